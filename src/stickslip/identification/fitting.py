"""The verb `fit`."""

from collections.abc import Callable, Collection, Mapping, Sequence
from typing import cast

from typing_extensions import TypeVar

from stickslip.errors import ConvergenceError, InputError, UnknownNameError
from stickslip.experiments import Measurement
from stickslip.experiments.preconditions import refuse_faults, with_doubts
from stickslip.friction import FrictionLaw, law_type, specification
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
    starting_law,
    with_known,
)
from stickslip.identification.validation import (
    LAW,
    Parameters,
    arguments,
    check_given,
    names_of,
    refuse_for_travels,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters

__all__ = ["check_rest", "fit", "fit_trials", "payable"]

AnyLaw = TypeVar("AnyLaw", bound=FrictionLaw, default=FrictionLaw)
"""The type of law that a fit was given; a name could stand for any."""

PAID_BY_TRAVEL = ("kinetic_coefficient", "viscous_coefficient")
"""Travels tell a level and a slope with speed; what shapes the curve needs a velocity trace."""
PAID_BY_CYCLES = "static_coefficient"
"""Travels of a drive that repeats itself tell the level at rest too: it breaks away every cycle."""


@arguments
def fit(
    mechanism: Mechanism,
    law: AnyLaw | type[AnyLaw] | str,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    route: RouteName | RouteChoice | None = None,
    settings: RecordSettings | None = None,
    t_end: float = 10.0,
    progress: Callable[[float], object] | None = None,
) -> Fit[AnyLaw]:
    """Fit parameters of a law to what was measured.

    Travels are fitted by runs to rest; records in time by simulated segments; friction that was
    measured directly along the measured motion; the force of a spring that pulls a block by its
    features, since no law follows irregular stick-slip sample by sample.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured; trials may override its parameters.
    law : FrictionLaw, type or str
        An instance, whose values are the start and, for parameters that are not varied, the
        assumption; or a type or a name, for which start values are found: in a record, or ordinary
        ones for travels. Names are those of `select`, such as ``"dahl-exponent"`` for records.
    measurement : Measurement
        Travels, records in time, measured friction, or the force of a spring.
    vary : str or sequence of str, optional
        Parameters to fit, all others are held: full paths such as ``"mechanism.inertia"``, last
        names that are unique, and patterns with ``*``. ``"friction.*"``, which is all if not given,
        stands for what is fitted of the law by default: of records its `fit_order`, of travels as
        much of that as different trials can pay for, of features what shapes a limit cycle. A
        constant offset, which sensors and cables have, is fitted to records unless it is fixed.
        Parameters of the mechanism are for records and features.
    fixed : mapping of str to float, optional
        Values of parameters that are held, of law and mechanism, by the same names.
    route : {"shooting", "force-map", "inverse-dynamics", "features"} or RouteChoice, optional
        How records are fitted, or what `choose_route` returned for them, with its settings; chosen
        by `choose_route` if not given.
    settings : RecordSettings, optional
        Segments, starts and seed of fits to records; of these, features have the seed only.
    t_end : float
        Time after which the body counts as stopped [s], for travels.
    progress : callable, optional
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
    if measurement.travelled:
        refuse_for_travels("vary, fixed, t_end and progress", route=route, settings=settings)
    kind: FrictionLaw | type[FrictionLaw]
    if isinstance(law, str) and measurement.travelled:
        kind = law_type(law)
    elif isinstance(law, str):
        kind, vary = _called(law, vary, fixed or {})
    else:
        kind = law
    found: Fit
    if by_features(measurement, asked_for(route)):
        seed = 0 if settings is None else settings.seed
        found = fit_features(
            mechanism, kind, measurement, vary=vary, fixed=fixed, seed=seed, progress=progress
        )
        return cast("Fit[AnyLaw]", found)
    chosen = Parameters.of(mechanism, kind, vary, fixed, measurement=measurement)
    mechanism, given = chosen.mechanism, chosen.law
    if not measurement.travelled:
        refuse_faults(measurement, mechanism)
        with with_doubts(measurement, mechanism, of=ConvergenceError):
            found = fit_record(
                mechanism,
                given,
                measurement,
                unknown=chosen.unknown,
                free=chosen.free,
                known=chosen.known,
                route=route,
                settings=settings,
                held=chosen.held,
                watch=progress,
            )
    elif chosen.unknown:
        raise InputError("a few travels cannot tell parameters of the mechanism from friction.")
    else:
        known = chosen.known
        start = with_known(starting_law(given), known) if isinstance(given, type) else given
        trials = trials_of(mechanism, measurement, t_end)
        free = _travel_paths(start, trials, chosen.free, known)
        found = fit_trials(start, trials, free=free, t_end=t_end, watch=progress)
        check_rest(found, t_end)
    return cast("Fit[AnyLaw]", found)  # each of them changes the numbers of a law, not its type


def _called(
    name: str, vary: str | Sequence[str] | None, fixed: Collection[str]
) -> tuple[FrictionLaw | type[FrictionLaw], str | Sequence[str] | None]:
    """Return the law that a name stands for, with what is fitted of it put into `vary`."""
    found = specification(name)
    if found.free is None:
        return found.law, vary
    own = [f"friction.{one}" for one in found.free if not {one, f"friction.{one}"} & {*fixed}]
    names = [LAW] if vary is None else names_of(vary)
    return found.law, [path for one in names for path in (own if one == LAW else [one])]


def _travel_paths(
    law: FrictionLaw,
    trials: Sequence[Trial],
    free: Sequence[str] | None,
    fixed: Collection[str],
) -> list[str]:
    """Return the paths of the parameters to fit, with the default of the law where it is asked."""
    found = list(free) if free is not None else [LAW]
    usual = payable(law, trials, fixed) if LAW in found else []
    found = list(dict.fromkeys([*usual, *(path for path in found if path != LAW)]))
    if not found:
        raise InputError(f"there is nothing to fit: name a parameter of {law.title} in vary.")
    return found


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
            f"{len(trials)} travel(s) cannot fix {len(names)} parameters: vary fewer of"
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


def payable(law: FrictionLaw, trials: Sequence[Trial], fixed: Collection[str] = ()) -> list[str]:
    """Return the paths of the parameters that the trials can pay for, one left over if possible.

    A law without a level at rest of its own is not given one; what is fixed, by name, is left out.
    """
    different = len({trial.setting for trial in trials})
    order = [name for name in law.fit_order if name not in fixed]
    names = [name for name in order if name in PAID_BY_TRAVEL] or order[:1]
    standing = PAID_BY_CYCLES not in fixed and getattr(law, PAID_BY_CYCLES, None) is not None
    if under_cycles(trials) and standing:
        names.append(PAID_BY_CYCLES)
    return [f"friction.{name}" for name in names[: max(1, different - 1)]]


def _path(law: FrictionLaw, name: str) -> str:
    paths = [path for path, _, _ in parameters(law, "friction")]
    full = name if name.startswith("friction.") else f"friction.{name}"
    if full not in paths:
        raise UnknownNameError(f"parameter of {type(law).__name__}", name, paths)
    return full
