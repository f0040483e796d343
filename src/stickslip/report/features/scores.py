"""The scores and the parameters: every law on the half of the record that its fit has not seen."""

import math

from stickslip.formatting import (
    estimate_text,
    in_words,
    number,
    percent,
    signed_percent,
    significant,
    with_unit,
)
from stickslip.identification import COMPARED, QUANTILE, FeatureFit
from stickslip.report.core.blocks import Block, KeyValue, KeyValues, Math, Paragraph, Subheading
from stickslip.report.core.documents import Section
from stickslip.report.core.headings import identified_heading
from stickslip.report.core.markup import label_of, typeset
from stickslip.report.core.sparklines import ERRORS, Axis, Colour, Mark, RowPlot
from stickslip.report.core.tables import Cell, Column, Name, Number, Row, Table
from stickslip.report.features.texts import (
    UNITS,
    label,
    symbols_of,
    typeset_lines,
)
from stickslip.selection import FeatureCandidate, FeatureVerdict, share_parts


def scores_section(verdict: FeatureVerdict) -> Section:
    """Return the section that compares all laws."""
    rows = [*verdict.candidates, *([verdict.control] if verdict.control else [])]
    count = len(verdict.candidates)
    heading = f"{in_words(count).capitalize()} candidates, scored on the held-out half"
    if count == 1:
        heading = "One candidate, scored on the held-out half"
    elif not verdict.ranked:
        heading = f"{in_words(count).capitalize()} candidates, not distinguished by their scores"
    blocks: list[Block] = [Paragraph(text=_how(verdict)), _laws(verdict, rows)]
    fit = verdict.best.fit if verdict.best else None
    if fit is not None:
        blocks += [Subheading(text=f"{fit.law.title}: features"), _features(fit)]
    return Section(id="scores", nav="Scores", heading=heading, blocks=tuple(blocks))


def _how(verdict: FeatureVerdict) -> str:
    return (
        "Every law is fitted so that its limit cycle has the frequency, mean and standard"
        " deviation of the first half, and is scored on those of the second. The features"
        f" themselves change by {percent(verdict.room)} between the halves: the drift of the"
        " record causes an error of that size for any law with fixed parameters."
    )


def _laws(verdict: FeatureVerdict, rows: list[FeatureCandidate]) -> Table:
    axis, second = _axis(rows), any(one.second for one in rows)
    columns = (
        Column(head="model"),
        Column(head="free\nparameters", numeric=True, phone="hide"),
        Column(head="held-out error\n%, ± 1 s.e.", numeric=True),
        Column(head="", axis=axis),
        *(
            Column(
                head=name.replace("_", "\n"),
                numeric=True,
                phone="label",
                label=name.replace("_", " "),
            )
            for name in COMPARED
        ),
        *([Column(head="second record\n%", numeric=True, phone="label")] if second else []),
        Column(head="outcome", phone="show"),
    )
    return Table(
        columns=columns,
        rows=tuple(_row(verdict, one, second=second) for one in rows),
        caption="Dot: held-out error, root mean square of the three. Bar: ± 1 standard error, from"
        " a block bootstrap of both halves. Laws are not distinguished if their errors"
        " differ by at most a paired standard error, or by at most half the change of the"
        " features between the halves; of these, a law with all parameters identified is"
        " chosen first, then the one with the fewest parameters.",
    )


def _row(verdict: FeatureVerdict, one: FeatureCandidate, *, second: bool) -> Row:
    nominal, chosen = one is verdict.control, one is verdict.best
    value, doubt = share_parts(one)
    held = one.fit is not None
    cells: list[Cell] = [
        Name(text=one.title, aside="nominal mechanism" if nominal else ""),
        str(one.parameters) if held else "—",
        Number(value=value, doubt=doubt) if held else "no score",
        _plot(one, "c1" if chosen else "c2" if nominal else "muted"),
        *(signed_percent(one.errors[name]) if name in one.errors else "—" for name in COMPARED),
    ]
    if second:
        size = math.sqrt(sum(e**2 for e in one.second.values()) / max(len(one.second), 1))
        cells.append(number(100.0 * size, 2) if one.second else "—")
    cells.append(typeset(one.outcome, symbols_of(verdict)))
    return Row(cells=tuple(cells), chosen=chosen, muted=bool(one.dropped))


