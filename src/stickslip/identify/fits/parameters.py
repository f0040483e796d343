"""What a fit looks for: parameters with bounds and units, and how the optimiser sees them."""

import dataclasses
import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.quantities import Quantity, fields_of, parameters, shadow, turned, vary

Array = NDArray[np.float64]

WIDE = 100.0
"""How far bounds lie from the size that is given, or that a record suggests."""
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
OFFSET = "measurement.offset.force."
"""Path of the constant force of a joint, before its name."""
MOVED = 1e-5
"""Share of its size by which a parameter is moved for slopes."""


@dataclass(frozen=True, kw_only=True)
class Range:
    """Start value and bounds of a parameter, in its unit; bounds of a surplus where it has one."""

    start: float
    """Start value."""
    low: float
    """Lower bound."""
    high: float
    """Upper bound."""

    @classmethod
    def of(cls, quantity: Quantity, sizes: Mapping[str, float]) -> "Range":
        """Return that of a parameter, by the sizes of `stickslip.quantities.SCALES` [SI].

        Examples
        --------
        >>> v_s = Quantity("v_s", "m/s", above=0, scale="speed", bounds=(1e-3, 1.0), start=0.1)
        >>> Range.of(v_s, {"speed": 0.5})
        Range(start=0.05, low=0.0005, high=0.5)
        """
        assert quantity.bounds is not None
        assert quantity.start is not None
        size = quantity.scaled_by(sizes)
        low, high = (size * bound for bound in quantity.bounds)
        if quantity.at_least is None:
            low, high = max(low, quantity.low), min(high, quantity.high)
        return cls(start=quantity.start * size, low=low, high=high)


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
    size = WIDE * abs(value)
    low = abs(value) / WIDE if quantity.above is not None else max(quantity.low, -size)
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


def refuse_open(law: type[FrictionLaw], settled: Collection[str]) -> None:
    """Refuse a law of which a parameter that it needs is neither varied nor given, by name.

    Examples
    --------
    >>> from stickslip import CoulombViscous
    >>> refuse_open(CoulombViscous, ["viscous_coefficient"])
    Traceback (most recent call last):
    stickslip.errors.InputError: CoulombViscous.kinetic_coefficient (mu_k) is neither varied ...
    """
    for name in required_of(law):
        if name not in settled:
            raise InputError(
                f"{law.__name__}.{name} ({fields_of(law)[name].symbol}) is neither varied"
                f" nor fixed: add it to vary, or give its value, fixed={{{name!r}: ...}}."
            )


def starting_law(
    law: type[FrictionLaw], load: float = 1.0, known: Mapping[str, float] | None = None
) -> FrictionLaw:
    """Return a law of that type with values of each parameter it needs: known, else ordinary ones.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> starting_law(Coulomb)
    Coulomb(kinetic_coefficient=0.25, static_coefficient=None)
    """
    per_load = ("slope", "slope+", "slope-", "drag")
    typical = ORDINARY | {name: ORDINARY[name] * load for name in per_load}
    typical |= {"load": load, "force": ORDINARY["level"] * load}
    values: dict[str, Any] = dict(known or {})
    for name in required_of(law):
        if name in values:
            continue
        quantity = with_ranges(law, name)
        values[name] = Range.of(quantity, typical).start
        if quantity.at_least in values:
            values[name] = values[quantity.at_least] * (1.0 + SURPLUS_AT_REST)
    return law(**values)


def with_known(law: FrictionLaw, known: Mapping[str, float] | None) -> FrictionLaw:
    """Return a law with the values that are known, by name, and others that keep its inequalities.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> with_known(Coulomb(kinetic_coefficient=0.3), {"static_coefficient": 0.21})
    Coulomb(kinetic_coefficient=0.15, static_coefficient=0.21)
    """
    values = dict(known or {})
    for name, value in (known or {}).items():
        base = fields_of(type(law))[name].at_least
        if base is not None and base not in values and getattr(law, base) > value:
            values[base] = value / (1.0 + SURPLUS_AT_REST)
    return vary(law, "friction", {f"friction.{name}": v for name, v in values.items()})


@dataclass(frozen=True, kw_only=True)
class FreeParameter:
    """One parameter that runs look for; the optimiser sees its logarithm if `log`."""

    path: str
    """Parameter path."""
    quantity: Quantity
    """Symbol and unit."""
    start: float
    """Start value."""
    low: float = -math.inf
    """Least value looked at."""
    high: float = math.inf
    """Largest value looked at."""
    log: bool = False
    """Whether its order of magnitude is what is looked for."""
    size: float = 0.0
    """Usual size of one that may be next to 0, a share of which moves it for slopes."""

    def limits(self) -> tuple[float, float]:
        """Return the bounds as the optimiser sees them."""
        if not self.log:
            return self.low, self.high
        return (math.log(self.low) if self.low > 0.0 else -math.inf), (
            math.log(self.high) if self.high > 0.0 else math.inf
        )


