"""What results have in common: a plot, and a short page in notebooks.

Plots stand above results in the order of imports, so this module asks for `stickslip.show.plots` by
name, when a plot is drawn. Nothing is imported before.
"""

import html
import importlib
import math
import re
import warnings
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, TypeAlias, TypeVar, cast, final

import numpy as np

from stickslip.errors import InputError
from stickslip.show.described import Described

if TYPE_CHECKING:
    from types import ModuleType

    import pandas as pd
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure
    from numpy.typing import NDArray

    Drawing: TypeAlias = Axes
    Target: TypeAlias = Axes | Figure | SubFigure | Sequence[Axes] | NDArray[np.object_] | None
    import xarray as xr


Drawn_co = TypeVar("Drawn_co", covariant=True)
"""What a plot of a result is: Axes, or an array of them."""

MOST_ROWS = 12
"""Rows of a table in a notebook at most."""


@dataclass(frozen=True, kw_only=True)
class Summary:
    """A result in short, as a notebook shows it."""

    sentence: str = ""
    """Status or verdict."""
    head: Sequence[str] = ()
    """Names of the columns; none where the first column names the rows."""
    rows: Sequence[Sequence[object]] = ()
    """Texts and numbers."""
    notes: Sequence[str] = ()
    """Sentences below the table."""


class Displayed(ABC, Generic[Drawn_co], metaclass=Described):
    """A result that draws itself, and that a notebook shows in short."""

    @abstractmethod
    def _summary(self) -> Summary:
        """Return status or verdict, and a small table."""

    @final
    def in_short(self) -> Summary:
        """Return status or verdict and a small table: what notebook, terminal and page show."""
        return self._summary()

    @final
    def plot(self, ax: "Target" = None) -> Drawn_co:
        """Draw the result as `stickslip.show.plots.plot` does.

        Parameters
        ----------
        ax : matplotlib Axes, sequence of Axes, or (Sub)Figure, optional
            Where to draw; a sequence for a plot of several panels. A new figure if not given.

        Returns
        -------
        matplotlib Axes or array of Axes
            The panels. The functions of `stickslip.show.plots` for one kind of result have options.

        Raises
        ------
        InputError
            If `ax` is nothing of the kind, or has another number of panels; or if the class of the
            result has no plot.
        """
        return self._plot(ax)

    def _plot(self, ax: "Target") -> Drawn_co:
        """Draw the result; what the class of a result replaces that has a plot of its own."""
        return cast("Drawn_co", plots().plot(self, ax))

    def __str__(self) -> str:
        """Return status or verdict and the table in short, as notebooks show them."""
        try:
            return text_of(self._summary())
        except Exception:  # a debugger shows results that are only half made, too
            return object.__repr__(self)

    def __repr__(self) -> str:
        return f"<{type(self).__name__}: {self}>".replace("\n", "\n ")

    @final
    def _repr_html_(self) -> str:
        return html_of(self._summary, self)


class OnAxes(Displayed["Axes"], ABC):
    """A result whose plot has one panel."""


class InPanels(Displayed["NDArray[np.object_]"], ABC):
    """A result whose plot has several panels."""


def text_of(summary: Summary) -> str:
    """Return a summary as lines of text.

    Examples
    --------
    >>> print(text_of(Summary(sentence="Done.", rows=[("runs", 3), ("time", "0 to 1 s")])))
    Done.
    runs: 3
    time: 0 to 1 s
    """
    rows = [[cell_text(value) for value in row] for row in summary.rows[:MOST_ROWS]]
    lines = [": ".join([row[0].rstrip("."), *row[1:]]) for row in rows]
    if summary.head:
        table = [[*map(str, summary.head)], *rows]
        widths = [max(map(len, column)) for column in zip(*table, strict=True)]
        lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in table]
    left = len(summary.rows) - len(rows)
    more = [f"{left} more rows."] if left > 0 else []
    return "\n".join([*filter(None, [summary.sentence]), *lines, *more, *summary.notes])


