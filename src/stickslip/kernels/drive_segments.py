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


def load_piece(table: Vector, row: int, w: Vector, whole: Wholes) -> None:
    """Put one row of the drives' table where the equations read it."""
    n_drives = whole[N_DRIVES]
    width = 1 + 3 * n_drives
    for i in range(3 * n_drives):
        w[NUMBERS + i] = table[row * width + 1 + i]


def next_stop(table: Vector, t_end: float, whole: Wholes) -> float:
    """Return the start of the next piece of the drives, or the end."""
    width = 1 + 3 * whole[N_DRIVES]
    following = (whole[PIECE] + 1) * width
    return min(table[following], t_end) if following < len(table) else t_end


def enter_pieces(table: Vector, w: Vector, whole: Wholes) -> None:
    """Load the piece of the drives that holds now."""
    width = 1 + 3 * whole[N_DRIVES]
    while (whole[PIECE] + 1) * width < len(table) and (
        table[(whole[PIECE] + 1) * width] <= w[TIME]
    ):
        whole[PIECE] += 1
    load_piece(table, whole[PIECE], w, whole)


def rests_for_good(w: Vector, whole: Wholes, bounds: Vector) -> bool:
    """Whether no drive can move the held body any more, nor pull it off its stop.

    `bounds` has least and largest value of each drive from the start of each piece on.
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
