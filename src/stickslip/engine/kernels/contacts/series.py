"""Exact propagation of linear modes with several contacts: sparse Taylor series.

While modes hold, forces are h + S (q, q') + s_t t, with sparse constant slopes S, and slipping
contacts damp by D. With q(t + x h) = sum of q_k x^k, x from 0 to 1, and so q', accelerations and
needed friction r,

    f_k     = S (q_k, q'_k) - D q'_k            (and h s_t where k = 1, or a power of a harmonic)
    M a_k   = f_k along what is free,  r_k = f_k - M a_k along what is held
    q_{k+1} = h q'_k / (k + 1),        q'_{k+1} = h a_k / (k + 1)

at the cost of the slopes and contacts, not of a matrix of all states. The series ends after two
terms in a row that vanish beside the largest one. The needed friction has a series of its own:
where nothing moves any more it still grows with the drives. A step is judged by the tail of its
series; it is as exact as numbers are.

Guards are sums of these series, that is, polynomials in x (`first_contact_crossing`): one whose
terms add up to less than its value cannot fall and is passed over; the first fall of others is
found in Bernstein form, only up to just behind the earliest one that is known. What falls in the
same instant, within rounding of the time, changes together.
"""

import math

from stickslip.engine.kernels import equations
from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector, rare
from stickslip.engine.kernels.contacts import assembly
from stickslip.engine.kernels.guard_roots import NO_GUARD, largest_term, size_of_forces
from stickslip.engine.kernels.mode_transitions import UNMOVED, wall_coordinate, wall_side
from stickslip.engine.kernels.numerics import FALLS_AT_ONCE, NEVER_FALLS, first_fall, interpolate
from stickslip.engine.kernels.steppers import VANISHED, fill_waves, series_tail, wave_at, waves_tail

STILLNESS = 1e-14
"""Acceleration over the forces that make it up, below which they balance but for rounding."""

LEAST_SLACK = 1e-12
"""Share of a step beyond the earliest fall known in which others are looked for all the same."""
TOGETHER = 4e-15
"""Time between two falls that are one, over the larger of the present time and the step."""


def contact_series(h: float, w: Vector, iw: IntVector, at: int) -> None:
    """Fill the dense output, and the series of needed friction, from the state at `at`.

    It begins at TIME.
    """
    assembly.assemble(w[layout.TIME], w, iw, at)
    fill_series(h, w, iw, at)


def fill_series(h: float, w: Vector, iw: IntVector, at: int) -> None:
    """Fill the series where accelerations and needed friction at the state are at hand."""
    n, states = iw[layout.N_COORDINATES], iw[layout.N_STATES]
    largest = iw[layout.POINT]
    equations.evaluate(
        equations.FORCE_SLOPES,
        0,
        iw[layout.FLAGS],
        w[layout.TIME],
        w,
        at,
        iw[layout.SLOPE_VALUES],
    )
    # Terms hold the powers of the step: the series is one in its fraction, from 0 to 1.
    last = iw[layout.DENSE] + 1
    for i in range(n):
        w[last + i] = w[at + i]
        w[last + n + i] = w[at + n + i]
        w[last + states + i] = h * w[at + n + i]
        w[last + states + n + i] = h * w[iw[layout.ACCELERATION] + i]
    for i in range(iw[layout.N_PAIRS]):
        w[iw[layout.NEEDED_SERIES] + i] = w[iw[layout.NEEDED] + i]
    # Largest terms so far, beside which later ones vanish.
    for i in range(states):
        w[largest + i] = max(abs(w[last + i]), abs(w[last + states + i]))
    last += states
    small, terms = 0, 1
    waving = fill_waves(w[layout.TIME], h, w, iw, at)
    while terms < layout.SERIES and small < 2:
        next_forces(terms, h, last, waving, w, iw)
        ratio = h / (terms + 1.0)
        # Before the last harmonic that counts, terms may vanish by themselves for a while.
        ended = terms >= waving
        for i in range(n):
            speed = ratio * w[last + n + i]
            growth = ratio * w[iw[layout.DRIFT] + i]
            w[last + states + i] = speed
            w[last + states + n + i] = growth
            w[largest + i] = max(w[largest + i], abs(speed))
            w[largest + n + i] = max(w[largest + n + i], abs(growth))
            ended = ended and abs(speed) <= VANISHED * w[largest + i]
            ended = ended and abs(growth) <= VANISHED * w[largest + n + i]
        # Even or odd terms alone may vanish: two in a row are asked for.
        small = small + 1 if ended else 0
        terms += 1
        last += states
    w[iw[layout.DENSE]] = terms - small
    w[iw[layout.BOUNDS]] = terms  # of the needed friction, which may go on where nothing moves
    # Speeds of closing slips are combinations of those of coordinates, term by term.
    for i in range(n, iw[layout.N_DIRECTIONS]):
        for k in range(terms - small + 1):
            rate = equations.combined(i, iw[layout.DENSE] + 1 + k * states + n, w, iw)
            w[iw[layout.NEEDED_SERIES] + k * iw[layout.N_PAIRS] + i] = rate


