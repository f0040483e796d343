"""Readings that are expected to reduce the width of the quantities of interest most.

Draws of the posterior say what is asked, and what would be read at each place that is offered: a
reading, a stretch, a motion or a record. Both have a mean and a covariance over the draws, and a
linear Gaussian update says what is left of what is asked.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri, ndtr

from stickslip.identify.bands import LEVEL
from stickslip.identify.posterior import Array

HALF = 0.3
"""Expected width over today's at which enough is measured: less than half is, mostly."""
WORTH = 0.95
"""Expected width over today's from which no readings are proposed."""
MOST, COUNTED, HALVED = 60, 300, 0.38
"""Readings that are proposed at most: no more than were taken, and than anybody takes; and those
up to which it is counted how many halve the band, which are those to an expected width a little
below: what comes scatters about it (to .45, 5 of 11 tables in doubt came below .5; to .38, 5 of 5
others)."""
DIRECTIONS = 6
"""Directions in which the rows of a record differ most, which are seen of it."""
AGAIN = 8
"""Further records or motions of which it is told what they leave."""
RESOLVED, SQUARES = 400, 9
"""Places at which a distribution is resolved, and differences of runs over which is averaged."""


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """Readings to take."""

    places: tuple[int, ...]
    """Offered places, in the order of their gain; one may stand for several readings."""
    shrinks: float
    """Expected width of the band after them, over today's; above 1 it gets wider."""
    halves: int | None = None
    """Readings, chosen so, by which the band is expected to halve; None if too many."""
    least: float = 0.0
    """Expected width after as many readings as are counted, over today's."""
    widths: tuple[float, ...] = ()
    """Expected widths after the first, the second ... of as many as may be taken, over today's."""


def within_band(curves: Array) -> Array:
    """Return drawn curves (d, n) within their 95 % band at each place.

    A rare one that is far off, such as a large drift, is much of the variance and nothing of the
    width.
    """
    return np.asarray(np.clip(curves, *np.quantile(curves, (0.025, 0.975), axis=0)))


def propose(
    asked: Array,
    offered: Array,
    noise: Array | float,
    taken: int = 16,
    rest: Array | float = 0.0,
    enough: float = HALF,
    shared: Array | float = 0.0,
    going: Callable[[int], Array | float] = lambda _: 0.0,
) -> Proposal:
    r"""Return the readings that narrow the band of curves at asked places (d, n).

    At each of the offered places (d, m), or (d, m, r), one or r numbers would be read. The draws
    have a mean and a covariance :math:`K` over all of them. Reading place :math:`j` with noise
    :math:`S_j` takes :math:`K_{ij} (K_{jj} + S_j)^{-1} K_{ji}` off the variance at place :math:`i`
    (linear Gaussian update); the place that takes off most of the mean variance is taken, and the
    next one after the update, until the expected width is `enough`; of 0, as many as may be taken
    are, however little they gain. Of a known law as many
    readings as were taken leave 1/sqrt(2) of the width, however they are chosen: it is counted how
    many halve it. `noise` are standard deviations (m,) or (m, r), and `rest` is the variance (n,)
    that no reading takes off, such as that from run to run. Errors of readings that repeats do not
    take off have the covariance `shared` (m r, m r): the block of a place, the run of all places.
    What changes on while so many readings are made, as by a drift, adds a variance `going` (n,).
    (Measured: the widest place shrinks the width to .71; rehearsing draws as truths gained nothing
    over it, and neither do places that separate the named law from the next one: either leaves one
    law in 2 of 7 tables, the second with a band 1.2 times as wide.)

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> level, slope = rng.normal(size=(2, 400, 1))
    >>> v = np.array([[0.0, 0.5, 1.0]])
    >>> propose(level + 5.0 * slope * v, level + 5.0 * slope * v, np.full(3, 0.1)).places[0]
    2
    >>> propose(level, level, np.ones(1), taken=1).halves  # 1 / (1 + 6) of the variance
    6
    >>> twice = np.repeat(level[:, None], 2, axis=2)  # a place where it is read twice
    >>> propose(level, twice, 1.0, taken=1).halves
    3
    >>> propose(level, level, 0.1, shared=np.ones((1, 1))).shrinks > 0.7  # repeats of one block
    True
    """
    count, (draws, places) = asked.shape[1], offered.shape[:2]
    curves = np.hstack([asked, offered.reshape(draws, -1)])
    curves = curves - curves.mean(axis=0)
    covariance = curves.T @ curves / draws
    covariance[count:, count:] += shared
    # of what is asked the variance is all that counts
    variance, covariance = np.diag(covariance)[:count].copy(), covariance[count:].copy()
    numbers = np.arange(len(covariance)).reshape(places, -1)
    errors = np.broadcast_to(np.reshape(noise, (-1, 1)) if np.ndim(noise) == 1 else noise,
                             numbers.shape)  # fmt: skip
    scatter = errors[:, :, None] ** 2 * np.eye(numbers.shape[1]) + 1e-300 * np.eye(numbers.shape[1])

    def width() -> float:
        """Return the mean standard deviation at the asked places."""
        return float(np.mean(np.sqrt(np.maximum(variance, 0.0) + rest + going(len(chosen)))))

    chosen, shrinks = list[int](), [1.0]
    start = width()
    if not start:
        return Proposal(places=(), shrinks=1.0, widths=(1.0,))
    while len(chosen) < max(COUNTED, taken):
        if shrinks[-1] <= (enough if len(chosen) < taken else HALVED):
            break
        own = covariance[numbers[:, :, None], count + numbers[:, None, :]] + scatter
        cross = covariance[numbers, :count]
        read = np.linalg.solve(own, cross) if numbers.shape[1] > 1 else cross / own
        best = int(np.argmax(np.einsum("jri,jri->j", cross, read)))
        rows = covariance[numbers[best]]
        less = np.linalg.solve(own[best], rows)
        variance -= np.sum(rows[:, :count] * less[:, :count], axis=0)
        covariance -= rows[:, count:].T @ less
        chosen.append(best)
        shrinks.append(width() / start)
    some = min(taken, len(chosen))
    widths = tuple(shrinks[1 : some + 1])
    if enough and shrinks[some] >= WORTH:
        return Proposal(places=(), shrinks=max(1.0, shrinks[some]), widths=widths)
    halves = next((k for k, x in enumerate(shrinks) if x <= HALVED), None)
    return Proposal(
        places=tuple(chosen[:some]),
        shrinks=shrinks[some],
        halves=halves,
        least=shrinks[-1],
        widths=widths,
    )


