"""Fits a law to records in time or to measured friction, by one of three routes."""

import math
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from stickslip.drives import SampledSwing
from stickslip.errors import ConvergenceError, InputError, UnknownNameError
from stickslip.experiments import Measurement, refuse_faults, refuse_unused, with_doubts
from stickslip.formatting import count, joined, number, percent, quantity
from stickslip.friction import FrictionLaw, containment_of, simpler_laws
from stickslip.identification.contact_inputs import (
    as_informed,
    check_inputs,
    recorded_inputs,
    unvaried,
)
from stickslip.identification.estimation.containment import (
    FittedLaw,
    elsewhere,
    reachable,
    search_failure,
    starts_from,
)
from stickslip.identification.estimation.estimates import (
    bounds_met,
    estimates_of,
    offset_left_out,
    sentences_of,
    widened_by_starts,
)
from stickslip.identification.estimation.halves import contradiction, widened
from stickslip.identification.estimation.jackknife import Displaced, Inference, infer
from stickslip.identification.estimation.levenberg_marquardt import (
    FIRST_DAMPING,
    OptimizeResult,
    Watch,
    search,
    step_of,
)
from stickslip.identification.estimation.parameters import FreeParameters, told
from stickslip.identification.estimation.problem import RecordProblem, ResidualJacobian
from stickslip.identification.force_map.force_balance import BalanceProblemBuilder, positive_noise
from stickslip.identification.force_map.model import ForceMap
from stickslip.identification.outliers import without_outliers
from stickslip.identification.records.fit import RecordFit, scale_of
from stickslip.identification.records.problems import (
    FitSetup,
    RecordRouteName,
    RouteChoice,
    Wanted,
    as_recorded,
    held_otherwise,
    prepared,
)
from stickslip.identification.records.refits import halves_of, interleaved
from stickslip.identification.records.resting import resting_trials, said_of_rests
from stickslip.identification.records.route_choice import better_route, choose_route, to_compare
from stickslip.identification.residuals.holds import HoldFinding, of_simulation
from stickslip.identification.rig_uncertainties import span_of, uncertainties_of
from stickslip.identification.series.applied_force import driven, inside
from stickslip.identification.series.measured_load import as_loaded
from stickslip.identification.settings import RecordSettings
from stickslip.identification.shooting.multiple_shooting import Shooting
from stickslip.identification.shooting.segments import with_usual_segment
from stickslip.identification.validation import LAW, Parameters
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.quantities import fields_of, vary

Array = NDArray[np.float64]

LOAD = "mechanism.load"
"""What a measured load takes the place of."""
NARROW = 0.6
"""Band in which a fit by derivatives is looked at again, over that of the fit."""
STEPS = (0.5, 2.0)
"""Samples along which it is looked at again, over those of the fit."""
FEWEST_ROWS = 12
"""Rows from which one of them may be called an exception."""
NORMAL_95 = 1.96
"""Half the width of an interval of 95 % over the standard error."""
LONE = 0.5
"""Share of the squared residuals above which one row is named."""
EXACT = 1e-12
"""Squared residual over the variance of what was measured that may come from rounding."""
WIDER = 100.0
"""How much farther out a guessed bound is moved that the search has met."""
WIDENINGS = 3
"""How often at most."""
WORTH = 0.02
"""Share of the cost that a wider bound must take off: else what ran there is told by nothing."""
CONTINUED = 4
"""How often at most a search goes on from its best end where a law has a memory ..."""
LEFT = 1e-3
"""... as long as that takes off this share of the cost."""
BEATEN = 2.0
"""Mean square over that of a rival from which a search that ends at a bound stays there: off it
a fit is looked for that is as close."""
SHIFT = 0.1
"""Way over a standard error from which an estimate is said to move: less leaves it as sure."""
THINNED = 1.5
"""Samples over rows from which rows were left out, and not only those at the ends."""
DECAY_STEP = 3.0
"""A free decay is fitted in segments, then in segments so much longer, then as a whole."""
ROUTES: tuple[RecordRouteName, ...] = ("shooting", "force-map", "inverse-dynamics")


