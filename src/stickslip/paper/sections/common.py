"""What the sections share."""

import math
from collections.abc import Callable, Iterable
from typing import Literal, TypeVar

from stickslip.friction import FrictionLaw, PrintedForm
from stickslip.paper.paper_audit import PaperAudit
from stickslip.quantities import fields_of
from stickslip.show.formatting import quantity, significant
from stickslip.show.report import Axis, Cell, Column, Row, Table

T = TypeVar("T")

COLOURS: dict[str, Literal["c1", "c2", "c3", "c4"]] = {"A": "c2", "B": "c1", "C": "c3"}
"""Colour of each reading of the rig."""
PER_LOAD = ("bristle_stiffness", "bristle_damping")
"""Parameters that a law has over the load, and a printed equation as they are."""
STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
"""Ends of axes, times a power of ten."""


def numbers(head: str, label: str = "") -> Column:
    """Return a column of numbers, which on a phone have a label: the head, or a shorter one."""
    return Column(head=head, numeric=True, phone="label", label=label)


FIRST_CYCLE = "first cycle\nmm"
LOWEST_VELOCITY = "lowest velocity\nmm/s"
BACK_SLIP = "back-slip\nmm/cycle"
"""Heads of the tables of the cart."""


def table(
    items: Iterable[T],
    *columns: tuple[str | Column, Callable[[T], Cell]],
    caption: str = "",
    chosen: Callable[[T], bool] = lambda _: False,
) -> Table:
    """Return a table with a row for each item; each column stands beside what makes its cells."""
    heads = [Column(head=column) if isinstance(column, str) else column for column, _ in columns]
    rows = [
        Row(cells=tuple(cell(item) for _, cell in columns), chosen=chosen(item)) for item in items
    ]
    return Table(columns=tuple(heads), rows=tuple(rows), caption=caption)


def values_of(law: FrictionLaw | PrintedForm, load: float | None = None) -> str:
    """List the parameters that a law has, as symbols with values and units."""
    parts = []
    for name, field in fields_of(type(law)).items():
        value, unit = getattr(law, name), field.unit
        if load is not None and name in PER_LOAD and isinstance(law, FrictionLaw):
            value, unit = value * load, {"1/m": "N/m", "s/m": "N s/m"}.get(unit, unit)
        plain = name.endswith("exponent") and value == 1.0 and law.name != "stribeck"
        if value is not None and not isinstance(value, bool) and not plain:
            parts.append(f"${field.symbol}$ {quantity(value, unit)}")
    return ", ".join(parts)


def travel_axis(audit: PaperAudit, travels: Iterable[float], caption: str) -> Axis:
    """Return the travel axis of the tables, with the measured travel as its line."""
    most = max((*travels, audit.measured))
    power = 10.0 ** math.floor(math.log10(most))
    high = next(step * power for step in STEPS if step * power >= most)
    return Axis(
        low=0.0,
        high=high,
        ticks=(0.0, 0.4 * high, 0.8 * high),
        reference=audit.measured,
        caption=caption,
    )


def back_slip_text(way: float) -> str:
    """Return a cell of `BACK_SLIP`."""
    return "none" if way == 0.0 else significant(1e3 * way, 2)
