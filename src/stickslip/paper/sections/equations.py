"""The printed equations, their defects, and where these act."""

import re

from stickslip.friction import PrintedForm
from stickslip.paper.audit import PaperAudit
from stickslip.paper.misprints import BACKWARD, STEP, TESTS, Consequence, Outcome
from stickslip.paper.sections.common import counted
from stickslip.report import (
    Block,
    Caption,
    Column,
    Math,
    Name,
    Paragraph,
    Row,
    Section,
    Subheading,
    Table,
)
from stickslip.report.numbers import fixed, significant, with_unit

__all__ = ["equation_section", "misprint_section"]

SYMBOL = re.compile(r"\b((?:mu|sigma|F|v)_[a-z0-9]|mu)\b")
DYNAMICS = (
    r"(M+m) \ddot x - m l \ddot\theta (\mu \sin\theta \operatorname{sgn} \dot x + \cos\theta)"
    r" \quad {} + m l \dot\theta^2 (\sin\theta - \mu \cos\theta \operatorname{sgn} \dot x)"
    r" \quad {} + \mu (M+m) g \operatorname{sgn} \dot x = 0"
)
"""Eq. (2), which is right."""
ENERGY = r"\tfrac12 k x^2 = \mu m g s"
"""Eq. (11)."""


def equation_section(found: PaperAudit) -> Section:
    """Show each equation as printed, what is wrong in it, what is right, and what is used here."""
    blocks: list[Block] = [
        Paragraph(
            text=(
                "In the paper’s symbols and under the names that it gives them. Equations (1) to"
                " (4) are forces on the body, (5) to (10) resistances. “Coulomb + viscous +"
                " static”, the sixth model that the paper names, has no equation of its own; it is"
                " (10) with the rule for rest of (5), here the law `coulomb-viscous-static`."
            )
        )
    ]
    for consequence in found.consequences:
        blocks += _shown(consequence.form)
        if consequence.form.equation == "(1)":
            blocks += [
                Subheading(text="(2) dynamics of the cart with (1)"),
                Math(latex=DYNAMICS, tag="(2)"),
                Paragraph(text="**Right**: it follows from (1) and the motion of the pendulum."),
            ]
    blocks += [
        Subheading(text="(11) energy"),
        Math(latex=ENERGY, tag="(11)"),
        Paragraph(text=_energy_text(found)),
    ]
    return Section(
        id="equations",
        nav="Equations",
        heading="The equations as printed",
        blocks=tuple(blocks),
    )


def _shown(form: type[PrintedForm]) -> tuple[Block, ...]:
    right = f" **Right**: {form.right}." if form.right else ""
    text = f"**Wrong**: {form.defect}.{right} **Used here**: {form.cure}."
    return (
        Subheading(text=f"{form.equation} {form.title}"),
        Math(latex=form.formula, tag=form.equation),
        Paragraph(text=_symbols(text)),
    )


def _energy_text(found: PaperAudit) -> str:
    """Say for which of the two springs eq. (11) holds."""
    release, attached = (found.table[0].reading(key).criteria.travel for key in "BC")
    return (
        "**Right for the block that is released**: $x$ is the compression, and the block leaves the"
        f" spring; with Table I it gives {fixed(release, 3)} m. It does not hold for a block that"
        f" stays fastened, which ends at {fixed(attached, 3)} m with energy left in the spring."
    )


def misprint_section(found: PaperAudit) -> Section:
    """Show where each misprint acts, and that none does in Table II."""
    tests = list(TESTS)
    coasting = sum(one.outcome("coast").differs for one in found.consequences)
    backward = sum(one.outcome("backward").differs for one in found.consequences)
    heading = (
        f"{counted(backward).capitalize()} misprints act when the body moves backwards, none in"
        " Table II"
        if coasting == 0
        else "Where the misprints act"
    )
    columns = (
        Column(head="equation"),
        *(
            Column(head=f"{TESTS[key]}\nm", numeric=True, phone="label", label=TESTS[key])
            for key in tests
        ),
    )
    rows = tuple(_row(one) for one in found.consequences)
    return Section(
        id="misprints",
        nav="Where they act",
        heading=heading,
        blocks=(
            Paragraph(text=_tests_text(found)),
            Table(columns=columns, rows=rows),
            Caption(
                text=(
                    "Travel with the printed form in steps of"
                    f" {1e3 * STEP:g} ms; where it differs by more than 1 mm and 1 %, that of the"
                    " corrected law, solved exactly, stands below. (4) is an equation of the cart:"
                    " on a block, whose load is its weight, it is (3). The printed forms:"
                    " `stickslip models --published`."
                )
            ),
        ),
    )


def _tests_text(found: PaperAudit) -> str:
    values = found.values
    force = values.rig.stiffness * values.rig.compression
    between = 0.5 * (values.mu_k + values.mu_s) * values.load
    return (
        "Each form is run literally, as a block diagram would, through four tests on the block of"
        f" Table I: coasting forwards, as after the push of the paper’s rig; pushed from rest with"
        f" {force:g} N for 0.1 s; coasting backwards from {-BACKWARD:g} m/s; and held at rest"
        f" against {between:.3g} N, which is between kinetic and static friction. Coasting forwards"
        " they are all right: the misprints have no effect on the rows of Table II. Taken"
        " literally, (6) to (10) would not even start from rest, and Table II has travels; so we"
        " infer that the simulations had another rule for rest than the one that is printed."
    )


def _row(consequence: Consequence) -> Row:
    form = consequence.form
    return Row(
        cells=(
            f"{form.equation} {form.title}",
            *(_cell(consequence.outcome(key)) for key in TESTS),
        )
    )


def _cell(outcome: Outcome) -> Name | str:
    right = significant(outcome.corrected.travel, 3)
    if outcome.diverged:
        when = with_unit(f"{1e3 * outcome.lasted:.3g}", "ms") if outcome.lasted else "one step"
        return Name(text=f"diverges in {when}", aside=f"not {right}")
    printed = significant(outcome.printed.travel, 3)
    return Name(text=printed, aside=f"not {right}") if outcome.differs else printed


def _symbols(text: str) -> str:
    """Mark the symbols in a plain text for typesetting."""
    return SYMBOL.sub(r"$\1$", text.replace("^n", "^{n}").replace("-|", "−|"))
