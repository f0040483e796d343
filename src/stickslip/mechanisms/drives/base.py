"""What a drive is: a quantity given as a function of time."""

import math
from abc import ABC, abstractmethod
from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple, final

import numpy as np
from typing_extensions import override

from stickslip.errors import ParameterError
from stickslip.maths import Scalar
from stickslip.quantities import Parametrised
from stickslip.show.formatting import number

BEGINNING = -1e300
"""Start of a piece that has always held; finite, so that slope 0 times the time since it is 0."""


MOST_PIECES = 1_000_000
"""Pieces of a drive that repeats itself that a run may have."""


class Piece(NamedTuple):
    """A stretch of time, up to the next piece, in which a part of the drive is linear.

    Before the first piece that part is zero.
    """

    start: Scalar
    """When it begins [s]."""
    value: Scalar
    """Value at the start."""
    slope: Scalar
    """Change per second."""


@dataclass(frozen=True, kw_only=True)
class Drive(Parametrised, ABC):
    """A force, torque or position: a smooth part and a piecewise linear one in time, and feedback.

    The solver stops at the start of every piece and loads its numbers, so jumps and kinks are met
    exactly however short they are.
    """

    wanted: ClassVar[str] = "a drive such as Sine(...)"
    moves: ClassVar[bool] = False
    """Whether the value is the acceleration of a motion, which no force or torque can be."""
    adds: ClassVar[bool] = True
    """Whether its value is its smooth part and its linear part together."""

    @override
    @classmethod
    def instead(cls, given: object) -> str:
        if isinstance(given, Drive):
            cure = (
                "A motion profile is an acceleration: a motor takes it, as Prescribed(profile=...),"
                " in a mechanism that has one, such as Capsule or PendulumCart."
            )
            return cure if given.moves else ""
        sampled = "Sampled(times=t, values=[f(s) for s in t], hold='first')"
        if isinstance(given, (int, float)):
            return f"A constant is Sampled(times=[0.0], values=[{given:g}])."
        if callable(given):
            return f"Give samples of the function f, {sampled}, or a sum of drives."
        if isinstance(given, (list, tuple)) or hasattr(given, "__array__"):
            return "Give the times of the samples too: Sampled(times=..., values=...)."
        return ""

    @abstractmethod
    def smooth(self, t: Scalar) -> Scalar:
        """Return the part that is one expression for all times; 0.0 where there is none."""

    @abstractmethod
    def pieces(self, until: float = 0.0) -> tuple[Piece, ...]:
        """Return the pieces of the linear part in the order of time; empty where there are none.

        A drive that repeats itself gives those that begin up to `until` [s], and perhaps more.
        """

    def shaped(self, linear: Scalar, t: Scalar) -> Scalar:  # pieces are a phase for some
        """Return the value from what the pieces give, and the time.

        Parameters
        ----------
        linear : float or array
            Value of the piece that holds then.
        t : float or array
            Time [s].

        Returns
        -------
        float or array
            Value of the drive.
        """
        return linear + self.smooth(t)

    def fed(self, states: Mapping[str, Scalar]) -> Scalar:
        """Return the part that follows states, from coordinates and rates by name."""
        return 0.0

    @abstractmethod
    def smooth_bound(self) -> tuple[Scalar, Scalar]:
        """Return the least and the largest value of the smooth part."""

    @abstractmethod
    def time_scale(self) -> float:
        """Return the shortest time in which the smooth part changes much [s], or infinity."""

    def repeats(self) -> float | None:
        """Return the duration of a cycle [s], None where the drive does not repeat itself."""
        return None

    @property
    def steady(self) -> bool:
        """Whether it does not depend on time from time 0 on."""
        return False

    def value(self, t: float) -> float:
        """Return the value at a time, without what follows states.

        Examples
        --------
        >>> from stickslip.mechanisms.drives import Pulse
        >>> push = Pulse(level=10.0, duration=0.1)
        >>> push.value(0.05), push.value(0.1)
        (10.0, 0.0)
        """
        pieces = self.pieces(t)
        linear, _ = _at(pieces, [piece.start for piece in pieces], t)
        return float(self.shaped(linear, t))

    def __add__(self, other: "Drive") -> "Sum":
        """Add two drives."""
        if not isinstance(other, Drive):
            return NotImplemented
        return Sum(parts=(self, other))


@dataclass(frozen=True, kw_only=True)
class Straight(Drive, ABC):
    """A drive without a smooth part."""

    @final
    @override
    def smooth(self, t: Scalar) -> Scalar:
        return 0.0

    @final
    @override
    def smooth_bound(self) -> tuple[Scalar, Scalar]:
        return 0.0, 0.0

    @final
    @override
    def time_scale(self) -> float:
        return math.inf


