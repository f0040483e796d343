"""The motion of a load point as few pieces of constant speed."""

import math
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.identify import THRESHOLDS

Array: TypeAlias = NDArray[np.float64]

STRETCHES = 1000
"""Samples, or means over stretches, that a record is looked at by."""
CANDIDATES = 30
"""Places of a change that are tried, and tried again around the best."""
CHANGE = math.log(1.1)
"""Speeds that differ by less are one speed; friction depends on their logarithm."""
JERK = 0.1
"""A piece is a jerk if it lasts less than this share of both pieces beside it, and moves the load
point by less than this share of the longer one."""
STRAIGHT = 3e-4
"""A path is followed to this share of it, in the mean; speeds below this share of the largest are
those of a load point that stands."""
SHORTEST = 10
"""Samples that show a piece, or how friction settles, at least."""
DEEPEST = 5
"""At most 2^DEEPEST pieces: a path that swings is searched for half a minute instead of a second
without this limit."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Path:
    """Pieces of constant speed."""

    time: Array
    """Times at which the speed changes, with both ends (k,) [s]."""
    position: Array
    """Positions there (k,) [m]."""

    @property
    def speeds(self) -> Array:
        """Speed of each piece (k - 1,) [m/s]."""
        return np.diff(self.position) / np.diff(self.time)

    @property
    def steps(self) -> Array:
        """Times at which the speed changes for long (m,) [s]; a jerk between is no step."""
        return np.array([self.time[last + 1] for _, last in self._kept[:-1]])

    @property
    def lasting(self) -> Array:
        """Speeds before, between and after the steps (m + 1,) [m/s]."""
        return self.speeds[[longest for longest, _ in self._kept]]

    @property
    def segments(self) -> Array:
        """The steps with both ends of the path (m + 2,) [s]."""
        return np.array([self.time[0], *self.steps, self.time[-1]])

    @property
    def places(self) -> Array:
        """Positions at the steps (m,) [m]."""
        return np.interp(self.steps, self.time, self.position)

    @property
    def _kept(self) -> list[tuple[int, int]]:
        """Return the longest and the last piece of each stretch of one speed, jerks left out."""
        lengths, ways = np.diff(self.time), np.abs(np.diff(self.position))
        kept = list(range(len(lengths)))
        for piece in np.argsort(lengths).tolist():
            at = kept.index(piece)
            beside = [kept[i] for i in (at - 1, at + 1) if 0 <= i < len(kept)]
            brief = beside and lengths[piece] < JERK * lengths[beside].min()
            if brief and ways[piece] < JERK * ways[beside].max():
                del kept[at]
        result: list[tuple[int, int]] = []
        for piece in kept:
            if result and not differ(*np.abs(self.speeds[[result[-1][0], piece]])):
                result[-1] = max(result[-1][0], piece, key=lengths.__getitem__), piece
            else:
                result.append((piece, piece))
        return result


def path_of(time: Array, pull: Array) -> Path:
    """Return the pieces of constant speed that a measured position consists of.

    Examples
    --------
    >>> t = np.linspace(0.0, 20.0, 401)
    >>> path = path_of(t, np.where(t < 8.0, t, 8.0 + 10.0 * (t - 8.0)))
    >>> path.time.round(3), path.speeds.round(3)
    (array([ 0.,  8., 20.]), array([ 1., 10.]))
    """
    from scipy.stats import chi2

    every = max(1, len(time) // STRETCHES)
    t, x = time[::every], pull[::every]
    scatter = _scatter(t, x) if len(x) > SHORTEST else 0.0
    # what a bend takes off the squares of noise by chance, wherever it is best: place and slope
    sure = float(chi2.isf(THRESHOLDS.pattern_chance / len(t), 2))
    changes = _changes(t, x, max(STRAIGHT * float(np.ptp(x)), scatter), sure, DEEPEST)
    while changes:
        changes = _together(t, x, _sharpened(t, x, changes))
        weakest = _weakest(t, x, changes, sure * scatter**2)
        if weakest is None:
            break
        del changes[weakest]
    return Path(
        time=np.array([time[0], *changes, time[-1]]), position=_positions(time, pull, changes)
    )


def _scatter(t: Array, x: Array) -> float:
    """Return the standard deviation of single positions about straight lines beside them."""
    from scipy.stats import median_abs_deviation

    share = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
    off = x[1:-1] - (1.0 - share) * x[:-2] - share * x[2:]
    single = off / np.sqrt(1.0 + share**2 + (1.0 - share) ** 2)
    return float(median_abs_deviation(single, scale="normal"))


def _weakest(t: Array, x: Array, changes: list[float], least: float) -> int | None:
    """Return which change is none: of a piece of no length or of one speed, or within the scatter.

    A load point that stands has a speed of rounding errors, which are no ratio of speeds.
    """
    whole = _squares(t, x, changes)
    gains = [_squares(t, x, changes[:i] + changes[i + 1 :]) - whole for i in range(len(changes))]
    lengths = _lengths(t, changes)
    held = np.diff(np.searchsorted(t, [t[0], *changes, t[-1]]))
    if held.min() <= 1:  # between two samples any path will do
        short = int(held.argmin())
        ends = [i for i in (short - 1, short) if 0 <= i < len(changes)]
        return min(ends, key=gains.__getitem__)
    speeds = np.abs(np.diff(_positions(t, x, changes)) / lengths)
    speeds = np.maximum(speeds, STRAIGHT * max(float(speeds.max()), 1e-300))
    ratios = np.abs(np.diff(np.log(speeds)))
    if ratios.min() < CHANGE:
        return int(ratios.argmin())
    return int(np.argmin(gains)) if min(gains) < least else None


def _lengths(t: Array, changes: list[float]) -> Array:
    return np.diff([t[0], *changes, t[-1]])


def _table(t: Array, changes: list[float]) -> Array:
    """Return the columns of a path that bends at given times (n, 2 + changes)."""
    bends = np.maximum(t[:, None] - np.array([t[0], *changes]), 0.0)
    return np.column_stack([np.ones_like(t), bends])


def _squares(t: Array, x: Array, changes: list[float]) -> float:
    table = _table(t, changes)
    left = x - table @ np.linalg.lstsq(table, x, rcond=None)[0]
    return float(left @ left)


def _positions(t: Array, x: Array, changes: list[float]) -> Array:
    """Return the positions of the closest path at its ends and changes."""
    numbers = np.linalg.lstsq(_table(t, changes), x, rcond=None)[0]
    steps = np.cumsum(numbers[1:]) * _lengths(t, changes)
    return np.array(numbers[0] + np.concatenate([[0.0], np.cumsum(steps)]))


def _best(t: Array, x: Array, low: float, high: float, others: list[float]) -> float:
    """Return the time between two others at which one more bend helps most."""
    known = np.linalg.qr(_table(t, others))[0]
    left = x - known @ (known.T @ x)
    least = 1e-20 * float(t @ t) + 1e-300  # where there is a bend already
    for _ in range(5):
        tried = np.linspace(low, high, CANDIDATES + 2)[1:-1]
        bends = np.maximum(t[:, None] - tried, 0.0)
        bends -= known @ (known.T @ bends)
        gains = (left @ bends) ** 2 / np.maximum(np.sum(bends**2, axis=0), least)
        best = float(tried[np.argmax(gains)])
        width = 2.0 * (high - low) / CANDIDATES
        low, high = max(low, best - width), min(high, best + width)
    return best


def _sharpened(t: Array, x: Array, changes: list[float]) -> list[float]:
    """Return changes each moved to where it helps most between its neighbours."""
    for i in range(len(changes)):
        others = changes[:i] + changes[i + 1 :]
        before, after = ([t[0], *others][i], [*others, t[-1]][i])
        changes = sorted([*others, _best(t, x, before, after, others)])
    return changes


def _together(t: Array, x: Array, changes: list[float]) -> list[float]:
    """Return changes moved all at once: both ends of a jerk, one by one, are caught in a valley."""
    from scipy.optimize import least_squares

    def left(tried: Array) -> Array:
        table = _table(t, np.sort(tried).tolist())
        return np.asarray(x - table @ np.linalg.lstsq(table, x, rcond=None)[0])

    size = max(float(np.ptp(x)), 1e-300)
    result = least_squares(
        lambda tried: left(tried) / size,
        changes,
        bounds=(t[0], t[-1]),
        x_scale=float(np.ptp(t)) / len(t),
        diff_step=1e-6,
    )
    moved = np.sort(result.x).tolist()
    return moved if _squares(t, x, moved) < _squares(t, x, changes) else changes


def differ(one: float, other: float) -> bool:
    """Whether two speeds count as two; one far below the other is that of a load point at rest."""
    least = max(STRAIGHT * max(one, other), 1e-300)
    return bool(abs(math.log(max(one, least) / max(other, least))) >= CHANGE)


def _changes(t: Array, x: Array, scatter: float, sure: float, depth: int) -> list[float]:
    """Return the times in a stretch at which it has to bend to be straight between them."""
    if depth == 0 or len(t) <= 2 * SHORTEST:
        return []
    if _squares(t, x, []) <= (len(t) + sure) * scatter**2:
        return []
    best = _best(t, x, float(t[SHORTEST]), float(t[-SHORTEST]), [])
    early = t <= best
    return [
        *_changes(t[early], x[early], scatter, sure, depth - 1),
        best,
        *_changes(t[~early], x[~early], scatter, sure, depth - 1),
    ]
