# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.identify.candidates.candidates import LEFT_OUT as LEFT_OUT
from stickslip.identify.candidates.candidates import Watch as Watch
from stickslip.identify.candidates.candidates import check_any as check_any
from stickslip.identify.candidates.candidates import check_apart as check_apart
from stickslip.identify.candidates.candidates import fitted_side_by_side as fitted_side_by_side
from stickslip.identify.candidates.candidates import specifications as specifications
from stickslip.identify.candidates.criteria import Criteria as Criteria
from stickslip.identify.candidates.criteria import criteria_of as criteria_of
from stickslip.identify.candidates.criteria import limits_of as limits_of
from stickslip.identify.candidates.fixed_step_comparison import FixedStepRow as FixedStepRow
from stickslip.identify.candidates.fixed_step_comparison import compare_fixed_steps as compare_fixed_steps
from stickslip.identify.candidates.fixed_step_comparison import largest_step as largest_step
from stickslip.identify.candidates.verdict import Candidate as Candidate
from stickslip.identify.candidates.verdict import MOST as MOST
from stickslip.identify.candidates.verdict import NOT_DISTINGUISHED as NOT_DISTINGUISHED
from stickslip.identify.candidates.verdict import ONE_LAW as ONE_LAW
from stickslip.identify.candidates.verdict import UNMEASURED as UNMEASURED
from stickslip.identify.candidates.verdict import Verdict as Verdict
from stickslip.identify.candidates.verdict import Wording as Wording
from stickslip.identify.candidates.verdict import corrections as corrections
from stickslip.identify.candidates.verdict import friction_of as friction_of
from stickslip.identify.candidates.verdict import held_out_text as held_out_text
from stickslip.identify.candidates.verdict import in_sentence as in_sentence
from stickslip.identify.candidates.verdict import longer as longer
from stickslip.identify.candidates.verdict import not_distinguished as not_distinguished
from stickslip.identify.candidates.verdict import on_second_record as on_second_record
from stickslip.identify.candidates.verdict import plain as plain
from stickslip.identify.candidates.verdict import score_scale as score_scale
from stickslip.identify.candidates.verdict import score_text as score_text
from stickslip.identify.candidates.verdict import to_predict as to_predict

__all__ = [
    "Candidate",
    "Criteria",
    "FixedStepRow",
    "Verdict",
    "compare_fixed_steps",
    "criteria_of",
]
