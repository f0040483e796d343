"""Tables in text files: CSV in its dialects, what only looks like one, and sheets of workbooks.

Text whose tables only their own reader knows is tried first; sheets are read as if they had been
saved as text.
"""

import csv
import io
import itertools
import operator
import re
import warnings
import zipfile
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from datetime import date, datetime, time, timedelta
from pathlib import Path
from typing import Any, Final

import pandas as pd

from stickslip.data.readers import instruments, tracks
from stickslip.data.readers import table as tables
from stickslip.data.readers.columns import without_unit
from stickslip.data.readers.layout import (
    BRACKETS,
    DOUBTED,
    Layout,
    bare_cells,
    bytes_of,
    cells_of,
    decoded,
    doubted_parts,
    is_number,
    is_stamp,
    layout_of,
    stated_rates,
    unit_in,
    without_names,
)
from stickslip.data.readers.toml import decode
from stickslip.data.tolerances import FEWEST_SAMPLES, LONGEST_LINE, MOST_CELLS
from stickslip.errors import MOST_NUMBERS, InputError, check_columns, check_size, concerning
from stickslip.show.display import require_library
from stickslip.show.formatting import joined
from stickslip.units import shown

# Text files whose tables only their own reader knows: a new one is a file and an entry here.

FRANKA: Final = "time, success_rate, state.q[0]"
"""How such a text begins: times are in milliseconds and say so nowhere."""


def is_franka(text: str) -> bool:
    """Whether a text is a log of libfranka.

    Examples
    --------
    >>> is_franka("time, success_rate, state.q[0], state.q[1]"), is_franka("time, q")
    (True, False)
    """
    return (
        text.lstrip("\ufeff")[: len(FRANKA) + 8]
        .replace(" ", "")
        .startswith(FRANKA.replace(" ", ""))
    )


def read_franka(text: str) -> tables.FileTable:
    r"""Return the columns of a log with their units.

    Examples
    --------
    >>> table = read_franka("time, success_rate, state.q[0], state.tau_J[0]\n7,1,0.5,2.5\n")
    >>> table.data.to_dict("list"), table.first_row
    ({'time [ms]': [7], 'success_rate': [1], 'state.q[0]': [0.5], 'state.tau_J[0]': [2.5]}, 2)
    """
    text = text.lstrip("\ufeff")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", pd.errors.ParserWarning)  # of further cells: see below
            table = pd.read_csv(io.StringIO(text), skipinitialspace=True, index_col=False)
    except (pd.errors.ParserError, ValueError) as error:
        raise tables.unequal_rows(error) from None
    width = len(table.columns)
    more = sum(any(map(str.strip, line.split(",")[width:])) for line in text.splitlines())
    return tables.FileTable(
        data=table.rename(columns={"time": "time [ms]"}),
        first_row=2,
        lost=(*tables.further_cells(more, width),),
    )


@dataclass(frozen=True, kw_only=True)
class Dialect:
    """A kind of text files."""

    title: str
    is_text: Callable[[str], bool]
    """Whether a text, or the top of one, is of this kind."""
    read: Callable[[str], tables.FileTable]
    """Returns the table of a text."""


DIALECTS: Final = (
    Dialect(title="tracks of a video", is_text=tracks.is_blocks, read=tracks.read_blocks),
    Dialect(title=instruments.SCOPE, is_text=instruments.is_scope, read=instruments.read_scope),
    Dialect(
        title=instruments.LABVIEW, is_text=instruments.is_labview, read=instruments.read_labview
    ),
    Dialect(
        title=instruments.TRIBOMETER,
        is_text=instruments.is_tribometer,
        read=instruments.read_tribometer,
    ),
    Dialect(title=tracks.MOTION_CAPTURE, is_text=tracks.is_capture, read=tracks.read_capture),
    Dialect(title=instruments.SERIAL, is_text=instruments.is_serial, read=instruments.read_serial),
    Dialect(title="log of libfranka", is_text=is_franka, read=read_franka),
)


