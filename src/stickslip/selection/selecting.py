"""The verb `select`."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.friction import FrictionLaw, law_type
from stickslip.identification.features.features import by_features
from stickslip.identification.records.route_choice import RouteChoice, RouteName, asked_for
from stickslip.identification.records.settings import RecordSettings
from stickslip.identification.validation import Laws, check_given, laws_of, names_of
from stickslip.mechanisms import Mechanism
from stickslip.selection.candidates import specifications
from stickslip.selection.feature_verdict import FeatureVerdict
from stickslip.selection.features import feature_laws, select_features
from stickslip.selection.record_verdict import RecordVerdict
from stickslip.selection.records import PurposeName, select_records
from stickslip.selection.travels import PLAIN, select_travels
from stickslip.selection.verdict import TravelVerdict
from stickslip.solver import Progress

__all__ = ["candidate_names", "select"]


def select(
    mechanism: Mechanism,
    measurement: Measurement,
    laws: Laws | FrictionLaw | type[FrictionLaw] | str | None = None,
    *,
    unknown: str | Sequence[str] = (),
    assumed: Mapping[str, Sequence[str]] | None = None,
    purpose: PurposeName = "simulate",
    horizon: float | None = None,
    route: RouteName | RouteChoice | None = None,
    validate: Measurement | None = None,
    settings: RecordSettings | None = None,
    t_end: float = 10.0,
    watch: Callable[[str, float], object] | None = None,
    compiling: Progress | None = None,
    executor: Executor | None = None,
) -> TravelVerdict | RecordVerdict | FeatureVerdict:
    """Fit every law to a measurement, compare them on what they have not seen, and name one.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    measurement : Measurement
        One travel or several trials; or records in time of position, velocity and force; or
        friction, measured directly; or one record of the force of a spring that pulls a block.
    laws : mapping, sequence or a single law, optional
        The candidates, as instances, types or names; instances bring start values and, for
        travels, assumptions. If not given, for travels Coulomb, viscous, both, Stribeck, Dahl
        and LuGre, for records ten, for features of stick-slip those with a step above sliding.
    unknown : str or sequence of str
        Parameters of the mechanism that are looked for too, such as ``"inertia"``.
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
    watch : callable, optional
        Called with the name of a law and the number of its runs, or the least residual so far.
        For records, False ends the search with the best so far; what was fitted is still judged.
    compiling : callable, optional
        Called as the `progress` of `stickslip.solver.warm_up`, if equations have to be compiled.
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
    >>> verdict = select(rig, reading, [Coulomb, Viscous])
    >>> verdict.best.name, [candidate.name for candidate in verdict.candidates]
    ('coulomb', ['coulomb', 'viscous'])
    """
    check_given("select", mechanism, measurement)
    unknown, laws = names_of(unknown), laws_of(laws)
    by_its_features = by_features(measurement, asked_for(route))
    if measurement.travelled and not by_its_features:
        _check_travels(unknown, validate)
        return select_travels(
            mechanism,
            measurement,
            _kinds(laws),
            assumed=assumed,
            t_end=t_end,
            watch=watch,
            compiling=compiling,
        )
    if by_its_features:
        return select_features(
            mechanism,
            measurement,
            laws,
            unknown=unknown,
            purpose=purpose,
            horizon=horizon,
            route=asked_for(route),
            validate=validate,
            settings=settings,
            watch=watch,
            executor=executor,
        )
    return select_records(
        mechanism,
        measurement,
        laws,
        unknown=unknown,
        purpose=purpose,
        horizon=horizon,
        route=route,
        validate=validate,
        settings=settings,
        watch=watch,
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
            "travels take no second record and no unknown parameters of the mechanism: give more"
            " trials instead."
        )
