"""``stickslip fit``."""

import math
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from stickslip.cli.console import (
    document,
    note,
    overrides,
    plain,
    print_json,
    refuse_overwriting,
    show_table,
    stdout,
    write_file,
)
from stickslip.cli.inputs import (
    Asked,
    Measured,
    measured,
    residuals,
    show_estimates,
    show_warnings,
)
from stickslip.cli.interrupts import Interrupts
from stickslip.cli.law_choice import fitted_name
from stickslip.cli.progress import Searching, Watching
from stickslip.cli.trials import content_of, show_trials
from stickslip.errors import InputError
from stickslip.experiments import Checks, Rig, check, load_rig
from stickslip.experiments.preconditions import told
from stickslip.experiments.second_records import refuse_same
from stickslip.formatting import quantity, signed_percent
from stickslip.friction import FrictionLaw, specification
from stickslip.identification import FeatureFit, Fit, RecordFit, Score, TravelFit, fit
from stickslip.identification.features.features import COMPARED
from stickslip.identification.results import far_above_dry
from stickslip.identification.travels.model import quantities_read
from stickslip.identification.trials.comparison import compared
from stickslip.selection.identifiable import limit_of
from stickslip.selection.record_wording import error_text, route_text

__all__ = ["run"]

UNITS = {"frequency": "Hz"}
"""Of features that have one."""


def run(
    path: Path | None,
    name: str | None,
    asked: Asked,
    changes: Sequence[str],
    output: Path | None,
    *,
    allow_import: bool,
    force: bool,
    as_json: bool,
) -> None:
    """Fit, write the rig file of the fitted law, print its parameters."""
    if output is not None:
        if output.suffix != ".toml":
            raise InputError(f"--output takes a .toml file, got {output}.")
        refuse_overwriting(output, output.parent, force=force)
    rig = load_rig(path, overrides=overrides(changes), allow_import=allow_import)
    name = fitted_name(rig, name)
    law = rig.laws.get(name) or name
    kind = specification(law).law if isinstance(law, str) else law
    found = measured(rig, asked, given=path is not None, law=kind)
    checks = _checked(rig, found, asked)
    result = _fitted(rig, law, found, asked)
    second = _second(result, found, asked)
    trials = compared(result) if isinstance(result, RecordFit) else None
    if output is not None:
        write_file(output, result.to_toml().encode())
    if as_json:
        content = _content(rig, found, result, checks, second)
        print_json(document("fit", {**content, **content_of(trials)}))
        return
    show_warnings(checks)
    _show(result, second)
    show_trials(trials)
    if output is not None:
        stdout().print(f"\nRig file of the fitted law: {output}", markup=False)


def _checked(rig: Rig, found: Measured, asked: Asked) -> Checks:
    """Return what is to be said of the measurement; refuse what no fit should be made from."""
    if asked.how.horizon is not None and not found.travels and found.validate is None:
        raise InputError(
            "--horizon is the length of predicted stretches of a second record: give --validate"
            " FILE too, or leave it out."
        )
    checks = check(found.measurement, mechanism=rig.mechanism)
    if checks.worst == "error":
        wrong = told([one for one in checks.findings if one.severity == "error"])
        raise InputError(f"No fit should be made from this record. {wrong}")
    if found.validate is not None:
        refuse_same(found.measurement, found.validate)
    return checks


def _fitted(
    rig: Rig,
    law: FrictionLaw | str,
    found: Measured,
    asked: Asked,
) -> Fit:
    """Fit with a bar; Ctrl-C once ends the search in a record."""
    name = law if isinstance(law, str) else law.name
    if found.travels:
        with Watching([name], "Fitting") as bar:
            return fit(
                rig.mechanism,
                law,
                found.measurement,
                vary=found.vary,
                fixed=found.fixed,
                t_end=rig.t_end,
                progress=lambda runs: bar(name, runs),
            )
    with (
        Interrupts() as interrupts,
        Searching([name], residuals(found), interrupts) as watch,
    ):
        watch(name, math.nan)  # what is compiled first takes longer than the first look
        return fit(
            rig.mechanism,
            law,
            found.measurement,
            vary=found.vary,
            fixed=found.fixed,
            route=found.route or asked.how.route,
            settings=asked.how.settings(rig),
            progress=lambda rms: watch(name, rms),
        )


def _second(result: Fit, found: Measured, asked: Asked) -> Score | Mapping[str, float] | None:
    """Return the error on a record that the fit did not see; of features those of each."""
    if isinstance(result, FeatureFit):
        return None if found.validate is None else result.judged(found.validate)
    if not isinstance(result, RecordFit):
        if found.validate is not None:
            raise InputError("travels take no second record: give more trials instead.")
        return None
    if found.validate is None:
        return None
    return result.score(found.validate, horizon=asked.how.horizon)


