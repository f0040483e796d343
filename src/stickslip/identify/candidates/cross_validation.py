"""Held-out errors of fits to records: blocks of time that a fit has not seen."""

import math
from abc import abstractmethod
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from typing import Any, Protocol, cast, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import TypeVar

from stickslip.data import Checks
from stickslip.errors import InputError
from stickslip.identify.candidates.verdict import Candidate, Verdict
from stickslip.identify.fits import (
    Fit,
    Inference,
    Problem,
    ResidualJacobian,
    SubsetProblem,
    improve,
)

Array = NDArray[np.float64]
Fit_co = TypeVar("Fit_co", bound=Fit[Any], covariant=True)

DIGITS = 6
"""Digits of a score, and of evidence, that another kernel of linear algebra gives, too."""


@dataclass(frozen=True, kw_only=True)
class CrossValidation:
    """Held-out errors of one candidate."""

    losses: tuple[float, ...]
    """Mean square of each block."""

    @classmethod
    def by_segment(
        cls, residual: Array, segment: NDArray[np.intp], weight: Array | float = 1.0
    ) -> "CrossValidation":
        """Return the mean square (n,) of each segment, of weighted rows; NaN was not held out."""
        weights = np.broadcast_to(np.square(weight), residual.shape)
        rows = [segment == one for one in np.unique(segment[~np.isnan(residual)])]
        losses = [float(np.average(residual[r] ** 2, weights=weights[r])) for r in rows]
        return cls(losses=tuple(losses))

    @property
    def score(self) -> float:
        """Root mean square over blocks.

        It has no more digits than another kernel of linear algebra gives, so that laws that do the
        same have the same score, and the order of the candidates decides.
        """
        return float(f"{math.sqrt(sum(self.losses) / len(self.losses)):.{DIGITS}g}")

    @property
    def error(self) -> float:
        """Standard error of the score, blocks taken as independent."""
        count = len(self.losses)
        variance = float(np.var(self.losses, ddof=1)) / count if count > 1 else math.inf
        return math.sqrt(variance) / (2.0 * self.score) if self.score > 0.0 else 0.0


class _WithResiduals(Protocol):
    """What a fit has whose residuals are those of a record in time."""

    inference: Inference

    @property
    def rms(self) -> float: ...


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class CrossValidated(Candidate[Fit_co]):
    """A candidate whose residuals are those of a record in time, judged on held-out blocks."""

    validation: CrossValidation | None = None
    """Held-out errors by block; None without a fit."""
    simpler: Collection[str] = ()
    """Names of the candidates that the law contains."""

    @property
    def score(self) -> float:
        """Root mean square held-out error, infinite without one."""
        return self.validation.score if self.validation else math.inf

    @property
    def score_error(self) -> float:
        """Standard error of the score; infinite if there is none."""
        return self.validation.error if self.validation else math.inf

    @property
    def residual(self) -> float:
        """Root mean square of the residuals of the fit to the whole record, infinite without."""
        return cast("_WithResiduals", self.fit).rms if self.fit else math.inf

    @property
    def effective(self) -> float:
        """Effective number of independent residuals, 0 without a fit."""
        return cast("_WithResiduals", self.fit).inference.effective if self.fit else 0.0

    @property
    @abstractmethod
    def is_simpler(self) -> Collection[str]:
        """Names of those of these that it is at its fitted values."""


Candidate_co = TypeVar("Candidate_co", bound=CrossValidated[Any], covariant=True)


@dataclass(frozen=True, kw_only=True, repr=False)
class CrossValidatedVerdict(Verdict[Candidate_co]):
    """A verdict on such candidates: one is closest to the record, recommended or not."""

    checks: Checks
    """What the record can tell, before any fit."""
    not_recommended: Candidate_co | None = None
    """What comes closest where no law is recommended; None where one is."""

    @property
    @final
    def closest(self) -> Candidate_co:
        """What the rule of choice takes: `best`, or what comes closest to the record."""
        taken = self.best or self.not_recommended
        assert taken is not None
        return taken


def held_out(
    problem: Problem,
    best: ResidualJacobian,
    held: Sequence[int] | None = None,
    told: Callable[[int, int], object] | None = None,
) -> Array:
    """Return the residuals (n,) of each segment after a fit to all others, which begins at `best`.

    Every segment is held out in turn, or those that are named; the rows of others are NaN.
    """
    present = np.unique(best.segment).tolist()
    if len(present) < 2:
        raise InputError(
            "one setting leaves nothing to fit when it is held out: measure at further settings, or"
            " `fit` one law without a held-out error."
        )
    chosen = present if held is None else held
    unseen = np.full(len(best.segment), np.nan)
    for number, one in enumerate(chosen, 1):
        if told is not None:
            told(number, len(chosen))
        end, _ = improve(
            SubsetProblem(problem, [other for other in present if other != one], best), best.values
        )
        seen = problem.linearise(end.values, only=[one], slopes=False)
        unseen[best.segment == one] = seen.residual
    return unseen
