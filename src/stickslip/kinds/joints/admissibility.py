"""Which fits to records may be taken, and which records no law explains."""

import math
from collections.abc import Iterator
from typing import Final

import numpy as np
from numpy.typing import NDArray

from stickslip.contact_inputs import DRIVES
from stickslip.experiments import Checks, Measurement, as_recorded
from stickslip.formatting import number, percent, quantity
from stickslip.identification import SEPARABLE, Estimate, RecordFit, step_intervals
from stickslip.kinds.joints.joint_verdict import RecordCandidate
from stickslip.mechanisms import motor_of
from stickslip.quantities import fields_of
from stickslip.selection import one_way, traded

Array = NDArray[np.float64]

STANDARD: Final = {"standard": 1.0, "rounding": 1.0 / math.sqrt(3.0), "interval": 0.5}
"""Standard uncertainty over the one stated: of an even spread, and of a 95 % interval."""
NOTHING: Final = 0.5
"""Held-out error over the variation of what is predicted from which a law explains nothing."""
MANY: Final = 10.0
"""Held-out error over its stated uncertainty from which readings contradict the law ..."""
VISIBLE: Final = 0.1
"""... if it is also this share of the variation: a law that leaves 1 % of the variance predicts."""


SHARES: Final = (
    ("motor_friction", "external_friction"),
    ("motor_static_friction", "external_static_friction"),
)
"""Parameters of gears that are one where all of them are alike."""
MOTOR: Final = ("mechanism.drive.resistance", "mechanism.drive.torque_constant")
"""Constants of a motor, whose back-EMF brakes like viscous friction."""


def objection(fit: RecordFit, *, shown: bool = False) -> str:
    """Return why a fit may not be taken, in words; empty if it may.

    Only the law's parameters are judged: an offset may well be 0. An interval that reaches 0 counts
    only where the law does not predict better than simpler ones (`shown`): that of one of several
    correlated parameters is wide though all of them are needed together.
    """
    reasons = [fit.search_failure.rstrip(".")] if fit.search_failure else []
    reasons += [reason for _, reason in _unsure(fit, shown=shown)]
    reasons += _alike(fit)
    reasons += _braked(fit)
    if fit.one_way:
        reasons.append(
            "a constant force and the friction level cannot be told apart: the rows that are"
            " compared slip in one direction only"
        )
    if fit.inference.condition > SEPARABLE:
        condition = number(fit.inference.condition, 2)
        reasons.append(f"condition number {condition}, above {number(SEPARABLE)}")
    return "; ".join(reasons)


def unidentified(fit: RecordFit) -> frozenset[str]:
    """Return the fields of a fitted law that the record does not tell, alone or from another one.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Axis, CoulombViscous, Measurement, QuadraticDrag, fit
    >>> v = np.linspace(0.1, 1.0, 40)
    >>> table = Measurement(velocity=v, friction=2.0 + 3.0 * v + 0.01 * np.cos(40.0 * v))
    >>> sorted(unidentified(fit(Axis(inertia=1.0), QuadraticDrag, table)))
    ['quadratic_coefficient']
    """
    found = {path for path, _ in _unsure(fit, shown=False)}
    if fit.inference.condition > SEPARABLE:
        found |= {path for path in traded(fit) if path.startswith("friction.")}
    return frozenset(path.removeprefix("friction.") for path in found)


def _unsure(fit: RecordFit, *, shown: bool) -> Iterator[tuple[str, str]]:
    """Yield the paths of a law's parameters that are not identified, and in which way."""
    steps = step_intervals(fit.free_parameters, fit.optimum.best, fit.inference)
    for estimate in fit.estimates:
        path, symbol = estimate.path, f"${estimate.quantity.symbol}$"
        if not path.startswith("friction."):
            continue
        if path in fit.at_bounds:
            yield path, f"{symbol} {_ran(fit, estimate)}"
        elif estimate.reason:
            yield path, f"{symbol} is not identified: {estimate.reason}"
        elif path in steps and steps[path][1] <= 0.0:
            step, low, high = steps[path]
            if not (shown and math.isfinite(high - low)):
                yield path, _no_step(step, low, high, estimate.quantity.unit)
        elif estimate.low <= 0.0 <= estimate.high and not shown:
            yield path, f"the interval of {symbol} includes 0"


def _alike(fit: RecordFit) -> list[str]:
    """Return that no share of a torque of a gear differs from that of the other torque, if so.

    The gear then loses them of the torque that it transmits, as a law with fewer parts says.
    """
    paths, symbols = fit.free_parameters.paths, {e.path: e.quantity.symbol for e in fit.estimates}
    found = []
    for motor, external in SHARES:
        if f"friction.{motor}" not in paths or f"friction.{external}" not in paths:
            continue
        pair = [paths.index(f"friction.{name}") for name in (motor, external)]
        row = np.zeros(len(paths))
        row[pair] = 1.0, -1.0
        apart, half = float(row @ fit.values), fit.inference.half_width(row)
        if abs(apart) > half:
            return []
        one, other = (symbols[paths[i]] for i in pair)
        found.append(f"${one}$ and ${other}$ are not shown to differ")
    return found