def next_forces(terms: int, h: float, last: int, waving: int, w: Vector, iw: IntVector) -> None:
    """Write one term of the accelerations to DRIFT and one of the needed friction."""
    n = iw[layout.N_COORDINATES]
    row = iw[layout.NEEDED_SERIES] + terms * iw[layout.N_PAIRS]
    slopes = iw[layout.SLOPE_VALUES]
    modes, result = iw[layout.MODES], iw[layout.DRIFT]
    k, count = 0, iw[layout.N_SLOPES]
    for i in range(n):  # the slopes stand row by row
        total = 0.0
        while k < count and iw[iw[layout.SLOPE_ROWS] + k] == i:
            total += w[slopes + k] * w[last + iw[iw[layout.SLOPE_COLUMNS] + k]]
            k += 1
        w[row + i] = total
    # Forces are affine in the time, which so has a slope in the first term alone.
    if terms == 1:
        for k in range(iw[layout.N_TIME_SLOPES]):
            w[row + iw[iw[layout.TIME_ROWS] + k]] += h * w[slopes + iw[layout.N_SLOPES] + k]
    elif waving > 0:
        add_waves(terms, row, w, iw)
    damp(last + n, row, w, iw)
    for i in range(n):
        w[result + i] = w[row + i]
    assembly.solve_free(w, iw, result)
    if iw[layout.N_DIRECTIONS] > n:
        leave_to_loops(row, w, iw)
    for i in range(n):
        if iw[modes + i] != layout.HELD_FAST:
            w[row + i] = 0.0  # what is free needs nothing
        elif not iw[layout.DIAGONAL]:
            total = w[row + i]
            for j in range(n):
                total -= w[iw[layout.MASS] + i * n + j] * w[result + j]
            w[row + i] = total


def add_waves(terms: int, to: int, w: Vector, iw: IntVector) -> None:
    """Add a power of the harmonics to a term of the forces."""
    power, waves = wave_at(terms, w, iw)
    for k in range(iw[layout.N_TIME_SLOPES]):
        w[to + iw[iw[layout.TIME_ROWS] + k]] += power * w[waves + k]


def damp(rates: int, to: int, w: Vector, iw: IntVector) -> None:
    """Take the damping of slipping contacts away from a term of the forces."""
    n = iw[layout.N_COORDINATES]
    # DAMPING has the slip factor squared in it: it is that of the force along the coordinate.
    for c in range(iw[layout.N_CONTACTS]):
        damping = w[iw[layout.DAMPING] + c]
        if damping != 0.0:
            i = iw[iw[layout.SLIPS] + c]
            if i < n:
                w[to + i] -= damping * w[rates + i]
            else:
                equations.spread(i, damping * equations.combined(i, rates, w, iw), to, w, iw)


@rare
def leave_to_loops(to: int, w: Vector, iw: IntVector) -> None:
    """Write a term of the forces along all cuts; DRIFT has that of the accelerations."""
    n, borne = iw[layout.N_COORDINATES], iw[layout.BORNE]
    for i in range(n):
        total = w[to + i]
        for j in range(n):
            total -= w[iw[layout.MASS] + i * n + j] * w[iw[layout.DRIFT] + j]
        w[borne + i] = total
    for cut in range(iw[layout.N_DIRECTIONS], iw[layout.N_PAIRS]):
        w[to + cut] = equations.combined(cut, borne, w, iw)


