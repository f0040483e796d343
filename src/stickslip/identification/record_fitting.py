"""Fits a law to records in time or to measured friction, by one of three routes."""

import math
import numbers
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, InputError, ParameterError, UnknownNameError
from stickslip.experiments import Measurement
from stickslip.experiments.refusals import refuse_unused, with_doubts
from stickslip.friction import FrictionLaw
from stickslip.identification.applied import driven
from stickslip.identification.doubts import (
    bounds_met,
    estimates_of,
    in_units_of,
    offset_left_out,
    sentences_of,
)
from stickslip.identification.features import ROUTE as FEATURES
from stickslip.identification.force_map import force_map
from stickslip.identification.force_units import in_forces
from stickslip.identification.inertia import inertia_of
from stickslip.identification.inference import infer
from stickslip.identification.inverse_dynamics import friction_record
from stickslip.identification.loads import loaded, with_usual_load
from stickslip.identification.map_problem import ForceMap
from stickslip.identification.map_records import stretches_of
from stickslip.identification.optimise import Found, Watch, search
from stickslip.identification.problem import RecordProblem
from stickslip.identification.record_fit import Build, RecordFit, scale_of
from stickslip.identification.record_starts import (
    joined,
    law_unknowns,
    mechanism_unknowns,
    scales_of,
)
from stickslip.identification.results import Estimate
from stickslip.identification.segmenting import (
    LEAST,
    RESOLUTION,
    Hold,
    measured_quantity,
    segments_of,
)
from stickslip.identification.shooting import Shooting
from stickslip.identification.unknowns import Unknowns
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, vary

__all__ = ["ROUTES", "RecordSettings", "fit_record", "route_of"]

Array = NDArray[np.float64]

SEGMENT = 1.0
"""Length of a segment [s] that is simulated from a state of its own."""
DECAY_STEP = 3.0
"""A free decay is fitted in segments, then in segments so much longer, then as a whole."""
STARTS = 4
"""Starts of the search."""


Route: TypeAlias = Literal["shooting", "force-map", "inverse-dynamics"]
ROUTES: tuple[Route, ...] = ("shooting", "force-map", "inverse-dynamics")


@dataclass(frozen=True, kw_only=True)
class RecordSettings:
    """How records are fitted."""

    segment: float = SEGMENT
    """Length of a segment [s] that is simulated."""
    resolution: int = RESOLUTION
    """Rows of a segment at most, 8 or more."""
    hold: Hold = "zero"
    """``"zero"`` if a force keeps its value until the next sample, ``"first"`` if it goes there.

    For simulated segments; the other routes do not simulate, and take each sample at its time.
    """
    starts: int = STARTS
    """Starts of the search."""
    seed: int = 0
    """Of the jitter of further starts."""

    def __post_init__(self) -> None:
        """Check all: a hold that is not known would pass for ``"zero"``."""
        Quantity("segment", "s", above=0).check("RecordSettings", "segment", self.segment)
        for name, least in (("resolution", LEAST), ("starts", 1), ("seed", 0)):
            value = getattr(self, name)
            whole = isinstance(value, numbers.Integral) and not isinstance(value, bool)
            if not (whole and value >= least):
                raise ParameterError(
                    f"RecordSettings.{name} must be a whole number of at least {least}, got"
                    f" {value!r}."
                )
        if self.hold not in get_args(Hold):
            raise UnknownNameError("hold in RecordSettings", self.hold, get_args(Hold))


@dataclass(frozen=True)
class _Set:
    """A problem and where its search begins."""

    mechanism: Mechanism
    start: FrictionLaw
    problem: RecordProblem
    build: Build
    tried: tuple[Array, ...] = ()
    before: tuple[Estimate, ...] = ()
    """What was found before the search, which takes it as known."""


# What builds problems is no closure, so that fits can cross processes.


@dataclass(frozen=True)
class _Shot:
    """Builds the shooting problem of a record."""

    mechanism: Mechanism
    law: FrictionLaw
    unknowns: Unknowns
    settings: RecordSettings
    quantity: str
    """What runs are compared with, in every record alike."""

    def __call__(self, record: Measurement, length: float | None) -> RecordProblem:
        return Shooting(
            law=self.law,
            unknowns_=self.unknowns,
            segments=segments_of(
                self.mechanism,
                record,
                length=self.settings.segment if length is None else length,
                resolution=_rows(self.settings, length),
                hold=self.settings.hold,
                quantity=self.quantity,
            ),
            quantity_=self.quantity,
        )


