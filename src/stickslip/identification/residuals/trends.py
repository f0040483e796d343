"""Whether residuals follow something, follow each other, or are no more than the sensor's noise."""

import itertools
import math

import numpy as np
import scipy
from numpy.typing import NDArray

Array = NDArray[np.float64]

BLOCKS = 20
"""Blocks of a record that are left out in turn."""
FEWEST = 6
"""Rows that a block has at least."""
RIDGE = 1e-6
"""Share of the whole record that each coefficient is drawn to 0 by, where a block has it all."""


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