def contact_series_step(h: float, w: Vector, iw: IntVector) -> float:
    """Try a step; return the tail of its series over what is allowed, the solution in Y1.

    The state has been assembled: by the decision before it, or by the audit of the step before it.
    """
    w[layout.LENGTH] = h
    fill_series(h, w, iw, iw[layout.Y])
    interpolate(w, iw, 1.0, iw[layout.Y1])
    return max(series_tail(h, w, iw), waves_tail(w, iw))


def is_balanced(i: int, w: Vector, iw: IntVector) -> bool:
    """Whether forces on a coordinate that begins to slip balance but for their rounding.

    Where inertia couples coordinates, those of all others count as they reach this one, by its row
    of the inverse mass matrix. The time is rounded, too.
    """
    n = iw[layout.N_COORDINATES]
    if iw[iw[layout.LOOPED] + i]:
        return is_looped_balanced(i, w, iw)
    size = abs(w[iw[layout.FORCE] + i])
    for k in range(iw[layout.N_SLOPES]):
        if iw[iw[layout.SLOPE_ROWS] + k] == i:
            column = iw[iw[layout.SLOPE_COLUMNS] + k]
            size += abs(w[iw[layout.SLOPE_VALUES] + k] * w[iw[layout.Y] + column])
    for c in range(iw[layout.N_CONTACTS]):
        if iw[iw[layout.SLIPS] + c] == i:
            size += abs(w[iw[layout.SLIP_FACTORS] + c] * w[iw[layout.FRICTION] + c])
    result = abs(w[iw[layout.ACCELERATION] + i]) - change_in_a_tick(i, w, iw)
    if iw[layout.DIAGONAL]:
        return result * w[iw[layout.MASS] + i * n + i] <= STILLNESS * size
    # A row of the inverse mass matrix, which is symmetric: the answer to a unit force.
    row = iw[layout.VALUES]
    for j in range(n):
        w[row + j] = 1.0 if j == i else 0.0
    assembly.solve_free(w, iw, row)
    size *= abs(w[row + i])
    for j in range(n):
        size += abs(w[row + j]) * size_of_forces(j, w, iw)
    return result <= STILLNESS * size


@rare
def is_looped_balanced(i: int, w: Vector, iw: IntVector) -> bool:
    """Whether forces on a slip of a loop that begins balance but for their rounding."""
    n, row = iw[layout.N_COORDINATES], iw[layout.VALUES]
    for j in range(n):
        w[row + j] = equations.factor_of(i, j, w, iw)
    assembly.solve_free(w, iw, row)
    size = 0.0
    for j in range(n):
        size += abs(w[row + j]) * size_of_forces(j, w, iw)
    for c in range(iw[layout.N_CONTACTS]):
        force = w[iw[layout.SLIP_FACTORS] + c] * w[iw[layout.FRICTION] + c]
        size += abs(force * equations.combined(iw[iw[layout.SLIPS] + c], row, w, iw))
    result = abs(equations.combined(i, iw[layout.ACCELERATION], w, iw)) - change_in_a_tick(i, w, iw)
    return result <= STILLNESS * size


def change_in_a_tick(i: int, w: Vector, iw: IntVector) -> float:
    """Return how much the acceleration of a slip changes within the rounding of the time.

    It is the second term of the series of its speed that tells.
    """
    h, n = w[layout.LENGTH], iw[layout.N_COORDINATES]
    if i < n:
        growth = w[iw[layout.DENSE] + 1 + 2 * iw[layout.N_STATES] + n + i]
    else:
        growth = w[iw[layout.NEEDED_SERIES] + 2 * iw[layout.N_PAIRS] + i]
    return STILLNESS * 2.0 * abs(growth) / h * max(1.0, w[layout.TIME] / h)


