"""``stickslip fit`` and ``select`` on the force of a spring that pulls a block."""

import json

import numpy as np
import pytest
from tests.commands import commands

from stickslip import Coulomb, TowedBlock, load_rig, simulate

RIG = """
title = "Slider"
subject = "made up"
[mechanism]
type = "towed-block"
mass = { value = "30 g", vary = true }
stiffness = "1000 N/m"
speed = "4 mm/s"
load = "0.3 N"
[data]
file = "pull.csv"
columns = { time = "t", spring_force = "F" }
"""


@pytest.fixture(scope="module")
def table():
    t = np.arange(0.5, 4.5, 5e-4)
    block = TowedBlock(mass=0.021, stiffness=1000.0, speed=4e-3, load=0.3)
    run = simulate(block, Coulomb(kinetic_coefficient=0.28, static_coefficient=0.32), t_end=4.5)
    noise = np.random.default_rng(0).normal(0.0, 5e-4, len(t))
    return np.column_stack([t, 1000.0 * (4e-3 * t - run.at(t)["x"]) + noise])


@pytest.fixture
def run(capsys, monkeypatch, tmp_path, table):
    """Run a command beside a rig with a record; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    np.savetxt(tmp_path / "pull.csv", table, delimiter=",", header="t,F", comments="")
    (tmp_path / "slider.toml").write_text(RIG)
    held = RIG.replace('{ value = "30 g", vary = true }', '"60 g"')
    (tmp_path / "held.toml").write_text(held)
    return commands(capsys, one_line=True)


@pytest.mark.slow
def test_fit_finds_the_mass_and_writes_a_rig_that_simulate_takes(run):
    code, out, _ = run("fit", "slider.toml", "--law", "coulomb", "-o", "fitted.toml")
    assert code == 0
    assert "mechanism.mass" in out
    assert "standard deviation" in out
    # stiffness is known to 10 %, and of both the frequency tells the ratio
    assert load_rig("fitted.toml").mechanism.mass == pytest.approx(0.021, rel=0.2)
    code, out, _ = run("simulate", "fitted.toml", "--t-end", "0.5")
    assert code == 0
    assert "break-away" in out


@pytest.mark.slow
def test_select_writes_a_page_a_verdict_and_the_law(run, tmp_path):
    code, out, _ = run("select", "slider.toml", "--laws", "coulomb,stribeck")
    assert code == 0
    assert "cannot rule out" in out
    assert max(len(line) for line in out.splitlines() if line.startswith("Coulomb")) <= 80
    report = tmp_path / "slider-report"
    content = json.loads((report / "verdict.json").read_text(encoding="utf-8"))
    assert content["best"] in ("coulomb", "stribeck")
    assert content["schema"].startswith("stickslip/select/")
    assert "limit cycle" in (report / "index.html").read_text(encoding="utf-8")
    assert load_rig(report / "law.toml").mechanism.mass == pytest.approx(0.021, rel=0.2)


def test_options_for_records_of_motion_are_refused(run):
    for option in (("--hold", "first"), ("--starts", "2")):
        code, _, err = run("fit", "slider.toml", *option)
        assert code == 2
        assert err.startswith(f"stickslip: {option[0]} applies to ")
