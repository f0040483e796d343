"""Which of the fitted laws is named: what a richer law has to show, and the choice.

A richer law fits and often predicts a little better by chance. It is *established* over a simpler
law that it contains by two witnesses: an F test on the residuals of the whole record, with their
effective sample size, and held-out blocks in pairs (decision 0024 has the measured error rates).
"""

import math
from collections import defaultdict
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from stickslip.friction import FrictionLaw, containment_of
from stickslip.identification import RecordFit
from stickslip.selection.cross_validation import CrossValidated

NEAR = 0.02
"""Share by which an error may be larger and count as the same, if blocks do not contradict."""
LIKELY = 0.30
"""Share by which the error of the law with the least AIC may be larger than the least error."""
SAME = 1e-3
"""Share of a mean square below which a difference is one of the search, not of the laws."""
LEVEL = 0.99
"""Confidence of the F test: several richer laws are tried at once."""
MATERIAL = 0.05
"""Share of the residual that a richer law must take off where held-out blocks are undecided."""
LEAST = 1e-300
"""Stands for 0 in logarithms and ratios."""


C = TypeVar("C", bound=CrossValidated[Any])


def paired(other: Sequence[float], best: Sequence[float]) -> tuple[float, float]:
    """Return the mean difference of two laws' losses and its standard error, from blocks in pairs.

    Examples
    --------
    >>> paired([2.0, 4.0], [1.0, 1.0])
    (2.0, 1.0)
    """
    gaps = np.subtract(other, best)
    error = float(np.std(gaps, ddof=1)) / math.sqrt(len(gaps)) if len(gaps) > 1 else 0.0
    return float(gaps.mean()), error


def as_good(other: CrossValidated[Any], best: CrossValidated[Any], *, share: float = NEAR) -> bool:
    """Whether another's loss is within one paired standard error and a share of the best's."""
    if other.validation is None or best.validation is None:
        return False
    gap, error = paired(other.validation.losses, best.validation.losses)
    same = SAME * best.score**2
    return bool(gap <= max(error, same) and other.score <= (1.0 + share) * best.score)


def established(
    rich: CrossValidated[Any], simple: CrossValidated[Any], *, uncertainty: float = 0.0
) -> bool:
    """Whether a richer law is shown to hold where a simpler one that it contains does not."""
    assert rich.validation is not None
    assert simple.validation is not None
    if simple.score <= uncertainty or not significant(rich, simple):
        return False
    own, other = rich.validation.losses, simple.validation.losses
    if rich.weak:  # a fit at a bound is no evidence for the law, only its predictions may be
        return beyond_doubt(other, own)
    # Ratios weigh blocks alike: squares of one bad block would outweigh all others.
    gain, error = paired(*(np.log(np.maximum(one, LEAST)).tolist() for one in (other, own)))
    material = rich.residual < (1.0 - MATERIAL) * simple.residual
    return gain > error or (gain >= -error and material)


def significant(
    rich: CrossValidated[Any],
    simple: CrossValidated[Any],
    *,
    level: float = LEVEL,
    effective: float | None = None,
) -> bool:
    """Whether an F test on the whole record is for a richer law, which need not be judged yet."""
    size = rich.effective if effective is None else effective
    return simple.name not in rich.is_simpler and _chance(rich, simple, size) < 1.0 - level


def _chance(rich: CrossValidated[Any], simple: CrossValidated[Any], effective: float) -> float:
    """Return how likely the richer law's gain on the whole record is if the simpler one holds.

    The F test of nested regressions. Residuals are counted by the effective number of the richer
    fit: what a wrong simpler law leaves is correlated because it is wrong.
    """
    from scipy import stats

    extra = max(rich.parameters - simple.parameters, 1)
    freedom = max(effective - rich.parameters, 1.0)
    ratio = min(simple.residual / max(rich.residual, LEAST), 1e100)
    return float(stats.f.sf((ratio**2 - 1.0) * freedom / extra, extra, freedom))


