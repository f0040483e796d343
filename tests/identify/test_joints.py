"""Selection for several joints: each is judged by its own balance, links from all together."""

import json
from dataclasses import replace

import numpy as np
import pytest
from jsonschema import Draft202012Validator
from tests.arm_cases import ARM, GUESSED, JOINTS, LINEAR, TRUTH, motion, parts, record
from tests.identify.test_links import (
    DESK,
    LEVELS,
    SLOPES,
    excited,
    of_other_links,
    undamped,
)

from stickslip import (
    DirectionDependent,
    Measurement,
    RecordSettings,
    Stribeck,
    fit,
    load_rig,
    select,
    simulate,
    write_report,
)
from stickslip.errors import InputError
from stickslip.identify import JointVerdict
from stickslip.identify.problems.joints import JointRecords
from stickslip.mechanisms import read_urdf

STRIBECK = Stribeck(
    kinetic_coefficient=0.15, static_coefficient=0.4, stribeck_velocity=0.8,
    viscous_coefficient=0.02,
)  # fmt: skip


@pytest.fixture(scope="module")
def verdict():
    return select(GUESSED, None, record(0), vary=LINEAR, validate=record(1))


def covered(verdict, joint, law):
    """Return the part of the speeds at which the true friction of a joint lies in its band."""
    v = verdict.joints[joint].speeds
    band, true = verdict.band(v, joint=joint), law.force(v, 1.0)
    return np.mean((band.low <= true) & (true <= band.high))


def test_the_law_of_each_joint_is_named_and_its_band_holds_the_friction(verdict):
    assert verdict.best.name == "shoulder=coulomb-viscous,elbow=coulomb-viscous"
    assert verdict.sentence.startswith("Shoulder: use Coulomb + viscous friction")
    assert "Elbow: use Coulomb + viscous friction" in verdict.sentence
    for joint in JOINTS:
        own = verdict.joints[joint]
        assert covered(verdict, joint, TRUTH[joint]) >= 0.93
        width = np.mean(own.friction.high - own.friction.low) / np.mean(np.abs(own.friction.median))
        assert width < 0.1  # noise is a tenth of the friction of the elbow
        assert own.inside > 0.9  # of the readings of a second record
        assert own.findings == ()
        assert own.score_unit == "N m"


def test_each_joint_is_followed_by_a_run_with_the_motion_of_the_others_known(verdict):
    for joint in JOINTS:
        seen = verdict.joints[joint].certificate
        assert seen.run_error < 0.1
        assert 0.9 < seen.friction_work < 1.1


def test_links_are_found_with_the_laws(verdict):
    found = verdict.best.fit
    for name in LINEAR:
        estimate = found.estimate(f"mechanism.{name}")
        assert estimate.low <= getattr(ARM, name) <= estimate.high
        assert estimate.high - estimate.low < 0.1 * getattr(ARM, name)
        assert getattr(found.mechanism, name) == estimate.value
    level = found.estimate("friction.elbow.kinetic_coefficient")
    assert level.low <= TRUTH["elbow"].kinetic_coefficient <= level.high


def test_draws_are_laws_of_all_joints_that_run(verdict):
    drawn = verdict.sample(10)
    # at a speed: what is no law is measured levels
    levels = np.array([[one[joint].force(1.0, load=1.0) for joint in JOINTS] for one in drawn])
    true = [TRUTH[joint].force(1.0, load=1.0) for joint in JOINTS]
    assert np.all(levels.std(axis=0) > 0.0)
    assert levels.mean(axis=0) == pytest.approx(true, rel=0.05)
    run = simulate(verdict.best.fit.mechanism, drawn[0], t_end=0.2, y0={"elbow": 1.0})
    assert run.certificate.certified


def test_a_joint_that_is_not_there_is_refused(verdict):
    with pytest.raises(InputError, match="joint must be shoulder or elbow, got 'wrist'"):
        verdict.band([0.1], joint="wrist")


def test_the_document_of_joints_is_what_the_schema_says(verdict):
    content = json.loads(json.dumps(verdict.to_dict()))
    schema = JointVerdict.schema()
    Draft202012Validator.check_schema(schema)
    assert content.keys() <= schema["properties"].keys()
    Draft202012Validator(schema).validate(content)
    assert content["joints"]["elbow"]["best"] == "coulomb-viscous"


def test_a_report_has_a_figure_for_each_joint_and_the_laws_as_a_rig_file(verdict, tmp_path):
    text = write_report(verdict, tmp_path).read_text()
    for part in ("joint-1", "joint-2", "mechanism", "reproduce"):
        assert f'id="{part}"' in text
    assert "could not be produced" not in text
    rig = load_rig(tmp_path / "law.toml")
    assert rig.law_by_contact() == dict(verdict.law.members)
    assert rig.mechanism.upper_inertia == verdict.best.fit.mechanism.upper_inertia


def test_records_of_another_measurement_are_made_once_for_all_joints(verdict, monkeypatch):
    numbers, made = [], JointRecords._made

    def counted(*given):
        numbers.append(len(numbers))
        return made(*given)

    monkeypatch.setattr(JointRecords, "_made", counted)
    seen = verdict.predict(record(2, span=4.0))
    assert [*seen] == [*JOINTS]
    assert numbers == [0]


def test_what_is_said_of_a_joint_that_turns_is_in_newton_metres(verdict):
    for own in verdict.joints.values():
        assert own.judgement.problem.turning


