"""The printed equations, their defects and what they do."""

import re

from stickslip.paper.audit import PaperAudit
from stickslip.paper.misprints import STEP, Consequence
from stickslip.paper.sections.common import counted
from stickslip.report import Caption, Column, Name, Paragraph, Row, Section, Table, mathml
from stickslip.report.numbers import significant

__all__ = ["equation_section"]

SYMBOL = re.compile(r"\b((?:mu|sigma|F|v)_[a-z0-9])\b")


def equation_section(found: PaperAudit) -> Section:
    """Show each printed equation beside the corrected one, and what both do in a test."""
    wrong = sum(_differs(c) for c in found.consequences)
    columns = (
        Column(head="equation"),
        Column(head="as printed, what is wrong, what is used here"),
        Column(head="as printed\nm", numeric=True, phone="label", label="as printed, m"),
        Column(head="corrected\nm", numeric=True, phone="label", label="corrected, m"),
    )
    rows = [_row(consequence) for consequence in found.consequences]
    rows.append(_energy_row(found))
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
                    f"The last columns: travel within the test, in steps of {1e3 * STEP:g} ms as"
                    " printed. The printed forms: `stickslip models --published`."
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
    remark = f"{form.defect}. Used here: {form.cure}."
    if consequence.diverged:
        outcome = "diverges"
        when = f"after {1e3 * consequence.lasted:.3g} ms" if consequence.lasted else "in one step"
        remark += f" The printed form grows beyond all numbers {when}."
    return Row(
        cells=(
            Name(text=f"{form.equation} {form.title}", aside=f"test: {consequence.test}"),
            Name(text=mathml(form.formula, display=False), aside=_symbols(remark)),
            outcome,
            significant(consequence.corrected.travel, 3),
        )
    )


def _energy_row(found: PaperAudit) -> Row:
    """Set eq. (11) against the two springs: it knows only one of them."""
    release, attached = (found.table[0].readings[i].criteria.travel for i in (1, 2))
    return Row(
        cells=(
            Name(text="(11) energy", aside="test: spring released, and spring fixed"),
            Name(
                text=mathml(r"\tfrac12 k x_0^2 = \mu m g s", display=False),
                aside="no condition stated. Used here: only if the block leaves the spring.",
            ),
            significant(release, 3),
            significant(attached, 3),
        )
    )


def _symbols(text: str) -> str:
    """Mark the symbols in a plain text for typesetting."""
    return SYMBOL.sub(r"$\1$", text)
