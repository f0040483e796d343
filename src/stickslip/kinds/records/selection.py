"""Selection on records: every law fitted, judged on blocks it has not seen, one named."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial

from stickslip.errors import ConvergenceError, InputError, SimulationError
from stickslip.experiments import Checks, Measurement, with_doubts
from stickslip.formatting import Scale, lower_first, quantity
from stickslip.friction import CandidateSpec, FrictionLaw
from stickslip.identification import (
    LAW,
    FittedLaw,
    ModelError,
    Parameters,
    RecordFit,
    RecordRouteName,
    RecordSettings,
    RouteChoice,
    TrialComparison,
    better_route,
    check_horizon,
    choice_of,
    choose_route,
    compared,
    decided,
    fit_record,
    known_inputs,
    loads_motor,
    mass_held,
    memory_is_seen,
    serves_inverse_dynamics,
    tells_no_scale,
    to_compare,
    usual_segment,
    whole_record_error,
    with_simulated_hold,
    without_outliers,
)
from stickslip.kinds.kind import PURPOSES, PurposeName
from stickslip.kinds.records.admissibility import (
    objection,
    resting,
    standard_uncertainty,
    unexplained,
    unidentified,
    variation_of,
)
from stickslip.kinds.records.explained import CLOSER, TEXTBOOK, Explained, explained
from stickslip.kinds.records.ladder import Climbed, climbed, with_gears
from stickslip.kinds.records.next_measurements import experiments_after
from stickslip.kinds.records.simplification import one_part_less, untold
from stickslip.kinds.records.verdict import Purpose, RecordCandidate, RecordVerdict, SecondRecord
from stickslip.kinds.records.wording import equals_of, outcomes, record_wording
from stickslip.mechanisms import Mechanism
from stickslip.quantities import fields_of, vary
from stickslip.selection import (
    ALIKE,
    APART,
    LEFT_OUT,
    REFERENCE,
    Plan,
    Watch,
    apart,
    as_good,
    checked,
    choose,
    contains,
    control,
    cross_validate,
    disturbing,
    effective_aic,
    errs_more,
    halves,
    one_way,
    plan_of,
    refuted_by_record,
    shown_over_simpler,
    specifications,
    takes_long,
)

NEARER = 1.5
"""Factor between errors from which one law is far nearer than another, whatever they scatter by."""
AS_WELL = 1.1
"""Error over that of a law up to which one predicts as well that lacks what no record tells."""
SIMPLER = 4
"""Laws without a part of which a record does not tell a parameter that are fitted at most; half as
many with a memory, whose fits take long."""
ROUNDING = 1e-9
"""Error over the variation of what is predicted below which a law is exact: no noise, digits."""
TOO_FAR = 2.0
"""Residual over that of a law from which one that lacks a part need not be scored."""
STIFFNESS = "bristle_stiffness"
RIGID = "not scored: the record does not tell how stiff its bristles are"
NOT_AS_WELL = "not scored: it leaves far more than the law that has a part more"
HOPELESS = (
    "not scored: its search was stopped early because the residual exceeded three times that of"
    " another law"
)


def select_records(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    purpose: PurposeName = "simulate",
    horizon: float | None = None,
    route: str | RouteChoice | None = None,
    validate: Measurement | None = None,
    settings: RecordSettings | None = None,
    progress: Watch | None = None,
    executor: Executor | None = None,
) -> RecordVerdict:
    """Select a law for records in time; arguments as in `select`.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured; trials may override its parameters.
    laws : mapping of str to FrictionLaw or sequence of FrictionLaw or type or str or None
        The candidates; the usual ones if None.
    measurement : Measurement
        Records in time of motion or friction.
    vary : str or sequence of str, optional
        Parameters of the mechanism to fit too, by path or last name.
    fixed : mapping of str to float, optional
        Values of parameters of the mechanism that are held [SI].
    purpose : {"simulate", "position", "compensate"}
        What the law is for, which sets what is scored.
    horizon : float, optional
        Length of the stretches that are predicted [s]; that of the purpose if not given.
    route : str or RouteChoice, optional
        How records are fitted, or what `choose_route` returned.
    validate : Measurement, optional
        A second record, which no fit sees.
    settings : RecordSettings, optional
        Segments, starts and seed.
    progress : callable, optional
        Called with the name of a law and its least residual so far; False ends the search with the
        best so far.
    executor : Executor, optional
        Processes that fit laws at the same time; one after the other if not given.

    Returns
    -------
    RecordVerdict
        Candidates, the law to use and sentences.
    """
    aim = aim_of(purpose, horizon, measurement)
    parameters = Parameters.of(mechanism, None, vary, fixed, measurement=measurement)
    mechanism = parameters.mechanism
    lost = tells_no_scale(mechanism, measurement, parameters.unknown)
    parameters = parameters.without_mass() if lost else parameters
    checks = checked(mechanism, measurement, validate, unknown=parameters.unknown)
    whole, (measurement, left_out) = measurement, without_outliers(mechanism, measurement)
    route = route or way_for(purpose, measurement)
    choice = (
        choose_route(mechanism, measurement, vary=[LAW, *parameters.unknown], settings=settings)
        if route is None
        else choice_of(route, measurement, settings)
    ).with_hold(mechanism, measurement)
    progress = progress and until_stopped(progress)
    asked = explained(mechanism, measurement, choice.settings, parameters.unknown, progress)
    usual = laws is None and asked is None
    chosen = asked.specs if asked and laws is None else laws_for(laws, measurement)
    if asked and laws is None:
        law, start = asked.specs[0].law, asked.starts[asked.specs[0].name].values
        near = (parameters.mechanism, law, start, measurement, parameters.unknown)
        choice = with_simulated_hold(decided(choice, *near), *near)
        if "starts" not in choice.settings.changed:
            choice = replace(choice, settings=replace(choice.settings, starts=1))
    seen = [one for one in chosen if memory_is_seen(one.law, measurement)] if asked else []
    choice = replace(choice, resolved=bool(seen) and choice.route == "inverse-dynamics")
    fitted, found = _tried(
        parameters,
        measurement,
        choice,
        chosen,
        progress,
        executor,
        usual=usual,
        leader=asked.specs[0].name if asked and laws is None else "",
        starts=asked.starts_of(chosen, parameters.unknown) if asked else {},
    )
    if asked and laws is None:
        along = partial(
            candidate_of,
            parameters=parameters,
            measurement=without_stated(measurement, "inverse-dynamics"),
            route=replace(choice, route="inverse-dynamics", alternative=None, resolved=True),
            starts={},
        )
        derivable = serves_inverse_dynamics(parameters.mechanism, measurement, parameters.unknown)
        found = _with_simulated(fitted, along, found, asked, progress) if derivable else found
        found = _with_relatives(fitted, found, asked, progress)
    if laws is None and (asked.loads_gear if asked else loads_motor(mechanism, measurement)):
        known = known_inputs(mechanism, measurement)
        found = with_gears(found, fitted, progress, executor, seen=with_contained, known=known)
    with with_doubts(measurement, mechanism, of=ConvergenceError):
        plan, judged, without = judged_of(
            fitted,
            found,
            aim,
            validate=validate,
            whole=purpose == "simulate",
            progress=progress,
            executor=executor,
        )
        if asked and laws is None:
            work = partial(_judged, plan=plan, validate=validate, whole=purpose == "simulate")
            judged = _simplified(fitted, work, judged, found.specs, asked, progress)
    if asked:
        judged = [with_errors(c, asked, judged, usual=laws is None) for c in judged]
    if lost:
        judged = [_with_error(c, mass_held(mechanism, measurement)) for c in judged]
    judged = [replace(c, fit=c.fit and replace(c.fit, left_out=left_out)) for c in judged]
    verdict = verdict_on(
        mechanism, whole, judged, without, plan, purpose, checks, validate, asked=asked
    )
    hold = verdict.closest.fit.hold if verdict.closest.fit else None
    return replace(
        verdict,
        settings=hold.applied(choice.settings) if hold else choice.settings,
        usual=laws is None,
        untried=found.untried,
        why_untried=found.why,
    )


def judged_of(
    fitted: Callable[..., RecordCandidate],
    found: Climbed,
    horizon: float,
    *,
    validate: Measurement | None,
    progress: Watch | None,
    executor: Executor | None,
    whole: bool = False,
) -> tuple[Plan, list[RecordCandidate], RecordCandidate | None]:
    """Return how laws are judged, those that were fitted with their errors, and the control."""
    fits = _fits(found.tried)
    plan = plan_of(min(fits, key=lambda fit: fit.rms), horizon=horizon)
    work = partial(_judged, plan=plan, validate=validate, whole=whole)
    controlled = partial(_control, fitted, work) if _has_control(fits[0]) else None
    judged, without = _all_judged(work, found.tried, controlled, progress, executor)
    return plan, with_contained(judged, found.specs), without


def _tried(
    parameters: Parameters[None],
    measurement: Measurement,
    choice: RouteChoice,
    chosen: Sequence[CandidateSpec],
    watch: Watch | None,
    executor: Executor | None,
    *,
    usual: bool,
    leader: str,
    starts: Mapping[str, FittedLaw],
) -> tuple[Callable[..., RecordCandidate], Climbed]:
    """Return what fits a candidate, and those that were: by the better of two open routes."""

    def by(name: RecordRouteName, reason: str) -> Callable[..., RecordCandidate]:
        return partial(
            candidate_of,
            parameters=parameters,
            measurement=without_stated(measurement, name),
            route=replace(choice, route=name, reason=reason, alternative=None),
            starts=starts,
        )

    def at_noise(one: RecordCandidate) -> bool:
        assert one.fit is not None
        stated = standard_uncertainty(measurement, one.fit.problem.quantity)
        return one.residual <= stated or one.fit.at_noise

    climb = partial(
        climbed,
        chosen,
        watch=watch,
        executor=executor,
        seen=with_contained,
        at_noise=at_noise,
        usual=usual,
        leader=leader,
    )
    fitted = by(choice.route, choice.reason)
    found = climb(fitted)
    fits = [one.fit for one in found.tried if one.fit]
    holds = {one.hold.hold for one in fits if one.hold}
    if len(holds) > 1:  # runs told them one by one; errors of one force alone can be compared
        hold = min(fits, key=lambda one: one.rms).hold
        assert hold is not None
        choice = replace(choice, hold=hold, settings=hold.applied(choice.settings))
        fitted = by(choice.route, choice.reason)
        found = climb(fitted)
        fits = [one.fit for one in found.tried if one.fit]
    if choice.alternative is None or not to_compare(choice, fits):
        return fitted, found
    try:
        others = climb(by(choice.alternative, ""))
    except InputError:  # what inverse dynamics does not serve was fitted by simulation
        return fitted, found
    why = better_route(fits, [one.fit for one in others.tried if one.fit])
    if not why:
        return fitted, found
    tried = [
        replace(one, fit=replace(one.fit, route_reason=why)) if one.fit else one
        for one in others.tried
    ]
    return by(choice.alternative, why), replace(others, tried=tuple(tried))


def _with_relatives(
    fitted: Callable[..., RecordCandidate], found: Climbed, asked: Explained, watch: Watch | None
) -> Climbed:
    """Return candidates with laws that no structure is, where the others leave more than noise."""
    while True:
        fits = [one.fit for one in found.tried if one.fit]
        new = asked.relative(fits, {spec.name for spec in found.specs})
        if new is None:
            return found
        spec, start = new
        rival = min(fits, key=lambda one: one.rms).fitted_law
        one = fitted(spec, [start] if start else [], rival.cost / rival.rows, watch)
        bristle = one.fit if spec.name == TEXTBOOK else None
        rigid = bristle is not None and STIFFNESS in unidentified(bristle)
        one = replace(one, dropped=RIGID) if rigid else one
        found = replace(found, specs=(*found.specs, spec), tried=(*found.tried, one))
        if rigid:
            return found


def _with_simulated(
    fitted: Callable[..., RecordCandidate],
    along: Callable[..., RecordCandidate],
    found: Climbed,
    asked: Explained,
    watch: Watch | None,
) -> Climbed:
    """Return simulated candidates with one that no structure is, if they leave more than noise.

    A simulated fit of one takes half a minute: fits along the measured motion, which take seconds,
    say which. What they leave is mostly the noise of derivatives.
    """
    bristled = [one for one in found.tried if one.fit and one.fit.law.states]
    closest = min(bristled, key=lambda one: one.residual, default=None)
    if closest is None or closest.fit is None or not closest.fit.problem.simulates:
        return found
    if closest.fit.at_noise:  # no law leaves less
        return found
    spec = found.specs[found.tried.index(closest)]
    try:
        first = along(spec, [closest.fit.fitted_law], 0.0, watch)
        shown = _with_relatives(along, Climbed(specs=(spec,), tried=(first,)), asked, watch)
    except InputError:  # what inverse dynamics does not serve was fitted by simulation
        return found
    if first.fit is None:
        return found
    fits = [(s, one.fit) for s, one in zip(shown.specs, shown.tried, strict=True) if one.fit]
    new, least = min(fits, key=lambda pair: pair[1].rms)
    if least.rms > CLOSER * first.fit.rms:
        return found
    rival = closest.fit.fitted_law
    one = fitted(new, [least.fitted_law], rival.cost / rival.rows, watch)
    return replace(found, specs=(*found.specs, new), tried=(*found.tried, one))


def way_for(purpose: str | None, measurement: Measurement) -> RecordRouteName | None:
    """Return how records are fitted for a purpose: one that compensates needs the force itself.

    Examples
    --------
    >>> way_for("compensate", Measurement(time=[0.0, 1.0], position=[0.0, 1.0], force=[1.0, 1.0]))
    'inverse-dynamics'
    """
    if purpose != "compensate" or "friction" in measurement.quantities():
        return None
    return "inverse-dynamics"


def aim_of(purpose: PurposeName, horizon: float | None, measurement: Measurement) -> float:
    """Return how far predictions go [s]: longer than usual where the usual segment is."""
    if purpose not in PURPOSES:
        raise InputError(f"purpose must be one of {', '.join(PURPOSES)}, got {purpose!r}.")
    if horizon is None:
        return PURPOSES[purpose] * usual_segment(measurement) / RecordSettings().segment
    check_horizon(horizon)
    return horizon


def laws_for(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
    measurement: Measurement,
) -> tuple[CandidateSpec, ...]:
    """Return the candidates; by default none that the motion cannot tell."""
    chosen = specifications(laws)
    if laws is not None:
        return chosen
    if one_way(measurement):
        return tuple(one for one in chosen if not one.law.directional)
    return chosen


def without_stated(measurement: Measurement, route: str | None) -> Measurement:
    """Return a measurement without the stated uncertainty of what is compared.

    Fits refuse it, as their intervals come from what they leave; the verdict alone uses it.
    """
    compared = "friction" if "friction" in measurement.quantities() else "position"
    if route == "inverse-dynamics" and compared == "position":
        return measurement
    bare = [
        replace(one, uncertainty={k: u for k, u in one.uncertainty.items() if k != compared})
        for one in measurement.records()
    ]
    return replace(measurement, trials=tuple(bare)) if measurement.trials else bare[0]


def _has_control(fit: RecordFit) -> bool:
    """Whether a fit without friction has anything to look for."""
    return fit.problem.simulates and any(
        path.startswith("mechanism.") for path in fit.free_parameters.paths
    )


def _fits(tried: Sequence[RecordCandidate]) -> list[RecordFit]:
    """Return the fits there are, at least one."""
    fits = [candidate.fit for candidate in tried if candidate.fit]
    if not fits:
        raise ConvergenceError(
            "no candidate can predict this record: "
            + "; ".join(f"{c.title}: {c.dropped}" for c in tried)
        )
    return fits


def unfitted(one: CandidateSpec, reason: str) -> RecordCandidate:
    """Return a candidate without a fit, kept with the reason."""
    return RecordCandidate(
        name=one.name, title=one.title, fit=None, validation=None, dropped=reason
    )


def candidate_of(
    one: CandidateSpec,
    contained: Sequence[FittedLaw] = (),
    rival: float = 0.0,
    watch: Watch | None = None,
    *,
    parameters: Parameters[None],
    measurement: Measurement,
    route: RouteChoice,
    starts: Mapping[str, FittedLaw],
) -> RecordCandidate:
    """Fit one candidate; one that cannot be fitted is kept with the reason."""
    if watch is not None and watch(one.name, math.nan) is False:
        return unfitted(one, LEFT_OUT)
    if route.resolved and one.law.states:  # others may leave rests out, where bristles err most
        rival = 0.0
    report = None if watch is None else (lambda rms: watch(one.name, rms))
    fitted = partial(
        fit_record,
        parameters.mechanism,
        measurement=measurement,
        unknown=parameters.unknown,
        route=route,
        held=parameters.held,
        contained=[*contained, *([starts[one.name]] if one.name in starts else [])] or None,
        rival=rival,
        watch=report,
    )
    try:
        whole = fitted(one.law, free=one.free)
        fit = _without_spare(whole, fitted)
    except (ConvergenceError, SimulationError) as error:
        return unfitted(one, str(error))
    left_out = [
        path for path in whole.free_parameters.paths if path not in fit.free_parameters.paths
    ]
    return _fitted(one, fit, left_out)


def _fitted(one: CandidateSpec, fit: RecordFit, left_out: Sequence[str]) -> RecordCandidate:
    """Return a candidate with its fit."""
    return RecordCandidate(
        name=one.name, title=one.title, fit=fit, validation=None, left_out=tuple(left_out)
    )


def _without_spare(fit: RecordFit, fitted: Callable[..., RecordFit]) -> RecordFit:
    """Fit again without slopes that a law can do without, where they went to 0.

    The search begins at the fit as it is, with what was fitted beside the law.
    """
    rest = without_spare(fit)
    if rest is None:
        return fit
    law, free = rest
    whole = fit.fitted_law
    values = {
        path: value
        for path, value in whole.values.items()
        if path in free or not path.startswith("friction.")
    }
    own = replace(whole, law=law, values=values)
    return fitted(law, free=free, contained=[own])


def without_spare(fit: RecordFit) -> tuple[FrictionLaw, tuple[str, ...]] | None:
    """Return a law without slopes that went to 0, and what is left to fit; None if none did."""
    fields = type(fit.law).__dataclass_fields__
    spare = [
        f"friction.{name}"
        for name, quantity in fields_of(type(fit.law)).items()
        if quantity.scale == "slope" and fields[name].default == 0.0
        if fit.at_bounds.get(f"friction.{name}") == "lower"
    ]
    if not spare or fit.optimum.cancelled:
        return None
    free = [e.path for e in fit.estimates if e.path.startswith("friction.")]
    law = vary(fit.law, "friction", dict.fromkeys(spare, 0.0))
    return law, tuple(path for path in free if path not in spare)


def _judged(
    candidate: RecordCandidate, plan: Plan, validate: Measurement | None, *, whole: bool
) -> RecordCandidate:
    """Add held-out errors and objections, and the error over whole records."""
    found = with_objections(with_scores(candidate, plan, validate))
    if not whole or found.fit is None or found.validation is None:
        return found
    return replace(found, whole=whole_record_error(found.fit))


def with_scores(
    candidate: RecordCandidate, plan: Plan, validate: Measurement | None
) -> RecordCandidate:
    """Add held-out errors; a candidate without them says why."""
    if candidate.fit is None or candidate.dropped:
        return candidate
    if candidate.fit.optimum.hopeless:
        return replace(candidate, dropped=HOPELESS)
    try:
        validation = cross_validate(candidate.fit, plan)
        second = None if validate is None else candidate.fit.score(validate, horizon=plan.horizon)
    except (ConvergenceError, SimulationError) as error:
        return replace(
            candidate,
            dropped=(f"not scored: the fit without one of the held-out blocks failed: {error}"),
        )
    if not math.isfinite(validation.score):
        reason = "not scored: its simulation of a held-out block failed"
        return replace(candidate, dropped=reason, second=second)
    return replace(candidate, validation=validation, second=second)


def with_objections(candidate: RecordCandidate) -> RecordCandidate:
    """Add what speaks against the fit of a candidate that has held-out errors."""
    if candidate.fit is None or candidate.validation is None:
        return candidate
    # no force that acts beside friction is known where friction was measured
    measured = candidate.fit.friction_was_measured
    refuted = "" if measured else refuted_by_record(candidate.fit)
    return replace(
        candidate,
        dropped="; ".join(filter(None, [refuted, objection(candidate.fit)])),
        refuted=refuted,
    )


def _control(
    fitted: Callable[[CandidateSpec], RecordCandidate],
    work: Callable[[RecordCandidate], RecordCandidate],
) -> RecordCandidate:
    """Return no friction at all, fitted and judged; a rig is not accused for its sake."""
    none = fitted(control())
    return work(replace(none, fit=none.fit and replace(none.fit, known_errors=())))


def _all_judged(
    work: Callable[[RecordCandidate], RecordCandidate],
    tried: Sequence[RecordCandidate],
    controlled: Callable[[], RecordCandidate] | None,
    watch: Watch | None,
    executor: Executor | None,
) -> tuple[list[RecordCandidate], RecordCandidate | None]:
    """Return the candidates judged, and the control; each is told before it is waited for."""

    def told(name: str) -> None:
        if watch is not None:
            watch(f"held-out blocks: {name}", math.nan)

    later: dict[str, Callable[[], RecordCandidate]]
    if executor is None:
        later, last = {c.name: partial(work, c) for c in tried}, controlled
    else:
        order = sorted(tried, key=lambda c: not takes_long(c.law))
        later = {c.name: executor.submit(work, c).result for c in order}
        last = executor.submit(controlled).result if controlled else None
    judged = []
    for number, candidate in enumerate(tried, 1):
        told(f"{candidate.name}, {number} of {len(tried)}")
        judged.append(later[candidate.name]())
    if last is None:
        return judged, None
    told("no friction")
    return judged, last()


def _judgeable(judged: Sequence[RecordCandidate]) -> list[RecordCandidate]:
    """Return the candidates with a held-out error, at least one."""
    scored = [c for c in judged if c.validation and math.isfinite(c.score)]
    if not scored:
        raise ConvergenceError(
            "no candidate can be scored on held-out blocks of this record: "
            + "; ".join(f"{c.title}: {c.dropped}" for c in judged)
        )
    return scored


def with_contained(
    judged: Sequence[RecordCandidate], chosen: Sequence[CandidateSpec]
) -> list[RecordCandidate]:
    """Add to each candidate which of the others its law contains."""
    simpler = {
        rich.name: {
            one.name: one.law if isinstance(one.law, type) else type(one.law)
            for one in chosen
            if one is not rich and contains(rich, one)
        }
        for rich in chosen
    }
    return [replace(c, simpler=simpler.get(c.name, {})) for c in judged]


def verdict_on(
    mechanism: Mechanism,
    measurement: Measurement,
    judged: Sequence[RecordCandidate],
    without: RecordCandidate | None,
    plan: Plan,
    purpose: str,
    checks: Checks,
    validate: Measurement | None,
    *,
    fault: str = "",
    material: float = 0.0,
    shown: Scale | None = None,
    asked: Explained | None = None,
) -> RecordVerdict:
    """Return the verdict on candidates that were judged."""
    ordered = _with_criteria(sorted(judged, key=lambda c: c.score))
    scored = _judgeable(ordered)
    picks = _picks(scored)
    variation = variation_of(scored[0], plan.horizon)
    stated = standard_uncertainty(measurement, _quantity_of(scored))
    least = max(stated, ROUNDING * variation)
    scored = [_objected(c, scored, least) for c in scored]
    closest = _named(scored, asked, uncertainty=least)
    ordered = [next((one for one in scored if one.name == c.name), c) for c in ordered]
    ordered = [closest if c.name == closest.name else c for c in ordered]
    what = Purpose(name=purpose, horizon=plan.horizon, scored=_scored(closest, plan))
    if not fault and (fault := unexplained(closest, variation, uncertainty=stated)):
        fault += resting(checks)
    if without is not None and not _better_than(closest, without):
        wrong = [one.finding for one in asked.errors if one.share > 0.0] if asked else []
        fault = fault or (
            lower_first(wrong[0]).removesuffix(".")
            if wrong
            else "no candidate predicts it significantly better than a model without friction"
        )
    on_second = _on_second(closest, scored)
    recommended = not fault and not closest.dropped and (on_second is None or on_second.holds)
    ordered = outcomes(ordered, closest, recommended=recommended)
    closest = next(c for c in ordered if c.name == closest.name)
    assert closest.fit is not None
    # What no law explains, or the model lacks, laws cannot be told apart by.
    holds = not fault and not disturbing(closest.fit)
    experiments = experiments_after(closest, ordered, plan) if holds else ()
    trials = compared(closest.fit) if measurement.trials else None
    if material and trials and not trials.shared and _alike(trials, closest.residual, material):
        trials = None
    return RecordVerdict(
        mechanism=mechanism,
        measurement=measurement,
        words=record_wording(
            ordered,
            closest,
            without,
            picks,
            checks,
            experiments,
            scored=what.scored,
            fault=fault,
            on_second=on_second,
            trials=trials,
            shown=shown,
        ),
        candidates=tuple(ordered),
        ranked=True,
        best=closest if recommended else None,
        not_recommended=None if recommended else closest,
        reference=next((c for c in ordered if c.name == REFERENCE), None),
        control=without,
        plan=plan,
        purpose=what,
        picks=picks,
        checks=checks,
        second=validate,
        on_second=on_second,
        trials=trials,
        equals=tuple(c.name for c in equals_of(closest, ordered)),
        experiments=experiments,
        half_estimates=halves(closest.fit),
        explained=asked is not None,
        shown=shown,
    )


def _named(
    scored: Sequence[RecordCandidate], asked: Explained | None, *, uncertainty: float
) -> RecordCandidate:
    """Return the candidate that is named, with what speaks against it as its doubt."""
    searched = [c for c in scored if c.fit and not c.fit.search_failure]
    sound = [c for c in searched if not c.refuted]
    found = sound or searched or scored
    among = [c for c in found if not c.simplifies] or found
    rejected = _rejected(scored, asked)
    among = _near(among, rejected, uncertainty=uncertainty)
    closest = choose(among, uncertainty=uncertainty)
    if asked is not None:
        closest = _agreed(closest, among, asked, rejected, uncertainty=uncertainty)
    closest = _as_simulated(closest, among, rejected, uncertainty=uncertainty)
    rejected = _rejected(scored, asked, simplified=True)
    return _doubted(_told(closest, found, rejected, uncertainty=uncertainty))


def _near(
    among: Sequence[RecordCandidate], rejected: Collection[str], *, uncertainty: float
) -> list[RecordCandidate]:
    """Return the laws that are not far from the best one, both on held-out blocks and on all rows.

    What a part explains at a few places, such as presliding, scatters from block to block.
    """
    sound = [c for c in among if c.name not in rejected]
    best = min(sound or among, key=lambda c: c.score)
    return [
        c
        for c in among
        if c.score <= NEARER * max(best.score, uncertainty) or c.residual <= NEARER * best.residual
    ]


def _rejected(
    judged: Sequence[RecordCandidate], asked: Explained | None, *, simplified: bool = False
) -> frozenset[str]:
    """Return the laws that the force balance tells from its own, if fits do not say otherwise.

    Fits of laws with a bristle see every row, rests too, with values that the balance has on a grid
    only: a part more that takes less off than Akaike's criterion asks for is not needed.
    """
    if asked is None:
        return frozenset()
    own = next((c for c in judged if c.name == asked.asked.best.name), None)

    def suffices(c: RecordCandidate) -> bool:
        if own is None or not (c.fit and own.fit and c.fit.law.states and own.fit.law.states):
            return False
        aic = effective_aic([c, own])
        return c.parameters < own.parameters and aic[c.name] < aic[own.name]

    return frozenset(
        c.name
        for c in judged
        if asked.rejects(c.name, c.law, simplified=simplified) and not suffices(c)
    )


def _told(
    closest: RecordCandidate,
    among: Sequence[RecordCandidate],
    rejected: Collection[str],
    *,
    uncertainty: float,
) -> RecordCandidate:
    """Return a law without parts that the record does not tell, where one predicts as well."""

    def order(c: RecordCandidate) -> tuple[int, int, float]:
        return len(untold(c.fit)) if c.fit else 0, c.parameters, c.score

    less = [
        c
        for c in among
        if c.simplifies == closest.name or c.name in closest.simpler
        if c.score <= AS_WELL * max(closest.score, uncertainty)
        if as_good(c, closest, uncertainty=uncertainty)
        if not c.whole > NEARER * closest.whole
        if c.name not in rejected
        if order(c)[0] < order(closest)[0]
    ]
    return min(less, key=order, default=closest)


def _simplified(
    fitted: Callable[..., RecordCandidate],
    work: Callable[[RecordCandidate], RecordCandidate],
    judged: Sequence[RecordCandidate],
    specs: Sequence[CandidateSpec],
    asked: Explained,
    watch: Watch | None,
) -> list[RecordCandidate]:
    """Return candidates with those one part simpler, as long as the named one is not all known.

    A law that the balance composes may have parameters that the record does not tell. One without
    some of them is named where it predicts as well, though better by less than is told apart.
    """
    known, every, whole, left = [*judged], [*specs], None, SIMPLER
    while left > 0:
        scored = [c for c in known if c.validation and math.isfinite(c.score)]
        if not scored:
            break
        named = _named([_objected(c, scored, 0.0) for c in scored], asked, uncertainty=0.0)
        assert named.fit is not None
        whole = whole or named
        new = next((one for one in one_part_less(named.fit) if not _among(one[0], every)), None)
        if new is None:
            break
        spec, start = new
        every.append(spec)
        left -= 2 if takes_long(spec.law) else 1
        rival = named.fit.fitted_law
        less = fitted(spec, [start], rival.cost / rival.rows, watch)
        if less.fit and less.residual > TOO_FAR * named.residual:
            less = replace(less, dropped=NOT_AS_WELL)
        known = with_contained([*known, replace(work(less), simplifies=whole.name)], every)
    return known


def _among(one: CandidateSpec, specs: Sequence[CandidateSpec]) -> bool:
    """Whether a candidate is one of others, perhaps under another name."""

    def size(spec: CandidateSpec) -> int:
        kind = spec.law if isinstance(spec.law, type) else type(spec.law)
        return len(kind.fit_order if spec.free is None else spec.free)

    return any(
        one.name == other.name or (contains(other, one) and size(one) == size(other))
        for other in specs
    )


def until_stopped(watch: Watch) -> Watch:
    """Return a watcher that goes on saying so once it has asked to stop."""
    stopped: list[bool] = []

    def watched(name: str, residual: float) -> bool:
        if watch(name, residual) is False:
            stopped.append(True)
        return not stopped

    return watched


def with_errors(
    c: RecordCandidate, asked: Explained, judged: Sequence[RecordCandidate], *, usual: bool
) -> RecordCandidate:
    """Return a candidate with what the force balance says is wrong, and which values it gave.

    That it asks for another law is not said of what predicts better than a fit of that law, nor of
    what predicts as well without a part of it that the record does not tell.
    """
    if c.fit is None:
        return c
    own = asked.asked.laws.get(c.name) if usual else None
    left = math.nan if c.fit.problem.simulates else c.fit.rms
    errors = asked.errors_of(c.name, c.fit.law, left)
    far = c.name in _rejected(judged, asked, simplified=bool(c.simplifies))
    if not far or any(one.name == asked.asked.best.name and errs_more(one, c) for one in judged):
        errors = tuple(one for one in errors if one.kind != "law")
    return replace(
        c,
        fit=replace(c.fit, known_errors=errors),
        from_balance=own.held if own else (),
    )


def _with_error(c: RecordCandidate, error: ModelError) -> RecordCandidate:
    """Return a candidate with one more thing that is wrong."""
    errors = () if c.fit is None else (*c.fit.model_errors, error)
    return replace(c, fit=c.fit and replace(c.fit, known_errors=errors))


def _agreed(
    closest: RecordCandidate,
    among: Sequence[RecordCandidate],
    asked: Explained,
    rejected: Collection[str],
    *,
    uncertainty: float,
) -> RecordCandidate:
    """Return the law that both predictions and the force balance allow.

    The balance sees every row, a prediction what the errors of all rows add up to: a law that the
    balance rejects is named only if those that it allows predict worse, clearly or by far, and
    nothing is wrong beside the law. The finding that another law is asked for is then said of it.
    """
    allowed = [c for c in among if c.name not in rejected]
    if not allowed:
        return closest
    if asked.decides and (own := [c for c in allowed if c.name == asked.asked.best.name]):
        return own[0]
    best = choose(allowed, uncertainty=uncertainty)
    holds = not any(one.share > 0.0 for one in asked.errors)
    far = best.score > NEARER * max(closest.score, uncertainty)
    foretold = holds and (far or errs_more(best, closest, uncertainty=uncertainty))
    return closest if foretold else best


def _as_simulated(
    closest: RecordCandidate,
    among: Sequence[RecordCandidate],
    rejected: Collection[str],
    *,
    uncertainty: float,
) -> RecordCandidate:
    """Return the law to simulate: of those that predict as well, one that stays clearly nearer.

    Over whole records, where errors add up that short predictions do not show.
    """
    nearer = [
        c
        for c in among
        if c.whole * NEARER < closest.whole and not c.dropped
        if as_good(c, closest, uncertainty=uncertainty)
        if c.name not in rejected
    ]
    return min(nearer, key=lambda c: c.whole, default=closest)


def _alike(trials: TrialComparison, residual: float, material: float) -> bool:
    """Whether laws of their own take less than a share off the residual of all trials."""
    apart = sum(one.rms**2 for one in trials.trials) / max(len(trials.trials), 1)
    return math.sqrt(apart) > (1.0 - material) * residual


def _quantity_of(scored: Sequence[RecordCandidate]) -> str:
    """Return what is predicted, as in `QUANTITIES`."""
    return next(c.fit.problem.quantity for c in scored if c.fit)


def _with_criteria(candidates: Sequence[RecordCandidate]) -> list[RecordCandidate]:
    """Add AIC and BIC, whose rows are counted by the effective number of the best fit."""
    fitted = [c for c in candidates if c.fit]
    size = min(fitted, key=lambda c: c.residual).effective
    aic = effective_aic(fitted)
    extra = math.log(max(size, 1.0)) - 2.0
    return [
        replace(c, aic=aic[c.name], bic=aic[c.name] + extra * c.parameters) if c.fit else c
        for c in candidates
    ]


def _better_than(best: RecordCandidate, without: RecordCandidate) -> bool:
    """Whether a law predicts better than no friction."""
    return not math.isfinite(without.score) or errs_more(without, best)


def _on_second(closest: RecordCandidate, scored: Sequence[RecordCandidate]) -> SecondRecord | None:
    """Return what the second record says of the choice; None without one."""
    if closest.second is None:
        return None
    own = closest.second
    others = [
        c
        for c in scored
        if c.second is not None
        and math.isfinite(c.second.rms)
        and c.name != closest.name
        and closest.name not in c.is_simpler
    ]
    losses = {c.name: [one**2 for one in c.second.blocks] for c in others if c.second}
    mine = [one**2 for one in own.blocks]
    better = [
        c
        for c in others
        if c.second
        and (
            not math.isfinite(own.rms)  # what the choice cannot simulate needs no test
            or (own.rms > (1.0 + ALIKE) * c.second.rms and apart(mine, losses[c.name]) > APART)
        )
    ]
    rival = min(
        better or others, key=lambda c: c.second.rms if c.second else math.inf, default=None
    )
    return SecondRecord(
        error=own.rms,
        ratio=own.rms / closest.score if closest.score > 0.0 else math.inf,
        holds=not better,
        rival=rival.name if rival else "",
        rival_error=rival.second.rms if rival and rival.second else math.nan,
        segments=len(mine),
    )


def _objected(
    candidate: RecordCandidate, scored: Sequence[RecordCandidate], uncertainty: float
) -> RecordCandidate:
    """Return a candidate without objections that its predictions have answered."""
    assert candidate.fit is not None
    if (
        candidate.dropped
        and not candidate.refuted
        and shown_over_simpler(candidate, scored, uncertainty=uncertainty)
    ):
        return replace(candidate, dropped=objection(candidate.fit, shown=True))
    return candidate


def _doubted(best: RecordCandidate) -> RecordCandidate:
    """Return what is taken with what spoke against it as its doubt.

    A law whose search failed stays without recommendation: its values are not those of the least
    error. So does one with a given value that the record contradicts.
    """
    failed = best.fit is not None and best.fit.search_failure
    if best.dropped and not (best.refuted or failed):
        return replace(best, dropped="", doubt=best.dropped)
    return best


def _picks(scored: Sequence[RecordCandidate]) -> Mapping[str, str]:
    def least(key: Callable[[RecordCandidate], float]) -> str:
        # A law that is a simpler candidate at its fitted values is no pick of its own.
        known = [c for c in scored if math.isfinite(key(c)) and not c.is_simpler]
        return min(known, key=key).name if known else ""

    return {
        "held-out blocks": least(lambda c: c.score),
        "extrapolation": least(lambda c: c.validation.extrapolation if c.validation else math.nan),
        "training error": least(lambda c: c.fit.rms if c.fit else math.nan),
        "AIC": least(lambda c: c.aic),
        "BIC": least(lambda c: c.bic),
    }


def _scored(best: RecordCandidate, plan: Plan) -> str:
    """Return what is scored, in words; a block that leaves nothing to fit to is not."""
    assert best.fit is not None
    assert best.validation is not None
    count, problem = len(best.validation.losses), best.fit.problem
    blocks = f"{count} held-out block{'s' if count > 1 else ''}, root mean square"
    if not problem.simulates:
        return f"{problem.quantity} on {blocks}"
    return f"{problem.quantity} over {quantity(plan.horizon, 's', 2)} on {blocks}"
