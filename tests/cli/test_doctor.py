"""``stickslip doctor``: what it finds, and that it goes on where something is broken."""

import json
from importlib.metadata import requires, version
from pathlib import Path

import pytest
from tests.commands import commands

import stickslip.cli.warmup as command
from stickslip.cli import NO_CONVERGENCE
from stickslip.errors import SimulationError

SUBJECTS = ("versions", "system", "extras", "cache", "threads", "compiler", "data", "self-test")


@pytest.fixture
def called(capsys, monkeypatch, tmp_path):
    """Run the command; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    return commands(capsys, "doctor", one_line=True)


def facts(called):
    code, out, err = called("--json")
    assert code == 0, err
    return json.loads(out)


def test_what_it_says_can_be_pasted(called, monkeypatch, tmp_path):
    monkeypatch.setenv("STICKSLIP_DATA", str(tmp_path / "records"))
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    code, out, err = called()
    assert (code, err) == (0, "")
    assert tuple(line.split()[0] for line in out.splitlines()) == SUBJECTS
    assert f"stickslip {version('stickslip')}" in out
    assert f"numpy {version('numpy')}" in out
    assert "STICKSLIP_DATA ~/records;" in out  # without the name of the user
    monkeypatch.setenv("STICKSLIP_DATA", f"/mnt{tmp_path}/records")
    assert f"STICKSLIP_DATA /mnt{tmp_path}/records;" in called()[1]


def test_both_tiers_agree_with_closed_forms(called):
    for fact in facts(called)["self-test"].values():
        assert max(fact["travel"], fact["time of leaving"]) < 1e-14


def test_each_extra_for_users_is_present_or_absent(called, monkeypatch):
    there = facts(called)["extras"]
    declared = {
        line.split("extra ==")[1].strip(" \"'")
        for line in requires("stickslip")
        if "extra ==" in line
    }
    assert {*there["present"], *there["absent"]} == declared - command.FOR_CONTRIBUTORS
    before = command._version_of
    monkeypatch.setattr(command, "_version_of", lambda name: before(name) * (name != "openpyxl"))
    assert "xlsx" in facts(called)["extras"]["absent"]


def test_what_is_set_wrongly_is_said_and_the_rest_is_looked_at(called, monkeypatch, tmp_path):
    monkeypatch.setenv("STICKSLIP_THREADS", "many")
    (tmp_path / "file").touch()
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "file"))
    found = facts(called)
    assert "must be a number of threads" in found["threads"]["error"]
    assert "cannot be written to" in found["cache"]["error"]
    assert found["compiler"]
    assert found["self-test"]["plain Python"]["travel"] < 1e-14


def test_a_wrong_result_ends_it_with_an_error(called, monkeypatch):
    monkeypatch.setattr(command, "CLOSE", 0.0)
    code, out, err = called()
    assert code == NO_CONVERGENCE
    assert "the self-test failed in plain Python and machine code" in err
    assert "where 0 is allowed" in out


def test_an_error_of_a_tier_names_the_tier(called, monkeypatch):
    def fails(*_, solver, **__):
        if solver.tier == "compiled":
            raise SimulationError("it cannot be loaded.")
        return before(*_, solver=solver, **__)

    before = command.simulate
    monkeypatch.setattr(command, "simulate", fails)
    code, out, err = called()
    assert code == NO_CONVERGENCE
    assert "failed in machine code" in err
    assert "machine code error it cannot be loaded." in out
