"""The run: steps, events, pieces of the drives, rest."""

import math

from stickslip.kernels.codes import (
    AT_REST,
    BREAK_FORWARD,
    END_TIME,
    LIFT_OFF,
    LIFTED_OFF,
    RUNNING,
    STEP_LIMIT,
    STEP_TOO_SMALL,
    STOP,
    SWITCH,
    ZENO,
)
from stickslip.kernels.dense import TERMS, interpolate
from stickslip.kernels.dop853 import DOP853_STAGES, dop853_dense, dop853_step
from stickslip.kernels.model import (
    CAN_STICK,
    HAS_BRISTLES,
    N_DRIVES,
    N_GUARDS,
    N_STATES,
    N_SWITCHES,
    REST_IS_FINAL,
    SLIP,
    contact,
    field,
    margins,
    power,
    rest,
)
from stickslip.kernels.rodas5p import rodas_dense, rodas_step
from stickslip.kernels.roots import NO_GUARD, SAMPLES, first_violation, guard_values
from stickslip.kernels.state import (
    DENSE_AT,
    EVENT_COLUMNS,
    EVENTS,
    FLAGS,
    MODE,
    PIECE,
    REJECTED,
    RESIDUAL,
    ROW_COLUMNS,
    STALLS,
    STATE_AT,
    STATUS,
    STEP,
    STEPS,
    SUPPLIED,
    TAKEN,
    TIME,
    VIOLATION,
    grown,
)
from stickslip.kernels.tier import Vector, vector

__all__ = ["advance", "initial_mode", "run"]

# Gauss-Legendre nodes and weights on 0 to 1, for the work done in a step
NODES = (0.046910077030668, 0.230765344947158, 0.5, 0.769234655052842, 0.953089922969332)
WEIGHTS = (
    0.118463442528095,
    0.239314335249683,
    0.284444444444444,
    0.239314335249683,
    0.118463442528095,
)
ROUNDING = 4.5e-16
STALL_LIMIT = 100
"""Events in a row at one instant after which the run is given up as Zeno."""


def attempt(
    mode: int,
    flags: int,
    t: float,
    y: Vector,
    h: float,
    p: Vector,
    rtol: float,
    work: tuple[Vector, ...],
) -> float:
    """Try a step with the mode's stepper, fill its dense output if it is good enough."""
    k, y1, slope, scale, matrix, pivots, drift, dense = work
    if HAS_BRISTLES and mode != 0:
        error = rodas_step(
            mode, flags, t, y, h, p, k, y1, slope, scale, rtol, matrix, pivots, drift
        )
        if error <= 1.0:
            rodas_dense(y, y1, k, dense)
        return error
    field(mode, flags, t, y, p, slope)
    for i in range(N_STATES):
        k[i] = slope[i]
    error = dop853_step(mode, flags, t, y, h, p, k, y1, slope, scale, rtol)
    if error <= 1.0:
        dop853_dense(mode, flags, t, y, h, p, k, y1, slope, dense)
    return error


def resized(h: float, error: float, mode: int) -> float:
    """Return the next step length for an error over the tolerance."""
    if error == 0.0:
        return 10.0 * h
    if not error < 1e30:
        return 0.1 * h
    order = 6.0 if HAS_BRISTLES and mode != 0 else 8.0
    return h * min(10.0, max(0.2, 0.9 * error ** (-1.0 / order)))


def accepted_step(
    y: Vector,
    stop: float,
    real: Vector,
    whole: Vector,
    p: Vector,
    rtol: float,
    cap: float,
    work: tuple[Vector, ...],
) -> float:
    """Shorten the step until it is accurate; return its length, 0 if there is none."""
    mode = int(whole[MODE])
    flags = int(whole[FLAGS])
    t = real[TIME]
    h = min(real[STEP], cap)
    while True:
        last = t + 1.01 * h >= stop
        if last:
            h = stop - t
        elif t + 2.0 * h > stop:
            h = 0.5 * (stop - t)
        if not t + h > t:
            whole[STATUS] = STEP_TOO_SMALL
            return 0.0
        error = attempt(mode, flags, t, y, h, p, rtol, work)
        proposed = resized(h, error, mode)
        if error <= 1.0:
            real[STEP] = max(proposed, real[STEP]) if last else proposed
            return h
        whole[REJECTED] += 1
        h = proposed


