"""A level that drifts while a table is measured: laws with it beside the law that is named."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Final, final

import numpy as np
import scipy.stats
from numpy.typing import NDArray

from stickslip.experiments import Measurement, speeds_in_order
from stickslip.identification import ModelError, ResidualJacobian, improve
from stickslip.kinds.records.verdict import RecordCandidate
from stickslip.selection import (
    LEAST,
    LIKELY,
    NEAR,
    CrossValidation,
    along,
    drift_text,
    errs_more,
    if_drifting,
)

Array = NDArray[np.float64]

ROUNDS: Final = 8
"""Times that a law is fitted again to friction without its drift, at most."""
SETTLED: Final = 1e-3
"""Change of a drift below which it is found."""
CHANCE: Final = 1e-3
"""Chance of a drift as large by the scatter of the readings from which it is taken out."""
CUTOFF: Final = 1e-8
"""Singular values over the largest one below which columns have no effect."""
DECIDES: Final = 1e-9
"""Stands for the share of a reading that others tell where it decides alone."""


@final
@dataclass(frozen=True, kw_only=True)
class Drifting:
    """A law whose friction drifts evenly from the first row of a table to the last."""

    candidate: RecordCandidate
    """The law, with the held-out errors that it has beside a drift."""
    drift: float
    """Share by which friction changes."""
    error: float
    """Its standard error."""
    freedom: int
    """Readings less parameters."""

    @property
    def title(self) -> str:
        """The law, and the drift with which it explains the table."""
        return if_drifting(self.candidate.title, self.drift, "row")

    @property
    def sure(self) -> bool:
        """Whether the drift is more than the scatter of the readings makes by chance."""
        times = abs(self.drift) / max(self.error, LEAST)
        return bool(2.0 * scipy.stats.t.sf(times, self.freedom) < CHANCE)

    def without(self, measurement: Measurement) -> Measurement:
        """Return a table without the drift, at the level of its first row."""
        return _without(measurement, self.drift)

    @property
    def finding(self) -> ModelError:
        """Return that a drift was taken out."""
        half = float(scipy.stats.t.ppf(0.975, self.freedom)) * self.error
        low, high = self.drift - half, self.drift + half
        return ModelError(
            kind="drift",
            finding=(
                f"Friction drifts by {drift_text(self.drift)} from the first row of the table to"
                f" the last (95 % interval {drift_text(low)} to {drift_text(high)}), which is taken"
                " out."
            ),
            consequence=(
                "Values are those of the first row. Find the cause, such as warming or wear, and"
                " measure in a steady state."
            ),
            effect=self.drift,
            interval=(low, high),
            share=0.0,
            moved=(),
        )


def _without(measurement: Measurement, drift: float) -> Measurement:
    friction = np.asarray(measurement.friction, dtype=float)
    return replace(measurement, friction=friction / (1.0 + drift * along(len(friction))))


def drifting(candidate: RecordCandidate, measurement: Measurement) -> Drifting | None:
    """Fit a law with a drift beside it; None where there is none, or a larger one than is likely.

    The drift is found by least squares with the law, which follows friction without it in turn.
    """
    fit = candidate.fit
    if fit is None or candidate.validation is None:
        return None
    problem, best, drift = fit.problem, fit.optimum.best, 0.0
    whole = along(len(np.asarray(measurement.velocity)))
    if len(best.residual) != len(whole):
        return None
    for _ in range(ROUNDS):
        own = (problem.measured - best.residual) * whole / (1.0 + drift * whole)
        columns = np.column_stack([best.slopes, own])
        columns = columns / np.maximum(np.linalg.norm(columns, axis=0), LEAST)
        found, *_ = np.linalg.lstsq(columns, best.residual, rcond=CUTOFF)
        step = float(found[-1]) / max(float(np.linalg.norm(own)), LEAST)
        drift += step
        if not abs(drift) <= LIKELY:
            return None
        if abs(step) < SETTLED:
            return _judged(candidate, columns, best, drift, float(np.linalg.norm(own)))
        problem = fit.build(_without(measurement, drift), None)
        best, _ = improve(problem, best.values)
    return None


def _judged(
    candidate: RecordCandidate, columns: Array, best: ResidualJacobian, drift: float, size: float
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
    named without one.
    """
    if speeds_in_order(np.asarray(measurement.velocity, dtype=float)):
        return None
    found = [one for c in candidates if (one := drifting(c, measurement))]
    best = min(found, key=lambda one: one.candidate.score, default=None)
    if best is None or not best.sure or not errs_more(closest, best.candidate, errors=NEAR):
        return None
    return best


def drifting_instead(
    closest: RecordCandidate, candidates: Sequence[RecordCandidate], measurement: Measurement
) -> dict[str, str]:
    """Return the laws that explain a table as well as the closest if friction drifts, by name.

    That is with fewer parameters, the drift among them no more, or better.
    """
    found = {}
    for c in candidates:
        one = None if c.name == closest.name else drifting(c, measurement)
        if one is None or errs_more(one.candidate, closest):
            continue
        if c.parameters < closest.parameters or errs_more(closest, one.candidate, errors=NEAR):
            found[c.name] = one.title
    return found
