"""Friction of a joint in simulators: a level and damping in place of a law, and what that leaves.

MuJoCo and URDF have a level f and a damping d, some formats a polynomial in the speed and a static
level. They are those of least squares over the speeds of the law, with f, d >= 0; what that leaves
is compared at all speeds, and by runs of the law and of its simplification beside each other.
"""

import contextlib
import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Annotated, ClassVar, Final, Generic, TypeAlias, TypeVar

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Rig
from stickslip.engine.simulation import simulate
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import InputError, StickslipError
from stickslip.exports.languages import commented
from stickslip.exports.program import Export, Subject, Target
from stickslip.friction import Dahl, FrictionLaw, LuGre, SetValuedLaw
from stickslip.maths import Scalar
from stickslip.mechanisms import slip_names
from stickslip.quantities import Quantity, turned, vary
from stickslip.show.formatting import quantity

# Dry and viscous friction of a joint in place of a law, what that leaves, and what it changes.

SPEEDS: Final = 2001
"""Speeds in each direction at which the law is compared with its simplification."""
TIMES: Final = 2001
"""Times at which two runs are compared."""
LEAST_SPEED_SHARE: Final = 1e-6
"""Smallest speed over the largest: what sliding begins with."""
ROUNDING: Final = 1e-12
"""Relative residual that roundings leave."""
ROOTS: Final = 4.0 * np.linspace(0.0, 1.0, 201) ** 2
"""Speeds over the largest at which the damping may vanish, of polynomials that are tried."""
FORCE_TOLERANCE: Final = 1e-9
"""Relative difference below which two forces count as equal."""


@dataclass(frozen=True, kw_only=True)
class JointFriction(SetValuedLaw):
    """Friction of a joint in simulators: one level, whatever the load, and a viscous part."""

    name: ClassVar[str] = "joint-friction"
    title: ClassVar[str] = "Joint friction"
    formula: ClassVar[str] = r"F = f \operatorname{sgn} v + d v, \quad |F| \le f \text{ at rest}"
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = ("level", "damping")

    level: Annotated[float, Quantity("f", "N", low=0)]
    """Friction force at any speed, and its largest at rest."""
    damping: Annotated[float, Quantity("d", "N s/m", low=0)]
    """Growth of the friction force with the speed."""
    static_surplus: Annotated[float, Quantity("f_s - f", "N", low=0)] = 0.0
    """What rest holds above the level, in simulators that have it."""

    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        return self.level + self.damping * speed + 0.0 * load

    def break_away(self, load: Scalar) -> Scalar:
        return self.level + self.static_surplus + 0.0 * load


@dataclass(frozen=True, kw_only=True)
class PolynomialFriction(SetValuedLaw):
    """Friction of a joint in MuJoCo: one level, and a damping that changes with the speed."""

    name: ClassVar[str] = "polynomial-friction"
    title: ClassVar[str] = "Joint friction with a polynomial"
    formula: ClassVar[str] = (
        r"F = f \operatorname{sgn} v + (d + d_1 |v| + d_2 v^2) v, \quad |F| \le f \text{ at rest}"
    )
    sources: ClassVar[tuple[str, ...]] = ()
    fit_order: ClassVar[tuple[str, ...]] = (
        "level", "damping", "damping_slope", "damping_curvature",
    )  # fmt: skip

    level: Annotated[float, Quantity("f", "N", low=0)]
    """Friction force towards rest, and its largest at rest."""
    damping: Annotated[float, Quantity("d", "N s/m", low=0)]
    """Growth of the friction force with the speed near rest."""
    damping_slope: Annotated[float, Quantity("d_1", "N s^2/m^2")]
    """Growth of the damping with the speed."""
    damping_curvature: Annotated[float, Quantity("d_2", "N s^3/m^3", low=0)]
    """Growth of the damping with the square of the speed."""

    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        growth = self.damping_slope * speed + self.damping_curvature * speed * speed
        return self.level + (self.damping + growth) * speed + 0.0 * load

    def break_away(self, load: Scalar) -> Scalar:
        return self.level + 0.0 * load


JointLaw = TypeVar("JointLaw", bound=SetValuedLaw)
JointLaw_co = TypeVar("JointLaw_co", bound=SetValuedLaw, covariant=True)


