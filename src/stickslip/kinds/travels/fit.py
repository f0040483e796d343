"""Fits a law to travels: distances to rest, or per cycle of a drive."""

import math
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence

from stickslip.errors import InputError, UnknownNameError
from stickslip.experiments import Measurement, refuse_faults
from stickslip.formatting import count, joined, number
from stickslip.friction import FrictionLaw
from stickslip.identification import (
    LAW,
    Parameters,
    TravelModel,
    Trial,
    is_rig,
    standard_errors,
    starting_law,
    trials_of,
    under_cycles,
    with_known,
)
from stickslip.identify import Start, nuisances_of
from stickslip.kinds.travels.result import TravelFit
from stickslip.kinds.travels.search import fit_readings
from stickslip.mechanisms import Mechanism
from stickslip.quantities import fields_of, parameters
from stickslip.solver import prepare

TOLD = ("level", "slope")
"""Scales of what travels tell, a level and a slope with speed: the rest needs a velocity trace."""


def fit_travels(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    t_end: float = 10.0,
    progress: Callable[[float], object] | None = None,
) -> TravelFit:
    """Fit a law to travels by runs to rest; arguments and errors as in `stickslip.fit`.

    Examples
    --------
    >>> from stickslip import SpringBlock, Viscous
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> found = fit_travels(rig, Viscous, Measurement(travel=0.20, uncertainty=0.005))
    >>> print(f"{found.law.viscous_coefficient:.2f}")
    5.73
    """
    chosen = Parameters.of(mechanism, law, vary, fixed, measurement=measurement)
    given = chosen.law
    start = with_known(starting_law(given), chosen.known) if isinstance(given, type) else given
    trials = trials_of(chosen.mechanism, measurement, t_end)
    refuse_faults(measurement, mechanism)
    check_rig(trials, chosen.unknown)
    free = _travel_paths(start, trials, chosen.free, chosen.known, chosen.unknown)
    nuisances = []
    if isinstance(given, type) and not chosen.unknown and len({t.setting for t in trials}) > 1:
        nuisances = nuisances_of(given, free, chosen.known)
    found = fit_trials(start, trials, free=free, nuisances=nuisances, t_end=t_end, watch=progress)
    check_rest(found, t_end)
    return found


def _travel_paths(
    law: FrictionLaw,
    trials: Sequence[Trial],
    free: Sequence[str] | None,
    fixed: Collection[str],
    rig: Sequence[str] = (),
) -> list[str]:
    """Return the paths of the parameters to fit, with the default of the law where it is asked."""
    found = list(free) if free is not None else [LAW]
    usual = payable(law, trials, fixed, rig) if LAW in found else []
    return list(dict.fromkeys([*usual, *(path for path in found if path != LAW), *rig]))


def check_rig(trials: Sequence[Trial], rig: Sequence[str]) -> None:
    """Refuse parameters of the mechanism that travels cannot tell, or that a trial has set."""
    if not rig:
        return
    settings = len({trial.setting for trial in trials})
    if settings <= len(rig) + 1:
        needed = f"{joined(list(rig))} and a level of friction"
        raise InputError(
            f"travels of {count(settings, 'setting')} cannot determine {needed}: that takes at"
            f" least {len(rig) + 2} different settings. Measure more, or vary fewer."
        )
    known = {
        path: (one, value) for path, one, value in parameters(trials[0].mechanism, "mechanism")
    }
    for path in rig:
        if path not in known:
            raise InputError(
                f"{path} has no value from which a search could begin: give it one in the rig file."
            )
        quantity, value = known[path]
        if value == 0.0 and (quantity.low == 0.0 or quantity.above is not None):
            raise InputError(
                f"{path} ({quantity.symbol}) is 0 {quantity.unit}, from which no search can begin:"
                " give a value of the right order of magnitude."
            )
        values = {dict(_values(trial))[path] for trial in trials}
        if len(values) > 1:
            raise InputError(
                f"trials set {path} themselves, from {number(min(values))} to"
                f" {number(max(values))} {quantity.unit}: it cannot be fitted as one value for all"
                " of them. Leave these values out, or do not vary it."
            )
        if any(path in trial.doubts or path in trial.shared for trial in trials):
            raise InputError(
                f"{path} is fitted, and an uncertainty was stated for it: leave one of both out."
            )


