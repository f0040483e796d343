r"""Refinement: the laws of a free motion, by runs of the motion.

A free motion has no force. Its balance of energy or momentum (`problems.free_balance`)
gives families of laws and values to start from; what is stated comes from runs with all of this
unknown at once:

.. math::
    \tau(u) = \sum_t c_t\, g_t(u; \theta_t) + \tau_0(u) \sum_k \delta_k T_k(\log u) ,

coefficients and shapes of the law, what no law says (:math:`\delta`, values at `KNOTS` speeds that
multiply a *fixed* curve :math:`\tau_0`, as :math:`c (1 + \delta)` would be bilinear), what no
balance sees of the mechanism (a length or stiffness), and of each record how it starts and the zero
of its readings.

1. **Gauss-Newton** along the sensitivities of the engine, from runs of some swings to runs of all
   without :math:`\delta`, then with it; a step is damped until it gains.
2. **Laplace's approximation** about the mode: with residuals :math:`r`, slopes :math:`A`, the
   precision :math:`P` of the prior and the reading error :math:`\sigma`, that of the unknowns is
   :math:`H = \kappa A^T A / \sigma^2 + P`, and

   .. math::
       \log p(y \mid \text{law}, \rho) = -\tfrac12 \left( \kappa |r|^2 / \sigma^2 + |x - m|_P^2
       + \log|H| - \log|P| \right) + \sum_t \log 2 \Phi(c_t / s_t) .

   The size :math:`\rho` of :math:`\delta`, as a share of friction, is a scale of the posterior, and
   is where most of it is at each step.
3. **Readings are not independent** where something that no law says is left: :math:`\kappa` is the
   sum of the squared scores of rows over that of their sums over `BLOCKS` blocks.

The weights of families at sizes, and draws, are read as those of any posterior.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.special import log_ndtr, logsumexp

from stickslip.engine.solver import BareRun, EventDriven
from stickslip.errors import InputError
from stickslip.friction import SetValuedLaw
from stickslip.identify.posterior import Array, Draws, Family, Node, Structure, allotted
from stickslip.identify.vocabulary import FAMILIES, PARTS, PLACE
from stickslip.maths import Scalar, log, where
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised, Quantity, parameters, vary

SOLVER = EventDriven(tier="compiled", tolerance=1e-9, stiff_tolerance=1e-6, max_steps=100_000)
"""Six digits below the noise of any record."""
KNOTS = 9
"""Speeds at which what no law says is free."""
CORRELATION = 1.0
"""E-folds of speed over which it is correlated (Matern 3/2)."""
SIZES = (0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
SIZE_PRIOR = (0.4, *(0.6 / 7.0,) * 7)
"""Sizes of what no law says, as a share of the fixed curve, and their prior. It grows as far as it
has to: stopped at .2, bands outside the vocabulary held .66."""
COEFFICIENT = 1.5
"""Prior standard deviation of a coefficient, over the size of the friction."""
RATIO = 0.01
"""Prior standard deviation of a length or stiffness, as a share, if none is stated."""
START, ZERO = 0.3, 0.03
"""Prior standard deviations of how a motion starts and of its zero, over its range."""
STAGES = (6, 20)
"""Turns of the first runs: a swing is predictable for some, as its phase is."""
ROUNDS = 10
"""Steps of Gauss-Newton in a stage."""
LEAST_DAMPING, DAMPED = 1e-4, 8
"""Least damping of a step that gained nothing, over the curvature, and how often it is raised."""
GAIN = 0.05
"""Gain of the logarithm of the posterior below which a mode has been met."""
LOST = 0.1
"""Scatter about the runs of a family, over the range, from which they begin once more."""
BLOCKS = 100
"""Blocks of rows, over all records, whose scores count as independent."""
ROUNDED = 1e-13
"""Least eigenvalue of a precision of unit diagonal, over the largest: what is below is rounding."""
RUNS, RUN_PRIOR = (0.005, 0.02, 0.08), (0.35, 0.45, 0.2)
"""By how much friction of another run may differ, as a share, and the prior: as of driven axes."""
SPARE = 6
"""Draws for each that is kept, so that those that are physics suffice."""
LEAST = 1e-6
"""Least friction of the fixed curve, over its root mean square."""


@dataclass(frozen=True, kw_only=True)
class Number(Parametrised):
    """A number of a law, which may be fitted."""

    value: Annotated[float, Quantity("c")]


@dataclass(frozen=True, kw_only=True)
class Term(Parametrised):
    """A part of a law with its coefficient."""

    part: str
    coefficient: Annotated[float, Quantity("c")]
    shape: tuple[Number, ...] = ()

    def at(self, speed: Scalar) -> Scalar:
        """Return its friction at a speed."""
        return self.coefficient * PARTS[self.part].curve(speed, [one.value for one in self.shape])


@dataclass(frozen=True, kw_only=True)
class RunLaw(SetValuedLaw):
    """A law and what no law says, as a run takes it: friction as a force, whatever the load."""

    name: ClassVar[str] = "refined"
    title: ClassVar[str] = "Law with what no law says"
    formula: ClassVar[str] = r"F = \tau(|v|)"
    sources: ClassVar[tuple[str, ...]] = ()

    terms: tuple[Term, ...]
    """The law."""
    fixed: tuple[Term, ...]
    """The curve that what no law says multiplies."""
    waves: tuple[Number, ...]
    """What no law says: coefficients of Chebyshev polynomials of the logarithm of the speed."""
    slowest: Annotated[float, Quantity("v", above=0)]
    fastest: Annotated[float, Quantity("v", above=0)]

    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        friction = sum(one.at(speed) for one in self.terms)
        if not self.waves:
            return friction
        low = self.slowest
        half = log(self.fastest / low)
        x = log((speed * speed + low * low) / (self.fastest * low)) / half
        before, own = 1.0, x
        share = self.waves[0].value + self.waves[1].value * x
        for one in self.waves[2:]:
            before, own = own, 2.0 * x * own - before
            share = share + one.value * own
        return friction + share * sum(one.at(speed) for one in self.fixed)

    def break_away(self, load: Scalar) -> Scalar:
        at_rest = self.sliding(0.0, load)
        return where(at_rest > 0.0, at_rest, 0.0)


@dataclass(frozen=True, kw_only=True, eq=False)
class Motion:
    """A free motion as it was recorded."""

    mechanism: Mechanism
    """What moves, with what is given of it."""
    time: Array
    """Times (n,) from 0 [s]."""
    values: Array
    """Positions (n,) [m], or velocities."""
    start: tuple[float, float]
    """Position and velocity at time 0, about."""
    located: bool = True
    """Whether positions were recorded."""
    turns: Array = field(default_factory=lambda: np.zeros(0))
    """Times at which it turns."""

    @cached_property
    def noise(self) -> float:
        """Standard deviation of the noise of a reading, by third differences."""
        return max(float(np.std(np.diff(self.values, 3))) / math.sqrt(20.0), 1e-9 * self.range)

    @cached_property
    def range(self) -> float:
        """Range of the readings."""
        return float(np.ptp(self.values)) + 1e-300

    def first(self, turns: int | None) -> int:
        """Return the number of rows until some turns; all of them if none are given."""
        if turns is None or len(self.turns) <= turns:
            return len(self.time)
        return int(np.searchsorted(self.time, self.turns[turns]))


@dataclass(frozen=True, kw_only=True)
class Unseen:
    """A parameter of the mechanism that no balance of a free motion sees."""

    path: str
    value: float
    deviation: float = RATIO
    """Standard deviation of its logarithm before the motion."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Candidate:
    """A structure from which the runs of its family begin."""

    structure: Structure
    coefficients: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Linear:
    """Runs linearised about some values of the unknowns."""

    x: Array
    residual: Array
    slopes: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Mode:
    """Laplace's approximation for one size of what no law says."""

    evidence: float
    x: Array
    covariance: Array
    left: float
    """Squares that are left of the readings."""


