"""The printed equations, their defects, and where these act."""

from stickslip.formatting import fixed, in_words, joined, number, quantity, significant, with_unit
from stickslip.friction import PRINTED_EQUATIONS, PrintedForm, RightEquation
from stickslip.paper.audit import PaperAudit
from stickslip.paper.excitations import PUSH_DURATION
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
from stickslip.paper.sections.common import levels_from, values_of
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


def equation_section(found: PaperAudit) -> Section:
    """Show each equation as printed, what is wrong in it, what is right, and what is used here."""
    blocks: list[Block] = [
        Paragraph(
            text=(
                "In the paper’s symbols; those of this page are in the table after the equations."
                " The paper quotes (1) to (4) from its references [6] and [7], in order to improve"
                " on them. (1) and (3) are forces on the cart, (5) to (10) resistances. “Coulomb"
                " plus viscous plus static” has no equation of its own; it is taken here as (10)"
                " with the rule for rest of (5), the law `coulomb-viscous-static`."
            )
        )
    ]
    for form in PRINTED_EQUATIONS:
        blocks += _shown(form)
    blocks.append(Paragraph(text=_energy_text(found)))
    blocks += [Subheading(text="Symbols"), _symbol_table()]
    blocks += [Subheading(text="Values in the tests of the equations"), _values_table(found)]
    return Section(
        collapsed=True,
        id="equations",
        nav="Equations",
        heading="The equations as printed, symbols and values",
        blocks=tuple(blocks),
    )


SYMBOLS = (
    ("$v$", "slip velocity", "m/s", "$x$′, written with a dot"),
    ("$F$", "friction force, with the sign of $v$", "N", "$F_f$; $F$ in (5), −$F_f$ in (1), (3)"),
    ("$N$", "normal force", "N", "$N$"),
    (
        "$mu_k$",
        "kinetic coefficient",
        "1",
        "$mu_d$ in Table I, $mu$ in (1), (2), (7) and (11), $mu_k$ in (3)",
    ),
    ("$mu_s$", "static coefficient", "1", "$mu_s$ in Table I"),
    ("$F_c$", "$mu_k$$N$, Coulomb friction", "N", "$F_c$; in (7) with its sgn $v$"),
    ("$F_s$", "$mu_s$$N$, break-away force", "N", "$F_s$"),
    (
        "$sigma_2$",
        "viscous coefficient",
        "N s/m",
        "$mu$ in (5) and (10), $mu_v$ in (8), $sigma_3$ in (9)",
    ),
    ("$sigma_0$", "stiffness of the bristles", "N/m", "$sigma_0$ in (6), $sigma_1$ in (9)"),
    ("$sigma_1$", "damping of the bristles", "N s/m", "$sigma_2$ in (9)"),
    ("$z$", "deflection of the bristles", "m", "$Z$"),
    ("$v_s$", "Stribeck velocity", "m/s", "$x$′ with the index s in (5), $v_s$ in (9)"),
    ("$n$", "exponent of the Stribeck curve", "1", "1 in (5), $alpha$ in (9)"),
    ("—", "steady friction against velocity", "N", "$F$($v$) and $F_v$ in (5), $F_v$ in (9)"),
    ("—", "force of the law while it slides", "N", "$F_d$ in (6), $F_v$ in (8) and (9)"),
    ("—", "resultant of the other forces", "N", "$F_x$; $F_e$ in (5), once $mu_v$ below (8)"),
    ("$k$, $x_0$", "spring and its compression", "N/m, m", "$K$ or $k$, $x$"),
    ("$x$", "displacement of block or cart", "m", "$x$; the whole travel is $s$ in (11)"),
)  # fmt: skip
"""Symbols of the page: symbol, meaning, unit, in the paper."""


def _symbol_table() -> Table:
    columns = (
        Column(head="here"),
        Column(head="meaning"),
        Column(head="unit", phone="label", label="unit:"),
        Column(head="in the paper", phone="label", label="in the paper:"),
    )
    return Table(columns=columns, rows=tuple(Row(cells=cells) for cells in SYMBOLS))


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
    places = found.table[0].reading("C").run["x"]  # turning points among them
    way = float(abs(places[1:] - places[:-1]).sum())
    x = quantity(found.values.rig.compression, "m")
    return (
        f"With the coefficient {levels_from(found)} and $x$ = {x} it gives"
        f" {fixed(release.travel, 3)} m. For a block that"
        f" stays fastened to its spring $s$ would be the length of its path, {fixed(way, 3)} m;"
        f" since that block returns, it ends at {fixed(attached.travel, 3)} m."
    )


