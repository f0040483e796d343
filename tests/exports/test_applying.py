"""Friction written into URDF and MJCF files: what changes in them, and what MuJoCo makes of it."""

import re
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    QuadraticDrag,
    Rig,
    Stribeck,
    export,
    load_rig,
    simulate,
)
from stickslip.data import KnownLaws
from stickslip.errors import InputError, UnknownNameError
from stickslip.exports import apply
from stickslip.exports.applying import SHARE, Mjcf
from stickslip.exports.joints import PolynomialFriction, simplified
from stickslip.exports.program import Subject
from stickslip.mechanisms import read_urdf

LAW = CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=0.1)
STRIBECK = Stribeck(
    kinetic_coefficient=0.3, static_coefficient=0.4, stribeck_velocity=0.1, viscous_coefficient=0.05
)
DESK_ARM = Path(str(files("stickslip.mechanisms") / "desk_arm.urdf"))
STIFF = ([0.002, 1.0], [0.9999, 0.9999, 0.001])
ARM = """<?xml version="1.0" encoding="utf-8"?>
<!-- do not   touch <joint name="elbow"/> -->
<mujoco model="arm">
\t<compiler angle="degree" autolimits="true"/>
\t<option timestep="0.001" integrator='implicitfast'/>
\t<default>
\t\t<joint damping="0.6" armature="0.01"/>
\t\t<default class="servo">
\t\t\t<joint frictionloss="0.052" damping="0.3"   range="-90 90"/>
\t\t\t<default class="rail"> <joint type="slide" range="-1 1"/> </default>
\t\t</default>
\t</default>
\t<worldbody>
\t\t<body name="upper" childclass="servo">
\t\t\t<joint name="shoulder" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0.3 0 0"
				size="0.03" mass="1.2"/>
\t\t\t<body name="lower" pos="0.3 0 0">
\t\t\t\t<joint name='elbow'
\t\t\t\t       axis="0 1 0" frictionloss="0.1"  />
\t\t\t\t<geom type="capsule" fromto="0 0 0 0.25 0 0" size="0.02" mass="0.6"
					contype="0" conaffinity="0"/>
\t\t\t\t<body name="tool" pos="0.25 0 0">
\t\t\t\t\t<joint class="rail" name="rail" axis="1 0 0"/>
\t\t\t\t\t<geom size="0.03" mass="0.2" contype="0" conaffinity="0"/>
\t\t\t\t</body>
\t\t\t</body>
\t\t</body>
\t\t<body pos="0 0 2"><freejoint name="base"/><geom size=".1"/></body>
\t\t<body pos="0 3 2"><joint axis="1 0 0"/><joint name="globe" type="ball"/><geom size=".1"/></body>
\t</worldbody>
\t<equality><joint joint1="elbow" active="false"/></equality>
\t<actuator><position joint="elbow" kp="10"/></actuator>
</mujoco>
"""


@pytest.fixture
def arm(tmp_path):
    """Return the path of an MJCF file."""
    path = tmp_path / "arm.xml"
    path.write_bytes(ARM.encode())
    return path


def written(law, path, joints, **settings):
    settings = {"largest_speed": 2.0, **settings}
    return apply(law, path, joints=joints, **settings)


def mujoco_or_skip():
    return pytest.importorskip("mujoco", reason="MuJoCo is not installed: pip install mujoco")


