"""What is kept of a run in an ensemble: one number for each output."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.contacts.guards import first_contact_guard, first_own_switch
from stickslip.kernels.coordinates import state_seen
from stickslip.kernels.dense_evaluation import restore, row_at
from stickslip.kernels.dense_output import interpolate
from stickslip.kernels.enums import (
    AT,
    BREAK_BACKWARD,
    BREAK_FORWARD,
    BROKE_AWAY,
    CLOSED_AGAIN,
    EVENT_COUNT,
    EVENT_TIME,
    FINAL,
    GREATEST,
    HELD_FAST,
    HIT,
    LEFT_GROUND,
    LEFT_STOP,
    LIFT_OFF,
    MEAN,
    OPENED,
    REVERSED,
    SMALLEST,
    STOP,
    STOPPED,
    SWITCH,
    UNLOADED,
)
from stickslip.kernels.gauss_legendre import NODES, WEIGHTS
from stickslip.kernels.hard_stops import wall_coordinate
from stickslip.kernels.state_layout import (
    END,
    EVENT_COLUMNS,
    EVENTS,
    FIRST_LIMIT,
    FIRST_WALL,
    LAW_SWITCHES,
    N_CONTACTS,
    N_COORDINATES,
    N_LIMITS,
    N_SWITCHES,
    POINT,
    ROW_COLUMNS,
    SAMPLES,
    STEPS,
)

GOLD = 0.6180339887498949


def state_in(x: float, state: int, w: Vector, whole: Wholes) -> float:
    """Return a state at a fraction of the restored row."""
    point = whole[POINT]
    interpolate(w, whole, x, point)
    return state_seen(point, state, w, whole)


def peak_in(state: int, side: float, low: float, high: float, w: Vector, whole: Wholes) -> float:
    """Return the largest `side` times a state within a bracket, by golden section."""
    a = high - GOLD * (high - low)
    b = low + GOLD * (high - low)
    f_a = side * state_in(a, state, w, whole)
    f_b = side * state_in(b, state, w, whole)
    for _ in range(40):
        if f_a > f_b:
            high = b
            b = a
            f_b = f_a
            a = high - GOLD * (high - low)
            f_a = side * state_in(a, state, w, whole)
        else:
            low = a
            a = b
            f_a = f_b
            b = low + GOLD * (high - low)
            f_b = side * state_in(b, state, w, whole)
    return max(f_a, f_b)


def extremum(
    state: int,
    side: float,
    since: float,
    w: Vector,
    whole: Wholes,
    count: int,
    log: Vector,
    table: Vector,
) -> float:
    """Return the largest (`side` 1) or smallest (-1) value of a state from a time on."""
    width_at = whole[ROW_COLUMNS]
    best = -math.inf
    for row in range(row_at(log, count, since, whole), count):
        at = row * width_at
        restore(log, row, table, w, whole)
        first = max((since - log[at]) / log[at + 2], 0.0)
        width = ((log[at + 1] - log[at]) / log[at + 2] - first) / SAMPLES
        top = side * state_in(first, state, w, whole)
        lowest = top
        place = first
        for s in range(1, SAMPLES + 1):
            here = side * state_in(first + s * width, state, w, whole)
            lowest = min(lowest, here)
            if here > top:
                top = here
                place = first + s * width
        best = max(best, top)
        # a peak lies beside the highest sample, and above it by less than the samples differ
        if top + (top - lowest) > best:
            low = max(place - width, first)
            high = min(place + width, first + SAMPLES * width)
            best = max(best, peak_in(state, side, low, high, w, whole))
    return side * best


def mean(
    state: int,
    since: float,
    until: float,
    w: Vector,
    whole: Wholes,
    count: int,
    log: Vector,
    table: Vector,
) -> float:
    """Return the mean of a state over a stretch of time."""
    width = whole[ROW_COLUMNS]
    total = 0.0
    for row in range(row_at(log, count, since, whole), count):
        at = row * width
        begin = max(since, log[at])
        span = min(until, log[at + 1]) - begin
        if span > 0.0:
            restore(log, row, table, w, whole)
            for node in range(len(NODES)):
                x = (begin - log[at] + NODES[node] * span) / log[at + 2]
                total += WEIGHTS[node] * span * state_in(x, state, w, whole)
    return total / (until - since)


def happened(events: Vector, k: int, whole: Wholes) -> int:
    """Return what event `k` was, as a code."""
    first_wall = whole[FIRST_WALL]
    first_limit = whole[FIRST_LIMIT]
    coordinates = whole[N_COORDINATES]
    at = k * EVENT_COLUMNS
    guard = int(events[at + 3])
    if whole[N_CONTACTS] > 0:
        return contact_happened(at, guard, events, whole)
    if guard == STOP:
        return REVERSED if abs(events[at + 2]) == 1.0 else STOPPED
    if guard in (BREAK_FORWARD, BREAK_BACKWARD):
        return LEFT_STOP if abs(events[at + 1]) == 2.0 else BROKE_AWAY
    if guard == LIFT_OFF:
        return LEFT_GROUND
    if guard >= first_wall:
        return HIT + wall_coordinate(guard - first_wall, whole)
    if guard >= first_limit:
        return HIT + coordinates + guard - first_limit
    ceased = 1 - ((int(events[at + 4]) >> (guard - SWITCH)) & 1)
    return HIT + coordinates + whole[N_LIMITS] + 2 * (guard - SWITCH) + ceased


def contact_happened(at: int, guard: int, events: Vector, whole: Wholes) -> int:
    """Return what an event was where several contacts rub, as a code."""
    before, after = events[at + 1], events[at + 2]
    if guard < 0:
        if UNLOADED in (before, after):
            return OPENED if after == UNLOADED else CLOSED_AGAIN
        if abs(before) == 2.0:
            return LEFT_STOP
        if after == HELD_FAST or abs(after) == 2.0:
            return STOPPED
        return BROKE_AWAY if before == HELD_FAST else REVERSED
    first = CLOSED_AGAIN + 1
    if guard >= whole[FIRST_WALL]:
        return first + wall_coordinate(guard - whole[FIRST_WALL], whole)
    first += whole[N_COORDINATES]
    if guard >= whole[FIRST_LIMIT]:
        return first + guard - whole[FIRST_LIMIT]
    first += whole[N_LIMITS]
    own = first_own_switch(whole)
    if guard < first_contact_guard(whole):  # of a coordinate: it leaves its stop
        left = 2 * (whole[N_SWITCHES] + whole[N_CONTACTS] * whole[LAW_SWITCHES])
        return first + left + guard // 2
    if guard >= own:
        ceased = 1 - ((int(events[at + 4]) >> (guard - own)) & 1)
        return first + 2 * (guard - own) + ceased
    contact, which = divmod(guard - first_contact_guard(whole), whole[LAW_SWITCHES] + 1)
    if which == whole[LAW_SWITCHES]:
        return LEFT_GROUND
    ceased = 1 - ((int(events[at + 4]) >> which) & 1)
    place = contact * whole[LAW_SWITCHES] + which
    return first + 2 * whole[N_SWITCHES] + 2 * place + ceased


def happened_at(what: int, contact: int, events: Vector, k: int, whole: Wholes) -> bool:
    """Return whether event `k` was this, at a contact, or at any if that is negative."""
    if contact >= 0 and int(events[k * EVENT_COLUMNS + 6]) != contact:
        return False
    return happened(events, k, whole) == what


def event_time(what: int, contact: int, which: int, whole: Wholes, events: Vector) -> float:
    """Return when something happened for the n-th time from 0, from the end if negative; or NaN."""
    found = 0
    number = whole[EVENTS]
    for i in range(number):
        k = i if which >= 0 else number - 1 - i
        if happened_at(what, contact, events, k, whole):
            if found == (which if which >= 0 else -1 - which):
                return events[k * EVENT_COLUMNS]
            found += 1
    return math.nan


def event_count(what: int, contact: int, whole: Wholes, events: Vector) -> float:
    """Return how often something happened."""
    found = 0.0
    for k in range(whole[EVENTS]):
        if happened_at(what, contact, events, k, whole):
            found += 1.0
    return found


def reduced(
    kind: int,
    what: int,
    first: float,
    last: float,
    w: Vector,
    whole: Wholes,
    table: Vector,
    log: Vector,
    events: Vector,
) -> float:
    """Return one output of a run.

    `what` is a state, or what happened; `first` and `last` are a time, a stretch of time, or which
    event and the contact at which it was. Asked for beyond the end of a run that ended early, the
    output is NaN.
    """
    width = whole[ROW_COLUMNS]
    count = whole[STEPS]
    if kind == FINAL:
        return w[whole[END] + what]
    if kind == EVENT_TIME:
        return event_time(what, int(last), int(first), whole, events)
    if kind == EVENT_COUNT:
        return event_count(what, int(last), whole, events)
    end = log[(count - 1) * width + 1]
    if not first <= end:
        return math.nan
    if kind in (GREATEST, SMALLEST):
        return extremum(what, 1.0 if kind == GREATEST else -1.0, first, w, whole, count, log, table)
    if kind == MEAN:
        return mean(what, first, last, w, whole, count, log, table) if last <= end else math.nan
    row = row_at(log, count, first, whole)
    restore(log, row, table, w, whole)
    at = row * width
    return state_in((first - log[at]) / log[at + 2], what, w, whole) if kind == AT else math.nan
