"""Serial arms and robots: their equations by other ways, and descriptions that are refused."""

import dataclasses
import importlib.util
import math
import re
from importlib.resources import files

import numpy as np
import pytest
from benchmarks.robots import START, ur, ur_laws
from tests.contact_cases import Arm, coulomb
from tests.mechanisms.urdf_cases import by_jacobians, needed, random_urdf

from stickslip import Coulomb, EventDriven, TwoLinkArm, simulate
from stickslip.engine import Status
from stickslip.engine.formulation import formulate
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.mechanisms import Link, Robot, RobotJoint, SerialArm, read_urdf

DESK = files("stickslip.mechanisms") / "desk_arm.urdf"
PLAIN = EventDriven(tier="python")
STICK = Link(mass=1.0, length=0.4, centre=0.4, inertia=0.16)


def read(tmp_path, text, **more):
    """Return the description in a text."""
    file = tmp_path / "robot.urdf"
    file.write_text(text)
    return read_urdf(file, **more)


def equations_of(robot, q, v):
    """Return mass matrix and what the joints take, dampers left out."""
    at, moving = (dict(zip(robot.coordinates, values, strict=True)) for values in (q, v))
    forces = robot.forces(0.0, at, moving, {})
    taken = [-forces[j.coordinate] - j.damping * moving[j.coordinate] for j in robot.joints]
    return np.array(robot.mass_matrix(at)), np.array(taken)


@pytest.mark.parametrize("seed", range(8))
def test_equations_are_those_of_jacobians_and_christoffel_symbols(tmp_path, seed):
    """Trees of random bodies with joints that turn, slide or are fixed, about any axis."""
    text = random_urdf(seed)
    robot = read(tmp_path, text).robot
    names = re.findall(r'<joint name="(\w+)" type="(?!fixed)', text)
    order = [names.index(heading.joint) for heading in robot.joints]
    dice = np.random.default_rng(seed)
    q, v = dice.uniform(-2.0, 2.0, len(names)), dice.normal(size=len(names))
    mass, taken = equations_of(robot, q[order], v[order])
    expected = by_jacobians(text, q)[0].real[np.ix_(order, order)]
    # some hundred roundings of the largest entry
    np.testing.assert_allclose(mass, expected, atol=1e-13 * np.abs(expected).max(), rtol=0)
    h = needed(text, q, v)[order]
    np.testing.assert_allclose(taken, h, atol=1e-13 * np.abs(h).max(), rtol=0)


@pytest.mark.skipif(importlib.util.find_spec("pinocchio") is None, reason="pin is not installed")
@pytest.mark.parametrize("seed", range(8))
def test_equations_are_those_of_pinocchio(tmp_path, seed):
    import pinocchio

    robot = read(tmp_path, random_urdf(seed, kinds=("revolute", "prismatic", "fixed"))).robot
    model = pinocchio.buildModelFromUrdf(str(tmp_path / "robot.urdf"))
    data = model.createData()
    dice = np.random.default_rng(seed)
    q, v = dice.uniform(-2.0, 2.0, model.nq), dice.normal(size=model.nv)
    order = [model.joints[model.getJointId(joint.joint)].idx_q for joint in robot.joints]
    upper = np.triu(pinocchio.crba(model, data, q))
    expected = (upper + np.triu(upper, 1).T)[np.ix_(order, order)]
    mass, taken = equations_of(robot, q[order], v[order])
    np.testing.assert_allclose(mass, expected, atol=1e-12 * np.abs(expected).max(), rtol=0)
    h = pinocchio.nonLinearEffects(model, data, q, v)[order]
    np.testing.assert_allclose(taken, h, atol=1e-12 * np.abs(h).max(), rtol=0)


def test_two_links_move_as_the_arm_of_the_reference_numbers():
    known = Arm()
    links = (STICK, dataclasses.replace(STICK, mass=0.5, inertia=0.08))
    laws = [coulomb(0.3, 0.45), coulomb(0.12, 0.2)]
    runs = [
        simulate(
            one, dict(zip((c.name for c in one.contacts()), laws, strict=True)), t_end=2.0,
            y0=dict(zip(one.coordinates, (1.2, 0.8), strict=True)), solver=PLAIN,
        )
        for one in (SerialArm(links=links), known)
    ]  # fmt: skip
    ends = [[run[name][-1] for name in run.states] for run in runs]
    assert ends[0] == pytest.approx(ends[1], abs=1e-7)  # both within the tolerance of the solver


