"""Rodas5P: Rosenbrock method of order 5 with analytic Jacobian and df/dt, for stiff modes."""

import math

from stickslip.kernels.backend import Vector
from stickslip.kernels.error_scale import size_of
from stickslip.kernels.lu import lu_factor, lu_solve
from stickslip.kernels.model_interface import (
    N_COORDINATES,
    N_STATES,
    SLIP,
    field,
    jacobian,
    time_slope,
)
from stickslip.kernels.rodas5p_tableau import (
    A_RODAS,
    C_RODAS,
    DENSE_RODAS,
    GAMMA,
    SLOPES_RODAS,
    TIMES_RODAS,
)
from stickslip.kernels.state_layout import DENSE, DRIFT, MATRIX, PIVOTS, STAGES, Y1, Y

__all__ = ["RODAS_STAGES", "rodas_dense", "rodas_step"]

RODAS_STAGES = 8


def rodas_matrix(mode: int, flags: int, t: float, h: float, w: Vector) -> bool:
    """Factorise 1 / (gamma h) - J.

    Reads: Y.
    Writes: MATRIX, PIVOTS.
    """
    n = N_STATES
    jacobian(mode, flags, t, w, Y, MATRIX)
    for i in range(n * n):
        w[MATRIX + i] = -w[MATRIX + i]
    for i in range(n):
        w[MATRIX + i * n + i] += 1.0 / (GAMMA * h)
    return lu_factor(w, MATRIX, n, PIVOTS)


def rodas_step(mode: int, flags: int, t: float, h: float, w: Vector, rtol: float) -> float:
    """Try a step; return its error over the tolerance. The solution is left in Y1.

    Reads: Y, SCALE.
    Writes: Y1, STAGES, MATRIX, PIVOTS, DRIFT.

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
    rtol : float
        Relative tolerance.

    Returns
    -------
    float
        Error over the tolerance: the step is good up to 1, infinite if the matrix has no inverse.
    """
    n = N_STATES
    if not rodas_matrix(mode, flags, t, h, w):
        return math.inf
    time_slope(mode, flags, t, w, Y, DRIFT)
    # Stages are those of Hairer and Wanner, section IV.7: sums of C over h stand for products with
    # the Jacobian, so that each costs one evaluation and one solution with the same factors.
    for s in range(RODAS_STAGES):
        row = s * (s - 1) // 2
        stage = STAGES + s * n
        for i in range(n):
            total = w[Y + i]
            for j in range(s):
                total += A_RODAS[row + j] * w[STAGES + j * n + i]
            w[Y1 + i] = total
        field(mode, flags, t + TIMES_RODAS[s] * h, w, Y1, stage)
        for i in range(n):
            total = 0.0
            for j in range(s):
                total += C_RODAS[row + j] * w[STAGES + j * n + i]
            w[stage + i] += total / h + h * SLOPES_RODAS[s] * w[DRIFT + i]
        lu_solve(w, MATRIX, n, PIVOTS, stage)
        if mode == 0:  # a held body stays where it is, whatever pivots round to
            w[stage + SLIP - N_COORDINATES] = 0.0
            w[stage + SLIP] = 0.0
    for i in range(n):
        w[Y1 + i] += w[STAGES + 7 * n + i]
    return rodas_error(h, w, rtol)


def rodas_error(h: float, w: Vector, rtol: float) -> float:
    """Return the last stage, which is the error estimate, over the tolerance.

    Reads: Y, Y1, SCALE, STAGES.
    """
    n = N_STATES
    total = 0.0
    for i in range(n):
        error = w[STAGES + 7 * n + i]
        size = rtol * size_of(i, h, w)
        if error != 0.0:
            share = error / size if size > 0.0 else math.inf
            total += share * share
    return math.sqrt(total / n)


def rodas_dense(w: Vector) -> None:
    """Fill the dense output of the step just taken.

    Reads: Y, Y1, STAGES.
    Writes: DENSE.
    """
    n = N_STATES
    w[DENSE] = 0.0
    for i in range(n):
        at = DENSE + 1 + i
        first = 0.0
        second = 0.0
        third = 0.0
        for s in range(RODAS_STAGES):
            stage = w[STAGES + s * n + i]
            first += DENSE_RODAS[s] * stage
            second += DENSE_RODAS[8 + s] * stage
            third += DENSE_RODAS[16 + s] * stage
        # Steinebach's (1 - x) y0 + x (y1 + (1 - x) (k1 + x (k2 + x k3))) in the nested form, where
        # k2 + x k3 is (k2 + k3) + (1 - x) (-k3).
        w[at] = w[Y + i]
        w[at + n] = w[Y1 + i] - w[Y + i]
        w[at + 2 * n] = first
        w[at + 3 * n] = second + third
        w[at + 4 * n] = -third
        for row in range(5, 8):
            w[at + row * n] = 0.0
