"""XML files of which single attributes are changed, and every other byte stays."""

import contextlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Final, final
from xml.parsers import expat

from stickslip.documents import NOT_XML, check_xml
from stickslip.errors import InputError
from stickslip.exports.applying.edits import Edit

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
        for one in self.children:
            yield from one.walk()


@final
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