def _plot(one: FeatureCandidate, colour: Colour) -> RowPlot:
    if not math.isfinite(one.score):
        return RowPlot(marks=())
    at, half = 100.0 * one.score, 100.0 * one.score_error
    marks = [Mark(kind="dot", at=at, colour=colour)]
    if math.isfinite(half):
        marks.insert(0, Mark(kind="bar", at=max(at - half, 0.0), to=at + half, colour=colour))
    return RowPlot(marks=tuple(marks))


def _axis(rows: list[FeatureCandidate]) -> Axis:
    ends = [100.0 * (c.score + (c.score_error if math.isfinite(c.score_error) else 0.0))
            for c in rows if math.isfinite(c.score)]  # fmt: skip
    high = max(ends, default=1.0) or 1.0
    power = 10.0 ** math.floor(math.log10(high))
    top = next(step * power for step in (1, 2, 4, 5, 10) if step * power >= high)
    return Axis(low=0.0, high=top, ticks=(0.0, top / 2, top), caption=ERRORS)


def _features(fit: FeatureFit) -> Table:
    """Return what was observed, fitted and held out, feature by feature."""
    columns = (
        Column(head="feature"),
        Column(head="first half", numeric=True),
        Column(head="fitted", numeric=True, phone="label"),
        Column(head="second half", numeric=True, phone="label"),
        Column(head="error", numeric=True, phone="label"),
    )
    rows = []
    for i, name in enumerate(COMPARED):
        cells: list[Cell] = [label(name), _observed(fit, i), _sized(name, fit.predicted[name])]
        held = fit.held_out
        cells.append("—" if held is None else _sized(name, getattr(held, name)))
        cells.append(signed_percent(fit.held_out_errors[name]) if held else "—")
        rows.append(Row(cells=tuple(cells)))
    caption = "With 95 % intervals from a block bootstrap of the first half."
    return Table(columns=columns, rows=tuple(rows), caption=caption)


def _observed(fit: FeatureFit, index: int) -> Number:
    name = COMPARED[index]
    value = float(getattr(fit.observed, name))
    half = QUANTILE * math.sqrt(float(fit.observed.covariance[index, index])) * abs(value)
    shown, doubt = estimate_text(value, half)
    return Number(value=shown, doubt=doubt, unit=UNITS.get(name, ""))


def _sized(name: str, value: float) -> str:
    return with_unit(significant(value), UNITS.get(name, "1"))


def parameters_section(verdict: FeatureVerdict) -> Section | None:
    """Return the section on the parameters of the chosen law."""
    fit = verdict.best.fit if verdict.best else None
    if fit is None or not fit.estimates:
        return None
    columns = (Column(head="parameter"), Column(head="estimate, 95 % interval", numeric=True),
               Column(head="given", numeric=True, phone="label"))  # fmt: skip
    table = Table(
        columns=columns,
        rows=tuple(_parameter(verdict, fit, i) for i in range(len(fit.estimates))),
        caption="95 % intervals from the block bootstrap of the observed features (Student t,"
        " eight blocks). Given: the value in the rig, if any.",
    )
    blocks: list[Block] = [Math(latex=fit.law.formula), table]
    lines = typeset_lines(fit.sentences, verdict)
    if lines:
        items = tuple(KeyValue(key="Note", value=line) for line in lines)
        blocks += [Subheading(text="Remarks"), KeyValues(items=items)]
    open_ended = sum(not e.bounded for e in fit.estimates)
    heading = (
        identified_heading(len(fit.estimates))
        if not open_ended
        else f"{in_words(open_ended).capitalize()} of {in_words(len(fit.estimates))} parameters"
        " not identified by the features"
    )
    return Section(id="parameters", nav="Parameters", heading=heading, blocks=tuple(blocks))


def _parameter(verdict: FeatureVerdict, fit: FeatureFit, index: int) -> Row:
    estimate = fit.estimates[index]
    value, doubt = estimate.parts
    unit = "" if estimate.quantity.unit == "1" else estimate.quantity.unit
    room, _, name = estimate.path.partition(".")
    given = getattr(verdict.mechanism, name, None) if room == "mechanism" else None
    cells: tuple[Cell, ...] = (
        Name(text=label_of(estimate), aside="" if estimate.bounded else estimate.reason),
        Number(value=value, doubt=doubt, unit=unit) if estimate.bounded else estimate.plus_minus,
        "—" if given is None else with_unit(number(given), unit),
    )
    return Row(cells=cells)
