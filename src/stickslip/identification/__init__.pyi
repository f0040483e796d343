# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.identification.contact_inputs import as_informed as as_informed
from stickslip.identification.contact_inputs import check_inputs as check_inputs
from stickslip.identification.contact_inputs import inputs_text as inputs_text
from stickslip.identification.contact_inputs import joint_inputs as joint_inputs
from stickslip.identification.contact_inputs import known_inputs as known_inputs
from stickslip.identification.contact_inputs import recorded_inputs as recorded_inputs
from stickslip.identification.contact_inputs import usual_values as usual_values
from stickslip.identification.contact_inputs import with_inputs as with_inputs
from stickslip.identification.estimation.estimates import bounds_met as bounds_met
from stickslip.identification.estimation.estimates import estimates_of as estimates_of
from stickslip.identification.estimation.estimates import sentences_of as sentences_of
from stickslip.identification.estimation.jackknife import BLOCKS as BLOCKS
from stickslip.identification.estimation.jackknife import Inference as Inference
from stickslip.identification.estimation.jackknife import effective_size as effective_size
from stickslip.identification.estimation.jackknife import infer as infer
from stickslip.identification.estimation.jackknife import quantile_of as quantile_of
from stickslip.identification.estimation.levenberg_marquardt import AGREE as AGREE
from stickslip.identification.estimation.levenberg_marquardt import Counter as Counter
from stickslip.identification.estimation.levenberg_marquardt import OptimizeResult as OptimizeResult
from stickslip.identification.estimation.levenberg_marquardt import Watch as Watch
from stickslip.identification.estimation.levenberg_marquardt import improve as improve
from stickslip.identification.estimation.levenberg_marquardt import search as search
from stickslip.identification.estimation.parameters import FreeParameter as FreeParameter
from stickslip.identification.estimation.parameters import FreeParameters as FreeParameters
from stickslip.identification.estimation.parameters import reads_as_forces as reads_as_forces
from stickslip.identification.estimation.parameters import required_of as required_of
from stickslip.identification.estimation.parameters import starting_law as starting_law
from stickslip.identification.estimation.parameters import told as told
from stickslip.identification.estimation.parameters import with_known as with_known
from stickslip.identification.estimation.problem import Problem as Problem
from stickslip.identification.estimation.problem import ResidualJacobian as ResidualJacobian
from stickslip.identification.estimation.problem import SubsetProblem as SubsetProblem
from stickslip.identification.force_map.data import load_along as load_along
from stickslip.identification.force_map.data import stretches_of as stretches_of
from stickslip.identification.force_map.force_balance import FilteredMotion as FilteredMotion
from stickslip.identification.force_map.force_balance import torque_along as torque_along
from stickslip.identification.force_map.gear_torques import gear_torques as gear_torques
from stickslip.identification.force_map.holds import hold_of as hold_of
from stickslip.identification.force_map.joint_balance import JointPiece as JointPiece
from stickslip.identification.force_map.joint_balance import check_joints as check_joints
from stickslip.identification.force_map.joint_balance import contacts_along as contacts_along
from stickslip.identification.force_map.joint_balance import joint_pieces as joint_pieces
from stickslip.identification.force_map.joint_balance import joint_record as joint_record
from stickslip.identification.force_map.start_values import StartEstimate as StartEstimate
from stickslip.identification.gears import transmitted_along as transmitted_along
from stickslip.identification.outliers import outlying as outlying
from stickslip.identification.outliers import without_outliers as without_outliers
from stickslip.identification.records.fit import Prediction as Prediction
from stickslip.identification.records.fit import RecordFit as RecordFit
from stickslip.identification.records.fit import Score as Score
from stickslip.identification.records.fitting import fit_records as fit_records
from stickslip.identification.records.joint_fitting import JOINTS as JOINTS
from stickslip.identification.records.joint_fitting import JointFitter as JointFitter
from stickslip.identification.records.joint_fitting import fit_joints as fit_joints
from stickslip.identification.records.route_choice import ROUTES as ROUTES
from stickslip.identification.records.route_choice import RouteName as RouteName
from stickslip.identification.records.route_choice import route_of as route_of
from stickslip.identification.results import Estimate as Estimate
from stickslip.identification.results import Fit as Fit
from stickslip.identification.results import Law_co as Law_co
from stickslip.identification.results import READINGS as READINGS
from stickslip.identification.results import estimates_for as estimates_for
from stickslip.identification.results import far_above_dry as far_above_dry
from stickslip.identification.rig_uncertainties import span_of as span_of
from stickslip.identification.rig_uncertainties import uncertainties_of as uncertainties_of
from stickslip.identification.series.applied_force import applied_force as applied_force
from stickslip.identification.series.applied_force import drives_itself as drives_itself
from stickslip.identification.series.applied_force import goes_straight as goes_straight
from stickslip.identification.series.applied_force import inside as inside
from stickslip.identification.series.inverse_dynamics import InverseDynamics as InverseDynamics
from stickslip.identification.series.inverse_dynamics import inverse_dynamics as inverse_dynamics
from stickslip.identification.series.inverse_dynamics import known_forces as known_forces
from stickslip.identification.series.measured_load import as_loaded as as_loaded
from stickslip.identification.series.start_values import load_of as load_of
from stickslip.identification.settings import ROUNDING as ROUNDING
from stickslip.identification.settings import RecordSettings as RecordSettings
from stickslip.identification.shooting.segments import segments_of as segments_of
from stickslip.identification.shooting.segments import with_drive as with_drive
from stickslip.identification.travel_model import LEAST_ERROR as LEAST_ERROR
from stickslip.identification.travel_model import TravelModel as TravelModel
from stickslip.identification.travel_model import Trial as Trial
from stickslip.identification.travel_model import driven_on as driven_on
from stickslip.identification.travel_model import durations as durations
from stickslip.identification.travel_model import is_rig as is_rig
from stickslip.identification.travel_model import quantities_read as quantities_read
from stickslip.identification.travel_model import standard_errors as standard_errors
from stickslip.identification.travel_model import trials_of as trials_of
from stickslip.identification.travel_model import under_cycles as under_cycles
from stickslip.identification.trials import ConditionLine as ConditionLine
from stickslip.identification.trials import TrialComparison as TrialComparison
from stickslip.identification.trials import compare_trials as compare_trials
from stickslip.identification.trials import compared as compared
from stickslip.identification.validation import AnyLaw as AnyLaw
from stickslip.identification.validation import LAW as LAW
from stickslip.identification.validation import Laws as Laws
from stickslip.identification.validation import Parameters as Parameters
from stickslip.identification.validation import called as called
from stickslip.identification.validation import check_given as check_given
from stickslip.identification.validation import check_varied as check_varied
from stickslip.identification.validation import covers as covers
from stickslip.identification.validation import law_quantities as law_quantities
from stickslip.identification.validation import laws_of as laws_of
from stickslip.identification.validation import names_of as names_of
from stickslip.identification.validation import refuse_of_laws as refuse_of_laws

__all__ = [
    "Estimate",
    "Fit",
    "InverseDynamics",
    "Prediction",
    "RecordFit",
    "RecordSettings",
    "Score",
    "TrialComparison",
    "compare_trials",
    "durations",
    "fit_joints",
    "fit_records",
    "inverse_dynamics",
    "starting_law",
]
