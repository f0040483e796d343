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
from stickslip.engine.kernels.backend import Vector, Wholes, rare
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


def margin_of(wall: int, w: Vector, whole: Wholes, at: int) -> float:
    """Return the distance of a coordinate from a stop."""
    position = w[whole[layout.WALLS] + wall * whole[layout.WALL_COLUMNS]]
    return wall_side(wall, whole) * (position - w[at + wall_coordinate(wall, whole)])


def stopped_side(i: int, w: Vector, whole: Wholes, at: int) -> int:
    """Return the side of the stop at which a coordinate is: 1 upper, -1 lower, 0 none."""
    for wall in range(whole[layout.N_WALLS]):
        if wall_coordinate(wall, whole) == i and margin_of(wall, w, whole, at) == 0.0:
            return wall_side(wall, whole)
    return 0


def raise_levels(levels: int, w: Vector, whole: Wholes, at: int) -> None:
    """Make the levels of held coordinates infinite towards the stops at which they are."""
    for wall in range(whole[layout.N_WALLS]):
        i = wall_coordinate(wall, whole)
        held = whole[whole[layout.MODES] + i] == layout.HELD_FAST
        if held and margin_of(wall, w, whole, at) == 0.0:
            w[levels + 2 * i + (0 if wall_side(wall, whole) > 0 else 1)] = math.inf


def finite(level: float) -> float:
    """Return a level, 0 for that of a stop."""
    return level if level < math.inf else 0.0


def stop_guards(w: Vector, whole: Wholes, at: int, to: int, always: float) -> None:
    """Write the guards of the stops: distances of the coordinates that may reach them."""
    # What moves away from a stop, or is held, cannot reach it: its distance may be 0 and say
    # nothing.
    for wall in range(whole[layout.N_WALLS]):
        mode = whole[whole[layout.MODES] + wall_coordinate(wall, whole)]
        away = mode in (layout.FORWARD, layout.BACKWARD) and mode != wall_side(wall, whole)
        idle = mode == layout.HELD_FAST or away
        margin = always if idle else margin_of(wall, w, whole, at)
        w[to + whole[layout.FIRST_WALL] + wall] = margin


# The mass matrix of the coordinates that are free to move, factorised by Cholesky.


def factorise(w: Vector, whole: Wholes) -> None:
    """Factorise the mass matrix of the free coordinates; those of held ones are rows of 1.

    A principal part of a positive definite matrix is one itself: there is always an answer.
    """
    n = whole[layout.N_COORDINATES]
    modes = whole[layout.MODES]
    mass = whole[layout.MASS]
    factors = whole[layout.CHOLESKY]
    if whole[layout.N_DIRECTIONS] > n:
        mass = project_mass(w, whole)
    for i in range(n):
        # Rows of held ones stay, as those of 1: a change of modes moves no index.
        free_row = whole[modes + i] != layout.HELD_FAST
        for j in range(i):
            free = free_row and whole[modes + j] != layout.HELD_FAST
            total = w[mass + i * n + j] if free else 0.0
            for k in range(j):
                total -= w[factors + i * n + k] * w[factors + j * n + k]
            w[factors + i * n + j] = total / w[factors + j * n + j]
        total = w[mass + i * n + i] if free_row else 1.0
        for k in range(i):
            total -= w[factors + i * n + k] * w[factors + i * n + k]
        # What is no inertia gives NaN, which no step accepts.
        w[factors + i * n + i] = math.sqrt(total) if total > 0.0 else math.nan


def solve_free(w: Vector, whole: Wholes, right: int) -> None:
    """Solve for the free coordinates in place; 0 at held ones."""
    n = whole[layout.N_COORDINATES]
    modes = whole[layout.MODES]
    if whole[layout.DIAGONAL]:
        mass = whole[layout.MASS]
        for i in range(n):
            held = whole[modes + i] == layout.HELD_FAST
            w[right + i] = 0.0 if held else w[right + i] / w[mass + i * n + i]
        return
    factors = whole[layout.CHOLESKY]
    if whole[layout.N_DIRECTIONS] > n:
        fold(right, w, whole)
    # L z = b, then L^T x = z; held ones have 0 on the right and stay so.
    for i in range(n):
        total = 0.0 if whole[modes + i] == layout.HELD_FAST else w[right + i]
        for k in range(i):
            total -= w[factors + i * n + k] * w[right + k]
        w[right + i] = total / w[factors + i * n + i]
    for i in range(n - 1, -1, -1):
        total = w[right + i]
        for k in range(i + 1, n):
            total -= w[factors + k * n + i] * w[right + k]
        w[right + i] = total / w[factors + i * n + i]
    for i in range(n):
        if whole[modes + i] == layout.HELD_FAST:
            w[right + i] = 0.0
    if whole[layout.N_DIRECTIONS] > n:
        equations.bind(right, 1, w, whole)