def displacements(
    again: Callable[[Measurement], RecordProblem],
    best: ResidualJacobian,
    mechanism: Mechanism,
    measurement: Measurement,
) -> tuple[Displaced, ...]:
    """Return how far stated uncertainties of a mechanism move the residuals of a fit.

    A parameter that is looked for, as a constant force is without being asked for, is known from
    the record; what was stated of it is not used.
    """
    uncertainties = uncertainties_of(mechanism, measurement)
    stated = dict.fromkeys(path for pair in uncertainties for one in pair for path in one)
    if not stated:
        return ()
    _refuse_load(stated, measurement)
    problem = again(measurement)
    paths = [path for path in stated if path not in problem.free_parameters.paths]
    record_of = problem.spans[:, 0].astype(int)[best.segment]
    found = []
    for path in paths:
        errors = [{**shared, **own}.get(path, 0.0) for own, shared in uncertainties]
        rows = _moved_by_rig(again, best, mechanism, measurement, path, errors, record_of)
        common = np.array([path in shared for _, shared in uncertainties])[record_of]
        if common.any():
            found.append(Displaced(path=path, rows=rows * common))
        for own in (~common & (record_of == k) for k, error in enumerate(errors) if error):
            if own.any():
                found.append(Displaced(path=path, rows=rows * own, shared=False))
    return tuple(found)


def _refuse_load(paths: Collection[str], measurement: Measurement) -> None:
    if LOAD in paths and "load" in measurement.quantities():
        raise InputError(
            f"the uncertainty of {LOAD} was stated, but the measured load replaces its value:"
            " leave the uncertainty out."
        )


def _moved_by_rig(
    again: Callable[[Measurement], RecordProblem],
    best: ResidualJacobian,
    mechanism: Mechanism,
    measurement: Measurement,
    path: str,
    errors: Sequence[float],
    record_of: NDArray[np.intp],
) -> Array:
    """Return by how much the uncertainty of a parameter in each record moves the residuals (n,)."""
    records = measurement.records()
    spans = np.array(
        [
            span_of(vary(mechanism, "mechanism", record.overrides), path, error)
            if error
            else (0.0, 1.0)
            for record, error in zip(records, errors, strict=True)
        ]
    )
    sides = []
    for ends in spans.T.tolist():
        changed = tuple(
            replace(record, overrides={**record.overrides, path: end}) if error else record
            for record, end, error in zip(records, ends, errors, strict=True)
        )
        whole = replace(measurement, trials=changed) if measurement.trials else changed[0]
        sides.append(again(whole).carried(best))
    if not all(np.all(np.isfinite(side)) for side in sides):
        raise ConvergenceError(
            f"the uncertainty of {path} cannot be propagated: the record cannot be simulated with"
            " values close to the stated one. Leave the uncertainty out."
        )
    slopes = np.array(errors) / (spans[:, 1] - spans[:, 0])
    return np.asarray((sides[1] - sides[0]) * slopes[record_of])


def record_route_name(measurement: Measurement, route: str | None = None) -> RecordRouteName:
    """Return how a measurement is fitted: as asked, or as its quantities suggest.

    Examples
    --------
    >>> record_route_name(Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6]))
    'force-map'
    """
    if route is not None:
        for known in ROUTES:
            if route == known:
                return known
        if route == "features":
            raise InputError(
                "the route 'features' has no residuals in time: use fit_features, `fit` or"
                " `select`."
            )
        raise UnknownNameError("route", route, (*ROUTES, "features"))
    return "force-map" if "friction" in measurement.quantities() else "shooting"


def fit_records(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    route: str | RouteChoice | None = None,
    settings: RecordSettings | None = None,
    progress: Watch | None = None,
) -> RecordFit:
    """Fit a law to records in time or measured friction; arguments as in `stickslip.fit`.

    Examples
    --------
    >>> from stickslip import Axis, Coulomb
    >>> table = Measurement(
    ...     velocity=[-0.2, -0.1, 0.1, 0.2] * 3, friction=[-2.0, -2.0, 2.0, 2.0] * 3
    ... )
    >>> fit_records(Axis(inertia=1.0), Coulomb, table).route
    'force-map'
    """
    chosen = Parameters.of(mechanism, law, vary, fixed, measurement=measurement)
    refuse_faults(measurement, chosen.mechanism, chosen.unknown)
    with with_doubts(measurement, chosen.mechanism, of=ConvergenceError):
        return fit_record(
            chosen.mechanism,
            chosen.law,
            measurement,
            unknown=chosen.unknown,
            free=chosen.free,
            known=chosen.known,
            route=route,
            settings=settings,
            held=chosen.held,
            watch=progress,
        )


