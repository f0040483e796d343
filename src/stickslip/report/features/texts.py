"""Words and numbers that several sections of the report on features share."""

import math
from collections.abc import Iterable

from stickslip.identification import Estimate
from stickslip.identification.features.features import COMPARED
from stickslip.report import numbers
from stickslip.report.records.texts import estimate_parts, typeset
from stickslip.selection import FeatureCandidate, FeatureVerdict

__all__ = ["UNITS", "label", "said", "share_parts", "symbols_of", "typeset_lines"]

UNITS = {"frequency": "Hz"}
"""Of features that have one; the others are over the load."""
LABELS = {
    "frequency": "frequency",
    "mean": "mean of $F$/$N$",
    "standard_deviation": "standard deviation of $F$/$N$",
}
assert set(LABELS) == set(COMPARED)


def label(name: str) -> str:
    """Return what a feature is called.

    Examples
    --------
    >>> label("mean")
    'mean of $F$/$N$'
    """
    return LABELS[name]


def said(estimate: Estimate) -> str:
    """Return an estimate with its half width and its unit."""
    value, doubt = estimate_parts(estimate)
    unit = "" if estimate.quantity.unit == "1" else estimate.quantity.unit
    if not estimate.bounded:
        return f"{numbers.with_unit(value, unit)}, {doubt}"
    return numbers.with_unit(f"{value} {doubt}".strip(), unit)


def share_parts(value: float, error: float) -> tuple[str, str]:
    r"""Return a relative error in per cent and its standard error, both with one decimal.

    Examples
    --------
    >>> share_parts(0.0573, 0.0219)
    ('5.7', '±\xa02.2')
    """
    text = numbers.fixed(100.0 * value, 1)
    if math.isnan(error):  # nothing was held out
        return text, ""
    return text, f"±{numbers.NO_BREAK_SPACE}{numbers.fixed(100.0 * error, 1)}"


def symbols_of(verdict: FeatureVerdict) -> frozenset[str]:
    """Return the symbols of all fitted parameters."""
    everyone: list[FeatureCandidate] = list(verdict.candidates)
    return frozenset(e.quantity.symbol for c in everyone if c.fit for e in c.fit.estimates)


def typeset_lines(lines: Iterable[str], verdict: FeatureVerdict) -> tuple[str, ...]:
    """Return texts with the symbols in them typeset."""
    symbols = symbols_of(verdict)
    return tuple(typeset(line, symbols) for line in lines)
