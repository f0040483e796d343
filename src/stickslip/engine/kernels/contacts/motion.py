"""Motion of several contacts in given modes: rates, work, rest, and the guards that end them.

Rates of coordinates are what states say, 0 where they are held; accelerations and rates of bristles
are those of `assembly`. Guards g stay at 0 or above while the modes hold:

    slip:           s q'_i              (s the direction; closing slips and cuts of loops likewise)
    held:           L_i+ - r_i  and  L_i- + r_i         (levels, needed friction)
    each contact:   its load; margins of its law's switches, as far as it slips or has inputs
    all:            margins of the mechanism's switches; PIVOT of the reactions, own limits;
                    distances from hard stops

Levels have an allowance for rounding, the same as in decisions, so that what a decision holds does
not fall at once.

Work is a quadrature over the part of a step that holds: of each contact F_c v_c, and of drives. In
exact modes friction of a contact is a constant and a damping, F = F_0 + d (v - v_0), whose work is
(F_0 - d v_0) times the slip and the integral of d v^2.

A rest is final where all is held and no drive can move it. Needed friction is affine in the drives,
so that it is largest at a corner of the box of what they may do from now on; all corners are tried.
"""

import math

from stickslip.engine.kernels.backend import Vector, Wholes
from stickslip.engine.kernels.contacts.assembly import (
    WITHIN,
    ask_law,
    assemble,
    blur,
    finite,
    put_motion,
    set_row,
    side_of,
    stop_guards,
    stopped_side,
)
from stickslip.engine.kernels.equations import (
    EFFORTS,
    LAW_MARGINS,
    LIMITS,
    MARGINS,
    POWER,
    REST,
    combined,
    evaluate,
    slip_rate_along,
)
from stickslip.engine.kernels.guard_roots import UNWATCHED
from stickslip.engine.kernels.mode_transitions import UNMOVED
from stickslip.engine.kernels.numerics import FEW_NODES, FEW_WEIGHTS, NODES, WEIGHTS, interpolate
from stickslip.engine.kernels.state_layout import (
    ACCELERATION,
    AFFINE,
    BACKWARD,
    BEFORE,
    BOX,
    BRISTLE_RATES,
    BRISTLES,
    CONSTANT_LOADS,
    DAMPING,
    DENSE,
    DIAGONAL,
    EXACT,
    FIRST_LIMIT,
    FLAGS,
    FORCE,
    FORWARD,
    FRACTION,
    FREE,
    FRICTION,
    GIVEN,
    GROSS,
    HAS_BRISTLES,
    HELD_FAST,
    INPUT_COUNTS,
    KINDS,
    LAW_FLAGS,
    LAW_SWITCHES,
    LAW_VALUES,
    LENGTH,
    LEVELS,
    LIVELIEST,
    LOAD,
    LOOPED,
    MASS,
    MODES,
    MOTION_POINT,
    N_CHANNELS,
    N_CONTACTS,
    N_COORDINATES,
    N_DRIVES,
    N_LIMITS,
    N_PAIRS,
    N_REACTIONS,
    N_STATES,
    N_SWITCHES,
    NEEDED,
    NEEDED_SERIES,
    OPEN,
    PIVOT,
    POINT,
    REACHED,
    REACTS,
    REST_IS_FINAL,
    SCALE,
    SLIP_FACTORS,
    SLIPS,
    STEPPER,
    SUPPLIED,
    SUPPLIES,
    TAKEN,
    TIME,
    UNLOADED,
    VALUES,
    WORKS,
    Y,
)

# Guards of mechanisms with several contacts, and what of them changes in one instant.
#
# Each coordinate has two: while it slips, its speed in the direction of its mode; while it is held,
# the level ahead less the needed friction, and the level back plus it. So have closing slips, and
# the cuts of loops, which stand for their directions while these are held. Then each contact has
# its law's switches, as far as it slips or has contact inputs, and its load; then come the
# mechanism's own switches, what ends the run, which is the determinant of the reactions' equations
# and the mechanism's own limits, and the distances from hard stops.

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
            # Towards a stop the level is infinite: nothing falls on that side.
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
            # A guard falls where the margin crosses its threshold, from whichever side it is now.
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
        # Rates of bristles are not affine in the speed.
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
        # Of an open contact the load has to stay below 0: its guard falls as it closes.
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


# What steppers ask of a mechanism with several contacts: rates, sizes, work, rest.

MODEST = 1e-3
"""Least speed that counts, over that which the largest kinetic energy would give a coordinate."""
BEGINNING_SHARE = 1e-6
"""Least speed that counts at the start, over what the forces at hand give in a run."""
FAINT = 1e-8
"""Least part of that speed where a motion is at hand whose own speeds are smaller."""
SHORT_SERIES = 6
"""A series that ends so early is that of a very short step, over which few nodes do."""


