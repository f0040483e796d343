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
from stickslip.engine.kernels.backend import Vector, Wholes
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


def begin_contacts(w: Vector, whole: Wholes) -> None:
    """Set modes, flags and openings for the state at which a run begins."""
    # States are turned by a matrix that depends on parameters alone; all else needs the turned
    # state.
    if whole[layout.IS_TURNED]:
        assembly.prepare(w[layout.TIME], w, whole)
        equations.turn_states(whole[layout.Y], 0, w, whole)
    set_own_flags(0, w, whole)
    whole[layout.CHANGED] = 0
    decide_start(w, whole)


def decide_start(w: Vector, whole: Wholes) -> None:
    """Set modes and openings for the state and the flags with which a run begins."""
    n = whole[layout.N_DIRECTIONS]
    assembly.prepare(w[layout.TIME], w, whole)
    for c in range(whole[layout.N_CONTACTS]):
        # A reaction is known only once modes are: its contact begins closed.
        closed = whole[whole[layout.REACTS] + c] or w[whole[layout.LOAD] + c] > 0.0
        whole[whole[layout.OPEN] + c] = 0 if closed else 1
        whole[whole[layout.LAW_FLAGS] + c] = 0
    for i in range(n):
        whole[whole[layout.BEFORE] + i] = layout.FREE  # nothing slipped before
        whole[whole[layout.MODES] + i] = mode_by_rate(i, w, whole)
    motion.law_flags(w[layout.TIME], w, whole, whole[layout.Y])
    remember(whole)
    none_forced(whole)
    settle_modes(w, whole)
    for i in range(n):
        rests = (
            equations.slip_rate_along(i, whole[layout.Y], w, whole) == 0.0
            and whole[whole[layout.MODES] + i] == layout.FORWARD
        )
        falls = equations.combined(i, whole[layout.ACCELERATION], w, whole) < 0.0
        if rests and not whole[whole[layout.RIGID] + i] and falls:
            whole[whole[layout.MODES] + i] = layout.BACKWARD  # as bristles begin to bend
            assembly.refresh(w[layout.TIME], w, whole, whole[layout.Y])
    for i in range(n):
        whole[whole[layout.BEFORE] + i] = whole[whole[layout.MODES] + i]
    for c in range(whole[layout.N_CONTACTS]):
        known = whole[whole[layout.REACTS] + c] or whole[layout.CONSTANT_LOADS]
        pulls = known and w[whole[layout.LOAD] + c] < 0.0
        if pulls and whole[layout.STATUS] == layout.RUNNING:  # beyond a limit loads have no meaning
            lift_off(lift_guard(c, whole), c, w, whole)
    end_beyond_limits(w, whole)


def rubs(i: int, whole: Wholes) -> bool:
    """Whether a contact along a coordinate is closed."""
    found = False
    for c in range(whole[layout.N_CONTACTS]):
        found = found or (whole[whole[layout.SLIPS] + c] == i and not whole[whole[layout.OPEN] + c])
    return found


def mode_by_rate(i: int, w: Vector, whole: Wholes) -> int:
    """Return the mode of a coordinate; one at rest that anything may hold is to be decided.

    What nothing but bristles holds slips: their forces need no decision.
    """
    # A stop comes first: it holds even where no contact is closed.
    rate = equations.slip_rate_along(i, whole[layout.Y], w, whole)
    if rate == 0.0 and assembly.stopped_side(i, w, whole, whole[layout.Y]) != 0:
        return layout.HELD_FAST
    if not rubs(i, whole):
        return layout.FREE
    if rate == 0.0 and whole[whole[layout.RIGID] + i]:
        return layout.HELD_FAST
    return layout.BACKWARD if rate < 0.0 else layout.FORWARD


def set_own_flags(standing: int, w: Vector, whole: Wholes) -> None:
    """Set the flags of the mechanism's own switches."""
    t, y, flags = w[layout.TIME], whole[layout.Y], whole[layout.FLAGS]
    whole[layout.FLAGS] = set_flags(t, w, whole, y, flags, standing)


