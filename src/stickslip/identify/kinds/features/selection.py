"""Selection by features of stick-slip: every law fitted to one half, judged on the other."""

import math
from collections.abc import Collection, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import replace
from functools import partial

import numpy as np

from stickslip.data import Checks, Measurement
from stickslip.errors import ConvergenceError, SimulationError
from stickslip.friction import CandidateSpec, Coulomb, FrictionLaw, LuGre, Stribeck
from stickslip.identify.candidates import LEFT_OUT, MOST, Watch, fitted_side_by_side, specifications
from stickslip.identify.fits import LAW, Estimate, Parameters, RecordSettings
from stickslip.identify.kinds.features.features import (
    COMPARED,
    StickSlipFeatures,
    features_of,
    is_steady,
    refuse_uncertainties,
)
from stickslip.identify.kinds.features.fit import fit_features, free_of
from stickslip.identify.kinds.features.problem import cycle_features
from stickslip.identify.kinds.features.result import (
    FeatureFit,
    as_good,
    error_of_score,
    is_missed,
    room_of,
)
from stickslip.identify.kinds.features.verdict import FeatureCandidate, FeatureVerdict, OtherSpeed
from stickslip.identify.kinds.features.wording import feature_wording, outcomes
from stickslip.identify.selection import checked
from stickslip.mechanisms import Mechanism
from stickslip.show.formatting import joined, ratio, signed_percent

USUAL: tuple[type[FrictionLaw], ...] = (Coulomb, Stribeck, LuGre)
"""Laws with a step above sliding: without one, a towed block comes to slide steadily."""

CONTROL = "the mechanism as stated"


def feature_laws(
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
) -> tuple[CandidateSpec, ...]:
    """Return the candidates: those given, or Coulomb, Stribeck and LuGre.

    Examples
    --------
    >>> [one.name for one in feature_laws(None)]
    ['coulomb', 'stribeck', 'lugre']
    """
    return specifications(USUAL if laws is None else laws)


def select_features(
    mechanism: Mechanism,
    laws: Mapping[str, FrictionLaw] | Sequence[FrictionLaw | type[FrictionLaw] | str] | None,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    validate: Measurement | None = None,
    settings: RecordSettings | None = None,
    progress: Watch | None = None,
    executor: Executor | None = None,
) -> FeatureVerdict:
    """Select a law for the force of a spring that pulls a block; arguments as in `select`.

    Parameters
    ----------
    mechanism : Mechanism
        A `TowedBlock` with nominal mass, stiffness and speed.
    laws : mapping of str to FrictionLaw or sequence of FrictionLaw or type or str or None
        The candidates; those with a step above sliding if None.
    measurement : Measurement
        One record with time and spring_force [N].
    vary : str or sequence of str, optional
        Parameters of the mechanism to fit too, by path or last name.
    fixed : mapping of str to float, optional
        Values of parameters of the mechanism that are held [SI].
    validate : Measurement, optional
        A second record, which no fit sees.
    settings : RecordSettings, optional
        Gives the seed of the global search.
    progress : callable, optional
        Called with the name of a law and its least residual so far; False ends its search.
    executor : Executor, optional
        Processes that fit laws at the same time; one after the other if not given.

    Returns
    -------
    FeatureVerdict
        Candidates, the law to use and sentences.
    """
    refuse_uncertainties(measurement)
    parameters = Parameters.of(mechanism, None, vary, fixed, measurement=measurement)
    mechanism = parameters.mechanism
    checks = checked(mechanism, measurement, validate)
    features = features_of(measurement, mechanism=mechanism)
    seed = 0 if settings is None else settings.seed
    fitted = partial(_candidate, mechanism=mechanism, measurement=measurement, seed=seed)
    looked = partial(fitted, unknown=parameters.unknown)
    chosen = feature_laws(laws)
    tried = fitted_side_by_side(looked, chosen, progress, executor)
    judged = sorted((_judged(one, validate) for one in tried), key=lambda one: one.score)
    best = _best(judged)
    ties = [one for one in judged if one is not best and _tied(one, best)]
    best = _reaching(best, ties, {one.name for one in chosen if isinstance(one.law, type)})
    control = None
    if parameters.unknown:
        own = next(one for one in chosen if one.name == best.name)
        control = _beside(_judged(fitted(own, _renamed(progress), unknown=()), validate), best)
    ordered = outcomes([best, *(one for one in judged if one.name != best.name)])
    return _verdict(mechanism, measurement, ordered, control, features, checks)