def search(
    value: float,
    bound: float,
    slack: float,
    row: int,
    width: int,
    sign: float,
    count: int,
    balanced: int,
    w: Vector,
) -> float:
    """Return the first fall of ``value + sign * (terms of a column)``, from POLYNOMIAL's start.

    The terms stand `width` apart from the place `row` on; `bound` is the sum of their sizes. The
    first `balanced` of them are rounding, and left out. The interval that is searched ends `slack`
    behind the earliest fall known, in FRACTION: coefficients are scaled by its powers.
    """
    reach = min(1.0, w[layout.FRACTION] + slack)
    # Each term has a power of the fraction of one at least: up to `reach` they add up to this at
    # most.
    if value > reach * bound:
        return NEVER_FALLS
    power = 1.0
    total = 0.0
    w[layout.POLYNOMIAL] = value
    for k in range(1, count + 1):
        power *= reach
        w[layout.POLYNOMIAL + k] = sign * power * w[row + (k - 1) * width]
        total += abs(w[layout.POLYNOMIAL + k])
    for k in range(1, balanced + 1):
        # Rounding as a first coefficient would decide the sign of all that follows.
        w[layout.POLYNOMIAL + k] = 0.0
    if value > total:
        return NEVER_FALLS
    x = first_fall(w, count)
    return reach * x if 0.0 < x <= 1.0 else x


def first_contact_crossing(w: Vector, iw: IntVector) -> int:
    """Find the first guard of a step that falls below zero, with its fraction in FRACTION.

    Guards that cannot fall, for the sum of their terms is less than their value, are passed over;
    the sums are made row by row, in the order in which the series lies in memory. Falls of all
    other guards are left in ROOTS: what falls in the same instant changes together.
    """
    n, states, pairs = iw[layout.N_COORDINATES], iw[layout.N_STATES], iw[layout.N_PAIRS]
    terms, count = int(w[iw[layout.DENSE]]), int(w[iw[layout.BOUNDS]]) - 1
    moved, grown = iw[layout.POINT], iw[layout.DRIFT]
    # POINT and DRIFT keep the sums of sizes: what speeds and needed friction can change by.
    sum_terms(iw[layout.DENSE] + 1 + states + n, states, terms, moved, n, w)
    sum_terms(iw[layout.NEEDED_SERIES] + pairs, pairs, count, grown, pairs, w)
    best = NO_GUARD
    w[layout.FRACTION] = 1.0
    for guard in range(2 * pairs):
        w[iw[layout.ROOTS] + guard] = NEVER_FALLS
    h = w[layout.LENGTH]
    # Falls closer than two ticks of the clock are one.
    slack = max(LEAST_SLACK, 2.0 * TOGETHER * max(abs(w[layout.TIME]), h) / h)
    early = nearest_guard(w, iw)  # what falls early leaves little of the step to the others
    if early != NO_GUARD:
        best = look_at(early, best, slack, w, iw)
    for guard in range(2 * pairs):
        if w[layout.FRACTION] == 0.0:
            return best
        if guard != early:
            best = look_at(guard, best, slack, w, iw)
    if iw[layout.N_SWITCHES] > 0:
        best = first_switch(best, slack, w, iw)
    return (
        first_stop(best, slack, w, iw)
        if iw[layout.N_WALLS] > 0 and w[layout.FRACTION] > 0.0
        else best
    )


@rare
def first_switch(best: int, slack: float, w: Vector, iw: IntVector) -> int:
    """Return the guard that falls first, those of the mechanism's own switches included."""
    states, terms, dense = (
        iw[layout.N_STATES],
        int(w[iw[layout.DENSE]]),
        iw[layout.DENSE] + 1,
    )
    first = iw[layout.FIRST_LIMIT] - iw[layout.N_SWITCHES]
    margins, slopes, h = iw[layout.LAW_VALUES], iw[layout.SLOPES], w[layout.LENGTH]
    equations.evaluate(
        equations.MARGINS, 0, iw[layout.FLAGS], w[layout.TIME], w, iw[layout.Y], margins
    )
    equations.evaluate(
        equations.MARGIN_SLOPES_OF,
        0,
        iw[layout.FLAGS],
        w[layout.TIME],
        w,
        iw[layout.Y],
        slopes,
    )
    for j in range(iw[layout.N_SWITCHES]):
        sign = 1.0 if iw[layout.FLAGS] & (1 << j) else -1.0
        value, reached, row = sign * w[margins + j], iw[layout.REACHED] + first + j, slopes
        row += j * (states + 1)
        w[reached] = max(w[reached], abs(value))
        if -UNMOVED * w[reached] <= value < 0.0:
            value = 0.0  # it has just been turned, within rounding of its threshold
        reach, power, total = min(1.0, w[layout.FRACTION] + slack), 1.0, 0.0
        w[layout.POLYNOMIAL] = value
        for k in range(1, terms + 1):
            power *= reach
            term = h * w[row + states] if k == 1 else 0.0
            for i in range(states):
                if value != 0.0 or k > 2 or not is_still(i, k, w, iw):
                    term += w[row + i] * w[dense + k * states + i]
            w[layout.POLYNOMIAL + k] = sign * power * term
            total += abs(w[layout.POLYNOMIAL + k])
        if value > total:
            continue
        x = first_fall(w, terms)
        if x == FALLS_AT_ONCE:
            w[layout.FRACTION] = 0.0
            return first + j
        if x <= 1.0 and (reach * x < w[layout.FRACTION] or (reach * x == 1.0 and best == NO_GUARD)):
            w[layout.FRACTION] = reach * x
            best = first + j
    return best


