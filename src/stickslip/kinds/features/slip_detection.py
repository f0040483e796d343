"""Slips, cycles and spectra of the force of a spring that pulls a slider."""

from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]

CERTAIN = 6.0
"""A fall counts if it stands out of the scatter of falls by so many of its standard deviations."""
LARGE = 0.25
"""And if it is this share of the median fall: smaller ones are creep."""
FINE = 8
"""Spectra are padded with zeros to so many times their length."""
SWING = 0.5
"""A cycle goes from so many standard deviations below the mean to as many above it."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Slips:
    """Slips of a record, one entry each."""

    place: NDArray[np.intp]
    """Sample in the middle of each slip (n,)."""
    level: Array
    """Highest force before each (n,)."""
    drop: Array
    """How far the force falls (n,)."""
    slope: Array
    """Slope of the force between slips (n - 1,), by sample."""


def slips_of(force: Array, half_period: int) -> Slips:
    """Return the slips of a force sampled evenly, each lasting about half a natural period.

    Examples
    --------
    >>> saw = np.tile(np.linspace(0.0, 1.0, 100), 5)
    >>> found = slips_of(saw, 3)
    >>> len(found.place), found.slope.round(4)
    (4, array([0.0101, 0.0101, 0.0101]))
    """
    from scipy.ndimage import uniform_filter1d
    from scipy.signal import find_peaks

    n = max(half_period, 1)
    smooth = uniform_filter1d(force, max(n // 2, 1))
    fall = np.zeros_like(force)
    fall[n:-n] = smooth[: -2 * n] - smooth[2 * n :]
    lag = max(n // 2, 1)
    rises = smooth[lag:] - smooth[:-lag]
    rise = float(np.median(rises))  # while it sticks, which is most of the time
    scatter = 1.4826 * float(np.median(np.abs(rises - rise)))
    usual = -rise * 2 * n / lag
    height = usual + CERTAIN * scatter + 1e-9 * float(np.ptp(force))
    place, _ = find_peaks(fall, height=height, distance=2 * n)
    if len(place):
        place = place[fall[place] >= LARGE * np.median(fall[place])]
    level = np.array([smooth[max(i - 3 * n, 0) : i + 1].max() for i in place])
    low = np.array([smooth[i : i + 3 * n].min() for i in place])
    spans = [(i + 2 * n, j - n) for i, j in pairwise(place)]
    slopes = [np.polyfit(np.arange(j - i), force[i:j], 1)[0] for i, j in spans if j - i > n]
    return Slips(place=place, level=level, drop=level - low, slope=np.array(slopes))


def cycles_of(force: Array, period: float) -> NDArray[np.intp]:
    """Return where the cycles of a force (n,) begin: where it has come from low to high.

    What changes over two periods or more does not count.

    Examples
    --------
    >>> wave = np.sin(2.0 * np.pi * np.arange(1000.0) / 40.0) + np.linspace(0.0, 3.0, 1000)
    >>> np.unique(np.diff(cycles_of(wave, 40.0)[2:-2])).tolist()
    [40]
    """
    from scipy.ndimage import uniform_filter1d

    fast = force - uniform_filter1d(force, max(round(2.0 * period), 1))
    limit = SWING * float(fast.std())
    outside = np.flatnonzero(np.abs(fast) > limit)
    high = fast[outside] > 0.0
    return np.asarray(outside[1:][high[1:] & ~high[:-1]], dtype=np.intp)


def spectra_of(force: Array, blocks: int, highest: float = 0.5) -> tuple[Array, Array]:
    """Return frequencies by sample (m,) and the spectra of half overlapping blocks (k, m)."""
    from scipy.fft import next_fast_len, rfft

    length = 2 * len(force) // (blocks + 1)
    starts = np.linspace(0, len(force) - length, blocks).astype(int)
    window = np.hanning(length)
    ramp = np.linspace(-1.0, 1.0, length)
    padded = next_fast_len(FINE * length, real=True)
    frequency = np.fft.rfftfreq(padded)
    kept = frequency <= highest
    spectra = []
    for start in starts:
        part = force[start : start + length]
        part = part - part.mean() - ramp * (ramp @ part) / (ramp @ ramp)
        spectra.append(np.abs(rfft(window * part, padded)[kept]) ** 2)
    return np.asarray(frequency[kept], dtype=float), np.array(spectra)


def peak_of(frequency: Array, spectrum: Array) -> float:
    """Return the frequency that carries most, counted by octaves: slow wandering does not.

    Examples
    --------
    >>> t = np.arange(4000.0)
    >>> frequency, spectra = spectra_of(np.sin(2.0 * np.pi * 0.0437 * t) + 1e-3 * t, 8)
    >>> round(peak_of(frequency, spectra.mean(axis=0)), 4)
    0.0437
    """
    carried = frequency * spectrum
    i = int(np.argmax(carried[1:-1])) + 1
    while 0 < i < len(spectrum) - 1 and spectrum[i] < max(spectrum[i - 1], spectrum[i + 1]):
        nearest = i + (1 if spectrum[i + 1] > spectrum[i - 1] else -1)
        if abs(frequency[nearest] - frequency[int(np.argmax(carried))]) > 0.1 * frequency[i]:
            break  # counting by octaves moves a line by far less: this is the slope of another one
        i = nearest
    i = min(max(i, 1), len(spectrum) - 2)
    before, here, after = np.log(np.maximum(spectrum[i - 1 : i + 2], 1e-300))
    bend = before - 2.0 * here + after
    # more than half a bin is no top of a peak, but the end of what was looked at
    shift = min(max(0.5 * (before - after) / bend, -0.5), 0.5) if bend < 0.0 else 0.0
    return float(frequency[i] + shift * (frequency[1] - frequency[0]))
