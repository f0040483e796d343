"""Friction that drifts evenly from the first reading to the last, in the order of readings."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from stickslip.formatting import number
from stickslip.selection.verdict import in_sentence

LIKELY: Final = 0.25
"""Largest drift over all readings, over the friction, that is thought of."""
ROUNDS: Final = 8
"""Steps of the search for a drift beside a law, at most."""
SETTLED: Final = 1e-3
"""Change of a drift below which it is found."""


def along(count: int) -> NDArray[np.float64]:
    """Return how far along its measurement each of so many readings is, from 0 to 1."""
    return np.linspace(0.0, 1.0, count)


def if_drifting(title: str, drift: float, what: str) -> str:
    """Return a law, and the drift over rows or trials with which it explains readings.

    Examples
    --------
    >>> if_drifting("Coulomb", 0.1, "row")
    'Coulomb with friction that drifts by 10 % from the first row to the last'
    """
    return (
        f"{in_sentence(title)} with friction that drifts by {number(100.0 * drift, 2)} % from the"
        f" first {what} to the last"
    )
