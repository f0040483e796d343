"""Residuals that depend on unknowns: what the optimiser is given."""

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.fits.estimation.parameters import FreeParameters

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
