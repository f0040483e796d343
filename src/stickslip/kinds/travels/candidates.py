"""One law tried on the trials: as given, as fitted, and predicting each trial from the others."""

import contextlib
import dataclasses
import math
from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np

from stickslip.errors import ConvergenceError, ParameterError, SimulationError
from stickslip.friction import Containment, FrictionLaw, containment_of
from stickslip.identification import TravelModel, Trial, required_of, spanning
from stickslip.kinds.travels.fit import check_rest, fit_trials, payable
from stickslip.kinds.travels.result import TravelFit
from stickslip.kinds.travels.search import law_from
from stickslip.identify.kinds.travel_starts import (
    Start,
    doubling_slope,
    nuisances_of,
    starting_points,
)
from stickslip.kinds.travels.verdict import TravelCandidate
from stickslip.mechanisms import Mechanism, slip_of
from stickslip.quantities import fields_of, parameters, vary
from stickslip.selection import Criteria, Watch, criteria_of
from stickslip.simulation import simulate
from stickslip.trajectory import Trajectory

CHANGES = (1.5, 1.0 / 1.5)
"""Factors on a parameter that was taken as given, to see whether the travel depends on it."""
PART = 0.5
"""The same for a slope with speed that was taken to be 0, over that which doubles friction."""
SAMPLES, STRAIGHT = 2001, 1.001
"""Samples of a run, and its path over its travel up to which the body went straight on."""
SCANNED = 2
"""Parameters of a law that is scanned beside the fits of simpler ones, at most."""


def try_law(
    name: str,
    law: FrictionLaw,
    trials: Sequence[Trial],
    *,
    t_end: float,
    ordinary: bool,
    simpler: Sequence[TravelCandidate] = (),
    marked: Collection[str] = (),
    free: Sequence[str] | None = None,
    thorough: bool = False,
    watch: Watch | None = None,
) -> TravelCandidate:
    """Fit one law; a law that cannot be fitted or run is kept with the reason.

    Several settings are fitted with all plausible values of what nobody measured, gave or fits, so
    that none of them counts as known: what it leaves, and its intervals, are those of the law.
    """
    report = None if watch is None else (lambda runs: watch(name, runs))
    _, given = _seen(trials[0], law, t_end)
    candidate = TravelCandidate(
        name=name, title=law.title, law=law, given=given, fit=None, run=None, criteria=None,
        ordinary=ordinary, marked=tuple(marked),
    )  # fmt: skip
    names = payable(law, trials) if free is None else free
    several = len({trial.setting for trial in trials}) > 1
    guessed = any(f"friction.{name}" in names for name in marked)
    known = () if ordinary else [name for name in fields_of(type(law)) if getattr(law, name)]
    unknown = nuisances_of(type(law), names, known) if several else []
    needed = [f"friction.{one}" for one in required_of(type(law)) if f"friction.{one}" not in names]
    invented = tuple(path.rpartition(".")[2] for path in (unknown or needed) if ordinary)

    def fitted(nuisances: Sequence[str]) -> TravelFit:
        starts = _starts(law, names, nuisances, trials, simpler, t_end, guessed=guessed)
        return fit_trials(
            law, trials, free=names, starts=starts, nuisances=nuisances, thorough=thorough,
            t_end=t_end, watch=report,
        )  # fmt: skip

    try:
        fit = fitted(unknown)
        if unknown and not ordinary:  # the values are as given; what they are not, intervals hold
            fit = _within(fitted([]), fit)
        fit = _at_rest(fit, law, names, trials, t_end)
        run, criteria = _seen(trials[0], fit.law, t_end, throw=True)
    except (ConvergenceError, SimulationError) as reason:
        return dataclasses.replace(
            candidate, dropped=str(reason), assumed=_assumed(law, names), invented=invented
        )
    assumed = _assumed(law, [estimate.path for estimate in fit.estimates])
    return dataclasses.replace(
        candidate,
        fit=fit,
        run=run,
        criteria=criteria,
        assumed=assumed,
        invented=invented,
        influence=_influence(fit, trials[0], assumed, t_end),
    )


def _at_rest(
    fit: TravelFit, law: FrictionLaw, names: Sequence[str], trials: Sequence[Trial], t_end: float
) -> TravelFit:
    """Return a fit with which the body comes to rest: another value, if that explains as well."""
    try:
        check_rest(fit, t_end)
    except ConvergenceError:
        for value in fit.others:
            other = fit_trials(law, trials, free=names, starts=[(value,)], t_end=t_end)
            with contextlib.suppress(ConvergenceError):
                check_rest(other, t_end)
                return other
        raise
    return fit


def _within(fit: TravelFit, wide: TravelFit) -> TravelFit:
    """Return a fit with intervals that hold those of a fit with nuisances too."""
    pairs = zip(fit.estimates, wide.estimates, strict=True)
    found = [
        spanning(one, [part for e in (one, other) for part in e.pieces or ((e.low, e.high),)])
        for one, other in pairs
    ]
    return dataclasses.replace(fit, estimates=tuple(found))


