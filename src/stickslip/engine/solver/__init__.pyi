# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from dataclasses import dataclass

from stickslip.engine.solver.backend import Equations as Equations
from stickslip.engine.solver.backend import Playback as Playback
from stickslip.engine.solver.block_diagram import BreakAway as BreakAway
from stickslip.engine.solver.block_diagram import BreakAway as _BreakAway
from stickslip.engine.solver.block_diagram import SoftConstraint as _SoftConstraint
from stickslip.engine.solver.compile.modules import Progress as Progress
from stickslip.engine.solver.compile.modules import WarmUp as WarmUp
from stickslip.engine.solver.compile.modules import object_files as object_files
from stickslip.engine.solver.compile.modules import warm_up as warm_up
from stickslip.engine.solver.delays import lines_of as lines_of
from stickslip.engine.solver.ensembles import IncrementalEnsemble as IncrementalEnsemble
from stickslip.engine.solver.ensembles import IncrementalRun as IncrementalRun
from stickslip.engine.solver.ensembles import as_numbers as as_numbers
from stickslip.engine.solver.ensembles import check_columns as check_columns
from stickslip.engine.solver.ensembles import run_ensemble as run_ensemble
from stickslip.engine.solver.event_driven import BareRun as BareRun
from stickslip.engine.solver.event_driven import EventDriven as _EventDriven
from stickslip.engine.solver.event_driven import Form as Form
from stickslip.engine.solver.event_driven import status_of as status_of
from stickslip.engine.solver.fixed_step import FixedStep as _FixedStep
from stickslip.engine.solver.fixed_step import Method as Method
from stickslip.engine.solver.fixed_step import Method as _Method
from stickslip.engine.solver.reducers import EventCount as EventCount
from stickslip.engine.solver.reducers import EventTimes as EventTimes
from stickslip.engine.solver.reducers import Final as Final
from stickslip.engine.solver.reducers import Max as Max
from stickslip.engine.solver.reducers import Mean as Mean
from stickslip.engine.solver.reducers import Min as Min
from stickslip.engine.solver.reducers import Output as Output
from stickslip.engine.solver.reducers import Samples as Samples
from stickslip.engine.solver.reducers import Sensitivity as Sensitivity
from stickslip.engine.solver.reducers import reasons as reasons
from stickslip.engine.solver.run import Solver as Solver
from stickslip.engine.solver.run import Tier as _Tier
from stickslip.engine.solver.run import column_units as column_units
from stickslip.engine.solver.run import path_units as path_units
from stickslip.engine.solver.run import prepare as prepare
from stickslip.engine.solver.starts import gather as gather
from stickslip.engine.solver.starts import within_stops as within_stops
from stickslip.quantities import Given as _Given

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
    "IncrementalEnsemble",
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
