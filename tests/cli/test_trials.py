"""``stickslip select`` says by how much several trials differ."""

import re

import numpy as np
import pytest
from typer.testing import CliRunner

from stickslip.cli.app import app

RIG = """
[mechanism]
type = "axis"
inertia = 1
[data]
files = ["run1.csv", "run2.csv", "run3.csv"]
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Write three trials whose level rises with the temperature."""
    draw, v = np.random.default_rng(0), 0.3 * np.sin(0.07 * np.arange(400))
    for number, temperature in enumerate((20, 40, 60), 1):
        friction = (5.0 + 0.02 * temperature) * np.sign(v) + 4.0 * v + 0.1 * draw.normal(size=400)
        rows = np.column_stack([0.01 * np.arange(400), v, friction, np.full(400, temperature)])
        np.savetxt(
            tmp_path / f"run{number}.csv",
            rows,
            delimiter=",",
            header="time,velocity,friction,temperature [degC]",
            comments="",
        )
    (tmp_path / "rig.toml").write_text(RIG)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def run(*arguments):
    result = CliRunner().invoke(app, list(arguments), terminal_width=200)
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.mark.slow
def test_select_says_by_how_much_trials_differ_with_the_temperature(folder):
    said = run("select", "rig.toml", "--laws", "coulomb-viscous")
    assert re.search(r"Friction rises by 1\d % where the temperature goes from 2\d", said)
    assert "is not used" not in said


def test_one_record_says_nothing_of_trials(folder):
    said = run("fit", "rig.toml", "--data", "run1.csv", "--law", "coulomb-viscous")
    assert "Trials" not in said
