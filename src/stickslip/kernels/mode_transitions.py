"""Modes and switches: what holds at a state, and what follows an event."""

from stickslip.kernels.backend import Vector
from stickslip.kernels.enums import (
    BREAK_BACKWARD,
    BREAK_FORWARD,
    HELD,
    LIFT_OFF,
    LIFTED_OFF,
    LIMITED,
    RUNNING,
    STOP,
    SWITCH,
    ZENO,
)
from stickslip.kernels.hard_stops import FIRST_LIMIT, FIRST_WALL, pressed_by, strike, touched
from stickslip.kernels.model_interface import (
    CAN_LIFT,
    CAN_STICK,
    HAS_BRISTLES,
    N_LIMITS,
    N_SWITCHES,
    SLIP,
    contact,
    field,
    guards,
    margins,
    time_slope,
)
from stickslip.kernels.state_layout import (
    EVENT_COLUMNS,
    EVENTS,
    FLAGS,
    MODE,
    REACHED,
    ROUNDING,
    STALLS,
    STATUS,
    TIME,
    VALUES,
    Y,
)

__all__ = [
    "handle_event",
    "initial_mode",
    "mode_from_rest",
    "set_flags",
    "settle",
    "turn_switches",
]

UNMOVED = 1e-12
"""Share of a switch's largest margin so far below which it did not jump: rounding left it there."""
STALL_LIMIT = 100
"""Events in a row at one instant after which the run is given up as Zeno."""


def set_flags(t: float, w: Vector, at: int, flags: int) -> int:
    """Return the flags that the margins of the switches ask for, nested ones included.

    Reads: `at`.
    Writes: VALUES.

    Parameters
    ----------
    t : float
        Time [s].
    w : array (SIZE,)
        Vector of the run.
    at : int
        Place in `w` of the state.
    flags : int
        Flags to begin with: nested switches depend on others.

    Returns
    -------
    int
        The flags.
    """
    for _ in range(N_SWITCHES):
        margins(0, flags, t, w, at, VALUES)
        flags = 0
        for j in range(N_SWITCHES):
            if w[VALUES + j] > 0.0:
                flags |= 1 << j
    return flags


def mode_from_rest(flags: int, w: Vector) -> int:
    """Return the mode of a body whose slip velocity is zero.

    Reads: TIME, Y.
    Writes: Y, VALUES, WALLS.

    Parameters
    ----------
    flags : int
        Bit j is set where the condition of switch j holds.
    w : array (SIZE,)
        Vector of the run.

    Returns
    -------
    int
        0 stick, 1 or -1 slip, 2 or -2 pressed against the upper or lower stop.
    """
    side = touched(flags, w)
    if side != 0:
        return 2 * side if pressed_by(side, flags, w) >= 0.0 else -side
    if CAN_STICK:
        contact(0, flags, w[TIME], w, Y, VALUES)
        if abs(w[VALUES + 2]) <= w[VALUES + 3]:
            return 0
        if not HAS_BRISTLES:
            return 1 if w[VALUES + 2] > 0.0 else -1
    return direction(flags, w)


def direction(flags: int, w: Vector) -> int:
    """Return the direction in which a bristle law's body leaves rest.

    Reads: TIME, Y.
    Writes: VALUES.
    """
    field(1, flags, w[TIME], w, Y, VALUES)
    if w[VALUES + SLIP] == 0.0:  # where a load begins to grow, its rate tells
        time_slope(1, flags, w[TIME], w, Y, VALUES)
    return -1 if w[VALUES + SLIP] < 0.0 else 1


def initial_mode(w: Vector, whole: Vector) -> None:
    """Set mode and flags for a state.

    Reads: TIME, Y.
    Writes: Y, VALUES, WALLS, MODE, FLAGS.

    Parameters
    ----------
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.
    """
    set_mode(0, w, whole)


def set_mode(flags: int, w: Vector, whole: Vector) -> None:
    """Set mode and flags for a state, from flags that held before.

    Reads: TIME, Y.
    Writes: Y, VALUES, WALLS, MODE, FLAGS.
    """
    flags = set_flags(w[TIME], w, Y, flags)
    whole[FLAGS] = flags
    if w[Y + SLIP] > 0.0:
        whole[MODE] = 1
    elif w[Y + SLIP] < 0.0:
        whole[MODE] = -1
    else:
        whole[MODE] = mode_from_rest(flags, w)


def transition(guard: int, w: Vector, whole: Vector) -> float:
    """Change mode or flags for a violated guard; return the margin of the decision.

    Reads: TIME, GROSS, LOST, Y, SCALE, MODE, FLAGS, STEPS, BOOKS.
    Writes: GROSS, LOST, Y, VALUES, WALLS, MODE, FLAGS, STATUS.
    """
    t = w[TIME]
    mode = int(whole[MODE])
    flags = int(whole[FLAGS])
    if guard >= FIRST_WALL:
        if strike(guard - FIRST_WALL, w, whole):
            whole[STATUS] = HELD
        set_mode(flags, w, whole)
        return 0.0
    if guard >= FIRST_LIMIT:
        whole[STATUS] = LIMITED + guard - FIRST_LIMIT
        return 0.0
    if guard >= SWITCH:
        whole[FLAGS] = flags ^ (1 << (guard - SWITCH))
        return 0.0
    if guard == LIFT_OFF:
        whole[STATUS] = LIFTED_OFF
        return 0.0
    if guard == STOP and HAS_BRISTLES and not CAN_STICK and touched(flags, w) == 0:
        whole[MODE] = -mode
    elif guard == STOP:
        w[Y + SLIP] = 0.0
        whole[MODE] = mode_from_rest(flags, w)
        if whole[MODE] == mode and not HAS_BRISTLES:  # forces balance but for their rounding
            whole[MODE] = 0
    elif abs(mode) == 2:
        whole[MODE] = -mode // 2
    elif HAS_BRISTLES:
        whole[MODE] = direction(flags, w)
    else:
        whole[MODE] = 1 if guard == BREAK_FORWARD else -1
    whole[FLAGS] = set_flags(t, w, Y, flags)
    if guard == STOP and CAN_STICK and abs(whole[MODE]) != 2:
        contact(0, int(whole[FLAGS]), t, w, Y, VALUES)
        return w[VALUES + 3] - abs(w[VALUES + 2])
    return 0.0