def test_a_serial_arm_of_two_links_is_the_two_link_arm():
    motor = {"rotor_inertia": 6e-5, "gear_ratio": 6.0}
    links = (
        Link(mass=0.6, length=0.2, centre=0.1, inertia=0.012, **motor),
        Link(mass=0.5, length=0.3, centre=0.2, inertia=0.03, **motor),
    )
    two = TwoLinkArm(
        upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
        lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03, **motor,
    )  # fmt: skip
    serial = SerialArm(links=links)
    q, v = (0.4, -0.9), (1.5, 0.7)
    found = []
    for arm in (serial, two):
        at, moving = (dict(zip(arm.coordinates, values, strict=True)) for values in (q, v))
        forces = arm.forces(0.0, at, moving, {})
        found.append((arm.mass_matrix(at), list(forces.values())))
    assert found[0] == found[1]


@pytest.mark.parametrize("gear", [1.0, 50.0])
def test_a_rotor_on_a_link_in_space_keeps_the_balance_of_energy(gear):
    """Its spin turns with the link, which takes gyroscopic torques; no other engine has them."""
    from stickslip.mechanisms.rigid_bodies import Body, mass_matrix_of, taken_by

    turn = ((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    solid = ((0.4, 0.02, 0.01), (0.02, 0.5, 0.03), (0.01, 0.03, 0.6))
    bodies = [
        Body(i - 1, turn, (0.1, 0.2, 0.3), 1.0, (0.1, -0.1, 0.2), solid, rotor=0.02, gear=gear)
        for i in range(3)
    ]
    dice = np.random.default_rng(4)
    q, v = dice.normal(size=(2, 3))
    step = 1e-5
    slopes = np.array(
        [
            (np.array(mass_matrix_of(bodies, q + step * e)) - mass_matrix_of(bodies, q - step * e))
            / (2.0 * step)
            for e in np.eye(3)
        ]
    )
    expected = np.einsum("kij,k,j->i", slopes, v, v) - 0.5 * np.einsum("ijk,j,k->i", slopes, v, v)
    found = taken_by(bodies, q, v, (0.0, 0.0, 0.0))
    # central differences leave the square of the step over that of a radian
    np.testing.assert_allclose(found, expected, atol=1e-8 * np.abs(expected).max())


def test_a_description_gives_masses_friction_and_limits():
    found = read_urdf(DESK)
    arm = found.robot
    assert arm.coordinates == ("turret", "shoulder", "elbow")
    assert [joint.mass for joint in arm.joints] == pytest.approx([1.2, 0.8, 0.65])
    assert found.levels == {"turret": 0.25, "shoulder": 0.4, "elbow": 0.15}
    assert found.limits == {"shoulder": (-1.9, 1.9), "elbow": (-2.4, 2.4)}
    assert found.locked == {"flange": 0.0}
    # the tool hangs 0.2 m out, its centre 0.03 m further: so does the joint's first moment say
    elbow = arm.joints[-1]
    assert elbow.mass * elbow.centre_x == pytest.approx(0.45 * 0.09 + 0.2 * 0.23)
    laws = {name: coulomb(level) for name, level in found.levels.items()}
    run = simulate(arm, laws, t_end=5.0, y0={"shoulder": 0.5, "turret_dot": 2.0})
    assert run.status is Status.AT_REST
    assert run.certificate.certified
    assert run.certificate.stick_drift == 0.0


def test_moments_that_no_body_has_are_told_and_taken(tmp_path):
    """Descriptions of makers have such; the equations have a solution all the same."""
    found = read(tmp_path, edited('izz="0.0052"', 'izz="0.52"'))
    assert len(found.remarks) == 1
    assert "link 'upper': no body has the principal moments of inertia" in found.remarks[0]
    assert not read_urdf(DESK).remarks


def test_locked_joints_stand_where_they_are_told(tmp_path):
    whole = read_urdf(DESK).robot
    part = read_urdf(DESK, locked={"turret": 0.3, "elbow": -0.7}).robot
    other = read_urdf(DESK, joints=["shoulder"], locked={"elbow": -0.7}).robot
    q = dict(zip(whole.coordinates, (0.3, 0.5, -0.7), strict=True))
    rest = dict.fromkeys(q, 0.0)
    expected = whole.mass_matrix(q)[1][1], whole.forces(0.0, q, rest, {})["shoulder"]
    for one in (part, other):
        assert one.coordinates == ("shoulder",)
        found = one.mass_matrix({"shoulder": 0.5})[0][0]
        weight = one.forces(0.0, {"shoulder": 0.5}, {"shoulder": 0.0}, {})["shoulder"]
        assert (found, weight) == pytest.approx(expected, rel=1e-14)


def test_a_payload_is_a_parameter():
    arm = read_urdf(DESK).robot
    paths = formulate(arm, coulomb(0.1)).parameter_paths
    assert "mechanism.joints.2.mass" in paths
    assert "mechanism.joints.2.inertia_yz" not in paths  # it is 0: it does not stand there


@pytest.mark.parametrize(
    ("name", "coordinate", "contact"),
    [
        ("shoulder.pitch joint", "shoulder_pitch_joint", "shoulder-pitch-joint"),
        ("Joint_2", "Joint_2", "joint-2"),
        ("2_axis", "2_axis", "joint-2-axis"),
        ("mode", "mode_joint", "mode"),
    ],
)
def test_any_name_of_a_joint_gives_names_of_columns(name, coordinate, contact):
    joint = RobotJoint(joint=name, mass=1.0)
    assert (joint.coordinate, joint.contact_name) == (coordinate, contact)


def edited(old, new):
    """Return the text of the desk arm with a change."""
    text = DESK.read_text()
    assert old in text
    return text.replace(old, new)


REFUSED = [
    ('type="continuous"', 'type="floating"', "joint 'turret' of type floating moves in six"),
    ('type="continuous"', 'type="planar"', "joint 'turret' of type planar moves in three"),
    ('type="continuous"', 'type="hinge"', "joint 'turret' has the unknown type 'hinge'"),
    ('<dynamics damping="0.05" friction="0.4"/>', '<mimic joint="turret"/>',
     "'shoulder' follows another one.*locked={'shoulder': 0.0}"),
    ('<child link="upper"/>', '<child link="uper"/>', "link of joint 'shoulder'.*'uper'.*upper"),
    ('<child link="tool"/>', '<child link="upper"/>', "on the joints 'shoulder' and 'flange'"),
    ('<parent link="column"/>', '<parent link="lower"/>', "upper, lower, tool hang on each other"),
    ('<parent link="column"/>', "", "joint 'shoulder' has no <parent"),
    ('<axis xyz="0 0 1"/>', '<axis xyz="0 0 0"/>', "'turret': axis must not be"),
    ('<axis xyz="0 0 1"/>', '<axis xyz="0 1"/>', "xyz must be 3 finite numbers, got '0 1'"),
    ('<mass value="0.8"/>', '<mass value="-0.8"/>', "link 'upper': mass must be at least 0 kg"),
    ('<mass value="0.8"/>', '<mass value="nan"/>', "value must be 1 finite number, got 'nan'"),
    ('ixy="0.0001"', 'ixy="0.05"', "link 'upper': the principal moments of inertia are"),
    ('damping="0.05"', 'damping="-1"', "joint 'shoulder': damping and friction"),
    ("</robot>", "", "is not XML"),
    ('<robot name="desk-arm">', '<!DOCTYPE a [<!ENTITY b "c">]><robot>', "declares entities"),
    ('name="elbow"', 'name="shoulder"', "two joints are called 'shoulder'"),
    ('<link name="tool">', '<link name="upper">', "two links are called 'upper'"),
    ('name="elbow"', 'name="shoulder_dot"', "a joint and a rate, are called 'shoulder_dot'"),
    ('name="elbow"', 'name=""', "a <joint> has no name"),
    ('value="0.8"', 'value="${m}"', "xacro"),
]  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message"), REFUSED)
def test_what_cannot_be_taken_is_refused_by_name(tmp_path, old, new, message):
    with pytest.raises(InputError, match=message) as caught:
        read(tmp_path, edited(old, new))
    assert "robot.urdf" in str(caught.value)


def test_a_joint_that_moves_nothing_is_refused_by_name(tmp_path):
    text = '<robot><link name="a"/><link name="b"/><joint name="j" type="revolute">'
    text += '<parent link="a"/><child link="b"/></joint></robot>'
    with pytest.raises(ParameterError, match="joint 'j' moves no mass"):
        read(tmp_path, text)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: read_urdf("nowhere.urdf"), "nowhere.urdf cannot be read"),
        (lambda: read_urdf(DESK, joints=["elbw"]), "elbw.*Did you mean 'elbow'"),
        (lambda: read_urdf(DESK, joints=["elbow"], locked={"elbow": 0.0}), "is locked and moves"),
        (lambda: read_urdf(DESK, joints=[]), "no joint moves"),
        (lambda: read_urdf(DESK, joints="elbow"), r"several names, such as \['elbow'\]"),
        (lambda: read_urdf(DESK, locked={"elbow": "one"}), r"locked.elbow \(q\) .*got 'one'"),
        (lambda: read_urdf(DESK, locked={"flange": 0.1}), "'flange' is fixed"),
        (lambda: read_urdf(3), "name of a URDF file, got 3"),
        (lambda: SerialArm(links=()), "at least 1 of Link"),
        (lambda: RobotJoint(joint="1", mass=1.0), "a name with letters"),
        (lambda: RobotJoint(joint="a", mass=1.0, orientation=(1.0,) * 9), "rotation matrix"),
        (lambda: RobotJoint(joint="a", mass=1.0, place=(1.0, math.inf, 0.0)), "3 numbers below"),
        (lambda: RobotJoint(joint="a", mass=1.0, kind="fixed"), "'revolute' or 'prismatic'"),
        (
            lambda: Robot(joints=[RobotJoint(joint="a", parent="b", mass=1.0, inertia_zz=1.0)]),
            "parent of Robot joint 'a'",
        ),
    ],
)
def test_bad_arguments_are_refused(make, message):
    with pytest.raises((InputError, UnknownNameError), match=message):
        make()


