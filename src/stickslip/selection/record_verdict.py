"""What a selection on records gives back."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, final

import numpy as np
from typing_extensions import override

from stickslip.experiments import Checks, Measurement
from stickslip.friction import FrictionLaw
from stickslip.identification import RecordFit
from stickslip.identification.model_error import ModelError
from stickslip.identification.record_fit import Score
from stickslip.identification.record_settings import RecordSettings
from stickslip.selection.cross_validation import CrossValidation, Plan
from stickslip.selection.experiments import Experiment
from stickslip.selection.verdict import Verdict, plain

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["LIKELY", "NEAR", "Judged", "Purpose", "RecordCandidate", "RecordVerdict", "as_good"]

NEAR = 0.02
"""Share by which an error may be larger and count as the same, if blocks do not contradict."""
LIKELY = 0.30
"""Share by which the error of the law that the whole record makes likeliest may be larger."""
SAME = 1e-3
"""Share of a mean square below which a difference is one of the search, not of the laws."""


@final
@dataclass(frozen=True, kw_only=True)
class Purpose:
    """What the law is for: it sets what is scored, and over which horizon."""

    name: str
    """``"simulate"``, ``"position"`` or ``"compensate"``."""
    horizon: float
    """Length of the segments that are predicted [s]."""
    scored: str
    """What is scored, in words."""


@final
@dataclass(frozen=True, kw_only=True)
class RecordCandidate:
    """One law on a record: its fit, its held-out error, and whether it may be taken."""

    name: str
    """Key of the candidate."""
    title: str
    """Name in running text."""
    fit: RecordFit | None
    """The fit; None if there is none."""
    validation: CrossValidation | None
    """Held-out errors; None without a fit."""
    dropped: str = ""
    """Why it may not be taken, in words; empty if it may."""
    doubt: str = ""
    """What speaks against it although it is taken, since nothing else predicts as well."""
    outcome: str = ""
    """What became of it, for tables."""
    second: Score | None = None
    """Error on the record given to validate, if there is one."""
    left_out: tuple[str, ...] = ()
    """Paths of what went to 0 beside the rest of the law, and was left out of the fit."""
    aic: float = math.nan
    """Akaike's criterion, as if residuals were independent; for information."""
    bic: float = math.nan
    """Schwarz's criterion, as if residuals were independent; for information."""

    @property
    def parameters(self) -> int:
        """Number of unknowns that were fitted."""
        return len(self.fit.unknowns) if self.fit else 0

    @property
    def score(self) -> float:
        """Held-out error, infinite without a fit."""
        return self.validation.score if self.validation else math.inf

    @property
    def law(self) -> FrictionLaw | None:
        """The fitted law."""
        return self.fit.law if self.fit else None

    def to_row(self) -> Mapping[str, Any]:
        """Return the candidate as a row of `Verdict.table`."""
        return {
            "law": self.name,
            "parameters": self.parameters,
            "score": self.score,
            "score_error": self.validation.error if self.validation else math.nan,
            "last_third": self.validation.extrapolation if self.validation else math.nan,
            "outcome": self.outcome,
        }

    def to_dict(self) -> Mapping[str, Any]:
        """Return the candidate as plain numbers and strings."""
        validation = self.validation
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.parameters,
            "score": self.score,
            "score_error": validation.error if validation else None,
            "block_errors": [math.sqrt(x) for x in validation.losses] if validation else [],
            "extrapolation": validation.extrapolation if validation else None,
            "second_record": self.second.rms if self.second else None,
            "left_out": list(self.left_out),
            "aic": self.aic,
            "bic": self.bic,
            "dropped": plain(self.dropped),
            "doubt": plain(self.doubt),
            "outcome": plain(self.outcome),
            "fit": self.fit.to_dict() if self.fit else None,
        }


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class RecordVerdict(Verdict):
    """A verdict on records in time, or on measured friction."""

    candidates: tuple[RecordCandidate, ...]
    """All laws tried, least held-out error first."""
    best: RecordCandidate | None
    """The law to use; None if no candidate could be fitted."""
    reference: RecordCandidate | None
    """Coulomb and viscous friction, whatever the record says."""
    control: RecordCandidate | None
    """No friction at all."""
    plan: Plan
    """Blocks, gaps and horizon of the held-out errors."""
    purpose: Purpose
    """What the law is for."""
    picks: Mapping[str, str]
    """What other criteria would pick: criterion -> name of the candidate."""
    checks: Checks
    """What the record can tell, before any fit."""
    second: Measurement | None = None
    """The record given to validate, which no fit has seen; None without one."""
    settings: RecordSettings = field(default_factory=RecordSettings)
    """How each law was fitted: segments, starts and their seed."""
    experiments: tuple[Experiment, ...] = ()
    """Measurements that would tell the best from its rivals, the most telling first."""
    half_estimates: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Estimates of the best law from the first and the second half of the record, by path."""

    @property
    def model_errors(self) -> tuple[ModelError, ...]:
        """What the residuals of the best law show to be wrong with model, rig or record."""
        return self.best.fit.model_errors if self.best and self.best.fit else ()

    @property
    def quantity(self) -> str:
        """What is predicted, as in `QUANTITIES`."""
        fits = [c.fit for c in self.candidates if c.fit]
        return fits[0].problem.quantity if fits else "position"

    @property
    def unit(self) -> str:
        """SI unit of the scores."""
        return self.measurement.unit(self.quantity)

    @property
    def blocks_scored(self) -> int:
        """Number of held-out blocks that are scored; one beside which nothing is left is not."""
        validation = self.best.validation if self.best else None
        return len(validation.losses) if validation else 0

    @override
    def __repr__(self) -> str:
        fitted = sum(candidate.fit is not None for candidate in self.candidates)
        return (
            f"<Verdict: {self.sentence}\n {fitted} of {len(self.candidates)} candidates fitted;"
            f" {self.purpose.scored}>"
        )

    @override
    def table(self) -> "pd.DataFrame":
        import pandas as pd

        return pd.DataFrame([candidate.to_row() for candidate in self.candidates])

    @override
    def to_dict(self) -> Mapping[str, Any]:
        return {
            **self._head(),
            "best": self.best.name if self.best else None,
            "ranked": self.best is not None,
            "purpose": self.purpose.name,
            "seed": self.settings.seed,
            "scored": self.purpose.scored,
            "quantity": self.quantity,
            "unit": self.unit,
            "folds": self.plan.folds,
            "blocks_scored": self.blocks_scored,
            "gap": self.plan.gap,
            "horizon": self.plan.horizon,
            "picks_of_other_criteria": dict(self.picks),
            "candidates": [candidate.to_dict() for candidate in self.candidates],
            "control": self.control.to_dict() if self.control else None,
            "checks": self.checks.to_dict(),
            "model_errors": [one.to_dict() for one in self.model_errors],
            "next_measurements": [one.to_dict() for one in self.experiments],
            "halves": {path: list(pair) for path, pair in self.half_estimates.items()},
        }


class Judged(Protocol):
    """What a choice among candidates looks at."""

    @property
    def name(self) -> str:
        """Key of the candidate."""

    @property
    def parameters(self) -> int:
        """Number of unknowns that were fitted."""

    @property
    def dropped(self) -> str:
        """Objection to it, in words."""

    @property
    def score(self) -> float:
        """Held-out error."""

    @property
    def validation(self) -> CrossValidation | None:
        """Held-out errors by block."""


def as_good(other: Judged, best: Judged, *, share: float = NEAR) -> bool:
    """Whether another's loss is within one paired standard error and a share of the best's."""
    if other.validation is None or best.validation is None:
        return False
    gaps = np.subtract(other.validation.losses, best.validation.losses)
    error = float(np.std(gaps, ddof=1)) / math.sqrt(len(gaps)) if len(gaps) > 1 else 0.0
    same = SAME * best.score**2
    return bool(gaps.mean() <= max(error, same) and other.score <= (1.0 + share) * best.score)
