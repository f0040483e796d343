"""What a selection on features of stick-slip gives back."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Final

import numpy as np

from stickslip.data import Checks
from stickslip.friction import FrictionLaw
from stickslip.identify.bands import ENDS, PredictionBand
from stickslip.identify.candidates import Candidate, Verdict, plain
from stickslip.identify.kinds.features.result import FeatureFit
from stickslip.identify.kinds.kind import Column, Columns, data_row
from stickslip.identify.ladder import probability_text
from stickslip.identify.problems.slip_features import COMPARED, FEATURES, StickSlipFeatures, towed
from stickslip.identify.simulated import ENOUGH
from stickslip.mechanisms import Mechanism
from stickslip.show.described import Described
from stickslip.show.formatting import Scale, percent, signed_percent


@dataclass(frozen=True, kw_only=True)
class OtherSetting(metaclass=Described):
    """What fitted laws predict at another setting, and what a record there would tell."""

    name: str
    """What is set: ``"speed"``, ``"stiffness"`` or ``"load"``."""
    value: float
    """To which value [SI]."""
    predicted: Mapping[str, Mapping[str, float]]
    """Median features by name of the law; frequency 0 if it slides on."""
    left: float
    """Expected width of what is asked, over that of now: which law, or its parameters."""

    def to_dict(self) -> Mapping[str, Any]:
        """Return the setting as plain numbers and strings."""
        return {
            "name": self.name,
            "value": self.value,
            "predicted": {name: dict(values) for name, values in self.predicted.items()},
            "expected_width": self.left,
        }


@dataclass(frozen=True, kw_only=True, repr=False)
class FeatureCandidate(Candidate[FeatureFit]):
    """One law on records of stick-slip: its fit, its probability, and what speaks against it."""

    share: float = 0.0
    """Probability of the law among those compared."""
    second: Mapping[str, float] = field(default_factory=dict)
    """Relative errors on the record given to validate, if there is one."""

    @property
    def score(self) -> float:
        """Root mean square of the relative errors of the features, infinite without a fit."""
        return self.fit.rms if self.fit else math.inf

    @property
    def law(self) -> FrictionLaw | None:
        """The fitted law."""
        return self.fit.law if self.fit else None

    def to_row(self) -> Mapping[str, Any]:
        return data_row(COLUMNS, self)

    def to_dict(self) -> Mapping[str, Any]:
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.parameters,
            "share": self.share,
            "errors": dict(self.fit.errors) if self.fit else {},
            "second_record": dict(self.second) or None,
            "dropped": plain(self.dropped),
            "outcome": plain(self.outcome),
            "fit": self.fit.to_dict() if self.fit else None,
        }


PERCENT: Final = Scale(100.0, "%")
"""What errors of features are shown in."""
SHORT: Final = {"standard_deviation": "deviation"}
"""Headings, shortened for a terminal of 80 characters."""


def _second(one: FeatureCandidate) -> float | None:
    """Return the root mean square of the errors on a second record; None without one."""
    errors = one.second.values()
    return math.sqrt(sum(e**2 for e in errors) / len(errors)) if errors else None


def _second_text(one: FeatureCandidate) -> str | None:
    size = _second(one)
    return None if size is None else percent(size).removesuffix(" %")


def _error_column(name: str) -> Column[FeatureCandidate]:
    """Return the column of what a law leaves of a feature."""

    def error(one: FeatureCandidate) -> float:
        return one.fit.errors[name] if one.fit else math.nan

    return Column(
        key=f"{name}_error", title=SHORT.get(name, name), page=name.replace("_", "\n"),
        phone="label", label=name.replace("_", " "), value=error,
        text=lambda one: signed_percent(round(error(one), 4)) if one.fit else None,
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
        key="share", title="share", page="share", phone="label", label="share:",
        value=lambda one: one.share,
        text=lambda one: probability_text(one.share) if one.fit else None,
    ),
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

    features: StickSlipFeatures
    """Features of the first record."""
    checks: Checks
    """What the record can tell, before any fit."""
    rivals: tuple[str, ...] = ()
    """Names of laws that the records do not tell from the closest."""
    settings: tuple[OtherSetting, ...] = ()
    """Other settings, the most telling first."""

    @property
    def route(self) -> str:
        return FEATURES

    @property
    def score_unit(self) -> str:
        return "1"

    @property
    def closest(self) -> FeatureCandidate:
        """The most probable law, recommended or not."""
        return self.candidates[0]

    def predict(self, mechanism: Mechanism) -> PredictionBand:
        """Return the band of frequency [Hz], mean and standard deviation of another record (3,).

        It holds whichever does of the laws that are not told apart, and includes what differs from
        run to run. Frequency and standard deviation are 0 as far as the block may slide steadily.

        Parameters
        ----------
        mechanism : TowedBlock
            The block as it is set for that record.
        """
        block, ends = towed(mechanism), (ENDS[0], 0.5, ENDS[1])
        near = [one.fit for one in self.candidates
                if one.fit and (one is self.closest or one.name in self.rivals)]  # fmt: skip
        draws = [one.foreseen([block], 2 * int(ENOUGH))[:, 0] for one in near]
        rows = [np.nanquantile(one, ends, axis=0) for one in draws]
        low, high = np.min([x[0] for x in rows], axis=0), np.max([x[2] for x in rows], axis=0)
        return PredictionBand(low=low, median=rows[0][1], high=high)

    def _basis(self) -> str:
        return " to features of stick-slip"

    def _details(self) -> Mapping[str, Any]:
        return {
            "not_distinguished_from": list(self.rivals),
            "features": self.features.to_dict(),
            "checks": self.checks.to_dict(),
            "next_measurements": [one.to_dict() for one in self.settings],
        }
