"""Narrow lines at the frequency of the mains and its harmonics."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from stickslip.experiments.checking.finding import Finding
from stickslip.experiments.measurement import SAMPLED, Array, Measurement
from stickslip.formatting import number, percent, quantity

MAINS: Final = (50.0, 60.0)
"""Frequencies of mains [Hz]."""
ORDERS: Final = (1, 2, 3, 4, 5)
"""Harmonics looked at; a rectifier has its ripple at the second."""
WANDER: Final = 0.2
"""Mains keep to this [Hz] nearly all the time (EN 50160: 0.5 Hz for 99.5 % of a year)."""
BLOCK: Final = 20.0
"""Length of the blocks whose spectra are averaged [s]: mains wander more in longer ones."""
NEAR: Final = 0.15
"""Half width, over its frequency, of the band that a line must stand out of. That of 50 Hz does not
reach 60 Hz, and 45 and 55 Hz, of a motion of 5 Hz with all its harmonics, lie within it."""
STANDS: Final = 8.0
"""A line has so many times the largest power beside it: noise of a few averages stays below."""
BASES: Final = (2, 3, 4, 5)
"""A line is a harmonic of another motion if there is a stronger one at such a part of it."""
LOBE: Final = 3
"""Bins to each side over which the window spreads a line."""
FEWEST: Final = 100
"""Bins below a line at least."""
TOLD: Final = 1e-3
"""Share of the variance from which hum is a warning."""
CURE: Final = (
    "Shield and ground the sensor's cable and record again, or remove the line with a notch filter"
)
"""What is to be done about hum."""


@dataclass(frozen=True, kw_only=True)
class MainsLine:
    """A narrow line of a spectrum."""

    frequency: float
    """Where it is [Hz]."""
    mains: float
    """Frequency of the mains that it belongs to [Hz]."""
    order: int
    """Harmonic of the mains."""
    share: float
    """Share of the variance that it carries."""
    amplitude: float
    """Amplitude, in the unit of the signal."""


def lines_of(values: Array, step: float) -> tuple[MainsLine, ...]:
    """Return the lines of the mains in a signal, the fundamental or its first harmonic first.

    Examples
    --------
    >>> t = np.arange(0.0, 20.0, 1e-3)
    >>> wave = np.sin(2.0 * np.pi * 1.3 * t) + 0.05 * np.sin(2.0 * np.pi * 49.98 * t)
    >>> [(round(line.frequency, 2), round(line.amplitude, 3)) for line in lines_of(wave, 1e-3)]
    [(49.98, 0.05)]
    """
    power, width = _spectrum(values, step)
    variance = float(np.var(values))
    if not variance > 0.0 or not np.isfinite(variance):
        return ()
    found = []
    for mains in MAINS:
        lines: list[MainsLine] = []
        for order in ORDERS:
            near = order * mains
            if order == 1:  # that of a harmonic may be the place of another one
                near = _folded(near, 1.0 / step)
            place = _standing(power, near, width)
            if place is None or (not lines and _is_harmonic(power, place, width)):
                continue
            rows = slice(place - LOBE, place + LOBE + 1)
            share = float(power[rows].sum()) / variance
            center = float(np.average(np.arange(place - 1, place + 2), weights=power[rows][2:5]))
            lines.append(
                MainsLine(
                    frequency=center * width,
                    mains=mains,
                    order=order,
                    share=min(share, 1.0),
                    amplitude=float(np.sqrt(2.0 * min(share, 1.0) * variance)),
                )
            )
        if any(line.order <= 2 for line in lines):
            found.append(tuple(lines))
    return max(found, key=lambda lines: sum(line.share for line in lines), default=())


def is_narrow(values: Array, step: float, frequency: float) -> bool:
    """Whether a signal has a narrow line at a frequency [Hz], of the mains or not.

    Below some 16 periods in a block of 20 s, a line cannot be told from a broader peak.

    Examples
    --------
    >>> t = np.arange(0.0, 20.0, 1e-3)
    >>> noise = np.random.default_rng(0).normal(size=len(t))
    >>> [is_narrow(noise + np.sin(2.0 * np.pi * 37.0 * t), 1e-3, f) for f in (37.0, 50.0)]
    [True, False]
    """
    power, width = _spectrum(values, step)
    return _standing(power, frequency, width) is not None


def _spectrum(values: Array, step: float) -> tuple[Array, float]:
    """Return the power in each bin (m,), averaged over half overlapping blocks, and their width."""
    length = min(len(values), max(round(BLOCK / step), 2))
    starts = range(0, len(values) - length + 1, max(length // 2, 1))
    window = np.hanning(length)
    total = np.zeros(length // 2 + 1)
    ramp = np.linspace(-1.0, 1.0, length)
    for start in starts:
        part = values[start : start + length]
        part = part - part.mean() - ramp * (ramp @ part) / (ramp @ ramp)
        total += np.abs(np.fft.rfft(window * part)) ** 2
    weight = float(window @ window) or 1.0  # a window of two samples has none
    # so that the sum over all bins is the variance (Parseval)
    return 2.0 * total / (len(starts) * length * weight), 1.0 / (length * step)


def _folded(frequency: float, rate: float) -> float:
    """Return where a frequency is seen that is sampled at a rate."""
    folded = frequency % rate
    return min(folded, rate - folded)


def _is_harmonic(power: Array, place: int, width: float) -> bool:
    """Whether a line is a harmonic of a stronger one."""
    bases = (_standing(power, place * width / part, width) for part in BASES)
    return any(base is not None and power[base] > power[place] for base in bases)


def _standing(power: Array, frequency: float, width: float) -> int | None:
    """Return the bin of a line near a frequency that stands out of the band about it."""
    reach = round(WANDER / width) + 1
    middle = round(frequency / width)
    aside = round(NEAR * middle)
    if aside < 2 * (reach + LOBE) or middle + reach + 2 * LOBE >= len(power):
        return None
    place = middle - reach + int(np.argmax(power[middle - reach : middle + reach + 1]))
    beside = np.concatenate(
        [power[middle - aside : place - LOBE], power[place + LOBE + 1 : middle + aside + 1]]
    )
    return place if power[place] > STANDS * float(beside.max()) else None


def words_of(lines: tuple[MainsLine, ...]) -> str:
    """Return lines in words, such as ``"50 Hz, with harmonics at 100 and 150 Hz"``.

    Examples
    --------
    >>> line = MainsLine(frequency=50.01, mains=50.0, order=1, share=0.1, amplitude=1.0)
    >>> words_of((line,))
    '50 Hz'
    """
    first, *rest = lines
    text = f"{number(first.frequency)} Hz"
    if abs(first.frequency - first.order * first.mains) > 2.0 * WANDER:
        text += f" (alias of {number(first.order * first.mains)} Hz)"
    if rest:
        text += f", with harmonics at {', '.join(number(one.frequency) for one in rest)} Hz"
    return text


def hum(record: Measurement) -> Iterator[Finding]:
    """Name lines of the mains in what was sampled."""
    time = np.asarray(record.time)
    step = float(np.median(np.diff(time)))
    count = round(float(time[-1] - time[0]) / step) + 1
    if not FEWEST <= count <= 10 * len(time):  # mostly gaps
        return
    even = time[0] + step * np.arange(count)
    for name in SAMPLED:
        values = getattr(record, name)
        if not isinstance(values, np.ndarray):
            continue
        lines = lines_of(np.interp(even, time, values), step)
        if not lines:
            continue
        share = sum(line.share for line in lines)
        size = quantity(lines[0].amplitude, record.unit(name))
        yield Finding(
            kind="mains hum",
            severity="warning" if share >= TOLD else "info",
            sentence=(
                f"{name.replace('_', ' ').capitalize()} has a narrow spectral line at"
                f" {words_of(lines)}, with an amplitude of {size} and {percent(share)} of the"
                f" variance: mains hum. {CURE}."
            ),
            numbers={
                "frequency": lines[0].frequency,
                "amplitude": lines[0].amplitude,
                "share": share,
            },
        )
