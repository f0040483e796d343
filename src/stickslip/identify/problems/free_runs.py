r"""Runs: what the readings of a free motion say of friction, as rows of the posterior.

A free motion has no force. Its readings :math:`y_i` follow from runs of the motion, in which
friction, what no balance sees of the mechanism (a length or stiffness), the start of each record
and the zero of its readings are unknown. Friction is a curve on a *fixed* one,

.. math::
    \tau(u) = \tau_0(u) \sum_k w_k N_k(\log (1 + u^2/u_1^2)) ,

Newton's polynomial through values at `KNOTS` speeds.

1. **A run that follows the readings** is found by the steps of Levenberg and Marquardt along the
   sensitivities of the engine, from some swings to all. Damping follows the ratio of the gain to
   that foreseen (Nielsen 1999); the steps end where one without damping would gain less than
   `SETTLED` of the logarithm of the posterior.
2. **Runs are nearly linear in the curve**: those that follow the readings differ by less than a
   hundredth of the friction where it works. With the slopes :math:`S` about that run, the column of
   a term :math:`g` of a law is :math:`S_w\, g / \tau_0` at the knots, and the problem is one of
   `stickslip.identify.posterior`: structures on a grid of shapes, no steps for any of them.
3. **What no law says**, :math:`\delta`, multiplies :math:`\tau_0`. It is normal with

   .. math::
       \langle \delta \delta' \rangle = (\rho^2 + \lambda^2 a(u) a(u'))\, M(\log u/u') , \qquad
       a(u) = 1 / (1 + (u/u_0)^4) ,

   :math:`M` that of Matern. Below :math:`u_0` friction does so little of its work that no swing
   tells it: what is small at speeds that were seen need not be small there.
4. **Readings are not independent** where something that nothing says is left: the Gram matrix is
   multiplied by the sum of the squared scores of rows over that of their sums over `BLOCKS` blocks.
5. The slopes are taken again about the most likely curve, until the run there leaves what the
   linear ones do.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from stickslip.engine.solver import BareRun, EventDriven
from stickslip.errors import InputError
from stickslip.friction import SetValuedLaw
from stickslip.identify.fits import FIRST_DAMPING
from stickslip.identify.own_laws import (
    Slips,
    certain_of,
    is_own,
    is_slope,
    signed_of,
    slope_column,
)
from stickslip.identify.posterior import (
    Array,
    Column,
    Draws,
    Model,
    Node,
    Posterior,
    Scale,
    Structure,
    System,
    family_of,
)
from stickslip.identify.problems.record_model import BEHIND, KEPT_LAWS, NODES, SCALES
from stickslip.identify.simulated import ROUNDS, SETTLED
from stickslip.identify.vocabulary import PARTS, SIGNED, Grid
from stickslip.maths import Scalar, log, where
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Parametrised, Quantity, parameters, vary

SOLVER = EventDriven(tier="compiled", tolerance=1e-9, stiff_tolerance=1e-6, max_steps=100_000)
"""Six digits below the noise of any record."""
KNOTS = 20
"""Speeds at which the curve is free: laws through it work alike to 1e-3, narrow ones too."""
CORRELATION = 1.0
"""E-folds of speed over which what no law says is correlated (Matern 3/2)."""
SIZES, SIZE_PRIOR = (0.0, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8), (0.4, *(0.6 / 7.0,) * 7)
"""Sizes of it, as a share of the fixed curve, and their prior. It grows as far as it has to:
stopped at .2, bands outside the vocabulary held .66."""
SLOW_SIZES, SLOW_PRIOR = (0.0, 0.3, 1.0), (0.4, 0.3, 0.3)
"""Further sizes of it at speeds that are too slow to be seen, and their prior: static friction is
up to twice the kinetic (without them bands outside the vocabulary held .69)."""
FOLLOWING = (6, 1)
"""Sizes with which a run that follows is looked for, and from which nodes are visited."""
RATIO = 0.01
"""Prior standard deviation of a length or stiffness, as a share, if none is stated."""
START, ZERO, DRIFT = 0.3, 0.03, 0.01
"""Prior standard deviations of how a motion starts, of its zero and of what that drifts, over its
range."""
OF_MOTION = 4
"""Unknowns of each motion."""
STAGES = (6, 20)
"""Turns of the first runs: a swing is predictable for some, as its phase is."""
MOST_DAMPING = 1e6 / FIRST_DAMPING
"""Damping over the curvature at which steps end."""
CLOSEST = 1e-5
"""Least deviation of readings over the range: laws work alike through the knots to no less."""
STRAIGHT, AGAIN = 0.1, 4
"""Error of the logarithm of the likelihood up to which runs are linear, and how often slopes are
taken at most."""
NOT_FREE = (
    "no run of a law follows this free motion: check mass, length and stiffness of the mechanism,"
    " and that nothing drives the motion."
)
BLOCKS = 100
"""Blocks of rows, over all records, whose scores count as independent."""
ROUNDED = 1e-13
"""Least eigenvalue of a precision of unit diagonal, over the largest: what is below is rounding."""
RUNS, RUN_PRIOR = SCALES["run"]
"""By how much friction of another run may differ, as a share, and the prior: as of driven axes."""
FINER = (1.0 / 3.0, 1.0 / 9.0, 1.0 / 27.0)
"""Parts of a step of the grid by which shapes are refined."""


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
        return self.coefficient * PARTS[self.part].curve(speed, [item.value for item in self.shape])


def leja(count: int) -> Array:
    """Return Chebyshev's points (n,) of -2 to 2 in the order in which Newton's form is stable.

    Each is as far from those before as may be: the product of the distances is the largest.

    Examples
    --------
    >>> np.abs(leja(3)).round(3).tolist()  # about 0, from the least
    [1.732, 1.732, 0.0]
    """
    left = [*(2.0 * np.cos(math.pi * (np.arange(count)[::-1] + 0.5) / count))]
    result = [left.pop(0)]
    while left:
        far = [math.prod(abs(x - item) for item in result) for x in left]
        result.append(left.pop(int(np.argmax(far))))
    return np.array(result)


POINTS = leja(KNOTS)


def place_of(speed: Scalar, slowest: Scalar, fastest: Scalar) -> Scalar:
    """Return where a speed is from -2, at rest, to 2, the fastest."""
    ratio, most = speed / slowest, fastest / slowest
    return 4.0 * log(1.0 + ratio * ratio) / log(1.0 + most * most) - 2.0


def newton(x: Array, points: Array) -> Array:
    """Return Newton's polynomials of some points at places (n, k)."""
    result = np.ones((len(x), len(points)))
    for k, at in enumerate(points[:-1]):
        result[:, k + 1] = result[:, k] * (x - at)
    return result