def contact_rates(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write the time derivatives of the states."""
    n = whole[N_COORDINATES]
    assemble(t, w, whole, at)
    for i in range(n):
        # Places follow rates as the state has them: what is held has rate 0 exactly.
        w[to + i] = w[at + n + i]
        w[to + n + i] = w[whole[ACCELERATION] + i]
    for k in range(whole[N_STATES] - 2 * n):
        w[to + 2 * n + k] = w[whole[BRISTLE_RATES] + k]


def contact_columns(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write friction, then load, then mode of each contact, then efforts of guided coordinates."""
    contacts = whole[N_CONTACTS]
    assemble(t, w, whole, at)
    for c in range(contacts):
        w[to + c] = w[whole[FRICTION] + c]
        w[to + contacts + c] = 0.0 if whole[whole[OPEN] + c] else w[whole[LOAD] + c]
        mode = whole[whole[MODES] + whole[whole[SLIPS] + c]]
        w[to + 2 * contacts + c] = mode_of(c, mode, whole[whole[OPEN] + c], w, whole, at)
    if whole[N_CHANNELS] > 0:
        put_motion(w, whole, at)
        evaluate(EFFORTS, 0, whole[FLAGS], t, w, whole[MOTION_POINT], to + 3 * contacts)


def mode_of(
    contact: int, coordinate_mode: int, is_open: int, w: Vector, whole: Wholes, at: int
) -> int:
    """Return the mode of a contact, which may slip against its coordinate."""
    if is_open or coordinate_mode == FREE:
        return UNLOADED
    mode = coordinate_mode
    if mode == HELD_FAST:
        mode = 2 * stopped_side(whole[whole[SLIPS] + contact], w, whole, at)
    # a contact may slip against its coordinate
    return mode if w[whole[SLIP_FACTORS] + contact] > 0.0 else -mode


def contact_power(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write the power supplied and that taken by friction."""
    assemble(t, w, whole, at)
    supply(t, w, whole, at, to)
    w[to + 1] = 0.0
    for c in range(whole[N_CONTACTS]):
        w[to + 1] += w[whole[FRICTION] + c] * slip_rate(c, w, whole, at)


def supply(t: float, w: Vector, whole: Wholes, at: int, to: int) -> None:
    """Write the power supplied; that of guides asks for accelerations, which are worked out."""
    if whole[N_CHANNELS] > 0:
        put_motion(w, whole, at)  # with the accelerations behind the state
        at = whole[MOTION_POINT]
    evaluate(POWER, 0, whole[FLAGS], t, w, at, to)


def slip_rate(contact: int, w: Vector, whole: Wholes, at: int) -> float:
    """Return the slip velocity of a contact."""
    i = whole[whole[SLIPS] + contact]
    return w[whole[SLIP_FACTORS] + contact] * slip_rate_along(i, at, w, whole)


def largest_pull(t: float, w: Vector, whole: Wholes) -> float:
    """Return the largest acceleration that forces and friction at a time give the present state."""
    n = whole[N_COORDINATES]
    assemble(t, w, whole, whole[Y])
    largest = 0.0
    for i in range(n):
        # A stop pulls nothing: only what friction can do gives a size.
        level = max(finite(w[whole[LEVELS] + 2 * i]), finite(w[whole[LEVELS] + 2 * i + 1]))
        pull = abs(w[whole[FORCE] + i]) + level
        largest = max(largest, pull / w[whole[MASS] + i * n + i])
    return largest


def first_contact_sizes(t_end: float, w: Vector, whole: Wholes) -> None:
    """Set the sizes at the start; what is at rest has those that the forces at hand give.

    Where there are none yet, the forces at the end of the run count, as the drives go on now. Where
    something moves, forces may be those that stop it at once: what it moves with counts then.
    """
    n, states, y, scale = whole[N_COORDINATES], whole[N_STATES], whole[Y], whole[SCALE]
    largest = largest_pull(w[TIME], w, whole)
    # At the start nothing may act yet: a drive that begins at 0 acts later.
    if largest == 0.0:
        largest = largest_pull(t_end, w, whole)
        assemble(w[TIME], w, whole, y)
    for i in range(states):
        w[scale + i] = abs(w[y + i])
    span = t_end - w[TIME]
    speed, fastest = BEGINNING_SHARE * largest * span, 0.0
    w[LIVELIEST] = 0.0
    note_motion(w, whole)
    for i in range(n):
        own = speed
        if w[LIVELIEST] > 0.0:
            own = max(FAINT * speed, min(speed, w[scale + n + i]))
        fastest = max(fastest, own)
        w[scale + n + i] = max(w[scale + n + i], own)
        w[scale + i] = max(w[scale + i], BEGINNING_SHARE * w[scale + n + i] * span)
    for i in range(2 * n, states):  # bristles, which bend far less than bodies move
        bent = BEGINNING_SHARE * BEGINNING_SHARE * fastest * span
        w[scale + i] = max(w[scale + i], bent)


def note_motion(w: Vector, whole: Wholes) -> None:
    """Give every rate a size: a small part of what the largest kinetic energy would give it.

    A coordinate that starts from rest has no size of its own yet.
    """
    n, mass, rates = whole[N_COORDINATES], whole[MASS], whole[Y] + whole[N_COORDINATES]
    energy = 0.0
    for i in range(n):
        # q' M q' over the rows of one triangle, the other half doubled: twice the kinetic energy.
        row = w[mass + i * n + i] * w[rates + i]
        if not whole[DIAGONAL]:
            for j in range(i):
                row += 2.0 * w[mass + i * n + j] * w[rates + j]
        energy += row * w[rates + i]
    w[LIVELIEST] = max(w[LIVELIEST], energy)
    size = whole[SCALE] + n
    for i in range(n):
        # The speed that all of that energy would give this coordinate alone.
        least = MODEST * math.sqrt(w[LIVELIEST] / w[mass + i * n + i])
        w[size + i] = max(w[size + i], least)


def book_contacts(w: Vector, whole: Wholes) -> None:
    """Add the work done in the part of the step that holds.

    In an exact mode a contact's friction is a constant and its damping: the work of the former is
    that constant times the slip.
    """
    exact = whole[STEPPER] == EXACT
    if exact:
        for c in range(whole[N_CONTACTS]):
            if whole[whole[MODES] + whole[whole[SLIPS] + c]] in (FORWARD, BACKWARD):
                book_slip(c, w, whole)
    if exact and not whole[SUPPLIES]:
        return
    share, h, point, values = w[FRACTION], w[LENGTH], whole[POINT], whole[VALUES]
    few = 0.0 < w[whole[DENSE]] <= SHORT_SERIES
    for node in range(len(FEW_NODES) if few else len(NODES)):
        x = share * (FEW_NODES[node] if few else NODES[node])
        weight = share * h * (FEW_WEIGHTS[node] if few else WEIGHTS[node])
        interpolate(w, whole, x, point)
        if exact:
            if whole[N_CHANNELS] > 0:
                assemble(w[TIME] + x * h, w, whole, point)
            supply(w[TIME] + x * h, w, whole, point, values)
        else:
            contact_power(w[TIME] + x * h, w, whole, point, values)
            for c in range(whole[N_CONTACTS]):
                own = w[whole[FRICTION] + c] * slip_rate(c, w, whole, point)
                w[whole[WORKS] + c] += weight * own
                w[TAKEN] += weight * own
                w[GROSS] += weight * abs(own)
        w[SUPPLIED] += weight * w[values]
        w[GROSS] += weight * abs(w[values])


def book_slip(contact: int, w: Vector, whole: Wholes) -> None:
    """Add the work of a contact that slips in an exact mode."""
    i, factor = whole[whole[SLIPS] + contact], w[whole[SLIP_FACTORS] + contact]
    n, states, dense = whole[N_COORDINATES], whole[N_STATES], whole[DENSE] + 1
    share, h = w[FRACTION], w[LENGTH]
    terms = int(w[whole[DENSE]])
    damping = w[whole[DAMPING] + contact]
    # Slip is a sum of terms, so that the work of a constant friction needs no quadrature.
    slip, power = 0.0, 1.0
    if i < n:
        for k in range(1, terms + 1):
            power *= share
            slip += w[dense + k * states + i] * power
        rates, width = dense + n + i, states
    else:
        for k in range(1, terms + 1):
            power *= share
            slip += combined(i, dense + k * states, w, whole) * power
        rates, width = whole[NEEDED_SERIES] + i, whole[N_PAIRS]
    # Friction is F_0 + d (v - v_0): what is constant of it times the slip, then d v^2 by
    # quadrature.
    work = (factor * w[whole[FRICTION] + contact] - damping * w[rates]) * slip
    if damping != 0.0:
        for node in range(len(NODES)):
            x = share * NODES[node]
            rate = w[rates + terms * width]
            for k in range(terms - 1, -1, -1):
                rate = rate * x + w[rates + k * width]
            work += WEIGHTS[node] * share * h * damping * rate * rate
    w[whole[WORKS] + contact] += work
    w[TAKEN] += work
    w[GROSS] += abs(work)


def contacts_rest(w: Vector, whole: Wholes) -> bool:
    """Whether all coordinates are held and no drive can move any of them any more.

    The needed friction is affine in the drives: it is largest at a corner of what they may do from
    now on, which stands in BOX.
    """
    n, drives, values = whole[N_COORDINATES], whole[N_DRIVES], whole[VALUES]
    if not whole[REST_IS_FINAL] or whole[HAS_BRISTLES]:  # bristles push and relax
        return False
    for i in range(n):
        if whole[whole[MODES] + i] != HELD_FAST:
            return False
    for corner in range(1 << drives):
        for k in range(drives):
            bound = w[whole[BOX] + 2 * k + ((corner >> k) & 1)]
            w[whole[GIVEN] + k] = bound
            # A drive without a bound can move anything.
            if not abs(bound) < math.inf:
                return False
        evaluate(REST, 0, whole[FLAGS], w[TIME], w, whole[Y], values)
        for i in range(whole[N_PAIRS]):
            force = combined(i, values, w, whole)
            # the friction that would be needed, against the level on its side
            level = w[whole[LEVELS] + 2 * i + (0 if force >= 0.0 else 1)]
            if abs(force) > level and not whole[whole[LOOPED] + i]:
                return False
    return True
