"""The paper's figures, drawn again under its captions."""

from stickslip.formatting import fixed, percent, quantity, residue, significant, with_unit
from stickslip.friction import Stribeck
from stickslip.paper.audit import PaperAudit, TableRow
from stickslip.paper.excitations import PUSH_DURATION
from stickslip.paper.stick_slip import SPEED
from stickslip.paper.unpublished import Requirement
from stickslip.plots import (
    RUN_SIZES,
    Sizes,
    characteristic_sizes,
    draw_characteristics,
    draw_motion,
    draw_presliding,
    draw_run,
    draw_stribeck,
    inline_svg,
    presliding_sizes,
    schematic,
    symbol_label,
)
from stickslip.report import Columns, Figure, Paragraph, Section

RUN_FIGURES = {"coulomb": 6, "dahl": 7, "stribeck": 8, "lugre": 9, "coulomb-viscous": 10}
"""Numbers of the figures that show the block, by the law that their captions name."""
BLOCK_SIZES = Sizes(wide=(880, 270), narrow=(358, 520))


def schematic_section(found: PaperAudit) -> Section:
    """Return Figs 1 and 5: cart and rig with the paper's symbols."""
    values = found.values
    return Section(
        collapsed=True,
        id="systems",
        nav="Figs 1 and 5",
        heading="The two systems of the paper",
        blocks=(
            Columns(
                left=(
                    Figure(
                        svg=schematic(
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
                    Figure(
                        svg=schematic(
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


def phenomena_section(found: PaperAudit) -> Section:
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
        Figure(
            svg=inline_svg(
                draw_run(pulled.run, until=pulled.run.span[1]),
                alt="Displacement, velocity and friction of a block in stick-slip",
                prefix="stick-slip",
                **RUN_SIZES,
            ),
            caption=(
                "**III.B.1, stick-slip motion.** The block of Table I, pulled through its spring at"
                f" {1e3 * SPEED:g} mm/s (ours). It sticks for {pulled.stick_time:.3f} s and slips"
                f" for {pulled.slip_time:.3f} s, as the closed forms have it within a relative"
                f" {residue(error)}."
            ),
        )
    ]
    curve = next((law for law in laws.values() if isinstance(law, Stribeck)), None)
    if curve is not None:
        figures.append(
            Figure(
                svg=inline_svg(
                    draw_stribeck(curve, load),
                    alt="Stribeck curve with static level, Coulomb level and Stribeck velocity",
                    prefix="fig3",
                    wide=(880, 280),
                    narrow=(358, 260),
                ),
                caption="**Fig. 3. Stribeck effect.** $F_s$ and $F_c$ by Table I; $v_s$ is not"
                " printed, and assumed here. The vertical line is what the contact holds at rest.",
            )
        )
    figures += [
        Figure(
            svg=inline_svg(
                draw_presliding(bristle, load=load),
                alt="Friction force against displacement before slip",
                prefix="fig4",
                **presliding_sizes(len(bristle)),
            ),
            caption="**Fig. 4. Presliding displacement**: friction against a slow displacement to"
            " and fro, before slip and at its onset. The paper shows the measurement of its"
            " reference [13]; these are the corrected Dahl and LuGre laws.",
        ),
        Figure(
            svg=inline_svg(
                draw_characteristics(laws, load=load, v_max=0.5),
                alt="Friction force against slip velocity of the five models",
                prefix="laws-of-table2",
                **characteristic_sizes(len(laws)),
            ),
            caption="**The laws of Table II** against velocity, corrected. At rest, any force up"
            " to break-away; for bristle laws, the curve of steady sliding.",
        ),
    ]
    return Section(
        collapsed=True,
        id="phenomena",
        nav="Phenomena, Figs 3, 4",
        heading="Stick-slip, Stribeck effect and presliding, recomputed",
        blocks=tuple(figures),
    )


def figure_section(found: PaperAudit) -> Section:
    """Return Figs 6 to 10, the block with each law, in the order of the paper."""
    rows = {row.law.name: row for row in found.table}
    figures = [
        _run_figure(found, rows[name], number)
        for name, number in RUN_FIGURES.items()
        if name in rows
    ]
    own = (
        f"The block in readings A and {found.values.own_reading} with each model. Dashed: the"
        " measured travel."
    )
    text = (
        "The block in readings A and B with the values assumed for Table II, and a third run with"
        " the value that gives the published travel. Dashed: the published and the measured travel."
    )
    return Section(
        collapsed=True,
        id="figures",
        nav="The block" if found.own else "Figs 6 to 10",
        heading="The block with each law" if found.own else "The block with each law, recomputed",
        blocks=(Paragraph(text=own if found.own else text), *figures),
    )


def _run_figure(found: PaperAudit, row: TableRow, number: int) -> Figure:
    shown = [row.reading(key) for key in (found.values.own_reading, "A")]
    runs = {f"{reading.key}. {reading.title}": reading.run for reading in shown}
    need = found.requirement(row.law.name)
    if need is not None and need.run is not None:
        runs[_need_label(need, row, symbol_label(need.symbol))] = need.run
    if row.law.name == "stribeck" and found.creeps:
        creep = found.creeps[len(found.creeps) // 2]
        velocity = f"{significant(1e3 * creep.stribeck_velocity, 4)} mm/s"
        runs[f"(5) in 10 ms, {symbol_label('v_s')} = {velocity}"] = creep.run
    published = row.published.travel
    travels = [f"{r.key} {r.criteria.travel:.3f} m" for r in reversed(shown)]
    note = f" ({row.published.note})" if row.published.note else ""
    digits = 3 if found.own else 2
    levels = {} if published is None else {f"published, {published:.2f} m": published}
    printed = "" if published is None else f"Published travel {published:.2f} m{note}; ours "
    title = row.law.title if found.own else f"Fig. {number}. {row.law.title}"
    return Figure(
        svg=inline_svg(
            draw_motion(
                runs,
                levels=levels | {f"measured, {found.measured:.{digits}f} m": found.measured},
            ),
            alt=f"Displacement and velocity of the block with {row.law.title} friction",
            prefix=f"fig{number}",
            **BLOCK_SIZES,
        ),
        caption=f"**{title}.** {printed}{', '.join(travels)}.{_need_text(found, need, row)}",
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
