"""Levenberg and Marquardt's least squares with bounds, from several starts."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError
from stickslip.formatting import number
from stickslip.identification.estimation.parameters import FreeParameters
from stickslip.identification.estimation.problem import LeastSquaresProblem, ResidualJacobian

Array = NDArray[np.float64]
Watch = Callable[[float], object]
"""Called with the least root mean square so far; answers False to stop with what there is."""

JITTER = 0.4
"""Further starts are the first one times e^(+-JITTER), by coordinate."""
AGREE = 0.01
"""Starts agree if their root mean squares differ by less than this share."""
FLAT = 1e-4
"""The search ends when a step lowers the cost by less than this share."""
STALLED, PATIENCE = 1e-3, 3
"""... or when so many steps together took less than this share off it."""
FIRST_DAMPING, GROWTH = 1e-3, 10.0
"""Damping of the first step, and what it is multiplied by when a step fails: after each further
failure by as much again, since steps change little while damping is below 1."""
MOST_DAMPING = 1e6
"""Damping above which nothing moves any more."""
FURTHER = 4
"""Starts added at most while only one came to the least cost."""
ROUNDS = 30
"""Steps of a descent at most."""
EARLY = 5
"""Steps after which starts are compared."""
HOPELESS = 9.0
"""Cost over the least then, above which a start goes no further: three times the residual."""
DISTINCT = 3
"""Ends on some segments that go `EARLY` rounds on all, at most."""
NEARLY, POLISHED = 1.5, 2
"""Cost over the least of these up to which others of them go on, and how many do at most."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OptimizeResult:
    """The least cost found, and what each start came to."""

    best: ResidualJacobian
    """Residuals and Jacobian at the least cost."""
    costs: tuple[float, ...]
    """Cost each start ended with, the first start first; of all segments, or scaled to them, if
    starts were compared on some."""
    values: Array
    """Values each start ended with (starts, p)."""
    evaluations: int
    """How often the record was predicted."""
    cancelled: bool = False
    """Whether the watcher ended the search."""
    hopeless: bool = False
    """Whether the search was ended early, for a rival far below."""

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
    """Called with the least root mean square so far, if given; False ends the search."""
    least: float = math.inf
    """Least root mean square so far."""
    count: int = 0
    """Predictions so far."""

    def __call__(self, seen: ResidualJacobian) -> None:
        """Note a prediction."""
        self.count += 1
        self.least = min(self.least, seen.rms)
        if self.watch is not None and self.watch(self.least) is False:
            raise _StoppedError


def search(
    problem: LeastSquaresProblem,
    *,
    starts: int = 4,
    seed: int = 0,
    start_values: Sequence[Array] = (),
    few: LeastSquaresProblem | None = None,
    rival: float = 0.0,
    watch: Watch | None = None,
) -> OptimizeResult:
    """Return the least cost over several starts."""
    race = _Race(problem if few is None else few, starts, seed, start_values, rival, Counter(watch))
    race.run()
    ends = [one for one in race.ends if one]
    if not ends:
        raise ConvergenceError(
            f"the record cannot be simulated from any of {len(race.ends)} starting points near"
            f" {', '.join(f'{i.path} = {number(i.start)}' for i in problem.free_parameters.items)}."
        )
    valleys = [_Valley(end, end) for end in ends] if few is None else _valleys(problem, ends, race)
    best = min((one.whole for one in valleys), key=lambda end: end.cost)
    share = len(best.residual) / len(ends[0].residual)
    return OptimizeResult(
        best=best,
        costs=tuple(_on_all(cost, valleys, share) for cost in race.costs),
        values=np.array([end.values for end in ends]),
        evaluations=race.counter.count,
        cancelled=race.cancelled,
        hopeless=race.hopeless,
    )


@dataclass(frozen=True)
class _Valley:
    """Where starts of a race came to."""

    end: ResidualJacobian
    """Where they ended on the segments of the race."""
    whole: ResidualJacobian
    """Where that leads with all segments."""


