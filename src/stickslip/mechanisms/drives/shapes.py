"""Drives: pulse, sine, ramp, drives given by points, and motion profiles; all by name."""

import functools
import itertools
import math
import numbers
from abc import ABC, abstractmethod
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, final

import numpy as np
from typing_extensions import override

from stickslip.errors import ParameterError
from stickslip.maths import Scalar, sin, sqrt
from stickslip.mechanisms.drives import base
from stickslip.mechanisms.drives.base import Drive, Piece, Straight, repeated
from stickslip.mechanisms.drives.feedback import DelayedFeedback, Feedback, Relay
from stickslip.quantities import Numbers, Quantity
from stickslip.show.formatting import number

# Motion profiles: what moves a pendulum or an inner mass as it is told, again and again.

GAP_STEPS = 3.0
"""Step of time over the usual one from which on a recorded motion has a gap."""
FEWEST_SAMPLES = 8
"""Samples of a recorded motion at least."""
COARSEST = 2
"""Intervals of the coarsest spline that is tried."""
FINER = 1.15
"""Ratio of the numbers of intervals that are tried."""
MOST_INTERVALS, MOST_KNOTS = 3000, 300
"""Intervals of a spline at most, and knots at which its error is looked at."""


@dataclass(frozen=True, kw_only=True)
class Profile(Drive, ABC):
    """A motion that is told, given by its acceleration [rad/s^2] or [m/s^2]; mostly periodic.

    As a drive its value is the acceleration; `start_position` and `start_rate` are where it begins.
    """

    wanted: ClassVar[str] = "a motion profile such as ThreePhase(...)"
    moves: ClassVar[bool] = True

    @override
    @classmethod
    def instead(cls, given: object) -> str:
        return ""

    @property
    @abstractmethod
    def period(self) -> float:
        """Duration of a cycle, or of a motion that does not repeat itself [s]."""

    @property
    @abstractmethod
    def start_position(self) -> float:
        """Position [rad] or [m] at time 0."""

    @property
    def start_rate(self) -> float:
        """Rate [rad/s] or [m/s] at time 0."""
        return 0.0

    @override
    def repeats(self) -> float | None:
        return self.period

    @abstractmethod
    def at(self, t: float) -> tuple[float, float]:
        """Return position and rate at a time [s].

        Examples
        --------
        >>> swing = ThreePhase(amplitude=0.8, fast=120.0, slow=30.0)
        >>> position, rate = swing.at(0.5 * swing.period)
        >>> round(position, 9), round(rate, 9)
        (0.8, 0.0)
        """


class _FromAmplitude:
    """A motion that begins at minus its amplitude."""

    amplitude: float

    @property
    def start_position(self) -> float:
        """Position [rad] or [m] at time 0."""
        return -self.amplitude


@dataclass(frozen=True, kw_only=True)
class Stepped(Straight, Profile, ABC):
    """A profile whose acceleration is a straight line between times: it has no smooth part."""

    @abstractmethod
    def cycle(self) -> tuple[Piece, ...]:
        """Return the pieces of one cycle, the first at time 0."""

    @final
    @override
    def pieces(self, until: float = 0.0) -> tuple[Piece, ...]:
        return repeated(type(self).__name__, self.cycle(), self.period, until)

    @override
    def at(self, t: float) -> tuple[float, float]:
        return _moved(self, self.cycle(), t % float(self.period))


def _moved(profile: Profile, pieces: Sequence[Piece], t: float) -> tuple[float, float]:
    """Return position and rate at a time [s] within the pieces of a profile."""
    position, rate = float(profile.start_position), float(profile.start_rate)
    ends = [*(float(piece.start) for piece in pieces[1:]), float(profile.period)]
    for piece, end in zip(pieces, ends, strict=True):
        h = min(t, end) - float(piece.start)
        if h <= 0.0:
            break
        # The acceleration is a straight line in a piece: its integrals are exact.
        value, slope = float(piece.value), float(piece.slope)
        position += rate * h + value * h * h / 2.0 + slope * h**3 / 6.0
        rate += value * h + slope * h * h / 2.0
    return position, rate


def _number(value: Any) -> float:
    if isinstance(value, (bool, str)):
        raise TypeError
    return float(value)


def _steps(durations: Sequence[Scalar], accelerations: Sequence[Scalar]) -> tuple[Piece, ...]:
    """Return pieces of constant acceleration that follow each other."""
    starts = itertools.accumulate(durations[:-1], initial=0.0)
    return tuple(Piece(s, a, 0.0) for s, a in zip(starts, accelerations, strict=True))


