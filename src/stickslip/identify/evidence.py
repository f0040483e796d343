r"""The evidence of families of structures, by which one is named.

The evidence of a family is the logarithm of its marginal likelihood
(`BlockRegression.marginal`), averaged over its shapes :math:`\theta` by a prior that is even over
their logarithms, less a price for each place in the order from usual to unusual, and for a sum of
terms that no usual law is,

.. math:: E = \log \int p(y | \theta)\, \pi(\theta)\, d\theta - 0.25\,\mathrm{rank}\;[-\,2].

Held-out losses judge how a law predicts what was not measured; the likelihood of all rows tells
few rows apart better (decision 0143).
"""

import math
from collections.abc import Mapping, Sequence

import numpy as np
from scipy.special import logsumexp

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
                    priors[having] *= _spacing(values, math.log(step)) / math.log(step)
        priors[rows] /= priors[rows].sum()
    # half the number of blocks times the difference of scores that such a share of the error makes
    nats = regression.price * len(problem.blocks)
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
