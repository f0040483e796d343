"""What the catalogue knows of a file and of the columns of its table."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import final

from stickslip.described import Described

Known = Mapping[str, float | str]
"""What is known of an experiment: numbers, whose names carry their units, and words."""


@final
@dataclass(frozen=True, kw_only=True)
class Column(metaclass=Described):
    """A column of a tidy table, and where its numbers come from.

    Examples
    --------
    >>> Column(name="x_m", unit="m", meaning="position", source="3", factor=1e-3).factor
    0.001
    """

    name: str
    """Name in the table, which ends with the unit: ``"x_m"``."""
    unit: str
    """Unit of the column."""
    meaning: str
    """What the column holds, in words."""
    quantity: str = ""
    """What it is in a `stickslip.Measurement`; empty where a measurement does without it."""
    gain: float = 1.0
    """Factor from the column to the quantity in SI."""
    source: str = ""
    """Variable of the upstream file, or number of its column in a text, from 1."""
    factor: float = 1.0
    """Factor from the upstream number to the column."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class DataFile(metaclass=Described):
    """A table of a record, and the upstream file it is converted from.

    Examples
    --------
    >>> DataFile(name="train", about="The first minute.", rows=12_000, part=True).file_name
    'train.parquet'
    """

    name: str
    """Name of the table among the files of its record."""
    about: str
    """What this table holds, in a sentence."""
    rows: int | None = None
    """Rows of the table; None where the catalogue does not know."""
    part: bool = False
    """Whether the table is the first `rows` rows of the upstream file, and not all of it."""
    sha256: str = ""
    """Checksum of the table that the catalogue was written for; empty where there is none."""
    source: str = ""
    """Path of the upstream file in its repository; empty where the catalogue cannot fetch it."""
    source_sha256: str = ""
    """Checksum of the upstream file."""
    ending: str = ".parquet"
    """Ending of the file that the table is kept in."""
    known: Known = field(default_factory=lambda: MappingProxyType({}))
    """What is known of this file alone."""

    @property
    def file_name(self) -> str:
        """Name of the table in a folder of data."""
        return self.name + self.ending
