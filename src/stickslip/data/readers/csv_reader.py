"""Tables in text files: CSV in its dialects, what only looks like one, and sheets of workbooks.

Text whose tables only their own reader knows is tried first; sheets are read as if they had been
saved as text.
"""

import csv
import io
import itertools
import math
import operator
import re
import warnings
import zipfile
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from datetime import date, datetime, time, timedelta
from pathlib import Path
from typing import Any, Final

import numpy as np
import pandas as pd

from stickslip.data.measurement import Array
from stickslip.data.readers import table as tables
from stickslip.data.readers import tracks
from stickslip.data.readers.columns import parts_of, without_unit
from stickslip.data.readers.layout import (
    BRACKETS,
    DOUBTED,
    MISSING,
    Layout,
    Separator,
    Text,
    are_units,
    bare_cells,
    bytes_of,
    cells_of,
    decoded,
    doubted_parts,
    headed,
    is_content,
    is_decimal,
    is_head,
    is_number,
    is_row,
    layout_of,
    marks_of,
    seconds_of,
    stated_rates,
    unit_in,
    upper_lines,
    without_names,
)
from stickslip.data.readers.table import (
    TIME,
    TRIAL,
    FileTable,
    further_cells,
    merged,
    numbered_twice,
    rows_of,
    times_in,
)
from stickslip.data.readers.toml import decode
from stickslip.data.tolerances import (
    FEW_SAMPLES,
    FEWEST,
    FEWEST_SAMPLES,
    LONGEST_HEAD,
    LONGEST_LINE,
    MOST_CELLS,
    MOST_LISTED,
    NEGLIGIBLE,
)
from stickslip.errors import MOST_NUMBERS, InputError, check_columns, check_size, concerning
from stickslip.show.display import require_library
from stickslip.show.formatting import count, joined
from stickslip.units import factor, is_of, is_unit, shown

# Text files of instruments: LabVIEW, TwinCAT Scope, serial monitors, tribometers.
#
# Each has rows that only its own reader finds: segments, groups of channels with times of their
# own, lines with stamps, steps below each other.

# Measurement files of LabVIEW: a header, and segments with a header each.
#
# A segment states of each channel its unit, its first time X0 and its step Delta_X. Its rows have
# one column of times, one for each channel, or none (``X_Columns``); each run of the program that
# writes may add a segment. See National Instruments, "Specification for the LabVIEW Measurement
# File".

LABVIEW: Final = "measurement file of LabVIEW"
_BEGIN: Final = "LabVIEW Measurement"
_END_OF_HEADER: Final = "***End_of_Header***"
_SPECIAL: Final = re.compile(r"^\*\*\*Start_Special.*?^\*\*\*End_Special[^\n]*\n?", re.M | re.S)
_DIMENSIONS: Final = {"Time": "s", "Frequency": "Hz", "": "s"}
"""Units of what these files call the dimension of their times."""
TIMES: Final = "X_Value"
_SEPARATORS: Final = {"Tab": "\t", "Comma": ","}


@dataclass(frozen=True, kw_only=True)
class _Segment:
    """Rows below one header."""

    head: Mapping[str, Sequence[str]]
    """Tag of a line above them -> its cells behind it."""
    names: Sequence[str]
    rows: Sequence[str]
    line: int
    """Line of the first row in the file."""


def is_labview(text: str) -> bool:
    r"""Whether a text is a measurement file of LabVIEW.

    Examples
    --------
    >>> is_labview("LabVIEW Measurement\t\n***End_of_Header***\n"), is_labview("t;x\n0;1\n")
    (True, False)
    """
    head = text[:LONGEST_HEAD].lstrip("\ufeff")
    return head.startswith(_BEGIN) and _END_OF_HEADER in head


def read_labview(text: str) -> FileTable:
    r"""Return the channels of all segments as one table.

    Segments that go on in time follow each other; where times begin again, each is a trial.

    Examples
    --------
    >>> table = read_labview(
    ...     "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\n\n"
    ...     "Channels\t2\nSamples\t2\t2\nY_Unit_Label\tmm\tN\nX0\t0\t0\nDelta_X\t0.5\t0.5\n"
    ...     "***End_of_Header***\nX_Value\tWeg\tKraft\tComment\n\t1.5\t2\n\t1.6\t3\n"
    ... )
    >>> table.data.to_dict("list")
    {'X_Value [s]': [0.0, 0.5], 'Weg [mm]': [1.5, 1.6], 'Kraft [N]': [2, 3]}
    """
    text = _SPECIAL.sub(lambda special: "\n" * special[0].count("\n"), text.lstrip("\ufeff"))
    lines = text.splitlines()
    separator = "\t" if "\t" in lines[1] else ","
    tags = {
        cells[0]: cells[1] for line in lines[1:30] if len(cells := cells_of(line, separator)) > 1
    }
    separator = _SEPARATORS.get(tags.get("Separator", ""), separator)
    segments = list(_segments(lines, separator))
    if not segments:
        raise InputError(f"has no rows below a header, as a {LABVIEW} has.")
    decimal = tags.get("Decimal_Separator", "")
    if decimal not in (".", ","):  # files of version 1 have no such tag
        commas = any("," in line for line in segments[0].rows)
        decimal = "," if commas and separator == "\t" else "."
    kept = [segment for segment in segments if [*segment.names] == [*segments[0].names]]
    parts = [_channels(segment, separator, decimal) for segment in kept]
    tables = [data for data, _ in parts]
    remarks, lost = [], (*_cut(kept),)
    if len(kept) < len(segments):
        other = dict.fromkeys(n for part in segments if part not in kept for n in part.names if n)
        remarks.append(
            f"{count(len(segments) - len(kept), 'segment')} of {len(segments)} have other channels"
            f" ({joined([*map(shown, [*other][:8])])}) than the first, and are not read."
        )
    if len(tables) == 1:
        line = kept[0].line if parts[0][1] else 1  # merged rows are not those of the file
        return FileTable(data=tables[0], first_row=line, remarks=(*remarks,), lost=lost)
    trials = [*_trials(tables)]
    if trials[-1] > 1:
        remarks.append(f"Times begin again in later segments: {trials[-1]} trials.")
        tables = [table.assign(**{TRIAL: n}) for table, n in zip(tables, trials, strict=True)]
    return FileTable(data=pd.concat(tables, ignore_index=True), remarks=(*remarks,), lost=lost)


