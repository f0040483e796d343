r"""The comparison: shares of structures, the set that is not told apart, the name.

The one statistic is the score by block of `search.block_scores`. For Dirichlet weights
:math:`d` of the blocks (Bayesian bootstrap) a structure has the stacking weight
:math:`\mathrm{softmax}_S(-\tfrac{m}{2} \sum_b d_b R_b(S) + \log \pi_S)`; its *share* is the mean
over the draws (pseudo-BMA+, Yao, Vehtari, Simpson, Gelman 2018). :math:`\pi_S` gives every family
the same prior, spread evenly over the logarithms of its shapes. The curve as measured, which is no
law, has at least the share `Problem.curve_share`.

The named family has the most *evidence* (`stickslip.identify.evidence`); those against which the
odds are less than `Thresholds.odds` are *not told apart* from it. On dense records everything is
significant: there the evidence is the logarithm of the held-out error, when each parameter has to
save a share of it (`Thresholds.material`), times the number of blocks.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import softmax

from stickslip.identify.candidates import DIGITS
from stickslip.identify.evidence import evidence_of, price_of, priors_of, prudent_choice
from stickslip.identify.problem import Array, Family, Mask, Structure
from stickslip.identify.search import Search, block_scores
from stickslip.identify.thresholds import THRESHOLDS

LEAST = float(np.finfo(float).eps)
"""Stands for the share of a structure that has none beside the others."""
NONE = float(np.finfo(float).tiny)
"""Stands for a prior of 0, as one is that many parameters cost all, or less by rounding."""


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
    priors = priors_of(search.regression, structures)
    shares = stacked_shares(scores, priors)
    if problem.worth:
        shares = _with_likelihood(search, shares, priors)
    curve_share = float(shares[~laws].sum())
    shares = with_curve(shares, laws, problem.curve_share)
    best_of: dict[Family, int] = {}
    for i in np.flatnonzero(laws):
        best_of.setdefault(families[i], int(i))
    top = min(best_of.values())
    if problem.worth:
        evidence = evidence_of(search.regression, structures, best_of)
        named = prudent_choice(search.regression, structures, evidence)
    else:
        evidence = _material_evidence(search, losses, best_of)
        # terms of one span differ by rounding
        named = min(
            evidence, key=lambda i: (-round(evidence[i], DIGITS), problem.rank(structures[i]), i)
        )
    least = max(evidence.values()) - math.log(THRESHOLDS.odds)
    near = {i for i, e in evidence.items() if e >= least}
    if not problem.worth:
        # terms that are not needed cost little on dense rows: laws with more are no rivals
        parts, count = set(families[named]), problem.parameters(structures[named])
        near = {
            i
            for i in near
            if i == named
            or (problem.parameters(structures[i]) <= count and not parts < set(families[i]))
        }
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


def _paired(difference: Array) -> float:
    """Return the mean of differences by block (b,) over its standard error."""
    error = float(np.std(difference, ddof=1)) / math.sqrt(len(difference))
    return float(np.mean(difference)) / (error + 1e-9)


def stacked_shares(scores: Array, priors: Array) -> Array:
    """Return stacking weights by Bayesian bootstrap of the blocks (s,); none without a prior."""
    count = scores.shape[1]
    draws = np.random.default_rng(1).dirichlet(np.ones(count), THRESHOLDS.draws)
    z = -0.5 * count * (scores @ draws.T) + np.log(np.maximum(priors, NONE))[:, None]
    return np.asarray(softmax(z, axis=0).mean(axis=1))


def _material_evidence(
    search: Search, losses: Array, best_of: Mapping[Family, int]
) -> dict[int, float]:
    """Return the evidence of families whose rows are dense, by the place of their best structures.

    It is less the logarithm of the held-out error for each block, each parameter at its price; an
    error that is less than rounding is rounding.
    """
    problem, price, blocks = search.problem, search.regression.price, losses.shape[1]
    structures = search.structures
    weighted = search.regression.weights * problem.response
    least = (THRESHOLDS.rounding * float(np.max(np.abs(weighted)))) ** 2
    error = 0.5 * np.log(losses.mean(axis=1) + least)
    count = np.array([problem.parameters(one) for one in structures])
    value = -blocks * (error + price * count)
    places: dict[Family, int] = {}
    for i in np.argsort(-np.round(value, DIGITS), kind="stable").tolist():
        family = problem.family(structures[i])
        if family in best_of:
            places.setdefault(family, i)
    return {i: float(value[i]) for i in places.values()}


def _with_likelihood(search: Search, shares: Array, priors: Array) -> Array:
    """Return the geometric means of shares (s,) and posterior probabilities, in sum 1."""
    problem, structures = search.problem, search.structures
    prices = np.array([price_of(problem, structure) for structure in structures])
    log = search.regression.marginal(structures) + np.log(priors) - prices
    return np.asarray(softmax(0.5 * (np.log(shares + LEAST) + log)))


def with_curve(shares: Array, laws: Mask, least: float = THRESHOLDS.curve_share) -> Array:
    """Return shares of which the measured curves have at least a given one."""
    curves = float(shares[~laws].sum())
    if curves >= least:
        return shares
    found = np.where(laws, shares * (1.0 - least) / max(float(shares[laws].sum()), LEAST), 0.0)
    first = np.flatnonzero(~laws)[0]  # structures are in the order of their scores
    found[~laws] = least * shares[~laws] / curves if curves > LEAST else 0.0
    found[first] += 1.0 - found.sum()
    return np.asarray(found)


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