def forbidden(w: Vector, whole: Vector) -> int:
    """Return the guard of a limit that the mode at hand begins beyond, or 0.

    Guards are looked at for a fall from above zero, which would miss one that begins below it.
    Where the equations have no meaning the normal force has none either, so limits come first.

    Reads: TIME, Y, MODE, FLAGS.
    Writes: VALUES.
    """
    if CAN_LIFT or N_LIMITS > 0:
        guards(int(whole[MODE]), int(whole[FLAGS]), w[TIME], w, Y, VALUES)
        for guard in range(FIRST_LIMIT, FIRST_LIMIT + N_LIMITS):
            if w[VALUES + guard] < 0.0:
                return guard
        if w[VALUES + LIFT_OFF] < 0.0:
            return LIFT_OFF
    return 0


def turn_switches(w: Vector, whole: Vector, events: Vector) -> None:
    """Turn the switches whose margins jumped with the drives, nested ones included.

    Reads: TIME, GROSS, LOST, Y, SCALE, REACHED, MODE, FLAGS, STEPS, EVENTS, STALLS, BOOKS.
    Writes: GROSS, LOST, Y, VALUES, WALLS, MODE, FLAGS, STATUS, EVENTS, STALLS.

    Parameters
    ----------
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.
    events : array (rows EVENT_COLUMNS,)
        Rows of events.
    """
    for _ in range(N_SWITCHES):
        for guard in range(SWITCH, FIRST_LIMIT):
            guards(int(whole[MODE]), int(whole[FLAGS]), w[TIME], w, Y, VALUES)
            if w[VALUES + guard] < -UNMOVED * w[REACHED + guard]:
                note_event(guard, w, whole, events)


def settle(w: Vector, whole: Vector, events: Vector) -> None:
    """Make the transitions that follow from a jump of forces, and from the start.

    Reads: TIME, GROSS, LOST, Y, SCALE, MODE, FLAGS, STATUS, STEPS, EVENTS, STALLS, BOOKS.
    Writes: GROSS, LOST, Y, VALUES, WALLS, MODE, FLAGS, STATUS, EVENTS, STALLS.

    Parameters
    ----------
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.
    events : array (rows EVENT_COLUMNS,)
        Rows of events.
    """
    t = w[TIME]
    mode = int(whole[MODE])
    flags = int(whole[FLAGS])
    beyond = forbidden(w, whole)
    if beyond > 0:
        note_event(beyond, w, whole, events)
        return
    if HAS_BRISTLES and abs(mode) == 1 and w[Y + SLIP] == 0.0:
        if mode_from_rest(flags, w) != mode:
            handle_event(STOP, w, whole, events)
        return
    guards(mode, flags, t, w, Y, VALUES)
    if w[VALUES + LIFT_OFF] < 0.0:
        handle_event(LIFT_OFF, w, whole, events)
    elif abs(mode) != 1 and w[VALUES + BREAK_FORWARD] < 0.0:
        handle_event(BREAK_FORWARD, w, whole, events)
    elif abs(mode) != 1 and w[VALUES + BREAK_BACKWARD] < 0.0:
        handle_event(BREAK_BACKWARD, w, whole, events)


def handle_event(guard: int, w: Vector, whole: Vector, events: Vector) -> None:
    """Make the transition of a guard, and of a limit that lies behind it.

    Reads: TIME, GROSS, LOST, Y, SCALE, MODE, FLAGS, STATUS, STEPS, EVENTS, STALLS, BOOKS.
    Writes: GROSS, LOST, Y, VALUES, WALLS, MODE, FLAGS, STATUS, EVENTS, STALLS.

    Parameters
    ----------
    guard : int
        Index of the guard.
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole-numbered state of the run.
    events : array (rows EVENT_COLUMNS,)
        Rows of events.
    """
    note_event(guard, w, whole, events)
    if whole[STATUS] == RUNNING:
        beyond = forbidden(w, whole)
        if beyond > 0:
            note_event(beyond, w, whole, events)


def note_event(guard: int, w: Vector, whole: Vector, events: Vector) -> None:
    """Make the transition of a guard and write it to the rows of events.

    Reads: TIME, GROSS, LOST, Y, SCALE, MODE, FLAGS, STEPS, EVENTS, STALLS, BOOKS.
    Writes: GROSS, LOST, Y, VALUES, WALLS, MODE, FLAGS, STATUS, EVENTS, STALLS.
    """
    t = w[TIME]
    mode = whole[MODE]
    margin = transition(guard, w, whole)
    at = int(whole[EVENTS]) * EVENT_COLUMNS
    events[at] = t
    events[at + 1] = mode
    events[at + 2] = whole[MODE]
    events[at + 3] = guard
    events[at + 4] = whole[FLAGS]
    events[at + 5] = margin
    # an event that a jump of the drives makes is no sign of others without end: time goes on
    stalled = whole[EVENTS] > 0 and t - events[at - EVENT_COLUMNS] <= ROUNDING * abs(t)
    whole[STALLS] = whole[STALLS] + 1 if stalled else 0
    whole[EVENTS] += 1
    if whole[STALLS] > STALL_LIMIT:
        whole[STATUS] = ZENO