@dataclass(frozen=True, kw_only=True)
class ThreePhase(_FromAmplitude, Stepped):
    """There and back in three phases of constant acceleration, of which the middle one differs.

    From minus the amplitude at rest it accelerates, brakes beyond the turning point at the
    amplitude, and comes back to rest where it began. With ``first="fast"`` the outer phases are the
    fast ones: ``+fast``, ``-slow``, ``+fast``; with ``first="slow"`` the middle one is. The last
    phase may have an acceleration of its own. With a `frequency` the motion keeps its way and its
    shape: of the accelerations the ratios count, and all are scaled to that many cycles a second.

    Examples
    --------
    >>> import math
    >>> swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    >>> round(float(swing.period), 5)
    0.7236
    >>> quicker = ThreePhase(amplitude=0.8, fast=4.0, slow=1.0, frequency=2.0)
    >>> [round(one, 6) for one in quicker.accelerations]
    [256.0, 64.0, 256.0]
    """

    amplitude: Annotated[float, Quantity("theta_m", "rad", above=0, or_unit="m")]
    """Half the way between the turning points, about 0."""
    fast: Annotated[float, Quantity("A_1", "rad/s^2", above=0, or_unit="m/s^2")]
    """Size of the large acceleration."""
    slow: Annotated[float, Quantity("A_2", "rad/s^2", above=0, or_unit="m/s^2")]
    """Size of the small acceleration."""
    first: Literal["fast", "slow"] = "fast"
    """What the outer phases are."""
    last: Annotated[float, Quantity("A_3", "rad/s^2", above=0, or_unit="m/s^2")] | None = None
    """Size of the acceleration of the last phase; that of the first one if not given."""
    frequency: Annotated[float, Quantity("f", "Hz", above=0)] | None = None
    """Cycles per second; those that the accelerations make if not given."""

    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.first not in ("fast", "slow"):
            raise ParameterError(f"ThreePhase.first must be 'fast' or 'slow', got {self.first!r}.")

    @property
    def accelerations(self) -> tuple[float, float, float]:
        """Sizes of the accelerations of the three phases; that of the middle one is a braking."""
        outer, middle = (self.fast, self.slow) if self.first == "fast" else (self.slow, self.fast)
        sizes = outer, middle, outer if self.last is None else self.last
        if self.frequency is None:
            return sizes
        # Accelerations go with the square of the speed at which the same way is covered.
        quicker = self.frequency * self._duration(sizes)
        first, middle, last = (quicker * quicker * size for size in sizes)
        return first, middle, last

    def _rates_of(self, sizes: tuple[float, float, float]) -> tuple[float, float]:
        """Return the largest rates on the way there and on the way back."""
        first, middle, last = sizes
        # Both ramps cover the way: v^2 / 2 (1 / a + 1 / b) = 2 theta_m.
        there: float = sqrt(4.0 * self.amplitude / (1.0 / first + 1.0 / middle))
        back: float = sqrt(4.0 * self.amplitude / (1.0 / middle + 1.0 / last))
        return there, back

    def _duration(self, sizes: tuple[float, float, float]) -> float:
        """Return how long a cycle with these accelerations lasts [s]."""
        first, middle, last = sizes
        there, back = self._rates_of(sizes)
        return there * (1.0 / first + 1.0 / middle) + back * (1.0 / middle + 1.0 / last)

    @property
    def peak_rate(self) -> float:
        """Largest rate, on the way there or on the way back."""
        there, back = self._rates_of(self.accelerations)
        return there if self.last is None else max(there, back)

    @property
    @override
    def period(self) -> float:
        if self.frequency is not None:
            return 1.0 / self.frequency
        return self._duration(self.accelerations)

    @override
    def cycle(self) -> tuple[Piece, ...]:
        first, middle, last = self.accelerations
        there, back = self._rates_of(self.accelerations)
        times = (there / first, (there + back) / middle, back / last)
        return _steps(times, (first, -middle, last))


@dataclass(frozen=True, kw_only=True)
class TimedThreePhase(_FromAmplitude, Stepped):
    """There and back in three phases of constant acceleration, given by their durations.

    From minus the amplitude at rest it accelerates, brakes beyond the turning point at the
    amplitude, and comes back to rest where it began. Any three durations make such a motion; where
    the outer ones are equal, so are their accelerations, and it is a `ThreePhase`. With a
    `frequency` the durations count as shares of a cycle.

    Examples
    --------
    >>> swing = TimedThreePhase(
    ...     amplitude=0.8, first_duration=0.1, middle_duration=0.5, last_duration=0.2
    ... )
    >>> [round(one, 2) for one in swing.accelerations]
    [86.67, 32.19, 37.14]
    >>> position, rate = swing.at(swing.period - 1e-12)
    >>> round(position, 9), abs(round(rate, 9))
    (-0.8, 0.0)
    """

    amplitude: Annotated[float, Quantity("theta_m", "rad", above=0, or_unit="m")]
    """Half the way between the turning points, about 0."""
    first_duration: Annotated[float, Quantity("t_1", "s", above=0)]
    """Duration of the first phase."""
    middle_duration: Annotated[float, Quantity("t_2", "s", above=0)]
    """Duration of the phase that brakes and turns back."""
    last_duration: Annotated[float, Quantity("t_3", "s", above=0)]
    """Duration of the last phase."""
    frequency: Annotated[float, Quantity("f", "Hz", above=0)] | None = None
    """Cycles per second; those that the durations make if not given."""

    @property
    def durations(self) -> tuple[float, float, float]:
        """Durations of the three phases [s]."""
        given = self.first_duration, self.middle_duration, self.last_duration
        if self.frequency is None:
            return given
        slower = 1.0 / (self.frequency * sum(given))
        first, middle, last = (slower * value for value in given)
        return first, middle, last

    @property
    def _rates(self) -> tuple[Scalar, Scalar]:
        """Largest rates on the way there and on the way back.

        Their ratio is that of the times in which they change, ``(t_2 + t_3) / (t_1 + t_2)``, since
        both ways are as long.
        """
        t_1, t_2, t_3 = self.durations
        share = (t_2 + t_3) / (t_1 + 2.0 * t_2 + t_3)  # of the middle phase, until it turns back
        there = 4.0 * self.amplitude / (t_1 + t_2 * share)
        return there, there * (t_1 + t_2) / (t_2 + t_3)

    @property
    def accelerations(self) -> tuple[float, float, float]:
        """Sizes of the accelerations of the three phases; that of the middle one is a braking."""
        there, back = self._rates
        first, middle, last = self.durations
        return there / first, (there + back) / middle, back / last

    @property
    @override
    def period(self) -> float:
        return sum(self.durations) if self.frequency is None else 1.0 / self.frequency

    @override
    def cycle(self) -> tuple[Piece, ...]:
        first, middle, last = self.accelerations
        return _steps(self.durations, (first, -middle, last))


