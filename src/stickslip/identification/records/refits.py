"""Fits made again without a stretch of their record."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, InputError, SimulationError
from stickslip.experiments import Measurement, rows_of
from stickslip.identification.estimation.estimates import bounds_met
from stickslip.identification.estimation.halves import Halves, blocks_of_half
from stickslip.identification.estimation.jackknife import Displaced, infer
from stickslip.identification.estimation.levenberg_marquardt import FIRST_DAMPING, improve, step_of
from stickslip.identification.estimation.problem import Problem, ResidualJacobian, SubsetProblem
from stickslip.identification.records.fit import RecordFit, scale_of
from stickslip.identification.series.applied_force import driven

Array = NDArray[np.float64]

FEWEST = 30
"""Rows beside a held-out block from which they are worth a segment of their own."""
ROUNDS = 8
"""Steps at most from the estimates of the whole record to those without a block."""
FLAT = 1e-3
"""They end when a step, but the first, promises to lower the cost by less than this share."""
LINEAR = 0.01
"""Share of the squares of all residuals, those left out included, up to which what a step does to
them is taken as linear: what that leaves out is of second order."""


def refitted(fit: RecordFit, first: float, last: float) -> ResidualJacobian | None:
    """Return a fit made again without a stretch of its record, from the estimates of the whole."""
    return (_refitted_decay if _decays(fit) else _refitted)(fit, first, last)


def _decays(fit: RecordFit) -> bool:
    return fit.problem.simulates and not driven(fit.measurement)


def halves_of(fit: RecordFit) -> Halves | None:
    """Return the estimates of either half of a record in time, fitted from those of the whole.

    Several trials are laid end to end, so that their halves are the first and the last trials. The
    standard error of their difference is that of two jackknives, with Welch's degrees of
    freedom.
    """
    end = float(positions_of(fit.problem)[-1, 1])
    try:
        parts = (refitted(fit, 0.5 * end, math.inf), refitted(fit, -math.inf, 0.5 * end))
    except (ConvergenceError, InputError, SimulationError):
        return None
    first, second = parts
    if first is None or second is None:
        return None
    known = [
        infer(
            one,
            scale_of(fit.free_parameters, one.values, bounds_met(fit.free_parameters, one.values)),
            blocks=blocks_of_half(one),
            displaced=_displaced_in(fit, one),
        )
        for one in (first, second)
    ]
    return Halves.of(
        (first.values, second.values),
        (known[0], known[1]),
        several=len(np.unique(fit.problem.spans[:, 0])) > 1,
    )


def _displaced_in(fit: RecordFit, half: ResidualJacobian) -> list[Displaced]:
    """Return what uncertainties of the mechanism make of a half.

    The halves of a free decay are cut anew: their rows are not those of the whole, and they are
    compared as if the mechanism were known.
    """
    if _decays(fit):
        return []
    rows = np.isin(fit.optimum.best.segment, half.segment)
    return [one.of(rows) for one in fit.displaced]


def positions_of(problem: Problem) -> Array:
    """Return first and last time of each segment (segments, 2), records laid end to end."""
    spans = problem.spans
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


def interleaved(spans: Array) -> bool:
    """Whether segments lie within each other, or are a row each: those of a table."""
    if np.all(spans[:, 1] == spans[:, 2]):
        return True
    same = spans[1:, 0] == spans[:-1, 0]
    return bool(np.any(same & (spans[1:, 1] < 0.5 * (spans[:-1, 1] + spans[:-1, 2]))))


def _refitted(fit: RecordFit, first: float, last: float) -> ResidualJacobian | None:
    """Return what fits the segments outside a stretch; None if no segment is outside."""
    placed = positions_of(fit.problem)
    seen = (placed[:, 1] <= first) | (placed[:, 0] >= last)
    if not seen.any():
        return None
    whole, chosen = fit.optimum.best, np.flatnonzero(seen)
    rows = np.isin(whole.segment, chosen)
    here = ResidualJacobian(
        values=fit.values,
        residual=whole.residual[rows],
        slopes=whole.slopes[rows],
        segment=whole.segment[rows],
        memory=whole.memory,
    )
    found = _stepped(fit, here, rows)
    if found is None:
        part = SubsetProblem(fit.problem, chosen.tolist(), whole)
        found, _ = improve(part, fit.values, near=here, rounds=ROUNDS, flat=FLAT)
    return found


def _stepped(
    fit: RecordFit, here: ResidualJacobian, rows: NDArray[np.bool_]
) -> ResidualJacobian | None:
    """Return the fit to some rows by one step from that to all; None if that is a long way.

    The prediction is taken as linear along the step, and not made again.
    """
    free, whole = fit.free_parameters, fit.optimum.best
    at, (low, high) = free.coordinates(here.values), free.limits()
    table = whole.slopes @ free.slopes(at)
    step, _ = step_of(table[rows], here.residual, at, low, high, FIRST_DAMPING)
    change = table @ step
    if not change @ change <= LINEAR * whole.cost:
        return None
    return ResidualJacobian(
        values=free.values(at + step),
        residual=here.residual - change[rows],
        slopes=here.slopes,
        segment=here.segment,
    )


def _refitted_decay(fit: RecordFit, first: float, last: float) -> ResidualJacobian | None:
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
    end, _ = improve(problem, fit.values, rounds=ROUNDS, flat=FLAT)
    return end


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
