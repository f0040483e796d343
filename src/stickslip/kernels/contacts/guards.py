"""Guards of mechanisms with several contacts, and what of them changes in one instant.

Each coordinate has two: while it slips, its speed in the direction of its mode; while it is held,
the level ahead less the needed friction, and the level back plus it. So have closing slips, and the
cuts of loops, which stand for their directions while these are held. Then each contact has its
law's switches, as far as it slips or has contact inputs, and its load; then come the mechanism's
own switches, what ends the run, which is the determinant of the reactions' equations and the
mechanism's own limits, and the distances from hard stops.
"""

import math

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.contacts.assembly import (
    WITHIN,
    ask_law,
    assemble,
    blur,
    put_motion,
    set_row,
    side_of,
)
from stickslip.kernels.contacts.stops import stop_guards
from stickslip.kernels.directions import slip_rate_along
from stickslip.kernels.enums import BACKWARD, FORWARD, FREE, HELD_FAST
from stickslip.kernels.equations import LAW_MARGINS, LIMITS, MARGINS, evaluate
from stickslip.kernels.guard_roots import UNWATCHED
from stickslip.kernels.mode_transitions import UNMOVED
from stickslip.kernels.state_layout import (
    AFFINE,
    BEFORE,
    BRISTLES,
    CONSTANT_LOADS,
    FIRST_LIMIT,
    FLAGS,
    INPUT_COUNTS,
    KINDS,
    LAW_FLAGS,
    LAW_SWITCHES,
    LAW_VALUES,
    LEVELS,
    LOAD,
    LOOPED,
    MODES,
    MOTION_POINT,
    N_CONTACTS,
    N_LIMITS,
    N_PAIRS,
    N_REACTIONS,
    N_SWITCHES,
    NEEDED,
    OPEN,
    PIVOT,
    REACHED,
    REACTS,
    SLIPS,
    TIME,
    Y,
)

LEAST_PIVOT = 1e-6
"""Determinant of the reactions at which a run ends, 1 being that without friction."""


def first_contact_guard(whole: Wholes) -> int:
    """Return the index of the first guard of the contacts, behind those of directions and cuts."""
    return 2 * whole[N_PAIRS]


def first_own_switch(whole: Wholes) -> int:
    """Return the index of the guard of the mechanism's first switch."""
    return first_contact_guard(whole) + whole[N_CONTACTS] * (whole[LAW_SWITCHES] + 1)


