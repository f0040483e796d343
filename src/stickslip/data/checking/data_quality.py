"""What a measurement can tell and what is wrong with it, before anything is fitted.

`check` gathers the remarks of all families. What no fit is made from is refused in the same words
by every verb.
"""

import html
import math
from collections.abc import Collection, Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from stickslip.data.checking import coverage, motion, signal_quality
from stickslip.data.checking.coverage import same
from stickslip.data.checking.finding import OTHER_WAY, SEVERITIES, Finding, Severity
from stickslip.data.differentiation import REPLACED, as_readings, outlier_sentence, without_outliers
from stickslip.data.measurement import Measurement, as_turning, quantity_called
from stickslip.data.rig import check_record
from stickslip.data.tolerances import DECADE, FEWEST_SAMPLES, LISTED
from stickslip.data.travels import is_filmed, other_drives
from stickslip.errors import ConvergenceError, InputError, ParameterError, UnknownNameError
from stickslip.mechanisms import PREFIX, BoundedMechanism, Mechanism, cycle_or_none, slip_names
from stickslip.quantities import vary
from stickslip.show.display import Tabular
from stickslip.show.formatting import joined, quantity, unbroken

if TYPE_CHECKING:
    import pandas as pd


RESTING_BODY = "the body rested, which bounds its friction at rest."
"""What it means that a body does not move in one of several trials."""
RESTING_JOINT = "the joint rests, which says little of its friction."
"""What it means that a joint does not move."""
FORWARD = "forward_share"
"""Number of a finding about the directions of a motion."""
MASSES = ("inertia", "mass")
"""Last names of parameters to which the force of a motion is in proportion."""
MARKS = {"info": "", "warning": "Warning: ", "error": "Error: "}


@dataclass(frozen=True, kw_only=True)
class Checks(Tabular):
    """What was found about a measurement.

    Examples
    --------
    >>> from stickslip import Measurement, check
    >>> found = check(Measurement(travel=0.2, uncertainty=0.005))
    >>> found.worst, [finding.kind for finding in found.findings]
    ('warning', ['settings'])
    """

    findings: tuple[Finding, ...]
    """In the order in which they are read."""
    name: str = ""
    """Of the measurement."""

    @property
    def sentences(self) -> tuple[str, ...]:
        """All findings as sentences, each after the name of its trial where there are several."""
        return tuple(map(str, self.findings))

    @property
    def worst(self) -> Severity:
        """``"error"`` if no fit should be made, ``"warning"``, or ``"info"``."""
        ranks = [SEVERITIES.index(finding.severity) for finding in self.findings]
        return SEVERITIES[max(ranks, default=0)]

    def of(self, kind: str) -> tuple[Finding, ...]:
        """Return the findings of a kind.

        Parameters
        ----------
        kind : str
            Such as ``"gap"``.

        Returns
        -------
        tuple of Finding
            None of them if there is nothing to say.

        Examples
        --------
        >>> from stickslip import Measurement, check
        >>> len(check(Measurement(travel=0.2, uncertainty=0.005)).of("settings"))
        1
        """
        return tuple(finding for finding in self.findings if finding.kind == kind)

    def to_dict(self) -> dict[str, Any]:
        """Return the findings as plain texts and numbers."""
        return {
            "name": self.name,
            "worst": self.worst,
            "findings": [finding.to_dict() for finding in self.findings],
        }

    def to_dataframe(self) -> "pd.DataFrame":
        """Return the findings as a pandas DataFrame, a row each."""
        import pandas as pd

        columns = ["kind", "severity", "record", "sentence"]
        rows = [
            (finding.kind, finding.severity, finding.record, str(finding))
            for finding in self.findings
        ]
        return pd.DataFrame(rows, columns=columns)

    def __str__(self) -> str:
        """Return one sentence a line, warnings and errors marked."""
        return "\n".join(f"{MARKS[f.severity]}{f}" for f in self.findings)

    def __repr__(self) -> str:
        return f"<Checks of {self.name or 'a measurement'}, {self.worst}\n{self}>"

    def _repr_html_(self) -> str:
        lines = []
        for finding in self.findings:
            # No line ends between a number and its unit.
            text = html.escape(unbroken(str(finding)))
            mark = MARKS[finding.severity]
            lines.append(f"<li>{f'<strong>{mark}</strong>' if mark else ''}{text}</li>")
        return f"<ul>{''.join(lines)}</ul>"


