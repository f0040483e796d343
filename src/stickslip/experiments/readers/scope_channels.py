"""Exports of TwinCAT Scope: channels side by side, each with times of its own."""

import io
import warnings
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np
import pandas as pd

from stickslip.errors import InputError
from stickslip.experiments.readers.layout import cells_of, is_number
from stickslip.experiments.readers.table import unequal_rows
from stickslip.formatting import count
from stickslip.units import is_unit, shown

SCOPE: Final = "channels of TwinCAT Scope"
"""What such a file is, for messages."""
LONGEST_HEAD: Final = 10_000
"""Characters at the top among which its mark is sought."""
_MARK: Final = "starttime of export"
TIME: Final = "time [ms]"


def is_scope(text: str) -> bool:
    r"""Whether a text is an export of TwinCAT Scope.

    Examples
    --------
    >>> is_scope("Name;Scope\nFile;a.csv\nStarttime of export;1337\n"), is_scope("t;x\n0;1\n")
    (True, False)
    """
    head = text[:LONGEST_HEAD].lstrip("\ufeff").lower()
    return head.startswith("name") and any(line.startswith(_MARK) for line in head.splitlines())


def read_scope(text: str) -> tuple[pd.DataFrame, int]:
    r"""Return the channels of an export as one table, and the line of its first row.

    Above the rows stand pairs of a key and its value, a pair for each channel. A row has a time in
    milliseconds, or the number of a sample, and a value for each channel. Channels with other times
    than the first are merged with it, and cells are then empty.

    Examples
    --------
    >>> head = "Name;P\nStarttime of export;13\n\nName;Pos;Name;Torque\nSampleTime[ms];2;;2\n"
    >>> table, line = read_scope(head + "Unit;mm;Unit;N\n\n0;0,5;0;1\n2;0,75;2;1,5\n")
    >>> table.to_dict("list"), line
    ({'time [ms]': [0.0, 2.0], 'Pos [mm]': [0.5, 0.75], 'Torque [N]': [1.0, 1.5]}, 8)
    """
    lines = text.lstrip("\ufeff").splitlines()
    separator = next((mark for mark in "\t;" if mark in lines[0]), ",")
    begins = next(index for index, line in enumerate(lines) if line.lower().startswith(_MARK))
    head: dict[str, list[str]] = {}
    found: list[str] = []
    first = begins
    for line in lines[begins:]:
        found = cells_of(line, separator)
        if any(found) and is_number(found[0]):
            break
        if any(found):
            head[found[0].casefold()] = found[1::2]
        first += 1
    else:
        raise InputError(f"has no rows of {SCOPE}.")
    names = head.get("name", [])
    if len(found) < 2 * len(names) or not names:
        raise InputError(
            f"has {count(len(names), 'name')} and rows of {len(found)} cells: {SCOPE}"
            " have a time and a value each."
        )
    decimal = "," if separator != "," and any("," in line for line in lines[first:]) else "."
    rows = _parsed(lines[first:], separator, decimal, len(found))
    tables = [_channel(rows, head, place) for place in range(len(names))]
    if all(table.index.equals(tables[0].index) for table in tables):
        return pd.concat(tables, axis=1).reset_index(), first + 1
    return pd.concat(
        [one[~one.index.duplicated()] for one in tables], axis=1
    ).sort_index().reset_index(), 1


def _parsed(lines: Sequence[str], separator: str, decimal: str, width: int) -> pd.DataFrame:
    """Return rows of cells, by the numbers of their columns."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            return pd.read_csv(
                io.StringIO("\n".join(lines)),
                sep=separator,
                decimal=decimal,
                header=None,
                names=list(range(width)),
                index_col=False,
                low_memory=False,
            )
    except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError) as error:
        raise unequal_rows(error) from None


def _channel(rows: pd.DataFrame, head: Mapping[str, Sequence[str]], place: int) -> pd.DataFrame:
    """Return the values of a channel by its times [ms]."""
    own = {key: values[place] for key, values in head.items() if place < len(values)}
    unit = own.get("unit", "").strip("()[]")
    name = f"{own['name']} [{unit}]" if unit and is_unit(unit) else own["name"]
    part = rows[[2 * place, 2 * place + 1]].set_axis([TIME, name], axis=1)
    part = part[part[TIME].notna()]
    times = pd.to_numeric(part[TIME], errors="coerce").astype(float)
    if times.isna().any():
        wrong = part[TIME][times.isna()].iloc[0]
        raise InputError(f"{shown(wrong)} is not a time of the channel {shown(own['name'])}.")
    period = pd.to_numeric(own.get("sampletime[ms]", ""), errors="coerce")
    steps = np.diff(times.to_numpy())
    counted = np.isfinite(period) and steps.size > 0 and np.median(steps) == 1.0
    return part.assign(**{TIME: times * float(period) if counted else times}).set_index(TIME)
