"""Links of robots that nobody knows: what a motion tells of them, and friction beside them."""

from dataclasses import replace
from importlib.resources import files

import numpy as np
import pytest

from stickslip import CoulombViscous, Measurement, TwoLinkArm, fit, load_rig
from stickslip.data import catalogue
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError
from stickslip.identify.problems.joints import JointRecords
from stickslip.identify.problems.links import JointBalances, told_links
from stickslip.mechanisms import Robot, RobotJoint, read_urdf

DESK = files("stickslip.mechanisms") / "desk_arm.urdf"
LEVELS, SLOPES = np.array([0.5, 0.8, 0.3]), np.array([0.05, 0.1, 0.04])
PUBLISHED = (8.05, 5.53, 1.97, 1.11)
"""Viscous coefficients of joints 1 to 4 of the TX40 [N m s/rad], as figaroh-examples states."""


def excited(robot, seed, *, noise=0.0, seconds=6.0):
    """Return a record of a robot along random Fourier series, with friction in every joint."""
    random, t = np.random.default_rng(seed), np.arange(0.0, seconds, 0.002)
    q, v, a = np.zeros((3, len(t), len(robot.joints)))
    for i in range(len(robot.joints)):
        for k in range(1, 6):
            w, (b, c) = 2.0 * np.pi * k / 5.0, random.normal(size=2) / k
            q[:, i] += b * np.sin(w * t) + c * np.cos(w * t)
            v[:, i] += w * (b * np.cos(w * t) - c * np.sin(w * t))
            a[:, i] -= w * w * (b * np.sin(w * t) + c * np.cos(w * t))
    forces, _ = JointTorques.of(robot, []).along(robot, t, q, v, a)
    count = len(robot.joints)
    forces = forces + np.sign(v) * LEVELS[:count] + v * SLOPES[:count]
    forces += noise * random.normal(size=forces.shape)
    return Measurement(
        time=t,
        position=dict(zip(robot.coordinates, q.T, strict=True)),
        force=dict(zip(robot.coordinates, forces.T, strict=True)),
    )


def of_other_links(robot, seed):
    """Return the robot as a description with wrong links has it."""
    random = np.random.default_rng(seed)
    joints = [
        replace(
            joint,
            mass=joint.mass * random.uniform(0.6, 1.5),
            centre_x=joint.centre_x + 0.03 * random.normal(),
            centre_z=joint.centre_z + 0.03 * random.normal(),
            inertia_yy=joint.inertia_yy * random.uniform(0.5, 2.0) + 1e-3,
            inertia_zz=joint.inertia_zz * random.uniform(0.5, 2.0) + 1e-3,
            damping=0.0,
        )
        for joint in robot.joints
    ]
    return replace(robot, joints=tuple(joints))


def undamped(robot):
    return replace(robot, joints=tuple(replace(joint, damping=0.0) for joint in robot.joints))


def planar():
    """Return two links that swing in a vertical plane."""
    place = {"orientation": (1, 0, 0, 0, 0, 1, 0, -1, 0)}
    return Robot(
        joints=(
            RobotJoint(joint="a", mass=1.3, centre_x=0.21, inertia_zz=0.033, **place),
            RobotJoint(
                joint="b", parent="a", place=(0.4, 0, 0), mass=0.7, centre_x=0.17, inertia_zz=0.021
            ),
        )
    )


@pytest.mark.parametrize("noise", [0.0, 0.1])
def test_two_links_in_a_plane_have_seven_base_parameters_however_certain(noise):
    """M. Gautier: moments of both, inertias of both and the armature of the second."""
    robot = planar()
    other = replace(robot, joints=(replace(robot.joints[0], mass=2.1), robot.joints[1]))
    record = excited(robot, 1, noise=noise) if noise else excited(robot, 1)
    _, told = told_links(other, record, held=False, zeros=False)
    assert len(told) == 7
    assert sum("moment" in path for path in told) == 4


def test_rows_of_a_joint_count_once_in_what_is_told_of_its_links():
    robot, record = planar(), excited(planar(), 1, noise=0.02)
    free, told = told_links(robot, record, held=False, zeros=False)
    balances = JointBalances.of(free, record, told, held=False, zeros=False)
    links = balances.links
    turns = told.index("mechanism.joints.1.added_armature")  # mostly in the balance of b
    errors = [np.linalg.norm(x.root[turns]) for x in (links.told, *links.beside.values())]
    assert links.beside.keys() == {"a", "b"}
    assert errors[0] < errors[1] < 1.5 * errors[0] < 0.5 * errors[2]
    for own in balances.records.at(links, held=False).values():
        assert all(x.link and x.doubt == 1.0 for x in own[0].unknown.values())


