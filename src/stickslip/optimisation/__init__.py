"""Motion profiles: which motion drives a mechanism best within limits."""

from stickslip.optimisation.cycle_metrics import Cycle, guide_of, measure, units_of_limits
from stickslip.optimisation.limits import Limits, Margin
from stickslip.optimisation.optimise import optimise_profile
from stickslip.optimisation.parametrisation import KINDS
from stickslip.optimisation.problem import GOALS, Goal, ScoredMotion
from stickslip.optimisation.result import Optimum
from stickslip.optimisation.scenarios import Scenarios

__all__ = [
    "GOALS",
    "KINDS",
    "Cycle",
    "Goal",
    "Limits",
    "Margin",
    "Optimum",
    "Scenarios",
    "ScoredMotion",
    "guide_of",
    "measure",
    "optimise_profile",
    "units_of_limits",
]
