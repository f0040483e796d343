"""The coordinates of the mechanism and those of its equations, which differ where slips are sums.

One matrix, constant in a run, gives those of the equations, and its inverse those of the mechanism;
rates follow alike, and so do sensitivities.
"""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.state_layout import IS_TURNED, N_COORDINATES, TURN, VALUES


def turn_columns(at: int, m: int, back: int, w: Vector, whole: Wholes) -> None:
    """Turn `m` columns of states in place, row by row; bristles stay as they are."""
    n, values = whole[N_COORDINATES], whole[VALUES]
    if not whole[IS_TURNED]:
        return
    matrix = whole[TURN] + back * n * n
    for block in range(2):
        for c in range(m):
            place = at + block * n * m + c
            for i in range(n):
                total = 0.0
                for j in range(n):
                    total += w[matrix + i * n + j] * w[place + j * m]
                w[values + i] = total
            for i in range(n):
                w[place + i * m] = w[values + i]


def turn_states(at: int, back: int, w: Vector, whole: Wholes) -> None:
    """Turn one state in place, as `turn_columns` does."""
    turn_columns(at, 1, back, w, whole)


def state_seen(at: int, state: int, w: Vector, whole: Wholes) -> float:
    """Return one of the states of the mechanism."""
    n = whole[N_COORDINATES]
    if not whole[IS_TURNED] or state >= 2 * n:
        return w[at + state]
    block, row = divmod(state, n)
    total = 0.0
    for j in range(n):
        total += w[whole[TURN] + n * n + row * n + j] * w[at + block * n + j]
    return total
