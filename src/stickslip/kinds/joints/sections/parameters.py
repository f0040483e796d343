"""The parameters of the chosen law: estimates, what moves together, what is undetermined."""

import math
from typing import Final

import numpy as np

from stickslip.experiments import equated
from stickslip.formatting import fixed, in_words, percent, ratio, significant, with_unit
from stickslip.identification import (
    JOINTS,
    Allowed,
    Estimate,
    RecordFit,
    largest_allowed,
    reads_as_forces,
    step_intervals,
)
from stickslip.kinds.joints.joint_verdict import RecordCandidate, RecordVerdict
from stickslip.kinds.joints.sections.texts import symbols_of, to_digits
from stickslip.report import (
    Axis,
    Block,
    Cell,
    Column,
    Columns,
    Correlations,
    KeyValue,
    KeyValues,
    Mark,
    Math,
    Name,
    Number,
    Row,
    RowPlot,
    Section,
    Subheading,
    Table,
    identified_heading,
    label_of,
    typeset,
)
from stickslip.selection import in_sentence

MOST_CORRELATED: Final = 8
"""Parameters of a triangle at most: a larger one is wider than a phone."""
TWICE: Final = 2.0
"""Sums of squares below this many times the least are said to be so many percent larger."""
STRONG: Final = 0.9
"""Correlation from which two parameters are said to trade off."""


def parameters_section(verdict: RecordVerdict) -> Section | None:
    """Return the section on the parameters of the chosen law."""
    best = verdict.closest
    if best.fit is None or not best.fit.estimates:
        return None
    fit = best.fit
    blocks: list[Block] = [Math(latex=fit.law.formula), _table(verdict, fit)]
    together, words = _together(fit), _in_words(verdict, fit)
    if together and words:
        blocks.append(Columns(left=together, right=words))
    else:
        blocks += [*together, *words]
    return Section(id="parameters", nav="Parameters", heading=_heading(fit), blocks=tuple(blocks))


def _heading(fit: RecordFit) -> str:
    open_ended = [e for e in fit.estimates if not e.bounded]
    count = len(fit.estimates)
    if not open_ended:
        return identified_heading(count)
    verb = "is" if len(open_ended) == 1 else "are"
    return (
        f"{in_words(len(open_ended)).capitalize()} of {in_words(count)} parameters {verb} not"
        " identified"
    )


def _table(verdict: RecordVerdict, fit: RecordFit) -> Table:
    halves = verdict.half_estimates
    columns = (
        Column(head="parameter"),
        Column(head="estimate, 95 % interval", numeric=True),
        Column(head=f"dot: this fit{'; triangles: the two halves' if halves else ''}"),
        *(
            [Column(head="first → second half", numeric=True, phone="label", label="halves")]
            if halves
            else []
        ),
        Column(
            head="naive interval\nis off by",
            numeric=True,
            phone="label",
            label="naive interval is off by",
        ),
    )
    rows = [
        _row(fit, i, halves.get(e.path), split=bool(halves)) for i, e in enumerate(fit.estimates)
    ]
    return Table(columns=columns, rows=tuple(rows), caption=_caption(fit))


def _row(fit: RecordFit, index: int, halves: tuple[float, float] | None, *, split: bool) -> Row:
    estimate = fit.estimates[index]
    value, doubt = estimate.parts
    known = halves is not None and bool(np.all(np.isfinite(halves)))
    pair = "—"
    if halves is not None and known:
        first, second = (to_digits(one, estimate) for one in halves)
        pair = f"{first} → {second}"
    aside, unit = "" if estimate.bounded else estimate.reason, estimate.quantity.unit
    cells: tuple[Cell, ...] = (
        Name(text=label_of(estimate), aside=aside),
        Number(value=value, doubt=doubt, unit=unit)
        if estimate.bounded
        else f"{with_unit(value, unit)}, {doubt}",
        _plot(estimate, halves if known else None),
        *([pair] if split else []),
        _narrow(fit, index),
    )
    return Row(cells=cells)


def _narrow(fit: RecordFit, index: int) -> str:
    """Return how many times wider the interval is than one that takes residuals as independent."""
    error = float(fit.inference.of_record.errors[index])
    naive = math.sqrt(max(float(fit.inference.naive[index, index]), 0.0))
    if not (math.isfinite(error) and 0.0 < naive < math.inf) or not fit.estimates[index].bounded:
        return "—"
    factor = with_unit(significant(max(error, naive) / min(error, naive), 2), "×")
    return f"{factor} too {'wide' if error < naive else 'narrow'}"


def _plot(estimate: Estimate, halves: tuple[float, float] | None) -> RowPlot:
    marks = []
    ends = [estimate.value]
    if halves is not None:
        marks += [Mark(kind="triangle", at=one, colour="c2") for one in halves]
        ends += halves
    if estimate.bounded:
        marks.append(Mark(kind="bar", at=estimate.low, to=estimate.high))
        ends += [estimate.low, estimate.high]
    marks.append(Mark(kind="dot", at=estimate.value))
    return RowPlot(marks=tuple(marks), axis=_axis(min(ends), max(ends)))


