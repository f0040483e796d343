"""Feedback: controllers that sample and hold, and what friction makes of them."""

from stickslip.control.actuation import place_of
from stickslip.control.equations_of_motion import Dynamics, dynamics_at
from stickslip.control.feedback_loop import ClosedLoop, Controller, closed_loop
from stickslip.control.friction_compensation import FrictionCompensation, compensation
from stickslip.control.limit_cycles import LimitCycle, limit_cycle
from stickslip.control.partial_feedback_linearisation import PartialLinearisation
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
    "place_of",
]
