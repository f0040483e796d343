"""Identification: parameters from measurements, with their doubt."""

from stickslip.identification.fitting import fit
from stickslip.identification.inverse_dynamics import InverseDynamics, inverse_dynamics
from stickslip.identification.record_fit import Prediction, RecordFit, Score
from stickslip.identification.record_fitting import RecordSettings
from stickslip.identification.results import Estimate, Fit, TravelFit
from stickslip.identification.starts import starting_law

__all__ = [
    "Estimate",
    "Fit",
    "InverseDynamics",
    "Prediction",
    "RecordFit",
    "RecordSettings",
    "Score",
    "TravelFit",
    "fit",
    "inverse_dynamics",
    "starting_law",
]