def _values(trial: Trial) -> Iterator[tuple[str, float]]:
    return ((path, value) for path, _, value in parameters(trial.mechanism, "mechanism"))


def fit_trials(
    law: FrictionLaw,
    trials: Sequence[Trial],
    *,
    free: Sequence[str] | None = None,
    starts: Sequence[Start] | None = None,
    nuisances: Sequence[str] = (),
    thorough: bool = False,
    t_end: float = 10.0,
    watch: Callable[[int], object] | None = None,
) -> TravelFit:
    """Fit to trials as `fit` does to a measurement.

    Where there are several, searches begin at `starts`, or at points found by a scan of the
    parameters if none are given.
    """
    names = (
        payable(law, trials)
        if free is None
        else [name if is_rig(name) else _path(law, name) for name in free]
    )
    if not names:
        raise InputError(f"there is nothing to fit: name a parameter of {law.title} in vary.")
    if len(names) > len(trials):
        raise InputError(
            f"{count(len(trials), 'travel')} cannot determine {len(names)} parameters: vary fewer"
            f" of {', '.join(names)}, or measure more trials."
        )
    model = TravelModel(law, names, t_end, watch)
    return fit_readings(model, trials, starts, nuisances, thorough=thorough)


def check_rest(fit: TravelFit, t_end: float) -> None:
    """Refuse a fit to travels to rest with whose law the body still moves at ``t_end``."""
    errors, stated = standard_errors(fit.trials)
    # the last digit that is written down is no bound on the error of a reading
    scale = 1.0 if stated or not fit.freedom > 0 else max(math.sqrt(fit.variance[0]), 1.0)
    TravelModel(fit.law, (), t_end).check_rest(fit.trials, (), scale * errors)


def payable(
    law: FrictionLaw,
    trials: Sequence[Trial],
    fixed: Collection[str] = (),
    rig: Collection[str] = (),
) -> list[str]:
    """Return the paths of the parameters that the trials can pay for, one left over if possible.

    A law without a level at rest of its own is not given one; what is fixed, by name, is left out.
    """
    different = len({trial.setting for trial in trials})
    known = fields_of(type(law))
    order = [name for name in law.fit_order if name not in fixed]
    sliding = [name for name in order if known[name].at_least is None]
    names = [name for name in sliding if known[name].scale in TOLD] or order[:1]
    if under_cycles(trials):  # it breaks away in every cycle, which tells the level at rest too
        names += [
            name
            for name in known
            if known[name].at_least is not None
            and known[name].scale == "level"
            and name not in fixed
            and getattr(law, name) is not None
        ]
    return [f"friction.{name}" for name in names[: max(1, different - 1 - len(rig))]]


def _path(law: FrictionLaw, name: str) -> str:
    paths = [path for path, _, _ in parameters(law, "friction")]
    full = name if name.startswith("friction.") else f"friction.{name}"
    if full not in paths:
        raise UnknownNameError(f"parameter of {type(law).__name__}", name, paths)
    return full


def compile_for(trials: Sequence[Trial], laws: Iterable[FrictionLaw]) -> None:
    """Compile the laws whose fit to trials takes so many slow runs that it is worth the wait.

    These are the laws with bristles, if there are several trials, and all laws if the trials are
    of many cycles.
    """
    cycles = under_cycles(trials)
    slow = [law for law in laws if cycles or law.states]
    if len(trials) < 2:
        return
    for law in slow:
        for trial in trials:
            prepare(trial.mechanism, law)
