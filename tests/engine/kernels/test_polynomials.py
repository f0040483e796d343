"""First falls below zero, against exact arithmetic on the very coefficients that are searched.

The judge is Sturm's theorem in whole numbers. An answer may differ from the exact one only as far
as the exact ones of the polynomial a few roundings higher and lower do.
"""

import itertools
import math
from fractions import Fraction

import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from tests.support import examples

from stickslip.engine.kernels.numerics import FALLS_AT_ONCE, NEVER_FALLS, first_fall
from stickslip.engine.kernels.state_layout import NUMBERS, POLYNOMIAL, SERIES

EPSILON = 2.0**-52
MANY = examples(200)


def found(coefficients):
    """Return what the kernel finds."""
    w = [0.0] * NUMBERS
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


# Random polynomials

insides = st.fractions(0, 1, max_denominator=10**9)
gaps = st.integers(1, 10).map(lambda power: Fraction(1, 10**power))


def pair_of(root, gap):
    return product([-root, 1], [-root - gap, 1])


def complex_pair(real, imaginary):
    return [real * real + imaginary * imaginary, -2 * real, 1]


factors = st.one_of(
    insides.map(lambda root: [-root, 1]),
    st.fractions(-3, 4, max_denominator=10**9).map(lambda root: [-root, 1]),
    insides.map(lambda root: pair_of(root, 0)),
    st.builds(pair_of, insides, gaps),
    st.builds(complex_pair, insides, gaps),
    st.sampled_from([[0, 1], [-1, 1]]),
)


@st.composite
def polynomials(draw, most=SERIES):
    """Draw coefficients of a polynomial with roots where they are awkward."""
    p = [Fraction(draw(st.sampled_from([1, -1])))]
    for factor in draw(st.lists(factors, min_size=1, max_size=most)):
        if len(p) + len(factor) - 2 <= most:
            p = product(p, factor)
    return [float(c) for c in p]


DOUBT = 2e-14
"""First coefficients below 4e-15 of all count as zero, some in a row now and then; the Bernstein
coefficients of degree 20 carry twenty roundings and one more for each halving."""


@MANY
@given(coefficients=polynomials())
@example(coefficients=[0.25, -1.25, 1.0])  # falls, and is zero again at the very end
def test_the_first_fall_is_that_of_a_polynomial_within_rounding(coefficients):
    assert_right_but_for(coefficients, DOUBT, found(coefficients))


@pytest.mark.parametrize("factor", [[0, 1], [0, 0, 1]])
@examples(100)
@given(coefficients=polynomials(most=SERIES - 2))
def test_a_guard_that_starts_at_zero_falls_where_its_rest_does(factor, coefficients):
    assume(abs(coefficients[0]) > DOUBT * sum(map(abs, coefficients)))
    shifted = [0.0] * (len(factor) - 1) + coefficients
    assert found(shifted) == found(coefficients)


@given(coefficients=polynomials(), doublings=st.integers(-200, 200))
def test_the_size_of_a_guard_does_not_matter(coefficients, doublings):
    scaled = [math.ldexp(c, doublings) for c in coefficients]
    assume(all(c == 0 or abs(c) > 1e-290 for c in scaled))  # no subnormal numbers on the way
    assert found(scaled) == found(coefficients)


outsides = st.fractions(2, 5, max_denominator=1000) | st.fractions(-4, -1, max_denominator=1000)


@MANY
@given(
    root=st.fractions(Fraction(1, 100), 1, max_denominator=10**6),
    others=st.lists(outsides, max_size=SERIES - 1),
)
def test_a_single_root_is_found_to_the_last_digits_that_it_has(root, others):
    p = [root, Fraction(-1)]
    for other in others:
        p = product(p, [1, -1 / other])
    coefficients = [float(c) for c in p]
    exact = exact_fall(coefficients)
    assume(exact <= 1)
    slope = abs(float(sum(k * Fraction(c) * exact ** (k - 1) for k, c in enumerate(coefficients))))
    size = float(sum(abs(c) * exact**k for k, c in enumerate(map(Fraction, coefficients))))
    # Horner's rule errs by up to two half units in the last place per degree; then the bracket
    doubt = (len(p) - 1) * EPSILON * size / slope + 2 * EPSILON
    assume(exact <= 1 - doubt)  # whether a later fall belongs to this step is rounding too
    assert abs(found(coefficients) - float(exact)) <= doubt


@MANY
@given(root=insides, others=st.lists(outsides, max_size=8))
def test_the_point_found_lies_past_the_fall_and_no_later_than_needed(root, others):
    assume(0.01 < root < 0.99)
    p = [root, Fraction(-1)]
    for other in others:
        p = product(p, [1, -1 / other])
    x = found(p)
    coefficients = [Fraction(float(c)) for c in p]
    level = 1e-15 * float(total(coefficients))  # some roundings: that of each term at most
    assert -4 * level < float(sum(c * Fraction(x) ** k for k, c in enumerate(coefficients))) < level


