"""Whether residuals follow something, follow each other, or are no more than the sensor's noise."""

import math

import numpy as np
import scipy
from numpy.typing import NDArray

from stickslip.experiments import Measurement, noise_of, step_of
from stickslip.identification.force_map.force_balance import passed_by_balance
from stickslip.identification.residuals.gains import (
    BLOCKS,
    FEWEST,
    LEVEL,
    basis_of,
    chance_of,
    gains_of,
)
from stickslip.identification.series.inverse_dynamics import mass_of
from stickslip.mechanisms import Mechanism

Array = NDArray[np.float64]

CELLS = 12
"""Cells of a quantity in which residuals are averaged to see a trend."""
TREND = 0.01
"""Share of the squared residuals that a trend must predict to be one."""
LAGS = 20
"""Lags of the test for autocorrelation."""


def has_trend(residual: Array, by: Array) -> bool:
    """Whether residuals (n,) in the order of time follow a quantity (n,), such as the velocity.

    Their means in cells of the quantity, from all blocks but one, must take squares off that one:
    in so many blocks that chance would do so in one record of 20.

    Examples
    --------
    >>> random = np.random.default_rng(1)
    >>> noise, v = random.normal(size=2000), np.sin(0.1 * np.arange(2000))
    >>> has_trend(noise, v), has_trend(noise + 0.3 * np.sign(v), v)
    (False, True)
    """
    if len(residual) < FEWEST * BLOCKS or np.ptp(by) == 0.0:
        return False
    u = 2.0 * (by - by.min()) / np.ptp(by) - 1.0
    if np.all(np.diff(by) >= 0.0):  # time: a block left out is a cell by itself
        columns = np.polynomial.legendre.legvander(u, 3)
    else:
        cell = np.minimum((0.5 * (u + 1.0) * CELLS).astype(int), CELLS - 1)
        columns = np.eye(CELLS)[cell]
    gains, _ = gains_of(np.zeros((len(u), 0)), basis_of(columns), residual)
    share = float(gains.sum()) / max(float(residual @ residual), 1e-300)
    chance = 1.0 if share < TREND else chance_of(gains)
    return chance < LEVEL


def ljung_box(residual: Array, lags: int = LAGS) -> float:
    """Return the probability of autocorrelations as large as these in white residuals (n,).

    Source: G. M. Ljung, G. E. P. Box, "On a measure of lack of fit in time series models", 1978.

    Examples
    --------
    >>> white = np.random.default_rng(1).normal(size=1000)
    >>> ljung_box(white) > 0.05, ljung_box(white[1:] + white[:-1]) < 1e-6
    (True, True)
    """
    r, n = residual - residual.mean(), len(residual)
    power = float(r @ r)
    if power <= 0.0 or n <= lags:
        return 1.0
    squares = [float(r[k:] @ r[:-k]) ** 2 / (n - k) for k in range(1, lags + 1)]
    return float(scipy.stats.chi2.sf(n * (n + 2.0) * sum(squares) / power**2, lags))


def noise_floor(mechanism: Mechanism, measurement: Measurement, compared: str) -> float:
    """Return the residuals that the sensor's noise alone would leave (root mean square, SI).

    Examples
    --------
    >>> from stickslip import Axis
    >>> t = np.arange(0.0, 2.0, 1e-3)
    >>> noise = 1e-6 * np.random.default_rng(1).normal(size=len(t))
    >>> record = Measurement(time=t, position=np.sin(t) + noise)
    >>> round(noise_floor(Axis(inertia=1.0), record, "position") * 1e6, 1)
    1.0
    """
    found = []
    for record in measurement.records():
        known = record.quantities()
        if record.time is None or (compared not in known and "position" not in known):
            return math.nan
        values = np.asarray(record.values(compared if compared in known else "position"))
        noise = noise_of(values, step_of(values))
        if compared not in known:  # white noise s has accelerations of variance s^2 w^5 / (5 pi)
            w = math.pi * passed_by_balance(values)
            step = float(np.median(np.diff(record.time)))
            noise *= mass_of(mechanism) * math.sqrt(w**5 / (5.0 * math.pi)) / step**2
        found.append(noise)
    return float(np.sqrt(np.mean(np.square(found))))
