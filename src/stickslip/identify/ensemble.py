r"""The ensemble: laws drawn over the set with their covariances, and the bands read from it.

A structure is drawn by its share, its coefficients from Student's t about their estimates with the
covariance of `BlockRegression.fit`; where the same measurement was prepared in other ways (twins),
a part of the draws comes from each, so that what the preparation changes is spread too. A band is
the quantiles of the drawn curves: point by point, or widened until that share of the curves lies
inside all along.

Each structure has a stream of random numbers of its own, whose first ones stay the same for any
number of draws: a share that differs by rounding adds or removes a draw, and changes no other.
"""

import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import numpy as np

from stickslip.identify.bands import PredictionBand, quantile_band
from stickslip.identify.comparison import Comparison
from stickslip.identify.explorer import Learned
from stickslip.identify.problem import Array, Columns, Fitted, Problem, Structure
from stickslip.identify.regression import BlockRegression
from stickslip.identify.thresholds import THRESHOLDS

REDRAWN = 20
"""Draws for each that is wanted, of which those that are physics are kept."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Draw:
    """A structure with the coefficients of its draws."""

    structure: Structure
    coefficients: Array
    """Coefficients (d, p) of each draw."""


@dataclass(eq=False)
class Ensemble:
    """Draws of laws of a comparison."""

    regression: BlockRegression
    comparison: Comparison
    seed: int = 0
    twinned: bool = True
    """Whether the same measurement prepared otherwise counts, too."""
    learned: Learned | None = None
    """How far friction may be off in a way that no law knows."""
    wider: float = 1.0
    """Factor on the spread of coefficients, by what a second record differs."""
    _fits: dict[Structure, Fitted] = field(default_factory=dict)

    @property
    def problem(self) -> Problem:
        """The measurement."""
        return self.regression.problem

    def fit(self, structure: Structure) -> Fitted:
        """Return a structure fitted to all rows."""
        if structure not in self._fits:
            self._fits[structure] = self.regression.fit(structure)
        return self._fits[structure]

    def draws(self, count: int = THRESHOLDS.ensemble) -> list[Draw]:
        """Return `count` laws, in the order of the structures."""
        return [
            Draw(structure=structure, coefficients=self.sampled(structure, n))
            for structure, n in self._counts(count)
        ]

    def _counts(self, count: int) -> list[tuple[Structure, int]]:
        """Return how often each structure is drawn, of those that are."""
        shares, structures = self.comparison.shares, self.comparison.structures
        return [(s, n) for s, n in zip(structures, allotted(shares, count), strict=True) if n]

    def sampled(self, structure: Structure, count: int, further: int = 0) -> Array:
        """Return coefficients (count, p) of draws of one structure, alike many of each twin.

        `further` is the number of a set of draws apart from others.
        """
        twins = [twin for twin in self._twins if twin.problem.serves(structure)]
        fits = [self.fit(structure), *(twin.fit(structure) for twin in twins)]
        parts = allotted(np.ones(len(fits)), count)
        streams = stream_of(structure, self.seed + further).spawn(len(fits))
        each = zip(fits, parts, streams, strict=True)
        return np.vstack([self._drawn(structure, fit, n, rng) for fit, n, rng in each])

    def _drawn(
        self, structure: Structure, fit: Fitted, count: int, rng: np.random.Generator
    ) -> Array:
        """Return coefficients (count, p) that are physics; any, where hardly any are."""
        found = fit.coefficients + self.wider * student(fit, count, rng)
        kept = self.problem.physical(structure, found)
        if np.all(kept):
            return found
        more = fit.coefficients + self.wider * student(fit, REDRAWN * count, rng)
        some = np.vstack([found[kept], more[self.problem.physical(structure, more)]])
        # no more draws than coefficients have no spread of their own
        return np.resize(some, found.shape) if len(some) > found.shape[1] else found

    @cached_property
    def _twins(self) -> "list[Prepared]":
        return [Prepared(one) for one in self.problem.twins] if self.twinned else []

    def predicted(self, structure: Structure, coefficients: Array, rows: Any) -> Array:
        """Return what a structure with coefficients (p,) predicts at rows (n,)."""
        columns = Columns(self.problem, rows)
        x = columns.matrix(structure, self._length(columns))
        return np.asarray(x @ coefficients)

    def curves(self, rows: Any, count: int = THRESHOLDS.ensemble) -> Array:
        """Return what drawn laws predict at rows (count, n)."""
        columns = Columns(self.problem, rows)
        length = self._length(columns)
        curves = np.vstack(
            [
                draw.coefficients @ columns.matrix(draw.structure, length).T
                for draw in self.draws(count)
            ]
        )
        if self.learned is None:
            return curves
        rng = np.random.default_rng(self.seed + 5)
        return curves + self.learned.draws(rows, len(curves), rng)

    def _length(self, columns: Columns) -> int:
        return len(columns.of(self.comparison.curve[0]))

    def band(self, rows: Any, level: float = 0.95, *, all_along: bool = False) -> PredictionBand:
        """Return the band of the curves at rows."""
        return band_of(self.curves(rows), level, all_along=all_along)

    def coefficient(
        self, term: str, structures: Mapping[Structure, float], count: int = 1500
    ) -> Array:
        """Return draws of the first coefficient of a term over structures by weight (count,)."""
        found = []
        having = {one: p for one, p in structures.items() if any(n == term for n, _ in one)}
        weights = np.array([*having.values()])
        for one, n in zip(having, allotted(weights / weights.sum(), count), strict=True):
            if n:
                before = one[: [name for name, _ in one].index(term)]
                at = sum(self.regression.columns.of(column).shape[1] for column in before)
                found.append(self.sampled(one, n, further=2)[:, at])
        return np.concatenate(found)


@dataclass(eq=False)
class Prepared:
    """A measurement prepared otherwise, or another: structures fitted with robust weights."""

    problem: Problem
    _fits: dict[Structure, Fitted] = field(default_factory=dict)

    @cached_property
    def _regression(self) -> BlockRegression:
        return BlockRegression(self.problem)

    def fit(self, structure: Structure) -> Fitted:
        """Return a structure fitted to all rows."""
        if structure not in self._fits:
            regression, weights = self._regression, np.ones(len(self.problem.response))
            regression.add(structure)
            for _ in range(THRESHOLDS.weighings):
                left = np.abs(regression.left(structure, weights))
                z = left / (1.4826 * float(np.median(left)) + 1e-300)
                weights = np.minimum(1.0, THRESHOLDS.outlier / np.maximum(z, 1e-9))
                weights = weights**self.problem.softness
            self._fits[structure] = regression.fit(structure, weights)
        return self._fits[structure]


def allotted(shares: Array, count: int) -> list[int]:
    """Return how many of `count` draws each share gets: systematic sampling, without chance."""
    ends = np.floor(np.cumsum(shares) / shares.sum() * count + 0.5 - 1e-9)
    return [int(one) for one in np.diff(ends, prepend=0.0)]


def stream_of(structure: Structure, seed: int) -> np.random.Generator:
    """Return the random numbers of a structure, whose shapes are known but for rounding."""
    text = repr([(name, [f"{float(x):.4g}" for x in shape]) for name, shape in structure])
    return np.random.default_rng([seed, zlib.crc32(text.encode())])


def student(fit: Fitted, count: int, rng: np.random.Generator) -> Array:
    """Return draws (count, p) of Student's t about 0 with the covariance of a fit."""
    root = root_of(fit.covariance) if fit.root is None else fit.root
    normal, scale = rng.spawn(2)
    drawn = normal.normal(size=(count, len(root))) @ root
    return np.asarray(drawn / np.sqrt(scale.chisquare(fit.freedom, (count, 1)) / fit.freedom))


def root_of(covariance: Array) -> Array:
    """Return a root (p, p) of a covariance, the transposed one of Cholesky."""
    size = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    unit = np.where(size > 0.0, size, 1.0)
    scaled = covariance / np.outer(unit, unit)
    root = np.linalg.cholesky(0.5 * (scaled + scaled.T) + 1e-9 * np.eye(len(size)))
    return np.asarray(root.T * size)


def band_of(
    curves: Array,
    level: float = 0.95,
    *,
    all_along: bool = False,
    rarer: float = THRESHOLDS.rarer,
) -> PredictionBand:
    """Return quantiles of curves (d, n): point by point, or so that they hold all along.

    They are wider than `level` by the power `rarer`: what no draw holds is the more, the rarer.
    """
    level = 1.0 - (1.0 - level) ** rarer
    return quantile_band(curves, level, all_along=all_along, wider=THRESHOLDS.all_along)
