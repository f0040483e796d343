r"""Simulated measurements: laws whose readings only a run tells, and their posterior.

A `Simulated` measurement says what its rows are, what a law makes of them (*simulate*), what is
unknown with which prior (*vary*), and which columns are always there. The model of a row is

    y_i = f_i(theta) + sum_k b_k z_k(i) + e_i,    theta ~ N(m, s^2),  b_k ~ N(0, q_kj^2)

with f a run of the law of a family, b what every experiment may have, with one of several sets j of
prior sizes, and e noise of one unknown size. Rows that are not independent count kappa of a row, by
the autocorrelation of what the best law leaves. Then for kappa n rows in effect:

1. *Linear part*. For given theta, b is integrated in closed form: with weights W,
   :math:`A_j = Z^T W Z + \Lambda_j`, :math:`\Lambda_j = \sigma^2/(\kappa q_j^2)`,
   :math:`S_j = r^T W r - r^T W Z A_j^{-1} Z^T W r` of r = y - f,

       log p(y | theta, j) = -(kappa n/2) log S_j - log(|A_j| / |Lambda_j|)/2.

2. *Modes*. Damped Gauss-Newton from several starts of every family at once, with derivatives by
   differences of runs; the laws that contain others begin where those ended.
3. *Laplace*. Families far below the best by Laplace's approximation keep that evidence.
4. *Draws weighed by exact runs*. Of the others, draws from Student's t about the modes have the
   weights w = p(y | theta) p(theta) / q(theta) of their own runs. The next proposals are t about
   the weighted draws, until `ENOUGH` are effective. Where rows tell less than there are unknowns,
   the posterior is a curved ridge: then some proposals are led to it by Newton's method, and
   others made about them, each with the second derivatives there. The evidence of a family is the
   mean weight of its draws of the last round, and their effective number, (sum w)^2 / sum w^2, is
   told.

Sources: R. E. Kass and A. E. Raftery, "Bayes factors", JASA 90 (1995) 773-795; O. Cappé and others,
"Population Monte Carlo", Journal of Computational and Graphical Statistics 13 (2004) 907-929.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.special import gammaln, logsumexp

from stickslip.identify.bands import ENDS, Array
from stickslip.identify.fits import BLOCKS, Estimate
from stickslip.identify.posterior import allotted
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity
from stickslip.show.formatting import significant

ROUNDS = 40
"""Steps of the search from a start at most."""
SETTLED = 0.01
"""Logarithm of the posterior that a step gains, below which a search ends."""
FAR = -math.log(THRESHOLDS.rounding)
"""Logarithm of the evidence by Laplace below the best from which a family needs no runs: its share
would be one in a million."""
PROPOSED = 400
"""Draws of a family in each round, if a problem asks for no more, and those that are kept, each
with the same weight."""
ENOUGH = 150.0
"""Effective draws of a family, or of all together, from which no further round is made: quantiles
of 95 % are then known to a fifth of the half width."""
AGAIN = 6
"""Rounds of draws at most."""
TAILS = THRESHOLDS.freedom
"""Degrees of freedom of proposals: weights stay bounded where the posterior has wider tails."""
WHITE = 0.7
"""Share of rows that counts at most: what a law lacks is alike in neighbouring rows, also where it
is too small to be seen in the autocorrelation of the noise."""

FIRST, EASED, STIFFENED, MOST = 1e-2, 0.2, 10.0, 1e7
"""Damping of a first step, its factors after a step that is kept and one that is not, and the
damping at which a descent ends."""

UNTOLD = 0.7
"""Deviation of draws over that of their prior, above which the rows tell nothing of a parameter."""

Watch: TypeAlias = Callable[[str, float], object]


@dataclass(frozen=True, kw_only=True, eq=False)
class Unknowns:
    """What is unknown of a family, in coordinates in which its prior is normal."""

    names: tuple[str, ...]
    mean: Array
    """Prior means (p,)."""
    deviation: Array
    """Prior standard deviations (p,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Always:
    """What every experiment may have: linear columns, each with the sizes it may have."""

    columns: Array
    """Columns (n, q)."""
    sizes: Array
    """Prior standard deviations (j, q) of the coefficients, a row for each set of sizes."""
    prior: Array
    """Probabilities of the sets of sizes (j,), in sum 1."""


class Readable(ABC):
    """What fits and verdicts read from draws of laws."""

    ends: tuple[float, float] = ENDS
    """Quantiles of draws between which an interval lies."""
    no_run: str = "no run works"
    """What is said of a law of which no run gives rows."""
    repeated: bool = False
    """Whether all readings repeat a single setting, so that none predicts another."""

    def failed(self, name: str) -> str:
        """Return why a law has no fit although runs of it were tried."""
        return self.no_run

    def title(self, family: str) -> str:
        """Return the name of a family in running text."""
        return family

    @abstractmethod
    def sought(self, family: str) -> Sequence[str]:
        """Return the paths of the parameters that are estimated, in the order of their report."""

    def derived(self, family: str) -> Mapping[str, Quantity]:
        """Return what follows from the parameters and is reported with an interval, by path."""
        return {}

    @abstractmethod
    def quantities(self, family: str) -> Mapping[str, Quantity]:
        """Return symbols and units of the parameters, by path."""

    def read(self, family: str, points: Array, coefficients: Array) -> Mapping[str, Array]:
        """Return parameters, and what is derived (k,), SI, by path, of draws (k, p) and (k, q)."""
        return dict(zip(self.sought(family), points.T, strict=True))

    @abstractmethod
    def result(self, family: str, values: Mapping[str, float]) -> tuple[Any, Mechanism]:
        """Return the law and the mechanism with values of parameters, by path."""

    def told(self, family: Any, name: str, estimates: Sequence[Estimate]) -> Sequence[Estimate]:
        """Return the estimates of a law, those that rows do not tell with the reason."""
        return estimates

    def leaves(self, family: Any, name: str) -> float:
        """Return the root mean square of what a law leaves, in the unit of the kind."""
        return float(family.rms)

    def contains(self, name: str, other: str) -> bool:
        """Return whether a family is another one at some values of its parameters."""
        return False


class Simulated(Readable):
    """A measurement whose rows are told by runs of laws."""

    measured: Array
    """Rows (n,), in the order in which they were taken."""
    weights: Array
    """Weights of the rows (n,), in the mean 1: samples of which each is the mean."""
    always: Always
    """What every experiment may have."""
    stages: Sequence[Sequence[str]]
    """Names of the families; those of a stage begin where those of the earlier ones ended."""
    places: int = 0
    """Draws about which proposals are made with derivatives of their own; 0 for none."""
    proposed: int = PROPOSED
    """Draws of a family in each round."""

    @abstractmethod
    def prior(self, family: str) -> float:
        """Return the logarithm of the prior probability of a family, up to a constant."""

    @abstractmethod
    def vary(self, family: str) -> Unknowns:
        """Return what is unknown of a family."""

    @abstractmethod
    def starts(self, family: str, ends: Mapping[str, Array]) -> Array:
        """Return where searches begin (m, p), from the modes (p,) of families of earlier stages."""

    def sought(self, family: str) -> Sequence[str]:
        return self.vary(family).names

    @abstractmethod
    def simulate(self, asked: Mapping[str, Array]) -> Mapping[str, Array]:
        """Return rows (n, k) for points (k, p) by family; NaN where a run fails or is no law."""


@dataclass(eq=False)
class Descents:
    r"""Damped Gauss-Newton descents from several starts at once, as runs are cheaper together.

    The logarithm of the posterior has the gradient :math:`g` and the curvature :math:`H` over the
    scales of the unknowns. The step is :math:`(H + \lambda\,\mathrm{diag}\,H)^{-1} g` of those
    that no bound holds. A step that gains is kept, and :math:`\lambda` falls; else it grows [M]_.

    .. [M] J. J. Moré, "The Levenberg-Marquardt algorithm: implementation and theory", Lecture Notes
       in Mathematics 630 (1978) 105-116.
    """

    at: Array
    """Where they are (m, p)."""
    scale: Array
    """Scales of the unknowns (m, p), in which steps, gradients and curvatures are counted."""
    settled: float
    """Gain of a step, in the logarithm of the posterior, up to which a descent ends."""
    low: Array | float = -np.inf
    """Least values of the unknowns (p,) and ..."""
    high: Array | float = np.inf
    """... largest ones."""
    reach: float = 2.0
    """Longest step of an unknown over its scale."""
    value: Array = field(init=False)
    """Logarithm of the posterior there (m,), up to a constant."""
    gradient: Array = field(init=False)
    """Gradients (m, p) and ..."""
    curvature: Array = field(init=False)
    """... minus second derivatives (m, p, p) by Gauss and Newton."""
    damping: Array = field(init=False)
    live: NDArray[np.bool_] = field(init=False)
    """Which of them go on (m,)."""

    def __post_init__(self) -> None:
        m, p = self.at.shape
        self.value, self.damping = np.full(m, -np.inf), np.full(m, FIRST)
        self.gradient, self.live = np.zeros((m, p)), np.ones(m, dtype=bool)
        self.curvature = np.broadcast_to(np.eye(p), (m, p, p)).copy()

    def proposed(self) -> Array:
        """Return the points of the next step (m, p)."""
        p, g = self.at.shape[1], self.gradient
        held = (self.at <= self.low) & (g < 0.0) | (self.at >= self.high) & (g > 0.0)
        h = np.where(held[:, :, None] | held[:, None, :], 0.0, self.curvature)
        diagonal = np.einsum("kii->ki", h)
        # what hardly matters is held back by what matters: else it would leap
        least = 1e-9 * np.max(diagonal, axis=1, keepdims=True)
        added = self.damping[:, None] * diagonal + least + (diagonal <= 0.0)
        lifted, right = h + added[:, :, None] * np.eye(p), np.where(held, 0.0, g)
        step = np.linalg.solve(lifted, right[:, :, None])[:, :, 0]
        longest = np.maximum(np.abs(step).max(axis=1, keepdims=True), 1e-300)
        step *= np.minimum(1.0, self.reach / longest)
        return np.asarray(np.clip(self.at + step * self.scale, self.low, self.high))

    def accept(self, points: Array, value: Array, *, first: bool = False) -> NDArray[np.intp]:
        """Move to those points (k, p) of live descents that gain; return which these are."""
        (which,) = np.nonzero(self.live)
        gain = np.where(np.isfinite(value), value, -np.inf) - np.maximum(self.value[which], -1e300)
        better = np.isfinite(value) & (first | (gain > 0.0))
        kept, others = which[better], which[~better]
        self.at[kept], self.value[kept] = points[better], value[better]
        self.damping[kept] *= EASED
        self.live[kept] = first | (gain[better] > self.settled)
        self.damping[others] = np.maximum(self.damping[others], 1e-3) * STIFFENED
        self.live[others] = (self.damping[others] < MOST) & (not first)
        return np.flatnonzero(better)


class _Search(Descents):
    """Searches of one family, over the deviations of its prior."""

    def __init__(self, unknowns: Unknowns, at: Array) -> None:
        super().__init__(at, np.broadcast_to(unknowns.deviation, at.shape), settled=SETTLED)
        self.unknowns = unknowns


@dataclass(frozen=True, kw_only=True, eq=False)
class FamilyDraws:
    """Draws of a family that were weighed by their own runs."""

    mode: Array
    """Where the posterior is largest (p,)."""
    effective: float
    """Effective number of the weighed draws; 0 where Laplace's approximation alone was made."""
    points: Array
    """Draws of the unknowns (k, p), each with the same weight; of what is far below the best by
    Laplace's approximation."""
    coefficients: Array
    """Draws of the coefficients of what is always there (k, q)."""
    usual: Array
    """Coefficients of what is always there (q,) at the mode."""
    rms: float
    """Root mean square of what the mode leaves; infinite where no run works."""

    @property
    def few_draws(self) -> tuple[str, ...]:
        """What is not told where few draws count, as a sentence; empty where enough do."""
        if self.effective >= ENOUGH / 3.0:
            return ()
        return (
            "Intervals are accurate to a third alone: the effective number of draws is"
            f" {significant(self.effective, 2)}.",
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class FamilyPosterior(FamilyDraws):
    """What the rows say of one family."""

    unknowns: Unknowns
    evidence: float
    """Logarithm of the probability of the rows, up to a constant that all families share."""
    sets: NDArray[np.intp]
    """Sets of sizes (k,) of what is always there, from which the draws are."""
    band: Array
    """Quantiles of 2.5, 50 and 97.5 % of the rows (3, n), without their noise."""

    def is_prior(self, name: str) -> bool:
        """Return whether draws of a coordinate are as wide as its prior."""
        at = self.unknowns.names.index(name)
        return float(np.std(self.points[:, at])) > UNTOLD * float(self.unknowns.deviation[at])


class SimulatedPosterior:
    """The posterior of a simulated measurement.

    Parameters
    ----------
    problem : Simulated
        The measurement.
    starts : int
        Searches of each family that are followed to their end, of those that begin.
    seed : int
        Seed of the draws.
    watch : callable, optional
        Called with a family and the root mean square of what it leaves; False ends the searches.
    """

    def __init__(
        self, problem: Simulated, *, starts: int = 4, seed: int = 0, watch: Watch | None = None
    ) -> None:
        self.problem, self._starts, self._watch = problem, starts, watch
        self.cancelled = False
        self._rng = np.random.default_rng(seed)
        self._w = problem.weights[:, None]
        step = np.diff(problem.measured)
        self.kappa = WHITE
        """Independent rows over rows."""
        self.noise = max(float(np.sqrt(0.5 * np.mean(step**2))), 1e-9 * float(np.std(step)), 1e-12)
        """Standard deviation of a row."""
        self._searches: dict[str, _Search] = {}
        self._set_scales()
        for stage in problem.stages:
            ends = {
                name: search.at[int(np.argmax(search.value))]
                for name, search in self._searches.items()
            }
            self._search({name: problem.starts(name, ends) for name in stage})
            self._set_noise()
        self._search(
            {name: self._best(search) for name, search in self._searches.items()}, again=True
        )
        self.families = self._judged()
        """What is said of each family, by name."""
        evidence = np.array([family.evidence + problem.prior(name)
                             for name, family in self.families.items()])  # fmt: skip
        works = np.isfinite(evidence)
        total = logsumexp(evidence[works]) if works.any() else 0.0
        chances = np.exp(np.where(works, evidence - total, -np.inf))
        self.shares = dict(zip(self.families, chances.tolist(), strict=True))
        """Posterior probabilities of the families, by name, in sum 1; 0 where no run works."""

    @property
    def effective(self) -> float:
        """Effective number of draws of the most probable family."""
        return self.families[max(self.shares, key=self.shares.__getitem__)].effective

    # ------------------------------------------------------------------ likelihood
    @property
    def counted(self) -> float:
        """Rows that count."""
        return max(self.kappa * len(self.problem.measured), float(BLOCKS))

    def _set_scales(self) -> None:
        """Prepare what the linear part needs for the noise and share of rows."""
        z, always = self.problem.always.columns, self.problem.always
        self._zw = (z * self._w).T
        gram = self._zw @ z
        ratio = self.noise**2 * len(z) / self.counted
        self._precisions = [np.diag(gram) * 0.0 + ratio / size**2 for size in always.sizes]
        self._inverses = [
            np.linalg.inv(gram + np.diag(precision)) for precision in self._precisions
        ]
        self._volumes = np.array([
            0.5 * (np.sum(np.log(precision)) + np.linalg.slogdet(inverse)[1])
            for precision, inverse in zip(self._precisions, self._inverses, strict=True)
        ])  # fmt: skip

    def _squares(self, left: Array) -> Array:
        """Return what no column takes of residuals (n, k), weighted, by set of sizes (j, k)."""
        total, moment = np.sum(self._w * left**2, axis=0), self._zw @ left
        return np.array([
            np.maximum(total - np.sum(moment * (inverse @ moment), axis=0), 1e-300)
            for inverse in self._inverses
        ])  # fmt: skip

    def _likelihoods(self, squares: Array) -> Array:
        """Return the logarithms (j, k) of the likelihood, with the prior of the sets of sizes."""
        volume = self._volumes + np.log(self.problem.always.prior)
        return np.asarray(volume[:, None] - 0.5 * self.counted * np.log(squares))

    @staticmethod
    def _priors(unknowns: Unknowns, points: Array) -> Array:
        """Return the logarithms of the prior density (k,)."""
        z = (points - unknowns.mean) / unknowns.deviation
        norm = np.sum(np.log(unknowns.deviation)) + 0.5 * z.shape[1] * math.log(2.0 * math.pi)
        return np.asarray(-0.5 * np.sum(z**2, axis=1) - norm)

    def _runs(self, asked: Mapping[str, Array]) -> dict[str, Array]:
        """Return residuals (n, k) by family; infinite where a run fails."""
        rows = self.problem.simulate(asked)
        y = self.problem.measured[:, None]
        return {name: np.where(np.isfinite(f), y - f, np.inf) for name, f in rows.items()}

    def _value(self, unknowns: Unknowns, points: Array, left: Array) -> Array:
        """Return the logarithm of the posterior density (k,); minus infinity without a run."""
        works = np.isfinite(left).all(axis=0)
        safe = np.where(works, left, 0.0)
        likelihood = logsumexp(self._likelihoods(self._squares(safe)), axis=0)
        return np.where(works, likelihood + self._priors(unknowns, points), -np.inf)

    # ------------------------------------------------------------------ modes
    def _search(self, starts: Mapping[str, Array], *, again: bool = False) -> None:
        """Search the modes of families, all at once, from starts (m, p)."""
        searches: dict[str, _Search] = {}
        left = self._runs(starts)
        for name, at in starts.items():
            unknowns = self.problem.vary(name)
            value = self._value(unknowns, at, left[name])
            best = np.argsort(-value, kind="stable")[: self._starts]
            searches[name] = _Search(unknowns, at[best])
        self._linearise(
            searches, {name: search.at for name, search in searches.items()}, first=True
        )
        for _ in range(4 if again else ROUNDS):
            active = {n: s for n, s in searches.items() if s.live.any() and s.at.shape[1]}
            if not active or self.cancelled:
                break
            self._linearise(active, {name: item.proposed() for name, item in active.items()})
            self._tell(active)
        self._searches |= searches

    def _tell(self, active: Mapping[str, _Search]) -> None:
        if self._watch is None:
            return
        for name, item in active.items():
            best = float(np.max(item.value - self._priors(item.unknowns, item.at)))
            rms = math.exp(-best / self.counted) / math.sqrt(len(self.problem.measured))
            if self._watch(name, rms) is False:
                self.cancelled = True

    def _linearise(
        self, searches: Mapping[str, _Search], points: Mapping[str, Array], *, first: bool = False
    ) -> None:
        """Move searches to points (m, p) that are better, with derivatives there."""
        steps = {name: 1e-3 * search.unknowns.deviation for name, search in searches.items()}
        asked = {}
        for name, item in searches.items():
            at = points[name][item.live]
            nudged = at[:, None, :] + np.diag(steps[name])[None]
            asked[name] = np.concatenate([at, nudged.reshape(at.size, at.shape[1])])
        every = self._runs(asked)
        for name, item in searches.items():
            (which,) = np.nonzero(item.live)
            at, k, p = points[name][which], len(which), item.at.shape[1]
            left, nudged = every[name][:, :k], every[name][:, k:].reshape(len(self._w), k, p)
            value = self._value(item.unknowns, at, left)
            for number in item.accept(at, value, first=first):
                slopes = (left[:, number, None] - nudged[:, number]) / 1e-3
                slopes = np.where(np.isfinite(slopes), slopes, 0.0)
                place = which[number]
                item.gradient[place], item.curvature[place] = self._newton(
                    item.unknowns, at[number], left[:, number], slopes
                )

    def _newton(
        self, unknowns: Unknowns, at: Array, left: Array, slopes: Array, which: int | None = None
    ) -> tuple[Array, Array]:
        """Return gradient (p,) and minus the second derivative (p, p), over prior deviations.

        They are those for a set of sizes of what is always there, the likeliest if none is asked.
        """
        squares = self._squares(left[:, None])
        if which is None:
            which = int(np.argmax(self._likelihoods(squares)[:, 0]))
        inverse, scale = self._inverses[which], self.counted / float(squares[which, 0])
        back = self._zw @ slopes
        plain = slopes.T * self._w[:, 0]
        h = plain @ slopes - back.T @ inverse @ back
        g = plain @ left - back.T @ (inverse @ (self._zw @ left))
        own = (at - unknowns.mean) / unknowns.deviation
        return scale * g - own, scale * h + np.eye(len(at))

    @staticmethod
    def _best(one: _Search) -> Array:
        """Return the modes that matter (m, p), the best first."""
        order = np.argsort(-one.value, kind="stable")
        kept = [order[0]]
        for k in order[1:]:
            near = one.value[k] > one.value[order[0]] - 6.0
            gaps = np.abs(one.at[kept] - one.at[k]) / one.unknowns.deviation
            if near and one.at.shape[1] and gaps.max(axis=1).min() > 0.1:
                kept.append(k)
        return np.array(one.at[kept])

    def _set_noise(self) -> None:
        """Take the noise and the share of rows that count from what the best law leaves."""
        name, one = max(self._searches.items(), key=lambda item: float(np.max(item[1].value)))
        if not np.isfinite(one.value).any():
            return
        best = one.at[[int(np.argmax(one.value))]]
        left = self._runs({name: best})[name][:, 0]
        left = left - self.problem.always.columns @ self._usual(left)
        self.noise = max(float(np.sqrt(np.mean(self.problem.weights * left**2))), 1e-12)
        alike = effective_size(left * np.sqrt(self.problem.weights)) / len(left)
        self.kappa = min(alike, WHITE)
        self._set_scales()
        left_of = self._runs({name: each.at for name, each in self._searches.items()})
        for name, each in self._searches.items():
            each.value = self._value(each.unknowns, each.at, left_of[name])

    def _usual(self, left: Array) -> Array:
        """Return the coefficients (q,) of what is always there for residuals (n,)."""
        which = int(np.argmax(self._likelihoods(self._squares(left[:, None]))[:, 0]))
        return np.asarray(self._inverses[which] @ (self._zw @ left))

    # ------------------------------------------------------------------ draws
    def _judged(self) -> dict[str, FamilyPosterior]:
        """Return what is said of each family: by weighed draws where it may hold."""
        rough = {name: self._laplace(search) for name, search in self._searches.items()}
        best = max(value + self.problem.prior(name) for name, value in rough.items())
        proposals = {
            name: [
                (search.at[k], _root(search.curvature[k], search.unknowns.deviation))
                for k in self._places(search)
            ]
            for name, search in self._searches.items()
            if math.isfinite(rough[name])
        }
        near = [name for name in proposals
                if rough[name] + self.problem.prior(name) > best - FAR
                and self._searches[name].at.shape[1]]  # fmt: skip
        weighed: dict[str, tuple[Array, Array, Array]] = {}
        for number in range(AGAIN):
            todo = [
                name
                for name in near
                if name not in weighed or effective_draws(weighed[name][1]) < ENOUGH
            ]
            if not todo:
                break
            for name in todo:
                if number:
                    proposals[name] = self._closer(*weighed[name][:2], proposals[name])
                proposals[name] = [*proposals[name], *self._along(name, proposals[name])]
            points = {name: self._proposed(proposals[name]) for name in todo}
            left = self._runs(points)
            for name in todo:
                unknowns = self._searches[name].unknowns
                value = self._value(unknowns, points[name], left[name])
                value = value - mixture_density(points[name], proposals[name])
                if name not in weighed or effective_draws(value) >= effective_draws(
                    weighed[name][1]
                ):
                    weighed[name] = points[name], value, left[name]
        return {
            name: self._family(name, rough[name], weighed.get(name), proposals)
            for name in self._searches
        }

    def _places(self, one: _Search) -> list[int]:
        modes = self._best(one)
        return [int(np.argmin(np.abs(one.at - mode).sum(axis=1))) for mode in modes]

    def _laplace(self, one: _Search) -> float:
        """Return the logarithm of the evidence by Laplace's approximation."""
        k, p = int(np.argmax(one.value)), one.at.shape[1]
        if not math.isfinite(one.value[k]) or not p:
            return float(one.value[k])
        volume = (
            np.sum(np.log(one.unknowns.deviation)) - 0.5 * np.linalg.slogdet(one.curvature[k])[1]
        )
        return float(one.value[k] + 0.5 * p * math.log(2.0 * math.pi) + volume)

    def _proposed(self, proposals: "Sequence[_Proposal]") -> Array:
        """Return draws from proposals (k, p), as many from each."""
        result = []
        counts = allotted(np.ones(len(proposals)), self.problem.proposed)
        for (centre, root), count in zip(proposals, counts, strict=True):
            result.append(centre + students(self._rng, count, len(centre)) @ root.T)
        return np.concatenate(result)

    def _along(self, name: str, proposals: "Sequence[_Proposal]") -> "list[_Proposal]":
        """Return proposals along the ridge on which draws of some proposals come to lie.

        Each draw takes the shortest steps, in prior deviations, by which its rows meet the measured
        ones; the sets of sizes of what is always there take turns.
        """
        if not self.problem.places:
            return []
        unknowns = self._searches[name].unknowns
        at, result = self._proposed(proposals)[:: self.problem.proposed // self.problem.places], []
        for last in (False, False, True):
            k, p = at.shape
            nudged = at[:, None, :] + np.diag(1e-3 * unknowns.deviation)[None]
            left = self._runs({name: np.concatenate([at, nudged.reshape(at.size, p)])})[name]
            moved, left = left[:, k:].reshape(-1, k, p), left[:, :k]
            works = np.flatnonzero(np.isfinite(left).all(axis=0))
            for i in works:
                slopes = (left[:, i, None] - moved[:, i]) / 1e-3
                slopes = np.where(np.isfinite(slopes), slopes, 0.0)
                which = int(i) % len(self._inverses)
                gradient, curvature = self._newton(unknowns, at[i], left[:, i], slopes, which)
                if last:
                    # a ridge bends within the spread of the posterior that is linearised
                    result.append((at[i], 0.6 * _root(curvature, unknowns.deviation)))
                    continue
                away = (at[i] - unknowns.mean) / unknowns.deviation
                step = np.linalg.solve(curvature, gradient + away)
                step *= min(1.0, 2.0 / max(float(np.abs(step).max()), 1e-300))
                at[i] = at[i] + step * unknowns.deviation
            at = at[works]
        return result

    @staticmethod
    def _closer(points: Array, value: Array, proposals: "Sequence[_Proposal]") -> "list[_Proposal]":
        """Return proposals with one about the weighed draws beside the former ones."""
        w = tempered(value, 0.1 * len(value))
        centre = w @ points
        off = points - centre
        spread = (off.T * w) @ off
        spread += 1e-6 * np.diag(np.diag(spread)) + 1e-12 * np.eye(len(centre))
        return [*proposals[:2], (centre, np.asarray(np.linalg.cholesky(spread), dtype=float))]

    def _family(
        self,
        name: str,
        laplace: float,
        weighed: tuple[Array, Array, Array] | None,
        proposals: "Mapping[str, Sequence[_Proposal]]",
    ) -> FamilyPosterior:
        one = self._searches[name]
        mode = one.at[int(np.argmax(one.value))]
        if not one.at.shape[1]:
            points = np.zeros((PROPOSED, 0))
            residual = np.repeat(self._runs({name: points[:1]})[name], PROPOSED, axis=1)
            evidence, effective = laplace, float(PROPOSED)
        elif weighed is None:
            evidence, effective = laplace, 0.0
            points = mode[None] if name not in proposals else np.concatenate(
                [mode[None], self._proposed(proposals[name])[:: 10]]
            )  # fmt: skip
            residual = self._runs({name: points})[name]
            finite = np.isfinite(residual).all(axis=0)
            points, residual = points[finite], residual[:, finite]
        else:
            drawn, value, left = weighed
            evidence = float(logsumexp(value) - math.log(len(value)))
            effective = effective_draws(value)
            order = np.argsort(drawn[:, 0], kind="stable")
            counts = allotted(np.exp(value - value.max())[order], PROPOSED)
            kept = np.repeat(order, counts)
            points, residual = drawn[kept], left[:, kept]
        coefficients, sets = self._coefficients(residual)
        rows = self.problem.measured[:, None] - residual
        rows = rows + self.problem.always.columns @ coefficients.T
        own = self._runs({name: mode[None]})[name][:, 0]
        works = bool(np.isfinite(own).all())
        usual = self._usual(own) if works else np.zeros(len(self._zw))
        left = own - self.problem.always.columns @ usual
        rms = float(np.sqrt(np.mean(self.problem.weights * left**2))) if works else math.inf
        return FamilyPosterior(
            unknowns=one.unknowns,
            mode=mode,
            evidence=evidence,
            effective=effective,
            points=points,
            coefficients=coefficients,
            sets=sets,
            usual=usual,
            band=np.quantile(rows, (0.025, 0.5, 0.975), axis=1) if works else np.zeros((3, 0)),
            rms=rms,
        )

    def _coefficients(self, left: Array) -> tuple[Array, NDArray[np.intp]]:
        """Return draws of coefficients of columns (k, q) for residuals (n, k), and their sets."""
        squares = self._squares(left)
        chance = self._likelihoods(squares)
        chance = np.exp(chance - logsumexp(chance, axis=0))
        moment, result = self._zw @ left, np.zeros((left.shape[1], len(self._zw)))
        which = (self._rng.random(left.shape[1]) > np.cumsum(chance, axis=0)[:-1]).sum(axis=0)
        for j, inverse in enumerate(self._inverses):
            at = np.flatnonzero(which == j)
            spread = np.sqrt(squares[j, at] / self.counted)
            noise = self._rng.normal(size=(len(at), len(inverse)))
            noise = noise @ np.linalg.cholesky(inverse).T
            result[at] = (inverse @ moment[:, at]).T + spread[:, None] * noise
        return result, which


_Proposal: TypeAlias = tuple[Array, Array]


def effective_size(residual: Array) -> float:
    """Return the number of independent residuals that vary as these (n,) do.

    From the autocorrelation up to its first zero, in the record's order.
    """
    r = residual - residual.mean()
    n = len(r)
    spectrum = np.fft.rfft(r, 2 * n)
    correlation = np.fft.irfft(np.abs(spectrum) ** 2)[:n]
    if correlation[0] <= 0.0:
        return float(n)
    correlation = correlation / correlation[0]
    below = np.flatnonzero(correlation <= 0.0)
    last = int(below[0]) if below.size else n
    return float(n / max(1.0 + 2.0 * correlation[1:last].sum(), 1.0))


def _root(curvature: Array, deviation: Array) -> Array:
    """Return the lower root (p, p) of the covariance of proposals about a mode.

    Over prior deviations no curvature is below 1, but for rounding where another is large.
    """
    size, axes = np.linalg.eigh(curvature)
    _, upper = np.linalg.qr((axes / np.sqrt(np.maximum(size, 1.0))).T)
    root = upper.T
    return np.asarray(deviation[:, None] * root * np.sign(np.diag(root)), dtype=np.float64)


def effective_draws(logarithms: Array) -> float:
    """Return the effective number of draws with logarithms of weights (k,)."""
    if not np.isfinite(logarithms).any():
        return 0.0
    return float(np.exp(2.0 * logsumexp(logarithms) - logsumexp(2.0 * logarithms)))


def tempered(logarithms: Array, least: float) -> Array:
    """Return weights (k,), in sum 1, to a power at which more draws than `least` are effective."""
    best = float(np.max(logarithms))
    if not math.isfinite(best):
        return np.full(len(logarithms), 1.0 / len(logarithms))
    powers = 1.0, 0.7, 0.5, 0.35, 0.25, 0.15, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001
    power = next((x for x in powers if effective_draws(x * logarithms) > least), powers[-1])
    w = np.exp(power * (logarithms - best))
    return np.asarray(w / w.sum())


def students(rng: np.random.Generator, count: int, size: int) -> Array:
    """Return draws (count, size) of Student's t of `TAILS` degrees of freedom."""
    normal = rng.normal(size=(count, size))
    return np.asarray(normal * np.sqrt(TAILS / rng.chisquare(TAILS, size=(count, 1))))


def mixture_density(points: Array, proposals: Sequence[_Proposal]) -> Array:
    """Return the logarithm of the density (k,) of a mixture of Student's t at points (k, p)."""
    p = points.shape[1]
    norm = gammaln(0.5 * (TAILS + p)) - gammaln(0.5 * TAILS) - 0.5 * p * math.log(TAILS * math.pi)
    result = []
    for centre, root in proposals:
        z = np.linalg.solve(root, (points - centre).T)
        volume = np.log(np.abs(np.diag(root))).sum()
        squared = np.sum(z**2, axis=0)
        result.append(norm - volume - 0.5 * (TAILS + p) * np.log1p(squared / TAILS))
    return np.asarray(logsumexp(result, axis=0) - math.log(len(proposals)))
