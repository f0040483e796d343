"""Writes friction of laws into joints of a model file, and says what that leaves of them."""

import contextlib
import math
import os
import re
from abc import ABC, abstractmethod
from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, ClassVar, Final
from xml.parsers import expat

from stickslip import mechanisms
from stickslip.data import Rig
from stickslip.errors import InputError, UnknownNameError, nearest
from stickslip.exports.joints import (
    SOFT,
    PolynomialFriction,
    Simplified,
    simplified,
)
from stickslip.exports.program import Subject
from stickslip.exports.verb import Usage, evaluated, law_or_rig, subject_of
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import has_macros
from stickslip.quantities import Given, named, turned
from stickslip.show.described import Described
from stickslip.show.documents import NOT_XML, check_xml, json_value, read_bytes, write_file
from stickslip.show.formatting import joined, percent, quantity

if TYPE_CHECKING:
    from stickslip.exports.verb import Exported


# Files of XML and USD of which single values are changed, and every other byte stays.
#
# Formatting, comments and what nobody here knows of a format are kept because nothing is written
# anew: the text is read once for the places of tags, attributes and values, and edits are made
# there.

# Single values of a file are changed, and every other byte stays.


@dataclass(frozen=True)
class Edit:
    """Bytes that take the place of others."""

    start: int
    end: int
    text: bytes


def edited(data: bytes, edits: Sequence[Edit]) -> bytes:
    """Return the bytes with all edits done.

    Examples
    --------
    >>> edited(b"abcd", [Edit(1, 2, b"X"), Edit(4, 4, b"!")])
    b'aXcd!'
    """
    for change in sorted(edits, key=lambda edit: (edit.start, edit.end), reverse=True):
        data = data[: change.start] + change.text + data[change.end :]
    return data


def byte_of(text: str, place: int) -> int:
    """Return the byte of UTF-8 at which a character of a text stands.

    Examples
    --------
    >>> byte_of("µm", 1)
    2
    """
    return len(text[:place].encode("utf-8"))


# XML files of which single attributes are changed, and every other byte stays.

HEAD: Final = 100_000
"""Bytes at the beginning of a file within which its first element is sought."""
ATTRIBUTE: Final = re.compile(rb"""(?<!\s)\s++([^\s=/>]++)\s*+=\s*+("[^"]*"|'[^']*')""")


@dataclass(eq=False)
class Tag:
    """An element, and where it stands in the file."""

    name: str
    attributes: Mapping[str, str]
    start: int
    """First byte of the start tag."""
    line: int
    parent: "Tag | None"
    children: list["Tag"] = field(default_factory=list)
    head: int = 0
    """First byte behind the start tag."""
    end: int = 0
    """First byte behind the element."""

    def walk(self) -> Iterator["Tag"]:
        """Yield the element and all that it contains, in the order of the file."""
        yield self
        for child in self.children:
            yield from child.walk()


@dataclass(frozen=True)
class Markup:
    """A file, its bytes and its elements."""

    path: Path
    data: bytes
    root: Tag

    def with_attributes(self, changes: Mapping[Tag, Mapping[str, str]]) -> "list[Edit]":
        """Return edits that give elements attributes, in place of those of the same name."""
        return [
            edit
            for tag, values in changes.items()
            for edit in _attribute_edits(self.data, tag, values)
        ]

    def with_child(self, tag: Tag, text: str) -> "Edit":
        """Return the edit that puts an element behind the last child, indented as that."""
        last = tag.children[-1]
        first = tag.children[0]
        indent = re.search(rb"(\r?\n)[ \t]*\Z", self.data[tag.head : first.start])
        return Edit(last.end, last.end, (indent[0] if indent else b"") + text.encode("ascii"))


def _attribute_edits(data: bytes, tag: Tag, values: Mapping[str, str]) -> Iterator[Edit]:
    name_end = tag.start + 1 + len(tag.name.encode())
    there = {m[1].decode("latin-1"): m for m in ATTRIBUTE.finditer(data, name_end, tag.head)}
    last = max((m.end() for m in there.values()), default=name_end)
    added = ""
    for name, value in values.items():
        if name in there:
            start, end = there[name].span(2)
            yield Edit(start + 1, end - 1, value.encode("ascii"))
        else:
            added += f' {name}="{value}"'
    if added:
        yield Edit(last, last, added.encode("ascii"))


