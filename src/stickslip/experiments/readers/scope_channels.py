"""Exports of TwinCAT Scope: groups of channels, each behind a column with their times.

Above the rows stand lines of a key and its values. Each column of times repeats the key, so that a
line reads ``Name;Pos;Force;Name;Torque`` where Pos and Force share their times. An option of the
export gives each channel times of its own, another ends the file with ``EOF``; cells are blank, or
rows shorter, where a slower channel has ended.
"""

import csv
import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np
import pandas as pd

from stickslip.errors import InputError
from stickslip.experiments.readers.layout import is_number, unit_in
from stickslip.experiments.readers.table import (
    Table,
    further_cells,
    merged,
    numbered_twice,
    rows_of,
    times_in,
)
from stickslip.formatting import count
from stickslip.units import is_unit, shown

SCOPE: Final = "channels of TwinCAT Scope"
"""What such a file is, for messages."""
LONGEST_HEAD: Final = 10_000
"""Characters at the top among which its mark is sought."""
_MARK: Final = re.compile(r'"?starttime of export"?(?P<separator>.)', re.IGNORECASE)
_END: Final = ("", "eof")
TIME: Final = "time [ms]"


def is_scope(text: str) -> bool:
    r"""Whether a text is an export of TwinCAT Scope.

    Examples
    --------
    >>> is_scope("Name;Scope\nFile;a.csv\nStarttime of export;1337\n"), is_scope("t;x\n0;1\n")
    (True, False)
    """
    head = text[:LONGEST_HEAD].lstrip("\ufeff")
    named = head.lstrip('"').lower().startswith("name")
    return named and any(_MARK.match(line) for line in head.splitlines())


def read_scope(text: str) -> Table:
    r"""Return the channels of an export as one table.

    Times are in milliseconds, or the numbers of samples. Groups with other times than the first
    are merged with it, and cells are then empty.

    Examples
    --------
    >>> head = "Name;P\nStarttime of export;13\n\nName;Pos;Name;Torque\nSampleTime[ms];2;;2\n"
    >>> table = read_scope(head + "Unit;mm (Position);Unit;N\n\n0;0,5;0;1\n2;0,75;2;1,5\nEOF\n")
    >>> table.data.to_dict("list"), table.first_row
    ({'time [ms]': [0.0, 2.0], 'Pos [mm]': [0.5, 0.75], 'Torque [N]': [1.0, 1.5]}, 8)
    """
    lines = text.lstrip("\ufeff").splitlines()
    marks = ((index, found) for index, line in enumerate(lines) if (found := _MARK.match(line)))
    begins, mark = next(marks)
    separator = mark["separator"]
    while lines[-1].strip(f'{separator}" ').casefold() in _END:
        lines.pop()
    head, first, cells = _head(lines, begins, separator)
    if "name" not in head:
        raise InputError(f"has no names of {SCOPE}: a line above its rows begins with Name.")
    width = Counter(len(row) for row in head.values()).most_common(1)[0][0]
    if len(cells) < width or width < 2:
        raise InputError(
            f"has names of {width} columns and rows of {len(cells)} cells: {SCOPE} have a column of"
            " times and one of values, or more, in each group."
        )
    names, remarks = _names(head, width)
    decimal = "," if separator != "," and any("," in line for line in lines[first:]) else "."
    rows = rows_of(lines[first:], separator, decimal, max(width, len(cells)))
    groups = [*_groups(head, width)]
    lost = further_cells(int(rows[[*rows][width:]].notna().any(axis=1).sum()), width)
    for begin, *places in groups:
        timeless = rows[begin].isna() & rows[places].notna().any(axis=1)
        if timeless.any():
            what = shown(names[places[0]])
            lost.append(f"{count(int(timeless.sum()), 'row')} of {what} without a time: not read.")
    data, same = merged([_group(rows, head, names, places) for places in groups])
    return Table(data=data, first_row=first + 1 if same else 1, remarks=remarks, lost=(*lost,))


