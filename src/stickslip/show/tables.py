"""Results as tables: a pandas DataFrame, and an xarray Dataset made of it, with units."""

import re
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, final

import numpy as np

from stickslip.show.described import Described
from stickslip.show.display import require_library

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

BRACKETED = re.compile(r"(?P<name>.*\S)\s*\[(?P<unit>[^\[\]]*)\]")


class Tabular(ABC, metaclass=Described):
    """A result that has rows and columns."""

    @abstractmethod
    def to_dataframe(self) -> "pd.DataFrame":
        """Return the result as a pandas DataFrame."""

    @final
    def to_xarray(self) -> "xr.Dataset":
        """Return the same as an xarray Dataset, with units as far as columns have one.

        Its dimension is the column that numbers or names the rows, such as the time, or ``"row"``
        where there is none. Units stand in the attribute ``units`` of each variable.

        Raises
        ------
        InputError
            If xarray is not installed.
        """
        return dataset_of(self.to_dataframe(), over=self._over(), units=self._column_units())

    def _over(self) -> str:
        """Return the column along which the rows stand; empty if they are numbered only."""
        return ""

    def _column_units(self) -> Mapping[str, str]:
        """Return the SI unit of each column that has one in all rows."""
        return {}


def dataset_of(
    table: "pd.DataFrame", *, over: str = "", units: Mapping[str, str] | None = None
) -> "xr.Dataset":
    """Return a table as an xarray Dataset that can be saved.

    Texts that are missing are empty, and numbers that are missing are NaN.

    Examples
    --------
    >>> import pandas as pd
    >>> data = dataset_of(
    ...     pd.DataFrame({"time [s]": [0.0, 0.1], "force [N]": [2.0, 3.0]}), over="time"
    ... )
    >>> list(data.dims), data["force"].units, data["force"].sel(time=0.1).item()
    (['time'], 'N', 3.0)
    """
    require_library("xarray", "xarray", "use to_dataframe")
    import xarray as xr

    columns: dict[str, tuple[Any, dict[str, str]]] = {}
    known = dict(units or {})
    for label, values in table.items():
        parsed = BRACKETED.fullmatch(str(label))
        name = parsed["name"] if parsed else str(label)
        unit = parsed["unit"] if parsed else known.get(name, "")
        # of two columns that differ by their unit alone, the second keeps it in its name
        kept = str(label) if name in columns else name
        columns[kept] = (_saved(values), {"units": unit} if unit else {})
    numbers = columns.get(over)
    dimension = over
    if numbers is None or len(np.unique(numbers[0])) < len(table):
        dimension = "row"
    found = {name: (dimension, values, own) for name, (values, own) in columns.items()}
    axis = found.pop(dimension, (dimension, np.arange(len(table)), {}))
    return xr.Dataset(found, {dimension: axis})


def _saved(values: "pd.Series[Any]") -> Any:
    """Return a column as an array of one type."""
    if values.dtype.kind in "biufM":
        return values.to_numpy()
    missing = values.isna()
    if all(isinstance(one, int | float | np.number) for one in values[~missing]):
        return values.astype(float).to_numpy()
    return values.astype(object).where(~missing, "").astype(str).to_numpy(dtype=str)
