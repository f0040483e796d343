"""Sensitivities: how the states of a recorded run change with parameters and initial states.

The rows of the run are gone through once more. In each the variational equations, linear along the
known solution, are solved: in exact modes by an exponential series, elsewhere by collocation
(Radau IIA, order nine, which stiffness does not hurt and which needs no second derivatives). At an
event, sensitivities jump with the moment of it (saltation), and those of the rates change by an
impact. Where two events coincide by chance there are none beyond: they are NaN.

The vector of the run is longer here: behind SIZE stand the slopes of the field and of the guards
with respect to all `q` quantities, the directions of the drives' numbers, and `m` columns of
sensitivities, rows by states, in several places. In the lists of slots, SIZE are the slopes of the
field, ``columns 0`` to ``columns 5`` the places of `columns_at`, `directions` and `guard slopes`
those of the functions of these names.
"""

import math

from stickslip.engine.kernels import equations
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector
from stickslip.engine.kernels.driver import restore, restore_modes, restore_start
from stickslip.engine.kernels.guard_roots import NO_GUARD
from stickslip.engine.kernels.mode_transitions import approach, wall_coordinate, wall_side
from stickslip.engine.kernels.numerics import NODES, WEIGHTS, interpolate, lu_factor, lu_solve
from stickslip.engine.kernels.steppers import VANISHED, series_fill

RADAU_STAGES = 5
RADAU_NODES = (
    0.05710419611451768,
    0.2768430136381238,
    0.5835904323689168,
    0.8602401356562195,
    1.0,
)
RADAU = (
    0.07299886431790333,
    -0.02673533110794557,
    0.018676929763984353,
    -0.01287910609330644,
    0.005042839233882015,
    0.15377523147918246,
    0.14621486784749352,
    -0.03644456890512809,
    0.02123306311930472,
    -0.007935579902728777,
    0.14006304568480987,
    0.29896712949128346,
    0.16758507013524895,
    -0.03396910168661774,
    0.010944288744192253,
    0.14489430810953477,
    0.2765000687601592,
    0.32579792291042103,
    0.12875675325490976,
    -0.015708917378805327,
    0.14371356079122594,
    0.28135601514946207,
    0.31182652297574126,
    0.22310390108357075,
    0.04,
)
"""The matrix of the method, rows one after the other; the last row holds the weights."""
COINCIDENT = 1e-9
"""Distance from its level, over the latter, at which what breaks away has done so by itself."""
TOGETHER_TOO = 1e-6
"""Difference of two moments' derivatives, over their size, up to which they are one."""
MOST_TERMS = layout.SERIES + 5
"""Powers of the Jacobian: the derivative of a series needs some beyond its own."""
SHARES = tuple(
    weight * (1.0 - node) ** k
    for k in range(MOST_TERMS + 1)
    for node, weight in zip(NODES, WEIGHTS, strict=True)
)
"""Weights of the nodes in an integral with a power of the time that is left."""


def guards_at(q: int, iw: IntVector) -> int:
    """Place of the guards' slopes."""
    return iw[layout.SIZE] + iw[layout.N_STATES] * q


def directions_at(q: int, iw: IntVector) -> int:
    """Place of the directions of the drives' numbers."""
    return guards_at(q, iw) + iw[layout.N_GUARDS] * q


def columns_at(which: int, q: int, m: int, iw: IntVector) -> int:
    """Place of sensitivities: 0 present, 1 result, 2 and 3 for terms; 4 moments; 5 what follows."""
    return directions_at(q, iw) + 3 * iw[layout.N_DRIVES] * m + which * iw[layout.N_STATES] * m


def sense_size(q: int, m: int, iw: IntVector) -> int:
    """Return how long the vector of a run must be."""
    n = iw[layout.N_STATES]
    stages = RADAU_STAGES * n
    return columns_at(5, q, m, iw) + max(stages * (stages + 1 + m), len(NODES) * n * m)