def set_flags(t: float, y: Vector, p: Vector, flags: int, values: Vector) -> int:
    """Return the flags that the margins of the switches ask for, nested ones included."""
    for _ in range(N_SWITCHES):
        margins(flags, t, y, p, values)
        flags = 0
        for j in range(N_SWITCHES):
            if values[j] > 0.0:
                flags |= 1 << j
    return flags


def mode_from_rest(t: float, flags: int, y: Vector, p: Vector, values: Vector) -> int:
    """Return the mode of a body whose slip velocity is zero."""
    if CAN_STICK:
        contact(0, flags, t, y, p, values)
        if abs(values[2]) <= values[3]:
            return 0
        if not HAS_BRISTLES:
            return 1 if values[2] > 0.0 else -1
    field(1, flags, t, y, p, values)
    return -1 if values[SLIP] < 0.0 else 1


def initial_mode(t: float, y: Vector, p: Vector, whole: Vector) -> None:
    """Set mode and flags for a state."""
    values = vector(N_STATES + N_SWITCHES + 4)
    flags = set_flags(t, y, p, 0, values)
    whole[FLAGS] = flags
    if y[SLIP] > 0.0:
        whole[MODE] = 1
    elif y[SLIP] < 0.0:
        whole[MODE] = -1
    else:
        whole[MODE] = mode_from_rest(t, flags, y, p, values)


def transition(guard: int, t: float, y: Vector, p: Vector, whole: Vector, values: Vector) -> float:
    """Change mode or flags for a violated guard; return the margin of the decision."""
    mode = int(whole[MODE])
    flags = int(whole[FLAGS])
    if guard >= SWITCH:
        whole[FLAGS] = flags ^ (1 << (guard - SWITCH))
        return 0.0
    if guard == LIFT_OFF:
        whole[STATUS] = LIFTED_OFF
        return 0.0
    if guard == STOP and HAS_BRISTLES and not CAN_STICK:
        whole[MODE] = -mode
    elif guard == STOP:
        y[SLIP] = 0.0
        whole[MODE] = mode_from_rest(t, flags, y, p, values)
    elif HAS_BRISTLES:
        field(1, flags, t, y, p, values)
        whole[MODE] = -1 if values[SLIP] < 0.0 else 1
    else:
        whole[MODE] = 1 if guard == BREAK_FORWARD else -1
    whole[FLAGS] = set_flags(t, y, p, flags, values)
    if guard == STOP and CAN_STICK:
        contact(0, int(whole[FLAGS]), t, y, p, values)
        return values[3] - abs(values[2])
    return 0.0


def add_work(
    t: float,
    h: float,
    share: float,
    y: Vector,
    real: Vector,
    whole: Vector,
    p: Vector,
    dense: Vector,
    point: Vector,
    values: Vector,
) -> None:
    """Add the work done in a share of a step."""
    for node in range(5):
        x = share * NODES[node]
        interpolate(y, dense, x, point)
        power(int(whole[MODE]), int(whole[FLAGS]), t + x * h, point, p, values)
        real[SUPPLIED] += share * h * WEIGHTS[node] * values[0]
        real[TAKEN] += share * h * WEIGHTS[node] * values[1]


def record(
    log: Vector, t: float, end: float, h: float, y: Vector, dense: Vector, whole: Vector
) -> None:
    """Write one row of the log."""
    at = int(whole[STEPS]) * ROW_COLUMNS
    log[at] = t
    log[at + 1] = end
    log[at + 2] = h
    log[at + 3] = whole[MODE]
    log[at + 4] = whole[FLAGS]
    log[at + 5] = whole[PIECE]
    for i in range(N_STATES):
        log[at + STATE_AT + i] = y[i]
    for i in range(TERMS * N_STATES):
        log[at + DENSE_AT + i] = dense[i]
    whole[STEPS] += 1


def load_piece(table: Vector, row: int, p: Vector) -> None:
    """Put one row of the drives' table into the parameters."""
    width = 1 + 3 * N_DRIVES
    first = len(p) - 3 * N_DRIVES
    for i in range(3 * N_DRIVES):
        p[first + i] = table[row * width + 1 + i]


