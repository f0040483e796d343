"""MJCF and URDF: dry and viscous friction of a joint, with what that leaves of the law."""

from collections.abc import Iterator, Sequence
from typing import ClassVar, final

from typing_extensions import override

from stickslip.exports.base import Export, Target
from stickslip.exports.programs import commented
from stickslip.exports.simplification import Simplified, simplified
from stickslip.exports.subject import Subject
from stickslip.formatting import quantity
from stickslip.quantities import turned

__all__ = ["Mjcf", "Urdf"]

OF_BODY = 0.1
"""Share of the inertia of an axis that the body has; the rest is armature.

MuJoCo 4.0 takes the stiffness of its friction constraint from the bodies: with a share of 0.0005,
friction hardly acts.
"""


def _safe(text: str) -> str:
    while "--" in text:
        text = text.replace("--", "- -")
    return text


def _sentences(subject: Subject, found: Simplified) -> Iterator[str]:
    """Yield what a joint's friction leaves of the law."""
    unit, speed_unit = turned("N", subject.turning), turned("m/s", subject.turning)
    yield (
        f"Least squares over speeds up to {quantity(found.largest_speed, speed_unit)} leave"
        f" {quantity(found.largest, unit)} at most and {quantity(found.rms, unit)} rms."
    )
    yield from found.lost
    yield from found.effect


def _comment(subject: Subject, found: Simplified, more: Sequence[str]) -> Iterator[str]:
    yield "<!--"
    lines = [*subject.header(), "The joint's friction is a simplification of this law.", *more]
    said = [f"- {line}" for line in _sentences(subject, found)]
    yield from (_safe(line) for line in commented([*lines, *said], "  "))
    yield "-->"


def _inertia(subject: Subject) -> tuple[float, bool]:
    """Return the inertia of what slips, if it is known, and whether it is that of an axis."""
    inertia = getattr(subject.mechanism, "inertia", None)
    if isinstance(inertia, float):
        return inertia, True
    mass = getattr(subject.mechanism, "mass", None)
    return (mass, False) if isinstance(mass, float) and not subject.turning else (1.0, False)


def _export(
    target: Target, subject: Subject, found: Simplified, name: str, lines: Sequence[str]
) -> Export:
    return Export(
        target=target.name,
        files={name: "\n".join(lines) + "\n"},
        remarks=tuple(_sentences(subject, found)),
    )


@final
class Mjcf(Target):
    """A model for MuJoCo with one joint, whose attributes are to be copied."""

    name: ClassVar[str] = "mjcf"
    title: ClassVar[str] = "MuJoCo (MJCF)"

    @override
    def export(self, subject: Subject) -> Export:
        found = simplified(subject)
        joint, name = found.joint, subject.name
        inertia, reflected = _inertia(subject)
        body = OF_BODY * inertia if reflected else inertia
        armature = inertia - body
        principal = " ".join([repr(body)] * 3)
        kind = "hinge" if subject.turning else "slide"
        notes = [
            "Copy frictionloss, damping and armature to the joint of your model.",
            "MuJoCo enforces frictionloss by a soft constraint: a loaded joint at rest creeps.",
        ]
        if reflected:
            notes.append(
                f"Armature and body share the inertia of the axis, {inertia!r}"
                f" {turned('kg', subject.turning)}: divide it as in your model. With a light body"
                " and a large armature, MuJoCo makes frictionloss too soft to act."
            )
        lines = [
            f'<mujoco model="{name}">',
            *(f"  {line}" for line in _comment(subject, found, notes)),
            '  <option timestep="0.001" gravity="0 0 0" integrator="implicitfast"/>',
            "  <worldbody>",
            f'    <body name="{name}">',
            f'      <joint name="{name}" type="{kind}" axis="1 0 0" frictionloss="{joint.level!r}"'
            f' damping="{joint.damping!r}" armature="{armature!r}"/>',
            f'      <inertial pos="0 0 0" mass="{body!r}" diaginertia="{principal}"/>',
            "    </body>",
            "  </worldbody>",
            "  <actuator>",
            f'    <motor name="{name}" joint="{name}"/>',
            "  </actuator>",
            "</mujoco>",
        ]
        return _export(self, subject, found, f"{name}.xml", lines)


@final
class Urdf(Target):
    """A robot of one joint, whose ``<dynamics>`` is to be copied."""

    name: ClassVar[str] = "urdf"
    title: ClassVar[str] = "URDF"

    @override
    def export(self, subject: Subject) -> Export:
        found = simplified(subject)
        joint, name = found.joint, subject.name
        inertia, _ = _inertia(subject)
        notes = (
            "Copy the element dynamics to the joint of your robot. URDF has no armature: reflected"
            " inertia belongs to the link.",
        )
        principal = " ".join(f'i{a}{b}="{inertia if a == b else 0.0!r}"' for a, b in _PAIRS)
        lines = [
            f'<robot name="{name}">',
            *(f"  {line}" for line in _comment(subject, found, notes)),
            '  <link name="base"/>',
            '  <link name="body">',
            "    <inertial>",
            f'      <mass value="{inertia!r}"/>',
            f"      <inertia {principal}/>",
            "    </inertial>",
            "  </link>",
            f'  <joint name="{name}" type="{"continuous" if subject.turning else "prismatic"}">',
            '    <parent link="base"/>',
            '    <child link="body"/>',
            '    <axis xyz="1 0 0"/>',
            *(
                []
                if subject.turning
                else ['    <limit lower="-1e3" upper="1e3" effort="1e6" velocity="1e3"/>']
            ),
            f'    <dynamics damping="{joint.damping!r}" friction="{joint.level!r}"/>',
            "  </joint>",
            "</robot>",
        ]
        return _export(self, subject, found, f"{name}.urdf", lines)


_PAIRS = (("x", "x"), ("x", "y"), ("x", "z"), ("y", "y"), ("y", "z"), ("z", "z"))
