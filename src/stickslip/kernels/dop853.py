"""DOP853: explicit Runge-Kutta of order 8 with dense output of order 7, for smooth modes."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.dop853_tableau import ERROR_3, ERROR_5, A, C, D
from stickslip.kernels.error_scale import size_of
from stickslip.kernels.model_interface import field
from stickslip.kernels.state_layout import DENSE, DOP853_STAGES, N_STATES, POINT, STAGES, Y1, Y


def dop853_stage(s: int, t: float, h: float, w: Vector, whole: Wholes, at: int) -> None:
    """Evaluate stage `s` from the ones before it, at a state that is written to `at`."""
    stages = whole[STAGES]
    y = whole[Y]
    n = whole[N_STATES]
    row = s * (s - 1) // 2
    for i in range(n):
        total = 0.0
        for j in range(s):
            total += A[row + j] * w[stages + j * n + i]
        w[at + i] = w[y + i] + h * total
    field(t + C[s] * h, w, whole, at, stages + s * n)


def dop853_step(t: float, h: float, w: Vector, whole: Wholes, rtol: float) -> float:
    """Try a step; return its error over the tolerance.

    Stage 12 is the slope at the solution, which is left in Y1.
    """
    stages = whole[STAGES]
    y1 = whole[Y1]
    n = whole[N_STATES]
    field(t, w, whole, whole[Y], stages)
    for s in range(1, 13):
        dop853_stage(s, t, h, w, whole, y1)
    sum_5 = 0.0
    sum_3 = 0.0
    for i in range(n):
        size = rtol * size_of(i, h, w, whole)
        error_5 = 0.0
        error_3 = 0.0
        for s in range(13):
            error_5 += ERROR_5[s] * w[stages + s * n + i]
            error_3 += ERROR_3[s] * w[stages + s * n + i]
        if error_5 != 0.0 or error_3 != 0.0:
            share_5 = error_5 / size if size > 0.0 else math.inf
            share_3 = error_3 / size if size > 0.0 else math.inf
            sum_5 += share_5 * share_5  # a power would raise where this becomes infinite
            sum_3 += share_3 * share_3
    # Hairer, Norsett and Wanner, section II.10: the square of the estimate of order 5 over that of
    # order 3 falls as h^8, as the error does; where steps are too long for that, the root leaves
    # the estimate of order 5 alone.
    total = sum_5 + 0.01 * sum_3
    return 0.0 if total == 0.0 else abs(h) * sum_5 / math.sqrt(total * n)


def dop853_dense(t: float, h: float, w: Vector, whole: Wholes) -> None:
    """Fill the dense output of the step just taken."""
    dense = whole[DENSE]
    stages = whole[STAGES]
    y1 = whole[Y1]
    y = whole[Y]
    point = whole[POINT]
    n = whole[N_STATES]
    w[dense] = 0.0
    for i in range(n):
        # The first four rows are the cubic of Hermite through both ends and their slopes; four more
        # from three further stages make it order 7.
        at = dense + 1 + i
        first, last = w[stages + i], w[stages + 12 * n + i]
        change = w[y1 + i] - w[y + i]
        w[at] = w[y + i]
        w[at + n] = change
        w[at + 2 * n] = h * first - change
        w[at + 3 * n] = 2.0 * change - h * (last + first)
    for s in range(13, 16):
        dop853_stage(s, t, h, w, whole, point)
    for row in range(4):
        for i in range(n):
            total = 0.0
            for s in range(DOP853_STAGES):
                total += D[16 * row + s] * w[stages + s * n + i]
            w[dense + 1 + (4 + row) * n + i] = h * total
