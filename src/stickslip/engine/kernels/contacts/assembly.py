"""Accelerations and forces of a mechanism with several contacts, from the parts of its equations.

With coordinates q, mass matrix M(q), forces h(t, q, q') and friction F along the slips W,

    M q'' = h - W F,        F_c = a_c + b_c N_c.

Friction is affine in the load N, and so is a level of break-away. Each coordinate has a mode.

1. A law is asked for the constant and the factor of its friction, of its levels and their slopes,
   for the direction in which its contact slips or is about to (`ask_contact`).
2. Of the coordinates f that are free, M_ff a_f = h_f - (W F)_f is solved by a Cholesky factor of
   M_ff. One that is held is left out: its acceleration is 0 to the last bit, and its needed
   friction is what is left of its row, r = h - W F - M a (`accelerate`). No matrix of the contacts
   is ever inverted, so that none can be singular.
3. Loads that are reactions of coordinates held at 0 follow from these rows. All is affine in them,
   friction included: the rows are evaluated without reactions and at a unit of each, and as many
   equations are solved. Their determinant over that without friction is PIVOT: where it vanishes,
   the rigid body has no answer (Painleve's paradox) (`react`).
4. Contacts that slip along the same coordinate share its mode, and their levels are added. What
   holds them while they stick is one number, which they share in proportion to their levels: they
   reach these together (`share`).

A coordinate at its hard stop counts as held with an infinite level towards it.
"""

import math

from stickslip.engine.kernels import equations
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector, rare
from stickslip.engine.kernels.contacts.loops import (
    cut_levels,
    find_followers,
    fold,
    project_mass,
    scale_cuts,
    share_in_loops,
)
from stickslip.engine.kernels.guard_roots import size_of_forces
from stickslip.engine.kernels.mode_transitions import wall_coordinate, wall_side

# Hard stops of mechanisms with several contacts: where they are, and what they hold.
#
# A coordinate that rests at its stop is held like any other, but that nothing moves it towards the
# stop: its level on that side is infinite. It is at its stop where its place is that of the stop to
# the last bit, onto which an impact puts it.


def margin_of(wall: int, w: Vector, iw: IntVector, at: int) -> float:
    """Return the distance of a coordinate from a stop."""
    position = w[iw[layout.WALLS] + wall * iw[layout.WALL_COLUMNS]]
    return wall_side(wall, iw) * (position - w[at + wall_coordinate(wall, iw)])


def stopped_side(i: int, w: Vector, iw: IntVector, at: int) -> int:
    """Return the side of the stop at which a coordinate is: 1 upper, -1 lower, 0 none."""
    for wall in range(iw[layout.N_WALLS]):
        if wall_coordinate(wall, iw) == i and margin_of(wall, w, iw, at) == 0.0:
            return wall_side(wall, iw)
    return 0


def raise_levels(levels: int, w: Vector, iw: IntVector, at: int) -> None:
    """Make the levels of held coordinates infinite towards the stops at which they are."""
    for wall in range(iw[layout.N_WALLS]):
        i = wall_coordinate(wall, iw)
        held = iw[iw[layout.MODES] + i] == layout.HELD_FAST
        if held and margin_of(wall, w, iw, at) == 0.0:
            w[levels + 2 * i + (0 if wall_side(wall, iw) > 0 else 1)] = math.inf


def finite(level: float) -> float:
    """Return a level, 0 for that of a stop."""
    return level if level < math.inf else 0.0


def stop_guards(w: Vector, iw: IntVector, at: int, to: int, always: float) -> None:
    """Write the guards of the stops: distances of the coordinates that may reach them."""
    # What moves away from a stop, or is held, cannot reach it: its distance may be 0 and say
    # nothing.
    for wall in range(iw[layout.N_WALLS]):
        mode = iw[iw[layout.MODES] + wall_coordinate(wall, iw)]
        away = mode in (layout.FORWARD, layout.BACKWARD) and mode != wall_side(wall, iw)
        idle = mode == layout.HELD_FAST or away
        margin = always if idle else margin_of(wall, w, iw, at)
        w[to + iw[layout.FIRST_WALL] + wall] = margin


