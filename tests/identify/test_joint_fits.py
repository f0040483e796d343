"""Fits of several joints at once: synthetic truth, what a record cannot tell, and refusals."""

from dataclasses import replace

import numpy as np
import pytest
from tests.arm_cases import ARM, GUESSED, JOINTS, LINEAR, QUICK, TRUTH, motion, parts, record

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    Measurement,
    Stribeck,
    check,
    export,
    fit,
    load_rig,
)
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError, ParameterError
from stickslip.friction import Laws

BOTH = dict.fromkeys(JOINTS, CoulombViscous)


@pytest.fixture(scope="module")
def measured():
    return record(0, name="first")


@pytest.fixture(scope="module")
def found(measured):
    return fit(GUESSED, BOTH, measured, vary=["friction.*", *LINEAR], settings=QUICK)


TRUE_VALUES = {
    **{f"mechanism.{name}": getattr(ARM, name) for name in LINEAR},
    **{f"friction.{name}.kinetic_coefficient": TRUTH[name].kinetic_coefficient for name in JOINTS},
    **{f"friction.{name}.viscous_coefficient": TRUTH[name].viscous_coefficient for name in JOINTS},
}


@pytest.mark.slow
def test_intervals_hold_the_laws_of_both_joints_and_the_base_parameters():
    """Of 32 intervals of four records; nominally 95 % are right, fewer than 26 are 1 in 1,000."""
    held = 0
    for seed in range(1, 5):
        own = fit(GUESSED, BOTH, record(seed), vary=["friction.*", *LINEAR], settings=QUICK)
        assert {e.path for e in own.shown} == set(TRUE_VALUES)
        held += sum(e.low <= TRUE_VALUES[e.path] <= e.high for e in own.shown)
    assert held >= 26


def test_the_saved_laws_of_joints_keep_their_intervals(found, measured, tmp_path):
    found.save(tmp_path / "law.toml")
    rig = load_rig(tmp_path / "law.toml")
    known = rig.estimates
    assert known == found.law_estimates()
    assert Laws(members=tuple(rig.law_by_contact().items())) == found.law
    at = [e.path for e in found.estimates]
    names = ("shoulder.kinetic_coefficient", "elbow.kinetic_coefficient")
    j = at.index(f"friction.{names[1]}")
    drawn = known.draw(found.law, 4000, seed=1)
    seen = np.corrcoef([drawn[f"friction.{name}"] for name in names])[0, 1]
    # laws of joints are drawn by themselves; standard error of 4000 draws: below 0.016
    assert abs(seen) < 0.06
    assert known.intervals[names[1]] == (found.estimates[j].low, found.estimates[j].high)
    for contact, coordinate in zip(JOINTS, ARM.coordinates, strict=True):
        joint = measured.joints[coordinate]
        fastest = np.abs(np.gradient(joint.position, joint.time)).max()
        # a speed that few readings are above
        assert 0.8 * fastest < known.largest_speed[contact] < 1.01 * fastest
    text = export(rig, "csv", contact="elbow").files["coulomb_viscous.csv"]
    assert f"Fitted at speeds up to {known.largest_speed['elbow']:.6g} rad/s" in text


def test_torques_of_another_record_are_predicted_to_their_noise(found):
    seen = found.predict(record(7))
    assert list(seen) == list(JOINTS)
    for (
        one
    ) in seen.values():  # noise of 0.01 N m, of which the filter leaves a tenth, and reversals
        assert one.error < 0.01
        assert one.inside > 0.9
        assert one.unit == "N m"


def test_the_record_that_was_fitted_is_no_other_record(found, measured):
    with pytest.raises(InputError, match="identical to the fitted one"):
        found.predict(measured)


@pytest.mark.slow
def test_several_records_are_one_data_set(found):
    both = Measurement(trials=(record(0, name="a"), record(5, name="b")))
    own = fit(GUESSED, BOTH, both, vary=["friction.*", *LINEAR], settings=QUICK)
    for name in LINEAR:
        assert own.estimate(name).half_width < found.estimate(name).half_width


