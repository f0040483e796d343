"""Levenberg and Marquardt's least squares with bounds."""

import math
from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.fits.parameters import FreeParameters

Array = NDArray[np.float64]
STEEPEST = float(np.sqrt(np.finfo(float).max))
"""Slopes from here on, whose squares overflow, are those of predictions that leave all bounds."""


class ResidualJacobian:
    """Residuals and their slopes at some values, with what is local to parts of them eliminated."""

    def __init__(
        self,
        *,
        values: Array,
        residual: Array,
        slopes: Array | Callable[[], Array],
        memory: Any = None,
    ) -> None:
        """Take residuals; slopes may be what finds them, when they are asked for."""
        self.values = values
        """Values of the unknowns (p,)."""
        self.residual = residual
        """Measured less predicted (n,); infinite where the prediction failed."""
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


AGREE = 0.01
"""Root mean squares agree that differ by less than this share."""
FIRST_DAMPING, GROWTH = 1e-3, 10.0
"""Damping of the first step, and what it is multiplied by when a step fails: after each further
failure by as much again, since steps change little while damping is below 1."""


def improve(
    problem: LeastSquaresProblem,
    values: Array,
    *,
    rounds: int,
    least: float,
    near: ResidualJacobian | None = None,
) -> ResidualJacobian:
    """Return where a descent from values (p,) ends: where a step gains no more than `least`.

    What a problem remembers, such as initial states, goes on from what is `near`.
    """
    free_parameters = problem.free_parameters
    low, high = free_parameters.limits()
    at = free_parameters.coordinates(values)
    here = problem.linearise(free_parameters.values(at), near)
    damping, growth = FIRST_DAMPING, GROWTH
    for _ in range(rounds if here.finite else 0):
        table = here.slopes * free_parameters.slopes(at)
        step, promised = step_of(table, here.residual, at, low, high, damping)
        done = promised <= least
        trial = at if done else np.clip(at + step, low, high)
        there = problem.linearise(free_parameters.values(trial), here)
        gained = here.cost - there.cost
        if gained > 0.0 and there.finite:
            at, here = trial, there
            damping, growth = damping * _eased(gained, promised), GROWTH
        elif not done:
            damping, growth = damping * growth, growth * GROWTH
        if done and not gained > least:
            break  # nor did initial states, which follow one step behind, gain anything
    return here


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
