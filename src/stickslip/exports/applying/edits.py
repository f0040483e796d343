"""Single values of a file are changed, and every other byte stays."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final


@final
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
    for one in sorted(edits, key=lambda edit: (edit.start, edit.end), reverse=True):
        data = data[: one.start] + one.text + data[one.end :]
    return data
