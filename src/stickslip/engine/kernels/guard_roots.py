"""Where inside a step a guard is first violated.

A guard g is a condition of the mode, which holds while g >= 0. In smooth and stiff modes:

1. All guards are sampled at equal parts of the step, along its dense output. Where anything is
   held, its guards change with time while no state does: every other sample is compared with the
   polynomial through the rest, and so is a point that is no multiple of a part: where they differ,
   samples do not show the course of the guards, and the step is taken shorter (`coarseness`).
2. A guard that begins at zero is armed once it has been positive. One that is armed and negative at
   a sample has a bracket; one that never becomes positive and ends negative falls at once. What
   leaves rest where forces balance has the rounding of that balance to spare (`note_spare`).
3. One that may fall and rise again between samples, which a parabola through three of them tells
   with room to spare, is searched for its minimum by golden section; a negative value there gives
   a bracket (`turns`, `dip`). One that begins at zero has no such fall in front of the first
   sample: it is not armed, and a dip there is the error of the dense output.
4. The root in a bracket is found by ITP (Oliveira and Takahashi, ACM Trans. Math. Softw. 47, 2020):
   the secant's point, moved towards the middle, and kept where bisection would still end in time.
   What is returned is the end of the bracket where g < 0, a unit of the time beyond the root.
5. The guard that falls first is the event; what begins later than the earliest one known is not
   looked at.

In linear modes guards are polynomials in the fraction of the step, g = sum of c_k x^k, with c from
the slopes of the guard and the series of the states. Their first fall is found in Bernstein form
without any samples (`numerics.first_fall`), so that no violation is too short to be seen.
"""

import math

from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector, rare
from stickslip.engine.kernels.equations import (
    FIELD,
    combined,
    evaluate,
    factor_of,
    field,
    guard_slopes,
    guards,
    size_along,
    slip_rate_along,
)
from stickslip.engine.kernels.mode_transitions import UNMOVED, wall_coordinate, wall_side
from stickslip.engine.kernels.numerics import FALLS_AT_ONCE, first_fall, interpolate
from stickslip.engine.kernels.steppers import wave_at

# Where inside a step a guard is first violated.

PUSH = 0.2
"""The paper's kappa_1 times the first bracket, with kappa_2 = 2: how far the secant's point is
moved towards the middle, so that a bracket of which one end never moves shrinks too."""
NO_GUARD = -1
UNWATCHED = 1.0
"""Value of a guard of several contacts that nothing watches."""
QUIET = 1e-12
"""Share of the largest speed so far below which a reversal of a bristle law is left unnoticed.

The fields of both directions agree there to rounding, and a body that creeps to rest would else
reverse with every rounding error.
"""
GOLDEN = 0.6180339887498949
"""(sqrt(5) - 1) / 2: of two points that cut a bracket so, one does so in the next bracket too."""
BARELY = 0.01
"""Share of the next value below which a guard may well have turned between them."""
RESOLVED = 1e-4
"""Difference from a polynomial, over the largest value, at which samples show a guard's course."""
NEGLIGIBLE = 1e-9
"""Share of the largest value so far of which nothing is asked: it may be rounding."""
LEAST_SIZE = 1e-290
"""Value below which quotients lose their digits."""
AT_GOLDEN_0 = 0.023356649595636096
AT_GOLDEN_1 = -0.15688989337595488
AT_GOLDEN_2 = 0.7337820300563611
AT_GOLDEN_3 = 0.43754306663301834
AT_GOLDEN_4 = -0.037791852909060696
"""Weights at `GOLDEN` of the polynomial through five values at even distances."""
EPSILON_STEP = 2.220446049250313e-16
"""Unit in the last place of 1; fractions of a step are found to it, or to that of the time."""
EARLY = 20
"""Steps in which what begins on a threshold has moved by more than rounding."""
AWAY = 10.0
"""Largest value over that rounding with which one has not been away from its threshold yet."""
PLACED = 8.9e-16
"""Four units in the last place: rounding of a difference of places, over their size."""
CLOCK = 4.440892098500626e-16
"""Rounding of the time of an event, over the larger of that and the step: two units of 1."""


