"""``stickslip select``, ``stickslip fit`` and ``stickslip plan``."""

import math
import re
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, cast

import typer

from stickslip.cli import console as terminal
from stickslip.cli import inputs
from stickslip.cli.options import (
    DEMO,
    DemoOptions,
    FitOptions,
    MeasuredOptions,
    PlanOptions,
    SelectOptions,
)
from stickslip.data import Checks, Rig, as_tolerance, check, refusal, refuse_same
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify import Verdict, kinds
from stickslip.identify.fits import Fit, far_above_dry
from stickslip.show import documents
from stickslip.show.formatting import in_words, number
from stickslip.show.report import Origin, Page, render

if TYPE_CHECKING:
    from stickslip.identify.kinds import TravelCandidate, TravelVerdict


# ``stickslip select``.

BETWEEN = r",(?![^\[]*\])"
"""Commas between laws: those in brackets are of one law."""
NO_LAW = 3
"""Exit code where no law is recommended."""
CRITERIA_FAILED = 4


def run_select(options: SelectOptions) -> None:
    """Select, write the verdict, print it, draw its page; with JSON only into a given folder."""
    default = f"{(options.rig or DEMO).stem}-report"
    folder = terminal.folder_of(options.output, default, as_json=options.as_json)
    if folder is not None:
        terminal.refuse_overwriting(folder, folder, force=options.force, files=kinds.VERDICT_FILES)
    rig = inputs.rig_with(options, terminal.overrides(options.changes))
    if folder is not None:
        for name in kinds.VERDICT_FILES:
            terminal.refuse_inputs(folder / name, [rig.path])
    kind, request, files = inputs.measured(rig, options)
    request = replace(request, tolerance=_tolerance(kind, rig, options.tolerance))
    rig = replace(rig, digest=documents.with_files(rig.digest, files))
    if options.enforce and not kind.has_criteria:
        users = [family for family in kinds.kinds() if family.has_criteria]
        raise InputError(f"--enforce {kinds.unused_text(kind, users)}")
    request = replace(request, laws=laws_of(rig, options.laws))
    verdict = _selected(kind, request)
    content = documents.document(
        "select", {"rig": rig.heading, "digest": rig.digest, **verdict.to_dict()}
    )
    page_code = 0
    # an earlier report stays until all of this is there
    if folder is not None and not (folder / kinds.DOCUMENT).exists():
        kinds.write_verdict(folder, verdict, content)
    if options.as_json:
        terminal.print_json(content)
    else:
        if said := _of_one_travel(verdict):
            terminal.stdout().print(said)
        show_verdict(verdict)
    if folder is not None:
        own = options.rig is None  # the bundled rig
        page_code = terminal.draw_page(
            folder,
            lambda: render(_page(verdict, rig, files, of_paper=own)),
            lambda text: kinds.write_verdict(folder, verdict, content, page=text),
            kept=f"The verdict is in {folder / kinds.DOCUMENT}.",
            quiet=options.as_json,
        )
    ended = [c.name for c in verdict.candidates if c.fit and c.fit.cancelled]
    if ended:
        terminal.note(
            f"Searches that were stopped early may not have converged: {', '.join(ended)}."
        )
    if verdict.best is None or verdict.best.dropped:
        terminal.note("No law is recommended; the verdict states the reason.")
        raise typer.Exit(NO_LAW)
    if options.enforce and not _criteria_hold(cast("TravelCandidate | None", verdict.best)):
        terminal.note(
            "The recommended law fails a criterion of the paper; the report names the criterion."
        )
        raise typer.Exit(CRITERIA_FAILED)
    terminal.leave_unless_drawn(page_code)


def _of_one_travel(verdict: Verdict) -> str:
    """Return what a single travel cannot show, and what can; empty of other measurements."""
    single = "travel" in verdict.measurement.quantities() and not verdict.measurement.trials
    if not single or verdict.ranked or len(verdict.candidates) < 2:
        return ""
    return (
        f"One travel cannot rank {in_words(len(verdict.candidates))} laws; travels at several"
        " settings can."
    )


def run_demo(options: DemoOptions) -> None:
    """Select a law for the bundled rig."""
    run_select(SelectOptions(**vars(options)))


def _tolerance(kind: kinds.AnyKind, rig: Rig, text: str | None) -> float | None:
    """Return the share of friction by which a law may be off, of a kind that has it."""
    called = "--tolerance" if text is not None else f"tolerance in [data] of {rig.path}"
    given = rig.tolerance if text is None else as_tolerance(text, called)
    if given is not None and "tolerance" not in kind.uses:
        users = [item for item in kinds.kinds() if "tolerance" in item.uses]
        raise InputError(f"{called} {kinds.unused_text(kind, users)}")
    return given


