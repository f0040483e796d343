"""Sections on Table II and on the figures, which are drawn again."""

from collections.abc import Mapping

from stickslip.engine.solver import BreakAway
from stickslip.friction import Stribeck
from stickslip.paper.paper_audit import PaperAudit, TableRow
from stickslip.paper.printed import Requirement
from stickslip.paper.rigs import PUSH_DURATION, SPEED
from stickslip.paper.sections.common import numbers, travel_axis
from stickslip.show import plots, report
from stickslip.show.formatting import (
    fixed,
    joined,
    number,
    percent,
    quantity,
    residue,
    signed_percent,
    significant,
    with_unit,
)

# The paper's Table II beside ours, and its criteria applied again.


def table_section(found: PaperAudit) -> report.Section:
    """Show every row of Table II beside ours in readings A and B, and the push in 10 ms steps."""
    text = (
        "A: the push, solved exactly, and in steps of 10 ms, the sample time that the paper states"
        " for its cart. B: the spring, solved exactly; C: it stays fastened. Levels are"
        " those of Table I; what the paper does not print is assumed:"
        f" {_assumptions(found)}. “Coulomb plus viscous plus static”, which the paper names, has no"
        " row in it."
    )
    if found.viscous_travels:
        titles = {row.law.name: row.law.title for row in found.table}
        travels = [f"{titles[name]} {fixed(x, 3)} m" for name, x in found.viscous_travels.items()]
        text += (
            " With the same viscous part, which (5) and (9) have too, the spring gives"
            f" {joined(travels)}: between the rows of B lies what is assumed, not the model."
        )
    return report.Section(
        id="table2",
        nav="Table II",
        heading=("The paper’s Table II beside ours"),
        blocks=(
            report.Paragraph(text=text),
            _table(found),
            report.Caption(text=_step_text(found)),
        ),
    )


def _assumptions(found: PaperAudit) -> str:
    """List the values that are not printed, in the paper's own terms."""
    values = found.values
    return (
        f"$sigma_2$ {quantity(values.viscous, 'N s/m', 2)} in Coulomb + viscous and none"
        f" in Stribeck and LuGre, $v_s$ {number(1e3 * values.stribeck_velocity)} mm/s,"
        f" bristles of {significant(values.stiffness, 2)} N/m and"
        f" {significant(values.damping, 2)} N s/m"
    )


RULES: Mapping[BreakAway, str] = {"zero": "sgn 0 = 0", "static": "from break-away"}
"""What the friction in the first step out of rest is called."""


def _table(found: PaperAudit) -> report.Table:
    travels = [row.published.travel or 0.0 for row in found.table]
    travels += [reading.criteria.travel for row in found.table for reading in row.readings]
    marks = "travel, m; triangle: A, dot: B, line: measured, ring: published"
    columns = (
        report.Column(head="friction model"),
        numbers("published\nm"),
        numbers("A, exact\nm", "A exact, m"),
        *(numbers(f"A, 10 ms\n{what}", f"10 ms, {what}") for what in RULES.values()),
        numbers("B, spring\nm"),
        numbers("C, fixed\nm"),
        report.Column(head="", axis=travel_axis(found, travels, marks)),
    )
    caption = (
        f"Below each travel its error against the measured {_metres(found)}. All runs hold the"
        " block at its first stop, by the paper’s switch to static friction."
    )
    return report.Table(
        columns=columns, rows=tuple(_row(found, row) for row in found.table), caption=caption
    )


def _row(found: PaperAudit, row: TableRow) -> report.Row:
    published = row.published.travel
    push, spring = (row.reading(key).criteria for key in ("A", "B"))
    marks = [
        report.Mark(kind="triangle", at=push.travel, colour="c2"),
        report.Mark(kind="dot", at=spring.travel, colour="c1"),
    ]
    if published is not None:
        marks.append(report.Mark(kind="ring", at=published, colour="muted"))
    return report.Row(
        cells=(
            report.Name(text=row.law.title, aside=row.published.note),
            _with_error(found, published, 2),
            _with_error(found, push.travel),
            *(_with_error(found, row.coarse.get(rule)) for rule in RULES),
            _with_error(found, spring.travel),
            _with_error(found, row.reading("C").criteria.travel),
            report.RowPlot(marks=tuple(marks), lanes=2),
        )
    )


