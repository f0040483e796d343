"""Loops of contacts: what follows while closing slips are held, and what can hold them.

The slip of a closing contact is a combination of coordinates. While it is held and they are not,
one of these follows from the others: the mass matrix is that of the others then, and nothing can
drift. A closing slip all of whose parts are held follows from them and needs nothing.

Held contacts of a loop have more forces than there are equations. They hold as long as some forces
within their levels balance all others, that is, as long as along no cut the force exceeds the sum
of the levels there. Which forces these are makes no difference to the motion. They are told to be
those that minimise the sum of their squares over the levels, within these: as if all contacts gave
way elastically, at one deflection up to their level, and then no more.
"""

from stickslip.engine.kernels.backend import IntVector, Vector, rare
from stickslip.engine.kernels.equations import combined, factor_of, size_along
from stickslip.engine.kernels.state_layout import (
    BORNE,
    CANDIDATES,
    FOLLOWED,
    FOLLOWERS,
    FREE,
    HELD_FAST,
    LEVELS,
    LOOPED,
    LOOPS,
    MASS,
    MODES,
    N_COORDINATES,
    N_DIRECTIONS,
    N_PAIRS,
    NEEDED,
    PROJECTED,
    RIGID,
    SHARES,
)

NOTHING = 1e-12
"""Share of a row below which what elimination leaves of it is rounding."""
MOST_LOADINGS = 8
"""Stages of loading for each direction: one ends where a level is reached, or where directions at
their levels are let go whose deflections fall. Random loops of up to ten contacts took 0.75 at
most. If stages run out, forces are left at the share that is loaded: they are within their levels
and do not balance all others; only what is told of them depends on that, no motion.
"""
BEYOND = 1e-9
"""Share of a force that deflections may leave where held contacts have reached their levels."""


def crossing(cut: int, direction: int, w: Vector, iw: IntVector) -> float:
    """Return the rate of a direction in the motion of a cut."""
    n, directions = iw[N_COORDINATES], iw[N_DIRECTIONS]
    # Rates of closing slips in the motions of cuts stand behind all rows of the coordinates.
    if direction < n:
        return w[iw[LOOPS] + (cut - n) * n + direction]
    first = iw[LOOPS] + (iw[N_PAIRS] - n) * n
    return w[first + (cut - directions) * (directions - n) + direction - n]


@rare
def scale_cuts(w: Vector, iw: IntVector) -> None:
    """Divide the motion of each cut by its largest rate; at values where it is none, leave zeros.

    Minors of rows have any size. Where rows are dependent at the values at hand, their minors are
    0, and the loop breaks open along other cuts.
    """
    n, directions = iw[N_COORDINATES], iw[N_DIRECTIONS]
    first = iw[LOOPS] + (iw[N_PAIRS] - n) * n
    for cut in range(directions, iw[N_PAIRS]):
        row, crossed = iw[LOOPS] + (cut - n) * n, first + (cut - directions) * (directions - n)
        largest = 0.0
        for j in range(n):
            largest = max(largest, abs(w[row + j]))
        for j in range(n):
            # A minor that should vanish is a difference of equal products, of which rounding is
            # left.
            w[row + j] = w[row + j] / largest if abs(w[row + j]) > NOTHING * largest else 0.0
        for d in range(directions - n):
            if w[crossed + d] != 0.0:  # what no motion of the cut crosses stays 0
                rate = combined(n + d, row, w, iw)
                beyond = abs(rate) > NOTHING * size_along(n + d, row, w, iw)
                w[crossed + d] = rate if beyond else 0.0


def leave(to: int, d: int, w: Vector, iw: IntVector) -> None:
    """Leave of a row over the coordinates what held ones and the first `d` closing slips do not."""
    n = iw[N_COORDINATES]
    # The size of the row before anything is left out tells what of it is rounding.
    size = 0.0
    for j in range(n):
        size = max(size, abs(w[to + j]))
        if iw[iw[MODES] + j] == HELD_FAST:
            w[to + j] = 0.0
    # Rows of followers are free of each other (`find_followers`), so that one pass does.
    for e in range(d):
        follower, other = iw[iw[FOLLOWERS] + e], iw[FOLLOWED] + e * n
        if follower >= 0 and w[to + follower] != 0.0:
            factor = w[to + follower]
            for j in range(n):
                w[to + j] -= factor * w[other + j]
            w[to + follower] = 0.0
    for j in range(n):
        if abs(w[to + j]) <= NOTHING * size:
            w[to + j] = 0.0