def dialect_of(text: str) -> Dialect | None:
    """Return the kind of a text, or None for a table like others.

    Examples
    --------
    >>> dialect_of("time, success_rate, state.q[0]").title, dialect_of("t,x")
    ('log of libfranka', None)
    """
    return next((dialect for dialect in DIALECTS if dialect.is_text(text)), None)


# Tables in text files: CSV in its dialects, and what only looks like one.

HEAD: Final = 65_536
"""Bytes that are enough to see that a file is no text."""
LOOKED_AT: Final = 50
"""Rows that are enough to see that a text is no table."""
TAIL: Final = 4096
"""Bytes at the end of a file among whose numbers a last one that is cut stands out."""
LEAST_CODE: Final = 32
SEPARATORS: Final = ",;\t"
_NUMBER: Final = re.compile(r"\s*+[+-]?(\d++(?:[.,]\d*+)?|[.,]\d++)([eE][+-]?\d++)?\s*+")
_GROUPED: Final = re.compile(
    r"""\s*[+-]?\d{1,3}(?:
        (?P<mark>[.'\ \u2019\u00a0\u202f])\d{3}(?:(?P=mark)\d{3})*(?:(?!(?P=mark))[.,]\d+)?
        |(?P<comma>,)\d{3}(?:(?:,\d{3})+(?:\.\d+)?|\.\d+))\s*""",
    re.VERBOSE,
)
"""A number whose thousands are separated by a mark; 1,592 alone may be one with decimals."""
_THOUSANDS: Final = re.compile(r"\s*[+-]?[1-9]\d{0,2},\d{3}\s*")
"""A number with a comma that may stand between thousands or before decimals."""
_WORDS: Final = {"", "nan", "inf", "+inf", "-inf", "na", "n/a", "null", "none", "true", "false"}


def ambiguous(file: str | Path, name: str) -> InputError:
    """Return the error of a table in which two columns have one name."""
    return InputError(f"{file}: two columns are named {shown(name)}. Rename one of them.")


def read_text(path: Path, layout: Layout | None = None) -> tables.FileTable:
    """Return a CSV table; lines before the header may be comments."""
    data = bytes_of(path)
    if layout is not None:
        return read_as(path, data, layout)
    text, encoding = _decoded(path, data)
    dialect = dialect_of(text)
    if dialect is not None:
        with concerning(f"{path}:", InputError):
            return dialect.read(text)
    lines, start = _head(path, text)
    named = _tracks(lines)
    lines, start = (lines[1:], start + 1) if named else (lines, start)
    header, sample = lines[0], lines[1:]
    separator = max(SEPARATORS, key=header.count)
    names = named or bare_cells(header, separator)
    first = [cells_of(header, mark) for mark in (*SEPARATORS, "|", " ")]
    if any(all(is_number(cell) or is_stamp(cell) for cell in cells) for cells in first):
        refuse_numbers(path, text)
    _check_first(path, lines, start, separator, text)
    _check_table(path, names, sample, separator, text)
    decimal = "," if _has_decimal_comma(sample[:20], separator) else "."
    found = Layout(encoding=encoding, separator=separator, decimal=decimal, preface=start)
    return _parsed(path, data, names, sample, found)


def read_as(path: Path, data: bytes, layout: Layout) -> tables.FileTable:
    """Return the table of a file that holds it in a known way."""
    try:
        text = data.decode(layout.encoding)
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: is not in the code page {layout.encoding} of its layout (byte"
            f" 0x{data[error.start]:02x} at {error.start})."
        ) from None
    dialect = dialect_of(text)
    if dialect is not None:
        raise InputError(
            f"{path}: is a {dialect.title}, which is read without a layout: leave it out."
        )
    many = layout.preface + LOOKED_AT
    upper = [line.rstrip("\r") for line in text.split("\n", many)[:many]]
    lines = upper[layout.preface :] if upper[-1] else upper[layout.preface : -1]
    if len(lines) < 2 + layout.units_row:
        raise InputError(f"{path}: has no rows below the {layout.preface} lines of its preface.")
    names = cells_of(lines[0].lstrip("\ufeff"), layout.separator)
    if layout.units_row:
        units = [unit_in(cell) for cell in cells_of(lines[1], layout.separator)]
        pairs = itertools.zip_longest(names, units, fillvalue="")
        names = [f"{name} [{unit}]" if unit and name else name for name, unit in pairs]
    sample = lines[1 + layout.units_row :]
    if not layout.thousands.isascii():  # of which the parser knows none
        data = text.replace(layout.thousands, "").encode(layout.encoding)
        layout = replace(layout, thousands="")
    rates = stated_rates(upper[: layout.preface], layout)
    return replace(_parsed(path, data, names, sample, layout), rates=rates)