def _renamed(watch: Watch | None) -> Watch | None:
    """Return what tells a watcher of the control, which is none of the candidates."""
    return None if watch is None else (lambda _, rms: watch(CONTROL, rms))


def _beside(control: FeatureCandidate, best: FeatureCandidate) -> FeatureCandidate:
    """Add to the control how much worse it is."""
    if control.fit is None:
        return replace(control, outcome=control.dropped)
    return replace(control, outcome=f"{ratio(control.score / best.score)} the error")


def _verdict(
    mechanism: Mechanism,
    measurement: Measurement,
    ordered: Sequence[FeatureCandidate],
    control: FeatureCandidate | None,
    features: StickSlipFeatures,
    checks: Checks,
) -> FeatureVerdict:
    best, others = ordered[0], ordered[1:]
    assert best.fit is not None
    rivals = [one for one in others if one.fit and not one.dropped]
    speeds = other_speeds(best, rivals)
    return FeatureVerdict(
        mechanism=mechanism,
        measurement=measurement,
        words=feature_wording(ordered, control, features, checks, speeds),
        candidates=tuple(ordered),
        best=best,
        control=control,
        ranked=len(others) > 0 and not any(_tied(one, best) for one in rivals),
        features=features,
        checks=checks,
        room=room_of(best.fit),
        speeds=speeds,
    )


def _candidate(
    one: CandidateSpec,
    watch: Watch | None = None,
    *,
    mechanism: Mechanism,
    measurement: Measurement,
    unknown: Sequence[str],
    seed: int,
) -> FeatureCandidate:
    """Fit one candidate; one that cannot be fitted is kept with the reason."""
    unfitted = partial(FeatureCandidate, name=one.name, title=one.title, fit=None)
    if not free_of(one.law):
        return unfitted(dropped="it has no friction level that these features could determine")
    if watch is not None and watch(one.name, math.nan) is False:
        return unfitted(dropped=LEFT_OUT)
    report = None if watch is None else (lambda rms: watch(one.name, rms))
    try:
        fit = fit_features(
            mechanism, one.law, measurement, vary=[LAW, *unknown], seed=seed, progress=report
        )
    except (ConvergenceError, SimulationError) as error:
        return unfitted(dropped=str(error))
    return FeatureCandidate(name=one.name, title=one.title, fit=fit)


def _judged(candidate: FeatureCandidate, validate: Measurement | None) -> FeatureCandidate:
    """Add the doubt of the score, the errors on a second record, and what speaks against it."""
    fit = candidate.fit
    if fit is None:
        return candidate
    return replace(
        candidate,
        score_error=error_of_score(fit),
        dropped=_missed(fit),
        doubt=_open(fit),
        second={} if validate is None else fit.judged(validate),
    )


def _missed(fit: FeatureFit) -> str:
    """Return which features of the half that it was fitted to a law does not reach."""
    missed = [
        f"{name.replace('_', ' ')} by {signed_percent(error)}"
        for name, error in fit.errors.items()
        if is_missed(error)
    ]
    return f"its fit misses the {joined(missed)}" if missed else ""


def _open(fit: FeatureFit) -> str:
    """Return which parameters the features leave open."""
    symbols = [f"${one.quantity.symbol}$" for one in fit.estimates if not one.bounded]
    if not symbols:
        return ""
    return f"{joined(symbols)} {'is' if len(symbols) == 1 else 'are'} not identified"


def _best(judged: Sequence[FeatureCandidate]) -> FeatureCandidate:
    """Return the least error, or of what is as good the one that says the least it need not."""
    fitted = [one for one in judged if one.fit and np.isfinite(one.score)]
    if not fitted:
        raise ConvergenceError(
            "no candidate has a limit cycle that can be compared with this record: "
            + "; ".join(f"{one.title}: {one.dropped}" for one in judged)
        )
    held = [one for one in fitted if not one.dropped] or fitted
    least = held[0]
    assert least.fit is not None
    near = [one for one in held if one.fit and as_good(one.fit, least.fit)]
    return min(near, key=lambda one: (bool(one.doubt), one.parameters, one.score))


