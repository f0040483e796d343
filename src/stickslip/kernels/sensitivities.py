"""Sensitivities: how the states of a recorded run change with parameters and initial states.

The rows of the run are gone through once more. In each the variational equations, linear along the
known solution, are solved: in exact modes by the derivative of the series, elsewhere by collocation
(Radau IIA, order nine, which stiffness does not hurt and which needs no second derivatives). At an
event, sensitivities jump with the moment of it (saltation). Beyond an impact at a hard stop there
are none: they are NaN.

The vector of the run is longer here: behind SIZE stand the slopes of the field and of the guards
with respect to all `q` quantities, the directions of the drives' numbers, and `m` columns of
sensitivities, rows by states, in several places. In the lists of slots, SIZE are the slopes of the
field, ``columns 0`` to ``columns 5`` the places of `columns_at`, `directions` and `guard slopes`
those of the functions of these names.
"""

import math

from stickslip.kernels.backend import Vector
from stickslip.kernels.dense_evaluation import restore
from stickslip.kernels.dense_output import interpolate
from stickslip.kernels.drive_segments import load_piece
from stickslip.kernels.enums import STOP
from stickslip.kernels.hard_stops import FIRST_WALL
from stickslip.kernels.lu import lu_factor, lu_solve
from stickslip.kernels.model_interface import (
    CAN_STICK,
    N_DRIVES,
    N_GUARDS,
    N_STATES,
    SLIP,
    field,
    field_slopes,
    guard_parameters,
    guard_slopes,
    jacobian,
)
from stickslip.kernels.radau_tableau import RADAU, RADAU_NODES, RADAU_STAGES
from stickslip.kernels.state_layout import (
    DENSE,
    DRIFT,
    EVENT_COLUMNS,
    MATRIX,
    POINT,
    ROW_COLUMNS,
    ROW_DENSE,
    SERIES,
    SIZE,
    SLOPES,
    VALUES,
    Y1,
    Y,
)
from stickslip.kernels.taylor_series import series_fill

__all__ = ["sense", "sense_size"]

MORE_TERMS = 5
"""Terms that the derivative of a series needs beyond the series."""


def guards_at(q: int) -> int:
    """Place of the guards' slopes."""
    return SIZE + N_STATES * q


def directions_at(q: int) -> int:
    """Place of the directions of the drives' numbers."""
    return guards_at(q) + N_GUARDS * q


def columns_at(which: int, q: int, m: int) -> int:
    """Place of sensitivities: 0 present, 1 result, 2 and 3 for terms; 4 moments; 5 what follows."""
    return directions_at(q) + 3 * N_DRIVES * m + which * N_STATES * m


def sense_size(q: int, m: int) -> int:
    """Return how long the vector of a run must be.

    Parameters
    ----------
    q : int
        Number of quantities: numbers of the drives, then parameters.
    m : int
        Number of directions.

    Returns
    -------
    int
        Length of the vector.
    """
    stages = RADAU_STAGES * N_STATES
    return columns_at(5, q, m) + stages * (stages + 1 + m)


def forcing(
    mode: int, flags: int, t: float, at: int, w: Vector, own: Vector, q: int, m: int, to: int
) -> None:
    """Write the slopes of the field along each direction.

    `own` has the quantity of each direction, -1 for an initial state.

    Reads: `at`, directions.
    Writes: `to`, SIZE.
    """
    field_slopes(mode, flags, t, w, at, SIZE)
    directions = directions_at(q)
    for c in range(m):
        for i in range(N_STATES):
            row = SIZE + i * q
            total = w[row + int(own[c])] if own[c] >= 0.0 else 0.0
            for k in range(3 * N_DRIVES):
                if w[directions + k * m + c] != 0.0:
                    total += w[row + k] * w[directions + k * m + c]
            w[to + i * m + c] = total


def add_product(w: Vector, matrix: int, columns: int, m: int, to: int) -> None:
    """Add the product of an n x n matrix with columns.

    Reads: `matrix`, `columns`, `to`.
    Writes: `to`.
    """
    n = N_STATES
    for i in range(n):
        for j in range(n):
            factor = w[matrix + i * n + j]
            if factor != 0.0:
                for c in range(m):
                    w[to + i * m + c] += factor * w[columns + j * m + c]


