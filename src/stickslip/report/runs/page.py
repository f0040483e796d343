"""The report of a run as a page."""

from functools import partial

from stickslip.experiments import equated, unfitted_bristles
from stickslip.formatting import count, joined, quantity
from stickslip.plots import VALIDATION_SIZES, draw_validation, inline_svg
from stickslip.report.core.blocks import Block, Caption, Fact, Figure
from stickslip.report.core.documents import Opening, Page, Section, colophon, made_sections
from stickslip.report.core.page import render
from stickslip.report.core.shared_sections import ended_early
from stickslip.report.core.tables import Column, Row, Table
from stickslip.report.runs.appendix import (
    certificate_section,
    law_section,
    reproduce_section,
)
from stickslip.report.runs.motion import (
    animation_section,
    criteria_section,
    cycles_section,
    events_section,
    motion_section,
)
from stickslip.report.runs.subject import RunReport
from stickslip.sweep import Validation

MOST_RECORDS = 4
"""Records that have a figure."""
HEADINGS = {
    True: "What was measured agrees with the prediction",
    False: "What was measured does not agree with the prediction",
    None: "What was measured beside the prediction",
}


def validation_section(about: RunReport) -> Section | None:
    """Return what was measured beside the prediction, None where nothing was compared."""
    seen = about.validation
    if seen is None:
        return None
    verdict, *rest = seen.sentences()
    blocks: list[Block] = [Caption(text=verdict)]
    for index in range(min(len(seen.records), MOST_RECORDS)):
        name = seen.records[index].name or f"record {index + 1}"
        band = "; shaded: 95 % band of the prediction, without noise" if seen.drawn else ""
        svg = inline_svg(
            draw_validation(seen, record=index),
            alt=f"Measured and predicted, {name}",
            prefix=f"validation-{index}",
            **VALIDATION_SIZES,
        )
        label = f" ({name})" if len(seen.records) > 1 else ""
        blocks.append(
            Figure(svg=svg, caption=f"**Measured and predicted**{label}, and residual{band}.")
        )
    if seen.travels:
        blocks.append(_travels(seen))
    blocks += [Caption(text=text) for text in rest]
    if about.refit:
        blocks.append(Caption(text="**Refitted to this measurement.** " + " ".join(about.refit)))
    return Section(
        id="validation", nav="Measured", heading=HEADINGS[seen.agrees], blocks=tuple(blocks)
    )


def _travels(seen: Validation) -> Table:
    heads = ("measured", "predicted", "95 % band", "meets it")
    columns = (
        Column(head="trial"),
        Column(head="quantity", phone="label", label="quantity:"),
        *(Column(head=head, numeric=True, phone="label", label=f"{head}:") for head in heads),
    )
    rows = (
        Row(cells=(one.name, one.quantity.replace("_", " "), *one.cells())) for one in seen.travels
    )
    return Table(columns=columns, rows=tuple(rows))


def opening_section(about: RunReport) -> Section:
    """Return the headline with its numbers, and what the run cannot tell."""
    opening = Opening(
        kicker=f"{about.rig.heading}, {about.law.title} friction",
        verdict=_headline(about),
        lede=_lede(about),
        facts=_facts(about),
        settles=_settles(about),
        cannot_tell=_cannot_tell(about),
        record="run",
    )
    return Section(id="result", nav="Result", heading="", blocks=(opening,))


def _headline(about: RunReport) -> str:
    run, seen, part = about.run, about.criteria, about.part
    if not run.status.complete:
        return ended_early(run.span[1])
    if not about.moves:
        return f"The {part} does not move"
    if about.cycles:
        last = about.cycles[-1]
        if not last.moves_on:
            return f"The {part} makes no net motion: the last cycle ends where it began"
        way = "moves" if last.travel > 0.0 else "moves back"
        return (
            f"The {part} {way} {about.of(abs(last.travel))} in a cycle of"
            f" {quantity(last.period, 's')}"
        )
    if seen.stop_time is not None:
        after = quantity(seen.stop_time, "s")
        return f"The {part} comes to rest {about.of(seen.travel)} from its start, after {after}"
    return f"The {part} has moved {about.of(seen.travel)} after {quantity(run.span[1], 's')}"


