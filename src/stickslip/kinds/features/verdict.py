"""What a selection on features of stick-slip gives back."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, final

from typing_extensions import override

from stickslip.described import Described
from stickslip.experiments import Checks
from stickslip.friction import FrictionLaw
from stickslip.kinds.features.features import COMPARED, FEATURES, StickSlipFeatures
from stickslip.kinds.features.result import FeatureFit
from stickslip.selection import Candidate, Verdict, plain


@final
@dataclass(frozen=True, kw_only=True)
class OtherSpeed(metaclass=Described):
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
@dataclass(frozen=True, kw_only=True, repr=False)
class FeatureCandidate(Candidate[FeatureFit]):
    """One law on a record of stick-slip: its fit, its held-out errors, and what speaks against."""

    score_error: float = math.nan
    """Standard error of the score."""
    second: Mapping[str, float] = field(default_factory=dict)
    """Relative errors on the record given to validate, if there is one."""

    @property
    @override
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

    @override
    def to_row(self) -> Mapping[str, Any]:
        return {
            "law": self.name,
            "parameters": self.parameters,
            "score": self.score,
            "score_error": self.score_error,
            **{f"{name}_error": self.errors.get(name, math.nan) for name in COMPARED},
            "outcome": plain(self.outcome),
        }

    @override
    def to_dict(self) -> Mapping[str, Any]:
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
class FeatureVerdict(Verdict[FeatureCandidate]):
    """A verdict on the force of a spring that pulls a block, by features of stick-slip."""

    control: FeatureCandidate | None
    """The same law with the nominal mechanism; None where nothing else was looked for."""
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
    def route(self) -> str:
        return FEATURES

    @property
    @override
    def score_unit(self) -> str:
        return "1"

    @override
    def _basis(self) -> str:
        return " to features of the first half of the record, scored on the second half"

    @override
    def _details(self) -> Mapping[str, Any]:
        return {
            "scored": "frequency, mean and standard deviation of the second half, root mean square",
            "change_between_halves": self.room,
            "features": self.features.to_dict(),
            "control": self.control.to_dict() if self.control else None,
            "checks": self.checks.to_dict(),
            "next_measurements": [one.to_dict() for one in self.speeds],
        }
