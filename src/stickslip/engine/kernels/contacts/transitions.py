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

from stickslip.engine.kernels.backend import Vector, Wholes
from stickslip.engine.kernels.contacts.assembly import (
    margin_of,
    prepare,
    refactor,
    refresh,
    stopped_side,
)
from stickslip.engine.kernels.contacts.decisions import STRIKES, decide, strike_stops
from stickslip.engine.kernels.contacts.loops import close_loops, crossing
from stickslip.engine.kernels.contacts.motion import (
    LEAST_PIVOT,
    book_contacts,
    contact_columns,
    contact_guards,
    contact_power,
    contact_rates,
    contacts_are_linear,
    contacts_rest,
    first_contact_guard,
    first_contact_sizes,
    first_own_switch,
    law_flags,
    mode_of,
    note_motion,
)
from stickslip.engine.kernels.contacts.series import (
    TOGETHER,
    contact_series,
    contact_series_step,
    first_contact_crossing,
)
from stickslip.engine.kernels.contacts.slopes import (
    guard_slopes_along,
    impact_slopes_along,
    rate_slopes_along,
)
from stickslip.engine.kernels.equations import (
    ANY_RATE,
    BEGIN,
    BOOK,
    CHANGE,
    COLUMNS,
    CROSSING,
    FIRST_SIZES,
    GUARD_QUANTITIES,
    GUARD_STATES,
    GUARDS_OF,
    IMPACT_QUANTITIES,
    IMPACT_STATES,
    IS_LINEAR,
    LOADS,
    MARGINS,
    MOTION,
    POWERS,
    PREPARE,
    QUANTITY_SLOPES,
    RATES,
    RESTORE,
    SERIES_FROM,
    SERIES_STEP,
    SETTLE,
    STATE_SLOPES,
    STAYS,
    TIME_SLOPES,
    bind,
    combined,
    evaluate,
    slip_rate_along,
    turn_states,
)
from stickslip.engine.kernels.guard_roots import NO_GUARD, guard_size
from stickslip.engine.kernels.mode_transitions import UNMOVED, wall_coordinate
from stickslip.engine.kernels.numerics import NEVER_FALLS
from stickslip.engine.kernels.state_layout import (
    ACCELERATION,
    ANSWER,
    BACKWARD,
    BEFORE,
    CANDIDATES,
    CHANGED,
    CHANGES,
    CLOSED,
    CONSTANT_LOADS,
    EVENT_COLUMNS,
    EXACT,
    FIRST_LIMIT,
    FIRST_WALL,
    FLAGS,
    FORCED,
    FORWARD,
    FRACTION,
    FREE,
    HELD_FAST,
    IS_TURNED,
    LAW_FLAGS,
    LAW_SWITCHES,
    LENGTH,
    LEVELS,
    LIFTED_OFF,
    LIMITED,
    LOAD,
    MODES,
    N_CONTACTS,
    N_COORDINATES,
    N_DIRECTIONS,
    N_LIMITS,
    N_REACTIONS,
    N_STATES,
    N_SWITCHES,
    N_VARIABLES,
    N_WALLS,
    NEEDED,
    OPEN,
    PIVOT,
    REACHED,
    REACTS,
    RIGID,
    ROOTS,
    RUNNING,
    SLIPS,
    STATUS,
    STEPPER,
    STEPS,
    STRUCK,
    TIME,
    VALUES,
    Y,
)

# What changes at an event of a mechanism with several contacts: all that fires in one instant.

OF_MODES = -1
"""Guard of an event in which modes change, in its record, less the guard that fell first."""
REACHED_ZERO = 1e-13
"""Share of its largest value below which a guard has fallen too, where it is sampled."""


def begin_contacts(w: Vector, whole: Wholes) -> None:
    """Set modes, flags and openings for the state at which a run begins."""
    # States are turned by a matrix that depends on parameters alone; all else needs the turned
    # state.
    if whole[IS_TURNED]:
        prepare(w[TIME], w, whole)
        turn_states(whole[Y], 0, w, whole)
    for _ in range(whole[N_SWITCHES]):
        set_own_flags(0, w, whole)
    whole[CHANGED] = 0
    decide_start(w, whole)


