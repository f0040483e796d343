"""Capsules and carts that an inner body drives, by a motion that is given or by a force."""

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
from typing_extensions import override

from stickslip.errors import InputError, ParameterError
from stickslip.maths import Scalar, cos, exp, power, sin, where
from stickslip.mechanisms import base
from stickslip.mechanisms.drives import Drive, Profile, Sine
from stickslip.quantities import Parametrised, Quantity

# What moves an inner body: a motion it is told, or a force or torque.

DRIVE = "motor"
"""Name of the drive that a motor has."""


@dataclass(frozen=True, kw_only=True)
class Motor(Parametrised, ABC):
    """What acts between a body and what it carries."""

    name: ClassVar[str]
    """``type`` in rig files."""
    wanted: ClassVar[str] = "a motor, Prescribed(...) or Torque(...)"

    @override
    @classmethod
    def instead(cls, given: object) -> str:
        if isinstance(given, Profile):
            return "Write Prescribed(profile=...)."
        if isinstance(given, Drive):
            return "Write Torque(drive=...)."
        return f"Write Torque(drive=...). {Drive.instead(given)}" if callable(given) else ""

    @abstractmethod
    def drives(self) -> Mapping[str, Drive]:
        """Return the drives that are fitted, by name."""

    @abstractmethod
    def force(self, drives: Mapping[str, Scalar], place: Scalar = 0.0) -> Scalar:
        """Return the force [N] or torque [N m] on what is driven.

        Parameters
        ----------
        drives : mapping
            Present values of the drives by name.
        place : float or array
            Where what is driven is [m] or [rad].

        Returns
        -------
        float or array
            Force or torque.
        """

    @abstractmethod
    def start(self, coordinate: str, rate: str) -> Mapping[str, Scalar]:
        """Return where the driven coordinate begins, by name; empty where it is free to.

        Parameters
        ----------
        coordinate : str
            Name of the driven coordinate.
        rate : str
            Name of its rate.

        Returns
        -------
        mapping of str to float or array
            Values at time 0, in SI units.
        """

    @abstractmethod
    def guide(self, effort: str, unit: str) -> base.Guide | None:
        """Return how the coordinate is guided, None where a force moves it.

        Parameters
        ----------
        effort : str
            Name for the force or torque that the motion takes, as a column of runs.
        unit : str
            Unit of that effort, ``"N"`` or ``"N m"``.

        Returns
        -------
        Guide or None
            The guide of the coordinate.
        """

    @abstractmethod
    def limits(self, effort: Scalar) -> Mapping[str, Scalar]:
        """Return what ends a run as a guided coordinate needs too much, by event."""


@dataclass(frozen=True, kw_only=True)
class Prescribed(Motor):
    """A prescribed motion; the force or torque that it requires is computed.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import ThreePhase
    >>> motor = Prescribed(profile=ThreePhase(amplitude=0.8, fast=120.0, slow=30.0))
    >>> float(motor.start("theta", "omega")["theta"])
    -0.8
    """

    name: ClassVar[str] = "prescribed"

    profile: Profile
    """The motion."""
    limit: Annotated[float, Quantity("tau_m", "N m", above=0, or_unit="N")] | None = None
    """Largest force or torque; a run that needs more ends there. None if not given."""

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {DRIVE: self.profile}

    @override
    def force(self, drives: Mapping[str, Scalar], place: Scalar = 0.0) -> Scalar:
        return 0.0

    @override
    def start(self, coordinate: str, rate: str) -> Mapping[str, Scalar]:
        return {coordinate: self.profile.start_position, rate: self.profile.start_rate}

    @override
    def guide(self, effort: str, unit: str) -> base.Guide | None:
        return base.Guide(drive=DRIVE, effort=effort, unit=unit)

    @override
    def limits(self, effort: Scalar) -> Mapping[str, Scalar]:
        if self.limit is None:
            return {}
        share = effort / self.limit
        return {"motor limit forward": 1.0 - share, "motor limit backward": 1.0 + share}