def is_still(state: int, power: int, w: Vector, iw: IntVector) -> bool:
    """Whether a term of a place or a rate is rounding, as something begins that is balanced."""
    n = iw[layout.N_COORDINATES]
    i = state % n
    if power > (2 if state < n else 1) or w[iw[layout.Y] + n + i] != 0.0:
        return False
    return is_balanced(i, w, iw)


def first_stop(best: int, slack: float, w: Vector, iw: IntVector) -> int:
    """Return the guard that falls first, those of hard stops included."""
    states, terms = iw[layout.N_STATES], int(w[iw[layout.DENSE]])
    first, values = iw[layout.FIRST_WALL], iw[layout.VALUES]
    assembly.stop_guards(w, iw, iw[layout.Y], values, math.inf)
    for wall in range(iw[layout.N_WALLS]):
        margin = w[values + first + wall]
        if margin == math.inf:
            continue
        reached = iw[layout.REACHED] + first + wall
        w[reached] = max(w[reached], abs(margin))
        i, side = wall_coordinate(wall, iw), wall_side(wall, iw)
        # what leaves its stop as its press ends has neither speed nor acceleration yet
        leaves = margin == 0.0 and w[iw[layout.Y] + iw[layout.N_COORDINATES] + i] == 0.0
        balanced = 2 if leaves and is_balanced(i, w, iw) else 0
        row = iw[layout.DENSE] + 1 + states + i
        # The margin is side * (position - place), so that terms of the place enter negated. No sum
        # of their sizes is at hand: infinity.
        x = search(margin, math.inf, slack, row, states, -side, terms, balanced, w)
        if x == FALLS_AT_ONCE:
            w[layout.FRACTION] = 0.0
            return first + wall
        if x < w[layout.FRACTION] or (x == 1.0 and best == NO_GUARD):
            w[layout.FRACTION] = x
            best = first + wall
    return best


def value_of(guard: int, w: Vector, iw: IntVector) -> float:
    """Return a guard at the start of the step; infinity for one that nothing watches.

    What is held within rounding of its level has the allowance of decisions: they held it.
    """
    n, i = iw[layout.N_COORDINATES], guard // 2
    mode = iw[iw[layout.MODES] + i]
    if i >= n and mode != layout.HELD_FAST:
        return (
            mode * equations.slip_rate_along(i, iw[layout.Y], w, iw)
            if is_slip(guard, iw)
            else math.inf
        )
    if mode == layout.HELD_FAST:
        if iw[layout.N_PAIRS] > n and iw[iw[layout.LOOPED] + i]:
            return math.inf
        level = w[iw[layout.LEVELS] + guard]
        value = level + side_sign(guard) * w[iw[layout.NEEDED_SERIES] + i]
        spare = assembly.WITHIN * level + assembly.blur(i, w, iw) if level < math.inf else 0.0
        return value + spare if value < spare else value
    if mode in (layout.FORWARD, layout.BACKWARD) and guard % 2 == 0:
        return mode * w[iw[layout.Y] + n + i]
    return math.inf


