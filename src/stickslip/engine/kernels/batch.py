"""Ensembles: many runs one after the other or by stretches, and what is kept of each.

A reducer keeps one number of a run for each output: its last value, its value at a time, an
extremum (by the dense output, not by samples), a mean by quadrature, the time or number of events,
or the slope with respect to a parameter.
"""

import math

from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector
from stickslip.engine.kernels.contacts.motion import first_contact_guard, first_own_switch
from stickslip.engine.kernels.driver import restore, restore_start, row_at, run
from stickslip.engine.kernels.equations import energy, state_seen
from stickslip.engine.kernels.mode_transitions import wall_coordinate
from stickslip.engine.kernels.numerics import NODES, WEIGHTS, interpolate
from stickslip.engine.kernels.sensitivities import columns_at, sense

# What is kept of a run in an ensemble: one number for each output.

GOLD = 0.6180339887498949


def state_in(x: float, state: int, w: Vector, iw: IntVector) -> float:
    """Return a state at a fraction of the restored row."""
    point = iw[layout.POINT]
    interpolate(w, iw, x, point)
    return state_seen(point, state, w, iw)


def peak_in(state: int, side: float, low: float, high: float, w: Vector, iw: IntVector) -> float:
    """Return the largest `side` times a state within a bracket, by golden section."""
    a = high - GOLD * (high - low)
    b = low + GOLD * (high - low)
    f_a = side * state_in(a, state, w, iw)
    f_b = side * state_in(b, state, w, iw)
    for _ in range(40):
        if f_a > f_b:
            high = b
            b = a
            f_b = f_a
            a = high - GOLD * (high - low)
            f_a = side * state_in(a, state, w, iw)
        else:
            low = a
            a = b
            f_a = f_b
            b = low + GOLD * (high - low)
            f_b = side * state_in(b, state, w, iw)
    return max(f_a, f_b)


def extremum(
    state: int,
    side: float,
    since: float,
    w: Vector,
    iw: IntVector,
    count: int,
    log: Vector,
    table: Vector,
) -> float:
    """Return the largest (`side` 1) or smallest (-1) value of a state from a time on."""
    width_at = iw[layout.ROW_COLUMNS]
    best = -math.inf
    for row in range(row_at(log, count, since, iw), count):
        at = row * width_at
        restore(log, row, table, w, iw)
        first = max((since - log[at]) / log[at + 2], 0.0)
        width = ((log[at + 1] - log[at]) / log[at + 2] - first) / layout.SAMPLES
        top = side * state_in(first, state, w, iw)
        lowest = top
        place = first
        for s in range(1, layout.SAMPLES + 1):
            here = side * state_in(first + s * width, state, w, iw)
            lowest = min(lowest, here)
            if here > top:
                top = here
                place = first + s * width
        best = max(best, top)
        # a peak lies beside the highest sample, and above it by less than the samples differ
        if top + (top - lowest) > best:
            low = max(place - width, first)
            high = min(place + width, first + layout.SAMPLES * width)
            best = max(best, peak_in(state, side, low, high, w, iw))
    return side * best


def mean(
    state: int,
    since: float,
    until: float,
    w: Vector,
    iw: IntVector,
    count: int,
    log: Vector,
    table: Vector,
) -> float:
    """Return the mean of a state over a stretch of time."""
    width = iw[layout.ROW_COLUMNS]
    total = 0.0
    for row in range(row_at(log, count, since, iw), count):
        at = row * width
        begin = max(since, log[at])
        span = min(until, log[at + 1]) - begin
        if span > 0.0:
            restore(log, row, table, w, iw)
            for node in range(len(NODES)):
                x = (begin - log[at] + NODES[node] * span) / log[at + 2]
                total += WEIGHTS[node] * span * state_in(x, state, w, iw)
    return total / (until - since)


def happened(events: Vector, k: int, iw: IntVector) -> int:
    """Return what event `k` was, as a code."""
    first_wall = iw[layout.FIRST_WALL]
    first_limit = iw[layout.FIRST_LIMIT]
    coordinates = iw[layout.N_COORDINATES]
    at = k * layout.EVENT_COLUMNS
    guard = int(events[at + 3])
    if iw[layout.N_CONTACTS] > 0:
        return contact_happened(at, guard, events, iw)
    if guard == layout.STOP:
        return layout.REVERSED if abs(events[at + 2]) == 1.0 else layout.STOPPED
    if guard in (layout.BREAK_FORWARD, layout.BREAK_BACKWARD):
        return layout.LEFT_STOP if abs(events[at + 1]) == 2.0 else layout.BROKE_AWAY
    if guard == layout.LIFT_OFF:
        return layout.LEFT_GROUND
    if guard >= first_wall:
        return layout.HIT + wall_coordinate(guard - first_wall, iw)
    if guard >= first_limit:
        return layout.HIT + coordinates + guard - first_limit
    ceased = 1 - ((int(events[at + 4]) >> (guard - layout.SWITCH)) & 1)
    return layout.HIT + coordinates + iw[layout.N_LIMITS] + 2 * (guard - layout.SWITCH) + ceased


