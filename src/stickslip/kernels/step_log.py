"""The log of a run: one row for each step, written as it goes on, and read at any times.

A row has all that the dense output of its step needs, the modes and flags, and the work done; so a
recorded run is evaluated at any time by restoring its row, without a step.
"""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.equations import (
    BOOK,
    MOTION,
    PREPARE,
    RESTORE,
    SERIES_FROM,
    ask,
    ask_here,
    ask_of,
    load_piece,
    power,
    put_constants,
    recorded,
    state_seen,
)
from stickslip.kernels.guard_roots import CLOCK, NO_GUARD, guard_at, guard_size, guard_values
from stickslip.kernels.numerics import FEW_NODES, FEW_WEIGHTS, NODES, WEIGHTS, interpolate
from stickslip.kernels.state_layout import (
    DENSE,
    FLAGS,
    FRACTION,
    GROSS,
    LAW_FLAGS,
    LENGTH,
    MODE,
    MODES,
    N_COLUMNS,
    N_CONTACTS,
    N_DRIVES,
    N_GUARDS,
    N_PAIRS,
    N_STATES,
    OPEN,
    PIECE,
    POINT,
    RESIDUAL,
    ROUNDING,
    ROW_COLUMNS,
    ROW_DENSE,
    SCALE,
    SLIP,
    STEPS,
    STOP,
    SUPPLIED,
    TAKEN,
    TERMS,
    TIME,
    VALUES,
    VIOLATION,
    Y1,
    Y,
)
from stickslip.kernels.steppers import series_fill

# The books of a run: rows of steps, work done, violations found.

NOTABLE = 1e-10
"""Share of its largest size by which a guard is violated more than the dense output's rounding."""
FEW_TERMS = 6
"""A series that ends so early is that of a very short step, over which few nodes do."""


def add_work(w: Vector, whole: Wholes) -> None:
    """Add the work done in the part of the step that holds."""
    point = whole[POINT]
    values = whole[VALUES]
    share = w[FRACTION]
    h = w[LENGTH]
    if whole[N_CONTACTS] > 0:
        ask_here(BOOK, w, whole)
        return
    terms = w[whole[DENSE]]
    few = 0.0 < terms <= FEW_TERMS or terms < 0.0
    supplied, taken, gross = 0.0, 0.0, 0.0
    for node in range(len(FEW_NODES) if few else len(NODES)):
        x = share * (FEW_NODES[node] if few else NODES[node])
        interpolate(w, whole, x, point)
        power(w[TIME] + x * h, w, whole, point, values)
        weight = share * h * (FEW_WEIGHTS[node] if few else WEIGHTS[node])
        supplied += weight * w[values]
        taken += weight * w[values + 1]
        gross += weight * (abs(w[values]) + abs(w[values + 1]))
    w[SUPPLIED] += supplied
    w[TAKEN] += taken
    w[GROSS] += gross


def record(log: Vector, end: float, w: Vector, whole: Wholes) -> None:
    """Write one row of the log."""
    dense = whole[DENSE]
    n = whole[N_STATES]
    at = whole[STEPS] * whole[ROW_COLUMNS]
    log[at] = w[TIME]
    log[at + 1] = end
    log[at + 2] = w[LENGTH]
    log[at + 3] = whole[MODE]
    log[at + 4] = whole[FLAGS]
    log[at + 5] = whole[PIECE]
    terms = 0 if w[dense] > 0.0 else TERMS
    for i in range(1 + (terms + 1) * n):
        log[at + ROW_DENSE + i] = w[dense + i]
    if whole[N_CONTACTS] > 0:
        note_modes(at + whole[ROW_COLUMNS], log, whole)
    whole[STEPS] += 1


def note_modes(end: int, log: Vector, whole: Wholes) -> None:
    """Write modes, flags and openings to the end of a row that ends before a place."""
    n, contacts = whole[N_PAIRS], whole[N_CONTACTS]
    at = end - n - 2 * contacts
    for i in range(n):
        log[at + i] = whole[whole[MODES] + i]
    for c in range(contacts):
        log[at + n + c] = whole[whole[LAW_FLAGS] + c]
        log[at + n + contacts + c] = whole[whole[OPEN] + c]


def audit(guard: int, start: float, w: Vector, whole: Wholes) -> None:
    """Note how far guards are violated at the end of a step, relative to their largest size yet.

    A steep guard may fall far between two ticks of the clock: what counts is where it was a tick
    before.
    """
    values, h = whole[VALUES], w[LENGTH]
    guard_values(w[TIME], w, whole, whole[Y], values)
    for i in range(whole[N_GUARDS]):
        value = w[values + i]
        if value < 0.0:
            size = guard_size(i, w, whole)
            if i == STOP and whole[N_CONTACTS] == 0:
                size = max(size, w[whole[SCALE] + whole[SLIP]])
            if value < -NOTABLE * size:
                before = max(0.0, w[FRACTION] - CLOCK * max(1.0, w[TIME] / h))
                value = min(0.0, max(value, guard_at(i, before, start, h, w, whole)))
                guard_values(w[TIME], w, whole, whole[Y], values)
            at = RESIDUAL if i == guard else VIOLATION
            if size > 0.0:
                w[at] = max(w[at], -value / size)


def close_step(guard: int, stop: float, w: Vector, whole: Wholes) -> None:
    """Move time and state to the end of the step."""
    n = whole[N_STATES]
    y = whole[Y]
    y1 = whole[Y1]
    scale = whole[SCALE]
    share = w[FRACTION]
    h = w[LENGTH]
    start = w[TIME]
    end = start + share * h
    if guard == NO_GUARD:
        for i in range(n):
            w[y + i] = w[y1 + i]
        if abs(stop - end) <= ROUNDING * max(abs(stop), abs(h)):
            end = stop
    else:
        interpolate(w, whole, share, y)
    for i in range(n):
        w[scale + i] = max(w[scale + i], abs(w[y + i]))
    if whole[N_CONTACTS] > 0:
        ask_here(MOTION, w, whole)
    w[TIME] = end
    if share > 0.0:
        audit(guard, start, w, whole)


# A recorded run at any times: its rows hold all that is needed.


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
