"""Joints: motors as unknowns, and positions that count from wherever an arm rested."""

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest
from tests.arm_cases import ARM, GUESSED, JOINTS, LINEAR, QUICK, TRUTH, motion, parts, record

from stickslip import Axis, Coulomb, CoulombViscous, Measurement, SerialArm, fit
from stickslip.data import catalogue
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError, ParameterError
from stickslip.identify.fits import RecordSettings
from stickslip.mechanisms import Link, read_urdf

LINKS = (
    Link(
        mass=0.5, length=0.2, centre=0.18, inertia=0.025, rotor_inertia=6e-5, gear_ratio=6.0
    ),
    Link(
        mass=0.6, length=0.3, centre=0.22, inertia=0.035, rotor_inertia=9e-5, gear_ratio=9.0
    ),
)  # fmt: skip
SERIAL = SerialArm(links=LINKS)
LAWS = dict(zip(("joint-1", "joint-2"), TRUTH.values(), strict=True))
BOTH = dict.fromkeys(LAWS, CoulombViscous)
ZEROS = replace(QUICK, position_zeros=True)


def with_links(first=(), second=()):
    """Return the arm with other guesses of some values."""
    return SerialArm(links=(replace(LINKS[0], **dict(first)), replace(LINKS[1], **dict(second))))


@pytest.fixture(scope="module")
def measured():
    """Positions and torques of a motion, with noise of 0.1 mrad and 0.01 N m."""
    t, q, v, a = motion(0)
    forces, _ = JointTorques.of(SERIAL, []).along(SERIAL, t, q, v, a)
    for i, law in enumerate(LAWS.values()):
        forces[:, i] += law.force(v[:, i], 1.0)
    rng = np.random.default_rng(1000)
    q, forces = q + rng.normal(0.0, 1e-4, q.shape), forces + rng.normal(0.0, 0.01, q.shape)
    names = SERIAL.coordinates
    return Measurement(
        time=t,
        position=dict(zip(names, q.T, strict=True)),
        force=dict(zip(names, forces.T, strict=True)),
    )


