"""Sections of the page of a selection on features of stick-slip."""

import math
from collections.abc import Iterable, Sequence
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.fits import Estimate
from stickslip.identify.kinds.features.features import COMPARED, StickSlipFeatures
from stickslip.identify.kinds.features.figures import PULL_SIZES, Excerpt, Half, draw_pull
from stickslip.identify.kinds.features.problem import SAMPLES, WATCHED
from stickslip.identify.kinds.features.result import FeatureFit, half_width
from stickslip.identify.kinds.features.verdict import (
    COLUMNS,
    PERCENT,
    FeatureCandidate,
    FeatureVerdict,
    OtherSpeed,
    share_parts,
)
from stickslip.identify.kinds.features.wording import share_text
from stickslip.identify.kinds.kind import page_table
from stickslip.quantities import fields_of
from stickslip.show.formatting import (
    estimate,
    estimate_text,
    in_words,
    number,
    parameter_words,
    percent,
    quantity,
    ratio,
    signed_percent,
    significant,
    with_unit,
)
from stickslip.show.plots import inline_svg, thinned
from stickslip.show.report import (
    Block,
    Cell,
    Colour,
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
    identified_heading,
    label_of,
    opening,
    parameters,
    record_and_checks,
    reproduce,
    typeset,
)

UNITS = {"frequency": "Hz"}
"""Of features that have one; the others are over the load."""
LABELS = {
    "frequency": "frequency",
    "mean": "mean of $F$/$N$",
    "standard_deviation": "standard deviation of $F$/$N$",
}
assert set(LABELS) == set(COMPARED)


def symbols_of(verdict: FeatureVerdict) -> frozenset[str]:
    """Return the symbols of all fitted parameters."""
    everyone: list[FeatureCandidate] = list(verdict.candidates)
    return frozenset(e.quantity.symbol for c in everyone if c.fit for e in c.fit.estimates)


def typeset_lines(lines: Iterable[str], verdict: FeatureVerdict) -> tuple[str, ...]:
    """Return texts with the symbols in them typeset."""
    symbols = symbols_of(verdict)
    return tuple(typeset(line, symbols) for line in lines)


def opening_section(verdict: FeatureVerdict, kicker: str, remark: str = "") -> Section:
    """Return the section that a reader may stop after."""
    best, words = verdict.best, verdict.words
    fit = best.fit if best else None
    told = fit is not None and best is not None and not best.dropped
    return opening(
        words,
        kicker,
        remark,
        symbols=symbols_of(verdict),
        law=_law_lines(fit) if fit else (),
        facts=_facts(verdict),
        settles=_settles(fit) if fit and told else None,
        no_score=words.no_score,
    )


def _settles(fit: FeatureFit) -> tuple[str, ...]:
    known = [e for e in fit.estimates if e.bounded]
    return tuple(f"{label_of(e)} is {e.plus_minus}." for e in known[:3])


def _law_lines(fit: FeatureFit) -> tuple[LawLine, ...]:
    """Return the parameters of the law, then what of the mechanism was looked for."""
    found = {e.path: e for e in fit.estimates}
    lines = []
    for name, field in fields_of(type(fit.law)).items():
        value, estimate = getattr(fit.law, name), found.get(f"friction.{name}")
        if value is None:
            continue
        text = f"{quantity(value, field.unit)}, taken as given"
        text = estimate.plus_minus if estimate else text
        lines.append(LawLine(label=parameter_words(name), formula=f"${field.symbol}$ = {text}"))
    for path, estimate in found.items():
        if path.startswith("mechanism."):
            name = parameter_words(path)
            formula = f"${estimate.quantity.symbol}$ = {estimate.plus_minus}"
            lines.append(LawLine(label=f"effective {name}", formula=formula))
    return tuple(lines)


def _facts(verdict: FeatureVerdict) -> tuple[Fact, ...]:
    best, control, features = verdict.best, verdict.control, verdict.features
    facts = []
    if best is not None and best.fit is not None:
        value, doubt = share_parts(best)
        what = (
            "held-out error: frequency, mean and standard deviation of the second half, root mean"
            " square, ± 1 standard error"
        )
        facts.append(Fact(value=value, aside=with_unit(doubt, "%"), what=what))
    if control is not None and control.fit is not None:
        what = "the same error with the mechanism fixed as stated"
        facts.append(Fact(value=share_text(control), what=what))
    facts.append(_motion(features))
    return tuple(facts[:3])


def _motion(features: StickSlipFeatures) -> Fact:
    """Return what tells most of the motion: the time between slips, or how fast it swings."""
    if features.slips > 1:
        spread = quantity(float(features.waiting_times.std()), "s", 2)
        what = (
            f"median time between slips, with the spread of {features.slips:,} slips; they begin"
            f" at {number(features.break_away)} of the load"
        )
        value = quantity(features.waiting_time, "s")
        return Fact(value=value, aside=f"± {spread}", what=what)
    faster = features.frequency / features.natural_frequency
    what = (
        "of the natural frequency √(k/m) of the nominal mass: the force oscillates at"
        f" {quantity(features.frequency, 'Hz')}"
    )
    return Fact(value=ratio(faster), what=what)