@dataclass(frozen=True, kw_only=True)
class Compared(Generic[JointLaw_co]):
    """A law as another program has it."""

    joint: JointLaw_co
    """What stands for it, by least squares over both directions."""
    load: float
    """Normal force of both [N]."""
    largest_speed: float
    """End of the range over which they are compared [m/s]."""
    largest: float
    """Largest difference of the forces [N]."""
    rms: float
    """Root mean square of the difference, all speeds alike [N]."""
    lost: tuple[str, ...]
    """What the joint cannot have, in sentences."""
    effect: tuple[str, ...]
    """What it changes on a rig, in sentences; empty without one."""


Simplified: TypeAlias = Compared[JointFriction | PolynomialFriction]
"""A law as a joint of a simulator has it."""


def steady_force(
    subject: Subject, velocity: NDArray[np.float64], load: float
) -> NDArray[np.float64]:
    """Return the friction force of steady sliding."""
    law = subject.law
    assert subject.equations is not None  # refuses what is no law
    try:
        force = np.asarray([float(law.steady(float(v), load)) for v in velocity])
    except OverflowError:
        force = np.full(velocity.shape, np.inf)
    if not np.all(np.isfinite(force)):
        raise InputError(
            f"{law.title} friction is not finite up to {np.abs(velocity).max():g}"
            f" {turned('m/s', subject.rotary)} at a load of {load:g}: give a smaller load or"
            " largest speed."
        )
    return force


def simplified(
    subject: Subject, *, polynomial: bool = False, holds: bool = False, static: bool = False
) -> Simplified:
    """Return level and damping of a joint for a law, with what they leave.

    A polynomial of the damping is nowhere below 0, beyond the largest speed either: it is a sum of
    squares and of a slope. A joint that `holds` has the level of break-away, and the damping that
    then comes closest. A `static` one has the level of break-away at rest alone.

    Examples
    --------
    >>> from stickslip import Stribeck
    >>> law = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01)
    >>> found = simplified(Subject(law=law, name="law", load=10.0, largest_speed=1.0))
    >>> round(found.joint.level, 3), round(found.largest, 2), round(found.rms, 3)
    (2.009, 0.99, 0.08)
    """
    from scipy.optimize import nnls

    steady = steady_of(subject)
    most, velocity = steady.largest_speed, steady.velocity
    # All speeds alike, and powers of the share of the largest: columns of about one size.
    share = np.abs(velocity) / most
    powers = np.column_stack([np.sign(velocity), *(velocity * share**k / most for k in range(3))])
    # columns: a level, a damping, its growth, and (share - root)^2
    parts = np.eye(4)[:, :2]
    if polynomial:
        # s^2 - 2 s r + r^2 for roots r all over the range: nowhere negative, nor is any sum of
        # them.
        squares = np.stack([0.0 * ROOTS, ROOTS**2, -2.0 * ROOTS, 1.0 + 0.0 * ROOTS])
        parts = np.column_stack([np.eye(4)[:, :3], squares])
    known, held = np.zeros(4), max(steady.break_away)
    if holds:
        known[0] = held
        parts = parts[:, 1:]
    # Weights of at least 0 keep level and damping from driving the joint.
    weights, _ = nnls(powers @ parts, steady.force - powers @ known)
    result = known + parts @ weights
    # What least squares leave of the largest term is rounding.
    level, *dampings = np.where(np.abs(result) > ROUNDING * np.abs(result).max(), result, 0.0)
    damping, slope, curvature = (float(x / most ** (k + 1)) for k, x in enumerate(dampings))
    joint: JointFriction | PolynomialFriction
    if polynomial:
        rest = {"damping_slope": slope, "damping_curvature": curvature}
        joint = PolynomialFriction(level=float(level), damping=damping, **rest)
    else:
        surplus = max(0.0, held - float(level)) if static else 0.0
        joint = JointFriction(level=float(level), damping=damping, static_surplus=surplus)
    return compared(subject, steady, joint)


@dataclass(frozen=True, kw_only=True)
class Steady:
    """Friction of steady sliding in both directions, all speeds alike."""

    load: float
    """Normal force [N]."""
    largest_speed: float
    """End of the range of speeds [m/s]."""
    velocity: NDArray[np.float64]
    """From the largest backwards to the largest ahead [m/s]."""
    force: NDArray[np.float64]
    """Friction at these [N]."""
    break_away: tuple[float, float]
    """Largest friction at rest, ahead and backwards [N]."""


