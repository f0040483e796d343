"""States of bristles, plays and free loads along a measured path, exact in every step."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.linalg.blas import dtbsv

Array = NDArray[np.float64]
Shape = tuple[float, ...]

SIGN: Shape = (0.0, 0.0)
"""The shape without memory: the state is the direction."""
LEAST_LEFT = 1e-12
"""Way to the full state below which a bristle of an exponent above 1 counts as there."""


def bristle_states(path: Array, shapes: Sequence[Shape], start: float) -> Array:
    """Return Dahl states in [-1, 1] along a path (n,) for shapes (length, exponent): (n, k).

    The exponent 0 is the elasto-plastic stop. Between two reversals the state follows from the way
    since the first of them in closed form, so that the loop runs over reversals only.

    Examples
    --------
    >>> z = bristle_states(np.array([0.0, 1.0, 2.0, 1.5]), [(1.0, 1.0), (1.0, 0.0)], 0.0)
    >>> [round(float(one), 4) for one in z[:, 0]], z[:, 1].tolist()
    ([0.0, 0.6321, 0.8647, 0.131], [0.0, 1.0, 1.0, 0.5])
    """
    steps = np.diff(path, prepend=path[0])
    ways, first = _runs(steps)
    covered = np.cumsum(np.abs(steps))
    before = covered[np.maximum(first - 1, 0)]
    ends = covered[np.append(first[1:], len(path)) - 1] - before
    run = np.cumsum(np.bincount(first[1:], minlength=len(path)))
    since = (covered - before[run])[:, None]
    found = np.empty((len(path), len(shapes)))
    for n in {shape[1] for shape in shapes}:
        own = [i for i, shape in enumerate(shapes) if shape[1] == n]
        length = np.array([shapes[i][0] for i in own])
        left = np.empty((len(first), len(own)))
        state = np.full(len(own), float(start))
        for i, (way, end) in enumerate(zip(ways.tolist(), ends.tolist(), strict=True)):
            left[i] = 1.0 - way * state
            state = way * (1.0 - _left(left[i], end / length, n))
        found[:, own] = ways[run, None] * (1.0 - _left(left[run], since / length, n))
    return found


def _runs(steps: Array) -> tuple[Array, NDArray[np.intp]]:
    """Return directions (r,) of the runs between reversals, and where each begins (r,)."""
    moved = np.flatnonzero(steps)
    if not moved.size:
        return np.ones(1), np.zeros(1, dtype=np.intp)
    signs = np.sign(steps[moved])
    turns = np.flatnonzero(np.diff(signs)) + 1
    return signs[np.append(0, turns)], np.append(0, moved[turns])


def _left(left: Array, way: Array, n: float) -> Array:
    """Return what is left of 1 after a way over the length, with d left = -left^n d way."""
    if n < 1e-6:
        return np.maximum(left - way, 0.0)
    if abs(n - 1.0) < 1e-6:
        return left * np.exp(-way)
    power = np.maximum(left, LEAST_LEFT) ** (1.0 - n) - (1.0 - n) * way
    found: Array = np.where(power > 0.0, np.maximum(power, 1e-300) ** (1.0 / (1.0 - n)), 0.0)
    return found


def lugre_states(path: Array, velocity: Array, shapes: Sequence[Shape], start: float) -> Array:
    """Return LuGre states along a path (n,) for shapes (length, 1, v_s, rho, delta): (n, k).

    At constant speed the state is g = 1 + rho exp(-(|v| / v_s)^delta). Each step is an affine map
    of the state, so that all of them are one triangular system with a band of two.
    """
    steps, speed = np.diff(path), np.abs(velocity[1:])
    ways, sizes = np.sign(steps), np.abs(steps)
    found = np.empty((len(shapes), len(path)))
    band = np.ones((2, len(path)), order="F")
    for states, (length, _, v_s, rho, delta) in zip(found, shapes, strict=True):
        level = 1.0 + rho * np.exp(-((speed / v_s) ** delta))
        kept = np.exp(-sizes / (length * level))
        band[1, :-1] = -kept
        states[0] = start
        states[1:] = ways * level * (1.0 - kept)
        states[:] = dtbsv(1, band, states, lower=1, diag=1)
    return found.T


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


def free_load(
    path: Array, velocity: Array, h: float, gap: float, frequency: float, damping: float = 0.1
) -> Array:
    """Return the acceleration (n,) of an inertia that a motion drives through a gap and a spring.

    The frequency [Hz] is that of the inertia on the spring, at most 0.12 of the sampling rate,
    where explicit steps are stable.
    """
    omega = 2.0 * math.pi * min(frequency, 0.12 / h)
    stiffness, resistance, half = omega * omega, 2.0 * damping * omega, 0.5 * gap
    x, v, found = float(path[0]), float(velocity[0]), []
    for q, u in zip(path.tolist(), velocity.tolist(), strict=True):
        d = q - x
        a = 0.0
        if d > half:
            a = stiffness * (d - half) + resistance * (u - v)
        elif d < -half:
            a = stiffness * (d + half) + resistance * (u - v)
        v += h * a
        x += h * v
        found.append(a)
    return np.array(found)
