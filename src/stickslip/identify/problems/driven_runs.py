r"""Driven runs: what runs under a recorded voltage say of one law, and of friction beside it.

A force balance is blind where constants of a motor are looked for that a voltage drives: what it
lacks, such as the error of a velocity, all goes to friction. Runs are not. With the parameters
:math:`\theta` of a law and of the mechanism where segments of runs follow the readings best
(`stickslip.identify.fits`), readings :math:`y` leave :math:`r`, and nearby

.. math::
    r = S\, (\theta - \hat\theta) + D\, w + e , \qquad
    \delta(u, T) = F \sum_k (w_k + w_{K+k}\, |T| / T_0)\, N_k(\log (1 + u^2/u_1^2)) .

1. **What no law says**, :math:`\delta`, is friction of speed :math:`u` and of what a gear
   transmits, :math:`T`: Newton's polynomials through values at `KNOTS` speeds, over the size
   :math:`F` of friction. Values are normal with a deviation of `SIZES` and Matern's correlation of
   the logarithm of the speed. Their slopes :math:`D` are those of the same segments.
2. Where :math:`\delta` is likelier than none, runs with it are linear about those that follow the
   readings best, by steps of Levenberg and Marquardt with the prior of the likeliest size.
3. :math:`\theta` is taken out of both, so that what a law of other values says is no
   :math:`\delta`. The probability of each size follows from the rest, whose rows count by the sum
   of their squared scores over that of blocks of rows (`problems.free_runs.worth`).
4. **Draws** take a size and :math:`w`; :math:`\theta` follows these, and varies about that as much
   as leaving out blocks of rows says (`RecordFit.inference`).
5. **No friction** is judged by what runs without any leave, and the criterion of Schwarz.
"""

import functools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.special import expit, logsumexp, ndtr, stdtrit

from stickslip.friction import FrictionLaw, SetValuedLaw, bound
from stickslip.identify.bands import MeasuredPoints
from stickslip.identify.fits import (
    CHANCE,
    FreeParameter,
    FreeParameters,
    RecordFit,
    ResidualJacobian,
    Shooting,
    improve,
)
from stickslip.identify.forces import TRANSMITTED
from stickslip.identify.judgement import DRAWS, Candidates, Problem
from stickslip.identify.laws import Composition, compose, own_composition
from stickslip.identify.own_laws import OwnLaw, Slips, Slope, is_slope
from stickslip.identify.posterior import (
    SPARE,
    Array,
    Draws,
    Family,
    Node,
    Structure,
    allotted,
    family_of,
)
from stickslip.identify.problems.free_runs import (
    RUN_PRIOR,
    RUNS,
    SIZE_PRIOR,
    SIZES,
    Number,
    alike,
    knots_of,
    leja,
    nested,
    newton,
    place_of,
    worth,
)
from stickslip.identify.problems.record_curves import OtherRows, SteadyRows, beyond
from stickslip.identify.problems.record_model import KAPPA
from stickslip.identify.problems.record_signals import Record
from stickslip.identify.problems.records import RecordProblem
from stickslip.identify.projection import Rung, Shaped
from stickslip.identify.simulated import SETTLED
from stickslip.maths import Scalar
from stickslip.quantities import Quantity
from stickslip.show.formatting import quantity

KNOTS = 8
"""Speeds at which friction beside a law is free: about one for each e-fold that a servo has."""
PLACES = leja(KNOTS)
LEVELS = 200
"""Draws by which a law is compared with the middle of friction."""
UNSEEN = (
    "Runs do not tell whether friction changes with the place, in time or between records: the"
    " intervals hold for friction as it was on average."
)
"""What is not looked for."""
AGAIN = 3
"""Times that the deviation of readings, and that runs, are taken again."""
STEPS = 8
"""Steps of the search for friction beside a law, each time."""


