"""Break-away levels that were given, not fitted, and that the measurement refutes directly."""

from collections.abc import Collection

import numpy as np

from stickslip.errors import InputError, ParameterError
from stickslip.experiments import levels_at
from stickslip.formatting import number, quantity
from stickslip.friction import FrictionLaw, anywhere, bound
from stickslip.identification import RecordFit, balanced
from stickslip.mechanisms import Mechanism, stops_of
from stickslip.quantities import fields_of, parameters, vary

STEP = 1e-3
"""Relative change of a parameter that shows whether the break-away level depends on it."""
CLEAR = 0.2
"""Share by which friction at rest must stay below a level that is said to be refuted."""
RESTED = 5
"""Samples of a rest at least."""
DEPARTURES = 2
"""Rests that ended in motion at least: one could be a blow or a slip of the sensor."""


def given_level(law: FrictionLaw, held: Collection[str]) -> str:
    """Return the name of the held parameter that sets the break-away level of a law.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.3)
    >>> given_level(law, ["static_coefficient"]), given_level(law, ["kinetic_coefficient"])
    ('static_coefficient', '')
    """
    level, found = anywhere(law).break_away(1.0), []
    for path, _, value in parameters(law, "friction"):
        for factor in (1.0 + STEP, 1.0 - STEP):
            try:
                other = vary(law, "friction", {path: factor * value})
            except ParameterError:  # a level at rest may not fall below that of sliding
                continue
            if anywhere(other).break_away(1.0) != level:
                found.append(path.rpartition(".")[2])
                break
    return found[0] if len(found) == 1 and found[0] in held else ""


def level_text(mechanism: Mechanism, friction: float, load: float) -> str:
    """Return friction at rest as levels of a law on this mechanism are given, with its unit.

    Examples
    --------
    >>> from stickslip import Axis, SpringBlock
    >>> level_text(SpringBlock(mass=1.0), 2.0, 10.0), level_text(Axis(inertia=1.0), 2.0, 1.0)
    ('0.2 N/N', '2 N')
    """
    levels = levels_at(mechanism)
    if levels == "per load":
        return f"{number(friction / load)} N/N"
    return quantity(friction, "N m" if levels == "torques" else "N")


def refuted_by_record(fit: RecordFit) -> str:
    """Return that a body broke away below a break-away level that was given.

    At rest, friction balances all other forces, which inverse dynamics knows. How large it became
    before the body moved on is the break-away level or, as a sensor sees motion late, more than it.
    """
    law, mechanism = fit.law, fit.mechanism
    free = {estimate.path for estimate in fit.estimates}
    paths = [path for path, _, _ in parameters(law, "friction") if path not in free]
    name = given_level(law, [path.rpartition(".")[2] for path in paths])
    if not name or law.states or stops_of(mechanism):
        return ""
    try:
        segments = balanced(mechanism, fit.measurement, hold="first")
    except InputError:  # too short, or never moves
        return ""
    levels, loads, laws = [], [], []
    for one in segments:
        if one.resting is None or one.held is None:
            continue
        edges = np.diff(one.resting.astype(int), prepend=0, append=0)
        for first, end in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
            if end == len(one.resting):  # the end of the record is no departure
                continue
            if end - first >= RESTED:
                friction, load = np.abs(one.held[first:end]), one.path.load[first:end]
                at = int(np.argmax(friction / load))
                levels.append(float(friction[at]))
                loads.append(float(load[at]))
                here = {name: float(x[first + at]) for name, x in one.path.inputs.items()}
                laws.append(bound(law, here))
    if len(levels) < DEPARTURES:
        return ""
    at = int(np.argmax(np.divide(levels, loads)))
    if levels[at] >= (1.0 - CLEAR) * float(laws[at].break_away(loads[at])):
        return ""
    known = level_text(mechanism, levels[at], loads[at])
    return (
        f"the {given_text(law, name)} contradicts the record: friction at rest was at most {known}"
    )


def given_text(law: FrictionLaw, name: str) -> str:
    """Return a value that was given, with symbol and unit, as part of a sentence."""
    of = fields_of(type(law))[name]
    return f"given ${of.symbol}$ = {quantity(getattr(law, name), of.unit)}"
