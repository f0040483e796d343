"""What to measure next: readings that are expected to narrow the band most, in closed form."""

from dataclasses import dataclass

import numpy as np

from stickslip.identify.posterior import Array

HALF = 0.3
"""Expected width over today's at which enough is measured: less than half is, mostly."""
WORTH = 0.95
"""Expected width over today's from which no readings are proposed."""
MOST, COUNTED, HALVED = 60, 150, 0.45
"""Readings that are proposed at most: no more than were taken, and than anybody takes; and those
up to which it is counted how many halve the band, which are those to an expected width a little
below: what comes scatters about it."""


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """Readings to take."""

    places: tuple[int, ...]
    """Offered places, in the order of their gain; one may stand for several readings."""
    shrinks: float
    """Expected width of the band after them, over today's."""
    halves: int | None = None
    """Readings, chosen so, by which the band is expected to halve; None if too many."""


def within_band(curves: Array) -> Array:
    """Return drawn curves (d, n) within their 95 % band at each place.

    A rare one that is far off, such as a large drift, is much of the variance and nothing of the
    width.
    """
    return np.asarray(np.clip(curves, *np.quantile(curves, (0.025, 0.975), axis=0)))


def propose(
    asked: Array, offered: Array, noise: Array, taken: int = 16, rest: Array | float = 0.0
) -> Proposal:
    r"""Return the readings that narrow the band of curves at asked places (d, n).

    The drawn curves have a mean and a covariance :math:`K` over asked and offered places. A reading
    at place :math:`j` with noise :math:`s_j` takes off :math:`K_{ij}^2 / (K_{jj} + s_j^2)` of the
    variance at place :math:`i` (linear Gaussian update); the place that takes off most of the mean
    variance is taken, and the next one after the update, until the expected width is `HALF` of
    today's. Of a known law as many readings as were taken leave 1/sqrt(2) of the width, however
    they are chosen: it is counted how many halve it. `rest` is the variance (n,) that no reading
    takes off, such as that from run to run.
    (Measured: the widest place shrinks the width to .71; rehearsing draws as truths gained nothing
    over it.)

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> level, slope = rng.normal(size=(2, 400, 1))
    >>> v = np.array([[0.0, 0.5, 1.0]])
    >>> propose(level + 5.0 * slope * v, level + 5.0 * slope * v, np.full(3, 0.1)).places[0]
    2
    >>> propose(level, level, np.ones(1), taken=1).halves  # 1 / (1 + 4) of the variance
    4
    """
    curves = np.hstack([asked, offered])
    curves = curves - curves.mean(axis=0)
    covariance = curves.T @ curves / len(curves)
    count = asked.shape[1]

    def width() -> float:
        """Return the mean standard deviation at the asked places."""
        return float(np.mean(np.sqrt(np.maximum(np.diag(covariance)[:count], 0.0) + rest)))

    start = width()
    places, shrinks, most = list[int](), [1.0], min(MOST, taken)
    while start > 0.0 and len(places) < COUNTED:
        if shrinks[-1] <= (HALF if len(places) < most else HALVED):
            break
        own = np.diag(covariance)[count:] + noise**2 + 1e-300
        gains = np.sum(covariance[:count, count:] ** 2 / own, axis=0)
        best = int(np.argmax(gains))
        row = covariance[:, count + best]
        covariance = covariance - np.outer(row, row) / own[best]
        places.append(best)
        shrinks.append(width() / start)
    count = min(most, len(places))
    if shrinks[count] >= WORTH:
        return Proposal(places=(), shrinks=1.0)
    halves = next((k for k, x in enumerate(shrinks) if x <= HALVED), None)
    return Proposal(places=tuple(places[:count]), shrinks=shrinks[count], halves=halves)