URDF = """<robot name='ü'><!-- joint -->
  <link name="a"/><link name="b"/>
  {joint}
  <transmission name="t"><joint name="j"><mechanicalReduction>1</mechanicalReduction></joint>
  </transmission>
</robot>
"""
HEAD = '<parent link="a"/>\n    <child link="b"/>'


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
@pytest.mark.parametrize("mark", ["", "\ufeff"])
@pytest.mark.parametrize(
    ("joint", "expected"),
    [
        (
            f'<joint type="revolute" name="j">\n    {HEAD}\n  </joint>',
            f'<joint type="revolute" name="j">\n    {HEAD}\n    <dynamics damping="0.1"'
            ' friction="0.3"/>\n  </joint>',
        ),
        (
            f'<joint name="j" type="continuous">{HEAD}<dynamics friction = "1"'
            "  damping='9' /></joint>",
            f'<joint name="j" type="continuous">{HEAD}<dynamics friction = "0.3"'
            "  damping='0.1' /></joint>",
        ),
        (
            f"<joint name='j' type='revolute'  >{HEAD}<dynamics\n  damping=\"9\""
            "\n/> <!-- > --></joint>",
            f"<joint name='j' type='revolute'  >{HEAD}<dynamics\n  damping=\"0.1\""
            ' friction="0.3"\n/> <!-- > --></joint>',
        ),
        (
            f'<joint name="j" type="revolute">{HEAD}<dynamics></dynamics></joint>',
            f'<joint name="j" type="revolute">{HEAD}<dynamics damping="0.1"'
            ' friction="0.3"></dynamics></joint>',
        ),
    ],
    ids=["none", "both", "one", "empty"],
)
def test_only_the_dynamics_of_the_joint_change_in_urdf(tmp_path, joint, expected, mark, newline):
    path = tmp_path / "robot.urdf"
    before, after = (
        (mark + URDF.format(joint=one)).replace("\n", newline).encode() for one in (joint, expected)
    )
    path.write_bytes(before)
    assert written(LAW, path, "j").content == after
    path.write_bytes(after)
    # what is there already is written again with the same bytes
    assert written(LAW, path, "j").content == after


def test_only_the_attributes_of_the_joint_change_in_mjcf(arm):
    found = written(LAW, arm, ["shoulder", "elbow"])
    solver = 'solreffriction="0.002 1" solimpfriction="0.9999 0.9999 0.001"'
    expected = ARM.replace(
        '<joint name="shoulder" axis="0 1 0"/>',
        f'<joint name="shoulder" axis="0 1 0" frictionloss="0.3" damping="0.1" {solver}/>',
    ).replace(
        'axis="0 1 0" frictionloss="0.1"  />',
        f'axis="0 1 0" frictionloss="0.3" damping="0.1" {solver}  />',
    )
    assert found.content.decode() == expected
    shoulder, elbow = found.joints
    assert shoulder.before == {"damping": "0.3", "armature": "0.01", "frictionloss": "0.052"}
    assert elbow.before["frictionloss"] == "0.1"
    (said,) = (line for line in elbow.lost if "take the place" in line)
    assert "damping='0.3' of class 'servo'" in said
    assert "frictionloss" not in said


def test_the_class_of_a_joint_says_whether_it_turns(arm):
    assert not written(LAW, arm, "rail", load=1.0).joints[0].rotary
    with pytest.raises(InputError, match="joint 'rail' slides, but the law is of a mechanism that"):
        written(
            Rig(mechanism=Axis(inertia=0.1, rotary=True), laws={LAW.name: LAW}, named=(LAW.name,)),
            arm,
            "rail",
        )


def robot_rig(laws, **changes):
    """Return the desk arm with laws by joint."""
    robot = read_urdf(DESK_ARM).robot
    robot = replace(robot, joints=tuple(replace(joint, **changes) for joint in robot.joints))
    contacts = {
        contact.name: KnownLaws(laws={law.name: law}, named=(law.name,))
        if (law := laws.get(contact.name))
        else None
        for contact in robot.contacts()
    }
    return Rig(mechanism=robot, contacts=contacts, path="law.toml")


def test_laws_go_to_joints_of_their_names_with_damper_and_motor_of_the_mechanism(arm):
    rig = robot_rig({"shoulder": LAW, "elbow": STRIBECK}, damping=0.04, armature=0.003)
    found = written(rig, arm, None)
    assert [joint.joint for joint in found.joints] == ["shoulder", "elbow"]
    shoulder, elbow = (joint.after for joint in found.joints)
    assert float(shoulder["damping"]) == pytest.approx(0.14)
    assert float(shoulder["armature"]) == 0.003
    near = simplified(Subject(law=STRIBECK, name="law", load=1.0, largest_speed=2.0))
    assert float(elbow["frictionloss"]) == pytest.approx(near.joint.level, rel=1e-8)
    assert float(elbow["damping"]) == pytest.approx(near.joint.damping + 0.04, rel=1e-8)
    assert found.joints[1].rms == near.rms
    swapped = written(rig, arm, {"elbow": "shoulder"})
    assert [(joint.contact, joint.joint) for joint in swapped.joints] == [("elbow", "shoulder")]
    urdf = written(rig, DESK_ARM, "elbow")
    assert any(
        line.startswith("Armature: URDF has none for the 0.003") for line in urdf.joints[0].lost
    )


