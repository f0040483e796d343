"""``stickslip select`` and ``stickslip fit`` on records in time."""

import json
import os
import re
import signal
from pathlib import Path

import numpy as np
import pytest
from tests.commands import commands

from stickslip import CoulombViscous, Pendulum, load_rig, simulate
from stickslip.cli.progress import Interrupts

RIG = """
title = "Axis"
subject = "made up"
[mechanism]
type = "axis"
inertia = {inertia}
"""
DATA = """
[data]
file = "axis.csv"
columns = { time = "t", position = "q", force = "u" }
"""
COLUMNS = ("--columns", "time=t,position=q,force=u")
LAW = ("--law", "coulomb-viscous")
FAST = ("--laws", "coulomb,coulomb-viscous")


@pytest.fixture
def write(tmp_path, axis_record):
    """Write the record, some of its columns replaced, and say what the file is called."""

    def writer(name="axis.csv", rows=slice(None), **changes):
        columns = {key: values[rows] for key, values in {**axis_record, **changes}.items()}
        table = np.stack(list(columns.values()), axis=1)
        np.savetxt(tmp_path / name, table, delimiter=",", header=",".join(columns), comments="")
        return name

    return writer


@pytest.fixture
def run(capsys, monkeypatch, tmp_path, write):
    """Run a command beside a rig with a record; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    write()
    (tmp_path / "bare.toml").write_text(RIG.format(inertia=5.0))
    (tmp_path / "axis.toml").write_text(
        RIG.format(inertia='{ value = "5 kg", vary = true }') + DATA
    )
    return commands(capsys, one_line=True)


@pytest.mark.slow
def test_a_rig_file_with_data_is_all_that_select_needs(run, tmp_path):
    code, out, _ = run("select", "axis.toml", *FAST)
    assert code == 0
    assert "Use Coulomb + viscous friction. Friction is known to ±" in out
    assert "friction is known to ±" in out
    assert "differs by" in out
    assert "mechanism.inertia" in out
    report = tmp_path / "axis-report"
    content = json.loads((report / "verdict.json").read_text(encoding="utf-8"))
    assert content["best"] == "coulomb-viscous"
    law = load_rig(report / "law.toml").laws["coulomb-viscous"]
    assert law.kinetic_coefficient == pytest.approx(10.0, rel=0.01)
    assert law.viscous_coefficient == pytest.approx(30.0, rel=0.01)


SAID = ("--gain", "force=35.15", "--unit", "position=mm")


@pytest.fixture
def volts(write, axis_record):
    """Write the record with forces in volts and positions in millimetres."""
    return write("volts.csv", u=axis_record["u"] / 35.15, q=1e3 * axis_record["q"])


@pytest.mark.slow
def test_options_say_what_a_rig_without_data_does_not(run, volts):
    _, out, _ = run("fit", "bare.toml", "--data", volts, *COLUMNS, *SAID, *LAW, "--json")
    told = json.loads(out)
    _, out, _ = run("fit", "bare.toml", "--data", "axis.csv", *COLUMNS, *LAW, "--json")
    plain = json.loads(out)
    # the file is written with 18 digits, the gain undone to rounding
    assert told["leaves"] == pytest.approx(plain["leaves"], rel=1e-4)
    values = [[one["value"] for one in entry["estimates"]] for entry in (told, plain)]
    assert values[0] == pytest.approx(values[1], rel=1e-4)


@pytest.mark.slow
def test_a_second_record_is_only_judged_by(run, write):
    write("second.csv", rows=slice(600, None))
    code, out, _ = run("fit", "axis.toml", "--validate", "second.csv")
    assert code == 0
    assert re.search(r"On the second record \d+ % of the \d+ readings lie in the band", out)


@pytest.mark.parametrize("command", [("select", *FAST), ("fit", "--law", "coulomb")])
def test_the_record_itself_is_no_second_record(run, write, tmp_path, command):
    write("copy.csv")
    name, *more = command
    code, out, message = run(name, "axis.toml", "--validate", "copy.csv", *more)
    assert (code, out) == (2, "")
    assert "the second record is identical to the fitted one" in message
    assert not (tmp_path / "axis-report").exists()


@pytest.mark.slow
def test_a_rig_or_an_option_says_that_a_force_was_joined(run, write, tmp_path):
    # 20 Hz instead of the 200 Hz of the controller: only joined does the force stay what it was
    write(rows=slice(None, None, 10))
    joined = (tmp_path / "axis.toml").read_text() + 'hold = "first"\n'
    (tmp_path / "joined.toml").write_text(joined)

    def residual(*arguments):
        code, out, err = run("fit", *arguments, "--json")
        assert code == 0, err
        return json.loads(out)["leaves"]

    by_rig, by_option = residual("joined.toml"), residual("axis.toml", "--hold", "first")
    held = residual("axis.toml", "--hold", "zero")
    # half a sample late is 25 ms, of which a delay takes a part
    assert by_rig == by_option < 0.5 * held
    assert residual("joined.toml", "--hold", "zero") == held  # the option wins


def test_a_fitted_law_is_a_rig_file_that_simulate_takes(run, tmp_path):
    code, _, _ = run("fit", "axis.toml", "-o", "law.toml")
    assert code == 0
    rig = load_rig(tmp_path / "law.toml")
    assert list(rig.laws) == ["coulomb-viscous"]
    code, out, _ = run("simulate", "law.toml", "--law", "coulomb-viscous", "--json")
    assert code == 0
    assert json.loads(out)["certificate"]["certified"] is True
    code, _, err = run("fit", "axis.toml", "-o", "law.toml")
    assert (code, "--force" in err) == (2, True)


@pytest.mark.parametrize(
    ("output", "command"),
    [("axis.toml", ("fit", *LAW)), ("axis.csv", ("simulate", "--law", "coulomb"))],
)
def test_what_a_command_reads_is_not_replaced(run, tmp_path, output, command):
    name, *options = command
    rig = RIG.format(inertia=5.0) + DATA + "[friction.coulomb]\nkinetic_coefficient = 10.0\n"
    (tmp_path / "axis.toml").write_text(rig)
    before = (tmp_path / output).read_bytes()
    (tmp_path / "link").symlink_to(tmp_path)
    for place in ("", "link/"):
        code, _, err = run(name, "axis.toml", *options, "-o", place + output, "--force")
        assert code == 2
        assert f"{output} is read by this command, so it is not replaced" in err
    assert (tmp_path / output).read_bytes() == before


@pytest.mark.slow
def test_the_digest_of_the_inputs_is_that_of_the_data_too(run, write, axis_record):
    def digest(*arguments):
        code, out, err = run("fit", *arguments, *LAW, "--json")
        assert code == 0, err
        return json.loads(out)["digest"]

    asked = ("bare.toml", "--data", "axis.csv", *COLUMNS)
    short = slice(300)
    write(rows=short)
    before = [digest("axis.toml"), digest(*asked), load_rig("bare.toml").digest]
    write("moved.csv", rows=short)
    assert digest("bare.toml", "--data", "moved.csv", *COLUMNS) == before[1]  # the same contents
    write(rows=short, u=1.001 * axis_record["u"])
    after = [digest("axis.toml"), digest(*asked), load_rig("bare.toml").digest]
    assert [one == other for one, other in zip(before, after, strict=True)] == [False, False, True]


@pytest.mark.slow
def test_only_the_parameters_named_are_free(run):
    own = "friction.coulomb-viscous"
    known = ("--set", f"{own}.kinetic_coefficient=10", "--set", f"{own}.viscous_coefficient=20")
    free = ("--vary", "viscous_coefficient", "--json")
    _, out, _ = run("fit", "axis.toml", *known, *free)
    paths = [load["parameter"] for load in json.loads(out)["estimates"]]
    assert "friction.viscous_coefficient" in paths
    assert "friction.kinetic_coefficient" not in paths


TRAVELS = """
[mechanism]
type = "spring-block"
mass = "1 kg"
stiffness = {{ value = "100 N/m", uncertainty = "{stiffness}" }}
compression = "100 mm"
[[trial]]
travel = "204 mm"
uncertainty = "1 mm"
[[trial]]
travel = "73 mm"
uncertainty = "1 mm"
set = {{ "mechanism.compression" = "60 mm" }}
"""


@pytest.mark.parametrize(
    ("stiffness", "said"),
    [
        ("3 N/m", "The stiffness (3 %) contributes more to its uncertainty than the readings."),
        ("0.1 N/m", "The readings contribute more to its uncertainty than the stiffness (0.1 %)."),
    ],
)
def test_fit_prints_what_limits_an_interval(run, tmp_path, stiffness, said):
    (tmp_path / "block.toml").write_text(TRAVELS.format(stiffness=stiffness))
    code, out, _ = run("fit", "block.toml", "--law", "coulomb")
    assert code == 0
    assert f"friction.kinetic_coefficient: {said}" in " ".join(out.split())


@pytest.mark.parametrize("command", [("fit", "--law"), ("select", "--laws"), ("plan", "--laws")])
def test_travels_refuse_a_law_that_only_records_can_fit(run, command):
    verb, option = command
    code, _, err = run(verb, "demo", option, "dahl-exponent")
    assert code == 2
    assert "dahl with its exponent fitted as well. Give dahl here." in err


BAD = [
    (("select", "bare.toml"), "has no measurement"),
    (("select", "bare.toml", "--data", "nowhere.csv"), "nowhere.csv does not exist"),
    (("select", "bare.toml", *COLUMNS), "apply to the files of --data"),
    (("select", "bare.toml", "--data", "axis.csv", "--columns", "position=x"), "column of axis"),
    (("select", "axis.toml", "--laws", "coulom"), "Did you mean 'coulomb'"),
    (("select", "axis.toml", "--laws", "bouc-wen"), "cannot be compared on this measurement"),
    (("select", "axis.toml", "--route", "balanc"), "Did you mean 'balance'"),
    (("select", "axis.toml", "--vary", "friction.*,inertias"), "Did you mean 'inertia'"),
    (("select", "axis.toml", "--hold", "second"), "--hold must be zero or first"),
    (("fit", "demo", "--hold", "first"), "--hold applies to records"),
    (("select", "axis.toml", "--enforce"), "--enforce applies to travels"),
    (("select", "demo", "--validate", "axis.csv", *COLUMNS), "give more trials instead"),
    (("fit", "axis.toml", "--law", "coulom"), "Did you mean 'coulomb'"),
    (("fit", "axis.toml", "--vary", "stifness"), "Did you mean 'stiffness'"),
    (("fit", "axis.toml", "--vary", "viscous_coefficient"), "neither varied nor fixed"),
    (("fit", "axis.toml", "--fixed", "inertia"), "--fixed takes NAME=VALUE"),
    (
        ("select", "axis.toml", "--fixed", "viscous_coefficient=0.4"),
        "takes only parameters of the mechanism when laws are compared, got viscous_coefficient",
    ),
    (("fit", "axis.toml", "--fixed", "inertia=5 m"), "--fixed mechanism.inertia"),
    (("fit", "axis.toml", "--fixed", "inertias=5"), "Did you mean 'inertia'"),
    (("fit", "axis.toml", "--fixed", "inertia=-5"), "above 0"),
    (
        ("select", "axis.toml", "--starts", "2"),
        "it has no effect on records of motion or friction: leave it out",
    ),
    (("fit", "axis.toml", "-o", "law.json"), "takes a .toml file"),
]


@pytest.mark.parametrize(("arguments", "fragment"), BAD, ids=lambda value: str(value)[:60])
def test_mistakes_give_one_message_and_leave_nothing(run, tmp_path, arguments, fragment):
    before = sorted(tmp_path.iterdir())
    code, out, err = run(*arguments)
    assert (code, out) == (2, "")
    assert fragment in err
    assert sorted(tmp_path.iterdir()) == before


HALF = slice(0, 600)


def damaged(record, how):
    """Return the columns of a record that something is wrong with, and what is then said."""
    time, position, force = record["t"][HALF], record["q"][HALF], record["u"][HALF]
    swapped = time.copy()
    swapped[[10, 20]] = swapped[[20, 10]]
    twice = time.copy()
    twice[11] = twice[10]
    holed = position.copy()
    holed[7] = np.nan
    return {
        "unsorted": ({"t": swapped, "q": position, "u": force}, "sort"),
        "a time twice": ({"t": twice, "q": position, "u": force}, "sort"),
        "not a number": ({"t": time, "q": holed, "u": force}, "line 9: must be a finite number"),
        "constant": ({"t": time, "q": 0 * time, "u": force}, "no motion"),
        "too short": ({"t": time[:8], "q": position[:8], "u": force[:8]}, "samples"),
    }[how]


@pytest.mark.parametrize("command", ["select", "fit"])
@pytest.mark.parametrize(
    "how", ["unsorted", "a time twice", "not a number", "constant", "too short"]
)
def test_bad_data_is_one_message(run, write, tmp_path, axis_record, command, how):
    columns, said = damaged(axis_record, how)
    file = write("bad.csv", rows=slice(None), **columns)
    before = sorted(tmp_path.iterdir())
    code, out, err = run(command, "bare.toml", "--data", file, *COLUMNS)
    assert (code, out) == (2, "")
    assert said in err.lower()
    assert len(err) < 500
    assert sorted(tmp_path.iterdir()) == before


@pytest.mark.parametrize("command", ["select", "fit"])
@pytest.mark.parametrize(
    ("text", "said"),
    [("", "is empty"), ("t,q,u\n", "no "), ("Call me Ishmael.\n" * 200_000, "is not a table")],
    ids=["empty", "header only", "a book"],
)
def test_what_is_no_record_is_one_message(run, tmp_path, command, text, said):
    (tmp_path / "bad.csv").write_text(text)
    code, out, err = run(command, "bare.toml", "--data", "bad.csv", *COLUMNS)
    assert (code, out) == (2, "")
    assert said in err
    assert "bad.csv" in err
    assert len(err) < 500


def test_millimetres_read_as_metres_are_refused(run, write, axis_record):
    write("mm.csv", q=1e3 * axis_record["q"])
    code, _, err = run("fit", "bare.toml", "--data", "mm.csv", *COLUMNS)
    assert code == 2
    assert "give its unit, as --unit position=mm" in err


def test_a_typo_in_columns_is_named_and_drops_nothing(run):
    code, _, err = run("check", "axis.csv", "--columns", "positon=q,time=t")
    assert code == 2
    assert "unknown quantity in columns 'positon'. Did you mean 'position'?" in err
    code, _, err = run("check", "axis.csv", "--columns", "current=u,time=t")
    assert code == 2
    assert "a force with a gain" in err


def test_interrupts_are_as_ever_afterwards():
    before = signal.getsignal(signal.SIGINT)
    with Interrupts() as interrupts:
        os.kill(os.getpid(), signal.SIGINT)
        assert interrupts.stopped
    assert signal.getsignal(signal.SIGINT) is before


@pytest.mark.slow
def test_lengths_in_the_wrong_unit_are_doubted_before_a_law_is_named(run, write, axis_record):
    write("wrong.csv", q=10.0 * axis_record["q"])
    code, out, _ = run("select", "bare.toml", "--data", "wrong.csv", *COLUMNS, *FAST)
    assert code == 0
    said = " ".join(out.split())
    assert said.startswith("Check units, gains and signs first. The inertia is 0.1 times as") or (
        re.match(r"Check units, gains and signs first\. The inertia is 0\.099\d times as", said)
    )
    assert "a unit of length is wrong. If they are right, use Coulomb + viscous friction" in said
    assert "Use " not in out


@pytest.fixture
def pendulum(run, tmp_path):
    """Write the free decay of a pendulum, whose friction is a torque."""
    rod = Pendulum(mass=0.5, length=0.4)
    law = CoulombViscous(kinetic_coefficient=0.02, viscous_coefficient=0.01)
    t = np.arange(400) / 100.0
    motion = simulate(rod, law, t_end=4.0, y0={"theta": 0.8}).at(t)["theta"]
    noise = np.random.default_rng(0).normal(0.0, 1e-3, t.size)
    table = np.stack([t, motion + noise], axis=1)
    np.savetxt(tmp_path / "swing.csv", table, delimiter=",", header="t,q", comments="")
    (tmp_path / "swing.toml").write_text(
        '[mechanism]\ntype = "pendulum"\nmass = 0.5\nlength = 0.4\n[data]\nfile = "swing.csv"\n'
        'columns = { time = "t", position = "q" }\nunits = { position = "rad" }\n'
    )
    return run


@pytest.mark.slow
def test_all_units_of_a_pendulum_are_those_of_torque_and_angle(pendulum, drawn_figures):
    asked = ("fit", "swing.toml", *LAW)
    assert pendulum(*asked, "-o", "law.toml")[0] == 0
    estimates = json.loads(pendulum(*asked, "--json")[1])["estimates"]
    units = {entry["parameter"]: entry["unit"] for entry in estimates}
    assert units["friction.kinetic_coefficient"] == "N m"
    assert units["friction.viscous_coefficient"] == "N m s/rad"
    code, out, err = pendulum("simulate", "swing.toml", "--law", "law.toml", "--report")
    assert code == 0
    assert "N m s/rad applies to the contact of the fit" in err
    assert re.search(r"fitted up to \d\.\d+ rad/s", err)
    text = " ".join(Path("stickslip-run/index.html").read_text(encoding="utf-8").split())
    for wrong in ("m/s<", " m/s", "N s/m"):
        assert wrong not in out + err + text
    for unit in (">N m<", ">N m s/rad<"):
        assert unit in text