def _segments(lines: Sequence[str], separator: str) -> Iterator[_Segment]:
    """Yield the segments: each begins with the number of its channels and ends before the next."""
    begins = [i for i, line in enumerate(lines) if line.startswith(f"Channels{separator}")]
    if not begins:  # a table below the header of the file
        begins = [next(i for i, line in enumerate(lines) if line.startswith(_END_OF_HEADER))]
    for begin, end in zip(begins, [*begins[1:], len(lines)], strict=True):
        head: dict[str, Sequence[str]] = {}
        for place in range(begin, end):
            cells = cells_of(lines[place], separator)
            if lines[place].startswith(_END_OF_HEADER):
                below = place + 1
                names = cells_of(lines[below], separator) if below < end else []
                rows = [line for line in lines[below + 1 : end] if line.strip()]
                if names and rows:
                    yield _Segment(head=head, names=names, rows=rows, line=below + 2)
                break
            if cells:
                head[cells[0]] = cells[1:]


def _told(head: Mapping[str, Sequence[str]], tag: str) -> list[str]:
    """Return what a line states of each channel; some programs leave a cell beside each free."""
    channels = int(cell) if (cell := "".join([*head.get("Channels", [])][:1])).isdigit() else 0
    places = [place for place, cell in enumerate(head.get("Samples", [])) if cell]
    if len(places) != channels:
        places = [*range(channels)]
    cells = head.get(tag, [])
    return [cells[place] if place < len(cells) else "" for place in places]


def _channels(segment: _Segment, separator: str, decimal: str) -> tuple[pd.DataFrame, bool]:
    """Return the channels of a segment with units, behind their times, and if all have the same."""
    names = segment.names
    width = max(len(names), len(cells_of(segment.rows[0], separator)))
    rows = rows_of(segment.rows, separator, width, decimal)
    own = [place for place, name in enumerate(names) if name not in (TIMES, "Comment", "")]
    units = _told(segment.head, "Y_Unit_Label")
    headers = numbered_twice([names[place] for place in own])
    labels = itertools.chain(units, itertools.repeat(""))
    headers = [headed(name, label) for name, label in zip(headers, labels, strict=False)]
    dimension = next((cell for cell in segment.head.get("X_Dimension", []) if cell), "")
    unit = next((cell for cell in segment.head.get("X_Unit_Label", []) if cell), "")
    times = headed(TIMES, unit or _DIMENSIONS.get(dimension, ""))
    columns = [place for place, name in enumerate(names) if name == TIMES]
    columns = [place for place in columns if rows[place].notna().any()]
    if len(columns) < 2:
        result = rows[own].set_axis(headers, axis=1)
        if columns:
            result.insert(0, times, times_in(rows[columns[0]].dropna(), TIMES))
        else:
            result.insert(0, times, _counted(segment, len(rows), decimal))
        return result, True
    tables = []
    for place, header in zip(own, headers, strict=True):
        before = max(column for column in columns if column < place)
        part = rows[[before, place]].set_axis([times, header], axis=1)
        part = part[part[times].notna()]
        tables.append(part.assign(**{times: times_in(part[times], header)}).set_index(times))
    return merged(tables)


def _counted(segment: _Segment, rows: int, decimal: str) -> Array:
    """Return the times of rows that have none, from those that the header states."""
    result = []
    for tag in ("X0", "Delta_X"):
        cells = [cell.replace(decimal, ".") for cell in _told(segment.head, tag)]
        if len(set(cells)) != 1:
            raise InputError(
                f"has no times, and {tag} of its header is {joined([*dict.fromkeys(cells)])}: save"
                " the channels with their times (X_Columns One or Multi)."
            )
        try:
            result.append(float(cells[0]))
        except ValueError:
            raise InputError(f"has {tag} {shown(cells[0])} in its header, no number.") from None
    return result[0] + result[1] * np.arange(rows, dtype=float)


def _trials(tables: Sequence[pd.DataFrame]) -> Iterator[int]:
    """Yield the trial of each segment: one that begins after the end of the last goes on."""
    trial, last = 1, -np.inf
    for table in tables:
        times = pd.to_numeric(table.iloc[:, 0], errors="coerce")
        trial += bool(times.min() <= last)
        last = float(times.max())
        yield trial


def _cut(segments: Sequence[_Segment]) -> Iterator[str]:
    """Yield that rows are missing, where a header states more samples."""
    for segment in segments:
        stated = max((int(c) for c in _told(segment.head, "Samples") if c.isdigit()), default=0)
        if stated > len(segment.rows):
            yield (
                f"The header above line {segment.line} states {stated:,} samples, and there are"
                f" {len(segment.rows):,} rows: the others are missing."
            )


# Exports of TwinCAT Scope: groups of channels, each behind a column with their times.
#
# Above the rows stand lines of a key and its values. Each column of times repeats the key, so that
# a line reads ``Name;Pos;Force;Name;Torque`` where Pos and Force share their times. An option of
# the export gives each channel times of its own, another ends the file with ``EOF``; cells are
# blank, or rows shorter, where a slower channel has ended.

SCOPE: Final = "channels of TwinCAT Scope"
"""What such a file is, for messages."""
_MARK: Final = re.compile(r'"?starttime of export"?(?P<separator>.)', re.IGNORECASE)
_END_OF_ROWS: Final = ("", "eof")
SCOPE_TIME: Final = "time [ms]"


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


