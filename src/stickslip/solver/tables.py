"""Numbers that a run starts from: parameters, pieces of the drives, their bounds."""

import bisect
import itertools
import math
from dataclasses import dataclass

from stickslip.drives import Drive, Piece
from stickslip.drives.base import BEGINNING
from stickslip.formulation import Model
from stickslip.friction import FrictionLaw
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters

__all__ = ["Inputs", "gather"]

SHORTEST = 8
"""Units in the last place of the time that a piece must last."""


@dataclass(frozen=True)
class Inputs:
    """The vectors that kernels take, as lists."""

    p: list[float]
    """Parameters."""
    first: int
    """Place of the first parameter in the vector of a run."""
    table: list[float]
    """A row a piece: start, then value, slope and start of each drive."""
    bounds: list[float]
    """For each row, least and largest value of each drive from its start on."""
    time_scale: float
    """Shortest time in which a drive changes much."""


def gather(mechanism: Mechanism, law: FrictionLaw, model: Model) -> Inputs:
    """Collect the numbers of a mechanism and a law in the order of the model."""
    values = {
        path: value
        for root, prefix in ((mechanism, "mechanism"), (law, "friction"))
        for path, _, value in parameters(root, prefix)
    }
    drives = list(mechanism.drives().values())
    tables = [_pieces(drive) for drive in drives]
    starts = _apart(sorted({piece.start for table in tables for piece in table} | {BEGINNING}))
    rows = [[_piece_at(table, start) for table in tables] for start in starts]
    table = [
        number for start, row in zip(starts, rows, strict=True) for number in (start, *sum(row, ()))
    ]
    return Inputs(
        p=[float(values[path]) for path in model.parameter_paths],
        first=model.first_parameter,
        table=table,
        bounds=_bounds(drives, starts, rows),
        time_scale=min((drive.time_scale() for drive in drives), default=math.inf),
    )


def _apart(starts: list[float]) -> list[float]:
    """Drop pieces that last no longer than roundings of the time: what they do is a jump."""
    return [
        start
        for start, following in itertools.pairwise([*starts, math.inf])
        if following == math.inf or following - start > SHORTEST * math.ulp(following)
    ]


def _pieces(drive: Drive) -> list[Piece]:
    return [Piece(*(float(number) for number in piece)) for piece in drive.pieces()]


def _piece_at(table: list[Piece], t: float) -> tuple[float, ...]:
    """Return value, slope and start of the piece that holds at a time."""
    index = bisect.bisect_right(table, t, key=lambda piece: piece.start) - 1
    if index < 0:
        return 0.0, 0.0, 0.0
    return table[index].value, table[index].slope, table[index].start


def _bounds(
    drives: list[Drive], starts: list[float], rows: list[list[tuple[float, ...]]]
) -> list[float]:
    """Return least and largest value of each drive from each row's start on, row by row."""
    bounds = [[(0.0, 0.0)] * len(drives) for _ in rows]
    for k, drive in enumerate(drives):
        low_smooth, high_smooth = (float(bound) for bound in drive.smooth_bound())
        low, high = math.inf, -math.inf
        for r in range(len(rows) - 1, -1, -1):
            value, slope, origin = rows[r][k]
            end = starts[r + 1] if r + 1 < len(rows) else math.inf
            last = value if slope == 0 else value + slope * (end - origin)
            first = value if slope == 0 else value + slope * (starts[r] - origin)
            low, high = min(low, first, last), max(high, first, last)
            bounds[r][k] = (low + low_smooth, high + high_smooth)
    return [number for row in bounds for pair in row for number in pair]