def fit_record(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    unknown: Sequence[str] = (),
    free: Sequence[str] | None = None,
    known: Mapping[str, float] | None = None,
    route: str | RouteChoice | None = None,
    settings: RecordSettings | None = None,
    held: Sequence[str] = (),
    contained: Sequence[FittedLaw] | None = None,
    rival: float = 0.0,
    watch: Watch | None = None,
) -> RecordFit:
    """Fit a law to records in time or to measured friction."""
    check_inputs(law, mechanism, measurement)
    measurement, left_out = without_outliers(measurement)
    choice = _route(mechanism, measurement, unknown, route, settings)
    if choice.route != "force-map":
        choice = choice.with_hold(mechanism, measurement)
    refuse_unused(measurement, inside(mechanism, measurement))
    wanted: Wanted = Parameters(
        mechanism=mechanism,
        law=law,
        free=None if free is None else tuple(free),
        known=known or {},
        unknown=tuple(unknown),
        held=tuple(held),
    )
    fits: list[RecordFit] = []
    try:
        fits.append(_fitted_by(choice, wanted, measurement, contained, watch, rival))
    except ConvergenceError:
        if choice.alternative is None:
            raise
    fits = [replace(one, left_out=left_out) for one in fits]
    if choice.alternative is None or not to_compare(choice, fits):
        return fits[0]
    other = replace(choice, route=choice.alternative, reason="", alternative=None)
    try:
        derived = _fitted_by(other, wanted, measurement, None, watch)
    except (ConvergenceError, InputError):
        if fits:
            return fits[0]
        raise
    why = better_route(fits, [derived])
    return replace(derived, route_reason=why, left_out=left_out) if why else fits[0]


def _fitted_by(
    choice: RouteChoice,
    wanted: Wanted,
    measurement: Measurement,
    contained: Sequence[FittedLaw] | None,
    watch: Watch | None,
    rival: float = 0.0,
) -> RecordFit:
    """Return a fit by one route."""
    if contained is None:
        contained = _simpler_fits(choice, wanted, measurement, watch)
    ready, found, first = _searched(choice, wanted, measurement, contained, watch, rival)
    if first is found and not (found.cancelled or found.hopeless):
        choice, ready, found = _under_either_hold(choice, ready, found, measurement, watch)
        ready, found = _under_each_sample(ready, found, measurement, watch)
        first = found
    build = ready.build.at(found.best.values)
    if build is not ready.build:
        ready = replace(ready, build=build, problem=build.fitted(measurement, None))
    contained = reachable(ready.start, ready.problem.free_parameters, contained)
    kind = _kind_of(wanted.law)
    failure = search_failure(kind, found.best.cost, len(found.best.residual), contained)
    fit = finished(choice.route, measurement, ready, found, first, hold=choice.hold)
    sentences = (failure, *fit.sentences) if failure else fit.sentences
    return replace(
        fit,
        sentences=sentences,
        search_failure=failure,
        route_reason=choice.reason,
    )


def _kind_of(law: FrictionLaw | type[FrictionLaw]) -> type[FrictionLaw]:
    return law if isinstance(law, type) else type(law)


def _searched(
    choice: RouteChoice,
    wanted: Wanted,
    measurement: Measurement,
    contained: Sequence[FittedLaw],
    watch: Watch | None,
    rival: float = 0.0,
) -> tuple[FitSetup, OptimizeResult, OptimizeResult]:
    """Return the problem and the end of its search, and the search that began from all starts.

    They differ for a free decay only, which is fitted again in longer segments.
    """
    kind, ready = _kind_of(wanted.law), prepared(choice, wanted, measurement)
    contained = reachable(ready.start, ready.problem.free_parameters, contained)
    few = ready.problem.few or ready.problem
    nested = starts_from(kind, few.free_parameters, contained, ready.load, few)
    if nested and contained[0].law == wanted.law:  # a fit of a richer law gave these very values
        ready = ready.looking_for(ready.problem.free_parameters.starting_at(nested[0]))
        nested = ()
    ready = replace(ready, tried=(*nested, *ready.tried))
    ready, found = widened_search(ready, choice.settings, watch, rival)
    if kind.states and not found.hopeless:
        found = _to_the_end(ready, found, watch, rounds=CONTINUED)
        if not found.best.rms**2 > BEATEN * rival > 0.0:
            found = _off_bounds(ready, found, watch)
    first = found
    if ready.problem.simulates and not driven(measurement):
        ready, found = _lengthened(ready, found, measurement, choice.settings, watch)
        again = starts_from(kind, ready.problem.free_parameters, contained, ready.load)
        found = _best_of(ready, found, again, watch)
    return ready, found, first


