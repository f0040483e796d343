"""Friction written for programs beside MuJoCo: each file is read again, by the real library."""

import difflib
import json
import math
import random
from dataclasses import replace

import numpy as np
import pytest
import yaml
from tests.friction.test_gear_laws import PUBLISHED, made, published

from stickslip import BamM3, Coulomb, CoulombViscous, LuGre, Pendulum, Rig, Stribeck
from stickslip.errors import InputError
from stickslip.exports import apply
from stickslip.exports.applying import LEVELS, SPEEDS
from stickslip.friction import LAWS, bound
from stickslip.mechanisms import DCMotor

LAW = CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=0.1)
STRIBECK = Stribeck(
    kinetic_coefficient=0.3, static_coefficient=0.4, stribeck_velocity=0.1, viscous_coefficient=0.05
)
DEGREE = math.pi / 180.0
STAGE = '''#usda 1.0
(
    doc = """A scene ( with { open marks"""
    metersPerUnit = METRES
    kilogramsPerUnit = KILOGRAMS
)
def Xform "robot" ( # comment (
    prepend apiSchemas = ["PhysicsArticulationRootAPI"]
)
{
    def Cube "base" (prepend apiSchemas = ["PhysicsRigidBodyAPI"]) { double size = 1; }
    custom string note = "def PhysicsRevoluteJoint \\"elbow\\" {"
    /* def PhysicsRevoluteJoint "elbow" { } */
    def PhysicsRevoluteJoint "shoulder" (
        prepend apiSchemas = ["PhysicsDriveAPI:angular"]
    )
    {
        rel physics:body0 = </robot/base>
        uniform token physics:axis = "Z"
        float drive:angular:physics:damping = 2 ( doc = "ü" )
        float physxJointAxis:angular:staticFrictionEffort = 9   # by hand
        float newton:friction = 0.125; float newton:damping = 3
    }
    def PhysicsRevoluteJoint "elbow" { uniform token physics:axis = "X"; }
    def PhysicsPrismaticJoint "rail"
    {   # empty
    }
    def PhysicsRevoluteJoint "wrist" ("said"
        customData = { string def = "x"; }
        delete apiSchemas = ["NewtonJointAPI"]
    ) {}
    def PhysicsRevoluteJoint "finger" (
        active = true
        apiSchemas = []
    ) {
    }
    def PhysicsFixedJoint "lock" {}
    def PhysicsSphericalJoint "globe" {}
}
'''
JOINTS = ("shoulder", "elbow", "wrist", "finger")


@pytest.fixture
def scene(tmp_path):
    """Write a scene with its units."""

    def writer(metres="1", kilograms="1", newline="\n"):
        path = tmp_path / "robot.usda"
        text = STAGE.replace("METRES", metres).replace("KILOGRAMS", kilograms)
        path.write_bytes(text.replace("\n", newline).encode())
        return path

    return writer


def written(law, path, joints, **settings):
    settings = {"largest_speed": 2.0, **settings}
    return apply(law, path, joints=joints, **settings)


def changed(old, new):
    """Return the lines that one text has and the other has not."""
    lines = difflib.ndiff(old.splitlines(), new.splitlines())
    return [line for line in lines if line[:2] in ("- ", "+ ")]


def stage_of(content):
    # schemas are registered before OpenUSD first looks for any
    for name in ("pxr", "newton_usd_schemas"):
        pytest.importorskip(name, reason="pip install usd-core newton-usd-schemas")
    from pxr import Sdf, Usd

    layer = Sdf.Layer.CreateAnonymous(".usda")
    assert layer.ImportFromString(content.decode())
    return Usd.Stage.Open(layer)


def of_prim(stage, name):
    """Return the schemas of a joint that are written, and its numbers."""
    prim = stage.GetPrimAtPath(f"/robot/{name}")
    listed = prim.GetMetadata("apiSchemas")
    schemas = [*listed.prependedItems, *listed.explicitItems] if listed else []
    values = {attributes.GetName(): attributes.Get() for attributes in prim.GetAuthoredAttributes()}
    return schemas, values