def _valleys(
    problem: LeastSquaresProblem, ends: Sequence[ResidualJacobian], race: "_Race"
) -> list[_Valley]:
    """Return the best distinct ends of a race, with all segments.

    Which of them are best is asked of all segments: a valley that some of them favour may be the
    worse one.
    """
    ordered = sorted(ends, key=lambda end: end.cost)
    race.counter.least = math.inf  # of some segments so far
    distinct = [ordered[0]]
    for end in ordered[1:]:
        near = end.cost <= HOPELESS * ordered[0].cost and len(distinct) < DISTINCT
        if near and not race.cancelled and not _agree(end.cost, distinct[-1].cost):
            distinct.append(end)
    found: list[_Valley] = []
    for end in distinct:
        rounds = 0 if race.cancelled else ROUNDS if len(distinct) == 1 else EARLY
        whole, cancelled = _improved(
            problem, end.values, None, race.counter, rounds, rival=race.rival
        )
        race.cancelled |= cancelled
        if whole:
            found.append(_Valley(end, whole))
    found.sort(key=lambda one: one.whole.cost)
    race.hopeless |= bool(found) and not race.cancelled and _far_above(found[0].whole, race.rival)
    for k, one in enumerate(found[:POLISHED]):
        near = one.whole.cost <= NEARLY * found[0].whole.cost
        if race.cancelled or race.hopeless or not near or len(distinct) == 1:
            break
        whole, race.cancelled = _improved(
            problem, one.whole.values, one.whole, race.counter, ROUNDS - EARLY
        )
        found[k] = _Valley(one.end, whole or one.whole)
    if not found:
        raise ConvergenceError(
            "the whole record cannot be simulated with the values fitted to a part of it."
        )
    return found


def _on_all(cost: float, valleys: Sequence[_Valley], share: float) -> float:
    """Return what a cost on the segments of a race is on all, `share` times as many rows."""
    for one in valleys:
        if one.end.cost > 0.0 and _agree(cost, one.end.cost):
            return cost * one.whole.cost / one.end.cost
    return cost * share


@dataclass
class _Race:
    """Searches from several starts.

    All go some rounds; those that are then far above the least cost go no further. As long as the
    least cost was reached once only, further starts are made, up to `FURTHER`. A start from which
    nothing is predicted has no end.
    """

    problem: LeastSquaresProblem
    starts: int
    seed: int
    tried: Sequence[Array]
    rival: float
    counter: Counter
    ends: list[ResidualJacobian | None] = field(default_factory=list)
    cancelled: bool = False
    hopeless: bool = False
    """Whether it was ended for a rival far below."""

    @property
    def costs(self) -> list[float]:
        """Cost of each end, the first start first."""
        return [math.inf if one is None else one.cost for one in self.ends]

    def run(self) -> None:
        """Search until starts agree, or the watcher stops it."""
        random = np.random.default_rng(self.seed)
        free_parameters = self.problem.free_parameters
        count = max(self.starts, 1 + len(self.tried))
        for start in range(count):
            if not self.cancelled:
                self.ends.append(None)
                self._go(start, _start(free_parameters, start, self.tried, random), EARLY)
        limit = HOPELESS * min(self.costs)
        goal: ResidualJacobian | None = None
        for start in sorted(range(len(self.ends)), key=self.costs.__getitem__):
            end = self.ends[start]
            if self.hopeless or not end or end.cost > limit:
                break
            self._go(start, end.values, ROUNDS, goal)
            # ends of five rounds are on their way: only where one has arrived can others agree
            goal = self._best
            several = len(self.ends) > 1 and not self.cancelled
            self.hopeless = several and goal is not None and _far_above(goal, self.rival)
        while self.starts > 1 and not self.hopeless and not self.cancelled:
            number = len(self.ends)
            if _agreeing(self.costs) > 1 or number >= FURTHER + count:
                break
            self.ends.append(None)
            values = _start(free_parameters, number, self.tried, random)
            self._go(number, values, ROUNDS, self._best)

    @property
    def _best(self) -> ResidualJacobian | None:
        """The end of least cost; None if there is none."""
        return min((one for one in self.ends if one), key=lambda one: one.cost, default=None)

    def _go(
        self, number: int, values: Array, rounds: int, goal: ResidualJacobian | None = None
    ) -> None:
        """Go on with a start for some rounds, or until it comes to a goal."""
        if not self.cancelled:
            self.ends[number], self.cancelled = _improved(
                self.problem, values, self.ends[number], self.counter, rounds, goal
            )


def _improved(
    problem: LeastSquaresProblem,
    values: Array,
    near: ResidualJacobian | None,
    counter: Counter,
    rounds: int,
    goal: ResidualJacobian | None = None,
    rival: float = 0.0,
) -> tuple[ResidualJacobian | None, bool]:
    """Return where a start leads, None if nothing is predicted there; and whether to stop."""
    try:
        return improve(
            problem, values, near=near, counter=counter, rounds=rounds, goal=goal, rival=rival
        )
    except ConvergenceError:
        return None, False


