"""The balance of forces along a record, through one filter, and its residuals made white."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.friction import FrictionLaw
from stickslip.identification.estimation.parameters import FreeParameters
from stickslip.identification.force_map.data import MotionSegment
from stickslip.identification.force_map.force_balance import balanced
from stickslip.identification.force_map.model import ForceMap
from stickslip.identification.force_map.problem import MECHANISM, SENSOR
from stickslip.identification.residuals.effects import Effect, Signals
from stickslip.identification.residuals.gains import beside
from stickslip.identification.results import Estimate
from stickslip.identification.series.inverse_dynamics import mass_of, positions_of
from stickslip.identification.settings import Hold
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters, vary

Array = NDArray[np.float64]

SAMPLES = 4_000
"""Samples of a record, unless its filter asks for more."""
TURNING = 2
"""Samples at rest that are no more than a reversal."""
OVERSAMPLED = (0.25, 0.5)
"""Most that the filter passes over half the frequency of the rows: where residuals are made white,
rows that hardly differ would say nothing."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Fitted:
    """A finished fit, as far as its residuals are asked."""

    mechanism: Mechanism
    """With the fitted values."""
    law: FrictionLaw
    """The same."""
    measurement: Measurement
    """Records that were fitted."""
    free_parameters: FreeParameters
    """What was fitted."""
    estimates: Sequence[Estimate]
    """Their values and intervals, in the same order."""
    hold: Hold
    """Whether a force keeps its value until the next sample."""
    measured: ForceMap | None = None
    """Friction that was measured; None where it is derived."""

    @property
    def values(self) -> dict[str, float]:
        """All numbers of law and mechanism, and what else was fitted, by path."""
        return {
            **_numbers(self.law, "friction"),
            **_numbers(self.mechanism, "mechanism"),
            **{estimate.path: estimate.value for estimate in self.estimates},
        }


@dataclass(frozen=True, kw_only=True, eq=False)
class Balance:
    """The balance of forces along a record, through one filter.

    Its rows (m,) are those samples where slip is sure and rows enough come before, made white.
    """

    residual: Array
    """Force less inertia, springs, friction and offset, made white (m,)."""
    slopes: Array
    """Derivatives of the predicted force by what was fitted, made white (m, p)."""
    friction: float
    """Root mean square of friction and offset by the law [N]."""
    passed: float
    """Highest frequency that the filter passes [Hz]."""
    signals: Signals
    """Motion and force from which columns of errors are made."""
    stretches: tuple[MotionSegment, ...]
    """Measured motion and friction, between gaps."""
    picked: NDArray[np.intp]
    """Which samples are looked at."""
    rows: NDArray[np.intp]
    """Which of these are rows (m,)."""
    memory: Array
    """Coefficients of the autoregression (order,)."""

    def seen(self, effects: Sequence[Effect]) -> list[Array]:
        """Return the columns of effects in the picked samples, filtered as residuals are."""
        columns = [np.stack(one.columns(self.signals), axis=1) for one in effects]
        raw = [k for k, one in enumerate(effects) if not one.filtered]
        if raw:
            # all at once: designing a filter takes longer than applying it
            table = np.concatenate([columns[k] for k in raw], axis=1)
            spans = itertools.pairwise(self.signals.edges)
            table = np.concatenate(
                [one.seen(table[a:b]) for one, (a, b) in zip(self.stretches, spans, strict=True)]
            )
            ends = np.cumsum([columns[k].shape[1] for k in raw])
            for k, part in zip(raw, np.split(table, ends[:-1], axis=1), strict=True):
                columns[k] = part
        return [column[self.picked] for column in columns]

    def white(self, columns: Array) -> Array:
        """Return the rows (m, q) of picked samples, less what those before say of them."""
        return whitened(columns, self.rows, self.memory)


def whitened(columns: Array, rows: NDArray[np.intp], memory: Array) -> Array:
    """Return rows (m, ...) less what an autoregression (order,) says of them from rows before.

    Examples
    --------
    >>> whitened(np.array([1.0, 0.5, 0.25, 1.0]), np.array([1, 2, 3]), np.array([0.5]))
    array([0.   , 0.   , 0.875])
    """
    found = columns[rows].copy()
    for k, coefficient in enumerate(memory.tolist(), 1):
        found -= coefficient * columns[rows - k]
    return np.asarray(found)


