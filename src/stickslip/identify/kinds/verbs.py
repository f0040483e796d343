"""The verbs `fit` and `select`: each asks the kind of the measurement once."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from typing import Any, Literal, TypeAlias, overload

from threadpoolctl import threadpool_limits
from typing_extensions import TypeVar

from stickslip.data import Measurement, as_tolerance, as_turning
from stickslip.engine.executors import threads
from stickslip.friction import FrictionLaw, RateState
from stickslip.identify import JointLawFit
from stickslip.identify.candidates import Verdict
from stickslip.identify.fits import Fit, RecordSettings, check_given
from stickslip.identify.kinds.kind import Request, SeveralLaws
from stickslip.identify.kinds.registry import (
    AnyKind,
    as_judged,
    kind_of,
    refuse_foreign,
    refuse_uninformed,
    refuse_unused,
)
from stickslip.mechanisms import Mechanism, as_rotary

AnyLaw = TypeVar("AnyLaw", bound=FrictionLaw | RateState, default=FrictionLaw)
"""The type of law that a fit was given; a name could stand for any."""
OwnRouteName: TypeAlias = Literal["table", "balance", "features", "rate-state"]
RouteName: TypeAlias = OwnRouteName | str
"""What `fit` and `select` may be asked for; editors complete ours, and other packages add theirs.
"""
OneLaw: TypeAlias = FrictionLaw | type[FrictionLaw] | RateState | type[RateState] | str
"""One type, since a union of several types of lists would keep checkers from inferring a list."""


@overload
def fit(
    mechanism: Mechanism,
    law: Mapping[str, FrictionLaw | type[FrictionLaw] | str | None],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    settings: RecordSettings | None = None,
    progress: Callable[[float], object] | None = None,
) -> JointLawFit: ...


@overload
def fit(
    mechanism: Mechanism,
    law: AnyLaw | type[AnyLaw] | str,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    route: RouteName | None = None,
    settings: RecordSettings | None = None,
    t_end: float | None = None,
    progress: Callable[[float], object] | None = None,
) -> Fit[AnyLaw]: ...


def fit(
    mechanism: Mechanism,
    law: Any,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    route: RouteName | None = None,
    settings: RecordSettings | None = None,
    t_end: float | None = None,
    progress: Callable[[float], object] | None = None,
) -> Fit[Any]:
    """Fit parameters of a law to what was measured.

    Travels are fitted by runs to rest; records in time by the force balance along the motion, or by
    runs that follow it; the force of a spring that pulls a block by its
    features, since no law follows irregular stick-slip sample by sample; friction under a load
    point with steps of its speed by rate-and-state laws; and several joints at once by inverse
    dynamics.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured; trials may override its parameters.
    law : FrictionLaw, RateState, type or str, or mapping of str to these
        An instance, whose values are the start and, for parameters that are not varied, the
        assumption; or a type or a name, for which start values are found: in a record, or ordinary
        ones for travels. Names are those of `select`, such as ``"dahl-exponent"`` for records. For
        a record of several joints, laws by the name of the contact, None where nothing rubs; a type
        or a name alone stands for one law of that kind at each contact.
    measurement : Measurement
        Travels, records in time, measured friction, the force of a spring, or velocity steps of a
        load point; or positions and forces of several joints.
    vary : str or sequence of str, optional
        Parameters to fit, all others are held: full paths such as ``"mechanism.inertia"``, last
        names that are unique, and patterns with ``*``. ``"friction.*"``, which is all if not given,
        stands for what is fitted of the law by default: of records its `fit_order`, of travels as
        much of that as different trials can pay for, of features what shapes a limit cycle. A
        constant offset, which sensors and cables have, is fitted to records unless it is fixed.
        Parameters of the mechanism are for records and features; named alone, they are fitted
        beside a law that is held.
    fixed : mapping of str to float, optional
        Values of parameters that are held, of law and mechanism, by the same names.
    route : str, optional
        How the measurement is fitted, as `RouteName` lists: a route of `select`. If not given, it
        follows from the quantities measured.
    settings : RecordSettings, optional
        How the force of a record runs between samples; features use the seed and velocity steps
        the starts and the seed. What is changed there without effect is refused.
    t_end : float, optional
        Time after which a body whose travel to rest was measured counts as stopped [s]; 10 s if not
        given.
    progress : callable, optional
        Called with the number of runs so far for travels, for features and velocity steps with the
        least root mean square so far; there, False ends the search with the best so far.

    Returns
    -------
    Fit
        A `LawFit`, `TravelFit`, `JointLawFit` or `SimulatedFit`: the fitted law, estimates with
        intervals, predictions.

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
    measurement = as_judged(as_turning(measurement, mechanism.units), route)
    if measurement.turning:
        mechanism = as_rotary(mechanism)
    kind = kind_of(measurement, route)
    request = Request(
        mechanism=mechanism,
        measurement=measurement,
        law=law,
        fixed=fixed,
        progress=progress,
        route=route,
        settings=settings,
        t_end=t_end,
    )
    refuse_unused(kind, {name: name for name in request.given}, request)
    several = isinstance(law, Mapping) and kind.by_contact
    given = [item for item in law.values() if item is not None] if several else [law]
    refuse_foreign(kind, given)
    refuse_uninformed(kind, given, mechanism, measurement)
    law, vary = kind.law_and_parameters(law, vary, fixed or ())
    threads()  # refuses what the environment says before the work begins
    with _one_thread():
        result: Fit[Any] = kind.fit(_chosen(kind, replace(request, law=law, vary=vary)))
    return result


