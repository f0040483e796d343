"""The motion in figures and tables: run, cycles, events, criteria."""

import math
from collections.abc import Mapping, Sequence

import numpy as np

from stickslip.formatting import Scale, capital, count, joined, number, quantity, significant
from stickslip.plots import (
    CYCLE_SIZES,
    FORCE_SIZES,
    FRICTION_SIZES,
    RUN_SIZES,
    animation_html,
    draw_cycles,
    draw_friction_velocity,
    draw_run,
    horizon,
    inline_svg,
)
from stickslip.report.core.blocks import Animation, Block, Caption, Figure, KeyValue, KeyValues
from stickslip.report.core.documents import Section
from stickslip.report.core.tables import Cell, Column, Row, Table
from stickslip.report.runs.subject import RunReport
from stickslip.sweep import Band, DrivenCycle
from stickslip.trajectory import Event, Trajectory

FIRST_ROWS, LAST_ROWS = 6, 4
"""Cycles of which a table shows the first and the last."""
MOST_DRAWN, DRAWN = 12, 8
"""Cycles up to which all are drawn against time, and how many of more than that."""
ANIMATED = 12.0
"""Frames a second."""
STACKED = (520.0, 560.0)
"""Scene above time plots, in a column of the page [CSS px]."""
PHONE = (358.0, 560.0)
"""The same on a phone."""
SHORTEST, LONGEST = 3.0, 8.0
"""How long an animation takes [s]: what is faster is shown in slow motion, what is longer is cut
or sped up."""
ANIMATED_CYCLES = 2
SAMPLES = 2001
"""Times at which the width of a band is asked for."""
LINE = 0.01
"""Width of the line of a curve, as a share of its range."""
ROUNDING = 1e-9
"""Relative error of a travel that is 0: a law fitted to one travel reproduces it to rounding."""


def motion_section(about: RunReport) -> Section:
    """Return the run against time, and friction against velocity."""
    force = about.run["normal_force"]
    varies = bool(np.ptp(force) > 1e-9 * np.abs(force).max(initial=0.0))
    what = "Displacement, velocity, friction" + (" and normal force" if varies else "")
    caption = f"**{what}** against time"
    until = None
    if len(about.cycles) > MOST_DRAWN:
        until = about.cycles[DRAWN].begin
    caption += f"; yellow: the {about.part} sticks." if _sticks(about.run, until=until) else "."
    if until is not None:
        caption += f" Of {len(about.cycles)} cycles the first {DRAWN} are shown."
    if about.band is not None:
        shaded = "Shaded" if _seen(about, about.band) else "Narrower than the line"
        caption += (
            f" {shaded}: range of 95 % of {about.band.count} runs with uncertain parameters drawn,"
            " for displacement and velocity."
        )
    blocks = (
        Figure(
            svg=inline_svg(
                draw_run(
                    about.run,
                    slip=about.slip,
                    rate=about.rate,
                    until=until,
                    normal_force=varies,
                    band=about.band,
                ),
                alt=f"{what} against time",
                prefix="motion",
                **(FORCE_SIZES if varies else RUN_SIZES),
            ),
            caption=caption,
        ),
        Figure(
            svg=inline_svg(
                draw_friction_velocity(about.run, rate=about.rate, slip=about.slip, until=until),
                alt="Friction against velocity along the run",
                prefix="friction-velocity",
                **FRICTION_SIZES,
            ),
            caption="**Friction against velocity** along the run.",
        ),
    )
    return Section(id="motion", nav="Motion", heading="The motion", blocks=blocks)


def _seen(about: RunReport, band: Band) -> bool:
    """Whether the band is anywhere wider than the line that is drawn through it."""
    times = np.linspace(*about.run.span, SAMPLES)
    seen = about.run.at(times)
    return any(
        float(np.max(high - low)) > LINE * float(np.ptp(seen[name]))
        for name in band.states
        for low, _, high in [band.at(name, times)]
    )


def _sticks(run: Trajectory, begin: float = -math.inf, until: float | None = None) -> bool:
    """Whether a stick phase, which figures shade yellow, is in what they show."""
    end = math.inf if until is None else until
    return any(start < end and stop > begin for start, stop in run.stick_spans())


