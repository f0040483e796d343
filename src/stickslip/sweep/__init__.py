"""Campaigns over many runs: mean motion, bifurcations, basins of attraction."""

from stickslip.mechanisms.cycles import cycle_of
from stickslip.sweep.average import VelocityMap, average_velocity
from stickslip.sweep.bands import Band, Spread, band_of
from stickslip.sweep.basins import Attractor, Basins, basins
from stickslip.sweep.bifurcation import Bifurcation, bifurcation
from stickslip.sweep.cycles import DrivenCycle, cycles_in

__all__ = [
    "Attractor",
    "Band",
    "Basins",
    "Bifurcation",
    "DrivenCycle",
    "Spread",
    "VelocityMap",
    "average_velocity",
    "band_of",
    "basins",
    "bifurcation",
    "cycle_of",
    "cycles_in",
]
