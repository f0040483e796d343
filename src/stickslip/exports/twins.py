"""What other programs make of a rig's friction: their law or rule for rest, its creep and error."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from types import MappingProxyType
from typing import Annotated, Any, ClassVar, Final

import numpy as np

from stickslip import mechanisms
from stickslip.data import levels_at
from stickslip.engine.simulation import simulate
from stickslip.engine.solver import BreakAway, FixedStep, SoftConstraint, Solver
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, SimulationError
from stickslip.exports import joints
from stickslip.exports.program import Subject
from stickslip.friction import FrictionLaw
from stickslip.friction import law as composed
from stickslip.quantities import Parametrised, Quantity, named, turned
from stickslip.show.described import Described
from stickslip.show.formatting import number, percent, quantity

SHARE: Final = 0.6
"""Share of break-away of the force under which creep is told, if none is given."""
TIMES: Final = 4001
"""Even times at which two runs are compared, beside the steps of the program."""
REFERENCE_SPEED: Final = 1.0
"""Range of speeds [m/s] over which a level is fitted where nothing moves on the rig."""
ROUNDING: Final = 1e-9
"""Share of a force below which nothing is left of it."""
WIDER: Final = 2.0
"""Dead band over the change of velocity in a step, which jumps over a narrower one."""


@dataclass(frozen=True, kw_only=True)
class Taken:
    """The friction of a program on a rig."""

    law: FrictionLaw
    """What its friction is while a body slides."""
    solver: Solver | None
    """Its steps and rule for rest; None where the law alone makes the difference."""
    level: float
    """Largest friction force at rest [N]."""
    lost: tuple[str, ...] = ()
    """What of the law it cannot have, in sentences."""


@dataclass(frozen=True, kw_only=True)
class Program(Parametrised, ABC):
    """Another program with its settings."""

    name: ClassVar[str]
    """Its name on the command line."""
    title: ClassVar[str]
    """Its name in text."""

    @abstractmethod
    def taken(self, subject: Subject) -> Taken:
        """Return the friction of the program for a law.

        Parameters
        ----------
        subject : Subject
            Law, mechanism, load and range of speeds.

        Returns
        -------
        Taken
            Law, solver and level.

        Raises
        ------
        InputError
            If the program has nothing for this law, or something is not known.
        """

    @abstractmethod
    def creep(self, subject: Subject, taken: Taken, force: float) -> float:
        """Return the steady speed of a body at rest under a force below the level.

        Parameters
        ----------
        subject : Subject
            Law and mechanism.
        taken : Taken
            The program's friction.
        force : float
            Applied force [N].

        Returns
        -------
        float
            Speed [m/s]; NaN if it takes an inertia that is not known.
        """

    @abstractmethod
    def settings(self, subject: Subject, taken: Taken) -> str:
        """Return the settings as the program spells them.

        Parameters
        ----------
        subject : Subject
            Law and mechanism.
        taken : Taken
            The program's friction.

        Returns
        -------
        str
            The settings.
        """

    @abstractmethod
    def stiffer(self, subject: Subject) -> "Program":
        """Return settings that come close to the law."""


def _viscous(taken: Taken) -> float:
    return float(vars(taken.law)["viscous_coefficient"])


def _steady_speed(subject: Subject, taken: Taken, force: float, fastest: float) -> float:
    """Return the speed, up to the fastest, at which a smooth law has this force."""
    from scipy.optimize import brentq

    load = subject.needed_load()

    def excess(speed: float) -> float:
        return float(taken.law.steady(speed, load)) - force

    if excess(fastest) <= 0.0:  # by rounding
        return fastest
    return float(brentq(excess, 0.0, fastest, xtol=1e-15, rtol=1e-12))


def _kept(found: joints.Simplified) -> tuple[str, ...]:
    """Return what is lost by a smooth law, which friction has that grows with the load."""
    return tuple(line for line in found.lost if not line.startswith("Dependence on the normal"))


def _level_and_damping(subject: Subject) -> tuple[joints.Simplified, float]:
    """Return level and damping of a law, and its largest force at rest."""
    found = joints.simplified(subject)
    # Bodies at rest are held in both senses: the larger level counts.
    rest = max(float(subject.law.towards(side).break_away(found.load)) for side in (1, -1))
    return found, max(rest, found.joint.level)


@dataclass(frozen=True, kw_only=True)
class MuJoCo(Program):
    """MuJoCo's ``frictionloss``: a level that a soft constraint enforces, and a joint's damping.

    With an impedance d, b = 2 / (largest impedance x time constant), the inertia m and the joint's
    damping c, a held body creeps at force / (d b m / (1 - d) + c). Steps are semi-implicit; a time
    constant below two time steps counts as two.

    Examples
    --------
    >>> MuJoCo(timestep=0.001).name
    'mujoco'
    """

    name: ClassVar[str] = "mujoco"
    title: ClassVar[str] = "MuJoCo, frictionloss"

    timestep: Annotated[float, Quantity("h", "s", above=0)] = 0.002
    """Option ``timestep``."""
    time_constant: Annotated[float, Quantity("tau", "s", above=0)] = 0.02
    """First number of ``solreffriction``."""
    impedance: Annotated[float, Quantity("d", above=0, high=0.9999)] = 0.9
    """First number of ``solimpfriction``."""
    largest_impedance: Annotated[float, Quantity("d_max", above=0, high=0.9999)] = 0.95
    """Second number of ``solimpfriction``."""

    @property
    def damping(self) -> float:
        """Rate b at which the velocity of a held body decays [1/s]."""
        return 2.0 / (self.largest_impedance * max(self.time_constant, 2.0 * self.timestep))

    def taken(self, subject: Subject) -> Taken:
        found = joints.simplified(subject)
        solver = FixedStep(
            dt=self.timestep,
            method="semi-implicit",
            stick_rule=False,
            viscous=found.joint.damping,
            soft=SoftConstraint(impedance=self.impedance, damping=self.damping),
        )
        lost = found.lost if subject.levels == "per load" else _kept(found)
        return Taken(law=found.joint, solver=solver, level=found.joint.level, lost=lost)

    def creep(self, subject: Subject, taken: Taken, force: float) -> float:
        inertia = joints.inertia_of(subject)
        if inertia is None:
            return math.nan
        # Largest impedance enters by b alone; the soft constraint acts at the first one.
        held = self.impedance * self.damping * inertia / (1.0 - self.impedance)
        return force / (held + float(vars(taken.law)["damping"]))

    def settings(self, subject: Subject, taken: Taken) -> str:
        level, damping = (vars(taken.law)[name] for name in ("level", "damping"))
        return (
            f'frictionloss="{level:.6g}" damping="{damping:.6g}"'
            f' solreffriction="{self.time_constant:g} 1"'
            f' solimpfriction="{self.impedance:g} {self.largest_impedance:g} 0.001"'
            f' timestep="{self.timestep:g}"'
        )

    def stiffer(self, subject: Subject) -> "MuJoCo":
        time_constant, _, impedance, largest, _ = map(float, f"{joints.SOFT} {joints.HARD}".split())
        return MuJoCo(
            timestep=min(self.timestep, joints.TIMESTEP),
            time_constant=time_constant,
            impedance=impedance,
            largest_impedance=largest,
        )


@dataclass(frozen=True, kw_only=True)
class MuJoCoMotor(Program):
    """LuGre friction of MuJoCo's actuator ``dcmotor``, with the integrator Euler.

    Its bristles hold a body without creep; the error is that of the time step.

    Examples
    --------
    >>> MuJoCoMotor().name
    'mujoco-dcmotor'
    """

    name: ClassVar[str] = "mujoco-dcmotor"
    title: ClassVar[str] = "MuJoCo, dcmotor"

    timestep: Annotated[float, Quantity("h", "s", above=0)] = 0.002
    """Option ``timestep``."""

    def taken(self, subject: Subject) -> Taken:
        found = joints.as_lugre(subject.law)
        if found is None:
            raise InputError(
                f"{self.name}: dcmotor has LuGre friction with an exponent of 2 and linear viscous"
                f" friction, which {subject.law.name} is not: use mujoco, whose frictionloss has a"
                " level and a damping for it."
            )
        solver = FixedStep(
            dt=self.timestep,
            method="semi-implicit",
            stick_rule=False,
            viscous=found.viscous_coefficient,
        )
        load = subject.needed_load()
        return Taken(law=found, solver=solver, level=found.static_coefficient * load)

    def creep(self, subject: Subject, taken: Taken, force: float) -> float:
        return 0.0

    def settings(self, subject: Subject, taken: Taken) -> str:
        return f'timestep="{self.timestep:g}" integrator="Euler"'

    def stiffer(self, subject: Subject) -> "MuJoCoMotor":
        found, inertia = joints.as_lugre(subject.law), joints.inertia_of(subject)
        step = joints.TIMESTEP
        if found is not None and inertia is not None:
            step = joints.bristle_step(found, subject.needed_load(), inertia)[0]
        # A tenth of a step that is merely stable: errors are proportional to it.
        return MuJoCoMotor(timestep=min(self.timestep, step) / 10.0)


@dataclass(frozen=True, kw_only=True)
class Drake(Program):
    """Contact friction of Drake with the approximations ``lagged``, the default, and ``similar``.

    The friction force is mu N v / sqrt(v^2 + v_s^2), so a held body creeps at v_s s / sqrt(1 - s^2)
    under the share s of the level, whatever its inertia, and slower where its joint is damped.
    Errors of Drake's time step come on top.

    Examples
    --------
    >>> Drake().stiction_tolerance
    0.0001
    """

    name: ClassVar[str] = "drake"
    title: ClassVar[str] = "Drake, contact friction"

    stiction_tolerance: Annotated[float, Quantity("v_s", "m/s", above=0)] = 1e-4
    """``stiction_tolerance`` of ``MultibodyPlantConfig``."""

    def taken(self, subject: Subject) -> Taken:
        if subject.rotary:
            raise InputError(
                f"{self.name}: joints of Drake have no dry friction, and its contact friction acts"
                " along a line, not about an axis: choose another program."
            )
        found = joints.simplified(subject)
        values = {
            "kinetic_coefficient": found.joint.level / found.load,
            "smoothing_velocity": self.stiction_tolerance,
            "viscous_coefficient": found.joint.damping,
        }
        smooth = composed("root(level) + viscous")(**values)
        return Taken(law=smooth, solver=None, level=found.joint.level, lost=_kept(found))

    def creep(self, subject: Subject, taken: Taken, force: float) -> float:
        share = force / taken.level
        # F = mu N v / sqrt(v^2 + v_s^2), solved for v.
        undamped = self.stiction_tolerance * share / math.sqrt(1.0 - share**2)
        # Damping of the joint only slows it: the speed lies between 0 and that without it.
        return _steady_speed(subject, taken, force, undamped)

    def settings(self, subject: Subject, taken: Taken) -> str:
        unit = turned("m/s", subject.rotary)
        return (
            f"friction {quantity(taken.level, turned('N', subject.rotary), 6)}, joint damping"
            f" {number(_viscous(taken), 6)}, stiction_tolerance"
            f" {quantity(self.stiction_tolerance, unit)}"
        )

    def stiffer(self, subject: Subject) -> "Drake":
        return Drake(stiction_tolerance=min(self.stiction_tolerance, 1e-4) / 100.0)


@dataclass(frozen=True, kw_only=True)
class Simscape(Program):
    """The block Translational Friction (Rotational Friction) of Simscape.

    F = sqrt(2 e) (F_brk - F_C) exp(-(v / v_St)^2) v / v_St + F_C tanh(v / v_Coul) + f v, where v_St
    is sqrt(2) and v_Coul 1/10 times the breakaway friction velocity. A held body creeps at the
    speed at which this is the applied force.

    Examples
    --------
    >>> Simscape().breakaway_velocity
    0.1
    """

    name: ClassVar[str] = "simscape"
    title: ClassVar[str] = "Simscape, Translational (Rotational) Friction"

    breakaway_velocity: Annotated[float, Quantity("v_brk", "m/s", above=0)] = 0.1
    """Breakaway friction velocity, 0.1 by default."""

    def taken(self, subject: Subject) -> Taken:
        found, rest = _level_and_damping(subject)
        values = {
            "kinetic_coefficient": found.joint.level / found.load,
            "static_coefficient": rest / found.load,
            "breakaway_velocity": self.breakaway_velocity,
            "viscous_coefficient": found.joint.damping,
        }
        smooth = composed("simscape + viscous")(**values)
        # The block has a breakaway force of its own, so that static friction is not lost.
        lost = tuple(line for line in _kept(found) if not line.startswith("Static friction"))
        return Taken(law=smooth, solver=None, level=rest, lost=lost)

    def creep(self, subject: Subject, taken: Taken, force: float) -> float:
        # The force is largest at the breakaway velocity: creep is below it.
        return _steady_speed(subject, taken, force, self.breakaway_velocity)

    def settings(self, subject: Subject, taken: Taken) -> str:
        unit, speed = turned("N", subject.rotary), turned("m/s", subject.rotary)
        load = subject.needed_load()
        kinetic = float(vars(taken.law)["kinetic_coefficient"]) * load
        force = "torque" if subject.rotary else "force"
        return (
            f"Breakaway friction {force} {quantity(taken.level, unit, 6)}, Breakaway friction"
            f" velocity {quantity(self.breakaway_velocity, speed)}, Coulomb friction {force}"
            f" {quantity(kinetic, unit, 6)}, Viscous friction coefficient"
            f" {number(_viscous(taken), 6)}"
        )

    def stiffer(self, subject: Subject) -> "Simscape":
        return Simscape(breakaway_velocity=min(self.breakaway_velocity, 0.1) / 1000.0)


@dataclass(frozen=True, kw_only=True)
class Karnopp(Program):
    """A block diagram with a fixed step that holds a body within a dead band of its velocity.

    Examples
    --------
    >>> Karnopp(step=0.0005).step
    0.0005
    """

    name: ClassVar[str] = "karnopp"
    title: ClassVar[str] = "Fixed steps with Karnopp's dead band"

    step: Annotated[float, Quantity("h", "s", above=0)] = 0.001
    """Step of forward Euler."""
    band: Annotated[float, Quantity("D_v", "m/s", above=0)] | None = None
    """Dead band; twice what break-away changes of the velocity in a step if not given."""
    break_away: BreakAway = "static"
    """Friction out of rest, in the first step: ``static``, ``kinetic`` or ``zero``."""

    def taken(self, subject: Subject) -> Taken:
        load = subject.needed_load()
        if not subject.law.holds:
            raise InputError(
                f"{self.name}: {subject.law.name} holds nothing at rest, so no dead band applies:"
                " choose another program."
            )
        level = max(float(subject.law.towards(side).break_away(load)) for side in (1, -1))
        inertia = joints.inertia_of(subject)
        if self.band is None and inertia is None:
            raise InputError(f"{self.name}: the inertia of the slip is not known: give a band.")
        # Wider than what one step changes, so that a body cannot step over the band.
        band = WIDER * level * self.step / inertia if inertia and not self.band else self.band
        assert band is not None
        bristles = bool(subject.law.states)
        solver = FixedStep(
            dt=self.step,
            stick_rule=False,
            zero_velocity_band=band,
            # bristles have their own, and refuse any other than the default
            break_away=None if bristles and self.break_away == "static" else self.break_away,
        )
        return Taken(law=subject.law, solver=solver, level=level)

    def creep(self, subject: Subject, taken: Taken, force: float) -> float:
        return 0.0

    def settings(self, subject: Subject, taken: Taken) -> str:
        assert isinstance(taken.solver, FixedStep)
        band = quantity(taken.solver.zero_velocity_band, turned("m/s", subject.rotary))
        start = {"static": "at break-away", "kinetic": "of sliding", "zero": "zero"}
        first = f", friction {start[self.break_away]} in the first step out of rest"
        return (
            f"step {quantity(self.step, 's')}, dead band {band}{'' if taken.law.states else first}"
        )

    def stiffer(self, subject: Subject) -> "Karnopp":
        return replace(self, step=self.step / 10.0, band=self.band and self.band / 10.0)


PROGRAMS: Final[Mapping[str, type[Program]]] = MappingProxyType(
    {program.name: program for program in (MuJoCo, MuJoCoMotor, Drake, Simscape, Karnopp)}
)
"""Programs by name."""


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Twin(metaclass=Described):
    """A rig as another program simulates it, beside the exact run; made by `twin`."""

    program: Program
    """The program with its settings."""
    subject: Subject
    """Law, mechanism, load and range of speeds."""
    taken: Taken
    """The program's friction: law, solver and level."""
    exact: Trajectory
    """The run with the law, events located."""
    run: Trajectory
    """The run that the program makes."""
    mechanism: mechanisms.Mechanism
    """What moves."""
    y0: Mapping[str, float] | None
    """Initial states by name, as they were given."""
    slip: str
    """Name of the coordinate along which the contact slips."""
    force: float
    """Force [N] under which the creep is told."""
    creep: float
    """Speed [m/s] of a body at rest under that force; 0 where it is held, NaN if not known."""
    peak_error: float
    """Largest distance of the two runs along the slip [m]."""
    at: float
    """Time of it [s]."""

    @property
    def settings(self) -> str:
        """The settings as the program spells them."""
        return self.program.settings(self.subject, self.taken)

    @property
    def cure(self) -> Program:
        """The program with settings that come close to the law."""
        return self.program.stiffer(self.subject)

    def cured(self) -> "Twin":
        """Return the same rig in the program with settings that come close to the law."""
        return twin(
            self.mechanism,
            self.subject.law,
            self.cure,
            t_end=self.exact.span[1],
            y0=self.y0,
            force=self.force,
        )

    @property
    def sentences(self) -> tuple[str, ...]:
        """Settings, creep, error and what is lost, in words."""
        rotary = self.subject.rotary
        speed, length = turned("m/s", rotary), turned("m", rotary)
        force = quantity(self.force, turned("N", rotary))
        share = percent(self.force / self.taken.level)
        under = f"Under {force} ({share} of the largest friction at rest), a body at rest"
        said = [f"{self.program.title}: {self.settings}."]
        if self.creep > 0.0:
            said.append(f"{under} creeps at {quantity(self.creep, speed)}.")
        elif self.creep == 0.0:
            said.append(f"{under} stays where it is.")
        travel = float(np.ptp(self.exact[self.slip]))
        there, exactly = (float(run.at([self.at])[self.slip][0]) for run in (self.run, self.exact))
        said.append(
            f"Largest error of {self.slip}: {quantity(there - exactly, length)}, at"
            f" {quantity(self.at, 's')}; the exact run moves over {quantity(travel, length)}."
        )
        return (*said, *self.taken.lost)

    def to_dict(self) -> Mapping[str, Any]:
        """Return settings and predictions as plain numbers."""
        return {
            "program": self.program.name,
            "settings": asdict(self.program),
            "spelt": self.settings,
            "law": self.taken.law.name,
            "force": self.force,
            "creep": None if math.isnan(self.creep) else self.creep,
            "peak_error": self.peak_error,
            "at": self.at,
            "sentences": list(self.sentences),
        }

    def __repr__(self) -> str:
        unit = turned("m", self.subject.rotary)
        return f"<Twin: {self.program.title}, largest error {quantity(self.peak_error, unit)}>"


