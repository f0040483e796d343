r"""Measurement files of LabVIEW: a header, and segments with a header each.

A segment states of each channel its unit, its first time X0 and its step Delta_X. Its rows have one
column of times, one for each channel, or none (``X_Columns``); each run of the program that writes
may add a segment. See National Instruments, "Specification for the LabVIEW
Measurement File".
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
import pandas as pd

from stickslip.errors import InputError
from stickslip.experiments.measurement import Array
from stickslip.experiments.readers.layout import cells_of, unit_in
from stickslip.experiments.readers.table import (
    TRIAL,
    Table,
    merged,
    numbered_twice,
    rows_of,
    times_in,
)
from stickslip.formatting import count, joined
from stickslip.units import is_unit, shown

LABVIEW: Final = "measurement file of LabVIEW"
_BEGIN: Final = "LabVIEW Measurement"
_END: Final = "***End_of_Header***"
_SPECIAL: Final = re.compile(r"^\*\*\*Start_Special.*?^\*\*\*End_Special[^\n]*\n?", re.M | re.S)
_DIMENSIONS: Final = {"Time": "s", "Frequency": "Hz", "": "s"}
"""Units of what these files call the dimension of their times."""
LONGEST_HEAD: Final = 10_000
"""Characters at the top in which the first header ends."""
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
    return head.startswith(_BEGIN) and _END in head


def read_labview(text: str) -> Table:
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
    kept = [one for one in segments if [*one.names] == [*segments[0].names]]
    parts = [_channels(one, separator, decimal) for one in kept]
    tables = [data for data, _ in parts]
    remarks, lost = [], (*_cut(kept),)
    if len(kept) < len(segments):
        other = dict.fromkeys(n for one in segments if one not in kept for n in one.names if n)
        remarks.append(
            f"{count(len(segments) - len(kept), 'segment')} of {len(segments)} have other channels"
            f" ({joined([*map(shown, [*other][:8])])}) than the first, and are not read."
        )
    if len(tables) == 1:
        line = kept[0].line if parts[0][1] else 1  # merged rows are not those of the file
        return Table(data=tables[0], first_row=line, remarks=(*remarks,), lost=lost)
    trials = [*_trials(tables)]
    if trials[-1] > 1:
        remarks.append(f"Times begin again in later segments: {trials[-1]} trials.")
        tables = [one.assign(**{TRIAL: n}) for one, n in zip(tables, trials, strict=True)]
    return Table(data=pd.concat(tables, ignore_index=True), remarks=(*remarks,), lost=lost)


def _segments(lines: Sequence[str], separator: str) -> Iterator[_Segment]:
    """Yield the segments: each begins with the number of its channels and ends before the next."""
    begins = [i for i, line in enumerate(lines) if line.startswith(f"Channels{separator}")]
    if not begins:  # a table below the header of the file
        begins = [next(i for i, line in enumerate(lines) if line.startswith(_END))]
    for begin, end in zip(begins, [*begins[1:], len(lines)], strict=True):
        head: dict[str, Sequence[str]] = {}
        for place in range(begin, end):
            cells = cells_of(lines[place], separator)
            if lines[place].startswith(_END):
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
    rows = rows_of(segment.rows, separator, decimal, width)
    own = [place for place, name in enumerate(names) if name not in (TIMES, "Comment", "")]
    units = _told(segment.head, "Y_Unit_Label")
    headers = numbered_twice([names[place] for place in own])
    headers = [
        f"{n}{_bracketed(u)}" for n, u in zip(headers, _padded(units, len(own)), strict=True)
    ]
    dimension = next((cell for cell in segment.head.get("X_Dimension", []) if cell), "")
    unit = next((cell for cell in segment.head.get("X_Unit_Label", []) if cell), "")
    times = f"{TIMES}{_bracketed(unit or _DIMENSIONS.get(dimension, ''))}"
    columns = [place for place, name in enumerate(names) if name == TIMES]
    columns = [place for place in columns if rows[place].notna().any()]
    if len(columns) < 2:
        found = rows[own].set_axis(headers, axis=1)
        if columns:
            found.insert(0, times, times_in(rows[columns[0]].dropna(), TIMES))
        else:
            found.insert(0, times, _counted(segment, len(rows), decimal))
        return found, True
    tables = []
    for place, header in zip(own, headers, strict=True):
        before = max(column for column in columns if column < place)
        part = rows[[before, place]].set_axis([times, header], axis=1)
        part = part[part[times].notna()]
        tables.append(part.assign(**{times: times_in(part[times], header)}).set_index(times))
    return merged(tables)


def _counted(segment: _Segment, rows: int, decimal: str) -> Array:
    """Return the times of rows that have none, from those that the header states."""
    found = []
    for tag in ("X0", "Delta_X"):
        cells = [cell.replace(decimal, ".") for cell in _told(segment.head, tag)]
        if len(set(cells)) != 1:
            raise InputError(
                f"has no times, and {tag} of its header is {joined([*dict.fromkeys(cells)])}: save"
                " the channels with their times (X_Columns One or Multi)."
            )
        try:
            found.append(float(cells[0]))
        except ValueError:
            raise InputError(f"has {tag} {shown(cells[0])} in its header, no number.") from None
    return found[0] + found[1] * np.arange(rows, dtype=float)


def _bracketed(label: str) -> str:
    unit = unit_in(label)
    return f" [{unit}]" if unit and is_unit(unit) else ""


def _padded(cells: Sequence[str], width: int) -> list[str]:
    return [*cells, *[""] * width][:width]


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
