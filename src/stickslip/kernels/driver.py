"""The run: steps, events, pieces of the drives, rest."""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.drive_segments import enter_pieces, next_stop, rests_for_good
from stickslip.kernels.enums import AT_REST, END_TIME, FULL, RUNNING, STEP_LIMIT, SWITCH, ZENO
from stickslip.kernels.equations import put_constants
from stickslip.kernels.error_scale import first_sizes
from stickslip.kernels.guard_roots import NO_GUARD
from stickslip.kernels.mode_transitions import (
    count_event,
    handle_event,
    initial_mode,
    settle,
    turn_switches,
)
from stickslip.kernels.questions import BEGIN, CHANGE, FIRST_SIZES, SETTLE, ask, ask_here, ask_of
from stickslip.kernels.state_layout import (
    ALWAYS_EXACT,
    BOOKS,
    CHANGED,
    CHANGES,
    DENSE,
    DENSE_SIZE,
    EVENT_COLUMNS,
    EVENTS,
    FIRST_LIMIT,
    FRACTION,
    HELD_STRIDE,
    LENGTH,
    LOWEST,
    MOST_EVENTS,
    N_CONTACTS,
    N_GUARDS,
    N_STATES,
    N_SWITCHES,
    N_WALLS,
    RHYTHM,
    ROW_COLUMNS,
    SCALE,
    STALLS,
    STATUS,
    STEP,
    STEPS,
    STRIDE,
    TIME,
    Y,
)
from stickslip.kernels.step import advance
from stickslip.kernels.step_log import add_work, close_step, record
from stickslip.kernels.stepper_selection import choose_stepper

MEMORY = 0.1
"""Weight of the last time between events in their mean."""
FEW_STALLS = 20
"""Events at one instant that several contacts may have, beside those of each contact and switch."""


def stay(end: float, w: Vector, whole: Wholes, log: Vector) -> None:
    """Record a body that stays where it is up to a time."""
    dense_size = whole[DENSE_SIZE]
    dense = whole[DENSE]
    n = whole[N_STATES]
    y = whole[Y]
    for i in range(dense_size):
        w[dense + i] = 0.0
    for i in range(n):
        w[dense + 1 + i] = w[y + i]
    if whole[ALWAYS_EXACT]:
        w[dense] = 1.0  # a series, of which the first state is kept
    w[LENGTH] = end - w[TIME] if end > w[TIME] else 1.0
    record(log, end, w, whole)


def turns_switch(guard: int, whole: Wholes) -> bool:
    """Whether a guard is that of a switch of the equations of one contact."""
    return whole[N_CONTACTS] == 0 and SWITCH <= guard < whole[FIRST_LIMIT]


def finish_step(
    guard: int,
    stop: float,
    t_end: float,
    w: Vector,
    whole: Wholes,
    table: Vector,
    log: Vector,
    events: Vector,
) -> None:
    """Book the step just taken and pass on to what follows it."""
    start = w[TIME]
    if w[FRACTION] > 0.0:
        if whole[BOOKS]:
            add_work(w, whole)
        record(log, start, w, whole)
    close_step(guard, stop, w, whole)
    if w[FRACTION] > 0.0:
        log[(whole[STEPS] - 1) * whole[ROW_COLUMNS] + 1] = w[TIME]
        if whole[N_CONTACTS] > 0:
            note_rhythm(guard, w[TIME] - start, w)
    if guard != NO_GUARD:
        change(guard, w, whole, events)
    if whole[STATUS] == RUNNING and w[TIME] >= t_end:
        whole[STATUS] = END_TIME
    elif whole[STATUS] == RUNNING and w[TIME] >= stop:
        enter_pieces(table, w, whole)
        settle_all(w, whole, events)
    elif whole[STATUS] == RUNNING and turns_switch(guard, whole):
        settle(w, whole, events)  # what a switch stands for may jump with it
    if guard != NO_GUARD or w[TIME] >= stop:
        if not has_sizes(w, whole):
            give_sizes(t_end, w, whole)
        choose_stepper(next_stop(table, t_end, whole), w, whole)


def note_rhythm(guard: int, taken: float, w: Vector) -> None:
    """Follow the mean length of steps that end with an event; one without an event raises it."""
    if guard == NO_GUARD or w[RHYTHM] == math.inf:
        w[RHYTHM] = max(taken, w[RHYTHM]) if guard == NO_GUARD else taken
    else:
        w[RHYTHM] += MEMORY * (taken - w[RHYTHM])


def most_stalls(whole: Wholes) -> int:
    """Return how many events in a row several contacts may have at one instant."""
    return FEW_STALLS + 4 * whole[N_CONTACTS] + 2 * whole[N_SWITCHES] + whole[N_WALLS]


def take_changes(w: Vector, whole: Wholes, events: Vector) -> None:
    """Take the new events of several contacts over into the rows of events."""
    t = w[TIME]
    most = most_stalls(whole)
    for k in range(whole[CHANGED]):
        at = whole[EVENTS] * EVENT_COLUMNS
        for i in range(EVENT_COLUMNS):
            events[at + i] = w[whole[CHANGES] + k * EVENT_COLUMNS + i]
        count_event(t, whole, events, most)