def nested(waves: Sequence[Number], x: Scalar, points: Array) -> Scalar:
    """Return the polynomial with coefficients `waves` of these at places."""
    result = waves[-1].value + 0.0 * x
    for wave, at in zip(waves[-2::-1], points[-2::-1], strict=True):
        result = wave.value + (x - at) * result
    return result


def alike(knots: Array) -> Array:
    """Return the correlation of what no law says at logarithms of speeds (k, k)."""
    apart = np.abs(knots[:, None] - knots) * math.sqrt(3.0) / CORRELATION
    return np.asarray((1.0 + apart) * np.exp(-apart) + 1e-9 * np.eye(len(knots)))


def knots_of(points: Array, slowest: float, fastest: float) -> Array:
    """Return the logarithms of the speeds (k,) of points from -2 to 2."""
    most = 1.0 + (fastest / slowest) ** 2
    return np.asarray(np.log(slowest * np.sqrt(most ** (0.25 * points + 0.5) - 1.0)))


@dataclass(frozen=True, kw_only=True)
class RunLaw(SetValuedLaw):
    """A law and what no law says, as a run takes it: friction as a force, whatever the load."""

    name: ClassVar[str] = "refined"
    title: ClassVar[str] = "Law with a discrepancy"
    formula: ClassVar[str] = r"F = \tau(|v|)"
    sources: ClassVar[tuple[str, ...]] = ()

    terms: tuple[Term, ...]
    """The law."""
    fixed: tuple[Term, ...]
    """The curve that what no law says multiplies."""
    waves: tuple[Number, ...]
    """The curve over the fixed one: coefficients of Newton's polynomial of the logarithm of the
    speed, whose nested form is short in symbols."""
    slowest: Annotated[float, Quantity("v", above=0)]
    fastest: Annotated[float, Quantity("v", above=0)]

    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        friction = sum(term.at(speed) for term in self.terms)
        if not self.waves:
            return friction
        share = nested(self.waves, place_of(speed, self.slowest, self.fastest), POINTS)
        return friction + share * sum(item.at(speed) for item in self.fixed)

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

    @property
    def late(self) -> Array:
        """Part of the record that has passed (n,), less a half; 0 where no zero can drift.

        Beside a motion that goes on, a zero that drifts is a velocity.
        """
        drifts = self.located and len(self.turns) > 0
        return np.asarray((self.time / self.time[-1] - 0.5) * drifts)

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
    """A structure with its coefficients."""

    structure: Structure
    coefficients: Array


