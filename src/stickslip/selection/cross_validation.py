"""Held-out errors of fits to records: blocks of time that a fit has not seen."""

import itertools
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, InputError, SimulationError
from stickslip.experiments import Measurement
from stickslip.experiments.cutting import rows_of
from stickslip.experiments.signals import interval_of
from stickslip.identification.applied import driven
from stickslip.identification.optimise import improve
from stickslip.identification.problem import Part, Problem
from stickslip.identification.record_fit import RecordFit, settled
from stickslip.identification.segmenting import LEAST

__all__ = ["FOLDS", "CrossValidation", "Plan", "cross_validate", "halves", "plan_of"]

Array = NDArray[np.float64]

FOLDS = 8
"""Blocks of time, each predicted by a fit to the others."""
EXTRAPOLATED = 1.0 / 3.0
"""Last share of the record that a fit to the rest extrapolates to."""
FEWEST = 30
"""Rows beside a held-out block from which they are worth a segment of their own."""
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
    if fit.route == "shooting":
        _check_block(fit.measurement, block, length, folds)
    correlated = length / fit.inference.effective
    return Plan(
        folds=folds,
        gap=min(correlated, 0.25 * block),
        horizon=min(horizon, block),
        length=length,
    )


def _check_block(measurement: Measurement, block: float, length: float, folds: int) -> None:
    """Refuse a record whose blocks have too few samples to be simulated.

    Raises
    ------
    InputError
        With the length of the record, which the user knows, as that of a block nobody gave.
    """
    times = [np.asarray(record.time) for record in measurement.records() if record.time is not None]
    if not times or any(block / interval_of(time) >= LEAST for time in times):
        return
    count = sum(time.size for time in times)
    raise InputError(
        f"the record of {length:.3g} s, {count} samples, is too short to be judged on {folds}"
        f" held-out blocks, which need {LEAST} samples each: record longer, or `fit` one law"
        " without judging it."
    )


def cross_validate(fit: RecordFit, plan: Plan) -> CrossValidation:
    """Return held-out errors of a fit, its unknowns fitted anew without each block."""
    judged = fit.build(fit.measurement, plan.horizon)
    trained, tested = _positions(fit.problem), _positions(judged)
    refitted = _refitting(fit)
    edges = np.linspace(0.0, max(trained[-1, 1], tested[-1, 1]), plan.folds + 1)
    losses = []
    for first, last in itertools.pairwise(edges.tolist()):
        middle = tested.mean(axis=1)
        held = (middle >= first) & (middle < last)
        if not held.any():
            continue
        # segments may stick out of their block: what they reach is not trained on
        begin, end = min(first, tested[held, 0].min()), max(last, tested[held, 1].max())
        values = refitted(fit, begin - plan.gap, end + plan.gap)
        if values is not None:
            losses.append(_loss(judged, values, held))
    if not losses:
        raise InputError(
            f"the record of {plan.length:.3g} s has nothing left to fit to when a block of it is"
            " held out: record longer, record several decays if nothing drives it, or `fit` one law"
            " without judging it."
        )
    border = (1.0 - EXTRAPOLATED) * edges[-1]
    after = tested[:, 0] >= border
    before = refitted(fit, border - plan.gap, math.inf) if after.any() else None
    ahead = math.nan if before is None else _loss(judged, before, after)
    return CrossValidation(losses=tuple(losses), extrapolation=math.sqrt(ahead))


def _refitting(fit: RecordFit) -> Callable[[RecordFit, float, float], Array | None]:
    """Return how a fit is made again without a stretch of its record."""
    decay = fit.route == "shooting" and not driven(fit.measurement)
    return _refitted_decay if decay else _refitted


def _positions(problem: Problem) -> Array:
    """Return first and last time of each segment (segments, 2), records laid end to end.

    The segments of a table have no times; they take one place each.
    """
    spans = problem.spans
    if _interleaved(spans):
        numbers = np.arange(len(spans), dtype=float)
        return np.column_stack([numbers, numbers + 1.0])
    shifts = _shifts(spans)
    placed: Array = spans[:, 1:] + np.array([[shifts[int(record)]] for record in spans[:, 0]])
    return placed


def _shifts(spans: Array) -> dict[int, float]:
    """Return by record what its times are shifted by, so that records lie end to end."""
    shifts, at = {}, 0.0
    for record in np.unique(spans[:, 0]):
        own = spans[spans[:, 0] == record]
        shifts[int(record)] = at - float(own[:, 1].min())
        at += float(own[:, 2].max() - own[:, 1].min())
    return shifts


def _interleaved(spans: Array) -> bool:
    """Whether segments lie within each other: those of a table, its rows dealt out in turn."""
    same = spans[1:, 0] == spans[:-1, 0]
    return bool(np.any(same & (spans[1:, 1] < 0.5 * (spans[:-1, 1] + spans[:-1, 2]))))


def _loss(judged: Problem, values: Array, held: NDArray[np.bool_]) -> float:
    """Return the mean square over segments that a fit with these values has not seen."""
    found = settled(judged, values, only=np.flatnonzero(held).tolist())
    return found.cost / len(found.residual)


def _refitted(fit: RecordFit, first: float, last: float) -> Array | None:
    """Return the values that fit the segments outside a stretch, from those that fit all.

    None if no segment is outside.
    """
    placed = _positions(fit.problem)
    seen = (placed[:, 1] <= first) | (placed[:, 0] >= last)
    if not seen.any():
        return None
    part = Part(fit.problem, np.flatnonzero(seen).tolist(), fit.found.best)
    end, _ = improve(part, fit.values, rounds=ROUNDS)
    return end.values


def _refitted_decay(fit: RecordFit, first: float, last: float) -> Array | None:
    """Return the same for a free decay, which was fitted in segments longer than a block.

    What comes before a stretch and what comes after it are segments of their own, as long as they
    are, as the whole decay was in the fit that is judged.
    """
    spans = fit.problem.spans
    parts = _outside(fit.measurement, _shifts(spans), first, last)
    if not parts:
        return None
    longest = float(np.max(spans[:, 2] - spans[:, 1]))
    problem = fit.build(Measurement(trials=parts), longest)
    end, _ = improve(problem, fit.values, rounds=ROUNDS)
    return end.values


def _outside(
    measurement: Measurement, shifts: Mapping[int, float], first: float, last: float
) -> tuple[Measurement, ...]:
    """Return what records have outside a stretch, where it is more than a few samples."""
    parts = []
    for number, record in enumerate(measurement.records()):
        if number not in shifts:
            continue
        time = np.asarray(record.time) + shifts[number]
        end = int(np.searchsorted(time, first, side="right"))
        begin = int(np.searchsorted(time, last))
        # A stretch that is elsewhere leaves the record as it is.
        pairs = [(0, end), (begin, len(time))] if begin > end else [(0, len(time))]
        parts += [rows_of(record, a, b) for a, b in pairs if b - a >= FEWEST]
    return tuple(replace(part, name="") for part in parts)


def halves(fit: RecordFit) -> dict[str, tuple[float, float]]:
    """Return the estimates from the first and from the second half of a record, by path.

    Nothing where a half is too short, or alone cannot be fitted.
    """
    middle, refitted = 0.5 * float(_positions(fit.problem)[-1, 1]), _refitting(fit)
    try:
        first, second = refitted(fit, middle, math.inf), refitted(fit, -math.inf, middle)
    except (ConvergenceError, SimulationError):
        return {}
    if first is None or second is None:
        return {}
    return {path: (float(first[i]), float(second[i])) for i, path in enumerate(fit.unknowns.paths)}