def turn_own_switches(w: Vector, whole: Wholes) -> None:
    """Turn the mechanism's switches whose margins jumped with the drives, nested too."""
    values, first = whole[layout.VALUES], motion.first_own_switch(whole)
    sweeps = whole[layout.N_SWITCHES]
    while sweeps > 0:
        sweeps -= 1
        equations.evaluate(
            equations.MARGINS, 0, whole[layout.FLAGS], w[layout.TIME], w, whole[layout.Y], values
        )
        turned = False
        for j in range(whole[layout.N_SWITCHES]):
            # A margin may have moved by rounding without a jump; only what is clearly beyond turns.
            margin = w[values + j] if whole[layout.FLAGS] & (1 << j) else -w[values + j]
            if margin < -UNMOVED * w[whole[layout.REACHED] + first + j]:
                whole[layout.FLAGS] ^= 1 << j
                write_unchanged(first + j, 0, w, whole)
                turned = True
        if not turned:
            return


def standing_switches(w: Vector, whole: Wholes) -> int:
    """Return the switches that are at their thresholds, whatever has just stopped.

    That of a rate which is 0 now is none: what it asks for has ended.
    """
    rates, found = (
        whole[layout.Y] + whole[layout.N_COORDINATES],
        (1 << whole[layout.N_SWITCHES]) - 1,
    )
    for trial in range(2 if found != 0 else 0):
        for i in range(whole[layout.N_COORDINATES]):
            # Only what stopped in this instant: rates of others are those that switches see.
            was = whole[whole[layout.BEFORE] + i] in (layout.FORWARD, layout.BACKWARD)
            if was and whole[whole[layout.MODES] + i] == layout.HELD_FAST:
                w[rates + i] = equations.ANY_RATE if trial == 0 else 0.0
        found = at_thresholds(found, w, whole)
    return found


def remember(whole: Wholes) -> None:
    """Keep the modes and openings before a change."""
    for i in range(whole[layout.N_DIRECTIONS]):
        whole[whole[layout.BEFORE] + i] = whole[whole[layout.MODES] + i]
    for c in range(whole[layout.N_CONTACTS]):
        whole[whole[layout.CLOSED] + c] = 1 - whole[whole[layout.OPEN] + c]


def none_forced(whole: Wholes) -> None:
    """Begin a decision: nothing is forced to slip."""
    for i in range(whole[layout.N_DIRECTIONS]):
        whole[whole[layout.FORCED] + i] = 0


def settle_modes(w: Vector, whole: Wholes) -> None:
    """Decide all coordinates that are held, or stopped; set what follows from the answer."""
    if whole[layout.N_DIRECTIONS] > whole[layout.N_COORDINATES]:
        close_loops(False, w, whole)
        set_rates(w, whole)
    for i in range(whole[layout.N_DIRECTIONS]):
        held = whole[whole[layout.MODES] + i] == layout.HELD_FAST
        whole[whole[layout.CANDIDATES] + i] = 1 if held else 0
    motion.law_flags(w[layout.TIME], w, whole, whole[layout.Y])
    solved = decide(w, whole)
    # loads that are given leave one answer; what trials without it left falls by its guard at once
    if whole[layout.N_REACTIONS] > 0 and (not solved or w[layout.PIVOT] < motion.LEAST_PIVOT):
        whole[layout.STATUS] = layout.LIMITED
    for i in range(whole[layout.N_COORDINATES] if whole[layout.N_WALLS] > 0 else 0):
        left = (
            whole[whole[layout.CANDIDATES] + i] != 0
            and whole[whole[layout.MODES] + i] != layout.HELD_FAST
        )
        # What leaves its stop and has no closed contact is free.
        if left and not rubs(i, whole):
            whole[whole[layout.MODES] + i] = layout.FREE
    if whole[layout.LAW_SWITCHES] > 0:
        motion.law_flags(w[layout.TIME], w, whole, whole[layout.Y])
        assembly.refresh(w[layout.TIME], w, whole, whole[layout.Y])


