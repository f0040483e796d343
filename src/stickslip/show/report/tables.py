"""Tables that become cards on a phone, with plots one line high in their cells."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Literal, NamedTuple, TypeAlias

from stickslip.errors import InputError
from stickslip.show.display import cell_text, is_numeric
from stickslip.show.formatting import NO_VALUE, number
from stickslip.show.report import markup

# Plots one line high inside a table: placed in percent, so that they stretch with the cell.

Colour: TypeAlias = Literal["c1", "c2", "c3", "c4", "data", "ink", "muted"]
"""A colour by its meaning; the style sheet says which it is in light, dark and print."""

_NEAR_AN_END: Final = 4.0
DIGITS_OF_A_FLOAT: Final = 15
"""Significant digits that every float holds; ticks are never written with more."""
UNSEEN: Final = 0.02
"""Share of the length of an axis by which the number of a tick may be off."""


class Tick(NamedTuple):
    """A tick of an axis, ready to place.

    Parameters
    ----------
    left : str
        Distance from the left end of the axis, as a percentage of its length.
    text : str
        The number.
    side : {"first", "middle", "last"}
        Where along the axis it is, which decides how the number is aligned.
    """

    left: str
    text: str
    side: Literal["first", "middle", "last"]


class Shape(NamedTuple):
    """A piece of a row plot, ready to place.

    Parameters
    ----------
    kind : str
        Kind of mark, or ``"below"`` or ``"above"`` for an arrow at the end of the axis.
    colour : str
        Colour, by its name in the style sheet.
    left : str
        Distance from the left end of the axis, as a percentage of its length.
    right : str
        Distance from the right end, likewise.
    """

    kind: str
    colour: str
    left: str
    right: str


@dataclass(frozen=True, kw_only=True)
class Axis:
    """The horizontal axis that the plots of a column share.

    Parameters
    ----------
    low, high : float
        Its ends, finite.
    ticks : tuple of float
        Where thin lines and numbers stand.
    labels : tuple of str
        The numbers; the ticks themselves if left out.
    reference : float, optional
        Where a strong line stands, such as the measured value.
    caption : str
        Quantity and unit, and what each mark is.

    Raises
    ------
    InputError
        If the ends are not finite and in order, or something lies outside.

    Examples
    --------
    >>> Axis(low=-1.0, high=1.0, ticks=(-1.0, 0.0, 1.0)).position(0.0)
    50.0
    """

    low: float
    high: float
    ticks: tuple[float, ...] = ()
    labels: tuple[str, ...] = ()
    reference: float | None = None
    caption: str = ""

    def __post_init__(self) -> None:
        if not (math.isfinite(self.low) and math.isfinite(self.high) and self.low < self.high):
            raise InputError(f"Axis: low and high must be finite and low < high, got {self}.")
        if self.labels and len(self.labels) != len(self.ticks):
            raise InputError(f"Axis: {len(self.ticks)} ticks but {len(self.labels)} labels.")
        placed = self.ticks if self.reference is None else (*self.ticks, self.reference)
        outside = [value for value in placed if not self.low <= value <= self.high]
        if outside:
            raise InputError(f"Axis: outside {self.low!r} to {self.high!r}: {outside}.")

    def position(self, value: float) -> float:
        """Return where a value stands, in percent of the length of the axis.

        Examples
        --------
        >>> Axis(low=0.0, high=0.5).position(0.2)
        40.0
        """
        return 100 * (value - self.low) / (self.high - self.low)

    def percent(self, value: float) -> str:
        """Return where a value stands, as a CSS length.

        Examples
        --------
        >>> Axis(low=0.0, high=0.5).percent(0.2)
        '40%'
        """
        return _percent(self.position(value))

    def placed_ticks(self) -> tuple[Tick, ...]:
        """Return the ticks with their places; those at the ends must not stick out.

        Examples
        --------
        >>> Axis(low=0.0, high=1.0, ticks=(0.0, 0.5)).placed_ticks()[1]
        Tick(left='50%', text='0.5', side='middle')
        """
        labels = self.labels or _tick_texts(self.ticks)
        out = []
        for tick, text in zip(self.ticks, labels, strict=True):
            at = self.position(tick)
            is_first, is_last = at < _NEAR_AN_END, at > 100 - _NEAR_AN_END
            out.append(
                Tick(_percent(at), text, "first" if is_first else "last" if is_last else "middle")
            )
        return tuple(out)


@dataclass(frozen=True, kw_only=True)
class Mark:
    """One mark of a row plot.

    Parameters
    ----------
    kind : {"dot", "ring", "triangle", "bar", "link"}
        A dot is this fit, a ring a published value, a triangle a further one; a bar is an
        interval, a dotted link joins two marks.
    at : float
        Where it stands or begins.
    to : float, optional
        Where a bar or link ends.
    colour : str
        Its meaning; a ring is always muted.

    Raises
    ------
    InputError
        If a bar or link has no end, or another mark has one.

    Examples
    --------
    >>> Mark(kind="bar", at=0.2, to=0.3).colour
    'c1'
    """

    kind: Literal["dot", "ring", "triangle", "bar", "link"]
    at: float
    to: float | None = None
    colour: Colour = "c1"

    def __post_init__(self) -> None:
        if (self.kind in {"bar", "link"}) is (self.to is None):
            wanted = "needs `to`" if self.to is None else "takes no `to`"
            raise InputError(f"Mark: a {self.kind} {wanted}, got {self.to!r}.")

    def shapes(self, axis: Axis) -> tuple[Shape, ...]:
        """Return what to draw; what lies beyond the axis becomes an arrow at that end.

        Examples
        --------
        >>> [s.kind for s in Mark(kind="bar", at=1, to=math.inf).shapes(Axis(low=0, high=2))]
        ['bar', 'above']
        """
        ends = sorted(
            axis.position(end) for end in (self.at, self.at if self.to is None else self.to)
        )
        if any(math.isnan(end) for end in ends):
            return ()
        first, last = ends
        arrows = [("below", first < 0), ("above", last > 100)]
        out = [Shape(kind, self.colour, "0%", "0%") for kind, is_drawn in arrows if is_drawn]
        if last >= 0 and first <= 100:
            left, right = _percent(max(first, 0)), _percent(100 - min(last, 100))
            out.insert(0, Shape(self.kind, self.colour, left, right))
        return tuple(out)


@dataclass(frozen=True, kw_only=True)
class RowPlot:
    """A table cell that shows numbers of its row along an axis.

    Parameters
    ----------
    marks : tuple of Mark
        What is drawn, the last on top.
    axis : Axis, optional
        An axis of its own, with numbers below; without it, that of the column.
    lanes : {1, 2}
        With 2, rings stand above the other marks, which they might hide.
    alt : str
        What it shows, if the cells beside it do not say so.

    Examples
    --------
    >>> RowPlot(marks=(Mark(kind="dot", at=0.204),)).lanes
    1
    """

    marks: tuple[Mark, ...]
    axis: Axis | None = None
    lanes: Literal[1, 2] = 1
    alt: str = ""


def _tick_texts(ticks: tuple[float, ...]) -> tuple[str, ...]:
    """Return numbers with the fewest digits, three at least, that move no tick by `UNSEEN`."""
    near = UNSEEN * (max(ticks, default=0.0) - min(ticks, default=0.0))
    enough = (
        digits
        for digits in range(3, DIGITS_OF_A_FLOAT)
        if all(abs(float(f"{tick:.{digits}g}") - tick) <= near for tick in ticks)
    )
    digits = next(enough, DIGITS_OF_A_FLOAT)
    return tuple(number(tick, digits) for tick in ticks)


def _percent(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".") + "%"


# Tables that become cards on a phone.

_MANY_ROWS: Final = 12


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


Cell: TypeAlias = str | Number | Name | RowPlot
"""What a cell may hold; plain text has the markup of `stickslip.show.report.markup.inline`."""


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


@dataclass(frozen=True, kw_only=True)
class Row:
    """A row of a table.

    Parameters
    ----------
    cells : tuple of str, Number, Name or RowPlot
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


