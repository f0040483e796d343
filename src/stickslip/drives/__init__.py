"""Drives: forces, torques and motions as functions of time."""

from stickslip.drives.algebra import Sum
from stickslip.drives.base import Drive, Piece
from stickslip.drives.forms import PiecewiseLinear, Pulse, Ramp, Sampled, Sine

__all__ = ["Drive", "Piece", "PiecewiseLinear", "Pulse", "Ramp", "Sampled", "Sine", "Sum"]
