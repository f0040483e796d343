"""Modes, switches and hard stops: what holds at a state, and what follows an event.

With one contact the mode is 0 at rest, 1 and -1 slipping forward and backward, 2 and -2 pressed to
a hard stop. A guard that falls

1. at a stop of the motion: rest, if the needed friction is within the static level; else slip on in
   the sense of the force, and a law of bristles alone slips back;
2. at break-away: slip in the sense of the level that was reached; off a hard stop: away from it;
3. at a switch: its flag turns; at a hard stop: an impact with the restitution there;
4. at a limit, or where the load vanishes: the run ends.

Flags and modes then follow from each other until nothing changes; 100 events in a row at one
instant end the run as Zeno.
"""

import math

from stickslip.engine.kernels import equations
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector

# Hard stops: which one a body touches, whether it is pressed there, and what an impact does.

RESTING = 1e-9
"""Share of the largest speed so far below which a body that is pressed bounces no more."""
INSTANT = 1e-13
"""Share of the time that has passed below which a bounce is too short to be stepped through."""
BLUR = 1.8e-15
"""Rounding of a place, eight units in its last digit, over the place."""
ELASTIC = 1e-3
"""Least share of the energy that an impact is taken to cost in what rounding can sustain."""


def wall_coordinate(wall: int, iw: IntVector) -> int:
    """Return the index of the coordinate that a stop bounds."""
    return iw[layout.HEADER + 2 * wall]


def wall_side(wall: int, iw: IntVector) -> int:
    """Return 1 for a stop above, -1 for one below."""
    return iw[layout.HEADER + 2 * wall + 1]


def touched(flags: int, w: Vector, iw: IntVector) -> int:
    """Return the side of the stop that the slipping body touches: 1 upper, -1 lower, 0 none.

    A body that has come to rest beyond its stop, by rounding, is put onto it.
    """
    y, walls_at, columns = iw[layout.Y], iw[layout.WALLS], iw[layout.WALL_COLUMNS]
    if iw[layout.N_WALLS] == 0:
        return 0
    equations.evaluate(equations.WALLS_OF, 0, flags, w[layout.TIME], w, y, walls_at)
    # SLIP is the index of the rate; its place stands N_COORDINATES before it.
    place = y + iw[layout.SLIP] - iw[layout.N_COORDINATES]
    for wall in range(iw[layout.N_WALLS]):
        position = w[walls_at + wall * columns]
        side = wall_side(wall, iw)
        if side * (w[place] - position) >= 0.0:
            w[place] = position
            return side
    return 0


def pressed_by(side: int, flags: int, w: Vector, iw: IntVector) -> float:
    """Return the force that is missing for the slipping body to leave its stop."""
    values = iw[layout.VALUES]
    # In mode 2 * side the body is held at its stop, and the guard of the way back tells how firmly.
    equations.evaluate(equations.GUARDS, 2 * side, flags, w[layout.TIME], w, iw[layout.Y], values)
    return w[values + (layout.BREAK_BACKWARD if side > 0 else layout.BREAK_FORWARD)]


def approach(guard: int, w: Vector, iw: IntVector) -> float:
    """Return the speed with which a coordinate nears the stop that a guard belongs to."""
    wall = guard - iw[layout.FIRST_WALL]
    return (
        wall_side(wall, iw) * w[iw[layout.Y] + iw[layout.N_COORDINATES] + wall_coordinate(wall, iw)]
    )


def resting_speed(t: float, size: float, push: float, place: float, restitution: float) -> float:
    """Return the speed of an impact below which a body that is pressed stays at its stop.

    A tiny share of the largest speed; but the bounce must also last some units of the time's last
    digit, and its impact cost a height that is not lost in the rounding of the place: of a bounce
    that gains by rounding what it loses by impact there is no end.
    """
    # Without a least cost the bound of an elastic impact would be infinite, and nothing would
    # bounce.
    cost = max(1.0 - restitution * restitution, ELASTIC)
    # A bounce of speed v rises v^2 / (2 push), of which `cost` is lost, and lasts 2 v / push: the
    # bounds follow from the rounding of the place and of the time.
    blurred = math.sqrt(2.0 * abs(push) * BLUR * abs(place) / cost)
    return max(RESTING * size, INSTANT * abs(t * push), blurred)


