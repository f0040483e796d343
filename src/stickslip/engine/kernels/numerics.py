"""Numerical tools of the kernels: quadrature, linear systems, polynomials inside a step.

1. Integrals over a step are sums over the nodes of Gauss and Legendre.
2. Small dense systems A x = b are factorised in place, P A = L U, with row pivoting.
3. The solution inside a step is a polynomial in the fraction x of its length: a power series where
   the mode is linear, else the nested form of Hairer's DOP853.
4. The first place at which such a polynomial falls below zero is found by its coefficients in
   Bernstein form: their sign changes bound the number of roots (Descartes), and an interval with
   more than one is halved. No fall is missed, however short.
"""

import math

from stickslip.engine.kernels import state_layout as layout
from stickslip.engine.kernels.backend import IntVector, Vector

# Nodes and weights of Gauss and Legendre on 0 to 1, for integrals over a step.

# n nodes are exact for polynomials up to degree 2 n - 1: 5 and 13.
FEW_NODES = (0.1127016653792583, 0.5, 0.8872983346207417)
FEW_WEIGHTS = (0.2777777777777778, 0.4444444444444444, 0.2777777777777778)

NODES = (
    0.0254460438286207,
    0.12923440720030277,
    0.2970774243113014,
    0.5,
    0.7029225756886985,
    0.8707655927996972,
    0.9745539561713793,
)
WEIGHTS = (
    0.06474248308443487,
    0.13985269574463843,
    0.19091502525255935,
    0.20897959183673465,
    0.19091502525255935,
    0.13985269574463843,
    0.06474248308443487,
)


# Small dense linear systems, factorised in place with row pivoting.


def lu_factor(w: Vector, a: int, n: int, pivots: int) -> bool:
    """Factorise the n x n matrix at `a`, rows one after the other; False if it is singular."""
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(w[a + i * n + k]) > abs(w[a + best * n + k]):
                best = i
        w[pivots + k] = best
        if not abs(w[a + best * n + k]) > 0.0:  # false for NaN, too
            return False
        if best != k:
            for j in range(n):
                swap = w[a + k * n + j]
                w[a + k * n + j] = w[a + best * n + j]
                w[a + best * n + j] = swap
        w[a + k * n + k] = 1.0 / w[a + k * n + k]  # many solutions follow, and products are faster
        for i in range(k + 1, n):
            factor = w[a + i * n + k] * w[a + k * n + k]
            w[a + i * n + k] = factor
            for j in range(k + 1, n):
                w[a + i * n + j] -= factor * w[a + k * n + j]
    return True


def lu_solve(w: Vector, a: int, n: int, pivots: int, b: int) -> None:
    """Solve with a factorised matrix; the solution replaces the right-hand side at `b`."""
    for k in range(n):
        best = int(w[pivots + k])
        if best != k:
            swap = w[b + k]
            w[b + k] = w[b + best]
            w[b + best] = swap
    # sums in variables of their own: a processor waits for what it has just put into memory
    if n == 3:  # a coordinate and its bristle
        x = w[b]
        y = w[b + 1] - w[a + 3] * x
        z = (w[b + 2] - w[a + 6] * x - w[a + 7] * y) * w[a + 8]
        y = (y - w[a + 5] * z) * w[a + 4]
        w[b] = (x - w[a + 1] * y - w[a + 2] * z) * w[a]
        w[b + 1] = y
        w[b + 2] = z
        return
    for i in range(1, n):
        total = w[b + i]
        for j in range(i):
            total -= w[a + i * n + j] * w[b + j]
        w[b + i] = total
    for i in range(n - 1, -1, -1):
        total = w[b + i]
        for j in range(i + 1, n):
            total -= w[a + i * n + j] * w[b + j]
        w[b + i] = total * w[a + i * n + i]


# Dense output: the solution inside a step, as a function of the fraction x of its length.
#
# Its first entry is the number of terms of a power series, or 0 for the nested form of the other
# steppers, y0 + x (F0 + (1 - x) (F1 + x (F2 + (1 - x) (F3 + x (F4 + (1 - x) (F5 + x F6)))))), or
# `NESTED_SHORT` for one that ends with F3.

NESTED_SHORT = -1.0


