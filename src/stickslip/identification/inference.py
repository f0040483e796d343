"""How sure estimates are where residuals are correlated: sandwiches of blocks, and bootstraps."""

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from stickslip.identification.problem import Linearised

__all__ = ["BLOCKS", "Inference", "block_sums", "bootstrap", "infer"]

Array = NDArray[np.float64]

BLOCKS = 10
"""Blocks of a record between which residuals count as independent."""
NO_SLOPE = 1e-12
"""Slope of a parameter, over the largest of all on their scales, below which it has no effect."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Inference:
    """Covariances of estimates (p, p), of what the data say and of what white noise would say."""

    covariance: Array
    """Cluster sandwich over blocks."""
    naive: Array
    """As if every residual were independent."""
    quantile: float
    """Half width of a 95 % interval in standard errors: Student's t with blocks - 1 degrees."""
    condition: float
    """Of the slopes, their columns scaled to 1."""
    effective: float
    """Effective number of independent residuals."""

    @property
    def errors(self) -> Array:
        """Standard errors (p,)."""
        return np.sqrt(np.maximum(np.diag(self.covariance), 0.0))

    @property
    def half_widths(self) -> Array:
        """Half widths of 95 % intervals (p,)."""
        return self.quantile * self.errors

    @property
    def correlation(self) -> Array:
        """Correlation of the estimates (p, p), 0 for what the record does not depend on."""
        known = np.isfinite(self.errors) & (self.errors > 0.0)
        errors = np.where(known, self.errors, 1.0)
        whole = np.where(np.isfinite(self.covariance), self.covariance, 0.0)
        table: Array = whole / np.outer(errors, errors)
        np.fill_diagonal(table, 1.0)
        return table


def block_sums(seen: Linearised, table: Array, *, blocks: int = BLOCKS) -> tuple[Array, Array]:
    """Return the Gauss-Newton matrices (b, p, p) and gradients (b, p) of contiguous blocks."""
    edges = np.linspace(0, len(seen.residual), blocks + 1).astype(int)
    squares, slopes = [], []
    for first, last in itertools.pairwise(edges.tolist()):
        part = table[first:last]
        squares.append(part.T @ part)
        slopes.append(part.T @ seen.residual[first:last])
    return np.array(squares), np.array(slopes)


def infer(seen: Linearised, scale: Array, *, blocks: int = BLOCKS) -> Inference:
    """Return covariances at an optimum.

    Parameters
    ----------
    seen : Linearised
        The record at the estimates, rows in the order of time.
    scale : array (p, p)
        Derivatives of the values by what the optimiser sees; rows that are free of bounds.
    blocks : int
        Number of blocks of equal length.
    """
    table = seen.slopes @ scale
    size = np.linalg.norm(table, axis=0)
    effective = size > NO_SLOPE * max(float(size.max(initial=0.0)), 1e-300)
    blocks = max(2, min(blocks, len(seen.residual) // 4))
    count = int(effective.sum())
    part = table[:, effective]
    squares, slopes = block_sums(seen, part, blocks=blocks)
    inverse = np.linalg.pinv(squares.sum(axis=0), hermitian=True)
    meat = np.einsum("bi,bj->ij", slopes, slopes)
    sandwich = inverse @ meat @ inverse * blocks / (blocks - 1)
    freedom = max(len(seen.residual) - count, 1)
    naive = inverse * seen.cost / freedom
    singular = np.linalg.svd(part / size[effective], compute_uv=False) if count else np.ones(1)
    return Inference(
        covariance=_spread(sandwich, effective, scale),
        naive=_spread(naive, effective, scale),
        quantile=float(stats.t.ppf(0.975, blocks - 1)),
        condition=float(singular[0] / max(singular[-1], 1e-300)),
        effective=effective_size(seen),
    )


def _spread(covariance: Array, effective: NDArray[np.bool_], scale: Array) -> Array:
    """Return a covariance of values from that of the effective coordinates; infinite for others."""
    whole = np.zeros((len(effective), len(effective)))
    whole[np.ix_(effective, effective)] = covariance
    values = scale @ whole @ scale.T
    for i in np.flatnonzero(~effective):
        values[i, i] = np.inf
    return values


def effective_size(seen: Linearised) -> float:
    """Return the number of independent residuals that vary as these do.

    From the autocorrelation up to its first zero, in the record's order.
    """
    r = seen.residual - seen.residual.mean()
    n = len(r)
    spectrum = np.fft.rfft(r, 2 * n)
    correlation = np.fft.irfft(np.abs(spectrum) ** 2)[:n]
    if correlation[0] <= 0.0:
        return float(n)
    correlation = correlation / correlation[0]
    below = np.flatnonzero(correlation <= 0.0)
    last = int(below[0]) if below.size else n
    return float(n / max(1.0 + 2.0 * correlation[1:last].sum(), 1.0))


def bootstrap(
    seen: Linearised,
    scale: Array,
    *,
    draws: int = 2000,
    blocks: int = BLOCKS,
    seed: int = 0,
) -> Array:
    """Return draws (draws, p) of the change of the estimates when blocks are drawn anew.

    One Gauss-Newton step from the optimum for each draw; no run is made.

    Examples
    --------
    >>> rows = np.random.default_rng(1).normal(size=200)
    >>> mean = Linearised(
    ...     values=np.zeros(1),
    ...     residual=rows - rows.mean(),
    ...     slopes=np.ones((200, 1)),
    ...     segment=np.zeros(200, dtype=int),
    ... )
    >>> draws = bootstrap(mean, np.eye(1))
    >>> bool(abs(draws.std() - rows.std() / 200**0.5) < 0.04)
    True
    """
    table = seen.slopes @ scale
    blocks = max(2, min(blocks, len(seen.residual) // 4))
    squares, slopes = block_sums(seen, table, blocks=blocks)
    drawn = np.random.default_rng(seed).integers(blocks, size=(draws, blocks))
    steps = [
        np.linalg.lstsq(squares[pick].sum(axis=0), slopes[pick].sum(axis=0), rcond=1e-12)[0]
        for pick in drawn
    ]
    changes: Array = np.array(steps) @ scale.T
    return changes
