"""Motion profiles: what moves a pendulum or an inner mass as it is told, again and again."""

import itertools
import math
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, final

from typing_extensions import override

from stickslip.drives.base import Drive, Piece, Straight, repeated
from stickslip.errors import ParameterError
from stickslip.formatting import number
from stickslip.maths import Scalar, sin, sqrt
from stickslip.quantities import Numbers, Quantity

__all__ = ["Profile", "SevenStep", "SineSwing", "SplineSwing", "ThreePhase"]


@dataclass(frozen=True, kw_only=True)
class Profile(Drive, ABC):
    """A periodic motion, given by its acceleration [rad/s^2] or [m/s^2].

    As a drive its value is the acceleration; `start_position` and `start_rate` are where it begins.
    """

    wanted: ClassVar[str] = "a motion profile such as ThreePhase(...)"

    @override
    @classmethod
    def instead(cls, given: object) -> str:
        return ""

    @property
    @abstractmethod
    def period(self) -> float:
        """Duration of a cycle [s]."""

    @property
    @abstractmethod
    def start_position(self) -> float:
        """Position [rad] or [m] at time 0."""

    @property
    def start_rate(self) -> float:
        """Rate [rad/s] or [m/s] at time 0."""
        return 0.0

    @final
    @override
    def repeats(self) -> float:
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
        left = t % float(self.period)
        position, rate = float(self.start_position), float(self.start_rate)
        pieces = self.cycle()
        ends = [*(float(piece.start) for piece in pieces[1:]), float(self.period)]
        for piece, end in zip(pieces, ends, strict=True):
            h = min(left, end) - float(piece.start)
            if h <= 0.0:
                break
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


@final
@dataclass(frozen=True, kw_only=True)
class ThreePhase(Stepped):
    """There and back in three phases of constant acceleration, of which the middle one differs.

    From minus the amplitude at rest it accelerates, brakes beyond the turning point at the
    amplitude, and comes back to rest where it began. With ``first="fast"`` the outer phases are the
    fast ones: ``+fast``, ``-slow``, ``+fast``; with ``first="slow"`` the middle one is.

    Examples
    --------
    >>> import math
    >>> swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    >>> round(float(swing.period), 5)
    0.7236
    """

    amplitude: Annotated[float, Quantity("theta_m", "rad", above=0, or_unit="m")]
    """Half the way between the turning points, about 0."""
    fast: Annotated[float, Quantity("A_1", "rad/s^2", above=0, or_unit="m/s^2")]
    """Size of the large acceleration."""
    slow: Annotated[float, Quantity("A_2", "rad/s^2", above=0, or_unit="m/s^2")]
    """Size of the small acceleration."""
    first: Literal["fast", "slow"] = "fast"
    """What the outer phases are."""

    @override
    def __post_init__(self) -> None:
        """Check the settings."""
        super().__post_init__()
        if self.first not in ("fast", "slow"):
            raise ParameterError(f"ThreePhase.first must be 'fast' or 'slow', got {self.first!r}.")

    @property
    def _pair(self) -> tuple[Scalar, Scalar]:
        """Sizes of the outer and of the middle acceleration."""
        return (self.fast, self.slow) if self.first == "fast" else (self.slow, self.fast)

    @property
    def peak_rate(self) -> float:
        """Largest rate, on the way there and on the way back."""
        rate: float = sqrt(4.0 * self.amplitude / (1.0 / self.fast + 1.0 / self.slow))
        return rate

    @property
    @override
    def period(self) -> float:
        return 2.0 * self.peak_rate * (1.0 / self.fast + 1.0 / self.slow)

    @property
    @override
    def start_position(self) -> float:
        return -self.amplitude

    @override
    def cycle(self) -> tuple[Piece, ...]:
        outer, middle = self._pair
        rate = self.peak_rate
        times = (rate / outer, 2.0 * rate / middle, rate / outer)
        return _steps(times, (outer, -middle, outer))


@final
@dataclass(frozen=True, kw_only=True)
class SevenStep(Stepped):
    """There and back with a rate that is limited, and a pause: up to seven steps.

    Forwards it accelerates fast, cruises at the top rate and brakes slowly; backwards it
    accelerates slowly, cruises and brakes fast; then it pauses. Without the pause these are six
    steps, and with a top rate that is just reached they are the three phases. The steps are ours:
    profiles of that name in the literature differ.

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
    """Rate of the cruise."""
    pause: Annotated[float, Quantity("t_p", "s", low=0)] = 0.0
    """How long it rests at the end of a cycle."""

    @override
    def __post_init__(self) -> None:
        """Check that the top rate is reached."""
        super().__post_init__()
        if self._cruise < 0.0:
            most = math.sqrt(4.0 * self.amplitude / (1.0 / self.fast + 1.0 / self.slow))
            raise ParameterError(
                f"SevenStep.top_rate (Omega) must be at most {number(most, 4)} rad/s, the rate"
                f" that the accelerations reach, got {number(self.top_rate, 6)}."
            )

    @property
    def _cruise(self) -> float:
        """Duration of a cruise [s]."""
        ramps = 0.5 * self.top_rate * (1.0 / self.fast + 1.0 / self.slow)
        return 2.0 * self.amplitude / self.top_rate - ramps

    @property
    @override
    def period(self) -> float:
        ramps = 2.0 * self.top_rate * (1.0 / self.fast + 1.0 / self.slow)
        return 2.0 * self._cruise + ramps + self.pause

    @property
    @override
    def start_position(self) -> float:
        return -self.amplitude

    @override
    def cycle(self) -> tuple[Piece, ...]:
        rise, fall = self.top_rate / self.fast, self.top_rate / self.slow
        times = (rise, self._cruise, fall, fall, self._cruise, rise, self.pause)
        signs = (self.fast, 0.0, -self.slow, -self.slow, 0.0, self.fast, 0.0)
        return _steps(times, signs)


@final
@dataclass(frozen=True, kw_only=True)
class SineSwing(Profile):
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
    @override
    def start_position(self) -> float:
        return -self.amplitude

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


@final
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

    @override
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
        return self._scaled()[0] / self.duration

    def _scaled(self) -> tuple[float, list[float]]:
        """Return first rate and the accelerations at the knots, for a cycle of 1 s."""
        import numpy as np

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
        _, knots = self._scaled()
        n, length = len(self.positions), self.duration
        square = length * length
        return tuple(
            Piece(i * length / n, a / square, (b - a) * n / (square * length))
            for i, (a, b) in enumerate(itertools.pairwise(knots))
        )
