"""Ensembles over the laws of a selection, of sweeps and of optimised motions."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from tests.commands import commands

from stickslip import Axis, Coulomb, Measurement, load_rig, select
from stickslip.data import settled_speed
from stickslip.identify.kinds import drawn_laws, write_verdict
from stickslip.study.optimisation import measure
from stickslip.study.sweep import velocity_band

CAPSULE = """
[mechanism]
type = "capsule"
capsule_mass = 0.08
inner_mass = 0.02
stiffness = 60.0
damping = 0.03
upper_soft_stop = { place = 0.002, stiffness = 3000.0, damping = 0.1 }
drive_on = "inner mass"
drive = { type = "torque", drive = { type = "sine", amplitude = 0.2, frequency = 7.0 } }
"""
STROKE = """
[mechanism]
type = "capsule"
capsule_mass = 0.8
inner_mass = 0.2
drive = {type = "prescribed", profile = {type = "three-phase", amplitude = 0.01, fast = 50.0, slow = 9.81, first = "slow"}}
"""  # noqa: E501  # one line of a rig file
FILM = """
[[trial]]
file = "{file}"
set = {{ mechanism.drive.drive.frequency = {frequency} }}
"""
SWEEP = ("sweep", "capsule.toml", "--law", "report/law.toml", "--settle", "10", "--cycles", "4")
VARY = ("--vary", "drive.frequency=6:12:3")


@pytest.fixture(scope="module")
def verdict():
    speed = np.linspace(0.02, 0.6, 12)
    noise = 1.0 + 0.05 * np.random.default_rng(3).normal(size=12)
    table = Measurement(velocity=speed, friction=4.0 * 0.25 * noise)
    return select(Axis(inertia=1.0, load=4.0), [Coulomb], table)


@pytest.fixture
def run(capsys, monkeypatch, tmp_path, verdict):
    """Run a command beside a capsule and the files of a selection; return code and outputs."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "capsule.toml").write_text(CAPSULE)
    write_verdict(tmp_path / "report", verdict, {})
    return commands(capsys)


def test_the_band_is_that_of_the_laws_that_the_selection_drew(run, verdict):
    code, out, _ = run(*SWEEP, *VARY, "--ensemble", "4", "-o", "band.csv", "--json")
    assert code == 0
    told = json.loads(out)
    drawn, error = drawn_laws("report/law.toml")
    assert drawn == verdict.sample(100)
    assert error == 0.0  # of a table
    axes = {"drive.frequency": [6.0, 9.0, 12.0]}
    own = velocity_band(load_rig("capsule.toml").mechanism, drawn[:4], axes, settle=10, cycles=4)
    for end in ("low", "median", "high"):
        np.testing.assert_array_equal(told[end], getattr(own, end))
    assert sum(told["laws"].values()) == 4
    table = pd.read_csv("band.csv")
    assert table["median [m/s]"].tolist() == told["median"]
    assert Path("band.svg").read_text().startswith("<svg")


def test_laws_whose_levels_are_forces_are_divided_by_the_load_that_is_given(run, tmp_path):
    speed = np.linspace(0.02, 0.6, 8)
    noise = 0.02 * np.random.default_rng(1).normal(size=8)
    table = Measurement(velocity=speed, friction=1.0 + noise)
    forces = select(Axis(inertia=1.0), [Coulomb], table)
    write_verdict(tmp_path / "forces", forces, {})
    own = ("--law", "forces/law.toml", *VARY, "--ensemble", "4", "--json")
    code, _, err = run(*SWEEP, *own)
    assert code == 2
    assert "--law-load" in err
    code, out, err = run(*SWEEP, *own, "--law-load", "4 N")
    assert code == 0, err
    axes = {"drive.frequency": [6.0, 9.0, 12.0]}
    laws = [vary_level(law, 0.25) for law in forces.sample(100)[:4]]
    known = velocity_band(load_rig("capsule.toml").mechanism, laws, axes, settle=10, cycles=4)
    np.testing.assert_allclose(json.loads(out)["median"], known.median, rtol=1e-9, atol=1e-12)


