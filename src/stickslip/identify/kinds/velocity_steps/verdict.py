"""What a selection on velocity steps gives back."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.friction import RateState
from stickslip.identify.candidates import CrossValidated, CrossValidatedVerdict, plain, score_text
from stickslip.identify.kinds.kind import Column, Columns, data_row
from stickslip.identify.kinds.velocity_steps.result import VELOCITY_STEPS, RateStateFit
from stickslip.show.described import Described
from stickslip.show.formatting import EstimateText, Scale

Array: TypeAlias = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class OtherStep(metaclass=Described):
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


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RateStateCandidate(CrossValidated[RateStateFit]):
    """One law on velocity steps: its fit, its held-out error, and what speaks against it."""

    unseen: Array | None = None
    """Measured less predicted coefficient of each row of the fit, by the fit that has not seen it
    (n,); NaN for rows that were never held out."""
    reduces_to: tuple[str, ...] = ()
    """Names of the simpler laws that the fitted values make of it."""
    second: float | None = None
    """Root mean square error on the record given to validate, if there is one."""

    @property
    def law(self) -> RateState | None:
        """The fitted law."""
        return self.fit.law if self.fit else None

    @property
    def is_simpler(self) -> Collection[str]:
        return self.reduces_to

    def to_row(self) -> Mapping[str, Any]:
        return data_row(COLUMNS, self)

    def to_dict(self) -> Mapping[str, Any]:
        judged = self.validation
        return {
            "law": self.name,
            "title": self.title,
            "parameters": self.parameters,
            "score": judged.score if judged else None,
            "score_error": judged.error if judged else None,
            "block_errors": [math.sqrt(x) for x in judged.losses] if judged else [],
            "second_record": self.second,
            "dropped": plain(self.dropped),
            "outcome": plain(self.outcome),
            "fit": self.fit.to_dict() if self.fit else None,
        }


def _rate_text(one: RateStateCandidate) -> str | EstimateText | None:
    """Return a - b with its interval; None where no fit has an interval for it."""
    if one.fit is None or one.fit.rate.interval == "known":
        return None
    rate = one.fit.rate
    return rate.parts if rate.bounded else rate.plus_minus


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
        key="score", title="held-out error", page="held-out error\n± 1 s.e.",
        value=lambda one: one.score,
        text=lambda one: score_text(COEFFICIENT, one.score, one.score_error), plotted=True,
    ),
    Column(
        key="score_error",
        value=lambda one: one.validation.error if one.validation else math.nan,
    ),
    Column(
        key="a_minus_b", title="a − b", page="a − b\n95 % interval", phone="label", label="a − b:",
        value=lambda one: one.fit.rate.value if one.fit else math.nan, text=_rate_text,
    ),
    Column(key="rmse", value=lambda one: one.fit.rmse if one.fit else math.nan),
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
class RateStateVerdict(CrossValidatedVerdict[RateStateCandidate]):
    """A verdict on friction while a load point is pulled with steps of its speed."""

    by_steps: bool
    """Whether what was held out begins with a velocity step; else parts of a record with one."""
    rival: str = ""
    """Name of the law that the record does not tell from the closest; empty without one."""
    next_steps: tuple[OtherStep, ...] = ()
    """Steps that would tell the closest from its rival, the most telling first."""

    @property
    def route(self) -> str:
        return VELOCITY_STEPS

    @property
    def score_unit(self) -> str:
        return ""

    def _basis(self) -> str:
        return f" to velocity steps, judged on {'steps' if self.by_steps else 'parts'} held out"

    def _details(self) -> Mapping[str, Any]:
        held = "velocity steps" if self.by_steps else "parts of the record"
        return {
            "scored": f"coefficient of friction after held-out {held}, root mean square",
            "not_distinguished_from": self.rival or None,
            "checks": self.checks.to_dict(),
            "next_measurements": [one.to_dict() for one in self.next_steps],
        }
