"""What a verdict on records says: second records, records that no law explains, proposals."""

import dataclasses
import json
import math

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    Measurement,
    RecordSettings,
    Stribeck,
    Viscous,
    check,
    fit,
    select,
    write_report,
)
from stickslip.documents import document, json_text
from stickslip.experiments.checking import stationarity
from stickslip.formatting import Scale
from stickslip.identification.estimation.halves import Halves
from stickslip.identification.results import ModelError
from stickslip.kinds.joints.admissibility import objection
from stickslip.kinds.records.design.experiments import design
from stickslip.kinds.records.design.predictors import Predictor
from stickslip.kinds.joints.ladder import IDLE
from stickslip.kinds.joints.sections.summary import opening_section
from stickslip.kinds.joints.judging import _on_second, verdict_on
from stickslip.kinds.joints.wording import equals_of, first_of, record_wording
from stickslip.selection.candidates import checked
from stickslip.selection.identifiable import settled_estimates
from stickslip.selection.verdict import corrections, score_text

AXIS = Axis(inertia=1.0)
QUICK = RecordSettings(starts=1)
LAWS = ["coulomb", "coulomb-viscous", "direction-dependent"]


TIME = np.linspace(0.0, 12.0, 240, endpoint=False)
RATE = 2.0 * math.pi / 3.0
PLACE, SPEED = -0.3 / RATE * np.cos(RATE * TIME + 0.3), 0.3 * np.sin(RATE * TIME + 0.3)


def rubbed(friction, **more):
    """A record of friction (n,) in time, along a motion that is measured to and fro."""
    return Measurement(time=TIME, position=PLACE, velocity=SPEED, friction=friction, **more)


def record(seed, *, forward=5.0, backward=5.0, level=2.0, noise=0.05, **more):
    """A record of friction whose viscous part may differ by direction."""
    slope = np.where(SPEED > 0.0, forward, backward)
    scatter = noise * np.random.default_rng([21, seed]).normal(size=SPEED.size)
    return rubbed(level * np.sign(SPEED) + slope * SPEED + scatter, **more)


def selected(first, second=None, laws=LAWS):
    return select(AXIS, laws, first, validate=second, settings=QUICK)


@pytest.fixture(scope="module")
def confirmed():
    return selected(record(1, forward=8.0), record(2, forward=8.0))


@pytest.fixture(scope="module")
def overturned():
    # first a seal drags in one direction, then in neither
    return selected(record(1, forward=8.0), record(2, forward=6.5, backward=6.5))


@pytest.fixture(scope="module")
def unexplained():
    return selected(rubbed(2.0 * np.random.default_rng(5).normal(size=TIME.size)))


@pytest.mark.slow
def test_the_error_on_a_second_record_stands_beside_the_first_in_the_first_paragraph(confirmed):
    assert confirmed.sentence == "Use direction-dependent friction."
    best, on_second = confirmed.best, confirmed.on_second
    held = confirmed.scale.estimate(best.score, best.score_error)
    assert confirmed.words.lede.startswith(f"Held-out error: {held} (")
    second = confirmed.scale.error(best.second.rms)
    said = f"On the second record: {second}; the choice holds there"
    assert said in confirmed.words.lede
    assert on_second.holds
    assert on_second.error == best.second.rms
    assert on_second.ratio == pytest.approx(best.second.rms / best.score)
    rows = confirmed.to_dataframe()
    assert rows["second_record"].tolist() == [c.second.rms for c in confirmed.candidates]
    content = json.loads(json_text(document("select", confirmed.to_dict())))
    assert content["second_record"]["holds"] is True
    assert content["best"] == "direction-dependent"


@pytest.mark.slow
def test_a_law_that_loses_on_the_second_record_is_not_recommended(overturned):
    assert overturned.best is None
    assert overturned.closest.name == "direction-dependent"
    own, other = (
        overturned.scale.quantity(e)
        for e in (overturned.on_second.error, overturned.on_second.rival_error)
    )
    assert overturned.sentence == (
        "Direction-dependent friction is chosen on the first record, but Coulomb + viscous friction"
        f" has a clearly smaller error on the second ({other} against {own})."
    )
    assert not overturned.on_second.holds
    assert overturned.on_second.rival == "coulomb-viscous"
    assert "the choice does not hold there (Coulomb + viscous: " in overturned.words.lede


@pytest.mark.slow
def test_a_difference_within_doubt_overturns_nothing():
    # the same machine: whichever law is a little nearer on the second record by chance
    for seed in range(6):
        found = selected(record(seed), record(100 + seed))
        assert found.on_second.holds
        assert found.best.name == "coulomb-viscous"


