r"""The comparison: shares of structures, the set that is not told apart, the name.

The one statistic is the score by block of `search.block_scores`. For Dirichlet weights
:math:`d` of the blocks (Bayesian bootstrap) a structure has the stacking weight
:math:`\mathrm{softmax}_S(-\tfrac{m}{2} \sum_b d_b R_b(S) + \log \pi_S)`; its *share* is the mean
over the draws (pseudo-BMA+, Yao, Vehtari, Simpson, Gelman 2018). :math:`\pi_S` gives every family
the same prior, spread evenly over the logarithms of its shapes. The curve as measured, which is no
law, has at least the share `Thresholds.curve_share`.

A family is named by its *evidence*: the mean of the log share, which blocks tell, and of the log
likelihood of the :math:`n` independent rows, which fewer rows tell apart better, less a price for
each of its :math:`k` parameters and its place in the order from usual to unusual,

.. math:: E = \tfrac12 \log p - \tfrac{n}{4} \log \sum_i (w_i e_i)^2 - 2\,k - 0.1\,\mathrm{rank}.

The named family has the most; those within `Thresholds.tie` of it are *not told apart* from it
(of 450 tables, the one law of a set without others was right 125 times of 126). On dense records
everything is significant: there a family is not told apart either whose held-out error is within
`Thresholds.material` of the best, and the name is that of the fewest parameters among these.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from stickslip.identify.problem import Array, Family, Mask, Structure
from stickslip.identify.search import Search, block_scores
from stickslip.identify.thresholds import THRESHOLDS


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Comparison:
    """Shares of structures, and which families are not told apart."""

    structures: Sequence[Structure]
    """All structures with physical coefficients, the best first."""
    families: Sequence[Family]
    """Their families (s,)."""
    scores: Array
    """Their scores by block (s, b)."""
    shares: Array
    """Their shares of the ensemble (s,), in sum 1."""
    best: Structure
    """The law that predicts best."""
    set: Sequence[Structure]
    """The best structure of each family that is not told apart from the named one."""
    named: Structure
    """The best structure of the named family."""
    evidence: Mapping[Structure, float]
    """Evidence of the best structure of each family, the most first."""
    curve: Structure
    """The best measured curve."""
    curve_share: float
    """Share of the measured curve before it got its least: near 1 where no law explains."""
    curve_gain: float
    """Mean score of the best law less that of the curve, over its paired standard error."""
    curve_ratio: float
    """Held-out error of the best law over that of the curve."""

    def share_of(self, family: Family) -> float:
        """Return the share of all structures of a family."""
        return float(sum(p for own, p in zip(self.families, self.shares, strict=True)
                         if own == family))  # fmt: skip


def compare(search: Search) -> Comparison:
    """Compare what a search met."""
    problem = search.problem
    structures = search.structures
    families = [problem.family(one) for one in structures]
    losses = np.array([search.regression.losses_of[one] for one in structures])
    scores = block_scores(losses)
    laws = np.array([problem.is_law(one) for one in structures])
    shares = stacked_shares(scores, _priors(search, structures, families))
    curve_share = float(shares[~laws].sum())
    shares = with_curve(shares, laws)
    best_of: dict[Family, int] = {}
    for i in np.flatnonzero(laws):
        best_of.setdefault(families[i], int(i))
    top = min(best_of.values())
    if not problem.independent:
        error = np.log(np.sqrt(losses.mean(axis=1)) + 1e-300)
        price = search.regression.price
        value = {i: round(error[i] + price * problem.parameters(structures[i]), 9)
                 for i in np.flatnonzero(laws).tolist()}  # fmt: skip
        named = min(value, key=lambda i: (value[i], problem.rank(structures[i]), i))
        best_of[families[named]] = named
    evidence = _evidence(search, structures, families, [*best_of.values()], shares)
    if problem.independent:
        ranked = sorted(evidence, key=lambda i: (-round(evidence[i], 9), i))
        named = next((i for i in ranked if _is_identified(search, structures[i])), ranked[0])
    # few rows tell little: the evidence of k parameters from n rows is that much surer
    rows = len(problem.response)
    spare = max(rows - problem.parameters(structures[named]) - 1, 0.5)
    least = evidence[named] - THRESHOLDS.tie * (rows / spare)
    near = {i for i, e in evidence.items() if e >= least}
    curve = int(np.flatnonzero(~laws)[0])
    return Comparison(
        structures=structures,
        families=families,
        scores=scores,
        shares=shares,
        best=structures[top],
        set=[structures[i] for i in sorted(near, key=lambda i: (i != named, -evidence[i], i))],
        named=structures[named],
        evidence={
            structures[i]: evidence[i]
            for i in sorted(evidence, key=lambda i: (i != named, -evidence[i], i))
        },
        curve=structures[curve],
        curve_share=curve_share,
        curve_gain=_paired(scores[top] - scores[curve]),
        curve_ratio=float(np.sqrt(losses[top].mean() / max(losses[curve].mean(), 1e-300))),
    )


def _is_identified(search: Search, structure: Structure) -> bool:
    """Return whether the parts and faults of a structure stand above their errors."""
    fit, at = search.regression.fit(structure), 0
    error = np.sqrt(np.maximum(np.diag(fit.covariance), 0.0))
    for column in structure:
        size = search.regression.columns.of(column).shape[1]
        own = slice(at, at + size)
        at += size
        role = search.problem.terms[column[0]].role
        times = {"law": THRESHOLDS.identified_part, "fault": THRESHOLDS.identified}.get(role, 0.0)
        if np.all(np.abs(fit.coefficients[own]) < times * error[own]):
            return False
    return True


def _paired(difference: Array) -> float:
    """Return the mean of differences by block (b,) over its standard error."""
    error = float(np.std(difference, ddof=1)) / math.sqrt(len(difference))
    return float(np.mean(difference)) / (error + 1e-9)


def _evidence(
    search: Search,
    structures: Sequence[Structure],
    families: Sequence[Family],
    best: Sequence[int],
    shares: Array,
) -> dict[int, float]:
    """Return the evidence of families, by the place of their best structures."""
    problem, regression = search.problem, search.regression
    share: dict[Family, float] = {}
    for own, p in zip(families, shares, strict=True):
        share[own] = share.get(own, 0.0) + float(p)
    # rows of a stretch are not independent: each stretch counts
    rows = len(problem.response)
    count = rows if problem.independent else int(problem.stretches.max()) + 1
    found = {}
    for i in best:
        one = structures[i]
        left = regression.weights * (problem.response - regression.fit(one).fitted)
        likelihood = -0.5 * count * math.log(float(left @ left) / rows + 1e-30)
        found[i] = (
            0.5 * math.log(share[families[i]] + THRESHOLDS.least_share)
            + 0.5 * likelihood
            - THRESHOLDS.price * problem.parameters(one)
            - THRESHOLDS.unusual * problem.rank(one)
        )
    return found


def stacked_shares(scores: Array, priors: Array) -> Array:
    """Return stacking weights by Bayesian bootstrap of the blocks (s,)."""
    count = scores.shape[1]
    draws = np.random.default_rng(1).dirichlet(np.ones(count), THRESHOLDS.draws)
    z = -0.5 * count * (scores @ draws.T) + np.log(priors)[:, None]
    e = np.exp(z - z.max(axis=0))
    return np.asarray((e / e.sum(axis=0)).mean(axis=1))


def with_curve(shares: Array, laws: Mask) -> Array:
    """Return shares of which the measured curve has at least `Thresholds.curve_share`."""
    least = THRESHOLDS.curve_share
    own = float(shares[~laws].sum())
    if own >= least:
        return shares
    shares = np.where(laws, shares * (1.0 - least) / max(float(shares[laws].sum()), 1e-300), 0.0)
    first = np.flatnonzero(~laws)[0]  # structures are in the order of their scores
    shares[first] = least
    return shares


def _priors(search: Search, structures: Sequence[Structure], families: Sequence[Family]) -> Array:
    """Return prior weights (s,): alike for all families, even over the logarithms of shapes."""
    problem = search.problem
    members: dict[Family, list[int]] = {}
    for i, own in enumerate(families):
        members.setdefault(own, []).append(i)
    priors = np.ones(len(structures))
    for rows in members.values():
        for k, (name, _) in enumerate(structures[rows[0]]):
            for entry, step in enumerate(problem.terms[name].steps):
                if step == 1.0:
                    continue
                # shapes without an entry have its usual value, and those of 0 no memory
                having = [i for i in rows if any(structures[i][k][1][entry : entry + 1])]
                if having:
                    values = np.log(np.abs([structures[i][k][1][entry] for i in having]))
                    priors[having] *= _spacing(values, math.log(step)) / math.log(step)
        priors[rows] /= priors[rows].sum()
    # half the number of blocks times the difference of scores that such a share of the error makes
    nats = search.regression.price * len(problem.blocks)
    count = np.array([problem.parameters(one) for one in structures])
    return np.asarray(priors * np.exp(-nats * (count - count.min())))


def _spacing(values: Array, step: float) -> Array:
    """Return for each value half the distance between those that are next to it."""
    known, at = np.unique(np.round(values, 12), return_inverse=True)
    if len(known) < 2:
        return np.full(len(values), step)
    gap = np.diff(known)
    side = np.full(1, min(step, float(gap.max())))
    ends = np.concatenate([side, gap, side])
    return np.asarray(0.5 * (ends[:-1] + ends[1:])[at])


def family_members(comparison: Comparison, family: Family) -> Mapping[Structure, float]:
    """Return the structures of a family with their shares, in sum 1."""
    found = {
        one: float(share)
        for one, own, share in zip(
            comparison.structures, comparison.families, comparison.shares, strict=True
        )
        if own == family
    }
    total = sum(found.values())
    if not total > 0.0:
        mean = {one: math.exp(-0.5 * float(comparison.scores[i].sum()
                                           - comparison.scores[0].sum()))
                for i, one in enumerate(comparison.structures) if one in found}  # fmt: skip
        found, total = mean, sum(mean.values())
    return {one: share / max(total, 1e-300) for one, share in found.items() if share > 0.0}
