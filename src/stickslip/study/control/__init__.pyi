# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from dataclasses import dataclass

from collections.abc import Callable as _Callable
from collections.abc import Mapping as _Mapping
from stickslip.friction import FrictionLaw as _FrictionLaw
from stickslip.mechanisms import Mechanism as _Mechanism
from stickslip.quantities import Given as _Given
from stickslip.study.control.feedback_loop import ClosedLoop as ClosedLoop
from stickslip.study.control.feedback_loop import Controller as Controller
from stickslip.study.control.feedback_loop import Controller as _Controller
from stickslip.study.control.feedback_loop import Dynamics as Dynamics
from stickslip.study.control.feedback_loop import FrictionCompensation as _FrictionCompensation
from stickslip.study.control.feedback_loop import LimitCycle as LimitCycle
from stickslip.study.control.feedback_loop import Load as _Load
from stickslip.study.control.feedback_loop import PID as _PID
from stickslip.study.control.feedback_loop import PartialLinearisation as _PartialLinearisation
from stickslip.study.control.feedback_loop import Signal as _Signal
from stickslip.study.control.feedback_loop import closed_loop as closed_loop
from stickslip.study.control.feedback_loop import compensation as compensation
from stickslip.study.control.feedback_loop import drive_places as drive_places
from stickslip.study.control.feedback_loop import dynamics_at as dynamics_at
from stickslip.study.control.feedback_loop import limit_cycle as limit_cycle

@dataclass(frozen=True, kw_only=True, init=False)
class FrictionCompensation(_FrictionCompensation):
    def __init__(
        self,
        *,
        law: _FrictionLaw,
        width: _Given,
        factor: _Given = ...,
        load: _Load = ...,
        inputs: _Mapping[str, _Load] = ...,
        velocity: str | _Callable[[float], float] = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PID(_PID):
    def __init__(
        self,
        *,
        proportional: _Given,
        integral: _Given = ...,
        derivative: _Given = ...,
        reference: _Signal = ...,
        reference_rate: _Signal = ...,
        state: str = ...,
        rate: str | None = ...,
        filter_time: _Given = ...,
        limit: _Given | None = ...,
        tracking_time: _Given | None = ...,
        feedforward: _Controller | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class PartialLinearisation(_PartialLinearisation):
    def __init__(
        self,
        *,
        mechanism: _Mechanism,
        law: _FrictionLaw,
        track: str,
        stiffness: _Given,
        damping: _Given,
        reference: _Signal = ...,
        reference_rate: _Signal = ...,
        reference_acceleration: _Signal = ...,
        drive: str | None = ...,
        rest_speed: _Given = ...,
        least: _Given = ...,
    ) -> None: ...

__all__ = [
    "ClosedLoop",
    "Controller",
    "Dynamics",
    "FrictionCompensation",
    "LimitCycle",
    "PID",
    "PartialLinearisation",
    "closed_loop",
    "compensation",
    "dynamics_at",
    "limit_cycle",
]