def steady_of(subject: Subject) -> Steady:
    """Return the friction of steady sliding over the range in which a law is used."""
    load, most = subject.needed_load(), subject.needed_speed()
    # Nothing from rest itself, where the law may be any force up to break-away.
    speed = np.linspace(LEAST_SPEED_SHARE * most, most, SPEEDS)
    velocity = np.concatenate([-speed[::-1], speed])
    ahead, back = (float(subject.law.towards(side).break_away(load)) for side in (1, -1))
    return Steady(
        load=load,
        largest_speed=most,
        velocity=velocity,
        force=steady_force(subject, velocity, load),
        break_away=(ahead, back),
    )


def compared(
    subject: Subject, steady: Steady, joint: JointLaw, called: str = "the joint's friction"
) -> Compared[JointLaw]:
    """Return what stands for a law, which sentences call by a name, with what it leaves."""
    stands = np.sign(steady.velocity) * joint.sliding(np.abs(steady.velocity), steady.load)
    residual = steady.force - stands
    # Rounding is no difference to tell.
    if float(np.abs(residual).max()) <= ROUNDING * float(np.abs(steady.force).max()):
        residual = np.zeros_like(residual)
    return Compared(
        joint=joint,
        load=steady.load,
        largest_speed=steady.largest_speed,
        largest=float(np.abs(residual).max()),
        rms=float(np.sqrt(np.mean(residual**2))),
        lost=tuple(_lost(subject, joint, steady, called)),
        effect=tuple(_effects(subject, joint)),
    )


def _effects(subject: Subject, joint: SetValuedLaw) -> Iterator[str]:
    """Yield the effect on the rig that was named, or on that of the law's file if it moves."""
    if subject.rig is not None:
        yield from _effect(subject.rig, *_runs(subject, subject.rig, joint))
    elif subject.own_rig is not None:
        with contextlib.suppress(StickslipError):  # nobody has asked for a run of it
            runs = _runs(subject, subject.own_rig, joint)
            _, rate = slip_names(subject.own_rig.mechanism)
            if any(run[rate].any() for run in runs):
                yield from _effect(subject.own_rig, *runs)


def _lost(subject: Subject, joint: SetValuedLaw, steady: Steady, called: str) -> Iterator[str]:
    """Yield what a joint with one level cannot have."""
    law, turning, load = subject.law, subject.rotary, steady.load
    unit, speed_unit = turned("N", turning), turned("m/s", turning)
    speed, ahead = steady.velocity[SPEEDS:], steady.force[SPEEDS:]
    # Seen along the motion, speeds growing as they do ahead.
    back = -steady.force[SPEEDS - 1 :: -1]
    held = float(joint.break_away(load))
    scale = max(float(np.abs(ahead).max()), float(np.abs(back).max()), held)
    same = np.allclose(ahead, back, rtol=FORCE_TOLERANCE, atol=FORCE_TOLERANCE * scale)
    levels = steady.break_away
    for level in dict.fromkeys(levels):
        if abs(level - held) > FORCE_TOLERANCE * scale:
            yield (
                f"Static friction: rest holds {quantity(level, unit)}, with {called}"
                f" {quantity(held, unit)}."
            )
    for forces in (ahead,) if same else (ahead, back):
        drop = float(forces[0] - forces.min())
        if drop > FORCE_TOLERANCE * scale:
            yield (
                f"Friction that falls with speed (Stribeck): by {quantity(drop, unit)} up to"
                f" {quantity(float(speed[forces.argmin()]), speed_unit)}."
            )
    if not same:
        most = float(np.abs(ahead - back).max())
        yield f"Different friction in the two directions: by up to {quantity(most, unit)}."
    if law.states:
        yield "Bristles: elastic displacement before slip, and friction that lags behind velocity."
    # A law of forces does not grow with the load, and needs no sentence.
    if float(law.towards(1).break_away(2.0 * load)) > levels[0]:
        yield from about_load(subject, load)
    if subject.at:
        yield f"Dependence on contact inputs: the joint has the friction at {subject.at_text}."


def about_load(subject: Subject, load: float) -> Iterator[str]:
    """Yield that a joint has its friction at one normal force, in a sentence, if there is one."""
    if subject.levels == "per load":
        yield (
            f"Dependence on the normal force: the joint has the friction at {quantity(load, 'N')}."
        )
    elif subject.has_normal_force:
        yield "Dependence on the normal force, which was not known."


