"""The route of scarce data: travels of a body that comes to rest."""

import dataclasses
import math
from collections import Counter
from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from decimal import Decimal
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import QUANTITIES, Measurement, scale_of
from stickslip.engine.simulation import ensemble, simulate
from stickslip.engine.solver import EventDriven, Samples
from stickslip.engine.trajectory import Trajectory
from stickslip.errors import ConvergenceError, InputError, ParameterError, SimulationError
from stickslip.friction import FrictionLaw
from stickslip.identify.fits.contact_inputs import with_inputs
from stickslip.identify.fits.rig_uncertainties import uncertainties_of
from stickslip.mechanisms import WHOLE, Mechanism, Motor, cycle_of, repeats, slip_of
from stickslip.quantities import fields_of, parameters, structure, vary
from stickslip.show.formatting import number, quantity

Array: TypeAlias = NDArray[np.float64]

AFTER = 201
"""Evenly spaced times after the end at which it is seen whether a body is at rest, beside the
solver's own."""
CLEARLY = 0.5
"""Way after the end over the error of a reading up to which a body is at rest, whatever it does
between the times at which that is looked at."""
STEADY = 1.98
"""Way in a time over that in its first half, from which on a body does not slow down."""
LEAST_ERROR = 1e-5
"""Share of the mean travel below which readings are not told apart: runs are exact to 1e-8, and no
travel was ever measured to this."""


SOLVER = EventDriven(tier="compiled", tolerance=1e-8, stiff_tolerance=1e-6)
"""Travels are wrong by 1e-6 of themselves, a tenth of what readings are told apart by at best."""


@dataclass(frozen=True, kw_only=True)
class Trial:
    """One measured travel and how the rig was set for it."""

    mechanism: Mechanism
    """The rig as it was set."""
    initial: Mapping[str, float]
    """Initial states by name [SI]."""
    travel: float
    """Measured travel, to rest or over the cycles [m]."""
    half_width: float
    """Uncertainty of the travel [m]; 0 if none was given."""
    quantity: str = "travel"
    """As what the travel was measured, one of `TRAVELS`."""
    scale: float = 1.0
    """The travel over the number that was read."""
    cycles: int | None = None
    """Whole cycles of the drives after which its run ends; None if it lasts until ``t_end``."""
    kind: str = "standard"
    """What the uncertainty is, as in `Measurement`."""
    doubts: Mapping[str, float] = field(default_factory=dict)
    """Standard uncertainties of the mechanism's parameters that are of this trial alone."""
    shared: Mapping[str, float] = field(default_factory=dict)
    """Those that all trials share."""

    def with_mechanism(self, mechanism: Mechanism) -> "Trial":
        """Return the trial as if it had been made with another mechanism."""
        return replace(self, mechanism=mechanism)

    def until(self, t_end: float) -> float:
        """Return when the run of this trial ends [s]."""
        if self.cycles is None:
            return t_end
        end = self.cycles * cycle_of(self.mechanism)
        return t_end if math.isclose(end, t_end, rel_tol=WHOLE) else end

    def start(self, law: FrictionLaw) -> Mapping[str, float]:
        """Return the initial states that a mechanism with a law has."""
        known = {*self.mechanism.coordinates, *self.mechanism.rates}
        known.update(law.states)
        return {name: value for name, value in self.initial.items() if name in known}

    def simulated(self, law: FrictionLaw, t_end: float, *, throw: bool = False) -> Trajectory:
        """Return its run with a law, to `t_end` [s] or over its cycles; as far as it works."""
        start = self.start(law)
        return simulate(self.mechanism, law, t_end=self.until(t_end), y0=start, throw=throw)

    def as_read(self, travel: float) -> str:
        """Return a travel [m] of this trial as what was read, with its unit."""
        return quantity(travel / self.scale, QUANTITIES[self.quantity].unit)

    @property
    def averaged(self) -> bool:
        """Whether it is shown as a mean velocity: that was read, or its run ends with a cycle."""
        return self.cycles is not None or self.quantity == "mean_velocity"

    @property
    def setting(self) -> Hashable:
        """What the experimenter set: trials of one setting are repeats."""
        return self.mechanism, frozenset(self.initial.items())

    @property
    def run(self) -> Hashable:
        """What tells runs apart: their setting, and when they end."""
        return self.setting, self.cycles