@dataclass(frozen=True, kw_only=True, eq=False)
class Linear:
    """Runs linearised about some values of the unknowns."""

    x: Array
    residual: Array
    slopes: Array


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
    dim: float = 0.0
    """Speed below which friction does too little work to be seen [m/s]."""
    side: float = 1.0
    """Sign of the velocity; 1 where it has both."""
    load: float = 1.0
    """Normal force at which laws of any form are [N]."""

    @property
    def paths(self) -> list[str]:
        """Paths of what no balance sees of the mechanism."""
        return [item.path for item in self.unseen]

    def values(self, logs: Array, motion: Motion | None = None) -> Array:
        """Return it for logarithms of it over its given values (..., p), as it is in a motion."""
        given = [item.value for item in self.unseen]
        if motion is not None:
            known = {path: x for path, _, x in parameters(motion.mechanism, "mechanism")}
            given = [known[path] for path in self.paths]
        return np.asarray(np.array(given) * np.exp(logs))

    @cached_property
    def knots(self) -> Array:
        """Logarithms of the speeds at which the curve is free."""
        return knots_of(POINTS, self.slowest, self.fastest)

    @cached_property
    def waves(self) -> Array:
        """Coefficients of Newton's polynomials for values at the knots (k, k)."""
        return np.asarray(np.linalg.inv(newton(POINTS, POINTS)))

    def root(self, size: float, slow: float) -> Array:
        """Return a root of the covariance of what no law says at the knots (k, k), by its sizes."""
        dim = slow / (1.0 + (np.exp(self.knots) / max(self.dim, 1e-300)) ** 4)
        share = max(size, 1e-6) ** 2 + np.outer(dim, dim)
        return np.asarray(np.linalg.cholesky(share * alike(self.knots)))

    def share(self, column: Column) -> Array:
        """Return a term of a law at the knots, over the fixed curve (k,)."""
        speed = np.exp(self.knots)
        return np.asarray(self.term(column, speed) / sum(item.at(speed) for item in self.fixed))

    def term(self, column: Column, speed: Array) -> Array:
        """Return a term of a law at speeds (n,)."""
        if is_slope(column[0]):
            rows = Slips(velocity=self.side * speed, load=0.0 * speed + self.load, inputs={})
            return self.side * slope_column(column, rows)
        return np.asarray(PARTS[column[0]].curve(speed, column[1]) + 0.0 * speed)

    def curve(self, candidate: Candidate) -> Array:
        """Return a law at the knots, over the fixed curve (k,)."""
        pairs = zip(candidate.structure, candidate.coefficients, strict=True)
        return np.asarray(sum((c * self.share(item) for item, c in pairs), np.zeros(KNOTS)))

    def beside(self, speed: Array) -> Array:
        """Return friction at speeds for values of 1 at each knot alone (n, k)."""
        fixed = sum(item.at(speed) for item in self.fixed)
        places = place_of(speed, self.slowest, self.fastest)
        table = newton(np.asarray(places), POINTS) @ self.waves
        return np.asarray(table * np.reshape(fixed, (-1, 1)))


