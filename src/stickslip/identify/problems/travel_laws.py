r"""Laws fitted to travels: coefficients by least squares, shapes on a grid.

A law is told from travels by its *coefficients*: a level, slopes with speed, a static surplus.
What they hardly tell, its *shape* (speeds, exponents, bristles), is tried on a grid of plausible
values. For each shape the coefficients :math:`c` minimise

.. math:: \sum_i \frac{(T_i - T(s_i; c))^2}{\sigma_i^2} + \sum_j \frac{(c_j - m_j)^2}{\tau_j^2},

by damped Gauss-Newton descents, all shapes in one ensemble of runs. The second
sum is a prior, as wide as what is plausible: slopes that double friction at the largest speed, a
surplus of half the level. The level has none. Searches begin at the levels where a scan of the
leading coefficient explains the travels best; a body that swings before it rests has several.
Parameters of the mechanism may be unknown too: they are coefficients with a prior about the value
that was given, and searches begin at points drawn about it, since a resonance lies elsewhere with
another stiffness.
"""

import itertools
import math
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from stickslip.engine.trajectory import Trajectory
from stickslip.friction import FrictionLaw
from stickslip.identify.bands import Array
from stickslip.identify.fits import TravelModel, Trial, is_rig, required_of, under_cycles
from stickslip.identify.simulated import SETTLED, Descents
from stickslip.mechanisms import slip_names, slip_of
from stickslip.quantities import Quantity, fields_of, parameters

LEVELS = np.geomspace(1e-5, 1e5, 61)
"""Leading coefficients at which it is first looked whether anything moves."""
FINE, SPAN = 240, 300.0
"""Levels of the scan, and its largest over its smallest."""
HOLDING = 10.0
"""Level that holds the body over the least one by which priors are scaled."""
RESOLVED = 1e-3
"""Share of the travels below which none is resolved: a body stands, and nobody reads better where
no uncertainty was stated."""
POOR = 0.01
"""Share of the squared travels that the best level leaves from which others are tried too."""
BRANCHES = 4
"""Levels from which searches begin, at most."""
SPEEDS = (0.03, 0.1, 0.25, 0.6)
"""Speeds of shapes over the largest one of a run."""
STIFFNESSES = (1e3, 1e5)
"""Stiffness of bristles over the level [1/m]."""
SOFT = (10.0, 100.0)
"""The same, tried too where the stiffness is named: no law is judged by bristles that soft."""
EXPONENTS = (0.33, 0.5, 1.5, 2.0)
"""Powers of the speed."""
DAMPING = 0.18
"""Damping of bristles over the root of their stiffness and of the level [s/m^.5]."""
LEADING, SURPLUS, SIDES = 3.0, 0.5, 0.3
"""Prior spread of the leading coefficient, over itself; of a static surplus, and of differences
between directions, over the level."""
TRIED = np.geomspace(0.25, 1.3, 10)
"""Levels over that of a branch from which laws with more than a level are tried."""
SHARES = (0.05, 0.5, 1.5)
"""The same of further coefficients, over their prior spread."""
DRAWN, AROUND = 256, 3.0
"""Points that are drawn where parameters of the mechanism are unknown, and the factor from the
values that were given up to which they lie."""
POINTS = 64
"""Combinations that are tried of each shape, at most; half where runs are of many cycles."""
STEPS = 8
"""Steps of a descent."""
STEP = 1e-4
"""Step of finite differences over the size of an unknown: runs with bristles are exact to 1e-8, and
the error of a one-sided difference is then about as small as it can be."""
REFINED, WIDE = 3, 2.0
"""Shapes that are fitted too, from the best of the grid, and as many settings at which starts are
tried; and the prior spread of shapes over themselves."""
FAILED = 1e6
"""Standardised residual of a run that cannot be made."""
SAMPLES = 2001
"""Times at which a run is looked at."""
APART, WORSE = 1e-2, 20.0
"""Relative distance from which minima are apart, and how much worse the best may leave them."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Size:
    """Sizes that follow from the leading coefficient that fits alone."""

    levels: Sequence[float]
    """Levels at which it explains the travels best, the best first."""
    level: float
    """A level as large as friction may be: of the best, or a part of that which holds the body."""
    force: float
    """Friction with it [N]."""
    speed: float
    """Largest speed of a run with it [m/s]."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TravelStructure:
    """A law in one shape, fitted to the travels."""

    law: "TravelLaw"
    count: int
    """Number of coefficients: those of the law, or all parameters where the shape is fitted too."""
    unknowns: Array
    """Coefficients and shape (p,): what must lie above another, by how much it does."""
    predicted: Array
    """Travels (n,) [m]."""
    slopes: Array
    """Their derivatives by the coefficients (n, c)."""
    means: Array
    """Prior means of the coefficients (c,); of the leading one its value."""
    precisions: Array
    """Inverse prior variances (c,)."""


