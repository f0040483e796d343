"""What stroboscopic samples tell: how many cycles an orbit takes."""

import numpy as np

from stickslip.sweep.parameter_grid import Array

CLOSED = 1e-3
"""Share of the size of a state within which samples count as the same point."""


def period_of(samples: Array, scale: Array | float, tolerance: float = CLOSED) -> int:
    """Return after how many samples an orbit closes, 0 if it does not within half of them.

    Examples
    --------
    >>> period_of(np.array([1.0, 3.0, 1.0, 3.0, 1.0, 3.0]), 3.0)
    2
    >>> period_of(np.array([1.0, 3.0, 2.0, 5.0, 1.5, 0.2]), 3.0)
    0
    """
    points = np.reshape(samples, (len(samples), -1))
    if not np.isfinite(points).all():
        return 0
    limit = tolerance * np.broadcast_to(scale, points.shape[1:])
    for period in range(1, len(points) // 2 + 1):
        if (np.abs(points[period:] - points[:-period]) <= limit).all():
            return period
    return 0
