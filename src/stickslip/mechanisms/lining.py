"""Friction linings: what brakes and clutches press on each other."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Annotated, TypeVar, final

from stickslip.drives import Drive
from stickslip.errors import ParameterError
from stickslip.maths import Scalar
from stickslip.mechanisms.base import Contact
from stickslip.quantities import Parametrised, Quantity

T = TypeVar("T")


@final
@dataclass(frozen=True, kw_only=True)
class Lining(Parametrised):
    """A friction lining: the pad of a brake, or the lining of a clutch.

    It rubs at a radius, so that its slip velocity is in m/s and its friction in N. A clutch with
    several faces has their number times the pressing force.

    Examples
    --------
    >>> from stickslip.drives import Ramp
    >>> pad = Lining(radius=0.12, press=Ramp(rate=50.0))
    >>> pad.press.value(2.0)
    100.0
    """

    radius: Annotated[float, Quantity("r", "m", above=0)]
    """Effective radius."""
    load: Annotated[float, Quantity("N", "N", low=0)] = 0.0
    """Constant part of the pressing force."""
    press: Drive | None = None
    """Pressing force beside the load [N]; while both together are not above 0, nothing rubs."""

    def contact(self, coordinate: str, name: str) -> Contact:
        """Return the contact of a lining.

        Parameters
        ----------
        coordinate : str
            Angle that turns at the lining.
        name : str
            Name of the contact.

        Returns
        -------
        Contact
            Its slip velocity is the radius times the rate of the angle.
        """
        return Contact(slip={coordinate: self.radius}, load=self.load, name=name)


def pressing_drives(linings: Mapping[str, Lining]) -> dict[str, Drive]:
    """Return the drives that press linings, by the names of these."""
    return {name: one.press for name, one in linings.items() if one.press is not None}


def pressing_forces(
    linings: Mapping[str, Lining], drives: Mapping[str, Scalar]
) -> dict[str, Scalar]:
    """Return the pressing forces [N] that change."""
    return {name: one.load + drives[name] for name, one in linings.items() if one.press is not None}


def checked_parts(owner: str, kind: type[T], parts: object, least: int) -> tuple[T, ...]:
    """Return the parts of a mechanism as a tuple; refuse those of another kind, or too few."""
    found = tuple(parts) if isinstance(parts, Iterable) else (parts,)
    if len(found) < least or not all(isinstance(one, kind) for one in found):
        raise ParameterError(
            f"{owner} must be at least {least} of {kind.__name__}(...) in a tuple, got {parts!r}."
        )
    return found
