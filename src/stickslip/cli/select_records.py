"""``stickslip select`` for records in time and measured friction."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

from stickslip.cli.console import (
    NONE,
    command_line,
    document,
    plain,
    show_table,
    stdout,
)
from stickslip.cli.inputs import (
    Asked,
    Measured,
    residuals,
    show_estimates,
    show_open,
    show_warnings,
)
from stickslip.cli.interrupts import Interrupts
from stickslip.cli.process_pool import workers
from stickslip.cli.progress import Searching
from stickslip.cli.selected import deliver, laws_of
from stickslip.cli.trials import show_trials
from stickslip.experiments import Rig
from stickslip.experiments.hashing import of_files
from stickslip.friction import FrictionLaw
from stickslip.report.core.versions import versions
from stickslip.report.records import record_page
from stickslip.selection import RecordCandidate, RecordVerdict, select
from stickslip.selection.candidates import specifications
from stickslip.selection.verdict import score_text

__all__ = ["select_on_records"]


def select_on_records(
    rig: Rig,
    found: Measured,
    asked: Asked,
    laws: str | None,
    output: Path,
    *,
    jobs: int,
    as_json: bool,
) -> None:
    """Select, write what was found into a folder, print the verdict."""
    verdict = _selected(rig, found, asked, laws_of(rig, laws), jobs)
    head = {"rig": rig.title, "digest": found.digest}
    content = document("select", {**head, **verdict.to_dict()})
    ended = [c.name for c in verdict.candidates if c.fit and c.fit.found.cancelled]
    deliver(
        verdict,
        content,
        None if as_json else output,
        page=lambda: _page(verdict, rig, found.digest, asked),
        show=lambda: _show(verdict),
        ended=ended,
    )


def _selected(
    rig: Rig,
    found: Measured,
    asked: Asked,
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | str] | None,
    jobs: int,
) -> RecordVerdict:
    """Select with a bar; Ctrl-C once ends the search with what there is."""
    names = [one.name for one in specifications(laws)]
    with (
        Interrupts() as interrupts,
        Searching(names, residuals(found), interrupts) as watch,
        workers(min(jobs, len(names))) as executor,
    ):
        verdict = select(
            rig.mechanism,
            found.measurement,
            laws,
            unknown=found.unknown,
            purpose=asked.how.purpose or "simulate",
            horizon=asked.how.horizon,
            route=found.route or asked.how.route,
            validate=found.validate,
            settings=asked.how.settings(rig),
            watch=watch,
            executor=executor,
        )
    assert isinstance(verdict, RecordVerdict)
    return verdict


def _page(verdict: RecordVerdict, rig: Rig, digest: str, asked: Asked) -> str:
    return record_page(
        verdict,
        title=rig.title or "Friction model selection",
        kicker=rig.subject,
        subject=Path(rig.path).name,
        digest=digest,
        files=of_files([*asked.data, *([asked.validate] if asked.validate else [])]),
        commands=[command_line()],
        versions=versions(),
    )


def _show(verdict: RecordVerdict) -> None:
    """Print the verdict, the scores, and the parameters of the law that is named."""
    words, console = verdict.words, stdout()
    show_warnings(verdict.checks)
    console.print(f"\n{plain(words.verdict)}", markup=False, style="bold")
    console.print(plain(words.lede), markup=False)
    console.print()
    second = any(candidate.second for candidate in verdict.candidates)
    unit = verdict.scale.unit
    heads = ["law", "free", f"held-out error, {unit}", f"last third, {unit}"]
    heads += [f"second record, {unit}"] if second else []
    rows = [_row(c, verdict, second=second) for c in verdict.candidates]
    show_table("", heads, rows, whole=heads)
    console.print()
    for one in verdict.candidates:
        console.print(f"  {one.name}: {plain(one.outcome)}", markup=False)
    for line in verdict.missing:
        console.print(f"  {line}", markup=False)
    if verdict.closest.fit:
        title = verdict.closest.title + ("" if verdict.best else ", closest but not recommended")
        console.print(f"\n{title}", markup=False, style="bold")
        show_estimates(verdict.closest.fit.estimates)
    show_trials(verdict.trials)
    show_open(words)


def _row(candidate: RecordCandidate, verdict: RecordVerdict, *, second: bool) -> list[str]:
    def told(value: float | None) -> str:
        known = value is not None and math.isfinite(value)
        return verdict.scale.number(float(value or 0.0)) if known else NONE

    seen = candidate.validation
    cells = [
        candidate.name,
        str(candidate.parameters) if candidate.fit else NONE,
        " ".join(score_text(verdict.scale, candidate.score, candidate.score_error)).strip()
        if candidate.fit
        else NONE,
        told(seen.extrapolation if seen else None),
    ]
    return cells + ([told(candidate.second.rms if candidate.second else None)] if second else [])
