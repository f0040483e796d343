"""Which fits may be taken: not those with a parameter that the data do not hold off its limit."""

from collections.abc import Sequence
from dataclasses import replace

from stickslip.identification import Estimate
from stickslip.quantities import fields_of
from stickslip.selection.verdict import Candidate

__all__ = ["doubts", "mark_passed_over", "within_errors"]


def doubts(candidate: Candidate) -> dict[str, str]:
    """Return why each fitted parameter that the data do not settle is in doubt, by field name."""
    found = {}
    for estimate in candidate.fit.estimates if candidate.fit else ():
        name = estimate.path.rpartition(".")[2]
        limit = _limit(candidate, name)
        if not estimate.bounded:
            found[name] = "not bounded by these trials"
        elif estimate.low <= limit:
            found[name] = _at(limit, estimate)
    return found


def _limit(candidate: Candidate, name: str) -> float:
    """Return the lowest value that a parameter may have beside the others."""
    assert candidate.fit is not None
    law = candidate.fit.law
    quantity = fields_of(type(law))[name]
    limits = [quantity.low, quantity.above or 0.0]
    if quantity.at_least is not None:
        limits.append(getattr(law, quantity.at_least))
    return float(max(limits))


def _at(limit: float, estimate: Estimate) -> str:
    value = "zero" if limit == 0.0 else f"its limit {limit:.3g}"
    return f"{value} within its {estimate.interval} interval"


def mark_passed_over(candidates: Sequence[Candidate]) -> list[Candidate]:
    """Mark the scored candidates whose doubtful parameter another law does without.

    That law must have no doubtful parameter itself, and be as good within the standard errors.
    """
    return [
        replace(candidate, passed_over=reason) if reason else candidate
        for candidate in candidates
        for reason in [_reason(candidate, candidates)]
    ]


def _reason(candidate: Candidate, candidates: Sequence[Candidate]) -> str:
    for name, doubt in doubts(candidate).items():
        for other in candidates:
            settled = name not in _fitted(other) and not doubts(other)
            if settled and within_errors(other, candidate):
                symbol = fields_of(type(candidate.law))[name].symbol
                return f"${symbol}$ is {doubt}, and {other.title} does without it"
    return ""


def _fitted(candidate: Candidate) -> set[str]:
    estimates = candidate.fit.estimates if candidate.fit else ()
    return {estimate.path.rpartition(".")[2] for estimate in estimates}


def within_errors(candidate: Candidate, other: Candidate) -> bool:
    """Whether a score is no worse than another within one standard error of each.

    Scores of travels have standard errors of their own; those of records are compared in pairs.
    """
    if candidate.score is None or other.score is None:
        return False
    doubt = (candidate.score_error or 0.0) + (other.score_error or 0.0)
    return candidate.score - other.score <= doubt
