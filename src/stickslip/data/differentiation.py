"""Velocities, accelerations and noise of a record, its parts, and readings that are no motion.

A velocity comes from neighbouring positions, an acceleration from velocities; no difference is
taken across a gap of the times. Steady readings have times too, but are rows of a table: a low
pass, or a difference, means nothing between them.
"""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from stickslip.data.measurement import SAMPLED, Array, Measurement
from stickslip.data.tolerances import (
    DECADE,
    FEW_SAMPLES,
    FEWEST,
    FEWEST_SAMPLES,
    GAP,
    HALF,
    LISTED,
    MOST_ENTRIES,
    MOSTLY,
    NEGLIGIBLE,
    ROUNDED,
)
from stickslip.errors import InputError, check_even_times
from stickslip.show.formatting import joined, number

CUTOFF: Final = 0.1
"""Corner of the low pass over the sampling frequency: 100 Hz where 1 kHz was sampled."""
PADDED: Final = 10.0
"""Periods of the corner frequency by which ends are continued."""
USUAL: Final = 100.0 * (1.0 - ROUNDED)
"""Percentile of speeds that counts as the largest: beyond it are outliers."""
QUARTILE: Final = 0.6745
"""Median size of a normal variable over its standard deviation."""
NEAR_STEPS: Final = 20.0
"""Distances of levels over their step that are looked at first."""
MOST_LEVELS: Final = 2**24
"""Levels that a converter has at most; finer steps are the digits of a number."""


def velocity_of(record: Measurement, *, cutoff: float | None = None) -> Array:
    r"""Return the velocity of a record: as measured, or from its position.

    A position passes a Butterworth filter of order 4 forward and backward, so that nothing is
    delayed, and is then differentiated by central differences. Gaps are not filtered across.

    Parameters
    ----------
    record : Measurement
        A record in time with a velocity or a position.
    cutoff : float, optional
        Corner frequency [Hz] of the filter; a tenth of the sampling frequency if not given. With
        one, a measured velocity is filtered as well.

    Returns
    -------
    array (n,)
        Velocity [m/s] at the times of the record.

    Raises
    ------
    InputError
        If the record has neither.

    Examples
    --------
    >>> t = np.linspace(0.0, 2.0, 2001)
    >>> record = Measurement(time=t, position=0.1 * np.sin(2 * np.pi * t))
    >>> error = velocity_of(record) - 0.2 * np.pi * np.cos(2 * np.pi * t)
    >>> bool(np.abs(error[50:-50]).max() < 1e-4)
    True
    """
    time = _time(record)
    if record.velocity is not None:
        measured = np.asarray(record.values("velocity"))
        return measured if cutoff is None else smooth(time, measured, cutoff)
    position = _position(record, "velocity")
    # Central differences, which are of second order where times are uneven, too.
    return np.gradient(smooth(time, position, cutoff), time)


def acceleration_of(record: Measurement, *, cutoff: float | None = None) -> Array:
    r"""Return the acceleration of a record, from its position or else its velocity.

    Parameters
    ----------
    record : Measurement
        A record in time with a position or a velocity.
    cutoff : float, optional
        As for `velocity_of`.

    Returns
    -------
    array (n,)
        Acceleration [m/s²] at the times of the record.

    Raises
    ------
    InputError
        If the record has neither.

    Examples
    --------
    >>> t = np.linspace(0.0, 2.0, 2001)
    >>> record = Measurement(time=t, velocity=3.0 * t)
    >>> bool(np.allclose(acceleration_of(record), 3.0))
    True
    """
    time = _time(record)
    if record.velocity is not None:
        return np.gradient(smooth(time, np.asarray(record.values("velocity")), cutoff), time)
    filtered = smooth(time, _position(record, "acceleration"), cutoff)
    return np.gradient(np.gradient(filtered, time), time)


def _time(record: Measurement) -> Array:
    if record.trials or record.time is None:
        raise InputError(
            "A velocity needs a single time record: use the entries of Measurement.records() that"
            " have times."
        )
    return record.time


def _position(record: Measurement, what: str) -> Array:
    if record.position is None:
        raise InputError(
            f"The {what} of a record needs its position or velocity, got"
            f" {', '.join(record.quantities())}."
        )
    return np.asarray(record.values("position"))


def interval_of(time: Array) -> float:
    """Return the usual step of time [s].

    Examples
    --------
    >>> interval_of(np.array([0.0, 0.1, 0.2, 0.9]))
    0.1
    """
    return float(np.median(np.diff(time)))


