"""A problem that is linear in its unknowns, whose answers are textbook formulas."""

from collections.abc import Sequence
from typing import final

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.fits.levenberg_marquardt import ResidualJacobian
from stickslip.identify.fits.parameters import FreeParameter, FreeParameters
from stickslip.quantities import Quantity

Array = NDArray[np.float64]


@final
class Linear:
    """Measured less table times values."""

    def __init__(
        self,
        table: Array,
        measured: Array,
        *,
        start: Sequence[float],
        bounds: tuple[float, float] = (-np.inf, np.inf),
        fails: bool = False,
    ) -> None:
        self.table, self.measured, self.fails = table, measured, fails
        self.visited: list[Array] = []
        self._unknowns = FreeParameters(
            tuple(
                FreeParameter(
                    path=f"friction.p{i}",
                    quantity=Quantity(f"p_{i}"),
                    start=value,
                    low=bounds[0],
                    high=bounds[1],
                )
                for i, value in enumerate(start)
            )
        )

    @property
    def free_parameters(self) -> FreeParameters:
        return self._unknowns

    def linearise(self, values: Array, near: ResidualJacobian | None = None) -> ResidualJacobian:
        self.visited.append(np.array(values))
        residual = self.measured - self.table @ values
        return ResidualJacobian(
            values=np.array(values),
            residual=np.full_like(residual, np.inf) if self.fails else residual,
            slopes=self.table,
        )
