"""``stickslip optimise``: files, exit codes, units of ranges and limits."""

import json
from pathlib import Path

import pytest
from tests.commands import commands

from stickslip import load_rig
from stickslip.cli import main

RIG = Path(__file__).parents[2] / "docs" / "howto" / "files" / "pushed-capsule.toml"
VARY = ("--vary", "duty=0.1..0.9", "--vary", "upper_soft_stop.place=0.1mm..3mm")
QUICK = ("--evaluations", "12")


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run the command in an empty folder; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    return commands(capsys, "optimise", str(RIG))


def test_writes_a_rig_that_simulates_a_figure_and_the_numbers(run, capsys):
    code, out, _ = run(*VARY, *QUICK, "--limit", "xi=10mm", "-o", "best")
    assert code == 0
    assert "mean speed, m/s" in out
    numbers = json.loads(Path("best/optimum.json").read_text())
    assert numbers["schema"] == "stickslip/optimum/1"
    assert numbers["limits"] == {"xi": 0.01}
    assert Path("best/optimum.svg").read_text().startswith("<")
    rig = load_rig("best/rig.toml")
    (best,) = numbers["motions"]
    assert rig.mechanism.drive.drive.duty == best["parameters"]["mechanism.drive.drive.duty"]
    with pytest.raises(SystemExit) as leaving:
        main(["simulate", "best/rig.toml", "--json"])
    assert not leaving.value.code
    assert json.loads(capsys.readouterr().out)["status"] == "END_TIME"
    Path("best/notes.txt").write_text("mine", encoding="utf-8")
    code, _, err = run(*VARY, *QUICK, "-o", "best")
    assert code == 2
    assert "--force" in err


def test_two_goals_list_the_front(run):
    pytest.importorskip("pymoo")
    code, out, _ = run(*VARY, *QUICK, "--goal", "speed", "--goal", "energy")
    assert code == 0
    assert "energy per travel, J/m" in out
    assert "as given" in out


def test_an_interval_takes_paths_and_two_ends(run):
    given = "friction.kinetic_coefficient=0.19..0.21"
    code, out, _ = run(*VARY, "--evaluations", "1", "--interval", given, "--json")
    assert code == 0
    assert json.loads(out)["scenarios"] == "the 5 % quantile of 5 scenarios"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--vary", "duty=0.1"), "PATH=LOW..HIGH"),
        (("--vary", "upper_soft_stop.place=1s..2s"), "must be in m"),
        ((*VARY, "--goal", "sped"), "Did you mean 'speed'"),
        ((*VARY, "--limit", "xi"), "NAME=VALUE"),
        ((*VARY, "--limit", "xy=1mm"), "unknown limit"),
        ((*VARY, "--limit", "xi=1s"), "--limit xi"),
        ((*VARY, "--interval", "kinetic_coefficient=0.2"), "PATH=LOW..HIGH"),
    ],
)
def test_bad_input_is_one_message(run, arguments, message):
    code, out, err = run(*arguments)
    assert code == 2
    assert out == ""
    assert message in " ".join(err.split())
    assert "Traceback" not in err


def test_limits_that_no_motion_keeps_exit_with_three(run):
    code, _, err = run(*VARY, *QUICK, "--limit", "peak_force=1mN")
    assert code == 3
    assert "widen limits" in err
    assert list(Path().iterdir()) == []