def forcing(
    t: float, at: int, w: Vector, iw: IntVector, own: Vector, q: int, m: int, to: int
) -> None:
    """Write the slopes of the field along each direction.

    `own` has the quantity of each direction, -1 for an initial state.
    """
    size = iw[layout.SIZE]
    n = iw[layout.N_STATES]
    n_drives = iw[layout.N_DRIVES]
    equations.field_slopes(t, w, iw, at, size)
    directions = directions_at(q, iw)
    for c in range(m):
        for i in range(n):
            row = size + i * q
            total = w[row + int(own[c])] if own[c] >= 0.0 else 0.0
            for k in range(3 * n_drives):
                if w[directions + k * m + c] != 0.0:
                    total += w[row + k] * w[directions + k * m + c]
            w[to + i * m + c] = total


def add_product(w: Vector, iw: IntVector, matrix: int, columns: int, m: int, to: int) -> None:
    """Add the product of an n x n matrix with columns."""
    n = iw[layout.N_STATES]
    for i in range(n):
        for j in range(n):
            factor = w[matrix + i * n + j]
            if factor != 0.0:
                for c in range(m):
                    w[to + i * m + c] += factor * w[columns + j * m + c]


def powers_needed(h: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int) -> int:
    """Return the last power of the Jacobian that counts in a step.

    Terms are at most those of absolute values, of the largest sensitivity of each state.
    """
    matrix, n, count = iw[layout.MATRIX], iw[layout.N_STATES], len(NODES)
    now, forced = columns_at(0, q, m, iw), columns_at(5, q, m, iw)
    largest, after, before = (
        columns_at(1, q, m, iw),
        columns_at(2, q, m, iw),
        columns_at(3, q, m, iw),
    )
    for i in range(n):
        size = 0.0
        for c in range(m):
            acts = 0.0
            if own[c] >= 0.0:
                for s in range(count):
                    acts = max(acts, abs(w[forced + (s * n + i) * m + c]))
            size = max(size, abs(w[now + i * m + c]) + h * acts)
        w[before + i] = size
        w[largest + i] = size
    power, ended = 0, False
    while power < MOST_TERMS and not ended:
        power += 1
        ended = True
        for i in range(n):
            total = 0.0
            for j in range(n):
                total += abs(w[matrix + i * n + j]) * w[before + j]
            w[after + i] = total * (h / power)
        for i in range(n):
            size = w[after + i]
            w[before + i] = size
            ended = ended and size <= VANISHED * w[largest + i]  # never of NaN
            w[largest + i] = max(w[largest + i], size)
    return power


def series_sensed(
    t: float, h: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int
) -> None:
    """Advance the sensitivities of an exact mode from the state in Y; result in columns 1.

    With the constant Jacobian A they are ``exp(h A) S + integral of exp((h - s) A) F(s)``. The
    integral is taken by the rule of Gauss, of which each power of A has a sum of its own; powers
    end where what they add has vanished.
    """
    y, matrix, point = iw[layout.Y], iw[layout.MATRIX], iw[layout.POINT]
    n, count = iw[layout.N_STATES], len(NODES)
    size = n * m
    now, result = columns_at(0, q, m, iw), columns_at(1, q, m, iw)
    term, forced = columns_at(2, q, m, iw), columns_at(5, q, m, iw)
    acts = False  # nothing does along initial states
    for c in range(m):
        acts = acts or own[c] >= 0.0
    if iw[layout.N_CONTACTS] > 0:
        w[layout.TIME] = t
        equations.ask_of(equations.SERIES_FROM, h, w, iw, y, 0)
    else:
        series_fill(t, h, w, iw, y)
    for s in range(count if acts else 0):
        interpolate(w, iw, NODES[s], point)
        forcing(t + NODES[s] * h, point, w, iw, own, q, m, forced + s * size)
    equations.jacobian(t, w, iw, y, matrix)
    most = powers_needed(h, w, iw, own, q, m)
    for k in range(most, -1, -1):
        for i in range(size):
            w[term + i] = w[result + i] * (h / (k + 1.0)) if k < most else 0.0
            w[result + i] = w[now + i]
        # Horner's scheme, from the highest power down: result = S + h F_k + (h A / (k + 1)) result,
        # where F_k is the mean of the forcing with the weight (1 - s / h)^k.
        for c in range(m):
            if own[c] >= 0.0:  # nothing acts along an initial state
                for i in range(n):
                    total, at = 0.0, forced + i * m + c
                    for s in range(count):
                        total += SHARES[k * count + s] * w[at + s * size]
                    w[result + i * m + c] += h * total
        add_product(w, iw, matrix, term, m, result)