def _with_error(found: PaperAudit, travel: float | None, digits: int = 4) -> report.Name | str:
    """Return a travel with its relative error below it."""
    if travel is None:
        return "—"
    return report.Name(
        text=fixed(travel, digits), aside=signed_percent(travel / found.measured - 1.0)
    )


def _step_text(found: PaperAudit) -> str:
    """Say what the columns of 10 ms are, and why bristle laws have no entry in them."""
    limits = [
        f"{quantity(row.largest_step, 's', 2)} ({row.law.title})"
        for row in found.table
        if not row.coarse and row.largest_step is not None
    ]
    text = (
        "Steps of 10 ms: forward Euler with a rule that holds the block where its velocity changes"
        " sign. In the first step out of rest there is no friction where sgn 0 = 0; by (5), and in"
        " Karnopp’s scheme [18], it begins at $F_s$."
    )
    if limits:
        text += f" The bristles assumed here need steps below {joined(limits)}."
    return text


def ranking_section(found: PaperAudit) -> report.Section:
    """Apply the paper's own criteria to its table and to ours, with our verdict beside."""
    keys = ("published", "A", "B")
    names = {"published": "published", "A": "A, push", "B": "B, spring"}
    judged = [f"{names[key]}: both\ncriteria, rank" for key in keys]
    heads = ["friction model", *judged, "by select"]
    rows = [
        (row.law.title, *(_judged(found, row, key) for key in keys), _ours(found, row))
        for row in found.table
    ]
    return report.Section(
        id="ranking",
        nav="Criteria",
        heading=_ranking_heading(found),
        blocks=(
            report.Paragraph(text=_criteria_text(found)),
            report.table_of(heads, rows),
            report.Caption(text=_caption(found)),
            report.Paragraph(text=_energy_text(found)),
        ),
    )


def _met(found: PaperAudit, key: str) -> int:
    return sum(
        seen.velocity_never_negative and seen.displacement_never_decreases
        for seen in (row.reading(key).criteria for row in found.table)
    )


def _ranking_heading(found: PaperAudit) -> str:
    total, keys = len(found.table), ("A", "B")
    met = [_met(found, key) for key in keys]
    if all(count == total for count in met):
        return "Every exact run that holds the block meets both criteria of the paper"
    return "The two criteria of the paper, applied to our runs"


def _judged(found: PaperAudit, row: TableRow, key: str) -> str:
    """Return the rank of a law by the criteria, or which of them it fails."""
    rank = found.ranking(key).get(row.law.name)
    if rank is not None:
        return f"met, {rank}"
    if key == "published":
        return "—" if row.published.travel is None else "velocity negative"
    seen = row.reading(key).criteria
    return f"fails: goes back {quantity(seen.largest_return, 'm', 2)}"


def _criteria_text(found: PaperAudit) -> str:
    """Say what the criteria reject among our runs, and that this is physical for bristles."""
    backs = [
        f"{back.law.title} {significant(1e3 * back.criteria.least_velocity, 2)} mm/s and"
        f" {quantity(back.criteria.largest_return, 'm', 2)}"
        for back in found.springbacks
    ]
    free = next(row for row in found.fixed_steps if row.dt is not None and not row.stick_rule)
    return (
        "The velocity never becomes negative, and the displacement never decreases; of the models"
        " that meet both, the least relative error decides. What fails is, first, bristles of"
        f" 10⁵ N/m that nothing holds ({joined(backs)} backwards): they are springs, and to spring"
        f" back is physical.{_soft_text(found)} Second, fixed steps without a rule for rest: in"
        f" {1e3 * (free.dt or 0.0):g} ms the velocity changes its sign {free.reversals} times in"
        f" 1 s and reaches {significant(1e3 * free.criteria.least_velocity, 2)} mm/s. The criteria"
        " alone tell neither from a body that is really driven back."
    )