def read_scope(text: str) -> FileTable:
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
    marks = ((index, result) for index, line in enumerate(lines) if (result := _MARK.match(line)))
    begins, mark = next(marks)
    separator = mark["separator"]
    while lines[-1].strip(f'{separator}" ').casefold() in _END_OF_ROWS:
        lines.pop()
    head, first, cells = _head_of_table(lines, begins, separator)
    if "name" not in head:
        raise InputError(f"has no names of {SCOPE}: a line above its rows begins with Name.")
    width = Counter(len(row) for row in head.values()).most_common(1)[0][0]
    if len(cells) < width or width < 2:
        raise InputError(
            f"has names of {width} columns and rows of {len(cells)} cells: {SCOPE} have a column of"
            " times and one of values, or more, in each group."
        )
    names, remarks = _names(head, width)
    rows = rows_of(lines[first:], separator, max(width, len(cells)))
    groups = [*_groups(head, width)]
    lost = further_cells(int(rows[[*rows][width:]].notna().any(axis=1).sum()), width)
    for begin, *places in groups:
        timeless = rows[begin].isna() & rows[places].notna().any(axis=1)
        if timeless.any():
            what = shown(names[places[0]])
            lost.append(f"{count(int(timeless.sum()), 'row')} of {what} without a time: not read.")
    data, same = merged([_group(rows, head, names, places) for places in groups])
    return FileTable(data=data, first_row=first + 1 if same else 1, remarks=remarks, lost=(*lost,))


