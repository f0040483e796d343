"""The chosen run, the laws as curves, and fixed steps beside the exact run."""

import math
from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from stickslip.formatting import fixed, joined, quantities, quantity, significant
from stickslip.friction import FrictionLaw
from stickslip.kinds.travels.verdict import TravelVerdict
from stickslip.mechanisms import slip_names
from stickslip.plots import (
    FRICTION_SIZES,
    RUN_SIZES,
    characteristic_sizes,
    draw_characteristics,
    draw_fixed_steps,
    draw_friction_velocity,
    draw_presliding,
    draw_run,
    fixed_step_sizes,
    inline_svg,
    presliding_sizes,
)
from stickslip.report import Block, Caption, Column, Figure, Row, Section, Table
from stickslip.selection import FixedStepRow, compare_fixed_steps, largest_step, rounded_step
from stickslip.trajectory import Trajectory

MOST_EVENTS = 4
STEPS: Final = (50.0, 500.0)
"""Fixed steps from the start to the stop, in the runs that are compared."""
LOST: Final = 1e3
"""Travel of a fixed-step run that is only garbage [m]; four decimals of it would be a line long."""
MOST_STEPS: Final = 2e4
"""Steps to the end of a run that is made only because bristles need it: a second or two."""


def run_section(verdict: TravelVerdict) -> Section | None:
    """Return the section on the chosen run, None if no law was chosen."""
    best = verdict.best
    if best is None or best.run is None or best.criteria is None:
        return None
    slip, rate = slip_names(verdict.mechanism)
    part = verdict.mechanism.moving_part
    stop = best.criteria.stop_time
    if stop is None:
        heading = f"With {best.title} friction the {part} does not come to rest"
    else:
        heading = (
            f"With {best.title} friction the {part} stops after {quantity(stop, 's')} and stays"
            " at rest"
        )
    blocks = (
        Figure(
            svg=inline_svg(
                draw_run(best.run, slip=slip, rate=rate),
                alt=f"Displacement, velocity and friction against time, {best.title}",
                prefix="chosen",
                **RUN_SIZES,
            ),
            caption=f"**The run of the chosen law.** {_events(best.run)}",
        ),
        Figure(
            svg=inline_svg(
                draw_friction_velocity(best.run, rate=rate, slip=slip),
                alt=f"Friction against velocity along the run, {best.title}",
                prefix="friction-velocity",
                **FRICTION_SIZES,
            ),
            caption="**Friction against velocity** along the same run.",
        ),
    )
    return Section(id="run", nav="Chosen law", heading=heading, blocks=blocks)


def _events(run: Trajectory) -> str:
    """Say what happens when, in one sentence."""
    if not run.events:
        return "There are no events."
    first = run.events[:MOST_EVENTS]
    times = quantities([event.t for event in first], "s")
    said = [f"{event.reason} at {t}" for event, t in zip(first, times, strict=True)]
    more = len(run.events) - MOST_EVENTS
    tail = f"; {more} more events" if more > 0 else ""
    return f"Dots are events: {joined(said) if not tail else ', '.join(said)}{tail}."


def laws_section(verdict: TravelVerdict) -> Section | None:
    """Return the section with the fitted laws as curves."""
    laws = {c.title: c.fit.law for c in verdict.explained if c.fit is not None}
    best = verdict.best
    if best is None or best.run is None or best.title not in laws:
        return None
    _, rate = slip_names(verdict.mechanism)
    v_max = float(np.max(np.abs(best.run[rate])))
    load = float(np.median(best.run["normal_force"]))
    blocks: list[Block] = [_characteristics(laws, load, v_max, best.title)]
    bristle = _bristle(laws)
    if bristle:
        guessed = [c.title for c in verdict.explained if "bristle_stiffness" in c.assumed]
        blocks.append(_presliding(bristle, load, guessed))
    heading = "Fitted laws as curves" if len(laws) > 1 else f"{best.title} friction as a curve"
    return Section(id="laws", nav="The laws", heading=heading, blocks=tuple(blocks))


def _bristle(laws: Mapping[str, FrictionLaw]) -> dict[str, FrictionLaw]:
    return {title: law for title, law in laws.items() if law.states}


def _characteristics(
    laws: Mapping[str, FrictionLaw], load: float, v_max: float, chosen: str
) -> Figure:
    svg = inline_svg(
        draw_characteristics(laws, load, v_max, chosen=chosen),
        alt="Friction against slip velocity of each fitted law",
        prefix="laws",
        **characteristic_sizes(len(laws)),
    )
    bristle = joined(list(_bristle(laws)))
    others = " Other laws in grey." if len(laws) > 1 else ""
    steady = f"; for {bristle} the curve is that of steady sliding" if bristle else ""
    return Figure(
        svg=svg,
        caption=f"**Each law as fitted**, at the load of {quantity(load, 'N')}.{others} At rest,"
        f" friction takes any value on the vertical line{steady}.",
    )


def _presliding(laws: Mapping[str, FrictionLaw], load: float, guessed: Sequence[str]) -> Figure:
    svg = inline_svg(
        draw_presliding(laws, load=load),
        alt="Friction against slow oscillating displacement, before full slip",
        prefix="presliding",
        **presliding_sizes(len(laws)),
    )
    caption = (
        "**Before full slip** the contact is elastic: friction against a slow oscillating"
        " displacement of growing amplitude."
    )
    if guessed:
        caption += f" The stiffness of {joined(guessed)} is assumed, not measured."
    return Figure(svg=svg, caption=caption)


