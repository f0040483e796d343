"""Estimates with their doubt, and what a record cannot tell, in words."""

import math
from collections.abc import Collection, Mapping, Sequence, Set

import numpy as np
from numpy.typing import NDArray

from stickslip.friction import FrictionLaw, Laws
from stickslip.identify.fits.levenberg_marquardt import ResidualJacobian
from stickslip.identify.fits.parameters import WIDE, FreeParameter, FreeParameters
from stickslip.identify.fits.results import READINGS, Estimate
from stickslip.identify.fits.settings import NEGLIGIBLE, TAKES_PART
from stickslip.identify.fits.shooting.jackknife import Inference
from stickslip.mechanisms import Mechanism
from stickslip.show import formatting
from stickslip.show.formatting import fixed, number

Array = NDArray[np.float64]

INTERVAL = "95 %"
MANY = 30.0
"""An interval that goes so many times the value to either side is none, or as many times
what the record suggests if that is more, nor is one of a logarithm that goes by this factor."""
TOGETHER = 0.95
"""Correlation from which two estimates are one number and a split of it."""
SEPARABLE = 300.0
"""Condition of the scaled slopes beyond which estimates are not separable."""


def bounds_met(free_parameters: FreeParameters, values: Array) -> Mapping[str, str]:
    """Return which unknowns ended at a bound, by path: ``"lower"`` or ``"upper"``."""
    found = {}
    low, high = free_parameters.limits()
    at = free_parameters.coordinates(values)
    for i, item in enumerate(free_parameters.items):
        size = max(abs(item.start), 1e-300) if not item.log else 1.0
        if at[i] <= low[i] + NEGLIGIBLE * size:
            found[item.path] = "lower"
        elif at[i] >= high[i] - NEGLIGIBLE * size:
            found[item.path] = "upper"
    return found


def estimates_of(
    free_parameters: FreeParameters,
    jacobian: ResidualJacobian,
    inference: Inference,
    at_bounds: Mapping[str, str],
) -> tuple[Estimate, ...]:
    """Return the estimates with 95 % intervals, and why an interval is not bounded."""
    found = []
    for i, item in enumerate(free_parameters.items):
        value, half = float(jacobian.values[i]), float(inference.half_widths[i])
        low, high, reason = value - half, value + half, ""
        if item.path in at_bounds:
            low, high = -math.inf, math.inf
            reason = _bound_reason(item, at_bounds[item.path], value)
        elif not math.isfinite(half):
            low, high, reason = -math.inf, math.inf, inference.reasons[i]
        elif item.log:
            spread = half / value
            low, high = value * math.exp(-min(spread, 700.0)), value * math.exp(min(spread, 700.0))
            if spread > math.log(MANY):
                low, high = -math.inf, math.inf
                reason = "the record does not determine its order of magnitude"
        elif half > MANY * max(abs(value), (item.high - item.low) / (2.0 * WIDE)):
            low, high = -math.inf, math.inf
            reason = f"the record does not determine its magnitude, ± {with_unit(half, item, 2)}"
        found.append(
            Estimate(
                path=item.path,
                quantity=item.quantity,
                value=value,
                low=low,
                high=high,
                interval=INTERVAL,
                reason=reason,
                sources={} if reason else _sources(inference, i),
            )
        )
    return tuple(found)


def _sources(inference: Inference, index: int) -> dict[str, float]:
    """Return the standard errors of an estimate by where they come from; none without others."""
    if not inference.held:
        return {}
    own = {READINGS: math.sqrt(max(inference.covariance[index, index], 0.0))}
    return own | {
        path: float(np.linalg.norm(moved[:, index])) for path, moved in inference.held.items()
    }


def _bound_reason(item: FreeParameter, side: str, value: float) -> str:
    if item.above and side == "lower":
        return f"it is not above the {in_words(item.above)}"
    return f"it reached its {side} bound, {with_unit(value, item)}"


def with_unit(value: float, item: FreeParameter, digits: int = 3) -> str:
    """Return a value of an unknown with its unit."""
    return formatting.with_unit(number(value, digits), item.quantity.unit)


def in_words(path: str) -> str:
    """Return a parameter in words.

    Examples
    --------
    >>> in_words("friction.kinetic_coefficient")
    'kinetic coefficient'
    >>> in_words("measurement.offset.force.elbow")
    'constant force'
    """
    if path.startswith("measurement.offset.force."):
        return "constant force"
    return formatting.parameter_words(path)