@pytest.mark.slow
def test_a_law_that_is_not_linear_in_its_parameters_is_found():
    """Stribeck friction of the shoulder, whose step and velocity no regression gives."""
    stribeck = Stribeck(
        kinetic_coefficient=0.15, static_coefficient=0.4, stribeck_velocity=0.8,
        viscous_coefficient=0.02,
    )  # fmt: skip
    several = [record(k, {**TRUTH, "shoulder": stribeck}, name=str(k)) for k in range(3)]
    laws = {"shoulder": Stribeck, "elbow": CoulombViscous}
    both = Measurement(trials=tuple(several))
    own = fit(GUESSED, laws, both, vary=["friction.*", *LINEAR], settings=QUICK)
    assert own.law["shoulder"].stribeck_velocity == pytest.approx(0.8, rel=0.2)
    assert own.law["shoulder"].static_coefficient == pytest.approx(0.4, rel=0.1)
    plain = fit(GUESSED, BOTH, both, vary=["friction.*", *LINEAR], settings=QUICK)
    left = [one.joints["shoulder"].closest.left for one in (own, plain)]
    assert left[0] < 0.5 * left[1]


@pytest.mark.slow
@pytest.mark.parametrize("given", [None, CoulombViscous])
def test_a_joint_without_friction_has_no_law(given):
    smooth = record(3, {**TRUTH, "elbow": None})
    own = fit(ARM, {"shoulder": CoulombViscous, "elbow": given}, smooth, settings=QUICK)
    assert list(own.joints) == ["shoulder"]
    assert not any("elbow" in e.path for e in own.estimates)
    said = [line for line in own.sentences if line.startswith("The joint elbow has no law. ")]
    assert len(said) == (given is not None)


@pytest.mark.slow
def test_a_law_with_a_level_in_each_direction_has_no_offset_beside_it(measured):
    laws = {"shoulder": DirectionDependent, "elbow": CoulombViscous}
    own = fit(ARM, laws, measured, settings=QUICK)
    paths = {e.path for e in own.estimates}
    assert "measurement.offset.force.shoulder" not in paths
    for side in ("forward", "backward"):
        level = getattr(own.law["shoulder"], f"{side}_kinetic_coefficient")
        assert level == pytest.approx(0.2, rel=0.1)


@pytest.mark.slow
def test_what_a_record_does_not_tell_is_said_and_has_no_interval(measured):
    """Without gravity and with a stiff upper joint, nothing depends on the upper centre."""
    floating = replace(ARM, gravity=0.0)
    t, q, v, a = motion(0)
    forces, _ = JointTorques.of(floating, []).along(floating, t, q, v, a)
    own = fit(
        floating,
        BOTH,
        Measurement(
            time=t,
            position=dict(zip(JOINTS, q.T, strict=True)),
            force=dict(zip(JOINTS, (forces + 0.1 * np.sign(v)).T, strict=True)),
        ),
        vary=["friction.*", "upper_centre"],
        settings=QUICK,
    )
    centre = own.estimate("upper_centre")
    assert not centre.bounded
    assert centre.reason
    assert any("upper centre (c_1) is not identified" in line for line in own.sentences)


@pytest.mark.slow
def test_fixed_values_and_single_parameters_are_named_by_path(measured):
    fixed = {"measurement.offset.force.elbow": 0.0, "friction.shoulder.viscous_coefficient": 0.02}
    own = fit(ARM, BOTH, measured, vary=["friction.*", "upper_centre"], fixed=fixed, settings=QUICK)
    assert not {e.path for e in own.estimates} & set(fixed)
    assert own.law["shoulder"].viscous_coefficient == 0.02
    fitted = fit(ARM, TRUTH, measured, vary="friction.elbow.*", settings=QUICK)
    assert [e.path for e in fitted.estimates if e.path.startswith("friction.")] == [
        "friction.elbow.kinetic_coefficient",
        "friction.elbow.viscous_coefficient",
    ]
    assert fitted.law["shoulder"] == TRUTH["shoulder"]


@pytest.mark.slow
def test_a_parameter_with_a_stated_uncertainty_does_not_spoil_the_laws(measured):
    """A given inertia is wrong by a standard error, which the record tells."""
    wrong = replace(ARM, lower_inertia=ARM.lower_inertia - 0.005)
    stated = replace(measured, parameter_uncertainties={"mechanism.lower_inertia": 0.005})
    doubtful, sure = (fit(wrong, BOTH, one, settings=QUICK) for one in (stated, measured))
    assert not any("mechanism" in e.path for e in doubtful.estimates)
    for name in JOINTS:
        level = doubtful.estimate(f"friction.{name}.kinetic_coefficient")
        assert level.value == pytest.approx(TRUTH[name].kinetic_coefficient, rel=0.02)
        left = [one.joints[name].closest.left for one in (doubtful, sure)]
        assert left[0] < 0.2 * left[1]