def series_sensed(
    mode: int, flags: int, t: float, h: float, w: Vector, own: Vector, q: int, m: int
) -> None:
    """Advance the sensitivities of an exact mode from the state in Y; result in columns 1.

    Reads: Y, columns 0, directions.
    Writes: POINT, MATRIX, DRIFT, DENSE, SIZE, columns 1, columns 2, columns 3, columns 4.
    """
    n = N_STATES
    now, result = columns_at(0, q, m), columns_at(1, q, m)
    term, new = columns_at(2, q, m), columns_at(3, q, m)
    series_fill(mode, flags, t, h, w, Y)
    terms = int(w[DENSE])
    forcing(mode, flags, t, Y, w, own, q, m, term)
    add_product(w, MATRIX, now, m, term)
    for i in range(n * m):
        w[term + i] *= h
        w[result + i] = w[now + i] + w[term + i]
    for i in range(n):
        w[DRIFT + i] = 0.0
    for k in range(1, SERIES + MORE_TERMS):
        for i in range(n * m):
            w[new + i] = 0.0
        if k <= terms:
            # affine in time and state together: the difference to the value at zero is linear
            rest = columns_at(4, q, m)
            forcing(mode, flags, 0.0, DRIFT, w, own, q, m, rest)
            forcing(mode, flags, h if k == 1 else 0.0, DENSE + 1 + k * n, w, own, q, m, new)
            for i in range(n * m):
                w[new + i] -= w[rest + i]
        add_product(w, MATRIX, term, m, new)
        for i in range(n * m):
            w[term + i] = h / (k + 1) * w[new + i]
            w[result + i] += w[term + i]


def radau_stage(
    s: int,
    mode: int,
    flags: int,
    t: float,
    h: float,
    length: float,
    w: Vector,
    own: Vector,
    q: int,
    m: int,
) -> None:
    """Write the rows of one stage: of the matrix, and of all right-hand sides.

    Reads: DENSE, columns 0, directions.
    Writes: POINT, MATRIX, SIZE, columns 2, columns 5.
    """
    n = N_STATES
    stages = RADAU_STAGES * n
    now, slopes, matrix = columns_at(0, q, m), columns_at(2, q, m), columns_at(5, q, m)
    right = matrix + stages * (stages + 1)
    share = RADAU_NODES[s] * length / h
    interpolate(w, share, POINT)
    jacobian(mode, flags, t + share * h, w, POINT, MATRIX)
    forcing(mode, flags, t + share * h, POINT, w, own, q, m, slopes)
    add_product(w, MATRIX, now, m, slopes)
    for i in range(n):
        row = matrix + (s * n + i) * stages
        for other in range(RADAU_STAGES):
            factor = length * RADAU[s * RADAU_STAGES + other]
            for j in range(n):
                w[row + other * n + j] = -factor * w[MATRIX + i * n + j]
        w[row + s * n + i] += 1.0
        for c in range(m):
            w[right + c * stages + s * n + i] = w[slopes + i * m + c]


def radau_sensed(
    mode: int,
    flags: int,
    t: float,
    h: float,
    length: float,
    w: Vector,
    own: Vector,
    q: int,
    m: int,
) -> None:
    """Advance the sensitivities along a row of length `h` by `length`; result in columns 1.

    Reads: DENSE, columns 0, directions.
    Writes: POINT, MATRIX, SIZE, columns 1, columns 2, columns 5.
    """
    n = N_STATES
    stages = RADAU_STAGES * n
    now, result, matrix = columns_at(0, q, m), columns_at(1, q, m), columns_at(5, q, m)
    pivots = matrix + stages * stages
    for s in range(RADAU_STAGES):
        radau_stage(s, mode, flags, t, h, length, w, own, q, m)
    lu_factor(w, matrix, stages, pivots)
    for c in range(m):
        right = pivots + stages + c * stages
        lu_solve(w, matrix, stages, pivots, right)
        for i in range(n):
            total = 0.0
            for s in range(RADAU_STAGES):
                total += RADAU[(RADAU_STAGES - 1) * RADAU_STAGES + s] * w[right + s * n + i]
            w[result + i * m + c] = w[now + i * m + c] + length * total


