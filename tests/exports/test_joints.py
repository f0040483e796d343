"""MJCF and URDF: level and damping, what they leave, and what they change."""

import re
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from tests.exports.laws import LAWS_EXPORTED
from tests.support import example_of

from stickslip import (
    Axis,
    CoulombViscous,
    Dahl,
    DirectionDependent,
    LuGre,
    Pendulum,
    Rig,
    Robot,
    SpringBlock,
    Stribeck,
    export,
    load_rig,
    simulate,
)
from stickslip.data import KnownLaws, LawEstimates, levels_at
from stickslip.errors import InputError
from stickslip.exports.joints import JointFriction, simplified
from stickslip.exports.program import Subject
from stickslip.mechanisms import RobotJoint, read_urdf
from stickslip.mechanisms.drives import Sine
from stickslip.show.formatting import quantity

LAW = CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=3.0)
STRIBECK = Stribeck(
    kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01, viscous_coefficient=3.0
)


def taken(law, load=10.0, largest_speed=0.5, rig=None):
    return simplified(Subject(law=law, name="law", load=load, largest_speed=largest_speed, rig=rig))


def test_coulomb_and_viscous_friction_leaves_nothing():
    found = taken(LAW)
    np.testing.assert_allclose([found.joint.level, found.joint.damping], [2.0, 3.0], rtol=1e-12)
    assert found.largest < 1e-12
    assert found.lost == ("Dependence on the normal force: the joint has the friction at 10 N.",)


def test_level_and_damping_are_those_of_least_squares_with_neither_below_zero():
    found = taken(STRIBECK)
    v = np.linspace(5e-7, 0.5, 2001)
    force = np.array([STRIBECK.sliding(speed, 10.0) for speed in v])
    table = np.column_stack([np.ones_like(v), v])
    (level, damping), *_ = np.linalg.lstsq(table, force, rcond=None)
    np.testing.assert_allclose(
        [found.joint.level, found.joint.damping], [level, damping], rtol=1e-9
    )
    left = force - table @ [level, damping]
    assert found.largest == pytest.approx(np.abs(left).max(), rel=1e-9)
    assert found.rms == pytest.approx(np.sqrt(np.mean(left**2)), rel=1e-9)
    falling = Stribeck(kinetic_coefficient=0.1, static_coefficient=0.5, stribeck_velocity=0.5)
    assert taken(falling).joint.damping == 0.0


def test_each_thing_that_a_joint_cannot_have_is_said_with_its_size():
    both = DirectionDependent(forward_kinetic_coefficient=0.2, backward_kinetic_coefficient=0.3)
    said = {
        "Static friction: rest holds 3 N": STRIBECK,
        "falls with speed (Stribeck): by": STRIBECK,
        "in the two directions: by up to 1 N": both,
        "Bristles:": example_of(LuGre),
        "the friction at 10 N": STRIBECK,
    }
    for words, law in said.items():
        assert any(words in line for line in taken(law).lost), words
    assert not any("Static" in line or "Stribeck" in line for line in taken(LAW).lost)


def test_the_effect_on_a_rig_is_the_difference_of_two_exact_runs():
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    rig = Rig(mechanism=block, t_end=2.0, path="block.toml")
    found = export(STRIBECK, "mjcf", rig=rig)
    (joint,) = re.findall(r'frictionloss="([^"]+)" damping="([^"]+)"', found.files["stribeck.xml"])
    level, damping = map(float, joint)
    plain = JointFriction(level=level, damping=damping)
    ends = [simulate(block, law, t_end=2.0)["x"][-1] for law in (STRIBECK, plain)]
    (said,) = (line for line in found.remarks if line.startswith("On block.toml"))
    assert f"x ends at {ends[0]:.3f} m" in said
    assert f"{ends[1]:.3f} m with the joint's friction" in said
    written = " ".join(found.files["stribeck.xml"].split())
    assert all(" ".join(line.split()) in written for line in found.remarks)


def test_the_rig_of_the_law_s_own_file_is_taken_if_it_moves(tmp_path):
    file = tmp_path / "law.toml"
    text = (
        '[mechanism]\ntype = "axis"\ninertia = 3.0\n{drive}[friction.stribeck]\n'
        "kinetic_coefficient = 5.0\nstatic_coefficient = 7.0\nstribeck_velocity = 0.02\n"
        "[run]\nt_end = 1.0\n"
    )
    drive = '[[mechanism.drive]]\ntype = "pulse"\nlevel = 20.0\nduration = 0.3\n'
    file.write_text(text.format(drive=drive))
    found = export(load_rig(file), "mjcf")
    assert any(line.startswith("On law.toml, simulated exactly to 1 s") for line in found.remarks)
    other = export(load_rig(file), "urdf", largest_speed=1.0)
    assert any(line.startswith("On law.toml") for line in other.remarks)
    file.write_text(text.format(drive=""))
    with pytest.raises(InputError, match="range of speeds"):
        export(load_rig(file), "mjcf")
    still = export(load_rig(file), "mjcf", largest_speed=1.0)
    assert not any(line.startswith("On ") for line in still.remarks)


