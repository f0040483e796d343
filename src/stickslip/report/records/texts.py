"""Words and numbers that several sections of the report on records share."""

import math
import re
from collections.abc import Iterable
from typing import Final, NamedTuple

import numpy as np

from stickslip.identification import Estimate
from stickslip.plots.core.helpers import in_mm
from stickslip.report import numbers
from stickslip.selection import RecordCandidate, RecordVerdict

__all__ = [
    "DOUBT",
    "Scale",
    "estimate_parts",
    "half_width",
    "label_of",
    "paired",
    "raised",
    "rival_of",
    "scale_for",
    "symbols_of",
    "typeset",
    "unit_of",
]

POWERS: Final = dict(zip("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹", strict=True))
DOUBT: Final = f"{numbers.NO_BREAK_SPACE}±{numbers.NO_BREAK_SPACE}"
FINE: Final = 0.1
"""Scores below this, in the unit shown, have significant digits instead of decimals."""


class Scale(NamedTuple):
    """The unit that errors of one quantity are shown in, over the whole report."""

    factor: float
    unit: str
    fine: bool

    def text(self, value: float) -> str:
        """Return an error as a number, in words if there is none."""
        if not math.isfinite(value):
            return "no score"
        shown = self.factor * value
        return numbers.significant(shown, 2) if self.fine and shown else numbers.score(shown)

    def pair(self, value: float, doubt: float) -> tuple[str, str]:
        """Return an error and its standard error."""
        if not math.isfinite(doubt):
            return self.text(value), ""
        if self.fine:
            parts = numbers.split_estimate(self.factor * value, self.factor * doubt)
            return parts.value, parts.doubt
        shown = self.text(doubt)
        if doubt > 0.0 and not float(shown.replace(",", "")):
            shown = numbers.significant(self.factor * doubt, 1)  # never a doubt of nothing
        return self.text(value), f"±{numbers.NO_BREAK_SPACE}{shown}"

    def with_unit(self, value: float) -> str:
        """Return an error with its unit."""
        return numbers.with_unit(self.text(value), self.unit)


def scale_for(verdict: RecordVerdict) -> Scale:
    """Return the unit for errors: millimetres where metres would need leading zeros."""
    scores = [c.score for c in verdict.candidates if math.isfinite(c.score)]
    least = min(scores, default=1.0)
    factor, unit = in_mm([least], verdict.unit)
    if factor > 1e3:  # 0.0002 mm is read more easily beside the millimetres of other sections
        factor, unit = 1e3, f"m{verdict.unit}"
    return Scale(factor, unit, factor * least < FINE)


def rival_of(verdict: RecordVerdict) -> RecordCandidate | None:
    """Return what the chosen law is compared with: the reference, or the next best law."""
    best, usual = verdict.closest, verdict.reference
    if usual is not None and usual.fit and usual.validation and usual.name != best.name:
        return usual
    others = [c for c in verdict.candidates if c.name != best.name and c.fit and c.validation]
    others = [c for c in others if math.isfinite(c.score)]
    return min(others, key=lambda c: (bool(c.dropped), c.score), default=None)


def paired(other: RecordCandidate, best: RecordCandidate) -> float | None:
    """Return the difference of two losses over its standard error, from blocks in pairs."""
    if other.validation is None or best.validation is None:
        return None
    one, two = other.validation.losses, best.validation.losses
    if len(one) != len(two) or len(one) < 2:
        return None
    gaps = np.subtract(one, two)
    error = float(np.std(gaps, ddof=1)) / math.sqrt(len(gaps))
    return float(gaps.mean()) / error if error > 0.0 else None


def half_width(estimate: Estimate) -> float:
    """Return half the width of an interval, infinite where it has an open end."""
    return 0.5 * (estimate.high - estimate.low) if estimate.bounded else math.inf


def unit_of(estimate: Estimate) -> str:
    """Return the unit of an estimate as it is printed, nothing for a pure number."""
    unit = raised(estimate.quantity.unit)
    return "" if unit == "1" else unit


def raised(unit: str) -> str:
    """Return a unit whose exponents are raised.

    Examples
    --------
    >>> raised("N s^2/m^2")
    'N s²/m²'
    """
    return re.sub(r"\^(\d)", lambda m: POWERS[m[1]], unit)


def estimate_parts(estimate: Estimate, factor: float = 1.0) -> tuple[str, str]:
    r"""Return an estimate and its half width; what is not bounded is said in words.

    Examples
    --------
    >>> from stickslip.quantities import Quantity
    >>> mass = Quantity("M", "kg")
    >>> one = Estimate(path="M", quantity=mass, value=93.2, low=92.1, high=94.3, interval="95 %")
    >>> estimate_parts(one)
    ('93.2', '±\xa01.1')
    """
    if not estimate.bounded:
        return numbers.significant(factor * estimate.value, 3), "not bounded"
    parts = numbers.split_estimate(factor * estimate.value, factor * half_width(estimate))
    return parts.value, parts.doubt


def label_of(estimate: Estimate) -> str:
    """Return a parameter in words with its symbol."""
    if estimate.path == "measurement.offset.friction":
        name = "Offset of the force sensor"
    else:
        name = estimate.path.rpartition(".")[2].replace("_", " ").capitalize()
    return f"{name} ${estimate.quantity.symbol}$"


def symbols_of(candidates: Iterable[RecordCandidate]) -> frozenset[str]:
    """Return the symbols with subscripts of all fitted parameters."""
    fits = [c.fit for c in candidates if c.fit]
    return frozenset(e.quantity.symbol for fit in fits for e in fit.estimates)


def typeset(text: str, symbols: Iterable[str]) -> str:
    """Return text whose symbols stand between dollar signs, which the page typesets.

    Minus signs become true ones, and no line ends before a doubt. A single letter is left alone:
    it may be a word or a unit.

    Examples
    --------
    >>> typeset("mu_- and sigma_- trade off (-0.98).", ["mu_-", "sigma_-", "J"])
    '$mu_-$ and $sigma_-$ trade off (−0.98).'
    """
    text = re.sub(r"(?<![\w$.])-(?=\d)", "−", text).replace(" ± ", DOUBT)
    for name in sorted((s for s in symbols if "_" in s), key=len, reverse=True):
        text = re.sub(rf"(?<![\w$]){re.escape(name)}(?![\w$+-])", lambda m: f"${m[0]}$", text)
    return text
