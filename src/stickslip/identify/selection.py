"""Selection: a measurement of each kind judged, with the verdict in words."""

import math
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

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
from stickslip.identify.bands import Array, Foreseen
from stickslip.identify.certificate import certificate_of
from stickslip.identify.compared import LawsToCompare, laws_for, laws_to_compare, with_own_laws
from stickslip.identify.fits import (
    Hold,
    goes_straight,
    inside,
    load_of,
    refuse_other_loads,
)
from stickslip.identify.forces import doubts_of, load_slopes, with_gear
from stickslip.identify.judgement import DRAWS, RIVAL, Judgement
from stickslip.identify.ladder import LEAST, ladder_verdict, rest_sentence
from stickslip.identify.posterior import Family
from stickslip.identify.problems.driven_runs import DrivenProblem, DrivenRuns, followed
from stickslip.identify.problems.free_balance import free_form, goes_on
from stickslip.identify.problems.free_motion import FreeMotionProblem
from stickslip.identify.problems.free_runs import AGAIN
from stickslip.identify.problems.record_checks import LIFTED, refuse_wrong_signs, settled
from stickslip.identify.problems.record_signals import NotToldError, Record, records_of
from stickslip.identify.problems.records import LOAD, RecordProblem
from stickslip.identify.problems.table_model import Rows
from stickslip.identify.problems.tables import TableProblem, known_terms, readings_of
from stickslip.identify.projection import TOLERANCE
from stickslip.identify.propose import (
    HALF,
    MOST,
    WORTH,
    Proposal,
    propose,
    rehearsed,
    widths_of_another,
    within_band,
)
from stickslip.identify.verdict import BandVerdict
from stickslip.identify.wording import (
    BOTH_WAYS,
    GAIN,
    NO_RECORDS,
    ORDERED,
    SCALED,
    Words,
    again_sentence,
    motions_sentence,
    start_sentence,
)
from stickslip.mechanisms import Mechanism
from stickslip.mechanisms.drives import SampledSwing
from stickslip.quantities import turned
from stickslip.quantities import vary as with_values
from stickslip.show.formatting import number, quantity

EACH = 60
"""Draws of each law of which it is rehearsed what readings come to."""


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
            mechanism, validate, which="The second record", unknown=unknown, conditions=conditions
        )
    checks = check(measurement, mechanism=mechanism, vary=unknown, conditions=conditions)
    if checks.worst == "error":
        wrong = [finding for finding in checks.findings if finding.severity == "error"]
        raise InputError(f"{which} cannot be used. {findings_text(wrong)}")
    return checks


def select_table(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    laws: Any = None,
    validate: Measurement | None = None,
    tolerance: float | None = None,
) -> BandVerdict:
    """Judge a table of friction: which law, and what friction is over all candidate laws.

    A law may be off by the `tolerance`, a share of friction.
    """
    checks = checked(mechanism, measurement, validate)
    asked = LawsToCompare()
    if laws is not None:
        table = readings_of(mechanism, measurement)
        asked = laws_to_compare(laws, known_terms(table), float(np.median(table.rows.load)))
    problem = with_own_laws(TableProblem.of(mechanism, measurement, asked.alone), asked)
    judgement = Judgement(problem, tolerance=TOLERANCE if tolerance is None else tolerance)
    words = Words(
        measured="readings",
        force_unit=measurement.unit("friction"),
        speed_unit=measurement.unit("velocity"),
    )
    proposal, chosen, *_ = further_readings(judgement)
    foreseer = partial(_foreseen_readings, judgement, mechanism)
    ordered_by = problem.model.ordered_by
    remarks = [ORDERED.format(ordered_by)] * bool(ordered_by)
    if len(problem.rests):
        remarks.append(rest_sentence(problem.rests, words.speed_unit))
    return ladder_verdict(
        judgement,
        mechanism,
        measurement,
        words,
        checks=checks,
        proposal=proposal,
        **settings_of(problem, chosen),
        largest_speed=problem.model.frame.fastest,
        route="table",
        foreseer=foreseer,
        second=validate,
        foreseen=None if validate is None else foreseer(validate),
        remarks=tuple(remarks),
    )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Wanted:
    """Friction as it is wanted: early, midway and late in a table."""

    rows: Rows
    """Where it is wanted (n,)."""
    grown: Array
    """How friction grows with the load there (n,)."""
    steady: Array
    """Its draws (k, n)."""
    rest: Array
    """The variance over the squared growth that no reading takes off (n,)."""
    made: int
    """Readings that were made."""

    def going(self, more: int) -> Array:
        """Return the variance (n,) that a drift is as it goes on while more readings are made.

        It goes on as it did from midway to the end.
        """
        first, middle, last = np.mean(self.steady / self.grown, axis=0).reshape(3, -1)
        further, slope = more / self.made, 2.0 * (last - middle)
        ends = [first, middle + 0.5 * further * slope, last + further * slope]
        return np.tile(np.var(ends, axis=0), 3)