def advance_sensed(
    log: Vector, row: int, length: float, w: Vector, own: Vector, q: int, m: int
) -> None:
    """Advance the sensitivities from the start of a restored row; result in columns 1.

    Reads: Y, DENSE, columns 0, directions.
    Writes: POINT, MATRIX, DRIFT, DENSE, SIZE, columns 1, columns 2, columns 3, columns 4, columns
    5.
    """
    at = row * ROW_COLUMNS
    mode, flags = int(log[at + 3]), int(log[at + 4])
    if log[at + ROW_DENSE] > 0.0:
        series_sensed(mode, flags, log[at], length, w, own, q, m)
    else:
        radau_sensed(mode, flags, log[at], log[at + 2], length, w, own, q, m)


def moments(
    guard: int, mode: int, flags: int, t: float, w: Vector, own: Vector, q: int, m: int
) -> None:
    """Write how the moment changes at which a guard reaches zero; state in Y, its slope in Y1.

    Reads: Y, Y1, columns 0, directions.
    Writes: SLOPES, columns 4, guard slopes.
    """
    n = N_STATES
    now, to = columns_at(0, q, m), columns_at(4, q, m)
    guard_slopes(mode, flags, t, w, Y, SLOPES)
    guard_parameters(mode, flags, t, w, Y, guards_at(q))
    row = SLOPES + guard * (n + 1)
    rate = w[row + n]
    for i in range(n):
        rate += w[row + i] * w[Y1 + i]
    parameters, directions = guards_at(q) + guard * q, directions_at(q)
    for c in range(m):
        total = w[parameters + int(own[c])] if own[c] >= 0.0 else 0.0
        for k in range(3 * N_DRIVES):
            total += w[parameters + k] * w[directions + k * m + c]
        for i in range(n):
            total += w[row + i] * w[now + i * m + c]
        # implicit function theorem; where the guard only touches zero there is no such derivative
        w[to + c] = -total / rate if rate != 0.0 else 0.0


def jump(w: Vector, q: int, m: int) -> None:
    """Let the sensitivities jump: slope before in Y1, after in VALUES, moments in columns 4.

    Reads: Y1, VALUES, columns 0, columns 4.
    Writes: columns 0.
    """
    now, moment = columns_at(0, q, m), columns_at(4, q, m)
    # Saltation: a run that meets the event dt later follows the slope before it for that long, and
    # misses as much of the slope after it.
    for i in range(N_STATES):
        change = w[Y1 + i] - w[VALUES + i]
        for c in range(m):
            w[now + i * m + c] += change * w[moment + c]


def lose(w: Vector, q: int, m: int) -> None:
    """Give the sensitivities up: an impact changes the rates in a way that is not followed.

    Writes: columns 0.
    """
    now = columns_at(0, q, m)
    for i in range(N_STATES * m):
        w[now + i] = math.nan


def load_directions(piece: int, dtable: Vector, w: Vector, q: int, m: int) -> None:
    """Put the directions of one piece of the drives in their place.

    Writes: directions.
    """
    directions = directions_at(q)
    at = piece * (1 + 3 * N_DRIVES) * m + m
    for k in range(3 * N_DRIVES * m):
        w[directions + k] = dtable[at + k]


def pass_piece(
    mode: int,
    flags: int,
    t: float,
    piece: int,
    table: Vector,
    dtable: Vector,
    w: Vector,
    q: int,
    m: int,
) -> None:
    """Go over to another piece of the drives, at a moment that its start gives.

    Reads: Y, columns 0.
    Writes: drives, Y1, VALUES, columns 0, columns 4, directions.
    """
    moment = columns_at(4, q, m)
    field(mode, flags, t, w, Y, Y1)
    load_piece(table, piece, w)
    load_directions(piece, dtable, w, q, m)
    field(mode, flags, t, w, Y, VALUES)
    for c in range(m):
        w[moment + c] = dtable[piece * (1 + 3 * N_DRIVES) * m + c]
    jump(w, q, m)


def pass_event(guard: int, mode: int, flags: int, t: float, w: Vector, q: int, m: int) -> None:
    """Go over to the mode and the flags that follow an event.

    Reads: Y, Y1, columns 0, columns 4.
    Writes: Y, VALUES, columns 0.
    """
    if guard >= FIRST_WALL:
        lose(w, q, m)
    if guard == STOP and CAN_STICK:
        w[Y + SLIP] = 0.0
    field(mode, flags, t, w, Y, VALUES)
    jump(w, q, m)