def energy_now(w: Vector, iw: IntVector) -> float:
    """Return the energy of the state, where guides may do work in an impact; else 0.

    A guide keeps the rate of its coordinate. Its impulse follows from the changes of the others,
    and its work is what the energy changes by and the stops do not take.
    """
    if iw[layout.N_CHANNELS] == 0:
        return 0.0
    equations.evaluate(
        equations.ENERGY,
        iw[layout.MODE],
        iw[layout.FLAGS],
        w[layout.TIME],
        w,
        iw[layout.Y],
        iw[layout.VALUES],
    )
    return w[iw[layout.VALUES]]


def strike(wall: int, w: Vector, iw: IntVector) -> None:
    """Change the rates by an impact of the slipping body."""
    y = iw[layout.Y]
    walls_at = iw[layout.WALLS]
    coordinates = iw[layout.N_COORDINATES]
    flags = iw[layout.FLAGS]
    equations.evaluate(equations.WALLS_OF, 0, flags, w[layout.TIME], w, y, walls_at)
    at = walls_at + wall * iw[layout.WALL_COLUMNS]
    side = wall_side(wall, iw)
    rate = coordinates + wall_coordinate(wall, iw)
    restitution = w[at + 1]
    # To the last bit: by this place `touched` finds the body at its stop later.
    w[y + wall_coordinate(wall, iw)] = w[at]
    equations.evaluate(
        equations.FIELD, iw[layout.MODE], flags, w[layout.TIME], w, y, iw[layout.VALUES]
    )
    push = side * w[iw[layout.VALUES] + rate]
    smallest = resting_speed(w[layout.TIME], w[iw[layout.SCALE] + rate], push, w[at], restitution)
    speed = approach(iw[layout.FIRST_WALL] + wall, w, iw)
    # What nothing presses leaves its stop, however slow it is.
    if speed <= smallest and pressed_by(side, flags, w, iw) > 0.0:
        restitution = 0.0
    if speed > 0.0:  # what leaves already takes no impulse
        before = energy_now(w, iw)
        # Behind position and restitution stand the inertia that the impulse meets, and the change
        # of each rate over that of the struck one.
        for i in range(coordinates):
            w[y + coordinates + i] -= (1.0 + restitution) * side * speed * w[at + 3 + i]
        # Set, not added up: 0.0 - 0 is +0, so that what stays has no sign of motion.
        w[y + rate] = 0.0 - side * restitution * speed
        if (
            iw[layout.BOOKS] and iw[layout.STEPS] > 0
        ):  # books open after what happens as a run begins
            # The energy of the struck motion, m v^2 / 2, but for the share e^2 that comes back.
            lost = 0.5 * w[at + 2] * (1.0 - restitution * restitution) * speed * speed
            w[layout.LOST] += lost
            w[layout.GROSS] += lost
            if iw[layout.N_CHANNELS] > 0:
                w[layout.SUPPLIED] += energy_now(w, iw) - before + lost


# Modes and switches: what holds at a state, and what follows an event.

UNMOVED = 1e-12
"""Share of a switch's largest margin so far below which it did not jump: rounding left it there."""
STALL_LIMIT = 100
"""Events in a row at one instant after which the run is given up as Zeno."""