def smooth(time: Array, values: Array, cutoff: float | None = None) -> Array:
    """Return samples through a low pass that delays nothing, piece by piece between gaps.

    Parameters
    ----------
    time, values : array (n,)
        The samples; where they are not evenly spaced, they are taken so by linear interpolation.
    cutoff : float, optional
        Corner frequency [Hz]; a tenth of the sampling frequency if not given.

    Returns
    -------
    array (n,)
        At the same times.

    Raises
    ------
    InputError
        If the corner is not between 0 and half the sampling frequency.

    Examples
    --------
    >>> t = np.arange(500) * 0.01
    >>> bool(np.allclose(smooth(t, 2.0 + t), 2.0 + t))
    True
    """
    from scipy.signal import butter

    dt = interval_of(time)
    corner = CUTOFF if cutoff is None else cutoff * dt
    if not 0 < corner < 0.4999:  # half of it is where the filter has no form
        raise InputError(
            f"The cutoff must lie between 0 and half the sampling frequency, {number(0.5 / dt)}"
            f" Hz, got {cutoff!r}."
        )
    sections = butter(4, 2 * corner, output="sos")
    # A filter would carry what is on one side of a gap to the other.
    cuts = np.flatnonzero(np.diff(time) > GAP * dt) + 1
    if cuts.size > MOST_ENTRIES:  # such a record is more gaps than samples: left as it is
        return values
    result = np.array(values, dtype=float)
    for piece in np.split(np.arange(time.size), cuts):
        if piece.size >= FEW_SAMPLES:
            span = slice(piece[0], piece[-1] + 1)
            result[span] = _low_pass(sections, corner, time[span], result[span])
    return result


def _low_pass(sections: Array, corner: float, time: Array, values: Array) -> Array:
    from scipy.signal import sosfiltfilt

    steps, dt = np.diff(time), interval_of(time)
    # The ends go on as they ran, for so long that the filter has forgotten how it began.
    pad = min(round(PADDED / corner), values.size - 1)
    if np.ptp(steps) < 0.05 * dt:
        return np.asarray(sosfiltfilt(sections, values, padlen=pad), dtype=float)
    count = max(round((time[-1] - time[0]) / dt) + 1, time.size)
    check_even_times(count)
    even = np.linspace(time[0], time[-1], count)
    filtered = sosfiltfilt(sections, np.interp(even, time, values), padlen=pad)
    return np.asarray(np.interp(time, even, filtered), dtype=float)


def step_of(values: Array) -> float:
    """Return the step in which values come, such as that of an encoder, or 0 if there is none.

    Examples
    --------
    >>> step_of(np.round(np.sin(np.arange(100.0)), 2)), step_of(np.sin(np.arange(100.0)))
    (0.01, 0.0)
    """
    # A long record says no more than a part of it, and sorting is what takes time.
    levels = np.unique(values[:200_000])
    if levels.size < 3:
        return 0.0
    apart = np.diff(levels)
    span = float(levels[-1] - levels[0])
    apart = apart[apart > max(span, float(np.abs(levels).max())) * 1e-9]  # the last digits
    if apart.size < 2:
        return 0.0
    # The least of all may be an accident of rounding, and that of nearly all several steps.
    guesses = (float(apart.min()), float(np.quantile(apart, 0.01, method="lower")))
    steps = [_common(levels - levels[0], apart, guess) for guess in guesses]
    step = next((value for value in steps if value and span / value <= MOST_LEVELS), 0.0)
    return float(f"{step:.5g}")


def _common(levels: Array, apart: Array, guess: float) -> float:
    """Return the step of which levels and their distances are multiples, near a guess, or 0."""
    near = apart[apart < NEAR_STEPS * guess]
    step = float(np.sum(near) / np.sum(np.rint(near / guess)))
    if near.size < min(2 * FEWEST_SAMPLES, apart.size) or not _whole(near / step):
        return 0.0
    # Ever farther, as the step is known better: near its peak a sine has levels of whole numbers.
    reach = NEAR_STEPS
    while step * reach < NEAR_STEPS * levels[-1]:
        within = levels[(levels > 0) & (levels < reach * step)]
        if within.size:
            counts = np.sum(np.rint(within / step))
            if counts:  # else all of them lie within half a step
                step = float(np.sum(within) / counts)
            if not _whole(within / step):
                return 0.0
        reach *= NEAR_STEPS
    return step