@pytest.mark.parametrize("newline", ["\n", "\r\n"])
def test_joints_of_physx_have_the_friction_and_openusd_reads_it(scene, newline):
    path = scene(newline=newline)
    found = written(STRIBECK, path, JOINTS, to="physx")
    stage = stage_of(found.content)
    for row in found.joints:
        schemas, values = of_prim(stage, row.joint)
        assert (
            schemas[-1:] == ["PhysxJointAxisAPI:angular"] or "PhysxJointAxisAPI:angular" in schemas
        )
        got = {key.rsplit(":", 1)[1]: x for key, x in values.items() if key.startswith("physx")}
        v = np.linspace(0.0, 2.0, 20001)[1:]
        damping = got["viscousFrictionCoefficient"] / DEGREE
        apart = STRIBECK.steady(v, 1.0) - got["dynamicFrictionEffort"] - damping * v
        # of 2001 speeds, the least counts for some 1/200 too much, and the error is largest there
        assert row.rms == pytest.approx(np.sqrt(np.mean(apart**2)), rel=5e-3)
        assert got["staticFrictionEffort"] == pytest.approx(0.4, rel=1e-6)
        assert got["dynamicFrictionEffort"] < got["staticFrictionEffort"]
        assert not any(line.startswith("Static friction") for line in row.lost)
    _, values = of_prim(stage, "shoulder")
    assert values["newton:friction"] == 0.125
    assert any("drive:angular:physics:damping = 2" in line for line in found.joints[0].lost)


def test_joints_of_newton_have_the_friction_and_its_schema_knows_them(scene):
    path = scene()
    found = written(LAW, path, JOINTS, to="newton")
    found.save(path, force=True)
    found = written(LAW, path, "rail", to="newton", load=2.0)
    stage = stage_of(found.content)
    from pxr import Usd

    known = Usd.SchemaRegistry().FindAppliedAPIPrimDefinition("NewtonJointAPI").GetPropertyNames()
    for name in (*JOINTS, "rail"):
        assert stage.GetPrimAtPath(f"/robot/{name}").HasAPI("NewtonJointAPI") or name == "wrist"
        _, values = of_prim(stage, name)
        assert {"newton:friction", "newton:damping"} <= {*known} & values.keys()
        level, unit = (0.6, 1.0) if name == "rail" else (0.3, DEGREE)
        assert values["newton:friction"] == pytest.approx(level, rel=1e-6)
        assert values["newton:damping"] == pytest.approx(0.1 * unit, rel=1e-6)


def test_the_rest_of_a_scene_stays_byte_by_byte(scene):
    path = scene()
    old = path.read_bytes()
    (row,) = written(LAW, path, "shoulder", to="physx").joints
    assert row.before == {"physxJointAxis:angular:staticFrictionEffort": "9"}
    new = written(LAW, path, "shoulder", to="physx").content
    lines = changed(old.decode(), new.decode())
    assert [line for line in lines if line.startswith("- ")] == [
        '-         prepend apiSchemas = ["PhysicsDriveAPI:angular"]',
        "-         float physxJointAxis:angular:staticFrictionEffort = 9   # by hand",
    ]
    assert "+         float physxJointAxis:angular:staticFrictionEffort = 0.3   # by hand" in lines
    assert len(lines) == 6
    # once more changes nothing
    path.write_bytes(new)
    assert written(LAW, path, "shoulder", to="physx").content == new


@pytest.mark.parametrize(("metres", "kilograms"), [("0.01", "1"), ("1", "1000"), ("0.01", "0.001")])
def test_a_scene_in_other_units_has_the_same_friction_in_these(scene, metres, kilograms):
    length, mass = float(metres), float(kilograms)
    path = scene(metres, kilograms)
    torque = mass * length**2  # of a unit of it [N m]
    (row,) = written(STRIBECK, path, "elbow", to="physx").joints
    (plain,) = written(STRIBECK, scene(), "elbow", to="physx").joints
    for key, value in row.after.items():
        assert float(value) * torque == pytest.approx(float(plain.after[key]), rel=1e-8)
    path = scene(metres, kilograms)
    (row,) = written(LAW, path, "rail", to="newton", load=1.0).joints
    assert float(row.after["newton:friction"]) * mass * length == pytest.approx(0.3, rel=1e-8)
    assert float(row.after["newton:damping"]) * mass == pytest.approx(0.1, rel=1e-8)