@dataclass(frozen=True, kw_only=True)
class SevenStep(_FromAmplitude, Stepped):
    """There and back with a rate that is limited, and a pause: up to seven steps.

    Forwards it accelerates fast, cruises at the top rate and brakes slowly; backwards it
    accelerates slowly, cruises and brakes fast; then it pauses. Without the pause these are six
    steps, and with a top rate that is just reached they are the three phases. With a `return_rate`
    it comes back at another rate: with equal and large accelerations that is a two-phase motion,
    whose relative speed is constant both ways. The steps are ours: profiles of
    that name in the literature differ.

    Examples
    --------
    >>> swing = SevenStep(amplitude=0.8, fast=120.0, slow=30.0, top_rate=6.0, pause=0.1)
    >>> round(float(swing.period), 6)
    0.883333
    """

    amplitude: Annotated[float, Quantity("theta_m", "rad", above=0, or_unit="m")]
    """Half the way between the turning points, about 0."""
    fast: Annotated[float, Quantity("A_1", "rad/s^2", above=0, or_unit="m/s^2")]
    """Size of the large acceleration."""
    slow: Annotated[float, Quantity("A_2", "rad/s^2", above=0, or_unit="m/s^2")]
    """Size of the small acceleration."""
    top_rate: Annotated[float, Quantity("Omega", "rad/s", above=0, or_unit="m/s")]
    """Rate of the cruise forwards, and backwards where no other is given."""
    pause: Annotated[float, Quantity("t_p", "s", low=0)] = 0.0
    """How long it rests at the end of a cycle."""
    return_rate: Annotated[float, Quantity("Omega_r", "rad/s", above=0, or_unit="m/s")] | None = (
        None
    )
    """Rate of the cruise backwards; the top rate if not given."""

    def __post_init__(self) -> None:
        """Check that the rates are reached."""
        super().__post_init__()
        for name, symbol, rate in zip(
            ("top_rate", "return_rate"), ("Omega", "Omega_r"), self.cruising_rates, strict=True
        ):
            if self._cruise(rate) < 0.0:
                most = math.sqrt(4.0 * self.amplitude / (1.0 / self.fast + 1.0 / self.slow))
                raise ParameterError(
                    f"SevenStep.{name} ({symbol}) must be at most {number(most, 4)} rad/s, the"
                    f" rate that the accelerations reach, got {number(rate, 6)}."
                )

    @property
    def cruising_rates(self) -> tuple[float, float]:
        """Rates of the cruise forwards and backwards."""
        return self.top_rate, self.top_rate if self.return_rate is None else self.return_rate

    def _cruise(self, rate: float) -> float:
        """Return the duration of a cruise at a rate [s]."""
        # What the ramps leave of the way, over the rate.
        ramps = 0.5 * rate * (1.0 / self.fast + 1.0 / self.slow)
        return 2.0 * self.amplitude / rate - ramps

    @property
    @override
    def period(self) -> float:
        ramps = 1.0 / self.fast + 1.0 / self.slow
        ways = [self._cruise(rate) + rate * ramps for rate in self.cruising_rates]
        return ways[0] + ways[1] + self.pause

    @override
    def cycle(self) -> tuple[Piece, ...]:
        there, back = self.cruising_rates
        forwards = (there / self.fast, self._cruise(there), there / self.slow)
        backwards = (back / self.slow, self._cruise(back), back / self.fast)
        times = (*forwards, *backwards, self.pause)
        signs = (self.fast, 0.0, -self.slow, -self.slow, 0.0, self.fast, 0.0)
        return _steps(times, signs)


@dataclass(frozen=True, kw_only=True)
class Rotation(Stepped):
    """A turn at a constant rate, as of an unbalanced rotor.

    Examples
    --------
    >>> turn = Rotation(rate=20.0)
    >>> position, rate = turn.at(0.5 * turn.period)
    >>> round(position, 9), rate
    (3.141592654, 20.0)
    """

    rate: Annotated[float, Quantity("Omega", "rad/s")]
    """Rate of the turn; negative the other way."""
    start: Annotated[float, Quantity("theta_0", "rad")] = 0.0
    """Angle at time 0."""

    def __post_init__(self) -> None:
        """Check that it turns."""
        super().__post_init__()
        if self.rate == 0.0:
            raise ParameterError("Rotation.rate (Omega) must not be 0 rad/s: nothing would turn.")

    @property
    @override
    def period(self) -> float:
        return 2.0 * math.pi / abs(self.rate)

    @property
    @override
    def start_position(self) -> float:
        return self.start

    @property
    @override
    def start_rate(self) -> float:
        return self.rate

    @override
    def cycle(self) -> tuple[Piece, ...]:
        return (Piece(0.0, 0.0, 0.0),)