def step_intervals(
    free_parameters: FreeParameters, jacobian: ResidualJacobian, inference: Inference
) -> Mapping[str, tuple[float, float, float]]:
    """Return by path surplus, lower and upper end, for unknowns that stand above another."""
    found = {}
    paths = list(free_parameters.paths)
    for i, item in enumerate(free_parameters.items):
        if item.above not in paths:
            continue
        j = paths.index(item.above)
        row = np.zeros(len(paths))
        row[[i, j]] = 1.0, -1.0
        half = inference.half_width(row)
        step = float(jacobian.values[i] - jacobian.values[j])
        found[item.path] = (step, step - half, step + half)
    return found


def sentences_of(
    free_parameters: FreeParameters,
    jacobian: ResidualJacobian,
    inference: Inference,
    at_bounds: Mapping[str, str],
    estimates: Sequence[Estimate],
) -> tuple[str, ...]:
    """Return what the record cannot tell."""
    lines = [
        f"{in_words(estimate.path)} ({estimate.quantity.symbol}) is not identified:"
        f" {estimate.reason}."
        for estimate in estimates
        if estimate.reason and not estimate.quantity.nuisance
    ]
    for path, (step, low, high) in step_intervals(free_parameters, jacobian, inference).items():
        if path not in at_bounds and low <= 0.0 and math.isfinite(high - low):
            item = free_parameters.items[free_parameters.paths.index(path)]
            lines.append(
                f"The step from {item.quantity.symbol} to sliding friction is not distinguished"
                f" from 0: {with_unit(step, item)}, interval {number(low)} to {number(high)}."
            )
    known = {one.path for one in estimates if one.bounded and one.path not in at_bounds}
    lines += _together(free_parameters, inference, known)
    if inference.condition > SEPARABLE:
        symbols = ", ".join(_inseparable(free_parameters, jacobian))
        lines.append(
            f"This record cannot separate {symbols}: the condition number is"
            f" {number(inference.condition, 2)}, above the limit of {number(SEPARABLE)}."
        )
    return tuple(lines)


def _inseparable(free_parameters: FreeParameters, jacobian: ResidualJacobian) -> list[str]:
    """Return the symbols of what the record separates least: what takes part in that direction."""
    quantities = [item.quantity for item in free_parameters.items]
    symbols = ["links" if one.nuisance else one.symbol for one in quantities]
    size = np.linalg.norm(jacobian.slopes, axis=0)
    seen = np.flatnonzero(size > 0.0)
    weakest = np.linalg.svd(jacobian.slopes[:, seen] / size[seen], full_matrices=False)[2][-1]
    found = [*dict.fromkeys(symbols[k] for k in seen[np.abs(weakest) > TAKES_PART])]
    return found if len(found) > 1 else [*dict.fromkeys(symbols)]


def offset_left_out(
    law: FrictionLaw | Laws, mechanism: Mechanism, paths: Collection[str]
) -> tuple[str, ...]:
    """Return a sentence where a level for each direction stands for a constant force as well.

    Of the parameters with `paths` it is none.

    Half the sum of the levels acts against the motion and half their difference always one way, so
    a constant force beside them is the same number twice.
    """
    constants = ("mechanism.offset", "measurement.offset.friction", "offset")
    fitted = any(path in paths for path in constants)
    if fitted or isinstance(law, Laws) or not law.directional:
        return ()
    own = float(getattr(mechanism, "offset", 0.0))
    unit = "N m" if getattr(mechanism, "rotary", False) else "N"
    held = formatting.with_unit(number(own), unit) if own else "0"
    return (
        "A constant force (gravity, a cable, a sensor offset) and different levels in the two"
        f" directions cannot be separated: the offset is fixed at {held} and absorbed"
        " into the two levels.",
    )


def _together(free_parameters: FreeParameters, inference: Inference, known: Set[str]) -> list[str]:
    """Return sentences on pairs of estimates that move together, of those that are identified."""
    lines = []
    # what the mechanism's uncertainty moves together is not for the record to separate
    table = inference.of_record.correlation
    for i, one in enumerate(free_parameters.items):
        for j, other in enumerate(free_parameters.items[:i]):
            free = one.path in known and other.path in known
            told = not (one.quantity.nuisance or other.quantity.nuisance)
            if free and told and np.isfinite(table[i, j]) and abs(table[i, j]) > TOGETHER:
                lines.append(
                    f"{other.quantity.symbol} and {one.quantity.symbol} are strongly correlated"
                    f" ({fixed(table[i, j], 2)}): a combination of them is known better than"
                    " either one."
                )
    return lines