def _parsed(
    path: Path, data: bytes, names: Sequence[str], sample: Sequence[str], layout: Layout
) -> tables.FileTable:
    """Return the table below a header."""
    check_columns(str(path), len(names))
    twice = [name for name, number in Counter(names).items() if number > 1 and name.strip()]
    if twice:
        raise ambiguous(path, twice[0])
    own = [name if name.strip() else f"Unnamed: {index}" for index, name in enumerate(names)]
    rows = [bare_cells(row, layout.separator) for row in sample if row.strip()]
    _check_names(path, names, rows, layout.separator)
    # A mark behind the last cell makes one more, which is empty.
    cells = [row[len(own) :] for row in rows]
    if not any(cell for more in cells for cell in more):
        own += [f"Unnamed: {len(own) + i}" for i in range(max(map(len, cells), default=0))]
    check_columns(str(path), len(own))
    above = layout.preface + 1 + layout.units_row
    check_size(str(path), len(own) * data.count(b"\n"), tables.FEWER_COLUMNS)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            table = pd.read_csv(
                io.BytesIO(data),
                sep=r"\s+" if layout.separator == " " else layout.separator,
                decimal=layout.decimal,
                thousands=layout.thousands or None,
                names=own,
                header=None,
                skiprows=above,
                index_col=False,
                low_memory=False,
                skip_blank_lines=False,
                encoding=layout.encoding,
                encoding_errors="replace",
            )
    except pd.errors.EmptyDataError:
        raise InputError(f"{path}: has no rows.") from None
    except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError) as error:
        # What stands before it names the parser's language and nothing in the file.
        reason = str(error).strip().splitlines()[0].rpartition("error: ")[2].rstrip(".")
        wide = min(map(len, rows), default=0) > len(names)
        reason = f"rows have {len(rows[0])} cells" if wide else reason
        commas = " Numbers with decimal commas must be in quotes." * (layout.separator == ",")
        raise InputError(
            f"{path}: rows and header do not match ({reason}). Every row needs {len(names)} cells,"
            f" separated by {layout.separator!r}.{commas * wide}"
        ) from None
    more = int(table[own[len(names) :]].notna().any(axis=1).sum())
    table = table[[column for column, name in zip(own, names, strict=False) if name.strip()]]
    table = _without_doubts(table.dropna(how="all"), layout)
    lost = tables.further_cells(more, len(names))
    if cut := _cut_number(data, layout):
        table = table.iloc[:-1]
        lost.append(
            f"The file ends within a number, {shown(cut)}, which has fewer digits than those above"
            " it: the last row is left out."
        )
    return tables.FileTable(data=table, first_row=above + 1, lost=tuple(lost))


def _without_doubts(table: pd.DataFrame, layout: Layout) -> pd.DataFrame:
    """Return a table with columns of their own for uncertainties in cells such as 3.51 ± 0.1."""
    for name in [*table.columns]:
        top = table[name].dropna().iloc[:FEWEST_SAMPLES]
        stated = f"{without_unit(name)}_uncertainty"
        if stated in table or not any(doubted_parts(cell) for cell in top if isinstance(cell, str)):
            continue
        plain = str.maketrans(layout.decimal, ".", layout.thousands)
        texts = table[name].astype("string").str.translate(plain)
        cells = texts.str.extract(f"^(?:{DOUBTED.pattern})$", flags=DOUBTED.flags)
        if (cells["value"].isna() & texts.notna()).any():  # which is refused as any other text
            continue
        value, doubt, digits = (pd.to_numeric(cells[part]).astype(float) for part in cells)
        # 3.51(10) counts in the last digit
        last = texts.str.extract(r"\.(\d+)\(")[0].str.len().fillna(0).astype(float)
        table = table.assign(**{name: value, stated: doubt.fillna(digits * 10.0**-last)})
    return table


