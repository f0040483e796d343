"""Selection: which law explains a measurement, and what the measurement cannot tell."""

from stickslip.selection.criteria import Criteria, criteria_of
from stickslip.selection.feature_verdict import FeatureCandidate, FeatureVerdict, OtherSpeed
from stickslip.selection.features import select_features
from stickslip.selection.fixed_step_comparison import FixedStepRow, compare_fixed_steps
from stickslip.selection.lab_sheet import Plan
from stickslip.selection.planning import plan
from stickslip.selection.rate_state import select_rate_state
from stickslip.selection.rate_state_verdict import (
    OtherStep,
    RateStateCandidate,
    RateStateVerdict,
)
from stickslip.selection.record_verdict import RecordCandidate, RecordVerdict
from stickslip.selection.records import PURPOSES, select_records
from stickslip.selection.travel_verdict import TravelCandidate, TravelVerdict
from stickslip.selection.travels import select_travels
from stickslip.selection.verdict import Candidate, Verdict

__all__ = [
    "PURPOSES",
    "Candidate",
    "Criteria",
    "FeatureCandidate",
    "FeatureVerdict",
    "FixedStepRow",
    "OtherSpeed",
    "OtherStep",
    "Plan",
    "RateStateCandidate",
    "RateStateVerdict",
    "RecordCandidate",
    "RecordVerdict",
    "TravelCandidate",
    "TravelVerdict",
    "Verdict",
    "compare_fixed_steps",
    "criteria_of",
    "plan",
    "select_features",
    "select_rate_state",
    "select_records",
    "select_travels",
]
