"""Rig files with a robot description: what they add to it, and what is refused."""

import math
from importlib.resources import files

import pytest
from tests.contact_cases import coulomb

from stickslip import Coulomb, load_rig
from stickslip.data import rig_toml
from stickslip.errors import InputError, UnknownNameError
from stickslip.mechanisms import read_urdf
from stickslip.mechanisms.drives import Sine

DESK = (files("stickslip.mechanisms") / "desk_arm.urdf").read_text()
ARM = """
[mechanism]
type = "urdf"
file = "arm.urdf"
locked = { turret = "30 deg" }

[mechanism.joints.elbow]
mass = "1 kg"
effort = { type = "sine", amplitude = "500 N mm", frequency = "1 Hz" }

[friction.elbow]
kinetic_coefficient = 0.1
static_coefficient = 0.2

[run]
initial = { shoulder = "40 deg" }
"""


@pytest.fixture
def read(tmp_path):
    """Read a rig beside the description of the desk arm."""
    (tmp_path / "arm.urdf").write_text(DESK)

    def reader(text, **overrides):
        file = tmp_path / "rig.toml"
        file.write_text(text)
        return load_rig(file, overrides=overrides)

    return reader


def test_a_rig_adds_to_the_joints_of_a_description(read, tmp_path):
    rig = read(ARM)
    shoulder, elbow = rig.mechanism.joints
    plain = read_urdf(tmp_path / "arm.urdf", locked={"turret": math.radians(30.0)}).robot
    assert shoulder.orientation == pytest.approx(plain.joints[0].orientation, abs=1e-15)
    assert elbow.mass == 1.0
    assert elbow.inertia_yy == plain.joints[1].inertia_yy
    assert elbow.effort == Sine(amplitude=0.5, frequency=1.0)
    # the level of the shoulder stands in the description, that of the elbow in the rig file
    shoulder_law = Coulomb(kinetic_coefficient=0.4)
    assert rig.law_by_contact() == {"shoulder": shoulder_law, "elbow": coulomb(0.1, 0.2)}
    assert rig.initial == {"shoulder": pytest.approx(math.radians(40.0))}


def test_a_law_for_all_contacts_replaces_the_levels_of_the_description(read):
    text = ARM.partition("[friction.elbow]")[0] + "[friction.coulomb]\nkinetic_coefficient = 0.3\n"
    rig = read(text)
    assert rig.laws["coulomb"] == Coulomb(kinetic_coefficient=0.3)
    assert not rig.contacts


def test_overrides_reach_joints(read):
    rig = read(ARM, **{"mechanism.joints.shoulder.armature": "0.02 kg m^2"})
    assert rig.mechanism.joints[0].armature == 0.02


def test_the_digest_of_a_rig_covers_its_description(read, tmp_path):
    first = read(ARM).digest
    (tmp_path / "arm.urdf").write_text(DESK.replace('value="0.8"', 'value="0.9"'))
    assert load_rig(tmp_path / "rig.toml").digest != first


def test_a_robot_is_written_and_read_again(read):
    rig = read(ARM)
    laws = rig.law_by_contact()
    again = read(rig_toml(rig.mechanism, laws))
    assert again.mechanism == rig.mechanism
    assert again.law_by_contact() == laws


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("joints.elbow]", "joints.elbo]", "unknown moving joint.*'elbo'.*'elbow'"),
        ("joints.elbow]", "joints.turret]", "unknown moving joint.*'turret'"),
        ('mass = "1 kg"', 'mass = "-1 kg"', "rig.toml.*mass"),
        ('mass = "1 kg"', 'weight = "1 kg"', "unknown key in .mechanism.joints.elbow.*'weight'"),
        ('"30 deg"', '"30 kg"', "rig.toml.*locked.turret"),
        ("{ turret", "{ turet", "joint in .*arm.urdf.*rig.toml.*'turet'"),
        ('"arm.urdf"', '"other.urdf"', "rig.toml: mechanism: .*other.urdf cannot be read"),
        ('file = "arm.urdf"', "", "rig.toml: mechanism.file is missing"),
        ("[friction.elbow]", "[friction.elbo]", "unknown key in .friction.*'elbo'"),
    ],
)
def test_what_cannot_be_used_is_refused_by_name(read, old, new, message):
    assert old in ARM
    with pytest.raises((InputError, UnknownNameError), match=message):
        read(ARM.replace(old, new))
