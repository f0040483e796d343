"""How a parameter that was fitted trial by trial depends on a numeric condition."""

import math
from dataclasses import dataclass
from typing import final

import numpy as np
import scipy
from numpy.typing import NDArray

from stickslip.quantities import Quantity

Array = NDArray[np.float64]

SURE = 0.05
"""Significance from which trials scatter about a line by more than their own doubt."""


@final
@dataclass(frozen=True, kw_only=True)
class ConditionLine:
    """A parameter as a line over a condition, by weighted least squares."""

    path: str
    """Path of the parameter."""
    quantity: Quantity
    """Symbol and unit of the parameter."""
    condition: str
    """Name of the condition, with its unit in brackets if it has one."""
    ends: tuple[float, float]
    """Least and largest value of the condition."""
    values: tuple[float, float]
    """The parameter on the line at these."""
    slope: float
    """Change of the parameter by unit of the condition."""
    low: float
    """Lower end of the 95 % interval of the slope; minus infinity if it is not bounded."""
    high: float
    """Upper end."""
    freedom: float
    """Degrees of freedom of that interval."""
    scatter: float
    """Probability of so large a scatter about the line if a line is right; NaN of two values."""

    @property
    def clear(self) -> bool:
        """Whether the interval of the slope leaves 0 out."""
        return self.low > 0.0 or self.high < 0.0


def line_over(
    condition: Array, values: Array, errors: Array, freedom: Array
) -> tuple[Array, float, float, float]:
    """Return a line through values with errors: its intercept and slope, and what is to be known.

    Where values scatter about the line by more than their errors tell, the scatter counts, with
    the degrees of freedom that it has.

    Examples
    --------
    >>> z = np.array([20.0, 40.0, 60.0])
    >>> line, error, *_ = line_over(z, 0.1 + 0.001 * z, np.full(3, 0.002), np.full(3, 7.0))
    >>> line.round(6).tolist(), round(error, 6)
    ([0.1, 0.001], 7.1e-05)
    """
    weights = 1.0 / errors**2
    center = float(np.average(condition, weights=weights))
    table = np.column_stack([np.ones_like(condition), condition - center])
    normal = table.T @ (weights[:, None] * table)
    level, slope = np.linalg.solve(normal, table.T @ (weights * values))
    error = math.sqrt(1.0 / normal[1, 1])
    # Welch and Satterthwaite: the slope is a sum over trials, of which each adds its own variance
    shares = (weights * (condition - center) / normal[1, 1]) ** 2 * errors**2
    own = float(shares.sum() ** 2 / np.sum(shares**2 / freedom))
    rest = len(values) - 2
    scatter = math.nan
    if rest > 0:
        misfit = float(np.sum(weights * (values - table @ [level, slope]) ** 2)) / rest
        total = float(np.sum(freedom))
        scatter = float(scipy.stats.f.sf(misfit, rest, total))
        if scatter < SURE:
            error, own = error * math.sqrt(misfit), float(rest)
    return np.array([level - slope * center, slope]), error, own, scatter