def _braked(fit: RecordFit) -> list[str]:
    """Return that the constants of a motor take the place of viscous friction, where they may.

    A law whose slope is known, and that no torque of the motor loads, leaves all of the brake of
    recorded voltages to back-EMF: both constants then follow from the law, and their intervals do
    not show it. An open winding does not brake.
    """
    motor, paths = motor_of(fit.mechanism), fit.free_parameters.paths
    if motor is None or motor.back_emf_constant is not None or not {*MOTOR} <= {*paths}:
        return []
    records, fields = fit.measurement.records(), fields_of(type(fit.law))
    slopes = [name for name, one in fields.items() if one.scale.startswith("slope")]
    motors = [motor_of(as_recorded(fit.mechanism, record)) for record in records]
    if (
        {*paths}.intersection(f"friction.{name}" for name in slopes)
        or {*DRIVES}.intersection(fit.law.inputs)
        or "current" in fit.measurement.quantities()
        or any(one is not None and one.current_limit == 0.0 for one in motors)
    ):
        return []
    held = any(getattr(fit.law, name) for name in slopes)
    what = "has the viscous part that was held" if held else "has no viscous part"
    return [f"$R$ and $k_t$ hold only if friction {what}"]


def _no_step(step: float, low: float, high: float, unit: str) -> str:
    if not math.isfinite(high - low):
        return "the step from static to kinetic friction is not identified"
    shown, first, last = (number(value, 2) for value in (step, low, high))
    shown += "" if unit in {"", "1"} else f" {unit}"
    return f"the interval of its static step of {shown} ({first} to {last}) includes 0"


def _ran(fit: RecordFit, estimate: Estimate) -> str:
    item = fit.free_parameters.items[fit.free_parameters.paths.index(estimate.path)]
    side = fit.at_bounds[estimate.path]
    if item.above and side == "lower":
        return "is not above the kinetic level"
    if side == "lower" and item.low == 0.0:
        return "is estimated as 0"
    return f"reached its {side} bound of {quantity(estimate.value, estimate.quantity.unit, 2)}"


def standard_uncertainty(measurement: Measurement, quantity: str) -> float:
    """Return the largest stated standard uncertainty of a quantity, 0 if none is stated.

    Examples
    --------
    >>> read = Measurement(velocity=[0.1, 0.2], friction=[2.0, 2.1], uncertainty={"friction": 0.1})
    >>> standard_uncertainty(read, "friction"), standard_uncertainty(read, "velocity")
    (0.1, 0.0)
    """
    stated = [
        record.uncertainty[quantity] * STANDARD[record.uncertainty_kind]
        for record in measurement.records()
        if quantity in record.uncertainty
    ]
    return max(stated, default=0.0)


def unexplained(candidate: RecordCandidate, variation: float, *, uncertainty: float) -> str:
    """Return in what a record contradicts even the closest law; empty if it does not."""
    share = candidate.score / variation if variation > 0.0 else 0.0
    assert candidate.fit is not None
    said = (
        f"the held-out error of the best, {candidate.title}, is {percent(share)} of the variation"
        f" of the {candidate.fit.problem.quantity} itself"
    )
    if uncertainty > 0.0 and candidate.score > MANY * uncertainty and share > VISIBLE:
        times = number(candidate.score / uncertainty, 2)
        return f"{said}, and {times} times the stated uncertainty"
    return said if share > NOTHING else ""


def resting(checks: Checks) -> str:
    """Return that the body rests for most of a record, as what follows a fault; empty if not.

    Examples
    --------
    >>> import numpy as np
    >>> from stickslip import Measurement, check
    >>> t = np.arange(0.0, 10.0, 0.01)
    >>> record = Measurement(time=t, position=0.1 * np.clip(t - 9.5, 0.0, None))
    >>> resting(check(record))
    '; the body rests for 95 % of the record'
    """
    shares = [one.numbers.get("share", 0.0) for one in checks.of("rests")]
    if not shares or any(one.severity == "info" for one in checks.of("rests")):
        return ""
    return f"; the body rests for {percent(min(shares))} of the record"


def variation_of(candidate: RecordCandidate) -> float:
    """Return the root mean square of what is predicted, about what needs no friction law.

    That is its mean, the sensor's offset; 0 where it was measured in one direction only.
    """
    fit = candidate.fit
    assert fit is not None
    measured = fit.problem.measured
    centre = 0.0 if one_way(fit.measurement) else float(np.mean(measured))
    return float(np.sqrt(np.mean((measured - centre) ** 2)))