@pytest.mark.slow
def test_a_second_record_that_is_missed_by_several_times_the_held_out_error_says_so():
    found = selected(record(1), record(2, level=3.0))
    assert found.on_second.ratio > 5.0
    assert "times the held-out error; expect errors of this size on new data" in found.words.lede
    said = [line.partition(" (")[0] for line in found.words.measure_next]
    assert "Find what differs between the two records" in said
    assert "times the held-out" not in selected(record(1), record(2)).words.lede


@pytest.mark.slow
def test_a_record_that_no_law_explains_is_said_to_be_one(unexplained):
    assert unexplained.sentence.startswith(
        "No candidate explains this record: the held-out error of"
    )
    assert "of the variation of the friction itself" in unexplained.sentence
    assert unexplained.words.settles == ()
    assert "check the units" in unexplained.words.measure_next[0]
    assert unexplained.experiments == ()


@pytest.mark.parametrize("which", ["unexplained", "overturned"])
def test_where_no_law_is_recommended_json_files_and_page_agree(which, tmp_path, request):
    found = request.getfixturevalue(which)
    page = write_report(found, tmp_path, title="A record").read_text(encoding="utf-8")
    assert not (tmp_path / "law.toml").exists()
    content = json.loads((tmp_path / "verdict.json").read_text(encoding="utf-8"))
    assert content["best"] is None
    assert content["closest"] == found.closest.name
    assert content["verdict"] == found.sentence
    assert found.sentence in page.replace("\N{NO-BREAK SPACE}", " ")
    assert "chosen" not in {c["outcome"] for c in content["candidates"]}


@pytest.mark.slow
def test_contradictory_readings_are_seen_by_their_stated_uncertainty():
    one, other = (record(k, level=2.0 * k, noise=0.01).values("friction") for k in (1, 2))
    odd = np.arange(TIME.size) % 2
    both = rubbed(np.where(odd, one, other), uncertainty={"friction": 0.02})
    found = selected(both)
    assert found.best is None
    assert "times the stated uncertainty" in found.sentence
    # readings that agree within it, and errors that are large beside it but small beside friction
    assert selected(record(1, noise=0.02, uncertainty={"friction": 0.02})).best is not None
    assert selected(record(1, noise=0.02, uncertainty={"friction": 0.001})).best is not None


@pytest.mark.slow
def test_a_simple_law_within_the_stated_uncertainty_is_enough():
    asymmetric = {"forward": 5.3, "noise": 0.005}
    assert selected(record(1, **asymmetric)).best.name == "direction-dependent"
    stated = record(1, **asymmetric, uncertainty={"friction": 0.1})
    assert selected(stated).best.name != "direction-dependent"


def test_an_hour_of_running_is_proposed_only_where_something_drifts(confirmed):
    def proposed(checks):
        return " ".join(
            record_wording(
                confirmed.candidates, confirmed.best, None, {}, checks, (), scored=""
            ).measure_next
        )

    findings = confirmed.checks.findings
    assert all(one.kind != "drift" for one in findings)
    assert "after an hour" not in proposed(confirmed.checks)
    time, rng = np.arange(200.0), np.random.default_rng(3)
    warm = np.where(time < 100, 5.0, 4.9) + 0.01 * rng.normal(size=200)
    (drift,) = stationarity.drift([stationarity.Level("force", "force", warm, 5.0)])
    assert drift.severity == "info"
    drifting = dataclasses.replace(confirmed.checks, findings=(*findings, drift))
    assert "after an hour" in proposed(drifting)
    wrong = dataclasses.replace(findings[0], severity="warning", sentence="A gain is wrong.")
    numbers = {"samples": 3600, "independent": 17.2}
    few = dataclasses.replace(wrong, kind="effective size", numbers=numbers)
    said = record_wording(
        confirmed.candidates,
        confirmed.best,
        None,
        {},
        dataclasses.replace(confirmed.checks, findings=(wrong, few, drift, *findings)),
        confirmed.experiments[:1],
        scored="",
    ).measure_next
    assert said[0] == "First correct the record: A gain is wrong."
    *_, last = said  # what to measure comes after it
    assert len(said) == 3  # what else there is does not crowd it out
    assert last.startswith("Record for longer: ")


