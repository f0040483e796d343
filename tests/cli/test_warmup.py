"""The command that compiles ahead of time."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.commands import commands

import stickslip.cli.warmup as command
from stickslip.engine.solver import WarmUp
from stickslip.errors import CompilationError

RIG = """
[mechanism]
type = "axis"
inertia = 1.0
[friction]
kinetic_coefficient = 0.25
"""


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run a command in an empty folder; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    return commands(capsys, one_line=True)


@pytest.fixture
def asked(monkeypatch):
    """Compile nothing; return what was asked for."""
    seen = {}

    def remembered(pairs, *, progress):
        progress(0, 2, "a pair")
        progress(2, 2, "a pair")
        seen.update(pairs=pairs)
        return WarmUp(
            kernels_compiled=True, equations_compiled=3, equations_found=4,
            seconds=31.25, folder=Path("/cache"),
        )  # fmt: skip

    monkeypatch.setattr(command, "warm_up", remembered)
    return seen


@pytest.mark.slow
def test_one_mechanism_with_two_laws_is_compiled_once(tmp_path):
    def told():
        """What a process of its own says: this one may have compiled the kernels already."""
        task = ("warmup", "--mechanism", "towed-block", "--laws", "coulomb,viscous", "--json")
        own = {**os.environ, "STICKSLIP_CACHE": str(tmp_path / "cache")}
        command = [sys.executable, "-m", "stickslip", *task]
        return json.loads(
            subprocess.run(command, env=own, stdout=subprocess.PIPE, check=True).stdout
        )

    content = told()
    assert content["schema"] == "stickslip/warmup/1"
    assert [pair["law"] for pair in content["pairs"]] == ["coulomb", "viscous"]
    assert content["kernels"] == {"compiled": True}
    assert content["equations"] == {"compiled": 2, "found": 0}
    assert content["cache"] == str(tmp_path / "cache")
    content = told()
    assert content["kernels"] == {"compiled": False}
    assert content["equations"] == {"compiled": 0, "found": 2}


def test_the_result_is_one_line(run, asked):
    code, out, _ = run("warmup")
    assert code == 0
    assert out == (
        "Kernels: compiled. Equations: 3 compiled, 4 in the cache. Time: 31.2 s. Cache: /cache\n"
    )


@pytest.mark.parametrize(
    ("table", "name"),
    [
        ("[friction.power-viscous]\nviscous_coefficient = 0.5", "power-viscous"),
        ("[friction.quadratic-drag]\nquadratic_coefficient = 0.5", "quadratic-drag"),
        ("quadratic_coefficient = 0.5", "quadratic-drag"),
    ],
)
def test_a_law_on_request_is_brought_by_its_table_or_by_what_only_it_has(
    run, asked, tmp_path, table, name
):
    (tmp_path / "rig.toml").write_text(f"{RIG}{table}\n")
    run("warmup", "--rig", "rig.toml")
    assert {law.name for _, law in asked["pairs"]} == {"coulomb", name}


def test_a_rig_file_brings_its_mechanism_and_its_laws(run, asked, tmp_path):
    (tmp_path / "rig.toml").write_text(RIG)
    run("warmup", "--rig", "rig.toml")
    assert {(rig.name, law.name) for rig, law in asked["pairs"]} == {("axis", "coulomb")}
    run("warmup", "--rig", "rig.toml", "--laws", "lugre")
    assert {(rig.name, law.name) for rig, law in asked["pairs"]} == {("axis", "lugre")}


BAD = [
    (["--rig", "rig.toml", "--mechanism", "axis"], "not both"),
    (["--rig", "nowhere.toml"], "nowhere.toml"),
    (["--mechanism", "axes"], "Did you mean 'axis'"),
    (["--mechanism", "serial-arm"], "serial-arm is made of parts"),
    (["--laws", "coulom"], "Did you mean 'coulomb'"),
    (["--laws", ""], "unknown friction law"),
]


@pytest.mark.parametrize(("arguments", "fragment"), BAD, ids=lambda value: str(value)[:50])
def test_bad_input_gives_one_message(run, arguments, fragment):
    code, out, err = run("warmup", *arguments)
    assert (code, out) == (2, "")
    assert fragment in err


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [(CompilationError("too large"), 3, "too large"), (KeyboardInterrupt(), 130, "Canc")],
)
def test_a_failure_and_an_interrupt_have_their_exit_codes(run, monkeypatch, error, code, words):
    def failing(*_arguments, **_settings):
        raise error

    monkeypatch.setattr(command, "warm_up", failing)
    left, out, err = run("warmup")
    assert (left, out) == (code, "")
    assert words in err


def test_a_cache_that_cannot_be_written_to_is_refused(run, monkeypatch, tmp_path):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("STICKSLIP_CACHE", str(tmp_path / "file" / "cache"))
    code, out, err = run("warmup", "--laws", "coulomb")
    assert (code, out) == (2, "")
    assert "would be lost" in err
