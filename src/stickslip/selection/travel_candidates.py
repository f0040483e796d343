"""One law tried on the trials: as given, as fitted, and predicting each trial from the others."""

import dataclasses
from collections.abc import Callable, Mapping, Sequence

from stickslip.errors import ConvergenceError, ParameterError, SimulationError
from stickslip.friction import FrictionLaw
from stickslip.identification.fitting import fit_trials
from stickslip.identification.results import TravelFit
from stickslip.identification.travel import TravelModel, Trial
from stickslip.quantities import parameters, vary
from stickslip.selection.criteria import Criteria, criteria_of
from stickslip.selection.scoring import held_out_errors, root_mean_square
from stickslip.selection.verdict import Candidate
from stickslip.simulation import simulate
from stickslip.trajectory import Trajectory

__all__ = ["Watch", "try_law"]

Watch = Callable[[str, int], object]
CHANGES = (1.5, 1.0 / 1.5)
"""Factors on a parameter that was taken as given, to see whether the travel depends on it."""


def try_law(
    name: str,
    law: FrictionLaw,
    trials: Sequence[Trial],
    *,
    t_end: float,
    ordinary: bool,
    watch: Watch | None,
) -> Candidate:
    """Try one law; a law that cannot be fitted or run is kept with the reason."""
    report = None if watch is None else (lambda runs: watch(name, runs))
    _, given = _seen(trials[0], law, t_end)
    candidate = Candidate(
        name=name, law=law, given=given, fit=None, run=None, criteria=None, dropped="",
        score=None, score_error=None, ordinary=ordinary,
    )  # fmt: skip
    try:
        fit = fit_trials(law, trials, t_end=t_end, watch=report)
        run, criteria = _seen(trials[0], fit.law, t_end, throw=True)
        errors = _held_out(law, trials, fit, t_end, report)
    except (ConvergenceError, SimulationError) as reason:
        return dataclasses.replace(candidate, dropped=str(reason))
    score, score_error = root_mean_square(errors) if errors else (None, None)
    assumed = _assumed(law, fit)
    return dataclasses.replace(
        candidate,
        fit=fit,
        run=run,
        criteria=criteria,
        score=score,
        score_error=score_error,
        held_out=errors,
        assumed=assumed,
        influence=_influence(fit, trials[0], assumed, t_end),
    )


def _seen(
    trial: Trial, law: FrictionLaw, t_end: float, *, throw: bool = False
) -> tuple[Trajectory, Criteria]:
    run = simulate(trial.mechanism, law, t_end=t_end, y0=trial.start(law), throw=throw)
    return run, criteria_of(run, trial.mechanism, trial.travel)


def _held_out(
    law: FrictionLaw,
    trials: Sequence[Trial],
    fit: TravelFit,
    t_end: float,
    report: Callable[[int], object] | None,
) -> tuple[float, ...]:
    """Return the held-out errors, none where the trials repeat one setting."""
    if len({trial.setting for trial in trials}) < 2:
        return ()
    free = [estimate.path for estimate in fit.estimates]
    return held_out_errors(law, trials, free=free, t_end=t_end, watch=report)


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
