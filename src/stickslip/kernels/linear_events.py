"""Where a step of a linear mode first violates a guard: guards are polynomials there."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.bernstein import FALLS_AT_ONCE, first_fall
from stickslip.kernels.enums import STOP, SWITCH
from stickslip.kernels.equations import FIELD, evaluate
from stickslip.kernels.guard_roots import NO_GUARD, note_least
from stickslip.kernels.mode_transitions import UNMOVED
from stickslip.kernels.model_interface import guard_slopes, guards
from stickslip.kernels.state_layout import (
    DENSE,
    DRIFT,
    FIRST_LIMIT,
    FLAGS,
    FRACTION,
    MATRIX,
    MODE,
    N_COORDINATES,
    N_GUARDS,
    N_STATES,
    N_WAVES,
    POINT,
    POLYNOMIAL,
    REACHED,
    SERIES,
    SLIP,
    SLOPES,
    VALUES,
    WAVES,
    Y,
)
from stickslip.kernels.taylor_series import wave_at

BALANCED = 4e-15
"""Acceleration over the forces that make it up, below which they balance but for rounding."""


def guard_waves(guard: int, w: Vector, whole: Wholes) -> bool:
    """Whether a guard of one contact has a harmonic term in this step."""
    if whole[N_WAVES] == 0:
        return False
    own = whole[WAVES] + SERIES + 1 + whole[N_STATES] + guard
    return w[own] != 0.0 or w[own + whole[N_WAVES]] != 0.0


def guard_polynomial(guard: int, h: float, w: Vector, whole: Wholes) -> int:
    """Write the coefficients of one guard in the fraction of the step; return the degree."""
    values = whole[VALUES]
    dense = whole[DENSE]
    reached = whole[REACHED]
    n = whole[N_STATES]
    row = whole[SLOPES] + guard * (n + 1)
    w[POLYNOMIAL] = w[values + guard]
    last = w[values + guard]
    degree = 0
    first = row
    while first <= row + n and w[first] == 0.0:
        first += 1
    waves = guard_waves(guard, w, whole)
    # many guards are 0 in a mode, or change with nothing in it
    terms = int(w[dense]) if first <= row + n or waves else 0
    for k in range(1, terms + 1):
        total = h * w[row + n] if k == 1 else 0.0
        if k > 1 and waves:
            power, place = wave_at(k, w, whole)
            total = power * w[place + n + guard]
        for i in range(n):
            total += w[row + i] * w[dense + 1 + k * n + i]
        w[POLYNOMIAL + k] = total
        last += total
        if total != 0.0:
            degree = k
    w[reached + guard] = max(w[reached + guard], abs(w[values + guard]), abs(last))
    note_least(guard, min(w[values + guard], last), w, whole)
    return degree


def quiet_start(t: float, h: float, w: Vector, whole: Wholes) -> None:
    """Drop the first slope of a body at rest where forces balance but for their rounding."""
    y = whole[Y]
    point = whole[POINT]
    slip = whole[SLIP]
    drift = whole[DRIFT]
    n = whole[N_STATES]
    matrix = whole[MATRIX]
    evaluate(FIELD, 1, whole[FLAGS], t, w, y, point)
    size = w[point + slip]
    evaluate(FIELD, -1, whole[FLAGS], t, w, y, point)
    size = abs(size - w[point + slip]) + abs(w[drift + slip] * t)
    for i in range(n):
        size += abs(w[matrix + slip * n + i] * w[y + i])
    if abs(w[POLYNOMIAL + 1]) <= BALANCED * h * size:
        w[POLYNOMIAL + 1] = 0.0
        still = w[drift + slip] == 0.0 and whole[N_WAVES] == 0
        if whole[N_COORDINATES] == 1 and still:  # nor is there anything to follow
            for k in range(2, SERIES + 1):
                w[POLYNOMIAL + k] = 0.0


def first_crossing(t: float, h: float, w: Vector, whole: Wholes) -> int:
    """Find the first violated guard of a step, with its fraction in FRACTION.

    The fraction is 0 where a guard that starts at zero falls below it at once.
    """
    y = whole[Y]
    n_guards = whole[N_GUARDS]
    slip = whole[SLIP]
    guards(t, w, whole, y, whole[VALUES])
    guard_slopes(t, w, whole, y, whole[SLOPES])
    best = NO_GUARD
    w[FRACTION] = 1.0
    for guard in range(n_guards):
        degree = guard_polynomial(guard, h, w, whole)
        switches = SWITCH <= guard < whole[FIRST_LIMIT]
        if switches and -UNMOVED * w[whole[REACHED] + guard] <= w[POLYNOMIAL] < 0.0:
            w[POLYNOMIAL] = 0.0  # it has just been turned, within rounding of its threshold
        if degree == 0 and w[POLYNOMIAL] >= 0.0:
            continue
        if guard == STOP and whole[MODE] != 0 and w[y + slip] == 0.0:
            quiet_start(t, h, w, whole)
        x = first_fall(w, degree)
        if x == FALLS_AT_ONCE:
            w[FRACTION] = 0.0
            return guard
        if x < w[FRACTION] or (x == 1.0 and best == NO_GUARD):
            w[FRACTION] = x
            best = guard
    return best