def _runs(subject: Subject, rig: Rig, joint: SetValuedLaw) -> tuple[Trajectory, Trajectory]:
    """Return the motion of a rig with the law and with the joint, both computed exactly."""
    contacts = len(rig.mechanism.contacts())
    if contacts != 1:
        raise InputError(
            f"{rig.path or rig.heading} has {contacts} contacts; the effect of a joint's friction"
            " is computed for rigs with one: leave --rig out."
        )
    law_run, joint_run = (
        simulate(rig.mechanism, law, t_end=rig.t_end, y0=rig.start(law))
        for law in (replace(subject.law), joint)  # the rig tells inputs that change
    )
    t = np.union1d(np.linspace(0.0, rig.t_end, TIMES), np.union1d(law_run.t, joint_run.t))
    return law_run.at(t), joint_run.at(t)


def _effect(rig: Rig, true: Trajectory, changed: Trajectory) -> tuple[str, ...]:
    """Return what the joint changes of the motion of a rig."""
    slip, rate = slip_names(rig.mechanism)
    length, unit = partial(quantity, unit=true.units[slip]), true.units[rate]
    rounding = ROUNDING * float(np.abs(true[slip]).max())
    apart = np.abs(changed[slip] - true[slip])
    apart[apart <= rounding] = 0.0
    end, other = (float(run[slip][-1]) for run in (true, changed))
    further = other - end if abs(other - end) > rounding else 0.0
    fastest, faster = (float(np.abs(run[rate]).max()) for run in (true, changed))
    where = Path(rig.path).name or rig.heading
    return (
        f"On {where}, simulated exactly to {quantity(rig.t_end, 's')}: {slip} ends at {length(end)}"
        f" with the law and at {length(other)} with the joint's friction, {length(further)} apart.",
        f"Their largest distance is {length(float(apart.max()))}, at"
        f" {quantity(float(true.t[apart.argmax()]), 's')}; the largest speeds are"
        f" {quantity(fastest, unit)} and {quantity(faster, unit)}.",
    )


# MJCF and URDF: friction of a joint, with what that leaves of the law.

TIMESTEP: Final = 1e-3
"""Longest step of a model for MuJoCo [s]."""
STEADINESS: Final = 0.5
"""Largest step over the shortest time constant of body and bristles; up to 1 it is stable."""
SOFT: Final = "0.002 1"
"""Time constant [s] and damping ratio of MuJoCo's friction constraint."""
HARD: Final = "0.999 0.9999 0.001"
"""Its impedance: smallest, largest, and the width between them."""
CREEP: Final = (1.0 - 0.999) / 0.999 * 0.9999 * 0.002 / 2.0
"""Creep of a loaded joint with these [s], over force and inverse inertia; 1.06e-3 s by default."""


def _safe(text: str) -> str:
    while "--" in text:
        text = text.replace("--", "- -")
    return text


def _sentences(subject: Subject, found: Simplified) -> Iterator[str]:
    """Yield what a joint's friction leaves of the law."""
    unit, speed_unit = turned("N", subject.rotary), turned("m/s", subject.rotary)
    yield (
        f"Least squares over speeds up to {quantity(found.largest_speed, speed_unit)} leave"
        f" {quantity(found.largest, unit)} at most and {quantity(found.rms, unit)} rms."
    )
    yield from found.lost
    yield from found.effect


def _comment(subject: Subject, notes: Sequence[str], said: Sequence[str]) -> Iterator[str]:
    yield "  <!--"
    lines = [*subject.header(), *notes, *(f"- {line}" for line in said)]
    yield from (f"  {_safe(line)}" for line in commented(lines, "  "))
    yield "  -->"


def inertia_of(subject: Subject) -> float | None:
    """Return the inertia [kg] of what slips while all else rests at 0; None if it is not known."""
    mechanism = subject.mechanism
    contacts = () if mechanism is None else mechanism.contacts()
    slips = [contact.slip for contact in contacts if subject.contact in ("", contact.name)]
    if mechanism is None or len(slips) != 1 or not isinstance(slips[0], str):
        return None
    # Kinetic energy at a velocity of 1 is half the inertia.
    moving = defaultdict(float, {slips[0]: 1.0})
    result = float(2.0 * mechanism.kinetic_energy(defaultdict(float), moving))
    return result if math.isfinite(result) and result > 0.0 else None


