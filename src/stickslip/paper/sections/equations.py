"""The printed equations, their defects, and where these act."""

from stickslip.formatting import fixed, in_words, significant, with_unit
from stickslip.friction import PRINTED_EQUATIONS, PrintedForm, RightEquation
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

__all__ = ["equation_section", "misprint_section"]


def equation_section(found: PaperAudit) -> Section:
    """Show each equation as printed, what is wrong in it, what is right, and what is used here."""
    blocks: list[Block] = [
        Paragraph(
            text=(
                "In the paper’s symbols. It quotes (1) to (4) from its references [6] and [7],"
                " whose friction model it calls simple, in order to improve on them. (1) and (3)"
                " are forces on the cart, (5) to (10) resistances. Elsewhere on this page"
                " $sigma_0$, $sigma_1$ and $sigma_2$ stand for the $sigma_1$, $sigma_2$ and"
                " $sigma_3$ of (9), $sigma_2$ for the viscous $mu$ of (5) and (10) and $mu_v$ of"
                " (8), and $mu_k$ for $mu_d$ of Table I. “Coulomb plus viscous plus static”, one of"
                " the six models that the paper names, has no equation of its own; it is taken"
                " here as (10) with the rule for rest of (5), the law `coulomb-viscous-static`."
            )
        )
    ]
    for form in PRINTED_EQUATIONS:
        blocks += _shown(form)
    blocks.append(Paragraph(text=_energy_text(found)))
    return Section(
        id="equations",
        nav="Equations",
        heading="The equations as printed",
        blocks=tuple(blocks),
    )


def _shown(form: type[PrintedForm] | RightEquation) -> tuple[Block, ...]:
    right = "Right" if form.defect else "Right as printed"
    parts = {"Defect": form.defect, right: form.right, "Used here": form.cure}
    text = " ".join(f"**{key}**: {what}." for key, what in parts.items() if what)
    return (
        Subheading(text=f"{form.equation} {form.title}"),
        Math(latex=form.formula, tag=form.equation),
        Paragraph(text=text),
    )


def _energy_text(found: PaperAudit) -> str:
    """Say for which of the two springs eq. (11) holds."""
    release, attached = (found.table[0].reading(key).criteria for key in "BC")
    way = attached.travel + 2.0 * attached.largest_return
    return (
        f"With Table I and $x$ = 0.1 m it gives {fixed(release.travel, 3)} m. For a block that"
        f" stays fastened to its spring $s$ would be the length of its path, {fixed(way, 3)} m;"
        f" since that block returns, it ends at {fixed(attached.travel, 3)} m."
    )


def misprint_section(found: PaperAudit) -> Section:
    """Show where each defect acts, and that none does in a coast forwards."""
    tests = list(TESTS)
    coasting = sum(one.differs("coast") for one in found.consequences)
    backward = sum(one.differs("backward") for one in found.consequences)
    heading = (
        f"{in_words(backward).capitalize()} equations err when the block moves backwards, none when"
        " it coasts forwards"
        if coasting == 0
        else "Where the defects act"
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
                    f"Travel in {SECONDS:g} s with the printed form, by Heun’s method in steps of"
                    f" {1e3 * STEP:g} ms ({1e3 * BRISTLE_STEP:g} ms with bristles). Below it, where"
                    " the two differ by more than 1 mm and 1 %, that of the corrected law, solved"
                    " exactly. (4) is an equation of the cart: for a block, whose load is its"
                    " weight, it equals (3). The exponent of (9) is taken as −|$v$/$v_s$|². Viscous"
                    " friction holds nothing and has no entry in the last column. As text:"
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
        f" against {below:.3g} N, half of kinetic friction. All are right when the block coasts"
        " forwards. By the paper’s account four of the five rows of Table II never move backwards,"
        " so no error of sign acts on them; LuGre’s does, and there the sgn of (9) may have acted."
        " (6) to (10) omit the break-away force that the paper describes (III.B.1) and prints in"
        " (5): as they stand they would not start from rest. Table II has travels, so we infer that"
        " the simulations used another rule for rest. (3) and (4) are tried with their signed"
        " coefficient, which was hardly simulated. (1) creeps where it should hold, by an amount"
        " that vanishes with the step."
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
