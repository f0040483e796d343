r"""What a law leaves: which recorded feature it follows, by one cross-validated learner.

Let :math:`z` be the held-out residuals of a structure over their scatter, at most
`Thresholds.outlying` either way. For each feature :math:`f` that a problem offers
(`Problem.features`), and for the fitted force,

1. the columns :math:`B = [h(f), s\,h(f)]`, with hats :math:`h` at quantiles of the feature and the
   direction of motion :math:`s`, predict :math:`z` by ridge regression, each block of the problem
   from the others. The *share* is what they take off the squares of :math:`z`; the feature with the
   largest names what is left;
2. on dense records, :math:`h(f)` alone predict :math:`\sqrt{|z|}` likewise: the scatter, of which
   the few rows of a table tell no more than `Problem.scales`;
3. `REHEARSALS` records are made of the fit and stretches of what it leaves, drawn anew with random
   signs, which hold nothing that follows a feature. The structure predicts them held out, and the
   learner looks for features. Of both largest shares the less likely decides, so that the two
   looks count as one: :math:`p` is the part of rehearsals in which as unlikely a share occurs.

On a dense record everything is significant, so a pattern is *material*, and is stated, only if
what it takes off is at least `Thresholds.pattern` of the force, or of the scatter a share of
`Thresholds.pattern_of_scatter`. A pattern names a feature and no cause.

All features with a share of their own together, fitted to all rows, are the *learned part*: how far
friction may be off in a way that the laws do not know. It widens the ensemble by one draw, normal
with the learned part as its deviation, significant or not; a feature that asked rows do not state,
such as the time, is that of measured rows in turn. Where laws are refined, noise of the force
explains what they leave, and the ensemble has no learned part: that of the balance is of its filter
(60 records: the band was 1.7 times as wide and held no more).

Gram matrices are made once for all features, as in `stickslip.identify.regression`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from stickslip.identify.problem import SIDE, STRETCHES, Array, Columns, Mask, Structure
from stickslip.identify.regression import BlockRegression, noise_at
from stickslip.identify.thresholds import THRESHOLDS

REHEARSALS = 99
"""Records without a pattern with which what is left is compared."""
RIDGE = 0.03
"""Ridge over the number of rows, of columns of variance 1."""


@dataclass(frozen=True, kw_only=True)
class Pattern:
    """The feature that what is left of the named law, or its scatter, follows most."""

    feature: str
    """Name of the feature."""
    scatter: bool
    """Whether it is the scatter that follows the feature."""
    share: float
    """Share of the held-out squares that it explains, or of the variance of roots of sizes."""
    of_force: float
    """Root mean square of what it explains over that of the response; 0 of the scatter."""
    p: float
    """Part of the rehearsals in which something as unlikely occurs."""
    material: bool
    """Whether it is large enough to be stated."""

    @property
    def stated(self) -> bool:
        """Whether it is material and no chance."""
        return self.material and self.p <= THRESHOLDS.pattern_chance


@dataclass(frozen=True, kw_only=True, eq=False)
class Curves:
    """Columns of one feature: hats at its quantiles, alone and times the direction."""

    name: str
    knots: Array
    """Where hats stand (k,); empty where the feature gives its columns itself."""
    signed: bool
    mean: Array
    size: Array

    @classmethod
    def of(cls, name: str, x: Array, side: Array | None, count: int) -> "Curves | None":
        """Return the columns of a feature with values (n,) or columns (n, d); None if constant."""
        knots = np.zeros(0)
        if x.ndim == 1:
            knots = np.unique(np.quantile(x, np.linspace(0.0, 1.0, count)))
            if float(np.ptp(knots)) <= 1e-9 * float(np.max(np.abs(knots))):
                return None
        plain = cls._hats(x, knots)
        both = plain if side is None else np.hstack([plain, side[:, None] * plain])
        size = both.std(axis=0)
        return cls(
            name=name,
            knots=knots,
            signed=side is not None,
            mean=both.mean(axis=0),
            size=np.where(size > 1e-9, size, np.inf),
        )

    @staticmethod
    def _hats(x: Array, knots: Array) -> Array:
        """Return hats (n, k - 1): the first is what the others leave of 1."""
        if not len(knots):
            return np.asarray(x, dtype=float)
        return np.array([np.interp(x, knots, one) for one in np.eye(len(knots))[1:]]).T

    def columns(self, x: Array, side: Array) -> Array:
        """Return columns (n, p) of mean 0 and variance 1 at the rows that were explored."""
        plain = self._hats(x, self.knots)
        both = np.hstack([plain, side[:, None] * plain]) if self.signed else plain
        return np.asarray((both - self.mean) / self.size)


@dataclass(frozen=True, kw_only=True, eq=False)
class Learned:
    """What features predict of what is left, at any rows."""

    regression: BlockRegression
    structure: Structure
    curves: Sequence[Curves]
    coefficients: Array
    """Coefficients (p,) of all columns, in units of the noise."""
    moments: Mapping[str, Array]
    """Features of measured rows (k,) or (k, d), by name, that stand for those of asked rows."""

    def at(self, rows: Any) -> Array:
        """Return the learned part at rows (k, n), as it is at each of k measured moments."""
        asked = features_of(self.regression, self.structure, rows)
        unstated = any(np.isnan(asked[one.name]).any() for one in self.curves)
        found = []
        for k in range(STRETCHES if unstated else 1):
            parts = []
            for one in self.curves:
                x = asked[one.name]
                x = np.where(np.isnan(x), self.moments[one.name][k], x)
                parts.append(one.columns(x, asked[SIDE]))
            found.append(np.hstack(parts) @ self.coefficients)
        return np.array(found) * noise_at(self.regression, rows)

    def draws(self, rows: Any, count: int, rng: np.random.Generator) -> Array:
        """Return draws (count, n) of how far friction is off."""
        learned = self.at(rows)
        moments = rng.integers(len(learned), size=count)
        return np.asarray(rng.normal(size=(count, 1)) * learned[moments])


def features_of(
    regression: BlockRegression, structure: Structure, rows: Any
) -> Mapping[str, Array]:
    """Return the features of rows by name, with the force that a structure predicts there."""
    offered = dict(regression.problem.features(rows))
    if offered and structure:
        columns = Columns(regression.problem, rows).matrix(structure, len(offered[SIDE]))
        offered["fitted force"] = columns @ regression.fit(structure).coefficients
    return offered


class Explorer:
    """What a structure leaves of a problem, and what it may follow."""

    def __init__(self, regression: BlockRegression, structure: Structure) -> None:
        self.regression, self.structure = regression, structure
        problem = regression.problem
        count = len(problem.response)
        self.held_out = regression.held_out(structure)
        self.features = features_of(regression, structure, problem.rows)
        side = self.features[SIDE] if self.features else np.zeros(count)
        both = side if len(np.unique(side)) > 1 else None
        knots = 1 + round(count**0.2)  # the error of a curve through noise is least so
        self.curves: list[Curves] = []
        parts = [np.ones((len(side), 1))]
        for name, values in self.features.items():
            one = Curves.of(name, values, both, knots)
            if one is not None:
                self.curves.append(one)
                parts.append(one.columns(values, side))
        self._widths = [one.shape[1] for one in parts[1:]]
        self._matrix = np.hstack(parts)
        own, near = problem.blocks, problem.excluded
        self._grams = self._gram(own)
        left_out = self._grams if near is own else self._gram(near)
        self._left = self._matrix.T @ self._matrix - left_out

    def _gram(self, masks: Sequence[Mask]) -> Array:
        """Return Gram matrices (b, p, p) of the rows of masks."""
        return np.array([x.T @ x for x in (self._matrix[rows] for rows in masks)])

    def _columns(self, which: Sequence[int], *, plain: bool = False) -> NDArray[np.intp]:
        """Return the columns of some features with the constant first; without signed ones."""
        starts = 1 + np.concatenate([[0], np.cumsum(self._widths)]).astype(int)
        found = [np.zeros(1, dtype=np.intp)]
        for k in which:
            width = self._widths[k] // 2 if plain and self.curves[k].signed else self._widths[k]
            found.append(np.arange(starts[k], starts[k] + width))
        return np.concatenate(found)

    def shares(self, values: Array, groups: Sequence[NDArray[np.intp]]) -> Array:
        """Return shares (g, m) of the held-out squares of values (n, m) by groups of columns."""
        own, excluded = self.regression.problem.blocks, self.regression.problem.excluded
        inside = np.array([self._matrix[rows].T @ values[rows] for rows in own])
        near = np.array([self._matrix[rows].T @ values[rows] for rows in excluded])
        moment = self._matrix.T @ values - near
        centred = values - values.mean(axis=0)
        total = sum(np.sum(centred[rows] ** 2, axis=0) for rows in own)
        squares = sum(np.sum(values[rows] ** 2, axis=0) for rows in own)
        found = []
        for at in groups:
            left = self._left[:, at[:, None], at] + self._ridge(at)
            c = np.linalg.solve(left, moment[:, at])
            error = squares - 2.0 * np.einsum("bpm,bpm->m", c, inside[:, at])
            error += np.einsum("bpm,bpm->m", c, self._grams[:, at[:, None], at] @ c)
            found.append(1.0 - error / np.maximum(total, 1e-300))
        return np.array(found)

    def _ridge(self, own: NDArray[np.intp]) -> Array:
        """Return the ridge of columns; none of the constant."""
        return np.diag(np.where(own == 0, 1e-9, RIDGE)) * len(self._matrix)

    @property
    def _scaled(self) -> Array:
        """What is left, held out, over its scatter (n,)."""
        z, most = self.held_out * self.regression.weights, THRESHOLDS.outlying
        return np.asarray(np.clip(z, -most, most))

    def learned(self) -> Learned | None:
        """Return what features predict of what is left; None where they predict nothing."""
        z = self._scaled[:, None]
        each = self.shares(z, [self._columns([k]) for k in range(len(self.curves))])
        used = [k for k in range(len(self.curves)) if each[k, 0] > 0.0]
        own = self._columns(used)
        if not used or self.shares(z, [own])[0, 0] <= 0.0:
            return None
        x = self._matrix[:, own]
        c = np.linalg.solve(x.T @ x + self._ridge(own), x.T @ z)[1:, 0]
        at = np.linspace(0, len(self.held_out) - 1, STRETCHES).astype(int)
        return Learned(
            regression=self.regression,
            structure=self.structure,
            curves=[self.curves[k] for k in used],
            coefficients=np.asarray(c, dtype=float),
            moments={name: values[at] for name, values in self.features.items()},
        )

    def _rehearsed(self) -> Array:
        """Return held-out residuals over their scatter of records without a pattern (n, m)."""
        regression, problem = self.regression, self.regression.problem
        fitted, count = regression.fit(self.structure).fitted, len(problem.response)
        left = (problem.response - fitted) * regression.weights
        rng = np.random.default_rng(7)
        length = -(-count // (int(problem.stretches.max()) + 1))
        pieces = -(-count // length)
        starts = rng.integers(0, count - length + 1, (REHEARSALS, pieces))
        signs = rng.choice([-1.0, 1.0], (REHEARSALS, pieces, 1))
        drawn = signs * left[starts[:, :, None] + np.arange(length)]
        noise = drawn.reshape(REHEARSALS, -1)[:, :count].T / regression.weights[:, None]
        z = regression.held_out(self.structure, fitted[:, None] + noise)
        return np.asarray(z * regression.weights[:, None])

    def patterns(self) -> tuple[Pattern, ...]:
        """Return what is left and its scatter follow most, each with what stands against chance."""
        problem = self.regression.problem
        error = float(np.sqrt(np.mean(self.held_out**2)))
        size = float(np.sqrt(np.mean(problem.response**2)))
        if not self.curves or error <= THRESHOLDS.rounding * size:
            return ()
        most = THRESHOLDS.outlying
        z = np.clip(self._rehearsed(), -most, most)
        z = np.column_stack([self._scaled, z])
        every = range(len(self.curves))
        shares = [self.shares(z, [self._columns([k]) for k in every])]
        plain = [self._columns([k], plain=True) for k in every]
        shares.append(self.shares(np.sqrt(np.abs(z)), plain))
        top = [one.max(axis=0) for one in shares]
        same = THRESHOLDS.rounding
        chance = np.array([np.mean(one >= one[:, None] - same, axis=1) for one in top])
        least = chance.min(axis=0)
        found = []
        for scatter, own in enumerate(shares):
            best = int(np.argmax(own[:, 0] >= top[scatter][0] - same))
            share = float(top[scatter][0])
            off = 0.0 if scatter else float(np.sqrt(max(share, 0.0))) * error / size
            found.append(
                Pattern(
                    feature=self.curves[best].name,
                    scatter=bool(scatter),
                    share=share,
                    of_force=off,
                    p=float(np.mean(least <= chance[scatter, 0] + 1e-9)),
                    material=share >= THRESHOLDS.pattern_of_scatter
                    if scatter
                    else off >= THRESHOLDS.pattern,
                )
            )
        return tuple(found)
