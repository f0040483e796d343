"""Candidates a part at a time: a richer law is fitted where what it builds on is shown to hold."""

import math
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, fields, replace
from typing import final

from stickslip.formatting import count
from stickslip.friction import CandidateSpec, Rung, rungs
from stickslip.kinds.joints.joint_verdict import RecordCandidate
from stickslip.selection import (
    LEAST,
    LEFT_OUT,
    Fitted,
    Watch,
    fitted_side_by_side,
    friction_of,
)

SHOWN = 5.0
"""Akaike's criterion by which a law must be below all that it contains to be built upon."""
LOADED = ("bam-m3", "level + gear + viscous", "bam-m4", "bam-m5", "bam-m6")
"""Laws of gears under load, each after those that it contains."""
EXPONENT = "fading_exponent"
"""Parameter of gear laws that is looked for: held at 2 where it was 1, M5 was named for M4."""
IDLE = "not scored: it leaves hardly less than a law that it contains"


@final
@dataclass(frozen=True, kw_only=True)
class Climbed:
    """The candidates that were fitted, and why no others were."""

    specs: tuple[CandidateSpec, ...]
    """What was fitted."""
    tried: tuple[RecordCandidate, ...]
    """The candidates in the same order."""
    untried: tuple[str, ...] = ()
    """Names of the candidates that were not fitted."""
    why: str = ""
    """Why they were not, in a sentence; empty if all were fitted."""


def climbed(
    candidates: Sequence[CandidateSpec],
    fitted: Fitted[RecordCandidate],
    watch: Watch | None,
    executor: Executor | None,
    *,
    seen: Callable[[Sequence[RecordCandidate], Sequence[CandidateSpec]], Sequence[RecordCandidate]],
    at_noise: Callable[[RecordCandidate], bool],
    usual: bool,
    leader: str = "",
) -> Climbed:
    """Fit candidates: those that were given all, the usual ones from the simplest upwards.

    Of the usual ones, laws without memory that have at most one part beside a level and a viscous
    part are always fitted. Where the best of all leaves more than noise, so is Dahl's law. Then
    those with one part more than the best law follow, as long as that law leaves less than all that
    it contains, by Akaike's criterion.
    """
    by_name = {one.name: one for one in candidates}
    chosen = [*by_name.values()]
    if usual:
        known, lowest = rungs(), [Rung(), *Rung().above()]
        chosen = [one for one in chosen if known.get(one.name, Rung()) in lowest]
        chosen = [one for one in chosen if not one.law.states]
    first, why = {one.name for one in chosen}, ""
    found: dict[str, RecordCandidate] = {}
    while True:
        tried = fitted_side_by_side(fitted, chosen, watch, executor, found, leader=leader)
        if not usual:
            break
        fits = _Fits.of(seen(tried, chosen))
        more, why = fits.above(by_name, at_noise)
        if not more:
            idle = {name for name in found if name not in first and fits.is_idle(name)}
            tried = [replace(one, dropped=IDLE) if one.name in idle else one for one in tried]
            break
        chosen += more
    left = tuple(name for name in by_name if name not in found)
    said = f"{count(len(left), 'richer candidate')} not tried: {why}." if left else ""
    return Climbed(specs=tuple(chosen), tried=tuple(tried), untried=left, why=said)


def _criterion(c: RecordCandidate, size: float) -> float:
    spare = size - c.parameters - 1.0
    if spare <= 0.0:
        return math.inf
    return size * (math.log(max(c.residual**2, LEAST)) + 2.0 * c.parameters / spare)


@final
@dataclass(frozen=True)
class _Fits:
    """Candidates with fits to one record, as far as they are fitted."""

    tried: Sequence[RecordCandidate]
    """All candidates so far."""
    known: Mapping[str, RecordCandidate]
    """Those whose search came to its end, by name."""
    criteria: Mapping[str, float]
    """Akaike's criterion of these, corrected for few residuals (Hurvich & Tsai 1989), which are
    counted by the effective number of the fit that has the most.

    Of what a law that lacks another part leaves, little counts as independent, so that by its own
    number hardly a law would be climbed from.
    """

    @classmethod
    def of(cls, tried: Sequence[RecordCandidate]) -> "_Fits":
        """Return the fits of candidates."""
        known = {
            c.name: c
            for c in tried
            if c.fit and not c.fit.search_failure and not c.fit.optimum.hopeless
        }
        size = max((c.effective for c in known.values()), default=0.0)
        return cls(tried, known, {name: _criterion(c, size) for name, c in known.items()})

    def above(
        self, by_name: Mapping[str, CandidateSpec], at_noise: Callable[[RecordCandidate], bool]
    ) -> tuple[list[CandidateSpec], str]:
        """Return what is fitted next, and if nothing is to be, the reason as a clause."""
        if any(c.dropped == LEFT_OUT or (c.fit and c.fit.optimum.cancelled) for c in self.tried):
            return [], "the search was stopped"
        if not self.known:
            return [], "no simpler law could be fitted"
        best = min(filter(self.is_shown, self.known.values()), key=lambda c: self.criteria[c.name])
        title = friction_of(best.title)
        if at_noise(best):
            return [], f"{title} leaves no more than noise"
        own, tried = rungs().get(best.name, Rung()), {c.name for c in self.tried}
        wanted = [*Rung().above(), *(one for one in own.above() if self.is_promising(own, one))]
        names = dict.fromkeys(one.specification.name for one in wanted)
        more = [by_name[name] for name in names if name in by_name and name not in tried]
        return more, f"no law with one part more is shown to hold over {title}"

    def is_shown(self, c: RecordCandidate, *, by: float = SHOWN) -> bool:
        """Whether the criterion of a law is so far below those of all that it contains."""
        simpler = (self.criteria[name] for name in c.simpler if name in self.known)
        return all(one - self.criteria[c.name] > by for one in simpler)

    def is_idle(self, name: str) -> bool:
        """Whether a law takes no more off than chance does from one that it contains."""
        return name in self.known and not self.is_shown(self.known[name], by=0.0)

    def is_promising(self, own: Rung, above: Rung) -> bool:
        """Whether a law is fitted: one with memory, which takes long, if its part gains alone."""
        new = {
            field.name: getattr(above, field.name)
            for field in fields(Rung)
            if getattr(above, field.name) != getattr(own, field.name)
        }
        if not above.memory or "exponent" in new:
            return True
        alone = self.known.get(Rung(**new).specification.name)
        return alone is None or self.is_shown(alone)