def contact_happened(at: int, guard: int, events: Vector, iw: IntVector) -> int:
    """Return what an event was where several contacts rub, as a code."""
    before, after = events[at + 1], events[at + 2]
    if guard < 0:
        if layout.UNLOADED in (before, after):
            return layout.OPENED if after == layout.UNLOADED else layout.CLOSED_AGAIN
        if abs(before) == 2.0:
            return layout.LEFT_STOP
        if after == layout.HELD_FAST or abs(after) == 2.0:
            return layout.STOPPED
        return layout.BROKE_AWAY if before == layout.HELD_FAST else layout.REVERSED
    first = layout.CLOSED_AGAIN + 1
    if guard >= iw[layout.FIRST_WALL]:
        return first + wall_coordinate(guard - iw[layout.FIRST_WALL], iw)
    first += iw[layout.N_COORDINATES]
    if guard >= iw[layout.FIRST_LIMIT]:
        return first + guard - iw[layout.FIRST_LIMIT]
    first += iw[layout.N_LIMITS]
    own = first_own_switch(iw)
    if guard < first_contact_guard(iw):  # of a coordinate: it leaves its stop
        left = 2 * (iw[layout.N_SWITCHES] + iw[layout.N_CONTACTS] * iw[layout.LAW_SWITCHES])
        return first + left + guard // 2
    if guard >= own:
        ceased = 1 - ((int(events[at + 4]) >> (guard - own)) & 1)
        return first + 2 * (guard - own) + ceased
    contact, which = divmod(guard - first_contact_guard(iw), iw[layout.LAW_SWITCHES] + 1)
    if which == iw[layout.LAW_SWITCHES]:
        return layout.LEFT_GROUND
    ceased = 1 - ((int(events[at + 4]) >> which) & 1)
    place = contact * iw[layout.LAW_SWITCHES] + which
    return first + 2 * iw[layout.N_SWITCHES] + 2 * place + ceased


def happened_at(what: int, contact: int, events: Vector, k: int, iw: IntVector) -> bool:
    """Return whether event `k` was this, at a contact, or at any if that is negative."""
    if contact >= 0 and int(events[k * layout.EVENT_COLUMNS + 6]) != contact:
        return False
    return happened(events, k, iw) == what


def event_time(what: int, contact: int, which: int, iw: IntVector, events: Vector) -> float:
    """Return when something happened for the n-th time from 0, from the end if negative; or NaN."""
    result = 0
    number = iw[layout.EVENTS]
    for i in range(number):
        k = i if which >= 0 else number - 1 - i
        if happened_at(what, contact, events, k, iw):
            if result == (which if which >= 0 else -1 - which):
                return events[k * layout.EVENT_COLUMNS]
            result += 1
    return math.nan


def event_count(what: int, contact: int, iw: IntVector, events: Vector) -> float:
    """Return how often something happened."""
    result = 0.0
    for k in range(iw[layout.EVENTS]):
        if happened_at(what, contact, events, k, iw):
            result += 1.0
    return result


def reduced(
    kind: int,
    what: int,
    first: float,
    last: float,
    w: Vector,
    iw: IntVector,
    table: Vector,
    log: Vector,
    events: Vector,
) -> float:
    """Return one output of a run.

    `what` is a state, or what happened; `first` and `last` are a time, a stretch of time, or which
    event and the contact at which it was. Asked for beyond the end of a run that ended early, the
    output is NaN.
    """
    width = iw[layout.ROW_COLUMNS]
    count = iw[layout.STEPS]
    if kind == layout.FINAL:
        return w[iw[layout.END] + what]
    if kind == layout.EVENT_TIME:
        return event_time(what, int(last), int(first), iw, events)
    if kind == layout.EVENT_COUNT:
        return event_count(what, int(last), iw, events)
    end = log[(count - 1) * width + 1]
    if not first <= end:
        return math.nan
    if kind in (layout.GREATEST, layout.SMALLEST):
        return extremum(
            what, 1.0 if kind == layout.GREATEST else -1.0, first, w, iw, count, log, table
        )
    if kind == layout.MEAN:
        return mean(what, first, last, w, iw, count, log, table) if last <= end else math.nan
    row = row_at(log, count, first, iw)
    restore(log, row, table, w, iw)
    at = row * width
    return state_in((first - log[at]) / log[at + 2], what, w, iw) if kind == layout.AT else math.nan


# Many runs one after the other, of each of which some numbers are kept.

EVIDENCE = 5
"""Energy error, guard violation, event residual, steps, rejected steps."""