@dataclass(frozen=True)
class _Rubbed:
    """Builds the problem of a record of friction, or of one that friction is derived from."""

    mechanism: Mechanism
    problem: ForceMap
    derived: bool

    def __call__(self, record: Measurement, length: float | None) -> RecordProblem:
        own = friction_record(self.mechanism, record) if self.derived else record
        return replace(self.problem, stretches=stretches_of(self.mechanism, own, segment=length))


def route_of(measurement: Measurement, route: str | None = None) -> Route:
    """Return how a measurement is fitted: as asked, or as its quantities suggest.

    Examples
    --------
    >>> route_of(Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6]))
    'force-map'
    """
    if route is not None:
        for known in ROUTES:
            if route == known:
                return known
        if route == FEATURES:
            raise InputError(
                "features are no residuals of a record: fit_features, `fit` and `select` take that"
                " route."
            )
        raise UnknownNameError("route", route, (*ROUTES, FEATURES))
    return "force-map" if "friction" in measurement.quantities() else "shooting"


def fit_record(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    unknown: Sequence[str] = (),
    free: Sequence[str] | None = None,
    known: Mapping[str, float] | None = None,
    route: str | None = None,
    settings: RecordSettings | None = None,
    watch: Watch | None = None,
) -> RecordFit:
    """Fit a law to records in time or to measured friction.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    law : FrictionLaw or type
        A type, whose start values come from the record; or an instance, whose values they are.
    measurement : Measurement
        Records in time with position or velocity, and the force applied if there is one; or
        friction measured directly.
    unknown : sequence of str
        Parameters of the mechanism that are looked for too, such as ``"inertia"``.
    free : sequence of str, optional
        Parameters of the law that are looked for; all of its `fit_order` if not given.
    known : mapping of str to float, optional
        Values of those that are not, by name, where the law is a type.
    route : {"shooting", "force-map", "inverse-dynamics"}, optional
        Simulated segments; measured friction along the measured motion; or friction that inverse
        dynamics finds, along it.
    settings : RecordSettings, optional
        Segments and starts.
    watch : callable, optional
        Called with the least root mean square so far; False ends the search with the best so far.

    Returns
    -------
    RecordFit
        The law, estimates with intervals, what the record cannot tell.

    Raises
    ------
    InputError
        If the record does not serve, or a name is not known.
    ConvergenceError
        If no start predicts the record.
    """
    settings = RecordSettings() if settings is None else settings
    way = route_of(measurement, route)
    refuse_unused(measurement)
    if way == "shooting":
        ready = _shooting(mechanism, law, measurement, unknown, free, known, settings)
    else:
        ready = _mapped(mechanism, law, measurement, unknown, free, known, way)
    found = search(
        ready.problem,
        starts=settings.starts,
        seed=settings.seed,
        tried=ready.tried,
        watch=watch,
    )
    if way == "shooting" and not driven(measurement):
        ready, found = _lengthened(ready, found, measurement, settings, watch)
    return _finished(way, measurement, ready, found)


def _lengthened(
    ready: _Set,
    found: Found,
    measurement: Measurement,
    settings: RecordSettings,
    watch: Watch | None,
) -> tuple[_Set, Found]:
    """Fit a free decay again in longer segments, at last as a whole.

    The whole tells the most, but only from near the truth: from farther off, a swing more or less
    is as good a fit.
    """
    spans = ready.problem.spans
    whole = float(np.max(spans[:, 2]) - np.min(spans[:, 1]))
    for length in (DECAY_STEP * settings.segment, whole):
        if found.cancelled or length <= settings.segment or length > whole:
            continue
        longer = ready.build(measurement, length)
        near = longer.unknowns.starting_at(found.best.values)
        problem = replace(longer, unknowns_=near) if isinstance(longer, Shooting) else longer
        try:
            again = search(problem, starts=1, watch=watch)
        except ConvergenceError as error:
            raise ConvergenceError(
                f"segments of {settings.segment:g} s of this free decay do not tell enough to"
                f" predict {length:.3g} s: {error} Give longer segments."
            ) from None
        ready = replace(ready, problem=problem)
        found = replace(found, best=again.best, evaluations=found.evaluations + again.evaluations)
    return ready, found