# Accelerations and forces of a mechanism with several contacts, from the parts of its equations.

WITHIN = 2e-15
"""Share of its level, nine units in the last place of 1, by which needed friction may exceed it, in
decisions as in guards: where both are equal, rounding would let it break away and stop without end.
"""


def prepare(t: float, w: Vector, whole: Wholes) -> None:
    """Write what is the same in a whole run: directions of slip, a constant mass matrix."""
    equations.evaluate(
        equations.GEOMETRY,
        0,
        whole[layout.FLAGS],
        t,
        w,
        whole[layout.Y],
        whole[layout.SLIP_FACTORS],
    )
    if whole[layout.IS_TURNED]:
        equations.evaluate(
            equations.TURNING, 0, whole[layout.FLAGS], t, w, whole[layout.Y], whole[layout.TURN]
        )
    if whole[layout.N_DIRECTIONS] > whole[layout.N_COORDINATES]:
        equations.evaluate(
            equations.LOOPS_OF, 0, whole[layout.FLAGS], t, w, whole[layout.Y], whole[layout.LOOPS]
        )
        scale_cuts(w, whole)
    if whole[layout.N_WALLS] > 0:
        equations.evaluate(
            equations.WALLS_OF, 0, whole[layout.FLAGS], t, w, whole[layout.Y], whole[layout.WALLS]
        )
    put_mass(t, w, whole, whole[layout.Y])
    # Without friction only the normals are in the rows: their determinant is the measure of PIVOT.
    count, rows = whole[layout.N_REACTIONS], whole[layout.REACTION_ROWS]
    for i in range(count * (count + 1)):
        w[rows + i] = 0.0
    add_normals(w, whole)
    w[layout.FRICTIONLESS] = determinant(w, rows, count)
    equations.evaluate(
        equations.LOADS, 0, whole[layout.FLAGS], t, w, whole[layout.Y], whole[layout.LOAD]
    )


