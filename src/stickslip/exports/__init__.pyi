# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from dataclasses import dataclass

from stickslip.engine.solver import EventDriven as _EventDriven
from stickslip.exports.applying import Applied as Applied
from stickslip.exports.applying import AppliedJoint as AppliedJoint
from stickslip.exports.applying import apply as apply
from stickslip.exports.applying import check_output as check_output
from stickslip.exports.fmu.export import compiler_here as compiler_here
from stickslip.exports.fmu.export import export_fmu as export_fmu
from stickslip.exports.gym import CAPSULE as CAPSULE
from stickslip.exports.gym import CART as CART
from stickslip.exports.gym import MotorEnvironment as MotorEnvironment
from stickslip.exports.gym import MotorTask as _MotorTask
from stickslip.exports.gym import MotorVectorEnvironment as MotorVectorEnvironment
from stickslip.exports.gym import register_environments as register_environments
from stickslip.exports.program import Export as Export
from stickslip.exports.program import Target as Target
from stickslip.exports.program import identifier as identifier
from stickslip.exports.verb import TARGETS as TARGETS
from stickslip.exports.verb import export as export
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
    "Applied",
    "AppliedJoint",
    "Export",
    "TARGETS",
    "Target",
    "apply",
    "export",
    "export_fmu",
]
