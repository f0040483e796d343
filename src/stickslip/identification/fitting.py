"""The verb `fit`."""

from collections.abc import Callable, Sequence

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments import Measurement
from stickslip.friction import FrictionLaw
from stickslip.identification.compiling import compile_for
from stickslip.identification.exact import fit_one
from stickslip.identification.least_squares import fit_several
from stickslip.identification.results import Fit, TravelFit
from stickslip.identification.starts import starting_law
from stickslip.identification.travel import TravelModel, Trial, trials_of
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters

__all__ = ["fit", "fit_trials", "payable"]

PAID_BY_TRAVEL = ("kinetic_coefficient", "viscous_coefficient")
"""Travels tell a level and a slope with speed; what shapes the curve needs a velocity trace."""


def fit(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    free: Sequence[str] | None = None,
    t_end: float = 10.0,
    watch: Callable[[int], None] | None = None,
) -> Fit:
    """Fit the free parameters of a law to measured travels.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured; trials may override its parameters.
    law : FrictionLaw or type
        An instance, whose values are the start and, for parameters not free, the assumption; or a
        type, for which ordinary values are taken.
    measurement : Measurement
        One travel or several trials.
    free : sequence of str, optional
        Names or paths of the parameters to fit. If not given, the first of the law's `fit_order`
        that the number of different trials can pay for.
    t_end : float
        Time after which the body counts as stopped [s].
    watch : callable, optional
        Called with the number of runs so far.

    Returns
    -------
    Fit
        The fitted law, estimates with intervals, predictions.

    Raises
    ------
    InputError
        If the measurement has no travel, or a name is not a parameter of the law.
    ConvergenceError
        If no value of the parameter gives the measured travel.

    Examples
    --------
    >>> from stickslip import Measurement, SpringBlock, Viscous
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> result = fit(rig, Viscous, Measurement(travel=0.20, uncertainty=0.005))
    >>> print(f"{result.law.viscous_coefficient:.2f}")
    5.73
    """
    start = starting_law(law) if isinstance(law, type) else law
    trials = trials_of(mechanism, measurement)
    return fit_trials(start, trials, free=free, t_end=t_end, watch=watch)


def fit_trials(
    law: FrictionLaw,
    trials: Sequence[Trial],
    *,
    free: Sequence[str] | None = None,
    t_end: float = 10.0,
    watch: Callable[[int], None] | None = None,
) -> TravelFit:
    """Fit to trials as `fit` does to a measurement."""
    names = payable(law, trials) if free is None else [_path(law, name) for name in free]
    if len(names) > len(trials):
        raise InputError(
            f"{len(trials)} travel(s) cannot fix {len(names)} parameters: free fewer of"
            f" {', '.join(names)}, or measure more trials."
        )
    model = TravelModel(law, names, t_end, watch)
    if len(trials) == 1:
        return fit_one(model, trials[0])
    compile_for(trials, [law])
    return fit_several(model, trials)


def payable(law: FrictionLaw, trials: Sequence[Trial]) -> list[str]:
    """Return the paths of the parameters that the trials can pay for, one left over if possible."""
    different = len({trial.setting for trial in trials})
    names = [name for name in law.fit_order if name in PAID_BY_TRAVEL] or [law.fit_order[0]]
    return [f"friction.{name}" for name in names[: max(1, different - 1)]]


def _path(law: FrictionLaw, name: str) -> str:
    paths = [path for path, _, _ in parameters(law, "friction")]
    full = name if name.startswith("friction.") else f"friction.{name}"
    if full not in paths:
        raise UnknownNameError(f"parameter of {type(law).__name__}", name, paths)
    return full