def radau_stage(
    s: int, t: float, h: float, length: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int
) -> None:
    """Write the rows of one stage: of the matrix, and of all right-hand sides."""
    point = iw[layout.POINT]
    matrix_at = iw[layout.MATRIX]
    n = iw[layout.N_STATES]
    stages = RADAU_STAGES * n
    now, slopes, matrix = (
        columns_at(0, q, m, iw),
        columns_at(2, q, m, iw),
        columns_at(5, q, m, iw),
    )
    right = matrix + stages * (stages + 1)
    # Nodes of the part that is advanced, as fractions of the whole row, which the dense output
    # spans.
    share = RADAU_NODES[s] * length / h
    interpolate(w, iw, share, point)
    equations.jacobian(t + share * h, w, iw, point, matrix_at)
    forcing(t + share * h, point, w, iw, own, q, m, slopes)
    # The unknowns are the slopes K of the stages: K = F + J (S + length * (sum of RADAU x K)).
    add_product(w, iw, matrix_at, now, m, slopes)
    # Rows of I - length * (RADAU x J).
    for i in range(n):
        row = matrix + (s * n + i) * stages
        for other in range(RADAU_STAGES):
            factor = length * RADAU[s * RADAU_STAGES + other]
            for j in range(n):
                w[row + other * n + j] = -factor * w[matrix_at + i * n + j]
        w[row + s * n + i] += 1.0
        for c in range(m):
            w[right + c * stages + s * n + i] = w[slopes + i * m + c]


def radau_sensed(
    t: float, h: float, length: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int
) -> None:
    """Advance the sensitivities along a row of length `h` by `length`; result in columns 1."""
    n = iw[layout.N_STATES]
    stages = RADAU_STAGES * n
    now, result = columns_at(0, q, m, iw), columns_at(1, q, m, iw)
    matrix = columns_at(5, q, m, iw)
    pivots = matrix + stages * stages
    for s in range(RADAU_STAGES):
        radau_stage(s, t, h, length, w, iw, own, q, m)
    lu_factor(w, matrix, stages, pivots)
    for c in range(m):
        right = pivots + stages + c * stages
        lu_solve(w, matrix, stages, pivots, right)
        for i in range(n):
            total = 0.0
            for s in range(RADAU_STAGES):
                total += RADAU[(RADAU_STAGES - 1) * RADAU_STAGES + s] * w[right + s * n + i]
            w[result + i * m + c] = w[now + i * m + c] + length * total


def restore_sensed(log: Vector, row: int, table: Vector, w: Vector, iw: IntVector) -> None:
    """Bring back the start of a row; its series is filled in up to where it is needed."""
    if log[row * iw[layout.ROW_COLUMNS] + layout.ROW_DENSE] > 0.0:
        restore_start(log, row, table, w, iw)
    else:
        restore(log, row, table, w, iw)


def advance_sensed(
    log: Vector, row: int, length: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int
) -> None:
    """Advance the sensitivities from the start of a restored row; result in columns 1."""
    at = row * iw[layout.ROW_COLUMNS]
    if log[at + layout.ROW_DENSE] > 0.0:
        series_sensed(log[at], length, w, iw, own, q, m)
    else:
        radau_sensed(log[at], log[at + 2], length, w, iw, own, q, m)


