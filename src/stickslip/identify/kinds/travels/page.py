"""The page of a verdict on travels: law, band and figure on the first screen."""

import math
from functools import partial
from typing import Any, cast

from stickslip.identify import (
    THRESHOLDS,
    TITLES,
    draw_band,
    opening_section,
    parameters_section,
    remarks_section,
)
from stickslip.identify.candidates import in_sentence
from stickslip.identify.kinds.kind import page_table
from stickslip.identify.kinds.travels.verdict import TravelVerdict, columns_of, what_of
from stickslip.show.formatting import capital, count, joined, percent, quantity
from stickslip.show.plots import MAP_SIZES, inline_svg
from stickslip.show.report import (
    MOST,
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
from stickslip.show.report import Column as PageColumn


def sections(verdict: TravelVerdict, origin: Origin, remark: str) -> tuple[SectionMaker, ...]:
    """Return what makes the sections of the page of a verdict."""
    alike = cast("Any", verdict)  # sections that bands of friction have too
    return (
        partial(opening_section, alike, origin, remark, band_figure(verdict)),
        partial(laws_section, verdict),
        partial(parameters_section, alike),
        partial(trials_section, verdict),
        partial(remarks_section, alike),
        partial(record_and_checks, verdict.checks),
        partial(reproduce, origin, laws=[c.fit.law for c in verdict.candidates if c.fit]),
    )


def band_figure(verdict: TravelVerdict) -> Figure | None:
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
        f"**{capital(what)} over the {word}.** Points: readings. Line: {verdict.closest.title}."
        f" Band: where the {what} lies with 95 % at each setting, by {_made_of(verdict)}."
    )
    if verdict.places:
        text += " Dotted: where another reading narrows the band most."
    return Figure(svg=svg, caption=text)


def _made_of(verdict: TravelVerdict) -> str:
    """Return how many different laws the band holds, and what else."""
    titles = {one.name: in_sentence(one.title) for one in verdict.candidates}
    parts = [f"{number} {titles[name]}" for name, number in verdict.laws_drawn.items()]
    said = f"{parts[0]} laws" if parts else ""
    if len(parts) > 1:
        kinds = joined(parts) if len(parts) <= MOST else f"of {len(parts)} kinds"
        said = f"{count(sum(verdict.laws_drawn.values()), 'law')} ({kinds})"
    others = [said] if said else []
    if verdict.curve_share:
        others.append(f"the {TITLES['curve']}")
    if error := verdict.prediction_error:
        others.append(
            f"an error of {quantity(error, 'm/s', 2)} that they leave at held-out settings"
        )
    return joined(others)


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
            f" {math.log(THRESHOLDS.odds):.1f} of it cannot be distinguished. Shares of the band"
            " follow from how well laws predict held-out settings, whatever their parts: another"
            " law than the named one may have more."
            + (
                f" The {TITLES['curve']} has {percent(verdict.curve_share)}."
                if verdict.curve_share
                else ""
            )
        ),
    )
    number = len(verdict.set)
    heading = (
        "One law is left"
        if number == 1
        else f"{number} laws cannot be distinguished by these travels"
    )
    if not verdict.explained:
        heading = "No law explains these travels"
    return Section(id="models", nav="Laws", heading=heading, blocks=(table,))


def trials_section(verdict: TravelVerdict) -> Section | None:
    """Return each trial with what the named law predicts; None of one trial."""
    if verdict.closest.fit is None or len(verdict.trials) < 2:
        return None
    table, (_, unit) = verdict.compared(), what_of(verdict.trials)
    parts = {name: table[name].tolist() for name in ("measured", "predicted", "held_out_error")}
    if not verdict.ranked:
        del parts["held_out_error"]
    rows = tuple(
        Row(cells=(Name(text=str(name)), *(quantity(x[i], unit) for x in parts.values())))
        for i, name in enumerate(table.index)
    )
    heads = ("measured", verdict.closest.title, "held-out error")
    columns = (
        PageColumn(head="trial"),
        *(PageColumn(head=head, numeric=True) for head in heads[: len(parts)]),
    )
    caption = "Held-out errors are those of a setting that the law was not fitted to."
    return Section(
        id="trials", nav="Trials", heading="Each trial",
        blocks=(Table(columns=columns, rows=rows, caption=caption if verdict.ranked else ""),),
    )  # fmt: skip
