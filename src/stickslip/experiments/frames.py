"""Columns of CSV and Parquet files, by the quantity they hold."""

import csv
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.experiments.toml import check_file, decode
from stickslip.experiments.units import factor, shown

__all__ = ["Frame", "read_frame"]

_HEADER = re.compile(r"\s*(?P<name>[^\[\]]*?)\s*(?:\[(?P<unit>[^\[\]]*)\])?\s*")


@dataclass(frozen=True, kw_only=True)
class Frame:
    """A table whose columns are known by the quantities they hold."""

    file: str
    data: pd.DataFrame
    names: Mapping[str, str]
    """Quantity, parameter path, or the column's own name -> column in the data."""
    units: Mapping[str, str | None]
    """Unit by the same names; None where numbers are in SI."""
    first_row: int
    """Line of the first row in the file, or 1 where there are no lines."""

    def line(self, row: int) -> str:
        """Return where a row stands in the file."""
        kind = "line" if self.first_row > 1 else "row"
        return f"{kind} {self.first_row + int(self.data.index[row])}"

    def place(self, name: str, row: int) -> str:
        """Return where a cell stands, for messages."""
        return f"{self.file}: column {self.names[name]!r}, {self.line(row)}"

    def numbers(self, name: str, target: str | None) -> NDArray[np.float64]:
        """Return a column (n,) as numbers in the target unit, or in SI.

        Raises
        ------
        ParameterError
            If a cell is not a finite number, or the unit is of another kind.
        """
        return self.scaled(name, self.raw(name), target)

    def raw(self, name: str) -> NDArray[np.float64]:
        """Return a column (n,) as the numbers that stand there, all finite."""
        column = self.data[self.names[name]]
        values = pd.to_numeric(column, errors="coerce").to_numpy(dtype=float, na_value=np.nan)
        bad = np.flatnonzero(~np.isfinite(values))
        if _is_other(column):
            bad = np.arange(len(column))
        if bad.size:
            cell = column.iloc[int(bad[0])]
            got = "nothing" if pd.isna(cell) else shown(cell)
            raise ParameterError(
                f"{self.place(name, int(bad[0]))}: must be a finite number, got {got}."
            )
        return values

    def scaled(
        self, name: str, values: NDArray[np.float64], target: str | None
    ) -> NDArray[np.float64]:
        """Convert values of a column from its unit to the target unit, or to SI."""
        unit = self.units.get(name)
        if unit is None:
            return values
        try:
            scale = factor(unit, target)
        except ParameterError as error:
            raise ParameterError(f"{self.file}: column {self.names[name]!r} {error}.") from None
        # Division by a whole number rounds once, so that 35 mm is the float 0.035.
        whole = round(1.0 / scale) if scale < 1.0 else 0
        return values / whole if whole and 1.0 / whole == scale else values * scale


def _is_other(column: "pd.Series[Any]") -> bool:
    """Whether a column holds neither numbers nor text: truth values and dates would convert."""
    kinds = pd.api.types
    if kinds.is_bool_dtype(column.dtype):
        return True
    return not any(
        check(column.dtype)
        for check in (kinds.is_numeric_dtype, kinds.is_string_dtype, kinds.is_object_dtype)
    )


def read_frame(path: str | Path, *, columns: Mapping[str, str], units: Mapping[str, str]) -> Frame:
    """Read a file and find out what its columns hold."""
    check_file(path)
    file, suffix = str(path), Path(path).suffix.lower()
    first_row = 1
    if suffix in {".csv", ".tsv", ".txt"}:
        data, first_row = _csv(Path(path))
    elif suffix in {".parquet", ".pq"}:
        data = _parquet(Path(path))
    else:
        raise InputError(
            f"{file}: must be a .csv, .tsv, .txt or .parquet file, got {suffix or 'no ending'}."
            " Save a spreadsheet as CSV."
        )
    if data.empty:
        raise InputError(f"{file}: has no rows.")
    return _named(file, data, first_row, columns, units)


def _csv(path: Path) -> tuple[pd.DataFrame, int]:
    """Return a CSV table and the line of its first row; lines before the header may be comments."""
    try:
        lines = decode(path.read_bytes(), str(path)).splitlines()
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}.") from None
    start = next((i for i, line in enumerate(lines) if line.strip() and line[0] != "#"), None)
    if start is None:
        raise InputError(f"{path}: has no header.")
    header, sample = lines[start], "\n".join(lines[start + 1 : start + 20])
    separator = max(",;\t", key=header.count)
    comma = separator != "," and re.search(r"\d,\d", sample) is not None
    names = next(csv.reader([header], delimiter=separator))
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise InputError(f"{path}: two columns are called {twice[0]!r}.")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)
            data = pd.read_csv(
                path,
                sep=separator,
                decimal="," if comma else ".",
                skiprows=start,
                index_col=False,
                low_memory=False,
                skip_blank_lines=False,
                encoding="utf-8-sig",
            )
    except (pd.errors.ParserError, pd.errors.ParserWarning, ValueError) as error:
        reason = str(error).strip().splitlines()[0].rstrip(".")
        raise InputError(
            f"{path}: rows and header do not fit ({reason}). Every row needs"
            f" {len(names)} cells, parted by {separator!r}."
        ) from None
    data = data[[column for column, name in zip(data, names, strict=True) if name.strip()]]
    return data.dropna(how="all"), start + 2


def _parquet(path: Path) -> pd.DataFrame:
    try:
        return pd.read_parquet(path).reset_index(drop=True)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}.") from None
    except Exception as error:
        # pyarrow has an exception tree of its own.
        raise InputError(f"{path}: is not a Parquet file: {error}.") from None


def _named(
    file: str,
    data: pd.DataFrame,
    first_row: int,
    columns: Mapping[str, str],
    units: Mapping[str, str],
) -> Frame:
    names: dict[str, str] = {}
    found_units: dict[str, str | None] = {}
    for header in map(str, data.columns):
        match = _HEADER.fullmatch(header)
        name, unit = (match["name"], match["unit"]) if match else (header, None)
        if name in names:
            raise InputError(f"{file}: two columns are called {name!r}.")
        names[name], found_units[name] = header, unit
    data = data.set_axis(list(map(str, data.columns)), axis=1)
    own, own_units = dict(names), dict(found_units)
    # A mapped column is known by its quantity alone, so none is used twice.
    for column in columns.values():
        key = _known_column(file, column, own)
        names.pop(key, None)
        found_units.pop(key, None)
    for quantity, column in columns.items():
        key = _known_column(file, column, own)
        names[quantity], found_units[quantity] = own[key], own_units[key]
    for name, unit in units.items():
        if name not in names:
            raise UnknownNameError(f"column in units of {file}:", name, names)
        found_units[name] = unit
    return Frame(file=file, data=data, names=names, units=found_units, first_row=first_row)


def _known_column(file: str, column: Any, own: Mapping[str, str]) -> str:
    for name, header in own.items():
        if column in (name, header):
            return name
    raise UnknownNameError(f"column of {file}:", str(column), own)