def set_rates(w: Vector, whole: Wholes) -> None:
    """Set the rates of what is held, and of what follows from others, to what they are exactly."""
    rates = whole[layout.Y] + whole[layout.N_COORDINATES]
    for i in range(whole[layout.N_COORDINATES]):
        if whole[whole[layout.MODES] + i] == layout.HELD_FAST:
            w[rates + i] = 0.0
    equations.bind(rates, 1, w, whole)


def end_beyond_limits(w: Vector, whole: Wholes) -> None:
    """End a run whose modes begin beyond one of the mechanism's own limits.

    Guards are looked at for a fall from above zero, which would miss one that begins below it.
    """
    # Where there are reactions, the determinant of their equations is limit 0.
    pivots = 1 if whole[layout.N_REACTIONS] > 0 else 0
    if pivots > 0 and whole[layout.STATUS] == layout.LIMITED:
        write_remark(whole[layout.FIRST_LIMIT], 0, w, whole)
    if whole[layout.STATUS] != layout.RUNNING or whole[layout.N_LIMITS] == pivots:
        return
    motion.contact_guards(w[layout.TIME], w, whole, whole[layout.Y], whole[layout.VALUES])
    for limit in range(pivots, whole[layout.N_LIMITS]):
        guard = whole[layout.FIRST_LIMIT] + limit
        if w[whole[layout.VALUES] + guard] < 0.0 and whole[layout.STATUS] == layout.RUNNING:
            whole[layout.STATUS] = layout.LIMITED + limit
            write_remark(guard, 0, w, whole)


def open_and_close(w: Vector, whole: Wholes) -> None:
    """Let loads that jumped open or close their contacts, and coordinates follow."""
    if not whole[layout.CONSTANT_LOADS]:
        equations.evaluate(
            equations.LOADS,
            0,
            whole[layout.FLAGS],
            w[layout.TIME],
            w,
            whole[layout.Y],
            whole[layout.LOAD],
        )
        for c in range(whole[layout.N_CONTACTS]):
            if not whole[whole[layout.REACTS] + c]:
                load = w[whole[layout.LOAD] + c]  # without load the law says nothing: it opens
                if load > 0.0:
                    whole[whole[layout.OPEN] + c] = 0
                else:
                    whole[whole[layout.OPEN] + c] = 1
    follow_openings(w, whole)


def follow_openings(w: Vector, whole: Wholes) -> None:
    """Free coordinates whose contacts are all open; take up those with one that has closed."""
    for i in range(whole[layout.N_DIRECTIONS]):
        if whole[whole[layout.MODES] + i] == layout.FREE or not rubs(i, whole):
            whole[whole[layout.MODES] + i] = mode_by_rate(i, w, whole)


def settle_contacts(w: Vector, whole: Wholes) -> None:
    """Decide anew after a jump of forces or loads, and write down what changes."""
    whole[layout.CHANGED] = 0
    remember(whole)
    turn_own_switches(w, whole)
    open_and_close(w, whole)
    none_forced(whole)
    settle_modes(w, whole)
    write_changes(NO_GUARD, w, whole)
    end_beyond_limits(w, whole)