def itp_limit(width: float, epsilon: float) -> int:
    """Return the number of trials that bisection would need, and one more."""
    return math.ceil(math.log2(max(width / epsilon, 1.0))) + 1


def itp_point(
    spare: int,
    width: float,
    epsilon: float,
    low: float,
    high: float,
    f_low: float,
    f_high: float,
) -> float:
    """Return where to look next: the secant's point, kept where bisection still ends in time.

    `spare` is the number of trials left, `width` the length of the first bracket.
    """
    middle = 0.5 * (low + high)
    # How far from the middle a point may lie if bisection is still to end in the trials that are
    # left.
    radius = max(epsilon * 2.0**spare - 0.5 * (high - low), 0.0)
    # Interpolate, push towards the middle, and project into that radius: the three steps of ITP.
    secant = (f_high * low - f_low * high) / (f_high - f_low)
    side = 1.0 if middle > secant else -1.0
    push = PUSH / width * (high - low) ** 2
    x = middle if push > abs(middle - secant) else secant + side * push
    if abs(x - middle) > radius:
        x = middle - side * radius
    # Each trial takes half a unit off the bracket at least, so that none is wasted at its ends.
    return min(max(x, low + 0.5 * epsilon), high - 0.5 * epsilon)


def direction_from_rest(i: int, w: Vector, iw: IntVector) -> int:
    """Return the direction in which what a level or a stop held moves from rest in a step, or 0."""
    if iw[layout.N_CONTACTS] > 0:
        mode = iw[iw[layout.MODES] + i]
        mode = mode if mode == layout.FREE or iw[iw[layout.RIGID] + i] else 0
        rate = slip_rate_along(i, iw[layout.Y], w, iw)
    else:
        own = iw[layout.N_COORDINATES] + i == iw[layout.SLIP] and abs(iw[layout.MODE]) == 1
        mode = iw[layout.MODE] if own and not iw[layout.HAS_BRISTLES] else 0
        rate = w[iw[layout.Y] + iw[layout.SLIP]]
    for wall in range(iw[layout.N_WALLS] if mode != 0 and rate == 0.0 else 0):
        place = w[iw[layout.WALLS] + wall * iw[layout.WALL_COLUMNS]]
        if wall_coordinate(wall, iw) == i and w[iw[layout.Y] + i] == place:
            return -wall_side(wall, iw)
    return mode if abs(mode) == 1 and rate == 0.0 else 0


def note_spare(w: Vector, iw: IntVector) -> None:
    """Write how much of the acceleration of what moves from rest may be rounding.

    As it breaks away, or leaves its stop, forces balance, and it is their growth that tells that
    it goes on. What is left of the balance is the rounding of forces and of the time.
    """
    w[layout.SPARE] = 0.0
    if iw[layout.STEPPER] == layout.EXACT:
        return
    for i in range(max(iw[layout.N_DIRECTIONS], iw[layout.N_COORDINATES])):
        if direction_from_rest(i, w, iw) != 0:
            w[layout.SPARE] = max(w[layout.SPARE], UNMOVED * size_of_slip(i, w, iw))


def size_of_slip(i: int, w: Vector, iw: IntVector) -> float:
    """Return how large the accelerations are that balance as something begins to slip.

    Over the time that has passed its change counts, too: the time is rounded as forces are.
    """
    n, states, t = iw[layout.N_COORDINATES], iw[layout.N_STATES], w[layout.TIME]
    y, point, now = iw[layout.Y], iw[layout.POINT], iw[layout.STAGES]
    later, size = now + states, 0.0
    field(t, w, iw, y, now)
    if iw[layout.N_CONTACTS] > 0:
        for j in range(n):
            forces = abs(w[iw[layout.FORCE] + j]) + size_of_forces(j, w, iw)
            size += abs(factor_of(i, j, w, iw)) * forces / w[iw[layout.MASS] + j * n + j]
    else:  # fields of both directions differ by twice the friction
        evaluate(FIELD, -iw[layout.MODE], iw[layout.FLAGS], t, w, y, later)
        size = abs(w[now + n + i] - w[later + n + i])
    tick = UNMOVED * t
    for j in range(states):
        w[point + j] = w[y + j] + tick * w[now + j]
    field(t + tick, w, iw, point, later)
    for j in range(states):
        w[later + j] = (w[later + j] - w[now + j]) / UNMOVED
    return size + abs(combined(i, later + n, w, iw))


