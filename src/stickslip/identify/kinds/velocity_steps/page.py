"""Sections of the page of a selection on velocity steps."""

import math
from typing import Final

import numpy as np

from stickslip.friction import RATE_STATE_FORMS
from stickslip.identify.candidates import score_text
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds.kind import page_table
from stickslip.identify.kinds.velocity_steps.result import SETTLED, RateStateFit
from stickslip.identify.kinds.velocity_steps.verdict import (
    COEFFICIENT,
    COLUMNS,
    RateStateCandidate,
    RateStateVerdict,
)
from stickslip.quantities import fields_of
from stickslip.show.formatting import (
    Scale,
    count,
    in_words,
    joined,
    number,
    parameter_words,
    quantity,
    ratio,
    significant,
    with_unit,
)
from stickslip.show.plots import (
    ERROR_SIZES,
    ErrorSeries,
    Piece,
    draw_pieces,
    draw_prediction_error,
    draw_residuals,
    inline_svg,
    panel_of,
    piece_sizes,
    residual_sizes,
    sampled,
)
from stickslip.show.report import (
    Block,
    Column,
    Fact,
    Figure,
    KeyValue,
    LawLine,
    Name,
    Number,
    Origin,
    PageSections,
    Paragraph,
    Row,
    Section,
    Subheading,
    Table,
    candidates_heading,
    label_of,
    opening,
    parameters,
    record_and_checks,
    reproduce,
    typeset,
)

MILLI: Final = Scale(1e3, "10⁻³")
"""Errors of coefficients in figures."""
SHOWN: Final = ("reference_coefficient", "direct_effect", "evolution_effect")
"""Parameters that the code of a law names even where they are 0."""


def opening_section(verdict: RateStateVerdict, kicker: str, remark: str = "") -> Section:
    """Return the section that a reader may stop after."""
    words, fit = verdict.words, _fit(verdict)
    return opening(
        words,
        kicker,
        remark,
        symbols=_symbols(fit),
        law=_law_lines(fit),
        facts=_facts(verdict, fit),
        no_score=words.no_score,
    )


def _fit(verdict: RateStateVerdict) -> RateStateFit:
    assert verdict.closest.fit is not None
    return verdict.closest.fit


def _symbols(fit: RateStateFit) -> list[str]:
    return [e.quantity.symbol for e in fit.estimates]


def _law_lines(fit: RateStateFit) -> tuple[LawLine, ...]:
    """Return the parameters of the law, then what of the mechanism was fitted."""
    found = {e.path: e for e in fit.estimates}
    lines = []
    for name, symbol in fields_of(type(fit.law)).items():
        value = getattr(fit.law, name)
        if name != "reference_velocity" and name not in RATE_STATE_FORMS[fit.law.name].fit_order:
            continue
        estimate = found.get(f"friction.{name}")
        text = estimate.plus_minus if estimate else _held_text(name, quantity(value, symbol.unit))
        lines.append(LawLine(label=parameter_words(name), formula=f"${symbol.symbol}$ = {text}"))
    for path, estimate in found.items():
        if not path.startswith("friction."):
            name = path.rpartition(".")[2]
            text = f"${estimate.quantity.symbol}$ = {estimate.plus_minus}"
            lines.append(LawLine(label=name, formula=text))
    return tuple(lines)


def _held_text(name: str, value: str) -> str:
    return value if name == "reference_velocity" else f"{value}, held"


def _facts(verdict: RateStateVerdict, fit: RateStateFit) -> tuple[Fact, ...]:
    value, doubt = score_text(COEFFICIENT, verdict.closest.score, verdict.closest.score_error)
    facts = [
        Fact(
            value=value,
            aside=doubt,
            what=f"held-out error of the coefficient, on {_held(verdict)}, ± 1 standard error",
        )
    ]
    if fit.rate.interval != "known":
        shown, half = fit.rate.parts
        symbols = " − ".join(f"${symbol}$" for symbol in fit.rate_symbols)
        what = (
            f"{symbols}: lasting change of the coefficient where the speed rises by a factor of e,"
            " 95 % interval"
        )
        facts.append(Fact(value=shown, aside=half, what=what))
    speeds = fit.problem.record.path.lasting
    steps = len(fit.problem.record.path.steps)
    facts.append(
        Fact(
            value=count(steps, "velocity step"),
            what=f"between {quantity(float(speeds.min()), 'm/s')} and"
            f" {quantity(float(speeds.max()), 'm/s')}, in {len(fit.time):,} samples",
        )
    )
    return tuple(facts)


