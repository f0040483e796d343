r"""A table of friction over speed, loads, inputs and runs, as a model of the posterior.

.. math::
    y_i = \sum_t c_t\, s_i\, (N_i / N_0)^{a} f_t(|v_i|)
        + \text{offset} + \text{sides} + \text{drift} + \text{run} + \text{inputs} + \text{load}
        + s_i\, \delta(\log |v_i|) + u_{\text{block}} + e_i

:math:`s` is the direction of motion and :math:`N_0` the mean load. :math:`\delta` is a Gaussian
process (Matern 3/2 over `LENGTHS`, in e-folds) by knots, so that any number of rows costs
the same. Readings at one speed, load and run are a *block*, whose common error is part of the
noise; so are stated errors and the step to which readings were rounded. All other terms are always
there, with the sizes in the table `TERMS` below: what the design cannot tell widens the band by
them, and costs nothing where it is told.

1. More than `MOST_ROWS` rows become means of cells, with their count and inner scatter.
2. All shapes are compared at a few nodes; the best `KEPT` are refined by thirds of a step.
3. Nodes are visited; then weights of the readings follow from how far each is from what the others
   say (a Student's t of `THRESHOLDS.freedom`), and the size of friction with which drift, runs and
   noise grow from the best law. This is repeated until no weight changes, `TURNS` times at most.
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cholesky, solve_triangular

from stickslip.identify.fits import last_digit
from stickslip.identify.forces import TRANSMITTED
from stickslip.identify.own_laws import Slips, is_slope, slope_column
from stickslip.identify.posterior import (
    COEFFICIENT,
    Array,
    Column,
    Family,
    Model,
    Node,
    Posterior,
    Scale,
    Structure,
    System,
    family_of,
)
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.identify.vocabulary import (
    DRY,
    FAMILIES,
    GEAR,
    PARTS,
    PLACE,
    SIGNED,
    STEP,
    Grid,
    levels_at,
    parameters_of,
)
from stickslip.units import factor

Integers = NDArray[np.intp]

# Prior sizes, over the root mean square of the friction, and grids: with those of the vocabulary
# the only constants of the model.
RHO = (0.0, 0.35, 0.7, 1.4, 2.8, 5.6, 11.0, 22.0, 45.0)
"""Deviation of what no law says, over the noise: factors of 2, up to where noise is a fiftieth."""
NO_DELTA, DELTA = 0.55, 0.1
"""Prior of a law without it, and the size above which it is unlikely (half-normal): real joints
leave 3 to 6 % to every law."""
LENGTHS = {0.7: 0.3, 2.0: 0.7}
"""E-folds of the speed over which its parts change, with their shares of the variance. Without the
smooth part a misfit of a law over decades was a drift of a sorted file (band 36 noises wide)."""
BETA = (0.0, 0.8, 1.4, 2.5, 4.2, 7.2, 12.0, 21.0, 36.0, 62.0, 110.0, 190.0)
BETA_PRIOR = (0.35, 0.1, 0.1, 0.1, 0.1, 0.08, 0.06, 0.05, 0.03, 0.01, 0.01, 0.01)
"""Deviation between blocks over the noise within; repeats may be copies, without any noise."""
SIDES = (
    (), ("offset",), ("offset", "viscous_direction"), ("offset", "sides"),
    ("offset", "viscous_direction", "sides"),
)  # fmt: skip
SIDES_PRIOR = (0.5, 0.22, 0.15, 0.09, 0.04)
"""What differs by direction."""
ALIKE, APART = 0.003, 0.25
"""Deviation of a difference between directions where they are alike, and where they are not."""
DRIFTS = (0.002, 0.02, 0.12, 0.4)
DRIFT_PRIOR, SORTED_PRIOR = (0.93, 0.045, 0.02, 0.005), (0.91, 0.06, 0.028, 0.002)
"""Change of friction over the order of the readings: 1 careful table in 14 drifts by more than some
parts in a thousand (with 1 in 7, a drift that no noisy table excludes was a third of the band)."""
OF_TIME = 0.02
"""Prior of a drift where the order follows the speed: files are sorted, and such a course is rather
a smooth one over the speed that no law says, which 3 to 6 % of the friction of real joints is. A
Gaussian process is rougher, so that without these courses the drift was what explains them."""
FOLLOWS = 0.8
"""Adjusted share of the order that speeds or loads explain from which it follows them, and share
of an input that runs explain."""
RUNS, RUNS_PRIOR = (0.003, 0.02, 0.06, 0.18), (0.4, 0.25, 0.2, 0.15)
"""Deviation of friction from run to run."""
INPUT, INPUTS_PRIOR = (0.005, 0.2), (0.5, 0.5)
"""Change of friction by `KELVINS` of the temperature, or by half the range of another input, whose
size depends on its unit."""
KELVINS = 10.0
BEND = 0.05
"""Bends of friction over a load, beyond its power, and over an input, where its change is large: an
exponential of .3 over `KELVINS` bends by that near the mean; over several times `KELVINS` it bends
more, which kinks follow. Where the change is small, so is its bend."""
LOAD_POWERS = {1.0: 0.5, 0.85: 0.2, 0.7: 0.2, 0.55: 0.1}
"""Powers of the load with their priors: in proportion, adhesive, elastic contact."""
RULES = {"own": 0.5, "all": 0.4, "hersey": 0.1}
"""Whether dry parts alone, all parts, or a surplus over speed / load follow the load."""
NOISES_PRIOR = (0.6, 0.4)
"""Whether noise is even, or grows with the force."""
NOISE, NOISE_FACTOR = 0.02, 1.2
"""Median of the noise, and the deviation of its logarithm: readings of a careful experiment."""
NOISE_RANGE = (1e-4, 1.3)
BEYOND = (0.03, 1.0)
"""Deviation an e-fold beyond the measured speeds: of friction, and of what no law says."""

JUMP, KINK = "jump", "kink"
"""Dry friction may jump somewhere between two speeds, loads or values of an input, or change its
slope there over a load or an input, which no law says and no process follows: names of terms, with
what they are over."""
JUMPS, JUMP_PRIOR = 3, 0.02
"""Laws beside which each is tried, and its prior."""
FINE = 4
"""Parts of a gap in which a kink may be."""
MOST_GAPS = 60
"""Gaps between speeds, loads or inputs up to which jumps are tried."""
READ_IN = ("lbf", "kgf", "ozf", "lbf in", "lbf ft", "ozf in")
"""Units beside those of SI in which instruments show forces and torques."""
FEW_GAPS, OF_EACH, COARSEST = 4, 3, 0.1
"""Differences between readings that say nothing of a step, readings of each value that do, and the
largest step of these over friction: two friction levels are no rounding."""
TURNS = 3
MOST_ROWS = 250
FIRST, MOST = 100, 400
"""Nodes that are visited in the first turn, and in others."""
DIGITS = 9
"""Digits of a reading: equal settings may differ beyond them by the conversion of a unit."""
KEPT = 80
"""Structures that are refined, and that are kept (with 40, up to 8 % of the weight was cut off at
the ends of intervals)."""
FINER = 4
"""Times that shapes are refined by thirds of a step ..."""
RESOLVED, LEAST_SHARE = 4.0, 0.02
"""... where fewer values of one than that count, in families with that share at least."""
BEHIND, LOST = 12.0, 8.0
"""Logarithm of the weight from which structures are not refined, or dropped after one turn."""
SUSPECT = (3.0, 8.0)
"""Deviations from which a reading may be an outlier, and what few readings add to that."""
OUTLIER_PRIOR = 0.01
"""Prior of a reading to be an outlier; at an end it may be friction as well. Without it a fall of
friction in one direction, which some readings show, was two outliers of ten (band 7 noises beside
the truth)."""
AT_ENDS = 0.6
"""Share of friction by which a reading alone at the slowest or fastest speed may be off, so that it
may be friction, such as a static surplus, as well as an outlier: half of the draws take it so."""
FAR = 1e3
"""Logarithm of a speed that is beyond any."""
NEAR = 0.02
"""Difference of logarithms of speeds up to which readings are repeats ..."""
NEAR_LOAD = 0.05
"""... and of loads."""
CELL, CELL_GROWTH, WIDEST = 0.02, 1.3, 0.4
"""Width of cells in logarithms, the factor by which they grow until they are few, and its end: a
mean over more is not friction at the mean speed (error on other steps of the traction machine, by
`benchmarks.real_records`: 16.5 N with up to 3, 12.2 N with .4)."""
LEAST = 0.03
"""Least size of friction, over its root mean square, with which something grows."""
FEW_SPEEDS = 3
"""Speeds of a direction from which it may differ from the other, and that tell all families."""
ONE_WAY = 0.1
"""Part of the largest speed that a direction has at least, to differ from the other."""
SCALES = ("noise", "delta", "growth", "block", "sides", "drift", "run", "run part")
"""Scales of every table, in the order of the entries of a node; one for each input follows."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Rows(Slips):
    """Readings of friction, or places where it is asked; no velocity is 0."""

    run: Integers
    """Number of the run (n,); -1: any."""
    order: Array
    """Place in the order of measuring, from 0 to 1 (n,); NaN: any."""

    @property
    def speed(self) -> Array:
        """Sizes of the velocities (n,) [m/s]."""
        return np.abs(self.velocity)

    @property
    def direction(self) -> Array:
        """Signs of the velocities (n,)."""
        return np.where(self.velocity < 0.0, -1.0, 1.0)

    @property
    def along(self) -> Array:
        """Numbers (n,) that rise with the logarithm of the speed, below 0 where that is against."""
        return np.asarray(self.direction * (FAR + np.log(self.speed)))

    def where(self, kept: "NDArray[np.bool_] | Integers") -> "Rows":
        """Return some of the rows."""
        return Rows(
            velocity=self.velocity[kept],
            load=self.load[kept],
            inputs={name: x[kept] for name, x in self.inputs.items()},
            run=self.run[kept],
            order=self.order[kept],
        )

    def each(self, make: Callable[[Array], Array]) -> "Rows":
        """Return rows of which numbers are made of these, such as means; runs are the nearest."""
        return Rows(
            velocity=np.where(make(self.direction) < 0.0, -1.0, 1.0)
            * np.exp(make(np.log(self.speed))),
            load=make(self.load),
            inputs={name: make(x) for name, x in self.inputs.items()},
            run=np.rint(make(self.run.astype(float))).astype(np.intp),
            order=make(self.order),
        )


