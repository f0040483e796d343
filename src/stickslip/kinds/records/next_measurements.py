"""Which measurements a selection on records proposes next."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from stickslip.errors import InputError
from stickslip.experiments import Measurement
from stickslip.identification import RecordFit, driven, inverse_dynamics, load_of
from stickslip.kinds.records.design.experiments import Experiment, design
from stickslip.kinds.records.design.predictors import Predictor
from stickslip.kinds.records.verdict import RecordCandidate
from stickslip.mechanisms import slip_of, stops_of
from stickslip.selection import Plan, one_way

RIVALS = 3
"""Laws that proposed measurements tell the best from, at most."""
LENGTH_DOUBT = 1e-4
"""What a position [m] is taken to be known to where only velocity was compared."""


def experiments_after(
    best: RecordCandidate, candidates: Sequence[RecordCandidate], plan: Plan
) -> tuple[Experiment, ...]:
    """Design measurements that tell the best from its rivals.

    These are what is within a tenth of its error and has nothing against it; if there is no such
    law, the next best that has nothing against it. Nothing is proposed that the rig cannot do: no
    constant speed or force where the record was not driven, no reversal where all motion went one
    way.
    """
    assert best.fit is not None
    others = [c for c in candidates if c.fit and c.name != best.name and not c.dropped]
    near = [c for c in others if c.score <= 1.1 * best.score]
    rivals = (near or others[:1])[:RIVALS]
    if not rivals or not _moves(best.fit) or not _actuated(best.fit):
        return ()
    try:
        dynamics = inverse_dynamics(best.fit.mechanism, best.fit.measurement, vary=())
    except InputError:  # too short to be filtered
        return ()
    # Where friction was measured no force was, and dynamics know nothing of its doubt.
    left = best.fit.rms if not best.fit.problem.simulates else float(np.std(dynamics.residual))
    correlated = plan.length / best.fit.inference.effective
    predictors = {c.name: predictor_of(c.fit) for c in [best, *rivals] if c.fit}
    return design(
        predictors,
        best=best.name,
        speed=float(np.percentile(np.abs(dynamics.velocity), 98.0)),
        force_doubt=lambda seconds: left * min(math.sqrt(correlated / seconds), 1.0),
        length_doubt=best.fit.rms if best.fit.problem.quantity == "position" else LENGTH_DOUBT,
        driven=not best.fit.friction_was_measured,
        turning=best.fit.measurement.turning,
        reach=reach_of(best.fit),
        sides=_sides(best.fit.measurement, dynamics.velocity),
    )


def _moves(fit: RecordFit) -> bool:
    """Whether a motion in time was measured."""
    known = {"position", "velocity"}.intersection(fit.measurement.quantities())
    return bool(known) and all(record.time is not None for record in fit.measurement.records())


def _actuated(fit: RecordFit) -> bool:
    """Whether something imposed the motion: a force, a reference, or a machine that measured."""
    return not fit.problem.simulates or driven(fit.measurement)


def _sides(measurement: Measurement, velocity: NDArray[np.float64]) -> tuple[float, ...]:
    """Return the directions that the body was moved in, by sign."""
    if one_way(measurement):
        return (1.0,) if float(np.sum(velocity)) >= 0.0 else (-1.0,)
    return (1.0, -1.0)


def reach_of(fit: RecordFit) -> tuple[float, float] | None:
    """Return between which positions [m] the body moves: its stops, or else where it was measured.

    A body that turned by more than a full turn may turn on. None where nothing is known.
    """
    seen = [
        np.asarray(record.values("position"))
        for record in fit.measurement.records()
        if "position" in record.quantities()
    ]
    sides: dict[str, float] = {}
    if seen:
        widest = max(seen, key=np.ptp)  # each record may count from a zero of its own
        sides = {"lower": float(widest.min()), "upper": float(widest.max())}
        if fit.measurement.turning and sides["upper"] - sides["lower"] > math.tau:
            sides = {"lower": -math.inf, "upper": math.inf}
    slip = slip_of(fit.mechanism)
    sides |= {one.side: one.position for one in stops_of(fit.mechanism) if one.coordinate == slip}
    return (sides["lower"], sides["upper"]) if len(sides) == 2 else None


def predictor_of(fit: RecordFit) -> Predictor:
    """Return a fit as what predicts measurements that have not been made."""
    return Predictor(
        law=fit.law,
        mechanism=fit.mechanism,
        load=load_of(fit.mechanism),
        inputs=fit.typical_inputs,
        estimates=dict(zip(fit.free_parameters.paths, fit.values.tolist(), strict=True)),
        errors=fit.inference.errors,
        correlation=fit.inference.correlation,
    )
