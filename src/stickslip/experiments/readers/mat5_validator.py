"""The structure of MATLAB files of version 5 to 7, checked before they are read.

SciPy trusts the sizes in such a file, and one whose bytes have shifted may take the whole process
down. See MathWorks, MAT-File Format, "Level 5 MAT-File Format".
"""

import math
import struct
import zlib
from collections.abc import Iterator, Sequence
from typing import Final, NamedTuple

from stickslip.errors import MOST_NUMBERS, check_size

CURE: Final = "split the file, or save fewer variables"
HEADER: Final = 128
MATRIX: Final = 14
COMPRESSED: Final = 15
DEEPEST: Final = 20
SIZES: Final = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 9: 8, 12: 8, 13: 8}
"""Bytes of a number by the type of its element."""
NAMES: Final = {1, 16}
"""Types of a name: plain bytes, or UTF-8 where other programs write it."""
TEXTS: Final = {1, 2, 4, 16, 17, 18}
"""Types of a text: bytes, 16-bit numbers, or UTF-8, -16 and -32."""
LONGEST_TEXT: Final = 1_000_000
CELL, STRUCT, CHAR = 1, 2, 4
COMPLEX: Final = 0x800
NUMERIC: Final = range(6, 16)


class Element(NamedTuple):
    """One piece of a file."""

    kind: int
    """Number of its data type in the MAT-file format."""
    body: memoryview
    """Its bytes, without the tag."""


def is_level_5(data: bytes) -> bool:
    r"""Whether a file says that it is of version 5 to 7.

    Examples
    --------
    >>> is_level_5(b"MATLAB 5.0 MAT-file".ljust(124) + b"\x00\x01IM"), is_level_5(b"")
    (True, False)
    """
    return data[124:HEADER] in {b"\x00\x01IM", b"\x01\x00MI"}


def check_structure(data: bytes, file: str = "data.mat") -> None:
    """Check that all sizes in a file fit each other, and that it does not grow without bound."""
    order = "<" if data[126:HEADER] == b"IM" else ">"
    numbers, expanded = 0, 0
    for element in _elements(memoryview(data)[HEADER:], order):
        body = element.body
        if element.kind == COMPRESSED:
            stream = zlib.decompressobj()
            head = stream.decompress(body, 8)
            size = struct.unpack(f"{order}II", head.ljust(8, b"\0"))[1]
            expanded += size
            # before anything is expanded
            check_size(file, expanded, CURE, unit="expanded bytes", most=8 * MOST_NUMBERS)
            body = memoryview(head + stream.decompress(stream.unconsumed_tail, size + 8))
            if stream.unconsumed_tail:
                raise ValueError("a compressed variable is larger than it says")
            inner = [*_elements(body, order)]
        else:
            inner = [element]
        numbers += sum(_check_variable(one, order) for one in inner)
        check_size(file, numbers, CURE)


def _elements(data: memoryview, order: str) -> Iterator[Element]:
    """Yield the pieces that follow each other."""
    place = 0
    while place < len(data):
        if place + 8 > len(data):
            raise ValueError("it ends within a tag")
        kind, size = struct.unpack_from(f"{order}II", data, place)
        if kind >> 16:  # a small one: its size and up to four bytes share the tag
            kind, size, start, after = kind & 0xFFFF, kind >> 16, place + 4, place + 8
            if size > 4:
                raise ValueError("a small element is too large")
        else:
            start = place + 8
            # All but compressed ones end on a multiple of eight.
            after = start + size + (0 if kind == COMPRESSED else -size % 8)
        if start + size > len(data):
            raise ValueError("it is truncated")
        yield Element(kind, data[start : start + size])
        place = after


def _check_variable(element: Element, order: str, depth: int = DEEPEST) -> int:
    """Check a variable and return how many numbers it has."""
    if element.kind != MATRIX or not depth:
        raise ValueError("an element is not a variable")
    if not len(element.body):
        return 0
    parts = list(_elements(element.body, order))
    if parts[0].kind != 6 or len(parts[0].body) != 8:
        raise ValueError("a variable has no flags")
    flags = struct.unpack(f"{order}II", parts[0].body)[0]
    kind = flags & 0xFF
    if kind > NUMERIC[-1]:  # objects of classes, which are left alone
        return 0
    if (
        len(parts) < 3
        or parts[1].kind not in {5, 6}
        or len(parts[1].body) % 4
        or len(parts[1].body) < 8
    ):
        raise ValueError("a variable has no shape")
    shape = struct.unpack(f"{order}{len(parts[1].body) // 4}i", parts[1].body)
    if min(shape) < 0 or parts[2].kind not in NAMES:
        raise ValueError("a variable has no name")
    return _check_content(flags, math.prod(shape), parts[3:], order, depth)


def _check_content(flags: int, size: int, parts: Sequence[Element], order: str, depth: int) -> int:
    """Check that a variable has as many values as its shape says; return how many numbers."""
    kind = flags & 0xFF
    if kind in NUMERIC:
        for part in parts:
            if SIZES.get(part.kind, 0) * size != len(part.body):
                raise ValueError("the size of a variable differs from its shape")
        if len(parts) != (2 if flags & COMPLEX else 1):  # real, and imaginary if the flag says so
            raise ValueError("a variable has no values")
        return size
    if kind == CHAR:
        if len(parts) != 1 or parts[0].kind not in TEXTS:
            raise ValueError("a text has no characters")
        # Other programs leave out blanks at the end of a text.
        if size > max(LONGEST_TEXT, sum(len(part.body) for part in parts)):
            raise ValueError("a text is shorter than its shape")
    elif kind in {CELL, STRUCT}:
        fields = 1
        if kind == STRUCT:
            fields, parts = _fields(parts, order), parts[2:]
        if len(parts) != fields * size:
            raise ValueError("the size of a struct or cell differs from its shape")
        return sum(_check_variable(part, order, depth - 1) for part in parts)
    return 0


def _fields(parts: Sequence[Element], order: str) -> int:
    """Return how many fields a struct has."""
    if len(parts) < 2 or parts[0].kind not in {5, 6} or len(parts[0].body) != 4:
        raise ValueError("a struct has no fields")
    width = int(struct.unpack(f"{order}i", parts[0].body)[0])
    if width <= 0 or len(parts[1].body) % width:
        raise ValueError("the field names are inconsistent")
    return len(parts[1].body) // width
