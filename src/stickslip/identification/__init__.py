"""Identification: parameters from measurements, with their doubt."""

from stickslip.identification.feature_fit import compare_features, fit_features
from stickslip.identification.feature_result import FeatureFit
from stickslip.identification.features import StickSlipFeatures, features_of
from stickslip.identification.fitting import fit
from stickslip.identification.inverse_dynamics import InverseDynamics, inverse_dynamics
from stickslip.identification.posterior import Posterior, sample_posterior
from stickslip.identification.rate_state import RateState, SliderHistory, simulate_velocity_steps
from stickslip.identification.rate_state_fit import fit_rate_state
from stickslip.identification.rate_state_result import RateStateFit
from stickslip.identification.record_fit import Prediction, RecordFit, Score
from stickslip.identification.record_settings import RecordSettings
from stickslip.identification.results import Estimate, Fit, TravelFit
from stickslip.identification.starts import starting_law
from stickslip.identification.trial_comparison import TrialComparison, compare_trials

__all__ = [
    "Estimate",
    "FeatureFit",
    "Fit",
    "InverseDynamics",
    "Posterior",
    "Prediction",
    "RateState",
    "RateStateFit",
    "RecordFit",
    "RecordSettings",
    "Score",
    "SliderHistory",
    "StickSlipFeatures",
    "TravelFit",
    "TrialComparison",
    "compare_features",
    "compare_trials",
    "features_of",
    "fit",
    "fit_features",
    "fit_rate_state",
    "inverse_dynamics",
    "sample_posterior",
    "simulate_velocity_steps",
    "starting_law",
]