UR_EVENTS = [
    ("q4", 0.18560758999), ("q4", 0.25463098791), ("q3", 0.30489569365), ("q1", 0.38660392405),
    ("q5", 0.40809748085), ("q3", 0.64656012793), ("q4", 0.75717633250), ("q2", 0.76432625748),
    ("q1", 0.84203125209), ("q2", 0.85276347079),
]  # fmt: skip


@pytest.mark.slow
def test_a_robot_with_six_joints_moves_as_pinocchio_and_scipy_say():
    """Events that were located with another engine's equations, to 1e-11 s."""
    robot, laws = ur(), ur_laws()
    start = dict(zip(robot.coordinates, START, strict=True))
    solver = EventDriven(tier="compiled", tolerance=1e-12)
    run = simulate(robot, laws, t_end=4.0, y0=start, solver=solver)
    assert [e.contact for e in run.events][:10] == [name for name, _ in UR_EVENTS]
    assert [e.t for e in run.events][:10] == pytest.approx([t for _, t in UR_EVENTS], abs=3e-11)
    ends = (-1.283338505, 7.982650928, 3.062804467, -7.831914021, 3.872642595, 0.2)
    # the motion is chaotic: errors grow 100-fold a second
    assert [run.at(2.0)[q][0] for q in robot.coordinates] == pytest.approx(ends, abs=2e-9)
    assert np.ptp(run["q6"]) == 0.0
    assert len(run.events) == 39


