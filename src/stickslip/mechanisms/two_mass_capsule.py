"""A capsule that two inner masses drive."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.maths import Scalar, cos, sin
from stickslip.mechanisms.actuators import DRIVE, IDLE, Motor
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
from stickslip.mechanisms.capsule import SoftStop, soft_stops
from stickslip.quantities import Parametrised, Quantity


@final
@dataclass(frozen=True, kw_only=True)
class InnerMass(Parametrised):
    """A mass that moves along a straight line in a capsule.

    Examples
    --------
    >>> InnerMass(mass=0.02, stiffness=60.0).angle
    0.0
    """

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Its mass."""
    angle: Annotated[float, Quantity("alpha", "rad")] = 0.0
    """Angle of its line from the ground: pi/2 is upwards."""
    drive: Motor = IDLE
    """What moves it: `Prescribed`, or `Torque` for a force between it and the capsule [N]."""
    stiffness: Annotated[float, Quantity("k", "N/m", low=0)] = 0.0
    """Spring to the capsule, free of force in the middle."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0)] = 0.0
    """Damper to the capsule."""
    lower_stop: Annotated[float, Quantity("xi_l", "m")] | None = None
    """Hard stop below; none if not given."""
    upper_stop: Annotated[float, Quantity("xi_u", "m")] | None = None
    """Hard stop above; none if not given."""
    restitution: Annotated[float, Quantity("e", low=0, high=1)] = 0.0
    """Relative speed after an impact over the speed before."""
    lower_soft_stop: SoftStop | None = None
    """Elastic stop below; none if not given."""
    upper_soft_stop: SoftStop | None = None
    """Elastic stop above; none if not given."""

    def soft_stops(self, whose: str) -> list[tuple[SoftStop, int, tuple[str, str]]]:
        """Return the elastic stops with their sides and the names of their events."""
        return soft_stops(self.lower_soft_stop, self.upper_soft_stop, f"{whose} mass ")


@final
@dataclass(frozen=True, kw_only=True)
class TwoMassCapsule(BoundedMechanism):
    """A capsule on rough ground with two masses inside.

    The places `xi` and `zeta` of both are counted from the capsule, each along its own line. One
    that moves upwards changes the normal force: of two that move at right angles, one loosens the
    capsule while the other pushes it on. A run ends where the capsule lifts off.

    Examples
    --------
    Two masses that are one do what the inner mass of a `Capsule` does:

    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.drives import ThreePhase
    >>> from stickslip.mechanisms import InnerMass, Prescribed
    >>> stroke = Prescribed(profile=ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow"))
    >>> half = InnerMass(mass=0.1, drive=stroke)
    >>> capsule = TwoMassCapsule(capsule_mass=0.8, first=half, second=half)
    >>> run = simulate(capsule, Coulomb(kinetic_coefficient=0.2), t_end=stroke.profile.period)
    >>> round(float(run["x"][-1]), 6)
    0.00643
    """

    name: ClassVar[str] = "two-mass-capsule"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "xi", "zeta")
    rates: ClassVar[tuple[str, ...]] = ("v", "xi_dot", "zeta_dot")
    units: ClassVar[tuple[str, ...]] = ("m", "m", "m")
    moving_part: ClassVar[str] = "capsule"

    capsule_mass: Annotated[float, Quantity("M", "kg", above=0)]
    """Mass of the capsule."""
    first: InnerMass
    """The mass at `xi`."""
    second: InnerMass
    """The mass at `zeta`."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""
    incline: Incline = 0.0
    """Angle of the ground from the horizontal; where it is positive, positive x is uphill."""
    squeeze: Annotated[float, Quantity("F_h", "N", low=0)] = 0.0
    """Force beside the weight that presses it on its ground, as the hoop stress of a bowel."""

    def _inner(self) -> Iterator[tuple[str, str, str, InnerMass]]:
        """Yield both masses with their names, coordinates and rates."""
        yield "first", "xi", "xi_dot", self.first
        yield "second", "zeta", "zeta_dot", self.second

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        v, w = q_dot["x"], q_dot["y"]
        found = 0.5 * self.capsule_mass * (v * v + w * w)
        for _, place, _, one in self._inner():
            along = v + cos(one.angle) * q_dot[place]
            up = w + sin(one.angle) * q_dot[place]
            found = found + 0.5 * one.mass * (along * along + up * up)
        return found

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        x, y = q["x"], q["y"]
        found = self.gravity * self.capsule_mass * height(self.incline, x, y) + self.squeeze * y
        for name, place, _, one in self._inner():
            along, up = x + cos(one.angle) * q[place], y + sin(one.angle) * q[place]
            found = found + self.gravity * one.mass * height(self.incline, along, up)
            found = found + 0.5 * one.stiffness * q[place] * q[place]
            for stop, side, events in one.soft_stops(name):
                found = found + stop.energy(q[place], side, events)
        return found

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        found: dict[str, Scalar] = {}
        for name, place, _, one in self._inner():
            own = {DRIVE: drives[motor]} if (motor := f"{name}_{DRIVE}") in drives else {}
            force = one.drive.force(own) - one.damping * q_dot[place]
            for stop, side, events in one.soft_stops(name):
                force = force + stop.damper_force(q[place], q_dot[place], side, events)
            found[place] = force
        return found

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
        mass = self.capsule_mass + self.first.mass + self.second.mass
        return {"gravity": -mass * self.gravity * sin(self.incline), "position": q["x"]}

    @override
    def stops(self) -> tuple[Stop, ...]:
        return tuple(
            stop
            for _, place, _, one in self._inner()
            for stop in stops_between(place, one.lower_stop, one.upper_stop, one.restitution)
        )

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {
            f"{name}_{motor}": drive
            for name, _, _, one in self._inner()
            for motor, drive in one.drive.drives().items()
        }

    @override
    def start(self) -> Mapping[str, Scalar]:
        return {
            key: value
            for _, place, rate, one in self._inner()
            for key, value in one.drive.start(place, rate).items()
        }

    @override
    def guided(self) -> Mapping[str, Guide]:
        found = {}
        for name, place, _, one in self._inner():
            guide = one.drive.guide(f"{name}_force", "N")
            if guide is not None:
                drive = f"{name}_{guide.drive}"
                found[place] = Guide(drive=drive, effort=guide.effort, unit=guide.unit)
        return found

    @override
    def limits(self, forces: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        return {
            f"{name} {event}": margin
            for name, place, _, one in self._inner()
            if place in forces
            for event, margin in one.drive.limits(forces[place]).items()
        }
