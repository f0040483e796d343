"""The judge: search, comparison and ensemble of one problem, and what they say of parameters.

1. `Search` meets structures by their held-out losses, with weights that follow from residuals.
2. `compare` gives each a share, names a family, and says which are not told apart from it.
3. `Ensemble` draws laws by their shares with their covariances: bands, samples, intervals.

Every statement of a verdict is read from these; there are no further rules.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.friction import FrictionLaw
from stickslip.identify.comparison import Comparison, compare, family_members
from stickslip.identify.ensemble import (
    Draw,
    Ensemble,
    PredictionBand,
    Prepared,
    allotted,
    band_of,
)
from stickslip.identify.explorer import Explorer, Pattern
from stickslip.identify.laws import Composition, Sliding
from stickslip.identify.problem import Array, Column, Family, Problem, Structure
from stickslip.identify.regression import BlockRegression, noise_at, noise_weights, same_span
from stickslip.identify.search import Search
from stickslip.identify.thresholds import THRESHOLDS

FLOW = "viscous_coefficient"
"""Parameter whose meaning depends on the part that has it."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """What a measurement says of a parameter."""

    path: str
    """Full path, such as ``"friction.kinetic_coefficient"``; of nuisances their name."""
    value: float
    """Estimate under the named law."""
    low: float
    high: float
    """95 % interval under the named law."""
    low_any: float
    high_any: float
    """95 % interval over whichever law of the set has the parameter."""


@dataclass(frozen=True, kw_only=True)
class Cause:
    """A property of the rig, or a fault of the measurement, that the named structure holds."""

    term: str
    """Name of the term."""
    title: str
    """What it is, in words."""
    share: float
    """Share of the squared held-out error that it takes off."""
    left: float
    """Share of the variance of the response that the named structure leaves."""
    explained: float
    """Share that it takes off what noise of the sensors does not explain without it."""
    needed: bool
    """Whether all laws that are not told apart hold it, or what is not told from it."""
    instead: tuple[str, ...] = ()
    """Names of terms that this design does not tell from it."""

    @property
    def asserted(self) -> bool:
        """Whether most of what could be explained is, by it and by the law beside it."""
        return self.explained > THRESHOLDS.explained and self.left <= THRESHOLDS.explained


@dataclass(frozen=True, eq=False)
class Judgement:
    """A judged problem."""

    problem: Problem
    regression: BlockRegression
    comparison: Comparison
    ensemble: Ensemble
    offset: bool = False
    """Whether the levels of laws hold a constant offset, as no mechanism does."""

    @classmethod
    def of(cls, problem: Problem) -> "Judgement":
        """Judge a problem."""
        search = Search(problem).run()
        comparison = compare(search)
        learned = Explorer(search.regression, comparison.structures[0]).learned()
        ensemble = Ensemble(search.regression, comparison, learned=learned)
        return cls(problem, search.regression, comparison, ensemble)

    @property
    def named(self) -> Structure:
        """The best structure of the named family."""
        return self.comparison.named

    @cached_property
    def estimated(self) -> Structure:
        """The named law with the shapes of its estimates: refined where the ensemble is."""
        refined = self.ensemble.comparison.named
        family = self.problem.family
        return refined if family(refined) == family(self.named) else self.named

    @cached_property
    def composition(self) -> Composition:
        """The named law with its estimates."""
        fit = self.ensemble.fit(self.estimated)
        return self._composed(self.estimated, fit.coefficients[None])

    def _composed(self, structure: Structure, coefficients: Array) -> Composition:
        return self.problem.composition(structure, coefficients, offset=self.offset)

    def handed_over(
        self, structure: Structure, coefficients: Array
    ) -> tuple[Composition, Sliding, FrictionLaw | None]:
        """Return what a structure with coefficients (p,) is, how it slides, and its law.

        The law slides as the structure says in both directions, beside the offset if no level holds
        it. It is None where no law of `stickslip.friction` does.
        """
        composed = self._composed(structure, coefficients[None])
        sliding = self.problem.sliding(structure, coefficients, offset=self.offset)
        law = composed.law()
        if law is not None and not composed.text and not sliding.brakes(law, composed):
            law = None
        return composed, sliding, law

    def acting(self, rows: Any) -> Array:
        """Return friction of the named law and its constant offset (n,) at rows."""
        fit = self.ensemble.fit(self.estimated)
        return self.problem.acting(self.estimated, fit.coefficients, rows)

    def named_draws(self, count: int = THRESHOLDS.ensemble) -> list[Draw]:
        """Return draws of the named family: shapes by their shares, coefficients by covariance."""
        return self._family_draws(self.problem.family(self.named), count)

    def _family_draws(self, family: Family, count: int) -> list[Draw]:
        members = family_members(self.ensemble.comparison, family)
        members = members or family_members(self.comparison, family)
        parts = allotted(np.array([*members.values()]), count)
        return [
            Draw(structure=one, coefficients=self.ensemble.sampled(one, n, further=1))
            for one, n in zip(members, parts, strict=True)
            if n
        ]

    @property
    def named_band(self) -> PredictionBand:
        """Band of the named family alone, at the rows over which that of all is stated."""
        rows, predicted = self.problem.asked(), self.ensemble.predicted
        drawn = [predicted(one.structure, one.coefficients.T, rows) for one in self.named_draws()]
        return band_of(np.hstack(drawn).T)

    def values(self, draws: list[Draw]) -> dict[str, Array]:
        """Return parameters of draws (d,) by path, of those that have them as the law does."""
        found: dict[str, list[Array]] = {}
        for draw in draws:
            composed = self._composed(draw.structure, draw.coefficients)
            for path, x in composed.paths().items():
                if composed.flow == self.composition.flow or not path.endswith(FLOW):
                    found.setdefault(path, []).append(x)
        return {path: np.concatenate(parts) for path, parts in found.items()}

    @cached_property
    def named_values(self) -> dict[str, Array]:
        """Draws of the parameters of the named family (d,) by path."""
        return self.values(self.named_draws())

    @cached_property
    def intervals(self) -> tuple[Interval, ...]:
        """Intervals of the parameters of the named law.

        Whichever law holds, as many draws are of the named family as of all that the band has, and
        each rival adds the root of its odds: what is not told apart must not be left out.
        """
        own, every = self.named_values, self.values(self.ensemble.draws())
        tail = 0.5 * (1.0 - THRESHOLDS.interval)
        evidence, (named, *rivals) = self.comparison.evidence, self.comparison.set
        drawn = []
        for rival in rivals:
            odds = math.exp(evidence[rival] - evidence[named])
            count = math.ceil(THRESHOLDS.ensemble * math.sqrt(odds))
            drawn.append(self.values(self._family_draws(self.problem.family(rival), count)))
        found = []
        for path, x in self.composition.paths().items():
            low, high = np.quantile(own[path], (tail, 1.0 - tail)).tolist()
            others = every.get(path, own[path])
            rest = [values[path] for values in drawn if path in values]
            both = np.concatenate([own[path], np.resize(others, len(own[path])), *rest])
            low_any, high_any = np.quantile(both, (tail, 1.0 - tail)).tolist()
            ends = {"low": low, "high": high}
            ends |= {"low_any": min(low, low_any), "high_any": max(high, high_any)}
            found.append(Interval(path=path, value=float(x[0]), **ends))
        return tuple(found)

    @cached_property
    def correlation(self) -> Array:
        """Correlation of the parameters of the named law (p, p), as `intervals` orders them."""
        if not self.intervals:
            return np.zeros((0, 0))
        paths = [one.path for one in self.intervals]
        parts = [self.values([draw]) for draw in self.named_draws()]
        # shapes of a family may lack a parameter: Hersey's number has no exponent of the load
        table = np.hstack(
            [[part[path] for path in paths] for part in parts if part.keys() >= {*paths}]
        )
        spread = np.std(table, axis=1)
        safe = np.where(spread > 0.0, spread, 1.0)
        centred = (table - table.mean(axis=1, keepdims=True)) / safe[:, None]
        return np.asarray(centred @ centred.T / table.shape[1])

    def held_out_error(self, structure: Structure) -> float:
        """Return the root mean square of the held-out residuals, outliers as far as they count."""
        left = self.regression.held_out(structure)
        return float(np.sqrt(np.average(left**2, weights=self.regression.counted)))

    @cached_property
    def causes(self) -> tuple[Cause, ...]:
        """What the named structure holds beside a law, the largest first."""
        terms, named = self.problem.terms, self.named
        losses = self.regression.losses_of
        y, counted = self.problem.response, self.regression.counted
        total = float(np.cov(y, aweights=counted, ddof=0)) or 1.0
        left = self.held_out_error(named) ** 2 / total
        coefficients = self.ensemble.fit(named).coefficients
        noise = np.mean(self.problem.noise_floor(named, coefficients) * self.regression.weights**2)
        instead = same_span(self.regression, named).instead
        found = []
        for column in named:
            if terms[column[0]].role not in ("rig", "fault", "run"):
                continue
            without = self._without(column)
            if without is None:
                continue
            self.regression.losses([without])
            before, after = (float(np.mean(losses[one])) for one in (without, named))
            share, explained = 1.0, 1.0
            if math.isfinite(before) and before > 0.0:
                share = 1.0 - after / before
                explained = (before - after) / max(before - float(noise), before - after, 1e-300)
            alike = tuple(name for name, _ in instead.get(column[0], ()))
            each = [{name for name, _ in one} for one in self.comparison.set]
            found.append(
                Cause(
                    term=column[0],
                    title=terms[column[0]].title,
                    share=share,
                    left=left,
                    explained=explained,
                    needed=all(names & {column[0], *alike} for names in each),
                    instead=alike,
                )
            )
        return tuple(sorted(found, key=lambda one: -one.share))

    def _without(self, column: Column) -> Structure | None:
        """Return the named structure without a term and those that need it; None if none stands."""
        terms, rest = self.problem.terms, tuple(one for one in self.named if one != column)
        if column[0] in self.problem.always:
            return None
        while not self.problem.allowed(rest):
            names = {name for name, _ in rest}
            kept = tuple(
                one for one in rest if not terms[one[0]].needs or terms[one[0]].needs & names
            )
            if kept == rest:
                return None
            rest = kept
        return rest

    @cached_property
    def patterns(self) -> tuple[Pattern, ...]:
        """What the residuals of the named structure follow, and their scatter."""
        return Explorer(self.regression, self.named).patterns()

    @cached_property
    def outliers(self) -> Mapping[int, float]:
        """Rows that are far from the others, with how many standard deviations."""
        _, z = noise_weights(self.regression, self.named)
        far = np.flatnonzero(z > THRESHOLDS.outlying)
        return {int(row): float(z[row]) for row in far}

    @property
    def is_noise(self) -> bool:
        """Whether half of the measurement is as large as its noise: else a few rows make that."""
        middle = 1.4826 * float(np.median(np.abs(self.regression.weights * self.problem.response)))
        return middle**2 >= THRESHOLDS.least_variance

    def noise(self, rows: Any) -> Array:
        """Return the standard deviation of a reading at rows (n,): that of the nearest by speed."""
        return noise_at(self.regression, rows)

    @cached_property
    def _left(self) -> Sequence[Array]:
        """What the named and the best structure leave of parts of the measurement (2, n)."""
        pair = dict.fromkeys([self.named, self.comparison.best])
        return [self.regression.left_between(one, self.problem.parts()) for one in pair]

    def reading_band(self, rows: Any, level: float = 0.95) -> PredictionBand:
        """Return the band of new readings at rows (n,)."""
        # noise of independent readings has the tails of the score: what no draw holds is in them
        rarer = 1.0 if self.problem.independent else THRESHOLDS.rarer
        return band_of(self.readings(rows), level, rarer=rarer)

    def readings(self, rows: Any) -> Array:
        """Return draws of new readings at rows (d, n): curves and noise.

        Of independent readings noise has the variance that each law leaves and, as in the score of
        blocks, the tails of Student's t: what a law leaves is larger where friction is not as it
        says, and smaller elsewhere. Dense rows have what laws leave of one part of the measurement,
        predicted from the others, at rows of about the same speed: with its tails, its scatter by
        speed, and what differs from part to part.
        """
        curves = self.ensemble.curves(rows)
        rng = np.random.default_rng(self.ensemble.seed + 3)
        if not self.problem.independent:
            return curves + self._resampled(rows, len(curves), rng)
        freedom = THRESHOLDS.freedom
        noise = rng.standard_t(freedom, size=curves.shape) * math.sqrt(1.0 - 2.0 / freedom)
        return np.asarray(curves + self.noise(rows) * noise * self.ensemble.scatter(rng)[:, None])

    def _resampled(self, rows: Any, count: int, rng: np.random.Generator) -> Array:
        """Return what readings at rows leave (count, n), drawn from rows of like speed."""
        problem = self.problem
        speed, asked = problem.speeds(problem.rows), problem.speeds(rows)
        order = np.argsort(speed, kind="stable")
        place = np.searchsorted(speed[order], asked)
        near = math.isqrt(len(speed))  # neighbours grow with the rows, and their share of all falls
        at = place + rng.integers(-near, near + 1, size=(count, len(asked)))
        left = np.array([one[order] for one in self._left]) + problem.beside(rows)[order]
        which = rng.integers(len(left), size=(count, 1))
        return np.asarray(left[which, np.clip(at, 0, len(order) - 1)])

    def widened_by(self, other: Problem) -> "Judgement":
        """Return the judgement with a band that holds what a second record differs by.

        The named law is fitted to that record too. The spread of coefficients grows by the root
        mean square of the difference of both curves over the standard deviation of the band.
        """
        rows, law = self.problem.asked(), self.estimated
        curves = self.ensemble.curves(rows)
        again = self.ensemble.predicted(law, Prepared(other).fit(law).coefficients, rows)
        apart = (again - np.median(curves, axis=0)) / (np.std(curves, axis=0) + 1e-300)
        times = float(np.sqrt(np.mean(apart**2)))
        return replace(self, ensemble=replace(self.ensemble, wider=max(times, 1.0)))


# What to measure next: readings that are expected to narrow the band most.

HALF = 0.3
"""Expected width over today's at which enough is measured: less than half is, mostly."""
WORTH = 0.7
"""Expected width over today's from which no readings are proposed."""
MOST = 4
"""Readings that are proposed at most, over those that were taken."""


