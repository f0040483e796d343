"""Campaigns over many runs: mean motion, bifurcations, basins of attraction."""

from stickslip.sweep.average import VelocityMap, average_velocity
from stickslip.sweep.basins import Attractor, Basins, basins
from stickslip.sweep.bifurcation import Bifurcation, bifurcation
from stickslip.sweep.cycles import cycle_of

__all__ = [
    "Attractor",
    "Basins",
    "Bifurcation",
    "VelocityMap",
    "average_velocity",
    "basins",
    "bifurcation",
    "cycle_of",
]