def _ours(found: PaperAudit, row: TableRow) -> str:
    """Say what selection makes of a law: one travel, one value that reproduces it."""
    named = [candidate for candidate in found.verdict.candidates if candidate.name == row.law.name]
    if not named:
        return "not tried"
    fit = named[0].fit
    if fit is None or not fit.estimates:
        return "no value reproduces the travel"
    estimate = fit.estimates[0]
    symbol, value = estimate.quantity.symbol, significant(estimate.value, 3)
    return f"${symbol}$ = {value} reproduces the travel"


def _caption(found: PaperAudit) -> str:
    errors = sorted(abs(row.reading("B").criteria.relative_error or 0.0) for row in found.table)
    half = found.values.uncertainty / found.measured
    return (
        f"In B the first four errors are {percent(errors[0])} to {percent(errors[3])}, and the"
        f" measured travel is rounded to ± {percent(half)}: their order means nothing."
    )


def _soft_text(found: PaperAudit) -> str:
    """Grant that the run which gives the published row of LuGre is rightly rejected."""
    need = found.requirement("lugre")
    if need is None or need.value is None or need.criteria is None:
        return ""
    values = found.values
    bent = values.mu_s * values.load / need.value
    return (
        f" The run that gives the published {need.published:.2f} m of LuGre, with bristles of"
        f" {significant(need.value, 3)} N/m, goes back by"
        f" {quantity(need.criteria.largest_return, 'm', 2)} and bends by"
        f" $F_s$/$sigma_0$ = {quantity(bent, 'm', 2)} at break-away, where the paper describes a"
        " very tiny displacement: to reject it is right, and speaks against the value."
    )


def _energy_text(found: PaperAudit) -> str:
    """Answer the step from (11) to a choice by travel: what follows from it, and what does not."""
    work = 0.5 * found.values.rig.stiffness * found.values.rig.compression**2
    return (
        "From (11) the paper concludes that the displacement is unique for given parameters and"
        " can therefore select the model. The first is right. The second needs parameters from"
        " elsewhere: (11) holds for every law with its mean friction along the path, which the"
        f" travel fixes at {quantity(work, 'J')} / {_metres(found)} ="
        f" {quantity(work / found.measured, 'N')}, and with it one value in each law. Travels from"
        " several compressions tell models apart: $s$ grows as $x$² under Coulomb friction, as $x$"
        " under viscous friction."
    )


def _metres(found: PaperAudit) -> str:
    return f"{found.measured:.2f} m"


# The paper's figures, drawn again under its captions.

RUN_FIGURES = {"coulomb": 6, "dahl": 7, "stribeck": 8, "lugre": 9, "coulomb-viscous": 10}
"""Numbers of the figures that show the block, by the law that their captions name."""
BLOCK_SIZES = plots.Sizes(wide=(880, 270), narrow=(358, 520))


def schematic_section(found: PaperAudit) -> report.Section:
    """Return Figs 1 and 5: cart and rig with the paper's symbols."""
    values = found.values
    return report.Section(
        collapsed=True,
        id="systems",
        nav="Figs 1 and 5",
        heading="The two systems of the paper",
        blocks=(
            report.Columns(
                left=(
                    report.Figure(
                        svg=plots.schematic(
                            "cart",
                            alt="Cart of mass M with an inverted pendulum of length l and ball m",
                            prefix="fig1",
                        ),
                        caption="**Fig. 1. Pendulum-driven cart.** Mass $M$, ball $m$ on a rod of"
                        " length $l$, angle $theta$ from the vertical, displacement $x$, torque"
                        " $tau$, friction coefficient $mu$. The paper prints no values.",
                    ),
                ),
                right=(
                    report.Figure(
                        svg=plots.schematic(
                            "rig",
                            alt="Steel block of mass m before a compressed spring of stiffness k",
                            prefix="fig5",
                        ),
                        caption="**Fig. 5. Spring and steel block.** By Table I"
                        f" $M$ = {values.rig.mass:g} kg, $K$ = {values.rig.stiffness:g} N/m,"
                        f" $mu_d$ = {values.mu_k:g}, $mu_s$ = {values.mu_s:g}; $x$ is the"
                        f" compression, $s$ the travel, measured as {found.measured:.2f} m.",
                    ),
                ),
            ),
        ),
    )


