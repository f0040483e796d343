"""Events of a mechanism with several contacts, and its answers to the other kernels.

All that fires in one instant is dealt with at once (`change_contacts`):

1. A limit ends the run.
2. Every guard of a coordinate that falls in the same instant, within rounding of the time, has
   fallen: what slips and is rigid stops, what bristles alone carry turns, and what is held and
   reaches its level is forced to slip, unless its level vanished with its load.
3. Then the guard that fell first: an impact changes the rates, a switch turns, a load opens or
   closes its contact. Coordinates whose contacts are all open are free; one that has a closed
   contact again is held if it rests.
4. All that is held, or was stopped, is decided together (`decisions`).
5. What changed is written down, an event a contact: impacts first, then modes, then switches that
   an impact or a stop has turned. A run that stands beyond a limit now, or has lifted off, ends.

A jump of drives at a new piece does the same without a guard (`settle_contacts`), and so does the
start of a run, at which nothing has slipped before (`decide_start`).
"""

from stickslip.engine.kernels import equations
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector
from stickslip.engine.kernels.contacts import assembly, motion, series, slopes
from stickslip.engine.kernels.contacts.decisions import STRIKES, decide, strike_stops
from stickslip.engine.kernels.contacts.loops import close_loops, crossing
from stickslip.engine.kernels.guard_roots import NO_GUARD, guard_size
from stickslip.engine.kernels.mode_transitions import (
    UNMOVED,
    at_thresholds,
    set_flags,
    wall_coordinate,
)
from stickslip.engine.kernels.numerics import NEVER_FALLS

# What changes at an event of a mechanism with several contacts: all that fires in one instant.

OF_MODES = -1
"""Guard of an event in which modes change, in its record, less the guard that fell first."""
REACHED_ZERO = 1e-13
"""Share of its largest value below which a guard has fallen too, where it is sampled."""


def begin_contacts(w: Vector, iw: IntVector) -> None:
    """Set modes, flags and openings for the state at which a run begins."""
    # States are turned by a matrix that depends on parameters alone; all else needs the turned
    # state.
    if iw[layout.IS_TURNED]:
        assembly.prepare(w[layout.TIME], w, iw)
        equations.turn_states(iw[layout.Y], 0, w, iw)
    set_own_flags(0, w, iw)
    iw[layout.CHANGED] = 0
    decide_start(w, iw)


def decide_start(w: Vector, iw: IntVector) -> None:
    """Set modes and openings for the state and the flags with which a run begins."""
    n = iw[layout.N_DIRECTIONS]
    assembly.prepare(w[layout.TIME], w, iw)
    for c in range(iw[layout.N_CONTACTS]):
        # A reaction is known only once modes are: its contact begins closed.
        closed = iw[iw[layout.REACTS] + c] or w[iw[layout.LOAD] + c] > 0.0
        iw[iw[layout.OPEN] + c] = 0 if closed else 1
        iw[iw[layout.LAW_FLAGS] + c] = 0
    for i in range(n):
        iw[iw[layout.BEFORE] + i] = layout.FREE  # nothing slipped before
        iw[iw[layout.MODES] + i] = mode_by_rate(i, w, iw)
    motion.law_flags(w[layout.TIME], w, iw, iw[layout.Y])
    remember(iw)
    none_forced(iw)
    settle_modes(w, iw)
    for i in range(n):
        rests = (
            equations.slip_rate_along(i, iw[layout.Y], w, iw) == 0.0
            and iw[iw[layout.MODES] + i] == layout.FORWARD
        )
        falls = equations.combined(i, iw[layout.ACCELERATION], w, iw) < 0.0
        if rests and not iw[iw[layout.RIGID] + i] and falls:
            iw[iw[layout.MODES] + i] = layout.BACKWARD  # as bristles begin to bend
            assembly.refresh(w[layout.TIME], w, iw, iw[layout.Y])
    for i in range(n):
        iw[iw[layout.BEFORE] + i] = iw[iw[layout.MODES] + i]
    for c in range(iw[layout.N_CONTACTS]):
        known = iw[iw[layout.REACTS] + c] or iw[layout.CONSTANT_LOADS]
        pulls = known and w[iw[layout.LOAD] + c] < 0.0
        if pulls and iw[layout.STATUS] == layout.RUNNING:  # beyond a limit loads have no meaning
            lift_off(lift_guard(c, iw), c, w, iw)
    end_beyond_limits(w, iw)


