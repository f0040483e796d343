"""Motion profiles: which motion drives a mechanism best within limits."""

from stickslip.optimisation.cycles import Cycle, guide_of, measure, units_of_limits
from stickslip.optimisation.limits import Limits, Margin
from stickslip.optimisation.optimise import optimise_profile
from stickslip.optimisation.optimum import Optimum
from stickslip.optimisation.problem import GOALS, Goal, Judged
from stickslip.optimisation.scenarios import Scenarios
from stickslip.optimisation.spaces import KINDS

__all__ = [
    "GOALS",
    "KINDS",
    "Cycle",
    "Goal",
    "Judged",
    "Limits",
    "Margin",
    "Optimum",
    "Scenarios",
    "guide_of",
    "measure",
    "optimise_profile",
    "units_of_limits",
]
