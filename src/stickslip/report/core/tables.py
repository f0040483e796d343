"""Tables that become cards on a phone."""

from dataclasses import dataclass
from itertools import pairwise
from typing import ClassVar, Final, Literal, TypeAlias, final

from stickslip.errors import InputError
from stickslip.formatting import fixed
from stickslip.report.core import markup
from stickslip.report.core.sparklines import Axis, RowPlot

_MANY_ROWS: Final = 12


@final
@dataclass(frozen=True, kw_only=True)
class Number:
    """A cell with a number, its doubt and its unit, each set in its own weight.

    Parameters
    ----------
    value : str
        The number, formatted.
    doubt : str
        Such as "± 4".
    unit : str
        Only where the rows of a column differ; else it stands in the head. A pure number, ``"1"``,
        has none.

    Examples
    --------
    >>> Number(value="158", doubt="± 4", unit="N s/m").value
    '158'
    """

    value: str
    doubt: str = ""
    unit: str = ""


@final
@dataclass(frozen=True, kw_only=True)
class Name:
    """A cell with a name and, below it in small print, what distinguishes it.

    Parameters
    ----------
    text : str
        The name.
    aside : str
        Such as "the usual choice".

    Examples
    --------
    >>> Name(text="Coulomb", aside="no offset").aside
    'no offset'
    """

    text: str
    aside: str = ""


@final
@dataclass(frozen=True, kw_only=True)
class Blank:
    """A cell to write into by hand.

    Parameters
    ----------
    what : str
        What is written there, for who cannot see the line.

    Examples
    --------
    >>> Blank(what="travel").what
    'travel'
    """

    what: str


Cell: TypeAlias = str | Number | Name | Blank | RowPlot
"""What a cell may hold; plain text has the markup of `stickslip.report.core.markup.inline`."""


@final
@dataclass(frozen=True, kw_only=True)
class Column:
    r"""A column of a table.

    Parameters
    ----------
    head : str
        Quantity and unit; a line break separates the two.
    numeric : bool
        Whether its cells are aligned to the right.
    phone : {"show", "hide", "label"}
        What happens on a phone, where a row is a card: shown as it is, left out, or shown with
        a label.
    label : str
        That label; the head if left out.
    axis : Axis, optional
        The axis of its row plots.

    Examples
    --------
    >>> Column(head="travel\nm", numeric=True).phone
    'show'
    """

    head: str
    numeric: bool = False
    phone: Literal["show", "hide", "label"] = "show"
    label: str = ""
    axis: Axis | None = None

    @property
    def phone_label(self) -> str:
        """The label on a phone, or nothing."""
        text = self.label or self.head.replace("\n", ", ")
        return markup.plain(text) if self.phone == "label" else ""


@final
@dataclass(frozen=True, kw_only=True)
class Row:
    """A row of a table.

    Parameters
    ----------
    cells : tuple of str, Number, Name, Blank or RowPlot
        One for each column.
    chosen : bool
        Whether it is the model that the page recommends.
    muted : bool
        Whether it was dropped.

    Examples
    --------
    >>> Row(cells=("Coulomb", "0.204"), chosen=True).muted
    False
    """

    cells: tuple[Cell, ...]
    chosen: bool = False
    muted: bool = False


@final
@dataclass(frozen=True, kw_only=True)
class Table:
    r"""A table.

    Parameters
    ----------
    columns : tuple of Column
        The first names the rows.
    rows : tuple of Row
        At least one.
    caption : str
        What the marks are and what to see.

    Raises
    ------
    InputError
        If a row has too many or too few cells, a cell is empty, or a plot has no axis.

    Examples
    --------
    >>> columns = (Column(head="model"), Column(head="travel\nm", numeric=True))
    >>> Table(columns=columns, rows=(Row(cells=("Coulomb", "0.204")),)).is_long
    False
    """

    template: ClassVar[str] = "table"
    columns: tuple[Column, ...]
    rows: tuple[Row, ...]
    caption: str = ""

    def __post_init__(self) -> None:
        if not self.rows:
            raise InputError("Table: no rows; leave the section out or say why in words.")
        for row in self.rows:
            if len(row.cells) != len(self.columns):
                raise InputError(f"Table: {len(self.columns)} columns but the row {row.cells}.")
            for column, cell in zip(self.columns, row.cells, strict=True):
                _check(column, cell)

    @property
    def is_long(self) -> bool:
        """Whether it may be broken over two printed pages."""
        return len(self.rows) > _MANY_ROWS

    @property
    def phone_plots(self) -> tuple[Column, ...]:
        """The columns whose axis stands above the table on a phone, where the head is hidden."""
        return tuple(column for column in self.columns if column.axis and column.phone != "hide")

    def css(self, index: int) -> str:
        """Return the CSS classes of the cells of a column."""
        column = self.columns[index]
        is_plot = any(isinstance(row.cells[index], RowPlot) for row in self.rows)
        classes = {
            "n": column.numeric,
            "plot": is_plot,
            "full": index > 0 and (is_plot or not column.numeric),
            "hide": column.phone == "hide",
        }
        return " ".join(name for name, holds in classes.items() if holds)


@final
@dataclass(frozen=True, kw_only=True)
class Correlations:
    """The triangle of correlations between estimates.

    Parameters
    ----------
    names : tuple of str
        The parameters, at least two.
    values : tuple of tuple of float
        Below the diagonal: the row of the second parameter has one number, the next two, ...
    caption : str
        What trades off against what, in words.

    Raises
    ------
    InputError
        If the rows do not form a triangle of numbers from -1 to 1.

    Examples
    --------
    >>> Correlations(names=("$F_c$", "$F_v$"), values=((-0.98,),)).shade(-0.98)
    ('c2', 41)
    """

    template: ClassVar[str] = "correlations"
    names: tuple[str, ...]
    values: tuple[tuple[float, ...], ...]
    caption: str = ""

    def __post_init__(self) -> None:
        lengths = [0, *(len(row) for row in self.values)]
        is_triangle = all(b - a == 1 for a, b in pairwise(lengths))
        if len(self.names) < 2 or len(lengths) != len(self.names) or not is_triangle:
            raise InputError(
                f"Correlations: not a triangle for {len(self.names)} names: {lengths}."
            )
        if not all(-1 <= value <= 1 for row in self.values for value in row):
            raise InputError(f"Correlations: numbers must be from -1 to 1, got {self.values}.")

    def shade(self, value: float) -> tuple[str, int]:
        """Return the colour of a correlation and how much of it, in percent."""
        return ("c2" if value < 0 else "c1"), round(42 * abs(value))

    def text(self, value: float) -> str:
        """Return a correlation with two decimals and its sign."""
        return ("+" if value >= 0.005 else "") + fixed(value, 2)


def _check(column: Column, cell: Cell) -> None:
    if isinstance(cell, RowPlot):
        if cell.axis is None and column.axis is None:
            raise InputError(f"Table: the plots of column {column.head!r} have no axis.")
        return
    if isinstance(cell, Number | Blank):
        text = cell.value if isinstance(cell, Number) else cell.what
    else:
        text = cell.text if isinstance(cell, Name) else cell
    if not text.strip():
        raise InputError(
            f"Table: an empty cell in column {column.head!r}; say in words what is not known."
        )
