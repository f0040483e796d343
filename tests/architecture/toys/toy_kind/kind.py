"""Slides: the kind that joins fit, selection and page."""

import math
from dataclasses import replace
from functools import partial
from typing import final

import numpy as np
from typing_extensions import override

from stickslip.data import Measurement
from stickslip.errors import ConvergenceError, InputError
from stickslip.friction import CandidateSpec, Coulomb
from stickslip.identify.candidates import UNMEASURED, Wording, friction_of, specifications
from stickslip.identify.fits import Estimate, ResidualJacobian
from stickslip.identify.kinds import Kind, Request
from stickslip.identify.kinds.kind import SeveralLaws
from stickslip.identify.selection import checked
from stickslip.show.formatting import joined, quantity, with_unit

from .fit import DURATION, SlideFit, fit_slides, problem_of
from .verdict import COLUMNS, ROUTE, SlideCandidate, SlideVerdict

ALIKE = 4.0
"""Difference of criteria up to which laws are not told apart."""
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
        if all(one.fit is None for one in judged):
            raise ConvergenceError(
                "; ".join(f"{candidate.title}: {candidate.dropped}" for candidate in judged)
            )
        ordered = sorted(judged, key=lambda candidate: candidate.criterion)
        closest = ordered[0]
        alike = [one for one in ordered[1:] if one.criterion < closest.criterion + ALIKE]
        useless = _frictionless(request) < closest.criterion + ALIKE
        told = [
            replace(
                one,
                outcome="chosen"
                if one is closest
                else ("not told apart" if one in alike else one.dropped),
            )
            for one in ordered
        ]
        return SlideVerdict(
            mechanism=mechanism,
            measurement=measurement,
            words=_words(told[0], [one.title for one in alike], useless=useless),
            candidates=tuple(told),
            best=None if useless else told[0],
            ranked=len(told) > 1,
            checks=checks,
        )


def _judged(one: CandidateSpec, request: Request) -> SlideCandidate:
    """Return a law fitted to all slides, with its criterion."""
    bare = SlideCandidate(name=one.name, title=one.title, fit=None)
    # in a selection, progress is told the name of the candidate first
    watch = request.progress and partial(request.progress, one.name)
    asked = replace(request, law=one.law, laws=None, progress=watch)
    try:
        fit = fit_slides(**asked.arguments("law"))
    except (ConvergenceError, InputError) as error:
        return replace(bare, dropped=str(error))
    return replace(bare, fit=fit, criterion=_criterion(fit.optimum.best, len(fit.estimates)))


def _criterion(seen: ResidualJacobian, parameters: int) -> float:
    """Return Akaike's criterion, with what few rows add to it."""
    rows = len(seen.residual)
    spare = max(rows - parameters - 2, 1)
    return 2.0 * rows * math.log(seen.rms) + 2.0 * (parameters + 1) * rows / spare


def _frictionless(request: Request) -> float:
    """Return the criterion of no friction at all."""
    none = Coulomb(kinetic_coefficient=0.0)
    problem = problem_of(request.mechanism, none, request.measurement, free=())
    return _criterion(problem.linearise(np.zeros(0), slopes=False), 0)


def _between(one: Estimate) -> str:
    return with_unit(one.range.replace(" to ", " and "), one.quantity.unit)


def _words(closest: SlideCandidate, alike: list[str], *, useless: bool) -> Wording:
    assert closest.fit is not None
    name, fit = friction_of(closest.title), closest.fit
    verdict = f"Use {name}." if not useless else f"{name} predicts no better than none."
    ties = (f"These slides do not distinguish it from {joined(alike)}.",) if alike else ()
    return Wording(
        verdict=verdict,
        lede=f"It leaves {quantity(fit.rms, 'm', 2)}, root mean square.",
        settles=tuple(
            f"${estimate.quantity.symbol}$ lies between {_between(estimate)}."
            for estimate in fit.estimates
            if estimate.bounded
        ),
        cannot_tell=(*ties, *fit.sentences, UNMEASURED),
        measure_next=(),
        no_score="",
    )