def balance_of(fit: Fitted, wider: float, order: int) -> Balance:
    """Return the balance of forces of a fit."""
    if fit.measured is not None:
        return _measured(fit, fit.measured, order)
    mechanism, measurement = fit.mechanism, fit.measurement
    stretched = partial(
        balanced,
        measurement=measurement,
        hold=fit.hold,
        samples=SAMPLES,
        slipping=True,
        wider=wider,
    )
    stretches = stretched(mechanism)
    residual, slopes = _linearised(fit, stretches)
    for i, path in enumerate(fit.free_parameters.paths):
        if path.startswith("mechanism.") and path != MECHANISM:
            value = fit.values[path]
            step = 1e-4 * max(abs(value), 1e-6)
            moved = stretched(vary(mechanism, "mechanism", {path: value + step}))
            slopes[:, i] = (_kept(stretches) - _kept(moved)) / step
    widest = max(one.passed for one in stretches)
    every = max(1, int(OVERSAMPLED[bool(order)] / widest))
    kept = np.flatnonzero(np.concatenate([one.rows_of(None) for one in stretches]))
    return _of_rows(
        stretches,
        residual=residual,
        slopes=slopes,
        friction=float(np.sqrt(np.mean((_kept(stretches) - residual) ** 2))),
        kept=(kept, kept % every == 0),
        every=every,
        order=order,
        passed=0.5 * widest / float(np.mean(np.diff(stretches[0].path.time))),
        signals=_signals([_part(one, measurement, mechanism) for one in stretches]),
    )


def _measured(fit: Fitted, problem: ForceMap, order: int) -> Balance:
    """Return what a law leaves of friction that was measured in time.

    Nothing was filtered. Rows at rest are left out of laws without memory, which may have any
    friction there.
    """
    stretches = problem.stretches
    if not all(one.timed for one in stretches):
        raise InputError("a table has no order in time.")
    seen = problem.linearise(np.array([fit.values[path] for path in problem.free_parameters.paths]))
    rows = np.concatenate([one.rows_of(None) for one in stretches])
    resting = np.concatenate([_resting(one) for one in stretches])
    slips = rows if fit.law.states else rows & ~resting
    predicted = np.concatenate([one.friction for one in stretches])
    if not (rows.all() and len(seen.residual) == len(predicted)):
        raise InputError("not all rows are compared.")
    predicted = predicted - seen.residual
    steps = float(np.median(np.concatenate([np.diff(one.path.time) for one in stretches])))
    parts = [_part_of_map(one, fit.measurement) for one in stretches]
    return _of_rows(
        stretches,
        residual=seen.residual,
        slopes=seen.slopes,
        friction=float(np.sqrt(np.mean(predicted**2))),
        kept=(np.arange(len(rows)), slips),
        every=1,
        order=order,
        passed=0.5 / steps,
        signals=replace(_signals(parts), force=_through_reversals(predicted, resting)),
    )


def _through_reversals(predicted: Array, resting: NDArray[np.bool_]) -> Array:
    """Return predictions (n,) that go straight through reversals: rests of a sample or two.

    What a law without memory has there is the measurement, late as that may be.
    """
    edges = np.flatnonzero(np.diff(resting, prepend=False, append=False)).reshape(-1, 2)
    alone = np.zeros(len(resting), dtype=bool)
    for first, end in edges[edges[:, 1] - edges[:, 0] <= TURNING].tolist():
        alone[first:end] = True
    at = np.arange(len(predicted))
    return np.where(alone, np.interp(at, at[~alone], predicted[~alone]), predicted)


def _of_rows(
    stretches: tuple[MotionSegment, ...],
    *,
    residual: Array,
    slopes: Array,
    friction: float,
    kept: tuple[NDArray[np.intp], NDArray[np.bool_]],
    every: int,
    order: int,
    passed: float,
    signals: Signals,
) -> Balance:
    """Return the balance of samples that have rows, of which some are looked at."""
    picked, chosen = kept[0][kept[1]], kept[1]
    rows = with_rows_before(picked, signals.edges, every, order)
    residual, slopes = residual[chosen], slopes[chosen]
    if not (np.isfinite(residual).all() and np.isfinite(slopes).all()):
        raise InputError("the law does not predict friction over the whole motion.")
    memory = autoregression(beside(residual, slopes), rows, order)
    return Balance(
        residual=whitened(residual, rows, memory),
        slopes=whitened(slopes, rows, memory),
        friction=friction,
        passed=passed,
        signals=signals,
        stretches=stretches,
        picked=picked,
        rows=rows,
        memory=memory,
    )


