"""How sure the errors of fits to features are, and whether two of them differ."""

import math
from collections.abc import Mapping
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.kinds.features.features import COMPARED
from stickslip.kinds.features.result import FeatureFit

Array: TypeAlias = NDArray[np.float64]

SHARE = 0.5
"""Share of what the features themselves change that decides nothing between two laws."""
LEAST = 0.01
"""Nor does a difference below this."""


def room_of(fit: FeatureFit) -> float:
    """Return the root mean square change of the features from the fitted part to the other.

    It is 0 where nothing was held out.
    """
    if fit.held_out is None:
        return 0.0
    change = np.log(fit.held_out.compared / fit.observed.compared)
    return float(np.sqrt(np.mean(change**2)))


def error_of_score(fit: FeatureFit) -> float:
    """Return the standard error of a held-out score; not a number where nothing was held out.

    Features of both parts are in doubt: those of one are predicted, those of the other judge.
    """
    return _doubt(fit, _slope(fit.held_out_errors))


def paired(other: FeatureFit, best: FeatureFit) -> tuple[float, float]:
    """Return by how much another score is larger, and the standard error of this difference.

    Both are judged by the same features, so what is in doubt of these cancels as far as the laws
    err alike.
    """
    slope = _slope(other.held_out_errors) - _slope(best.held_out_errors)
    return other.score - best.score, _doubt(best, slope)


def as_good(other: FeatureFit, best: FeatureFit) -> bool:
    """Whether a record does not tell another law from the best.

    The difference must exceed one paired standard error, and half of what the features change by
    themselves: a law that misses the fitted part may come nearer to the other by chance.
    """
    if best.held_out is None:
        return other.rms <= best.rms + LEAST
    difference, error = paired(other, best)
    return difference <= max(error, SHARE * room_of(best) + LEAST)


def _slope(errors: Mapping[str, float]) -> Array:
    """Return the derivative of a score by the logarithms of the features (3,)."""
    left = np.array([errors.get(name, math.nan) for name in COMPARED])
    size = float(np.sqrt(left @ left))
    if size == 0.0:
        return np.full(len(COMPARED), 1.0 / len(COMPARED))
    return np.asarray(left / (size * math.sqrt(len(COMPARED))))


def _doubt(fit: FeatureFit, slope: Array) -> float:
    if fit.held_out is None:
        return math.nan
    covariance = fit.observed.covariance + fit.held_out.covariance
    return math.sqrt(max(float(slope @ covariance @ slope), 0.0))