def check(
    measurement: Measurement,
    *,
    mechanism: Mechanism | None = None,
    vary: str | Collection[str] = (),
    conditions: Collection[str] = (),
) -> Checks:
    """Say what a measurement can tell and what is wrong with it.

    Parameters
    ----------
    measurement : Measurement
        A record in time, a friction map, or readings; several trials are checked one by one.
    mechanism : Mechanism, optional
        What was measured: its parameters must be those that trials override, positions must lie
        between its stops, and forces must be of the size that its motion takes.
    vary : str or collection of str, optional
        Parameters of the mechanism that are fitted as well, by path or last name. With a mass among
        them, forces are not compared with it: the one given is where a search begins.
    conditions : collection of str, optional
        Names of conditions of trials that are used: they tell settings apart.

    Returns
    -------
    Checks
        Sentences with numbers, warnings and errors.

    Raises
    ------
    InputError
        If it is no measurement.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Measurement, check
    >>> time = np.arange(2000) / 1000
    >>> record = Measurement(time=time, position=0.05 * np.sin(2 * np.pi * time))
    >>> print(check(record).sentences[0])
    2,000 samples at 1 kHz over 2 s, evenly spaced (largest deviation below 0.001 %).
    """
    if not isinstance(measurement, Measurement):
        raise InputError(
            f"check takes a Measurement, got {type(measurement).__name__}: read a file with"
            " load_measurement."
        )
    if mechanism is not None:
        measurement = as_turning(measurement, mechanism.units)
    # Findings of a joint that turns have units of turning.
    found = _findings(measurement, mechanism, conditions)
    return Checks(findings=tuple(_beside_mass(found, vary)), name=measurement.name)


def faults(
    measurement: Measurement,
    *,
    mechanism: Mechanism | None = None,
    vary: str | Collection[str] = (),
) -> tuple[Finding, ...]:
    """Return the errors that `check` finds, without the work for what is no error.

    Examples
    --------
    >>> still = Measurement(time=np.arange(50.0), position=np.zeros(50))
    >>> [str(one) for one in faults(still)]
    ['Position is constant: no motion was recorded.']
    """
    found = _beside_mass(_findings(measurement, mechanism, grave=True), vary)
    return tuple(finding for finding in found if finding.severity == "error")


def _beside_mass(findings: Iterable[Finding], vary: str | Collection[str]) -> Iterator[Finding]:
    """Yield findings without those about a mass that is fitted."""
    names = [vary] if isinstance(vary, str) else vary
    free = any(name.rpartition(".")[2] in MASSES for name in names)
    yield from (finding for finding in findings if not (free and motion.compares_mass(finding)))


def _findings(
    measurement: Measurement,
    mechanism: Mechanism | None,
    conditions: Collection[str] = (),
    *,
    grave: bool = False,
) -> Iterator[Finding]:
    """Yield all findings; with ``grave`` only those of checks that can find errors."""
    records = measurement.records()
    if records[0].time is not None:
        measurement = as_readings(measurement)
        if measurement.kind == "friction-map":
            yield motion.readings(records[0].time)
        records = measurement.records()
    if measurement.kind == "scalars":
        yield from coverage.settings(records, conditions)
        yield from () if grave else coverage.order_of_settings(records)
    yield from coverage.lost((measurement, *records))
    yield from coverage.volts(records)
    yield from coverage.alike(records)
    if not grave:
        yield from coverage.repeated(records)
    own = [*_of_records(measurement, mechanism, grave)]
    yield from _beside_others(own, len(records)) if measurement.trials else own
    if not grave:
        yield from coverage.unused(records, conditions)


