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
from stickslip.cli.feature_fit import show_feature_fit
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
from stickslip.formatting import quantity
from stickslip.friction import FrictionLaw, law_type
from stickslip.identification import FeatureFit, Fit, RecordFit, Score, TravelFit, fit
from stickslip.identification.trials.comparison import compared
from stickslip.selection.record_wording import error_text, route_text

__all__ = ["run"]


def run(
    path: Path | None,
    name: str | None,
    free: str | None,
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
    law = rig.laws.get(name) or law_type(name)
    found = measured(rig, asked, given=path is not None)
    checks = _checked(rig, found, asked)
    wanted = None if free is None else [part.strip() for part in free.split(",")]
    result = _fitted(rig, law, found, asked, wanted)
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
    law: FrictionLaw | type[FrictionLaw],
    found: Measured,
    asked: Asked,
    free: Sequence[str] | None,
) -> Fit:
    """Fit with a bar; Ctrl-C once ends the search in a record."""
    known = _known(rig, law.name, free)
    if found.travels:
        with Watching([law.name], "Fitting") as bar:
            return fit(
                rig.mechanism,
                law,
                found.measurement,
                free=free,
                known=known,
                unknown=found.unknown,
                t_end=rig.t_end,
                watch=lambda runs: bar(law.name, runs),
            )
    with (
        Interrupts() as interrupts,
        Searching([law.name], residuals(found), interrupts) as watch,
    ):
        watch(law.name, math.nan)  # what is compiled first takes longer than the first look
        return fit(
            rig.mechanism,
            law,
            found.measurement,
            free=free,
            known=known,
            unknown=found.unknown,
            route=found.route or asked.how.route,
            settings=asked.how.settings(rig),
            watch=lambda rms: watch(law.name, rms),
        )


def _known(rig: Rig, name: str, free: Sequence[str] | None) -> dict[str, float]:
    """Return what the rig says of parameters that are not free, where it does not say all."""
    given = rig.given.get(name, {})
    if name in rig.laws or not given:
        return {}
    if free is None:
        said = ", ".join(f"{field} = {value:g}" for field, value in given.items())
        note(f"All of {name} is fitted, {said} too; --free names what is looked for beside it.")
        return {}
    wanted = {one.rpartition(".")[2] for one in free}
    return {field: value for field, value in given.items() if field not in wanted}


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
    console.print()
    if isinstance(result, TravelFit):
        pairs = zip(result.measured, result.predicted, strict=True)
        rows = [[plain(quantity(m, "m")), plain(quantity(p, "m"))] for m, p in pairs]
        show_table("", ["measured travel", "predicted"], rows)
        return
    if isinstance(result, FeatureFit):
        assert not isinstance(second, Score)
        show_feature_fit(result, second or {})
        return
    assert isinstance(result, RecordFit)
    assert not isinstance(second, Mapping)
    compared, found = result.problem.quantity, result.found
    said = partial(error_text, quantity=compared, turning=result.measurement.turning)
    console.print(f"Residual of {compared}: {said(result.rms)}", markup=False)
    if second is not None:
        console.print(
            f"On the second record: {said(second.rms)}, {_predicted(result, second)}", markup=False
        )
    console.print(f"Restarts: {_restarts(found.agreeing, len(found.costs))}", markup=False)
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


def _predicted(result: RecordFit, second: Score) -> str:
    """Return how a second record was predicted: where friction is, bristles run through it."""
    if result.route == "shooting":
        return f"over {quantity(second.horizon, 's')} at a time"
    return "along the measured motion"


def _restarts(agreeing: int, starts: int) -> str:
    if starts == 1:
        return "none, a single start"
    return f"{agreeing} of {starts} starts end at the least residual"