def put_mass(t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Write the mass matrix, of held coordinates below it."""
    n = whole[layout.N_COORDINATES]
    mass = whole[layout.MASS]
    values = whole[layout.LAW_VALUES]
    equations.evaluate(equations.MASSES, 0, whole[layout.FLAGS], t, w, at, values)
    for k in range(whole[layout.N_MASSES]):
        i = whole[whole[layout.MASS_ROWS] + k]
        j = whole[whole[layout.MASS_COLUMNS] + k]
        w[mass + i * n + j] = w[values + k]
        if i < n:  # rows from n on are those of held coordinates, which are no columns
            w[mass + j * n + i] = w[values + k]


def side_of(contact: int, w: Vector, whole: Wholes, at: int) -> int:
    """Return the direction, 1 or -1, in which a contact slips or is about to."""
    coordinate = whole[whole[layout.SLIPS] + contact]
    factor = w[whole[layout.SLIP_FACTORS] + contact]
    mode = whole[whole[layout.MODES] + coordinate]
    if mode in (layout.HELD_FAST, layout.FREE):
        return 1 if factor * equations.slip_rate_along(coordinate, at, w, whole) >= 0.0 else -1
    return 1 if mode * factor > 0.0 else -1


def ask_law(contact: int, side: int, t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Write the numbers of a contact's law for a direction, at the slip velocity of a state.

    They are: constant and factor of the load of friction, and of the level; the slopes of the
    first two along the speed; whether friction is affine in the speed; rates of bristles.
    """
    row = set_row(contact, side, w, whole, at)
    kind = whole[whole[layout.KINDS] + contact]
    equations.evaluate(
        equations.LAW + kind,
        side,
        whole[whole[layout.LAW_FLAGS] + contact],
        t,
        w,
        row,
        whole[layout.LAW_VALUES],
    )


def set_row(contact: int, side: int, w: Vector, whole: Wholes, at: int) -> int:
    """Write what the functions of a contact's law read; return the place in `w` where it stands."""
    coordinate = whole[whole[layout.SLIPS] + contact]
    row = whole[whole[layout.LAW_ROWS] + contact]
    if whole[whole[layout.MODES] + coordinate] == layout.HELD_FAST:
        # 0 exactly: laws must not see what rounding has left of a rate.
        w[row] = 0.0
    else:
        speed = w[whole[layout.SLIP_FACTORS] + contact] * equations.slip_rate_along(
            coordinate, at, w, whole
        )
        w[row] = side * speed
    bristle = whole[whole[layout.BRISTLES] + contact]
    place = row + whole[whole[layout.LAW_BRISTLES] + contact]
    inputs = whole[whole[layout.INPUT_COUNTS] + contact]
    for k in range(inputs):
        # Inputs of all contacts stand behind the loads, contact by contact.
        first = (
            whole[layout.LOAD] + whole[layout.N_CONTACTS] + whole[whole[layout.INPUTS] + contact]
        )
        w[place - inputs + k] = w[first + k]
    if bristle >= 0:
        for k in range(whole[whole[layout.BRISTLE_COUNTS] + contact]):
            w[place + k] = w[at + 2 * whole[layout.N_COORDINATES] + bristle + k]
        # Friction is affine in the load, which stands outside; rates of bristles are not.
        w[place + whole[whole[layout.BRISTLE_COUNTS] + contact]] = w[whole[layout.LOAD] + contact]
    return row


def bends(contact: int, whole: Wholes) -> bool:
    """Return whether bristles carry a contact's friction; a rule for rest takes it away."""
    mode = whole[whole[layout.MODES] + whole[whole[layout.SLIPS] + contact]]
    slips = mode in (layout.FORWARD, layout.BACKWARD, layout.FREE)
    return whole[whole[layout.BRISTLES] + contact] >= 0 and (
        slips or not whole[whole[layout.HOLDS] + contact]
    )


def ask_laws(fresh: bool, t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Write friction and levels of all contacts as constants and factors of their loads.

    Unless all is asked afresh, contacts keep what they had if their mode is as it was.
    """
    for c in range(whole[layout.N_CONTACTS]):
        mode = whole[whole[layout.MODES] + whole[whole[layout.SLIPS] + c]]
        if fresh or whole[whole[layout.ASKED] + c] != mode:
            whole[whole[layout.ASKED] + c] = mode
            ask_contact(c, mode, t, w, whole, at)


def ask_contact(contact: int, mode: int, t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Write friction and levels of a contact as constants and factors of its load.

    One that is pushed to its static level, in a decision, has that as its friction. Rates of
    bristles are written too, with the load at hand; those of open contacts rest.
    """
    constant, factor = whole[layout.FRICTION_CONSTANT], whole[layout.FRICTION_FACTOR]
    values = whole[layout.LAW_VALUES]
    levels = whole[layout.LEVEL_CONSTANT] + 2 * contact
    level_factors = whole[layout.LEVEL_FACTOR] + 2 * contact
    w[constant + contact] = 0.0
    w[factor + contact] = 0.0
    w[whole[layout.DAMPING] + contact] = 0.0
    for k in range(2):
        w[levels + k] = 0.0
        w[level_factors + k] = 0.0
    bristle = whole[whole[layout.BRISTLES] + contact]
    if whole[whole[layout.OPEN] + contact]:
        # An open contact has no friction, and its bristles keep their bend.
        for k in range(whole[whole[layout.BRISTLE_COUNTS] + contact]):
            w[whole[layout.BRISTLE_RATES] + bristle + k] = 0.0
        return
    side = side_of(contact, w, whole, at)
    ask_law(contact, side, t, w, whole, at)
    if bends(contact, whole):
        w[constant + contact] = side * w[values]
        w[factor + contact] = side * w[values + 1]
        for k in range(whole[whole[layout.BRISTLE_COUNTS] + contact]):
            w[whole[layout.BRISTLE_RATES] + bristle + k] = w[values + 7 + k]
        return
    for k in range(whole[whole[layout.BRISTLE_COUNTS] + contact]):
        w[whole[layout.BRISTLE_RATES] + bristle + k] = 0.0
    if mode in (layout.FORWARD, layout.BACKWARD):
        w[constant + contact] = side * w[values]
        w[factor + contact] = side * w[values + 1]
        # Slip speed is the factor times the rate, and the force along the coordinate the factor
        # times friction: damping has its square.
        own = w[whole[layout.SLIP_FACTORS] + contact]
        w[whole[layout.DAMPING] + contact] = (
            own * own * (w[values + 4] + w[values + 5] * w[whole[layout.LOAD] + contact])
        )
    elif mode not in (layout.HELD_FAST, layout.FREE):
        w[constant + contact] = side * w[values + 2]
        w[factor + contact] = side * w[values + 3]
    ahead = 0 if side > 0 else 1
    w[levels + ahead] = w[values + 2]
    w[level_factors + ahead] = w[values + 3]
    # A law without directions has the level that was just asked on both sides.
    if whole[whole[layout.DIRECTIONAL] + contact] and mode == layout.HELD_FAST:
        ask_law(contact, -side, t, w, whole, at)
    w[levels + 1 - ahead] = w[values + 2]
    w[level_factors + 1 - ahead] = w[values + 3]


def accelerate(w: Vector, whole: Wholes) -> None:
    """Write accelerations, needed friction and friction of slipping contacts for given loads."""
    n = whole[layout.N_COORDINATES]
    found, needed = whole[layout.ACCELERATION], whole[layout.NEEDED]
    force, friction = whole[layout.FORCE], whole[layout.FRICTION]
    modes, mass = whole[layout.MODES], whole[layout.MASS]
    for i in range(n):
        w[found + i] = w[force + i]
    loops = whole[layout.N_DIRECTIONS] > n
    for c in range(whole[layout.N_CONTACTS]):
        own = (
            w[whole[layout.FRICTION_CONSTANT] + c]
            + w[whole[layout.FRICTION_FACTOR] + c] * w[whole[layout.LOAD] + c]
        )
        w[friction + c] = own
        equations.spread(
            whole[whole[layout.SLIPS] + c], w[whole[layout.SLIP_FACTORS] + c] * own, found, w, whole
        )
    # All forces but inertia here; what couples held coordinates to free ones is taken off below.
    for i in range(n):
        w[needed + i] = w[found + i]
    solve_free(w, whole, found)
    if loops:
        bear(w, whole)
    for i in range(n):
        if whole[modes + i] != layout.HELD_FAST:
            w[needed + i] = 0.0
        elif not whole[layout.DIAGONAL]:  # else nothing couples them
            total = w[needed + i]
            for j in range(n):
                total -= w[mass + i * n + j] * w[found + j]
            w[needed + i] = total


@rare
def bear(w: Vector, whole: Wholes) -> None:
    """Write the forces that held contacts of loops have to bear, along all coordinates.

    NEEDED has the forces but those of inertia.
    """
    n = whole[layout.N_COORDINATES]
    for i in range(n):
        total = w[whole[layout.NEEDED] + i]
        for j in range(n):
            total -= w[whole[layout.MASS] + i * n + j] * w[whole[layout.ACCELERATION] + j]
        w[whole[layout.BORNE] + i] = total if whole[whole[layout.LOOPED] + i] else 0.0


def blur(i: int, w: Vector, whole: Wholes) -> float:
    """Return how much of the needed friction of a held coordinate may be rounding."""
    return WITHIN * size_of_forces(i, w, whole)


def share(w: Vector, whole: Wholes, at: int) -> None:
    """Write the levels of each coordinate, and the needed friction by contact.

    At a stop friction takes what it can of the force towards it, and the stop the rest. Reads
    loads, accelerations and needed friction.
    """
    levels = whole[layout.LEVELS]
    for i in range(2 * whole[layout.N_PAIRS]):
        w[levels + i] = 0.0
    for c in range(whole[layout.N_CONTACTS]):
        factor, load = w[whole[layout.SLIP_FACTORS] + c], w[whole[layout.LOAD] + c]
        for k in range(2):
            place = 2 * c + (k if factor > 0.0 else 1 - k)
            level = (
                w[whole[layout.LEVEL_CONSTANT] + place]
                + w[whole[layout.LEVEL_FACTOR] + place] * load
            )
            w[levels + 2 * whole[whole[layout.SLIPS] + c] + k] += abs(factor) * level
    if whole[layout.N_DIRECTIONS] > whole[layout.N_COORDINATES]:
        cut_levels(levels, w, whole)
        share_in_loops(w, whole)
    for c in range(whole[layout.N_CONTACTS]):
        i = whole[whole[layout.SLIPS] + c]
        if whole[whole[layout.MODES] + i] == layout.HELD_FAST and whole[whole[layout.HOLDS] + c]:
            factor, load = w[whole[layout.SLIP_FACTORS] + c], w[whole[layout.LOAD] + c]
            # Partners share in proportion to their levels, and so reach these at the same time.
            needed = w[whole[layout.NEEDED] + i]
            back = 0 if needed >= 0.0 else 1
            place = 2 * c + (back if factor > 0.0 else 1 - back)
            level = (
                w[whole[layout.LEVEL_CONSTANT] + place]
                + w[whole[layout.LEVEL_FACTOR] + place] * load
            )
            total = w[levels + 2 * i + back]
            if whole[layout.N_WALLS] > 0:
                needed = max(-total, min(total, needed))
            part = needed * level / total if total > 0.0 else 0.0
            w[whole[layout.FRICTION] + c] = part if factor > 0.0 else -part
    raise_levels(levels, w, whole, at)


def held_surplus(row: int, w: Vector, whole: Wholes) -> float:
    """Return the force that a held coordinate needs beside those that act on it."""
    n = whole[layout.N_COORDINATES]
    total = -w[whole[layout.FORCE] + n + row]
    for i in range(n):
        total += w[whole[layout.MASS] + (n + row) * n + i] * w[whole[layout.ACCELERATION] + i]
    for c in range(whole[layout.N_CONTACTS]):
        total += (
            w[whole[layout.HELD_SLIPS] + c * whole[layout.N_HELD] + row]
            * w[whole[layout.FRICTION] + c]
        )
    return total


def equal_part(contact: int, force: float, w: Vector, whole: Wholes) -> float:
    """Return the part that a held contact has in a force along its coordinate, in equal parts.

    This is affine in the loads, as shares in proportion to the levels are not. It makes no
    difference to the reactions where contacts of one coordinate slip at the same height.
    """
    i, partners = whole[whole[layout.SLIPS] + contact], 0
    for d in range(whole[layout.N_CONTACTS]):
        together = whole[whole[layout.SLIPS] + d] == i and whole[whole[layout.HOLDS] + d]
        partners += 1 if together and not whole[whole[layout.OPEN] + d] else 0
    return force / max(partners, 1) / w[whole[layout.SLIP_FACTORS] + contact]


def split(w: Vector, whole: Wholes) -> None:
    """Write the needed friction of held coordinates by contact, in equal parts."""
    for c in range(whole[layout.N_CONTACTS]):
        i = whole[whole[layout.SLIPS] + c]
        if whole[whole[layout.MODES] + i] == layout.HELD_FAST and whole[whole[layout.HOLDS] + c]:
            is_open = whole[whole[layout.OPEN] + c]
            own = 0.0 if is_open else equal_part(c, w[whole[layout.NEEDED] + i], w, whole)
            w[whole[layout.FRICTION] + c] = own


def react(w: Vector, whole: Wholes) -> None:
    """Write the loads that are reactions of held coordinates.

    All is affine in them, friction included: the rows that they must balance are evaluated without
    them and at a unit of each, and a system of as many equations is solved. Its determinant over
    that without friction is left in PIVOT: where it vanishes, so does the rigid body's answer.
    """
    for trial in range(whole[layout.N_REACTIONS] + 1):
        put_loads(trial - 1, whole[layout.LOAD], w, whole)
        accelerate(w, whole)
        split(w, whole)
        for row in range(whole[layout.N_REACTIONS]):
            note_surplus(trial, row, held_surplus(row, w, whole), w, whole)
    w[layout.PIVOT] = balance(whole[layout.LOAD], w, whole) / w[layout.FRICTIONLESS]


def put_loads(unit: int, to: int, w: Vector, whole: Wholes) -> None:
    """Set the reactions to 0, but one of them to 1."""
    k = 0
    for c in range(whole[layout.N_CONTACTS]):
        if whole[whole[layout.REACTS] + c]:
            w[to + c] = 1.0 if k == unit else 0.0
            k += 1


def note_surplus(trial: int, row: int, surplus: float, w: Vector, whole: Wholes) -> None:
    """Enter what a held coordinate lacks without reactions (trial 0), or with a unit of one."""
    count, wide = whole[layout.N_REACTIONS], whole[layout.N_REACTIONS] + 1
    rows = whole[layout.REACTION_ROWS]
    bare = rows + count * wide + row
    if trial == 0:
        w[bare] = surplus
    else:  # all is affine in the loads: the difference is the column of slopes, negated
        w[rows + row * wide + trial - 1] = w[bare] - surplus


def balance(to: int, w: Vector, whole: Wholes) -> float:
    """Write the reactions that leave no surplus; return the determinant of their equations."""
    count, wide = whole[layout.N_REACTIONS], whole[layout.N_REACTIONS] + 1
    rows = whole[layout.REACTION_ROWS]
    for row in range(count):
        w[rows + row * wide + count] = w[rows + count * wide + row]
    # What held coordinates lack is what loads give by their normals.
    add_normals(w, whole)
    found = determinant(w, rows, count)
    k = 0
    for c in range(whole[layout.N_CONTACTS]):
        if whole[whole[layout.REACTS] + c]:
            w[to + c] = w[rows + k * wide + count]
            k += 1
    return found


def add_normals(w: Vector, whole: Wholes) -> None:
    """Add to each row of the reactions what a unit of each load does to it by itself."""
    count, held = whole[layout.N_REACTIONS], whole[layout.N_HELD]
    k = 0
    for c in range(whole[layout.N_CONTACTS]):
        if whole[whole[layout.REACTS] + c]:
            for row in range(count):
                normal = w[whole[layout.HELD_NORMALS] + c * held + row]
                w[whole[layout.REACTION_ROWS] + row * (count + 1) + k] += normal
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


def refactor(w: Vector, whole: Wholes) -> None:
    """Factorise a constant mass matrix for the modes at hand; find what follows from others."""
    if whole[layout.N_DIRECTIONS] > whole[layout.N_COORDINATES]:
        find_followers(w, whole)
    if whole[layout.CONSTANT_MASS] and not whole[layout.DIAGONAL]:
        factorise(w, whole)


def refresh(t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Factorise anew what is constant as long as no mode changes, and write all there is."""
    refactor(w, whole)
    assemble(t, w, whole, at)


def assemble(t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Write everything at a state: accelerations, needed friction, levels, friction and loads."""
    equations.evaluate(equations.FORCES, 0, whole[layout.FLAGS], t, w, at, whole[layout.FORCE])
    if not whole[layout.CONSTANT_MASS]:
        put_mass(t, w, whole, at)
        factorise(w, whole)
    if not whole[layout.CONSTANT_LOADS]:
        equations.evaluate(equations.LOADS, 0, whole[layout.FLAGS], t, w, at, whole[layout.LOAD])
    apply_laws(True, t, w, whole, at)


def apply_laws(fresh: bool, t: float, w: Vector, whole: Wholes, at: int) -> None:
    """Write friction and what follows from it, where forces, mass matrix and loads are at hand."""
    reacts = whole[layout.N_REACTIONS] > 0
    # Reactions change with any mode: no answer of a law may be kept.
    ask_laws(fresh or reacts, t, w, whole, at)
    if reacts:
        react(w, whole)
        if whole[layout.HAS_BRISTLES]:
            ask_laws(True, t, w, whole, at)  # rates of bristles depend on the loads
    accelerate(w, whole)
    share(w, whole, at)


def reconsider(w: Vector, whole: Wholes) -> None:
    """Write everything anew at a state and a time at which only modes have changed since."""
    refactor(w, whole)
    if not whole[layout.CONSTANT_MASS]:
        factorise(w, whole)
    apply_laws(False, w[layout.TIME], w, whole, whole[layout.Y])


def put_motion(w: Vector, whole: Wholes, at: int) -> None:
    """Write a state, and behind it the accelerations and the friction that belong to it."""
    n, states, point = (
        whole[layout.N_COORDINATES],
        whole[layout.N_STATES],
        whole[layout.MOTION_POINT],
    )
    for i in range(states):
        w[point + i] = w[at + i]
    for i in range(n):
        w[point + states + i] = w[whole[layout.ACCELERATION] + i]
    for c in range(whole[layout.N_CONTACTS]):
        w[point + states + n + c] = w[whole[layout.FRICTION] + c]
