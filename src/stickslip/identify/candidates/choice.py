"""Which of the fitted laws is named, and which ones held-out blocks do not tell from it.

One rule serves all kinds of measurement: the losses of two laws on the same held-out blocks are
compared as ratios, block by block, and their mean is compared with its own scatter. A law counts by
what it predicts, whatever it contains and wherever its parameters end (decision 0077).
"""

import math
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from stickslip.identify.candidates.cross_validation import CrossValidated
from stickslip.show.formatting import ratio

NEAR = 1.1
"""Standard errors of the mean ratio within which a more usual law is named instead of the best; a
gain in one block alone has exactly one."""
APART = 2.5
"""Standard errors of the mean ratio from which the verdict says that two laws are told apart."""
ALIKE = 0.02
"""Share by which an error may be larger and count as the same, whatever its standard error ..."""
READINGS = 2.0
"""... or so many readings of all, where these are few: what a part that fits them gains."""
MOST = 100.0
"""Largest ratio of losses that counts for a block: one in which a law runs away would make all
others look like scatter."""
LEAST = math.sqrt(np.finfo(float).tiny)
"""Stands for 0 in logarithms and ratios."""


C = TypeVar("C", bound=CrossValidated[Any])


def apart(other: Sequence[float], best: Sequence[float]) -> float:
    """Return how many standard errors the losses of a law lie above those of another.

    The mean logarithm of the ratio of both losses, block by block, over its standard error. The
    mean loss of the better law is added to both: neither a block in which a law happens to be exact
    nor one that is bad for all decides alone. No block counts more than a ratio of `MOST`.

    Examples
    --------
    >>> round(apart([2.0, 4.0, 3.0], [1.0, 1.0, 1.0]), 2), apart([2.0], [1.0])
    (4.54, 0.0)
    """
    if len(best) < 2:
        return 0.0
    level = max(float(np.mean(best)), LEAST)
    ratios = np.log((np.asarray(other) + level) / (np.asarray(best) + level))
    ratios = np.clip(ratios, -math.log(MOST), math.log(MOST))
    error = float(np.std(ratios, ddof=1)) / math.sqrt(len(ratios))
    mean = float(ratios.mean())
    return mean / error if error > 0.0 else math.copysign(math.inf, mean) if mean else 0.0


def errs_more(
    other: CrossValidated[Any],
    best: CrossValidated[Any],
    *,
    errors: float = APART,
    uncertainty: float = 0.0,
) -> bool:
    """Whether a law predicts held-out blocks worse than another: the rule of acceptance."""
    if other.validation is None or best.validation is None or other.score <= uncertainty:
        return False
    share = max(ALIKE, READINGS / max(best.effective, READINGS))
    larger = other.score > (1.0 + share) * best.score
    return larger and apart(other.validation.losses, best.validation.losses) > errors


def as_good(
    other: CrossValidated[Any], best: CrossValidated[Any], *, uncertainty: float = 0.0
) -> bool:
    """Whether held-out blocks do not tell a law from another that may be better."""
    known = other.validation is not None and best.validation is not None
    return known and not errs_more(other, best, uncertainty=uncertainty)


def choose(scored: Sequence[C], *, uncertainty: float = 0.0) -> C:
    """Return the law to name: of those that predict as well as the best, the most usual."""
    best = min(scored, key=lambda c: c.score)
    near = [c for c in scored if not errs_more(c, best, errors=NEAR, uncertainty=uncertainty)]
    return min(near, key=lambda c: (c.parameters, c.score))


def outcome_beside(
    one: CrossValidated[Any], closest: CrossValidated[Any], *, tied: bool, recommended: bool
) -> str:
    """Return what became of a candidate, where one is closest and others may be tied with it."""
    if one.validation is None:
        return one.dropped if one.fit else f"not fitted: {one.dropped}"
    if one.name == closest.name:
        said = "chosen" if recommended else "closest, but not recommended"
        return f"{said}; {one.dropped}" if one.dropped else said
    if tied:
        return "not told apart from the chosen law"
    if closest.name in one.simpler:
        return "not shown to be better than the chosen law, which it contains"
    return f"{ratio(one.score / closest.score)} the error" if closest.score > 0.0 else "worse"


def effective_aic(candidates: Sequence[CrossValidated[Any]]) -> Mapping[str, float]:
    """Return Akaike's criterion by name, residuals counted by their effective number.

    That of the best fit counts for all: criteria of different sample sizes cannot be compared.
    """
    size = min(candidates, key=lambda c: c.residual).effective
    return {
        c.name: size * math.log(max(c.residual**2, LEAST)) + 2.0 * c.parameters for c in candidates
    }