def root_of(data: bytes) -> str:
    """Return the name of the first element; empty of what is no XML."""
    result: list[str] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, _: result.append(name)
    with contextlib.suppress(*NOT_XML):
        parser.Parse(data[:HEAD], False)
    return result[0] if result else ""


def markup_of(path: Path, data: bytes) -> Markup:
    """Return an XML file with its elements."""
    check_xml(data, str(path))
    return Markup(path, data, _parsed(path, data))


def _parsed(path: Path, data: bytes) -> Tag:
    parser = expat.ParserCreate()
    roots: list[Tag] = []
    open_tags: list[Tag] = []

    def begin(name: str, attributes: dict[str, str]) -> None:
        start = parser.CurrentByteIndex
        if not data.startswith(b"<" + name.encode(), start):
            raise InputError(f"{path} is not in UTF-8: save it in that encoding first.")
        parent = open_tags[-1] if open_tags else None
        tag = Tag(name, attributes, start, parser.CurrentLineNumber, parent)
        tag.head = _tag_end(data, start)
        (roots if parent is None else parent.children).append(tag)
        open_tags.append(tag)

    def finish(_: str) -> None:
        tag = open_tags.pop()
        closed = parser.CurrentByteIndex
        # an empty element has no end tag
        tag.end = tag.head if data[tag.head - 2] == ord("/") else data.index(b">", closed) + 1

    parser.StartElementHandler, parser.EndElementHandler = begin, finish
    parser.Parse(data, True)
    return roots[0]


def _tag_end(data: bytes, start: int) -> int:
    """Return the first byte behind a start tag; values may contain ``>``."""
    result = re.compile(rb"""(?:[^"'>]|"[^"]*"|'[^']*')*>""").match(data, start)
    assert result is not None  # expat has found the tag well-formed
    return result.end()


# Scenes of USD as text: where prims, their schemas and their values stand.

TOKEN: Final = re.compile(
    rb"""
      (?P<space>[ \t\r\n]+ | \#[^\r\n]* | //[^\r\n]* | /\*.*?\*/)
    | (?P<text>\"\"\"(?:\\.|[^\\])*?\"\"\" | '''(?:\\.|[^\\])*?'''
             | "(?:\\.|[^"\\\r\n])*" | '(?:\\.|[^'\\\r\n])*')
    | (?P<path>@@@.*?@@@ | @[^@\r\n]*@ | <[^>\r\n]*>)
    | (?P<mark>[(){}\[\]=;,])
    | (?P<word>(?!/\*)[^\s(){}\[\]=;,"'@<#]+)
    """,
    re.VERBOSE | re.DOTALL,
)
PAIRS: Final = {b"(": b")", b"{": b"}", b"[": b"]"}
SPECIFIERS: Final = (b"def", b"over", b"class")
OTHERS: Final = (b"delete", b"reorder")
"""Edits of a list that add nothing to it."""


@dataclass(frozen=True)
class Token:
    """A word, text, path or mark."""

    kind: str
    data: bytes
    start: int
    end: int

    @property
    def text(self) -> str:
        """What it says."""
        return self.data.decode("utf-8", "replace")


@dataclass(kw_only=True)
class Prim:
    """An element of a scene."""

    name: str
    kind: str
    line: int
    named: int
    """First byte behind the name."""
    body: int
    """First byte behind the brace that opens it."""
    head: tuple[int, int] | None
    """Bytes of its metadata, without parentheses."""
    schemas: tuple[Token, ...] | None
    """The list of applied schemas to which one can be added, with its brackets."""
    values: dict[str, Token] = field(default_factory=dict)
    """Single values of its attributes."""