def contact_guards(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write all guards at a state."""
    n, modes = whole[N_PAIRS], whole[MODES]
    assemble(t, w, whole, at)
    for i in range(n):
        mode = whole[modes + i]
        w[to + 2 * i] = UNWATCHED
        w[to + 2 * i + 1] = UNWATCHED
        if mode in (FORWARD, BACKWARD):
            w[to + 2 * i] = mode * slip_rate_along(i, at, w, whole)
        elif mode == HELD_FAST and not whole[whole[LOOPED] + i]:
            needed, levels = w[whole[NEEDED] + i], whole[LEVELS] + 2 * i
            spare = blur(i, w, whole)
            if w[levels] < math.inf:
                w[to + 2 * i] = w[levels] * (1.0 + WITHIN) + spare - needed
            if w[levels + 1] < math.inf:
                w[to + 2 * i + 1] = w[levels + 1] * (1.0 + WITHIN) + spare + needed
    for c in range(whole[N_CONTACTS]):
        own_guards(c, t, w, whole, at, to + 2 * n + c * (whole[LAW_SWITCHES] + 1))
    if whole[N_SWITCHES] > 0:
        values = whole[LAW_VALUES]
        evaluate(MARGINS, 0, whole[FLAGS], t, w, at, values)
        place = to + first_own_switch(whole)
        for j in range(whole[N_SWITCHES]):
            margin = w[values + j]
            w[place + j] = margin if whole[FLAGS] & (1 << j) else -margin
    if whole[N_LIMITS] > 0:
        limits_at(t, w, whole, at, to + whole[FIRST_LIMIT])
    stop_guards(w, whole, at, to, UNWATCHED)


def limits_at(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write what ends a run as it falls below 0, at a state of which everything is worked out."""
    pivots = 1 if whole[N_REACTIONS] > 0 else 0
    if pivots > 0:
        w[to] = w[PIVOT] - LEAST_PIVOT
    if whole[N_LIMITS] > pivots:
        put_motion(w, whole, at)
        evaluate(LIMITS, 0, whole[FLAGS], t, w, whole[MOTION_POINT], to + pivots)


def contacts_are_linear(w: Vector, whole: Wholes) -> bool:
    """Whether all equations are affine in states and time in the modes at hand."""
    if not whole[AFFINE]:
        return False
    linear = True
    for c in range(whole[N_CONTACTS]):
        mode = whole[whole[MODES] + whole[whole[SLIPS] + c]]
        if whole[whole[BRISTLES] + c] >= 0 and not whole[whole[OPEN] + c]:
            linear = False
        if mode in (FORWARD, BACKWARD) and not whole[whole[OPEN] + c]:
            ask_law(c, side_of(c, w, whole, whole[Y]), w[TIME], w, whole, whole[Y])
            linear = linear and w[whole[LAW_VALUES] + 6] > 0.0
            linear = linear and not has_switches(c, w[TIME], w, whole, whole[Y])
    return linear


def own_guards(contact: int, t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write the guards of one contact: its law's switches, its load."""
    switches = whole[LAW_SWITCHES]
    for j in range(switches + 1):
        w[to + j] = UNWATCHED
    if not whole[CONSTANT_LOADS] or whole[whole[REACTS] + contact]:
        load = w[whole[LOAD] + contact]
        w[to + switches] = -load if whole[whole[OPEN] + contact] else load
    mode = whole[whole[MODES] + whole[whole[SLIPS] + contact]]
    if switches > 0 and watches(contact, mode, whole):
        flags = whole[whole[LAW_FLAGS] + contact]
        law_margins(contact, flags, t, w, whole, at, UNWATCHED)
        for j in range(switches):
            margin = w[whole[LAW_VALUES] + j]
            w[to + j] = margin if flags & (1 << j) else -margin


def watches(contact: int, mode: int, whole: Wholes) -> bool:
    """Whether the switches of a contact's law may turn in a mode of its coordinate.

    At rest those turn that depend on contact inputs, such as the sign of a torque.
    """
    if mode == HELD_FAST:
        return whole[whole[INPUT_COUNTS] + contact] > 0
    return mode in (FORWARD, BACKWARD)


def has_switches(contact: int, t: float, w: Vector, whole: Wholes, at: int) -> bool:
    """Whether a contact's law has switches, which the series of exact modes does not watch."""
    if whole[LAW_SWITCHES] == 0:
        return False
    law_margins(contact, whole[whole[LAW_FLAGS] + contact], t, w, whole, at, math.nan)
    return not math.isnan(w[whole[LAW_VALUES]])


def law_margins(
    contact: int, flags: int, t: float, w: Vector, whole: Wholes, at: int, absent: float
) -> None:
    """Write the margins of the switches of a contact's law, positive where they hold."""
    side = side_of(contact, w, whole, at)
    row = set_row(contact, side, w, whole, at)
    kind = whole[whole[KINDS] + contact]
    values = whole[LAW_VALUES]
    for j in range(whole[LAW_SWITCHES]):
        w[values + j] = absent
    evaluate(LAW_MARGINS + kind, side, flags, t, w, row, values)


def law_flags(t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Set the flags of all laws, nested switches included.

    The flags of what slipped before turn only where a margin has jumped beyond rounding: at a
    threshold, the next step shows to which side it is left. Those of what is held are as at rest,
    for decisions ask with which friction it would begin to slip.
    """
    switches = whole[LAW_SWITCHES]
    for c in range(whole[N_CONTACTS] if switches > 0 else 0):
        i = whole[whole[SLIPS] + c]
        mode = whole[whole[MODES] + i]
        if mode == FREE:
            continue
        share = UNMOVED
        kept = mode == whole[whole[BEFORE] + i]
        if not kept or (mode == HELD_FAST and not watches(c, mode, whole)):
            whole[whole[LAW_FLAGS] + c] = 0
            share = 0.0
        reached = whole[REACHED] + first_contact_guard(whole) + c * (switches + 1)
        for _ in range(switches):
            before = whole[whole[LAW_FLAGS] + c]
            law_margins(c, before, t, w, whole, at, UNWATCHED)
            flags = 0
            for j in range(switches):
                margin, rounding = w[whole[LAW_VALUES] + j], share * w[reached + j]
                if margin > rounding or (before & (1 << j) and margin >= -rounding):
                    flags |= 1 << j
            whole[whole[LAW_FLAGS] + c] = flags
