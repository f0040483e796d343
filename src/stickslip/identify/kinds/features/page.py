"""Sections of the page of a selection on features of stick-slip."""

from collections.abc import Iterable, Sequence
from typing import Any, Final, NamedTuple

import numpy as np

from stickslip.identify.bands import Array
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds.features.result import FeatureFit
from stickslip.identify.kinds.features.verdict import (
    COLUMNS,
    PERCENT,
    FeatureCandidate,
    FeatureVerdict,
    OtherSetting,
)
from stickslip.identify.kinds.features.wording import UNITS as SETTING_UNITS
from stickslip.identify.kinds.kind import page_table, share_fact
from stickslip.identify.problems.limit_cycles import SAMPLES, WATCHED
from stickslip.identify.problems.slip_features import COMPARED, StickSlipFeatures
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
from stickslip.show.plots import C1, DATA, INK, MUTED, Draw, Sizes, inline_svg, thinned
from stickslip.show.report import (
    Cell,
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
    opening,
    parameters,
    record_and_checks,
    reproduce,
    typeset,
)

PULL_SIZES: Final = Sizes(wide=(880, 430), narrow=(358, 620))
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
    words = verdict.words
    return opening(
        words,
        kicker,
        remark,
        symbols=symbols_of(verdict),
        law=_law_lines(_fit(verdict)),
        facts=_facts(verdict),
        no_score=words.no_score,
    )


def _fit(verdict: FeatureVerdict) -> FeatureFit:
    assert verdict.closest.fit is not None
    return verdict.closest.fit


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
    fit = _fit(verdict)
    facts = [*share_fact(verdict.closest.share, len(verdict.candidates))]
    what = "error of frequency, mean and standard deviation of its limit cycle, root mean square"
    facts += [Fact(value=percent(fit.rms), what=what), _motion(verdict.features)]
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


class Excerpt(NamedTuple):
    """Some cycles: measured and simulated force over the load, times [s] from 0."""

    time: Array
    """Times (n,) of the samples [s]."""
    measured: Array
    """Measured force (n,) over the load."""
    simulated_time: Array
    """Times (m,) of the simulation [s]."""
    simulated: Array
    """Simulated force (m,) over the load."""


def draw_pull(time: Array, force: Array, excerpt: Excerpt) -> Draw:
    """Return a drawing of a record of pulling and of an excerpt beside a limit cycle.

    Examples
    --------
    >>> t = np.linspace(0.0, 1.0, 50)
    >>> callable(draw_pull(t, np.sin(9 * t), Excerpt(t, np.sin(9 * t), t, np.sin(9 * t))))
    True
    """

    def draw(figure: Any, narrow: bool) -> None:  # noqa: ARG001
        record, cycles = figure.subplots(2)
        record.plot(time, force, color=DATA, linewidth=0.7)
        record.axhline(float(force.mean()), color=INK, linewidth=1.2)
        record.set_title("spring force over load, whole record", color=MUTED)
        record.margins(x=0.0)
        cycles.plot(excerpt.time, excerpt.measured, ".", color=DATA, markersize=3.5)
        cycles.plot(excerpt.simulated_time, excerpt.simulated, color=C1, linewidth=1.5)
        cycles.set_title("some cycles from its middle, measured and simulated", color=MUTED)
        cycles.set_xlabel("time, s")
        cycles.margins(x=0.0, y=0.1)

    return draw


def force_section(verdict: FeatureVerdict) -> Section | None:
    """Return the section with the measured and the simulated force."""
    fit = _fit(verdict)
    record, load = fit.measurement.records()[0], fit.problem.settings[0].block.steady_load
    if len(fit.problem.settings) > 1:
        return None  # the limit cycle is that of the block as it is stated
    time, force = np.asarray(record.time), np.asarray(record.values("spring_force")) / load
    excerpt = _excerpt(fit, time, force)
    svg = inline_svg(
        draw_pull(*thinned(time, force), excerpt),
        alt="Spring force over load against time: the record, and some cycles beside the fitted"
        " limit cycle",
        prefix="force-figure",
        **PULL_SIZES,
    )
    shown = quantity(float(np.ptp(excerpt.time)), "s", 2)
    caption = (
        "**The force of the spring over the load.** Above: the record with its mean. Below:"
        f" {shown} from its middle (grey) and the fitted limit cycle (blue). Its phase is chosen to"
        " match best; only frequency, mean and standard deviation were fitted, since no law follows"
        " an irregular record cycle by cycle."
    )
    heading = "The measured force and the predicted motion"
    block = Figure(svg=svg, caption=caption)
    return Section(id="force", nav="Force", heading=heading, blocks=(block,))


def _excerpt(fit: FeatureFit, time: Array, force: Array) -> Excerpt:
    """Return some cycles about the middle, with the limit cycle shifted to lie nearest."""
    period = 1.0 / fit.observed.frequency
    middle = 0.5 * float(time[0] + time[-1])
    kept = np.abs(time - middle) <= 0.5 * WATCHED * period
    t, measured = time[kept] - time[kept][0], force[kept]
    fine = np.linspace(0.0, float(t[-1]) + period, 40 * (WATCHED + 1) + 1)
    cycle = fit.limit_cycle(fine) / fit.mechanism.steady_load
    shifts = np.linspace(0.0, period, SAMPLES, endpoint=False)
    misfit = [float(np.sum((np.interp(t + s, fine, cycle) - measured) ** 2)) for s in shifts]
    shift = float(shifts[int(np.argmin(misfit))])
    inside = (fine >= shift) & (fine - shift <= t[-1])
    return Excerpt(t, measured, fine[inside] - shift, cycle[inside])


