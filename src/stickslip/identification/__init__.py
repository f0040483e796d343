"""Identification: parameters from measurements, with their doubt."""

from stickslip.friction import RateState
from stickslip.identification.features.features import StickSlipFeatures, features_of
from stickslip.identification.features.fit import compare_features, fit_features
from stickslip.identification.features.result import FeatureFit
from stickslip.identification.rate_state.fit import fit_rate_state
from stickslip.identification.rate_state.result import RateStateFit
from stickslip.identification.rate_state.slider import SliderHistory, simulate_velocity_steps
from stickslip.identification.records.fit import Prediction, RecordFit, Score
from stickslip.identification.records.fitting import fit_records
from stickslip.identification.records.posterior import Posterior, sample_posterior
from stickslip.identification.records.settings import RecordSettings
from stickslip.identification.results import Estimate, Fit
from stickslip.identification.series.inverse_dynamics import InverseDynamics, inverse_dynamics
from stickslip.identification.travels.fit import fit_travels
from stickslip.identification.travels.result import TravelFit
from stickslip.identification.travels.start_values import starting_law
from stickslip.identification.trials.comparison import TrialComparison, compare_trials

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
    "fit_features",
    "fit_rate_state",
    "fit_records",
    "fit_travels",
    "inverse_dynamics",
    "sample_posterior",
    "simulate_velocity_steps",
    "starting_law",
]
