"""DOP853: explicit Runge-Kutta of order 8 with dense output of order 7, for smooth modes."""

import math

from stickslip.kernels.dop853_tableau import ERROR_3, ERROR_5, A, C, D
from stickslip.kernels.model import N_STATES, field
from stickslip.kernels.sizes import size_of
from stickslip.kernels.tier import Vector

__all__ = ["DOP853_STAGES", "dop853_dense", "dop853_step"]

DOP853_STAGES = 16


def dop853_stage(
    s: int,
    mode: int,
    flags: int,
    t: float,
    y: Vector,
    h: float,
    p: Vector,
    k: Vector,
    y1: Vector,
    slope: Vector,
) -> None:
    """Evaluate stage `s` from the ones before it."""
    n = N_STATES
    row = s * (s - 1) // 2
    for i in range(n):
        total = 0.0
        for j in range(s):
            total += A[row + j] * k[j * n + i]
        y1[i] = y[i] + h * total
    field(mode, flags, t + C[s] * h, y1, p, slope)
    for i in range(n):
        k[s * n + i] = slope[i]


def dop853_step(
    mode: int,
    flags: int,
    t: float,
    y: Vector,
    h: float,
    p: Vector,
    k: Vector,
    y1: Vector,
    slope: Vector,
    scale: Vector,
    rtol: float,
) -> float:
    """Try a step from the slope in k[0]; return its error over the tolerance.

    Stage 12 is the solution itself, left in `y1` with its slope.
    """
    n = N_STATES
    for s in range(1, 13):
        dop853_stage(s, mode, flags, t, y, h, p, k, y1, slope)
    sum_5 = 0.0
    sum_3 = 0.0
    for i in range(n):
        size = rtol * size_of(i, h, y, y1, scale)
        error_5 = 0.0
        error_3 = 0.0
        for s in range(13):
            error_5 += ERROR_5[s] * k[s * n + i]
            error_3 += ERROR_3[s] * k[s * n + i]
        if error_5 != 0.0 or error_3 != 0.0:
            share_5 = error_5 / size if size > 0.0 else math.inf
            share_3 = error_3 / size if size > 0.0 else math.inf
            sum_5 += share_5 * share_5  # a power would raise where this becomes infinite
            sum_3 += share_3 * share_3
    total = sum_5 + 0.01 * sum_3
    return 0.0 if total == 0.0 else abs(h) * sum_5 / math.sqrt(total * n)


def dop853_dense(
    mode: int,
    flags: int,
    t: float,
    y: Vector,
    h: float,
    p: Vector,
    k: Vector,
    y1: Vector,
    slope: Vector,
    dense: Vector,
) -> None:
    """Fill the dense output of the step just taken; `y1` and `slope` are kept."""
    n = N_STATES
    for i in range(n):
        change = y1[i] - y[i]
        dense[i] = change
        dense[n + i] = h * k[i] - change
        dense[2 * n + i] = 2.0 * change - h * (slope[i] + k[i])
    stage_y = dense[3 * n : 4 * n]
    stage_slope = dense[4 * n : 5 * n]
    for s in range(13, 16):
        dop853_stage(s, mode, flags, t, y, h, p, k, stage_y, stage_slope)
    for row in range(4):
        for i in range(n):
            total = 0.0
            for s in range(DOP853_STAGES):
                total += D[16 * row + s] * k[s * n + i]
            dense[(3 + row) * n + i] = h * total
