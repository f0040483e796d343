"""Model files whose joints are given friction: MJCF, URDF and USD.

A model lists its joints with what the file says of their friction, tells what its format has of a
law, and returns the bytes with the new values in place.
"""

import math
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final

from stickslip.errors import InputError, nearest
from stickslip.exports.applying import markup as markups
from stickslip.exports.joints import SOFT, Compared, PolynomialFriction, Simplified, simplified
from stickslip.exports.program import Subject
from stickslip.friction import SetValuedLaw
from stickslip.mechanisms import DCMotor, has_macros
from stickslip.quantities import turned
from stickslip.show.documents import read_bytes
from stickslip.show.formatting import percent, quantity

# What a model file is: joints that can be given friction, and what its format has of a law.

DIGITS: Final = 9
"""Significant digits of the numbers that are written."""
SHARE: Final = 0.6
"""Share of break-away under which a joint has to hold."""


@dataclass(frozen=True, kw_only=True)
class Beside:
    """What the mechanism of a law has beside it at the joint."""

    damping: float = 0.0
    """Damper [N s/m] or [N m s/rad]."""
    armature: float | None = None
    """Inertia of motor and gear [kg] or [kg m^2]; None leaves that of the file."""
    motor: DCMotor | None = None
    """Motor with its gear, where the law was fitted through one."""


@dataclass(frozen=True, kw_only=True)
class Wishes:
    """How laws become what a format has: arguments of `apply`."""

    polynomial: bool = False
    """Whether the damping changes with the speed."""
    holds: bool = False
    """Whether the level is that of break-away."""


@dataclass(frozen=True, kw_only=True)
class Friction:
    """What a joint of a model is given."""

    level: float
    """Friction at any speed [N] or [N m]."""
    static: float
    """Largest friction at rest, of formats that have it."""
    damping: tuple[float, ...]
    """Coefficients of v, v |v| and v^3; one alone where the rest is 0."""
    armature: float | None = None
    """Inertia of motor and gear at the joint; None leaves that of the file."""


@dataclass(frozen=True, kw_only=True)
class Carried:
    """A law as a joint of a file has it."""

    values: Mapping[str, str]
    """What is written, by name."""
    near: Compared[SetValuedLaw] | None
    """What the joint has in place of the law; None if it has the law itself."""
    lost: tuple[str, ...]
    """What the file cannot have of the law, in sentences."""


@dataclass(frozen=True, kw_only=True)
class ModelJoint:
    """A joint of a file."""

    name: str
    """Its name; empty if it has none."""
    kind: str
    """``"hinge"``, ``"slide"`` or ``"either"``, if the file does not say; else no friction."""
    line: int
    place: Any
    """Where it stands, as the reader of the format gives it."""
    given: Mapping[str, tuple[str, str]]
    """Friction that the file gives it so far, by name, each with the class that it comes from."""

    @property
    def rotary(self) -> bool | None:
        """Whether it turns; None if the file does not say."""
        return None if self.kind == "either" else self.kind == "hinge"

    @property
    def has(self) -> Mapping[str, str]:
        """Friction that the file gives it so far, by name."""
        return {key: value for key, (value, _) in self.given.items()}


