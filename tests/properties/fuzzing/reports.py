"""Tables of what became of the cases, and how to run one of them again."""

import statistics
from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence

from tests.properties.fuzzing.campaign import Outcome
from tests.properties.fuzzing.cases import Case
from tests.properties.fuzzing.rigs import OWN

from stickslip import EventDriven


def _table(rows: Sequence[Sequence[str]]) -> str:
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(w) for cell, w in zip(row, widths, strict=True)) for row in rows]
    return "\n".join(line.rstrip() for line in lines)


def _most(titles: Iterable[str]) -> str:
    return ", ".join(f"{title} {n}" for title, n in Counter(titles).most_common(3))


def classes(outcomes: Sequence[Outcome]) -> str:
    """Return a table by status and reason."""
    groups: dict[tuple[str, str], list[Outcome]] = defaultdict(list)
    for outcome in outcomes:
        groups[outcome.status, outcome.reason].append(outcome)
    rows = [("status", "not certified because", "cases", "steps", "events", "first", "most often")]
    for (status, reason), group in sorted(groups.items(), key=lambda item: -len(item[1])):
        rows.append((
            status,
            reason or "-",
            str(len(group)),
            f"{statistics.median(one.steps for one in group):g}",
            f"{statistics.mean(run.events for run in group):.1f}",
            " ".join(str(one.index) for one in group[:4]),
            _most(one.title for one in group),
        ))  # fmt: skip
    several = sum(run.events >= 3 for run in outcomes)
    ending = f"{len(outcomes)} cases, {several} of them with three events or more"
    return f"{_table(rows)}\n{ending}, {sum(one.seconds for one in outcomes):.0f} s"


def violated(outcomes: Sequence[Outcome]) -> str:
    """Return a table of the checks that failed."""
    groups: dict[str, list[Outcome]] = defaultdict(list)
    for outcome in outcomes:
        for name, _ in outcome.violations:
            groups[name].append(outcome)
    if not groups:
        return "No check failed."
    rows = [("a run that fails to be one that", "cases", "first", "most often")]
    for name, group in sorted(groups.items(), key=lambda item: -len(item[1])):
        first = " ".join(str(one.index) for one in group[:6])
        rows.append((name, str(len(group)), first, _most(one.title for one in group)))
    return _table(rows)


def reproducer(case: Case, solver: EventDriven) -> str:
    """Return a program that runs a case again."""
    own = type(case.mechanism).__name__ if case.mechanism.name in OWN else ""
    lines = ["from stickslip import *"]
    if own:
        lines.append(f"from tests.properties.fuzzing.rigs import {own}")
    lines += [
        "run = simulate(",
        f"    {case.mechanism!r},",
        f"    {case.law!r},",
        f"    t_end={case.t_end!r}, y0={dict(case.y0)!r}, throw=False,",
        f"    solver=EventDriven(max_steps={solver.max_steps:g}, tier={solver.tier!r}),",
        ")",
        "print(run.status, run.certificate, run.events[-5:], sep='\\n')",
    ]
    return "\n".join(lines)