def _axis(low: float, high: float) -> Axis:
    """Return an axis between round numbers."""
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        half = 0.1 * abs(low) or 1.0
        low, high = low - half, high + half
    wide = 1.2 * (high - low)
    power = 10.0 ** math.floor(math.log10(wide / 2))
    step = next(size * power for size in (1, 2, 5, 10) if size * power >= wide / 4)
    first, last = math.floor(low / step), math.ceil(high / step)
    last += (last - first) % 2  # so that the middle is round as well
    ticks = tuple(float(f"{count * step:.10g}") for count in (first, (first + last) // 2, last))
    return Axis(low=ticks[0], high=ticks[-1], ticks=ticks)


def _caption(fit: RecordFit) -> str:
    effective, rows = fit.inference.effective, len(fit.residual)
    text = (
        "95 % intervals from the block jackknife (Student t). The effective sample size is about"
        f" {significant(effective, 2)} of {rows:,} rows; last column: factor by which intervals"
        " that assume independent rows are too narrow or too wide."
    )
    if reads_as_forces(fit.mechanism, fit.measurement):
        text += " The normal force is set to 1, so that friction levels are forces."
    for own, other in equated(fit.law).values():
        text += f" ${own}$ was not fitted: it is set equal to ${other}$."
    force = fit.offset_estimate
    if force is not None and force.bounded and force.low <= 0.0 <= force.high:
        text += f" The interval of ${force.quantity.symbol}$ includes 0: no constant force is seen."
    return text


def _together(fit: RecordFit) -> tuple[Block, ...]:
    """Return the triangle of correlations."""
    count = len(fit.free_parameters)
    table = np.clip(fit.inference.correlation, -1.0, 1.0)
    if count < 2 or count > MOST_CORRELATED or not np.all(np.isfinite(table)):
        return ()
    names = tuple(f"${e.quantity.symbol}$" for e in fit.estimates[:count])
    values = tuple(tuple(float(table[i, j]) for j in range(i)) for i in range(1, count))
    i, j = max(
        ((i, j) for i in range(1, count) for j in range(i)), key=lambda at: abs(float(table[at]))
    )
    most = float(table[i, j])
    how = (
        "are almost completely correlated"
        if abs(most) >= STRONG
        else ("have the strongest correlation")
    )
    sign = fixed(most, 2)
    caption = f"Correlations of the estimates. {names[j]} and {names[i]} {how} ({sign})."
    triangle = Correlations(names=names, values=values, caption=caption)
    return (Subheading(text="Correlations"), triangle)


def _in_words(verdict: RecordVerdict, fit: RecordFit) -> tuple[Block, ...]:
    """Return what the record cannot tell of the parameters, in sentences."""
    symbols = symbols_of(verdict.candidates)
    items = [
        KeyValue(key=label_of(e), value=typeset(e.reason, symbols))
        for e in fit.estimates
        if not e.bounded and e.reason
    ]
    said = tuple(f"({e.quantity.symbol}) is not identified" for e in fit.estimates if e.reason)
    lines = [typeset(one, symbols) for one in fit.sentences if not any(s in one for s in said)]
    items += [KeyValue(key="Note", value=line) for line in lines]
    hidden = _hidden(verdict)
    items += [hidden] if hidden is not None else []
    if not items:
        items = [
            KeyValue(
                key="Not identified",
                value=("none of the parameters of this law, at the speeds of this record"),
            )
        ]
    return (Subheading(text="Remarks"), KeyValues(items=tuple(items)))


def _hidden(verdict: RecordVerdict) -> KeyValue | None:
    """Return how large a step or an exponent may be that the record does not settle.

    Of all laws the one that predicts best is asked: a profile takes as long as a fit from near by.
    """
    if verdict.route == JOINTS:  # a profile would hold the mechanism, which joints share
        return None
    known = [c for c in verdict.candidates if c.fit is not None and math.isfinite(c.score)]
    for one in sorted(known, key=lambda c: c.score):
        assert one.fit is not None
        path = _undetermined(one.fit)
        found = largest_allowed(one.fit, path) if path else None
        if path and found is not None:
            return _allowed(one, found)
    return None


def _undetermined(fit: RecordFit) -> str:
    """Return the path of a step or an exponent of a law that is not settled, "" if all are."""
    steps = step_intervals(fit.free_parameters, fit.optimum.best, fit.inference)
    for estimate in fit.estimates[: len(fit.free_parameters)]:
        is_step = estimate.path in steps and steps[estimate.path][1] <= 0.0
        shapes = estimate.quantity.structural or estimate.path in steps
        if is_step or (shapes and not estimate.bounded):
            return estimate.path
    return ""


def _allowed(one: RecordCandidate, found: Allowed) -> KeyValue:
    assert one.fit is not None
    estimate = one.fit.estimate(found.path)
    unit = estimate.quantity.unit
    end = with_unit(significant(found.value, 3), unit)
    at, cost = found.tried[1], found.costs[1]  # the nearer one to the end
    tried = with_unit(significant(at, 3), unit)
    rise = percent(cost - 1.0) + " larger" if cost < TWICE else ratio(cost)
    return KeyValue(
        key=f"{label_of(estimate)} of {in_sentence(one.title)}",
        value=f"values up to about {end} are compatible with this record (95 %, profile"
        f" likelihood); at {tried} the sum of squares is {rise}",
    )
