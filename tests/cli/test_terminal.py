"""Help, completion, quiet, the first steps from a data file, and progress without a terminal."""

import json
import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import typer.main

from stickslip import load_rig
from stickslip.cli import main
from stickslip.cli.app import PANELS, app
from stickslip.cli.progress import Drawing, Searching


@pytest.fixture
def run(tmp_path, monkeypatch, capfd):
    """Run a command in an empty folder; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "100")

    def called(*arguments):
        with pytest.raises(SystemExit) as left:
            main([str(one) for one in arguments])
        out, err = capfd.readouterr()
        return left.value.code or 0, out, err

    return called


def leaves(group, above=()):
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            yield from leaves(command, (*above, name))
        else:
            yield (*above, name)


COMMANDS = list(leaves(typer.main.get_command(app)))


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_each_command_has_short_help_with_an_example_and_can_be_quiet(run, command):
    code, out, _ = run(*command, "-h")
    assert code == 0
    assert run(*command, "--help")[1] == out
    assert re.search(rf"^  Examples?:\n    \$ stickslip {' '.join(command)}", out, re.MULTILINE)
    assert "-q, --quiet" in out


@pytest.mark.parametrize("command", COMMANDS, ids=" ".join)
def test_every_option_has_a_long_name_and_the_text_below_its_field_as_help(command):
    found = typer.main.get_command(app)
    for name in command:
        found = found.commands[name]
    for option in found.params:
        assert option.help.endswith(".")
        if option.param_type_name == "option":
            assert any(name.startswith("--") for name in option.opts)


@pytest.mark.parametrize(
    "command",
    [
        ("simulate", "demo", "--t-end", "0.1", "-o", "new/one/file.csv"),
        ("simulate", "demo", "--t-end", "0.1", "--report-to", "new/one"),
        ("export", "law.toml", "--to", "c", "-o", "new/one"),
    ],
    ids=lambda command: command[0],
)
def test_commands_make_the_folder_of_what_they_write_and_the_help_says_so(
    run, tmp_path, sketches, command
):
    law = "[friction]\nkinetic_coefficient = 0.3\n[friction.coulomb]\n"
    (tmp_path / "law.toml").write_text(f'[mechanism]\ntype = "axis"\ninertia = 1.0\n{law}')
    code, out, err = run(*command)
    assert code == 0, err
    assert list((tmp_path / "new" / "one").iterdir())
    assert "new/one" in out.replace("\\", "/")
    said = " ".join(run("-h")[1].split())
    assert "Folders of files to write are made where they do not exist." in said


def test_commands_are_listed_by_panels_and_none_is_left_out(run):
    code, out, _ = run("-h")
    assert code == 0
    heads = [f"\n{title}:" for title in PANELS]
    assert [out.index(head) for head in heads] == sorted(out.index(head) for head in heads)
    listed = [name for names in PANELS.values() for name in names]
    assert sorted(listed) == sorted({command[0] for command in COMMANDS})
    assert all(f"\n  {name} " in out for name in listed)


NEEDING = ("select", "fit", "simulate", "animate", "sweep", "plan")


@pytest.mark.parametrize("command", NEEDING)
def test_without_a_rig_a_command_says_what_it_needs(run, tmp_path, command):
    code, out, err = run(command)
    assert (code, out) == (2, "")
    assert err.startswith(f"stickslip: stickslip {command} needs a rig file (TOML)")
    assert f"stickslip {command} demo" in err
    assert "stickslip init" in err
    assert err.count("\n") == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("command", "needed", "meaning"),
    [
        (("check",), "FILE", "Data files (CSV"),
        (("init",), "FILE...", "Record (CSV"),
        (("export",), "FILE", "Rig file (TOML) with a law"),
        (("export", "law.toml"), "--to", "c (C99)"),
        (("data", "show"), "NAME", "Name of a record"),
        (("data", "path"), "NAME", "Name of a record"),
        (("optimise",), "RIG", "Rig file (TOML) whose drives repeat themselves"),
        (("optimise", "rig.toml"), "--vary", "Parameter to optimise"),
    ],
)
def test_without_what_it_needs_a_command_names_it_with_an_example(run, command, needed, meaning):
    code, out, err = run(*command)
    assert (code, out) == (2, "")
    path = " ".join(word for word in command if not word.endswith(".toml"))
    assert err.startswith(f"stickslip: stickslip {path} needs {needed}: {meaning}")
    assert f"Example: `stickslip {path} " in err
    assert err.count("\n") == 1


def test_a_value_of_the_wrong_kind_is_still_the_parsers_to_refuse(run):
    code, _, err = run("simulate", "demo", "--samples", "many")
    assert code == 2
    assert "Invalid value for '--samples'" in err


@pytest.mark.parametrize("name", ["run.csv", "RUN.TXT", "log.mf4", "a.parquet", "a.mat"])
def test_a_data_file_in_place_of_a_rig_is_offered_init_in_one_line(run, name):
    code, _, err = run("select", name)
    assert code == 2
    assert f"`stickslip init {name}` writes one" in err
    assert f"stickslip select {Path(name).with_suffix('.toml')}" in err
    assert err.count("\n") == 1


def test_a_value_is_set_by_its_last_name_where_it_is_the_only_one(run):
    code, out, _ = run("simulate", "demo", "--law", "coulomb", "--set", "mass=2 kg", "--json")
    same = run("simulate", "demo", "--law", "coulomb", "--set", "mechanism.mass=2 kg", "--json")
    assert (code, json.loads(out)["final"]) == (0, json.loads(same[1])["final"])
    # a key that the file does not have
    _, out, _ = run("simulate", "demo", "--law", "coulomb", "--set", "t_end=0.1 s", "--json")
    assert json.loads(out)["status"] == "END_TIME"


def test_a_last_name_that_several_have_lists_them(run):
    code, _, err = run("simulate", "demo", "--set", "viscous_coefficient=0.2")
    assert code == 2
    found = re.search(r"several paths end so, (.*): give one of them", " ".join(err.split()))
    assert found
    paths = found[1].split(", ")
    assert len(paths) > 1
    assert all(path.endswith(".viscous_coefficient") for path in paths)
    assert load_rig(overrides={paths[0]: 0.2}).laws


N = 1500
T = np.arange(N) / 250


@pytest.fixture
def measured(tmp_path):
    """Write a German record of an axis; return its true mass and friction."""
    from stickslip import Axis, CoulombViscous, simulate
    from stickslip.mechanisms.drives import PiecewiseLinear

    force = 40 * np.sin(2 * np.pi * T) + 15 * np.sin(2.3 * T)
    axis = Axis(inertia=5.0, drive=PiecewiseLinear(times=T, values=force))
    law = CoulombViscous(kinetic_coefficient=10.0, viscous_coefficient=30.0)
    x = simulate(axis, law, t_end=float(T[-1])).at(T)["x"]
    x = 1e3 * x + np.random.default_rng(1).normal(0.0, 0.005, N)
    rows = "".join(f"{a:.4f};{b:.4f};{c:.4f}\n" for a, b, c in zip(T, x, force, strict=True))
    text = "Prüfstand Süd\nZeit;Weg;Kraft\ns;mm;N\n" + rows.replace(".", ",")
    (tmp_path / "messung.csv").write_text(text, encoding="cp1252")
    return 5.0, 10.0, 30.0


@pytest.mark.slow
def test_two_commands_lead_from_a_german_file_to_a_report(run, tmp_path, measured):
    code, out, err = run("init", "messung.csv")
    assert (code, err) == (0, "")
    assert "column 'Weg' in mm, by its name; " not in out
    assert "decimal comma" in out
    assert run("check", "messung.toml")[0] == 0
    # least squares on differences of positions with 5 um of noise: enough for a start
    assert load_rig("messung.toml").mechanism.inertia == pytest.approx(5.0, rel=0.3)
    code, out, _ = run(
        "select", "messung.toml", "--laws", "coulomb,coulomb-viscous", "--json",
    )  # fmt: skip
    verdict = json.loads(out)
    assert (code, verdict["best"]) == (0, "coulomb-viscous")
    found = {entry["parameter"]: entry["value"] for entry in verdict["parameters"]}
    mass, level, slope = measured
    # velocities are differences of positions with 5 um of noise
    assert found["mechanism.inertia"] == pytest.approx(mass, rel=0.02)
    assert found["friction.kinetic_coefficient"] == pytest.approx(level, rel=0.03)
    assert found["friction.viscous_coefficient"] == pytest.approx(slope, rel=0.03)


def test_the_inertia_of_a_small_motor_is_small_enough_to_be_checked(run, tmp_path):
    # an inertia of 1 kg m^2 would be refused as impossible
    turned = 8.0 * np.sin(2 * T)
    torque = 0.002 * -32.0 * np.sin(2 * T) + 0.1 * np.sign(np.cos(2 * T))
    rows = "".join(f"{a:.4f};{b:.6f};{c:.6f}\n" for a, b, c in zip(T, turned, torque, strict=True))
    (tmp_path / "a.csv").write_text("Zeit;Winkel;Moment\ns;rad;Nm\n" + rows.replace(".", ","))
    assert run("init", "a.csv", "-q") == (0, "", "")
    assert load_rig("a.toml").mechanism.inertia == pytest.approx(0.002, rel=0.05)
    assert run("check", "a.toml")[0] == 0


def test_a_rate_is_given_where_rows_have_no_times(run, tmp_path):
    rows = "".join(f"{a:.4f},{b:.4f}\n" for a, b in zip(np.sin(T), np.cos(T), strict=True))
    (tmp_path / "log").write_text(f"angle [rad],torque [N m]\n{rows}")
    code, _, err = run("init", "log")
    assert (code, "--columns time=..., or give the rate of the rows, as --rate 50Hz." in err) == (
        2,
        True,
    )
    for given, rate in (("50Hz", "50Hz"), ("50", "50 Hz"), ("20 ms", "20 ms")):
        assert run("init", "log", "--rate", given, "--force", "-q") == (0, "", "")
        assert f'time = "{rate}"' in (tmp_path / "log.toml").read_text()
        code, out, _ = run("check", "log.toml")
        assert (code, "at 50 Hz over" in out) == (0, True)
    for wrong in (("--rate", "fast"), ("--rate", "50Hz", "--columns", "time=angle")):
        code, _, err = run("init", "log", "--force", *wrong)
        assert (code, err.startswith("stickslip: --rate takes a rate such as 50Hz")) == (2, True)


def test_init_overwrites_nothing_and_takes_what_is_known(run, tmp_path, measured):
    assert measured
    (tmp_path / "messung.toml").write_text("mine")
    code, _, err = run("init", "messung.csv")
    assert code == 2
    assert "--force" in err
    assert (tmp_path / "messung.toml").read_text() == "mine"
    code, out, _ = run("init", "messung.csv", "-o", "new/own.toml", "--unit", "force=kN", "--json")
    assert code == 0
    assert json.loads(out)["schema"] == "stickslip/init/1"
    assert json.loads(out)["units"]["force"] == "kN"
    assert 'file = "../messung.csv"' in (tmp_path / "new" / "own.toml").read_text()
    assert "takes a .toml file" in run("init", "messung.csv", "-o", "own.json")[2]
    code, _, err = run("init", "nowhere.csv")
    assert (code, "does not exist" in err) == (2, True)


class Clock:
    """A clock that is set by hand."""

    now = 0.0

    def __call__(self):
        return self.now


class Interrupts:
    stopped = False
    promise = ""


@pytest.mark.parametrize("forced", ["", "1"], ids=["plain", "forced colour"])
def test_progress_without_a_terminal_is_a_line_now_and_then(capsys, monkeypatch, forced):
    monkeypatch.setenv("FORCE_COLOR", forced)  # notebooks set it for the commands of their cells
    clock = Clock()
    monkeypatch.setattr("stickslip.cli.progress.time", SimpleNamespace(monotonic=clock))
    names = ["coulomb", "viscous", "lugre", "dahl"]
    with Searching(names, lambda error: f"{error:g}", Interrupts()) as watch:
        for second in range(120):
            clock.now = float(second)
            watch(names[second // 30], 1.0)
    lines = capsys.readouterr().err.splitlines()
    # four steps, and in each at most one line after 20 s
    assert 4 < len(lines) <= 8
    assert lines[0] == "Fitting coulomb (law 1 of 4) ..."
    assert lines[2] == "Fitting viscous (law 2 of 4, 30 s) ..."


def test_laws_are_counted_as_they_come_and_no_time_is_told_that_nobody_knows(capsys, monkeypatch):
    """Simpler laws are fitted first, and a law with bristles takes 100 times as long."""
    clock = Clock()
    monkeypatch.setattr("stickslip.cli.progress.time", SimpleNamespace(monotonic=clock))
    with Searching(["lugre", "coulomb", "stribeck"], str, Interrupts()) as watch:
        for now, name in ((0, "coulomb"), (1, "stribeck"), (2, "coulomb"), (6, "lugre")):
            clock.now = float(now)
            watch(name, 0.5)
        clock.now = 400.0
        watch("lugre", 0.4)
        watch("held-out block 1 of 8", 0.4)
    lines = capsys.readouterr().err.splitlines()
    assert lines == [
        "Fitting coulomb (law 1 of 3) ...",
        "Fitting stribeck (law 2 of 3) ...",
        "Fitting lugre (law 3 of 3, 6 s) ...",
        "Fitting lugre (law 3 of 3, 6 min 40 s) ...",
        "Validating on held-out block 1 of 8 (6 min 40 s) ...",
    ]


def test_the_time_left_leaves_out_what_compiling_took(capsys, monkeypatch):
    clock = Clock()
    monkeypatch.setattr("stickslip.cli.progress.time", SimpleNamespace(monotonic=clock))
    with Drawing("Running") as report:
        for done in range(1, 400):
            clock.now = 60.0 + 0.1 * done  # a minute before the first
            report(done, 1000)
    (early, late) = capsys.readouterr().err.splitlines()[:2]
    assert early == "Running (1 of 1000 done, 1 min 0 s) ..."
    assert "about 1 min 20 s left" in late


def test_init_of_a_place_without_a_name_is_one_sentence(run):
    for place in ("/", ".", ".."):
        code, out, err = run("init", place)
        assert (code, out) == (2, "")
        assert len(err.splitlines()) == 1, err
