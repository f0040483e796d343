r"""Travels: laws fitted, weighed and drawn; the travel at a setting over all laws.

1. *Fits*: every law in every shape (`travel_laws`), and the measured curve over the setting,
   :math:`T = T(c) (1 + a + b u + w(u))` with :math:`T(c)` of the best law, :math:`u` the logarithm
   of the setting and :math:`w` an integrated Wiener process: a smooth factor that opens where
   nothing was measured.
2. *Nuisances*: uncertain parameters of the mechanism, and an offset of the reading, move travels
   linearly, :math:`T = T(c) + D \delta` with :math:`\delta \sim N(0, 1)`.
3. *Noise*: stated errors of the readings, at least the scatter of repeats, and beside them an
   unstated part, alike for all or in proportion to the travel, of which the evidence of all
   structures together is largest.
4. *Evidence* of a structure is its likelihood, with Student's t for each setting, integrated over
   coefficients and nuisances by Laplace's method; held-out errors of a setting follow from the
   same linear problem without its rows. Repeats of a setting have less noise together, and are one
   piece of evidence on a law, as what a law lacks there is the same in all (`setting_scores`).
   For Dirichlet weights :math:`d` of the settings (Bayesian bootstrap) a structure has the stacking
   weight :math:`\mathrm{softmax}_S(-\tfrac{m}{2} \sum_b d_b R_b(S) + \log \pi_S)`, of which the
   mean over the draws is its *share* (pseudo-BMA+ [YV]_).
5. *Ensemble*: coefficients and nuisances are drawn from Student's t about each fit, *simulated* at
   the measured settings, and drawn again by their likelihood there; so the linear problem is a
   proposal, not a result. Where few of them count, the leading coefficient of each is led to
   travels about the readings, and its density is that with which it was led there. A band is the
   quantiles of their travels at a setting.
6. *Discrepancy*: what a body does that carries its drive jumps where it changes from one motion to
   another, so no smooth factor stands for what all laws lack. Instead mean velocities have an error
   of variance :math:`\tau^2` beside what the readings and the coefficients make of them, if the
   law holds. Held-out errors of settings tell it (`unexplained_error`).

.. [YV] Y. Yao, A. Vehtari, D. Simpson and A. Gelman, "Using stacking to average Bayesian
   predictive distributions", Bayesian Analysis 13 (2018) 917-1007.
.. [PM] R. C. Paule and J. Mandel, "Consensus values and weighting factors", Journal of Research of
   the National Bureau of Standards 87 (1982) 377-385.
.. [QP] W. Viechtbauer, "Confidence intervals for the amount of heterogeneity in meta-analysis",
   Statistics in Medicine 26 (2007) 37-52.
"""

import contextlib
import math
from collections.abc import Callable, Collection, Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtri, logsumexp, ndtri, softmax, stdtrit

from stickslip.data import whole_cycles
from stickslip.errors import ConvergenceError, InputError, StickslipError
from stickslip.friction import DirectionDependent, FrictionLaw, law_type, listed
from stickslip.identify.bands import ALIKE, Array, PredictionBand, quantile_band
from stickslip.identify.fits import (
    READINGS,
    TravelModel,
    Trial,
    durations,
    span_of,
    standard_errors,
    starting_law,
    under_cycles,
)
from stickslip.identify.judgement import RIVAL
from stickslip.identify.posterior import allotted
from stickslip.identify.problems.travel_laws import (
    HOLDING,
    RESOLVED,
    STEP,
    Size,
    TravelLaw,
    TravelStructure,
    moving_back,
)
from stickslip.identify.simulated import (
    SETTLED,
    UNTOLD,
    effective_draws,
    mixture_density,
    students,
    tempered,
)
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.mechanisms import Mechanism
from stickslip.quantities import fields_of, parameters, vary
from stickslip.show.formatting import joined, number, quantity

