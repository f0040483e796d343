"""Tracks of bodies: programs for video analysis, and exports of motion capture."""

import re
from collections.abc import Sequence
from typing import Final

import numpy as np
import pandas as pd

from stickslip.data.readers.columns import STYLES
from stickslip.data.readers.layout import LOOKED_AT, cells_of, is_number, unit_in
from stickslip.data.readers.table import FileTable, numbered_twice, rows_of
from stickslip.errors import InputError, check_columns
from stickslip.show.formatting import quantity
from stickslip.units import factor, is_unit, shown

# Tracks that programs for video analysis write: names above the header, and blocks without one.
#
# Tracker [1]_ puts the name of a track above its columns, ``mass_A``; with several tracks a line
# has one name where the columns of each begin. Kinovea [2]_ writes them into one CSV file, whose
# columns are called ``track/point/X``, or for gnuplot as blocks of rows parted by blanks.
#
# .. [1] https://github.com/OpenSourcePhysics/tracker, class ExportDataDialog.
# .. [2] https://github.com/Kinovea/Kinovea, classes ExporterCSV and ExporterTXTTrajectory; older
#    versions wrote the times of blocks as h:mm:ss:cc.

SEPARATOR: Final = "/"
"""Stands between the name of a track and that of its coordinate."""
FIRST: Final = "t"
"""The column that Tracker writes first."""
_BLOCKS: Final = "#kinovea trajectory"
_STAMP: Final = re.compile(
    r"\s*(?:(?P<hours>\d{1,9}):(?P<minutes>\d\d):(?P<seconds>\d\d)(?:[.,:](?P<part>\d+))?"
    r"|(?P<m>\d{1,9}):(?P<s>\d\d)[.,](?P<rest>\d+))\s*"
)
_UNIT: Final = re.compile(r"(?P<name>.*\S)\s*\((?P<unit>[^()]+)\)\s*")


def seconds(cell: object) -> float | None:
    """Return a time such as ``h:mm:ss:cc`` or ``m:ss.xxx`` in seconds; None if it is none.

    Examples
    --------
    >>> seconds("0:00:01:07"), seconds("1:00:00.25"), seconds("2:03,5"), seconds("12:30")
    (1.07, 3600.25, 123.5, None)
    """
    result = _STAMP.fullmatch(cell) if isinstance(cell, str) else None
    if result is None:
        return None
    hours, minutes, whole = (
        result["hours"] or 0,
        result["minutes"] or result["m"],
        result["seconds"],
    )
    part = result["part"] or result["rest"] or 0
    return 60 * (60 * int(hours) + int(minutes)) + float(f"{whole or result['s']}.{part}")


def is_named(names: Sequence[str], below: Sequence[str]) -> bool:
    """Whether a line has the names of tracks, to which the columns in the line below it belong.

    Examples
    --------
    >>> is_named(["mass_A"], ["t", "x", "y"]), is_named(["Tribometer"], ["time", "position"])
    (True, False)
    """
    given = any(name.strip() for name in names)
    first = _with_unit(below[0]).partition(" [")[0]
    return given and names[0] != FIRST == first and len(names) <= len(below)


def header_of(names: Sequence[str], below: Sequence[str]) -> list[str]:
    """Return the columns of Tracker with their units, and with their tracks if there are several.

    Examples
    --------
    >>> header_of(["mass_A"], ["t", "x (cm)", "y (cm)"])
    ['t', 'x [cm]', 'y [cm]']
    >>> header_of(["", "mass A", "", "mass B"], ["t", "x", "y", "x", "y", ""])
    ['t', 'mass A/x', 'mass A/y', 'mass B/x', 'mass B/y', '']
    """
    known = [column.strip() for column in below if column.strip()]
    several = len(set(known)) < len(known)
    track, result = "", []
    for index, column in enumerate(below):
        own = names[index].strip() if index < len(names) else ""
        track = own or track
        name = _with_unit(column)
        named = several and track and name and index > 0
        result.append(f"{track}{SEPARATOR}{name}" if named else name)
    return result


def _with_unit(column: str) -> str:
    result = _UNIT.fullmatch(column.strip())  # from the start only: a cell may be long
    return f"{result['name']} [{result['unit']}]" if result else column.strip()


def is_blocks(text: str) -> bool:
    r"""Whether a text has the tracks of Kinovea as blocks of rows.

    Examples
    --------
    >>> is_blocks("#Kinovea Trajectory data export\n#T X Y\n")
    True
    """
    return text[: len(_BLOCKS)].lower() == _BLOCKS


