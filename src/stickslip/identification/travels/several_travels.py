"""Several travels: weighted least squares, with intervals from the readings' standard errors."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import ConvergenceError, ParameterError, SimulationError
from stickslip.formatting import joined
from stickslip.identification.results import Estimate
from stickslip.identification.travels.model import (
    TravelModel,
    Trial,
    is_rig,
    standard_errors,
)
from stickslip.identification.travels.propagation import (
    Propagated,
    agreeing_scale,
    covariance_of,
    propagated,
)
from stickslip.identification.travels.result import TravelFit, variance_of
from stickslip.identification.travels.single_travel import room_for
from stickslip.identification.travels.start_values import Start, starting_points
from stickslip.quantities import Quantity, parameters

Array: TypeAlias = NDArray[np.float64]

STEP = 1e-4
"""Step of finite differences over the scale of a parameter: runs with bristles are exact to 1e-8,
and the error of a one-sided difference is then about as small as it can be."""
POLISHED = 3
"""Starting points that least squares goes on from, at most."""
POOR = 4.0
"""Mean square of standardised residuals beyond which, where a mechanism is unknown, searches begin
from all further starting points."""
STEPS, REFINED = 15, 4
"""Steps of least squares, at most: of a search, and from a single start that is already near."""
WEIGHINGS = 2
"""Fits by weights that follow from the fit before, where the mechanism is uncertain."""
NEAR = 100.0
"""Cost of a starting point over that of the best one beyond which no search begins there."""
FAILED = 1e6
"""Standardised residual of a run that cannot be made."""
STRIDES, ENOUGH = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0), 0.7
"""Lengths of an interval at which it is seen whether chi-square has risen by such a share of what
it should, which its third derivatives change."""
BESIDE = 6.0
"""Standard errors from the best values at which searches begin again: mean speeds and travels rise
and fall with a mechanism's parameters, and minima that fit as well lie side by side."""
INSENSITIVE = "the trials hardly depend on it"
"""Why an estimate has no interval."""
TOGETHER = 0.95
"""Correlation beyond which two parameters are told in combination only."""
AS_WELL = 3.84
"""Chi-square over its least value up to which other values fit as well: 95 %."""
FLAT = 1e-8
"""Singular value over the largest, columns scaled, below which a direction is not identified."""


def fit_several(
    model: TravelModel, trials: Sequence[Trial], starts: Sequence[Start] | None = None
) -> TravelFit:
    """Fit the free parameters to all trials, and return the best point of all searches.

    Intervals are those of Student's t distribution. With stated uncertainties that the residuals
    bear out, the standard errors are known, which is the limit of infinitely many degrees of
    freedom. Where no uncertainty is stated, or the residuals exceed it significantly, the variance
    is estimated from the residuals, and t has as many degrees of freedom as there are readings more
    than parameters; see `TravelFit.variance`.

    Uncertainties of the mechanism make the covariance of the travels, at a first fit without those
    that trials share: what was set for each trial adds to its variance, what trials share moves
    them together. Where residuals give the errors of the readings, weights follow the ratio of
    both.
    """
    problem = _Problem(model, trials)
    points = starting_points(model, trials) if starts is None else list(starts)
    tried = sorted(
        (problem.cost(problem.free_parameters(point)), index, problem.free_parameters(point))
        for index, point in enumerate(points)
    )
    steps = (STEPS if len(points) > 1 else REFINED) * (2 if problem.rig else 1)
    near = [start for first, _, start in tried if first <= NEAR * tried[0][0]]
    ends = [tried[0][2]]
    for count, start in enumerate(near):
        poor = problem.rig and min(map(problem.cost, ends)) > POOR * len(trials)
        if count >= POLISHED and not poor:
            break
        ends.append(problem.polished(start, steps))
    best = min(ends, key=problem.cost)
    if problem.rig:
        ends += [problem.polished(start, STEPS) for start in problem.beside(best)]
        best = min(ends, key=problem.cost)
    cost = problem.cost(best)
    if cost >= FAILED**2:
        raise ConvergenceError(
            f"the search found no values of {', '.join(model.free)} with which every trial can"
            " be simulated."
        )
    for _ in range(WEIGHINGS):
        if not problem.weighed(best):
            break
        best = min(best, problem.polished(best, REFINED), key=problem.cost)
    return problem.fit(best, ends)


