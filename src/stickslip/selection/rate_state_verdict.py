"""What a selection on velocity steps gives back."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.experiments import Checks
from stickslip.friction import RateState
from stickslip.identification import RateStateFit
from stickslip.identification.rate_state.result import ROUTE, UNSPENT, bounds_met
from stickslip.selection.choice import TRUSTED
from stickslip.selection.cross_validation import CrossValidation
from stickslip.selection.verdict import Verdict, plain

if TYPE_CHECKING:
    import pandas as pd

Array: TypeAlias = NDArray[np.float64]

__all__ = ["OtherStep", "RateStateCandidate", "RateStateVerdict"]


@final
@dataclass(frozen=True, kw_only=True)
class OtherStep:
    """A velocity step that was not measured, and how far apart two fitted laws are after it."""

    before: float
    """Speed of the load point before the step [m/s]."""
    after: float
    """Speed after it [m/s]."""
    separation: float
    """Root mean square difference of the coefficients that the two laws predict."""

    def to_dict(self) -> Mapping[str, float]:
        """Return the step as plain numbers."""
        return {"before": self.before, "after": self.after, "separation": self.separation}


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class RateStateCandidate:
    """One law on velocity steps: its fit, its held-out error, and what speaks against it."""

    name: str
    """Key of the candidate."""
    title: str
    """Name in running text."""
    fit: RateStateFit | None
    """The fit to the whole record; None if there is none."""
    validation: CrossValidation | None = None
    """Mean squares of the coefficient in each part that a fit to the others has not seen."""
    unseen: Array | None = None
    """Measured less predicted coefficient of each row of the fit, by the fit that has not seen it
    (n,); NaN for rows that were never held out."""
    simpler: tuple[str, ...] = ()
    """Names of the candidates that it contains."""
    dropped: str = ""
    """Why it may not be taken, in words; empty if it may."""
    outcome: str = ""
    """What became of it, for tables."""
    second: float | None = None
    """Root mean square error on the record given to validate, if there is one."""

    @property
    def parameters(self) -> int:
        """Number of unknowns that were fitted."""
        return len(self.fit.estimates) if self.fit else 0

    @property
    def score(self) -> float:
        """Root mean square held-out error of the coefficient, infinite without one."""
        return self.validation.score if self.validation else math.inf

    @property
    def score_error(self) -> float:
        """Standard error of the score."""
        return self.validation.error if self.validation else math.nan

    @property
    def law(self) -> RateState | None:
        """The fitted law."""
        return self.fit.law if self.fit else None

    @property
    def residual(self) -> float:
        """Root mean square of the residuals of the fit to the whole record."""
        return self.fit.rms if self.fit else math.inf

    @property
    def effective(self) -> float:
        """Effective number of independent residuals."""
        return self.fit.inference.effective if self.fit else 0.0

    @property
    def is_simpler(self) -> Collection[str]:
        """Names of the contained candidates that it is at its fitted values."""
        law = self.law
        if law is None:
            return ()
        if law.evolution != "none":
            return self.simpler if abs(law.evolution_effect) < UNSPENT * law.direct_effect else ()
        return self.simpler if law.direct_effect == 0.0 else ()

    @property
    def weak(self) -> bool:
        """Whether a parameter ended at a bound, or the condition is too large."""
        if self.fit is None:
            return True
        return self.fit.inference.condition > TRUSTED or bool(bounds_met(self.fit))

    def to_row(self) -> Mapping[str, Any]:
        """Return the candidate as a row of `Verdict.to_dataframe`."""
        return {
            "law": self.name,
            "parameters": self.parameters,
            "score": self.score,
            "score_error": self.score_error,
            "a_minus_b": self.fit.rate.value if self.fit else math.nan,
            "rmse": self.fit.rmse if self.fit else math.nan,
            "outcome": self.outcome,
        }

    def to_dict(self) -> Mapping[str, Any]:
        """Return the candidate as plain numbers and strings."""
        judged = self.validation
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.parameters,
            "score": judged.score if judged else None,
            "score_error": judged.error if judged else None,
            "held_out": list(judged.losses) if judged else [],
            "second_record": self.second,
            "dropped": plain(self.dropped),
            "outcome": plain(self.outcome),
            "fit": self.fit.to_dict() if self.fit else None,
        }


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class RateStateVerdict(Verdict):
    """A verdict on friction while a load point is pulled with steps of its speed."""

    candidates: tuple[RateStateCandidate, ...]
    """All laws tried, the closest first, then the least held-out error."""
    best: RateStateCandidate | None
    """The law to use; None if no law explains the record."""
    closest: RateStateCandidate
    """The best law, or the one that comes nearest."""
    ranked: bool
    """Whether there are others, and the record tells the closest from all of them."""
    checks: Checks
    """What the record can tell, before any fit."""
    by_steps: bool
    """Whether what was held out begins with a velocity step; else parts of a record with one."""
    rival: str = ""
    """Name of the law that the record does not tell from the closest; empty without one."""
    next_steps: tuple[OtherStep, ...] = ()
    """Steps that would tell the closest from its rival, the most telling first."""

    @property
    @override
    def score_unit(self) -> str:
        return "1"

    @override
    def __repr__(self) -> str:
        fitted = sum(candidate.fit is not None for candidate in self.candidates)
        return (
            f"<Verdict: {self.sentence}\n {fitted} of {len(self.candidates)} candidates fitted to"
            f" velocity steps, judged on {'steps' if self.by_steps else 'parts'} held out>"
        )

    @override
    def to_dataframe(self) -> "pd.DataFrame":
        import pandas as pd

        return pd.DataFrame([candidate.to_row() for candidate in self.candidates])

    @override
    def to_dict(self) -> Mapping[str, Any]:
        held = "velocity steps" if self.by_steps else "parts of the record"
        return {
            **self._head(),
            "best": self.best.name if self.best else None,
            "closest": self.closest.name,
            "ranked": self.ranked,
            "route": ROUTE,
            "scored": f"coefficient of friction after held-out {held}, root mean square",
            "candidates": [candidate.to_dict() for candidate in self.candidates],
            "not_told_from": self.rival or None,
            "checks": self.checks.to_dict(),
            "next_measurements": [one.to_dict() for one in self.next_steps],
        }
