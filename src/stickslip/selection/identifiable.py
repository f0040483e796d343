"""Which estimates of a fit may be quoted one by one, and what limits their intervals."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from stickslip.formatting import capital, percent, quantity
from stickslip.identification import (
    READINGS,
    TOGETHER,
    Estimate,
    Fit,
    ModelError,
    RecordFit,
    step_intervals,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters


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


def disturbing(fit: RecordFit) -> tuple[ModelError, ...]:
    """Return what was found beside the law that leaves no estimate, and no prediction, sure."""
    return tuple(one for one in fit.model_errors if one.moved is None and one.kind != "law")


def moved_by_errors(fit: RecordFit) -> frozenset[str]:
    """Return the paths of the estimates that an error of the model moves out of their intervals.

    All of them, where an error does not say which.
    """
    found: set[str] = set()
    for error in fit.model_errors:
        found |= set(fit.free_parameters.paths if error.moved is None else error.moved)
    return frozenset(found)


def of_open_steps(fit: RecordFit) -> frozenset[str]:
    """Return the paths of static levels whose step the record does not tell from 0, if any.

    And of the velocities at which they fade: of a step that is not there these say nothing, nor
    does the step that fades at the least or the largest that was searched.
    """
    steps = step_intervals(fit.free_parameters, fit.optimum.best, fit.inference)
    speeds = {
        one.path
        for one in fit.free_parameters.items
        if one.path.startswith("friction.") and one.quantity.scale == "speed"
    }
    faded = bool(speeds & {*fit.at_bounds})
    found = {path for path, (_, low, _) in steps.items() if low <= 0.0 or faded}
    return frozenset(found | speeds if found else ())


def settled_estimates(fit: RecordFit, equals: Sequence[RecordFit] = ()) -> tuple[Estimate, ...]:
    """Return the estimates that stand each for itself, the surest first.

    Their intervals are bounded, do not hold 0 and are not as wide as they are large, they are no
    offset and of no step in doubt, none trades off with another, no error of the model moves them,
    and none has another value by fits of laws that are not distinguished from this.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb, Measurement, fit
    >>> v = np.linspace(-1.0, 1.0, 40)
    >>> friction = 2.0 * np.sign(v) + 0.01 * np.cos(40.0 * v)
    >>> found = fit(Axis(inertia=1.0), Coulomb, Measurement(velocity=v, friction=friction))
    >>> [estimate.quantity.symbol for estimate in settled_estimates(found)]
    ['mu_k']
    """
    apart = traded(fit) | moved_by_errors(fit) | of_open_steps(fit)
    known = [
        e
        for e in fit.estimates
        if e.bounded and not e.low <= 0.0 <= e.high and half_of(e) < abs(e.value)
        if "offset" not in e.path and e.path not in apart
        if not any(_differs(e, other) for fit in equals for other in fit.estimates)
    ]
    return tuple(sorted(known, key=lambda e: half_of(e) / max(abs(e.value), 1e-300)))


def _differs(one: Estimate, other: Estimate) -> bool:
    """Return whether two estimates are of one quantity, and their intervals lie apart."""
    if not other.bounded or (one.path, one.quantity) != (other.path, other.quantity):
        return False
    return max(one.low, other.low) > min(one.high, other.high)


def limit_of(fit: Fit[Any], estimate: Estimate) -> str:
    """Return what limits the interval of an estimate, as a sentence; empty if nothing was stated.

    It is the record or the readings, or the uncertainty of the mechanism.
    """
    if not estimate.sources:
        return ""
    return limit_text(estimate, fit.rig_uncertainties, fit.readings)


def limits_of(fit: Fit[Any]) -> tuple[str, ...]:
    """Return what limits each interval of a fit, with the path of the parameter."""
    limits = {one.path: limit_of(fit, one).strip() for one in fit.estimates}
    return tuple(f"{path}: {limit}" for path, limit in limits.items() if limit)


def limit_text(
    estimate: Estimate, stated: Sequence[tuple[Mechanism, Mapping[str, float]]], readings: str
) -> str:
    """Return which source makes most of an interval, as a sentence; empty if there is only one.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, fit
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(
    ...     travel=0.2, uncertainty=0.001, parameter_uncertainties={"stiffness": 3.0}
    ... )
    >>> (level,) = fit(rig, Coulomb, reading).estimates
    >>> limit_text(level, [(rig, {"mechanism.stiffness": 3.0})], "the reading")
    ' The stiffness (3 %) contributes more to its uncertainty than the reading.'
    """
    rig = {path: error for path, error in estimate.sources.items() if path != READINGS}
    if not rig:
        return ""
    path = max(rig, key=lambda one: rig[one])
    known = f"the {path.rpartition('.')[2].replace('_', ' ')}{_known_to(path, stated)}"
    if rig[path] > estimate.sources[READINGS]:
        return f" {capital(known)} contributes more to its uncertainty than {readings}."
    verb = "contribute" if readings.endswith("s") else "contributes"
    return f" {capital(readings)} {verb} more to its uncertainty than {known}."


def _known_to(path: str, stated: Sequence[tuple[Mechanism, Mapping[str, float]]]) -> str:
    """Return the uncertainty of a parameter in brackets: its share, or itself if that differs."""
    pairs = set()
    for mechanism, doubts in stated:
        known = {p: (value, q.unit) for p, q, value in parameters(mechanism, "mechanism")}
        if path in doubts:
            pairs.add((doubts[path], *known[path]))
    shares = {percent(doubt / abs(value)) for doubt, value, _ in pairs if value}
    if len(shares) == 1:
        return f" ({shares.pop()})"
    sizes = {quantity(doubt, unit, 2) for doubt, _, unit in pairs}
    return f" ({sizes.pop()})" if len(sizes) == 1 else ""
