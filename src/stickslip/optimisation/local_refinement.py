"""Polishing of a motion by sequential quadratic programming, with gradients from sensitivities."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.optimisation.cma_search import Told, judged_at
from stickslip.optimisation.cycle_metrics import Cycle, motor_of, slip_of_body
from stickslip.optimisation.parametrisation import Space
from stickslip.optimisation.problem import FAILED, UNIT_OF_BACK_SLIP, Problem, ScoredMotion

Array = NDArray[np.float64]
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


@final
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
            told = (
                None if self.watch is None else self.watch("polish", self.evaluations, 0, self.top)
            )
            if told is False:
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
    counts = np.round(np.array(ends) / cycle.period)
    at_ends = slopes @ moved + np.outer(seen[v] * counts, period)
    return np.asarray(at_ends[1] - at_ends[0])