Array: TypeAlias = NDArray[np.float64]


def force_section(verdict: FeatureVerdict) -> Section | None:
    """Return the section with the measured and the simulated force."""
    fit = verdict.best.fit if verdict.best else None
    if fit is None or fit.held_out is None:
        return None
    load = fit.mechanism.steady_load
    time, force = np.asarray(fit.measurement.time), np.asarray(fit.measurement.spring_force) / load
    middle = len(time) // 2
    halves = [
        Half(float(time[0]), float(time[middle - 1]), fit.observed.mean),
        Half(float(time[middle]), float(time[-1]), fit.held_out.mean),
    ]
    excerpts = [
        _excerpt(fit, time, force, name, 0.5 * (half.start + half.end))
        for name, half in zip(("first half, fitted", "second half, held out"), halves, strict=True)
    ]
    svg = inline_svg(
        draw_pull(*thinned(time, force), halves, excerpts),
        alt="Spring force over load against time: the whole record, and some cycles of each half"
        " beside the fitted limit cycle",
        prefix="force-figure",
        **PULL_SIZES,
    )
    shown = quantity(float(np.ptp(excerpts[0].time)), "s", 2)
    caption = (
        "**The force of the spring over the load.** Above: the record, with the mean of each half."
        f" Below: {shown} from the middle of each half (grey) and the fitted limit cycle (blue)."
        " Its phase is chosen to match best; only frequency, mean and standard deviation were"
        " fitted, since no law follows an irregular record cycle by cycle."
    )
    heading = "The measured force and the predicted motion"
    block = Figure(svg=svg, caption=caption)
    return Section(id="force", nav="Force", heading=heading, blocks=(block,))


def _excerpt(fit: FeatureFit, time: Array, force: Array, name: str, middle: float) -> Excerpt:
    """Return some cycles about a time, with the limit cycle shifted to lie nearest."""
    period = 1.0 / fit.observed.frequency
    kept = np.abs(time - middle) <= 0.5 * WATCHED * period
    t, measured = time[kept] - time[kept][0], force[kept]
    fine = np.linspace(0.0, float(t[-1]) + period, 40 * (WATCHED + 1) + 1)
    cycle = fit.limit_cycle(fine) / fit.mechanism.steady_load
    shifts = np.linspace(0.0, period, SAMPLES, endpoint=False)
    misfit = [float(np.sum((np.interp(t + s, fine, cycle) - measured) ** 2)) for s in shifts]
    shift = float(shifts[int(np.argmin(misfit))])
    inside = (fine >= shift) & (fine - shift <= t[-1])
    return Excerpt(name, t, measured, fine[inside] - shift, cycle[inside])


def scores_section(verdict: FeatureVerdict) -> Section:
    """Return the section that compares all laws."""
    rows = [*verdict.candidates, *([verdict.control] if verdict.control else [])]
    count = len(verdict.candidates)
    heading = candidates_heading(count, "the held-out half")
    if count > 1 and not verdict.ranked:
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
    symbols = symbols_of(verdict)

    def name(one: FeatureCandidate) -> Name:
        aside = "nominal mechanism" if one is verdict.control else ""
        return Name(text=one.title, aside=aside)

    def colour(one: FeatureCandidate) -> Colour:
        return "c1" if one is verdict.best else "c2" if one is verdict.control else "muted"

    return page_table(
        COLUMNS,
        rows,
        cells={"model": name, "outcome": lambda one: typeset(one.outcome, symbols)},
        scale=PERCENT,
        colour=colour,
        chosen=lambda one: one is verdict.best,
        caption="Dot: held-out error, root mean square of the three. Bar: ± 1 standard error, from"
        " a block bootstrap of both halves. Laws are not distinguished if their errors"
        " differ by at most a paired standard error, or by at most half the change of the"
        " features between the halves; of these, a law with all parameters identified is"
        " chosen first, then the one with the fewest parameters.",
    )


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
        cells: list[Cell] = [LABELS[name], _observed(fit, i), _sized(name, fit.predicted[name])]
        held = fit.held_out
        cells.append("—" if held is None else _sized(name, getattr(held, name)))
        cells.append(signed_percent(fit.held_out_errors[name]) if held else "—")
        rows.append(Row(cells=tuple(cells)))
    caption = "With 95 % intervals from a block bootstrap of the first half."
    return Table(columns=columns, rows=tuple(rows), caption=caption)


def _observed(fit: FeatureFit, index: int) -> Number:
    name = COMPARED[index]
    value = float(getattr(fit.observed, name))
    half = half_width(math.sqrt(float(fit.observed.covariance[index, index]))) * abs(value)
    shown, doubt = estimate_text(value, half)
    return Number(value=shown, doubt=doubt, unit=UNITS.get(name, ""))