def forget_spare(w: Vector, iw: IntVector) -> None:
    """Take for 0 what rounding leaves of a motion against the slip, at the end of a step in Y1."""
    rates = iw[layout.Y1] + iw[layout.N_COORDINATES]
    for i in range(iw[layout.N_COORDINATES]):
        speed = direction_from_rest(i, w, iw) * w[rates + i]
        if -w[layout.SPARE] * w[layout.LENGTH] <= speed < 0.0:
            w[rates + i] = 0.0
            w[iw[layout.Y1] + i] = w[iw[layout.Y] + i]


def guard_values(t: float, ahead: float, w: Vector, iw: IntVector, at: int, to: int) -> None:
    """Evaluate the guards a time ahead of the start of a step, with what rounding may decide.

    That is the quiet zone of bristle laws, and the speed or the way that what begins to move has by
    rounding.
    """
    guards(t, w, iw, at, to)
    if ahead * w[layout.SPARE] > 0.0:
        for i in range(max(iw[layout.N_DIRECTIONS], iw[layout.N_COORDINATES])):
            if direction_from_rest(i, w, iw) != 0:
                speed = 2 * i if iw[layout.N_CONTACTS] > 0 else layout.STOP
                w[to + speed] += ahead * w[layout.SPARE]
        for wall in range(iw[layout.N_WALLS]):
            if direction_from_rest(wall_coordinate(wall, iw), w, iw) == -wall_side(wall, iw):
                w[to + iw[layout.FIRST_WALL] + wall] += 0.5 * ahead * ahead * w[layout.SPARE]
    if not iw[layout.HAS_BRISTLES]:
        return
    if iw[layout.N_CONTACTS] > 0:
        for i in range(iw[layout.N_DIRECTIONS]):
            if reverses(2 * i, iw):
                w[to + 2 * i] += QUIET * guard_size(2 * i, w, iw)
    elif iw[layout.MODE] != 0:
        w[to + layout.STOP] += QUIET * w[iw[layout.SCALE] + iw[layout.SLIP]]


def reverses(guard: int, iw: IntVector) -> bool:
    """Whether a guard is the speed of a body that bristles alone carry, which only turns."""
    if not iw[layout.HAS_BRISTLES]:
        return False
    if iw[layout.N_CONTACTS] == 0:
        return guard == layout.STOP
    if guard < 0 or guard >= 2 * iw[layout.N_DIRECTIONS] or guard % 2 == 1:
        return False
    i = guard // 2
    return (
        iw[iw[layout.MODES] + i] in (layout.FORWARD, layout.BACKWARD)
        and not iw[iw[layout.RIGID] + i]
    )


def guard_at(guard: int, x: float, t: float, h: float, w: Vector, iw: IntVector) -> float:
    """Return one guard at a fraction of the step."""
    point = iw[layout.POINT]
    values = iw[layout.VALUES]
    interpolate(w, iw, x, point)
    guard_values(t + x * h, x * h, w, iw, point, values)
    return w[values + guard]


def bisect(
    guard: int, low: float, high: float, t: float, h: float, w: Vector, iw: IntVector
) -> float:
    """Return the fraction just past a sign change."""
    f_low = guard_at(guard, low, t, h, w, iw)
    f_high = guard_at(guard, high, t, h, w, iw)
    # A fraction of the step is told no better than the clock tells the time.
    epsilon = max(EPSILON_STEP, EPSILON_STEP * abs(t) / abs(h))
    width = high - low
    limit = itp_limit(width, epsilon)
    for trial in range(limit + 1):
        if high - low <= 2.0 * epsilon:
            break
        x = itp_point(limit - trial, width, epsilon, low, high, f_low, f_high)
        value = guard_at(guard, x, t, h, w, iw)
        # The guard holds at `low` and is violated at `high`: what is returned lies just past the
        # root.
        if value < 0.0:
            high = x
            f_high = value
        else:
            low = x
            f_low = value
    return high