def expected_fit(model: TravelModel, trials: Sequence[Trial], values: Sequence[float]) -> TravelFit:
    """Return the fit to travels that given values lead to: its intervals to expect."""
    measured = model.travels(trials, values)
    pairs = zip(trials, measured.tolist(), strict=True)
    problem = _Problem(model, [replace(trial, travel=travel) for trial, travel in pairs])
    best = problem.free_parameters(values)
    problem.weighed(best)
    return problem.fit(best)


class _Problem:
    """Whitened residuals, as a function of unknowns that keep a law's inequalities.

    An unknown is the parameter itself, or how much it lies above another free parameter that it
    must not fall below.
    """

    def __init__(self, model: TravelModel, trials: Sequence[Trial]) -> None:
        self.model, self.trials = model, trials
        self.rig = any(map(is_rig, model.free))
        """Whether parameters of the mechanism are unknown too."""
        self.measured = np.array([trial.travel for trial in trials])
        self.readings, self.stated = standard_errors(trials)
        """Standard errors of the readings alone (n,)."""
        self.spread = Propagated(own={}, shared={})
        """What the uncertainties of the mechanism make of the travels."""
        self.weights = self.spread
        """The same as it weighs residuals."""
        self.relative = False
        """Whether that is to scale with the errors of the readings, which residuals tell."""
        self.whitening = np.diag(1.0 / self.readings)
        """Makes uncorrelated residuals of variance 1 (n, n)."""
        known = *parameters(model.law, "friction"), *parameters(trials[0].mechanism, "mechanism")
        self.known: dict[str, tuple[Quantity, float]] = {p: (q, v) for p, q, v in known}
        self.scale = np.array([self.known[path][1] or 0.1 for path in model.free])
        self.matrix = np.eye(len(model.free))
        """Values from unknowns."""
        room = []
        for i, path in enumerate(model.free):
            prefix, _, name = path.rpartition(".")
            base = f"{prefix}.{self.known[path][0].at_least}"
            if base in model.free:
                self.matrix[i, list(model.free).index(base)] = 1.0
                room.append((0.0, math.inf))
            elif is_rig(path):
                own = self.known[path][0]
                room.append((max(own.low, -math.inf if own.above is None else own.above), own.high))
            else:
                room.append(room_for(model.law, name, model.free))
        self.low, self.high = (np.array(side) for side in zip(*room, strict=True))
        above = np.array([self.known[p][0].above is not None for p in model.free])
        self.least = self.low + np.where(above, 1e-3 * self.scale, 0.0)
        self._seen: dict[tuple[float, ...], Array] = {}

    def free_parameters(self, values: Sequence[float]) -> Array:
        """Return the unknowns for values of the parameters, just inside their bounds."""
        found = np.linalg.solve(self.matrix, np.asarray(values, dtype=float))
        clipped: Array = np.clip(found, self.least, self.high)
        return clipped

    def weighed(self, free_parameters: Array) -> bool:
        """Weigh residuals by what the mechanism's uncertainties make of them; False without any."""
        if not any((*trial.doubts, *trial.shared) for trial in self.trials):
            return False
        values = (self.matrix @ free_parameters).tolist()
        self.spread = self.weights = propagated(self.model, self.trials, values)
        self._whiten()
        left = self.measured - self.predicted(free_parameters)
        freedom = len(left) - len(values)
        whole = float(np.sum((self.whitening @ left) ** 2))
        self.relative = (
            freedom > 0 and variance_of(whole, freedom, stated=self.stated)[1] < math.inf
        )
        if self.relative:
            # weights that trust such readings against what trials share would be wrong: they
            # follow the errors with which residuals agree, and the scale is that of residuals
            self.weights = self.spread.scaled(1.0 / math.sqrt(self._scale(left, freedom)))
            self._whiten()
        return True

    def _scale(self, left: Array, freedom: int) -> float:
        """Return the variance of readings with which residuals agree, over that stated."""

        def covariance(scale: float) -> Array:
            scatter = self.spread.scatter(self.readings * math.sqrt(scale))
            return covariance_of(scatter, self.spread.shared)

        return agreeing_scale(left, self.readings, freedom, covariance)

    def _whiten(self) -> None:
        self.whitening = np.linalg.inv(np.linalg.cholesky(self._covariance()))

    def _covariance(self) -> Array:
        """Return the covariance of the travels (n, n) as residuals are weighed, up to a factor."""
        return covariance_of(self.weights.scatter(self.readings), self.weights.shared)

    def predicted(self, free_parameters: Array) -> Array:
        """Return the travels [m] (n,); NaN where a run cannot be made."""
        key = tuple(free_parameters.tolist())
        if key not in self._seen:
            values = (self.matrix @ free_parameters).tolist()
            try:
                self._seen[key] = self.model.travels(self.trials, values)
            except (SimulationError, ParameterError):
                self._seen[key] = np.full(len(self.trials), math.nan)
        return self._seen[key]

    def residuals(self, free_parameters: Array) -> Array:
        """Return measured less predicted travels, whitened (n,)."""
        left = self.measured - self.predicted(free_parameters)
        if not np.all(np.isfinite(left)):
            return np.full(len(self.trials), FAILED)
        return np.asarray(self.whitening @ left)

    def cost(self, free_parameters: Array) -> float:
        return float(np.sum(self.residuals(free_parameters) ** 2))

    def slopes_at(self, free_parameters: Array) -> Array:
        """Return derivatives of the residuals (n, p), by central differences for a mechanism.

        Near a resonance one-sided ones are wrong by a hundredth, and what scales with all else, as
        masses, forces and a stiffness do together, would seem to be told apart.
        """
        if not self.rig:
            return self.jacobian(free_parameters)
        columns = []
        for i, scale in enumerate(np.maximum(np.abs(free_parameters), 0.1 * self.scale)):
            ends = np.clip(
                free_parameters[i] + STEP * scale * np.array([-1.0, 1.0]), self.low[i], self.high[i]
            )
            there = [free_parameters.copy(), free_parameters.copy()]
            there[0][i], there[1][i] = ends
            low, high = map(self.residuals, there)
            columns.append((high - low) / (ends[1] - ends[0]))
        return np.stack(columns, axis=1)

    def jacobian(self, free_parameters: Array) -> Array:
        """Return derivatives of the residuals (n, p) by one-sided differences within bounds."""
        base = self.residuals(free_parameters)
        columns = []
        for i, scale in enumerate(np.maximum(np.abs(free_parameters), 0.1 * self.scale)):
            moved = free_parameters.copy()
            side = 1.0 if free_parameters[i] + STEP * scale <= self.high[i] else -1.0
            moved[i] += side * STEP * scale
            columns.append((self.residuals(moved) - base) / (moved[i] - free_parameters[i]))
        return np.stack(columns, axis=1)

    def polished(self, start: Array, steps: int) -> Array:
        """Return where least squares ends that begins at `start`, on a bound if that is as good."""
        from scipy.optimize import least_squares

        # steps shrink with the distance from a bound: a start on one would hardly move
        off = np.minimum(1e-2 * self.scale, 0.25 * (self.high - self.low))
        inside = np.clip(start, self.low + off, self.high - off)
        found = least_squares(
            self.residuals,
            inside,
            jac=self.jacobian,
            bounds=(self.low, self.high),
            x_scale=np.maximum(np.abs(inside), 0.1 * self.scale),
            xtol=1e-8,
            ftol=1e-4,  # of chi-square, which decides where it is of the order of 10
            gtol=1e-10,
            max_nfev=steps,
        )
        ends: Array = np.asarray(found.x)
        bound = np.where(ends - self.low < 1e-3 * self.scale, self.least, ends)
        return bound if self.cost(bound) <= (1.0 + 1e-3) * self.cost(ends) + 1e-6 else ends

    def beside(self, best: Array) -> Iterator[Array]:
        """Yield unknowns on both sides of the best ones, along what each value is told with."""
        gain, _ = self._gain(best)
        known = np.where(np.isfinite(gain), gain, 0.0)
        table = known @ self._covariance() @ known.T
        values = self.matrix @ best
        sizes = np.maximum(np.abs(values), self.scale)
        for along, variance in zip(table.T, np.diag(table), strict=True):
            if variance > 0.0:
                step = BESIDE * along / math.sqrt(variance)
                step *= min(1.0, 0.5 / float(np.max(np.abs(step) / sizes)))
                for side in (-1.0, 1.0):
                    yield self.free_parameters((values + side * step).tolist())

    def fit(self, best: Array, ends: Sequence[Array] = ()) -> TravelFit:
        """Return what the best unknowns are, with intervals; `ends` are those of all searches."""
        residuals = self.residuals(best)
        values = (self.matrix @ best).tolist()
        gain, condition = self._gain(best)
        freedom = len(residuals) - len(values)
        variance = variance_of(float(np.sum(residuals**2)), freedom, stated=self.stated)
        scatter = self.spread.scatter(self.readings)
        doubtful = bool(self.spread.own or self.spread.shared)
        sources = self.weights.sources(self.readings, gain)
        correlation = _correlation(gain, self._covariance())
        found = [
            self._estimate(path, value, scale, variance, source, stated=doubtful)
            for path, value, scale, source in zip(
                self.model.free, values, self.scale.tolist(), sources, strict=True
            )
        ]
        if self.rig:
            found = self._told_apart(found, values, gain, variance[0])
        rivals = self._rivals(found, best, ends, variance)
        return TravelFit(
            law=self.model.with_values(values),
            mechanism=self.model.set_up(self.trials[0], values).mechanism,
            estimates=tuple(
                self._reaching(one, [rival[i] for rival in rivals]) for i, one in enumerate(found)
            ),
            measured=tuple(self.measured.tolist()),
            predicted=tuple(self.predicted(best).tolist()),
            standard_errors=tuple(scatter.tolist()),
            reading_errors=tuple(self.readings.tolist()),
            slopes=self._slopes(best),
            shared={path: tuple(part.tolist()) for path, part in self.spread.shared.items()},
            stated=self.stated,
            condition=condition,
            correlation=correlation,
            rivals=rivals,
            trials=tuple(self.model.set_up(trial, values) for trial in self.trials),
            runs=self.model.runs,
        )

    def _told_apart(
        self, found: Sequence[Estimate], values: Sequence[float], gain: Array, variance: float
    ) -> list[Estimate]:
        """Return estimates whose intervals reach to where the trials are explained no more.

        Slopes at the best values say nothing of what is farther away, and are wrong where a run
        jumps. So each interval is walked, the other values following, until chi-square has risen;
        one that ends nowhere near, or is wider than the value itself, is open.
        """
        known = np.where(np.isfinite(gain), gain, 0.0)
        table = known @ self._covariance() @ known.T
        spreads = np.sqrt(np.maximum(np.diag(table), 1e-300))
        told = []
        for i, (one, scale) in enumerate(zip(found, self.scale.tolist(), strict=True)):
            if one.reason:
                told.append(one)
                continue
            half = one.high - one.value
            step = table[:, i] / spreads[i] ** 2 * half
            most = max(abs(one.value), scale)
            far = max(self._reach(np.array(values), side * step, variance) for side in (1.0, -1.0))
            if far * half <= most:
                least = self.known[one.path][0]
                low = max(one.value - far * half, least.low, least.above or -math.inf)
                told.append(replace(one, low=low, high=one.value + far * half))
                continue
            others = [
                other.quantity.symbol
                for j, other in enumerate(found)
                if j != i and abs(table[i, j]) > TOGETHER * spreads[i] * spreads[j]
            ]
            reason = INSENSITIVE
            if others:
                reason = f"the trials tell no more than a combination of it with {joined(others)}"
            told.append(replace(one, low=-math.inf, high=math.inf, reason=reason, sources={}))
        return told

    def _reach(self, values: Array, step: Array, variance: float) -> float:
        """Return how many steps from values chi-square has risen; infinite if it does not."""
        base = self.cost(self.free_parameters(values.tolist()))
        for times in STRIDES:
            there = self.free_parameters((values + times * step).tolist())
            if self.cost(there) - base >= ENOUGH * AS_WELL * variance:
                return times
            if np.any((there <= self.least) & (step < 0.0)):  # a limit ends the interval
                return times
        return math.inf

    def _rivals(
        self,
        found: Sequence[Estimate],
        best: Array,
        ends: Sequence[Array],
        variance: tuple[float, float],
    ) -> tuple[tuple[float, ...], ...]:
        """Return other values where a search ended that fit as well, outside of the intervals."""
        room = self.cost(best) + AS_WELL * variance[0]
        rivals = []
        for end in ends if self.rig else ():
            values = tuple((self.matrix @ end).tolist())
            outside = (not e.low <= v <= e.high for e, v in zip(found, values, strict=True))
            if any(outside) and self.cost(end) <= room:
                rivals.append(values)
        return tuple(rivals)

    def _reaching(self, one: Estimate, others: Sequence[float]) -> Estimate:
        """Return an estimate whose interval reaches over other values that fit as well."""
        if not others or not one.bounded:
            return one
        half = one.high - one.value + max(abs(other - one.value) for other in others)
        least = self.known[one.path][0]
        low = max(one.value - half, least.low, least.above or -math.inf)
        return replace(one, low=low, high=one.value + half)

    def _slopes(self, best: Array) -> tuple[tuple[float, ...], ...]:
        """Return derivatives of the travels (n, p) by what no bound holds; 0 by the others."""
        slopes = -np.linalg.solve(self.whitening, self.slopes_at(best))
        free = np.isfinite(slopes).all(axis=0) & (best > self.least) & (best < self.high)
        return tuple(map(tuple, np.where(free, slopes, 0.0).tolist()))

    def _gain(self, best: Array) -> tuple[Array, float]:
        """Return derivatives of values by travels (p, n), and the condition of the scaled Jacobian.

        A value on which a direction bears that the travels do not determine has infinite ones.
        """
        jacobian = self.slopes_at(best) @ np.linalg.inv(self.matrix)
        sizes = np.linalg.norm(jacobian, axis=0)
        if not np.all(np.isfinite(jacobian)) or not np.all(sizes > 0.0):
            return np.full(jacobian.shape[::-1], np.inf), math.inf
        left, singular, rows = np.linalg.svd(jacobian / sizes, full_matrices=False)
        condition = float(singular[0] / max(singular[-1], 1e-300))
        inverse = np.where(singular > FLAT * singular[0], 1.0 / np.maximum(singular, 1e-300), 0.0)
        cut = np.abs(rows[inverse == 0.0]).max(axis=0, initial=0.0) > FLAT
        # the Jacobian is that of residuals, which fall as a prediction rises
        gain = -(rows.T * inverse / sizes[:, None]) @ left.T @ self.whitening
        return np.where(cut[:, None], np.inf, gain), condition

    def _estimate(
        self,
        path: str,
        value: float,
        scale: float,
        variance: tuple[float, float],
        sources: Mapping[str, float],
        *,
        stated: bool,
    ) -> Estimate:
        """Return an estimate with its interval by Student's t; see `fit_several`."""
        from scipy import stats

        factor, freedom = variance
        sources = {
            name: part
            * (1.0 if name in self.spread.shared and not self.relative else math.sqrt(factor))
            for name, part in sources.items()
        }
        common = math.hypot(*(sources[name] for name in self.spread.shared))
        own = math.hypot(*(sources[name] for name in sources if name not in self.spread.shared))
        error = math.hypot(common, own)
        reason = ""
        if freedom == 0:
            spread, reason = math.inf, "too few readings to estimate their uncertainty"
        elif not math.isfinite(error) or error > 1e6 * max(abs(value), scale):
            spread, reason = math.inf, INSENSITIVE
        else:
            scattered = float(stats.t.ppf(0.975, freedom)) * own
            spread = math.hypot(scattered, float(stats.norm.ppf(0.975)) * common)
        quantity = self.known[path][0]
        least = max(quantity.low, quantity.above or 0.0, 0.0)
        return Estimate(
            path=path,
            quantity=quantity,
            value=value,
            low=max(value - spread, least) if math.isfinite(spread) else -math.inf,
            high=value + spread,
            interval="95 %",
            reason=reason,
            sources=sources if stated and not reason else {},
        )


def _correlation(gain: Array, covariance: Array) -> tuple[tuple[float, ...], ...]:
    """Return the correlation of estimates (p, p) from that of travels (n, n) and the gain (p, n).

    It is 0 with what the travels do not tell.
    """
    known = np.where(np.isfinite(gain), gain, 0.0)
    table = known @ covariance @ known.T
    sizes = np.sqrt(np.diag(table))
    table = table / np.outer(np.where(sizes > 0.0, sizes, 1.0), np.where(sizes > 0.0, sizes, 1.0))
    np.fill_diagonal(table, 1.0)
    return tuple(map(tuple, table.tolist()))
