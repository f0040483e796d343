"""States of laws along given motions: bristles by the step, and an observer of a record.

Along a motion that is known, velocity and inputs are constant in a step, and each state z of a law
follows by the law's own formula, or from its rate r(z) by exponential Rosenbrock steps of order 3
(exprb32; Hochbruck and Ostermann, Acta Numerica 19, 2010), which are exact where r is linear in z.
An error above `TOLERANCE` cuts the step into equal parts, the same for all copies of a law, so that
slopes are differences between them.

The observer runs a law of one coordinate along a record. At each sample place and speed are
corrected by a share of the innovation, e = place measured - x; the innovations are the residuals:

    x <- x + g e,    v <- v + g' e

Between samples the force of the record moves the inertia m against friction,

    f = L(t) z (A(v) + P(x)) + z D1(t) + |z| B(v) + V(v) + W(x) + v D2(t) + D3(t) + c2 L(t) z2,

with tables of A, B and V over the signed root of the speed, of P and W over the place, and values
at each sample of what changes in time. z is the state of a bristle, z2 that of a second one. A part
of the step is half the way, the change of the speed, and the other half (of second order); friction
is that of the speed half a step ahead, by the last change. Bristles move along both halves of the
way by their own formula, dz/d|x| = (1 - |z|)^n / length while the motion goes on in one direction.
Where the bristle has no length, z is the direction, and friction stops what it can within a step.
"""

import math

from stickslip.engine.kernels.backend import Vector

# States of a law along a motion, one step after the other: compiled beside the law's equations.
#
# A vector ``w`` holds what these read: duration, velocity, load and contact inputs of a step, the
# parameters of one copy of the law, its states, and whether its latched switches are on.

TOLERANCE = 1e-3
"""Error of a step over the largest deflection: below the noise of any force, and forgotten with the
next reversal."""
MOST_PARTS = 8
"""Parts that a step between two samples is cut into at most."""
REACH = 0.5
"""Way that a part may go over the largest deflection, where bristles come to yield all of a sudden
and slopes say nothing about the error."""
NUDGE = 1e-7
"""Share of the largest deflection by which bristles are moved for slopes."""
MARGIN = 1e-6
"""Share of the way at the first rate by which rounding may exceed it."""
SEEN = 1e-5
"""Error over the largest deflection that rounding of slopes does not make."""
STILL = 1e-10
"""Rate over the first one that is none."""
SERIES = 0.05
"""Argument below which the functions of the exponential are summed as series."""
LEAST = 1e-300
"""What keeps quotients finite, and nothing else."""


def move(w: Vector) -> None:
    """Move the states by the law's own formula, and turn its switches; written for each law."""
    raise NotImplementedError


def rate(z: float, w: Vector) -> float:
    """Return the rate of a single state; written for each law."""
    raise NotImplementedError


def by_formula(
    columns: int,
    parameters: int,
    states: int,
    flags: int,
    steps: int,
    copies: int,
    motion: Vector,
    p: Vector,
    out: Vector,
    w: Vector,
) -> None:
    """Write states (states, steps + 1, copies), of which the first ones are there."""
    first = columns + parameters
    for c in range(copies):
        for j in range(parameters):
            w[columns + j] = p[c * parameters + j]
        for j in range(states):
            w[first + j] = out[j * (steps + 1) * copies + c]
        for j in range(flags):
            w[first + states + j] = 0.0
        for i in range(steps):
            for j in range(columns):
                w[j] = motion[i * columns + j]
            move(w)
            for j in range(states):
                out[(j * (steps + 1) + i + 1) * copies + c] = w[first + j]


def by_rates(
    columns: int,
    parameters: int,
    steps: int,
    copies: int,
    motion: Vector,
    p: Vector,
    out: Vector,
    w: Vector,
) -> None:
    """Write a single state (steps + 1, copies), of which the first ones are there.

    All copies take the same parts of a step: slopes are differences between them.
    """
    size, parts = 0.0, 1
    for c in range(copies):
        size = max(size, abs(out[c]))
    for i in range(steps):
        for j in range(columns):
            w[j] = motion[i * columns + j]
        parts = max(1, parts - 1)
        while True:
            worst, largest = 0.0, size
            for c in range(copies):
                for j in range(parameters):
                    w[columns + j] = p[c * parameters + j]
                z, error = stepped(out[i * copies + c], parts, size, w)
                out[(i + 1) * copies + c] = z
                worst, largest = max(worst, error), max(largest, abs(z))
            size = largest
            if not (worst > TOLERANCE * size) or parts >= MOST_PARTS:
                break
            more = 1.1 * parts * math.pow(worst / (TOLERANCE * size), 1.0 / 3.0)
            parts = min(max(math.ceil(min(more, 1.0 * MOST_PARTS)), parts + 1), MOST_PARTS)