def _shooting(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    unknown: Sequence[str],
    free: Sequence[str] | None,
    known: Mapping[str, float] | None,
    settings: RecordSettings,
) -> _Set:
    quantity = measured_quantity(measurement)
    mechanism = with_usual_load(mechanism, measurement)
    with with_doubts(measurement, mechanism):
        scales = scales_of(mechanism, loaded(mechanism, measurement), unknown)
    start, items, further = law_unknowns(law, scales, free, known)
    unknowns = joined(start, [*items, *mechanism_unknowns(mechanism, start, unknown, scales)])
    if not len(unknowns):
        raise InputError("there is nothing to fit: name at least one parameter in `free`.")
    _check_overrides(loaded(mechanism, measurement), unknowns)

    build = _Shot(mechanism, start, unknowns, settings, quantity)
    tried = tuple(
        np.array([other.get(p, v) for p, v in zip(unknowns.paths, unknowns.start, strict=True)])
        for other in further
    )
    with with_doubts(measurement, mechanism):
        problem = build(measurement, None)
    return _Set(mechanism, start, problem, build, tried)


def _check_overrides(measurement: Measurement, unknowns: Unknowns) -> None:
    """Refuse trials with values of their own for what is one unknown of all of them."""
    for number, record in enumerate(measurement.records(), 1):
        for path in record.overrides:
            if path in unknowns.paths:
                raise InputError(
                    f"trial {record.name or number} overrides {path}, which is looked for as one"
                    " number of all trials: leave the override out, or do not look for it."
                )


def _mapped(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    unknown: Sequence[str],
    free: Sequence[str] | None,
    known: Mapping[str, float] | None,
    way: Route,
) -> _Set:
    """Return the problem of friction that was measured, or that inverse dynamics finds."""
    derived = way == "inverse-dynamics"
    if unknown and not derived:
        raise InputError(
            f"friction was measured, which tells nothing of {', '.join(unknown)}: leave out what is"
            " unknown of the mechanism, or fit another record that has motion and force."
        )
    mass = inertia_of(mechanism, measurement, unknown) if derived else None
    if mass is not None:
        mechanism = vary(mechanism, "mechanism", {mass.path: mass.value})

    own = friction_record(mechanism, measurement) if derived else measurement
    kind = law if isinstance(law, type) else type(law)
    wanted = kind.fit_order if free is None else [name.rpartition(".")[2] for name in free]
    held = [name for name in kind.fit_order if name not in wanted]
    problem = force_map(law, mechanism, own, held=held, known=known)

    build = _Rubbed(mechanism, problem, derived)
    return _Set(mechanism, problem.law, problem, build, before=() if mass is None else (mass,))


def _finished(
    route: Route,
    measurement: Measurement,
    ready: _Set,
    found: Found,
) -> RecordFit:
    """Return a fit from the end of its search: law, intervals and what is not told."""
    unknowns, best = ready.problem.unknowns, found.best
    at_bounds = bounds_met(unknowns, best.values)
    inference = infer(best, scale_of(unknowns, best.values, at_bounds))
    told = in_forces(unknowns, ready.mechanism, measurement)
    estimates = estimates_of(told, best, inference, at_bounds)
    values = dict(zip(unknowns.paths, best.values.tolist(), strict=True))
    law, own = (
        {path: value for path, value in values.items() if path.startswith(f"{room}.")}
        for room in ("friction", "mechanism")
    )
    return RecordFit(
        law=vary(ready.start, "friction", law),
        mechanism=vary(ready.mechanism, "mechanism", own) if own else ready.mechanism,
        estimates=in_units_of(measurement, (*estimates, *ready.before)),
        route=route,
        measurement=measurement,
        problem=ready.problem,
        build=ready.build,
        found=found,
        inference=inference,
        at_bounds=at_bounds,
        sentences=(
            *sentences_of(told, best, inference, at_bounds, estimates),
            *offset_left_out(ready.start, ready.mechanism, unknowns),
            *_doubtful(found),
            *map(_taken, ready.before),
        ),
    )


def _taken(estimate: Estimate) -> str:
    """Return the sentence about what was found before the search."""
    return (
        f"{estimate.path} comes from a regression of its own: the intervals of friction take it as"
        " known."
    )


def _doubtful(found: Found) -> tuple[str, ...]:
    """Return a sentence where no other start came to the least residual."""
    if found.agreeing > 1 or len(found.costs) == 1:
        return ()
    return (
        f"Only one of {len(found.costs)} starts came to this residual: the estimates may be those"
        " of a side valley, which intervals do not show.",
    )


def _rows(settings: RecordSettings, length: float | None) -> int:
    """Return the rows of a segment, so that longer ones are resolved alike."""
    if length is None:
        return settings.resolution
    return max(settings.resolution, math.ceil(settings.resolution * length / settings.segment))