@dataclass(eq=False)
class TravelLaw:
    """A law as travels tell it."""

    name: str
    law: FrictionLaw
    trials: Sequence[Trial]
    t_end: float
    model: TravelModel
    count: int
    """Number of coefficients, which come before the shape."""
    quantities: Sequence[Quantity]
    """What the unknowns are (p,)."""
    matrix: Array
    """Values from unknowns (p, p)."""
    means: Array
    """Prior means of the unknowns (p,); 0 where none was given."""
    named: Collection[str] = ()
    """Names of parameters that were asked for one by one."""
    thorough: bool = False
    """Whether a law with bristles is searched as others are, whatever its runs take."""
    structures: list[TravelStructure] = field(default_factory=list)
    measured: Array = field(default_factory=lambda: np.zeros(0))
    """Travels (n,) [m] that it was fitted to."""
    errors: Array = field(default_factory=lambda: np.zeros(0))
    """Their standard errors as they weighed [m]."""
    tried: Array = field(default_factory=lambda: np.zeros((1, 0)))
    """Shapes that were tried (k, p - c)."""
    typical: Array = field(default_factory=lambda: np.zeros(0))
    """Typical shape (p - c,), if shapes are fitted too."""

    @classmethod
    def of(
        cls,
        name: str,
        law: FrictionLaw,
        trials: Sequence[Trial],
        t_end: float,
        *,
        held: Collection[str],
        given: bool,
        guessed: Collection[str] = (),
        named: Collection[str] = (),
        rig: Sequence[str] = (),
        watch: Callable[[int], object] | None = None,
    ) -> "TravelLaw":
        """Return a law with the parameters that are not held; values that were given are means.

        `rig` are paths of parameters of the mechanism that are unknown too.
        """
        known = fields_of(type(law))
        again = [  # it breaks away in every cycle, which tells the level at rest too
            item for item, x in known.items()
            if x.scale == "level" and x.at_least is not None and under_cycles(trials)
        ]  # fmt: skip
        names = dict.fromkeys([*law.fit_order, *required_of(type(law)), *again, *named])
        coefficients, shape = list[str](), list[str]()
        for entry in names:
            scale, absent = known[entry].scale, getattr(law, entry) is None
            if entry in held or absent or (scale in ("slope+", "slope-") and entry not in named):
                continue
            if scale.rstrip("+-") in ("level", "slope", "drag"):
                coefficients.append(entry)
            elif not (scale == "none" and law.states) or entry in named:
                shape.append(entry)
        own = {p: (q, v) for p, q, v in parameters(trials[0].mechanism, "mechanism")}
        both = [*coefficients, *rig, *shape]
        matrix = np.eye(len(both))
        values = np.array([own[x][1] if x in rig else float(getattr(law, x)) for x in both])
        for i, entry in enumerate(coefficients):
            base = known[entry].at_least or entry.replace("backward", "forward")
            if base in coefficients and base != entry:
                matrix[i, coefficients.index(base)] = 1.0
        means = np.linalg.solve(matrix, values) if given else np.zeros(len(both))
        means[len(coefficients) : len(both) - len(shape)] = [own[item][1] for item in rig]
        # a shape that was guessed is tried on the grid
        means[[i for i, item in enumerate(both) if item in shape and item in guessed]] = 0.0
        return cls(
            name=name, law=law, trials=trials, t_end=t_end,
            model=TravelModel(
                law, [x if x in rig else f"friction.{x}" for x in both], t_end, watch
            ),
            count=len(coefficients) + len(rig), matrix=matrix, means=means, named=named,
            quantities=[own[x][0] if x in rig else known[x] for x in both],
        )  # fmt: skip

    @property
    def names(self) -> list[str]:
        """Names of the parameters (p,), those of the shape last."""
        return [path.rpartition(".")[2] for path in self.model.free]

    @property
    def rig(self) -> NDArray[np.bool_]:
        """Which unknowns (p,) are parameters of the mechanism."""
        return np.array([is_rig(path) for path in self.model.free])

    @property
    def slow(self) -> bool:
        """Whether runs take long: the law has bristles."""
        return bool(self.law.states) and not self.thorough

    def values(self, unknowns: Array) -> Array:
        """Return the values (k, p) of unknowns (k, p)."""
        # what must be above a limit is, where a linear step ends at it
        limits = [
            0.0 if quantity.above is None else quantity.above + 1e-9 for quantity in self.quantities
        ]
        least = np.maximum([max(quantity.low, 0.0) for quantity in self.quantities], limits)
        least[self.rig] = self._ends[0][self.rig]
        if len(self.typical):  # a linear step may lead a shape that was fitted below 0
            least[self.count :] = np.maximum(least[self.count :], RESOLVED * self.typical)
        return np.asarray(np.maximum(unknowns @ self.matrix.T, least))

    def table(self, trials: Sequence[Trial], unknowns: Array) -> Array:
        """Return the travels (k, n) [m] with unknowns (k, p); NaN where no run is made."""
        return self.model.table(trials, self.values(unknowns))

    def with_unknowns(self, unknowns: Array) -> FrictionLaw:
        """Return the law with other unknowns (p,)."""
        return self.model.with_values(self.values(unknowns).tolist())

    def scanned(self) -> tuple[list[float], float]:
        """Return values of the leading coefficient that explain the travels best, the best first.

        The second is the least value with which hardly anything moves.

        Values at which anything moves are found on a coarse grid, from which a fine one goes down.
        """
        measured = np.array([trial.travel for trial in self.trials])
        low, high = room_for(self.law, self.names[0], self.names)
        rest = np.zeros(len(self.names) - 1)

        def travels(levels: Array) -> Array:
            rows = np.column_stack([levels, np.tile(rest, (len(levels), 1))])
            result = self.table(self.trials, np.clip(rows, low, None))
            return np.where(np.isfinite(result), result, np.inf)

        tried = LEVELS[(low <= LEVELS) & (high >= LEVELS)]
        coarse, still = travels(tried), float(np.mean(measured**2))
        moving = np.isfinite(coarse) & (coarse**2 > RESOLVED**2 * still)
        # at a resonance what is driven moves whatever its friction: there in half of the trials
        moves = moving.mean(axis=1) >= 0.5 if under_cycles(self.trials) else moving.any(axis=1)
        top = tried[min(int(np.flatnonzero(moves).max(initial=0)) + 1, len(tried) - 1)]
        best = tried[int(np.argmin(np.mean((coarse - measured) ** 2, axis=1)))]
        fine = np.geomspace(min(top / SPAN, best / 3.0), min(top, high), FINE)
        results = np.mean((travels(fine) - measured) ** 2, axis=1)
        padded = np.pad(results, 1, constant_values=np.inf)
        valleys = np.flatnonzero(
            (results <= padded[:-2]) & (results <= padded[2:]) & (results < still)
        )
        order = valleys[np.argsort(results[valleys], kind="stable")]
        levels = [float(fine[i]) for i in order[:BRANCHES]]
        if not levels or float(results.min()) > POOR * still:  # other coefficients move these
            levels += np.geomspace(10.0 * top / SPAN, top, BRANCHES).tolist()
        return levels, float(top)

    def size(self, levels: Sequence[float], top: float) -> Size:
        """Return sizes with the leading coefficient at the first of some levels."""
        # of what is driven, hardly any motion may be nearer to the travels than another: no size
        best = 0.0 if under_cycles(self.trials) else levels[0]
        level = max(best, top / HOLDING)
        longest = max(self.trials, key=lambda item: abs(item.travel))
        law = self.model.with_values([level, *self.means[1:].tolist()])
        run = longest.simulated(law, self.t_end)
        force = level * float(np.median(run["normal_force"]))
        speed = max(top_speed(longest, run), 1e-6)
        return Size(levels=levels, level=level, force=force, speed=speed)

    def shapes(self, size: Size) -> Array:
        """Return the shapes that are plausible (k, p - c); one that is empty without any."""
        level = size.level
        axes: list[Sequence[float]] = []
        scales = [quantity.scale for quantity in self.quantities[self.count :]]
        for name, scale, mean in zip(
            self.names[self.count :], scales, self.means[self.count :], strict=True
        ):
            given = float(mean)
            if given:
                axes.append([given])
            elif scale == "speed":
                axes.append([share * size.speed for share in SPEEDS[:: 2 if self.slow else 1]])
            elif scale == "stiffness":
                factors = (*SOFT, *STIFFNESSES) if name in self.named else STIFFNESSES
                axes.append([factor * level for factor in factors])
            elif scale == "damping":
                axes.append([math.nan])
            else:
                axes.append(EXPONENTS[1::2] if under_cycles(self.trials) else EXPONENTS)
        rows = np.array(list(itertools.product(*axes)), dtype=float)
        for k, scale in enumerate(scales):
            if scale == "damping":  # goes with the root of the stiffness beside it
                stiff = [other == "stiffness" for other in scales]
                of = rows[:, stiff.index(True)] if any(stiff) else np.full(len(rows), 1e4 * level)
                rows[:, k] = np.where(
                    np.isnan(rows[:, k]), DAMPING * np.sqrt(of * level), rows[:, k]
                )
        return rows

    def spreads(self, size: Size, points: Array) -> Array:
        """Return prior spreads (k, c) of coefficients of points (k, p); infinite of the first."""
        result = np.full((len(points), self.count), np.inf)
        exponent = np.ones(len(points))
        for i, quantity in enumerate(self.quantities):
            if i >= self.count and quantity.scale == "none":
                exponent = points[:, i]
        for i, unknown in enumerate(self.rig[: self.count]):
            scale = self.quantities[i].scale
            if unknown:
                result[:, i] = LEADING * (abs(self.means[i]) or 1.0)
            elif i == 0:
                continue
            elif scale.endswith("-"):
                result[:, i] = SIDES * size.level
            elif scale.startswith("slope"):
                result[:, i] = size.force / size.speed**exponent
            elif scale == "drag":
                result[:, i] = size.force / size.speed**2
            else:
                result[:, i] = SURPLUS * size.level
        return result

    @cached_property
    def _ends(self) -> tuple[Array, Array]:
        """Least and largest values of the unknowns (p,) that the law and the mechanism allow."""
        pairs = []
        for path, quantity, mean in zip(self.model.free, self.quantities, self.means, strict=True):
            if is_rig(path):
                least = (
                    quantity.low
                    if quantity.above is None
                    else quantity.above + RESOLVED * abs(mean)
                )
                pairs.append((least, quantity.high))
            else:
                pairs.append(room_for(self.law, path.rpartition(".")[2], self.names))
        low, high = np.array(pairs, dtype=float).T
        return low, high

    def bounds(self, size: Size) -> tuple[Array, Array]:
        """Return the least and largest unknowns (p,)."""
        low, high = (ends.copy() for ends in self._ends)
        for i, name in enumerate(self.names):
            if np.count_nonzero(self.matrix[i]) > 1:
                low[i] = -0.8 * size.level if name.startswith("backward") else 0.0
                high[i] = math.inf
            if not self.rig[i] and (self.quantities[i].above is not None or i == 0):
                low[i] = max(low[i], 1e-6 * size.levels[0])
        if not self.rig[0]:
            high[0] = min(high[0], 1e4 * size.levels[0])
        return low, high

    def fit(self, size: Size, errors: Array, simpler: Sequence["TravelLaw"] = ()) -> None:
        """Fit every shape to travels with standard errors (n,) [m]; fills `structures`."""
        low, high = self.bounds(size)
        measured = np.array([trial.travel for trial in self.trials])
        self.measured, self.errors = measured, errors
        moving = np.arange(len(low)) < self.count
        scale = np.where(moving, 0.1 * size.level, 1.0)
        shapes = self.tried = self.shapes(size)
        spread = self.spreads(size, np.column_stack([np.zeros((len(shapes), self.count)), shapes]))
        told = np.isfinite(spread[0])
        scale[: self.count][told] = 0.1 * spread[0, told]

        def residuals(points: Array) -> Array:
            left = (measured - self.table(self.trials, np.clip(points, low, high))) / errors
            left = np.where(np.isfinite(left).all(axis=1, keepdims=True), left, FAILED)
            prior = (points - self.means)[:, : self.count] / self.spreads(size, points)
            return np.hstack([left, prior])

        most = 4 * self.count if self.rig.any() else REFINED
        few = [self.trials.index(trial) for trial in spread_out(self.trials, most)]

        def cost(points: Array) -> Array:
            tried = self.table([self.trials[i] for i in few], np.clip(points, low, high))
            left = (measured[few] - tried) / errors[few]
            return np.where(np.isfinite(left).all(axis=1), np.sum(left**2, axis=1), FAILED**2)

        valley = Valley(residuals=residuals, low=low, high=high, sizes=scale)
        starts = np.clip(self._starts(size, shapes, spread, cost, simpler), low, high)
        steps = STEPS // 2 if self.slow else 2 * STEPS if self.rig.any() else STEPS
        points, costs = valley.descended(starts, moving, steps)
        kept = list[int]()
        for i in np.argsort(np.round(costs, 6), kind="stable").tolist():
            alike = [np.allclose(points[k, self.count :], points[i, self.count :]) for k in kept]
            same = np.array(kept, dtype=np.intp)[alike]
            sizes = np.maximum(np.abs(points[same]), scale)
            near = np.all(np.abs(points[same] - points[i]) <= APART * sizes, axis=1).any()
            worse = len(same) and costs[i] > costs[same[0]] + WORSE
            if not near and not worse and len(same) < BRANCHES:
                kept.append(i)
        points = points[kept]
        every = np.ones(len(low), dtype=bool)
        self.structures = self._structures(points, self.count, moving, valley, size)
        settings = len({trial.setting for trial in self.trials})
        paid = len(low) < settings or (self.thorough and settings > 1)
        if self.count < len(low) and paid and not self._fixed(shapes):
            # a grid of shapes is coarser than readings that are good: the best are fitted too
            self.typical = np.median(shapes, axis=0)
            scale[self.count :] = 0.1 * self.typical
            low[self.count :] = np.maximum(low[self.count :], 0.1 * shapes.min(axis=0))
            high[self.count :] = np.minimum(high[self.count :], 10.0 * shapes.max(axis=0))
            best_few = points[: 1 if self.slow else REFINED]
            ends, left = valley.descended(best_few, every, 2 * steps)
            best = ends[np.argmin(left)][None]
            self.structures += self._structures(best, len(low), every, valley, size)

    def _fixed(self, shapes: Array) -> bool:
        """Return whether the shape was given."""
        return len(shapes) == 1 and bool(np.any(self.means[self.count :]))

    def _structures(
        self,
        points: Array,
        count: int,
        moving: NDArray[np.bool_],
        valley: "Valley",
        size: Size,
    ) -> list[TravelStructure]:
        """Return points as structures of so many coefficients, with their slopes."""
        left = valley.residuals(points)
        table = valley.slopes(points, left, moving)
        measured, errors = self.measured, self.errors
        n, spreads = len(measured), self.spreads(size, points)
        typical = np.tile(self.typical, (len(points), 1))
        leading = points[:, :1]
        if self.rig[0]:
            leading = np.full_like(leading, self.means[0])
        else:
            spreads[:, 0] = LEADING * np.abs(points[:, 0])
        wide = np.hstack([spreads, WIDE * typical])[:, :count]
        means = np.hstack([leading, np.tile(self.means[1 : self.count], (len(points), 1)),
                           typical])[:, :count]  # fmt: skip
        return [
            TravelStructure(
                law=self,
                count=count,
                unknowns=point,
                predicted=measured - errors * item[:n],
                slopes=-errors[:, None] * slope[:n, :count],
                means=mean,
                precisions=spread**-2.0,
            )
            for point, item, slope, mean, spread in zip(
                points, left, table, means, wide, strict=True
            )
            if np.all(np.abs(item[:n]) < FAILED) and np.isfinite(slope).all()
        ]

    def _starts(
        self,
        size: Size,
        shapes: Array,
        spread: Array,
        cost: Callable[[Array], Array],
        simpler: Sequence["TravelLaw"],
    ) -> Array:
        """Return where descents begin: of each shape the best combinations of coefficients.

        A law with bristles begins where that without them ended.
        """
        if self.rig.any():
            return self._drawn(size, shapes, spread, cost)
        if self.law.states and simpler:
            return self._from(simpler, shapes)
        levels = [*([float(self.means[0])] if self.means[0] else []), *size.levels]
        if self.count == 1:
            return np.array([[x, *shape] for shape in shapes for x in levels], dtype=float)
        sides = [name.startswith("backward") for name in self.names[1 : self.count]]
        further = [(*(-x for x in SHARES), *SHARES) if side else SHARES for side in sides]
        mixed = np.array(list(itertools.product(TRIED, *further)))
        cycles = under_cycles(self.trials) and not self.thorough
        most = POINTS // 2 if cycles else POINTS
        if len(mixed) > most:
            shares = qmc.Sobol(self.count, rng=np.random.default_rng(0)).random(most)
            ends = [(TRIED[0], TRIED[-1]), *[(0.0, SHARES[-1])] * (self.count - 1)]
            mixed = np.array([a for a, _ in ends]) + shares * np.array([b - a for a, b in ends])
        starts = list[Array]()
        for shape, widths in zip(shapes, spread, strict=True):
            rows = np.vstack([
                np.column_stack([
                    level * mixed[:, 0], mixed[:, 1:] * widths[1:],
                    np.tile(shape, (len(mixed), 1)),
                ])
                for level in levels
            ])  # fmt: skip
            rows = np.vstack([rows, [[x, *np.zeros(self.count - 1), *shape] for x in levels]])
            order = np.argsort(cost(rows), kind="stable")
            count = 2 if cycles or len(levels) == 1 else BRANCHES
            count = max(count, 2 * BRANCHES // len(shapes) if cycles else 0)  # few shapes, more
            starts += [rows[i] for i in order[:count]]
        return np.array(starts)

    def _drawn(
        self, size: Size, shapes: Array, spread: Array, cost: Callable[[Array], Array]
    ) -> Array:
        """Return the best of points drawn about what was given of the mechanism."""
        shares = qmc.Sobol(self.count, rng=np.random.default_rng(0)).random(DRAWN)
        rig = self.rig[: self.count]
        drawn = SHARES[-1] * shares * np.where(np.isfinite(spread[0]), spread[0], 0.0)
        mean = np.where(self.means[: self.count] == 0.0, 1.0, self.means[: self.count])
        drawn[:, rig] = (mean * AROUND ** (2.0 * shares - 1.0))[:, rig]
        if not rig[0]:  # a level that fits with the wrong mechanism may be far off
            top = HOLDING * size.level
            drawn[:, 0] = top * SPAN ** (shares[:, 0] - 1.0)
        rows = np.vstack([
            np.column_stack([drawn, np.tile(shape, (DRAWN, 1))]) for shape in shapes
        ])  # fmt: skip
        return rows[np.argsort(cost(rows), kind="stable")[: 2 * BRANCHES]]

    def _from(self, simpler: Sequence["TravelLaw"], shapes: Array) -> Array:
        """Return the points of the law without bristles that has most of the parameters."""
        nearest = max(simpler, key=lambda item: len({*item.names} & {*self.names}))
        every = [
            dict(zip(nearest.names, structure.unknowns.tolist(), strict=True))
            for structure in nearest.structures
        ]
        coefficients, names = self.names[: self.count], self.names[self.count :]
        starts = list[list[float]]()
        for shape in shapes.tolist():
            same = {name: x for name, x in zip(names, shape, strict=True) if name in nearest.names}
            off = [sum(abs(math.log(item[name] / x)) for name, x in same.items()) for item in every]
            near = every[int(np.argmin(off))] if every else {}
            starts.append([*(near.get(name, 0.0) for name in coefficients), *shape])
        return np.array(starts)


@dataclass(frozen=True, kw_only=True, eq=False)
class Valley:
    """Residuals of least squares, in which descents go down."""

    residuals: Callable[[Array], Array]
    """Residuals (k, n) at points (k, p)."""
    low: Array
    """Ends of the unknowns (p,) ..."""
    high: Array
    sizes: Array
    """... and their least sizes."""

    def descended(
        self, starts: Array, moving: NDArray[np.bool_], steps: int
    ) -> tuple[Array, Array]:
        """Return where damped Gauss-Newton descents from k starts end, and their costs.

        `moving` tells which unknowns move (p,).

        Examples
        --------
        >>> low, high, sizes = np.array([[-9.0], [9.0], [0.1]])
        >>> valley = Valley(residuals=lambda x: x**2 - 2.0, low=low, high=high, sizes=sizes)
        >>> ends, costs = valley.descended(np.array([[1.0], [-1.0]]), np.array([True]), 20)
        >>> ends.round(4).tolist()
        [[1.4142], [-1.4142]]
        """
        at = np.array(starts, dtype=float)
        sizes = np.maximum(np.abs(at), self.sizes)
        result = Descents(at, sizes, SETTLED, self.low, self.high, reach=1.0)
        for number in range(steps + 1):
            (which,) = np.nonzero(result.live)
            points = result.proposed()[which] if number else at
            left = self.residuals(points)
            kept = result.accept(points, -0.5 * np.sum(left**2, axis=1), first=not number)
            if number == steps or not result.live.any():
                break
            kept = kept[result.live[which[kept]]]
            if not len(kept):
                continue
            slopes = self.slopes(points[kept], left[kept], moving)
            scale = np.maximum(np.abs(points[kept]), self.sizes)
            slopes = np.where(np.isfinite(slopes), slopes, 0.0) * scale[:, None, :]
            result.scale[which[kept]] = scale
            result.gradient[which[kept]] = -np.einsum("kni,kn->ki", slopes, left[kept])
            result.curvature[which[kept]] = np.einsum("kni,knj->kij", slopes, slopes)
        return result.at, -2.0 * result.value

    def slopes(self, points: Array, left: Array, moving: NDArray[np.bool_]) -> Array:
        """Return derivatives of residuals (k, n, p) at points (k, p), by one-sided differences."""
        result = np.zeros((*left.shape, points.shape[1]))
        steps = STEP * np.maximum(np.abs(points), self.sizes)
        back = np.where(points - steps >= self.low, -steps, 0.0)
        steps = np.where(points + steps <= self.high, steps, back)
        columns, rows = np.nonzero(np.broadcast_to(moving, points.shape).T)
        shifted = points[rows]
        step = steps[rows, columns]
        shifted[np.arange(len(rows)), columns] += step
        there = self.residuals(shifted) - left[rows]
        result[rows, :, columns] = there / np.where(step == 0.0, math.inf, step)[:, None]
        return result


def spread_out(trials: Sequence[Trial], most: int) -> list[Trial]:
    """Return one trial of each setting; of many some, from the shortest to the longest travel."""
    different = sorted({t.run: t for t in trials}.values(), key=lambda t: abs(t.travel))
    chosen = np.linspace(0, len(different), most).astype(int)
    return [different[min(i, len(different) - 1)] for i in dict.fromkeys(chosen.tolist())]


def top_speed(trial: Trial, run: Trajectory) -> float:
    """Return the largest speed of slip of a run of a trial [m/s]."""
    seen = run.at(np.union1d(np.linspace(*run.span, SAMPLES), run.t))
    return float(np.abs(seen[slip_names(trial.mechanism)[1]]).max())


def room_for(law: FrictionLaw, name: str, free: Collection[str]) -> tuple[float, float]:
    """Return the values a parameter may take while all that are not free stay as they are."""
    known = fields_of(type(law))
    one = known[name]
    low, high = max(one.low, one.above or 0.0, 0.0), one.high
    if one.scale == "none" and one.bounds:  # powers: beyond these no law is meant
        low, high = max(low, one.bounds[0]), min(high, one.bounds[1])
    if one.at_least is not None:
        low = max(low, getattr(law, one.at_least))
    above = [x for x, other in known.items() if other.at_least == name and x not in free]
    return low, min([high, *(getattr(law, x) for x in above if getattr(law, x) is not None)])


def moving_back(law: FrictionLaw, trials: Sequence[Trial], t_end: float) -> bool:
    """Return whether the body turns back in a trial: only then do directions differ."""
    for trial in {item.run: item for item in trials}.values():
        run = trial.simulated(law, t_end)
        path = run.at(np.linspace(*run.span, SAMPLES))[slip_of(trial.mechanism)]
        if np.abs(np.diff(path)).sum() > 1.001 * abs(float(path[-1] - path[0])):
            return True
    return False
