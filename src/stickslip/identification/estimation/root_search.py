"""A root of one unknown on a positive axis."""

import math
from collections.abc import Callable

import scipy

from stickslip.errors import SimulationError

STRIDE = 1.3
"""Ratio of neighbouring points of the search; two roots closer than this are not told apart."""
REACH = 4096.0
"""How far the search for a first root goes, as a factor. Beyond it laws only get stiff."""

Function = Callable[[float], float]


def positive_root(
    function: Function,
    start: float,
    *,
    low: float = 0.0,
    high: float = math.inf,
    reach: float = REACH,
) -> float | None:
    """Return the root between `low` and `high` that is nearest to `start`, or None.

    Examples
    --------
    >>> round(positive_root(lambda x: x * x - 2.0, 1.0), 9)
    1.414213562
    """
    found = _search(function, start, low, high, reach)
    return min(
        found, key=lambda root: abs(math.log(root / start)) if root > 0 else 1e9, default=None
    )


def _search(function: Function, start: float, low: float, high: float, reach: float) -> list[float]:
    """Return the first roots that are met outwards from the start, up to a factor of `reach`."""
    start = min(max(start, low), high)
    value = _value(function, start)
    found = [start] if value == 0.0 else []
    value = value or None  # a root at the start brackets nothing
    sides = {STRIDE: (start, value), 1.0 / STRIDE: (start, value)}
    factor = 1.0
    while factor < reach and not found:
        factor *= STRIDE
        for step, (before, f_before) in list(sides.items()):
            point = min(max(before * step, low), high)
            if point == before:
                continue
            f_point = _value(function, point)
            if f_before is not None and f_point is not None and _crosses(f_before, f_point):
                ends = sorted((before, point))
                found.append(float(scipy.optimize.brentq(function, *ends, rtol=1e-10, xtol=1e-300)))
            sides[step] = (point, f_point)
    return found


def _crosses(before: float, after: float) -> bool:
    """Whether the sign changes, or 0 is reached; the product of tiny values would be 0."""
    return before < 0.0 <= after or after <= 0.0 < before


def _value(function: Function, point: float) -> float | None:
    try:
        return function(point)
    except SimulationError:
        return None