def laws_of(
    rig: Rig, names: str | None
) -> Mapping[str, FrictionLaw] | Sequence[FrictionLaw | str] | None:
    """Return the laws to try: those of the rig, or those asked for; None for the usual ones."""
    if names is None:
        return rig.laws or None
    wanted = dict.fromkeys(part.strip() for part in re.split(BETWEEN, names))
    if "" in wanted:
        raise InputError(
            f"--laws takes names of laws with commas between them, such as coulomb,viscous, got"
            f" {names!r}."
        )
    return [rig.laws.get(name) or name for name in map(rig.name_of, wanted)]


def _selected(kind: kinds.AnyKind, request: kinds.Request) -> Verdict:
    """Select with bars; of records, Ctrl-C once ends the search with what there is."""
    laws = request.laws
    for measurement in (request.measurement, request.validate):
        if measurement is not None:
            given = laws.values() if isinstance(laws, Mapping) else laws or ()
            kinds.refuse_uninformed(kind, given, request.mechanism, measurement)
    names = kind.candidates(laws, request.measurement)
    with inputs.watching(names, kind, request) as watch:
        verdict: Verdict = kind.select(replace(request, progress=watch))
        return verdict


def show_verdict(verdict: Verdict) -> None:
    """Print the verdict, the comparison, the parameters of the law that is named, what is open."""
    words, console = verdict.words, terminal.stdout()
    table = kinds.kind_of_route(verdict.route).comparison(verdict)
    if table.checks:
        inputs.show_warnings(table.checks)
    console.print(f"\n{terminal.plain(words.verdict)}", style="bold")
    console.print(terminal.plain(words.lede))
    if words.no_score:
        console.print(words.no_score, style="dim")
    console.print()
    rows = [[terminal.plain(cell) for cell in row] for row in table.rows]
    terminal.show_table("", table.heads, rows, whole=table.heads if table.fitted else ())
    if table.notes:
        console.print()
    for line in table.notes:
        console.print(f"  {terminal.plain(line)}")
    if table.fitted:
        title, estimates = table.fitted
        console.print(f"\n{title}", style="bold")
        inputs.show_estimates(estimates)
    inputs.show_open(words)


def _page(verdict: Verdict, rig: Rig, files: Sequence[Path], *, of_paper: bool) -> Page:
    """Return the page of a verdict; of the bundled rig it says too where its paper errs."""
    origin = Origin(
        title=rig.heading,
        data=rig.subject,
        file=Path(rig.path).name,
        digest=rig.digest,
        files=documents.of_files(files),
        commands=(terminal.command_line(),),
    )
    if of_paper:
        from stickslip.paper import beside

        own = cast("TravelVerdict", verdict)  # the bundled rig has travels
        remark, lead, extra = beside(rig, own)
        remark = " ".join(filter(None, (_of_one_travel(verdict), remark)))
        return kinds.verdict_page(verdict, origin, remark=remark, lead=lead, extra=extra)
    return kinds.verdict_page(verdict, origin)


def _criteria_hold(best: "TravelCandidate | None") -> bool:
    seen = best.criteria if best else None
    return bool(seen and seen.velocity_never_negative and seen.displacement_never_decreases)


# ``stickslip fit``.


def run_fit(options: FitOptions) -> None:
    """Fit, write the rig file of the fitted law, print its parameters."""
    output = options.output
    if output is not None:
        terminal.check_rig_file(output)
        terminal.refuse_overwriting(output, output.parent, force=options.force)
    rig = inputs.rig_with(options, terminal.overrides(options.changes), law=options.law)
    if output is not None:
        terminal.refuse_inputs(output, [rig.path, *rig.files])
    kind, request, files = inputs.measured(
        rig, options, law=partial(inputs.law_to_fit, rig, options.law)
    )
    if output is not None and not kind.simulated:
        raise InputError(
            f"--output writes a law that `simulate` can run; laws of {kind.measured} are not"
            " simulated: use --json."
        )
    checks = _checked(request)
    result = _fitted(kind, request)
    shown = kind.summary(result, request.validate)
    if output is not None:
        documents.write_file(output, result.to_toml())
    if options.as_json:
        content = {
            "rig": rig.heading,
            "digest": documents.with_files(rig.digest, files),
            **result.to_dict(),
            "checks": checks.to_dict(),
            "second_record": shown.second,
        }
        terminal.print_json(documents.document("fit", content))
        return
    inputs.show_warnings(checks)
    _show_fit(result, shown)
    if output is not None:
        terminal.stdout().print(f"\nRig file of the fitted law: {output}")


def _checked(request: kinds.Request) -> Checks:
    """Return what is to be said of the measurement; refuse what no fit should be made from."""
    conditions = kinds.kind_of(request.measurement).conditions
    checks = check(
        request.measurement,
        mechanism=request.mechanism,
        vary=request.vary or (),
        conditions=conditions,
    )
    if checks.worst == "error":
        raise refusal([finding for finding in checks.findings if finding.severity == "error"])
    if request.validate is not None:
        refuse_same(request.measurement, request.validate)
    return checks