def as_read(values: Array) -> Array:
    """Return values (n,) with the digits that a reading may have: what is further is rounding.

    Readings are counted, grouped and taken for copies where they are equal.

    Examples
    --------
    >>> as_read(np.array([0.1 + 0.2, -1.0 / 3.0, 0.0])).tolist()
    [0.3, -0.333333333, 0.0]
    """
    return np.array([float(f"{x:.{DIGITS}g}") for x in values])


@dataclass(frozen=True, kw_only=True, eq=False)
class Readings:
    """What was read: single readings, or means of cells."""

    rows: Rows
    friction: Array
    """Friction (n,) [N]."""
    stated: Array
    """Stated standard uncertainties (n,) [N]; 0 where none is."""
    count: Array
    """Readings of each cell (n,)."""
    within: Array
    """Squares about the mean of each cell, in sum (n,)."""
    last: int = 0
    """Place of the last reading of the measurement, from 0."""
    at_rest: Array = field(default_factory=lambda: np.zeros(0))
    """Velocities of readings at rest, which are left out (k,)."""
    copies: int = 0
    """Readings that are copies of others, which are left out."""

    @classmethod
    def of(cls, rows: Rows, friction: Array, stated: Array | None = None) -> "Readings":
        """Return single readings; of many, means of cells.

        Where all readings at each setting are equal and most settings are repeated, one counts: the
        others are copies, unless readings are so coarse that noise is lost in rounding.
        """
        n = len(friction)
        inputs = {name: as_read(x) for name, x in rows.inputs.items()}
        rows = replace(
            rows, velocity=as_read(rows.velocity), load=as_read(rows.load), inputs=inputs
        )
        single = cls(
            rows=rows,
            friction=as_read(friction),
            stated=np.zeros(n) if stated is None else np.asarray(stated, dtype=float),
            count=np.ones(n),
            within=np.zeros(n),
        )
        setting = np.column_stack([rows.velocity, rows.load, *rows.inputs.values()])
        _, first, count = np.unique(setting, axis=0, return_index=True, return_counts=True)
        alike = len(first) == len(np.unique(np.column_stack([setting, friction]), axis=0))
        if alike and 2 * np.sum(count > 1) >= len(first) and not step_of(single, Frame.of(single)):
            single = replace(single.where(np.sort(first)), copies=n - len(first))
        return single if len(single.friction) <= MOST_ROWS else single.condensed()

    @property
    def total(self) -> int:
        """Number of the readings that were made."""
        return round(float(self.count.sum()))

    def where(self, kept: "NDArray[np.bool_] | Integers") -> "Readings":
        """Return some of the readings."""
        return replace(
            self,
            rows=self.rows.where(kept),
            friction=self.friction[kept],
            stated=self.stated[kept],
            count=self.count[kept],
            within=self.within[kept],
        )

    def condensed(self) -> "Readings":
        """Return means of cells: readings of like speed, load, inputs and of one run."""
        rows, width = self.rows, CELL
        least = {"temperature": KELVINS}  # what changes friction at least
        while True:
            parts = [
                rows.direction,
                np.floor(np.log(rows.speed) / width),
                np.round(np.log(rows.load) / max(NEAR_LOAD, width)),
                rows.run,
                *(
                    np.floor(
                        (x - x.min())
                        / (max(np.ptp(x), least.get(name, 0.0)) * max(NEAR_LOAD, width) + 1e-12)
                    )
                    for name, x in rows.inputs.items()
                ),
            ]
            cell = np.unique(np.column_stack(parts), axis=0, return_inverse=True)[1].ravel()
            if cell.max() < MOST_ROWS or width > WIDEST:
                break
            width *= CELL_GROWTH
        count = np.bincount(cell).astype(float)

        def mean(x: Array) -> Array:
            return np.asarray(np.bincount(cell, x) / count)

        middle = mean(self.friction)
        result = Readings(
            rows=rows.each(mean),
            friction=middle,
            stated=np.sqrt(mean(self.stated**2)),
            count=count,
            within=np.asarray(np.bincount(cell, (self.friction - middle[cell]) ** 2), dtype=float),
        )
        return result.where(np.argsort(result.rows.order, kind="stable"))


