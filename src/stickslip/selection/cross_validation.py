"""Held-out errors of fits to records: blocks of time that a fit has not seen."""

import itertools
import math
from abc import abstractmethod
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Protocol, cast, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import TypeVar, override

from stickslip.errors import ConvergenceError, InputError
from stickslip.experiments import Checks, Measurement, interval_of
from stickslip.formatting import quantity
from stickslip.identification import (
    LEAST,
    Fit,
    Inference,
    Problem,
    RecordFit,
    RecordProblem,
    ResidualJacobian,
    SubsetProblem,
    improve,
    positions_of,
    refitted,
    settled,
)
from stickslip.selection.verdict import Candidate, Verdict

Array = NDArray[np.float64]
Fit_co = TypeVar("Fit_co", bound=Fit[Any], covariant=True)

FOLDS = 8
"""Blocks of time, each predicted by a fit to the others."""
DIGITS = 6
"""Significant digits of a score."""
EXTRAPOLATED = 1.0 / 3.0
"""Last share of the record that a fit to the rest extrapolates to."""


@final
@dataclass(frozen=True, kw_only=True)
class Plan:
    """How all candidates of a selection are judged."""

    folds: int
    """Blocks of time."""
    gap: float
    """Time [s] left out on both sides of a block."""
    horizon: float
    """Length [s] of the segments that are predicted."""
    length: float
    """Length of all records together [s]."""


@final
@dataclass(frozen=True, kw_only=True)
class CrossValidation:
    """Held-out errors of one candidate."""

    losses: tuple[float, ...]
    """Mean square of each block."""
    extrapolation: float
    """Root mean square of the last third, predicted by a fit to what comes before."""
    joints: Mapping[str, "CrossValidation"] = field(default_factory=dict)
    """The same of each joint; empty where there is only one."""

    @classmethod
    def of(
        cls, losses: Sequence["_Loss"], ahead: "_Loss | None", joints: Iterable[str] = ()
    ) -> "CrossValidation":
        """Return the errors of blocks and of an extrapolation, and those of each joint."""
        return cls(
            losses=tuple(one.mean for one in losses),
            extrapolation=math.nan if ahead is None else math.sqrt(ahead.mean),
            joints={
                name: cls.of(own, None if ahead is None else ahead.joints.get(name))
                for name in joints
                if (own := [one.joints[name] for one in losses if name in one.joints])
            },
        )

    @classmethod
    def by_segment(
        cls, residual: Array, segment: NDArray[np.intp], weight: Array | float = 1.0
    ) -> "CrossValidation":
        """Return the mean square (n,) of each segment, of weighted rows; NaN was not held out."""
        weights = np.broadcast_to(np.square(weight), residual.shape)
        rows = [segment == one for one in np.unique(segment[~np.isnan(residual)])]
        losses = [float(np.average(residual[r] ** 2, weights=weights[r])) for r in rows]
        return cls(losses=tuple(losses), extrapolation=math.nan)

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


@final
@dataclass(frozen=True)
class _Loss:
    """Mean square of a held-out block."""

    mean: float
    joints: Mapping[str, "_Loss"] = field(default_factory=dict)


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
    @override
    def score(self) -> float:
        """Root mean square held-out error, infinite without one."""
        return self.validation.score if self.validation else math.inf

    @property
    @override
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
    @override
    def closest(self) -> Candidate_co:
        """What the rule of choice takes: `best`, or what comes closest to the record."""
        taken = self.best or self.not_recommended
        assert taken is not None
        return taken


def plan_of(fit: RecordFit, *, horizon: float) -> Plan:
    """Return a plan: gaps as long as residuals of a fit are correlated, a horizon that fits in."""
    spans = fit.problem.spans
    length = float(np.sum(spans[:, 2] - spans[:, 1]))
    if not length > 0.0:
        raise InputError(
            "hardly any rows of this record can be compared, and none can be held out: record"
            " longer, or `fit` one law without a held-out error."
        )
    block = length / FOLDS
    if fit.problem.simulates:
        _check_block(fit.measurement, block, length)
    correlated = length / fit.inference.effective
    return Plan(
        folds=FOLDS,
        gap=min(correlated, 0.25 * block),
        horizon=min(horizon, block),
        length=length,
    )


def _check_block(measurement: Measurement, block: float, length: float) -> None:
    """Refuse a record whose blocks have too few samples to be simulated."""
    times = [np.asarray(record.time) for record in measurement.records() if record.time is not None]
    if not times or any(block / interval_of(time) >= LEAST for time in times):
        return
    count = sum(time.size for time in times)
    raise InputError(
        f"the record of {quantity(length, 's')}, {count} samples, is too short for {FOLDS}"
        f" held-out blocks of at least {LEAST} samples: record longer, or `fit` one law without a"
        " held-out error."
    )


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


def cross_validate(fit: RecordFit, plan: Plan) -> CrossValidation:
    """Return held-out errors of a fit, its unknowns fitted anew without each block."""
    judged = fit.build(fit.measurement, plan.horizon)
    trained, tested = positions_of(fit.problem), positions_of(judged)
    edges = np.linspace(0.0, max(trained[-1, 1], tested[-1, 1]), plan.folds + 1)
    losses = []
    for first, last in itertools.pairwise(edges.tolist()):
        middle = tested.mean(axis=1)
        held = (middle >= first) & (middle < last)
        if not held.any():
            continue
        # segments may stick out of their block: what they reach is not trained on
        begin, end = min(first, tested[held, 0].min()), max(last, tested[held, 1].max())
        without = refitted(fit, begin - plan.gap, end + plan.gap)
        if without is not None:
            if len(without.residual) < len(fit.values):  # it would keep what it has seen
                raise ConvergenceError(
                    f"{len(without.residual)} rows are left for {len(fit.values)} unknowns"
                )
            losses.append(_loss(judged, without.values, held))
    if not losses:
        raise InputError(
            f"the record of {quantity(plan.length, 's')} leaves no data for the fit when one of"
            " its blocks is held out: record longer, record several decays if nothing drives the"
            " motion, or `fit` one law without a held-out error."
        )
    border = (1.0 - EXTRAPOLATED) * edges[-1]
    after = tested[:, 0] >= border
    before = refitted(fit, border - plan.gap, math.inf) if after.any() else None
    ahead = None if before is None else _loss(judged, before.values, after)
    names = dict.fromkeys(name for one in losses for name in one.joints)
    return CrossValidation.of(losses, ahead, names)


def _loss(judged: RecordProblem, values: Array, held: NDArray[np.bool_]) -> _Loss:
    """Return the mean square over segments that a fit with these values has not seen.

    That of a joint is of its own rows, without their weights.
    """
    found = settled(judged, values, only=np.flatnonzero(held).tolist())
    parts = judged.by_joint(found)
    mean = found.cost / len(found.residual)
    moving = {name: one for name, one in parts.items() if len(one.residual)}
    return _Loss(mean, {name: _Loss(one.rms**2) for name, one in moving.items()})


def halves(fit: RecordFit) -> dict[str, tuple[float, float]]:
    """Return the estimates from the first and from the second half of a record, by path.

    Nothing where a half is too short, or alone cannot be fitted.
    """
    found = fit.halves
    if found is None:
        return {}
    first, second = found.values
    return {
        path: (float(first[i]), float(second[i]))
        for i, path in enumerate(fit.free_parameters.paths)
    }
