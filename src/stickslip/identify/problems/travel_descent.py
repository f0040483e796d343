"""Least squares from many starting points at once: what all of them need is one ensemble."""

import math
from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]

STEP = 1e-4
"""Step of finite differences over the size of an unknown: runs with bristles are exact to 1e-8, and
the error of a one-sided difference is then about as small as it can be."""
FIRST, EASED, STIFFENED, MOST = 1e-3, 0.1, 10.0, 1e6
"""Damping of a first step, its factors after a step that is kept and one that is not, and the
damping at which a descent ends."""
LONGEST = 1.0
"""Longest step over the size of an unknown."""
DONE = 1e-9
"""Step over the size of each unknown below which a descent ends."""
WORTH = 1e-4
"""Share of the cost, which is chi-square, that a step takes off at least if descents go on."""


def descended(
    residuals: Callable[[Array], Array],
    starts: Array,
    *,
    low: Array,
    high: Array,
    sizes: Array,
    moving: NDArray[np.bool_],
    steps: int,
) -> tuple[Array, Array]:
    """Return where damped Gauss-Newton descents from k starts end, and their costs.

    `moving` tells which unknowns move, of all starts (p,) or of each (k, p).

    Examples
    --------
    >>> ends, costs = descended(
    ...     lambda x: x**2 - 2.0,
    ...     np.array([[1.0], [-1.0]]),
    ...     low=np.array([-9.0]),
    ...     high=np.array([9.0]),
    ...     sizes=np.array([0.1]),
    ...     moving=np.array([True]),
    ...     steps=20,
    ... )
    >>> ends.round(6).tolist()
    [[1.414214], [-1.414214]]
    """
    found = np.array(starts, dtype=float)
    left = residuals(found)
    costs = np.sum(left**2, axis=1)
    moving = np.broadcast_to(moving, found.shape)
    damping = np.full(len(found), FIRST)
    slopes = np.zeros((*left.shape, found.shape[1]))
    stale = np.ones(len(found), dtype=bool)
    live = np.isfinite(costs) & moving.any(axis=1)
    for _ in range(steps):
        if not live.any():
            break
        at = np.flatnonzero(live & stale)
        if len(at):
            slopes[at] = slopes_of(residuals, found[at], left[at], low=low, high=high,
                                   sizes=sizes, moving=moving[at])  # fmt: skip
            stale[at] = False
        at = np.flatnonzero(live)
        size = np.maximum(np.abs(found[at]), sizes)
        step = size * _steps(slopes[at] * size[:, None, :], left[at], damping[at], found[at], low,
                             high, moving[at])  # fmt: skip
        there = np.clip(found[at] + step, low, high)
        moved = np.max(np.abs(there - found[at]) / size, axis=1)
        left_there = residuals(there)
        cost = np.sum(left_there**2, axis=1)
        better = cost < costs[at]
        kept = at[better]
        gain = costs[kept] - cost[better]
        done = (moved[better] < DONE) | (gain <= WORTH * costs[kept])
        found[kept], left[kept], costs[kept] = there[better], left_there[better], cost[better]
        stale[kept] = True
        damping[kept] *= EASED
        damping[at[~better]] *= STIFFENED
        live[kept[done]] = False
        live[at[~better & (moved < DONE)]] = False
        live &= damping < MOST
    return found, costs


def slopes_of(
    residuals: Callable[[Array], Array],
    points: Array,
    left: Array,
    *,
    low: Array,
    high: Array,
    sizes: Array,
    moving: NDArray[np.bool_],
) -> Array:
    """Return derivatives of residuals (k, n, p) at points (k, p), by one-sided differences."""
    found = np.zeros((*left.shape, points.shape[1]))
    steps = STEP * np.maximum(np.abs(points), sizes)
    steps = np.where(points + steps <= high, steps, np.where(points - steps >= low, -steps, 0.0))
    columns, rows = np.nonzero(np.broadcast_to(moving, points.shape).T)
    shifted = points[rows]
    step = steps[rows, columns]
    shifted[np.arange(len(rows)), columns] += step
    there = residuals(shifted) - left[rows]
    found[rows, :, columns] = there / np.where(step == 0.0, math.inf, step)[:, None]
    return found


def _steps(
    slopes: Array,
    left: Array,
    damping: Array,
    points: Array,
    low: Array,
    high: Array,
    moving: NDArray[np.bool_],
) -> Array:
    """Return damped steps (k, p) over sizes; 0 for what is held or would leave its bounds."""
    slopes = np.where(np.isfinite(slopes), slopes, 0.0)
    downhill = -np.einsum("kni,kn->ki", slopes, left)
    held = (points <= low) & (downhill < 0.0) | (points >= high) & (downhill > 0.0) | ~moving
    slopes = np.where(held[:, None, :], 0.0, slopes)
    downhill = np.where(held, 0.0, downhill)
    normal = np.einsum("kni,knj->kij", slopes, slopes)
    diagonal = np.einsum("kii->ki", normal)
    scale = np.where(diagonal > 0.0, diagonal, 1.0)
    # what hardly matters is held back by what matters: else it would leap
    least = 1e-9 * np.max(diagonal, axis=1, keepdims=True)
    added = damping[:, None] * scale + least + np.where(diagonal > 0.0, 0.0, 1.0)
    solved = np.linalg.solve(normal + added[:, :, None] * np.eye(len(low)), downhill[:, :, None])
    steps: Array = solved[:, :, 0]
    longest = np.max(np.abs(steps), axis=1, keepdims=True)
    shorter: Array = steps * np.minimum(1.0, LONGEST / np.maximum(longest, 1e-300))
    return shorter
