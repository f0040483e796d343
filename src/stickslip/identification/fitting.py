"""The verb `fit`."""

from collections.abc import Callable, Mapping, Sequence
from typing import cast

from typing_extensions import TypeVar

from stickslip.errors import ConvergenceError, InputError, UnknownNameError
from stickslip.experiments import Measurement
from stickslip.experiments.preconditions import refuse_faults, with_doubts
from stickslip.friction import FrictionLaw, law_type
from stickslip.identification.features.features import by_features
from stickslip.identification.features.fit import fit_features
from stickslip.identification.precompile import compile_for
from stickslip.identification.records.fitting import fit_record
from stickslip.identification.records.route_choice import RouteChoice, RouteName, asked_for
from stickslip.identification.records.settings import RecordSettings
from stickslip.identification.results import Fit
from stickslip.identification.travels.model import (
    TravelModel,
    Trial,
    standard_errors,
    trials_of,
    under_cycles,
)
from stickslip.identification.travels.result import TravelFit
from stickslip.identification.travels.several_travels import fit_several
from stickslip.identification.travels.single_travel import fit_one
from stickslip.identification.travels.start_values import (
    Start,
    check_known,
    starting_law,
    with_known,
)
from stickslip.identification.validation import check_given, names_of
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters

__all__ = ["check_rest", "fit", "fit_trials", "payable"]

AnyLaw = TypeVar("AnyLaw", bound=FrictionLaw, default=FrictionLaw)
"""The type of law that a fit was given; a name could stand for any."""

PAID_BY_TRAVEL = ("kinetic_coefficient", "viscous_coefficient")
"""Travels tell a level and a slope with speed; what shapes the curve needs a velocity trace."""
PAID_BY_CYCLES = "static_coefficient"
"""Travels of a drive that repeats itself tell the level at rest too: it breaks away every cycle."""


def fit(
    mechanism: Mechanism,
    law: AnyLaw | type[AnyLaw] | str,
    measurement: Measurement,
    *,
    free: str | Sequence[str] | None = None,
    known: Mapping[str, float] | None = None,
    unknown: str | Sequence[str] = (),
    route: RouteName | RouteChoice | None = None,
    settings: RecordSettings | None = None,
    t_end: float = 10.0,
    watch: Callable[[float], object] | None = None,
) -> Fit[AnyLaw]:
    """Fit the free parameters of a law to what was measured.

    Travels are fitted by runs to rest; records in time by simulated segments; friction that was
    measured directly along the measured motion; the force of a spring that pulls a block by its
    features, since no law follows irregular stick-slip sample by sample.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured; trials may override its parameters.
    law : FrictionLaw, type or str
        An instance, whose values are the start and, for parameters not free, the assumption; or a
        type or its name, for which start values are found: in a record, or ordinary ones for
        travels.
    measurement : Measurement
        Travels, records in time, measured friction, or the force of a spring.
    free : str or sequence of str, optional
        Names or paths of the law's parameters to fit. If not given, for travels the first of the
        law's `fit_order` that the number of different trials can pay for; for records all of it.
    known : mapping of str to float, optional
        Values of the law's parameters that are not free, by name, where the law is a type.
    unknown : str or sequence of str
        Parameters of the mechanism that are looked for too, such as ``"inertia"``; for records.
    route : {"shooting", "force-map", "inverse-dynamics", "features"} or RouteChoice, optional
        How records are fitted, or what `choose_route` returned for them, with its settings; chosen
        by `choose_route` if not given.
    settings : RecordSettings, optional
        Segments, starts and seed of fits to records; of these, features have the seed only.
    t_end : float
        Time after which the body counts as stopped [s], for travels.
    watch : callable, optional
        Called with the number of runs so far for travels, for records with the least root mean
        square so far; there, False ends the search with the best so far.

    Returns
    -------
    Fit
        A `TravelFit`, a `RecordFit` or a `FeatureFit`: the fitted law, estimates with intervals,
        predictions.

    Raises
    ------
    InputError
        If the measurement does not serve, as by the errors of `stickslip.check`, or a name is not
        known.
    ConvergenceError
        If no value of the parameters gives what was measured, or a body whose travel to rest was
        measured still moves at ``t_end``.

    Examples
    --------
    >>> from stickslip import Measurement, SpringBlock, Viscous
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> result = fit(rig, Viscous, Measurement(travel=0.20, uncertainty=0.005))
    >>> print(f"{result.law.viscous_coefficient:.2f}")
    5.73
    """
    check_given("fit", mechanism, measurement)
    unknown, free = names_of(unknown), None if free is None else names_of(free)
    given = _known_law(law, known)
    found: Fit
    if by_features(measurement, asked_for(route)):
        _refuse_known(known)
        seed = 0 if settings is None else settings.seed
        found = fit_features(
            mechanism, given, measurement, unknown=unknown, free=free, seed=seed, watch=watch
        )
    elif not measurement.travelled:
        refuse_faults(measurement, mechanism)
        with with_doubts(measurement, mechanism, of=ConvergenceError):
            found = fit_record(
                mechanism,
                given,
                measurement,
                unknown=unknown,
                free=free,
                known=known,
                route=route,
                settings=settings,
                watch=watch,
            )
    elif unknown:
        raise InputError("a few travels cannot tell parameters of the mechanism from friction.")
    else:
        start = with_known(starting_law(given), known) if isinstance(given, type) else given
        trials = trials_of(mechanism, measurement, t_end)
        found = fit_trials(start, trials, free=free, t_end=t_end, watch=watch)
        check_rest(found, t_end)
    return cast("Fit[AnyLaw]", found)  # each of them changes the numbers of a law, not its type


