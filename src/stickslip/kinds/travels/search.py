"""Weighted least squares on travels, with all values that explain them and their intervals."""

import math
from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip import formatting
from stickslip.errors import ConvergenceError
from stickslip.formatting import joined, number
from stickslip.identification import (
    Estimate,
    TravelModel,
    Trial,
    is_rig,
    spanning,
    standard_errors,
    under_cycles,
)
from stickslip.identify import (
    INSENSITIVE,
    Propagated,
    Start,
    agreeing_scale,
    covariance_of,
    descended,
    force_and_speed,
    plausible,
    propagated,
    room_for,
    slopes_of,
    spread_out,
    starting_points,
)
from stickslip.kinds.travels.profiles import profile_ends
from stickslip.kinds.travels.result import SIGNIFICANT, TravelFit, variance_of
from stickslip.quantities import Quantity, parameters

Array: TypeAlias = NDArray[np.float64]

STEP = 1e-4
"""Half the span of central differences over the size of a parameter; see `descent`."""
POLISHED = 3
"""Starting points that descents go on from, at most, where each run is slow or a mechanism is
unknown."""
POOR = 4.0
"""Mean square of standardised residuals beyond which, where a mechanism is unknown, searches begin
from all further starting points."""
STEPS, REFINED, BRIEF, FOLLOWED = 15, 4, 6, 8
"""Steps of a descent, at most: of a search, from a start that is already near, beside a draw of
nuisances, and of what follows another value."""
WEIGHINGS = 2
"""Fits by weights that follow from the fit before, where the mechanism is uncertain."""
NEAR = 100.0
"""Cost of a starting point over that of the best one beyond which no slow search begins there."""
LARGEST = 1e150
"""Size of residuals whose sum of squares is a number; readings of 0 weigh as much."""
FAILED = 1e6
"""Standardised residual of a run that cannot be made."""
MET = 1e-3
"""Standardised residual up to which a value gives a single travel."""
APART = 1e-3
"""Distance over their size from which values of two descents are told apart."""
STRIDES, ENOUGH = (1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0), 0.7
"""Lengths of an interval at which it is seen whether chi-square has risen by such a share of what
it should, which its third derivatives change."""
OUTWARDS = 1e-3
"""Least length of an interval by which its ends are looked for, over the size of the value."""
OTHER_SPEEDS = (1 / 16, 1 / 4, 4.0, 16.0)
"""Speeds from which descents are tried where the end of an interval seems to be met, over that
there."""
BESIDE = 6.0
"""Standard errors from the best values at which searches begin again: mean speeds and travels rise
and fall with a mechanism's parameters, and minima that fit as well lie side by side."""
INTERVALS = {"rounding": "rounding range", "interval": "stated interval", "standard": "95 %"}
"""What the interval of an estimate is called, by the kind of uncertainty of a single reading."""
SPAN, LEVELS, MANY, FEW = (0.3, 2.0), 48, 24, 8
"""Levels over those of a simpler law at which one with nuisances is scanned where it does not
explain the travels, how many they are beside one such level, and from how many of them descents
begin: from fewer where runs are of many cycles."""
WIDEST = 3.0
"""How many times as many levels are scanned, at most, where simpler laws have several."""
FEW_TRIALS = 3
"""Settings, from the shortest to the longest travel, that such a scan runs."""
STILL = 0.01
"""Largest predicted travel over the largest measured one below which nothing moves."""
UNSTATED = 0.02
"""Share of the travels up to which residuals count as small where no uncertainty was stated."""
FREED = 4
"""Drawn points from which descents free what was drawn, at most; one where runs are of many
cycles."""
TOGETHER = 0.95
"""Correlation beyond which two parameters are told in combination only."""
AS_WELL = 3.841458820694124
"""Chi-square over its least value up to which other values fit as well: 95 %."""
SAME = 1e-3
"""Share of that room within which the readings do not prefer one of two minima."""
LOWER = 0.05
"""Share of that room by which a point beside the best one has to explain more to be the best."""
ALIKE = 1e-3
"""Share by which the sums of squares of two points differ at most that are one and the same."""
CLOSE = 1e-6
"""Distance from a bound, over the size of a parameter, at which it counts as met."""
FLAT = 1e-6
"""Singular value over the largest, columns scaled, below which a direction is not identified, and
influence of a parameter over the largest below which it has none. Travels are rounded to some 1e-12
of their size, and their differences, which `descent.STEP` divides, to 1e-8."""