def guard_changes(
    guard: int, t: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int
) -> None:
    """Write how a guard changes; state in Y."""
    y = iw[layout.Y]
    slopes = iw[layout.SLOPES]
    n_drives = iw[layout.N_DRIVES]
    n = iw[layout.N_STATES]
    now, to = columns_at(0, q, m, iw), columns_at(4, q, m, iw)
    equations.guard_slopes(t, w, iw, y, slopes)
    equations.guard_parameters(t, w, iw, y, guards_at(q, iw))
    row = slopes + guard * (n + 1)
    parameters, directions = guards_at(q, iw) + guard * q, directions_at(q, iw)
    for c in range(m):
        total = w[parameters + int(own[c])] if own[c] >= 0.0 else 0.0
        for k in range(3 * n_drives):
            total += w[parameters + k] * w[directions + k * m + c]
        for i in range(n):  # the chain rule: by quantities, drives and states
            total += w[row + i] * w[now + i * m + c]
        w[to + c] = total


def moments(guard: int, t: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int) -> None:
    """Write how the moment changes at which a guard reaches zero; state in Y, its slope in Y1."""
    n, to = iw[layout.N_STATES], columns_at(4, q, m, iw)
    guard_changes(guard, t, w, iw, own, q, m)
    row = iw[layout.SLOPES] + guard * (n + 1)
    rate = w[row + n]
    for i in range(n):
        rate += w[row + i] * w[iw[layout.Y1] + i]
    for c in range(m):
        # implicit function theorem; where the guard only touches zero there is no such derivative
        w[to + c] = -w[to + c] / rate if rate != 0.0 else 0.0


def same_moment(
    guard: int, t: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int
) -> None:
    """Give up moments in columns 4 along directions where another guard has one."""
    kept, moment = columns_at(3, q, m, iw), columns_at(4, q, m, iw)
    for c in range(m):
        w[kept + c] = w[moment + c]
    moments(guard, t, w, iw, own, q, m)
    for c in range(m):
        size = abs(w[kept + c]) + abs(w[moment + c])
        apart = abs(w[kept + c] - w[moment + c]) > TOGETHER_TOO * size
        w[moment + c] = math.nan if apart else w[kept + c]


def jump(w: Vector, iw: IntVector, q: int, m: int) -> None:
    """Let the sensitivities jump: slope before in Y1, after in VALUES, moments in columns 4."""
    n = iw[layout.N_STATES]
    y1 = iw[layout.Y1]
    values = iw[layout.VALUES]
    now, moment = columns_at(0, q, m, iw), columns_at(4, q, m, iw)
    # Saltation: a run that meets the event dt later follows the slope before it for that long, and
    # misses as much of the slope after it.
    for i in range(n):
        change = w[y1 + i] - w[values + i]
        for c in range(m):
            w[now + i * m + c] += change * w[moment + c]


def lose(w: Vector, iw: IntVector, q: int, m: int) -> None:
    """Give the sensitivities up: what came before the start is not known."""
    n = iw[layout.N_STATES]
    now = columns_at(0, q, m, iw)
    for i in range(n * m):
        w[now + i] = math.nan


def rebound(case: int, t: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int) -> None:
    """Let an impact change the sensitivities; slope before in Y1, moments in columns 4.

    They become those of the state right after the impact, whenever it comes: as the slope of that
    is what is left to subtract, the slope before is 0 from here on.
    """
    n, coordinates = iw[layout.N_STATES], iw[layout.N_COORDINATES]
    y1, size, slopes = iw[layout.Y1], iw[layout.SIZE], iw[layout.MATRIX]
    now, new = columns_at(0, q, m, iw), columns_at(3, q, m, iw)
    moment = columns_at(4, q, m, iw)
    for i in range(n):
        for c in range(m):
            # to the moment of the impact, which parameters move, from the end of the row
            w[now + i * m + c] += w[y1 + i] * w[moment + c]
        w[y1 + i] = 0.0
    equations.impact_slopes(case, t, w, iw, iw[layout.Y], slopes)
    equations.impact_parameters(case, t, w, iw, iw[layout.Y], size)
    for i in range(coordinates):
        for c in range(m):
            total = w[size + i * q + int(own[c])] if own[c] >= 0.0 else 0.0
            for j in range(n):
                total += w[slopes + i * n + j] * w[now + j * m + c]
            w[new + i * m + c] = total
    # Places go on without a jump; only rates have new sensitivities.
    for i in range(coordinates * m):
        w[now + coordinates * m + i] = w[new + i]