def rests_for_good(
    t: float, y: Vector, p: Vector, whole: Vector, bounds: Vector, values: Vector
) -> bool:
    """Whether no drive can move the held body any more."""
    if not REST_IS_FINAL or whole[MODE] != 0:
        return False
    d = vector(N_DRIVES + 1)
    for corner in range(1 << N_DRIVES):
        for k in range(N_DRIVES):
            d[k] = bounds[(int(whole[PIECE]) * N_DRIVES + k) * 2 + ((corner >> k) & 1)]
            if not abs(d[k]) < math.inf:
                return False
        rest(int(whole[FLAGS]), t, y, p, d, values)
        if abs(values[0]) > values[1]:
            return False
    return True


def advance(
    y: Vector,
    stop: float,
    real: Vector,
    whole: Vector,
    p: Vector,
    rtol: float,
    cap: float,
    work: tuple[Vector, ...],
    buffers: tuple[Vector, ...],
) -> int:
    """Take one step up to the first event; return the guard that ended it, or NO_GUARD.

    On return ``buffers[0]`` holds the new state, ``buffers[1]`` the length of the dense output and
    the fraction of it that holds. A body that starts from rest towards a guard that would be
    violated at once gets shorter steps before that is believed.
    """
    scale, dense = work[3], work[7]
    point, found, samples, values = buffers
    t = real[TIME]
    while True:
        h = accepted_step(y, stop, real, whole, p, rtol, cap, work)
        if h == 0.0:
            return NO_GUARD
        guard = first_violation(
            int(whole[MODE]),
            int(whole[FLAGS]),
            t,
            h,
            y,
            dense,
            p,
            scale,
            samples,
            point,
            values,
            found,
        )
        unarmed_start = guard == STOP and found[1] > 0.0 and not HAS_BRISTLES
        if unarmed_start and t + h / 64.0 > t and h > 1e-9 * (stop - t):
            real[STEP] = h / 8.0
            continue
        found[1] = h
        if guard == NO_GUARD:
            found[0] = 1.0
        return guard


def audit(
    guard: int,
    t: float,
    y: Vector,
    real: Vector,
    whole: Vector,
    p: Vector,
    scale: Vector,
    samples: Vector,
    values: Vector,
) -> None:
    """Note how far guards are violated at the end of a step, relative to their size in it."""
    guard_values(int(whole[MODE]), int(whole[FLAGS]), t, y, p, scale, values)
    for i in range(N_GUARDS):
        size = 0.0
        for s in range(SAMPLES + 1):
            size = max(size, abs(samples[s * N_GUARDS + i]))
        if values[i] < 0.0 and size > 0.0:
            at = RESIDUAL if i == guard else VIOLATION
            real[at] = max(real[at], -values[i] / size)


def close_step(
    guard: int,
    stop: float,
    y: Vector,
    real: Vector,
    whole: Vector,
    p: Vector,
    work: tuple[Vector, ...],
    buffers: tuple[Vector, ...],
) -> None:
    """Move time and state to the end of the step."""
    y1, scale, dense = work[1], work[3], work[7]
    point, found, samples, values = buffers
    share, h = found[0], found[1]
    end = real[TIME] + share * h
    if guard == NO_GUARD:
        for i in range(N_STATES):
            point[i] = y1[i]
        if abs(stop - end) <= ROUNDING * max(abs(stop), abs(h)):
            end = stop
    else:
        interpolate(y, dense, share, point)
    for i in range(N_STATES):
        y[i] = point[i]
        scale[i] = max(scale[i], abs(point[i]))
    real[TIME] = end
    if share > 0.0:
        audit(guard, end, y, real, whole, p, scale, samples, values)


def handle_event(
    guard: int,
    start: float,
    y: Vector,
    real: Vector,
    whole: Vector,
    p: Vector,
    values: Vector,
    events: Vector,
) -> None:
    """Make the transition of a guard and write it to the rows of events."""
    t = real[TIME]
    mode = whole[MODE]
    margin = transition(guard, t, y, p, whole, values)
    at = int(whole[EVENTS]) * EVENT_COLUMNS
    events[at] = t
    events[at + 1] = mode
    events[at + 2] = whole[MODE]
    events[at + 3] = guard
    events[at + 4] = whole[FLAGS]
    events[at + 5] = margin
    whole[EVENTS] += 1
    whole[STALLS] = 0 if t - start > ROUNDING * abs(t) else whole[STALLS] + 1
    if whole[STALLS] > STALL_LIMIT:
        whole[STATUS] = ZENO