def beyond_doubt(worse: Sequence[float], better: Sequence[float]) -> bool:
    """Whether a law's losses are above another's by more than a 95 % interval of the difference.

    Examples
    --------
    >>> beyond_doubt([2.0, 2.1, 1.9], [1.0, 1.0, 1.0]), beyond_doubt([2.0], [1.0])
    (True, False)
    """
    from scipy import stats

    gap, error = paired(worse, better)
    return len(worse) > 1 and gap > float(stats.t.ppf(0.975, len(worse) - 1)) * error


def effective_aic(candidates: Sequence[CrossValidated[Any]]) -> Mapping[str, float]:
    """Return Akaike's criterion by name, residuals counted by their effective number.

    That of the best fit counts for all: criteria of different sample sizes cannot be compared.
    """
    size = min(candidates, key=lambda c: c.residual).effective
    return {
        c.name: size * math.log(max(c.residual**2, 1e-300)) + 2.0 * c.parameters for c in candidates
    }


def choose(scored: Sequence[C], *, uncertainty: float = 0.0) -> C:
    """Return the law to name: the best of those established over every simpler one they contain.

    Of the established laws, the one with the least AIC (effective sample size) where held-out
    blocks do not speak against it: within one paired standard error and 30 % of the least error.
    If they do, those within one paired standard error and 2 % of the least error count as equal,
    and one without an objection, then the one with the fewest parameters, is taken.
    """
    shown = [
        c
        for c in scored
        if not _simpler_of(c, scored) or shown_over_simpler(c, scored, uncertainty=uncertainty)
    ]
    least = min(shown, key=lambda c: c.score)
    criteria = effective_aic(shown)
    likely = min(shown, key=lambda c: criteria[c.name])
    if as_good(likely, least, share=LIKELY):
        return likely
    near = [c for c in shown if as_good(c, least)]
    return min(near, key=lambda c: (bool(c.dropped), c.parameters, c.score))


def shown_over_simpler(rich: C, scored: Sequence[C], *, uncertainty: float = 0.0) -> bool:
    """Whether a law contains simpler ones and is established over each of them."""
    simpler = _simpler_of(rich, scored)
    return bool(simpler) and all(established(rich, c, uncertainty=uncertainty) for c in simpler)


def _simpler_of(rich: C, scored: Sequence[C]) -> list[C]:
    """Return the candidates that a law contains."""
    return [c for c in scored if c.name in rich.simpler]


def reduces_to(fit: RecordFit, simpler: type[FrictionLaw]) -> bool:
    """Whether a fitted law is, at its values, a simpler law that it contains.

    Examples
    --------
    >>> from stickslip import Axis, CoulombViscous, Measurement, QuadraticDrag, fit
    >>> v = np.linspace(0.1, 1.0, 40)
    >>> table = Measurement(velocity=v, friction=2.0 + 3.0 * np.sqrt(v))
    >>> found = fit(Axis(inertia=1.0), QuadraticDrag, table)
    >>> reduces_to(found, CoulombViscous)  # no drag that falls off: it went to 0
    True
    """
    one = containment_of(type(fit.law), simpler)
    if one is None:
        return False
    if any(fit.at_bounds.get(f"friction.{name}") != "upper" for name in one.limits):
        return False
    alike: dict[str, list[float]] = defaultdict(list)
    for name, source in one.values.items():
        value = getattr(fit.law, name)
        if value is None:  # a level that follows others, which are compared
            continue
        alike[source if isinstance(source, str) else name].append(float(value))
        if not isinstance(source, str):
            alike[name].append(float(source))
    sizes = [max(abs(x) for x in values) for values in alike.values()]
    spread = [max(values) - min(values) for values in alike.values()]
    return all(gap <= 1e-6 * size for gap, size in zip(spread, sizes, strict=True))
