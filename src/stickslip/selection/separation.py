"""Which further measurement would tell the candidates apart: found by simulating it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from stickslip.errors import StickslipError
from stickslip.friction import FrictionLaw
from stickslip.identification.travel import TravelModel, Trial
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary

__all__ = ["Separation", "knob_of", "separations"]

FACTORS = (0.4, 0.6, 0.8, 1.0, 1.25, 1.5)
"""Settings tried, over the present one: what a rig can usually be set to."""
KNOBS = ("mechanism.compression", "mechanism.drive.level", "mechanism.drive.amplitude")
"""Parameters an experimenter can turn, in the order of ease."""


@dataclass(frozen=True, kw_only=True)
class Separation:
    """One setting of the rig and the travel each fitted law predicts for it."""

    path: str
    """Parameter to set."""
    symbol: str
    unit: str
    value: float
    """Setting, SI."""
    predicted: Mapping[str, float]
    """Travel [m] by law."""

    def gap(self, one: str, other: str) -> float:
        """Return the difference of two predictions [m]."""
        return abs(self.predicted[one] - self.predicted[other])

    @property
    def spread(self) -> float:
        """Largest difference of two predictions [m]."""
        return max(self.predicted.values()) - min(self.predicted.values())

    def to_dict(self) -> Mapping[str, Any]:
        """Return the separation as plain numbers and strings."""
        return {"set": {self.path: self.value}, "predicted_travel": dict(self.predicted)}


def knob_of(mechanism: Mechanism) -> tuple[str, str, str, float] | None:
    """Return path, symbol, unit and value of the parameter that is easiest to turn."""
    known = {
        path: (q.symbol, q.unit, value) for path, q, value in parameters(mechanism, "mechanism")
    }
    for path in KNOBS:
        if path in known and known[path][2] != 0:
            return path, *known[path]
    return None


def separations(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw],
    *,
    t_end: float,
    factors: Sequence[float] = FACTORS,
) -> tuple[Separation, ...]:
    """Predict the travel of each law at other settings of the rig, in the order of the setting."""
    knob = knob_of(mechanism)
    if knob is None or not laws:
        return ()
    path, symbol, unit, value = knob
    found = []
    for factor in factors:
        setting = float(f"{value * factor:.3g}")
        changed = vary(mechanism, "mechanism", {path: setting})
        trial = Trial(mechanism=changed, initial={}, travel=0.0, half_width=0.0)
        try:
            predicted = {
                name: TravelModel(law, (), t_end).travel(trial, ()) for name, law in laws.items()
            }
        except StickslipError:
            continue
        found.append(
            Separation(path=path, symbol=symbol, unit=unit, value=setting, predicted=predicted)
        )
    return tuple(found)
