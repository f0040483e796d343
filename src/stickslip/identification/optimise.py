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
"""Starts added at most while only one came to the least cost."""
ROUNDS = 30
"""Steps of a descent at most."""
EARLY = 5
"""Steps after which starts are compared."""
HOPELESS = 9.0
"""Cost over the least then, above which a start goes no further: three times the residual."""


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
        return _agreeing(self.costs)


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
        Number of starts; up to `FURTHER` more while only one of several came to the least cost.
    seed : int
        Of the jitter of further starts.
    tried : sequence of array (p,)
        Values known to be worth a start, all of which are used, and before jittered ones.
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

    All starts go some rounds; those that are then far above the least cost go no further. As long
    as the least cost was reached once only, further starts are made, up to `FURTHER`. A start from
    which nothing is predicted has a cost and no end.
    """
    random = np.random.default_rng(seed)
    begun: list[Linearised | None] = []
    for number in range(max(starts, 1 + len(tried))):
        values = _start(problem.unknowns, number, tried, random)
        end, cancelled = _improved(problem, values, None, counter, EARLY)
        begun.append(end)
        if cancelled:
            return [one for one in begun if one], _costs(begun), True
    least = min(_costs(begun))
    ends: list[Linearised | None] = []
    for one in begun:
        going = one is not None and one.cost <= HOPELESS * least
        end, cancelled = (
            _improved(problem, one.values, one, counter, ROUNDS) if going and one else (one, False)
        )
        ends.append(end)
        if cancelled:
            return [e for e in ends if e], _costs(ends), True
    number = len(ends)
    while starts > 1 and _agreeing(_costs(ends)) < 2 and len(ends) < number + FURTHER:
        values = _start(problem.unknowns, len(ends), tried, random)
        end, cancelled = _improved(problem, values, None, counter, ROUNDS)
        ends.append(end)
        if cancelled:
            break
    return [one for one in ends if one], _costs(ends), cancelled


def _improved(
    problem: Searchable, values: Array, near: Linearised | None, counter: Counter, rounds: int
) -> tuple[Linearised | None, bool]:
    """Return where a start leads, None if nothing is predicted there; and whether to stop."""
    try:
        return improve(problem, values, near=near, counter=counter, rounds=rounds)
    except ConvergenceError:
        return None, False


def _costs(ends: Sequence[Linearised | None]) -> list[float]:
    return [math.inf if one is None else one.cost for one in ends]


def _agreeing(costs: Sequence[float]) -> int:
    """Return how many starts came to the least cost."""
    least = min(costs)
    return sum(cost <= least * (1.0 + AGREE) ** 2 for cost in costs)


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
    near: Linearised | None = None,
    counter: Callable[[Linearised], None] | None = None,
    rounds: int = ROUNDS,
) -> tuple[Linearised, bool]:
    """Descend from values (p,); return the end, and whether the watcher stopped it.

    A descent that ended at these values, `near`, is gone on with.

    Raises
    ------
    ConvergenceError
        If the record cannot be predicted at the start.
    """
    unknowns = problem.unknowns
    low, high = unknowns.limits()
    at = unknowns.coordinates(values)
    here = problem.linearise(unknowns.values(at)) if near is None else near
    if not here.finite:
        raise ConvergenceError("the record cannot be predicted from this start.")
    damping = 1e-3
    try:
        if counter is not None and near is None:
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