def not_whole(item: FreeParameter, value: float) -> float:
    """Return a value; next to it if it is a whole exponent, which has no slope.

    Whole exponents shape the equations.
    """
    whole = item.quantity.structural and value.is_integer()
    return value * (1.0 + 0.1 * MOVED) if whole else value


@dataclass(frozen=True)
class FreeParameters:
    """The unknowns of runs in order, and the way between values and coordinates.

    Examples
    --------
    >>> from stickslip.quantities import Quantity
    >>> level = FreeParameter(
    ...     path="friction.kinetic_coefficient", quantity=Quantity("mu_k"), start=2.0
    ... )
    >>> speed = FreeParameter(
    ...     path="friction.stribeck_velocity", quantity=Quantity("v_s", "m/s"), start=1.0, log=True
    ... )
    >>> both = FreeParameters((level, speed))
    >>> both.coordinates(both.start)
    array([2., 0.])
    """

    items: tuple[FreeParameter, ...]
    """The free parameters, in the order of all arrays (p,)."""

    def __len__(self) -> int:
        return len(self.items)

    @property
    def paths(self) -> tuple[str, ...]:
        """Paths in order."""
        return tuple(item.path for item in self.items)

    @property
    def start(self) -> Array:
        """Start values (p,)."""
        return np.array([item.start for item in self.items])

    @property
    def logs(self) -> NDArray[np.bool_]:
        """Whether the optimiser sees logarithms (p,)."""
        return np.array([item.log for item in self.items], dtype=bool)

    def starting_at(self, values: Sequence[float] | Array) -> "FreeParameters":
        """Return the same unknowns with other start values (p,)."""
        items = (replace(item, start=float(v)) for item, v in zip(self.items, values, strict=True))
        return replace(self, items=tuple(items))

    def limits(self) -> tuple[Array, Array]:
        """Return the bounds of the coordinates (p,), (p,)."""
        pairs = np.array([item.limits() for item in self.items]).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    def coordinates(self, values: Array) -> Array:
        """Return what the optimiser sees (p,), inside the bounds."""
        logs = np.log(np.maximum(np.where(self.logs, values, 1.0), 1e-300))
        return np.clip(np.where(self.logs, logs, values), *self.limits())

    def values(self, coordinates: Array) -> Array:
        """Return parameter values (p,) for coordinates."""
        return np.where(self.logs, self._exponentials(coordinates), coordinates)

    def slopes(self, coordinates: Array) -> Array:
        """Return the derivative of each value by its coordinate (p,)."""
        return np.where(self.logs, self._exponentials(coordinates), 1.0)

    def _exponentials(self, coordinates: Array) -> Array:
        return np.exp(np.minimum(np.where(self.logs, coordinates, 0.0), 700.0))


def unit_of(path: str, quantity: Quantity, *, per_load: bool, turning: bool) -> str:
    """Return the unit of a parameter where motion is straight, or about an axis."""
    if path.startswith("friction."):
        return quantity.unit_at(per_load=per_load, turning=turning)
    if path.startswith("mechanism."):  # these say which other unit they have about an axis
        return (turning and quantity.or_unit) or quantity.unit
    return turned(quantity.unit, turning)


def as_level(quantity: Quantity) -> Quantity:
    """Return a quantity with the symbol of a force or torque, if it is one and no coefficient.

    Examples
    --------
    >>> as_level(Quantity("mu_k", "N")).symbol, as_level(Quantity("mu_s", "N m")).symbol
    ('F_c', 'T_s')
    >>> as_level(Quantity("mu_k")).symbol
    'mu_k'
    """
    letter = {"N": "F", "N m": "T"}.get(quantity.unit)
    if letter is None:
        return quantity
    symbol = quantity.symbol.replace("mu_k", f"{letter}_c").replace("mu_", f"{letter}_")
    return replace(quantity, symbol=symbol)


def with_arrays(law: FrictionLaw, table: Mapping[str, Array]) -> Any:
    """Return a law with arrays (copies,) for some of its parameters, by path.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> both = with_arrays(
    ...     Coulomb(kinetic_coefficient=0.5),
    ...     {"friction.kinetic_coefficient": np.array([0.5, 0.6])},
    ... )
    >>> both.force(np.array([[0.1]]), 10.0)
    array([[5., 6.]])
    """
    known = {path: value for path, _, value in parameters(law, "friction")}
    # a whole exponent is part of the equations' shape and would not be replaced
    whole = {path: float(v[0]) * (1.0 + 1e-12) for path, v in table.items() if path not in known}
    return shadow(
        vary(law, "friction", whole), "friction", lambda path: table.get(path, known.get(path))
    )