def _head_of_table(
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
    headers = [
        symbols[i] if again and len(symbols) == width else name
        for i, (name, again) in enumerate(zip(names, several, strict=True))
    ]
    return numbered_twice(headers), remarks


def _channel_units(head: Mapping[str, Sequence[str]], width: int) -> Sequence[str]:
    """Return labels of the columns' units; dV (Voltage) is one, also where blanks part cells."""
    cells = head.get("unit", [])
    joined: list[str] = []
    for cell in cells:
        behind = joined and cell.startswith("(") and len(cells) > width
        if behind and not joined[-1].endswith(")") and joined[-1] != cells[0]:
            joined[-1] += f" {cell}"
        else:
            joined.append(cell)
    return joined if len(joined) == width else [""] * width


def _group(
    rows: pd.DataFrame,
    head: Mapping[str, Sequence[str]],
    names: Sequence[str],
    places: Sequence[int],
) -> pd.DataFrame:
    """Return the values of the channels of a group by their times [ms]."""
    units = _channel_units(head, len(names))
    headers = [headed(names[i], units[i]) for i in places[1:]]
    part = rows[list(places)].set_axis([SCOPE_TIME, *headers], axis=1)
    part = part[part[SCOPE_TIME].notna()]
    times = times_in(part[SCOPE_TIME], names[places[-1]])
    periods = head.get("sampletime[ms]", [])
    period = periods[places[1]].replace(",", ".") if len(periods) > places[-1] > 0 else ""
    steps = np.diff(times.to_numpy())
    counted = is_number(period) and steps.size > 0 and np.median(steps) == 1.0
    return part.assign(**{SCOPE_TIME: times * float(period) if counted else times}).set_index(
        SCOPE_TIME
    )


# Traces of CODESYS and TwinCAT: for each variable a block of times and values.
#
# Above the blocks stand lines ``key; value``, and so do some of each variable before its rows
# ``; time; value``. Two bits of the flags say in what the times are counted.

TRACE: Final = "trace of CODESYS"
_VARIABLE: Final = re.compile(r"^\d++\.Variable[ \t]*+;[ \t]*+([^\r\n]*+)", re.M)
_FLAGS: Final = re.compile(r"^Flags[ \t]*+;[ \t]*+(\d{1,9})[ \t\r]*+$", re.M)
_COUNTED_IN: Final = {16: "ms", 32: "us"}
"""Bits of the flags by which times are counted, and in what."""


def is_trace(text: str) -> bool:
    r"""Whether a text is a trace of CODESYS.

    Examples
    --------
    >>> is_trace("[key]; [value]\n0.Variable; Axis.fActPosition\n"), is_trace("t;x\n0;1\n")
    (True, False)
    """
    return _VARIABLE.search(text[:LONGEST_HEAD]) is not None


def read_trace(text: str) -> FileTable:
    r"""Return the variables of a trace by their times, which all or only some may share.

    Examples
    --------
    >>> text = "Flags; 16\n0.Variable; A.x\n0.Data; \n; 2; 0.5\n; 4; 0.6\n"
    >>> read_trace(text + "1.Variable; A.F\n1.Data; \n; 2; 7\n; 4; 8\n").data.to_dict("list")
    {'time [ms]': [2.0, 4.0], 'A.x': [0.5, 0.6], 'A.F': [7, 8]}
    """
    head, *blocks = _VARIABLE.split(text)
    flags = int(said[1]) if (said := _FLAGS.search(head)) else 0
    time = headed("time", _COUNTED_IN.get(flags & sum(_COUNTED_IN), ""))
    parts, empty = [], []
    for name, block in zip(numbered_twice(blocks[::2]), blocks[1::2], strict=True):
        lines = (line.split(";") for line in block.splitlines() if line.startswith(";"))
        rows = [";".join(map(str.strip, cells[1:3])) for cells in lines]
        if rows:
            part = rows_of(rows, ";", 2).set_axis([time, name], axis=1)
            parts.append(part.assign(**{time: times_in(part[time], name)}).set_index(time))
        else:
            empty.append(name)
    if not parts:
        raise InputError(f"has no rows below the variables of a {TRACE}.")
    lost = [f"Without rows, and not read: {joined([*map(shown, empty)], MOST_LISTED)}."]
    return FileTable(data=merged(parts)[0], lost=(*lost[: len(empty)],))


# What a serial monitor shows, with its time stamps: ``12:30:00.250 -> 1.5<TAB>0.8``.

SERIAL: Final = "output of a serial monitor"
_LINE: Final = re.compile(r"(?P<stamp>\d{1,2}:\d\d:\d\d(?:[.,]\d+)?)\s*->\s?(?P<text>.*)")
_LABELLED: Final = re.compile(r"(?P<name>(?=[\s\d]*+[^\s:\d])[^:]*+):\s*+(?P<value>\S+)")
MONITOR_SEPARATORS: Final = ("\t", ";", ",", " ")


def is_serial(text: str) -> bool:
    r"""Whether a text is the output of a serial monitor.

    Examples
    --------
    >>> is_serial("12:30:00.250 -> 1.5\t0.8\n"), is_serial("12:30:00,1.5\n")
    (True, False)
    """
    first = text.lstrip("\ufeff \t\r\n")[:200].partition("\n")[0]
    return _LINE.fullmatch(first.rstrip()) is not None


def read_serial(text: str) -> FileTable:
    r"""Return the numbers behind the arrows, named as the lines name them, or by their places.

    Examples
    --------
    >>> table = read_serial("23:59:59.500 -> x\tF\n23:59:59.500 -> 1\t2\n00:00:00.000 -> 3\t4\n")
    >>> table.data.to_dict("list")
    {'time [s]': [0.0, 0.5], 'x': [1, 3], 'F': [2, 4]}
    """
    result = [match for line in text.lstrip("\ufeff").splitlines() if (match := _LINE.match(line))]
    texts = [match["text"].strip() for match in result]
    separator = next(
        (mark for mark in MONITOR_SEPARATORS if sum(mark in text for text in texts) > 1), ";"
    )
    cells = [cells_of(text, separator) for text in texts]
    labels = [[_LABELLED.fullmatch(cell) for cell in row] for row in cells]
    values = [
        [match["value"] if match else cell for match, cell in zip(own, row, strict=True)]
        for own, row in zip(labels, cells, strict=True)
    ]
    full = [bool(row) and all(map(is_number, row)) for row in values]
    widths = Counter(len(row) for row, there in zip(values, full, strict=True) if there)
    if not widths:
        raise InputError("has no rows of numbers behind the time stamps of its lines.")
    width = widths.most_common(1)[0][0]
    rows = [i for i, there in enumerate(full) if there and len(values[i]) == width]
    names = [match["name"].strip() if match else "" for match in labels[rows[0]]]
    heads = [cells[i] for i in range(rows[0]) if len(cells[i]) == width]
    if not all(names):
        names = heads[-1] if heads else [f"column {place}" for place in range(1, width + 1)]
    data = rows_of([";".join(values[i]) for i in rows], ";", width).set_axis(names, axis=1)
    times = seconds_of(pd.Series([result[i]["stamp"] for i in rows]))
    if times is None:
        raise InputError("has time stamps before its lines that are no times of day.")
    data.insert(0, TIME, times - times[0])
    lost = len(result) - len(rows) - bool(heads)
    are = "is" if lost == 1 else "are"
    said = [f"{count(lost, 'line')} without {width} numbers {are} not read."] if lost else []
    return FileTable(data=data, lost=(*said,))


# Exports of tribometers: steps below each other, with a header each or a recipe above the table.
#
# Programs of universal tribometers write ``Step No. 1``, some settings, a header and a row of
# units, and the rows. Those of traction machines write ``Step 1 started at``, settings and a
# header, in which names may come twice. Those of rotary modules write a recipe, then one table with
# a column Step, and further lines below it. A step is a trial.

TRIBOMETER: Final = "steps of a tribometer"
_STEP: Final = re.compile(
    r"""^[ \t"]*+step[ \t]*+(?:
        (?:no\.?|nr\.?|number|\#)[ \t]*+[:=]?[ \t]*+(?P<number>\d++)\b
        |(?P<started>\d++)[ \t]+started\b
        |[:=]?[ \t]*+(?P<alone>\d++)[ \t";,]*$)""",
    re.IGNORECASE | re.MULTILINE | re.VERBOSE,
)
_RECIPE: Final = re.compile(r"^\"?recipe\b[^\r\n]*[\r\n]", re.I)
_DIGITS: Final = re.compile(r"(?=[^\d\n]*+\d)[\s\d.,;+\-eE\"]++")
STEP_SEPARATORS: Final = "\t;,"
STEP: Final = "step"
RADIUS: Final = "radius"
FORCES: Final = {"g": "gf", "kg": "kgf", "mg": "mgf"}
"""Units of masses in which forces are given there, and what is meant."""
_FORCE: Final = re.compile(r"F[xyzntf]?|F_?[xyznt]|load|force", re.I)
FEWEST_IN_STEP: Final = 2
"""Numbers in a row of a table, and rows in a step."""


@dataclass(frozen=True, kw_only=True)
class _Section:
    """Rows below one header."""

    label: str
    """Number of the step; empty if none stands above the header."""
    names: tuple[str, ...]
    """Empty if the lines above name not all columns."""
    units: tuple[str, ...]
    rows: Sequence[str]


def is_tribometer(text: str) -> bool:
    r"""Whether a text has steps of a tribometer.

    Examples
    --------
    >>> (
    ...     is_tribometer("Run # 1\nStep No. 1\n\nFx,Fz,T\ng,g,sec\n1,2,3\n"),
    ...     is_tribometer("step,x\n1,2\n"),
    ... )
    (True, False)
    """
    head = text[:LONGEST_HEAD].lstrip("\ufeff")
    recipe = _RECIPE.match(head) is not None and STEP in head.casefold()
    return recipe or _STEP.search(head) is not None


def read_tribometer(text: str) -> FileTable:
    r"""Return the rows of all steps, with the number of their step as the trial.

    Examples
    --------
    >>> table = read_tribometer(
    ...     "Step No. 1\nRadius = 4\nFx,T\ng,sec\n\n1,0\n2,1\n\n"
    ...     "Step No. 2\nRadius = 4\nFx,T\ng,sec\n\n3,0\n4,1\n"
    ... )
    >>> table.data.to_dict("list")
    {'Fx [gf]': [1, 2, 3, 4], 'T [sec]': [0, 1, 0, 1], 'trial': [1, 1, 2, 2]}
    """
    lines = text.lstrip("\ufeff").splitlines()
    separator = max(STEP_SEPARATORS, key=lambda mark: sum(line.count(mark) for line in lines[:500]))
    result = [*_sections(lines, separator)]
    sections = [section for section in result if section.names]
    if not sections:
        raise InputError(
            f"has no rows of {TRIBOMETER}: names of columns, perhaps a row of units, then numbers."
        )
    often = Counter(section.names for section in sections).most_common(1)[0][0]
    kept = [section for section in sections if section.names == often]
    units = [_step_units(section) for section in kept]
    alike = [_are_alike(own, units[0]) for own in units]
    tables = [
        _table(section, own, units[0], separator)
        for section, own, fits in zip(kept, units, alike, strict=True)
        if fits
    ]
    others = [section for section, fits in zip(kept, alike, strict=True) if not fits]
    kept = [section for section in kept if section not in others]
    lost = _without_rows(lines, sections)
    others = [section for section in sections if section.names != often or section in others]
    if others:
        labels = [other.label or str(sections.index(other) + 1) for other in others]
        lost.append(
            f"Steps with other columns, or units of another kind: {joined(labels, MOST_LISTED)}."
        )
    remarks = []
    labels = [section.label or str(number) for number, section in enumerate(kept, 1)]
    if len(set(labels)) < len(labels):  # each run counts its steps anew
        labels = [str(number) for number in range(1, len(kept) + 1)]
    if len(tables) > 1:
        tables = [t.assign(**{TRIAL: int(n)}) for t, n in zip(tables, labels, strict=True)]
    data = _once(pd.concat(tables, ignore_index=True))
    data, own = _of_column(data)
    steps = own or (labels if len(tables) > 1 else [])
    if steps:
        remarks.append(
            f"Each of the {count(len(steps), 'step')} is a trial: {joined(steps, MOST_LISTED)}."
        )
    data, told = _with_sliding_speed(data, lines, separator)
    data, said = _from_slip(data)
    if nameless := sum(len(section.rows) for section in result if not section.names):
        lost.append(f"{count(nameless, 'row')} below no names of columns: not read.")
    return FileTable(data=data, remarks=(*remarks, *told, *said), lost=tuple(lost))


def _is_row(cells: Sequence[str]) -> bool:
    """Whether all cells that hold anything are numbers, and several do."""
    full = [cell for cell in cells if cell]
    return len(full) >= FEWEST_IN_STEP and all(map(is_number, full))


def _sections(lines: Sequence[str], separator: str) -> Iterator[_Section]:
    """Yield the tables: rows of numbers, and the header above them."""
    above: list[str] = []
    rows: list[str] = []
    for line in [*lines, "end"]:
        # of a long table, only the first row is looked at cell by cell
        if _DIGITS.fullmatch(line) and (rows or _is_row(cells_of(line, separator))):
            rows.append(line)
            continue
        if not line.strip(f"{separator} "):
            continue
        if len(rows) >= FEWEST_IN_STEP:
            yield _section(above, rows, separator)
        above = [line] if rows else [*above, line]
        rows = []


def _section(above: Sequence[str], rows: Sequence[str], separator: str) -> _Section:
    """Return rows with what the lines above them say of them."""
    heads = [cells_of(line, separator) for line in above[-2:]]
    units = heads.pop() if len(heads) == 2 and are_units(heads[-1]) else []
    names = heads[-1] if heads else []
    width = max(place for place, cell in enumerate(cells_of(rows[0], separator), 1) if cell)
    if len(names) < width or sum(map(bool, names)) < FEWEST_IN_STEP:
        names = []
    result = [match[match.lastgroup or 0] for line in above if (match := _STEP.match(line))]
    return _Section(
        label=result[-1] if result else "",
        names=tuple(name.removesuffix("()").strip() for name in names),
        units=tuple(units),
        rows=rows,
    )


def _without_rows(lines: Sequence[str], sections: Sequence[_Section]) -> list[str]:
    """Return what is said of steps below whose number there are no two rows."""
    result = [match for line in lines if (match := _STEP.match(line))]
    kinds = {
        hit.lastgroup for hit in result if hit[hit.lastgroup or 0] in {s.label for s in sections}
    }
    missed = Counter(hit[hit.lastgroup or 0] for hit in result if hit.lastgroup in kinds)
    missed -= Counter(section.label for section in sections)
    if not missed:
        return []
    step, have, are = ("Steps", "have", "are") if len(missed) > 1 else ("Step", "has", "is")
    which = (
        f"{step} {joined([*missed], MOST_LISTED)} {have} no table of {FEWEST_IN_STEP} rows or more"
    )
    return [f"{which} and {are} left out."]


def _step_units(section: _Section) -> list[str]:
    """Return the unit of each name; empty where there is none."""
    units = [unit_in(cell) for cell in section.units]
    units += [""] * (len(section.names) - len(units))
    result = [
        FORCES.get(unit, unit) if _FORCE.fullmatch(name) else unit
        for name, unit in zip(section.names, units, strict=False)
    ]
    return [unit if unit and is_unit(unit) else "" for unit in result]


def _are_alike(units: Sequence[str], first: Sequence[str]) -> bool:
    """Whether units are those of another step, or of their kinds."""
    pairs = zip(units, first, strict=True)
    return all(own == pair or (bool(own and pair) and is_of(own, pair)) for own, pair in pairs)


def _table(
    section: _Section, units: Sequence[str], first: Sequence[str], separator: str
) -> pd.DataFrame:
    """Return the rows of a section in the units of the first, columns without a name left out."""
    width = max(len(section.names), len(cells_of(section.rows[0], separator)))
    data = rows_of(section.rows, separator, width)
    named = [place for place, name in enumerate(section.names) if name]
    for place in named:
        if units[place] != first[place]:
            data[place] = data[place].astype(float) * factor(units[place], first[place])
    headers = [section.names[i] + (f" [{first[i]}]" if first[i] else "") for i in named]
    return data[named].set_axis(numbered_twice(headers), axis=1)


def _once(data: pd.DataFrame) -> pd.DataFrame:
    """Return a table without columns that repeat another one under the same name."""
    again = [
        name
        for name in data.columns
        if (match := re.fullmatch(r"(.*) \(\d+\)", name))
        and match[1] in data.columns
        and data[name].equals(data[match[1]])
    ]
    return data.drop(columns=again)


def _of_column(data: pd.DataFrame) -> tuple[pd.DataFrame, list[str]]:
    """Return a table whose column Step, if it has one, numbers the trials, and their numbers."""
    column = next((name for name in data.columns if name.casefold() == STEP), None)
    if column is None or TRIAL in data.columns or data[column].isna().any():
        return data, []
    steps = [str(step) for step in data[column].unique()]
    if len(steps) < 2:
        return data, []
    again = [n for n in data.columns if n != column and data[n].equals(data[column])]
    return data.drop(columns=again).rename(columns={column: TRIAL}), steps


def _with_sliding_speed(
    data: pd.DataFrame, lines: Sequence[str], separator: str
) -> tuple[pd.DataFrame, list[str]]:
    """Return a table with the speed at the radius of a recipe, where it has one of rotation."""
    heads = [[cell.casefold() for cell in cells_of(line, separator)] for line in lines[:2]]
    values = cells_of(lines[1], separator) if len(lines) > 1 else []
    place = heads[0].index(RADIUS) if RADIUS in heads[0] else len(values)
    speeds = [name for name in data.columns if re.search(r"[\[(]rpm[\])]", name, re.I)]
    if not speeds or place >= len(values) or not is_number(values[place]):
        return data, []
    radius = float(values[place])
    speed = pd.to_numeric(data[speeds[0]], errors="coerce") * (2.0 * math.pi / 60.0 * radius)
    return data.assign(**{"Sliding Speed [mm/s]": np.asarray(speed, dtype=float)}), [
        f"The sliding speed is {shown(speeds[0])} at the radius of the recipe, {radius:g} mm."
    ]


def _from_slip(data: pd.DataFrame) -> tuple[pd.DataFrame, list[str]]:
    """Return a table with the sliding speed, from a slide-roll ratio and the rolling speed."""
    headers = list(map(str, data.columns))
    names = {header: " ".join(parts_of(re.split(r"[\[(]", header)[0])) for header in headers}
    if any("sliding" in name or "slip" in name for name in names.values()):
        return data, []
    ratio = next((n for n, bare in names.items() if bare in ("srr", "slide roll ratio")), None)
    rolling = [n for n, bare in names.items() if bare in ("rolling speed", "entrainment speed")]
    if ratio is None or not rolling:
        return data, []
    bracket = re.search(r"[\[(]([^\[\]()]++)[\])]", rolling[0])
    unit = bracket[1] if bracket else ""
    share = 100.0 if "%" in ratio else 1.0
    speed = pd.to_numeric(data[ratio], errors="coerce") / share
    speed *= pd.to_numeric(data[rolling[0]], errors="coerce")
    name = f"Sliding Speed [{unit}]" if unit and is_unit(unit) else "Sliding Speed"
    return data.assign(**{name: np.asarray(speed, dtype=float)}), [
        f"The sliding speed is {shown(ratio)} times {shown(rolling[0])}: the ratio is taken for the"
        " difference of both surfaces' speeds over their mean."
    ]


# Tables in text files: CSV in its dialects, what only looks like one, and sheets of workbooks.

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
    Dialect(title=SCOPE, is_text=is_scope, read=read_scope),
    Dialect(title=TRACE, is_text=is_trace, read=read_trace),
    Dialect(title=LABVIEW, is_text=is_labview, read=read_labview),
    Dialect(
        title=TRIBOMETER,
        is_text=is_tribometer,
        read=read_tribometer,
    ),
    Dialect(title=tracks.MOTION_CAPTURE, is_text=tracks.is_capture, read=tracks.read_capture),
    Dialect(title=SERIAL, is_text=is_serial, read=read_serial),
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

CONTROLS: Final = bytes({*range(ord(" "))} - {*b"\t\n\r\f"})
"""Bytes that hardly stand in a text."""
SEPARATORS: Final[tuple[Separator, ...]] = (",", ";", "\t")
"""Marks between cells of a table whose first line is its header."""
_GROUPED: Final = re.compile(
    r"""\s*[+-]?\d{1,3}(?:
        (?P<mark>[.'\ \u2019\u00a0\u202f])\d{3}(?:(?P=mark)\d{3})*(?:(?!(?P=mark))[.,]\d+)?
        |(?P<comma>,)\d{3}(?:(?:,\d{3})+(?:\.\d+)?|\.\d+))\s*""",
    re.VERBOSE,
)
"""A number whose thousands are separated by a mark; 1,592 alone may be one with decimals."""
NO_MARK: Final = "\x1f"
"""Decimal mark for numbers of which none is known: it stands in no text."""
_LONE: Final = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}")
"""A number with one mark, which may be decimal or part thousands."""


