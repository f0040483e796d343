"""Options of ``fit`` and ``select`` for records: used, or refused; and what is told meanwhile."""

import json

import numpy as np
import pytest
from tests.commands import commands

from stickslip.engine.solver.compile.modules import notice

RIG = """
title = "Axis"
[mechanism]
type = "axis"
inertia = "5 kg"
"""
DATA = """
[data]
file = "axis.csv"
columns = { time = "t", position = "q", force = "u" }
"""
VISCOUS = """
[friction]
viscous_coefficient = "30 N s/m"
"""


@pytest.fixture
def run(capsys, monkeypatch, tmp_path, axis_record):
    """Run a command beside a rig with a record; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    table = np.stack(list(axis_record.values()), axis=1)
    np.savetxt("axis.csv", table, delimiter=",", header=",".join(axis_record), comments="")
    velocity = np.linspace(-1.0, 1.0, 200)
    rubbed = np.stack([velocity, 10.0 * np.sign(velocity) + 30.0 * velocity], axis=1)
    np.savetxt("map.csv", rubbed, delimiter=",", header="velocity,friction", comments="")
    (tmp_path / "axis.toml").write_text(RIG + DATA)
    (tmp_path / "map.toml").write_text(RIG + '[data]\nfile = "map.csv"\n')
    (tmp_path / "known.toml").write_text(RIG + DATA + VISCOUS)
    return commands(capsys)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("fit", "map.toml", "--hold", "first"), "it has no effect on tables of friction"),
        (
            ("fit", "axis.toml", "--starts", "2"),
            "it has no effect on records of motion or friction",
        ),
        (("select", "map.toml", "--starts", "2"), "it has no effect on tables of friction"),
        (("select", "map.toml", "--route", "balance"), "give arrays with time [s]"),
        (("fit", "axis.toml", "--route", "force-map"), "unknown route 'force-map'"),
    ],
)
def test_an_option_without_effect_is_refused(run, arguments, said):
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert said in err
    assert len(err.splitlines()) == 1


@pytest.mark.parametrize("command", ["fit", "select"])
@pytest.mark.parametrize(
    "option",
    [
        ("--route", "balance"),
        ("--hold", "zero"),
    ],
)
def test_options_of_records_are_refused_for_travels(run, command, option):
    code, _, err = run(command, "demo", *option)  # the bundled rig has a travel
    assert code == 2
    assert err.startswith(f"stickslip: {option[0]} applies to ")
    assert "records of motion or friction; it has no effect on travels" in err


@pytest.mark.parametrize(
    "rig",
    [
        ("known.toml",),
        ("axis.toml", "--set", "friction.viscous_coefficient=30"),
    ],
)
def test_what_the_rig_gives_is_held_where_it_is_not_varied(run, rig):
    code, out, err = run("fit", *rig, "--vary", "kinetic_coefficient", "--json")
    assert code == 0, err
    found = {e["parameter"]: e["value"] for e in json.loads(out)["estimates"]}
    assert "friction.viscous_coefficient" not in found
    # with the slope that made the record
    assert found["friction.kinetic_coefficient"] == pytest.approx(10.0, rel=0.01)


def test_a_value_that_is_fitted_all_the_same_is_said(run):
    code, _, err = run("fit", "known.toml")
    assert code == 0
    assert "including viscous_coefficient = 30" in err


def test_what_nobody_gives_is_still_asked_for(run):
    code, _, err = run("fit", "axis.toml", "--vary", "kinetic_coefficient")
    assert code == 2
    assert "viscous_coefficient (sigma_2) is neither varied nor fixed" in err


def test_notices_of_the_library_reach_a_pipe(run, monkeypatch):
    monkeypatch.setattr(
        "stickslip.cli.models.print_json", lambda _: notice("Compiling the solver ...")
    )
    _, _, err = run("schema")
    assert "Compiling the solver ..." in err