@dataclass(frozen=True, kw_only=True)
class SineSwing(_FromAmplitude, Profile):
    """A harmonic motion that begins at rest at minus the amplitude.

    Examples
    --------
    >>> swing = SineSwing(amplitude=0.5, frequency=2.0)
    >>> position, rate = swing.at(0.25)
    >>> round(position, 12), round(rate, 12)
    (0.5, 0.0)
    """

    amplitude: Annotated[float, Quantity("theta_m", "rad", above=0, or_unit="m")]
    """Largest position."""
    frequency: Annotated[float, Quantity("f", "Hz", above=0)]
    """Cycles per second."""

    @property
    @override
    def period(self) -> float:
        return 1.0 / self.frequency

    @property
    def _turn(self) -> Scalar:
        """Angular frequency [rad/s]."""
        return 2.0 * math.pi * self.frequency

    @override
    def smooth(self, t: Scalar) -> Scalar:
        return self.amplitude * self._turn * self._turn * sin(self._turn * t + 0.5 * math.pi)

    @override
    def pieces(self, until: float = 0.0) -> tuple[Piece, ...]:
        return ()

    @override
    def smooth_bound(self) -> tuple[Scalar, Scalar]:
        most = self.amplitude * self._turn * self._turn
        return -most, most

    @override
    def time_scale(self) -> float:
        return 1.0 / self.frequency

    @override
    def at(self, t: float) -> tuple[float, float]:
        angle = self._turn * t
        return -self.amplitude * math.cos(angle), self.amplitude * self._turn * math.sin(angle)


@dataclass(frozen=True, kw_only=True)
class SplineSwing(Stepped):
    """A periodic cubic spline through positions evenly spaced over a cycle.

    Examples
    --------
    >>> swing = SplineSwing(positions=(-0.5, 0.0, 0.5, 0.0), duration=1.0)
    >>> round(swing.at(0.25)[0], 12), round(swing.at(0.5)[0], 12)
    (0.0, 0.5)
    """

    data_fields: ClassVar[tuple[str, ...]] = ("positions",)

    positions: tuple[float, ...]
    """Positions [rad] or [m] at 0, 1/n, 2/n, ... of a cycle, at least three."""
    duration: Annotated[float, Quantity("T", "s", above=0)]
    """Duration of a cycle."""

    if TYPE_CHECKING:  # any series is taken and kept as a tuple

        def __init__(self, *, positions: Numbers, duration: float) -> None: ...

    def __post_init__(self) -> None:
        """Check the positions and keep them as a tuple of floats."""
        super().__post_init__()
        try:
            positions = tuple(_number(x) for x in self.positions)
        except (TypeError, ValueError):
            raise ParameterError(
                f"SplineSwing.positions must be a series of numbers, got {self.positions!r}."
            ) from None
        if len(positions) < 3 or not all(map(math.isfinite, positions)):
            raise ParameterError(
                "SplineSwing.positions must be at least 3 finite numbers [rad] or [m],"
                f" got {self.positions!r}."
            )
        object.__setattr__(self, "positions", positions)

    @property
    @override
    def period(self) -> float:
        return self.duration

    @property
    @override
    def start_position(self) -> float:
        return self.positions[0]

    @property
    @override
    def start_rate(self) -> float:
        return self._scaled[0] / self.duration

    @functools.cached_property
    def _scaled(self) -> tuple[float, list[float]]:
        """First rate and the accelerations at the knots, for a cycle of 1 s."""
        y = np.array(self.positions)
        n = len(y)
        # slopes of neighbouring cubics agree: a_before + 4 a + a_after = 6 n^2 (second difference)
        joined = 4.0 * np.eye(n) + np.roll(np.eye(n), 1, axis=0) + np.roll(np.eye(n), -1, axis=0)
        curved = 6.0 * n * n * (np.roll(y, -1) - 2.0 * y + np.roll(y, 1))
        knots = np.linalg.solve(joined, curved).tolist()
        rate = n * (y[1] - y[0]) - (2.0 * knots[0] + knots[1]) / (6.0 * n)
        return float(rate), [*knots, knots[0]]

    @override
    def cycle(self) -> tuple[Piece, ...]:
        _, knots = self._scaled
        n, length = len(self.positions), self.duration
        square = length * length  # accelerations go with 1 / T^2
        return tuple(
            Piece(i * length / n, a / square, (b - a) * n / (square * length))
            for i, (a, b) in enumerate(itertools.pairwise(knots))
        )