def test_a_joint_whose_motor_others_turn_is_refused_and_a_fitted_armature_is_written(arm):
    rig = robot_rig({"shoulder": LAW, "elbow": STRIBECK}, damping=0.04, armature=0.003)
    turret, first, last = rig.mechanism.joints
    found = replace(first, added_armature=0.002)
    fitted = replace(rig, mechanism=replace(rig.mechanism, joints=(turret, found, last)))
    shoulder = written(fitted, arm, "shoulder").joints[0].after
    assert float(shoulder["armature"]) == pytest.approx(0.005)
    turned = replace(last, coupling={"shoulder": 1.0}, lower_stop=None, upper_stop=None)
    coupled = replace(rig, mechanism=replace(rig.mechanism, joints=(turret, first, turned)))
    with pytest.raises(InputError, match="choose the other joints with --joint"):
        written(coupled, arm, None)
    assert written(coupled, arm, "shoulder").joints[0].joint == "shoulder"


def test_the_error_of_the_force_is_that_over_the_speeds_of_both_directions():
    found = written(STRIBECK, DESK_ARM, "elbow").joints[0]
    v = np.linspace(0.0, 2.0, 20001)[1:]
    level, damping = (float(found.after[key]) for key in ("friction", "damping"))
    apart = np.array([STRIBECK.force(speed, load=1.0) for speed in v]) - level - damping * v
    # the grid of 2001 speeds puts some 1/200 too much on the speed 0, where the error is largest
    assert found.rms == pytest.approx(np.sqrt(np.mean(apart**2)), rel=5e-3)
    assert found.largest == pytest.approx(np.abs(apart).max(), rel=1e-3)


def test_a_polynomial_carries_what_grows_with_a_power_and_never_drives(arm):
    drag = QuadraticDrag(kinetic_coefficient=0.3, quadratic_coefficient=0.2)
    (row,) = written(drag, arm, "elbow", polynomial=True).joints
    assert row.largest < 1e-9
    np.testing.assert_allclose(
        [float(one) for one in row.after["damping"].split()], [0.0, 0.2, 0.0], atol=1e-8
    )
    subject = Subject(law=STRIBECK, name="law", load=1.0, largest_speed=2.0)
    line, curve = (simplified(subject, polynomial=value) for value in (False, True))
    assert curve.rms < line.rms
    assert isinstance(curve.joint, PolynomialFriction)
    v = np.linspace(0.0, 200.0, 20001)
    joint = curve.joint
    damping = joint.damping + joint.damping_slope * v + joint.damping_curvature * v**2
    assert damping.min() > -1e-12
    with pytest.raises(InputError, match="URDF has one damping"):
        written(LAW, DESK_ARM, "elbow", polynomial=True)


def test_a_joint_that_holds_has_the_level_of_break_away(arm):
    steep = replace(STRIBECK, static_coefficient=0.9)
    (row,) = written(steep, arm, "elbow").joints
    assert any(line.startswith("It slips where the law holds: 60 %") for line in row.lost)
    (row,) = written(steep, arm, "elbow", holds=True).joints
    assert float(row.after["frictionloss"]) == 0.9
    assert not any(line.startswith("It slips") for line in row.lost)


