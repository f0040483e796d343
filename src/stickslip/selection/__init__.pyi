# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.selection.candidates import LEFT_OUT as LEFT_OUT
from stickslip.selection.candidates import Watch as Watch
from stickslip.selection.candidates import check_any as check_any
from stickslip.selection.candidates import check_apart as check_apart
from stickslip.selection.candidates import checked as checked
from stickslip.selection.candidates import fitted_side_by_side as fitted_side_by_side
from stickslip.selection.candidates import specifications as specifications
from stickslip.selection.candidates import watched as watched
from stickslip.selection.choice import as_good as as_good
from stickslip.selection.choice import choose as choose
from stickslip.selection.choice import effective_aic as effective_aic
from stickslip.selection.choice import errs_more as errs_more
from stickslip.selection.choice import outcome_beside as outcome_beside
from stickslip.selection.criteria import Criteria as Criteria
from stickslip.selection.criteria import criteria_of as criteria_of
from stickslip.selection.cross_validation import CrossValidated as CrossValidated
from stickslip.selection.cross_validation import CrossValidatedVerdict as CrossValidatedVerdict
from stickslip.selection.cross_validation import CrossValidation as CrossValidation
from stickslip.selection.cross_validation import DIGITS as DIGITS
from stickslip.selection.cross_validation import held_out as held_out
from stickslip.selection.fixed_step_comparison import FixedStepRow as FixedStepRow
from stickslip.selection.fixed_step_comparison import compare_fixed_steps as compare_fixed_steps
from stickslip.selection.fixed_step_comparison import largest_step as largest_step
from stickslip.selection.identifiable import limits_of as limits_of
from stickslip.selection.verdict import Candidate as Candidate
from stickslip.selection.verdict import MOST as MOST
from stickslip.selection.verdict import NOT_DISTINGUISHED as NOT_DISTINGUISHED
from stickslip.selection.verdict import ONE_LAW as ONE_LAW
from stickslip.selection.verdict import UNMEASURED as UNMEASURED
from stickslip.selection.verdict import Verdict as Verdict
from stickslip.selection.verdict import Wording as Wording
from stickslip.selection.verdict import corrections as corrections
from stickslip.selection.verdict import friction_of as friction_of
from stickslip.selection.verdict import held_out_text as held_out_text
from stickslip.selection.verdict import in_sentence as in_sentence
from stickslip.selection.verdict import longer as longer
from stickslip.selection.verdict import not_distinguished as not_distinguished
from stickslip.selection.verdict import on_second_record as on_second_record
from stickslip.selection.verdict import plain as plain
from stickslip.selection.verdict import score_scale as score_scale
from stickslip.selection.verdict import score_text as score_text
from stickslip.selection.verdict import to_predict as to_predict

__all__ = [
    "Candidate",
    "Criteria",
    "FixedStepRow",
    "Verdict",
    "compare_fixed_steps",
    "criteria_of",
]