def _sized(name: str, value: float) -> str:
    return with_unit(significant(value), UNITS.get(name, "1"))


def parameters_section(verdict: FeatureVerdict) -> Section | None:
    """Return the section on the parameters of the chosen law."""
    fit = verdict.best.fit if verdict.best else None
    if fit is None or not fit.estimates:
        return None
    open_ended = sum(not e.bounded for e in fit.estimates)
    heading = (
        identified_heading(len(fit.estimates))
        if not open_ended
        else f"{in_words(open_ended).capitalize()} of {in_words(len(fit.estimates))} parameters"
        " not identified by the features"
    )

    def given(one: Estimate, unit: str) -> str:
        room, _, name = one.path.partition(".")
        value = getattr(verdict.mechanism, name, None) if room == "mechanism" else None
        return "—" if value is None else with_unit(number(value), unit)

    return parameters(
        fit.law.formula,
        fit.estimates,
        ("given", given),
        heading=heading,
        caption="95 % intervals from the block bootstrap of the observed features (Student t,"
        " eight blocks). Given: the value in the rig, if any.",
        remarks=("Remarks", typeset_lines(fit.sentences, verdict)),
    )


def record_section(verdict: FeatureVerdict) -> Section | None:
    """Return the section on the features of the whole record and what was checked of it."""
    items = [*_numbers(verdict)]
    for line in typeset_lines(verdict.features.sentences, verdict):
        items.append(KeyValue(key="Feature", value=line, mark="warn"))
    return record_and_checks(verdict.checks, items=items, source="its features and checks")


def _numbers(verdict: FeatureVerdict) -> list[KeyValue]:
    seen = verdict.features
    items = [
        KeyValue(key="Motion", value=seen.regime),
        KeyValue(
            key="Frequency",
            value=f"{quantity(seen.frequency, 'Hz')}, natural"
            f" {quantity(seen.natural_frequency, 'Hz')}",
        ),
    ]
    if seen.slips > 1:
        spread = float(seen.waiting_times.std())
        items += [
            KeyValue(
                key="Slips",
                value=f"{seen.slips:,}, {quantity(seen.waiting_time, 's')} apart in the"
                f" median (spread {quantity(spread, 's', 2)})",
            ),
            KeyValue(
                key="Break-away",
                value=f"{estimate(seen.break_away, float(seen.levels.std()))} of the"
                f" load, drop {number(seen.drop)}",
            ),
        ]
    return items


def next_section(verdict: FeatureVerdict) -> Section | None:
    """Return the section on other speeds of the pull, None if laws were not to be told apart."""
    if not verdict.speeds:
        return None
    titles = {c.name: c.title for c in verdict.candidates}
    names = list(verdict.speeds[0].predicted)
    columns = (
        Column(head="pulling speed"),
        *(
            Column(head=titles[n], numeric=True, phone="label", label=f"{titles[n]}:")
            for n in names
        ),
        Column(head="separation", numeric=True, phone="label"),
    )
    caption = (
        "Frequency and standard deviation of force over load predicted by the fitted laws."
        " Parameters that are not identified may have other values that fit this record equally"
        " well and predict other numbers: such a pull determines these values first, and the law"
        " second. Separation: root mean square difference of the features between the chosen law"
        " and its nearest rival."
    )
    rows = tuple(_speed(one, names) for one in verdict.speeds)
    return Section(
        id="next",
        nav="Measure next",
        heading="The fitted laws differ at other speeds",
        blocks=(Table(columns=columns, rows=rows, caption=caption),),
    )


def _speed(one: OtherSpeed, names: Sequence[str]) -> Row:
    cells: list[Cell] = [quantity(one.speed, "m/s")]
    for name in names:
        seen = one.predicted[name]
        cells.append(
            f"{quantity(seen['frequency'], 'Hz')}, {number(seen['standard_deviation'])}"
            if seen["frequency"] > 0.0
            else "steady sliding"
        )
    return Row(cells=(*cells, percent(one.separation)))


def reproduce_section(verdict: FeatureVerdict, origin: Origin) -> Section:
    """Return the section with commands, the rig file of the fit, data and references."""
    fit = verdict.best.fit if verdict.best else None
    code, items = [], []
    if fit is not None:
        code.append((fit.to_toml().strip(), "The fitted block and law as a file for simulations."))
        text = f"{fit.runs:,} limit cycles simulated for the chosen law"
        items.append(KeyValue(key="Runs", value=text))
    laws = [c.law for c in verdict.candidates if c.law is not None]
    return reproduce(origin, code=code, items=items, data=verdict.measurement.provenance, laws=laws)


sections = PageSections[FeatureVerdict](
    opening=opening_section,
    middle=(
        force_section,
        scores_section,
        parameters_section,
        record_section,
        next_section,
    ),
    reproduce=reproduce_section,
)
"""Makes the sections of a page, in the order in which a reader decides."""
