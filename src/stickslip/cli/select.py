"""``stickslip select``."""

import contextlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

import typer

from stickslip.cli.console import (
    command_line,
    folder_of,
    note,
    overrides,
    plain,
    print_json,
    refuse_overwriting,
    show_table,
    stdout,
)
from stickslip.cli.inputs import (
    Ask,
    show_estimates,
    show_open,
    show_trials,
    show_warnings,
    watching,
)
from stickslip.cli.law_choice import rig_with
from stickslip.cli.pages import draw_page, leave_unless_drawn
from stickslip.cli.process_pool import workers
from stickslip.documents import document, of_files, with_files
from stickslip.errors import InputError
from stickslip.experiments import Rig
from stickslip.friction import FrictionLaw
from stickslip.kinds import (
    DOCUMENT,
    VERDICT_FILES,
    AnyKind,
    Request,
    kind_of_route,
    kinds,
    refuse_uninformed,
    refuse_unused,
    unused_text,
    verdict_page,
    write_verdict,
)
from stickslip.report import Origin, Page, render
from stickslip.selection import Verdict

if TYPE_CHECKING:
    from stickslip.kinds import TravelCandidate, TravelVerdict

BETWEEN = r",(?![^\[]*\])"
"""Commas between laws: those in brackets are of one law."""
NO_LAW = 3
"""Exit code where no law is recommended."""
CRITERIA_FAILED = 4


def run(
    path: Path | None,
    ask: Ask,
    changes: Sequence[str],
    laws: str | None,
    output: Path | None,
    *,
    count: int | None,
    executor: str | None,
    allow_import: bool,
    force: bool,
    as_json: bool,
    enforce: bool,
) -> None:
    """Select, write the verdict, print it, draw its page; with JSON only into a given folder."""
    folder = folder_of(output, "stickslip-report", as_json=as_json)
    if folder is not None:
        refuse_overwriting(folder, folder, force=force, files=VERDICT_FILES)
    rig = rig_with(path, overrides(changes), allow_import=allow_import)
    kind, request, files = ask(rig, given=path is not None)
    rig = replace(rig, digest=with_files(rig.digest, files))
    for option, value in (("--workers", count), ("--executor", executor)):
        if value is not None:
            refuse_unused(kind, {"executor": option}, request)
    if enforce and not kind.has_criteria:
        users = [one for one in kinds() if one.has_criteria]
        raise InputError(f"--enforce {unused_text(kind, users)}")
    verdict = _selected(kind, replace(request, laws=laws_of(rig, laws)), count or 1, executor)
    content = document("select", {"rig": rig.heading, "digest": rig.digest, **verdict.to_dict()})
    page_code = 0
    # an earlier report stays until all of this is there
    if folder is not None and not (folder / DOCUMENT).exists():
        write_verdict(folder, verdict, content)
    with contextlib.suppress(BrokenPipeError):  # the report is written for a later reader
        if as_json:
            print_json(content)
        else:
            show_verdict(verdict)
    if folder is not None:
        own = path is None  # the bundled rig
        page_code = draw_page(
            folder,
            lambda: render(_page(verdict, rig, files, of_paper=own)),
            lambda text: write_verdict(folder, verdict, content, page=text),
            kept=f"The verdict is in {folder / DOCUMENT}.",
            quiet=as_json,
        )
    ended = [c.name for c in verdict.candidates if c.fit and c.fit.cancelled]
    if ended:
        note(f"Searches that were stopped early may not have converged: {', '.join(ended)}.")
    if verdict.best is None or verdict.best.dropped:
        note("No law is recommended; the verdict states the reason.")
        raise typer.Exit(NO_LAW)
    if enforce and not _criteria_hold(cast("TravelCandidate | None", verdict.best)):
        note("The recommended law fails a criterion of the paper; the report names the criterion.")
        raise typer.Exit(CRITERIA_FAILED)
    leave_unless_drawn(page_code)


def laws_of(
    rig: Rig, names: str | None
) -> Mapping[str, FrictionLaw] | Sequence[FrictionLaw | str] | None:
    """Return the laws to try: those of the rig, or those asked for; None for the usual ones."""
    if names is None:
        return rig.laws or None
    asked = dict.fromkeys(part.strip() for part in re.split(BETWEEN, names))
    if "" in asked:
        raise InputError(
            f"--laws takes names of laws with commas between them, such as coulomb,viscous, got"
            f" {names!r}."
        )
    return [rig.laws.get(name) or name for name in map(rig.name_of, asked)]


def _selected(kind: AnyKind, request: Request, count: int, address: str | None) -> Verdict:
    """Select with bars; of records, Ctrl-C once ends the search with what there is."""
    laws = request.laws
    for measurement in (request.measurement, request.validate):
        if measurement is not None:
            given = laws.values() if isinstance(laws, Mapping) else laws or ()
            refuse_uninformed(kind, given, request.mechanism, measurement)
    names = kind.candidates(laws, request.measurement)
    with (
        watching(names, kind, request) as watch,
        workers(min(count, len(names)), address) as executor,
    ):
        verdict: Verdict = kind.select(replace(request, progress=watch, executor=executor))
        return verdict


def show_verdict(verdict: Verdict) -> None:
    """Print the verdict, the comparison, the parameters of the law that is named, what is open."""
    words, console = verdict.words, stdout()
    table = kind_of_route(verdict.route).comparison(verdict)
    if table.checks:
        show_warnings(table.checks)
    console.print(f"\n{plain(words.verdict)}", markup=False, style="bold")
    console.print(plain(words.lede), markup=False)
    if words.no_score:
        console.print(words.no_score, markup=False, style="dim")
    console.print()
    rows = [[plain(cell) for cell in row] for row in table.rows]
    show_table("", table.heads, rows, whole=table.heads if table.fitted else ())
    if table.notes:
        console.print()
    for line in table.notes:
        console.print(f"  {plain(line)}", markup=False)
    if table.fitted:
        title, estimates = table.fitted
        console.print(f"\n{title}", markup=False, style="bold")
        show_estimates(estimates)
    show_trials(table.trials)
    show_open(words)


def _page(verdict: Verdict, rig: Rig, files: Sequence[Path], *, of_paper: bool) -> Page:
    """Return the page of a verdict; of the bundled rig it says too where its paper errs."""
    origin = Origin(
        title=rig.heading,
        data=rig.subject,
        file=Path(rig.path).name,
        digest=rig.digest,
        files=of_files(files),
        commands=(command_line(),),
    )
    if of_paper:
        from stickslip.paper import beside

        own = cast("TravelVerdict", verdict)  # the bundled rig has travels
        remark, lead, extra = beside(rig, own)
        return verdict_page(verdict, origin, remark=remark, lead=lead, extra=extra)
    return verdict_page(verdict, origin)


def _criteria_hold(best: "TravelCandidate | None") -> bool:
    seen = best.criteria if best else None
    return bool(seen and seen.velocity_never_negative and seen.displacement_never_decreases)