def change_contacts(guard: int, w: Vector, whole: Wholes) -> None:
    """Make all changes of an instant, of which `guard` is the first."""
    whole[layout.CHANGED] = 0
    if whole[layout.FIRST_LIMIT] <= guard < whole[layout.FIRST_WALL]:
        whole[layout.STATUS] = layout.LIMITED + guard - whole[layout.FIRST_LIMIT]
        write_remark(guard, 0, w, whole)
        return
    remember(whole)
    none_forced(whole)
    # Exact modes have left all falls of the step in ROOTS; elsewhere guards at the event are looked
    # at.
    exact = whole[layout.STEPPER] == layout.EXACT
    if not exact:
        motion.contact_guards(w[layout.TIME], w, whole, whole[layout.Y], whole[layout.VALUES])
    # The other guard of the same coordinate tells of the opposite side.
    for other in range(motion.first_contact_guard(whole)):
        if other == guard or (other // 2 != guard // 2 and fires_too(other, exact, w, whole)):
            stop_or_break(other, w, whole)
    lifted, flags = -1, whole[layout.FLAGS]
    if guard >= whole[layout.FIRST_WALL]:
        bounce(guard, w, whole)
    elif guard >= motion.first_own_switch(whole):
        switch = guard - motion.first_own_switch(whole)
        whole[layout.FLAGS] ^= 1 << switch
        flags = whole[layout.FLAGS]
        write_unchanged(guard, 0, w, whole)
        if w[layout.TIME] == 0.0 and whole[layout.STEPS] == 0:
            decide_start(w, whole)  # as if it had begun so
            return
        open_and_close(w, whole)  # loads may jump with the switch
    elif guard >= motion.first_contact_guard(whole):
        lifted = switch_or_open(guard, w, whole)
    else:
        # a rate that was set to 0 may be what one asks for
        set_own_flags(standing_switches(w, whole), w, whole)
    if not whole[layout.CONSTANT_LOADS]:
        follow_openings(w, whole)
    settle_modes(w, whole)
    turn_at_once(guard, w, whole)
    write_impacts(guard, w, whole)
    write_changes(guard, w, whole)
    write_turned(flags, w, whole)
    end_beyond_limits(w, whole)
    if lifted >= 0:  # after what falls with it: the last event is what ends the run
        lift_off(guard, lifted, w, whole)


def turn_at_once(guard: int, w: Vector, whole: Wholes) -> None:
    """Turn a coordinate that falls back at once, in a direction that was decided again.

    The force that drives it there is gone before the clock can tell, and where its level is 0 too,
    nothing holds it.
    """
    if guard >= motion.first_contact_guard(whole) or w[layout.FRACTION] > 0.0:
        return
    i = guard // 2
    mode = whole[whole[layout.MODES] + i]
    if mode in (layout.FORWARD, layout.BACKWARD) and mode == whole[whole[layout.BEFORE] + i]:
        whole[whole[layout.MODES] + i] = -mode
        assembly.refresh(w[layout.TIME], w, whole, whole[layout.Y])


def lift_guard(contact: int, whole: Wholes) -> int:
    """Return the guard of the load of a contact."""
    wide = whole[layout.LAW_SWITCHES] + 1
    return motion.first_contact_guard(whole) + contact * wide + whole[layout.LAW_SWITCHES]


def lift_off(guard: int, contact: int, w: Vector, whole: Wholes) -> None:
    """End the run where a contact lifts off."""
    write_remark(guard, contact, w, whole)
    whole[layout.STATUS] = layout.LIFTED_OFF


def bounce(guard: int, w: Vector, whole: Wholes) -> None:
    """Make the impacts of an instant; what has another rate then slips, or is to be decided."""
    strike_stops(guard, w, whole)
    for i in range(whole[layout.N_DIRECTIONS]):
        whole[whole[layout.MODES] + i] = mode_by_rate(i, w, whole)
    set_own_flags(0, w, whole)


def fires_too(guard: int, exact: bool, w: Vector, whole: Wholes) -> bool:
    """Whether a guard of a coordinate falls in the instant at hand, too.

    What bristles alone carry only turns, and by its own guard: at rest its speed says nothing. Nor
    does that of what has just begun to slip.
    """
    if (
        not whole[whole[layout.RIGID] + guard // 2]
        and whole[whole[layout.MODES] + guard // 2] != layout.HELD_FAST
    ):
        return False
    values = whole[layout.ROOTS] if exact else whole[layout.VALUES]
    # of a level that has vanished both sides are near: nothing breaks away in both directions
    if whole[whole[layout.MODES] + guard // 2] == layout.HELD_FAST:
        opposite = guard + 1 - 2 * (guard % 2)  # guards of the two sides pair up
        if not w[values + guard] < w[values + opposite]:
            return False
    elif equations.slip_rate_along(guard // 2, whole[layout.Y], w, whole) == 0.0:
        return False
    if exact:
        h = w[layout.LENGTH]
        near = w[layout.FRACTION] + series.TOGETHER * max(abs(w[layout.TIME]), h) / h
        return w[values + guard] < NEVER_FALLS and w[values + guard] <= near
    size = guard_size(guard, w, whole)
    return size > 0.0 and w[values + guard] <= REACHED_ZERO * size


def stop_or_break(guard: int, w: Vector, whole: Wholes) -> None:
    """Stop a coordinate that slips, or let one go that is held."""
    i = guard // 2
    mode = whole[whole[layout.MODES] + i]
    if mode == layout.HELD_FAST and not opens_instead(guard, w, whole):
        force(i, layout.FORWARD if guard % 2 == 0 else layout.BACKWARD, w, whole)
    elif mode in (layout.FORWARD, layout.BACKWARD) and guard % 2 == 0:
        if whole[whole[layout.RIGID] + i]:
            if i < whole[layout.N_COORDINATES]:
                w[whole[layout.Y] + whole[layout.N_COORDINATES] + i] = 0.0
            whole[whole[layout.MODES] + i] = layout.HELD_FAST
        else:
            whole[whole[layout.MODES] + i] = -mode


def force(i: int, side: int, w: Vector, whole: Wholes) -> None:
    """Force a coordinate to slip, or what slips in the motion of a cut."""
    if i < whole[layout.N_DIRECTIONS]:
        whole[whole[layout.FORCED] + i] = side
        return
    for d in range(whole[layout.N_DIRECTIONS]):
        rate = side * crossing(i, d, w, whole)
        if (
            whole[whole[layout.MODES] + d] == layout.HELD_FAST
            and rate != 0.0
            and whole[whole[layout.FORCED] + d] == 0
        ):
            whole[whole[layout.FORCED] + d] = layout.FORWARD if rate > 0.0 else layout.BACKWARD


def opens_instead(guard: int, w: Vector, whole: Wholes) -> bool:
    """Open the contacts whose loads have vanished, if that alone let a coordinate go.

    Its level falls to zero with the loads, though nothing pushes: it is not broken away from. A
    guard that fell at once tells of no fall: the load of a contact that has just closed is 0 too.
    """
    i, least = guard // 2, REACHED_ZERO * w[whole[layout.REACHED] + guard]
    if whole[layout.CONSTANT_LOADS] or w[layout.FRACTION] == 0.0:
        return False
    if max(abs(w[whole[layout.NEEDED] + i]), w[whole[layout.LEVELS] + guard]) > least:
        return False
    found = False
    for c in range(whole[layout.N_CONTACTS]):
        own = whole[whole[layout.SLIPS] + c]
        if i >= whole[layout.N_DIRECTIONS] and crossing(i, own, w, whole) != 0.0:
            own = i
        if own == i and not whole[whole[layout.OPEN] + c]:
            light = (
                w[whole[layout.LOAD] + c]
                <= REACHED_ZERO * w[whole[layout.REACHED] + lift_guard(c, whole)]
            )
            if light and not whole[whole[layout.REACTS] + c]:
                whole[whole[layout.OPEN] + c] = 1
                found = True
    return found


def switch_or_open(guard: int, w: Vector, whole: Wholes) -> int:
    """Turn a switch of a law, or open or close a contact; return what lifts off, or -1."""
    wide = whole[layout.LAW_SWITCHES] + 1
    contact, which = divmod(guard - motion.first_contact_guard(whole), wide)
    if which < whole[layout.LAW_SWITCHES]:
        whole[whole[layout.LAW_FLAGS] + contact] ^= 1 << which
        write_unchanged(guard, contact, w, whole)
        return -1
    if whole[whole[layout.REACTS] + contact]:
        return contact
    whole[whole[layout.OPEN] + contact] = whole[
        whole[layout.CLOSED] + contact
    ]  # whatever fell with its load
    return -1


def modes_about(contact: int, w: Vector, whole: Wholes) -> tuple[int, int]:
    """Return the modes of a contact before and after the changes of an instant."""
    i, y = whole[whole[layout.SLIPS] + contact], whole[layout.Y]
    was_open = 1 - whole[whole[layout.CLOSED] + contact]
    before = motion.mode_of(contact, whole[whole[layout.BEFORE] + i], was_open, w, whole, y)
    after = motion.mode_of(
        contact, whole[whole[layout.MODES] + i], whole[whole[layout.OPEN] + contact], w, whole, y
    )
    return before, after


def first_contact_of(i: int, whole: Wholes) -> int:
    """Return the first contact along a coordinate, or the number of contacts if there is none."""
    for c in range(whole[layout.N_CONTACTS]):
        if whole[whole[layout.SLIPS] + c] == i:
            return c
    return whole[layout.N_CONTACTS]


def write_impacts(guard: int, w: Vector, whole: Wholes) -> None:
    """Write an event for each coordinate that has reached a stop, told of its first contact.

    Where no contact is along the coordinate, the first of all is named, whose mode is as it was.
    """
    if guard < whole[layout.FIRST_WALL]:
        return
    for wall in range(whole[layout.N_WALLS]):
        i = wall_coordinate(wall, whole)
        strikes = whole[whole[layout.STRUCK] + i] == STRIKES
        if strikes and assembly.margin_of(wall, w, whole, whole[layout.Y]) == 0.0:
            c = first_contact_of(i, whole)
            own = c < whole[layout.N_CONTACTS]
            before, after = modes_about(c if own else 0, w, whole)
            now = after if own else before
            write_event(
                whole[layout.FIRST_WALL] + wall, c if own else 0, before, now, 0.0, w, whole
            )


def write_changes(guard: int, w: Vector, whole: Wholes) -> None:
    """Write an event for each contact whose mode has changed, in their order."""
    impact = guard >= whole[layout.FIRST_WALL]
    for c in range(whole[layout.N_CONTACTS]):
        i = whole[whole[layout.SLIPS] + c]
        if (
            impact
            and whole[whole[layout.STRUCK] + i] == STRIKES
            and first_contact_of(i, whole) == c
        ):
            continue  # the impact's event tells
        before, after = modes_about(c, w, whole)
        if before != after:
            margin = 0.0
            if after == layout.HELD_FAST:
                needed = w[whole[layout.NEEDED] + i]
                back = 0 if needed >= 0.0 else 1
                margin = w[whole[layout.LEVELS] + 2 * i + back] - abs(needed)
            # The guard that fell first is kept in the code: -2 - guard.
            write_event(OF_MODES - 1 - guard, c, before, after, margin, w, whole)
    for i in range(whole[layout.N_COORDINATES] if whole[layout.N_WALLS] > 0 else 0):
        held = (
            whole[whole[layout.BEFORE] + i] == layout.HELD_FAST
            and whole[whole[layout.MODES] + i] != layout.HELD_FAST
        )
        if held and first_contact_of(i, whole) == whole[layout.N_CONTACTS]:
            write_remark(2 * i, 0, w, whole)  # it leaves its stop


def write_unchanged(guard: int, contact: int, w: Vector, whole: Wholes) -> None:
    """Write an event that changes no mode, before those of the instant that do."""
    before, _ = modes_about(contact, w, whole)
    write_event(guard, contact, before, before, 0.0, w, whole)


def write_remark(guard: int, contact: int, w: Vector, whole: Wholes) -> None:
    """Write an event that changes no mode, after all others of the instant."""
    mode, is_open = (
        whole[whole[layout.MODES] + whole[whole[layout.SLIPS] + contact]],
        whole[whole[layout.OPEN] + contact],
    )
    now = motion.mode_of(contact, mode, is_open, w, whole, whole[layout.Y])
    write_event(guard, contact, now, now, 0.0, w, whole)


def write_turned(flags: int, w: Vector, whole: Wholes) -> None:
    """Write an event for each of the mechanism's switches that an impact or a stop has turned."""
    first = motion.first_own_switch(whole)
    for j in range(whole[layout.N_SWITCHES]):
        if (whole[layout.FLAGS] ^ flags) & (1 << j):
            write_remark(first + j, 0, w, whole)


def write_event(
    guard: int,
    contact: int,
    before: int,
    after: int,
    margin: float,
    w: Vector,
    whole: Wholes,
) -> None:
    """Write one row of the events that are new."""
    at = whole[layout.CHANGES] + whole[layout.CHANGED] * layout.EVENT_COLUMNS
    flags = whole[layout.FLAGS]
    # Guards between these belong to a law: flags of that law are the ones that explain the event.
    if guard >= motion.first_contact_guard(whole) and guard < motion.first_own_switch(whole):
        flags = whole[whole[layout.LAW_FLAGS] + contact]
    w[at] = w[layout.TIME]
    w[at + 1] = before
    w[at + 2] = after
    w[at + 3] = guard
    w[at + 4] = flags
    w[at + 5] = margin
    w[at + 6] = contact
    whole[layout.CHANGED] += 1


# Answers of a mechanism with several contacts to the questions of the other kernels.


def answer(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Answer one question; whole numbers are left in ANSWER."""
    if name == equations.RATES:
        motion.contact_rates(t, w, whole, at, to)
    elif name == equations.GUARDS_OF:
        motion.contact_guards(t, w, whole, at, to)
    elif name == equations.COLUMNS:
        motion.contact_columns(t, w, whole, at, to)
    elif name == equations.POWERS:
        motion.contact_power(t, w, whole, at, to)
    elif name < equations.STATE_SLOPES:
        answer_of_run(name, t, w, whole, at, to)
    else:
        answer_of_slopes(name, t, w, whole, at, to)


def answer_of_slopes(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write slopes along states, time, or all quantities."""
    states = whole[layout.N_STATES]
    quantities = whole[layout.N_VARIABLES] - states - 1
    if name == equations.STATE_SLOPES:
        slopes.rate_slopes_along(0, states, t, w, whole, at, to)
    elif name == equations.TIME_SLOPES:
        slopes.rate_slopes_along(states, 1, t, w, whole, at, to)
    elif name == equations.QUANTITY_SLOPES:
        slopes.rate_slopes_along(states + 1, quantities, t, w, whole, at, to)
    elif name == equations.GUARD_STATES:
        slopes.guard_slopes_along(0, states + 1, t, w, whole, at, to)
    elif name == equations.GUARD_QUANTITIES:
        slopes.guard_slopes_along(states + 1, quantities, t, w, whole, at, to)
    elif name == equations.IMPACT_STATES:
        slopes.impact_slopes_along(0, states, t, w, whole, at, to)
    elif name == equations.IMPACT_QUANTITIES:
        slopes.impact_slopes_along(states + 1, quantities, t, w, whole, at, to)


def answer_of_run(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Answer what is asked of the course of a run."""
    if name == equations.SERIES_STEP:
        w[to] = series.contact_series_step(t, w, whole)
    elif name == equations.SERIES_FROM:
        series.contact_series(t, w, whole, at)
    elif name == equations.CROSSING:
        whole[layout.ANSWER] = series.first_contact_crossing(w, whole)
    elif name == equations.CHANGE:
        change_contacts(at, w, whole)
    elif name == equations.SETTLE:
        settle_contacts(w, whole)
    elif name == equations.BOOK:
        motion.book_contacts(w, whole)
    elif name == equations.MOTION:
        motion.note_motion(w, whole)
    elif name == equations.IS_LINEAR:
        whole[layout.ANSWER] = 1 if motion.contacts_are_linear(w, whole) else 0
    elif name == equations.STAYS:
        whole[layout.ANSWER] = 1 if motion.contacts_rest(w, whole) else 0
    else:
        answer_of_start(name, t, w, whole)


def answer_of_start(name: int, t: float, w: Vector, whole: Wholes) -> None:
    """Set what follows from a state at which a run begins, or is taken up again."""
    if name == equations.RESTORE:
        assembly.refactor(w, whole)
    elif name == equations.PREPARE:
        assembly.prepare(t, w, whole)
    elif name == equations.FIRST_SIZES:
        motion.first_contact_sizes(t, w, whole)
    elif name == equations.BEGIN:
        begin_contacts(w, whole)
