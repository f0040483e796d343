"""The paper's Table II beside ours."""

from stickslip.paper.audit import PaperAudit, TableRow
from stickslip.paper.sections.common import counted, travel_axis
from stickslip.paper.springback import STIFFNESS
from stickslip.paper.unpublished import Requirement
from stickslip.report import Block, Column, Mark, Note, Paragraph, Row, RowPlot, Section, Table
from stickslip.report.numbers import fixed, interval, significant

__all__ = ["table_section"]


def table_section(found: PaperAudit) -> Section:
    """Show every row of Table II with the travels of the three readings."""
    travels = [_travel(row, "B") for row in found.table]
    near = sum(abs(travel - found.measured) <= 0.01 for travel in travels)
    text = (
        f"Same {counted(len(found.table))} models, Table I coefficients. What the paper does not"
        f" print is assumed: {_assumptions(found)}. With the spring released they land between"
        f" {interval(min(travels), max(travels)).replace(' to ', ' and ')} m,"
        f" {counted(near)} of them within 10 mm of the measured {found.measured:.2f} m."
    )
    return Section(
        id="table2",
        nav="Table II, ours",
        heading="The paper’s Table II beside ours",
        blocks=(Paragraph(text=text), _table(found), _note(found)),
    )


def _travel(row: TableRow, key: str) -> float:
    return next(r.criteria.travel for r in row.readings if r.key == key)


def _assumptions(found: PaperAudit) -> str:
    """List the assumed values in the paper's own terms."""
    values = found.values
    return (
        f"$sigma_2$ {values.viscous:g} N s/m, $v_s$ {1e3 * values.stribeck_velocity:g} mm/s,"
        f" bristles of {significant(values.stiffness, 2)} N/m and"
        f" {significant(values.damping, 2)} N s/m"
    )


def _table(found: PaperAudit) -> Table:
    columns = (
        Column(head="model"),
        Column(head="published\nm", numeric=True, phone="label", label="published"),
        Column(head="A, push\nm", numeric=True, phone="label", label="A push"),
        Column(head="B, spring\nm", numeric=True, phone="label", label="B spring"),
        Column(head="C, fixed\nm", numeric=True, phone="label", label="C fixed"),
        Column(
            head="",
            axis=travel_axis(found, "travel, m; ring: published, triangle: A, dot: B"),
        ),
        Column(head="what gives the published row"),
    )
    needs = {need.law: need for need in found.requirements}
    rows = tuple(_row(row, needs.get(row.law.name)) for row in found.table)
    return Table(columns=columns, rows=rows)


def _row(row: TableRow, need: Requirement | None) -> Row:
    published = row.published.travel or 0.0
    push, spring, fixed_spring = (_travel(row, key) for key in "ABC")
    marks = (
        Mark(kind="link", at=min(push, published), to=max(push, published), colour="muted"),
        Mark(kind="triangle", at=push, colour="c2"),
        Mark(kind="ring", at=published, colour="muted"),
        Mark(kind="dot", at=spring, colour="c1"),
    )
    return Row(
        cells=(
            row.law.title,
            fixed(published, 2),
            fixed(push, 3),
            fixed(spring, 3),
            fixed(fixed_spring, 3),
            RowPlot(marks=marks),
            _origin(need),
        )
    )


def _origin(need: Requirement | None) -> str:
    if need is None:
        return "not searched"
    if need.value is None:
        return f"no value of ${need.symbol}$: {need.text}"
    unit = "" if need.unit == "1" else f" {need.unit}"
    return f"${need.symbol}$ = {significant(need.value, 3)}{unit}, {need.text}"


def _note(found: PaperAudit) -> Block:
    """Say what criterion 1 does to laws with elastic presliding."""
    backs = [
        f"{back.law.title} {1e3 * back.criteria.least_velocity:.2g} mm/s"
        for back in found.springbacks
    ]
    speeds = " and ".join(backs).replace("-", "−")
    return Note(
        title="The criterion “velocity never negative” rejects correct models.",
        text=(
            "Bristle laws let the block spring back by its elastic deflection when it stops: at"
            f" {STIFFNESS / 1e5:g} × 10⁵ N/m and without a hold, {speeds}. That is"
            " physics, not error. In the table above the block is held at its first stop, as in"
            " the paper, and no row fails for that reason."
        ),
    )
