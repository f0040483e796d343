"""What the parameters that the paper does not print would have to be."""

from stickslip.paper.audit import PaperAudit
from stickslip.paper.sections.common import counted
from stickslip.paper.unpublished import Requirement
from stickslip.report import Caption, Column, Name, Paragraph, Row, Section, Table
from stickslip.report.numbers import fixed, significant

__all__ = ["unpublished_section"]


def unpublished_section(found: PaperAudit) -> Section:
    """Show the value behind each published row with its range, for a push and for a spring."""
    total = len(found.table)
    reached = {key: _reached(found, key) for key in "AB"}
    columns = (
        Column(head="row"),
        Column(head="published\nm", numeric=True, phone="label", label="published, m"),
        Column(head="A, push: would need", numeric=True, phone="label", label="A would need"),
        Column(head="B, spring: would need", numeric=True, phone="label", label="B would need"),
        Column(head="what that means"),
    )
    needs = {(need.law, need.reading): need for need in found.requirements}
    rows = tuple(
        Row(
            cells=(
                row.law.title,
                fixed(row.published.travel or 0.0, 2),
                *(_value(needs[row.law.name, key]) for key in "AB"),
                needs[row.law.name, "A"].text,
            )
        )
        for row in found.table
        if (row.law.name, "A") in needs
    )
    return Section(
        id="unpublished",
        nav="Unpublished values",
        heading=(
            f"As a push {counted(reached['A'])} of {counted(total)} rows can be had from a value"
            f" that is not published, as a spring {counted(reached['B'])}"
        ),
        blocks=(
            Paragraph(
                text=(
                    "The paper prints no stiffness, Stribeck velocity or viscous coefficient. These"
                    " values, found by root finding in readings A and B, give its rows; below each"
                    " the range for travels that round to the printed figure."
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


def _reached(found: PaperAudit, key: str) -> int:
    return sum(need.value is not None and need.reading == key for need in found.requirements)


def _value(need: Requirement) -> Name:
    unit = "" if need.unit == "1" else f" {need.unit}"
    if need.value is None:
        return Name(text=f"no ${need.symbol}$", aside=f"nearest {fixed(need.start, 3)} m")
    limits = "one-sided"
    if need.low is not None and need.high is not None:
        limits = f"{significant(need.low, 3)} to {significant(need.high, 3)}"
    return Name(text=f"${need.symbol}$ = {significant(need.value, 3)}{unit}", aside=limits)


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
        "The push of reading A with softer and softer bristles. Published: Dahl 0.25 m, LuGre"
        " 0.13 m with a velocity that becomes negative."
    )
    return Table(columns=columns, rows=rows, caption=caption)
