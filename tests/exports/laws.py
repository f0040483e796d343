"""Laws that are exported: all registered ones, whole and fractional exponents, and hostile ones."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, Any, ClassVar, Final, final

from tests.support import UNAIDED, example_of
from typing_extensions import override

from stickslip import LuGre
from stickslip.friction import BristleLaw, FrictionLaw, SetValuedLaw
from stickslip.maths import Scalar, exp, sqrt, tanh, where
from stickslip.quantities import Quantity, fields_of

FRACTIONAL: Final = 1.4


@final
@dataclass(frozen=True, kw_only=True)
class Hostile(SetValuedLaw):
    """Symbols are words of the languages, names of temporaries, or no names at all."""

    name: ClassVar[str] = "hostile"
    title: ClassVar[str] = '*/ --> "quoted" \\'
    formula: ClassVar[str] = "F = */ ??/ --> % \n end"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ()

    a: Annotated[float, Quantity("double", low=0)] = 0.3
    b: Annotated[float, Quantity("end", low=0)] = 0.1
    c: Annotated[float, Quantity("c1", "m/s", above=0)] = 0.05
    d: Annotated[float, Quantity("x0", "N s/m", low=0)] = 0.2
    e: Annotated[float, Quantity("s0", "N s^2/m^2", low=0)] = 0.1
    f: Annotated[float, Quantity("load", low=0)] = 0.05
    g: Annotated[float, Quantity("λ'", "m/s", above=0)] = 0.3
    h: Annotated[float, Quantity("mu *", low=0)] = 0.02

    @override
    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        fading = self.b * exp(-speed / self.c) + self.f / (1.0 + sqrt(speed * speed + 1.0))
        beyond = where(speed < self.g, 0.0, self.h * tanh(speed - self.g))
        return (self.a + fading + beyond) * load + self.d * speed + self.e * speed**2

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return (self.a + self.b + self.f) * load


@final
@dataclass(frozen=True, kw_only=True)
class TwoBristles(BristleLaw):
    """Two elastic elements beside each other, with names that mean something elsewhere."""

    name: ClassVar[str] = "two-bristles"
    title: ClassVar[str] = "Two bristles"
    formula: ClassVar[str] = r"F = (\sigma_a z_a + \sigma_b z_b) N"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ()
    states: ClassVar[tuple[str, ...]] = ("force", "x1")

    soft: Annotated[float, Quantity("sigma_a", "1/m", above=0)] = 200.0
    stiff: Annotated[float, Quantity("sigma_b", "1/m", above=0)] = 3000.0
    level: Annotated[float, Quantity("mu", above=0)] = 0.12

    @override
    def force(self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...] = ()) -> Scalar:
        return (self.soft * states[0] + self.stiff * states[1]) * load

    @override
    def rates(
        self, velocity: Scalar, load: Scalar, states: tuple[Scalar, ...]
    ) -> tuple[Scalar, ...]:
        return tuple(
            velocity - abs(velocity) * stiffness * z / self.level
            for stiffness, z in zip((self.soft, self.stiff), states, strict=True)
        )

    @override
    def steady(self, velocity: Scalar, load: Scalar) -> Scalar:
        return where(velocity < 0.0, -1.0, where(velocity > 0.0, 1.0, 0.0)) * 2 * self.level * load

    @override
    def break_away(self, load: Scalar) -> Scalar:
        return 2.0 * self.level * load


def exported() -> dict[str, FrictionLaw]:
    """Return laws by the names of their programs."""
    found: dict[str, FrictionLaw] = {}
    for name, kind in UNAIDED.items():
        if name == "gms":  # whose functions take latches: see test_memories_in_programs
            continue
        law: Any = example_of(kind)
        key = name.replace("-", "_")
        key = f"{key}_law" if hasattr(math, key) else key  # not the name of a function of C
        found[key] = law
        shapes = [one for one, quantity in fields_of(kind).items() if quantity.structural]
        if shapes:
            found[f"{key}_bent"] = replace(law, **dict.fromkeys(shapes, FRACTIONAL))
    found["hostile"] = Hostile()
    found["two_bristles"] = TwoBristles()
    found["lugre_held"] = replace(example_of(LuGre), static_switch=True)
    return found


LAWS_EXPORTED: Final = exported()
SPEEDS: Final = tuple(10.0 ** (i / 3.0) for i in range(-24, 4))
"""From 1e-8 to 10 m/s: within, across and beyond every layer."""
LOADS: Final = (0.0, 7.0)


def bristle_states(law: FrictionLaw, share: float) -> tuple[float, ...]:
    """Return deflections that carry a share of the friction level."""
    if not law.states:
        return ()
    reach = law.break_away(1.0) / law.force(0.0, 1.0, (1.0,) * len(law.states))
    return (reach * share,) * len(law.states)
