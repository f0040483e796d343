"""``python -m benchmarks.friction [task ...]``: public records, our laws, other libraries.

Each task fits one part of a record and predicts another. Records are downloaded where they are
missing. What was interrupted goes on with the same command.
"""

import argparse
import csv
import io
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from benchmarks.friction.definition import Task
from benchmarks.friction.peers import PEERS
from benchmarks.friction.runs import benchmark_page, run, summary_rows, tasks
from stickslip.cli import console
from stickslip.cli.progress import Drawing, Interrupts, workers
from stickslip.errors import InputError, StickslipError, UnknownNameError
from stickslip.show.documents import document, write_files
from stickslip.show.report import render

PAGE: Final = "index.html"
SUMMARY: Final = "summary.csv"
BAD_INPUT, CANCELLED = 2, 130
"""Exit codes of what cannot be used, and of a benchmark that is not complete."""


def parsed(arguments: Sequence[str] | None) -> argparse.Namespace:
    """Return the options of the command."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.friction", description=__doc__)
    add = parser.add_argument
    add("names", nargs="*", metavar="TASK", help="tasks; all if not given")
    add(
        "-o", "--output", type=Path, default=Path("stickslip-benchmark"),
        help="folder of page, tables and results so far",
    )  # fmt: skip
    add("--peers", metavar="NAME,...", help=f"of {', '.join(PEERS)}; default: those installed")
    add("--list", action="store_true", dest="listed", help="only list the tasks")
    add("--json", action="store_true", help="print one JSON document")
    add("--workers", type=int, default=1, help="processes that share the work")
    add("--executor", metavar="dask://HOST:PORT", help="Dask cluster that does the work")
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the tasks that are missing, write page and tables, show the overview."""
    given = parsed(arguments)
    try:
        return _run(given, shlex.join(sys.argv[1:] if arguments is None else arguments))
    except StickslipError as error:
        print(f"benchmarks.friction: {error}", file=sys.stderr)
        return BAD_INPUT


def _run(given: argparse.Namespace, command: str) -> int:
    folder, known = given.output, tasks()
    for name in given.names:
        if name not in known:
            raise UnknownNameError("task of the benchmark", name, known)
    chosen = [known[name] for name in given.names] or list(known.values())
    if given.listed:
        _list(chosen, as_json=given.json)
        return 0
    chosen = _with_data(chosen)
    peers = None if given.peers is None else [*filter(None, map(str.strip, given.peers.split(",")))]
    with (
        Interrupts() as interrupts,
        Drawing("Running", "fits") as bar,
        workers(given.workers, given.executor) as pool,
    ):
        interrupts.promise = "Stopping after the fits in work; press Ctrl-C again to cancel."

        def progress(done: int, total: int) -> bool:
            bar(done, total)
            return not interrupts.stopped

        names = [task.name for task in chosen]
        result = run(names, folder, peers=peers, executor=pool, progress=progress)
    if not result.rows:
        console.note("No fit is there yet: the same command begins again.")
        return CANCELLED
    heads, cells = ["task", "law of stickslip", "error", *PEERS], summary_rows(result)
    lines = io.StringIO()
    csv.writer(lines, lineterminator="\n").writerows([heads, *cells])
    reproduce = [f"python -m benchmarks.friction {command}".strip()]
    page = render(benchmark_page(result, reproduce=reproduce))
    write_files({folder / PAGE: page, folder / SUMMARY: lines.getvalue()})
    if given.json:
        content = {"folder": str(folder), "made": result.made, "complete": result.complete}
        console.print_json(document("benchmark-run", content))
    else:
        console.show_table("", heads, cells, whole=["task"])
        console.stdout().print(f"\nReport: {folder / PAGE}")
    if not result.complete:
        console.note("Not all fits are there: the same command goes on.")
        return CANCELLED
    return 0


def _with_data(chosen: Sequence[Task]) -> list[Task]:
    """Return the tasks whose records are there, or could be got; say licences, and what is not."""
    result = []
    for task in chosen:
        record = task.dataset

        def told(text: str, licence: str = record.licence) -> None:
            console.note(f"{text} (licence: {licence})")

        try:
            for file in task.files:
                record.path(file, report=told)
        except InputError as error:
            console.note(f"{task.name}: left out: {error}")
        else:
            result.append(task)
    if not result:
        raise InputError("there is no record for any of the tasks: stickslip data list")
    return result


def _list(chosen: Sequence[Task], *, as_json: bool) -> None:
    if as_json:
        rows = [
            {
                "name": task.name,
                "title": task.title,
                "record": task.record,
                "licence": task.dataset.licence,
                "fitted": task.fitted,
                "judged": task.judged,
                "metric": task.metric.text,
                "unit": task.metric.unit,
            }
            for task in chosen
        ]
        console.print_json(document("benchmark-tasks", {"tasks": rows}))
        return
    cells = [[task.name, task.title, task.fitted, task.judged, task.metric.text] for task in chosen]
    console.show_table("", ["task", "what", "fitted", "judged", "metric"], cells, whole=["task"])


if __name__ == "__main__":
    sys.exit(main())
