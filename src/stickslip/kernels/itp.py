"""The ITP method for a sign change in a bracket (Oliveira, Takahashi 2021)."""

import math

PUSH = 0.2
"""The paper's kappa_1 times the first bracket, with kappa_2 = 2: how far the secant's point is
moved towards the middle, so that a bracket of which one end never moves shrinks too."""


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
    radius = max(epsilon * 2.0**spare - 0.5 * (high - low), 0.0)
    secant = (f_high * low - f_low * high) / (f_high - f_low)
    side = 1.0 if middle > secant else -1.0
    push = PUSH / width * (high - low) ** 2
    x = middle if push > abs(middle - secant) else secant + side * push
    if abs(x - middle) > radius:
        x = middle - side * radius
    return min(max(x, low + 0.5 * epsilon), high - 0.5 * epsilon)