def _wanted(judgement: Judgement) -> _Wanted:
    """Return where friction is wanted, and what is known of it."""
    problem = judgement.problem
    assert isinstance(problem, TableProblem)
    offered = problem.offered()
    times, n = (0.0, 0.5, 1.0), len(offered.velocity)
    rows = offered.where(np.tile(np.arange(n), len(times)))
    rows = replace(rows, order=np.repeat(times, n))
    steady = within_band(problem.steady(rows, judgement.draws))
    curves = within_band(judgement.curves(rows))
    # friction is as well known at each load, about
    grown = np.tile(problem.model.frame.grown(offered), len(times))
    # what runs differ, and ends that may be outliers, no reading takes off
    rest = np.maximum(np.var(curves, axis=0) - np.var(steady, axis=0), 0.0) / grown**2
    return _Wanted(
        rows=rows, grown=grown, steady=steady, rest=rest, made=problem.table.total
    )  # fmt: skip


def further_readings(
    judgement: Judgement, count: int | None = None
) -> tuple[Proposal, Rows, Array, "NDArray[np.bool_]"]:
    """Return which readings of a table to make, their rows in the order to make them, what comes.

    They are no more than were made, and end where little is left to gain, if no count is given.
    What comes are widths of the band (k,) over that of now, of which the proposal has the middle,
    and whether they leave one law (k,).
    """
    problem = judgement.problem
    assert isinstance(problem, TableProblem)
    wanted, offered = _wanted(judgement), problem.offered()
    noise, shared = problem.errors(offered)
    # none can be early or late in what was made
    midway = wanted.steady[:, len(noise) : 2 * len(noise)]
    proposal = propose(
        wanted.steady / wanted.grown, midway, noise,
        min(MOST, wanted.made) if count is None else count,
        wanted.rest, HALF if count is None else 0.0, shared, wanted.going,
    )  # fmt: skip
    rows = offered.where(np.array(proposal.places, dtype=np.intp))
    if not proposal.places:
        return proposal, rows, np.ones(1), np.zeros(1, dtype=bool)
    rows = rows.where(np.random.default_rng(0).permutation(len(rows.velocity)))
    known = problem.table.rows
    inputs = {name: _settable(x, known.inputs[name]) for name, x in rows.inputs.items()}
    rows = replace(rows, velocity=_settable(rows.velocity, known.velocity),
                   load=_settable(rows.load, known.load), inputs=inputs)  # fmt: skip
    widths, alone = foreseen_widths(judgement, rows, wanted)
    middle = float(np.median(widths))
    # what halves the band is not said of readings that are expected to do so
    halves = len(proposal.places) if middle <= 0.5 else proposal.halves
    return replace(proposal, shrinks=middle, halves=halves), rows, widths, alone


def _settable(values: Array, known: Array) -> Array:
    """Return values (n,) with three digits, or more if what is known (m,) spans less than them."""
    span = float(np.ptp(known))
    if not span:
        return np.full(len(values), known[0])
    sizes = np.minimum(np.where(values, np.abs(values), span), span)
    places = (2 - np.floor(np.log10(sizes))).astype(int).tolist()
    return np.array([round(x, n) for x, n in zip(values.tolist(), places, strict=True)])


def settings_of(problem: TableProblem, rows: Rows) -> dict[str, Any]:
    """Return velocities of rows, and loads and inputs where these differ, as a verdict has them."""
    loads = {LOAD: rows.load} if problem.model.frame.loaded else {}
    conditions = {name: tuple(x.tolist()) for name, x in (loads | {**rows.inputs}).items()}
    return {"places": tuple(rows.velocity.tolist()), "conditions": conditions}