# Short dips and touches


@MANY
@given(
    root=st.fractions(Fraction(1, 50), Fraction(49, 50), max_denominator=10**9),
    rest=st.lists(st.integers(0, 3), max_size=SERIES - 2),
)
def test_a_dip_of_a_millionth_of_the_step_is_not_missed(root, rest):
    width = Fraction(1, 10**6)
    p = product(pair_of(root, width), [1, *[Fraction(c, 10) for c in rest]])
    assert p[0] > 0
    assert sum(p) > 0
    x = found(p)
    # the slope is the width at least: its millionth part of the digits are left
    doubt = 1e6 * EPSILON * float(total(p)) * 4
    assert doubt < 1e-7
    assert abs(x - root) <= doubt


@pytest.mark.parametrize("power", range(4, 8))
@pytest.mark.parametrize("place", [1 / 3, 0.1, 0.5, 0.96875, 0.0078125])
def test_a_dip_is_found_as_long_as_it_is_deeper_than_rounding(place, power):
    width = Fraction(1, 10**power)  # its depth is a quarter of the square
    x = found(pair_of(Fraction(place), width))
    assert place - width / 100 <= x <= place + width / 2


@given(
    places=st.lists(st.integers(1, 255), min_size=1, max_size=3),
    rest=st.lists(st.integers(0, 15), max_size=6),
)
def test_double_roots_are_touched_and_at_most_taken_for_falls_of_no_depth(places, rest):
    p = [Fraction(1), *map(Fraction, rest)]
    for place in places:
        p = product(p, pair_of(Fraction(place, 256), 0))
    assume(all(Fraction(float(c)) == c for c in p))
    assert exact_fall(p) == NEVER_FALLS
    assert_right_but_for(p, DOUBT, found(p))


@pytest.mark.parametrize("place", [0.5, 0.25, 0.375, 0.0625, 0.8125])
def test_a_touch_in_whole_digits_is_no_fall_at_all(place):
    assert found(pair_of(Fraction(place), 0)) == NEVER_FALLS


@pytest.mark.parametrize("place", [0.5, 0.3, 0.75])
def test_a_fall_after_a_touch_is_found(place):
    x = found(product(pair_of(Fraction(1, 4), 0), [Fraction(place), -1]))
    # where it touches it is zero within rounding, a fall of no depth; it ends at the true one
    assert x == pytest.approx(0.25, abs=1e-7) or x == pytest.approx(place, rel=1e-13)


@pytest.mark.parametrize("place", [0.1, 0.3, 0.5, 0.75, 0.999])
def test_a_triple_root_is_a_fall(place):
    root = Fraction(place)
    x = found([-c for c in product(pair_of(root, 0), [-root, 1])])
    assert abs(x - place) <= 1e-4  # the third root of rounding, some units of it


# Ends


@pytest.mark.parametrize("factor", [[0.75, -1.0], [0.3, -1.0], [0.037447314, -1.0]])
def test_a_fall_counts_although_the_guard_is_back_at_zero_at_the_end(factor):
    x = found(product([Fraction(c) for c in factor], [1, -1]))
    assert x == pytest.approx(factor[0], rel=4 * EPSILON)


@pytest.mark.parametrize(
    "coefficients",
    [
        [0.0],
        [0.0, 0.0, 0.0],
        [1.0],
        [1.0, 2.0],
        [0.0, 1.0],
        [0.0, 0.0, 0.0, 1e-300],
        [1.0, -0.5, -0.4],
        [1.0, -1.0],  # zero at the end is not below it
        [0.0, 1.0, -1.0],
        [-1e-16, 1.0],  # an event was left there by rounding
        [1e-16, -1e-16, 1.0],
        [0.0, -4e-16, 1.0],
        [-0.0, 0.0, 1.0],
        [1.0, -3.0, 2.5],
    ],
)
def test_a_guard_that_never_falls_is_known(coefficients):
    assert found(coefficients) == NEVER_FALLS


@pytest.mark.parametrize(
    "coefficients",
    [
        [-1.0],
        [-1.0, 3.0],
        [0.0, -1.0],
        [0.0, 0.0, -1e-300],
        [1e-16, -1.0],  # an event was left there by rounding
        [-1e-14, 1.0],
        [0.0, 1e-17, -1.0, 5.0],
        [-1e-16, 1e-17, -1.0, 0.5],
    ],
)
def test_a_guard_that_falls_at_once_is_known(coefficients):
    assert found(coefficients) == FALLS_AT_ONCE


def test_a_root_at_the_very_end_is_not_looked_for_before_it():
    for degree in range(1, SERIES + 1):
        x = found([1.0, *[0.0] * (degree - 1), -1.0 - 4 * EPSILON])
        assert 1.0 - 8 * EPSILON <= x <= 1.0  # the root: 1 less four units over the degree