def bounces(wall: int, end: float, held: bool, w: Vector, iw: IntVector) -> bool:
    """Whether what strikes a stop bounces, by its rate after the instant and whether it is held.

    Without restitution nothing bounces, but more of it would make what is not held then do so.
    """
    restitution = w[iw[layout.WALLS] + wall * iw[layout.WALL_COLUMNS] + 1]
    return end != 0.0 or (restitution == 0.0 and not held)


def load_directions(piece: int, dtable: Vector, w: Vector, iw: IntVector, q: int, m: int) -> None:
    """Put the directions of one piece of the drives in their place."""
    n_drives = iw[layout.N_DRIVES]
    directions = directions_at(q, iw)
    at = piece * (1 + 3 * n_drives) * m + m
    for k in range(3 * n_drives * m):
        w[directions + k] = dtable[at + k]


def pass_piece(
    t: float, piece: int, table: Vector, dtable: Vector, w: Vector, iw: IntVector, q: int, m: int
) -> None:
    """Go over to another piece of the drives, at a moment that its start gives."""
    y = iw[layout.Y]
    n_drives = iw[layout.N_DRIVES]
    moment = columns_at(4, q, m, iw)
    equations.field(t, w, iw, y, iw[layout.Y1])
    equations.load_piece(table, piece, w, iw)
    load_directions(piece, dtable, w, iw, q, m)
    equations.field(t, w, iw, y, iw[layout.VALUES])
    for c in range(m):
        w[moment + c] = dtable[piece * (1 + 3 * n_drives) * m + c]
    jump(w, iw, q, m)


def pass_event(guard: int, t: float, w: Vector, iw: IntVector, q: int, m: int) -> None:
    """Go over to the mode and the flags that follow an event."""
    y = iw[layout.Y]
    # The run has stopped it exactly; the dense output leaves rounding.
    if guard == layout.STOP and iw[layout.CAN_STICK]:
        w[y + iw[layout.SLIP]] = 0.0
    equations.field(t, w, iw, y, iw[layout.VALUES])
    jump(w, iw, q, m)


def pass_impact(
    guard: int,
    mode: int,
    following: int,
    t: float,
    log: Vector,
    w: Vector,
    iw: IntVector,
    own: Vector,
    q: int,
    m: int,
) -> None:
    """Make an impact of a mechanism with one contact, after which it is in a mode.

    `following` is the row that begins after the instant.
    """
    n, y, wall = iw[layout.N_COORDINATES], iw[layout.Y], guard - iw[layout.FIRST_WALL]
    rate = n + wall_coordinate(wall, iw)
    equations.evaluate(equations.WALLS_OF, 0, iw[layout.FLAGS], t, w, y, iw[layout.WALLS])
    held = mode not in (1, -1)
    # The mode after the impact and the rate in the next row tell whether it bounced or stayed.
    end = log[following * iw[layout.ROW_COLUMNS] + layout.ROW_DENSE + 1 + rate]
    case = wall if bounces(wall, end, held, w, iw) else iw[layout.N_WALLS] + wall
    rebound(case, t, w, iw, own, q, m)
    equations.evaluate(equations.IMPACT, case, iw[layout.FLAGS], t, w, y, iw[layout.VALUES])
    for i in range(n):
        w[y + n + i] = w[iw[layout.VALUES] + i]


