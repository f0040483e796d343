# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.experiments import Checks as Checks
from stickslip.experiments import Finding as Finding
from stickslip.identification import Estimate as Estimate
from stickslip.identification import Fit as Fit
from stickslip.identification import RecordFit as RecordFit
from stickslip.identification import TrialComparison as TrialComparison
from stickslip.identify import BandVerdict as BandVerdict
from stickslip.identify import JointVerdict as JointVerdict
from stickslip.identify import PredictionBand as PredictionBand
from stickslip.kinds import FeatureFit as FeatureFit
from stickslip.kinds import FeatureVerdict as FeatureVerdict
from stickslip.kinds import Plan as Plan
from stickslip.kinds import RateStateFit as RateStateFit
from stickslip.kinds import RateStateVerdict as RateStateVerdict
from stickslip.kinds import TravelFit as TravelFit
from stickslip.kinds import TravelVerdict as TravelVerdict
from stickslip.optimisation import Optimum as Optimum
from stickslip.selection import Verdict as Verdict
from stickslip.solver import Sensitivity as Sensitivity
from stickslip.trajectory import Certificate as Certificate
from stickslip.trajectory import Ensemble as Ensemble
from stickslip.trajectory import Event as Event
from stickslip.trajectory import Status as Status
from stickslip.trajectory import Trajectory as Trajectory

__all__ = [
    "BandVerdict",
    "Certificate",
    "Checks",
    "Ensemble",
    "Estimate",
    "Event",
    "FeatureFit",
    "FeatureVerdict",
    "Finding",
    "Fit",
    "JointVerdict",
    "Optimum",
    "Plan",
    "PredictionBand",
    "RateStateFit",
    "RateStateVerdict",
    "RecordFit",
    "Sensitivity",
    "Status",
    "Trajectory",
    "TravelFit",
    "TravelVerdict",
    "TrialComparison",
    "Verdict",
]
