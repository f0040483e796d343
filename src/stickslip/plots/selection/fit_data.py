"""The numbers behind the figures: what was measured, and what the fits leave of it."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Final, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.formatting import scale_of
from stickslip.identification import RecordFit, inverse_dynamics, load_of
from stickslip.plots.core.helpers import LINE_POINTS, thinned
from stickslip.plots.selection.residuals import ErrorSeries, ResidualPanel
from stickslip.selection import CrossValidated

Array: TypeAlias = NDArray[np.float64]

MOST_POINTS: Final = 2400
SEED: Final = 0
BINS: Final = 16
DOTS: Final = 1000
"""Residuals drawn in each panel at most."""
FEWEST: Final = 10
"""Rows of a bin from which its mean is shown."""
STEADY: Final = 0.05
"""Changes of speed below this share of what is rarely exceeded count as none."""


class MapPoints(NamedTuple):
    """Friction against velocity as measured."""

    velocity: Array
    """Slip velocities (n,) [m/s]."""
    friction: Array
    """Friction forces (n,) [N]."""
    load: float
    """Normal force [N]; its median where it varies."""
    load_varies: bool
    """Whether the normal force varies by more than 5 %."""
    measured: bool
    """Whether friction was measured; if not, it is from inverse dynamics."""
    trend: Array
    """1 where the speed rises, -1 where it falls, 0 where it does neither or nobody knows."""
    beside: Mapping[str, Array] = MappingProxyType({})
    """What else friction may depend on (n,), by the name of the contact input [SI]."""


class Rows(NamedTuple):
    """Residuals of a fit with the motion that they belong to; None where it is not known."""

    t: Array | None
    """Times (n,) [s]; records follow one another."""
    velocity: Array | None
    """Velocities (n,) [m/s]."""
    position: Array | None
    """Positions (n,) [m]."""
    residual: Array
    """Residuals (n,) [SI]."""


def sampled(count: int, most: int = MOST_POINTS) -> NDArray[np.intp]:
    """Return which of so many points are drawn: all, or a random sample with a fixed seed.

    Every so manieth point of a periodic record would hide the cloud.

    Examples
    --------
    >>> len(sampled(10_000)), sampled(3).tolist()
    (2400, [0, 1, 2])
    """
    if count <= most:
        return np.arange(count)
    return np.sort(np.random.default_rng(SEED).choice(count, most, replace=False))


def is_timed(fit: RecordFit) -> bool:
    """Whether the rows of a fit follow each other in time; those of a table do not."""
    return all(record.time is not None for record in fit.measurement.records())


def map_points(fit: RecordFit) -> MapPoints | None:
    """Return friction against velocity, measured or by inverse dynamics; None if neither can be."""
    if stretches := fit.problem.samples:
        load = np.concatenate([one.load for one in stretches])
        middle = float(np.median(load))
        return MapPoints(
            velocity=np.concatenate([one.velocity for one in stretches]),
            friction=np.concatenate([one.friction for one in stretches]),
            load=middle,
            load_varies=bool(np.ptp(np.percentile(load, [5.0, 95.0])) > 0.05 * middle),
            measured=fit.friction_was_measured,
            trend=np.concatenate(
                [
                    np.zeros(len(one.friction))
                    if one.time is None
                    else trend_of(one.time, one.velocity)
                    for one in stretches
                ]
            ),
            beside={
                name: np.concatenate([one.beside[name] for one in stretches])
                for name in stretches[0].beside
                if all(name in one.beside for one in stretches)
            },
        )
    try:
        found = inverse_dynamics(fit.mechanism, fit.measurement, vary=())
        load_now = load_of(fit.mechanism)
    except InputError:  # too short, without a position, or of several coordinates
        return None
    return MapPoints(
        found.velocity,
        found.friction,
        load_now,
        load_varies=False,
        measured=False,
        trend=trend_of(found.time, found.velocity),
    )


def trend_of(t: Array, velocity: Array) -> Array:
    """Return 1 where the speed rises, -1 where it falls, 0 where it hardly does either.

    Examples
    --------
    >>> trend_of(np.arange(5.0), np.array([-3.0, -2.0, -1.0, 0.0, 1.0])).tolist()
    [-1.0, -1.0, -1.0, 0.0, 1.0]
    """
    rate = np.zeros(len(t))
    forward = np.flatnonzero(np.diff(t, prepend=-np.inf) <= 0.0)  # several records, end to end
    for own in np.split(np.arange(len(t)), forward):
        if len(own) > 1:
            rate[own] = np.gradient(np.abs(velocity[own]), t[own])
    least = STEADY * float(np.percentile(np.abs(rate), 95.0)) if len(rate) else 0.0
    return np.sign(rate) * (np.abs(rate) > least)


def speeds_of(fit: RecordFit, record: Measurement) -> tuple[Array, Array] | None:
    """Return times and velocities of one record, measured or by differences."""
    if record.time is None:
        return None
    if "velocity" in record.quantities():
        return record.time, np.asarray(record.values("velocity"), dtype=float)
    if "position" not in record.quantities():
        return None
    try:
        found = inverse_dynamics(fit.mechanism, record, vary=())
    except InputError:  # too short to be filtered
        position = np.asarray(record.values("position"), dtype=float)
        return record.time, np.gradient(position, record.time)
    return found.time, found.velocity


def rows_of(fit: RecordFit) -> Rows:
    """Return the residuals of a fit with times, velocities and positions."""
    problem, seen = fit.problem, fit.optimum.best
    if not is_timed(fit):
        velocity = np.concatenate([one.velocity for one in problem.samples])
        return Rows(None, velocity, None, seen.residual)
    record = problem.spans[seen.segment, 0].astype(int)
    t, shift = problem.times, _shifts(problem.spans)
    columns: dict[str, Array | None] = {"velocity": np.zeros(len(t)), "position": np.zeros(len(t))}
    for number, one in enumerate(fit.measurement.records()):
        own = record == number
        motion: dict[str, tuple[Array, Array] | None] = {"velocity": speeds_of(fit, one)}
        known = "position" in one.quantities() and one.time is not None
        motion["position"] = (one.time, np.asarray(one.values("position"))) if known else None  # type: ignore[assignment]
        for name, pair in motion.items():
            column = columns[name]
            if pair is None or column is None:
                columns[name] = None
            else:
                column[own] = np.interp(t[own], *pair)
    placed = t + np.array([shift[number] for number in record])
    return Rows(placed, columns["velocity"], columns["position"], seen.residual)


def _shifts(spans: Array) -> dict[int, float]:
    """Return what times of each record are shifted by, so that several lie end to end."""
    order = np.unique(spans[:, 0]).astype(int).tolist()
    if len(order) == 1:
        return {order[0]: 0.0}
    found, at = {}, 0.0
    for record in order:
        own = spans[spans[:, 0] == record]
        found[record] = at - float(own[:, 1].min())
        at += float(own[:, 2].max() - own[:, 1].min())
    return found


def errors_of(
    candidate: CrossValidated[RecordFit], horizon: float, factor: float
) -> ErrorSeries | None:
    """Return errors of predictions over a horizon [s], over time and by held-out block."""
    if candidate.fit is None or candidate.validation is None:
        return None
    seen = candidate.fit.predict(horizon=horizon)
    problem = candidate.fit.problem
    shift = _shifts(problem.spans)
    placed = seen.t + np.array([shift[int(record)] for record in seen.record])
    share = max(LINE_POINTS // max(len(np.unique(seen.segment)), 1), 12)
    times: list[Array] = []
    errors: list[Array] = []
    for number in np.unique(seen.segment):
        own = seen.segment == number
        t, y = thinned(placed[own], factor * seen.residual[own], share)
        times += [t, t[-1:]]  # a gap in the line: each segment starts from a state of its own
        errors += [y, np.array([np.nan])]
    return ErrorSeries(
        np.concatenate(times),
        np.concatenate(errors),
        factor * np.sqrt(np.array(candidate.validation.losses)),
    )


def panel_of(
    label: str, x: Array, residual: Array, effective: float, shown: Sequence[int] | NDArray[np.intp]
) -> ResidualPanel:
    """Return residuals against a quantity, with means of bins and twice their standard errors.

    Neighbours are alike: a bin counts as many independent rows as its share of those of all.
    """
    edges = np.linspace(float(x.min()), float(x.max()), BINS + 1)
    place = np.clip(np.digitize(x, edges) - 1, 0, BINS - 1)
    centre, mean, doubt = [], [], []
    for number in range(BINS):
        own = residual[place == number]
        if len(own) < FEWEST:
            continue
        independent = max(len(own) * min(effective / len(residual), 1.0), 1.0)
        centre.append(0.5 * (edges[number] + edges[number + 1]))
        mean.append(float(own.mean()))
        doubt.append(2.0 * float(own.std()) / independent**0.5)
    return ResidualPanel(
        label, x[shown], residual[shown], np.array(centre), np.array(mean), np.array(doubt)
    )


def residual_panels(fit: RecordFit, factor: float) -> dict[str, ResidualPanel]:
    """Return residuals, times a factor, against time, velocity and position, where known."""
    rows = rows_of(fit)
    residual = factor * rows.residual
    shown = sampled(len(residual), DOTS)
    found = {}
    against = {"time": rows.t, "velocity": rows.velocity, "position": rows.position}
    for name, x in against.items():
        if x is None or np.ptp(x) == 0.0:
            continue
        by, unit = scale_of(x, "s" if name == "time" else fit.measurement.unit(name))
        panel = panel_of(f"{name}, {unit}", by * x, residual, fit.inference.effective, shown)
        if len(panel.centre):
            found[name] = panel
    return found
