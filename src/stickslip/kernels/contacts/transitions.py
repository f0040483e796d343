"""What changes at an event of a mechanism with several contacts: all that fires in one instant."""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.contacts.assembly import prepare, refresh
from stickslip.kernels.contacts.decisions import decide
from stickslip.kernels.contacts.guards import (
    LEAST_PIVOT,
    contact_guards,
    first_contact_guard,
    first_own_switch,
    law_flags,
)
from stickslip.kernels.enums import (
    BACKWARD,
    EXACT,
    FORWARD,
    FREE,
    HELD_FAST,
    LIFTED_OFF,
    LIMITED,
    UNLOADED,
)
from stickslip.kernels.equations import LOADS, MARGINS, evaluate
from stickslip.kernels.guard_roots import NO_GUARD
from stickslip.kernels.state_layout import (
    BEFORE,
    CANDIDATES,
    CHANGED,
    CHANGES,
    CLOSED,
    CONSTANT_LOADS,
    EVENT_COLUMNS,
    FIRST_LIMIT,
    FLAGS,
    FORCED,
    FRACTION,
    LAW_FLAGS,
    LAW_SWITCHES,
    LENGTH,
    LEVELS,
    LOAD,
    MODES,
    N_CONTACTS,
    N_COORDINATES,
    N_LIMITS,
    N_SWITCHES,
    NEEDED,
    OPEN,
    PIVOT,
    REACHED,
    REACTS,
    RIGID,
    ROOTS,
    SLIP_FACTORS,
    SLIPS,
    STATUS,
    STEPPER,
    TIME,
    VALUES,
    Y,
)

__all__ = ["begin_contacts", "change_contacts", "settle_contacts"]

OF_MODES = -1
"""Guard of an event in which modes change, in its record, less the guard that fell first."""
TOGETHER = 4e-15
"""Time between two falls that are one, over the larger of the present time and the step."""
REACHED_ZERO = 1e-13
"""Share of its largest value below which a guard has fallen too, where it is sampled."""


def begin_contacts(w: Vector, whole: Wholes) -> None:
    """Set modes, flags and openings for the state at which a run begins.

    Parameters
    ----------
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    """
    n, y = whole[N_COORDINATES], whole[Y]
    for _ in range(whole[N_SWITCHES]):
        set_own_flags(w, whole)
    prepare(w[TIME], w, whole)
    for i in range(n):
        whole[whole[MODES] + i] = FREE
    for c in range(whole[N_CONTACTS]):
        closed = whole[whole[REACTS] + c] or w[whole[LOAD] + c] > 0.0
        whole[whole[OPEN] + c] = 0 if closed else 1
        whole[whole[LAW_FLAGS] + c] = 0
        if closed:
            i = whole[whole[SLIPS] + c]
            rate = w[y + n + i]
            whole[whole[MODES] + i] = FORWARD if rate > 0.0 else (BACKWARD if rate < 0.0 else 0)
    only_bristles(whole)
    law_flags(w[TIME], w, whole, y)
    remember(whole)
    none_forced(whole)
    settle_modes(w, whole)
    for i in range(n):
        whole[whole[BEFORE] + i] = whole[whole[MODES] + i]
    whole[CHANGED] = 0
    for c in range(whole[N_CONTACTS]):
        pulls = whole[whole[REACTS] + c] and w[whole[LOAD] + c] < 0.0
        if pulls and whole[STATUS] != LIFTED_OFF:
            lift_off(lift_guard(c, whole), c, w, whole)


def set_own_flags(w: Vector, whole: Wholes) -> None:
    """Set the flags of the mechanism's own switches."""
    values = whole[VALUES]
    evaluate(MARGINS, 0, whole[FLAGS], w[TIME], w, whole[Y], values)
    whole[FLAGS] = 0
    for j in range(whole[N_SWITCHES]):
        if w[values + j] > 0.0:
            whole[FLAGS] |= 1 << j


def only_bristles(whole: Wholes) -> None:
    """Let coordinates slip that nothing but bristles holds: their forces need no decision."""
    for i in range(whole[N_COORDINATES]):
        if whole[whole[MODES] + i] == HELD_FAST and not whole[whole[RIGID] + i]:
            whole[whole[MODES] + i] = FORWARD


