"""``stickslip select`` for records in time and measured friction."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path

import typer

from stickslip.cli.interrupts import Interrupts
from stickslip.cli.measured import (
    Asked,
    Measured,
    residuals,
    show_estimates,
    show_open,
    show_warnings,
)
from stickslip.cli.output import (
    command_line,
    document,
    json_text,
    note,
    plain,
    print_json,
    show_table,
    stdout,
    write_folder,
)
from stickslip.cli.progress import Searching
from stickslip.cli.workers import workers
from stickslip.experiments import Rig
from stickslip.experiments.digests import of_files
from stickslip.friction import FrictionLaw
from stickslip.paper.pages import versions
from stickslip.report.records import record_page
from stickslip.selection import RecordCandidate, RecordVerdict, select
from stickslip.selection.record_words import error_text
from stickslip.selection.specifications import specifications

__all__ = ["NO_LAW", "laws_of", "select_on_records"]

NO_LAW = 3


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
    content = document("select", {"rig": rig.title, "digest": found.digest, **verdict.to_dict()})
    if as_json:
        print_json(content)
    else:
        sources = of_files([*asked.data, *([asked.validate] if asked.validate else [])])
        files = {**_page(verdict, rig, found.digest, sources), "verdict.json": json_text(content)}
        if verdict.best and verdict.best.fit:
            files["law.toml"] = verdict.best.fit.to_toml()
        write_folder(output, files)
        _show(verdict)
        stdout().print(f"\nReport: {output / 'index.html'}", markup=False)
    _say_what_was_ended(verdict)
    if verdict.best is None or verdict.best.dropped:
        note("No law is beyond objection; the verdict says why.")
        raise typer.Exit(NO_LAW)


def laws_of(
    rig: Rig, names: str | None
) -> Mapping[str, FrictionLaw] | Sequence[FrictionLaw | str] | None:
    """Return the laws to try: those of the rig, or those asked for; None for the usual ones."""
    if names is None:
        return rig.laws or None
    asked = dict.fromkeys(part.strip() for part in names.split(","))
    return [rig.laws.get(name) or name for name in asked]


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
        Searching(names, residuals(found, asked.how.way), interrupts) as watch,
        workers(min(jobs, len(names))) as executor,
    ):
        verdict = select(
            rig.mechanism,
            found.measurement,
            laws,
            unknown=found.unknown,
            purpose=asked.how.purpose or "simulate",
            horizon=asked.how.horizon,
            route=asked.how.route,
            validate=found.validate,
            settings=asked.how.settings(rig),
            watch=watch,
            executor=executor,
        )
    assert isinstance(verdict, RecordVerdict)
    return verdict


def _page(
    verdict: RecordVerdict, rig: Rig, digest: str, files: Mapping[str, str]
) -> dict[str, str | bytes]:
    """Return the report as a page."""
    note("Writing the report ...")
    page = record_page(
        verdict,
        title=rig.title or "Friction model selection",
        kicker=rig.subject,
        subject=Path(rig.path).name,
        digest=digest,
        files=files,
        commands=[command_line()],
        versions=versions(),
    )
    return {"index.html": page}


def _show(verdict: RecordVerdict) -> None:
    """Print the verdict, the scores, and the parameters of the law that is named."""
    words, console = verdict.words, stdout()
    show_warnings(verdict.checks)
    console.print(f"\n{plain(words.verdict)}", markup=False, style="bold")
    console.print(plain(words.lede), markup=False)
    console.print()
    second = any(candidate.second for candidate in verdict.candidates)
    heads = ["law", "free", "held-out error", "±", "last third"]
    heads += ["second record"] if second else []
    rows = [_row(c, verdict, second=second) for c in verdict.candidates]
    show_table("", heads, rows, whole=heads)
    console.print()
    for one in verdict.candidates:
        console.print(f"  {one.name}: {plain(one.outcome)}", markup=False)
    if verdict.best and verdict.best.fit:
        console.print(f"\n{verdict.best.title}", markup=False, style="bold")
        show_estimates(verdict.best.fit.estimates)
    show_open(words)


def _row(candidate: RecordCandidate, verdict: RecordVerdict, *, second: bool) -> list[str]:
    def told(value: float | None) -> str:
        known = value is not None and math.isfinite(value)
        turning = verdict.measurement.turning
        return error_text(float(value or 0.0), verdict.quantity, turning=turning) if known else ""

    seen = candidate.validation
    cells = [
        candidate.name,
        str(candidate.parameters) if candidate.fit else "",
        told(candidate.score),
        told(seen.error if seen else None),
        told(seen.extrapolation if seen else None),
    ]
    return cells + ([told(candidate.second.rms if candidate.second else None)] if second else [])


def _say_what_was_ended(verdict: RecordVerdict) -> None:
    """Say which law was not fitted to the end, if the search was ended early."""
    ended = [c.name for c in verdict.candidates if c.fit and c.fit.found.cancelled]
    if ended:
        note(f"Ended early: {', '.join(ended)} may do better than this.")
