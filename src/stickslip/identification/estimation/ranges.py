"""Where fits look for the parameters of a law: its quantities' ranges, times measured sizes."""

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.quantities import Quantity, fields_of, vary

DECADES = 1e3
"""Factor by which a parameter without a range may leave its given value."""
LEVELS = frozenset({"level", "level+", "level-", "force", "stiffness"})
"""Sizes that grow with friction."""

ORDINARY = {
    "level": 0.25,
    "level+": 0.25,
    "level-": 0.25,
    "slope": 0.5 / 9.81,
    "slope+": 0.5 / 9.81,
    "slope-": 0.5 / 9.81,
    "drag": 1.0 / 9.81,
    "speed": 0.5,
    "displacement": 0.25e-3,
    "stiffness": 1e3,
    "damping": 10.0,
}
"""Dry metal on metal; slopes and drag are over the load. Bristles give way by 0.25 mm."""
SURPLUS_AT_REST = 0.4
"""What a level has over that which it does not fall below, over the latter."""


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


def required_of(law: type[FrictionLaw]) -> tuple[str, ...]:
    """Return the names of the parameters that a law cannot do without.

    Examples
    --------
    >>> from stickslip import Dahl
    >>> required_of(Dahl)
    ('kinetic_coefficient', 'bristle_stiffness')
    """
    fields = law.__dataclass_fields__
    return tuple(name for name in fields_of(law) if fields[name].default is dataclasses.MISSING)


def starting_law(law: type[FrictionLaw], load: float = 1.0) -> FrictionLaw:
    """Return a law of that type with ordinary values for each parameter it needs.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> starting_law(Coulomb)
    Coulomb(kinetic_coefficient=0.25, static_coefficient=None)
    """
    per_load = ("slope", "slope+", "slope-", "drag")
    typical = ORDINARY | {name: ORDINARY[name] * load for name in per_load}
    typical |= {"load": load, "force": ORDINARY["level"] * load}
    sizes = Sizes(typical=typical, reach=typical)
    values: dict[str, Any] = {}
    for name in required_of(law):
        quantity = with_ranges(law, name)
        values[name] = sizes.of(quantity).start
        if quantity.at_least in values:
            values[name] = values[quantity.at_least] * (1.0 + SURPLUS_AT_REST)
    return law(**values)


def with_known(law: FrictionLaw, known: Mapping[str, float] | None) -> FrictionLaw:
    """Return a law with the values that are known, by name.

    Examples
    --------
    >>> from stickslip import Viscous
    >>> with_known(Viscous(viscous_coefficient=1.0), {"viscous_coefficient": 30.0})
    Viscous(viscous_coefficient=30.0)
    """
    return vary(law, "friction", {f"friction.{name}": v for name, v in (known or {}).items()})
