"""``stickslip benchmark``."""

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import typer

from stickslip.benchmark import PEERS, Task, benchmark_page, run, summary_rows, tasks
from stickslip.cli.console import command_line, note, print_json, show_table, stdout
from stickslip.cli.process_pool import workers
from stickslip.cli.progress import Drawing, Interrupts
from stickslip.documents import document, write_files
from stickslip.errors import InputError, UnknownNameError
from stickslip.report import render

PAGE: Final = "index.html"
SUMMARY: Final = "summary.csv"
CANCELLED: Final = 130


def run_benchmark(
    names: Sequence[str],
    folder: Path,
    *,
    peers: str | None,
    count: int | None,
    executor: str | None,
    listed: bool,
    as_json: bool,
) -> None:
    """Run the tasks that are missing, write page and tables, show the overview."""
    known = tasks()
    for name in names:
        if name not in known:
            raise UnknownNameError("task of the benchmark", name, known)
    chosen = [known[name] for name in names] or list(known.values())
    if listed:
        _list(chosen, as_json=as_json)
        return
    chosen = _with_data(chosen)
    asked = None if peers is None else [one.strip() for one in peers.split(",") if one.strip()]
    with (
        Interrupts() as interrupts,
        Drawing("Running", "fits") as bar,
        workers(count or 1, executor) as pool,
    ):
        interrupts.promise = "Stopping after the fits in work; press Ctrl-C again to cancel."

        def progress(done: int, total: int) -> bool:
            bar(done, total)
            return not interrupts.stopped

        found = run(
            [one.name for one in chosen], folder, peers=asked, executor=pool, progress=progress
        )
    if not found.rows:
        note("No fit is there yet: the same command begins again.")
        raise typer.Exit(CANCELLED)
    heads, cells = ["task", "law of stickslip", "error", *PEERS], summary_rows(found)
    lines = io.StringIO()
    csv.writer(lines, lineterminator="\n").writerows([heads, *cells])
    page = render(benchmark_page(found, reproduce=[command_line()]))
    write_files({folder / PAGE: page, folder / SUMMARY: lines.getvalue()})
    if as_json:
        content = {"folder": str(folder), "made": found.made, "complete": found.complete}
        print_json(document("benchmark-run", content))
    else:
        show_table("", heads, cells, whole=["task"])
        stdout().print(f"\nReport: {folder / PAGE}", markup=False)
    if not found.complete:
        note("Not all fits are there: the same command goes on.")
        raise typer.Exit(CANCELLED)


def _with_data(chosen: Sequence[Task]) -> list[Task]:
    """Return the tasks whose records are there, or could be got; say licences, and what is not."""
    found = []
    for one in chosen:
        record = one.dataset

        def told(text: str, licence: str = record.licence) -> None:
            note(f"{text} (licence: {licence})")

        try:
            for file in one.files:
                record.path(file, report=told)
        except InputError as error:
            note(f"{one.name}: left out: {error}")
        else:
            found.append(one)
    if not found:
        raise InputError("there is no record for any of the tasks: stickslip data list")
    return found


def _list(chosen: Sequence[Task], *, as_json: bool) -> None:
    if as_json:
        rows = [
            {
                "name": one.name,
                "title": one.title,
                "record": one.record,
                "licence": one.dataset.licence,
                "fitted": one.fitted,
                "judged": one.judged,
                "metric": one.metric.text,
                "unit": one.metric.unit,
            }
            for one in chosen
        ]
        print_json(document("benchmark-tasks", {"tasks": rows}))
        return
    cells = [[one.name, one.title, one.fitted, one.judged, one.metric.text] for one in chosen]
    show_table("", ["task", "what", "fitted", "judged", "metric"], cells, whole=["task"])