def ambiguous(file: str | Path, name: str) -> InputError:
    """Return the error of a table in which two columns have one name."""
    return InputError(f"{file}: two columns are named {shown(name)}. Rename one of them.")


def read_text(path: Path, layout: Layout | None = None) -> tables.FileTable:
    """Return a CSV table; lines before the header may be comments."""
    data = bytes_of(path)
    text, encoding = _decoded(path, data) if layout is None else (_text_in(path, data, layout), "")
    dialect = dialect_of(text)
    if dialect is not None and layout is None:
        with concerning(f"{path}:", InputError):
            return dialect.read(text)
    if dialect is not None:
        raise InputError(
            f"{path}: is a {dialect.title}, which is read without a layout: leave it out."
        )
    if layout is not None:
        return read_as(path, text, data, layout)
    layout, doubted = _layout(path, text, encoding)
    return read_as(path, text, data, layout, doubted=doubted)


def _text_in(path: Path, data: bytes, layout: Layout) -> str:
    try:
        return data.decode(layout.encoding)
    except UnicodeDecodeError as error:
        raise InputError(
            f"{path}: is not in the code page {layout.encoding} of its layout (byte"
            f" 0x{data[error.start]:02x} at {error.start})."
        ) from None


def _layout(path: Path, text: str, encoding: str) -> tuple[Layout, str]:
    """Return how a text holds its table, and the marks that may be decimal or part thousands.

    Numbers with such a mark stay text, which is refused where it is read.
    """
    lines = upper_lines(text)
    start = next((i for i, line in enumerate(lines) if is_content(line)), None)
    if start is None:
        raise InputError(f"{path}: has no header. Add a first line with the column names.")
    if len(lines[start]) >= LONGEST_LINE:
        raise InputError(
            f"{path}: is not a table: its first line has {LONGEST_LINE:,} characters or more. The"
            " first line must hold the column names."
        )
    separator = max(SEPARATORS, key=lines[start].count)
    below = [line for line in lines[start + 1 :] if line.strip()]
    rows = [cells_of(line, separator) for line in below]
    named = separator in lines[start] and is_head(cells_of(lines[start], separator))
    # Names in the first line above a row of numbers, or names wherever rows of numbers begin.
    plain = named and (not below or is_row(below[0], separator))
    if not plain and (result := layout_of(text, encoding)):
        _check_head(path, lines, result)
        layout, assumed = result.layout, result.assumed
    else:
        if not plain:
            refuse_numbers(path, text)
        if rows and not any(is_number(x) or x.casefold() in MISSING for row in rows for x in row):
            raise InputError(
                f"{path}: is not a table: its first {len(rows)} rows contain no number; the first"
                f" begins with {shown(rows[0][0][:40])}. A table has a line of column names, and"
                " below it rows of numbers separated by commas, semicolons, tabs, bars or blanks."
            )
        decimal, thousands, assumed = marks_of(text, rows[:FEW_SAMPLES], separator)
        layout = Layout(
            encoding=encoding,
            separator=separator,
            decimal=decimal,
            thousands=thousands,
            preface=start,
        )
    _check_single_table(path, lines, layout)
    if not assumed:
        return layout, ""
    if not layout.thousands:
        return replace(layout, decimal="."), ","
    # 1,592 beside 1.592: either mark may be the decimal one
    both = not is_decimal(layout.decimal, text, layout.separator)
    return replace(layout, thousands=""), ".," if both else layout.thousands


