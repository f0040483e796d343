"""Modes and switches: what holds at a state, and what follows an event."""

from stickslip.kernels.codes import BREAK_FORWARD, LIFT_OFF, LIFTED_OFF, STOP, SWITCH, ZENO
from stickslip.kernels.model import (
    CAN_STICK,
    HAS_BRISTLES,
    N_STATES,
    N_SWITCHES,
    SLIP,
    contact,
    field,
    margins,
    time_slope,
)
from stickslip.kernels.state import (
    EVENT_COLUMNS,
    EVENTS,
    FLAGS,
    MODE,
    ROUNDING,
    STALLS,
    STATUS,
    TIME,
)
from stickslip.kernels.tier import Vector, vector

__all__ = ["handle_event", "initial_mode", "mode_from_rest", "set_flags"]

STALL_LIMIT = 100
"""Events in a row at one instant after which the run is given up as Zeno."""


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
    if values[SLIP] == 0.0:  # where a load begins to grow, its rate tells
        time_slope(1, flags, t, y, p, values)
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