@dataclass(frozen=True)
class Model(ABC):
    """A file with joints; a format for a program is one subclass and its entry of `CONSUMERS`."""

    path: Path
    data: bytes

    name: ClassVar[str]
    """Name of the format, as ``--to`` takes it."""
    title: ClassVar[str]
    program: ClassVar[str]
    """What reads the file."""
    refuses: ClassVar[Mapping[str, str]] = MappingProxyType({})
    """Fields of `Wishes` that the format cannot meet, with what it has instead."""

    @classmethod
    @abstractmethod
    def recognises(cls, path: Path, data: bytes) -> bool:
        """Return whether a file seems to be of the format."""

    @abstractmethod
    def joints(self) -> Iterator[ModelJoint]:
        """Yield the joints, those that take no friction too."""

    @abstractmethod
    def carry(self, joint: ModelJoint, subject: Subject, beside: Beside, wishes: Wishes) -> Carried:
        """Return a law as a joint of the file has it."""

    @abstractmethod
    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[markups.Edit]:
        """Return the edits that give a joint values."""

    def has_exactly(self, subject: Subject) -> bool:  # most have no law itself
        """Return whether the format has the law itself, at all contact inputs."""
        return False

    def elsewhere(self, name: str) -> str:  # most files stand alone
        """Return where else a joint of a name is, in a sentence; empty if that is not known."""
        return ""

    def included(self) -> Sequence[markups.Markup]:
        """Return the files of XML that the file includes."""
        return ()

    def remarks(self) -> Sequence[str]:
        """Return what users of the file have to know, in sentences."""
        return ()

    def written(self, values: Sequence[tuple[ModelJoint, Mapping[str, str]]]) -> bytes:
        """Return the file with values of its joints."""
        return markups.edited(self.data, [edit for pair in values for edit in self.edits(*pair)])

    def joint(self, name: str) -> ModelJoint:
        """Return a joint by its name."""
        given = list(self.joints())
        names = [joint.name for joint in given]
        if not name or name not in names:
            raise InputError(f"{self._unknown(name, names)}{self._unnamed(given)}")
        if Counter(names)[name] > 1:
            lines = [str(joint.line) for joint in given if joint.name == name]
            raise InputError(
                f"{self.path}: {len(lines)} joints are called {name!r}, in lines"
                f" {', '.join(lines)}: rename all but one."
            )
        found = given[names.index(name)]
        if found.kind not in _MOVE:
            raise InputError(
                f"{self.path}: joint {name!r} is of type {found.kind}, which"
                f" {_REFUSED.get(found.kind, _OTHER)}. Joints that take friction:"
                f" {', '.join(self.movable) or 'none'}."
            )
        return found

    @property
    def movable(self) -> list[str]:
        """Names of the joints that take friction."""
        return [joint.name for joint in self.joints() if joint.kind in _MOVE and joint.name]

    def _unknown(self, name: str, names: list[str]) -> str:
        known = list(filter(None, names))
        if elsewhere := self.elsewhere(name):
            return elsewhere
        if not known:
            return f"{self.path} has no joint with a name, so none is {name!r}."
        close = nearest(name, known)
        hint = f" Did you mean {close}?" if close else ""
        return f"{self.path} has no joint {name!r}, but {', '.join(known)}.{hint}"

    def _unnamed(self, given: list[ModelJoint]) -> str:
        lines = [str(joint.line) for joint in given if not joint.name]
        if not lines:
            return ""
        if len(lines) == 1:
            return f" A joint has no name (line {lines[0]}): give it one to apply a law to it."
        return (
            f" {len(lines)} joints have no name (lines {', '.join(lines)}): give each a name to"
            " apply a law to it."
        )


class JointModel(Model):
    """A file whose joints have one level and a damping."""

    holds_statically: ClassVar[bool] = False
    """Whether a joint has a level of its own at rest."""

    @abstractmethod
    def attributes(self, joint: ModelJoint, friction: Friction) -> Mapping[str, str]:
        """Return friction as what is written."""

    @abstractmethod
    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        """Yield what of it the format does not have, in sentences."""

    def carry(self, joint: ModelJoint, subject: Subject, beside: Beside, wishes: Wishes) -> Carried:
        friction, near, lost = level_and_damping(
            subject, beside, wishes, static=self.holds_statically
        )
        return Carried(
            values=self.attributes(joint, friction),
            near=near,
            lost=(*lost, *self.lost(joint, friction)),
        )


def level_and_damping(
    subject: Subject, beside: Beside, wishes: Wishes, *, static: bool = False
) -> tuple[Friction, Simplified, tuple[str, ...]]:
    """Return a level and a damping for a law and what stands beside it, and what they leave."""
    near = simplified(subject, polynomial=wishes.polynomial, holds=wishes.holds, static=static)
    joint = near.joint
    damping = [joint.damping + beside.damping]
    if isinstance(joint, PolynomialFriction) and (joint.damping_slope or joint.damping_curvature):
        damping += [joint.damping_slope, joint.damping_curvature]
    friction = Friction(
        level=joint.level,
        static=float(joint.break_away(near.load)),
        damping=tuple(damping),
        armature=beside.armature,
    )
    return friction, near, (*of_damper(subject, beside), *_slips(subject, near), *near.lost)


def of_damper(subject: Subject, beside: Beside) -> Iterator[str]:
    """Yield that the damping is not that of the law alone, in a sentence."""
    if beside.damping:
        unit = turned("N s/m", subject.rotary)
        yield (
            f"The damping contains {quantity(beside.damping, unit)} of the mechanism on which the"
            " law was fitted."
        )


def _slips(subject: Subject, near: Simplified) -> Iterator[str]:
    push = SHARE * min(float(subject.law.towards(side).break_away(near.load)) for side in (1, -1))
    held = float(near.joint.break_away(near.load))
    if push > held:
        unit = turned("N", subject.rotary)
        yield (
            f"It slips where the law holds: {percent(SHARE)} of break-away,"
            f" {quantity(push, unit)}, is more than the level of {quantity(held, unit)}."
            " --holds (in Python holds=True) gives it the level of break-away."
        )


def number(value: float) -> str:
    """Return a number as it is written."""
    return f"{value:.{DIGITS}g}"


ONE_DAMPING: Final = MappingProxyType({"polynomial": "has one damping for all speeds"})
"""What formats without a polynomial refuse."""
_MOVE: Final = ("hinge", "slide", "either")
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


# Models for MuJoCo (MJCF).