class Runs:
    """Runs of the motions with a law, and a curve beside it unless the law is `alone`.

    The unknowns are, in this order: the curve at the knots over the fixed one, the logarithm of
    what is unseen over its given value, and of each motion its position and velocity at the start,
    its zero and the drift of that.
    """

    def __init__(
        self, motion: FreeMotion, law: Candidate | None = None, *, alone: bool = False
    ) -> None:
        self.waved = slice(0, 0 if alone else KNOTS)
        self.motion, self.law = motion, law or Candidate(structure=(), coefficients=np.zeros(0))
        self.knots, self.ratio = slice(0, KNOTS), slice(KNOTS, KNOTS + len(motion.unseen))
        self.starts = slice(self.ratio.stop, self.ratio.stop + OF_MOTION * len(motion.motions))
        self.mean, self.deviations = self._prior()

    def _prior(self) -> tuple[Array, Array]:
        """Return means and standard deviations of the unknowns; those of the knots are 0 and 1."""
        motion = self.motion
        mean, deviations = np.zeros(self.starts.stop), np.ones(self.starts.stop)
        deviations[self.ratio] = [item.deviation for item in motion.unseen]
        for k, entry in enumerate(motion.motions):
            at = self.starts.start + OF_MOTION * k
            rate = (
                START * entry.range / max(float(entry.time[-1]), 1e-300) * (len(entry.turns) + 1.0)
            )
            speed, place = max(abs(entry.start[1]), rate), max(abs(entry.start[0]), entry.range)
            mean[at : at + 2] = entry.start
            deviations[at : at + 4] = (
                START * place,
                START * speed,
                ZERO * entry.range,
                (DRIFT * entry.range),
            )
            if not entry.located:
                deviations[at : at + 2] = START * place, START * entry.range
        return mean, deviations

    @cached_property
    def precision(self) -> Array:
        """Precision (m, m) with which a run that follows is looked for."""
        result = np.diag(self.deviations**-2.0)
        k, slow = FOLLOWING
        root = np.linalg.inv(self.motion.root(SIZES[k], SLOW_SIZES[slow]))
        result[self.knots, self.knots] = root.T @ root
        return result

    def _law(self, x: Array) -> RunLaw:
        return RunLaw(
            terms=tuple(
                Term(part=n, coefficient=float(c), shape=tuple(Number(value=v) for v in shape))
                for (n, shape), c in zip(self.law.structure, self.law.coefficients, strict=True)
            ),
            fixed=self.motion.fixed,
            waves=tuple(
                Number(value=float(w)) for w in self.motion.waves[self.waved] @ x[self.knots]
            ),
            slowest=self.motion.slowest,
            fastest=self.motion.fastest,
        )

    def run(self, x: Array, turns: int | None = None) -> "tuple[Array, list[BareRun]] | None":
        """Return what runs leave of the readings, with the runs; None where a run fails."""
        motion, left, runs = self.motion, list[Array](), list[BareRun]()
        if not np.all(np.isfinite(x)):
            return None
        law = self._law(x)
        try:
            for item, (q, v, zero, drift) in zip(
                motion.motions, x[self.starts].reshape(-1, OF_MOTION), strict=True
            ):
                mechanism = item.mechanism
                if motion.unseen:
                    values = motion.values(x[self.ratio], item).tolist()
                    own = dict(zip(motion.paths, values, strict=True))
                    mechanism = vary(mechanism, "mechanism", own)
                rows = item.first(turns)
                run = SOLVER.bare(mechanism, law, y0=[q, v], t_end=float(item.time[rows - 1]))
                if not run.status.complete:
                    return None
                there = run.at(item.time[:rows])[:, 1 - item.located]
                left.append(item.values[:rows] - there - zero - drift * item.late[:rows])
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
            *(f"friction.waves.{k}.value" for k in range(KNOTS)[self.waved]),
            *self.motion.paths,
            *(f"initial.{name}" for name in names),
        ]

    def _slopes(self, x: Array, runs: "Sequence[BareRun]", turns: int | None) -> Array:
        """Return the slopes of the runs by the unknowns (n, m)."""
        motion, result = self.motion, list[Array]()
        for k, (item, run) in enumerate(zip(motion.motions, runs, strict=True)):
            rows = item.first(turns)
            table = run.differentiate(item.time[:rows], self._paths)[:, 1 - item.located, :]
            # what a run has no slope by stays where it is
            table = np.where(np.isfinite(table).all(axis=0), table, 0.0)
            own = np.zeros((rows, len(x)))
            count = self.waved.stop
            own[:, self.knots] = table[:, :count] @ motion.waves[self.waved]
            unseen = slice(count, count + len(motion.unseen))
            own[:, self.ratio] = table[:, unseen] * motion.values(x[self.ratio], item)
            at = self.starts.start + OF_MOTION * k
            own[:, at : at + 2] = table[:, unseen.stop :]
            own[:, at + 2] = 1.0 * item.located
            own[:, at + 3] = item.late[:rows]
            result.append(own)
        return np.vstack(result)

    def linear(self, x: Array, turns: int | None = None) -> Linear | None:
        """Return runs linearised about some unknowns; None where none can be made."""
        made = self.run(x, turns)
        if made is None:
            return None
        return Linear(x=x, residual=made[0], slopes=self._slopes(x, made[1], turns))

    def solved(
        self, x: Array, *, turns: int | None = None, free: "NDArray[np.bool_] | None" = None
    ) -> Linear | None:
        """Return runs linearised about the mode near some unknowns; None where none can be made.

        With `free`, only those are looked for.
        """
        linear = self.linear(x, turns)
        if linear is None:
            return None
        at = np.flatnonzero(np.ones(len(x), dtype=bool) if free is None else free)
        precision, weight = self.precision[np.ix_(at, at)], self.noise**-2.0
        mean, damping, rise = self.mean[at], 0.0, 2.0
        for _ in range(ROUNDS):
            slopes = linear.slopes[:, at]
            gram = weight * slopes.T @ slopes + precision
            off = linear.x[at] - mean
            pull = weight * slopes.T @ linear.residual - precision @ off
            if 0.5 * pull @ inverse(gram) @ pull < SETTLED:
                break
            least = weight * linear.residual @ linear.residual + off @ precision @ off
            while damping < MOST_DAMPING:
                step = inverse(gram + damping * np.diag(np.diag(gram))) @ pull
                x = linear.x.copy()
                x[at] += step
                made, ratio = self.run(x, turns), -1.0
                if made is not None:
                    cost = weight * made[0] @ made[0] + (off + step) @ precision @ (off + step)
                    ratio = (least - cost) / (step @ (2.0 * pull - gram @ step))
                if ratio > 0.0:
                    damping *= max(1.0 / 3.0, 1.0 - (2.0 * ratio - 1.0) ** 3)
                    damping, rise = damping * (damping > 1e-9), 2.0
                    break
                damping, rise = max(damping * rise, FIRST_DAMPING), 2.0 * rise
            if made is None or damping >= MOST_DAMPING:
                break
            linear = Linear(x=x, residual=made[0], slopes=self._slopes(x, made[1], turns))
        return linear

    def beside(self, x: Array) -> Linear | None:
        """Return runs of this very law: starts and what is unseen of the mechanism are free."""
        free = np.ones(self.starts.stop, dtype=bool)
        free[self.knots] = False
        return self.solved(x, free=free)

    def follows(self, curve: Array) -> Linear | None:
        """Return runs that follow the readings with a curve near another (k,)."""
        self.mean[self.knots], x = curve, self.mean.copy()
        x[self.knots] = curve
        for turns in (*(n for n in STAGES if self._has(n)), None):
            linear = self.solved(x, turns=turns)
            x = x if linear is None else linear.x
        self.mean[self.knots] = 0.0
        return linear

    def _has(self, turns: int) -> bool:
        return any(len(motion.turns) > turns for motion in self.motion.motions)

    @property
    def noise(self) -> float:
        """Standard deviation of the noise of readings, by third differences."""
        return math.sqrt(float(np.mean([motion.noise**2 for motion in self.motion.motions])))

    def scatter(self, linear: Linear) -> float:
        """Return the standard deviation of what runs leave of the readings."""
        gram = self.noise**-2.0 * linear.slopes.T @ linear.slopes
        told = float(np.trace(inverse(gram + self.precision) @ gram))
        freedom = max(len(linear.residual) - told, 1.0)
        least = max(0.1 * self.noise, CLOSEST * max(motion.range for motion in self.motion.motions))
        return max(math.sqrt(float(linear.residual @ linear.residual) / freedom), least)