def _of_records(
    measurement: Measurement, mechanism: Mechanism | None, grave: bool
) -> Iterator[Finding]:
    """Yield what is found of each record by itself."""
    for number, record in enumerate(measurement.records(), 1):
        label = (record.name or f"trial {number}") if measurement.trials else ""
        fits = [*_fits(record, mechanism)]
        if record.joints:
            yield from _joints(record, mechanism, label, grave)
            own = fits
        else:
            # Where a record does not fit its mechanism, comparisons of both would say so once more.
            own = [*_record(record, None if _wrong(fits) else mechanism, grave), *fits]
        yield from (replace(finding, record=label) for finding in own)


def _beside_others(findings: Sequence[Finding], trials: int) -> Iterator[Finding]:
    """Yield findings of trials without faults that are none where others move, or otherwise."""
    still = {finding.record for finding in findings if _still(finding)}
    shares: dict[str, list[float]] = {}
    for finding in findings:
        if finding.kind == "reversals" and FORWARD in finding.numbers:
            shares.setdefault(_joint_of(finding), []).append(finding.numbers[FORWARD])
    # Trials in one direction only are no fault where others go the other way.
    both = {joint for joint, all_ in shares.items() if min(all_) < 1.0 and max(all_) > 0.0}
    for finding in findings:
        if _still(finding) and len(still) < trials:
            yield _resting(finding, RESTING_JOINT if _joint_of(finding) else RESTING_BODY)
        elif finding.measure == OTHER_WAY and _joint_of(finding) in both:
            yield motion.beside_other_way(finding)
        else:
            yield finding


def _joints(
    record: Measurement, mechanism: Mechanism | None, label: str, grave: bool
) -> Iterator[Finding]:
    """Yield what is found of each joint by itself, after its name; what all share, once.

    Its force is not compared with its motion alone, since it drives those of the others too.
    """
    units = (
        {} if mechanism is None else dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    )
    joints = {
        name: replace(trial, turning=True) if units.get(name) == "rad" else trial
        for name, trial in record.joints.items()
    }
    found = {name: [*_record(trial, None, grave, coupled=True)] for name, trial in joints.items()}
    moving = [name for name, own in found.items() if not any(map(_still, own))]
    if moving:  # what jitter looks like in a joint that rests says nothing
        found = {
            name: own
            if name in moving
            else [_resting(remark, RESTING_JOINT) for remark in own if _still(remark)]
            for name, own in found.items()
        }
    said = [{remark.sentence for remark in found[name]} for name in moving or found]
    shared = set.intersection(*said)
    # What all moving joints share is said once, in the place of the first.
    first = (moving or [*found])[0]
    for name, own in found.items():
        for finding in own:
            if finding.sentence not in shared:
                yield replace(finding, record=f"{label}, {name}" if label else name)
            elif name == first:
                yield replace(finding, record=label)


def _joint_of(finding: Finding) -> str:
    """Return the joint of a trial that a finding is about; empty of a record without joints."""
    return finding.record.partition(", ")[2]


def _still(finding: Finding) -> bool:
    return finding.kind == "constant" and finding.severity == "error"


def _resting(finding: Finding, means: str) -> Finding:
    """Return that something rests, as no fault where others move, and what that means."""
    why = finding.sentence.removesuffix("no motion was recorded.")
    return replace(finding, severity="info", sentence=f"{why}{means}")


def _wrong(found: Sequence[Finding]) -> bool:
    return any(finding.severity == "error" for finding in found)