def _content(
    rig: Rig,
    found: Measured,
    result: Fit,
    checks: Checks,
    second: Score | Mapping[str, float] | None,
) -> Mapping[str, Any]:
    return {
        "rig": rig.title,
        "digest": found.digest,
        **result.to_dict(),
        "checks": checks.to_dict(),
        "second_record": second.rms if isinstance(second, Score) else second,
    }


def _show(result: Fit, second: Score | Mapping[str, float] | None) -> None:
    console = stdout()
    console.print(f"\n{result.law.title} friction", markup=False, style="bold")
    show_estimates(result.estimates)
    _show_limits(result)
    console.print()
    for line in far_above_dry(result):
        console.print(f"! {plain(line)}\n", markup=False, style="yellow")
    if isinstance(result, TravelFit):
        rows, read = [], quantities_read(result.trials)
        for trial, *pair in zip(result.trials, result.measured, result.predicted, strict=True):
            rows.append([plain(quantity(travel, "m")) for travel in pair])
            rows[-1] += [plain(trial.as_read(travel)) for travel in pair] if read else []
        heads = ["measured travel", "predicted"]
        show_table("", [*heads, f"measured {read}", "predicted"] if read else heads, rows)
        return
    if isinstance(result, FeatureFit):
        assert not isinstance(second, Score)
        _show_features(result, second or {})
        return
    assert isinstance(result, RecordFit)
    assert not isinstance(second, Mapping)
    scored, found = result.problem.quantity, result.found
    said = partial(error_text, quantity=scored, turning=result.measurement.turning)
    console.print(f"Residual of {scored}: {said(result.rms)}", markup=False)
    if second is not None:
        console.print(
            f"On the second record: {said(second.rms)}, {_predicted(result, second)}", markup=False
        )
    console.print(f"Restarts: {_restarts(result)}", markup=False)
    for remark in (*result.remarks, route_text(result)):
        if remark:
            console.print(remark, markup=False)
    if found.cancelled:
        note("The search was ended early; this is the best so far.")
    for error in result.model_errors:
        console.print(f"\nError of the model: {error}", markup=False)
    if result.sentences:
        console.print("\nCannot tell", markup=False, style="bold")
    for line in result.sentences:
        console.print(f"  {plain(line)}", markup=False)


def _show_limits(result: Fit) -> None:
    """Print what limits each interval, the readings or the rig; features tell neither apart."""
    for one in result.estimates:
        if isinstance(result, TravelFit | RecordFit) and (limit := limit_of(result, one)):
            stdout().print(f"  {one.path}:{plain(limit)}", markup=False)


def _predicted(result: RecordFit, second: Score) -> str:
    """Return how a second record was predicted: where friction is, bristles run through it."""
    if result.route == "shooting":
        return f"over {quantity(second.horizon, 's')} at a time"
    return "along the measured motion"


def _restarts(result: RecordFit) -> str:
    """Return how many starts agree; a free decay is fitted in longer segments after that."""
    starts = len(result.restarts.costs)
    if starts == 1:
        return "none, a single start"
    text = f"{result.restarts.agreeing} of {starts} starts end at the least residual"
    if result.first is None:
        return text
    return f"{text} in short segments; longer ones of the free decay were fitted from there"


def _show_features(fit: FeatureFit, second: Mapping[str, float]) -> None:
    """Print what the features of a fit are, and what it says."""
    console = stdout()
    heads = ["feature of F/N", "first half", "fitted", "second half", "off by"]
    heads += ["second record off by"] if second else []
    rows = []
    for name in COMPARED:
        cells = [_sized(name, getattr(fit.observed, name)), _sized(name, fit.predicted[name])]
        cells += ["" if fit.held_out is None else _sized(name, getattr(fit.held_out, name))]
        cells += [signed_percent(fit.held_out_errors[name]) if fit.held_out_errors else ""]
        cells += [signed_percent(second[name])] if second else []
        rows.append([name.replace("_", " "), *cells])
    show_table("", heads, rows, whole=heads)
    if fit.cancelled:
        note("The search was ended early; this is the best so far.")
    if fit.sentences:
        console.print("\nWhat the features say", markup=False, style="bold")
    for line in fit.sentences:
        console.print(f"  {plain(line)}", markup=False)


def _sized(name: str, value: float) -> str:
    return quantity(value, UNITS.get(name, "1"))