def _whole(ratio: Array) -> bool:
    """Whether nearly all are whole numbers; of random ones a fifth would seem so."""
    return bool(np.mean(np.abs(ratio - np.rint(ratio)) < 0.1) >= 0.98)


def usual_top_speed(velocity: Array) -> float:
    """Return the speed that all but the fastest 2 % of samples stay below.

    Examples
    --------
    >>> usual_top_speed(np.linspace(-1.0, 1.0, 201)), usual_top_speed(np.array([-0.5, 0.5]))
    (0.98, 0.5)
    """
    return float(np.percentile(np.abs(velocity), USUAL))


def noise_of(values: Array, step: float = 0.0, order: int = 3, time: Array | None = None) -> float:
    """Return the standard deviation of the noise of samples, from what no smooth motion explains.

    Without times, samples are taken as even.

    Examples
    --------
    >>> noise_of(np.arange(10.0)), round(noise_of(np.arange(10.0), step=1.0), 3)
    (0.0, 0.289)
    >>> uneven = np.arange(100.0) + 0.25 * (np.arange(100) % 2)
    >>> noise_of(uneven**2, time=uneven) < 1e-9 < noise_of(uneven**2)
    True
    """
    if time is None:
        growth = math.sqrt(math.comb(2 * order, order))  # of white noise: its weights are binomials
        differences = np.diff(values, order) / growth
    else:
        differences = unit_differences(values, time, order)
    middle = float(np.median(np.abs(differences))) if differences.size else 0.0
    spread = middle / QUARTILE
    rounding = 1e-15 * float(np.abs(values).max())  # what differences of floats leave
    return max(spread if spread > 20 * rounding else 0.0, step / float(np.sqrt(12.0)))


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
    # Row i holds for each difference the sample i places on.
    columns = [np.arange(i, max(len(values) - order, 0) + i) for i in range(order + 1)]
    weights = np.ones((order + 1, len(columns[0])))
    for i, j in itertools.permutations(range(order + 1), 2):
        # Weights of Newton's divided differences, one over the product of all other distances.
        weights[i] /= time[columns[i]] - time[columns[j]]
    # The sum of squares of the weights is the variance that white noise has in the difference.
    weights /= np.linalg.norm(weights, axis=0)
    return np.asarray(
        np.sum([w * values[rows] for w, rows in zip(weights, columns, strict=True)], axis=0)
    )


# Parts of a record: some of its rows, or what lies between its gaps.


def rows_of(record: Measurement, first: int, end: int) -> Measurement:
    """Return the rows of a record in time from one on, up to another that is left out.

    Examples
    --------
    >>> record = Measurement(time=[0.0, 1.0, 2.0], position=[5.0, 6.0, 7.0], load=9.0)
    >>> part = rows_of(record, 1, 3)
    >>> part.time.tolist(), part.position.tolist(), part.load
    ([1.0, 2.0], [6.0, 7.0], 9.0)
    """
    rows = slice(first, end)
    columns = {
        name: getattr(record, name)[rows]
        for name in ("time", *SAMPLED)
        if isinstance(getattr(record, name), np.ndarray)
    }
    inputs, doubts = (
        {name: x[rows] if isinstance(x, np.ndarray) else x for name, x in held.items()}
        for held in (record.inputs, record.uncertainty)
    )
    joints = {name: rows_of(joint, first, end) for name, joint in record.joints.items()}
    return replace(record, **columns, inputs=inputs, uncertainty=doubts, joints=joints)


def between_gaps(record: Measurement) -> tuple[Measurement, ...]:
    """Return the parts of a record in time between steps over three times the usual one.

    Examples
    --------
    >>> record = Measurement(time=[0.0, 1.0, 2.0, 9.0, 10.0, 11.0], position=[0, 1, 2, 9, 10, 11])
    >>> [part.time.tolist() for part in between_gaps(record)]
    [[0.0, 1.0, 2.0], [9.0, 10.0, 11.0]]
    """
    time = np.asarray(record.time)
    cuts = np.flatnonzero(np.diff(time) > GAP * interval_of(time)) + 1
    if not cuts.size:
        return (record,)
    edges = [0, *cuts.tolist(), time.size]
    # One row alone has no step of time, and is no record.
    return tuple(rows_of(record, a, b) for a, b in pairwise(edges) if b - a > 1)