def stepped(z: float, parts: int, size: float, w: Vector) -> tuple[float, float]:
    """Return the state after a step in equal parts, and the largest error.

    Exponential Rosenbrock steps of order 3 (exprb32, doi:10.1017/S0962492910000048): exact for laws
    that are linear in the deflection, such as LuGre's and Dahl's, and stable however many
    presliding lengths a step crosses.
    """
    h, worst = w[0] / parts, 0.0
    for _ in range(parts):
        f = rate(z, w)
        nudge = NUDGE * max(abs(z), max(size, abs(h * f)) + LEAST)
        slope = (rate(z + nudge, w) - f) / nudge
        x = min(h * slope, 50.0)
        if abs(x) < SERIES:
            phi_3 = (1.0 + x / 4.0 * (1.0 + x / 5.0 * (1.0 + x / 6.0 * (1.0 + x / 7.0)))) / 6.0
            phi_1 = 1.0 + x * (0.5 + x * phi_3)
        else:
            phi_1 = (math.exp(x) - 1.0) / x
            phi_3 = ((phi_1 - 1.0) / x - 0.5) / x
        there = z + h * phi_1 * f
        found = rate(there, w)
        rest = found - f - slope * (there - z)
        correction = 2.0 * h * phi_3 * rest
        new, error = there + correction, abs(correction)
        if found * f <= 0.0 and error > SEEN * size:  # it comes to yield all of a sudden
            limit = REACH * max(size, 1e-3 * abs(h * f), LEAST)
            error = TOLERANCE * size * math.pow(abs(h * f) / limit, 3.0)
            # ten times the way that is left: arrived, whatever the slopes promise
            share = 0.0 if f == 0.0 else (new - z) / (h * f)
            if abs(h * f) > 10.0 * size or not (-MARGIN <= share <= 1.0 + MARGIN):
                new = there
        z, worst = held_back(z, f, new, w), max(worst, error)
    return z, worst


def held_back(z: float, f: float, new: float, w: Vector) -> float:
    """Return a step that does not cross the deflection at which the rate is zero.

    At constant velocity no solution does, but a step may where the law yields all of a sudden, as
    Dahl's does with an exponent below 1.
    """
    f_high = rate(new, w)
    if not (f_high * f < 0.0 and abs(new - z) > 1e-9 * abs(z)):
        return new
    low, high, f_low, middle = z, new, f, new
    for _ in range(40):
        spread = f_high - f_low
        middle = high - f_high * (high - low) / (1.0 if spread == 0.0 else spread)
        f_middle = rate(middle, w)
        # the rate of a law that is linear in the deflection is 0 after one step, but for rounding
        found = abs(f_middle) <= STILL * abs(f)
        # Illinois: the end that stays counts half
        if f_middle * f > 0.0:
            low, f_low, f_high = middle, f_middle, 0.5 * f_high
            if found:
                high = middle
        else:
            high, f_high, f_low = middle, f_middle, 0.5 * f_low
            if found:
                low = middle
        if abs(high - low) - 1e-10 * abs(new) <= 0.0:
            break
    return middle


# A law of one coordinate run along a record as an observer, compiled.
#
# Between samples the force of the record moves the inertia against friction; at each sample, place
# and speed are corrected by a share of the difference to the measured place. That difference, the
# innovation, is the residual. Friction is
#
#     f = L(t) z (A(v) + P(x)) + z D1(t) + |z| B(v) + V(v) + W(x) + v D2(t) + D3(t) + c2 L(t) z2,
#
# with tables of A, B and V over the signed root of the speed, of P and W over the place, and values
# at each sample of what changes in time. z is the state of a bristle, z2 that of a second one;
# where the bristle has no length, z is the direction, and friction stops what it can within a step.
#
# A step is half the way, the change of the speed, and the other half (of second order in the step);
# friction is that of the speed half a step ahead, by the last change. Bristles move along both
# halves of the way by their own formula.

