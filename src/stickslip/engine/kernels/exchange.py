"""A run whose steps another solver takes: its rates, its guards, and what follows from events.

States are handed over in the coordinates of the mechanism. The modes are those of the run: at an
instant between two steps they change by the same functions as in a run of one's own.
"""

from stickslip.engine.kernels.backend import Vector, Wholes
from stickslip.engine.kernels.driver import (
    advance,
    begin,
    change,
    piece_at,
    restore,
    settle_all,
    turns_switch,
)
from stickslip.engine.kernels.equations import (
    MOTION,
    PREPARE,
    RESTORE,
    ask,
    ask_here,
    bind,
    enter_pieces,
    field,
    jacobian,
    load_piece,
    next_stop,
    put_constants,
    recorded,
    turn_states,
)
from stickslip.engine.kernels.guard_roots import (
    NO_GUARD,
    guard_size,
    guard_values,
    note_sizes,
    reverses,
)
from stickslip.engine.kernels.mode_transitions import settle
from stickslip.engine.kernels.numerics import interpolate
from stickslip.engine.kernels.state_layout import (
    DRIFT,
    END_TIME,
    FRACTION,
    HELD_FAST,
    MATRIX,
    MODE,
    MODES,
    N_CONTACTS,
    N_COORDINATES,
    N_DIRECTIONS,
    N_GUARDS,
    N_STATES,
    PIECE,
    POINT,
    ROW_COLUMNS,
    RUNNING,
    SAMPLED,
    SAMPLES,
    SCALE,
    SLIP,
    SMOOTH,
    STAGES,
    STATUS,
    STEP_TOO_SMALL,
    STEPPER,
    STEPS,
    STOP,
    TIME,
    VALUES,
    Y,
)
from stickslip.engine.kernels.steppers import choose_stepper

ENTER = 0
RATES_AT = 1
GUARDS_AT = 2
COLUMNS_AT = 3
FALLEN = 4
JUMP = 5
LOOK = 6
NOTE = 7
CUT = 8
RETUNE = 9
SHOWN = 10
PLACE = 11
ALONG = 12
PAST = 1e-12
"""Share of its largest value by which a guard is below 0 where its event indicator is 0.

A solver from outside may stop on either side of a root, or on it, and modes that change there need
a guard that has fallen.
"""
QUIET_OUTSIDE = 1e-8
"""Share of the largest speed so far below which a reversal of a bristle law is left unnoticed.

A solver from outside leaves errors of its own tolerance in a speed that dies away. The rates of
both directions agree there but for the square of this share.
"""


def set_held_rates(at: int, w: Vector, whole: Wholes) -> None:
    """Set the rates of what is held to 0: a solver from outside may have rounded them."""
    n = whole[N_COORDINATES]
    if whole[N_CONTACTS] == 0:
        if abs(whole[MODE]) != 1:
            w[at + whole[SLIP]] = 0.0
        return
    for i in range(n):
        if whole[whole[MODES] + i] == HELD_FAST:
            w[at + n + i] = 0.0
    if whole[N_DIRECTIONS] > n:
        bind(at + n, 1, w, whole)


def take_over(at: int, w: Vector, whole: Wholes) -> None:
    """Turn a state that was handed over to the coordinates of the equations."""
    turn_states(at, 0, w, whole)
    set_held_rates(at, w, whole)


