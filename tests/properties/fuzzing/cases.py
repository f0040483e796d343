"""Random cases: any mechanism with any law, filled with numbers of many decades.

What a parameter is, is read off its declaration, so that a law or a mechanism that is added to a
registry is met here without a change.
"""

import dataclasses
import math
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from random import Random
from typing import Any, Literal

from tests.properties.fuzzing.drawing import MAKERS, Sizes, around, draw_drive, sizes
from tests.properties.fuzzing.rigs import OWN, PendulumCart
from tests.support import UNAIDED

from stickslip import EventDriven, simulate
from stickslip.engine import Trajectory
from stickslip.friction import FrictionLaw, Laws, PowerViscous
from stickslip.friction.parts.flows import PLATEAU
from stickslip.mechanisms import MECHANISMS, InnerMass, Mechanism, Motor
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import fields_of

Kinds = tuple[type[Drive], ...]


STOPS = ("lower_stop", "upper_stop")
"""Hard stops have random tests of their own."""


@dataclass(frozen=True, kw_only=True)
class Shape:
    """What shapes the equations of a law, or of a mechanism with its law; numbers do not."""

    law: type[FrictionLaw]
    flags: Mapping[str, bool]
    """Fields that are true or false."""
    given: Mapping[str, bool]
    """Whether a field that may be None has a value."""
    exponent: float | None
    """A whole exponent, or None for any other."""
    drives: Mapping[str, Kinds]


@dataclass(frozen=True, kw_only=True)
class Structure(Shape):
    """What shapes the equations of a case with one contact."""

    mechanism: type[Mechanism]


@dataclass(frozen=True, kw_only=True)
class Case:
    """One call of `simulate`."""

    mechanism: Mechanism
    law: FrictionLaw | Laws
    t_end: float
    y0: Mapping[str, float]

    @property
    def title(self) -> str:
        """Mechanism and law in words, and whether rigid bodies with friction can jam."""
        words = f"{self.mechanism.name} {len(self.laws)}"
        if len(self.contact_names) == 1:
            words = f"{self.mechanism.name} {self.laws[self.contact_names[0]].name}"
        return words + " paradox" if self.may_jam else words

    @property
    def contact_names(self) -> tuple[str, ...]:
        """Names of the contacts of the mechanism."""
        return tuple(contact.name for contact in self.mechanism.contacts())

    @property
    def laws(self) -> dict[str, FrictionLaw]:
        """Law of each contact that rubs."""
        if isinstance(self.law, Laws):
            return dict(self.law.members)
        return dict.fromkeys(self.contact_names, self.law)

    @property
    def has_bristles(self) -> bool:
        """Whether friction can give energy back."""
        return any(law.states for law in self.laws.values())

    @property
    def may_jam(self) -> bool:
        """Whether somewhere the cart's M + m s^2 - mu s c m, s and c of its angle, is not positive.

        This is the paradox of Painleve: no acceleration, or more than one, belongs to such a state.
        """
        if not isinstance(self.mechanism, PendulumCart):
            return len(self.laws) > 1 and any(c.normal for c in self.mechanism.contacts())
        M, m = self.mechanism.mass, self.mechanism.ball
        bristles = self.law.states
        mu = max(level_of(self.law, 1.0, side) for side in (1, -1))
        return bristles or mu * m >= 2.0 * math.sqrt(M * (M + m))


def _fields(kind: type) -> dict[str, Any]:
    hints = typing.get_type_hints(kind)
    return {field.name: hints[field.name] for field in dataclasses.fields(kind)}


def _is_drive(hint: Any) -> bool:
    return Drive in (hint, *typing.get_args(hint))


FUZZED = [
    kind
    for kind in MECHANISMS.values()
    if not {Motor, InnerMass} & {*_fields(kind).values()} and not kind.contact_names
]
"""Those with one contact and without motors; of carts with a pendulum that of users is drawn."""


def draw_structure(rng: Random) -> Structure:
    """Return what shapes the equations of a case with one contact."""
    mechanism = rng.choice([*FUZZED, *OWN.values()])
    law = rng.choice(list(UNAIDED.values()))
    return Structure(mechanism=mechanism, **vars(draw_shape(rng, law, mechanism)))


def draw_shape(rng: Random, law: type[FrictionLaw], *others: type) -> Shape:
    """Return what shapes the equations of a law, and of a mechanism if one is given."""
    flags, given, drives = {}, {}, {}
    for kind in (*others, law):
        for name, hint in _fields(kind).items():
            if hint is bool:
                flags[name] = rng.random() < 0.3
            elif typing.get_origin(hint) is Literal:
                flags[name] = rng.choice(typing.get_args(hint))
            elif _is_drive(hint):
                count = rng.choice((0, 1, 1, 1, 1, 2))
                kinds = [drive for drive in MAKERS if drive.adds or count < 2]
                drives[name] = tuple(rng.choice(kinds) for _ in range(count))
            elif type(None) in typing.get_args(hint):
                given[name] = rng.random() < 0.5 and name not in STOPS
    return Shape(
        law=law, flags=flags, given=given, exponent=rng.choice((1.0, 2.0, None)), drives=drives
    )


MAY_VANISH = ("N/m", "N s/m", "N s^2/m^2", "s/m", "1", "N", "m")
"""Units whose numbers are sometimes 0 where their range allows it."""


