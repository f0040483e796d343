"""Two axes that know nothing of each other: what several contacts do, each does alone."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from stickslip import Axis, Coulomb, Mechanism
from stickslip.mechanisms import Contact
from stickslip.mechanisms.drives import Drive, Sine
from stickslip.quantities import Quantity


@dataclass(frozen=True, kw_only=True)
class Pair(Mechanism):
    """Two axes of 1 kg, with springs and drives of their own."""

    name: ClassVar[str] = "pair"
    coordinates: ClassVar[tuple[str, ...]] = ("a", "b")
    rates: ClassVar[tuple[str, ...]] = ("a_dot", "b_dot")
    units: ClassVar[tuple[str, ...]] = ("m", "m")
    stiffness: Annotated[float, Quantity("k", "N/m", low=0)] = 0.0
    left_drive: Drive | None = None
    right_drive: Drive | None = None

    def kinetic_energy(self, q, q_dot):
        return 0.5 * (q_dot["a"] * q_dot["a"] + q_dot["b"] * q_dot["b"])

    def potential_energy(self, t, q):
        return 0.5 * self.stiffness * (q["a"] * q["a"] + q["b"] * q["b"])

    def forces(self, t, q, q_dot, drives):
        return {"a": drives.get("left_drive", 0.0), "b": drives.get("right_drive", 0.0)}

    def contacts(self):
        return (Contact(name="left", slip="a", load=1.0), Contact(name="right", slip="b", load=1.0))

    def drives(self):
        given = {"left_drive": self.left_drive, "right_drive": self.right_drive}
        return {name: drive for name, drive in given.items() if drive is not None}


PUSH = Sine(amplitude=4.0, frequency=1.0) + Sine(amplitude=3.0, frequency=2.0, phase=1.0)
"""A drive that brings an axis forwards."""
LAW = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
OTHER = Coulomb(kinetic_coefficient=0.6, static_coefficient=0.8)
LAWS = {"left": LAW, "right": OTHER}


def axis(drive=None, stiffness=0.0):
    """Return one of the two axes."""
    return Axis(inertia=1.0, stiffness=stiffness, drive=drive)
