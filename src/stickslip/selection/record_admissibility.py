"""Which fits to records may be taken, and why not."""

import math

from stickslip.experiments.wording import number, quantity
from stickslip.identification.doubts import MOST_CONDITION, step_intervals
from stickslip.identification.record_fit import RecordFit
from stickslip.identification.results import Estimate

__all__ = ["objection"]

OPEN = "open"
"""What reasons of intervals say where an order of magnitude is not known."""


def objection(fit: RecordFit) -> str:
    """Return why a fit may not be taken, in words; empty if it may.

    Only the law's parameters are judged: an offset may well be 0.
    """
    reasons = [fit.search_failure.rstrip(".")] if fit.search_failure else []
    seen = fit.found.best
    steps = step_intervals(fit.unknowns, seen, fit.inference)
    for estimate in fit.estimates:
        if not estimate.path.startswith("friction."):
            continue
        symbol = f"${estimate.quantity.symbol}$"
        if estimate.path in fit.at_bounds:
            reasons.append(f"{symbol} {_ran(fit, estimate)}")
        elif estimate.reason:
            reasons.append(f"{symbol} is undetermined: {estimate.reason}")
        elif estimate.path in steps and steps[estimate.path][1] <= 0.0:
            reasons.append(_no_step(*steps[estimate.path], estimate.quantity.unit))
        elif estimate.low <= 0.0:
            reasons.append(f"the interval of {symbol} covers 0")
    if fit.inference.condition > MOST_CONDITION:
        condition = number(fit.inference.condition, 2)
        reasons.append(f"condition number {condition}, above {MOST_CONDITION:g}")
    return "; ".join(reasons)


def _no_step(step: float, low: float, high: float, unit: str) -> str:
    if not math.isfinite(high - low):
        return "its step is not bounded"
    shown, first, last = (number(value, 2) for value in (step, low, high))
    shown += "" if unit in {"", "1"} else f" {unit}"
    return f"its step of {shown} ({first} to {last}) covers 0"


def _ran(fit: RecordFit, estimate: Estimate) -> str:
    item = fit.unknowns.items[fit.unknowns.paths.index(estimate.path)]
    side = fit.at_bounds[estimate.path]
    if item.above and side == "lower":
        return "shows no step above the kinetic level"
    if side == "lower" and item.low == 0.0:
        return "went to 0"
    return f"ran to its {side} bound of {quantity(estimate.value, estimate.quantity.unit, 2)}"
