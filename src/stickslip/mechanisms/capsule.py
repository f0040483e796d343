"""A capsule that an inner mass drives."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.maths import Scalar, sin
from stickslip.mechanisms.actuators import IDLE, Motor
from stickslip.mechanisms.base import (
    BoundedMechanism,
    Contact,
    ContactInputs,
    Guide,
    Incline,
    Stop,
    height,
    stops_between,
)
from stickslip.quantities import Quantity


@final
@dataclass(frozen=True, kw_only=True)
class Capsule(BoundedMechanism):
    """A capsule on rough ground with a mass inside that moves along it.

    The place `xi` of the inner mass is counted from the capsule. A spring and a damper hold it,
    and a force between the two drives it, or its motion is prescribed. With stops it strikes the
    capsule, as in vibro-impact capsules, bounces, and rests there while it is pressed. On an
    incline both are pulled towards negative x.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb, simulate
    >>> from stickslip.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    >>> run = simulate(capsule, Coulomb(kinetic_coefficient=0.2), t_end=float(stroke.period))
    >>> round(float(run["x"][-1]), 6)
    0.00643
    """

    name: ClassVar[str] = "capsule"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "xi")
    rates: ClassVar[tuple[str, ...]] = ("v", "xi_dot")
    units: ClassVar[tuple[str, ...]] = ("m", "m")
    moving_part: ClassVar[str] = "capsule"

    capsule_mass: Annotated[float, Quantity("M", "kg", above=0)]
    """Mass of the capsule."""
    inner_mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass inside."""
    drive: Motor = IDLE
    """What moves the inner mass: `Prescribed`, or `Torque` for a force on it [N]."""
    stiffness: Annotated[float, Quantity("k", "N/m", low=0)] = 0.0
    """Spring between the two, free of force at xi = 0."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0)] = 0.0
    """Damper between the two."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""
    incline: Incline = 0.0
    """Angle of the ground from the horizontal; where it is positive, positive x is uphill."""
    lower_stop: Annotated[float, Quantity("xi_l", "m")] | None = None
    """Hard stop that xi does not fall below; none if not given."""
    upper_stop: Annotated[float, Quantity("xi_u", "m")] | None = None
    """Hard stop that xi does not rise above; none if not given."""
    restitution: Annotated[float, Quantity("e", low=0, high=1)] = 0.0
    """Relative speed after an impact over the speed before; 0 if nothing bounces."""

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        inner = q_dot["x"] + q_dot["xi"]
        upward = q_dot["y"] * q_dot["y"]
        capsule = self.capsule_mass * (q_dot["x"] * q_dot["x"] + upward)
        return 0.5 * capsule + 0.5 * self.inner_mass * (inner * inner + upward)

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        capsule = self.capsule_mass * height(self.incline, q["x"], q["y"])
        inner = self.inner_mass * height(self.incline, q["x"] + q["xi"], q["y"])
        return self.gravity * (capsule + inner) + 0.5 * self.stiffness * q["xi"] * q["xi"]

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        return {"xi": self.drive.force(drives) - self.damping * q_dot["xi"]}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", normal="y"),)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        whole = self.capsule_mass + self.inner_mass
        return {"gravity": -whole * self.gravity * sin(self.incline), "position": q["x"]}

    @override
    def stops(self) -> tuple[Stop, ...]:
        return stops_between("xi", self.lower_stop, self.upper_stop, self.restitution)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return self.drive.drives()

    @override
    def start(self) -> Mapping[str, Scalar]:
        return self.drive.start("xi", "xi_dot")

    @override
    def guided(self) -> Mapping[str, Guide]:
        guide = self.drive.guide("force", "N")
        return {} if guide is None else {"xi": guide}

    @override
    def limits(self, forces: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        return self.drive.limits(forces["xi"]) if "xi" in forces else {}