# The mass matrix of the coordinates that are free to move, factorised by Cholesky.


def factorise(w: Vector, iw: IntVector) -> None:
    """Factorise the mass matrix of the free coordinates; those of held ones are rows of 1.

    A principal part of a positive definite matrix is one itself: there is always an answer.
    """
    n = iw[layout.N_COORDINATES]
    modes = iw[layout.MODES]
    mass = iw[layout.MASS]
    factors = iw[layout.CHOLESKY]
    if iw[layout.N_DIRECTIONS] > n:
        mass = project_mass(w, iw)
    for i in range(n):
        # Rows of held ones stay, as those of 1: a change of modes moves no index.
        free_row = iw[modes + i] != layout.HELD_FAST
        for j in range(i):
            free = free_row and iw[modes + j] != layout.HELD_FAST
            total = w[mass + i * n + j] if free else 0.0
            for k in range(j):
                total -= w[factors + i * n + k] * w[factors + j * n + k]
            w[factors + i * n + j] = total / w[factors + j * n + j]
        total = w[mass + i * n + i] if free_row else 1.0
        for k in range(i):
            total -= w[factors + i * n + k] * w[factors + i * n + k]
        # What is no inertia gives NaN, which no step accepts.
        w[factors + i * n + i] = math.sqrt(total) if total > 0.0 else math.nan


def solve_free(w: Vector, iw: IntVector, right: int) -> None:
    """Solve for the free coordinates in place; 0 at held ones."""
    n = iw[layout.N_COORDINATES]
    modes = iw[layout.MODES]
    if iw[layout.DIAGONAL]:
        mass = iw[layout.MASS]
        for i in range(n):
            held = iw[modes + i] == layout.HELD_FAST
            w[right + i] = 0.0 if held else w[right + i] / w[mass + i * n + i]
        return
    factors = iw[layout.CHOLESKY]
    if iw[layout.N_DIRECTIONS] > n:
        fold(right, w, iw)
    # L z = b, then L^T x = z; held ones have 0 on the right and stay so.
    for i in range(n):
        total = 0.0 if iw[modes + i] == layout.HELD_FAST else w[right + i]
        for k in range(i):
            total -= w[factors + i * n + k] * w[right + k]
        w[right + i] = total / w[factors + i * n + i]
    for i in range(n - 1, -1, -1):
        total = w[right + i]
        for k in range(i + 1, n):
            total -= w[factors + k * n + i] * w[right + k]
        w[right + i] = total / w[factors + i * n + i]
    for i in range(n):
        if iw[modes + i] == layout.HELD_FAST:
            w[right + i] = 0.0
    if iw[layout.N_DIRECTIONS] > n:
        equations.bind(right, 1, w, iw)


# Accelerations and forces of a mechanism with several contacts, from the parts of its equations.

WITHIN = 2e-15
"""Share of its level, nine units in the last place of 1, by which needed friction may exceed it, in
decisions as in guards: where both are equal, rounding would let it break away and stop without end.
"""


def prepare(t: float, w: Vector, iw: IntVector) -> None:
    """Write what is the same in a whole run: directions of slip, a constant mass matrix."""
    equations.evaluate(
        equations.GEOMETRY,
        0,
        iw[layout.FLAGS],
        t,
        w,
        iw[layout.Y],
        iw[layout.SLIP_FACTORS],
    )
    if iw[layout.IS_TURNED]:
        equations.evaluate(
            equations.TURNING, 0, iw[layout.FLAGS], t, w, iw[layout.Y], iw[layout.TURN]
        )
    if iw[layout.N_DIRECTIONS] > iw[layout.N_COORDINATES]:
        equations.evaluate(
            equations.LOOPS_OF, 0, iw[layout.FLAGS], t, w, iw[layout.Y], iw[layout.LOOPS]
        )
        scale_cuts(w, iw)
    if iw[layout.N_WALLS] > 0:
        equations.evaluate(
            equations.WALLS_OF, 0, iw[layout.FLAGS], t, w, iw[layout.Y], iw[layout.WALLS]
        )
    put_mass(t, w, iw, iw[layout.Y])
    # Without friction only the normals are in the rows: their determinant is the measure of PIVOT.
    count, rows = iw[layout.N_REACTIONS], iw[layout.REACTION_ROWS]
    for i in range(count * (count + 1)):
        w[rows + i] = 0.0
    add_normals(w, iw)
    w[layout.FRICTIONLESS] = determinant(w, rows, count)
    equations.evaluate(equations.LOADS, 0, iw[layout.FLAGS], t, w, iw[layout.Y], iw[layout.LOAD])


