"""Levenberg and Marquardt's least squares with bounds, from several starts."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError
from stickslip.identify.fits.parameters import FreeParameters
from stickslip.identify.fits.settings import ROUNDS, SETTLED
from stickslip.show.formatting import count, number

Array = NDArray[np.float64]
STEEPEST = float(np.sqrt(np.finfo(float).max))
"""Slopes from here on, whose squares overflow, are those of predictions that leave all bounds."""


class ResidualJacobian:
    """Residuals and their slopes at some values, with what is local to a segment eliminated."""

    def __init__(
        self,
        *,
        values: Array,
        residual: Array,
        slopes: Array | Callable[[], Array],
        segment: NDArray[np.intp],
        memory: Any = None,
    ) -> None:
        """Take residuals; slopes may be what finds them, when they are asked for."""
        self.values = values
        """Values of the unknowns (p,)."""
        self.residual = residual
        """Measured less predicted (n,); infinite where the prediction failed."""
        self.segment = segment
        """Segment each row belongs to (n,)."""
        self.memory = memory
        """What the problem wants to be handed when it linearises near by."""
        self._slopes = slopes

    @property
    def slopes(self) -> Array:
        """Derivatives of the prediction by the values (n, p)."""
        if callable(self._slopes):
            self._slopes = self._slopes()
        return self._slopes

    def __getstate__(self) -> dict[str, Any]:
        """Return what crosses processes: slopes that are found."""
        return {**self.__dict__, "_slopes": self.slopes}

    def with_residual(self, residual: Array) -> "ResidualJacobian":
        """Return the same with other residuals (n,)."""
        return ResidualJacobian(
            values=self.values,
            residual=residual,
            slopes=lambda: self.slopes,
            segment=self.segment,
            memory=self.memory,
        )

    @property
    def cost(self) -> float:
        """Sum of squares."""
        return float(self.residual @ self.residual)

    @property
    def finite(self) -> bool:
        """Whether the record is predicted, and slopes are not beyond what can be squared."""
        if not np.isfinite(self.cost):
            return False
        steepest = float(np.max(np.abs(self.slopes), initial=0.0))  # NaN stays
        return steepest < STEEPEST

    @property
    def rms(self) -> float:
        """Root mean square of the residuals."""
        return float(np.sqrt(self.cost / len(self.residual)))


class LeastSquaresProblem(Protocol):
    """What a search needs."""

    @property
    def free_parameters(self) -> FreeParameters:
        """What is looked for."""

    def linearise(self, values: Array, near: ResidualJacobian | None = None) -> ResidualJacobian:
        """Return residuals and slopes at values (p,), from an answer for near values if any."""


Watch = Callable[[float], object]
"""Called with the least root mean square so far; answers False to stop with what there is."""

JITTER = 0.4
"""Further starts are the first one times e^(+-JITTER), by coordinate."""
AGREE = 0.01
"""Starts agree if their root mean squares differ by less than this share."""
FIRST_DAMPING, GROWTH = 1e-3, 10.0
"""Damping of the first step, and what it is multiplied by when a step fails: after each further
failure by as much again, since steps change little while damping is below 1."""


@dataclass(frozen=True, kw_only=True, eq=False)
class OptimizeResult:
    """The least cost found, and what each start came to."""

    best: ResidualJacobian
    """Residuals and Jacobian at the least cost."""
    costs: tuple[float, ...]
    """Cost each start ended with, the first start first."""
    evaluations: int
    """How often the record was predicted."""
    cancelled: bool = False
    """Whether the watcher ended the search."""
    ends: tuple[Array, ...] = ()
    """Values (p,) that each start ended with, NaN where it could not be simulated."""

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
    starts: int = 1,
    seed: int = 0,
    watch: Watch | None = None,
) -> OptimizeResult:
    """Return the least cost over several starts.

    The first is that of the problem, the others are jittered.
    """
    counter, random = Counter(watch), np.random.default_rng(seed)
    ends: list[ResidualJacobian] = []
    costs, reached = list[float](), list[Array]()
    cancelled = False
    for place in range(starts):
        if cancelled:
            break
        values = _start(problem.free_parameters, place, random)
        try:
            end, cancelled = improve(problem, values, counter=counter)
            gains = True
            while gains and not cancelled:  # in a long valley damping grows too much
                before = end.cost
                end, cancelled = improve(problem, end.values, near=end, counter=counter)
                gains = end.cost < (1.0 - AGREE) * before
        except ConvergenceError:
            costs.append(math.inf)
            reached.append(np.full(len(values), math.nan))
            continue
        ends.append(end)
        reached.append(end.values)
        costs.append(end.cost)
    if not ends:
        raise ConvergenceError(
            f"the record cannot be simulated from any of {count(len(costs), 'starting point')} near"
            f" {', '.join(f'{i.path} = {number(i.start)}' for i in problem.free_parameters.items)}."
        )
    return OptimizeResult(
        best=min(ends, key=lambda end: end.cost),
        costs=tuple(costs),
        evaluations=counter.count,
        cancelled=cancelled,
        ends=tuple(reached),
    )


def _start(
    free_parameters: FreeParameters,
    number: int,
    random: np.random.Generator,
) -> Array:
    """Return the values of a start: the first one, then jittered ones."""
    if number == 0:
        return free_parameters.start
    factors = np.exp(JITTER * random.choice((-1.0, 1.0), size=len(free_parameters)))
    return free_parameters.values(free_parameters.coordinates(free_parameters.start * factors))


def improve(
    problem: LeastSquaresProblem,
    values: Array,
    *,
    near: ResidualJacobian | None = None,
    counter: Callable[[ResidualJacobian], None] | None = None,
    rounds: int = ROUNDS,
    least: float | None = None,
) -> tuple[ResidualJacobian, bool]:
    """Descend from values (p,); return the end, and whether the watcher stopped it.

    A descent that ended at these values, `near`, is continued. It ends where a step lowers the cost
    by no more than `least`, or a share of the cost if that is not given.
    """
    free_parameters = problem.free_parameters
    low, high = free_parameters.limits()
    at = free_parameters.coordinates(values)
    here = problem.linearise(free_parameters.values(at)) if near is None else near
    if not here.finite:
        raise ConvergenceError("the record cannot be simulated with these start values.")
    damping, growth = FIRST_DAMPING, GROWTH
    try:
        if counter is not None and near is None:
            counter(here)
        for _ in range(rounds):
            table = here.slopes @ free_parameters.slopes(at)
            step, promised = step_of(table, here.residual, at, low, high, damping)
            enough = SETTLED * here.cost if least is None else least
            done = promised <= enough
            trial = at if done else np.clip(at + step, low, high)
            there = problem.linearise(free_parameters.values(trial), here)
            if counter is not None:
                counter(there)
            gained = here.cost - there.cost
            if gained > 0.0 and there.finite:
                at, here = trial, there
                damping, growth = damping * _eased(gained, promised), GROWTH
            elif not done:
                damping, growth = damping * growth, growth * GROWTH
            if done and not gained > enough:
                break  # nor did initial states, which follow one step behind, gain anything
    except _StoppedError:
        return here, True
    return here, False


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
