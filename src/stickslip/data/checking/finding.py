"""One remark about a measurement, or about what was found from it."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import Any, Final, Literal

from stickslip.data.tolerances import LISTED
from stickslip.show.described import Described
from stickslip.show.formatting import joined

OTHER_SPEEDS: Final = "Measure at further velocities"
"""What answers a motion at too few speeds."""
OTHER_WAY: Final = "Measure in the other direction, too"
"""What answers a motion in one direction."""
Severity = Literal["info", "warning", "error"]
TURN: Final = (
    "set its gain to −1 (`gain` under [data] of a rig file), or reverse the sign of its present"
    " gain"
)
"""Cure of a force that counts the other way; a gain that is given takes the place of another."""
SEVERITIES: tuple[Severity, ...] = ("info", "warning", "error")


@dataclass(frozen=True, kw_only=True)
class Finding(metaclass=Described):
    """One remark about a measurement, as a sentence with its numbers.

    Examples
    --------
    >>> one = Finding(kind="gap", sentence="Gap of 0.3 s after 12.5 s.", severity="warning")
    >>> str(one)
    'Gap of 0.3 s after 12.5 s.'
    """

    kind: str
    """What it is about, such as ``"sampling"`` or ``"drift"``."""
    sentence: str
    """The remark, with numbers and units."""
    severity: Severity = "info"
    """``"error"`` where no fit should be made from the record as it is."""
    numbers: Mapping[str, float] = field(default_factory=dict)
    """The numbers of the sentence, SI."""
    measure: str = ""
    """What to measure, without a full stop, where a further measurement answers it; else empty."""
    record: str = ""
    """Name of the trial it is about, where there are several."""

    def __post_init__(self) -> None:
        """Keep the numbers as plain floats that nobody changes."""
        numbers = {str(name): float(value) for name, value in self.numbers.items()}
        object.__setattr__(self, "numbers", MappingProxyType(numbers))

    def __getstate__(self) -> dict[str, Any]:
        """Return what crosses processes: a view of the numbers does not."""
        return {**self.__dict__, "numbers": dict(self.numbers)}

    def __setstate__(self, state: Mapping[str, Any]) -> None:
        """Keep what came from another process as it was made there."""
        self.__dict__.update(state, numbers=MappingProxyType(state["numbers"]))

    def __str__(self) -> str:
        """Return the sentence, after the name of its trial."""
        return f"{self.record}: {self.sentence}" if self.record else self.sentence

    def to_dict(self) -> dict[str, Any]:
        """Return plain texts and numbers."""
        return {
            "kind": self.kind,
            "severity": self.severity,
            "sentence": self.sentence,
            "numbers": dict(self.numbers),
            "record": self.record,
        }


def remark(
    kind: str, severity: Severity | bool, sentence: str, measure: str = "", /, **numbers: float
) -> Finding:
    """Return a finding with the numbers of its sentence by their names.

    A severity of True is a warning; False is a remark, which asks for no measurement.

    Examples
    --------
    >>> found = remark("gap", True, "Gap of 0.3 s after 12.5 s.", "Record again", duration=0.3)
    >>> found.severity, found.measure, found.numbers["duration"]
    ('warning', 'Record again', 0.3)
    """
    if not isinstance(severity, str):
        measure = measure if severity else ""
        severity = "warning" if severity else "info"
    return Finding(
        kind=kind, severity=severity, sentence=sentence, measure=measure, numbers=numbers
    )


def sentences_of(findings: Iterable[Finding], *kinds: str) -> tuple[str, ...]:
    """Return findings in words, those of some kinds alone if any are named.

    Examples
    --------
    >>> found = [
    ...     Finding(kind="drift", sentence="It drifts."),
    ...     Finding(kind="gap", sentence="A gap."),
    ... ]
    >>> sentences_of(found, "drift")
    ('It drifts.',)
    """
    return tuple(str(finding) for finding in findings if not kinds or finding.kind in kinds)


def grouped(findings: Iterable[Finding]) -> list[Finding]:
    """Return findings with what several trials have in common once, after the names of these.

    Examples
    --------
    >>> from dataclasses import replace
    >>> still = Finding(kind="constant", sentence="Position is constant.", record="run1")
    >>> others = [replace(still, record=name) for name in ("run2", "")]
    >>> [str(finding) for finding in grouped([still, *others])]
    ['run1 and run2: Position is constant.', 'Position is constant.']
    """
    groups: dict[tuple[str, bool], dict[str, Finding]] = {}
    for finding in findings:
        groups.setdefault((finding.sentence, bool(finding.record)), {})[finding.record] = finding
    names = {name for group in groups.values() for name in group} - {""}
    return [
        replace(first, record="all trials" if 2 < len(has) == len(names) else joined(has, LISTED))
        for has, first in (([*group], next(iter(group.values()))) for group in groups.values())
    ]
