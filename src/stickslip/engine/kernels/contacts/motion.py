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

from stickslip.engine.kernels import equations
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector
from stickslip.engine.kernels.contacts import assembly
from stickslip.engine.kernels.guard_roots import UNWATCHED
from stickslip.engine.kernels.mode_transitions import UNMOVED
from stickslip.engine.kernels.numerics import FEW_NODES, FEW_WEIGHTS, NODES, WEIGHTS, interpolate

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


def first_contact_guard(iw: IntVector) -> int:
    """Return the index of the first guard of the contacts, behind those of directions and cuts."""
    return 2 * iw[layout.N_PAIRS]


def first_own_switch(iw: IntVector) -> int:
    """Return the index of the guard of the mechanism's first switch."""
    return first_contact_guard(iw) + iw[layout.N_CONTACTS] * (iw[layout.LAW_SWITCHES] + 1)


def contact_guards(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write all guards at a state."""
    n, modes = iw[layout.N_PAIRS], iw[layout.MODES]
    assembly.assemble(t, w, iw, at)
    for i in range(n):
        mode = iw[modes + i]
        w[to + 2 * i] = UNWATCHED
        w[to + 2 * i + 1] = UNWATCHED
        if mode in (layout.FORWARD, layout.BACKWARD):
            w[to + 2 * i] = mode * equations.slip_rate_along(i, at, w, iw)
        elif mode == layout.HELD_FAST and not iw[iw[layout.LOOPED] + i]:
            needed, levels = w[iw[layout.NEEDED] + i], iw[layout.LEVELS] + 2 * i
            spare = assembly.blur(i, w, iw)
            # Towards a stop the level is infinite: nothing falls on that side.
            if w[levels] < math.inf:
                w[to + 2 * i] = w[levels] * (1.0 + assembly.WITHIN) + spare - needed
            if w[levels + 1] < math.inf:
                w[to + 2 * i + 1] = w[levels + 1] * (1.0 + assembly.WITHIN) + spare + needed
    for c in range(iw[layout.N_CONTACTS]):
        own_guards(c, t, w, iw, at, to + 2 * n + c * (iw[layout.LAW_SWITCHES] + 1))
    if iw[layout.N_SWITCHES] > 0:
        values = iw[layout.LAW_VALUES]
        equations.evaluate(equations.MARGINS, 0, iw[layout.FLAGS], t, w, at, values)
        place = to + first_own_switch(iw)
        for j in range(iw[layout.N_SWITCHES]):
            margin = w[values + j]
            # A guard falls where the margin crosses its threshold, from whichever side it is now.
            w[place + j] = margin if iw[layout.FLAGS] & (1 << j) else -margin
    if iw[layout.N_LIMITS] > 0:
        limits_at(t, w, iw, at, to + iw[layout.FIRST_LIMIT])
    assembly.stop_guards(w, iw, at, to, UNWATCHED)


def limits_at(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write what ends a run as it falls below 0, at a state of which everything is worked out."""
    pivots = 1 if iw[layout.N_REACTIONS] > 0 else 0
    if pivots > 0:
        w[to] = w[layout.PIVOT] - LEAST_PIVOT
    if iw[layout.N_LIMITS] > pivots:
        assembly.put_motion(w, iw, at)
        equations.evaluate(
            equations.LIMITS, 0, iw[layout.FLAGS], t, w, iw[layout.MOTION_POINT], to + pivots
        )


def contacts_are_linear(w: Vector, iw: IntVector) -> bool:
    """Whether all equations are affine in states and time in the modes at hand."""
    if not iw[layout.AFFINE]:
        return False
    linear = True
    for c in range(iw[layout.N_CONTACTS]):
        mode = iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + c]]
        # Rates of bristles are not affine in the speed.
        if iw[iw[layout.BRISTLES] + c] >= 0 and not iw[iw[layout.OPEN] + c]:
            linear = False
        if mode in (layout.FORWARD, layout.BACKWARD) and not iw[iw[layout.OPEN] + c]:
            assembly.ask_law(
                c,
                assembly.side_of(c, w, iw, iw[layout.Y]),
                w[layout.TIME],
                w,
                iw,
                iw[layout.Y],
            )
            linear = linear and w[iw[layout.LAW_VALUES] + 6] > 0.0
            linear = linear and not has_switches(c, w[layout.TIME], w, iw, iw[layout.Y])
    return linear