def inverse(matrix: Array) -> Array:
    """Return the inverse of a positive matrix whose entries differ in size."""
    size = np.sqrt(np.diag(matrix))
    values, vectors = np.linalg.eigh(matrix / np.outer(size, size))
    own = vectors / np.sqrt(np.maximum(values, ROUNDED * values[-1])) / size[:, None]
    return np.asarray(own @ own.T)


class RunModel(Model):
    """Readings of free motions, linear about a run that follows them."""

    scales = (
        Scale(name="curve", values=SIZES, prior=SIZE_PRIOR),
        Scale(name="slow", values=SLOW_SIZES, prior=SLOW_PRIOR),
    )

    def __init__(
        self,
        runs: Runs,
        linear: Linear,
        closest: "RunModel | None" = None,
        own: Sequence[Structure] = (),
    ) -> None:
        self.own: Sequence[Structure] = own or (closest.own if closest else ())
        """Laws that are no sums of parts."""
        self.signed, self.certain = SIGNED | signed_of(self.own), certain_of(self.own)
        self.runs, self.motion, self.linear = runs, runs.motion, linear
        sigma = runs.scatter(linear)
        self.sigma: float = closest.sigma if closest else sigma
        """Standard deviation of the readings about the closest run."""
        of_row = worth(linear.slopes / sigma, linear.residual, runs.precision)
        self.kappa: float = closest.kappa if closest else of_row
        """What a reading is worth, over one whose error is its own."""
        self.x = linear.x.copy()
        """The unknowns of that run, its law in the curve."""
        self.x[:KNOTS] += self.motion.curve(runs.law)
        y = linear.residual + linear.slopes @ (self.x - runs.mean)
        table = np.column_stack([linear.slopes, y])
        self.gram = self.kappa / self.sigma**2 * table.T @ table

    def size(self, column: Column) -> float:
        """Return the coefficient with which a term alone would be friction of the usual size."""
        speed = np.geomspace(self.motion.slowest, self.motion.fastest, 40)
        curve = self.motion.term(column, speed)
        return self.motion.size / (math.sqrt(float(np.mean(curve**2))) + 1e-300)

    def root(self, node: Node) -> Array:
        """Return a root of the covariance of what no law says at the knots (k, k)."""
        return self.motion.root(SIZES[node[0]], SLOW_SIZES[node[1]])

    def system(self, node: Node, columns: Sequence[Column]) -> System:
        sizes = np.array([*map(self.size, columns)])
        shares = [*map(self.motion.share, columns)]
        return through_knots(self.gram, self.root(node), shares, sizes, self.runs.deviations)

    def unknowns(self, node: Node, structure: Structure, law: Array, random: Array) -> Array:
        """Return the unknowns of runs (m,) with a law (d,) and random coefficients (m,)."""
        x = self.runs.mean + random
        x[:KNOTS] = self.root(node) @ random[:KNOTS]
        x[:KNOTS] += self.motion.curve(Candidate(structure=structure, coefficients=law))
        return x

    def beside(self, draws: Sequence[Draws]) -> Array:
        """Return what no law says at the knots, and the unknowns behind it, of draws (m, k)."""
        result = []
        for draw in draws:
            x = draw.random.copy()
            x[:KNOTS] = self.root(draw.node) @ draw.random[:KNOTS]
            result.append(x)
        return np.hstack(result)

    @property
    def told(self) -> Array:
        """Precision of the curve at the knots by the readings, whatever else is unknown (k, k)."""
        return self._told(self.gram[:-1, :-1], KNOTS)

    def _told(self, gram: Array, count: int) -> Array:
        """Return the precision of the first unknowns by a Gram matrix, whatever the others are."""
        rest = gram[count:, count:] + np.diag(self.runs.deviations[count : len(gram)] ** -2.0)
        cross = gram[:count, count:]
        return np.asarray(gram[:count, :count] - cross @ inverse(rest) @ cross.T)

    def told_by_another(self, share: float) -> Array:
        """Return what a motion like the first tells of the knots and what is unseen (p, p).

        It begins at a share of the start. It is the precision that rows as those of the first would
        give them, less what its start takes.
        """
        first, start = self.motion.motions[0], self.runs.starts.start
        slopes: Array | None = self.linear.slopes[: len(first.time)]
        if share < 1.0:
            runs = Runs(replace(self.motion, motions=[first]))
            middle = float(np.median(first.values))
            x = self.x[: runs.starts.stop].copy()
            x[start] = middle + share * (x[start] - middle) if first.located else x[start]
            x[start + 1] *= share
            made = runs.linear(x)
            slopes = None if made is None else made.slopes
        if slopes is None:
            return np.zeros((start, start))
        gram = self.kappa / self.sigma**2 * slopes[:, : start + OF_MOTION].T
        return self._told(gram @ slopes[:, : start + OF_MOTION], start)

    def another(self, motions: Sequence[Motion], draws: Sequence[Draws]) -> Array:
        """Return readings of other motions of the same mechanism in draws (k, n).

        Each begins as it fits them best, and its friction differs as that of another run does.
        """
        rng, runs = np.random.default_rng(11), Runs(replace(self.motion, motions=motions))
        values = np.concatenate([motion.values for motion in motions])
        base: Linear | None = None
        result, free = [], np.zeros(runs.starts.stop, dtype=bool)
        free[runs.starts] = True
        for draw in draws:
            for law, random in zip(draw.law.T, draw.random.T, strict=True):
                factor = 1.0 + rng.choice(RUNS, p=RUN_PRIOR) * rng.normal()
                x = runs.mean.copy()
                known = self.unknowns(draw.node, draw.structure, law, random)
                x[: runs.starts.start] = known[: runs.starts.start]
                x[:KNOTS] *= factor
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
                    result.append(values - made[0] + self.sigma * rng.normal(size=len(values)))
        if not result:
            raise InputError("no run of a law follows the second record: check what it is of.")
        return np.array(result)