CASES = {
    "rotors": (
        with_links({"rotor_inertia": 1e-5}, {"rotor_inertia": 2e-5}),
        {"links.0.rotor_inertia": 6e-5, "links.1.rotor_inertia": 9e-5},
    ),
    "gears": (
        with_links({"gear_ratio": 4.0}, {"gear_ratio": 12.0}),
        {"links.0.gear_ratio": 6.0, "links.1.gear_ratio": 9.0},
    ),
    "geometry": (
        with_links({"length": 0.25}, {"centre": 0.15}),
        {"links.0.length": 0.2, "links.1.centre": 0.22},
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_motors_and_lengths_are_found_though_forces_are_not_linear_in_them(case, measured):
    guess, truth = CASES[case]
    paths = {f"mechanism.{name}": value for name, value in truth.items()}
    own = fit(guess, BOTH, measured, vary=["friction.*", *paths], settings=QUICK)
    for path, value in paths.items():
        seen = own.estimate(path)
        # intervals are nominally 95 %, here of one record; twice as wide misses 1 in 10,000
        assert abs(seen.value - value) < 2.0 * seen.half_width
        assert seen.half_width < 0.11 * value
    assert own.law["joint-2"].kinetic_coefficient == pytest.approx(0.1, rel=0.05)


@pytest.mark.parametrize("names", [("mass", "centre"), ("rotor_inertia", "gear_ratio")])
def test_parameters_that_do_the_same_to_all_forces_are_refused_by_name(names, measured):
    paths = [f"mechanism.links.0.{name}" for name in names]
    message = f"cannot distinguish {paths[0]} and {paths[1]}: fix one of them"
    with pytest.raises(InputError, match=message):
        fit(SERIAL, BOTH, measured, vary=["friction.*", *paths], settings=QUICK)


def test_a_parameter_that_no_force_depends_on_is_refused_by_name(measured):
    paths = ["mechanism.links.1.length", "mechanism.links.1.gear_ratio"]
    with pytest.raises(InputError, match=r"do not depend on mechanism\.links\.1\.length: fix it"):
        fit(SERIAL, BOTH, measured, vary=["friction.*", *paths], settings=QUICK)


def moved(one, shoulder, elbow):
    """Return a record whose positions count from elsewhere."""
    t, q, u = parts(one)
    return Measurement(
        time=t,
        position={"shoulder": q["shoulder"] - shoulder, "elbow": q["elbow"] - elbow},
        force=u,
        name=one.name,
    )


@pytest.fixture(scope="module")
def displaced():
    """Two records whose encoders were 0 at different places, up to 2 degrees off."""
    one, other = record(0, name="first"), record(1, name="second")
    return Measurement(trials=(moved(one, 0.03, -0.02), moved(other, -0.03, 0.02)))


ASKED = ["friction.*", *LINEAR]


@pytest.mark.slow
def test_unknown_zeros_of_positions_do_not_bias_what_is_fitted(displaced):
    laws = dict.fromkeys(JOINTS, CoulombViscous)
    own = fit(GUESSED, laws, displaced, vary=ASKED, settings=ZEROS)
    plain = fit(GUESSED, laws, displaced, vary=ASKED, settings=QUICK)
    truth = {f"mechanism.{name}": getattr(ARM, name) for name in LINEAR}
    truth |= {f"friction.{n}.kinetic_coefficient": TRUTH[n].kinetic_coefficient for n in JOINTS}
    found = {path: own.estimate(path) for path in truth}
    # twice the half-widths of 95 %, and 0.5 % of inertias, whose intervals are narrower than what
    # the zero leaves in second order and the filter of accelerations
    assert all(
        abs(e.value - truth[p]) < max(2.0 * e.half_width, 5e-3 * truth[p]) for p, e in found.items()
    )
    for name in JOINTS:  # 0.03 rad of an arm with 3 N m/rad are 0.09 N m
        assert own.joints[name].closest.left < 0.02
        assert plain.joints[name].closest.left < 0.02
    assert not any(e.path.startswith("measurement.offset") for e in own.estimates)


def test_position_zeros_are_for_joints_and_true_or_false():
    measurement = Measurement(time=np.linspace(0, 1, 50), position=np.linspace(0, 1, 50) ** 2)
    with pytest.raises(InputError, match="records of several joints"):
        fit(Axis(inertia=1.0), Coulomb, measurement, settings=RecordSettings(position_zeros=True))
    with pytest.raises(ParameterError, match="position_zeros must be True or False, got 1"):
        RecordSettings(position_zeros=1)


GUESS = replace(
    ARM, upper_mass=0.5, upper_centre=0.1, upper_inertia=0.02, lower_centre=0.2, lower_inertia=0.03
)


def predicted_from_others(name, records):
    others = Measurement(trials=tuple(one for key, one in records.items() if key != name))
    laws = dict.fromkeys(JOINTS, CoulombViscous)
    own = fit(GUESS, laws, others, vary=ASKED, settings=ZEROS)
    return own.predict(records[name])


@pytest.fixture(scope="module")
def arm_records():
    entry = catalogue.dataset("two_link_arm")
    try:
        return {name: entry.measurement(name) for name in entry.files}
    except InputError:
        pytest.skip("needs STICKSLIP_DATA")


@pytest.mark.slow
def test_every_record_of_the_measured_arm_is_predicted_from_the_others(arm_records):
    """One record differs from the others, and one joint of another: the band is beside them."""
    seen = [predicted_from_others(name, arm_records)[n] for name in arm_records for n in JOINTS]
    ratios = np.array([x.error / x.usual_error for x in seen])
    inside = np.array([x.inside for x in seen])
    usual = np.array([x.chance > 0.1 for x in seen])
    assert np.median(ratios) < 1.1
    assert np.all(ratios[usual] < 1.4)
    assert np.all(inside[usual] > 0.85)
    assert np.count_nonzero(~usual) <= 2


@pytest.mark.slow
def test_friction_of_a_robot_file_that_is_held_stands_beside_what_is_fitted():
    t, q, v, a = motion(1)
    robot = read_urdf(
        files("stickslip.mechanisms") / "desk_arm.urdf", joints=["shoulder", "elbow"]
    ).robot
    forces, _ = JointTorques.of(robot, []).along(robot, t, q, v, a)
    forces += np.sign(v) * [0.4, 0.15] + v * [0.03, 0.0]
    measured = Measurement(
        time=t,
        position=dict(zip(JOINTS, q.T, strict=True)),
        force=dict(zip(JOINTS, forces.T, strict=True)),
    )
    laws = {"shoulder": CoulombViscous, "elbow": Coulomb(kinetic_coefficient=0.15)}
    found = fit(robot, laws, measured, vary="mechanism.joints.1.mass", settings=QUICK)
    assert found.estimate("friction.shoulder.viscous_coefficient").value == pytest.approx(
        0.03, rel=0.02
    )
    paths = {one.path for one in found.estimates}
    assert "friction.shoulder.kinetic_coefficient" in paths  # not named
