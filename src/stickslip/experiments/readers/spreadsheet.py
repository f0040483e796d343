"""Tables in the sheets of Excel workbooks, which are read as if they had been saved as text."""

import csv
import io
import zipfile
from collections.abc import Collection, Iterable, Iterator
from contextlib import closing
from dataclasses import replace
from datetime import date, datetime, time, timedelta
from pathlib import Path
from typing import Any, Final

from stickslip.errors import MOST_NUMBERS, InputError, check_size
from stickslip.experiments.readers.csv_reader import read_as
from stickslip.experiments.readers.dialects import dialect_of
from stickslip.experiments.readers.layout import layout_of
from stickslip.experiments.readers.table import Table, read_of
from stickslip.formatting import joined
from stickslip.units import shown

SPREADSHEET: Final = (".xlsx", ".xlsm")
"""Endings of workbooks."""
CURE: Final = "save the sheet of the record as CSV"
MOST_CELLS: Final = 2e7
"""Cells up to which a sheet is read, empty ones that are stepped over included."""


def read_spreadsheet(path: Path, _names: Collection[str] = ()) -> Table:
    """Return the table of the first sheet that has one: names above rows of numbers."""
    try:
        import openpyxl
    except ImportError:
        raise InputError(
            f"{path}: workbooks need the package openpyxl: pip install 'stickslip[xlsx]', or save"
            " the sheet as CSV."
        ) from None
    try:
        with path.open("rb") as data, zipfile.ZipFile(data) as parts:
            expanded = sum(part.file_size for part in parts.infolist())
            check_size(
                str(path), float(expanded), CURE, unit="expanded bytes", most=4 * MOST_NUMBERS
            )
            with closing(openpyxl.load_workbook(data, read_only=True, data_only=True)) as book:
                return _first(path, {sheet.title: _text(path, sheet) for sheet in book.worksheets})
    except InputError:
        raise
    except Exception as error:
        # The package has whatever error its parser stumbles over.
        reason = (str(error).strip() or type(error).__name__).splitlines()[0].rstrip(".")
        raise InputError(f"{path}: is not a workbook, or is damaged: {reason}.") from None


def _first(path: Path, sheets: dict[str, str]) -> Table:
    """Return the table of the first of the sheets, given as texts, that has one."""
    for title, text in sheets.items():
        dialect, found = dialect_of(text), layout_of(text, "utf-8")
        if dialect is None and found is None:
            continue
        others = [name for name, rest in sheets.items() if name != title and rest.strip()]
        remarks = [*read_of("sheet", title, others)]
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
    """Return the cells of a sheet as text, parted by tabs."""
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
