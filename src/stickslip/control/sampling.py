"""When a controller samples and what it sees, when its commands act, and the drive they make."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, TypeAlias, final

import numpy as np

from stickslip.drives import PiecewiseAffine, Sampled
from stickslip.errors import UnknownNameError
from stickslip.quantities import Parametrised, Quantity

SAME = 1e-9
"""Share of a period that counts as none: delays are multiples of it or are not."""


@final
@dataclass(frozen=True, kw_only=True)
class Timing(Parametrised):
    """Settings of a loop, checked."""

    period: Annotated[float, Quantity("T_s", "s", above=0)]
    """Time between samples [s]."""
    delay: Annotated[float, Quantity("tau", "s", low=0)] = 0.0
    """Time from a sample to the moment at which its command takes effect [s]."""
    limit: Annotated[float, Quantity("u_max", above=0)] | None = None
    """Largest magnitude of a command, in its unit; None if there is none."""
    step: Annotated[float, Quantity("u_q", above=0)] | None = None
    """Step of commands, in their unit; None if they have none."""

    def times(self, t_end: float) -> list[float]:
        """Return the times of the samples before the end."""
        return [k * self.period for k in range(math.ceil(t_end / self.period - SAME))]

    def lag(self) -> tuple[int, float]:
        """Return the delay as whole periods and a rest [s]."""
        whole = round(self.delay / self.period)
        if abs(self.delay - whole * self.period) <= SAME * self.period:
            return whole, 0.0
        whole = math.floor(self.delay / self.period)
        return whole, self.delay - whole * self.period

    def within(self, command: float) -> float:
        """Return a command in whole steps, within the limit."""
        if self.step is not None:
            command = self.step * round(command / self.step)
        if self.limit is None:
            return command
        return min(max(command, -self.limit), self.limit)


Stretch: TypeAlias = tuple[float, float, float]
"""Start of a stretch of constant or straight command [s], its value there, its slope."""


@final
class Commands:
    """Commands as they take effect: after the delay, and held."""

    def __init__(self, timing: Timing, samples: Sequence[float], hold: str, t_end: float) -> None:
        """Take the times of the samples."""
        self.whole, self.rest = timing.lag()
        self.period, self.hold = timing.period, hold
        self.told: list[float] = []
        ends = [*samples[1:], t_end]
        middle = [t + self.rest for t in samples if self.rest > 0.0]
        inner = [t for t, end in zip(middle, ends, strict=False) if t < end]
        self._breaks, self._end = sorted([*samples, *inner]), t_end

    def untold(self) -> Sampled | PiecewiseAffine:
        """Return the drive before anything is commanded: zeros, piece by piece."""
        return drive_of(self.hold, [(t, 0.0, 0.0) for t in self._breaks], self._end)

    def _line(self, index: int) -> tuple[float, float]:
        """Return value and slope of a command at its own start; nothing acts before the first."""
        if index < 0:
            return 0.0, 0.0
        now = self.told[index]
        if self.hold == "zero" or index == 0:
            return now, 0.0
        return now, (now - self.told[index - 1]) / self.period

    def stretches(self, index: int, start: float, end: float) -> list[Stretch]:
        """Return what acts from a sample to the next, in one stretch or two."""
        value, slope = self._line(index - self.whole)
        if self.rest <= 0.0:
            return [(start, value, slope)]
        old, steep = self._line(index - self.whole - 1)
        first = (start, old + steep * (self.period - self.rest), steep)
        middle = start + self.rest
        return [first, (middle, value, slope)] if middle < end else [first]


def drive_of(hold: str, stretches: Sequence[Stretch], end: float) -> Sampled | PiecewiseAffine:
    """Return commands as a drive; a line ends, at the end at the latest, and its value is held."""
    if hold == "zero":
        times, values, _ = (tuple(column) for column in zip(*stretches, strict=True))
        return Sampled(times=times, values=values)
    start, value, slope = stretches[-1]
    lines = [*stretches, (end, value + slope * (end - start), 0.0)]
    times, values, slopes = (tuple(column) for column in zip(*lines, strict=True))
    return PiecewiseAffine(times=times, values=values, slopes=slopes)


SPREAD = Quantity("sigma", low=0)
STEP = Quantity("q", above=0)


@final
class Sensors:
    """Reads states as a controller gets them: noise first, then quantisation.

    Examples
    --------
    >>> sensors = Sensors(("x", "v"), quantisation={"x": 0.01})
    >>> sensors.read([0.123, 0.456])
    {'x': 0.12, 'v': 0.456}
    """

    def __init__(
        self,
        names: Sequence[str],
        *,
        noise: Mapping[str, float] | None = None,
        quantisation: Mapping[str, float] | None = None,
        seed: int = 0,
    ) -> None:
        """Take the names of what is measured."""
        self.names = tuple(names)
        self._noise = self._checked("noise", noise or {}, SPREAD)
        self._steps = self._checked("quantisation", quantisation or {}, STEP)
        self._random = np.random.default_rng(seed)

    def _checked(
        self, what: str, given: Mapping[str, float], quantity: Quantity
    ) -> dict[str, float]:
        for name in given:
            if name not in self.names:
                raise UnknownNameError(f"state in {what}", name, self.names)
        return {k: quantity.check("closed_loop", f"{what}[{k!r}]", v) for k, v in given.items()}

    def read(self, state: Sequence[float]) -> dict[str, float]:
        """Return what is measured of a state, by name."""
        found = dict(zip(self.names, state, strict=False))  # bristles are seen by nobody
        for name, spread in self._noise.items():
            found[name] += spread * float(self._random.standard_normal())
        for name, step in self._steps.items():
            found[name] = step * round(found[name] / step)
        return found
