# Written by tools/stubs.py from the table in __init__.py; renew it by `make stubs`.
from stickslip.drives.base import BEGINNING as BEGINNING
from stickslip.drives.base import Drive as Drive
from stickslip.drives.base import Piece as Piece
from stickslip.drives.base import Straight as Straight
from stickslip.drives.base import Sum as Sum
from stickslip.drives.elementary import PiecewiseAffine as PiecewiseAffine
from stickslip.drives.elementary import PiecewiseLinear as PiecewiseLinear
from stickslip.drives.elementary import Pulse as Pulse
from stickslip.drives.elementary import Ramp as Ramp
from stickslip.drives.elementary import Sampled as Sampled
from stickslip.drives.elementary import Sine as Sine
from stickslip.drives.elementary import Square as Square
from stickslip.drives.motion_profiles import Profile as Profile
from stickslip.drives.motion_profiles import SevenStep as SevenStep
from stickslip.drives.motion_profiles import SineSwing as SineSwing
from stickslip.drives.motion_profiles import SplineSwing as SplineSwing
from stickslip.drives.motion_profiles import ThreePhase as ThreePhase
from stickslip.drives.registry import DRIVES as DRIVES
from stickslip.drives.registry import PROFILES as PROFILES

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
