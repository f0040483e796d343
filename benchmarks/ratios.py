"""Ratios to other tools, one CSV file a release: python -m benchmarks.ratios --output FILE.

Times are those of `decay`, `belt`, `lugre` and `sampled` at equal error, the peer's over the
kernel's, on the machine at hand. Errors are those of the friction benchmark on parts that no fit
has seen, the peer's over that of the law that stickslip names, or of the least error where it names
none: `python -m benchmarks.friction -o FOLDER` writes the table that ``--friction`` takes, by
default that of this version. A ratio above 1 is in favour of stickslip.

``--table FOLDER`` prints such files beside each other, in the order of their names.
"""

import argparse
import csv
import importlib
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from tools.site import order

import stickslip
from benchmarks.measuring import KERNEL, MANY, Missing
from benchmarks.tables import ratio_of, table

CASES = ("decay", "belt", "lugre", "sampled")
FIELDS = ("measure", "task", "peer", "stickslip", "other", "unit", "ratio")
OURS = "stickslip"
ROOT = Path(__file__).parents[1]
FRICTION = ROOT / "docs/_static/friction-benchmark" / stickslip.__version__ / "results.csv"
KEPT = 4
"""Digits of a number in a file: times are not steadier."""

Row = dict[str, str]


def row(measure: str, task: str, peer: str, own: float, other: float, unit: str) -> Row:
    numbers = (f"{item:.{KEPT}g}" for item in (own, other, other / own))
    cells = (measure, task, peer, *numbers)
    return dict(zip(FIELDS, (*cells[:5], unit, cells[5]), strict=True))


def times(cases: Sequence[str], repeats: int) -> Iterator[Row]:
    """Yield how long peers take over the kernel, at the same error."""
    for case in cases:
        result = importlib.import_module(f"benchmarks.{case}").run(repeats)
        entries = [entry for entry in result.entries if not isinstance(entry, Missing)]
        (own,) = (entry.time for entry in entries if entry.solver == KERNEL)
        for entry in entries:
            if not entry.solver.startswith(OURS):
                yield row("time", case, entry.solver.partition(",")[0], own, entry.time, "s")


def errors(path: Path) -> Iterator[Row]:
    """Yield how large the held-out errors of peers are over those of stickslip."""
    by_task: dict[str, list[Row]] = {}
    with path.open(encoding="utf-8", newline="") as file:
        for item in csv.DictReader(file):
            if item["error"]:
                by_task.setdefault(item["task"], []).append(item)
    for task, rows in by_task.items():
        ours = [item for item in rows if item["tool"] == OURS]
        named = [our for our in ours if our["named"] == "True"]
        best = min((float(our["error"]) for our in named or ours), default=None)
        for item in rows:
            if best is not None and item["tool"] != OURS:
                yield row("error", task, item["tool"], best, float(item["error"]), item["unit"])


def beside(folder: Path) -> list[str]:
    """Return the ratios of all files of a folder as a Markdown table, a column each."""
    files = sorted(folder.glob("*.csv"), key=lambda path: (order(path.stem), path.stem))
    result: dict[tuple[str, str, str], dict[str, str]] = {}
    for path in files:
        with path.open(encoding="utf-8", newline="") as file:
            for item in csv.DictReader(file):
                key = (item["measure"], item["task"], item["peer"])
                result.setdefault(key, {})[path.stem] = ratio_of(float(item["ratio"]))
    heads = ("measure", "task", "peer", *(path.stem for path in files))
    return table(
        heads, [[*key, *(of.get(head, "") for head in heads[3:])] for key, of in result.items()]
    )


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.ratios", description=__doc__)
    parser.add_argument("--output", type=Path, help="CSV file to write")
    parser.add_argument(
        "--friction", type=Path, default=FRICTION, help="results.csv of a benchmark"
    )
    parser.add_argument("--cases", default=",".join(CASES), help="joined by commas")
    parser.add_argument("--repeats", type=int, default=MANY, help="runs, of which the least counts")
    parser.add_argument("--table", type=Path, help="folder of such files, to print")
    asked = parser.parse_args()
    if asked.table is not None:
        print("\n".join(beside(asked.table)))
        return
    if asked.output is None:
        parser.error("give --output or --table")
    if not asked.friction.is_file():
        parser.error(f"{asked.friction} is missing: `python -m benchmarks.friction` writes it")
    rows = [*times([item for item in asked.cases.split(",") if item], asked.repeats)]
    rows += errors(asked.friction)
    asked.output.parent.mkdir(parents=True, exist_ok=True)
    with asked.output.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, FIELDS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    print("\n".join(beside(asked.output.parent)), file=sys.stderr)


if __name__ == "__main__":
    main()