def scores_section(verdict: FeatureVerdict) -> Section:
    """Return the section that compares all laws."""
    closest, rows = verdict.closest, verdict.candidates
    symbols = symbols_of(verdict)
    table = page_table(
        COLUMNS,
        rows,
        cells={
            "model": lambda one: Name(text=one.title),
            "outcome": lambda one: typeset(one.outcome, symbols),
        },
        scale=PERCENT,
        colour=lambda one: "c1" if one is closest else "muted",
        chosen=lambda one: one is verdict.best,
        caption="Families that can fit many shapes are penalised: their likelihood is averaged over"
        " all values of their parameters. Errors are those of the likeliest limit cycle.",
    )
    fit = _fit(verdict)
    how = (
        "The share of a law is its probability, over all values of its parameters, of the mass and"
        " the stiffness of the machine, and of what no law has. Draws are weighed by their own"
        f" runs; those of the closest law count as {significant(fit.family.effective, 2)}"
        " independent ones."
    )
    blocks = (
        Paragraph(text=how), table, Subheading(text=f"{fit.law.title}: features"), _features(fit),
    )  # fmt: skip
    heading = candidates_heading(len(rows), "one posterior")
    return Section(id="scores", nav="Scores", heading=heading, blocks=blocks)


def _features(fit: FeatureFit) -> Table:
    """Return what was observed and fitted, feature by feature and record by record."""
    columns = (
        Column(head="feature"),
        Column(head="measured", numeric=True),
        Column(head="fitted", numeric=True, phone="label"),
        Column(head="error", numeric=True, phone="label"),
    )
    rows = []
    blocks = [one.block for one in fit.problem.settings]
    modes = fit.problem.cycles(fit.name, fit.family.mode[None], blocks)[0]
    for setting, mode in zip(fit.problem.settings, modes, strict=True):
        several = len(blocks) > 1
        at = f", {quantity(setting.block.speed, 'm/s')}" if several else ""
        for i, name in enumerate(COMPARED):
            if setting.slides and i != 1:
                continue
            value = float(setting.features.compared[i])
            half = 2.0 * float(np.sqrt(setting.features.covariance[i, i])) * abs(value)
            shown, doubt = estimate_text(value, half)
            cells: list[Cell] = [
                f"{LABELS[name]}{at}",
                Number(value=shown, doubt=doubt, unit=UNITS.get(name, "")),
                _sized(name, float(mode[i])),
                signed_percent(round(float(mode[i]) / value - 1.0, 4)),
            ]
            rows.append(Row(cells=tuple(cells)))
    caption = "Measured: with two standard errors, by how stretches of whole cycles scatter."
    return Table(columns=columns, rows=tuple(rows), caption=caption)


def _sized(name: str, value: float) -> str:
    return with_unit(significant(value), UNITS.get(name, "1"))


def parameters_section(verdict: FeatureVerdict) -> Section:
    """Return the section on the parameters of the closest law."""
    fit = _fit(verdict)
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
        caption="95 % intervals: quantiles of the draws of the posterior."
        " Given: the value in the rig, if any.",
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
    """Return the section on other settings, None without any."""
    if not verdict.settings:
        return None
    titles = {c.name: c.title for c in verdict.candidates}
    names = [*verdict.settings[0].predicted]
    columns = (
        Column(head="setting"),
        *(
            Column(head=titles[n], numeric=True, phone="label", label=f"{titles[n]}:")
            for n in names
        ),
        Column(head="expected width", numeric=True, phone="label"),
    )
    asked = "which law holds" if verdict.rivals else "the parameters"
    caption = (
        "Frequency and standard deviation of force over load, medians of the draws. Expected width:"
        f" what would be left of what is not known of {asked}, with another record there."
    )
    rows = tuple(_setting(one, names) for one in verdict.settings)
    return Section(
        id="next",
        nav="Measure next",
        heading="What records at other settings would tell",
        blocks=(Table(columns=columns, rows=rows, caption=caption),),
    )


def _setting(one: OtherSetting, names: Sequence[str]) -> Row:
    cells: list[Cell] = [f"{one.name} {quantity(one.value, SETTING_UNITS[one.name])}"]
    for name in names:
        seen = one.predicted[name]
        cells.append(
            f"{quantity(seen['frequency'], 'Hz')}, {number(seen['standard_deviation'])}"
            if seen["frequency"] > 0.0
            else "steady sliding"
        )
    return Row(cells=(*cells, percent(one.left)))


def reproduce_section(verdict: FeatureVerdict, origin: Origin) -> Section:
    """Return the section with commands, the rig file of the fit, data and references."""
    fit = _fit(verdict)
    text = fit.to_toml().strip()
    code = [(text, "The fitted block and law as a file for simulations.")] if verdict.best else []
    laws = [c.law for c in verdict.candidates if c.law is not None]
    return reproduce(origin, code=code, data=verdict.measurement.provenance, laws=laws)


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