def prepare_row(
    row: int, columns: Vector, places: Vector, base: Vector, w: Vector, iw: IntVector
) -> None:
    """Set the vectors of a run back, with the numbers of one row in their places."""
    stages = iw[layout.STAGES]
    reached = iw[layout.REACHED]
    slopes = iw[layout.SLOPES]
    for i in range(layout.POLYNOMIAL):
        w[i] = base[i]
    for i in range(layout.NUMBERS, stages):
        w[i] = base[i]
    for i in range(reached, slopes):
        w[i] = 0.0
    for i in range(len(places)):
        w[int(places[i])] = columns[row * len(places) + i]
    books = iw[layout.BOOKS]
    for i in range(layout.WHOLES):
        iw[i] = 0
    iw[layout.BOOKS] = books


def energy_at(t: float, w: Vector, iw: IntVector) -> float:
    """Return the energy of the state in Y."""
    values = iw[layout.VALUES]
    energy(t, w, iw, iw[layout.Y], values)
    return w[values]


def potential_at(t: float, w: Vector, iw: IntVector) -> float:
    """Return the energy of the state in Y at rest, where it is left."""
    n = iw[layout.N_COORDINATES]
    for i in range(n, 2 * n):
        w[iw[layout.Y] + i] = 0.0
    return energy_at(t, w, iw)


def keep_evidence(
    at: int, w: Vector, iw: IntVector, table: Vector, log: Vector, evidence: Vector
) -> None:
    """Write how far the run may be trusted, and keep its last state."""
    n = iw[layout.N_STATES]
    end = iw[layout.END]
    y = iw[layout.Y]
    for i in range(n):
        w[end + i] = state_seen(y, i, w, iw)
    last = energy_at(w[layout.TIME], w, iw)
    size = max(abs(last), w[layout.GROSS], last - potential_at(w[layout.TIME], w, iw))
    restore_start(log, 0, table, w, iw)
    first = energy_at(log[0], w, iw)
    size = max(abs(first), size, first - potential_at(log[0], w, iw))
    mismatch = abs(last - first - w[layout.SUPPLIED] + w[layout.TAKEN] + w[layout.LOST])
    evidence[at] = mismatch / size if mismatch != 0.0 else 0.0  # what is no number stays none
    evidence[at + 1] = w[layout.VIOLATION]
    evidence[at + 2] = w[layout.RESIDUAL]
    evidence[at + 3] = iw[layout.STEPS]
    evidence[at + 4] = iw[layout.REJECTED]


def batch_row(
    row: int,
    columns: Vector,
    places: Vector,
    base: Vector,
    table: Vector,
    bounds: Vector,
    cap: float,
    outputs: Vector,
    arguments: Vector,
    t_end: float,
    rtol: float,
    limit: int,
    w: Vector,
    iw: IntVector,
    log: Vector,
    events: Vector,
    results: Vector,
    statuses: Vector,
    evidence: Vector,
) -> bool:
    """Make one run, or go on with it, and keep its outputs; return whether it found room."""
    n = len(outputs) // 2
    if iw[layout.STATUS] != layout.FULL:
        prepare_row(row, columns, places, base, w, iw)
    run(w, iw, table, bounds, t_end, rtol, cap, limit, log, events)
    if iw[layout.STATUS] == layout.FULL:
        return False
    statuses[row] = iw[layout.STATUS]
    keep_evidence(row * EVIDENCE, w, iw, table, log, evidence)
    asked = row * 2 * n if len(arguments) > 2 * n else 0
    for j in range(n):
        results[row * n + j] = reduced(
            int(outputs[2 * j]), int(outputs[2 * j + 1]), arguments[asked + 2 * j],
            arguments[asked + 2 * j + 1], w, iw, table, log, events,
        )  # fmt: skip
    return True


def batch(
    first: int,
    count: int,
    columns: Vector,
    places: Vector,
    base: Vector,
    tables: Vector,
    bounds: Vector,
    caps: Vector,
    outputs: Vector,
    arguments: Vector,
    t_end: float,
    rtol: float,
    limit: int,
    w: Vector,
    iw: IntVector,
    log: Vector,
    events: Vector,
    results: Vector,
    statuses: Vector,
    evidence: Vector,
) -> int:
    """Run all rows from one on; return the first that is not done, for want of room for its rows.

    The caller makes room, and calls again with that row.

    `columns` has a row a run: the numbers that go to `places` of the vector of a run, which is
    `base` otherwise. `tables`, `bounds`, `caps` and `arguments` have a row a run, or one for all.
    `outputs` has kind and subject of each output, `arguments` two numbers for each.
    """
    width, room = len(tables) // len(caps), len(bounds) // len(caps)
    for row in range(first, count):
        own = row if len(caps) > 1 else 0
        done = batch_row(
            row, columns, places, base, tables[own * width : (own + 1) * width],
            bounds[own * room : (own + 1) * room], caps[own], outputs, arguments, t_end, rtol,
            limit, w, iw, log, events, results, statuses, evidence,
        )  # fmt: skip
        if not done:
            return row
    return count