@dataclass(frozen=True, kw_only=True)
class Stage:
    """A scene."""

    data: bytes
    prims: tuple[Prim, ...]
    metres: float | None
    """Length of a unit [m], if the file says it."""
    kilograms: float
    """Mass of a unit [kg]."""

    def edits(self, prim: Prim, values: Mapping[str, str], schema: str) -> list[Edit]:
        """Return the edits that apply a schema to a prim, and give it values."""
        result, added = list(self._schema(prim, schema)), ""
        newline, indent = self._indent(prim.body)
        for name, value in values.items():
            if name in prim.values:
                there = prim.values[name]
                result.append(Edit(there.start, there.end, value.encode("ascii")))
            else:
                added += f"{newline}{indent}float {name} = {value}"
        if added:
            place = self._behind(prim.body)
            # what follows in the line goes on in one of its own
            added += newline if self._rest(place) else ""
            result.append(Edit(place, place, added.encode("ascii")))
        return result

    def _schema(self, prim: Prim, schema: str) -> Iterator[Edit]:
        text = f'"{schema}"'
        if prim.schemas is not None:
            names = [token for token in prim.schemas if token.kind == "text"]
            if any(name.text[1:-1] == schema for name in names):
                return
            place = names[-1].end if names else prim.schemas[0].end
            text = f", {text}" if names else text
        else:
            newline, indent = self._indent(prim.body)
            line = f"{newline}{indent}prepend apiSchemas = [{text}]"
            if prim.head is not None:
                place = self._behind(prim.head[0])
                text = line + (newline if self._rest(place) else "")
            else:
                place, text = prim.named, f" ({line}{newline}{indent[:-4]})"
        yield Edit(place, place, text.encode("ascii"))

    def _indent(self, place: int) -> tuple[str, str]:
        """Return the line break of the file, and the indentation of what stands in a prim."""
        start = self.data.rfind(b"\n", 0, place) + 1
        line = re.match(rb"[ \t]*", self.data[start:])
        assert line is not None  # it may be empty
        newline = "\r\n" if b"\r\n" in self.data else "\n"
        return newline, line[0].decode("ascii") + "    "

    def _behind(self, place: int) -> int:
        """Return the place, or behind the comment that follows it in the line."""
        result = re.compile(rb"[ \t]*(?:#|//)[^\r\n]*").match(self.data, place)
        return place if result is None else result.end()

    def _rest(self, place: int) -> bytes:
        """Return what follows in the line."""
        return self.data[place : self.data.find(b"\n", place)].strip()


def stage_of(path: Path, data: bytes) -> Stage:
    """Return a scene with its prims."""
    tokens = list(_tokens(path, data))
    closes = _closes(path, data, tokens)
    prims = tuple(_prims(data, tokens, closes))
    units = {
        name: _length(path, value)
        for name, value in (_values(tokens, closes, 0) if 0 in closes else ())
        if name in ("metersPerUnit", "kilogramsPerUnit")
    }
    return Stage(
        data=data,
        prims=prims,
        metres=units.get("metersPerUnit"),
        kilograms=units.get("kilogramsPerUnit", 1.0),
    )


def _length(path: Path, token: Token) -> float:
    try:
        result = float(token.text)
    except ValueError:
        result = 0.0
    if not 0.0 < result < float("inf"):
        raise InputError(f"{path}: a unit of the scene must be above 0, got {token.text}.")
    return result


def _tokens(path: Path, data: bytes) -> Iterator[Token]:
    place = 0
    while place < len(data):
        result = TOKEN.match(data, place)
        if result is None:
            raise InputError(f"{path} is not USD: {_line(data, place)}.")
        if result.lastgroup != "space":
            yield Token(str(result.lastgroup), result[0], result.start(), result.end())
        place = result.end()


def _line(data: bytes, place: int) -> str:
    lines = data.count(b"\n", 0, place)
    return f"line {lines + 1} cannot be read"


def _closes(path: Path, data: bytes, tokens: Sequence[Token]) -> dict[int, int]:
    """Return where what each opening mark opens is closed."""
    result: dict[int, int] = {}
    opened: list[int] = []
    for i, token in enumerate(tokens):
        if token.data in PAIRS and token.kind == "mark":
            opened.append(i)
        elif token.kind == "mark" and token.data in PAIRS.values():
            if not opened or PAIRS[tokens[opened[-1]].data] != token.data:
                raise InputError(f"{path} is not USD: {_line(data, token.start)}.")
            result[opened.pop()] = i
    if opened:
        raise InputError(f"{path} is not USD: {_line(data, tokens[opened[-1]].start)}.")
    return result


