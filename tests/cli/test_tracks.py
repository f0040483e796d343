"""``stickslip check`` and ``stickslip fit`` on what a video gave."""

import json

import numpy as np
import pytest
from tests.commands import commands

MU = 0.21
SPEED = 1.4
TIME = np.arange(72) / 60


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run a command beside a coasting block that was filmed at 3 degrees, and its rig."""
    monkeypatch.chdir(tmp_path)
    slowing = MU * 9.81
    time = np.minimum(TIME, SPEED / slowing)
    way = SPEED * time - slowing * time**2 / 2
    noise = np.random.default_rng(1).normal(0.0, 3e-4, (2, way.size))
    tilt = np.radians(3.0)
    x, y = np.array([[np.cos(tilt)], [np.sin(tilt)]]) * way + noise
    rows = ["\t".join(f"{cell:.6E}" for cell in row) for row in zip(TIME, x, y, strict=True)]
    (tmp_path / "track.txt").write_text("\n".join(["mass_A", "t\tx\ty", *rows, ""]))
    twice = "\n".join(f"{row}\t{row.split(chr(9), 1)[1]}" for row in rows)
    (tmp_path / "two.txt").write_text("\tmass A\t\tmass B\nt\tx\ty\tx\ty\n" + twice)
    (tmp_path / "block.toml").write_text('[mechanism]\ntype = "spring-block"\nmass = 0.82\n')
    return commands(capsys, one_line=True)


def test_check_says_how_the_motion_lies_in_the_picture(run):
    code, out, _ = run("check", "track.txt", "--columns", "position=x,y", "--json")
    assert code == 0
    (line,) = [found for found in json.loads(out)["findings"] if found["kind"] == "line"]
    # Jitter over spread and root of n is 0.02 degrees.
    assert np.degrees(line["numbers"]["tilt"]) == pytest.approx(3.0, abs=0.08)


def test_of_two_tracks_the_option_is_told_that_names_one(run):
    code, _, err = run("check", "two.txt", "--columns", "position=x,y")
    assert code == 2
    assert 'Choose one, as --columns "position=mass A/x,mass A/y".' in err
    assert run("check", "two.txt", "--columns", "position=mass A/x,mass A/y")[0] == 0


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ("x,y", "--columns takes NAME=VALUE such as position=q_m, got 'x'"),
        ("time=t,q", "columns.time must be the name of one column, got ['t', 'q']"),
        ("position=x,y,t", "or two different names, for the two coordinates"),
        ("position=x,", "--columns takes NAME=VALUE such as position=q_m, got ''"),
        ("position=x=,y", "unknown column of track.txt: 'x='"),
    ],
)
def test_columns_that_cannot_be_meant_are_refused(run, given, message):
    code, _, err = run("check", "track.txt", "--columns", given)
    assert code == 2
    assert message in err


def test_the_friction_of_a_filmed_block_is_found(run):
    code, out, _ = run(
        *("fit", "block.toml", "--data", "track.txt", "--columns", "position=x,y", "--json"),
        *("--law", "coulomb", "-o", "law.toml"),
    )
    assert code == 0
    (mu,) = json.loads(out)["estimates"]
    assert mu["parameter"] == "friction.kinetic_coefficient"
    assert mu["value"] == pytest.approx(MU, rel=0.005)
