"""Runs of the benchmark, a folder of results that goes on, and the page made of it."""

import functools
import hashlib
import inspect
import json
import math
import os
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from importlib.metadata import PackageNotFoundError, entry_points, version
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Final

from benchmarks.friction.definition import CoefficientError, ForceError, Task
from benchmarks.friction.peers import PEERS, Found, by_speed
from stickslip.engine.executors import Inline, check_executor, spread
from stickslip.errors import InputError, StickslipError, UnknownNameError
from stickslip.friction import law_type
from stickslip.identify.fits import Fit
from stickslip.identify.kinds import fit, select
from stickslip.quantities import vary
from stickslip.show.described import Described
from stickslip.show.display import Tabular, require_library
from stickslip.show.documents import document, json_text, regular_bytes, unwritable, write_file
from stickslip.show.formatting import Scale, count, joined, number, quantity, scale_of
from stickslip.show.plots import INTERVAL_SIZE, Interval, draw_intervals, inline_svg
from stickslip.show.report import (
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
from stickslip.show.report import Row as TableRow

if TYPE_CHECKING:
    import pandas as pd


# The tasks of the benchmark, and those of other packages.

GROUP = "stickslip.benchmark"
"""Entry points of other packages: a `Task`, or a sequence of them."""


@functools.cache
def tasks() -> Mapping[str, Task]:
    """Return the tasks by name.

    Examples
    --------
    >>> list(tasks())[:2]
    ['emps', 'pendulum']
    """
    from benchmarks.friction.records import TASKS

    result = list(TASKS)
    for entry in entry_points(group=GROUP):
        own = entry.load()
        result += [own] if isinstance(own, Task) else own
    names = [item.name for item in result]
    if twice := {name for name in names if names.count(name) > 1}:
        raise InputError(f"two tasks of the benchmark are called {min(twice)!r}.")
    return MappingProxyType({item.name: item for item in result})


def task(name: str) -> Task:
    """Return a task.

    Examples
    --------
    >>> task("rock").record
    'rock_velocity_step'
    """
    if name not in tasks():
        raise UnknownNameError("task of the benchmark", name, tasks())
    return tasks()[name]


# Runs of the benchmark: a task given to a tool, and a folder of results that goes on.

OURS: Final = "stickslip"
JOURNAL: Final = "results.jsonl"
TABLE: Final = "results.csv"
DOCUMENT: Final = "results.json"
PLAIN: Final = "coulomb-viscous"
"""The law whose fit alone is timed, beside that of the peers."""


@dataclass(frozen=True, kw_only=True)
class Row(metaclass=Described):
    """A law that a tool fitted, and how it was judged.

    Examples
    --------
    >>> Row(task="emps", tool="stickslip", law="coulomb", title="Coulomb", error=2e-3).failed
    ''
    """

    task: str
    """Name of the task."""
    tool: str
    """``"stickslip"`` or the name of a peer."""
    law: str = ""
    """Name of the law; of several joints, of each alike."""
    title: str = ""
    """Name of the law in running text."""
    error: float = math.nan
    """Error on the part that judges, in the unit of the task's metric."""
    doubt: float = math.nan
    """Standard error of the error; NaN where the record has no parts."""
    estimates: tuple[Mapping[str, Any], ...] = ()
    """Path, symbol, unit, value and 95 % interval of each parameter."""
    seconds: float = math.nan
    """Processor time of the fit [s]; of a selection, of all its laws."""
    named: bool = False
    """Whether the selection recommends it."""
    outcome: str = ""
    """What became of it in the selection, or what a peer was given."""
    failed: str = ""
    """Why there is no result; empty if there is one."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Results(Tabular):
    """The rows of a folder."""

    rows: tuple[Row, ...]
    """By task, tool and law."""
    made: int = 0
    """Pairs of task and tool that were run now; the others were there."""
    complete: bool = True
    """Whether all pairs that were asked for are there."""
    versions: Mapping[str, str] = field(default_factory=dict)
    """Of all that the results depend on."""

    def to_dataframe(self) -> "pd.DataFrame":
        """Return a row for each law, its parameters as text."""
        import pandas as pd

        rows = []
        for row in self.rows:
            own = asdict(row)
            own["unit"] = task(row.task).metric.unit
            own["estimates"] = "; ".join(map(_text, row.estimates))
            rows.append(own)
        return pd.DataFrame(rows)

    def of(self, name: str) -> tuple[Row, ...]:
        """Return the rows of a task."""
        return tuple(row for row in self.rows if row.task == name)

    def _column_units(self) -> Mapping[str, str]:
        return {"seconds": "s"}


def _text(row: Mapping[str, Any]) -> str:
    ends = "" if row["low"] is None else f" ({row['low']:.4g} to {row['high']:.4g})"
    return f"{row['path']} = {row['value']:.5g}{ends} {row['unit']}"


def run(
    names: Sequence[str],
    folder: str | Path,
    *,
    peers: Sequence[str] | None = None,
    executor: Executor | None = None,
    progress: Callable[[int, int], object] | None = None,
) -> Results:
    """Give tasks to stickslip and its peers, and keep each result in a folder.

    A pair of task and tool that is there, made by the same versions of the same code from the same
    data, is not run again: what was ended at any time goes on where it was.

    Parameters
    ----------
    names : sequence of str
        Tasks, as in `tasks`.
    folder : str or Path
        Where ``results.jsonl`` is kept, and ``results.csv`` and ``results.json`` are written.
    peers : sequence of str, optional
        Names of `PEERS`; those that are installed if not given.
    executor : concurrent.futures.Executor, optional
        Runs pairs at the same time; one after the other if not given, as processor times ask for.
    progress : callable, optional
        Called with the number of pairs that are there and of all; False ends after those in work.

    Returns
    -------
    Results
        The rows of the tasks that were asked for.

    Raises
    ------
    UnknownNameError
        If there is no such task or peer.
    InputError
        If the folder cannot be written.

    Examples
    --------
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as folder:
    ...     run([], folder).rows
    ()
    """
    check_executor(executor)
    chosen = [task(name) for name in names]
    tools = (
        [name for name, peer in PEERS.items() if _version(peer.package)] if peers is None else peers
    )
    for name in tools:
        if name not in PEERS:
            raise UnknownNameError("peer of the benchmark", name, PEERS)
        if not _version(PEERS[name].package):  # before minutes of fits
            require_library(PEERS[name].package, "bench", f"leave the peer {name} out")
    pairs = [(item.name, tool) for item in chosen for tool in (OURS, *tools)]
    folder = Path(folder)
    known = _read(folder / JOURNAL)
    # By all that a result depends on: a result of other code or data is not taken.
    digests = {pair: _digest(*pair) for pair in pairs}
    there = {pair: known[digest] for pair, digest in digests.items() if digest in known}
    missing = [pair for pair in pairs if pair not in there]
    made = 0

    def keep(found: tuple[tuple[str, str], list[Row]]) -> bool:
        nonlocal made
        pair, rows = found
        # Written at once: what is done is not lost where a later pair ends the program.
        _append(folder / JOURNAL, digests[pair], rows)
        there[pair] = rows
        made += 1
        answer = None if progress is None else progress(len(there), len(pairs))
        return answer is None or bool(answer)

    if progress is not None:
        progress(len(there), len(pairs))
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from error
    complete = spread(made_by, missing, keep, executor or Inline())
    results = Results(
        rows=tuple(row for pair in pairs for row in there.get(pair, ())),
        made=made,
        complete=complete,
        versions=_versions(tools),
    )
    if results.rows:
        write_file(folder / TABLE, results.to_dataframe().to_csv(index=False))
        rows = [_plain(row) for row in results.rows]
        content = {"versions": results.versions, "complete": complete, "rows": rows}
        write_file(folder / DOCUMENT, json_text(document("benchmark", content)))
    return results


def made_by(name: str, tool: str) -> tuple[tuple[str, str], list[Row]]:
    """Return the rows of a tool on a task; what it cannot do is said in a row."""
    case = task(name)
    empty = Row(task=name, tool=tool)
    if tool in case.left_out:
        return (name, tool), [replace(empty, failed=f"left out: {case.left_out[tool]}")]
    try:
        rows = list(_ours(case) if tool == OURS else _of_peer(case, tool))
    # What a peer cannot do is a result; an error of the program is none and passes.
    except (StickslipError, ValueError, RuntimeError, ArithmeticError) as error:
        rows = [replace(empty, failed=f"{type(error).__name__}: {error}")]
    return (name, tool), rows


def _options(case: Task) -> dict[str, Any]:
    route = {} if case.route is None else {"route": case.route}
    return {"vary": list(case.vary), "settings": case.settings, **route}


def _fit(case: Task, law: Any, record: Any) -> Any:
    return fit(case.mechanism, law, record, **_options(case))


def _timed(work: Callable[[], Any]) -> tuple[float, Any]:
    # Processor time: other programs of a loaded machine do not count.
    begun = time.process_time()
    result = work()
    return time.process_time() - begun, result


def _ours(case: Task) -> Iterator[Row]:
    """Yield the laws of a selection, or each law fitted."""
    fitted, judging = case.split()
    row = Row(task=case.name, tool=OURS)
    if not case.selects:
        for law in case.laws or ():
            own = replace(row, law=law, title=law)
            try:
                own = replace(own, title=law_type(law).title)
                seconds, result = _timed(partial(_fit, case, law, fitted))
                yield _judged(replace(own, seconds=seconds), case, result, judging)
            except StickslipError as error:
                yield replace(own, failed=str(error))
        return
    seconds, verdict = _timed(lambda: select(case.mechanism, case.laws, fitted, **_options(case)))
    for item in verdict.candidates:
        # Of the laws, the one that the selection recommends and did not drop.
        named = item is verdict.best and not item.dropped
        own = replace(
            row, law=item.name, title=item.title, seconds=seconds, named=named, outcome=item.outcome
        )
        if item.fit is None:
            yield replace(own, failed=item.dropped or "not fitted")
        else:
            yield _judged(own, case, item.fit, judging)


def _judged(row: Row, case: Task, found: Any, judging: Any) -> Row:
    error, doubt = case.metric.of(found, judging)
    estimates = tuple(
        {
            "path": item.path,
            "symbol": item.quantity.symbol,
            "unit": item.quantity.unit,
            "value": item.value,
            # Without a finite interval both ends are left out.
            "low": item.low if math.isfinite(item.high - item.low) and not item.reason else None,
            "high": item.high if math.isfinite(item.high - item.low) and not item.reason else None,
        }
        for item in found.estimates
    )
    return replace(row, error=error, doubt=doubt, estimates=estimates)


def _of_peer(case: Task, tool: str) -> Iterator[Row]:
    """Yield what a peer finds, judged as the fit of stickslip with its values."""
    peer = PEERS[tool]
    fitted, judging = case.split()
    if isinstance(case.metric, CoefficientError):
        since = case.metric.since
        seconds, (estimate, error) = _timed(lambda: by_speed(tool, fitted, judging, since))
        numbers = tuple(
            {
                "path": path, "symbol": path, "unit": "s/m" if path == "b" else "1", "value": value,
                "low": _end_of(estimate, path, -1.0), "high": _end_of(estimate, path, 1.0),
            }
            for path, value in estimate.values.items()
        )  # fmt: skip
        law = {"scipy": "c + b V", "lmfit": "c + a ln V"}[tool]
        yield Row(
            task=case.name, tool=tool, law=law, title=f"{peer.title.partition(',')[0]}, {law}",
            error=error, estimates=numbers, seconds=seconds, outcome=estimate.note,
        )  # fmt: skip
        return
    if isinstance(case.metric, ForceError):
        raise InputError("the force along a motion is foreseen by a posterior, and this has none.")
    # Our fit tells the unknowns, and values of others are judged by the same steps.
    own = _fit(case, peer.law, fitted)
    seconds, result = _timed(lambda: peer.fit(case, fitted, own))
    at = _at(own, result)
    row = Row(task=case.name, tool=tool, law=peer.law, title=peer.title, seconds=seconds)
    error, doubt = case.metric.of(at, judging)
    estimates = tuple(
        {
            "path": item.path,
            "symbol": item.quantity.symbol,
            "unit": item.quantity.unit,
            "value": result.values[item.path],
            "low": _end_of(result, item.path, -1.0),
            "high": _end_of(result, item.path, 1.0),
        }
        for item in own.estimates
    )
    yield replace(row, error=error, doubt=doubt, estimates=estimates, outcome=result.note)


def _end_of(found: Found, path: str, side: float) -> float | None:
    half = found.halves.get(path, math.nan)
    return found.values[path] + side * half if math.isfinite(half) else None


def _at(own: Fit[Any], found: Found) -> Fit[Any]:
    """Return a fit with other values of its unknowns, whose law and mechanism are judged."""
    law = {
        # Offsets of sensors are unknowns of the record, not parameters of the law.
        path: x
        for path, x in found.values.items()
        if path.startswith("friction.") and "offset" not in path
    }
    rig = {
        path: x
        for path, x in found.values.items()
        if path.startswith("mechanism.") and "joints" not in path
    }
    return replace(
        own,
        law=vary(own.law, "friction", law),
        mechanism=vary(own.mechanism, "mechanism", rig),
    )


def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return ""


def _versions(peers: Iterable[str]) -> dict[str, str]:
    packages = dict.fromkeys((OURS, "numpy", "scipy", *(PEERS[name].package for name in peers)))
    return {"python": sys.version.partition(" ")[0], **{name: _version(name) for name in packages}}


def _digest(name: str, tool: str) -> str:
    """Return the hash of all that a result depends on: task, data, versions, code of both."""
    case = task(name)
    own = [case.dataset.file(file) for file in case.files]
    data = [(file.name, file.sha256 or file.source_sha256) for file in own]
    code = [inspect.getsource(sys.modules[case.split.__module__]), _code()]
    packages = _versions([] if tool == OURS else [tool])
    text = repr((name, tool, data, code, packages))
    return hashlib.sha256(text.encode()).hexdigest()


@functools.cache
def _code() -> str:
    """Return the hash of all code of this package."""
    # Of all files: what a result depends on cannot be told from the outside.
    result = hashlib.sha256()
    for path in sorted(Path(str(files(OURS))).rglob("*.py")):
        result.update(path.read_bytes())
    return result.hexdigest()


def _plain(row: Row) -> dict[str, Any]:
    """Return a row as JSON has it: None for what is not a number."""
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in asdict(row).items()
    }


def _row(plain: Mapping[str, Any]) -> Row:
    """Return a row that JSON had."""
    values: dict[str, Any] = {
        key: math.nan if value is None else tuple(value) if isinstance(value, list) else value
        for key, value in plain.items()
    }
    return Row(**values)


def _read(path: Path) -> dict[str, list[Row]]:
    """Return results by their hash; a last line that was cut off counts as not there."""
    result: dict[str, list[Row]] = {}
    try:
        lines = regular_bytes(path).decode("utf-8").splitlines()
    except FileNotFoundError:
        return result
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path} cannot be read: {error}.") from None
    # Each line by itself: one that was cut off does not cost the others.
    for line in lines:
        try:
            entry = json.loads(line)
            result[entry["digest"]] = [_row(row) for row in entry["rows"]]
        except (KeyError, RecursionError, TypeError, ValueError):
            continue
    return result


def _append(path: Path, digest: str, rows: Sequence[Row]) -> None:
    line = json.dumps({"digest": digest, "rows": [_plain(row) for row in rows]})
    try:
        with path.open("ab+") as journal:
            if journal.tell():
                journal.seek(-1, os.SEEK_END)
                line = line if journal.read() == b"\n" else f"\n{line}"  # the last one was cut off
            journal.write(f"{line}\n".encode())
    except OSError as error:
        raise unwritable(path, error) from error


# The page of the benchmark: who predicts what was not seen, set by set.

NONE = "—"
SHOWN = 8
"""Parameters of a law that a row shows at most; the CSV has all."""


def benchmark_page(results: Results, *, reproduce: Sequence[str] = ()) -> Page:
    """Return the page of the results."""
    names = list(dict.fromkeys(row.task for row in results.rows))
    sections = [_section(task(name), results.of(name)) for name in names]
    return Page(
        title="Friction benchmark",
        subject=count(len(names), "task"),
        kicker="fitted on one part, judged on another",
        sections=(_overview(results, names), *sections, _closing_section(results, reproduce)),
        footer=colophon(results.versions),
    )


def best_of(rows: Sequence[Row]) -> Row | None:
    """Return the row with the least error."""
    known = [row for row in rows if math.isfinite(row.error)]
    return min(known, key=lambda row: row.error, default=None)


def of_ours(rows: Sequence[Row]) -> Row | None:
    """Return the law that is named; where none is, the best of those that were fitted."""
    own = [row for row in rows if row.tool == OURS]
    named = [row for row in own if row.named]
    return named[0] if named else best_of(own)


def scale_for(case: Task, rows: Sequence[Row]) -> Scale:
    """Return what errors of a task are shown in, by the least of them."""
    if case.metric.unit == "1":
        return Scale(100.0, "%")
    best = best_of(rows)
    return scale_of([] if best is None else [best.error], case.metric.unit)


def error_text(scale: Scale, row: Row | None) -> tuple[str, str]:
    """Return an error and its standard error in a scale."""
    if row is None or not math.isfinite(row.error):
        return NONE, ""
    doubt = f"± {number(scale.factor * row.doubt, 1)}" if math.isfinite(row.doubt) else ""
    return number(scale.factor * row.error, 3), doubt


def summary_rows(results: Results) -> list[list[str]]:
    """Return the cells of the overview: task, our law, its error, that of each peer."""
    result = []
    for name in dict.fromkeys(row.task for row in results.rows):
        rows, case = results.of(name), task(name)
        scale, ours = scale_for(case, rows), of_ours(rows)
        law = "" if ours is None else ours.title + ("" if ours.named else " (not named)")
        by_tool = {row.tool: row for row in rows}
        judged = (ours, *(by_tool.get(tool) for tool in PEERS))
        result.append([name, law, *(_in_words(scale, row) for row in judged)])
    return result


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
        case, own = task(name), results.of(name)
        scale, ours = scale_for(case, own), of_ours(own)
        law = Name(text=NONE) if ours is None else Name(text=ours.title, aside=_whether(ours))
        cells: list[Cell] = [Name(text=name, aside=case.title), law, _number(scale, ours)]
        by_tool = {row.tool: row for row in own}
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


def _section(case: Task, rows: Sequence[Row]) -> Section:
    scale, record = scale_for(case, rows), case.dataset
    best = best_of(rows)
    facts = [
        ("Record", f"{record.name}: {record.title}"),
        ("Source", f"{record.citation} https://github.com/{record.repository}"),
        ("Licence", record.licence),
        ("Fitted", case.fitted),
        ("Judged", case.judged),
        ("Metric", case.metric.text),
        *((peer.what, f"{peer.result} ({peer.source})") for peer in case.published),
    ]
    if case.truth:
        truth = joined([f"{name} {number(value)}" for name, value in case.truth.items()])
        facts.append(("True values", truth))
    blocks: list[Block] = [KeyValues(items=tuple(KeyValue(key=k, value=v) for k, v in facts))]
    shown = [row for row in rows if math.isfinite(row.error)]
    ordered = sorted(shown, key=lambda row: row.error)
    if ordered:
        marks = [
            Interval(_called(row), row.error, row.doubt, row.named)
            for row in ordered
            # Errors far beyond would press all others to one end of the axis.
            if best is not None and row.error < 50.0 * best.error
        ]
        height = max(INTERVAL_SIZE[1], 60 + 34 * len(marks))
        svg = inline_svg(
            draw_intervals(marks, "error on what was not seen", case.metric.unit),
            wide=(INTERVAL_SIZE[0], height),
            alt=f"Errors of {len(marks)} laws on {case.title}",
            prefix=f"figure-{case.name}",
        )
        blocks.append(
            Figure(svg=svg, caption=f"**{case.title}.** Dot: error; bar: ± 1 standard error.")
        )
        blocks.append(_table(scale, ordered))
    failed = [f"{_called(row)}: {row.failed}" for row in rows if row.failed]
    blocks += [Caption(text=f"{text.rstrip('.')}.") for text in dict.fromkeys(failed)]
    heading = case.title if best is None else f"{case.title}: {_called(best)} errs least"
    return Section(id=f"task-{case.name}", nav=case.name, heading=heading, blocks=tuple(blocks))


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
    result = []
    for row in rows:
        value, doubt = error_text(scale, row)
        tool = "stickslip" if row.tool == OURS else row.tool
        remark = ("named; " if row.named and row.outcome != "chosen" else "") + row.outcome
        cells: tuple[Cell, ...] = (
            Name(text=_called(row), aside=tool),
            Number(value=value, doubt=doubt),
            parameters_text(row.estimates) or NONE,
            number(row.seconds, 2),
            remark or NONE,
        )
        result.append(TableRow(cells=cells, chosen=row.named, muted=False))
    return Table(columns=columns, rows=tuple(result))


def parameters_text(estimates: Sequence[Mapping[str, Any]]) -> str:
    """Return the parameters of a law with their intervals, in a line.

    Examples
    --------
    >>> one = {"symbol": "mu_k", "unit": "1", "value": 0.25, "low": 0.2, "high": 0.3}
    >>> parameters_text([one])
    '$mu_k$ = 0.25 (0.2 to 0.3)'
    """
    texts = []
    for row in estimates[:SHOWN]:
        low, high = row["low"], row["high"]
        ends = "no interval" if low is None else f"{number(low, 3)} to {number(high, 3)}"
        texts.append(f"${row['symbol']}$ = {quantity(row['value'], row['unit'], 3)} ({ends})")
    more = len(estimates) - SHOWN
    return ", ".join(texts) + (f" and {more} more" if more > 0 else "")


def _closing_section(results: Results, commands: Sequence[str]) -> Section:
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
