"""Steady readings of friction that have times: rows of a table, not samples of a motion.

A motion is sampled so often that neighbouring velocities are nearly one, and what a low pass takes
off them is noise. Each steady reading is taken at a speed of its own, which friction follows at
once: a low pass takes off what friction depends on, and slow readings between faster ones vanish.
"""

from typing import Final

import numpy as np

from stickslip.experiments.measurement import Array

FEWEST: Final = 30
"""Rows below which nothing is sampled often enough to be filtered."""
SLOW: Final = 1.0
"""Step of time [s] from which rows, each at another speed, are readings."""
OTHER: Final = 0.01
"""Change of a velocity over its range from which the next one is another ..."""
OFTEN: Final = 0.5
"""... and the share of the rows that are followed by another one."""
LOST: Final = 2.0
"""Scatter of friction about the mean velocity of some rows, over that about its own velocity."""
MEAN: Final = 5
"""Rows of that mean: about what a low pass at a tenth of the sampling frequency takes."""


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
    slow = float(np.median(np.diff(time))) >= SLOW
    if slow and velocity.size < FEWEST:
        return True
    steps = np.abs(np.diff(velocity))
    if float(np.mean(steps > OTHER * extent)) < OFTEN:
        return False
    if slow:
        return True
    if _rms(np.diff(velocity, n=2)) < _rms(steps):
        return False  # a motion goes on from step to step; readings in any order do not
    usual = np.convolve(np.pad(velocity, MEAN // 2, mode="edge"), np.full(MEAN, 1 / MEAN), "valid")
    return _scatter(usual, friction) > LOST * _scatter(velocity, friction)


def _scatter(velocity: Array, friction: Array) -> float:
    """Return how far friction at one velocity is from that at the next, root mean square."""
    return _rms(np.diff(friction[np.argsort(velocity, kind="stable")]))


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