def cycles_section(about: RunReport) -> Section | None:
    """Return the travel of each cycle of the drives, None without whole cycles."""
    cycles = about.cycles
    if not cycles:
        return None
    last = cycles[-1]
    end = min(last.begin + last.period, about.run.span[1])
    runs = {about.law.title: about.run}
    figure = Figure(
        svg=inline_svg(
            draw_cycles(
                runs,
                chosen=about.law.title,
                cycle=(last.begin, end),
                slip=about.slip,
                rate=about.rate,
            ),
            alt="Displacement in all cycles, and the velocity in the last",
            prefix="cycles",
            **CYCLE_SIZES,
        ),
        caption="**All cycles, and the velocity in the last one**, near zero if the"
        f" {about.part} moves back in it."
        + (f" Yellow: the {about.part} sticks." if _sticks(about.run, last.begin, end) else ""),
    )
    blocks: list[Block] = [figure, _cycle_table(about)]
    if len(cycles) > FIRST_ROWS + LAST_ROWS:
        left = f"{FIRST_ROWS + 1} to {len(cycles) - LAST_ROWS}"
        blocks.append(Caption(text=f"Cycles {left} of {len(cycles)} are left out."))
    return Section(id="cycles", nav="Cycles", heading=_cycles_heading(about), blocks=tuple(blocks))


def _cycles_heading(about: RunReport) -> str:
    if not about.moves:
        return f"The {about.part} does not move in any cycle"
    if not about.cycles[-1].moves_on:
        return "The last cycle ends where it began"
    travels = [one.travel for one in about.cycles]
    advance = f"The {about.part} {about.advances(travels[-1])}"
    if len(travels) == 1:
        return f"{advance} in one cycle"
    if about.cycles[-1].repeats(about.cycles[-2]):
        return f"{advance} per cycle once the motion has settled"
    return f"{advance} in the last cycle and has not settled"


def _cycle_table(about: RunReport) -> Table:
    unit = "mm" if about.unit == "m" else f"m{about.unit}"
    heads = [f"travel\n{unit}"]
    heads += ["95 % band\n" + unit] if about.band is not None else []
    heads += [f"mean velocity\n{unit}/s", f"back-slip\n{unit}", f"lowest velocity\n{unit}/s"]
    heads.append("lowest normal force\nN")
    columns = [Column(head="")]
    columns += [Column(head=head, numeric=True, phone="label") for head in heads]
    cycles = about.cycles
    shown = list(range(len(cycles)))
    if len(cycles) > FIRST_ROWS + LAST_ROWS:
        shown = [*shown[:FIRST_ROWS], *shown[-LAST_ROWS:]]
    return Table(columns=tuple(columns), rows=tuple(_cycle_row(about, k, cycles[k]) for k in shown))


def _cycle_row(about: RunReport, place: int, one: DrivenCycle) -> Row:
    cells: list[Cell] = [f"cycle {place + 1}", _thousandth(one.advance, 4)]
    if about.band is not None:
        spreads = about.band.cycles
        low, _, high = spreads[place]
        cells.append(Scale(1e3, "").interval(low, high))
    cells += [_thousandth(value) for value in (one.advance / one.period, one.back_slip)]
    cells += [_thousandth(one.least_velocity), number(one.least_normal_force)]
    return Row(cells=tuple(cells))


def _thousandth(value: float, digits: int = 3) -> str:
    return significant(1e3 * value, digits) if abs(value) > 1e-12 else "0"


def animation_section(about: RunReport) -> Section | None:
    """Return the run as a moving picture, None where it is over at once."""
    first, last = about.run.span
    if about.cycles:
        until = first + ANIMATED_CYCLES * about.cycles[0].period
    else:
        until = horizon(about.run, about.slip)
    until = min(until, last)
    length = until - first
    if length <= 0.0:
        return None
    speed = length / min(max(length, SHORTEST), LONGEST)
    pace = "in real time"
    if abs(speed - 1.0) > 1e-9:
        pace = (
            f"slowed down {number(1.0 / speed, 2)} times"
            if speed < 1.0
            else f"sped up {number(speed, 2)} times"
        )
    html = animation_html(
        about.run,
        about.rig.mechanism,
        alt=f"The mechanism moves, with {about.law.title} friction",
        fps=ANIMATED,
        speed=speed,
        until=until,
        size=STACKED,
        narrow=PHONE,
    )
    sticks = f"The {about.part} is yellow where it sticks; arrows"
    said = sticks if _sticks(about.run, until=until) else "Arrows"
    caption = f"**The first {quantity(length, 's')}**, to scale, {pace}. {said} are forces."
    block = Animation(html=html, caption=caption)
    return Section(id="animation", nav="Animation", heading="Animation", blocks=(block,))