@dataclass(frozen=True, kw_only=True, eq=False)
class Frame:
    """What the columns of all rows are scaled by: it is that of the readings."""

    slowest: float
    fastest: float
    load: float
    """Geometric mean of the loads [N]."""
    size: float
    """Root mean square of the friction [N]."""
    means: Mapping[str, float]
    """Means of the inputs ..."""
    spans: Mapping[str, float]
    """... and by how much each changes where its effect has its prior size."""
    squares: Mapping[str, float]
    """Means over the readings of squares about these means, in squares of that size."""
    runs: int
    """Number of the runs."""
    loaded: bool
    """Whether loads differ."""
    both: bool
    """Whether both directions were measured at several speeds."""
    load_power: float
    """Power of the load that all friction follows about."""

    @classmethod
    def of(cls, readings: Readings) -> "Frame":
        """Return the frame of readings."""
        rows, u = readings.rows, readings.rows.speed
        usual = running_medians(readings)  # one reading in another unit is no size of friction
        size = float(np.sqrt(np.average(usual**2, weights=readings.count))) or 1.0
        load = float(np.exp(np.mean(np.log(rows.load))))
        logs = np.log(rows.load / load)
        loaded = bool(np.ptp(logs) > NEAR_LOAD)
        power = 0.0
        if loaded:
            x = np.column_stack([np.ones(len(u)), np.log(u + 1e-3 * u.max()), logs])
            y = np.log(np.abs(readings.friction) + 0.02 * size)
            power = float(np.clip(np.linalg.lstsq(x, y, rcond=None)[0][2], 0.0, 1.2))
        spans = {
            name: KELVINS if name == "temperature" else 0.5 * float(np.ptp(x))
            for name, x in rows.inputs.items()
        }
        return cls(
            slowest=float(u.min()),
            fastest=float(u.max()),
            load=load,
            size=size,
            means={name: float(np.mean(x)) for name, x in rows.inputs.items()},
            spans=spans,
            squares={name: float(np.var(x)) / spans[name] ** 2 for name, x in rows.inputs.items()},
            runs=int(rows.run.max()) + 1,
            loaded=loaded,
            both=is_both_ways(rows),
            load_power=power,
        )

    def grown(self, rows: Rows) -> Array:
        """Return how friction grows with the load (n,), about."""
        return np.asarray((rows.load / self.load) ** self.load_power)

    @cached_property
    def knots(self) -> Array:
        """Logarithms of speeds at which what no law says has its values (k,)."""
        low, high = math.log(self.slowest) - 1.3, math.log(self.fastest) + 0.8
        return np.linspace(low, high, math.ceil((high - low) / (0.45 * min(LENGTHS))) + 1)

    @cached_property
    def _root(self) -> Array:
        """Inverse root of the covariance over the knots (k, k)."""
        apart = np.abs(self.knots[:, None] - self.knots)
        covariance = _matern(apart) + 1e-8 * np.eye(len(apart))
        return np.asarray(np.linalg.inv(np.linalg.cholesky(covariance)).T)

    def basis(self, rows: Rows) -> Array:
        """Return columns (n, k) of independent coefficients whose sum is the Gaussian process."""
        logs = np.log(np.maximum(rows.speed, 0.05 * self.slowest))
        columns = _matern(np.abs(logs[:, None] - self.knots)) @ self._root
        return np.asarray(columns * self.grown(rows)[:, None])


def ends_of(rows: Rows) -> "NDArray[np.bool_]":
    """Return which rows are at the slowest or the fastest speed of a direction (n,).

    Examples
    --------
    >>> v = np.array([0.1, 0.2, 0.3])
    >>> ends_of(Rows(velocity=v, load=v, inputs={}, run=np.zeros(3, int), order=v)).tolist()
    [True, False, True]
    """
    result = np.zeros(len(rows.velocity), dtype=bool)
    logs = np.log(rows.speed)
    for way in (-1.0, 1.0):
        at = rows.direction == way
        if at.any():
            own = logs[at]
            result[at] = (own < own.min() + NEAR) | (own > own.max() - NEAR)
    return result


def _matern(distance: Array) -> Array:
    """Return the sum of Matern correlations of order 3/2 at distances."""
    scaled = ((share, math.sqrt(3.0) * distance / length) for length, share in LENGTHS.items())
    return np.asarray(sum(share * (1.0 + d) * np.exp(-d) for share, d in scaled))


def is_both_ways(rows: Rows) -> bool:
    """Return whether there are readings at several speeds, or at the only one, both ways."""
    sides = [rows.velocity[rows.velocity > 0.0], -rows.velocity[rows.velocity < 0.0]]
    if min(len(np.unique(side)) for side in sides) < min(FEW_SPEEDS, speeds_of(rows)):
        return False
    return min(float(side.max()) for side in sides) > ONE_WAY * float(rows.speed.max())


def families_at(rows: Rows) -> list[Family]:
    """Return the families of the vocabulary that speeds can tell: at one it is a level.

    Where a gear transmits what differs, each level may grow with it.

    Examples
    --------
    >>> v, ones = np.full(4, 0.1), np.ones(4)
    >>> rows = Rows(velocity=v, load=ones, inputs={}, run=np.zeros(4, int), order=ones)
    >>> families_at(rows)
    [(), ('level',)]
    """
    speeds, every = speeds_of(rows), [tuple(item.split()) for item in FAMILIES]
    if speeds < FEW_SPEEDS:
        one = speeds == 1
        every = [x for x in every if parameters_of(x) <= speeds - (one and x != ("level",))]
    if TRANSMITTED not in rows.inputs:
        return every
    return every + [tuple(sorted((GEAR, *x))) for x in every if "level" in x]


def speeds_of(rows: Rows) -> int:
    """Return the number of speeds that readings are at."""
    return int(_grouped(np.log(rows.speed), NEAR).max()) + 1


def law_column(column: Column, rows: Rows, frame: Frame) -> Array:
    """Return friction over the coefficient of a term of a law at rows (n,).

    A shape may end in the power of the load that the term follows; without one, dry terms are in
    proportion to it and the others do not change. A Hersey surplus fades with speed over load.
    """
    name, shape = column
    if is_slope(name):
        return slope_column(column, rows)
    ratio = rows.load / frame.load
    if name == "hersey":
        surplus = PARTS["stribeck"].curve(rows.speed / ratio, shape)
        return np.asarray(rows.direction * ratio * surplus)
    if name == "adhesion":
        return rows.direction
    if name == GEAR:
        return np.asarray(rows.direction * rows.inputs[TRANSMITTED])
    if is_break(name):
        return break_column(name, middle_of(name, shape), rows, frame)
    part = PARTS[name]
    own = len(part.shapes)
    power = shape[own] if len(shape) > own else (1.0 if part.dry else 0.0)
    return np.asarray(rows.direction * ratio**power * part.curve(rows.speed, shape))


def is_break(name: str) -> bool:
    """Return whether a term is a jump or a kink."""
    return name.partition(" ")[0] in (JUMP, KINK)


def is_ratio(name: str) -> bool:
    """Return whether what a jump or a kink is over is a ratio: speeds and loads, no inputs."""
    return name.partition(" ")[2] in ("speed", "load")


def middle_of(name: str, ends: tuple[float, ...]) -> float:
    """Return the middle of a gap in which friction jumps or has a kink.

    Examples
    --------
    >>> middle_of("jump load", (10.0, 40.0)), middle_of("kink temperature", (10.0, 40.0))
    (20.0, 25.0)
    """
    low, high = ends
    return math.sqrt(low * high) if is_ratio(name) else 0.5 * (low + high)


