"""Motions along a record: filtered positions and velocities, rests, and noise of the sensor.

Columns of a balance pass the same filter, forward and backward: what it smears at reversals, it
smears in all of them, and no estimate shifts.
"""

import functools
import math

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from stickslip.data import noise_of, step_of, usual_top_speed

Array = NDArray[np.float64]


GAP = 3.0
"""Steps of time longer than this many usual ones are gaps, in which the motion is not known."""
ORDER = 4
"""Order of filters."""


def play(path: Array, reach: float) -> Array:
    """Return positions (n,) that follow a path only where it leaves their reach, as play does.

    Chatter of less than the reach is gone: noise at rest must not relax a bristle.

    Examples
    --------
    >>> play(np.array([0.0, 1.0, 3.0, 2.0, -2.0]), 1.0).tolist()
    [0.0, 0.0, 2.0, 2.0, -1.0]
    """
    at, result = float(path[0]), []
    for x in path.tolist():  # comparisons, as `min` and `max` take thrice as long
        at = x - reach if at < x - reach else x + reach if at > x + reach else at
        result.append(at)
    return np.array(result)


QUIET = 0.005
"""Standard deviation that noise may leave in velocities, over the largest speed. The less they are
smoothed, the less reversals shift."""
BEYOND = 4.0
"""Standard deviations of the noise of positions from which a displacement is one: one in 16,000
samples of normal noise lies beyond."""
FINEST = 1e-5
"""Least displacement over the range of positions that is resolved: what is finer may come from a
filter before the record."""
SLOW = 0.01
"""Share of the largest speed below which a body may be at rest, if positions do not change."""
GLIMPSE = 0.1
"""Share of a row that is seen through the filter and overlooked: of slow samples, in a row that
slips, and of the memory of the filter, a rest."""
LEAK = 1e-3
"""Share of the accelerations' variance that may be noise."""
FEWEST = 5.0
"""The common filter passes at least so many times the mean frequency of the motion."""
PATH = 4.0
"""What a filter of positions passes, over that of what is made of them: it changes nothing that
passes, and leaves out noise that accelerations or bristles would see."""
HARMONICS = 20.0
"""Filters pass at least so many times the mean frequency of a motion, where reversals are seen."""
HIGHEST = 0.2
"""They stay below this share of the sampling frequency."""
LEAST = 30
"""Samples without a gap that are filtered at least."""


def mean_force(force: Array, *, joined: bool) -> Array:
    """Return the mean force (n,) [N] about each sample that second differences of position see.

    These weigh accelerations from one sample before to one after as a triangle: of a force that is
    held, that is half of the one before; of one whose samples are joined, nearly its own.

    Examples
    --------
    >>> mean_force(np.array([0.0, 0.0, 6.0, 6.0]), joined=False)
    array([0., 0., 3., 6.])
    >>> mean_force(np.array([0.0, 0.0, 6.0, 6.0]), joined=True)
    array([0., 1., 5., 6.])
    """
    before = np.concatenate([force[:1], force[:-1]])
    if not joined:
        return np.asarray(0.5 * (before + force))
    after = np.concatenate([force[1:], force[-1:]])
    return np.asarray((before + 4.0 * force + after) / 6.0)


def second_differences(x: Array, dt: float) -> Array:
    """Return accelerations (n,) [m/s^2]; the outer ones are repeated."""
    inner = (x[2:] - 2.0 * x[1:-1] + x[:-2]) / dt**2
    return np.concatenate([inner[:1], inner, inner[-1:]])


def positive_noise(x: Array, time: Array | None = None) -> float:
    """Return the standard deviation of white noise of positions (n,); at least their rounding.

    Between the steps of a coarse encoder most third differences are 0, and so would their median.
    Positions are to be those that were recorded, at their times (n,) if these are uneven: on lines
    between them, there are no steps of an encoder.
    Third differences alone, unlike for the velocities of a force map: the shares of noise that the
    filters leave (`LEAK`, `QUIET`) were chosen with them.
    """
    return max(noise_of(x, step_of(x), time=time), 1e-12 * float(np.ptp(x)), 1e-150)