def set_flags(t: float, w: Vector, iw: IntVector, at: int, flags: int, standing: int) -> int:
    """Return the flags that the margins of the switches ask for, nested ones included.

    Those in `standing` are at their thresholds and turn only where a margin has jumped beyond
    rounding. Of others, one that is at its threshold is off: the next step shows to which side it
    goes.
    """
    reached = iw[layout.REACHED] + iw[layout.FIRST_LIMIT] - iw[layout.N_SWITCHES]
    values = iw[layout.VALUES]
    # One may depend on another: as many sweeps as there are switches settle any chain of them.
    for _ in range(iw[layout.N_SWITCHES]):
        before = flags & standing
        equations.evaluate(equations.MARGINS, 0, flags, t, w, at, values)
        flags = 0
        for j in range(iw[layout.N_SWITCHES]):
            rounding = UNMOVED * w[reached + j] if standing & (1 << j) else 0.0
            if w[values + j] > rounding or (before & (1 << j) and w[values + j] >= -rounding):
                flags |= 1 << j
    return flags


def at_thresholds(found: int, w: Vector, iw: IntVector) -> int:
    """Return those of some switches that are at their thresholds but for rounding."""
    reached = iw[layout.REACHED] + iw[layout.FIRST_LIMIT] - iw[layout.N_SWITCHES]
    values, flags = iw[layout.VALUES], iw[layout.FLAGS]
    equations.evaluate(equations.MARGINS, 0, flags, w[layout.TIME], w, iw[layout.Y], values)
    for j in range(iw[layout.N_SWITCHES]):
        if abs(w[values + j]) > UNMOVED * w[reached + j]:
            found &= ~(1 << j)
    return found


def standing_flags(w: Vector, iw: IntVector) -> int:
    """Return the switches that are at their thresholds, whatever the slip velocity is.

    That of a velocity which is 0 now is none: what it asks for has ended.
    """
    rate = iw[layout.Y] + iw[layout.SLIP]
    result, now = (1 << iw[layout.N_SWITCHES]) - 1, w[rate]
    # A switch that is at its threshold at both rates does not depend on the rate at all.
    for trial in range(2 if result != 0 else 0):
        w[rate] = now + equations.ANY_RATE if trial == 0 else now
        result = at_thresholds(result, w, iw)
    return result


def mode_from_rest(flags: int, w: Vector, iw: IntVector) -> int:
    """Return the mode of a body whose slip velocity is zero."""
    values = iw[layout.VALUES]
    side = touched(flags, w, iw)
    # At its stop a body can only be pressed or leave it; friction decides nothing there.
    if side != 0:
        return 2 * side if pressed_by(side, flags, w, iw) >= 0.0 else -side
    if iw[layout.CAN_STICK]:
        # CONTACT writes friction, normal force, needed friction and level, in this order.
        equations.evaluate(equations.CONTACT, 0, flags, w[layout.TIME], w, iw[layout.Y], values)
        if abs(w[values + 2]) <= w[values + 3]:
            return 0
        if not iw[layout.HAS_BRISTLES]:
            return 1 if w[values + 2] > 0.0 else -1
    return direction(flags, w, iw)


def direction(flags: int, w: Vector, iw: IntVector) -> int:
    """Return the direction in which a bristle law's body leaves rest."""
    y = iw[layout.Y]
    values = iw[layout.VALUES]
    slip = iw[layout.SLIP]
    # At rest both directions have the same field: bristles push as they are bent.
    equations.evaluate(equations.FIELD, 1, flags, w[layout.TIME], w, y, values)
    if w[values + slip] == 0.0:  # where a load begins to grow, its rate tells
        equations.evaluate(equations.TIME_SLOPE, 1, flags, w[layout.TIME], w, y, values)
    return -1 if w[values + slip] < 0.0 else 1


def direction_of_break(guard: int, flags: int, w: Vector, iw: IntVector) -> int:
    """Return the direction in which a held body leaves rest as its level is reached.

    Bristles that have yielded to that level leave nothing but rounding of the balance: the body
    goes where it was pulled.
    """
    values = iw[layout.VALUES]
    equations.evaluate(equations.CONTACT, 0, flags, w[layout.TIME], w, iw[layout.Y], values)
    needed, level = w[values + 2], w[values + 3]
    equations.evaluate(equations.CONTACT, 1, flags, w[layout.TIME], w, iw[layout.Y], values)
    if abs(needed - w[values]) <= UNMOVED * level:
        return 1 if guard == layout.BREAK_FORWARD else -1
    return direction(flags, w, iw)