def _route(
    mechanism: Mechanism,
    measurement: Measurement,
    unknown: Sequence[str],
    route: str | RouteChoice | None,
    settings: RecordSettings | None,
) -> RouteChoice:
    """Return the route, its settings and why it was chosen; as asked for if it was."""
    if route is None:
        return choose_route(mechanism, measurement, vary=[LAW, *unknown], settings=settings)
    return choice_of(route, measurement, settings)


def choice_of(
    route: str | RouteChoice, measurement: Measurement, settings: RecordSettings | None = None
) -> RouteChoice:
    """Return the choice of a route that was asked for; one that was made is kept.

    Examples
    --------
    >>> table = Measurement(velocity=[0.1, 0.2], friction=[2.5, 2.6])
    >>> choice_of("force-map", table).settings.starts
    4
    """
    if isinstance(route, RouteChoice):
        return route
    name, settings = record_route_name(measurement, route), settings or RecordSettings()
    if name == "shooting":
        settings = with_usual_segment(settings, measurement)
    return RouteChoice(route=name, settings=settings)


def _simpler_fits(
    choice: RouteChoice, wanted: Wanted, measurement: Measurement, watch: Watch | None
) -> tuple[FittedLaw, ...]:
    """Fit the laws that a law contains, with a name or without, the simplest first.

    Of each, what is looked for and what is held is that of the law. Those that contain nothing are
    left out: Coulomb friction alone, say, is found by linear regression as part of the next.
    """
    once = replace(choice, settings=replace(choice.settings, starts=1))
    kind = _kind_of(wanted.law)
    free = set(kind.fit_order if wanted.free is None else ())
    for name in wanted.free or ():
        free |= set(kind.fit_order) if name == LAW else {name.rpartition(".")[2]}
    held = dict(wanted.known)
    if not isinstance(wanted.law, type):
        held |= {name: getattr(wanted.law, name) for name in fields_of(kind) if name not in free}
    found: dict[frozenset[str], FittedLaw] = {}

    def add(richer: type[FrictionLaw], free: Mapping[str, str], held: Mapping[str, float]) -> None:
        """Add what a law contains of which some fields are free, by those of the law asked for."""
        for simpler in simpler_laws(richer, free):
            how = containment_of(richer, simpler)
            if how is None or not simpler.contained:
                continue
            own = {field: to for field, to in how.values.items() if isinstance(to, str)}
            left = {to: free[field] for field, to in own.items() if field in free}
            kept = {to: held[field] for field, to in own.items() if held.get(field) is not None}
            # the same may have two names: with an exponent that is held at 1, and without
            key = frozenset(left.values())
            if key in found:
                continue
            add(simpler, left, kept)
            if len(left) == len(free):  # no unknown less: the same law by another name
                continue
            asked = replace(wanted, law=simpler, free=tuple(left), known=kept)
            one = _fitted_law(once, asked, measurement, tuple(found.values()), watch)
            if one is not None:
                found[key] = one

    add(kind, {name: name for name in free}, held)
    return tuple(found.values())


def _fitted_law(
    choice: RouteChoice,
    wanted: Wanted,
    measurement: Measurement,
    contained: Sequence[FittedLaw],
    watch: Watch | None,
) -> FittedLaw | None:
    """Return how the search of a law ends; None if it cannot be fitted."""
    try:
        ready, end, _ = _searched(choice, wanted, measurement, contained, watch)
    except (ConvergenceError, InputError):
        return None
    paths = ready.problem.free_parameters.paths
    values = dict(zip(paths, end.best.values.tolist(), strict=True))
    friction = {path: v for path, v in values.items() if path.startswith("friction.")}
    return FittedLaw(
        law=vary(ready.start, "friction", friction),
        values=values,
        cost=end.best.cost,
        rows=len(end.best.residual),
    )


def _to_the_end(
    ready: FitSetup, found: OptimizeResult, watch: Watch | None, *, rounds: int
) -> OptimizeResult:
    """Return a search that goes on from its best end as long as that is worth it.

    Parameters of memories make long and bent valleys, in which a descent comes slowly.
    """
    for _ in range(rounds):
        again = _best_of(ready, found, [found.best.values], watch)
        gained = again.best.cost < (1.0 - LEFT) * found.best.cost
        found = replace(again, costs=found.costs, values=found.values)
        if found.cancelled or not gained:
            break
    return found