def put_mass(t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Write the mass matrix, of held coordinates below it."""
    n = iw[layout.N_COORDINATES]
    mass = iw[layout.MASS]
    values = iw[layout.LAW_VALUES]
    equations.evaluate(equations.MASSES, 0, iw[layout.FLAGS], t, w, at, values)
    for k in range(iw[layout.N_MASSES]):
        i = iw[iw[layout.MASS_ROWS] + k]
        j = iw[iw[layout.MASS_COLUMNS] + k]
        w[mass + i * n + j] = w[values + k]
        if i < n:  # rows from n on are those of held coordinates, which are no columns
            w[mass + j * n + i] = w[values + k]


def side_of(contact: int, w: Vector, iw: IntVector, at: int) -> int:
    """Return the direction, 1 or -1, in which a contact slips or is about to."""
    coordinate = iw[iw[layout.SLIPS] + contact]
    factor = w[iw[layout.SLIP_FACTORS] + contact]
    mode = iw[iw[layout.MODES] + coordinate]
    if mode in (layout.HELD_FAST, layout.FREE):
        return 1 if factor * equations.slip_rate_along(coordinate, at, w, iw) >= 0.0 else -1
    return 1 if mode * factor > 0.0 else -1


def ask_law(contact: int, side: int, t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Write the numbers of a contact's law for a direction, at the slip velocity of a state.

    They are: constant and factor of the load of friction, and of the level; the slopes of the
    first two along the speed; whether friction is affine in the speed; rates of bristles.
    """
    row = set_row(contact, side, w, iw, at)
    kind = iw[iw[layout.KINDS] + contact]
    equations.evaluate(
        equations.LAW + kind,
        side,
        iw[iw[layout.LAW_FLAGS] + contact],
        t,
        w,
        row,
        iw[layout.LAW_VALUES],
    )


def set_row(contact: int, side: int, w: Vector, iw: IntVector, at: int) -> int:
    """Write what the functions of a contact's law read; return the place in `w` where it stands."""
    coordinate = iw[iw[layout.SLIPS] + contact]
    row = iw[iw[layout.LAW_ROWS] + contact]
    if iw[iw[layout.MODES] + coordinate] == layout.HELD_FAST:
        # 0 exactly: laws must not see what rounding has left of a rate.
        w[row] = 0.0
    else:
        speed = w[iw[layout.SLIP_FACTORS] + contact] * equations.slip_rate_along(
            coordinate, at, w, iw
        )
        w[row] = side * speed
    bristle = iw[iw[layout.BRISTLES] + contact]
    place = row + iw[iw[layout.LAW_BRISTLES] + contact]
    inputs = iw[iw[layout.INPUT_COUNTS] + contact]
    for k in range(inputs):
        # Inputs of all contacts stand behind the loads, contact by contact.
        first = iw[layout.LOAD] + iw[layout.N_CONTACTS] + iw[iw[layout.INPUTS] + contact]
        w[place - inputs + k] = w[first + k]
    if bristle >= 0:
        for k in range(iw[iw[layout.BRISTLE_COUNTS] + contact]):
            w[place + k] = w[at + 2 * iw[layout.N_COORDINATES] + bristle + k]
    # Friction is affine in the load, which stands outside; switches and rates of bristles are not.
    w[place + iw[iw[layout.BRISTLE_COUNTS] + contact]] = w[iw[layout.LOAD] + contact]
    return row


def bends(contact: int, iw: IntVector) -> bool:
    """Return whether bristles carry a contact's friction; a rule for rest takes it away."""
    mode = iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + contact]]
    slips = mode in (layout.FORWARD, layout.BACKWARD, layout.FREE)
    return iw[iw[layout.BRISTLES] + contact] >= 0 and (slips or not iw[iw[layout.HOLDS] + contact])


