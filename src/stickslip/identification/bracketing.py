"""Roots of one unknown on a positive axis."""

import math
from collections.abc import Callable

from scipy.optimize import brentq

__all__ = ["positive_root"]

DOUBLINGS = 12
"""How far the search goes: a factor of 4096 to either side. Beyond it laws only get stiff."""


def positive_root(
    function: Callable[[float], float],
    start: float,
    *,
    low: float = 0.0,
    high: float = math.inf,
) -> float | None:
    """Return a root between `low` and `high` next to `start`, or None if no sign change is found.

    The search doubles and halves outwards from `start`, so it needs no scale.

    Examples
    --------
    >>> round(positive_root(lambda x: x * x - 2.0, 1.0), 9)
    1.414213562
    """
    start = min(max(start, low), high)
    inner = function(start)
    if inner == 0.0:
        return start
    below = above = start
    f_below = f_above = inner
    for _ in range(DOUBLINGS):
        if above < high:
            wider = min(2.0 * above, high)
            f_wider = function(wider)
            if f_wider * f_above <= 0.0:
                return float(brentq(function, above, wider, rtol=1e-10, xtol=1e-300))
            above, f_above = wider, f_wider
        if below > low:
            lower = max(0.5 * below, low)
            f_lower = function(lower)
            if f_lower * f_below <= 0.0:
                return float(brentq(function, lower, below, rtol=1e-10, xtol=1e-300))
            below, f_below = lower, f_lower
        if above >= high and below <= max(low, start * 2.0**-DOUBLINGS):
            break
    return None