def rubs(i: int, iw: IntVector) -> bool:
    """Whether a contact along a coordinate is closed."""
    result = False
    for c in range(iw[layout.N_CONTACTS]):
        result = result or (iw[iw[layout.SLIPS] + c] == i and not iw[iw[layout.OPEN] + c])
    return result


def mode_by_rate(i: int, w: Vector, iw: IntVector) -> int:
    """Return the mode of a coordinate; one at rest that anything may hold is to be decided.

    What nothing but bristles holds slips: their forces need no decision.
    """
    # A stop comes first: it holds even where no contact is closed.
    rate = equations.slip_rate_along(i, iw[layout.Y], w, iw)
    if rate == 0.0 and assembly.stopped_side(i, w, iw, iw[layout.Y]) != 0:
        return layout.HELD_FAST
    if not rubs(i, iw):
        return layout.FREE
    if rate == 0.0 and iw[iw[layout.RIGID] + i]:
        return layout.HELD_FAST
    return layout.BACKWARD if rate < 0.0 else layout.FORWARD


def set_own_flags(standing: int, w: Vector, iw: IntVector) -> None:
    """Set the flags of the mechanism's own switches."""
    t, y, flags = w[layout.TIME], iw[layout.Y], iw[layout.FLAGS]
    iw[layout.FLAGS] = set_flags(t, w, iw, y, flags, standing)


def turn_own_switches(w: Vector, iw: IntVector) -> None:
    """Turn the mechanism's switches whose margins jumped with the drives, nested too."""
    values, first = iw[layout.VALUES], motion.first_own_switch(iw)
    sweeps = iw[layout.N_SWITCHES]
    while sweeps > 0:
        sweeps -= 1
        equations.evaluate(
            equations.MARGINS, 0, iw[layout.FLAGS], w[layout.TIME], w, iw[layout.Y], values
        )
        turned = False
        for j in range(iw[layout.N_SWITCHES]):
            # A margin may have moved by rounding without a jump; only what is clearly beyond turns.
            margin = w[values + j] if iw[layout.FLAGS] & (1 << j) else -w[values + j]
            if margin < -UNMOVED * w[iw[layout.REACHED] + first + j]:
                iw[layout.FLAGS] ^= 1 << j
                write_unchanged(first + j, 0, w, iw)
                turned = True
        if not turned:
            return


def standing_switches(w: Vector, iw: IntVector) -> int:
    """Return the switches that are at their thresholds, whatever has just stopped.

    That of a rate which is 0 now is none: what it asks for has ended.
    """
    rates, result = (
        iw[layout.Y] + iw[layout.N_COORDINATES],
        (1 << iw[layout.N_SWITCHES]) - 1,
    )
    for trial in range(2 if result != 0 else 0):
        for i in range(iw[layout.N_COORDINATES]):
            # Only what stopped in this instant: rates of others are those that switches see.
            was = iw[iw[layout.BEFORE] + i] in (layout.FORWARD, layout.BACKWARD)
            if was and iw[iw[layout.MODES] + i] == layout.HELD_FAST:
                w[rates + i] = equations.ANY_RATE if trial == 0 else 0.0
        result = at_thresholds(result, w, iw)
    return result


def remember(iw: IntVector) -> None:
    """Keep the modes and openings before a change."""
    for i in range(iw[layout.N_DIRECTIONS]):
        iw[iw[layout.BEFORE] + i] = iw[iw[layout.MODES] + i]
    for c in range(iw[layout.N_CONTACTS]):
        iw[iw[layout.CLOSED] + c] = 1 - iw[iw[layout.OPEN] + c]


def none_forced(iw: IntVector) -> None:
    """Begin a decision: nothing is forced to slip."""
    for i in range(iw[layout.N_DIRECTIONS]):
        iw[iw[layout.FORCED] + i] = 0