@dataclass(frozen=True, kw_only=True, eq=False)
class FreeMotion:
    """Free motions of one mechanism, and by what their unknowns are scaled."""

    motions: Sequence[Motion]
    size: float
    """Root mean square of the friction [N]."""
    slowest: float
    fastest: float
    """Range of the speeds that were seen [m/s]."""
    fixed: tuple[Term, ...]
    """The curve that what no law says multiplies."""
    unseen: tuple[Unseen, ...] = ()

    @property
    def paths(self) -> list[str]:
        """Paths of what no balance sees of the mechanism."""
        return [one.path for one in self.unseen]

    def values(self, logs: Array, motion: Motion | None = None) -> Array:
        """Return it for logarithms of it over its given values (..., p), as it is in a motion."""
        given = [one.value for one in self.unseen]
        if motion is not None:
            known = {path: x for path, _, x in parameters(motion.mechanism, "mechanism")}
            given = [known[path] for path in self.paths]
        return np.asarray(np.array(given) * np.exp(logs))

    @cached_property
    def knots(self) -> Array:
        """Logarithms of the speeds of what no law says: Chebyshev's, on which no wave grows."""
        at = np.cos(math.pi * (np.arange(KNOTS)[::-1] + 0.5) / KNOTS)
        low, high = math.log(self.slowest), math.log(self.fastest)
        return 0.5 * (low + high) + 0.5 * (high - low) * at

    @cached_property
    def waves(self) -> Array:
        """Coefficients of waves for values at the knots (k, k)."""
        at = np.cos(math.pi * (np.arange(KNOTS)[::-1] + 0.5) / KNOTS)
        table = np.polynomial.chebyshev.chebvander(at, KNOTS - 1)
        return np.asarray(np.linalg.inv(table))

    @cached_property
    def roughness(self) -> Array:
        """Precision of the values at the knots for a size of 1 (k, k)."""
        apart = np.abs(self.knots[:, None] - self.knots) * math.sqrt(3.0) / CORRELATION
        return np.asarray(np.linalg.inv((1.0 + apart) * np.exp(-apart) + 1e-6 * np.eye(KNOTS)))

    def beside(self, speed: Array) -> Array:
        """Return friction at speeds for values of 1 at each knot alone (n, k)."""
        low, fixed = self.slowest, sum(one.at(speed) for one in self.fixed)
        x = np.log((speed**2 + low**2) / (self.fastest * low)) / math.log(self.fastest / low)
        table = np.polynomial.chebyshev.chebvander(x, KNOTS - 1) @ self.waves
        return np.asarray(table * np.reshape(fixed, (-1, 1)))


