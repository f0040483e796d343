"""Models for MuJoCo (MJCF)."""

from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import ClassVar, Final, final

from typing_extensions import override

from stickslip.documents import read_bytes
from stickslip.errors import InputError
from stickslip.exports.applying.edits import Edit
from stickslip.exports.applying.markup import Markup, Tag, markup_of, root_of
from stickslip.exports.applying.models import Friction, JointModel, ModelJoint, number
from stickslip.exports.joints import SOFT

HARD: Final = "0.9999 0.9999 0.001"
"""Impedance of MuJoCo's friction constraint, the largest that it has: links of robots are light,
and the creep of a loaded joint is in proportion to its inverse inertia."""
MOST_PARTS: Final = 100
"""Files that a model includes, one within the other or side by side."""
HOLDS_JOINTS: Final = ("body", "frame", "replicate", "worldbody", "mujocoinclude")
"""Elements of MJCF whose child <joint> is a joint; others have defaults and references."""
WRITTEN: Final = (
    "frictionloss", "damping", "armature", "solreffriction", "solimpfriction", "springdamper",
)  # fmt: skip


@final
class Mjcf(JointModel):
    """A model for MuJoCo."""

    name: ClassVar[str] = "mjcf"
    title: ClassVar[str] = "MJCF"
    program: ClassVar[str] = "MuJoCo"
    runs: ClassVar[bool] = True

    @classmethod
    @override
    def recognises(cls, path: Path, data: bytes) -> bool:
        return root_of(data) in ("mujoco", "mujocoinclude")

    @cached_property
    def markup(self) -> Markup:
        """The elements of the file."""
        return markup_of(self.path, self.data)

    @override
    def joints(self) -> Iterator[ModelJoint]:
        classes = self._classes()
        for tag in self.markup.root.walk():
            if tag.parent is None or tag.parent.name not in HOLDS_JOINTS:
                continue
            values: dict[str, tuple[str, str]] = {}
            if tag.name == "freejoint":
                kind = "free"
            elif tag.name == "joint":
                values = dict(classes.get(_class_of(tag), classes[""]))
                values |= {key: (value, "") for key, value in tag.attributes.items()}
                kind, _ = values.get("type", ("hinge", ""))
            else:
                continue
            yield ModelJoint(
                name=tag.attributes.get("name", ""),
                kind=kind,
                line=tag.line,
                place=tag,
                given={key: values[key] for key in WRITTEN if key in values},
            )

    def _classes(self) -> dict[str, dict[str, tuple[str, str]]]:
        """Return attributes of joints by default class, with the class that gives each."""
        found: dict[str, dict[str, tuple[str, str]]] = {"": {}}

        def read(tag: Tag, outer: Mapping[str, tuple[str, str]], top: str) -> None:
            name = tag.attributes.get("class", top or "main")
            own = dict(outer)
            for one in tag.children:
                if one.name == "joint":
                    own |= {key: (value, name) for key, value in one.attributes.items()}
            found[name] = own
            for one in tag.children:
                if one.name == "default":
                    read(one, own, "")

        for tag in (one for root in self._roots() for one in root.children):
            if tag.name == "default":
                read(tag, found[""], "main")
                found[""] = found[tag.attributes.get("class", "main")]
        return found

    @override
    def attributes(self, joint: ModelJoint, friction: Friction) -> Mapping[str, str]:
        values = {
            "frictionloss": number(friction.level),
            "damping": " ".join(map(number, friction.damping)),
            "solreffriction": SOFT,
            "solimpfriction": HARD,
        }
        if friction.armature is not None:
            values["armature"] = number(friction.armature)
        return values

    @override
    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        return self.markup.with_attributes({joint.place: values})

    @override
    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        inherited = {key: where for key, (_, where) in joint.given.items() if where}
        replaced = [key for key in inherited if key in self.attributes(joint, friction)]
        if replaced:
            given = ", ".join(
                f"{key}={joint.has[key]!r} of class {inherited[key]!r}" for key in replaced
            )
            yield f"The joint's own attributes take the place of {given}; other joints keep these."
        unknown = _class_of(joint.place)
        if unknown not in self._classes():
            yield (
                f"Class {unknown!r} is neither in this file nor in one that it includes: the joint"
                f" is taken to {'turn' if joint.rotary else 'slide'}, as it says itself or by"
                " default."
            )
        if joint.has.get("springdamper", "0").split()[:1] not in ([], ["0"]):
            yield (
                f"springdamper={joint.has['springdamper']!r} makes MuJoCo compute a damping of its"
                " own, which takes the place of this one: remove it."
            )
        for tag in self.markup.root.walk():
            adds = [key for key in ("damping", "armature", "lugre") if key in tag.attributes]
            if adds and tag.attributes.get("joint") == joint.name and tag.name != "joint":
                yield (
                    f"The actuator <{tag.name}> in line {tag.line} has {' and '.join(adds)}, which"
                    " come on top of those of the joint."
                )

    def parts(self) -> Iterator[tuple[str, Markup]]:
        """Yield the files that are included, each behind those that it includes, by their names."""
        yield from _parts(self.path.parent, self.markup, {self.path.resolve()})

    @override
    def included(self) -> Sequence[Markup]:
        return [part for _, part in self.parts()]

    @override
    def elsewhere(self, name: str) -> str:
        for _, part in self.parts():
            if any(
                tag.attributes.get("name") == name
                for tag in part.root.walk()
                if tag.name == "joint"
            ):
                return (
                    f"{self.path}: joint {name!r} is not in this file but in {part.path}, which it"
                    " includes: apply the law to that file."
                )
        return ""

    def _roots(self) -> Iterator[Tag]:
        """Yield the roots of the files that are included, and that of the file."""
        yield from (part.root for _, part in self.parts())
        yield self.markup.root


def _parts(main: Path, markup: Markup, read: set[Path]) -> Iterator[tuple[str, Markup]]:
    """Yield what a file includes, each once: MuJoCo takes no file twice, nor one within itself."""
    for tag in markup.root.walk():
        name = tag.attributes.get("file", "")
        if tag.name != "include" or not name:
            continue
        # MuJoCo looks beside the main file, then beside the one that includes
        path = next(
            (one / name for one in (main, markup.path.parent) if (one / name).exists()), None
        )
        if path is None:
            continue  # MuJoCo says what it misses
        if path.resolve() in read or len(read) > MOST_PARTS:
            continue
        read.add(path.resolve())
        try:
            part = markup_of(path, read_bytes(path))
        except InputError:
            continue
        yield from _parts(main, part, read)
        yield name, part


def _class_of(tag: Tag) -> str:
    """Return the default class of a joint: its own, or the nearest childclass around it."""
    if "class" in tag.attributes:
        return tag.attributes["class"]
    outer = tag.parent
    while outer is not None:
        if "childclass" in outer.attributes:
            return outer.attributes["childclass"]
        outer = outer.parent
    return ""
