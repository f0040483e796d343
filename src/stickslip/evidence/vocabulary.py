"""The candidates of a search: terms and bristle shapes, with nonlinear parameters on grids."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, median_filter

from stickslip.contact_inputs import DRIVES
from stickslip.evidence.balance import Balance
from stickslip.evidence.bristles import Shape
from stickslip.evidence.fits import Fit
from stickslip.evidence.structure import GROWN
from stickslip.evidence.terms import Term
from stickslip.evidence.values import SLOW

Array = NDArray[np.float64]

LAWS = ("level", "offset", "viscous", "viscous_dir", "quadratic")
"""Kinds of laws without a nonlinear parameter."""
DRIFTS = ("spring", "drift", "offset_drift", "viscous_drift")
"""Faults without a nonlinear parameter."""
EXPONENTS = (0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.5)
"""Exponents of viscous powers."""
STRIBECK_EXPONENTS = (1.0, 2.0)
LIMITS = (0.8, 0.85, 0.9, 0.94, 0.97, 0.985, 0.995)
"""Quantiles of the force at which an amplifier may saturate, where few peaks are the largest."""
BEYOND = tuple(0.7 * 0.87**k for k in range(21))
"""Shares of the largest force that may lie beyond the limit. What is beyond the nearest of these is
within a tenth of what is beyond the true one: its coefficient is 1 within the limits of its kind.
"""
LOAD_FREQUENCIES = (20.0, 40.0)
"""Frequencies [Hz] at which a load bounces on a gap."""
LAGS = (0.004, 0.006, 0.008, 0.012, 0.016, 0.025)
"""Time constants [s] of a filter through which a sensor shows friction."""
DELAYS = (0.001, 0.002, 0.003, 0.004, 0.006, 0.008, 0.012, 0.016, 0.025, 0.04)
"""Delays [s] of the force channel; negative ones are those of the position."""
LAST_DELAYS = (0.003, 0.006, 0.012, 0.02, 0.035)
"""Delays [s] at the end of the record of a force channel whose clock drifts."""
SHAPE_EXPONENTS = (0.0, 0.5, 1.0, 2.0)
"""Exponents of Dahl; 0 is the elasto-plastic stop."""
LUGRE_STEPS = (0.25, 0.7, 1.6)
"""Stribeck steps of LuGre over its level."""
LEAST_PERIODS = {"ripple": 2.0, "level_ripple": 1.0, "imbalance": 2.0}
"""Least periods in the range of the position: a force of longer waves is like a spring ..."""
MOST_PERIODS = 60.0
"""... and most."""
CELLS = 2048
"""Cells of the range of the position over which residuals are summed for their harmonics."""
FINE = 0.4
"""Step of the wave number times the range of the position."""
LEAST_HUM = 1.0
"""Least frequency [Hz] of a ripple in time."""
LINE = 30.0
"""Power of a line in a spectrum over the median of what is beside it."""
BESIDE = 40
"""Frequencies on either side with which a line is compared."""


def grid(low: float, high: float, count: int) -> list[float]:
    """Return values over decades; none if there is no room.

    Examples
    --------
    >>> grid(1.0, 100.0, 3), grid(2.0, 1.0, 3)
    ([1.0, 10.0, 100.0], [])
    """
    if not 0.0 < low < high:
        return []
    return [float(f"{x:.4g}") for x in np.geomspace(low, high, count)]


def vocabulary(balance: Balance, *, faults: bool = True) -> list[Term]:
    """Return every candidate term of every channel."""
    found = [
        term
        for channel in balance.channels
        for term in _of_channel(balance, channel, faults=faults and balance.dynamic)
    ]
    if faults and balance.dynamic and not balance.free:
        found += [Term("delay", (sign * x,), "*") for x in DELAYS for sign in (1.0, -1.0)]
        rates = [float(f"{x / balance.length:.4g}") for x in LAST_DELAYS]
        found += [Term("skew", (sign * x,), "*") for x in rates for sign in (1.0, -1.0)]
        if not any(one.driven for one in balance.parts):
            found += [Term("lag", (x,), "*") for x in LAGS]
    return found


def _of_channel(balance: Balance, channel: str, *, faults: bool) -> Iterator[Term]:
    """Yield the candidates of a channel."""
    part, top = balance.of(channel)[0], balance.speed[channel]
    for kind in LAWS:
        yield Term(kind, (), channel)
    if balance.dynamic:
        yield Term("level_slope", (), channel)
        yield Term("level_dir", (), channel)
        yield Term("damping", (), channel)
    for exponent in EXPONENTS:
        yield Term("power", (exponent,), channel)
        yield Term("power_dir", (exponent,), channel)
    speeds = grid(top / 300.0, SLOW * top, 12)
    steps = [(v_s, delta) for v_s in speeds for delta in STRIBECK_EXPONENTS]
    for kind in ("stribeck", "stribeck_dir"):
        yield from (Term(kind, par, channel) for par in steps)
    for name in part.covariates:
        if name == "load":
            yield Term("load", (), channel, name)
        elif name in DRIVES:
            kinds = ("motor_weight",) if name == "motor" else ("weight", "weight2")
            yield from (Term(kind, (), channel, name) for kind in kinds)
        else:
            yield Term("temperature", (), channel, name)
            yield from (Term(kind, (), channel, name) for kind in GROWN)
    if faults:
        yield from _faults(balance, channel)


def _faults(balance: Balance, channel: str) -> Iterator[Term]:
    """Yield candidates that accuse the rig; those of a drive only where an inertia is moved."""
    own = balance.of(channel)
    for kind in DRIFTS:
        # of a free motion, inertia and springs are known in proportion to each other only
        if kind != "spring" or not (balance.free and own[0].inertia):
            yield Term(kind, (), channel)
    if not own[0].driven:
        return
    if own[0].mass is not None and not own[0].extra:  # columns of the mechanism hold it
        yield Term("mass", (), channel)
    if balance.free:
        return
    yield from saturations(balance, channel)
    least, most = 3.0 * balance.resolved[channel], balance.span[channel] / 8.0
    for gap in grid(least, most, 10):
        yield Term("backlash", (gap,), channel)
    for gap in grid(least, most, 12):
        for frequency in LOAD_FREQUENCIES:
            yield Term("loose", (gap, frequency), channel)
    for frequency in grid(3.0, min(80.0, 2.0 * balance.fc), 30):
        yield Term("flexible", (frequency,), channel)


def saturations(balance: Balance, channel: str) -> Iterator[Term]:
    """Yield limits of the force that an amplifier may have."""
    force = np.concatenate([np.abs(one.raw) for one in balance.of(channel)])
    limits = np.concatenate([np.quantile(force, LIMITS), (1.0 - np.array(BEYOND)) * force.max()])
    for limit in dict.fromkeys(float(f"{x:.3g}") for x in limits):
        if limit >= balance.least_limit[channel] > 0.0:
            yield Term("saturation", (limit,), channel)


def shapes(balance: Balance, channel: str) -> list[Shape]:
    """Return the bristle shapes of a channel; none in a table."""
    if not balance.dynamic:
        return []
    resolved, span, top = balance.resolved[channel], balance.span[channel], balance.speed[channel]
    found: list[Shape] = [
        (length, n) for n in SHAPE_EXPONENTS for length in grid(2.0 * resolved, span / 3.0, 12)
    ]
    found += [
        (length, 1.0, v_s, rho, 1.0)
        for length in grid(2.0 * resolved, span / 10.0, 9)
        for v_s in grid(top / 100.0, top / 2.0, 5)
        for rho in LUGRE_STEPS
    ]
    return found


def ripples(balance: Balance, found: Fit, top: int = 2) -> list[Term]:
    """Return ripples at the wave numbers where the residual of a fit has its largest harmonics.

    Of each channel, in the force, in the level, and in a force that grows with the speed squared.
    """
    if not balance.dynamic:
        return []
    terms = []
    for channel in balance.channels:
        own = balance.of(channel)
        rows = balance.use & ~balance.at_rest & balance.own[channel]
        picked = rows[balance.own[channel]]
        q = np.concatenate([one.q[:: one.every] for one in own])[picked]
        span = float(np.ptp(q)) if q.size else 0.0
        if span <= 0.0:
            continue
        shape = found.structure.shape(channel)
        state = np.concatenate([one.state(shape)[:: one.every] for one in own])[picked]
        squared = np.concatenate([one.v[:: one.every] for one in own])[picked] ** 2
        left = found.residual[rows]
        cell = np.minimum((q - q.min()) / span * CELLS, CELLS - 1).astype(int)
        size = round(2.0 * math.pi * CELLS / FINE)
        most = round(2.0 * math.pi * MOST_PERIODS / FINE)
        seen = {"ripple": left, "level_ripple": left * state, "imbalance": left * squared}
        for kind, periods in LEAST_PERIODS.items():
            least = round(2.0 * math.pi * periods / FINE)
            along = np.bincount(cell, seen[kind], minlength=CELLS)
            power = np.abs(np.fft.rfft(along, size))[least:most]
            peaks = np.flatnonzero((power[1:-1] > power[:-2]) & (power[1:-1] > power[2:])) + 1
            largest = peaks[np.argsort(-power[peaks])[:top]]
            waves = (least + largest) * FINE / span
            terms += [Term(kind, (float(f"{wave:.4g}"),), channel) for wave in waves]
    return terms


def hums(balance: Balance, found: Fit, top: int = 2) -> list[Term]:
    """Return ripples in time at the frequencies of the largest lines of a fit's residual.

    A line that direction or speed has as well is of the motion, and so is one of a known force:
    what an error of the mechanism leaves has the lines of all joints.
    """
    if not balance.dynamic or balance.free:
        return []
    terms = []
    for channel in balance.channels:
        part = max(balance.of(channel), key=lambda one: one.count)
        used = (balance.use & ~balance.at_rest)[part.rows]
        step = part.h * part.every
        window = used * np.hanning(part.count)
        signals = [
            found.residual[part.rows],
            *(
                x[:: part.every]
                for x in (np.sign(part.v), np.abs(part.v), part.taken, *part.extra.values())
            ),
        ]
        f = np.fft.rfftfreq(4 * part.count, step)
        lines = []
        for x in signals:
            centred = window * (x - np.average(x, weights=window + 1e-300))
            power = np.abs(np.fft.rfft(centred, len(f) * 2 - 2)) ** 2
            usual = median_filter(power, 8 * BESIDE + 1, mode="nearest")
            lines.append(power / np.maximum(usual, 1e-12 * max(power.max(), 1e-300)))
        left, *motion = lines
        wide = maximum_filter1d(np.max(motion, axis=0), 17)
        peaks = np.flatnonzero((left[1:-1] > left[:-2]) & (left[1:-1] > left[2:])) + 1
        peaks = peaks[
            (left[peaks] > np.maximum(LINE, wide[peaks]))
            & (f[peaks] > LEAST_HUM)
            & (f[peaks] < balance.fc)
        ]
        largest = peaks[np.argsort(-left[peaks])[:top]]
        terms += [Term("hum", (float(f"{x:.6g}"),), channel) for x in f[largest]]
    return terms
