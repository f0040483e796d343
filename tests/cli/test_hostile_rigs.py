"""Rig files with numbers that no rig has end in a verdict or in one clear message."""

import json
import math
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pytest
import tomlkit

from stickslip import Coulomb, TowedBlock, simulate
from stickslip.cli import main
from stickslip.friction import RateState
from stickslip.identify.kinds import simulate_velocity_steps

TRAVEL = """
[mechanism]
type = "spring-block"
mass = { value = "1 kg", uncertainty = "0.01 kg" }
stiffness = "100 N/m"
compression = "100 mm"
attached = false
incline = "0 deg"
[run]
t_end = "10 s"
[friction]
kinetic_coefficient = 0.25
static_coefficient = 0.35
[[trial]]
travel = "0.20 m"
uncertainty = "5 mm"
initial = { v = "0 m/s" }
conditions = { temperature = 20.0 }
set = { compression = { value = "100 mm", uncertainty = "1 mm" } }
[[trial]]
travel = 0.072
uncertainty = 0.005
set = { compression = 0.06 }
[[published]]
law = "coulomb"
travel = "0.16 m"
relative_error = "20 %"
"""
RECORD = """
[mechanism]
type = "axis"
inertia = { value = "5 kg", vary = true }
[run]
t_end = 10.0
[friction]
kinetic_coefficient = 10.0
[data]
file = "axis.csv"
columns = { time = "t", position = "q", force = "u" }
gain = { force = 1.0 }
offset = { position = 0.0 }
"""
FEATURES = """
[mechanism]
type = "towed-block"
mass = { value = "30 g", vary = true }
stiffness = "1000 N/m"
speed = "4 mm/s"
load = "0.3 N"
[data]
file = "pull.csv"
columns = { time = "t", spring_force = "F" }
gain = { spring_force = 1.0 }
"""
STEPS = """
[mechanism]
type = "towed-block"
mass = "1 g"
stiffness = { value = "2000 N/m", vary = true }
speed = "1 um/s"
load = "1 N"
[data]
file = "steps.csv"
columns = { time = "t", pull = "pull", friction = "mu" }
units = { pull = "um" }
gain = { friction = 1.0 }
"""
RIGS = {
    "travel": (TRAVEL, ["--laws", "coulomb"]),
    "record": (RECORD, ["--laws", "coulomb-viscous"]),
    "features": (FEATURES, ["--laws", "coulomb"]),
    "rate-state": (STEPS, ["--laws", "logarithmic", "--starts", "1"]),
}
KINDS = [0, -1, 1e308, 1e-308, math.nan, math.inf, "text", True, [], {"nested": 1.0}]
"""What stands where a number is expected."""
SIZES = [1e30, -1e30, 1e-30, 1e15, 1e-15]
"""Numbers that are read."""
WORDS = {"type", "file", "columns", "law", "units"}
OUTCOMES = {0, 2, 3}
"""A verdict, a message about the input, and a verdict that names no law."""


def places(node, path=()):
    """Yield the path of each number, and of each text that is one."""
    if isinstance(node, dict | list):
        for key, inner in node.items() if isinstance(node, dict) else enumerate(node):
            if key not in WORDS:
                yield from places(inner, (*path, key))
    else:
        yield path


def changed(text, path, value):
    """Return the text of a rig file with another value at a place."""
    tables = tomllib.loads(text)
    node = tables
    for step in path[:-1]:
        node = node[step]
    node[path[-1]] = value
    return tomlkit.dumps(tables)


def cases(values):
    return [
        pytest.param(kind, path, value, id=f"{kind}:{'.'.join(map(str, path))}={value!r}")
        for kind, (text, _) in RIGS.items()
        for path in places(tomllib.loads(text))
        for value in values
    ]


def pulled():
    t = np.arange(0.5, 4.5, 5e-4)
    block = TowedBlock(mass=0.021, stiffness=1000.0, speed=4e-3, load=0.3)
    law = Coulomb(kinetic_coefficient=0.28, static_coefficient=0.32)
    run = simulate(block, law, t_end=4.5)
    noise = np.random.default_rng(0).normal(0.0, 5e-4, len(t))
    return {"t": t, "F": 1000.0 * (4e-3 * t - run.at(t)["x"]) + noise}