def pass_instant(
    log: Vector,
    row: int,
    events: Vector,
    number: int,
    first: int,
    table: Vector,
    dtable: Vector,
    w: Vector,
    iw: IntVector,
    own: Vector,
    q: int,
    m: int,
) -> int:
    """Make all transitions at the end of a row; return the first event after them.

    What follows at the same instant has its moment from what came first.
    """
    width = iw[layout.ROW_COLUMNS]
    point = iw[layout.POINT]
    n = iw[layout.N_STATES]
    y = iw[layout.Y]
    y1 = iw[layout.Y1]
    at = row * width
    t = log[at + 1]
    whole_row = (
        log[at + layout.ROW_DENSE] > 0.0
    )  # the series at hand is that up to the end of the row
    interpolate(w, iw, 1.0 if whole_row else (t - log[at]) / log[at + 2], point)
    for i in range(n):
        w[y + i] = w[point + i]
    if iw[layout.N_CONTACTS] > 0:
        guard = first_guard(events, first, number, t)
        struck = note_struck(log, row + 1, events, number, first, w, iw)
        pass_contacts(log, row, guard, struck, table, dtable, w, iw, own, q, m)
        while first < number and events[first * layout.EVENT_COLUMNS] <= t:
            first += 1
        return first
    following = int(log[at + width + 5])
    known = following != int(log[at + 5])
    # Where a new piece begins, its start gives the moment, and all events of the instant follow
    # from it.
    if known:
        pass_piece(t, following, table, dtable, w, iw, q, m)
    k, last = first, NO_GUARD
    while k < number and events[k * layout.EVENT_COLUMNS] <= t:
        event = k * layout.EVENT_COLUMNS
        guard = int(events[event + 3])
        equations.field(t, w, iw, y, y1)
        if not known:
            moments(guard, t, w, iw, own, q, m)
            known = True
        # A second stop met in the same instant has a moment of its own, for parameters nearby.
        elif guard >= iw[layout.FIRST_WALL] and guard != last:
            same_moment(guard, t, w, iw, own, q, m)
        if guard >= iw[layout.FIRST_WALL]:
            last = guard
            pass_impact(guard, int(events[event + 2]), row + 1, t, log, w, iw, own, q, m)
        iw[layout.MODE] = int(events[event + 2])
        iw[layout.FLAGS] = int(events[event + 4])
        pass_event(guard, t, w, iw, q, m)
        k += 1
    return k


def restore_contacts(log: Vector, row: int, w: Vector, iw: IntVector) -> None:
    """Take over modes, flags and state with which a row begins, of several contacts."""
    at = row * iw[layout.ROW_COLUMNS]
    for i in range(iw[layout.N_STATES]):
        w[iw[layout.Y] + i] = log[at + layout.ROW_DENSE + 1 + i]
    iw[layout.FLAGS] = int(log[at + 4])
    restore_modes(at + iw[layout.ROW_COLUMNS], log, w, iw)


def first_guard(events: Vector, k: int, number: int, t: float) -> int:
    """Return the guard that fell first of those at an instant, NO_GUARD if none did."""
    guard = NO_GUARD
    while k < number and events[k * layout.EVENT_COLUMNS] <= t:
        known = int(events[k * layout.EVENT_COLUMNS + 3])
        if guard == NO_GUARD:
            # Events of changed modes carry the guard that fell first as -2 - guard: see
            # `transitions.OF_MODES`.
            guard = known if known >= 0 else -2 - known
        k += 1
    return guard


def note_struck(
    log: Vector, row: int, events: Vector, number: int, first: int, w: Vector, iw: IntVector
) -> bool:
    """Write which coordinates an instant's impacts stop, and how all rates change; whether any is.

    What else changes then, such as a rate that friction has stopped, was 0 but for rounding.
    """
    n, rates = iw[layout.N_COORDINATES], iw[layout.Y] + iw[layout.N_COORDINATES]
    after = row * iw[layout.ROW_COLUMNS] + layout.ROW_DENSE + 1 + n
    # The modes after the instant stand at the end of the next row.
    modes = (row + 1) * iw[layout.ROW_COLUMNS] - iw[layout.N_PAIRS] - 2 * iw[layout.N_CONTACTS]
    t, result, k = log[row * iw[layout.ROW_COLUMNS]], False, first
    for i in range(n):
        iw[iw[layout.STRUCK] + i] = 0
        w[iw[layout.BOUNDS] + i] = log[after + i] - w[rates + i]
    while k < number and events[k * layout.EVENT_COLUMNS] <= t:
        wall = int(events[k * layout.EVENT_COLUMNS + 3]) - iw[layout.FIRST_WALL]
        if wall >= 0:
            i = wall_coordinate(wall, iw)
            held = int(log[modes + i]) == layout.HELD_FAST
            iw[iw[layout.STRUCK] + i] = 2 if bounces(wall, log[after + i], held, w, iw) else 1
            result = True
        k += 1
    return result


