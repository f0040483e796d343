"""Drives: forces, torques and motions as functions of time."""

from stickslip.drives.base import Drive, Piece, Sum
from stickslip.drives.forms import PiecewiseLinear, Pulse, Ramp, Sampled, Sine, StraightPieces

__all__ = [
    "Drive",
    "Piece",
    "PiecewiseLinear",
    "Pulse",
    "Ramp",
    "Sampled",
    "Sine",
    "StraightPieces",
    "Sum",
]