def test_a_door_strikes_its_stop_and_comes_back():
    """J = 4.5 kg m^2, M = 3 N m: 4 - 2 M / J of the squared speed are left after 1 rad."""
    hinge = RobotJoint(
        joint="Hinge", mass=20.0, centre_x=0.4, inertia_zz=1.3, upper_stop=1.0, restitution=0.5
    )
    door = Robot(joints=(hinge,))
    run = simulate(door, Coulomb(kinetic_coefficient=3.0), t_end=9.0, y0={"Hinge_dot": 2.0})
    back = 0.25 * (4.0 - 2.0 * 3.0 / 4.5) * 4.5 / (2.0 * 3.0)
    assert run["Hinge"][-1] == pytest.approx(1.0 - back, abs=1e-12)


def test_joints_of_a_description_do_not_pass_their_limits():
    found = read_urdf(DESK)
    assert {one.coordinate: (one.lower_stop, one.upper_stop) for one in found.robot.joints} == {
        "turret": (None, None), **found.limits
    }  # fmt: skip
    laws = {joint.contact_name: Coulomb(kinetic_coefficient=0.05) for joint in found.robot.joints}
    run = simulate(found.robot, laws, t_end=2.0, y0={"shoulder": 0.5, "elbow": 0.6})
    assert run.certificate.certified
    assert any("hits stop" in event.reason for event in run.events)
    for name, (low, high) in found.limits.items():
        assert low - 1e-12 <= run[name].min()
        assert run[name].max() <= high + 1e-12


