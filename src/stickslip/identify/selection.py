"""Selection: a measurement of each kind judged, with the verdict in words."""

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from stickslip.data import (
    Checks,
    Measurement,
    check,
    findings_text,
    refuse_lack,
    refuse_same,
    refuse_unused,
    without_outliers,
)
from stickslip.errors import InputError
from stickslip.friction import PARTS, FrictionLaw, law_type
from stickslip.identify.bands import PredictionBand
from stickslip.identify.ensemble import band_of
from stickslip.identify.fits import goes_straight, inside, load_of
from stickslip.identify.forces import doubts_of, load_slopes, with_gear
from stickslip.identify.judge import Judgement as RecordJudgement
from stickslip.identify.judgement import Judgement
from stickslip.identify.ladder import ladder_verdict, rest_sentence
from stickslip.identify.observer import Observer
from stickslip.identify.problem import MEMORY, Array, Family
from stickslip.identify.problems.record_signals import Record, records_of
from stickslip.identify.problems.records import (
    RecordsProblem,
    chance_of_records,
    unseen_length,
    with_hold,
)
from stickslip.identify.problems.tables import TableProblem, known_terms, readings_of
from stickslip.identify.projection import TOLERANCE
from stickslip.identify.propose import propose
from stickslip.identify.thresholds import THRESHOLDS
from stickslip.identify.verdict import BandVerdict, verdict_on
from stickslip.identify.wording import (
    DIFFER,
    ORDERED,
    OTHERS,
    SCALED,
    UNDAMPED,
    Words,
    hold_sentence,
    presliding_sentence,
    start_sentence,
    widened_sentence,
)
from stickslip.mechanisms import Mechanism
from stickslip.quantities import turned
from stickslip.quantities import vary as with_values
from stickslip.show.formatting import joined, quantity


def checked(
    mechanism: Mechanism,
    measurement: Measurement,
    validate: Measurement | None = None,
    which: str = "This record",
    *,
    unknown: Sequence[str] = (),
    conditions: Collection[str] = (),
) -> Checks:
    """Return what the record can tell; refuse one that cannot decide.

    Parameters of the mechanism that are fitted are named, and conditions of trials that are used.
    """
    if validate is not None:
        refuse_lack(measurement, validate, which="the second record")
        refuse_unused(validate, inside(mechanism, validate))
        refuse_same(measurement, validate)
        checked(
            mechanism,
            validate,
            which="The second record",
            unknown=unknown,
            conditions=conditions,
        )
    checks = check(measurement, mechanism=mechanism, vary=unknown, conditions=conditions)
    if checks.worst == "error":
        wrong = [one for one in checks.findings if one.severity == "error"]
        raise InputError(f"{which} cannot be used for a selection. {findings_text(wrong)}")
    return checks


def select_table(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    laws: Any = None,
    validate: Measurement | None = None,
    tolerance: float | None = None,
    route: str = "table",
) -> BandVerdict:
    """Judge a table of friction: which law, and what friction is whichever law holds.

    A law may be off by the `tolerance`, a share of friction.
    """
    checks = checked(mechanism, measurement, validate)
    families = None
    if laws is not None:
        families = families_of(laws, known_terms(readings_of(mechanism, measurement)))
        if not families:
            raise InputError("laws is empty: name at least one law, or leave it out.")
    problem = TableProblem.of(mechanism, measurement, families)
    judgement = Judgement(problem, tolerance=TOLERANCE if tolerance is None else tolerance)
    words = Words(
        measured="readings",
        held_out="speeds",
        response="friction",
        force_unit=measurement.unit("friction"),
        speed_unit=measurement.unit("velocity"),
    )
    asked, offered = problem.asked(), problem.offered()
    typical = problem.steady(asked, judgement.draws)
    # new readings do not take off by what runs differ, and what may drift
    rest = np.maximum(np.var(judgement.curves(asked), axis=0) - np.var(typical, axis=0), 0.0)
    proposal = propose(
        typical,
        problem.steady(offered, judgement.draws),
        problem.noise(offered),
        problem.table.total,
        rest,
    )
    inside, readings = math.nan, 0
    if validate is not None:
        other = readings_of(mechanism, validate)
        inside = _inside(judgement.reading_band(problem.like(other.rows)), other.friction)
        readings = len(other.friction)
    remarks = [ORDERED] * problem.model.is_sorted
    if problem.rests is not None:
        remarks.append(rest_sentence(problem.rests, words.speed_unit))
    return ladder_verdict(
        judgement,
        mechanism,
        measurement,
        words,
        checks=checks,
        proposal=proposal,
        places=tuple(float(offered.velocity[k]) for k in proposal.places),
        largest_speed=problem.model.frame.fastest,
        route=route,
        second=validate,
        inside=inside,
        readings=readings,
        remarks=tuple(remarks),
    )


