"""Candidates that the force balance of a record asks for, and what it says of them."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from stickslip.errors import InputError
from stickslip.evidence import TERMS, Explanation, Fit, Rule, Structure, explain
from stickslip.experiments import Measurement
from stickslip.friction import CandidateSpec, FrictionLaw, specification
from stickslip.identification import FittedLaw, ModelError, RecordSettings
from stickslip.identification.estimation.containment import CONSTANTS
from stickslip.identification.series.inverse_dynamics import mass_of
from stickslip.identification.terms.composed_laws import ComposedLaw, composed_law
from stickslip.identification.terms.dense_series import dense_series, is_dense, loads_of
from stickslip.identification.terms.findings import model_errors
from stickslip.mechanisms import Mechanism
from stickslip.selection.candidates import REFERENCE, Watch

SPECIAL = ("level_slope", "level_ripple", "ripple", "second")
"""Kinds of terms that only a record which asks for them brings in."""
MOST = 2
"""Rivals that are fitted beside the law of the best structure."""
FEWEST = 3
"""Laws that are fitted, if there are so many."""


@final
@dataclass(frozen=True, kw_only=True)
class Explained:
    """What the force balance of a record asks for."""

    explanation: Explanation
    """The search over structures."""
    specs: tuple[CandidateSpec, ...]
    """Candidates: the law of the best structure first, then those that are not told apart from it,
    and the usual choice."""
    fits: Mapping[str, Fit]
    """The closest structure of each law that was met, by the name of its candidate."""
    starts: Mapping[str, FittedLaw]
    """Where searches of candidates begin, by name."""
    errors: tuple[ModelError, ...]
    """What is wrong with the rig or the record."""

    def rejects(self, name: str) -> bool:
        """Whether the force balance tells a law from that of the best structure."""
        own, best = self.fits.get(name), self.explanation.best
        if own is None or own is best or name == self.specs[0].name:
            return False
        return Rule().better(best, own, self.explanation.scale)


def explained(
    mechanism: Mechanism,
    measurement: Measurement,
    settings: RecordSettings,
    unknown: Sequence[str],
    watch: Watch | None,
) -> Explained | None:
    """Return what the force balance asks for; None where none can be written down or judged."""
    if not is_dense(mechanism, measurement):
        return None
    told = None if watch is None else _told(watch)
    try:
        series = dense_series(mechanism, measurement, settings.holding, unknown)
        found = explain(series, progress=told)
    except InputError:
        return None
    load = float(np.median(np.concatenate(loads_of(mechanism, measurement))))
    mass = mass_of(mechanism)
    fits: dict[str, Fit] = {}
    specs: dict[str, CandidateSpec] = {}
    starts: dict[str, FittedLaw] = {}
    for one in [found.best, *found.ties, *sorted(found.family.values(), key=lambda f: f.rms)]:
        law = composed_law(one, load, mass) if one.ok else None
        if law is not None and fits.setdefault(law.specification.name, one) is one:
            specs[law.specification.name] = law.specification
            starts[law.specification.name] = _start(law, unknown)
    if not specs:
        return None
    return Explained(
        explanation=found,
        specs=_compared(found, fits, specs),
        starts=starts,
        fits=fits,
        errors=model_errors(found, measurement),
    )


def _start(law: ComposedLaw, unknown: Sequence[str]) -> FittedLaw:
    """Return the coefficients of a structure as a fit from which searches begin."""
    beside = {path: law.inertia for path in unknown if path.endswith(("inertia", "mass"))}
    values = {**law.start, **{path: x for path, x in beside.items() if x is not None}}
    if not law.specification.law.directional:
        values |= dict.fromkeys(CONSTANTS, law.constant)
    assert isinstance(law.specification.law, FrictionLaw)
    return FittedLaw(law=law.specification.law, values=values, cost=math.inf, rows=0)


def _compared(
    found: Explanation, fits: Mapping[str, Fit], specs: Mapping[str, CandidateSpec]
) -> tuple[CandidateSpec, ...]:
    """Return the laws to fit: that of the best structure, its rivals and the usual choice.

    A structure with a part more than the best is no rival, as with a part that nothing asks for any
    law predicts alike; one such, without memory, stands beside a law that has no rival.
    """
    best, rule = found.best, Rule()
    alike = [
        name
        for name, one in fits.items()
        if one is not best and not _accuses(one, best) and not rule.better(best, one, found.scale)
    ]
    richer = [name for name in alike if _contains(fits[name].structure, best.structure)]
    chosen = [name for name in alike if name not in richer][:MOST]
    names = [next(iter(fits)), *chosen, *([] if REFERENCE in specs else [REFERENCE])]
    names += [REFERENCE] if REFERENCE not in names else []
    plain = [name for name in richer if not fits[name].structure.memories]
    names += plain[: max(FEWEST - len(set(names)), 0)]
    return tuple(specs.get(name) or specification(name) for name in dict.fromkeys(names))


def _accuses(one: Fit, best: Fit) -> bool:
    """Whether a structure has a fault, or a special term, that the best one has not."""
    known = {term.kind for term in best.structure.free}
    new = {term.kind for term in one.structure.free} - known
    return any(TERMS[kind].fault or kind in SPECIAL for kind in new)


def _contains(rich: Structure, simple: Structure) -> bool:
    kinds = [{(term.kind, term.channel) for term in one.terms} for one in (rich, simple)]
    shapes = [{(c, len(shape)) for c, shape in one.memories} for one in (rich, simple)]
    return kinds[1] <= kinds[0] and shapes[1] <= shapes[0]


def _told(watch: Watch) -> Callable[[float, str], None]:
    def told(share: float, structure: str) -> None:
        watch(f"force balance, {100.0 * share:.0f} %: {structure}", math.nan)

    return told
