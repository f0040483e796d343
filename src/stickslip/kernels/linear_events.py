"""Where a step of a linear mode first violates a guard: guards are polynomials there."""

from stickslip.kernels.backend import Vector
from stickslip.kernels.bernstein import FALLS_AT_ONCE, first_fall
from stickslip.kernels.enums import STOP
from stickslip.kernels.guard_roots import NO_GUARD, note_least
from stickslip.kernels.model_interface import (
    N_COORDINATES,
    N_GUARDS,
    N_STATES,
    SLIP,
    field,
    guard_slopes,
    guards,
)
from stickslip.kernels.state_layout import (
    DENSE,
    DRIFT,
    FRACTION,
    MATRIX,
    POINT,
    POLYNOMIAL,
    REACHED,
    SERIES,
    SLOPES,
    VALUES,
    Y,
)

__all__ = ["first_crossing"]

BALANCED = 4e-15
"""Acceleration over the forces that make it up, below which they balance but for rounding."""


def guard_polynomial(guard: int, h: float, w: Vector) -> int:
    """Write the coefficients of one guard in the fraction of the step; return the degree.

    Reads: VALUES, DENSE, REACHED, LOWEST, SLOPES.
    Writes: REACHED, LOWEST, POLYNOMIAL.
    """
    n = N_STATES
    row = SLOPES + guard * (n + 1)
    w[POLYNOMIAL] = w[VALUES + guard]
    last = w[VALUES + guard]
    degree = 0
    for k in range(1, int(w[DENSE]) + 1):
        total = h * w[row + n] if k == 1 else 0.0
        for i in range(n):
            total += w[row + i] * w[DENSE + 1 + k * n + i]
        w[POLYNOMIAL + k] = total
        last += total
        if total != 0.0:
            degree = k
    w[REACHED + guard] = max(w[REACHED + guard], abs(w[VALUES + guard]), abs(last))
    note_least(guard, min(w[VALUES + guard], last), w)
    return degree


def quiet_start(flags: int, t: float, h: float, w: Vector) -> None:
    """Drop the first slope of a body at rest where forces balance but for their rounding.

    Reads: Y, MATRIX, DRIFT, POLYNOMIAL.
    Writes: POINT, POLYNOMIAL.
    """
    field(1, flags, t, w, Y, POINT)
    size = w[POINT + SLIP]
    field(-1, flags, t, w, Y, POINT)
    size = abs(size - w[POINT + SLIP]) + abs(w[DRIFT + SLIP] * t)
    for i in range(N_STATES):
        size += abs(w[MATRIX + SLIP * N_STATES + i] * w[Y + i])
    if abs(w[POLYNOMIAL + 1]) <= BALANCED * h * size:
        w[POLYNOMIAL + 1] = 0.0
        if N_COORDINATES == 1 and w[DRIFT + SLIP] == 0.0:  # nor is there anything to follow
            for k in range(2, SERIES + 1):
                w[POLYNOMIAL + k] = 0.0


def first_crossing(mode: int, flags: int, t: float, h: float, w: Vector) -> int:
    """Find the first violated guard of a step, with its fraction in FRACTION.

    The fraction is 0 where a guard that starts at zero falls below it at once.

    Reads: Y, MATRIX, DRIFT, DENSE, REACHED, LOWEST.
    Writes: FRACTION, POINT, VALUES, REACHED, LOWEST, SLOPES, POLYNOMIAL, ROOM.

    Parameters
    ----------
    mode : int
        Contact mode: 1 or -1 slip, 0 stick, 2 or -2 pressed against a stop.
    flags : int
        Bit j is set where the condition of switch j holds.
    t : float
        Time [s].
    h : float
        Length of the step [s].
    w : array (SIZE,)
        Vector of the run.

    Returns
    -------
    int
        Index of the guard, or `NO_GUARD`.
    """
    guards(mode, flags, t, w, Y, VALUES)
    guard_slopes(mode, flags, t, w, Y, SLOPES)
    best = NO_GUARD
    w[FRACTION] = 1.0
    for guard in range(N_GUARDS):
        degree = guard_polynomial(guard, h, w)
        if degree == 0 and w[POLYNOMIAL] >= 0.0:
            continue
        if guard == STOP and mode != 0 and w[Y + SLIP] == 0.0:
            quiet_start(flags, t, h, w)
        x = first_fall(w, degree)
        if x == FALLS_AT_ONCE:
            w[FRACTION] = 0.0
            return guard
        if x < w[FRACTION] or (x == 1.0 and best == NO_GUARD):
            w[FRACTION] = x
            best = guard
    return best