def fit_readings(
    model: TravelModel,
    trials: Sequence[Trial],
    starts: Sequence[Start] | None = None,
    nuisances: Sequence[str] = (),
    *,
    thorough: bool = False,
) -> TravelFit:
    """Fit the free parameters to all trials, and return the best point of all searches.

    One search serves one travel and several: descents from all points of a scan of the whole range
    that lead downhill. Values where others of them end and that explain the travels as well are
    told with the best ones, and intervals hold all of them.

    Intervals are those of Student's t distribution. With stated uncertainties that the residuals
    bear out, the standard errors are known, which is the limit of infinitely many degrees of
    freedom. Where no uncertainty is stated, or the residuals exceed it significantly, the variance
    is estimated from the residuals, and t has as many degrees of freedom as there are readings more
    than parameters; see `TravelFit.variance`. The interval of a single travel is what its stated
    range, or 95 % of its errors, leaves of the parameter.

    Uncertainties of the mechanism make the covariance of the travels, at a first fit without those
    that trials share: what was set for each trial adds to its variance, what trials share moves
    them together. Where residuals give the errors of the readings, weights follow the ratio of
    both.
    """
    problem = _Problem(model, trials)
    count = len(model.free)
    given = starting_points(model, trials) if starts is None else starts
    points = problem.unknowns([list(point)[:count] for point in given])
    ends = [*points] if nuisances and starts is not None else problem.ends(points)
    reached: list[list[float]] = []
    wide: _Problem | None = None
    if nuisances:
        moving = [end for end in ends if problem.moves(end)] or ends[:1]
        level = [(problem.matrix @ end).tolist() for end in moving]
        problem, wide, reached = _freed(model, trials, level, given, nuisances, thorough=thorough)
        model = problem.model
        ends = [problem.free_parameters(reached[0][:count])]
    best = problem.nearest(ends)
    if problem.rig:
        ends += [problem.polished(start, STEPS) for start in problem.beside(best)]
        best = min(ends, key=problem.cost)
    if problem.cost(best) >= FAILED**2:
        if len(trials) == 1:
            raise _no_value(model, trials[0])
        raise ConvergenceError(
            f"the search found no values of {', '.join(model.free)} with which every trial can"
            " be simulated."
        )
    if len(trials) == 1 and problem.cost(best) > MET**2:
        raise _no_value(model, trials[0])
    for _ in range(WEIGHINGS):
        if not problem.weighed(best):
            break
        best = min(best, problem.polished(best, REFINED), key=problem.cost)
    followed = wide is not None and not model.law.states
    found = problem.fit(best, ends, walked=not followed, reached=reached)
    return wide.followed(found, reached, problem) if wide is not None and followed else found


def _freed(
    model: TravelModel,
    trials: Sequence[Trial],
    ends: Sequence[Start],
    given: Sequence[Start],
    nuisances: Sequence[str],
    *,
    thorough: bool,
) -> tuple["_Problem", "_Problem", list[list[float]]]:
    """Return the problem with the nuisances that explain most, and that in which these are free.

    All values that explain as well follow, the best first. `ends` are values of the free
    parameters, and `given` may have some of the nuisances too. Nuisances of bristles, whose runs
    take long, are freed in a thorough search only.
    """
    count = len(model.free)
    wide = _Problem(replace(model, free=[*model.free, *nuisances]), trials)
    drawn = plausible(model, trials, ends[0], nuisances, thorough=thorough)
    more = [point for point in given if len(point) == len(wide.model.free)]
    cycles = under_cycles(trials)
    slow = (bool(model.law.states) and not thorough) or cycles
    few = bool(model.law.states) and not thorough
    beside = ends[: 1 if slow else 2]
    points = wide.drawn(beside, drawn, more[: 1 if few else FREED])
    own = np.arange(len(wide.model.free)) < count
    ends_of = wide.descend(points, REFINED if slow else BRIEF, own)
    plainest = ends_of[1][-len(drawn) * len(beside) :: len(drawn)]  # the first draw does least
    found = _sorted(*ends_of)
    if not model.law.states:
        most = 1 if cycles else FREED
        found = wide.with_free(found, most)
        # sticking makes branches that no simpler law leads to
        if wide.poor(found[0]) and wide.moves(found[0]):
            coarse = _Problem(wide.model, spread_out(trials, FEW_TRIALS))
            levels = [end[0] for end in ends if end[0] > 0.0] or [float(wide.scale[0])]
            scanned = coarse.scanned(points[-len(drawn) :], levels, FEW if cycles else MANY)
            ends_of = wide.descend(scanned, REFINED if cycles else BRIEF, own)
            found = wide.with_free([*found, *_sorted(*ends_of)], most)
    elif thorough:
        found = wide.with_free(found, FREED)
    least = wide.cost(found[0])
    found = wide.nearest_first(found, ends[0])
    whole = replace(model, law=wide.model.with_values((wide.matrix @ found[0]).tolist()))
    # a slope that a search ended beside 0 says nothing of its size
    problem = _Problem(whole, trials, wide.scale[:count])
    problem.spent, problem.plain = len(nuisances), float(min(plainest))
    limit = least + problem.room(least)
    reached = [(wide.matrix @ one).tolist() for one in found if wide.cost(one) <= limit]
    return problem, wide, reached