def set_mode(w: Vector, iw: IntVector) -> None:
    """Set mode and flags for a state, from flags that held before."""
    rate = iw[layout.Y] + iw[layout.SLIP]
    iw[layout.FLAGS] = set_flags(w[layout.TIME], w, iw, iw[layout.Y], iw[layout.FLAGS], 0)
    if w[rate] > 0.0:
        iw[layout.MODE] = 1
    elif w[rate] < 0.0:
        iw[layout.MODE] = -1
    else:
        iw[layout.MODE] = mode_from_rest(iw[layout.FLAGS], w, iw)


def turn_switch(switch: int, w: Vector, iw: IntVector) -> None:
    """Turn a switch; if it does as the run begins, decide a body at rest as if it had begun so.

    Forces that just reach the level say nothing, and would hold what has broken away there.
    """
    iw[layout.FLAGS] ^= 1 << switch
    if w[layout.TIME] == 0.0 and iw[layout.STEPS] == 0 and w[iw[layout.Y] + iw[layout.SLIP]] == 0.0:
        mode, values = mode_from_rest(iw[layout.FLAGS], w, iw), iw[layout.VALUES]
        if mode != 0 or abs(w[values + 2]) < w[values + 3]:
            iw[layout.MODE] = mode


def transition(guard: int, w: Vector, iw: IntVector) -> float:
    """Change mode or flags for a violated guard; return the margin of the decision."""
    first_wall = iw[layout.FIRST_WALL]
    first_limit = iw[layout.FIRST_LIMIT]
    y = iw[layout.Y]
    values = iw[layout.VALUES]
    t = w[layout.TIME]
    mode = iw[layout.MODE]
    flags = iw[layout.FLAGS]
    if guard >= first_wall:
        strike(guard - first_wall, w, iw)
        set_mode(w, iw)
        return 0.0
    if guard >= first_limit:
        iw[layout.STATUS] = layout.LIMITED + guard - first_limit
        return 0.0
    if guard >= layout.SWITCH:
        turn_switch(guard - layout.SWITCH, w, iw)
        return 0.0
    if guard == layout.LIFT_OFF:
        iw[layout.STATUS] = layout.LIFTED_OFF
        return 0.0
    if (
        guard == layout.STOP
        and iw[layout.HAS_BRISTLES]
        and not iw[layout.CAN_STICK]
        and touched(flags, w, iw) == 0
    ):
        iw[layout.MODE] = -mode  # bristles go on without a jump of force: nothing has to hold
    elif guard == layout.STOP:
        w[y + iw[layout.SLIP]] = 0.0
        iw[layout.MODE] = mode_from_rest(flags, w, iw)
        if (
            iw[layout.MODE] == mode and not iw[layout.HAS_BRISTLES]
        ):  # forces balance but for their rounding
            iw[layout.MODE] = 0
    elif abs(mode) == 2:  # it leaves its stop
        iw[layout.MODE] = -mode // 2
    elif iw[layout.HAS_BRISTLES]:
        iw[layout.MODE] = direction_of_break(guard, flags, w, iw)
    else:
        iw[layout.MODE] = 1 if guard == layout.BREAK_FORWARD else -1
    iw[layout.FLAGS] = set_flags(t, w, iw, y, flags, standing_flags(w, iw))
    if guard == layout.STOP and iw[layout.CAN_STICK] and abs(iw[layout.MODE]) != 2:
        equations.evaluate(equations.CONTACT, 0, iw[layout.FLAGS], t, w, y, values)
        return w[values + 3] - abs(w[values + 2])
    return 0.0


