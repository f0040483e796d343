"""Options of ``fit`` and ``select`` for records: used, or refused; and what is told meanwhile."""

import json

import numpy as np
import pytest
from tests.commands import commands

from stickslip import Axis, CoulombViscous, load_rig, simulate
from stickslip.cli.inputs import measured
from stickslip.cli.options import MeasuredOptions
from stickslip.engine.solver.compile.modules import notice
from stickslip.mechanisms.drives import Sampled

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
ONCE = ("--starts", "1")


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
        (("fit", "axis.toml", "--horizon", "1"), "--horizon is the prediction length"),
        (("fit", "map.toml", "--segment", "1"), "it has no effect on tables of friction"),
        (("fit", "map.toml", "--hold", "first"), "it has no effect on tables of friction"),
        (("fit", "axis.toml", "--route", "inverse-dynamics", "--segment", "1"), "the route is inv"),
        (("select", "axis.toml", "--segment", "1"), "it has no effect on `select`"),
        (("select", "axis.toml", "--horizon", "1"), "it has no effect on `select`"),
        (
            ("select", "map.toml", "--starts", "2"),
            "--starts applies to `fit` of tables of friction",
        ),
        (("select", "map.toml", "--route", "force-map"), "--route 'force-map' applies to `fit`"),
        (("fit", "axis.toml", "--segment", "-1"), "stickslip: --segment must be a time above 0 s"),
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
        ("--route", "shooting"),
        ("--horizon", "1"),
        ("--segment", "1"),
        ("--hold", "zero"),
        ("--starts", "2"),
        ("--seed", "1"),
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
        ("known.toml", "--route", "inverse-dynamics"),
    ],
)
def test_what_the_rig_gives_is_held_where_it_is_not_varied(run, rig):
    code, out, err = run("fit", *rig, "--vary", "kinetic_coefficient", *ONCE, "--json")
    assert code == 0, err
    found = {e["parameter"]: e["value"] for e in json.loads(out)["estimates"]}
    assert "friction.viscous_coefficient" not in found
    # with the slope that made the record; inverse dynamics loses some tenths at reversals
    assert found["friction.kinetic_coefficient"] == pytest.approx(10.0, rel=0.05)


def test_a_value_that_is_fitted_all_the_same_is_said(run):
    code, _, err = run("fit", "known.toml", *ONCE)
    assert code == 0
    assert "including viscous_coefficient = 30" in err


@pytest.mark.slow
def test_a_saved_fit_is_fitted_again_by_the_law_it_names(run, tmp_path):
    (tmp_path / "law.toml").write_text(RIG + "[friction.coulomb]\nkinetic_coefficient = 12\n")
    data = ("--data", "axis.csv", "--columns", "time=t,position=q,force=u")
    code, out, err = run("fit", "law.toml", *data, *ONCE, "--json")
    assert code == 0, err
    assert json.loads(out)["law"] == "coulomb"


def test_what_nobody_gives_is_still_asked_for(run):
    code, _, err = run("fit", "axis.toml", "--vary", "kinetic_coefficient", *ONCE)
    assert code == 2
    assert "viscous_coefficient (sigma_2) is neither varied nor fixed" in err


@pytest.mark.slow
def test_the_command_in_a_report_is_quoted(run, monkeypatch, tmp_path):
    command = ["select", "axis.toml", "--laws", "coulomb", "-o", "emps a"]
    monkeypatch.setattr("sys.argv", ["stickslip", *command])
    assert run(*command)[0] in (0, 3)
    page = (tmp_path / "emps a" / "index.html").read_text(encoding="utf-8")
    assert "-o &#39;emps a&#39;" in page


def test_notices_of_the_library_reach_a_pipe(run, monkeypatch):
    monkeypatch.setattr(
        "stickslip.cli.console.print_json", lambda _: notice("Compiling the solver ...")
    )
    _, _, err = run("schema")
    assert "Compiling the solver ..." in err


@pytest.fixture
def pushed(run):
    """Write a record whose motion the recorded force alone does not predict; return the rig."""
    rate, draw = 200.0, np.random.default_rng(1)
    time = np.arange(1200) / rate
    force = 20.0 * np.sin(2.0 * np.pi * time)
    unseen = 60.0 * np.sin(3.1 * time) + 50.0 * np.sin(7.7 * time + 1.0)
    drive = Sampled(times=time, values=force + unseen)
    law = CoulombViscous(kinetic_coefficient=10.0, viscous_coefficient=30.0)
    moved = simulate(Axis(inertia=5.0, drive=drive), law, t_end=6.0).at(time)["x"]
    rows = np.stack([time, moved + draw.normal(0.0, 1e-6, time.size), force], axis=1)
    np.savetxt("axis.csv", rows, delimiter=",", header="t,q,u", comments="")
    return "axis.toml"


@pytest.mark.slow
def test_the_bar_has_the_unit_of_the_route_that_is_taken_and_its_reason_is_said(run, pushed):
    rig = load_rig(pushed)
    kind, request, _ = measured(rig, MeasuredOptions(rig=pushed), law=lambda _: "coulomb")
    assert kind.residual_text(1.0, request) == "1 N"
    _, out, _ = run("fit", pushed, "--law", "coulomb-viscous", *ONCE)
    assert "Fitted by inverse dynamics, because Coulomb + viscous friction leaves" in " ".join(
        out.split()
    )


def test_the_length_of_segments_is_refused_where_the_route_taken_has_none(run, pushed):
    code, _, err = run("fit", pushed, "--law", "coulomb-viscous", "--segment", "0.9")
    assert code == 2
    assert "here the route is inverse-dynamics" in err
