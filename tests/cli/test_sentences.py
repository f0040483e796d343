"""Sentences of commands say all of it: units, each placeholder, how every branch ends, rest."""

import json

import pytest
from tests.commands import commands

AXIS = """
[mechanism]
type = "axis"
inertia = "1 kg"
stiffness = "100 N/m"
drive = {type = "sine", amplitude = "4 N", frequency = "2 Hz"}
[friction.coulomb]
kinetic_coefficient = 0.5
"""
CAPSULE = """
[mechanism]
type = "capsule"
capsule_mass = "80 g"
inner_mass = "20 g"
stiffness = "60 N/m"
damping = "0.03 N s/m"
drive_on = "inner mass"
[mechanism.upper_soft_stop]
place = "2 mm"
stiffness = "3000 N/m"
damping = "0.1 N s/m"
[mechanism.drive]
type = "torque"
drive = { type = "sine", amplitude = "0.2 N", frequency = "8 Hz" }
[friction.coulomb]
kinetic_coefficient = 0.2
"""


@pytest.fixture
def called(tmp_path, monkeypatch, capsys):
    """Return a function that runs a command where rigs lie: exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "axis.toml").write_text(AXIS)
    (tmp_path / "capsule.toml").write_text(CAPSULE)
    (tmp_path / "open.toml").write_text(AXIS.replace("1 kg", "? kg").replace("4 N", "? N"))
    (tmp_path / "still.toml").write_text(AXIS.replace("4 N", "0.1 N"))
    return commands(capsys, one_line=True)


def test_a_change_of_sign_has_a_unit(called):
    frequencies = ("--vary", "frequency=4:5:3", "--settle", "40", "--cycles", "6")
    code, out, _ = called("sweep", "capsule.toml", *frequencies)
    assert code == 0
    (line,) = [text for text in out.splitlines() if "changes sign at about" in text]
    assert line.endswith(" Hz.")


def test_a_parameter_with_a_default_is_set_by_its_last_name(called):
    """It was refused, with its own name as what may be meant."""
    outs = [
        called("simulate", "capsule.toml", "--set", f"{path}=0.3")
        for path in ("static_coefficient", "friction.static_coefficient")
    ]
    assert outs[0] == outs[1]
    assert outs[0][0] == 0
    assert outs[0][1] != called("simulate", "capsule.toml")[1]


def test_no_refused_name_is_what_may_be_meant(called):
    for name in ("limit", "lower_stop", "squeez", "phas", "mu_s"):
        code, _, told = called("simulate", "capsule.toml", "--set", f"{name}=1e-3")
        assert code == 0 or f"Did you mean '{name}'" not in told


def test_all_question_marks_are_told_at_once(called):
    code, _, told = called("check", "open.toml")
    assert code == 2
    assert "2 values" in told
    assert "mechanism.inertia = '? kg'" in told
    assert "mechanism.drive.amplitude = '? N'" in told
    code, _, told = called("simulate", "open.toml", "--set", "inertia=1 kg")
    assert code == 2
    assert "inertia" not in told
    given = ("--set", "inertia=1 kg", "--set", "amplitude=4 N")
    assert called("simulate", "open.toml", *given)[0] == 0


def test_every_branch_says_how_it_ends_also_at_the_range(called):
    quick = ("--values", "3", "--settle", "40", "--period", "2", "--json")
    code, out, _ = called("orbits", "axis.toml", "--vary", "drive.frequency=1.9:2.4", *quick)
    assert code == 0
    (branch,) = json.loads(out)["branches"]
    assert branch["ends"] == ["It reaches 1.9 Hz.", "It reaches 2.4 Hz."]