def test_a_law_that_is_a_joint_already_changes_nothing_on_a_rig():
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    found = export(LAW, "urdf", rig=Rig(mechanism=block, t_end=2.0))
    (said,) = (line for line in found.remarks if line.startswith("Their largest distance"))
    assert re.match(r"Their largest distance is (0|[0-9.]+ × 10⁻¹[⁴-⁹]) m, at", said), said


@pytest.mark.parametrize("name", LAWS_EXPORTED)
@pytest.mark.parametrize("target", ["mjcf", "urdf"])
def test_files_are_well_formed_for_all_laws(name, target):
    found = export(LAWS_EXPORTED[name], target, name=name, load=5.0, largest_speed=1.0)
    (text,) = found.files.values()
    (joint,) = (one for one in ElementTree.fromstring(text).iter("joint") if len(one.attrib) > 1)
    assert joint.attrib["name"] == name


def test_our_own_reader_takes_the_robot_back(tmp_path):
    rig = Rig(mechanism=Axis(inertia=3.0, load=20.0), t_end=1.0)
    found = export(LAW, "urdf", name="slide", rig=rig, largest_speed=1.0)
    (path,) = found.save(tmp_path)
    robot = read_urdf(path)
    assert robot.levels == {"slide": pytest.approx(4.0)}


def test_the_body_has_the_whole_inertia_of_what_slips_and_no_armature():
    for mechanism, kind, inertia in (
        (Pendulum(mass=1.0, length=0.5, inertia=0.1), "hinge", 0.35),
        (Axis(inertia=3.0), "slide", 3.0),
        (Axis(inertia="0.02 kg m^2"), "hinge", 0.02),
    ):
        rig = Rig(mechanism=mechanism, t_end=0.1)
        text = export(LAW, "mjcf", rig=rig, largest_speed=1.0).files["coulomb_viscous.xml"]
        assert f'type="{kind}"' in text
        assert 'armature="' not in text
        assert float(re.findall(r' mass="([^"]+)"', text)[0]) == pytest.approx(inertia)


def test_the_joints_of_an_arm_with_a_slide_leave_each_as_its_own():
    inertias = {"inertia_xx": 0.1, "inertia_yy": 0.1, "inertia_zz": 0.1}
    hinge = RobotJoint(joint="turn", mass=1.0, centre_x=0.2, **inertias)
    slide = RobotJoint(joint="push", parent="turn", kind="prismatic", mass=0.5, **inertias)
    robot = Robot(joints=(hinge, slide))
    laws = {
        "turn": CoulombViscous(kinetic_coefficient=1.0, viscous_coefficient=0.3),
        "push": CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=4.0),
    }
    contacts = {n: KnownLaws(laws={law.name: law}, named=(law.name,)) for n, law in laws.items()}
    known = LawEstimates(
        law=dict.fromkeys(laws, "coulomb-viscous"),
        levels=levels_at(robot),
        largest_speed={"turn": 2.0, "push": 0.25},
    )
    rig = Rig(mechanism=robot, contacts=contacts, estimates=known)
    for contact, kind, unit, speed in (
        ("turn", "hinge", "[N m s/rad]", "2 rad/s"),
        ("push", "slide", "[N s/m]", "0.25 m/s"),
    ):
        found = export(rig, "mjcf", contact=contact)
        (text,) = found.files.values()
        assert f'type="{kind}"' in text
        assert unit in text
        assert f"up to {speed}" in found.remarks[0]


def test_a_load_or_a_range_of_speeds_that_is_not_known_is_asked_for():
    with pytest.raises(InputError, match=r"--load .50 N. \(in Python load=50.0\)"):
        export(LAW, "mjcf", largest_speed=1.0)
    with pytest.raises(InputError, match=r"--largest-speed .0\.5 m/s"):
        export(LAW, "mjcf", load=5.0)
    with pytest.raises(InputError, match=r"--largest-speed .0\.5 rad/s"):
        export(LAW, "mjcf", rotary=True)


def test_a_joint_whose_inertia_is_not_known_says_so_beside_its_creep():
    found = export(LAW, "mjcf", load=5.0, largest_speed=1.0)
    assert found.remarks[-1] == "The inertia is not known: 1.0 kg stands for it."


BRISTLES = LuGre.from_forces(
    load=1.0, kinetic_force=1.0, static_force=1.5, stribeck_velocity=0.1, bristle_stiffness=2e3,
    bristle_damping=4.0, viscous_coefficient=0.3,
)  # fmt: skip


