"""Sections of the page of a selection on velocity steps."""

import math
from typing import Final

import numpy as np

from stickslip.friction import RATE_STATE_FORMS
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds.kind import page_table, share_fact
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
    Piece,
    draw_pieces,
    draw_residuals,
    inline_svg,
    panel_of,
    piece_sizes,
    residual_sizes,
    sampled,
)
from stickslip.show.report import (
    Fact,
    Figure,
    KeyValue,
    LawLine,
    Name,
    Origin,
    PageSections,
    Paragraph,
    Section,
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
    facts = [*share_fact(verdict.closest.share, len(verdict.candidates))]
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


def _others(verdict: RateStateVerdict) -> list[RateStateCandidate]:
    """Return the closest law and what it is compared with in figures: its rival or the next."""
    rest = [one for one in verdict.candidates[1:] if one.fit is not None]
    rest.sort(key=lambda one: (one.name != verdict.rival, -one.share))
    return [verdict.closest, *rest[:1]]


def friction_section(verdict: RateStateVerdict) -> Section:
    """Return the section with the coefficient over time, measured and fitted."""
    fit = _fit(verdict)
    problem, shown = fit.problem, _others(verdict)
    t = problem.times
    curves = {one.title: one.fit.band.median for one in shown if one.fit}
    step = max(problem.record.path.steps, key=lambda at: _change(fit, float(at)))
    close = _about(fit, float(step))
    pieces = [
        Piece(
            name, t[rows], problem.measured[rows], {title: y[rows] for title, y in curves.items()}
        )
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
        "**The coefficient of friction**, measured (grey) and by the medians of the draws of"
        f" {_names(shown)}, with what changes along the way. Error: measured less that. The second"
        " pair of panels shows the largest step."
    )
    heading = "Measured and fitted coefficient of friction"
    figure = Figure(svg=record, caption=caption)
    return Section(id="friction", nav="Friction", heading=heading, blocks=(figure,))


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
    path, t = fit.problem.record.path, fit.problem.times
    way = fit.law.critical_distance or abs(fit.law.direct_effect) / fit.stiffness
    place = np.interp(t, path.time, path.position) - np.interp(step, path.time, path.position)
    near = np.abs(place) < SETTLED * way
    few = np.argsort(np.abs(t - step))[: len(t) // 10]  # a way that settles within no samples
    near[few] = True
    return np.asarray(near)


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
        caption="Families that can fit many shapes are penalised: their likelihood is averaged over"
        " all values of their parameters. *Leaves*: root mean square of the residuals.",
    )
    drawn = significant(_fit(verdict).family.effective, 2)
    how = (
        "The share of a law is its probability, over all values of its parameters, of the stiffness"
        " of the machine, and of what changes along the way. Draws are weighed by their own runs;"
        f" those of the closest law count as {drawn} independent ones."
    )
    heading = candidates_heading(len(rows), "one posterior")
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
    return parameters(
        fit.law.formula,
        known,
        ("range", lambda e, unit: with_unit(e.range, unit) if e.bounded else e.range),
        heading=heading,
        caption="95 % intervals: quantiles of the draws of the posterior.",
        remarks=("In words", _notes(fit)),
        label=_label,
    )


def _notes(fit: RateStateFit) -> tuple[str, ...]:
    return tuple(typeset(line, _symbols(fit)) for line in (*fit.sentences[1:], *fit.remarks))


def _label(estimate: Estimate) -> str:
    symbols = estimate.quantity.symbol.split(" - ")
    told = " − ".join(f"${symbol}$" for symbol in symbols)
    return f"Rate dependence {told}" if len(symbols) > 1 else label_of(estimate)


def residuals_section(verdict: RateStateVerdict) -> Section | None:
    """Return the section on what the chosen law does not explain."""
    fit = _fit(verdict)
    problem = fit.problem
    residual = MILLI.factor * (problem.measured - fit.band.median)
    path = problem.record.path
    shown = sampled(len(residual), 1000)
    place = 1e3 * np.interp(problem.times, path.time, path.position)
    effective = fit.posterior.kappa * len(residual)
    panels = [
        panel_of("time, s", problem.times, residual, effective, shown),
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
    ),
    reproduce=reproduce_section,
)
"""Makes the sections of a page, in the order in which a reader decides."""
