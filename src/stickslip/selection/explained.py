"""Candidates that the force balance of a record asks for, and what it says of them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from stickslip.errors import InputError
from stickslip.evidence import Explanation, Fit, Rule, explain
from stickslip.experiments import Measurement
from stickslip.friction import CandidateSpec, specification
from stickslip.identification import ModelError, RecordSettings
from stickslip.identification.series.inverse_dynamics import mass_of
from stickslip.identification.terms.composed_laws import composed_law
from stickslip.identification.terms.dense_series import dense_series, is_dense, loads_of
from stickslip.identification.terms.findings import model_errors
from stickslip.mechanisms import Mechanism
from stickslip.selection.candidates import REFERENCE, Watch

MOST = 3
"""Laws of other structures that are fitted beside that of the best."""


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
    own = [c.value for c in ()] or mass
    specs: dict[str, CandidateSpec] = {}
    fits: dict[str, Fit] = {}
    for one in [found.best, *found.ties, *found.family.values()]:
        law = composed_law(one, load, own)
        if law is None or not one.ok:
            continue
        name = law.specification.name
        if name not in fits or one.rms < fits[name].rms:
            fits.setdefault(name, one)
        wanted = one is found.best or (
            any(one is tie for tie in found.ties) and not one.structure.faults
        )
        if wanted and name not in specs and len(specs) <= MOST:
            specs[name] = law.specification
    if not specs:
        return None
    specs.setdefault(REFERENCE, specification(REFERENCE))
    return Explained(
        explanation=found,
        specs=tuple(specs.values()),
        fits=fits,
        errors=model_errors(found, measurement),
    )


def _told(watch: Watch) -> Callable[[float, str], None]:
    def told(share: float, structure: str) -> None:
        watch(f"force balance, {100.0 * share:.0f} %: {structure}", float("nan"))

    return told
