"""Feedback: controllers that sample and hold, and what friction makes of them."""

from stickslip.control.compensating import FrictionCompensation, compensation
from stickslip.control.cycles import LimitCycle, limit_cycle
from stickslip.control.dynamics import Dynamics, dynamics_at
from stickslip.control.linearising import PartialLinearisation
from stickslip.control.loop import ClosedLoop, Controller, closed_loop
from stickslip.control.pid import PID

__all__ = [
    "PID",
    "ClosedLoop",
    "Controller",
    "Dynamics",
    "FrictionCompensation",
    "LimitCycle",
    "PartialLinearisation",
    "closed_loop",
    "compensation",
    "dynamics_at",
    "limit_cycle",
]