class Runs:
    """Runs of the motions with one family of laws.

    The unknowns are, in this order: coefficients over their prior's size, logarithms of shapes,
    what no law says at the knots, the logarithm of what is unseen over its given value, and of each
    motion its position and velocity at the start and its zero.
    """

    def __init__(self, motion: FreeMotion, candidate: Candidate) -> None:
        self.motion, self.structure = motion, candidate.structure
        self.shapes = [
            (term, entry)
            for term, (name, _) in enumerate(self.structure)
            for entry, kind in enumerate(PARTS[name].shapes)
            if kind in ("speed", "exponent")
        ]
        d, e = len(self.structure), len(self.shapes)
        self.law, self.logs = slice(0, d), slice(d, d + e)
        self.knots = slice(d + e, d + e + KNOTS)
        self.ratio = slice(d + e + KNOTS, d + e + KNOTS + len(motion.unseen))
        self.starts = slice(self.ratio.stop, self.ratio.stop + 3 * len(motion.motions))
        self.sizes = COEFFICIENT * np.array([self._size(one) for one in self.structure])
        self.mean, self.deviations = self._prior()
        self.first = self.mean.copy()
        self.first[self.law] = candidate.coefficients / self.sizes
        self.first[self.logs] = [
            math.log(self.structure[term][1][entry]) for term, entry in self.shapes
        ]

    def _size(self, column: tuple[str, tuple[float, ...]]) -> float:
        """Return the coefficient with which a term alone would be friction of the usual size."""
        speed = np.geomspace(self.motion.slowest, self.motion.fastest, 40)
        curve = PARTS[column[0]].curve(speed, column[1]) * np.ones(40)
        return self.motion.size / (math.sqrt(float(np.mean(curve**2))) + 1e-300)

    def _prior(self) -> tuple[Array, Array]:
        """Return means and standard deviations of the unknowns; those of the knots are 1."""
        motion = self.motion
        mean, deviations = np.zeros(self.starts.stop), np.ones(self.starts.stop)
        low, high = math.log(motion.slowest), math.log(motion.fastest)
        for at, (term, entry) in enumerate(self.shapes, self.logs.start):
            is_speed = PARTS[self.structure[term][0]].shapes[entry] == "speed"
            mean[at] = 0.5 * (low + high) if is_speed else math.log(0.8)
            deviations[at] = max((high - low) / math.sqrt(12.0), 0.5) if is_speed else 0.6
        deviations[self.ratio] = [one.deviation for one in motion.unseen]
        for k, one in enumerate(motion.motions):
            at = self.starts.start + 3 * k
            rate = START * one.range / max(float(one.time[-1]), 1e-300) * (len(one.turns) + 1.0)
            speed, place = max(abs(one.start[1]), rate), max(abs(one.start[0]), one.range)
            mean[at : at + 2] = one.start
            deviations[at : at + 3] = START * place, START * speed, ZERO * one.range
            if not one.located:
                deviations[at : at + 2] = START * place, START * one.range
        return mean, deviations

    def precision(self, size: float) -> Array:
        """Return the precision of the prior (m, m) for a size of what no law says."""
        found = np.diag(self.deviations**-2.0)
        found[self.knots, self.knots] = self.motion.roughness / max(size, 1e-6) ** 2
        return found

    def shaped(self, x: Array) -> Structure:
        """Return the structure with the shapes of some unknowns."""
        shapes = [list(shape) for _, shape in self.structure]
        for (term, entry), value in zip(self.shapes, x[self.logs], strict=True):
            shapes[term][entry] = math.exp(value)
        names = [name for name, _ in self.structure]
        return tuple((n, tuple(s)) for n, s in zip(names, shapes, strict=True))

    def _law(self, x: Array) -> RunLaw:
        return RunLaw(
            terms=tuple(
                Term(part=n, coefficient=float(c), shape=tuple(Number(value=v) for v in shape))
                for (n, shape), c in zip(self.shaped(x), x[self.law] * self.sizes, strict=True)
            ),
            fixed=self.motion.fixed,
            waves=tuple(Number(value=float(w)) for w in self.motion.waves @ x[self.knots]),
            slowest=self.motion.slowest,
            fastest=self.motion.fastest,
        )

    def run(self, x: Array, turns: int | None = None) -> "tuple[Array, list[BareRun]] | None":
        """Return what runs leave of the readings, with the runs; None where a run fails."""
        motion, left, runs = self.motion, list[Array](), list[BareRun]()
        if not np.all(np.isfinite(x)) or np.any(np.abs(x[self.logs] - self.mean[self.logs]) > 12.0):
            return None
        law = self._law(x)
        try:
            for one, (q, v, zero) in zip(
                motion.motions, x[self.starts].reshape(-1, 3), strict=True
            ):
                mechanism = one.mechanism
                if motion.unseen:
                    values = motion.values(x[self.ratio], one).tolist()
                    own = dict(zip(motion.paths, values, strict=True))
                    mechanism = vary(mechanism, "mechanism", own)
                rows = one.first(turns)
                run = SOLVER.bare(mechanism, law, y0=[q, v], t_end=float(one.time[rows - 1]))
                if not run.status.complete:
                    return None
                left.append(one.values[:rows] - run.at(one.time[:rows])[:, 1 - one.located] - zero)
                runs.append(run)
        except InputError:  # a value out of its range
            return None
        residual = np.concatenate(left)
        return (residual, runs) if np.all(np.isfinite(residual)) else None

    @cached_property
    def _paths(self) -> list[str]:
        """Paths of what the engine gives sensitivities of, the start last."""
        mechanism = self.motion.motions[0].mechanism
        names = [*mechanism.coordinates, *mechanism.rates]
        return [
            *(f"friction.terms.{k}.coefficient" for k in range(len(self.structure))),
            *(f"friction.terms.{term}.shape.{entry}.value" for term, entry in self.shapes),
            *(f"friction.waves.{k}.value" for k in range(KNOTS)),
            *self.motion.paths,
            *(f"initial.{name}" for name in names),
        ]

    def _slopes(self, x: Array, runs: "Sequence[BareRun]", turns: int | None) -> Array:
        """Return the slopes of the runs by the unknowns (n, m)."""
        motion, found = self.motion, list[Array]()
        for k, (one, run) in enumerate(zip(motion.motions, runs, strict=True)):
            rows = one.first(turns)
            table = run.differentiate(one.time[:rows], self._paths)[:, 1 - one.located, :]
            # what a run has no slope by stays where it is
            table = np.where(np.isfinite(table).all(axis=0), table, 0.0)
            own = np.zeros((rows, len(x)))
            own[:, self.law] = table[:, self.law] * self.sizes
            own[:, self.logs] = table[:, self.logs] * np.exp(x[self.logs])
            own[:, self.knots] = table[:, self.knots] @ motion.waves
            own[:, self.ratio] = table[:, self.ratio] * motion.values(x[self.ratio], one)
            at = self.starts.start + 3 * k
            own[:, at : at + 2] = table[:, self.ratio.stop :]
            own[:, at + 2] = 1.0 * one.located
            found.append(own)
        return np.vstack(found)

    def solved(
        self, x: Array, *, turns: int | None = None, free: "NDArray[np.bool_] | None" = None
    ) -> Linear | None:
        """Return runs linearised about the mode near some unknowns; None where none can be made.

        With `free`, only those are looked for; else also the size of what no law says.
        """
        made = self.run(x, turns)
        if made is None:
            return None
        linear = Linear(x=x, residual=made[0], slopes=self._slopes(x, made[1], turns))
        at = np.flatnonzero(np.ones(len(x), dtype=bool) if free is None else free)
        damping = 0.0
        for _ in range(ROUNDS):
            sigma = self.noise if free is not None else self.scatter(linear)
            size = 0.0 if free is not None else self._likeliest(linear, sigma)
            precision, off = self.precision(size), linear.x - self.mean
            slopes = linear.slopes[:, at] / sigma
            gram = slopes.T @ slopes + precision[np.ix_(at, at)]
            pull = slopes.T @ linear.residual / sigma - (precision @ off)[at]
            least = _cost(linear.residual / sigma, off, precision)
            gain = 0.0
            for _ in range(DAMPED):
                x = linear.x.copy()
                x[at] += _inverse(gram + damping * np.diag(np.diag(gram)))[0] @ pull
                made = self.run(x, turns)
                if made is not None:
                    gain = least - _cost(made[0] / sigma, x - self.mean, precision)
                    if gain > 0.0:
                        break
                damping = max(10.0 * damping, LEAST_DAMPING)
            if made is None or not gain > 0.0:
                break
            damping = 0.03 * damping if damping > LEAST_DAMPING else 0.0
            linear = Linear(x=x, residual=made[0], slopes=self._slopes(x, made[1], turns))
            if gain < GAIN:
                break
        return linear

    def _likeliest(self, linear: Linear, sigma: float) -> float:
        """Return the size of what no law says, above 0, that is most likely."""
        evidence = [self.mode(linear, size, sigma).evidence for size in SIZES[1:]]
        return SIZES[1 + int(np.argmax(evidence))]

    def mode(self, linear: Linear, size: float, sigma: float, kappa: float = 1.0) -> Mode:
        """Return Laplace's approximation of a linearisation for a size of what no law says."""
        precision, weight = self.precision(size), kappa / sigma**2
        gram = weight * linear.slopes.T @ linear.slopes + precision
        off = self.mean - linear.x
        covariance, volume = _inverse(gram)
        step = covariance @ (weight * linear.slopes.T @ linear.residual + precision @ off)
        left = linear.residual - linear.slopes @ step
        quadratic = weight * float(left @ left) + float((step - off) @ precision @ (step - off))
        x = linear.x + step
        evidence = 0.5 * (np.linalg.slogdet(precision)[1] - volume - quadratic)
        for place in self.positive:
            z = x[place] / math.sqrt(covariance[place, place])
            evidence += float(log_ndtr(z)) + math.log(2.0)
        return Mode(evidence=float(evidence), x=x, covariance=covariance, left=float(left @ left))

    @cached_property
    def positive(self) -> list[int]:
        """Unknowns that are not negative."""
        return [k for k, (name, _) in enumerate(self.structure) if not PARTS[name].signed]

    def followed(self, near: Array) -> Array:
        """Return what a run of this very law leaves of the readings, from starts near some (n,).

        Only the starts and what is unseen of the mechanism are free.
        """
        x, free = self.first.copy(), np.zeros(self.starts.stop, dtype=bool)
        x[self.ratio.start :], free[self.ratio.start :] = near, True
        linear = self.solved(x, free=free)
        count = sum(len(one.time) for one in self.motion.motions)
        return np.full(count, np.inf) if linear is None else linear.residual

    @property
    def told(self) -> "NDArray[np.bool_]":
        """All unknowns but what no law says (m,)."""
        found = np.ones(self.starts.stop, dtype=bool)
        found[self.knots] = False
        return found

    def refined(self, near: Array | None = None) -> Linear | None:
        """Return the runs about the mode: from some turns to all, then with what no law says.

        What the unknowns of the mechanism and the starts were in another family is a better start.
        """
        x, stages = self.first.copy(), [n for n in STAGES if self._has(n)]
        if near is not None:
            x[self.ratio.start :], stages = near, []
        for turns in (*stages, None):
            linear = self.solved(x, turns=turns, free=self.told)
            x = x if linear is None else linear.x
        return self.solved(x)

    def _has(self, turns: int) -> bool:
        return any(len(one.turns) > turns for one in self.motion.motions)

    @property
    def noise(self) -> float:
        """Standard deviation of the noise of readings, by third differences."""
        return math.sqrt(float(np.mean([one.noise**2 for one in self.motion.motions])))

    def scatter(self, linear: Linear) -> float:
        """Return the standard deviation of what runs leave of the readings."""
        freedom = max(len(linear.residual) - len(linear.x), 1)
        return max(math.sqrt(float(linear.residual @ linear.residual) / freedom), 0.1 * self.noise)


