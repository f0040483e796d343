"""How a text file holds its table: code page, separators, and what stands above the rows."""

import csv
import re
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, Literal, final

from stickslip.described import Described
from stickslip.errors import InputError
from stickslip.experiments.readers.time_stamps import is_stamp
from stickslip.units import is_unit

SEPARATORS: Final = (";", "\t", ",", "|", " ")
"""Marks between cells, the surest first: commas also stand in numbers, and blanks in names."""
LOOKED_AT: Final = 400
"""Lines at the top among which header and rows are sought."""
LONGEST_CELL: Final = 100_000
"""Characters that are looked at of a cell that is no number."""
ALIKE: Final = 10
"""Rows that have to follow each other, unless the file has fewer."""
CODE_PAGES: Final = {b"\xef\xbb\xbf": "utf-8-sig", b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
MISSING: Final = ("", "nan", "inf", "+inf", "-inf", "na", "n/a", "null", "none", "true", "false")
"""Words of cells, in any case, that stand for a number that is missing, or for none."""
BRACKETS: Final = ("[]", "()", "<>", "{}")
NO_UNIT: Final = ("-", "\N{EN DASH}", "\N{MINUS SIGN}", "1")
_NUMBER: Final = re.compile(
    r"""[+-]?(?:\d+(?:[.'\ \u2019\u00a0\u202f]\d{3})*(?:[.,]\d*)?   # 12, 0,5, 1.592,0
        |\d{1,3}(?:,\d{3})+(?:\.\d*)?                               # 1,592.0
        |[.,]\d+)(?:[eE][+-]?\d+)?""",
    re.VERBOSE,
)
_BLANKS: Final = "'\u2019 \u00a0\u202f"
_THOUSANDS: Final = (
    (",", re.compile(rf"(?<![.{_BLANKS}]\d\d)\d([.{_BLANKS}])\d{{3}}(?:\1\d{{3}})*+,\d")),
    (".", re.compile(rf"(?<![,{_BLANKS}]\d\d)\d([,{_BLANKS}])\d{{3}}(?:\1\d{{3}})*+\.\d")),
)
"""By decimal mark: a number that has both this and a mark between thousands, from its first one."""


@final
@dataclass(frozen=True, kw_only=True)
class Layout(metaclass=Described):
    """How a text file holds its table, as `guess_data` finds it and `load_measurement` takes it.

    Examples
    --------
    >>> Layout(separator=";", decimal=",", preface=3, units_row=True).decimal
    ','
    """

    encoding: str = "utf-8-sig"
    """Code page, such as ``"cp1252"`` of older programs under Windows."""
    separator: str = ","
    """What stands between cells; a blank stands for any number of blanks and tabs."""
    decimal: str = "."
    """Decimal mark, a point or a comma."""
    thousands: str = ""
    """Mark between thousands; empty if there is none."""
    preface: int = 0
    """Number of lines above the header, comments and empty lines included."""
    units_row: bool = False
    """Whether the row below the header holds the units of the columns."""

    def __post_init__(self) -> None:
        """Check all; a wrong mark would make text of numbers."""
        for name, allowed in (("separator", SEPARATORS), ("decimal", (".", ","))):
            given = getattr(self, name)
            if given not in allowed:
                listed = ", ".join(map(repr, allowed))
                raise InputError(f"layout.{name} must be one of {listed}, got {given!r}.")
        if len(self.thousands) > 1 or (self.thousands and self.thousands == self.decimal):
            raise InputError(
                "layout.thousands must be one character other than the decimal mark, got"
                f" {self.thousands!r}."
            )
        lines: object = self.preface
        if not isinstance(lines, int) or isinstance(lines, bool) or lines < 0:
            raise InputError(f"layout.preface must be a number of lines, got {self.preface!r}.")
        try:
            "".encode(self.encoding)
        except LookupError:
            raise InputError(
                f"layout.encoding must be a code page such as utf-8 or cp1252, got"
                f" {self.encoding!r}."
            ) from None


@final
@dataclass(frozen=True, kw_only=True)
class Text:
    """The upper lines of a file as cells."""

    layout: Layout
    """How the file holds its table."""
    names: tuple[str, ...]
    """Names of the columns as they stand in the header."""
    units: tuple[str, ...]
    """Units of the columns, from a row below the header; empty where there is none."""
    assumed: str
    """A whole number with a mark that is only assumed to part thousands; empty if none has."""
    rows: tuple[tuple[str, ...], ...]
    """Cells of some of the upper rows."""


def decoded(data: bytes) -> tuple[str, str]:
    """Return a text and its code page.

    Examples
    --------
    >>> decoded("µm".encode("cp1252")), decoded("µm".encode("utf-16"))
    (('µm', 'cp1252'), ('µm', 'utf-16'))
    """
    encoding = next((name for mark, name in CODE_PAGES.items() if data.startswith(mark)), "")
    if not encoding and b"\0" in data[:LOOKED_AT]:
        even, odd = (data[start:LOOKED_AT:2].count(0) for start in (0, 1))
        if min(even, odd) == 0 and max(even, odd) > LOOKED_AT / 8:
            encoding = "utf-16-be" if even else "utf-16-le"
    for name in [encoding] if encoding else ["utf-8-sig", "cp1252"]:
        try:
            return data.decode(name), name
        except UnicodeDecodeError:
            continue
    return data.decode(encoding or "cp1252", errors="replace"), encoding or "cp1252"


def cells_of(line: str, separator: str) -> list[str]:
    """Return the cells of a line, quotes removed."""
    return [cell.strip() for cell in bare_cells(line, separator, skipinitialspace=True)]


def bare_cells(line: str, separator: str, *, skipinitialspace: bool = False) -> list[str]:
    """Return the cells of a line as they stand; one beyond what `csv` takes is cut."""
    if separator == " ":
        return line.lstrip("#% \t").split()  # a header may be marked as a comment
    try:
        found = csv.reader([line], delimiter=separator, skipinitialspace=skipinitialspace)
        return next(found, [])
    except csv.Error:
        return [cell[:LONGEST_CELL] for cell in line.split(separator)]


def is_number(cell: str) -> bool:
    """Whether a cell holds a number, with either decimal mark and perhaps marks between thousands.

    Examples
    --------
    >>> [is_number(cell) for cell in ("0,5", "1.592,0", "12 000", "1e-3", "Weg", "1;2")]
    [True, True, True, True, False, False]
    """
    return _NUMBER.fullmatch(cell) is not None


def layout_of(text: str, encoding: str) -> Text | None:
    r"""Return how a text holds its table; None if it has no header above rows of numbers.

    Examples
    --------
    >>> found = layout_of("Zeit;Weg\ns;mm\n0,0;1,5\n0,1;1,6\n", "utf-8-sig")
    >>> found.layout.decimal, found.layout.units_row, found.names, found.units
    (',', True, ('Zeit', 'Weg'), ('s', 'mm'))
    """
    lines = _upper(text)
    # The mark that leaves fewest words beside numbers, and then makes most cells, parts them.
    found = sorted(
        (
            (*rows, -place, mark)
            for place, mark in enumerate(SEPARATORS)
            for rows in _rows(lines, mark)
        ),
        reverse=True,
    )
    for _, width, first, _, separator in found:
        table = _table(text, encoding, lines, first, width, separator)
        if table is not None:
            return table
    return None


def _table(
    text: str, encoding: str, lines: Sequence[str], first: int, width: int, separator: str
) -> Text | None:
    """Return the table whose rows begin at a line, if there is a header above it."""
    above = [index for index in range(first) if lines[index].strip()]
    heads = [index for index in above if _is_head(cells_of(lines[index], separator), width)]
    if not heads:
        return None
    header, units = heads[-1], tuple[str, ...]()
    last = cells_of(lines[header], separator)
    if len(heads) > 1 and heads[-2] == above[-2] and are_units(last):
        header, units = heads[-2], tuple(unit_in(cell) for cell in last)
    rows = tuple(tuple(cells_of(line, separator)) for line in lines[first:] if line.strip())
    names = _padded(cells_of(lines[header], separator), max(width, len(rows[0])))
    decimal, thousands = _marks(text, rows, separator)
    grouped = [cell for row in rows for cell in row if is_number(cell) and thousands in cell]
    sure = thousands not in (".", ",") or any(decimal in cell for cell in grouped)
    return Text(
        layout=Layout(
            encoding=encoding,
            separator=separator,
            decimal=decimal,
            thousands=thousands,
            preface=header,
            units_row=bool(units),
        ),
        names=names,
        units=_padded(units, len(names)) if units else (),
        assumed="" if sure else next(iter(grouped), ""),
        rows=rows,
    )


def _upper(text: str) -> list[str]:
    """Return the upper lines, cut by hand: a long file has more than anybody asks for."""
    found: list[str] = []
    position = 0
    while position < len(text) and len(found) < LOOKED_AT:
        end = text.find("\n", position)
        end = len(text) if end < 0 else end
        found.append(text[position:end].rstrip("\r").lstrip("\ufeff"))
        position = end + 1
    return found


def _rows(lines: Sequence[str], separator: str) -> Iterator[tuple[int, int, int]]:
    """Yield, if rows of numbers are parted by a mark, where they begin.

    That is the number of words among them, negative; the number of cells that are not empty at the
    end of all rows; the first line.
    """
    counts = [_counted(line, separator) for line in lines]
    full = [index for index, line in enumerate(lines) if line.strip()]
    for place, index in enumerate(full):
        following = [counts[i] for i in full[place : place + ALIKE]]
        sizes = {size for size, _, _ in following}
        if len(sizes) == 1 and min(sizes) > 0:
            words = sum(words for _, _, words in following)
            yield -words, max(width for _, width, _ in following), index
            return


def _counted(line: str, separator: str) -> tuple[int, int, int]:
    """Return the numbers of cells, of those up to the last that is not empty, and of words.

    All are 0 unless most of the cells are numbers.
    """
    if not line.strip() or line.startswith("#"):
        return 0, 0, 0
    cells = cells_of(line, separator)
    width = max((place for place, cell in enumerate(cells, 1) if cell), default=0)
    numbers = sum(is_number(cell) or is_stamp(cell) for cell in cells)
    words = sum(cell.casefold() not in MISSING for cell in cells) - numbers
    return (len(cells), width, words) if numbers > words else (0, 0, 0)


def _is_head(cells: Sequence[str], width: int) -> bool:
    """Whether cells above rows of a width may be their names or their units."""
    named = [cell for cell in cells if cell]
    if not named or len(cells) < width:
        return False
    return not any(is_number(cell) or is_stamp(cell) for cell in named if cell not in NO_UNIT)


def are_units(cells: Sequence[str]) -> bool:
    """Whether cells hold units and nothing else.

    Examples
    --------
    >>> are_units(["s", "[mm]", ""]), are_units(["t", "x"])
    (True, False)
    """
    named = [cell for cell in cells if cell]
    return bool(named) and all(
        cell[0] + cell[-1] in BRACKETS or unit_in(cell) in NO_UNIT or is_unit(unit_in(cell))
        for cell in named
    )


def unit_in(cell: str) -> str:
    """Return the unit of a cell that holds nothing else, without the brackets around it.

    Examples
    --------
    >>> unit_in("[mm]"), unit_in("(1/min)"), unit_in("in mm"), unit_in("N")
    ('mm', '1/min', 'mm', 'N')
    >>> unit_in("mm (Position)")
    'mm'
    """
    unit, bracket, rest = cell.strip().partition(" (")  # and what is measured in it
    named = unit and bracket and rest.endswith(")")
    bare = (unit if named else cell).strip().strip("[]()<>{}").strip()
    return bare.removeprefix("in ") if bare != "in" else bare


def _padded(cells: Sequence[str], width: int) -> tuple[str, ...]:
    return (*cells, *[""] * (width - len(cells)))


def _marks(
    text: str, rows: Sequence[Sequence[str]], separator: str
) -> tuple[Literal[".", ","], str]:
    """Return the decimal mark and that between thousands.

    Marks between thousands are sought in the whole text: a number may pass a thousand late.
    """
    numbers = [cell for row in rows for cell in row if is_number(cell)]
    decimal: Literal[".", ","] = "."
    if separator == " " and any("." in cell for cell in numbers):
        return ".", ""
    if separator != "," or any('"' in line for line in _upper(text)[:LOOKED_AT]):
        last = Counter(mark for cell in numbers for mark in _last_mark(cell))
        both = any("." in cell and "," in cell for cell in numbers)
        if last[","] and (both or last[","] >= last["."]):
            decimal = ","
    for mark, pattern in _THOUSANDS:
        if mark != decimal or (separator == "," and '"' not in text):
            continue
        found = pattern.search(text)
        if found and found[1] != separator:
            return decimal, found[1]
    blanks = [cell for cell in numbers if any(mark in cell for mark in _BLANKS)]
    if blanks:
        return decimal, next(mark for mark in _BLANKS if mark in blanks[0])
    return decimal, _other_mark(numbers, decimal)


def _last_mark(cell: str) -> Iterator[str]:
    marks = [mark for mark in cell if mark in ".,"]
    # One that comes twice parts thousands.
    if marks and marks.count(marks[-1]) == 1:
        yield marks[-1]


def _other_mark(numbers: Sequence[str], decimal: str) -> str:
    """Return the mark that is no decimal one but stands in whole numbers, such as 1.592.

    Where it stands elsewhere too, as in 0.15, a file has both decimal marks, and none is dropped.
    """
    other = "," if decimal == "." else "."
    found = [cell for cell in numbers if other in cell]
    whole = rf"[+-]?[1-9]\d{{0,2}}(?:\{other}\d{{3}})+"
    return other if found and all(re.fullmatch(whole, cell) for cell in found) else ""
