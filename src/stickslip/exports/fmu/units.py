"""SI units as powers of the base units."""

import re
from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from stickslip.errors import InputError

__all__ = ["BASES", "base_units"]

BASES: Final = ("kg", "m", "s", "A", "K", "rad")
_NAMED: Final[Mapping[str, Mapping[str, int]]] = MappingProxyType(
    {
        **{base: {base: 1} for base in BASES},
        "N": {"kg": 1, "m": 1, "s": -2},
        "Pa": {"kg": 1, "m": -1, "s": -2},
        "J": {"kg": 1, "m": 2, "s": -2},
        "W": {"kg": 1, "m": 2, "s": -3},
        "V": {"kg": 1, "m": 2, "s": -3, "A": -1},
        "Hz": {"s": -1},
        "1": {},
    }
)
_FACTOR: Final = re.compile(r"(?P<name>[A-Za-z]+|1)(?:\^(?P<power>\d+))?")


def base_units(unit: str) -> dict[str, int]:
    """Return the powers of the base units of an SI unit.

    Parameters
    ----------
    unit : str
        Unit as quantities have it: factors separated by spaces, and one solidus at most, behind
        which all factors are divisors.

    Returns
    -------
    dict of str to int
        Powers by base unit, without those that are 0.

    Raises
    ------
    InputError
        If the unit is not of this form.

    Examples
    --------
    >>> base_units("N m s/rad")
    {'kg': 1, 'm': 2, 's': -1, 'rad': -1}
    """
    found = dict.fromkeys(BASES, 0)
    above, _, below = unit.partition("/")
    for side, sign in ((above, 1), (below, -1)):
        for factor in side.split():
            parsed = _FACTOR.fullmatch(factor)
            if parsed is None or parsed["name"] not in _NAMED:
                raise InputError(
                    f"the unit {unit!r} has {factor!r}, which is no SI unit known here."
                )
            for base, power in _NAMED[parsed["name"]].items():
                found[base] += sign * power * int(parsed["power"] or 1)
    return {base: power for base, power in found.items() if power}
