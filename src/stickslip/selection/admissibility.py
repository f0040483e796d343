"""Which law several travels call for: a likelihood-ratio test with the readings' uncertainty."""

import math
from collections.abc import Sequence
from dataclasses import replace

from stickslip.formatting import joined, number
from stickslip.friction import FrictionLaw, anywhere
from stickslip.identification import Estimate, TravelFit
from stickslip.quantities import fields_of, parameters
from stickslip.selection.travel_verdict import TravelCandidate

LEVEL = 0.975
"""Of the test. A viscous part that is not there is taken for real in 1.25 of 100 sets of readings:
it has a bound at 0, where half of such fits end."""


def doubts(candidate: TravelCandidate) -> dict[str, str]:
    """Return why each fitted parameter that the data do not settle is in doubt, by field name."""
    found = {}
    for estimate in candidate.fit.estimates if candidate.fit else ():
        name = estimate.path.rpartition(".")[2]
        limit = limit_of(candidate.fit.law, name) if candidate.fit else 0.0
        if not estimate.bounded:
            found[name] = "not identified by these trials"
        elif estimate.low <= limit:
            found[name] = _at(limit, estimate)
    return found


def limit_of(law: FrictionLaw, name: str) -> float:
    """Return the lowest value that a parameter of a law may have beside the others.

    Examples
    --------
    >>> from stickslip import Coulomb
    >>> law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.3)
    >>> limit_of(law, "kinetic_coefficient"), limit_of(law, "static_coefficient")
    (0.0, 0.2)
    """
    quantity = fields_of(type(law))[name]
    limits = [quantity.low, quantity.above or 0.0]
    if quantity.at_least is not None:
        limits.append(getattr(law, quantity.at_least))
    return float(max(limits))


def _at(limit: float, estimate: Estimate) -> str:
    value = "zero" if limit == 0.0 else f"its limit of {number(limit)}"
    return f"consistent with {value} ({estimate.interval} interval)"


def improves(richer: TravelFit, simpler: TravelFit, extra: int) -> bool:
    """Whether a fit leaves significantly less than that of a simpler law.

    The drop of the deviance is compared with the 97.5 % quantile of its distribution if the extra
    parameters are not there: chi-square with as many degrees of freedom where the uncertainty of
    the readings is known, and F where it is estimated from what the richer law leaves. Both laws
    are weighed with that uncertainty, so that what is shared or set beside it counts alike.
    """
    from scipy import stats

    factor, freedom = richer.variance
    if freedom == 0:
        return False
    known = math.isinf(freedom)
    needed = stats.chi2.ppf(LEVEL, extra) if known else extra * stats.f.ppf(LEVEL, extra, freedom)
    # uncertain settings move the travels of each law by as much as that law says
    return simpler.deviance(factor) - richer.deviance(factor) > float(needed)


def chosen(candidates: Sequence[TravelCandidate]) -> TravelCandidate | None:
    """Return the simplest law that no richer one improves on significantly, None without any.

    Parameters that were neither measured, given nor fitted count: a law that has them is taken only
    where there is no other. Laws with as many parameters are compared as if the one with the longer
    list had one more.
    """
    fitted = [c for c in candidates if c.fit is not None and not c.dropped]
    best: TravelCandidate | None = None
    for one in sorted([c for c in fitted if not c.invented] or fitted, key=_size):
        if best is None or _improves(one, best):
            best = one
    return best


def _size(candidate: TravelCandidate) -> tuple[int, bool, int]:
    """Return the number of parameters that readings or guesses pay for, and of all.

    Of laws with as many, those that hold a body at rest come first, since it did come to rest.
    """
    law = candidate.law
    return (
        candidate.parameters,
        not anywhere(law).break_away(1.0) > 0,
        len([*parameters(law, "friction")]),
    )


def _improves(one: TravelCandidate, other: TravelCandidate) -> bool:
    assert one.fit is not None
    assert other.fit is not None
    return improves(one.fit, other.fit, max(one.parameters - other.parameters, 1))


def told_apart(candidate: TravelCandidate, best: TravelCandidate) -> bool:
    """Whether the readings speak for the best law against another one beyond their uncertainty."""
    return candidate.fit is None or bool(candidate.dropped) or _improves(best, candidate)


def mark_passed_over(
    candidates: Sequence[TravelCandidate], best: TravelCandidate
) -> list[TravelCandidate]:
    """Mark which laws are not told apart from the best, and why they are not taken."""
    return [
        c
        if c is best or c.fit is None
        else replace(c, distinguished=told_apart(c, best), passed_over=_reason(c, best))
        for c in candidates
    ]


def _reason(candidate: TravelCandidate, best: TravelCandidate) -> str:
    """Return why a law is not taken whatever it leaves; empty if it leaves too much."""
    if candidate.invented and not best.invented:
        fields = fields_of(type(candidate.law))
        names = joined([f"${fields[name].symbol}$" for name in candidate.invented])
        verb = "was" if len(candidate.invented) == 1 else "were"
        return f"{names} {verb} neither measured, given nor fitted"
    if told_apart(candidate, best):
        return ""
    needed = {e.path.rpartition(".")[2] for e in best.fit.estimates} if best.fit else set()
    for name, doubt in doubts(candidate).items():
        if name not in needed:
            symbol = fields_of(type(candidate.law))[name].symbol
            return f"${symbol}$ is {doubt}, and {best.title} does not need it"
    return f"it is not significantly better than {best.title}"