def decide_start(w: Vector, whole: Wholes) -> None:
    """Set modes and openings for the state and the flags with which a run begins."""
    n = whole[N_DIRECTIONS]
    prepare(w[TIME], w, whole)
    for c in range(whole[N_CONTACTS]):
        # A reaction is known only once modes are: its contact begins closed.
        closed = whole[whole[REACTS] + c] or w[whole[LOAD] + c] > 0.0
        whole[whole[OPEN] + c] = 0 if closed else 1
        whole[whole[LAW_FLAGS] + c] = 0
    for i in range(n):
        whole[whole[BEFORE] + i] = FREE  # nothing slipped before
        whole[whole[MODES] + i] = mode_by_rate(i, w, whole)
    law_flags(w[TIME], w, whole, whole[Y])
    remember(whole)
    none_forced(whole)
    settle_modes(w, whole)
    for i in range(n):
        rests = slip_rate_along(i, whole[Y], w, whole) == 0.0 and whole[whole[MODES] + i] == FORWARD
        falls = combined(i, whole[ACCELERATION], w, whole) < 0.0
        if rests and not whole[whole[RIGID] + i] and falls:
            whole[whole[MODES] + i] = BACKWARD  # as bristles begin to bend
            refresh(w[TIME], w, whole, whole[Y])
    for i in range(n):
        whole[whole[BEFORE] + i] = whole[whole[MODES] + i]
    for c in range(whole[N_CONTACTS]):
        known = whole[whole[REACTS] + c] or whole[CONSTANT_LOADS]
        pulls = known and w[whole[LOAD] + c] < 0.0
        if pulls and whole[STATUS] == RUNNING:  # beyond a limit loads have no meaning
            lift_off(lift_guard(c, whole), c, w, whole)
    end_beyond_limits(w, whole)


def rubs(i: int, whole: Wholes) -> bool:
    """Whether a contact along a coordinate is closed."""
    found = False
    for c in range(whole[N_CONTACTS]):
        found = found or (whole[whole[SLIPS] + c] == i and not whole[whole[OPEN] + c])
    return found


def mode_by_rate(i: int, w: Vector, whole: Wholes) -> int:
    """Return the mode of a coordinate; one at rest that anything may hold is to be decided.

    What nothing but bristles holds slips: their forces need no decision.
    """
    # A stop comes first: it holds even where no contact is closed.
    rate = slip_rate_along(i, whole[Y], w, whole)
    if rate == 0.0 and stopped_side(i, w, whole, whole[Y]) != 0:
        return HELD_FAST
    if not rubs(i, whole):
        return FREE
    if rate == 0.0 and whole[whole[RIGID] + i]:
        return HELD_FAST
    return BACKWARD if rate < 0.0 else FORWARD


def set_own_flags(standing: int, w: Vector, whole: Wholes) -> None:
    """Set the flags of the mechanism's own switches.

    One that stands at its threshold is off, unless it was left on there, as `standing` tells: the
    next step shows to which side it goes.
    """
    values = whole[VALUES]
    evaluate(MARGINS, 0, whole[FLAGS], w[TIME], w, whole[Y], values)
    whole[FLAGS] = 0
    for j in range(whole[N_SWITCHES]):
        margin = w[values + j]
        if margin > 0.0 or (margin == 0.0 and standing & (1 << j)):
            whole[FLAGS] |= 1 << j


def turn_own_switches(w: Vector, whole: Wholes) -> None:
    """Turn the mechanism's switches whose margins jumped with the drives, nested too."""
    values, first = whole[VALUES], first_own_switch(whole)
    sweeps = whole[N_SWITCHES]
    while sweeps > 0:
        sweeps -= 1
        evaluate(MARGINS, 0, whole[FLAGS], w[TIME], w, whole[Y], values)
        turned = False
        for j in range(whole[N_SWITCHES]):
            # A margin may have moved by rounding without a jump; only what is clearly beyond turns.
            margin = w[values + j] if whole[FLAGS] & (1 << j) else -w[values + j]
            if margin < -UNMOVED * w[whole[REACHED] + first + j]:
                whole[FLAGS] ^= 1 << j
                write_unchanged(first + j, 0, w, whole)
                turned = True
        if not turned:
            return