def next_stop(table: Vector, t_end: float, whole: Vector) -> float:
    """Return the start of the next piece of the drives, or the end."""
    width = 1 + 3 * N_DRIVES
    following = (int(whole[PIECE]) + 1) * width
    return min(table[following], t_end) if following < len(table) else t_end


def enter_pieces(table: Vector, p: Vector, real: Vector, whole: Vector) -> None:
    """Load the piece of the drives that holds now."""
    width = 1 + 3 * N_DRIVES
    while (int(whole[PIECE]) + 1) * width < len(table) and (
        table[(int(whole[PIECE]) + 1) * width] <= real[TIME]
    ):
        whole[PIECE] += 1
    load_piece(table, int(whole[PIECE]), p)


def finish_step(
    guard: int,
    start: float,
    stop: float,
    t_end: float,
    y: Vector,
    real: Vector,
    whole: Vector,
    p: Vector,
    table: Vector,
    work: tuple[Vector, ...],
    buffers: tuple[Vector, ...],
    log: Vector,
    events: Vector,
) -> None:
    """Book the step just taken and pass on to what follows it."""
    dense = work[7]
    point, found, _, values = buffers
    share, h = found[0], found[1]
    if share > 0.0:
        add_work(start, h, share, y, real, whole, p, dense, point, values)
        record(log, start, start + share * h, h, y, dense, whole)
    close_step(guard, stop, y, real, whole, p, work, buffers)
    if share > 0.0:
        log[(int(whole[STEPS]) - 1) * ROW_COLUMNS + 1] = real[TIME]
    if guard != NO_GUARD:
        handle_event(guard, start, y, real, whole, p, values, events)
    elif real[TIME] >= t_end:
        whole[STATUS] = END_TIME
    elif real[TIME] >= stop:
        enter_pieces(table, p, real, whole)


def run(
    p: Vector,
    table: Vector,
    bounds: Vector,
    y: Vector,
    t_end: float,
    rtol: float,
    cap: float,
    limit: int,
    real: Vector,
    whole: Vector,
) -> tuple[Vector, Vector]:
    """Integrate from ``real[TIME]`` to `t_end`; return the rows of steps and of events.

    `table` has a row a piece: start, then value, slope and start of each drive. `bounds` has least
    and largest value of each drive from the start of each piece on.
    """
    n = N_STATES
    room = n + N_GUARDS + 4
    work = (
        vector(DOP853_STAGES * n),
        vector(n),
        vector(room),
        vector(n),
        vector(n * n),
        vector(n),
        vector(n),
        vector(TERMS * n),
    )
    buffers = (vector(n), vector(2), vector((SAMPLES + 1) * N_GUARDS), vector(room))
    log = vector(64 * ROW_COLUMNS)
    events = vector(64 * EVENT_COLUMNS)
    for i in range(n):
        work[3][i] = abs(y[i])
    enter_pieces(table, p, real, whole)
    initial_mode(real[TIME], y, p, whole)
    real[STEP] = 1e-3 * (next_stop(table, t_end, whole) - real[TIME])
    while whole[STATUS] == RUNNING:
        start = real[TIME]
        log = grown(log, (int(whole[STEPS]) + 1) * ROW_COLUMNS)
        events = grown(events, (int(whole[EVENTS]) + 1) * EVENT_COLUMNS)
        if rests_for_good(start, y, p, whole, bounds, buffers[3]):
            for i in range(TERMS * n):
                work[7][i] = 0.0
            record(log, start, t_end, t_end - start, y, work[7], whole)
            whole[STATUS] = AT_REST
            return log, events
        stop = next_stop(table, t_end, whole)
        guard = advance(y, stop, real, whole, p, rtol, cap, work, buffers)
        if whole[STATUS] == RUNNING:
            finish_step(
                guard, start, stop, t_end, y, real, whole, p, table, work, buffers, log, events
            )
        if whole[STEPS] >= limit and whole[STATUS] == RUNNING:
            whole[STATUS] = STEP_LIMIT
    return log, events