@dataclass(frozen=True, kw_only=True)
class SampledSwing(Straight, Profile):
    """A motion that was recorded, such as the measured angle of a pendulum; it does not repeat.

    A cubic spline with even knots is fitted to the samples: its acceleration, which drives, is
    continuous and straight between knots. Differentiating twice amplifies noise: with knots ``h``
    apart and samples ``dt`` apart, noise ``s`` leaves an error of the acceleration of about
    ``12 s sqrt(dt / h) / h**2`` (`acceleration_error` has it). Knots that are too wide flatten
    jumps of the acceleration. If no spacing is given, the corrected information criterion of Akaike
    chooses it.

    Examples
    --------
    >>> import numpy as np
    >>> t = np.linspace(0.0, 1.0, 101)
    >>> swing = SampledSwing(times=t, positions=-0.5 * np.cos(2.0 * np.pi * t))
    >>> position, rate = swing.at(0.5)
    >>> round(position, 4), round(swing.value(0.5)), swing.acceleration_error < 0.1
    (0.5, -20, True)
    """

    data_fields: ClassVar[tuple[str, ...]] = ("times", "positions")

    times: tuple[float, ...]
    """Times of the samples [s], increasing from 0, when runs begin; at least 8, without gaps."""
    positions: tuple[float, ...]
    """Positions [rad] or [m] at these times."""
    spacing: Annotated[float, Quantity("h", "s", above=0, structural=True)] | None = None
    """Distance of the knots of the spline, rounded to a whole part of the record; chosen by the
    data if not given."""

    if TYPE_CHECKING:  # any series is taken and kept as a tuple

        def __init__(
            self, *, times: Numbers, positions: Numbers, spacing: float | None = None
        ) -> None: ...

    def __post_init__(self) -> None:
        """Check the samples and keep them as tuples of floats."""
        super().__post_init__()
        for name in ("times", "positions"):
            object.__setattr__(
                self, name, _spline_series(f"SampledSwing.{name}", getattr(self, name))
            )
        _check_samples(self.times, self.positions)
        if self.spacing is not None:
            usual = self.period / (len(self.times) - 1)
            if not 2.0 * usual <= self.spacing <= self.period / COARSEST:
                raise ParameterError(
                    "SampledSwing.spacing (h) must be from two samples,"
                    f" {number(2.0 * usual, 4)} s, to half the record,"
                    f" {number(self.period / COARSEST, 4)} s, got {number(self.spacing, 6)}."
                )

    @property
    @override
    def period(self) -> float:
        """Duration of the record [s]."""
        return self.times[-1]

    @override
    def repeats(self) -> None:
        return None

    @property
    @override
    def start_position(self) -> float:
        return self._smoothed.position

    @property
    @override
    def start_rate(self) -> float:
        return self._smoothed.rate

    @property
    def noise(self) -> float:
        """Root mean square of the samples less the spline [rad] or [m]."""
        return self._smoothed.noise

    @property
    def acceleration_error(self) -> float:
        """Standard error of the acceleration that comes of the noise [rad/s^2] or [m/s^2].

        Root mean square over the knots; what the spline flattens comes to it.
        """
        return self._smoothed.error

    @property
    def _smoothed(self) -> "_Smoothed":
        return _smoothed(self.times, self.positions, self.spacing)

    @override
    def pieces(self, until: float = 0.0) -> tuple[Piece, ...]:
        if until > self.period * (1.0 + 1e-9):
            raise ParameterError(
                f"SampledSwing: the recorded motion ends at {number(self.period, 6)} s, but the run"
                f" at t_end = {number(until, 6)} s: shorten the run."
            )
        return self._smoothed.pieces

    @override
    def at(self, t: float) -> tuple[float, float]:
        return _moved(self, self.pieces(t), t)


def _spline_series(label: str, values: Any) -> tuple[float, ...]:
    try:
        result = tuple(_number(x) for x in values)
    except (TypeError, ValueError):
        raise ParameterError(f"{label} must be a series of numbers, got {values!r}.") from None
    if not all(map(math.isfinite, result)):
        raise ParameterError(f"{label} must be finite numbers, one of them is not.")
    return result


