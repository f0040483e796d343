"""Which estimates of a fit may be quoted one by one."""

from typing import Any

import numpy as np

from stickslip.identification import TOGETHER, Estimate, Fit, RecordFit
from stickslip.selection.limits import limit_text

__all__ = ["half_of", "limit_of", "limits_of", "moved_by_errors", "settled_estimates", "traded"]


def half_of(estimate: Estimate) -> float:
    """Return half the width of a bounded interval."""
    return 0.5 * (estimate.high - estimate.low)


def limit_of(fit: Fit[Any], estimate: Estimate) -> str:
    """Return what limits the interval of an estimate, as a sentence; empty if nothing was stated.

    It is the record or the readings, or the uncertainty of the mechanism.

    Parameters
    ----------
    fit : Fit
        The fit, with its record or readings.
    estimate : Estimate
        One of its estimates, with the sources of its interval.

    Returns
    -------
    str
        The sentence.
    """
    if not estimate.sources:
        return ""
    return limit_text(estimate, fit.rig_uncertainties, fit.readings)


def limits_of(fit: Fit[Any]) -> tuple[str, ...]:
    """Return what limits each interval of a fit, with the path of the parameter."""
    limits = {one.path: limit_of(fit, one).strip() for one in fit.estimates}
    return tuple(f"{path}: {limit}" for path, limit in limits.items() if limit)


def traded(fit: RecordFit) -> frozenset[str]:
    """Return the paths of what trades off with another unknown: only together they are known."""
    table = np.abs(fit.inference.of_record.correlation)
    found = set()
    for i, one in enumerate(fit.unknowns.paths):
        for j, other in enumerate(fit.unknowns.paths[:i]):
            if table[i, j] > TOGETHER:
                found |= {one, other}
    return frozenset(found)


def moved_by_errors(fit: RecordFit) -> frozenset[str]:
    """Return the paths of the estimates that an error of the model moves out of their intervals.

    All of them, where an error does not say which.
    """
    found: set[str] = set()
    for error in fit.model_errors:
        found |= set(fit.unknowns.paths if error.moved is None else error.moved)
    return frozenset(found)


def settled_estimates(fit: RecordFit) -> tuple[Estimate, ...]:
    """Return the estimates that stand each for itself, the surest first.

    Their intervals are bounded, they are no offset, none trades off with another, and no
    error of the model moves them.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, Measurement, fit
    >>> v = np.linspace(-1.0, 1.0, 40)
    >>> friction = 2.0 * np.sign(v) + 0.01 * np.cos(40.0 * v)
    >>> found = fit(Axis(inertia=1.0), Coulomb, Measurement(velocity=v, friction=friction))
    >>> [estimate.quantity.symbol for estimate in settled_estimates(found)]
    ['mu_k']
    """
    apart = traded(fit) | moved_by_errors(fit)
    known = [
        e for e in fit.estimates if e.bounded and "offset" not in e.path and e.path not in apart
    ]
    return tuple(sorted(known, key=lambda e: half_of(e) / max(abs(e.value), 1e-300)))
