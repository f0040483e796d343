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
from stickslip.identify.bands import Interval, MeasuredPoints, PredictionBand, correlation_of
from stickslip.identify.comparison import Comparison, compare, family_members
from stickslip.identify.ensemble import (
    Draw,
    Ensemble,
    Prepared,
    allotted,
    band_of,
)
from stickslip.identify.explorer import Explorer, Pattern
from stickslip.identify.laws import Composition, Sliding, drawn_curve
from stickslip.identify.problem import Array, Column, Family, Problem, Structure
from stickslip.identify.regression import BlockRegression, same_span
from stickslip.identify.search import Search
from stickslip.identify.thresholds import THRESHOLDS

FLOW = "viscous_coefficient"
"""Parameter whose meaning depends on the part that has it."""


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

    @property
    def family(self) -> Family:
        """Names of the terms of the named law."""
        return self.problem.family(self.named)

    @property
    def families(self) -> tuple[Family, ...]:
        """Families that are not told apart, the named one first."""
        return tuple(self.problem.family(one) for one in self.comparison.set)

    @property
    def curve_share(self) -> float:
        """Share of the curve as measured, which is no law, in the band."""
        comparison = self.ensemble.comparison
        both = zip(comparison.structures, comparison.shares.tolist(), strict=True)
        return min(math.fsum(p for one, p in both if not self.problem.is_law(one)), 1.0)

    @property
    def is_explained(self) -> bool:
        """Whether a law predicts as well as the measured curve."""
        comparison = self.comparison
        return not (
            comparison.curve_share > THRESHOLDS.no_law
            and comparison.curve_gain > THRESHOLDS.errors
            and comparison.curve_ratio > THRESHOLDS.no_law_ratio
        )

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

    def sampled(self, count: int, seed: int) -> list[FrictionLaw]:
        """Return laws of draws; through their levels where they are none of ours."""
        draws = replace(self.ensemble, seed=seed).draws()
        rows = [(draw.structure, row) for draw in draws for row in draw.coefficients]
        order = np.random.default_rng(seed).permutation(len(rows))
        found = []
        for structure, row in (rows[k] for k in np.resize(order, count)):
            composed, sliding, law = self.handed_over(structure, row)
            found.append(drawn_curve(sliding, composed.normal()) if law is None else law)
        return found

    def measured(self) -> MeasuredPoints:
        """Return what a figure shows of the measurement."""
        fit = self.ensemble.fit(self.estimated)
        points = self.problem.points(self.estimated, fit.coefficients)
        ones = np.ones(len(points.velocity))
        return MeasuredPoints(
            velocity=points.velocity,
            friction=points.friction,
            load=points.load,
            weights=ones if points.rows is None else self.regression.weights[points.rows],
        )

    def band(self, rows: Any, level: float = 0.95, *, all_along: bool = False) -> PredictionBand:
        """Return the band of friction at rows, whichever law holds."""
        return band_of(self.ensemble.curves(rows), level, all_along=all_along)

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
        return correlation_of(table)

    def held_out_error(self, structure: Structure) -> float:
        """Return the root mean square of the held-out residuals."""
        left = self.regression.held_out(structure)
        return float(np.sqrt(np.mean(left**2)))

    @cached_property
    def causes(self) -> tuple[Cause, ...]:
        """What the named structure holds beside a law, the largest first."""
        terms, named = self.problem.terms, self.named
        losses = self.regression.losses_of
        total = float(np.var(self.problem.response)) or 1.0
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

    def details(self) -> Mapping[str, Any]:
        """Return what a document has of the judgement beside the band and the parameters."""
        return {
            "causes": [
                {
                    "term": one.term,
                    "role": self.problem.terms[one.term].role,
                    "title": one.title,
                    "share": one.share,
                    "left": one.left,
                    "explained": one.explained,
                    "asserted": one.asserted,
                    "needed": one.needed,
                    "instead": list(one.instead),
                }
                for one in self.causes
            ],
            "patterns": [
                {
                    "of": "scatter" if one.scatter else "residuals",
                    "feature": one.feature,
                    "share": one.share,
                    "of_force": one.of_force,
                    "p": one.p,
                    "stated": one.stated,
                }
                for one in self.patterns
            ],
        }

    @property
    def is_noise(self) -> bool:
        """Whether half of the measurement is as large as its noise: else a few rows make that."""
        middle = 1.4826 * float(np.median(np.abs(self.regression.weights * self.problem.response)))
        return middle**2 >= THRESHOLDS.least_variance

    @cached_property
    def _left(self) -> Sequence[Array]:
        """What the named and the best structure leave of parts of the measurement (2, n)."""
        pair = dict.fromkeys([self.named, self.comparison.best])
        return [self.regression.left_between(one, self.problem.parts()) for one in pair]

    def reading_band(self, rows: Any, level: float = 0.95) -> PredictionBand:
        """Return the band of new readings at rows (n,)."""
        return band_of(self.readings(rows), level)

    def readings(self, rows: Any) -> Array:
        """Return draws of new readings at rows (d, n): curves and noise.

        Noise is what laws leave of one part of the measurement, predicted from the others, at rows
        of about the same speed: with its tails, its scatter by speed, and what differs from part to
        part.
        """
        curves, rng = self.ensemble.curves(rows), np.random.default_rng(self.ensemble.seed + 3)
        return curves + self._resampled(rows, len(curves), rng)

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
