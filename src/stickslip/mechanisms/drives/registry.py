"""The drives by name."""

from collections.abc import Mapping
from types import MappingProxyType

from stickslip.mechanisms.drives.base import Drive
from stickslip.mechanisms.drives.elementary import (
    HalfSine,
    PiecewiseLinear,
    Pulse,
    Ramp,
    Sampled,
    Sine,
    Square,
)
from stickslip.mechanisms.drives.motion_profiles import (
    Profile,
    Rotation,
    SampledSwing,
    SevenStep,
    SineSwing,
    SplineSwing,
    ThreePhase,
    TimedThreePhase,
)

DRIVES: Mapping[str, type[Drive]] = MappingProxyType(
    {
        "half-sine": HalfSine,
        "piecewise-linear": PiecewiseLinear,
        "pulse": Pulse,
        "ramp": Ramp,
        "sampled": Sampled,
        "sine": Sine,
        "square": Square,
    }
)
"""The drives that come with the package, by the ``type`` they have in rig files.

Sums have no name of their own: a list of drives is their sum.
"""

PROFILES: Mapping[str, type[Profile]] = MappingProxyType(
    {
        "rotation": Rotation,
        "sampled-swing": SampledSwing,
        "seven-step": SevenStep,
        "sine-swing": SineSwing,
        "spline-swing": SplineSwing,
        "three-phase": ThreePhase,
        "timed-three-phase": TimedThreePhase,
    }
)
"""The motion profiles that come with the package, by the ``type`` they have in rig files."""
