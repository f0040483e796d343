"""The end of the report: the record and its checks, next measurements, how to reproduce it."""

from collections.abc import Sequence

from stickslip.formatting import estimate, number, percent, quantity
from stickslip.report.core.blocks import KeyValue, KeyValues
from stickslip.report.core.checks import check_items
from stickslip.report.core.documents import Origin, Section
from stickslip.report.core.headings import checks_heading
from stickslip.report.core.reproduce import law_references, reproduce
from stickslip.report.core.tables import Cell, Column, Row, Table
from stickslip.report.features.texts import typeset_lines
from stickslip.selection import FeatureVerdict, OtherSpeed


def record_section(verdict: FeatureVerdict) -> Section:
    """Return the section on the features of the whole record and what was checked of it."""
    items = [*_numbers(verdict)]
    for line in typeset_lines(verdict.features.sentences, verdict):
        items.append(KeyValue(key="Feature", value=line, mark="warn"))
    items += check_items(verdict.checks)
    warned = sum(item.mark != "none" for item in items)
    heading = checks_heading(warned, "its features and checks")
    block = KeyValues(items=tuple(items))
    return Section(id="record", nav="Record and checks", heading=heading, blocks=(block,))


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
    if verdict.measurement.provenance:
        items.append(KeyValue(key="Data", value=verdict.measurement.provenance))
    laws = [c.law for c in verdict.candidates if c.law is not None]
    return reproduce(origin, code=code, items=items, references=law_references(laws, {}))