def _inside(band: PredictionBand, values: Array) -> float:
    """Return the share of values (n,) that lie in a band."""
    return float(np.mean((band.low <= values) & (values <= band.high)))


def of_volts(checks: Checks) -> Iterable[str]:
    """Return what forces that were recorded in volts leave open."""
    return (one.sentence for one in checks.of("volts"))


def _is_held(measurement: Measurement) -> bool:
    """Return whether what drives the records may hold from sample to sample."""
    return all(not goes_straight(record, "zero") for record in measurement.records())


def _remarks(
    problem: RecordsProblem, judgement: RecordJudgement, validate: Measurement | None, unit: str
) -> list[str]:
    """Return what the number of records, a free motion and a balance leave to say.

    Places are said in their unit.
    """
    if len(problem.records) > 1:
        found = (DIFFER,) if chance_of_records(problem) <= THRESHOLDS.differ_chance else ()
    else:
        found = (OTHERS,) if validate is None else ()
    if judgement.ensemble.wider > THRESHOLDS.no_law_ratio:
        found = (widened_sentence(judgement.ensemble.wider),)
    said = [SCALED] if problem.free else []
    said += found
    if MEMORY in problem.family(judgement.named) and problem.memory == "lugre":
        said.append(UNDAMPED)
    first = problem.records[0]
    if begun := [one.began for one in problem.records if one.began is not None]:
        said.append(start_sentence([quantity(x, unit) for x in begun]))
    if first.hold_doubt and not problem.free:
        said.append(hold_sentence(held=first.held, doubt=first.hold_doubt))
    return said


def _problem(
    mechanism: Mechanism, records: Sequence[Record], *, vary: Sequence[str], offset: bool
) -> RecordsProblem:
    """Return records with the normal force, and the parameters that are looked for."""
    loads = [one.load for one in records if one.load is not None]
    slopes: dict[str, tuple[float, float]] = {}
    if loads:
        normal = float(np.exp(np.mean(np.log(np.concatenate(loads)))))
    else:
        doubts = {path: one.doubt for path, one in records[0].unknown.items() if one.doubt}
        normal, slopes = load_of(mechanism), load_slopes(mechanism, vary, doubts)
    constant = next((path for path in vary if path.endswith(".offset")), "offset" * offset)
    inertias = [path for path in vary if path not in records[0].unknown and path != constant]
    return RecordsProblem(
        records,
        normal=normal,
        inertia_path=inertias[0] if inertias else "",
        load_slopes=slopes,
        offset=constant,
    )


def only_laws(problem: RecordsProblem, families: Sequence[Family]) -> None:
    """Compare only laws of some families, with a memory or without as each says."""
    own = [tuple(name for name in one if name not in REMEMBERED) for one in families]
    problem.only = [tuple(sorted({*problem.always, *one})) for one in own]
    laws = [frozenset(name for name in one if problem.terms[name].role == "law") for one in own]
    named = {name for one in families for name in one if name in REMEMBERED}
    problem.memory = named.pop() if len(named) == 1 else problem.memory
    problem.remembering = {
        (law, one != family) for law, one, family in zip(laws, own, families, strict=True)
    }