def _starts(
    law: FrictionLaw,
    names: Sequence[str],
    nuisances: Sequence[str],
    trials: Sequence[Trial],
    simpler: Sequence[TravelCandidate],
    t_end: float,
    *,
    guessed: bool,
) -> list[Start] | None:
    """Return where searches on several trials begin, the richest first: at simpler laws' fits.

    A law of few parameters is scanned too, and one without a simpler law. One with bristles is not,
    as its runs take long, unless one of its values was guessed: a stiffness decades too large has
    no slope that leads from there.
    """
    if len(trials) < 2:
        return None
    found: list[Start] = []
    every = [*names, *nuisances]
    for other in reversed(simpler):
        if other.fit is None or other.dropped:
            continue
        fitted = [e.path for e in other.fit.estimates]
        how = containment_of(type(law), type(other.law))
        if how is None and not set(fitted) <= set(every):
            continue
        for values in (None, *((v,) for v in other.fit.others), *other.fit.rivals):
            own = other.fit.law
            if values is not None:
                own = vary(own, "friction", dict(zip(fitted, values, strict=True)))
            row: dict[str, float] = {}
            for path in every:
                value = _there(law, path, own, how)
                row[path] = _absent(law, path, row) if value is None else value
            found.append([row[path] for path in every])
    if not found:
        return None
    if not nuisances and len(names) <= SCANNED and (guessed or not law.states):
        found += starting_points(TravelModel(law, names, t_end), trials)
    return found


def _there(law: FrictionLaw, path: str, own: FrictionLaw, how: Containment | None) -> float | None:
    """Return the value of a parameter with which a law is a simpler one; None if there is none."""
    name = path.rpartition(".")[2]
    source = name if how is None else how.values.get(name, name)
    if not isinstance(source, str):
        return None if fields_of(type(law))[name].scale == "damping" else float(source)
    value = getattr(own, source) if source in fields_of(type(own)) else None
    return None if value is None else float(value)


def _absent(law: FrictionLaw, path: str, row: Mapping[str, float]) -> float:
    """Return the value of a parameter with which a law is nearest to one without it."""
    name = path.rpartition(".")[2]
    quantity = fields_of(type(law))[name]
    if quantity.at_least is not None:
        return row.get(f"friction.{quantity.at_least}", float(getattr(law, name)))
    # bristles of finite stiffness without damping swing for ever
    none = quantity.above is None and quantity.scale != "damping"
    return 0.0 if none else float(getattr(law, name))


def with_held_out(
    candidate: TravelCandidate, trials: Sequence[Trial], *, t_end: float, watch: Watch | None = None
) -> TravelCandidate:
    """Return a candidate with its held-out errors; the same where trials repeat one setting."""
    if candidate.fit is None or len({trial.setting for trial in trials}) < 2:
        return candidate
    report = None if watch is None else (lambda runs: watch(candidate.name, runs))
    try:
        errors = held_out_errors(
            candidate.law, trials, fit=candidate.fit, t_end=t_end, watch=report
        )
    except (ConvergenceError, SimulationError) as reason:
        return dataclasses.replace(candidate, dropped=str(reason))
    score, score_error = root_mean_square(errors)
    return dataclasses.replace(candidate, held_out=errors, score=score, score_error=score_error)


def _seen(
    trial: Trial, law: FrictionLaw, t_end: float, *, throw: bool = False
) -> tuple[Trajectory, Criteria]:
    end = trial.until(t_end)
    run = simulate(trial.mechanism, law, t_end=end, y0=trial.start(law), throw=throw)
    return run, criteria_of(run, trial.mechanism, trial.travel)


def turning(fit: TravelFit, t_end: float) -> bool:
    """Whether the body turns back in a trial, with the law of a fit."""
    for trial in {trial.run: trial for trial in fit.trials}.values():
        if turns_back(_seen(trial, fit.law, t_end)[0], trial.mechanism):
            return True
    return False


def turns_back(run: Trajectory, mechanism: Mechanism) -> bool:
    """Whether a body turns back in a run."""
    path = run.at(np.linspace(*run.span, SAMPLES))[slip_of(mechanism)]
    return bool(np.abs(np.diff(path)).sum() > STRAIGHT * abs(path[-1] - path[0]))


def _assumed(law: FrictionLaw, free: Collection[str]) -> tuple[str, ...]:
    """Return the names of the parameters that were taken as given, of paths that are fitted."""
    paths = [path for path, _, _ in parameters(law, "friction")]
    return tuple(path.rpartition(".")[2] for path in paths if path not in free)


def _influence(
    fit: TravelFit, trial: Trial, assumed: Sequence[str], t_end: float
) -> Mapping[str, float]:
    """Return how far each given parameter moves the travel [m], changed by half.

    A slope that is 0 is raised to half of what doubles friction at the largest speed.
    """
    found = {}
    quantities = fields_of(type(fit.law))
    for name in assumed:
        value = float(getattr(fit.law, name))
        moved, values = [0.0], [value * factor for factor in CHANGES]
        if value == 0.0 and quantities[name].scale == "slope":
            model = TravelModel(fit.law, [e.path for e in fit.estimates], t_end)
            values = [PART * doubling_slope(model, [trial], [e.value for e in fit.estimates])]
        for other in values:
            try:
                changed = vary(fit.law, "friction", {f"friction.{name}": other})
                travel = TravelModel(changed, (), t_end).travel(trial, ())
            except (ParameterError, SimulationError):
                continue
            moved.append(abs(travel - fit.predicted[0]))
        found[name] = max(moved)
    return found


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