def own_guards(contact: int, t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write the guards of one contact: its law's switches, its load."""
    switches = iw[layout.LAW_SWITCHES]
    for j in range(switches + 1):
        w[to + j] = UNWATCHED
    if not iw[layout.CONSTANT_LOADS] or iw[iw[layout.REACTS] + contact]:
        load = w[iw[layout.LOAD] + contact]
        # Of an open contact the load has to stay below 0: its guard falls as it closes.
        w[to + switches] = -load if iw[iw[layout.OPEN] + contact] else load
    mode = iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + contact]]
    if switches > 0 and watches(contact, mode, iw):
        flags = iw[iw[layout.LAW_FLAGS] + contact]
        law_margins(contact, flags, t, w, iw, at, UNWATCHED)
        for j in range(switches):
            margin = w[iw[layout.LAW_VALUES] + j]
            w[to + j] = margin if flags & (1 << j) else -margin


def watches(contact: int, mode: int, iw: IntVector) -> bool:
    """Whether the switches of a contact's law may turn in a mode of its coordinate.

    At rest those turn that depend on contact inputs, such as the sign of a torque.
    """
    if mode == layout.HELD_FAST:
        return iw[iw[layout.INPUT_COUNTS] + contact] > 0
    return mode in (layout.FORWARD, layout.BACKWARD)


def has_switches(contact: int, t: float, w: Vector, iw: IntVector, at: int) -> bool:
    """Whether a contact's law has switches, which the series of exact modes does not watch."""
    if iw[layout.LAW_SWITCHES] == 0:
        return False
    law_margins(contact, iw[iw[layout.LAW_FLAGS] + contact], t, w, iw, at, math.nan)
    return not math.isnan(w[iw[layout.LAW_VALUES]])


def law_margins(
    contact: int, flags: int, t: float, w: Vector, iw: IntVector, at: int, absent: float
) -> None:
    """Write the margins of the switches of a contact's law, positive where they hold."""
    side = assembly.side_of(contact, w, iw, at)
    row = assembly.set_row(contact, side, w, iw, at)
    kind = iw[iw[layout.KINDS] + contact]
    values = iw[layout.LAW_VALUES]
    for j in range(iw[layout.LAW_SWITCHES]):
        w[values + j] = absent
    equations.evaluate(equations.LAW_MARGINS + kind, side, flags, t, w, row, values)