def is_rig(path: str) -> bool:
    """Whether a parameter is one of the mechanism, not of the law."""
    return path.startswith("mechanism.")


def quantities_read(trials: Sequence[Trial]) -> str:
    """Return what was read in place of travels, in words; empty if travels were read.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> quantities_read(trials_of(SpringBlock(mass=1.0), Measurement(mean_velocity=0.1), 2.0))
    'mean velocity'
    """
    names = dict.fromkeys(trial.quantity for trial in trials)
    return "" if list(names) == ["travel"] else " or ".join(names).replace("_", " ")


def driven_on(mechanism: Mechanism) -> bool:
    """Whether a drive moves the body for as long as a run lasts, so that it has no travel to rest.

    That is so where a drive repeats itself, and in a cart or capsule that carries its drive.

    Examples
    --------
    >>> from stickslip import Capsule, SpringBlock
    >>> from stickslip.mechanisms.drives import Pulse
    >>> from stickslip.mechanisms import Torque
    >>> push = Pulse(level=10.0, duration=0.1)
    >>> capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Torque(drive=push))
    >>> driven_on(capsule), driven_on(SpringBlock(mass=1.0, drive=push))
    (True, False)
    """
    parts = (getattr(mechanism, item.name) for item in dataclasses.fields(mechanism))
    carried = any(isinstance(part, Motor) for part in parts)
    return repeats(mechanism) or (carried and bool(mechanism.drives()))


def quiet_from(mechanism: Mechanism) -> float:
    """Return when the drives of a mechanism change last [s]; infinity if they go on.

    Examples
    --------
    >>> from stickslip import Axis, SpringBlock
    >>> from stickslip.mechanisms.drives import Pulse
    >>> quiet_from(Axis(inertia=1.0, drive=Pulse(level=1.0, duration=0.1)))
    0.1
    >>> quiet_from(SpringBlock(mass=1.0))
    0.0
    """
    drives = mechanism.drives().values()
    last = [drive.pieces()[-1] for drive in drives if drive.pieces()]
    changes = any(drive.smooth_bound() != (0, 0) for drive in drives) or any(x.slope for x in last)
    if driven_on(mechanism) or mechanism.carried() or changes:
        return math.inf
    return max((piece.start for piece in last), default=0.0)


def trials_of(mechanism: Mechanism, measurement: Measurement, t_end: float) -> tuple[Trial, ...]:
    """Return the trials of a measurement of travels, mean velocities or travels per cycle.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> (one,) = trials_of(SpringBlock(mass=1.0), Measurement(mean_velocity=0.1), 2.0)
    >>> one.travel
    0.2
    """
    trials = []
    uncertainties = uncertainties_of(mechanism, measurement)
    pairs = zip(measurement.records(), uncertainties, strict=True)
    for index, (record, (own, shared)) in enumerate(pairs, 1):
        name = record.travelled
        if not name:
            raise InputError(
                "a fit to travels needs travels, and record"
                f" {record.name or 'without a name'!r} has none;"
                f" it has {', '.join(record.quantities())}."
            )
        scale, cycles = scale_of(mechanism, record, t_end, f"trial {record.name or index}")
        trials += [
            Trial(
                mechanism=with_inputs(
                    vary(mechanism, "mechanism", record.overrides), record, np.zeros(1)
                ),
                initial=record.initial,
                travel=scale * float(value),
                half_width=scale * record.usual_uncertainty(name),
                quantity=name,
                scale=scale,
                cycles=cycles,
                kind=record.uncertainty_kind,
                doubts=own,
                shared=shared,
            )
            for value in np.atleast_1d(record.values(name))
        ]
    return tuple(trials)


