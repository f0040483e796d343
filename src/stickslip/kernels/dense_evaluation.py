"""A recorded run at any times: its rows hold all that is needed."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.coordinates import state_seen
from stickslip.kernels.dense_output import interpolate
from stickslip.kernels.drive_segments import load_piece
from stickslip.kernels.equations import put_constants
from stickslip.kernels.model_interface import recorded
from stickslip.kernels.questions import PREPARE, RESTORE, SERIES_FROM, ask, ask_here, ask_of
from stickslip.kernels.state_layout import (
    DENSE,
    FLAGS,
    LAW_FLAGS,
    MODE,
    MODES,
    N_COLUMNS,
    N_CONTACTS,
    N_DRIVES,
    N_PAIRS,
    N_STATES,
    OPEN,
    POINT,
    ROW_COLUMNS,
    ROW_DENSE,
    TERMS,
    TIME,
    VALUES,
    Y,
)
from stickslip.kernels.taylor_series import series_fill


def row_at(log: Vector, count: int, t: float, whole: Wholes) -> int:
    """Return the last row that begins at or before a time."""
    width = whole[ROW_COLUMNS]
    low = 0
    high = count
    while high - low > 1:
        middle = (low + high) // 2
        if log[middle * width] <= t:
            low = middle
        else:
            high = middle
    return low


def piece_at(table: Vector, first: int, t: float, whole: Wholes) -> int:
    """Return the piece of the drives that holds at a time, `first` or a later one."""
    width = 1 + 3 * whole[N_DRIVES]
    piece = first
    while (piece + 1) * width < len(table) and table[(piece + 1) * width] <= t:
        piece += 1
    return piece


def restore_modes(end: int, log: Vector, w: Vector, whole: Wholes) -> None:
    """Bring back the modes, flags and openings of a row that ends before a place."""
    n, contacts = whole[N_PAIRS], whole[N_CONTACTS]
    at = end - n - 2 * contacts
    for i in range(n):
        whole[whole[MODES] + i] = int(log[at + i])
    for c in range(contacts):
        whole[whole[LAW_FLAGS] + c] = int(log[at + n + c])
        whole[whole[OPEN] + c] = int(log[at + n + contacts + c])
    ask_here(RESTORE, w, whole)


def restore_start(log: Vector, row: int, table: Vector, w: Vector, whole: Wholes) -> None:
    """Bring back the start of a row in Y, its mode, and the piece of its drives."""
    n = whole[N_STATES]
    y = whole[Y]
    at = row * whole[ROW_COLUMNS]
    whole[MODE] = int(log[at + 3])
    whole[FLAGS] = int(log[at + 4])
    load_piece(table, int(log[at + 5]), w, whole)
    for i in range(n):
        w[y + i] = log[at + ROW_DENSE + 1 + i]
    if whole[N_CONTACTS] > 0:
        restore_modes(at + whole[ROW_COLUMNS], log, w, whole)


def restore(log: Vector, row: int, table: Vector, w: Vector, whole: Wholes) -> None:
    """Bring back the start of a row in Y, its dense output, mode and piece of the drives."""
    n = whole[N_STATES]
    y = whole[Y]
    dense = whole[DENSE]
    at = row * whole[ROW_COLUMNS]
    restore_start(log, row, table, w, whole)
    if log[at + ROW_DENSE] > 0.0 and whole[N_CONTACTS] > 0:
        w[TIME] = log[at]
        ask_of(SERIES_FROM, log[at + 2], w, whole, y, 0)
    elif log[at + ROW_DENSE] > 0.0:
        series_fill(log[at], log[at + 2], w, whole, y)
    else:
        for i in range(1 + (TERMS + 1) * n):
            w[dense + i] = log[at + ROW_DENSE + i]


def play(
    log: Vector,
    count: int,
    times: Vector,
    table: Vector,
    w: Vector,
    whole: Wholes,
    states: Vector,
    forces: Vector,
    rows: Vector,
) -> None:
    """Write states, friction, loads and what else is recorded, and the row, of each of the times.

    A body at rest for good is one row, during which its drives go on.
    """
    width = whole[ROW_COLUMNS]
    point = whole[POINT]
    values = whole[VALUES]
    n = whole[N_STATES]
    columns = whole[N_COLUMNS]
    row = -1
    piece = 0
    put_constants(w, whole)
    if whole[N_CONTACTS] > 0:
        ask(PREPARE, log[0], w, whole)
    for i in range(len(times)):
        t = times[i]
        here = row
        if row < 0 or t < log[row * width] or not t < log[row * width + 1]:
            here = row_at(log, count, t, whole)
        at = here * width
        if here != row or t < times[i - 1]:
            piece = int(log[at + 5])
        if here != row:
            row = here
            restore(log, row, table, w, whole)
        interpolate(w, whole, (t - log[at]) / log[at + 2], point)
        piece = piece_at(table, piece, t, whole)
        load_piece(table, piece, w, whole)
        recorded(t, w, whole, point, values)
        for j in range(n):
            states[i * n + j] = state_seen(point, j, w, whole)
        for j in range(columns):
            forces[columns * i + j] = w[values + j]
        rows[i] = row