def _held(verdict: RateStateVerdict) -> str:
    return (
        "velocity steps that no fit has seen"
        if verdict.by_steps
        else "parts of the record that no fit has seen"
    )


def _others(verdict: RateStateVerdict) -> list[RateStateCandidate]:
    """Return the closest law and what it is compared with in figures: its rival or the next."""
    rest = [c for c in verdict.candidates[1:] if c.fit is not None and c.unseen is not None]
    # a richer law that is not established mostly coincides with the closest
    name = verdict.closest.name
    rest.sort(key=lambda c: (c.name != verdict.rival, name in c.simpler, c.score))
    return [verdict.closest, *rest[:1]]


def friction_section(verdict: RateStateVerdict) -> Section:
    """Return the section with the coefficient over time, and what is held out of it."""
    fit = _fit(verdict)
    slider, shown = fit.problem, _others(verdict)
    t = slider.mean_time
    curves = {c.title: slider.mean - c.fit.best.residual / slider.weight for c in shown if c.fit}
    step = max(slider.record.path.steps, key=lambda at: _change(fit, float(at)))
    close = _about(fit, float(step))
    pieces = [
        Piece(name, t[rows], slider.mean[rows], {title: y[rows] for title, y in curves.items()})
        for name, rows in (
            ("the whole record", sampled(len(t))),
            (f"about the step at {quantity(float(step), 's')}", np.flatnonzero(close)),
        )
    ]
    record = inline_svg(
        draw_pieces(pieces, "coefficient", "1", chosen=verdict.closest.title),
        alt=f"Coefficient of friction over time, measured and by {joined(list(curves))}",
        prefix="friction-figure",
        **piece_sizes(2),
    )
    caption = (
        "**The coefficient of friction**, measured (grey) and fitted to the whole record:"
        f" {_names(shown)}. Error: measured less fitted. The second pair of panels shows the"
        " largest step."
    )
    blocks: list[Block] = [Figure(svg=record, caption=caption), _held_figure(verdict, shown)]
    heading = "Measured and fitted coefficient of friction"
    return Section(id="friction", nav="Friction", heading=heading, blocks=tuple(blocks))


def _names(shown: list[RateStateCandidate]) -> str:
    return joined([c.title.lower() for c in shown])


def _change(fit: RateStateFit, step: float) -> float:
    """Return by how much the logarithm of the speed changes in a step."""
    path = fit.problem.record.path
    index = int(np.argmin(np.abs(path.steps - step)))
    first, second = np.maximum(path.lasting[index : index + 2], 1e-300)
    return abs(math.log(second / first))