def fixed_steps_section(verdict: TravelVerdict) -> Section | None:
    """Return the section on what fixed steps make of the run, None if no law was chosen."""
    best = verdict.best
    if best is None or best.fit is None or best.run is None:
        return None
    law, trial = best.fit.law, verdict.trials[0]
    last = best.run.span[1]
    stop = best.criteria.stop_time if best.criteria else None
    until = min(2.0 * stop, last) if stop else last
    limit = largest_step(trial.mechanism, law, best.run)
    steps = _steps(stop or last / 20.0, until, limit)
    rows = compare_fixed_steps(trial.mechanism, law, t_end=until, y0=trial.initial, steps=steps)
    blocks: list[Block] = [_steps_table(rows)]
    shown = [row for row in rows if row.dt is not None and not row.diverged]
    if shown:
        runs = {
            f"{quantity(row.dt or 0.0, 's')}, {'' if row.stick_rule else 'no '}stick rule": row.run
            for row in reversed(shown)
            if row.dt == shown[0].dt
        }
        _, rate = slip_names(verdict.mechanism)
        svg = inline_svg(
            draw_fixed_steps(best.run, runs, rate=rate),
            alt="Velocity of the exact run and with fixed steps",
            prefix="fixed-steps",
            **fixed_step_sizes(len(runs)),
        )
        stops = any(event.to_mode == 0 for event in best.run.events)
        when = "around the stop" if stops else "at the end of the run"
        caption = (
            f"**Velocity {when}.** Each panel covers the same number of steps; dots are steps."
        )
        blocks.insert(0, Figure(svg=svg, caption=caption))
    if limit is not None and limit < max(steps):
        text = (
            f"The bristles of this law need steps below {quantity(limit, 's', 2)}: with larger"
            " steps, forward Euler is unstable."
        )
        blocks.append(Caption(text=text))
    return Section(
        id="steps", nav="Fixed steps", heading=steps_heading(rows, limit), blocks=tuple(blocks)
    )


def _steps(stop: float, until: float, limit: float | None) -> tuple[float, ...]:
    """Return the steps to compare: parts of the time to the stop, and one that bristles allow."""
    steps = [rounded_step(stop / parts) for parts in STEPS]
    if limit is not None and limit < steps[-1] and until < MOST_STEPS * limit:
        steps.append(rounded_step(limit / 2.0))
    return tuple(steps)


def steps_heading(rows: Sequence[FixedStepRow], limit: float | None = None) -> str:
    """Return what the comparison shows, or its topic if it shows nothing.

    Examples
    --------
    >>> steps_heading([])
    'Fixed steps and the exact run'
    """
    large = [row.dt for row in rows if row.dt and (row.diverged or row.dt > (limit or math.inf))]
    if large:
        return f"A fixed step of {quantity(min(large), 's')} is too large for this law"
    shown = max((row.dt for row in rows if row.dt is not None), default=None)  # in the panels
    worst = max((r for r in rows if r.dt == shown), key=lambda row: row.reversals, default=None)
    exact = next((row.reversals for row in rows if row.dt is None), 0)
    extra = worst.reversals - exact if worst else 0
    if worst is None or worst.dt is None or extra == 0:
        return "Fixed steps and the exact run"
    times = "once" if extra == 1 else f"{extra:,} times"
    rule = "" if worst.stick_rule else " without a stick rule"
    more = " more than the exact run" if exact else ""
    step = quantity(worst.dt, "s")
    return f"With a fixed step of {step}{rule}, the velocity reverses {times}{more}"


def _travel(travel: float) -> str:
    return fixed(travel, 4) if abs(travel) < LOST else significant(travel, 2)


def _steps_table(rows: Sequence[FixedStepRow]) -> Table:
    columns = (
        Column(head="step"),
        Column(head="stick rule", phone="label", label="stick rule:"),
        Column(head="travel\nm", numeric=True, phone="label"),
        Column(head="difference\nmm", numeric=True, phone="label"),
        Column(head="lowest velocity\nmm/s", numeric=True, phone="label"),
        Column(head="reversals", numeric=True, phone="label"),
    )
    exact = next((row.criteria.travel for row in rows if row.dt is None), None)
    out = []
    for row in rows:
        if row.diverged and row.dt is not None:
            when = f"diverges within {quantity(row.run.span[1], 's')}"
            rule = "yes" if row.stick_rule else "no"
            out.append(Row(cells=(quantity(row.dt, "s"), rule, when, "—", "—", "—")))
            continue
        gap = None if exact is None or row.dt is None else row.criteria.travel - exact
        least = row.criteria.least_velocity
        out.append(
            Row(
                cells=(
                    "exact, event-driven" if row.dt is None else quantity(row.dt, "s"),
                    "located events" if row.dt is None else "yes" if row.stick_rule else "no",
                    _travel(row.criteria.travel),
                    "—" if gap is None else significant(1e3 * gap, 2),
                    "0" if abs(least) < 1e-9 else significant(1e3 * least, 2),
                    f"{row.reversals:,}",
                ),
                chosen=row.dt is None,
            )
        )
    caption = (
        "Travel at the end of the run. With a fixed step, a reversal is detected one step late;"
        " the stick rule then holds the body, and without it the velocity chatters about zero."
        " Out of rest, friction is at its break-away level in the first step."
    )
    return Table(columns=columns, rows=tuple(out), caption=caption)