def dip(guard: int, low: float, high: float, t: float, h: float, w: Vector, iw: IntVector) -> float:
    """Return the fraction just past a fall between, if the minimum there is negative; else 2."""
    begin = low
    a = high - GOLDEN * (high - low)
    b = low + GOLDEN * (high - low)
    f_a = guard_at(guard, a, t, h, w, iw)
    f_b = guard_at(guard, b, t, h, w, iw)
    # 0.618^40 is 4e-9 of the bracket; closer than the root of the rounding, 1.5e-8, values of a
    # smooth function about its minimum do not differ.
    for _ in range(40):
        if f_a < 0.0 or f_b < 0.0:
            return bisect(guard, begin, a if f_a < 0.0 else b, t, h, w, iw)
        if f_a < f_b:
            high = b
            b = a
            f_b = f_a
            a = high - GOLDEN * (high - low)
            f_a = guard_at(guard, a, t, h, w, iw)
        else:
            low = a
            a = b
            f_a = f_b
            b = low + GOLDEN * (high - low)
            f_b = guard_at(guard, b, t, h, w, iw)
    return 2.0


def turns(edge: float, near: float, far: float) -> bool:
    """Whether a guard may fall below zero between the edge of a step and the sample next to it.

    A step that was taken again to end just beyond an event has a shallow fall there. The parabola
    through the three values turns between the first two; it falls below zero where `edge` is less
    than half the square of its slope there over its curvature, and 2.5 times that leaves room for
    what is no parabola. One that has turned goes on rising: without that, every guard that falls
    steadily would be searched, at forty evaluations each. Very near to where it turns, the three
    values do not tell its slope.
    """
    # Slope of the parabola at the edge, and its second difference, both per sample.
    slope = 0.5 * (4.0 * near - 3.0 * edge - far)
    bend = edge - 2.0 * near + far
    if 0.0 < edge < BARELY * near:
        return True
    return near < far and slope < 0.0 and 2.0 * edge * bend < 2.5 * slope * slope


def first_sign(guard: int, first: float, t: float, h: float, w: Vector, iw: IntVector) -> float:
    """Return the first point just past a fall of one guard among the samples.

    That is `first` if the guard holds up to there, and -1 for a guard that starts at zero and never
    becomes positive although it ends negative.
    """
    n_guards = iw[layout.N_GUARDS]
    first_wall = iw[layout.FIRST_WALL]
    at = iw[layout.SAMPLED] + guard
    value = w[at]
    before = value
    armed = value > 0.0
    for s in range(1, layout.SAMPLES + 1):
        low = (s - 1) / layout.SAMPLES
        if armed and low >= first:  # a fall behind the earliest one known need not be found
            return first
        earlier = before
        before = value
        value = w[at + s * n_guards]
        if armed and value < 0.0:
            return min(first, bisect(guard, low, s / layout.SAMPLES, t, h, w, iw))
        if armed and s > 1:
            x = 2.0
            if s == 2 and earlier > 0.0 and turns(earlier, before, value):
                x = dip(guard, 0.0, 1.0 / layout.SAMPLES, t, h, w, iw)
            # A minimum lies near `before`. The parabola through the three values falls below zero
            # only where 10 before < earlier + value; 4 leaves room for what is no parabola.
            if before <= value and before < earlier and 4.0 * before < earlier + value:
                x = min(x, dip(guard, (s - 2) / layout.SAMPLES, s / layout.SAMPLES, t, h, w, iw))
            if s == layout.SAMPLES and turns(value, before, earlier):
                x = min(x, dip(guard, low, 1.0, t, h, w, iw))
            if x < 2.0:
                return min(first, x)
        if value < 0.0 and guard >= first_wall:  # a bounce too short to be seen
            return -1.0
        armed = armed or value > 0.0
    return -1.0 if not armed and value < 0.0 else first


