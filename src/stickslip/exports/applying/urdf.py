"""Robot descriptions (URDF)."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import ClassVar, Final, final

from typing_extensions import override

from stickslip.errors import InputError
from stickslip.exports.applying.edits import Edit
from stickslip.exports.applying.markup import Markup, Tag, markup_of, root_of
from stickslip.exports.applying.mjcf import HARD
from stickslip.exports.applying.models import ONE_DAMPING, Friction, JointModel, ModelJoint, number
from stickslip.exports.joints import SOFT
from stickslip.mechanisms import has_macros

KINDS: Final = MappingProxyType({"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"})
WRITTEN: Final = ("friction", "damping")


@final
class Urdf(JointModel):
    """A robot description."""

    name: ClassVar[str] = "urdf"
    title: ClassVar[str] = "URDF"
    program: ClassVar[str] = "programs that read URDF"
    refuses: ClassVar[Mapping[str, str]] = ONE_DAMPING
    runs: ClassVar[bool] = True

    @classmethod
    @override
    def recognises(cls, path: Path, data: bytes) -> bool:
        return root_of(data) == "robot"

    @cached_property
    def markup(self) -> Markup:
        """The elements of the file."""
        found = markup_of(self.path, self.data)
        if any(
            tag.name.startswith("xacro:") or "${" in "".join(tag.attributes.values())
            for tag in found.root.walk()
        ):
            raise has_macros(str(self.path))
        return found

    @override
    def joints(self) -> Iterator[ModelJoint]:
        for tag in self.markup.root.children:
            if tag.name == "joint":
                kind, dynamics = tag.attributes.get("type", ""), _dynamics(tag)
                has = {} if dynamics is None else dynamics.attributes
                yield ModelJoint(
                    name=tag.attributes.get("name", ""),
                    kind=KINDS.get(kind, kind),
                    line=tag.line,
                    place=tag,
                    given={key: (has[key], "") for key in WRITTEN if key in has},
                )

    @override
    def attributes(self, joint: ModelJoint, friction: Friction) -> Mapping[str, str]:
        return {"damping": number(friction.damping[0]), "friction": number(friction.level)}

    @override
    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        tag: Tag = joint.place
        dynamics = _dynamics(tag)
        if dynamics is not None:
            return self.markup.with_attributes({dynamics: values})
        if not tag.children:
            raise InputError(f"{self.path}: joint {joint.name!r} has neither <parent> nor <child>.")
        text = "".join(f' {key}="{value}"' for key, value in values.items())
        return [self.markup.with_child(tag, f"<dynamics{text}/>")]

    @override
    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        if friction.armature is not None:
            yield (
                f"Armature: URDF has none for the {number(friction.armature)}"
                f" {'kg m^2' if joint.rotary else 'kg'} of motor and gear; it is left out."
            )
        if any(one.name == "mimic" for one in joint.place.children):
            yield (
                "The joint follows another one (mimic): simulators differ in whether its friction"
                " acts."
            )

    @override
    def remarks(self) -> Sequence[str]:
        return (
            "URDF has no settings for how friction is held. With MuJoCo's defaults, loaded joints"
            f' creep. The rows "stiff" are with solreffriction="{SOFT}" and'
            f' solimpfriction="{HARD}" at the joints and time steps of 1 ms: set these in your'
            " program, or apply the laws to an MJCF file, where they are written.",
        )


def _dynamics(tag: Tag) -> Tag | None:
    return next((one for one in tag.children if one.name == "dynamics"), None)