def _cut_number(data: bytes, layout: Layout) -> str:
    """Return the last cell of a text that ends within it: with fewer digits than all above.

    A program that was ended, or a disk that was full, cut the text anywhere.
    """
    if data.endswith((b"\n", b"\r")) or layout.encoding.startswith("utf-16"):
        return ""
    lines = data[-TAIL:].decode(layout.encoding, errors="replace").splitlines()[1:]
    cells = [row[-1] for line in lines if (row := cells_of(line, layout.separator))]
    if len(cells) <= FEWEST_SAMPLES or not all(map(is_number, cells)):
        return ""
    *above, last = (_digits(cell, layout.decimal) for cell in cells)
    least = [min(pair[part] for pair in above) for part in range(len(last))]
    return cells[-1] if any(map(operator.gt, least, last)) else ""


def _digits(cell: str, decimal: str) -> tuple[int, int]:
    """Return how many digits a number has behind its mark, and in its exponent."""
    mantissa, _, exponent = cell.casefold().partition("e")
    return len(mantissa.partition(decimal)[2]), len(exponent.lstrip("+-"))


def _check_names(
    path: Path, names: Sequence[str], rows: Sequence[Sequence[str]], separator: str
) -> None:
    """Refuse a name that is cut by the mark between cells: it would shift all behind it."""
    if max(map(len, rows), default=len(names)) >= len(names):
        return
    for name, after in itertools.pairwise(names):
        if any(name.count(left) > name.count(right) and right in after for left, right in BRACKETS):
            raise InputError(
                f"{path}: the name {shown(f'{name}{separator}{after}')} of a column holds a mark"
                " that separates cells: put it in quotes."
            )


def _decoded(path: Path, data: bytes) -> tuple[str, str]:
    """Return a text and its encoding: that of Windows where only names need one."""
    text, encoding = decoded(data)
    if not encoding.startswith("utf-16"):
        _check_text(path, data[:HEAD])
    if encoding == "cp1252":
        foreign = [line for line in text.splitlines() if not line.isascii()]
        if any(_NUMBER.fullmatch(cell) for line in foreign for cell in re.split("[,;\t]", line)):
            decode(data, str(path))  # raises: who knows what these bytes are
    return text, encoding


def _tracks(lines: list[str]) -> list[str]:
    """Return the names of columns where names of tracks stand above them, else nothing."""
    if len(lines) < 2:
        return []
    separator = max(SEPARATORS, key=lines[1].count)
    above, below = bare_cells(lines[0], separator), bare_cells(lines[1], separator)
    return (
        tracks.header_of(above, below) if above and below and tracks.is_named(above, below) else []
    )


def _has_decimal_comma(rows: list[str], separator: str) -> bool:
    """Whether numbers have decimal commas; beside commas that part cells these are in quotes."""
    if separator != ",":
        return re.search(r"\d,\d", "\n".join(rows)) is not None
    cells = [cell for row in rows if '"' in row for cell in bare_cells(row, separator)]
    found = [cell for cell in cells if _NUMBER.fullmatch(cell)]
    sure = any("," in cell and not _THOUSANDS.fullmatch(cell) for cell in found)
    return sure and not any("." in cell for cell in found)


def _check_text(path: Path, head: bytes) -> None:
    bare = sum(code < LEAST_CODE and code not in b"\t\n\r\f" for code in head)
    if b"\0" in head or bare > len(head) / 100:
        raise InputError(
            f"{path}: is a binary file, not a text table. Give a CSV, Parquet or MATLAB file with"
            " the matching file extension."
        )