def own_moments(
    first: int,
    following: int,
    struck: bool,
    t: float,
    log: Vector,
    w: Vector,
    iw: IntVector,
    own: Vector,
    q: int,
    m: int,
) -> None:
    """Write the moment of an instant in which several contacts change, in the modes before it.

    Where two guards have fallen and not at the same moment for parameters nearby, the run has no
    derivative: NaN. Beside the first, these are of what has stopped, and of what breaks away just
    as it has reached its level, and not because of another.
    """
    values, rates = iw[layout.VALUES], iw[layout.Y1] + iw[layout.N_COORDINATES]
    after = (
        (following + 1) * iw[layout.ROW_COLUMNS] - iw[layout.N_PAIRS] - 2 * iw[layout.N_CONTACTS]
    )
    moments(first, t, w, iw, own, q, m)
    equations.guards(t, w, iw, iw[layout.Y], values)
    for other in range(2 * iw[layout.N_PAIRS]):
        mode, is_cut = (
            iw[iw[layout.MODES] + other // 2],
            other >= 2 * iw[layout.N_DIRECTIONS],
        )
        if other == first or (mode == int(log[after + other // 2]) and not is_cut):
            continue
        if mode == layout.HELD_FAST and iw[iw[layout.LOOPED] + other // 2]:
            continue  # its cuts tell
        stops = mode != layout.HELD_FAST and other % 2 == 0 and not is_cut
        if stops and struck:  # an impact may give it another mode, however fast it is
            stops = abs(w[values + other]) <= COINCIDENT * t * abs(w[rates + other // 2])
        # Both guards of what is held add up to its two levels.
        level = w[values + other] + w[values + other + 1 - 2 * (other % 2)]
        breaks = mode == layout.HELD_FAST and abs(w[values + other]) <= COINCIDENT * level
        if stops or breaks:
            same_moment(other, t, w, iw, own, q, m)


def pass_contacts(
    log: Vector,
    row: int,
    guard: int,
    struck: bool,
    table: Vector,
    dtable: Vector,
    w: Vector,
    iw: IntVector,
    own: Vector,
    q: int,
    m: int,
) -> None:
    """Make all that changes at the end of a row where several contacts rub, as one jump."""
    at = row * iw[layout.ROW_COLUMNS]
    y, t = iw[layout.Y], log[at + 1]
    w[layout.TIME] = t
    piece = int(log[at + iw[layout.ROW_COLUMNS] + 5])
    moment = columns_at(4, q, m, iw)
    equations.field(t, w, iw, y, iw[layout.Y1])
    if piece != int(log[at + 5]):
        equations.load_piece(table, piece, w, iw)
        load_directions(piece, dtable, w, iw, q, m)
        for c in range(m):
            w[moment + c] = dtable[piece * (1 + 3 * iw[layout.N_DRIVES]) * m + c]
    elif guard != NO_GUARD:
        own_moments(guard, row + 1, struck, t, log, w, iw, own, q, m)
    else:
        return
    if struck:
        for wall in range(iw[layout.N_WALLS]):
            meets = iw[iw[layout.STRUCK] + wall_coordinate(wall, iw)] != 0
            other = iw[layout.FIRST_WALL] + wall
            if meets and other != guard and approach(other, w, iw) > 0.0:
                same_moment(other, t, w, iw, own, q, m)
        rebound(0, t, w, iw, own, q, m)
    restore_contacts(log, row + 1, w, iw)
    equations.field(t, w, iw, y, iw[layout.VALUES])
    jump(w, iw, q, m)
    hold_contacts(w, iw, q, m)


def hold_contacts(w: Vector, iw: IntVector, q: int, m: int) -> None:
    """Take away the rates of what is held."""
    n, now = iw[layout.N_COORDINATES], columns_at(0, q, m, iw)
    for i in range(n):
        if iw[iw[layout.MODES] + i] == layout.HELD_FAST:
            for c in range(m):
                w[now + (n + i) * m + c] = 0.0
    if iw[layout.N_DIRECTIONS] > n:
        for c in range(m):
            equations.bind(now + n * m + c, m, w, iw)


def hold_at_stops(
    mode: int, t: float, w: Vector, iw: IntVector, own: Vector, q: int, m: int
) -> None:
    """Give up the directions in which what is held at its stop as a run begins would leave it.

    What follows there depends on what an impact would do right after the start.
    """
    n, states = iw[layout.N_COORDINATES], iw[layout.N_STATES]
    now, moves = columns_at(0, q, m, iw), columns_at(4, q, m, iw)
    for wall in range(iw[layout.N_WALLS]):
        i, side = wall_coordinate(wall, iw), wall_side(wall, iw)
        if iw[layout.N_CONTACTS] > 0:
            position = w[iw[layout.WALLS] + wall * iw[layout.WALL_COLUMNS]]
            held = iw[iw[layout.MODES] + i] == layout.HELD_FAST and w[iw[layout.Y] + i] == position
        else:
            held = mode == 2 * side and n + i == iw[layout.SLIP]
            iw[layout.MODE] = side if held else mode  # one that slips watches its stop
        if held:
            guard_changes(iw[layout.FIRST_WALL] + wall, t, w, iw, own, q, m)
            for c in range(m):
                if w[moves + c] != 0.0 or w[now + (n + i) * m + c] != 0.0:
                    for j in range(states):
                        w[now + j * m + c] = math.nan
    iw[layout.MODE] = mode


def hold(mode: int, w: Vector, iw: IntVector, q: int, m: int) -> None:
    """Take away what a body that is held at the start does not do: it loses a small velocity."""
    if mode == 0:
        now = columns_at(0, q, m, iw)
        for c in range(m):
            w[now + iw[layout.SLIP] * m + c] = 0.0


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
    iw: IntVector,
    out: Vector,
    to: int,
) -> None:
    """Write the sensitivities at increasing times; those at the start stand in columns 0.

    `dtable` has the derivatives of the drives' table, a column a direction.
    """
    width = iw[layout.ROW_COLUMNS]
    m = len(own)
    n = iw[layout.N_STATES]
    now, result = columns_at(0, q, m, iw), columns_at(1, q, m, iw)
    asked = 0
    k = 0
    # What happens as a run begins has no row before it.
    while k < number and events[k * layout.EVENT_COLUMNS] <= log[0]:
        if events[k * layout.EVENT_COLUMNS + 3] >= iw[layout.FIRST_WALL]:
            lose(w, iw, q, m)
        k += 1
    equations.put_constants(w, iw)
    if iw[layout.N_CONTACTS] > 0:
        equations.ask(equations.PREPARE, log[0], w, iw)
        equations.turn_columns(now, m, 0, w, iw)
    load_directions(int(log[5]), dtable, w, iw, q, m)
    restore(log, 0, table, w, iw)
    hold_at_stops(int(log[3]), log[0], w, iw, own, q, m)
    if iw[layout.N_CONTACTS] > 0:
        hold_contacts(w, iw, q, m)
    else:
        hold(int(log[3]), w, iw, q, m)
    for row in range(count):
        at = row * width
        last = row == count - 1
        load_directions(int(log[at + 5]), dtable, w, iw, q, m)
        # The last row also answers all times behind its end.
        while asked < len(times) and (last or times[asked] < log[at + 1]):
            restore_sensed(log, row, table, w, iw)
            advance_sensed(log, row, times[asked] - log[at], w, iw, own, q, m)
            equations.turn_columns(result, m, 1, w, iw)
            for i in range(n * m):
                out[to + asked * n * m + i] = w[result + i]
            asked += 1
        if last:
            return
        restore_sensed(log, row, table, w, iw)
        advance_sensed(log, row, log[at + 1] - log[at], w, iw, own, q, m)
        for i in range(n * m):
            w[now + i] = w[result + i]
        k = pass_instant(log, row, events, number, k, table, dtable, w, iw, own, q, m)
