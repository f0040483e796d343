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
