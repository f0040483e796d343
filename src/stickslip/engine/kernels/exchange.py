"""A run whose steps another solver takes: its rates, its guards, and what follows from events.

States are handed over in the coordinates of the mechanism. The modes are those of the run: at an
instant between two steps they change by the same functions as in a run of one's own.
"""

from stickslip.engine.kernels import driver, equations, guard_roots
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector
from stickslip.engine.kernels.mode_transitions import settle
from stickslip.engine.kernels.numerics import interpolate
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


def set_held_rates(at: int, w: Vector, iw: IntVector) -> None:
    """Set the rates of what is held to 0: a solver from outside may have rounded them."""
    n = iw[layout.N_COORDINATES]
    if iw[layout.N_CONTACTS] == 0:
        if abs(iw[layout.MODE]) != 1:
            w[at + iw[layout.SLIP]] = 0.0
        return
    for i in range(n):
        if iw[iw[layout.MODES] + i] == layout.HELD_FAST:
            w[at + n + i] = 0.0
    if iw[layout.N_DIRECTIONS] > n:
        equations.bind(at + n, 1, w, iw)


def take_over(at: int, w: Vector, iw: IntVector) -> None:
    """Turn a state that was handed over to the coordinates of the equations."""
    equations.turn_states(at, 0, w, iw)
    set_held_rates(at, w, iw)


