"""Search for a motion by CMA-ES, with restarts."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ParameterError
from stickslip.optimisation.checkpoint import Memory, Row
from stickslip.optimisation.parametrisation import Space
from stickslip.optimisation.problem import FAILED, Problem, ScoredMotion

Array = NDArray[np.float64]
Told: TypeAlias = Callable[[str, int, int, float], object]
"""Called with the search, evaluations done and in all, and the best goal within limits or NaN."""

PRICE = 10.0
"""Cost of breaking a limit by all of itself, over the best goal so far."""
FIRST_WIDTH, LATER_WIDTH = 0.1, 0.3
"""Widths of the first cloud around a start that is given, and around one that is not."""
LOST = 2.0 * FAILED
"""Violation of numbers that make no profile."""


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