@rare
def find_followers(w: Vector, iw: IntVector) -> None:
    """Choose the coordinates that follow from others, for the modes at hand; set those of cuts.

    A cut is watched as a held coordinate is as long as a held direction has a part in it.
    """
    n, directions, modes = iw[N_COORDINATES], iw[N_DIRECTIONS], iw[MODES]
    for d in range(directions - n):
        row = iw[FOLLOWED] + d * n
        iw[iw[FOLLOWERS] + d] = -1
        if iw[modes + n + d] != HELD_FAST:
            continue
        for j in range(n):
            w[row + j] = factor_of(n + d, j, w, iw)
        leave(row, d, w, iw)
        # The largest entry is divided by: it follows, and the others stay below 1.
        best, largest = -1, 0.0
        for j in range(n):
            if abs(w[row + j]) > largest:
                best, largest = j, abs(w[row + j])
        if best < 0:  # held by others already: it needs nothing
            continue
        pivot = w[row + best]
        for j in range(n):
            w[row + j] /= pivot
        iw[iw[FOLLOWERS] + d] = best
        # Earlier rows lose the new follower, as Gauss and Jordan do.
        for e in range(d):
            other = iw[FOLLOWED] + e * n
            if iw[iw[FOLLOWERS] + e] >= 0 and w[other + best] != 0.0:
                factor = w[other + best]
                for j in range(n):
                    w[other + j] -= factor * w[row + j]
                w[other + best] = 0.0
    watch_cuts(w, iw)


def watch_cuts(w: Vector, iw: IntVector) -> None:
    """Set the modes of all cuts, for those of the directions."""
    directions, modes = iw[N_DIRECTIONS], iw[MODES]
    # A cut is one more direction to watch, but never one to be decided: its mode follows.
    for cut in range(directions, iw[N_PAIRS]):
        iw[modes + cut] = FREE
        for i in range(directions):
            if iw[modes + i] == HELD_FAST and crossing(cut, i, w, iw) != 0.0:
                iw[modes + cut] = HELD_FAST


@rare
def is_bound(i: int, w: Vector, iw: IntVector) -> bool:
    """Return whether nothing can move along a direction, for others are held."""
    n, row = iw[N_COORDINATES], iw[SHARES]
    for j in range(n):
        w[row + j] = factor_of(i, j, w, iw)
    leave(row, iw[N_DIRECTIONS] - n, w, iw)
    free = False
    for j in range(n):
        free = free or w[row + j] != 0.0
    return not free


@rare
def close_loops(waiting: bool, w: Vector, iw: IntVector) -> None:
    """Hold all that others hold already, or of these what is to be decided."""
    find_followers(w, iw)
    for i in range(iw[N_DIRECTIONS]):
        mode = iw[iw[MODES] + i]
        decided = iw[iw[LOOPED] + i] == 1 and iw[iw[RIGID] + i] == 1
        decided = decided and (not waiting or iw[iw[CANDIDATES] + i] == 1)
        if decided and mode not in (HELD_FAST, FREE) and is_bound(i, w, iw):
            iw[iw[MODES] + i] = HELD_FAST
    find_followers(w, iw)  # what is held now makes others follow


@rare
def project_mass(w: Vector, iw: IntVector) -> int:
    """Write the mass matrix of the coordinates from which others follow; return its place.

    Rows of followers are those of 1.
    """
    n, to = iw[N_COORDINATES], iw[PROJECTED]
    for i in range(n * n):
        w[to + i] = w[iw[MASS] + i]
    for d in range(iw[N_DIRECTIONS] - n):
        p, row = iw[iw[FOLLOWERS] + d], iw[FOLLOWED] + d * n
        if p < 0:
            continue
        # T^T M T, where T gives all coordinates by those that are left: columns first, then rows.
        for j in range(n):
            factor = w[row + j]
            if j != p and factor != 0.0:
                for i in range(n):
                    w[to + i * n + j] -= factor * w[to + i * n + p]
                for i in range(n):
                    w[to + j * n + i] -= factor * w[to + p * n + i]
        for i in range(n):
            w[to + i * n + p] = 0.0
            w[to + p * n + i] = 0.0
        w[to + p * n + p] = 1.0
    return to