USUAL_LAWS = (
    "coulomb", "viscous", "coulomb-viscous", "stribeck", "power-viscous", "dahl", "lugre",
    "quadratic-drag", "direction-dependent",
)  # fmt: skip
"""Laws that are compared where none are named, from usual to unusual."""
KNOBS = ("mechanism.compression", "mechanism.drive.level", "mechanism.drive.amplitude")
"""Parameters that an experimenter can turn, in the order of ease."""
OFFSET = 0.5
"""Prior spread of an offset of all readings, over the error of one."""
BENDING = (0.01, 0.03, 0.1, 0.3)
"""Spreads of the curve's factor, of its power of the setting, and of the change of that over a
factor of e in the setting."""
KNOTS, REACH = 31, 1.0
"""Places at which the curve may bend, and how far beyond the settings, in logarithms."""
FEWEST = 4
"""Readings of one setting from which their scatter counts."""
STILL = 0.01
"""Travel over the measured one up to which a law holds the body."""
STATED = 0.7
"""Probability that readings err as stated, beforehand."""
PARTS = (0.5, 60.0, 12)
"""Unstated errors over the stated ones: least, largest, and how many are tried."""
PROPOSED = 2
"""Draws that are simulated for each that is kept ..."""
SLOW = 8
"""... but no more of a law with bristles, whose runs take long."""
NEWTON = 4
"""Steps by which leading coefficients are made to meet the readings, where few draws count."""
COUNTING, TRIED = 5.0, 50
"""Effective number of draws of a family at least, where there are this many."""
LEAST = float(np.finfo(float).eps)
"""Stands for the share of a law that has none beside the others."""
INSENSITIVE = "the trials hardly depend on it"
"""Why an estimate has no interval."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Linear:
    """A structure as a linear problem: travels over coefficients and nuisances."""

    name: str
    """Family: the name of the law, empty for the measured curve."""
    structure: TravelStructure
    predicted: Array
    """Travels (n,) at `centre`."""
    columns: Array
    """Derivatives (n, q), those of nuisances last."""
    centre: Array
    """Where the problem was made (q,)."""
    means: Array
    precisions: Array
    """Of the prior (q,)."""
    prior: float
    """Logarithm of the prior probability within the family."""
    bending: float = 0.0
    """Of the curve."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Solved:
    """A linear problem solved for some errors of the readings."""

    linear: Linear
    values: Array
    """Coefficients and nuisances (q,)."""
    root: Array
    """Root (q, q) of their covariance."""
    left: Array
    """Standardised residuals (n,)."""
    evidence: float
    """Logarithm of the integrated likelihood and of the prior within the family."""
    freedom: float
    """Readings less what they determine."""
    held_out: Array
    """Residuals (n,) without the readings of the same setting [m]."""
    spreads: Sequence[Array]
    """Covariances (k, k) by setting of these if the structure holds, over errors of the reading."""
    losses: Array
    """Mean squares of these, standardised, by setting (b,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class TravelDraws:
    """Draws of a law, or of the curve about it."""

    law: TravelLaw
    unknowns: Array
    """Unknowns (d, p)."""
    nuisances: Array
    """Nuisances (d, k)."""
    off: Array | None = None
    """Of the curve, how far coefficients of its law are from these (d, c)."""
    smooth: Array | None = None
    """Of the curve, the coefficients of its factor (d, q)."""


@dataclass(eq=False)
class TravelJudgement:
    """Travels, judged."""

    mechanism: Mechanism
    trials: Sequence[Trial]
    t_end: float
    laws: Sequence[TravelLaw]
    size: Size
    order: Sequence[str]
    """Names of the laws, the usual ones first."""
    dropped: Mapping[str, tuple[FrictionLaw, str]] = field(default_factory=dict)
    """Laws that are left out, and why, by name."""
    seed: int = 0

    def __post_init__(self) -> None:
        self.measured = np.array([trial.travel for trial in self.trials])
        self.readings, self.stated = standard_errors(self.trials)
        least = 0.0 if self.stated else RESOLVED * float(np.mean(np.abs(self.measured)))
        self.readings = np.maximum(self.readings, least)
        self.blocks = _settings(self.trials)
        self.counts = np.bincount(self.blocks)
        self._weighed: dict[tuple[str, int], tuple[TravelDraws, Array]] = {}
        self._drawn: dict[bytes, tuple[Array, Array]] = {}
        self._best_runs: dict[str, tuple[Array, Array]] = {}

    # ------------------------------------------------------------------ settings
    @cached_property
    def knob(self) -> tuple[str, float] | None:
        """What is set to get other travels: its path, and its value as the rig stands."""
        return knob_of(self.mechanism, self.trials)

    @cached_property
    def settings(self) -> Array:
        """Values of the knob (n,) in the trials; empty without one."""
        return np.array(_set(self.trials, self.knob[0])) if self.knob else np.zeros(0)

    @cached_property
    def one_way(self) -> bool:
        """Whether settings differ by the knob alone, and are enough for a curve."""
        if self.knob is None or len({trial.cycles for trial in self.trials}) > 1:
            return False
        same = {vary(t.mechanism, "mechanism", {self.knob[0]: self.knob[1]}) for t in self.trials}
        told = len(np.unique(self.settings)) >= THRESHOLDS.fewest and bool(np.all(self.settings))
        return len(same) == 1 and told

    def at(self, settings: Array) -> list[Trial]:
        """Return trials at settings of the knob (m,) that are not measured."""
        if self.knob is None:
            raise InputError(
                "the trials differ in more than one parameter of the mechanism, and it has none"
                " that is usually set: there is no band over a setting."
            )
        path = self.knob[0]
        first = next((one for one in self.trials if not one.averaged), self.trials[0])
        rigs = [vary(self.mechanism, "mechanism", {path: float(x)}) for x in settings]
        return [
            replace(first, mechanism=rig,
                    cycles=None if first.cycles is None else whole_cycles(rig, self.t_end))
            for rig in rigs
        ]  # fmt: skip

    # ------------------------------------------------------------------ linear problems
    @cached_property
    def _doubts(self) -> tuple[list[str], Array]:
        """Paths of uncertain parameters that trials share, and what is set anew, as variances."""
        law = min(
            (structure for law in self.laws for structure in law.structures),
            key=lambda item: float(np.sum(((self.measured - item.predicted) / self.readings) ** 2)),
        )
        self._reference, self._base = law.law.with_unknowns(law.unknowns), law.predicted
        values = law.law.values(law.unknowns[None])[0].tolist()
        trials = [law.law.model.set_up(trial, values) for trial in self.trials]
        alone, shared = propagated(TravelModel(self._reference, (), self.t_end), trials)
        self._columns = np.array([*shared.values()]).reshape(-1, len(self.trials)).T
        self._alone = alone
        own = sum((part**2 for part in alone.values()), np.zeros(len(self.trials)))
        return [*shared], own

    @cached_property
    def nuisances_count(self) -> int:
        """Number of nuisances: parameters that trials share, and an offset."""
        return len(self._doubts[0]) + 1

    def nuisances(self, trials: Sequence[Trial]) -> Array:
        """Return what nuisances of spread 1 move the travels of trials (m, k) [m]."""
        paths, _ = self._doubts
        model = TravelModel(self._reference, (), self.t_end)
        _, shared = propagated(model, trials) if paths else ({}, {})
        columns = [shared[path] for path in paths]
        # an offset is of the readings, and not of the travels
        return np.array([*columns, np.zeros(len(trials))]).T

    @cached_property
    def linears(self) -> list[Linear]:
        """All laws in all shapes, and the curve, as linear problems."""
        paths, _ = self._doubts
        offset = OFFSET * np.full(len(self.trials), float(np.median(self.readings)))
        extra = np.column_stack([self._columns, offset]) if paths else offset[:, None]
        result, zeros = [], np.zeros(extra.shape[1])
        for law in self.laws:
            refined = any(structure.count > law.count for structure in law.structures)
            for item in law.structures:
                alike = sum(other.count == item.count for other in law.structures)
                result.append(Linear(
                    name=law.name, structure=item, predicted=item.predicted,
                    columns=np.hstack([item.slopes, extra]),
                    centre=np.concatenate([item.unknowns[: item.count], zeros]),
                    means=np.concatenate([item.means, zeros]),
                    precisions=np.concatenate([item.precisions, zeros + 1.0]),
                    prior=-math.log(alike * (1 + refined)),
                ))  # fmt: skip
        return result

    def _curves(self, best: Linear) -> list[Linear]:
        """Return the measured curve about a law, with several spreads of its factor."""
        base = best.predicted
        if not self.one_way or np.abs(base).min() < 0.02 * np.abs(base).max():
            return []
        result = []
        for bending in BENDING:
            columns = bending * base[:, None] * self._smooth(self.settings)
            columns = np.hstack([best.columns, columns])
            more = np.zeros(columns.shape[1] - len(best.centre))
            result.append(replace(
                best, name="", columns=columns, centre=np.concatenate([best.centre, more]),
                means=np.concatenate([best.means, more]), bending=bending,
                precisions=np.concatenate([best.precisions, more + 1.0]),
                prior=-math.log(len(BENDING)),
            ))  # fmt: skip
        return result

    def _smooth(self, settings: Array) -> Array:
        """Return the columns (m, q) of a curve's factor, with coefficients of spread 1."""
        known = np.log(np.abs(self.settings))
        low, high = float(known.min()), float(known.max())
        middle, knots = 0.5 * (low + high), np.linspace(low - REACH, high + REACH, KNOTS)
        u, side = np.log(np.abs(settings))[:, None] - middle, np.sign(knots - middle)
        step = math.sqrt(float(knots[1] - knots[0]))
        bends = step * np.maximum(side * (u - (knots - middle)), 0.0)
        return np.hstack([np.ones_like(u), u, bends])

    # ------------------------------------------------------------------ noise and evidence
    @cached_property
    def errors(self) -> Array:
        """Standard errors of the readings (n,) [m]: as stated, or larger where nothing fits."""
        base = self.least_errors
        size = float(np.median(base))
        low, high, count = PARTS
        largest = max(high * size, 0.2 * float(np.abs(self.measured).max()))
        parts = np.geomspace(low * size, largest, count)
        rough = self._solve_all(base, self.linears)
        best = max(rough, key=lambda item: item.evidence - self.price(item.linear.name))
        self.linears.extend(self._curves(best.linear))
        relative = np.abs(self.measured) / max(float(np.abs(self.measured).mean()), 1e-300)
        tried = [(math.log(STATED if self.stated else 1.0 / (2 * count)), base)]
        tried += [
            (math.log((1.0 - STATED if self.stated else 1.0) / (2 * count)),
             np.hypot(base, part * growth))
            for part in parts for growth in (np.ones(len(base)), relative)
        ]  # fmt: skip
        if len(self.trials) == 1:
            return base
        sums = [
            prior + float(logsumexp([item.evidence for item in self._solve_all(x, self.linears)]))
            for prior, x in tried
        ]
        return tried[int(np.argmax(sums))][1]

    @cached_property
    def least_errors(self) -> Array:
        """Errors of the readings (n,) [m] that are stated, and that repeats and settings have."""
        _, alone = self._doubts
        return np.asarray(np.sqrt(self.readings**2 + self._repeats() ** 2 + alone))

    @cached_property
    def misfit(self) -> bool:
        """Whether travels are far from every law, for what is stated and repeats scatter by."""
        ratio = float(np.median(self.errors / self.least_errors))
        return self.stated and ratio > THRESHOLDS.misfit

    @cached_property
    def assumed(self) -> bool:
        """Whether the errors of the readings were found, and not stated."""
        known = np.sqrt(self.readings**2 + self._doubts[1])
        return not self.stated or bool(np.any(self.errors > 1.001 * known))

    def _repeats(self) -> Array:
        """Return what repeats scatter by beside the readings' errors, as the travel (n,) [m].

        They are compared over the travels of a law: numbers of one setting are about the same, and
        travels differ by what these do.
        """
        if len(self.trials) - len(self.counts) < FEWEST - 1:
            return np.zeros(len(self.measured))
        base = np.where(self._base == 0.0, 1.0, self._base)
        mean = (np.bincount(self.blocks, self.measured / base) / self.counts)[self.blocks] * base
        free = 1.0 - 1.0 / self.counts[self.blocks]
        excess = float(np.sum((self.measured - mean) ** 2 - free * self.readings**2))
        least = max(float(free @ mean**2), 1e-300)
        return np.asarray(math.sqrt(max(excess, 0.0) / least) * np.abs(mean))

    def _solve_all(self, errors: Array, linears: Sequence[Linear]) -> list[Solved]:
        shared = self._shared(errors)
        result = [_solved(linear, self.measured, errors, shared) for linear in linears]
        return [item for item in result if math.isfinite(item.evidence)]

    def _shared(self, errors: Array) -> Array:
        """Return what an error of the mean velocity makes of residuals, by setting (b, n)."""
        of = np.arange(len(self.counts))[:, None] == self.blocks
        rows = np.where(of, durations(self.trials, self.t_end) / errors, 0.0)
        return np.asarray(rows / np.linalg.norm(rows, axis=1, keepdims=True))

    @cached_property
    def solved(self) -> list[Solved]:
        """All structures with the errors that the readings have, those of laws first."""
        errors = self.errors
        return self._solve_all(errors, self.linears)

    @cached_property
    def families(self) -> list[str]:
        """Names of the laws that are fitted, and the curve's, which is empty."""
        return list(dict.fromkeys(item.linear.name for item in self.solved))

    def price(self, name: str) -> float:
        """Return what a law costs for being unusual; the curve, nothing."""
        known = self.order.index(name) if name in self.order else len(self.order)
        return THRESHOLDS.unusual * known if name else 0.0

    @cached_property
    def _alike(self) -> bool:
        """Whether all trials repeat one setting: then every law can have that travel."""
        return len(self.counts) < 2

    @cached_property
    def evidence(self) -> dict[str, float]:
        """Evidence of the laws, without the curve's, the most first."""
        result = {name: -self.price(name) for name in self.families if name}
        if not self._alike:
            for name in result:
                parts = [s.evidence for s in self.solved if s.linear.name == name]
                result[name] += float(logsumexp(parts))
        return dict(sorted(result.items(), key=lambda item: -item[1]))

    @cached_property
    def named(self) -> str:
        """Name of the law with the most evidence."""
        return next(iter(self.evidence))

    @cached_property
    def set(self) -> list[str]:
        """Laws that cannot be distinguished, the named one first."""
        least = self.evidence[self.named] - math.log(RIVAL)
        return [name for name, value in self.evidence.items() if value >= least]

    @cached_property
    def scores(self) -> Array:
        """Scores (s, b) of all structures by setting."""
        return np.array([block_scores(item.losses) for item in self.solved])

    @cached_property
    def raw_shares(self) -> Array:
        """Shares of structures (s,) before the curve gets its least."""
        log = np.array([item.evidence - self.price(item.linear.name) for item in self.solved])
        if self._alike:
            return np.asarray(softmax([s.linear.prior - self.price(s.linear.name)
                                       for s in self.solved]))  # fmt: skip
        priors = np.exp([item.linear.prior for item in self.solved])
        shares = stacked_shares(self.scores, priors)
        return np.asarray(softmax(0.5 * (np.log(shares + LEAST) + log)))

    @cached_property
    def shares(self) -> dict[str, float]:
        """Shares of the laws and of the curve in the ensemble, in sum 1."""
        laws = np.array([bool(item.linear.name) for item in self.solved])
        order = np.argsort(self.scores.mean(axis=1), kind="stable")
        result, raw = np.empty(len(order)), self.raw_shares[order]
        result[order] = raw if laws.all() else with_curve(raw, laws[order])
        return {
            name: float(sum(p for p, item in zip(result, self.solved, strict=True)
                            if item.linear.name == name))
            for name in self.families
        }  # fmt: skip

    def best_of(self, name: str) -> Solved:
        """Return the structure of a family with the most evidence.

        Of a law whose leading coefficient was given, among values that leave the same up to one
        standard error, it is the one near that.
        """
        own = [item for item in self.solved if item.linear.name == name]
        given = own[0].linear.structure.law.means[0] if name else 0.0
        if not given:
            return max(own, key=lambda item: item.evidence)
        costs = [float(item.left @ item.left) for item in own]
        alike = [item for item, cost in zip(own, costs, strict=True) if cost <= min(costs) + 1.0]
        return min(
            alike,
            key=lambda item: (round(abs(math.log(abs(item.values[0] / given) + LEAST)), 1),
                             -item.evidence),
        )  # fmt: skip

    @cached_property
    def explained(self) -> bool:
        """Whether a law meets the readings, and predicts as well as the measured curve."""
        if self.misfit:
            return False
        if "" not in self.families:
            return True
        rows = [self.scores[i].mean() for i, s in enumerate(self.solved) if s.linear.name]
        top = [s for s in self.solved if s.linear.name][int(np.argmin(rows))]
        curve = min((s for s in self.solved if not s.linear.name), key=lambda s: s.losses.mean())
        gap = block_scores(top.losses) - block_scores(curve.losses)
        gain = float(gap.mean() / (gap.std(ddof=1) / math.sqrt(len(gap)) + 1e-9))
        ratio = math.sqrt(float(top.losses.mean() / max(curve.losses.mean(), 1e-300)))
        curves = np.array([not s.linear.name for s in self.solved])
        better = gain > THRESHOLDS.errors and ratio > THRESHOLDS.no_law_ratio
        left = min(float(np.mean(s.left**2)) for s in self.solved if s.linear.name)
        far = self.stated and math.sqrt(left) > THRESHOLDS.misfit
        # where few readings tell many parameters, a setting held out is missed by the true law, too
        chances = np.asarray(softmax([s.evidence for s in self.solved]))
        judged, likely = (float(x[curves].sum()) > THRESHOLDS.no_law
                          for x in (self.raw_shares, chances))  # fmt: skip
        return not (judged and (far or (better and likely)))

    def law_of(self, name: str) -> TravelLaw:
        """Return a law by name."""
        return next(law for law in self.laws if law.name == name)

    def unknowns_of(self, name: str) -> Array:
        """Return unknowns (p,) of a law with which its simulated travels meet the readings best."""
        return self._best_run(name)[0]

    def predicted(self, name: str) -> Array:
        """Return the travels (n,) [m] of the best unknowns of a law, of the curve its own."""
        if name:
            return self._best_run(name)[1]
        return np.asarray(self.measured - self.best_of(name).left * self.errors)

    def _best_run(self, name: str) -> tuple[Array, Array]:
        """Return unknowns (p,) and travels (n,): of the linear problem, or where it was made."""
        if name in self._best_runs:
            return self._best_runs[name]
        best = self.best_of(name)
        start, count = best.linear.structure.unknowns, best.linear.structure.count
        both = np.stack([np.concatenate([best.values[:count], start[count:]]), start])
        travels = self.law_of(name).table(self.trials, both)
        costs = np.sum(((self.measured - travels) / self.errors) ** 2, axis=1)
        at = int(np.argmin(np.where(np.isfinite(costs), costs, np.inf)))
        return self._best_runs.setdefault(name, (both[at], travels[at]))

    def named_travels(self, settings: Array) -> Array:
        """Return the travels (m,) [m] of the named law at settings of the knob."""
        unknowns = self.unknowns_of(self.named)
        return np.asarray(self.law_of(self.named).table(self.at(settings), unknowns[None])[0])

    def held_out(self, name: str) -> float:
        """Return the root mean square [m] of the held-out errors of a family, over settings."""
        squares = self.best_of(name).held_out ** 2
        return math.sqrt(float(np.mean(np.bincount(self.blocks, squares) / self.counts)))

    @cached_property
    def discrepancy(self) -> float:
        """Error of mean velocities beside what the laws tell [m/s], as a scale of Student's t.

        0 of runs that do not end with a cycle, where the measured curve stands for it, and of a
        single setting.
        """
        cyclic = all(trial.cycles is not None for trial in self.trials)
        if "" in self.families or not cyclic or self._alike:
            return 0.0
        best, lasts = self.best_of(self.named), durations(self.trials, self.t_end)
        means = np.bincount(self.blocks, best.held_out / lasts) / self.counts
        known = np.zeros(len(means))
        for block, spread in enumerate(best.spreads):
            own = (self.least_errors / lasts)[self.blocks == block] / self.counts[block]
            known[block] = own @ spread @ own
        return unexplained_error(means, known, best.freedom - len(lasts) + len(means))

    # ------------------------------------------------------------------ ensemble
    @cached_property
    def draws(self) -> list[TravelDraws]:
        """Draws of all families, as many of each as its share asks for."""
        counts = allotted(np.array([self.shares[x] for x in self.families]), THRESHOLDS.draws)
        return [
            self.drawn(name, count)
            for name, count in zip(self.families, counts, strict=True)
            if count
        ]

    def drawn(self, name: str, count: int) -> TravelDraws:
        """Return draws of a family: proposals, drawn again by their likelihood when simulated."""
        rng = np.random.default_rng([self.seed, self.families.index(name)])
        if not name:
            return self._curve_drawn(count, rng)
        own = [item for item in self.solved if item.linear.name == name]
        law = own[0].linear.structure.law
        wanted = PROPOSED * max(count, TRIED)
        if law.law.states or under_cycles(self.trials):
            wanted = TRIED
        if law.slow:
            wanted = min(wanted, max(SLOW, len(own)))
        if (name, wanted) not in self._weighed:  # for any count, and runs take long
            self._weighed[name, wanted] = self._proposals(own, wanted, rng)
        draws, log = self._weighed[name, wanted]
        least = min(COUNTING, 1.0 + COUNTING * count / TRIED)
        weights = tempered(log, min(least, 0.5 * np.isfinite(log).sum()))
        pick = np.searchsorted(np.cumsum(weights), (np.arange(count) + 0.5) / count)
        at = np.minimum(pick, len(log) - 1)
        return TravelDraws(law=law, unknowns=draws.unknowns[at], nuisances=draws.nuisances[at])

    def _proposals(
        self, own: Sequence[Solved], wanted: int, rng: np.random.Generator
    ) -> tuple[TravelDraws, Array]:
        """Return draws about the solutions of a family, and log weights (d,), when simulated."""
        shares = np.asarray(softmax([item.evidence for item in own]))
        law = own[0].linear.structure.law
        rows, priors, densities = [], [], []
        k = self.nuisances_count
        for entry, n in zip(own, allotted(shares, wanted), strict=True):
            if not n:
                continue
            linear = entry.linear
            c = linear.structure.count
            values, density = self._proposed(entry, n, rng)
            shape = np.tile(linear.structure.unknowns[c:], (n, 1))
            rows.append(np.column_stack([values[:, :c], shape, values[:, c : c + k]]))
            prior = -0.5 * (values - linear.means) ** 2 @ linear.precisions + linear.prior
            prior += 0.5 * float(np.sum(np.log(linear.precisions / (2.0 * math.pi))))
            priors.append(prior - math.log(n / wanted))
            densities.append(density)
        points, prior, (density, others) = np.vstack(rows), np.hstack(priors), np.hstack(densities)
        size = len(law.names)
        draws = TravelDraws(law=law, unknowns=points[:, :size], nuisances=points[:, size:])
        c = own[0].linear.structure.count
        moved, freedom = own[0].linear.columns[:, c : c + k], own[0].freedom
        travels = self._simulated(draws, self.trials, moved)
        result = prior - density + self._likelihood(travels, freedom)
        if effective_draws(result) < 0.6 * len(result) / PROPOSED:
            met, travels, leading = self._met(draws, travels, moved, rng)
            again = prior - others - leading + self._likelihood(travels, freedom)
            if effective_draws(again) > effective_draws(result):
                return met, again
        return draws, result

    def _met(
        self, draws: TravelDraws, travels: Array, moved: Array, rng: np.random.Generator
    ) -> tuple[TravelDraws, Array, Array]:
        """Return draws whose leading unknown meets the readings, drawn again by their errors.

        Where coefficients make up for each other far from a fit, few linear proposals do. Slopes
        are those of secants after the first step, and a draw that is there stays. With the draws
        come their travels, and log densities (d,) of the leading unknown given the others: that of
        Student's t along the slope, infinite of draws that do not meet the readings.
        """
        aside = 0.5  # over errors of readings: a draw that is farther off does not meet them
        low, high = (float(x[0]) for x in draws.law.bounds(self.size))
        noise = students(rng, *travels.shape)
        goal = self.measured + self.errors * noise
        unknowns, here = draws.unknowns.copy(), travels.copy()
        live, change = np.arange(len(unknowns)), -1e-3 * np.abs(unknowns[:, 0])  # room above or not
        slope = np.zeros(travels.shape)
        for step in range(NEWTON + 1):
            point = unknowns[live]
            point[:, 0] += change
            part = replace(draws, unknowns=point, nuisances=draws.nuisances[live])
            there = self._simulated(part, self.trials, moved)
            slope[live] = np.nan_to_num((there - here[live]) / change[:, None] / self.errors)
            if step:
                unknowns[live], here[live] = point, there
            left = np.nan_to_num((goal[live] - here[live]) / self.errors)
            size, steep = np.abs(unknowns[live, 0]), slope[live]
            change = np.sum(steep * left, 1) / np.maximum(np.sum(steep**2, 1), 1e-300)
            change = np.clip(change, -0.5 * size, 0.5 * size)
            change = np.clip(unknowns[live, 0] + change, low, high) - unknowns[live, 0]
            far = np.linalg.norm(steep * change[:, None], axis=1) > 0.1 * aside
            live, change = live[far], change[far]
            if not len(live):
                break
        steep = np.linalg.norm(slope, axis=1) + 1e-300
        along, left = (
            np.sum(slope * x, axis=1) / steep for x in (noise, (goal - here) / self.errors)
        )
        density = np.log(steep) + mixture_density(along[:, None], [(np.zeros(1), np.eye(1))])
        # it ended elsewhere, or hardly moves the travels
        density[~(np.abs(left) < aside) | (steep * np.abs(unknowns[:, 0]) < aside)] = math.inf
        return replace(draws, unknowns=unknowns), here, density

    def _curve_drawn(self, count: int, rng: np.random.Generator) -> TravelDraws:
        """Return draws of the curve, whose factor is linear: so it stays beside the law."""
        own = [item for item in self.solved if not item.linear.name]
        shares = np.asarray(softmax([item.evidence for item in own]))
        best = own[0].linear.structure
        size, k = best.count, self.nuisances_count
        rows, smooth = [], []
        for entry, n in zip(own, allotted(shares, count), strict=True):
            size_of = n, len(entry.values)
            drawn = students(rng, *size_of) if self.assumed else rng.normal(size=size_of)
            values = entry.values + drawn @ entry.root
            rows.append(values[:, : size + k])
            smooth.append(values[:, size + k :] * entry.linear.bending)
        points = np.vstack(rows)
        return TravelDraws(
            law=best.law,
            unknowns=np.tile(best.unknowns, (len(points), 1)),
            nuisances=points[:, size:],
            off=points[:, :size] - best.unknowns[:size],
            smooth=np.vstack(smooth),
        )

    def _simulated(self, draws: TravelDraws, trials: Sequence[Trial], moved: Array) -> Array:
        """Return the travels (d, m) [m] of draws in trials; nuisances move them by (m, k)."""
        points, at = np.unique(draws.unknowns, axis=0, return_inverse=True)
        result = draws.law.table(trials, points)[at.ravel()]
        return np.asarray(result + draws.nuisances @ moved.T)

    def _around(self, draws: TravelDraws, trials: Sequence[Trial], settings: Array) -> Array:
        """Return what a curve adds (d, m) [m] to the law about which it is."""
        assert draws.off is not None
        assert draws.smooth is not None
        base, count = draws.unknowns[0], draws.off.shape[1]
        steps = STEP * np.maximum(np.abs(base[:count]), STEP * np.abs(base[0]))
        moved = np.diag(np.r_[steps, np.zeros(len(base) - count)])[:count]
        points = np.vstack([base, base + moved])
        travels = draws.law.table(trials, points)
        slopes = (travels[1:] - travels[0]) / steps[:, None]
        factor = draws.smooth @ self._smooth(settings).T
        return np.asarray(draws.off @ slopes + travels[0] * factor)

    def _proposed(self, one: Solved, count: int, rng: np.random.Generator) -> tuple[Array, Array]:
        """Return draws (d, q) about a solution, within its bounds, and their log densities (2, d).

        The second densities are those of all values but the first.
        """
        values = one.values + students(rng, count, len(one.values)) @ one.root
        law, c = one.linear.structure.law, one.linear.structure.count
        # the fit itself meets the readings, whatever linear proposals do
        values[0, :c], values[0, c:] = one.linear.centre[:c], 0.0
        others = _root((one.root.T @ one.root)[1:, 1:])
        density = mixture_density(values, [(one.values, one.root.T)])
        rest = mixture_density(values[:, 1:], [(one.values[1:], others.T)])
        low, high = law.bounds(self.size)
        inside = values[:, :c]
        # reflected at what is least: it stays a draw, of about the same density
        inside = np.where(inside < low[:c], 2.0 * low[:c] - inside, inside)
        values[:, :c] = np.clip(inside, low[:c], high[:c])
        return values, np.array([density, rest])

    def _likelihood(self, travels: Array, freedom: float) -> Array:
        """Return log likelihoods (d,) of simulated travels (d, n)."""
        left = (self.measured - travels) / self.errors
        if self.assumed:  # the scale is not known either
            nu = max(freedom, 1.0)
            result = -0.5 * (nu + left.shape[1]) * np.log1p(np.sum(left**2, 1) / nu)
        else:
            result = -0.5 * setting_scores(left, self._shared(self.errors))
        return np.where(np.isfinite(result), result, -np.inf)

    def travels(self, settings: Array) -> Array:
        """Return the travels (d, m) [m] at settings (m,) of the knob: of draws, and their error."""
        every = self.drawn_travels(settings)
        # a draw is off alike at all settings: so limits are no rougher than the laws
        places = np.random.default_rng([self.seed, 1]).permutation(len(every))
        off = self.discrepancy * stdtrit(THRESHOLDS.freedom, (places + 0.5) / len(every))
        return np.asarray(every + np.outer(off, durations(self.at(settings), self.t_end)))

    def drawn_travels(self, settings: Array) -> Array:
        """Return the travels (d, m) [m] at settings (m,) of the knob by draws of laws."""
        return self._drawn_at(settings)[0]

    def drawn_readings(self, settings: Array) -> Array:
        """Return these as they would be read (d, m) [m]: all with the offset of their draw."""
        travels, offsets = self._drawn_at(settings)
        return travels + OFFSET * float(np.median(self.readings)) * offsets[:, None]

    def _drawn_at(self, settings: Array) -> tuple[Array, Array]:
        asked = np.asarray(settings, dtype=float).tobytes()
        if asked not in self._drawn:  # a band and what narrows it are of the same runs
            trials = self.at(settings)
            moved = self.nuisances(trials)
            result = []
            for draw in self.draws:
                result.append(self._simulated(draw, trials, moved))
                if draw.smooth is not None:
                    result[-1] += self._around(draw, trials, settings)
            every = np.vstack(result)
            works = np.isfinite(every).all(axis=1)
            offsets = np.concatenate([draw.nuisances[:, -1] for draw in self.draws])
            self._drawn[asked] = every[works], offsets[works]
        return self._drawn[asked]

    def noise(self, settings: Array) -> Array:
        """Return the standard errors of new readings at settings (m,): as the nearest have."""
        off = np.abs(np.asarray(settings)[:, None] - self.settings)
        # what readings scatter by beyond that is in the travels where laws have a discrepancy
        errors = self.least_errors if self.discrepancy else self.errors
        return np.asarray(errors[np.argmin(off, axis=1)])

    def laws_of(self, draws: TravelDraws) -> list[FrictionLaw]:
        """Return the laws that draws are."""
        return [draws.law.with_unknowns(x) for x in draws.unknowns]

    @cached_property
    def named_draws(self) -> dict[str, TravelDraws]:
        """Draws of each law that has a share or is named, by name."""
        result = {draw.law.name: draw for draw in self.draws if draw.smooth is None}
        result[self.named] = self.drawn(self.named, THRESHOLDS.draws)
        return result

    def draws_of(self, name: str) -> TravelDraws:
        """Return draws of a law: those of the band, or as many as intervals ask for."""
        return self.named_draws.get(name) or self.drawn(name, THRESHOLDS.draws // 4)

    def effective(self, name: str) -> float:
        """Return how many of the draws of a law count, by their likelihoods when simulated."""
        self.draws_of(name)
        return max(
            effective_draws(log) for (of, _), (_, log) in self._weighed.items() if of == name
        )

    def values(self, name: str) -> dict[str, Array]:
        """Return the parameters of the draws of a law (d,) by path."""
        draws = self.draws_of(name)
        return dict(zip(draws.law.model.free, draws.law.values(draws.unknowns).T, strict=True))

    def sources(self, name: str) -> list[dict[str, float]]:
        """Return the standard errors of the coefficients of a law by where they come from.

        Empty where no uncertainty of the mechanism was stated.
        """
        paths, _ = self._doubts
        if not paths and not self._alone:
            return []
        one = self.best_of(name).linear
        count = one.structure.count
        own = one.columns[:, :count] / self.errors[:, None]
        known = own.T @ own + np.diag(one.precisions[:count])
        gain = np.linalg.solve(known, own.T) / self.errors
        scatter = np.sqrt(np.maximum(self.errors**2 - self._doubts[1], self.readings**2))
        parts = {READINGS: np.linalg.norm(gain * scatter, axis=1)}
        parts |= {path: np.linalg.norm(gain * x, axis=1) for path, x in self._alone.items()}
        for path, column in zip(paths, self._columns.T, strict=True):
            parts[path] = np.hypot(parts.get(path, 0.0), np.abs(gain @ column))
        return [{path: float(x[i]) for path, x in parts.items()} for i in range(count)]

    def around_zero(self, name: str) -> Collection[str]:
        """Return paths of coefficients of a law that may be 0: draws are cut off there.

        What lies above another coefficient is not 0 where it lies no higher.
        """
        one = self.best_of(name)
        law = one.linear.structure.law
        spread = np.sqrt(np.sum(one.root**2, axis=0))[: law.count]
        inside = one.values[: law.count] < 2.0 * spread
        alone = np.count_nonzero(law.matrix, axis=1) == 1
        return [
            path
            for path, near, plain in zip(law.model.free, inside, alone, strict=False)
            if near and plain
        ]

    def untold(self, name: str) -> Collection[str]:
        """Return paths of parameters of a law that travels hardly depend on.

        Shapes are not told where draws of them scatter as those that were tried do.
        """
        one = self.best_of(name)
        law = one.linear.structure.law
        spread = np.sqrt(np.sum(one.root**2, axis=0))[: law.count]
        share = [*(spread * one.linear.precisions[: law.count] ** 0.5)]
        for i, path in enumerate(law.model.free[law.count :]):
            tried = np.std(np.log(law.tried[:, i]))
            share.append(np.std(np.log(self.values(name)[path])) / tried if tried else math.inf)
        return [path for path, x in zip(law.model.free, share, strict=True) if x > UNTOLD]


def knob_of(mechanism: Mechanism, trials: Sequence[Trial]) -> tuple[str, float] | None:
    """Return what is set to get other travels, with its value; None without any.

    What the trials vary, if that is one parameter, can be set, and has the value of a trial where
    it is 0 as the rig stands and in no trial; else it is the one that is easiest to turn.

    Examples
    --------
    >>> from stickslip import SpringBlock
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0)
    >>> trials = [
    ...     Trial(mechanism=replace(rig, compression=x), initial={}, travel=x, half_width=1e-3)
    ...     for x in (0.1, 0.2)
    ... ]
    >>> knob_of(rig, trials)
    ('mechanism.compression', 0.2)
    """
    known = {path: value for path, _, value in parameters(mechanism, "mechanism")}
    varied = [path for path in known if len({*_set(trials, path)}) > 1]
    if len(varied) == 1 and not known[varied[0]] and all(_set(trials, varied[0])):
        return varied[0], max(_set(trials, varied[0]), key=abs)
    for path in (*(varied if len(varied) == 1 else ()), *KNOBS):
        if known.get(path):
            return path, float(known[path])
    return None


def _set(trials: Sequence[Trial], path: str) -> list[float]:
    """Return the values of a parameter of the mechanism in trials."""
    return [
        float({p: v for p, _, v in parameters(trial.mechanism, "mechanism")}[path])
        for trial in trials
    ]


def _root(covariance: Array) -> Array:
    """Return a root (q, q) of a covariance, whose scales may differ by decades."""
    size = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    scaled = covariance / np.outer(size, size) + 1e-9 * np.eye(len(size))
    return np.asarray(np.linalg.cholesky(scaled).T * size)


def block_scores(losses: Array) -> Array:
    """Return the scores (b,) of held-out losses (b,), in units of the noise.

    Examples
    --------
    >>> block_scores(np.array([0.0, 1.0, 1e12])).round(2).tolist()
    [0.0, 1.12, 131.22]
    """
    nu = THRESHOLDS.freedom
    return np.asarray((nu + 1.0) * np.log1p(losses / nu))


def stacked_shares(scores: Array, priors: Array) -> Array:
    """Return stacking weights by Bayesian bootstrap of the blocks (s,)."""
    count = scores.shape[1]
    draws = np.random.default_rng(1).dirichlet(np.ones(count), THRESHOLDS.draws)
    z = -0.5 * count * (scores @ draws.T) + np.log(priors)[:, None]
    return np.asarray(softmax(z, axis=0).mean(axis=1))


def with_curve(shares: Array, laws: NDArray[np.bool_]) -> Array:
    """Return shares of which the measured curve has at least a given one."""
    least, curves = THRESHOLDS.curve_share, float(shares[~laws].sum())
    if curves >= least:
        return shares
    result = np.where(laws, shares * (1.0 - least) / max(float(shares[laws].sum()), LEAST), 0.0)
    first = np.flatnonzero(~laws)[0]  # structures are in the order of their scores
    result[~laws] = least * shares[~laws] / curves if curves > LEAST else 0.0
    result[first] += 1.0 - result.sum()
    return np.asarray(result)


def band_of(curves: Array, level: float = 0.95, *, all_along: bool = False) -> PredictionBand:
    """Return quantiles of curves (d, n), a little wider than `level`.

    They are wider by a power: what no draw holds is the more, the rarer.
    """
    level = 1.0 - (1.0 - level) ** THRESHOLDS.rarer
    return quantile_band(curves, level, all_along=all_along, wider=THRESHOLDS.all_along)


def setting_scores(left: Array, shared: Array) -> Array:
    r"""Return scores (...) of standardised residuals (..., n), by Student's t for each setting.

    Of :math:`k` readings of a setting, which share an error along the unit vector :math:`u`
    (`shared` (b, n)), :math:`u \cdot z` has one score; what else they leave scatters by noise.

    Examples
    --------
    >>> alone, thrice = np.eye(3), np.ones((1, 3)) / math.sqrt(3.0)
    >>> left = np.array([4.0, 4.0, 4.0])
    >>> [round(float(setting_scores(left, one)), 1) for one in (alone, thrice)]
    [24.1, 12.8]
    """
    counts = np.sum(shared != 0.0, axis=1)[np.argmax(shared != 0.0, axis=0)]
    along = left @ shared.T
    rest = (left - along @ shared) ** 2 * counts / np.maximum(counts - 1.0, 1.0)
    scatter = block_scores(rest) * (counts - 1.0) / counts
    return np.asarray(np.sum(block_scores(along**2), axis=-1) + np.sum(scatter, axis=-1))


def unexplained_error(errors: Array, known: Array, freedom: float) -> float:
    r"""Return the error of a new setting beside known variances, as a scale of Student's t.

    Held-out errors :math:`e_i` (n,) have the variances :math:`v_i + \tau^2`, so that
    :math:`Q(\tau^2) = \sum_i e_i^2 / (v_i + \tau^2)` is :math:`n` on average [PM]_. They are no
    more independent than residuals are: Q is :math:`n / f` times chi squared with as many degrees
    of freedom :math:`f` as readings leave. That is what is known of :math:`\tau` [QP]_, of which a
    few settings say little. The scale is that of the distribution with the 95 % limits of new
    errors, normal with every such :math:`\tau`.

    Examples
    --------
    >>> errors = np.array([1.0, -1.0] * 50)
    >>> [round(unexplained_error(errors, v * np.ones(100), 98.0), 2) for v in (0.01, 2.0)]
    [0.71, 0.0]
    """
    n, squares, count = len(errors), errors**2, THRESHOLDS.draws
    even = (np.arange(count) + 0.5) / count
    freedom = max(freedom, 1.0)
    wanted = n / freedom * chdtri(freedom, even)  # falling
    tried = np.geomspace(1e-9, 1e9, count) * squares.max(initial=1e-300)
    total = np.sum(squares[:, None] / (known[:, None] + tried), axis=0)
    scales = np.exp(np.interp(-wanted, -total, np.log(tried)))
    scales[wanted >= total[0]] = 0.0
    new = np.outer(np.sqrt(scales), ndtri(0.5 + 0.5 * even))
    return float(np.quantile(new, 0.95) / stdtrit(THRESHOLDS.freedom, 0.975))


def _settings(trials: Sequence[Trial]) -> NDArray[np.intp]:
    """Return the number of the setting of each trial (n,): numbers of one are about the same."""
    firsts, result = list[Trial](), list[int]()
    for trial in trials:
        result.append(next((k for k, x in enumerate(firsts) if _same(x, trial)), len(firsts)))
        firsts.extend([trial] * (result[-1] == len(firsts)))
    return np.array(result)


def _same(one: Trial, other: Trial) -> bool:
    """Return whether two trials have the same setting, whatever the last digits of its numbers."""
    known, values = (
        {path: x for path, _, x in parameters(trial.mechanism, "mechanism")} | {**trial.initial}
        for trial in (one, other)
    )
    near = {x for x in known if math.isclose(known[x], values.get(x, math.nan), rel_tol=ALIKE)}
    moved = {path: known[path] for path in near - one.initial.keys()}
    started = one.initial.keys() == other.initial.keys() <= near
    return started and vary(other.mechanism, "mechanism", moved) == one.mechanism


def _solved(linear: Linear, measured: Array, errors: Array, shared: Array) -> Solved:
    """Return a linear problem solved, with its evidence and its held-out errors."""
    columns = linear.columns / errors[:, None]
    off = linear.centre - linear.means
    gram, precision = columns.T @ columns, linear.precisions
    matrix = gram + np.diag(precision + 1e-12 * np.diag(gram) + 1e-300)
    left = (measured - linear.predicted) / errors
    step = np.linalg.solve(matrix, columns.T @ left - precision * off)
    law, count = linear.structure.law, linear.structure.count
    signed = np.array([not name.startswith("backward") for name in law.names[:count]])
    signed &= ~law.rig[:count]
    outside = np.zeros(len(step), dtype=bool)
    outside[:count] = (linear.centre + step < 0.0)[:count] & signed
    while outside.any():  # nothing is negative: others follow what is held
        # coefficients end at 0, shapes stay
        ends = np.where(np.arange(len(step)) < law.count, -linear.centre, 0.0)
        step = np.where(outside, ends, step)
        right = columns.T @ left - precision * off - matrix[:, outside] @ step[outside]
        step[~outside] = np.linalg.solve(matrix[np.ix_(~outside, ~outside)], right[~outside])
        more = ~outside
        more[:count] &= (linear.centre + step < 0.0)[:count] & signed
        more[count:] = False
        if not more.any():
            break
        outside |= more
    left = left - columns @ step
    off = off + step
    covariance = np.linalg.inv(matrix)
    covariance = 0.5 * (covariance + covariance.T)
    _, volume = np.linalg.slogdet(matrix)
    evidence = (
        -0.5 * float(setting_scores(left, shared))
        - float(np.sum(np.log(errors)))
        - 0.5 * float(off**2 @ precision)
        - 0.5 * float(volume)
        + 0.5 * float(np.sum(np.log(precision)))
        + linear.prior
    )
    evidence += math.log(2.0) * int(
        signed[1 : law.count].sum()
    )  # others than the leading are not negative
    held_out, spreads, losses = np.array(left), list[Array](), list[float]()
    for block in shared:
        rows = block != 0.0
        own = columns[rows]
        hat = own @ covariance @ own.T
        # rounding must not make a leverage more than 1
        values, vectors = np.linalg.eigh(0.5 * (hat + hat.T))
        inverse = (vectors / (1.0 + 1e-9 - np.minimum(values, 1.0))) @ vectors.T
        held_out[rows] = alone = inverse @ left[rows]
        spreads.append(inverse)
        losses.append(float(np.mean(alone**2)))
    return Solved(
        linear=linear,
        values=linear.centre + step,
        root=_root(covariance),
        left=left,
        evidence=evidence,
        freedom=len(measured) - float(np.trace(covariance @ gram)),
        held_out=held_out * errors,
        spreads=spreads,
        losses=np.array(losses),
    )


def judged_travels(
    mechanism: Mechanism,
    trials: Sequence[Trial],
    laws: Mapping[str, FrictionLaw] | None = None,
    *,
    ordinary: Collection[str] = (),
    assumed: Mapping[str, Collection[str]] | None = None,
    named: Sequence[str] | None = None,
    rig: Sequence[str] = (),
    known: Collection[str] = (),
    strict: bool = False,
    t_end: float = 10.0,
    watch: Callable[[str, float], object] | None = None,
) -> TravelJudgement:
    """Judge travels: fit all laws, the usual ones if none are given, and weigh them.

    Values of laws that are not `ordinary` were given: of shapes they hold but for those `assumed`,
    and coefficients are held where the settings do not pay for them. Of a single law, `named` are
    parameters that are fitted, whatever values were given (all that travels tell if not given),
    `rig` paths of the mechanism that are fitted too, and `known` parameters that are held; it is
    searched thoroughly. If `strict`, a law that has no fit is an error.
    """
    usual_ones, listed_laws = laws is None, listed()
    if laws is None:
        laws = {name: starting_law(law_type(name)) for name in USUAL_LAWS if name in listed_laws}
    alone = len(laws) == 1
    fits = _Fits.of(trials, t_end)
    fitted, dropped = list[TravelLaw](), dict[str, tuple[FrictionLaw, str]]()
    for name in sorted(laws, key=lambda item: bool(laws[item].states)):
        law, is_given = laws[name], not (usual_ones or name in ordinary)
        if usual_ones and isinstance(law, DirectionDependent):
            start = fits.leading.with_unknowns(np.array(fits.size.levels[:1]))
            if not moving_back(start, trials, t_end):
                continue
        marked, held = set((assumed or {}).get(name, ())), {*known}
        if named is not None:  # a value that was given is where a search begins, and no more
            is_given = False
            held |= {item for item in fields_of(type(law)) if item not in named}
        elif is_given:
            held |= _unpaid(law, {x for x in _given_names(law) if x not in marked}, trials)
        try:
            one = TravelLaw.of(
                name, law, trials, t_end, held=held, given=is_given, guessed=marked,
                named=named or (), rig=rig, watch=None if watch is None else partial(watch, name),
            )  # fmt: skip
            one.thorough = alone
            simpler = [x for x in fitted if not x.slow]
            if alone and law.states and not rig:
                simpler = fits.without_bristles(law, held)
            fitted.append(fits.fitted(one, simpler))
        except (StickslipError, ValueError, IndexError) as error:
            why = str(error) if isinstance(error, StickslipError) else ""
            if strict and why:
                raise
            dropped[name] = law, why or "no values reproduce the travels"
    if not fitted:
        raise InputError(
            "no law can be fitted to these travels: " + " ".join(why for _, why in dropped.values())
        )
    return TravelJudgement(
        mechanism=mechanism, trials=trials, t_end=t_end, laws=fitted, size=fits.size,
        order=USUAL_LAWS, dropped=dropped,
    )  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class _Fits:
    """What fits of all laws to the same travels share."""

    leading: TravelLaw
    """Coulomb friction, by which levels are scanned."""
    size: Size
    errors: Array
    """Standard errors (n,) by which readings weigh [m]."""

    @classmethod
    def of(cls, trials: Sequence[Trial], t_end: float) -> "_Fits":
        coulomb = starting_law(law_type("coulomb"))
        leading = TravelLaw.of("coulomb", coulomb, trials, t_end, held=(), given=False)
        errors, _ = standard_errors(trials)
        measured = np.array([trial.travel for trial in trials])
        errors = np.maximum(errors, RESOLVED * float(np.mean(np.abs(measured))))
        return cls(leading=leading, size=leading.size(*leading.scanned()), errors=errors)

    def without_bristles(self, law: FrictionLaw, held: Collection[str]) -> list[TravelLaw]:
        """Return the law without bristles that has most of the parameters; none if it fails."""
        others = [law_type(name) for name in USUAL_LAWS if name in listed()]
        like = max(
            (other for other in others if not starting_law(other).states),
            key=lambda other: len(fields_of(other).keys() & fields_of(type(law)).keys() - held),
        )
        start, trials, t_end = starting_law(like), self.leading.trials, self.leading.t_end
        plain = TravelLaw.of(like.name, start, trials, t_end, held=held, given=False)
        with contextlib.suppress(StickslipError):
            return [self.fitted(plain)]
        return []

    def fitted(self, one: TravelLaw, simpler: Sequence[TravelLaw] = ()) -> TravelLaw:
        """Return a law fitted in all its shapes; an error says why it makes no such travels."""
        law, own, trials, errors = one.law, self.size, one.trials, self.errors
        measured = np.array([trial.travel for trial in trials])
        if not one.names:
            raise InputError(f"there is nothing to fit: name a parameter of {law.title} in vary.")
        if not one.rig[0] and one.quantities[0].scale != "level":  # a level tells nothing of it
            levels, top = one.scanned()
            own = replace(own, levels=levels, level=max(levels[0], top / HOLDING))
        one.fit(own, errors, simpler)
        if not one.structures:
            raise ConvergenceError(
                f"no values of {', '.join(one.model.free)} were found with which every trial can be"
                " simulated."
            )
        costs = [float(np.sum(((measured - s.predicted) / errors) ** 2)) for s in one.structures]
        best, *others = (one.structures[k] for k in np.argsort(costs, kind="stable"))
        moved = np.abs(measured) > THRESHOLDS.outlier * errors
        if np.any(moved & (np.abs(best.predicted) < STILL * np.abs(measured))):
            raise ConvergenceError(
                f"{law.title} friction holds the body at rest in a trial in which it moved."
            )
        off = abs(float(np.mean(measured - best.predicted)))
        alike = len({trial.setting for trial in trials}) == 1
        said = ""
        if alike and off > THRESHOLDS.outlier * float(np.max(errors)):
            said = (
                f"no value of {joined(list(one.model.free))} gives a travel of"
                f" {number(float(np.mean(measured)))} m; the nearest is"
                f" {quantity(float(best.predicted[0]), 'm', 4)}."
            )
        least, stated = standard_errors(trials)
        errors_of = least if stated else errors
        far = [float(np.sum(((best.predicted - s.predicted) / errors_of) ** 2)) for s in others]
        # of minima with the same travels, some may leave the body moving
        near = [s for s, x in zip(others, far, strict=True) if x <= 2.0 * SETTLED]
        moving = list[str]()
        for structure in (best, *near):
            values = one.values(structure.unknowns[None])[0].tolist()
            try:
                one.model.check_rest(trials, values, errors_of)
            except ConvergenceError as error:
                moving.append(str(error))
                one.structures.remove(structure)
            else:
                break
        else:
            raise ConvergenceError(f"{said} {moving[0]}".strip())
        if said:
            raise ConvergenceError(said)
        return one


def _given_names(law: FrictionLaw) -> list[str]:
    """Return names of parameters that have values."""
    return [path.rpartition(".")[2] for path, _, value in parameters(law, "friction") if value]


def _unpaid(law: FrictionLaw, known: Collection[str], trials: Sequence[Trial]) -> set[str]:
    """Return names of given coefficients for which the settings are too few."""
    settings = len({trial.setting for trial in trials})
    free = [name for name in law.fit_order if name not in known][: max(settings - 1, 0)]
    rest = [name for name in law.fit_order if name in known]
    return set(rest[max(settings - 1 - len(free), 1) :]) if rest else set()


def propagated(
    model: TravelModel, trials: Sequence[Trial]
) -> tuple[dict[str, Array], dict[str, Array]]:
    """Return what uncertainties of the mechanism make of each travel [m], to first order, by path.

    The first are of what was set anew for each trial, which scatters; the second of what all trials
    share, which moves them together, so that its entries have a sign. Slopes are those of a law and
    not of what was measured: a covariance that follows the readings' own noise biases estimates
    (Peelle's puzzle).
    """
    slopes: dict[tuple[Hashable, str], float] = {}

    def slope(trial: Trial, path: str, doubt: float) -> float:
        if (trial.run, path) not in slopes:
            ends = span_of(trial.mechanism, path, doubt)
            low, high = (
                model.travel(
                    trial.with_mechanism(vary(trial.mechanism, "mechanism", {path: end})), ()
                )
                for end in ends
            )
            slopes[trial.run, path] = (high - low) / (ends[1] - ends[0])
        return slopes[trial.run, path]

    def errors(doubts: Sequence[Mapping[str, float]]) -> dict[str, Array]:
        pairs = list(zip(trials, doubts, strict=True))
        return {
            path: np.array([slope(t, path, x[path]) * x[path] if path in x else 0.0
                            for t, x in pairs])
            for path in dict.fromkeys(path for doubt in doubts for path in doubt)
        }  # fmt: skip

    return errors([trial.doubts for trial in trials]), errors([trial.shared for trial in trials])
