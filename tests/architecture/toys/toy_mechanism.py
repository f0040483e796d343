"""A mechanism as a contributor would write it: a slab that a weight on a cord pulls."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.maths import Scalar
from stickslip.mechanisms.base import Contact, Mechanism
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import Quantity


@final
@dataclass(frozen=True, kw_only=True)
class ToySlab(Mechanism):
    """A slab on a table, pulled by a hanging weight over a pulley."""

    name: ClassVar[str] = "toy-slab"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the slab."""
    weight: Annotated[float, Quantity("m_w", "kg", above=0)]
    """Mass that hangs."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        slab = self.mass * (q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"])
        return 0.5 * (slab + self.weight * q_dot["x"] * q_dot["x"])

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        return self.gravity * (self.mass * q["y"] - self.weight * q["x"])

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return {}

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", normal="y"),)
