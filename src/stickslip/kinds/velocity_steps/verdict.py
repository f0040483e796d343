"""What a selection on velocity steps gives back."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.described import Described
from stickslip.friction import RateState
from stickslip.kinds.velocity_steps.result import VELOCITY_STEPS, RateStateFit
from stickslip.selection import CrossValidated, CrossValidatedVerdict, plain

Array: TypeAlias = NDArray[np.float64]


@final
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


@final
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
    @override
    def is_simpler(self) -> Collection[str]:
        return self.reduces_to

    @override
    def to_row(self) -> Mapping[str, Any]:
        return {
            "law": self.name,
            "parameters": self.parameters,
            "score": self.score,
            "score_error": self.validation.error if self.validation else math.nan,
            "a_minus_b": self.fit.rate.value if self.fit else math.nan,
            "rmse": self.fit.rmse if self.fit else math.nan,
            "outcome": plain(self.outcome),
        }

    @override
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


@final
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
    @override
    def route(self) -> str:
        return VELOCITY_STEPS

    @property
    @override
    def score_unit(self) -> str:
        return ""

    @override
    def _basis(self) -> str:
        return f" to velocity steps, judged on {'steps' if self.by_steps else 'parts'} held out"

    @override
    def _details(self) -> Mapping[str, Any]:
        held = "velocity steps" if self.by_steps else "parts of the record"
        return {
            "scored": f"coefficient of friction after held-out {held}, root mean square",
            "not_distinguished_from": self.rival or None,
            "checks": self.checks.to_dict(),
            "next_measurements": [one.to_dict() for one in self.next_steps],
        }
