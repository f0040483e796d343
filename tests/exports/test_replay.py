"""A measured record beside the law, its simplification and MuJoCo: errors that are known."""

import json
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, BamM5, CoulombViscous, Measurement, Pendulum, Rig, Stribeck, simulate
from stickslip.cli import main
from stickslip.data import KnownLaws
from stickslip.engine.formulation import JointTorques
from stickslip.errors import InputError
from stickslip.exports import apply
from stickslip.exports.joints import simplified
from stickslip.exports.program import Subject
from stickslip.mechanisms import DCMotor, PositionLoop, read_urdf
from stickslip.mechanisms.drives import Sampled

LINK = """<link name="{}"><inertial><origin xyz="0.15 0 0"/><mass value="{}"/>
  <inertia ixx="1e-3" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
JOINT = """<joint name="{}" type="continuous"><parent link="{}"/><child link="{}"/>
  <origin xyz="{} 0 0"/><axis xyz="0 1 0"/></joint>"""
LAWS = {
    "shoulder": Stribeck(
        kinetic_coefficient=0.4,
        static_coefficient=0.6,
        stribeck_velocity=0.5,
        viscous_coefficient=0.1,
    ),
    "elbow": CoulombViscous(kinetic_coefficient=0.15, viscous_coefficient=0.05),
}
"""Friction of an arm: that of the elbow is what a file has."""


def description(lower=0.6):
    """Return an arm of two links, which turn in a vertical plane, as URDF."""
    parts = [
        '<link name="base"/>',
        LINK.format("upper", 1.2, 0.012, 0.012),
        LINK.format("lower", lower, 0.006, 0.006),
        JOINT.format("shoulder", "base", "upper", 0.0),
        JOINT.format("elbow", "upper", "lower", 0.3),
    ]
    return '<robot name="arm">' + "\n".join(parts) + "</robot>"


def motion(t):
    """Return places, rates and accelerations of both joints (n, 2)."""
    w, size = np.array([2.1, 3.3]), np.array([1.0, 0.7])
    angle = t[:, None] * w + [0.0, 1.0]
    return size * np.sin(angle), size * w * np.cos(angle), -size * w**2 * np.sin(angle)


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    """Return the path of a description, and the record of the arm that it describes."""
    path = tmp_path_factory.mktemp("arm") / "arm.urdf"
    path.write_text(description())
    robot = read_urdf(path).robot
    t = np.arange(0.0, 12.0, 0.004)
    q, v, a = motion(t)
    torques, _ = JointTorques.of(robot, []).along(robot, t, q, v, a)
    for i, law in enumerate(LAWS.values()):
        torques[:, i] += law.steady(v[:, i], 1.0)
    record = Measurement(
        time=t,
        position=dict(zip(LAWS, q.T, strict=True)),
        force=dict(zip(LAWS, torques.T, strict=True)),
    )
    return path, record


def rig_of(path):
    known = {name: KnownLaws(laws={law.name: law}, named=(law.name,)) for name, law in LAWS.items()}
    return Rig(mechanism=read_urdf(path).robot, contacts=known)


def replays_of(arm, file=None, **settings):
    path, record = arm
    found = apply(rig_of(path), file or path, largest_speed="2.4 rad/s", record=record, **settings)
    return {joint.joint: joint.replay for joint in found.joints}


def mujoco_or_skip():
    return pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")


@pytest.mark.slow
def test_the_cost_on_a_record_is_the_difference_of_the_friction_along_its_motion(arm):
    found = replays_of(arm, run=False)
    subject = Subject(law=LAWS["shoulder"], name="", rotary=True, load=1.0, largest_speed=2.4)
    near = simplified(subject).joint
    _, v, _ = motion(arm[1].time)
    slips = np.abs(v[:, 0]) > 0.1
    apart = (LAWS["shoulder"].steady(v[:, 0], 1.0) - near.steady(v[:, 0], 1.0))[slips]
    law, simple = found["shoulder"].models
    # rows that slip are chosen by the filter, and not by this speed
    assert simple.cost == pytest.approx(np.sqrt(np.mean(apart**2)), rel=0.05)
    # sampled torques have their jumps at reversals spread over a step
    assert law.force < 0.2 * simple.cost
    assert simple.force == pytest.approx(simple.cost, rel=0.05)
    # which moves the joint, while the law itself follows the record
    assert simple.drift > 5 * law.position
    # the elbow has the law itself, but sits on the shoulder
    assert found["elbow"].models[1].cost == 0.0
    assert found["elbow"].models[1].drift > 0.0


@pytest.mark.slow
def test_mujoco_errs_by_the_simplification_where_the_file_is_right(arm):
    mujoco_or_skip()
    found = replays_of(arm)
    for joint in found.values():
        law, simple, _, stiff = joint.models
        assert stiff.model == "MuJoCo (stiff)"
        # filters and reversals leave 1 % of the spread
        assert stiff.force == pytest.approx(simple.force, abs=0.01 * joint.spread)
        assert stiff.position == pytest.approx(simple.position, abs=5e-3)
        assert law.position < 0.3 * simple.position


@pytest.mark.slow
def test_mujoco_errs_by_what_the_links_of_its_file_are_wrong(arm, tmp_path):
    mujoco_or_skip()
    heavy = tmp_path / "heavy.urdf"
    heavy.write_text(description(lower=0.9))
    found = replays_of(arm, heavy)
    path, record = arm
    t = record.time
    q, v, a = motion(t)
    right, wrong = (read_urdf(one).robot for one in (path, heavy))
    torques = JointTorques.of(right, [])
    apart = torques.along(wrong, t, q, v, a)[0] - torques.along(right, t, q, v, a)[0]
    for i, joint in enumerate(found.values()):
        *_, stiff = joint.models
        expected = np.sqrt(np.mean(apart[:, i] ** 2))
        assert stiff.force == pytest.approx(expected, rel=0.1)  # rows at reversals are left out
        assert stiff.position > 5 * joint.models[0].position


def test_an_axis_is_compared_on_its_record(tmp_path):
    mujoco_or_skip()
    path = tmp_path / "cart.xml"
    path.write_text(
        '<mujoco><option gravity="0 0 0" timestep="0.001"/><worldbody><body>'
        '<joint name="rail" type="slide" axis="1 0 0"/>'
        '<geom size="0.1" mass="2"/></body></worldbody></mujoco>'
    )
    t = np.arange(0.0, 10.0, 0.005)
    v = 0.3 * np.cos(3.0 * t)
    law = CoulombViscous(kinetic_coefficient=5.0, viscous_coefficient=4.0)
    record = Measurement(
        time=t,
        position=0.1 * np.sin(3.0 * t),
        force=-2.0 * 0.9 * np.sin(3.0 * t) + law.steady(v, 1.0) + 0.7,
    )
    rig = Rig(mechanism=Axis(inertia=2.0), laws={law.name: law}, named=(law.name,))
    (joint,) = apply(rig, path, largest_speed=0.3, record=record).joints
    replay = joint.replay
    law_, simple, theirs = replay.models
    assert replay.constant == pytest.approx(0.7, abs=0.01)
    assert simple.cost == 0.0
    assert max(law_.force, theirs.force) < 0.02 * replay.spread
    assert max(law_.position, theirs.position) < 2e-3
    assert "level and damping change the force of the law by 0 N rms" in joint.sentences[2]


@pytest.mark.slow
def test_the_command_takes_the_rig_file_of_a_log(arm, tmp_path, capsys):
    path, record = arm
    table = {"time": record.time}
    for name, joint in record.joints.items():
        table |= {f"position.{name}": joint.position, f"force.{name}": joint.force}
    columns = np.column_stack(list(table.values()))
    np.savetxt(tmp_path / "run.csv", columns, delimiter=",", header=",".join(table), comments="")
    (tmp_path / "law.toml").write_text(
        f'[mechanism]\ntype = "urdf"\nfile = "{path}"\n'
        "[friction.shoulder.coulomb-viscous]\n"
        "kinetic_coefficient = 0.5\nviscous_coefficient = 0.1\n"
        "[friction.elbow.coulomb-viscous]\n"
        "kinetic_coefficient = 0.15\nviscous_coefficient = 0.05\n"
    )
    (tmp_path / "log.toml").write_text(
        f'[mechanism]\ntype = "urdf"\nfile = "{path}"\n[data]\nfile = "run.csv"\n'
    )
    documents = []
    for given in ("run.csv", "log.toml"):
        arguments = [
            "apply", tmp_path / "law.toml", path, "-o", tmp_path / "new.urdf", "--force",
            "--no-run", "--largest-speed", "2.4 rad/s", "--json", "--record", tmp_path / given,
        ]  # fmt: skip
        with pytest.raises(SystemExit) as leaving:
            main([*map(str, arguments)])
        assert not leaving.value.code
        documents.append(json.loads(capsys.readouterr().out)["joints"][0]["record"])
    assert documents[0] == documents[1]
    assert [document["model"] for document in documents[0]["models"]] == [
        "law",
        "level and damping",
    ]


def test_a_record_without_the_mechanism_of_the_law_is_refused(arm):
    path, record = arm
    with pytest.raises(InputError, match="needs the mechanism of the law"):
        apply(LAWS["elbow"], path, joints="elbow", largest_speed=1.0, record=record)


def test_a_record_of_other_joints_is_refused(arm):
    path, record = arm
    less = replace(record, joints={"elbow": record.joints["elbow"]})
    with pytest.raises(InputError, match="no position of the joint 'shoulder'"):
        apply(rig_of(path), path, largest_speed=1.0, record=less, run=False)


MOTOR = DCMotor(resistance=4.0, torque_constant=0.4, rotor_inertia=2e-3)
SERVO = Pendulum(mass=0.5, length=0.1, gravity=9.81, drive=MOTOR)
GEAR = CoulombViscous(kinetic_coefficient=0.03, viscous_coefficient=0.01)


def test_a_gear_is_written_at_the_usual_torque_of_its_record(tmp_path):
    gear = BamM5(
        kinetic_coefficient=0.01,
        static_coefficient=0.01,
        stribeck_velocity=0.1,
        motor_friction=0.1,
        external_friction=0.1,
        motor_static_friction=0.0,
        external_static_friction=0.0,
        viscous_coefficient=0.01,
    )
    arm = Pendulum(mass=0.5, length=0.1, gravity=9.81)
    t = np.arange(0.0, 8.0, 0.01)
    theta, omega = 1.2 + 0.2 * np.sin(2.0 * t), 0.4 * np.cos(2.0 * t)
    weight = -0.5 * 9.81 * 0.1 * np.sin(theta)
    motor = -weight + 0.01 * np.sign(omega)
    record = Measurement(time=t, position=theta, force=motor, turning=True)
    rig = Rig(mechanism=arm, laws={gear.name: gear}, named=(gear.name,))
    given = {"largest_speed": 1.0, "run": False, "record": record}
    (joint,) = apply(rig, servo_file(tmp_path, 0.5), **given).joints
    # a motor that holds a weight loads its gear with both
    usual = 0.01 + 0.1 * np.median(np.abs(motor - weight))
    assert float(joint.after["frictionloss"]) == pytest.approx(usual, rel=0.05)
    stated = {"motor": 0.0, "external": 0.0}
    (joint,) = apply(rig, servo_file(tmp_path, 0.5), at=stated, **given).joints
    assert float(joint.after["frictionloss"]) == pytest.approx(0.01, rel=1e-3)


def servo_file(folder, mass):
    """Return the path of a servo with an arm in MuJoCo, whose file has no motor."""
    path = folder / f"servo{mass}.xml"
    path.write_text(
        '<mujoco><option timestep="0.001" gravity="0 0 -9.81"/><worldbody><body>'
        '<joint name="horn" type="hinge" axis="0 1 0"/>'
        f'<inertial pos="0 0 -0.1" mass="{mass}" diaginertia="1e-9 1e-9 1e-9"/>'
        "</body></worldbody></mujoco>"
    )
    return path


def servo_record(law):
    """Return the motion of the servo under a voltage of two sines, held for 5 ms."""
    t = np.arange(0.0, 8.0, 0.005)
    volts = 3.0 * np.sin(2.9 * t) + 2.0 * np.sin(7.7 * t)
    told = replace(MOTOR, drive=Sampled(times=t, values=volts, hold="zero"))
    run = simulate(replace(SERVO, drive=told), law, t_end=t[-1]).at(t)
    # its mean until the next sample, which is what a filtered sensor of the current has
    omega = run["omega"] + 0.5 * np.append(np.diff(run["omega"]), 0.0)
    current = (volts - 0.4 * omega) / 4.0
    return Measurement(time=t, position=run["theta"], voltage=volts, turning=True), current


@pytest.mark.slow
@pytest.mark.parametrize("what", ["voltage", "current", "reference"])
def test_the_motor_of_a_record_drives_the_file_in_mujoco(tmp_path, what):
    mujoco_or_skip()
    record, current = servo_record(GEAR)
    servo = SERVO
    if what == "current":
        record = replace(record, current=current)
    if what == "reference":
        t = record.time
        servo = replace(SERVO, drive=replace(MOTOR, loop=PositionLoop(gain=20.0)))
        goal = 0.8 * np.sin(2.9 * t) + 0.3 * np.sin(7.7 * t)
        told = replace(servo.drive, drive=Sampled(times=t, values=goal, hold="first"))
        run = simulate(replace(servo, drive=told), GEAR, t_end=t[-1]).at(t)
        record = Measurement(time=t, position=run["theta"], reference=goal, turning=True)
    rig = Rig(mechanism=servo, laws={GEAR.name: GEAR}, named=(GEAR.name,))
    (right,) = apply(rig, servo_file(tmp_path, 0.5), largest_speed=5.0, record=record).joints
    (heavy,) = apply(rig, servo_file(tmp_path, 0.75), largest_speed=5.0, record=record).joints
    law, simple, theirs = right.replay.models
    assert right.replay.driven_by == what
    assert right.replay.constant == 0.0
    assert f"under the recorded {what} of the motor" in right.sentences[3]
    # the law is the file's own, so that all three follow the record
    assert max(law.force, simple.force, theirs.force) < 0.03 * right.replay.spread
    travel = float(np.ptp(record.position))
    assert max(law.position, theirs.position) < 0.01 * travel
    # half as much again of the arm's mass in the file is seen, but by the law is not
    *_, wrong = heavy.replay.models
    assert wrong.position > 5.0 * theirs.position
    assert heavy.replay.models[0] == law


def test_a_motor_of_a_record_has_the_back_emf_of_the_speed_in_the_file(tmp_path):
    mujoco_or_skip()
    record, _ = servo_record(GEAR)
    # without friction in the law, the file runs faster: its own back-EMF brakes it more
    plain = CoulombViscous(kinetic_coefficient=0.0, viscous_coefficient=1e-9)
    rig = Rig(mechanism=SERVO, laws={plain.name: plain}, named=(plain.name,))
    (joint,) = apply(rig, servo_file(tmp_path, 0.5), largest_speed=5.0, record=record).joints
    law, _, theirs = joint.replay.models
    assert theirs.position == pytest.approx(law.position, rel=0.02)
    assert law.position > 0.02
