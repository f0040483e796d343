"""Whether trials share one law: a test that allows for autocorrelated residuals.

Each trial with a law of its own fits better than all with one. How much better it is by chance
follows from how the gradients of blocks scatter within each trial, not from the residuals taken as
independent, which reject far too often. The statistic is the fall of the sum of squares, to first
order at the joint optimum; its mean and variance under the hypothesis match a scaled F (Rao & Scott
1984; Bell & McCaffrey 2002 for the degrees of freedom of few blocks).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
import scipy
from numpy.typing import NDArray

from stickslip.identification.estimation.jackknife import BLOCKS, Displaced, block_sums
from stickslip.identification.estimation.problem import ResidualJacobian

Array = NDArray[np.float64]

CUT = 1e-10
"""Eigenvalue of the scaled normal matrix, over the largest, below which a direction is not seen."""

KNOWN = 1e9
"""Degrees of freedom of a stated uncertainty."""


@final
@dataclass(frozen=True, kw_only=True)
class Homogeneity:
    """The test that trials share one law."""

    p: float
    """Probability of so large a difference if they do; not a number where it cannot be tested."""
    statistic: float
    """F statistic."""
    freedom: tuple[float, float]
    """Degrees of freedom of the F distribution."""


def rows_of(jacobian: ResidualJacobian, rows: NDArray[np.bool_]) -> ResidualJacobian:
    """Return some rows of linearised residuals.

    Examples
    --------
    >>> seen = ResidualJacobian(
    ...     values=np.zeros(1),
    ...     residual=np.arange(3.0),
    ...     slopes=np.ones((3, 1)),
    ...     segment=np.array([0, 0, 1]),
    ... )
    >>> rows_of(seen, seen.segment == 0).residual.tolist()
    [0.0, 1.0]
    """
    return ResidualJacobian(
        values=jacobian.values,
        residual=jacobian.residual[rows],
        slopes=jacobian.slopes[rows],
        segment=jacobian.segment[rows],
    )


def homogeneity(
    trials: Sequence[ResidualJacobian],
    scale: Array,
    separate: Sequence[int],
    displaced: Sequence[Sequence[Displaced]] = (),
) -> Homogeneity:
    """Test whether trials share the values of some unknowns.

    Examples
    --------
    >>> draw = np.random.default_rng(0)
    >>> def trial(level):
    ...     return ResidualJacobian(
    ...         values=np.zeros(1),
    ...         residual=level + draw.normal(size=200),
    ...         slopes=np.ones((200, 1)),
    ...         segment=np.zeros(200, dtype=int),
    ...     )
    >>> same = homogeneity([trial(0.0), trial(0.0)], np.eye(1), [0])
    >>> other = homogeneity([trial(-0.5), trial(0.5)], np.eye(1), [0])
    >>> same.p > 0.05, other.p < 0.001
    (True, True)
    """
    width = len(scale)
    shared = [i for i in range(width) if i not in separate]
    places = _places(len(trials), separate, shared)
    size = len(trials) * len(separate) + len(shared)
    normal, score = np.zeros((size, size)), np.zeros(size)
    gathered = np.zeros((size, width))
    scatters, freedoms = [], []
    for one, place in zip(trials, places, strict=True):
        blocks = max(2, min(BLOCKS, len(one.residual) // 4))
        squares, slopes = block_sums(one, one.slopes @ scale, blocks=blocks)
        normal[np.ix_(place, place)] += squares.sum(axis=0)
        score[place] += slopes.sum(axis=0)
        gathered[place, np.arange(width)] = 1.0
        apart = slopes - slopes.mean(axis=0)
        whole = np.zeros((size, size))
        between = _between_blocks(one, scale, blocks) * blocks / (blocks - 1.0)
        whole[np.ix_(place, place)] = between * (apart.T @ apart)
        scatters.append(whole)
        freedoms.append(blocks - 1.0)
    for several in zip(*displaced, strict=True):
        pull = np.zeros(size)
        for one, place, moved in zip(trials, places, several, strict=True):
            pull[place] += (one.slopes @ scale).T @ moved.rows
        scatters.append(np.outer(pull, pull))
        freedoms.append(KNOWN)
    form = _inverse(normal) - gathered @ _inverse(gathered.T @ normal @ gathered) @ gathered.T
    return _matched(float(score @ form @ score), form, scatters, freedoms)


def _between_blocks(one: ResidualJacobian, scale: Array, blocks: int) -> float:
    """Return by how much a whole trial varies more than its blocks, added as independent, say.

    Residuals on both sides of the edge between two blocks are correlated as well. Without this,
    blocks five times as long as residuals remember reject 10 % instead of 5 %.
    """
    table = one.slopes @ scale
    roots = np.linalg.eigh(_inverse(table.T @ table))
    rows = one.residual[:, None] * (table @ (roots[1] * np.sqrt(np.maximum(roots[0], 0.0))))
    n = len(rows)
    spectrum = np.abs(np.fft.rfft(rows, 2 * n, axis=0)) ** 2
    shared = np.fft.irfft(spectrum.sum(axis=1))[:n]
    if not shared[0] > 0.0:
        return 1.0
    below = np.flatnonzero(shared <= 0.0)
    shared = shared[: int(below[0]) if below.size else n] / shared[0]
    lag = np.arange(1, len(shared))
    by_trial, by_block = (
        1.0 + 2.0 * float(np.sum(np.maximum(1.0 - lag / length, 0.0) * shared[1:]))
        for length in (n, n / blocks)
    )
    return by_trial / by_block


def _places(trials: int, own: Sequence[int], shared: Sequence[int]) -> list[NDArray[np.intp]]:
    """Return where the unknowns of each trial (p,) stand among those of all with own values."""
    found = []
    for k in range(trials):
        place = np.zeros(len(own) + len(shared), dtype=np.intp)
        place[list(own)] = k * len(own) + np.arange(len(own))
        place[list(shared)] = trials * len(own) + np.arange(len(shared))
        found.append(place)
    return found


def _inverse(matrix: Array) -> Array:
    """Return the inverse of a normal matrix on the directions that are seen, columns scaled."""
    size = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    size = np.where(size > 0.0, size, 1.0)
    inverse = np.linalg.pinv(matrix / np.outer(size, size), rcond=CUT, hermitian=True)
    return np.asarray(inverse / np.outer(size, size))


def _matched(
    statistic: float, form: Array, scatters: Sequence[Array], freedoms: Sequence[float]
) -> Homogeneity:
    """Return the F that has the mean and the variance of a quadratic form of block gradients."""
    parts = [form @ scatter for scatter in scatters]
    means = np.array([float(np.trace(part)) for part in parts])
    mean = float(means.sum())
    if not mean > 0.0 or not math.isfinite(statistic):
        return Homogeneity(p=math.nan, statistic=math.nan, freedom=(math.nan, math.nan))
    whole = sum(parts)
    assert isinstance(whole, np.ndarray)
    squares = float(np.sum(whole * whole.T))
    unsure = 0.0
    for part, own, f in zip(parts, means, freedoms, strict=True):
        raw = float(np.sum(part * part.T))
        # a scatter of f degrees overrates its square (Bai & Saranadasa 1996)
        right = (
            max(f * f / ((f - 1.0) * (f + 2.0)) * (raw - own * own / f), 0.0) if f > 1.0 else 0.0
        )
        squares += max(right, own * own / len(form)) - raw
        unsure += max(right, own * own / len(form)) / f
    above = min(max(mean * mean / max(squares, 1e-300), 1.0), float(len(form)))
    below = mean * mean / max(unsure, 1e-300)
    found = statistic / mean
    return Homogeneity(
        p=float(scipy.stats.f.sf(found, above, below)), statistic=found, freedom=(above, below)
    )
