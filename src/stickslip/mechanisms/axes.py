"""Axes and joints with one motor: stiff, with something that gives, and a pendulum."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

from typing_extensions import override

from stickslip.errors import ParameterError
from stickslip.maths import Scalar, cos, sin
from stickslip.mechanisms import base
from stickslip.mechanisms.drives import Drive
from stickslip.mechanisms.electric_motor import DCMotor, driving, driving_force, driving_inertia
from stickslip.quantities import Quantity

# One servo axis or joint.


@dataclass(frozen=True, kw_only=True)
class Axis(base.LinearOrRotary, base.BoundedMechanism):
    """An inertia with a drive, a spring and a damper; linear or rotary.

    With the default load of 1, friction levels read as forces [N] or torques [N m].

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.mechanisms.drives import Pulse
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
    def contacts(self) -> tuple[base.Contact, ...]:
        return (base.Contact(slip="x", load=self.load),)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
        external = -self.stiffness * q["x"] - self.damping * q_dot["x"] - self.offset
        force = driving_force(self.drive, drives, q["x"], q_dot["x"])
        return base.gear_inputs(force, external, position=q["x"])

    @override
    def stops(self) -> tuple[base.Stop, ...]:
        return base.stops_between("x", self.lower_stop, self.upper_stop, self.restitution)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return driving(self.drive)


# An axis under a continuous PID loop, as a mechanism: its hunting has orbits and branches.
#
# A mechanism has no states but coordinates, their rates, and bristles. The integral part w of the
# loop is the rate of a second coordinate p of inertia 1, on which the error acts as a force:
#
#     J v' = K_p (r - x) + w - K_d v + f(t) - F
#     w'   = K_i (r - x)                          p' = w
#
# so that the equations stay linear between events, and are solved as exactly as any other; during
# a long phase of sticking w is a straight line. Nothing depends on p: it is left out of the
# unknowns of an orbit like the place of a capsule, and comes back if the mean of w is 0.


@dataclass(frozen=True, kw_only=True)
class PIDAxis(base.LinearOrRotary):
    """An inertia whose position is controlled by a PID loop without samples; linear or rotary.

    States are `x`, `v`, the integral part `integral_part` of the command [N] or [N m], and its
    integral `impulse`. With the default load of 1, friction levels read as forces [N] or torques
    [N m]. `closed_loop` with `PID` is the same loop with samples.

    References
    ----------
    R. H. A. Hensen, M. J. G. van de Molengraft and M. Steinbuch, Friction induced hunting limit
    cycles: a comparison between the LuGre and switch friction model, Automatica 39 (2003)
    2131-2137.

    Examples
    --------
    Static friction above sliding friction makes it hunt about its target:

    >>> from stickslip import Coulomb
    >>> from stickslip.study.sweep import periodic_orbit
    >>> axis = PIDAxis(
    ...     inertia=1.0, proportional=100.0, integral=300.0, derivative=20.0, reference=0.1
    ... )
    >>> hunting = periodic_orbit(axis, Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5))
    >>> round(hunting.period, 5), round(hunting.sticking[""], 4), hunting.stable
    (7.6415, 0.8904, True)
    """

    name: ClassVar[str] = "pid-axis"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "impulse")
    rates: ClassVar[tuple[str, ...]] = ("v", "integral_part")
    moving_part: ClassVar[str] = "axis"
    computed: ClassVar[frozenset[str]] = frozenset({"impulse"})

    inertia: Annotated[float, Quantity("J", "kg", above=0, or_unit="kg m^2")]
    """Mass [kg] or moment of inertia [kg m^2]."""
    proportional: Annotated[float, Quantity("K_p", "N/m", low=0, or_unit="N m/rad")]
    """Command per error."""
    integral: Annotated[float, Quantity("K_i", "N/(m s)", low=0, or_unit="N m/(rad s)")]
    """Command per error and second."""
    derivative: Annotated[float, Quantity("K_d", "N s/m", low=0, or_unit="N m s/rad")] = 0.0
    """Command against the speed."""
    reference: Annotated[float, Quantity("r", "m", or_unit="rad")] = 0.0
    """Where to be."""
    drive: Drive | None = None
    """Force [N] or torque [N m] beside that of the loop: a disturbance, a feedforward."""
    load: Annotated[float, Quantity("N", "N", low=0)] = 1.0
    """Normal force at the contact, or 1 where levels are forces."""

    @property
    @override
    def units(self) -> tuple[str, ...]:  # type: ignore[override]
        return ("rad", "N m s") if self.rotary else ("m", "N s")

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        v, part = q_dot["x"], q_dot["impulse"]
        return 0.5 * (self.inertia * v * v + part * part)

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        return 0.0 * q["x"]

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        error = self.reference - q["x"]
        loop = self.proportional * error + q_dot["impulse"] - self.derivative * q_dot["x"]
        return {"x": loop + drives.get("drive", 0.0), "impulse": self.integral * error}

    @override
    def contacts(self) -> tuple[base.Contact, ...]:
        return (base.Contact(slip="x", load=self.load),)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.drive is None else {"drive": self.drive}


# An axis whose motor and load are joined by something that gives.


