"""Which estimates of a fit may be quoted one by one, and what limits their intervals."""

from collections.abc import Mapping, Sequence
from typing import Any

from stickslip.identify.fits import (
    READINGS,
    Estimate,
    Fit,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters
from stickslip.show.formatting import capital, percent, quantity


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