def with_readings(measurement: Measurement, rows: Rows) -> Measurement:
    """Return a table with rows to fill in, whose friction is 0 so far; of trials as another one.

    Rows are in SI; inputs that did not change have their value in them too.
    """
    first, *others = measurement.records()
    new: dict[str, Any] = {"velocity": rows.velocity, "friction": 0.0 * rows.velocity}
    new |= {} if first.load is None else {LOAD: rows.load}
    new |= {"force": rows.inputs["motor"]} if "motor" in rows.inputs.keys() - first.inputs else {}
    inputs = {name: rows.inputs.get(name, np.full(len(rows.velocity), np.median(x)))
              for name, x in first.inputs.items()}  # fmt: skip
    if others:
        return Measurement(**new, inputs=inputs, turning=measurement.turning)
    shape = np.shape(first.values("friction"))

    def longer(own: Any, more: Array) -> Array:
        return np.append(np.broadcast_to(own, shape), more)

    new = {name: longer(first.values(name), x) for name, x in new.items()}
    return Measurement(
        **new, conditions=first.conditions,
        inputs={name: longer(first.inputs[name], x) for name, x in inputs.items()},
        uncertainty={name: longer(x, np.full(len(rows.velocity), np.median(x)))
                     for name, x in first.uncertainty.items() if name in new},
        uncertainty_kind=first.uncertainty_kind, turning=measurement.turning,
    )  # fmt: skip


def foreseen_widths(
    judgement: Judgement, rows: Rows, wanted: _Wanted
) -> tuple[Array, "NDArray[np.bool_]"]:
    """Return to which widths of the band readings at rows may come, and whether they leave one law.

    Rows are in SI, widths (k,) over that of now; laws (k,) that are one already are not left by
    them. Laws are those of a thousandth of the likeliest's mass.
    """
    problem = judgement.problem
    assert isinstance(problem, TableProblem)
    posterior, model, taken = problem.posterior, problem.model, len(rows.velocity)
    aims, grown = wanted.rows, wanted.grown
    rest = wanted.rest + wanted.going(0), wanted.rest + wanted.going(taken)
    noise, shared = problem.errors(rows)
    far = np.array([model.unexplained(x) for x in posterior.nodes])[:, None]
    far = far > judgement.tolerance * problem.size
    is_far = np.broadcast_to(far if far.any() else ~far, posterior.weights.shape)
    least = LEAST * max(rung.adequate for rung in judgement.rungs)
    laws = [(x.adequate, problem.holds(x.family) & ~far)
            for x in judgement.rungs if x.adequate > least]  # fmt: skip
    laws.append((float(posterior.weights[far[:, 0]].sum()), is_far))
    midway, every = replace(rows, order=np.full(taken, 0.5)), []
    for mass, only in laws:
        draws = posterior.draws(EACH, seed=1, only=only)
        asked, read = (within_band(problem.steady(at, draws)) for at in (aims, midway))
        every.append((mass, asked / grown, read))
    sizes = np.hypot([*map(model.sigma, posterior.nodes)], np.median(problem.table.stated))
    sizes, weights = np.log(sizes), posterior.weights.sum(axis=1)
    share = taken / (taken + problem.table.total)
    doubt = math.sqrt(share * float(weights @ (sizes - weights @ sizes) ** 2))
    widths, alone = rehearsed(every, np.diag(noise**2) + shared, rest, doubt, RIVAL)
    return widths, alone & (len(judgement.set) > 1)


def _foreseen_readings(
    judgement: Judgement, mechanism: Mechanism, measurement: Measurement
) -> Foreseen:
    """Return what is foreseen of another table."""
    problem, other = judgement.problem, readings_of(mechanism, measurement)
    assert isinstance(problem, TableProblem)
    rows = problem.like(other.rows)
    return judgement.foreseen(rows, other.friction, measurement.unit("friction"))


