"""The kinds of motion that are searched, each as a cube of numbers from 0 to 1."""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Literal, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms import drives
from stickslip.quantities import fields_of, named
from stickslip.study.optimisation.problem import Limits

Array = NDArray[np.float64]

LEAST_AMPLITUDE = 0.02
"""Least amplitude over the position allowed."""
SLOWEST, FASTEST = 1.0 / 50.0, 200.0
"""Accelerations, over the one that just reaches the rate allowed within the position allowed."""
LEAST_SHARE = 0.05
"""Least top rate over the one that could be reached."""
SHORTEST_SPLINE, LONGEST_SPLINE = 0.5, 30.0
"""Durations of a spline, over the time for there and back at the rate allowed."""
BELOW = 1.0 - 1e-12
"""A top rate must be reached, rounding included."""


def _between(low: float, high: float, u: float) -> float:
    """Return a number between two, its logarithm evenly spread."""
    return float(low * (high / low) ** u)


def _placed(low: float, high: float, value: float) -> float:
    return math.log(value / low) / math.log(high / low)


@dataclass(frozen=True, kw_only=True)
class Space(ABC):
    """A kind of motion within limits; a point of the cube is a profile."""

    kind: ClassVar[str]
    """Name of the kind."""
    limits: Limits
    """Their position and rate set the scales."""

    @property
    @abstractmethod
    def size(self) -> int:
        """Numbers of a point."""

    @abstractmethod
    def profile(self, u: Array) -> drives.Profile:
        """Return the profile at a point (size,)."""

    @abstractmethod
    def place(self, profile: drives.Profile) -> Array | None:
        """Return the point of a profile, moved into the cube, or None where it has none."""

    @abstractmethod
    def paths(self, u: Array) -> Mapping[str, float]:
        """Return the values at a point by the fields that runs have sensitivities to."""

    @final
    def inside(self, u: list[float]) -> Array:
        """Return a point moved into the cube."""
        return np.asarray(np.clip(np.array(u), 0.0, 1.0))

    @final
    def amplitude(self, u: float) -> float:
        """Return the amplitude at a number from 0 to 1."""
        return (LEAST_AMPLITUDE + (1.0 - LEAST_AMPLITUDE) * u) * self.limits.position

    @final
    def share(
        self,
        profile: drives.ThreePhase | drives.TimedThreePhase | drives.SevenStep | drives.SineSwing,
    ) -> float:
        """Return the number that stands for the amplitude of a profile."""
        share = profile.amplitude / self.limits.position
        return (share - LEAST_AMPLITUDE) / (1.0 - LEAST_AMPLITUDE)

    @final
    def placed(self, sizes: Sequence[float]) -> list[float]:
        """Return the numbers that stand for accelerations."""
        return [_placed(*self.accelerations, size) for size in sizes]

    @property
    def accelerations(self) -> tuple[float, float]:
        """Least and largest acceleration."""
        unit = self.limits.rate**2 / (2.0 * self.limits.position)
        largest = self.limits.acceleration or FASTEST * unit
        return min(SLOWEST * unit, SLOWEST * largest), largest


def _numbers(profile: drives.Profile) -> dict[str, float]:
    values = {name: getattr(profile, name) for name in fields_of(type(profile))}
    return {name: float(value) for name, value in values.items() if value is not None}


class ThreePhases(Space):
    """Amplitude, outer and middle acceleration; which of them is the fast one is left open."""

    kind: ClassVar[str] = "three-phase"

    @property
    def size(self) -> int:
        return 3

    def profile(self, u: Array) -> drives.ThreePhase:
        outer, middle = (_between(*self.accelerations, x) for x in u[1:])
        return _three_phases(self.amplitude(u[0]), outer, middle)

    def place(self, profile: drives.Profile) -> Array | None:
        if not isinstance(profile, drives.ThreePhase) or profile.last is not None:
            return None
        return self.inside([self.share(profile), *self.placed(profile.accelerations[:2])])

    def paths(self, u: Array) -> Mapping[str, float]:
        return _numbers(self.profile(u))


class ThreeAccelerations(Space):
    """Amplitude and the accelerations of three phases, each its own."""

    kind: ClassVar[str] = "three-accelerations"

    @property
    def size(self) -> int:
        return 4

    def profile(self, u: Array) -> drives.ThreePhase:
        first, middle, last = (_between(*self.accelerations, x) for x in u[1:])
        return _three_phases(self.amplitude(u[0]), first, middle, last)

    def place(self, profile: drives.Profile) -> Array | None:
        if not isinstance(profile, drives.ThreePhase | drives.TimedThreePhase):
            return None
        return self.inside([self.share(profile), *self.placed(profile.accelerations)])

    def paths(self, u: Array) -> Mapping[str, float]:
        return _numbers(self.profile(u))


def _three_phases(
    amplitude: float, first: float, middle: float, last: float | None = None
) -> drives.ThreePhase:
    return drives.ThreePhase(
        amplitude=amplitude,
        fast=max(first, middle),
        slow=min(first, middle),
        first="fast" if first >= middle else "slow",
        last=last,
    )