def test_what_no_correction_answers_is_not_called_one():
    v = np.linspace(0.01, 0.3, 30)
    one_way = check(Measurement(velocity=v, friction=2.0 + v))
    said = "All velocities are forward: friction level and offset cannot be separated."
    assert corrections(one_way) == (f"Measure in the other direction, too: {said}",)
    time = np.concatenate([np.arange(100), np.arange(140, 300)]) * 1e-3
    moved = Measurement(time=time, position=0.1 * time, force=np.full(time.size, 2.0))
    found = check(moved)
    assert {one.kind for one in found.findings if one.severity == "warning"} > {"gap"}
    (first,) = corrections(found)  # what can be corrected comes first
    assert first.startswith("First correct the record: Gap of ")


def test_few_independent_samples_ask_for_a_longer_record_and_not_for_a_correction(confirmed):
    few = dataclasses.replace(
        confirmed.checks.findings[0],
        kind="effective size",
        severity="warning",
        numbers={"samples": 3600, "independent": 17.3},
    )
    said = record_wording(
        confirmed.candidates,
        confirmed.best,
        None,
        {},
        dataclasses.replace(confirmed.checks, findings=(few,)),
        confirmed.experiments[:2],
        scored="",
    ).measure_next
    assert said[-1] == "Record for longer: the effective sample size is 17 of 3,600 samples."
    assert not any("correct the record" in line for line in said)


def designed(sides):
    laws = {"coulomb": Coulomb(kinetic_coefficient=2.0), "viscous": Viscous(viscous_coefficient=4)}
    return design(
        {name: Predictor(law=law, mechanism=AXIS, load=1.0) for name, law in laws.items()},
        best="coulomb",
        speed=0.5,
        force_doubt=lambda seconds: 0.1,
        length_doubt=1e-5,
        driven=True,
        sides=sides,
    )


def test_no_reversal_is_proposed_to_a_body_that_slides_one_way():
    both = " ".join(one.what for one in designed((1.0, -1.0)))
    assert "backwards" in both
    assert "alternating" in both
    forwards = " ".join(one.what for one in designed((1.0,)))
    assert "forwards" in forwards
    assert "backwards" not in forwards
    assert "to and fro" not in forwards


def test_a_law_that_reduces_to_the_chosen_one_contradicts_nothing():
    size, way = np.abs(SPEED), np.sign(SPEED)
    falling = way * (3.0 + 5.5 * size - 5.0 * size**2)
    found = selected(rubbed(falling), laws=["coulomb-viscous", "quadratic-drag"])
    drag = next(c for c in found.candidates if c.name == "quadratic-drag")
    assert drag.is_simpler == ("coulomb-viscous",)  # its drag would be negative
    assert found.best.name == "coulomb-viscous"
    assert set(found.picks.values()) <= {"coulomb-viscous", ""}
    assert "Criteria disagree" not in " ".join(found.words.cannot_tell)
    assert "Quadratic drag" not in found.words.lede


@pytest.mark.slow
def test_what_is_not_distinguished_is_listed():
    found = selected(record(3), laws=["coulomb-viscous", "power-viscous", "direction-dependent"])
    assert found.best.name == "coulomb-viscous"
    named = [c for c in found.candidates if "no significant improvement" in c.outcome]
    assert named
    assert "his record does not distinguish it from" in found.sentence + found.words.lede


@pytest.mark.slow
def test_a_law_that_was_not_scored_is_listed_if_the_criterion_prefers_it():
    found = selected(record(3), laws=["coulomb-viscous", "direction-dependent"])
    rich = next(c for c in found.candidates if c.name == "direction-dependent")
    idle = dataclasses.replace(rich, validation=None, dropped=IDLE)
    for change, listed in ((-1.0, ["direction-dependent"]), (1.0, [])):
        one = dataclasses.replace(idle, aic=found.best.aic + change)
        assert [c.name for c in equals_of(found.best, [found.best, one])] == listed


def test_scores_have_the_digits_that_their_standard_error_allows():
    assert score_text(Scale(1e3, "mm"), 0.00043, 0.000079) == ("0.43", "± 0.08")
    assert score_text(Scale(1.0, "N"), 1.0, math.inf) == ("1.00", "")
    assert score_text(Scale(1.0, "rad"), 0.2, 0.03) == ("0.20", "± 0.03")


def second_of(candidate, blocks):
    """A candidate with these errors on the second record."""
    blocks = tuple(blocks)
    rms = math.sqrt(sum(b * b for b in blocks) / len(blocks))
    second = dataclasses.replace(candidate.second, blocks=blocks, rms=rms)
    return dataclasses.replace(candidate, second=second)