def _linearised(fit: Fitted, stretches: tuple[MotionSegment, ...]) -> tuple[Array, Array]:
    """Return residuals (n,) [N] and slopes (n, p) by what stands in the law or beside it."""
    values, paths = fit.values, fit.free_parameters.paths
    constant = SENSOR if SENSOR in paths else MECHANISM
    along = [i for i, p in enumerate(paths) if p.startswith("friction.") or p == constant]
    own = FreeParameters(tuple(fit.free_parameters.items[i] for i in along), values)
    problem = ForceMap(
        law=fit.law,
        free_parameters_=own,
        stretches=stretches,
        constant=constant,
        offset=values.get(constant, 0.0),
        mass=mass_of(fit.mechanism),
    )
    seen = problem.linearise(np.array([values[path] for path in own.paths]))
    slopes = np.zeros((len(seen.residual), len(paths)))
    slopes[:, along] = seen.slopes
    return seen.residual, slopes


def _numbers(model: Mechanism | FrictionLaw, room: str) -> dict[str, float]:
    return {path: float(value) for path, _, value in parameters(model, room)}


def _kept(stretches: Sequence[MotionSegment]) -> Array:
    return np.concatenate([one.friction[one.rows_of(None)] for one in stretches])


def with_rows_before(
    picked: NDArray[np.intp], edges: Sequence[int], every: int, order: int
) -> NDArray[np.intp]:
    """Return which picked samples have `order` picked ones right before them in their stretch."""
    stretch = np.searchsorted(edges, picked, side="right")
    near = (np.diff(picked, prepend=-every - 1) == every) & (np.diff(stretch, prepend=-1) == 0)
    run = np.arange(len(picked)) - np.maximum.accumulate(np.where(near, 0, np.arange(len(picked))))
    return np.flatnonzero(run >= order)


def autoregression(residual: Array, rows: NDArray[np.intp], order: int) -> Array:
    """Return the coefficients (order,) that predict rows from those before them."""
    if not order or not len(rows):
        return np.zeros(order)
    past = np.stack([residual[rows - k] for k in range(1, order + 1)], axis=1)
    return np.asarray(np.linalg.lstsq(past, residual[rows], rcond=1e-8)[0])


def _signals(parts: Sequence[dict[str, Array]]) -> Signals:
    """Return the signals of stretches end to end."""
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    edges = (0, *itertools.accumulate(len(part["time"]) for part in parts))
    return Signals(edges=edges, acceleration=columns.pop("acceleration", None), **columns)


def _resting(one: MotionSegment) -> NDArray[np.bool_]:
    """Return at which samples (n,) the sensor resolves no motion."""
    known = one.resting is not None
    return np.asarray(one.resting) if known else np.zeros(len(one.path.time), dtype=bool)


def _part(one: MotionSegment, measurement: Measurement, mechanism: Mechanism) -> dict[str, Array]:
    """Return the signals of a stretch of derived friction."""
    assert one.regressors is not None
    acceleration = one.regressors[:, 0]
    own = _part_of_map(one, measurement)
    force = one.friction + mass_of(mechanism) * acceleration
    return {**own, "force": force, "acceleration": acceleration}


def _part_of_map(one: MotionSegment, measurement: Measurement) -> dict[str, Array]:
    """Return the signals of a stretch; the force is that of friction."""
    record = measurement.records()[one.record]
    t, v = one.path.time, one.path.velocity
    way = np.concatenate([[0.0], np.cumsum(np.abs(one.path.travel))])
    turned = np.concatenate([[0], np.flatnonzero(np.diff(np.sign(v)) != 0) + 1])
    last = turned[np.searchsorted(turned, np.arange(len(t)), side="right") - 1]
    return {
        "time": t - float(np.asarray(record.time)[0]),
        "position": np.interp(t, np.asarray(record.time), positions_of(record)),
        "velocity": v,
        "level": np.sign(v) * one.path.load,
        "since": way - way[last],
        "force": one.friction,
    }