def forbidden(w: Vector, iw: IntVector) -> int:
    """Return the guard of a limit that the mode at hand begins beyond, or 0.

    Guards are looked at for a fall from above zero, which would miss one that begins below it.
    Where the equations have no meaning the normal force has none either, so limits come first.
    """
    limits = iw[layout.N_LIMITS]
    values = iw[layout.VALUES]
    first_limit = iw[layout.FIRST_LIMIT]
    if iw[layout.CAN_LIFT] or limits > 0:
        equations.guards(w[layout.TIME], w, iw, iw[layout.Y], values)
        for guard in range(first_limit, first_limit + limits):
            if w[values + guard] < 0.0:
                return guard
        if w[values + layout.LIFT_OFF] < 0.0:
            return layout.LIFT_OFF
    return 0


def turn_switches(w: Vector, iw: IntVector, events: Vector) -> None:
    """Turn the switches whose margins jumped with the drives, nested ones included."""
    values = iw[layout.VALUES]
    for _ in range(iw[layout.N_SWITCHES]):
        for guard in range(layout.SWITCH, iw[layout.FIRST_LIMIT]):
            equations.guards(w[layout.TIME], w, iw, iw[layout.Y], values)
            if w[values + guard] < -UNMOVED * w[iw[layout.REACHED] + guard]:
                note_event(guard, w, iw, events)


def settle(w: Vector, iw: IntVector, events: Vector) -> None:
    """Make the transitions that follow from a jump of forces, and from the start."""
    values, mode = iw[layout.VALUES], iw[layout.MODE]
    beyond = forbidden(w, iw)
    if beyond > 0:
        note_event(beyond, w, iw, events)
        return
    guard = -1  # a variable, so that machine code is made once for all of them
    if iw[layout.HAS_BRISTLES] and abs(mode) == 1 and w[iw[layout.Y] + iw[layout.SLIP]] == 0.0:
        if mode_from_rest(iw[layout.FLAGS], w, iw) != mode:
            guard = layout.STOP
    elif iw[layout.CAN_LIFT] or abs(mode) != 1:
        equations.guards(w[layout.TIME], w, iw, iw[layout.Y], values)
        if w[values + layout.LIFT_OFF] < 0.0:
            guard = layout.LIFT_OFF
        elif abs(mode) != 1 and w[values + layout.BREAK_FORWARD] < 0.0:
            guard = layout.BREAK_FORWARD
        elif abs(mode) != 1 and w[values + layout.BREAK_BACKWARD] < 0.0:
            guard = layout.BREAK_BACKWARD
    if guard >= 0:
        handle_event(guard, w, iw, events)


def handle_event(guard: int, w: Vector, iw: IntVector, events: Vector) -> None:
    """Make the transition of a guard, and of a limit that lies behind it."""
    note_event(guard, w, iw, events)
    if iw[layout.STATUS] == layout.RUNNING:
        beyond = forbidden(w, iw)
        if beyond > 0:
            note_event(beyond, w, iw, events)


def note_event(guard: int, w: Vector, iw: IntVector, events: Vector) -> None:
    """Make the transition of a guard and write it to the rows of events."""
    t = w[layout.TIME]
    mode = iw[layout.MODE]
    margin = transition(guard, w, iw)
    at = iw[layout.EVENTS] * layout.EVENT_COLUMNS
    events[at] = t
    events[at + 1] = mode
    events[at + 2] = iw[layout.MODE]
    events[at + 3] = guard
    events[at + 4] = iw[layout.FLAGS]
    events[at + 5] = margin
    events[at + 6] = 0.0
    count_event(t, iw, events, STALL_LIMIT)


def count_event(t: float, iw: IntVector, events: Vector, most: int) -> None:
    """Count an event that has been written; too many at one instant end the run."""
    # an event that a jump of the drives makes is no sign of others without end: time goes on
    at = iw[layout.EVENTS] * layout.EVENT_COLUMNS
    stalled = iw[layout.EVENTS] > 0 and t - events[
        at - layout.EVENT_COLUMNS
    ] <= layout.ROUNDING * abs(t)
    iw[layout.STALLS] = iw[layout.STALLS] + 1 if stalled else 0
    iw[layout.EVENTS] += 1
    if iw[layout.STALLS] > most and iw[layout.STATUS] == layout.RUNNING:
        iw[layout.STATUS] = layout.ZENO
