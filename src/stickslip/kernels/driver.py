"""The run: steps, events, pieces of the drives, rest."""

from stickslip.kernels.booking import add_work, close_step, record
from stickslip.kernels.codes import AT_REST, END_TIME, RUNNING, STEP_LIMIT
from stickslip.kernels.dense import TERMS
from stickslip.kernels.dop853 import DOP853_STAGES
from stickslip.kernels.model import HAS_BRISTLES, N_GUARDS, N_STATES, SLIP
from stickslip.kernels.pieces import enter_pieces, next_stop, rests_for_good
from stickslip.kernels.roots import NO_GUARD, SAMPLES
from stickslip.kernels.sizes import first_sizes
from stickslip.kernels.state import (
    EVENT_COLUMNS,
    EVENTS,
    FLAGS,
    MODE,
    ROW_COLUMNS,
    STATUS,
    STEP,
    STEPS,
    TIME,
    grown,
)
from stickslip.kernels.stepping import advance
from stickslip.kernels.switching import handle_event, initial_mode, mode_from_rest
from stickslip.kernels.tier import Vector, vector

__all__ = ["run"]


def workspace() -> tuple[Vector, ...]:
    """Return stages, new state, slope, scale, matrix, pivots, df/dt and dense output."""
    n = N_STATES
    return (
        vector(DOP853_STAGES * n),
        vector(n),
        vector(n + N_GUARDS + 4),
        vector(n),
        vector(n * n),
        vector(n),
        vector(n),
        vector(TERMS * n),
    )


def scratch() -> tuple[Vector, ...]:
    """Return a point, what was found, samples of the guards, values, the guards' largest sizes."""
    return (
        vector(N_STATES),
        vector(2),
        vector((SAMPLES + 1) * N_GUARDS),
        vector(N_STATES + N_GUARDS + 4),
        vector(N_GUARDS),
    )


def keep_start(y: Vector, real: Vector, whole: Vector, log: Vector) -> None:
    """Record the start where not one step could be taken: it is all there is."""
    if whole[STEPS] == 0:
        record(log, real[TIME], real[TIME], 1.0, y, vector(TERMS * N_STATES), whole)


def final_rest(
    y: Vector, t_end: float, real: Vector, whole: Vector, log: Vector, dense: Vector
) -> None:
    """Record a body that stays where it is up to the end."""
    for i in range(TERMS * N_STATES):
        dense[i] = 0.0
    record(log, real[TIME], t_end, t_end - real[TIME], y, dense, whole)
    whole[STATUS] = AT_REST


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
    point, found, _, values, _ = buffers
    share, h = found[0], found[1]
    if share > 0.0:
        add_work(start, h, share, y, real, whole, p, dense, point, values)
        record(log, start, start + share * h, h, y, dense, whole)
    close_step(guard, stop, y, real, whole, p, work, buffers)
    if share > 0.0:
        log[(int(whole[STEPS]) - 1) * ROW_COLUMNS + 1] = real[TIME]
    if guard != NO_GUARD:
        handle_event(guard, start, y, real, whole, p, values, events)
    if whole[STATUS] == RUNNING and real[TIME] >= t_end:
        whole[STATUS] = END_TIME
    elif real[TIME] >= stop:
        enter_pieces(table, p, real, whole)
        if HAS_BRISTLES and whole[MODE] != 0 and y[SLIP] == 0.0:
            whole[MODE] = mode_from_rest(real[TIME], int(whole[FLAGS]), y, p, values)


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
    work = workspace()
    buffers = scratch()
    log = vector(64 * ROW_COLUMNS)
    events = vector(64 * EVENT_COLUMNS)
    enter_pieces(table, p, real, whole)
    initial_mode(real[TIME], y, p, whole)
    first_sizes(real[TIME], t_end, y, p, work[3])
    real[STEP] = 1e-3 * (next_stop(table, t_end, whole) - real[TIME])
    while whole[STATUS] == RUNNING:
        start = real[TIME]
        log = grown(log, (int(whole[STEPS]) + 1) * ROW_COLUMNS)
        events = grown(events, (int(whole[EVENTS]) + 1) * EVENT_COLUMNS)
        if rests_for_good(start, y, p, whole, bounds, buffers[3]):
            final_rest(y, t_end, real, whole, log, work[7])
            break
        stop = next_stop(table, t_end, whole)
        guard = advance(y, stop, real, whole, p, rtol, cap, work, buffers)
        if whole[STATUS] == RUNNING:
            finish_step(
                guard, start, stop, t_end, y, real, whole, p, table, work, buffers, log, events
            )
        if whole[STEPS] >= limit and whole[STATUS] == RUNNING:
            whole[STATUS] = STEP_LIMIT
    keep_start(y, real, whole, log)
    return log, events
