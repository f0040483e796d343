"""Words and numbers that several sections of the report on records share."""

import math
from collections.abc import Iterable

from stickslip.formatting import rounded
from stickslip.identification import Estimate
from stickslip.kinds.joints.joint_verdict import RecordCandidate, RecordVerdict


def rival_of(verdict: RecordVerdict) -> RecordCandidate | None:
    """Return what the chosen law is compared with: the reference, or the next best law."""
    best, usual = verdict.closest, verdict.reference
    if usual is not None and usual.fit and usual.validation and usual.name != best.name:
        return usual
    others = [c for c in verdict.candidates if c.name != best.name and c.fit and c.validation]
    others = [c for c in others if math.isfinite(c.score)]
    return min(others, key=lambda c: (bool(c.dropped), c.score), default=None)


def symbols_of(candidates: Iterable[RecordCandidate]) -> frozenset[str]:
    """Return the symbols with subscripts of all fitted parameters."""
    fits = [c.fit for c in candidates if c.fit]
    return frozenset(e.quantity.symbol for fit in fits for e in fit.estimates)


def to_digits(value: float, estimate: Estimate) -> str:
    """Return a value to the digits of an estimate, such as what half of a record gives for it."""
    return rounded(value, estimate.half_width if estimate.bounded else math.inf)
