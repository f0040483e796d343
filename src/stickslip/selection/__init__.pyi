# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.selection.applicability import checked as checked
from stickslip.selection.candidates import LEFT_OUT as LEFT_OUT
from stickslip.selection.candidates import Watch as Watch
from stickslip.selection.candidates import check_any as check_any
from stickslip.selection.candidates import check_apart as check_apart
from stickslip.selection.candidates import specifications as specifications
from stickslip.selection.choice import ALIKE as ALIKE
from stickslip.selection.choice import APART as APART
from stickslip.selection.choice import NEAR as NEAR
from stickslip.selection.choice import apart as apart
from stickslip.selection.choice import as_good as as_good
from stickslip.selection.choice import choose as choose
from stickslip.selection.choice import effective_aic as effective_aic
from stickslip.selection.choice import errs_more as errs_more
from stickslip.selection.criteria import Criteria as Criteria
from stickslip.selection.criteria import criteria_of as criteria_of
from stickslip.selection.cross_validation import CrossValidated as CrossValidated
from stickslip.selection.cross_validation import CrossValidatedVerdict as CrossValidatedVerdict
from stickslip.selection.cross_validation import CrossValidation as CrossValidation
from stickslip.selection.design.experiments import Experiment as Experiment
from stickslip.selection.design.predictors import Steady as Steady
from stickslip.selection.fixed_step_comparison import FixedStepRow as FixedStepRow
from stickslip.selection.fixed_step_comparison import compare_fixed_steps as compare_fixed_steps
from stickslip.selection.fixed_step_comparison import largest_step as largest_step
from stickslip.selection.fixed_step_comparison import rounded_step as rounded_step
from stickslip.selection.given_levels import given_level as given_level
from stickslip.selection.given_levels import given_text as given_text
from stickslip.selection.given_levels import level_text as level_text
from stickslip.selection.identifiable import limit_of as limit_of
from stickslip.selection.identifiable import limits_of as limits_of
from stickslip.selection.identifiable import moved_by_errors as moved_by_errors
from stickslip.selection.identifiable import settled_estimates as settled_estimates
from stickslip.selection.identifiable import traded as traded
from stickslip.selection.joint_verdict import JointVerdict as JointVerdict
from stickslip.selection.joint_verdict import joint_label as joint_label
from stickslip.selection.joint_verdict import short_verdict as short_verdict
from stickslip.selection.joints import joint_specifications as joint_specifications
from stickslip.selection.joints import select_joints as select_joints
from stickslip.selection.ladder import climbed as climbed
from stickslip.selection.next_measurements import predictor_of as predictor_of
from stickslip.selection.parallel_fit import fitted_side_by_side as fitted_side_by_side
from stickslip.selection.parallel_fit import watched as watched
from stickslip.selection.record_admissibility import standard_uncertainty as standard_uncertainty
from stickslip.selection.record_verdict import RecordCandidate as RecordCandidate
from stickslip.selection.record_verdict import RecordVerdict as RecordVerdict
from stickslip.selection.record_verdict import SecondRecord as SecondRecord
from stickslip.selection.record_wording import error_text as error_text
from stickslip.selection.record_wording import restarts_text as restarts_text
from stickslip.selection.record_wording import route_text as route_text
from stickslip.selection.records import PURPOSES as PURPOSES
from stickslip.selection.records import PurposeName as PurposeName
from stickslip.selection.records import ROUNDING as ROUNDING
from stickslip.selection.records import aim_of as aim_of
from stickslip.selection.records import candidate_of as candidate_of
from stickslip.selection.records import judged_of as judged_of
from stickslip.selection.records import laws_for as laws_for
from stickslip.selection.records import select_records as select_records
from stickslip.selection.records import until_stopped as until_stopped
from stickslip.selection.records import verdict_on as verdict_on
from stickslip.selection.records import way_for as way_for
from stickslip.selection.records import with_contained as with_contained
from stickslip.selection.records import without_stated as without_stated
from stickslip.selection.verdict import Candidate as Candidate
from stickslip.selection.verdict import Verdict as Verdict
from stickslip.selection.verdict import Wording as Wording
from stickslip.selection.verdict import plain as plain
from stickslip.selection.verdict import score_scale as score_scale
from stickslip.selection.verdict import score_text as score_text
from stickslip.selection.wording import NOT_DISTINGUISHED as NOT_DISTINGUISHED
from stickslip.selection.wording import ONE_LAW as ONE_LAW
from stickslip.selection.wording import UNMEASURED as UNMEASURED
from stickslip.selection.wording import corrections as corrections
from stickslip.selection.wording import friction_of as friction_of
from stickslip.selection.wording import held_out_text as held_out_text
from stickslip.selection.wording import in_sentence as in_sentence
from stickslip.selection.wording import longer as longer
from stickslip.selection.wording import not_distinguished as not_distinguished
from stickslip.selection.wording import on_second_record as on_second_record
from stickslip.selection.wording import to_predict as to_predict

__all__ = [
    "Candidate",
    "Criteria",
    "FixedStepRow",
    "JointVerdict",
    "PURPOSES",
    "RecordCandidate",
    "RecordVerdict",
    "Verdict",
    "compare_fixed_steps",
    "criteria_of",
    "select_joints",
    "select_records",
]
