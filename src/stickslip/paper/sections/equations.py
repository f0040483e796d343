"""The printed equations, their defects, and where these act."""

import re

from stickslip.friction import PrintedForm
from stickslip.paper.audit import PaperAudit
from stickslip.paper.misprints import (
    BACKWARD,
    BRISTLE_STEP,
    HELD,
    SECONDS,
    STEP,
    TESTS,
    Consequence,
    Outcome,
)
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
LOAD = re.compile(r"(?<=mu_[ks] )N\b")
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
                "In the paper’s symbols. It quotes (1) to (4) from its references [6] and [7],"
                " which it calls too simple; (1) and (3) are forces on the body, (5) to (10)"
                " resistances. Elsewhere on this page $sigma_0$, $sigma_1$ and $sigma_2$ stand for"
                " the $sigma_1$, $sigma_2$ and $sigma_3$ of (9), $sigma_2$ for the viscous $mu$ of"
                " (5), (8) and (10), and $mu_k$ for $mu_d$ of Table I. “Coulomb plus viscous plus"
                " static”, one of the six models that the paper names, has no equation of its own;"
                " it is (10) with the rule for rest of (5), here the law `coulomb-viscous-static`."
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
    release, attached = (found.table[0].reading(key).criteria for key in "BC")
    way = attached.travel + 2.0 * attached.largest_return
    return (
        "**Right for the block that is released**: $x$ is the compression, and the block leaves the"
        f" spring; with Table I it gives {fixed(release.travel, 3)} m. For a block that stays"
        f" fastened $s$ would be the length of its path, {fixed(way, 3)} m; since it returns, it"
        f" ends at {fixed(attached.travel, 3)} m."
    )


def misprint_section(found: PaperAudit) -> Section:
    """Show where each misprint acts, and that none does in a coast forwards."""
    tests = list(TESTS)
    coasting = sum(one.differs("coast") for one in found.consequences)
    backward = sum(one.differs("backward") for one in found.consequences)
    heading = (
        f"{counted(backward).capitalize()} equations err when the body moves backwards, none when"
        " it coasts forwards"
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
                    f"Travel in {SECONDS:g} s with the printed form, by Heun's method in steps of"
                    f" {1e3 * STEP:g} ms, with bristles {1e3 * BRISTLE_STEP:g} ms; where it differs"
                    " by more than 1 mm and 1 %, that of the corrected law, solved exactly, stands"
                    " below. (4) is an equation of the cart: on a block, whose load is its weight,"
                    " it is (3). The exponent of (9) is taken as −|$v$/$v_s$|². Viscous friction"
                    " holds nothing and has no entry in the last column. The printed forms:"
                    " `stickslip models --published`."
                )
            ),
        ),
    )


def _tests_text(found: PaperAudit) -> str:
    values = found.values
    force = values.rig.stiffness * values.rig.compression
    below = HELD * values.mu_k * values.load
    return (
        "Each form is evaluated as it stands, as a block diagram would, in four tests on the block"
        " of Table I: coasting forwards, as after the push; pushed from rest with"
        f" {force:g} N for 0.1 s; coasting backwards from {-BACKWARD:g} m/s; and held at rest"
        f" against {below:.3g} N, half of kinetic friction. Coasting forwards"
        " all are right. Four of the five rows of Table II never move backwards, so that no"
        " misprint acts on them; LuGre's does, by the paper's account, and there the sgn of (9)"
        " may have acted. (6) to (10) omit the break-away limit that the paper describes (III.B.1)"
        " and prints in (5): as they stand they would not start from rest. Table II has travels,"
        " so we infer that the simulations had another rule for rest."
    )


def _row(consequence: Consequence) -> Row:
    form = consequence.form
    return Row(
        cells=(
            f"{form.equation} {form.title}",
            *(_cell(consequence.outcome(key)) for key in TESTS),
        )
    )


def _cell(outcome: Outcome | None) -> Name | str:
    if outcome is None:
        return "—"
    right = significant(outcome.corrected.travel, 3)
    if outcome.diverged:
        when = with_unit(f"{1e3 * outcome.lasted:.3g}", "ms") if outcome.lasted else "one step"
        return Name(text=f"diverges in {when}", aside=f"not {right}")
    printed = significant(outcome.printed.travel, 3)
    return Name(text=printed, aside=f"not {right}") if outcome.differs else printed


def _symbols(text: str) -> str:
    """Mark the symbols in a plain text for typesetting."""
    text = LOAD.sub("$N$", text)
    return SYMBOL.sub(r"$\1$", text.replace("^n", "^{n}").replace("-|", "−|"))