def rehearsed(
    laws: Sequence[tuple[float, Array, Array]],
    errors: Array,
    rest: tuple[Array, Array],
    doubt: float,
    odds: float,
) -> tuple[Array, NDArray[np.bool_]]:
    r"""Return widths (k,) to which readings may come, and whether they leave one law (k,).

    Of each law there is its mass, and what is asked (d, n) and read (d, m) in its draws; the last
    stands for all that is no law. Readings are drawn from one of them with `errors`, a covariance
    (m, m), and update each as in `propose`: its mass by their density, which has a mean and a
    covariance. One law is left at `odds` over each other. Where the logarithm of the noise is known
    to a deviation, it comes out off by the `doubt` that readings take off that. `rest` as there,
    before and after them.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> near, far, none = (x + rng.normal(size=(300, 1)) for x in (0.0, 20.0, 9.0))
    >>> laws = [(0.5, near, near), (0.5, far, far), (0.0, none, none)]
    >>> widths, alone = rehearsed(laws, np.eye(1), (np.zeros(1),) * 2, 0.0, 100.0)
    >>> round(float(np.median(widths)), 2), float(np.mean(alone))  # sqrt(1/2) over sqrt(101)
    (0.07, 1.0)
    """
    rng, mass = np.random.default_rng(5), np.array([item[0] for item in laws])
    mass[-1] += not mass.any()  # no law of those that are compared
    mass /= mass.sum()
    truths = rng.choice(len(laws), COUNTED, p=mass)
    drawn = np.array([laws[k][2][rng.integers(len(laws[k][2]))] for k in truths])
    read = drawn + rng.multivariate_normal(np.zeros(len(errors)), errors, COUNTED)
    logs, known = list[Array](), list[tuple[Array, Array, Array, Array]]()
    for share, x, y in laws:
        n, middle, off = x.shape[1], x.mean(axis=0), read - y.mean(axis=0)
        covariance = np.cov(np.hstack([x, y]).T)
        own, cross = covariance[n:, n:].reshape(len(errors), -1) + errors, covariance[n:, :n]
        less, before = np.linalg.solve(own, cross), np.diag(covariance)[:n]
        score = np.sum(off * np.linalg.solve(own, off.T).T, axis=1) + np.linalg.slogdet(own)[1]
        logs.append(math.log(share + 1e-300) - 0.5 * score)
        after = np.maximum(before - np.sum(cross * less, axis=0), 0.0)
        known.append((middle[None], before[None], middle + off @ less, after[None]))
    weights = np.exp(np.array(logs) - np.max(logs, axis=0))
    weights /= weights.sum(axis=0)

    def width(shares: Array, middles: Array, own: Array, rest: Array) -> Array:
        """Return the mean standard deviation (k,) of what is asked, over several laws."""
        middle = np.einsum("lk,lkn->kn", shares, middles)
        spread = np.einsum("lk,lkn->kn", shares, own + (middles - middle) ** 2)
        return np.asarray(np.mean(np.sqrt(spread + rest), axis=1))

    first, spread, then, left = (np.array(item) for item in zip(*known, strict=True))
    widths = width(weights, then, left, rest[1]) / width(mass[:, None], first, spread, rest[0])
    ordered = np.sort(np.vstack([np.zeros((2, COUNTED)), weights[:-1]]), axis=0)
    alone = np.asarray((ordered[-1] >= odds * ordered[-2]) & (ordered[-1] > 0.0))
    return widths * np.exp(doubt * rng.normal(size=COUNTED)), alone


