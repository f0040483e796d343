"""What no fit is made from, refused in the same words by every verb."""

from collections.abc import Collection, Iterator, Sequence
from contextlib import contextmanager

from stickslip.errors import ConvergenceError, InputError, ParameterError, UnknownNameError
from stickslip.experiments.checking.data_quality import check, faults
from stickslip.experiments.checking.finding import Finding
from stickslip.experiments.checking.map_coverage import same
from stickslip.experiments.measurement import Measurement, quantity_called
from stickslip.formatting import joined
from stickslip.mechanisms import Mechanism

MOST_LISTED = 6
"""Names of trials in a message."""
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
    for one in findings:
        records.setdefault((one.sentence, bool(one.record)), []).append(one.record)
    return " ".join(
        f"{_listed(names)}: {sentence}" if named else sentence
        for (sentence, named), names in records.items()
    )


def _listed(names: Sequence[str]) -> str:
    """Return names in words, of many the first ones."""
    names = list(dict.fromkeys(names))
    if len(names) > MOST_LISTED:
        names = [*names[: MOST_LISTED - 1], f"{len(names) - MOST_LISTED + 1} more"]
    return joined(names)


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
            given = ", ".join(one for one in getattr(record, name) if one not in inside)
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
    for one in second.records():
        for other in first.records():
            if not same(one, other):
                continue
            name = one.name or other.name
            told = f" ({name!r})" if name else ""
            raise InputError(
                f"the second record is identical to the fitted one{told}, sample by sample, so its"
                " error would not be a held-out error. Give another record, or none: held-out"
                " blocks then compare the laws on one record."
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
        doubts = [one for one in found if one.severity == "warning"]
        if not doubts:
            raise
        text = str(error).rstrip()
        text += "" if text.endswith((".", "!", "?")) else "."
        said = " ".join([text, "Warnings of the data check:", findings_text(doubts)])
        raise type(error)(said) from None