def _agreement(
    record: Measurement,
    mechanism: Mechanism | None,
    moving: motion.Motion | None,
    *,
    coupled: bool,
) -> Iterator[Finding]:
    """Yield what signals say of each other; force says nothing where two of them contradict."""
    agree = [*motion.velocity_and_position(record)]
    yield from agree
    yield from motion.friction_sign(record, moving)
    # Where signals contradict each other, energies would only repeat it.
    if not _wrong(agree) and not coupled:
        yield from motion.energy(record, mechanism)
        yield from motion.proportion(record, mechanism)


def _record(
    record: Measurement, mechanism: Mechanism | None, grave: bool, *, coupled: bool = False
) -> Iterator[Finding]:
    """Yield the findings about one record."""
    huge = [*signal_quality.unusable(record)]
    yield from huge
    if huge:
        return
    if record.kind == "friction-map":
        yield from coverage.coverage(record)
        yield from coverage.resting(record)
        if not grave:
            yield from coverage.stated(record)
            yield from signal_quality.plausible(record)
    if not grave:
        yield from coverage.coefficient(record, mechanism)
    if record.time is None:
        return
    yield from signal_quality.length(record.time)
    if not grave:
        yield from signal_quality.sampling(record.time)
        yield from signal_quality.gaps(record.time)
    record, times = without_outliers(record)  # of which no motion and no force is made
    for column, at in times.items():
        # Those of joints stay where they are.
        said = " ".join([outlier_sentence(column, at), *[REPLACED] * (not coupled)])
        numbers = {"samples": len(at), "first": at[0]}
        yield Finding(kind="outliers", severity="warning", sentence=said, numbers=numbers)
    still = [*signal_quality.constant(record), *signal_quality.unmoved(record)]
    yield from still
    # What only asks for errors needs a motion for its speed, or to compare it with friction.
    needed = isinstance(record.friction, np.ndarray) or signal_quality.has_speed(record)
    moving = None if _wrong(still) or (grave and not needed) else motion.motion_of(record)
    fast = [*signal_quality.too_fast(record, moving)]
    yield from fast
    still += fast  # comparisons of such a motion would say so once more
    enough = isinstance(record.time, np.ndarray) and (record.time.size >= FEWEST_SAMPLES)
    if not grave:
        yield from _signals(record, mechanism, enough)
    if enough and not _wrong(still):
        yield from _agreement(record, mechanism, moving, coupled=coupled)
    if enough and not grave and not _wrong(still):
        yield from _course(record, mechanism, moving, coupled=coupled)


def _signals(record: Measurement, mechanism: Mechanism | None, enough: bool) -> Iterator[Finding]:
    """Yield what each signal tells by itself."""
    yield from motion.missing(record, mechanism)
    yield from signal_quality.plausible(record)
    yield from signal_quality.usual(record)
    yield from motion.straight(record)
    if not enough:
        return
    yield from signal_quality.jumps(record)
    yield from signal_quality.saturated(record)
    yield from signal_quality.held(record)
    yield from signal_quality.cut_off(record)
    yield from signal_quality.quantised(record)
    yield from signal_quality.lifted(record)
    yield from signal_quality.hum(record)
    if record.position is None and record.velocity is None:
        yield Finding(
            kind="motion",
            sentence="Neither position nor velocity is given: directions and rests cannot be"
            " determined.",
        )


def _course(
    record: Measurement,
    mechanism: Mechanism | None,
    moving: motion.Motion | None,
    *,
    coupled: bool,
) -> Iterator[Finding]:
    """Yield what the course of the motion and of the friction tells."""
    if moving is not None:
        yield from motion.reversals(moving, offset=motion.has_offset(record, mechanism))
        yield from motion.rests(moving)
        yield from motion.slow(moving)
    if coupled:  # levels are what a force has beside its own acceleration
        return
    levels = list(coverage.levels(record, moving))
    if moving is None or not moving.hardly_moves:  # at rest, levels are those of what is applied
        yield from coverage.drift(levels)
    yield from coverage.effective(record, levels)


