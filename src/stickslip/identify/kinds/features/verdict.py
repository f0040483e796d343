"""What a selection on features of stick-slip gives back."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

from stickslip.data import Checks
from stickslip.friction import FrictionLaw
from stickslip.identify.candidates import Candidate, Verdict, plain, score_text
from stickslip.identify.fits import Estimate
from stickslip.identify.kinds.features.features import COMPARED, FEATURES, StickSlipFeatures
from stickslip.identify.kinds.features.result import FeatureFit
from stickslip.identify.kinds.kind import Column, Columns, data_row
from stickslip.show.described import Described
from stickslip.show.formatting import EstimateText, Scale, percent, signed_percent


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


@dataclass(frozen=True, kw_only=True, repr=False)
class FeatureCandidate(Candidate[FeatureFit]):
    """One law on a record of stick-slip: its fit, its held-out errors, and what speaks against."""

    score_error: float = math.nan
    """Standard error of the score."""
    second: Mapping[str, float] = field(default_factory=dict)
    """Relative errors on the record given to validate, if there is one."""

    @property
    def score(self) -> float:
        """Root mean square of the relative errors held out, infinite without a fit."""
        return self.fit.score if self.fit else math.inf

    @property
    def alone(self) -> tuple[Estimate, ...]:
        """Estimates that hold if this law does; empty where those of `fit` do."""
        return self.fit.alone if self.fit else ()

    @property
    def law(self) -> FrictionLaw | None:
        """The fitted law."""
        return self.fit.law if self.fit else None

    @property
    def errors(self) -> Mapping[str, float]:
        """Relative errors of each feature, held out."""
        return self.fit.held_out_errors if self.fit else {}

    def to_row(self) -> Mapping[str, Any]:
        return data_row(COLUMNS, self)

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
            "alone": [estimate.to_dict() for estimate in self.alone],
        }


PERCENT: Final = Scale(100.0, "%")
"""What errors of features are shown in."""
SHORT: Final = {"standard_deviation": "deviation"}
"""Headings, shortened for a terminal of 80 characters."""


def share_parts(one: FeatureCandidate) -> EstimateText:
    """Return a held-out error [%] and its standard error, as two texts without the unit."""
    return score_text(PERCENT, one.score, one.score_error)


def _second(one: FeatureCandidate) -> float | None:
    """Return the root mean square of the errors on a second record; None without one."""
    errors = one.second.values()
    return math.sqrt(sum(e**2 for e in errors) / len(errors)) if errors else None


def _second_text(one: FeatureCandidate) -> str | None:
    size = _second(one)
    return None if size is None else percent(size).removesuffix(" %")


def _error_column(name: str) -> Column[FeatureCandidate]:
    """Return the column of the held-out errors of a feature."""

    def text(one: FeatureCandidate) -> str | None:
        error = one.errors.get(name, math.nan)
        return signed_percent(error) if math.isfinite(error) else None

    return Column(
        key=f"{name}_error", title=SHORT.get(name, name), page=name.replace("_", "\n"),
        phone="label", label=name.replace("_", " "),
        value=lambda one: one.errors.get(name, math.nan), text=text,
    )  # fmt: skip


COLUMNS: Final[Columns[FeatureCandidate]] = (
    Column(
        key="law", title="law", page="model", numeric=False,
        value=lambda one: one.name, text=lambda one: one.name,
    ),
    Column(
        key="parameters", title="free", page="free\nparameters", phone="hide",
        value=lambda one: one.parameters,
        text=lambda one: str(one.parameters) if one.fit else None,
    ),
    Column(
        key="score", title="held-out, %", page="held-out error\n%, ± 1 s.e.", why_empty="no score",
        plotted=True,
        value=lambda one: one.score, text=lambda one: share_parts(one) if one.fit else None,
    ),
    Column(key="score_error", value=lambda one: one.score_error),
    *map(_error_column, COMPARED),
    Column(
        title="second", page="second record", unit="%", phone="label", optional=True,
        value=_second, text=_second_text,
    ),
    Column(
        key="outcome", page="outcome", numeric=False,
        value=lambda one: plain(one.outcome), text=lambda one: one.outcome,
    ),
)  # fmt: skip
"""What tables say of each law."""


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
    def route(self) -> str:
        return FEATURES

    @property
    def score_unit(self) -> str:
        return "1"

    def _basis(self) -> str:
        return " to features of the first half of the record, scored on the second half"

    def _details(self) -> Mapping[str, Any]:
        return {
            "scored": "frequency, mean and standard deviation of the second half, root mean square",
            "change_between_halves": self.room,
            "features": self.features.to_dict(),
            "control": self.control.to_dict() if self.control else None,
            "checks": self.checks.to_dict(),
            "next_measurements": [one.to_dict() for one in self.speeds],
        }
