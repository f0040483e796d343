"""Friction that drifts from trial to trial: laws with it, which others may be mistaken for."""

import math
from dataclasses import replace
from typing import Final

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import StickslipError
from stickslip.identification import Estimate, TravelModel
from stickslip.kinds.travels.result import TravelFit
from stickslip.kinds.travels.verdict import TravelCandidate
from stickslip.quantities import parameters, vary
from stickslip.selection import LIKELY, ROUNDS, SETTLED, along, if_drifting

Array = NDArray[np.float64]

FORCES: Final = ("level", "slope", "drag", "force")
"""What scales of parameters begin with that a drift of friction changes."""
STEP: Final = 1e-3
"""Step of differences, over the value."""


def drifting(candidate: TravelCandidate, t_end: float) -> TravelCandidate | None:
    """Return a law as it fits with a drift beside it, told by its title.

    None where no drift, or only a larger one than is likely, makes a law explain the readings
    better. Its levels lie between those of the first trial and of the last.
    """
    fit = candidate.fit
    if fit is None or not fit.standard_errors or candidate.law.states or candidate.invented:
        return None
    try:
        found = _searched(fit, t_end)
    except StickslipError:  # a body that does not rest, or an inequality that a drift breaks
        return None
    if found is None:
        return None
    values, spread = found
    *_, drift = values
    again = _travels(fit, t_end, values)
    moved = [
        _estimate(one, value, error, drift)
        for one, value, error in zip(fit.estimates, values[:-1].tolist(), spread, strict=True)
    ]
    fit = replace(fit, predicted=tuple(again.tolist()), estimates=tuple(moved))
    title = if_drifting(candidate.title, float(drift), "trial")
    return replace(candidate, fit=fit, drifts=title)


def _travels(fit: TravelFit, t_end: float, values: Array) -> Array:
    """Return the travels [m] of a law with values of what was fitted, and a drift."""
    model = TravelModel(fit.law, [one.path for one in fit.estimates], t_end)
    law = model.with_values(values[:-1].tolist())
    scaled = [
        (path, float(value))
        for path, quantity, value in parameters(law, "friction")
        if quantity.scale.startswith(FORCES) and value
    ]
    found = []
    for trial, share in zip(fit.trials, along(len(fit.trials)), strict=True):
        factor = 1.0 + float(values[-1]) * share
        own = vary(law, "friction", {path: factor * value for path, value in scaled})
        found.append(TravelModel(own, [], t_end).travel(trial, []))
    return np.array(found)


def _slopes(fit: TravelFit, t_end: float, values: Array, here: Array) -> Array:
    columns = []
    for i, value in enumerate(values):
        step = STEP * (value or 1.0) if i < len(values) - 1 else STEP
        moved = values.copy()
        moved[i] += step
        columns.append((_travels(fit, t_end, moved) - here) / step)
    return np.column_stack(columns)


def _searched(fit: TravelFit, t_end: float) -> tuple[Array, list[float]] | None:
    """Return the values of what was fitted, and the drift, with which a law leaves least.

    And the standard errors of these beside the drift, by the last slopes.
    """
    root = np.linalg.cholesky(fit.travel_covariance(fit.variance[0]))
    values = np.array([*(one.value for one in fit.estimates), 0.0])
    measured, limits = np.array(fit.measured), [one.quantity.low for one in fit.estimates]
    for _ in range(ROUNDS):
        here = _travels(fit, t_end, values)
        slopes = np.linalg.solve(root, _slopes(fit, t_end, values, here))
        step, *_ = np.linalg.lstsq(slopes, np.linalg.solve(root, measured - here), rcond=1e-10)
        values = values + step
        values[:-1] = np.maximum(values[:-1], limits)
        if not abs(values[-1]) <= LIKELY:
            return None
        if abs(step[-1]) < SETTLED:
            covariance = np.linalg.pinv(slopes.T @ slopes, rcond=1e-10, hermitian=True)
            return values, [math.sqrt(max(one, 0.0)) for one in np.diag(covariance)[:-1]]
    return None


def _estimate(one: Estimate, value: float, error: float, drift: float) -> Estimate:
    """Return what a law with a drift leaves of a parameter, over all trials."""
    half = 2.0 * error
    drifts = one.quantity.scale.startswith(FORCES)
    ends = (value, value * (1.0 + drift)) if drifts else (value, value)
    low, high = max(min(ends) - half, one.quantity.low), max(ends) + half
    return replace(one, value=value, low=low, high=high, pieces=(), reason="")
