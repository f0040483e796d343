"""Whether a recorded force was held between its samples or went straight to the next.

A held force acts half a sample later than one along straight lines. How late the recorded force
acts is one of the unknowns of a force balance along the record
(:mod:`stickslip.identify.problems.records`). Intervals of estimates include what is left open.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, Final

from stickslip.data import Measurement
from stickslip.identify.fits.record_forces import driven
from stickslip.identify.fits.settings import Hold, RecordSettings
from stickslip.show.formatting import fixed


@dataclass(frozen=True, kw_only=True)
class HoldFinding:
    """How the force runs between its samples, and what a record says of that."""

    hold: Hold
    """What fits take."""
    given: bool = False
    """Whether the user gave it."""
    lateness: float = math.nan
    """By how many samples the force acts later than along straight lines: 0 for these, 0.5 if it is
    held; not a number where it was not estimated."""
    half_width: float = math.inf
    """Half width of its 95 % interval."""

    @property
    def told(self) -> bool:
        """Whether the record tells it: closer than the two holds lie."""
        return self.half_width < 0.5

    @property
    def unsure(self) -> float:
        """Half samples by which the force may act earlier or later than fits take; 0 if given."""
        if self.given:
            return 0.0
        taken = 0.5 if self.hold == "zero" else 0.0
        return 2.0 * (abs(self.lateness - taken) + self.half_width) if self.told else 1.0

    @property
    def sentence(self) -> str:
        """What is to be said; nothing where the user gave it."""
        if self.given:
            return ""
        what = f'the force {MEANING[self.hold]} (hold = "{self.hold}")'
        if not self.told:
            return (
                f"Assumed: between samples, {what}. The record does not tell, and intervals include"
                " half a sample. Give the hold if it is known."
            )
        late = f"{fixed(self.lateness, 2)} ± {fixed(self.half_width, 2)}"
        return (
            f"Estimated from the record: between samples, {what}; {late} samples late, where"
            " straight lines have 0 and a held force 0.5."
        )

    def applied(self, settings: RecordSettings) -> RecordSettings:
        """Return settings with this hold."""
        return replace(settings, hold=self.hold)

    def to_dict(self) -> dict[str, Any]:
        """Return all as numbers and texts; None for what is not known."""
        known = math.isfinite(self.half_width)
        return {
            "hold": self.hold,
            "given": self.given,
            "samples_late": self.lateness if known else None,
            "half_width": self.half_width if known else None,
        }


MEANING: Final[dict[Hold, str]] = {
    "zero": "keeps its value until the next one",
    "first": "goes straight to the next value",
}


def hold_of(
    measurement: Measurement, given: Hold | None, late: tuple[float, float] | None = None
) -> HoldFinding | None:
    """Return how the force of a record runs between its samples, by how `late` it acts.

    That is a number of samples with the half width of its interval, if a balance told it.

    Examples
    --------
    >>> record = Measurement(time=[0.0, 0.1, 0.2], position=[0.0, 0.1, 0.3], force=[1.0, 2.0, 0.0])
    >>> hold_of(record, None, (0.02, 0.1)).hold, hold_of(record, None).hold
    ('first', 'zero')
    """
    records = measurement.records()
    known = measurement.quantities()
    if "friction" in known or any(record.time is None for record in records):
        return None
    if not ("force" in known and driven(measurement)):
        return None
    if given is not None:
        return HoldFinding(hold=given, given=True)
    value, half = late or (math.nan, math.inf)
    # commands are usual, where an estimate is worth nothing
    hold: Hold = "first" if value < 0.25 and half < 0.5 else "zero"
    return HoldFinding(hold=hold, lateness=value, half_width=half)