def _fits(record: Measurement, mechanism: Mechanism | None) -> Iterator[Finding]:
    """Yield what does not fit the mechanism."""
    if mechanism is None:
        return
    try:
        if record.overrides or record.initial:
            check_record(mechanism, record, record.name or "the record")
    except InputError as error:
        yield Finding(kind="mechanism", severity="error", sentence=str(error))
        return
    if record.position is None:
        return
    if is_filmed(record) and cycle_or_none(vary(mechanism, PREFIX, record.overrides)) is not None:
        for sentence in other_drives(mechanism, record):
            yield Finding(kind="drive frequency", severity="error", sentence=sentence)
    position, unit = np.atleast_1d(record.values("position")), record.unit("position")
    stops = mechanism.stops() if isinstance(mechanism, BoundedMechanism) else ()
    # Stops inside of a mechanism, as of a joint's play, bound no position that was measured.
    inside = any(wall.coordinate not in slip_names(mechanism) for wall in stops)
    bounds = (("lower_stop", -1.0, position.min()), ("upper_stop", 1.0, position.max()))
    lower, upper = (None if inside else getattr(mechanism, name, None) for name, *_ in bounds)
    room = math.inf if lower is None or upper is None else float(upper) - float(lower)
    span = float(np.ptp(position))
    if span > DECADE * room:
        yield Finding(
            kind="mechanism",
            severity="error",
            sentence=(
                f"Position spans {quantity(span, unit)}, and the stops of the mechanism are"
                f" {quantity(room, unit)} apart: give the unit of the position, as --unit"
                " position=mm, or correct the stops."
            ),
            numbers={"span": span, "room": room},
        )
        return
    for name, side, reached in bounds:
        stop = None if inside else getattr(mechanism, name, None)  # of what was measured
        if stop is not None and side * (float(reached) - float(stop)) > 0:
            yield Finding(
                kind="mechanism",
                severity="warning",
                sentence=(
                    f"Position reaches {quantity(float(reached), unit)}, beyond {name} of the"
                    f" mechanism at {quantity(float(stop), unit)}: check the zero and the unit of"
                    " position."
                ),
                numbers={"reached": float(reached), "stop": float(stop)},
            )


# What no fit is made from, refused in the same words by every verb.

ACTING = ("force", "reference", "friction")
"""What acts on a body: a second record without it would be predicted as if nothing did."""


def refuse_faults(
    measurement: Measurement, mechanism: Mechanism, vary: Collection[str] = ()
) -> None:
    """Refuse a measurement with errors that `check` finds where some parameters are fitted.

    Examples
    --------
    >>> from stickslip import Axis
    >>> still = Measurement(time=list(range(50)), position=[0.0] * 50)
    >>> refuse_faults(still, Axis(inertia=1.0))
    Traceback (most recent call last):
    stickslip.errors.InputError: This record cannot be fitted. Position is constant: ...
    """
    wrong = faults(measurement, mechanism=mechanism, vary=vary)
    if wrong:
        raise refusal(wrong)


def refusal(wrong: Sequence[Finding]) -> InputError:
    """Return what refuses a record with these errors."""
    return InputError(f"This record cannot be fitted. {findings_text(wrong)}")


def findings_text(findings: Sequence[Finding]) -> str:
    """Return findings as one text: what several trials have in common once, after their names.

    Examples
    --------
    >>> from dataclasses import replace
    >>> still = Finding(kind="constant", sentence="Position is constant.", record="run1")
    >>> findings_text([still, replace(still, record="run2"), replace(still, record="")])
    'run1 and run2: Position is constant. Position is constant.'
    """
    records: dict[tuple[str, bool], list[str]] = {}
    for finding in findings:
        records.setdefault((finding.sentence, bool(finding.record)), []).append(finding.record)
    return " ".join(
        f"{joined([*dict.fromkeys(names)], LISTED)}: {sentence}" if named else sentence
        for (sentence, named), names in records.items()
    )


