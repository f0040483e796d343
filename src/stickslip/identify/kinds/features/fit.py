"""Laws fitted to features of stick-slip and oscillation, and judged on what they did not see."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from stickslip.data import Measurement
from stickslip.errors import ConvergenceError, InputError, check_size
from stickslip.friction import FrictionLaw
from stickslip.identify import THRESHOLDS
from stickslip.identify.fits import (
    LAW,
    Counter,
    Parameters,
    ResidualJacobian,
    Watch,
    improve,
    starting_law,
    with_known,
)
from stickslip.identify.kinds.features.features import (
    COMPARED,
    StickSlipFeatures,
    features_of,
    refuse_uncertainties,
    towed,
)
from stickslip.identify.kinds.features.problem import FeatureProblem, unknowns_of
from stickslip.identify.kinds.features.result import (
    FeatureFit,
    as_good,
    errors_of,
    estimates_of,
    room_of,
    sentences_of,
)
from stickslip.mechanisms import Mechanism, TowedBlock
from stickslip.quantities import Quantity, fields_of
from stickslip.quantities import vary as with_values
from stickslip.show.formatting import number, percent

Array: TypeAlias = NDArray[np.float64]
Progress: TypeAlias = Callable[[int, int], object]

MASS = "mechanism.mass"
LOCAL = 12
"""Points of the global search from which the search goes on locally; of 6, one more of 20
sliders has narrow intervals that miss the truth."""


def fit_features(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    share: float = 0.5,
    points: int = 256,
    seed: int = 0,
    progress: Watch | None = None,
) -> FeatureFit:
    """Fit a law on a towed block to frequency, mean and standard deviation of the spring's force.

    The first part of the record is fitted and the rest is kept to judge by. Limit cycles are
    simulated; a Sobol sequence over the whole range of the unknowns comes first, because a local
    search alone seldom finds the best, and the best points go on locally. Intervals propagate a
    block bootstrap of the observed features.

    Parameters
    ----------
    mechanism : TowedBlock
        Nominal mass, stiffness and speed. The load stays the nominal one, whatever the mass.
    law : FrictionLaw or type
        An instance, whose values hold for what is not varied; or a type, for ordinary values.
    measurement : Measurement
        One record with ``time`` and ``spring_force`` [N].
    vary : str or sequence of str, optional
        Parameters to fit, as for `fit`; all others are held. ``"friction.*"``, which is all if not
        given, stands for levels of friction and speeds of the law, such as kinetic and static
        coefficient and Stribeck velocity.
    fixed : mapping of str to float, optional
        Values of parameters that are held, of law and mechanism.
    share : float
        Share of the record that is fitted, above 0 and up to 1.
    points, seed : int
        Points of the global search, and seed of its scrambling.
    progress : callable, optional
        Called with the least root mean square error of the features so far, infinite before there
        is one; False ends the search with the best so far.

    Returns
    -------
    FeatureFit
        Law, mechanism, estimates with intervals, errors on both parts, and sentences.

    Raises
    ------
    InputError
        If the record, the mechanism or a name will not do.
    ConvergenceError
        If no run of the global search has a limit cycle.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> block = TowedBlock(mass=0.03, stiffness=1000.0, speed=4e-3)
    >>> truth = Coulomb(kinetic_coefficient=0.28, static_coefficient=0.32)
    >>> t = np.linspace(0.5, 4.5, 8001)
    >>> run = simulate(block, truth, t_end=4.5).at(t)
    >>> record = Measurement(time=t, spring_force=1000.0 * (4e-3 * t - run["x"]))
    >>> found = fit_features(block, Coulomb, record, vary=["friction.*", "mechanism.mass"])
    >>> abs(found.mechanism.mass / 0.03 - 1.0) < 0.03
    True
    """
    towed(mechanism)
    chosen = Parameters.of(mechanism, law, vary, fixed, measurement=measurement)
    block, known = towed(chosen.mechanism), chosen.known
    refuse_uncertainties(measurement)
    if not 0.0 < share <= 1.0:
        raise InputError(f"fit_features: share must be above 0 and at most 1, got {share!r}.")
    first, rest = _parts(measurement, share)
    observed = features_of(first, mechanism=block)
    start = with_known(_start(block, chosen.law), known)
    held = None if rest is None else features_of(rest, mechanism=block)
    for part in (observed, held):
        _check_pull(part)
    free = (LAW,) if chosen.free is None else chosen.free
    usual = [f"friction.{name}" for name in free_of(start) if name not in known]
    named = [path for path in free if path != LAW]
    names = list(dict.fromkeys([*(usual if LAW in free else ()), *named]))
    free_parameters = unknowns_of(block, start, observed, unknown=chosen.unknown, free=names)
    if not len(free_parameters):
        raise InputError(
            f"there is nothing to fit: all friction levels and speeds of {start.title} are fixed;"
            " name at least one parameter in vary."
        )
    problem = FeatureProblem(
        block=block, law=start, observed=observed, free_parameters=free_parameters
    )
    return _result(problem, _searched(problem, points, seed, progress), held, measurement)


def free_of(law: FrictionLaw | type[FrictionLaw]) -> list[str]:
    """Return the names of the parameters of a law that features are fitted by: levels and speeds.

    Examples
    --------
    >>> from stickslip import Coulomb, Viscous
    >>> free_of(Coulomb), free_of(Viscous)
    (['kinetic_coefficient', 'static_coefficient'], [])
    """
    known = fields_of(law if isinstance(law, type) else type(law))
    return [
        name
        for name, quantity in known.items()
        if quantity.scale in ("level", "force", "speed") and not _stands_on_top(known, quantity)
    ]


def _stands_on_top(known: Mapping[str, Quantity], quantity: Quantity) -> bool:
    """Whether a level must not fall below one that itself stands above another."""
    return quantity.at_least is not None and known[quantity.at_least].at_least is not None


@dataclass(frozen=True)
class _End:
    """Where a search ended."""

    best: ResidualJacobian
    runs: int
    cancelled: bool


def _result(
    problem: FeatureProblem, end: _End, held: StickSlipFeatures | None, measurement: Measurement
) -> FeatureFit:
    best = end.best
    block, observed, free_parameters = problem.block, problem.observed, problem.free_parameters
    pairs = dict(zip(free_parameters.paths, map(float, best.values), strict=True))
    own = {path: value for path, value in pairs.items() if path.startswith("mechanism.")}
    others = {path: value for path, value in pairs.items() if path not in own}
    predicted = observed.compared * np.exp(-best.residual)
    estimates, correlation = estimates_of(free_parameters, best, observed.covariance)
    errors = errors_of(predicted, observed)
    said = sentences_of(estimates, observed, held, errors)
    if observed.too_fast and MASS not in pairs:
        said += (
            "The mass was fixed at its nominal value; vary=['friction.*', 'mechanism.mass'] fits"
            " it too.",
        )
    return FeatureFit(
        law=with_values(problem.law, "friction", others),
        mechanism=with_values(replace(block, load=block.steady_load), "mechanism", own),
        estimates=estimates,
        observed=observed,
        predicted=dict(zip(COMPARED, map(float, predicted), strict=True)),
        errors=errors,
        held_out=held,
        held_out_errors={} if held is None else errors_of(predicted, held),
        runs=end.runs,
        sentences=said,
        measurement=measurement,
        correlation=correlation,
        cancelled=end.cancelled,
    )


def compare_features(
    mechanism: Mechanism,
    laws: Sequence[FrictionLaw | type[FrictionLaw]],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    share: float = 0.5,
    points: int = 256,
    seed: int = 0,
    progress: Watch | None = None,
) -> tuple[FeatureFit, ...]:
    """Fit several laws as `fit_features` does, least held-out error first.

    Laws whose errors differ by less than the features themselves differ between the parts are not
    told apart by this record, and their sentences say so.

    Parameters
    ----------
    mechanism : Mechanism
        A `TowedBlock` with nominal mass, stiffness and speed.
    laws : sequence of FrictionLaw or type
        The laws to fit.
    measurement : Measurement
        One record with time and spring_force [N].
    vary : str or sequence of str, optional
        Parameters to fit, as for `fit_features`.
    fixed : mapping of str to float, optional
        Values of parameters that are held [SI], of laws and mechanism.
    share : float
        Share of the record that is fitted, above 0 and up to 1.
    points : int
        Points of the global search of each law.
    seed : int
        Seed of the search's scrambling.
    progress : callable, optional
        Called with the least root mean square error so far; False ends the search of a law with the
        best so far.

    Returns
    -------
    tuple of FeatureFit
        One fit for each law; of equal ones, that with fewer free parameters first.

    Examples
    --------
    >>> from stickslip import Coulomb, simulate
    >>> block = TowedBlock(mass=0.03, stiffness=1000.0, speed=4e-3)
    >>> truth = Coulomb(kinetic_coefficient=0.28, static_coefficient=0.32)
    >>> t = np.linspace(0.5, 4.5, 8001)
    >>> run = simulate(block, truth, t_end=4.5).at(t)
    >>> record = Measurement(time=t, spring_force=1000.0 * (4e-3 * t - run["x"]))
    >>> fits = compare_features(block, [Coulomb], record, vary=["friction.*", "mass"])
    >>> [fitted.law.title for fitted in fits]
    ['Coulomb']
    """
    fits = [
        fit_features(
            mechanism,
            law,
            measurement,
            vary=vary,
            fixed=fixed,
            share=share,
            points=points,
            seed=seed,
            progress=progress,
        )
        for law in laws
    ]
    # of equal ones the law with less to look for comes first
    fits.sort(key=lambda fitted: (round(fitted.score, 3), len(fitted.estimates)))
    return _told_apart(fits)


def _told_apart(fits: Sequence[FeatureFit]) -> tuple[FeatureFit, ...]:
    """Return sorted fits; those as good as the first say so."""
    alike = [one for one in fits if as_good(one, fits[0])]
    if len(alike) < 2:
        return tuple(fits)
    said = (
        f"{', '.join(one.law.title for one in alike)} are not distinguished: their held-out errors"
        " differ by less than the features change between the parts of the record"
        f" ({percent(room_of(fits[0]))})."
    )
    return tuple(
        replace(one, sentences=(*one.sentences, said)) if one in alike else one for one in fits
    )


def _check_pull(observed: StickSlipFeatures | None) -> None:
    """Refuse a force that does not pull the block forwards on the average."""
    if observed is not None and not observed.mean > 0.0:
        raise InputError(
            f"the mean spring force over the load is {number(observed.mean)} and must be above 0:"
            " count force and speed positive in the direction of the pull, with a gain such as"
            ' gain={"spring_force": -1}, or correct the offset of the force.'
        )


def _parts(measurement: Measurement, share: float) -> tuple[Measurement, Measurement | None]:
    """Return the first share of a record, and the rest if any."""
    if measurement.trials or measurement.time is None or measurement.spring_force is None:
        raise InputError("fit_features needs one record with time and spring_force [N].")
    time, force = measurement.time, np.asarray(measurement.values("spring_force"))
    cut = max(2, round(share * len(time)))
    first = Measurement(time=time[:cut], spring_force=force[:cut])
    if len(time) - cut < 2:
        return first, None
    return first, Measurement(time=time[cut:], spring_force=force[cut:])


def _start(block: TowedBlock, law: FrictionLaw | type[FrictionLaw]) -> FrictionLaw:
    """Return a law with a static level and, of a type with bristles, ones stiffer than the spring.

    Softer bristles would oscillate in place of the spring.
    """
    load = block.steady_load
    start = starting_law(law, float(load)) if isinstance(law, type) else law
    changes: dict[str, float] = {}
    stiffness = 30.0 * block.stiffness / load
    sizes = {
        "stiffness": stiffness,
        "damping": math.sqrt(stiffness * block.mass / load),
        "slope": 0.0,
    }
    known = fields_of(type(start))
    for name, quantity in known.items():
        base, size = quantity.at_least, sizes.get(quantity.scale)
        if base is not None and not _stands_on_top(known, quantity):
            if getattr(start, name) is None:
                changes[f"friction.{name}"] = 1.2 * getattr(start, base)
        elif isinstance(law, type) and size is not None and quantity.allows(size):
            changes[f"friction.{name}"] = size
    return with_values(start, "friction", changes) if changes else start


def _searched(
    problem: FeatureProblem,
    points: int,
    seed: int,
    progress: Watch | None,
) -> _End:
    """Return the best end of the best points of a Sobol sequence, and what fits as well.

    That is where chi-square is above the least by no more than chance allows of three features.
    """
    from scipy.stats import chi2

    counter = Counter(progress)
    places, costs = _spread(problem, points, seed, _told(progress))
    ends, cancelled = [], False
    for i in np.argsort(costs)[:LOCAL]:
        if cancelled or not math.isfinite(costs[i]):
            break
        try:
            end, cancelled = improve(problem, places[i], counter=counter)
        except ConvergenceError:  # a neighbour of the point has no limit cycle
            continue
        ends.append(end)
    if not ends:
        raise ConvergenceError(
            f"none of {len(places)} simulated runs has a limit cycle: check the mass, stiffness"
            " and speed of the block."
        )
    i = int(np.argmin([end.cost for end in ends]))
    best, inverse = ends[i], np.linalg.inv(problem.observed.covariance)
    sizes = np.array([end.residual @ inverse @ end.residual for end in ends])
    room = chi2.isf(THRESHOLDS.pattern_chance, len(COMPARED))
    runs = len(places) + counter.count * (1 + len(problem.free_parameters))
    best.memory = np.array([end.values for end in ends])[sizes <= sizes[i] + room]
    return _End(best, runs, cancelled)


def _spread(
    problem: FeatureProblem, points: int, seed: int, progress: Progress
) -> tuple[Array, Array]:
    """Return points (n, p) of a Sobol sequence over all ranges, and what each costs (n,)."""
    from scipy.stats import qmc

    free_parameters = problem.free_parameters
    low, high = free_parameters.limits()
    check_size("points", points * len(free_parameters), "ask for fewer")
    exponent = max(4, math.ceil(math.log2(max(points, 1))))
    cube = qmc.Sobol(len(free_parameters), rng=np.random.default_rng(seed)).random_base2(exponent)
    places = np.array([free_parameters.values(low + (high - low) * row) for row in cube])
    costs = np.sum(problem.residuals(problem.features(places, progress)) ** 2, axis=1)
    costs[~np.isfinite(costs)] = math.inf
    return places, costs


def _told(progress: Watch | None) -> Progress:
    """Return what hears of the runs of the global search, of which there is no best so far."""
    return lambda _done, _of: progress is None or progress(math.inf) is not False
