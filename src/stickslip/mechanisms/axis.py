"""One servo axis or joint."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.maths import Scalar
from stickslip.mechanisms.base import (
    BoundedMechanism,
    Contact,
    ContactInputs,
    LinearOrRotary,
    Stop,
    gear_inputs,
    stops_between,
)
from stickslip.mechanisms.electric_motor import DCMotor, driving, driving_force, driving_inertia
from stickslip.quantities import Quantity


@final
@dataclass(frozen=True, kw_only=True)
class Axis(LinearOrRotary, BoundedMechanism):
    """An inertia with a drive, a spring and a damper; linear or rotary.

    With the default load of 1, friction levels read as forces [N] or torques [N m].

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.drives import Pulse
    >>> axis = Axis(inertia=2.0, drive=Pulse(level=5.0, duration=1.0))
    >>> run = simulate(axis, Coulomb(kinetic_coefficient=1.0), t_end=10.0)
    >>> round(float(run["x"][-1]), 9)
    5.0
    """

    name: ClassVar[str] = "axis"
    coordinates: ClassVar[tuple[str, ...]] = ("x",)
    rates: ClassVar[tuple[str, ...]] = ("v",)
    moving_part: ClassVar[str] = "axis"

    inertia: Annotated[float, Quantity("J", "kg", above=0, or_unit="kg m^2")]
    """Mass [kg] or moment of inertia [kg m^2]."""
    drive: Drive | DCMotor | None = None
    """Force [N] or torque [N m], or a `DCMotor`, whose rotor adds to the inertia."""
    stiffness: Annotated[float, Quantity("k", "N/m", low=0, or_unit="N m/rad")] = 0.0
    """Spring towards x = 0."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0, or_unit="N m s/rad")] = 0.0
    """Damper to the ground."""
    load: Annotated[float, Quantity("N", "N", low=0)] = 1.0
    """Normal force at the contact, or 1 where levels are forces."""
    offset: Annotated[float, Quantity("o", "N", or_unit="N m")] = 0.0
    """Constant force against the drive: gravity, a cable, a sensor's bias."""
    lower_stop: Annotated[float, Quantity("x_l", "m", or_unit="rad")] | None = None
    """Hard stop that x does not fall below; none if not given."""
    upper_stop: Annotated[float, Quantity("x_u", "m", or_unit="rad")] | None = None
    """Hard stop that x does not rise above; none if not given."""
    restitution: Annotated[float, Quantity("e", low=0, high=1)] = 0.0
    """Speed after an impact at a stop over the speed before; 0 if nothing bounces."""

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        inertia = self.inertia + driving_inertia(self.drive)
        return 0.5 * inertia * q_dot["x"] * q_dot["x"]

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        return 0.5 * self.stiffness * q["x"] * q["x"]

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        force = driving_force(self.drive, drives, q["x"], q_dot["x"])
        return {"x": force - self.damping * q_dot["x"] - self.offset}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", load=self.load),)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        external = -self.stiffness * q["x"] - self.damping * q_dot["x"] - self.offset
        force = driving_force(self.drive, drives, q["x"], q_dot["x"])
        return gear_inputs(force, external, position=q["x"])

    @override
    def stops(self) -> tuple[Stop, ...]:
        return stops_between("x", self.lower_stop, self.upper_stop, self.restitution)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return driving(self.drive)
