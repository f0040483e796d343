"""Nonlinear parameters off their grids, and intervals of all parameters."""

import math
from collections.abc import Sequence

import numpy as np
import scipy.stats
from numpy.typing import NDArray
from scipy.optimize import minimize

from stickslip.errors import InputError
from stickslip.evidence.balance import Balance
from stickslip.evidence.fits import Fit, design, estimated, fit, possible, sandwich
from stickslip.evidence.values import (
    changes,
    column_keys,
    free_values,
    logarithms,
    moved,
    polished,
    sane,
    slopes,
)

Array = NDArray[np.float64]
Interval = tuple[float, float, float]

BLOCKS = 20
"""Blocks of time that intervals come from."""
BUDGET = 60
"""Evaluations that the refinement may take."""
BANDS = (0.6, 1.5)
"""Bands, over the usual one, between which parameters shift: the bias of a filtered balance is
not statistical."""
SIMPLEX = 0.1
"""First changes of logarithms."""
NUDGE = 1e-3
"""Change of a logarithm for slopes."""


def refined(balance: Balance, found: Fit) -> Fit:
    """Return a fit with its nonlinear parameters off their grids, by variable projection."""
    which = free_values(found.structure)
    if not which:
        return found
    start = logarithms(found.structure, which)
    forbidden = 1e3 * float(np.sum(found.residual**2))

    def cost(logs: Array) -> float:
        structure = moved(found.structure, which, logs)
        with balance.passing():
            made = design(balance, structure)
            values = estimated(made).values
        left = made.errors(values)[balance.use]
        wild = not sane(balance, structure) or not possible(made, values)
        return float(left @ left) + (forbidden if wild else 0.0)

    first = changes(balance, found.structure, which, SIMPLEX)
    simplex = np.vstack([start, start + np.diag(first)])
    options = {
        "maxfev": BUDGET,
        "xatol": 2e-3,
        "fatol": 1e-7 * cost(start),
        "initial_simplex": simplex,
    }
    best = minimize(cost, start, method="Nelder-Mead", options=options).x
    return fit(balance, moved(found.structure, which, best))


def intervals_of(balance: Balance, found: Fit) -> dict[str, Interval]:
    """Return value, lower and upper limit (95 %) of every parameter, from blocks of time.

    The points of a table are independent.
    """
    which = free_values(found.structure)
    made = design(balance, found.structure)
    rows = made.slipping
    moving = slopes(balance, found.structure, which, found.coef, NUDGE)
    seen = made.shown(np.column_stack([made.columns, moving]) * rows[:, None])[rows]
    left = found.residual[rows]
    if balance.dynamic:
        blocks = max(min(BLOCKS, len(left) // 2), 2)
        half = sandwich(seen, left, blocks, 1e-10) * scipy.stats.t.ppf(0.975, blocks - 1)
    else:
        half = _independent(seen, left)
    found_intervals: dict[str, Interval] = {}
    count = len(made.owners)
    for key, value, width in zip(column_keys(made.owners), found.coef, half, strict=False):
        found_intervals[key] = (float(value), float(value - width), float(value + width))
    for one, width in zip(which, half[count:], strict=True):
        value, factor = one.of(found.structure), math.exp(min(float(width), 50.0))
        low, high = sorted((value / factor, value * factor))
        found_intervals[one.name] = (value, low, high)
    return found_intervals


def _independent(seen: Array, left: Array) -> Array:
    """Return half widths (p,) for rows that are independent and scatter alike."""
    freedom = max(len(left) - seen.shape[1], 1)
    size = np.maximum(np.sqrt((seen * seen).sum(axis=0)), 1e-300)
    scaled = seen / size
    inverse = np.linalg.pinv(scaled.T @ scaled, rcond=1e-10)
    variance = float(left @ left) / freedom
    errors = np.sqrt(np.maximum(np.diag(inverse), 0.0) * variance) / size
    return np.asarray(errors * scipy.stats.t.ppf(0.975, freedom))


def widened(
    balance: Balance, found: Fit, intervals: dict[str, Interval], factors: Sequence[float] = BANDS
) -> dict[str, Interval]:
    """Return intervals wider by what each parameter shifts between bands."""
    shift = dict.fromkeys(intervals, 0.0)
    for factor in factors if balance.dynamic else ():
        try:
            other = Balance(balance.series, factor * balance.fc)
        except InputError:  # too short for so narrow a band
            continue
        again = fit(other, polished(other, found.structure, 3))
        values = values_of(again)
        for key, (value, _, _) in intervals.items():
            shift[key] = max(shift[key], abs(values.get(key, value) - value))
    return {
        key: (
            value,
            value - math.hypot(value - low, shift[key]),
            value + math.hypot(high - value, shift[key]),
        )
        for key, (value, low, high) in intervals.items()
    }


def values_of(found: Fit) -> dict[str, float]:
    """Return every parameter of a fit, by the names of intervals."""
    values = dict(zip(column_keys(found.owner), map(float, found.coef), strict=True))
    for one in free_values(found.structure):
        values[one.name] = one.of(found.structure)
    return values