def through_knots(
    gram: Array, root: Array, shares: Sequence[Array], sizes: Array, deviations: Array
) -> System:
    """Return rows whose first unknowns are a curve at knots, in terms of laws that go through them.

    Of the Gram matrix (m + 1, m + 1) the last column is the response. What no law says has a root
    (k, k) of its covariance; `shares` (k,) are terms of laws at the knots, of which `sizes` (p,)
    are the coefficients of the usual size.
    """
    k, m, p = len(root), len(gram) - 1, len(shares)
    turn = np.zeros((m + 1, m + p + 1))
    turn[:k, :k] = root
    turn[range(k, m), range(k, m)] = 1.0
    if shares:
        turn[:k, m : m + p] = np.column_stack(shares) * sizes
    turn[m, m + p] = 1.0
    return System(gram=turn.T @ gram @ turn, deviations=deviations, volume=0.0, sizes=sizes)


def begun(motion: FreeMotion, law: Candidate, *, alone: bool = False) -> tuple[Runs, Array]:
    """Return runs with a law, perhaps `alone`, and their unknowns at their means (m,).

    A law that is no sum of parts is a curve through the knots.
    """
    curve = is_own(law.structure)
    runs = Runs(motion) if curve else Runs(motion, law, alone=alone)
    x = runs.mean.copy()
    if curve:
        x[:KNOTS] = motion.curve(law)
    return runs, x


