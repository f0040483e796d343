"""Searches for a motion: by CMA-ES with restarts, then polished with gradients.

Covariance matrix adaptation finds the valley among many; sequential quadratic programming, with
gradients from the sensitivities of runs, goes to its bottom.
"""

import hashlib
import json
import os
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError, ParameterError
from stickslip.show.documents import regular_bytes, unwritable, write_file
from stickslip.study.optimisation.parametrisation import Space
from stickslip.study.optimisation.problem import (
    FAILED,
    UNIT_OF_BACK_SLIP,
    Cycle,
    Problem,
    ScoredMotion,
    motor_of,
    slip_of_body,
)

# Search for a motion by CMA-ES, with restarts.

Array = NDArray[np.float64]

Row: TypeAlias = tuple[float, float]
"""Goal and violation of one motion."""
FORM = "stickslip/profile-search/1"
Told: TypeAlias = Callable[[str, int, int, float], object]
"""Called with the search, evaluations done and in all, and the best goal within limits or NaN."""
PRICE = 10.0
"""Cost of breaking a limit by all of itself, over the best goal so far."""
FIRST_WIDTH, LATER_WIDTH = 0.1, 0.3
"""Widths of the first cloud around a start that is given, and around one that is not."""
LOST = 2.0 * FAILED
"""Violation of numbers that make no profile."""


class Memory:
    """Goals and violations by search and generation; what a file has already is not run again.

    A search asks for the same motions again in the same order, so their results are all there is
    to know: no random state is kept, and the file is plain JSON.

    Parameters
    ----------
    path : str, Path or None
        File of the memory; None keeps it in this process only.
    subject : str
        Text of the problem; a file that belongs to another one is refused.

    Raises
    ------
    InputError
        If the file cannot be read or written, or belongs to another problem.

    Examples
    --------
    >>> memory = Memory(None, "one problem")
    >>> memory.recall("spline", 0) is None
    True
    >>> memory.keep("spline", [(0.06, 0.0)])
    >>> memory.recall("spline", 0)
    [(0.06, 0.0)]
    """

    def __init__(self, path: str | Path | None, subject: str) -> None:
        if not (path is None or isinstance(path, (str, os.PathLike))):
            raise InputError(f"state must be the path of a file, got {path!r}.")
        self.path = None if path is None else Path(path)
        self.digest = hashlib.sha256(subject.encode()).hexdigest()
        self.searches: dict[str, list[list[Row]]] = {}
        if self.path is not None and self.path.exists():
            self.searches = self._read(self.path)
        if self.path is not None:
            _refuse_unwritable(self.path)

    def recall(self, search: str, generation: int) -> list[Row] | None:
        """Return what came of a generation, if that is known."""
        known = self.searches.get(search, [])
        return known[generation] if generation < len(known) else None

    def keep(self, search: str, rows: Sequence[Row]) -> None:
        """Add a generation; the file appears whole or not at all."""
        self.searches.setdefault(search, []).append(list(rows))
        if self.path is not None:
            content = {"form": FORM, "problem": self.digest, "searches": self.searches}
            write_file(self.path, json.dumps(content))

    def _read(self, path: Path) -> dict[str, list[list[Row]]]:
        try:
            content: Any = json.loads(regular_bytes(path))
            if content["form"] != FORM:
                raise KeyError
            found = {
                str(name): [[(float(a), float(b)) for a, b in rows] for rows in generations]
                for name, generations in content["searches"].items()
            }
            digest = content["problem"]
        except OSError as error:
            raise InputError(f"{path} cannot be read: {error.strerror}.") from error
        except (AttributeError, KeyError, RecursionError, TypeError, ValueError):
            raise InputError(
                f"{path} is not the saved state of a profile search: name another file, or remove"
                " it."
            ) from None
        if digest != self.digest:
            raise InputError(
                f"{path} is the saved state of another search (different mechanism, law, goal,"
                " limit, seed, number of evaluations, or version): repeat the same request, or"
                " name another file."
            )
        return found