@rare
def fold(right: int, w: Vector, iw: IntVector) -> None:
    """Add forces on followers to those on what they follow from."""
    n = iw[N_COORDINATES]
    # Virtual work: a force on a follower acts on what it follows from with its factor, negated.
    for d in range(iw[N_DIRECTIONS] - n):
        p, row = iw[iw[FOLLOWERS] + d], iw[FOLLOWED] + d * n
        if p >= 0:
            for j in range(n):
                if j != p:
                    w[right + j] -= w[row + j] * w[right + p]
            w[right + p] = 0.0


def mass_along(i: int, w: Vector, iw: IntVector) -> float:
    """Return the inertia of a motion along a coordinate, or that of a cut."""
    n = iw[N_COORDINATES]
    if i < n:
        return w[iw[MASS] + i * n + i]
    return mass_of_sum(i, w, iw)


@rare
def mass_of_sum(i: int, w: Vector, iw: IntVector) -> float:
    """Return the inertia of the motion of a cut."""
    n, total = iw[N_COORDINATES], 0.0
    for j in range(n):
        total += factor_of(i, j, w, iw) * combined(i, iw[MASS] + j * n, w, iw)
    return total


@rare
def cut_levels(levels: int, w: Vector, iw: IntVector) -> None:
    """Write the levels of all cuts, from those of the held directions that have a part in each."""
    for cut in range(iw[N_DIRECTIONS], iw[N_PAIRS]):
        w[levels + 2 * cut] = 0.0
        w[levels + 2 * cut + 1] = 0.0
        for i in range(iw[N_DIRECTIONS]):
            rate = crossing(cut, i, w, iw)
            if iw[iw[MODES] + i] == HELD_FAST and rate != 0.0:
                along = 0 if rate > 0.0 else 1
                w[levels + 2 * cut] += abs(rate) * w[levels + 2 * i + along]
                w[levels + 2 * cut + 1] += abs(rate) * w[levels + 2 * i + 1 - along]


@rare
def share_in_loops(w: Vector, iw: IntVector) -> None:
    """Write the force along each cut, and the needed friction of each held direction of a loop.

    Forces grow in proportion up to those at hand, and deflections with them. A direction whose
    level is reached has that, unless its deflection falls again; directions of a level of 0 have
    nothing.
    """
    n, directions, needed = iw[N_COORDINATES], iw[N_DIRECTIONS], iw[NEEDED]
    for cut in range(directions, iw[N_PAIRS]):
        held = iw[iw[MODES] + cut] == HELD_FAST
        w[needed + cut] = combined(cut, iw[BORNE], w, iw) if held else 0.0
    # Scratch behind the equations of the deflections: their growth, and where levels are reached.
    rates = iw[SHARES] + n * (n + 2)
    clamped = rates + directions
    for i in range(directions):
        w[clamped + i] = 0.0
        if iw[iw[LOOPED] + i]:
            w[needed + i] = 0.0
    reached = 0.0
    for _ in range(MOST_LOADINGS * directions):
        if reached >= 1.0 or not grow(rates, clamped, w, iw):
            return
        # Where something was let go, growth is another: nothing is loaded before it is known.
        if not release(rates, clamped, w, iw):
            reached += load_on(1.0 - reached, rates, clamped, w, iw)


def release(rates: int, clamped: int, w: Vector, iw: IntVector) -> bool:
    """Let directions at their levels go whose deflections fall; return whether there are any."""
    released = False
    for i in range(iw[N_DIRECTIONS]):
        # it moves back from the side at which it is clamped
        if w[clamped + i] * w[rates + i] < 0.0:
            w[clamped + i] = 0.0
            released = True
    return released


