"""Identification: parameters from measurements, with their doubt."""

from stickslip.identification.fitting import fit
from stickslip.identification.results import Estimate, Fit, TravelFit
from stickslip.identification.starts import starting_law

__all__ = ["Estimate", "Fit", "TravelFit", "fit", "starting_law"]