def interpolate(w: Vector, iw: IntVector, x: float, to: int) -> None:
    """Evaluate the step at the fraction `x` of its length."""
    dense = iw[layout.DENSE]
    n = iw[layout.N_STATES]
    terms = int(w[dense])
    if terms > 0:
        for i in range(0, n, 2):
            first = i if i < n - 1 else i - 1  # the last of an odd number once more with its own
            values_of_two(w, x, n, terms, dense + 1 + first, to + first)
        return
    rest_of_step = 1.0 - x
    if terms < 0:
        for i in range(n):
            at = dense + 1 + i
            value = w[at + 4 * n] * rest_of_step + w[at + 3 * n]
            value = value * x + w[at + 2 * n]
            value = value * rest_of_step + w[at + n]
            w[to + i] = value * x + w[at]
        return
    for i in range(n):
        at = dense + 1 + i
        value = w[at + 7 * n] * x + w[at + 6 * n]
        value = value * rest_of_step + w[at + 5 * n]
        value = value * x + w[at + 4 * n]
        value = value * rest_of_step + w[at + 3 * n]
        value = value * x + w[at + 2 * n]
        value = value * rest_of_step + w[at + n]
        w[to + i] = value * x + w[at]


def values_of_two(w: Vector, x: float, n: int, terms: int, at: int, to: int) -> None:
    """Evaluate the series of two of `n` states, whose terms stand side by side from `at` on.

    Even and odd powers are summed by themselves: none of the four sums waits for another.
    """
    square = x * x
    k = at + n * (terms - terms % 2)
    even_x, even_v, odd_x, odd_v = w[k], w[k + 1], 0.0, 0.0
    if terms % 2 == 1:
        odd_x, odd_v = w[k + n], w[k + n + 1]
    while k > at:
        k -= 2 * n
        even_x = even_x * square + w[k]
        even_v = even_v * square + w[k + 1]
        odd_x = odd_x * square + w[k + n]
        odd_v = odd_v * square + w[k + n + 1]
    for i in range(2):
        w[to + i] = even_x + x * odd_x if i == 0 else even_v + x * odd_v


# Where a polynomial on 0 to 1 first falls below zero; no fall is missed, however short.
#
# In Bernstein form the number of roots is at most the number of sign changes of the coefficients,
# and of the same parity (Descartes). None means no root, one means one; else the interval is
# halved. The coefficients stand at POLYNOMIAL, the intervals still to be looked at on a stack at
# ROOM.

NEVER_FALLS = 2.0
FALLS_AT_ONCE = -1.0
ROUNDED = 4e-15
"""Share of all coefficients below which the first ones are zero but for rounding."""
EPSILON = 2.220446049250313e-16


def horner(w: Vector, first: int, degree: int, x: float) -> float:
    """Return the polynomial over x to the power `first`."""
    value = w[layout.POLYNOMIAL + degree]
    for k in range(layout.POLYNOMIAL + degree - 1, layout.POLYNOMIAL + first - 1, -1):
        value = value * x + w[k]
    return value


def to_bernstein(w: Vector, first: int, d: int) -> None:
    """Write the whole interval, with the Bernstein coefficients, to the bottom of the stack."""
    w[layout.ROOM] = 0.0
    w[layout.ROOM + 1] = 1.0
    # b_i is the sum over j <= i of c_j binomial(i, j) / binomial(d, j): quotients, then sums of
    # neighbours as in Pascal's triangle
    binomial = 1.0
    for j in range(d + 1):
        w[layout.ROOM + 2 + j] = w[layout.POLYNOMIAL + first + j] / binomial
        binomial *= (d - j) / (j + 1.0)
    for row in range(d):
        for i in range(layout.ROOM + 2 + d, layout.ROOM + 2 + row, -1):
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
    top = at + layout.INTERVAL
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
        value = w[layout.POLYNOMIAL + degree]
        slope = 0.0
        for k in range(layout.POLYNOMIAL + degree - 1, layout.POLYNOMIAL + first - 1, -1):
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
    total, first = 0.0, 0
    for k in range(degree + 1):
        total += abs(w[layout.POLYNOMIAL + k])
    while first <= degree and abs(w[layout.POLYNOMIAL + first]) <= ROUNDED * total:
        first += 1
    if first > degree:
        return NEVER_FALLS
    if w[layout.POLYNOMIAL + first] < 0.0:
        return FALLS_AT_ONCE
    # powers fall from each to the next on 0 to 1: a polynomial is a mean of its partial sums
    partial, least = 0.0, math.inf
    for k in range(first, degree + 1):
        partial += w[layout.POLYNOMIAL + k]
        least = min(least, partial)
    if least > ROUNDED * total:
        return NEVER_FALLS
    d = degree - first
    to_bernstein(w, first, d)
    top = 0
    while top >= 0:
        at = layout.ROOM + top * layout.INTERVAL
        changes = sign_changes(w, at, d)
        if changes == -1:
            return max(w[at], EPSILON)
        if changes == 1:
            return fall_in(w, first, degree, at)
        if changes == 0 or top == layout.DEEPEST:
            top -= 1
        else:
            halve(w, at, d)
            top += 1
    return NEVER_FALLS