def _fitted(kind: kinds.AnyKind, request: kinds.Request) -> Fit:
    """Fit with a bar; of records, Ctrl-C once ends the search."""
    law: kinds.Law = request.law
    name = _name(law)
    several = isinstance(law, Mapping)
    laws = [friction for friction in law.values() if friction is not None] if several else [law]
    kinds.refuse_uninformed(kind, laws, request.mechanism, request.measurement)
    law, vary = kind.law_and_parameters(law, request.vary, request.fixed or ())
    with inputs.watching([name], kind, request) as watch:
        report = partial(watch, name)
        if not kind.counts_runs:
            report(math.nan)  # what is compiled first takes longer than the first look
        fitted: Fit = kind.fit(replace(request, law=law, vary=vary, progress=report))
        return fitted


def _name(law: kinds.Law) -> str:
    """Return the name of a law, or of those of the contacts."""
    if isinstance(law, Mapping):
        names = {contact: _name(fitted) for contact, fitted in law.items() if fitted is not None}
        return ", ".join(f"{contact}={name}" for contact, name in names.items())
    return law if isinstance(law, str) else law.name


def _show_fit(result: Fit, shown: kinds.FitSummary) -> None:
    console = terminal.stdout()
    console.print(f"\n{result.law.title} friction", style="bold")
    inputs.show_estimates(result.shown)
    for line in shown.limits:
        console.print(f"  {terminal.plain(line)}")
    console.print()
    for line in far_above_dry(result):
        console.print(f"! {terminal.plain(line)}\n", style="yellow")
    if shown.rows:
        terminal.show_table(
            "", shown.heads, [[terminal.plain(cell) for cell in row] for row in shown.rows]
        )
    for line in shown.lines:
        console.print(terminal.plain(line))
    if result.cancelled:
        terminal.note("The search was stopped early; this is the best fit so far.")
    for line in shown.findings:
        console.print(f"\n{terminal.plain(line)}")
    heading, lines = shown.open
    if lines:
        console.print(f"\n{heading}", style="bold")
    for line in lines:
        console.print(f"  {terminal.plain(line)}")


# ``stickslip plan``.


def run_plan(options: PlanOptions) -> None:
    """Plan, write the table to fill in, show."""
    rig = inputs.rig_with(options, terminal.overrides(options.changes))
    if rig.measurement is None and not options.data:
        raise InputError(kinds.UNMEASURED)
    names = [item.name for item in fields(MeasuredOptions) if hasattr(options, item.name)]
    given = MeasuredOptions(**{name: getattr(options, name) for name in names})
    kind, request, _ = inputs.measured(rig, given)
    request = replace(request, laws=laws_of(rig, options.laws))
    output = options.output
    if output is not None:
        if output.suffix.lower() != ".csv":
            raise InputError(f"the table to fill in is written as a .csv file, got {output}.")
        if kind.content != "tables":
            raise InputError(
                f"-o writes readings to make beside a table of friction, not beside"
                f" {kind.measured}: leave it out."
            )
        terminal.refuse_overwriting(output, output.parent, force=options.force)
        terminal.refuse_inputs(output, [rig.path, *rig.files, *options.data])
    result = kinds.plan_of(_selected(kind, request), options.readings)
    text = result.csv(rig.reading.with_changes(terminal.reading_of(options)))
    files = [output] if output is not None and text else []  # there may be nothing worth reading
    if output is not None and text:
        code = getattr(rig.reading.layout, "encoding", "utf-8")
        _refuse_loss(output, text, code)
        documents.write_files({output: text.encode(code)})
    if options.as_json:
        content = {"rig": rig.heading, "digest": rig.digest, **result.to_dict()}
        terminal.print_json(documents.document("plan", content | {"files": [*map(str, files)]}))
        return
    _show_plan(result)
    if output is not None:
        said = f"Written: {output}, to fill in." if files else f"{output} is not written."
        terminal.stdout().print(f"\n{said}")


def _refuse_loss(table: Path, text: str, code: str) -> None:
    """Refuse to replace what is no table to fill in, or has a filled-in row that is not in the new.

    Columns to fill in are those that are empty in the last row of the new text.
    """
    if not table.exists():
        return
    try:
        lines = documents.regular_bytes(table).decode(code, "replace").splitlines()
    except OSError as error:
        raise InputError(f"{table} cannot be read: {error.strerror or error}.") from None
    rows = text.splitlines()
    between = next((mark for mark in "\t;," if mark in rows[-1]), ",")
    empty = [k for k, cell in enumerate(rows[-1].split(between)) if not cell]
    filled = [x for x in lines if any(x.split(between)[k : k + 1] != [""] for k in empty)]
    if lines[:1] != rows[:1] or Counter(filled) - Counter(rows):
        raise InputError(f"{table} has rows that the new table lacks: move it, or give another -o.")


def _show_plan(plan: kinds.Plan) -> None:
    console = terminal.stdout()
    for line in plan.lines or [plan.sentence]:
        console.print(f"\n{terminal.plain(line)}")
    if len(rows := plan.to_dataframe()):
        console.print()
        cells = [[number(x, 6) for x in row] for row in rows.itertuples(index=False)]
        terminal.show_table("", [*rows], cells)