def twin(
    mechanism: mechanisms.Mechanism,
    law: FrictionLaw,
    program: str | Program,
    *,
    t_end: float,
    y0: Mapping[str, float] | None = None,
    force: float | None = None,
) -> Twin:
    """Simulate a rig as another program does, and compare that with the exact run.

    Programs hold a body at rest by a soft constraint, by a smooth law or by a dead band, and some
    have a level and a damping in place of the law. The run has the program's friction, and where it
    has fixed steps these too.

    Parameters
    ----------
    mechanism : Mechanism
        What moves; one contact that slips along a coordinate.
    law : FrictionLaw
        Friction of its contact.
    program : Program or str
        A program with its settings, or a name in `PROGRAMS` for those that it has by default.
    t_end : float
        Time at which both runs end [s].
    y0 : mapping of str to float, optional
        Initial states by name [SI]; those of the mechanism if not given.
    force : float, optional
        Force [N] under which the creep is told, below the largest friction at rest; 60 % of it if
        not given.

    Returns
    -------
    Twin
        Both runs, the creep, the largest error, and settings that come closer.

    Raises
    ------
    InputError
        If the program has nothing for this law or mechanism.
    SimulationError
        If the program's run diverges.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> from stickslip.mechanisms.drives import Sine
    >>> axis = Axis(inertia=2.0, drive=Sine(amplitude=4.0, frequency=0.5), load=1.0)
    >>> found = twin(axis, Coulomb(kinetic_coefficient=5.0), "mujoco", t_end=2.0)
    >>> print(found.sentences[1])
    Under 3 N (60 % of the largest friction at rest), a body at rest creeps at 1.58 mm/s.
    >>> (
    ...     found.peak_error > 1e-3,
    ...     twin(axis, Coulomb(kinetic_coefficient=5.0), found.cure, t_end=2.0).peak_error < 2e-6,
    ... )
    (True, True)
    """
    chosen = named(PROGRAMS, program, "program")() if isinstance(program, str) else program
    if not mechanisms.has_one_slip(mechanism):
        raise InputError(
            f"a twin is of one contact that slips along a coordinate, which {mechanism.name} does"
            " not have."
        )
    slip, rate = mechanisms.slip_names(mechanism)
    exact = simulate(mechanism, law, t_end=t_end, y0=y0)
    # Even times beside those of the steps, between which extremes may lie.
    even = np.linspace(0.0, t_end, TIMES)
    levels = levels_at(mechanism)
    subject = Subject(
        law=law,
        name=law.name,
        mechanism=mechanism,
        rotary=mechanisms.slips_by_angle(mechanism),
        levels=levels,
        load=mechanisms.static_normal_force(mechanism) if levels == "per load" else 1.0,
        # A body that never moves has no range: any speed serves.
        largest_speed=float(np.abs(exact.at(even)[rate]).max()) or REFERENCE_SPEED,
    )
    taken = chosen.taken(subject)
    assert subject.largest_speed is not None
    sliding = abs(float(law.steady(subject.largest_speed, subject.needed_load())))
    if taken.level <= ROUNDING * sliding:
        raise InputError(
            f"{chosen.name}: {law.name} has no friction at rest, so there is nothing to hold and"
            " nothing that creeps."
        )
    force = SHARE * taken.level if force is None else force
    if not 0.0 < force < (1.0 - ROUNDING) * taken.level:
        unit = turned("N", subject.rotary)
        raise InputError(
            "twin: force must be above 0 and below the largest friction at rest,"
            f" {quantity(taken.level, unit)}, got {quantity(force, unit)}."
        )
    try:
        run = simulate(
            mechanism,
            taken.law,
            t_end=t_end,
            y0=_begun(y0, mechanism, taken.law),
            solver=taken.solver,
        )
    except SimulationError as error:
        raise SimulationError(
            f"{chosen.title} does not get to the end: {error} Its settings are"
            f" {chosen.settings(subject, taken)}; take a smaller step, or the settings of"
            f" {chosen.stiffer(subject)!r}."
        ) from error
    t = np.union1d(even, run.t)
    apart = np.abs(run.at(t)[slip] - exact.at(t)[slip])
    return Twin(
        program=chosen,
        subject=subject,
        taken=taken,
        exact=exact,
        run=run,
        mechanism=mechanism,
        y0=y0,
        slip=slip,
        force=force,
        creep=chosen.creep(subject, taken, force),
        peak_error=float(apart.max()),
        at=float(t[apart.argmax()]),
    )


def _begun(
    y0: Mapping[str, float] | None, mechanism: mechanisms.Mechanism, law: FrictionLaw
) -> Mapping[str, float] | None:
    """Return initial states without those of bristles that a program's friction does not have."""
    if y0 is None:
        return None
    known = (*mechanism.coordinates, *mechanism.rates, *law.states)
    return {name: value for name, value in y0.items() if name in known}
