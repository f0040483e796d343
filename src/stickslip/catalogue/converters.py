"""Converts upstream files to tidy tables."""

import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from stickslip.catalogue.download import fresh
from stickslip.catalogue.schema import Column, DataFile
from stickslip.errors import InputError


def convert(
    raw: Path, target: Path, *, form: str, columns: Sequence[Column], file: DataFile
) -> None:
    """Write the table of an upstream file; it is there whole or not at all."""
    import pandas as pd

    try:
        series = _READERS[form](raw)
        table = pd.DataFrame({column.name: _taken(series, column) for column in columns})
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{raw}: cannot be read as {form}: {str(error).rstrip('.')}. Its checksum is correct,"
            " so the catalogue entry is wrong: please report this."
        ) from None
    if file.part:
        table = table.iloc[: file.rows]
    if file.rows is not None and len(table) != file.rows:
        warnings.warn(
            f"{raw.name} gives a table of {len(table)} rows, but the catalogue lists {file.rows}:"
            f" results for {file.name} may differ from published ones.",
            stacklevel=2,
        )
    with fresh(target) as temporary:
        table.to_parquet(temporary, index=False, compression="zstd")


def _taken(series: Mapping[str, Any], column: Column) -> Any:
    if column.source not in series:
        raise ValueError(f"{column.source!r} is missing; the file contains {', '.join(series)}")
    # One product, and none where nothing is to be scaled, keeps bits and precision as they were.
    values = series[column.source]
    return values if column.factor == 1.0 else values * column.factor


def _matlab(path: Path) -> dict[str, Any]:
    from scipy.io import loadmat

    try:
        found = loadmat(path)
    except Exception as error:  # of any kind: the reader trusts the file
        raise ValueError(f"{type(error).__name__}: {error}") from None
    return {name: found[name].ravel() for name in found if not name.startswith("__")}


def _text(path: Path) -> dict[str, Any]:
    import numpy as np

    table = np.loadtxt(path, delimiter="\t", skiprows=1, ndmin=2)
    return {str(number): column for number, column in enumerate(table.T, 1)}


_READERS = {"mat": _matlab, "tsv": _text}