def _head(path: Path, text: str) -> tuple[list[str], int]:
    """Return the header with some rows below it, and how many lines stand before it."""
    position = start = 0
    # Cut by hand: a long file has more lines than anybody asks for.
    while position < len(text):
        end = text.find("\n", position)
        line = text[position : len(text) if end < 0 else end]
        if line.strip() and line[0] != "#":
            break
        position, start = (len(text) if end < 0 else end + 1), start + 1
    if position >= len(text):
        raise InputError(f"{path}: has no header. Add a first line with the column names.")
    part = text[position : position + 20 * LONGEST_LINE]
    lines = list(itertools.islice(part.splitlines(), LOOKED_AT + 1))
    if len(lines[0]) > LONGEST_LINE:
        raise InputError(
            f"{path}: is not a table: its first line has {len(lines[0]):,} characters or more. The"
            " first line must hold the column names."
        )
    return lines, start


def _by_init(path: Path, text: str, what: str) -> str:
    """Return the cure, after a comma, that is a rig file, if one can be written for a text."""
    found = layout_of(text, "utf-8")
    return f", or let `stickslip init {path.name}` write a rig file{what}" if found else ""


def _check_first(path: Path, lines: list[str], start: int, separator: str, text: str) -> None:
    """Refuse lines above the header that are no comments, before they are taken for it."""
    width = len(bare_cells(lines[0], separator))
    rows = [(index, line) for index, line in enumerate(lines) if line.strip()]
    for (index, line), (_, below) in itertools.pairwise(rows):
        for mark in SEPARATORS:
            names, numbers = bare_cells(line, mark), bare_cells(below, mark)
            if len(names) < 2 or len(names) != len(numbers) or len(names) == width:
                continue
            words = not any(_NUMBER.fullmatch(name) for name in names)
            if index and words and all(_NUMBER.fullmatch(cell) for cell in numbers):
                above = "a line precedes" if index == 1 else f"{index} lines precede"
                raise InputError(
                    f"{path}: {above} the header, which appears to be line {start + index + 1},"
                    f" {shown(line[:40].strip())}. Begin each line above it with #, or delete it"
                    f"{_by_init(path, text, ' that skips it')}."
                )


def _check_table(
    path: Path, names: list[str], sample: list[str], separator: str, text: str
) -> None:
    """Refuse what is no table before megabytes of it are parsed."""
    rows = [row for row in sample if row.strip()]
    if not rows:
        return
    if len(names) == 1:
        _check_single(path, names[0], rows, text)
    cells = [cell.strip().strip('"') for row in rows for cell in row.split(separator)]
    if not any(_NUMBER.fullmatch(cell) or cell.lower() in _WORDS for cell in cells):
        refuse_numbers(path, text)
        raise InputError(
            f"{path}: is not a table: its first {len(rows)} rows contain no number; the first"
            f" begins with {shown(rows[0][:40])}. A table has a line of column names, followed by"
            " rows of numbers separated by commas, semicolons or tabs."
        )


def refuse_numbers(path: Path, text: str) -> None:
    """Refuse a text whose rows of numbers have no names above them, whatever parts them."""
    if said := without_names(text):
        raise InputError(f"{path}: {said}.")


def _check_single(path: Path, name: str, rows: list[str], text: str) -> None:
    """Refuse a single column whose rows are separated by something else."""
    for mark, words in (("|", "'|'"), (None, "blanks"), (":", "':'")):
        parts = [row.split(mark) for row in rows]
        several = [cells for cells in parts if len(cells) > 1]
        # A time of day such as 12:30 is one cell, so that names must be parted as well.
        alike = len(several) == len(rows) and len(name.split(mark)) > 1
        if alike and all(_NUMBER.fullmatch(cells[0]) for cells in several):
            refuse_numbers(path, text)
            raise InputError(
                f"{path}: has a single column {shown(name)}, with cells separated by {words}."
                f" Separate the cells by commas, semicolons or tabs{_by_init(path, text, '')}."
            )


