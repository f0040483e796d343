"""Solvers: the event-driven one, and the fixed step of a block diagram."""

from stickslip.solver.base import Solver
from stickslip.solver.compile.precompile import Progress, WarmUp, warm_up
from stickslip.solver.event_driven import EventDriven
from stickslip.solver.fixed_step import FixedStep, Method
from stickslip.solver.reducers import (
    EventCount,
    EventTimes,
    Final,
    Max,
    Mean,
    Min,
    Output,
    Samples,
    Sensitivity,
)
from stickslip.solver.run import prepare

__all__ = [
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
    "Solver",
    "WarmUp",
    "prepare",
    "warm_up",
]
