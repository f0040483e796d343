"""The drives by name."""

from collections.abc import Mapping
from types import MappingProxyType

from stickslip.mechanisms.drives import elementary, motion_profiles
from stickslip.mechanisms.drives.base import Drive

DRIVES: Mapping[str, type[Drive]] = MappingProxyType(
    {
        "half-sine": elementary.HalfSine,
        "piecewise-linear": elementary.PiecewiseLinear,
        "pulse": elementary.Pulse,
        "ramp": elementary.Ramp,
        "sampled": elementary.Sampled,
        "sine": elementary.Sine,
        "square": elementary.Square,
    }
)
"""The drives that come with the package, by the ``type`` they have in rig files.

Sums have no name of their own: a list of drives is their sum.
"""

PROFILES: Mapping[str, type[motion_profiles.Profile]] = MappingProxyType(
    {
        "rotation": motion_profiles.Rotation,
        "sampled-swing": motion_profiles.SampledSwing,
        "seven-step": motion_profiles.SevenStep,
        "sine-swing": motion_profiles.SineSwing,
        "spline-swing": motion_profiles.SplineSwing,
        "three-phase": motion_profiles.ThreePhase,
        "timed-three-phase": motion_profiles.TimedThreePhase,
    }
)
"""The motion profiles that come with the package, by the ``type`` they have in rig files."""