def found_values(judgement: RecordJudgement) -> dict[str, float]:
    """Return parameters of the mechanism as they were found, by path."""
    rig = judgement.composition.rig
    return {path: float(x[0]) for path, x in rig.items() if path.startswith("mechanism.")}


def _judged(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    rig: Mechanism,
    laws: Any,
    vary: Sequence[str],
    offset: bool,
    hold: str | None,
) -> tuple[RecordsProblem, RecordJudgement]:
    """Return records as a problem and its judgement, with the torques that the gear of a rig has.

    Forces run between samples as `hold` says, or as the record shows.
    """
    seen = with_gear(rig, measurement)
    doubts = doubts_of(mechanism, measurement, vary)
    held = _is_held(measurement)
    records = records_of(mechanism, seen, unknown=vary, offset=offset, held=held, doubts=doubts)
    make = partial(_problem, mechanism, vary=vary, offset=offset)
    (problem,) = with_hold(make, [records], hold)
    if laws is not None:
        restrict(problem, laws)
    return problem, refined(RecordJudgement.of(problem))


def restrict(problem: RecordsProblem, laws: Any) -> None:
    """Compare only laws that a user asks for."""
    known = [
        name
        for name, term in problem.terms.items()
        if (term.role == "law" or name == "offset")
        # without a memory, a level that differs by direction is an offset
        and (name != "level_direction" or any(not any(shape[:1]) for shape in term.shapes))
    ]
    only_laws(problem, families_of(laws, [*known, *REMEMBERED]))


def refined(judgement: RecordJudgement) -> RecordJudgement:
    """Return a judgement of records refined by simulation."""
    return replace(judgement, ensemble=Observer(judgement.ensemble).refined())


def select_record(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    laws: Any = None,
    vary: Sequence[str] = (),
    offset: bool = True,
    hold: str | None = None,
    validate: Measurement | None = None,
    route: str = "balance",
) -> BandVerdict:
    """Judge records of one coordinate: which law, and what friction is whichever law holds.

    A constant force is among the terms with `offset`; `hold` says how the force runs between its
    samples, as in `RecordSettings`, and None that the record is to tell it.
    """
    checks = checked(mechanism, measurement, validate, unknown=vary)
    measurement, _ = without_outliers(measurement)
    judged = partial(
        _judged, mechanism, measurement, laws=laws, vary=vary, offset=offset, hold=hold
    )
    problem, judgement = judged(rig=mechanism)
    rig = mechanism
    if vary and "gear" in problem.terms:  # what a gear transmits follows from what was found
        rig = with_values(mechanism, "mechanism", found_values(judgement))
        problem, judgement = judged(rig=rig)
    others: list[Record] | None = None
    if validate is not None:
        again = with_gear(rig, validate)
        others = records_of(
            mechanism,
            again,
            unknown=vary,
            offset=offset,
            held=problem.records[0].held,
            doubts=doubts_of(mechanism, measurement, vary),
        )
    return record_verdict(
        problem,
        judgement,
        mechanism,
        measurement,
        checks=checks,
        route=route,
        second=validate,
        others=others,
        remarks=map(str, checks.of("outliers")),
    )


def record_verdict(
    problem: RecordsProblem,
    judgement: RecordJudgement,
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    checks: Checks,
    route: str,
    second: Measurement | None,
    others: Sequence[Record] | None,
    remarks: Iterable[str] = (),
) -> BandVerdict:
    """Return the verdict on records of one coordinate, with what other records say of it."""
    first = problem.records[0]
    words = Words(
        measured="record",
        held_out="stretches",
        response="force" if problem.finds_inertia else "friction",
        force_unit=measurement.unit("friction" if first.friction else "force"),
        speed_unit=measurement.unit("velocity"),
    )
    steady = problem.asked()
    inside, count = math.nan, 0
    if others is not None:
        other = problem.of(others)
        inside = _inside(judgement.reading_band(other.rows), other.response)
        count = len(other.response)
        judgement = judgement.widened_by(other)
    unseen = unseen_length(judgement.regression, judgement.named)
    unit = turned("m", measurement.turning)
    said = [presliding_sentence(quantity(unseen, unit, 2))] if unseen > 0.0 else []
    return verdict_on(
        judgement,
        mechanism,
        measurement,
        words,
        checks=checks,
        speeds=steady.velocity,
        band=band_of(judgement.ensemble.curves(steady)),
        largest_speed=problem.frame.top,
        route=route,
        second=second,
        inside=inside,
        readings=count,
        remarks=(*remarks, *said, *of_volts(checks), *_remarks(problem, judgement, second, unit)),
    )