@dataclass(frozen=True, kw_only=True)
class Torque(Motor):
    """A force or torque given as a function of time, limited to what the motor can supply.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Sine
    >>> Torque(drive=Sine(amplitude=0.4, frequency=1.0), limit=0.3).name
    'torque'
    """

    name: ClassVar[str] = "torque"

    drive: Drive | None = None
    """Torque [N m] or force [N]; none if not given."""
    limit: Annotated[float, Quantity("tau_m", "N m", above=0, or_unit="N")] | None = None
    """Largest torque: beyond it the motor saturates. None if not given."""

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {} if self.drive is None else {DRIVE: self.drive}

    @override
    def force(self, drives: Mapping[str, Scalar], place: Scalar = 0.0) -> Scalar:
        wanted = drives.get(DRIVE, 0.0)
        if self.limit is None or self.drive is None:
            return wanted
        most = self.limit
        named = ("motor saturates", "motor leaves saturation")
        above = where(wanted > most, most, wanted, named)
        return where(wanted < -most, -most, above, named)

    @override
    def start(self, coordinate: str, rate: str) -> Mapping[str, Scalar]:
        return {}

    @override
    def guide(self, effort: str, unit: str) -> base.Guide | None:
        return None

    @override
    def limits(self, effort: Scalar) -> Mapping[str, Scalar]:
        return {}


@dataclass(frozen=True, kw_only=True)
class Coil(Torque):
    """A ring-shaped coil that acts on a magnet on its axis: the force depends on the place.

    At a distance ``u R`` from its middle the force of a drive P is ``P s(u)`` with

        s(u) = u (1 + u^2)^(-5/2) / s_max,    s_max = 16 / (25 sqrt(5)) at u = 1/2

    so that P is the largest force, half a radius from the middle. In the middle there is none;
    a positive P pushes away from it. The magnet is short and the coil thin beside R.

    Source: D. J. Griffiths, Introduction to Electrodynamics, on the field of a loop on its axis and
    the force on a dipole in it.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Sine
    >>> coil = Coil(radius=0.01, middle=-0.005, drive=Sine(amplitude=0.4, frequency=1.0))
    >>> round(coil.force({"motor": 0.4}, 0.0), 12), round(coil.force({"motor": 0.4}, -0.01), 12)
    (0.4, -0.4)
    """

    name: ClassVar[str] = "coil"

    radius: Annotated[float, Quantity("R", "m", above=0, or_unit="rad")]
    """Radius R of the coil."""
    middle: Annotated[float, Quantity("xi_m", "m", or_unit="rad")] = 0.0
    """Place of the inner mass at which its magnet is in the middle of the coil."""

    @override
    def force(self, drives: Mapping[str, Scalar], place: Scalar = 0.0) -> Scalar:
        u = (place - self.middle) / self.radius
        return super().force(drives, place) * (u / _STRONGEST * power(1.0 + u * u, -2.5))


_STRONGEST = 0.5 * 1.25**-2.5

IDLE = Torque()
"""A motor that does nothing."""

MOTORS: Mapping[str, type[Motor]] = {motor.name: motor for motor in (Prescribed, Torque, Coil)}
"""The motors by the ``type`` they have in rig files."""


# A capsule that an inner mass drives.


SPRINGS = ("linear", "hertz", "exponential")
"""How the force of an elastic stop may grow with its depth."""


