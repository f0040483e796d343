# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from dataclasses import dataclass

from stickslip.quantities import Given as _Given
from stickslip.solver.backend import Equations as Equations
from stickslip.solver.block_diagram import BreakAway as BreakAway
from stickslip.solver.block_diagram import BreakAway as _BreakAway
from stickslip.solver.block_diagram import SoftConstraint as _SoftConstraint
from stickslip.solver.compile.modules import Progress as Progress
from stickslip.solver.compile.modules import WarmUp as WarmUp
from stickslip.solver.compile.modules import notice as notice
from stickslip.solver.compile.modules import object_files as object_files
from stickslip.solver.compile.modules import warm_up as warm_up
from stickslip.solver.compile.states import observe as observe
from stickslip.solver.compile.states import states_along as states_along
from stickslip.solver.ensembles import as_numbers as as_numbers
from stickslip.solver.ensembles import check_columns as check_columns
from stickslip.solver.ensembles import run_ensemble as run_ensemble
from stickslip.solver.event_driven import BareRun as BareRun
from stickslip.solver.event_driven import EventDriven as _EventDriven
from stickslip.solver.event_driven import status_of as status_of
from stickslip.solver.fixed_step import FixedStep as _FixedStep
from stickslip.solver.fixed_step import Method as Method
from stickslip.solver.fixed_step import Method as _Method
from stickslip.solver.incremental import IncrementalEnsemble as IncrementalEnsemble
from stickslip.solver.incremental import IncrementalRun as IncrementalRun
from stickslip.solver.reducers import EventCount as EventCount
from stickslip.solver.reducers import EventTimes as EventTimes
from stickslip.solver.reducers import Final as Final
from stickslip.solver.reducers import Max as Max
from stickslip.solver.reducers import Mean as Mean
from stickslip.solver.reducers import Min as Min
from stickslip.solver.reducers import Output as Output
from stickslip.solver.reducers import Samples as Samples
from stickslip.solver.reducers import Sensitivity as Sensitivity
from stickslip.solver.reducers import reasons as reasons
from stickslip.solver.run import Solver as Solver
from stickslip.solver.run import Tier as _Tier
from stickslip.solver.run import column_units as column_units
from stickslip.solver.run import path_units as path_units
from stickslip.solver.run import prepare as prepare
from stickslip.solver.starts import gather as gather
from stickslip.solver.starts import within_stops as within_stops

@dataclass(frozen=True, kw_only=True, init=False)
class EventDriven(_EventDriven):
    def __init__(
        self,
        *,
        tolerance: _Given | None = ...,
        stiff_tolerance: _Given | None = ...,
        max_steps: _Given = ...,
        estimate_error: bool = ...,
        tier: _Tier = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class FixedStep(_FixedStep):
    soft: SoftConstraint | None = ...
    def __init__(
        self,
        *,
        dt: _Given,
        method: _Method = ...,
        stick_rule: bool | None = ...,
        break_away: _BreakAway | None = ...,
        zero_velocity_band: _Given = ...,
        soft: _SoftConstraint | None = ...,
        viscous: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SoftConstraint(_SoftConstraint):
    def __init__(
        self,
        *,
        impedance: _Given,
        damping: _Given,
    ) -> None: ...

__all__ = [
    "BreakAway",
    "EventCount",
    "EventDriven",
    "EventTimes",
    "Final",
    "FixedStep",
    "Max",
    "Mean",
    "Method",
    "Min",
    "Output",
    "Progress",
    "Samples",
    "Sensitivity",
    "SoftConstraint",
    "Solver",
    "WarmUp",
    "prepare",
    "warm_up",
]
