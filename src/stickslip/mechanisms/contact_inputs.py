"""What friction laws may ask of their contact beside speed and load: names, units, meaning."""

import dataclasses
import math
from collections.abc import Iterable, Mapping
from types import MappingProxyType

from stickslip.errors import UnknownNameError
from stickslip.quantities import Quantity, turned


@dataclasses.dataclass(frozen=True)
class ContactInput:
    """Something that friction may depend on, and that a mechanism or a record can tell."""

    unit: str
    """SI unit of a straight motion; temperatures are in degC."""
    meaning: str
    """What it is, in one sentence."""
    tex: str
    """Symbol in formulas."""
    index: str
    """What stands behind ``_`` in symbols of parameters that go with it."""
    scale: str = ""
    """Size that measurements tell of it, one of `SCALES`; empty if none is."""
    size: float = 1.0
    """Change that may be expected of it where no size is told."""
    low: float = -math.inf
    """Least value; no temperature is below absolute zero."""

    def quantity(self, unit: str = "") -> Quantity:
        """Return symbol, units and range, in its own unit and that of turning unless one is given.

        Examples
        --------
        >>> CONTACT_INPUTS["transmitted"].quantity().or_unit
        'N m'
        """
        other = "" if unit else turned(self.unit)
        return Quantity(
            self.index,
            unit or self.unit,
            low=self.low,
            or_unit=other if other != self.unit else "",
        )

    def over(self, quantity: Quantity) -> Quantity:
        """Return the quantity of a parameter that goes with this input."""
        over = {"": 0, "{0}": -1, "1/{0}": 1, "1/{0}^2": 2}
        power = over[quantity.unit if "{0}" in quantity.unit else ""]
        changes: dict[str, object] = {
            "symbol": quantity.symbol.replace("{0}", self.index),
            # A difference of temperatures is in kelvins.
            "unit": quantity.unit.replace("{0}", "K" if self.unit == "degC" else self.unit),
        }
        # What an expected change of the input does, over its size, is the parameter's.
        if power and quantity.bounds is not None and quantity.start is not None:
            scale = {-1: self.scale, 1: f"/{self.scale}", 2: f"/{self.scale}^2"}[power]
            level = "level" if quantity.scale == "level" else "1" * (power > 0)
            least, most = (bound / self.size**power for bound in quantity.bounds)
            changes |= {
                "scale": f"{level}{scale}" if self.scale else "none",
                "bounds": (least, most),
                "start": quantity.start / self.size**power,
            }
        return dataclasses.replace(quantity, **changes)  # type: ignore[arg-type]  # by name


CONTACT_INPUTS: Mapping[str, ContactInput] = MappingProxyType(
    {
        "motor": ContactInput(
            "N", "Force or torque of the drive, along the motion.", r"\tau_m", "m", "force"
        ),
        "external": ContactInput(
            "N",
            "All other forces or torques along the motion, without inertia and friction.",
            r"\tau_e",
            "e",
            "force",
        ),
        "transmitted": ContactInput(
            "N",
            "Force or torque that a gear between both transmits, motor - external, without inertia:"
            " a motor that holds a weight loads its gear twice with it.",
            r"\tau",
            "t",
            "force",
        ),
        "gravity": ContactInput(
            "N", "Force or torque of gravity, along the motion.", r"\tau_g", "g", "force"
        ),
        "position": ContactInput("m", "Position or angle of what slips.", "x", "x", "", 1.0),
        "temperature": ContactInput(
            "degC", "Temperature of the contact or its lubricant.", "T", "T", "", 10.0, -273.15
        ),
        "pressure": ContactInput(
            "Pa", "Pressure at the contact, as of a seal or a lubricant.", "P", "P", "", 1e5
        ),
    }
)
"""Contact inputs by name; the names are fixed."""
DRIVES = ("transmitted", "motor")
"""Those that have the force of the drive in them: a level grows with their size."""


def checked_inputs(names: Iterable[str]) -> tuple[str, ...]:
    """Return names of contact inputs, or say which known names are nearest.

    Examples
    --------
    >>> checked_inputs(["temprature"])
    Traceback (most recent call last):
    stickslip.errors.UnknownNameError: unknown contact input 'temprature'. Did you mean ...
    """
    result = tuple(names)
    for name in result:
        if name not in CONTACT_INPUTS:
            raise UnknownNameError("contact input", name, CONTACT_INPUTS)
    return result
