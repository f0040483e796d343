"""Intervals where neighbouring residuals are correlated."""

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.identification.estimation.directions import Directions
from stickslip.identification.estimation.problem import ResidualJacobian

__all__ = ["sandwich"]

Array: TypeAlias = NDArray[np.float64]


def sandwich(at: ResidualJacobian, free: NDArray[np.bool_]) -> Array:
    """Return the covariance (p, p) of the values; infinite variances where not free or not seen.

    Residuals may be correlated in any way within a segment, and not between segments. Where few
    segments carry all the information that comes out too small by chance, so variances are at least
    those of independent residuals.

    Parameters
    ----------
    at : ResidualJacobian
        Residuals (n,), Jacobian (n, p) and segments of the rows, at the estimates.
    free : array of bool (p,)
        Which estimates no bound holds.

    Returns
    -------
    array (p, p)
        Covariance of the values.

    Examples
    --------
    >>> draw = np.random.default_rng(0)
    >>> many = ResidualJacobian(
    ...     values=np.zeros(1),
    ...     residual=draw.normal(size=10_000),
    ...     slopes=np.ones((10_000, 1)),
    ...     segment=np.repeat(np.arange(100), 100),
    ... )
    >>> 0.008 < float(np.sqrt(sandwich(many, np.array([True]))[0, 0])) < 0.012
    True
    """
    known = Directions.of(at.slopes[:, free])
    kinds, which = np.unique(at.segment, return_inverse=True)
    scores = np.zeros((len(kinds), known.columns.shape[1]))
    np.add.at(scores, which, known.columns * at.residual[:, None])
    count = len(kinds)
    moved = scores @ known.inverse.T
    inner = moved.T @ moved * (count / max(count - 1, 1))
    spare = max(len(at.residual) - len(known.size), 1)
    white = np.sum(known.inverse**2, axis=1) * at.cost / spare
    narrow = np.sqrt(np.maximum(1.0, white / np.maximum(np.diag(inner), 1e-300)))
    inner = np.where(np.diag(inner) > 0.0, inner * np.outer(narrow, narrow), np.diag(white))
    for i, reason in enumerate(known.reasons(np.eye(len(known.size)))):
        if reason:
            inner[i, i] = np.inf
    covariance = np.zeros((len(free), len(free)))
    covariance[np.ix_(free, free)] = inner
    covariance[~free, ~free] = np.inf
    return covariance