def words_with(verdict, best, candidates=None, **more):
    """The words if the chosen law were this one."""
    others = verdict.candidates if candidates is None else candidates
    shown = [best if c.name == best.name else c for c in others]
    return record_wording(
        shown, best, None, verdict.picks, verdict.checks, (), scored="friction", **more
    )


def test_a_choice_that_cannot_be_simulated_on_the_second_record_does_not_hold(confirmed):
    best = second_of(confirmed.best, [math.inf, 0.1])
    others = [c for c in confirmed.candidates if c.name != best.name]
    found = _on_second(best, [best, *others])
    assert not found.holds
    assert found.rival in {c.name for c in others}
    said = words_with(confirmed, best, on_second=found)
    assert "against a simulation that fails" in said.verdict
    assert "the choice does not hold there" in said.lede
    failed = [second_of(c, [math.inf, 0.1]) for c in others]
    assert _on_second(best, [best, *failed]).finding == "cannot be tested (its simulation fails)"


def test_one_segment_of_a_second_record_cannot_judge_the_choice(confirmed):
    candidates = [second_of(c, [0.05]) for c in confirmed.candidates]
    best = next(c for c in candidates if c.name == confirmed.best.name)
    found = _on_second(best, candidates)
    assert found.holds  # nothing speaks against it
    said = words_with(confirmed, best, candidates, on_second=found).lede
    assert "the choice cannot be tested (only one segment) there" in said
    assert "holds" not in said


def with_errors(verdict, moved, **more):
    """The chosen law if residuals showed an error of the model that moves these paths."""
    late = ModelError(
        kind="delay", finding="It is late.", consequence="Much.", effect=1.0, interval=(0.5, 2.0),
        share=0.9, moved=moved,
    )  # fmt: skip
    fit = dataclasses.replace(verdict.best.fit, known_errors=(late,))
    return dataclasses.replace(verdict.best, fit=fit, **more)


def test_what_an_error_of_the_model_moves_is_not_settled(confirmed):
    known = settled_estimates(confirmed.best.fit)
    assert known
    moved = with_errors(confirmed, (known[0].path,)).fit
    assert settled_estimates(moved) == known[1:]
    assert settled_estimates(with_errors(confirmed, None).fit) == ()
    # the page's facts and lines quote none of them either
    found = dataclasses.replace(confirmed, best=with_errors(confirmed, None))
    (opening,) = opening_section(found, "").blocks
    assert opening.settles == ()
    assert not any("interval" in fact.what or "in reverse" in fact.what for fact in opening.facts)


@pytest.mark.slow
def test_an_error_of_the_model_hides_neither_doubts_nor_laws_not_distinguished():
    found = selected(record(3), laws=["coulomb-viscous", "power-viscous", "direction-dependent"])
    assert "does not distinguish it from" in found.sentence
    best = with_errors(found, None, doubt="the interval of $mu_k$ includes 0")
    rivals = [dataclasses.replace(c, simpler={}) for c in found.candidates]
    said = words_with(found, best, rivals)
    assert said.verdict.endswith("is chosen, but the model does not hold: it is late.")
    assert "parameters are identified: the interval of $mu_k$ includes 0." in said.lede
    assert "his record does not distinguish it from" in said.lede


def test_halves_that_contradict_each_other_stand_in_the_verdict(confirmed):
    fit = confirmed.best.fit
    count = len(fit.estimates)
    apart = Halves(
        values=(np.array([9.0, *fit.values[1:]]), np.array([1.0, *fit.values[1:]])),
        errors=np.full(count, 0.1),
        freedom=np.full(count, 6.0),
    )
    best = dataclasses.replace(confirmed.best, fit=dataclasses.replace(fit, halves=apart))
    said = words_with(confirmed, best).verdict
    assert "predicts best, but the two halves of the record disagree: " in said
    assert "= 9.0 and 1.0 N, a difference of 80 standard errors." in said


def judged_again(verdict, candidates):
    """The verdict on the same fits and held-out errors, with candidates changed."""
    return verdict_on(
        verdict.mechanism, verdict.measurement, candidates, None, verdict.plan,
        verdict.purpose.name, verdict.checks, None,
    )  # fmt: skip


def failed(candidate):
    """A candidate whose search failed."""
    why = "The search did not converge: Coulomb friction has a smaller residual."
    fit = dataclasses.replace(candidate.fit, search_failure=why)
    return dataclasses.replace(candidate, fit=fit, dropped=why.rstrip("."))