def _off_bounds(ready: FitSetup, found: OptimizeResult, watch: Watch | None) -> OptimizeResult:
    """Return a search that ends off the bounds of what was searched, if that fits as closely.

    Errors of the other unknowns would take what ended at a bound for known.
    """
    unknowns = ready.problem.free_parameters
    met = bounds_met(unknowns, found.best.values)
    for start in elsewhere(ready.problem, found.best.values, met):
        again = None if found.cancelled else _from(ready, start, watch)
        if again is None:
            continue
        again = _to_the_end(ready, again, watch, rounds=CONTINUED)
        fewer = len(bounds_met(unknowns, again.best.values)) < len(met)
        if again.best.cost < (1.0 + LEFT * fewer) * found.best.cost:
            found = replace(
                again,
                costs=(*found.costs, *again.costs),
                values=np.concatenate([found.values, again.values]),
                evaluations=found.evaluations + again.evaluations,
            )
    return found


def _under_either_hold(
    choice: RouteChoice,
    ready: FitSetup,
    found: OptimizeResult,
    measurement: Measurement,
    watch: Watch | None,
) -> tuple[RouteChoice, FitSetup, OptimizeResult]:
    """Return a choice with the hold that runs tell where the force balance does not, and its end.

    Noise of accelerations hides half a sample of a slow force, long before that of positions does.
    """
    hold = choice.hold
    open_ = hold is not None and hold.is_open and not hold.simulated
    build = held_otherwise(ready.build) if open_ and ready.problem.simulates else None
    if hold is None or build is None:
        return choice, ready, found
    unknowns, best = ready.problem.free_parameters, found.best
    problem = build.fitted(measurement, ready.length).with_free_parameters(unknowns)
    seen = of_simulation(hold, best, problem.linearise(best.values, best))
    if seen.hold != hold.hold:
        other = replace(ready, problem=problem, build=build)
        again = _from(other, best.values, watch)
        if again is None:
            return choice, ready, found
        ready, found = (
            other,
            replace(
                again,
                costs=found.costs,
                values=found.values + (again.best.values - best.values),
                evaluations=found.evaluations + again.evaluations,
            ),
        )
    return replace(choice, hold=seen, settings=seen.applied(choice.settings)), ready, found


def _under_each_sample(
    ready: FitSetup, found: OptimizeResult, measurement: Measurement, watch: Watch | None
) -> tuple[FitSetup, OptimizeResult]:
    """Return a search that ends under the force of each sample, if that moves an estimate.

    Searches take a piece of the force a row. What that shifts is little beside the noise of a row,
    but not always beside the errors of estimates, which hold nothing of it.
    """
    best, unknowns = found.best, ready.problem.free_parameters
    fewer = isinstance(ready.problem, Shooting) and ready.problem.fewer_pieces
    build = as_recorded(ready.build) if fewer and driven(measurement) else None
    if build is None:
        return ready, found
    problem = build(measurement, ready.length).with_free_parameters(unknowns)
    here = problem.linearise(best.values, best)
    errors = infer(best, scale_of(unknowns, best.values, bounds_met(unknowns, best.values))).errors
    shift = np.abs(_step(unknowns, here) - _step(unknowns, best)) if here.finite else 0.0 * errors
    exact = replace(ready, problem=problem, build=build)
    again = _from(exact, best.values, watch) if np.any(shift > SHIFT * errors) else None
    if again is None:
        return ready, found
    return exact, replace(
        again,
        costs=found.costs,
        values=found.values + (again.best.values - best.values),
        evaluations=found.evaluations + again.evaluations,
    )


def _step(unknowns: FreeParameters, here: ResidualJacobian) -> Array:
    """Return how far one step moves the values (p,) at which a problem was linearised."""
    at, (low, high) = unknowns.coordinates(here.values), unknowns.limits()
    step, _ = step_of(
        here.slopes @ unknowns.slopes(at), here.residual, at, low, high, FIRST_DAMPING
    )
    return np.asarray(unknowns.values(at + step) - here.values)


def _best_of(
    ready: FitSetup, found: OptimizeResult, starts: Sequence[Array], watch: Watch | None
) -> OptimizeResult:
    """Return the better of a search and of searches from further starts."""
    for start in starts:
        again = None if found.cancelled else _from(ready, start, watch)
        if again is not None:
            better = min(found, again, key=lambda one: one.best.cost)
            found = replace(better, evaluations=found.evaluations + again.evaluations)
    return found


def _from(ready: FitSetup, start: Array, watch: Watch | None) -> OptimizeResult | None:
    """Return a search from one start; None if nothing is predicted there."""
    try:
        near = ready.looking_for(ready.problem.free_parameters.starting_at(start)).problem
        return search(near, starts=1, watch=watch)
    except ConvergenceError:
        return None