def law_flags(t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Set the flags of all laws, nested switches included.

    The flags of what slipped before turn only where a margin has jumped beyond rounding: at a
    threshold, the next step shows to which side it is left. Those of what is held are as at rest,
    for decisions ask with which friction it would begin to slip.
    """
    switches = iw[layout.LAW_SWITCHES]
    for c in range(iw[layout.N_CONTACTS] if switches > 0 else 0):
        i = iw[iw[layout.SLIPS] + c]
        mode = iw[iw[layout.MODES] + i]
        if mode == layout.FREE:
            continue
        share = UNMOVED
        kept = mode == iw[iw[layout.BEFORE] + i]
        if not kept or (mode == layout.HELD_FAST and not watches(c, mode, iw)):
            iw[iw[layout.LAW_FLAGS] + c] = 0
            share = 0.0
        reached = iw[layout.REACHED] + first_contact_guard(iw) + c * (switches + 1)
        for _ in range(switches):
            before = iw[iw[layout.LAW_FLAGS] + c]
            law_margins(c, before, t, w, iw, at, UNWATCHED)
            flags = 0
            for j in range(switches):
                margin, rounding = w[iw[layout.LAW_VALUES] + j], share * w[reached + j]
                if margin > rounding or (before & (1 << j) and margin >= -rounding):
                    flags |= 1 << j
            iw[iw[layout.LAW_FLAGS] + c] = flags


# What steppers ask of a mechanism with several contacts: rates, sizes, work, rest.

MODEST = 1e-3
"""Least speed that counts, over that which the largest kinetic energy would give a coordinate."""
BEGINNING_SHARE = 1e-6
"""Least speed that counts at the start, over what the forces at hand give in a run."""
FAINT = 1e-8
"""Least part of that speed where a motion is at hand whose own speeds are smaller."""
SHORT_SERIES = 6
"""A series that ends so early is that of a very short step, over which few nodes do."""


def contact_rates(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write the time derivatives of the states."""
    n = iw[layout.N_COORDINATES]
    assembly.assemble(t, w, iw, at)
    for i in range(n):
        # Places follow rates as the state has them: what is held has rate 0 exactly.
        w[to + i] = w[at + n + i]
        w[to + n + i] = w[iw[layout.ACCELERATION] + i]
    for k in range(iw[layout.N_STATES] - 2 * n):
        w[to + 2 * n + k] = w[iw[layout.BRISTLE_RATES] + k]


def contact_columns(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write friction, then load, then mode of each contact, then efforts of guided coordinates."""
    contacts = iw[layout.N_CONTACTS]
    assembly.assemble(t, w, iw, at)
    for c in range(contacts):
        w[to + c] = w[iw[layout.FRICTION] + c]
        w[to + contacts + c] = 0.0 if iw[iw[layout.OPEN] + c] else w[iw[layout.LOAD] + c]
        mode = iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + c]]
        w[to + 2 * contacts + c] = mode_of(c, mode, iw[iw[layout.OPEN] + c], w, iw, at)
    if iw[layout.N_CHANNELS] > 0:
        assembly.put_motion(w, iw, at)
        equations.evaluate(
            equations.EFFORTS,
            0,
            iw[layout.FLAGS],
            t,
            w,
            iw[layout.MOTION_POINT],
            to + 3 * contacts,
        )


def mode_of(
    contact: int, coordinate_mode: int, is_open: int, w: Vector, iw: IntVector, at: int
) -> int:
    """Return the mode of a contact, which may slip against its coordinate."""
    if is_open or coordinate_mode == layout.FREE:
        return layout.UNLOADED
    mode = coordinate_mode
    if mode == layout.HELD_FAST:
        mode = 2 * assembly.stopped_side(iw[iw[layout.SLIPS] + contact], w, iw, at)
    # a contact may slip against its coordinate
    return mode if w[iw[layout.SLIP_FACTORS] + contact] > 0.0 else -mode


def contact_power(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write the power supplied and that taken by friction."""
    assembly.assemble(t, w, iw, at)
    supply(t, w, iw, at, to)
    w[to + 1] = 0.0
    for c in range(iw[layout.N_CONTACTS]):
        w[to + 1] += w[iw[layout.FRICTION] + c] * slip_rate(c, w, iw, at)


def supply(t: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Write the power supplied; that of guides asks for accelerations, which are worked out."""
    if iw[layout.N_CHANNELS] > 0:
        assembly.put_motion(w, iw, at)  # with the accelerations behind the state
        at = iw[layout.MOTION_POINT]
    equations.evaluate(equations.POWER, 0, iw[layout.FLAGS], t, w, at, to)


def slip_rate(contact: int, w: Vector, iw: IntVector, at: int) -> float:
    """Return the slip velocity of a contact."""
    i = iw[iw[layout.SLIPS] + contact]
    return w[iw[layout.SLIP_FACTORS] + contact] * equations.slip_rate_along(i, at, w, iw)


def largest_pull(t: float, w: Vector, iw: IntVector) -> float:
    """Return the largest acceleration that forces and friction at a time give the present state."""
    n = iw[layout.N_COORDINATES]
    assembly.assemble(t, w, iw, iw[layout.Y])
    largest = 0.0
    for i in range(n):
        # A stop pulls nothing: only what friction can do gives a size.
        level = max(
            assembly.finite(w[iw[layout.LEVELS] + 2 * i]),
            assembly.finite(w[iw[layout.LEVELS] + 2 * i + 1]),
        )
        pull = abs(w[iw[layout.FORCE] + i]) + level
        largest = max(largest, pull / w[iw[layout.MASS] + i * n + i])
    return largest


def first_contact_sizes(t_end: float, w: Vector, iw: IntVector) -> None:
    """Set the sizes at the start; what is at rest has those that the forces at hand give.

    Where there are none yet, the forces at the end of the run count, as the drives go on now. Where
    something moves, forces may be those that stop it at once: what it moves with counts then.
    """
    n, states, y, scale = (
        iw[layout.N_COORDINATES],
        iw[layout.N_STATES],
        iw[layout.Y],
        iw[layout.SCALE],
    )
    largest = largest_pull(w[layout.TIME], w, iw)
    # At the start nothing may act yet: a drive that begins at 0 acts later.
    if largest == 0.0:
        largest = largest_pull(t_end, w, iw)
        assembly.assemble(w[layout.TIME], w, iw, y)
    for i in range(states):
        w[scale + i] = abs(w[y + i])
    span = t_end - w[layout.TIME]
    speed, fastest = BEGINNING_SHARE * largest * span, 0.0
    w[layout.LIVELIEST] = 0.0
    note_motion(w, iw)
    for i in range(n):
        own = speed
        if w[layout.LIVELIEST] > 0.0:
            own = max(FAINT * speed, min(speed, w[scale + n + i]))
        fastest = max(fastest, own)
        w[scale + n + i] = max(w[scale + n + i], own)
        w[scale + i] = max(w[scale + i], BEGINNING_SHARE * w[scale + n + i] * span)
    for i in range(2 * n, states):  # bristles, which bend far less than bodies move
        bent = BEGINNING_SHARE * BEGINNING_SHARE * fastest * span
        w[scale + i] = max(w[scale + i], bent)


def note_motion(w: Vector, iw: IntVector) -> None:
    """Give every rate a size: a small part of what the largest kinetic energy would give it.

    A coordinate that starts from rest has no size of its own yet.
    """
    n, mass, rates = (
        iw[layout.N_COORDINATES],
        iw[layout.MASS],
        iw[layout.Y] + iw[layout.N_COORDINATES],
    )
    energy = 0.0
    for i in range(n):
        # q' M q' over the rows of one triangle, the other half doubled: twice the kinetic energy.
        row = w[mass + i * n + i] * w[rates + i]
        if not iw[layout.DIAGONAL]:
            for j in range(i):
                row += 2.0 * w[mass + i * n + j] * w[rates + j]
        energy += row * w[rates + i]
    w[layout.LIVELIEST] = max(w[layout.LIVELIEST], energy)
    size = iw[layout.SCALE] + n
    for i in range(n):
        # The speed that all of that energy would give this coordinate alone.
        least = MODEST * math.sqrt(w[layout.LIVELIEST] / w[mass + i * n + i])
        w[size + i] = max(w[size + i], least)


def book_contacts(w: Vector, iw: IntVector) -> None:
    """Add the work done in the part of the step that holds.

    In an exact mode a contact's friction is a constant and its damping: the work of the former is
    that constant times the slip.
    """
    exact = iw[layout.STEPPER] == layout.EXACT
    if exact:
        for c in range(iw[layout.N_CONTACTS]):
            if iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + c]] in (
                layout.FORWARD,
                layout.BACKWARD,
            ):
                book_slip(c, w, iw)
    if exact and not iw[layout.SUPPLIES]:
        return
    share, h, point, values = (
        w[layout.FRACTION],
        w[layout.LENGTH],
        iw[layout.POINT],
        iw[layout.VALUES],
    )
    few = 0.0 < w[iw[layout.DENSE]] <= SHORT_SERIES
    for node in range(len(FEW_NODES) if few else len(NODES)):
        x = share * (FEW_NODES[node] if few else NODES[node])
        weight = share * h * (FEW_WEIGHTS[node] if few else WEIGHTS[node])
        interpolate(w, iw, x, point)
        if exact:
            if iw[layout.N_CHANNELS] > 0:
                assembly.assemble(w[layout.TIME] + x * h, w, iw, point)
            supply(w[layout.TIME] + x * h, w, iw, point, values)
        else:
            contact_power(w[layout.TIME] + x * h, w, iw, point, values)
            for c in range(iw[layout.N_CONTACTS]):
                own = w[iw[layout.FRICTION] + c] * slip_rate(c, w, iw, point)
                w[iw[layout.WORKS] + c] += weight * own
                w[layout.TAKEN] += weight * own
                w[layout.GROSS] += weight * abs(own)
        w[layout.SUPPLIED] += weight * w[values]
        w[layout.GROSS] += weight * abs(w[values])


def book_slip(contact: int, w: Vector, iw: IntVector) -> None:
    """Add the work of a contact that slips in an exact mode."""
    i, factor = iw[iw[layout.SLIPS] + contact], w[iw[layout.SLIP_FACTORS] + contact]
    n, states, dense = iw[layout.N_COORDINATES], iw[layout.N_STATES], iw[layout.DENSE] + 1
    share, h = w[layout.FRACTION], w[layout.LENGTH]
    terms = int(w[iw[layout.DENSE]])
    damping = w[iw[layout.DAMPING] + contact]
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
            slip += equations.combined(i, dense + k * states, w, iw) * power
        rates, width = iw[layout.NEEDED_SERIES] + i, iw[layout.N_PAIRS]
    # Friction is F_0 + d (v - v_0): what is constant of it times the slip, then d v^2 by
    # quadrature.
    work = (factor * w[iw[layout.FRICTION] + contact] - damping * w[rates]) * slip
    if damping != 0.0:
        for node in range(len(NODES)):
            x = share * NODES[node]
            rate = w[rates + terms * width]
            for k in range(terms - 1, -1, -1):
                rate = rate * x + w[rates + k * width]
            work += WEIGHTS[node] * share * h * damping * rate * rate
    w[iw[layout.WORKS] + contact] += work
    w[layout.TAKEN] += work
    w[layout.GROSS] += abs(work)


def contacts_rest(w: Vector, iw: IntVector) -> bool:
    """Whether all coordinates are held and no drive can move any of them any more.

    The needed friction is affine in the drives: it is largest at a corner of what they may do from
    now on, which stands in BOX.
    """
    n, drives, values = iw[layout.N_COORDINATES], iw[layout.N_DRIVES], iw[layout.VALUES]
    if not iw[layout.REST_IS_FINAL] or iw[layout.HAS_BRISTLES]:  # bristles push and relax
        return False
    for i in range(n):
        if iw[iw[layout.MODES] + i] != layout.HELD_FAST:
            return False
    for corner in range(1 << drives):
        for k in range(drives):
            bound = w[iw[layout.BOX] + 2 * k + ((corner >> k) & 1)]
            w[iw[layout.GIVEN] + k] = bound
            # A drive without a bound can move anything.
            if not abs(bound) < math.inf:
                return False
        equations.evaluate(
            equations.REST, 0, iw[layout.FLAGS], w[layout.TIME], w, iw[layout.Y], values
        )
        for i in range(iw[layout.N_PAIRS]):
            force = equations.combined(i, values, w, iw)
            # the friction that would be needed, against the level on its side
            level = w[iw[layout.LEVELS] + 2 * i + (0 if force >= 0.0 else 1)]
            if abs(force) > level and not iw[iw[layout.LOOPED] + i]:
                return False
    return True