def stepped():
    law = RateState(
        reference_coefficient=0.6,
        direct_effect=0.010,
        evolution_effect=0.0,
        reference_velocity=1e-6,
        evolution="none",
    )
    knots, places = (0.0, 20.0, 40.0, 80.0), (0.0, 20e-6, 220e-6, 260e-6)
    t = np.arange(0.0, 80.0, 0.2)
    run = simulate_velocity_steps(law, stiffness=2e3, time=knots, pull=places, at=t)
    noise = np.random.default_rng(0).normal(0.0, 5e-4, len(t))
    return {"t": t, "pull": 1e6 * np.interp(t, knots, places), "mu": run.coefficient + noise}


@pytest.fixture(scope="module")
def tables(axis_record):
    short = {name: values[:600] for name, values in axis_record.items()}
    return {"axis.csv": short, "pull.csv": pulled(), "steps.csv": stepped()}


@pytest.fixture
def run(capsys, monkeypatch, tmp_path, tables):
    """Run a command on the text of a rig file; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    for name, columns in tables.items():
        rows = np.column_stack(list(columns.values()))
        np.savetxt(name, rows, delimiter=",", header=",".join(columns), comments="")

    def call(text, verb, *options):
        Path("rig.toml").write_text(text, encoding="utf-8")
        try:
            # what NumPy says of numbers that overflow is no traceback
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", RuntimeWarning)
                code = main([verb, "rig.toml", *options])
        except SystemExit as leaving:
            code = leaving.code or 0
        seen = capsys.readouterr()
        return code, seen.out, seen.err

    return call


def assert_is_told(run, kind, path, value):
    text, options = RIGS[kind]
    code, out, err = run(changed(text, path, value), "select", *options, "--json")
    assert code in OUTCOMES, err
    if code == 2 or not out:  # 3 without a verdict: no fit converged
        assert out == ""
        assert err.splitlines()[-1].startswith("stickslip: ")
        assert {path.name for path in Path.cwd().iterdir()} <= {"rig.toml", *FILES}
    else:
        json.loads(out)


FILES = {"axis.csv", "pull.csv", "steps.csv"}


@pytest.mark.parametrize(("kind", "path", "value"), cases(KINDS)[::13])
def test_any_value_of_any_field_ends_in_a_verdict_or_a_message(run, kind, path, value):
    assert_is_told(run, kind, path, value)


@pytest.mark.slow
@pytest.mark.parametrize(("kind", "path", "value"), [*cases(KINDS), *cases(SIZES)])
def test_every_value_of_every_field_ends_in_a_verdict_or_a_message(run, kind, path, value):
    assert_is_told(run, kind, path, value)


@pytest.mark.parametrize("value", [1e308, -1e308, 1e-308, 1.1e30, "1e309 mm", "1e31 km"])
@pytest.mark.parametrize("verb", ["select", "fit"])
def test_a_travel_beyond_all_measure_is_one_message(run, verb, value):
    law = ["--laws", "coulomb"] if verb == "select" else ["--law", "coulomb"]
    code, out, err = run(changed(TRAVEL, ("trial", 0, "travel"), value), verb, *law)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert "trial.0.travel" in err
    assert "must be" in err
    assert not Path("rig-report").exists()


def test_numbers_at_the_ends_of_what_is_read_are_read(run):
    code, _, err = run(
        changed(TRAVEL, ("published", 0, "travel"), 1e30), "simulate", "--law=coulomb"
    )
    assert code == 0, err
    code, _, err = run(
        changed(TRAVEL, ("published", 0, "travel"), 1e-30), "simulate", "--law=coulomb"
    )
    assert code == 0, err


@pytest.mark.parametrize(("field", "value"), [("stiffness", 1e-9), ("mass", 1e9)])
def test_a_record_shorter_than_a_natural_period_has_no_features(run, field, value):
    text = changed(FEATURES, ("mechanism", field), value)
    code, _, err = run(text, "select", "--laws", "coulomb")
    assert (code, "one natural period or more" in err) == (2, True)
