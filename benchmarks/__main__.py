"""``python -m benchmarks``: run all cases, print them, and write docs/benchmarks.md."""

import importlib.metadata
import os
import platform
from pathlib import Path

from benchmarks import belt, decay, lugre
from benchmarks.measuring import Result

CASES = (decay, belt, lugre)
PAGE = Path(__file__).parents[1] / "docs" / "benchmarks.md"
HEADS = (
    "case", "solver", "tolerance", "error", "first run, ms", "median, ms", "spread, ms",
    "time over stickslip's",
)  # fmt: skip


def rows_of(result: Result) -> list[list[str]]:
    own = result.entries[0].median
    return [
        [
            result.title if entry is result.entries[0] else "",
            entry.solver,
            f"{entry.tolerance:.1e}",
            f"{entry.error:.0e}",
            f"{1e3 * entry.first:.1f}",
            f"{1e3 * entry.median:.1f}",
            f"{1e3 * min(entry.times):.1f} to {1e3 * max(entry.times):.1f}",
            f"{entry.median / own:.2f}",
        ]
        for entry in result.entries
    ]


def table(results: list[Result]) -> list[str]:
    """Return the results as a Markdown table whose columns are aligned."""
    rows = [list(HEADS), *[row for result in results for row in rows_of(result)]]
    widths = [max(len(row[i]) for row in rows) for i in range(len(HEADS))]
    lines = [
        "| " + " | ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)) + " |"
        for row in rows
    ]
    lines.insert(1, "|" + "|".join("-" * (w + 2) for w in widths) + "|")
    return lines


def machine() -> str:
    """Return what the times were taken on."""
    libraries = ", ".join(
        f"{name} {importlib.metadata.version(name)}" for name in ("stickslip", "numpy", "scipy")
    )
    return (
        f"Machine: {processor()}, {os.cpu_count()} cores;"
        f" {platform.system()}, Python {platform.python_version()}, {libraries}."
    )


def processor() -> str:
    try:
        for line in Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.partition(":")[2].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def main() -> None:
    results = [case.run() for case in CASES]
    notes = [
        f"- {result.title}: {result.what}; all below {result.error:.0e}." for result in results
    ]
    repeats = len(results[0].entries[0].times)
    text = "\n".join(
        [
            *table(results),
            "",
            *notes,
            "",
            f"Medians of {repeats} runs after the first, one process. {machine()}",
        ]
    )
    print(text)
    PAGE.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