def _number(rng: Random, name: str, kind: type, size: Sizes, known: Mapping[str, Any]) -> float:
    """Return a value for a declared quantity."""
    quantity = fields_of(kind)[name]
    if 0.0 < quantity.high <= 1.0:
        least = 0.0 if quantity.above is None else 0.1
        return quantity.high * rng.choice((least, 0.5, 1.0))
    if quantity.unit == "m/s^2":
        return 9.81
    value = size.draw(rng, quantity.unit, 3.0 if quantity.unit in ("m/s", "1/m", "s/m") else 0.7)
    can_vanish = quantity.above is None and quantity.low <= 0 and quantity.unit in MAY_VANISH
    can_vanish = can_vanish and quantity.at_least is None
    if can_vanish and rng.random() < (0.4 if quantity.unit in ("N s/m", "m") else 0.1):
        return 0.0
    if quantity.unit == "N" and quantity.low == 0:
        return size.load
    if quantity.low < 0.0 and quantity.above is None:
        value = max(quantity.low, min(value, quantity.high)) * rng.choice((-1.0, 1.0))
    if quantity.at_least is not None:
        value = known[quantity.at_least] + rng.choice((0.0, 0.1, 1.0)) * value
    return value


def draw_law(rng: Random, structure: Shape, size: Sizes) -> FrictionLaw:
    """Return a law of a shape with numbers of a size."""
    values: dict[str, Any] = {}
    for name in _fields(structure.law):
        quantity = fields_of(structure.law).get(name)
        if quantity is None:
            values[name] = structure.flags[name]
        elif quantity.structural:
            fraction = rng.choice((0.5, 0.7, 1.5, rng.uniform(0.2, 4.0)))
            exponent = fraction if structure.exponent is None else structure.exponent
            values[name] = min(max(exponent, quantity.low), quantity.high)
        elif structure.given.get(name, True):
            values[name] = _number(rng, name, structure.law, size, values)
    return structure.law(**values)


def _mechanism(rng: Random, structure: Structure, size: Sizes, force: float, t_end: float) -> Any:
    kind = structure.mechanism
    values: dict[str, Any] = {}
    for name in _fields(kind):
        if name in structure.drives:
            torque = size.length if name == "torque" else 1.0
            kinds = structure.drives[name]
            values[name] = draw_drive(rng, kinds, force * torque, size.time, t_end)
        elif name in structure.flags:
            values[name] = structure.flags[name]
        elif structure.given.get(name, True):
            values[name] = _number(rng, name, kind, size, values)
    if "compression" in values:  # a spring that pushes or lies loose, but is there
        values["compression"] *= 10.0 ** rng.uniform(0.0, 1.0)
        values["stiffness"] = values["stiffness"] or size.stiffness
    return kind(**values)


def level_of(law: FrictionLaw, load: float, direction: int = 1) -> float:
    """Return the break-away level [N] of a direction."""
    return float(law.towards(direction).break_away(load))


def full_deflection(law: FrictionLaw) -> float:
    """Return the deflection [m] of bristles that carry what breaks away."""
    return level_of(law, 1.0) / float(law.force(0.0, 1.0, (1.0,) * len(law.states)))


STARTS = ("rest", "rest", "rest", "tiny", "usual", "usual", "large")


def _factors(rng: Random) -> dict[str, float]:
    return {"tiny": rng.choice((1e-9, 1e-15, 1e-150)), "usual": 3.0, "large": 1e3, "guard": 1.0}


def factor_of_start(rng: Random) -> float:
    """Return by how much initial states are larger than usual, 0 at rest."""
    how = rng.choice(STARTS)
    return 0.0 if how == "rest" else _factors(rng)[how]


def _start(rng: Random, mechanism: Mechanism, law: FrictionLaw, size: Sizes) -> dict[str, float]:
    """Return an initial state: rest, tiny, usual, large, or exactly on a guard."""
    how = rng.choice((*STARTS, "guard"))
    if how == "rest":
        return {}
    factor = _factors(rng)
    speed, slip = size.of("m/s"), mechanism.rates[0]
    start: dict[str, float] = {}
    if how == "guard":
        start[mechanism.coordinates[0]] = getattr(mechanism, "compression", size.length)
        layer = getattr(law, "stribeck_velocity", None)
        if layer is not None and rng.random() < 0.5:
            start[slip] = layer * 36.0 ** (1.0 / getattr(law, "fading_exponent", 2.0))
        elif isinstance(law, PowerViscous):
            start[slip] = PLATEAU
    else:
        for name, unit in zip(mechanism.coordinates, mechanism.units, strict=True):
            start[name] = rng.choice((0.0, rng.uniform(-1, 1) * factor[how] * size.of(unit)))
        for name, unit in zip(mechanism.rates, mechanism.units, strict=True):
            rate = speed if unit == "m" else 1.0 / size.time
            start[name] = rng.choice((0.0, 1.0, 1.0)) * rng.uniform(-1, 1) * factor[how] * rate
    for name in law.states:
        start[name] = full_deflection(law) * rng.choice((0.0, 1.0, -1.0, rng.uniform(-1, 1)))
    return start


def draw_case(rng: Random, structure: Structure) -> Case:
    """Return a case of a structure."""
    size = sizes(rng)
    law = draw_law(rng, structure, size)
    t_end = min(max(around(rng, 10.0 * size.time, 1.0, 0.7), 1e-4), 1e4)
    force = level_of(law, size.load) or size.force
    mechanism = _mechanism(rng, structure, size, force, t_end)
    return Case(mechanism=mechanism, law=law, t_end=t_end, y0=_start(rng, mechanism, law, size))


def run_case(case: Case, solver: EventDriven) -> Trajectory:
    """Simulate a case, whatever comes of it."""
    return simulate(
        case.mechanism, case.law, t_end=case.t_end, y0=case.y0, solver=solver, throw=False
    )