BAD = {
    "nothing": (lambda t: "", "is not XML"),
    "cut": (lambda t: t[:-20], "is not XML"),
    "root": (lambda t: "<sdf/>", "root <sdf>; a URDF file has <robot>"),
    "encoding": (lambda t: t.replace("utf-8", "u"), "is not XML: unknown encoding"),
    "bytes": (lambda t: t.replace("utf-8", "utf-32"), "is not XML: multi-byte encodings"),
    "entities": (lambda t: "<!DOCTYPE x><mujoco/>", "declares entities"),
    "xacro": (
        lambda t: '<robot xmlns:xacro="x"><xacro:include filename="a"/></robot>',
        "has xacro macros: expand it first",
    ),
    "elbow": (lambda t: t.replace("'elbow'", "'knee'"), "no joint 'elbow', but shoulder, knee"),
    "unnamed": (lambda t: t.replace("'elbow'", "''"), r"2 joints have no name \(lines \d+, \d+\)"),
    "twice": (lambda t: t.replace('"rail" axis', '"elbow" axis'), "2 joints are called 'elbow'"),
    "ball": (
        lambda t: t.replace("'elbow'", "'x'").replace("globe", "elbow"),
        "of type ball, which turns about three axes.* take friction: shoulder, x, rail",
    ),
    "free": (lambda t: t.replace("'elbow'", "'x'").replace('"base"', '"elbow"'), "of type free"),
    "included": (
        lambda t: '<mujoco><include file="parts.xml"/></mujoco>',
        "not in this file but in .*parts.xml, which it includes",
    ),
}


@pytest.mark.parametrize("kind", BAD)
def test_a_model_that_cannot_take_the_law_is_refused_in_one_sentence(arm, kind):
    change, message = BAD[kind]
    (arm.parent / "parts.xml").write_text(ARM)
    arm.write_text(change(ARM))
    with pytest.raises(InputError, match=message):
        written(LAW, arm, "elbow")


@pytest.mark.parametrize("kind", ["mjcf", "urdf"])
def test_a_declaration_in_a_comment_is_none(arm, kind):
    said = b"<!-- no <!DOCTYPE x> and no <!ENTITY y> -->"
    if kind == "urdf":
        arm.write_bytes(DESK_ARM.read_bytes().replace(b"<link", said + b"<link", 1))
        assert len(read_urdf(arm).robot.joints) == 3
    else:
        arm.write_bytes(ARM.encode().replace(b"<default>", said + b"<default>", 1))
    assert said in written(LAW, arm, "elbow").content


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16"])
def test_a_declaration_is_refused_in_any_encoding(tmp_path, encoding):
    path = tmp_path / "robot.urdf"
    text = f'<?xml version="1.0" encoding="{encoding}"?><!DOCTYPE a [<!ENTITY b "c">]><robot/>'
    path.write_bytes(text.encode(encoding))
    for read in (read_urdf, lambda path: written(LAW, path, "j")):
        with pytest.raises(InputError, match="declares entities"):
            read(path)


def test_a_fixed_joint_has_no_friction(tmp_path):
    path = tmp_path / "robot.urdf"
    path.write_text(URDF.format(joint=f'<joint name="j" type="fixed">{HEAD}</joint>'))
    with pytest.raises(InputError, match="'j' is of type fixed, which does not move"):
        written(LAW, path, "j")


def test_a_file_in_another_encoding_is_refused_where_its_bytes_are_not_those_of_ascii(tmp_path):
    path = tmp_path / "robot.urdf"
    text = URDF.format(joint=f'<joint name="j" type="revolute">{HEAD}</joint>')
    path.write_bytes(f'<?xml version="1.0" encoding="utf-16"?>{text}'.encode("utf-16"))
    with pytest.raises(InputError, match="not in UTF-8"):
        written(LAW, path, "j")
    path.write_bytes(f'<?xml version="1.0" encoding="latin-1"?>{text}'.encode("latin-1"))
    assert "ü".encode("latin-1") in written(LAW, path, "j").content


def test_a_law_for_one_of_several_joints_asks_which(arm):
    with pytest.raises(InputError, match=r"3 joints that take friction \(shoulder, elbow, rail\)"):
        written(LAW, arm, None)
    rig = robot_rig({"turret": LAW})
    with pytest.raises(InputError, match="no joint 'turret', but shoulder, elbow"):
        written(rig, arm, None)
    with pytest.raises(InputError, match="Pair them, as --joint turret=elbow"):
        written(rig, arm, "elbow")
    with pytest.raises(InputError, match="no contact 'elbow' has a law; those that do: turret"):
        written(rig, arm, {"elbow": "elbow"})