def culprit(cells: Sequence[object]) -> int:
    """Return which of the cells that are no numbers makes text of a whole column.

    One such cell leaves all others as text too, of which those with a decimal comma then are no
    numbers either.

    Examples
    --------
    >>> culprit(["0,0", "1.592,0", "broken"]), culprit(["0,0", "broken"]), culprit(["n", "m"])
    (1, 1, 0)
    """
    texts = [cell if isinstance(cell, str) else "" for cell in cells]
    for fits in (_GROUPED.fullmatch, lambda text: not _NUMBER.fullmatch(text)):
        for index, text in enumerate(texts):
            if fits(text):
                return index
    return 0


def grouped(cell: object) -> str:
    """Return the cure, after a blank, of a number with a mark between thousands; else nothing.

    Examples
    --------
    >>> grouped("1.592,0"), grouped("12 000"), grouped("broken")
    (" Write numbers ... separator, here '1592,0'.", " Write ...12000'.", '')
    """
    found = _GROUPED.fullmatch(cell) if isinstance(cell, str) else None
    if found is None:
        return ""
    plain = found[0].strip().replace(found["mark"] or found["comma"], "")
    return f" Write numbers without a thousands separator, here {plain!r}."


# Tables in the sheets of Excel workbooks, which are read as if they had been saved as text.

SPREADSHEET: Final = (".xlsx", ".xlsm")
"""Endings of workbooks."""
CURE: Final = "save the sheet of the record as CSV"


def read_spreadsheet(path: Path, _names: Collection[str] = ()) -> tables.FileTable:
    """Return the table of the first sheet that has one: names above rows of numbers."""
    openpyxl = require_library("openpyxl", "xlsx", f"save the sheet of {path} as CSV")
    with (
        tables.parsed_as(path, "a workbook"),
        path.open("rb") as data,
        zipfile.ZipFile(data) as parts,
    ):
        expanded = sum(part.file_size for part in parts.infolist())
        check_size(str(path), float(expanded), CURE, unit="expanded bytes", most=4 * MOST_NUMBERS)
        with closing(openpyxl.load_workbook(data, read_only=True, data_only=True)) as book:
            return _first(path, {sheet.title: _text(path, sheet) for sheet in book.worksheets})


def _first(path: Path, sheets: dict[str, str]) -> tables.FileTable:
    """Return the table of the first of the sheets, given as texts, that has one."""
    for title, text in sheets.items():
        dialect, found = dialect_of(text), layout_of(text, "utf-8")
        if dialect is None and found is None:
            continue
        others = [name for name, rest in sheets.items() if name != title and rest.strip()]
        remarks = [*tables.read_of("sheet", title, others)]
        if dialect is not None:
            table = dialect.read(text)
        elif found is not None:
            table = read_as(path, text.encode(), found.layout)
        return replace(table, remarks=(*remarks, *table.remarks))
    listed = joined([*map(shown, sheets)])
    raise InputError(
        f"{path}: no sheet has a row of names above rows of numbers; the sheets are {listed}."
    )


def _text(path: Path, sheet: Any) -> str:
    """Return the cells of a sheet as text, separated by tabs."""
    sheet.reset_dimensions()  # which programs write wrongly
    out = io.StringIO()
    writer = csv.writer(out, delimiter="\t", lineterminator="\n")
    cells = 0
    for row in sheet.iter_rows(values_only=True):
        cells += max(1, len(row))
        check_size(str(path), float(cells), CURE, unit="cells", most=MOST_CELLS)
        writer.writerow(_written(row))
    return out.getvalue()


def _written(row: Iterable[Any]) -> Iterator[str]:
    """Yield cells as a text file would have them."""
    for cell in row:
        if cell is None:
            yield ""
        elif isinstance(cell, datetime):
            yield cell.isoformat(sep="T", timespec="microseconds")
        elif isinstance(cell, timedelta):
            yield repr(cell.total_seconds())
        elif isinstance(cell, time):
            yield cell.isoformat(timespec="microseconds")
        elif isinstance(cell, date):
            yield cell.isoformat()
        else:
            yield " ".join(str(cell).split())
