"""A record of a spring slider as residuals of rate-and-state friction."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import InputError
from stickslip.friction import RateState, RateStateForm
from stickslip.identify import THRESHOLDS
from stickslip.identify.fits import (
    BLOCKS,
    FreeParameter,
    FreeParameters,
    Problem,
    ResidualJacobian,
)
from stickslip.identify.kinds.velocity_steps.load_point import STRETCHES, Path, path_of
from stickslip.identify.kinds.velocity_steps.slider import coefficients, logarithms
from stickslip.quantities import Quantity, fields_of
from stickslip.show.formatting import number, quantity

Array: TypeAlias = NDArray[np.float64]

PATHS = (
    "friction.direct_effect",
    "friction.evolution_effect",
    "friction.critical_distance",
    "mechanism.stiffness",
    "friction.reference_coefficient",
    "friction.stress_effect",
    "friction.second_evolution_effect",
    "friction.second_critical_distance",
)
DRIFT = "drift"
EFFECTS = ("direct_effect", "evolution_effect", "stress_effect", "second_evolution_effect")
DIRECT, EVOLVED, STRESS, SECOND = (PATHS.index(f"friction.{effect}") for effect in EFFECTS)
"""Places in `PATHS` of effects on friction; the distance of a state is next to its effect."""
PLAIN = 4000
"""Up to so many samples are taken as they are: means over time are poor where records with samples
at uneven times have most of these at steps."""
TOLERANCE = 1e-9
"""Six digits below the noise of any record."""
NUDGE = math.sqrt(TOLERANCE)
"""Step of difference quotients, relative."""


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
    """Path of the load point: pieces of constant speed, from time 0 and position 0 on."""
    begins: float = 0.0
    """Time 0 on the clock of the measurement [s]."""
    load: float = 1.0
    """Mean load [N]."""

    @property
    def speed(self) -> float:
        """First speed of the load point [m/s]."""
        return float(self.path.lasting[0])

    @property
    def after(self) -> float:
        """Way of the load point after its last change of speed [m]."""
        return float(self.path.position[-1] - self.path.places[-1])

    @property
    def slid(self) -> float:
        """Way of the load point after its first change of speed [m]."""
        return float(self.path.position[-1] - self.path.places[0])

    def within(self, before: float | None, after: float | None) -> "Record":
        """Return what lies within some way before the first step and some after the last."""
        place = np.interp(self.time, self.path.time, self.path.position)
        low = -np.inf if before is None else self.path.places[0] - before
        high = np.inf if after is None else self.path.places[-1] + after
        kept = (place >= low) & (place <= high)
        time = self.time[kept]
        inner = (self.path.time > time[0]) & (self.path.time < time[-1])
        knots = np.array([time[0], *self.path.time[inner], time[-1]])
        position = np.interp(knots, self.path.time, self.path.position)
        return replace(
            self,
            time=time - time[0],
            coefficient=self.coefficient[kept],
            pull=self.pull[kept] - self.pull[kept][0],
            path=Path(time=knots - time[0], position=position - position[0]),
            begins=self.begins + float(time[0]),
        )


def record_of(measurement: Measurement, load: float = 1.0) -> Record:
    """Return the record of a measurement with friction, load and pull."""
    if measurement.trials:
        raise InputError(
            f"a rate-and-state fit needs one record, got {len(measurement.trials)} trials: give one"
            " of them, and another to validate."
        )
    for name in ("time", "friction", "pull"):
        if getattr(measurement, name) is None:
            raise InputError(
                "a rate-and-state fit needs one record with time, friction and pull (the position"
                f" of the load point); {name} is missing. A coefficient is a friction at load 1."
            )
    assert measurement.time is not None
    loads = np.asarray(load if measurement.load is None else measurement.values("load"))
    if np.any(loads <= 0.0):
        raise InputError("a rate-and-state fit needs loads above 0 N throughout.")
    time = measurement.time - measurement.time[0]
    pull = np.asarray(measurement.values("pull"))
    pull = pull - pull[0]
    path = path_of(time, pull)
    if not len(path.steps):
        raise InputError(
            "a rate-and-state fit needs a step of the speed of the load point, and"
            f" Measurement.pull moves at {quantity(path.lasting[0], 'm/s')} throughout: a and b"
            " say how"
            " friction changes with speed."
        )
    if path.lasting[0] <= 0.0 or np.any(path.lasting < -0.01 * path.lasting.max()):
        raise InputError(
            "a rate-and-state fit needs a load point that moves forwards at first and never back,"
            f" got speeds from {quantity(path.lasting.min(), 'm/s')} to"
            f" {quantity(path.lasting.max(), 'm/s')}."
        )
    coefficient = np.asarray(measurement.values("friction")) / loads
    if np.mean(coefficient) <= 0.0:
        raise InputError(
            f"the mean coefficient of friction is {number(float(np.mean(coefficient)))} and must be"
            " above 0: count friction positive in the direction of the pull, with a gain such as"
            ' gain={"friction": -1}, or correct the offset of the force.'
        )
    return Record(
        time=time,
        coefficient=coefficient,
        pull=pull,
        path=path,
        begins=float(measurement.time[0]),
        load=float(loads.mean()),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class Slider(Problem):
    """Means of the friction coefficient over short stretches of a record, weighted by samples."""

    record: Record
    """The record, sample by sample."""
    form: RateStateForm
    """Form of the law."""
    reference_velocity: float
    """Speed at which the reference coefficient holds [m/s]."""
    free_parameters: FreeParameters
    """What is looked for, in the order of `PATHS`; a drift comes last, if any."""
    mean_time: Array
    """Mean times of the stretches (n,) [s]."""
    mean: Array
    """Mean coefficients of the stretches (n,)."""
    weight: Array
    """Square roots of the numbers of samples over their mean (n,)."""
    regularised: bool = False
    """Whether the law has an arcsinh in place of a logarithm."""

    @staticmethod
    def of(
        record: Record,
        form: RateStateForm,
        free_parameters: FreeParameters,
        reference_velocity: float,
        *,
        regularised: bool = False,
    ) -> "Slider":
        """Return the problem of a record; sums of squares differ by scatter within stretches.

        Of long records these are as many even ones of time, and as many that widen away from each
        step.
        """
        bins = np.arange(len(record.time))
        if len(bins) > PLAIN:
            bins = np.searchsorted(_edges(record), record.time, side="right")
        _, which, count = np.unique(bins, return_inverse=True, return_counts=True)
        return Slider(
            record=record,
            form=form,
            regularised=regularised,
            reference_velocity=reference_velocity,
            free_parameters=free_parameters,
            mean_time=np.bincount(which, record.time) / count,
            mean=np.bincount(which, record.coefficient) / count,
            weight=np.sqrt(count / count.mean()),
        )

    def with_free_parameters(self, free_parameters: FreeParameters) -> "Slider":
        """Return the same record with other unknowns, of the same paths."""
        return replace(self, free_parameters=free_parameters)

    @property
    def quantity(self) -> str:
        return "friction"

    @property
    def times(self) -> Array:
        return self.mean_time

    @property
    def by_steps(self) -> bool:
        """Whether segments begin with a step, so that each can be predicted from the others."""
        return len(self.record.path.steps) > 1

    @property
    def edges(self) -> Array:
        """Ends of the segments (segments + 1,) [s].

        Pieces of constant speed; parts with equally many rows of a record with a single step, of
        which nothing but that step tells how friction settles.
        """
        if self.by_steps:
            return self.record.path.segments
        inner = np.quantile(self.mean_time, np.arange(1, BLOCKS) / BLOCKS)
        return np.array([self.record.time[0], *inner, self.record.time[-1]])

    @property
    def spans(self) -> Array:
        edges = self.edges
        return np.column_stack([np.zeros(len(edges) - 1), edges[:-1], edges[1:]])

    @property
    def segments(self) -> NDArray[np.intp]:
        """Segment that each row belongs to (n,)."""
        return np.searchsorted(self.edges[1:-1], self.mean_time, side="right").astype(np.intp)

    def law(self, values: Array) -> RateState:
        """Return the law with values (p,) of the unknowns."""
        a, b, D_c, _, mu_0, c, b_2, D_2 = map(float, values[: len(PATHS)])
        return RateState(
            reference_coefficient=mu_0,
            direct_effect=a,
            evolution_effect=b,
            critical_distance=None if self.form.evolution == "none" else D_c,
            second_evolution_effect=b_2,
            second_critical_distance=D_2 if self.form.second else None,
            stress_effect=c,
            reference_velocity=self.reference_velocity,
            evolution=self.form.evolution,
            regularised=self.regularised,
        )

    def predict(self, values: Array, times: Array) -> Array | None:
        """Return friction coefficients at some times."""
        law, path = self.law(values), self.record.path
        speeds = np.maximum(path.speeds, 0.0)
        k = float(values[3])
        logs = logarithms(law, k, path.time, speeds, times, TOLERANCE, shown=True)
        if logs is None:
            return None
        drift = values[len(PATHS)] if len(values) > len(PATHS) else 0.0
        return np.array(
            coefficients(law, logs) + drift * np.interp(times, path.time, path.position)
        )

    def linearise(
        self,
        values: Array,
        near: ResidualJacobian | None = None,
        *,
        only: Sequence[int] | None = None,
        slopes: bool = True,
    ) -> ResidualJacobian:
        segments = self.segments
        rows = np.ones(len(segments), dtype=bool) if only is None else np.isin(segments, only)
        times, weight = self.mean_time[rows], self.weight[rows]
        base = self.predict(values, times)
        table = np.zeros((len(times), len(values)))
        if base is None:
            residual = np.full(len(times), np.inf)
            return ResidualJacobian(
                values=values, residual=residual, slopes=table, segment=segments[rows]
            )
        if slopes:
            table = weight[:, None] * self._slopes(values, times, base)
        return ResidualJacobian(
            values=values,
            residual=weight * (self.mean[rows] - base),
            slopes=table,
            segment=segments[rows],
        )

    def _slopes(self, values: Array, times: Array, base: Array) -> Array:
        """Return the derivatives of the prediction by the unknowns (n, p)."""
        table = np.ones((len(times), len(values)))  # the fifth is that of the level
        items = self.free_parameters.items
        for i in range(len(PATHS)):
            if items[i].path == PATHS[4]:
                continue
            if items[i].low == items[i].high:
                table[:, i] = 0.0
                continue
            size = values[i]
            if i in (DIRECT, EVOLVED, SECOND):
                level = THRESHOLDS.negligible * values[4]
                size = np.abs([values[DIRECT], values[EVOLVED], level]).max()
            elif i == STRESS:
                size = 1.0 + values[STRESS]
            step = NUDGE * size
            nudged = values.copy()
            nudged[i] += step
            there = self.predict(nudged, times)
            table[:, i] = 0.0 if there is None else (there - base) / step
        if len(values) > len(PATHS):
            table[:, -1] = np.interp(times, self.record.path.time, self.record.path.position)
        return table


def _edges(record: Record) -> Array:
    first, last = record.time[0], record.time[-1]
    edges = [np.linspace(first, last, STRETCHES + 1)]
    shortest = float(np.median(np.diff(record.time)))
    for step in record.path.steps:
        if last - step > 2.0 * shortest:
            edges.append(step + np.geomspace(shortest, last - step, STRETCHES))
    return np.unique(np.concatenate([*edges, record.path.steps]))


def unknowns_for(
    record: Record,
    form: RateStateForm,
    *,
    drift: bool,
    lowest_evolution_effect: float,
    held: Mapping[str, float],
    given: Mapping[str, float],
    reference_velocity: float,
) -> FreeParameters:
    """Return what is looked for, with first guesses read off the record."""
    declared = fields_of(RateState)
    slid, state = record.slid, form.evolution != "none"
    stressed = form.evolution == "nagata"
    rate, first = _levels(record)
    mu_0 = first - rate * float(np.log(record.speed / reference_velocity))
    start_a = (max(rate, 0.0) + 0.005) * (1.0 + stressed)  # a step shows a / (1 + c) at once
    start_b = start_a - rate
    lowest = lowest_evolution_effect
    if stressed:  # an effect of stress is divided by that of evolution
        lowest = max(lowest, THRESHOLDS.negligible * abs(mu_0))
    k = given.get(PATHS[3], held.get(PATHS[3], _steepest(record)))
    names = [path.rpartition(".")[2] for path in PATHS]
    numbers = [
        (declared[names[0]], start_a, 1e-6, 1.0, True),
        (declared[names[1]], start_b, lowest, 1.0, False),
        (declared[names[2]], 0.01 * slid, 1e-4 * slid, 10.0 * slid, True),
        (Quantity("k", "1/m", above=0), k, 1e-2 * k, 1e2 * k, True),
        (declared[names[4]], mu_0, -np.inf, np.inf, False),
        (declared[names[5]], 1.0, 0.0, np.inf, False),
        (declared[names[6]], 0.0, lowest_evolution_effect, 1.0, False),
        (declared[names[7]], 0.1 * slid, 1e-4 * slid, 10.0 * slid, True),
    ]
    if not state:
        numbers[0] = (declared[names[0]], rate, -1.0, 1.0, False)
        held = {PATHS[2]: slid, **held, PATHS[1]: 0.0}
    if form.second:
        numbers[1] = (declared[names[1]], 0.5 * start_b, lowest, 1.0, False)
        numbers[6] = (declared[names[6]], 0.5 * start_b, lowest_evolution_effect, 1.0, False)
    else:
        held = {**held, PATHS[6]: 0.0, PATHS[7]: slid}
    if not stressed:
        held = {**held, PATHS[5]: 0.0}
    items = []
    for path, (symbol, guess, low, high, log) in zip(PATHS, numbers, strict=True):
        start = held.get(path, given.get(path, guess))
        ends = (start, start) if path in held else (min(low, start), max(high, start))
        size = log and path not in held  # what is held stays to the last digit
        items.append(
            FreeParameter(
                path=path, quantity=symbol, start=start, low=ends[0], high=ends[1], log=size
            )
        )
    if drift:
        items.append(FreeParameter(path=DRIFT, quantity=Quantity("eta", "1/m"), start=0.0))
    return FreeParameters(tuple(items))


def _levels(record: Record) -> tuple[float, float]:
    """Return a guess of a - b and of the level at first, from the last third of each piece."""
    knots, speeds = record.path.segments, record.path.lasting
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
    edges = np.linspace(record.pull.min(), record.pull.max(), STRETCHES)
    bins = np.searchsorted(edges, record.pull, side="right")
    count = np.bincount(bins)
    kept = count > 0
    total = (np.bincount(bins, values)[kept] for values in (record.coefficient, record.pull))
    mu, x = (sums / count[kept] for sums in total)
    way = 2.0 * np.ptp(record.pull) / STRETCHES
    rise = [
        abs(np.interp(place + way, x, mu) - np.interp(place, x, mu)) / way
        for place in record.path.places
    ]
    return 2.0 * float(max(rise)) + 1e-3 / max(record.slid, 1e-12)