# Steady readings of friction that have times: rows of a table, not samples of a motion.
#
# A motion is sampled so often that neighbouring velocities are nearly one, and what a low pass
# takes off them is noise. Each steady reading is taken at a speed of its own, which friction
# follows at once: a low pass takes off what friction depends on, and slow readings between faster
# ones vanish.

FEWEST_READINGS: Final = 2 * FEW_SAMPLES
"""Rows without a gap between them below which nothing is sampled often enough to be filtered."""
TABLE: Final = {"velocity", "friction", "load", "force"}
"""What rows of a table have; beside anything else they are samples of a motion."""
READING_INTERVAL: Final = 1.0
"""Step of time [s] from which rows, each at another speed, are readings."""
SCATTER_RATIO: Final = 2.0
"""Scatter of friction about the mean velocity of some rows, over that about its own velocity."""
MEAN_ROWS: Final = round(0.5 / CUTOFF)
"""Rows of that mean: about what a low pass at a tenth of the sampling frequency takes."""


def as_readings(measurement: Measurement) -> Measurement:
    """Return steady readings that have times as a table in their order; all else as it is.

    Examples
    --------
    >>> v = np.tile([0.1, 0.2, 0.4], 20)
    >>> as_readings(Measurement(time=6.0 * np.arange(60), velocity=v, friction=2.0 + v)).kind
    'friction-map'
    """
    records = measurement.records()
    if not all(map(_are_readings, records)):
        return measurement
    tables = tuple(replace(record, time=None, force=None) for record in records)
    return replace(measurement, trials=tables) if measurement.trials else tables[0]


def _are_readings(record: Measurement) -> bool:
    time, velocity, friction = record.time, record.velocity, record.friction
    if time is None or not {*record.quantities()} <= TABLE:
        return False
    if not isinstance(velocity, np.ndarray) or not isinstance(friction, np.ndarray):
        return False
    return are_steady_readings(time, velocity, friction)


def are_steady_readings(time: Array, velocity: Array, friction: Array) -> bool:
    """Return whether rows are steady readings of friction, and no samples of a motion.

    Examples
    --------
    >>> t = 6.0 * np.arange(60)
    >>> v = 1.0 + np.sin(np.arange(60.0) ** 2)
    >>> are_steady_readings(t, v, 2.0 + v)
    True
    >>> fast = np.sin(t / 20.0)  # of large steps and reversals, but one after the other
    >>> are_steady_readings(t / 600.0, fast, np.sign(fast))
    False
    """
    extent = float(np.ptp(velocity))
    if extent == 0.0:
        return False
    slow = interval_of(time) >= READING_INTERVAL
    gaps = np.flatnonzero(np.diff(time) > GAP * interval_of(time))
    if slow and np.diff([-1, *gaps, time.size - 1]).max() < FEWEST_READINGS:
        return True
    steps = np.abs(np.diff(velocity))
    if float(np.mean(steps > NEGLIGIBLE * extent)) < HALF:
        return False
    if slow:
        return True
    if _rms(np.diff(velocity, n=2)) < _rms(steps):
        return False  # a motion goes on from step to step; readings in any order do not
    usual = np.convolve(
        np.pad(velocity, MEAN_ROWS // 2, mode="edge"), np.full(MEAN_ROWS, 1 / MEAN_ROWS), "valid"
    )
    return _scatter(usual, friction) > SCATTER_RATIO * _scatter(velocity, friction)


def _scatter(velocity: Array, friction: Array) -> float:
    """Return how far friction at one velocity is from that at the next, root mean square."""
    return _rms(np.diff(friction[np.argsort(velocity, kind="stable")]))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))


# Single samples far off those beside, as a dropped reading is: checks name them, fits go on.
#
# A step is none, as the median of five samples follows it, nor is the turn of a swing, beside which
# samples differ as much. What is more frequent belongs to the signal.

BESIDE: Final = 2 * MEAN_ROWS - 1
"""Samples about it of which the change counts."""
OUT: Final = 1.25
"""Least distance of an outlier beside a step from both of its sides, over its height ..."""
SHARES: Final = {"position": 0.005, "velocity": 0.005, "force": 0.5, "friction": 0.5}
"""... and over the range. What has mass moves smoothly; a force that is commanded may have peaks.
"""
ROUNDS: Final = 200
"""Most rounds in which outliers are looked for, each beside what the one before left."""
REPLACED: Final = "Straight lines between the samples beside stand in their place."
"""What becomes of outliers of a record of one coordinate."""


