"""Parquet files."""

from collections.abc import Collection
from pathlib import Path
from typing import Any, Final

import pandas as pd

from stickslip.errors import InputError, check_columns, check_size
from stickslip.experiments.readers.table import Table

PARQUET: Final = (".parquet", ".pq")


def read_parquet(path: Path, _names: Collection[str] = ()) -> Table:
    """Return the columns of a file."""
    return Table(data=parquet_data(path))


def parquet_data(path: Path) -> pd.DataFrame:
    """Return the columns of a file, whatever they hold."""
    import pyarrow.parquet as pq

    try:
        with pq.ParquetFile(path) as file:
            check_parquet(str(path), file)
            # Texts stay references to the few that differ: each is written once and repeated.
            texts = [field.name for field in file.schema_arrow if _is_text(field.type)]
        data = pd.read_parquet(path, engine="pyarrow", read_dictionary=texts)
        repeated = [name for name in texts if isinstance(data.get(name), pd.Series)]
        data = data.astype(dict.fromkeys(repeated, object))
        return data.reset_index(drop=True)
    except InputError:
        raise
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}.") from None
    except Exception as error:
        # pyarrow has an exception tree of its own.
        raise InputError(f"{path}: is not a Parquet file: {error}.") from None


def check_parquet(path: str, file: Any, names: Collection[str] = ()) -> float:
    """Refuse a file whose footer announces too much, in all columns or those of some names.

    A cell may hold lists of any length, and pages that repeat a number take no room in the file.
    Returns how many numbers it announces.
    """
    footer = file.metadata
    check_columns(path, footer.num_columns)
    size, rows = 0.0, 0
    for i in range(footer.num_row_groups):
        group = footer.row_group(i)
        rows += group.num_rows
        for k in range(group.num_columns):
            column = group.column(k)
            flat = file.schema.column(k).max_repetition_level == 0
            if flat and column.num_values != group.num_rows:
                raise _contradicted(path, group.num_rows, column.num_values)
            name = column.path_in_schema  # of lists, and names may have dots: name.list.element
            if not names or any(f"{name}.".startswith(f"{one}.") for one in names):
                size += max(column.num_values, column.total_uncompressed_size / 8)
    if rows != footer.num_rows:
        raise _contradicted(path, footer.num_rows, rows)
    width = len(names) or footer.num_columns
    size = max(size, float(footer.num_rows * width))
    check_size(path, size, "split the file")
    return size


def _contradicted(path: str, rows: int, values: int) -> InputError:
    return InputError(
        f"{path}: is damaged: its footer announces {rows:,} rows, and {values:,} in their place."
    )


def _is_text(kind: Any) -> bool:
    from pyarrow import types

    return bool(types.is_string(kind) or types.is_large_string(kind))
