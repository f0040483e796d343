"""Friction written for programs beside MuJoCo: each file is read again, by the real library."""

import difflib
import math

import numpy as np
import pytest

from stickslip import CoulombViscous, Pendulum, Rig, Stribeck
from stickslip.errors import InputError
from stickslip.exports import apply
from stickslip.friction import LAWS
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
    pytest.importorskip("pxr", reason="pip install usd-core")
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
    (row,) = written(LAW, path, "rail", load=1.0).joints
    friction = row.after["physxJointAxis:linear:dynamicFrictionEffort"]
    damping = row.after["physxJointAxis:linear:viscousFrictionCoefficient"]
    assert float(friction) * mass * length == pytest.approx(0.3, rel=1e-8)
    assert float(damping) * mass == pytest.approx(0.1, rel=1e-8)


def test_the_motor_of_a_mechanism_becomes_the_armature_of_a_scene(scene):
    motor = DCMotor(resistance=4.0, torque_constant=0.1, gear_ratio=5.0, rotor_inertia=2e-3)
    servo = Pendulum(mass=0.5, length=0.1, damping=0.02, drive=motor)
    rig = Rig(mechanism=servo, laws={"coulomb-viscous": LAW}, named=("coulomb-viscous",))
    (row,) = written(rig, scene(), "elbow").joints
    assert float(row.after["physxJointAxis:angular:armature"]) == pytest.approx(0.05)
    damping = row.after["physxJointAxis:angular:viscousFrictionCoefficient"]
    assert float(damping) == pytest.approx(0.12 * DEGREE, rel=1e-8)


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
    "a.txt": {"text": (lambda t: "hello", "none of the files that friction can be written into")},
}
WHOLE = {"robot.usda": STAGE, "a.txt": ""}


@pytest.mark.parametrize(("file", "kind"), [(file, kind) for file in BAD for kind in BAD[file]])
def test_a_file_that_cannot_take_the_law_is_refused_in_one_sentence(tmp_path, file, kind):
    change, message = BAD[file][kind]
    path = tmp_path / file
    text = change(WHOLE[file]).replace("METRES", "1").replace("KILOGRAMS", "1")
    path.write_text(text, encoding="utf-8")
    to = "physx" if file == "robot.usda" and kind != "binary" else None
    with pytest.raises(InputError, match=message):
        written(LAW, path, "elbow", to=to)


def test_what_a_format_does_not_have_is_refused(scene):
    path = scene()
    with pytest.raises(InputError, match=r"robot.usda is no file of MJCF"):
        written(LAW, path, "elbow", to="mjcf")
    with pytest.raises(InputError, match="unknown format 'physics'"):
        written(LAW, path, "elbow", to="physics")
    with pytest.raises(InputError, match="friction at rest of its own, that of break-away: leave"):
        written(LAW, path, "elbow", to="physx", holds=True)
    with pytest.raises(InputError, match=r"one damping for all speeds: leave polynomial \(--p"):
        written(LAW, path, "elbow", polynomial=True)
    gear = LAWS["bam-m3"](**LAWS["bam-m3"].typical.values)
    with pytest.raises(InputError, match="bam-m3 depends on transmitted: give it"):
        written(gear, path, "elbow")
