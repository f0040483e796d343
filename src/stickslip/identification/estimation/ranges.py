"""Where fits look for the parameters of a law: its quantities' ranges, times measured sizes."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.quantities import Quantity, fields_of

DECADES = 1e3
"""Factor by which a parameter without a range may leave its given value."""
LEVELS = frozenset({"level", "level+", "level-", "force", "stiffness"})
"""Sizes that grow with friction."""


@dataclass(frozen=True, kw_only=True)
class Range:
    """Start value and bounds of a parameter, in its unit; bounds of a surplus where it has one."""

    start: float
    """Start value."""
    low: float
    """Lower bound."""
    high: float
    """Upper bound."""


@dataclass(frozen=True, kw_only=True)
class Sizes:
    """What a measurement says of the sizes of `stickslip.quantities.SCALES` [SI], by name."""

    typical: Mapping[str, float]
    """What start values are multiples of."""
    reach: Mapping[str, float]
    """What bounds are multiples of."""

    def of(self, quantity: Quantity) -> Range:
        """Return start value and bounds of a parameter.

        Examples
        --------
        >>> v_s = Quantity("v_s", "m/s", above=0, scale="speed", bounds=(1e-3, 1.0), start=0.1)
        >>> Sizes(typical={"speed": 0.5}, reach={"speed": 2.0}).of(v_s)
        Range(start=0.05, low=0.002, high=2.0)
        """
        assert quantity.bounds is not None
        assert quantity.start is not None
        reach = quantity.scaled_by(self.reach)
        low, high = (reach * bound for bound in quantity.bounds)
        start = quantity.start * quantity.scaled_by(self.typical)
        if quantity.at_least is None:
            low, high = max(low, quantity.low), min(high, quantity.high)
        return Range(start=start, low=low, high=high)


def is_level(quantity: Quantity) -> bool:
    """Whether a parameter grows with friction as a whole: a level, a force or a stiffness.

    Examples
    --------
    >>> from stickslip import LuGre
    >>> [name for name, quantity in fields_of(LuGre).items() if is_level(quantity)]
    ['kinetic_coefficient', 'static_coefficient', 'bristle_stiffness']
    """
    return any(name in LEVELS and power == 1 for name, power in quantity.powers.items())


def with_ranges(law: FrictionLaw | type[FrictionLaw], name: str) -> Quantity:
    """Return a parameter of a law, with a range: its own, or one about the value that is given.

    Examples
    --------
    >>> from stickslip import Stribeck
    >>> with_ranges(Stribeck, "stribeck_velocity").bounds
    (0.001, 1.0)
    """
    kind = law if isinstance(law, type) else type(law)
    quantity = fields_of(kind)[name]
    if quantity.scale:
        return quantity
    value = None if isinstance(law, type) else getattr(law, name)
    if not value:
        raise InputError(_without_range(kind, name, quantity))
    size = DECADES * abs(value)
    low = abs(value) / DECADES if quantity.above is not None else max(quantity.low, -size)
    above = quantity.at_least is not None
    return replace(
        quantity,
        scale="none",
        bounds=(0.0 if above else low, size if above else min(size, quantity.high)),
        start=float(value),
    )


def _without_range(kind: type[FrictionLaw], name: str, quantity: Quantity) -> str:
    limits = "".join(
        f", {side}={value:g}"
        for side, value in (("above", quantity.above), ("low", quantity.low))
        if value is not None and math.isfinite(value)
    )
    unit = "" if quantity.unit == "1" else f', "{quantity.unit}"'
    usual = {
        "1": 'scale="level", bounds=(0.0, 100.0), start=1.0',
        "m/s": 'scale="speed", bounds=(1e-3, 1.0), start=0.1',
        "N s/m": 'scale="slope", bounds=(0.0, 100.0), start=1.0',
        "1/m": 'scale="stiffness", bounds=(1e-2, 1e3), start=1.0',
    }
    text = usual.get(quantity.unit, 'scale="none", bounds=(LOW, HIGH), start=VALUE')
    return (
        f"{kind.__name__}.{name} ({quantity.symbol}) has no search range: complete its"
        f' Quantity, such as Quantity("{quantity.symbol}"{unit}{limits}, {text}), where bounds and'
        ' start are multiples of the scale as measured, or values with scale="none"; or give an'
        f" instance of {kind.__name__}, whose values other than 0 are the start."
    )