@dataclass(frozen=True, kw_only=True)
class TwoMassAxis(base.LinearOrRotary):
    """A motor that drives a load through a spring and a damper: a belt, a shaft, a screw.

    Where one of the two rubs, `x` is the place of that one and `other` that of the other. Where
    both do, `x` is the place of the load and the contacts are `load` and `motor`. Linear or rotary;
    with the default load of 1, friction levels read as forces [N] or torques [N m]. Behind a gear
    or a pulley, inertias, stiffness and levels are those that act on one side.

    Examples
    --------
    >>> from stickslip import Coulomb, TwoMassAxis, simulate
    >>> from stickslip.mechanisms.drives import Pulse
    >>> axis = TwoMassAxis(
    ...     motor_inertia=0.5,
    ...     load_inertia=1.5,
    ...     stiffness=1e4,
    ...     damping=20.0,
    ...     drive=Pulse(level=5.0, duration=1.0),
    ... )
    >>> run = simulate(axis, Coulomb(kinetic_coefficient=1.0), t_end=10.0)
    >>> round(float(run["x"][-1]), 2)  # the rigid axis of 2 kg stops at 5 m
    5.0
    """

    name: ClassVar[str] = "two-mass-axis"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "other")
    rates: ClassVar[tuple[str, ...]] = ("v", "other_dot")
    moving_part: ClassVar[str] = "axis"
    contact_names: ClassVar[str] = "load, motor (with rubs = both)"

    motor_inertia: Annotated[float, Quantity("J_m", "kg", above=0, or_unit="kg m^2")]
    """Mass [kg] or moment of inertia [kg m^2] on the motor's side."""
    load_inertia: Annotated[float, Quantity("J_l", "kg", above=0, or_unit="kg m^2")]
    """The same on the load's side."""
    stiffness: Annotated[float, Quantity("k", "N/m", above=0, or_unit="N m/rad")]
    """Stiffness of what joins them."""
    damping: Annotated[float, Quantity("c", "N s/m", low=0, or_unit="N m s/rad")] = 0.0
    """Damper beside it."""
    drive: Drive | DCMotor | None = None
    """Force [N] or torque [N m] on the motor's side, or a `DCMotor` there, whose rotor adds to its
    inertia."""
    rubs: Literal["load", "motor", "both"] = "load"
    """Which side has the friction."""
    load: Annotated[float, Quantity("N", "N", low=0)] = 1.0
    """Normal force at each contact, or 1 where levels are forces."""
    offset: Annotated[float, Quantity("o", "N", or_unit="N m")] = 0.0
    """Constant force against motion of the load: gravity, a cable."""

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.rubs not in ("load", "motor", "both"):
            raise ParameterError(
                f"TwoMassAxis.rubs must be 'load', 'motor' or 'both', got {self.rubs!r}."
            )

    @property
    def _sides(self) -> tuple[str, str]:
        """Coordinates of motor and load."""
        return ("x", "other") if self.rubs == "motor" else ("other", "x")

    @property
    def motor_side(self) -> str:
        """Coordinate of the motor."""
        return self._sides[0]

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        motor, load = (q_dot[side] for side in self._sides)
        inertia = self.motor_inertia + driving_inertia(self.drive)
        return 0.5 * (inertia * motor * motor + self.load_inertia * load * load)

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        stretch = q["x"] - q["other"]
        return 0.5 * self.stiffness * stretch * stretch

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        motor, load = self._sides
        damped = self.damping * (q_dot[motor] - q_dot[load])
        force = driving_force(self.drive, drives, q[motor], q_dot[motor])
        return {motor: force - damped, load: damped - self.offset}

    @override
    def contacts(self) -> tuple[base.Contact, ...]:
        if self.rubs != "both":
            return (base.Contact(slip="x", load=self.load),)
        return (
            base.Contact(name="load", slip="x", load=self.load),
            base.Contact(name="motor", slip="other", load=self.load),
        )

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
        motor, load = self._sides
        # What joins both sides drives the load, and is an external force to the motor.
        wound = self.stiffness * (q[motor] - q[load])
        wound = wound + self.damping * (q_dot[motor] - q_dot[load])
        sides = {
            "load": base.gear_inputs(wound, -self.offset, position=q[load]),
            "motor": base.gear_inputs(
                driving_force(self.drive, drives, q[motor], q_dot[motor]),
                -wound,
                position=q[motor],
            ),
        }
        return sides if self.rubs == "both" else sides[self.rubs]

    @override
    def drives(self) -> Mapping[str, Drive]:
        return driving(self.drive)


# A pendulum whose pivot rubs.


@dataclass(frozen=True, kw_only=True)
class Pendulum(base.Mechanism):
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
    def contacts(self) -> tuple[base.Contact, ...]:
        return (base.Contact(slip="theta", load=self.load),)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
        weight = -self.mass * self.gravity * self.length * sin(self._leaning(q))
        return base.gear_inputs(
            driving_force(self.drive, drives, q["theta"], q_dot["theta"]),
            weight - self.damping * q_dot["theta"],
            gravity=weight,
            position=q["theta"],
        )

    @override
    def drives(self) -> Mapping[str, Drive]:
        return driving(self.drive)
