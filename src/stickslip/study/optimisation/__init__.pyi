# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.study.optimisation.search import Cycle as Cycle
from stickslip.study.optimisation.search import GOALS as GOALS
from stickslip.study.optimisation.search import Goal as Goal
from stickslip.study.optimisation.search import GoalName as GoalName
from stickslip.study.optimisation.search import Margin as Margin
from stickslip.study.optimisation.search import Motion as Motion
from stickslip.study.optimisation.search import Optimum as Optimum
from stickslip.study.optimisation.search import Scenario as Scenario
from stickslip.study.optimisation.search import known_paths as known_paths
from stickslip.study.optimisation.search import measure as measure
from stickslip.study.optimisation.search import optimise as optimise
from stickslip.study.optimisation.search import travelling as travelling
from stickslip.study.optimisation.search import units_of as units_of

__all__ = [
    "Cycle",
    "GOALS",
    "Goal",
    "Margin",
    "Motion",
    "Optimum",
    "measure",
    "optimise",
]
