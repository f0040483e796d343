"""What a measured motion shows: its resolution, the band of the balance, directions and rests."""

import itertools
import math
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d
from scipy.signal import butter, sosfilt, sosfilt_zi

from stickslip.evidence.series import Series

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]

ORDER = 4
"""Order of filters."""
SHARE = 0.01
"""Share of the force that noise of the position may cost through the inertia in the band."""
OF_FRICTION = 0.025
"""Share of what a known mechanism leaves of the force that it may cost: with 1 %, records of
5 s have so narrow a band that reversals look like Stribeck steps."""
LOWEST, HIGHEST = 4.0, 60.0
"""Limits of the band [Hz]: below, reversals are not seen; above, friction has little to say."""
RATE = 0.2
"""Largest band over the sampling rate."""
TOP = 0.98
"""Quantile of the speed that counts as the largest."""
MIXED = 0.5
"""Reach of the filter beside rests and reversals, over 1/fc, beyond which a tenth is left ..."""
RINGING = 1.6
"""... and beyond which nothing is left of what happens there."""
ABOVE = 3.0
"""Standard deviations of its noise from which a velocity has a direction."""


@final
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


def resolution_of(series: Series) -> float:
    """Return the resolution that a series is given, or that its positions show."""
    return resolution(series.q, series.t) if series.resolution is None else series.resolution


def unit_differences(values: Array, time: Array, order: int) -> Array:
    """Return divided differences of values (n,) in which white noise 1 is 1, whatever the times.

    Polynomials of a lower order are 0 in them, while plain differences of uneven samples have the
    jitter of the times in them.

    Examples
    --------
    >>> t = np.array([0.0, 1.0, 1.5, 4.0])
    >>> unit_differences(t**2, t, 3).round(12).tolist()
    [0.0]
    >>> unit_differences(np.array([0.0, 0.0, 1.0]), np.arange(3.0), 2).round(3).tolist()
    [0.408]
    """
    columns = [np.arange(i, max(len(values) - order, 0) + i) for i in range(order + 1)]
    weights = np.ones((order + 1, len(columns[0])))
    for i, j in itertools.permutations(range(order + 1), 2):
        weights[i] /= time[columns[i]] - time[columns[j]]
    weights /= np.linalg.norm(weights, axis=0)
    return np.asarray(
        np.sum([w * values[rows] for w, rows in zip(weights, columns, strict=True)], axis=0)
    )


def top_speed(v: Array) -> float:
    """Return the speed that few samples exceed."""
    return float(np.quantile(np.abs(v), TOP))


def band(series: Series) -> float:
    """Return the band [Hz] in which noise of the position costs little of the force.

    White noise s of the position, sampled every h, has an acceleration of variance
    2 h s^2 (2 pi)^4 fc^5 / 5 up to fc; the inertia comes from a first regression.
    """
    h = float(np.median(np.diff(series.t)))  # pieces may be uneven yet
    top = min(RATE / h, HIGHEST)
    if not series.driven:
        return top
    rest = series.force if series.taken is None else series.force - series.taken
    if series.mass is not None:
        noise = series.mass * resolution_of(series)
        allowed = SHARE * float((series.force if series.force.any() else rest).std())
        if series.taken is not None or series.extra:  # friction may be a small part of the force
            low = low_pass(h, min(10.0, top / 2.0))
            a = derivative(derivative(low.passed(series.q), h), h)
            friction = low.passed(rest) - series.mass * a
            known = [low.passed(one) for one in series.extra.values()]
            friction = friction - _fitted(np.column_stack([np.ones_like(a), *known]), friction)
            small = OF_FRICTION * float(friction.std())
            allowed = min(allowed, small) if allowed > 0.0 else small
        return float(np.clip(_frequency(allowed / noise, h), LOWEST, top)) if noise > 0.0 else top
    low = low_pass(h, min(10.0, top / 2.0))
    v = np.gradient(low.passed(series.q), h)
    a = np.gradient(v, h)
    f = low.passed(rest)
    slow = max(0.01 * top_speed(v), 1e-300)
    known = [low.passed(one) for one in series.extra.values()]
    columns = np.column_stack([a, np.tanh(v / slow), np.ones_like(a), *known])
    size = np.maximum(np.sqrt((columns * columns).sum(axis=0)), 1e-300)
    values = np.linalg.lstsq(columns / size, f, rcond=None)[0] / size
    noise = abs(float(values[0])) * resolution_of(series)
    allowed = SHARE * float(f.std())
    if series.taken is not None or series.extra:
        friction = values[1] * columns[:, 1] + f - columns @ values
        allowed = min(allowed, OF_FRICTION * float(friction.std()))
    if not noise > 0.0:
        return top
    return float(np.clip(_frequency(allowed / noise, h), LOWEST, top))