def load_on(rest: float, rates: int, clamped: int, w: Vector, iw: IntVector) -> float:
    """Load until a level is reached, or all of the rest is on; return the share that was added."""
    needed, step, which = iw[NEEDED], rest, -1
    for i in range(iw[N_DIRECTIONS]):
        # Deflections grow at one rate; forces by their stiffnesses, up to the first level.
        rate = stiffness(i, w, iw) * w[rates + i]
        if w[clamped + i] == 0.0 and rate != 0.0:
            level = w[iw[LEVELS] + 2 * i + (0 if rate > 0.0 else 1)]
            side = 1.0 if rate > 0.0 else -1.0
            room = max((level - side * w[needed + i]) / abs(rate), 0.0)
            if room < step:
                step, which = room, i
    for i in range(iw[N_DIRECTIONS]):
        if w[clamped + i] == 0.0:
            w[needed + i] += step * stiffness(i, w, iw) * w[rates + i]
    if which >= 0:
        forward = w[rates + which] > 0.0
        w[clamped + which] = 1.0 if forward else -1.0
        # The level itself: rounding of many stages must not add up.
        level = w[iw[LEVELS] + 2 * which + (0 if forward else 1)]
        w[needed + which] = level if forward else -level
    return step


def stiffness(i: int, w: Vector, iw: IntVector) -> float:
    """Return the stiffness with which a held direction of a loop shares: the mean of its levels."""
    if not iw[iw[LOOPED] + i] or iw[iw[MODES] + i] != HELD_FAST:
        return 0.0
    return 0.5 * (w[iw[LEVELS] + 2 * i] + w[iw[LEVELS] + 2 * i + 1])


def grow(rates: int, clamped: int, w: Vector, iw: IntVector) -> bool:
    """Write how deflections grow with the forces, unless too few are below their levels."""
    n, wide, rows = iw[N_COORDINATES], iw[N_COORDINATES] + 1, iw[SHARES]
    growth, size = rows + n * wide, 0.0
    put_stiffness(clamped, w, iw)
    for j in range(n):
        w[growth + j] = 0.0
        size = max(size, abs(w[rows + j * wide + n]))
    eliminate(growth, w, iw)
    for j in range(n):
        used = w[growth + j] != 0.0
        w[growth + j] = w[rows + j * wide + n] if used else 0.0
        # A force that no stiffness below its level can balance: the rest cannot be put on.
        if not used and abs(w[rows + j * wide + n]) > BEYOND * size:
            return False
    for i in range(iw[N_DIRECTIONS]):
        w[rates + i] = combined(i, growth, w, iw)
    return size > 0.0


def put_stiffness(clamped: int, w: Vector, iw: IntVector) -> None:
    """Write the equations of the deflections: stiffnesses of what is not at its level, forces."""
    n, wide, rows = iw[N_COORDINATES], iw[N_COORDINATES] + 1, iw[SHARES]
    for j in range(n):
        for k in range(n):
            w[rows + j * wide + k] = 0.0
        w[rows + j * wide + n] = w[iw[BORNE] + j]
    for i in range(iw[N_DIRECTIONS]):
        weight = stiffness(i, w, iw) if w[clamped + i] == 0.0 else 0.0
        for j in range(n):
            own = weight * factor_of(i, j, w, iw)
            if own != 0.0:
                for k in range(n):
                    w[rows + j * wide + k] += own * factor_of(i, k, w, iw)


def eliminate(used: int, w: Vector, iw: IntVector) -> None:
    """Solve the equations of deflections as far as there are stiffnesses; mark rows used."""
    n, wide, rows = iw[N_COORDINATES], iw[N_COORDINATES] + 1, iw[SHARES]
    largest = 0.0
    for j in range(n):
        largest = max(largest, w[rows + j * wide + j])
    # The matrix is symmetric and semidefinite: diagonal pivots are enough, and none below rounding
    # counts.
    for _ in range(n):
        best, pivot = -1, NOTHING * largest
        for j in range(n):
            if w[used + j] == 0.0 and w[rows + j * wide + j] > pivot:
                best, pivot = j, w[rows + j * wide + j]
        if best < 0:
            return
        w[used + best] = 1.0
        for k in range(wide):
            w[rows + best * wide + k] /= pivot
        for j in range(n):
            factor = w[rows + j * wide + best]
            if j != best and factor != 0.0:
                for k in range(wide):
                    w[rows + j * wide + k] -= factor * w[rows + best * wide + k]
