"""What columns of a record show: filters and slopes, and the noise of a sensor."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfilt, sosfilt_zi

from stickslip.data import unit_differences

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


def derivative(x: Array, h: float) -> Array:
    """Return slopes by central differences of the fourth order.

    Those of the second order bias the inertia by half a per cent, and the damping of a bristle that
    vibrates with a tenth of the sampling frequency by seven.
    """
    found = np.gradient(x, h)
    found[2:-2] = (x[:-4] - 8.0 * x[1:-3] + 8.0 * x[3:-1] - x[4:]) / (12.0 * h)
    return np.asarray(found)


def resolution(q: Array, t: Array | None = None) -> float:
    """Return the standard deviation of what positions (n,) do not resolve, at even times or t.

    The larger of the rounding, where many samples differ by one step of an encoder, and of the
    third differences in the quietest fifth of the record.

    Examples
    --------
    >>> q = np.sin(0.001 * np.arange(5000.0))
    >>> resolution(np.round(q, 2)) > 0.002, resolution(q) < 1e-8
    (True, True)
    """
    unit = 1e-12 * max(float(np.ptp(q)), 1e-300)
    levels = np.unique(np.round((q - q[0]) / unit)) * unit
    apart = np.diff(levels)
    apart = apart[apart > 1.5 * unit]
    step = float(apart.min()) if apart.size else 0.0
    steps = np.abs(np.diff(q))
    moved = steps[steps > unit]
    share = float(np.mean(moved < 1.5 * step)) if moved.size else 0.0
    rounded = share > 0.02 or len(levels) < len(q) / 3
    third = np.diff(q, 3) / math.sqrt(20.0) if t is None else unit_differences(q, t, 3)
    n = max(len(third) // 20, 1)
    blocks = [third[i * n : (i + 1) * n] for i in range(20)]
    quiet = float(np.quantile([one.std() for one in blocks if one.size], 0.2))
    return max(step / math.sqrt(12.0) if rounded else 0.0, quiet)


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