def test_a_joint_whose_stops_exclude_0_begins_in_the_middle_between_them():
    hinge = RobotJoint(
        joint="Hinge", mass=20.0, centre_x=0.4, inertia_zz=1.3, lower_stop=-3.0, upper_stop=-0.5
    )
    run = simulate(Robot(joints=(hinge,)), Coulomb(kinetic_coefficient=3.0), t_end=1.0)
    assert run["Hinge"][0] == -1.75


def coupled(robot, multiples):
    """Return a robot whose motors turn with joints before them: by joint, multiples by joint."""
    joints = [
        dataclasses.replace(
            joint,
            lower_stop=None,
            upper_stop=None,
            armature=0.02,
            coupling=multiples.get(joint.joint, {}),
        )
        for joint in robot.joints
    ]
    return dataclasses.replace(robot, joints=tuple(joints))


@pytest.mark.parametrize("seed", range(4))
def test_coupled_motors_have_the_energies_of_the_joints(tmp_path, seed):
    """T(x) = T(q) + armatures' and V(x) = V(q), and virtual work, with x = q + c q_before."""
    robot = read(tmp_path, random_urdf(seed, count=4, kinds=("revolute", "prismatic"))).robot
    names = [heading.joint for heading in robot.joints]
    factors = {names[2]: {names[0]: 0.7}, names[3]: {names[2]: -1.3, names[1]: 0.4}}
    plain, other = coupled(robot, {}), coupled(robot, factors)
    mix = np.eye(4)
    for name, by in factors.items():
        for before, factor in by.items():
            mix[names.index(name), names.index(before)] = factor
    dice = np.random.default_rng(seed)
    q, v = dice.uniform(-2.0, 2.0, 4), dice.normal(size=4)
    own = 0.02 * np.eye(4)
    mass, taken = equations_of(plain, q, v)
    taken_there = equations_of(other, mix @ q, mix @ v)
    back = np.linalg.inv(mix)
    scale = np.abs(mass).max()
    expected = back.T @ (mass - own) @ back + own
    np.testing.assert_allclose(taken_there[0], expected, atol=1e-12 * scale, rtol=0)
    # dampers act along the coordinates, and equations_of leaves them out
    np.testing.assert_allclose(taken_there[1], back.T @ taken, atol=1e-11 * scale, rtol=0)
    heights = [
        one.potential_energy(0.0, dict(zip(one.coordinates, at, strict=True)))
        for one, at in ((plain, q), (other, mix @ q))
    ]
    assert heights[0] == pytest.approx(heights[1], rel=1e-12)


def test_a_coupled_arm_with_friction_balances_its_energy():
    arm = coupled(read_urdf(DESK).robot, {"elbow": {"shoulder": 1.0}})
    arm = dataclasses.replace(
        arm, joints=tuple(dataclasses.replace(joint, damping=0.0) for joint in arm.joints)
    )
    run = simulate(
        arm,
        Coulomb(kinetic_coefficient=0.05),
        t_end=2.0,
        y0={"shoulder": 0.5, "turret_dot": 1.0, "elbow": 0.8},
    )
    assert run.certificate.certified


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"coupling": {"wrist": 1.0}}, "joint in the coupling of 'elbow'.*'wrist'"),
        ({"coupling": {"elbow": 1.0}}, "coupling must be multiples"),
        ({"coupling": {"shoulder": math.inf}}, "coupling must be multiples"),
        ({"coupling": 3.0}, "coupling must be multiples"),
        ({"coupling": {"shoulder": 1.0}, "upper_stop": 1.0}, "takes no lower_stop or upper_stop"),
    ],
)
def test_couplings_that_are_refused(change, message):
    arm = coupled(read_urdf(DESK).robot, {})

    def changed():
        last = dataclasses.replace(arm.joints[2], **change)
        return dataclasses.replace(arm, joints=(*arm.joints[:2], last))

    with pytest.raises((ParameterError, UnknownNameError), match=message):
        changed()
