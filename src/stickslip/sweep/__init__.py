"""Many runs: campaigns, sensitivity indices, mean motion, bifurcations, basins of attraction."""

from stickslip.mechanisms import cycle_of
from stickslip.sweep.bands import Band, Spread, band_of
from stickslip.sweep.basins import Attractor, Basins, basins
from stickslip.sweep.bifurcation import Bifurcation, bifurcation
from stickslip.sweep.campaign import Campaign, CampaignRuns, Case, Estimate, campaign
from stickslip.sweep.cycles import DrivenCycle, cycles_in
from stickslip.sweep.design import Design, Factor, Levels, Normal, Uniform
from stickslip.sweep.mean_velocity import VelocityMap, average_velocity
from stickslip.sweep.refit import ParameterAgreement, Refit, compare_estimates
from stickslip.sweep.sensitivity_indices import SensitivityIndices
from stickslip.sweep.validation import ValidatedRecord, ValidatedTravel, Validation, validate

__all__ = [
    "Attractor",
    "Band",
    "Basins",
    "Bifurcation",
    "Campaign",
    "CampaignRuns",
    "Case",
    "Design",
    "DrivenCycle",
    "Estimate",
    "Factor",
    "Levels",
    "Normal",
    "ParameterAgreement",
    "Refit",
    "SensitivityIndices",
    "Spread",
    "Uniform",
    "ValidatedRecord",
    "ValidatedTravel",
    "Validation",
    "VelocityMap",
    "average_velocity",
    "band_of",
    "basins",
    "bifurcation",
    "campaign",
    "compare_estimates",
    "cycle_of",
    "cycles_in",
    "validate",
]


def __dir__() -> list[str]:
    return sorted(__all__)