def select(
    mechanism: Mechanism,
    laws: Mapping[str, OneLaw] | Sequence[OneLaw] | OneLaw | None,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    assumed: Mapping[str, Sequence[str]] | None = None,
    route: RouteName | None = None,
    validate: Measurement | None = None,
    settings: RecordSettings | None = None,
    t_end: float | None = None,
    tolerance: float | None = None,
    progress: Callable[[str, float], object] | None = None,
) -> Verdict:
    """Fit every law to a measurement, compare them on what they have not seen, and name one.

    Parameters
    ----------
    mechanism : Mechanism
        What was measured.
    laws : mapping, sequence or a single law, or None
        The candidates, as instances, types or names; instances bring start values and, for
        travels, assumptions. None stands for the usual ones: for travels Coulomb, viscous, both,
        Stribeck, Dahl and LuGre; for records and tables all sums of the parts that explain them;
        for several joints what their force balances ask for; for features of stick-slip Coulomb,
        with viscous too, and Stribeck; for velocity steps forms of rate-and-state friction.
    measurement : Measurement
        One travel or several trials; or records in time of position, velocity and force; or
        friction, measured directly; or one record of the force of a spring that pulls a block, or
        of friction under velocity steps of a load point; or positions and forces of several joints,
        for each of which a law is named.
    vary : str or sequence of str, optional
        ``"friction.*"``, which is all if not given, for the parameters that `fit` fits of each law
        by default, and parameters of the mechanism to fit too, such as ``"mechanism.inertia"``.
    fixed : mapping of str to float, optional
        Values of parameters of the mechanism that are held.
    assumed : mapping of str to sequence of str, optional
        By name of the law, parameters whose values were assumed, not measured, such as those of
        `Rig.assumed`: for travels, they are fitted where no law explains the readings without.
    route : str, optional
        How the measurement is judged, as `RouteName` lists, or a route of another package. If not
        given, it follows from the quantities measured.
    validate : Measurement, optional
        A second record, which no fit sees; what it says of the verdict is reported.
    settings : RecordSettings, optional
        Starts, seed and hold of fits to several joints; of these, features use the seed and
        velocity steps the starts and the seed. What has no effect is refused.
    t_end : float, optional
        Time after which a body whose travel to rest was measured counts as stopped [s]; 10 s if not
        given.
    tolerance : float, optional
        Share of friction by which the law that is named may be off, such as 0.05; 0.02 if
        not given.
    progress : callable, optional
        Called with the name of a law and the number of its runs, or the least residual so far. For
        joints, False ends the search with the best so far; what was fitted is still judged.

    Returns
    -------
    Verdict
        A `BandVerdict` of tables and of records of one coordinate, else a `TravelVerdict`,
        `JointVerdict` or `SimulatedVerdict`, or that of a kind
        of another package: candidates, the law to use, what the data settle and what they cannot
        tell.

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
    measurement = as_judged(as_turning(measurement, mechanism.units), route)
    if measurement.turning:
        mechanism = as_rotary(mechanism)
    kind = kind_of(measurement, route)
    is_one = laws is not None and not isinstance(laws, Mapping | Sequence)
    several: SeveralLaws = [laws] if is_one or isinstance(laws, str) else laws
    request = Request(
        mechanism=mechanism,
        laws=several,
        measurement=measurement,
        vary=vary,
        fixed=fixed,
        progress=progress,
        route=route,
        settings=settings,
        validate=validate and as_judged(as_turning(validate, mechanism.units), route),
        assumed=assumed or None,
        t_end=t_end,
        tolerance=None if tolerance is None else as_tolerance(tolerance),
    )
    refuse_unused(kind, {name: name for name in request.given}, request)
    given = several.values() if isinstance(several, Mapping) else several or ()
    refuse_foreign(kind, given)
    for item in (measurement, request.validate):
        if item is not None:
            refuse_uninformed(kind, given, mechanism, item)
    with _one_thread():
        verdict: Verdict = kind.select(_chosen(kind, request))
    return verdict


def _one_thread() -> AbstractContextManager[object]:
    """Keep linear algebra to one thread: of thin matrices, others would wait for each other."""
    limits: AbstractContextManager[object] = threadpool_limits(limits=1, user_api="blas")
    return limits


def _chosen(kind: AnyKind, request: Request) -> Request:
    """Return the request with what is chosen for the measurement, if settings depend on it.

    Settings that have no effect then are refused.
    """
    changed = () if request.settings is None else request.settings.changed
    if not changed:
        return request
    request = kind.resolved(request)
    refuse_unused(kind, {name: f"RecordSettings.{name}" for name in changed}, request)
    return request