def ask_laws(fresh: bool, t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Write friction and levels of all contacts as constants and factors of their loads.

    Unless all is asked afresh, contacts keep what they had if their mode is as it was.
    """
    for c in range(iw[layout.N_CONTACTS]):
        mode = iw[iw[layout.MODES] + iw[iw[layout.SLIPS] + c]]
        if fresh or iw[iw[layout.ASKED] + c] != mode:
            iw[iw[layout.ASKED] + c] = mode
            ask_contact(c, mode, t, w, iw, at)


def ask_contact(contact: int, mode: int, t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Write friction and levels of a contact as constants and factors of its load.

    One that is pushed to its static level, in a decision, has that as its friction. Rates of
    bristles are written too, with the load at hand; those of open contacts rest.
    """
    constant, factor = iw[layout.FRICTION_CONSTANT], iw[layout.FRICTION_FACTOR]
    values = iw[layout.LAW_VALUES]
    levels = iw[layout.LEVEL_CONSTANT] + 2 * contact
    level_factors = iw[layout.LEVEL_FACTOR] + 2 * contact
    w[constant + contact] = 0.0
    w[factor + contact] = 0.0
    w[iw[layout.DAMPING] + contact] = 0.0
    for k in range(2):
        w[levels + k] = 0.0
        w[level_factors + k] = 0.0
    bristle = iw[iw[layout.BRISTLES] + contact]
    if iw[iw[layout.OPEN] + contact]:
        # An open contact has no friction, and its bristles keep their bend.
        for k in range(iw[iw[layout.BRISTLE_COUNTS] + contact]):
            w[iw[layout.BRISTLE_RATES] + bristle + k] = 0.0
        return
    side = side_of(contact, w, iw, at)
    ask_law(contact, side, t, w, iw, at)
    if bends(contact, iw):
        w[constant + contact] = side * w[values]
        w[factor + contact] = side * w[values + 1]
        for k in range(iw[iw[layout.BRISTLE_COUNTS] + contact]):
            w[iw[layout.BRISTLE_RATES] + bristle + k] = w[values + 7 + k]
        return
    for k in range(iw[iw[layout.BRISTLE_COUNTS] + contact]):
        w[iw[layout.BRISTLE_RATES] + bristle + k] = 0.0
    if mode in (layout.FORWARD, layout.BACKWARD):
        w[constant + contact] = side * w[values]
        w[factor + contact] = side * w[values + 1]
        # Slip speed is the factor times the rate, and the force along the coordinate the factor
        # times friction: damping has its square.
        own = w[iw[layout.SLIP_FACTORS] + contact]
        w[iw[layout.DAMPING] + contact] = (
            own * own * (w[values + 4] + w[values + 5] * w[iw[layout.LOAD] + contact])
        )
    elif mode not in (layout.HELD_FAST, layout.FREE):
        w[constant + contact] = side * w[values + 2]
        w[factor + contact] = side * w[values + 3]
    ahead = 0 if side > 0 else 1
    w[levels + ahead] = w[values + 2]
    w[level_factors + ahead] = w[values + 3]
    # A law without directions has the level that was just asked on both sides.
    if iw[iw[layout.DIRECTIONAL] + contact] and mode == layout.HELD_FAST:
        ask_law(contact, -side, t, w, iw, at)
    w[levels + 1 - ahead] = w[values + 2]
    w[level_factors + 1 - ahead] = w[values + 3]


def accelerate(w: Vector, iw: IntVector) -> None:
    """Write accelerations, needed friction and friction of slipping contacts for given loads."""
    n = iw[layout.N_COORDINATES]
    result, needed = iw[layout.ACCELERATION], iw[layout.NEEDED]
    force, friction = iw[layout.FORCE], iw[layout.FRICTION]
    modes, mass = iw[layout.MODES], iw[layout.MASS]
    for i in range(n):
        w[result + i] = w[force + i]
    loops = iw[layout.N_DIRECTIONS] > n
    for c in range(iw[layout.N_CONTACTS]):
        own = (
            w[iw[layout.FRICTION_CONSTANT] + c]
            + w[iw[layout.FRICTION_FACTOR] + c] * w[iw[layout.LOAD] + c]
        )
        w[friction + c] = own
        equations.spread(
            iw[iw[layout.SLIPS] + c], w[iw[layout.SLIP_FACTORS] + c] * own, result, w, iw
        )
    # All forces but inertia here; what couples held coordinates to free ones is taken off below.
    for i in range(n):
        w[needed + i] = w[result + i]
    solve_free(w, iw, result)
    if loops:
        bear(w, iw)
    for i in range(n):
        if iw[modes + i] != layout.HELD_FAST:
            w[needed + i] = 0.0
        elif not iw[layout.DIAGONAL]:  # else nothing couples them
            total = w[needed + i]
            for j in range(n):
                total -= w[mass + i * n + j] * w[result + j]
            w[needed + i] = total


@rare
def bear(w: Vector, iw: IntVector) -> None:
    """Write the forces that held contacts of loops have to bear, along all coordinates.

    NEEDED has the forces but those of inertia.
    """
    n = iw[layout.N_COORDINATES]
    for i in range(n):
        total = w[iw[layout.NEEDED] + i]
        for j in range(n):
            total -= w[iw[layout.MASS] + i * n + j] * w[iw[layout.ACCELERATION] + j]
        w[iw[layout.BORNE] + i] = total if iw[iw[layout.LOOPED] + i] else 0.0


def blur(i: int, w: Vector, iw: IntVector) -> float:
    """Return how much of the needed friction of a held coordinate may be rounding."""
    return WITHIN * size_of_forces(i, w, iw)


def share(w: Vector, iw: IntVector, at: int) -> None:
    """Write the levels of each coordinate, and the needed friction by contact.

    At a stop friction takes what it can of the force towards it, and the stop the rest. Reads
    loads, accelerations and needed friction.
    """
    levels = iw[layout.LEVELS]
    for i in range(2 * iw[layout.N_PAIRS]):
        w[levels + i] = 0.0
    for c in range(iw[layout.N_CONTACTS]):
        factor, load = w[iw[layout.SLIP_FACTORS] + c], w[iw[layout.LOAD] + c]
        for k in range(2):
            place = 2 * c + (k if factor > 0.0 else 1 - k)
            level = w[iw[layout.LEVEL_CONSTANT] + place] + w[iw[layout.LEVEL_FACTOR] + place] * load
            w[levels + 2 * iw[iw[layout.SLIPS] + c] + k] += abs(factor) * level
    if iw[layout.N_DIRECTIONS] > iw[layout.N_COORDINATES]:
        cut_levels(levels, w, iw)
        share_in_loops(w, iw)
    for c in range(iw[layout.N_CONTACTS]):
        i = iw[iw[layout.SLIPS] + c]
        if iw[iw[layout.MODES] + i] == layout.HELD_FAST and iw[iw[layout.HOLDS] + c]:
            factor, load = w[iw[layout.SLIP_FACTORS] + c], w[iw[layout.LOAD] + c]
            # Partners share in proportion to their levels, and so reach these at the same time.
            needed = w[iw[layout.NEEDED] + i]
            back = 0 if needed >= 0.0 else 1
            place = 2 * c + (back if factor > 0.0 else 1 - back)
            level = w[iw[layout.LEVEL_CONSTANT] + place] + w[iw[layout.LEVEL_FACTOR] + place] * load
            total = w[levels + 2 * i + back]
            if iw[layout.N_WALLS] > 0:
                needed = max(-total, min(total, needed))
            part = needed * level / total if total > 0.0 else 0.0
            w[iw[layout.FRICTION] + c] = part if factor > 0.0 else -part
    raise_levels(levels, w, iw, at)


def held_surplus(row: int, w: Vector, iw: IntVector) -> float:
    """Return the force that a held coordinate needs beside those that act on it."""
    n = iw[layout.N_COORDINATES]
    total = -w[iw[layout.FORCE] + n + row]
    for i in range(n):
        total += w[iw[layout.MASS] + (n + row) * n + i] * w[iw[layout.ACCELERATION] + i]
    for c in range(iw[layout.N_CONTACTS]):
        total += w[iw[layout.HELD_SLIPS] + c * iw[layout.N_HELD] + row] * w[iw[layout.FRICTION] + c]
    return total


def equal_part(contact: int, force: float, w: Vector, iw: IntVector) -> float:
    """Return the part that a held contact has in a force along its coordinate, in equal parts.

    This is affine in the loads, as shares in proportion to the levels are not. It makes no
    difference to the reactions where contacts of one coordinate slip at the same height.
    """
    i, partners = iw[iw[layout.SLIPS] + contact], 0
    for d in range(iw[layout.N_CONTACTS]):
        together = iw[iw[layout.SLIPS] + d] == i and iw[iw[layout.HOLDS] + d]
        partners += 1 if together and not iw[iw[layout.OPEN] + d] else 0
    return force / max(partners, 1) / w[iw[layout.SLIP_FACTORS] + contact]


def split(w: Vector, iw: IntVector) -> None:
    """Write the needed friction of held coordinates by contact, in equal parts."""
    for c in range(iw[layout.N_CONTACTS]):
        i = iw[iw[layout.SLIPS] + c]
        if iw[iw[layout.MODES] + i] == layout.HELD_FAST and iw[iw[layout.HOLDS] + c]:
            is_open = iw[iw[layout.OPEN] + c]
            own = 0.0 if is_open else equal_part(c, w[iw[layout.NEEDED] + i], w, iw)
            w[iw[layout.FRICTION] + c] = own


def react(w: Vector, iw: IntVector) -> None:
    """Write the loads that are reactions of held coordinates.

    All is affine in them, friction included: the rows that they must balance are evaluated without
    them and at a unit of each, and a system of as many equations is solved. Its determinant over
    that without friction is left in PIVOT: where it vanishes, so does the rigid body's answer.
    """
    for trial in range(iw[layout.N_REACTIONS] + 1):
        put_loads(trial - 1, iw[layout.LOAD], w, iw)
        accelerate(w, iw)
        split(w, iw)
        for row in range(iw[layout.N_REACTIONS]):
            note_surplus(trial, row, held_surplus(row, w, iw), w, iw)
    w[layout.PIVOT] = balance(iw[layout.LOAD], w, iw) / w[layout.FRICTIONLESS]


def put_loads(unit: int, to: int, w: Vector, iw: IntVector) -> None:
    """Set the reactions to 0, but one of them to 1."""
    k = 0
    for c in range(iw[layout.N_CONTACTS]):
        if iw[iw[layout.REACTS] + c]:
            w[to + c] = 1.0 if k == unit else 0.0
            k += 1


def note_surplus(trial: int, row: int, surplus: float, w: Vector, iw: IntVector) -> None:
    """Enter what a held coordinate lacks without reactions (trial 0), or with a unit of one."""
    count, wide = iw[layout.N_REACTIONS], iw[layout.N_REACTIONS] + 1
    rows = iw[layout.REACTION_ROWS]
    bare = rows + count * wide + row
    if trial == 0:
        w[bare] = surplus
    else:  # all is affine in the loads: the difference is the column of slopes, negated
        w[rows + row * wide + trial - 1] = w[bare] - surplus


def balance(to: int, w: Vector, iw: IntVector) -> float:
    """Write the reactions that leave no surplus; return the determinant of their equations."""
    count, wide = iw[layout.N_REACTIONS], iw[layout.N_REACTIONS] + 1
    rows = iw[layout.REACTION_ROWS]
    for row in range(count):
        w[rows + row * wide + count] = w[rows + count * wide + row]
    # What held coordinates lack is what loads give by their normals.
    add_normals(w, iw)
    result = determinant(w, rows, count)
    k = 0
    for c in range(iw[layout.N_CONTACTS]):
        if iw[iw[layout.REACTS] + c]:
            w[to + c] = w[rows + k * wide + count]
            k += 1
    return result


def add_normals(w: Vector, iw: IntVector) -> None:
    """Add to each row of the reactions what a unit of each load does to it by itself."""
    count, held = iw[layout.N_REACTIONS], iw[layout.N_HELD]
    k = 0
    for c in range(iw[layout.N_CONTACTS]):
        if iw[iw[layout.REACTS] + c]:
            for row in range(count):
                normal = w[iw[layout.HELD_NORMALS] + c * held + row]
                w[iw[layout.REACTION_ROWS] + row * (count + 1) + k] += normal
            k += 1


def determinant(w: Vector, rows: int, count: int) -> float:
    """Solve a system of `count` equations by elimination; return its determinant.

    The right-hand side, in the last column, becomes the solution.
    """
    wide = count + 1
    product = 1.0
    for k in range(count):
        best = k
        for i in range(k + 1, count):
            if abs(w[rows + i * wide + k]) > abs(w[rows + best * wide + k]):
                best = i
        if best != k:
            product = -product
            for j in range(wide):
                other = w[rows + k * wide + j]
                w[rows + k * wide + j] = w[rows + best * wide + j]
                w[rows + best * wide + j] = other
        pivot = w[rows + k * wide + k]
        product *= pivot
        if pivot == 0.0:  # nothing that is a number would come of it
            return 0.0
        for i in range(count):
            if i != k:
                factor = w[rows + i * wide + k] / pivot
                for j in range(k, wide):
                    w[rows + i * wide + j] -= factor * w[rows + k * wide + j]
    for k in range(count):
        w[rows + k * wide + count] /= w[rows + k * wide + k]
    return product


def refactor(w: Vector, iw: IntVector) -> None:
    """Factorise a constant mass matrix for the modes at hand; find what follows from others."""
    if iw[layout.N_DIRECTIONS] > iw[layout.N_COORDINATES]:
        find_followers(w, iw)
    if iw[layout.CONSTANT_MASS] and not iw[layout.DIAGONAL]:
        factorise(w, iw)


def refresh(t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Factorise anew what is constant as long as no mode changes, and write all there is."""
    refactor(w, iw)
    assemble(t, w, iw, at)


def assemble(t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Write everything at a state: accelerations, needed friction, levels, friction and loads."""
    equations.evaluate(equations.FORCES, 0, iw[layout.FLAGS], t, w, at, iw[layout.FORCE])
    if not iw[layout.CONSTANT_MASS]:
        put_mass(t, w, iw, at)
        factorise(w, iw)
    if not iw[layout.CONSTANT_LOADS]:
        equations.evaluate(equations.LOADS, 0, iw[layout.FLAGS], t, w, at, iw[layout.LOAD])
    apply_laws(True, t, w, iw, at)


def apply_laws(fresh: bool, t: float, w: Vector, iw: IntVector, at: int) -> None:
    """Write friction and what follows from it, where forces, mass matrix and loads are at hand."""
    reacts = iw[layout.N_REACTIONS] > 0
    # Reactions change with any mode: no answer of a law may be kept.
    ask_laws(fresh or reacts, t, w, iw, at)
    if reacts:
        react(w, iw)
        if iw[layout.HAS_BRISTLES]:
            ask_laws(True, t, w, iw, at)  # rates of bristles depend on the loads
    accelerate(w, iw)
    share(w, iw, at)


def reconsider(w: Vector, iw: IntVector) -> None:
    """Write everything anew at a state and a time at which only modes have changed since."""
    refactor(w, iw)
    if not iw[layout.CONSTANT_MASS]:
        factorise(w, iw)
    apply_laws(False, w[layout.TIME], w, iw, iw[layout.Y])


def put_motion(w: Vector, iw: IntVector, at: int) -> None:
    """Write a state, and behind it the accelerations and the friction that belong to it."""
    n, states, point = (
        iw[layout.N_COORDINATES],
        iw[layout.N_STATES],
        iw[layout.MOTION_POINT],
    )
    for i in range(states):
        w[point + i] = w[at + i]
    for i in range(n):
        w[point + states + i] = w[iw[layout.ACCELERATION] + i]
    for c in range(iw[layout.N_CONTACTS]):
        w[point + states + n + c] = w[iw[layout.FRICTION] + c]