def _sorted(found: Array, costs: Array) -> list[Array]:
    """Return unknowns in the order of their costs."""
    return [*found[np.argsort(costs, kind="stable")]]


def _no_value(model: TravelModel, trial: Trial) -> ConvergenceError:
    """Return that no value of the one free parameter gives a single travel, and what it gives."""
    (path,) = model.free
    known = {name: (field, value) for name, field, value in parameters(model.law, "friction")}
    field, start = known[path]
    low, high = room_for(model.law, path.rpartition(".")[2])
    room = (
        f"above {number(low)}"
        if math.isinf(high)
        else (f"between {number(low)} and {number(high)}")
    )
    said = (
        f"no value of {path} ({field.symbol}) {room} gives a travel of {number(trial.travel)}"
        f" m; with {number(start)} the travel is"
        f" {formatting.quantity(model.travel(trial, [start]), 'm', 4)}."
    )
    try:
        model.check_rest([trial], [start], standard_errors([trial])[0])
    except ConvergenceError as error:
        said += f" With that value {error}"
    return ConvergenceError(said)


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

    def __init__(
        self, model: TravelModel, trials: Sequence[Trial], scale: Array | None = None
    ) -> None:
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
        values = [self.known[path][1] or 0.1 for path in model.free]
        self.scale = np.array(values) if scale is None else scale
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
        self.floor = np.full(len(model.free), -math.inf)
        """Values below which none is run."""
        self.spent, self.plain = 0, math.nan
        """Nuisances that residuals have paid for too, and what was left without them."""
        self._seen: dict[tuple[float, ...], Array] = {}

    def variance(self, cost: float) -> tuple[float, float]:
        """Return the variance of standardised residuals and its degrees of freedom.

        Where nuisances leave none, residuals that give the uncertainty of the readings are those of
        the law without them: what they take off may be noise.
        """
        freedom = len(self.trials) - len(self.model.free)
        if self.spent and not self.stated and freedom <= self.spent:
            return variance_of(self.plain, freedom, stated=False)
        return variance_of(cost, freedom - self.spent, stated=self.stated)

    def alone(self, i: int) -> "_Problem | None":
        """Return the problem in which a value that lies above another one is an unknown of its own.

        What it lies above is then told by how much that is less. None if more lies above the same.
        """
        base = int(np.flatnonzero(self.matrix[i] * (np.arange(len(self.scale)) != i))[0])
        if np.count_nonzero(self.matrix[:, base]) > 2:
            return None
        twin = copy(self)
        twin.matrix = self.matrix.copy()
        twin.matrix[i, base], twin.matrix[base, i], twin.matrix[base, base] = 0.0, 1.0, -1.0
        twin.floor = self.floor.copy()
        twin.floor[base] = self.least[base]
        order = np.arange(len(self.scale))
        order[[i, base]] = base, i
        twin.low, twin.high, twin.least = self.low[order], self.high[order], self.least[order]
        twin._seen = {}
        return twin

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

    def unknowns(self, points: Sequence[Start]) -> Array:
        """Return the unknowns (k, p) for values of the parameters, just inside their bounds."""
        return np.array([self.free_parameters(point) for point in points])

    def table(self, points: Array) -> Array:
        """Return the travels [m] (k, n) of k unknowns (k, p); NaN where a run cannot be made."""
        keys = [tuple(point) for point in points.tolist()]
        new = list(dict.fromkeys(key for key in keys if key not in self._seen))
        if new:
            values = np.maximum(np.array(new) @ self.matrix.T, self.floor)
            rows = self.model.table(self.trials, values)
            self._seen |= dict(zip(new, rows, strict=True))
        return np.array([self._seen[key] for key in keys])

    def residuals_of(self, points: Array) -> Array:
        """Return measured less predicted travels of k unknowns, whitened (k, n)."""
        left = self.measured - self.table(points)
        made = np.all(np.isfinite(left), axis=1, keepdims=True)
        found = np.clip(np.where(made, left, 0.0) @ self.whitening.T, -LARGEST, LARGEST)
        return np.where(made, found, FAILED)

    def predicted(self, free_parameters: Array) -> Array:
        """Return the travels [m] (n,); NaN where a run cannot be made."""
        return np.asarray(self.table(free_parameters[None])[0])

    def residuals(self, free_parameters: Array) -> Array:
        """Return measured less predicted travels, whitened (n,)."""
        return np.asarray(self.residuals_of(free_parameters[None])[0])

    def cost(self, free_parameters: Array) -> float:
        return float(np.sum(self.residuals(free_parameters) ** 2))

    def descend(
        self,
        points: Array,
        steps: int,
        moving: NDArray[np.bool_] | None = None,
        *,
        exact: bool = False,
    ) -> tuple[Array, Array]:
        """Return where descents end, and their costs; all unknowns move if not told."""
        return descended(
            self.residuals_of,
            points,
            low=self.least,
            high=self.high,
            sizes=0.1 * self.scale,
            moving=np.ones(len(self.scale), dtype=bool) if moving is None else moving,
            steps=steps,
            exact=exact,
        )

    def ends(self, points: Array) -> list[Array]:
        """Return where descents from points end, without those that met, the best first."""
        slow = self.rig or bool(self.model.law.states)
        steps = (STEPS if len(points) > 1 else REFINED) * (2 if self.rig else 1)
        if slow:
            costs = np.sum(self.residuals_of(points) ** 2, axis=1)
            order = np.argsort(costs, kind="stable")
            points, costs = points[order], costs[order]
            points = points[costs <= NEAR * costs[0]]
            found, costs = self.descend(points[:POLISHED], steps)
            if self.rig and costs.min() > POOR * len(self.trials) and len(points) > POLISHED:
                more, others = self.descend(points[POLISHED:], steps)
                found, costs = np.concatenate([found, more]), np.concatenate([costs, others])
        else:
            found, costs = self.descend(points, steps)
        order = np.argsort(costs, kind="stable")
        found, costs = found[order], costs[order]
        if not slow:
            worth = costs <= costs[0] + 4.0 * self.room(float(costs[0]))
            found, costs = self.descend(found[worth], REFINED, exact=True)
            order = np.argsort(costs, kind="stable")
            found, costs = found[order], costs[order]
        apart: list[Array] = []
        for one in found:
            size = np.maximum(np.abs(one), 0.1 * self.scale)
            if all(np.max(np.abs(one - other) / size) > APART for other in apart):
                apart.append(one)
        return apart

    def nearest(self, ends: Sequence[Array]) -> Array:
        """Return the best end; of those that readings do not tell apart, that near the start."""
        if self.rig or len(ends) == 1:
            return ends[0]
        path = self.model.free[0]
        start = float(getattr(self.model.law, path.rpartition(".")[2]) or 0.0)
        least = self.cost(ends[0])
        limit = least + SAME * self.room(least)
        alike = [end for end in ends if self.cost(end) <= limit]
        return min(alike, key=lambda end: abs(float((self.matrix @ end)[0]) - start))

    def nearest_first(self, found: Sequence[Array], level: Start) -> list[Array]:
        """Return unknowns, the best first; of those that explain alike, that nearest to a level.

        Which of these leaves least is rounding, and so is which of those with one level is nearest.
        """
        least = self.cost(found[0])
        limit = least + SAME * self.room(least)

        def order(one: Array) -> tuple[float, ...]:
            off = np.array([abs(one[0] - level[0]), *one[1:]]) / self.scale
            return tuple(np.round(off / APART).tolist())

        first = min((one for one in found if self.cost(one) <= limit), key=order)
        return [first, *(one for one in found if one is not first)]

    def with_free(self, found: Sequence[Array], most: int) -> list[Array]:
        """Return unknowns with where descents from the best of them end, the best first.

        Of those that leave the same, as all do that make a simpler law of it, one descends.
        """
        best = sorted(found, key=self.cost)
        costs = np.array([self.cost(one) for one in best])
        first = np.diff(costs, prepend=-np.inf) > ALIKE * costs
        apart = [one for one, new in zip(best, first.tolist(), strict=True) if new]
        free, _ = self.descend(np.array(apart[:most]), STEPS)
        return sorted([*best, *free], key=self.cost)

    def moves(self, free_parameters: Array) -> bool:
        """Whether anything moves: nothing is found beside values with which all trials stand."""
        least = STILL * float(np.max(np.abs(self.measured)))
        return not np.all(np.abs(self.predicted(free_parameters)) < least)

    def poor(self, free_parameters: Array) -> bool:
        """Whether unknowns leave more than the errors of the readings."""
        from scipy.stats import chi2

        if not self.stated:
            left = self.measured - self.predicted(free_parameters)
            return not np.linalg.norm(left) <= UNSTATED * np.linalg.norm(self.measured)
        return self.cost(free_parameters) > float(chi2.ppf(SIGNIFICANT, len(self.trials)))

    def scanned(self, points: Array, levels: Sequence[float], most: int) -> Array:
        """Return the best of many values of the first unknown beside the others of each point.

        They reach beyond all levels of simpler laws: travels that rise and fall with the level have
        several, and friction at rest moves these.
        """
        low, high = SPAN[0] * min(levels), SPAN[1] * max(levels)
        share = math.log(high / low) / math.log(SPAN[1] / SPAN[0])
        tried = np.geomspace(low, high, math.ceil(LEVELS * min(share, WIDEST)))
        rows = np.repeat(points, len(tried), axis=0)
        rows[:, 0] = np.tile(tried, len(points))
        rows = np.clip(rows, self.least, self.high)
        costs = np.sum(self.residuals_of(rows) ** 2, axis=1)
        return rows[np.argsort(costs, kind="stable")[:most]]

    def room(self, cost: float) -> float:
        """Return how much more than the least cost values may leave that explain as well."""
        from scipy import stats

        trials = self.trials
        if len(trials) == 1:
            kind = trials[0].kind
            if kind == "standard" or self.spread.own or self.spread.shared:
                return AS_WELL
            return 3.0 if kind == "rounding" else 1.0
        factor, freedom_of = self.variance(cost)
        if freedom_of == 0.0:
            return AS_WELL
        return factor * float(stats.t.ppf(0.975, freedom_of)) ** 2

    def drawn(self, ends: Sequence[Start], drawn: Array, more: Sequence[Start]) -> Array:
        """Return unknowns for each end of a search without nuisances beside each draw of them."""
        rows = [self.free_parameters(point) for point in more]
        count = len(self.scale) - drawn.shape[1]
        for end in ends:
            start = np.zeros(len(self.scale))
            # what a nuisance lies above is part of its value, and not of its unknown
            start[:count] = np.linalg.solve(self.matrix[:count, :count], np.asarray(end))
            for draw in drawn:
                start[count:] = draw
                rows.append(np.clip(start, self.least, self.high))
        return np.array(rows)

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
        return np.asarray(
            slopes_of(
                self.residuals_of,
                free_parameters[None],
                self.residuals(free_parameters)[None],
                low=self.low,
                high=self.high,
                sizes=0.1 * self.scale,
                moving=np.ones(len(self.scale), dtype=bool),
            )[0]
        )

    def polished(self, start: Array, steps: int) -> Array:
        """Return where a descent ends that begins at `start`."""
        found, _ = self.descend(start[None], steps)
        return np.asarray(found[0])

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

    def fit(
        self,
        best: Array,
        ends: Sequence[Array] = (),
        *,
        walked: bool = False,
        reached: Sequence[Start] = (),
    ) -> TravelFit:
        """Return what the best unknowns are, with intervals."""
        single = len(self.trials) == 1
        residuals = self.residuals(best)
        values = (self.matrix @ best).tolist()
        gain, condition = self._gain(best)
        variance = self.variance(float(np.sum(residuals**2)))
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
        rivals = self._rivals(found, best, ends)
        if not self.rig:
            found = self._together(found)
            wider = [[(one.low, one.high)] for one in found]
            if walked:
                starts = [best, *map(self.free_parameters, rivals)]
                wider, lowest = self._between(found, starts)
                if self.cost(lowest) < self.cost(best) - LOWER * self.room(self.cost(best)):
                    return self.fit(self.polished(lowest, STEPS), [best, *ends], walked=True)
            found = [
                self._holding(i, one, parts, reached)
                for i, (one, parts) in enumerate(zip(found, wider, strict=True))
            ]
        else:
            found = [self._reaching(one, [r[i] for r in rivals]) for i, one in enumerate(found)]
        others = tuple(rival[0] for rival in rivals) if len(values) == 1 and not self.rig else ()
        return TravelFit(
            law=self.model.with_values(values),
            mechanism=self.model.set_up(self.trials[0], values).mechanism,
            estimates=tuple(found),
            measured=tuple(self.measured.tolist()),
            predicted=tuple(self.predicted(best).tolist()),
            others=others,
            standard_errors=() if single else tuple(scatter.tolist()),
            reading_errors=() if single else tuple(self.readings.tolist()),
            slopes=() if single else self._slopes(best),
            shared={path: tuple(part.tolist()) for path, part in self.spread.shared.items()},
            stated=self.stated,
            condition=condition,
            correlation=correlation,
            rivals=() if others else rivals,
            trials=tuple(self.model.set_up(trial, values) for trial in self.trials),
            runs=self.model.runs,
        )

    def _together(self, found: Sequence[Estimate]) -> list[Estimate]:
        """Return estimates without the intervals of static levels beside a speed that is open.

        A static level is told together with the speed up to which it acts, along a curve. Bristles
        take too long to follow it, and slopes hold beside the best speed only.
        """
        speeds = [
            one.quantity.symbol
            for one in found
            if one.quantity.scale == "speed" and not (one.bounded and one.low > self._lowest(one))
        ]
        if not speeds or not self.model.law.states or len(self.trials) < 2:
            return [*found]
        reason = f"the trials tell it together with {joined(speeds)} only"
        above = np.count_nonzero(self.matrix, axis=1) > 1
        return [
            replace(one, low=-math.inf, high=math.inf, reason=reason, sources={}) if open_ else one
            for one, open_ in zip(found, above.tolist(), strict=True)
        ]

    def _holding(
        self,
        i: int,
        one: Estimate,
        parts: Sequence[tuple[float, float]],
        reached: Sequence[Start],
    ) -> Estimate:
        """Return an estimate whose interval holds all values that explain the travels as well."""
        single = len(self.trials) == 1
        if one.reason and (not single or not self.stated):
            return one
        reason = one.reason if not single else ""
        if not all(math.isfinite(end) for end in parts[0]):
            reason = INSENSITIVE
            if single:
                reason = "no value gives the travel at one end of the range of the reading"
        low, high = parts[0]
        half = 0.5 * (high - low) if one.bounded else 0.0
        parts = [*parts, *((value[i] - half, value[i] + half) for value in reached)]
        return spanning(replace(one, reason=reason), parts, self._lowest(one))

    def followed(self, fit: TravelFit, reached: Sequence[Start], narrow: "_Problem") -> TravelFit:
        """Return a fit whose intervals end where no values of nuisances explain the travels more.

        The nuisances are the last unknowns here. Bristles take too long for that. They stay
        plausible: speeds below the largest of a run, beyond which more friction at rest is another
        name of the level.
        """
        best = self.free_parameters(reached[0])
        least = self.cost(best)
        told = [i for i, one in enumerate(fit.estimates) if not one.reason]
        _, speed = force_and_speed(self.model, self.trials, reached[0])
        for i, path in enumerate(self.model.free):
            if self.known[path][0].scale == "speed":
                self.high[i] = max(speed, float(best[i]))
        first = [0.5 * (e.high - e.low) if e.bounded else math.inf for e in fit.estimates]
        values = np.array(reached)[:, told]
        # a valley of its own may begin where the best values have no slopes: those of a simpler law
        farthest = {0, *values.argmin(axis=0).tolist(), *values.argmax(axis=0).tolist()}
        starts = [self.free_parameters(reached[one]) for one in sorted(farthest)]
        ends, _ = self._ends(starts, told, first, least + narrow.room(least))
        found = [*fit.estimates]
        for i, own in zip(told, ends, strict=True):
            one, reason = found[i], ""
            if not all(math.isfinite(end) for part in own for end in part):
                reason = INSENSITIVE
            parts = [*(one.pieces or ((one.low, one.high),)), *own]
            found[i] = spanning(replace(one, reason=reason), parts, self._lowest(one))
        return replace(fit, estimates=tuple(found), runs=self.model.runs + fit.runs)

    def _between(
        self, found: Sequence[Estimate], starts: Sequence[Array]
    ) -> tuple[list[list[tuple[float, float]]], Array]:
        """Return what each estimate lies between from each start, and the best of all points.

        The others follow. Slopes at the best values say nothing of what is farther away, nor that
        a parameter has a bound. Bristles take too long for that.
        """
        single, (best, *others) = len(self.trials) == 1, starts
        base = self.cost(best)
        wider = [[(one.low, one.high)] for one in found]
        if bool(self.model.law.states) and not single:
            for i, parts in enumerate(wider):
                parts += [self._local(i, there) for there in others]
            return wider, best
        told = [i for i, one in enumerate(found) if not one.reason or (single and self.stated)]
        ends, lowest = self._ends(starts, told, [math.inf] * len(found), base + self.room(base))
        for i, parts in zip(told, ends, strict=True):
            one, (low, high) = found[i], parts[0]
            if not single and one.bounded and (self.spread.own or self.spread.shared):
                # the ends bend as chi-square does, but residuals scale no uncertainty of the
                # mechanism
                half = self._halves(best)[i]
                low = one.value - (one.value - low) / half * (one.value - one.low)
                high = one.value + (high - one.value) / half * (one.high - one.value)
            wider[i] = [(low, high), *parts[1:]]
        return wider, lowest

    def _halves(self, there: Array) -> Array:
        """Return half the interval of each value, of 95 %, that slopes at some unknowns give."""
        return np.sqrt(self.room(self.cost(there)) * np.diag(self._table(there)))

    def _table(self, there: Array) -> Array:
        """Return the covariance of values (p, p) that slopes at some unknowns give."""
        gain, _ = self._gain(there)
        known = np.where(np.isfinite(gain), gain, 0.0)
        return np.asarray(known @ self._covariance() @ known.T)

    def _ends(
        self, starts: Sequence[Array], told: Sequence[int], most: Sequence[float], target: float
    ) -> tuple[list[list[tuple[float, float]]], Array]:
        """Return the ends of intervals of some values from each start, and the best of all points.

        All walks are one ensemble. What lies above another value is an unknown in a problem of its
        own. `most` has the lengths of the first steps, at most.
        """
        above = np.count_nonzero(self.matrix, axis=1) > 1
        ends, lowest = self._walked(starts, [i for i in told if not above[i]], most, target)
        for i in told:
            if not above[i]:
                continue
            twin = self.alone(i)
            if twin is None:
                ends[i] = [self._local(i, one) for one in starts]
                continue
            there = [
                np.linalg.solve(twin.matrix, self.matrix @ one).astype(float) for one in starts
            ]
            found, low = twin._walked(there, [i], most, target)
            ends[i] = found[i]
            back = self.free_parameters((twin.matrix @ low).tolist())
            lowest = min(lowest, back, key=self.cost)
        return [ends[i] for i in told], lowest

    def _walked(
        self, starts: Sequence[Array], told: Sequence[int], most: Sequence[float], target: float
    ) -> tuple[dict[int, list[tuple[float, float]]], Array]:
        """Return the ends from each start of values that are unknowns, and the best point."""
        lowest = min(starts, key=self.cost)
        if not told:
            return {}, lowest
        along = []
        for there in starts:
            table = self._table(there)
            for i in told:
                half, way = (
                    math.sqrt(self.room(self.cost(there)) * table[i, i]),
                    np.zeros(len(there)),
                )
                if half > 0.0:
                    way = np.linalg.solve(self.matrix, table[:, i] / table[i, i])
                way[i] = 1.0
                size = max(min(half, most[i]), OUTWARDS * float(self.scale[i]))
                along += [-size * way, size * way]
        seen = [lowest]

        def descend(points: Array, moving: NDArray[np.bool_]) -> tuple[Array, Array]:
            found, costs = self.descend(points, FOLLOWED, moving)
            seen[0] = min(seen[0], found[np.argmin(costs)], key=self.cost)
            return found, costs

        at = np.tile(np.repeat(told, 2), len(starts))
        inside, outside, share = profile_ends(
            descend,
            np.repeat(np.array(starts), 2 * len(told), axis=0),
            at,
            np.array(along),
            low=self.least,
            high=self.high,
            least=min(map(self.cost, starts)),
            target=target,
            again=self._turned,
        )
        one, other = (points[np.arange(len(at)), at] for points in (inside, outside))
        if len(self.scale) == 1:  # nothing follows: the end is that of a curve
            ends = [self._crossing(*pair, target) for pair in zip(one, other, strict=True)]
        else:
            ends = np.where(np.isfinite(other), one + share * (other - one), other).tolist()
        pairs = np.array(ends).reshape(len(starts), len(told), 2)
        return {
            i: [(float(low), float(high)) for low, high in pairs[:, k]] for k, i in enumerate(told)
        }, seen[0]

    def _crossing(self, inside: float, outside: float, target: float) -> float:
        """Return the single unknown between two at which the cost meets the target."""
        from scipy.optimize import brentq

        def excess(value: float) -> float:
            return self.cost(np.array([value])) - target

        if not math.isfinite(outside) or excess(inside) >= 0.0:
            return outside if math.isinf(outside) else inside
        if excess(outside) <= 0.0:
            return outside
        return float(brentq(excess, inside, outside, rtol=1e-10, xtol=1e-300))

    def _turned(self, there: Array) -> Array:
        """Return unknowns, and the same with other powers of the speed and other speeds.

        On these travels do not depend as on a level or a slope: descents end in the valley where
        they begin.
        """
        rows = [there]
        for i, path in enumerate(self.model.free):
            scale = self.known[path][0].scale
            others: Sequence[float] = ()
            if scale == "none":
                others = (self.least[i], self.high[i])
            elif scale == "speed":
                others = there[i] * np.array(OTHER_SPEEDS)
            for value in others:
                rows.append(there.copy())
                rows[-1][i] = np.clip(value, self.least[i], self.high[i])
        return np.array(rows)

    def _local(self, i: int, there: Array) -> tuple[float, float]:
        """Return the interval of a value that slopes at some unknowns give."""
        value, half = float((self.matrix @ there)[i]), float(self._halves(there)[i])
        return value - half, value + half

    def _lowest(self, one: Estimate) -> float:
        return max(one.quantity.low, one.quantity.above or 0.0, 0.0)

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
        self, found: Sequence[Estimate], best: Array, ends: Sequence[Array]
    ) -> tuple[tuple[float, ...], ...]:
        """Return other values where a search ended that fit as well, outside of the intervals."""
        least = self.cost(best)
        room = least + (MET**2 if len(self.trials) == 1 else self.room(least))
        rivals: list[tuple[float, ...]] = []
        for end in ends:
            values = tuple((self.matrix @ end).tolist())
            outside = any(
                not e.low <= v <= e.high if e.bounded else abs(v - e.value) > APART * abs(e.value)
                for e, v in zip(found, values, strict=True)
            )
            if outside and self.cost(end) <= room:
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
        slopes = -np.linalg.solve(self.whitening, self.slopes_at(best)).astype(float)
        margin = CLOSE * self.scale
        inside = (best > self.least + margin) & (best < self.high - margin)
        free = np.isfinite(slopes).all(axis=0) & inside
        sizes: Array = np.maximum(np.abs(best), self.scale)
        free[free] = _moving(slopes[:, free], sizes[free])
        return tuple(map(tuple, np.where(free, slopes, 0.0).tolist()))

    def _gain(self, best: Array) -> tuple[Array, float]:
        """Return derivatives of values by travels (p, n), and the condition of the scaled Jacobian.

        A value on which a direction bears that the travels do not determine has infinite ones.
        """
        jacobian = self.slopes_at(best) @ np.linalg.inv(self.matrix)
        gain = np.full(jacobian.shape[::-1], np.inf)
        sizes = np.linalg.norm(jacobian, axis=0)
        if not np.all(np.isfinite(jacobian)) or not np.any(sizes > 0.0):
            return gain, math.inf
        # what travels do not depend on at all bears on nothing else
        seen = _moving(jacobian, np.maximum(np.abs(self.matrix @ best), self.scale))
        left, singular, rows = np.linalg.svd(jacobian[:, seen] / sizes[seen], full_matrices=False)
        condition = float(singular[0] / max(singular[-1], 1e-300)) if seen.all() else math.inf
        inverse = np.where(singular > FLAT * singular[0], 1.0 / np.maximum(singular, 1e-300), 0.0)
        cut = np.abs(rows[inverse == 0.0]).max(axis=0, initial=0.0) > FLAT
        # the Jacobian is that of residuals, which fall as a prediction rises
        known = -(rows.T * inverse / sizes[seen, None]) @ left.T @ self.whitening
        gain[seen] = np.where(cut[:, None], np.inf, known)
        return gain, condition

    def _kind(self) -> str:
        """Return of which kind the uncertainty of a single reading is, the rig's included."""
        return "standard" if self.spread.own or self.spread.shared else self.trials[0].kind

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
        """Return an estimate with its interval by Student's t; see `fit_readings`."""
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
            if len(self.trials) == 1:
                reason = "no uncertainty of the reading was stated"
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
            interval="95 %" if len(self.trials) > 1 else INTERVALS[self._kind()],
            reason=reason,
            sources=sources if stated and not reason else {},
        )


def _moving(slopes: Array, sizes: Array) -> NDArray[np.bool_]:
    """Return which unknowns of some sizes move travels by more than these are rounded."""
    moved = np.linalg.norm(slopes, axis=0) * sizes
    return np.asarray(moved > FLAT * np.max(moved, initial=0.0))


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