def indicators(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write the event indicators: the guards, above 0 a little longer than these."""
    guard_values(t, w, whole, at, to)
    for guard in range(whole[N_GUARDS]):
        size = guard_size(guard, w, whole)
        if guard == STOP and whole[N_CONTACTS] == 0:
            size = max(size, w[whole[SCALE] + whole[SLIP]])
        share = PAST
        if reverses(guard, whole):
            share = QUIET_OUTSIDE
        w[to + guard] += share * size


def fall(guard: int, w: Vector, whole: Wholes, events: Vector) -> None:
    """Make what follows from a guard that has fallen between two steps from outside."""
    whole[STEPPER] = SMOOTH  # no series has told what falls with it
    w[FRACTION] = 1.0  # it held before
    change(guard, w, whole, events)
    if whole[STATUS] == RUNNING and turns_switch(guard, whole):
        settle(w, whole, events)


def falls_at_once(
    t_end: float,
    rtol: float,
    cap: float,
    w: Vector,
    whole: Wholes,
    table: Vector,
    events: Vector,
) -> int:
    """Try a step and do what a guard that falls as it begins asks; tell whether one did."""
    stop = next_stop(table, t_end, whole)
    choose_stepper(stop, w, whole)
    guard = advance(stop, w, whole, rtol, cap)
    if whole[STATUS] == STEP_TOO_SMALL:
        whole[STATUS] = RUNNING  # steps are the concern of the other solver
        return 0
    if whole[STATUS] == RUNNING and guard != NO_GUARD and w[FRACTION] == 0.0:
        change(guard, w, whole, events)
        if whole[STATUS] == RUNNING and turns_switch(guard, whole):
            settle(w, whole, events)
        return 1
    return 0


def note_state(w: Vector, whole: Wholes) -> None:
    """Note how large states and guards are at the present state."""
    n, guards_of, sampled = whole[N_STATES], whole[N_GUARDS], whole[SAMPLED]
    for i in range(n):
        w[whole[SCALE] + i] = max(w[whole[SCALE] + i], abs(w[whole[Y] + i]))
    if whole[N_CONTACTS] > 0:
        ask_here(MOTION, w, whole)
    guard_values(w[TIME], w, whole, whole[Y], sampled)
    # There is no step whose samples could be looked at: the one state stands for all of them.
    for s in range(1, SAMPLES + 1):
        for guard in range(guards_of):
            w[sampled + s * guards_of + guard] = w[sampled + guard]
    note_sizes(w, whole)


def cut(t: float, w: Vector, whole: Wholes, table: Vector, log: Vector) -> None:
    """Take a run of one's own back to a time within its last step."""
    n, point, row = whole[N_STATES], whole[POINT], whole[STEPS] - 1
    at = row * whole[ROW_COLUMNS]
    restore(log, row, table, w, whole)
    interpolate(w, whole, (t - log[at]) / log[at + 2], point)
    # A row at rest lasts for many pieces; the one that holds at the time is looked for from its
    # first.
    whole[PIECE] = piece_at(table, int(log[at + 5]), t, whole)
    load_piece(table, whole[PIECE], w, whole)
    for i in range(n):
        w[whole[Y] + i] = w[point + i]
    w[TIME] = t
    whole[STATUS] = END_TIME


def retune(w: Vector, whole: Wholes) -> None:
    """Write what a run keeps of its parameters for other ones; the state is that handed over."""
    # First what turns states into the coordinates of the equations, then what depends on the state.
    put_constants(w, whole)
    if whole[N_CONTACTS] > 0:
        ask(PREPARE, w[TIME], w, whole)
    take_over(whole[Y], w, whole)
    if whole[N_CONTACTS] > 0:
        ask(PREPARE, w[TIME], w, whole)
        ask_here(RESTORE, w, whole)


def rates_along(point: int, w: Vector, whole: Wholes) -> None:
    """Write how the rates of a state change along a direction, in the modes at hand."""
    n, matrix = whole[N_STATES], whole[MATRIX]
    take_over(whole[DRIFT], w, whole)
    jacobian(w[TIME], w, whole, point, matrix)
    # J d, with d in the coordinates of the equations; the result is turned back.
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += w[matrix + i * n + j] * w[whole[DRIFT] + j]
        w[whole[STAGES] + i] = total
    turn_states(whole[STAGES], 1, w, whole)


def answer_at(question: int, point: int, w: Vector, whole: Wholes) -> None:
    """Write what is asked about a state: rates, their changes, guards, or what is recorded."""
    if question == RATES_AT:
        field(w[TIME], w, whole, point, whole[STAGES])
        turn_states(whole[STAGES], 1, w, whole)
    elif question == ALONG:
        rates_along(point, w, whole)
    elif question == GUARDS_AT:
        indicators(w[TIME], w, whole, point, whole[SAMPLED])
    else:
        recorded(w[TIME], w, whole, point, whole[VALUES])


def exchange(
    question: int,
    guard: int,
    t_end: float,
    rtol: float,
    cap: float,
    w: Vector,
    whole: Wholes,
    table: Vector,
    log: Vector,
    events: Vector,
) -> int:
    """Answer one question at the time in `w`; return 1 where something has happened, else 0.

    States that are asked about stand at POINT, the one at which anything may happen at Y. Both are
    handed over in the coordinates of the mechanism, the latter by `ENTER`, `PLACE` or `RETUNE`.

    ========== ================================================================================
    ENTER      begin with the state at Y
    RATES_AT   write the rates of the state at POINT to STAGES
    GUARDS_AT  write the guards at POINT to SAMPLED
    COLUMNS_AT write what is recorded at POINT to VALUES
    ALONG      write how these rates change along the direction at DRIFT to STAGES
    PLACE      take over the state at Y
    FALLEN     make what follows from a guard that has fallen
    JUMP       make what follows from a new piece of the drives, or other inputs or parameters
    LOOK       make what follows from a guard that falls at once
    NOTE       note the sizes of states and guards
    CUT        take a run of one's own back to `t_end`, which lies in its last step
    RETUNE     go on from Y with other parameters
    SHOWN      write the state at Y to POINT in the coordinates of the mechanism
    ========== ================================================================================
    """
    point, y = whole[POINT], whole[Y]
    if question in (RATES_AT, ALONG, GUARDS_AT, COLUMNS_AT):
        take_over(point, w, whole)
        answer_at(question, point, w, whole)
    elif question == PLACE:
        take_over(y, w, whole)
    elif question == FALLEN:
        fall(guard, w, whole, events)
    elif question == JUMP:
        enter_pieces(table, w, whole)
        settle_all(w, whole, events)
    elif question == LOOK:
        return falls_at_once(t_end, rtol, cap, w, whole, table, events)
    elif question == NOTE:
        note_state(w, whole)
    elif question == CUT:
        cut(t_end, w, whole, table, log)
    elif question == RETUNE:
        retune(w, whole)
    elif question == SHOWN:
        for i in range(whole[N_STATES]):
            w[point + i] = w[y + i]
        turn_states(point, 1, w, whole)
    else:
        begin(table, t_end, w, whole, events)
    return 0
