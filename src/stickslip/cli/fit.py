"""``stickslip fit``."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

from stickslip.cli.console import (
    check_rig_file,
    note,
    overrides,
    plain,
    print_json,
    refuse_inputs,
    refuse_overwriting,
    show_table,
    stdout,
)
from stickslip.cli.inputs import (
    Ask,
    content_of,
    show_estimates,
    show_trials,
    show_warnings,
    watching,
)
from stickslip.cli.law_choice import law_to_fit, rig_with
from stickslip.documents import document, with_files, write_file
from stickslip.errors import InputError
from stickslip.experiments import Checks, check, refusal, refuse_same
from stickslip.identification import Fit, far_above_dry
from stickslip.kinds import AnyKind, FitSummary, Law, Request, kind_of, refuse_uninformed


def run(
    path: Path | None,
    name: str | None,
    ask: Ask,
    changes: Sequence[str],
    output: Path | None,
    *,
    allow_import: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Fit, write the rig file of the fitted law, print its parameters."""
    if output is not None:
        check_rig_file(output)
        refuse_overwriting(output, output.parent, force=force)
    rig = rig_with(path, overrides(changes), law=name, allow_import=allow_import)
    if output is not None:
        refuse_inputs(output, [rig.path, *rig.files])
    law = partial(law_to_fit, rig, name)
    kind, request, files = ask(rig, given=path is not None, law=law)
    if output is not None and not kind.simulated:
        raise InputError(
            f"--output writes a law that `simulate` can run; laws of {kind.measured} are not"
            " simulated: use --json."
        )
    checks = _checked(request)
    result = _fitted(kind, request)
    shown = kind.summary(result, request.validate, request.horizon)
    if output is not None:
        write_file(output, result.to_toml())
    if as_json:
        content = {
            "rig": rig.heading,
            "digest": with_files(rig.digest, files),
            **result.to_dict(),
            "checks": checks.to_dict(),
            "second_record": shown.second,
            **content_of(shown.trials),
        }
        print_json(document("fit", content))
        return
    show_warnings(checks)
    _show(result, shown)
    show_trials(shown.trials)
    if output is not None:
        stdout().print(f"\nRig file of the fitted law: {output}", markup=False)


def _checked(request: Request) -> Checks:
    """Return what is to be said of the measurement; refuse what no fit should be made from."""
    if request.horizon is not None and request.validate is None:
        raise InputError(
            "--horizon is the prediction length on a second record: give --validate FILE too, or"
            " leave it out."
        )
    conditions = kind_of(request.measurement).conditions
    checks = check(
        request.measurement,
        mechanism=request.mechanism,
        vary=request.vary or (),
        conditions=conditions,
    )
    if checks.worst == "error":
        raise refusal([one for one in checks.findings if one.severity == "error"])
    if request.validate is not None:
        refuse_same(request.measurement, request.validate)
    return checks


def _fitted(kind: AnyKind, request: Request) -> Fit:
    """Fit with a bar; of records, Ctrl-C once ends the search."""
    law: Law = request.law
    name = _name(law)
    several = isinstance(law, Mapping)
    laws = [one for one in law.values() if one is not None] if several else [law]
    refuse_uninformed(kind, laws, request.mechanism, request.measurement)
    law, vary = kind.law_and_parameters(law, request.vary, request.fixed or ())
    with watching([name], kind, request) as watch:
        report = partial(watch, name)
        if not kind.counts_runs:
            report(math.nan)  # what is compiled first takes longer than the first look
        fitted: Fit = kind.fit(replace(request, law=law, vary=vary, progress=report))
        return fitted


def _name(law: Law) -> str:
    """Return the name of a law, or of those of the contacts."""
    if isinstance(law, Mapping):
        names = {contact: _name(one) for contact, one in law.items() if one is not None}
        return ", ".join(f"{contact}={one}" for contact, one in names.items())
    return law if isinstance(law, str) else law.name


def _show(result: Fit, shown: FitSummary) -> None:
    console = stdout()
    console.print(f"\n{result.law.title} friction", markup=False, style="bold")
    show_estimates(result.shown)
    for line in shown.limits:
        console.print(f"  {plain(line)}", markup=False)
    console.print()
    for line in far_above_dry(result):
        console.print(f"! {plain(line)}\n", markup=False, style="yellow")
    if shown.rows:
        show_table("", shown.heads, [[plain(cell) for cell in row] for row in shown.rows])
    for line in shown.lines:
        console.print(plain(line), markup=False)
    if result.cancelled:
        note("The search was stopped early; this is the best fit so far.")
    for line in shown.findings:
        console.print(f"\n{plain(line)}", markup=False)
    heading, lines = shown.open
    if lines:
        console.print(f"\n{heading}", markup=False, style="bold")
    for line in lines:
        console.print(f"  {plain(line)}", markup=False)
