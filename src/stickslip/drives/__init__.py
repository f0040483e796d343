"""Drives: forces, torques and motions as functions of time."""

from stickslip.drives.base import Drive, Piece, Sum
from stickslip.drives.elementary import (
    PiecewiseAffine,
    PiecewiseLinear,
    Pulse,
    Ramp,
    Sampled,
    Sine,
    Square,
)
from stickslip.drives.motion_profiles import Profile, SevenStep, SineSwing, SplineSwing, ThreePhase

__all__ = [
    "Drive",
    "Piece",
    "PiecewiseAffine",
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
    "Sum",
    "ThreePhase",
]
