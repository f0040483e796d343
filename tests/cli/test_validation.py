"""``simulate`` beside what was measured, with uncertainties of rigs and of single coefficients."""

import json
from pathlib import Path

import numpy as np
import pytest
from tests.cli.test_law_files import CART, KNOWN, LAW, write
from tests.commands import commands

from stickslip import Coulomb, Pendulum, SpringBlock, load_rig, simulate


@pytest.fixture
def walk(tmp_path, monkeypatch, capsys):
    """Run commands in a folder of their own; return exit code, stdout, stderr on one line."""
    monkeypatch.chdir(tmp_path)
    return commands(capsys, one_line=True)


@pytest.fixture
def cart(walk, tmp_path):
    """A rig with a record of a cart, and a law for it; returns the path of the rig."""

    def make(kinetic=0.2):
        text = CART.read_text(encoding="utf-8").split("[friction")[0]
        mechanism = load_rig(CART).mechanism
        t = np.arange(0.0, 2.9, 0.01)
        run = simulate(mechanism, Coulomb(kinetic_coefficient=kinetic), t_end=3.0)
        x = run.at(t)["x"] + 3e-4 * np.random.default_rng(1).normal(size=t.size)
        np.savetxt(
            "cart.csv",
            np.column_stack([t, 1e3 * x]),
            delimiter=",",
            header="time [s],position [mm]",
            comments="",
        )
        path = tmp_path / "cart.toml"
        path.write_text(f"{text}\n[data]\nfile = 'cart.csv'\n[run]\nt_end = 2.9\n")
        write("law.toml", SpringBlock(mass=1.0), LAW, KNOWN)
        return path

    return make


@pytest.mark.slow
def test_a_carried_law_is_compared_with_the_record_and_refitted(walk, cart):
    rig = cart(0.2)
    code, out, _ = walk("simulate", rig, "--law", "law.toml", "--refit", "--ensemble", 50)
    assert code == 0
    assert "The record agrees with the prediction" in out
    assert "Residual of the position (measured less predicted): root mean square" in out
    assert "mu_k: carried 0.200 (0.190 to 0.210), refitted 0.200" in out
    assert ": agree (difference" in out


@pytest.mark.slow
def test_a_travel_per_cycle_was_measured(walk, cart):
    rig = cart()
    trial = '[[trial]]\ntravel_per_cycle = "56 mm"\nuncertainty = "1 mm"\n'
    mechanism = rig.read_text().partition("[data]")[0]
    rig.write_text(f"{mechanism}\n{trial}[run]\nt_end = '3.62 s'\n")
    code, out, _ = walk("simulate", rig, "--law", "law.toml", "--report-to", "page")
    assert code == 0
    assert "travel per cycle" in out
    page = Path("page/index.html").read_text(encoding="utf-8")
    assert "no travel of this rig was measured" not in page
    assert "% of the measured travel per cycle" in page


def test_uncertain_masses_count_in_the_ensemble(walk):
    asked = ("simulate", "demo", "--law", "coulomb", "--ensemble", 200, "--json")
    code, out, _ = walk(*asked, "--set", "mass=1 +- 0.02 kg")
    band = json.loads(out)["band"]
    assert code == 0
    assert list(band["parameters"]) == ["mechanism.mass"]
    travel = band["travel"]
    # the travel goes with 1 / m; quantiles of 200 draws are known to 12 %
    half = 0.5 * (travel["high"] - travel["low"]) / travel["median"]
    assert half == pytest.approx(1.96 * 0.02, rel=0.35)


@pytest.mark.parametrize(
    "value", ["0.25 +- 0.01", "0.25 +/- 4 %", "0.25 ± 0.01", "{value = 0.25, uncertainty = 0.01}"]
)
def test_a_coefficient_is_set_with_its_uncertainty(walk, value):
    write("law.toml", SpringBlock(mass=1.0), LAW, KNOWN)
    law = ("--law", "law.toml", "--set", f"friction.kinetic_coefficient={value}")
    code, out, _ = walk("simulate", "demo", *law, "--ensemble", 200, "--json")
    drawn = json.loads(out)["band"]["parameters"]["friction.kinetic_coefficient"]
    assert code == 0
    assert drawn["median"] == pytest.approx(0.25, abs=0.005)
    assert 0.5 * (drawn["high"] - drawn["low"]) == pytest.approx(0.0196, rel=0.35)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--ensemble", "20"], "neither this law nor the mechanism has any"),
        (["--set", "mass=1 +- 0.02 s"], "must be in kg"),
        (["--set", "mass=1 +- 2"], "below 0.5 kg, half of the value"),
        (
            ["--set", "kinetic_coefficient={value=0.2, uncertainty=0.01, assumed=true}"],
            "fits hold an assumed value",
        ),
        (["--refit", "--fixed-step", "0.01"], "--refit requires exact events"),
    ],
)
def test_what_cannot_be_drawn_or_refitted_is_one_message(walk, arguments, said):
    code, _, err = walk("simulate", "demo", "--law", "coulomb", *arguments)
    assert code == 2
    assert said in err
    assert "Traceback" not in err


def test_a_refit_needs_a_measurement(walk):
    code, _, err = walk("simulate", CART, "--law", "coulomb", "--refit")
    assert code == 2
    assert "nothing was measured: leave it out" in err


def test_a_free_decay_is_predicted_from_its_initial_state_and_refitted(walk):
    t = np.arange(0.0, 8.0, 0.02)
    clock = Pendulum(mass=0.2, length=0.5)
    run = simulate(clock, Coulomb(kinetic_coefficient=0.01), t_end=8.0, y0={"theta": 0.5})
    angle = run.at(t)["theta"] + 1e-3 * np.random.default_rng(1).normal(size=t.size)
    rows = "\n".join(f"{a},{b}" for a, b in zip(t.tolist(), angle.tolist(), strict=True))
    Path("decay.csv").write_text(f"time [s],position [rad]\n{rows}\n")
    Path("decay.toml").write_text(
        """
[mechanism]
type = "pendulum"
mass = 0.2
length = 0.5
[friction.coulomb]
kinetic_coefficient = "0.01 +- 0.0003"
[run]
t_end = 8
[[trial]]
file = "decay.csv"
initial = { theta = "0.5 rad" }
"""
    )
    code, out, _ = walk("simulate", "decay.toml", "--refit", "--ensemble", 50)
    assert code == 0
    assert "The record agrees with the prediction" in out
    assert ": agree (difference" in out