def read_blocks(text: str) -> FileTable:
    r"""Return blocks of rows as one table over all their times.

    Cells stay texts. Rows are counted from 1 where there are several blocks, which are merged.

    Examples
    --------
    >>> text = "#Kinovea Trajectory data export\n#T X Y\n0:00:00:00 866.0 320,5 \n"
    >>> table = read_blocks(text)
    >>> table.data.to_dict("records"), table.first_row
    ([{'T': '0:00:00:00', 'X': '866.0', 'Y': '320.5'}], 3)
    """
    tracks: list[tuple[str, list[list[str]], list[int]]] = []
    name, begun = "", False
    for number, line in enumerate(text.splitlines(), 1):
        cells = line.replace(",", ".").split()
        if not cells or line.startswith("#"):
            begun = False
            name = line[1:].strip() if line.startswith("# ") else name
            continue
        if not begun:
            tracks.append((name or f"track {len(tracks) + 1}", [], []))
            name, begun = "", True
        tracks[-1][1].append(cells)
        tracks[-1][2].append(number)
    several = len(tracks) > 1
    tables = [_block(rows, f"{track}{SEPARATOR}" if several else "") for track, rows, _ in tracks]
    if not several:
        first = tracks[0][2][0] if tracks else 1
        whole = tables[0] if tables else pd.DataFrame()
        lines = [line - first for line in tracks[0][2]] if tracks else []
        return FileTable(data=whole.set_axis(lines), first_row=first)
    by_time = [table.set_index("T") for table in tables]
    for (track, _, _), table in zip(tracks, by_time, strict=True):
        if not table.index.is_unique:
            twice = table.index[table.index.duplicated()][0]
            raise InputError(
                f"{track!r} has the time {twice} twice: export the times with more digits, e.g. in"
                " milliseconds."
            )
    merged = pd.concat(by_time, axis=1)
    return FileTable(data=merged.loc[sorted(merged.index, key=_moment)].reset_index())


def _moment(cell: str) -> float:
    stamp = seconds(cell)
    try:
        return float(cell) if stamp is None else stamp
    except ValueError:
        raise InputError(
            f"a row begins with {shown(cell)}, which is not a time. Every row of a"
            " track begins with its time."
        ) from None


def _block(rows: list[list[str]], track: str) -> pd.DataFrame:
    """Return one block; a track of several points has more than one pair of columns."""
    width = max(len(cells) for cells in rows)
    check_columns("the table", width)
    pairs = (width - 1) // 2
    names = ["T"]
    for pair in range(pairs):
        point = f"{pair}{SEPARATOR}" if pairs > 1 else ""
        names += [f"{track}{point}X", f"{track}{point}Y"]
    names += [f"{track}{index}" for index in range(len(names), width)]
    return pd.DataFrame(rows, columns=names)


# Exports of motion capture by Motive: rigid bodies and markers in five rows of headers.
#
# The first line holds settings of the take in pairs. Above the columns stand what each is of (Rigid
# Body), its name, its number, and whether it is of the rotation or of the position; below these,
# the axes. See the description of "Data Export: CSV" by OptiTrack.

MOTION_CAPTURE: Final = "bodies of motion capture"
_BEGIN: Final = "format version"
_TAKE: Final = "take name"
POSITION: Final = "Position"


def is_capture(text: str) -> bool:
    """Whether a text is an export of Motive.

    Examples
    --------
    >>> is_capture("Format Version,1.23,Take Name,Take 1,Capture Frame Rate,120"), is_capture("t,x")
    (True, False)
    """
    first = text[:2000].lstrip("\ufeff").partition("\n")[0].casefold()
    return first.startswith(_BEGIN) and _TAKE in first


def read_capture(text: str) -> FileTable:
    """Return the columns called ``body/Position/X``, those first along which a body moves most."""
    lines = text.lstrip("\ufeff").splitlines()
    settings = cells_of(lines[0], ",")
    stated = dict(zip(settings[::2], settings[1::2], strict=False))
    head = [cells_of(line, ",") for line in lines[:LOOKED_AT]]
    first = next((i for i, cells in enumerate(head) if cells and is_number(cells[0])), 0)
    above = [cells for cells in head[1:first] if any(cells)]
    if len(above) < 2:
        raise InputError(f"has no rows of {MOTION_CAPTURE} below its headers.")
    axes, kinds = above[-1], above[-2]
    names = next((row for row in above if row[1:2] == ["Name"]), [])
    width = max(len(row) for row in above)
    length = unit_in(stated.get("Length Units", ""))
    headers = []
    for place in range(width):
        name, kind, axis = (row[place] if place < len(row) else "" for row in (names, kinds, axes))
        parts = [part for part in (name, kind, axis) if part] if place > 1 else [axis]
        header = SEPARATOR.join(parts)
        match = STYLES[0].fullmatch(header) if place == 1 else None
        if match and is_unit(unit_in(match["unit"])):
            header = f"{match['name']} [{unit_in(match['unit'])}]"
        headers.append(f"{header} [{length}]" if kind == POSITION and is_unit(length) else header)
    rows = [line for line in lines[first:] if line.strip(", ")]
    data = rows_of(rows, ",", width).set_axis(numbered_twice(headers), axis=1)
    data = data[[name for name in data.columns if name and data[name].notna().any()]]
    spans = {name: _span(data[name]) for name in data.columns if f"{SEPARATOR}{POSITION}" in name}
    order = sorted(spans, key=lambda name: spans[name], reverse=True)
    others = [name for name in data.columns if name not in spans]
    remarks = []
    if order and is_unit(length):
        scale = factor(length, "m")
        told = [
            f"{shown(n.partition(' [')[0])} {quantity(spans[n] * scale, 'm')}" for n in order[:3]
        ]
        remarks.append(f"Largest spans of positions: {', '.join(told)}.")
    return FileTable(
        data=data[[*others[:2], *order, *others[2:]]], first_row=first + 1, remarks=(*remarks,)
    )


def _span(column: "pd.Series[float]") -> float:
    numbers = pd.to_numeric(column, errors="coerce").to_numpy(dtype=float)
    return float(np.nanmax(numbers) - np.nanmin(numbers)) if np.isfinite(numbers).any() else 0.0