@dataclass(frozen=True, kw_only=True)
class BesideLaw(SetValuedLaw):
    """A law with friction beside it, of the speed and of what a gear transmits."""

    name: ClassVar[str] = "beside"
    title: ClassVar[str] = "Law with what no law says"
    formula: ClassVar[str] = r"F = F_0(|v|) + \delta(|v|, T)"
    sources: ClassVar[tuple[str, ...]] = ()

    law: FrictionLaw
    level: tuple[Number, ...]
    """Coefficients of Newton's polynomials [N]."""
    gear: tuple[Number, ...]
    """The same of what multiplies that which a gear transmits."""
    slowest: Annotated[float, Quantity("v", above=0)]
    fastest: Annotated[float, Quantity("v", above=0)]

    def _beside(self, speed: Scalar) -> Scalar:
        x = place_of(speed, self.slowest, self.fastest)
        result = nested(self.level, x, PLACES)
        if self.gear:
            result = result + abs(self.contact(TRANSMITTED)) * nested(self.gear, x, PLACES)
        return result

    @property
    def _bound(self) -> Any:
        return bound(self.law, {name: self.contact(name) for name in self.law.inputs})

    def sliding(self, speed: Scalar, load: Scalar) -> Scalar:
        return self._bound.sliding(speed, load) + self._beside(speed)

    def break_away(self, load: Scalar) -> Scalar:
        return self._bound.break_away(load) + self._beside(0.0)


@functools.cache
def _kind(inputs: tuple[str, ...]) -> type[BesideLaw]:
    """Return laws with friction beside them that see inputs of the contact."""
    return type("BesideLaw", (BesideLaw,), {"inputs": inputs})


def _inner(path: str) -> str:
    """Return the path of a parameter of a law that has friction beside it."""
    return path.replace("friction.", "friction.law.", 1)