def table_of(
    heads: Sequence[str],
    rows: Iterable[Sequence[object]],
    caption: str = "",
    *,
    chosen: Sequence[bool] = (),
) -> Table:
    r"""Return a table of texts, whose columns of numbers are aligned to the right.

    Examples
    --------
    >>> table = table_of(["law", "travel\nm"], [("Coulomb", "0.204"), ("Dahl", "—")])
    >>> [column.numeric for column in table.columns]
    [False, True]
    """
    made = [
        Row(cells=tuple(map(_cell, row)), chosen=bool(chosen) and chosen[place])
        for place, row in enumerate(rows)
    ]
    columns = []
    for place, head in enumerate(heads):
        cells = [row.cells[place] for row in made]
        numeric = place > 0 and all(
            isinstance(cell, Number) or (isinstance(cell, str) and is_numeric(cell))
            for cell in cells
        )
        phone: Literal["show", "label"] = "show" if place == 0 else "label"
        label = f"{head}:" if head and "\n" not in head else ""
        columns.append(Column(head=head, numeric=numeric, phone=phone, label=label))
    return Table(columns=tuple(columns), rows=tuple(made), caption=caption)


def _cell(item: object) -> Cell:
    """Return a cell, in which what is not known is a dash."""
    if isinstance(item, Number | Name | RowPlot):
        return item
    return cell_text(item) or NO_VALUE


def _check(column: Column, cell: Cell) -> None:
    if isinstance(cell, RowPlot):
        if cell.axis is None and column.axis is None:
            raise InputError(f"Table: the plots of column {column.head!r} have no axis.")
        return
    text = cell if isinstance(cell, str) else cell.value if isinstance(cell, Number) else cell.text
    if not text.strip():
        raise InputError(
            f"Table: an empty cell in column {column.head!r}; say in words what is not known."
        )