def outlier_sentence(column: str, times: Sequence[float]) -> str:
    """Return which samples of a column lie far off those beside them.

    Examples
    --------
    >>> outlier_sentence("velocity", [25.7, 80.1])
    '2 samples of the velocity lie far off those beside, at 25.7 and 80.1 s.'
    """
    count, said = len(times), [number(time, 6) for time in times[:LISTED]]
    what = f"{count} samples of the {column} lie" if count > 1 else f"1 sample of the {column} lies"
    where = f"the first at {joined(said)}" if count > LISTED else f"at {joined(said)}"
    return f"{what} far off those beside, {where} s."


def without_outliers(
    measurement: Measurement,
) -> tuple[Measurement, Mapping[str, tuple[float, ...]]]:
    """Return a measurement with single samples far off those beside on lines between these.

    And their times [s] by column, of all records; none of records without times.

    Examples
    --------
    >>> t = np.arange(0.0, 10.0, 0.02)
    >>> x, u = np.sin(t), np.cos(t)
    >>> u[100] += 5.0
    >>> _, times = without_outliers(Measurement(time=t, position=x, force=u))
    >>> dict(times)
    {'force': (2.0,)}
    """
    result: dict[str, tuple[float, ...]] = {}
    records = tuple(_without(record, result) for record in measurement.records())
    if result:
        measurement = replace(measurement, trials=records) if measurement.trials else records[0]
    return measurement, result


def _without(record: Measurement, found: dict[str, tuple[float, ...]]) -> Measurement:
    """Return a record without outliers, whose times are added to those found."""
    if record.time is None or record.time.size < FEW_SAMPLES:
        return record
    columns: dict[str, Any] = {}
    for name in SHARES.keys() & {*record.quantities()}:
        x = raw = np.asarray(getattr(record, name), dtype=float)
        for _ in range(ROUNDS):
            far = far_off(x, name)
            if not far.any():
                break
            x = np.where(far, np.interp(record.time, record.time[~far], x[~far]), x)
        if x is not raw:
            columns[name] = x
            found[name] = (*found.get(name, ()), *record.time[x != raw].tolist())
    return replace(record, **columns) if columns else record


def far_off(x: Array, column: str) -> NDArray[np.bool_]:
    """Return which samples (n,) of a column, single or in pairs, lie far off those beside them.

    A value beyond both sides of a step is one where other steps have none. A body at rest may slip
    within a sample: there, only a speed beyond those of a motion is no speed.

    Examples
    --------
    >>> x = np.sin(0.01 * np.arange(500.0))
    >>> x[[100, 300, 301]] += 3.0
    >>> np.flatnonzero(far_off(x, "position")).tolist()
    [100, 300, 301]
    """
    # Imported here, as what has no times needs no filter.
    from scipy.ndimage import label, maximum_filter1d, median_filter, minimum_filter1d

    middle = median_filter(x, 5)
    for end in (middle, middle[::-1]):  # which goes on there as it ran beside
        end[:2] = end[2] + (end[2] - end[4]) * np.array([1.0, 0.5])
    apart = np.abs(x - middle)
    steps = np.abs(np.diff(x))
    usual = float(np.median(steps[steps > 0.0])) if steps.any() else 0.0
    beside = maximum_filter1d(np.abs(np.diff(middle, append=middle[-1])), BESIDE)
    least = max(
        DECADE * float(np.quantile(apart, 0.9)),
        SHARES[column] * float(np.ptp(middle)),
        GAP * usual,
    )
    top, bottom = maximum_filter1d(middle, BESIDE), minimum_filter1d(middle, BESIDE)
    lone = (apart > least) & (np.maximum(x - top, bottom - x) > OUT * beside)
    if lone.any():
        steps = label(beside >= 0.5 * beside[lone].min())[1]
        lone &= label(lone)[1] <= (1.0 - MOSTLY) * steps
    far: NDArray[np.bool_] = lone | ((apart > least) & (apart > GAP * beside))
    for end, off, at in ((x, apart, far), (x[::-1], apart[::-1], far[::-1])):
        # A motion may turn there, as fast as it moves beside.
        at[:2] &= off[:2] > DECADE * max(least, float(np.max(np.abs(np.diff(end[3 : 3 + BESIDE])))))
    if column == "velocity":
        fastest = usual_top_speed(middle)
        moves = fastest > least
        far &= (np.abs(middle) > least) | (moves & (np.abs(x) > OUT * fastest))
    return far if far.sum() <= max(NEGLIGIBLE * x.size, FEWEST) else np.zeros(x.size, dtype=bool)