def test_a_file_is_replaced_with_force_only(arm):
    found = written(LAW, arm, "elbow")
    with pytest.raises(InputError, match="is the file that is read; give --force"):
        found.save(arm)
    link = arm.parent / "link.xml"
    link.symlink_to(arm)
    with pytest.raises(InputError, match="is the file that is read"):
        found.save(link)
    other = arm.parent / "other.xml"
    other.write_text("mine")
    with pytest.raises(InputError, match="already exists"):
        found.save(other)
    assert other.read_text() == "mine"
    assert arm.read_text() == ARM
    assert found.save(arm.parent / "new" / "arm.xml").read_bytes() == found.content
    assert found.save(arm, force=True).read_bytes() == found.content


def model_of(mujoco, content, stiff):
    """Return the whole model, of URDF with friction that holds."""
    spec = mujoco.MjSpec.from_string(content.decode())
    spec.compiler.balanceinertia = True
    spec.option.timestep = 1e-3
    for joint in spec.joints if stiff else ():
        joint.solref_friction, joint.solimp_friction[:3] = STIFF
    return spec.compile()


@pytest.mark.parametrize("kind", ["urdf", "mjcf"])
def test_an_arm_holds_all_joints_at_once_under_60_percent_of_break_away(arm, kind):
    mujoco = mujoco_or_skip()
    path = DESK_ARM if kind == "urdf" else arm
    names = ["turret", "shoulder", "elbow"] if kind == "urdf" else ["shoulder", "elbow"]
    model = model_of(mujoco, written(STRIBECK, path, names).content, kind == "urdf")
    model.opt.gravity[:] = 0.0
    data = mujoco.MjData(model)
    dofs = [int(model.jnt_dofadr[model.joint(name).id]) for name in names]
    data.qfrc_applied[dofs] = SHARE * 0.4
    begin = data.qpos[[int(model.jnt_qposadr[model.joint(name).id]) for name in names]].copy()
    while data.time < 10.0:
        mujoco.mj_step(model, data)
    moved = data.qpos[[int(model.jnt_qposadr[model.joint(name).id]) for name in names]] - begin
    print(f"{kind}: in 10 s joints moved by {moved} rad or m")
    assert np.abs(moved).max() < 1e-3


def test_a_whole_arm_under_gravity_moves_in_mujoco_as_ours_does(tmp_path):
    mujoco = mujoco_or_skip()
    names = ("turret", "shoulder", "elbow")
    text = re.sub(rb"<limit[^>]*/>", b'<limit lower="-9" upper="9" effort="1" velocity="1"/>',
                  DESK_ARM.read_bytes())  # fmt: skip
    path = tmp_path / "arm.urdf"
    path.write_bytes(text)
    model = model_of(mujoco, written(LAW, path, names).content, stiff=True)
    robot = read_urdf(path).robot
    robot = replace(robot, joints=tuple(replace(joint, damping=0.0) for joint in robot.joints))
    start = {"turret_dot": 2.0, "shoulder_dot": -1.0, "elbow_dot": 3.0, "shoulder": 0.2}
    t_end, apart = 1.0, []
    run = simulate(robot, dict.fromkeys(names, LAW), t_end=t_end, y0=start)
    for step in (1e-3, 5e-4):
        model.opt.timestep = step
        data, left = mujoco.MjData(model), 0.0
        for i, name in enumerate(names):
            data.qvel[i] = start.get(f"{name}_dot", 0.0)
            data.qpos[i] = start.get(name, 0.0)
        for i in range(round(t_end / step)):
            mujoco.mj_step(model, data)
            ours = run.at([(i + 1) * step])
            left = max(left, *(abs(data.qpos[k] - ours[name][0]) for k, name in enumerate(names)))
        apart.append(float(left))
    travel = max(float(np.ptp(run[name])) for name in names)
    print(f"largest distance {apart} rad at steps of 1 and 0.5 ms, over {travel:.3g} rad")
    # MuJoCo's steps are of first order
    assert apart[0] < 0.01 * travel
    assert apart[1] == pytest.approx(0.5 * apart[0], rel=0.3)