def _about(fit: RateStateFit, step: float) -> "np.ndarray[tuple[int, ...], np.dtype[np.bool_]]":
    """Return which rows lie so near a step that one sees friction settle (n,)."""
    slider = fit.problem
    path, t = slider.record.path, slider.mean_time
    way = fit.law.critical_distance or abs(fit.law.direct_effect) / fit.stiffness
    place = np.interp(t, path.time, path.position) - np.interp(step, path.time, path.position)
    near = np.abs(place) < SETTLED * way
    few = np.argsort(np.abs(t - step))[: len(t) // 10]  # a way that settles within no samples
    near[few] = True
    return np.asarray(near)


def _held_figure(verdict: RateStateVerdict, shown: list[RateStateCandidate]) -> Figure:
    fit = _fit(verdict)
    slider = fit.problem
    series = {}
    for one in shown:
        assert one.unseen is not None
        error, blocks = MILLI.factor * one.unseen, []
        for k in range(len(slider.edges) - 1):
            own = error[slider.segments == k]
            rows = own[~np.isnan(own)]
            blocks.append(float(np.sqrt(np.mean(rows**2))) if len(rows) else math.nan)
        series[one.title] = ErrorSeries(slider.mean_time, error, np.array(blocks))
    svg = inline_svg(
        draw_prediction_error(
            series,
            slider.edges,
            f"error, {MILLI.unit}",
            chosen=verdict.closest.title,
            above="each part predicted by a fit to the others",
            below="root mean square of each part",
        ),
        alt=f"Held-out errors over time by {joined(list(series))}",
        prefix="held-out-figure",
        **ERROR_SIZES,
    )
    said = (
        "Vertical lines: steps of the speed. What lies before the first step is in every fit."
        if verdict.by_steps
        else "The record has one step: parts with equally many samples are held out in turn, and"
        " the part with the step shows what its level alone predicts."
    )
    return Figure(svg=svg, caption=f"**Held-out errors**: {_names(shown)}. {said}")


def scores_section(verdict: RateStateVerdict) -> Section:
    """Return the section that compares all laws."""
    rows, closest = verdict.candidates, verdict.closest
    table = page_table(
        COLUMNS,
        rows,
        cells={"model": lambda one: Name(text=one.title)},
        scale=COEFFICIENT,
        colour=lambda one: "c1" if one is closest else "muted",
        chosen=lambda one: one is verdict.best,
        caption="Of the laws whose losses are within 1.1 standard errors of those of the law with"
        " the lowest error, the one with the fewest parameters is named. Of two laws of evolution"
        " neither contains the other, but Nagata's contains the ageing law.",
    )
    how = (
        "Each law is fitted to the whole record, and once more without each velocity step, which"
        " it then predicts."
        if verdict.by_steps
        else "Each law is fitted to the whole record, and once more without each part of it, which"
        " it then predicts. No step is left to judge by, as there is only one."
    )
    heading = candidates_heading(len(rows), "held-out parts" if len(rows) == 1 else _held(verdict))
    return Section(id="scores", nav="Scores", heading=heading, blocks=(Paragraph(text=how), table))


def parameters_section(verdict: RateStateVerdict) -> Section:
    """Return the section on the parameters of the chosen law."""
    fit = _fit(verdict)
    known = [*fit.estimates, *([fit.rate] if fit.rate.interval != "known" else [])]
    loose = sum(not e.bounded for e in fit.estimates)
    total = in_words(len(fit.estimates))
    heading = (
        f"The record bounds all {total} parameters"
        if not loose
        else f"{in_words(loose).capitalize()} of {total} parameters not bounded by the record"
    )
    if len(fit.estimates) == 1 and not loose:
        heading = "The record bounds the one parameter"
    more: list[Block] = [Subheading(text="By how much of the record is used"), _windows(fit)]
    return parameters(
        fit.law.formula,
        known,
        ("range", lambda e, unit: with_unit(e.range, unit) if e.bounded else e.range),
        heading=heading,
        caption="95 % intervals: what leaving out blocks of time changes (jackknife, Student t),"
        " and every value that fits as well with another $b$.",
        more=more if len(fit.windows) > 1 else (),
        remarks=("In words", _notes(fit)),
        label=_label,
    )


def _notes(fit: RateStateFit) -> tuple[str, ...]:
    return tuple(typeset(line, _symbols(fit)) for line in (*fit.sentences[1:], *fit.remarks))


def _label(estimate: Estimate) -> str:
    symbols = estimate.quantity.symbol.split(" - ")
    told = " − ".join(f"${symbol}$" for symbol in symbols)
    return f"Rate dependence {told}" if len(symbols) > 1 else label_of(estimate)


def _windows(fit: RateStateFit) -> Table:
    """Return a - b by how much of the record after the last step is used."""
    columns = (
        Column(head="way after the last step"),
        Column(head="a − b, 95 % interval", numeric=True),
    )
    rows = [
        Row(
            cells=(
                quantity(one.after, "m"),
                Number(**_parts(one.rate, one.half_width)),
            )
        )
        for one in fit.windows
    ]
    caption = "If $a$ − $b$ changes with the way, the law does not describe the whole record."
    return Table(columns=columns, rows=tuple(rows), caption=caption)


def _parts(value: float, half_width: float) -> dict[str, str]:
    if not math.isfinite(half_width):
        return {"value": number(value), "doubt": "not bounded"}
    return dict(zip(("value", "doubt"), COEFFICIENT.estimate_text(value, half_width), strict=True))


def residuals_section(verdict: RateStateVerdict) -> Section | None:
    """Return the section on what the chosen law does not explain."""
    fit = _fit(verdict)
    slider = fit.problem
    residual = MILLI.factor * fit.best.residual / slider.weight
    path = slider.record.path
    shown = sampled(len(residual), 1000)
    place = 1e3 * np.interp(slider.mean_time, path.time, path.position)
    effective = fit.inference.effective
    panels = [
        panel_of("time, s", slider.mean_time, residual, effective, shown),
        panel_of("load point, mm", place, residual, effective, shown),
    ]
    panels = [one for one in panels if len(one.centre)]
    if not panels:
        return None
    svg = inline_svg(
        draw_residuals(panels, f"residual, {MILLI.unit}"),
        alt="Residuals of the chosen law against time and against the way of the load point",
        prefix="residual-figure",
        **residual_sizes(len(panels)),
    )
    over = f", {ratio(fit.over_scatter)} the scatter of neighbouring samples"
    caption = (
        f"**Residuals** of the fit to the whole record: root mean square {number(fit.rmse, 2)}"
        f"{over}. Error bars assume an effective sample size of"
        f" {significant(effective, 2)} of {len(residual):,}."
    )
    heading = f"Root-mean-square residual of the coefficient: {number(fit.rmse, 2)}"
    figure = Figure(svg=svg, caption=caption)
    return Section(id="residuals", nav="Residuals", heading=heading, blocks=(figure,))


def record_section(verdict: RateStateVerdict) -> Section | None:
    """Return the section on the load point and what was checked of the record."""
    path = _fit(verdict).problem.record.path
    pieces = [
        f"{quantity(float(v), 'm/s')} for {quantity(float(x), 'm')}"
        for v, x in zip(path.speeds, np.diff(path.position), strict=True)
    ]
    pulled = KeyValue(key="Load point", value=", then ".join(pieces))
    return record_and_checks(verdict.checks, items=[pulled])


def next_section(verdict: RateStateVerdict) -> Section | None:
    """Return the section on other steps, None if laws were not to be told apart."""
    if not verdict.next_steps:
        return None
    rms = _fit(verdict).rms
    rows = tuple(
        Row(
            cells=(
                f"{quantity(one.before, 'm/s')} → {quantity(one.after, 'm/s')}",
                significant(one.separation, 2),
                ratio(one.separation / rms) if rms > 0.0 else "—",
            )
        )
        for one in verdict.next_steps
    )
    columns = (
        Column(head="step"),
        Column(head="laws part by", numeric=True),
        Column(head="over the residual", numeric=True, phone="label"),
    )
    rival = next(c for c in verdict.candidates if c.name == verdict.rival)
    caption = (
        "Root mean square difference of the coefficients that"
        f" {verdict.closest.title.lower()} and {rival.title.lower()} predict as fitted, over the"
        " way on which friction settles."
    )
    heading = "At other steps the fitted laws part"
    table = Table(columns=columns, rows=rows, caption=caption)
    return Section(id="next", nav="Measure next", heading=heading, blocks=(table,))


def reproduce_section(verdict: RateStateVerdict, origin: Origin) -> Section:
    """Return the section with commands, the fitted law as code, data and references."""
    fit = _fit(verdict)
    values = [
        f"    {name}={getattr(fit.law, name)!r},"
        for name in (*fields_of(type(fit.law)), "evolution", "regularised")
        if getattr(fit.law, name) is not None and (name in SHOWN or getattr(fit.law, name))
    ]
    text = "\n".join(
        ["from stickslip.friction import RateState", "", "law = RateState(", *values, ")"]
    )
    note = f"The fitted law, for `simulate_velocity_steps` with stiffness={fit.stiffness:.6g} 1/m."
    laws = {c.law.formula: c.law for c in verdict.candidates if c.law is not None}
    return reproduce(
        origin,
        code=[(text, note)],
        data=verdict.measurement.provenance,
        laws=[one for one in laws.values() if one.evolution != "none"],
    )


sections = PageSections[RateStateVerdict](
    opening=opening_section,
    middle=(
        friction_section,
        scores_section,
        parameters_section,
        residuals_section,
        record_section,
        next_section,
    ),
    reproduce=reproduce_section,
)
"""Makes the sections of a page, in the order in which a reader decides."""
