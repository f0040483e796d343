"""Many runs that go on together, each by a stretch in which its drives are constant."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.driver import run
from stickslip.kernels.enums import END_TIME, FULL, RUNNING
from stickslip.kernels.state_layout import (
    EVENTS,
    N_DRIVES,
    NUMBERS,
    POLYNOMIAL,
    SIZE,
    STATUS,
    STEPS,
)


def kept_size(whole: Wholes) -> int:
    """Return how many numbers of the vector of a run are kept between stretches.

    The room in which roots of guards are looked for is not among them.
    """
    return POLYNOMIAL + whole[SIZE] - NUMBERS


def take_up(row: int, kept: Vector, wholes: Wholes, w: Vector, whole: Wholes) -> None:
    """Put the numbers of a run into the vectors of a run."""
    at = row * kept_size(whole)
    for i in range(POLYNOMIAL):
        w[i] = kept[at + i]
    at += POLYNOMIAL - NUMBERS
    for i in range(NUMBERS, whole[SIZE]):
        w[i] = kept[at + i]
    at = row * len(whole)
    for i in range(len(whole)):
        whole[i] = wholes[at + i]


def put_away(row: int, kept: Vector, wholes: Wholes, w: Vector, whole: Wholes) -> None:
    """Keep the numbers of a run."""
    at = row * kept_size(whole)
    for i in range(POLYNOMIAL):
        kept[at + i] = w[i]
    at += POLYNOMIAL - NUMBERS
    for i in range(NUMBERS, whole[SIZE]):
        kept[at + i] = w[i]
    at = row * len(whole)
    for i in range(len(whole)):
        wholes[at + i] = whole[i]


def hold_drives(row: int, values: Vector, table: Vector, whole: Wholes) -> None:
    """Make a table of one piece, in which each drive has a constant value."""
    n_drives = whole[N_DRIVES]
    for k in range(n_drives):
        table[1 + 3 * k] = values[row * n_drives + k]


def stretches(
    first: int,
    count: int,
    values: Vector,
    untils: Vector,
    bounds: Vector,
    rtol: float,
    cap: float,
    limit: int,
    kept: Vector,
    wholes: Wholes,
    w: Vector,
    whole: Wholes,
    table: Vector,
    log: Vector,
    events: Vector,
) -> int:
    """Go on with all runs from one on; return the first that is not done, for want of room.

    Each goes on as `run` does with a new piece of the drives, up to a time of its own. Steps and
    events are counted anew in each stretch, and their rows are written over. A run that has ended
    before its time stays as it is.
    """
    for row in range(first, count):
        if wholes[row * len(whole) + STATUS] in (RUNNING, END_TIME, FULL):
            take_up(row, kept, wholes, w, whole)
            if whole[STATUS] != FULL:
                whole[STEPS] = 0
                whole[EVENTS] = 0
            hold_drives(row, values, table, whole)
            run(w, whole, table, bounds, untils[row], rtol, cap, limit, log, events)
            put_away(row, kept, wholes, w, whole)
            if whole[STATUS] == FULL:
                return row
    return count
