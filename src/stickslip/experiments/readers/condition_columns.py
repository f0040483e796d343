"""Conditions of trials from the columns of files, and the columns that nothing was read from."""

import re
from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments.readers.table import TRIAL
from stickslip.experiments.readers.table_reader import Frame
from stickslip.formatting import number

KELVINS = ("K", "°C", "degC", "°F", "degF")
"""Units of temperatures."""
STEADY = 0.05
"""Share of its mean within which a number may vary in a trial: the mean is taken."""


def by_trial(frame: Frame) -> Iterator[tuple[str, Frame]]:
    """Yield the rows of each trial with its name, in the order in which they come.

    A table without a column of trials, or with one trial only, is yielded as it is.
    """
    if TRIAL not in frame.names:
        yield "", frame
        return
    cells = frame.data[frame.names[TRIAL]]
    if cells.isna().any():
        row = int(np.flatnonzero(cells.isna())[0])
        raise InputError(
            f"{frame.place(TRIAL, row)}: the trial of this row is missing: fill the cell."
        )
    if cells.nunique() == 1:
        yield "", frame
        return
    for value in cells.unique():
        name = f"{TRIAL} {value:g}" if isinstance(value, float) else f"{TRIAL} {value}"
        yield name, replace(frame, data=frame.data[cells == value])


def condition_keys(frame: Frame, columns: Sequence[str]) -> dict[str, str]:
    """Return the column of each condition, by name, with its unit if the column has one."""
    found = {}
    for name in columns:
        own = next(
            (
                key
                for key, header in frame.names.items()
                if name in (key, header, header.partition("[")[0].strip())
            ),
            None,
        )
        if own is None:
            raise UnknownNameError(f"column in conditions of {frame.file}:", name, frame.names)
        unit = frame.units.get(own)
        found[f"{own} [{unit}]" if unit not in (None, "1") else own] = own
    return found


def condition_cells(frame: Frame, name: str) -> list[float | str | None]:
    """Return the cells of a column as numbers, or as texts if one is none; None where empty."""
    column = frame.data[frame.names[name]]
    numbers = pd.to_numeric(column, errors="coerce")
    if numbers.notna().sum() == column.notna().sum() and column.dtype != bool:
        return [float(cell) if np.isfinite(cell) else None for cell in numbers.astype(float)]
    return [None if pd.isna(cell) else str(cell).strip() or None for cell in column]


def conditions_in(frame: Frame, columns: Sequence[str]) -> dict[str, float | str]:
    """Return the conditions of a record, whose columns have one value each.

    A condition without any value is left out.
    """
    found: dict[str, float | str] = {}
    for key, name in condition_keys(frame, columns).items():
        cells = [cell for cell in condition_cells(frame, name) if cell is not None]
        values = set(cells)
        if not values:
            continue
        known = [cell for cell in cells if isinstance(cell, float)]
        if len(values) == 1:
            found[key] = cells[0]
        elif len(known) == len(cells) and (
            np.ptp(known) <= STEADY * abs(float(np.mean(known)))
            or _is_temperature(name, frame.units.get(name))
        ):
            found[key] = float(np.mean(known))
        else:
            shown = (
                f"from {number(min(known))} to {number(max(known))}"
                if len(known) == len(cells)
                else f"{len(values)} texts"
            )
            raise InputError(
                f"{frame.file}: column {frame.names[name]!r} changes within the trial ({shown}),"
                " but a condition has one value per trial. Split the record, or leave the"
                " condition out."
            )
    return found


def _is_temperature(name: str, unit: str | None) -> bool:
    """Whether a column is one of temperatures, which no experimenter can hold."""
    words = re.split(r"[\W\d_]+", name.casefold())
    named = any(
        w == "temp" or w.startswith("temperatur") or w.endswith("temperatur") for w in words
    )
    return named or unit in KELVINS


def unused_in(frame: Frame, used: Collection[str]) -> dict[str, float | str | None]:
    """Return the columns that nothing was read from, with their value if they have one."""
    found: dict[str, float | str | None] = {}
    for name in frame.names:
        if name in used or not name:
            continue
        column = frame.data[frame.names[name]]
        alike = len(column) > 0 and bool((column == column.iloc[0]).all())
        found[name] = (
            condition_cells(replace(frame, data=frame.data[:1]), name)[0] if alike else None
        )
    return found