def test_what_a_gear_transmits_does_not_depend_on_what_is_looked_for():
    robot, record = planar(), excited(planar(), 1, noise=0.02)
    free, told = told_links(robot, record, held=False, zeros=False)
    both = [JointRecords.of(free, record, unknown=paths) for paths in ((), told)]
    known, looked_for = (x.records["b"][0].inputs["transmitted"] for x in both)
    np.testing.assert_allclose(looked_for, known, rtol=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [11, 12, 13])
def test_friction_is_found_beside_links_that_are_described_wrongly(seed):
    robot = undamped(read_urdf(DESK).robot)
    record = excited(robot, seed, noise=0.02)
    found = fit(of_other_links(robot, seed), CoulombViscous, record, vary=["friction.*", "links"])
    for i, contact in enumerate(("turret", "shoulder", "elbow")):
        level = found.estimate(f"friction.{contact}.kinetic_coefficient")
        slope = found.estimate(f"friction.{contact}.viscous_coefficient")
        # twice the interval: one of 18 lies outside a 95 % interval by chance
        assert abs(level.value - LEVELS[i]) < 2.0 * level.half_width < 0.1
        assert abs(slope.value - SLOPES[i]) < 2.0 * slope.half_width < 0.05
    shown = [estimate.path for estimate in found.shown]
    assert not any("added" in path for path in shown)
    assert len(found.estimates) > len(shown)
    assert "added" not in str(found)
    assert not any("h_" in line or "L_" in line for line in found.sentences)


def test_links_are_of_robots_only():
    arm = TwoLinkArm(
        upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
        lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03,
    )  # fmt: skip
    record = excited(planar(), 2)
    joints = dict(zip(arm.coordinates, record.joints.values(), strict=True))
    record = Measurement(
        time=record.time,
        position={name: joint.position for name, joint in joints.items()},
        force={name: joint.force for name, joint in joints.items()},
    )
    with pytest.raises(InputError, match=r"the mechanism is a TwoLinkArm: name its parameters"):
        fit(arm, CoulombViscous, record, vary=["friction.*", "links"])


@pytest.mark.slow
def test_a_rig_file_says_that_links_are_unknown_and_a_fit_is_saved_with_them(tmp_path):
    robot = undamped(read_urdf(DESK).robot)
    (tmp_path / "desk_arm.urdf").write_text(DESK.read_text())
    record = excited(robot, 3, noise=0.02)
    columns = [record.time]
    names = ["time [s]"]
    for name, joint in record.joints.items():
        columns += [joint.position, joint.force]
        names += [f"position.{name} [rad]", f"force.{name} [N m]"]
    table = "\n".join(",".join(f"{x:.8g}" for x in row) for row in zip(*columns, strict=True))
    (tmp_path / "log.csv").write_text(",".join(names) + "\n" + table + "\n")
    file = tmp_path / "rig.toml"
    file.write_text(
        '[mechanism]\ntype = "urdf"\nfile = "desk_arm.urdf"\nlinks = "unknown"\n'
        "[mechanism.joints.elbow]\ncoupling = { shoulder = 0.5 }\nmass = 0.9\n"
        '[data]\nfile = "log.csv"\n'
    )
    rig = load_rig(file)
    assert rig.vary == ("links",)
    assert rig.mechanism.joints[2].coupling == (("shoulder", 0.5),)
    found = fit(rig.mechanism, CoulombViscous, rig.measurement, vary=["friction.*", *rig.vary])
    found.save(tmp_path / "fitted.toml")
    again = load_rig(tmp_path / "fitted.toml")
    assert again.mechanism == found.mechanism


@pytest.fixture(scope="module")
def tx40():
    try:
        return catalogue.dataset("staubli_tx40").measurement()
    except InputError:
        pytest.skip("needs STICKSLIP_DATA")


@pytest.mark.slow
def test_a_measured_arm_of_unknown_links_has_the_published_friction(tx40):
    from benchmarks.friction.records import by_motors, tx40_robot

    robot, record = tx40_robot(), by_motors(tx40)
    found = fit(robot, CoulombViscous, record, vary=["friction.*", "links"])
    for i, published in enumerate(PUBLISHED, 1):
        slope = found.estimate(f"friction.q{i}.viscous_coefficient")
        # theirs is of the whole record, of which this is half: least squares of it with all links
        # is up to 6 % from them
        assert abs(slope.value - published) < slope.half_width + 0.05 * published
        assert slope.half_width < 0.2 * published