def _tied(one: FeatureCandidate, best: FeatureCandidate) -> bool:
    """Whether the features do not tell a law from the one that is named."""
    assert best.fit is not None
    return one.fit is not None and not one.dropped and as_good(one.fit, best.fit)


def _reaching(
    best: FeatureCandidate, ties: Sequence[FeatureCandidate], usual: Collection[str]
) -> FeatureCandidate:
    """Return the law that is named with intervals that hold those of all that are not told from it.

    Three features determine three numbers: which ones, only the law says. What one of these laws
    leaves open has no interval: bristles of a stiffness that nobody gave leave the static level and
    the speed up to which it acts open. `usual` names the laws whose values nobody gave.
    """
    assert best.fit is not None
    fits = [one.fit for one in ties if one.fit is not None]
    if not fits or best.dropped:
        return best
    found = []
    for one in best.fit.estimates:
        same = [other for fit in fits for other in fit.estimates if other.path == one.path]
        open_ = [
            c.title
            for c in ties
            if c.fit
            and any(
                e.path == one.path and not (e.bounded and _told(e, c, usual))
                for e in c.fit.estimates
            )
        ]
        if open_ and one.bounded:
            said = f"{joined(open_)} friction, which has the same features, leaves it open"
            found.append(replace(one, low=-math.inf, high=math.inf, reason=said))
        else:
            low, high = (min(e.low for e in [one, *same]), max(e.high for e in [one, *same]))
            found.append(replace(one, low=low, high=high))
    return replace(best, fit=replace(best.fit, estimates=tuple(found), alone=best.fit.estimates))


def _told(one: Estimate, candidate: FeatureCandidate, usual: Collection[str]) -> bool:
    """Whether an estimate of a law does not rest on bristles of which nobody gave the stiffness."""
    guessed = candidate.name in usual and candidate.law is not None and candidate.law.states
    return not guessed or (one.quantity.at_least is None and one.quantity.scale != "speed")


FACTORS = (0.1, 0.25, 0.5, 2.0, 4.0)
"""Speeds that are tried, over that of the record."""


def other_speeds(
    best: FeatureCandidate, rivals: Sequence[FeatureCandidate]
) -> tuple[OtherSpeed, ...]:
    """Return what the best law and its rivals predict at other speeds, the most telling first.

    A speed at which any of them does not settle within some cycles is left out.
    """
    if best.fit is None or not rivals:
        return ()
    found = []
    for factor in FACTORS:
        predicted = {one.name: _at(one.fit, factor) for one in [best, *rivals] if one.fit}
        if any(math.isnan(value) for row in predicted.values() for value in row.values()):
            continue
        apart = min(_apart(predicted[best.name], predicted[one.name]) for one in rivals)
        found.append(
            OtherSpeed(
                speed=factor * best.fit.mechanism.speed, predicted=predicted, separation=apart
            )
        )
    return tuple(sorted(found, key=lambda one: -one.separation)[:MOST])


def _at(fit: FeatureFit, factor: float) -> dict[str, float]:
    """Return the features of the limit cycle at another speed; steady sliding has frequency 0."""
    block = replace(fit.mechanism, speed=factor * fit.mechanism.speed)
    natural = 2.0 * math.pi * math.sqrt(block.mass / block.stiffness)
    # sticking lasts as long as the spring takes to fall by twice its swing: longer if slower
    sticking = 4.0 * fit.observed.standard_deviation * block.steady_load
    period = natural + sticking / (block.stiffness * block.speed)
    (row,) = cycle_features(
        block,
        fit.law,
        ("mechanism.speed",),
        np.array([[block.speed]]),
        period=period,
        level=fit.observed.mean,
    )
    found = dict(zip(COMPARED, map(float, row), strict=True))
    if is_steady(found["mean"], found["standard_deviation"]):
        found["frequency"] = 0.0
    return found


def _apart(one: dict[str, float], other: dict[str, float]) -> float:
    """Return the root mean square difference of features, each over the mean of both."""
    gaps = []
    for name in COMPARED:
        size = 0.5 * (abs(one[name]) + abs(other[name]))
        gaps.append((one[name] - other[name]) / size if size > 0.0 else 0.0)
    return float(np.sqrt(np.mean(np.square(gaps))))
