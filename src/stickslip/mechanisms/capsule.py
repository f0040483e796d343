"""A capsule that an inner mass drives."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, final

from typing_extensions import override

from stickslip.drives import Drive, Sine
from stickslip.errors import ParameterError
from stickslip.maths import Scalar, sin, where
from stickslip.mechanisms.actuators import IDLE, Motor, Prescribed, Torque
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
from stickslip.quantities import Parametrised, Quantity


@final
@dataclass(frozen=True, kw_only=True)
class SoftStop(Parametrised):
    """An elastic stop: a spring and a damper that the inner mass meets at a place.

    It pushes the mass away with ``k d + c d'`` while it is pressed in by `d`. It does not pull:
    where the damper would, the mass leaves it early, unless it `sticks`, as in models whose damper
    acts for as long as the spring is pressed in.

    Examples
    --------
    >>> SoftStop(place=2e-3, stiffness=5000.0).damping
    0.0
    """

    place: Annotated[float, Quantity("xi_s", "m")]
    """Place of the inner mass where it meets the stop."""
    stiffness: Annotated[float, Quantity("k_s", "N/m", above=0)]
    """Its spring."""
    damping: Annotated[float, Quantity("c_s", "N s/m", low=0)] = 0.0
    """Its damper."""
    sticks: bool = False
    """Whether its damper may pull."""

    def energy(self, xi: Scalar, side: int, events: tuple[str, str]) -> Scalar:
        """Return the potential energy [J] of a stop above (side 1) or below (-1) the mass."""
        depth = side * (xi - self.place)
        return where(depth > 0.0, 0.5 * self.stiffness * depth * depth, 0.0, events)

    def damper_force(self, xi: Scalar, rate: Scalar, side: int, events: tuple[str, str]) -> Scalar:
        """Return the force [N] on the inner mass beside that of the spring."""
        depth, speed = side * (xi - self.place), side * rate
        pull = self.damping * speed
        if not self.sticks:
            pressed = self.stiffness * depth
            pull = where(pressed + pull > 0.0, pull, -pressed)
        return -side * where(depth > 0.0, pull, 0.0, events)


def soft_stops(
    lower: SoftStop | None, upper: SoftStop | None, whose: str = ""
) -> list[tuple[SoftStop, int, tuple[str, str]]]:
    """Return the soft stops of a mass with their sides and the names of their events.

    Examples
    --------
    >>> [events for _, _, events in soft_stops(None, SoftStop(place=2e-3, stiffness=1.0), "first ")]
    [('first meets upper soft stop', 'first leaves upper soft stop')]
    """
    sides = ((lower, -1, "lower"), (upper, 1, "upper"))
    return [
        (stop, side, (f"{whose}meets {name} soft stop", f"{whose}leaves {name} soft stop"))
        for stop, side, name in sides
        if stop is not None
    ]


@final
@dataclass(frozen=True, kw_only=True)
class Capsule(BoundedMechanism):
    """A capsule on rough ground with a mass inside that moves along it.

    The place `xi` of the inner mass is counted from the capsule. A spring and a damper hold it. A
    force between the two drives it, or one from outside on the mass alone, as that of magnets, or
    its motion is prescribed. With stops, hard or soft, it strikes the capsule, as in vibro-impact
    capsules; at a hard one it bounces, and rests there while it is pressed. On an incline both are
    pulled towards negative x.

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
    lower_soft_stop: SoftStop | None = None
    """Elastic stop below; none if not given."""
    upper_soft_stop: SoftStop | None = None
    """Elastic stop above; none if not given."""
    drive_on: Literal["both", "inner mass"] = "both"
    """Where a force drives it: between the two, or from outside on the inner mass alone."""
    squeeze: Annotated[float, Quantity("F_h", "N", low=0)] = 0.0
    """Force beside the weight that presses it on its ground, as the hoop stress of a bowel."""

    @override
    def __post_init__(self) -> None:
        """Check the parameters: only a force can come from outside."""
        if self.drive_on not in ("both", "inner mass"):
            raise ParameterError(
                f"Capsule.drive_on must be 'both' or 'inner mass', got {self.drive_on!r}."
            )
        if self.drive_on == "inner mass" and isinstance(self.drive, Prescribed):
            raise ParameterError(
                "Capsule.drive_on is 'inner mass', but the drive prescribes the motion between"
                " both: give Torque(drive=...), or drive_on='both'."
            )
        super().__post_init__()

    @classmethod
    def dimensionless(
        cls,
        *,
        alpha: float,
        beta: float,
        gamma: float,
        delta: float,
        xi: float,
        omega: float,
        coefficient: float,
        drive_on: Literal["both", "inner mass"] = "inner mass",
    ) -> "Capsule":
        """Return a vibro-impact capsule by its dimensionless numbers.

        Inner mass and spring are 1 kg and 1 N/m and the sliding friction is 1 N, so that times,
        places and velocities of its runs are dimensionless. The soft stop is above and has no
        damper; the force is ``alpha cos(omega t)``.

        Parameters
        ----------
        alpha : float
            Amplitude of the force over the sliding friction.
        beta : float
            Stiffness of the soft stop over that of the spring.
        gamma : float
            Mass of the capsule over the inner mass.
        delta : float
            Gap of the soft stop, times the stiffness of the spring, over the sliding friction.
        xi : float
            Damping ratio ``c / (2 sqrt(k m))`` of the inner mass.
        omega : float
            Angular frequency of the force over ``sqrt(k / m)``.
        coefficient : float
            Coefficient of sliding friction of the law that runs will take; gravity is such that
            its friction is 1 N.
        drive_on : {"inner mass", "both"}
            Where the force acts.

        Returns
        -------
        Capsule
            The capsule.

        References
        ----------
        Y. Liu, M. Wiercigroch, E. Pavlovskaia, H. Yu, Modelling of a vibro-impact capsule system,
        Int. J. Mech. Sci. 66 (2013) 2-11.

        Examples
        --------
        >>> from stickslip import Coulomb, simulate
        >>> capsule = Capsule.dimensionless(
        ...     alpha=1.6, beta=15.0, gamma=5.0, delta=0.02, xi=0.05, omega=0.95, coefficient=0.3
        ... )
        >>> numbers = capsule.dimensionless_numbers(coefficient=0.3)
        >>> round(numbers["beta"], 12), round(numbers["delta"], 12)
        (15.0, 0.02)
        """
        drive = Sine(amplitude=alpha, frequency=omega / (2.0 * math.pi), phase=0.5 * math.pi)
        return cls(
            capsule_mass=gamma,
            inner_mass=1.0,
            stiffness=1.0,
            damping=2.0 * xi,
            gravity=1.0 / (coefficient * (1.0 + gamma)),
            drive=Torque(drive=drive),
            drive_on=drive_on,
            upper_soft_stop=SoftStop(place=delta, stiffness=beta),
        )

    def dimensionless_numbers(self, coefficient: float) -> dict[str, float]:
        """Return the dimensionless numbers of the capsule with a coefficient of sliding friction.

        Those of a force that is no `Sine`, or of a soft stop that is not there, are left out; see
        `dimensionless`.

        Examples
        --------
        >>> capsule = Capsule(capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03)
        >>> {name: round(one, 6) for name, one in capsule.dimensionless_numbers(0.2).items()}
        {'gamma': 4.0, 'xi': 0.013693}
        """
        weight = self.gravity * (self.capsule_mass + self.inner_mass)
        friction = coefficient * (weight + self.squeeze)
        natural = math.sqrt(self.stiffness / self.inner_mass)
        found = {
            "gamma": self.capsule_mass / self.inner_mass,
            "xi": 0.5 * self.damping / (self.inner_mass * natural),
        }
        drive = self.drive.drive if isinstance(self.drive, Torque) else None
        if isinstance(drive, Sine):
            found["alpha"] = drive.amplitude / friction
            found["omega"] = 2.0 * math.pi * drive.frequency / natural
        if self.upper_soft_stop is not None:
            found["beta"] = self.upper_soft_stop.stiffness / self.stiffness
            found["delta"] = self.upper_soft_stop.place * self.stiffness / friction
        return found

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
        springs = 0.5 * self.stiffness * q["xi"] * q["xi"]
        for stop, side, events in soft_stops(self.lower_soft_stop, self.upper_soft_stop):
            springs = springs + stop.energy(q["xi"], side, events)
        return self.gravity * (capsule + inner) + self.squeeze * q["y"] + springs

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        drive = self.drive.force(drives)
        between = drive - self.damping * q_dot["xi"]
        for stop, side, events in soft_stops(self.lower_soft_stop, self.upper_soft_stop):
            between = between + stop.damper_force(q["xi"], q_dot["xi"], side, events)
        return {"xi": between} | ({"x": drive} if self.drive_on == "inner mass" else {})

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
