"""Scenes in USD: joints of PhysX (Isaac Sim) and of Newton."""

import math
from abc import abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import ClassVar, Final, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.exports.applying.edits import Edit
from stickslip.exports.applying.models import ONE_DAMPING, Friction, JointModel, ModelJoint, number
from stickslip.exports.applying.usd_text import Prim, Stage, stage_of

KINDS: Final = MappingProxyType(
    {
        "PhysicsRevoluteJoint": "hinge",
        "PhysicsPrismaticJoint": "slide",
        "PhysicsFixedJoint": "fixed",
        "PhysicsSphericalJoint": "ball",
        "PhysicsJoint": "free",
        "PhysicsDistanceJoint": "free",
    }
)
AXES: Final = MappingProxyType({"hinge": "angular", "slide": "linear"})
DEGREE: Final = math.pi / 180.0
"""USD has angles in degrees, and dampings over these."""


class UsdModel(JointModel):
    """A scene as text, in which a joint has attributes of a schema that is applied to it."""

    refuses: ClassVar[Mapping[str, str]] = ONE_DAMPING

    @abstractmethod
    def schema(self, axis: str) -> str:
        """Return the schema that a joint with an angular or linear axis needs."""

    @abstractmethod
    def names(self, axis: str) -> Mapping[str, str]:
        """Return the attributes of level, rest, damping and armature."""

    @classmethod
    @override
    def recognises(cls, path: Path, data: bytes) -> bool:
        return data.startswith(b"#usda")

    @cached_property
    def stage(self) -> Stage:
        """The elements of the file."""
        return stage_of(self.path, self.data)

    @override
    def joints(self) -> Iterator[ModelJoint]:
        for prim in self.stage.prims:
            if prim.kind in KINDS:
                kind = KINDS[prim.kind]
                names = self.names(AXES.get(kind, "")).values()
                given = {key: (prim.values[key].text, "") for key in names if key in prim.values}
                yield ModelJoint(name=prim.name, kind=kind, line=prim.line, place=prim, given=given)

    @override
    def attributes(self, joint: ModelJoint, friction: Friction) -> Mapping[str, str]:
        length, mass = self.stage.metres, self.stage.kilograms
        if length is None:
            raise InputError(
                f"{self.path} does not say its unit of length, which USD takes for a centimetre:"
                " write metersPerUnit into its first parentheses, for metres ( metersPerUnit = 1 )."
            )
        effort = mass * length * length if joint.rotary else mass * length
        values = {
            "level": friction.level / effort,
            "static": friction.static / effort,
            "damping": friction.damping[0] / (effort / DEGREE if joint.rotary else mass),
        }
        if friction.armature is not None:
            values["armature"] = friction.armature / (effort if joint.rotary else mass)
        names = self.names(AXES[joint.kind])
        return {names[key]: number(value) for key, value in values.items() if key in names}

    @override
    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        prim: Prim = joint.place
        return self.stage.edits(prim, values, self.schema(AXES[joint.kind]))


@final
class Physx(UsdModel):
    """A scene for PhysX 5.6 and later, as Isaac Sim 5 has it."""

    name: ClassVar[str] = "physx"
    title: ClassVar[str] = "USD for PhysX"
    program: ClassVar[str] = "PhysX"
    refuses: ClassVar[Mapping[str, str]] = MappingProxyType(
        {**ONE_DAMPING, "holds": "has friction at rest of its own, that of break-away"}
    )
    holds_statically: ClassVar[bool] = True

    @override
    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        yield from _of_drive(joint)
        found = joint.place.values.get("physxJoint:jointFriction")
        if found is not None and found.text not in ("0", "0.0"):
            yield (
                f"physxJoint:jointFriction = {found.text} adds friction in proportion to what the"
                " joint transmits: remove it."
            )

    @override
    def remarks(self) -> Sequence[str]:
        return ("PhysX has friction of joints that are part of an articulation only.",)

    @override
    def schema(self, axis: str) -> str:
        return f"PhysxJointAxisAPI:{axis}"

    @override
    def names(self, axis: str) -> Mapping[str, str]:
        before = f"physxJointAxis:{axis}"
        return {
            "static": f"{before}:staticFrictionEffort",
            "level": f"{before}:dynamicFrictionEffort",
            "damping": f"{before}:viscousFrictionCoefficient",
            "armature": f"{before}:armature",
        }


@final
class Newton(UsdModel):
    """A scene for Newton."""

    name: ClassVar[str] = "newton"
    title: ClassVar[str] = "USD for Newton"
    program: ClassVar[str] = "Newton"

    @override
    def schema(self, axis: str) -> str:
        return "NewtonJointAPI"

    @override
    def names(self, axis: str) -> Mapping[str, str]:
        return {
            "level": "newton:friction",
            "damping": "newton:damping",
            "armature": "newton:armature",
        }

    @override
    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        yield from _of_drive(joint)


def _of_drive(joint: ModelJoint) -> Iterator[str]:
    """Yield that a drive damps the joint too, in a sentence."""
    name = f"drive:{AXES[joint.kind]}:physics:damping"
    found = joint.place.values.get(name)
    if found is not None and found.text not in ("0", "0.0"):
        yield (
            f"The drive of the joint has a damping too, {name} = {found.text}, which comes on top:"
            " it is for control and not for friction."
        )
