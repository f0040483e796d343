"""Mechanisms: equations of motion without friction, each one a file."""

from stickslip.mechanisms.actuators import MOTORS, Motor, Prescribed, Torque
from stickslip.mechanisms.axis import Axis
from stickslip.mechanisms.base import (
    BoundedMechanism,
    Contact,
    Guide,
    Mechanism,
    Stop,
    stops_between,
    stops_of,
)
from stickslip.mechanisms.capsule import Capsule
from stickslip.mechanisms.contacts import slip_names, static_normal_force
from stickslip.mechanisms.matrix_mechanism import MatrixMechanism
from stickslip.mechanisms.pendulum import Pendulum
from stickslip.mechanisms.pendulum_cart import PendulumCart
from stickslip.mechanisms.registry import MECHANISMS, mechanisms
from stickslip.mechanisms.spring_block import SpringBlock
from stickslip.mechanisms.towed_block import TowedBlock
from stickslip.mechanisms.two_mass_axis import TwoMassAxis

__all__ = [
    "MECHANISMS",
    "MOTORS",
    "Axis",
    "BoundedMechanism",
    "Capsule",
    "Contact",
    "Guide",
    "MatrixMechanism",
    "Mechanism",
    "Motor",
    "Pendulum",
    "PendulumCart",
    "Prescribed",
    "SpringBlock",
    "Stop",
    "Torque",
    "TowedBlock",
    "TwoMassAxis",
    "mechanisms",
    "slip_names",
    "static_normal_force",
    "stops_between",
    "stops_of",
]
