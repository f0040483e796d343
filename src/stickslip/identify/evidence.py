r"""The evidence of families of structures, by which one is named.

The evidence of a family is the logarithm of its marginal likelihood
(`BlockRegression.marginal`), averaged over its shapes :math:`\theta` by a prior that is even over
their logarithms, less a price for each place in the order from usual to unusual, and for a sum of
terms that no usual law is,

.. math:: E = \log \int p(y | \theta)\, \pi(\theta)\, d\theta - 0.25\,\mathrm{rank}\;[-\,2].

Held-out losses judge how a law predicts what was not measured; the likelihood of all rows tells
few rows apart better (decision 0143).

The family that is named is not simply the most probable: a law of few parameters that does not
pass through the readings may be somewhat more probable than one that does, and predicts badly
where that is true. With probabilities :math:`p_k \propto e^{E_k}` and curves :math:`f_k` of the
families, the named one has the largest

.. math:: E_i - \tfrac12 \sum_k p_k \sum_{\mathrm{rows}} w^2 (f_i - f_k)^2,

the evidence less what is lost, on average, where another holds.
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import logsumexp, softmax

from stickslip.identify.candidates import DIGITS
from stickslip.identify.problem import Array, Family, Problem, Structure
from stickslip.identify.regression import BlockRegression
from stickslip.identify.thresholds import THRESHOLDS


def evidence_of(
    regression: BlockRegression, structures: Sequence[Structure], best_of: Mapping[Family, int]
) -> dict[int, float]:
    """Return the evidence of families, by the place of their best structures."""
    problem = regression.problem
    members: dict[Family, list[int]] = {family: [] for family in best_of}
    for i, structure in enumerate(structures):
        members.get(problem.family(structure), []).append(i)
    prior = np.log(priors_of(regression, structures))
    evidence = {}
    for family, own in members.items():
        log = regression.marginal([structures[i] for i in own])
        each = log + prior[own] - float(logsumexp(prior[own]))
        evidence[best_of[family]] = float(logsumexp(each)) - price_of(problem, structures[own[0]])
    return evidence


def prudent_choice(
    regression: BlockRegression, structures: Sequence[Structure], evidence: Mapping[int, float]
) -> int:
    """Return the place of the structure with the most evidence less its mean loss elsewhere."""
    likely = max(evidence.values()) - math.log(THRESHOLDS.odds)
    places = [i for i, value in evidence.items() if value >= likely]
    fits = [regression.fit(structures[i]) for i in places]
    curves = np.array([regression.weights * fit.fitted for fit in fits])
    values = np.array([evidence[i] for i in places])
    share = softmax(values)
    apart = np.sum((curves[:, None] - curves) ** 2, axis=2)
    worth = np.round(values - 0.5 * apart @ share, DIGITS)
    rank = [regression.problem.rank(structures[i]) for i in places]
    # terms of one span differ by rounding
    return min(zip((-worth).tolist(), rank, places, strict=True))[2]


def price_of(problem: Problem, structure: Structure) -> float:
    """Return what a structure costs for being unusual."""
    usual = THRESHOLDS.unusual * problem.rank(structure)
    return usual if problem.is_usual(structure) else usual + THRESHOLDS.price


def priors_of(regression: BlockRegression, structures: Sequence[Structure]) -> Array:
    """Return prior weights (s,): alike for all families, even over the logarithms of shapes."""
    problem = regression.problem
    members: dict[Family, list[int]] = {}
    for i, structure in enumerate(structures):
        members.setdefault(problem.family(structure), []).append(i)
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
                    priors[having] *= _spacing(values, math.log(step))
        priors[rows] /= priors[rows].sum()
    # half the number of blocks times the difference of scores that such a share of the error makes
    nats = regression.price * len(problem.blocks)
    count = np.array([problem.parameters(one) for one in structures])
    return np.asarray(priors * np.exp(-nats * (count - count.min())))


def _spacing(values: Array, step: float) -> Array:
    """Return for each value half the distance between its neighbours, over a step up or down.

    Examples
    --------
    >>> _spacing(np.log([1.0, 0.8, 0.64]), math.log(0.8)).round(9).tolist()
    [1.0, 1.0, 1.0]
    """
    known, at = np.unique(np.round(values, 12), return_inverse=True)
    if len(known) < 2:
        return np.ones(len(values))
    gap = np.diff(known) / abs(step)
    side = np.full(1, min(1.0, float(gap.max())))
    ends = np.concatenate([side, gap, side])
    return np.asarray(0.5 * (ends[:-1] + ends[1:])[at])
