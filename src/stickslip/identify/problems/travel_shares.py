r"""Shares of laws of travels, by how well they predict settings that are held out.

For Dirichlet weights :math:`d` of the blocks (Bayesian bootstrap) a law has the stacking weight
:math:`\mathrm{softmax}_S(-\tfrac{m}{2} \sum_b d_b R_b(S) + \log \pi_S)`; its *share* is the mean
over the draws (pseudo-BMA+, Yao, Vehtari, Simpson, Gelman 2018).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.special import softmax

from stickslip.identify.bands import Array, PredictionBand, quantile_band
from stickslip.identify.thresholds import THRESHOLDS

LEAST = float(np.finfo(float).eps)
"""Stands for the share of a law that has none beside the others."""
NONE = float(np.finfo(float).tiny)
"""Stands for a prior of 0."""


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
    """Return stacking weights by Bayesian bootstrap of the blocks (s,); none without a prior."""
    count = scores.shape[1]
    draws = np.random.default_rng(1).dirichlet(np.ones(count), THRESHOLDS.draws)
    z = -0.5 * count * (scores @ draws.T) + np.log(np.maximum(priors, NONE))[:, None]
    return np.asarray(softmax(z, axis=0).mean(axis=1))


def with_curve(shares: Array, laws: NDArray[np.bool_]) -> Array:
    """Return shares of which the measured curve has at least a given one."""
    least, curves = THRESHOLDS.curve_share, float(shares[~laws].sum())
    if curves >= least:
        return shares
    found = np.where(laws, shares * (1.0 - least) / max(float(shares[laws].sum()), LEAST), 0.0)
    first = np.flatnonzero(~laws)[0]  # structures are in the order of their scores
    found[~laws] = least * shares[~laws] / curves if curves > LEAST else 0.0
    found[first] += 1.0 - found.sum()
    return np.asarray(found)


def band_of(curves: Array, level: float = 0.95, *, all_along: bool = False) -> PredictionBand:
    """Return quantiles of curves (d, n), a little wider than `level`.

    They are wider by a power: what no draw holds is the more, the rarer.
    """
    level = 1.0 - (1.0 - level) ** THRESHOLDS.rarer
    return quantile_band(curves, level, all_along=all_along, wider=THRESHOLDS.all_along)
