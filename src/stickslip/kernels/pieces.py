"""The pieces of the drives: which one holds, when the next begins, whether any still moves."""

import math

from stickslip.kernels.model import (
    N_DRIVES,
    REST_IS_FINAL,
    rest,
)
from stickslip.kernels.state import (
    FLAGS,
    MODE,
    PIECE,
    TIME,
)
from stickslip.kernels.tier import Vector, vector

__all__ = ["enter_pieces", "load_piece", "next_stop", "rests_for_good"]


def load_piece(table: Vector, row: int, p: Vector) -> None:
    """Put one row of the drives' table into the parameters."""
    width = 1 + 3 * N_DRIVES
    first = len(p) - 3 * N_DRIVES
    for i in range(3 * N_DRIVES):
        p[first + i] = table[row * width + 1 + i]


def next_stop(table: Vector, t_end: float, whole: Vector) -> float:
    """Return the start of the next piece of the drives, or the end."""
    width = 1 + 3 * N_DRIVES
    following = (int(whole[PIECE]) + 1) * width
    return min(table[following], t_end) if following < len(table) else t_end


def enter_pieces(table: Vector, p: Vector, real: Vector, whole: Vector) -> None:
    """Load the piece of the drives that holds now."""
    width = 1 + 3 * N_DRIVES
    while (int(whole[PIECE]) + 1) * width < len(table) and (
        table[(int(whole[PIECE]) + 1) * width] <= real[TIME]
    ):
        whole[PIECE] += 1
    load_piece(table, int(whole[PIECE]), p)


def rests_for_good(
    t: float, y: Vector, p: Vector, whole: Vector, bounds: Vector, values: Vector
) -> bool:
    """Whether no drive can move the held body any more."""
    if not REST_IS_FINAL or whole[MODE] != 0:
        return False
    d = vector(N_DRIVES + 1)
    for corner in range(1 << N_DRIVES):
        for k in range(N_DRIVES):
            d[k] = bounds[(int(whole[PIECE]) * N_DRIVES + k) * 2 + ((corner >> k) & 1)]
            if not abs(d[k]) < math.inf:
                return False
        rest(int(whole[FLAGS]), t, y, p, d, values)
        if abs(values[0]) > values[1]:
            return False
    return True