def followed(motion: FreeMotion) -> RunModel:
    """Return the readings linear about a run that follows them, from the fixed curve."""
    runs = Runs(motion)
    linear = runs.follows(np.ones(KNOTS))
    moved = [x.values - np.mean(x.values) * x.located for x in motion.motions]
    # a run that lost the phase leaves more of the motion than it follows
    if linear is None or 2.0 * np.sum(linear.residual**2) > np.sum(np.concatenate(moved) ** 2):
        raise InputError(NOT_FREE)
    return RunModel(runs, linear)


def judged(model: RunModel, grid: Grid, families: Sequence[tuple[str, ...]]) -> Posterior:
    """Return the weights of families and shapes, by runs about the most likely curve."""
    laws = {
        tuple(zip(family, map(tuple, shapes), strict=True)): prior
        for family, shapes, prior in grid.families(families)
    }
    laws |= dict.fromkeys(model.own, 0.0)
    posterior = refined_shapes(model, laws, grid, [FOLLOWING])
    laws = dict(zip(posterior.structures, posterior.priors.tolist(), strict=True))
    for _ in range(AGAIN):
        k, s = np.unravel_index(int(np.argmax(posterior.weights)), posterior.weights.shape)
        node, structure = posterior.nodes[k], posterior.structures[s]
        law, random = posterior.estimate(node, structure)
        runs, x = begun(model.motion, Candidate(structure=structure, coefficients=law))
        x += random
        x[:KNOTS] += model.root(node) @ random[:KNOTS] - random[:KNOTS]
        there = runs.linear(x)
        if there is None:
            break
        follower = RunModel(runs, there, model)
        foreseen = model.linear.residual - model.linear.slopes @ (follower.x - model.x)
        off = abs(foreseen @ foreseen - there.residual @ there.residual)
        if 0.5 * model.kappa / model.sigma**2 * off < STRAIGHT:
            break
        model = follower
        posterior = _weighed(model, laws, [FOLLOWING])
    return posterior


