"""Fits a law to travels: distances to rest, or per cycle of a drive."""

from collections.abc import Callable, Collection, Mapping, Sequence

import numpy as np

from stickslip.data import Measurement, refuse_faults
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw
from stickslip.identify import INSENSITIVE, THRESHOLDS, TravelJudgement, fitted_travels
from stickslip.identify.fits import (
    LAW,
    Estimate,
    Parameters,
    Trial,
    is_rig,
    starting_law,
    trials_of,
    with_known,
)
from stickslip.identify.kinds.travels.result import TravelFit
from stickslip.mechanisms import Mechanism
from stickslip.quantities import Quantity, parameters
from stickslip.show.formatting import count, joined, number

WIDER = "the trials tell no more than that it is of this size"
"""Why an estimate is open whose interval is wider than the value."""


def fit_travels(
    mechanism: Mechanism,
    law: FrictionLaw | type[FrictionLaw],
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    t_end: float = 10.0,
    progress: Callable[[float], object] | None = None,
) -> TravelFit:
    """Fit a law to travels by runs to rest; arguments and errors as in `stickslip.fit`.

    The fit is that of `select` with this law alone. Parameters that travels hardly tell are tried
    on a grid of plausible values, and intervals hold all that explain the travels.

    Examples
    --------
    >>> from stickslip import SpringBlock, Viscous
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> found = fit_travels(rig, Viscous, Measurement(travel=0.20, uncertainty=0.005))
    >>> print(f"{found.law.viscous_coefficient:.2f}")
    5.73
    """
    chosen = Parameters.of(mechanism, law, vary, fixed, measurement=measurement)
    given = chosen.law
    start = with_known(starting_law(given), chosen.known) if isinstance(given, type) else given
    trials = trials_of(chosen.mechanism, measurement, t_end)
    refuse_faults(measurement, mechanism)
    check_rig(trials, chosen.unknown)
    named: list[str] | None = None
    if chosen.free is not None:
        named = [path.removeprefix("friction.") for path in chosen.free if path != LAW]
        asked = [*named, *chosen.unknown]
        if len(asked) > len(trials):
            raise InputError(
                f"{count(len(trials), 'travel')} cannot determine {len(asked)} parameters: vary"
                f" fewer of {', '.join(asked)}, or measure more trials."
            )
        if LAW in chosen.free:
            named += [name for name in start.fit_order if name not in (*named, *chosen.known)]
    judgement = fitted_travels(
        chosen.mechanism,
        trials,
        start,
        named=named,
        rig=chosen.unknown,
        known=chosen.known,
        given=not isinstance(given, type),
        t_end=t_end,
        watch=progress,
    )
    paths = (f"friction.{name}" for name in named or ())
    return travel_fit(judgement, start.name, {*paths, *chosen.unknown})


def check_rig(trials: Sequence[Trial], rig: Sequence[str]) -> None:
    """Refuse parameters of the mechanism that travels cannot tell, or that a trial has set."""
    if not rig:
        return
    settings = len({trial.setting for trial in trials})
    if settings <= len(rig) + 1:
        needed = f"{joined(list(rig))} and a level of friction"
        raise InputError(
            f"travels of {count(settings, 'setting')} cannot determine {needed}: that takes at"
            f" least {len(rig) + 2} different settings. Measure more, or vary fewer."
        )
    rigs = [
        {path: (one, value) for path, one, value in parameters(trial.mechanism, "mechanism")}
        for trial in trials
    ]
    for path in rig:
        if path not in rigs[0]:
            raise InputError(
                f"{path} has no value from which a search could begin: give it one in the rig file."
            )
        one, value = rigs[0][path]
        if value == 0.0 and (one.low == 0.0 or one.above is not None):
            raise InputError(
                f"{path} ({one.symbol}) is 0 {one.unit}, from which no search can begin:"
                " give a value of the right order of magnitude."
            )
        values = {known[path][1] for known in rigs}
        if len(values) > 1:
            raise InputError(
                f"trials set {path} themselves, from {number(min(values))} to"
                f" {number(max(values))} {one.unit}: it cannot be fitted as one value for all"
                " of them. Leave these values out, or do not vary it."
            )
        if any(path in trial.doubts or path in trial.shared for trial in trials):
            raise InputError(
                f"{path} is fitted, and an uncertainty was stated for it: leave one of both out."
            )


def travel_fit(judgement: TravelJudgement, name: str, named: Collection[str] = ()) -> TravelFit:
    """Return a law as a fit: its coefficients with their 95 % intervals if it holds.

    Coefficients that the travels hardly depend on are left out, but for the first and those that
    are `named`, which have no interval then.
    """
    law = judgement.law_of(name)
    unknowns = judgement.unknowns_of(name)
    values, paths = law.values(unknowns[None])[0], law.model.free
    draws, limits = judgement.values(name), _limits(law.quantities)
    untold, zero = judgement.untold(name), judgement.around_zero(name)
    tail, sources = 0.5 * (1.0 - THRESHOLDS.interval), judgement.sources(name)
    alone = ""
    if not judgement.stated and len(judgement.trials) == 1:
        alone = "no uncertainty of the reading was stated"
    estimates = []
    for i, (path, one) in enumerate(zip(paths, law.quantities, strict=True)):
        asked, coefficient = path in named, i < law.count
        if not asked and i > 0 and (path in untold or not coefficient):
            continue
        value = float(values[i])
        low, high = np.quantile(draws[path], (tail, 1.0 - tail)).tolist()
        low = 0.0 if path in zero and not is_rig(path) else low
        reason = INSENSITIVE if path in untold else alone
        if is_rig(path) and high - low > abs(value):
            reason = reason or WIDER
        estimates.append(
            Estimate(
                path=path,
                quantity=one,
                value=value,
                low=-np.inf if reason else min(max(low, limits[i]), value),
                high=np.inf if reason else max(high, value),
                interval="95 %",
                reason=reason,
                sources=sources[i] if sources and not reason and i < len(sources) else {},
            )
        )
    table = np.array([draws[one.path] for one in estimates])
    spread = np.where(table.std(axis=1) > 0.0, table.std(axis=1), 1.0)
    scaled = (table - table.mean(axis=1, keepdims=True)) / spread[:, None]
    correlation = np.clip(scaled @ scaled.T / table.shape[1], -1.0, 1.0)
    np.fill_diagonal(correlation, 1.0)
    trials = tuple(law.model.set_up(trial, values.tolist()) for trial in judgement.trials)
    return TravelFit(
        law=law.with_unknowns(unknowns),
        mechanism=trials[0].mechanism,
        estimates=tuple(estimates),
        measured=tuple(judgement.measured.tolist()),
        predicted=tuple(judgement.predicted(name).tolist()),
        runs=law.model.runs,
        standard_errors=tuple(judgement.errors.tolist()),
        stated=judgement.stated,
        misfit=judgement.misfit,
        correlation=tuple(map(tuple, correlation.tolist())),
        trials=trials,
    )


def _limits(quantities: Sequence[Quantity]) -> list[float]:
    """Return the least values that estimates have."""
    return [max(one.low, -np.inf if one.above is None else one.above) for one in quantities]
