"""The pieces of the drives: which one holds, when the next begins, whether any still moves."""

import math

from stickslip.kernels.backend import Vector
from stickslip.kernels.model_interface import N_DRIVES, REST_IS_FINAL, rest
from stickslip.kernels.state_layout import FLAGS, GIVEN, MODE, PIECE, TIME, VALUES, Y

__all__ = ["enter_pieces", "load_piece", "next_stop", "rests_for_good"]


def load_piece(table: Vector, row: int, w: Vector) -> None:
    """Put one row of the drives' table where the equations read it.

    Writes: drives.

    Parameters
    ----------
    table : array (pieces (1 + 3 N_DRIVES),)
        For each piece of the drives its start, then value, slope and start of each drive.
    row : int
        Index of the piece.
    w : array (SIZE,)
        Vector of the run.
    """
    width = 1 + 3 * N_DRIVES
    for i in range(3 * N_DRIVES):
        w[i] = table[row * width + 1 + i]


def next_stop(table: Vector, t_end: float, whole: Vector) -> float:
    """Return the start of the next piece of the drives, or the end.

    Reads: PIECE.

    Parameters
    ----------
    table : array (pieces (1 + 3 N_DRIVES),)
        For each piece of the drives its start, then value, slope and start of each drive.
    t_end : float
        End of the run [s].
    whole : array (WHOLES,)
        Whole-numbered state of the run.

    Returns
    -------
    float
        Time up to which the drives are lines [s].
    """
    width = 1 + 3 * N_DRIVES
    following = (int(whole[PIECE]) + 1) * width
    return min(table[following], t_end) if following < len(table) else t_end


def enter_pieces(table: Vector, w: Vector, whole: Vector) -> None:
    """Load the piece of the drives that holds now.

    Reads: TIME, PIECE.
    Writes: drives, PIECE.

    Parameters
    ----------
    table : array (pieces (1 + 3 N_DRIVES),)
        For each piece of the drives its start, then value, slope and start of each drive.
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.
    """
    width = 1 + 3 * N_DRIVES
    while (int(whole[PIECE]) + 1) * width < len(table) and (
        table[(int(whole[PIECE]) + 1) * width] <= w[TIME]
    ):
        whole[PIECE] += 1
    load_piece(table, int(whole[PIECE]), w)


def rests_for_good(w: Vector, whole: Vector, bounds: Vector) -> bool:
    """Whether no drive can move the held body any more, nor pull it off its stop.

    `bounds` has least and largest value of each drive from the start of each piece on.

    Reads: TIME, Y, MODE, FLAGS, PIECE.
    Writes: GIVEN, VALUES.

    Parameters
    ----------
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.
    bounds : array (pieces N_DRIVES 2,)
        Least and largest value of each drive from the start of each piece on.

    Returns
    -------
    bool
        Whether the body stays to the end of the run.
    """
    if not REST_IS_FINAL or abs(whole[MODE]) == 1:
        return False
    side = 0.5 * whole[MODE]
    for corner in range(1 << N_DRIVES):
        for k in range(N_DRIVES):
            at = (int(whole[PIECE]) * N_DRIVES + k) * 2 + ((corner >> k) & 1)
            w[GIVEN + k] = bounds[at]
            if not abs(bounds[at]) < math.inf:
                return False
        rest(0, int(whole[FLAGS]), w[TIME], w, Y, VALUES)
        pull = abs(w[VALUES]) if side == 0.0 else -side * w[VALUES]
        if pull > w[VALUES + 1] or w[VALUES + 2] < 0.0:
            return False
    return True