def change(guard: int, w: Vector, whole: Wholes, events: Vector) -> None:
    """Make what follows from a guard that has fallen."""
    if whole[N_CONTACTS] > 0:
        ask_of(CHANGE, w[TIME], w, whole, guard, 0)
        take_changes(w, whole, events)
        if whole[CHANGED] == 0:  # what falls at once, again and again, may change nothing
            whole[STALLS] = whole[STALLS] + 1 if w[FRACTION] == 0.0 else 0
            if whole[STALLS] > most_stalls(whole):
                whole[STATUS] = ZENO
    else:
        handle_event(guard, w, whole, events)


def settle_all(w: Vector, whole: Wholes, events: Vector) -> None:
    """Make what follows from a jump of forces."""
    if whole[N_CONTACTS] > 0:
        ask_here(SETTLE, w, whole)
        take_changes(w, whole, events)
    else:
        turn_switches(w, whole, events)
        settle(w, whole, events)


def give_sizes(t_end: float, w: Vector, whole: Wholes) -> None:
    """Set the sizes that errors are compared with, by the state and the forces at hand."""
    if whole[N_CONTACTS] > 0:
        ask(FIRST_SIZES, t_end, w, whole)
    else:
        first_sizes(w[TIME], t_end, w, whole)


def has_sizes(w: Vector, whole: Wholes) -> bool:
    """Whether anything has moved yet, or forces were at hand that gave what rests a size."""
    found = False
    for i in range(whole[N_STATES]):
        found = found or w[whole[SCALE] + i] != 0.0
    return found


def begin(table: Vector, t_end: float, w: Vector, whole: Wholes, events: Vector) -> None:
    """Set what follows from the start: piece, mode, sizes, stepper."""
    n_guards = whole[N_GUARDS]
    lowest = whole[LOWEST]
    put_constants(w, whole)
    enter_pieces(table, w, whole)
    if whole[N_CONTACTS] > 0:
        ask_here(BEGIN, w, whole)
        take_changes(w, whole, events)
        w[RHYTHM] = math.inf
    else:
        initial_mode(w, whole)
        settle(w, whole, events)
    give_sizes(t_end, w, whole)
    for i in range(n_guards):
        w[lowest + i] = math.inf
    w[STEP] = 0.0
    w[STRIDE] = math.inf
    w[HELD_STRIDE] = math.inf
    choose_stepper(next_stop(table, t_end, whole), w, whole)


def go_on(table: Vector, t_end: float, w: Vector, whole: Wholes, events: Vector) -> None:
    """Take a run up that reached its end time, as if it had only met a new piece of the drives."""
    whole[STATUS] = RUNNING
    enter_pieces(table, w, whole)
    settle_all(w, whole, events)
    choose_stepper(next_stop(table, t_end, whole), w, whole)


def log_is_full(whole: Wholes, log: Vector) -> bool:
    """Whether there is no room for the rows of a step and of its end."""
    return (whole[STEPS] + 2) * whole[ROW_COLUMNS] > len(log)


def events_are_full(whole: Wholes, events: Vector) -> bool:
    """Whether there is no room for a step, a jump and what it switches, and a limit after each."""
    return (whole[EVENTS] + whole[MOST_EVENTS]) * EVENT_COLUMNS > len(events)


def run(
    w: Vector,
    whole: Wholes,
    table: Vector,
    bounds: Vector,
    t_end: float,
    rtol: float,
    cap: float,
    limit: int,
    log: Vector,
    events: Vector,
) -> None:
    """Integrate from the time and the state in `w` to `t_end`.

    `table` has a row a piece: start, then value, slope and start of each drive; `bounds` has least
    and largest value of each drive from the start of each piece on. A run that has reached an end
    time goes on from there: pieces may be told as late as they begin. One that has reached its step
    limit goes on as if there had been none. One that finds no room for further rows has the status
    FULL, and goes on with longer vectors that begin with the same rows.
    """
    if whole[STATUS] == END_TIME:
        go_on(table, t_end, w, whole, events)
    elif whole[STATUS] in (STEP_LIMIT, FULL):
        whole[STATUS] = RUNNING
    else:
        begin(table, t_end, w, whole, events)
    while whole[STATUS] == RUNNING:
        if log_is_full(whole, log) or events_are_full(whole, events):
            whole[STATUS] = FULL
            return
        if rests_for_good(w, whole, bounds):
            stay(t_end, w, whole, log)
            whole[STATUS] = AT_REST
            break
        stop = next_stop(table, t_end, whole)
        guard = advance(stop, w, whole, rtol, cap)
        if whole[STATUS] == RUNNING:
            finish_step(guard, stop, t_end, w, whole, table, log, events)
        if whole[STEPS] >= limit and whole[STATUS] == RUNNING:
            whole[STATUS] = STEP_LIMIT
    if whole[STEPS] == 0:  # where not one step could be taken, the start is all there is
        stay(w[TIME], w, whole, log)