def vary_level(law, factor):
    """Return a law with a factor on its level."""
    name = "kinetic_coefficient" if isinstance(law, Coulomb) else "curve_factor"
    return replace(law, **{name: factor * getattr(law, name)})


def test_speeds_of_films_stand_beside_the_band(run):
    time = np.arange(0.0, 2.0, 1 / 60)
    text = CAPSULE + '\n[data]\ncolumns = { time = "t [s]", position = "x [m]" }\n'
    for frequency, speed in ((6.0, 0.01), (9.0, 5.0)):
        place = speed * time + 0.001 * np.sin(2.0 * np.pi * frequency * time)
        rows = [f"{t!r},{x!r}" for t, x in zip(time.tolist(), place.tolist(), strict=True)]
        Path(f"{frequency:g}.csv").write_text("\n".join(["t [s],x [m]", *rows]))
        text += FILM.format(file=f"{frequency:g}.csv", frequency=frequency)
    Path("capsule.toml").write_text(text)
    code, out, err = run(*SWEEP, *VARY, "--ensemble", "3", "--json")
    assert code == 0, err
    rig = load_rig("capsule.toml")
    films = rig.measurement.records()
    speeds = [settled_speed(rig.mechanism, film)[0] for film in films]
    assert json.loads(out)["measured"] == [[6.0, speeds[0]], [9.0, speeds[1]]]
    code, out, _ = run(*SWEEP, *VARY, "--ensemble", "3", "--force")
    assert code == 0
    assert "95 % band over 3 laws" in out
    assert "not at" in out
    assert "9 Hz" in out


def test_a_law_file_that_was_changed_is_drawn_by_its_estimates(run):
    law = Path("report/law.toml")
    law.write_text(law.read_text() + "\n")
    assert drawn_laws(law) is None
    code, out, _ = run(*SWEEP, *VARY, "--ensemble", "5", "--seed", "2", "--json")
    assert code == 0
    assert json.loads(out)["laws"] == {"coulomb": 5}


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((*VARY, "--ensemble", "101"), "up to 100 laws"),
        ((*VARY, "--vary", "drive.amplitude=0.1:0.2:2", "--ensemble", "3"), "takes one --vary"),
        ((*VARY, "--law", "coulomb", "--ensemble", "3"), "needs laws to draw"),
        (("--ensemble", "3"), "applies to a rig file with --vary"),
    ],
)
def test_an_ensemble_that_cannot_be_is_refused_with_a_cure(run, arguments, words):
    code, out, err = run(*SWEEP, *arguments)
    assert (code, out) == (2, "")
    assert words in " ".join(err.split())


def test_a_motion_is_optimised_over_the_laws_that_the_selection_drew(run):
    Path("stroke.toml").write_text(STROKE)
    given = ("optimise", "stroke.toml", "--vary", "amplitude=1mm..10mm", "--evaluations", "2")
    drawn = ("--law", "report/law.toml", "--ensemble", "2")
    code, out, err = run(*given, *drawn, "--quantile", "mean", "--json")
    assert code == 0, err
    answer = json.loads(out)
    laws, _ = drawn_laws("report/law.toml")
    (best,) = answer["motions"]
    profile = load_rig("stroke.toml").mechanism.drive.profile
    amplitude = best["parameters"]["mechanism.drive.profile.amplitude"]
    capsule = load_rig("stroke.toml").mechanism
    moved = replace(
        capsule, drive=replace(capsule.drive, profile=replace(profile, amplitude=amplitude))
    )
    assert answer["scenarios"] == "the mean of 2 scenarios"
    speeds = [measure(moved, law).speed for law in laws[:2]]
    assert best["values"]["speed"] == pytest.approx(np.mean(speeds))
    code, _, err = run(*given, *drawn, "--quantile", "most")
    assert code == 2
    assert "--quantile" in err