# Laws that a user asks to compare, as families of terms.

IGNORED = ("peak", "step")
"""Optional parts: without a value for them, a law lacks them."""
NAMES: Mapping[str, str] = {"weight[transmitted]": "gear"}
"""Terms that are not called as the part is."""
REMEMBERED = ("dahl", "lugre")
"""Memories that records tell: they mark a family. The balance does not tell them apart, as the
damping of bristles is hardly a part of it."""
BOTH_WAYS: Mapping[str, str] = {
    "level": "level_direction",
    "stribeck": "stribeck_sides",
    "viscous": "viscous_direction",
}
"""Terms that make a part differ by direction."""


def family_of_law(law: FrictionLaw | type[FrictionLaw] | str, known: Collection[str]) -> Family:
    """Return the terms of a law among those that a measurement can tell.

    Examples
    --------
    >>> terms = ["level", "viscous", "stribeck"]
    >>> family_of_law("stribeck", terms)
    ('level', 'stribeck', 'viscous')
    >>> family_of_law("dahl", terms)
    Traceback (most recent call last):
    stickslip.errors.InputError: Dahl friction cannot be compared on this measurement, ...
    """
    kind = law_type(law) if isinstance(law, str) else law
    if kind.composition is None:
        raise InputError(
            f"{kind.title} friction cannot be compared on this measurement, as it is no sum of"
            f" parts: use stickslip.fit for its parameters. Compared can be {', '.join(known)} and"
            " sums of these."
        )
    found: set[str] = set()
    parts = [str(one) for one in kind.composition.parts()]
    both = any(part.startswith("both_ways") for part in parts)
    smooth = "tanh" in parts
    unknown = []
    inputs = [name.partition("[")[2].rstrip("]") for name in parts if name.startswith("linear[")]
    for part in parts:
        if part.startswith(("both_ways", "linear[")) or part in IGNORED:
            continue
        name = "tanh" if smooth and part == "level" else NAMES.get(part, part)
        if name not in known:
            unknown.append(part)
            continue
        found.add(name)
        other = BOTH_WAYS.get(name) if both else None
        if other == "level_direction" and other not in known:
            other = "offset"  # under one load they are the same
        if other is not None and other in known:
            found.add(other)
            found -= {"stribeck"} if other == "stribeck_sides" else set()
    text = str(kind.composition)
    for name in inputs:
        for part in ("level", "viscous"):
            if f"{part} * linear[{name}]" in text and f"{part}*{name}" in known:
                found.add(f"{part}*{name}")
    if unknown:
        memory = [one for one in unknown if one in PARTS and PARTS[one].role == "memory"]
        why = (
            "tells the memories of Dahl and LuGre, and only in time: use stickslip.fit for its"
            " parameters"
            if memory
            else f"is not explained by {joined(unknown)} here: use stickslip.fit for its parameters"
        )
        raise InputError(
            f"{kind.title} friction cannot be compared on this measurement, which {why}. Compared"
            f" can be {', '.join(known)} and sums of these."
        )
    return tuple(sorted(found))


def families_of(
    laws: Mapping[str, FrictionLaw] | Iterable[FrictionLaw | type[FrictionLaw] | str],
    known: Collection[str],
) -> tuple[Family, ...]:
    """Return the families of laws, each once."""
    given = laws.values() if isinstance(laws, Mapping) else laws
    return tuple(dict.fromkeys(family_of_law(law, known) for law in given))
