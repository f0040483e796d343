"""The verb `select` for travels."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray
from scipy.special import ndtri

from stickslip.data import Measurement, check, refuse_faults
from stickslip.engine.simulation import simulate
from stickslip.errors import InputError
from stickslip.friction import FrictionLaw, law_type
from stickslip.identify import THRESHOLDS, TravelJudgement, band_of, judged_travels
from stickslip.identify.candidates import NOT_DISTINGUISHED, Watch, check_any, check_apart
from stickslip.identify.criteria import Criteria, criteria_of
from stickslip.identify.fits import (
    Estimate,
    Laws,
    Parameters,
    Trial,
    durations,
    starting_law,
    trials_of,
    under_cycles,
)
from stickslip.identify.kinds.travels.fit import rounded_setting, travel_fit
from stickslip.identify.kinds.travels.verdict import TravelCandidate, TravelVerdict
from stickslip.identify.kinds.travels.wording import wording
from stickslip.identify.projection import TOLERANCE
from stickslip.identify.propose import propose
from stickslip.mechanisms import Mechanism
from stickslip.quantities import parameters
from stickslip.show.formatting import joined

Array: TypeAlias = NDArray[np.float64]

BEYOND = (0.75, 1.5)
"""Least and largest settings of the band over those measured."""
ALONE = (0.4, 1.5)
"""The same where there is but one."""
RIG_DOUBT = 0.015
"""Prior deviation of forces over themselves, by a stiffness, mass or inertia whose uncertainty
nobody stated."""
PLACES = (17, 41)
"""Settings of the band within those measured, and of bodies that carry their drive, which have
resonances: half a second, and three (docs: explanation/travels)."""


def select_travels(
    mechanism: Mechanism,
    laws: Laws | None,
    measurement: Measurement,
    *,
    vary: str | Sequence[str] | None = None,
    fixed: Mapping[str, float] | None = None,
    assumed: Mapping[str, Sequence[str]] | None = None,
    t_end: float = 10.0,
    progress: Watch | None = None,
) -> TravelVerdict:
    """Fit laws to measured travels, and say which to use and what holds for all candidate laws.

    Examples
    --------
    >>> from stickslip import Coulomb, Measurement, SpringBlock, Viscous
    >>> rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    >>> reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    >>> verdict = select_travels(rig, [Coulomb, Viscous], reading)
    >>> verdict.best.name, verdict.ranked
    ('coulomb', False)
    """
    varied = Parameters.of(mechanism, None, vary, fixed, measurement=measurement)
    if varied.unknown:
        raise InputError(
            f"laws are compared by travels with the mechanism as it is given, and vary names"
            f" {joined(list(varied.unknown))}: fit these first with one law (fit takes the same"
            " vary), give the mechanism the values found and state their uncertainties, and compare"
            " laws then."
        )
    mechanism = varied.mechanism
    refuse_faults(measurement, mechanism)
    trials = trials_of(mechanism, measurement, t_end)
    if isinstance(laws, Mapping) and not laws:
        laws = None  # a rig file without friction values: the command tries the usual laws too
    named, ordinary = named_laws(laws)
    judgement = judged_travels(
        mechanism, trials, named, ordinary=ordinary, assumed=assumed, t_end=t_end, watch=progress
    )
    settings = band_settings(judgement)
    band = band_of(judgement.travels(settings)) if len(settings) else None
    candidates = _candidates(judgement, t_end)
    every = tuple(_any_law(judgement, one) for one in _estimates(candidates[0]))
    places, shrinks = _advised(judgement, settings)
    checks, findings = check(measurement, mechanism=mechanism), check(measurement).findings
    ranked = len(np.unique(judgement.blocks)) > 1
    return TravelVerdict(
        mechanism=mechanism,
        measurement=measurement,
        words=wording(judgement, candidates, every, settings, band, (places, shrinks), findings),
        candidates=tuple(candidates),
        best=candidates[0] if judgement.explained else None,
        ranked=ranked and judgement.explained,
        judgement=judgement,
        settings=settings,
        travel=band,
        checks=checks,
        intervals=every,
        places=places,
        shrinks=shrinks,
        t_end=t_end,
    )


def _advised(judgement: TravelJudgement, settings: Array) -> tuple[tuple[float, ...], float]:
    """Return the settings at which readings narrow the band of travels most, and by what.

    One stands for several readings; in all, they are no more than were made. No reading takes off
    what laws leave at settings that were not measured.
    """
    if judgement.knob is None or not len(settings):
        return (), 1.0
    travels = judgement.drawn_travels(settings)
    lasts = durations(judgement.at(settings), judgement.t_end)
    found = propose(
        travels, travels, judgement.noise(settings), taken=len(judgement.trials),
        rest=(judgement.discrepancy * lasts) ** 2,
    )  # fmt: skip
    path = judgement.knob[0]
    unit = {p: q.unit for p, q, _ in parameters(judgement.mechanism, "mechanism")}[path]
    places = sorted(rounded_setting(float(settings[k]), unit) for k in found.places)
    return tuple(places), found.shrinks


def named_laws(laws: Laws | None) -> tuple[dict[str, FrictionLaw] | None, set[str]]:
    """Return laws by name, None for the usual ones, and the names of those without values."""
    if laws is None:
        return None, set()
    if isinstance(laws, Mapping):
        return dict(laws), set()
    kinds = [law_type(one) if isinstance(one, str) else one for one in laws]
    check_any(kinds)
    check_apart([one.name for one in kinds])
    made = {one.name: starting_law(one) if isinstance(one, type) else one for one in kinds}
    return made, {one.name for one in kinds if isinstance(one, type)}


def band_settings(judgement: TravelJudgement) -> Array:
    """Return the settings over which the band is stated: those measured, between and beyond."""
    if judgement.knob is None:
        return np.zeros(0)
    known, count = judgement.settings, PLACES[under_cycles(judgement.trials)]
    low, high = float(known.min()), float(known.max())
    if low == high:
        return np.union1d(low * np.linspace(*ALONE, count), known)
    ends = sorted((BEYOND[0] * min(low, high, key=abs), BEYOND[1] * max(low, high, key=abs)))
    inner = np.linspace(low, high, count)
    beyond = [np.linspace(*pair, count // 4) for pair in ((ends[0], low), (high, ends[1]))]
    return np.unique(np.concatenate([known, inner, *beyond]))


def _seen(trial: Trial, law: FrictionLaw, t_end: float) -> Criteria:
    """Return what a run does in the terms of the paper."""
    end = trial.until(t_end)
    run = simulate(trial.mechanism, law, t_end=end, y0=trial.start(law), throw=False)
    return criteria_of(run, trial.mechanism, trial.travel)


def _estimates(candidate: TravelCandidate) -> Sequence[Estimate]:
    return candidate.fit.estimates if candidate.fit else ()


def _candidates(judgement: TravelJudgement, t_end: float) -> list[TravelCandidate]:
    """Return all laws: the named one first, then by their evidence, then those left out."""
    most = judgement.evidence[judgement.named]
    ranked = len(np.unique(judgement.blocks)) > 1
    first, found = judgement.trials[0], []
    for name, evidence in judgement.evidence.items():
        fit = travel_fit(judgement, name)
        law = judgement.law_of(name)
        found.append(
            TravelCandidate(
                name=name,
                title=law.law.title,
                law=law.law,
                fit=fit,
                given=_seen(first, law.law, t_end),
                criteria=_seen(first, fit.law, t_end),
                held_out=judgement.held_out(name) if ranked else None,
                share=judgement.shares[name],
                evidence=evidence - most,
                outcome=(
                    "named"
                    if name == judgement.named
                    else NOT_DISTINGUISHED
                    if name in judgement.set
                    else ""
                ),
            )
        )
    for name, (left, why) in judgement.dropped.items():
        found.append(
            TravelCandidate(
                name=name,
                title=left.title,
                law=left,
                fit=None,
                given=_seen(first, left, t_end),
                criteria=None,
                dropped=why,
            )
        )
    return found


def _any_law(judgement: TravelJudgement, own: Estimate) -> Estimate:
    """Return the interval of a parameter over all laws of the band that have it.

    No law is that of the ground to less than `TOLERANCE`, nor a rig as it is given to less than
    `RIG_DOUBT` where nobody stated how well it is known: what either makes of forces is beside what
    the readings leave, by the root of the sum of squares.
    """
    counts = {name: round(THRESHOLDS.draws * share) for name, share in judgement.shares.items()}
    parts = []
    for name, count in counts.items():
        if name and count and name in judgement.named_draws:
            values = judgement.values(name).get(own.path)
            if values is not None:
                parts.append(np.resize(values, count))
    if not judgement.explained:  # it is a parameter of a law that does not hold
        return replace(own, low=-math.inf, high=math.inf, reason="no law holds")
    if not parts or not own.bounded:
        return own
    tail = 0.5 * (1.0 - THRESHOLDS.interval)
    low, high = np.quantile(np.concatenate(parts), (tail, 1.0 - tail)).tolist()
    low, high = min(own.low, max(low, 0.0)), max(own.high, high)
    if own.quantity.scale.startswith(("level", "slope", "drag")):
        doubt = 0.0 if any(one.doubts or one.shared for one in judgement.trials) else RIG_DOUBT
        beside = math.hypot(TOLERANCE, doubt) * abs(own.value) * float(ndtri(1.0 - tail))
        low = max(own.value - math.hypot(own.value - low, beside), 0.0)
        high = own.value + math.hypot(high - own.value, beside)
    return replace(own, low=low, high=high)
