"""``stickslip export``: files, remarks, and one message for what cannot be done."""

import json

import pytest
from tests.commands import commands

LAW = """
title = "Slide"
[mechanism]
type = "spring-block"
mass = "1 kg"
stiffness = "100 N/m"
compression = "100 mm"
[friction.stribeck]
kinetic_coefficient = 0.25
static_coefficient = 0.35
stribeck_velocity = "20 mm/s"
[run]
t_end = "2 s"
[estimates]
law = "stribeck"
largest_speed = 0.7
[estimates.intervals]
kinetic_coefficient = [0.24, 0.26]
"""


@pytest.fixture
def called(tmp_path, monkeypatch, capsys):
    """Run commands in a folder with a law; return exit code, stdout and stderr on one line."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "law.toml").write_text(LAW, encoding="utf-8")
    return commands(capsys, "export", one_line=True)


def test_files_go_into_a_folder_and_are_named(called, tmp_path):
    code, out, _ = called("law.toml", "--to", "c", "--name", "my axis", "-o", "code")
    assert code == 0
    assert "C99: code/my_axis.h, code/my_axis.c" in out
    assert "95 %: 0.24 to 0.26" in (tmp_path / "code" / "my_axis.c").read_text(encoding="utf-8")


def test_a_joint_says_what_it_cannot_carry_and_what_that_changes(called):
    code, out, _ = called("law.toml", "--to", "mjcf", "--rig", "law.toml", "--json")
    assert code == 0
    found = json.loads(out)
    assert found["schema"] == "stickslip/export/1"
    assert found["files"] == ["stickslip-export/stribeck.xml"]
    assert any("falls with speed" in line for line in found["remarks"])
    assert any(
        line.startswith("On law.toml, simulated exactly to 2 s") for line in found["remarks"]
    )


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("law.toml", "--to", "fortran"), "unknown target 'fortran'. Known: c, csv, fmu, json"),
        (("law.json", "--to", "c"), "give the law.toml that `stickslip select` writes beside"),
        (("none.toml", "--to", "c"), "none.toml does not exist"),
        (("law.toml", "--to", "c", "--law", "dahl"), "dahl"),
        (("law.toml", "--to", "csv", "--load", "3 kg"), "--load"),
        (("law.toml", "--to", "csv", "--load", "-3 N"), "must be above 0 N"),
        (("law.toml", "--to", "csv", "--largest-speed", "0 m/s"), "must be above 0 m/s"),
        (("law.toml", "--to", "csv", "--law-load", "3 N"), "already coefficients"),
        (("law.toml", "--to", "c", "--contact", "elbow"), "this is one law"),
        (("law.toml", "--to", "c", "--name", "+"), "needs a letter or a digit"),
        (("law.toml", "--to", "c", "-o", "law.toml"), "a folder is needed"),
        (("law.toml", "--to", "c", "-o", "law.toml/x"), "cannot be written"),
    ],
)
def test_what_cannot_be_done_is_one_message_and_exit_code_2(called, tmp_path, arguments, message):
    code, out, err = called(*arguments)
    assert code == 2
    assert message in err
    assert "Traceback" not in err
    assert out == ""
    assert sorted(path.name for path in tmp_path.iterdir()) == ["law.toml"]


@pytest.mark.parametrize("target", ["json", "mjcf", "fmu"])
def test_an_existing_folder_is_refused_before_work_begins(called, tmp_path, monkeypatch, target):
    (tmp_path / "old").mkdir()
    for reader in ("load_rig", "rig_and_friction"):
        monkeypatch.setattr(
            f"stickslip.cli.export.{reader}", lambda *_, **__: pytest.fail("work began")
        )
    code, _, err = called("law.toml", "--to", target, "-o", "old")
    assert code == 2
    assert "old already exists; give --force to replace files in it, or another -o" in err


def test_a_selection_that_named_no_law_says_so(called, tmp_path):
    (tmp_path / "report").mkdir()
    (tmp_path / "report" / "verdict.json").write_text("{}", encoding="utf-8")
    code, _, err = called("report/law.toml", "--to", "c")
    assert code == 2
    assert "select recommended no law" in err


WARM = """
[mechanism]
type = "axis"
inertia = "2 kg"
load = "10 N"
[contact]
temperature = "30 degC"
[friction.warm]
law = "level + viscous * exponential[temperature]"
kinetic_coefficient = 0.2
viscous_coefficient = "3 N s/m"
viscous_temperature_decay = 0.03
"""


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--to", "c", "--at", "temperature=3"), "has an argument for each contact input"),
        (("--to", "urdf", "--at", "temperature"), "--at takes a contact input and its value"),
        (("--to", "urdf", "--at", "temperature=3 mm"), "--at temperature (T) must be in degC"),
        (("--to", "urdf", "--at", "temp=3"), "unknown contact input of"),
        (("--to", "fmu", "--at", "temperature=3"), "--to fmu does not take --at"),
    ],
)
def test_values_of_inputs_that_do_not_fit_are_refused(called, tmp_path, options, words):
    (tmp_path / "warm.toml").write_text(WARM, encoding="utf-8")
    code, _, err = called("warm.toml", *options)
    assert code == 2
    assert words in err


def test_a_file_with_laws_alone_is_exported(called, tmp_path):
    text = LAW[LAW.index("[friction.stribeck]") : LAW.index("[run]")]
    (tmp_path / "alone.toml").write_text(text, encoding="utf-8")
    assert called("alone.toml", "--to", "c", "-o", "code")[0] == 0
    assert "0.35" in (tmp_path / "code" / "stribeck.c").read_text(encoding="utf-8")
    code, _, err = called("alone.toml", "--to", "mjcf", "-o", "model")
    assert code == 2
    assert 'give it, as --load "50 N"' in err
    code, _, err = called("alone.toml", "--to", "c", "--law", "strybeck", "-o", "other")
    assert (code, "Did you mean 'stribeck'?" in err) == (2, True)
    # what says how well a law is known says it of a mechanism
    known = LAW[LAW.index("[friction.stribeck]") :]
    (tmp_path / "known.toml").write_text(known, encoding="utf-8")
    code, _, err = called("known.toml", "--to", "c", "-o", "third")
    assert code == 2
    assert "mechanism is missing" in err
