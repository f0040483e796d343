"""Files of XML and USD of which single values are changed, and every other byte stays.

Formatting, comments and what nobody here knows of a format are kept because nothing is written
anew: the text is read once for the places of tags, attributes and values, and edits are made there.
"""

import contextlib
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final
from xml.parsers import expat

from stickslip.errors import InputError
from stickslip.show.documents import NOT_XML, check_xml

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
    found: list[str] = []
    parser = expat.ParserCreate()
    parser.StartElementHandler = lambda name, _: found.append(name)
    with contextlib.suppress(*NOT_XML):
        parser.Parse(data[:HEAD], False)
    return found[0] if found else ""


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
    found = re.compile(rb"""(?:[^"'>]|"[^"]*"|'[^']*')*>""").match(data, start)
    assert found is not None  # expat has found the tag well-formed
    return found.end()


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
        found, added = list(self._schema(prim, schema)), ""
        newline, indent = self._indent(prim.body)
        for name, value in values.items():
            if name in prim.values:
                there = prim.values[name]
                found.append(Edit(there.start, there.end, value.encode("ascii")))
            else:
                added += f"{newline}{indent}float {name} = {value}"
        if added:
            place = self._behind(prim.body)
            # what follows in the line goes on in one of its own
            added += newline if self._rest(place) else ""
            found.append(Edit(place, place, added.encode("ascii")))
        return found

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
        found = re.compile(rb"[ \t]*(?:#|//)[^\r\n]*").match(self.data, place)
        return place if found is None else found.end()

    def _rest(self, place: int) -> bytes:
        """Return what follows in the line."""
        return self.data[place : self.data.find(b"\n", place)].strip()


def stage_of(path: Path, data: bytes) -> Stage:
    """Return a scene with its prims."""
    tokens = list(_tokens(path, data))
    closes = _closes(path, data, tokens)
    prims = tuple(_prims(data, tokens, closes))
    units = {
        name: _real(path, value)
        for name, value in (_values(tokens, closes, 0) if 0 in closes else ())
        if name in ("metersPerUnit", "kilogramsPerUnit")
    }
    return Stage(
        data=data,
        prims=prims,
        metres=units.get("metersPerUnit"),
        kilograms=units.get("kilogramsPerUnit", 1.0),
    )


def _real(path: Path, token: Token) -> float:
    try:
        found = float(token.text)
    except ValueError:
        found = 0.0
    if not 0.0 < found < float("inf"):
        raise InputError(f"{path}: a unit of the scene must be above 0, got {token.text}.")
    return found


def _tokens(path: Path, data: bytes) -> Iterator[Token]:
    place = 0
    while place < len(data):
        found = TOKEN.match(data, place)
        if found is None:
            raise InputError(f"{path} is not USD: {_line(data, place)}.")
        if found.lastgroup != "space":
            yield Token(str(found.lastgroup), found[0], found.start(), found.end())
        place = found.end()


def _line(data: bytes, place: int) -> str:
    lines = data.count(b"\n", 0, place)
    return f"line {lines + 1} cannot be read"


def _closes(path: Path, data: bytes, tokens: Sequence[Token]) -> dict[int, int]:
    """Return where what each opening mark opens is closed."""
    found: dict[int, int] = {}
    opened: list[int] = []
    for i, token in enumerate(tokens):
        if token.data in PAIRS and token.kind == "mark":
            opened.append(i)
        elif token.kind == "mark" and token.data in PAIRS.values():
            if not opened or PAIRS[tokens[opened[-1]].data] != token.data:
                raise InputError(f"{path} is not USD: {_line(data, token.start)}.")
            found[opened.pop()] = i
    if opened:
        raise InputError(f"{path} is not USD: {_line(data, tokens[opened[-1]].start)}.")
    return found


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
