"""MJCF and URDF: friction of a joint, with what that leaves of the law."""

import math
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, final

from typing_extensions import override

from stickslip.exports.base import Export, Target
from stickslip.exports.languages import commented
from stickslip.exports.simplification import Simplified, about_load, simplified
from stickslip.exports.subject import Subject
from stickslip.formatting import quantity
from stickslip.friction import Dahl, FrictionLaw, LuGre
from stickslip.quantities import turned, vary

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
    yield "<!--"
    lines = [*subject.header(), *notes, *(f"- {line}" for line in said)]
    yield from (_safe(line) for line in commented(lines, "  "))
    yield "-->"


def inertia_of(subject: Subject) -> float | None:
    """Return the inertia [kg] of what slips while all else rests at 0; None if it is not known."""
    mechanism = subject.mechanism
    contacts = () if mechanism is None else mechanism.contacts()
    slips = [one.slip for one in contacts if subject.contact in ("", one.name)]
    if mechanism is None or len(slips) != 1 or not isinstance(slips[0], str):
        return None
    moving = defaultdict(float, {slips[0]: 1.0})
    found = float(2.0 * mechanism.kinetic_energy(defaultdict(float), moving))
    return found if math.isfinite(found) and found > 0.0 else None


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
    found = simplified(subject)
    level, damping = found.joint.level, found.joint.damping
    creep = 0.6 * CREEP * level / inertia
    return _Joint(
        attributes=f' frictionloss="{level!r}" damping="{damping!r}"'
        f' solreffriction="{SOFT}" solimpfriction="{HARD}"',
        notes=(
            "The joint's friction is a simplification of this law. Copy frictionloss, damping,"
            " solreffriction and solimpfriction to the joint of your model.",
        ),
        said=(
            *_sentences(subject, found),
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
        values = next(one for one in LuGre.contained if one.law == law.name).embed(law)
        # without a static surplus, the speed at which it fades has no effect
        start = LuGre(
            kinetic_coefficient=1.0,
            static_coefficient=1.0,
            stribeck_velocity=1.0,
            bristle_stiffness=1.0,
            bristle_damping=0.0,
            static_switch=law.static_switch,
        )
        return (
            None
            if values is None
            else as_lugre(
                vary(start, "friction", {f"friction.{name}": x for name, x in values.items()})
            )
        )
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


@final
class Mjcf(Target):
    """A model for MuJoCo with one joint, whose friction is to be copied."""

    name: ClassVar[str] = "mjcf"
    title: ClassVar[str] = "MuJoCo (MJCF)"
    evaluates: ClassVar[bool] = True

    @override
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
            *(f"  {line}" for line in _comment(subject, notes, joint.said)),
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
        return _export(self, said, f"{name}.xml", lines)


def _export(target: Target, said: Sequence[str], name: str, lines: Sequence[str]) -> Export:
    return Export(target=target.name, files={name: "\n".join(lines) + "\n"}, remarks=tuple(said))


@final
class Urdf(Target):
    """A robot of one joint, whose ``<dynamics>`` is to be copied."""

    name: ClassVar[str] = "urdf"
    title: ClassVar[str] = "URDF"
    evaluates: ClassVar[bool] = True

    @override
    def export(self, subject: Subject) -> Export:
        found = simplified(subject)
        joint, name, known = found.joint, subject.name, inertia_of(subject)
        inertia, said = 1.0 if known is None else known, tuple(_sentences(subject, found))
        notes = (
            "The joint's friction is a simplification of this law. Copy the element dynamics to the"
            " joint of your robot. URDF has no armature: reflected inertia belongs to the link.",
            _about_inertia(subject, known),
        )
        principal = " ".join(f'i{a}{b}="{inertia if a == b else 0.0!r}"' for a, b in _PAIRS)
        lines = [
            f'<robot name="{name}">',
            *(f"  {line}" for line in _comment(subject, notes, said)),
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
        return _export(self, said, f"{name}.urdf", lines)


_PAIRS = (("x", "x"), ("x", "y"), ("x", "z"), ("y", "y"), ("y", "z"), ("z", "z"))
