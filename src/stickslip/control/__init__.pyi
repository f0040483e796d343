# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.control.actuation import place_of as place_of
from stickslip.control.equations_of_motion import Dynamics as Dynamics
from stickslip.control.equations_of_motion import dynamics_at as dynamics_at
from stickslip.control.feedback_loop import ClosedLoop as ClosedLoop
from stickslip.control.feedback_loop import Controller as Controller
from stickslip.control.feedback_loop import closed_loop as closed_loop
from stickslip.control.friction_compensation import FrictionCompensation as FrictionCompensation
from stickslip.control.friction_compensation import compensation as compensation
from stickslip.control.limit_cycles import LimitCycle as LimitCycle
from stickslip.control.limit_cycles import limit_cycle as limit_cycle
from stickslip.control.partial_feedback_linearisation import PartialLinearisation as PartialLinearisation
from stickslip.control.pid import PID as PID

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