def _prims(data: bytes, tokens: Sequence[Token], closes: Mapping[int, int]) -> Iterator[Prim]:
    counted, lines = 0, 1
    for i, token in enumerate(tokens):
        if token.kind != "word" or token.data not in SPECIFIERS:
            continue
        lines += data.count(b"\n", counted, token.start)
        counted = token.start
        at = i + 1 if _kind(tokens, i + 1) == "text" else i + 2
        if _kind(tokens, at) != "text":
            continue
        head = at + 1 if at + 1 in closes and tokens[at + 1].data == b"(" else None
        body = (at if head is None else closes[head]) + 1
        if body not in closes or tokens[body].data != b"{":
            continue
        inner = None if head is None else (tokens[head].end, tokens[closes[head]].start)
        yield Prim(
            name=tokens[at].text[1:-1],
            kind=tokens[i + 1].text if at == i + 2 else "",
            line=lines,
            named=tokens[at].end,
            body=tokens[body].end,
            head=inner,
            schemas=None if head is None else _schemas(tokens, closes, head),
            values=dict(_values(tokens, closes, body)),
        )


def _kind(tokens: Sequence[Token], place: int) -> str:
    return tokens[place].kind if place < len(tokens) else ""


def _schemas(
    tokens: Sequence[Token], closes: Mapping[int, int], head: int
) -> tuple[Token, ...] | None:
    for i in _level(closes, head):
        listed = tokens[i].data == b"apiSchemas" and i + 2 in closes
        if listed and tokens[i - 1].data not in OTHERS:
            return tuple(tokens[i + 2 : closes[i + 2] + 1])
    return None


def _values(
    tokens: Sequence[Token], closes: Mapping[int, int], body: int
) -> Iterator[tuple[str, Token]]:
    for i in _level(closes, body):
        if tokens[i].data == b"=" and tokens[i - 1].kind == _kind(tokens, i + 1) == "word":
            yield tokens[i - 1].text, tokens[i + 1]


def _level(closes: Mapping[int, int], opening: int) -> Iterator[int]:
    """Yield what stands between two marks, without what other marks enclose there."""
    i = opening + 1
    while i < closes[opening]:
        yield i
        i = closes.get(i, i) + 1


# Writes friction of laws into joints of a model file, and says what that leaves of them.

# Model files whose joints are given friction: MJCF, URDF and USD.
#
# A model lists its joints with what the file says of their friction, tells what its format has of a
# law, and returns the bytes with the new values in place.

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
    near: Simplified
    """What the joint has in place of the law."""
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
    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        """Return the edits that give a joint values."""

    def elsewhere(self, name: str) -> str:  # most files stand alone
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
        return edited(self.data, [edit for pair in values for edit in self.edits(*pair)])

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
        result = given[names.index(name)]
        if result.kind not in _MOVE:
            raise InputError(
                f"{self.path}: joint {name!r} is of type {result.kind}, which"
                f" {_REFUSED.get(result.kind, _OTHER)}. Joints that take friction:"
                f" {', '.join(self.movable) or 'none'}."
            )
        return result

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


class XmlModel(JointModel):
    """A file of XML."""

    roots: ClassVar[tuple[str, ...]]
    """Names of its first element."""

    @classmethod
    def recognises(cls, path: Path, data: bytes) -> bool:
        return root_of(data) in cls.roots

    @cached_property
    def markup(self) -> Markup:
        """The elements of the file."""
        return markup_of(self.path, self.data)


class Mjcf(XmlModel):
    """A model for MuJoCo."""

    name: ClassVar[str] = "mjcf"
    roots: ClassVar[tuple[str, ...]] = ("mujoco", "mujocoinclude")
    title: ClassVar[str] = "MJCF"
    program: ClassVar[str] = "MuJoCo"

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
        result: dict[str, dict[str, tuple[str, str]]] = {"": {}}

        def read(tag: Tag, outer: Mapping[str, tuple[str, str]], top: str) -> None:
            name = tag.attributes.get("class", top or "main")
            own = dict(outer)
            for child in tag.children:
                if child.name == "joint":
                    own |= {key: (value, name) for key, value in child.attributes.items()}
            result[name] = own
            for child in tag.children:
                if child.name == "default":
                    read(child, own, "")

        for tag in (child for root in self._roots() for child in root.children):
            if tag.name == "default":
                read(tag, result[""], "main")
                result[""] = result[tag.attributes.get("class", "main")]
        return result

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

    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
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

    def parts(self) -> Iterator[tuple[str, Markup]]:
        """Yield the files that are included, each behind those that it includes, by their names."""
        yield from _parts(self.path.parent, self.markup, {self.path.resolve()})

    def included(self) -> Sequence[Markup]:
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
            (file / name for file in (main, markup.path.parent) if (file / name).exists()), None
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


