"""Numbers, units and lists as text: one rule for each kind, for terminals, files and pages alike.

Spaces are ordinary ones. A page keeps lines from ending within a number by `unbroken`.
"""

from stickslip.formatting.numbers import (
    MINUS,
    NOT_FINITE,
    UNBOUNDED,
    EstimateText,
    estimate,
    estimate_text,
    fixed,
    interval,
    number,
    percent,
    ratio,
    residue,
    rounded,
    signed,
    signed_percent,
    significant,
    within,
)
from stickslip.formatting.text import (
    NO_BREAK_SPACE,
    capital,
    count,
    in_words,
    joined,
    unbroken,
)
from stickslip.formatting.units import (
    Scale,
    quantities,
    quantity,
    scale_of,
    span,
    unit_text,
    with_unit,
)

__all__ = [
    "MINUS",
    "NOT_FINITE",
    "NO_BREAK_SPACE",
    "UNBOUNDED",
    "EstimateText",
    "Scale",
    "capital",
    "count",
    "estimate",
    "estimate_text",
    "fixed",
    "in_words",
    "interval",
    "joined",
    "number",
    "percent",
    "quantities",
    "quantity",
    "ratio",
    "residue",
    "rounded",
    "scale_of",
    "signed",
    "signed_percent",
    "significant",
    "span",
    "unbroken",
    "unit_text",
    "with_unit",
    "within",
]
