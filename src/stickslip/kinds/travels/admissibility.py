"""Which law several travels call for: a likelihood-ratio test with the readings' uncertainty."""

import math
from collections.abc import Sequence
from dataclasses import replace

from stickslip.formatting import joined, number
from stickslip.friction import CoulombViscous, FrictionLaw, anywhere, containment_of
from stickslip.identification import Estimate, spanning
from stickslip.kinds.travels.result import TravelFit
from stickslip.kinds.travels.verdict import TravelCandidate
from stickslip.quantities import fields_of, parameters

SURE = 0.999
"""Level of the test by which a law is ruled out: one that is not named need not be wrong."""
LEVEL = 0.975
"""Of the test that names a law. A viscous part that is not there is taken for real in 1.25 of 100
sets of readings: it has a bound at 0, where half of such fits end."""


def doubts(candidate: TravelCandidate) -> dict[str, str]:
    """Return why each fitted parameter that the data do not settle is in doubt, by field name."""
    found = {}
    several = {one.path for one in candidate.alone if one.pieces}
    alone = {one.path: one for one in candidate.alone if one.bounded and not one.pieces}
    for estimate in candidate.fit.estimates if candidate.fit else ():
        name = estimate.path.rpartition(".")[2]
        limit = limit_of(candidate.fit.law, name) if candidate.fit else 0.0
        if not estimate.bounded and estimate.path in alone:
            said = alone[estimate.path].range.replace(" to ", " and ")
            found[name] = (
                f"lies between {said} if {candidate.title} friction holds; {estimate.reason}"
            )
        elif not estimate.bounded:
            found[name] = "not identified by these trials"
        elif estimate.pieces:
            ranges = estimate.range.replace(" to ", " and ").replace(" or ", ", or between ")
            found[name] = f"lies between {ranges}: these readings do not tell which"
        elif estimate.path in several:
            said = estimate.range.replace(" to ", " and ")
            found[name] = f"lies between {said}: these readings do not tell which of several values"
        elif estimate.low <= limit and estimate.path in alone and alone[estimate.path].low > limit:
            said = alone[estimate.path].range.replace(" to ", " and ")
            found[name] = (
                f"lies between {said} if {candidate.title} friction holds; if another law does that"
                f" these readings do not rule out, it may be {_limit_text(limit)}"
            )
        elif estimate.low <= limit:
            found[name] = f"consistent with {_limit_text(limit)} ({estimate.interval} interval)"
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


def _limit_text(limit: float) -> str:
    return "zero" if limit == 0.0 else f"its limit of {number(limit)}"


def improves(richer: TravelFit, simpler: TravelFit, extra: int, level: float = LEVEL) -> bool:
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
    needed = stats.chi2.ppf(level, extra) if known else extra * stats.f.ppf(level, extra, freedom)
    # uncertain settings move the travels of each law by as much as that law says
    return simpler.deviance(factor) - richer.deviance(factor) > float(needed)


def chosen(candidates: Sequence[TravelCandidate]) -> TravelCandidate | None:
    """Return the simplest law that no richer one improves on significantly, None without any.

    A law with parameters that were neither measured, given nor fitted is not taken. Laws with as
    many parameters are compared as if the one with the longer list had one more.
    """
    fitted = [c for c in candidates if c.fit is not None and not c.dropped]
    best: TravelCandidate | None = None
    for one in sorted([c for c in fitted if not c.invented], key=_size):
        if best is None or improves_on(one, best):
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


def improves_on(one: TravelCandidate, other: TravelCandidate, level: float = LEVEL) -> bool:
    """Whether a law leaves significantly less than another, by the parameters of both."""
    assert one.fit is not None
    assert other.fit is not None
    return improves(one.fit, other.fit, max(one.parameters - other.parameters, 1), level)


def unsettling(
    candidates: Sequence[TravelCandidate], best: TravelCandidate | None, level: float = SURE
) -> list[TravelCandidate]:
    """Return laws with invented values that rule out the best of the others.

    What was invented has been looked for over all that is plausible. So these laws explain the
    readings, but the readings do not determine them, and no law can be named.
    """
    invented = [c for c in candidates if c.invented and c.fit is not None and not c.dropped]
    if best is None:
        return invented
    return [c for c in invented if improves_on(c, best, level)]


def reaching(best: TravelCandidate, ties: Sequence[TravelCandidate]) -> TravelCandidate:
    """Return the best law with intervals that hold those of all laws that are not ruled out.

    What one of them has too, but with a value that was invented and not fitted, it leaves open.
    """
    ties = [c for c in ties if c.fit is not None and not c.dropped]
    fits = [c.fit for c in ties if c.fit is not None]
    if best.fit is None or not fits:
        return best
    found = []
    for one in best.fit.estimates:
        name = one.path.rpartition(".")[2]
        open_ = [c.title for c in ties if name in c.invented]
        if open_ and one.bounded:
            said = f"{joined(open_)} friction, which explains the readings too, leaves it open"
            found.append(replace(one, low=-math.inf, high=math.inf, pieces=(), reason=said))
            continue
        limit = limit_of(best.fit.law, name)
        parts = [*(one.pieces or ((one.low, one.high),))]
        for fit in fits:
            same = _same(one, fit, type(best.law))
            if same is None:
                parts.append((limit, one.high))
            for other in same or ():
                parts += other.pieces or ((other.low, other.high),)
        reason = one.reason
        if one.bounded and not all(math.isfinite(end) for part in parts for end in part):
            reason = "another law that explains the readings leaves it open"
        found.append(replace(spanning(one, parts), reason=reason))
    fit = replace(best.fit, estimates=tuple(found))
    return replace(best, fit=fit, alone=best.fit.estimates)


def _same(one: Estimate, fit: TravelFit, law: type[FrictionLaw]) -> list[Estimate] | None:
    """Return what another law's fit says of a parameter of a law; None if it does without it.

    The levels of both directions are each what the level of both is, if the body went there. The
    factor of a power of the speed is no slope.
    """
    name, fields = one.path.rpartition(".")[2], fields_of(type(fit.law))
    how = containment_of(type(fit.law), law)
    straight = containment_of(type(fit.law), CoulombViscous)
    if one.quantity.scale == "slope" and straight is not None:
        for shape, value in straight.values.items():
            if fields[shape].scale == "none" and getattr(fit.law, shape) != value:
                return []
    if name in fields:
        return [e for e in fit.estimates if e.path == one.path]
    names = {own for own, source in (how.values.items() if how else ()) if source == name}
    told = [e for e in fit.estimates if e.path.rpartition(".")[2] in names and not e.reason]
    return told if names else None


def told_apart(candidate: TravelCandidate, best: TravelCandidate) -> bool:
    """Whether the readings speak for the best law against another one beyond their uncertainty.

    They cannot against a law with invented values that contains the best one: it does what the best
    one does, whatever its own search found.
    """
    if candidate.fit is None or candidate.dropped:
        return True
    if candidate.invented and containment_of(type(candidate.law), type(best.law)) is not None:
        return False
    return improves_on(best, candidate, SURE)


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
