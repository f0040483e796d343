"""Tables of candidates: one list of columns for DataFrames, terminals and pages."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, Generic, Literal, TypeAlias

from typing_extensions import TypeVar

from stickslip.identify.candidates import Candidate
from stickslip.show.formatting import NO_VALUE, EstimateText, Scale, with_unit
from stickslip.show.report import Axis, Cell, Colour, Number, Row, Table, error_axis, error_plot
from stickslip.show.report import Column as PageColumn

C = TypeVar("C", bound=Candidate[Any])
Shown: TypeAlias = str | EstimateText | None


@dataclass(frozen=True, kw_only=True)
class Column(Generic[C]):
    """What a table says of each candidate; a medium without a name for it leaves it out."""

    key: str = ""
    """Its name in a DataFrame."""
    title: str = ""
    """Its heading on a terminal."""
    page: str = ""
    """Its heading on a page; a line break stands before what is set small."""
    value: Callable[[C], object] = lambda _: None
    """Number [SI] or text for a DataFrame."""
    text: Callable[[C], Shown] = lambda _: None
    """What people read, without the unit; None where there is nothing."""
    unit: str = ""
    """Unit of the text, which a terminal says in the cell and a page in the heading."""
    why_empty: str = NO_VALUE
    """What a page says where there is nothing."""
    optional: bool = False
    """Whether the column is left out where all values are None."""
    numeric: bool = True
    """Whether a page aligns its cells to the right."""
    phone: Literal["show", "hide", "label"] = "show"
    """What becomes of it on a phone."""
    label: str = ""
    """Its label there, if not the heading."""
    plotted: bool = False
    """Whether a page draws the held-out error beside it, with its standard error."""

    def on_terminal(self, one: C) -> str:
        """Return the cell of a candidate on a terminal."""
        text = self.text(one)
        if text is None:
            return NO_VALUE
        return with_unit(text if isinstance(text, str) else " ".join(text).strip(), self.unit)

    def on_page(self, one: C) -> Cell:
        """Return the cell of a candidate on a page."""
        text = self.text(one)
        if text is None:
            return self.why_empty
        return text if isinstance(text, str) else Number(value=text.value, doubt=text.doubt)


Columns: TypeAlias = Sequence[Column[C]]


def data_row(columns: Columns[C], one: C) -> dict[str, Any]:
    """Return a candidate as a row of a DataFrame."""
    return {column.key: column.value(one) for column in columns if column.key}


def terminal_table(columns: Columns[C], rows: Sequence[C]) -> tuple[list[str], list[list[str]]]:
    """Return headings and cells of a table on a terminal."""
    shown = [one for one in columns if one.title and _is_shown(one, rows)]
    return [one.title for one in shown], [[one.on_terminal(row) for one in shown] for row in rows]


def page_table(
    columns: Columns[C],
    rows: Sequence[C],
    *,
    cells: Mapping[str, Callable[[C], Cell]],
    scale: Scale,
    colour: Callable[[C], Colour],
    chosen: Callable[[C], bool],
    caption: str,
    axis: Axis | None = None,
) -> Table:
    """Return the table of a page, with the held-out errors drawn where there are several.

    `cells` has what a page says otherwise, by heading; `axis` is that of the errors, if not the
    usual one.
    """
    errors = [(_number(row.score), _number(row.score_error)) for row in rows]
    axis = axis or error_axis([one for one, _ in errors], scale, [error for _, error in errors])

    made: list[tuple[PageColumn, Callable[[C], Cell]]] = []
    for one in columns:
        if not one.page or not _is_shown(one, rows):
            continue
        head = f"{one.page}\n{one.unit}" if one.unit else one.page
        column = PageColumn(head=head, numeric=one.numeric, phone=one.phone, label=one.label)
        made.append((column, cells.get(one.page, one.on_page)))
        if one.plotted and axis is not None:
            made.append((PageColumn(head="", axis=axis), partial(_plotted, scale, colour, axis)))
    return Table(
        columns=tuple(column for column, _ in made),
        rows=tuple(
            Row(
                cells=tuple(cell(row) for _, cell in made),
                chosen=chosen(row),
                muted=bool(row.dropped),
            )
            for row in rows
        ),
        caption=caption,
    )


def _plotted(scale: Scale, colour: Callable[[C], Colour], axis: Axis, one: C) -> Cell:
    return error_plot(_number(one.score), _number(one.score_error), scale, colour(one), axis)


def _number(value: float | None) -> float:
    return math.inf if value is None else value


def _is_shown(column: Column[C], rows: Sequence[C]) -> bool:
    return not column.optional or any(column.value(row) is not None for row in rows)
