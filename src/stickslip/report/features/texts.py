"""Words and numbers that several sections of the report on features share."""

from collections.abc import Iterable

from stickslip.identification import COMPARED
from stickslip.report.core.markup import typeset
from stickslip.selection import FeatureCandidate, FeatureVerdict

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


def symbols_of(verdict: FeatureVerdict) -> frozenset[str]:
    """Return the symbols of all fitted parameters."""
    everyone: list[FeatureCandidate] = list(verdict.candidates)
    return frozenset(e.quantity.symbol for c in everyone if c.fit for e in c.fit.estimates)


def typeset_lines(lines: Iterable[str], verdict: FeatureVerdict) -> tuple[str, ...]:
    """Return texts with the symbols in them typeset."""
    symbols = symbols_of(verdict)
    return tuple(typeset(line, symbols) for line in lines)