STEP, GAIN, RATE_GAIN, INERTIA, LENGTH, EXPONENT = 0, 1, 2, 3, 4, 5
SECOND, SECOND_LENGTH, SECOND_EXPONENT = 6, 7, 8
SPEED_UNIT, PLACE_START, PLACE_STEP, START_SPEED, START_STATE = 9, 10, 11, 12, 13
COUNT = 14
"""Places of numbers in the vector of parameters, and how many there are."""
LOST = 1e6
"""Innovation of a run that went astray."""


def looked_up(table: Vector, place: float) -> float:
    """Return a value between the entries of a table; 0 of one that has none."""
    last = len(table) - 1
    if last < 1:
        return 0.0
    at = min(max(place, 0.0), last - 1e-6)
    i = int(at)
    share = at - i
    return table[i] * (1.0 - share) + table[i + 1] * share


def strained(z: float, length: float, exponent: float, way: float) -> float:
    """Return the state of a bristle after a way."""
    if way == 0.0:
        return z
    side = 1.0 if way > 0.0 else -1.0
    left = 1.0 - side * z
    x = abs(way) / length
    if exponent == 0.0:
        left = left - x if left > x else 0.0
    elif exponent == 1.0:
        left = left * math.exp(-x)
    else:
        left = left / (1.0 + left * x)  # exponent 2
    return side * (1.0 - left)


def observe(  # noqa: C901  # a call costs a third of a step
    count: int,
    parts: int,
    held: int,
    p: Vector,
    force: Vector,
    place: Vector,
    a: Vector,
    b: Vector,
    v_table: Vector,
    p_table: Vector,
    w_table: Vector,
    load: Vector,
    d1: Vector,
    d2: Vector,
    d3: Vector,
    out: Vector,
) -> None:
    """Write the innovations of a run (count,)."""
    dt = p[STEP] / parts
    k = dt / p[INERTIA]
    length = p[LENGTH]
    second = p[SECOND_LENGTH]
    middle = 0.5 * (len(a) - 1)
    per_speed = 1.0 / p[SPEED_UNIT]
    per_place = 1.0 / p[PLACE_STEP]
    x = place[0]
    v = p[START_SPEED]
    z = p[START_STATE]
    z2 = z
    gained = 0.0  # change of the speed in the last step, which tells the mean speed of the next
    for j in range(count):
        e = place[j] - x
        out[j] = e
        x = x + p[GAIN] * e
        v = v + p[RATE_GAIN] * e
        after = j + 1 if j + 1 < count else j
        still = d3[j]
        now = load[j]
        f = force[j]
        rise = 0.0
        if held == 0:
            rise = (force[after] - f) / parts
            f = f + 0.5 * rise
        for _ in range(parts):
            u = v + 0.5 * gained
            way = 0.5 * v * dt
            x = x + way
            if length > 0.0:
                z = strained(z, length, p[EXPONENT], way)
            if second > 0.0:
                z2 = strained(z2, second, p[SECOND_EXPONENT], way)
            at = (x - p[PLACE_START]) * per_place
            root = math.sqrt(abs(u) * per_speed)
            s = middle + root if u >= 0.0 else middle - root
            s = min(max(s, 0.0), 2.0 * middle - 1e-6)
            i = int(s)
            share = s - i
            level = a[i] * (1.0 - share) + a[i + 1] * share + looked_up(p_table, at)
            level = now * level + d1[j]
            odd = looked_up(b, s)
            flow = v_table[i] * (1.0 - share) + v_table[i + 1] * share
            flow = flow + looked_up(w_table, at) + d2[j] * u + still
            if second > 0.0:
                flow = flow + p[SECOND] * now * z2
            before = v
            if length == 0.0:
                free = v + k * (f - flow)
                most = level + odd if free > 0.0 else level - odd
                most = most if most > 0.0 else 0.0
                m = abs(free) - k * most
                if m > 0.0:
                    v = m if free > 0.0 else -m
                    z = 1.0 if free > 0.0 else -1.0
                else:
                    v = 0.0
            else:
                v = v + k * (f - z * level - abs(z) * odd - flow)
            gained = v - before
            way = 0.5 * v * dt
            x = x + way
            if length > 0.0:
                z = strained(z, length, p[EXPONENT], way)
            if second > 0.0:
                z2 = strained(z2, second, p[SECOND_EXPONENT], way)
            f = f + rise
        if not abs(v) < LOST:
            for later in range(j, count):
                out[later] = LOST
            return