def width_after(points: Array, seen: Sequence[Array], shares: Sequence[float]) -> float:
    """Return the expected width of what is asked after a record is made, over today's.

    Asked is which of several laws, with probabilities in proportion to `shares`, holds or, of one
    alone, its parameters in draws (k, p). In draws of each law the record shows rows (k, r), over
    their noise and with it: what is seen are the `DIRECTIONS` in which they differ most, and their
    squares, as laws may differ by the scatter of what they show.

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> a, b = rng.normal(size=(2, 400, 1))
    >>> round(width_after(a, [a + b], [1.0]), 1)  # sqrt(1/2)
    0.7
    >>> width_after(a, [a, b + 9.0], [0.5, 0.5]) < 0.3  # rows tell the laws apart
    True
    """
    top = max(shares)
    pairs = zip(seen, shares, strict=True)
    seen = [x[:: max(round(top / share), 1)] for x, share in pairs if share > 0.0]
    rows = np.concatenate(seen)
    law = np.repeat(np.arange(len(seen)), [len(item) for item in seen])
    asked = points if len(seen) == 1 else (law[:, None] == np.arange(1, len(seen))).astype(float)
    rows = rows - rows.mean(axis=0)
    if rows.shape[1] > DIRECTIONS:
        rows = rows @ np.linalg.svd(rows, full_matrices=False)[2][:DIRECTIONS].T
    rows = np.hstack([rows, rows**2])
    scale = rows.std(axis=0)
    rows = rows[:, scale > 0.0] / scale[scale > 0.0]
    known = asked.std(axis=0)
    asked = asked[:, known > 0.0] / known[known > 0.0]
    if not asked.size or not rows.size:
        return 1.0
    width = propose(asked, rows[:, None], 1e-4, taken=1).widths[0]
    # rows that tell nothing reduce the variance in few draws by their number over that of draws
    by_chance = max(1.0 - rows.shape[1] / (len(rows) - 1), 0.1)
    return min(width / math.sqrt(by_chance), 1.0)


def widths_of_another(
    sizes: Sequence[float], shares: Sequence[float], known: float, runs: int
) -> tuple[float, ...]:
    r"""Return expected widths of what another run shows after one, two ... more, over today's.

    Runs differ by a deviation of one of some `sizes` (k,), with their probabilities `shares` (k,);
    their mean is `known` to a deviation from as many `runs` as were made. The squared differences
    of level and slope among :math:`m` more runs are a multiple of :math:`\chi^2_{2m}`, which says
    which deviation holds.

    Examples
    --------
    >>> after = widths_of_another((0.005, 0.08), (0.5, 0.5), 0.0, 1)
    >>> after[1] < after[0] < 0.8
    True
    >>> round(widths_of_another((0.02,), (1.0,), 0.0, 1)[3], 2)  # nothing is to be learned
    1.0
    """
    p = np.array(shares)
    s, p = np.array(sizes)[p > 0.0], p[p > 0.0]

    def width(weights: Array, count: int) -> float:
        """Return the end of the interval of a sum of normal distributions."""
        each = np.sqrt(s**2 + known**2 * runs / count)
        x = np.linspace(0.0, 4.0 * each.max(), RESOLVED)
        inside = (2.0 * ndtr(x[:, None] / np.maximum(each, 1e-300)) - 1.0) @ weights
        return float(np.interp(LEVEL, inside, x))

    today, result = width(p, runs), []
    for more in range(1, AGAIN + 1):
        free, total = 2 * more, 0.0
        squares = chdtri(free, (np.arange(SQUARES) + 0.5) / SQUARES)
        for size, share in zip(s, p, strict=True):
            for square in size**2 * squares:
                log = np.log(p) - free * np.log(s) - 0.5 * square / s**2
                weights = np.exp(log - log.max())
                total += share / SQUARES * width(weights / weights.sum(), runs + more)
        result.append(float(total / today))
    return tuple(result)
