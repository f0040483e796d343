"""A pendulum whose pivot rubs."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.maths import Scalar, cos, sin
from stickslip.mechanisms.base import Contact, ContactInputs, Mechanism, gear_inputs
from stickslip.mechanisms.electric_motor import DCMotor, driving, driving_force, driving_inertia
from stickslip.quantities import Quantity


@final
@dataclass(frozen=True, kw_only=True)
class Pendulum(Mechanism):
    """A hanging pendulum with friction in its pivot.

    The angle `theta` is counted from below, or from the zero of an encoder (`rest_angle`). With
    the default load of 1, friction levels read as torques [N m] at the pivot.

    Examples
    --------
    >>> from stickslip import Coulomb, Pendulum, simulate
    >>> clock = Pendulum(mass=0.2, length=0.5)
    >>> run = simulate(clock, Coulomb(kinetic_coefficient=0.02), t_end=60.0, y0={"theta": 0.5})
    >>> run.status.name
    'AT_REST'
    """

    name: ClassVar[str] = "pendulum"
    coordinates: ClassVar[tuple[str, ...]] = ("theta",)
    rates: ClassVar[tuple[str, ...]] = ("omega",)
    units: ClassVar[tuple[str, ...]] = ("rad",)
    moving_part: ClassVar[str] = "pendulum"

    mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the bob."""
    length: Annotated[float, Quantity("l", "m", above=0)]
    """Distance of the bob from the pivot."""
    inertia: Annotated[float, Quantity("J", "kg m^2", low=0)] = 0.0
    """Moment of inertia of what turns beside the bob, about the pivot."""
    drive: Drive | DCMotor | None = None
    """Torque [N m], or a `DCMotor`, whose rotor adds to the inertia."""
    damping: Annotated[float, Quantity("c", "N m s/rad", low=0)] = 0.0
    """Damper at the pivot."""
    load: Annotated[float, Quantity("N", low=0)] = 1.0
    """Load of the friction law: 1 where levels are torques."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""
    rest_angle: Annotated[float, Quantity("theta_0", "rad")] | None = None
    """Angle at which the pendulum hangs; it is counted from there if not given."""

    def _leaning(self, q: Mapping[str, Scalar]) -> Scalar:
        """Return the angle from where it hangs."""
        return q["theta"] if self.rest_angle is None else q["theta"] - self.rest_angle

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        inertia = self.mass * self.length * self.length + self.inertia
        inertia = inertia + driving_inertia(self.drive)
        return 0.5 * inertia * q_dot["theta"] * q_dot["theta"]

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        return self.mass * self.gravity * self.length * (1.0 - cos(self._leaning(q)))

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        torque = driving_force(self.drive, drives, q["theta"], q_dot["theta"])
        return {"theta": torque - self.damping * q_dot["theta"]}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="theta", load=self.load),)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        weight = -self.mass * self.gravity * self.length * sin(self._leaning(q))
        return gear_inputs(
            driving_force(self.drive, drives, q["theta"], q_dot["theta"]),
            weight - self.damping * q_dot["theta"],
            gravity=weight,
            position=q["theta"],
        )

    @override
    def drives(self) -> Mapping[str, Drive]:
        return driving(self.drive)
