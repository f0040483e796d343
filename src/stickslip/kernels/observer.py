"""A law of one coordinate run along a record as an observer, compiled.

Between samples the force of the record moves the inertia against friction; at each sample, place
and speed are corrected by a share of the difference to the measured place. That difference, the
innovation, is the residual. Friction is

    f = L(t) z (A(v) + P(x)) + z D1(t) + |z| B(v) + V(v) + W(x) + v D2(t) + D3(t) + c2 L(t) z2,

with tables of A, B and V over the signed root of the speed, of P and W over the place, and values
at each sample of what changes in time. z is the state of a bristle, z2 that of a second one; where
the bristle has no length, z is the direction, and friction stops what it can within a step.

A step is half the way, the change of the speed, and the other half (of second order in the step);
friction is that of the speed half a step ahead, by the last change. Bristles move along both halves
of the way by their own formula.
"""

import math

from stickslip.kernels.backend import Vector

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
