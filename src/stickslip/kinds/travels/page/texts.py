"""Words and numbers that several sections of the report share."""

from typing import Final

import numpy as np

from stickslip.formatting import Scale, quantity
from stickslip.friction import FrictionLaw
from stickslip.identification import Estimate, Trial, trials_of
from stickslip.kinds.travels.verdict import TravelCandidate, TravelVerdict
from stickslip.mechanisms import slip_of
from stickslip.quantities import fields_of
from stickslip.selection import score_scale

SAMPLES: Final = 4000


def estimate_range(estimate: Estimate) -> str:
    """Return the interval of an estimate, or why it has no end."""
    text = estimate.range
    return f"{text}: {estimate.reason}" if estimate.reason and not estimate.bounded else text


def assumptions(candidate: TravelCandidate) -> str:
    """Return the parameters that were neither measured nor fitted, with their values."""
    law: FrictionLaw = candidate.fit.law if candidate.fit else candidate.law
    quantities = fields_of(type(law))
    parts = [
        f"${quantities[name].symbol}$ {quantity(value, quantities[name].unit)}"
        for name in candidate.assumed
        for value in [getattr(law, name)]
        if value  # a viscous part of 0 is the absence of an assumption
    ]
    switch = ["held at its first stop"] if getattr(law, "static_switch", False) else []
    return ", ".join([*parts, *switch]) or "nothing"


def score_scale_of(verdict: TravelVerdict) -> Scale:
    """Return what held-out errors [m] are shown in."""
    return score_scale([c.score for c in verdict.candidates], "m")


def slip_and_rate(verdict: TravelVerdict) -> tuple[str, str]:
    """Return the names of the slipping coordinate and of its rate."""
    slip = slip_of(verdict.mechanism)
    return slip, verdict.mechanism.rates[verdict.mechanism.coordinates.index(slip)]


def travels(verdict: TravelVerdict) -> tuple[float, ...]:
    """Return the measured travels [m], one a reading, whatever quantity was read."""
    return tuple(trial.travel for trial in _trials(verdict))


def measured_band(verdict: TravelVerdict) -> tuple[float, float] | None:
    """Return the range of the first measured travel [m], None if it has no stated doubt."""
    first = _trials(verdict)[0]
    half = first.half_width
    return (first.travel - half, first.travel + half) if half else None


def _trials(verdict: TravelVerdict) -> tuple[Trial, ...]:
    return trials_of(verdict.mechanism, verdict.measurement, verdict.t_end)


def largest_difference(verdict: TravelVerdict, candidate: TravelCandidate) -> float | None:
    """Return how far a law is from the chosen one on the way at most [m]."""
    if verdict.best is None or verdict.best.run is None or candidate.run is None:
        return None
    slip, _ = slip_and_rate(verdict)
    one, other = verdict.best.run, candidate.run
    last = min(one.span[1], other.span[1])
    times = np.union1d(np.linspace(0.0, last, SAMPLES), one.t[one.t <= last])
    return float(np.max(np.abs(one.at(times)[slip] - other.at(times)[slip])))