def _foreseen_records(
    judgement: Judgement,
    judged: Measurement,
    again: Callable[[Measurement], Sequence[Record]],
    measurement: Measurement,
) -> Foreseen:
    """Return what is foreseen of records of another run."""
    problem, records = judgement.problem, again(measurement)
    assert isinstance(problem, RecordProblem | DrivenProblem | FreeMotionProblem)
    rows = problem.like(records)
    kind = "friction" if records[0].friction else "force"
    if isinstance(problem, FreeMotionProblem):
        kind = "position" if problem.balance.each[0].record.located else "velocity"
    return judgement.foreseen(rows, rows.response, judged.unit(kind))


def _records_again(
    rig: Mechanism, made: Callable[..., list[Record]], measurement: Measurement
) -> list[Record]:
    """Return records of another run of a mechanism that was found."""
    return made(rig, with_gear(rig, measurement))


def _divided(
    made: Callable[..., list[Record]], gain: float, rig: Mechanism, measurement: Measurement
) -> list[Record]:
    """Return records whose forces are divided by a gain that was found."""
    return [
        replace(item, force=(item.force + item.constant) / gain - item.constant)
        for item in made(rig, measurement)
    ]


def _known_by_runs(
    runs: DrivenRuns, made: Callable[..., list[Record]], rig: Mechanism, measurement: Measurement
) -> list[Record]:
    """Return records of a mechanism that runs told."""
    return runs.known(made(rig, measurement, linear=False))


def _is_held(measurement: Measurement) -> bool:
    """Return whether what drives the records may hold from sample to sample."""
    return all(not goes_straight(record, "zero") for record in measurement.records())


def problem_of_records(
    mechanism: Mechanism,
    records: Sequence[Record],
    *,
    vary: Sequence[str] = (),
    offset: bool = True,
    families: Sequence[Family] | None = None,
    turning: bool = False,
    highest: float = math.inf,
    timed: bool = False,
) -> RecordProblem | FreeMotionProblem:
    """Return records with the normal force, and the parameters that are looked for.

    A constant force is among these with `offset`. What nothing drives is a free motion. It may be
    known how forces run between samples (`timed`).
    """
    loads = [record.load for record in records if record.load is not None]
    slopes: dict[str, tuple[float, float]] = {}
    doubts = {path: item.doubt for path, item in records[0].unknown.items() if item.doubt}
    if loads:
        if not all(np.all(load > 0.0) for load in loads):
            raise InputError(LIFTED)
        normal = float(np.exp(np.mean(np.log(np.concatenate(loads)))))
    else:
        normal, slopes = load_of(mechanism), load_slopes(mechanism, vary, doubts)
    constant = next((path for path in vary if path.endswith(".offset")), "offset" * offset)
    sought = [path for path in vary if path != constant]
    inertias = [path for path in sought if path not in records[0].unknown]
    if inertias and all(
        record.mechanism is None and not np.ptp(record.force) for record in records
    ):
        _refuse_scale(inertias[0], records)
    if free_form(records):
        return FreeMotionProblem(
            records,
            normal=normal,
            sought=sought,
            load_slopes=slopes,
            deviations=doubts,
            families=families,
        )
    return RecordProblem(
        records,
        normal=normal,
        inertia_path=inertias[0] if inertias else "",
        load_slopes=slopes,
        offset=constant,
        families=families,
        turning=turning,
        highest=highest,
        timed=timed,
    )


def _refuse_scale(inertia: str, records: Sequence[Record]) -> None:
    """Refuse an inertia beside friction where one force, or none, acts one way."""
    if not records[0].friction and not records[0].driven and goes_on(records):
        raise InputError(
            f"vary: {inertia}: the force that moves the body never changes, and less inertia with"
            " other friction explains the motion as well. Give its value, or record under a force"
            " that changes."
        )