def start_on_thresholds(w: Vector, iw: IntVector) -> None:
    """Take for 0 what is left of switches by rounding of the places at which a run begins.

    One that begins on its threshold is left to the side to which it goes, and that must not be what
    a difference of places leaves.
    """
    guards, first = iw[layout.N_GUARDS], iw[layout.FIRST_LIMIT] - iw[layout.N_SWITCHES]
    if iw[layout.N_SWITCHES] == 0:
        return
    guard_slopes(w[layout.TIME], w, iw, iw[layout.Y], iw[layout.SLOPES])
    for guard in range(first, iw[layout.FIRST_LIMIT]):
        rounding = rounding_of_places(guard, w, iw)
        # Only what has not been away from its threshold in this run: larger values are no rounding.
        for s in range(
            layout.SAMPLES + 1 if w[iw[layout.REACHED] + guard] <= AWAY * rounding else 0
        ):
            at = iw[layout.SAMPLED] + s * guards + guard
            if abs(w[at]) <= rounding:
                w[at] = 0.0


def rounding_of_places(guard: int, w: Vector, iw: IntVector) -> float:
    """Return the rounding of a switch by that of the state, where slopes of guards are at hand."""
    n, size = iw[layout.N_STATES], 0.0
    for i in range(n):
        size += abs(w[iw[layout.SLOPES] + guard * (n + 1) + i] * w[iw[layout.Y] + i])
    return PLACED * size


def first_violation(t: float, h: float, w: Vector, iw: IntVector) -> int:
    """Find the first violated guard of a step, with its fraction in FRACTION.

    The fraction is 0 where a guard was never armed: it starts at zero and falls.
    """
    point = iw[layout.POINT]
    sampled = iw[layout.SAMPLED]
    n_guards = iw[layout.N_GUARDS]
    for s in range(layout.SAMPLES + 1):
        interpolate(w, iw, s / layout.SAMPLES, point)
        ahead = s / layout.SAMPLES * h
        guard_values(t + ahead, ahead, w, iw, point, sampled + s * n_guards)
    if iw[layout.STEPS] < EARLY and (iw[layout.N_CONTACTS] == 0 or iw[layout.N_VARIABLES] > 0):
        start_on_thresholds(w, iw)
    best = NO_GUARD
    w[layout.FRACTION] = 2.0  # beyond the step: any fall is earlier
    for guard in range(n_guards):
        x = first_sign(guard, w[layout.FRACTION], t, h, w, iw)
        if x < 0.0:
            w[layout.FRACTION] = 0.0
            return guard
        if x < w[layout.FRACTION]:
            w[layout.FRACTION] = x
            best = guard
    w[layout.FRACTION] = min(w[layout.FRACTION], 1.0)
    return best


def is_held(iw: IntVector) -> bool:
    """Whether anything is held: its guards may change with time while no state does."""
    if iw[layout.N_CONTACTS] == 0:
        return abs(iw[layout.MODE]) != 1
    held = False
    for i in range(iw[layout.N_DIRECTIONS]):
        held = held or iw[iw[layout.MODES] + i] == layout.HELD_FAST
    return held


def opposite(guard: int, iw: IntVector) -> int:
    """Return the guard of the other direction, where both are of one level; else itself.

    Their sum is twice the level, which tells how large the rounding of either is.
    """
    if iw[layout.N_CONTACTS] > 0:
        pair = guard < 2 * iw[layout.N_PAIRS] and not is_speed(guard, iw)
        return guard + 1 - 2 * (guard % 2) if pair else guard
    if guard in (layout.BREAK_FORWARD, layout.BREAK_BACKWARD):
        return layout.BREAK_FORWARD + layout.BREAK_BACKWARD - guard
    return guard


