"""Where a polynomial on 0 to 1 first falls below zero; no fall is missed, however short.

In Bernstein form the number of roots is at most the number of sign changes of the coefficients,
and of the same parity (Descartes). None means no root, one means one; else the interval is halved.
The coefficients stand at POLYNOMIAL, the intervals still to be looked at on a stack at ROOM.
"""

from stickslip.kernels.backend import Vector
from stickslip.kernels.state_layout import DEEPEST, INTERVAL, POLYNOMIAL, ROOM

NEVER_FALLS = 2.0
FALLS_AT_ONCE = -1.0
ROUNDED = 4e-15
"""Share of all coefficients below which the first ones are zero but for rounding."""
EPSILON = 2.220446049250313e-16


def horner(w: Vector, first: int, degree: int, x: float) -> float:
    """Return the polynomial over x to the power `first`."""
    value = w[POLYNOMIAL + degree]
    for k in range(POLYNOMIAL + degree - 1, POLYNOMIAL + first - 1, -1):
        value = value * x + w[k]
    return value


def to_bernstein(w: Vector, first: int, d: int) -> None:
    """Write the whole interval, with the Bernstein coefficients, to the bottom of the stack."""
    w[ROOM] = 0.0
    w[ROOM + 1] = 1.0
    # b_i is the sum over j <= i of c_j binomial(i, j) / binomial(d, j): quotients, then sums of
    # neighbours as in Pascal's triangle
    binomial = 1.0
    for j in range(d + 1):
        w[ROOM + 2 + j] = w[POLYNOMIAL + first + j] / binomial
        binomial *= (d - j) / (j + 1.0)
    for row in range(d):
        for i in range(ROOM + 2 + d, ROOM + 2 + row, -1):
            w[i] += w[i - 1]


def sign_changes(w: Vector, at: int, d: int) -> int:
    """Return the number of sign changes, zeros left out; -1 if the first sign is negative."""
    changes = 0
    sign = 0.0
    for i in range(at + 2, at + d + 3):
        value = w[i]
        if value != 0.0:
            if sign == 0.0 and value < 0.0:
                return -1
            if value * sign < 0.0:
                changes += 1
            sign = 1.0 if value > 0.0 else -1.0
    return changes


def halve(w: Vector, at: int, d: int) -> None:
    """Split an interval in two (de Casteljau): its right half stays, the left one goes on top."""
    top = at + INTERVAL
    half = 0.5 * w[at + 1]
    w[top] = w[at]
    w[top + 1] = half
    w[at] += half
    w[at + 1] = half
    w[top + 2] = w[at + 2]
    for row in range(1, d + 1):
        for i in range(at + 2, at + d + 3 - row):
            w[i] = 0.5 * (w[i] + w[i + 1])
        w[top + 2 + row] = w[at + 2]


def fall_in(w: Vector, first: int, degree: int, at: int) -> float:
    """Return the point just past the one sign change of an interval."""
    low = w[at]
    high = low + w[at + 1]
    f_low = w[at + 2]
    f_high = w[at + 2 + degree - first]
    if f_low <= 0.0:  # a root within rounding of the lower end
        return low
    if f_high >= 0.0:  # negative before, and back at zero but for rounding
        f_high = -EPSILON * f_low
    # Newton's steps, and the middle of the bracket where they leave it or shrink too slowly
    last = high - low
    x = low + last * (f_low / (f_low - f_high))
    while True:
        value = w[POLYNOMIAL + degree]
        slope = 0.0
        for k in range(POLYNOMIAL + degree - 1, POLYNOMIAL + first - 1, -1):
            slope = slope * x + value
            value = value * x + w[k]
        if value < 0.0:
            high = x
        else:
            low = x
        step = -value / slope if slope < 0.0 else high - low
        if abs(step) <= EPSILON * x or high - low <= 2.0 * EPSILON * high:
            break
        if not (low < x + step < high and 2.0 * abs(step) <= last):
            step = 0.5 * (low + high) - x
            if not low < x + step < high:
                return high
        last = abs(step)
        x += step
    beyond = EPSILON * x
    while x < high and beyond > 0.0 and horner(w, first, degree, x) >= 0.0:
        x += beyond
        beyond *= 2.0
    return min(x, high)


def first_fall(w: Vector, degree: int) -> float:
    """Return the fraction just past the first fall below zero, NEVER_FALLS or FALLS_AT_ONCE."""
    total = 0.0
    down = 0.0
    for k in range(degree + 1):
        coefficient = w[POLYNOMIAL + k]
        total += abs(coefficient)
        if coefficient < 0.0:
            down -= coefficient
    first = 0
    while first <= degree and abs(w[POLYNOMIAL + first]) <= ROUNDED * total:
        first += 1
    if first > degree:
        return NEVER_FALLS
    if w[POLYNOMIAL + first] < 0.0:
        return FALLS_AT_ONCE
    # on 0 to 1 the negative terms cannot outweigh the first one if it is more than their sum
    if w[POLYNOMIAL + first] > down:
        return NEVER_FALLS
    d = degree - first
    to_bernstein(w, first, d)
    top = 0
    while top >= 0:
        at = ROOM + top * INTERVAL
        changes = sign_changes(w, at, d)
        if changes == -1:
            return max(w[at], EPSILON)
        if changes == 1:
            return fall_in(w, first, degree, at)
        if changes == 0 or top == DEEPEST:
            top -= 1
        else:
            halve(w, at, d)
            top += 1
    return NEVER_FALLS