def widened_search(
    ready: FitSetup, settings: RecordSettings, watch: Watch | None, rival: float
) -> tuple[FitSetup, OptimizeResult]:
    """Search, and again with wider bounds where one was met that a start value had set.

    A bound that follows from a poor guess would pass for what the record says. One that is a limit
    of the quantity, such as 0, or of what the record covers stays.
    """
    found = search(
        ready.problem,
        starts=settings.starts,
        seed=settings.seed,
        start_values=ready.tried,
        few=ready.problem.few,
        rival=rival,
        watch=watch,
    )
    for _ in range(WIDENINGS):
        free_parameters = ready.problem.free_parameters
        wider = free_parameters.widened(bounds_met(free_parameters, found.best.values), WIDER)
        if found.cancelled or wider == free_parameters:
            break
        wide = ready.looking_for(wider.starting_at(found.best.values))
        again = search(
            wide.problem,
            starts=settings.starts,
            seed=settings.seed,
            few=wide.problem.few,
            rival=rival,
            watch=watch,
        )
        again = replace(again, evaluations=found.evaluations + again.evaluations)
        if again.best.cost > (1.0 - WORTH) * found.best.cost:
            return ready, replace(found, evaluations=again.evaluations, cancelled=again.cancelled)
        ready, found = wide, again
    return ready, found


def _thinned(problem: RecordProblem, measurement: Measurement) -> Iterator[str]:
    """Yield that friction is compared at some of the samples only."""
    if not isinstance(problem, ForceMap):
        return
    rows = sum(len(one.path.time) for one in problem.stretches if one.timed and not one.winding)
    present = {one.record for one in problem.stretches}  # a trial at rest has no rows
    samples = sum(
        record.time.size
        for index, record in enumerate(measurement.records())
        if record.time is not None and index in present
    )
    if rows and samples > THINNED * rows:
        yield (
            f"The record was thinned from {samples:,} to {rows:,} rows: friction was compared at"
            " these."
        )


def _lengthened(
    ready: FitSetup,
    found: OptimizeResult,
    measurement: Measurement,
    settings: RecordSettings,
    watch: Watch | None,
) -> tuple[FitSetup, OptimizeResult]:
    """Fit a free decay again in longer segments, at last as a whole.

    The whole tells the most, but only from near the truth: from farther off, a swing more or less
    is as good a fit. What is returned is how the last search ended, whose residuals are those of
    the fit: costs over longer segments cannot be compared with costs over short ones.
    """
    spans = ready.problem.spans
    whole = float(np.max(spans[:, 2]) - np.min(spans[:, 1]))
    for length in (DECAY_STEP * settings.segment, whole):
        if found.cancelled or length <= settings.segment or length > whole:
            continue
        longer = ready.build(measurement, length)
        near = longer.free_parameters.starting_at(found.best.values)
        problem = longer.with_free_parameters(near)
        try:
            again = search(problem, starts=1, watch=watch)
        except ConvergenceError as error:
            raise ConvergenceError(
                f"segments of {number(settings.segment)} s of this free decay are too short to"
                f" predict {quantity(length, 's')}: {error} Give longer segments."
            ) from None
        ready = replace(ready, problem=problem, length=length)
        found = replace(again, evaluations=found.evaluations + again.evaluations)
    return ready, found


