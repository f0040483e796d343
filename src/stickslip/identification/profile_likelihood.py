"""How large a parameter may be before the record speaks against it."""

import math
from dataclasses import dataclass
from typing import final

import numpy as np

from stickslip.described import Described
from stickslip.errors import ConvergenceError
from stickslip.identification.estimation.jackknife import quantile_of
from stickslip.identification.records.fit import RecordFit

FIRST = 0.2
"""First step over the value, where no interval says how far the end may be."""


@final
@dataclass(frozen=True, kw_only=True)
class Allowed(metaclass=Described):
    """The upper end of what a record allows a parameter, all others fitted anew beside it."""

    path: str
    """Parameter path."""
    value: float
    """The largest value allowed with 95 %, between or beyond the two that were tried."""
    tried: tuple[float, float]
    """Values that it was held at."""
    costs: tuple[float, float]
    """Least sum of squares at each of them, over that of the fit."""


def largest_allowed(fit: RecordFit, name: str) -> Allowed | None:
    """Return the largest value of a parameter that the record still allows, by its profile.

    The least sum of squares may rise by the square of Student's quantile over the degrees of
    freedom, which are counted in independent rows. Near its least it is a parabola: two values
    tell where it gets there.

    Parameters
    ----------
    fit : RecordFit
        The fit.
    name : str
        Path or last name of an unknown.

    Returns
    -------
    Allowed or None
        None if the record cannot be predicted with larger values, or does not depend on them.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Axis, Coulomb, Measurement, fit
    >>> v = np.linspace(-1.0, 1.0, 80)
    >>> table = Measurement(velocity=v, friction=2.0 * np.sign(v) + 0.1 * np.cos(40.0 * v))
    >>> found = fit(Axis(inertia=1.0), Coulomb, table)
    >>> end = largest_allowed(found, "kinetic_coefficient")
    >>> found.estimate("kinetic_coefficient").value < end.value < 2.1
    True
    """
    estimate = fit.estimate(name)
    freedom = max(fit.inference.effective - len(fit.free_parameters), 1.0)
    rise = float(quantile_of(np.array(freedom))) ** 2 / freedom
    first = FIRST * abs(estimate.value)
    if estimate.bounded and 0.0 < estimate.high - estimate.value < 10.0 * first:
        first = estimate.high - estimate.value
    one = _rise(fit, estimate.path, estimate.value + first)
    if not 0.0 < one < math.inf:
        return None
    second = first * min(max(math.sqrt(rise / one), 0.1), 4.0)
    two = _rise(fit, estimate.path, estimate.value + second)
    if not 0.0 < two < math.inf:
        return None
    return Allowed(
        path=estimate.path,
        value=estimate.value + second * math.sqrt(rise / two),
        tried=(estimate.value + first, estimate.value + second),
        costs=(1.0 + one, 1.0 + two),
    )


def _rise(fit: RecordFit, path: str, value: float) -> float:
    """Return by what share the sum of squares rises where a parameter is held."""
    try:
        return float(fit.profile(path, [value])[0]) / fit.optimum.best.cost - 1.0
    except ConvergenceError:
        return math.inf
