"""How records are fitted, and how a force channel shows a force."""

import numbers
from dataclasses import dataclass, fields
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ParameterError, UnknownNameError, not_whole
from stickslip.show.described import Described

Array = NDArray[np.float64]

Hold: TypeAlias = Literal["zero", "first"]
"""What an applied force does between samples: keeps its value, or goes straight to the next."""
RESOLUTION = 100
"""Rows at which a segment is compared, pieces its drive has, and poses and stretches of a record
that are looked at, at most."""
BLOCKS = 8
"""Blocks of a record between which residuals count as independent."""

# What several rules ask alike has one answer.
ROUNDING = 1e-9
"""Share by which numbers differ that are the same but for their units and for sums."""
NEGLIGIBLE = 1e-7
"""Share below which slopes, and singular values of slopes, are not told from 0: they are exact to
seven or eight digits."""
TAKES_PART = 0.01
"""Share of a direction from which a parameter takes part in it, and of a slope that is its own."""
SETTLED = 1e-4
"""Share by which a step lowers a cost, or changes values, at which an iteration ends."""
ROUNDS = 200
"""Steps of an iteration at most: all end by themselves."""
STEP = 1e-3
"""Share by which a parameter of a mechanism is moved to see what depends on it: neither the error
of a run, 1e-8, nor curvature changes more than the third digit of a difference."""
MOST = 0.5
"""Share of a force that explains it: where a balance leaves more, it says nothing of its parts."""
CHANCE = 0.05
"""Chance with which an interval misses, and with which a test finds what is not there."""
SURE = 3.0
"""Standard errors from 0 beyond which a single number is something."""


@dataclass(frozen=True, kw_only=True)
class RecordSettings(metaclass=Described):
    """How records are fitted."""

    hold: Hold | None = None
    """``"zero"`` if a force keeps its value until the next sample, ``"first"`` if it goes straight
    there, None if that is to be estimated from the record.

    Measured friction has no force beside it.
    """
    starts: int = 1
    """Searches of a law by runs that are followed to their end."""
    seed: int = 0
    """Of the draws of laws by runs."""
    position_zeros: bool | None = None
    """Whether positions of each record count from a place that is not known, as where encoders are
    set to 0 wherever an arm rests; for records of several joints, whose constant forces are then
    0. None is no."""

    @property
    def changed(self) -> tuple[str, ...]:
        """Names of the settings that differ from the usual ones."""
        return tuple(f.name for f in fields(self) if getattr(self, f.name) != f.default)

    def __post_init__(self) -> None:
        """Check all: a hold that is not known would pass for ``"zero"``."""
        for name, least in (("starts", 1), ("seed", 0)):
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
