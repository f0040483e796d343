"""Rodas5P: Rosenbrock method of order 5 with analytic Jacobian and df/dt, for stiff modes."""

import math

from stickslip.kernels.lu import lu_factor, lu_solve
from stickslip.kernels.model import N_STATES, field, jacobian, time_slope
from stickslip.kernels.rodas5p_tableau import (
    A_RODAS,
    C_RODAS,
    DENSE_RODAS,
    GAMMA,
    SLOPES_RODAS,
    TIMES_RODAS,
)
from stickslip.kernels.sizes import size_of
from stickslip.kernels.tier import Vector

__all__ = ["RODAS_STAGES", "rodas_dense", "rodas_step"]

RODAS_STAGES = 8


def rodas_matrix(
    mode: int, flags: int, t: float, y: Vector, h: float, p: Vector, matrix: Vector, pivots: Vector
) -> bool:
    """Factorise 1 / (gamma h) - J."""
    n = N_STATES
    jacobian(mode, flags, t, y, p, matrix)
    for i in range(n * n):
        matrix[i] = -matrix[i]
    for i in range(n):
        matrix[i * n + i] += 1.0 / (GAMMA * h)
    return lu_factor(matrix, n, pivots)


def rodas_step(
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
    matrix: Vector,
    pivots: Vector,
    drift: Vector,
) -> float:
    """Try a step; return its error over the tolerance. The solution is left in `y1`."""
    n = N_STATES
    if not rodas_matrix(mode, flags, t, y, h, p, matrix, pivots):
        return math.inf
    time_slope(mode, flags, t, y, p, drift)
    for s in range(RODAS_STAGES):
        row = s * (s - 1) // 2
        for i in range(n):
            y1[i] = y[i]
            for j in range(s):
                y1[i] += A_RODAS[row + j] * k[j * n + i]
        field(mode, flags, t + TIMES_RODAS[s] * h, y1, p, slope)
        for i in range(n):
            total = 0.0
            for j in range(s):
                total += C_RODAS[row + j] * k[j * n + i]
            slope[i] += total / h + h * SLOPES_RODAS[s] * drift[i]
        lu_solve(matrix, n, pivots, slope)
        for i in range(n):
            k[s * n + i] = slope[i]
    for i in range(n):
        y1[i] += k[7 * n + i]
    return rodas_error(h, y, y1, k, scale, rtol)


def rodas_error(h: float, y: Vector, y1: Vector, k: Vector, scale: Vector, rtol: float) -> float:
    """Return the last stage, which is the error estimate, over the tolerance."""
    n = N_STATES
    total = 0.0
    for i in range(n):
        error = k[7 * n + i]
        size = rtol * size_of(i, h, y, y1, scale)
        if error != 0.0:
            share = error / size if size > 0.0 else math.inf
            total += share * share
    return math.sqrt(total / n)


def rodas_dense(y: Vector, y1: Vector, k: Vector, dense: Vector) -> None:
    """Fill the dense output of the step just taken."""
    n = N_STATES
    for i in range(n):
        first = 0.0
        second = 0.0
        third = 0.0
        for s in range(RODAS_STAGES):
            first += DENSE_RODAS[s] * k[s * n + i]
            second += DENSE_RODAS[8 + s] * k[s * n + i]
            third += DENSE_RODAS[16 + s] * k[s * n + i]
        dense[i] = y1[i] - y[i]
        dense[n + i] = first
        dense[2 * n + i] = second + third
        dense[3 * n + i] = -third
        for row in range(4, 7):
            dense[row * n + i] = 0.0
