"""Mechanisms with several contacts, and the reference numbers of their motions.

Reference numbers come from two methods that agree: closed forms, 80-bit Taylor series, or SciPy at
1e-13 with bordered matrices and enumerated modes.
"""

import math
from dataclasses import dataclass, replace
from functools import partial
from typing import Annotated, ClassVar

import numpy as np

from stickslip import BlockChain, Coulomb
from stickslip.maths import cos, sin
from stickslip.mechanisms import Contact, Mechanism
from stickslip.mechanisms.drives import Drive, Sampled
from stickslip.quantities import Quantity


def coulomb(kinetic, static=None):
    """Return Coulomb's law by its levels."""
    return Coulomb(
        kinetic_coefficient=kinetic, static_coefficient=kinetic if static is None else static
    )


def level(i):
    """Return the fraction that spreads the levels of the chains."""
    return round((0.6180339887498949 * i) % 1, 4)


class Plain(Mechanism):
    """A mechanism without forces and drives unless it says so."""

    def potential_energy(self, t, q):
        return 0.0

    def forces(self, t, q, q_dot, drives):
        return {}

    def drives(self):
        return {}


@dataclass(frozen=True, kw_only=True)
class Chain(BlockChain):
    """Blocks in a row whose contacts are called as their places."""

    name: ClassVar[str] = "chain"

    def contacts(self):
        return tuple(replace(contact, name=contact.slip) for contact in super().contacts())

    def contact_inputs(self, t, q, q_dot, drives):
        inputs = super().contact_inputs(t, q, q_dot, drives).values()
        return dict(zip(self.coordinates, inputs, strict=True))


def chain(n):
    """Return what makes a row of n blocks of 1 kg."""
    return partial(Chain, blocks=n, mass=1.0, coupling=0.0)


def decay(n):
    """Return mechanism, laws and start of n coupled blocks that come to rest."""
    laws = {f"x{i}": coulomb(1.0 + 0.2 * level(i)) for i in range(1, n + 1)}
    start = {f"v{i}": round(3 * math.sin(1.7 * i), 4) for i in range(1, n + 1)}
    return chain(n)(coupling=100.0, stiffness=10.0), laws, start


def belt(n):
    """Return mechanism and laws of n coupled blocks that a belt carries along."""
    laws = {f"x{i}": coulomb(0.7, 1.0 + 0.2 * level(i)) for i in range(1, n + 1)}
    return chain(n)(coupling=4.0, stiffness=1.0, speed=0.1), laws


@dataclass(frozen=True, kw_only=True)
class Clutches(Plain):
    """Four inertias in a row, coupled by three clutches, in relative angles."""

    name: ClassVar[str] = "clutches"
    coordinates: ClassVar[tuple[str, ...]] = ("phi", "r1", "r2", "r3")
    rates: ClassVar[tuple[str, ...]] = ("w", "u1", "u2", "u3")
    units: ClassVar[tuple[str, ...]] = ("rad",) * 4
    inertia: Annotated[float, Quantity("J", "kg m^2", above=0)] = 1.0
    level: Annotated[float, Quantity("A", "N m")] = 10.0
    press: Annotated[float, Quantity("F", "N")] = 20.0
    second: Drive
    third: Drive

    def kinetic_energy(self, q, q_dot):
        rate, total = 0.0, 0.0
        for i in self.coordinates:
            rate = rate + q_dot[i]
            total = total + rate * rate
        return 0.5 * self.inertia * total

    def forces(self, t, q, q_dot, drives):
        return {"phi": self.level * sin(10.0 * math.pi * t)}

    def contacts(self):
        return tuple(Contact(slip=f"r{i}", name=f"clutch-{i}") for i in (1, 2, 3))

    def loads(self, t, q, q_dot, drives):
        return {
            "clutch-1": self.press * cos(0.4 * math.pi * t),
            "clutch-2": drives["second"],
            "clutch-3": drives["third"],
        }

    def drives(self):
        return {"second": self.second, "third": self.third}


@dataclass(frozen=True, kw_only=True)
class Arm(Plain):
    """Two links of equal length, each with its mass at the end, in a vertical plane."""

    name: ClassVar[str] = "arm"
    coordinates: ClassVar[tuple[str, ...]] = ("shoulder", "elbow")
    rates: ClassVar[tuple[str, ...]] = ("shoulder_dot", "elbow_dot")
    units: ClassVar[tuple[str, ...]] = ("rad", "rad")
    upper_mass: Annotated[float, Quantity("m_1", "kg", above=0)] = 1.0
    lower_mass: Annotated[float, Quantity("m_2", "kg", above=0)] = 0.5
    length: Annotated[float, Quantity("l", "m", above=0)] = 0.4
    gravity: Annotated[float, Quantity("g", "m/s^2")] = 9.81

    def kinetic_energy(self, q, q_dot):
        u = self.length * q_dot["shoulder"]
        w = self.length * (q_dot["shoulder"] + q_dot["elbow"])
        lower = u * u + w * w + 2.0 * u * w * cos(q["elbow"])
        return 0.5 * (self.upper_mass * u * u + self.lower_mass * lower)

    def potential_energy(self, t, q):
        upper = -self.length * cos(q["shoulder"])
        lower = upper - self.length * cos(q["shoulder"] + q["elbow"])
        return self.gravity * (self.upper_mass * upper + self.lower_mass * lower)

    def contacts(self):
        return tuple(Contact(slip=i, load=1.0, name=i) for i in self.coordinates)


