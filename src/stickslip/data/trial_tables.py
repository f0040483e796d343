"""Tables of trials: one row a trial."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pandas as pd

from stickslip.data.measurement import QUANTITIES, TRAVELS, Measurement
from stickslip.data.readers.table_reader import QuantityTable, condition_cells, condition_keys
from stickslip.data.rig import check_record, state_units
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.mechanisms import PREFIX, Mechanism, canonical_path, quantity_at

WORDS = ("name", "provenance", "uncertainty_kind")
NUMBERS = (*TRAVELS, "uncertainty")


def read_trials(
    frame: QuantityTable,
    common: Mapping[str, Any],
    name: str,
    mechanism: Mechanism | None,
    conditions: Sequence[str] = (),
) -> Measurement:
    """Return the trials of a table; what a row does not say is taken from `common`."""
    keys = condition_keys(frame, conditions)
    named = {key: condition_cells(frame, column) for key, column in keys.items()}
    columns = {
        column: _values(frame, column, mechanism)
        for column in frame.names
        if column not in keys.values()
    }
    records = []
    for row in range(len(frame.data)):
        cells = {column: values[row] for column, values in columns.items()}
        own = {key: values[row] for key, values in named.items() if values[row] is not None}
        records.append(_trial(frame, row, cells, {**common, "conditions": own}, mechanism))
    return records[0] if len(records) == 1 else Measurement(trials=tuple(records), name=name)


def travelled(frame: QuantityTable) -> str:
    """Return the column that says how far the body came; empty if the table is of no trials."""
    return "" if "time" in frame.names else next((n for n in TRAVELS if n in frame.names), "")


def _values(frame: QuantityTable, column: str, mechanism: Mechanism | None) -> list[Any]:
    """Return the cells of a column: words, or numbers in SI."""
    if column in WORDS:
        cells = frame.data[frame.names[column]]
        return ["" if pd.isna(cell) else str(cell) for cell in cells]
    if column in NUMBERS:
        unit = QUANTITIES[travelled(frame) if column == "uncertainty" else column].unit
        return list(map(float, frame.numbers(column, unit)))
    first, _, rest = column.partition(".")
    if first == "initial" and rest:
        units = {} if mechanism is None else state_units(mechanism)
        if mechanism is not None and rest not in units:
            raise UnknownNameError(f"state in column of {frame.file}:", rest, units)
        return list(map(float, frame.numbers(column, units.get(rest))))
    if mechanism is not None:
        unit = quantity_at(mechanism, _path(frame, column, mechanism)).unit
        return list(map(float, frame.numbers(column, unit)))
    if first == PREFIX and rest:
        return list(map(float, frame.numbers(column, None)))
    known = (*NUMBERS, *WORDS, "initial.x", "mechanism.mass")
    raise UnknownNameError(f"column of {frame.file}:", column, known)


def _path(frame: QuantityTable, column: str, mechanism: Mechanism) -> str:
    try:
        return canonical_path(mechanism, column)
    except UnknownNameError as error:
        cure = f' If it is a condition of the trials, give conditions="{column}".'
        said = str(error) if "Did you mean" in str(error) else f"{error}{cure}"
        raise InputError(f"{frame.file}: column {column!r}: {said}") from None


def _overrides(
    frame: QuantityTable, cells: Mapping[str, Any], mechanism: Mechanism | None
) -> Iterator[tuple[str, float]]:
    for column, value in cells.items():
        if column in NUMBERS or column in WORDS or column.startswith("initial."):
            continue
        yield column if mechanism is None else _path(frame, column, mechanism), value


def _trial(
    frame: QuantityTable,
    row: int,
    cells: Mapping[str, Any],
    common: Mapping[str, Any],
    mechanism: Mechanism | None,
) -> Measurement:
    parts = dict(common)
    parts["overrides"] = {**common["overrides"], **dict(_overrides(frame, cells, mechanism))}
    starts = {key.partition(".")[2]: value for key, value in cells.items() if "initial." in key}
    parts["initial"] = {**common["initial"], **starts}
    parts["provenance"] = f"{Path(frame.file).name}, {frame.line(row)}"
    given = {key: cells[key] for key in (*NUMBERS, *WORDS) if key in cells and cells[key] != ""}
    label = frame.place(travelled(frame), row)
    try:
        record = Measurement(**{**parts, **given})
        if mechanism is not None:
            check_record(mechanism, record, label)
    except ParameterError as error:
        text = str(error)
        raise ParameterError(text if text.startswith(label) else f"{label}: {text}") from None
    except UnknownNameError:
        raise
    except InputError as error:
        raise InputError(f"{label}: {error}") from None
    return record