def break_column(name: str, place: float | Array, rows: Rows, frame: Frame) -> Array:
    """Return what a jump or a kink at a place, or places (k, 1), adds at rows (n,) or (k, n)."""
    kind, _, over = name.partition(" ")
    x = {"speed": rows.speed, "load": rows.load, **rows.inputs}[over]
    beyond = np.asarray(x > place, dtype=float)
    if kind == KINK:
        beyond *= np.log(x / place) if is_ratio(name) else (x - place) / frame.spans[over]
    return np.asarray(rows.direction * rows.load / frame.load * beyond)


def gaps_of(rows: Rows, over: str) -> list[tuple[float, float]]:
    """Return gaps (low, high) between values of a speed, load or input, two of them on each side.

    Values that are near each other are one.

    Examples
    --------
    >>> v = np.array([0.1, 0.2, 0.202, 0.4, 0.8, 1.6])
    >>> rows = Rows(velocity=v, load=v, inputs={}, run=np.zeros(6, int), order=v)
    >>> gaps_of(rows, "speed")
    [(0.202, 0.4), (0.4, 0.8)]
    """
    x = {"speed": rows.speed, "load": rows.load, **rows.inputs}[over]
    least = {"speed": NEAR, "load": NEAR_LOAD}.get(over, NEAR_LOAD * float(np.ptp(x)))
    values = np.unique(x)
    apart = np.diff(np.log(values) if over in ("speed", "load") else values)
    lower = np.flatnonzero(apart > least)[1:-1]
    return list(zip(values[lower].tolist(), values[lower + 1].tolist(), strict=True))


def breaks_of(frame: Frame) -> list[str]:
    """Return the names of the jumps and kinks that readings may show."""
    by = ["load"] * frame.loaded + [*frame.means]
    return [f"{JUMP} speed", *(f"{kind} {over}" for over in by for kind in (JUMP, KINK))]


def structures_of(
    frame: Frame, grid: Grid, families: Sequence[Family]
) -> tuple[list[Structure], Array]:
    """Return the structures of families with the logarithms of their priors (s,)."""
    every = [
        (structure, prior + math.log(of_load))
        for family, shapes, prior in grid.families(families)
        for structure, of_load in _loaded(frame, family, shapes)
    ]
    return [structure for structure, _ in every], np.array([prior for _, prior in every])


def _loaded(
    frame: Frame, family: Family, shapes: Sequence[tuple[float, ...]]
) -> list[tuple[Structure, float]]:
    """Return a law under each rule by which it may follow the load, with its prior."""
    plain = tuple(sorted(zip(family, shapes, strict=True)))
    if not frame.loaded:
        return [(plain, 1.0)]
    dry = any(name in DRY for name in family)
    flow = any(name not in DRY and name != GEAR for name in family)
    result = []
    for power, prior in LOAD_POWERS.items():
        if dry or power == 1.0:
            own = tuple((n, (*s, power)) if n in DRY else (n, s) for n, s in plain)
            result.append((own, RULES["own"] * prior))
        if flow or not dry:
            every = tuple((n, s if n == GEAR else (*s, power)) for n, s in plain)
            result.append((every, RULES["all"] * prior))
    if "stribeck" in family:
        hersey = tuple(sorted(("hersey", s) if n == "stribeck" else (n, s) for n, s in plain))
        result.append((hersey, RULES["hersey"]))
    if "level" in family and "power" not in family:
        adhesion = tuple(sorted((*(o for o in plain), ("adhesion", ()))))
        result.append((adhesion, RULES["own"] * LOAD_POWERS[1.0] * math.exp(-PLACE)))
    return result


def finer(
    structure: Structure, grid: Grid, frame: Frame, part: float = 1.0 / 3.0
) -> list[Structure]:
    """Return a structure and those whose shapes, or power of the load, are a part of a step off."""
    names = tuple(name for name, _ in structure)
    ends = [len(PARTS[name].shapes if name in PARTS else shape) for name, shape in structure]
    own = [shape[:end] for (_, shape), end in zip(structure, ends, strict=True)]
    of_load = [shape[end:] for (_, shape), end in zip(structure, ends, strict=True)]
    plain = tuple("stribeck" if name == "hersey" else name for name in names)
    powers = {power for (power,) in filter(None, of_load)}
    step = 3.0 * part * STEP
    loads = [0.0] if powers <= {1.0} or not frame.loaded else [-step, 0.0, step]
    return [
        tuple(
            (name, (*shape, *(power + more for power in extra)))
            for name, shape, extra in zip(names, shapes, of_load, strict=True)
        )
        for shapes in grid.finer(plain, own, part)
        for more in loads
    ]


@dataclass(frozen=True, eq=False)
class LawCurve:
    """A law; without one, the size of friction.

    What no law says is left out: it follows the readings, and noise would grow with itself.
    """

    frame: Frame
    structure: Structure
    coefficients: Array

    def __call__(self, rows: Rows) -> Array:
        """Return the curve at rows (n,)."""
        if not self.structure:
            return self.frame.size * self.frame.grown(rows)
        columns = [law_column(item, rows, self.frame) for item in self.structure]
        return np.asarray(self.coefficients @ np.array(columns))


@dataclass(frozen=True, eq=False)
class Reference:
    """The size of friction at rows, with which drift, runs and noise grow."""

    frame: Frame
    curve: Callable[[Rows], Array]

    def __call__(self, rows: Rows) -> Array:
        """Return the size (n,) [N]."""
        return np.maximum(np.abs(self.curve(rows)), LEAST * self.frame.size)


def running_medians(readings: Readings, grown: Array | float = 1.0) -> Array:
    """Return medians over the speed and direction of the size of friction over a growth (n,)."""
    rows, n = readings.rows, len(readings.friction)
    over = np.abs(readings.friction) / grown
    order, half, result = np.argsort(rows.along, kind="stable"), 1 + n // 25, np.empty(n)
    for place, row in enumerate(order):
        first = min(max(0, place - half), n - 2 * half - 1)
        result[row] = np.median(over[order[max(0, first) : max(0, first) + 2 * half + 1]])
    return result


