"""Candidates that the force balance of a record asks for, and what it says of them."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

from stickslip.evidence import GEARS, TERMS, Fit, Structure
from stickslip.experiments import Measurement
from stickslip.friction import CandidateSpec, FrictionLaw, law, specification
from stickslip.identification import (
    Asked,
    FittedLaw,
    ModelError,
    RecordSettings,
    errors_of,
    model_errors,
)
from stickslip.kinds.joints.ladder import LOADED
from stickslip.selection import REFERENCE, Watch

SPECIAL = ("level_slope", "level_ripple", "ripple", "imbalance", "second", *GEARS)
"""Kinds of terms that only a record which asks for them brings in."""
MOST = 2
"""Rivals that are fitted beside the law of the best structure."""
FEWEST = 5
"""Laws that are fitted, if there are so many: of Coulomb + viscous friction, those with another
power of the speed, a drag, a step or a slope for each direction."""
CLEARER = 0.5
"""Error of a fitted force over that of the balance below which the fit of a law with a memory has
seen what the balance has not. That of other laws has the narrower band."""
TEXTBOOK = "lugre"
"""Law with a bristle that stands beside all others that have one, and that is tried where all
others have none and leave more than noise."""
ONE_MEMORY = "dahl-exponent"
"""Law whose exponent two memories may stand for."""
ELASTIC = "elasto-plastic"
"""Law with a bristle that stands beside one that does not yield below break-away."""
RELATIVES = ("gms", ELASTIC)
"""Laws with a bristle and a Stribeck step that no structure is, fitted where one of those that are
leaves more than noise."""
CLEARLY = 1.5
"""Force that laws without a bristle leave, over what one with it leaves, from which it is less."""
RATE = 100.0
"""Rate [1/s] at which an element or a bristle comes to its level where a search begins."""
CLOSER = 0.98
"""Error over that of the best structure from which one with a part more is fitted in any case: the
balance asks for more than that, but all rows together may tell what it leaves open."""
SIMPLER = 1.1
"""Error of the balance over that of the best structure up to which it does not speak for a part of
which no prediction tells the parameters."""


@final
@dataclass(frozen=True, kw_only=True)
class Explained:
    """What the force balance of a record asks for."""

    asked: Asked
    """Laws of the structures that were compared."""
    specs: tuple[CandidateSpec, ...]
    """Candidates: the law of the best structure first, then those that are not told apart from it,
    and the usual choice."""
    starts: Mapping[str, FittedLaw]
    """Where searches of candidates begin, by name."""
    errors: tuple[ModelError, ...]
    """What is wrong with the rig or the record."""
    unit: str
    """Of held-out errors of the balance."""

    @classmethod
    def of(
        cls,
        asked: Asked,
        measurement: Measurement,
        settings: RecordSettings,
        unknown: Sequence[str] = (),
    ) -> "Explained":
        """Return what the laws of an explanation are for a selection."""
        return cls(
            asked=asked,
            specs=_compared(asked),
            starts={name: law.as_fit(unknown) for name, law in asked.laws.items()},
            errors=model_errors(
                asked.explanation, measurement, settings.holding, settings.response
            ),
            unit=measurement.unit("force"),
        )

    def rejects(self, name: str, law: FrictionLaw | None, *, simplified: bool = False) -> bool:
        """Whether the force balance tells a law from that of the best structure.

        One that lacks a part of which the record does not tell a parameter has to leave more.
        """
        if law is None or name == self.asked.best.name:
            return False
        own = self.asked.fit_of(name, law)
        if not self.asked.rejects(own):
            return False
        return not (simplified and own and own.rms < SIMPLER * self.asked.explanation.best.rms)

    def errors_of(
        self, name: str, law: FrictionLaw, left: float = math.nan
    ) -> tuple[ModelError, ...]:
        """Return what is wrong with a fitted law, the rig or the record.

        Of a law with a memory whose fit leaves far less force [N] than the balance's own best
        structure, the balance has nothing to say.

        A law that no structure is and that leaves no more force than the best one with its faults
        needs none: what the balance says of rig and record stands for what its laws lack.
        """
        if law.name in (*RELATIVES, *LOADED) and left <= self.asked.explanation.best.rms:
            return ()
        found = errors_of(self.asked, law, name, self.errors, self.unit)
        if not (law.states and left < CLEARER * self.asked.explanation.best.rms):
            return found
        return tuple(one for one in found if one.kind not in ("law", "unexplained"))


def _compared(asked: Asked) -> tuple[CandidateSpec, ...]:
    """Return the laws to fit: that of the best structure, its rivals and the usual choice.

    A law without memory that does not grow with the speed stands beside one with a viscous part: a
    simulation tells a slope that is below the noise of the balance.

    A structure with a part more than the best is no rival, as with a part that nothing asks for any
    law predicts alike; such ones, without memory, stand beside laws that have too few rivals, and
    the first that comes closer stands beside all.
    """
    best, fits = asked.explanation.best, asked.fits
    alike = [
        name
        for name, one in fits.items()
        if one is not best and not _accuses(one, best) and not asked.rejects(one)
    ]
    if not best.structure.memories:  # which fits of take minutes, and nothing asks for
        alike = [name for name in alike if not fits[name].structure.memories]
    richer = [name for name in alike if _contains(fits[name].structure, best.structure)]
    rivals = [name for name in alike if name not in richer][:MOST]
    if best.structure.memories and TEXTBOOK in fits and asked.best.name != TEXTBOOK:
        # its fit has more to say of a bristle, its damping too, than the balance
        rivals = [*dict.fromkeys([TEXTBOOK, *rivals])][:MOST]
    if asked.best.text.startswith("maxwell[1](level + stribeck)"):
        rivals = [*dict.fromkeys([ELASTIC, *rivals])][:MOST]
    if any(term.kind == "second" for term in best.structure.free):
        rivals = [*dict.fromkeys([ONE_MEMORY, *rivals])][:MOST]
    names = dict.fromkeys([asked.best.name, *rivals, REFERENCE])
    own = {}
    if not (best.structure.memories or asked.flows):
        kind = law(f"{asked.best.text} + viscous")
        own = {kind.name: CandidateSpec(name=kind.name, title=kind.title, law=kind)}
        names |= dict.fromkeys(own)
    plain = [name for name in richer if not fits[name].structure.memories]
    closer = [name for name in plain if fits[name].rms < CLOSER * best.rms][:1]
    names |= dict.fromkeys([*closer, *plain[: max(FEWEST - len(names), 0)]])
    known = own | {name: law.specification for name, law in asked.laws.items()}
    return tuple(known.get(name) or specification(name) for name in names)


def _accuses(one: Fit, best: Fit) -> bool:
    """Whether a structure has a fault, or a special term, that the best one has not."""
    known = {term.kind for term in best.structure.free}
    known |= {*GEARS} if known & {*GEARS} else set()
    new = {term.kind for term in one.structure.free} - known
    return any(TERMS[kind].fault or kind in SPECIAL for kind in new)


def _contains(rich: Structure, simple: Structure) -> bool:
    kinds = [{(term.kind, term.channel) for term in one.terms} for one in (rich, simple)]
    shapes = [{(c, len(shape)) for c, shape in one.memories} for one in (rich, simple)]
    return kinds[1] <= kinds[0] and shapes[1] <= shapes[0]


def told_to(watch: Watch, share: float, structure: str, where: str = "") -> None:
    """Tell how far the search over structures is, and the best so far."""
    watch(f"{where}force balance, {100.0 * share:.0f} %: {structure}", math.nan)
