"""Candidates that the force balance of a record asks for, and what it says of them."""

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import final

from stickslip.errors import ParameterError
from stickslip.evidence import GEARS, TERMS, Fit, Structure
from stickslip.experiments import Measurement
from stickslip.friction import CandidateSpec, FrictionLaw, law, specification
from stickslip.identification import (
    Asked,
    FittedLaw,
    ModelError,
    RecordFit,
    RecordSettings,
    asked_of,
    errors_of,
    force_noise,
    model_errors,
)
from stickslip.kinds.records.ladder import LOADED
from stickslip.mechanisms import Mechanism
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
STRAYED = 10.0
"""Factor between a stiffness and that of the balance from which it is that of another valley."""
CLEARLY = 1.5
"""Force that laws without a bristle leave, over what one with it leaves, from which it is less."""
WHITE = 1.5
"""Force that the closest law leaves over the noise of the force sensor from which it is more: noise
of the motion is estimated by the best structure, and what this lacks would count as noise."""
RATE = 100.0
"""Rate [1/s] at which an element or a bristle comes to its level where a search begins."""
STATIC = 1.3
"""Static over kinetic level where a search begins from a law without a static one."""
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
    decides: bool = False
    """Whether its law is named whatever the candidates predict: where that is the same force along
    the same motion, of which the balance alone knows rests and reversals."""

    @classmethod
    def of(
        cls,
        asked: Asked,
        measurement: Measurement,
        settings: RecordSettings,
        unknown: Sequence[str] = (),
        *,
        decides: bool = False,
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
            decides=decides,
        )

    @property
    def loads_gear(self) -> bool:
        """Whether friction grows with the torque of a gear."""
        return any(term.kind in GEARS for term in self.asked.explanation.best.structure.free)

    def starts_of(
        self, specs: Sequence[CandidateSpec], unknown: Sequence[str]
    ) -> dict[str, FittedLaw]:
        """Return where searches of candidates begin, also of those that were named, by name."""
        kinds = {one.name: one.law if isinstance(one.law, type) else type(one.law) for one in specs}
        named = {
            name: self.asked.start_of(kind, unknown) for name, kind in kinds.items() if kind.states
        }
        return {name: one for name, one in named.items() if one} | {**self.starts}

    def relative(
        self, fits: Sequence[RecordFit], tried: Collection[str]
    ) -> tuple[CandidateSpec, FittedLaw | None] | None:
        """Return the next law that no structure is, begun from the closest law with a bristle.

        Where the search of that one left the stiffness that the balance sees, it ended in another
        valley, and the next law finds a start of its own.

        None where the closest law leaves no more than noise of the force, or where motion is
        simulated: along the measured one a fit of theirs takes seconds, and there minutes. That one
        of them leaves little does not tell that another one leaves more. Where no law with a
        bristle was tried, as the path hardly resolves one, LuGre friction comes first, and the
        others where it leaves clearly less.
        """
        closest = min(fits, key=lambda one: one.rms, default=None)
        if closest is None or closest.problem.simulates:
            return None
        noise = WHITE * force_noise(self.asked.explanation)
        # of a law without a bristle, rests are not among the rows that its fit leaves a force at
        bristled = [one for one in fits if one.law.states]
        if not bristled:
            first = specification(TEXTBOOK)
            new = closest.rms > noise and TEXTBOOK not in tried
            return (first, closest.fitted_law) if new else None
        closest = min(bristled, key=lambda one: one.rms)
        rigid = [one.rms for one in fits if not one.law.states]
        resolved = self.asked.best.specification.law.states
        if not resolved and CLEARLY * closest.rms > min(rigid, default=math.inf):
            return None
        name = next((one for one in RELATIVES if one not in tried), None)
        composed = [one for one in bristled if one.law.name not in RELATIVES]
        left = min(composed, key=lambda one: one.rms, default=closest)
        if name is None or (len(left.law.states) < 2 and left.rms <= noise):
            return None
        spec = specification(name)
        assert isinstance(spec.law, type)
        seen, ended = (
            getattr(one, "bristle_stiffness", 0.0)
            for one in (self.asked.best.specification.law, closest.law)
        )
        if seen and not seen / STRAYED < ended < seen * STRAYED:
            return spec, None
        own = begun_from(spec.law, closest.law)
        if own is None:
            return None
        beside = {
            path: value
            for path, value in closest.fitted_law.values.items()
            if not path.startswith("friction.")
        }
        values = {f"friction.{name}": getattr(own, name) for name in spec.law.fit_order}
        start = FittedLaw(law=own, values=beside | values, cost=math.inf, rows=0)
        return replace(spec, law=own), start

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


def begun_from(kind: type[FrictionLaw], law: FrictionLaw) -> FrictionLaw | None:
    """Return a law with a bristle with the values of another one; None if it has no level of it.

    Of levels and slopes by direction it begins with the means.
    """

    def value(name: str) -> float | None:
        own = [getattr(law, f"{side}{name}", None) for side in ("", "forward_", "backward_")]
        known = [float(one) for one in own if one is not None]
        return sum(known) / len(known) if known else None

    level, stiffness = value("kinetic_coefficient"), value("bristle_stiffness")
    if not level or not stiffness:
        return None
    begun = {
        "static_coefficient": STATIC * level,
        "stribeck_velocity": level / stiffness * RATE,
        "attraction": RATE * level,
        "bristle_damping": stiffness / RATE,
        "elastic_share": 0.5,
        "viscous_coefficient": 0.0,
    }
    values = begun | {name: x for name in kind.fit_order if (x := value(name)) is not None}
    try:
        return kind(**{name: x for name, x in values.items() if name in kind.fit_order})
    except ParameterError:
        return None


def explained(
    mechanism: Mechanism,
    measurement: Measurement,
    settings: RecordSettings,
    unknown: Sequence[str],
    watch: Watch | None,
) -> Explained | None:
    """Return what the force balance asks for; None where none can be written down or judged."""
    told = None if watch is None else partial(told_to, watch)
    channel = settings.holding, unknown, settings.response
    asked = asked_of(mechanism, measurement, *channel, progress=told)
    if asked is None:
        return None
    return Explained.of(asked, measurement, settings, unknown)


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