def _about_inertia(subject: Subject, inertia: float | None) -> str:
    unit = turned("kg", subject.rotary)
    if inertia is None:
        return f"The inertia is not known: 1.0 {unit} stands for it."
    return f"The inertia is {inertia!r} {unit}."


@dataclass(frozen=True, kw_only=True)
class _Joint:
    """Friction of a joint in MuJoCo."""

    attributes: str
    """Attributes of the joint."""
    actuators: tuple[str, ...] = ()
    """Actuators that rub."""
    timestep: float = TIMESTEP
    """Time step of the model [s]."""
    integrator: str = "implicitfast"
    """Its integrator."""
    notes: tuple[str, ...]
    """How it is used, in sentences."""
    said: tuple[str, ...]
    """What it leaves of the law, in sentences."""


def _by_constraint(subject: Subject, inertia: float) -> _Joint:
    """Return the friction of a joint as a level and a damping."""
    result = simplified(subject)
    level, damping = result.joint.level, result.joint.damping
    creep = 0.6 * CREEP * level / inertia  # 60 % of the level, as the sentence says
    return _Joint(
        attributes=f' frictionloss="{level!r}" damping="{damping!r}"'
        f' solreffriction="{SOFT}" solimpfriction="{HARD}"',
        notes=(
            "The joint's friction is a simplification of this law. Copy frictionloss, damping,"
            " solreffriction and solimpfriction to the joint of your model.",
        ),
        said=(
            *_sentences(subject, result),
            "Creep: MuJoCo's frictionloss is a soft constraint. Loaded with 60 % of its level, this"
            f" joint creeps by {quantity(creep, turned('m/s', subject.rotary))}, in proportion to"
            " load and inverse inertia, at time steps up to 1 ms, and by twice that at 2 ms. With"
            " MuJoCo's defaults it is 1000 times as fast."
            + (
                ""
                if subject.rotary
                else " Inertia given as armature does not count in the stiffness of a slide joint,"
                " which then creeps more: give it as mass."
            ),
        ),
    )


def as_lugre(law: FrictionLaw) -> LuGre | None:
    """Return a law as LuGre friction that MuJoCo has, if it is such a law."""
    if isinstance(law, Dahl):
        values = next(inner for inner in LuGre.contained if inner.law == law.name).embed(law)
        # without a static surplus, the speed at which it fades has no effect
        start = LuGre(
            kinetic_coefficient=1.0,
            static_coefficient=1.0,
            stribeck_velocity=1.0,
            bristle_stiffness=1.0,
            bristle_damping=0.0,
            static_switch=law.static_switch,
        )
        if values is None:
            return None
        return as_lugre(vary(start, "friction", {f"friction.{k}": x for k, x in values.items()}))
    if not isinstance(law, LuGre) or law.static_switch:
        return None
    return law if law.fading_exponent == 2.0 and law.viscous_exponent == 1.0 else None


def bristle_step(law: LuGre, load: float, inertia: float) -> tuple[float, float]:
    """Return a time step for bristles on an inertia, and the shortest time constant of both [s]."""
    stiffness, damping = law.bristle_stiffness * load, law.bristle_damping * load
    shortest = math.sqrt(inertia / stiffness)
    if damping > 0.0:
        shortest = min(shortest, inertia / damping)
    step = STEADINESS * shortest
    # Two digits: a step is no number to be exact about.
    return TIMESTEP if step >= TIMESTEP else float(f"{step:.1e}"), shortest