def select_record(
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    laws: Any = None,
    vary: Sequence[str] = (),
    offset: bool = True,
    hold: Hold | None = None,
    validate: Measurement | None = None,
    tolerance: float | None = None,
) -> BandVerdict:
    """Judge records of one coordinate: which law, and what friction is over all candidate laws.

    A constant force is among the terms with `offset`; `hold` says how the force runs between its
    samples, as in `RecordSettings`. A law may be off by the `tolerance`, a share of friction.
    """
    refuse_other_loads(mechanism, measurement)
    checks = checked(mechanism, measurement, validate, unknown=vary)
    measurement, _ = without_outliers(measurement)
    held = hold != "first" and _is_held(measurement)
    doubts = doubts_of(mechanism, measurement, vary)
    made = partial(records_of, unknown=vary, offset=offset, held=held, doubts=doubts)
    problem_of = partial(
        problem_of_records, vary=vary, offset=offset, turning=measurement.turning,
        timed=hold is not None,
    )  # fmt: skip
    runs = followed(mechanism, measurement, vary, doubts=doubts, offset=offset, hold=hold)
    if runs is None:
        rig = settled(mechanism, measurement, vary, offset=offset)
    else:
        rig, made = runs.on(mechanism), partial(_known_by_runs, runs, made)
    records = made(rig, with_gear(rig, measurement))
    refuse_wrong_signs(records)
    asked = laws_for(laws, records, load_of(rig))
    problem = problem_of(rig, records, families=asked.alone)
    values = _values_of(problem) if isinstance(problem, RecordProblem) else {}
    if values:  # what a gear transmits follows from what the balance says of the mechanism
        rig = with_values(rig, "mechanism", values)
        problem = problem_of(rig, made(rig, with_gear(rig, measurement)), families=asked.alone)
    gain = problem.gain() if isinstance(problem, RecordProblem) and runs is None else 1.0
    if gain != 1.0:
        made = partial(_divided, made, gain)
        problem = problem_of(rig, made(rig, with_gear(rig, measurement)), families=asked.alone)
    if isinstance(problem, RecordProblem) and any(x.bent for x in records[0].unknown.values()):
        _refuse_outside(problem)
    verdict = record_verdict(
        with_own_laws(problem, asked)
        if runs is None or not runs.is_followed
        else _driven_problem(problem, runs, asked),
        mechanism,
        measurement,
        offset=not offset,
        tolerance=tolerance,
        checks=checks,
        route="balance",
        second=validate,
        other=validate,
        again=partial(_records_again, rig, made),
        remarks=[
            *map(str, checks.of("outliers")),
            *([runs.sentence] if runs and runs.sentence else []),
            *_of_recorded_swings(mechanism),
        ],
    )
    if gain == 1.0:
        return verdict
    words = verdict.words
    said = f"! {GAIN.format(number(gain, 3))} {words.verdict.removeprefix('! ')}"
    return replace(verdict, words=replace(words, verdict=said))


def _of_recorded_swings(mechanism: Mechanism) -> list[str]:
    """Return a sentence for each recorded motion that drives, whose error no interval holds."""
    units = dict(zip(mechanism.coordinates, mechanism.units, strict=True))
    drives = mechanism.drives()
    guided = ((name, drives[guide.drive]) for name, guide in mechanism.guided().items())
    return [
        f"The motion of {name} is a recorded one, whose acceleration has a standard error of"
        f" {quantity(drive.acceleration_error, f'{units[name]}/s^2')} from noise, beside what its"
        " smoothing flattens: neither is part of the intervals."
        for name, drive in guided
        if isinstance(drive, SampledSwing)
    ]


def _driven_problem(
    plain: RecordProblem | FreeMotionProblem, runs: DrivenRuns, asked: LawsToCompare
) -> DrivenProblem:
    """Return what runs say of laws, linear about what is likeliest and follows best."""
    assert isinstance(plain, RecordProblem)
    tried = list[tuple[float, DrivenProblem]]()
    following: DrivenRuns | None = runs
    while following is not None and len(tried) <= AGAIN:
        problem: DrivenProblem = with_own_laws(DrivenProblem(plain, following), asked)
        left, following = problem.straight()
        tried.append((left, problem))
    return min(tried, key=lambda item: item[0])[1]


def _refuse_outside(problem: RecordProblem) -> None:
    """Refuse parameters that end outside their range: with them nothing has a scale."""
    unknown = problem.records[0].unknown
    for path, x in problem.rig(problem.posterior.draws(DRAWS)).items():
        one, middle = unknown.get(path), float(np.median(x))
        if one is None or not one.bent or one.limits[0] <= middle - one.given <= one.limits[1]:
            continue
        name = path.removeprefix("mechanism.")
        raise NotToldError(
            f"vary: beside the others {name} ends at {middle:.3g}, outside its range: these records"
            " do not tell them together. Give the value of one."
        )


