"""Dense output: the solution inside a step, as a function of the fraction x of its length.

Its first entry is the number of terms of a power series, or 0 for the nested form of the other
steppers, y0 + x (F0 + (1 - x) (F1 + x (F2 + (1 - x) (F3 + x (F4 + (1 - x) (F5 + x F6)))))), or
`NESTED_SHORT` for one that ends with F3.
"""

from stickslip.kernels.backend import Vector, Wholes
from stickslip.kernels.state_layout import DENSE, N_STATES

NESTED_SHORT = -1.0


def interpolate(w: Vector, whole: Wholes, x: float, to: int) -> None:
    """Evaluate the step at the fraction `x` of its length."""
    dense = whole[DENSE]
    n = whole[N_STATES]
    terms = int(w[dense])
    if terms > 0 and n == 2:
        values_of_two(w, x, dense + 1, terms, to)
        return
    if terms > 0:
        # even and odd powers by themselves, of which neither waits for the other
        square = x * x
        half = terms // 2
        for i in range(n):
            at = dense + 1 + i
            even = w[at + 2 * half * n]
            odd = w[at + terms * n] if terms > 2 * half else 0.0
            for k in range(half - 1, -1, -1):
                even = even * square + w[at + 2 * k * n]
                odd = odd * square + w[at + (2 * k + 1) * n]
            w[to + i] = even + x * odd
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


def values_of_two(w: Vector, x: float, at: int, terms: int, to: int) -> None:
    """Evaluate the series of two states, whose terms stand side by side from `at` on."""
    square = x * x
    last = at + 2 * terms
    even_x, even_v, odd_x, odd_v = w[last], w[last + 1], 0.0, 0.0
    if terms % 2 == 1:
        odd_x, odd_v = even_x, even_v
        last -= 2
        even_x, even_v = w[last], w[last + 1]
    for k in range(last - 4, at - 1, -4):
        even_x = even_x * square + w[k]
        even_v = even_v * square + w[k + 1]
        odd_x = odd_x * square + w[k + 2]
        odd_v = odd_v * square + w[k + 3]
    for i in range(2):
        w[to + i] = even_x + x * odd_x if i == 0 else even_v + x * odd_v
