"""Held-out scores of travels: each trial predicted from the others."""

import math
from collections.abc import Callable, Sequence

from stickslip.friction import FrictionLaw
from stickslip.identification.fitting import fit_trials
from stickslip.identification.travel import TravelModel, Trial

__all__ = ["held_out_errors", "root_mean_square", "simpler_within_doubt"]

FLOOR = 0.05
"""A simpler law may be worse by this share, if that is also within one standard error."""


def held_out_errors(
    law: FrictionLaw,
    trials: Sequence[Trial],
    *,
    free: Sequence[str],
    t_end: float,
    watch: Callable[[int], object] | None = None,
) -> tuple[float, ...]:
    """Return measured less predicted travel [m] of each trial, fitted to the others."""
    errors = []
    for left_out, trial in enumerate(trials):
        others = [other for i, other in enumerate(trials) if i != left_out]
        fitted = fit_trials(law, others, free=free, t_end=t_end, watch=watch).law
        errors.append(trial.travel - TravelModel(fitted, (), t_end, watch).travel(trial, ()))
    return tuple(errors)


def root_mean_square(errors: Sequence[float]) -> tuple[float, float]:
    """Return the root mean square of errors and its standard error.

    Examples
    --------
    >>> root_mean_square([3.0, 3.0])
    (3.0, 0.0)
    """
    squares = [error * error for error in errors]
    mean = sum(squares) / len(squares)
    if mean == 0.0 or len(squares) < 2:
        return math.sqrt(mean), math.inf if len(squares) < 2 else 0.0
    variance = sum((square - mean) ** 2 for square in squares) / (len(squares) - 1)
    return math.sqrt(mean), math.sqrt(variance / len(squares)) / (2.0 * math.sqrt(mean))


def simpler_within_doubt(simple: Sequence[float], best: Sequence[float]) -> bool:
    """Whether the simpler law's loss is within one paired standard error and within the floor."""
    losses = [s * s - b * b for s, b in zip(simple, best, strict=True)]
    mean = sum(losses) / len(losses)
    variance = sum((loss - mean) ** 2 for loss in losses) / max(len(losses) - 1, 1)
    paired = math.sqrt(variance / len(losses))
    near = root_mean_square(simple)[0] <= (1.0 + FLOOR) * root_mean_square(best)[0]
    return mean <= paired and near
