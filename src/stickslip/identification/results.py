"""What a fit gives back."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity

__all__ = ["Estimate", "Fit"]


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """One fitted parameter with its doubt."""

    path: str
    """Parameter path, such as ``"friction.kinetic_coefficient"``."""
    quantity: Quantity
    """Symbol and unit."""
    value: float
    """Best value."""
    low: float
    """Lower end of the interval; minus infinity where the data do not bound it."""
    high: float
    """Upper end; infinity where the data do not bound it."""
    interval: str
    """What the interval is: ``"rounding range"``, ``"stated interval"`` or ``"95 %"``."""
    reason: str = ""
    """Why an end is infinite, in words."""

    @property
    def bounded(self) -> bool:
        """Whether the data bound the parameter on both sides."""
        return math.isfinite(self.low) and math.isfinite(self.high)


@dataclass(frozen=True, kw_only=True)
class Fit:
    """A law whose free parameters make a mechanism behave as measured.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, fit
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> result = fit(rig, Coulomb, reading)
    >>> print(f"{result.estimates[0].value:.3f}")
    0.255
    """

    law: FrictionLaw
    """The law with its fitted parameters."""
    mechanism: Mechanism
    """The mechanism as measured first."""
    estimates: tuple[Estimate, ...]
    """The free parameters."""
    measured: tuple[float, ...]
    """Travels [m], one a trial."""
    predicted: tuple[float, ...]
    """Travels of the fitted law [m]."""
    runs: int
    """Simulations spent."""

    def to_law(self) -> FrictionLaw:
        """Return the fitted law."""
        return self.law

    @property
    def residuals(self) -> tuple[float, ...]:
        """Measured less predicted travel [m], one a trial."""
        return tuple(m - p for m, p in zip(self.measured, self.predicted, strict=True))

    def to_dict(self) -> Mapping[str, Any]:
        """Return the fit as plain numbers and strings."""
        return {
            "law": self.law.name,
            "estimates": [
                {
                    "parameter": estimate.path,
                    "symbol": estimate.quantity.symbol,
                    "unit": estimate.quantity.unit,
                    "value": estimate.value,
                    "low": estimate.low if math.isfinite(estimate.low) else None,
                    "high": estimate.high if math.isfinite(estimate.high) else None,
                    "interval": estimate.interval,
                    "reason": estimate.reason,
                }
                for estimate in self.estimates
            ],
            "measured_travel": list(self.measured),
            "predicted_travel": list(self.predicted),
            "runs": self.runs,
        }
