# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.identify import fits as fits
from stickslip.identify import kinds as kinds
from stickslip.identify.bands import Foreseen as Foreseen
from stickslip.identify.bands import Interval as Interval
from stickslip.identify.bands import PredictionBand as PredictionBand
from stickslip.identify.bands import RunCertificate as RunCertificate
from stickslip.identify.candidates import Verdict as Verdict
from stickslip.identify.candidates import Wording as Wording
from stickslip.identify.criteria import Criteria as Criteria
from stickslip.identify.criteria import FixedStepRow as FixedStepRow
from stickslip.identify.criteria import compare_fixed_steps as compare_fixed_steps
from stickslip.identify.criteria import criteria_of as criteria_of
from stickslip.identify.criteria import largest_step as largest_step
from stickslip.identify.figures import BandDrawing as BandDrawing
from stickslip.identify.figures import draw_joints as draw_joints
from stickslip.identify.figures import plot_band as plot_band
from stickslip.identify.fits import Estimate as Estimate
from stickslip.identify.fits import Fit as Fit
from stickslip.identify.fitting import fitted_law as fitted_law
from stickslip.identify.joints import JointLawFit as JointLawFit
from stickslip.identify.joints import JointVerdict as JointVerdict
from stickslip.identify.joints import fit_joints as fit_joints
from stickslip.identify.joints import joint_sections as joint_sections
from stickslip.identify.joints import select_joints as select_joints
from stickslip.identify.kinds import Plan as Plan
from stickslip.identify.kinds import SimulatedFit as SimulatedFit
from stickslip.identify.kinds import SimulatedVerdict as SimulatedVerdict
from stickslip.identify.kinds import TravelFit as TravelFit
from stickslip.identify.kinds import TravelVerdict as TravelVerdict
from stickslip.identify.ladder import ladder_rows as ladder_rows
from stickslip.identify.ladder import probability_text as probability_text
from stickslip.identify.laws import CurvePoint as CurvePoint
from stickslip.identify.laws import MeasuredCurve as MeasuredCurve
from stickslip.identify.laws import MeasuredCurves as MeasuredCurves
from stickslip.identify.page import sections_of as sections_of
from stickslip.identify.page import verdict_sections as verdict_sections
from stickslip.identify.problems.record_checks import sign_findings as sign_findings
from stickslip.identify.problems.travels import INSENSITIVE as INSENSITIVE
from stickslip.identify.problems.travels import TravelJudgement as TravelJudgement
from stickslip.identify.problems.travels import USUAL_LAWS as USUAL_LAWS
from stickslip.identify.problems.travels import band_of as band_of
from stickslip.identify.problems.travels import judged_travels as judged_travels
from stickslip.identify.selection import select_record as select_record
from stickslip.identify.selection import select_table as select_table
from stickslip.identify.thresholds import THRESHOLDS as THRESHOLDS
from stickslip.identify.verdict import BandVerdict as BandVerdict
from stickslip.identify.verdict import LawCandidate as LawCandidate
from stickslip.identify.verdict import LawFit as LawFit
from stickslip.identify.verdict import importance as importance
from stickslip.identify.wording import parameter_sentence as parameter_sentence

__all__ = [
    "Criteria",
    "FixedStepRow",
    "compare_fixed_steps",
    "criteria_of",
    "BandVerdict",
    "Estimate",
    "Fit",
    "Foreseen",
    "Interval",
    "JointVerdict",
    "LawCandidate",
    "LawFit",
    "Plan",
    "PredictionBand",
    "RunCertificate",
    "SimulatedFit",
    "SimulatedVerdict",
    "TravelFit",
    "TravelVerdict",
    "Verdict",
    "fits",
    "kinds",
]