def is_speed(guard: int, iw: IntVector) -> bool:
    """Whether a guard is one of a coordinate of several that moves: its speed, not a force."""
    if iw[layout.N_CONTACTS] == 0 or guard >= 2 * iw[layout.N_PAIRS]:
        return False
    return iw[iw[layout.MODES] + guard // 2] != layout.HELD_FAST


def guard_size(guard: int, w: Vector, iw: IntVector) -> float:
    """Return how large a guard has been in the run: a speed as a speed, a force as a force."""
    if is_speed(guard, iw):
        return size_along(guard // 2, iw[layout.SCALE] + iw[layout.N_COORDINATES], w, iw)
    return w[iw[layout.REACHED] + guard]


def size_of_forces(i: int, w: Vector, iw: IntVector) -> float:
    """Return how large the forces are of which a held coordinate's needed friction is the rest.

    Inertia forces of others may leave little of them but their rounding.
    """
    if iw[layout.DIAGONAL]:
        return 0.0
    n = iw[layout.N_COORDINATES]
    if i >= n:
        return size_in_motion(i, w, iw)
    total = abs(w[iw[layout.FORCE] + i])
    for j in range(n):
        total += abs(w[iw[layout.MASS] + i * n + j] * w[iw[layout.ACCELERATION] + j])
    return total


@rare
def size_in_motion(i: int, w: Vector, iw: IntVector) -> float:
    """Return how large the forces are of which that along a closing slip or a cut is the rest."""
    n, total = iw[layout.N_COORDINATES], 0.0
    for j in range(n):
        factor = abs(factor_of(i, j, w, iw))
        if factor != 0.0:
            total += factor * abs(w[iw[layout.FORCE] + j])
            for k in range(n):
                total += factor * abs(
                    w[iw[layout.MASS] + j * n + k] * w[iw[layout.ACCELERATION] + k]
                )
    return total


def size_of_balance(guard: int, w: Vector, iw: IntVector) -> float:
    """Return how large the forces are that a guard compares at the state; 0 if none."""
    if iw[layout.N_CONTACTS] == 0 or guard >= 2 * iw[layout.N_PAIRS] or is_speed(guard, iw):
        return 0.0
    return size_of_forces(guard // 2, w, iw)


def coarseness(t: float, h: float, w: Vector, iw: IntVector) -> float:
    """Return how badly the samples of a step show the course of the guards; up to 1 they do.

    Every other sample is compared with the polynomial through the rest, and so is one point that is
    no multiple of a part of the step, as a fast oscillation may have the same phase at all of them.
    """
    n_guards, sampled, values = iw[layout.N_GUARDS], iw[layout.SAMPLED], iw[layout.VALUES]
    interpolate(w, iw, GOLDEN, iw[layout.POINT])
    guard_values(t + GOLDEN * h, GOLDEN * h, w, iw, iw[layout.POINT], values)
    worst = 0.0
    for guard in range(n_guards):
        at = sampled + guard
        a, b, c = w[at], w[at + 2 * n_guards], w[at + 4 * n_guards]
        d, e = w[at + 6 * n_guards], w[at + 8 * n_guards]
        known = max(guard_size(guard, w, iw), abs(w[sampled + opposite(guard, iw)]))
        known = max(known, size_of_balance(guard, w, iw))
        if guard >= iw[layout.FIRST_WALL]:  # a way to a stop is the rest of two places
            wall = (guard - iw[layout.FIRST_WALL]) * iw[layout.WALL_COLUMNS]
            known = max(known, abs(w[iw[layout.WALLS] + wall]))
        size = max(abs(a), abs(b), abs(c), abs(d), abs(e), NEGLIGIBLE * known)
        # Weights of the polynomial of degree four through every other sample, at those between,
        # times 128.
        through = 35.0 * a + 140.0 * b - 70.0 * c + 28.0 * d - 5.0 * e
        difference = abs(through - 128.0 * w[at + n_guards])
        through = -5.0 * a + 60.0 * b + 90.0 * c - 20.0 * d + 3.0 * e
        difference = max(difference, abs(through - 128.0 * w[at + 3 * n_guards]))
        through = 3.0 * a - 20.0 * b + 90.0 * c + 60.0 * d - 5.0 * e
        difference = max(difference, abs(through - 128.0 * w[at + 5 * n_guards]))
        through = -5.0 * a + 28.0 * b - 70.0 * c + 140.0 * d + 35.0 * e
        difference = max(difference, abs(through - 128.0 * w[at + 7 * n_guards])) / 128.0
        through = AT_GOLDEN_0 * a + AT_GOLDEN_1 * b + AT_GOLDEN_2 * c
        through += AT_GOLDEN_3 * d + AT_GOLDEN_4 * e
        difference = max(difference, abs(through - w[values + guard]))
        if size > LEAST_SIZE and difference > worst * RESOLVED * size:
            worst = difference / (RESOLVED * size)
    return worst


def stays(guard: int, w: Vector, iw: IntVector) -> bool:
    """Whether a guard just above its threshold comes no nearer in a step that was to end there."""
    at, largest = iw[layout.SAMPLED] + guard, 0.0
    if not 0.0 < w[at] <= AWAY * rounding_of_places(guard, w, iw):
        return False
    for s in range(layout.SAMPLES + 1):
        largest = max(largest, w[at + s * iw[layout.N_GUARDS]])
    return w[at + layout.SAMPLES * iw[layout.N_GUARDS]] > 0.5 * largest


def rises(guard: int, w: Vector, iw: IntVector) -> bool:
    """Whether one guard is positive at any of the samples."""
    sampled = iw[layout.SAMPLED]
    n_guards = iw[layout.N_GUARDS]
    highest = w[sampled + guard]
    for s in range(1, layout.SAMPLES + 1):
        highest = max(highest, w[sampled + s * n_guards + guard])
    return highest > 0.0


def note_least(guard: int, value: float, w: Vector, iw: IntVector) -> None:
    """Note the least value of a guard that ends runs."""
    lowest = iw[layout.LOWEST]
    if (iw[layout.CAN_LIFT] and guard == layout.LIFT_OFF) or iw[layout.FIRST_LIMIT] <= guard < iw[
        layout.FIRST_WALL
    ]:
        w[lowest + guard] = min(w[lowest + guard], value)


def note_sizes(w: Vector, iw: IntVector) -> None:
    """Note the largest size of each guard among the samples of a step, and the least ones."""
    n_guards = iw[layout.N_GUARDS]
    sampled = iw[layout.SAMPLED]
    reached = iw[layout.REACHED]
    for guard in range(n_guards):
        if is_speed(guard, iw):
            continue  # the largest speeds stand at SCALE
        largest = max(w[reached + guard], size_of_balance(guard, w, iw))
        least = math.inf
        for s in range(layout.SAMPLES + 1):
            value = w[sampled + s * n_guards + guard]
            if value == UNWATCHED and iw[layout.N_CONTACTS] > 0:
                continue
            largest = max(largest, abs(value))
            least = min(least, value)
        w[reached + guard] = largest
        note_least(guard, least, w, iw)


# Where a step of a linear mode first violates a guard: guards are polynomials there.

BALANCED = 4e-15
"""Acceleration over the forces that make it up, below which they balance but for rounding."""


def guard_waves(guard: int, w: Vector, iw: IntVector) -> bool:
    """Whether a guard of one contact has a harmonic term in this step."""
    if iw[layout.N_WAVES] == 0:
        return False
    own = iw[layout.WAVES] + layout.SERIES + 1 + iw[layout.N_STATES] + guard
    return w[own] != 0.0 or w[own + iw[layout.N_WAVES]] != 0.0


def guard_polynomial(guard: int, h: float, w: Vector, iw: IntVector) -> int:
    """Write the coefficients of one guard in the fraction of the step; return the degree."""
    values = iw[layout.VALUES]
    dense = iw[layout.DENSE]
    reached = iw[layout.REACHED]
    n = iw[layout.N_STATES]
    row = iw[layout.SLOPES] + guard * (n + 1)  # slopes along the states, then along time
    w[layout.POLYNOMIAL] = w[values + guard]
    last = w[values + guard]
    degree = 0
    first = row
    while first <= row + n and w[first] == 0.0:
        first += 1
    waves = guard_waves(guard, w, iw)
    # many guards are 0 in a mode, or change with nothing in it
    terms = int(w[dense]) if first <= row + n or waves else 0
    for k in range(1, terms + 1):
        w[layout.POLYNOMIAL + k] = h * w[row + n] if k == 1 else 0.0
        if k > 1 and waves:
            power, place = wave_at(k, w, iw)
            w[layout.POLYNOMIAL + k] = power * w[place + n + guard]
    for i in range(n if terms > 0 else 0):
        if w[row + i] != 0.0:  # most guards change with a state or two
            slope, at = w[row + i], dense + 1 + i
            for k in range(1, terms + 1):
                w[layout.POLYNOMIAL + k] += slope * w[at + k * n]
    for k in range(1, terms + 1):
        last += w[layout.POLYNOMIAL + k]
        if w[layout.POLYNOMIAL + k] != 0.0:
            degree = k
    w[reached + guard] = max(w[reached + guard], abs(w[values + guard]), abs(last))
    note_least(guard, min(w[values + guard], last), w, iw)
    return degree


def largest_term(k: int, states: int, first: int, w: Vector, iw: IntVector) -> float:
    """Return the largest term of one power in the series of the states from `first` on."""
    row, size = iw[layout.DENSE] + 1 + k * states, 0.0
    for i in range(first, states):
        size = max(size, abs(w[row + i]))
    return size


def quiet_start(t: float, h: float, w: Vector, iw: IntVector) -> None:
    """Drop the first slopes of a body at rest where forces balance but for their rounding."""
    y = iw[layout.Y]
    point = iw[layout.POINT]
    slip = iw[layout.SLIP]
    drift = iw[layout.DRIFT]
    n = iw[layout.N_STATES]
    matrix = iw[layout.MATRIX]
    # Fields of both directions differ by twice the friction. With slopes times states and time they
    # tell how large the forces are that balance.
    evaluate(FIELD, 1, iw[layout.FLAGS], t, w, y, point)
    size = w[point + slip]
    evaluate(FIELD, -1, iw[layout.FLAGS], t, w, y, point)
    size = abs(size - w[point + slip]) + abs(w[drift + slip] * t)
    for i in range(n):
        size += abs(w[matrix + slip * n + i] * w[y + i])
    # a force between other bodies reaches this one by the rounding of the inverse mass matrix
    if abs(w[layout.POLYNOMIAL + 1]) <= BALANCED * max(h * size, largest_term(1, n, 0, w, iw)):
        w[layout.POLYNOMIAL + 1] = 0.0
        if abs(w[layout.POLYNOMIAL + 2]) <= BALANCED * largest_term(2, n, 0, w, iw):
            w[layout.POLYNOMIAL + 2] = 0.0
        still = w[drift + slip] == 0.0 and iw[layout.N_WAVES] == 0
        if iw[layout.N_COORDINATES] == 1 and still:  # nor is there anything to follow
            for k in range(2, layout.SERIES + 1):
                w[layout.POLYNOMIAL + k] = 0.0


def first_crossing(t: float, h: float, w: Vector, iw: IntVector) -> int:
    """Find the first violated guard of a step, with its fraction in FRACTION.

    The fraction is 0 where a guard that starts at zero falls below it at once.
    """
    y = iw[layout.Y]
    n_guards = iw[layout.N_GUARDS]
    slip = iw[layout.SLIP]
    guards(t, w, iw, y, iw[layout.VALUES])
    guard_slopes(t, w, iw, y, iw[layout.SLOPES])
    best = NO_GUARD
    w[layout.FRACTION] = 1.0
    for guard in range(n_guards):
        degree = guard_polynomial(guard, h, w, iw)
        switches = layout.SWITCH <= guard < iw[layout.FIRST_LIMIT]
        if switches and -UNMOVED * w[iw[layout.REACHED] + guard] <= w[layout.POLYNOMIAL] < 0.0:
            w[layout.POLYNOMIAL] = 0.0  # it has just been turned, within rounding of its threshold
        if degree == 0 and w[layout.POLYNOMIAL] >= 0.0:
            continue
        if guard == layout.STOP and iw[layout.MODE] != 0 and w[y + slip] == 0.0:
            quiet_start(t, h, w, iw)
        x = first_fall(w, degree)
        if x == FALLS_AT_ONCE:
            w[layout.FRACTION] = 0.0
            return guard
        # A fall right at the end of the step counts only if no other guard has one.
        if x < w[layout.FRACTION] or (x == 1.0 and best == NO_GUARD):
            w[layout.FRACTION] = x
            best = guard
    return best