def _inverse(matrix: Array) -> tuple[Array, float]:
    """Return the inverse of a positive matrix whose entries differ in size, and log|matrix|."""
    size = np.sqrt(np.diag(matrix))
    values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    values = np.maximum(values, ROUNDED * values[-1])
    own = vectors / np.sqrt(values) / size[:, None]
    return own @ own.T, float(np.sum(np.log(values)) + 2.0 * np.sum(np.log(size)))


def _cost(residual: Array, off: Array, precision: Array) -> float:
    """Return twice the negative logarithm of the posterior: of residuals over their deviation."""
    return float(residual @ residual + off @ precision @ off)


class RunPosterior:
    """The weights of families at sizes of what no law says, by runs.

    Parameters
    ----------
    motion : FreeMotion
        What was recorded.
    candidates : sequence of Candidate
        Where the runs of each family begin, the most likely first.
    """

    def __init__(self, motion: FreeMotion, candidates: Sequence[Candidate]) -> None:
        self.motion = motion
        found = list[tuple[Runs, Linear]]()
        for one in candidates:
            runs = Runs(motion, one)
            best = min(found, key=lambda pair: pair[0].scatter(pair[1]), default=None)
            near = None if best is None else best[1].x[best[0].ratio.start :]
            linear = runs.refined(near)
            lost = linear is None or runs.scatter(linear) > LOST * motion.motions[0].range
            if near is not None and lost:  # the way of another family leads nowhere
                linear = runs.refined() or linear
            if linear is not None:
                found.append((runs, linear))
        if not found:
            raise InputError(
                "no run of a law follows this free motion: check mass, length and stiffness of the"
                " mechanism, and that nothing drives the motion."
            )
        self.runs, self.linear = zip(*found, strict=True)
        runs, linear = min(found, key=lambda pair: pair[0].scatter(pair[1]))
        self.sigma = runs.scatter(linear)
        """Standard deviation of the readings about the closest run."""
        self.kappa = worth(linear, runs.precision(SIZES[2]), self.sigma)
        """What a reading is worth, over one whose error is its own."""
        self.modes = [
            [own.mode(one, size, self.sigma, self.kappa) for own, one in found] for size in SIZES
        ]
        self.nodes: tuple[Node, ...] = tuple((k,) for k in range(len(SIZES)))
        self.structures: tuple[Structure, ...] = tuple(own.shaped(one.x) for own, one in found)
        self.families: list[Family] = [tuple(name for name, _ in one) for one in self.structures]
        places = [FAMILIES.get(" ".join(one), max(FAMILIES.values())) for one in self.families]
        table = np.array(
            [[self._evidence(s, one) for s, one in enumerate(row)] for row in self.modes]
        )
        table += np.log(SIZE_PRIOR)[:, None] - PLACE * np.array(places)
        # without a law, what multiplies a curve is no friction
        table[1:, [not one for one in self.structures]] = -np.inf
        self.weights: Array = np.exp(table - logsumexp(table))
        """Posterior probabilities of sizes and families (k, s), in sum 1."""

    def _evidence(self, place: int, mode: Mode) -> float:
        """Return the evidence of a mode with what a run there leaves, not the linear one."""
        made = self.runs[place].run(mode.x)
        left = math.inf if made is None else float(made[0] @ made[0])
        return mode.evidence - 0.5 * self.kappa / self.sigma**2 * (left - mode.left)

    @property
    def shares(self) -> Array:
        """Posterior probabilities of the families (s,)."""
        return np.asarray(self.weights.sum(axis=0))

    @property
    def best(self) -> tuple[int, int]:
        """Place of the largest weight: size, family."""
        k, s = np.unravel_index(int(np.argmax(self.weights)), self.weights.shape)
        return int(k), int(s)

    def draws(self, count: int, *, seed: int = 0, only: Array | None = None) -> list[Draws]:
        """Return `count` draws, each with its own shapes, in the order of sizes and families.

        The random coefficients are what no law says at the knots, and behind it what is unseen of
        the mechanism, if anything, and how each motion starts.
        """
        weights = self.weights if only is None else np.where(only, self.weights, 0.0)
        numbers = allotted(weights.ravel(), count)
        found = []
        for pair in np.flatnonzero(numbers):
            k, s = divmod(int(pair), len(self.structures))
            runs, rng = self.runs[s], np.random.default_rng([seed, k, s])
            for x in drawn(runs, self.modes[k][s], int(numbers[pair]), rng):
                law = np.maximum(x[runs.law], [0.0 if j in runs.positive else -np.inf
                                               for j in range(len(runs.structure))])  # fmt: skip
                found.append(
                    Draws(
                        node=(k,),
                        structure=runs.shaped(x),
                        law=np.reshape(law * runs.sizes, (-1, 1)),
                        random=x[runs.knots.start :, None],
                    )
                )
        return found

    def told_by_another(self) -> Array:
        """Return what a motion like the first tells of the knots and what is unseen (p, p).

        It is the precision that the rows of the first give them, less what its start takes.
        """
        _, s = self.best
        runs, at = self.runs[s], slice(self.runs[s].starts.start, self.runs[s].starts.start + 3)
        slopes = self.linear[s].slopes[: len(self.motion.motions[0].time)]
        slopes = math.sqrt(self.kappa) / self.sigma * slopes
        common, start = slopes[:, runs.knots.start : runs.ratio.stop], slopes[:, at]
        own, _ = _inverse(start.T @ start + np.diag(runs.deviations[at] ** -2.0))
        cross = common.T @ start
        return np.asarray(common.T @ common - cross @ own @ cross.T)

    def another(self, motions: Sequence[Motion], draws: Sequence[Draws]) -> Array:
        """Return readings of other motions of the same mechanism in draws (k, n).

        Each begins as it fits them best, and its friction differs as that of another run does.
        """
        rng, motion = np.random.default_rng(11), replace(self.motion, motions=motions)
        values = np.concatenate([one.values for one in motions])
        base: Linear | None = None
        found = []
        for one in draws:
            factor = 1.0 + rng.choice(RUNS, p=RUN_PRIOR) * rng.normal()
            law = Candidate(structure=one.structure, coefficients=factor * one.law[:, 0])
            runs = Runs(motion, law)
            x, free = runs.first.copy(), np.zeros(runs.starts.stop, dtype=bool)
            known = runs.ratio.stop - runs.knots.start
            x[runs.knots.start : runs.ratio.stop] = one.random[:known, 0]
            x[runs.knots] *= factor
            free[runs.starts] = True
            if base is None:
                base = runs.solved(x, free=free)
                if base is None:
                    continue
                start, slopes = base.x[runs.starts], np.linalg.pinv(base.slopes[:, runs.starts])
            x[runs.starts] = start
            for _ in range(2):  # starts follow along the slopes of the first
                made = runs.run(x)
                if made is not None:
                    x[runs.starts] += slopes @ made[0]
            made = runs.run(x)
            if made is not None:
                found.append(values - made[0] + self.sigma * rng.normal(size=len(values)))
        if not found:
            raise InputError("no run of a law follows the second record: check what it is of.")
        return np.array(found)


