# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from dataclasses import dataclass

from stickslip.engine.solver import EventDriven as _EventDriven
from stickslip.exports.adapters.environments import CAPSULE as CAPSULE
from stickslip.exports.adapters.environments import CART as CART
from stickslip.exports.adapters.environments import MotorEnvironment as MotorEnvironment
from stickslip.exports.adapters.environments import MotorTask as _MotorTask
from stickslip.exports.adapters.environments import MotorVectorEnvironment as MotorVectorEnvironment
from stickslip.exports.adapters.environments import register_environments as register_environments
from stickslip.friction import FrictionLaw as _FrictionLaw
from stickslip.mechanisms import Mechanism as _Mechanism
from stickslip.quantities import Given as _Given

@dataclass(frozen=True, kw_only=True, init=False)
class MotorTask(_MotorTask):
    def __init__(
        self,
        *,
        mechanism: _Mechanism,
        law: _FrictionLaw,
        effort_limit: _Given,
        position_limit: _Given,
        rate_limit: _Given,
        speed_bound: _Given,
        work_weight: _Given,
        period: _Given = ...,
        duration: _Given = ...,
        start_spread: _Given = ...,
        solver: _EventDriven = ...,
    ) -> None: ...

__all__ = [
    "CAPSULE",
    "CART",
    "MotorEnvironment",
    "MotorTask",
    "MotorVectorEnvironment",
    "register_environments",
]
