"""``stickslip profile optimise``: files, exit codes, units of limits."""

import json
from pathlib import Path

import pytest
from tests.commands import commands

from stickslip import load_rig
from stickslip.cli import main

RIG = Path(__file__).parents[2] / "docs" / "howto" / "files" / "pendulum-cart.toml"
LIMITS = (
    "--angle", "60 deg", "--rate", "12 rad/s", "--torque", "1.5 N m",
    "--load-share", "10 %", "--back-slip", "1 mm",
)  # fmt: skip
"""The motion of the rig keeps them, so that searches however short have a result everywhere."""
QUICK = ("--kind", "three-phase", "--evaluations", "30")


@pytest.fixture(autouse=True)
def polishes_are_short(monkeypatch):
    """Let a polish try some ten motions: how far it gets is asserted in `tests/optimisation`."""
    monkeypatch.setattr("stickslip.study.optimisation.optimise.LEAST_ROUNDS", 1)
    monkeypatch.setattr("stickslip.study.optimisation.optimise.POLISH", 1)


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run the command in an empty folder; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    return commands(capsys, "profile", "optimise", str(RIG))


def test_writes_a_rig_that_simulates_a_figure_and_the_numbers(run, capsys):
    code, out, _ = run(*LIMITS, *QUICK, "-o", "best", "--resume", "state.json")
    assert code == 0
    assert "Best three-phase motion" in out
    numbers = json.loads(Path("best/optimum.json").read_text())
    assert numbers["schema"] == "stickslip/profile/1"
    assert numbers["limits"]["back_slip"] == 1e-3
    assert all(margin["margin"] >= 0.0 for margin in numbers["margins"])
    assert Path("best/profile.svg").read_text().startswith("<")
    assert Path("state.json").exists()
    rig = load_rig("best/rig.toml")
    assert rig.mechanism.pendulum.profile.amplitude == numbers["profile"]["amplitude"]
    with pytest.raises(SystemExit) as leaving:
        main(["simulate", "best/rig.toml", "--json"])
    assert not leaving.value.code
    assert json.loads(capsys.readouterr().out)["status"] == "END_TIME"


def test_json_is_one_document_and_nothing_is_written(run):
    code, out, _ = run(*LIMITS, *QUICK, "--json")
    assert code == 0
    assert json.loads(out)["factor"] == 1.0
    assert list(Path().iterdir()) == []


def test_a_folder_that_is_given_is_written_beside_the_document(run):
    code, out, _ = run(*LIMITS, *QUICK, "--json", "-o", "best")
    assert code == 0
    assert json.loads(Path("best/optimum.json").read_text()) == json.loads(out)
    code, out, err = run(*LIMITS, *QUICK, "--json", "-o", "best")
    assert (code, out) == (2, "")
    assert "best already exists" in err


CAPSULE = """
[mechanism]
type = "capsule"
capsule_mass = 0.8
inner_mass = 0.2
drive = {type = "prescribed", profile = {type = "three-phase", amplitude = 0.01, fast = 50.0, slow = 9.81, first = "slow"}}
[friction.coulomb]
kinetic_coefficient = 0.2
"""  # noqa: E501  # TOML has a table in a line


@pytest.fixture
def run_capsule(capsys, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    Path("capsule.toml").write_text(CAPSULE)
    return commands(capsys, "profile", "optimise", "capsule.toml")


def test_the_stroke_of_an_inner_mass_is_from_end_to_end(run_capsule):
    code, out, _ = run_capsule("--stroke", "20 mm", "--rate", "0.5 m/s", *QUICK, "--json")
    assert code == 0
    found = json.loads(out)
    assert found["limits"]["position"] == 0.01
    assert found["profile"]["amplitude"] <= 0.01


@pytest.mark.parametrize(
    "given", [("--angle", "10 mm"), (), ("--stroke", "2 mm", "--angle", "1 mm")]
)
def test_a_way_along_a_line_is_given_as_a_stroke(run_capsule, given):
    code, _, err = run_capsule(*given, "--rate", "0.5 m/s")
    assert code == 2
    assert "give --stroke: the inner body of this rig moves along a line" in " ".join(err.split())


def test_kinds_are_called_as_in_rig_files_too(run):
    ask = (*LIMITS, "--evaluations", "1", "--json")
    documents = [json.loads(run(*ask, "--kind", kind)[1]) for kind in ("sine", "sine-swing")]
    assert documents[0] == documents[1]
    assert documents[0]["kind"] == "sine"


@pytest.mark.slow
def test_an_interval_takes_paths_and_two_ends(run):
    given = "friction.kinetic_coefficient=0.19..0.21"
    code, out, _ = run(*LIMITS, *QUICK, "--interval", given, "--json")
    assert code == 0
    assert "the worst of 5 evenly spaced points" in json.loads(out)["scenarios"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--angle", "60 mm", "--rate", "12 rad/s"), "--angle (q_max)"),
        (("--stroke", "60 mm", "--rate", "12 rad/s"), "give --angle: the inner body of this rig t"),
        (("--angle", "60 deg", "--rate", "12"), "has no unit"),
        ((*LIMITS, "--goal", "travl"), "Did you mean 'travel'"),
        ((*LIMITS, "--interval", "kinetic_coefficient=0.2"), "PATH=LOW..HIGH"),
        ((*LIMITS, "--set", "mechanism.pendulum.type=torque"), "mechanism"),
    ],
)
def test_bad_input_is_one_message(run, arguments, message):
    code, out, err = run(*arguments)
    assert code == 2
    assert out == ""
    assert message in " ".join(err.split())
    assert "Traceback" not in err


def test_limits_that_no_motion_keeps_exit_with_three(run):
    code, _, err = run("--angle", "60 deg", "--rate", "12 rad/s", "--torque", "10 mN m", *QUICK)
    assert code == 3
    assert "widen the limits" in err
    assert list(Path().iterdir()) == []


def test_a_folder_that_is_there_is_kept_without_force(run):
    Path("best").mkdir()
    code, _, err = run(*LIMITS, *QUICK, "-o", "best")
    assert code == 2
    assert "--force" in err
