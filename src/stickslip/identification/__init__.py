"""Identification: parameters from measurements, with their doubt."""

from stickslip.identification.fitting import fit
from stickslip.identification.results import Estimate, Fit
from stickslip.identification.starts import starting_law

__all__ = ["Estimate", "Fit", "fit", "starting_law"]