def phenomena_section(found: PaperAudit) -> report.Section:
    """Return stick-slip and Figs 3 and 4: the phenomena of friction that the paper reviews."""
    pulled = found.stick_slip
    assert pulled is not None  # of the rig of the paper
    error = max(
        abs(pulled.stick_time / pulled.stick_formula - 1.0),
        abs(pulled.slip_time / pulled.slip_formula - 1.0),
    )
    printed = [row.law for row in found.table if row.published.travel is not None]
    laws = {law.title: law for law in printed}
    bristle = {title: law for title, law in laws.items() if law.states}
    load = found.values.load
    figures = [
        report.figure(
            plots.draw_run(pulled.run, until=pulled.run.span[1]),
            "Displacement, velocity and friction of a block in stick-slip",
            "stick-slip",
            "**III.B.1, stick-slip motion.** The block of Table I, pulled through its spring at"
            f" {1e3 * SPEED:g} mm/s (ours). It sticks for {pulled.stick_time:.3f} s and slips"
            f" for {pulled.slip_time:.3f} s, as the closed forms have it within a relative"
            f" {residue(error)}.",
            plots.RUN_SIZES,
        )
    ]
    curve = next((law for law in laws.values() if isinstance(law, Stribeck)), None)
    if curve is not None:
        figures.append(
            report.figure(
                plots.draw_stribeck(curve, load),
                "Stribeck curve with static level, Coulomb level and Stribeck velocity",
                "fig3",
                "**Fig. 3. Stribeck effect.** $F_s$ and $F_c$ by Table I; $v_s$ is not printed, and"
                " assumed here. The vertical line is what the contact holds at rest.",
                {"wide": (880, 280), "narrow": (358, 260)},
            )
        )
    figures += [
        report.figure(
            plots.draw_presliding(bristle, load=load),
            "Friction force against displacement before slip",
            "fig4",
            "**Fig. 4. Presliding displacement**: friction against a slow displacement to and fro,"
            " before slip and at its onset. The paper shows the measurement of its reference [13];"
            " these are the corrected Dahl and LuGre laws.",
            plots.presliding_sizes(len(bristle)),
        ),
        report.figure(
            plots.draw_characteristics(laws, load=load, v_max=0.5),
            "Friction force against slip velocity of the five models",
            "laws-of-table2",
            "**The laws of Table II** against velocity, corrected. At rest, any force up to"
            " break-away; for bristle laws, the curve of steady sliding.",
            plots.characteristic_sizes(len(laws)),
        ),
    ]
    return report.Section(
        collapsed=True,
        id="phenomena",
        nav="Phenomena, Figs 3, 4",
        heading="Stick-slip, Stribeck effect and presliding, recomputed",
        blocks=tuple(figures),
    )


def figure_section(found: PaperAudit) -> report.Section:
    """Return Figs 6 to 10, the block with each law, in the order of the paper."""
    rows = {row.law.name: row for row in found.table}
    figures = [
        _run_figure(found, rows[name], number)
        for name, number in RUN_FIGURES.items()
        if name in rows
    ]
    text = (
        "The block in readings A and B with the values assumed for Table II, and a third run with"
        " the value that gives the published travel. Dashed: the published and the measured travel."
    )
    return report.Section(
        collapsed=True,
        id="figures",
        nav="Figs 6 to 10",
        heading="The block with each law, recomputed",
        blocks=(report.Paragraph(text=text), *figures),
    )


