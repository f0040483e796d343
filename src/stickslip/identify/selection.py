"""Selection: a measurement of each kind judged, with the verdict in words."""

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from stickslip.experiments import Measurement, speeds_in_order
from stickslip.formatting import quantity
from stickslip.identification import load_of
from stickslip.identify.advice import Proposal, propose
from stickslip.identify.ensemble import band_of
from stickslip.identify.judge import Judgement
from stickslip.identify.kinds.record_signals import records_of
from stickslip.identify.kinds.records import RecordsProblem, readings
from stickslip.identify.kinds.tables import TableProblem
from stickslip.identify.observer import Observer
from stickslip.identify.requests import families_of
from stickslip.identify.verdict import BandVerdict, verdict_on
from stickslip.identify.wording import ORDERED, OTHERS, Words
from stickslip.mechanisms import Mechanism
from stickslip.selection import checked


def select_table(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    laws: Any = None,
    validate: Measurement | None = None,
    route: str = "force-map",
) -> BandVerdict:
    """Judge a table of friction: which law, and what friction is whichever law holds."""
    checks = checked(mechanism, measurement, validate)
    problem = TableProblem.of(mechanism, measurement)
    if laws is not None:
        problem.only = families_of(laws, problem.terms)
    judgement = Judgement.of(problem)
    words = Words(
        measured="readings",
        held_out="speeds",
        force_unit=measurement.unit("friction"),
        speed_unit=measurement.unit("velocity"),
    )
    asked = problem.asked()
    curves = judgement.ensemble.curves(asked)
    band = band_of(curves)
    offered = problem.offered()
    proposal = propose(
        curves, judgement.ensemble.curves(offered), judgement.noise(offered), len(problem.response)
    )
    places = tuple(float(offered.velocity[k]) for k in proposal.places)
    inside = math.nan
    if validate is not None:
        other = TableProblem.of(mechanism, validate)
        low, high = np.quantile(
            judgement.readings(problem.like(other.rows)), (0.025, 0.975), axis=0
        )
        inside = float(np.mean((other.response >= low) & (other.response <= high)))
    ordered = speeds_in_order(problem.rows.velocity)
    return verdict_on(
        judgement,
        mechanism,
        measurement,
        words,
        checks=checks,
        speeds=asked.velocity,
        band=band,
        proposal=proposal,
        places=places,
        place_text=[quantity(v, words.speed_unit, 2) for v in places],
        largest_speed=problem.frame.fastest,
        route=route,
        second=validate,
        inside=inside,
        readings=0 if validate is None else len(other.response),
        remarks=(ORDERED,) if ordered else (),
    )


def select_record(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    laws: Any = None,
    vary: Sequence[str] = (),
    validate: Measurement | None = None,
    route: str = "balance",
) -> BandVerdict:
    """Judge records of one coordinate: which law, and what friction is whichever law holds."""
    checks = checked(mechanism, measurement, validate, unknown=vary)
    held = "force" in measurement.quantities()
    normal, unit = load_of(mechanism), {"find_inertia": bool(vary), "held": held}
    records = records_of(mechanism, measurement, **unit)
    loads = [one.load for one in records if one.load is not None]
    if loads:
        normal = float(np.exp(np.mean(np.log(np.concatenate(loads)))))
    path = vary[0] if vary else "mechanism.inertia"
    problem = RecordsProblem(records, normal=normal, inertia_path=path)
    if laws is not None:
        asked = families_of(laws, problem.terms)
        problem.only = [tuple(sorted({*problem.always, *one})) for one in asked]
    judgement = Judgement.of(problem)
    refined = Observer(judgement.ensemble).refined()
    judgement = replace(judgement, ensemble=refined)
    words = Words(
        measured="record",
        held_out="stretches",
        force_unit=measurement.unit("friction" if records[0].friction else "force"),
        speed_unit=measurement.unit("velocity"),
    )
    steady = problem.asked()
    band = band_of(judgement.ensemble.curves(steady))
    inside, count = math.nan, 0
    if validate is not None:
        other = problem.of(records_of(mechanism, validate, **unit))
        found = readings(judgement.ensemble, judgement.regression.held_out(judgement.named), other)
        inside = float(np.mean((other.response >= found.low) & (other.response <= found.high)))
        count = len(other.response)
    return verdict_on(
        judgement,
        mechanism,
        measurement,
        words,
        checks=checks,
        speeds=steady.velocity,
        band=band,
        proposal=Proposal(places=(), shrinks=1.0),
        places=(),
        place_text=(),
        largest_speed=problem.frame.top,
        route=route,
        second=validate,
        inside=inside,
        readings=count,
        remarks=() if validate is not None or len(records) > 1 else (OTHERS,),
    )
