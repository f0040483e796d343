"""``stickslip apply``: the user's file with friction, what it costs, and one message otherwise."""

import json
from importlib.resources import files

import pytest
from tests.commands import commands

LAW = """
title = "Desk arm"
[mechanism]
type = "urdf"
file = "arm.urdf"
[friction.turret]
kinetic_coefficient = 0.3
[friction.shoulder.stribeck]
kinetic_coefficient = 0.5
static_coefficient = 0.7
stribeck_velocity = 0.1
[friction.elbow]
kinetic_coefficient = 0.2
"""
SPEED = ("--largest-speed", "2 rad/s")


@pytest.fixture
def called(tmp_path, monkeypatch, capsys):
    """Run commands in a folder with laws and a robot; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "law.toml").write_text(LAW, encoding="utf-8")
    robot = (files("stickslip.mechanisms") / "desk_arm.urdf").read_bytes()
    (tmp_path / "arm.urdf").write_bytes(robot)
    return commands(capsys, "apply", one_line=True)


def test_the_file_is_written_with_what_it_costs(called, tmp_path):
    code, out, _ = called("law.toml", "arm.urdf", "-o", "new/arm.urdf", *SPEED)
    assert code == 0
    assert "new/arm.urdf: arm.urdf with friction in turret, shoulder, elbow" in out
    assert "N m rms, " in out
    before, after = (
        (tmp_path / name).read_text().splitlines() for name in ("arm.urdf", "new/arm.urdf")
    )
    changed = [new for old, new in zip(before, after, strict=True) if old != new]
    assert len(changed) == 3
    assert all("<dynamics" in line for line in changed)


def test_the_document_has_all_numbers(called):
    options = ("--joint", "shoulder", "--joint", "elbow", "--json")
    code, out, _ = called("law.toml", "arm.urdf", "-o", "new.urdf", *options, *SPEED)
    assert code == 0
    found = json.loads(out)
    assert found["schema"] == "stickslip/apply/1"
    assert found["file"] == "new.urdf"
    shoulder, elbow = found["joints"]
    assert (shoulder["joint"], elbow["after"]["friction"]) == ("shoulder", "0.2")
    assert shoulder["largest"] > shoulder["rms"] > 0.0


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("law.toml", "arm.urdf", "-o", "arm.urdf"), "arm.urdf is the file that is read; give --f"),
        (("law.toml", "arm.urdf", "-o", "law.toml"), "law.toml already exists; give --force"),
        (("law.toml", "arm.urdf", "-o", "."), "is a folder, but a file is written"),
        (("law.toml", "none.urdf", "-o", "new.urdf"), "none.urdf cannot be read: No such file"),
        (("law.toml", "law.toml", "-o", "new.urdf"), "law.toml is none of the files that"),
        (("law.toml", "arm.urdf", "-o", "new.urdf"), "give its end, as --largest-speed"),
        (
            ("law.toml", "arm.urdf", "-o", "new.urdf", "--joint", "elbow=wrist", *SPEED),
            "has no joint 'wrist', but turret, shoulder, elbow",
        ),
        (
            ("law.toml", "arm.urdf", "-o", "new.urdf", "--joint", "elbow=a", "--joint", "b"),
            "takes contacts with joints or joints alone, got both",
        ),
        (
            ("law.toml", "arm.urdf", "-o", "new.urdf", "--polynomial", *SPEED),
            "URDF has one damping for all speeds",
        ),
        (
            ("law.toml", "arm.urdf", "-o", "new.urdf", "--largest-speed", "2 kg"),
            "--largest-speed",
        ),
        (("fit.json", "arm.urdf", "-o", "new.urdf"), "does not say all of its mechanism"),
    ],
)  # fmt: skip
def test_what_cannot_be_done_is_said_in_one_sentence_and_writes_nothing(
    called, tmp_path, arguments, message
):
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}
    code, out, err = called(*arguments)
    assert (code, out) == (2, "")
    assert message in err
    assert "Traceback" not in err
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_the_file_itself_is_replaced_with_force(called, tmp_path):
    code, _, _ = called("law.toml", "arm.urdf", "-o", "arm.urdf", "--force", *SPEED)
    assert code == 0
    assert 'friction="0.3"' in (tmp_path / "arm.urdf").read_text()


def test_a_verdict_stands_for_the_law_beside_it(called, tmp_path):
    (tmp_path / "verdict.json").write_text("{}")
    code, out, _ = called("verdict.json", "arm.urdf", "-o", "new.urdf", *SPEED)
    assert code == 0
    assert "shoulder: stribeck" in out


def test_laws_without_a_mechanism_go_into_a_joint(called, tmp_path):
    (tmp_path / "alone.toml").write_text(
        "[friction.coulomb]\nkinetic_coefficient = 0.4\n"
        "[friction.coulomb-viscous]\nkinetic_coefficient = 0.3\nviscous_coefficient = 0.1\n"
    )
    asked = ("alone.toml", "arm.urdf", "-o", "new.urdf", "--joint", "elbow", *SPEED)
    code, _, err = called(*asked)
    assert code == 2
    assert "alone.toml has coulomb, coulomb-viscous: choose one law with --law" in err
    code, out, _ = called(*asked, "--law", "coulomb-viscous")
    assert code == 0
    assert 'damping="0.1" friction="0.3"' in out
