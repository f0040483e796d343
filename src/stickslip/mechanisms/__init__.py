"""Mechanisms: equations of motion without friction, each one a file."""

from stickslip.mechanisms.axis import Axis
from stickslip.mechanisms.base import (
    BoundedMechanism,
    Contact,
    Mechanism,
    Stop,
    stops_between,
    stops_of,
)
from stickslip.mechanisms.registry import MECHANISMS, mechanisms
from stickslip.mechanisms.spring_block import SpringBlock
from stickslip.mechanisms.towed_block import TowedBlock

__all__ = [
    "MECHANISMS",
    "Axis",
    "BoundedMechanism",
    "Contact",
    "Mechanism",
    "SpringBlock",
    "Stop",
    "TowedBlock",
    "mechanisms",
    "stops_between",
    "stops_of",
]
