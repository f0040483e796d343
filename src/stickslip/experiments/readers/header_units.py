"""Units that stand in the names of columns, and the kinds of units that a quantity has."""

import re
from collections.abc import Mapping
from typing import Final

from stickslip.experiments.measurement import QUANTITIES, is_beside, unit_of_input
from stickslip.units import CELSIUS, is_of

UNITS: Final[Mapping[str, tuple[str, ...]]] = {
    "time": ("s",),
    "current": ("A",),
    "friction": ("N", "N m", "1"),
    **{
        name: tuple(filter(None, (QUANTITIES[name].unit, QUANTITIES[name].or_unit)))
        for name in ("position", "velocity", "force", "load", "reference")
    },
    "temperature": (CELSIUS,),
}
"""Kinds of units of each quantity."""
STYLES: Final = (
    re.compile(r"(?P<name>.*?)\s*[\[(<{](?P<unit>[^\[\]()<>{}]+)[\])>}]\s*"),
    re.compile(r"(?P<name>.+?)\s+in\s+(?P<unit>\S.*)"),
    re.compile(r"(?P<name>.+?)\s*/\s*(?P<unit>\S.*)"),
    re.compile(r"[\[(<{](?P<unit>[^\[\]()<>{}]+)[\])>}]\s*(?P<name>.+)"),
    re.compile(r"(?P<name>[^\[(]+?)\s*[\[(](?P<unit>[^\[\](),;]+)[\]),;].+"),
    re.compile(r"(?P<name>.+)[_ ,.;:-](?P<unit>[^\s_]+)"),
)
"""How headers carry units: Weg [mm], Weg (mm), Weg in mm, Weg / mm, [mm] Weg, Weg_mm."""
SURE: Final = 3
"""Of these, the first that hold whatever the unit is; in the others it may be any word."""
LONGEST_HEADER: Final = 300
"""Characters of a header up to which a unit is sought in it: that takes their square."""


def is_unit_of(unit: str, quantity: str) -> bool:
    """Whether a unit is of a kind that a quantity has.

    Examples
    --------
    >>> is_unit_of("rpm", "velocity"), is_unit_of("1/min", "velocity"), is_unit_of("V", "velocity")
    (True, True, False)
    """
    return any(is_of(unit, kind) for kind in _kinds(quantity))


def _kinds(quantity: str) -> tuple[str, ...]:
    first = quantity.partition(".")[0]
    if first in UNITS:
        return UNITS[first]
    if is_beside(quantity):
        return (unit_of_input(first), unit_of_input(first, turning=True))
    known = QUANTITIES.get(first)
    return () if known is None else tuple(filter(None, (known.unit, known.or_unit)))


def stated_unit(header: str, quantity: str) -> str | None:
    """Return the unit that the header of a quantity's column carries, if it is one of its kind.

    Examples
    --------
    >>> stated_unit("Velocity (mm/s)", "velocity"), stated_unit("Velocity (raw)", "velocity")
    ('mm/s', None)
    """
    found = _surely(header)
    return next(
        (one["unit"].strip() for one in found if is_unit_of(one["unit"].strip(), quantity)), None
    )


def without_unit(header: str) -> str:
    """Return a header without the unit in brackets, or behind a slash, that ends it.

    Examples
    --------
    >>> without_unit("Velocity (mm/s)"), without_unit("Weg / mm"), without_unit("Weg")
    ('Velocity', 'Weg', 'Weg')
    """
    return next((one["name"].strip() for one in _surely(header)), header.strip())


def _surely(header: str) -> list[re.Match[str]]:
    if len(header) > LONGEST_HEADER:
        return []
    return [one for style in STYLES[:SURE] if (one := style.fullmatch(header))]
