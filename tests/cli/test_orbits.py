"""`stickslip orbits`: branches, table, figure; one message for bad input."""

import re
from pathlib import Path

import pandas as pd
import pytest
from tests.commands import commands

ROOT = Path(__file__).parents[2]
RIG = """
[mechanism]
type = "axis"
inertia = "1 kg"
stiffness = "100 N/m"
drive = {type = "sine", amplitude = "4 N", frequency = "2 Hz"}

[friction.coulomb]
kinetic_coefficient = 0.5
"""
QUICK = ("--values", "3", "--settle", "40", "--period", "2")


@pytest.fixture
def called(tmp_path, monkeypatch, capsys):
    """Run a command where a rig lies; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "axis.toml").write_text(RIG)
    return commands(capsys, "orbits", one_line=True)


def test_orbits_writes_a_table_and_a_figure_and_says_what_it_cost(called, tmp_path):
    code, shown, _ = called(
        "axis.toml", "--vary", "drive.frequency=1.9:2.4", *QUICK, "-o", "orbits.csv"
    )
    assert code == 0
    assert "1.9 to 2.4 Hz" in " ".join(shown.split())
    assert "settled runs" in shown
    table = pd.read_csv(tmp_path / "orbits.csv")
    assert table["stable"].all()
    assert table["mechanism.drive.frequency [Hz]"].min() == 1.9
    svg = (tmp_path / "orbits.svg").read_text()
    assert "period 1" in svg
    assert "frequency, Hz" in svg


def test_orbits_are_summed_up_by_where_they_are_stable_and_how_fast_they_go(called, tmp_path):
    capsule = (ROOT / "docs/howto/files/capsule.toml").read_text()
    (tmp_path / "capsule.toml").write_text(capsule)
    code, shown, _ = called(
        *("capsule.toml", "--vary", "drive.frequency=15.8:16.6", "--values", "3"),
        *("--settle", "150", "--period", "1", "-o", "orbits.csv"),
    )
    assert code == 0
    first, _, *stretches = re.sub(r"^.*friction\n", "", shown).splitlines()
    # from rest into the motion that goes on, from 14.2 Hz, and at rest beside it, up to 16.68 Hz
    assert first.startswith("Stable orbits are known over 100 % of the range, several side by side")
    assert any("0 m/s" in row for row in stretches)
    table = pd.read_csv(tmp_path / "orbits.csv")
    ways = table["mean velocity x [m/s]"]
    assert ways.to_numpy() == pytest.approx(table["advance x [m]"] / table["period [s]"])
    assert ways[table["stable"]].max() == pytest.approx(0.0304, abs=2e-4)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("axis.toml", "--vary", "drive.frequency=3:2"), "lower value first"),
        (("axis.toml", "--vary", "drive.frequency=3"), "PATH=LOW:HIGH, the lower"),
        (("axis.toml", "--vary", "drive.frequency=[3]"), "PATH=[VALUE, ...], two or more"),
        (("axis.toml", "--vary", "frequenzy=2:3"), "frequency"),
        (("axis.toml", "--vary", "drive.frequency=0:3"), "above 0 Hz, got 0"),
        (("axis.toml", "--vary", "initial.x=0:1"), "not a parameter"),
        (("axis.toml", "--vary", "drive.frequency=2:3", "--period", "0"), "cycles must be"),
        (("axis.toml", "--vary", "drive.frequency=2:3", "--values", "1"), "values must be"),
        (("axis.toml", "--vary", "drive.frequency=2:3", "-o", "x.txt"), ".parquet or .mat"),
    ],
)
def test_bad_input_gets_one_message_and_code_2(called, arguments, message):
    code, shown, told = called(*arguments)
    assert code == 2
    assert not shown
    assert message in told
    assert told.count("stickslip:") == 1


def test_two_ranges_make_a_chart_of_curves(called, tmp_path):
    ranges = ("--vary", "kinetic_coefficient=0.5:3.5", "--vary", "drive.frequency=1.9:2.4")
    quick = ("--values", "4", "--settle", "40", "--period", "1", "-o", "chart.csv")
    code, shown, _ = called("axis.toml", *ranges, *quick)
    assert code == 0
    assert "of 16 cells" in " ".join(shown.split())
    table = pd.read_csv(tmp_path / "chart.csv")
    assert set(table["event"]) <= {"fold", "period doubling", "grazing", "sticking"}
    assert (table["event"] == "sticking").any()
    assert "numbers: stable motions" in (tmp_path / "chart.svg").read_text()
    code, _, error = called("axis.toml", *ranges, "--vary", "stiffness=90:110")
    assert code != 0
    assert "--vary is given once or twice, got 3" in error