def pass_instant(
    log: Vector,
    row: int,
    events: Vector,
    number: int,
    first: int,
    table: Vector,
    dtable: Vector,
    w: Vector,
    own: Vector,
    q: int,
    m: int,
) -> int:
    """Make all transitions at the end of a row; return the first event after them.

    What follows at the same instant has its moment from what came first.

    Reads: DENSE, columns 0, directions.
    Writes: drives, Y, Y1, POINT, VALUES, SLOPES, columns 0, columns 4, directions, guard slopes.
    """
    at = row * ROW_COLUMNS
    t = log[at + 1]
    mode, flags = int(log[at + 3]), int(log[at + 4])
    whole_row = log[at + ROW_DENSE] > 0.0  # the series at hand is that up to the end of the row
    interpolate(w, 1.0 if whole_row else (t - log[at]) / log[at + 2], POINT)
    for i in range(N_STATES):
        w[Y + i] = w[POINT + i]
    following = int(log[at + ROW_COLUMNS + 5])
    known = following != int(log[at + 5])
    if known:
        pass_piece(mode, flags, t, following, table, dtable, w, q, m)
    k = first
    while k < number and events[k * EVENT_COLUMNS] <= t:
        event = k * EVENT_COLUMNS
        guard = int(events[event + 3])
        field(mode, flags, t, w, Y, Y1)
        if not known:
            moments(guard, mode, flags, t, w, own, q, m)
            known = True
        mode, flags = int(events[event + 2]), int(events[event + 4])
        pass_event(guard, mode, flags, t, w, q, m)
        k += 1
    return k


def hold(mode: int, w: Vector, q: int, m: int) -> None:
    """Take away what a body that is held at the start does not do.

    Writes: columns 0.
    """
    if mode == 0:  # it loses a small velocity at once
        now = columns_at(0, q, m)
        for c in range(m):
            w[now + SLIP * m + c] = 0.0
    if abs(mode) == 2:  # what follows depends on what an impact at the start would do
        lose(w, q, m)


def sense(
    log: Vector,
    count: int,
    events: Vector,
    number: int,
    times: Vector,
    table: Vector,
    dtable: Vector,
    own: Vector,
    q: int,
    w: Vector,
    out: Vector,
) -> None:
    """Write the sensitivities at increasing times; those at the start stand in columns 0.

    `dtable` has the derivatives of the drives' table, a column a direction.

    Reads: columns 0.
    Writes: drives, Y, Y1, POINT, VALUES, MATRIX, DRIFT, DENSE, SLOPES, SIZE, columns 0, columns 1,
    columns 2, columns 3, columns 4, columns 5, directions, guard slopes.

    Parameters
    ----------
    log : array (rows ROW_COLUMNS,)
        Rows of steps.
    count : int
        Number of rows of steps.
    events : array (rows EVENT_COLUMNS,)
        Rows of events.
    number : int
        Number of rows of events.
    times : array (k,)
        Increasing times [s].
    table : array (pieces (1 + 3 N_DRIVES),)
        For each piece of the drives its start, then value, slope and start of each drive.
    dtable : array
        Derivatives of the drives' table, for each of its numbers one a direction.
    own : array (m,)
        Quantity of each direction, -1 for an initial state.
    q : int
        Number of quantities: numbers of the drives, then parameters.
    w : array (sense_size,)
        Vector of the run, with room for sensitivities.
    out : array (k N_STATES m,)
        Written: sensitivities at each time, rows by states.
    """
    m = len(own)
    n = N_STATES
    now, result = columns_at(0, q, m), columns_at(1, q, m)
    asked = 0
    k = 0
    while k < number and events[k * EVENT_COLUMNS] <= log[0]:
        k += 1
    hold(int(log[3]), w, q, m)
    for row in range(count):
        at = row * ROW_COLUMNS
        last = row == count - 1
        load_directions(int(log[at + 5]), dtable, w, q, m)
        while asked < len(times) and (last or times[asked] < log[at + 1]):
            restore(log, row, table, w)
            advance_sensed(log, row, times[asked] - log[at], w, own, q, m)
            for i in range(n * m):
                out[asked * n * m + i] = w[result + i]
            asked += 1
        if last:
            return
        restore(log, row, table, w)
        advance_sensed(log, row, log[at + 1] - log[at], w, own, q, m)
        for i in range(n * m):
            w[now + i] = w[result + i]
        k = pass_instant(log, row, events, number, k, table, dtable, w, own, q, m)
