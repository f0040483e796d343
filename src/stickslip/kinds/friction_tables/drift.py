"""A level that drifts while a table is measured: laws with it beside the law that is named."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
import scipy.stats
from numpy.typing import NDArray

from stickslip.experiments import Measurement, speeds_in_order
from stickslip.formatting import quantity
from stickslip.identification import (
    ModelError,
    RecordFit,
    RecordProblem,
    ResidualJacobian,
    improve,
)
from stickslip.kinds.friction_tables.shapes import Readings, smooth_curve
from stickslip.kinds.records.verdict import RecordCandidate
from stickslip.selection import (
    LEAST,
    LIKELY,
    NEAR,
    ROUNDS,
    SETTLED,
    CrossValidation,
    along,
    drift_text,
    errs_more,
    if_drifting,
)

Array = NDArray[np.float64]

CHANCE: Final = 1e-3
"""Chance of a drift as large by the scatter of the readings from which it is taken out."""
CUTOFF: Final = 1e-8
"""Singular values over the largest one below which columns have no effect."""
DECIDES: Final = 1e-9
"""Stands for the share of a reading that others tell where it decides alone."""


@final
@dataclass(frozen=True, kw_only=True)
class Drift:
    """What changes evenly from the first row of a table to the last: friction, or a zero."""

    size: float
    """Share by which friction changes, or of its mean size by which the zero of its sensor does."""
    constant: float
    """Part of a reading that is no friction, stated or fitted [N]: it does not drift with it."""
    zero: float = 0.0
    """Mean size of friction [N] where the zero of its sensor drifts; 0 where friction does."""

    def without(self, measurement: Measurement) -> Measurement:
        """Return a table without the drift, at the level of its first row."""
        read = np.asarray(measurement.friction, dtype=float)
        drift = self.size * along(len(read))
        friction = (read - self.constant) / (1.0 + drift)
        left = read - self.zero * drift if self.zero else self.constant + friction
        return replace(measurement, friction=left)


@final
@dataclass(frozen=True, kw_only=True)
class Drifting:
    """A law beside a drift, as it fits a table."""

    candidate: RecordCandidate
    """The law, with the held-out errors that it has beside the drift."""
    drift: Drift
    """The drift."""
    error: float
    """Standard error of its size."""
    freedom: int
    """Readings less parameters."""
    instead: "Drifting | None" = None
    """The same law beside a drift of the zero, where that explains the table as well."""

    @property
    def title(self) -> str:
        """The law, and the drift with which it explains the table."""
        return if_drifting(self.candidate.title, self.drift.size, "row")

    @property
    def sure(self) -> bool:
        """Whether the drift is more than the scatter of the readings makes by chance."""
        times = abs(self.drift.size) / max(self.error, LEAST)
        return bool(2.0 * scipy.stats.t.sf(times, self.freedom) < CHANCE)

    @property
    def interval(self) -> tuple[float, float]:
        """95 % confidence interval of the size, if the law holds."""
        half = float(scipy.stats.t.ppf(0.975, self.freedom)) * self.error
        return self.drift.size - half, self.drift.size + half

    def possible(self, measurement: Measurement) -> list[Measurement]:
        """Return what tables may be without the drift, beside the one that is the most likely."""
        ends = [replace(self.drift, size=end).without(measurement) for end in self.interval]
        return ends if self.instead is None else [*ends, *self.instead.possible(measurement)]

    def finding(self, unit: str) -> ModelError:
        """Return that a drift was taken out."""
        scale = self.drift.zero
        said = [
            quantity(scale * one, unit) if scale else drift_text(one)
            for one in (self.drift.size, *self.interval)
        ]
        what = "The zero of the sensor of friction" if scale else "Friction"
        if self.instead is not None:
            what = "Friction, or the zero of its sensor,"
        low, high = self.interval
        return ModelError(
            kind="drift",
            finding=(
                f"{what} drifts by {said[0]} from the first row of the table to the last (95 %"
                f" interval {said[1]} to {said[2]}), which is taken out."
            ),
            consequence=(
                "Values are those of the first row. Find the cause, such as warming or wear, and"
                " measure in a steady state."
            ),
            effect=(scale or 1.0) * self.drift.size,
            interval=((scale or 1.0) * low, (scale or 1.0) * high),
            share=0.0,
            moved=(),
        )


def drifting(
    candidate: RecordCandidate, measurement: Measurement, *, zero: bool = False
) -> Drifting | None:
    """Fit a law with a drift beside it, of friction or of the zero of its sensor.

    None where there is none, or a larger one than is likely. The drift is found by least squares
    with the law, which follows the readings without it in turn.
    """
    fit = candidate.fit
    if fit is None or candidate.validation is None:
        return None
    problem, best = fit.problem, fit.optimum.best
    whole = along(len(np.asarray(measurement.velocity)))
    if len(best.residual) != len(whole):
        return None
    size = float(np.mean(np.abs(problem.measured - fit.offset))) if zero else 0.0
    stated = measurement.offset.get("friction", 0.0)
    drift = Drift(size=0.0, constant=stated + fit.offset, zero=size)
    for _ in range(ROUNDS):
        beside = _constant(problem, best.values)
        friction = problem.measured - best.residual - beside
        own = size * whole if zero else friction * whole / (1.0 + drift.size * whole)
        columns = np.column_stack([best.slopes, own])
        columns = columns / np.maximum(np.linalg.norm(columns, axis=0), LEAST)
        found, *_ = np.linalg.lstsq(columns, best.residual, rcond=CUTOFF)
        step = float(found[-1]) / max(float(np.linalg.norm(own)), LEAST)
        drift = replace(drift, size=drift.size + step, constant=stated + beside)
        if not abs(drift.size) <= LIKELY:
            return None
        if abs(step) < SETTLED:
            return _judged(candidate, columns, best, drift, float(np.linalg.norm(own)))
        problem = fit.build(drift.without(measurement), None)
        best, _ = improve(problem, best.values)
    return None


def _constant(problem: RecordProblem, values: Array) -> float:
    """Return the constant force beside friction [N]: it would scale with a drift of friction."""
    pairs = zip(problem.free_parameters.paths, values.tolist(), strict=True)
    found = (value for path, value in pairs if path.endswith("offset"))
    return float(next(found, problem.held_offset or 0.0))


def _judged(
    candidate: RecordCandidate, columns: Array, best: ResidualJacobian, drift: Drift, size: float
) -> Drifting:
    """Return a law with its drift, predicted block by block from the others, to first order."""
    u, s, v = np.linalg.svd(columns, full_matrices=False)
    told = s > CUTOFF * s[0]
    u, s, v = u[:, told], s[told], v[told]
    left, others = best.residual - u @ (u.T @ best.residual), np.eye(len(u)) - u @ u.T
    losses = []
    for block in np.unique(best.segment):
        rows = np.flatnonzero(best.segment == block)
        tells = others[np.ix_(rows, rows)] + DECIDES * np.eye(len(rows))
        losses.append(float(np.mean(np.linalg.solve(tells, left[rows]) ** 2)))
    freedom = max(len(left) - len(s), 1)
    spread = math.sqrt(float(left @ left) / freedom * float(np.sum((v[:, -1] / s) ** 2)))
    validation = CrossValidation(losses=tuple(losses), extrapolation=math.nan)
    return Drifting(
        candidate=replace(candidate, validation=validation),
        drift=drift,
        error=spread / max(size, LEAST),
        freedom=freedom,
    )


def drift_of(
    closest: RecordCandidate, candidates: Sequence[RecordCandidate], measurement: Measurement
) -> Drifting | None:
    """Return the drift to take out of a table: where the order of its rows tells it from speed.

    It has to be more than chance, and the law with it to predict held-out rows better than what is
    named without one, and than a smooth curve over the speed: else a shape that no candidate has
    would count as a drift. Where such a curve is better without the drift, the law is wrong, and so
    may be what drifts beside it.
    """
    readings = Readings.of(closest)
    if readings is None or speeds_in_order(np.asarray(measurement.velocity, dtype=float)):
        return None
    beside = [drifting(c, measurement, zero=zero) for c in candidates for zero in (False, True)]
    found = [
        one
        for one in beside
        if one is not None and one.sure and errs_more(closest, one.candidate, errors=NEAR)
    ]
    if not found:
        return None
    best = min(found, key=lambda one: one.candidate.score)

    def curve(table: Measurement) -> RecordCandidate:
        smooth = smooth_curve(replace(readings, friction=np.asarray(table.values("friction"))))
        return replace(closest, validation=smooth)

    with_drift, without = curve(measurement), curve(best.drift.without(measurement))
    if not errs_more(with_drift, best.candidate, errors=NEAR):
        return None
    if errs_more(best.candidate, without, errors=NEAR):
        return None
    first, *others = [
        one
        for one in found
        if one.candidate.name == best.candidate.name
        and (one is best or not errs_more(one.candidate, best.candidate))
    ]
    return replace(first, instead=others[0]) if others else first


def reaching(fit: RecordFit, possible: Sequence[Measurement]) -> RecordFit:
    """Return a fit whose intervals reach as far as its estimates move with other tables."""
    if not possible:
        return fit
    moved = [improve(fit.build(one, None), fit.values)[0].values - fit.values for one in possible]
    ends = zip(np.min(moved, axis=0).tolist(), np.max(moved, axis=0).tolist(), strict=True)
    estimates = [
        replace(
            one,
            low=max(one.low + min(down, 0.0), min(one.low, one.quantity.low)),
            high=one.high + max(up, 0.0),
            pieces=(),
        )
        for one, (down, up) in zip(fit.estimates, ends, strict=True)
    ]
    return replace(fit, estimates=tuple(estimates))


def drifting_instead(
    closest: RecordCandidate, candidates: Sequence[RecordCandidate], measurement: Measurement
) -> dict[str, str]:
    """Return the laws that explain a table as well as the closest if friction drifts, by name.

    That is with fewer parameters, the drift among them no more, or better; the closest itself
    where its drift is more than chance.
    """
    found = {}
    for c in candidates:
        one = drifting(c, measurement)
        if one is None or errs_more(one.candidate, closest):
            continue
        if c.name == closest.name and not one.sure:
            continue
        if c.parameters < closest.parameters or errs_more(closest, one.candidate, errors=NEAR):
            found[c.name] = one.title
    return found
