"""Whether residuals follow something, follow each other, or are no more than the sensor's noise."""

import itertools
import math

import numpy as np
import scipy
from numpy.typing import NDArray

from stickslip.experiments import Measurement, noise_of, step_of
from stickslip.identification.force_map.force_balance import passed_by_balance
from stickslip.identification.series.inverse_dynamics import mass_of
from stickslip.mechanisms import Mechanism

Array = NDArray[np.float64]

BLOCKS = 20
"""Blocks of a record that are left out in turn."""
FEWEST = 6
"""Rows that a block has at least."""
LEVEL = 0.05
"""Probability that a record without an error is said to have one, all columns together."""
RIDGE = 1e-6
"""Share of the whole record that each coefficient is drawn to 0 by, where a block has it all."""
CELLS = 12
"""Cells of a quantity in which residuals are averaged to see a trend."""
TREND = 0.01
"""Share of the squared residuals that a trend must predict to be one."""
LAGS = 20
"""Lags of the test for autocorrelation."""


def basis_of(slopes: Array) -> Array:
    """Return orthonormal columns (m, r) that span those of a table (m, p)."""
    size = np.linalg.norm(slopes, axis=0)
    if not np.any(size > 0.0):
        return np.zeros((len(slopes), 0))
    u, s, _ = np.linalg.svd(slopes[:, size > 0.0] / size[size > 0.0], full_matrices=False)
    return np.asarray(u[:, s > 1e-7 * s[0]])


def beside(columns: Array, slopes: Array) -> Array:
    """Return columns (m, ...) less what slopes (m, p) can take up."""
    basis = basis_of(slopes)
    return np.asarray(columns - basis @ (basis.T @ columns))


def gains_of(basis: Array, directions: Array, residual: Array) -> tuple[Array, Array]:
    """Return the squares (blocks,) that directions (m, q) take off each block when it is left out.

    And their coefficients without it (blocks, q). What `basis` (m, p) takes off is no gain; all
    columns are orthonormal.
    """
    table = np.column_stack([basis, directions])
    p = basis.shape[1]
    starts = np.linspace(0, len(residual), BLOCKS + 1).astype(int)
    rows = [slice(first, last) for first, last in itertools.pairwise(starts.tolist())]
    squares = np.array([table[own].T @ table[own] for own in rows])
    slopes = np.array([table[own].T @ residual[own] for own in rows])
    # columns are orthonormal over all rows, so that a ridge is a share of them
    rest = squares.sum(axis=0) - squares + RIDGE * np.eye(len(squares[0]))
    wanted = (slopes.sum(axis=0) - slopes)[..., None]
    without = np.linalg.solve(rest[:, :p, :p], wanted[:, :p])[..., 0]
    found = np.linalg.solve(rest, wanted)[..., 0]
    gains = _taken_off(found, squares, slopes) - _taken_off(
        without, squares[:, :p, :p], slopes[:, :p]
    )
    return gains, np.asarray(found[:, p:])


def _taken_off(values: Array, squares: Array, slopes: Array) -> Array:
    """Return the squares (b,) that coefficients (b, p) take off each block."""
    found: Array = 2.0 * np.einsum("bp,bp->b", values, slopes) - np.einsum(
        "bp,bpq,bq->b", values, squares, values
    )
    return found


def half_width_of(left_out: Array) -> float:
    """Return the half width of the 95 % interval of a number from its jackknife (blocks,).

    Examples
    --------
    >>> round(half_width_of(np.array([1.0, 1.1, 0.9, 1.0])), 3)
    0.39
    """
    count = len(left_out)
    error = math.sqrt((count - 1) / count * float(np.sum((left_out - left_out.mean()) ** 2)))
    return float(scipy.stats.t.ppf(0.975, count - 1)) * error


def chance_of(gains: Array) -> float:
    """Return the probability of gains (blocks,) like these where nothing is to be predicted.

    Source: F. Wilcoxon, "Individual comparisons by ranking methods", 1945 (signed ranks).

    Examples
    --------
    >>> chance_of(np.arange(1.0, 11.0)) < 0.001, chance_of(np.array([1.0, -2.0, 3.0, -4.0])) > 0.3
    (True, True)
    """
    return float(scipy.stats.wilcoxon(gains, alternative="greater").pvalue)


def has_trend(residual: Array, by: Array, *, among: int = 1) -> bool:
    """Whether residuals (n,) in the order of time follow a quantity (n,), such as the velocity.

    Their means in cells of the quantity, from all blocks but one, must take squares off that one:
    in so many blocks that the probability of it by chance is below 0.05, divided by the number of
    quantities tested, `among` (Bonferroni).

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
    return chance < LEVEL / among


def ljung_box(residual: Array) -> float:
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
    if power <= 0.0 or n <= LAGS:
        return 1.0
    squares = [float(r[k:] @ r[:-k]) ** 2 / (n - k) for k in range(1, LAGS + 1)]
    return float(scipy.stats.chi2.sf(n * (n + 2.0) * sum(squares) / power**2, LAGS))


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