# Robot descriptions (URDF).

URDF_KINDS: Final = MappingProxyType(
    {"revolute": "hinge", "continuous": "hinge", "prismatic": "slide"}
)
URDF_WRITTEN: Final = ("friction", "damping")


class Urdf(XmlModel):
    """A robot description."""

    name: ClassVar[str] = "urdf"
    title: ClassVar[str] = "URDF"
    program: ClassVar[str] = "programs that read URDF"
    roots: ClassVar[tuple[str, ...]] = ("robot",)
    refuses: ClassVar[Mapping[str, str]] = ONE_DAMPING

    @cached_property
    def markup(self) -> Markup:
        """The elements of the file."""
        result = markup_of(self.path, self.data)
        if any(
            tag.name.startswith("xacro:") or "${" in "".join(tag.attributes.values())
            for tag in result.root.walk()
        ):
            raise has_macros(str(self.path))
        return result

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

    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        tag: Tag = joint.place
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


def _dynamics(tag: Tag) -> Tag | None:
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
    def stage(self) -> Stage:
        """The elements of the file."""
        return stage_of(self.path, self.data)

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

    def edits(self, joint: ModelJoint, values: Mapping[str, str]) -> list[Edit]:
        prim: Prim = joint.place
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
        result = joint.place.values.get("physxJoint:jointFriction")
        if result is not None and result.text not in ("0", "0.0"):
            yield (
                f"physxJoint:jointFriction = {result.text} adds friction in proportion to what the"
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


def _of_drive(joint: ModelJoint) -> Iterator[str]:
    """Yield that a drive damps the joint too, in a sentence."""
    name = f"drive:{AXES[joint.kind]}:physics:damping"
    result = joint.place.values.get(name)
    if result is not None and result.text not in ("0", "0.0"):
        yield (
            f"The drive of the joint has a damping too, {name} = {result.text}, which comes on top:"
            " it is for control and not for friction."
        )


# Writes friction of laws into joints of a model file, and says what that leaves of them.

# The formats of model files by name.

CONSUMERS: Final[Mapping[str, type[Model]]] = MappingProxyType(
    {item.name: item for item in (Urdf, Mjcf, Physx)}
)
"""What laws can be applied to."""


XML: Final = (".xml", ".urdf", ".mjcf", ".xacro")
"""Names of files that are XML, or should be."""


def read_model(path: Path, to: str | None = None) -> Model:
    """Read a file in the format that it seems to have, or in a named one."""
    data = read_bytes(path)
    fitting = [consumer for consumer in CONSUMERS.values() if consumer.recognises(path, data)]
    if to is not None:
        wanted: type[Model] = named(CONSUMERS, to, "format")
        if wanted not in fitting:
            raise InputError(f"{path} is no file of {wanted.title}.")
        return wanted(path, data)
    if not fitting:
        raise _unknown(path, data)
    return fitting[0](path, data)


def _unknown(path: Path, data: bytes) -> InputError:
    if data.startswith((b"PXR-USDC", b"PK")):
        return InputError(f"{path} is binary USD: write it as text first, with usdcat -o new.usda.")
    root = root_of(data)
    if root or path.suffix.lower() in XML:
        check_xml(data, str(path))
        return InputError(
            f"{path} has the root <{root}>; a URDF file has <robot>, an MJCF file <mujoco>."
        )
    known = "; ".join(consumer.title for consumer in CONSUMERS.values())
    return InputError(f"{path} is none of the files that friction can be written into: {known}.")


# Writes friction of laws into joints of a model file, and says what that leaves of them.


@dataclass(frozen=True, kw_only=True)
class AppliedJoint(metaclass=Described):
    """A joint with its new friction, and what that leaves of the law."""

    joint: str
    """Name of the joint in the file."""
    contact: str
    """Whose law it has, where contacts have laws of their own."""
    law: str
    """Name of the law."""
    before: Mapping[str, str]
    """Attributes that the file gave it."""
    after: Mapping[str, str]
    """Attributes that were written."""
    largest_speed: float
    """End of the range of speeds over which both are compared [m/s] or [rad/s]."""
    rms: float
    """Root mean square of the difference of the steady friction, over speeds from 0 to the end of
    the range in both directions, all alike [N] or [N m]."""
    largest: float
    """Largest difference there [N] or [N m]."""
    rotary: bool
    """Whether it turns."""
    lost: tuple[str, ...]
    """What the file cannot have of the law, in sentences."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """Attributes, error of the friction and what is lost, in words."""
        unit, speed = turned("N", self.rotary), turned("m/s", self.rotary)
        values = " ".join(f'{key}="{value}"' for key, value in self.after.items())
        before = " ".join(f'{key}="{value}"' for key, value in self.before.items())
        error = (
            f"Error of the friction up to {quantity(self.largest_speed, speed)}:"
            f" {quantity(self.rms, unit)} rms, {quantity(self.largest, unit)} at most."
        )
        return (f"{values}; before: {before or 'none'}.", error, *self.lost)

    def to_dict(self) -> Mapping[str, Any]:
        """Return the joint as plain values."""
        names = ("joint", "contact", "law", "before", "after", "largest_speed", "rms", "largest")
        result = {name: getattr(self, name) for name in names}
        return dict(json_value({**result, "unit": turned("N", self.rotary), "lost": self.lost}))


@dataclass(frozen=True, kw_only=True, repr=False)
class Applied(metaclass=Described):
    """A model file with friction; made by `apply`."""

    path: Path
    """The file that was read."""
    target: str
    """What reads it, such as ``"urdf"`` or ``"mjcf"``."""
    content: bytes
    """The file with friction, equal to the one that was read but for the joints' attributes."""
    joints: tuple[AppliedJoint, ...]
    """What was written, joint by joint."""
    remarks: tuple[str, ...] = ()
    """What concerns the file as a whole, in sentences."""

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the file, whole or not at all.

        Parameters
        ----------
        path : str or Path
            Where to; its folder is made if needed.
        force : bool
            Whether a file may be replaced, such as the one that was read.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        InputError
            If there is such a file, or it cannot be written.
        """
        check_output(self.path, Path(path), force=force)
        write_file(Path(path), self.content)
        return Path(path)

    def to_dict(self) -> Mapping[str, Any]:
        """Return what was written as plain values."""
        return {
            "target": self.target,
            "input": str(self.path),
            "joints": [joint.to_dict() for joint in self.joints],
            "remarks": list(self.remarks),
        }

    def __repr__(self) -> str:
        return f"<Applied {self.target}: {', '.join(joint.joint for joint in self.joints)}>"


def check_output(source: Path, path: Path, *, force: bool) -> None:
    """Refuse to replace a file, before any work."""
    if path.is_dir():
        raise InputError(f"{path} is a folder, but a file is written: give its name.")
    if force or not os.path.lexists(path):
        return
    same = source.exists() and path.exists() and path.samefile(source)
    what = "is the file that is read" if same else "already exists"
    raise InputError(
        f"{path} {what}; give --force (in Python force=True) to replace it, or another -o."
    )


def apply(
    source: "Exported",
    file: str | Path,
    *,
    joints: str | Collection[str] | Mapping[str, str] | None = None,
    law: str | None = None,
    load: float | None = None,
    largest_speed: Given | None = None,
    law_load: float | None = None,
    at: Mapping[str, Given | Mapping[str, Given]] | None = None,
    to: str | None = None,
    polynomial: bool = False,
    holds: bool = False,
) -> Applied:
    """Write friction laws into the joints of a model file, and change nothing else in it.

    Files are URDF, MJCF, and USD as text for PhysX (Isaac Sim). The level and the damping of a
    joint are those that come closest to the law, by least squares over speeds up to the largest in
    both directions; a damper of the law's mechanism is added.

    Parameters
    ----------
    source : FrictionLaw, Fit, Verdict or Rig
        The law, or what has it: of a verdict it is the law to use. `load_rig` reads a ``law.toml``.
        Contacts with laws of their own go to the joints with their names.
    file : str or Path
        The file with the joints.
    joints : str, collection of str, or mapping of str to str, optional
        Joints that get the law; or, by contact, the joint that gets its law. If not given, all
        contacts with a law, or the only joint of the file.
    law : str, optional
        Which of the laws of a rig.
    load : float, optional
        Normal force [N] at which the joint has its friction, as in `export`.
    largest_speed : float or str, optional
        End of the range of speeds; that of the fit if not given.
    law_load : float, optional
        Normal force [N] at which the law was fitted, if its levels are forces.
    at : mapping of str to float, str or mapping, optional
        Contact inputs of the laws at which the joints have their friction: by name for all laws
        that depend on them, and by contact and name for one.
    to : str, optional
        What reads the file: ``"urdf"``, ``"mjcf"`` or ``"physx"``; seen from the file if not given.
    polynomial : bool
        Of MJCF, whether the damping changes with the speed (MuJoCo 3.7 and later). Off by default.
    holds : bool
        Whether the level is that of break-away, so that the joint holds what the law holds. By
        default it is the one that comes closest to the law while sliding.

    Returns
    -------
    Applied
        The file with friction, and what it leaves of the laws.

    Raises
    ------
    InputError
        If the file cannot be read, has no such joint, or the joint does not take the law.

    Examples
    --------
    >>> from importlib.resources import files
    >>> from stickslip import CoulombViscous
    >>> arm = files("stickslip.mechanisms") / "desk_arm.urdf"
    >>> law = CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=0.1)
    >>> found = apply(law, arm, joints="elbow", largest_speed=2.0)
    >>> found.joints[0].sentences[0]
    'damping="0.1" friction="0.3"; before: friction="0.15" damping="0.02".'
    """
    model = read_model(Path(file), to)
    wishes = Wishes(polynomial=polynomial, holds=holds)
    _check_wishes(model, wishes)
    given = Usage(law=law, load=load, largest_speed=largest_speed, law_load=law_load)
    rows: dict[str, AppliedJoint] = {}
    values: list[tuple[ModelJoint, Mapping[str, str]]] = []
    source = law_or_rig(source)
    by_contact = source.contacts.items() if isinstance(source, Rig) else ()
    pairs = _pairs([name for name, known in by_contact if known is not None], model, joints)
    shared, own = _stated(at or {}, [contact for contact, _ in pairs])
    unasked = dict(shared)
    for contact, name in pairs:
        joint = model.joint(name)
        if name in rows:
            raise InputError(f"joint {name!r} is named twice; it has one friction.")
        usage = replace(given, contact=contact or None)
        if isinstance(source, FrictionLaw):
            usage = replace(usage, rotary=joint.rotary is not False)
        whole = subject_of(source, model.title, usage, evaluates=False, rig=None)
        # of several laws, each takes what it depends on
        known = {k: x for k, x in shared.items() if len(pairs) == 1 or k in whole.law.inputs}
        unasked = {k: x for k, x in unasked.items() if k not in known}
        stated = {**known, **own.get(contact, {})}
        subject = evaluated(whole, model.title, stated)
        _check_kind(model, joint, subject)
        beside = _beside(subject.mechanism, subject.contact)
        carried = model.carry(joint, subject, beside, wishes)
        values.append((joint, carried.values))
        rows[name] = _applied(joint, contact, subject, carried)
    if unasked:
        raise InputError(f"no law of these joints depends on {joined(list(unasked))}.")
    return Applied(
        path=Path(file),
        target=model.name,
        content=model.written(values),
        joints=tuple(rows.values()),
        remarks=tuple(model.remarks()),
    )


def _check_wishes(model: Model, wishes: Wishes) -> None:
    for name, instead in model.refuses.items():
        if getattr(wishes, name):
            raise InputError(f"{model.title} {instead}: leave {name} (--{name}) out.")


def _pairs(
    contacts: Sequence[str], model: Model, joints: str | Collection[str] | Mapping[str, str] | None
) -> list[tuple[str, str]]:
    """Return contacts and the joints that get their laws; without contacts, empty names."""
    chosen = [joints] if isinstance(joints, str) else joints
    if chosen is not None and not chosen:
        raise InputError("joints is empty: leave it out, or name at least one.")
    if not contacts:
        if isinstance(chosen, Mapping):
            raise InputError(
                f"this is one law and not laws by contact, so there is no"
                f" {', '.join(map(repr, chosen))}: name joints alone."
            )
        names = model.movable if chosen is None else list(chosen)
        if chosen is None and len(names) != 1:
            raise InputError(
                f"{model.path} has {len(names)} joints that take friction"
                f" ({', '.join(names) or 'none with a name'}), and this is one law: choose with"
                " --joint (in Python joints)."
            )
        return [("", name) for name in names]
    if isinstance(chosen, Mapping):
        pairs = dict(chosen)
    else:
        wanted = model.movable if chosen is None else list(chosen)
        pairs = {contact: name for name in wanted for contact in contacts if _same(contact, name)}
        missing = [name for name in chosen or () if name not in pairs.values()]
        if missing:
            raise InputError(
                f"no contact has the name of the joint {missing[0]!r}; contacts with a law:"
                f" {', '.join(contacts)}. Pair them, as --joint {contacts[0]}={missing[0]}"
                f" (in Python joints={{{contacts[0]!r}: {missing[0]!r}}})."
            )
        if chosen is None:
            for contact in contacts:
                pairs.setdefault(contact, contact)  # refused with the names of the joints
    for contact in pairs:
        if contact not in contacts:
            raise InputError(
                f"no contact {contact!r} has a law; those that do: {', '.join(contacts)}."
            )
    return list(pairs.items())


def _same(contact: str, joint: str) -> bool:
    """Return whether a contact has the name of a joint, as robots give it to theirs."""
    if contact == joint:
        return True
    try:
        return mechanisms.RobotJoint(joint=joint, mass=1.0).contact_name == contact
    except InputError:  # a name without letters
        return False


def _check_kind(model: Model, joint: ModelJoint, subject: Subject) -> None:
    if joint.rotary is not None and subject.rotary != joint.rotary:
        what = "turns" if joint.rotary else "slides"
        raise InputError(
            f"{model.path}: joint {joint.name!r} {what}, but the law is of a mechanism that"
            f" {'turns' if subject.rotary else 'slides'}, with friction in"
            f" {turned('N', subject.rotary)}: choose another joint; of an axis, rotary in"
            " [mechanism] says which it is."
        )


def _beside(mechanism: mechanisms.Mechanism | None, contact: str) -> Beside:
    """Return the damper, the motor and its inertia at a joint."""
    if isinstance(mechanism, mechanisms.Axis | mechanisms.Pendulum):
        inertia = float(mechanisms.driving_inertia(mechanism.drive))
        return Beside(damping=mechanism.damping, armature=inertia or None)
    if isinstance(mechanism, mechanisms.Robot):
        for joint in mechanism.joints:
            if contact in ("", joint.contact_name):
                if joint.coupling:
                    raise InputError(
                        f"friction of {joint.joint!r} acts along a motor that other joints turn too"
                        " (coupling), and that of a joint in a file along its own angle: choose the"
                        " other joints with --joint."
                    )
                inertia = max(0.0, joint.armature + joint.added_armature)
                return Beside(damping=joint.damping, armature=inertia or None)
    if isinstance(mechanism, mechanisms.SerialArm):
        names = [place.name for place in mechanism.contacts()]
        link = mechanism.links[names.index(contact) if contact else 0]
        inertia = link.rotor_inertia * link.gear_ratio**2
        return Beside(damping=link.damping, armature=inertia or None)
    return Beside()


def _stated(
    at: Mapping[str, Given | Mapping[str, Given]], contacts: Sequence[str]
) -> tuple[dict[str, Given], dict[str, Mapping[str, Given]]]:
    """Return contact inputs that are stated for all laws, and those for the law of a contact."""
    shared: dict[str, Given] = {}
    own: dict[str, Mapping[str, Given]] = {}
    for name, value in at.items():
        if not isinstance(value, Mapping):
            shared[name] = value
        elif name in contacts:
            own[name] = value
        else:
            raise UnknownNameError(
                "contact with inputs of its own", name, [*filter(None, contacts)]
            )
    return shared, own


def _applied(joint: ModelJoint, contact: str, subject: Subject, carried: Carried) -> AppliedJoint:
    near = carried.near
    return AppliedJoint(
        joint=joint.name,
        contact=contact,
        law=subject.law.name,
        before=joint.has,
        after=carried.values,
        largest_speed=near.largest_speed,
        rms=near.rms,
        largest=near.largest,
        rotary=subject.rotary,
        lost=carried.lost,
    )
