"""What trials at rest throughout say of friction: at least what they were held against.

No row of such a trial slips, so that a fit of sliding friction has none of it. Its force balance is
an inequality, |F| <= F_s(N), which is compared with the fitted law.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from stickslip.errors import InputError, ParameterError
from stickslip.experiments import Measurement, as_recorded, faults, noise_of, step_of, with_voltage
from stickslip.formatting import significant, with_unit
from stickslip.friction import FrictionLaw, bound
from stickslip.identification.contact_inputs import typical_inputs
from stickslip.identification.force_map.data import load_along
from stickslip.identification.results import Estimate
from stickslip.identification.series.applied_force import applied_force
from stickslip.identification.series.inverse_dynamics import known_forces, positions_of
from stickslip.mechanisms import Mechanism
from stickslip.quantities import vary

Array = NDArray[np.float64]

BRIEF = 5
"""Samples of the median that takes single ones off a force."""
NOISE = 2.0
"""Standard deviations of the noise of a force that its largest median may have of it."""


@dataclass(frozen=True, kw_only=True)
class RestingTrial:
    """A trial at rest throughout, and the friction that held it."""

    name: str
    """Of the trial."""
    held: float
    """Friction that it had at least, with the sign of the force that it balanced [N]."""
    load: float
    """Normal force then [N]."""
    mechanism: Mechanism
    """The mechanism with what the trial overrides."""
    record: Measurement
    """The trial."""


def rests(record: Measurement) -> bool:
    """Whether a record is one of a single body that rests throughout, as `check` says.

    Examples
    --------
    >>> t = np.arange(50.0)
    >>> [rests(Measurement(time=t, position=x, force=t)) for x in (0.0 * t, np.sin(t))]
    [True, False]
    """
    if record.time is None or record.joints:
        return False
    return any(one.kind == "constant" for one in faults(record))


def resting_trials(
    mechanism: Mechanism, measurement: Measurement, offset: float = 0.0
) -> Iterator[RestingTrial]:
    """Yield the trials at rest among those of a measurement, under a force that is known.

    The constant force beside friction [N] is taken off what was applied.

    Examples
    --------
    >>> from stickslip import Axis
    >>> t = np.arange(0.0, 4.0, 0.01)
    >>> moving = Measurement(time=t, position=np.sin(t), force=np.cos(t))
    >>> resting = Measurement(time=t, position=0.0 * t, force=3.0 * np.sin(t), name="held")
    >>> (one,) = resting_trials(Axis(inertia=1.0), Measurement(trials=(moving, resting)))
    >>> one.name, round(one.held, 2)
    ('held', 3.0)
    """
    if not measurement.trials:
        return
    for number, record in enumerate(measurement.records(), 1):
        if not rests(record):
            continue
        set_up = vary(mechanism, "mechanism", record.overrides)
        try:
            friction = _friction(set_up, record) - offset
            load = load_along(set_up, record, friction.size)
        except InputError:  # no force is known
            continue
        steady = scipy.ndimage.median_filter(friction, BRIEF, mode="nearest")
        most = int(np.argmax(np.abs(steady)))
        doubt = NOISE * noise_of(friction, step_of(friction))
        held = max(abs(float(steady[most])) - doubt, 0.0)
        if held > 0.0:
            yield RestingTrial(
                name=record.name or f"trial {number}",
                held=math.copysign(held, steady[most]),
                load=float(load[most]),
                mechanism=set_up,
                record=record,
            )


def _friction(mechanism: Mechanism, given: Measurement) -> Array:
    """Return friction (n,) [N] of a body at rest: measured, or what balances all other forces."""
    if "friction" in given.quantities():
        return np.array(np.broadcast_to(given.values("friction"), np.asarray(given.time).shape))
    record = with_voltage(mechanism, given, "zero")
    set_up = as_recorded(mechanism, record)
    x = positions_of(record)
    applied = applied_force(set_up, record)
    _, rest = known_forces(set_up, x, 0.0 * x, 0.0 * x if applied is None else applied)
    return rest


def said_of_rests(
    law: FrictionLaw, estimates: Sequence[Estimate], trials: Sequence[RestingTrial]
) -> tuple[list[str], list[str]]:
    """Return that trials at rest bound friction there, and which of them a fitted law contradicts.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> t = np.arange(50.0)
    >>> held = RestingTrial(
    ...     name="b",
    ...     held=3.0,
    ...     load=1.0,
    ...     mechanism=Axis(inertia=1.0),
    ...     record=Measurement(time=t, position=0.0 * t),
    ... )
    >>> agree, against = said_of_rests(Coulomb(kinetic_coefficient=2.0), (), [held])
    >>> agree, against[0].startswith("b rested throughout under up to 3.00 N, more than the 2.00")
    ([], True)
    """
    agree, against = [], []
    for trial in trials:
        unit = trial.record.unit("force")
        level, doubt = _level(law, estimates, trial)
        held, fitted = (with_unit(significant(one), unit) for one in (abs(trial.held), level))
        rested = f"{trial.name} rested throughout under up to {held}"
        if abs(trial.held) > level + doubt:
            against.append(
                f"{rested}, more than the {fitted} that the fitted law holds at"
                " rest: fit a law with a static level of its own, or check the force and the load"
                " of that trial."
            )
        else:
            unsure = ", whose interval includes that" if abs(trial.held) > level else ""
            agree.append(
                f"{rested}: friction at rest is at least {held} (fitted: {fitted}{unsure})."
            )
    return agree, against


def _level(
    law: FrictionLaw, estimates: Sequence[Estimate], trial: RestingTrial
) -> tuple[float, float]:
    """Return the break-away level of a law under a trial, and half the width of its interval."""
    inputs = typical_inputs(law, trial.mechanism, trial.record)
    side = 1 if trial.held > 0.0 else -1

    def at(one: FrictionLaw) -> float:
        return float(bound(one, inputs).towards(side).break_away(trial.load))

    level = at(law)
    away = []
    for one in estimates:
        if one.path.startswith("friction."):
            end = one.high if math.isfinite(one.high) else 2.0 * abs(one.value) + 1.0
            try:
                off = at(vary(law, "friction", {one.path: end})) - level
            except ParameterError:  # an interval may end beyond what the parameter can be
                off = math.inf
            away.append(off if one.bounded or off == 0.0 else math.inf)
    return level, math.hypot(*away)
