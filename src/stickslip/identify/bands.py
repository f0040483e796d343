"""Bands of curves and intervals of parameters, as quantiles of draws."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
LEVEL = 0.95
"""Probability of a band, and of an interval."""
ALIKE = 0.02
"""Difference of logarithms up to which speeds, or loads, are the same."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PredictionBand:
    """Limits of curves at rows (n,).

    Parameters
    ----------
    low : array (n,)
        Lower limits [N] or [N m].
    median : array (n,)
        Medians.
    high : array (n,)
        Upper limits.
    """

    low: Array
    median: Array
    high: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredPoints:
    """Friction as it was measured, for a figure."""

    velocity: Array
    """Velocities (n,) [m/s]."""
    friction: Array
    """Friction (n,) [N], less what stands beside it."""
    load: Array
    """Loads (n,) [N]."""
    weights: Array
    """How much each counts (n,)."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """What a measurement says of a parameter."""

    path: str
    """Full path, such as ``"friction.kinetic_coefficient"``; of nuisances their name."""
    value: float
    """Estimate under the named law."""
    low: float
    high: float
    """95 % interval under the named law."""
    low_any: float
    high_any: float
    """95 % interval over whichever law of the set has the parameter."""


def quantile_band(
    curves: Array, level: float = LEVEL, *, all_along: bool = False, wider: float = 1.0
) -> PredictionBand:
    """Return quantiles of curves (d, n): point by point, or so that they hold all along.

    Those that hold all along are wider by a factor.

    Examples
    --------
    >>> curves = np.linspace(0.0, 1.0, 101)[:, None] * np.array([1.0, 2.0])
    >>> quantile_band(curves, 0.9).high.round(2).tolist()
    [0.95, 1.9]
    """
    low, median, high = np.quantile(curves, (0.5 - 0.5 * level, 0.5, 0.5 + 0.5 * level), axis=0)
    if all_along:
        above = (curves - median) / (high - median + 1e-300)
        below = (median - curves) / (median - low + 1e-300)
        times = wider * float(np.quantile(np.max(np.maximum(above, below), axis=1), level))
        low, high = median - times * (median - low), median + times * (high - median)
    return PredictionBand(low=low, median=median, high=high)


def correlation_of(values: Array) -> Array:
    """Return the correlation (p, p) of draws of parameters (p, d); 0 of those that are constant."""
    spread = np.std(values, axis=1)
    centred = values - values.mean(axis=1, keepdims=True)
    centred = centred / np.where(spread > 0.0, spread, 1.0)[:, None]
    return np.asarray(centred @ centred.T / values.shape[1])
