"""One law tried on the trials: as given, as fitted, and predicting each trial from the others."""

import dataclasses
from collections.abc import Mapping, Sequence

from stickslip.errors import ConvergenceError, ParameterError, SimulationError
from stickslip.friction import FrictionLaw
from stickslip.identification import (
    Start,
    TravelFit,
    TravelModel,
    Trial,
    check_rest,
    fit_trials,
    payable,
    required_of,
    starting_points,
)
from stickslip.quantities import fields_of, parameters, vary
from stickslip.selection.candidates import Watch
from stickslip.selection.criteria import Criteria, criteria_of
from stickslip.selection.leave_one_out import held_out_errors, root_mean_square
from stickslip.selection.travel_verdict import TravelCandidate
from stickslip.simulation import simulate
from stickslip.trajectory import Trajectory

CHANGES = (1.5, 1.0 / 1.5)
"""Factors on a parameter that was taken as given, to see whether the travel depends on it."""


def try_law(
    name: str,
    law: FrictionLaw,
    trials: Sequence[Trial],
    *,
    t_end: float,
    ordinary: bool,
    simpler: Sequence[TravelCandidate] = (),
    free: Sequence[str] | None = None,
    watch: Watch | None = None,
) -> TravelCandidate:
    """Fit one law; a law that cannot be fitted or run is kept with the reason."""
    report = None if watch is None else (lambda runs: watch(name, runs))
    _, given = _seen(trials[0], law, t_end)
    candidate = TravelCandidate(
        name=name, title=law.title, law=law, given=given, fit=None, run=None, criteria=None,
        ordinary=ordinary,
    )  # fmt: skip
    names = payable(law, trials) if free is None else free
    needed = [f"friction.{one}" for one in required_of(type(law))] if ordinary else []
    invented = tuple(path.rpartition(".")[2] for path in needed if path not in names)
    if invented and simpler:
        law = _scaled(law, invented, simpler)
    try:
        starts = _starts(law, names, trials, simpler, t_end, scanned=not (invented and simpler))
        fit = fit_trials(law, trials, free=names, starts=starts, t_end=t_end, watch=report)
        check_rest(fit, t_end)
        run, criteria = _seen(trials[0], fit.law, t_end, throw=True)
    except (ConvergenceError, SimulationError) as reason:
        return dataclasses.replace(candidate, dropped=str(reason))
    assumed = _assumed(law, fit)
    return dataclasses.replace(
        candidate,
        fit=fit,
        run=run,
        criteria=criteria,
        assumed=assumed,
        invented=invented,
        influence=_influence(fit, trials[0], assumed, t_end),
    )


def _starts(
    law: FrictionLaw,
    names: Sequence[str],
    trials: Sequence[Trial],
    simpler: Sequence[TravelCandidate],
    t_end: float,
    *,
    scanned: bool,
) -> list[Start] | None:
    """Return where searches on several trials begin: at simpler laws' fits, and where scans lead.

    A law with invented values is only shown beside the others: it begins at the richest fit.
    """
    if len(trials) < 2:
        return None
    found: list[Start] = []
    for other in simpler:
        values = {e.path: e.value for e in other.fit.estimates} if other.fit else {}
        if values and set(values) <= set(names):
            found.append([values.get(path, _absent(law, path)) for path in names])
    if found and not scanned:
        return found[-1:]
    return [*found, *starting_points(TravelModel(law, names, t_end), trials)]


def _scaled(
    law: FrictionLaw, invented: Sequence[str], simpler: Sequence[TravelCandidate]
) -> FrictionLaw:
    """Return a law whose ordinary level at rest is as far above sliding as it is by default."""
    fitted = {e.path: e.value for c in reversed(simpler) if c.fit for e in c.fit.estimates}
    quantities = fields_of(type(law))
    changes: dict[str, float] = {}
    for name in invented:
        base = quantities[name].at_least
        level = fitted.get(f"friction.{base}", 0.0)
        if base is not None and level > 0.0:
            over = getattr(law, name) / getattr(law, base)
            changes |= {f"friction.{base}": level, f"friction.{name}": over * level}
    return vary(law, "friction", changes)


def _absent(law: FrictionLaw, path: str) -> float:
    """Return the value of a parameter with which a law is nearest to one without it."""
    name = path.rpartition(".")[2]
    quantity = fields_of(type(law))[name]
    stiff = quantity.above is not None or quantity.at_least is not None
    return float(getattr(law, name)) if stiff else 0.0


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


def _assumed(law: FrictionLaw, fit: TravelFit) -> tuple[str, ...]:
    """Return the names of the parameters that were taken as given."""
    free = {estimate.path for estimate in fit.estimates}
    paths = [path for path, _, _ in parameters(law, "friction")]
    return tuple(path.rpartition(".")[2] for path in paths if path not in free)


def _influence(
    fit: TravelFit, trial: Trial, assumed: Sequence[str], t_end: float
) -> Mapping[str, float]:
    """Return how far each given parameter moves the travel [m], changed by half."""
    found = {}
    for name in assumed:
        value = float(getattr(fit.law, name))
        moved = [0.0]
        for factor in CHANGES:
            try:
                changed = vary(fit.law, "friction", {f"friction.{name}": value * factor})
                travel = TravelModel(changed, (), t_end).travel(trial, ())
            except (ParameterError, SimulationError):
                continue
            moved.append(abs(travel - fit.predicted[0]))
        found[name] = max(moved)
    return found