def settle_modes(w: Vector, iw: IntVector) -> None:
    """Decide all coordinates that are held, or stopped; set what follows from the answer."""
    if iw[layout.N_DIRECTIONS] > iw[layout.N_COORDINATES]:
        close_loops(False, w, iw)
        set_rates(w, iw)
    for i in range(iw[layout.N_DIRECTIONS]):
        held = iw[iw[layout.MODES] + i] == layout.HELD_FAST
        iw[iw[layout.CANDIDATES] + i] = 1 if held else 0
    motion.law_flags(w[layout.TIME], w, iw, iw[layout.Y])
    solved = decide(w, iw)
    # loads that are given leave one answer; what trials without it left falls by its guard at once
    if iw[layout.N_REACTIONS] > 0 and (not solved or w[layout.PIVOT] < motion.LEAST_PIVOT):
        iw[layout.STATUS] = layout.LIMITED
    for i in range(iw[layout.N_COORDINATES] if iw[layout.N_WALLS] > 0 else 0):
        left = iw[iw[layout.CANDIDATES] + i] != 0 and iw[iw[layout.MODES] + i] != layout.HELD_FAST
        # What leaves its stop and has no closed contact is free.
        if left and not rubs(i, iw):
            iw[iw[layout.MODES] + i] = layout.FREE
    if iw[layout.LAW_SWITCHES] > 0:
        motion.law_flags(w[layout.TIME], w, iw, iw[layout.Y])
        assembly.refresh(w[layout.TIME], w, iw, iw[layout.Y])


def set_rates(w: Vector, iw: IntVector) -> None:
    """Set the rates of what is held, and of what follows from others, to what they are exactly."""
    rates = iw[layout.Y] + iw[layout.N_COORDINATES]
    for i in range(iw[layout.N_COORDINATES]):
        if iw[iw[layout.MODES] + i] == layout.HELD_FAST:
            w[rates + i] = 0.0
    equations.bind(rates, 1, w, iw)


def end_beyond_limits(w: Vector, iw: IntVector) -> None:
    """End a run whose modes begin beyond one of the mechanism's own limits.

    Guards are looked at for a fall from above zero, which would miss one that begins below it.
    """
    # Where there are reactions, the determinant of their equations is limit 0.
    pivots = 1 if iw[layout.N_REACTIONS] > 0 else 0
    if pivots > 0 and iw[layout.STATUS] == layout.LIMITED:
        write_remark(iw[layout.FIRST_LIMIT], 0, w, iw)
    if iw[layout.STATUS] != layout.RUNNING or iw[layout.N_LIMITS] == pivots:
        return
    motion.contact_guards(w[layout.TIME], w, iw, iw[layout.Y], iw[layout.VALUES])
    for limit in range(pivots, iw[layout.N_LIMITS]):
        guard = iw[layout.FIRST_LIMIT] + limit
        if w[iw[layout.VALUES] + guard] < 0.0 and iw[layout.STATUS] == layout.RUNNING:
            iw[layout.STATUS] = layout.LIMITED + limit
            write_remark(guard, 0, w, iw)


def open_and_close(w: Vector, iw: IntVector) -> None:
    """Let loads that jumped open or close their contacts, and coordinates follow."""
    if not iw[layout.CONSTANT_LOADS]:
        equations.evaluate(
            equations.LOADS,
            0,
            iw[layout.FLAGS],
            w[layout.TIME],
            w,
            iw[layout.Y],
            iw[layout.LOAD],
        )
        for c in range(iw[layout.N_CONTACTS]):
            if not iw[iw[layout.REACTS] + c]:
                load = w[iw[layout.LOAD] + c]  # without load the law says nothing: it opens
                if load > 0.0:
                    iw[iw[layout.OPEN] + c] = 0
                else:
                    iw[iw[layout.OPEN] + c] = 1
    follow_openings(w, iw)


def follow_openings(w: Vector, iw: IntVector) -> None:
    """Free coordinates whose contacts are all open; take up those with one that has closed."""
    for i in range(iw[layout.N_DIRECTIONS]):
        if iw[iw[layout.MODES] + i] == layout.FREE or not rubs(i, iw):
            iw[iw[layout.MODES] + i] = mode_by_rate(i, w, iw)


def settle_contacts(w: Vector, iw: IntVector) -> None:
    """Decide anew after a jump of forces or loads, and write down what changes."""
    iw[layout.CHANGED] = 0
    remember(iw)
    turn_own_switches(w, iw)
    open_and_close(w, iw)
    none_forced(iw)
    settle_modes(w, iw)
    write_changes(NO_GUARD, w, iw)
    end_beyond_limits(w, iw)


