"""Selection on records: every law fitted, judged on blocks it has not seen, one named."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace

from stickslip.errors import ConvergenceError, SimulationError
from stickslip.experiments import Checks, Measurement
from stickslip.formatting import Scale, lower_first
from stickslip.friction import CandidateSpec, FrictionLaw
from stickslip.identification import (
    RecordFit,
    TrialComparison,
    compared,
)
from stickslip.kinds.joints.admissibility import (
    objection,
    resting,
    standard_uncertainty,
    unexplained,
    variation_of,
)
from stickslip.kinds.joints.explained import Explained
from stickslip.kinds.joints.joint_verdict import RecordCandidate, RecordVerdict, SecondRecord
from stickslip.kinds.joints.simplification import untold
from stickslip.kinds.joints.wording import equals_of, outcomes, record_wording
from stickslip.mechanisms import Mechanism
from stickslip.quantities import fields_of, vary
from stickslip.selection import (
    ALIKE,
    APART,
    REFERENCE,
    Plan,
    apart,
    as_good,
    choose,
    contains,
    cross_validate,
    effective_aic,
    errs_more,
    halves,
    refuted_by_record,
    shown_over_simpler,
)

NEARER = 1.5
"""Factor between errors from which one law is far nearer than another, whatever they scatter by."""
AS_WELL = 1.1
"""Error over that of a law up to which one predicts as well that lacks what no record tells."""
ROUNDING = 1e-9
"""Error over the variation of what is predicted below which a law is exact: no noise, digits."""
HOPELESS = (
    "not scored: its search was stopped early because the residual exceeded three times that of"
    " another law"
)


def unfitted(one: CandidateSpec, reason: str) -> RecordCandidate:
    """Return a candidate without a fit, kept with the reason."""
    return RecordCandidate(
        name=one.name, title=one.title, fit=None, validation=None, dropped=reason
    )


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
    variation = variation_of(scored[0])
    stated = standard_uncertainty(measurement, _quantity_of(scored))
    least = max(stated, ROUNDING * variation)
    scored = [_objected(c, scored, least) for c in scored]
    closest = _named(scored, asked, uncertainty=least)
    ordered = [next((one for one in scored if one.name == c.name), c) for c in ordered]
    ordered = [closest if c.name == closest.name else c for c in ordered]
    scored_on = _scored(closest)
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
            scored=scored_on,
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
        scored_on=scored_on,
        picks=picks,
        checks=checks,
        second=validate,
        on_second=on_second,
        trials=trials,
        equals=tuple(c.name for c in equals_of(closest, ordered)),
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
    rejected = _rejected(scored, asked)
    among = _near(found, rejected, uncertainty=uncertainty)
    closest = choose(among, uncertainty=uncertainty)
    if asked is not None:
        closest = _agreed(closest, among, asked, rejected, uncertainty=uncertainty)
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
        if c.name in closest.simpler
        if c.score <= AS_WELL * max(closest.score, uncertainty)
        if as_good(c, closest, uncertainty=uncertainty)
        if c.name not in rejected
        if order(c)[0] < order(closest)[0]
    ]
    return min(less, key=order, default=closest)


def with_errors(
    c: RecordCandidate, asked: Explained, judged: Sequence[RecordCandidate], *, usual: bool
) -> RecordCandidate:
    """Return a candidate with what the force balance says is wrong, and which values it gave.

    That it asks for another law is not said of what predicts better than a fit of that law.
    """
    if c.fit is None:
        return c
    own = asked.asked.laws.get(c.name) if usual else None
    errors = asked.errors_of(c.name, c.fit.law, c.fit.rms)
    far = c.name in _rejected(judged, asked)
    if not far or any(one.name == asked.asked.best.name and errs_more(one, c) for one in judged):
        errors = tuple(one for one in errors if one.kind != "law")
    return replace(
        c,
        fit=replace(c.fit, known_errors=errors),
        from_balance=own.held if own else (),
    )


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
    if own := [c for c in allowed if c.name == asked.asked.best.name]:
        return own[0]
    best = choose(allowed, uncertainty=uncertainty)
    holds = not any(one.share > 0.0 for one in asked.errors)
    far = best.score > NEARER * max(closest.score, uncertainty)
    foretold = holds and (far or errs_more(best, closest, uncertainty=uncertainty))
    return closest if foretold else best


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


def _scored(best: RecordCandidate) -> str:
    """Return what is scored, in words; a block that leaves nothing to fit to is not."""
    assert best.fit is not None
    assert best.validation is not None
    count, problem = len(best.validation.losses), best.fit.problem
    blocks = f"{count} held-out block{'s' if count > 1 else ''}, root mean square"
    return f"{problem.quantity} on {blocks}"