def finished(
    route: str,
    measurement: Measurement,
    ready: FitSetup,
    found: OptimizeResult,
    searched: OptimizeResult,
    *,
    hold: HoldFinding | None = None,
) -> RecordFit:
    """Return a fit from the end of its search, which began with one from several starts."""
    free_parameters, best = ready.problem.free_parameters, found.best
    at_bounds = bounds_met(free_parameters, best.values)
    values = dict(zip(free_parameters.paths, best.values.tolist(), strict=True))
    law, own = (
        {path: value for path, value in values.items() if path.startswith(f"{room}.")}
        for room in ("friction", "mechanism")
    )
    mechanism = vary(ready.mechanism, "mechanism", own) if own else ready.mechanism
    again = partial(ready.build.fitted, length=ready.length)
    doubted = any(one.parameter_uncertainties for one in (measurement, *measurement.records()))
    moved = displacements(again, best, mechanism, measurement) if doubted else ()
    inference = infer(best, scale_of(free_parameters, best.values, at_bounds), displaced=moved)
    shown = told(free_parameters, mechanism, measurement)
    inference, apart = widened_by_starts(inference, shown, found)
    mechanism, said = as_loaded(mechanism, measurement)
    mechanism, told_inputs = as_informed(ready.start, mechanism, measurement)
    fit = RecordFit(
        law=vary(ready.start, "friction", law),
        mechanism=mechanism,
        estimates=(),
        remarks=(*([said] if said else []), *told_inputs, *_thinned(ready.problem, measurement)),
        route=route,
        measurement=measurement,
        problem=ready.problem,
        build=ready.build,
        optimum=found,
        first=None if searched is found else searched,
        inference=inference,
        displaced=moved,
        at_bounds=at_bounds,
        cancelled=found.cancelled,
        sentences=(),
        hold=hold,
    )
    sentences = (
        *offset_left_out(ready.start, ready.mechanism, free_parameters),
        *_zeros(ready, best, inference),
        *_of_one_row(ready.problem, best.residual, measurement),
        *unvaried(ready.start, _inputs_of(ready.problem, measurement)),
        *_of_recorded_swing(mechanism),
        *_of_one_way(fit),
        *((apart,) if apart else _doubtful(searched)),
    )
    return _with_estimates(fit, told(free_parameters, ready.mechanism, measurement), sentences)


def _with_estimates(fit: RecordFit, free: FreeParameters, sentences: Sequence[str]) -> RecordFit:
    """Return a fit with its estimates and their intervals, and what is to be said of both."""
    best = fit.optimum.best
    # the rows of a table have no order: their halves would differ by chance alone
    untold = fit.optimum.cancelled or interleaved(fit.problem.spans)
    halves = None if untold else halves_of(fit)
    inference = fit.inference if halves is None else widened(fit.inference, best.values, halves)
    inference = inference.including(*_moved_by_looks(fit), *_moved_by_hold(fit))
    estimates = estimates_of(free, best, inference, fit.at_bounds)
    rested = [*resting_trials(fit.mechanism, fit.measurement, fit.offset)]
    bounded, refuted = said_of_rests(fit.law, estimates, rested)
    return replace(
        fit,
        remarks=(*fit.remarks, *bounded),
        estimates=estimates,
        inference=inference,
        halves=halves,
        sentences=(
            *(() if halves is None else contradiction(free, halves)),
            *refuted,
            *sentences_of(free, best, inference, fit.at_bounds, estimates),
            *sentences,
        ),
    )


def _moved_by_looks(fit: RecordFit) -> list[Array]:
    """Return how far estimates (p,) move in a narrower band, by other steps and with more noise.

    What the band cuts off a peak, and what a sampled motion hides of a bristle between samples, are
    errors that repeat from block to block, which these do not show: bands and steps do. Noise of
    positions deflects bristles in all blocks: as much again moves estimates about as far once more
    (simulation extrapolation). So it is with the back-EMF of a motor, which tells R from k_t by
    little, and with noise of a current that a torque constant is multiplied with. Empty for fits by
    simulation.

    Source: J. R. Cook, L. A. Stefanski, "Simulation-extrapolation estimation in parametric
    measurement error models", 1994.
    """
    build = fit.build
    if not isinstance(build, BalanceProblemBuilder):
        return []
    if not all("position" in one.quantities() for one in fit.measurement.records()):
        return []
    looks = [replace(build, wider=NARROW), *(replace(build, finer=steps) for steps in STEPS)]
    problems = [look.fitted(fit.measurement) for look in looks]
    problems.append(build.fitted(_noisier(fit.measurement)))
    moved = [_moved(fit, problem) for problem in problems]
    return [one for one in moved if one is not None]


def _moved_by_hold(fit: RecordFit) -> list[Array]:
    """Return how far estimates (p,) move if the force acts as early, or late, as it may.

    Where either hold may be the true one, that is under the other one, or as many half samples
    farther as runs leave open. What derivatives tell of a hold errs as estimates by derivatives do.
    """
    hold, by_derivatives = fit.hold, isinstance(fit.build, BalanceProblemBuilder)
    if hold is None or fit.optimum.cancelled or not (hold.is_open or by_derivatives):
        return []
    build = held_otherwise(fit.build) if hold.unsure > 0.0 else None
    moved = None if build is None else _moved(fit, build.fitted(fit.measurement, None))
    return [] if moved is None else [hold.unsure * moved]