def events_section(about: RunReport) -> Section:
    """Return what happened how often, first and last."""
    events = about.run.events
    if about.fixed_step is not None or not events:
        text = "Fixed steps locate no events." if about.fixed_step is not None else "No events."
        blocks: Sequence[Block] = (Caption(text=text),)
        return Section(id="events", nav="Events", heading="Events", blocks=tuple(blocks))
    kinds = list(dict.fromkeys(event.reason for event in events))
    heading = f"{capital(count(len(events), 'event'))}: {joined(kinds)}"
    table = event_table({"": events})
    return Section(id="events", nav="Events", heading=heading, blocks=(table,))


def event_table(seen: Mapping[str, Sequence[Event]]) -> Table:
    """Return how often, and when first and last, each kind of event was seen at each contact.

    Contacts without a name have no column.
    """
    named = any(seen)
    rows = []
    for name, events in seen.items():
        for kind in dict.fromkeys(event.reason for event in events):
            times = [event.t for event in events if event.reason == kind]
            cells = (kind, f"{len(times):,}", f"{times[0]:.6f}", f"{times[-1]:.6f}")
            rows.append(Row(cells=(name, *cells) if named else cells))
    first = (
        (Column(head="contact"), Column(head="event", phone="label", label="event:"))
        if named
        else (Column(head="event"),)
    )
    columns = (
        *first,
        Column(head="count", numeric=True, phone="label", label="count:"),
        Column(head="first\ns", numeric=True, phone="label"),
        Column(head="last\ns", numeric=True, phone="label"),
    )
    return Table(columns=columns, rows=tuple(rows))


def criteria_section(about: RunReport) -> Section:
    """Return the three criteria of the source paper, evaluated on the run."""
    seen = about.criteria
    items = (
        KeyValue(
            key="1. The velocity never becomes negative",
            value=_held(
                seen.velocity_never_negative,
                f"lowest velocity {about.of(seen.least_velocity, 3, per_second=True)}",
            ),
            mark="ok" if seen.velocity_never_negative else "warn",
        ),
        KeyValue(
            key="2. The displacement never decreases",
            value=_held(
                seen.displacement_never_decreases,
                f"largest back-slip {about.of(seen.largest_return)}"
                if seen.travel >= 0.0
                else f"travel {about.of(seen.travel)}",
            ),
            mark="ok" if seen.displacement_never_decreases else "warn",
        ),
        KeyValue(
            key="3. Relative error of the travel",
            value=_third(about),
        ),
    )
    text = (
        f"A drive force larger than friction can move the {about.part} backwards, and elastic"
        f" bristles spring back when the {about.part} stops: failing criterion 1 or 2 does not"
        " refute the law."
    )
    blocks = (KeyValues(items=items), Caption(text=text))
    return Section(
        id="criteria", nav="Criteria", heading="The criteria of the source paper", blocks=blocks
    )


def _third(about: RunReport) -> str:
    """Return the error of the travel, or of all that were measured, in words."""
    error, measurement = about.criteria.relative_error, about.rig.measurement
    if error is not None:
        return f"{number(100.0 * error) if abs(error) > ROUNDING else 0} % of the measured one"
    if measurement is None or not measurement.travelled:
        return "no travel of this rig was measured"
    travels = () if about.validation is None else about.validation.travels
    errors = [one.relative_error for one in travels if one.relative_error is not None]
    if not errors:
        return "the measured travels were not compared"
    what = travels[0].quantity.replace("_", " ")
    if len(errors) == 1:
        return f"{number(100.0 * errors[0])} % of the measured {what}"
    ends = (number(100.0 * end) for end in (min(errors), max(errors)))
    return f"{' to '.join(ends)} % of {len(errors)} measured values ({what})"


def _held(holds: bool, found: str) -> str:
    return f"{'holds' if holds else 'does not hold'}: {found}"