def misprint_section(found: PaperAudit) -> Section:
    """Show where each defect acts, as printed and with a stick rule added."""
    errs = {key: sum(one.differs(key) for one in found.consequences) for key in TESTS}
    heading = (
        f"As printed, {in_words(errs['coast'])} equations err when the block coasts forwards,"
        f" {in_words(errs['push'])} when it is pushed from rest"
    )
    columns = (
        Column(head="equation"),
        *(
            Column(head=f"{what}\nm", numeric=True, phone="label", label=f"{what}, m")
            for what in TESTS.values()
        ),
    )
    rows = tuple(_row(one) for one in found.consequences)
    return Section(
        collapsed=True,
        id="misprints",
        nav="Where they act",
        heading=heading,
        blocks=(
            Paragraph(text=_tests_text(found)),
            Table(columns=columns, rows=rows),
            Caption(
                text=(
                    f"Travel in {SECONDS:g} s, by Heun’s method in steps of"
                    f" {1e3 * STEP:g} ms ({1e3 * BRISTLE_STEP:g} ms with bristles), without a stick"
                    " rule. Below it, where the two differ by more than 1 mm and 1 %, that of the"
                    " corrected law, solved exactly. For a block, (4) equals (3). Viscous friction"
                    " has no entry in the last column. As text: `stickslip models --published`."
                )
            ),
            Paragraph(text=_rule_text(found)),
        ),
    )


def _tests_text(found: PaperAudit) -> str:
    values = found.values
    below = HELD * values.mu_k * values.load
    return (
        f"Each equation as it stands, in four tests on the block {levels_from(found)}: coasting"
        f" forwards, as after the push; pushed from rest with {number(values.force)} N for"
        f" {PUSH_DURATION:g} s; coasting backwards from {-BACKWARD:g} m/s; held at rest against"
        f" {below:.3g} N, half of kinetic friction. A block that coasts forwards in steps ends with"
        " a velocity a little below zero, and there the errors of sign act. (6) to (10) hold a"
        " body at rest without limit, so that the push does not start it; as Table II has travels,"
        " we infer that the simulations had another rule for rest."
    )


def _rule_text(found: PaperAudit) -> str:
    """Say which equations a stick rule makes right, and in which tests."""
    parts = []
    for key in ("coast", "push"):
        right = [
            f"{one.form.equation} gives {significant(seen.with_rule.criteria.travel, 3)} m"
            for one in found.consequences
            if (seen := one.outcome(key)) is not None
            and seen.differs
            and not seen.with_rule.errs(seen.corrected)
        ]
        if right:
            parts.append(f"{TESTS[key]}, {joined(right)}")
    what = (
        "With a stick rule, which holds the block where its velocity changes sign and which none of"
        " the equations prints,"
    )
    return f"{what} {'; '.join(parts)}." if parts else f"{what} nothing changes."


def _values_table(found: PaperAudit) -> Table:
    """Show the values behind every number of the tests."""
    load = found.values.load
    columns = (
        Column(head="equation"),
        Column(head="values as printed", phone="label", label="as printed:"),
        Column(head="values of the corrected law", phone="label", label="corrected:"),
    )
    rows = tuple(
        Row(
            cells=(
                f"{one.form.equation} {one.form.title}",
                values_of(one.printed),
                Name(text=values_of(one.corrected, load), aside=one.corrected.title),
            )
        )
        for one in found.consequences
    )
    bare = [
        row.law.title
        for row in found.table
        if getattr(row.law, "viscous_coefficient", None) == 0.0
        and row.law.name in {one.corrected.name for one in found.consequences}
        and row.law.name != "dahl"
    ]
    other = (
        f" {joined(bare)} have $sigma_2$ here (assumed), so that the sgn of its term shows, and"
        " none in the table of the models above."
        if bare
        else ""
    )
    return Table(
        columns=columns,
        rows=rows,
        caption=f"The values behind the numbers above; bristles at a load of {quantity(load, 'N')}."
        f" The weight $W$ of (4) is that load.{other}",
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
    run, right = outcome.printed, significant(outcome.corrected.travel, 3)
    if run.diverged:
        when = with_unit(f"{1e3 * run.lasted:.3g}", "ms") if run.lasted else "one step"
        return Name(text=f"diverges in {when}", aside=f"not {right}")
    travel = significant(run.criteria.travel, 3)
    if not outcome.differs:
        return travel
    held = run.criteria.travel == 0.0
    return Name(text=travel, aside=f"held without limit; not {right}" if held else f"not {right}")
