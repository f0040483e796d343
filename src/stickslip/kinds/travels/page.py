"""The page of a verdict on travels: law, band and figure on the first screen."""

import math
from functools import partial
from typing import Any, cast

from stickslip.formatting import NO_VALUE, capital, percent
from stickslip.identify import (
    THRESHOLDS,
    TITLES,
    draw_band,
    opening_section,
    parameters_section,
    remarks_section,
)
from stickslip.kinds.columns import page_table
from stickslip.kinds.travels.verdict import TravelVerdict, columns_of, records_of
from stickslip.plots import MAP_SIZES, inline_svg
from stickslip.report import Column as PageColumn
from stickslip.report import (
    Figure,
    Name,
    Origin,
    Row,
    Section,
    SectionMaker,
    Table,
    record_and_checks,
    reproduce,
)


def sections(verdict: TravelVerdict, origin: Origin, remark: str) -> tuple[SectionMaker, ...]:
    """Return what makes the sections of the page of a verdict."""
    alike = cast("Any", verdict)  # sections that bands of friction have too
    return (
        partial(opening_section, alike, origin, remark),
        partial(figure_section, verdict),
        partial(laws_section, verdict),
        partial(parameters_section, alike),
        partial(trials_section, verdict),
        partial(remarks_section, alike),
        partial(record_and_checks, verdict.checks),
        partial(reproduce, origin, laws=[c.fit.law for c in verdict.candidates if c.fit]),
    )


def figure_section(verdict: TravelVerdict) -> Section | None:
    """Return the figure of the readings, the band and the law; None without a band."""
    if verdict.travel is None or verdict.judgement.knob is None:
        return None
    drawing = verdict.drawing()
    word, what = drawing.names
    svg = inline_svg(
        draw_band(drawing),
        alt=f"{capital(what)} against {word}: readings, the 95 % band and the named law",
        prefix="band-figure",
        **MAP_SIZES,
    )
    text = (
        f"**{capital(what)}.** Points: readings. Line: {verdict.closest.title}. Band: where the"
        f" {what} lies with 95 % at each setting, whichever law, or the measured curve, holds."
    )
    if verdict.places:
        text += " Dotted: where another reading narrows the band most."
    block = Figure(svg=svg, caption=text)
    return Section(
        id="band", nav="Band", heading=f"{capital(what)} over the {word}", blocks=(block,)
    )


def laws_section(verdict: TravelVerdict) -> Section:
    """Return the table of the laws."""
    table = page_table(
        columns_of(verdict),
        verdict.candidates,
        cells={},
        scale=verdict.scale,
        colour=lambda one: "c1" if one is verdict.best else "muted",
        chosen=lambda one: one is verdict.best,
        caption=(
            "The law with the most evidence is named: it fits with few and usual parts. Laws within"
            f" {math.log(THRESHOLDS.odds):.1f} of it are not told apart. The band is made of all"
            f" laws by how well they predict, and to {percent(verdict.curve_share)} of the"
            f" {TITLES['curve']}."
        ),
    )
    number = len(verdict.set)
    heading = (
        "One law is left" if number == 1 else f"{number} laws are not told apart by these travels"
    )
    if not verdict.explained:
        heading = "The measured curve predicts better than every law"
    return Section(id="models", nav="Laws", heading=heading, blocks=(table,))


def trials_section(verdict: TravelVerdict) -> Section | None:
    """Return each trial with what the named law predicts; None of one trial."""
    fit = verdict.closest.fit
    if fit is None or len(verdict.trials) < 2:
        return None
    held_out = verdict.judgement.best_of(verdict.closest.name).held_out
    rows = tuple(
        Row(
            cells=(
                Name(text=record.name or f"trial {i}"),
                trial.as_read(trial.travel),
                trial.as_read(predicted),
                trial.as_read(left) if verdict.ranked else NO_VALUE,
            )
        )
        for i, (record, trial, predicted, left) in enumerate(
            zip(
                records_of(verdict.measurement),
                verdict.trials,
                fit.predicted,
                held_out,
                strict=True,
            ),
            1,
        )
    )
    columns = (
        PageColumn(head="trial"),
        PageColumn(head="measured", numeric=True),
        PageColumn(head=verdict.closest.title, numeric=True),
        PageColumn(head="held-out error", numeric=True, phone="label"),
    )
    caption = "Held-out errors are those of a setting that the law was not fitted to."
    table = Table(columns=columns, rows=rows, caption=caption)
    return Section(id="trials", nav="Trials", heading=capital("each trial"), blocks=(table,))
