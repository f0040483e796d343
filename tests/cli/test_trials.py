"""``stickslip fit`` and ``select`` say whether several trials share one law."""

import json
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
def test_fit_says_that_the_trials_do_not_share_one_law_and_which_column_is_not_used(folder):
    said = run("fit", "rig.toml", "--law", "coulomb-viscous")
    assert "The trials do not share one law (p < 0.001)" in said
    assert "Column 'temperature' is not used but differs between the trials" in said


@pytest.mark.slow
def test_fit_names_the_condition_that_explains_it(folder):
    (folder / "rig.toml").write_text(RIG + 'conditions = ["temperature"]\n')
    said = run("fit", "rig.toml", "--law", "coulomb-viscous")
    assert re.search(r"F_c rises from 5\.4\S* N at 20 °C to 6\.[12]\S* N at 60 °C", said)
    found = json.loads(run("fit", "rig.toml", "--law", "coulomb-viscous", "--json"))["trials"]
    assert [entry["conditions"] for entry in found["trials"]] == [
        {"temperature [degC]": value} for value in (20.0, 40.0, 60.0)
    ]


def test_one_record_says_nothing_of_trials(folder):
    said = run("fit", "rig.toml", "--data", "run1.csv", "--law", "coulomb-viscous")
    assert "Trials" not in said