@dataclass(frozen=True, kw_only=True)
class Proposal:
    """Readings to take."""

    places: tuple[int, ...]
    """Offered places, in the order of their gain; one may stand for several readings."""
    shrinks: float
    """Expected width of the band after them, over today's."""


def propose(
    asked: Array, offered: Array, noise: Array, taken: int = 16, rest: Array | float = 0.0
) -> Proposal:
    r"""Return the readings that narrow the band of curves at asked places (d, n).

    The drawn curves have a mean and a covariance :math:`K` over asked and offered places. A reading
    at place :math:`j` with noise :math:`s_j` takes off :math:`K_{ij}^2 / (K_{jj} + s_j^2)` of the
    variance at place :math:`i` (linear Gaussian update); the place that takes off most of the mean
    variance is taken, and the next one after the update, until the expected width is `HALF` of
    today's. `rest` is the variance (n,) that no reading takes off, such as that from run to run.
    (Measured: the widest place shrinks the width to .71; rehearsing draws as truths gained nothing
    over it.)

    Examples
    --------
    >>> rng = np.random.default_rng(0)
    >>> level, slope = rng.normal(size=(2, 400, 1))
    >>> v = np.array([[0.0, 0.5, 1.0]])
    >>> propose(level + 5.0 * slope * v, level + 5.0 * slope * v, np.full(3, 0.1)).places[0]
    2
    """
    curves = np.hstack([asked, offered])
    curves = curves - curves.mean(axis=0)
    covariance = curves.T @ curves / len(curves)
    count = asked.shape[1]

    def width() -> float:
        """Return the mean standard deviation at the asked places."""
        return float(np.mean(np.sqrt(np.maximum(np.diag(covariance)[:count], 0.0) + rest)))

    start = width()
    places: list[int] = []
    while start > 0.0 and len(places) < MOST * taken and width() > HALF * start:
        own = np.diag(covariance)[count:] + noise**2 + 1e-300
        gains = np.sum(covariance[:count, count:] ** 2 / own, axis=0)
        best = int(np.argmax(gains))
        row = covariance[:, count + best]
        covariance = covariance - np.outer(row, row) / own[best]
        places.append(best)
    shrinks = width() / start if start > 0.0 else 1.0
    if shrinks >= WORTH:
        return Proposal(places=(), shrinks=1.0)
    return Proposal(places=tuple(places), shrinks=shrinks)
