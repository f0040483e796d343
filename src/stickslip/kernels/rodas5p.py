"""Rodas5P: Rosenbrock method of order 5 with analytic Jacobian and df/dt, for stiff modes."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.dense_output import NESTED_SHORT
from stickslip.kernels.directions import bind
from stickslip.kernels.enums import HELD_FAST
from stickslip.kernels.error_scale import size_of
from stickslip.kernels.lu import lu_factor, lu_solve
from stickslip.kernels.model_interface import field, jacobian, time_slope
from stickslip.kernels.state_layout import (
    DENSE,
    DRIFT,
    MATRIX,
    MODE,
    MODES,
    N_CONTACTS,
    N_COORDINATES,
    N_DIRECTIONS,
    N_STATES,
    PIVOTS,
    POINT,
    SLIP,
    STAGES,
    Y1,
    Y,
)

# fmt: off
# Rows one after the other: row s, of s numbers, begins at s * (s - 1) // 2.
A_RODAS = (
    3.0,
    2.849394379747939, 0.45842242204463923,
    -6.954028509809101, 2.489845061869568, -10.358996098473584,
    2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641,
    -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
    0.030198172008377946,
    -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
    0.030198172008377946, 1.0,
    -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256,
    0.030198172008377946, 1.0, 1.0,
)
C_RODAS = (
    -14.155112264123755,
    -17.97296035885952, -2.859693295451294,
    147.12150275711716, -1.41221402718213, 71.68940251302358,
    165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306,
    24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125,
    -0.6610691825249471,
    30.91273214028599, -3.1208243349937974, 77.79954646070892, 34.28646028294783,
    -19.097331116725623, -28.087943162872662,
    37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047,
    -40.06618937091002, -54.66780262877968, -9.48861652309627,
)
TIMES_RODAS = (
    0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0,
    1.0,
)
SLOPES_RODAS = (
    0.21193756319429014, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734,
    2.325825639765069, 0.0, 0.0, 0.0,
)
# Three rows of 8, for the dense output.
DENSE_RODAS = (
    25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022685204,
    0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493,
    -9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796,
    20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372,
    11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643,
    -52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722,
)
GAMMA = 0.21193756319429014
RODAS_STAGES = 8


# fmt: on


def rodas_matrix(t: float, h: float, w: Vector, whole: Wholes) -> bool:
    """Factorise 1 / (gamma h) - J."""
    matrix = whole[MATRIX]
    n = whole[N_STATES]
    jacobian(t, w, whole, whole[Y], matrix)
    for i in range(n * n):
        w[matrix + i] = -w[matrix + i]
    for i in range(n):
        w[matrix + i * n + i] += 1.0 / (GAMMA * h)
    return lu_factor(w, matrix, n, whole[PIVOTS])


def rodas_step(t: float, h: float, w: Vector, whole: Wholes, rtol: float) -> float:
    """Try a step; return its error over the tolerance. The solution is left in Y1."""
    y = whole[Y]
    drift = whole[DRIFT]
    stages = whole[STAGES]
    y1 = whole[Y1]
    matrix = whole[MATRIX]
    pivots = whole[PIVOTS]
    point = whole[POINT]
    n = whole[N_STATES]
    if not rodas_matrix(t, h, w, whole):
        return math.inf
    time_slope(t, w, whole, y, drift)
    per_step = 1.0 / h
    # Stages are those of Hairer and Wanner, section IV.7: sums of C over h stand for products with
    # the Jacobian, so that each costs one evaluation and one solution with the same factors.
    for s in range(RODAS_STAGES):
        row = s * (s - 1) // 2
        stage = stages + s * n
        for i in range(n):
            total = w[y + i]
            product = 0.0
            for j in range(s):
                earlier = w[stages + j * n + i]
                total += A_RODAS[row + j] * earlier
                product += C_RODAS[row + j] * earlier
            w[y1 + i] = total
            w[point + i] = product
        field(t + TIMES_RODAS[s] * h, w, whole, y1, stage)
        slope = h * SLOPES_RODAS[s]
        for i in range(n):
            w[stage + i] += w[point + i] * per_step + slope * w[drift + i]
        lu_solve(w, matrix, n, pivots, stage)
        hold_still(stage, w, whole)
    for i in range(n):
        w[y1 + i] += w[stages + 7 * n + i]
    return rodas_error(h, w, whole, rtol)


def hold_still(to: int, w: Vector, whole: Wholes) -> None:
    """Keep what is held where it is, whatever pivots round to."""
    n = whole[N_COORDINATES]
    for i in range(n):
        if whole[N_CONTACTS] > 0:
            held = whole[whole[MODES] + i] == HELD_FAST
        else:
            held = whole[MODE] == 0 and whole[SLIP] == n + i
        if held:
            w[to + i] = 0.0
            w[to + n + i] = 0.0
    if whole[N_DIRECTIONS] > n:
        bind(to, 1, w, whole)
        bind(to + n, 1, w, whole)


def rodas_error(h: float, w: Vector, whole: Wholes, rtol: float) -> float:
    """Return the last stage, which is the error estimate, over the tolerance."""
    stages = whole[STAGES]
    n = whole[N_STATES]
    total = 0.0
    for i in range(n):
        error = w[stages + 7 * n + i]
        size = rtol * size_of(i, h, w, whole)
        if error != 0.0:
            share = error / size if size > 0.0 else math.inf
            total += share * share
    return math.sqrt(total / n)


def rodas_dense(w: Vector, whole: Wholes) -> None:
    """Fill the dense output of the step just taken."""
    dense = whole[DENSE]
    stages = whole[STAGES]
    y = whole[Y]
    y1 = whole[Y1]
    n = whole[N_STATES]
    w[dense] = NESTED_SHORT
    for i in range(n):
        at = dense + 1 + i
        first = 0.0
        second = 0.0
        third = 0.0
        for s in range(RODAS_STAGES):
            stage = w[stages + s * n + i]
            first += DENSE_RODAS[s] * stage
            second += DENSE_RODAS[8 + s] * stage
            third += DENSE_RODAS[16 + s] * stage
        # Steinebach's (1 - x) y0 + x (y1 + (1 - x) (k1 + x (k2 + x k3))) in the nested form, where
        # k2 + x k3 is (k2 + k3) + (1 - x) (-k3).
        w[at] = w[y + i]
        w[at + n] = w[y1 + i] - w[y + i]
        w[at + 2 * n] = first
        w[at + 3 * n] = second + third
        w[at + 4 * n] = -third
        for row in range(5, 8):
            w[at + row * n] = 0.0
