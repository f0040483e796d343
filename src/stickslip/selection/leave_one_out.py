"""Held-out errors of travels: each setting predicted from the others."""

import math
from collections.abc import Callable, Sequence

from stickslip.friction import FrictionLaw
from stickslip.identification import TravelFit, TravelModel, Trial, law_from

FLOOR = 0.05
"""A simpler law may be worse by this share, if that is also within one standard error."""


def held_out_errors(
    law: FrictionLaw,
    trials: Sequence[Trial],
    *,
    fit: TravelFit,
    t_end: float,
    watch: Callable[[int], object] | None = None,
) -> tuple[float, ...]:
    """Return measured less predicted travel [m] of each trial, fitted to the other settings.

    Repeats of a setting are left out together: one would tell the others.
    """
    free = [estimate.path for estimate in fit.estimates]
    start = [estimate.value for estimate in fit.estimates]
    errors: dict[int, float] = {}
    for setting in dict.fromkeys(trial.setting for trial in trials):
        others = [trial for trial in trials if trial.setting != setting]
        fitted = law_from(TravelModel(law, free, t_end, watch), others, start)
        left_out = [i for i, trial in enumerate(trials) if trial.setting == setting]
        predicted = TravelModel(fitted, (), t_end, watch).travels([trials[i] for i in left_out], ())
        errors |= {
            i: trials[i].travel - float(one) for i, one in zip(left_out, predicted, strict=True)
        }
    return tuple(errors[i] for i in range(len(trials)))


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