@dataclass(frozen=True, kw_only=True)
class RubbingCart(Plain):
    """A cart whose wheels rub, under their reaction, with a pendulum whose pivot rubs."""

    name: ClassVar[str] = "rubbing-cart"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "theta")
    rates: ClassVar[tuple[str, ...]] = ("v", "omega")
    units: ClassVar[tuple[str, ...]] = ("m", "rad")
    cart_mass: Annotated[float, Quantity("M", "kg", above=0)] = 0.5
    ball_mass: Annotated[float, Quantity("m", "kg", above=0)] = 0.2
    length: Annotated[float, Quantity("l", "m", above=0)] = 0.3
    gravity: Annotated[float, Quantity("g", "m/s^2")] = 9.81

    def kinetic_energy(self, q, q_dot):
        along = q_dot["x"] + self.length * cos(q["theta"]) * q_dot["theta"]
        up = q_dot["y"] + self.length * sin(q["theta"]) * q_dot["theta"]
        cart = q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"]
        return 0.5 * (self.cart_mass * cart + self.ball_mass * (along * along + up * up))

    def potential_energy(self, t, q):
        weight = (self.cart_mass + self.ball_mass) * self.gravity
        return weight * q["y"] - self.ball_mass * self.gravity * self.length * cos(q["theta"])

    def contacts(self):
        return (
            Contact(slip="x", normal="y", name="wheels"),
            Contact(slip="theta", load=1.0, name="pivot"),
        )

    def held(self):
        return ("y",)


FEET = {"mass": 2.0, "front": 0.3, "rear": 0.2, "height": 0.15, "stiffness": 50.0}
"""Numbers of a body on two feet that a spring pulls."""


@dataclass(frozen=True, kw_only=True)
class Disc(Plain):
    """A disc between two pads at different radii, with a torque that grows."""

    name: ClassVar[str] = "disc"
    coordinates: ClassVar[tuple[str, ...]] = ("phi",)
    rates: ClassVar[tuple[str, ...]] = ("omega",)
    units: ClassVar[tuple[str, ...]] = ("rad",)
    inertia: Annotated[float, Quantity("J", "kg m^2", above=0)] = 0.5
    inner_radius: Annotated[float, Quantity("r_i", "m")] = 0.10
    outer_radius: Annotated[float, Quantity("r_o", "m")] = 0.12
    slope: Annotated[float, Quantity("s", "N m/s")] = 1.5

    def kinetic_energy(self, q, q_dot):
        return 0.5 * self.inertia * q_dot["phi"] * q_dot["phi"]

    def forces(self, t, q, q_dot, drives):
        return {"phi": self.slope * t}

    def contacts(self):
        return (
            Contact(slip={"phi": self.inner_radius}, load=100.0, name="inner"),
            Contact(slip={"phi": self.outer_radius}, load=80.0, name="outer"),
        )


def clutches():
    """Return mechanism, laws and start of three clutches that close one after the other."""
    pressed = (Sampled(times=(0.0, t), values=(0.0, 20.0)) for t in (0.4, 0.9))
    laws = {f"clutch-{i}": coulomb(0.5, 0.55) for i in (1, 2, 3)}
    mechanism = Clutches(**dict(zip(("second", "third"), pressed, strict=True)))
    return mechanism, laws, {"w": 10.0, "u1": -10.0}


def plates(n):
    """Return the class of a stack of n plates, each rubbing on the one below, and its start."""
    names = tuple(f"r{i}" for i in range(1, n + 1))

    @dataclass(frozen=True, kw_only=True)
    class Plates(Plain):
        """A stack of plates, in relative places."""

        name: ClassVar[str] = f"plates-{n}"
        coordinates: ClassVar[tuple[str, ...]] = names
        rates: ClassVar[tuple[str, ...]] = tuple(f"u{i}" for i in range(1, n + 1))
        units: ClassVar[tuple[str, ...]] = ("m",) * n
        mass: Annotated[float, Quantity("m", "kg", above=0)] = 1.0
        stiffness: Annotated[float, Quantity("k", "N/m")] = 20.0
        gravity: Annotated[float, Quantity("g", "m/s^2")] = 9.81

        def kinetic_energy(self, q, q_dot):
            total, rate = 0.0, 0.0
            for i in names:
                rate = rate + q_dot[i]
                total = total + 0.5 * self.mass * rate * rate
            return total

        def potential_energy(self, t, q):
            total, place = 0.0, 0.0
            for i in names:
                place = place + q[i]
                total = total + 0.5 * self.stiffness * place * place
            return total

        def contacts(self):
            weight = self.mass * self.gravity
            return tuple(
                Contact(slip=i, load=weight * (n - k), name=i) for k, i in enumerate(names)
            )

    absolute = np.round(3 * np.sin(1.7 * np.arange(1, n + 1)), 4)
    relative = np.diff(np.concatenate([[0.0], absolute]))
    laws = {f"r{i + 1}": coulomb(0.1 + 0.05 * ((i * 0.618) % 1), 0.2) for i in range(n)}
    return Plates(), laws, {f"u{i + 1}": float(u) for i, u in enumerate(relative)}
