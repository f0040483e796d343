"""Sections on the printed equations, on how the block is set in motion, and on all assumptions."""

import math
from collections.abc import Sequence

from stickslip.friction import PRINTED_EQUATIONS, LuGre, PrintedForm, RightEquation
from stickslip.paper.paper_audit import PaperAudit
from stickslip.paper.printed import (
    BACKWARD,
    BRISTLE_STEP,
    CART_STEP,
    CREEPING,
    FINE_STEP,
    HELD,
    SECONDS,
    STIFFNESS,
    TESTS,
    Outcome,
    lugre_row,
)
from stickslip.paper.printed import FINE_STEP as FINE
from stickslip.paper.rigs import CYCLES, KINETIC, PUSH_DURATION, SPEED, Excitation
from stickslip.paper.sections.common import (
    COLOURS,
    numbers,
    table,
    travel_axis,
    values_of,
)
from stickslip.show import report
from stickslip.show.formatting import (
    fixed,
    in_words,
    interval,
    joined,
    number,
    quantity,
    residue,
    signed_percent,
    significant,
    with_unit,
)
from stickslip.show.plots import EXCITATION_SIZES, draw_excitations, sketch

# The printed equations, their defects, and where these act.


def equation_section(found: PaperAudit) -> report.Section:
    """Show each equation as printed, what is wrong in it, what is right, and what is used here."""
    blocks: list[report.Block] = [
        report.Paragraph(
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
    blocks.append(report.Paragraph(text=_energy_text(found)))
    blocks += [report.Subheading(text="Symbols"), _symbol_table()]
    blocks += [report.Subheading(text="Values in the tests of the equations"), _values_table(found)]
    return report.Section(
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


def _symbol_table() -> report.Table:
    return report.table_of(["here", "meaning", "unit", "in the paper"], SYMBOLS)


def _shown(form: type[PrintedForm] | RightEquation) -> tuple[report.Block, ...]:
    right = "Right" if form.defect else "Right as printed"
    parts = {"Defect": form.defect, right: form.right, "Used here": form.cure}
    text = " ".join(f"**{key}**: {what}." for key, what in parts.items() if what)
    return (
        report.Subheading(text=f"{form.equation} {form.title}"),
        report.Math(latex=form.formula, tag=form.equation),
        report.Paragraph(text=text),
    )


def _energy_text(found: PaperAudit) -> str:
    """Say for which of the two springs eq. (11) holds."""
    release, attached = (found.table[0].reading(key).criteria for key in "BC")
    places = found.table[0].reading("C").run["x"]  # turning points among them
    way = float(abs(places[1:] - places[:-1]).sum())
    x = quantity(found.values.rig.compression, "m")
    return (
        f"With the coefficient of Table I and $x$ = {x} it gives"
        f" {fixed(release.travel, 3)} m. For a block that"
        f" stays fastened to its spring $s$ would be the length of its path, {fixed(way, 3)} m;"
        f" since that block returns, it ends at {fixed(attached.travel, 3)} m."
    )


def misprint_section(found: PaperAudit) -> report.Section:
    """Show where each defect acts, as printed and with a stick rule added."""
    errs = {key: sum(defect.differs(key) for defect in found.consequences) for key in TESTS}
    heading = (
        f"As printed, {in_words(errs['coast'])} equations err when the block coasts forwards,"
        f" {in_words(errs['push'])} when it is pushed from rest"
    )
    heads = ["equation", *(f"{what}\nm" for what in TESTS.values())]
    rows = [
        (f"{item.form.equation} {item.form.title}", *(_cell(item.outcome(key)) for key in TESTS))
        for item in found.consequences
    ]
    return report.Section(
        collapsed=True,
        id="misprints",
        nav="Where they act",
        heading=heading,
        blocks=(
            report.Paragraph(text=_tests_text(found)),
            report.table_of(heads, rows),
            report.Caption(
                text=(
                    f"Travel in {SECONDS:g} s, by Heun’s method in steps of"
                    f" {1e3 * FINE_STEP:g} ms ({1e3 * BRISTLE_STEP:g} ms with bristles), without a"
                    " stick rule. Below it, where the two differ by more than 1 mm and 1 %, that of"
                    " the corrected law, solved exactly. For a block, (4) equals (3). Viscous"
                    " friction has no entry in the last column. As text: `stickslip models"
                    " --published`."
                )
            ),
            report.Paragraph(text=_rule_text(found)),
        ),
    )


def _tests_text(found: PaperAudit) -> str:
    values = found.values
    below = HELD * values.mu_k * values.load
    return (
        f"Each equation as it stands, in four tests on the block of Table I: coasting"
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
            f"{consequence.form.equation} gives {significant(seen.with_rule.criteria.travel, 3)} m"
            for consequence in found.consequences
            if (seen := consequence.outcome(key)) is not None
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


def _values_table(found: PaperAudit) -> report.Table:
    """Show the values behind every number of the tests."""
    load = found.values.load
    bare = [
        row.law.title
        for row in found.table
        if getattr(row.law, "viscous_coefficient", None) == 0.0
        and row.law.name in {consequence.corrected.name for consequence in found.consequences}
        and row.law.name != "dahl"
    ]
    other = (
        f" {joined(bare)} have $sigma_2$ here (assumed), so that the sgn of its term shows, and"
        " none in the table of the models above."
        if bare
        else ""
    )
    text = (
        f"The values behind the numbers above; bristles at a load of {quantity(load, 'N')}. The"
        f" weight $W$ of (4) is that load.{other}"
    )
    rows = [
        (
            f"{item.form.equation} {item.form.title}",
            values_of(item.printed),
            report.Name(text=values_of(item.corrected, load), aside=item.corrected.title),
        )
        for item in found.consequences
    ]
    heads = ["equation", "values as printed", "values of the corrected law"]
    return report.table_of(heads, rows, text)


def _cell(outcome: Outcome | None) -> report.Name | str:
    if outcome is None:
        return "—"
    run, right = outcome.printed, significant(outcome.corrected.travel, 3)
    if run.diverged:
        when = with_unit(f"{1e3 * run.lasted:.3g}", "ms") if run.lasted else "one step"
        return report.Name(text=f"diverges in {when}", aside=f"not {right}")
    travel = significant(run.criteria.travel, 3)
    if not outcome.differs:
        return travel
    held = run.criteria.travel == 0.0
    return report.Name(
        text=travel, aside=f"held without limit; not {right}" if held else f"not {right}"
    )


# Three readings of how the block is set in motion.

SKETCHES = {"A": "push", "B": "released-spring", "C": "fixed-spring"}


def excitation_section(found: PaperAudit) -> report.Section:
    """Show three readings of one sentence of the paper, with the first law of its table."""
    row = found.table[0]
    mu_k = getattr(row.law, "kinetic_coefficient", 0.0)
    values = found.values
    force = f"{quantity(values.force, 'N')} for {PUSH_DURATION:g} s"
    text = (
        "Section IV has a compressed spring that is released, with $F$ = $K$$x$, and for"
        f" experiment and simulation alike a force of {force}. A released spring does not push"
        f" with a constant force. The compression, {values.rig.compression:g} m, follows from"
        f" {quantity(values.force, 'N')} and $K$. Both readings, and a control, with $mu_k$ ="
        f" {mu_k:g} and {row.law.title} friction:"
    )
    travels = {f"{reading.criteria.travel:.2f}" for reading in row.readings}
    return report.Section(
        id="excitation",
        nav="Three excitations",
        heading=f"Two readings of the rig and a control, {in_words(len(travels))} travels",
        blocks=(
            report.Paragraph(text=text),
            _sketches(row.readings),
            _figure(found, row.readings),
            _table(found, row.readings),
            _closed_forms(row.readings),
        ),
    )


def _sketches(readings: Sequence[Excitation]) -> report.Gallery:
    return report.Gallery(
        panels=tuple(
            report.Panel(
                svg=sketch(
                    SKETCHES[reading.key],
                    alt=f"Sketch of the rig: {reading.title}",
                    prefix=f"sketch-{reading.key.lower()}",
                ),
                title=f"{reading.key}. {reading.title}.",
                text=reading.text,
                colour=COLOURS[reading.key],
            )
            for reading in readings
        )
    )


def _figure(found: PaperAudit, readings: Sequence[Excitation]) -> report.Figure:
    values = found.values
    low, high = (found.measured + side * values.uncertainty for side in (-1.0, 1.0))
    draw = draw_excitations(
        {_label(r): r.run for r in readings},
        chosen=next(_label(r) for r in readings if r.key == "B"),
        band=(low, high),
        measured=f"measured, {found.measured:.2f} m",
    )
    alt = "Travel against time in the three readings of the rig"
    caption = f"**Travel in the two readings and the control.** {_band_text(found, low, high)}"
    return report.figure(draw, alt, "excitations", caption, EXCITATION_SIZES)


def _band_text(found: PaperAudit, low: float, high: float) -> str:
    """Say what the band around the measured travel is, where there is one."""
    if not high > low:
        return "Line: the measured travel, whose uncertainty is not stated."
    what = (
        f"the travels that round to {found.measured:.2f} m"
        if found.values.rounded
        else "the measured travel ± its standard uncertainty"
    )
    return f"Blue-grey band: {interval(low, high)} m, {what}."


def _table(found: PaperAudit, readings: Sequence[Excitation]) -> report.Table:
    travels = [reading.criteria.travel for reading in readings]
    axis = travel_axis(found, travels, "travel, m; line: measured")
    return table(
        readings,
        ("excitation", _label),
        (
            report.Column(head="travel\nm", numeric=True),
            lambda reading: report.Number(value=fixed(reading.criteria.travel, 3)),
        ),
        (report.Column(head="", axis=axis), lambda reading: report.RowPlot(marks=(_dot(reading),))),
        (
            numbers("error"),
            lambda reading: signed_percent(reading.criteria.relative_error or 0.0),
        ),
        (numbers("work put in\nJ"), lambda reading: fixed(reading.criteria.work_in, 3)),
        ("how it ends", _ending),
        chosen=lambda reading: reading.key == "B",
    )


def _label(reading: Excitation) -> str:
    return f"{reading.key}. {reading.title}"


def _dot(reading: Excitation) -> report.Mark:
    return report.Mark(kind="dot", at=reading.criteria.travel, colour=COLOURS[reading.key])


def _ending(reading: Excitation) -> str:
    """Say in words how a run ends."""
    seen = reading.criteria
    if seen.stop_time is None:
        return "still moves at the end"
    if seen.displacement_never_decreases:
        return f"stops at {seen.stop_time:.3f} s, stays"
    farthest = float(reading.run["x"].max())
    return f"turns at {farthest:.3f} m, ends at {seen.stop_time:.3f} s"


def _closed_forms(readings: Sequence[Excitation]) -> report.Caption:
    """Set the runs against the formulas."""
    known = {r: r.closed_form for r in readings if r.closed_form is not None}
    if not known:
        return report.Caption(
            text="No reading has a closed form here: the block stays with its spring."
        )
    off = max(abs(r.criteria.travel - travel) for r, travel in known.items())
    travels = ", ".join(f"{r.key} {travel:.7f} m" for r, travel in known.items())
    return report.Caption(
        text=f"Closed forms: {travels}; the simulated travels differ by {residue(off)} m at most."
    )


# All that is assumed on the page, in one table.


def assumption_section(found: PaperAudit) -> report.Section:
    """List every value that the page uses and the source does not print, with its origin."""
    rows = (*_rig_rows(found), *_law_rows(found), *_run_rows(found))
    return report.Section(
        collapsed=True,
        id="assumptions",
        nav="Assumptions",
        heading="What is assumed, and where it is used",
        blocks=(
            report.Paragraph(
                text="Every value on this page is one that Tables I and II and the text of the"
                " paper print, or stands in this table."
            ),
            report.table_of(["where", "value", "origin"], rows),
        ),
    )


def _rig_rows(found: PaperAudit) -> list[tuple[str, str, str]]:
    values = found.values
    rig, pushed = values.rig, f"{quantity(values.force, 'N')} for {PUSH_DURATION:g} s"
    return [
        ("block, gravity", quantity(rig.gravity, "m/s^2"), "not printed"),
        (
            "readings B and C, compression",
            quantity(rig.compression, "m"),
            "inferred from $F$ = $K$$x$ and 10 N",
        ),
        ("reading A", f"{pushed}, then coasting", "printed; that it coasts is inferred"),
        ("reading C", "the block stays fastened", "ours, a control"),
    ]


def _law_rows(found: PaperAudit) -> list[tuple[str, str, str]]:
    load = found.values.load
    rows = []
    for row in found.table:
        held = " held at its first stop" if getattr(row.law, "static_switch", False) else ""
        assumed = found.rig.assumed.get(row.law.name, ())
        origin = "Table I"
        if assumed:
            origin = (
                f"levels of Table I; {joined([name.replace('_', ' ') for name in assumed])} assumed"
            )
        if isinstance(row.law, LuGre):
            origin += "; $n$ not printed"
        rows.append(
            (f"models, {row.law.title}", f"{values_of(row.law, load)}{held and ','}{held}", origin)
        )
    return rows


def _run_rows(found: PaperAudit) -> list[tuple[str, str, str]]:
    values, cart, swing = found.values, found.cart.cart, found.cart.swing
    angle = f"{math.degrees(swing.amplitude):.0f}°"
    soft = lugre_row(values, STIFFNESS)
    return [
        (
            "printed equations",
            f"$sigma_2$ {significant(values.viscous, 2)} N s/m in (5), (8), (9) and (10), also"
            " where the models above have none; $n$ = 2 in (9)",
            "assumed",
        ),
        (
            "printed equations, tests",
            f"{-BACKWARD:g} m/s backwards; held against {HELD:g} $F_c$; steps of {1e3 * FINE:g} ms,"
            f" {1e3 * BRISTLE_STEP:g} ms with bristles; Heun’s method",
            "ours",
        ),
        (
            "spring-back, break-away with bristles",
            f"LuGre, {values_of(soft, values.load)}",
            "LuGre 1995, with the levels of the block",
        ),
        (
            "steps of 10 ms",
            f"{quantity(CART_STEP, 's')}, forward Euler",
            "the paper states the time for its cart, not the method",
        ),
        (
            "cart",
            f"{number(cart.cart_mass)} kg, ball {number(cart.ball_mass)} kg, rod"
            f" {number(cart.length)} m",
            "ours",
        ),
        (
            "cart, swing",
            f"−{angle} to {angle} and back, {number(swing.fast)}, −{number(swing.slow)},"
            f" {number(swing.fast)} rad/s², {CYCLES} cycles",
            "ours",
        ),
        (
            "unpublished values, LuGre",
            "$sigma_1$ the root of $sigma_0$, $sigma_2$ 0.4 N s/m, $v_s$ 1 mm/s, $n$ 2, nothing"
            " holds the block",
            "LuGre 1995",
        ),
        (
            "(5) in steps of 10 ms",
            f"$v_s$ {joined([significant(1e3 * value, 4) for value in CREEPING])} mm/s; sgn $v$"
            " added",
            "tried",
        ),
        ("cart, $mu_k$ = $mu_s$", f"{KINETIC:g}; Table I’s where said", "ours"),
        ("stick-slip, pulling speed", f"{1e3 * SPEED:g} mm/s", "ours"),
    ]