def is_slip(guard: int, iw: IntVector) -> bool:
    """Whether a guard is that of the speed of something that slips."""
    return iw[iw[layout.MODES] + guard // 2] in (layout.FORWARD, layout.BACKWARD) and guard % 2 == 0


def side_sign(guard: int) -> float:
    """Return the sign with which needed friction enters a guard: less the level ahead first."""
    return -1.0 if guard % 2 == 0 else 1.0


def nearest_guard(w: Vector, iw: IntVector) -> int:
    """Return the guard that would fall first if all went on as they begin, or `NO_GUARD`."""
    n, states, pairs = iw[layout.N_COORDINATES], iw[layout.N_STATES], iw[layout.N_PAIRS]
    best, least = NO_GUARD, 1.0
    for guard in range(2 * pairs):
        i = guard // 2
        if iw[iw[layout.MODES] + i] == layout.HELD_FAST:
            slope = side_sign(guard) * w[iw[layout.NEEDED_SERIES] + pairs + i]
        elif i < n:
            slope = iw[iw[layout.MODES] + i] * w[iw[layout.DENSE] + 1 + states + n + i]
        # Behind the coordinates this series has the speeds of closing slips that slip.
        else:
            slope = iw[iw[layout.MODES] + i] * w[iw[layout.NEEDED_SERIES] + pairs + i]
        value = value_of(guard, w, iw)
        if value > 0.0 and value < -least * slope:
            best, least = guard, -value / slope
    return best


def look_at(guard: int, best: int, slack: float, w: Vector, iw: IntVector) -> int:
    """Note where a guard falls, if it does before the best one; return which of them is first."""
    n, states, i = iw[layout.N_COORDINATES], iw[layout.N_STATES], guard // 2
    pairs = iw[layout.N_PAIRS]
    mode, value = iw[iw[layout.MODES] + i], value_of(guard, w, iw)
    if value == math.inf:
        return best
    if mode == layout.HELD_FAST:
        w[iw[layout.REACHED] + guard] = max(w[iw[layout.REACHED] + guard], abs(value))
        row, count = iw[layout.NEEDED_SERIES] + pairs + i, int(w[iw[layout.BOUNDS]]) - 1
        bound, sign = w[iw[layout.DRIFT] + i], side_sign(guard)
        # Where nothing can hold it, growth below the rounding of the inertia forces is no growth.
        loose = w[iw[layout.LEVELS] + guard] == 0.0 and i < n
        balanced = 1 if loose and abs(w[row]) <= STILLNESS * growth_of_forces(i, w, iw) else 0
        x = search(value, bound, slack, row, pairs, sign, count, balanced, w)
    else:
        balanced = 1 if value == 0.0 and is_balanced(i, w, iw) else 0
        if i < n:
            row, count = iw[layout.DENSE] + 1 + states + n + i, int(w[iw[layout.DENSE]])
            # a force between other bodies reaches this one by the rounding of the inverse mass
            if balanced and abs(w[row + states]) <= STILLNESS * largest_term(2, states, n, w, iw):
                balanced = 2
            x = search(value, w[iw[layout.POINT] + i], slack, row, states, mode, count, balanced, w)
        else:
            row, count = iw[layout.NEEDED_SERIES] + pairs + i, int(w[iw[layout.DENSE]])
            x = search(value, math.inf, slack, row, pairs, mode, count, balanced, w)
    return note_root(guard, x, best, w, iw)


def growth_of_forces(i: int, w: Vector, iw: IntVector) -> float:
    """Return how fast the inertia forces change that act on a coordinate, over the step."""
    n, total = iw[layout.N_COORDINATES], 0.0
    row = iw[layout.DENSE] + 1 + 2 * iw[layout.N_STATES] + n
    for j in range(n):
        total += abs(w[iw[layout.MASS] + i * n + j] * w[row + j])
    return 2.0 * total / w[layout.LENGTH]  # half of the second derivative stands in the series


def sum_terms(row: int, width: int, count: int, to: int, n: int, w: Vector) -> None:
    """Write the sums of the sizes of `count` rows of `n` terms that lie `width` apart."""
    for i in range(n):
        w[to + i] = 0.0
    for k in range(count):
        for i in range(n):
            w[to + i] += abs(w[row + k * width + i])


def note_root(guard: int, x: float, best: int, w: Vector, iw: IntVector) -> int:
    """Keep the fall of a guard; return the guard that falls first."""
    if x == FALLS_AT_ONCE:
        w[iw[layout.ROOTS] + guard] = 0.0
        w[layout.FRACTION] = 0.0
        return guard
    w[iw[layout.ROOTS] + guard] = x
    if x < w[layout.FRACTION] or (x == 1.0 and best == NO_GUARD):
        w[layout.FRACTION] = x
        return guard
    return best
