"""Where laws come from: the bibliography of this package, in plain text."""

import re
from collections.abc import Iterator, Mapping
from importlib.resources import files
from types import MappingProxyType
from typing import NamedTuple

ENTRY = re.compile(r"^@\w+\{([\w-]+),\n(.*?)^\}", re.DOTALL | re.MULTILINE)
FIELD = re.compile(r"^ *(\w+) *= *\{(.*)\},$", re.MULTILINE)
INITIAL, SHORT = re.compile(r"(\w)\w*\.?"), r"\1."
PLACES = (
    *("booktitle", "journal", "type", "school", "institution", "number", "publisher"),
    *("address", "note", "year"),
)
"""Fields that say where something was published, in their order."""


class Citation(NamedTuple):
    """A publication in words."""

    authors: str
    """Initials and surnames; empty where nobody is named."""
    title: str
    where: str
    """Journal with volume and number, or publisher; year."""


def _read(text: str) -> Iterator[tuple[str, Citation]]:
    """Yield the entries of a BibTeX file with a field in each line."""
    for key, body in ENTRY.findall(text):
        own = {name: re.sub("[{}]", "", value) for name, value in FIELD.findall(body)}
        authors = ", ".join(map(_short, filter(None, own.get("author", "").split(" and "))))
        if "volume" in own:
            issue = f"({own.pop('number')})" if "number" in own else ""
            own["journal"] += f" {own['volume']}{issue}"
        where = ", ".join(own[place] for place in PLACES if place in own)
        yield key, Citation(authors, own["title"], where)


def _short(name: str) -> str:
    """Return a name with initials.

    Examples
    --------
    >>> _short("Canudas de Wit, Carlos"), _short("Wen, Yi-Kwei"), _short("The MathWorks")
    ('C. Canudas de Wit', 'Y.-K. Wen', 'The MathWorks')
    """
    surname, _, given = name.partition(", ")
    return f"{INITIAL.sub(SHORT, given)} {surname}".strip()


CITATIONS: Mapping[str, Citation] = MappingProxyType(
    dict(_read(files(__package__).joinpath("references.bib").read_text(encoding="utf-8")))
)
"""Publications by key."""
SOURCES: Mapping[str, str] = MappingProxyType(
    {key: ". ".join(filter(None, citation)) + "." for key, citation in CITATIONS.items()}
)
"""Citation in plain text by key."""