def _noisier(measurement: Measurement) -> Measurement:
    """Return a measurement whose positions, and currents of a motor, have as much noise again."""
    random = np.random.default_rng(0)
    records = []
    for one in measurement.records():
        for name in ("position", "current"):
            if name in one.quantities():
                x = np.asarray(one.values(name))
                noisy = x + positive_noise(x) * random.standard_normal(len(x))
                one = replace(one, **{name: noisy})  # type: ignore[arg-type]  # noqa: PLW2901
        records.append(one)
    return replace(measurement, trials=tuple(records)) if measurement.trials else records[0]


def _moved(fit: RecordFit, problem: RecordProblem) -> Array | None:
    """Return how far one step moves the estimates (p,) in another problem of the same record."""
    free = fit.free_parameters
    here = problem.with_free_parameters(free).linearise(fit.values)
    return _step(free, here) if here.finite else None


def _zeros(ready: FitSetup, best: ResidualJacobian, inference: Inference) -> tuple[str, ...]:
    """Return a sentence on the place from which positions of a free motion count."""
    if not isinstance(ready.problem, Shooting):
        return ()
    autocorrelation = math.sqrt(max(len(best.residual) / max(inference.effective, 1.0), 1.0))
    found = ready.problem.zeros(best, autocorrelation)
    if not found:
        return ()
    unit = ready.mechanism.units[ready.mechanism.coordinates.index(slip_of(ready.mechanism))]
    shown = [
        f"{quantity(one.value, unit, 2)} ± {quantity(NORMAL_95 * one.error, unit, 2)}"
        for one in found.values()
    ]
    more = "" if len(shown) == 1 else " for each record"
    return (
        f"The zero of the position is not known and is estimated with the fit{more}:"
        f" {joined(shown)}. Levels of friction that differ by direction would look alike. If the"
        " zero is known, set position_zeros to False (--no-position-zeros).",
    )


def _inputs_of(problem: RecordProblem, measurement: Measurement) -> Sequence[Mapping[str, Array]]:
    """Return contact inputs along stretches; of simulated segments, what was recorded."""
    if isinstance(problem, ForceMap):
        return [one.path.inputs for one in problem.stretches]
    records = measurement.records()
    return [recorded_inputs(one, np.asarray(one.time)) for one in records]


def _of_one_row(
    problem: RecordProblem, residual: Array, measurement: Measurement
) -> tuple[str, ...]:
    """Return a sentence where a single row of a record leaves most of the squared residuals."""
    if measurement.trials or len(residual) < FEWEST_ROWS:
        return ()
    squares = residual**2
    at, total = int(np.argmax(squares)), float(squares.sum())
    if squares[at] <= max(LONE * total, EXACT * float(np.var(problem.measured))):
        return ()
    row = float(problem.times[at])
    timed = measurement.time is not None
    where = f"The sample at {quantity(row, 's')}" if timed else f"Row {round(row) + 1} of the table"
    return (
        f"{where} alone leaves {percent(float(squares[at]) / total)} of the squared residuals:"
        " check it for an error of measurement.",
    )


def _of_one_way(fit: RecordFit) -> tuple[str, ...]:
    """Return a sentence where a constant force is a part of the friction level."""
    if not fit.one_way:
        return ()
    return (
        "The rows that are compared slip in one direction only: a constant force (gravity, a cable,"
        " a sensor offset) and the friction level cannot be told apart. The level includes it, and"
        " its interval does not allow for it. Move in the other direction, too, or give the force"
        " in fixed.",
    )


def _of_recorded_swing(mechanism: Mechanism) -> tuple[str, ...]:
    """Return a sentence where a recorded motion drives, whose error no interval holds."""
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    drives = mechanism.drives()
    guided = ((name, drives[guide.drive]) for name, guide in mechanism.guided().items())
    return tuple(
        f"The motion of {name} is a recorded one, whose acceleration has a standard error of"
        f" {quantity(drive.acceleration_error, f'{units[name]}/s^2')} from noise, beside what its"
        " smoothing flattens: neither is part of the intervals."
        for name, drive in guided
        if isinstance(drive, SampledSwing)
    )


def _doubtful(found: OptimizeResult) -> tuple[str, ...]:
    """Return a sentence where no other start came to the least residual."""
    if found.hopeless:
        return (
            f"The search from {count(len(found.costs), 'start')} was stopped early: the least"
            " residual is more than three times that of another law.",
        )
    if found.agreeing > 1 or len(found.costs) == 1:
        return ()
    return (
        f"Only one of {len(found.costs)} starts reached the smallest residual: the search may have"
        " ended in a local minimum, which the intervals do not show.",
    )
