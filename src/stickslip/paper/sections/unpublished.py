"""What the parameters that the paper does not print would have to be."""

from stickslip.paper.audit import PaperAudit
from stickslip.paper.sections.common import counted
from stickslip.paper.unpublished import Requirement
from stickslip.report import Caption, Column, Paragraph, Row, Section, Table
from stickslip.report.numbers import fixed, significant

__all__ = ["unpublished_section"]


def unpublished_section(found: PaperAudit) -> Section:
    """Show the value behind each published row, with its range."""
    reached = sum(need.value is not None for need in found.requirements)
    total = len(found.requirements)
    columns = (
        Column(head="row"),
        Column(head="published\nm", numeric=True, phone="label", label="published"),
        Column(head="would need", numeric=True),
        Column(head="range for\nthe rounding", numeric=True, phone="label", label="range"),
        Column(head="what that means"),
    )
    titles = {row.law.name: row.law.title for row in found.table}
    rows = tuple(_row(need, titles.get(need.law, need.law)) for need in found.requirements)
    return Section(
        id="unpublished",
        nav="Unpublished values",
        heading=f"{counted(reached).capitalize()} of {counted(total)} rows can be had, each from"
        " a value that is not published",
        blocks=(
            Paragraph(
                text=(
                    "The paper prints no stiffness, Stribeck velocity or viscous coefficient. These"
                    " values, found by root finding under reading A, the push it simulated, give"
                    " its rows; the range is that of the travels that round to the printed figure."
                )
            ),
            Table(columns=columns, rows=rows),
            _bristle_table(found),
            Caption(
                text=(
                    "That a value gives the row does not show that it was used. To settle it would"
                    " take the parameters of the paper's simulations."
                )
            ),
        ),
    )


def _row(need: Requirement, title: str) -> Row:
    unit = "" if need.unit == "1" else f" {need.unit}"
    if need.value is None:
        value = f"no ${need.symbol}$"
        limits = f"nearest {fixed(need.start, 3)} m"
    else:
        value = f"${need.symbol}$ = {significant(need.value, 3)}{unit}"
        limits = "one-sided"
        if need.low is not None and need.high is not None:
            limits = f"{significant(need.low, 3)} to {significant(need.high, 3)}"
    return Row(cells=(title, fixed(need.published, 2), value, limits, need.text))


def _bristle_table(found: PaperAudit) -> Table:
    """Show the travel of the bristle laws by their stiffness, in the same push."""
    columns = (
        Column(head="bristles"),
        Column(head="Dahl, held\nm", numeric=True, phone="label", label="Dahl, held, m"),
        Column(head="LuGre, free\nm", numeric=True, phone="label", label="LuGre, free, m"),
        Column(
            head="LuGre, lowest\nvelocity, mm/s",
            numeric=True,
            phone="label",
            label="LuGre, lowest velocity, mm/s",
        ),
    )
    dahl = [row for row in found.bristles if row.law == "dahl"]
    lugre = [row for row in found.bristles if row.law == "lugre"]
    rows = tuple(
        Row(
            cells=(
                f"{significant(one.stiffness, 1)} N/m",
                fixed(one.criteria.travel, 4),
                fixed(other.criteria.travel, 4),
                significant(1e3 * other.criteria.least_velocity, 2),
            )
        )
        for one, other in zip(dahl, lugre, strict=True)
    )
    caption = (
        "The same push with softer and softer bristles. Published: Dahl 0.25 m, LuGre 0.13 m with"
        " a velocity that becomes negative."
    )
    return Table(columns=columns, rows=rows, caption=caption)