def _run_figure(found: PaperAudit, row: TableRow, number: int) -> report.Figure:
    shown = [row.reading(key) for key in ("B", "A")]
    runs = {f"{reading.key}. {reading.title}": reading.run for reading in shown}
    need = found.requirement(row.law.name)
    if need is not None and need.run is not None:
        runs[_need_label(need, row, plots.symbol_label(need.symbol))] = need.run
    if row.law.name == "stribeck" and found.creeps:
        creep = found.creeps[len(found.creeps) // 2]
        velocity = f"{significant(1e3 * creep.stribeck_velocity, 4)} mm/s"
        runs[f"(5) in 10 ms, {plots.symbol_label('v_s')} = {velocity}"] = creep.run
    published = row.published.travel
    travels = [f"{r.key} {r.criteria.travel:.3f} m" for r in reversed(shown)]
    note = f" ({row.published.note})" if row.published.note else ""
    levels = {} if published is None else {f"published, {published:.2f} m": published}
    printed = "" if published is None else f"Published travel {published:.2f} m{note}; ours "
    title = f"Fig. {number}. {row.law.title}"
    levels |= {f"measured, {found.measured:.2f} m": found.measured}
    return report.figure(
        plots.draw_motion(runs, levels=levels),
        f"Displacement and velocity of the block with {row.law.title} friction",
        f"fig{number}",
        f"**{title}.** {printed}{', '.join(travels)}.{_need_text(found, need, row)}",
        BLOCK_SIZES,
    )


def _need_label(need: Requirement, row: TableRow, symbol: str) -> str:
    """Name the run that gives the published travel, with its symbol as it is to be set."""
    solution, unit = need.solution, "" if need.unit == "1" else f" {need.unit}"
    other = solution is not None and solution.name != row.law.name
    model = f"{solution.title.lower()}, " if other and solution is not None else ""
    return f"{need.reading}, {model}{symbol} = {significant(need.value or 0.0, 3)}{unit}"


def _need_text(found: PaperAudit, need: Requirement | None, row: TableRow) -> str:
    """Say what gives the published travel, how the block then stops, and what it would take."""
    if need is None or need.criteria is None or need.run is None:
        return ""
    done, last = need.criteria, need.run.span[1]
    if not done.displacement_never_decreases:
        lowest = with_unit(significant(1e3 * done.least_velocity, 2), "mm/s")
        how = (
            f"the velocity falls to {lowest} and the block goes back by"
            f" {quantity(done.largest_return, 'm', 2)}, in kind as the paper describes. Nothing"
            " holds the block in this run; held as soon as it stops, by the switch of (9), it could"
            " not go back. In fixed steps the velocity may pass zero without being zero, and the"
            " switch not act"
        )
    elif done.stop_time is not None:
        how = f"the block stops at {done.stop_time:.2f} s"
    else:
        left = residue(float(need.run.at([last])["v"][0]))
        how = f"the block creeps there, and moves at {left} m/s after {last:g} s"
    label = _need_label(need, row, f"${need.symbol}$")
    said = f" {label}: {fixed(done.travel, 2)} m; {how}."
    return said if need.kept else f"{said}{_least_friction(found, row)}"


def _least_friction(found: PaperAudit, row: TableRow) -> str:
    """Say why (5) does not reach its travel when solved exactly, and how it can in steps."""
    values, published = found.values, row.published.travel or 0.0
    rig, level = values.rig, values.mu_k * values.load
    impulse = values.force * PUSH_DURATION
    most = max(0.5 * rig.stiffness * rig.compression**2, 0.5 * impulse**2 / rig.mass)
    mean = most / published
    if not isinstance(row.law, Stribeck) or mean >= level:
        return ""
    return (
        f" Solved exactly, (5) with Table I cannot give it: neither excitation puts in more than"
        f" {quantity(most, 'J')}, so that the mean friction over {published:.2f} m is at most"
        f" {quantity(mean, 'N', 2)}, {percent(mean / level)} of $F_c$ = {quantity(level, 'N', 3)},"
        " below which (5) never falls forwards. In steps of 10 ms without a rule for rest it can,"
        " as said above: the fourth curve is one such run, with sgn $v$ added."
    )
