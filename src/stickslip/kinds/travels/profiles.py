"""Ends of intervals: a value followed away from the best one, with the others beside it."""

from collections.abc import Callable
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]

ROUNDS = 30
"""Steps of a walk, at most."""
FAR, LARGE = 64.0, 3.0
"""Way of a walk over the interval that slopes at its start give, and over the value there, from
which on it ends nowhere."""
FIRST = 0.4
"""First step over that interval."""
FLAT, STEEP = 0.15, 0.6
"""Rise of a step, in standard deviations over those at the end, below which the next one is longer,
and above which it is shorter."""
NEAR = 1.25
"""Height beyond the end, of which 1 is the height, from which the end is interpolated."""
HALVINGS = 6
"""Times that a step is halved before what it leads to counts as a jump."""
CLOSER = 2
"""Times that a point is tried where the end is expected: else it would depend on the steps of the
walk, which rounding may change."""


def profile_ends(
    descend: Callable[[Array, NDArray[np.bool_]], tuple[Array, Array]],
    starts: Array,
    at: NDArray[np.int_],
    along: Array,
    *,
    low: Array,
    high: Array,
    least: float,
    target: float,
    again: Callable[[Array], Array],
) -> tuple[Array, Array, Array]:
    """Return two points (k, p) around the end of each of k walks, and the end's share of the way.

    A walk goes from `starts` in the direction of `along`, by steps of one unknown each, `at`. The
    others follow by a descent that begins on the line through the last two points: where valleys
    bend, what slopes say at the best point leads out of them. A walk that meets a bound ends there,
    with two equal points, and one that goes on for ever at an infinite second point. `again` gives
    further points (m, p) from which a descent is tried where one has ended beyond the target.

    Examples
    --------
    The profile of x of the cost x^2 + 100 (y - x^2)^2 is x^2:

    >>> def descend(points, moving):
    ...     points = np.where(moving, points[:, :1] ** 2, points)
    ...     return points, points[:, 0] ** 2 + 100.0 * (points[:, 1] - points[:, 0] ** 2) ** 2
    >>> inside, outside, share = profile_ends(
    ...     descend,
    ...     np.zeros((1, 2)),
    ...     np.array([0]),
    ...     np.array([[1.0, 0.0]]),
    ...     low=np.full(2, -9.0),
    ...     high=np.full(2, 9.0),
    ...     least=0.0,
    ...     target=4.0,
    ...     again=lambda point: point[None],
    ... )
    >>> (inside + share[:, None] * (outside - inside))[0, 0].round(3).item()
    2.0
    """
    count = len(starts)
    inside, outside, step = starts.copy(), starts.copy(), FIRST * along
    height, beyond, share = np.zeros(count), np.full(count, np.inf), np.zeros(count)
    halved = np.zeros(count, dtype=int)
    moving = np.arange(starts.shape[1]) != at[:, None]
    live = np.ones(count, dtype=bool)
    for _ in range(ROUNDS):
        walks = np.flatnonzero(live)
        there = np.clip(inside[walks] + step[walks], low, high)
        goes = there[np.arange(len(walks)), at[walks]] != inside[walks, at[walks]]
        outside[walks[~goes]] = inside[walks[~goes]]
        live[walks[~goes]] = False
        walks, there = walks[goes], there[goes]
        if not len(walks):
            break
        found, costs = descend(there, moving[walks])
        for i in np.flatnonzero(costs > target):
            plain = inside[walks[i]].copy()
            plain[at[walks[i]]] = there[i, at[walks[i]]]
            rows = again(plain)
            rows[:, at[walks[i]]] = plain[at[walks[i]]]  # the value that is followed is held
            rows = np.unique(rows, axis=0)
            others, those = descend(rows, np.repeat(moving[walks[i]][None], len(rows), axis=0))
            if those.min() < costs[i]:
                found[i], costs[i] = others[np.argmin(those)], those.min()
        heights = np.sqrt(np.maximum(costs - least, 0.0) / (target - least))
        for walk, point, reached in zip(walks.tolist(), found, heights.tolist(), strict=True):
            if reached > 1.0:
                if reached <= NEAR or halved[walk] >= HALVINGS:
                    outside[walk], beyond[walk], live[walk] = point, reached, False
                else:
                    step[walk] *= 0.5
                    halved[walk] += 1
                continue
            rise = reached - height[walk]
            longer = 2.0 if rise < FLAT and not halved[walk] else 0.5 if rise > STEEP else 1.0
            step[walk] = longer * (point - inside[walk])
            inside[walk], outside[walk], height[walk] = point, point, reached
            way = abs(point[at[walk]] - starts[walk, at[walk]])
            size = LARGE * abs(starts[walk, at[walk]])
            if way > max(FAR * abs(along[walk, at[walk]]), size):
                break_off = np.copysign(np.inf, along[walk, at[walk]])
                outside[walk, at[walk]], share[walk], live[walk] = break_off, 1.0, False
    met = np.isfinite(beyond)
    share[met] = (1.0 - height[met]) / (beyond[met] - height[met])
    for _ in range(CLOSER):
        walks = np.flatnonzero(beyond <= NEAR)
        if not len(walks):
            break
        way = outside[walks] - inside[walks]
        found, costs = descend(inside[walks] + share[walks, None] * way, moving[walks])
        reached = np.sqrt(np.maximum(costs - least, 0.0) / (target - least))
        short, far = reached <= 1.0, (reached > 1.0) & (reached <= NEAR)
        inside[walks[short]], height[walks[short]] = found[short], reached[short]
        outside[walks[far]], beyond[walks[far]] = found[far], reached[far]
        share[walks] = (1.0 - height[walks]) / (beyond[walks] - height[walks])
    return inside, outside, share