def _by_bristles(subject: Subject, law: LuGre, inertia: float) -> _Joint:
    """Return the friction of a joint as bristles, which MuJoCo's model of a motor has."""
    load = subject.needed_load()
    stiffness, damping = law.bristle_stiffness * load, law.bristle_damping * load
    step, shortest = bristle_step(law, load, inertia)
    numbers = (
        stiffness,
        damping,
        law.kinetic_coefficient * load,
        law.static_coefficient * load,
        law.stribeck_velocity,
    )
    return _Joint(
        # MuJoCo adds the viscous part as damping of the joint.
        attributes=f' damping="{law.viscous_coefficient!r}"',
        actuators=(
            f'    <dcmotor name="{subject.name}_friction" joint="{subject.name}" resistance="1"'
            f' motorconst="1e-6 1e-6" lugre="{" ".join(map(repr, numbers))}"/>',
        ),
        timestep=step,
        integrator="Euler",
        notes=(
            "MuJoCo has this law since version 3.7, as friction of the actuator dcmotor. Copy that"
            " actuator and the damping to your model, and leave its control at 0: it is no drive.",
        ),
        said=(
            f"Steps: errors are proportional to the time step, which must be below"
            f" {quantity(shortest, 's')} for these bristles on this inertia; the model has"
            f" {quantity(step, 's')}. Use the integrator Euler: at the same step, the error of"
            " implicitfast is 20 to 200 times as large where bristles are damped.",
            *about_load(subject, load),
        ),
    )


class Mjcf(Target):
    """A model for MuJoCo with one joint, whose friction is to be copied."""

    name: ClassVar[str] = "mjcf"
    title: ClassVar[str] = "MuJoCo (MJCF)"
    evaluates: ClassVar[bool] = True

    def export(self, subject: Subject) -> Export:
        known, law, name = inertia_of(subject), as_lugre(subject.law), subject.name
        inertia = 1.0 if known is None else known
        joint = (
            _by_constraint(subject, inertia) if law is None else _by_bristles(subject, law, inertia)
        )
        about = _about_inertia(subject, known)
        notes = [*joint.notes, about]
        kind = "hinge" if subject.rotary else "slide"
        principal = " ".join([repr(inertia)] * 3)
        lines = [
            f'<mujoco model="{name}">',
            *_comment(subject, notes, joint.said),
            f'  <option timestep="{joint.timestep!r}" gravity="0 0 0"'
            f' integrator="{joint.integrator}"/>',
            "  <worldbody>",
            f'    <body name="{name}">',
            f'      <joint name="{name}" type="{kind}" axis="1 0 0"{joint.attributes}/>',
            f'      <inertial pos="0 0 0" mass="{inertia!r}" diaginertia="{principal}"/>',
            "    </body>",
            "  </worldbody>",
            "  <actuator>",
            f'    <motor name="{name}" joint="{name}"/>',
            *joint.actuators,
            "  </actuator>",
            "</mujoco>",
        ]
        said = joint.said if known is not None else (*joint.said, about)
        files = {f"{name}.xml": "\n".join(lines) + "\n"}
        return Export(target=self.name, files=files, remarks=said)


class Urdf(Target):
    """A robot of one joint, whose ``<dynamics>`` is to be copied."""

    name: ClassVar[str] = "urdf"
    title: ClassVar[str] = "URDF"
    evaluates: ClassVar[bool] = True

    def export(self, subject: Subject) -> Export:
        result = simplified(subject)
        joint, name, known = result.joint, subject.name, inertia_of(subject)
        inertia, said = 1.0 if known is None else known, tuple(_sentences(subject, result))
        notes = (
            "The joint's friction is a simplification of this law. Copy the element dynamics to the"
            " joint of your robot. URDF has no armature: reflected inertia belongs to the link.",
            _about_inertia(subject, known),
        )
        principal = " ".join(f'i{a}{b}="{inertia if a == b else 0.0!r}"' for a, b in _PAIRS)
        lines = [
            f'<robot name="{name}">',
            *_comment(subject, notes, said),
            '  <link name="base"/>',
            '  <link name="body">',
            "    <inertial>",
            f'      <mass value="{inertia!r}"/>',
            f"      <inertia {principal}/>",
            "    </inertial>",
            "  </link>",
            f'  <joint name="{name}" type="{"continuous" if subject.rotary else "prismatic"}">',
            '    <parent link="base"/>',
            '    <child link="body"/>',
            '    <axis xyz="1 0 0"/>',
            *(
                []
                if subject.rotary
                else ['    <limit lower="-1e3" upper="1e3" effort="1e6" velocity="1e3"/>']
            ),
            f'    <dynamics damping="{joint.damping!r}" friction="{joint.level!r}"/>',
            "  </joint>",
            "</robot>",
        ]
        files = {f"{name}.urdf": "\n".join(lines) + "\n"}
        return Export(target=self.name, files=files, remarks=said)


_PAIRS = (("x", "x"), ("x", "y"), ("x", "z"), ("y", "y"), ("y", "z"), ("z", "z"))
