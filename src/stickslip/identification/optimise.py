"""Levenberg and Marquardt's least squares with bounds, from several starts."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError
from stickslip.identification.problem import Linearised, Searchable
from stickslip.identification.unknowns import Unknowns

__all__ = ["Counter", "Found", "Watch", "improve", "search", "step_of"]

Array = NDArray[np.float64]
Watch = Callable[[float], object]
"""Called with the least root mean square so far; answers False to stop with what there is."""

JITTER = 0.4
"""Further starts are the first one times e^(+-JITTER), by coordinate."""
AGREE = 0.01
"""Starts agree if their root mean squares differ by less than this share."""
FLAT = 1e-4
"""The search ends when a step lowers the cost by less than this share."""
FURTHER = 4
"""Starts added when the first ones disagree."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Found:
    """The least cost found, and what each start came to."""

    best: Linearised
    costs: tuple[float, ...]
    """Cost each start ended with, the first start first."""
    values: Array
    """Values each start ended with (starts, p)."""
    evaluations: int
    """How often the record was predicted."""
    cancelled: bool = False

    @property
    def agreeing(self) -> int:
        """How many starts came to the least cost."""
        least = min(self.costs)
        return sum(cost <= least * (1.0 + AGREE) ** 2 for cost in self.costs)


class _StoppedError(Exception):
    """The watcher does not want to go on."""


@dataclass
class Counter:
    """Counts predictions and tells a watcher of the least root mean square, which may end them."""

    watch: Watch | None
    least: float = math.inf
    count: int = 0

    def __call__(self, seen: Linearised) -> None:
        """Note a prediction."""
        self.count += 1
        self.least = min(self.least, seen.rms)
        if self.watch is not None and self.watch(self.least) is False:
            raise _StoppedError


def search(
    problem: Searchable,
    *,
    starts: int = 4,
    seed: int = 0,
    tried: Sequence[Array] = (),
    watch: Watch | None = None,
) -> Found:
    """Return the least cost over several starts.

    Parameters
    ----------
    problem : Searchable
        Its unknowns give the first start.
    starts : int
        Number of starts; as many as `FURTHER` more if they disagree.
    seed : int
        Of the jitter of further starts.
    tried : sequence of array (p,)
        Values known to be worth a start, used before jittered ones.
    watch : callable, optional
        Called with the least root mean square so far; False ends the search with the best so far.

    Raises
    ------
    ConvergenceError
        If the record cannot be predicted from any start.
    """
    counter = Counter(watch)
    ends, costs, cancelled = _ends(problem, starts, seed, tried, counter)
    if not ends:
        raise ConvergenceError(
            f"the record cannot be predicted from any of {len(costs)} starts near"
            f" {', '.join(f'{i.path} = {i.start:.3g}' for i in problem.unknowns.items)}."
        )
    return Found(
        best=min(ends, key=lambda end: end.cost),
        costs=tuple(costs),
        values=np.array([end.values for end in ends]),
        evaluations=counter.count,
        cancelled=cancelled,
    )


def _ends(
    problem: Searchable, starts: int, seed: int, tried: Sequence[Array], counter: Counter
) -> tuple[list[Linearised], list[float], bool]:
    """Return where starts ended, the cost of each, and whether the watcher stopped them.

    A start from which nothing is predicted has a cost and no end.
    """
    random = np.random.default_rng(seed)
    ends: list[Linearised] = []
    costs: list[float] = []
    cancelled, wanted = False, starts
    while len(costs) < wanted and not cancelled:
        values = _start(problem.unknowns, len(costs), tried, random)
        try:
            end, cancelled = improve(problem, values, counter=counter)
        except ConvergenceError:
            costs.append(math.inf)
        else:
            ends.append(end)
            costs.append(end.cost)
        if len(costs) == starts > 1 and _disagree(costs):
            wanted = starts + FURTHER
    return ends, costs, cancelled


def _disagree(costs: Sequence[float]) -> bool:
    """Whether less than half of the starts came to the least cost."""
    least = min(costs)
    agreeing = sum(cost <= least * (1.0 + AGREE) ** 2 for cost in costs)
    return agreeing < (len(costs) + 1) // 2


def _start(
    unknowns: Unknowns, number: int, tried: Sequence[Array], random: np.random.Generator
) -> Array:
    """Return the values of a start: the first one, those tried, then jittered ones."""
    if number == 0:
        return unknowns.start
    if number <= len(tried):
        return tried[number - 1]
    factors = np.exp(JITTER * random.choice((-1.0, 1.0), size=len(unknowns)))
    base = tried[(number - 1) % len(tried)] if tried else unknowns.start
    return unknowns.values(unknowns.coordinates(base * factors))


def improve(
    problem: Searchable,
    values: Array,
    *,
    counter: Callable[[Linearised], None] | None = None,
    rounds: int = 30,
) -> tuple[Linearised, bool]:
    """Descend from values (p,); return the end, and whether the watcher stopped it.

    Raises
    ------
    ConvergenceError
        If the record cannot be predicted at the start.
    """
    unknowns = problem.unknowns
    low, high = unknowns.limits()
    at = unknowns.coordinates(values)
    here = problem.linearise(unknowns.values(at))
    if not here.finite:
        raise ConvergenceError("the record cannot be predicted from this start.")
    damping = 1e-3
    try:
        if counter is not None:
            counter(here)
        for _ in range(rounds):
            table = here.slopes @ unknowns.slopes(at)
            step, promised = step_of(table, here.residual, at, low, high, damping)
            flat = promised <= FLAT * here.cost
            trial = at if flat else np.clip(at + step, low, high)
            there = problem.linearise(unknowns.values(trial), here)
            if counter is not None:
                counter(there)
            gained = here.cost - there.cost
            better = there.finite and gained > 0.0
            if better:
                at, here = trial, there
            if flat and not gained > FLAT * here.cost:
                break  # nor did initial states, which follow one step behind, gain anything
            if not flat:
                damping = max(damping / 10.0, 1e-12) if better else damping * 10.0
            if damping > 1e6:
                break
    except _StoppedError:
        return here, True
    return here, False


def step_of(
    table: Array, residual: Array, at: Array, low: Array, high: Array, damping: float
) -> tuple[Array, float]:
    """Return a damped step (p,) that leaves no bound, and what it promises to take off the cost."""
    slope = table.T @ residual
    free = ~(((at <= low) & (slope < 0.0)) | ((at >= high) & (slope > 0.0)))
    step = np.zeros_like(at)
    while free.any():
        square = table[:, free].T @ table[:, free]
        scale = np.maximum(np.diag(square), 1e-30 * max(float(np.trace(square)), 1e-300))
        wanted = slope[free] - table[:, free].T @ (table[:, ~free] @ step[~free])
        whole = np.linalg.lstsq(square + damping * np.diag(scale), wanted, rcond=None)[0]
        reached = at[free] + whole
        step[free] = np.clip(reached, low[free], high[free]) - at[free]
        stopped = (reached < low[free]) | (reached > high[free])
        if not stopped.any():
            break
        # The others went as far as they did to make up for what a bound now cuts short.
        free[np.flatnonzero(free)[stopped]] = False
    change = table @ step
    return step, float(2.0 * residual @ change - change @ change)
