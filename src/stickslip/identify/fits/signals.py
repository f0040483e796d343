"""Filters of columns of a record, and the gaps in them."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfilt, sosfilt_zi

Array = NDArray[np.float64]

GAP = 3.0
"""Steps of time longer than this many usual ones are gaps, in which the motion is not known."""
ORDER = 4
"""Order of filters."""


@dataclass(frozen=True, eq=False)
class LowPass:
    """A filter, with the states that take scipy's filter longer to find than a column to pass."""

    sections: Array
    """Sections of second order (m, 6)."""
    settled: Array
    """Their states after a constant 1 (m, 2)."""

    def passed(self, x: Array) -> Array:
        """Return columns (n, ...) after the filter, forward and backward, as `sosfiltfilt` does.

        Beyond their ends they go on point-mirrored, and before these as a constant.
        """
        n = 3 * (ORDER + 1)
        found = np.concatenate([2.0 * x[:1] - x[n:0:-1], x, 2.0 * x[-1:] - x[-2 : -n - 2 : -1]])
        settled = self.settled.reshape(*self.settled.shape, *(1,) * (x.ndim - 1))
        for _ in ("forward", "backward"):
            found = sosfilt(self.sections, found, axis=0, zi=settled * found[0])[0][::-1]
        return np.asarray(found[n:-n])


def low_pass(h: float, fc: float, most: float = 0.9) -> LowPass:
    """Return the filter of fourth order with a band [Hz] at steps h [s]."""
    sections = np.asarray(butter(ORDER, min(2.0 * h * fc, most), output="sos"))
    return LowPass(sections, np.asarray(sosfilt_zi(sections)))


def play(path: Array, reach: float) -> Array:
    """Return positions (n,) that follow a path only where it leaves their reach, as play does.

    Chatter of less than the reach is gone: noise at rest must not relax a bristle.
    """
    found, at = [], float(path[0])
    for x in path.tolist():  # comparisons, as `min` and `max` take thrice as long
        if at < x - reach:
            at = x - reach
        elif at > x + reach:
            at = x + reach
        found.append(at)
    return np.array(found)
