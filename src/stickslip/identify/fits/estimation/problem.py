"""A record as residuals that depend on unknowns: what every route gives to the optimiser."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, Protocol, Self

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.trajectory import Trajectory
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


class Problem(ABC):
    """Residuals of one or several records as a function of unknowns, segment by segment."""

    free_parameters: FreeParameters
    """What is looked for."""

    @property
    @abstractmethod
    def spans(self) -> Array:
        """Record, first and last time of each segment (segments, 3)."""

    @property
    @abstractmethod
    def quantity(self) -> str:
        """Name of what the residuals are of, as in `QUANTITIES`."""

    @property
    @abstractmethod
    def times(self) -> Array:
        """Time of each row (n,) [s]."""

    @abstractmethod
    def linearise(
        self,
        values: Array,
        near: ResidualJacobian | None = None,
        *,
        only: Sequence[int] | None = None,
        slopes: bool = True,
    ) -> ResidualJacobian:
        """Return what predictions with values (p,) leave, and their slopes; of some segments.

        Slopes are not looked at where they are not asked for.
        """


class RecordProblem(Problem):
    """A problem whose rows are samples of a record, which predictions stand beside."""

    @property
    @abstractmethod
    def measured(self) -> Array:
        """What was measured of the quantity compared, of each row (n,)."""

    @property
    @abstractmethod
    def variation(self) -> float:
        """Sum of squares of what a law is to explain: of what was measured, less what is free."""

    @property
    def simulates(self) -> bool:
        """Whether motion is predicted from its start; else friction along the measured motion."""
        return False

    def runs(self, seen: ResidualJacobian) -> tuple[Trajectory, ...]:
        """Return the segments simulated again from their fitted states, each with its certificate.

        Times of a run count from the start of its segment. There are none along measured motion.
        """
        return ()

    @abstractmethod
    def with_free_parameters(self, free_parameters: FreeParameters) -> Self:
        """Return the same with other bounds or start values of the unknowns."""

    @abstractmethod
    def carried(self, seen: ResidualJacobian) -> Array:
        """Return the residuals (n,) at the values, and from the local states, of an answer.

        The answer may be that of the same record with another mechanism: the local states stay
        where they are, so that the difference of the residuals is smooth in what was changed.
        """