def _fitted(columns: Array, wanted: Array) -> Array:
    """Return what columns (n, p) explain (n,) by least squares."""
    size = np.maximum(np.sqrt((columns * columns).sum(axis=0)), 1e-300)
    found: Array = columns / size @ np.linalg.lstsq(columns / size, wanted, rcond=None)[0]
    return found


def acceleration_of_noise(h: float, fc: float) -> float:
    """Return the standard deviation of the acceleration of white noise 1 of the position."""
    return math.sqrt(2.0 * h * (2.0 * math.pi) ** 4 * fc**5 / 5.0)


def _frequency(ratio: float, h: float) -> float:
    """Return where noise of the position 1 has an acceleration of a standard deviation."""
    return float((5.0 * ratio**2 / (2.0 * h * (2.0 * math.pi) ** 4)) ** 0.2)


def directions(series: Series, v: Array, sigma: float, fc: float) -> Array:
    """Return the direction (n,) of the motion, -1, 0 or 1.

    It is the sign of the velocity in the finest of four bands in which that stands above the noise
    of the position; where none does, the last direction holds. It is 0 before the first one.
    """
    h = float(series.t[1] - series.t[0])
    found = np.zeros_like(series.q)
    for f in (2.0 * fc, fc, fc / 2.0, fc / 4.0):
        x = v
        if f < 2.0 * fc and series.velocity is None:
            x = np.gradient(low_pass(h, f).passed(series.q), h)
        noise = sigma * math.sqrt(2.0 * h * (2.0 * math.pi) ** 2 * f**3 / 3.0)
        shown = (found == 0.0) & (np.abs(x) > ABOVE * noise)
        found[shown] = np.sign(x[shown])
        if series.velocity is not None:
            break
    last = np.maximum.accumulate(np.where(found != 0.0, np.arange(len(found)), 0))
    return found[last]


def open_rows(q: Array, direction: Array, reach: float, fc: float, h: float) -> Flags:
    """Return rows (n,) at rest or in a reversal, where a law without memory leaves a force open.

    There the position stays within reach for 1/fc, or the direction changes, or the filter mixes
    the row with such.
    """
    turns = np.concatenate([[False], np.diff(direction) != 0.0])
    mixed = max(int(MIXED / fc / h), 1)
    return near_rest(q, reach, fc, h, mixed) | spread_out(turns, mixed)


def near_rest(q: Array, reach: float, fc: float, h: float, rows: int) -> Flags:
    """Return rows (n,) at which the position stays within reach for 1/fc, or so near such ones."""
    half = max(int(0.5 / fc / h), 2)
    still = maximum_filter1d(q, 2 * half + 1) - minimum_filter1d(q, 2 * half + 1) <= reach
    return spread_out(still, half + rows)


def spread_out(flags: Flags, rows: int) -> Flags:
    """Return flags (n,) that also stand so many rows beside each."""
    found: Flags = maximum_filter1d(flags.astype(np.uint8), 2 * rows + 1) > 0
    return found