def test_a_law_whose_search_failed_is_not_chosen_where_another_is_left(confirmed):
    name = confirmed.best.name
    some = [failed(c) if c.name == name else c for c in confirmed.candidates]
    found = judged_again(confirmed, some)
    assert found.closest.name != name
    every = judged_again(confirmed, [failed(c) for c in confirmed.candidates])
    assert every.best is None
    assert every.closest.dropped.startswith("The search did not converge")
    assert every.sentence == (
        "No candidate passes all checks; direction-dependent friction fits best."
    )


def test_an_interval_that_reaches_0_is_no_objection_to_a_law_that_an_f_test_established(confirmed):
    def wide(candidate):
        first, *rest = candidate.fit.estimates
        estimates = (dataclasses.replace(first, low=-abs(first.low)), *rest)
        fit = dataclasses.replace(candidate.fit, estimates=estimates)
        return dataclasses.replace(candidate, fit=fit, dropped=objection(fit))

    name = confirmed.best.name
    some = [wide(c) if c.name == name else c for c in confirmed.candidates]
    assert any("includes 0" in c.dropped for c in some)
    assert judged_again(confirmed, some).sentence == "Use direction-dependent friction."
    # without a simpler candidate no test has established it
    alone = [c for c in some if c.name == name]
    found = judged_again(confirmed, [dataclasses.replace(c, simpler={}) for c in alone])
    assert "includes 0" in found.sentence


def test_a_law_with_several_objections_is_told_by_the_first():
    assert first_of("c is estimated as 0") == "c is estimated as 0"
    assert first_of("a is 0; b is 0") == "a is 0, and 1 more objection"


def test_a_table_of_candidates_has_plain_symbols(confirmed):
    objected = dataclasses.replace(confirmed.best, outcome="$sigma_2$ is estimated as 0")
    assert objected.to_row()["outcome"] == "sigma_2 is estimated as 0"


def test_of_several_objections_the_verdict_has_the_first_and_the_reasons_have_all(confirmed):
    doubted = dataclasses.replace(confirmed.best, doubt="a is 0; b is 0; c is 0")
    said = record_wording(
        [doubted if c.name == doubted.name else c for c in confirmed.candidates],
        doubted, None, {}, confirmed.checks, (), scored="",
    )  # fmt: skip
    assert said.verdict.endswith("are identified: a is 0, and 2 more objections.")
    assert "are identified: a is 0; b is 0; c is 0." in said.lede


def test_a_step_in_doubt_settles_no_static_level_and_no_velocity():
    v = np.linspace(-0.3, 0.3, 120)
    friction = 2.0 * np.sign(v) + 5.0 * v + 0.05 * np.random.default_rng(4).normal(size=120)
    found = fit(AXIS, Stribeck, Measurement(velocity=v, friction=friction), settings=QUICK)
    low = found.estimate("static_coefficient").low
    assert low <= found.estimate("kinetic_coefficient").high  # the step may be 0
    settled = {one.path for one in settled_estimates(found)}
    assert not {"friction.static_coefficient", "friction.stribeck_velocity"} & settled
    clear = 2.0 * np.sign(v) * (1.0 + np.exp(-np.square(v / 0.05))) + 5.0 * v
    found = fit(AXIS, Stribeck, Measurement(velocity=v, friction=clear), settings=QUICK)
    step = {"friction.static_coefficient", "friction.stribeck_velocity"}
    assert step <= {one.path for one in settled_estimates(found)}
    bound = dataclasses.replace(found, at_bounds={"friction.stribeck_velocity": "lower"})
    assert not step & {one.path for one in settled_estimates(bound)}


def test_a_mass_that_is_looked_for_is_no_fault_of_the_record():
    t = np.arange(0.0, 10.0, 0.01)
    v = 0.1 * (np.sin(2.5 * t) + 0.6 * np.sin(4.3 * t + 1.0))
    x = np.concatenate([[0.0], np.cumsum(0.005 * (v[1:] + v[:-1]))])
    force = 20.0 * np.gradient(v, t) + 0.5 * np.sign(v)
    record = Measurement(time=t, position=x, force=force)
    assert [one.kind for one in checked(AXIS, record).findings if one.severity == "warning"]
    found = checked(AXIS, record, unknown=["mechanism.inertia"])
    assert not [one for one in found.findings if one.kind == "units"]
    turned = dataclasses.replace(record, force=-force)
    assert checked(AXIS, turned, unknown=["mechanism.inertia"]).of("units")
