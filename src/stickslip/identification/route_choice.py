"""Which route fits a record: simulated segments, or friction that inverse dynamics derives.

A simulation of a second tells friction only where friction decides what happens in a second. At low
speed in a closed loop it does not: the force that was recorded answers to every disturbance, and
played back to the model it drives it elsewhere. Inverse dynamics, which takes the motion as it was
measured, needs no such prediction, but a motion that is measured well.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from stickslip.errors import StickslipError
from stickslip.experiments import Measurement
from stickslip.experiments.wording import number, percent
from stickslip.friction import CoulombViscous
from stickslip.identification.applied import driven
from stickslip.identification.problem import Linearised
from stickslip.identification.record_problems import Route, Wanted, prepared
from stickslip.identification.record_settings import RecordSettings
from stickslip.identification.shooting import Segment, Shooting
from stickslip.mechanisms import Mechanism

__all__ = ["RouteChoice", "choose_route", "motion_left", "serves_inverse_dynamics"]

UNPREDICTED = 0.5
"""Share of the motion left unexplained beyond which simulated segments do not serve."""
LOOKED_AT = 12
"""Segments that are simulated to see it."""
SHORTER = (0.5, 0.25, 0.125)
"""Shares of the usual length that are tried where inverse dynamics does not serve."""


@final
@dataclass(frozen=True, kw_only=True)
class RouteChoice:
    """How a record is fitted, and why."""

    route: Route
    """The route."""
    settings: RecordSettings
    """Settings with the length of segments that serves."""
    reason: str = ""
    """Why it is not simulated segments of the usual length; empty if it is."""


def choose_route(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    unknown: Sequence[str] = (),
    settings: RecordSettings | None = None,
) -> RouteChoice:
    """Return how a record is fitted where nobody asks for a route.

    Friction that was measured is fitted along the measured motion. Everything else is simulated in
    segments, unless Coulomb and viscous friction, with values by linear regression of the forces,
    leaves more than half of the motion within these unexplained. Then friction is derived by
    inverse dynamics if the mechanism allows that, else the segments are made shorter.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    measurement : Measurement
        Records in time, or measured friction.
    unknown : sequence of str
        Parameters of the mechanism that are fitted too.
    settings : RecordSettings, optional
        Segments; a length other than the usual one is kept.

    Examples
    --------
    >>> from stickslip import Axis
    >>> table = Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6])
    >>> choose_route(Axis(inertia=1.0), table).route
    'force-map'
    """
    settings = RecordSettings() if settings is None else settings
    if "friction" in measurement.quantities():
        return RouteChoice(route="force-map", settings=settings)
    usual = RouteChoice(route="shooting", settings=settings)
    if not driven(measurement):
        return usual
    left = _left_by_regression(mechanism, measurement, unknown, settings)
    if not left > UNPREDICTED:
        return usual
    why = (
        f"Coulomb + viscous friction leaves {percent(left)} of the motion within"
        f" {number(settings.segment)} s unexplained"
        if math.isfinite(left)
        else f"the motion cannot be simulated over {number(settings.segment)} s"
    )
    if serves_inverse_dynamics(mechanism, measurement, unknown):
        return RouteChoice(route="inverse-dynamics", settings=settings, reason=why)
    if settings.segment != RecordSettings().segment:
        return usual
    for share in SHORTER:
        shorter = replace(settings, segment=share * settings.segment)
        if not _left_by_regression(mechanism, measurement, unknown, shorter) > UNPREDICTED:
            return RouteChoice(route="shooting", settings=shorter, reason=why)
    return usual


def _left_by_regression(
    mechanism: Mechanism,
    measurement: Measurement,
    unknown: Sequence[str],
    settings: RecordSettings,
) -> float:
    """Return what Coulomb and viscous friction leaves; 0 where that cannot be said."""
    wanted = Wanted(
        mechanism=mechanism,
        law=CoulombViscous,
        measurement=measurement,
        unknown=unknown,
        free=None,
        known=None,
        settings=settings,
    )
    try:
        problem = prepared("shooting", wanted).problem
    except StickslipError:
        return 0.0  # what is wrong with the record is said where it is fitted
    assert isinstance(problem, Shooting)
    return motion_left(problem)


def serves_inverse_dynamics(
    mechanism: Mechanism, measurement: Measurement, unknown: Sequence[str] = ()
) -> bool:
    """Whether friction can be derived from motion and force: one coordinate, driven, positions.

    Examples
    --------
    >>> from stickslip import Axis
    >>> t = np.arange(100) / 100
    >>> pushed = Measurement(time=t, position=np.sin(t), force=np.cos(t))
    >>> serves_inverse_dynamics(Axis(inertia=1.0), pushed)
    True
    """
    return (
        len(mechanism.coordinates) == 1
        and driven(measurement)
        and all(path.rpartition(".")[2] in ("inertia", "mass") for path in unknown)
        and all(
            record.time is not None and "position" in record.quantities()
            for record in measurement.records()
        )
    )


def motion_left(problem: Shooting) -> float:
    """Return the share of the motion within segments that the start values leave unexplained.

    A straight line is taken off the motion of each segment, since its first position and velocity
    are fitted.

    Parameters
    ----------
    problem : Shooting
        Its start values, by linear regression of forces, are near what a law can reach.
    """
    count = len(problem.segments)
    chosen = list(range(0, count, max(1, math.ceil(count / LOOKED_AT))))
    seen = problem.linearise(problem.unknowns.start, only=chosen, slopes=False)
    for _ in range(2):
        if not math.isfinite(seen.cost):
            return math.inf
        seen = _better(seen, problem.linearise(seen.values, seen, only=chosen, slopes=False))
    moved = sum(_curved(problem.segments[k]) for k in chosen)
    return math.sqrt(seen.cost / max(moved, 1e-300))


def _better(one: Linearised, other: Linearised) -> Linearised:
    return other if other.cost < one.cost else one


def _curved(segment: Segment) -> float:
    """Return the sum of squares of the motion of a segment less a straight line."""
    line = np.polyfit(segment.times, segment.measured, 1)
    return float(np.sum((segment.measured - np.polyval(line, segment.times)) ** 2))