def standard_errors(trials: Sequence[Trial]) -> tuple[Array, bool]:
    """Return a standard error of each travel [m], and whether any uncertainty was stated.

    That of a rounding range is that of a uniform distribution; repeats of a setting that were all
    rounded to one number share one error, and so tell no more than one of them. Readings without a
    stated uncertainty beside others with one have the largest stated one. Where none is stated the
    errors are lower bounds, for the true ones to be estimated from the residuals: nobody reads
    better than the last digit that is written down.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> one = Trial(mechanism=rig, initial={}, travel=0.204, half_width=0.0)
    >>> errors, stated = standard_errors([one])
    >>> f"{1e3 * errors[0]:.2f} mm", stated
    ('0.29 mm', False)
    """
    rounded = 1.0 / math.sqrt(3.0)
    widths = np.array([t.half_width * (rounded if t.kind == "rounding" else 1.0) for t in trials])
    least = LEAST_ERROR * float(np.mean([abs(trial.travel) for trial in trials])) or LEAST_ERROR
    groups = Counter((t.setting, t.travel) for t in trials if t.kind == "rounding")
    settings = Counter(trial.setting for trial in trials)
    for i, t in enumerate(trials):
        if groups[t.setting, t.travel] == settings[t.setting]:
            widths[i] *= math.sqrt(settings[t.setting])
    if np.any(widths > 0.0):
        return np.maximum(np.where(widths > 0.0, widths, widths.max()), 1e-3 * least), True
    digit = min(trial.scale * last_digit([trial.travel / trial.scale]) for trial in trials)
    return np.full(len(trials), max(min(digit, 0.01) / math.sqrt(12.0), least)), False


def last_digit(readings: Iterable[float]) -> float:
    """Return the unit of the last digit that is written down of readings.

    Examples
    --------
    >>> last_digit([0.25, 1.3, 12.0]), last_digit([300.0, 20.0, 0.0])
    (0.01, 10.0)
    """
    written = [Decimal(f"{reading:.12g}").normalize().as_tuple() for reading in readings if reading]
    return 10.0 ** min((int(number.exponent) for number in written), default=0)


def under_cycles(trials: Sequence[Trial]) -> bool:
    """Whether a drive that repeats itself moves the body again and again.

    Examples
    --------
    >>> from stickslip import Capsule, SpringBlock
    >>> from stickslip.mechanisms.drives import Square
    >>> from stickslip.mechanisms import Torque
    >>> wave = Torque(drive=Square(high=6.0, low=-1.0, period=0.4))
    >>> rigs = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=wave), SpringBlock(mass=1.0)
    >>> trials = [Trial(mechanism=rig, initial={}, travel=0.2, half_width=0.0) for rig in rigs]
    >>> under_cycles(trials), under_cycles(trials[1:])
    (True, False)
    """
    return any(repeats(trial.mechanism) for trial in trials)


def durations(trials: Sequence[Trial], t_end: float) -> Array:
    """Return how long runs last if all are shown by mean velocities (n,) [s]; 1 of others.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> trial = Trial(mechanism=SpringBlock(mass=1.0), initial={}, travel=0.2, half_width=0.0)
    >>> durations([trial], 10.0)
    array([1.])
    """
    averaged = all(trial.averaged for trial in trials)
    return np.array([trial.until(t_end) if averaged else 1.0 for trial in trials])


