"""What `select` and `fit` share: what was measured, how it is fitted, what is to be said of it."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, Final, TypeAlias

from stickslip.cli.console import note, plain, show_table, stdout
from stickslip.cli.numbers import number_of
from stickslip.cli.options import EstimationOptions, ParameterOptions
from stickslip.cli.progress import Interrupts, Searching, Watching
from stickslip.errors import InputError, ParameterError
from stickslip.experiments import Checks, Reading, Rig, condition_name, read_data
from stickslip.formatting import number, significant, unit_text, within
from stickslip.friction import FrictionLaw, specification
from stickslip.identification import (
    LAW,
    AnyLaw,
    Estimate,
    RecordSettings,
    TrialComparison,
    covers,
    law_quantities,
    refuse_of_laws,
)
from stickslip.kinds import AnyKind, Law, Request, kind_of, refuse_unused
from stickslip.quantities import Quantity, all_paths, full_path
from stickslip.selection import Wording

ALL_PARAMETERS: Final = ParameterOptions()
"""Without a word of options."""
USUAL: Final = EstimationOptions()
Ask: TypeAlias = Callable[..., tuple[AnyKind, Request, list[Path]]]
"""`measured` with what the options say."""


def measured(
    rig: Rig,
    *,
    reading: Reading,
    data: Sequence[Path] = (),
    parameters: ParameterOptions = ALL_PARAMETERS,
    estimation: EstimationOptions = USUAL,
    given: bool,
    law: Callable[[AnyKind], Law] | None = None,
) -> tuple[AnyKind, Request, list[Path]]:
    """Return what fits such a measurement, what it is asked, and the data files of the options.

    Options for files add to what the rig says of its own; None says nothing. `given` is
    whether a rig file was, `law` the law of a kind.
    """
    said, horizon, validate = estimation.settings, estimation.horizon, parameters.validate
    route = estimation.route
    for name, value in (("horizon", horizon), ("segment", said.get("segment"))):
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise InputError(f"--{name} must be a time above 0 s, got {value:g}.")
    if said.get("hold") not in (None, "zero", "first"):
        raise InputError(f"--hold must be zero or first, got {said['hold']!r}.")
    own = rig.reading.with_changes(reading)
    measurement, second = rig.measurement, rig.validate
    if data:
        measurement = rig.with_uncertainties(read_data(data, own, mechanism=rig.mechanism))
    elif reading != Reading() and validate is None:
        raise InputError(
            "--columns, --unit, --gain, --repair and --conditions apply to the files of --data or"
            " --validate: name one, or leave them out."
        )
    if measurement is None:
        raise InputError(
            f"{rig.path} has no measurement: add a [[trial]] with a travel or [data] with a file,"
            " or give --data FILE."
        )
    files = _hashed(data)
    if validate is not None:
        # a second record is predicted, whatever its conditions
        second = read_data([validate], replace(own, conditions=()), mechanism=rig.mechanism)
        files += _hashed([validate])
    kind = kind_of(measurement, route)
    chosen = None if law is None else law(kind)
    owner = None if chosen is None else kind.owner(chosen)
    varied, held = _parameters(rig, parameters.vary or (), parameters.fixed or (), owner)
    numerics = RecordSettings(**{"hold": rig.hold, **said})
    request = Request(
        mechanism=rig.mechanism,
        measurement=measurement,
        law=owner,
        vary=varied,
        fixed=held,
        route=route,
        settings=None if numerics == RecordSettings() else numerics,
        horizon=horizon,
        validate=second,
        assumed=rig.assumed or None,
        t_end=rig.t_end,
    ).only(kind.uses)
    options = {"horizon": horizon, "route": route, **said}
    options["validate"] = validate
    typed = {
        name: f"--{name.replace('_', '-')}" for name, one in options.items() if one is not None
    }
    refuse_unused(kind, typed, request)
    if not given and "t_end" not in kind.uses:  # the bundled rig is a block with a travel
        raise InputError(
            "a record needs a rig file with a mechanism: give one with a [mechanism] table, such"
            ' as type = "axis" and inertia = { value = "80 kg", vary = true }.'
        )
    request = replace(kind.resolved(request), law=chosen)
    refuse_unused(kind, {name: how for name, how in typed.items() if name != "validate"}, request)
    return kind, request, files


def _hashed(given: Sequence[Path]) -> list[Path]:
    """Return the files that hold the data of options."""
    if not given:
        return []
    from stickslip.experiments import log_files  # with pandas, which other rigs do without

    return [one for path in given for one in log_files(path)]


def _parameters(
    rig: Rig, vary: Sequence[str], fixes: Sequence[str], law: AnyLaw
) -> tuple[tuple[str, ...], dict[str, float]]:
    """Return what is varied and what fixed, with what the rig file says of both.

    Values that it gives of a law, but not all, are held where `--vary` says what is fitted of it.
    """
    names = [part.strip() for text in vary for part in text.split(",")]
    fixed = _fixed(rig, fixes, law)
    given: Mapping[str, float] = {}
    if isinstance(law, type) and issubclass(law, FrictionLaw):
        given = rig.given.get(law.name, {})
    if given and (not names or LAW in names):
        said = ", ".join(f"{name} = {number(value, 6)}" for name, value in given.items())
        note(
            f"All parameters of {law.name if law else 'the law'} are fitted, including {said} of"
            " the rig file; --vary adds parameters to the fit, --fixed holds them."
        )
    elif given:
        paths = {f"friction.{name}": value for name, value in given.items()}
        held = {p: v for p, v in paths.items() if not any(covers(name, p) for name in names)}
        fixed = held | fixed
    marked = (path for path in rig.vary if path not in fixed)
    return (*(names or (LAW,)), *marked), fixed


def _fixed(rig: Rig, texts: Sequence[str], law: AnyLaw) -> dict[str, float]:
    """Return fixed values by path, read with their units."""
    known = {**_law_quantities(law), **all_paths(rig.mechanism, "mechanism")}
    found: dict[str, float] = {}
    for part in (part for text in texts for part in text.split(",")):
        name, equals, value = part.partition("=")
        if not equals or not name.strip() or not value.strip():
            raise InputError(
                f"--fixed takes NAME=VALUE such as viscous_coefficient=0.4, got {part!r}."
            )
        if law is None:
            refuse_of_laws([name.strip()], known)
        path = full_path(name.strip(), known, "parameter in --fixed")
        try:
            found[path] = number_of(value.strip(), known[path])
        except ParameterError as error:
            raise ParameterError(f"--fixed {path} {error}") from None
    return found


def _law_quantities(law: Any) -> Mapping[str, Quantity]:
    """Return the parameters of a law by path, or those of laws by contact."""
    if not isinstance(law, Mapping):
        return law_quantities(law)
    return {
        path.replace("friction.", f"friction.{contact}.", 1): quantity
        for contact, one in law.items()
        for path, quantity in law_quantities(
            specification(one).law if isinstance(one, str) else one
        ).items()
    }


@contextmanager
def watching(
    names: Sequence[str], kind: AnyKind, request: Request
) -> Iterator[Watching | Searching]:
    """Show how far the fits of laws are; where searches can be ended early, Ctrl-C does so."""
    if kind.counts_runs:
        with Watching(names, "Fitting") as counting:
            yield counting
        return

    def text(error: float) -> str:
        return kind.residual_text(error, request)

    with (
        Interrupts() as interrupts,
        Searching(
            names,
            text,
            interrupts,
            longest_first=kind.longest_first,
        ) as bar,
    ):
        yield bar


def show_warnings(checks: Checks) -> None:
    """Print what is doubtful about a record."""
    doubts = [finding for finding in checks.findings if finding.severity == "warning"]
    for finding in doubts:
        stdout().print(f"! {finding}", markup=False, style="yellow")


def show_estimates(estimates: Sequence[Estimate]) -> None:
    """Print parameters with their intervals, and why one is not bounded."""
    rows = [
        [
            one.path,
            one.quantity.symbol,
            within(one.value, one.low, one.high),
            unit_text(one.quantity.unit),
            one.range,
        ]
        for one in estimates
    ]
    kinds = ", ".join(dict.fromkeys(one.interval for one in estimates))
    heads = ["parameter", "", "value", "unit", f"range ({kinds})"]
    show_table("", heads, rows, whole=heads[1:])
    for one in estimates:
        if one.reason:
            stdout().print(f"  {one.path}: {plain(one.reason)}", markup=False)


def show_open(words: Wording) -> None:
    """Print what the data cannot tell and what to measure next."""
    console = stdout()
    for title, lines in (("Limitations", words.cannot_tell), ("Measure next", words.measure_next)):
        if lines:
            console.print(f"\n{title}", markup=False, style="bold")
        for line in lines:
            console.print(f"  {plain(line)}", markup=False)


def content_of(comparison: TrialComparison | None) -> Mapping[str, Any]:
    """Return the comparison as a part of what a command writes as JSON."""
    return {} if comparison is None else {"trials": comparison.to_dict()}


def show_trials(comparison: TrialComparison | None) -> None:
    """Print whether the trials share one law, and by trial what was fitted where they do not."""
    if comparison is None:
        return
    console = stdout()
    console.print("\nTrials", markup=False, style="bold")
    for line in comparison.sentences:
        console.print(f"  {plain(line)}", markup=False)
    if not comparison.trials or (comparison.shared and not comparison.conditions):
        return
    symbols = [one.quantity.symbol for one in comparison.trials[0].estimates]
    heads = ["trial", *map(condition_name, comparison.conditions)]
    heads += [head for symbol in symbols for head in (symbol, "95 %")]
    rows = []
    for trial in comparison.trials:
        row = [trial.name]
        for name in comparison.conditions:
            value = trial.conditions.get(name)
            row.append(significant(value, 4) if isinstance(value, float) else value or "")
        for one, error in zip(trial.estimates, trial.errors, strict=True):
            known = math.isfinite(error)
            row += [significant(one.value, 4), one.range if known else "open"]
        rows.append([plain(cell) for cell in row])
    show_table("", heads, rows, whole=heads)
