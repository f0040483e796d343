"""The models compared: their fitted runs, scores where there are any, and what each assumes."""

import math
from itertools import chain
from typing import Final

from stickslip.formatting import (
    NO_VALUE,
    Scale,
    capital,
    fixed,
    in_words,
    number,
    quantity,
    span,
    with_unit,
    within,
)
from stickslip.identification import Estimate
from stickslip.kinds.travels.figures import TRAVEL_SIZES, draw_travels
from stickslip.kinds.travels.page.texts import (
    assumptions,
    estimate_range,
    largest_difference,
    measured_band,
    score_scale_of,
    slip_and_rate,
    travels,
)
from stickslip.kinds.travels.verdict import TravelCandidate, TravelVerdict
from stickslip.plots import inline_svg
from stickslip.report import (
    ERRORS,
    Axis,
    Block,
    Cell,
    Colour,
    Column,
    Figure,
    Mark,
    Name,
    Number,
    Row,
    RowPlot,
    Section,
    Table,
)
from stickslip.selection import friction_of, score_text

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
    target = f"{quantity(travels(verdict)[0], 'm')}"
    if best is None and verdict.closest is not None:
        return f"The best model, {verdict.closest.title}, does not explain the readings"
    if best is None:
        return "No model reaches the measured travel"
    if verdict.ranked and best.score is not None:
        scale = score_scale_of(verdict)
        error = with_unit(score_text(scale, best.score, best.score_error).value, scale.unit)
        return f"{capital(friction_of(best.title))}: held-out error {error}"
    others = [c for c in verdict.explained if c is not best]
    gaps = [gap for c in others if (gap := largest_difference(verdict, c)) is not None]
    near = [gap for gap in gaps if gap <= CLOSE * abs(travels(verdict)[0])]
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
    slip, _ = slip_and_rate(verdict)
    draw = draw_travels(runs, best.title, band=measured_band(verdict), slip=slip)
    first = "each law" if len(runs) > 1 else best.title
    setting = " in the first trial" if len(verdict.measurement.records()) > 1 else ""
    right = (
        " Right: the resolution that a position sensor needs to distinguish them."
        if len(runs) > 1
        else ""
    )
    left = "Left: travel" if right else "Travel against time"
    caption = f"**{first[0].upper() + first[1:]} as fitted.** {left}{setting}"
    if measured_band(verdict):
        caption += "; the band is the range of the measured travel"
    svg = inline_svg(
        draw, alt=f"Travel against time of {first} as fitted", prefix="travels", **TRAVEL_SIZES
    )
    return Figure(svg=svg, caption=f"{caption}.{right}")


def _table(verdict: TravelVerdict) -> Table:
    axis, scale = _axis(verdict), score_scale_of(verdict)
    rows = []
    for candidate in verdict.candidates:
        is_best = candidate is verdict.best
        cells = _cells(verdict, candidate)
        if axis is not None:
            cells[1:1] = _score_cells(candidate, scale, is_best)
        rows.append(Row(cells=tuple(cells), chosen=is_best, muted=bool(candidate.dropped)))
    return Table(columns=_columns(verdict, axis), rows=tuple(rows), caption=_caption(verdict))


def _columns(verdict: TravelVerdict, axis: Axis | None) -> tuple[Column, ...]:
    band = measured_band(verdict)
    kind = next(
        (e.interval for c in verdict.explained if c.fit for e in c.fit.estimates), "interval"
    )
    is_range = band is not None and len(travels(verdict)) == 1
    of = f"range for a travel\nof {span(*band, 'm')}" if is_range and band else kind
    title = verdict.best.title if verdict.best else "the first"
    scores = (
        Column(head=f"held-out error\n{score_scale_of(verdict).unit}", numeric=True),
        Column(head="", axis=axis),
    )
    others = (
        Column(head="fitted", numeric=True),
        Column(head=of, numeric=True, phone="label", label="range"),
        Column(head="not fitted", phone="label", label="not fitted:"),
        Column(head="travel\nm", numeric=True, phone="hide"),
        Column(
            head=f"largest difference\nfrom {title}, mm",
            numeric=True,
            phone="label",
            label="differs by up to, mm",
        ),
    )
    if axis is not None:
        return (Column(head="model"), *scores, others[0], others[2])
    return (Column(head="model"), *(others if verdict.best else others[:-1]))


def _cells(verdict: TravelVerdict, candidate: TravelCandidate) -> list[Cell]:
    name = Name(text=candidate.title)
    if candidate.fit is None or candidate.criteria is None:
        given = fixed(candidate.given.travel, 3)
        reason = f"dropped: {candidate.dropped}"
        if verdict.ranked:
            return [name, "no value", reason]
        cells: list[Cell] = [name, "no value", NO_VALUE, reason, f"{given} as given"]
        return [*cells, NO_VALUE] if verdict.best else cells
    estimates = candidate.fit.estimates
    values = [f"${e.quantity.symbol}$ = {_value(e)}" for e in estimates]
    assumed = assumptions(candidate)
    if candidate.criteria.stop_time is None:
        assumed += "; still moves at the end"
    fitted, ranges = ", ".join(values) or "nothing", ", ".join(map(estimate_range, estimates))
    assumed = f"dropped: {candidate.dropped}" if candidate.dropped else assumed
    assumed += f"; not chosen: {candidate.passed_over}" if candidate.passed_over else ""
    if not candidate.distinguished:
        assumed += "; not distinguished"
    if verdict.ranked:
        return [name, Name(text=fitted, aside=ranges), assumed]
    cells = [name, fitted, ranges or NO_VALUE, assumed]
    cells.append(fixed(candidate.criteria.travel, 3))
    if verdict.best is None:
        return cells
    gap = largest_difference(verdict, candidate)
    apart = NO_VALUE if gap is None or candidate is verdict.best else number(1e3 * gap)
    return [*cells, apart]


def _value(estimate: Estimate) -> str:
    value = within(estimate.value, estimate.low, estimate.high)
    return with_unit(value, estimate.quantity.unit)


def _score_cells(candidate: TravelCandidate, scale: Scale, is_best: bool) -> list[Cell]:
    if candidate.score is None:
        return [
            Name(text="not scored", aside=candidate.unscored.removeprefix("not scored: ")),
            RowPlot(marks=()),
        ]
    score, error = (scale.factor * part for part in (candidate.score, candidate.score_error or 0.0))
    colour: Colour = "c1" if is_best else "muted"
    marks = (
        Mark(kind="bar", at=max(score - error, 0.0), to=score + error, colour=colour),
        Mark(kind="dot", at=score, colour=colour),
    )
    value, doubt = score_text(scale, candidate.score, candidate.score_error)
    return [Number(value=value, doubt=doubt), RowPlot(marks=marks)]


def _axis(verdict: TravelVerdict) -> Axis | None:
    """Return the axis of the scores, logarithmic if they span more than 20 times."""
    factor = score_scale_of(verdict).factor
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