def _lede(about: RunReport) -> str:
    said = [about.run.ending]
    if about.cycles:
        number = count(len(about.cycles), "whole cycle")
        travel = sum(one.travel for one in about.cycles)
        if about.moves:
            said.append(f"The {about.part} {about.advances(travel, 4)} in {number}.")
    resting = _resting(about, about.cycles[-1].advance if about.cycles else about.criteria.travel)
    said += [f"The travel {resting.removeprefix('; ')}."] if resting else []
    band = about.band
    if band is not None:
        travels = about.range_beside(band.travel, about.criteria.travel)
        said.append(
            f"With uncertain parameters drawn, the travel of the whole run is"
            f" {travels} in 95 % of {band.count} runs."
        )
        said += band.reasons
    return " ".join(said)


def _facts(about: RunReport) -> tuple[Fact, ...]:
    band, seen = about.band, about.criteria
    moved = about.cycles[-1].advance if about.cycles else seen.travel
    travel = Fact(
        value=about.of(seen.travel, 4),
        aside="" if band is None else about.range_beside(band.travel, seen.travel),
        what=f"travel in the whole run{_resting(about, moved)}",
    )
    mean = Fact(
        value=about.of(about.mean_velocity, per_second=True),
        aside=""
        if band is None
        else about.range_beside(band.mean_velocity, about.mean_velocity, per_second=True),
        what="mean velocity over whole cycles" if about.cycles else "mean velocity of the run",
    )
    slip = about.cycles[-1].back_slip if about.cycles else seen.largest_return
    name = "back-slip in the last cycle" if about.cycles else "largest back-slip"
    back = Fact(value=about.of(slip), what=f"{name}{_resting(about, slip)}")
    return travel, mean, back


def _resting(about: RunReport, distance: float) -> str:
    """Return on which bristles a distance rests that no measurement determined, behind a comma."""
    found = unfitted_bristles(about.law, about.estimates, distance, about.rig.mechanism)
    return f"; depends on {joined(list(found))}, which no measurement determined" if found else ""


def _settles(about: RunReport) -> tuple[str, ...]:
    if about.fixed_step is not None:
        step = quantity(about.fixed_step, "s")
        return (f"The solution in fixed steps of {step}; events are not located.",)
    if not about.run.certificate.certified:
        return ()
    return ("The solution of the equations with this law: the run is certified.",)


def _cannot_tell(about: RunReport) -> tuple[str, ...]:
    said = []
    if about.law_file:
        said.append(
            "Whether this contact has the same friction as the one to which the law was fitted."
        )
    said += [
        f"By how much static friction exceeds sliding friction: ${own}$ was neither measured nor"
        f" given and is set equal to ${other}$."
        for own, other in equated(about.law).values()
    ]
    if about.estimates is None:
        said.append("The uncertainty of the motion: the law has no intervals.")
    elif about.band is None:
        said.append(
            "The uncertainty of the motion: `--ensemble 200` computes it from the law's intervals."
        )
    else:
        said.append(f"How the {about.part} would move with another law that fits the data as well.")
    if not about.run.status.complete:
        said.append("The motion after the run ended.")
    return tuple(said)


SECTIONS = (
    opening_section,
    motion_section,
    validation_section,
    cycles_section,
    animation_section,
    events_section,
    criteria_section,
    law_section,
    certificate_section,
    reproduce_section,
)


def run_page(about: RunReport) -> str:
    """Return the report of a run as one HTML file.

    A section that cannot be made is a line on the page that says why.

    Examples
    --------
    >>> from stickslip import Coulomb, Rig, SpringBlock, simulate
    >>> rig = Rig(title="Block", mechanism=SpringBlock(mass=1.0, stiffness=100.0, compression=0.1))
    >>> law = Coulomb(kinetic_coefficient=0.25)
    >>> run = simulate(rig.mechanism, law, t_end=1.0)
    >>> page = run_page(RunReport(rig=rig, law=law, run=run))
    >>> "The block comes to rest" in page, "could not be made" in page
    (True, False)
    """
    sections = made_sections(*(partial(make, about) for make in SECTIONS))
    return render(
        Page(
            title=f"{about.rig.heading}: {about.law.title} friction",
            subject=about.rig.path or about.rig.heading,
            sections=sections,
            footer=colophon(about.versions),
            kicker="simulation report",
        )
    )
