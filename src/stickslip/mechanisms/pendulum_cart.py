"""A cart that a swinging pendulum drives: the mechanism of capsule robots."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

from typing_extensions import override

from stickslip.drives import Drive
from stickslip.maths import Scalar, cos, sin
from stickslip.mechanisms.actuators import IDLE, Motor
from stickslip.mechanisms.base import (
    Contact,
    ContactInputs,
    Guide,
    Incline,
    Mechanism,
    gear_inputs,
    height,
)
from stickslip.quantities import Quantity

GROUND = "ground"
"""Name of the drive that shakes the ground."""


@final
@dataclass(frozen=True, kw_only=True)
class PendulumCart(Mechanism):
    """A cart on rough ground with an inverted pendulum, a ball on a light rod.

    The angle `theta` is that of the rod from the normal of the ground, which is the upright where
    the ground is level; the ball is at ``(x - length * sin(theta), length * cos(theta))``, along
    the ground and above the pivot. On an incline positive x is uphill. The swing is prescribed, or
    a torque turns the pendulum; the normal force is that of the whole motion. A spring and a damper
    at the pivot act between rod and cart: beside a prescribed swing they change what the motor has
    to give, and not the motion. With a `pivot_load` the pivot rubs too: the contacts are then
    `wheels` and `pivot`. A run ends where the cart lifts off or tips over its wheels, and
    where its equations lose their meaning (Painleve).

    Examples
    --------
    >>> import math
    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.drives import ThreePhase
    >>> from stickslip.mechanisms import Prescribed
    >>> swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    >>> cart = PendulumCart(
    ...     cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    ... )
    >>> run = simulate(cart, Coulomb(kinetic_coefficient=0.2), t_end=float(swing.period))
    >>> round(float(run["x"][-1]), 7)
    0.0248596
    """

    name: ClassVar[str] = "pendulum-cart"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "theta")
    rates: ClassVar[tuple[str, ...]] = ("v", "omega")
    units: ClassVar[tuple[str, ...]] = ("m", "rad")
    moving_part: ClassVar[str] = "cart"
    contact_names: ClassVar[str] = "wheels, pivot (with pivot_load)"
    imposed: ClassVar[frozenset[str]] = frozenset({GROUND})

    cart_mass: Annotated[float, Quantity("M", "kg", above=0)]
    """Mass of the cart."""
    ball_mass: Annotated[float, Quantity("m", "kg", above=0)]
    """Mass of the ball."""
    length: Annotated[float, Quantity("l", "m", above=0)]
    """Length of the rod."""
    pendulum: Motor = IDLE
    """What moves the pendulum: `Prescribed` or `Torque`."""
    pivot_stiffness: Annotated[float, Quantity("k_theta", "N m/rad", low=0)] = 0.0
    """Spring at the pivot, between rod and cart."""
    pivot_angle: Annotated[float, Quantity("theta_0", "rad")] = 0.0
    """Angle at which that spring is free of torque."""
    pivot_damping: Annotated[float, Quantity("c_theta", "N m s/rad", low=0)] = 0.0
    """Damper at the pivot, between rod and cart."""
    pivot_load: Annotated[float, Quantity("N_p", low=0)] | None = None
    """Load of the friction law of the pivot, 1 where its levels are torques; with None or 0, the
    pivot does not rub."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""
    incline: Incline = 0.0
    """Angle of the ground from the horizontal; where it is positive, positive x is uphill."""
    wheelbase: Annotated[float, Quantity("b", "m", above=0)] | None = None
    """Distance of the outer wheels; a cart without one does not tip."""
    pivot_height: Annotated[float, Quantity("h_p", "m", low=0)] = 0.0
    """Height of the pivot above the ground; it matters to tipping only."""
    centre_height: Annotated[float, Quantity("h_c", "m", low=0)] = 0.0
    """Height of the cart's centre of mass above the ground; it matters to tipping only."""
    ground: Drive | None = None
    """Acceleration of the ground along its normal [m/s^2], as of a vibrating pipe; rest if not
    given."""

    @override
    def __post_init__(self) -> None:
        """Check the parameters; a pivot without load is no contact."""
        super().__post_init__()
        if self.pivot_load == 0.0:
            object.__setattr__(self, "pivot_load", None)

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        tilt, tilting = q.get("tilt", 0.0), q_dot.get("tilt", 0.0)
        angle, turning = q["theta"] + tilt, q_dot["theta"] + tilting
        h_p, h_c, l = self.pivot_height, self.centre_height, self.length  # noqa: E741
        x_dot, y_dot = q_dot["x"], q_dot["y"]
        cart = _square(x_dot - h_c * cos(tilt) * tilting, y_dot - h_c * sin(tilt) * tilting)
        ball = _square(
            x_dot - h_p * cos(tilt) * tilting - l * cos(angle) * turning,
            y_dot - h_p * sin(tilt) * tilting - l * sin(angle) * turning,
        )
        return 0.5 * self.cart_mass * cart + 0.5 * self.ball_mass * ball

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        tilt = q.get("tilt", 0.0)
        h_p, h_c, l = self.pivot_height, self.centre_height, self.length  # noqa: E741
        x, y, angle = q["x"], q["y"], q["theta"] + tilt
        cart = height(self.incline, x - h_c * sin(tilt), y + h_c * cos(tilt))
        ball = height(
            self.incline,
            x - h_p * sin(tilt) - l * sin(angle),
            y + h_p * cos(tilt) + l * cos(angle),
        )
        wound = q["theta"] - self.pivot_angle
        spring = 0.5 * self.pivot_stiffness * wound * wound
        return self.gravity * (self.cart_mass * cart + self.ball_mass * ball) + spring

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        pivot = self.pendulum.force(drives) - self.pivot_damping * q_dot["theta"]
        if self.ground is None:
            return {"theta": pivot}
        shaken = self._shaken(q, drives)
        normal = -(self.cart_mass + self.ball_mass) * drives[GROUND]
        return {"theta": pivot + shaken, "y": normal} | dict.fromkeys(self.held(), shaken)

    def _shaken(self, q: Mapping[str, Scalar], drives: Mapping[str, Scalar]) -> Scalar:
        """Return the torque about the pivot of a ball that its ground carries along [N m]."""
        angle = q["theta"] + q.get("tilt", 0.0)
        return self.ball_mass * drives.get(GROUND, 0.0) * self.length * sin(angle)

    @override
    def contacts(self) -> tuple[Contact, ...]:
        if self.pivot_load is None:
            return (Contact(slip="x", normal="y"),)
        return (
            Contact(slip="x", normal="y", name="wheels"),
            Contact(slip="theta", load=self.pivot_load, name="pivot"),
        )

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> ContactInputs:
        whole = self.cart_mass + self.ball_mass
        slope = -whole * self.gravity * sin(self.incline)
        wheels: dict[str, Scalar] = {"gravity": slope, "position": q["x"]}
        if self.pivot_load is None:
            return wheels
        leaning = self.ball_mass * self.gravity * self.length
        weight = leaning * sin(q["theta"] + self.incline)
        pivot: dict[str, Scalar] = {"gravity": weight, "position": q["theta"]}
        if not self.guided():  # the torque of a prescribed motion follows from the motion
            wound = self.pivot_stiffness * (q["theta"] - self.pivot_angle)
            others = weight - wound - self.pivot_damping * q_dot["theta"]
            others = others + self._shaken(q, drives)
            pivot = gear_inputs(self.pendulum.force(drives), others, **pivot)
        return {"wheels": wheels, "pivot": pivot}

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {**self.pendulum.drives(), **({} if self.ground is None else {GROUND: self.ground})}

    @override
    def start(self) -> Mapping[str, Scalar]:
        return self.pendulum.start("theta", "omega")

    @override
    def guided(self) -> Mapping[str, Guide]:
        guide = self.pendulum.guide("torque", "N m")
        return {} if guide is None else {"theta": guide}

    @override
    def held(self) -> tuple[str, ...]:
        return () if self.wheelbase is None else ("tilt",)

    @override
    def limits(self, forces: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        found = dict(self.pendulum.limits(forces["theta"]) if "theta" in forces else {})
        if self.wheelbase is not None:
            # the ground's force acts between the wheels, its moment about their middle being "tilt"
            reach, weight = 0.5 * self.wheelbase, self.gravity * (self.cart_mass + self.ball_mass)
            spare, moment = forces["y"] / weight, forces["tilt"] / (reach * weight)
            found |= {"tips forward": spare - moment, "tips backward": spare + moment}
        return found


def _square(a: Scalar, b: Scalar) -> Scalar:
    return a * a + b * b
