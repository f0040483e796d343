"""The printed equations, their defects and what they do."""

from stickslip.paper.audit import PaperAudit
from stickslip.paper.misprints import STEP, Consequence
from stickslip.paper.sections.common import counted
from stickslip.report import Caption, Column, Name, Paragraph, Row, Section, Table, mathml
from stickslip.report.numbers import significant

__all__ = ["equation_section"]


def equation_section(found: PaperAudit) -> Section:
    """Show each printed equation beside the corrected one, and what both do in a test."""
    wrong = sum(_differs(c) for c in found.consequences)
    columns = (
        Column(head="equation"),
        Column(head="as printed"),
        Column(head="used here"),
        Column(head="test"),
        Column(head="as printed\nm", numeric=True, phone="label", label="as printed, m"),
        Column(head="corrected\nm", numeric=True, phone="label", label="corrected, m"),
    )
    rows = [_row(consequence) for consequence in found.consequences]
    release, attached = (found.table[0].readings[i].criteria.travel for i in (1, 2))
    rows.append(
        Row(
            cells=(
                Name(text="(11) energy"),
                "no condition stated",
                "valid only if the block leaves the spring",
                "spring released, and spring fixed",
                significant(release, 3),
                significant(attached, 3),
            )
        )
    )
    return Section(
        id="equations",
        nav="Equations",
        heading=f"{counted(wrong).capitalize()} printed equations move the block where the"
        " corrected ones do not",
        blocks=(
            Paragraph(
                text=(
                    "Each printed form is run literally, as a block diagram would, in a test that"
                    " shows its defect; beside it the corrected law, solved exactly. Equation (2)"
                    " is correct."
                )
            ),
            Table(columns=columns, rows=tuple(rows)),
            Caption(
                text=(
                    f"Travel within the test; Heun steps of {1e3 * STEP:g} ms. The printed forms:"
                    " `stickslip models --published`."
                )
            ),
        ),
    )


def _differs(consequence: Consequence) -> bool:
    gap = abs(consequence.printed.travel - consequence.corrected.travel)
    return consequence.diverged or gap > 0.01 * abs(consequence.corrected.travel) + 1e-3


def _row(consequence: Consequence) -> Row:
    form = consequence.form
    outcome = significant(consequence.printed.travel, 3)
    if consequence.diverged:
        outcome = f"beyond all numbers at {1e3 * consequence.lasted:.3g} ms"
    return Row(
        cells=(
            Name(text=f"{form.equation} {form.title}", aside=form.defect),
            mathml(form.formula, display=False),
            form.cure.replace("mu_s", "$mu_s$").replace("mu_k", "$mu_k$"),
            consequence.test,
            outcome,
            significant(consequence.corrected.travel, 3),
        )
    )