@dataclass(frozen=True, kw_only=True)
class SoftStop(Parametrised):
    """An elastic stop: a spring and a damper that an inner mass or a pendulum meets at a place.

    It pushes the mass away with ``F(d) + c d'`` while it is pressed in by `d`. It does not pull:
    where the damper would, the mass leaves it early, unless it `sticks`, as in models whose damper
    acts for as long as the spring is pressed in. F is one of

    - ``"linear"``: ``k d``
    - ``"hertz"``: ``k d^(3/2)`` with d in m or rad, as between round bodies
    - ``"exponential"``: ``(k / b) (exp(b d) - 1)``, as of soft tissue that stiffens; k is its
      stiffness at first touch

    Sources: K. L. Johnson, Contact Mechanics, 1985 (Hertz); Y. C. Fung, Am. J. Physiol. 213, 1967.

    Examples
    --------
    >>> SoftStop(place=2e-3, stiffness=5000.0).damping
    0.0
    >>> tissue = SoftStop(place=2e-3, stiffness=50.0, spring="exponential", stiffening=800.0)
    >>> round(tissue.pressed(1e-3), 6)
    0.076596
    """

    place: Annotated[float, Quantity("xi_s", "m", or_unit="rad")]
    """Place of the inner mass, or angle of the pendulum, where it meets the stop."""
    stiffness: Annotated[float, Quantity("k_s", "N/m", above=0, or_unit="N m/rad")]
    """Its spring; of a Hertz stop, what it pushes with at a depth of 1 m or rad."""
    damping: Annotated[float, Quantity("c_s", "N s/m", low=0, or_unit="N m s/rad")] = 0.0
    """Its damper."""
    sticks: bool = False
    """Whether its damper may pull."""
    spring: Literal["linear", "hertz", "exponential"] = "linear"
    """How its force grows with the depth."""
    stiffening: Annotated[float, Quantity("b", "1/m", low=0, or_unit="1/rad")] = 0.0
    """Rate b of an exponential spring."""

    def __post_init__(self) -> None:
        """Check that the spring is known, and stiffens where it has to."""
        super().__post_init__()
        if self.spring not in SPRINGS:
            raise ParameterError(
                f"SoftStop.spring must be one of {', '.join(SPRINGS)}, got {self.spring!r}."
            )
        if self.spring == "exponential" and self.stiffening == 0.0:
            raise ParameterError(
                "SoftStop.stiffening (b) must be above 0 1/m for an exponential spring: give it, or"
                ' leave spring at "linear".'
            )

    def pressed(self, depth: Scalar) -> Scalar:
        """Return the force [N] or torque [N m] of the spring, pressed in by a depth."""
        if self.spring == "hertz":
            return self.stiffness * power(depth, 1.5)
        if self.spring == "exponential":
            return self.stiffness / self.stiffening * (exp(self.stiffening * depth) - 1.0)
        return self.stiffness * depth

    def energy(self, xi: Scalar, side: int, events: tuple[str, str]) -> Scalar:
        """Return the potential energy [J] of a stop above (side 1) or below (-1) the mass."""
        depth = side * (xi - self.place)
        stored = 0.5 * self.stiffness * depth * depth
        if self.spring == "hertz":
            stored = 0.4 * self.stiffness * power(depth, 2.5)
        elif self.spring == "exponential":
            grown = (exp(self.stiffening * depth) - 1.0) / self.stiffening
            stored = self.stiffness / self.stiffening * (grown - depth)
        return where(depth > 0.0, stored, 0.0, events)

    def damper_force(self, xi: Scalar, rate: Scalar, side: int, events: tuple[str, str]) -> Scalar:
        """Return the force [N] on the inner mass beside that of the spring."""
        depth, speed = side * (xi - self.place), side * rate
        pull = self.damping * speed
        if not self.sticks:
            pressed = self.pressed(depth)
            pull = where(pressed + pull > 0.0, pull, -pressed)
        return -side * where(depth > 0.0, pull, 0.0, events)

    def force(self, xi: Scalar, rate: Scalar, side: int, events: tuple[str, str]) -> Scalar:
        """Return the force [N] on the inner mass, that of the spring included."""
        depth = side * (xi - self.place)
        spring = where(depth > 0.0, self.pressed(depth), 0.0, events)
        return self.damper_force(xi, rate, side, events) - side * spring


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


