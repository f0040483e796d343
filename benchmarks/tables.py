"""The tables and notes of the page, in Markdown."""

from collections.abc import Sequence

from benchmarks.block.problem import HEAVY, LIGHT
from benchmarks.engines import Held, Holding
from benchmarks.measuring import Entry, Missing, Result, Section, Target

EQUAL = (
    "case", "solver", "tolerance", "error", "first run, ms", "least, ms", "spread, ms",
    "time over the kernel's",
)  # fmt: skip
TARGETS = ("work", "target", "measured", "met", "why not")
BLOCK = (
    "engine", "levels", "travel error", f"creep at {LIGHT:g} N, m", f"slide at {HEAVY:g} N, m",
    "first run, ms", "median, ms", "spread, ms", "time over stickslip's",
)  # fmt: skip


def milliseconds(seconds: float) -> str:
    """Return a time with three digits that count."""
    ms = 1e3 * seconds
    return f"{ms:.0f}" if ms >= 100 else f"{ms:#.3g}".rstrip(".")


def ratio_of(times: float) -> str:
    """Return a ratio with the digits that count."""
    return f"{times:.0f}" if times >= 100 else f"{times:#.2g}".rstrip(".")


def times(entry: Entry | Held, own: float) -> list[str]:
    """Return the four last cells of a row."""
    lowest, highest = min(entry.times), max(entry.times)
    ratio = entry.time / own
    return [
        milliseconds(entry.first),
        milliseconds(entry.time),
        f"{milliseconds(lowest)} to {milliseconds(highest)}",
        ratio_of(ratio),
    ]


def equal_rows(result: Result) -> list[list[str]]:
    own = result.entries[0].time
    rows = []
    for entry in result.entries:
        head = [result.title if entry is result.entries[0] else "", entry.solver]
        if isinstance(entry, Missing):
            rows.append([*head, entry.word, *[""] * 5])
        else:
            exact = [f"{entry.tolerance:.1e}", f"{entry.error:.0e}"]
            rows.append([*head, *exact, *times(entry, own)])
    return rows


def block_rows(holding: Holding) -> list[list[str]]:
    own = holding.entries[0].time
    rows = []
    for entry in holding.entries:
        if isinstance(entry, Missing):
            rows.append([entry.solver, "", entry.word, *[""] * 6])
        else:
            lengths = [entry.travel_error, entry.creep, entry.slide]
            cells = ["0" if length == 0 else f"{length:.1e}" for length in lengths]
            rows.append([entry.solver, entry.levels, *cells, *times(entry, own)])
    return rows


def table(heads: tuple[str, ...], rows: list[list[str]]) -> list[str]:
    """Return a Markdown table whose columns are aligned."""
    rows = [list(heads), *rows]
    widths = [max(len(row[i]) for row in rows) for i in range(len(heads))]
    lines = [
        "| " + " | ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)) + " |"
        for row in rows
    ]
    lines.insert(1, "|" + "|".join("-" * (w + 2) for w in widths) + "|")
    return lines


def reasons(entries: tuple[object, ...]) -> list[str]:
    return [
        f"- {entry.solver}: {entry.word}: {entry.reason}."
        for entry in entries
        if isinstance(entry, Missing)
    ]


def equal_error(results: list[Result]) -> list[str]:
    """Return the part with the cases whose solvers all reach the same error."""
    rows = [row for result in results for row in equal_rows(result)]
    missing = [line for result in results for line in reasons(result.entries)]
    return [
        *table(EQUAL, rows),
        "",
        *(f"- {result.title}: {result.what}; all below {result.error:.0e}." for result in results),
        *dict.fromkeys(missing),
        "",
    ]


def targets(found: Sequence[Target]) -> list[str]:
    """Return the table of targets; work with several stands once."""
    rows = []
    for i, target in enumerate(found):
        known = i > 0 and found[i - 1].work == target.work
        same = known and not found[i - 1].met and found[i - 1].reason == target.reason
        reason = "" if target.met else "as above" if same else target.reason
        rows.append([
            "" if known else target.work, target.goal, target.measured,
            "yes" if target.met else "no", reason,
        ])  # fmt: skip
    return [*table(TARGETS, rows), ""]


def section(found: Section) -> list[str]:
    """Return a part with a table of its own."""
    return [*table(found.heads, [list(row) for row in found.rows]), "", *found.notes, ""]


def in_engines(holding: Holding) -> list[str]:
    """Return the part with the block in other engines."""
    return [*table(BLOCK, block_rows(holding)), "", *NOTES, *reasons(holding.entries), ""]


NOTES = (
    "- A block of 1 kg on rough ground (mu_k = 0.25, mu_s = 0.35) is pushed with 10 N for 0.1 s,"
    " coasts to a stop, and from 1 s on is held for 10 s by 2 N, which is below both levels of"
    " friction (2.45 and 3.43 N), or by 3 N, which is between them. It must not move while held.",
    "- Travel error: place before the hold over the closed form, 0.15387 m, less 1. The time is"
    " that of the run with 2 N; building the model and letting a soft contact sink in counts in"
    " the first run only.",
    "- Levels: what the engine knows of friction. One that has a single level gets mu_k, which the"
    " travel needs, so 3 N drives it 27.4 m: right for its law, wrong for the block. Drake is"
    " given both levels, and uses the static one only in its continuous mode.",
    "- MuJoCo: the fine settings are implicitfast, 5 noslip iterations and, for the box, impratio"
    " 100; frictionloss is dry friction in a joint, without a contact.",
    "- Drake: the box has hydroelastic contact, the feet are four spheres with point contact; a"
    " velocity is the stiction tolerance, else its default.",
)