HARD: Final = "0.9999 0.9999 0.001"
"""Impedance of MuJoCo's friction constraint, the largest that it has: links of robots are light,
and the creep of a loaded joint is in proportion to its inverse inertia."""
MOST_PARTS: Final = 100
"""Files that a model includes, one within the other or side by side."""
HOLDS_JOINTS: Final = ("body", "frame", "replicate", "worldbody", "mujocoinclude")
"""Elements of MJCF whose child <joint> is a joint; others have defaults and references."""
MJCF_WRITTEN: Final = (
    "frictionloss", "damping", "armature", "solreffriction", "solimpfriction", "springdamper",
)  # fmt: skip


class Mjcf(JointModel):
    """A model for MuJoCo."""

    name: ClassVar[str] = "mjcf"
    title: ClassVar[str] = "MJCF"
    program: ClassVar[str] = "MuJoCo"

    @classmethod
    def recognises(cls, path: Path, data: bytes) -> bool:
        return markups.root_of(data) in ("mujoco", "mujocoinclude")

    @cached_property
    def markup(self) -> markups.Markup:
        """The elements of the file."""
        return markups.markup_of(self.path, self.data)

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
                given={key: values[key] for key in MJCF_WRITTEN if key in values},
            )

    def _classes(self) -> dict[str, dict[str, tuple[str, str]]]:
        """Return attributes of joints by default class, with the class that gives each."""
        found: dict[str, dict[str, tuple[str, str]]] = {"": {}}

        def read(tag: markups.Tag, outer: Mapping[str, tuple[str, str]], top: str) -> None:
            name = tag.attributes.get("class", top or "main")
            own = dict(outer)
            for child in tag.children:
                if child.name == "joint":
                    own |= {key: (value, name) for key, value in child.attributes.items()}
            found[name] = own
            for child in tag.children:
                if child.name == "default":
                    read(child, own, "")

        for tag in (child for root in self._roots() for child in root.children):
            if tag.name == "default":
                read(tag, found[""], "main")
                found[""] = found[tag.attributes.get("class", "main")]
        return found

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

    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[markups.Edit]:
        return self.markup.with_attributes({joint.place: values})

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

    def parts(self) -> Iterator[tuple[str, markups.Markup]]:
        """Yield the files that are included, each behind those that it includes, by their names."""
        yield from _parts(self.path.parent, self.markup, {self.path.resolve()})

    def included(self) -> Sequence[markups.Markup]:
        return [part for _, part in self.parts()]

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

    def _roots(self) -> Iterator[markups.Tag]:
        """Yield the roots of the files that are included, and that of the file."""
        yield from (part.root for _, part in self.parts())
        yield self.markup.root


def _parts(
    main: Path, markup: markups.Markup, read: set[Path]
) -> Iterator[tuple[str, markups.Markup]]:
    """Yield what a file includes, each once: MuJoCo takes no file twice, nor one within itself."""
    for tag in markup.root.walk():
        name = tag.attributes.get("file", "")
        if tag.name != "include" or not name:
            continue
        # MuJoCo looks beside the main file, then beside the one that includes
        path = next(
            (file / name for file in (main, markup.path.parent) if (file / name).exists()), None
        )
        if path is None:
            continue  # MuJoCo says what it misses
        if path.resolve() in read or len(read) > MOST_PARTS:
            continue
        read.add(path.resolve())
        try:
            part = markups.markup_of(path, read_bytes(path))
        except InputError:
            continue
        yield from _parts(main, part, read)
        yield name, part


def _class_of(tag: markups.Tag) -> str:
    """Return the default class of a joint: its own, or the nearest childclass around it."""
    if "class" in tag.attributes:
        return tag.attributes["class"]
    outer = tag.parent
    while outer is not None:
        if "childclass" in outer.attributes:
            return outer.attributes["childclass"]
        outer = outer.parent
    return ""


# Robot descriptions (URDF).

URDF_KINDS: Final = MappingProxyType(
    {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}
)
URDF_WRITTEN: Final = ("friction", "damping")