def mean_frequency(x: Array, noise: float) -> float:
    """Return the mean frequency of a motion (n,) with white noise [rad per sample].

    That of the sine with the same mean squares of position, seen from its mean, and of steps.
    """
    steps = float(np.var(np.diff(x))) - 2.0 * noise**2
    return math.sqrt(max(steps, 0.0)) / max(float(np.std(x)), 1e-300)


def passed_by_balance(x: Array) -> float:
    """Return what the common filter passes along positions (n,), over half their frequency.

    A multiple of the mean frequency of the motion; less where accelerations would be noise, as
    least squares would find too small a mass. White noise s has accelerations of variance
    s^2 w^5 / (5 pi) up to w rad per sample.
    """
    noise, spread = positive_noise(x), float(np.std(x))
    mean = mean_frequency(x, noise)
    share = 5.0 * math.pi * LEAK * (mean**2 * spread / noise) ** 2
    quiet = math.pow(share, 0.2) / math.pi
    least, most = FEWEST * mean / math.pi, HARMONICS * mean / math.pi
    return float(min(max(min(max(quiet, least), most), 2.0 * HARMONICS / len(x)), HIGHEST))


def _passed_of_motion(x: Array, noise: float, least: float) -> float:
    """Return what the filter of the motion passes: as much as the noise of positions allows.

    White noise s has velocities of variance s^2 w^3 / (3 pi) up to w rad per sample.
    """
    speed = usual_top_speed(np.diff(x))
    share = (3.0 * np.pi * (QUIET * speed / noise) ** 2) ** (1.0 / 3.0) / np.pi
    return float(min(max(share, least), PATH * HIGHEST))


def filtered_velocity(raw: Array, dt: float, passed: float, *, tracked: bool) -> Array:
    """Return the velocities (n,) that positions (n,) show, 0 at rest.

    A sample is at rest if it is slow and if positions stay within the sensor's resolution for
    longer than a row overlooks. Presliding is slow, but it goes somewhere: it is motion.
    """
    noise = positive_noise(raw)
    x = smoothed(raw, _passed_of_motion(raw, noise, passed))
    v = np.gradient(x, dt)
    resting = np.abs(v) <= SLOW * usual_top_speed(v)
    if tracked:
        reach = reach_of(raw, noise)
        steps = np.diff(play(raw, reach), prepend=raw[0])
        moved = np.flatnonzero(steps)
        number = np.searchsorted(moved, np.arange(len(raw)), side="right")
        edges = np.concatenate([[-len(raw)], moved, [2 * len(raw)]])
        ways = np.concatenate([[0.0], np.sign(steps[moved]), [0.0]])
        # between two displacements of one direction slow slip has that direction, too
        known = resting & (ways[number] == ways[number + 1])
        v = np.where(known & (ways[number] != 0.0), ways[number] * np.abs(v), v)
        least = max(GLIMPSE / passed, 1.0)
        resting &= edges[number + 1] - edges[number] > least
        resting = _lasting(resting, least)
    return np.where(resting, 0.0, v)


def _lasting(resting: NDArray[np.bool_], least: float) -> NDArray[np.bool_]:
    """Return rests (n,) of more than so many samples: shorter ones are reversals.

    There a body accelerates, while friction at rest is what balances forces without acceleration.
    """
    runs = np.flatnonzero(np.diff(resting, prepend=False, append=False)).reshape(-1, 2)
    result = np.zeros(len(resting), dtype=bool)
    for first, end in runs[runs[:, 1] - runs[:, 0] > least].tolist():
        result[first:end] = True
    return result


def reach_of(position: Array, noise: float) -> float:
    """Return the displacement to either side that positions with noise do not resolve."""
    return max(BEYOND * noise, FINEST * float(np.ptp(position)))


def smoothed(columns: Array, passed: float) -> Array:
    """Return columns (n,) or (n, m) filtered forward and backward, so that nothing is delayed."""
    return np.asarray(sosfiltfilt(_low_pass(passed), columns, axis=0))


@functools.lru_cache(maxsize=64)
def _low_pass(passed: float) -> Array:
    """Return the sections (m, 6) of the filter, whose design takes as long as its use."""
    return np.asarray(butter(ORDER, min(passed, 1.0), output="sos"))
