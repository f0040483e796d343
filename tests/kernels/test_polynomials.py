"""First falls below zero, against exact arithmetic on the very coefficients that are searched.

The judge is Sturm's theorem in whole numbers. An answer may differ from the exact one only as far
as the exact ones of the polynomial a few roundings higher and lower do.
"""

import itertools
import math
from fractions import Fraction

import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from stickslip.kernels.layout import POLYNOMIAL, SERIES, SIZE
from stickslip.kernels.polynomials import FALLS_AT_ONCE, NEVER_FALLS, first_fall

EPSILON = 2.0**-52
MANY = settings(max_examples=200)


def found(coefficients):
    """Return what the kernel finds."""
    w = [0.0] * SIZE
    w[POLYNOMIAL : POLYNOMIAL + len(coefficients)] = [float(c) for c in coefficients]
    return first_fall(w, len(coefficients) - 1)


# Exact arithmetic: polynomials are lists of coefficients, the constant one first


def product(p, q):
    result = [Fraction(0)] * (len(p) + len(q) - 1)
    for (i, a), (j, b) in itertools.product(enumerate(p), enumerate(q)):
        result[i + j] += a * b
    return result


def value(p, x):
    """Return a positive multiple of the value of a polynomial in whole numbers."""
    total, power = 0, 1
    for c in reversed(p):
        total = total * x.numerator + c * power
        power *= x.denominator
    return total


def derivative(p):
    return [k * c for k, c in enumerate(p)][1:]


def whole(p):
    """Return the polynomial in whole numbers, without common factor and leading zeros."""
    p = [Fraction(c) for c in p]
    while p and p[-1] == 0:
        p.pop()
    shared = math.lcm(*[c.denominator for c in p])
    numbers = [int(c * shared) for c in p]
    return [n // math.gcd(*numbers) for n in numbers]


def remainder(p, q):
    """Return a positive multiple of the remainder of p over q."""
    p = list(p)
    while len(p) >= len(q):
        lead = p.pop() * (1 if q[-1] > 0 else -1)
        p = [abs(q[-1]) * c for c in p]
        for i, c in enumerate(q[:-1], len(p) + 1 - len(q)):
            p[i] -= lead * c
    return whole(p)


def sturm(p):
    chain = [p, whole(derivative(p))]
    while chain[-1]:
        chain.append([-c for c in remainder(chain[-2], chain[-1])])
    return chain[:-1]


def changes(chain, x):
    signs = [s > 0 for s in (value(p, x) for p in chain) if s != 0]
    return sum(a != b for a, b in itertools.pairwise(signs))


def without_ends(p):
    """Return the polynomial without its roots at 0 and at 1, with its sign between them."""
    p = whole(p)
    while p and p[0] == 0:
        p = p[1:]
    while p and sum(p) == 0:  # divided by 1 - x
        p = list(itertools.accumulate(p))[:-1]
    return p


def exact_fall(p):
    """Return where an exact polynomial begins to be negative: 0 to 1, or NEVER_FALLS."""
    p = without_ends(p)
    if not p or p[0] < 0:
        return Fraction(0) if p else NEVER_FALLS
    chain = sturm(p)
    pending = [(Fraction(0), Fraction(1))]
    while pending:
        low, high = pending.pop()
        roots = changes(chain, low) - changes(chain, high)
        if roots == 0 or (roots == 1 and value(p, high) > 0):
            continue
        middle = (low + high) / 2
        while value(p, middle) == 0:
            middle = (low + middle) / 2
        if roots > 1:
            pending += [(middle, high), (low, middle)]
        elif high - low < EPSILON / 16:
            return high
        else:
            pending.append((low, middle) if value(p, middle) < 0 else (middle, high))
    return NEVER_FALLS


def total(coefficients):
    return sum(abs(Fraction(c)) for c in coefficients)


def assert_right_but_for(coefficients, doubt, x):
    """Check an answer against those of the polynomial a little lower and higher, relatively."""
    shift = total(coefficients) * Fraction(doubt)
    first, *others = [Fraction(c) for c in coefficients]
    x = max(x, 0.0)
    assert exact_fall([first - shift, *others]) - 2 * EPSILON <= x
    assert x <= exact_fall([first + shift, *others]) + 2 * EPSILON