def refuse_unused(measurement: Measurement, inside: Collection[str] = ()) -> None:
    """Refuse settings of records in time or of friction that would have no effect.

    Examples
    --------
    >>> refuse_unused(Measurement(time=[0.0, 1.0], position=[0.0, 0.1], initial={"x": 1.0}))
    Traceback (most recent call last):
    stickslip.errors.InputError: Measurement.initial (x) of the record has no effect on ...
    """
    for record in measurement.records():
        label = f"record {record.name!r}" if record.name else "the record"
        for name, why in (
            ("initial", "the initial states of its segments are estimated"),
            ("uncertainty", "intervals come from the residuals of the fit"),
        ):
            # Rows of a table may be weighted by what is stated of each.
            known = {*inside, *["friction"] * (record.kind == "friction-map")}
            given = ", ".join(state for state in getattr(record, name) if state not in known)
            if given:
                raise InputError(
                    f"Measurement.{name} ({given}) of {label} has no effect on fits to records:"
                    f" {why}. Leave it out."
                )


def refuse_lack(
    first: Measurement, second: Measurement, *, compared: str = "", which: str = "the second record"
) -> None:
    """Refuse a record that has not what another one has that a fit was made to.

    Examples
    --------
    >>> time, x = [0.0, 1.0], [0.0, 0.1]
    >>> driven = Measurement(time=time, position=x, force=x)
    >>> refuse_lack(driven, Measurement(time=time, position=x))
    Traceback (most recent call last):
    stickslip.errors.InputError: the second record has no force (u) [N], which ...
    """
    needed = [name for name in first.quantities() if name.partition(".")[0] in ACTING]
    for name in dict.fromkeys([*needed, *([compared] if compared else [])]):
        for record in second.records():
            if name in record.quantities():
                continue
            label = f"{which} {record.name!r}" if record.name else which
            quantity = quantity_called(name)
            cure = " Where no force acted, give a force of 0." if name == "force" else ""
            raise InputError(
                f"{label} has no {name} ({quantity.symbol}) [{quantity.unit}], which the fitted"
                f" record has; it has {', '.join(record.quantities())}.{cure}"
            )


def refuse_same(first: Measurement, second: Measurement) -> None:
    """Refuse a second record that holds what the fit is made to, number by number.

    Examples
    --------
    >>> run = {"time": [0.0, 1.0], "position": [0.0, 0.1]}
    >>> refuse_same(Measurement(**run, name="run 1"), Measurement(**run))
    Traceback (most recent call last):
    stickslip.errors.InputError: the second record is identical to the fitted one ('run 1'), ...
    """
    for record in second.records():
        for other in first.records():
            if not same(record, other):
                continue
            name = record.name or other.name
            label = f" ({name!r})" if name else ""
            raise InputError(
                f"the second record is identical to the fitted one{label}, sample by sample, so its"
                " error would not be that on another. Give another record."
            )


@contextmanager
def with_doubts(
    measurement: Measurement,
    mechanism: Mechanism,
    of: type[InputError | ConvergenceError] = InputError,
) -> Iterator[None]:
    """Add what `check` warns of to the message of a record that turns out not to serve.

    Examples
    --------
    >>> from stickslip import Axis
    >>> few = Measurement(time=list(range(20)), velocity=[0.1 * (i % 5) for i in range(20)])
    >>> with with_doubts(few, Axis(inertia=1.0)):
    ...     raise InputError("it does not serve.")
    Traceback (most recent call last):
    stickslip.errors.InputError: it does not serve. Warnings of the data check: ...
    """
    try:
        yield
    except (ParameterError, UnknownNameError):  # of what was asked, not of the record
        raise
    except of as error:
        found = check(measurement, mechanism=mechanism).findings
        doubts = [finding for finding in found if finding.severity == "warning"]
        if not doubts:
            raise
        text = str(error).rstrip()
        text += "" if text.endswith((".", "!", "?")) else "."
        # The class tells callers what went wrong: it stays.
        said = " ".join([text, "Warnings of the data check:", findings_text(doubts)])
        raise type(error)(said) from None
