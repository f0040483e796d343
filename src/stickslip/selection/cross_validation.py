"""Held-out errors of fits to records: blocks of time that a fit has not seen."""

import itertools
import math
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.identification.optimise import improve
from stickslip.identification.problem import Part, Problem
from stickslip.identification.record_fit import RecordFit, settled

__all__ = ["FOLDS", "CrossValidation", "Plan", "cross_validate", "halves", "plan_of"]

Array = NDArray[np.float64]

FOLDS = 8
"""Blocks of time, each predicted by a fit to the others."""
EXTRAPOLATED = 1.0 / 3.0
"""Last share of the record that a fit to the rest extrapolates to."""
ROUNDS = 8
"""Steps at most from the estimates of the whole record to those without a block."""


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
    """Length of all records together [s]; 0 for a table."""


@final
@dataclass(frozen=True, kw_only=True)
class CrossValidation:
    """Held-out errors of one candidate."""

    losses: tuple[float, ...]
    """Mean square of each block."""
    extrapolation: float
    """Root mean square of the last third, predicted by a fit to what comes before."""

    @property
    def score(self) -> float:
        """Root mean square over blocks."""
        return math.sqrt(sum(self.losses) / len(self.losses))

    @property
    def error(self) -> float:
        """Standard error of the score, blocks taken as independent."""
        count = len(self.losses)
        variance = float(np.var(self.losses, ddof=1)) / count if count > 1 else math.inf
        return math.sqrt(variance) / (2.0 * self.score) if self.score > 0.0 else 0.0


def plan_of(fit: RecordFit, *, horizon: float, folds: int = FOLDS) -> Plan:
    """Return a plan: gaps as long as residuals of a fit are correlated, a horizon that fits in."""
    spans = fit.problem.spans
    if _interleaved(spans):
        return Plan(folds=min(folds, len(spans)), gap=0.0, horizon=horizon, length=0.0)
    length = float(np.sum(spans[:, 2] - spans[:, 1]))
    block = length / folds
    correlated = length / fit.inference.effective
    return Plan(
        folds=folds,
        gap=min(correlated, 0.25 * block),
        horizon=min(horizon, block),
        length=length,
    )


def cross_validate(fit: RecordFit, plan: Plan) -> CrossValidation:
    """Return held-out errors of a fit, its unknowns fitted anew without each block."""
    judged = fit.build(fit.measurement, plan.horizon)
    trained, tested = _positions(fit.problem), _positions(judged)
    edges = np.linspace(0.0, max(trained[-1, 1], tested[-1, 1]), plan.folds + 1)
    losses = []
    for first, last in itertools.pairwise(edges.tolist()):
        middle = tested.mean(axis=1)
        held = (middle >= first) & (middle < last)
        if not held.any():
            continue
        # segments may stick out of their block: what they reach is not trained on
        begin, end = min(first, tested[held, 0].min()), max(last, tested[held, 1].max())
        seen = (trained[:, 1] <= begin - plan.gap) | (trained[:, 0] >= end + plan.gap)
        if seen.any():
            losses.append(_loss(fit, judged, seen, held))
    if not losses:
        raise InputError(
            f"the record of {plan.length:.3g} s has nothing left to fit to when a block of it is"
            " held out: record longer, or `fit` one law without judging it."
        )
    border = (1.0 - EXTRAPOLATED) * edges[-1]
    before = trained[:, 1] <= border - plan.gap
    after = tested[:, 0] >= border
    ahead = _loss(fit, judged, before, after) if before.any() and after.any() else math.nan
    return CrossValidation(losses=tuple(losses), extrapolation=math.sqrt(ahead))


def _positions(problem: Problem) -> Array:
    """Return first and last time of each segment (segments, 2), records laid end to end.

    The segments of a table have no times; they take one place each.
    """
    spans = problem.spans
    if _interleaved(spans):
        numbers = np.arange(len(spans), dtype=float)
        return np.column_stack([numbers, numbers + 1.0])
    starts, at = {}, 0.0
    for record in np.unique(spans[:, 0]):
        own = spans[spans[:, 0] == record]
        starts[record] = at - own[:, 1].min()
        at += float(own[:, 2].max() - own[:, 1].min())
    shift = np.array([starts[record] for record in spans[:, 0]])
    placed: Array = spans[:, 1:] + shift[:, None]
    return placed


def _interleaved(spans: Array) -> bool:
    """Whether segments lie within each other: those of a table, its rows dealt out in turn."""
    same = spans[1:, 0] == spans[:-1, 0]
    return bool(np.any(same & (spans[1:, 1] < 0.5 * (spans[:-1, 1] + spans[:-1, 2]))))


def _loss(
    fit: RecordFit, judged: Problem, seen: NDArray[np.bool_], held: NDArray[np.bool_]
) -> float:
    """Return the mean square over segments held out of a fit to those seen."""
    values = _refitted(fit, seen)
    found = settled(judged, values, only=np.flatnonzero(held).tolist())
    return found.cost / len(found.residual)


def _refitted(fit: RecordFit, seen: NDArray[np.bool_]) -> Array:
    """Return the values that fit some segments best, from those that fit all."""
    part = Part(fit.problem, np.flatnonzero(seen).tolist(), fit.found.best)
    end, _ = improve(part, fit.values, rounds=ROUNDS)
    return end.values


def halves(fit: RecordFit) -> dict[str, tuple[float, float]]:
    """Return the estimates from the first and from the second half of a record, by path."""
    placed = _positions(fit.problem)
    middle = 0.5 * float(placed[-1, 1])
    first = placed[:, 1] <= middle
    second = placed[:, 0] >= middle
    if not (first.any() and second.any()):
        return {}
    pair = [_refitted(fit, part) for part in (first, second)]
    return {
        path: (float(pair[0][i]), float(pair[1][i])) for i, path in enumerate(fit.unknowns.paths)
    }
