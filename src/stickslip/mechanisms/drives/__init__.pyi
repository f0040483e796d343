# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from dataclasses import dataclass

from stickslip.mechanisms.drives.base import BEGINNING as BEGINNING
from stickslip.mechanisms.drives.base import Drive as Drive
from stickslip.mechanisms.drives.base import Piece as Piece
from stickslip.mechanisms.drives.base import Straight as Straight
from stickslip.mechanisms.drives.base import Sum as Sum
from stickslip.mechanisms.drives.base import parts_of as parts_of
from stickslip.mechanisms.drives.feedback import DelayedFeedback as _DelayedFeedback
from stickslip.mechanisms.drives.feedback import Feedback as _Feedback
from stickslip.mechanisms.drives.feedback import Relay as _Relay
from stickslip.mechanisms.drives.feedback import is_delayed as is_delayed
from stickslip.mechanisms.drives.feedback import without_delays as without_delays
from stickslip.mechanisms.drives.shapes import DRIVES as DRIVES
from stickslip.mechanisms.drives.shapes import HalfSine as _HalfSine
from stickslip.mechanisms.drives.shapes import PROFILES as PROFILES
from stickslip.mechanisms.drives.shapes import PiecewiseAffine as PiecewiseAffine
from stickslip.mechanisms.drives.shapes import PiecewiseLinear as PiecewiseLinear
from stickslip.mechanisms.drives.shapes import Profile as Profile
from stickslip.mechanisms.drives.shapes import Pulse as _Pulse
from stickslip.mechanisms.drives.shapes import Ramp as _Ramp
from stickslip.mechanisms.drives.shapes import Rotation as _Rotation
from stickslip.mechanisms.drives.shapes import Sampled as Sampled
from stickslip.mechanisms.drives.shapes import SampledSwing as _SampledSwing
from stickslip.mechanisms.drives.shapes import SevenStep as _SevenStep
from stickslip.mechanisms.drives.shapes import Sine as _Sine
from stickslip.mechanisms.drives.shapes import SineSwing as _SineSwing
from stickslip.mechanisms.drives.shapes import SplineSwing as _SplineSwing
from stickslip.mechanisms.drives.shapes import Square as _Square
from stickslip.mechanisms.drives.shapes import ThreePhase as _ThreePhase
from stickslip.mechanisms.drives.shapes import TimedThreePhase as _TimedThreePhase
from stickslip.quantities import Given as _Given
from typing import Literal as _Literal

@dataclass(frozen=True, kw_only=True, init=False)
class DelayedFeedback(_DelayedFeedback):
    def __init__(
        self,
        *,
        state: str,
        gain: _Given,
        delay: _Given,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Feedback(_Feedback):
    def __init__(
        self,
        *,
        state: str,
        gain: _Given,
        reference: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class HalfSine(_HalfSine):
    def __init__(
        self,
        *,
        amplitude: _Given,
        period: _Given,
        duty: _Given = ...,
        start: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Pulse(_Pulse):
    def __init__(
        self,
        *,
        level: _Given,
        duration: _Given,
        start: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Ramp(_Ramp):
    def __init__(
        self,
        *,
        rate: _Given,
        start: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Relay(_Relay):
    def __init__(
        self,
        *,
        state: str,
        above: _Given,
        below: _Given,
        level: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Rotation(_Rotation):
    def __init__(
        self,
        *,
        rate: _Given,
        start: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SampledSwing(_SampledSwing):
    def __init__(
        self,
        *,
        times: tuple[float, ...],
        positions: tuple[float, ...],
        spacing: _Given | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SevenStep(_SevenStep):
    def __init__(
        self,
        *,
        amplitude: _Given,
        fast: _Given,
        slow: _Given,
        top_rate: _Given,
        pause: _Given = ...,
        return_rate: _Given | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Sine(_Sine):
    def __init__(
        self,
        *,
        amplitude: _Given,
        frequency: _Given,
        phase: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SineSwing(_SineSwing):
    def __init__(
        self,
        *,
        amplitude: _Given,
        frequency: _Given,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class SplineSwing(_SplineSwing):
    def __init__(
        self,
        *,
        positions: tuple[float, ...],
        duration: _Given,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class Square(_Square):
    def __init__(
        self,
        *,
        high: _Given,
        low: _Given = ...,
        period: _Given,
        duty: _Given = ...,
        start: _Given = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class ThreePhase(_ThreePhase):
    def __init__(
        self,
        *,
        amplitude: _Given,
        fast: _Given,
        slow: _Given,
        first: _Literal['fast', 'slow'] = ...,
        last: _Given | None = ...,
        frequency: _Given | None = ...,
    ) -> None: ...

@dataclass(frozen=True, kw_only=True, init=False)
class TimedThreePhase(_TimedThreePhase):
    def __init__(
        self,
        *,
        amplitude: _Given,
        first_duration: _Given,
        middle_duration: _Given,
        last_duration: _Given,
        frequency: _Given | None = ...,
    ) -> None: ...

__all__ = [
    "DelayedFeedback",
    "Feedback",
    "Relay",
    "Drive",
    "HalfSine",
    "Piece",
    "PiecewiseAffine",
    "PiecewiseLinear",
    "Profile",
    "Pulse",
    "Ramp",
    "Rotation",
    "Sampled",
    "SampledSwing",
    "SevenStep",
    "Sine",
    "SineSwing",
    "SplineSwing",
    "Square",
    "Sum",
    "ThreePhase",
    "TimedThreePhase",
]
