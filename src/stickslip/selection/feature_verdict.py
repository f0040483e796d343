"""What a selection on features of stick-slip gives back."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, final

from typing_extensions import override

from stickslip.experiments import Checks
from stickslip.friction import FrictionLaw
from stickslip.identification import FeatureFit, StickSlipFeatures
from stickslip.identification.features.features import COMPARED
from stickslip.selection.verdict import Verdict, plain

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["FeatureCandidate", "FeatureVerdict", "OtherSpeed"]


@final
@dataclass(frozen=True, kw_only=True)
class OtherSpeed:
    """What fitted laws predict where the spring is pulled at another speed."""

    speed: float
    """Speed of the pull [m/s]."""
    predicted: Mapping[str, Mapping[str, float]]
    """Compared features by name of the candidate, the best first; frequency 0 if it slides on."""
    separation: float
    """Root mean square difference of the features of the best law and of its nearest rival."""

    def to_dict(self) -> Mapping[str, Any]:
        """Return the predictions as plain numbers and strings."""
        return {
            "speed": self.speed,
            "predicted": {name: dict(values) for name, values in self.predicted.items()},
            "separation": self.separation,
        }


@final
@dataclass(frozen=True, kw_only=True)
class FeatureCandidate:
    """One law on a record of stick-slip: its fit, its held-out errors, and what speaks against."""

    name: str
    """Key of the candidate."""
    title: str
    """Name in running text."""
    fit: FeatureFit | None
    """The fit; None if there is none."""
    score_error: float = math.nan
    """Standard error of the score."""
    dropped: str = ""
    """Why it may not be taken, in words; empty if it may."""
    doubt: str = ""
    """What speaks against it although it may be taken."""
    outcome: str = ""
    """What became of it, for tables."""
    second: Mapping[str, float] = field(default_factory=dict)
    """Relative errors on the record given to validate, if there is one."""

    @property
    def parameters(self) -> int:
        """Number of unknowns that were fitted."""
        return len(self.fit.estimates) if self.fit else 0

    @property
    def fitted_law(self) -> None:
        """Features leave no sum of squares that fits of richer laws could begin from."""
        return None

    @property
    def score(self) -> float:
        """Root mean square of the relative errors held out, infinite without a fit."""
        return self.fit.score if self.fit else math.inf

    @property
    def law(self) -> FrictionLaw | None:
        """The fitted law."""
        return self.fit.law if self.fit else None

    @property
    def errors(self) -> Mapping[str, float]:
        """Relative errors of each feature, held out."""
        return self.fit.held_out_errors if self.fit else {}

    def to_row(self) -> Mapping[str, Any]:
        """Return the candidate as a row of `Verdict.to_dataframe`."""
        return {
            "law": self.name,
            "parameters": self.parameters,
            "score": self.score,
            "score_error": self.score_error,
            **{f"{name}_error": self.errors.get(name, math.nan) for name in COMPARED},
            "outcome": self.outcome,
        }

    def to_dict(self) -> Mapping[str, Any]:
        """Return the candidate as plain numbers and strings."""
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.parameters,
            "score": self.score,
            "score_error": self.score_error,
            "errors": dict(self.errors),
            "second_record": dict(self.second) or None,
            "dropped": plain(self.dropped),
            "doubt": plain(self.doubt),
            "outcome": plain(self.outcome),
            "fit": self.fit.to_dict() if self.fit else None,
        }


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class FeatureVerdict(Verdict):
    """A verdict on the force of a spring that pulls a block, by features of stick-slip."""

    candidates: tuple[FeatureCandidate, ...]
    """All laws tried, the one to use first, then the least held-out error."""
    best: FeatureCandidate | None
    """The law to use; None if no candidate could be fitted."""
    control: FeatureCandidate | None
    """The same law with the nominal mechanism; None where nothing else was looked for."""
    ranked: bool
    """Whether there are others, and the record tells the best from all that may be taken."""
    features: StickSlipFeatures
    """Features of the whole record."""
    checks: Checks
    """What the record can tell, before any fit."""
    room: float
    """Root mean square change of the features from the fitted half to the other."""
    speeds: tuple[OtherSpeed, ...] = ()
    """Other speeds of the pull, the most telling first."""

    @property
    @override
    def score_unit(self) -> str:
        return "1"

    @override
    def __repr__(self) -> str:
        fitted = sum(candidate.fit is not None for candidate in self.candidates)
        return (
            f"<Verdict: {self.sentence}\n {fitted} of {len(self.candidates)} candidates fitted to"
            " features of the first half of the record, judged on the second>"
        )

    @override
    def to_dataframe(self) -> "pd.DataFrame":
        import pandas as pd

        return pd.DataFrame([candidate.to_row() for candidate in self.candidates])

    @override
    def to_dict(self) -> Mapping[str, Any]:
        return {
            **self._head(),
            "best": self.best.name if self.best else None,
            "ranked": self.ranked,
            "route": "features",
            "scored": "frequency, mean and standard deviation of the second half, root mean square",
            "change_between_halves": self.room,
            "features": self.features.to_dict(),
            "candidates": [candidate.to_dict() for candidate in self.candidates],
            "control": self.control.to_dict() if self.control else None,
            "checks": self.checks.to_dict(),
            "next_measurements": [one.to_dict() for one in self.speeds],
        }