def standing_switches(w: Vector, whole: Wholes) -> int:
    """Return the flags of switches that are on at their thresholds, whatever has just stopped.

    That of a rate which is 0 now is off: what it asks for has ended.
    """
    values, rates, found = whole[VALUES], whole[Y] + whole[N_COORDINATES], whole[FLAGS]
    for trial in range(2):
        for i in range(whole[N_COORDINATES]):
            # Only what stopped in this instant: rates of others are those that switches see.
            was = whole[whole[BEFORE] + i] in (FORWARD, BACKWARD)
            if was and whole[whole[MODES] + i] == HELD_FAST:
                w[rates + i] = ANY_RATE if trial == 0 else 0.0
        evaluate(MARGINS, 0, whole[FLAGS], w[TIME], w, whole[Y], values)
        for j in range(whole[N_SWITCHES]):
            if w[values + j] != 0.0:
                found &= ~(1 << j)
    return found


def remember(whole: Wholes) -> None:
    """Keep the modes and openings before a change."""
    for i in range(whole[N_DIRECTIONS]):
        whole[whole[BEFORE] + i] = whole[whole[MODES] + i]
    for c in range(whole[N_CONTACTS]):
        whole[whole[CLOSED] + c] = 1 - whole[whole[OPEN] + c]


def none_forced(whole: Wholes) -> None:
    """Begin a decision: nothing is forced to slip."""
    for i in range(whole[N_DIRECTIONS]):
        whole[whole[FORCED] + i] = 0


def settle_modes(w: Vector, whole: Wholes) -> None:
    """Decide all coordinates that are held, or stopped; set what follows from the answer."""
    if whole[N_DIRECTIONS] > whole[N_COORDINATES]:
        close_loops(False, w, whole)
        set_rates(w, whole)
    for i in range(whole[N_DIRECTIONS]):
        held = whole[whole[MODES] + i] == HELD_FAST
        whole[whole[CANDIDATES] + i] = 1 if held else 0
    law_flags(w[TIME], w, whole, whole[Y])
    solved = decide(w, whole)
    # loads that are given leave one answer; what trials without it left falls by its guard at once
    if whole[N_REACTIONS] > 0 and (not solved or w[PIVOT] < LEAST_PIVOT):
        whole[STATUS] = LIMITED
    for i in range(whole[N_COORDINATES] if whole[N_WALLS] > 0 else 0):
        left = whole[whole[CANDIDATES] + i] != 0 and whole[whole[MODES] + i] != HELD_FAST
        # What leaves its stop and has no closed contact is free.
        if left and not rubs(i, whole):
            whole[whole[MODES] + i] = FREE
    if whole[LAW_SWITCHES] > 0:
        law_flags(w[TIME], w, whole, whole[Y])
        refresh(w[TIME], w, whole, whole[Y])


def set_rates(w: Vector, whole: Wholes) -> None:
    """Set the rates of what is held, and of what follows from others, to what they are exactly."""
    rates = whole[Y] + whole[N_COORDINATES]
    for i in range(whole[N_COORDINATES]):
        if whole[whole[MODES] + i] == HELD_FAST:
            w[rates + i] = 0.0
    bind(rates, 1, w, whole)


def end_beyond_limits(w: Vector, whole: Wholes) -> None:
    """End a run whose modes begin beyond one of the mechanism's own limits.

    Guards are looked at for a fall from above zero, which would miss one that begins below it.
    """
    # Where there are reactions, the determinant of their equations is limit 0.
    pivots = 1 if whole[N_REACTIONS] > 0 else 0
    if pivots > 0 and whole[STATUS] == LIMITED:
        write_remark(whole[FIRST_LIMIT], 0, w, whole)
    if whole[STATUS] != RUNNING or whole[N_LIMITS] == pivots:
        return
    contact_guards(w[TIME], w, whole, whole[Y], whole[VALUES])
    for limit in range(pivots, whole[N_LIMITS]):
        guard = whole[FIRST_LIMIT] + limit
        if w[whole[VALUES] + guard] < 0.0 and whole[STATUS] == RUNNING:
            whole[STATUS] = LIMITED + limit
            write_remark(guard, 0, w, whole)