def _far_above(end: ResidualJacobian, rival: float) -> bool:
    """Whether an end leaves far more than a rival's mean square of all rows, 0 if there is none."""
    return end.rms**2 > HOPELESS * rival > 0.0


def _agree(cost: float, other: float) -> bool:
    """Whether two costs agree."""
    return _agreeing([cost, other]) == 2


def _agreeing(costs: Sequence[float]) -> int:
    """Return how many starts came to the least cost."""
    least = min(costs)
    return sum(cost <= least * (1.0 + AGREE) ** 2 for cost in costs)


def _start(
    free_parameters: FreeParameters,
    number: int,
    tried: Sequence[Array],
    random: np.random.Generator,
) -> Array:
    """Return the values of a start: the first one, those tried, then jittered ones."""
    if number == 0:
        return free_parameters.start
    if number <= len(tried):
        return tried[number - 1]
    factors = np.exp(JITTER * random.choice((-1.0, 1.0), size=len(free_parameters)))
    base = tried[(number - 1) % len(tried)] if tried else free_parameters.start
    return free_parameters.values(free_parameters.coordinates(base * factors))


def improve(
    problem: LeastSquaresProblem,
    values: Array,
    *,
    near: ResidualJacobian | None = None,
    counter: Callable[[ResidualJacobian], None] | None = None,
    rounds: int = ROUNDS,
    goal: ResidualJacobian | None = None,
    flat: float = FLAT,
    rival: float = 0.0,
) -> tuple[ResidualJacobian, bool]:
    """Descend from values (p,); return the end, and whether the watcher stopped it.

    A descent that ended at these values, `near`, is continued. It ends early where it comes to a
    `goal`, another end, where it is still far above the mean square of a `rival`, and where a step
    promises to lower it by less than the share `flat`; a share that is not the usual one never
    stops the first step.
    """
    free_parameters = problem.free_parameters
    low, high = free_parameters.limits()
    at = free_parameters.coordinates(values)
    here = problem.linearise(free_parameters.values(at)) if near is None else near
    if not here.finite:
        raise ConvergenceError("the record cannot be simulated with these start values.")
    damping, growth = FIRST_DAMPING, GROWTH
    costs, moved = [here.cost], False
    try:
        if counter is not None and near is None:
            counter(here)
        for k in range(rounds):
            table = here.slopes @ free_parameters.slopes(at)
            step, promised = step_of(table, here.residual, at, low, high, damping)
            done = promised <= flat * here.cost
            trial = at if done and (moved or flat <= FLAT) else np.clip(at + step, low, high)
            there = problem.linearise(free_parameters.values(trial), here)
            if counter is not None:
                counter(there)
            gained = here.cost - there.cost
            if gained > 0.0 and there.finite:
                at, here = trial, there
                damping, growth = damping * _eased(gained, promised), GROWTH
                costs.append(here.cost)
            elif not done:
                damping, growth = damping * growth, growth * GROWTH
            moved = True
            if done and not gained > flat * here.cost:
                break  # nor did initial states, which follow one step behind, gain anything
            if len(costs) > PATIENCE and here.cost > (1.0 - STALLED) * costs[-1 - PATIENCE]:
                break
            if damping > MOST_DAMPING or (k + 1 >= EARLY and _far_above(here, rival)):
                break
            if gained < AGREE * here.cost and goal and _leads_to(free_parameters, here, goal):
                break
    except _StoppedError:
        return here, True
    return here, False


def _leads_to(
    free_parameters: FreeParameters, here: ResidualJacobian, goal: ResidualJacobian
) -> bool:
    """Whether a descent comes to an end: their costs agree, and slopes predict that of the end.

    One that passes the same cost on its way to another valley must go on.
    """
    if not _agree(here.cost, goal.cost):
        return False
    at, end = map(free_parameters.coordinates, (here.values, goal.values))
    there = here.residual - here.slopes @ free_parameters.slopes(at) @ (end - at)
    return _agree(float(there @ there), goal.cost)


def _eased(gained: float, promised: float) -> float:
    """Return what damping is multiplied by after a step that gained so much of what it promised."""
    if gained > 0.75 * promised:
        return 1.0 / GROWTH
    return 1.0 if gained > 0.25 * promised else math.sqrt(GROWTH)


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