def indicators(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write the event indicators: the guards, above 0 a little longer than these."""
    guard_roots.guard_values(t, 0.0, w, iw, at, to)
    for guard in range(iw[layout.N_GUARDS]):
        size = guard_roots.guard_size(guard, w, iw)
        if guard == layout.STOP and iw[layout.N_CONTACTS] == 0:
            size = max(size, w[iw[layout.SCALE] + iw[layout.SLIP]])
        share = PAST
        if guard_roots.reverses(guard, iw):
            share = QUIET_OUTSIDE
        w[to + guard] += share * size


def fall(guard: int, w: Vector, iw: IntVector, events: Vector) -> None:
    """Make what follows from a guard that has fallen between two steps from outside."""
    iw[layout.STEPPER] = layout.SMOOTH  # no series has told what falls with it
    w[layout.FRACTION] = 1.0  # it held before
    driver.change(guard, w, iw, events)
    if iw[layout.STATUS] == layout.RUNNING and driver.turns_switch(guard, iw):
        settle(w, iw, events)


def falls_at_once(
    t_end: float,
    rtol: float,
    cap: float,
    w: Vector,
    iw: IntVector,
    table: Vector,
    events: Vector,
) -> int:
    """Try a step and do what a guard that falls as it begins asks; tell whether one did."""
    stop = equations.next_stop(table, t_end, iw)
    choose_stepper(stop, w, iw)
    guard = driver.advance(stop, w, iw, rtol, cap)
    if iw[layout.STATUS] == layout.STEP_TOO_SMALL:
        iw[layout.STATUS] = layout.RUNNING  # steps are the concern of the other solver
        return 0
    if (
        iw[layout.STATUS] == layout.RUNNING
        and guard != guard_roots.NO_GUARD
        and w[layout.FRACTION] == 0.0
    ):
        driver.change(guard, w, iw, events)
        if iw[layout.STATUS] == layout.RUNNING and driver.turns_switch(guard, iw):
            settle(w, iw, events)
        return 1
    return 0


def note_state(w: Vector, iw: IntVector) -> None:
    """Note how large states and guards are at the present state."""
    n, guards_of, sampled = iw[layout.N_STATES], iw[layout.N_GUARDS], iw[layout.SAMPLED]
    for i in range(n):
        w[iw[layout.SCALE] + i] = max(w[iw[layout.SCALE] + i], abs(w[iw[layout.Y] + i]))
    if iw[layout.N_CONTACTS] > 0:
        equations.ask_here(equations.MOTION, w, iw)
    guard_roots.guard_values(w[layout.TIME], 0.0, w, iw, iw[layout.Y], sampled)
    # There is no step whose samples could be looked at: the one state stands for all of them.
    for s in range(1, layout.SAMPLES + 1):
        for guard in range(guards_of):
            w[sampled + s * guards_of + guard] = w[sampled + guard]
    guard_roots.note_sizes(w, iw)


def cut(t: float, w: Vector, iw: IntVector, table: Vector, log: Vector) -> None:
    """Take a run of one's own back to a time within its last step."""
    n, point, row = iw[layout.N_STATES], iw[layout.POINT], iw[layout.STEPS] - 1
    at = row * iw[layout.ROW_COLUMNS]
    driver.restore(log, row, table, w, iw)
    interpolate(w, iw, (t - log[at]) / log[at + 2], point)
    # A row at rest lasts for many pieces; the one that holds at the time is looked for from its
    # first.
    iw[layout.PIECE] = driver.piece_at(table, int(log[at + 5]), t, iw)
    equations.load_piece(table, iw[layout.PIECE], w, iw)
    for i in range(n):
        w[iw[layout.Y] + i] = w[point + i]
    w[layout.TIME] = t
    iw[layout.STATUS] = layout.END_TIME


def retune(w: Vector, iw: IntVector) -> None:
    """Write what a run keeps of its parameters for other ones; the state is that handed over."""
    # First what turns states into the coordinates of the equations, then what depends on the state.
    equations.put_constants(w, iw)
    if iw[layout.N_CONTACTS] > 0:
        equations.ask(equations.PREPARE, w[layout.TIME], w, iw)
    take_over(iw[layout.Y], w, iw)
    if iw[layout.N_CONTACTS] > 0:
        equations.ask(equations.PREPARE, w[layout.TIME], w, iw)
        equations.ask_here(equations.RESTORE, w, iw)


def rates_along(point: int, w: Vector, iw: IntVector) -> None:
    """Write how the rates of a state change along a direction, in the modes at hand."""
    n, matrix = iw[layout.N_STATES], iw[layout.MATRIX]
    take_over(iw[layout.DRIFT], w, iw)
    equations.jacobian(w[layout.TIME], w, iw, point, matrix)
    # J d, with d in the coordinates of the equations; the result is turned back.
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += w[matrix + i * n + j] * w[iw[layout.DRIFT] + j]
        w[iw[layout.STAGES] + i] = total
    equations.turn_states(iw[layout.STAGES], 1, w, iw)


def answer_at(question: int, point: int, w: Vector, iw: IntVector) -> None:
    """Write what is asked about a state: rates, their changes, guards, or what is recorded."""
    if question == RATES_AT:
        equations.field(w[layout.TIME], w, iw, point, iw[layout.STAGES])
        equations.turn_states(iw[layout.STAGES], 1, w, iw)
    elif question == ALONG:
        rates_along(point, w, iw)
    elif question == GUARDS_AT:
        indicators(w[layout.TIME], w, iw, point, iw[layout.SAMPLED])
    else:
        equations.recorded(w[layout.TIME], w, iw, point, iw[layout.VALUES])


def exchange(
    question: int,
    guard: int,
    t_end: float,
    rtol: float,
    cap: float,
    w: Vector,
    iw: IntVector,
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
    point, y = iw[layout.POINT], iw[layout.Y]
    if question in (RATES_AT, ALONG, GUARDS_AT, COLUMNS_AT):
        take_over(point, w, iw)
        answer_at(question, point, w, iw)
    elif question == PLACE:
        take_over(y, w, iw)
    elif question == FALLEN:
        fall(guard, w, iw, events)
    elif question == JUMP:
        equations.enter_pieces(table, w, iw)
        driver.settle_all(w, iw, events)
    elif question == LOOK:
        return falls_at_once(t_end, rtol, cap, w, iw, table, events)
    elif question == NOTE:
        note_state(w, iw)
    elif question == CUT:
        cut(t_end, w, iw, table, log)
    elif question == RETUNE:
        retune(w, iw)
    elif question == SHOWN:
        for i in range(iw[layout.N_STATES]):
            w[point + i] = w[y + i]
        equations.turn_states(point, 1, w, iw)
    else:
        driver.begin(table, t_end, w, iw, events)
    return 0