def drawn(runs: Runs, mode: Mode, count: int, rng: np.random.Generator) -> Array:
    """Return draws of the unknowns (k, m), those that are physics first."""
    size = np.sqrt(np.diag(mode.covariance))
    values, vectors = np.linalg.eigh(mode.covariance / np.outer(size, size))
    root = size[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
    x = mode.x + rng.normal(size=(SPARE * count, len(mode.x))) @ root.T
    physics = np.all(x[:, runs.positive] > 0.0, axis=1)
    return np.asarray(x[np.argsort(~physics, kind="stable")[:count]])


def worth(linear: Linear, precision: Array, sigma: float) -> float:
    """Return what a reading is worth: squared scores of rows over those of blocks of rows."""
    slopes = linear.slopes / sigma
    gram = slopes.T @ slopes + precision
    size = np.sqrt(np.diag(gram))
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    scores = slopes / size @ (vectors / np.sqrt(np.maximum(values, ROUNDED * values[-1])))
    scores = scores * (linear.residual / sigma)[:, None]
    blocks = np.arange(len(scores)) * BLOCKS // len(scores)
    sums = np.zeros((BLOCKS, scores.shape[1]))
    np.add.at(sums, blocks, scores)
    return float(min(np.sum(scores**2) / (np.sum(sums**2) + 1e-300), 1.0))
