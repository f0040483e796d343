"""The audit of the paper as a page, and what it adds to the page of its rig."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import Literal, NamedTuple, TypeVar

import numpy as np

from stickslip.data import Rig, load_rig
from stickslip.engine.solver import BreakAway
from stickslip.engine.trajectory import Trajectory
from stickslip.friction import (
    PRINTED_EQUATIONS,
    SOURCES,
    FrictionLaw,
    LuGre,
    PrintedForm,
    RightEquation,
    Stribeck,
)
from stickslip.identify.kinds import TravelVerdict
from stickslip.paper import printed, rigs
from stickslip.paper.paper_audit import PaperAudit, TableRow, audit
from stickslip.quantities import fields_of
from stickslip.show import plots, report
from stickslip.show.formatting import (
    fixed,
    in_words,
    interval,
    joined,
    number,
    percent,
    quantity,
    residue,
    signed_percent,
    significant,
    with_unit,
)
from stickslip.show.plots import EXCITATION_SIZES, draw_excitations, sketch
from stickslip.show.report import Name, Section, Table, figure, table_of

# What the sections share.

T = TypeVar("T")

COLOURS: dict[str, Literal["c1", "c2", "c3", "c4"]] = {"A": "c2", "B": "c1", "C": "c3"}
"""Colour of each reading of the rig."""
PER_LOAD = ("bristle_stiffness", "bristle_damping")
"""Parameters that a law has over the load, and a printed equation as they are."""
STEPS = (1.0, 2.0, 2.5, 5.0, 10.0)
"""Ends of axes, times a power of ten."""


def numbers(head: str, label: str = "") -> report.Column:
    """Return a column of numbers, which on a phone have a label: the head, or a shorter one."""
    return report.Column(head=head, numeric=True, phone="label", label=label)


FIRST_CYCLE = "first cycle\nmm"
LOWEST_VELOCITY = "lowest velocity\nmm/s"
BACK_SLIP = "back-slip\nmm/cycle"
"""Heads of the tables of the cart."""


def table(
    items: Iterable[T],
    *columns: tuple[str | report.Column, Callable[[T], report.Cell]],
    caption: str = "",
    chosen: Callable[[T], bool] = lambda _: False,
) -> Table:
    """Return a table with a row for each item; each column stands beside what makes its cells."""
    heads = [
        report.Column(head=column) if isinstance(column, str) else column for column, _ in columns
    ]
    rows = [
        report.Row(cells=tuple(cell(item) for _, cell in columns), chosen=chosen(item))
        for item in items
    ]
    return Table(columns=tuple(heads), rows=tuple(rows), caption=caption)


def values_of(law: FrictionLaw | PrintedForm, load: float | None = None) -> str:
    """List the parameters that a law has, as symbols with values and units."""
    parts = []
    for name, field in fields_of(type(law)).items():
        value, unit = getattr(law, name), field.unit
        if load is not None and name in PER_LOAD and isinstance(law, FrictionLaw):
            value, unit = value * load, {"1/m": "N/m", "s/m": "N s/m"}.get(unit, unit)
        plain = name.endswith("exponent") and value == 1.0 and law.name != "stribeck"
        if value is not None and not isinstance(value, bool) and not plain:
            parts.append(f"${field.symbol}$ {quantity(value, unit)}")
    return ", ".join(parts)


def travel_axis(audit: PaperAudit, travels: Iterable[float], caption: str) -> report.Axis:
    """Return the travel axis of the tables, with the measured travel as its line."""
    most = max((*travels, audit.measured))
    power = 10.0 ** math.floor(math.log10(most))
    high = next(step * power for step in STEPS if step * power >= most)
    return report.Axis(
        low=0.0,
        high=high,
        ticks=(0.0, 0.4 * high, 0.8 * high),
        reference=audit.measured,
        caption=caption,
    )


def section(
    place: str, nav: str, heading: str, *content: report.Block | str, collapsed: bool = True
) -> Section:
    """Return a section with an address on the page; a text is a paragraph of it."""
    shown = (report.Paragraph(text=part) if isinstance(part, str) else part for part in content)
    return Section(id=place, nav=nav, heading=heading, blocks=tuple(shown), collapsed=collapsed)


def milli(value: float, digits: int = 3) -> str:
    """Return a length or a velocity in thousandths of its unit, without this."""
    return significant(1e3 * value, digits)


def back_slip_text(way: float) -> str:
    """Return a cell of `BACK_SLIP`."""
    return "none" if way == 0.0 else milli(way, 2)


# Sections on Table II and on the figures, which are drawn again.

# The paper's Table II beside ours, and its criteria applied again.


def table_section(found: PaperAudit) -> Section:
    """Show every row of Table II beside ours in readings A and B, and the push in 10 ms steps."""
    values = found.values
    text = (
        "A: the push, solved exactly, and in steps of 10 ms, the sample time that the paper states"
        " for its cart. B: the spring, solved exactly; C: it stays fastened. Levels are those of"
        " Table I; what the paper does not print is assumed: $sigma_2$"
        f" {quantity(values.viscous, 'N s/m', 2)} in Coulomb + viscous and none in Stribeck and"
        f" LuGre, $v_s$ {number(1e3 * values.stribeck_velocity)} mm/s, bristles of"
        f" {significant(values.stiffness, 2)} N/m and {significant(values.damping, 2)} N s/m."
        " “Coulomb plus viscous plus static”, which the paper names, has no row in it."
    )
    if found.viscous_travels:
        titles = {row.law.name: row.law.title for row in found.table}
        travels = [f"{titles[name]} {fixed(x, 3)} m" for name, x in found.viscous_travels.items()]
        text += (
            " With the same viscous part, which (5) and (9) have too, the spring gives"
            f" {joined(travels)}: between the rows of B lies what is assumed, not the model."
        )
    heading = "The paper’s Table II beside ours"
    shown = _table(found), report.Caption(text=_step_text(found))
    return section("table2", "Table II", heading, text, *shown, collapsed=False)


RULES: Mapping[BreakAway, str] = {"zero": "sgn 0 = 0", "static": "from break-away"}
"""What the friction in the first step out of rest is called."""


def _table(found: PaperAudit) -> Table:
    travels = [row.published.travel or 0.0 for row in found.table]
    travels += [reading.criteria.travel for row in found.table for reading in row.readings]
    marks = "travel, m; triangle: A, dot: B, line: measured, ring: published"

    def travel(key: str) -> Callable[[TableRow], report.Cell]:
        return lambda row: _with_error(found, row.travel(key))

    def in_steps(rule: BreakAway) -> Callable[[TableRow], report.Cell]:
        return lambda row: _with_error(found, row.coarse.get(rule))

    return table(
        found.table,
        ("friction model", lambda row: Name(text=row.law.title, aside=row.published.note)),
        (numbers("published\nm"), lambda row: _with_error(found, row.published.travel, 2)),
        (numbers("A, exact\nm", "A exact, m"), travel("A")),
        *(
            (numbers(f"A, 10 ms\n{what}", f"10 ms, {what}"), in_steps(rule))
            for rule, what in RULES.items()
        ),
        (numbers("B, spring\nm"), travel("B")),
        (numbers("C, fixed\nm"), travel("C")),
        (report.Column(head="", axis=travel_axis(found, travels, marks)), _travel_plot),
        caption=(
            f"Below each travel its error against the measured {_metres(found)}. All runs hold the"
            " block at its first stop, by the paper’s switch to static friction."
        ),
    )


def _travel_plot(row: TableRow) -> report.RowPlot:
    marks = [
        report.Mark(kind="triangle", at=row.travel("A"), colour="c2"),
        report.Mark(kind="dot", at=row.travel("B"), colour="c1"),
    ]
    if row.published.travel is not None:
        marks.append(report.Mark(kind="ring", at=row.published.travel, colour="muted"))
    return report.RowPlot(marks=tuple(marks), lanes=2)


def _with_error(found: PaperAudit, travel: float | None, digits: int = 4) -> Name | str:
    """Return a travel with its relative error below it."""
    if travel is None:
        return "—"
    return Name(text=fixed(travel, digits), aside=signed_percent(travel / found.measured - 1.0))


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


def ranking_section(found: PaperAudit) -> Section:
    """Apply the paper's own criteria to its table and to ours, with our verdict beside."""
    names = {"published": "published", "A": "A, push", "B": "B, spring"}
    judged = [f"{name}: both\ncriteria, rank" for name in names.values()]
    rows = [
        (row.law.title, *(_judged(found, row, key) for key in names), _ours(found, row))
        for row in found.table
    ]
    heading = "The two criteria of the paper, applied to our runs"
    if all(row.holds(key) for row in found.table for key in "AB"):
        heading = "Every exact run that holds the block meets both criteria of the paper"
    errors = sorted(abs(row.reading("B").criteria.relative_error or 0.0) for row in found.table)
    half = found.values.uncertainty / found.measured
    caption = (
        f"In B the first four errors are {percent(errors[0])} to {percent(errors[3])}, and the"
        f" measured travel is rounded to ± {percent(half)}: their order means nothing."
    )
    shown = table_of(["friction model", *judged, "by select"], rows), report.Caption(text=caption)
    texts = _criteria_text(found), *shown, _energy_text(found)
    return section("ranking", "Criteria", heading, *texts, collapsed=False)


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
        f"{back.law.title} {milli(back.criteria.least_velocity, 2)} mm/s and"
        f" {quantity(back.criteria.largest_return, 'm', 2)}"
        for back in found.springbacks
    ]
    free = found.without_rule
    return (
        "The velocity never becomes negative, and the displacement never decreases; of the models"
        " that meet both, the least relative error decides. What fails is, first, bristles of"
        f" 10⁵ N/m that nothing holds ({joined(backs)} backwards): they are springs, and to spring"
        f" back is physical.{_soft_text(found)} Second, fixed steps without a rule for rest: in"
        f" {1e3 * (free.dt or 0.0):g} ms the velocity changes its sign {free.reversals} times in"
        f" 1 s and reaches {milli(free.criteria.least_velocity, 2)} mm/s. The criteria"
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


def schematic_section(found: PaperAudit) -> Section:
    """Return Figs 1 and 5: cart and rig with the paper's symbols."""
    values = found.values
    cart = report.Figure(
        svg=plots.schematic(
            "cart",
            alt="Cart of mass M with an inverted pendulum of length l and ball m",
            prefix="fig1",
        ),
        caption="**Fig. 1. Pendulum-driven cart.** Mass $M$, ball $m$ on a rod of"
        " length $l$, angle $theta$ from the vertical, displacement $x$, torque"
        " $tau$, friction coefficient $mu$. The paper prints no values.",
    )
    rig = report.Figure(
        svg=plots.schematic(
            "rig",
            alt="Steel block of mass m before a compressed spring of stiffness k",
            prefix="fig5",
        ),
        caption="**Fig. 5. Spring and steel block.** By Table I"
        f" $M$ = {values.rig.mass:g} kg, $K$ = {values.rig.stiffness:g} N/m,"
        f" $mu_d$ = {values.mu_k:g}, $mu_s$ = {values.mu_s:g}; $x$ is the"
        f" compression, $s$ the travel, measured as {_metres(found)}.",
    )
    sides = report.Columns(left=(cart,), right=(rig,))
    return section("systems", "Figs 1 and 5", "The two systems of the paper", sides)


def phenomena_section(found: PaperAudit) -> Section:
    """Return stick-slip and Figs 3 and 4: the phenomena of friction that the paper reviews."""
    pulled = found.stick_slip
    assert pulled is not None  # of the rig of the paper
    error = max(
        abs(pulled.stick_time / pulled.stick_formula - 1.0),
        abs(pulled.slip_time / pulled.slip_formula - 1.0),
    )
    laws = {row.law.title: row.law for row in found.table if row.published.travel is not None}
    bristle = {title: law for title, law in laws.items() if law.states}
    load = found.values.load
    figures = [
        figure(
            plots.draw_run(pulled.run, until=pulled.run.span[1]),
            "Displacement, velocity and friction of a block in stick-slip",
            "stick-slip",
            "**III.B.1, stick-slip motion.** The block of Table I, pulled through its spring at"
            f" {1e3 * rigs.SPEED:g} mm/s (ours). It sticks for {pulled.stick_time:.3f} s and slips"
            f" for {pulled.slip_time:.3f} s, as the closed forms have it within a relative"
            f" {residue(error)}.",
            plots.RUN_SIZES,
        )
    ]
    curve = next((law for law in laws.values() if isinstance(law, Stribeck)), None)
    if curve is not None:
        figures.append(
            figure(
                plots.draw_stribeck(curve, load),
                "Stribeck curve with static level, Coulomb level and Stribeck velocity",
                "fig3",
                "**Fig. 3. Stribeck effect.** $F_s$ and $F_c$ by Table I; $v_s$ is not printed, and"
                " assumed here. The vertical line is what the contact holds at rest.",
                {"wide": (880, 280), "narrow": (358, 260)},
            )
        )
    figures += [
        figure(
            plots.draw_presliding(bristle, load=load),
            "Friction force against displacement before slip",
            "fig4",
            "**Fig. 4. Presliding displacement**: friction against a slow displacement to and fro,"
            " before slip and at its onset. The paper shows the measurement of its reference [13];"
            " these are the corrected Dahl and LuGre laws.",
            plots.presliding_sizes(len(bristle)),
        ),
        figure(
            plots.draw_characteristics(laws, load=load, v_max=0.5),
            "Friction force against slip velocity of the five models",
            "laws-of-table2",
            "**The laws of Table II** against velocity, corrected. At rest, any force up to"
            " break-away; for bristle laws, the curve of steady sliding.",
            plots.characteristic_sizes(len(laws)),
        ),
    ]
    heading = "Stick-slip, Stribeck effect and presliding, recomputed"
    return section("phenomena", "Phenomena, Figs 3, 4", heading, *figures)


def figure_section(found: PaperAudit) -> Section:
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
    return section("figures", "Figs 6 to 10", "The block with each law, recomputed", text, *figures)


def _run_figure(found: PaperAudit, row: TableRow, number: int) -> report.Figure:
    shown = [row.reading(key) for key in ("B", "A")]
    runs = {f"{reading.key}. {reading.title}": reading.run for reading in shown}
    need = found.requirement(row.law.name)
    if need is not None and need.run is not None:
        runs[_need_label(need, row, plots.symbol_label(need.symbol))] = need.run
    if row.law.name == "stribeck" and found.creeps:
        creep = found.creeps[len(found.creeps) // 2]
        velocity = f"{milli(creep.stribeck_velocity, 4)} mm/s"
        runs[f"(5) in 10 ms, {plots.symbol_label('v_s')} = {velocity}"] = creep.run
    published = row.published.travel
    travels = [f"{r.key} {r.criteria.travel:.3f} m" for r in reversed(shown)]
    note = f" ({row.published.note})" if row.published.note else ""
    levels = {} if published is None else {f"published, {published:.2f} m": published}
    quoted = "" if published is None else f"Published travel {published:.2f} m{note}; ours "
    title = f"Fig. {number}. {row.law.title}"
    levels |= {f"measured, {found.measured:.2f} m": found.measured}
    return figure(
        plots.draw_motion(runs, levels=levels),
        f"Displacement and velocity of the block with {row.law.title} friction",
        f"fig{number}",
        f"**{title}.** {quoted}{', '.join(travels)}.{_need_text(found, need, row)}",
        BLOCK_SIZES,
    )


def _need_label(need: printed.Requirement, row: TableRow, symbol: str = "") -> str:
    """Name the run that gives the published travel, with its symbol as it is to be set."""
    solution = need.solution
    other = solution is not None and solution.name != row.law.name
    model = f"{solution.title.lower()}, " if other and solution is not None else ""
    return f"{need.reading}, {model}{_setting(need, symbol)}"


def _need_text(found: PaperAudit, need: printed.Requirement | None, row: TableRow) -> str:
    """Say what gives the published travel, how the block then stops, and what it would take."""
    if need is None or need.criteria is None or need.run is None:
        return ""
    done, last = need.criteria, need.run.span[1]
    if not done.displacement_never_decreases:
        lowest = with_unit(milli(done.least_velocity, 2), "mm/s")
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
    said = f" {_need_label(need, row)}: {fixed(done.travel, 2)} m; {how}."
    return said if need.kept else f"{said}{_least_friction(found, row)}"


def _least_friction(found: PaperAudit, row: TableRow) -> str:
    """Say why (5) does not reach its travel when solved exactly, and how it can in steps."""
    values, published = found.values, row.published.travel or 0.0
    rig, level = values.rig, values.mu_k * values.load
    impulse = values.force * rigs.PUSH_DURATION
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


# Sections on what the paper claims and on what it does not print.

# What the parameters that the paper does not print would have to be.


def unpublished_section(found: PaperAudit) -> Section:
    """Show the value behind each published row with its range, for a push and for a spring."""
    total = in_words(sum(row.published.travel is not None for row in found.table))
    needs = {(need.law, need.reading): need for need in found.requirements}
    heads = ["row", "published\nm", "A, push: would need", "B, spring: would need"]
    rows = [
        (
            row.law.title,
            fixed(row.published.travel or 0.0, 2),
            *(_value(needs[row.law.name, key]) for key in "AB"),
            needs[row.law.name, "A"].text,
        )
        for row in found.table
        if (row.law.name, "A") in needs
    ]
    steps = found.step_travels
    reached = in_words(sum(travel.reached for travel in steps))
    return section(
        "unpublished",
        "Unpublished values",
        f"With Table I kept, unpublished values can give {in_words(found.reached('A'))} of the"
        f" {total} travels for the push and {in_words(found.reached('B'))} for the spring",
        "Found by root finding, solved exactly; under each value the range for travels that round"
        " to the printed figure. That a value gives the row does not show that it was used.",
        table_of([*heads, "what that means"], rows),
        report.Subheading(
            text=f"In steps of 10 ms, {reached} of {in_words(len(steps))}, Table I kept"
        ),
        _step_table(found),
        collapsed=False,
    )


def trial_section(found: PaperAudit) -> Section:
    """Show the runs behind the values for (5) in steps and for bristles."""
    return section(
        "trials",
        "(5) in steps, bristles",
        "The 0.45 m of Stribeck in steps, and travels by stiffness of the bristles",
        _creep_text(found),
        _creep_table(found),
        report.Subheading(text="By stiffness of the bristles"),
        _bristle_table(found),
    )


def _step_table(found: PaperAudit) -> Table:
    """Show what steps of 10 ms make of the push, by the friction in the first step."""
    titles = {row.law.name: row.law.title for row in found.table}
    rows = []
    for step in found.step_travels:
        # Where sgn 0 = 0, and where friction begins at the break-away level.
        cells = fixed(step.travel, 3), fixed(step.static, 3)
        values = values_of(step.law, found.values.load)
        if step.scatter is not None:
            cells = "—", f"{fixed(step.scatter[0], 2)} to {fixed(step.scatter[1], 2)}"
            values = f"(5), sgn $v$ added, no rule for rest; {values_of(step.law)}"
        rows.append((titles[step.row], fixed(step.published, 2), *cells, values))
    caption = (
        "The push by forward Euler in the sample time that the paper states for its cart. The 0.16"
        " m of both Coulomb rows need sgn 0 = 0 in the first step; bristles have no such step."
        " Which of these it was cannot be told from the paper."
    )
    heads = ["row", "published\nm", "sgn 0 = 0\nm", "from break-away\nm", "with"]
    return table_of(heads, rows, caption)


def _creep_text(found: PaperAudit) -> str:
    """Say how (5) reaches its printed travel in steps, and what speaks against it."""
    least = min(creep.least_velocity for creep in found.creeps)
    return (
        "As printed, (5) diverges once the velocity is negative. With the sgn $v$ that it lacks,"
        " friction backwards exceeds $F_s$, so that in steps of 10 ms each step back is followed by"
        " a larger one forwards, and the block creeps on. That agrees with the remark on Fig. 8"
        " that the velocity does not become exactly zero; the Yes of Table II does not, since it"
        f" falls to {milli(least, 2)} mm/s again and again. The creep is chaotic: $v_s$ that differ"
        " by 10⁻⁹ of themselves give the scatter, whose digits differ between computers."
    )


def _creep_table(found: PaperAudit) -> Table:
    speed = number(1e3 * found.values.stribeck_velocity)
    caption = (
        "Travel of the push after 10 s; the rule for rest holds the block where its velocity"
        f" changes sign, and friction begins at $F_s$. Table II has $v_s$ = {speed} mm/s."
    )
    heads = [
        "Stribeck velocity",
        "10 ms, no rule\nmean, m",
        "scatter\nm",
        "10 ms, rule\nfor rest, m",
        "1 ms, no rule\nm",
    ]
    rows = [
        (
            f"$v_s$ = {milli(creep.stribeck_velocity, 4)} mm/s",
            fixed(creep.mean, 2),
            f"{fixed(min(creep.travels), 2)} to {fixed(max(creep.travels), 2)}",
            fixed(creep.held, 4),
            fixed(creep.fine, 4),
        )
        for creep in found.creeps
    ]
    return table_of(heads, rows, caption)


def _value(need: printed.Requirement) -> Name:
    if need.value is None:
        return Name(text=f"no ${need.symbol}$", aside=f"nearest {fixed(need.start, 3)} m")
    limits = "one-sided"
    if need.low is not None and need.high is not None:
        limits = f"{significant(need.low, 3)} to {significant(need.high, 3)}"
    return Name(text=_setting(need), aside=limits)


def _setting(need: printed.Requirement, symbol: str = "") -> str:
    """Return what gives a travel: the parameter, by its symbol or one that is given, and value."""
    unit = "" if need.unit == "1" else f" {need.unit}"
    return f"{symbol or f'${need.symbol}$'} = {significant(need.value or 0.0, 3)}{unit}"


def _bristle_table(found: PaperAudit) -> Table:
    """Show the travel of the bristle laws by their stiffness, in the same push."""
    dahl, lugre = ([row for row in found.bristles if row.law == law] for law in ("dahl", "lugre"))
    caption = (
        "The push, solved exactly; LuGre with the other values of its 1995 paper. Published: Dahl"
        " 0.25 m, LuGre 0.13 m with a velocity that becomes negative."
    )
    heads = ["bristles", "Dahl, held\nm", "LuGre, free\nm", "LuGre, lowest\nvelocity, mm/s"]
    rows = [
        (
            f"{significant(held.stiffness, 1)} N/m",
            fixed(held.criteria.travel, 4),
            fixed(free.criteria.travel, 4),
            milli(free.criteria.least_velocity, 2),
        )
        for held, free in zip(dahl, lugre, strict=True)
    ]
    return table_of(heads, rows, caption)


# What the paper claims, equation by equation and figure by figure, and what became of it.

REPRODUCED = "reproduced"
IN_STEPS = "reproduced in steps of 10 ms only"
CORRECTED = "corrected"
CANNOT = "cannot be: value not printed"
IN_KIND = "in kind: values not printed"
Claim = tuple[str, str, str, str]
"""What is claimed, where, what became of it, and the number that bears it out."""
SAMPLES = 4000
"""Times at which loads and speeds are read."""


def claim_section(audit: PaperAudit) -> Section:
    """List every claim, equation and figure with the result and its number."""
    claims = (*_table_2(audit), *_rig(audit), *_equations(audit), *_phenomena(audit), *_cart(audit))
    rows = [(what, where, Name(text=result, aside=why)) for what, where, result, why in claims]
    listed = table_of(["claim, equation or figure", "where", "result"], rows)
    heading = "What the paper claims, and what became of it"
    return section("claims", "Claims", heading, listed, collapsed=False)


def _table_2(audit: PaperAudit) -> Iterator[Claim]:
    steps = {step_travel.row: step_travel for step_travel in audit.step_travels}
    for row in audit.table:
        if row.published.travel is None:
            continue
        need, step = audit.requirement(row.law.name), steps.get(row.law.name)
        parts = [f"exactly {fixed(row.travel('A'), 3)} m"]
        given = _setting(need) if need is not None and need.reading == "A" else ""
        if need is not None and given and need.kept:
            parts = [f"{given} gives it"]
        elif row.law.name == "stribeck":
            parts = ["exactly, none with the dry friction of Table I"]
            parts += [f"viscous friction alone, {given}, gives it"] if given else []
        elif given:
            parts.append(f"{given} in place of Table I gives it")
        elif row.law.name != "coulomb":
            parts = ["exactly, no $sigma_2$ gives it for the push"]
        if step is not None and step.scatter is not None:
            speed = milli(audit.creeps[len(audit.creeps) // 2].stribeck_velocity, 4)
            low, high = (fixed(end, 2) for end in step.scatter)
            parts.append(
                f"in steps, sgn $v$ added and $v_s$ = {speed} mm/s, it creeps to {low} to {high} m"
            )
        elif step is not None and row.law.states:
            value = values_of(step.law, audit.values.load).split(", ")
            soft = next(part for part in value if "sigma_0" in part)
            parts.append(f"in steps of 10 ms {soft} gives {fixed(step.travel, 3)} m")
        elif step is not None:
            viscous = getattr(step.law, "viscous_coefficient", 0.0)
            part = f"$sigma_2$ = {viscous:g} N s/m: " if viscous else ""
            parts.append(
                f"in steps of 10 ms {part}{fixed(step.travel, 3)} m where sgn 0 = 0,"
                f" {fixed(step.static, 3)} m where friction begins at $F_s$"
            )
        result = CANNOT
        if row.law.name == "coulomb" and step is not None and step.reached:
            result = IN_STEPS
        yield f"{row.law.title}, {row.published.travel:.2f} m", "Table II", result, "; ".join(parts)
    yield (
        "Relative errors",
        "Table II",
        REPRODUCED,
        f"they follow from the travels and the measured {audit.measured:.2f} m",
    )
    yield (
        "Coulomb and Coulomb + viscous are the most accurate",
        "IV.B",
        CORRECTED,
        "one travel ranks no model: each has a value that gives it",
    )


def _rig(audit: PaperAudit) -> Iterator[Claim]:
    fit = audit.verdict.best.fit if audit.verdict.best else None
    known = fit.estimates[0] if fit is not None and fit.estimates else None
    inside = known is not None and known.low <= audit.values.mu_k <= known.high
    allowed = "" if known is None else f"{known.low:.3f} to {known.high:.3f}"
    yield (
        f"$mu_d$ = {audit.values.mu_k:g}",
        "Table I",
        REPRODUCED if inside else CORRECTED,
        f"the measured travel allows {allowed or 'none'} with the spring released,"
        f" {_pushed(audit)} if the block was pushed",
    )
    spring = audit.table[0].reading("B")
    yield (
        "(11) energy balance",
        "IV",
        REPRODUCED,
        f"{fixed(spring.closed_form or 0.0, 4)} m by formula and by simulation",
    )
    met = [sum(row.holds(key) for row in audit.table) for key in "AB"]
    backs = [
        f"{back.law.title} {quantity(back.criteria.largest_return, 'm', 2)}"
        for back in audit.springbacks
    ]
    yield (
        "Two criteria: no negative velocity, no decrease",
        "III.A",
        CORRECTED,
        f"met by {met[0]} and {met[1]} of {len(audit.table)} exact runs that hold the block (push,"
        f" spring); free bristles spring back ({', '.join(backs)}), which is physical",
    )
    free = audit.without_rule
    yield (
        "A rule for rest is needed in steps",
        "III.A",
        REPRODUCED,
        f"without it the velocity changes its sign {free.reversals} times in 1 s, in steps of"
        f" {1e3 * (free.dt or 0.0):g} ms",
    )


def _pushed(audit: PaperAudit) -> str:
    """Return the coefficients whose travel after the push rounds to the measured one."""
    values, duration = audit.values, rigs.PUSH_DURATION
    levels = [
        (values.force * duration) ** 2
        / (2.0 * values.rig.mass * travel + values.force * duration**2)
        for travel in (audit.measured + printed.ROUNDING, audit.measured - printed.ROUNDING)
    ]
    low, high = (level / values.load for level in levels)
    return f"{low:.3f} to {high:.3f}"


def _equations(audit: PaperAudit) -> Iterator[Claim]:
    by = {consequence.form.equation: consequence for consequence in audit.consequences}
    yield (
        "(1) Coulomb, of [6]",
        "II",
        CORRECTED,
        "nothing is held at rest, since sgn 0 = 0: the body creeps by an amount set by the step",
    )
    yield "(2) dynamics with (1)", "II", REPRODUCED, "right while the cart slides"
    yield (
        "(3), (4) friction and dynamics, of [7]",
        "II",
        CORRECTED,
        f"sgn $v$ enters twice; as printed, a block coasting forwards {_ends(by['(3)'], 'coast')}",
    )
    yield (
        "(5) Stribeck",
        "III.C.1",
        CORRECTED,
        f"|·| and sgn $v$ are missing; as printed, coasting {_ends(by['(5)'], 'coast')}. Its rule"
        " for rest is right, and is used here",
    )
    for equation, title, what in (
        ("(6)", "Dahl", "$Z$ has a sign already; "),
        ("(7)", "Coulomb", ""),
        ("(8)", "viscous", "one sgn too many; "),
        ("(9)", "LuGre", "sgn on all three parts, exponent ambiguous; "),
        ("(10)", "Coulomb + viscous", "one sgn too many; "),
    ):
        yield (
            f"{equation} {title}",
            "III.C",
            CORRECTED,
            f"{what}holds a body at rest without limit: pushed from rest $x$ = 0, not"
            f" {significant(_corrected(by[equation], 'push'), 3)} m{_assumed(by[equation])}",
        )


def _ends(consequence: printed.Consequence, test: str) -> str:
    seen = consequence.outcome(test)
    assert seen is not None
    right, viscous = significant(seen.corrected.travel, 3), _assumed(consequence)
    if seen.printed.diverged:
        return f"diverges, instead of {right} m{viscous}"
    return f"ends at {significant(seen.printed.criteria.travel, 3)} m, not {right} m{viscous}"


def _assumed(consequence: printed.Consequence) -> str:
    """Name the viscous part with which an equation is run where Table II gives its law none."""
    viscous = getattr(consequence.corrected, "viscous_coefficient", 0.0)
    if consequence.form.equation not in ("(5)", "(9)") or not viscous:
        return ""
    return f" (with $sigma_2$ = {viscous:g} N s/m, assumed)"


def _corrected(consequence: printed.Consequence, test: str) -> float:
    seen = consequence.outcome(test)
    assert seen is not None
    return seen.corrected.travel


def _phenomena(audit: PaperAudit) -> Iterator[Claim]:
    pulled = audit.stick_slip
    if pulled is not None:
        yield (
            "Stick-slip motion",
            "III.B.1",
            REPRODUCED,
            f"sticks {pulled.stick_time:.3f} s, slips {pulled.slip_time:.3f} s, by run and formula",
        )
    bristles = audit.cart.break_away[-1]
    if isinstance(bristles.law, LuGre):
        yield (
            "Break-away force that varies",
            "III",
            REPRODUCED,
            f"only (9) has it: {significant(max(bristles.largest_friction), 3)} of the normal force"
            f" on the cart, not {audit.values.mu_s:g}",
        )
    yield (
        "Figs 3, 4 Stribeck effect, presliding",
        "III.B",
        IN_KIND,
        "drawn again with the corrected laws; $v_s$ and stiffness are assumed",
    )
    yield (
        "Figs 6 to 10 the block",
        "IV.B",
        IN_KIND,
        "drawn again; the travels are those of Table II",
    )


def _cart(audit: PaperAudit) -> Iterator[Claim]:
    study = audit.cart
    steps, exact = study.run("printed-1"), study.run("exact")
    old, new = study.run("table-1"), study.run("table-1-exact")
    yield (
        "Fig. 2 the cart of [6], [7] goes back",
        "II",
        IN_KIND,
        f"(1), (2) in steps of 10 ms reach {_speed(steps.least_velocity)}; exactly"
        f" {_speed(exact.least_velocity)} at $mu$ = {rigs.KINETIC:g}",
    )
    loads, speeds = _ranges(study.run("paper").run)
    _, block = _ranges(audit.table[0].reading("B").run)
    yield (
        "Rig and cart share the same physical condition",
        "IV.B",
        CANNOT,
        f"masses and swing are not printed; with ours the load is {interval(*loads)} N and the"
        f" speed up to {significant(speeds[1], 2)} m/s, on the rig {audit.values.load:.2f} N"
        f" throughout and {significant(block[1], 2)} m/s",
    )
    yield (
        "Fig. 11 with a rule for rest the cart never goes back",
        "V",
        IN_KIND,
        f"back-slip {_way(new.mean_return)} a cycle with $mu_s$ = {audit.values.mu_s:g}: the swing"
        f" pulls with {percent(largest_pull(new))} of the normal force",
    )
    yield (
        "The cart goes to “the same displacement” as before",
        "V",
        IN_KIND,
        f"(1), (2) in steps of 10 ms and exactly: {fixed(old.travel, 3)} and"
        f" {fixed(new.travel, 3)} m in {rigs.CYCLES} cycles at Table I’s levels",
    )


def _ranges(run: Trajectory) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the range of the normal force, and of the speed."""
    seen = run.at(np.linspace(*run.span, SAMPLES))
    load, speed = seen["normal_force"], np.abs(seen["v"])
    return (float(load.min()), float(load.max())), (float(speed.min()), float(speed.max()))


def _speed(velocity: float) -> str:
    return with_unit(milli(velocity, 2), "mm/s")


def _way(way: float) -> str:
    return "0 mm" if way == 0.0 else quantity(way, "m", 2)


# Sections on the printed equations, on how the block is set in motion, and on all assumptions.

# The printed equations, their defects, and where these act.


def equation_section(found: PaperAudit) -> Section:
    """Show each equation as printed, what is wrong in it, what is right, and what is used here."""
    return section(
        "equations",
        "Equations",
        "The equations as printed, symbols and values",
        "In the paper’s symbols; those of this page are in the table after the equations."
        " The paper quotes (1) to (4) from its references [6] and [7], in order to improve"
        " on them. (1) and (3) are forces on the cart, (5) to (10) resistances. “Coulomb"
        " plus viscous plus static” has no equation of its own; it is taken here as (10)"
        " with the rule for rest of (5), the law `coulomb-viscous-static`.",
        *(block for form in PRINTED_EQUATIONS for block in _shown(form)),
        _energy_answer(found),
        report.Subheading(text="Symbols"),
        table_of(["here", "meaning", "unit", "in the paper"], SYMBOLS),
        report.Subheading(text="Values in the tests of the equations"),
        _values_table(found),
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


def _shown(form: type[PrintedForm] | RightEquation) -> tuple[report.Block, ...]:
    right = "Right" if form.defect else "Right as printed"
    parts = {"Defect": form.defect, right: form.right, "Used here": form.cure}
    text = " ".join(f"**{key}**: {what}." for key, what in parts.items() if what)
    return (
        report.Subheading(text=f"{form.equation} {form.title}"),
        report.Math(latex=form.formula, tag=form.equation),
        report.Paragraph(text=text),
    )


def _energy_answer(found: PaperAudit) -> str:
    """Say for which of the two springs eq. (11) holds."""
    release, attached = (found.table[0].reading(key).criteria for key in "BC")
    places = found.table[0].reading("C").run["x"]  # turning points among them
    way = float(abs(places[1:] - places[:-1]).sum())
    x = quantity(found.values.rig.compression, "m")
    return (
        f"With the coefficient of Table I and $x$ = {x} it gives {fixed(release.travel, 3)} m. For"
        " a block that stays fastened to its spring $s$ would be the length of its path,"
        f" {fixed(way, 3)} m; since that block returns, it ends at {fixed(attached.travel, 3)} m."
    )


def misprint_section(found: PaperAudit) -> Section:
    """Show where each defect acts, as printed and with a stick rule added."""
    errs = {key: sum(defect.differs(key) for defect in found.consequences) for key in printed.TESTS}
    heads = ["equation", *(f"{what}\nm" for what in printed.TESTS.values())]
    rows = [
        (
            f"{item.form.equation} {item.form.title}",
            *(_cell(item.outcome(key)) for key in printed.TESTS),
        )
        for item in found.consequences
    ]
    caption = (
        f"Travel in {printed.SECONDS:g} s, by Heun’s method in steps of {1e3 * printed.FINE_STEP:g}"
        f" ms ({1e3 * printed.BRISTLE_STEP:g} ms with bristles), without a stick rule. Below it,"
        " where the two differ by more than 1 mm and 1 %, that of the corrected law, solved"
        " exactly. For a block, (4) equals (3). Viscous friction has no entry in the last column."
        " As text: `stickslip models --published`."
    )
    return section(
        "misprints",
        "Where they act",
        f"As printed, {in_words(errs['coast'])} equations err when the block coasts forwards,"
        f" {in_words(errs['push'])} when it is pushed from rest",
        _tests_text(found),
        table_of(heads, rows),
        report.Caption(text=caption),
        _rule_text(found),
    )


def _tests_text(found: PaperAudit) -> str:
    values = found.values
    below = printed.HELD * values.mu_k * values.load
    return (
        "Each equation as it stands, in four tests on the block of Table I: coasting forwards, as"
        f" after the push; pushed from rest with {number(values.force)} N for"
        f" {rigs.PUSH_DURATION:g} s; coasting backwards from {-printed.BACKWARD:g} m/s; held at"
        f" rest against {below:.3g} N, half of kinetic friction. A block that coasts forwards in"
        " steps ends with a velocity a little below zero, and there the errors of sign act. (6) to"
        " (10) hold a body at rest without limit, so that the push does not start it; as Table II"
        " has travels, we infer that the simulations had another rule for rest."
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
            parts.append(f"{printed.TESTS[key]}, {joined(right)}")
    what = (
        "With a stick rule, which holds the block where its velocity changes sign and which none of"
        " the equations prints,"
    )
    return f"{what} {'; '.join(parts)}." if parts else f"{what} nothing changes."


def _values_table(found: PaperAudit) -> Table:
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
            Name(text=values_of(item.corrected, load), aside=item.corrected.title),
        )
        for item in found.consequences
    ]
    heads = ["equation", "values as printed", "values of the corrected law"]
    return table_of(heads, rows, text)


def _cell(outcome: printed.Outcome | None) -> Name | str:
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


# Three readings of how the block is set in motion.

SKETCHES = {"A": "push", "B": "released-spring", "C": "fixed-spring"}


def excitation_section(found: PaperAudit) -> Section:
    """Show three readings of one sentence of the paper, with the first law of its table."""
    row = found.table[0]
    mu_k = getattr(row.law, "kinetic_coefficient", 0.0)
    values = found.values
    force = f"{quantity(values.force, 'N')} for {rigs.PUSH_DURATION:g} s"
    text = (
        "Section IV has a compressed spring that is released, with $F$ = $K$$x$, and for"
        f" experiment and simulation alike a force of {force}. A released spring does not push"
        f" with a constant force. The compression, {values.rig.compression:g} m, follows from"
        f" {quantity(values.force, 'N')} and $K$. Both readings, and a control, with $mu_k$ ="
        f" {mu_k:g} and {row.law.title} friction:"
    )
    travels = {f"{reading.criteria.travel:.2f}" for reading in row.readings}
    return section(
        "excitation",
        "Three excitations",
        f"Two readings of the rig and a control, {in_words(len(travels))} travels",
        text,
        _sketches(row.readings),
        _figure(found, row.readings),
        _excitation_table(found, row.readings),
        _closed_forms(row.readings),
        collapsed=False,
    )


def _sketches(readings: Sequence[rigs.Excitation]) -> report.Gallery:
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


def _figure(found: PaperAudit, readings: Sequence[rigs.Excitation]) -> report.Figure:
    values = found.values
    low, high = (found.measured + side * values.uncertainty for side in (-1.0, 1.0))
    draw = draw_excitations(
        {_label(r): r.run for r in readings},
        chosen=next(_label(r) for r in readings if r.key == "B"),
        band=(low, high),
        measured=f"measured, {_metres(found)}",
    )
    band = "Line: the measured travel, whose uncertainty is not stated."
    if high > low:
        what = "the measured travel ± its standard uncertainty"
        if values.rounded:
            what = f"the travels that round to {_metres(found)}"
        band = f"Blue-grey band: {interval(low, high)} m, {what}."
    alt = "Travel against time in the three readings of the rig"
    caption = f"**Travel in the two readings and the control.** {band}"
    return figure(draw, alt, "excitations", caption, EXCITATION_SIZES)


def _excitation_table(found: PaperAudit, readings: Sequence[rigs.Excitation]) -> Table:
    travels = [reading.criteria.travel for reading in readings]
    axis = travel_axis(found, travels, "travel, m; line: measured")

    def dot(reading: rigs.Excitation) -> report.RowPlot:
        at, colour = reading.criteria.travel, COLOURS[reading.key]
        return report.RowPlot(marks=(report.Mark(kind="dot", at=at, colour=colour),))

    return table(
        readings,
        ("excitation", _label),
        (
            report.Column(head="travel\nm", numeric=True),
            lambda r: report.Number(value=fixed(r.criteria.travel, 3)),
        ),
        (report.Column(head="", axis=axis), dot),
        (numbers("error"), lambda r: signed_percent(r.criteria.relative_error or 0.0)),
        (numbers("work put in\nJ"), lambda r: fixed(r.criteria.work_in, 3)),
        ("how it ends", _ending),
        chosen=lambda r: r.key == "B",
    )


def _label(reading: rigs.Excitation) -> str:
    return f"{reading.key}. {reading.title}"


def _ending(reading: rigs.Excitation) -> str:
    """Say in words how a run ends."""
    seen = reading.criteria
    if seen.stop_time is None:
        return "still moves at the end"
    if seen.displacement_never_decreases:
        return f"stops at {seen.stop_time:.3f} s, stays"
    farthest = float(reading.run["x"].max())
    return f"turns at {farthest:.3f} m, ends at {seen.stop_time:.3f} s"


def _closed_forms(readings: Sequence[rigs.Excitation]) -> report.Caption:
    """Set the runs against the formulas."""
    known = {r: r.closed_form for r in readings if r.closed_form is not None}
    text = "No reading has a closed form here: the block stays with its spring."
    if known:
        off = max(abs(r.criteria.travel - travel) for r, travel in known.items())
        travels = ", ".join(f"{r.key} {travel:.7f} m" for r, travel in known.items())
        text = f"Closed forms: {travels}; the simulated travels differ by {residue(off)} m at most."
    return report.Caption(text=text)


# All that is assumed on the page, in one table.


def assumption_section(found: PaperAudit) -> Section:
    """List every value that the page uses and the source does not print, with its origin."""
    values = found.values
    pushed = f"{quantity(values.force, 'N')} for {rigs.PUSH_DURATION:g} s, then coasting"
    rig_rows = [
        ("block, gravity", quantity(values.rig.gravity, "m/s^2"), "not printed"),
        (
            "readings B and C, compression",
            quantity(values.rig.compression, "m"),
            "inferred from $F$ = $K$$x$ and 10 N",
        ),
        ("reading A", pushed, "printed; that it coasts is inferred"),
        ("reading C", "the block stays fastened", "ours, a control"),
    ]
    rows = (*rig_rows, *_law_rows(found), *_run_rows(found))
    return section(
        "assumptions",
        "Assumptions",
        "What is assumed, and where it is used",
        "Every value on this page is one that Tables I and II and the text of the"
        " paper print, or stands in this table.",
        table_of(["where", "value", "origin"], rows),
    )


def _law_rows(found: PaperAudit) -> list[tuple[str, str, str]]:
    load = found.values.load
    rows = []
    for row in found.table:
        held = ", held at its first stop" if getattr(row.law, "static_switch", False) else ""
        assumed = [name.replace("_", " ") for name in found.rig.assumed.get(row.law.name, ())]
        origin = f"levels of Table I; {joined(assumed)} assumed" if assumed else "Table I"
        if isinstance(row.law, LuGre):
            origin += "; $n$ not printed"
        rows.append((f"models, {row.law.title}", f"{values_of(row.law, load)}{held}", origin))
    return rows


def _run_rows(found: PaperAudit) -> list[tuple[str, str, str]]:
    values, cart, swing = found.values, found.cart.cart, found.cart.swing
    angle = f"{math.degrees(swing.amplitude):.0f}°"
    soft = printed.lugre_row(values, printed.STIFFNESS)
    return [
        (
            "printed equations",
            f"$sigma_2$ {significant(values.viscous, 2)} N s/m in (5), (8), (9) and (10), also"
            " where the models above have none; $n$ = 2 in (9)",
            "assumed",
        ),
        (
            "printed equations, tests",
            f"{-printed.BACKWARD:g} m/s backwards; held against {printed.HELD:g} $F_c$; steps of"
            f" {1e3 * printed.FINE_STEP:g} ms, {1e3 * printed.BRISTLE_STEP:g} ms with bristles;"
            " Heun’s method",
            "ours",
        ),
        (
            "spring-back, break-away with bristles",
            f"LuGre, {values_of(soft, values.load)}",
            "LuGre 1995, with the levels of the block",
        ),
        (
            "steps of 10 ms",
            f"{quantity(printed.CART_STEP, 's')}, forward Euler",
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
            f" {number(swing.fast)} rad/s², {rigs.CYCLES} cycles",
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
            f"$v_s$ {joined([milli(value, 4) for value in printed.CREEPING])} mm/s; sgn $v$ added",
            "tried",
        ),
        ("cart, $mu_k$ = $mu_s$", f"{rigs.KINETIC:g}; Table I’s where said", "ours"),
        ("stick-slip, pulling speed", f"{1e3 * rigs.SPEED:g} mm/s", "ours"),
    ]


# Sections on the cart and on rest: Figs 2 and 11, rules for rest, break-away levels that vary.

# The paper's cart: the printed equations and exactly (Fig. 2), then a chosen law (Fig. 11).

STEP_TEXT = f"steps of {1e3 * rigs.STEP:g} ms"
CAUSES = {
    "no-stick-rule": ("no rule for rest", "without and with the stick rule, in {step}"),
    "step": ("the time step", "{step} against located events, both with the stick rule"),
    "friction": ("the cart itself", "the exact run: the swing pulls harder than friction holds"),
}
"""What each share is called, and which runs it is the difference of.

The share of the misprint is not among them: it was hardly simulated.
"""
ANIMATED = 12.0
"""Frames a second of what is shown."""
STROKE = (1.15, 0.7)
"""Begin and end of the stroke of Fig. 11 that is shown, in cycles before the end."""
STEADY = 1e-6
"""Share of the travel within which cycles are the same."""


def cart_section(found: PaperAudit) -> Section:
    """Fig. 2: the cart with the printed equations, in fixed steps and exactly."""
    study = found.cart
    free, exact = (study.run(key).least_velocity for key in ("fixed", "exact"))
    heading = "Fig. 2: the cart with the printed equations"
    if exact > 0.5 * free:  # both are at most 0
        heading = "Fig. 2: most of the backward motion of the old scheme comes from its steps"
    return section(
        "cart",
        "Fig. 2, the cart",
        heading,
        _setting_text(study),
        _run_table((*study.runs, *study.table_1)),
        _scheme_text(study),
        _cycle_figure(study),
        _animation(study),
        report.Subheading(text="Where the backward motion comes from"),
        _share_table(study),
        report.Caption(text=_shares_text(study)),
        collapsed=False,
    )


def _setting_text(study: rigs.CartStudy) -> str:
    cart, swing = study.cart, study.swing
    angle = f"{math.degrees(swing.amplitude):.0f}°"
    origin = (
        "As given by `--set`"
        if study.given
        else "Ours, since the paper prints none and its sources were not at hand; who holds [6] and"
        ' [7] enters theirs, such as `stickslip paper --set cart_mass=0.4 --set amplitude="40'
        ' deg"`'
    )
    return (
        f"{origin}: cart {cart.cart_mass:g} kg, ball {cart.ball_mass:g} kg, rod {cart.length:g} m;"
        f" the rod swings from −{angle} to {angle} and back with {swing.fast:g}, −{swing.slow:g}"
        f" and {swing.fast:g} rad/s², in {study.period:.5f} s. {in_words(rigs.CYCLES).capitalize()}"
        f" cycles from rest with $mu_k$ = $mu_s$ = {rigs.KINETIC:g}, then at the levels of Table I;"
        " in steps of the paper’s 10 ms by forward Euler (our choice), and exactly. With the stick"
        " rule friction begins at $F_s$, without it sgn 0 = 0."
    )


def _scheme_text(study: rigs.CartStudy) -> str:
    """Say what (4) cannot have been, and how far the old scheme and the exact run agree."""
    exact, old, new = (study.run(key) for key in ("exact", "table-1", "table-1-exact"))
    literal = study.run("printed-4")
    turned = (
        f" Taken literally, (3) and (4) drive this cart {quantity(abs(literal.travel), 'm')}"
        " backwards, while the paper’s goes forwards: we infer that the sign in $mu$ of (3) is a"
        f" slip of notation. With the plain $mu$ of (1), (4) gives"
        f" {fixed(study.run('unsigned-4').travel, 3)} m."
        if literal.travel * exact.travel < 0.0
        else ""
    )
    return (
        "The paper concludes that a rule for rest removes the backward motion and leaves the"
        f" displacement as it was. At $mu$ = {rigs.KINETIC:g}, (1) and (2) in steps give"
        f" {fixed(study.run('printed-1').travel, 3)} m and the exact run"
        f" {fixed(exact.travel, 3)} m; at the levels of Table I {fixed(old.travel, 3)} and"
        f" {fixed(new.travel, 3)} m, with a back-slip of {quantity(old.mean_return, 'm', 2)} and"
        f" {'none' if new.mean_return == 0.0 else quantity(new.mean_return, 'm', 2)}"
        f" a cycle.{turned}"
    )


def _animation(study: rigs.CartStudy) -> report.Animation:
    """The first two cycles of the exact run, drawn to scale."""
    exact = study.run("exact").run
    alt = "A cart with an inverted pendulum moves to the right as the pendulum swings"
    until = 2.0 * study.period
    draw = partial(plots.animation_html, exact, study.cart, fps=ANIMATED, until=until)
    return report.Animation(
        html=partial(draw, alt=alt, narrow=(358, 560)),
        caption="**The exact run** in its first two cycles, to scale and in real time."
        " The cart is yellow while it sticks; the arrows are the forces of the ground and"
        " the torque.",
    )


def _run_table(runs: Sequence[rigs.CartRun]) -> Table:
    heads = [
        "run",
        f"travel in\n{rigs.CYCLES} cycles, m",
        "by cycle\nmm",
        LOWEST_VELOCITY,
        BACK_SLIP,
    ]
    exact = [run.key.endswith("exact") for run in runs]
    return table_of(heads, map(_run_row, runs, exact), chosen=exact)


def _run_row(run: rigs.CartRun, exact: bool) -> Sequence[report.Cell]:
    later = sorted((1e3 * travel for travel in run.travels[1:]), key=abs)
    steady = abs(later[-1] - later[0]) < STEADY * abs(later[0])
    ends = [significant(travel, 3) for travel in (later[0], later[-1])]
    following = ends[0] if steady else " to ".join(ends)
    return (
        Name(text=run.title, aside="events located" if exact else STEP_TEXT),
        significant(run.travel, 3),
        f"{milli(run.travels[0])}, then {following}",
        milli(run.least_velocity),
        milli(run.mean_return),
    )


def _cycle_figure(study: rigs.CartStudy) -> report.Figure:
    keys = ("exact", "printed-1", "fixed-held")
    runs = {study.run(key).title: study.run(key).run for key in keys}
    exact = study.run("exact")
    last = exact.run.span[1]
    same = ""
    if study.run("printed-1").travels == study.run("fixed").travels:
        same = "Without the stick rule the corrected law is (1), (2): the same run."
    return figure(
        plots.draw_cycles(runs, chosen=exact.title, cycle=(last - study.period, last)),
        "Displacement of the cart in all cycles, and its velocity near zero in the last",
        "fig2b",
        "**In place of Fig. 2. Cart displacement by (1) and (2)**, as printed and corrected in"
        f" {STEP_TEXT}, and exactly: all cycles, and the velocity near zero in the last one."
        f" Yellow: the exact run sticks. {same}",
        plots.CYCLE_SIZES,
    )


def _shares_text(study: rigs.CartStudy) -> str:
    shares = {share.key: share for share in study.shares}
    steps = [shares["no-stick-rule"], shares["step"]]
    free, exact = study.run("fixed"), study.run("exact")
    late = sum(share.least_velocity for share in steps)
    return (
        "What each cause adds at $mu$ = 0.2; the rows add up to the run with (1) and (2). In"
        f" {STEP_TEXT} it reaches {_speed(free.least_velocity)}, of which the step and the missing"
        f" rule make up {percent(late / free.least_velocity)} and vanish with the step. The exact"
        f" run reaches {_speed(exact.least_velocity)}: the swing pulls this cart back harder than"
        " friction can hold. A criterion on the sign of the velocity cannot tell the two apart."
    )


def _share_table(study: rigs.CartStudy) -> Table:
    together = study.run("printed-1")
    shares = [share for share in study.shares if share.key in CAUSES]
    named = [
        (CAUSES[share.key][0], CAUSES[share.key][1].format(step=STEP_TEXT)) for share in shares
    ]
    named.append(("all together", f"{together.title}, {STEP_TEXT}"))
    parts: list[rigs.Share | rigs.CartRun] = [*shares, together]
    rows = [
        (
            Name(text=cause, aside=runs),
            milli(of.least_velocity),
            milli(of.mean_return),
        )
        for (cause, runs), of in zip(named, parts, strict=True)
    ]
    chosen = [share.key == "friction" for share in shares]
    return table_of(["cause", LOWEST_VELOCITY, BACK_SLIP], rows, chosen=(*chosen, False))


def choice_section(found: PaperAudit) -> Section:
    """Fig. 11: the cart with the law that the selection names, and with the paper's choice."""
    study = found.cart
    ways = {choice.key: quantity(choice.travels[-1], "m") for choice in study.choices}
    heading = f"{study.run('paper').law.title} friction moves the cart {ways['paper']} a cycle"
    chosen = "names no law"
    if "selected" in ways:
        heading = (
            f"The cart moves {ways['selected']} a cycle with the law that select names, and"
            f" {ways['paper']} with the paper’s example"
        )
        chosen = f"names {study.run('selected').law.title}"
    return section(
        "cart-choice",
        "Fig. 11, the choice",
        heading,
        "The paper takes Coulomb + viscous friction “for instance”; its $sigma_2$ is not printed"
        f" ({quantity(found.values.viscous, 'N s/m', 2)}, assumed). `select` {chosen} for the rig."
        f" Masses and swing of the cart are {'given by `--set`' if study.given else 'ours'}"
        ", so that the figure can be compared in kind only.",
        _choice_table(study),
        _choice_figure(study),
        report.Caption(text=_return_text(study)),
        collapsed=False,
    )


def _run_label(run: rigs.CartRun) -> str:
    return "by select" if run.key == "selected" else "the paper’s example"


def _choice_table(study: rigs.CartStudy) -> Table:
    heads = ["law", "travel\nm", FIRST_CYCLE, "last cycle\nmm", BACK_SLIP, LOWEST_VELOCITY]
    rows = [
        (
            Name(text=f"{run.law.title}, {_run_label(run)}", aside=values_of(run.law)),
            significant(run.travel, 3),
            fixed(1e3 * run.travels[0], 2),
            fixed(1e3 * run.travels[-1], 2),
            back_slip_text(run.mean_return),
            milli(run.least_velocity, 2),
            fixed(run.least_normal_force, 3),
        )
        for run in study.choices
    ]
    chosen = [run.key == "selected" for run in study.choices]
    return table_of([*heads, "lowest normal\nforce, N"], rows, chosen=chosen)


def _choice_figure(study: rigs.CartStudy) -> report.Figure:
    runs = {_run_label(choice): choice.run for choice in study.choices}
    last = study.choices[0].run.span[1]
    stroke = (last - STROKE[0] * study.period, last - STROKE[1] * study.period)
    views = [
        plots.MotionView(column="x", title="displacement", span=(0.0, last)),
        plots.MotionView(column="v", title="velocity", span=stroke),
    ]
    apart = ""
    if len(runs) > 1:
        views.append(
            plots.MotionView(
                column="v", title="difference in velocity", span=stroke, difference=True
            )
        )
        apart = ", and by how much that of the paper’s example differs"
    return figure(
        plots.draw_motion(runs, views=views),
        "Displacement and velocity of the cart with the chosen laws",
        "fig11",
        "**In place of Fig. 11. The cart under Coulomb + viscous friction**, the paper’s example,"
        " and under the law that select names, both solved exactly: displacement in all cycles,"
        f" velocity in the last whole stroke{apart}.",
        {"wide": (880, 300), "narrow": (358, 600)},
    )


def _return_text(study: rigs.CartStudy) -> str:
    """Say whether the cart slips back, what keeps it from it, and what the normal force does."""
    back = [choice for choice in study.choices if choice.mean_return > 0.0]
    ways = ", ".join(f"{_run_label(run)}: {quantity(run.mean_return, 'm', 2)}" for run in back)
    text = f"The cart slips back in a cycle: {ways}."
    if not back:
        pull = max(largest_pull(run) for run in study.choices)
        text = (
            "The cart never slips back: at rest the swing pulls it back with up to"
            f" {percent(pull)} of the normal force, less than friction can hold. At a lower level"
            f" of {rigs.KINETIC:g} it does slip back, as the tables above show."
        )
    least = min(choice.least_normal_force for choice in study.choices)
    return (
        f"{text} The normal force is the same with every law, since the swing is prescribed; it"
        f" falls to {percent(least / study.weight)} of the weight."
    )


def largest_pull(run: rigs.CartRun) -> float:
    """Return the largest backward pull on the resting cart, over the normal force.

    NaN if it never rests.
    """
    first, last = run.run.span
    seen = run.run.at(np.union1d(np.linspace(first, last, 20_000), run.run.t))
    resting = seen["mode"] == 0
    pulls = -seen["friction"][resting] / seen["normal_force"][resting]
    return float(max(pulls, default=math.nan))


# Rules for rest beside the exact switch, and break-away levels that vary.


def rest_section(found: PaperAudit) -> Section:
    """Show what the zero-velocity band of the paper's [18] does, beside other rules for rest."""
    heads = [
        "rule for rest",
        "block, travel\nm",
        "sign changes\nin 1 s",
        "block\nat the end",
        f"cart, travel in\n{rigs.CYCLES} cycles, m",
        "cart, back-slip\nmm/cycle",
    ]
    rows = [
        (
            _rule_name(rule),
            fixed(rule.block.travel, 4),
            str(rule.reversals),
            "rests" if rule.rests else "moves to and fro" if rule.reversals else "moves",
            fixed(rule.cart_travel, 3),
            milli(rule.cart_back_slip, 2),
        )
        for rule in found.rest_rules
    ]
    rules = table_of(heads, rows, chosen=[rule.dt is None for rule in found.rest_rules])
    heading = "The zero-velocity band of [18] beside the exact switch"
    caption = report.Caption(text=_rest_caption(found))
    return section("rest", "Rules for rest", heading, _rest_text(found), rules, caption)


def _rest_text(found: PaperAudit) -> str:
    steps = sorted({rule.dt for rule in found.rest_rules if rule.dt is not None}, reverse=True)
    level = found.values.mu_k * found.values.load / found.values.rig.mass
    jumps = joined([f"{significant(1e3 * level * dt, 2)} mm/s in {1e3 * dt:g} ms" for dt in steps])
    return (
        "Karnopp (1985), the paper’s [18], has a body slower than $D_v$ at rest while the force"
        " needed is within break-away. A step changes the velocity of the block by $F_c$ $dt$/$m$,"
        f" which is {jumps}, and can jump over a narrower band. Coulomb friction with the levels of"
        " Table I, forward Euler, friction from $F_s$ in the first step out of rest."
    )


def _rule_name(rule: rigs.RestRule) -> Name:
    if rule.dt is None:
        return Name(text="exact switch", aside="events located")
    text = "at a change of sign" if rule.stick_rule else "none"
    if rule.band > 0.0:
        text = f"band, $D_v$ = {number(1e3 * rule.band)} mm/s"
    return Name(text=text, aside=f"steps of {1e3 * rule.dt:g} ms")


def _rest_caption(found: PaperAudit) -> str:
    exact, *others = found.rest_rules
    held, missed = [], []
    for rule in (rule for rule in others if rule.band > 0.0):
        band = f"{number(1e3 * rule.band)} mm/s in steps of {1e3 * (rule.dt or 0.0):g} ms"
        off = rule.block.travel / exact.block.travel - 1.0
        if rule.rests:
            held.append(f"{band} ({percent(off)} too far)")
        else:
            missed.append(band)
    text = f"Bands that hold the block: {joined(held)}." if held else "No band holds the block."
    if missed:
        text += f" Bands that it jumps over: {joined(missed)}."
    return (
        f"{text} With a rule, friction begins at $F_s$; without one, sgn 0 = 0. A wide band does"
        " what the rule for a change of sign does. Neither finds the instant of stop or start, so"
        " that travels keep an error of the order of the step."
    )


def break_away_section(found: PaperAudit) -> Section:
    """Show what a break-away level that varies does to the cart."""
    values, groups = found.values, _groups(found)
    reached = "friction reached\nby cycle, over $N$"
    heads = ["break-away level", reached, FIRST_CYCLE, "later cycles\nmm", BACK_SLIP]
    heading = "A break-away level that varies"
    if _spread(groups[0]) < STEADY:
        heading += " changes the first cycle of the cart, and whether it slips back"
    return section(
        "break-away",
        "Break-away that varies",
        heading,
        "Section III lists a break-away force that varies; of the equations only (9) has one, since"
        " bristles give way earlier the faster the force grows. The cart, solved exactly: Coulomb"
        f" friction with other static levels, at $mu_k$ = {number(values.mu_k)} and at"
        f" {rigs.KINETIC:g}; and LuGre with $mu_s$ = {number(values.mu_s)}, free bristles of 10⁵"
        " N/m and the other values of its 1995 paper.",
        table_of(heads, map(_break_away_row, found.cart.break_away)),
        report.Caption(text=_break_away_caption(found, groups)),
    )


def _groups(found: PaperAudit) -> list[list[rigs.CartRun]]:
    """Return the runs with a constant level, by their kinetic coefficient."""
    groups: dict[float, list[rigs.CartRun]] = {}
    for run in found.cart.break_away:
        kinetic = getattr(run.law, "kinetic_coefficient", None)
        if run.law.name == "coulomb" and kinetic is not None:
            groups.setdefault(kinetic, []).append(run)
    return list(groups.values())


def _later(run: rigs.CartRun) -> tuple[float, float]:
    return min(run.travels[1:]), max(run.travels[1:])


def _spread(runs: list[rigs.CartRun]) -> float:
    """Return by how much travels of later cycles differ between runs, over the travel."""
    low = min(_later(run)[0] for run in runs)
    high = max(_later(run)[1] for run in runs)
    return (high - low) / abs(high)


def _break_away_row(run: rigs.CartRun) -> Sequence[report.Cell]:
    low, high = (milli(value, 4) for value in _later(run))
    reached = [significant(value, 3) for value in run.largest_friction]
    steady = len(set(reached[1:])) == 1
    return (
        Name(text=run.title, aside="" if run.law.name == "coulomb" else "free bristles"),
        f"{reached[0]}, then {reached[1]}" if steady else ", ".join(reached),
        milli(run.travels[0], 4),
        low if low == high else f"{low} to {high}",
        back_slip_text(run.mean_return),
    )


def _break_away_caption(found: PaperAudit, groups: list[list[rigs.CartRun]]) -> str:
    parts = []
    for runs in groups:
        kinetic = number(getattr(runs[0].law, "kinetic_coefficient", 0.0))
        first = [1e3 * run.travels[0] for run in runs]
        ends = f"{interval(min(first), max(first))} mm"
        parts.append(f"at $mu_k$ = {kinetic} the first cycle has {ends}")
    slipping = [run for run in found.cart.break_away if run.mean_return > 0.0]
    text = f"By level, {joined(parts)}."
    if _spread(groups[0]) < STEADY:
        text += (
            " Later on the swing reverses its acceleration at once and asks for more than any of"
            " these levels at that instant, so that the cart starts at the same time with each."
        )
    held = [run for run in found.cart.break_away if run.mean_return == 0.0]
    if slipping and held:
        pull = largest_pull(held[-1])
        text += (
            f" Whether it slips back depends on the level: the swing pulls it back with up to"
            f" {percent(pull)} of the normal force, and a level that falls below that at a cycle"
            " lets it slip in that cycle."
        )
    bristles = found.cart.break_away[-1]
    if bristles.law.name == "lugre":
        text += (
            f" LuGre reaches {significant(max(bristles.largest_friction), 3)} of the normal force"
            f" before slip, not {number(found.values.mu_s)}, and springs back by"
            f" {quantity(bristles.mean_return, 'm', 2)} a cycle."
        )
    return text


# The audit of the paper as a page, and what it adds to the page of its rig.


class Beside(NamedTuple):
    """What the page of a selection on the rig of the paper shows beside the selection."""

    remark: str = ""
    """A sentence at the end of the lede."""
    lead: tuple[report.SectionMaker, ...] = ()
    """Sections after the verdict."""
    extra: tuple[Section | report.SectionMaker, ...] = ()
    """Sections before what to measure next."""


def beside(rig: Rig, verdict: TravelVerdict) -> Beside:
    """Return where the paper's own comparison errs, for the page of its rig; nothing for others."""
    if not _bundled(rig, verdict):
        return Beside()
    try:
        result = audit(verdict=verdict)
    except report.blocks.CAUGHT as error:
        return Beside(extra=(report.blocks.failed_section("paper", error),))
    return Beside(
        remark=_remark(result),
        lead=(partial(excitation_section, result), partial(table_section, result)),
        extra=(
            partial(equation_section, result),
            partial(misprint_section, result),
        ),
    )


def _bundled(rig: Rig, verdict: TravelVerdict) -> bool:
    """Whether a verdict is on the rig of the paper as it comes with the package."""
    paper = load_rig()
    return (
        rig.digest == paper.digest
        and verdict.mechanism == rig.mechanism
        and verdict.measurement is rig.measurement
    )


def _remark(found: PaperAudit) -> str:
    """Say where the published error comes from, if the numbers bear it out."""
    first = found.table[0]
    push, spring = (abs(r.criteria.relative_error or 0.0) for r in first.readings[:2])
    published = first.published.relative_error
    if published is None or not spring < push:
        return ""
    return (
        f"The paper prints an error of {percent(published)} for {first.law.title} friction. With"
        f" the spring released it is {percent(spring)}; the push of 10 N for 0.1 s, of which it"
        f" also writes, gives {percent(push)}, the nearest reading."
    )


def result_sections(found: PaperAudit) -> tuple[Section, ...]:
    """Return the sections whose tables the terminal shows."""
    makers = (
        table_section,
        ranking_section,
        unpublished_section,
        trial_section,
        cart_section,
        choice_section,
    )
    return tuple(maker(found) for maker in makers)


def paper_report(audit: PaperAudit, *, command: str = "stickslip paper") -> str:
    """Return the audit of the paper as one HTML page."""
    makers = (
        claim_section,
        table_section,
        ranking_section,
        choice_section,
        excitation_section,
        unpublished_section,
        misprint_section,
        cart_section,
        schematic_section,
        figure_section,
        phenomena_section,
        trial_section,
        rest_section,
        break_away_section,
        equation_section,
        assumption_section,
    )
    opening = _opening(audit)
    origin = report.Origin(title="", data="", commands=(command,), digest=audit.rig.digest)
    laws = [row.law for row in audit.table]
    page = report.Page(
        title="The pendulum-driven cart paper, recomputed",
        subject="Tables and figures beside what was printed",
        kicker="audit of a paper",
        sections=report.blocks.made_sections(
            Section(id="verdict", nav="Verdict", heading="", blocks=(opening,)),
            *(partial(maker, audit) for maker in makers),
            partial(report.reproduce, origin, laws=laws, cited={"paper": ["rig"]}),
        ),
        footer=report.blocks.colophon(origin.versions),
    )
    return report.render(page)


def _opening(found: PaperAudit) -> report.Opening:
    """Say what the audit found."""
    first = found.table[0]
    push, spring = (r.criteria for r in first.readings[:2])
    in_steps = sum(step_travel.reached for step_travel in found.step_travels)
    facts = (
        report.Fact(
            value=percent(abs(spring.relative_error or 0.0)),
            aside=f"printed: {percent(first.published.relative_error or 0.0)}",
            what=f"error of {first.law.title} with Table I’s coefficient, spring released",
        ),
        report.Fact(
            value=f"{fixed(push.work_in, 3)} J",
            aside=f"and {fixed(spring.work_in, 3)} J",
            what="work of the push of 10 N for 0.1 s, and of the released spring",
        ),
        report.Fact(
            value=f"{found.reached('A')} of {len(found.rig.published)} rows",
            aside=f"{in_steps} in steps of 10 ms",
            what="of Table II can follow from unpublished values for the push, Table I kept: solved"
            " exactly, and by forward Euler with some rule for rest",
        ),
    )
    return report.Opening(
        kicker=SOURCES["paper"],
        verdict="One travel cannot rank friction models.",
        lede=(
            "The paper writes that a spring is released, and also that 10 N act for 0.1 s. With the"
            f" spring released, {first.law.title} friction with Table I’s coefficient travels"
            f" {spring.travel:.3f} m, {percent(spring.relative_error or 0.0)} from the measured"
            f" {found.measured:.2f} m. A push gives {push.travel:.3f} m, the reading nearest to the"
            f" printed {first.published.travel or 0.0:.2f} m; that a push stood for the spring in"
            " the simulation is our inference. The other rows depend on values that the paper does"
            " not print."
        ),
        facts=facts,
        settles=found.verdict.words.settles[:2],
        cannot_tell=(
            "Which values the paper used, beyond Table I.",
            *found.verdict.words.cannot_tell[:1],
        ),
        measure_next=found.verdict.words.measure_next[:1],
    )
