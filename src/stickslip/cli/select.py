"""``stickslip select``."""

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import typer

from stickslip.cli.console import (
    command_line,
    document,
    note,
    overrides,
    print_json,
    refuse_overwriting,
)
from stickslip.cli.inputs import Asked, Measured, measured, residuals
from stickslip.cli.interrupts import Interrupts
from stickslip.cli.pages import draw_page, leave_unless_drawn
from stickslip.cli.process_pool import workers
from stickslip.cli.progress import Searching, Watching
from stickslip.cli.verdict_tables import AnyVerdict, show_verdict
from stickslip.errors import InputError
from stickslip.experiments import Rig, load_rig
from stickslip.experiments.hashing import of_files
from stickslip.friction import FrictionLaw
from stickslip.report import Page, render
from stickslip.report.core.documents import Origin
from stickslip.report.verdict_page import verdict_page
from stickslip.report.writing import DOCUMENT, write_verdict
from stickslip.selection import Candidate, TravelVerdict, candidate_names, select

__all__ = ["NO_LAW", "laws_of", "run"]

NO_LAW = 3
"""Exit code where no law is recommended."""
CRITERIA_FAILED = 4


def run(
    path: Path | None,
    asked: Asked,
    changes: Sequence[str],
    laws: str | None,
    output: Path,
    *,
    jobs: int | None,
    allow_import: bool,
    force: bool,
    as_json: bool,
    enforce: bool,
) -> None:
    """Select, write the verdict, print it, draw its page; as JSON print only the verdict."""
    if not as_json:
        refuse_overwriting(output, output, force=force)
    rig = load_rig(path, overrides=overrides(changes), allow_import=allow_import)
    found = measured(rig, asked, given=path is not None)
    if found.travels and jobs is not None:
        raise InputError("--jobs is for records; travels are fitted one after the other.")
    if enforce and not found.travels:
        raise InputError("--enforce is for travels: the criteria of the paper judge these.")
    verdict = _selected(rig, found, asked, laws_of(rig, laws), jobs or 1)
    content = document("select", {"rig": rig.title, "digest": found.digest, **verdict.to_dict()})
    page_code = 0
    if as_json:
        print_json(content)
    else:
        write_verdict(output, verdict, content)
        show_verdict(verdict)
        kept = f"The verdict is in {output / DOCUMENT}."
        own = path is None  # the bundled rig
        page_code = draw_page(
            output, lambda: render(_page(verdict, rig, found, asked, of_paper=own)), kept=kept
        )
    ended = [c.name for c in verdict.candidates if c.fit and c.fit.cancelled]
    if ended:
        note(f"Searches that were ended early may not have converged: {', '.join(ended)}.")
    if verdict.best is None or getattr(verdict.best, "dropped", False):
        note("No law is recommended; the verdict gives the reason.")
        raise typer.Exit(NO_LAW)
    if enforce and isinstance(verdict, TravelVerdict) and not _criteria_hold(verdict.best):
        note("A criterion of the paper fails for the law that is named; the report says which.")
        raise typer.Exit(CRITERIA_FAILED)
    leave_unless_drawn(page_code)


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
) -> AnyVerdict:
    """Select with bars; of records, Ctrl-C once ends the search with what there is."""
    names = candidate_names(found.measurement, laws)
    with ExitStack() as stack:
        watch: Watching | Searching
        if found.travels:
            watch = stack.enter_context(Watching(names, "Fitting"))
        else:
            interrupts = stack.enter_context(Interrupts())
            watch = stack.enter_context(Searching(names, residuals(found), interrupts))
        return select(
            rig.mechanism,
            laws,
            found.measurement,
            vary=found.vary,
            fixed=found.fixed,
            assumed=rig.assumed,
            purpose=asked.how.purpose or "simulate",
            horizon=asked.how.horizon,
            route=found.route or asked.how.route,
            validate=found.validate,
            settings=None if found.travels else asked.how.settings(rig),
            t_end=rig.t_end,
            progress=watch,
            executor=stack.enter_context(workers(min(jobs, len(names)))),
        )


def _page(verdict: AnyVerdict, rig: Rig, found: Measured, asked: Asked, *, of_paper: bool) -> Page:
    """Return the page of a verdict; of the bundled rig it says too where its paper errs."""
    origin = Origin(
        title=rig.title or verdict.mechanism.name.replace("-", " ").capitalize(),
        data=rig.subject,
        file=Path(rig.path).name,
        digest=found.digest,
        files=of_files([*asked.data, *([asked.validate] if asked.validate else [])]),
        commands=(command_line(),),
    )
    if of_paper and isinstance(verdict, TravelVerdict):
        from stickslip.paper import beside

        remark, lead, extra = beside(replace(rig, digest=found.digest), verdict)
        return verdict_page(verdict, origin, remark=remark, lead=lead, extra=extra)
    return verdict_page(verdict, origin)


def _criteria_hold(best: Candidate | None) -> bool:
    seen = best.criteria if best else None
    return bool(seen and seen.velocity_never_negative and seen.displacement_never_decreases)