@pytest.mark.parametrize("rotary", [False, True])
@pytest.mark.parametrize(
    "law", [BRISTLES, Dahl(kinetic_coefficient=1.0, bristle_stiffness=2e3)], ids=["lugre", "dahl"]
)
def test_the_bristles_of_mujoco_are_those_of_the_law(law, rotary):
    mujoco = pytest.importorskip("mujoco", minversion="3.7", reason="needs MuJoCo 3.7: dcmotor")
    axis = Axis(inertia=0.02, rotary=rotary, drive=Sine(amplitude=2.5, frequency=1.0))
    rig = Rig(mechanism=axis, laws={law.name: law}, named=(law.name,), t_end=1.0)
    (text,) = export(rig, "mjcf", name="joint").files.values()
    true = simulate(axis, law, t_end=1.0)
    apart = []
    for share in (1.0, 0.5):
        model = mujoco.MjModel.from_xml_string(text)
        model.opt.timestep *= share
        data, left = mujoco.MjData(model), 0.0
        while data.time < 1.0 - 1e-9:
            data.ctrl[0] = 2.5 * np.sin(2.0 * np.pi * data.time)
            mujoco.mj_step(model, data)
            left = max(left, abs(data.qpos[0] - true.at(min(data.time, 1.0))["x"]))
        apart.append(left / np.ptp(true["x"]))
    assert apart[0] < 0.01
    # Euler's method is of order 1: half the step has half the error
    assert apart[1] == pytest.approx(0.5 * apart[0], rel=0.3)


def test_bristles_that_mujoco_does_not_have_become_a_level_and_a_damping():
    for law in (
        replace(BRISTLES, fading_exponent=1.0),
        replace(BRISTLES, viscous_exponent=0.5),
        replace(BRISTLES, static_switch=True),
        Dahl(kinetic_coefficient=1.0, bristle_stiffness=2e3, yield_exponent=2.0),
    ):
        found = export(law, "mjcf", load=1.0, largest_speed=1.0)
        (text,) = found.files.values()
        assert "frictionloss=" in text
        assert "<dcmotor" not in text
        assert any(remark.startswith("Bristles:") for remark in found.remarks)


@pytest.mark.parametrize("rotary", [False, True])
@pytest.mark.parametrize(("inertia", "load"), [(2.0, 10.0), (1e-3, 0.05)])
def test_a_loaded_joint_of_mujoco_creeps_as_little_as_the_file_says(rotary, inertia, load):
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")
    rig = Rig(mechanism=Axis(inertia=inertia, load=load, rotary=rotary), t_end=0.1)
    found = export(LAW, "mjcf", rig=rig, largest_speed=1.0)
    model = mujoco.MjModel.from_xml_string(found.files["coulomb_viscous.xml"])
    data = mujoco.MjData(model)
    data.ctrl[0] = 0.6 * 0.2 * load
    while data.time < 2.0:
        mujoco.mj_step(model, data)
    creep = data.qpos[0] / 2.0
    expected = 1.0009e-6 * 0.6 * 0.2 * load / inertia
    assert creep == pytest.approx(expected, rel=0.02)
    unit = "rad/s" if rotary else "m/s"
    (said,) = (line for line in found.remarks if line.startswith("Creep:"))
    assert f"creeps by {quantity(expected, unit)}," in said


def test_mujoco_slides_as_the_law_does_and_holds_where_it_rests():
    mujoco = pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")
    load, mass, start = 10.0, 2.0, 1.0
    rig = Rig(mechanism=Axis(inertia=mass, load=load), t_end=0.1)
    found = export(LAW, "mjcf", rig=rig, largest_speed=1.0)
    model = mujoco.MjModel.from_xml_string(found.files["coulomb_viscous.xml"])
    data = mujoco.MjData(model)
    data.qvel[0] = start
    end = 0.5
    while data.time < end - 1e-9:
        mujoco.mj_step(model, data)
    true = simulate(Axis(inertia=mass, load=load), LAW, t_end=end, y0={"x": 0.0, "v": start})
    # steps of a millisecond of first order, and a constraint that is soft
    assert data.qvel[0] == pytest.approx(true["v"][-1], rel=0.02)
    assert data.qpos[0] == pytest.approx(true["x"][-1], rel=0.02)

    data = mujoco.MjData(model)
    data.ctrl[0] = 0.9 * 2.0
    while data.time < 1.0:
        mujoco.mj_step(model, data)
    held = data.qpos[0]
    while data.time < 2.0:
        mujoco.mj_step(model, data)
    creep = data.qpos[0] - held
    assert 0.0 < creep < 2e-6
    data.ctrl[0] = 2.5 * 2.0
    while data.time < 3.0:
        mujoco.mj_step(model, data)
    assert data.qpos[0] > 0.1
