"""Search for a motion by CMA-ES, with restarts."""

import hashlib
import json
import os
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.documents import regular_bytes, unwritable, write_file
from stickslip.errors import InputError, ParameterError
from stickslip.optimisation.parametrisation import Space
from stickslip.optimisation.problem import FAILED, Problem, ScoredMotion

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


@final
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


@final
@dataclass(frozen=True, kw_only=True)
class SearchResult:
    """Where a search ended."""

    best: tuple[Array, ...]
    """The best point within all limits of each lap that met one, the best of all first."""
    evaluations: int
    """Motions tried."""
    cancelled: bool
    """Whether it was ended early."""


@final
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
        scale = self.top if self.top > 0.0 else self.largest or 1.0
        return [PRICE * broken - goal / scale for goal, broken in rows]

    def found(self, evaluations: int, *, cancelled: bool) -> SearchResult:
        """Return where the search ended."""
        order = sorted(self.goals, key=lambda lap: -self.goals[lap])
        best = tuple(self.points[lap] for lap in order)
        return SearchResult(best=best, evaluations=evaluations, cancelled=cancelled)


@final
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

    own = seed + 1_000_003 * lap
    if start is None:
        middle = np.full(space.size, 0.5)
        start = middle if lap == 0 else np.random.default_rng(own).uniform(0.1, 0.9, space.size)
        width = LATER_WIDTH
    else:
        width = FIRST_WIDTH
    usual = 8 + int(3.0 * np.log(space.size))
    options = {
        "bounds": [0.0, 1.0],
        "popsize": usual * 2 ** min(lap, 3),
        "randn": _Normal(own),
        "seed": np.nan,
        "tolfun": 1e-6,
        "tolx": 1e-6,
        "verbose": -9,
    }
    return cma.CMAEvolutionStrategy(np.asarray(start), width, options)