def change_contacts(guard: int, w: Vector, iw: IntVector) -> None:
    """Make all changes of an instant, of which `guard` is the first."""
    iw[layout.CHANGED] = 0
    if iw[layout.FIRST_LIMIT] <= guard < iw[layout.FIRST_WALL]:
        iw[layout.STATUS] = layout.LIMITED + guard - iw[layout.FIRST_LIMIT]
        write_remark(guard, 0, w, iw)
        return
    remember(iw)
    none_forced(iw)
    # Exact modes have left all falls of the step in ROOTS; elsewhere guards at the event are looked
    # at.
    exact = iw[layout.STEPPER] == layout.EXACT
    if not exact:
        motion.contact_guards(w[layout.TIME], w, iw, iw[layout.Y], iw[layout.VALUES])
    # The other guard of the same coordinate tells of the opposite side.
    for other in range(motion.first_contact_guard(iw)):
        if other == guard or (other // 2 != guard // 2 and fires_too(other, exact, w, iw)):
            stop_or_break(other, w, iw)
    lifted, flags = -1, iw[layout.FLAGS]
    if guard >= iw[layout.FIRST_WALL]:
        bounce(guard, w, iw)
    elif guard >= motion.first_own_switch(iw):
        switch = guard - motion.first_own_switch(iw)
        iw[layout.FLAGS] ^= 1 << switch
        flags = iw[layout.FLAGS]
        write_unchanged(guard, 0, w, iw)
        if w[layout.TIME] == 0.0 and iw[layout.STEPS] == 0:
            decide_start(w, iw)  # as if it had begun so
            return
        open_and_close(w, iw)  # loads may jump with the switch
    elif guard >= motion.first_contact_guard(iw):
        lifted = switch_or_open(guard, w, iw)
    else:
        # a rate that was set to 0 may be what one asks for
        set_own_flags(standing_switches(w, iw), w, iw)
    if not iw[layout.CONSTANT_LOADS]:
        follow_openings(w, iw)
    settle_modes(w, iw)
    turn_at_once(guard, w, iw)
    write_impacts(guard, w, iw)
    write_changes(guard, w, iw)
    write_turned(flags, w, iw)
    end_beyond_limits(w, iw)
    if lifted >= 0:  # after what falls with it: the last event is what ends the run
        lift_off(guard, lifted, w, iw)


def turn_at_once(guard: int, w: Vector, iw: IntVector) -> None:
    """Turn a coordinate that falls back at once, in a direction that was decided again.

    The force that drives it there is gone before the clock can tell, and where its level is 0 too,
    nothing holds it.
    """
    if guard >= motion.first_contact_guard(iw) or w[layout.FRACTION] > 0.0:
        return
    i = guard // 2
    mode = iw[iw[layout.MODES] + i]
    if mode in (layout.FORWARD, layout.BACKWARD) and mode == iw[iw[layout.BEFORE] + i]:
        iw[iw[layout.MODES] + i] = -mode
        assembly.refresh(w[layout.TIME], w, iw, iw[layout.Y])


def lift_guard(contact: int, iw: IntVector) -> int:
    """Return the guard of the load of a contact."""
    wide = iw[layout.LAW_SWITCHES] + 1
    return motion.first_contact_guard(iw) + contact * wide + iw[layout.LAW_SWITCHES]


def lift_off(guard: int, contact: int, w: Vector, iw: IntVector) -> None:
    """End the run where a contact lifts off."""
    write_remark(guard, contact, w, iw)
    iw[layout.STATUS] = layout.LIFTED_OFF


def bounce(guard: int, w: Vector, iw: IntVector) -> None:
    """Make the impacts of an instant; what has another rate then slips, or is to be decided."""
    strike_stops(guard, w, iw)
    for i in range(iw[layout.N_DIRECTIONS]):
        iw[iw[layout.MODES] + i] = mode_by_rate(i, w, iw)
    set_own_flags(0, w, iw)


def fires_too(guard: int, exact: bool, w: Vector, iw: IntVector) -> bool:
    """Whether a guard of a coordinate falls in the instant at hand, too.

    What bristles alone carry only turns, and by its own guard: at rest its speed says nothing. Nor
    does that of what has just begun to slip.
    """
    if (
        not iw[iw[layout.RIGID] + guard // 2]
        and iw[iw[layout.MODES] + guard // 2] != layout.HELD_FAST
    ):
        return False
    values = iw[layout.ROOTS] if exact else iw[layout.VALUES]
    # of a level that has vanished both sides are near: nothing breaks away in both directions
    if iw[iw[layout.MODES] + guard // 2] == layout.HELD_FAST:
        opposite = guard + 1 - 2 * (guard % 2)  # guards of the two sides pair up
        if not w[values + guard] < w[values + opposite]:
            return False
    elif equations.slip_rate_along(guard // 2, iw[layout.Y], w, iw) == 0.0:
        return False
    if exact:
        h = w[layout.LENGTH]
        near = w[layout.FRACTION] + series.TOGETHER * max(abs(w[layout.TIME]), h) / h
        return w[values + guard] < NEVER_FALLS and w[values + guard] <= near
    size = guard_size(guard, w, iw)
    return size > 0.0 and w[values + guard] <= REACHED_ZERO * size


def stop_or_break(guard: int, w: Vector, iw: IntVector) -> None:
    """Stop a coordinate that slips, or let one go that is held."""
    i = guard // 2
    mode = iw[iw[layout.MODES] + i]
    if mode == layout.HELD_FAST and not opens_instead(guard, w, iw):
        force(i, layout.FORWARD if guard % 2 == 0 else layout.BACKWARD, w, iw)
    elif mode in (layout.FORWARD, layout.BACKWARD) and guard % 2 == 0:
        if iw[iw[layout.RIGID] + i]:
            if i < iw[layout.N_COORDINATES]:
                w[iw[layout.Y] + iw[layout.N_COORDINATES] + i] = 0.0
            iw[iw[layout.MODES] + i] = layout.HELD_FAST
        else:
            iw[iw[layout.MODES] + i] = -mode


def force(i: int, side: int, w: Vector, iw: IntVector) -> None:
    """Force a coordinate to slip, or what slips in the motion of a cut."""
    if i < iw[layout.N_DIRECTIONS]:
        iw[iw[layout.FORCED] + i] = side
        return
    for d in range(iw[layout.N_DIRECTIONS]):
        rate = side * crossing(i, d, w, iw)
        if (
            iw[iw[layout.MODES] + d] == layout.HELD_FAST
            and rate != 0.0
            and iw[iw[layout.FORCED] + d] == 0
        ):
            iw[iw[layout.FORCED] + d] = layout.FORWARD if rate > 0.0 else layout.BACKWARD


def opens_instead(guard: int, w: Vector, iw: IntVector) -> bool:
    """Open the contacts whose loads have vanished, if that alone let a coordinate go.

    Its level falls to zero with the loads, though nothing pushes: it is not broken away from. A
    guard that fell at once tells of no fall: the load of a contact that has just closed is 0 too.
    """
    i, least = guard // 2, REACHED_ZERO * w[iw[layout.REACHED] + guard]
    if iw[layout.CONSTANT_LOADS] or w[layout.FRACTION] == 0.0:
        return False
    if max(abs(w[iw[layout.NEEDED] + i]), w[iw[layout.LEVELS] + guard]) > least:
        return False
    result = False
    for c in range(iw[layout.N_CONTACTS]):
        own = iw[iw[layout.SLIPS] + c]
        if i >= iw[layout.N_DIRECTIONS] and crossing(i, own, w, iw) != 0.0:
            own = i
        if own == i and not iw[iw[layout.OPEN] + c]:
            light = (
                w[iw[layout.LOAD] + c] <= REACHED_ZERO * w[iw[layout.REACHED] + lift_guard(c, iw)]
            )
            if light and not iw[iw[layout.REACTS] + c]:
                iw[iw[layout.OPEN] + c] = 1
                result = True
    return result


def switch_or_open(guard: int, w: Vector, iw: IntVector) -> int:
    """Turn a switch of a law, or open or close a contact; return what lifts off, or -1."""
    wide = iw[layout.LAW_SWITCHES] + 1
    contact, which = divmod(guard - motion.first_contact_guard(iw), wide)
    if which < iw[layout.LAW_SWITCHES]:
        iw[iw[layout.LAW_FLAGS] + contact] ^= 1 << which
        write_unchanged(guard, contact, w, iw)
        return -1
    if iw[iw[layout.REACTS] + contact]:
        return contact
    iw[iw[layout.OPEN] + contact] = iw[iw[layout.CLOSED] + contact]  # whatever fell with its load
    return -1


def modes_about(contact: int, w: Vector, iw: IntVector) -> tuple[int, int]:
    """Return the modes of a contact before and after the changes of an instant."""
    i, y = iw[iw[layout.SLIPS] + contact], iw[layout.Y]
    was_open = 1 - iw[iw[layout.CLOSED] + contact]
    before = motion.mode_of(contact, iw[iw[layout.BEFORE] + i], was_open, w, iw, y)
    after = motion.mode_of(
        contact, iw[iw[layout.MODES] + i], iw[iw[layout.OPEN] + contact], w, iw, y
    )
    return before, after


def first_contact_of(i: int, iw: IntVector) -> int:
    """Return the first contact along a coordinate, or the number of contacts if there is none."""
    for c in range(iw[layout.N_CONTACTS]):
        if iw[iw[layout.SLIPS] + c] == i:
            return c
    return iw[layout.N_CONTACTS]


def write_impacts(guard: int, w: Vector, iw: IntVector) -> None:
    """Write an event for each coordinate that has reached a stop, told of its first contact.

    Where no contact is along the coordinate, the first of all is named, whose mode is as it was.
    """
    if guard < iw[layout.FIRST_WALL]:
        return
    for wall in range(iw[layout.N_WALLS]):
        i = wall_coordinate(wall, iw)
        strikes = iw[iw[layout.STRUCK] + i] == STRIKES
        if strikes and assembly.margin_of(wall, w, iw, iw[layout.Y]) == 0.0:
            c = first_contact_of(i, iw)
            own = c < iw[layout.N_CONTACTS]
            before, after = modes_about(c if own else 0, w, iw)
            now = after if own else before
            write_event(iw[layout.FIRST_WALL] + wall, c if own else 0, before, now, 0.0, w, iw)


def write_changes(guard: int, w: Vector, iw: IntVector) -> None:
    """Write an event for each contact whose mode has changed, in their order."""
    impact = guard >= iw[layout.FIRST_WALL]
    for c in range(iw[layout.N_CONTACTS]):
        i = iw[iw[layout.SLIPS] + c]
        if impact and iw[iw[layout.STRUCK] + i] == STRIKES and first_contact_of(i, iw) == c:
            continue  # the impact's event tells
        before, after = modes_about(c, w, iw)
        if before != after:
            margin = 0.0
            if after == layout.HELD_FAST:
                needed = w[iw[layout.NEEDED] + i]
                back = 0 if needed >= 0.0 else 1
                margin = w[iw[layout.LEVELS] + 2 * i + back] - abs(needed)
            # The guard that fell first is kept in the code: -2 - guard.
            write_event(OF_MODES - 1 - guard, c, before, after, margin, w, iw)
    for i in range(iw[layout.N_COORDINATES] if iw[layout.N_WALLS] > 0 else 0):
        held = (
            iw[iw[layout.BEFORE] + i] == layout.HELD_FAST
            and iw[iw[layout.MODES] + i] != layout.HELD_FAST
        )
        if held and first_contact_of(i, iw) == iw[layout.N_CONTACTS]:
            write_remark(2 * i, 0, w, iw)  # it leaves its stop


def write_unchanged(guard: int, contact: int, w: Vector, iw: IntVector) -> None:
    """Write an event that changes no mode, before those of the instant that do."""
    before, _ = modes_about(contact, w, iw)
    write_event(guard, contact, before, before, 0.0, w, iw)


def write_remark(guard: int, contact: int, w: Vector, iw: IntVector) -> None:
    """Write an event that changes no mode, after all others of the instant."""
    mode, is_open = (
        iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + contact]],
        iw[iw[layout.OPEN] + contact],
    )
    now = motion.mode_of(contact, mode, is_open, w, iw, iw[layout.Y])
    write_event(guard, contact, now, now, 0.0, w, iw)


def write_turned(flags: int, w: Vector, iw: IntVector) -> None:
    """Write an event for each of the mechanism's switches that an impact or a stop has turned."""
    first = motion.first_own_switch(iw)
    for j in range(iw[layout.N_SWITCHES]):
        if (iw[layout.FLAGS] ^ flags) & (1 << j):
            write_remark(first + j, 0, w, iw)


def write_event(
    guard: int,
    contact: int,
    before: int,
    after: int,
    margin: float,
    w: Vector,
    iw: IntVector,
) -> None:
    """Write one row of the events that are new."""
    at = iw[layout.CHANGES] + iw[layout.CHANGED] * layout.EVENT_COLUMNS
    flags = iw[layout.FLAGS]
    # Guards between these belong to a law: flags of that law are the ones that explain the event.
    if guard >= motion.first_contact_guard(iw) and guard < motion.first_own_switch(iw):
        flags = iw[iw[layout.LAW_FLAGS] + contact]
    w[at] = w[layout.TIME]
    w[at + 1] = before
    w[at + 2] = after
    w[at + 3] = guard
    w[at + 4] = flags
    w[at + 5] = margin
    w[at + 6] = contact
    iw[layout.CHANGED] += 1


# Answers of a mechanism with several contacts to the questions of the other kernels.


def answer(name: int, t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Answer one question; whole numbers are left in ANSWER."""
    if name == equations.RATES:
        motion.contact_rates(t, w, iw, at, to)
    elif name == equations.GUARDS_OF:
        motion.contact_guards(t, w, iw, at, to)
    elif name == equations.COLUMNS:
        motion.contact_columns(t, w, iw, at, to)
    elif name == equations.POWERS:
        motion.contact_power(t, w, iw, at, to)
    elif name < equations.STATE_SLOPES:
        answer_of_run(name, t, w, iw, at, to)
    else:
        answer_of_slopes(name, t, w, iw, at, to)


def answer_of_slopes(name: int, t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write slopes along states, time, or all quantities."""
    states = iw[layout.N_STATES]
    quantities = iw[layout.N_VARIABLES] - states - 1
    if name == equations.STATE_SLOPES:
        slopes.rate_slopes_along(0, states, t, w, iw, at, to)
    elif name == equations.TIME_SLOPES:
        slopes.rate_slopes_along(states, 1, t, w, iw, at, to)
    elif name == equations.QUANTITY_SLOPES:
        slopes.rate_slopes_along(states + 1, quantities, t, w, iw, at, to)
    elif name == equations.GUARD_STATES:
        slopes.guard_slopes_along(0, states + 1, t, w, iw, at, to)
    elif name == equations.GUARD_QUANTITIES:
        slopes.guard_slopes_along(states + 1, quantities, t, w, iw, at, to)
    elif name == equations.IMPACT_STATES:
        slopes.impact_slopes_along(0, states, t, w, iw, at, to)
    elif name == equations.IMPACT_QUANTITIES:
        slopes.impact_slopes_along(states + 1, quantities, t, w, iw, at, to)


def answer_of_run(name: int, t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Answer what is asked of the course of a run."""
    if name == equations.SERIES_STEP:
        w[to] = series.contact_series_step(t, w, iw)
    elif name == equations.SERIES_FROM:
        series.contact_series(t, w, iw, at)
    elif name == equations.CROSSING:
        iw[layout.ANSWER] = series.first_contact_crossing(w, iw)
    elif name == equations.CHANGE:
        change_contacts(at, w, iw)
    elif name == equations.SETTLE:
        settle_contacts(w, iw)
    elif name == equations.BOOK:
        motion.book_contacts(w, iw)
    elif name == equations.MOTION:
        motion.note_motion(w, iw)
    elif name == equations.IS_LINEAR:
        iw[layout.ANSWER] = 1 if motion.contacts_are_linear(w, iw) else 0
    elif name == equations.STAYS:
        iw[layout.ANSWER] = 1 if motion.contacts_rest(w, iw) else 0
    else:
        answer_of_start(name, t, w, iw)


def answer_of_start(name: int, t: float, w: Vector, iw: IntVector) -> None:
    """Set what follows from a state at which a run begins, or is taken up again."""
    if name == equations.RESTORE:
        assembly.refactor(w, iw)
    elif name == equations.PREPARE:
        assembly.prepare(t, w, iw)
    elif name == equations.FIRST_SIZES:
        motion.first_contact_sizes(t, w, iw)
    elif name == equations.BEGIN:
        begin_contacts(w, iw)
