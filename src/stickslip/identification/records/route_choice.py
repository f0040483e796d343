"""Which route fits a record: simulated segments, or friction that inverse dynamics derives.

A simulation of a second tells friction only where friction decides what happens in a second. At low
speed in a closed loop it does not: the force that was recorded answers to every disturbance, and
played back to the model it drives it elsewhere. Inverse dynamics, which takes the motion as it was
measured, needs no such prediction, but a motion that is measured well.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from stickslip.errors import ConvergenceError, StickslipError
from stickslip.experiments import Measurement
from stickslip.formatting import number, parameter_words, percent
from stickslip.friction import CoulombViscous
from stickslip.identification.estimation.levenberg_marquardt import improve, search
from stickslip.identification.records.fit import RecordFit, settled
from stickslip.identification.records.problems import (
    RouteChoice,
    Wanted,
    per_current,
    prepared,
    simulated,
)
from stickslip.identification.series.applied_force import driven, drives_itself
from stickslip.identification.series.measured_load import has_one_load
from stickslip.identification.settings import RecordSettings
from stickslip.identification.shooting.multiple_shooting import Shooting
from stickslip.identification.shooting.segments import usual_segment, with_usual_segment
from stickslip.identification.validation import Parameters
from stickslip.mechanisms import Mechanism

OwnRouteName: TypeAlias = Literal[
    "shooting", "force-map", "inverse-dynamics", "features", "rate-state", "table", "balance"
]
RouteName: TypeAlias = OwnRouteName | str
"""What `fit` and `select` may be asked for; editors complete ours, and other packages add theirs.
"""

UNPREDICTED = 0.5
"""Share of the motion left unexplained beyond which simulated segments do not serve."""
SUSPECT = 0.05
"""Share beyond which their mass and level are compared with those of inverse dynamics."""
CONTRADICTED = 1.5
"""Factor between the two beyond which the simulated segments do not serve."""
LOOKED_AT = 12
"""Segments that are simulated to see it."""
COMPARED = ("inertia", "mass", "kinetic_coefficient")
"""Ends of paths of what is compared; viscous parts trade off with levels at low speed."""
STARTS = 2
"""Starts of a search where the regression leaves much: of a short record it may be far off."""
SHORTER = (0.5, 0.25, 0.125)
"""Shares of the usual length that are tried where inverse dynamics does not serve."""


def asked_for(route: str | RouteChoice | None) -> str | None:
    """Return the name of a route, or of that of a choice; None if nobody asked for one.

    Examples
    --------
    >>> asked_for("shooting")
    'shooting'
    """
    return route.route if isinstance(route, RouteChoice) else route


def unexplained_share(fit: RecordFit) -> float:
    """Return what a fit leaves unexplained, as a share.

    Of simulated segments, that of their motion about a straight line, as their first position and
    velocity are fitted; of friction, that of its variation about its mean.
    """
    return math.sqrt(fit.optimum.best.cost / max(fit.problem.variation, 1e-300))


def better_route(fits: Sequence[RecordFit], others: Sequence[RecordFit]) -> str:
    """Return why the route of other fits to the same record serves better; empty if it does not.

    It does where the best of its fits leaves a smaller share of what it explains.
    """
    if not others:
        return ""
    if not fits:
        return "no law could be fitted to simulated segments"
    one, other = (min(unexplained_share(fit) for fit in some) for some in (fits, others))
    if not other < one:
        return ""
    return (
        f"simulated segments leave {percent(one)} of the motion unexplained at best, inverse"
        f" dynamics {percent(other)} of the friction"
    )


def to_compare(choice: RouteChoice, fits: Sequence[RecordFit]) -> bool:
    """Whether the alternative of a choice is to be tried, as even the best fit leaves much.

    Not after a search was ended early.
    """
    if choice.alternative is None or any(fit.optimum.cancelled for fit in fits):
        return False
    return not fits or min(unexplained_share(fit) for fit in fits) > SUSPECT


def choose_route(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    settings: RecordSettings | None = None,
) -> RouteChoice:
    """Return how a record is fitted where nobody asks for a route.

    Friction that was measured is fitted along the measured motion. Everything else is simulated in
    segments, unless Coulomb and viscous friction leaves more than half of the motion within these
    unexplained, or a good part of it with a mass or a level that inverse dynamics contradicts. Then
    friction is derived by inverse dynamics, or, where the mechanism does not allow that, segments
    are made shorter.

    Examples
    --------
    >>> from stickslip import Axis
    >>> table = Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6])
    >>> choose_route(Axis(inertia=1.0), table).route
    'force-map'
    """
    settings = RecordSettings() if settings is None else settings
    unknown = Parameters.of(mechanism, None, vary).unknown
    if "friction" in measurement.quantities():
        return RouteChoice(route="force-map", settings=settings)
    settings = with_usual_segment(settings, measurement)
    usual = _by_segments(settings).with_hold(mechanism, measurement)
    return replace(_chosen(mechanism, measurement, unknown, usual.settings), hold=usual.hold)


def _chosen(
    mechanism: Mechanism,
    measurement: Measurement,
    unknown: Sequence[str],
    settings: RecordSettings,
) -> RouteChoice:
    """Return how a record in time is fitted, with a hold that is known."""
    if drives_itself(mechanism, measurement):
        return _by_segments(_whole(measurement, settings))
    usual = _by_segments(settings)
    if not driven(measurement):
        return usual
    if per_current(mechanism, measurement, unknown) and _has_positions(mechanism, measurement):
        why = "current and voltage were recorded, and simulated segments take one of them"
        return RouteChoice(route="inverse-dynamics", settings=settings, reason=why)
    derivable = serves_inverse_dynamics(mechanism, measurement, unknown)
    if derivable and not has_one_load(measurement):
        why = "simulated segments take one load, and that of the record changes"
        return RouteChoice(route="inverse-dynamics", settings=settings, reason=why)
    seen = _simulated(mechanism, measurement, unknown, settings)
    if seen is None or seen.left <= SUSPECT:
        return usual
    if seen.left > UNPREDICTED:
        why = (
            f"Coulomb + viscous friction leaves {percent(seen.left)} of the motion within"
            f" {number(settings.segment)} s unexplained"
            if math.isfinite(seen.left)
            else _no_motion(settings)
        )
    else:
        found = _contradiction(mechanism, measurement, unknown, settings, seen)
        derivable, why = derivable and found is not None, found or ""
    if not why:
        return replace(usual, alternative="inverse-dynamics") if derivable else usual
    if derivable:
        return RouteChoice(route="inverse-dynamics", settings=settings, reason=why)
    if settings.segment != RecordSettings().segment:
        return usual
    for share in SHORTER:
        shorter = replace(settings, segment=share * settings.segment)
        again = _simulated(mechanism, measurement, unknown, shorter)
        if again is None or again.left <= UNPREDICTED:
            return RouteChoice(route="shooting", settings=shorter, reason=why)
    return usual


def _whole(measurement: Measurement, settings: RecordSettings) -> RecordSettings:
    """Return settings by which records are simulated as a whole, resolved as segments are.

    A mechanism that drives itself runs from its start in any case: short segments would tell less.
    """
    if settings.segment != usual_segment(measurement):
        return settings
    longest = max(float(np.ptp(np.asarray(one.time))) for one in measurement.records())
    rows = math.ceil(settings.resolution * max(longest / settings.segment, 1.0))
    return replace(settings, segment=max(longest, settings.segment), resolution=rows)


@dataclass(frozen=True, kw_only=True)
class _Simulated:
    """Coulomb and viscous friction fitted to simulated segments."""

    values: Mapping[str, float]
    left: float
    """Share of the motion within the segments that it leaves unexplained."""


def _simulated(
    mechanism: Mechanism,
    measurement: Measurement,
    unknown: Sequence[str],
    settings: RecordSettings,
) -> _Simulated | None:
    """Return what Coulomb and viscous friction leaves; None where that cannot be said."""
    try:
        plain = _plain_fit(mechanism, unknown)
        problem = simulated(_by_segments(settings), plain, measurement).problem
    except StickslipError:
        return None  # what is wrong with the record is said where it is fitted
    return _motion_left(problem)


def _plain_fit(mechanism: Mechanism, unknown: Sequence[str]) -> Wanted:
    return Parameters(mechanism=mechanism, law=CoulombViscous, unknown=tuple(unknown))


def _by_segments(settings: RecordSettings) -> RouteChoice:
    return RouteChoice(route="shooting", settings=settings)


def _contradiction(
    mechanism: Mechanism,
    measurement: Measurement,
    unknown: Sequence[str],
    settings: RecordSettings,
    seen: _Simulated,
) -> str | None:
    """Return where inverse dynamics finds another mass or level, in words; empty if it does not.

    None if it finds nothing at all.
    """
    try:
        choice = RouteChoice(route="inverse-dynamics", settings=settings)
        problem = prepared(choice, _plain_fit(mechanism, unknown), measurement).problem
        end, _ = improve(problem, problem.free_parameters.start)
    except StickslipError:
        return None
    derived = dict(zip(problem.free_parameters.paths, end.values.tolist(), strict=True))
    for path, value in seen.values.items():
        other = derived.get(path, 0.0)
        if path.endswith(COMPARED) and value > 0.0 and other > 0.0:
            factor = max(value / other, other / value)
            if factor > CONTRADICTED:
                name = parameter_words(path)
                return (
                    f"simulated segments and inverse dynamics disagree: the {name} differs by a"
                    f" factor of {number(factor, 2)}"
                )
    return ""


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
        driven(measurement)
        and all(path.rpartition(".")[2] in ("inertia", "mass") for path in unknown)
        and _has_positions(mechanism, measurement)
    )


def _has_positions(mechanism: Mechanism, measurement: Measurement) -> bool:
    """Whether a mechanism has one coordinate, and its position was recorded in time."""
    return len(mechanism.coordinates) == 1 and all(
        record.time is not None and "position" in record.quantities()
        for record in measurement.records()
    )


def _no_motion(settings: RecordSettings) -> str:
    return f"the motion cannot be simulated over {number(settings.segment)} s"


def _motion_left(problem: Shooting) -> _Simulated:
    """Return the share of the motion within segments that a law leaves unexplained at its best.

    A straight line is taken off the motion of each segment, since its first position and velocity
    are fitted. Start values, by linear regression of forces, are improved only if they leave much.
    """
    count = len(problem.segments)
    step = max(1, math.ceil(count / LOOKED_AT))
    few = replace(problem, segments=problem.segments[::step])
    moved = few.variation
    seen = settled(few, few.free_parameters.start)
    for starts in (1, STARTS):
        enough = SUSPECT if starts == 1 else UNPREDICTED
        if seen.cost <= enough**2 * moved:
            break
        try:
            seen = search(few, starts=starts).best
        except ConvergenceError:
            return _Simulated(values={}, left=math.inf)
    values = dict(zip(few.free_parameters.paths, seen.values.tolist(), strict=True))
    return _Simulated(values=values, left=math.sqrt(seen.cost / max(moved, 1e-300)))
