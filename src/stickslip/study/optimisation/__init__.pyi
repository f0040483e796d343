# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from dataclasses import dataclass

from stickslip.quantities import Given as _Given
from stickslip.study.optimisation.optimise import COSTS as COSTS
from stickslip.study.optimisation.optimise import Optimum as Optimum
from stickslip.study.optimisation.optimise import ParetoFront as ParetoFront
from stickslip.study.optimisation.optimise import optimise_profile as optimise_profile
from stickslip.study.optimisation.optimise import pareto_front as pareto_front
from stickslip.study.optimisation.parametrisation import KINDS as KINDS
from stickslip.study.optimisation.parametrisation import KindName as KindName
from stickslip.study.optimisation.problem import Cycle as Cycle
from stickslip.study.optimisation.problem import GOALS as GOALS
from stickslip.study.optimisation.problem import Goal as Goal
from stickslip.study.optimisation.problem import GoalName as GoalName
from stickslip.study.optimisation.problem import Limits as _Limits
from stickslip.study.optimisation.problem import Margin as Margin
from stickslip.study.optimisation.problem import Scenarios as Scenarios
from stickslip.study.optimisation.problem import ScoredMotion as ScoredMotion
from stickslip.study.optimisation.problem import guide_of as guide_of
from stickslip.study.optimisation.problem import load_shares as load_shares
from stickslip.study.optimisation.problem import measure as measure
from stickslip.study.optimisation.problem import slip_of_body as slip_of_body
from stickslip.study.optimisation.problem import units_of_limits as units_of_limits

@dataclass(frozen=True, kw_only=True, init=False)
class Limits(_Limits):
    def __init__(
        self,
        *,
        position: _Given,
        rate: _Given,
        acceleration: _Given | None = ...,
        effort: _Given | None = ...,
        load_share: _Given = ...,
        back_slip: _Given | None = ...,
        energy: _Given | None = ...,
    ) -> None: ...

__all__ = [
    "Cycle",
    "GOALS",
    "Goal",
    "KINDS",
    "Limits",
    "Margin",
    "Optimum",
    "ParetoFront",
    "Scenarios",
    "ScoredMotion",
    "guide_of",
    "measure",
    "optimise_profile",
    "pareto_front",
    "units_of_limits",
]
