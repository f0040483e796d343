"""`stickslip animate` and `stickslip sweep`: files, exit codes, one message for bad input."""

import json

import pandas as pd
import pytest
from PIL import Image
from tests.commands import commands

RIG = """
title = "Driven axis"
subject = "the driven axis"

[mechanism]
type = "axis"
inertia = "2 kg"
drive = { type = "sine", amplitude = "30 N", frequency = "2 Hz" }

[friction.coulomb]
kinetic_coefficient = 4.0

[run]
t_end = "1 s"
"""
SMALL = ("--fps", "5", "--size", "440x320")


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run a command in a folder with a rig file; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rig.toml").write_text(RIG)
    return commands(capsys)


def test_animate_writes_the_frames_it_tells_of(run, tmp_path):
    code, out, _ = run("animate", "rig.toml", "-o", "new/axis.gif", "--json", *SMALL)
    assert code == 0
    told = json.loads(out)
    assert told["schema"] == "stickslip/animate/1"
    with Image.open(tmp_path / "new/axis.gif") as gif:
        assert gif.n_frames == told["frames"] == 6


def test_animate_replaces_a_file_only_with_force(run, tmp_path):
    (tmp_path / "axis.gif").write_text("mine")
    code, _, err = run("animate", "rig.toml", "-o", "axis.gif", *SMALL)
    assert code == 2
    assert "--force" in err
    assert (tmp_path / "axis.gif").read_text() == "mine"
    code, out, _ = run("animate", "rig.toml", "-o", "axis.gif", "--force", *SMALL)
    assert code == 0
    assert "axis.gif, 6 frames" in out


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("-o", "axis.avi"), "one of .gif, .mp4"),
        (("--size", "wide"), "WIDTHxHEIGHT"),
        (("--law", "coulom"), "Did you mean"),
        (("--set", "mechanism.mass=1"), "mass"),
    ],
)
def test_animate_refuses_bad_input_and_writes_nothing(arguments, words, run, tmp_path):
    code, out, err = run("animate", "rig.toml", *arguments)
    assert (code, out) == (2, "")
    assert words in " ".join(err.split())
    assert [path.name for path in tmp_path.iterdir()] == ["rig.toml"]


SWEEP = ("sweep", "rig.toml", "--settle", "2", "--cycles", "2")


def test_sweep_writes_a_row_for_each_point_and_a_figure(run, tmp_path):
    vary = ("--vary", "mechanism.drive.frequency=1:2:3", "--vary", "amplitude=20:30:2")
    code, out, _ = run(*SWEEP, *vary, "-o", "found.csv")
    assert code == 0
    assert "mean velocity" in out
    table = pd.read_csv(tmp_path / "found.csv")
    assert table["mechanism.drive.frequency [Hz]"].tolist() == [1.0, 1.0, 1.5, 1.5, 2.0, 2.0]
    assert (tmp_path / "found.svg").read_text().startswith("<svg")
    code, _, err = run(*SWEEP, *vary, "-o", "found.csv")
    assert code == 2
    assert "--force" in err


@pytest.mark.parametrize(
    "arguments",
    [(), ("--vary", "frequency"), ("--vary", "frequency=1:2"), ("--vary", "frequency=1:2:0")],
)
def test_sweep_refuses_what_is_no_grid(arguments, run):
    code, out, err = run(*SWEEP, *arguments)
    assert (code, out) == (2, "")
    assert "--vary" in err
