"""A record of a spring slider as residuals of rate-and-state friction."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias, final

import numpy as np
from numpy.typing import NDArray
from typing_extensions import override

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.formatting import number, quantity
from stickslip.identification.estimation.parameters import FreeParameter, FreeParameters
from stickslip.identification.estimation.problem import Problem, ResidualJacobian
from stickslip.identification.rate_state.law import Evolution, RateState, logarithms
from stickslip.identification.series.load_point import Path, path_of
from stickslip.quantities import Quantity, fields_of

__all__ = ["DRIFT", "PATHS", "Record", "Slider", "record_of", "unknowns_for"]

Array: TypeAlias = NDArray[np.float64]

PATHS = (
    "friction.direct_effect",
    "friction.evolution_effect",
    "friction.critical_distance",
    "mechanism.stiffness",
    "friction.reference_coefficient",
)
DRIFT = "drift"
BLOCKS = 10
"""Stretches of equal time within which residuals may be correlated in any way."""
PLAIN = 4000
"""Up to so many samples are taken as they are, and means of longer records."""
EVEN, CLOSE = 1000, 300
"""Means over so many even stretches of time, and over so many that widen away from each step."""
COARSE = 500
"""Stretches of the pull over which the first guess of the stiffness is read."""
TOLERANCE = 1e-9
"""Six digits below the noise of any record."""
NUDGE = 1e-4
"""Step of difference quotients, relative; half the digits of the tolerance."""


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Record:
    """Times, friction coefficients and the path of the load point, from time 0 on."""

    time: Array
    """Times (n,) [s]."""
    coefficient: Array
    """Friction over load (n,)."""
    pull: Array
    """Position of the load point (n,) [m], as measured, from 0 on."""
    path: Path

    @property
    def speed(self) -> float:
        """First speed of the load point [m/s]."""
        return float(self.path.speeds[0])

    @property
    def after(self) -> float:
        """Way of the load point after its last change of speed [m]."""
        return float(np.diff(self.path.position)[-1])

    @property
    def slid(self) -> float:
        """Way of the load point after its first change of speed [m]."""
        return float(self.path.position[-1] - self.path.position[1])

    def within(self, before: float | None, after: float | None) -> "Record":
        """Return what lies within some way before the first step and some after the last [m]."""
        place = np.interp(self.time, self.path.time, self.path.position)
        low = -np.inf if before is None else self.path.position[1] - before
        high = np.inf if after is None else self.path.position[-2] + after
        kept = (place >= low) & (place <= high)
        time = self.time[kept]
        inner = (self.path.time > time[0]) & (self.path.time < time[-1])
        knots = np.array([time[0], *self.path.time[inner], time[-1]])
        position = np.interp(knots, self.path.time, self.path.position)
        return Record(
            time=time - time[0],
            coefficient=self.coefficient[kept],
            pull=self.pull[kept] - self.pull[kept][0],
            path=Path(time=knots - time[0], position=position - position[0]),
        )


def record_of(measurement: Measurement) -> Record:
    """Return the record of a measurement with friction, load and pull.

    Raises
    ------
    InputError
        If something is missing, or the load point never changes its speed.
    """
    for name in ("time", "friction", "pull"):
        if measurement.trials or getattr(measurement, name) is None:
            raise InputError(
                "a rate-and-state fit needs one record with time, friction and pull (the position"
                f" of the load point); {name} is missing. A coefficient is a friction at load 1."
            )
    assert measurement.time is not None
    load = 1.0 if measurement.load is None else measurement.values("load")
    if np.any(np.asarray(load) <= 0.0):
        raise InputError("a rate-and-state fit needs loads above 0 N throughout.")
    time = measurement.time - measurement.time[0]
    pull = np.asarray(measurement.values("pull"))
    pull = pull - pull[0]
    path = path_of(time, pull)
    if not len(path.steps):
        raise InputError(
            "a rate-and-state fit needs a step of the speed of the load point, and"
            f" Measurement.pull moves at {quantity(path.speeds[0], 'm/s')} throughout: a and b"
            " say how"
            " friction changes with speed."
        )
    if path.speeds[0] <= 0.0 or np.any(path.speeds < -0.01 * path.speeds.max()):
        raise InputError(
            "a rate-and-state fit needs a load point that moves forwards at first and never back,"
            f" got speeds from {number(path.speeds.min())} to {quantity(path.speeds.max(), 'm/s')}."
        )
    coefficient = np.asarray(measurement.values("friction")) / load
    return Record(time=time, coefficient=coefficient, pull=pull, path=path)


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Slider(Problem):
    """Means of the friction coefficient over short stretches of a record, weighted by samples."""

    record: Record
    evolution: Evolution
    unknowns_: FreeParameters
    mean_time: Array
    mean: Array
    weight: Array

    @staticmethod
    def of(record: Record, evolution: Evolution, unknowns: FreeParameters) -> "Slider":
        """Return the problem of a record; sums of squares differ by scatter within stretches."""
        bins = np.arange(len(record.time))
        if len(bins) > PLAIN:
            bins = np.searchsorted(_edges(record), record.time, side="right")
        _, which, count = np.unique(bins, return_inverse=True, return_counts=True)
        return Slider(
            record=record,
            evolution=evolution,
            unknowns_=unknowns,
            mean_time=np.bincount(which, record.time) / count,
            mean=np.bincount(which, record.coefficient) / count,
            weight=np.sqrt(count / count.mean()),
        )

    def with_unknowns(self, unknowns: FreeParameters) -> "Slider":
        """Return the same record with other unknowns, of the same paths."""
        return replace(self, unknowns_=unknowns)

    @property
    @override
    def unknowns(self) -> FreeParameters:
        return self.unknowns_

    @property
    @override
    def quantity(self) -> str:
        return "friction"

    @property
    @override
    def times(self) -> Array:
        return self.mean_time

    @property
    @override
    def spans(self) -> Array:
        edges = np.linspace(self.record.time[0], self.record.time[-1], BLOCKS + 1)
        return np.column_stack([np.zeros(BLOCKS), edges[:-1], edges[1:]])

    @property
    def blocks(self) -> NDArray[np.intp]:
        """Stretch that each row belongs to (n,)."""
        return np.searchsorted(self.spans[1:, 1], self.mean_time, side="right").astype(np.intp)

    def law(self, values: Array) -> RateState:
        """Return the law with values (p,) of the unknowns."""
        a, b, D_c, _, mu_0 = map(float, values[:5])
        return RateState(
            reference_coefficient=mu_0,
            direct_effect=a,
            evolution_effect=b,
            critical_distance=D_c,
            reference_velocity=self.record.speed,
            evolution=self.evolution,
        )

    def predict(self, values: Array, times: Array) -> Array | None:
        """Return friction coefficients at times (n,); None if the slider runs away."""
        law, path = self.law(values), self.record.path
        speeds = np.maximum(path.speeds, 0.0)
        logs = logarithms(law, float(values[3]), path.time, speeds, times, TOLERANCE)
        if logs is None:
            return None
        mu = law.reference_coefficient + logs @ values[:2]
        drift = values[5] if len(values) > 5 else 0.0
        return np.array(mu + drift * np.interp(times, path.time, path.position))

    @override
    def linearise(
        self,
        values: Array,
        near: ResidualJacobian | None = None,
        *,
        only: Sequence[int] | None = None,
        slopes: bool = True,
    ) -> ResidualJacobian:
        blocks = self.blocks
        rows = np.ones(len(blocks), dtype=bool) if only is None else np.isin(blocks, only)
        times, weight = self.mean_time[rows], self.weight[rows]
        base = self.predict(values, times)
        table = np.zeros((len(times), len(values)))
        if base is None:
            residual = np.full(len(times), np.inf)
            return ResidualJacobian(
                values=values, residual=residual, slopes=table, segment=blocks[rows]
            )
        if slopes:
            table = weight[:, None] * self._slopes(values, times, base)
        return ResidualJacobian(
            values=values,
            residual=weight * (self.mean[rows] - base),
            slopes=table,
            segment=blocks[rows],
        )

    def _slopes(self, values: Array, times: Array, base: Array) -> Array:
        """Return the derivatives of the prediction by the unknowns (n, p)."""
        table = np.ones((len(times), len(values)))  # the fifth is that of the level
        for i in range(4):
            step = NUDGE * (max(abs(values[1]), values[0]) if i == 1 else values[i])
            nudged = values.copy()
            nudged[i] += step
            there = self.predict(nudged, times)
            table[:, i] = 0.0 if there is None else (there - base) / step
        if len(values) > 5:
            table[:, 5] = np.interp(times, self.record.path.time, self.record.path.position)
        return table


def _edges(record: Record) -> Array:
    first, last = record.time[0], record.time[-1]
    edges = [np.linspace(first, last, EVEN + 1)]
    shortest = float(np.median(np.diff(record.time)))
    for step in record.path.steps:
        if last - step > 2.0 * shortest:
            edges.append(step + np.geomspace(shortest, last - step, CLOSE))
    return np.unique(np.concatenate([*edges, record.path.steps]))


def unknowns_for(
    record: Record, *, drift: bool, lowest_evolution_effect: float, stiffness: float | None
) -> FreeParameters:
    """Return what is looked for, with first guesses read off the record."""
    declared = fields_of(RateState)
    slid = record.slid
    rate, mu_0 = _levels(record)
    start_a = max(rate, 0.0) + 0.005
    k = _steepest(record) if stiffness is None else stiffness
    low_k, high_k = (1e-2 * k, 1e2 * k) if stiffness is None else (k, k)
    names = [path.rpartition(".")[2] for path in PATHS]
    numbers = [
        (declared[names[0]], start_a, 1e-6, 1.0, True),
        (declared[names[1]], start_a - rate, lowest_evolution_effect, 1.0, False),
        (declared[names[2]], 0.01 * slid, 1e-4 * slid, 10.0 * slid, True),
        (Quantity("k", "1/m", above=0), k, low_k, high_k, True),
        (declared[names[4]], mu_0, -np.inf, np.inf, False),
    ]
    items = [
        FreeParameter(path=path, quantity=quantity, start=start, low=low, high=high, log=log)
        for path, (quantity, start, low, high, log) in zip(PATHS, numbers, strict=True)
    ]
    if drift:
        items.append(FreeParameter(path=DRIFT, quantity=Quantity("eta", "1/m"), start=0.0))
    return FreeParameters(tuple(items))


def _levels(record: Record) -> tuple[float, float]:
    """Return a guess of a - b and of the level at first, from the last third of each piece."""
    knots, speeds = record.path.time, record.path.speeds
    found = []
    for start, end, speed in zip(knots[:-1], knots[1:], speeds, strict=True):
        late = (record.time > end - (end - start) / 3.0) & (record.time <= end)
        if speed > 1e-3 * record.speed and late.any():
            found.append((np.log(speed / record.speed), record.coefficient[late].mean()))
    logs, levels = np.array(found).T
    change = logs - logs.mean()
    rate = float(change @ levels / (change @ change)) if change.any() else 0.0
    return rate, float(levels[0])


def _steepest(record: Record) -> float:
    """Return a guess of the stiffness: friction rises by no more than that with the pull."""
    edges = np.linspace(record.pull.min(), record.pull.max(), COARSE)
    bins = np.searchsorted(edges, record.pull, side="right")
    count = np.bincount(bins)
    kept = count > 0
    total = (np.bincount(bins, values)[kept] for values in (record.coefficient, record.pull))
    mu, x = (sums / count[kept] for sums in total)
    way = 2.0 * np.ptp(record.pull) / COARSE
    rise = [
        abs(np.interp(place + way, x, mu) - np.interp(place, x, mu)) / way
        for place in np.interp(record.path.steps, record.path.time, record.path.position)
    ]
    return 2.0 * float(max(rise)) + 1e-3 / max(record.slid, 1e-12)
