"""Modes and switches: what holds at a state, and what follows an event."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.enums import (
    BREAK_BACKWARD,
    BREAK_FORWARD,
    LIFT_OFF,
    LIFTED_OFF,
    LIMITED,
    RUNNING,
    STOP,
    SWITCH,
    ZENO,
)
from stickslip.kernels.equations import ANY_RATE, CONTACT, FIELD, MARGINS, TIME_SLOPE, evaluate
from stickslip.kernels.hard_stops import pressed_by, strike, touched
from stickslip.kernels.model_interface import guards
from stickslip.kernels.state_layout import (
    CAN_LIFT,
    CAN_STICK,
    EVENT_COLUMNS,
    EVENTS,
    FIRST_LIMIT,
    FIRST_WALL,
    FLAGS,
    HAS_BRISTLES,
    MODE,
    N_LIMITS,
    N_SWITCHES,
    REACHED,
    ROUNDING,
    SLIP,
    STALLS,
    STATUS,
    STEPS,
    TIME,
    VALUES,
    Y,
)

UNMOVED = 1e-12
"""Share of a switch's largest margin so far below which it did not jump: rounding left it there."""
STALL_LIMIT = 100
"""Events in a row at one instant after which the run is given up as Zeno."""


def set_flags(t: float, w: Vector, whole: Wholes, at: int, flags: int, standing: int) -> int:
    """Return the flags that the margins of the switches ask for, nested ones included.

    A switch that stands at its threshold is off, unless it was left on there: the next step shows
    to which side it goes.
    """
    switches = whole[N_SWITCHES]
    values = whole[VALUES]
    for _ in range(switches):
        evaluate(MARGINS, 0, flags, t, w, at, values)
        flags = 0
        for j in range(switches):
            margin = w[values + j]
            if margin > 0.0 or (margin == 0.0 and standing & (1 << j)):
                flags |= 1 << j
    return flags


def standing_flags(w: Vector, whole: Wholes) -> int:
    """Return the flags of switches that are on at their thresholds, whatever the slip velocity is.

    That of a velocity which is 0 now is off: what it asks for has ended.
    """
    values, rate = whole[VALUES], whole[Y] + whole[SLIP]
    found, now = whole[FLAGS], w[rate]
    if whole[N_SWITCHES] == 0:
        return found
    for trial in range(2):
        w[rate] = now + ANY_RATE if trial == 0 else now
        evaluate(MARGINS, 0, whole[FLAGS], w[TIME], w, whole[Y], values)
        for j in range(whole[N_SWITCHES]):
            if w[values + j] != 0.0:
                found &= ~(1 << j)
    return found


def mode_from_rest(flags: int, w: Vector, whole: Wholes) -> int:
    """Return the mode of a body whose slip velocity is zero."""
    values = whole[VALUES]
    side = touched(flags, w, whole)
    if side != 0:
        return 2 * side if pressed_by(side, flags, w, whole) >= 0.0 else -side
    if whole[CAN_STICK]:
        evaluate(CONTACT, 0, flags, w[TIME], w, whole[Y], values)
        if abs(w[values + 2]) <= w[values + 3]:
            return 0
        if not whole[HAS_BRISTLES]:
            return 1 if w[values + 2] > 0.0 else -1
    return direction(flags, w, whole)


def direction(flags: int, w: Vector, whole: Wholes) -> int:
    """Return the direction in which a bristle law's body leaves rest."""
    y = whole[Y]
    values = whole[VALUES]
    slip = whole[SLIP]
    evaluate(FIELD, 1, flags, w[TIME], w, y, values)
    if w[values + slip] == 0.0:  # where a load begins to grow, its rate tells
        evaluate(TIME_SLOPE, 1, flags, w[TIME], w, y, values)
    return -1 if w[values + slip] < 0.0 else 1


def initial_mode(w: Vector, whole: Wholes) -> None:
    """Set mode and flags for a state."""
    whole[FLAGS] = 0
    set_mode(w, whole)


def set_mode(w: Vector, whole: Wholes) -> None:
    """Set mode and flags for a state, from flags that held before."""
    y = whole[Y]
    slip = whole[SLIP]
    flags = set_flags(w[TIME], w, whole, y, whole[FLAGS], 0)
    whole[FLAGS] = flags
    if w[y + slip] > 0.0:
        whole[MODE] = 1
    elif w[y + slip] < 0.0:
        whole[MODE] = -1
    else:
        whole[MODE] = mode_from_rest(flags, w, whole)


def turn_switch(switch: int, w: Vector, whole: Wholes) -> None:
    """Turn a switch; if it does as the run begins, decide a body at rest as if it had begun so.

    Forces that just reach the level say nothing, and would hold what has broken away there.
    """
    whole[FLAGS] ^= 1 << switch
    if w[TIME] == 0.0 and whole[STEPS] == 0 and w[whole[Y] + whole[SLIP]] == 0.0:
        mode, values = mode_from_rest(whole[FLAGS], w, whole), whole[VALUES]
        if mode != 0 or abs(w[values + 2]) < w[values + 3]:
            whole[MODE] = mode


