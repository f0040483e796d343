"""Parquet files."""

from collections.abc import Collection
from pathlib import Path
from typing import Any, Final

import pandas as pd

from stickslip.errors import InputError, check_size
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
            _check_parquet(str(path), file)
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


def _check_parquet(path: str, file: Any) -> None:
    """Refuse a file whose footer announces too much, lists within cells included."""
    footer = file.metadata
    size = 0.0
    for i in range(footer.num_row_groups):
        group = footer.row_group(i)
        for k in range(group.num_columns):
            column = group.column(k)
            size += max(column.num_values, column.total_uncompressed_size / 8)
    check_size(path, max(size, footer.num_rows * footer.num_columns), "split the file")


def _is_text(kind: Any) -> bool:
    from pyarrow import types

    return bool(types.is_string(kind) or types.is_large_string(kind))