def _check_samples(times: Sequence[float], positions: Sequence[float]) -> None:
    """Refuse samples through which no motion can be laid."""
    if len(times) != len(positions) or len(times) < FEWEST_SAMPLES:
        raise ParameterError(
            f"SampledSwing.times and positions must be as many, at least {FEWEST_SAMPLES}, got"
            f" {len(times)} and {len(positions)}."
        )
    steps = [b - a for a, b in itertools.pairwise(times)]
    usual = sorted(steps)[len(steps) // 2]
    if min(steps) <= 0.0:
        at = steps.index(min(steps)) + 1
        raise ParameterError(
            f"SampledSwing.times must increase, got {number(times[at], 6)} s after"
            f" {number(times[at - 1], 6)} s (sample {at})."
        )
    if abs(times[0]) > 1e-6 * usual:
        raise ParameterError(
            f"SampledSwing.times must begin at 0 s, when runs begin, got {number(times[0], 6)} s:"
            " subtract the first time, from all that was recorded with it."
        )
    if max(steps) > GAP_STEPS * usual:
        at = steps.index(max(steps))
        raise ParameterError(
            f"SampledSwing.times have a gap of {number(max(steps), 4)} s after"
            f" {number(times[at], 6)} s, where samples are {number(usual, 4)} s apart: fill it, or"
            " cut the record."
        )


@dataclass(frozen=True, kw_only=True)
class _Smoothed:
    """A spline through the samples of a motion."""

    position: float
    rate: float
    pieces: tuple[Piece, ...]
    noise: float
    error: float


@functools.lru_cache(maxsize=8)
def _smoothed(
    times: tuple[float, ...], positions: tuple[float, ...], spacing: float | None
) -> _Smoothed:
    """Fit a cubic spline with even knots by least squares."""
    t, y = np.array(times), np.array(positions)
    t[0] = 0.0
    end, n = float(t[-1]), len(t)
    if spacing is not None:
        count = max(COARSEST, round(end / spacing))
    else:
        counts = [COARSEST]
        # Not so many that the corrected criterion has no samples left to divide by.
        while counts[-1] * FINER < min((n - 6) // 2, MOST_INTERVALS):
            counts.append(max(counts[-1] + 1, int(counts[-1] * FINER)))
        tiny = n * (1e-14 * float(np.ptp(y) or 1.0)) ** 2  # rounding of floats

        def criterion(count: int) -> float:
            """Return the information criterion of Akaike, corrected for few samples."""
            squares, p = _Spline(t, y, count).squares, count + 4  # with the noise
            return n * math.log(max(squares, tiny) / n) + 2.0 * p * n / (n - p - 1)

        count = min(counts, key=criterion)
    result = _Spline(t, y, count)
    if not math.isfinite(result.squares):
        raise ParameterError(
            f"SampledSwing.spacing (h) is too small for samples as uneven as these, got"
            f" {number(end / count, 4)} s: increase it."
        )
    h, c = end / count, result.weights
    # Second derivative and value of cubic B-splines at their knots, from three weights each.
    bends = ((c[:-2] - 2.0 * c[1:-1] + c[2:]) / h**2).tolist()
    noise = math.sqrt(result.squares / max(n - (count + 3), 1))
    return _Smoothed(
        position=float(c[0] + 4.0 * c[1] + c[2]) / 6.0,
        rate=float(c[2] - c[0]) / (2.0 * h),
        pieces=tuple(
            Piece(k * h, u, (v - u) / h) for k, (u, v) in enumerate(itertools.pairwise(bends))
        ),
        noise=noise,
        error=noise * result.bent_by_noise(h),
    )


class _Spline:
    """Least-squares weights (count + 3,) of cubic B-splines with even knots from 0 to the end."""

    def __init__(self, t: Any, y: Any, count: int) -> None:
        place = t * (count / t[-1])
        cell = np.minimum(place.astype(int), count - 1)
        u = place - cell
        basis = (
            (1.0 - u) ** 3 / 6.0,
            (3.0 * u**3 - 6.0 * u**2 + 4.0) / 6.0,
            (-3.0 * u**3 + 3.0 * u**2 + 3.0 * u + 1.0) / 6.0,
            u**3 / 6.0,
        )
        size = count + 3
        # Each sample sees four splines: the normal equations have four bands.
        bands = np.zeros((4, size))
        for i, share in enumerate(basis):
            for k, other in enumerate(basis[i:]):
                bands[k] += np.bincount(cell + i, share * other, size)
        self.factor = _banded_factor(bands.tolist())
        self.weights, residual = np.zeros(size), y
        for _ in range(2 if self.factor else 0):  # the second round takes off rounding
            right = sum(
                np.bincount(cell + i, item * residual, size) for i, item in enumerate(basis)
            )
            self.weights = self.weights + _banded_solution(self.factor, right)
            residual = y - sum(item * self.weights[cell + i] for i, item in enumerate(basis))
        self.squares = float(residual @ residual) if self.factor else math.inf

    def bent_by_noise(self, h: float) -> float:
        """Return the standard error of the second derivative over that of a sample."""
        size = len(self.weights)
        knots = np.unique(np.linspace(0, size - 3, MOST_KNOTS).astype(int))
        bends = np.zeros((size, len(knots)))
        for i, weight in enumerate((1.0, -2.0, 1.0)):
            bends[knots + i, np.arange(len(knots))] = weight / h**2
        covered = np.sum(bends * _banded_solution(self.factor, bends), axis=0)
        return math.sqrt(float(np.mean(covered)))


def _banded_factor(a: list[list[float]]) -> list[list[float]]:
    """Return the Cholesky factor of bands ``a[k][j] = A[j + k, j]``; empty if there is none."""
    size = len(a[0])
    for j in range(size):
        square = a[0][j] - sum(a[k][j - k] ** 2 for k in range(1, min(4, j + 1)))
        # Knots without samples between them leave a weight undetermined.
        if square <= 1e-12 * a[0][j]:
            return []
        a[0][j] = math.sqrt(square)
        for m in range(1, min(4, size - j)):
            known = sum(a[m + k][j - k] * a[k][j - k] for k in range(1, min(4 - m, j + 1)))
            a[m][j] = (a[m][j] - known) / a[0][j]
    return a


def _banded_solution(factor: list[list[float]], right: Any) -> Any:
    """Solve with the factor of `_banded_factor` for right sides (n,) or (n, m)."""
    result, size = right.copy(), len(right)
    for j in range(size):
        for k in range(1, min(4, j + 1)):
            result[j] -= factor[k][j - k] * result[j - k]
        result[j] /= factor[0][j]
    for j in range(size - 1, -1, -1):
        for k in range(1, min(4, size - j)):
            result[j] -= factor[k][j] * result[j + k]
        result[j] /= factor[0][j]
    return result


# Pulse, sine, ramp, and drives given by points.


@dataclass(frozen=True, kw_only=True)
class Pulse(base.Straight):
    """A constant level for a given duration, zero before and after.

    Examples
    --------
    >>> Pulse(level=10.0, duration=0.1).value(0.099)
    10.0
    """

    level: Annotated[float, Quantity("F_0", "N", or_unit="N m")]
    """Value while it lasts."""
    duration: Annotated[float, Quantity("T", "s", low=0)]
    """How long it lasts."""
    start: Annotated[float, Quantity("t_0", "s")] = 0.0
    """When it begins."""

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        return (
            base.Piece(self.start, self.level, 0.0),
            base.Piece(self.start + self.duration, 0.0, 0.0),
        )


@dataclass(frozen=True, kw_only=True)
class Square(base.Straight):
    """A square wave: in each cycle a high level for a share of the period, then a low one.

    It is 0 before its start, which may lie before time 0: that shifts the wave.

    Examples
    --------
    >>> wave = Square(high=5.0, low=-2.0, period=0.4, duty=0.25)
    >>> [wave.value(t) for t in (0.05, 0.1, 0.39, 0.4)], round(wave.mean, 12)
    ([5.0, -2.0, -2.0, 5.0], -0.25)
    """

    high: Annotated[float, Quantity("F_1", "N", or_unit="N m")]
    """Level in the first part of each cycle."""
    low: Annotated[float, Quantity("F_2", "N", or_unit="N m")] = 0.0
    """Level in the rest of it; negative where it pulls back."""
    period: Annotated[float, Quantity("T", "s", above=0)]
    """Duration of a cycle."""
    duty: Annotated[float, Quantity("D", low=0, high=1)] = 0.5
    """Share of the period that the high level lasts."""
    start: Annotated[float, Quantity("t_0", "s")] = 0.0
    """When the first cycle begins."""

    @property
    def mean(self) -> float:
        """Mean value of a cycle."""
        return self.low + self.duty * (self.high - self.low)

    @override
    def repeats(self) -> float:
        return self.period

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        turn = self.start + self.duty * self.period
        cycle = (base.Piece(self.start, self.high, 0.0), base.Piece(turn, self.low, 0.0))
        # a cycle more than begins: what holds at the end of a run is not the last there is
        span = until - base.least(self.start) + base.least(self.period)
        result = list(base.repeated(type(self).__name__, cycle, self.period, span))
        # a wave that is always high falls where it rises again, but for a rounding error
        for i, following in enumerate(result[1:]):
            start = base.earlier(result[i].start, following.start)
            result[i] = base.Piece(start, result[i].value, result[i].slope)
        return tuple(result)


@dataclass(frozen=True, kw_only=True)
class HalfSine(base.Drive):
    """Pulses that are the half of a sine, one in each cycle, and 0 between them.

    Its pieces are the phase of the pulse, so that both ends are met exactly.

    Examples
    --------
    >>> blows = HalfSine(amplitude=3.0, period=0.4, duty=0.25)
    >>> [round(blows.value(t), 9) for t in (0.05, 0.1, 0.3, 0.45)], round(blows.mean, 9)
    ([3.0, 0.0, 0.0, 3.0], 0.477464829)
    """

    adds: ClassVar[bool] = False

    amplitude: Annotated[float, Quantity("P", "N", or_unit="N m")]
    """Largest value."""
    period: Annotated[float, Quantity("T", "s", above=0)]
    """Duration of a cycle."""
    duty: Annotated[float, Quantity("D", above=0, high=1)] = 0.5
    """Share of the period that the pulse lasts."""
    start: Annotated[float, Quantity("t_0", "s")] = 0.0
    """When the first cycle begins."""

    @property
    def mean(self) -> float:
        """Mean value of a cycle."""
        return 2.0 * self.duty * self.amplitude / math.pi

    @override
    def smooth(self, t: Scalar) -> Scalar:
        return 0.0

    @override
    def shaped(self, linear: Scalar, t: Scalar) -> Scalar:
        return self.amplitude * sin(linear)

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        width = self.duty * self.period
        cycle = (
            base.Piece(self.start, 0.0, math.pi / width),
            base.Piece(self.start + width, 0.0, 0.0),
        )
        # A cycle more, as in `Square`.
        span = until - base.least(self.start) + base.least(self.period)
        return base.repeated(type(self).__name__, cycle, self.period, span)

    @override
    def smooth_bound(self) -> tuple[Scalar, Scalar]:
        # beside the phase, which is from 0 to pi: wider than the values are
        return -abs(self.amplitude), abs(self.amplitude)

    @override
    def repeats(self) -> float:
        return self.period

    @override
    def time_scale(self) -> float:
        return self.duty * self.period


@dataclass(frozen=True, kw_only=True)
class Ramp(base.Straight):
    """Grows at a constant rate from a given time.

    Examples
    --------
    >>> Ramp(rate=2.0, start=1.0).value(3.0)
    4.0
    """

    rate: Annotated[float, Quantity("r", "N/s", or_unit="N m/s")]
    """Growth per second."""
    start: Annotated[float, Quantity("t_0", "s")] = 0.0
    """When it begins."""

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        return (base.Piece(self.start, 0.0, self.rate),)


@dataclass(frozen=True, kw_only=True)
class Sine(base.Drive):
    """A harmonic force, ``amplitude * sin(2 pi frequency t + phase)``.

    Examples
    --------
    >>> round(Sine(amplitude=25.0, frequency=0.25).value(1.0), 12)
    25.0
    """

    amplitude: Annotated[float, Quantity("P", "N", or_unit="N m")]
    """Largest value."""
    frequency: Annotated[float, Quantity("f", "Hz", above=0)]
    """Cycles per second."""
    phase: Annotated[float, Quantity("phi", "rad")] = 0.0
    """Angle at time 0."""

    @override
    def smooth(self, t: Scalar) -> Scalar:
        return self.amplitude * sin(2.0 * math.pi * self.frequency * t + self.phase)

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        return ()

    @override
    def smooth_bound(self) -> tuple[Scalar, Scalar]:
        return -abs(self.amplitude), abs(self.amplitude)

    @override
    def repeats(self) -> float:
        return 1.0 / self.frequency

    @override
    def time_scale(self) -> float:
        return 1.0 / self.frequency


def _numbers(owner: str, series: object) -> list[float]:
    """Return a series as floats, or say that it is none."""
    result = []
    for x in series if isinstance(series, Iterable) else (series, None):
        if isinstance(x, bool) or not isinstance(x, numbers.Real):
            raise ParameterError(
                f"{owner}.times [s] and .values must be series of numbers, got {series!r}."
            )
        result.append(float(x))
    return result


def _series(
    owner: str, times: Sequence[float], values: Sequence[float]
) -> tuple[list[float], list[float]]:
    """Return checked points: as many times as values, finite, times increasing."""
    t, u = (_numbers(owner, series) for series in (times, values))
    if len(t) != len(u) or not t:
        raise ParameterError(
            f"{owner}.times and .values must have the same length of at least 1,"
            f" got {len(t)} and {len(u)}."
        )
    if not all(map(math.isfinite, t + u)):
        raise ParameterError(f"{owner}.times [s] and .values must be finite numbers.")
    for before, after in itertools.pairwise(t):
        if after <= before:
            raise ParameterError(
                f"{owner}.times [s] must increase, got {before:g} before {after:g}."
            )
    return t, u


@dataclass(frozen=True, kw_only=True)
class PiecewiseLinear(base.Straight):
    """Linear interpolation between points, with constant values before and after.

    Examples
    --------
    >>> PiecewiseLinear(times=(0.0, 10.0), values=(0.0, 1.5)).value(5.0)
    0.75
    """

    data_fields: ClassVar[tuple[str, ...]] = ("times", "values")

    times: tuple[float, ...]
    """Times of the points [s], increasing."""
    values: tuple[float, ...]
    """Values at the points."""

    if TYPE_CHECKING:  # any series is taken and kept as a tuple

        def __init__(self, *, times: Numbers, values: Numbers) -> None: ...

    def __post_init__(self) -> None:
        """Check the points and keep them as tuples of floats."""
        super().__post_init__()
        t, u = _series(type(self).__name__, self.times, self.values)
        object.__setattr__(self, "times", tuple(t))
        object.__setattr__(self, "values", tuple(u))

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        t, u = self.times, self.values
        inner = [
            base.Piece(t[i], u[i], (u[i + 1] - u[i]) / (t[i + 1] - t[i])) for i in range(len(t) - 1)
        ]
        return (base.Piece(base.BEGINNING, u[0], 0.0), *inner, base.Piece(t[-1], u[-1], 0.0))


@dataclass(frozen=True, kw_only=True)
class Sampled(base.Straight):
    """Values of a sampled signal: held until the next sample, or interpolated linearly.

    Examples
    --------
    >>> Sampled(times=(0.0, 0.1, 0.2), values=(1.0, 3.0, 2.0)).value(0.15)
    3.0
    """

    data_fields: ClassVar[tuple[str, ...]] = ("times", "values", "hold")

    times: tuple[float, ...]
    """Times of the samples [s], increasing."""
    values: tuple[float, ...]
    """Samples."""
    hold: Literal["zero", "first"] = "zero"
    """Order of the hold: ``"zero"`` keeps the value, ``"first"`` joins the samples."""

    if TYPE_CHECKING:  # any series is taken and kept as a tuple

        def __init__(
            self, *, times: Numbers, values: Numbers, hold: Literal["zero", "first"] = "zero"
        ) -> None: ...

    def __post_init__(self) -> None:
        """Check the samples and keep them as tuples of floats."""
        super().__post_init__()
        t, u = _series(type(self).__name__, self.times, self.values)
        if self.hold not in ("zero", "first"):
            raise ParameterError(f"Sampled.hold must be 'zero' or 'first', got {self.hold!r}.")
        object.__setattr__(self, "times", tuple(t))
        object.__setattr__(self, "values", tuple(u))

    @property
    @override
    def steady(self) -> bool:
        return len(self.values) == 1

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        if self.hold == "first":
            return PiecewiseLinear(times=self.times, values=self.values).pieces()
        held = [base.Piece(t, u, 0.0) for t, u in zip(self.times, self.values, strict=True)]
        return (base.Piece(base.BEGINNING, self.values[0], 0.0), *held[1:])


@dataclass(frozen=True, kw_only=True)
class PiecewiseAffine(base.Straight):
    """Straight lines that need not join: what a long signal is condensed to.

    The last one is held from its start on.

    Examples
    --------
    >>> PiecewiseAffine(times=(0.0, 0.1), values=(1.0, 3.0), slopes=(5.0, 0.0)).value(0.05)
    1.25
    """

    data_fields: ClassVar[tuple[str, ...]] = ("times", "values", "slopes")

    times: tuple[float, ...]
    """Times at which pieces begin [s], increasing; the first one holds before, too."""
    values: tuple[float, ...]
    """Value at the start of each piece."""
    slopes: tuple[float, ...]
    """Change a second in each piece; 0 for the last one."""

    if TYPE_CHECKING:  # any series is taken and kept as a tuple

        def __init__(self, *, times: Numbers, values: Numbers, slopes: Numbers) -> None: ...

    def __post_init__(self) -> None:
        """Check the pieces and keep them as tuples of floats."""
        super().__post_init__()
        t, u = _series(type(self).__name__, self.times, self.values)
        _, k = _series(type(self).__name__, self.times, self.slopes)
        if k[-1] != 0.0:
            raise ParameterError(f"PiecewiseAffine.slopes must end with 0, got {k[-1]:g}.")
        for name, axis in (("times", t), ("values", u), ("slopes", k)):
            object.__setattr__(self, name, tuple(axis))

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        held = [
            base.Piece(*piece) for piece in zip(self.times, self.values, self.slopes, strict=True)
        ]
        return (base.Piece(base.BEGINNING, self.values[0], 0.0), *held)


# The drives by name.

DRIVES: Mapping[str, type[Drive]] = MappingProxyType(
    {
        "delayed-feedback": DelayedFeedback,
        "feedback": Feedback,
        "half-sine": HalfSine,
        "piecewise-linear": PiecewiseLinear,
        "pulse": Pulse,
        "ramp": Ramp,
        "relay": Relay,
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
