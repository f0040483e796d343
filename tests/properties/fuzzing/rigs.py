"""Mechanisms of users: more coordinates, normal forces that move, several drives."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.maths import cos, sin
from stickslip.mechanisms import Contact, Mechanism
from stickslip.mechanisms.drives import Drive
from stickslip.quantities import Quantity

Mass = Annotated[float, Quantity("m", "kg", above=0)]
Gravity = Annotated[float, Quantity("g", "m/s^2", above=0)]


@final
@dataclass(frozen=True, kw_only=True)
class PendulumCart(Mechanism):
    """A cart on the ground, driven by the torque of its pendulum: the load follows the motion."""

    name: ClassVar[str] = "pendulum-cart"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "theta")
    rates: ClassVar[tuple[str, ...]] = ("v", "omega")
    units: ClassVar[tuple[str, ...]] = ("m", "rad")

    mass: Mass
    ball: Mass
    length: Annotated[float, Quantity("l", "m", above=0)]
    torque: Drive | None = None
    gravity: Gravity = 9.81

    @override
    def kinetic_energy(self, q, q_dot):
        u = q_dot["x"] - self.length * cos(q["theta"]) * q_dot["theta"]
        w = q_dot["y"] - self.length * sin(q["theta"]) * q_dot["theta"]
        cart = self.mass * (q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"])
        return 0.5 * (cart + self.ball * (u * u + w * w))

    @override
    def potential_energy(self, t, q):
        height = q["y"] + self.length * cos(q["theta"])
        return self.gravity * (self.mass * q["y"] + self.ball * height)

    @override
    def forces(self, t, q, q_dot, drives):
        return {"theta": drives.get("torque", 0.0)}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", normal="y"),)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.torque is None else {"torque": self.torque}


@final
@dataclass(frozen=True, kw_only=True)
class Chain(Mechanism):
    """A driven mass that pulls a rubbing one through a spring and a damper."""

    name: ClassVar[str] = "chain"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "w")
    rates: ClassVar[tuple[str, ...]] = ("v", "u")
    units: ClassVar[tuple[str, ...]] = ("m", "m")

    mass: Mass
    free: Mass
    stiffness: Annotated[float, Quantity("k", "N/m", above=0)]
    damping: Annotated[float, Quantity("c", "N s/m", low=0)] = 0.0
    load: Annotated[float, Quantity("N", "N", low=0)] = 1.0
    drive: Drive | None = None

    @override
    def kinetic_energy(self, q, q_dot):
        rubbing = self.mass * q_dot["x"] * q_dot["x"]
        return 0.5 * (rubbing + self.free * q_dot["w"] * q_dot["w"])

    @override
    def potential_energy(self, t, q):
        stretch = q["w"] - q["x"]
        return 0.5 * self.stiffness * stretch * stretch

    @override
    def forces(self, t, q, q_dot, drives):
        damper = self.damping * (q_dot["w"] - q_dot["x"])
        return {"x": damper, "w": drives.get("drive", 0.0) - damper}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", load=self.load),)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.drive is None else {"drive": self.drive}


@final
@dataclass(frozen=True, kw_only=True)
class ShakenBlock(Mechanism):
    """A block that one force pushes along and another lifts, up to taking it off the ground."""

    name: ClassVar[str] = "shaken-block"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    units: ClassVar[tuple[str, ...]] = ("m",)

    mass: Mass
    stiffness: Annotated[float, Quantity("k", "N/m", low=0)] = 0.0
    push: Drive | None = None
    lift: Drive | None = None
    gravity: Gravity = 9.81

    @override
    def kinetic_energy(self, q, q_dot):
        return 0.5 * self.mass * (q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"])

    @override
    def potential_energy(self, t, q):
        spring = 0.5 * self.stiffness * q["x"] * q["x"]
        return self.mass * self.gravity * q["y"] + spring

    @override
    def forces(self, t, q, q_dot, drives):
        return {"x": drives.get("push", 0.0), "y": drives.get("lift", 0.0)}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", normal="y"),)

    @override
    def drives(self) -> Mapping[str, Drive]:
        fitted = {"push": self.push, "lift": self.lift}
        return {name: drive for name, drive in fitted.items() if drive is not None}


OWN: Mapping[str, type[Mechanism]] = {
    mechanism.name: mechanism for mechanism in (PendulumCart, Chain, ShakenBlock)
}
"""Mechanisms that are not of the package, by name."""