def remember(whole: Wholes) -> None:
    """Keep the modes and openings before a change."""
    for i in range(whole[N_COORDINATES]):
        whole[whole[BEFORE] + i] = whole[whole[MODES] + i]
    for c in range(whole[N_CONTACTS]):
        whole[whole[CLOSED] + c] = 1 - whole[whole[OPEN] + c]


def none_forced(whole: Wholes) -> None:
    """Begin a decision: nothing is forced to slip."""
    for i in range(whole[N_COORDINATES]):
        whole[whole[FORCED] + i] = 0


def settle_modes(w: Vector, whole: Wholes) -> None:
    """Decide all coordinates that are held, or stopped; set what follows from the answer."""
    for i in range(whole[N_COORDINATES]):
        held = whole[whole[MODES] + i] == HELD_FAST
        whole[whole[CANDIDATES] + i] = 1 if held else 0
    solved = decide(w, whole)
    if not solved or (whole[N_LIMITS] > 0 and w[PIVOT] < LEAST_PIVOT):
        whole[STATUS] = LIMITED
    if whole[LAW_SWITCHES] > 0:
        law_flags(w[TIME], w, whole, whole[Y])
        refresh(w[TIME], w, whole, whole[Y])


def open_and_close(w: Vector, whole: Wholes) -> None:
    """Let loads that jumped open or close their contacts, and coordinates follow."""
    if not whole[CONSTANT_LOADS]:
        evaluate(LOADS, 0, whole[FLAGS], w[TIME], w, whole[Y], whole[LOAD])
        for c in range(whole[N_CONTACTS]):
            if not whole[whole[REACTS] + c]:
                load = w[whole[LOAD] + c]
                if load > 0.0:
                    whole[whole[OPEN] + c] = 0
                else:
                    whole[whole[OPEN] + c] = 1
    follow_openings(w, whole)


def follow_openings(w: Vector, whole: Wholes) -> None:
    """Free coordinates whose contacts are all open; take up those with one that has closed."""
    n = whole[N_COORDINATES]
    for i in range(n):
        rubs = False
        for c in range(whole[N_CONTACTS]):
            rubs = rubs or (whole[whole[SLIPS] + c] == i and not whole[whole[OPEN] + c])
        if not rubs:
            whole[whole[MODES] + i] = FREE
        elif whole[whole[MODES] + i] == FREE:
            rate = w[whole[Y] + n + i]
            whole[whole[MODES] + i] = FORWARD if rate > 0.0 else (BACKWARD if rate < 0.0 else 0)
    only_bristles(whole)


def settle_contacts(w: Vector, whole: Wholes) -> None:
    """Decide anew after a jump of forces or loads, and write down what changes.

    Parameters
    ----------
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    """
    whole[CHANGED] = 0
    remember(whole)
    open_and_close(w, whole)
    none_forced(whole)
    settle_modes(w, whole)
    write_changes(NO_GUARD, w, whole)


def change_contacts(guard: int, w: Vector, whole: Wholes) -> None:
    """Make all changes of an instant, of which `guard` is the first.

    Parameters
    ----------
    guard : int
        Index of the guard.
    w : array (SIZE,)
        Vector of the run.
    whole : array (WHOLES,)
        Whole numbers of the run.
    """
    whole[CHANGED] = 0
    if guard >= whole[FIRST_LIMIT]:
        whole[STATUS] = LIMITED + guard - whole[FIRST_LIMIT]
        write_event(guard, 0, 0, 0, 0.0, w, whole)
        return
    remember(whole)
    none_forced(whole)
    exact = whole[STEPPER] == EXACT
    if not exact:
        contact_guards(w[TIME], w, whole, whole[Y], whole[VALUES])
    for other in range(first_contact_guard(whole)):
        if other == guard or fires_too(other, exact, w, whole):
            stop_or_break(other, w, whole)
    lifted = -1
    if guard >= first_own_switch(whole):
        switch = guard - first_own_switch(whole)
        whole[FLAGS] ^= 1 << switch
        write_event(guard, 0, 0, 0, 0.0, w, whole)
        open_and_close(w, whole)  # loads may jump with the switch
    elif guard >= first_contact_guard(whole):
        lifted = switch_or_open(guard, w, whole)
    else:
        for _ in range(whole[N_SWITCHES]):
            set_own_flags(w, whole)  # a rate that was set to 0 may be what a switch asks for
    if not whole[CONSTANT_LOADS]:
        follow_openings(w, whole)
    settle_modes(w, whole)
    write_changes(guard, w, whole)
    if lifted >= 0:  # after what falls with it: the last event is what ends the run
        lift_off(guard, lifted, w, whole)


