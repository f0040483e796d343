"""The verb `select`."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.friction import FrictionLaw, law_type
from stickslip.identification.features.features import by_features
from stickslip.identification.records.route_choice import RouteChoice, RouteName, asked_for
from stickslip.identification.records.settings import RecordSettings
from stickslip.identification.validation import (
    Laws,
    Parameters,
    arguments,
    check_given,
    laws_of,
    refuse_for_travels,
)
from stickslip.mechanisms import Mechanism
from stickslip.selection.candidates import specifications
from stickslip.selection.feature_verdict import FeatureVerdict
from stickslip.selection.features import feature_laws, select_features
from stickslip.selection.record_verdict import RecordVerdict
from stickslip.selection.records import PurposeName, select_records
from stickslip.selection.travels import PLAIN, select_travels
from stickslip.selection.verdict import TravelVerdict

__all__ = ["candidate_names", "select"]


@arguments
def select(
    mechanism: Mechanism,
    laws: Laws | FrictionLaw | type[FrictionLaw] | str | None,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    assumed: Mapping[str, Sequence[str]] | None = None,
    purpose: PurposeName = "simulate",
    horizon: float | None = None,
    route: RouteName | RouteChoice | None = None,
    validate: Measurement | None = None,
    settings: RecordSettings | None = None,
    t_end: float = 10.0,
    progress: Callable[[str, float], object] | None = None,
    executor: Executor | None = None,
) -> TravelVerdict | RecordVerdict | FeatureVerdict:
    """Fit every law to a measurement, compare them on what they have not seen, and name one.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    laws : mapping, sequence or a single law, or None
        The candidates, as instances, types or names; instances bring start values and, for
        travels, assumptions. None stands for the usual ones: for travels Coulomb, viscous, both,
        Stribeck, Dahl and LuGre, for records ten, for features of stick-slip those with a step
        above sliding.
    measurement : Measurement
        One travel or several trials; or records in time of position, velocity and force; or
        friction, measured directly; or one record of the force of a spring that pulls a block.
    vary : str or sequence of str, optional
        ``"friction.*"``, which is all if not given, for the parameters that `fit` fits of each law
        by default, and parameters of the mechanism to fit too, such as ``"mechanism.inertia"``.
    fixed : mapping of str to float, optional
        Values of parameters of the mechanism that are held.
    assumed : mapping of str to sequence of str, optional
        By name of the law, parameters whose values were assumed, not measured, such as those of
        `Rig.assumed`: for travels, they are fitted where no law explains the readings without.
    purpose : {"simulate", "position", "compensate"}
        What the law is for. It sets what is scored: motion over 4 s, motion over 1 s, or the
        friction force.
    horizon : float, optional
        Length of the stretches that are predicted [s], if not that of the purpose.
    route : {"shooting", "force-map", "inverse-dynamics", "features"} or RouteChoice, optional
        How records are fitted, or what `choose_route` returned for them, with its settings; chosen
        by `choose_route` if not given.
    validate : Measurement, optional
        A second record, which no fit sees; each law's error on it is reported.
    settings : RecordSettings, optional
        Segments, starts and seed of fits to records; of these, features have the seed only.
    t_end : float
        Time after which a body counts as stopped [s], for travels.
    progress : callable, optional
        Called with the name of a law and the number of its runs, or the least residual so far; for
        travels also with ``"compiling: ..."`` and the share that is done, if equations have to be
        compiled. For records, False ends the search with the best so far; what was fitted is still
        judged.
    executor : concurrent.futures.Executor, optional
        Fits laws to records at the same time, with the same result; processes, since threads gain
        nothing. A law's residual is then told only when its search ends.

    Returns
    -------
    TravelVerdict, RecordVerdict or FeatureVerdict
        Candidates, the law to use, what the data settle and what they cannot tell.

    Raises
    ------
    InputError
        If there is no law to try, or the measurement cannot decide.
    ConvergenceError
        If no law can be fitted to a record.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, Viscous
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> verdict = select(rig, [Coulomb, Viscous], reading)
    >>> verdict.best.name, [candidate.name for candidate in verdict.candidates]
    ('coulomb', ['coulomb', 'viscous'])
    """
    check_given("select", mechanism, measurement)
    laws = laws_of(laws)
    if measurement.travelled:
        refuse_for_travels(
            "vary, fixed, assumed, t_end and progress",
            purpose=None if purpose == "simulate" else purpose,
            horizon=horizon,
            route=route,
            settings=settings,
        )
        chosen = Parameters.of(mechanism, None, vary, fixed, measurement=measurement)
        _check_travels(chosen.unknown, validate)
        return select_travels(
            chosen.mechanism,
            _kinds(laws),
            measurement,
            assumed=assumed,
            t_end=t_end,
            progress=progress,
        )
    if by_features(measurement, asked_for(route)):
        return select_features(
            mechanism,
            laws,
            measurement,
            vary=vary,
            fixed=fixed,
            purpose=purpose,
            horizon=horizon,
            route=asked_for(route),
            validate=validate,
            settings=settings,
            progress=progress,
            executor=executor,
        )
    return select_records(
        mechanism,
        laws,
        measurement,
        vary=vary,
        fixed=fixed,
        purpose=purpose,
        horizon=horizon,
        route=route,
        validate=validate,
        settings=settings,
        progress=progress,
        executor=executor,
    )


def candidate_names(measurement: Measurement, laws: Laws | None = None) -> list[str]:
    """Return the names of the laws that `select` would compare, as its callbacks call them.

    Parameters
    ----------
    measurement : Measurement
        What was measured.
    laws : mapping or sequence, optional
        The candidates, if not those that such a measurement is compared with by default.

    Examples
    --------
    >>> candidate_names(Measurement(travel=0.2))
    ['coulomb', 'viscous', 'coulomb-viscous', 'stribeck', 'dahl', 'lugre']
    """
    if measurement.travelled:
        return [one if isinstance(one, str) else one.name for one in laws or PLAIN]
    chosen = feature_laws(laws) if by_features(measurement, None) else specifications(laws)
    return [one.name for one in chosen]


def _kinds(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
) -> Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw]] | None:
    """Return laws with the types that names stand for."""
    if laws is None or isinstance(laws, Mapping):
        return laws
    return [law_type(one) if isinstance(one, str) else one for one in laws]


def _check_travels(unknown: Sequence[str], validate: Measurement | None) -> None:
    if validate is not None or unknown:
        raise InputError(
            "travels take no second record, and vary takes no parameters of the mechanism: give"
            " more trials instead."
        )
