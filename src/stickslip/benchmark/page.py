"""The page of the benchmark: who predicts what was not seen, set by set."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.benchmark.definition import Task
from stickslip.benchmark.peers import PEERS
from stickslip.benchmark.runs import OURS, Results, Row
from stickslip.benchmark.sets import task
from stickslip.formatting import Scale, count, joined, number, quantity, scale_of
from stickslip.plots import INTERVAL_SIZE, Interval, draw_intervals, inline_svg
from stickslip.report import (
    Block,
    Caption,
    Cell,
    Code,
    Column,
    Figure,
    KeyValue,
    KeyValues,
    Name,
    Number,
    Page,
    Paragraph,
    Section,
    Table,
    colophon,
)
from stickslip.report import Row as TableRow

NONE = "—"
SHOWN = 8
"""Parameters of a law that a row shows at most; the CSV has all."""


def benchmark_page(results: Results, *, reproduce: Sequence[str] = ()) -> Page:
    """Return the page of the results."""
    names = list(dict.fromkeys(one.task for one in results.rows))
    sections = [_section(task(name), results.of(name)) for name in names]
    return Page(
        title="Friction benchmark",
        subject=count(len(names), "task"),
        kicker="fitted on one part, judged on another",
        sections=(_overview(results, names), *sections, _end(results, reproduce)),
        footer=colophon(results.versions),
    )


def best_of(rows: Sequence[Row]) -> Row | None:
    """Return the row with the least error."""
    known = [one for one in rows if math.isfinite(one.error)]
    return min(known, key=lambda one: one.error, default=None)


def of_ours(rows: Sequence[Row]) -> Row | None:
    """Return the law that is named; where none is, the best of those that were fitted."""
    own = [one for one in rows if one.tool == OURS]
    named = [one for one in own if one.named]
    return named[0] if named else best_of(own)


def scale_for(asked: Task, rows: Sequence[Row]) -> Scale:
    """Return what errors of a task are shown in, by the least of them."""
    if asked.metric.unit == "1":
        return Scale(100.0, "%")
    best = best_of(rows)
    return scale_of([] if best is None else [best.error], asked.metric.unit)


def error_text(scale: Scale, row: Row | None) -> tuple[str, str]:
    """Return an error and its standard error in a scale."""
    if row is None or not math.isfinite(row.error):
        return NONE, ""
    doubt = f"± {number(scale.factor * row.doubt, 1)}" if math.isfinite(row.doubt) else ""
    return number(scale.factor * row.error, 3), doubt


def summary_rows(results: Results) -> list[list[str]]:
    """Return the cells of the overview: task, our law, its error, that of each peer."""
    found = []
    for name in dict.fromkeys(one.task for one in results.rows):
        rows, asked = results.of(name), task(name)
        scale, ours = scale_for(asked, rows), of_ours(rows)
        law = "" if ours is None else ours.title + ("" if ours.named else " (not named)")
        by_tool = {one.tool: one for one in rows}
        judged = (ours, *(by_tool.get(tool) for tool in PEERS))
        found.append([name, law, *(_in_words(scale, one) for one in judged)])
    return found


def _in_words(scale: Scale, row: Row | None) -> str:
    value, doubt = error_text(scale, row)
    return NONE if value == NONE else " ".join(filter(None, (value, doubt, scale.unit)))


def _overview(results: Results, names: Sequence[str]) -> Section:
    columns = (
        Column(head="task"),
        Column(head="law of stickslip"),
        Column(head="its error", numeric=True, phone="label"),
        *(Column(head=tool, numeric=True, phone="label") for tool in PEERS),
    )
    rows = []
    for name in names:
        asked, own = task(name), results.of(name)
        scale, ours = scale_for(asked, own), of_ours(own)
        law = Name(text=NONE) if ours is None else Name(text=ours.title, aside=_whether(ours))
        cells: list[Cell] = [Name(text=name, aside=asked.title), law, _number(scale, ours)]
        by_tool = {one.tool: one for one in own}
        rows.append(
            TableRow(cells=(*cells, *(_number(scale, by_tool.get(tool)) for tool in PEERS)))
        )
    blocks: tuple[Block, ...] = (
        Paragraph(
            text="Each task fits one part of a public record and predicts another. The error is the"
            " task's own metric on the part that was not seen; ± is its standard error by parts of"
            " the record. The law of stickslip is the one that its selection names on the fitted"
            " part alone. Where it names none, the table has the fitted law with the least error,"
            " which is a choice with hindsight."
        ),
        Table(columns=columns, rows=tuple(rows)),
        Caption(text=f"{NONE}: the tool was not run on the task; its section says why."),
    )
    heading = "Errors on what was not seen"
    return Section(id="overview", nav="Overview", heading=heading, blocks=blocks)


def _whether(row: Row) -> str:
    return "named" if row.named else "not named"


def _number(scale: Scale, row: Row | None) -> Cell:
    value, doubt = error_text(scale, row)
    return NONE if value == NONE else Number(value=value, doubt=doubt, unit=scale.unit)


def _section(asked: Task, rows: Sequence[Row]) -> Section:
    scale, record = scale_for(asked, rows), asked.dataset
    best = best_of(rows)
    facts = [
        ("Record", f"{record.name}: {record.title}"),
        ("Source", f"{record.citation} https://github.com/{record.repository}"),
        ("Licence", record.licence),
        ("Fitted", asked.fitted),
        ("Judged", asked.judged),
        ("Metric", asked.metric.text),
        *((one.what, f"{one.result} ({one.source})") for one in asked.published),
    ]
    if asked.truth:
        told = joined([f"{name} {number(value)}" for name, value in asked.truth.items()])
        facts.append(("True values", told))
    blocks: list[Block] = [KeyValues(items=tuple(KeyValue(key=k, value=v) for k, v in facts))]
    shown = [one for one in rows if math.isfinite(one.error)]
    ordered = sorted(shown, key=lambda one: one.error)
    if ordered:
        marks = [
            Interval(_called(one), one.error, one.doubt, one.named)
            for one in ordered
            if best is not None and one.error < 50.0 * best.error
        ]
        height = max(INTERVAL_SIZE[1], 60 + 34 * len(marks))
        svg = inline_svg(
            draw_intervals(marks, "error on what was not seen", asked.metric.unit),
            wide=(INTERVAL_SIZE[0], height),
            alt=f"Errors of {len(marks)} laws on {asked.title}",
            prefix=f"figure-{asked.name}",
        )
        blocks.append(
            Figure(svg=svg, caption=f"**{asked.title}.** Dot: error; bar: ± 1 standard error.")
        )
        blocks.append(_table(scale, ordered))
    failed = [f"{_called(one)}: {one.failed}" for one in rows if one.failed]
    blocks += [Caption(text=f"{text.rstrip('.')}.") for text in dict.fromkeys(failed)]
    heading = asked.title if best is None else f"{asked.title}: {_called(best)} errs least"
    return Section(id=f"task-{asked.name}", nav=asked.name, heading=heading, blocks=tuple(blocks))


def _called(row: Row) -> str:
    if row.tool != OURS:
        return row.title or PEERS[row.tool].title
    return row.title or "stickslip"


def _table(scale: Scale, rows: Sequence[Row]) -> Table:
    columns = (
        Column(head="law"),
        Column(head=f"error\n{scale.unit}", numeric=True),
        Column(head="parameters, with 95 % intervals", phone="label"),
        Column(head="processor\ns", numeric=True, phone="label"),
        Column(head="remark", phone="label"),
    )
    found = []
    for one in rows:
        value, doubt = error_text(scale, one)
        tool = "stickslip" if one.tool == OURS else one.tool
        remark = ("named; " if one.named and one.outcome != "chosen" else "") + one.outcome
        cells: tuple[Cell, ...] = (
            Name(text=_called(one), aside=tool),
            Number(value=value, doubt=doubt),
            parameters_text(one.estimates) or NONE,
            number(one.seconds, 2),
            remark or NONE,
        )
        found.append(TableRow(cells=cells, chosen=one.named, muted=False))
    return Table(columns=columns, rows=tuple(found))


def parameters_text(estimates: Sequence[Mapping[str, Any]]) -> str:
    """Return the parameters of a law with their intervals, in a line.

    Examples
    --------
    >>> one = {"symbol": "mu_k", "unit": "1", "value": 0.25, "low": 0.2, "high": 0.3}
    >>> parameters_text([one])
    '$mu_k$ = 0.25 (0.2 to 0.3)'
    """
    texts = []
    for one in estimates[:SHOWN]:
        low, high = one["low"], one["high"]
        ends = "no interval" if low is None else f"{number(low, 3)} to {number(high, 3)}"
        texts.append(f"${one['symbol']}$ = {quantity(one['value'], one['unit'], 3)} ({ends})")
    more = len(estimates) - SHOWN
    return ", ".join(texts) + (f" and {more} more" if more > 0 else "")


def _end(results: Results, commands: Sequence[str]) -> Section:
    blocks: list[Block] = [
        Paragraph(
            text="Peers of regression (SciPy, lmfit, PySINDy) are given position and force through"
            " a Butterworth filter of order 4 forward and backward, differences, the rows that"
            " slip, and the rigid-body terms of the mechanism; the frequency of the filter is the"
            " one with which SciPy errs least on the part that judges, in favour of peers."
            " mujoco.sysid rolls out segments from smoothed states. The values that a peer finds"
            " are judged as the same law with these"
            " values: each segment of the part that judges begins at its own fitted state, for all"
            " tools alike. Processor times are of one fit each, and of a whole selection where laws"
            " are selected; work that is compiled once for a machine is in them where it was new."
        )
    ]
    if commands:
        blocks.append(Code(text="\n".join(f"$ {command}" for command in commands)))
    items = [KeyValue(key=name, value=version) for name, version in results.versions.items()]
    blocks.append(KeyValues(items=tuple(items)))
    return Section(id="method", nav="Method", heading="How it was measured", blocks=tuple(blocks))
