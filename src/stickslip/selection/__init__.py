"""Selection: which law explains a measurement, and what the measurement cannot tell."""

from stickslip.selection.criteria import Criteria, criteria_of
from stickslip.selection.discretisation import FixedStepRow, compare_fixed_steps
from stickslip.selection.selecting import select
from stickslip.selection.verdict import Candidate, Verdict

__all__ = [
    "Candidate",
    "Criteria",
    "FixedStepRow",
    "Verdict",
    "compare_fixed_steps",
    "criteria_of",
    "select",
]