class TableModel(Model):
    """Readings with weights, and a size of friction with which things grow."""

    def __init__(
        self, readings: Readings, frame: Frame, weights: Array, reference: Reference
    ) -> None:
        self.readings, self.frame = readings, frame
        self.signed = SIGNED | {*breaks_of(frame)}
        self.weights, self.reference = weights, reference
        self.block, self.repeats = blocks_of(readings)
        self.step = step_of(readings, frame)
        values = np.unique(readings.friction)
        self.is_equal = len(np.unique(np.abs(values))) == 1
        few = self.is_equal or (len(values) <= FEW_GAPS and not self.repeats)
        self.is_flat = bool(self.step) and few
        if self.is_flat:  # equal readings at neighbouring speeds have one error
            order = np.argsort(readings.rows.along, kind="stable")
            ends = np.diff(readings.friction[order], prepend=math.inf) != 0.0
            self.block[order], self.repeats = np.cumsum(ends) - 1, False
        self.known = bool(np.any(readings.stated > 0.0)) or self.step > 0.0
        self.ordered_by, self.is_sorted = order_of(readings)
        self.scales = self._scales()
        self._columns, self.groups = self.random(readings.rows)
        self._laws: tuple[tuple[Column, ...], Array, Array] | None = None
        self._grams: dict[tuple[int, ...], tuple[Array, float, float]] = {}

    def _scales(self) -> tuple[Scale, ...]:
        frame, n = self.frame, len(self.readings.friction)
        step = float(np.clip(1.2 / math.sqrt(n), 0.08, 0.33))
        low, high = np.log(NOISE_RANGE)
        noise = np.exp(np.linspace(low, high, math.ceil((high - low) / step) + 1))
        flat = np.log(noise / NOISE) / NOISE_FACTOR * (not self.known)
        lawful = (1.0 - NO_DELTA) / (len(RHO) - 1)

        def of(name: str, values: Sequence[float], prior: Sequence[float], used: bool) -> Scale:
            kept = slice(None) if used else slice(1)
            return Scale(
                name=name, values=tuple(values)[kept], prior=tuple(prior)[kept] if used else (1.0,)
            )

        drift: tuple[float, ...] = SORTED_PRIOR if self.is_sorted else DRIFT_PRIOR
        if self.is_sorted and not self.is_by_speed:
            more = [OF_TIME * x for x in drift[1:]]
            drift = 1.0 - sum(more), *more
        return (
            Scale(name="noise", values=tuple(noise), prior=tuple(np.exp(-0.5 * flat**2))),
            Scale(name="delta", values=RHO, prior=(NO_DELTA, *(lawful,) * (len(RHO) - 1))),
            Scale(name="growth", values=(0.0, 1.0), prior=NOISES_PRIOR, ordered=False),
            of("block", BETA, BETA_PRIOR, self.repeats),
            replace(of("sides", range(len(SIDES)), SIDES_PRIOR, frame.both), ordered=False),
            Scale(name="drift", values=DRIFTS, prior=drift),
            of("run", RUNS, RUNS_PRIOR, frame.runs > 1),
            replace(of("run part", (0.0, 1.0), (0.5, 0.5), frame.runs > 1), ordered=False),
            *(
                Scale(
                    name=name,
                    values=(0.0, 1.0, 2.0, 3.0),
                    prior=tuple(INPUTS_PRIOR[k % 2] * INPUTS_PRIOR[k // 2] for k in range(4)),
                    ordered=False,
                )
                for name in frame.means
            ),
        )

    def prior(self, node: Node) -> float:
        """Return the logarithm of the prior of a node: what no law says and repeats share is small.

        Few blocks do not tell what they share: unbounded, it was a fifth of friction at one speed.
        """
        apart = math.hypot(RHO[node[1]], BETA[node[3]]) * self.sigma(node) / self.frame.size
        return super().prior(node) - 0.5 * (apart / DELTA) ** 2

    def sigma(self, node: Node) -> float:
        """Return the noise of a node [N]."""
        return self.frame.size * self.scales[0].values[node[0]]

    def tau(self, node: Node) -> float:
        """Return the deviation of what no law says at a node [N]."""
        return RHO[node[1]] * self.sigma(node)

    def unexplained(self, node: Node) -> float:
        """Return the deviation of all that no law says at a node, also along a sorted file [N]."""
        course = DRIFTS[node[5]] * self.frame.size if self.is_by_speed and node[5] else 0.0
        return max(self.tau(node), course)

    @property
    def is_by_speed(self) -> bool:
        """Whether a course over the order may be one over the speed."""
        return self.is_sorted and self.ordered_by == "speed"

    def sorted_in(self, rows: Rows) -> Rows:
        """Return rows at the places in the order at which their speeds were measured."""
        own = self.readings.rows
        known, at = np.unique(own.along, return_inverse=True)
        order = np.bincount(at, own.order) / np.bincount(at)
        return replace(rows, order=np.interp(rows.along, known, order))

    def shared(self, node: Node) -> float:
        """Return the variance of what readings of a block share at a node.

        Noise makes errors of rounding at one friction differ: what is the same fades with it
        (B. Widrow, I. Kollar, Quantization Noise, 2008).
        """
        repeated = (BETA[node[3]] * self.repeats * self.sigma(node)) ** 2
        return repeated + self._alike(node) * self.step**2 / 12.0

    def _alike(self, node: Node) -> float:
        """Return the share of the variance of rounding that is the same for readings of a block."""
        return math.exp(-((math.tau * self.sigma(node) / self.step) ** 2)) if self.is_flat else 1.0

    def _precisions(self, node: Node) -> tuple[Array, float]:
        """Return precisions of readings (n,) at a node, over the squared noise, and half their log.

        Of readings that rounding makes equal no scatter says how small the noise is.
        """
        readings, alike = self.readings, self._alike(node)
        known = readings.stated**2 + (1.0 - alike) * self.step**2 / 12.0
        variance = self.growth(readings.rows, node) ** 2 / self.weights
        w = readings.count / (variance + known / self.sigma(node) ** 2)
        # readings of a cell have the determinant of their noise, not of their mean's
        volume = readings.count * np.log(w / readings.count)
        if self.is_flat:
            free = 1.0 - 1.0 / np.bincount(self.block)[self.block]
            # so that to 2 % theirs is the probability to be equal, about the middle of a step
            more = alike / 12.0 + (1.0 / math.tau - 1.0 / 12.0) * alike**0.25
            more *= (self.step / self.sigma(node)) ** 2
            volume = volume - free * np.log1p(more * w / readings.count)
        return w, 0.5 * float(np.sum(volume))

    def begin(self) -> list[Node]:
        """Return nodes over the range of the noise and of what no law says."""
        noise = np.array(self.scales[0].values)
        spread = np.ptp(np.log(self.reference(self.readings.rows))) > 0.5
        sides = len(SIDES) - 1 if self.frame.both else 0
        more = (1 if self.frame.runs > 1 else 0, 0, *(3 for _ in self.frame.means))
        result = []
        for sigma in (0.002, 0.006, 0.02, 0.06, 0.2, 0.6, 1.2):
            at = int(np.argmin(np.abs(np.log(noise / sigma))))
            for delta, growth, block in itertools.product(
                (0, 3, 6), {0, int(spread)}, (0, 5) if self.repeats else (0,)
            ):
                result.append((at, delta, growth, block, sides, 1, *more))
        return result

    def growth(self, rows: Rows, node: Node) -> Array:
        """Return what the noise grows with at rows (n,)."""
        if node[2] == 0:
            return np.ones(len(rows.velocity))
        return self.reference(rows) / self.frame.size

    def random(self, rows: Rows) -> tuple[Array, NDArray[np.str_]]:
        """Return the columns of what is always there (n, m), and the group of each (m,)."""
        frame, result = self.frame, list[tuple[str, Array]]()
        side, size = rows.direction, frame.size
        grown = self.reference(rows) * side
        ones, along = np.ones(len(side)), rows.velocity / frame.fastest
        if frame.both:
            result.append(("offset", size * ones))
            u = rows.speed / frame.fastest
            result.append(("viscous_direction", size * np.column_stack([u, np.sqrt(u) - u])))
            if frame.loaded:
                result.append(("offset", size * rows.load / frame.load))
        result.append(("drift", grown[:, None] * drifts(rows.order)))
        if frame.runs > 1:
            own = (rows.run[:, None] == np.arange(frame.runs)).astype(float)
            parts_of_runs = self.run_parts(rows)[:, :, None] * own[:, None, :]
            result.append(("run", parts_of_runs.reshape(len(side), -1)))
        for name, mean in frame.means.items():
            z = (rows.inputs[name] - mean) / frame.spans[name]
            result.append((f"level*{name}", size * frame.grown(rows) * side * z))
            result.append((f"viscous*{name}", size * along * z))
            # about its mean over the readings: between two temperatures it is no level of friction
            bent = z * z - frame.squares[name]
            bend = [grown * bent, grown * z * np.log(np.abs(along) + 1e-3)]
            result.append((f"level bend*{name}", BEND * np.column_stack(bend)))
            result.append((f"viscous bend*{name}", BEND * size * along * bent))
        process = frame.basis(rows)
        result.append(("delta", process * side[:, None]))
        if frame.loaded:
            z = np.log(rows.load / frame.load)
            result.append(("bend", BEND * np.column_stack([grown * z, 0.5 * grown * z * z])))
            result.append(("delta", 0.4 * process * (side * z)[:, None]))
        if frame.both:
            result.append(("sides", process))
        parts = [np.reshape(x, (len(side), -1)) for _, x in result]
        names = [
            name for (name, _), x in zip(result, parts, strict=True) for _ in range(x.shape[1])
        ]
        return np.hstack(parts), np.array(names)

    def run_parts(self, rows: Rows) -> Array:
        """Return what may differ from run to run (n, 2): all friction, or a level.

        A mounting or a seal changes the level alone: with friction in proportion alone, what that
        left was a drift, and laws of two days lay 8 % beside their mean.
        """
        level = self.frame.size * self.frame.grown(rows)
        both = np.column_stack([self.reference(rows), level]) * rows.direction[:, None]
        return np.asarray(both)

    def run_deviations(self, node: Node) -> Array:
        """Return the deviations (2,) of what may differ from run to run: only one part does."""
        return RUNS[node[6]] * np.where(np.arange(2) == node[7], 1.0, 1e-6)

    def deviations(self, node: Node) -> Array:
        """Return prior deviations of the random coefficients (m,) at a node."""
        named = SIDES[node[4]]
        tau = max(self.tau(node), 1e-6 * self.sigma(node))
        apart = APART * 0.6 * self.frame.size if "sides" in named else 0.0
        sizes = {
            "offset": APART if "offset" in named else ALIKE,
            "viscous_direction": APART if "viscous_direction" in named else ALIKE,
            "drift": DRIFTS[node[5]],
            "run": 0.0,
            "bend": 1.0,
            "delta": tau,
            "sides": max(0.2 * tau, apart),
        }
        for name, own in zip(self.frame.means, node[len(SCALES) :], strict=True):
            for part, change in (("level", INPUT[own % 2]), ("viscous", INPUT[own // 2])):
                sizes[f"{part}*{name}"] = change
                sizes[f"{part} bend*{name}"] = change / INPUT[-1]
        of_runs = self.groups == "run"
        result = np.array([sizes[name] for name in self.groups])
        result[of_runs] = np.repeat(self.run_deviations(node), int(of_runs.sum()) // 2)
        return result

    def system(self, node: Node, columns: Sequence[Column]) -> System:
        """Return the normal equations of a node: blocks by Woodbury's identity."""
        x, sizes = self._law_columns(columns)
        sigma = self.sigma(node)
        alone = (node[2], node[3]) if not self.known else (node[2], node[3], node[0])
        if alone not in self._grams:
            self._grams[alone] = self._gram(node, x)
        gram, volume, inner = self._grams[alone]
        total = self.readings.total
        volume += -total * math.log(sigma) - 0.5 * inner / sigma**2
        return System(
            gram=gram / sigma**2,
            deviations=self.deviations(node),
            volume=volume,
            sizes=sizes,
        )

    def not_below_zero(self, structure: Structure) -> Array:
        return levels_at(structure, self.frame.fastest)

    def _law_columns(self, columns: Sequence[Column]) -> tuple[Array, Array]:
        """Return columns of laws (n, p) of the size of the friction, and their factors (p,)."""
        key = tuple(columns)
        if self._laws is None or (self._laws[0] is not columns and self._laws[0] != key):
            x = np.column_stack([law_column(item, self.readings.rows, self.frame) for item in key])
            least = np.sqrt(np.mean(x * x, axis=0))
            # a static surplus at speeds that were not measured is unusual far above friction
            rest = [PARTS[item[0]].curve(0.0, item[1]) if item[0] in DRY else 0.0 for item in key]
            sizes = self.frame.size / (np.maximum(least, rest) + 1e-300)
            self._laws, self._grams = (key, x * sizes, sizes), {}
        return self._laws[1], self._laws[2]

    def _gram(self, node: Node, x: Array) -> tuple[Array, float, float]:
        """Return the Gram matrix over the squared noise, minus half log |V|, and inner squares."""
        readings, sigma = self.readings, self.sigma(node)
        w, volume = self._precisions(node)
        columns = np.column_stack([self._columns, x, readings.friction])
        weighted = columns * w[:, None]
        gram = columns.T @ weighted
        shared = self.shared(node) / sigma**2
        if shared > 0.0:
            sums = np.zeros((int(self.block.max()) + 1, columns.shape[1]))
            np.add.at(sums, self.block, weighted)
            inside = np.bincount(self.block, w)
            factor = shared / (1.0 + shared * inside)
            gram = gram - (sums * factor[:, None]).T @ sums
            volume -= 0.5 * float(np.sum(np.log1p(shared * inside)))
        inner = float(np.sum(readings.within * w / readings.count))
        return gram, volume, inner

    def left_out(self, node: Node, structure: Structure) -> Array:
        """Return how far each reading is from what the others say (n,), in its deviations."""
        readings = self.readings
        laws = np.column_stack(
            [np.zeros(len(readings.friction))]
            + [law_column(item, readings.rows, self.frame) for item in structure]
        )
        laws = laws * self.frame.size / (np.sqrt(np.mean(laws**2, axis=0)) + 1e-300) * COEFFICIENT
        x = np.hstack([self._columns * self.deviations(node), laws])
        noise = (self.growth(readings.rows, node) * self.sigma(node)) ** 2
        shared = self.shared(node)
        w = self._precisions(node)[0] / self.sigma(node) ** 2
        factor = (shared / (1.0 + shared * np.bincount(self.block, w)))[self.block]
        sums = np.zeros((int(self.block.max()) + 1, x.shape[1] + 1))
        columns = np.column_stack([x, readings.friction])
        np.add.at(sums, self.block, w[:, None] * columns)
        # what blocks share and then the columns are taken off by Woodbury's identity
        solved = w[:, None] * (columns - factor[:, None] * sums[self.block])
        inner = x.T @ solved
        root = cholesky(np.eye(x.shape[1]) + inner[:, :-1], lower=True)
        taken = solve_triangular(root, solved[:, :-1].T, lower=True)
        left = solved[:, -1] - taken.T @ solve_triangular(root, inner[:, -1], lower=True)
        precision = w - w * w * factor - np.sum(taken * taken, axis=0)
        precision = np.maximum(precision, 1e-12 * w)
        variance = 1.0 / precision - noise * (1.0 / self.weights - 1.0) / readings.count
        return np.asarray(np.abs(left / precision) / np.sqrt(np.maximum(variance, 1e-30)))


def drifts(order: Array) -> Array:
    """Return courses over the order (n, 4): what settles, a line, and slow waves; 0 where any."""
    p = np.where(np.isfinite(order), order, 0.5)
    known = np.isfinite(order)[:, None]
    courses = [
        np.exp(-p / 0.25) - 0.25,
        2.0 * p - 1.0,
        0.3 * np.cos(2.0 * math.pi * p),
        0.15 * np.cos(3.0 * math.pi * p),
    ]
    return np.where(known, np.column_stack(courses), 0.0)


def blocks_of(readings: Readings) -> tuple[Integers, bool]:
    """Return the number of the block of each reading (n,), and whether some have several."""
    rows = readings.rows
    parts = [
        (np.log(rows.speed), NEAR),
        (np.log(rows.load), NEAR_LOAD),
        (rows.direction, 0.5),
        (rows.run.astype(float), 0.5),
        *((x, NEAR_LOAD * float(np.ptp(x)) + 1e-9) for x in rows.inputs.values()),
    ]
    groups = np.column_stack([_grouped(x, gap) for x, gap in parts])
    block = np.unique(groups, axis=0, return_inverse=True)[1].ravel()
    return block, bool(block.max() + 1 < len(block))


def _grouped(x: Array, gap: float) -> Integers:
    """Return the number of the group of values (n,): none spans more than a gap.

    Examples
    --------
    >>> _grouped(np.array([1.0, 1.01, 1.5, 1.02]), 0.03).tolist()
    [0, 0, 1, 0]
    """
    order = np.argsort(x, kind="stable")
    result, start, number = np.empty(len(x), dtype=np.intp), -math.inf, -1
    for row in order:
        if x[row] > start + gap:
            start, number = float(x[row]), number + 1
        result[row] = number
    return result


def step_of(readings: Readings, frame: Frame) -> float:
    """Return the step to which friction was rounded [N], if it is coarse; else 0.

    It is the least difference between readings, if that divides all others; of few values, each
    of several readings, if it divides these; of equal ones, their `resolution` or what their stated
    uncertainty allows.

    Examples
    --------
    >>> v = np.linspace(0.1, 1.0, 8)
    >>> rows = Rows(velocity=v, load=np.ones(8), inputs={}, run=np.zeros(8, int), order=v)
    >>> readings = Readings.of(rows, np.round(2.0 + v, 1))
    >>> round(step_of(readings, Frame.of(readings)), 6)
    0.1
    """
    values = np.unique(readings.friction)
    gaps = np.diff(values)
    if len(sizes := np.unique(np.abs(values))) == 1:
        stated, size = math.sqrt(12.0) * float(np.median(readings.stated)), float(sizes[0])
        return min(resolution(float(sizes[0])), stated or size, COARSEST * size)
    if 0 < len(gaps) < FEW_GAPS and len(readings.friction) >= OF_EACH * len(values):
        steps = values / gaps.min()
        if gaps.min() < COARSEST * frame.size and np.allclose(steps, np.rint(steps), 0.0, 1e-6):
            return float(gaps.min())
    # exact friction in proportion to even speeds has even gaps too, and they are all alike
    if len(gaps) < FEW_GAPS or np.any(readings.count > 1.0) or np.ptp(gaps) < 1e-3 * gaps.min():
        return 0.0
    least = float(gaps.min())
    steps = gaps / least
    divides = np.all(np.abs(steps - np.round(steps)) < 1e-6 * np.maximum(1.0, steps))
    return least if divides and least > 2e-3 * frame.size else 0.0


def resolution(size: float) -> float:
    """Return the unit of the last digit of a reading, in a unit in which it has few.

    A converted reading has many digits, those of its factor, which may be rounded. So has a
    calculated one, which is known to them; of digits without an end nothing is known.

    Examples
    --------
    >>> resolution(2.50155), round(resolution(3.1 * 4.448), 3), resolution(7.0 / 3.0)
    (1e-05, 0.445, 2.3333333333333335)
    """
    digit = last_digit([size])
    if digit > 1e-5 * size:
        return digit
    few = {x: float(f"{size / x:.3g}") for x in (factor(unit, None) for unit in READ_IN)}
    same = max(1e-6 * size, 10.0 * digit)  # to more digits, if there are more, than any number is
    near = [x * last_digit([k]) for x, k in few.items() if abs(k * x - size) < same]
    return max(near or [digit if digit > 1e-9 * size else size])


def order_of(readings: Readings) -> tuple[str, bool]:
    """Return which of "speed" and "load" explains the order, or "", and if nothing else does.

    Speeds that are shuffled at each of rising loads say more of time than a sorted file.
    """
    rows = readings.rows
    load, order = np.log(rows.load), np.arange(len(rows.load), dtype=float)
    speed, ones = _ranks(rows.speed), np.ones(len(load))
    speeds = [ones, rows.direction, speed, rows.direction * speed]
    loads = [ones, _ranks(rows.load)] if np.ptp(load) > NEAR_LOAD else [ones]
    by_speed, by_load = _explained(order, speeds), _explained(order, loads)
    if max(by_speed, by_load, _explained(order, speeds + loads)) <= FOLLOWS:
        return "", False
    if by_speed > min(by_load, FOLLOWS):
        return "speed", True
    group = _grouped(load, NEAR_LOAD)
    within = order - (np.bincount(group, order) / np.bincount(group))[group]
    return "load", not within.any() or _explained(within, speeds) > FOLLOWS


def _ranks(x: Array) -> Array:
    """Return the places of numbers (n,) in their order; equal ones share a place."""
    ordered = np.sort(x)
    return np.asarray(np.searchsorted(ordered, x) + np.searchsorted(ordered, x, side="right"))


def _explained(x: Array, columns: Sequence[Array]) -> float:
    """Return the share of numbers (n,) that columns (n,) explain, less what as many do by chance.

    Examples
    --------
    >>> x = np.arange(6.0)
    >>> _explained(x, [x**0, x]), _explained(np.array([0.0, 1, 1, 0]), [x[:4] ** 0, x[:4]]) < 0.0
    (1.0, True)
    """
    table = np.column_stack(columns)
    c, _, rank, _ = np.linalg.lstsq(table, x, rcond=None)
    free = len(x) - int(rank)
    left = float(np.var(x - table @ c) / np.var(x))
    return 1.0 - left * (len(x) - 1) / free if free else 0.0


@dataclass(frozen=True, eq=False)
class TableFit:
    """A posterior of a table with its model."""

    model: TableModel
    posterior: Posterior
    far: Array
    """How far each reading is from what the others say (n,), in its deviations."""
    priors: Array
    """Logarithms of the priors of the structures (s,)."""
    evidence: float
    """Logarithm of the evidence with the prior of each outlier; a far reading at an end is none."""


def first_weights(readings: Readings, frame: Frame, smooth: Array) -> Array:
    """Return weights (n,) by which a reading that is far from its neighbours hardly counts."""
    left = np.abs(np.abs(readings.friction) - smooth)
    middle = max(1.5 * float(np.median(left)) + 1e-9 * frame.size, 0.01 * frame.size)
    z = left / middle
    return np.where(z > 6.0, np.minimum(1.0, (3.0 / np.maximum(z, 1e-9)) ** 2), 1.0)


def compared(fit: TableFit, families: Sequence[Family] | None = None) -> TableFit:
    """Return a fit, or that of readings that all count, if it is as probable.

    Cells of many readings tell which are outliers.
    """
    readings = fit.model.readings
    if fit.evidence < fit.posterior.evidence and readings.total == len(readings.friction):
        every = fitted(readings, families, suspected=False)
        if every.evidence > fit.evidence:
            return every
    return fit


def fitted(
    readings: Readings, families: Sequence[Family] | None = None, *, suspected: bool = True
) -> TableFit:
    """Return the posterior of readings: over some families, or those of the vocabulary.

    Some may be `suspected` to be outliers.
    """
    frame = Frame.of(readings)
    grid = Grid(slowest=frame.slowest, fastest=frame.fastest, fine=2.0 if frame.loaded else 3.0)
    known = families_at(readings.rows) if families is None else [*families]
    grown, order = frame.grown(readings.rows), np.argsort(readings.rows.speed, kind="stable")
    over = running_medians(readings, grown)
    smooth = np.log(readings.rows.speed[order]), over[order]
    reference = Reference(
        frame, lambda rows: np.interp(np.log(rows.speed), *smooth) * frame.grown(rows)
    )
    weights = first_weights(readings, frame, over * grown) if suspected else np.ones(len(over))
    model = TableModel(readings, frame, weights, reference)
    structures, priors = structures_of(frame, grid, known)
    posterior = Posterior(model, structures, priors, begin=model.begin(), most=0)
    structures, priors = _refined(posterior, priors, grid, frame)
    part = 1.0 / 9.0
    for _ in range(1, FINER):  # as finely as the readings tell shapes
        posterior = Posterior(model, structures, priors, begin=[posterior.best], most=0)
        again = _finer_still(posterior, priors, grid, frame, part)
        if len(again[0]) == len(structures):
            break
        structures, priors = again
        part /= 3.0
    begin, far = [posterior.best], np.zeros(len(weights))
    for turn in range(TURNS + FINER):
        if turn:
            model = TableModel(readings, frame, weights, reference)
        posterior = Posterior(model, structures, priors, begin=begin, most=MOST if turn else FIRST)
        if not turn:
            kept = [k for some in _near(posterior, LOST) for k in some]
            structures = [structures[k] for k in kept]
            structures, priors = _with_breaks(structures, priors[kept], readings.rows, frame)
        again = _finer_still(posterior, priors, grid, frame, part) if turn else (structures, priors)
        begin, before = [posterior.best], weights
        structure = posterior.law_at(posterior.best)
        far = model.left_out(posterior.best, structure)
        bound = SUSPECT[0] + SUSPECT[1] / max(len(far) - 3, 1)
        freedom = THRESHOLDS.freedom
        if suspected:
            weights = np.where(far > bound, (freedom + 1.0) / (freedom + far**2), 1.0)
        reference = Reference(
            frame, LawCurve(frame, structure, posterior.estimate(posterior.best, structure)[0])
        )
        settled = turn + 1 >= TURNS or bool(turn and np.allclose(before, weights, atol=0.15))
        coarse = len(again[0]) > len(structures)  # the noise is less than it was taken
        if turn + 1 == TURNS + FINER or (settled and not coarse):
            break
        if coarse:
            structures, priors, part = *again, part / 3.0
    prior = math.log(OUTLIER_PRIOR) * np.sum((model.weights < 1.0) & ~ends_of(readings.rows))
    return TableFit(model, posterior, far, priors, posterior.evidence + float(prior))


def _near(posterior: Posterior, depth: float) -> tuple[list[int], list[int]]:
    """Return the structures within a depth of the best, and the best of each other family."""
    value, best = np.log(posterior.shares + 1e-300), dict[Family, int]()
    order = np.argsort(-value, kind="stable").tolist()
    near = [k for k in order if value[k] > value[order[0]] - depth][:KEPT]
    for k in [*near, *order]:
        best.setdefault(family_of(posterior.structures[k]), k)
    return near, [k for k in best.values() if k not in near]


def _refined(
    posterior: Posterior, priors: Array, grid: Grid, frame: Frame
) -> tuple[list[Structure], Array]:
    """Return the best structures with their neighbours, and the best of each other family."""
    near, others = _near(posterior, BEHIND)
    result: dict[Structure, float] = {}
    for k in near:
        many = finer(posterior.structures[k], grid, frame)
        for item in many:
            result.setdefault(item, float(priors[k]) - math.log(len(many)))
    result |= {posterior.structures[k]: float(priors[k]) for k in others}
    return [*result], np.array([*result.values()])


def _finer_still(
    posterior: Posterior, priors: Array, grid: Grid, frame: Frame, part: float
) -> tuple[list[Structure], Array]:
    """Return structures with more steps of each shape that is told to about a step of its grid.

    Shapes under one exponent of fading are judged together, each for itself: of two, one may be
    told much better. A point of the prior, such as the proportion to the load, is no step.
    """
    shares, result = posterior.shares, dict(zip(posterior.structures, priors.tolist(), strict=True))
    of: dict[tuple[Family, int, tuple[float, ...]], list[int]] = {}
    for k, structure in enumerate(posterior.structures):
        fading = tuple(shape[1] for name, shape in structure if name in ("stribeck", "hersey"))
        key = family_of(structure), len(_entries(structure)), fading
        of.setdefault(key, []).append(k)
    for some in of.values():
        if (total := float(shares[some].sum())) < LEAST_SHARE:
            continue
        moves = {k: finer(posterior.structures[k], grid, frame, part) for k in some}
        entries = {k: np.array([_entries(item) for item in moves[k]]) for k in some}
        coarse = np.zeros(entries[some[0]].shape[1], dtype=bool)
        for entry in range(len(coarse)):
            free = [k for k in some if np.ptp(entries[k][:, entry]) > 0.0]
            values = [float(f"{_entries(posterior.structures[k])[entry]:.9g}") for k in free]
            own = np.bincount(np.unique(values, return_inverse=True)[1], shares[free])
            told = own.sum() ** 2 <= RESOLVED * np.sum(own**2)
            coarse[entry] = own.sum() >= LEAST_SHARE and told
        order = np.array(some)[np.argsort(-shares[some], kind="stable")]
        enough = int(np.searchsorted(np.cumsum(shares[order]), 0.99 * total)) + 1
        for k in order[:enough] if coarse.any() else ():
            same = np.isclose(entries[k], _entries(posterior.structures[k]), rtol=1e-9)
            kept = np.flatnonzero(np.all(same | coarse, axis=1))
            prior = result[posterior.structures[k]] - math.log(len(kept))
            result |= {moves[k][at]: prior for at in kept}
    return [*result], np.array([*result.values()])


def _entries(structure: Structure) -> list[float]:
    """Return the entries of all shapes of a structure."""
    return [x for _, shape in structure for x in shape]


def _with_breaks(
    structures: Sequence[Structure], priors: Array, rows: Rows, frame: Frame
) -> tuple[list[Structure], Array]:
    """Return structures, the most likely first, and these beside a jump or a kink."""
    result = dict(zip(structures, priors.tolist(), strict=True))
    for name in breaks_of(frame):
        gaps = gaps_of(rows, name.partition(" ")[2])
        if not 0 < len(gaps) <= MOST_GAPS:
            continue
        if name.startswith(KINK):  # where in a gap a slope changes, readings show
            points = [
                low + (high - low) * (k + 0.5) / FINE for low, high in gaps for k in range(FINE)
            ]
            gaps = list(itertools.pairwise(points))
        prior = math.log(JUMP_PRIOR / len(gaps))
        for structure, own in zip(structures[:JUMPS], priors.tolist(), strict=False):
            result |= {tuple(sorted((*structure, (name, gap)))): own + prior for gap in gaps}
    return [*result], np.array([*result.values()])