GEOM = '<geom size=".1"/>'
LARGE = {
    "replicate": ("body", f'<replicate count="1e8" offset="1 0 0">{GEOM}</replicate>', "elements"),
    "nested": (
        "body",
        f'<replicate count="1000"><replicate count="1000">{GEOM}</replicate></replicate>',
        "elements exceed",
    ),
    "composite": ("body", '<composite type="cable" count="9999999 1 1" size="1"/>', "elements"),
    "flexcomp": ("body", '<flexcomp name="f" type="grid" count="999 999 999"/>', "elements"),
    "field": ("asset", '<hfield name="h" nrow="99999" ncol="99999" size="1 1 1 1"/>', "numbers"),
    "numeric": ("custom", '<numeric name="n" size="999999999"/>', "numbers"),
    "sensor": ("sensor", '<user name="u" dim="999999999"/>', "numbers"),
    "user": ("size", "nuser_geom='999999999'", "nuser_geom"),
    "memory": ("size", "memory='900G'", "bytes of memory"),
    "step": ("option", "timestep='1e-12'", "time step of 1e-12 s"),
    "iterations": ("option", "iterations='999999999'", "iterations"),
    "device": ("asset", '<mesh name="m" file="/dev/zero"/>', "inf bytes"),
    "model": ("asset", '<model name="m" file="arm.xml"/>', "models within the model"),
}


def test_a_model_that_includes_itself_is_read_once(arm):
    other = arm.parent / "other.xml"
    include = '<include file="{}"/>'
    other.write_text(
        f"<mujoco>{include.format('arm.xml') * 9}{include.format('other.xml') * 9}</mujoco>"
    )
    arm.write_text(ARM.replace("</mujoco>", include.format("other.xml") * 9 + "</mujoco>"))
    assert b"frictionloss" in written(LAW, arm, "elbow").content
    assert [part.path.name for part in Mjcf(arm, arm.read_bytes()).included()] == ["other.xml"]


@pytest.mark.parametrize("kind", ["mjcf", "urdf", "many"])
def test_elements_within_elements_without_end_are_refused(tmp_path, kind):
    path = tmp_path / "deep.xml"
    root, tag = ("robot", "link") if kind == "urdf" else ("mujoco", "body")
    inner = "<a/>" * 200_001 if kind == "many" else f"<{tag}>" * 1000 + f"</{tag}>" * 1000
    path.write_text(f"<{root}>{inner}</{root}>")
    message = "more than 200,000 elements" if kind == "many" else "nested more than 200 deep"
    with pytest.raises(InputError, match=message):
        written(LAW, path, "elbow")
    if kind == "urdf":
        with pytest.raises(InputError, match=message):
            read_urdf(path)


def test_what_adds_to_the_damping_of_a_joint_is_named(arm):
    text = ARM.replace('kp="10"', 'kp="10" damping="1"')
    arm.write_text(text.replace("<joint name='elbow'", "<joint name='elbow' springdamper='0.1 1'"))
    (row,) = written(Coulomb(kinetic_coefficient=0.3), arm, "elbow").joints
    assert any("springdamper='0.1 1' makes MuJoCo compute" in line for line in row.lost)
    assert any(re.match(r"The actuator <position> in line \d+ has damping", x) for x in row.lost)


def test_classes_of_included_files_count_and_missing_ones_are_named(arm):
    begin, end = ARM.index("\t<default>"), ARM.index("\t<worldbody>")
    (arm.parent / "classes.xml").write_text(f"<mujoco>{ARM[begin:end]}</mujoco>")
    include = '\t<include file="classes.xml"/>\n'
    arm.write_text(ARM[:begin] + include + ARM[end:])
    found = written(LAW, arm, "rail", load=1.0)
    assert not found.joints[0].rotary
    assert b"<include" in found.content
    arm.write_text(ARM[:begin] + ARM[end:])
    (row,) = written(LAW, arm, "rail").joints
    assert any(line.startswith("Class 'rail' is neither in this file") for line in row.lost)


def with_nested_classes(arm, places):
    """Put the classes into parts of parts; those in later places are of other joints."""
    begin, end = ARM.index("\t<default>"), ARM.index("\t<worldbody>")
    classes, folder = ARM[begin:end], arm.parent
    (folder / "parts/deep").mkdir(parents=True)
    (folder / "parts/more.xml").write_text('<mujoco><include file="classes.xml"/></mujoco>')
    for i, place in enumerate(places):
        text = classes.replace('type="slide"', 'type="hinge"') if i else classes
        (folder / place / "classes.xml").write_text(f"<mujoco>{text}</mujoco>")
    arm.write_text(ARM[:begin] + '\t<include file="parts/more.xml"/>\n' + ARM[end:])


