"""The verb `select` for travels."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from stickslip.errors import InputError
from stickslip.experiments import Measurement, check, refuse_faults
from stickslip.formatting import joined, lower_first
from stickslip.friction import (
    DirectionDependent,
    FrictionLaw,
    PowerViscous,
    Stribeck,
    anywhere,
    containment_of,
    law_type,
    listed,
)
from stickslip.identification import (
    Estimate,
    Laws,
    Parameters,
    TravelModel,
    Trial,
    required_of,
    standard_errors,
    starting_law,
    trials_of,
    under_cycles,
)
from stickslip.kinds.travels.admissibility import (
    LEVEL,
    SURE,
    chosen,
    improves_on,
    limit_of,
    mark_passed_over,
    reaching,
    told_apart,
    unsettling,
)
from stickslip.kinds.travels.candidates import try_law, turning, with_held_out
from stickslip.kinds.travels.contradictions import (
    Contradiction,
    closest_of,
    contradiction,
    refuted_by_travels,
)
from stickslip.kinds.travels.drift import drifting
from stickslip.kinds.travels.fit import compile_for, payable
from stickslip.kinds.travels.result import TravelFit
from stickslip.kinds.travels.separations import Proposal, Separation, propose, separations
from stickslip.identify.kinds.travel_starts import room_for
from stickslip.kinds.travels.verdict import TravelCandidate, TravelVerdict, misfit
from stickslip.kinds.travels.wording import undecided, wording
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary
from stickslip.selection import Watch, check_any, check_apart

PLAIN = tuple(name for name, one in listed().items() if not one.on_request)
"""What a few travels can be compared with: they have no direction and no more than a slope."""
BESIDE = (Stribeck, PowerViscous, DirectionDependent)
"""Laws that are tried beside those that were asked for, with what travels seldom exclude: more
friction at rest, a power of the speed, and other friction to the other side."""
WORTH = 0.7
"""Share of the root mean square residual that fitting assumed values must leave at most."""
STEP = 0.1
"""Step over half the interval of a parameter at which it is seen how far a prediction moves."""
UNSTATED = 0.02
"""Share of the travels up to which residuals count as small where no uncertainty was stated."""


def select_travels(
    mechanism: Mechanism,
    laws: Laws | None,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    assumed: Mapping[str, Sequence[str]] | None = None,
    t_end: float = 10.0,
    progress: Watch | None = None,
) -> TravelVerdict:
    """Fit every law to measured travels, compare them, and say what the data cannot tell.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, Viscous
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> verdict = select_travels(rig, [Coulomb, Viscous], reading)
    >>> verdict.best.name, verdict.ranked
    ('coulomb', False)
    """
    varied = Parameters.of(mechanism, None, vary, fixed, measurement=measurement)
    if varied.unknown:
        raise InputError(
            f"laws are compared by travels with the mechanism as it is given, and vary names"
            f" {joined(list(varied.unknown))}: fit these first with one law (fit takes the same"
            " vary), give the mechanism the values found and state their uncertainties, and compare"
            " laws then."
        )
    mechanism = varied.mechanism
    refuse_faults(measurement, mechanism)
    trials = trials_of(mechanism, measurement, t_end)
    if isinstance(laws, Mapping) and not laws:
        laws = None  # a rig file without friction values: the command tries the usual laws too
    named = _named(laws)
    check_any(named)
    scored = len({trial.setting for trial in trials}) > 1
    ordinary = _ordinary(laws)
    compile_for(trials, named.values())
    marks = assumed or {}
    candidates: list[TravelCandidate] = []
    for name in sorted(named, key=lambda one: len(required_of(type(named[one])))):
        law, usual = named[name], name in ordinary
        found = try_law(
            name,
            law,
            trials,
            t_end=t_end,
            ordinary=usual,
            simpler=candidates,
            marked=marks.get(name, ()),
            watch=progress,
        )
        candidates.append(found)
    candidates.sort(key=lambda c: list(named).index(c.name))
    if scored:
        candidates = _freed(candidates, trials, t_end, progress)
        candidates = _followed(candidates, trials, t_end, progress)
    candidates = [_refuted(c, trials, t_end) for c in candidates]
    if scored:
        candidates += _beside(candidates, trials, t_end, progress)
    candidates, best, against, open_ = (
        _ranked(candidates, trials, t_end, progress)
        if scored
        else (candidates, _plainest(candidates), _repeats_of(candidates, trials), [])
    )
    closest = best
    if against is not None or open_:
        best = None
    fitted = {c.name: c.fit.law for c in candidates if c.fit and not c.dropped}
    predictions = separations(mechanism, fitted, t_end=t_end, trials=trials)
    proposal = (
        None if best is None else _proposal(mechanism, trials, candidates, best, predictions, t_end)
    )
    words = (
        undecided(trials, candidates, closest, open_)
        if open_
        else wording(
            trials,
            candidates,
            best,
            proposal,
            against,
            ranked=scored,
            found=check(measurement).findings,
        )
    )
    return TravelVerdict(
        mechanism=mechanism,
        measurement=measurement,
        candidates=tuple(candidates),
        best=best,
        ranked=scored and best is not None,
        separations=predictions,
        proposal=proposal,
        words=words,
        t_end=t_end,
    )


def _named(laws: Laws | None) -> dict[str, FrictionLaw]:
    if isinstance(laws, Mapping):
        return dict(laws)
    chosen = _kinds(laws)
    made = [starting_law(law) if isinstance(law, type) else law for law in chosen]
    check_apart([law.name for law in made])
    return {law.name: law for law in made}


def _ordinary(laws: Laws | None) -> set[str]:
    """Return the names of the laws whose values nobody gave."""
    if isinstance(laws, Mapping):
        return set()
    return {law.name for law in _kinds(laws) if isinstance(law, type)}


def _kinds(
    laws: Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
) -> list[FrictionLaw | type[FrictionLaw]]:
    """Return laws with the types that names stand for."""
    return [
        law_type(one) if isinstance(one, str) else one for one in (PLAIN if laws is None else laws)
    ]


def _plainest(candidates: Sequence[TravelCandidate]) -> TravelCandidate | None:
    """Return the law that explains the data with the fewest parameters.

    Laws that can hold a body at rest come first, since it did come to rest.
    """
    explained = [c for c in candidates if not c.dropped]
    holding = [c for c in explained if anywhere(c.law).break_away(1.0) > 0]
    return min(holding or explained, key=_size, default=None)


def _size(candidate: TravelCandidate) -> int:
    return len(list(parameters(candidate.law, "friction")))


def _repeats_of(
    candidates: Sequence[TravelCandidate], trials: Sequence[Trial]
) -> Contradiction | None:
    """Return what speaks against repeats of one setting."""
    plainest = _plainest(candidates)
    return None if plainest is None else contradiction(trials, plainest, candidates)


def _freed(
    candidates: Sequence[TravelCandidate],
    trials: Sequence[Trial],
    t_end: float,
    watch: Watch | None,
) -> list[TravelCandidate]:
    """Fit what was invented or assumed too, where the readings call for more and pay for it.

    That is where the law that they call for so far leaves more than their uncertainty, and there
    are more settings than parameters.
    """
    best = chosen(candidates)
    enough = best is not None and best.fit is not None and not _leaves_much(best.fit)
    wanted = unsettling(candidates, best, LEVEL)
    if enough and not wanted:
        return list(candidates)
    settings = len({trial.setting for trial in trials})
    simpler = [other for other in candidates if not other.invented]
    found = []
    for c in candidates:
        free = _to_free(c, settings)
        # what was invented has been looked for already: a law that explains no more stays as it is
        if free and c.fit is not None and (c in wanted or not c.invented):
            others = [other for other in simpler if other is not c]
            freed = try_law(
                c.name, c.law, trials, t_end=t_end, ordinary=c.ordinary, simpler=[*others, c],
                marked=c.marked, free=free, watch=watch,
            )  # fmt: skip
            better = not freed.dropped and (c.invented or misfit(freed) < WORTH * misfit(c))
            found.append(freed if better else c)
        else:
            found.append(c)
    return found


def _followed(
    candidates: Sequence[TravelCandidate],
    trials: Sequence[Trial],
    t_end: float,
    watch: Watch | None,
) -> list[TravelCandidate]:
    """Fit laws with invented values again from the best law, where they contain it but err more.

    They can do what it does: their own search ended elsewhere, or with a body that does not rest.
    One with bristles is searched thoroughly where readings tell more of the best law than a level
    and a slope: else its search would know no valley but that of the best law.
    """
    best = chosen(candidates)
    if best is None or best.fit is None:
        return list(candidates)
    fitted = {one.path.rpartition(".")[2] for one in best.fit.estimates}
    plain = chosen([c for c in candidates if c is not best])
    found = []
    for c in candidates:
        contains = containment_of(type(c.law), type(best.law)) is not None
        unseen = c.law.states and not fitted.isdisjoint(c.invented) and not under_cycles(trials)
        worse = c.dropped or unseen or improves_on(best, c, SURE)
        if c is not best and c.invented and contains and worse:
            again = try_law(
                c.name, c.law, trials, t_end=t_end, ordinary=c.ordinary,
                simpler=[best, plain] if unseen and plain else [best],
                marked=c.marked, thorough=bool(unseen), watch=watch,
            )  # fmt: skip
            better = not again.dropped and (c.dropped or misfit(again) < misfit(c))
            found.append(again if better else c)
        else:
            found.append(c)
    return found


def _refuted(candidate: TravelCandidate, trials: Sequence[Trial], t_end: float) -> TravelCandidate:
    """Return a candidate without its fit where the readings refute what was given of it."""
    if candidate.ordinary:
        return candidate
    law, held = candidate.law, candidate.assumed
    if candidate.fit is None:
        free = payable(law, trials)
        paths = [path for path, _, _ in parameters(law, "friction")]
        held = tuple(path.rpartition(".")[2] for path in paths if path not in free)
    else:
        law = candidate.fit.law
    said = refuted_by_travels(law, held, trials, t_end=t_end)
    if not said:
        return candidate
    why = lower_first(said)
    return replace(candidate, fit=None, run=None, criteria=None, refuted=said, dropped=why)


def _beside(
    candidates: Sequence[TravelCandidate],
    trials: Sequence[Trial],
    t_end: float,
    watch: Watch | None,
) -> list[TravelCandidate]:
    """Return laws with parts that no candidate has, as far as they can be fitted."""
    known = [type(c.law) for c in candidates]
    closest = chosen(candidates) or closest_of(candidates)
    if closest is None or closest.fit is None:
        return []
    found = []
    for kind in BESIDE:
        if any(one is kind or (containment_of(one, kind) and not one.states) for one in known):
            continue
        law = starting_law(kind)
        free = payable(law, trials)
        if kind is DirectionDependent:
            if not turning(closest.fit, t_end):
                continue
            free = [f"friction.{side}_kinetic_coefficient" for side in ("forward", "backward")]
        compile_for(trials, [law])
        one = try_law(
            law.name, law, trials, t_end=t_end, ordinary=True, simpler=candidates,
            free=free, watch=watch,
        )  # fmt: skip
        if not one.dropped:
            found.append(replace(one, beside=True))
    return found


def _to_free(candidate: TravelCandidate, settings: int) -> list[str]:
    """Return the paths to fit where ordinary or assumed values may be wrong.

    Of assumed values those come first that move the travel most.
    """
    if candidate.invented:
        needed = [*required_of(type(candidate.law)), *candidate.invented]
        paths = [f"friction.{name}" for name in dict.fromkeys(needed)]
        paths += (
            [e.path for e in candidate.fit.estimates if e.path not in paths]
            if (candidate.fit and len(paths) + 1 < settings)
            else []
        )
        return paths if len(paths) < settings else []
    moving = [name for name in candidate.marked if candidate.influence.get(name, 0.0) > 0.0]
    if not moving or candidate.fit is None:
        return []
    moving.sort(key=lambda name: -candidate.influence[name])
    paths = [e.path for e in candidate.fit.estimates][:1]
    return [*paths, *(f"friction.{name}" for name in moving)][: max(settings - 1, 0)]


def _leaves_much(fit: TravelFit) -> bool:
    """Whether residuals exceed the stated uncertainty, or else a fiftieth of the travels."""
    if fit.stated:
        return fit.variance != (1.0, math.inf)
    left = sum(r * r for r in fit.residuals) / max(fit.freedom, 1)
    return left > UNSTATED**2 * sum(m * m for m in fit.measured) / len(fit.measured)


def _ranked(
    candidates: Sequence[TravelCandidate],
    trials: Sequence[Trial],
    t_end: float,
    watch: Watch | None,
) -> tuple[
    list[TravelCandidate], TravelCandidate | None, Contradiction | None, list[TravelCandidate]
]:
    """Choose, order the others by held-out error, and return what speaks against the choice.

    That is a contradiction, or laws that explain more, with invented parameters. Those are not
    scored, nor, if their runs take long, are those that are ruled out, and all where no law can be
    named.
    """
    best = chosen(candidates)
    slow = under_cycles(trials)
    named = not _explaining(trials, unsettling(candidates, best))
    scored = [
        c
        if c.invented or (best and (slow or c.law.states) and (not named or told_apart(c, best)))
        else with_held_out(c, trials, t_end=t_end, watch=watch)
        for c in candidates
    ]
    best = chosen(scored)
    if best is None:
        return scored, None, None, _explaining(trials, unsettling(scored, None))
    against = contradiction(trials, best, scored)
    if against is not None:
        # a law that explains the readings alone explains them beside others too
        tested = [c for c in scored if c.fit is not None and c.fit.freedom > 0]
        if better := chosen(_explaining(trials, tested)):
            best, against = better, None
    if open_ := _explaining(trials, unsettling(scored, best)):
        return scored, best, None, open_
    if against is None:
        marked = mark_passed_over(scored, best)
        ties = [c for c in marked if c is not best and not c.distinguished]
        drifts = _drifting(marked, best, t_end)
        whole = reaching(best, [*ties, *drifts])
        whole = replace(whole, otherwise={c.name: c.drifts for c in drifts})
        marked, best = [whole if c is best else c for c in marked], whole
    else:  # where no law is named, none is passed over for it
        marked, best = scored, closest_of(scored) or best
    others = [c for c in marked if c is not best]
    others.sort(key=lambda c: (c.beside, bool(c.dropped), math.inf if c.score is None else c.score))
    return [best, *others], best, against, []


def _drifting(
    candidates: Sequence[TravelCandidate], best: TravelCandidate, t_end: float
) -> list[TravelCandidate]:
    """Return laws that are ruled out, are simpler, and are not if friction drifts over trials."""
    ruled_out = [c for c in candidates if c.distinguished and c.parameters < best.parameters]
    with_drift = [found for c in ruled_out if (found := drifting(c, t_end))]
    return [c for c in with_drift if not told_apart(c, best)]


def _explaining(
    trials: Sequence[Trial], candidates: Sequence[TravelCandidate]
) -> list[TravelCandidate]:
    """Return the candidates that the readings do not contradict."""
    return [c for c in candidates if contradiction(trials, c, [c]) is None]


def _proposal(
    mechanism: Mechanism,
    trials: Sequence[Trial],
    candidates: Sequence[TravelCandidate],
    best: TravelCandidate,
    predictions: Sequence[Separation],
    t_end: float,
) -> Proposal | None:
    """Propose what tells the best law from those not distinguished from it, or else from others."""
    others = [c for c in candidates if c is not best and c.fit is not None and not c.dropped]
    rivals = [c for c in others if not c.distinguished] or others
    errors, _ = standard_errors(trials)
    doubt = max(2.0 * float(errors.max()), best.score or 0.0)
    asked = [
        replace(trials[0], mechanism=vary(mechanism, "mechanism", {row.path: row.value}))
        for row in predictions
    ]
    uncertain = {
        c.name: _prediction_errors(c, asked, [row.predicted[c.name] for row in predictions], t_end)
        for c in (best, *rivals)
    }
    return propose(predictions, best.name, [c.name for c in rivals], doubt, uncertain)


def _step(law: FrictionLaw, one: Estimate, step: float) -> float:
    """Return a step from an estimate with which the law keeps its inequalities, down if it can be.

    The others stay as they are. What must not fall below another value may be as low as that one.
    """
    name = one.path.rpartition(".")[2]
    below = 0.0 if one.quantity.at_least is not None else one.value - limit_of(law, name)
    above = room_for(law, name)[1] - one.value
    if below > step or below > above:
        return -min(step, 0.5 * below) if below <= step else -step
    return min(step, max(above, 0.0))


def _prediction_errors(
    candidate: TravelCandidate, asked: Sequence[Trial], predicted: Sequence[float], t_end: float
) -> list[float]:
    """Return half the 95 % interval of what a law predicts at each setting [m], given that.

    It follows, to first order, from what the readings leave of its parameters if it holds.
    """
    assert candidate.fit is not None
    found = candidate.alone or candidate.fit.estimates
    model = TravelModel(candidate.fit.law, [e.path for e in found], t_end)
    half = np.array([0.5 * (e.high - e.low) if e.bounded else math.inf for e in found])
    values = np.array([e.value for e in found])
    steps = STEP * np.where(np.isfinite(half) & (half > 0.0), half, np.abs(values))
    if not asked:
        return []
    steps = np.array(
        [_step(candidate.fit.law, e, step) for e, step in zip(found, steps, strict=True)]
    )
    table = model.table(asked, values + np.diag(steps))
    moved = ((table - predicted) / np.where(steps != 0.0, steps, math.inf)[:, None]).T
    parts = np.where(moved != 0.0, moved * np.where(moved != 0.0, half, 0.0), 0.0)
    open_ = ~np.isfinite(parts).all(axis=1)
    parts[open_] = 0.0
    correlation = np.array(candidate.fit.correlation)
    squares = np.einsum("ni,ij,nj->n", parts, correlation, parts)
    return [*map(float, np.where(open_, math.inf, np.sqrt(np.maximum(squares, 0.0))))]