def _check_head(path: Path, lines: Sequence[str], text: Text) -> None:
    """Refuse a text of which several lines may be the header; that above it may name tracks."""
    names = cells_of(lines[text.layout.preface], text.layout.separator)
    for line in text.rivals:
        if not tracks.is_named(cells_of(lines[line], text.layout.separator), names):
            first, last = sorted((line, text.layout.preface))
            raise InputError(
                f"{path}: line {first + 1}, {shown(lines[first][:40].strip())}, and line"
                f" {last + 1}, {shown(lines[last][:40].strip())}, may both hold the names of the"
                " columns. Begin the line that does not with #, if it is above the other, or"
                " delete it."
            )


def _check_single_table(path: Path, lines: Sequence[str], layout: Layout) -> None:
    """Refuse a second table: names above rows of numbers, as wide as these and not as the first."""
    if layout.separator == " ":
        return
    full = [index for index, line in enumerate(lines) if is_content(line)]
    cells = {index: cells_of(lines[index], layout.separator) for index in full}
    width = len(cells.get(layout.preface, ()))
    for place, index in enumerate(full):
        size = len(cells[index])
        # Above the header, a line of settings may have their names above it.
        few = 1 if index > layout.preface else FEWEST
        below = full[place + 1 : place + 1 + few]
        if (
            size not in (1, width)
            and len(below) == few
            and all(len(cells[i]) == size and is_row(lines[i], layout.separator) for i in below)
            and all(cells[index])
            and is_head(cells[index])
            and not any(map(is_number, cells[index]))
        ):
            raise InputError(
                f"{path}: line {index + 1}, {shown(lines[index][:40].strip())}, appears to be a"
                f" second header, beside line {layout.preface + 1}. Give each table a file of its"
                " own."
            )


