"""What errors are judged against: the sizes that the states have had in the run."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.equations import FIELD, evaluate
from stickslip.kernels.mode_transitions import set_flags
from stickslip.kernels.state_layout import (
    DENSE,
    N_COORDINATES,
    N_STATES,
    POINT,
    PULLS,
    SCALE,
    SERIES,
    SLIP,
    VALUES,
    Y1,
    Y,
)

LEAST = 1e-9
"""Least speed that counts, over that which the contact's own force gives in the time of the run."""

BALANCED = 1e-3
"""Size of a rate, over what a single force gives it in a step, of which others leave little: with a
tolerance of 1e-12, errors of 1e-15 of it count, and its rounding does not."""
TAIL = 1e-16
"""Size of the last two terms of a series, over that of the state, that a step may have."""
VANISHED = 1e-18
"""Size of a term, over the largest of its state, below which a series has ended."""


def first_sizes(t: float, t_end: float, w: Vector, whole: Wholes) -> None:
    """Set the sizes at the start.

    A body at rest has no speed to compare with. Where friction falls steeply from rest, it leaves
    as a power of time, which no relative error control gets started; a floor far below any speed
    of interest does. It follows from the forces at rest, and so from the scale of the problem.
    """
    n = whole[N_STATES]
    scale = whole[SCALE]
    y = whole[Y]
    point = whole[POINT]
    slip = whole[SLIP]
    values = whole[VALUES]
    for i in range(n):
        w[scale + i] = abs(w[y + i])
        w[point + i] = w[y + i]
    w[point + slip] = 0.0
    flags = set_flags(t, w, whole, point, 0, 0)
    evaluate(FIELD, 1, flags, t, w, point, values)
    forward = w[values + slip]
    evaluate(FIELD, -1, flags, t, w, point, values)
    floor = LEAST * 0.5 * abs(forward - w[values + slip]) * (t_end - t)
    w[scale + slip] = max(w[scale + slip], floor)


def size_of(i: int, h: float, w: Vector, whole: Wholes) -> float:
    """Return what an error of state `i` in a step is judged against."""
    scale = whole[SCALE]
    coordinates = whole[N_COORDINATES]
    size = max(w[scale + i], abs(w[whole[Y] + i]), abs(w[whole[Y1] + i]))
    if i < coordinates:
        return max(size, abs(h) * w[scale + i + coordinates])
    if i < 2 * coordinates:
        return max(size, BALANCED * abs(h) * w[whole[PULLS] + i - coordinates])
    return size


def series_tail(h: float, w: Vector, whole: Wholes) -> float:
    """Return the tail of the series in the dense output over what is allowed."""
    dense = whole[DENSE]
    n = whole[N_STATES]
    error = 0.0
    if w[dense] >= SERIES:
        last = dense + 1 + SERIES * n
        for i in range(n):
            tail = abs(w[last + i]) + abs(w[last - n + i])
            if not tail < math.inf:
                return math.inf
            size = TAIL * size_of(i, h, w, whole)
            if tail > 0.0:
                error = max(error, tail / size if size > 0.0 else math.inf)
    return error