def _head(
    lines: Sequence[str], begins: int, separator: str
) -> tuple[dict[str, list[str]], int, list[str]]:
    """Return the lines of keys, the place of the first row, and its cells."""
    head: dict[str, list[str]] = {}
    for place in range(begins, len(lines)):
        cells = _cells(lines[place], separator)
        if any(cells) and is_number(cells[0]):
            return head, place, cells
        if any(cells) and ("name" in head or cells[0].casefold() == "name"):
            head[cells[0].casefold()] = cells
    raise InputError(f"has no rows of {SCOPE}.")


def _cells(line: str, separator: str) -> list[str]:
    """Return the cells of a line, those that are empty too; blanks may part them."""
    try:
        return [cell.strip() for cell in next(csv.reader([line], delimiter=separator), [])]
    except csv.Error:
        return [cell.strip() for cell in line.split(separator)]


def _groups(head: Mapping[str, Sequence[str]], width: int) -> Iterator[list[int]]:
    """Yield the columns of each group, that of its times first: there, all lines have their key."""
    rows = [row for row in head.values() if len(row) == width]
    times = [
        place
        for place in range(width)
        if all(row[place] in ("", row[0]) for row in rows) and any(row[place] for row in rows)
    ]
    for begin, end in zip(times, [*times[1:], width], strict=True):
        yield [*range(begin, end)]


def _names(head: Mapping[str, Sequence[str]], width: int) -> tuple[Sequence[str], tuple[str, ...]]:
    """Return the names of the columns, which are those of symbols where blanks cut the names."""
    names, symbols = head["name"], head.get("symbolname", [])
    remarks: tuple[str, ...] = ()
    if len(names) != width and len(symbols) == width:
        names = symbols
        remarks = (
            "Blanks part the cells and stand in names of channels: the channels are called by"
            " their symbols.",
        )
    if len(names) < width:
        raise InputError(f"has {len(names)} names and {width} columns of {SCOPE}.")
    often = Counter(names)
    several = [often[name] > 1 and symbols[i : i + 1] != [""] for i, name in enumerate(names)]
    told = [
        symbols[i] if again and len(symbols) == width else name
        for i, (name, again) in enumerate(zip(names, several, strict=True))
    ]
    return numbered_twice(told), remarks


def _units(head: Mapping[str, Sequence[str]], width: int) -> Sequence[str]:
    """Return the units of the columns; dV (Voltage) is one cell, also where blanks part cells."""
    cells = head.get("unit", [])
    joined: list[str] = []
    for cell in cells:
        behind = joined and cell.startswith("(") and len(cells) > width
        if behind and not joined[-1].endswith(")") and joined[-1] != cells[0]:
            joined[-1] += f" {cell}"
        else:
            joined.append(cell)
    units = [unit_in(cell) for cell in joined] if len(joined) == width else [""] * width
    return [unit if unit and is_unit(unit) else "" for unit in units]


def _group(
    rows: pd.DataFrame,
    head: Mapping[str, Sequence[str]],
    names: Sequence[str],
    places: Sequence[int],
) -> pd.DataFrame:
    """Return the values of the channels of a group by their times [ms]."""
    units = _units(head, len(names))
    headers = [f"{names[i]} [{units[i]}]" if units[i] else names[i] for i in places[1:]]
    part = rows[list(places)].set_axis([TIME, *headers], axis=1)
    part = part[part[TIME].notna()]
    times = times_in(part[TIME], names[places[-1]])
    periods = head.get("sampletime[ms]", [])
    period = periods[places[1]].replace(",", ".") if len(periods) > places[-1] > 0 else ""
    steps = np.diff(times.to_numpy())
    counted = is_number(period) and steps.size > 0 and np.median(steps) == 1.0
    return part.assign(**{TIME: times * float(period) if counted else times}).set_index(TIME)