def read_as(
    path: Path, text: str, data: bytes, layout: Layout, *, doubted: str = ""
) -> tables.FileTable:
    """Return the table of a text, and the bytes of that, which holds it in a known way.

    Numbers stay text that have a mark of which it is `doubted` what it parts. Of a workbook, names
    that come again are numbered.
    """
    lines = upper_lines(text, layout.preface)
    if len(lines) < 1 + layout.units_row:
        raise InputError(f"{path}: has no rows below the {layout.preface} lines of its preface.")
    names = cells_of(lines[0], layout.separator)
    above = upper_lines(text)[: layout.preface]
    track = cells_of(above[-1], layout.separator) if above else []
    if track and names and tracks.is_named(track, names):
        names = tracks.header_of(track, names)
    if layout.units_row:
        units = [unit_in(cell) for cell in cells_of(lines[1], layout.separator)]
        pairs = itertools.zip_longest(names, units, fillvalue="")
        names = [_with_unit(path, name, unit) if unit and name else name for name, unit in pairs]
    remarks: tuple[str, ...] = ()
    if path.suffix.casefold() in SPREADSHEET:
        bare = [without_unit(name) for name in names]
        own = [name and again for name, again in zip(bare, numbered_twice(bare), strict=True)]
        names = [name.replace(old, new, 1) for name, old, new in zip(names, bare, own, strict=True)]
        if again := [shown(name) for name in own if name not in bare]:
            remarks = (f"Names that stand twice are numbered: {joined(again, MOST_LISTED)}.",)
    sample = lines[1 + layout.units_row :][:FEW_SAMPLES]
    if not layout.thousands.isascii():  # of which the parser knows none
        data = text.replace(layout.thousands, "").encode(layout.encoding)
        layout = replace(layout, thousands="")
    rates = stated_rates(above, layout)
    table = _parsed(path, data, names, sample, layout, doubted=doubted)
    return replace(table, rates=rates, remarks=remarks)


