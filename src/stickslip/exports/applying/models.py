"""Joints of URDF and MJCF files, and the friction that each format has for them."""

import contextlib
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import ClassVar, Final, final

from typing_extensions import override

from stickslip.errors import InputError, nearest
from stickslip.exports.applying.markup import Edit, Markup, Tag, read_markup
from stickslip.exports.joints import SOFT
from stickslip.mechanisms import has_macros

DIGITS: Final = 9
"""Significant digits of the numbers that are written."""
HARD: Final = "0.9999 0.9999 0.001"
"""Impedance of MuJoCo's friction constraint, the largest that it has: links of robots are light,
and the creep of a loaded joint is in proportion to its inverse inertia."""
DEEPEST: Final = 8
"""Files that include each other, one within the other."""
URDF_KINDS: Final = MappingProxyType(
    {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}
)
HOLDS_JOINTS: Final = ("body", "frame", "replicate", "worldbody", "mujocoinclude")
"""Elements of MJCF whose child <joint> is a joint; others have defaults and references."""


@final
@dataclass(frozen=True, kw_only=True)
class Friction:
    """What a joint of a model is given."""

    level: float
    """Friction at any speed [N] or [N m]."""
    damping: tuple[float, ...]
    """Coefficients of v, v |v| and v^3; one alone where the rest is 0."""
    armature: float | None = None
    """Inertia of motor and gear at the joint; None leaves that of the file."""


@final
@dataclass(frozen=True, kw_only=True)
class ModelJoint:
    """A joint of a file that can be given friction."""

    name: str
    rotary: bool
    tag: Tag
    has: Mapping[str, str]
    """Friction that the file gives it so far, as attributes."""
    inherited: Mapping[str, str]
    """Those of `has` that are not its own, with the class that they come from."""


@dataclass(frozen=True)
class Model(ABC):
    """A file with joints."""

    markup: Markup

    name: ClassVar[str]
    """Name of the format, as that of the target of `export`."""
    title: ClassVar[str]
    written: ClassVar[tuple[str, ...]]
    """Attributes that are read and reported."""

    @abstractmethod
    def joints(self) -> Iterator[tuple[Tag, str, Mapping[str, tuple[str, str]]]]:
        """Yield joints, their kind, and their friction by attribute with its class."""

    @abstractmethod
    def attributes(self, friction: Friction) -> Mapping[str, str]:
        """Return friction as attributes."""

    @abstractmethod
    def edits(self, joint: ModelJoint, friction: Friction) -> list[Edit]:
        """Return the edits that give a joint friction."""

    @abstractmethod
    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        """Yield what of it the format does not have, in sentences."""

    def joint(self, name: str) -> ModelJoint:
        """Return a joint by its name."""
        path, given = self.markup.path, list(self.joints())
        names = [tag.attributes.get("name", "") for tag, _, _ in given]
        if not name or name not in names:
            raise InputError(f"{self._unknown(name, names)}{self._unnamed(given)}")
        if Counter(names)[name] > 1:
            lines = [tag.line for tag, _, _ in given if tag.attributes.get("name") == name]
            raise InputError(
                f"{path}: {len(lines)} joints are called {name!r}, in lines"
                f" {', '.join(map(str, lines))}: rename all but one."
            )
        tag, kind, has = given[names.index(name)]
        if kind not in ("hinge", "slide"):
            movable = [n for n, (_, kind, _) in zip(names, given, strict=True) if kind in _MOVE]
            raise InputError(
                f"{path}: joint {name!r} is of type {kind}, which {_REFUSED.get(kind, _OTHER)}."
                f" Joints that take friction: {', '.join(filter(None, movable)) or 'none'}."
            )
        return ModelJoint(
            name=name,
            rotary=kind == "hinge",
            tag=tag,
            has={key: value for key, (value, _) in has.items()},
            inherited={key: where for key, (_, where) in has.items() if where},
        )

    @property
    def movable(self) -> list[str]:
        """Names of the joints that take friction."""
        return [
            tag.attributes["name"]
            for tag, kind, _ in self.joints()
            if kind in _MOVE and tag.attributes.get("name")
        ]

    def _unknown(self, name: str, names: list[str]) -> str:
        path, known = self.markup.path, list(filter(None, names))
        held = _included(self.markup, name)
        if held is not None:
            return (
                f"{path}: joint {name!r} is not in this file but in {held}, which it includes:"
                " apply the law to that file."
            )
        if not known:
            return f"{path} has no joint with a name, so none is {name!r}."
        close = nearest(name, known)
        hint = f" Did you mean {close}?" if close else ""
        return f"{path} has no joint {name!r}, but {', '.join(known)}.{hint}"

    def _unnamed(self, given: list[tuple[Tag, str, Mapping[str, tuple[str, str]]]]) -> str:
        lines = [str(tag.line) for tag, _, _ in given if not tag.attributes.get("name")]
        if not lines:
            return ""
        if len(lines) == 1:
            return f" A joint has no name (line {lines[0]}): give it one to apply a law to it."
        return (
            f" {len(lines)} joints have no name (lines {', '.join(lines)}): give each a name to"
            " apply a law to it."
        )


_MOVE: Final = ("hinge", "slide")
_OTHER: Final = "is not known here"
_FREE: Final = "moves in six directions, and a law is of one"
_REFUSED: Final = MappingProxyType(
    {
        "fixed": "does not move, so it has no friction",
        "floating": _FREE,
        "free": _FREE,
        "planar": "moves in three directions, and a law is of one",
        "ball": "turns about three axes, and a law is of one",
    }
)


def _number(value: float) -> str:
    return f"{value:.{DIGITS}g}"


