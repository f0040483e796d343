"""What a model file is: joints that can be given friction, and what its format has of a law."""

from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, ClassVar, Final, final

from typing_extensions import override

from stickslip.errors import InputError, nearest
from stickslip.exports.applying.edits import Edit, edited
from stickslip.exports.applying.markup import Markup
from stickslip.exports.simplification import Compared, PolynomialFriction, Simplified, simplified
from stickslip.exports.subject import Subject
from stickslip.formatting import percent, quantity
from stickslip.friction import SetValuedLaw
from stickslip.mechanisms import DCMotor
from stickslip.quantities import turned

DIGITS: Final = 9
"""Significant digits of the numbers that are written."""
SHARE: Final = 0.6
"""Share of break-away under which a joint has to hold."""


@final
@dataclass(frozen=True, kw_only=True)
class Beside:
    """What the mechanism of a law has beside it at the joint."""

    damping: float = 0.0
    """Damper [N s/m] or [N m s/rad]."""
    armature: float | None = None
    """Inertia of motor and gear [kg] or [kg m^2]; None leaves that of the file."""
    motor: DCMotor | None = None
    """Motor with its gear, where the law was fitted through one."""


@final
@dataclass(frozen=True, kw_only=True)
class Wishes:
    """How laws become what a format has: arguments of `apply`."""

    polynomial: bool = False
    """Whether the damping changes with the speed."""
    holds: bool = False
    """Whether the level is that of break-away."""


@final
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


@final
@dataclass(frozen=True, kw_only=True)
class Carried:
    """A law as a joint of a file has it."""

    values: Mapping[str, str]
    """What is written, by name."""
    near: Compared[SetValuedLaw] | None
    """What the joint has in place of the law; None if it has the law itself."""
    lost: tuple[str, ...]
    """What the file cannot have of the law, in sentences."""


@final
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
    runs: ClassVar[bool] = False
    """Whether MuJoCo can run the file."""

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
    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        """Return the edits that give a joint values."""

    def has_exactly(self, subject: Subject) -> bool:  # noqa: ARG002  # most have no law itself
        """Return whether the format has the law itself, at all contact inputs."""
        return False

    def elsewhere(self, name: str) -> str:  # noqa: ARG002  # most files stand alone
        """Return where else a joint of a name is, in a sentence; empty if that is not known."""
        return ""

    def included(self) -> Sequence[Markup]:
        """Return the files of XML that the file includes."""
        return ()

    def remarks(self) -> Sequence[str]:
        """Return what users of the file have to know, in sentences."""
        return ()

    def written(self, values: Sequence[tuple[ModelJoint, Mapping[str, str]]]) -> bytes:
        """Return the file with values of its joints."""
        return edited(self.data, [one for pair in values for one in self.edits(*pair)])

    def joint(self, name: str) -> ModelJoint:
        """Return a joint by its name."""
        given = list(self.joints())
        names = [one.name for one in given]
        if not name or name not in names:
            raise InputError(f"{self._unknown(name, names)}{self._unnamed(given)}")
        if Counter(names)[name] > 1:
            lines = [str(one.line) for one in given if one.name == name]
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
        return [one.name for one in self.joints() if one.kind in _MOVE and one.name]

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
        lines = [str(one.line) for one in given if not one.name]
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

    @override
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