def refined_shapes(
    model: Model, laws: "dict[Structure, float]", grid: Grid, begin: Sequence[Node]
) -> Posterior:
    """Return the weights of laws with the logarithms of their priors, and of shapes near them."""
    posterior = _weighed(model, laws, begin)
    for part in FINER:
        laws = _refined(posterior, laws, grid, part)
        posterior = _weighed(model, laws, begin)
    return posterior


def _weighed(model: Model, laws: "dict[Structure, float]", begin: Sequence[Node]) -> Posterior:
    most = min(math.prod(len(scale.values) for scale in model.scales), NODES)
    return Posterior(model, [*laws], np.array([*laws.values()]), begin=begin, most=most)


def _refined(
    posterior: Posterior, laws: "dict[Structure, float]", grid: Grid, part: float
) -> "dict[Structure, float]":
    """Return structures with shapes a part of a step aside, with the logarithms of their priors."""
    value = np.log(posterior.shares + 1e-300)
    order = np.argsort(-value, kind="stable").tolist()
    best: dict[tuple[str, ...], int] = {}
    for k in order:
        best.setdefault(family_of(posterior.structures[k]), k)
    near = [k for k in order[:KEPT_LAWS] if value[k] > value[order[0]] - BEHIND]
    result: dict[Structure, float] = {}
    for k in dict.fromkeys([*near, *best.values()]):
        law = posterior.structures[k]
        many = [*grid.finer(family_of(law), [shape for _, shape in law], part)]
        for shapes in many:
            one = tuple(zip(family_of(law), map(tuple, shapes), strict=True))
            result.setdefault(one, laws[law] - math.log(len(many)))
    return result


def worth(slopes: Array, residual: Array, precision: Array) -> float:
    """Return what a reading is worth: squared scores of rows over those of blocks of rows.

    Slopes (n, m) are over the deviation of a reading.
    """
    gram = slopes.T @ slopes + precision
    size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    least = max(ROUNDED * values[-1], 1e-300)
    scores = slopes / size @ (vectors / np.sqrt(np.maximum(values, least)))
    scores = scores * residual[:, None]
    blocks = np.arange(len(scores)) * BLOCKS // len(scores)
    sums = np.zeros((BLOCKS, scores.shape[1]))
    np.add.at(sums, blocks, scores)
    return float(min(np.sum(scores**2) / (np.sum(sums**2) + 1e-300), 1.0))