@dataclass(frozen=True, kw_only=True)
class Capsule(base.BoundedMechanism):
    """A capsule on rough ground with a mass inside that moves along it.

    The place `xi` of the inner mass is counted from the capsule. A spring and a damper hold it. A
    force between the two drives it, or one from outside on the mass alone, as that of magnets, or
    its motion is prescribed. With stops, hard or soft, it strikes the capsule, as in vibro-impact
    capsules; at a hard one it bounces, and rests there while it is pressed. On an incline both are
    pulled towards negative x. With an `angle` the inner mass moves along an inclined line, and the
    run ends where the capsule lifts off; stops are soft there, since a blow on a hard one may lift
    the capsule in no time.

    Examples
    --------
    >>> from stickslip import Capsule, Coulomb, simulate
    >>> from stickslip.mechanisms.drives import ThreePhase
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
    incline: base.Incline = 0.0
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
    angle: Annotated[float, Quantity("alpha", "rad")] | None = None
    """Angle of the line of the inner mass from the ground, pi/2 being upwards: its weight hangs on
    the spring, and its motion changes the normal force. None, as usual, is along the ground."""

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
            gravity=1.0 / (coefficient * (1.0 + gamma)),  # mu (M + m) g = 1
            drive=Torque(drive=drive),
            drive_on=drive_on,
            upper_soft_stop=SoftStop(place=delta, stiffness=beta),
        )

    def dimensionless_numbers(self, coefficient: float) -> dict[str, float]:
        """Return the dimensionless numbers of the capsule with a coefficient of sliding friction.

        Those of a force that is no `Sine`, or of a soft stop that is not there, are left out; so is
        alpha of a `Coil`, whose force depends on the place. See `dimensionless`.

        Raises
        ------
        InputError
            If the inner mass has an angle: the friction then varies with its motion.

        Examples
        --------
        >>> capsule = Capsule(capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03)
        >>> {name: round(one, 6) for name, one in capsule.dimensionless_numbers(0.2).items()}
        {'gamma': 4.0, 'xi': 0.013693}
        """
        if self.angle:
            raise InputError(
                "Capsule.dimensionless_numbers: they are over one level of friction, which with an"
                f" angle (alpha) of {self.angle:g} rad varies with the motion of the inner mass."
                " Leave the angle out."
            )
        weight = self.gravity * (self.capsule_mass + self.inner_mass)
        friction = coefficient * (weight + self.squeeze)
        natural = math.sqrt(self.stiffness / self.inner_mass)
        result = {
            "gamma": self.capsule_mass / self.inner_mass,
            "xi": 0.5 * self.damping / (self.inner_mass * natural),
        }
        drive = self.drive.drive if isinstance(self.drive, Torque) else None
        if isinstance(drive, Sine):
            if not isinstance(self.drive, Coil):
                result["alpha"] = drive.amplitude / friction
            result["omega"] = 2.0 * math.pi * drive.frequency / natural
        if self.upper_soft_stop is not None:
            result["beta"] = self.upper_soft_stop.stiffness / self.stiffness
            result["delta"] = self.upper_soft_stop.place * self.stiffness / friction
        return result

    def _parts(self, way: Scalar) -> tuple[Scalar, Scalar]:
        """Return the parts along and above the ground of a way or force along the inner line."""
        if self.angle is None:
            return way, 0.0
        return cos(self.angle) * way, sin(self.angle) * way

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        v, w = q_dot["x"], q_dot["y"]
        along, above = self._parts(q_dot["xi"])
        inner = self.inner_mass * _square(v + along, w + above)
        return 0.5 * self.capsule_mass * _square(v, w) + 0.5 * inner

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        capsule = self.capsule_mass * base.height(self.incline, q["x"], q["y"])
        along, above = self._parts(q["xi"])
        inner = self.inner_mass * base.height(self.incline, q["x"] + along, q["y"] + above)
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
        drive = self.drive.force(drives, q["xi"])
        between = drive - self.damping * q_dot["xi"]
        for stop, side, events in soft_stops(self.lower_soft_stop, self.upper_soft_stop):
            between = between + stop.damper_force(q["xi"], q_dot["xi"], side, events)
        # xi counts from the capsule: a force between both acts along xi alone, one from outside
        # along x too.
        if self.drive_on == "both":
            return {"xi": between}
        along, above = self._parts(drive)
        return {"xi": between, "x": along} | ({} if self.angle is None else {"y": above})

    @override
    def contacts(self) -> tuple[base.Contact, ...]:
        return (base.Contact(slip="x", normal="y"),)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
        whole = self.capsule_mass + self.inner_mass
        return {"gravity": -whole * self.gravity * sin(self.incline), "position": q["x"]}

    @override
    def stops(self) -> tuple[base.Stop, ...]:
        return _hard_stops("xi", self)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return self.drive.drives()

    @override
    def start(self) -> Mapping[str, Scalar]:
        return self.drive.start("xi", "xi_dot")

    @override
    def guided(self) -> Mapping[str, base.Guide]:
        guide = self.drive.guide("force", "N")
        return {} if guide is None else {"xi": guide}

    @override
    def limits(self, forces: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        return self.drive.limits(forces["xi"]) if "xi" in forces else {}


ALONG_GROUND = 1e-6
"""Sine of an angle up to which a blow acts along the ground alone: the share across it."""


def _hard_stops(place: str, mass: "Capsule | InnerMass") -> tuple[base.Stop, ...]:
    """Return the hard stops of a mass, which moves along the ground where there are any."""
    stops = base.stops_between(place, mass.lower_stop, mass.upper_stop, mass.restitution)
    if stops and (angle := next(iter(_sloped(mass.angle)), None)) is not None:
        raise ParameterError(
            f"{type(mass).__name__}: hard stops are for a mass that moves along the ground, got"
            f" an angle (alpha) of {angle:.12g} rad: a blow may lift the capsule there. Use soft"
            " stops (lower_soft_stop, upper_soft_stop), or an angle of 0 rad."
        )
    return stops


def _sloped(angles: Scalar) -> list[float]:
    """Return those of some angles at which a blow acts on the normal force."""
    if not isinstance(angles, int | float | np.ndarray):  # where equations are traced
        return []
    known = np.ravel(angles)
    return [float(x) for x in known[np.abs(np.sin(known)) > ALONG_GROUND]]


# A capsule that two inner masses drive.


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


@dataclass(frozen=True, kw_only=True)
class TwoMassCapsule(base.BoundedMechanism):
    """A capsule on rough ground with two masses inside.

    The places `xi` and `zeta` of both are counted from the capsule, each along its own line. One
    that moves upwards changes the normal force: of two that move at right angles, one loosens the
    capsule while the other pushes it on. A run ends where the capsule lifts off. Hard stops are for
    a mass that moves along the ground: a blow on one may else lift the capsule in no time.

    Examples
    --------
    Two masses that are one do what the inner mass of a `Capsule` does:

    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.mechanisms.drives import ThreePhase
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
    incline: base.Incline = 0.0
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
        result = 0.5 * self.capsule_mass * (v * v + w * w)
        for _, place, _, mass in self._inner():
            along = v + cos(mass.angle) * q_dot[place]
            up = w + sin(mass.angle) * q_dot[place]
            result = result + 0.5 * mass.mass * (along * along + up * up)
        return result

    @override
    def potential_energy(self, t: Scalar, q: Mapping[str, Scalar]) -> Scalar:
        x, y = q["x"], q["y"]
        result = (
            self.gravity * self.capsule_mass * base.height(self.incline, x, y) + self.squeeze * y
        )
        for name, place, _, mass in self._inner():
            along, up = x + cos(mass.angle) * q[place], y + sin(mass.angle) * q[place]
            result = result + self.gravity * mass.mass * base.height(self.incline, along, up)
            result = result + 0.5 * mass.stiffness * q[place] * q[place]
            for stop, side, events in mass.soft_stops(name):
                result = result + stop.energy(q[place], side, events)
        return result

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        result: dict[str, Scalar] = {}
        for name, place, _, mass in self._inner():
            own = {DRIVE: drives[motor]} if (motor := f"{name}_{DRIVE}") in drives else {}
            force = mass.drive.force(own, q[place]) - mass.damping * q_dot[place]
            for stop, side, events in mass.soft_stops(name):
                force = force + stop.damper_force(q[place], q_dot[place], side, events)
            result[place] = force
        return result

    @override
    def contacts(self) -> tuple[base.Contact, ...]:
        return (base.Contact(slip="x", normal="y"),)

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
        mass = self.capsule_mass + self.first.mass + self.second.mass
        return {"gravity": -mass * self.gravity * sin(self.incline), "position": q["x"]}

    @override
    def stops(self) -> tuple[base.Stop, ...]:
        return tuple(
            stop for _, place, _, mass in self._inner() for stop in _hard_stops(place, mass)
        )

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {
            f"{name}_{motor}": drive
            for name, _, _, mass in self._inner()
            for motor, drive in mass.drive.drives().items()
        }

    @override
    def start(self) -> Mapping[str, Scalar]:
        return {
            key: value
            for _, place, rate, mass in self._inner()
            for key, value in mass.drive.start(place, rate).items()
        }

    @override
    def guided(self) -> Mapping[str, base.Guide]:
        result = {}
        for name, place, _, mass in self._inner():
            guide = mass.drive.guide(f"{name}_force", "N")
            if guide is not None:
                drive = f"{name}_{guide.drive}"
                result[place] = base.Guide(drive=drive, effort=guide.effort, unit=guide.unit)
        return result

    @override
    def limits(self, forces: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        return {
            f"{name} {event}": margin
            for name, place, _, mass in self._inner()
            if place in forces
            for event, margin in mass.drive.limits(forces[place]).items()
        }


# A cart that a swinging pendulum drives: the mechanism of capsule robots.

GROUND = "ground"
"""Name of the drive that shakes the ground."""


@dataclass(frozen=True, kw_only=True)
class PendulumCart(base.BoundedMechanism):
    """A cart on rough ground with an inverted pendulum, a ball on a light rod.

    The angle `theta` is that of the rod from the normal of the ground, which is the upright where
    the ground is level; the ball is at ``(x - length * sin(theta), length * cos(theta))``, along
    the ground and above the pivot. On an incline positive x is uphill. The swing is prescribed, or
    a torque turns the pendulum; the normal force is that of the whole motion. A spring and a damper
    at the pivot act between rod and cart: beside a prescribed swing they change what the motor has
    to give, and not the motion. With stops the pendulum strikes the cart, which takes the torque:
    soft ones stand anywhere, hard ones where the rod is along the normal (0 or pi), since a blow
    elsewhere acts on the normal force, and by that on friction, in no time. With a `pivot_load`
    the pivot rubs too: the contacts are then `wheels` and `pivot`. A run ends where the cart lifts
    off or tips over its wheels, and where its equations lose their meaning (Painleve).

    Examples
    --------
    >>> import math
    >>> from stickslip import Coulomb, simulate
    >>> from stickslip.mechanisms.drives import ThreePhase
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
    lower_stop: Annotated[float, Quantity("theta_l", "rad")] | None = None
    """Hard stop that theta does not fall below; none if not given. Fixed at a multiple of pi: other
    places are refused, so that no sweep or fit varies it."""
    upper_stop: Annotated[float, Quantity("theta_u", "rad")] | None = None
    """Hard stop that theta does not rise above; none if not given. Fixed as the lower one."""
    restitution: Annotated[float, Quantity("e", low=0, high=1)] = 0.0
    """Angular velocity after an impact at a stop over that before; 0 if nothing bounces."""
    lower_soft_stop: SoftStop | None = None
    """Elastic stop below; none if not given."""
    upper_soft_stop: SoftStop | None = None
    """Elastic stop above; none if not given."""
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81
    """Acceleration of free fall."""
    incline: base.Incline = 0.0
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

    def __post_init__(self) -> None:
        """Check the parameters; a pivot without load is no contact."""
        super().__post_init__()
        if self.pivot_load == 0.0:
            object.__setattr__(self, "pivot_load", None)

    @override
    def kinetic_energy(self, q: Mapping[str, Scalar], q_dot: Mapping[str, Scalar]) -> Scalar:
        # Where tipping is watched, `tilt` is a coordinate held at 0: its reaction is the moment of
        # the ground.
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
        cart = base.height(self.incline, x - h_c * sin(tilt), y + h_c * cos(tilt))
        ball = base.height(
            self.incline,
            x - h_p * sin(tilt) - l * sin(angle),
            y + h_p * cos(tilt) + l * cos(angle),
        )
        wound = q["theta"] - self.pivot_angle
        spring = 0.5 * self.pivot_stiffness * wound * wound
        for stop, side, events in soft_stops(self.lower_soft_stop, self.upper_soft_stop):
            spring = spring + stop.energy(q["theta"], side, events)
        return self.gravity * (self.cart_mass * cart + self.ball_mass * ball) + spring

    @override
    def forces(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> Mapping[str, Scalar]:
        pivot = self.pendulum.force(drives, q["theta"]) - self.pivot_damping * q_dot["theta"]
        for stop, side, events in soft_stops(self.lower_soft_stop, self.upper_soft_stop):
            pivot = pivot + stop.damper_force(q["theta"], q_dot["theta"], side, events)
        if self.ground is None:
            return {"theta": pivot}
        shaken = self._shaken(q, drives)
        # In axes of the ground its acceleration acts like a weight.
        normal = -(self.cart_mass + self.ball_mass) * drives[GROUND]
        return {"theta": pivot + shaken, "y": normal} | dict.fromkeys(self.held(), shaken)

    def _shaken(self, q: Mapping[str, Scalar], drives: Mapping[str, Scalar]) -> Scalar:
        """Return the torque about the pivot of a ball that its ground carries along [N m]."""
        angle = q["theta"] + q.get("tilt", 0.0)
        return self.ball_mass * drives.get(GROUND, 0.0) * self.length * sin(angle)

    @override
    def contacts(self) -> tuple[base.Contact, ...]:
        if self.pivot_load is None:
            return (base.Contact(slip="x", normal="y"),)
        return (
            base.Contact(slip="x", normal="y", name="wheels"),
            base.Contact(slip="theta", load=self.pivot_load, name="pivot"),
        )

    @override
    def contact_inputs(
        self,
        t: Scalar,
        q: Mapping[str, Scalar],
        q_dot: Mapping[str, Scalar],
        drives: Mapping[str, Scalar],
    ) -> base.ContactInputs:
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
            for stop, side, events in soft_stops(self.lower_soft_stop, self.upper_soft_stop):
                others = others + stop.force(q["theta"], q_dot["theta"], side, events)
            pivot = base.gear_inputs(self.pendulum.force(drives, q["theta"]), others, **pivot)
        return {"wheels": wheels, "pivot": pivot}

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {**self.pendulum.drives(), **({} if self.ground is None else {GROUND: self.ground})}

    @override
    def start(self) -> Mapping[str, Scalar]:
        return self.pendulum.start("theta", "omega")

    @override
    def guided(self) -> Mapping[str, base.Guide]:
        guide = self.pendulum.guide("torque", "N m")
        return {} if guide is None else {"theta": guide}

    @override
    def held(self) -> tuple[str, ...]:
        return () if self.wheelbase is None else ("tilt",)

    @override
    def stops(self) -> tuple[base.Stop, ...]:
        stops = base.stops_between("theta", self.lower_stop, self.upper_stop, self.restitution)
        soft = "Use soft stops (lower_soft_stop, upper_soft_stop)"
        for stop in stops:
            if (place := next(iter(_sloped(stop.position)), None)) is not None:
                name, symbol = f"{stop.side}_stop", f"theta_{stop.side[0]}"
                raise ParameterError(
                    f"PendulumCart: hard stops are for a rod that stands or hangs along the normal"
                    f" there, got {name} ({symbol}) = {place:.12g} rad: a blow elsewhere lifts the"
                    " cart or presses it on its ground, whose friction takes a part of the blow."
                    f" {soft}, or 0 or 180 deg (pi rad)."
                )
        if stops and self.wheelbase is not None:
            raise ParameterError(
                "PendulumCart: a blow on a hard stop has a moment that no weight holds, got a"
                f" wheelbase (b) of {self.wheelbase:g} m, so that the cart would tip. {soft}, or"
                " leave the wheelbase out."
            )
        return stops

    @override
    def limits(self, forces: Mapping[str, Scalar]) -> Mapping[str, Scalar]:
        result = dict(self.pendulum.limits(forces["theta"]) if "theta" in forces else {})
        if self.wheelbase is not None:
            # the ground's force acts between the wheels, its moment about their middle being "tilt"
            reach, weight = 0.5 * self.wheelbase, self.gravity * (self.cart_mass + self.ball_mass)
            spare, moment = forces["y"] / weight, forces["tilt"] / (reach * weight)
            result |= {"tips forward": spare - moment, "tips backward": spare + moment}
        return result


def _square(a: Scalar, b: Scalar) -> Scalar:
    return a * a + b * b