def open_and_close(w: Vector, whole: Wholes) -> None:
    """Let loads that jumped open or close their contacts, and coordinates follow."""
    if not whole[CONSTANT_LOADS]:
        evaluate(LOADS, 0, whole[FLAGS], w[TIME], w, whole[Y], whole[LOAD])
        for c in range(whole[N_CONTACTS]):
            if not whole[whole[REACTS] + c]:
                load = w[whole[LOAD] + c]  # without load the law says nothing: it opens
                if load > 0.0:
                    whole[whole[OPEN] + c] = 0
                else:
                    whole[whole[OPEN] + c] = 1
    follow_openings(w, whole)


def follow_openings(w: Vector, whole: Wholes) -> None:
    """Free coordinates whose contacts are all open; take up those with one that has closed."""
    for i in range(whole[N_DIRECTIONS]):
        if whole[whole[MODES] + i] == FREE or not rubs(i, whole):
            whole[whole[MODES] + i] = mode_by_rate(i, w, whole)


def settle_contacts(w: Vector, whole: Wholes) -> None:
    """Decide anew after a jump of forces or loads, and write down what changes."""
    whole[CHANGED] = 0
    remember(whole)
    turn_own_switches(w, whole)
    open_and_close(w, whole)
    none_forced(whole)
    settle_modes(w, whole)
    write_changes(NO_GUARD, w, whole)
    end_beyond_limits(w, whole)