def html_of(summary: Any, result: object) -> str:
    """Return a summary and a small figure of a result; never raises.

    Examples
    --------
    >>> html_of(lambda: Summary(rows=[("runs", 3)]), "no result")
    '<table><tr><th>runs</th><td>3</td></tr></table>'
    """
    try:
        page = _page(summary())
    except Exception:  # a notebook shows a result, whatever is wrong with it
        return f"<pre>{html.escape(_text(result))}</pre>"
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return page + str(plots().thumbnail(result))
    except Exception:  # what cannot be drawn is told by the table
        return page


def paragraphs(lines: Iterable[str]) -> str:
    """Return lines as paragraphs of a page.

    Examples
    --------
    >>> paragraphs(["a < b"])
    '<p>a &lt; b</p>'
    """
    return "".join(f"<p>{html.escape(line)}</p>" for line in lines)


def summary_of_table(sentence: str, table: "pd.DataFrame", notes: Sequence[str] = ()) -> Summary:
    """Return the summary of a result that has a table."""
    rows = table.itertuples(index=False, name=None)
    return Summary(sentence=sentence, head=[*map(str, table.columns)], rows=[*rows], notes=notes)


def require_library(name: str, extra: str, otherwise: str = "") -> "ModuleType":
    """Return a library that not all users have installed.

    Examples
    --------
    >>> require_library("nonsense", "xarray", "use to_dataframe")
    Traceback (most recent call last):
    ...
    stickslip.errors.InputError: nonsense is not installed: pip install 'stickslip[xarray]', or
    use to_dataframe.
    """
    try:
        return importlib.import_module(name)
    except ImportError:
        other = f", or {otherwise}" if otherwise else ""
        raise InputError(
            f"{name.partition('.')[0]} is not installed: pip install 'stickslip[{extra}]'{other}."
        ) from None


def plots() -> Any:
    """Return `stickslip.show.plots`, imported when a result is drawn: it stands above results."""
    return importlib.import_module("stickslip.show.plots")


def _page(summary: Summary) -> str:
    rows = [f"<tr>{_cells(row, named=not summary.head)}</tr>" for row in summary.rows[:MOST_ROWS]]
    head = "".join(f"<th>{html.escape(name)}</th>" for name in summary.head)
    head = f"<tr>{head}</tr>" if head else ""
    left = len(summary.rows) - len(rows)
    notes = [*([f"{left} more rows."] if left > 0 else []), *summary.notes]
    table = f"<table>{head}{''.join(rows)}</table>" if rows else ""
    return paragraphs([summary.sentence] if summary.sentence else []) + table + paragraphs(notes)


def _cells(row: Sequence[object], *, named: bool) -> str:
    tags = ["th" if named and place == 0 else "td" for place in range(len(row))]
    cells = zip(tags, map(cell_text, row), strict=True)
    return "".join(f"<{tag}>{html.escape(text)}</{tag}>" for tag, text in cells)


def cell_text(value: object) -> str:
    """Return what a cell of a table shows: numbers with four digits, a dash of what is not known.

    Examples
    --------
    >>> cell_text(0.123456), cell_text(None), cell_text("Coulomb")
    ('0.1235', '—', 'Coulomb')
    """
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "—"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def is_numeric(text: str) -> bool:
    """Return whether a cell holds a number, or says that there is none.

    Examples
    --------
    >>> is_numeric("−0.2 mm"), is_numeric("—"), is_numeric("Coulomb")
    (True, True, False)
    """
    return text in ("", "—") or text[0].isdigit() or text[0] in "-−.+"


def _text(result: object) -> str:
    try:
        return repr(result)
    except Exception:
        return object.__repr__(result)


# Results as tables: a pandas DataFrame, and an xarray Dataset made of it, with units.

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
    result = {name: (dimension, values, own) for name, (values, own) in columns.items()}
    axis = result.pop(dimension, (dimension, np.arange(len(table)), {}))
    return xr.Dataset(result, {dimension: axis})


def _saved(values: "pd.Series[Any]") -> Any:
    """Return a column as an array of one type."""
    if values.dtype.kind in "biufM":
        return values.to_numpy()
    missing = values.isna()
    if all(isinstance(value, int | float | np.number) for value in values[~missing]):
        return values.astype(float).to_numpy()
    return values.astype(object).where(~missing, "").astype(str).to_numpy(dtype=str)
