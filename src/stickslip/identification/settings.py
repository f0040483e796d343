"""How records are fitted."""

import math
import numbers
from dataclasses import dataclass, fields
from typing import Literal, TypeAlias, get_args

from stickslip.described import Described
from stickslip.errors import ParameterError, UnknownNameError, not_whole
from stickslip.identification.sensor_response import SensorResponse
from stickslip.quantities import Quantity

Hold: TypeAlias = Literal["zero", "first"]
"""What an applied force does between samples: keeps its value, or goes straight to the next."""
RESOLUTION = 100
"""Samples a segment is compared at, and pieces its drive has, at most."""
LEAST = 8
"""Rows that a segment must have to say anything beside its initial state."""

SEGMENT = 1.0
"""Length of a segment [s] that is simulated from a state of its own."""
STARTS = 4
"""Starts of the search."""


@dataclass(frozen=True, kw_only=True)
class RecordSettings(metaclass=Described):
    """How records are fitted."""

    segment: float = SEGMENT
    """Length of a segment [s] that is simulated."""
    resolution: int = RESOLUTION
    """Rows of a segment at most, 8 or more."""
    hold: Hold | None = None
    """``"zero"`` if a force keeps its value until the next sample, ``"first"`` if it goes straight
    there, None if that is to be estimated from the record.

    Simulated segments and inverse dynamics heed it; measured friction has no force beside it.
    """
    starts: int = STARTS
    """Starts of the search."""
    seed: int = 0
    """Of the jitter of further starts."""
    position_zeros: bool | None = None
    """Whether positions of each record count from a place that is not known, as where encoders are
    set to 0 wherever an arm rests; where not given, those of a body that swings or slides freely
    do. True is for records of several joints, whose constant forces are then 0."""

    friction_delay: float = 0.0
    """Time [s] by which measured friction is recorded after the motion; below 0 if before it."""
    friction_lag: float = 0.0
    """Time constant [s] of a first-order filter of measured friction."""

    @property
    def response(self) -> SensorResponse:
        """How the force channel shows friction that was measured."""
        return SensorResponse(delay=self.friction_delay, lag=self.friction_lag)

    @property
    def holding(self) -> Hold:
        """The hold; ``"zero"``, as of commands, where none was given or estimated."""
        return self.hold or "zero"

    @property
    def changed(self) -> tuple[str, ...]:
        """Names of the settings that differ from the usual ones."""
        return tuple(f.name for f in fields(self) if getattr(self, f.name) != f.default)

    def __post_init__(self) -> None:
        """Check all: a hold that is not known would pass for ``"zero"``."""
        segment = Quantity("segment", "s", above=0).check("RecordSettings", "segment", self.segment)
        object.__setattr__(self, "segment", segment)
        for name, low in (("friction_delay", -math.inf), ("friction_lag", 0.0)):
            value = Quantity(name, "s", low=low).check("RecordSettings", name, getattr(self, name))
            object.__setattr__(self, name, value)
        for name, least in (("resolution", LEAST), ("starts", 1), ("seed", 0)):
            value = getattr(self, name)
            whole = isinstance(value, numbers.Integral) and not isinstance(value, bool)
            if not (whole and value >= least):
                raise ParameterError(not_whole(f"RecordSettings.{name}", least, value))
        if not (self.position_zeros is None or isinstance(self.position_zeros, bool)):
            raise ParameterError(
                f"RecordSettings.position_zeros must be True or False, got {self.position_zeros!r}."
            )
        if self.hold is not None and self.hold not in get_args(Hold):
            raise UnknownNameError("hold in RecordSettings", self.hold, get_args(Hold))
