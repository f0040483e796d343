"""A smooth curve through a friction table, which shows whether it has a shape that no law has."""

import itertools
import math
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from stickslip.identification import interleaved
from stickslip.kinds.records.verdict import (
    RecordCandidate,
)
from stickslip.selection import (
    NEAR,
    CrossValidation,
    errs_more,
)

Array = NDArray[np.float64]

LENGTHS: Final = (0.1, 0.2, 0.3, 0.5, 0.85)
"""Lengths over which curves bend, over the range of the logarithm of the speed ..."""
NOISES: Final = (0.1, 0.03, 0.01, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5)
"""... and variances of the noise, over that by which they bend."""
STIFF: Final = 100.0
"""Variance of the level of a curve, over that by which it bends."""
ENOUGH: Final = 5
"""Speeds of a direction from which a curve is drawn through them."""


def with_curve(candidate: RecordCandidate, *, uncertainty: float) -> RecordCandidate:
    """Return a candidate with the errors of a curve if it predicts its table better."""
    curve = _curve_through(candidate)
    if curve is None:
        return candidate
    smooth = replace(candidate, validation=curve)
    worse = errs_more(candidate, smooth, errors=NEAR, uncertainty=uncertainty)
    return replace(candidate, curve=curve) if worse else candidate


def _curve_through(candidate: RecordCandidate) -> CrossValidation | None:
    """Return the held-out errors of a curve through the table that a candidate was fitted to.

    The curve is no law: a Gaussian process over the logarithm of the speed, one for each direction.
    None where a direction has too few speeds, or the load varies.
    """
    fit = candidate.fit
    if fit is None or candidate.validation is None or not interleaved(fit.problem.spans):
        return None
    samples = fit.problem.samples
    velocity, friction, load = (
        np.concatenate([getattr(one, name) for one in samples])
        for name in ("velocity", "friction", "load")
    )
    segment = fit.optimum.best.segment
    if len(segment) != len(velocity) or np.ptp(load) > 0.0 or not friction.any():
        return None
    counts = [len(np.unique(velocity[side])) for side in (velocity > 0.0, velocity < 0.0)]
    if not velocity.all() or any(0 < count < ENOUGH for count in counts):
        return None
    losses = _losses(np.log(np.abs(velocity)), np.sign(velocity), friction, segment)
    return CrossValidation(losses=losses, extrapolation=math.nan)


def _losses(x: Array, side: Array, friction: Array, segment: NDArray[np.intp]) -> tuple[float, ...]:
    """Return the mean squares of held-out segments by the curve that predicts them best."""
    alike = side[:, None] == side[None, :]
    apart = np.subtract.outer(x, x) / max(float(np.ptp(x)), 1e-9)
    tried = []
    for length, noise in itertools.product(LENGTHS, NOISES):
        covariance = alike * (np.exp(-0.5 * (apart / length) ** 2) + STIFF)
        inverse = np.linalg.inv(covariance + noise * np.eye(len(x)))
        weights = inverse @ friction
        rows = [np.flatnonzero(segment == k) for k in np.unique(segment)]
        left = [np.linalg.solve(inverse[np.ix_(r, r)], weights[r]) for r in rows]
        tried.append(tuple(float(np.mean(one**2)) for one in left))
    return min(tried, key=sum)