class Urdf(JointModel):
    """A robot description."""

    name: ClassVar[str] = "urdf"
    title: ClassVar[str] = "URDF"
    program: ClassVar[str] = "programs that read URDF"
    refuses: ClassVar[Mapping[str, str]] = ONE_DAMPING

    @classmethod
    def recognises(cls, path: Path, data: bytes) -> bool:
        return markups.root_of(data) == "robot"

    @cached_property
    def markup(self) -> markups.Markup:
        """The elements of the file."""
        found = markups.markup_of(self.path, self.data)
        if any(
            tag.name.startswith("xacro:") or "${" in "".join(tag.attributes.values())
            for tag in found.root.walk()
        ):
            raise has_macros(str(self.path))
        return found

    def joints(self) -> Iterator[ModelJoint]:
        for tag in self.markup.root.children:
            if tag.name == "joint":
                kind, dynamics = tag.attributes.get("type", ""), _dynamics(tag)
                has = {} if dynamics is None else dynamics.attributes
                yield ModelJoint(
                    name=tag.attributes.get("name", ""),
                    kind=URDF_KINDS.get(kind, kind),
                    line=tag.line,
                    place=tag,
                    given={key: (has[key], "") for key in URDF_WRITTEN if key in has},
                )

    def attributes(self, joint: ModelJoint, friction: Friction) -> Mapping[str, str]:
        return {"damping": number(friction.damping[0]), "friction": number(friction.level)}

    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[markups.Edit]:
        tag: markups.Tag = joint.place
        dynamics = _dynamics(tag)
        if dynamics is not None:
            return self.markup.with_attributes({dynamics: values})
        if not tag.children:
            raise InputError(f"{self.path}: joint {joint.name!r} has neither <parent> nor <child>.")
        text = "".join(f' {key}="{value}"' for key, value in values.items())
        return [self.markup.with_child(tag, f"<dynamics{text}/>")]

    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        if friction.armature is not None:
            yield (
                f"Armature: URDF has none for the {number(friction.armature)}"
                f" {'kg m^2' if joint.rotary else 'kg'} of motor and gear; it is left out."
            )
        if any(child.name == "mimic" for child in joint.place.children):
            yield (
                "The joint follows another one (mimic): simulators differ in whether its friction"
                " acts."
            )

    def remarks(self) -> Sequence[str]:
        return (
            "URDF has no settings for how friction is held. With MuJoCo's defaults, loaded joints"
            f' creep: set solreffriction="{SOFT}" and solimpfriction="{HARD}" of the joints and'
            " time steps of 1 ms in your program, or apply the laws to an MJCF file, where they are"
            " written.",
        )


def _dynamics(tag: markups.Tag) -> markups.Tag | None:
    return next((child for child in tag.children if child.name == "dynamics"), None)


# Scenes in USD: joints of PhysX (Isaac Sim) and of Newton.

USD_KINDS: Final = MappingProxyType(
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
    def recognises(cls, path: Path, data: bytes) -> bool:
        return data.startswith(b"#usda")

    @cached_property
    def stage(self) -> markups.Stage:
        """The elements of the file."""
        return markups.stage_of(self.path, self.data)

    def joints(self) -> Iterator[ModelJoint]:
        for prim in self.stage.prims:
            if prim.kind in USD_KINDS:
                kind = USD_KINDS[prim.kind]
                names = self.names(AXES.get(kind, "")).values()
                given = {key: (prim.values[key].text, "") for key in names if key in prim.values}
                yield ModelJoint(name=prim.name, kind=kind, line=prim.line, place=prim, given=given)

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

    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[markups.Edit]:
        prim: markups.Prim = joint.place
        return self.stage.edits(prim, values, self.schema(AXES[joint.kind]))


class Physx(UsdModel):
    """A scene for PhysX 5.6 and later, as Isaac Sim 5 has it."""

    name: ClassVar[str] = "physx"
    title: ClassVar[str] = "USD for PhysX"
    program: ClassVar[str] = "PhysX"
    refuses: ClassVar[Mapping[str, str]] = MappingProxyType(
        {**ONE_DAMPING, "holds": "has friction at rest of its own, that of break-away"}
    )
    holds_statically: ClassVar[bool] = True

    def lost(self, joint: ModelJoint, friction: Friction) -> Iterator[str]:
        yield from _of_drive(joint)
        found = joint.place.values.get("physxJoint:jointFriction")
        if found is not None and found.text not in ("0", "0.0"):
            yield (
                f"physxJoint:jointFriction = {found.text} adds friction in proportion to what the"
                " joint transmits: remove it."
            )

    def remarks(self) -> Sequence[str]:
        return ("PhysX has friction of joints that are part of an articulation only.",)

    def schema(self, axis: str) -> str:
        return f"PhysxJointAxisAPI:{axis}"

    def names(self, axis: str) -> Mapping[str, str]:
        before = f"physxJointAxis:{axis}"
        return {
            "static": f"{before}:staticFrictionEffort",
            "level": f"{before}:dynamicFrictionEffort",
            "damping": f"{before}:viscousFrictionCoefficient",
            "armature": f"{before}:armature",
        }


class Newton(UsdModel):
    """A scene for Newton."""

    name: ClassVar[str] = "newton"
    title: ClassVar[str] = "USD for Newton"
    program: ClassVar[str] = "Newton"

    def schema(self, axis: str) -> str:
        return "NewtonJointAPI"

    def names(self, axis: str) -> Mapping[str, str]:
        return {
            "level": "newton:friction",
            "damping": "newton:damping",
            "armature": "newton:armature",
        }

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