@dataclass(frozen=True, kw_only=True)
class Sum(Drive):
    """The sum of several drives; written with ``+``.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Pulse, Sine
    >>> (Pulse(level=2.0, duration=1.0) + Sine(amplitude=1.0, frequency=0.25)).value(1.0)
    1.0
    """

    parts: tuple[Drive, ...]
    """What is added, at least one drive."""

    def __post_init__(self) -> None:
        """Check that there is something to add."""
        super().__post_init__()
        if not self.parts:
            raise ParameterError("Sum.parts must contain at least one drive, got none.")
        for part in self.parts:
            cure = self.instead(part)
            if cure or not isinstance(part, Drive):
                raise ParameterError(
                    f"Sum.parts must contain drives such as Sine(...), got {part!r}. {cure}".strip()
                )
            if not part.adds:
                raise ParameterError(
                    f"Sum.parts cannot contain {type(part).__name__}, whose pieces are a phase."
                    " Give it alone."
                )

    @override
    def smooth(self, t: Scalar) -> Scalar:
        return sum((part.smooth(t) for part in self.parts), 0.0)

    @override
    def fed(self, states: Mapping[str, Scalar]) -> Scalar:
        return sum((part.fed(states) for part in self.parts), 0.0)

    @override
    def pieces(self, until: float = 0.0) -> tuple[Piece, ...]:
        tables = [part.pieces(until) for part in self.parts]
        begins = [[float(piece.start) for piece in table] for table in tables]
        return tuple(
            # At each start of any part the values and slopes of all are summed anew.
            Piece(start, sum(v for v, _ in at), sum(s for _, s in at))
            for start in sorted({start for starts in begins for start in starts})
            for at in [[_at(*part, start) for part in zip(tables, begins, strict=True)]]
        )

    @override
    def smooth_bound(self) -> tuple[Scalar, Scalar]:
        bounds = [part.smooth_bound() for part in self.parts]
        return sum((low for low, _ in bounds), 0.0), sum((high for _, high in bounds), 0.0)

    @override
    def time_scale(self) -> float:
        return min(part.time_scale() for part in self.parts)


def repeated(owner: str, cycle: Sequence[Piece], period: Scalar, until: float) -> tuple[Piece, ...]:
    """Return the pieces of a cycle again and again: of all cycles that begin up to a time.

    Examples
    --------
    >>> [piece.start for piece in repeated("Beat", [Piece(0.0, 1.0, 0.0)], 0.5, 1.2)]
    [0.0, 0.5, 1.0]
    """
    # Of several periods the shortest, so that every row has cycles enough.
    shortest = least(period)
    count = max(0.0, until) / shortest
    if not count * len(cycle) < MOST_PIECES:
        raise ParameterError(
            f"{owner}: a run to t_end = {number(until, 6)} s would have {number(count)} cycles of"
            f" {number(shortest)} s, more than the limit of"
            f" {number(MOST_PIECES // len(cycle), 7)}: shorten the run."
        )
    return tuple(
        Piece(piece.start + k * period, piece.value, piece.slope)
        for k in range(math.floor(count) + 1)
        for piece in cycle
    )


def earlier(first: Scalar, second: Scalar) -> Scalar:
    """Return the earlier of two times, or of (n,) of them one by one; parts may be imaginary.

    Examples
    --------
    >>> earlier(1.0, 2.0), earlier(3.0, 2.0)
    (1.0, 2.0)
    """
    # By real parts: imaginary ones carry derivatives and do not count in order.
    if np.ndim(first) == np.ndim(second) == 0:
        return second if np.real(second) < np.real(first) else first
    return np.where(np.real(second) < np.real(first), second, first)


def least(values: Any) -> float:
    """Return the least of one number or several, whose derivatives may be imaginary parts.

    Examples
    --------
    >>> least([0.5, 0.2 + 1e-30j])
    0.2
    """
    return float(np.min(np.real(values)))


def _at(table: Sequence[Piece], starts: Sequence[float], t: float) -> tuple[Scalar, Scalar]:
    """Return value and slope of the piece that holds at `t`."""
    # A piece holds from its start on, the start included.
    index = bisect_right(starts, t) - 1
    if index < 0:
        return 0.0, 0.0
    piece = table[index]
    return piece.value + piece.slope * (t - piece.start), piece.slope


def parts_of(drive: Drive) -> list[Drive]:
    """Return the drives that are added to make one; itself if it is no sum.

    Examples
    --------
    >>> from stickslip.mechanisms.drives import Pulse, Sine
    >>> push, shake = Pulse(level=2.0, duration=1.0), Sine(amplitude=1.0, frequency=0.25)
    >>> parts_of(push + (shake + push)) == [push, shake, push]
    True
    """
    if not isinstance(drive, Sum):
        return [drive]
    return [sub for part in drive.parts for sub in parts_of(part)]
