"""The pieces of the drives: which one holds, when the next begins, whether any still moves."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.equations import REST, evaluate
from stickslip.kernels.questions import STAYS, ask_here
from stickslip.kernels.state_layout import (
    BOX,
    FLAGS,
    GIVEN,
    MODE,
    N_CONTACTS,
    N_DRIVES,
    NUMBERS,
    PIECE,
    REST_IS_FINAL,
    TIME,
    VALUES,
    Y,
)

__all__ = ["enter_pieces", "load_piece", "next_stop", "rests_for_good"]


def load_piece(table: Vector, row: int, w: Vector, whole: Wholes) -> None:
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
    whole : array (WHOLES,)
        Whole numbers of the run.
    """
    n_drives = whole[N_DRIVES]
    width = 1 + 3 * n_drives
    for i in range(3 * n_drives):
        w[NUMBERS + i] = table[row * width + 1 + i]


def next_stop(table: Vector, t_end: float, whole: Wholes) -> float:
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
    width = 1 + 3 * whole[N_DRIVES]
    following = (whole[PIECE] + 1) * width
    return min(table[following], t_end) if following < len(table) else t_end


def enter_pieces(table: Vector, w: Vector, whole: Wholes) -> None:
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
    width = 1 + 3 * whole[N_DRIVES]
    while (whole[PIECE] + 1) * width < len(table) and (
        table[(whole[PIECE] + 1) * width] <= w[TIME]
    ):
        whole[PIECE] += 1
    load_piece(table, whole[PIECE], w, whole)


def rests_for_good(w: Vector, whole: Wholes, bounds: Vector) -> bool:
    """Whether no drive can move the held body any more, nor pull it off its stop.

    `bounds` has least and largest value of each drive from the start of each piece on.

    Reads: TIME, Y, MODE, FLAGS, PIECE.
    Writes: GIVEN, VALUES, BOX, ANSWER, CHANGED.

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
    n_drives = whole[N_DRIVES]
    given = whole[GIVEN]
    y = whole[Y]
    values = whole[VALUES]
    if whole[N_CONTACTS] > 0:
        for k in range(2 * whole[N_DRIVES]):
            w[whole[BOX] + k] = bounds[whole[PIECE] * whole[N_DRIVES] * 2 + k]
        return ask_here(STAYS, w, whole) == 1
    if not whole[REST_IS_FINAL] or abs(whole[MODE]) == 1:
        return False
    side = 0.5 * whole[MODE]
    for corner in range(1 << n_drives):
        for k in range(n_drives):
            at = (whole[PIECE] * n_drives + k) * 2 + ((corner >> k) & 1)
            w[given + k] = bounds[at]
            if not abs(bounds[at]) < math.inf:
                return False
        evaluate(REST, 0, whole[FLAGS], w[TIME], w, y, values)
        pull = abs(w[values]) if side == 0.0 else -side * w[values]
        if pull > w[values + 1] or w[values + 2] < 0.0:
            return False
    return True