def transition(guard: int, w: Vector, whole: Wholes) -> float:
    """Change mode or flags for a violated guard; return the margin of the decision."""
    first_wall = whole[FIRST_WALL]
    first_limit = whole[FIRST_LIMIT]
    y = whole[Y]
    values = whole[VALUES]
    t = w[TIME]
    mode = whole[MODE]
    flags = whole[FLAGS]
    if guard >= first_wall:
        strike(guard - first_wall, w, whole)
        set_mode(w, whole)
        return 0.0
    if guard >= first_limit:
        whole[STATUS] = LIMITED + guard - first_limit
        return 0.0
    if guard >= SWITCH:
        turn_switch(guard - SWITCH, w, whole)
        return 0.0
    if guard == LIFT_OFF:
        whole[STATUS] = LIFTED_OFF
        return 0.0
    if (
        guard == STOP
        and whole[HAS_BRISTLES]
        and not whole[CAN_STICK]
        and touched(flags, w, whole) == 0
    ):
        whole[MODE] = -mode
    elif guard == STOP:
        w[y + whole[SLIP]] = 0.0
        whole[MODE] = mode_from_rest(flags, w, whole)
        if whole[MODE] == mode and not whole[HAS_BRISTLES]:  # forces balance but for their rounding
            whole[MODE] = 0
    elif abs(mode) == 2:
        whole[MODE] = -mode // 2
    elif whole[HAS_BRISTLES]:
        whole[MODE] = direction(flags, w, whole)
    else:
        whole[MODE] = 1 if guard == BREAK_FORWARD else -1
    whole[FLAGS] = set_flags(t, w, whole, y, flags, standing_flags(w, whole))
    if guard == STOP and whole[CAN_STICK] and abs(whole[MODE]) != 2:
        evaluate(CONTACT, 0, whole[FLAGS], t, w, y, values)
        return w[values + 3] - abs(w[values + 2])
    return 0.0


def forbidden(w: Vector, whole: Wholes) -> int:
    """Return the guard of a limit that the mode at hand begins beyond, or 0.

    Guards are looked at for a fall from above zero, which would miss one that begins below it.
    Where the equations have no meaning the normal force has none either, so limits come first.
    """
    limits = whole[N_LIMITS]
    values = whole[VALUES]
    first_limit = whole[FIRST_LIMIT]
    if whole[CAN_LIFT] or limits > 0:
        guards(w[TIME], w, whole, whole[Y], values)
        for guard in range(first_limit, first_limit + limits):
            if w[values + guard] < 0.0:
                return guard
        if w[values + LIFT_OFF] < 0.0:
            return LIFT_OFF
    return 0


def turn_switches(w: Vector, whole: Wholes, events: Vector) -> None:
    """Turn the switches whose margins jumped with the drives, nested ones included."""
    switches = whole[N_SWITCHES]
    first_limit = whole[FIRST_LIMIT]
    y = whole[Y]
    values = whole[VALUES]
    reached = whole[REACHED]
    for _ in range(switches):
        for guard in range(SWITCH, first_limit):
            guards(w[TIME], w, whole, y, values)
            if w[values + guard] < -UNMOVED * w[reached + guard]:
                note_event(guard, w, whole, events)


def settle(w: Vector, whole: Wholes, events: Vector) -> None:
    """Make the transitions that follow from a jump of forces, and from the start."""
    y = whole[Y]
    values = whole[VALUES]
    t = w[TIME]
    mode = whole[MODE]
    flags = whole[FLAGS]
    beyond = forbidden(w, whole)
    if beyond > 0:
        note_event(beyond, w, whole, events)
        return
    guard = -1  # a variable, so that machine code is made once for all of them
    if whole[HAS_BRISTLES] and abs(mode) == 1 and w[y + whole[SLIP]] == 0.0:
        if mode_from_rest(flags, w, whole) != mode:
            guard = STOP
    elif whole[CAN_LIFT] or abs(mode) != 1:
        guards(t, w, whole, y, values)
        if w[values + LIFT_OFF] < 0.0:
            guard = LIFT_OFF
        elif abs(mode) != 1 and w[values + BREAK_FORWARD] < 0.0:
            guard = BREAK_FORWARD
        elif abs(mode) != 1 and w[values + BREAK_BACKWARD] < 0.0:
            guard = BREAK_BACKWARD
    if guard >= 0:
        handle_event(guard, w, whole, events)


def handle_event(guard: int, w: Vector, whole: Wholes, events: Vector) -> None:
    """Make the transition of a guard, and of a limit that lies behind it."""
    note_event(guard, w, whole, events)
    if whole[STATUS] == RUNNING:
        beyond = forbidden(w, whole)
        if beyond > 0:
            note_event(beyond, w, whole, events)


def note_event(guard: int, w: Vector, whole: Wholes, events: Vector) -> None:
    """Make the transition of a guard and write it to the rows of events."""
    t = w[TIME]
    mode = whole[MODE]
    margin = transition(guard, w, whole)
    at = whole[EVENTS] * EVENT_COLUMNS
    events[at] = t
    events[at + 1] = mode
    events[at + 2] = whole[MODE]
    events[at + 3] = guard
    events[at + 4] = whole[FLAGS]
    events[at + 5] = margin
    events[at + 6] = 0.0
    count_event(t, whole, events, STALL_LIMIT)


def count_event(t: float, whole: Wholes, events: Vector, most: int) -> None:
    """Count an event that has been written; too many at one instant end the run."""
    # an event that a jump of the drives makes is no sign of others without end: time goes on
    at = whole[EVENTS] * EVENT_COLUMNS
    stalled = whole[EVENTS] > 0 and t - events[at - EVENT_COLUMNS] <= ROUNDING * abs(t)
    whole[STALLS] = whole[STALLS] + 1 if stalled else 0
    whole[EVENTS] += 1
    if whole[STALLS] > most and whole[STATUS] == RUNNING:
        whole[STATUS] = ZENO