def includes(markup: Markup) -> Iterator[Path]:
    """Yield the files that a file includes."""
    for tag in markup.root.walk():
        if tag.name == "include" and tag.attributes.get("file"):
            yield markup.path.parent / tag.attributes["file"]


def _included(markup: Markup, name: str, depth: int = DEEPEST) -> Path | None:
    """Return the included file that has a joint of a name."""
    for path in includes(markup) if depth else ():
        try:
            found = read_markup(path)
        except InputError:
            continue
        if any(
            tag.attributes.get("name") == name for tag in found.root.walk() if tag.name == "joint"
        ):
            return path
        deeper = _included(found, name, depth - 1)
        if deeper is not None:
            return deeper
    return None


@final
class UrdfModel(Model):
    """A robot description."""

    name: ClassVar[str] = "urdf"
    title: ClassVar[str] = "URDF"
    written: ClassVar[tuple[str, ...]] = ("friction", "damping")

    @override
    def joints(self) -> Iterator[tuple[Tag, str, Mapping[str, tuple[str, str]]]]:
        for tag in self.markup.root.children:
            if tag.name == "joint":
                kind, dynamics = tag.attributes.get("type", ""), _dynamics(tag)
                given = {} if dynamics is None else dynamics.attributes
                has = {key: (given[key], "") for key in self.written if key in given}
                yield tag, URDF_KINDS.get(kind, kind), has

    @override
    def attributes(self, friction: Friction) -> Mapping[str, str]:
        return {"damping": _number(friction.damping[0]), "friction": _number(friction.level)}

    @override
    def edits(self, joint: ModelJoint, friction: Friction) -> list[Edit]:
        values = self.attributes(friction)
        dynamics = _dynamics(joint.tag)
        if dynamics is not None:
            return self.markup.with_attributes({dynamics: values})
        if not joint.tag.children:
            raise InputError(
                f"{self.markup.path}: joint {joint.name!r} has neither <parent> nor <child>."
            )
        text = "".join(f' {key}="{value}"' for key, value in values.items())
        return [self.markup.with_child(joint.tag, f"<dynamics{text}/>")]

    @override
    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        if friction.armature is not None:
            yield (
                f"Armature: URDF has none for the {_number(friction.armature)}"
                f" {'kg m^2' if joint.rotary else 'kg'} of motor and gear; it is left out."
            )
        if any(one.name == "mimic" for one in joint.tag.children):
            yield (
                "The joint follows another one (mimic): simulators differ in whether its friction"
                " acts."
            )


def _dynamics(tag: Tag) -> Tag | None:
    return next((one for one in tag.children if one.name == "dynamics"), None)


@final
class MjcfModel(Model):
    """A model for MuJoCo."""

    name: ClassVar[str] = "mjcf"
    title: ClassVar[str] = "MJCF"
    written: ClassVar[tuple[str, ...]] = (
        "frictionloss", "damping", "armature", "solreffriction", "solimpfriction", "springdamper",
    )  # fmt: skip

    @override
    def joints(self) -> Iterator[tuple[Tag, str, Mapping[str, tuple[str, str]]]]:
        classes = self._classes()
        for tag in self.markup.root.walk():
            if tag.parent is None or tag.parent.name not in HOLDS_JOINTS:
                continue
            if tag.name == "freejoint":
                yield tag, "free", {}
            elif tag.name == "joint":
                values = dict(classes.get(_class_of(tag), classes[""]))
                values |= {key: (value, "") for key, value in tag.attributes.items()}
                kind, _ = values.get("type", ("hinge", ""))
                yield tag, kind, {key: values[key] for key in self.written if key in values}

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

        for tag in (one for root in _roots(self.markup) for one in root.children):
            if tag.name == "default":
                read(tag, found[""], "main")
                found[""] = found[tag.attributes.get("class", "main")]
        return found

    @override
    def attributes(self, friction: Friction) -> Mapping[str, str]:
        values = {
            "frictionloss": _number(friction.level),
            "damping": " ".join(map(_number, friction.damping)),
            "solreffriction": SOFT,
            "solimpfriction": HARD,
        }
        if friction.armature is not None:
            values["armature"] = _number(friction.armature)
        return values

    @override
    def edits(self, joint: ModelJoint, friction: Friction) -> list[Edit]:
        return self.markup.with_attributes({joint.tag: self.attributes(friction)})

    @override
    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        replaced = [key for key in joint.inherited if key in self.attributes(friction)]
        if replaced:
            given = ", ".join(
                f"{key}={joint.has[key]!r} of class {joint.inherited[key]!r}" for key in replaced
            )
            yield f"The joint's own attributes take the place of {given}; other joints keep these."
        unknown = _class_of(joint.tag)
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


def _roots(markup: Markup, depth: int = DEEPEST) -> Iterator[Tag]:
    """Yield the roots of the files that a file includes, and its own."""
    for path in includes(markup) if depth else ():
        with contextlib.suppress(InputError):  # MuJoCo says what it misses
            yield from _roots(read_markup(path), depth - 1)
    yield markup.root


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


def read_model(path: Path) -> Model:
    """Read a file, whose root says what it is."""
    markup = read_markup(path)
    root = markup.root
    if any(
        tag.name.startswith("xacro:") or "${" in "".join(tag.attributes.values())
        for tag in root.walk()
    ):
        raise has_macros(str(path))
    if root.name == "robot":
        return UrdfModel(markup)
    if root.name in ("mujoco", "mujocoinclude"):
        return MjcfModel(markup)
    raise InputError(
        f"{path} has the root <{root.name}>; a URDF file has <robot>, an MJCF file <mujoco>."
    )