def _with_unit(path: Path, name: str, unit: str) -> str:
    """Return a name with its unit from the row below, which must not differ from one it has."""
    known = name.removeprefix(without_unit(name)).strip(" /[]()<>{}")
    if known and is_unit(known) and known != unit:
        raise InputError(
            f"{path}: the header states {known} of the column {shown(without_unit(name))}, and the"
            f" row of units below it {shown(unit)}. Delete the one that is wrong."
        )
    return name if known == unit else f"{name} [{unit}]"


def _parsed(
    path: Path,
    data: bytes,
    names: Sequence[str],
    sample: Sequence[str],
    layout: Layout,
    *,
    doubted: str,
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
                decimal=NO_MARK if layout.decimal in doubted else layout.decimal,
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
    table = table.dropna(how="all")
    table = _without_doubts(table if doubted else _with_points(table, layout), layout)
    lost = tables.further_cells(more, len(names))
    if cut := _cut_number(data, layout):
        table = table.iloc[:-1]
        lost.append(
            f"The file ends within a number, {shown(cut)}, which has fewer digits than those above"
            " it: the last row is left out."
        )
    return tables.FileTable(
        data=table, first_row=above + 1, lost=tuple(lost), doubted=bool(doubted)
    )


def _with_points(table: pd.DataFrame, layout: Layout) -> pd.DataFrame:
    """Return a table with numbers where all of a column have points, beside decimal commas."""
    texts = table.select_dtypes(exclude="number") if layout.decimal == "," else table[[]]
    numbers = texts.apply(pd.to_numeric, errors="coerce")
    known = [name for name in texts if numbers[name].notna().equals(texts[name].notna())]
    return table.assign(**{str(name): numbers[name] for name in known})


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
    lines = data[-LONGEST_HEAD:].decode(layout.encoding, errors="replace").splitlines()[1:]
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
        _check_text(path, data[:LONGEST_LINE])
    if encoding == "cp1252":
        for line in text.splitlines():
            cells = [] if line.isascii() else [cell.strip() for cell in re.split("[,;\t]", line)]
            numbers = {cell for cell in cells if is_number(cell)}
            if numbers and any(not cell.isascii() for cell in cells if cell not in numbers):
                decode(data, str(path))  # raises: who knows what these bytes are
    return text, encoding


def _check_text(path: Path, head: bytes) -> None:
    bare = len(head) - len(head.translate(None, CONTROLS))
    if b"\0" in head or bare > NEGLIGIBLE * len(head):
        raise InputError(
            f"{path}: is a binary file, not a text table. Give a CSV, Parquet or MATLAB file with"
            " the matching file extension."
        )


def refuse_numbers(path: Path, text: str) -> None:
    """Refuse a text whose rows of numbers have no names above them, whatever parts them."""
    if said := without_names(text):
        raise InputError(f"{path}: {said}.")


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
    for fits in (_GROUPED.fullmatch, lambda text: not is_number(text.strip())):
        for index, text in enumerate(texts):
            if fits(text):
                return index
    return 0


def is_doubted(cell: object) -> bool:
    """Return whether the mark of a number may be decimal or part thousands.

    Examples
    --------
    >>> is_doubted("1,592"), is_doubted("1.5"), is_doubted("0.592")
    (True, False, False)
    """
    return isinstance(cell, str) and _LONE.fullmatch(cell.strip()) is not None


def grouped(cell: object) -> str:
    """Return the cure, after a blank, of a number with a mark between thousands; else nothing.

    Examples
    --------
    >>> grouped("1.592,0"), grouped("12 000"), grouped("broken")
    (" Write numbers ... separator, here '1592,0'.", " Write ...12000'.", '')
    >>> grouped("1,592")[:32]
    " '1,592' may be 1592 or 1.592: w"
    """
    text = cell.strip() if isinstance(cell, str) else ""
    if is_doubted(text):
        whole, part = (re.sub("[.,]", mark, text) for mark in ("", "."))
        return (
            f" {text!r} may be {whole} or {part}: write all numbers with one decimal mark, or give"
            " a layout, which says what parts thousands."
        )
    result = _GROUPED.fullmatch(text)
    if result is None:
        return ""
    plain = text.replace(result["mark"] or result["comma"], "")
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
        dialect, result = dialect_of(text), layout_of(text, "utf-8")
        if dialect is None and result is None:
            continue
        others = [name for name, rest in sheets.items() if name != title and rest.strip()]
        remarks = [*tables.read_of("sheet", title, others)]
        if dialect is not None:
            table = dialect.read(text)
        elif result is not None:
            table = read_as(path, text, text.encode(), result.layout)
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
