"""Candidates a part at a time: a richer law is fitted where what it builds on is shown to hold."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, fields
from typing import Generic, TypeVar, final

from stickslip.formatting import count
from stickslip.friction import Rung, rungs
from stickslip.selection.candidates import LEFT_OUT, REFERENCE, CandidateSpec, Watch
from stickslip.selection.choice import effective_aic, significant
from stickslip.selection.parallel_fit import Fitted, Tried, fitted_side_by_side
from stickslip.selection.record_verdict import RecordCandidate
from stickslip.selection.wording import in_sentence

__all__ = ["Climbed", "climbed"]

C = TypeVar("C", bound=Tried)


@final
@dataclass(frozen=True, kw_only=True)
class Climbed(Generic[C]):
    """The candidates that were fitted, and why no others were."""

    specs: tuple[CandidateSpec, ...]
    """What was fitted."""
    tried: tuple[C, ...]
    """The candidates in the same order."""
    untried: tuple[str, ...] = ()
    """Names of the candidates that were not fitted."""
    why: str = ""
    """Why they were not, in a sentence; empty if all were fitted."""


def climbed(
    candidates: Sequence[CandidateSpec],
    fitted: Fitted[C],
    watch: Watch | None,
    executor: Executor | None,
    *,
    seen: Callable[[Sequence[C], Sequence[CandidateSpec]], Sequence[RecordCandidate]],
    at_noise: Callable[[RecordCandidate], bool],
    usual: bool,
) -> Climbed[C]:
    """Fit candidates: those that were given all, the usual ones from the simplest upwards.

    Of the usual ones, laws without memory that have at most one part beside a level and a viscous
    part are always fitted. Where the best of all leaves more than noise, so is Dahl's law. Then
    those with one part more than the best law follow, as long as an F test shows that law to hold
    over all that it contains.

    Parameters
    ----------
    candidates : sequence of CandidateSpec
        What may be fitted.
    fitted : callable
        Fits one candidate, as for `fitted_side_by_side`.
    watch : callable or None
        Called with name and least residual; False ends the searches. None if nobody watches.
    executor : Executor or None
        Processes that fit; None to fit one after the other.
    seen : callable
        Returns the candidates as they are compared, with what they contain.
    at_noise : callable
        Whether what a candidate leaves is no more than the noise of what is compared.
    usual : bool
        Whether nobody asked for these candidates.

    Returns
    -------
    Climbed
        What was fitted, and what was not.
    """
    by_name = {one.name: one for one in candidates}
    chosen = [*by_name.values()]
    if usual:
        known, first = rungs(), [Rung(), *Rung().above()]
        chosen = [one for one in chosen if one.name not in known or known[one.name] in first]
        chosen = [one for one in chosen if not one.law.states]
    found: dict[str, C] = {}
    why = ""
    while True:
        tried = fitted_side_by_side(fitted, chosen, watch, executor, found)
        if not usual:
            break
        more, why = _above(seen(tried, chosen), by_name, at_noise)
        if not more:
            break
        chosen += more
    left = tuple(name for name in by_name if name not in found)
    said = f"{count(len(left), 'richer candidate')} not tried: {why}." if left else ""
    return Climbed(specs=tuple(chosen), tried=tuple(tried), untried=left, why=said)


def _above(
    compared: Sequence[RecordCandidate],
    by_name: Mapping[str, CandidateSpec],
    at_noise: Callable[[RecordCandidate], bool],
) -> tuple[list[CandidateSpec], str]:
    """Return what is fitted next; nothing, with the reason as a clause, if nothing is to be."""
    fits = {
        c.name: c
        for c in compared
        if c.fit and not c.fit.search_failure and not c.fit.optimum.hopeless
    }
    if any(c.dropped == LEFT_OUT or (c.fit and c.fit.optimum.cancelled) for c in compared):
        return [], "the search was stopped"
    shown = [c for c in fits.values() if _shown(c, fits)]
    if not shown:
        return [], "no simpler law could be fitted"
    criteria = effective_aic(shown)
    best = min(shown, key=lambda c: criteria[c.name])
    title = in_sentence(best.title)
    if at_noise(best):
        return [], f"{title} friction leaves no more than noise"
    tried = {c.name for c in compared}
    own = rungs().get(best.name, Rung())
    wanted = [*Rung().above(), *(one for one in own.above() if _promising(own, one, fits))]
    names = dict.fromkeys(one.specification.name for one in wanted)
    more = [by_name[name] for name in names if name in by_name and name not in tried]
    return more, f"no law with one part more is shown to hold over {title} friction"


def _shown(c: RecordCandidate, fits: Mapping[str, RecordCandidate]) -> bool:
    return all(significant(c, fits[name]) for name in c.simpler if name in fits)


def _promising(own: Rung, above: Rung, fits: Mapping[str, RecordCandidate]) -> bool:
    """Whether a law with memory, whose fits take long, has a part more that gains by itself."""
    if not above.memory or above.exponent:
        return True
    new = {
        field.name: getattr(above, field.name)
        for field in fields(Rung)
        if getattr(above, field.name) != getattr(own, field.name)
    }
    alone, plain = fits.get(Rung(**new).specification.name), fits.get(REFERENCE)
    return alone is None or plain is None or significant(alone, plain)
