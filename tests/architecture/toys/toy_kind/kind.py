"""Slides: the kind that joins fit, selection and page."""

from dataclasses import replace
from functools import partial
from typing import final

import numpy as np
from typing_extensions import override

from stickslip.data import Measurement
from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import CandidateSpec, Coulomb
from stickslip.identify.candidates import (
    UNMEASURED,
    CrossValidation,
    Wording,
    as_good,
    choose,
    errs_more,
    friction_of,
    held_out,
    held_out_text,
    outcome_beside,
    specifications,
)
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds import Kind, Request
from stickslip.identify.kinds.kind import SeveralLaws
from stickslip.identify.selection import checked
from stickslip.show.formatting import joined, quantity, with_unit

from .fit import DURATION, SlideFit, fit_slides, problem_of
from .verdict import COLUMNS, MILLIMETRES, ROUTE, SlideCandidate, SlideVerdict

USUAL = ("viscous", "coulomb", "coulomb-viscous")


@final
class SlideKind(Kind[SlideFit, SlideVerdict]):
    """Blocks that slide down an incline, whose way is read after a noted time."""

    routes = (ROUTE,)
    measured = "slides"
    uses = frozenset()
    conditions = frozenset({DURATION})
    columns = COLUMNS

    @override
    def serves(self, measurement: Measurement) -> bool:
        return all(
            "travel" in record.quantities() and record.condition(DURATION, "s") is not None
            for record in measurement.records()
        )

    @override
    def candidates(self, laws: SeveralLaws | None, measurement: Measurement) -> list[str]:
        return [specification.name for specification in specifications(laws or list(USUAL))]

    @override
    def residual_text(self, error: float, request: Request) -> str:
        return f"residual {quantity(error, 'm', 2)}"

    @override
    def fit(self, request: Request) -> SlideFit:
        return fit_slides(**request.arguments("law"))

    @override
    def select(self, request: Request) -> SlideVerdict:
        chosen = specifications(request.laws or list(USUAL))
        mechanism, measurement = request.mechanism, request.measurement
        checks = checked(mechanism, measurement, conditions=self.conditions)
        judged = [_judged(one, request) for one in chosen]
        scored = [one for one in judged if one.validation]
        if not scored:
            raise ConvergenceError(
                "; ".join(f"{candidate.title}: {candidate.dropped}" for candidate in judged)
            )
        closest = choose(scored)
        alike = [
            one
            for one in scored
            if one is not closest and as_good(one, closest) and closest.name not in one.simpler
        ]
        rest = sorted(
            (one for one in judged if one is not closest), key=lambda candidate: candidate.score
        )
        useless = not errs_more(_frictionless(request), closest)
        ordered = [
            replace(
                one,
                outcome=outcome_beside(one, closest, tied=one in alike, recommended=not useless),
            )
            for one in (closest, *rest)
        ]
        return SlideVerdict(
            mechanism=mechanism,
            measurement=measurement,
            words=_words(ordered[0], [one.title for one in alike], useless=useless),
            candidates=tuple(ordered),
            best=None if useless else ordered[0],
            not_recommended=ordered[0] if useless else None,
            ranked=len(ordered) > 1,
            checks=checks,
        )


def _judged(one: CandidateSpec, request: Request) -> SlideCandidate:
    """Return a law fitted to all slides, and its errors at settings that were held out."""
    bare = SlideCandidate(name=one.name, title=one.title, fit=None)
    # in a selection, progress is told the name of the candidate first
    watch = request.progress and partial(request.progress, one.name)
    asked = replace(request, law=one.law, laws=None, progress=watch)
    try:
        fit = fit_slides(**asked.arguments("law"))
    except (ConvergenceError, InputError) as error:
        return replace(bare, dropped=str(error))
    best = fit.optimum.best
    return replace(
        bare,
        fit=fit,
        validation=CrossValidation.by_segment(held_out(fit.problem, best), best.segment),
    )


def _frictionless(request: Request) -> SlideCandidate:
    """Return what no friction at all leaves."""
    none = Coulomb(kinetic_coefficient=0.0)
    problem = problem_of(request.mechanism, none, request.measurement, free=())
    seen = problem.linearise(np.zeros(0), slopes=False)
    found = CrossValidation.by_segment(seen.residual, seen.segment)
    return SlideCandidate(name="none", title="No friction", fit=None, validation=found)


def _between(one: Estimate) -> str:
    return with_unit(one.range.replace(" to ", " and "), one.quantity.unit)


def _words(closest: SlideCandidate, alike: list[str], *, useless: bool) -> Wording:
    assert closest.fit is not None
    name, fit = friction_of(closest.title), closest.fit
    verdict = f"Use {name}." if not useless else f"{name} predicts no better than none."
    ties = (f"These slides do not distinguish it from {joined(alike)}.",) if alike else ()
    return Wording(
        verdict=verdict,
        lede=held_out_text(
            MILLIMETRES, closest.score, closest.score_error, "each setting held out in turn"
        ),
        settles=tuple(
            f"${estimate.quantity.symbol}$ lies between {_between(estimate)}."
            for estimate in fit.estimates
            if estimate.bounded
        ),
        cannot_tell=(*ties, *fit.sentences, UNMEASURED),
        measure_next=(),
        no_score="",
    )