def change_contacts(guard: int, w: Vector, whole: Wholes) -> None:
    """Make all changes of an instant, of which `guard` is the first."""
    whole[CHANGED] = 0
    if whole[FIRST_LIMIT] <= guard < whole[FIRST_WALL]:
        whole[STATUS] = LIMITED + guard - whole[FIRST_LIMIT]
        write_remark(guard, 0, w, whole)
        return
    remember(whole)
    none_forced(whole)
    # Exact modes have left all falls of the step in ROOTS; elsewhere guards at the event are looked
    # at.
    exact = whole[STEPPER] == EXACT
    if not exact:
        contact_guards(w[TIME], w, whole, whole[Y], whole[VALUES])
    # The other guard of the same coordinate tells of the opposite side.
    for other in range(first_contact_guard(whole)):
        if other == guard or (other // 2 != guard // 2 and fires_too(other, exact, w, whole)):
            stop_or_break(other, w, whole)
    lifted, flags = -1, whole[FLAGS]
    if guard >= whole[FIRST_WALL]:
        bounce(guard, w, whole)
    elif guard >= first_own_switch(whole):
        switch = guard - first_own_switch(whole)
        whole[FLAGS] ^= 1 << switch
        flags = whole[FLAGS]
        write_unchanged(guard, 0, w, whole)
        if w[TIME] == 0.0 and whole[STEPS] == 0:
            decide_start(w, whole)  # as if it had begun so
            return
        open_and_close(w, whole)  # loads may jump with the switch
    elif guard >= first_contact_guard(whole):
        lifted = switch_or_open(guard, w, whole)
    else:
        standing = standing_switches(w, whole) if whole[N_SWITCHES] > 0 else 0
        for _ in range(whole[N_SWITCHES]):
            set_own_flags(standing, w, whole)  # a rate that was set to 0 may be what one asks for
    if not whole[CONSTANT_LOADS]:
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
    if guard >= first_contact_guard(whole) or w[FRACTION] > 0.0:
        return
    i = guard // 2
    mode = whole[whole[MODES] + i]
    if mode in (FORWARD, BACKWARD) and mode == whole[whole[BEFORE] + i]:
        whole[whole[MODES] + i] = -mode
        refresh(w[TIME], w, whole, whole[Y])


def lift_guard(contact: int, whole: Wholes) -> int:
    """Return the guard of the load of a contact."""
    wide = whole[LAW_SWITCHES] + 1
    return first_contact_guard(whole) + contact * wide + whole[LAW_SWITCHES]


def lift_off(guard: int, contact: int, w: Vector, whole: Wholes) -> None:
    """End the run where a contact lifts off."""
    write_remark(guard, contact, w, whole)
    whole[STATUS] = LIFTED_OFF


def bounce(guard: int, w: Vector, whole: Wholes) -> None:
    """Make the impacts of an instant; what has another rate then slips, or is to be decided."""
    strike_stops(guard, w, whole)
    for i in range(whole[N_DIRECTIONS]):
        whole[whole[MODES] + i] = mode_by_rate(i, w, whole)
    for _ in range(whole[N_SWITCHES]):
        set_own_flags(0, w, whole)


def fires_too(guard: int, exact: bool, w: Vector, whole: Wholes) -> bool:
    """Whether a guard of a coordinate falls in the instant at hand, too.

    What bristles alone carry only turns, and by its own guard: at rest its speed says nothing. Nor
    does that of what has just begun to slip.
    """
    if not whole[whole[RIGID] + guard // 2] and whole[whole[MODES] + guard // 2] != HELD_FAST:
        return False
    values = whole[ROOTS] if exact else whole[VALUES]
    # of a level that has vanished both sides are near: nothing breaks away in both directions
    if whole[whole[MODES] + guard // 2] == HELD_FAST:
        opposite = guard + 1 - 2 * (guard % 2)  # guards of the two sides pair up
        if not w[values + guard] < w[values + opposite]:
            return False
    elif slip_rate_along(guard // 2, whole[Y], w, whole) == 0.0:
        return False
    if exact:
        h = w[LENGTH]
        near = w[FRACTION] + TOGETHER * max(abs(w[TIME]), h) / h
        return w[values + guard] < NEVER_FALLS and w[values + guard] <= near
    size = guard_size(guard, w, whole)
    return size > 0.0 and w[values + guard] <= REACHED_ZERO * size


def stop_or_break(guard: int, w: Vector, whole: Wholes) -> None:
    """Stop a coordinate that slips, or let one go that is held."""
    i = guard // 2
    mode = whole[whole[MODES] + i]
    if mode == HELD_FAST and not opens_instead(guard, w, whole):
        force(i, FORWARD if guard % 2 == 0 else BACKWARD, w, whole)
    elif mode in (FORWARD, BACKWARD) and guard % 2 == 0:
        if whole[whole[RIGID] + i]:
            if i < whole[N_COORDINATES]:
                w[whole[Y] + whole[N_COORDINATES] + i] = 0.0
            whole[whole[MODES] + i] = HELD_FAST
        else:
            whole[whole[MODES] + i] = -mode


def force(i: int, side: int, w: Vector, whole: Wholes) -> None:
    """Force a coordinate to slip, or what slips in the motion of a cut."""
    if i < whole[N_DIRECTIONS]:
        whole[whole[FORCED] + i] = side
        return
    for d in range(whole[N_DIRECTIONS]):
        rate = side * crossing(i, d, w, whole)
        if whole[whole[MODES] + d] == HELD_FAST and rate != 0.0 and whole[whole[FORCED] + d] == 0:
            whole[whole[FORCED] + d] = FORWARD if rate > 0.0 else BACKWARD


def opens_instead(guard: int, w: Vector, whole: Wholes) -> bool:
    """Open the contacts whose loads have vanished, if that alone let a coordinate go.

    Its level falls to zero with the loads, though nothing pushes: it is not broken away from. A
    guard that fell at once tells of no fall: the load of a contact that has just closed is 0 too.
    """
    i, least = guard // 2, REACHED_ZERO * w[whole[REACHED] + guard]
    if whole[CONSTANT_LOADS] or w[FRACTION] == 0.0:
        return False
    if max(abs(w[whole[NEEDED] + i]), w[whole[LEVELS] + guard]) > least:
        return False
    found = False
    for c in range(whole[N_CONTACTS]):
        own = whole[whole[SLIPS] + c]
        if i >= whole[N_DIRECTIONS] and crossing(i, own, w, whole) != 0.0:
            own = i
        if own == i and not whole[whole[OPEN] + c]:
            light = w[whole[LOAD] + c] <= REACHED_ZERO * w[whole[REACHED] + lift_guard(c, whole)]
            if light and not whole[whole[REACTS] + c]:
                whole[whole[OPEN] + c] = 1
                found = True
    return found


def switch_or_open(guard: int, w: Vector, whole: Wholes) -> int:
    """Turn a switch of a law, or open or close a contact; return what lifts off, or -1."""
    wide = whole[LAW_SWITCHES] + 1
    contact, which = divmod(guard - first_contact_guard(whole), wide)
    if which < whole[LAW_SWITCHES]:
        whole[whole[LAW_FLAGS] + contact] ^= 1 << which
        write_unchanged(guard, contact, w, whole)
        return -1
    if whole[whole[REACTS] + contact]:
        return contact
    whole[whole[OPEN] + contact] = whole[whole[CLOSED] + contact]  # whatever fell with its load
    return -1


def modes_about(contact: int, w: Vector, whole: Wholes) -> tuple[int, int]:
    """Return the modes of a contact before and after the changes of an instant."""
    i, y = whole[whole[SLIPS] + contact], whole[Y]
    was_open = 1 - whole[whole[CLOSED] + contact]
    before = mode_of(contact, whole[whole[BEFORE] + i], was_open, w, whole, y)
    after = mode_of(contact, whole[whole[MODES] + i], whole[whole[OPEN] + contact], w, whole, y)
    return before, after


def first_contact_of(i: int, whole: Wholes) -> int:
    """Return the first contact along a coordinate, or the number of contacts if there is none."""
    for c in range(whole[N_CONTACTS]):
        if whole[whole[SLIPS] + c] == i:
            return c
    return whole[N_CONTACTS]


def write_impacts(guard: int, w: Vector, whole: Wholes) -> None:
    """Write an event for each coordinate that has reached a stop, told of its first contact.

    Where no contact is along the coordinate, the first of all is named, whose mode is as it was.
    """
    if guard < whole[FIRST_WALL]:
        return
    for wall in range(whole[N_WALLS]):
        i = wall_coordinate(wall, whole)
        strikes = whole[whole[STRUCK] + i] == STRIKES
        if strikes and margin_of(wall, w, whole, whole[Y]) == 0.0:
            c = first_contact_of(i, whole)
            own = c < whole[N_CONTACTS]
            before, after = modes_about(c if own else 0, w, whole)
            now = after if own else before
            write_event(whole[FIRST_WALL] + wall, c if own else 0, before, now, 0.0, w, whole)


def write_changes(guard: int, w: Vector, whole: Wholes) -> None:
    """Write an event for each contact whose mode has changed, in their order."""
    impact = guard >= whole[FIRST_WALL]
    for c in range(whole[N_CONTACTS]):
        i = whole[whole[SLIPS] + c]
        if impact and whole[whole[STRUCK] + i] == STRIKES and first_contact_of(i, whole) == c:
            continue  # the impact's event tells
        before, after = modes_about(c, w, whole)
        if before != after:
            margin = 0.0
            if after == HELD_FAST:
                needed = w[whole[NEEDED] + i]
                back = 0 if needed >= 0.0 else 1
                margin = w[whole[LEVELS] + 2 * i + back] - abs(needed)
            # The guard that fell first is kept in the code: -2 - guard.
            write_event(OF_MODES - 1 - guard, c, before, after, margin, w, whole)
    for i in range(whole[N_COORDINATES] if whole[N_WALLS] > 0 else 0):
        held = whole[whole[BEFORE] + i] == HELD_FAST and whole[whole[MODES] + i] != HELD_FAST
        if held and first_contact_of(i, whole) == whole[N_CONTACTS]:
            write_remark(2 * i, 0, w, whole)  # it leaves its stop


def write_unchanged(guard: int, contact: int, w: Vector, whole: Wholes) -> None:
    """Write an event that changes no mode, before those of the instant that do."""
    before, _ = modes_about(contact, w, whole)
    write_event(guard, contact, before, before, 0.0, w, whole)


def write_remark(guard: int, contact: int, w: Vector, whole: Wholes) -> None:
    """Write an event that changes no mode, after all others of the instant."""
    mode, is_open = (
        whole[whole[MODES] + whole[whole[SLIPS] + contact]],
        whole[whole[OPEN] + contact],
    )
    now = mode_of(contact, mode, is_open, w, whole, whole[Y])
    write_event(guard, contact, now, now, 0.0, w, whole)


def write_turned(flags: int, w: Vector, whole: Wholes) -> None:
    """Write an event for each of the mechanism's switches that an impact or a stop has turned."""
    first = first_own_switch(whole)
    for j in range(whole[N_SWITCHES]):
        if (whole[FLAGS] ^ flags) & (1 << j):
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
    at = whole[CHANGES] + whole[CHANGED] * EVENT_COLUMNS
    flags = whole[FLAGS]
    # Guards between these belong to a law: flags of that law are the ones that explain the event.
    if guard >= first_contact_guard(whole) and guard < first_own_switch(whole):
        flags = whole[whole[LAW_FLAGS] + contact]
    w[at] = w[TIME]
    w[at + 1] = before
    w[at + 2] = after
    w[at + 3] = guard
    w[at + 4] = flags
    w[at + 5] = margin
    w[at + 6] = contact
    whole[CHANGED] += 1


# Answers of a mechanism with several contacts to the questions of the other kernels.


def answer(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Answer one question; whole numbers are left in ANSWER."""
    if name == RATES:
        contact_rates(t, w, whole, at, to)
    elif name == GUARDS_OF:
        contact_guards(t, w, whole, at, to)
    elif name == COLUMNS:
        contact_columns(t, w, whole, at, to)
    elif name == POWERS:
        contact_power(t, w, whole, at, to)
    elif name < STATE_SLOPES:
        answer_of_run(name, t, w, whole, at, to)
    else:
        answer_of_slopes(name, t, w, whole, at, to)


def answer_of_slopes(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write slopes along states, time, or all quantities."""
    states = whole[N_STATES]
    quantities = whole[N_VARIABLES] - states - 1
    if name == STATE_SLOPES:
        rate_slopes_along(0, states, t, w, whole, at, to)
    elif name == TIME_SLOPES:
        rate_slopes_along(states, 1, t, w, whole, at, to)
    elif name == QUANTITY_SLOPES:
        rate_slopes_along(states + 1, quantities, t, w, whole, at, to)
    elif name == GUARD_STATES:
        guard_slopes_along(0, states + 1, t, w, whole, at, to)
    elif name == GUARD_QUANTITIES:
        guard_slopes_along(states + 1, quantities, t, w, whole, at, to)
    elif name == IMPACT_STATES:
        impact_slopes_along(0, states, t, w, whole, at, to)
    elif name == IMPACT_QUANTITIES:
        impact_slopes_along(states + 1, quantities, t, w, whole, at, to)


def answer_of_run(name: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Answer what is asked of the course of a run."""
    if name == SERIES_STEP:
        w[to] = contact_series_step(t, w, whole)
    elif name == SERIES_FROM:
        contact_series(t, w, whole, at)
    elif name == CROSSING:
        whole[ANSWER] = first_contact_crossing(w, whole)
    elif name == CHANGE:
        change_contacts(at, w, whole)
    elif name == SETTLE:
        settle_contacts(w, whole)
    elif name == BOOK:
        book_contacts(w, whole)
    elif name == MOTION:
        note_motion(w, whole)
    elif name == IS_LINEAR:
        whole[ANSWER] = 1 if contacts_are_linear(w, whole) else 0
    elif name == STAYS:
        whole[ANSWER] = 1 if contacts_rest(w, whole) else 0
    else:
        answer_of_start(name, t, w, whole)


def answer_of_start(name: int, t: float, w: Vector, whole: Wholes) -> None:
    """Set what follows from a state at which a run begins, or is taken up again."""
    if name == RESTORE:
        refactor(w, whole)
    elif name == PREPARE:
        prepare(t, w, whole)
    elif name == FIRST_SIZES:
        first_contact_sizes(t, w, whole)
    elif name == BEGIN:
        begin_contacts(w, whole)