def _known_law(
    law: FrictionLaw | type[FrictionLaw] | str, known: Mapping[str, float] | None
) -> FrictionLaw | type[FrictionLaw]:
    """Return the law that a name stands for; refuse known values that it cannot take."""
    law = law_type(law) if isinstance(law, str) else law
    check_known(law, known)
    return law


def _refuse_known(known: Mapping[str, float] | None) -> None:
    if known:
        raise InputError(
            "known values beside a type of law are for travels and records of motion; for features"
            " give the law with its values, and free those to look for."
        )


def fit_trials(
    law: FrictionLaw,
    trials: Sequence[Trial],
    *,
    free: Sequence[str] | None = None,
    starts: Sequence[Start] | None = None,
    t_end: float = 10.0,
    watch: Callable[[int], object] | None = None,
) -> TravelFit:
    """Fit to trials as `fit` does to a measurement.

    Where there are several, searches begin at `starts`, or at points found by a scan of the
    parameters if none are given.
    """
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
    return fit_several(model, trials, starts)


def check_rest(found: TravelFit, t_end: float) -> None:
    """Refuse a fit to travels to rest with whose law the body still moves at ``t_end``."""
    errors, _ = standard_errors(found.trials)
    TravelModel(found.law, (), t_end).check_rest(found.trials, (), errors)


def payable(law: FrictionLaw, trials: Sequence[Trial]) -> list[str]:
    """Return the paths of the parameters that the trials can pay for, one left over if possible.

    A law without a level at rest of its own is not given one.
    """
    different = len({trial.setting for trial in trials})
    names = [name for name in law.fit_order if name in PAID_BY_TRAVEL] or [law.fit_order[0]]
    if under_cycles(trials) and getattr(law, PAID_BY_CYCLES, None) is not None:
        names.append(PAID_BY_CYCLES)
    return [f"friction.{name}" for name in names[: max(1, different - 1)]]


def _path(law: FrictionLaw, name: str) -> str:
    paths = [path for path, _, _ in parameters(law, "friction")]
    full = name if name.startswith("friction.") else f"friction.{name}"
    if full not in paths:
        raise UnknownNameError(f"parameter of {type(law).__name__}", name, paths)
    return full