def _refuse_unwritable(path: Path) -> None:
    """Say at once what writing would only say after the first generation."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise unwritable(path, error) from error


@dataclass(frozen=True, kw_only=True)
class SearchResult:
    """Where a search ended."""

    best: tuple[Array, ...]
    """The best point within all limits of each lap that met one, the best of all first."""
    evaluations: int
    """Motions tried."""
    cancelled: bool
    """Whether it was ended early."""


class _Laps:
    """The best point of each lap, and the price of what is broken."""

    def __init__(self) -> None:
        self.points: dict[int, Array] = {}
        self.goals: dict[int, float] = {}
        self.largest = 0.0

    def add(self, lap: int, points: Sequence[Array], rows: Sequence[Row]) -> None:
        """Look at a generation."""
        for point, (goal, broken) in zip(points, rows, strict=True):
            self.largest = max(self.largest, abs(goal))
            if broken <= 0.0 and goal > self.goals.get(lap, -np.inf):
                self.points[lap], self.goals[lap] = point, goal

    @property
    def top(self) -> float:
        """Best goal within limits, or NaN."""
        return max(self.goals.values(), default=float("nan"))

    def costs(self, rows: Sequence[Row]) -> list[float]:
        """Return what the evolution strategy is told; it looks at their order only."""
        # In units of the best goal, or of the largest while none is within the limits.
        scale = self.top if self.top > 0.0 else self.largest or 1.0
        return [PRICE * broken - goal / scale for goal, broken in rows]

    def found(self, evaluations: int, *, cancelled: bool) -> SearchResult:
        """Return where the search ended."""
        order = sorted(self.goals, key=lambda lap: -self.goals[lap])
        best = tuple(self.points[lap] for lap in order)
        return SearchResult(best=best, evaluations=evaluations, cancelled=cancelled)


class _Normal:
    """Standard normal numbers of their own, so that nothing else shifts them."""

    def __init__(self, seed: int) -> None:
        self._draw = np.random.default_rng(seed)

    def __call__(self, *shape: int) -> Any:
        return self._draw.standard_normal(shape)


def search(
    problem: Problem,
    space: Space,
    start: Array | None,
    *,
    name: str,
    budget: int,
    seed: int,
    memory: Memory,
    watch: Told | None,
    executor: Executor | None = None,
) -> SearchResult:
    """Search until the budget is used up, starting again where the cloud has shrunk.

    Motions that break limits cost what they break beside their goal, so that the search may come
    from outside; the best is chosen among those that break none.
    """
    laps, done, generation = _Laps(), 0, 0
    if start is not None:  # a cloud hardly meets its own middle
        rows = _rows(problem, space, [start], name, memory, generation, executor)
        laps.add(-1, [start], rows)
        done, generation = 1, 1
    for lap in range(budget):
        cloud = _cloud(space, start if lap == 0 else None, seed, lap)
        while done < budget and not cloud.stop():
            points = [np.asarray(point, dtype=np.float64) for point in cloud.ask()]
            rows = _rows(problem, space, points, name, memory, generation, executor)
            laps.add(lap, points, rows)
            cloud.tell(points, laps.costs(rows))
            done, generation = done + len(rows), generation + 1
            if watch is not None and watch(name, done, budget, laps.top) is False:
                return laps.found(done, cancelled=True)
        if done >= budget:
            break
    return laps.found(done, cancelled=False)


def _rows(
    problem: Problem,
    space: Space,
    points: Sequence[Array],
    name: str,
    memory: Memory,
    generation: int,
    executor: Executor | None,
) -> Sequence[Row]:
    """Return what comes of a generation, from memory if it is there."""
    rows = memory.recall(name, generation)
    if rows is None:
        run = map if executor is None else executor.map
        rows = list(run(partial(_row, problem, space), points))
        memory.keep(name, rows)
    return rows


def _row(problem: Problem, space: Space, point: Array) -> Row:
    """Return goal and violation of a point."""
    judged = judged_at(problem, space, point)
    return (0.0, LOST) if judged is None else (judged.value, judged.violation)


def judged_at(problem: Problem, space: Space, point: Array) -> ScoredMotion | None:
    """Return what comes of a point, None where it makes no profile."""
    try:
        profile = space.profile(point)
    except ParameterError:
        return None
    return problem.judge(profile)


def _cloud(space: Space, start: Sequence[float] | Array | None, seed: int, lap: int) -> Any:
    """Return a new evolution strategy within the cube; later ones are larger."""
    import cma

    # Far apart, so that laps of one seed are not those of the next.
    own = seed + 1_000_003 * lap
    if start is None:
        middle = np.full(space.size, 0.5)
        start = middle if lap == 0 else np.random.default_rng(own).uniform(0.1, 0.9, space.size)
        width = LATER_WIDTH
    else:
        width = FIRST_WIDTH
    # Each lap has twice as many points, up to eight times as many: larger clouds see past narrow
    # valleys.
    usual = 8 + int(3.0 * np.log(space.size))
    options = {
        "bounds": [0.0, 1.0],
        "popsize": usual * 2 ** min(lap, 3),
        "randn": _Normal(own),
        "seed": np.nan,  # leaves NumPy's global state alone
        "tolfun": 1e-6,
        "tolx": 1e-6,
        "verbose": -9,
    }
    return cma.CMAEvolutionStrategy(np.asarray(start), width, options)


# Polishing of a motion by sequential quadratic programming, with gradients from sensitivities.

At: TypeAlias = Callable[[Array], ScoredMotion | None]
"""Runs the motion at a point."""

NUDGE = 1e-4
"""Half width of differences in the cube."""
SMALL = 1e-6
"""The same for numbers that no run stands behind."""
ROUNDS, BACK = 40, 15
"""Rounds of a quadratic programme towards the goal, and of one back within the limits."""
LAPS = 2
"""How often both are done."""
SPARE = (1e-4, 1e-3, 5e-3)
"""Shares of the limits that are left free on the back-slip, the next where one did not do."""
GAIN = 1e-3
"""Relative gain of a lap below which there is no next one."""
BROKEN = -10.0
"""What is left of the limits where a motion cannot be gone through."""
LAST = 1e-12
"""Relative improvement at which the quadratic programme stops."""


def polish(
    problem: Problem, space: Space, start: Array, *, budget: int, watch: Told | None = None
) -> tuple[Array | None, int]:
    """Improve a point; return the best within limits, if one was met, and the motions tried.

    These are no more than the budget, slopes by differences included.
    """
    steps = _Steps(problem, space, budget, watch)
    first = steps.at(start)
    if first is None or not first.margins:
        return None, steps.evaluations
    steps.count = len(steps.left(start))
    steps.scale = abs(first.value) or 1.0
    point = start
    try:
        for _ in range(LAPS):
            before = steps.top
            point = steps.towards_goal(point)
            for spare in SPARE:
                back = steps.back_within(point, spare)
                judged = steps.at(back)
                if judged is not None and judged.feasible:
                    break
            if steps.best is None or steps.top - before <= GAIN * abs(steps.top):
                break
            point = steps.best
    except _EndedError:
        pass
    return steps.best, steps.evaluations


class _EndedError(Exception):
    """Somebody wants the best so far, or the budget is used up."""


@dataclass
class _Steps:
    """Runs of a polish, each made once."""

    problem: Problem
    space: Space
    budget: int
    watch: Told | None
    known: dict[bytes, ScoredMotion | None] = field(default_factory=dict)
    count: int = 0
    scale: float = 1.0
    best: Array | None = None
    top: float = -np.inf

    @property
    def evaluations(self) -> int:
        """Motions tried."""
        return len(self.known)

    def at(self, u: Array) -> ScoredMotion | None:
        """Return what comes of a point, moved into the cube."""
        u = np.clip(u, 0.0, 1.0)
        key = u.tobytes()
        if key not in self.known:
            if self.evaluations >= self.budget:
                raise _EndedError
            judged = judged_at(self.problem, self.space, u)
            self.known[key] = judged
            if judged is not None and judged.feasible and judged.value > self.top:
                self.best, self.top = u, judged.value
            answer = (
                None if self.watch is None else self.watch("polish", self.evaluations, 0, self.top)
            )
            if answer is False:
                raise _EndedError
        return self.known[key]

    def towards_goal(self, start: Array) -> Array:
        """Return where a quadratic programme leads; its ways are often just outside the limits."""
        return self._solve(
            lambda u: -self.goal(u) / self.scale,
            lambda u: -self.slope(u) / self.scale,
            start,
            spare=0.0,
            rounds=ROUNDS,
        )

    def back_within(self, start: Array, spare: float) -> Array:
        """Return a point within the limits as close as can be."""
        return self._solve(
            lambda u: 0.5 * float((u - start) @ (u - start)),
            lambda u: u - start,
            start,
            spare=spare,
            rounds=BACK,
        )

    def _solve(
        self,
        cost: Callable[[Array], float],
        slope: Callable[[Array], Array],
        start: Array,
        *,
        spare: float,
        rounds: int,
    ) -> Array:
        from scipy.optimize import minimize

        found = minimize(
            cost,
            start,
            jac=slope,
            bounds=[(0.0, 1.0)] * self.space.size,
            constraints=[
                {"type": "ineq", "fun": lambda u: self.left(u) - spare, "jac": self.left_slopes}
            ],
            method="SLSQP",
            options={"maxiter": rounds, "ftol": LAST},
        )
        return np.asarray(np.clip(found.x, 0.0, 1.0))

    def goal(self, u: Array) -> float:
        return _value(self.at(u))

    def slope(self, u: Array) -> Array:
        judged = self.at(u)
        if judged is None or not judged.margins:
            return np.zeros(self.space.size)
        return goal_gradient(self.problem, self.space, np.clip(u, 0.0, 1.0), judged, self.at)

    def left(self, u: Array) -> Array:
        """Return what is left of each limit, in each stretch and scenario, as a share of it."""
        judged = self.at(u)
        if judged is None or not judged.margins:
            return np.full(self.count, BROKEN)
        return np.concatenate([self._left_of(cycle) for cycle in judged.cycles])

    def _left_of(self, cycle: Cycle) -> Array:
        parts = [np.array([SPARE[-1] if cycle.repeats else -FAILED])]
        for name, allowed in self.problem.limits.given().items():
            reached = cycle.peaks.get(name, np.array([getattr(cycle, name)]))
            left = reached - allowed if name == "load_share" else allowed - reached
            parts.append(left / (1.0 if name == "load_share" else allowed or UNIT_OF_BACK_SLIP))
        return np.concatenate(parts)

    def left_slopes(self, u: Array) -> Array:
        """Return the slopes of what is left (limits, size), by differences."""
        return _differences(self.left, np.clip(u, 0.0, 1.0), NUDGE)


def _differences(function: Any, u: Array, nudge: float) -> Array:
    """Return central differences within the cube, one-sided at its faces."""
    columns = []
    for i in range(len(u)):
        above, below = u.copy(), u.copy()
        above[i], below[i] = min(1.0, u[i] + nudge), max(0.0, u[i] - nudge)
        rise = np.asarray(function(above)) - np.asarray(function(below))
        columns.append(rise / (above[i] - below[i]))
    return np.stack(columns, axis=-1)


def goal_gradient(
    problem: Problem, space: Space, u: Array, judged: ScoredMotion, at: At | None = None
) -> Array:
    """Return the slopes of the goal in the cube (size,).

    Travel and period come from the sensitivities of the runs and from the profile; the work of the
    motor, and all of it where a kind of motion has no sensitivities, from differences, whose
    motions `at` runs, so that they are counted.
    """
    seen: At = (lambda v: judged_at(problem, space, v)) if at is None else at
    if not space.paths(u):
        return _differences(lambda v: _value(seen(v)), u, NUDGE)
    values = problem.values(judged.cycles)
    weights = problem.scenarios.weights(values)
    found = np.zeros(space.size)
    for k in np.flatnonzero(weights):
        found += weights[k] * _slope_of(problem, space, u, judged.cycles[k], int(k), seen)
    return found


def _value(judged: ScoredMotion | None) -> float:
    return 0.0 if judged is None else judged.value


def _slope_of(problem: Problem, space: Space, u: Array, cycle: Cycle, k: int, at: At) -> Array:
    """Return the slopes of the goal of one scenario."""
    travel = travel_gradient(problem, space, u, cycle)
    if problem.goal.name == "travel":
        return travel
    if problem.goal.name == "speed":
        period = _differences(lambda v: float(space.profile(v).period), u, SMALL)
        return (travel - cycle.travel / cycle.period * period) / cycle.period

    def work(v: Array) -> float:
        judged = at(v)
        return cycle.work if judged is None or not judged.margins else judged.cycles[k].work

    slope = _differences(work, u, NUDGE)
    return np.asarray((travel - cycle.travel / cycle.work * slope) / cycle.work)


def travel_gradient(problem: Problem, space: Space, u: Array, cycle: Cycle) -> Array:
    """Return the slopes of the travel of a cycle in the cube (size,).

    The ends of the cycle move with the period, so that the velocity there counts too.
    """
    x = slip_of_body(problem.mechanism)
    v = problem.mechanism.rates[problem.mechanism.coordinates.index(x)]
    names = list(space.paths(u))
    ends = [cycle.begin, cycle.run.span[1]]
    seen = cycle.run.at(ends)
    assert seen.differentiate is not None
    motor = motor_of(problem.mechanism)
    paths = [f"mechanism.{motor}.profile.{name}" for name in names]
    slopes = seen.differentiate(seen.t, paths)[:, seen.states.index(x), :]
    moved = _differences(lambda w: list(space.paths(w).values()), u, SMALL)
    period = _differences(lambda w: float(space.profile(w).period), u, SMALL)
    # Ends lie at whole numbers of periods, and move with the period.
    counts = np.round(np.array(ends) / cycle.period)
    at_ends = slopes @ moved + np.outer(seen[v] * counts, period)
    return np.asarray(at_ends[1] - at_ends[0])
