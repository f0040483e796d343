"""Pulse, sine, ramp, and drives given by points."""

import itertools
import math
import numbers
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from typing_extensions import override

from stickslip.errors import ParameterError
from stickslip.maths import Scalar, sin
from stickslip.mechanisms.drives import base
from stickslip.quantities import Numbers, Quantity


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
        found = list(base.repeated(type(self).__name__, cycle, self.period, span))
        # a wave that is always high falls where it rises again, but for a rounding error
        for i, following in enumerate(found[1:]):
            start = base.earlier(found[i].start, following.start)
            found[i] = base.Piece(start, found[i].value, found[i].slope)
        return tuple(found)


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
    found = []
    for x in series if isinstance(series, Iterable) else (series, None):
        if isinstance(x, bool) or not isinstance(x, numbers.Real):
            raise ParameterError(
                f"{owner}.times [s] and .values must be series of numbers, got {series!r}."
            )
        found.append(float(x))
    return found


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
        for name, found in (("times", t), ("values", u), ("slopes", k)):
            object.__setattr__(self, name, tuple(found))

    @override
    def pieces(self, until: float = 0.0) -> tuple[base.Piece, ...]:
        held = [
            base.Piece(*piece) for piece in zip(self.times, self.values, self.slopes, strict=True)
        ]
        return (base.Piece(base.BEGINNING, self.values[0], 0.0), *held)