@dataclass
class TravelModel:
    """Travel as a function of the free parameters of a law, and of its mechanism."""

    law: FrictionLaw
    """Holds the parameters that are not free."""
    free: Sequence[str]
    """Full paths of the p free parameters: those of the law, then those of the mechanism."""
    t_end: float
    """Time after which a body counts as stopped [s]."""
    watch: Callable[[int], object] | None = None
    """Called with the number of runs so far."""
    runs: int = field(default=0, init=False)
    """Number of runs so far."""

    def with_values(self, values: Sequence[float]) -> FrictionLaw:
        """Return the law with other values of the free parameters."""
        changes = dict(zip(self.free, values, strict=True))
        return vary(self.law, "friction", {p: v for p, v in changes.items() if not is_rig(p)})

    def set_up(self, trial: Trial, values: Sequence[float]) -> Trial:
        """Return a trial whose mechanism has other values of the free parameters."""
        own = {p: v for p, v in zip(self.free, values, strict=True) if is_rig(p)}
        return trial.with_mechanism(vary(trial.mechanism, "mechanism", own)) if own else trial

    def travel(self, trial: Trial, values: Sequence[float]) -> float:
        """Return the travel [m] of one trial."""
        self.runs += 1
        if self.watch is not None:
            self.watch(self.runs)
        trial = self.set_up(trial, values)
        run = trial.simulated(self.with_values(values), self.t_end, throw=True)
        ends = run.at(run.span)[slip_of(trial.mechanism)]
        return float(ends[1] - ends[0])

    def travels(self, trials: Sequence[Trial], values: Sequence[float]) -> Array:
        """Return the travel of each trial [m] (n,); trials of one setting are one run."""
        result: dict[Hashable, float] = {}
        for trial in trials:
            if trial.run not in result:
                result[trial.run] = self.travel(trial, values)
        return np.array([result[trial.run] for trial in trials])

    def table(self, trials: Sequence[Trial], rows: Array) -> Array:
        """Return the travels of each trial for many values at once, by ensembles."""
        if any(map(is_rig, self.free)) and any(trial.cycles is not None for trial in trials):
            # when a run ends may depend on what is fitted
            return np.array([self._travels_or_nan(trials, row.tolist()) for row in rows])
        result: dict[Hashable, Array] = {}
        for alike in self._alike(trials):
            end = alike[0].until(self.t_end)
            made = self._to_rest(alike, rows, end)
            self.runs += made.size
            if self.watch is not None:
                self.watch(self.runs)
            result |= {trial.run: travels for trial, travels in zip(alike, made, strict=True)}
        return np.stack([result[trial.run] for trial in trials], axis=1)

    def _to_rest(self, trials: Sequence[Trial], rows: Array, end: float) -> Array:
        """Return the travels (n, k) of trials alike; of bristles, from where a body is at rest.

        It is at rest where it rings by less than readings are told apart by, and its mean would go
        no farther until the end at the speed that it has: a body that slows down goes less far.
        """
        # undamped bristles ring for as long as a run lasts, thousands of times
        part, live = 0.2 * end, np.arange(len(rows))
        result = np.full((len(trials), len(rows)), math.nan)
        damped = any(item.scale == "damping" for item in fields_of(type(self.law)).values())
        rings = bool(self.law.states) and not damped and not any(map(is_rig, self.free))
        if rings and max(quiet_from(trial.mechanism) for trial in trials) < 0.75 * part:
            times = np.r_[0.0, part * np.linspace(0.75, 1.0, AFTER - 1)]
            seen = self._together(trials, rows, times.tolist(), part)
            way = seen[:, :, 1:] - seen[:, :, :1]
            window = np.hanning(AFTER // 2)
            before, mean = (x @ window / window.sum() for x in np.split(way, 2, axis=2))
            left = np.abs(mean - before) / (0.125 * part) * (end - part) + np.ptp(way, axis=2)
            least = LEAST_ERROR * float(np.mean([abs(trial.travel) for trial in trials]))
            done = np.all(left <= least, axis=0)
            result[:, done], live = mean[:, done], live[~done]
        if len(live):
            ends = self._together(trials, rows[live], (0.0, end), end)
            result[:, live] = ends[:, :, 1] - ends[:, :, 0]
        return result

    def _alike(self, trials: Sequence[Trial]) -> list[list[Trial]]:
        """Return trials whose runs can be one ensemble, one of each run."""
        together: dict[Hashable, list[Trial]] = {}
        for trial in {trial.run: trial for trial in trials}.values():
            start = tuple(trial.start(self.law).items())
            kind = structure(trial.mechanism), trial.until(self.t_end), start
            together.setdefault(kind, []).append(trial)
        return list(together.values())

    def _together(
        self, trials: Sequence[Trial], rows: Array, times: Sequence[float], end: float
    ) -> Array:
        """Return the positions (n, k, m) at times of trials that differ in numbers only.

        They are those of one ensemble, and NaN where a run is not complete.
        """
        first, count = trials[0], len(rows)
        known = [
            {path: value for path, _, value in parameters(trial.mechanism, "mechanism")}
            for trial in trials
        ]
        columns = {p: np.tile(rows[:, i], len(trials)) for i, p in enumerate(self.free)}
        for path, value in known[0].items():
            if any(values[path] != value for values in known):
                columns[path] = np.repeat([float(values[path]) for values in known], count)
        if not columns:
            path, value = next(
                (path, value)
                for path, quantity, value in parameters(self.law, "friction")
                if not quantity.structural
            )
            columns[path] = np.full(len(trials) * count, float(value))
        slip = slip_of(first.mechanism)
        runs = ensemble(
            first.mechanism,
            self.law,
            columns,
            t_end=end,
            outputs={slip: Samples(slip, times)},
            y0=first.start(self.law),
            solver=SOLVER,
        )
        complete = np.array([status.complete for status in runs.status])
        result: Array = np.where(complete[:, None], runs[slip], math.nan)
        return result.reshape(len(trials), count, len(times))

    def _travels_or_nan(self, trials: Sequence[Trial], values: Sequence[float]) -> Array:
        try:
            return self.travels(trials, values)
        except (SimulationError, ParameterError):
            return np.full(len(trials), math.nan)

    def check_rest(
        self, trials: Sequence[Trial], values: Sequence[float], errors: Sequence[float] | Array
    ) -> None:
        """Refuse values with which a body that is to come to rest still moves at ``t_end``.

        A run that creeps towards its last position counts as at rest once the way left is within
        the uncertainty of the reading; that way is looked for by a run of twice the duration.
        Mean velocities and travels per cycle are those of the run, at rest or not, and so are
        travels under a drive that goes on.
        """
        least, ends = dict[Hashable, float](), list[Trial]()
        for trial, error in zip(trials, errors, strict=True):
            if trial.quantity == "travel" and not driven_on(trial.mechanism):
                ends.append(self.set_up(trial, values))
                known = least.get(ends[-1].run, math.inf)
                least[ends[-1].run] = min(error, known)
        fitted = TravelModel(self.with_values(values), (), self.t_end)
        times = np.linspace(self.t_end, 2.0 * self.t_end, AFTER).tolist()
        for alike in fitted._alike(ends):  # ensembles tell who is at rest for less than runs do
            seen = fitted._together(alike, np.zeros((1, 0)), times, times[-1])[:, 0]
            way = np.max(np.abs(seen - seen[:, :1]), axis=1)
            for trial, moved in zip(alike, way.tolist(), strict=True):
                if not moved <= CLEARLY * least[trial.run]:
                    fitted._check_rest(trial, least[trial.run])

    def _check_rest(self, trial: Trial, error: float) -> None:
        end, slip = self.t_end, slip_of(trial.mechanism)
        run = trial.simulated(self.law, 2.0 * end)
        index = trial.mechanism.coordinates.index(slip)
        last = min(2.0 * end, float(run.span[1]))
        if last <= end:
            return
        times = np.union1d(np.linspace(end, last, AFTER), run.t[(run.t > end) & (run.t < last)])
        seen = run.at(times)
        way = np.abs(seen[slip] - seen[slip][0])
        if not way.max() > error:
            return
        unit = trial.mechanism.units[index]
        speed = quantity(abs(float(seen[trial.mechanism.rates[index]][0])), f"{unit}/s")
        halves = way[np.searchsorted(times, 0.5 * (end + last))], way[-1]
        steady = halves[1] >= STEADY * halves[0]
        cure = "It does not slow down: measure mean_velocity over the run instead."
        raise ConvergenceError(
            f"{self.law.title} friction does not bring the body to rest: at t_end ="
            f" {number(end)} s it still moves at {speed}, and travels up to"
            f" {quantity(float(way.max()), unit)} farther in the same time again."
            f" {cure if steady else 'Increase t_end.'}"
        )
