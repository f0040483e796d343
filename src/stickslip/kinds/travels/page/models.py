"""The models compared: their fitted runs, scores where there are any, and what each assumes."""

import math
from dataclasses import replace
from itertools import chain
from typing import Final

import numpy as np

from stickslip.formatting import (
    NO_VALUE,
    capital,
    fixed,
    in_words,
    number,
    quantity,
    span,
    with_unit,
)
from stickslip.friction import FrictionLaw
from stickslip.kinds.columns import page_table
from stickslip.kinds.travels.figures import TRAVEL_SIZES, draw_travels
from stickslip.kinds.travels.verdict import (
    TravelCandidate,
    TravelVerdict,
    columns_of,
    estimate_range,
    estimate_text,
)
from stickslip.mechanisms import slip_names
from stickslip.plots import inline_svg
from stickslip.quantities import fields_of
from stickslip.report import ERRORS, Axis, Block, Cell, Figure, Name, Section, Table
from stickslip.selection import friction_of, score_text

SAMPLES: Final = 4000
"""Times at which two runs are compared, beside the solver's own."""
CLOSE: Final = 0.02
"""Share of the travel below which a difference on the way is called close."""


def models_section(verdict: TravelVerdict) -> Section:
    """Return the section that compares the fitted laws."""
    blocks: list[Block] = []
    if verdict.best is not None and verdict.best.run is not None:
        blocks.append(_figure(verdict, verdict.best))
    blocks.append(_table(verdict))
    return Section(
        id="models", nav="Models compared", heading=_heading(verdict), blocks=tuple(blocks)
    )


def _heading(verdict: TravelVerdict) -> str:
    best = verdict.best
    target = f"{quantity(verdict.trials[0].travel, 'm')}"
    if best is None and verdict.closest is not None:
        return f"The best model, {verdict.closest.title}, does not explain the readings"
    if best is None:
        return "No model reaches the measured travel"
    if verdict.ranked and best.score is not None:
        scale = verdict.score_scale
        error = with_unit(score_text(scale, best.score, best.score_error).value, scale.unit)
        return f"{capital(friction_of(best.title))}: held-out error {error}"
    others = [c for c in verdict.explained if c is not best]
    gaps = [gap for c in others if (gap := largest_difference(verdict, c)) is not None]
    near = [gap for gap in gaps if gap <= CLOSE * abs(verdict.trials[0].travel)]
    if not near:
        return f"{best.title}, fitted to {target}" if not others else f"Models fitted to {target}"
    bound = number(_rounded_up(1e3 * max(near)))
    if len(others) == 1:
        who = "the other model stays"
    elif len(near) == len(others):
        who = f"all {in_words(len(others))} other models stay"
    else:
        stays = "stays" if len(near) == 1 else "stay"
        who = f"{in_words(len(near))} of the {in_words(len(others))} other models {stays}"
    return f"Fitted to {target}, {who} within {bound} mm of {best.title} throughout"


def _rounded_up(value: float) -> float:
    place = 10.0 ** math.floor(math.log10(value)) if value > 0 else 1.0
    return math.ceil(value / place - 1e-9) * place


def _figure(verdict: TravelVerdict, best: TravelCandidate) -> Figure:
    runs = {c.title: c.run for c in verdict.explained if c.run is not None}
    slip, _ = slip_names(verdict.mechanism)
    draw = draw_travels(runs, best.title, band=verdict.measured_band, slip=slip)
    first = "each law" if len(runs) > 1 else best.title
    setting = " in the first trial" if len(verdict.measurement.records()) > 1 else ""
    right = (
        " Right: the resolution that a position sensor needs to distinguish them."
        if len(runs) > 1
        else ""
    )
    left = "Left: travel" if right else "Travel against time"
    caption = f"**{first[0].upper() + first[1:]} as fitted.** {left}{setting}"
    if verdict.measured_band:
        caption += "; the band is the range of the measured travel"
    svg = inline_svg(
        draw, alt=f"Travel against time of {first} as fitted", prefix="travels", **TRAVEL_SIZES
    )
    return Figure(svg=svg, caption=f"{caption}.{right}")