@pytest.mark.slow
def test_zeros_of_positions_differ_from_record_to_record():
    """Zeros of .03 rad are .09 N m of gravity: half of the friction of the shoulder."""
    rng = np.random.default_rng(4)

    def displaced(seed, zeros):
        one = record(seed, span=6.0, name=str(seed))
        t, q, forces = parts(one)
        q = {name: q[name] - x for name, x in zip(JOINTS, zeros, strict=True)}
        return Measurement(time=t, position=q, force=forces, name=one.name)

    several = [displaced(k, 0.03 * rng.normal(size=2)) for k in range(4)]
    found = select(
        GUESSED, ["coulomb-viscous"], Measurement(trials=tuple(several)), vary=LINEAR,
        validate=displaced(9, (0.02, -0.03)),
    )  # fmt: skip
    for name in LINEAR:
        estimate = found.closest.fit.estimate(f"mechanism.{name}")
        assert abs(estimate.value - getattr(ARM, name)) < 2.0 * estimate.half_width
        assert estimate.half_width < 0.02 * getattr(ARM, name)
    for name, own in found.joints.items():
        assert own.inside >= 0.9
        rows = own.judgement.problem.at(np.array([-1.0, 1.0]))
        curves = own.judgement.curves(rows)
        low, high = np.quantile(0.5 * (curves[:, 1] - curves[:, 0]), (0.025, 0.975))
        assert low <= TRUTH[name].force(1.0, 1.0) <= high  # the mean zero is a constant force


@pytest.mark.slow
@pytest.mark.parametrize("seed", [5, 7])
def test_a_short_record_tells_links_and_friction_of_another_motion(seed):
    """Rows of two seconds are few beside links of three joints: the band of balances is wider."""
    robot = undamped(read_urdf(DESK).robot)
    given = excited(robot, seed, noise=0.02, seconds=2.0)
    found = select(
        of_other_links(robot, 3), ["coulomb-viscous"], given, vary=["friction.*", "links"]
    )
    second = found.predict(excited(robot, seed + 1, noise=0.02, seconds=2.0))
    for (name, own), level, slope in zip(found.joints.items(), LEVELS, SLOPES, strict=True):
        v, band = own.speeds, own.friction
        true = level * np.sign(v) + slope * v
        assert np.mean((band.low <= true) & (true <= band.high)) >= 0.93
        assert second[name].inside >= 0.9
        assert second[name].error < 0.1 * level


@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 12])
def test_laws_of_different_kinds_are_named_over_two_records(seed):
    several = [record(10 * seed + k, {**TRUTH, "shoulder": STRIBECK}) for k in range(2)]
    found = select(GUESSED, None, Measurement(trials=tuple(several)), vary=LINEAR)
    kept = {name: {candidate.name for candidate in own.candidates if candidate.outcome}
            for name, own in found.joints.items()}  # fmt: skip
    assert all("stribeck" in text for text in kept["shoulder"])
    assert "coulomb-viscous" in kept["elbow"]
    assert covered(found, "shoulder", STRIBECK) >= 0.93
    assert covered(found, "elbow", TRUTH["elbow"]) >= 0.93


@pytest.mark.slow
def test_a_level_that_differs_by_direction_is_in_the_band():
    """It is the same along a record as a constant force."""
    law = DirectionDependent(
        forward_kinetic_coefficient=0.15, backward_kinetic_coefficient=0.25,
        forward_viscous_coefficient=0.02, backward_viscous_coefficient=0.02,
    )  # fmt: skip
    found = select(GUESSED, None, record(5, {**TRUTH, "shoulder": law}), vary=LINEAR)
    assert covered(found, "shoulder", law) >= 0.93
    named = {one.path: one for one in found.joints["shoulder"].parameters}
    for side, level in (("forward", 0.15), ("backward", 0.25)):
        one = named[f"friction.{side}_kinetic_coefficient"]
        assert one.low <= level <= one.high


@pytest.mark.slow
def test_a_late_force_of_one_joint_is_a_delay_of_that_joint():
    t, places, forces = parts(record(4))
    late = np.interp(t - 0.01, t, forces["elbow"])
    given = Measurement(time=t, position=places, force={**forces, "elbow": late})
    found = select(ARM, None, given)
    (late,) = (one for one in found.joints["elbow"].findings if one.term == "delay")
    assert late.asserted
    assert -late.size == pytest.approx(0.01, rel=0.3)
    assert not any(one.asserted for one in found.joints["shoulder"].findings)


@pytest.mark.slow
def test_exchanged_joints_are_said_in_the_verdict_and_among_the_checks():
    t, places, forces = parts(record(0, span=4.0))
    swapped = {"shoulder": forces["elbow"], "elbow": forces["shoulder"]}
    wrong = Measurement(time=t, position=places, force=swapped)
    found = select(GUESSED, ["coulomb"], wrong, vary=LINEAR)
    assert found.best is None
    assert "The forces of shoulder and elbow seem to be exchanged" in found.sentence
    assert found.checks.findings[0].severity == "warning"


def test_a_joint_that_rests_is_said_and_the_other_judged():
    t, q, _, _ = motion(0)
    still = {"shoulder": q[:, 0], "elbow": np.full_like(t, 0.3)}
    sound = record(0)
    given = replace(sound, joints={}, position=still, force=parts(sound)[2])
    found = select(ARM, ["coulomb-viscous"], given)
    assert found.resting == ("elbow",)
    assert "Elbow: at rest, so its friction is unknown." in found.sentence
    assert [*found.joints] == ["shoulder"]


@pytest.mark.parametrize("verb", [select, fit])
def test_settings_of_searches_have_no_effect_on_joints(verb):
    law = "coulomb" if verb is fit else ["coulomb"]
    with pytest.raises(InputError, match=r"RecordSettings\.starts .* no effect on records of sev"):
        verb(ARM, law, record(0, span=2.0), settings=RecordSettings(starts=2))