def lift_guard(contact: int, whole: Wholes) -> int:
    """Return the guard of the load of a contact."""
    wide = whole[LAW_SWITCHES] + 1
    return first_contact_guard(whole) + contact * wide + whole[LAW_SWITCHES]


def lift_off(guard: int, contact: int, w: Vector, whole: Wholes) -> None:
    """End the run where a contact lifts off."""
    now = mode_of(contact, whole[whole[MODES] + whole[whole[SLIPS] + contact]], 0, w, whole)
    write_event(guard, contact, now, now, 0.0, w, whole)
    whole[STATUS] = LIFTED_OFF


def fires_too(guard: int, exact: bool, w: Vector, whole: Wholes) -> bool:
    """Whether a guard of a coordinate falls in the instant at hand, too."""
    if exact:
        h = w[LENGTH]
        return w[whole[ROOTS] + guard] <= w[FRACTION] + TOGETHER * max(abs(w[TIME]), h) / h
    size = w[whole[REACHED] + guard]
    return size > 0.0 and w[whole[VALUES] + guard] <= REACHED_ZERO * size


def stop_or_break(guard: int, w: Vector, whole: Wholes) -> None:
    """Stop a coordinate that slips, or let one go that is held."""
    i = guard // 2
    mode = whole[whole[MODES] + i]
    if mode == HELD_FAST:
        whole[whole[FORCED] + i] = FORWARD if guard % 2 == 0 else BACKWARD
    elif mode in (FORWARD, BACKWARD) and guard % 2 == 0:
        if whole[whole[RIGID] + i]:
            w[whole[Y] + whole[N_COORDINATES] + i] = 0.0
            whole[whole[MODES] + i] = HELD_FAST
        else:
            whole[whole[MODES] + i] = -mode


def switch_or_open(guard: int, w: Vector, whole: Wholes) -> int:
    """Turn a switch of a law, or open or close a contact; return what lifts off, or -1."""
    wide = whole[LAW_SWITCHES] + 1
    contact, which = divmod(guard - first_contact_guard(whole), wide)
    if which < whole[LAW_SWITCHES]:
        whole[whole[LAW_FLAGS] + contact] ^= 1 << which
        write_event(guard, contact, 0, 0, 0.0, w, whole)
        return -1
    if whole[whole[REACTS] + contact]:
        return contact
    whole[whole[OPEN] + contact] = 1 - whole[whole[OPEN] + contact]
    return -1


def mode_of(contact: int, coordinate_mode: int, is_open: int, w: Vector, whole: Wholes) -> int:
    """Return the mode of a contact, which may slip against its coordinate."""
    if is_open or coordinate_mode == FREE:
        return UNLOADED
    return coordinate_mode if w[whole[SLIP_FACTORS] + contact] > 0.0 else -coordinate_mode


def write_changes(guard: int, w: Vector, whole: Wholes) -> None:
    """Write an event for each contact whose mode has changed, in their order."""
    for c in range(whole[N_CONTACTS]):
        i = whole[whole[SLIPS] + c]
        before = mode_of(c, whole[whole[BEFORE] + i], 1 - whole[whole[CLOSED] + c], w, whole)
        after = mode_of(c, whole[whole[MODES] + i], whole[whole[OPEN] + c], w, whole)
        if before != after:
            margin = 0.0
            if after == HELD_FAST:
                needed = w[whole[NEEDED] + i]
                back = 0 if needed >= 0.0 else 1
                margin = w[whole[LEVELS] + 2 * i + back] - abs(needed)
            write_event(OF_MODES - 1 - guard, c, before, after, margin, w, whole)


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
