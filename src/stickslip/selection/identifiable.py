"""Which estimates of a fit may be quoted one by one."""

import numpy as np

from stickslip.identification import TOGETHER, Estimate, RecordFit


def half_of(estimate: Estimate) -> float:
    """Return half the width of a bounded interval."""
    return 0.5 * (estimate.high - estimate.low)


def traded(fit: RecordFit) -> frozenset[str]:
    """Return the paths of what trades off with another unknown: only together they are known."""
    table = np.abs(fit.inference.of_record.correlation)
    found = set()
    for i, one in enumerate(fit.free_parameters.paths):
        for j, other in enumerate(fit.free_parameters.paths[:i]):
            if table[i, j] > TOGETHER:
                found |= {one, other}
    return frozenset(found)


def moved_by_errors(fit: RecordFit) -> frozenset[str]:
    """Return the paths of the estimates that an error of the model moves out of their intervals.

    All of them, where an error does not say which.
    """
    found: set[str] = set()
    for error in fit.model_errors:
        found |= set(fit.free_parameters.paths if error.moved is None else error.moved)
    return frozenset(found)


def settled_estimates(fit: RecordFit) -> tuple[Estimate, ...]:
    """Return the estimates that stand each for itself, the surest first.

    Their intervals are bounded and do not hold 0, they are no offset, none trades off with another,
    and no error of the model moves them.

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
        e
        for e in fit.estimates
        if e.bounded and not e.low <= 0.0 <= e.high
        if "offset" not in e.path and e.path not in apart
    ]
    return tuple(sorted(known, key=lambda e: half_of(e) / max(abs(e.value), 1e-300)))