def _table(verdict: TravelVerdict) -> Table:
    best, band = verdict.best, verdict.measured_band
    kind = next((e.interval for c in verdict.explained if c.fit for e in c.fit.estimates), "")
    is_range = band is not None and len(verdict.trials) == 1
    of = f"range for a travel\nof {span(*band, 'm')}" if is_range and band else kind or "interval"
    columns = columns_of(verdict)
    apart = columns[-1].page

    def unscored(one: TravelCandidate) -> Cell | None:
        aside = one.unscored.removeprefix("not scored: ")
        return Name(text="not scored", aside=aside) if one.score is None else None

    def fitted(one: TravelCandidate) -> Cell:
        if not one.ran or one.fit is None:
            return "no value"
        text = ", ".join(map(estimate_text, one.fit.estimates)) or "nothing"
        return Name(text=text, aside=_ranges(one)) if verdict.ranked else text

    def difference(one: TravelCandidate) -> Cell:
        gap = largest_difference(verdict, one) if one.ran else None
        return NO_VALUE if gap is None or one is best else number(1e3 * gap)

    def travel(one: TravelCandidate) -> Cell:
        if one.criteria is None:
            return f"{fixed(one.given.travel, 3)} as given"
        return fixed(one.criteria.travel, 3)

    return page_table(
        [replace(one, page=of) if one.page == "range" else one for one in columns],
        verdict.candidates,
        cells={
            "model": lambda one: Name(text=one.title),
            columns[1].page: lambda one: unscored(one) or columns[1].on_page(one),
            "fitted": fitted,
            of: lambda one: _ranges(one) or NO_VALUE,
            "not fitted": _not_fitted,
            "travel\nm": travel,
            apart: difference,
        },
        scale=verdict.score_scale,
        colour=lambda one: "c1" if one is best else "muted",
        chosen=lambda one: one is best,
        caption=_caption(verdict),
        axis=_axis(verdict),
    )


def _ranges(one: TravelCandidate) -> str:
    return ", ".join(map(estimate_range, one.fit.estimates)) if one.ran and one.fit else ""


def _not_fitted(one: TravelCandidate) -> str:
    """Return what was assumed of a law, or why it is dropped, and what became of it."""
    if not one.ran or one.criteria is None:
        return f"dropped: {one.dropped}"
    said = assumptions(one)
    if one.criteria.stop_time is None:
        said += "; still moves at the end"
    said = f"dropped: {one.dropped}" if one.dropped else said
    said += f"; not chosen: {one.passed_over}" if one.passed_over else ""
    return said if one.distinguished else f"{said}; not distinguished"


def assumptions(candidate: TravelCandidate) -> str:
    """Return the parameters that were neither measured nor fitted, with their values."""
    law: FrictionLaw = candidate.fit.law if candidate.fit else candidate.law
    quantities = fields_of(type(law))
    parts = [
        f"${quantities[name].symbol}$ {quantity(value, quantities[name].unit)}"
        for name in candidate.assumed
        for value in [getattr(law, name)]
        if value  # a viscous part of 0 is the absence of an assumption
    ]
    switch = ["held at its first stop"] if getattr(law, "static_switch", False) else []
    return ", ".join([*parts, *switch]) or "nothing"


def largest_difference(verdict: TravelVerdict, candidate: TravelCandidate) -> float | None:
    """Return how far a law is from the chosen one on the way at most [m]."""
    if verdict.best is None or verdict.best.run is None or candidate.run is None:
        return None
    slip, _ = slip_names(verdict.mechanism)
    one, other = verdict.best.run, candidate.run
    last = min(one.span[1], other.span[1])
    times = np.union1d(np.linspace(0.0, last, SAMPLES), one.t[one.t <= last])
    return float(np.max(np.abs(one.at(times)[slip] - other.at(times)[slip])))


def _axis(verdict: TravelVerdict) -> Axis | None:
    """Return the axis of the scores, logarithmic if they span more than 20 times."""
    factor = verdict.score_scale.factor
    scores = [factor * c.score for c in verdict.candidates if c.score is not None]
    if not verdict.ranked:
        return None
    if not any(scores):  # none, or readings that are met exactly
        return Axis(low=0.0, high=1.0, ticks=(0.0, 1.0), caption=ERRORS)
    low, high = max(min(scores), 1e-3 * max(scores)), max(scores)
    if high > 20 * low:
        powers = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
        ticks = tuple(10.0**power for power in powers)
        return Axis(low=ticks[0], high=ticks[-1], ticks=ticks, log=True, caption=ERRORS)
    errors = [factor * (c.score_error or 0.0) for c in verdict.candidates if c.score is not None]
    ends = (s + e for s, e in zip(scores, errors, strict=True) if math.isfinite(e))
    top = _rounded_up(max(chain([high], ends)))
    return Axis(low=0.0, high=top, ticks=(0.0, top / 2, top), caption=ERRORS)


def _caption(verdict: TravelVerdict) -> str:
    if not verdict.ranked:
        tail = ""
        if verdict.best is not None and len(verdict.explained) > 1:
            tail = f" {verdict.best.title} is named because it needs the fewest assumptions."
        return verdict.words.no_score + tail
    count = len(verdict.measurement.records())
    return (
        f"Held-out error: each of the {count} travels predicted from a fit to the other settings,"
        " root mean square. Intervals stand below the fitted values. Rule of choice: the simplest"
        " model that no richer model improves significantly (likelihood-ratio test at 2.5 %)."
        " Parameters that were neither measured, given nor fitted count as free, and models with"
        " such parameters are not scored."
    )