def sense_end(
    row: int,
    table: Vector,
    starts: Vector,
    slopes: Vector,
    own: Vector,
    q: int,
    w: Vector,
    iw: IntVector,
    log: Vector,
    events: Vector,
    gradients: Vector,
) -> None:
    """Take the sensitivities at the end of a run.

    `starts` has those at its start, `slopes` the derivatives of its table, `own` and `q` are as in
    `sense`; `gradients` gets states by directions.
    """
    size = len(starts)
    first = columns_at(0, q, len(own), iw)
    for i in range(size):
        w[first + i] = starts[i]
    steps = iw[layout.STEPS]
    last = (steps - 1) * iw[layout.ROW_COLUMNS]
    end = log[last + 1 : last + 2]
    sense(
        log, steps, events, iw[layout.EVENTS], end, table, slopes, own, q, w, iw, gradients,
        row * size,
    )  # fmt: skip


def batch_sensed(
    first: int, count: int, columns: Vector, places: Vector, base: Vector, tables: Vector,
    bounds: Vector, caps: Vector, outputs: Vector, arguments: Vector, t_end: float, rtol: float,
    limit: int, w: Vector, iw: IntVector, log: Vector, events: Vector, results: Vector,
    statuses: Vector, evidence: Vector, starts: Vector, slopes: Vector, own: Vector, q: int,
    gradients: Vector,
) -> int:  # fmt: skip
    """Run rows as `batch` does, and take the sensitivities at their ends."""
    width, room = len(tables) // len(caps), len(bounds) // len(caps)
    long = len(slopes) // len(caps)
    for row in range(first, count):
        at = row if len(caps) > 1 else 0
        table = tables[at * width : (at + 1) * width]
        done = batch_row(
            row, columns, places, base, table, bounds[at * room : (at + 1) * room], caps[at],
            outputs, arguments, t_end, rtol, limit, w, iw, log, events, results, statuses,
            evidence,
        )  # fmt: skip
        if not done:
            return row
        sense_end(
            row, table, starts, slopes[at * long : (at + 1) * long], own, q, w, iw, log, events,
            gradients,
        )  # fmt: skip
    return count


# Many runs that go on together, each by a stretch in which its drives are constant.


def kept_size(iw: IntVector) -> int:
    """Return how many numbers of the vector of a run are kept between stretches.

    The room in which roots of guards are looked for is not among them.
    """
    return layout.POLYNOMIAL + iw[layout.SIZE] - layout.NUMBERS


def take_up(row: int, kept: Vector, int_vectors: IntVector, w: Vector, iw: IntVector) -> None:
    """Put the numbers of a run into the vectors of a run."""
    at = row * kept_size(iw)
    for i in range(layout.POLYNOMIAL):
        w[i] = kept[at + i]
    at += layout.POLYNOMIAL - layout.NUMBERS
    for i in range(layout.NUMBERS, iw[layout.SIZE]):
        w[i] = kept[at + i]
    at = row * len(iw)
    for i in range(len(iw)):
        iw[i] = int_vectors[at + i]


def put_away(row: int, kept: Vector, int_vectors: IntVector, w: Vector, iw: IntVector) -> None:
    """Keep the numbers of a run."""
    at = row * kept_size(iw)
    for i in range(layout.POLYNOMIAL):
        kept[at + i] = w[i]
    at += layout.POLYNOMIAL - layout.NUMBERS
    for i in range(layout.NUMBERS, iw[layout.SIZE]):
        kept[at + i] = w[i]
    at = row * len(iw)
    for i in range(len(iw)):
        int_vectors[at + i] = iw[i]


def hold_drives(row: int, values: Vector, table: Vector, iw: IntVector) -> None:
    """Make a table of one piece, in which each drive has a constant value."""
    n_drives = iw[layout.N_DRIVES]
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
    int_vectors: IntVector,
    w: Vector,
    iw: IntVector,
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
        if int_vectors[row * len(iw) + layout.STATUS] in (
            layout.RUNNING,
            layout.END_TIME,
            layout.FULL,
        ):
            take_up(row, kept, int_vectors, w, iw)
            if iw[layout.STATUS] != layout.FULL:
                iw[layout.STEPS] = 0
                iw[layout.EVENTS] = 0
            hold_drives(row, values, table, iw)
            run(w, iw, table, bounds, untils[row], rtol, cap, limit, log, events)
            put_away(row, kept, int_vectors, w, iw)
            if iw[layout.STATUS] == layout.FULL:
                return row
    return count