@dataclass(frozen=True, kw_only=True, eq=False)
class _WithPrior:
    """Residuals of runs, and rows of what is known before of unknowns that are about 0."""

    runs: Shooting
    rows: Array
    """Unknowns over their deviations, in deviations of a reading (m, p)."""

    @property
    def free_parameters(self) -> FreeParameters:
        """What is looked for."""
        return self.runs.free_parameters

    def linearise(self, values: Array, near: ResidualJacobian | None = None) -> ResidualJacobian:
        """Return residuals at values (p,), with the rows."""
        return self.of(self.runs.linearise(values, near))

    def of(self, seen: ResidualJacobian) -> ResidualJacobian:
        """Return residuals of runs with the rows."""
        return ResidualJacobian(
            values=seen.values,
            residual=np.concatenate([seen.residual, -self.rows @ seen.values]),
            slopes=lambda: np.vstack([seen.slopes, self.rows]),
            segment=np.concatenate([seen.segment, np.full(len(self.rows), -1)]),
            memory=seen.memory,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Told:
    """What readings say of values at the knots, whatever the parameters of a law are."""

    gram: Array
    """Precision (m, m)."""
    moment: Array
    """That times the values (m,)."""
    values: Array
    """Parameters (p,) where values are in the middle ..."""
    middle: Array
    """... that runs are linear about (m,)."""
    goes: Array
    """How far parameters go against the values (p, m)."""
    deviation: float
    """Deviation of a reading that would be independent of others."""

    def at(self, root: Array) -> tuple[Array, Array, float]:
        """Return mean and root of the covariance of values, and the evidence, by a prior root."""
        inner = np.eye(len(self.gram)) + root.T @ self.gram @ root
        turned = root.T @ self.moment
        solved = np.linalg.solve(inner, turned)
        evidence = 0.5 * float(turned @ solved - np.linalg.slogdet(inner)[1])
        return root @ solved, root @ np.linalg.inv(np.linalg.cholesky(inner)).T, evidence


@dataclass(frozen=True, kw_only=True, eq=False)
class DrivenRuns:
    """A fit of a law by runs, and what runs say of friction beside it.

    Parameters
    ----------
    fit : RecordFit
        The law and the mechanism where segments of runs follow the readings best.
    slowest, fastest : float
        Range of the speeds that were seen [m/s].
    size : float
        Root mean square of the friction [N].
    transmitted : float
        What the gear transmits in the middle [N]; 0 where that hardly changes.
    """

    fit: RecordFit
    slowest: float
    fastest: float
    size: float
    transmitted: float = 0.0

    @cached_property
    def law(self) -> OwnLaw:
        """The law with what is looked for of it."""
        free = self.fit.free_parameters.paths
        names = [path.removeprefix("friction.") for path in free if path.startswith("friction.")]
        unknown = {x.path.removeprefix("friction.") for x in self.fit.estimates if not x.known}
        return OwnLaw(
            law=self.fit.law,
            varied=tuple(name for name in names if name not in unknown),
            untold=tuple(name for name in names if name in unknown),
        )

    @property
    def paths(self) -> list[str]:
        """Paths of what is looked for of the mechanism."""
        every = self.fit.free_parameters.paths
        return [path for path in every if not path.startswith("friction.")]

    @cached_property
    def waves(self) -> Array:
        """Coefficients of Newton's polynomials for values at the knots (k, k) [N]."""
        return np.asarray(self.size * np.linalg.inv(newton(PLACES, PLACES)))

    @cached_property
    def root(self) -> Array:
        """Root of the covariance of values at the knots, of a size of 1 (2k, 2k) or (k, k)."""
        root = np.linalg.cholesky(alike(knots_of(PLACES, self.slowest, self.fastest)))
        return np.kron(np.eye(2 if self.transmitted else 1), root)

    def beside(self, speed: Array, transmitted: Array | float) -> Array:
        """Return friction for values of 1 at each knot alone at speeds (n, 2k) or (n, k) [N]."""
        own = newton(np.asarray(place_of(speed, self.slowest, self.fastest)), PLACES) @ self.waves
        if not self.transmitted:
            return np.asarray(own)
        share = np.abs(transmitted * np.ones(len(speed))) / self.transmitted
        return np.hstack([own, share[:, None] * own])

    @cached_property
    def _table(self) -> Array:
        """Coefficients of Newton's polynomials for values at the knots (m, m)."""
        sizes = [1.0, 1.0 / self.transmitted] if self.transmitted else [1.0]
        return np.asarray(np.kron(np.diag(sizes), self.waves), dtype=float)

    @cached_property
    def _runs(self) -> Shooting:
        """Runs of the law with friction beside it, from where the fit ended with none."""
        fit, none = self.fit, tuple(Number(value=0.0) for _ in PLACES)
        gear = none if self.transmitted else ()
        inputs = dict.fromkeys((*fit.law.inputs, *([TRANSMITTED] if gear else [])))
        law = _kind(tuple(inputs))(
            law=fit.law, level=none, gear=gear, slowest=self.slowest, fastest=self.fastest
        )
        own = [
            replace(item, start=at, path=_inner(item.path), above=_inner(item.above))
            for item, at in zip(fit.free_parameters.items, fit.values.tolist(), strict=True)
        ]
        own += [
            FreeParameter(path=f"friction.{part}.{k}.value", quantity=Quantity("c"), start=0.0)
            for part, of_part in (("level", none), ("gear", gear))
            for k in range(len(of_part))
        ]
        problem = replace(fit.problem.starting_from(fit.optimum.best), law=law)
        return problem.with_free_parameters(FreeParameters(tuple(own)))

    @cached_property
    def _told(self) -> "_Told":
        """What the readings say of friction beside the law, linear about where they lead."""
        runs, count = self._runs, len(self.fit.values)
        seen = runs.linearise(runs.free_parameters.start)
        told = self._read(seen)
        for _ in range(AGAIN):
            likely = np.array([told.at(size * self.root)[2] for size in SIZES]) + np.log(SIZE_PRIOR)
            size = SIZES[int(np.argmax(likely))]
            if not size:
                break
            root = np.linalg.inv(size * self._table @ self.root)
            prior = np.hstack([np.zeros((len(root), count)), root])
            sought = _WithPrior(runs=runs, rows=told.deviation * prior)
            end, _ = improve(
                sought, seen.values, near=sought.of(seen), rounds=STEPS,
                least=2.0 * SETTLED * told.deviation**2,
            )  # fmt: skip
            seen = runs.linearise(end.values, end)
            told = self._read(seen)
        return told

    def _read(self, seen: ResidualJacobian) -> "_Told":
        """Return what linear runs say of the values at the knots, whatever the parameters are."""
        count, scale = len(self.fit.values), self.fit.scale
        table, beside = seen.slopes[:, :count] @ scale, seen.slopes[:, count:] @ self._table
        middle = np.asarray(np.linalg.solve(self._table, seen.values[count:]), dtype=float)
        inverse = np.linalg.pinv(table)
        goes = inverse @ beside
        beside = beside - table @ goes
        left = seen.residual - table @ (inverse @ seen.residual) + beside @ middle
        wide = SIZES[-1] ** 2 * self.root @ self.root.T
        precision = np.asarray(np.linalg.inv(wide), dtype=float)
        rest = left - beside @ middle
        for _ in range(AGAIN):
            deviation = math.sqrt(float(rest @ rest) / max(len(rest) - table.shape[1], 1))
            share = min(worth(beside / deviation, rest, precision), KAPPA)
            counted = share / deviation**2
            gram, moment = counted * beside.T @ beside, counted * beside.T @ left
            rest = left - beside @ np.linalg.solve(gram + precision, moment)
        return _Told(
            gram=gram,
            moment=moment,
            values=seen.values[:count],
            middle=middle,
            goes=scale @ goes,
            deviation=deviation / math.sqrt(share),
        )

    @cached_property
    def _spread(self) -> tuple[Array, Array]:
        """Root of the correlation of the parameters (p, p), and their half widths (p,).

        What a bound holds stays there; others vary as they do with it there.
        """
        fit, inference = self.fit, self.fit.inference
        table, half = inference.correlation.copy(), inference.half_widths
        still = ~np.isfinite(half)
        still |= np.array([item.path in fit.at_bounds for item in fit.free_parameters.items])
        across = table[:, still]
        table = table - across @ np.linalg.pinv(table[np.ix_(still, still)]) @ across.T
        table[still] = table[:, still] = 0.0
        size = np.sqrt(np.maximum(np.diag(table), 0.0))
        scale = np.where(size > 1e-12, size, 1.0)
        value, vector = np.linalg.eigh(table / np.outer(scale, scale))
        return vector * np.sqrt(np.maximum(value, 0.0)), np.where(still, 0.0, half) * size

    def evidence(self, size: float) -> float:
        """Return the logarithm of the probability of the readings for a size."""
        return self._told.at(size * self.root)[2]

    @cached_property
    def without(self) -> float:
        """Logarithm of the odds of friction against none, with another mechanism to first order.

        By the criterion of Schwarz: each parameter of friction costs half the logarithm of how many
        readings count.
        """
        fit = self.fit
        free = fit.free_parameters
        sizes = [x.path.startswith("friction.") and x.low <= 0.0 and not x.log for x in free.items]
        none = fit.problem.linearise(np.where(sizes, 0.0, fit.values), fit.optimum.best)
        if not none.finite:
            return math.inf
        table = none.slopes[:, [not x.path.startswith("friction.") for x in free.items]]
        left = none.residual - table @ np.linalg.lstsq(table, none.residual)[0]
        least, spread = fit.optimum.best.cost, self._told.deviation**2
        counted = max(least / spread, 1.0)
        return 0.5 * float(left @ left - least) / spread - 0.5 * sum(sizes) * math.log(counted)

    def drawn(
        self, size: float, count: int, rng: np.random.Generator
    ) -> tuple[Array, dict[str, Array]]:
        """Return draws of the values at the knots (m, k), and of the parameters (k,) by path."""
        told, fit = self._told, self.fit
        mean, root, _ = told.at(size * self.root)
        values = mean[:, None] + root @ rng.normal(size=(len(mean), SPARE * count))
        turn, half = self._spread
        normal = ndtr(turn @ rng.normal(size=(len(half), SPARE * count)))
        freedom = np.minimum(fit.inference.freedom, 1e6)[:, None]
        off = half[:, None] * stdtrit(freedom, normal) / stdtrit(freedom, 0.975)
        moved = off - told.goes @ (values - told.middle[:, None])
        drawn, inside = dict[str, Array](), np.ones(SPARE * count, dtype=bool)
        for item, at, own in zip(fit.free_parameters.items, told.values, moved, strict=True):
            x = at * np.exp(np.clip(own / at, -50.0, 50.0)) if item.log else at + own
            low, high = (item.low, item.high) if not item.above else (-math.inf, math.inf)
            inside &= (x >= low) & (x <= high)
            drawn[item.path] = x  # only with it is friction beside the law what it is
        kept = np.argsort(~inside, kind="stable")[:count]
        return values[:, kept], {path: x[kept] for path, x in drawn.items()}


class RunPosterior:
    """Weights of a law, and of no friction, at sizes of what no law says; draws of them."""

    def __init__(self, runs: DrivenRuns) -> None:
        self.runs = runs
        law = runs.law.structure(runs.law.values)
        self.structures: tuple[Structure, ...] = (law, ())
        self.nodes: tuple[Node, ...] = tuple((k,) for k in range(len(SIZES)))
        evidence = np.array([runs.evidence(size) for size in SIZES]) + np.log(SIZE_PRIOR)
        self.weights: Array = np.zeros((len(SIZES), 2))
        """Posterior probabilities of nodes and structures (k, s), in sum 1."""
        friction = float(expit(runs.without))
        self.weights[:, 0] = friction * np.exp(evidence - logsumexp(evidence))
        self.weights[0, 1] = 1.0 - friction

    @cached_property
    def best(self) -> Draws:
        """The law that was fitted, with nothing beside it, as a draw."""
        fit, law = self.runs.fit, self.structures[0]
        at = dict(zip(fit.free_parameters.paths, fit.values.tolist(), strict=True))
        return self._draw(0, law, np.zeros((self.runs.root.shape[0], 1)), at)

    def _draw(
        self, node: int, structure: Structure, beside: Array, values: Mapping[str, Array | float]
    ) -> Draws:
        """Return draws of values at the knots (m, k), and of parameters (k,) by path."""
        count = beside.shape[1]
        law = [
            np.ones(count) if x.place < 0 else values[f"friction.{x.own.varied[x.place]}"]
            for x in (slope(name) for name, _ in structure)
        ]
        rig = [values[path] * np.ones(count) for path in self.runs.paths]
        return Draws(
            node=(node,),
            structure=structure,
            law=np.array([x * np.ones(count) for x in law]).reshape(len(structure), count),
            random=np.array([*beside, *rig]),
        )

    @property
    def shares(self) -> Array:
        """Posterior probabilities of the structures (s,)."""
        return np.asarray(self.weights.sum(axis=0))

    def draws(
        self, count: int, *, seed: int = 0, only: "NDArray[np.bool_] | None" = None
    ) -> list[Draws]:
        """Return `count` draws, in the order of nodes and structures, of those in `only` (k, s).

        Random coefficients are the values at the knots, then what is looked for of the mechanism.
        """
        weights = self.weights if only is None else np.where(only, self.weights, 0.0)
        numbers, result = allotted(weights.ravel(), count).reshape(weights.shape), []
        for a, k in np.argwhere(numbers > 0).tolist():
            rng = np.random.default_rng([seed, a, k])
            own, structure = int(numbers[a, k]), self.structures[k]
            result.append(self._draw(a, structure, *self.runs.drawn(SIZES[a], own, rng)))
        return result


@dataclass(eq=False)
class DrivenProblem(Problem):
    """Records under a voltage, where runs tell a law and constants of a motor.

    What is no curve, such as the noise of a reading of the force, is that of a force balance with
    what the runs say of the mechanism.

    Parameters
    ----------
    plain : RecordProblem
        That balance.
    fit : RecordFit
        The law by runs.
    """

    plain: RecordProblem
    fit: RecordFit
    restricted = True

    def __post_init__(self) -> None:
        plain, frame = self.plain, self.plain.model.frame
        self.records, self.size, self.load = plain.records, plain.size, plain.load
        self.runs, self.grid, self.fitted = plain.runs, plain.grid, True
        self.driven = DrivenRuns(
            fit=self.fit,
            slowest=frame.low,
            fastest=frame.top,
            size=plain.size,
            transmitted=sum(frame.transmitted[1:2]),
        )
        self.posterior = RunPosterior(self.driven)
        self.best = self.posterior.best

    # ---- rows -------------------------------------------------------------------------------

    def at(
        self, velocity: Any, load: Any = None, inputs: Mapping[str, Any] | None = None
    ) -> SteadyRows:
        return self.plain.at(velocity, load, inputs)

    def asked(self) -> SteadyRows:
        return self.plain.asked()

    def places(self) -> SteadyRows:
        return self.plain.places()

    def curve_rows(self) -> SteadyRows:
        return self.plain.curve_rows()

    def slips(self, rows: SteadyRows) -> Slips:
        return self.plain.slips(rows)

    def like(self, records: Sequence[Record]) -> OtherRows:
        """Return the rows of other records, which are another run."""
        return self.plain.like(records)

    def usual(self, rows: OtherRows) -> Array:
        return self.plain.usual(rows)

    @property
    def run_sizes(self) -> tuple[Sequence[float], Sequence[float]]:
        """By how much runs may differ, over friction, with the probabilities: no run tells it."""
        return RUNS, RUN_PRIOR

    # ---- laws -------------------------------------------------------------------------------

    def columns(self, column: tuple[str, Any], rows: SteadyRows) -> list[Array]:
        return self.plain.columns(column, rows)

    def candidates(self) -> list[Candidates]:
        law = self.posterior.structures[0]
        count = len(self.driven.law.varied)
        return [Candidates(family=family_of(law), structures=[law], parameters=count)]

    def composition(
        self,
        structure: Shaped,
        coefficients: Array,
        draws: Sequence[Draws] | None = None,
        *,
        offset: bool = False,
    ) -> Composition:
        load = np.full(len(coefficients), self.load)
        if not structure:
            return replace(compose({}, {}, len(coefficients)), load=load)
        frame = self.plain.model.frame
        means = {name: mean for name, (mean, _) in frame.inputs.items()}
        means |= dict(zip([TRANSMITTED], frame.transmitted[1:2], strict=False))
        return replace(own_composition(structure, coefficients), load=load, inputs=means)

    # ---- weights ----------------------------------------------------------------------------

    def is_small(self, tolerance: float) -> "NDArray[np.bool_]":
        return np.array([SIZES[node[0]] <= tolerance for node in self.posterior.nodes])

    def holds(self, family: Family) -> "NDArray[np.bool_]":
        """Return the nodes and structures (k, s) at which a law holds.

        They are those with nothing beside it, unless that is improbable.
        """
        every = super().holds(family)
        alone = every & self.is_small(0.0)[:, None]
        likely = float(self.posterior.weights[alone].sum()) >= CHANCE
        return np.asarray(alone if likely else every)

    def nothing(self) -> "NDArray[np.bool_]":
        return np.asarray(super().holds(()) & self.is_small(0.0)[:, None])

    # ---- curves -----------------------------------------------------------------------------

    def steady(self, rows: SteadyRows, draws: Sequence[Draws]) -> Array:
        count = self.driven.root.shape[0]
        side, curves = np.sign(rows.velocity), list[Array]()
        beside = side[:, None] * self.driven.beside(np.abs(rows.velocity), self._through(rows))
        for draw in draws:
            law = self.design(draw.structure, rows) @ draw.law
            curves.append((law + beside @ draw.random[:count]).T * bool(draw.structure))
        return np.vstack(curves)

    def _through(self, rows: SteadyRows) -> Array:
        return np.asarray(rows.transmitted) * rows.ratio

    def friction(self, rows: SteadyRows, draws: Sequence[Draws], *, new: bool = False) -> Array:
        curves = self.steady(rows, draws) + beyond(self.plain.model, draws, rows)
        if not new:
            return curves
        rng = np.random.default_rng(7)
        sizes = rng.choice(RUNS, p=RUN_PRIOR, size=(len(curves), 1))
        return np.asarray(curves * (1.0 + sizes * rng.normal(size=(len(curves), 1))))

    def readings(self, rows: SteadyRows | OtherRows, draws: Sequence[Draws]) -> Array:
        if isinstance(rows, OtherRows):  # forces along other records are those of the balance
            return self.plain.readings(rows, self.plain.posterior.draws(DRAWS))
        curves = self.friction(rows, draws, new=True)
        noise = np.random.default_rng(11).normal(size=curves.shape)
        return np.asarray(curves + self.plain.noise(rows) * noise)

    # ---- what leaves ------------------------------------------------------------------------

    def rig(self, draws: Sequence[Draws]) -> dict[str, Array]:
        count = self.driven.root.shape[0]
        random = np.hstack([draw.random[count:] for draw in draws])
        return dict(zip(self.driven.paths, random, strict=True))

    def points(self, rung: Rung) -> MeasuredPoints:
        return self.plain.points(rung)

    def scatter(self, rung: Rung) -> float:
        rows = self.asked()
        middle = np.mean(self.steady(rows, self.posterior.draws(LEVELS)), axis=0)
        off = middle - self.design(rung.structure, rows) @ rung.coefficients
        return math.hypot(self.plain.noise_of_rows, math.sqrt(float(np.mean(off**2))))

    def untold(self) -> list[str]:
        return [*self.fit.sentences, UNSEEN]

    @property
    def followed(self) -> str:
        """How closely runs of the law follow the readings, in a sentence."""
        unit = self.fit.measurement.unit(self.fit.problem.quantity)
        length = quantity(float(np.median(np.ptp(self.fit.problem.spans[:, 1:], axis=1))), "s", 2)
        return (
            f"Runs of the mechanism with the law, in segments of {length}, determine its parameters"
            f" and those of the mechanism; they leave {quantity(self.fit.rms, unit, 2)} of the"
            f" {self.fit.problem.quantity} (root mean square)."
        )


def slope(name: str) -> Slope:
    """Return the name of a term as that of a law's parameter."""
    assert is_slope(name)
    return name
