"""Drives: forces, torques and motions as functions of time."""

from stickslip.drives.base import Drive, Piece, Sum
from stickslip.drives.elementary import (
    PiecewiseLinear,
    Pulse,
    Ramp,
    Sampled,
    Sine,
    Square,
    StraightPieces,
)
from stickslip.drives.motion_profiles import Profile, SevenStep, SineSwing, SplineSwing, ThreePhase

__all__ = [
    "Drive",
    "Piece",
    "PiecewiseLinear",
    "Profile",
    "Pulse",
    "Ramp",
    "Sampled",
    "SevenStep",
    "Sine",
    "SineSwing",
    "SplineSwing",
    "Square",
    "StraightPieces",
    "Sum",
    "ThreePhase",
]
