"""What `select` and `fit` share: what was measured, how it is fitted, what is to be said of it."""

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, final

from stickslip.cli.console import note, plain, show_table, stdout
from stickslip.cli.interrupts import Interrupts
from stickslip.cli.progress import Searching, Watching
from stickslip.errors import InputError, ParameterError
from stickslip.experiments import (
    Checks,
    Reading,
    Rig,
    all_paths,
    read_data,
    read_number,
    with_files,
)
from stickslip.formatting import number, unit_text, within
from stickslip.friction import FrictionLaw, specification
from stickslip.identification import (
    LAW,
    AnyLaw,
    Estimate,
    RecordSettings,
    RouteName,
    covers,
    law_quantities,
    refuse_of_laws,
)
from stickslip.kinds import AnyKind, Law, Request, kind_of, refuse_unused
from stickslip.quantities import Quantity, full_path
from stickslip.selection import PurposeName, Wording

SETTINGS = (
    "segment", "hold", "starts", "seed", "position_zeros", "friction_delay", "friction_lag",
)  # fmt: skip
"""Options that are fields of `RecordSettings`."""


@final
@dataclass(frozen=True, kw_only=True)
class CommandInputs:
    """What is fitted and how, as the options say it; None where they say nothing."""

    data: Sequence[Path] = ()
    """Data files; the measurement of the rig is used if empty."""
    reading: Reading
    """How data files are read."""
    validate: Path | None = None
    """Data file of a second record, which no fit uses."""
    vary: Sequence[str] = ()
    """Names or patterns of the parameters to fit, perhaps joined by commas."""
    fixed: Sequence[str] = ()
    """Values of parameters that are held, each as ``NAME=VALUE``, perhaps joined by commas."""
    purpose: PurposeName | None = None
    """What the law is selected for."""
    horizon: float | None = None
    """Length of the predictions that are scored [s]."""
    route: RouteName | None = None
    """Method of the fit."""
    segment: float | None = None
    """Length of the segments of a fit by shooting [s]."""
    hold: str | None = None
    """How the force runs between its samples."""
    starts: int | None = None
    """Number of start values of the search."""
    seed: int | None = None
    """Seed of the random numbers."""
    position_zeros: bool | None = None
    """Whether positions of each record count from an unknown place."""
    friction_delay: float | None = None
    """Time by which measured friction is recorded after the motion [s]."""
    friction_lag: float | None = None
    """Time constant of a first-order filter of measured friction [s]."""

    def __post_init__(self) -> None:
        """Check lengths of time and the hold; other names are checked where they are used."""
        for name in ("horizon", "segment"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise InputError(f"--{name} must be a time above 0 s, got {value:g}.")
        if self.hold not in (None, "zero", "first"):
            raise InputError(f"--hold must be zero or first, got {self.hold!r}.")

    @property
    def given(self) -> tuple[str, ...]:
        """Names of the options of fits and selections that are set."""
        known = ("purpose", "horizon", "route", *SETTINGS, "validate")
        return tuple(name for name in known if getattr(self, name) is not None)

    def settings(self, rig: Rig) -> RecordSettings | None:
        """Return settings of fits to records: as asked, or else as the rig says; None if usual."""
        given = {name: getattr(self, name) for name in SETTINGS}
        said = {name: value for name, value in given.items() if value is not None}
        found = RecordSettings(**{"hold": rig.hold, **said})
        return None if found == RecordSettings() else found


def measured(
    rig: Rig,
    asked: CommandInputs,
    *,
    given: bool,
    law: Callable[[AnyKind], Law] | None = None,
) -> tuple[AnyKind, Request, str]:
    """Return what fits such a measurement, what it is asked, and the SHA-256 of all that was read.

    Options for files add to what the rig says of its own. `given` is whether a rig file was.
    """
    reading = rig.reading.with_changes(asked.reading)
    measurement, validate = rig.measurement, rig.validate
    if asked.data:
        measurement = rig.with_uncertainties(
            read_data(asked.data, reading, mechanism=rig.mechanism)
        )
    elif asked.reading != Reading() and asked.validate is None:
        raise InputError(
            "--columns, --unit, --gain, --repair and --conditions apply to the files of --data or"
            " --validate: name one, or leave them out."
        )
    if measurement is None:
        raise InputError(
            f"{rig.path} has no measurement: add a [[trial]] with a travel or [data] with a file,"
            " or give --data FILE."
        )
    if asked.validate is not None:
        # a second record is predicted, whatever its conditions
        alike = replace(reading, conditions=())
        validate = read_data([asked.validate], alike, mechanism=rig.mechanism)
    files = [*asked.data, *([] if asked.validate is None else [asked.validate])]
    kind = kind_of(measurement, asked.route)
    chosen = None if law is None else law(kind)
    owner = None if chosen is None else kind.owner(chosen)
    vary, fixed = _parameters(rig, asked, owner)
    request = Request(
        mechanism=rig.mechanism,
        measurement=measurement,
        law=owner,
        vary=vary,
        fixed=fixed,
        route=asked.route,
        settings=asked.settings(rig),
        purpose=asked.purpose,
        horizon=asked.horizon,
        validate=validate,
        assumed=rig.assumed or None,
        t_end=rig.t_end,
    ).only(kind.uses)
    typed = {name: f"--{name.replace('_', '-')}" for name in asked.given}
    refuse_unused(kind, typed, request)
    if not given and "t_end" not in kind.uses:  # the bundled rig is a block with a travel
        raise InputError(
            "a record needs a rig file with a mechanism: give one with a [mechanism] table, such"
            ' as type = "axis" and inertia = { value = "80 kg", vary = true }.'
        )
    request = replace(kind.resolved(request), law=chosen)
    refuse_unused(kind, {name: how for name, how in typed.items() if name != "validate"}, request)
    return kind, request, with_files(rig.digest, files)


def _parameters(
    rig: Rig, asked: CommandInputs, law: AnyLaw
) -> tuple[tuple[str, ...], dict[str, float]]:
    """Return what is varied and what fixed, with what the rig file says of both.

    Values that it gives of a law, but not all, are held where `--vary` says what is fitted of it.
    """
    names = [part.strip() for text in asked.vary for part in text.split(",")]
    fixed = _fixed(rig, asked.fixed, law)
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
            found[path] = read_number(_number(value.strip()), known[path])
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


def _number(text: str) -> float | str:
    """Return a number in SI as such, so that only one with a unit is read as a text."""
    try:
        return float(text)
    except ValueError:
        return text


@contextmanager
def watching(
    names: Sequence[str], kind: AnyKind, request: Request, *, at_most: bool = False
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
            at_most=at_most,
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
