"""SI units as powers of the base units."""

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from stickslip.errors import InputError

BASES: Final = ("kg", "m", "s", "A", "K", "rad")
ZEROS: Final = {"degC": "273.15"}
"""Zeros of units that do not count from that of their base units."""
_NAMED: Final[Mapping[str, Mapping[str, int]]] = MappingProxyType(
    {
        **{base: {base: 1} for base in BASES},
        "N": {"kg": 1, "m": 1, "s": -2},
        "Pa": {"kg": 1, "m": -1, "s": -2},
        "J": {"kg": 1, "m": 2, "s": -2},
        "W": {"kg": 1, "m": 2, "s": -3},
        "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
        "Hz": {"s": -1},
        "degC": {"K": 1},
        "1": {},
    }
)
_FACTOR: Final = re.compile(r"(?P<name>[A-Za-z]+|1)(?:\^(?P<power>\d+))?")


def base_units(unit: str) -> dict[str, int]:
    """Return the powers of the base units of an SI unit.

    Examples
    --------
    >>> base_units("N m s/rad")
    {'kg': 1, 'm': 2, 's': -1, 'rad': -1}
    """
    found = dict.fromkeys(BASES, 0)
    for name, power in _factors(unit).items():
        for base, own in _NAMED[name].items():
            found[base] += power * own
    return {base: power for base, power in found.items() if power}


def per_second(unit: str) -> str:
    """Return the unit of a time derivative.

    Examples
    --------
    >>> per_second("m"), per_second("rad/s"), per_second("N m/rad"), per_second("N m s/rad")
    ('m/s', 'rad/s^2', 'N m/(rad s)', 'N m/rad')
    """
    if not unit:
        return ""
    powers = _factors(unit)
    powers["s"] = powers.get("s", 0) - 1
    above, below = (
        [
            name if abs(power) == 1 else f"{name}^{abs(power)}"
            for name, power in powers.items()
            if power * side > 0 and name != "1"
        ]
        for side in (1, -1)
    )
    divisors = f"({' '.join(below)})" if len(below) > 1 else "".join(below)
    return "/".join(filter(None, (" ".join(above) or "1", divisors)))


def _factors(unit: str) -> dict[str, int]:
    """Return the powers of the units that stand in a unit, in their order."""
    found: dict[str, int] = {}
    above, *below = unit.split("/")
    sides = [(above, 1), *((one.removeprefix("(").removesuffix(")"), -1) for one in below)]
    for side, sign in sides:
        for factor in side.split():
            parsed = _FACTOR.fullmatch(factor)
            if parsed is None or parsed["name"] not in _NAMED:
                raise InputError(
                    f"the unit {unit!r} has {factor!r}, which is no SI unit known here."
                )
            name = parsed["name"]
            found[name] = found.get(name, 0) + sign * int(parsed["power"] or 1)
    return found