@pytest.mark.parametrize("places", [("",), ("parts",), ("", "parts")])
def test_classes_of_nested_includes_are_those_that_mujoco_finds(arm, places):
    """MuJoCo seeks them beside the main file first, then beside the one that includes."""
    mujoco = mujoco_or_skip()
    with_nested_classes(arm, places)
    model = mujoco.MjModel.from_xml_path(str(arm))
    assert model.joint("rail").type[0] == mujoco.mjtJoint.mjJNT_SLIDE
    (row,) = written(LAW, arm, "rail", load=1.0).joints
    assert not row.rotary


def test_classes_that_mujoco_does_not_find_are_missing(arm):
    mujoco = mujoco_or_skip()
    with_nested_classes(arm, ("parts/deep",))
    with pytest.raises(ValueError, match=r"classes\.xml"):
        mujoco.MjModel.from_xml_path(str(arm))
    (row,) = written(LAW, arm, "rail").joints
    assert any(line.startswith("Class 'rail' is neither in this file") for line in row.lost)


def test_a_joint_of_a_nested_include_is_named_with_the_file_that_mujoco_reads(arm):
    folder = arm.parent
    (folder / "parts").mkdir()
    (folder / "parts/more.xml").write_text('<mujoco><include file="limb.xml"/></mujoco>')
    for place in ("limb.xml", "parts/limb.xml"):
        (folder / place).write_text(ARM)
    arm.write_text('<mujoco><include file="parts/more.xml"/></mujoco>')
    with pytest.raises(InputError, match=re.escape(f"but in {folder / 'limb.xml'}, which it")):
        written(LAW, arm, "elbow")


def test_joints_have_no_normal_force_to_depend_on(arm):
    rig = robot_rig({"elbow": LAW}, damping=0.0)
    for source in (rig, LAW):
        (row,) = written(source, arm, "elbow").joints
        assert not any("normal force" in line for line in row.lost)
    (row,) = written(LAW, arm, "rail", load=2.0).joints
    assert "Dependence on the normal force: the joint has the friction at 2 N." in row.lost
    text = export(rig, "c", contact="elbow").files
    assert "no normal force was known" not in "".join(text.values())
    slide = Rig(
        mechanism=Axis(inertia=1.0), laws={"coulomb-viscous": LAW}, named=("coulomb-viscous",)
    )
    (row,) = written(slide, arm, "rail").joints
    assert "Dependence on the normal force, which was not known." in row.lost


def test_each_law_takes_the_inputs_that_it_depends_on_and_those_of_its_contact(tmp_path):
    (tmp_path / "law.toml").write_text(
        f"""
[mechanism]
type = "urdf"
file = {str(DESK_ARM)!r}
moving = ["shoulder", "elbow"]

[friction.shoulder.coulomb-viscous]
kinetic_coefficient = 0.5
viscous_coefficient = 0.2

[friction.elbow.bam-m3]
kinetic_coefficient = 0.2
transmitted_coefficient = 0.25
viscous_coefficient = 0.05
""",
        encoding="utf-8",
    )
    rig = load_rig(tmp_path / "law.toml")

    def levels(at):
        found = apply(rig, DESK_ARM, at=at, largest_speed=2.0)
        return [float(row.after["friction"]) for row in found.joints]

    assert levels({"transmitted": "2 N m"}) == pytest.approx([0.5, 0.7])
    assert levels({"elbow": {"transmitted": 1.0}}) == pytest.approx([0.5, 0.45])
    # that of the contact stands before that of all
    both = {"transmitted": 2.0, "elbow": {"transmitted": 1.0}}
    assert levels(both) == pytest.approx([0.5, 0.45])
    with pytest.raises(InputError, match="no law of these joints depends on temperature"):
        levels({"transmitted": 2.0, "temperature": 20.0})
    with pytest.raises(UnknownNameError, match=r"'elbo'.*'elbow'"):
        levels({"elbo": {"transmitted": 1.0}})
    with pytest.raises(UnknownNameError, match="contact input of coulomb-viscous"):
        levels({"elbow": {"transmitted": 1.0}, "shoulder": {"transmitted": 1.0}})