def test_the_motor_of_a_mechanism_becomes_the_armature_of_a_scene(scene):
    motor = DCMotor(resistance=4.0, torque_constant=0.1, gear_ratio=5.0, rotor_inertia=2e-3)
    servo = Pendulum(mass=0.5, length=0.1, damping=0.02, drive=motor)
    rig = Rig(mechanism=servo, laws={"coulomb-viscous": LAW}, named=("coulomb-viscous",))
    for to, key in (("physx", "physxJointAxis:angular:armature"), ("newton", "newton:armature")):
        (row,) = written(rig, scene(), "elbow", to=to).joints
        assert float(row.after[key]) == pytest.approx(0.05)
        damping = next(
            float(x) for name, x in row.after.items() if "iscous" in name or "damp" in name
        )
        assert damping == pytest.approx(0.12 * DEGREE, rel=1e-8)


PARAMETERS = """{
  "kt": 0.28, "R": 2.0,
  "armature": 0.0025,
  "note": "µ \\"friction_base\\": 3",
  "friction_base": 0.002,   "friction_viscous" : 1.8e-2,
  "nested": {"friction_base": 7},
  "model": "m1",
  "actuator": "xl330"
}
"""


@pytest.fixture
def servo(tmp_path):
    """Return the path of the parameters of a servo."""
    path = tmp_path / "m1.json"
    path.write_text(PARAMETERS, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", PUBLISHED)
def test_a_gear_law_is_written_as_its_source_has_it(servo, name):
    law, values = made(name)
    found = apply(law, servo)
    got = json.loads(found.content)
    for key, value in values.items():
        # nine digits are written
        assert got[key] == pytest.approx(value, rel=1e-8, abs=1e-15)
    assert got["model"] == name.removeprefix("bam-")
    assert (got["nested"], got["kt"], got["actuator"]) == ({"friction_base": 7}, 0.28, "xl330")
    (row,) = found.joints
    assert (row.joint, row.rms, row.largest_speed) == ("xl330", 0.0, None)
    assert "The file has the law itself: the error of the friction is 0." in row.sentences
    read = {key: got[key] for key in (*LEVELS, *SPEEDS, "friction_stribeck") if key in values}
    for motor, external, v in ((0.4, -0.3, 0.05), (-0.2, 0.5, 0.7), (0.3, 0.3, -2.0)):
        told = bound(law, {"motor": motor, "external": external, "transmitted": motor - external})
        level, damping = published(read, motor, external, v)
        expected = math.copysign(level, v) + damping * v
        assert told.force(v, 1.0) == pytest.approx(expected, rel=1e-7)


@pytest.mark.parametrize("name", PUBLISHED)
def test_rhoban_bam_itself_has_the_friction_of_the_law(servo, name):
    reason = "Rhoban/bam is not installed (Python 3.12): pip install better-actuator-models"
    bam = pytest.importorskip("bam.model", reason=reason)
    law, _ = made(name)
    model = bam.load_model(str(apply(law, servo).save(servo, force=True)))
    rng = random.Random(0)
    for _ in range(50):
        motor, external = rng.gauss(0.0, 0.5), rng.gauss(0.0, 0.5)
        v = rng.choice((-1.0, 1.0)) * 10.0 ** rng.uniform(-3.0, 1.0)
        level, damping = model.compute_frictions(motor, external, v)
        told = bound(law, {"motor": motor, "external": external, "transmitted": motor - external})
        # nine digits are written
        assert abs(told.force(v, 1.0)) == pytest.approx(level + damping * abs(v), rel=1e-7)


def test_the_rest_of_the_parameters_of_a_servo_stays_byte_by_byte(servo):
    found = apply(LAW, servo)
    expected = PARAMETERS.replace('"friction_base": 0.002', '"friction_base": 0.3')
    assert found.content.decode() == expected.replace("1.8e-2", "0.1")
    added = apply(LAWS["bam-m3"](**LAWS["bam-m3"].typical.values), servo).content.decode()
    assert added.endswith('"actuator": "xl330",\n  "load_friction_base": 0.264077\n}\n')


def test_a_law_of_another_name_is_one_of_the_six_only_where_it_is_the_same(servo):
    (row,) = apply(STRIBECK, servo).joints
    assert (row.after["model"], row.after["alpha"], row.rms) == ("m2", "2", 0.0)
    lifted = replace(STRIBECK, break_away_coefficient=0.6)
    (row,) = apply(lifted, servo, largest_speed=2.0).joints
    assert row.after["model"] == "m1"
    assert row.rms > 0.0
    assert any(line.startswith("Static friction: rest holds 0.6 N m") for line in row.lost)
    bristles = LuGre.from_forces(
        load=1.0, kinetic_force=0.3, static_force=0.4, stribeck_velocity=0.1,
        bristle_stiffness=40.0, bristle_damping=0.4, viscous_coefficient=0.1,
    )  # fmt: skip
    (row,) = apply(bristles, servo, largest_speed=2.0).joints
    assert any(line.startswith("Bristles:") for line in row.lost)


def test_a_servo_gets_the_motor_with_which_its_friction_was_found(servo):
    motor = DCMotor(
        resistance=4.0, torque_constant=0.1, back_emf_constant=0.12, gear_ratio=5.0,
        rotor_inertia=2e-3,
    )  # fmt: skip
    law = BamM3(kinetic_coefficient=0.01, transmitted_coefficient=0.25, viscous_coefficient=0.01)
    arm = Pendulum(mass=0.5, length=0.1, damping=0.02, drive=motor)
    rig = Rig(mechanism=arm, laws={"bam-m3": law}, named=("bam-m3",))
    found = apply(rig, servo)
    got = json.loads(found.content)
    assert got["kt"] == pytest.approx(0.5)
    assert (got["R"], got["armature"]) == (4.0, pytest.approx(0.05))
    assert got["friction_viscous"] == pytest.approx(0.03)
    lost = " ".join(found.joints[0].lost)
    assert "was 0.6 V s/rad at the shaft" in lost
    assert "The damping contains 0.02 N m s/rad of the mechanism" in lost


@pytest.mark.parametrize("levels", [1.0, 3.0])
def test_a_normal_force_scales_what_a_servo_has_but_for_its_viscous_part(servo, levels):
    law, values = made("bam-m4")
    arm = Pendulum(mass=0.5, length=0.1, load=levels)
    rig = Rig(mechanism=arm, laws={"bam-m4": law}, named=("bam-m4",))
    got = json.loads(apply(rig, servo).content)
    for key in ("friction_base", "friction_stribeck", "load_friction_base"):
        assert got[key] == pytest.approx(levels * values[key], rel=1e-8)
    assert got["friction_viscous"] == pytest.approx(values["friction_viscous"], rel=1e-8)


CONTROLLERS = """# all controllers
controller_manager:
  ros__parameters:
    update_rate: 500  # Hz
/arm/cartesian:
  ros__parameters:
    joints: [joint1, "joint2"]   # ü
    use_friction: true
    friction:
      fp1: [0.5, 0.8]
      fp2:
        - 5.0
        - 9.0   # steep
      fp3: [0.01, 0.02]
trajectory:
  ros__parameters:
    joints:
      - lift
      - held
    command_interfaces: [effort]
    gains:
      lift: {p: 10.0, ff_velocity_scale: 1}
      held: {p: 10.0}
positions:
  ros__parameters:
    joints: [placed]
    command_interfaces: [position]
    gains:
      placed: {ff_velocity_scale: 0.0}
"""


@pytest.fixture
def controllers(tmp_path):
    """Return the path of the parameters of controllers."""
    path = tmp_path / "controllers.yaml"
    path.write_text(CONTROLLERS, encoding="utf-8")
    return path


def test_a_controller_makes_up_for_friction_as_steeply_as_it_did(controllers):
    found = written(STRIBECK, controllers, "joint2")
    lines = changed(CONTROLLERS, found.content.decode())
    assert len(lines) == 4
    got = yaml.safe_load(found.content)["/arm/cartesian"]["ros__parameters"]["friction"]
    assert [got[key][0] for key in ("fp1", "fp2", "fp3")] == [0.5, 5.0, 0.01]
    (_, height), (_, steepness), (_, shift) = (got[key] for key in ("fp1", "fp2", "fp3"))
    assert (steepness, shift) == (9.0, 0.0)
    v = np.linspace(-2.0, 2.0, 40001)
    v = v[v != 0.0]
    made_up = height / (1.0 + np.exp(-steepness * v)) - 0.5 * height
    friction = np.sign(v) * STRIBECK.steady(np.abs(v), 1.0)
    # no other height is nearer, and the stated error is what this one leaves
    assert made_up @ (friction - made_up) == pytest.approx(0.0, abs=2e-4 * (made_up @ made_up))
    rms = np.sqrt(np.mean((friction - made_up) ** 2))
    (row,) = found.joints
    assert row.rms == pytest.approx(rms, rel=5e-3)
    assert "Static friction: rest holds 0.4 N m, with the controller 0 N m." in row.lost


def test_a_trajectory_controller_has_the_viscous_part_that_comes_nearest(controllers):
    found = written(LAW, controllers, "lift")
    gains = yaml.safe_load(found.content)["trajectory"]["ros__parameters"]["gains"]
    # least squares of f + d v by k v over speeds up to V: k = d + 1.5 f / V
    assert gains["lift"]["ff_velocity_scale"] == pytest.approx(0.1 + 1.5 * 0.3 / 2.0, rel=2e-3)
    assert len(changed(CONTROLLERS, found.content.decode())) == 2


def test_a_damper_is_made_up_for_and_is_no_error(controllers):
    viscous = CoulombViscous(kinetic_coefficient=0.0, viscous_coefficient=0.1)
    arm = Pendulum(mass=0.5, length=0.1, damping=0.2)
    rig = Rig(mechanism=arm, laws={"coulomb-viscous": viscous}, named=("coulomb-viscous",))
    (row,) = written(rig, controllers, "lift").joints
    assert [float(x) for x in row.after.values()] == [pytest.approx(0.3)]
    assert row.rms == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("level", [3e-7, 4e9, 2.0])
def test_numbers_have_a_point_and_no_exponent_which_parts_of_ros_read_as_text(controllers, level):
    law = Coulomb(kinetic_coefficient=level)
    content = written(law, controllers, "lift").content
    value = yaml.safe_load(content)["trajectory"]["ros__parameters"]["gains"]["lift"]
    assert isinstance(value["ff_velocity_scale"], float)
    assert value["ff_velocity_scale"] == pytest.approx(0.75 * level, rel=2e-3)
    assert b"e-" not in content


def test_a_controller_that_leaves_friction_as_it_is_says_so(controllers):
    controllers.write_text(CONTROLLERS.replace("use_friction: true", "use_friction: false"))
    (row,) = written(LAW, controllers, "joint1").joints
    assert any(line.startswith("use_friction is not true") for line in row.lost)


BAD = {
    "robot.usda": {
        "cut": (lambda t: t[:-3], "is not USD: line 10 cannot be read"),
        "quote": (lambda t: t.replace('"elbow" {', '"elbow {'), "is not USD: line"),
        "unit": (lambda t: t.replace("metersPerUnit", "metres"), "does not say its unit of length"),
        "zero": (lambda t: t.replace("METRES", "0"), "must be above 0, got 0"),
        "fixed": (lambda t: t.replace("elbow", "x").replace("lock", "elbow"), "of type fixed"),
        "ball": (lambda t: t.replace("elbow", "x").replace("globe", "elbow"), "of type ball"),
        "name": (lambda t: t.replace('"elbow"', '"knee"'), "no joint 'elbow', but shoulder, knee"),
        "binary": (lambda t: "PXR-USDC\0", "is binary USD: write it as text first"),
    },
    "m.json": {
        "cut": (lambda t: t[:-4], "m.json is not JSON"),
        "other": (lambda t: '{"a": 1}', 'has no "model" and "actuator"'),
        "list": (lambda t: "[1]", 'has no "model" and "actuator"'),
        "deep": (lambda t: "[" * 100_000, "is not JSON"),
        "name": (lambda t: t, "no joint 'elbow', but xl330"),
    },
    "c.yaml": {
        "cut": (lambda t: "a: [1", "c.yaml is not YAML"),
        "other": (lambda t: "a: 1", "has no ros__parameters"),
        "empty": (lambda t: "", "has no ros__parameters"),
        "deep": (lambda t: "[" * 10_000, "is not YAML"),
        "alias": (
            lambda t: t.replace("[0.5, 0.8]", "&a [0.5, 0.8]").replace("[0.01, 0.02]", "*a"),
            "has an alias in line 14, which ROS 2 does not read",
        ),
        "position": (
            lambda t: t.replace("placed", "elbow"),
            "joint 'elbow' of positions has no friction to be written: neither",
        ),
        "name": (lambda t: t, "no joint 'elbow', but joint1, joint2, lift"),
        "steep": (
            lambda t: t.replace("joint1", "elbow").replace("- 5.0", "- 0"),
            r"friction.fp2\[0\] must be above 0 s/rad, got 0",
        ),
        "arrays": (
            lambda t: t.replace("joint1", "elbow, b"),
            "'elbow' of arm/cartesian has no friction to be written",
        ),
    },
    "a.txt": {"text": (lambda t: "hello", "none of the files that friction can be written into")},
}
WHOLE = {"robot.usda": STAGE, "m.json": PARAMETERS, "c.yaml": CONTROLLERS, "a.txt": ""}


@pytest.mark.parametrize(("file", "kind"), [(file, kind) for file in BAD for kind in BAD[file]])
def test_a_file_that_cannot_take_the_law_is_refused_in_one_sentence(tmp_path, file, kind):
    change, message = BAD[file][kind]
    path = tmp_path / file
    text = change(WHOLE[file]).replace("METRES", "1").replace("KILOGRAMS", "1")
    path.write_text(text, encoding="utf-8")
    to = "physx" if file == "robot.usda" and kind != "binary" else None
    with pytest.raises(InputError, match=message):
        written(LAW, path, "elbow", to=to)


def test_what_a_format_does_not_have_is_refused(scene, servo, controllers):
    path = scene()
    with pytest.raises(InputError, match="choose by --to physx, USD for PhysX or --to newton"):
        written(LAW, path, "elbow")
    with pytest.raises(InputError, match=r"robot.usda is no file of MJCF"):
        written(LAW, path, "elbow", to="mjcf")
    with pytest.raises(InputError, match="unknown format 'physics'"):
        written(LAW, path, "elbow", to="physics")
    with pytest.raises(InputError, match="friction at rest of its own, that of break-away: leave"):
        written(LAW, path, "elbow", to="physx", holds=True)
    for other in (servo, controllers):
        with pytest.raises(InputError, match=r"one damping for all speeds: leave polynomial \(--p"):
            written(LAW, other, None, polynomial=True)
    with pytest.raises(InputError, match="no friction at rest: leave holds"):
        written(LAW, controllers, "lift", holds=True)
    gear = LAWS["bam-m3"](**LAWS["bam-m3"].typical.values)
    with pytest.raises(InputError, match="bam-m3 depends on transmitted: give it"):
        written(gear, controllers, "lift")