def _values_of(problem: RecordProblem) -> dict[str, float]:
    """Return what the balance says of a mechanism with a gear that transmits what changes.

    Parameters about which forces are slopes stay where a plain balance leaves least: taken again
    where the posterior is, forces by place could stand for all others.
    """
    if not problem.model.frame.transmitted:
        return {}
    unknown, values = problem.records[0].unknown, dict[str, float]()
    for path, x in problem.rig(problem.posterior.draws(DRAWS)).items():
        one, middle = unknown.get(path), float(np.median(x))
        inside = one is None or one.limits[0] < middle - one.given < one.limits[1]
        if "." in path and inside and not (one is not None and one.bent):
            values[path] = middle
    return values


def record_verdict(
    problem: RecordProblem | DrivenProblem | FreeMotionProblem,
    mechanism: Mechanism,
    measurement: Measurement,
    *,
    offset: bool,
    tolerance: float | None,
    checks: Checks,
    route: str,
    second: Measurement | None,
    other: Measurement | None,
    again: Callable[[Measurement], Sequence[Record]],
    remarks: Iterable[str] = (),
) -> BandVerdict:
    """Return the verdict on records of one coordinate, with what a second measurement says of it.

    Records of that, or of any `other`, are had by `again`.

    Levels hold a constant `offset` where the mechanism has none.
    """
    judgement = Judgement(
        problem, tolerance=TOLERANCE if tolerance is None else tolerance, offset=offset
    )
    first = problem.records[0]
    words = Words(
        measured="records" if len(problem.records) > 1 else "record",
        force_unit=measurement.unit("friction" if first.friction else "force"),
        speed_unit=measurement.unit("velocity"),
    )
    foreseer = partial(_foreseen_records, judgement, measurement, again)
    said = [*remarks, *(item.sentence for item in checks.of("volts"))]
    if isinstance(problem, FreeMotionProblem):
        said += [SCALED, *([] if problem.balance.goes_on else [BOTH_WAYS])]
    if begun := [record.began for record in problem.records if record.began is not None]:
        unit = turned("m", measurement.turning)
        said.append(start_sentence([quantity(x, unit) for x in begun]))
    rows, next_, widths = problem.asked(), list[str](), tuple[float, ...]()
    if not isinstance(problem, FreeMotionProblem):
        widths = widths_of_another(*problem.run_sizes, 0.5 * judgement.known, problem.runs)
        proposal = Proposal(places=(), shrinks=widths[0])
    else:
        share = problem.start_of(judgement.draws)
        further = problem.further(judgement.draws, share)
        proposal = Proposal(places=(), shrinks=further[0])
        next_ += [motions_sentence(further, share)] * (further[0] < WORTH)
    if second is None and (problem.runs < 2 or (widths and widths[0] < WORTH)):
        bands = judgement.band(rows), judgement.band(rows, new=True)
        next_.append(again_sentence(*bands, widths, problem.runs, words.force_unit))
    elif second is None and widths:
        next_.append(NO_RECORDS)
    verdict = ladder_verdict(
        judgement,
        mechanism,
        measurement,
        words,
        checks=checks,
        proposal=proposal,
        places=(),
        advice=next_,
        largest_speed=float(np.max(np.abs(rows.velocity))),
        route=route,
        foreseer=foreseer,
        second=second,
        foreseen=None if other is None else foreseer(other),
        remarks=said,
    )
    return certified(verdict)


def certified(verdict: BandVerdict) -> BandVerdict:
    """Return a verdict with a run of what it hands over, and what is to be said of that."""
    seen, words = certificate_of(verdict.judgement, verdict.mechanism), verdict.words
    if seen is None:
        return verdict
    if isinstance(seen, str):
        return replace(verdict, words=replace(words, cannot_tell=(*words.cannot_tell, seen)))
    warned = [seen.warning] * (verdict.best is not None and bool(seen.warning))
    said = replace(
        words,
        verdict=" ".join((*warned, words.verdict)),
        lede=f"{words.lede} {seen}",
    )
    return replace(verdict, certificate=seen, words=said)