class SevenSteps(Space):
    """Amplitude, two accelerations, rates both ways over the one that is reached, and a pause."""

    kind: ClassVar[str] = "seven-step"

    @property
    def size(self) -> int:
        return 6

    def profile(self, u: Array) -> drives.SevenStep:
        fast, slow = (_between(*self.accelerations, x) for x in u[1:3])
        amplitude = self.amplitude(u[0])
        # Rates are shares of what is reached: any point of the cube is a motion.
        most = min(_reachable(amplitude, fast, slow), self.limits.rate)
        there, back = (most * (LEAST_SHARE + (1.0 - LEAST_SHARE) * x) for x in u[3:5])
        return drives.SevenStep(
            amplitude=amplitude,
            fast=fast,
            slow=slow,
            top_rate=there,
            return_rate=back,
            pause=u[5] * self._longest_pause,
        )

    @property
    def _longest_pause(self) -> float:
        return 4.0 * self.limits.position / self.limits.rate

    def place(self, profile: drives.Profile) -> Array | None:
        if isinstance(
            profile, drives.ThreePhase
        ):  # begins with its first two accelerations both ways
            fast, slow, _ = profile.accelerations
            rates, pause = (profile.peak_rate, profile.peak_rate), 0.0
        elif isinstance(profile, drives.SevenStep):
            fast, slow, rates = profile.fast, profile.slow, profile.cruising_rates
            pause = profile.pause
        else:
            return None
        most = min(_reachable(profile.amplitude, fast, slow), self.limits.rate)
        return self.inside(
            [
                self.share(profile),
                *self.placed((fast, slow)),
                *((rate / most - LEAST_SHARE) / (1.0 - LEAST_SHARE) for rate in rates),
                pause / self._longest_pause,
            ]
        )

    def paths(self, u: Array) -> Mapping[str, float]:
        return _numbers(self.profile(u))


def _reachable(amplitude: float, fast: float, slow: float) -> float:
    """Return the rate that two accelerations reach on the way."""
    return BELOW * math.sqrt(4.0 * amplitude / (1.0 / fast + 1.0 / slow))


class Sines(Space):
    """Amplitude, and peak rate over the rate allowed."""

    kind: ClassVar[str] = "sine"

    @property
    def size(self) -> int:
        return 2

    def profile(self, u: Array) -> drives.SineSwing:
        amplitude = self.amplitude(u[0])
        rate = _between(LEAST_SHARE, 1.0, u[1]) * self.limits.rate
        return drives.SineSwing(amplitude=amplitude, frequency=rate / (2.0 * math.pi * amplitude))

    def place(self, profile: drives.Profile) -> Array | None:
        if not isinstance(profile, drives.SineSwing):
            return None
        rate = 2.0 * math.pi * profile.frequency * profile.amplitude / self.limits.rate
        return self.inside(
            [
                self.share(profile),
                _placed(LEAST_SHARE, 1.0, rate),
            ]
        )

    def paths(self, u: Array) -> Mapping[str, float]:
        return _numbers(self.profile(u))


@dataclass(frozen=True, kw_only=True)
class Splines(Space):
    """Positions at the knots and the duration; runs have no sensitivities to the positions."""

    kind: ClassVar[str] = "spline"
    knots: int = 12
    """Number of positions."""

    @property
    def size(self) -> int:
        return self.knots + 1

    @property
    def _durations(self) -> tuple[float, float]:
        unit = 4.0 * self.limits.position / self.limits.rate
        return SHORTEST_SPLINE * unit, LONGEST_SPLINE * unit

    def profile(self, u: Array) -> drives.SplineSwing:
        positions = tuple((self.limits.position * (2.0 * u[1:] - 1.0)).tolist())
        return drives.SplineSwing(positions=positions, duration=_between(*self._durations, u[0]))

    def place(self, profile: drives.Profile) -> Array | None:
        period = float(profile.period)
        positions = [profile.at(k * period / self.knots)[0] for k in range(self.knots)]
        return self.inside(
            [
                _placed(*self._durations, period),
                *(0.5 + 0.5 * position / self.limits.position for position in positions),
            ]
        )

    def paths(self, u: Array) -> Mapping[str, float]:
        return {}


KindName: TypeAlias = Literal[
    "three-phase",
    "three-accelerations",
    "seven-step",
    "sine",
    "spline",
    "timed-three-phase",
    "sine-swing",
    "spline-swing",
]
"""The names that searches take: those of `KINDS` and of `TYPES`."""
KINDS: Mapping[str, type[Space]] = {
    space.kind: space for space in (ThreePhases, ThreeAccelerations, SevenSteps, Sines, Splines)
}
"""The kinds of motion by name."""
TYPES: Mapping[str, str] = {
    "sine-swing": Sines.kind,
    "spline-swing": Splines.kind,
    "timed-three-phase": ThreeAccelerations.kind,
}
"""The names that kinds have as the ``type`` of a profile in a rig file, where they differ."""


def kind_of(name: str) -> str:
    """Return the name of a kind, which may be given as rig files have it.

    Examples
    --------
    >>> kind_of("spline-swing"), kind_of("spline")
    ('spline', 'spline')
    """
    if not isinstance(name, str):
        raise InputError(f"kind must be one of {', '.join(KINDS)}, got {name!r}.")
    kind = TYPES.get(name, name)
    named(KINDS, kind, "kind of motion")
    return kind


def space_of(kind: str, limits: Limits, knots: int) -> Space:
    """Return the space of a kind.

    Examples
    --------
    >>> space = space_of("sine", Limits(position=0.5, rate=2.0), 12)
    >>> space.profile(np.array([1.0, 1.0])).amplitude
    0.5
    """
    if kind != Splines.kind:
        return KINDS[kind](limits=limits)
    if type(knots) is not int or not 4 <= knots <= 60:
        raise ParameterError(f"knots must be a whole number of 4 to 60, got {knots!r}.")
    return Splines(limits=limits, knots=knots)
