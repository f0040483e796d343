r"""Readings at a limit of the sensor: the largest value that it shows, or 0 below a threshold.

Such readings are censored: of friction they say that it is beyond the limit, and no more. With
:math:`k` equal readings :math:`y_c` among all readings :math:`y`, and the others :math:`y_o`,

.. math::
    \frac{p(\text{limit} \mid y)}{p(\text{none} \mid y)}
      = \frac{\pi}{1 - \pi}\,
        \frac{p(y_o)\, P(\text{beyond} \mid y_o)\, p_L}{p(y)\, \delta^k} ,

where :math:`\delta` is the resolution of the readings, with which the density of equal readings is
their probability, :math:`P` is a product over them, as if none went with another, and
:math:`p_L = \delta / \text{size}` the probability of the value of a limit; 0 is known.

Then each is a normal reading whose value and variance, beside the noise, give the mean and the
variance that friction :math:`\sim N(m, v)` by the others has beyond the limit (expectation
propagation, T. Minka, 2001): with :math:`s^2 = \sigma^2 + v`, :math:`z = (m - L) / s` and
:math:`r = \phi(z) / \Phi(z)`, they are :math:`m + s / (z + r)` and :math:`s^2 / r (z + r) - v`.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr

from stickslip.identify.posterior import ROUNDING, Array
from stickslip.identify.problems.table_model import Readings

CENSORED_PRIOR = 0.02
"""Probability that a sensor clips, or has a threshold, within the range of a table."""
ALIKE = 1e-4
"""Least chance, over the deviation of the noise, that two readings are equal: what else makes them
equal, such as a display that holds."""
EXACT = 3e-4
"""Noise over friction below which readings are calculated: they may be equal by their law."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Limit:
    """Equal readings that may be at a limit of the sensor."""

    value: float
    """What they are [N]; 0 at a threshold."""
    rows: "NDArray[np.intp]"
    """The rows (k,)."""
    least: float
    """Size of the least other reading [N]."""

    @property
    def term(self) -> str:
        """What it is called among findings."""
        return "clipping" if self.value else "threshold"

    @property
    def end(self) -> float:
        """Size of friction at the limit [N]."""
        return abs(self.value) or self.least

    def site(
        self, middle: Array, variance: Array, noise: Array, direction: Array
    ) -> tuple[Array, Array]:
        """Return readings (k,) that say as much as these, and their errors beside the noise [N].

        Friction there has a mean (k,) [N] and a variance by all other readings, noise a deviation
        [N], and the velocity a sign.
        """
        way, bound = np.full(len(middle), np.sign(self.value)), abs(self.value)
        if not self.value:
            way, bound = -direction, -self.least
        s = np.sqrt(noise**2 + variance)
        z = (way * middle - bound) / s
        r = np.exp(-0.5 * z * z - log_ndtr(z)) / math.sqrt(math.tau)
        size = np.maximum(s**2 / np.maximum(r * (z + r), ROUNDING) - variance, noise**2)
        return way * (way * middle + s / (z + r)), np.sqrt(size - noise**2)

    def probability(
        self, every: float, other: float, readings: Array, size: float, sigma: float, step: float
    ) -> float:
        """Return the probability that there is a limit.

        Given are the logarithms of the evidence of all readings and of the others, draws (d, k) of
        readings at its rows by the others, the size of friction, the deviation of the noise about
        the others, and the resolution [N].
        """
        if sigma < EXACT * size:
            return 0.0
        inside = np.abs(readings) < self.least
        if self.value:
            inside = np.sign(self.value) * (readings - self.value) >= -0.5 * step
        beyond = float(np.prod(np.mean(inside, axis=0)))
        if not beyond:  # such as outliers
            return 0.0
        resolution = math.log(max(step, ALIKE * sigma))
        odds = math.log(CENSORED_PRIOR / (1.0 - CENSORED_PRIOR)) + other + math.log(beyond)
        odds += (resolution - math.log(size)) * bool(self.value)
        odds -= every + len(self.rows) * resolution
        return 1.0 / (1.0 + math.exp(-min(max(odds, -700.0), 700.0)))


def limits_of(table: Readings) -> Iterator[Limit]:
    """Yield equal readings at 0, and at the ends of the range of single readings.

    Examples
    --------
    >>> from stickslip.identify.problems.table_model import Rows
    >>> v = np.linspace(0.1, 0.6, 6)
    >>> rows = Rows(velocity=v, load=np.ones(6), inputs={}, run=np.zeros(6, int), order=v)
    >>> table = Readings.of(rows, np.array([0.0, 0.0, 1.1, 2.2, 3.0, 3.0]))
    >>> [(limit.value, limit.rows.tolist()) for limit in limits_of(table)]
    [(0.0, [0, 1]), (3.0, [4, 5])]
    """
    y, side = table.friction, table.rows.direction
    if np.any(table.count > 1.0):
        return
    ends = [x for x, way in ((y.max(), 1.0), (y.min(), -1.0)) if x * way > 0.0]
    for value in (0.0, *map(float, ends)):
        rows = np.flatnonzero((y == value) & ((value == 0.0) | (side * value > 0.0)))
        others = np.delete(np.abs(y), rows)
        if len(rows) > 1 and len(others):
            yield Limit(value=value, rows=rows, least=float(others.min()))


def without_site(middle: Array, variance: Array, value: Array, error: Array) -> tuple[Array, Array]:
    """Return mean and variance (k,) of friction without a reading of its own of some variance.

    Examples
    --------
    >>> middle, variance = without_site(*map(np.atleast_1d, (1.0, 0.5, 2.0, 1.0)))
    >>> float(middle[0]), float(variance[0])
    (0.0, 1.0)
    """
    variance = np.minimum(variance, 0.99 * error)
    precision = 1.0 / variance - 1.0 / error
    return (middle / variance - value / error) / precision, 1.0 / precision
