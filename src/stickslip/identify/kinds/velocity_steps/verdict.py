"""What a selection on velocity steps gives back."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from stickslip.data import Checks
from stickslip.friction import RateState
from stickslip.identify.candidates import Candidate, Verdict, plain, score_text
from stickslip.identify.kinds.kind import Column, Columns, data_row
from stickslip.identify.kinds.velocity_steps.result import VELOCITY_STEPS, RateStateFit
from stickslip.identify.ladder import probability_text
from stickslip.show.formatting import EstimateText, Scale


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RateStateCandidate(Candidate[RateStateFit]):
    """One law on velocity steps: its fit, its probability, and what speaks against it."""

    share: float
    """Probability of the law among those compared."""
    second: float | None = None
    """Root mean square error on the record given to validate, if there is one."""

    @property
    def law(self) -> RateState | None:
        """The fitted law."""
        return self.fit.law if self.fit else None

    @property
    def score(self) -> float | None:
        """Root mean square of what the law leaves of the coefficient."""
        return self.fit.rms if self.fit else None

    def to_row(self) -> Mapping[str, Any]:
        return data_row(COLUMNS, self)

    def to_dict(self) -> Mapping[str, Any]:
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.parameters,
            "share": self.share,
            "leaves": self.score,
            "second_record": self.second,
            "dropped": plain(self.dropped),
            "outcome": plain(self.outcome),
            "fit": self.fit.to_dict() if self.fit else None,
        }


def _rate_text(one: RateStateCandidate) -> str | EstimateText | None:
    """Return a - b with its interval; None where no fit has an interval for it."""
    if one.fit is None or one.fit.rate.interval == "known":
        return None
    return one.fit.rate.parts


COEFFICIENT: Final = Scale(1.0, "")
"""Errors of a coefficient are absolute, not percentages."""

COLUMNS: Final[Columns[RateStateCandidate]] = (
    Column(
        key="law", title="law", page="model", numeric=False,
        value=lambda one: one.name, text=lambda one: one.title,
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
    Column(
        key="leaves", title="leaves", page="leaves",
        value=lambda one: one.score, text=lambda one: score_text(COEFFICIENT, one.score),
    ),
    Column(
        key="a_minus_b", title="a − b", page="a − b\n95 % interval", phone="label", label="a − b:",
        value=lambda one: one.fit.rate.value if one.fit else None, text=_rate_text,
    ),
    Column(
        title="second record", page="second\nrecord", phone="label", optional=True,
        value=lambda one: one.second, text=lambda one: score_text(COEFFICIENT, one.second).value,
    ),
    Column(
        key="outcome", page="outcome", numeric=False,
        value=lambda one: plain(one.outcome), text=lambda one: one.outcome,
    ),
)  # fmt: skip
"""What tables say of each law."""


@dataclass(frozen=True, kw_only=True, repr=False)
class RateStateVerdict(Verdict[RateStateCandidate]):
    """A verdict on friction while a load point is pulled with steps of its speed."""

    checks: Checks
    """What the record can tell, before any fit."""
    rival: str = ""
    """Name of the law that the record does not tell from the closest; empty without one."""

    @property
    def route(self) -> str:
        return VELOCITY_STEPS

    @property
    def score_unit(self) -> str:
        return ""

    @property
    def closest(self) -> RateStateCandidate:
        """The most probable law, recommended or not."""
        return self.candidates[0]

    def _basis(self) -> str:
        return " to velocity steps"

    def _details(self) -> Mapping[str, Any]:
        return {
            "not_distinguished_from": self.rival or None,
            "checks": self.checks.to_dict(),
        }
