"""Sums of drives."""

from dataclasses import dataclass
from typing import final

from typing_extensions import override

from stickslip.drives.base import Drive, Piece
from stickslip.maths import Scalar

__all__ = ["Sum"]


@final
@dataclass(frozen=True, kw_only=True)
class Sum(Drive):
    """The sum of several drives; written with ``+``.

    Examples
    --------
    >>> from stickslip import Pulse, Sine
    >>> (Pulse(level=2.0, duration=1.0) + Sine(amplitude=1.0, frequency=0.25)).value(1.0)
    1.0
    """

    parts: tuple[Drive, ...]

    @override
    def smooth(self, t: Scalar) -> Scalar:
        return sum((part.smooth(t) for part in self.parts), 0.0)

    @override
    def pieces(self) -> tuple[Piece, ...]:
        tables = [part.pieces() for part in self.parts]
        starts = sorted({float(piece.start) for table in tables for piece in table})
        return tuple(
            Piece(start, sum(v for v, _ in at), sum(s for _, s in at))
            for start in starts
            for at in [[_at(table, start) for table in tables]]
        )

    @override
    def smooth_bound(self) -> tuple[Scalar, Scalar]:
        bounds = [part.smooth_bound() for part in self.parts]
        return sum((low for low, _ in bounds), 0.0), sum((high for _, high in bounds), 0.0)

    @override
    def time_scale(self) -> float:
        return min(part.time_scale() for part in self.parts)


def _at(table: tuple[Piece, ...], t: float) -> tuple[Scalar, Scalar]:
    """Return value and slope of the piece that holds at `t`."""
    value, slope = 0.0, 0.0
    for piece in table:
        if piece.start > t:
            break
        value, slope = piece.value + piece.slope * (t - piece.start), piece.slope
    return value, slope