def without(what, joint):
    def change(t, q, u):
        table = {"position": dict(q), "force": dict(u)}
        del table[what][joint]
        return Measurement(time=t, **table)

    return change


BAD = {
    "no joint that moves": (
        lambda t, q, u: Measurement(time=t, position=dict.fromkeys(q, 0.0 * t), force=u),
        "Position is constant",
    ),
    "no force of one joint": (without("force", "elbow"), "no force of the joint 'elbow'"),
    "no position of one joint": (without("position", "shoulder"), "no position of the joint 'sh"),
    "other names": (
        lambda t, q, u: Measurement(
            time=t, position={"hip": q["elbow"]}, force={"hip": u["elbow"]}
        ),
        "a joint 'hip', and the mechanism has the coordinates shoulder and elbow",
    ),
    "too short": (
        lambda t, q, u: Measurement(
            time=t[:20], position={k: x[:20] for k, x in q.items()},
            force={k: x[:20] for k, x in u.items()},
        ),
        "at least 60 samples",
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", BAD)
def test_a_record_that_does_not_serve_gives_one_sentence(case, measured):
    change, message = BAD[case]
    with pytest.raises(InputError, match=message):
        fit(ARM, BOTH, change(*parts(measured)), settings=QUICK)


def test_samples_that_are_not_numbers_are_refused_with_the_joint(measured):
    t, q, u = parts(measured)
    hole = q["elbow"].copy()
    hole[5] = np.nan
    with pytest.raises(ParameterError, match=r"joint 'elbow': .*finite, got nan at index 5"):
        Measurement(time=t, position={**q, "elbow": hole}, force=u)
    with pytest.raises(InputError, match="force is not: give position, velocity and force by"):
        Measurement(time=t, position=q, force=u["elbow"])


@pytest.mark.parametrize(
    ("laws", "vary", "message"),
    [
        ({"shoulder": Coulomb}, None, "no law is given for the contact 'elbow'"),
        ({**BOTH, "wrist": Coulomb}, None, "unknown contact 'wrist'"),
        ({**BOTH, "elbow": 3}, None, "takes a FrictionLaw, its type or its name, got int"),
        (TRUTH["elbow"], None, "would be shared by all joints"),
        (BOTH, "kinetic_coefficient", "friction.elbow.kinetic_coefficient' or 'friction.should"),
        (BOTH, ["friction.*", "upper_mass", "upper_centre"], "upper_mass and mechanism.upper_cen"),
    ],
)
def test_a_wrong_request_is_refused_in_words(laws, vary, message, measured):
    with pytest.raises(InputError, match=message):
        fit(ARM, laws, measured, vary=vary, settings=QUICK)


def test_routes_and_laws_of_one_contact_keep_apart_from_those_of_joints(measured, found):
    with pytest.raises(InputError, match="coordinates x"):
        fit(Axis(inertia=1.0), CoulombViscous, measured)
    measurement = Measurement(time=measured.time, position=measured.joints["elbow"].position)
    with pytest.raises(InputError, match="got dict"):
        fit(Axis(inertia=1.0), BOTH, measurement)
    with pytest.raises(InputError, match="route 'joints' applies to records of several joints"):
        fit(Axis(inertia=1.0), Coulomb, measurement, route="joints")


def test_the_fitted_laws_are_written_and_read_by_contact(found, tmp_path):
    found.save(tmp_path / "arm.toml")
    rig = load_rig(tmp_path / "arm.toml")
    assert rig.law_by_contact() == dict(found.law.members)
    for name in ("upper_inertia", "lower_centre"):
        assert getattr(rig.mechanism, name) == getattr(found.mechanism, name)


def test_the_check_speaks_of_each_joint_and_once_of_what_they_share(measured):
    sentences = check(measured).sentences
    assert sum("samples at 500 Hz" in line for line in sentences) == 1
    assert any(line.startswith("elbow: The direction changes") for line in sentences)
