"""Many runs: campaigns, sensitivity indices, mean motion, periodic orbits, bifurcations, basins."""

from stickslip.mechanisms import cycle_of
from stickslip.study.sweep.bands import Band, Spread, band_of
from stickslip.study.sweep.bifurcation import (
    Attractor,
    Basins,
    Bifurcation,
    DrivenCycle,
    basins,
    bifurcation,
    cycles_in,
)
from stickslip.study.sweep.campaign import Campaign, CampaignRuns, Case, Estimate, campaign
from stickslip.study.sweep.continuation import (
    Branch,
    BranchEvent,
    continue_orbit,
)
from stickslip.study.sweep.design import Design, Factor, Levels, Normal, SensitivityIndices, Uniform
from stickslip.study.sweep.mean_velocity import (
    VelocityBand,
    VelocityMap,
    average_velocity,
    velocity_band,
)
from stickslip.study.sweep.orbit_diagram import OrbitDiagram, orbit_diagram
from stickslip.study.sweep.orbits import Orbit, periodic_orbit
from stickslip.study.sweep.refit import ParameterAgreement, Refit, compare_estimates
from stickslip.study.sweep.validation import ValidatedRecord, ValidatedTravel, Validation, validate

__all__ = [
    "Attractor",
    "Band",
    "Basins",
    "Bifurcation",
    "Branch",
    "BranchEvent",
    "Campaign",
    "CampaignRuns",
    "Case",
    "Design",
    "DrivenCycle",
    "Estimate",
    "Factor",
    "Levels",
    "Normal",
    "Orbit",
    "OrbitDiagram",
    "ParameterAgreement",
    "Refit",
    "SensitivityIndices",
    "Spread",
    "Uniform",
    "ValidatedRecord",
    "ValidatedTravel",
    "Validation",
    "VelocityBand",
    "VelocityMap",
    "average_velocity",
    "band_of",
    "basins",
    "bifurcation",
    "campaign",
    "compare_estimates",
    "continue_orbit",
    "cycle_of",
    "cycles_in",
    "orbit_diagram",
    "periodic_orbit",
    "validate",
    "velocity_band",
]


def __dir__() -> list[str]:
    return sorted(__all__)
