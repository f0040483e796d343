"""The command line: results, exit codes, one message for bad input, nothing half written."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
from scipy.io import loadmat
from tests.commands import commands

from stickslip.friction import LAWS, PRINTED_FORMS
from stickslip.show.documents import write_folder


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run a command in an empty folder; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    return commands(capsys)


def complaint(run, *arguments):
    """Run bad input and return its one message."""
    code, out, err = run(*arguments)
    assert code == 2, err
    assert out == ""
    assert "Traceback" not in err
    return " ".join(err.split())


def test_version_names_the_package(run):
    code, out, _ = run("--version")
    assert code == 0
    assert out.startswith("stickslip ")


def test_models_lists_every_registered_law(run):
    _, out, _ = run("models", "--json")
    names = [law["name"] for law in json.loads(out)["laws"]]
    assert names == list(LAWS)
    _, out, _ = run("models")
    assert all(name in out for name in names)


def test_models_shows_a_mechanism_with_its_parameters(run):
    code, out, _ = run("models", "capsule")
    assert code == 0
    assert "inner_mass    m       kg     above 0 kg" in out
    assert "drive: What moves the inner mass" in out
    told = json.loads(run("models", "serial-arm", "--json")[1])
    assert told["contacts"] == "joint-1, joint-2, ..."
    assert [*told["fields"]] == ["links"]
    assert "Did you mean 'capsule'" in run("models", "capsul")[2]


def test_an_existing_folder_is_refused_before_work_begins(run, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "old").mkdir()
    monkeypatch.setattr("stickslip.cli.studies.audit", lambda *_, **__: pytest.fail("work began"))
    code, _, err = run("paper", "-o", "old")
    assert (code, "old already exists; give --force" in err) == (2, True)
    with pytest.raises(pytest.fail.Exception, match="work began"):
        run("paper", "-o", "new")


def test_models_names_the_parameter_that_another_must_not_fall_below(run):
    _, out, _ = run("models", "stribeck", "--json")
    ranges = {name: about["range"] for name, about in json.loads(out)["parameters"].items()}
    assert ranges["static_coefficient"] == "at least 0 and at least kinetic_coefficient"
    _, out, _ = run("models", "stribeck")
    assert "kinetic_coefficient" in out.partition("static_coefficient")[2]


def test_models_published_names_defect_and_cure(run):
    _, out, _ = run("models", "--published")
    heads = [line.partition(" ")[0] for line in out.splitlines() if line.startswith("(")]
    assert heads == [f"({number})" for number in range(1, 12)]
    assert out.count("defect: ") == 9
    assert out.count("correct as printed: ") == 2
    assert "sgn 0 = 0" in out
    # formulas to be read, not LaTeX: each sign that the paper prints, in Unicode
    assert re.findall(r"[\\{}$]", out) == []
    assert "    F_v = F_c + (F_s − F_c) e^(−ẋ/ẋ_s) + μ ẋ\n" in out
    assert "    F_f = ⎧ F_d = σ₀ Z sgn(ẋ)  (ẋ ≠ 0)\n          ⎩ F_x                (ẋ = 0)\n" in out
    assert "    ½ k x² = μ m g s\n" in out
    told = json.loads(run("models", "--published", "--json")[1])["printed"]
    assert [form["equation"] for form in told] == heads
    assert [form["equation"] for form in told if form["name"] is None] == ["(2)", "(11)"]
    assert not any("$" in form[key] for form in told for key in ("defect", "right", "cure"))


@pytest.mark.parametrize("law", [*LAWS, *PRINTED_FORMS])
def test_the_formula_of_a_law_is_text_and_not_latex(run, law):
    _, out, _ = run("models", law)
    assert re.findall(r"[\\{}$]", out) == []


def test_simulate_prints_one_json_document(run):
    _, out, _ = run("simulate", "demo", "--json", "--set", "mechanism.attached=true")
    content = json.loads(out)
    assert content["schema"] == "stickslip/simulate/1"
    # PHYSICS: rest at .0981 m
    assert content["final"]["x"] == pytest.approx(0.0981, rel=1e-9)
    assert content["certificate"]["certified"] is True


@pytest.mark.parametrize("suffix", ["csv", "parquet"])
def test_simulate_exports_what_it_ran(run, tmp_path, suffix):
    code, _, _ = run("simulate", "demo", "-o", f"run.{suffix}", "--samples", "11")
    assert code == 0
    read = pd.read_csv if suffix == "csv" else pd.read_parquet
    frame = read(tmp_path / f"run.{suffix}")
    names = {"t": "s", "x": "m", "v": "m/s", "friction": "N", "normal_force": "N"}
    # a Parquet file has plain names
    headers = [f"{name} [{unit}]" for name, unit in names.items()] if suffix == "csv" else names
    assert list(frame.columns) == [*headers, "mode"]
    assert len(frame) == 11


def test_a_run_for_matlab_has_a_variable_for_each_column_and_their_units(run, tmp_path):
    def written(name):
        code, _, err = run("simulate", "demo", "-o", name, "--samples", "11")
        assert code == 0, err
        return (tmp_path / name).read_bytes()

    assert written("run.mat") == written("other.mat")
    content = loadmat(tmp_path / "run.mat", simplify_cells=True)
    assert content["x"].shape == content["t"].shape == (11,)
    assert content["units"] == {
        "t": "s", "x": "m", "v": "m/s", "friction": "N", "normal_force": "N", "mode": "1",
    }  # fmt: skip
    assert content["x"][-1] == pytest.approx(0.203874, abs=1e-6)


def test_an_export_is_never_overwritten_without_force(run, tmp_path):
    (tmp_path / "run.csv").write_text("mine")
    assert "--force" in complaint(run, "simulate", "demo", "-o", "run.csv")
    assert (tmp_path / "run.csv").read_text() == "mine"
    code, _, _ = run("simulate", "demo", "-o", "run.csv", "--force")
    assert code == 0
    assert (tmp_path / "run.csv").read_text() != "mine"


def test_a_fixed_step_run_claims_no_check_that_was_not_made(run):
    _, out, _ = run("simulate", "demo", "--fixed-step", "0.01", "--t-end", "1")
    assert "Mismatch" in out
    assert "violation" not in out
    assert "Drift at rest" not in out
    _, out, _ = run("simulate", "demo", "--fixed-step", "0.01", "--t-end", "1", "--json")
    certificate = json.loads(out)["certificate"]
    assert certificate["guard_violation"] is None
    assert certificate["stick_drift"] is None
    assert certificate["energy_error"] > 0


PUSHED = """
[mechanism]
type = "spring-block"
mass = 1.0
[mechanism.drive]
type = "pulse"
level = 10.0
duration = 0.1
[friction]
law = "coulomb"
kinetic_coefficient = 0.25
static_coefficient = 0.35
"""


@pytest.mark.parametrize(
    ("options", "travel"),
    [
        # the first of ten steps of 10 ms takes 0, .25 or .35 of 9.81 N from 10 N
        (("--break-away", "zero"), 0.163895),
        (("--break-away", "kinetic"), 0.153895),
        ((), 0.149971),
        # (3) drives the block backwards once it has stopped; a stick rule is not printed
        (("--law", "printed-3"), -0.244708),
        (("--law", "printed-3", "--stick-rule"), 0.163895),
    ],
)
def test_rules_for_rest_of_fixed_steps_are_options(run, tmp_path, options, travel):
    (tmp_path / "pushed.toml").write_text(PUSHED)
    steps = ("--fixed-step", "0.01", "--t-end", "1", "--json")
    code, out, err = run("simulate", "pushed.toml", *steps, *options)
    assert code == 0, err
    assert json.loads(out)["final"]["x"] == pytest.approx(travel, abs=5e-7)


def test_a_printed_equation_is_named_once_and_said_to_move_at_the_end(run):
    steps = ("--fixed-step", "0.001", "--t-end", "1")
    _, out, _ = run("simulate", "demo", "--law", "printed-3", *steps)
    assert "eq. (3) as printed: improved friction model of [7]\n" in out
    assert "Reached the end time. The body still moves then, at " in out
    _, out, _ = run("simulate", "demo", "--law", "printed-3", "--stick-rule", *steps)
    assert "still moves" not in out


def test_no_output_shows_a_negative_zero(run, tmp_path):
    backwards = ("simulate", "demo", "--set", "mechanism.compression=-0.1")
    _, out, _ = run(*backwards, "--json")
    assert not re.search(r"-0\.0\b(?!\d)", out)
    run(*backwards, "-o", "run.csv")
    assert not re.search(r"(^|,)-0\.0(,|$)", (tmp_path / "run.csv").read_text(), re.MULTILINE)


def test_enforced_criteria_fail_with_their_own_exit_code(run):
    code, _, err = run("simulate", "demo", "--set", "mechanism.attached=true", "--enforce")
    assert code == 4
    assert "moves backwards" in err
    assert run("simulate", "demo", "--enforce")[0] == 0


def test_select_prints_one_json_document(run, tmp_path):
    code, out, _ = run("select", "demo", "--laws", "coulomb,viscous", "--json")
    assert code == 0
    content = json.loads(out)
    assert content["schema"] == "stickslip/select/1"
    assert content["best"] == "coulomb"
    assert list(tmp_path.iterdir()) == []


def test_select_writes_the_folder_that_is_given_beside_the_document(run, rig, tmp_path):
    code, out, _ = run("select", rig(), "--laws", "coulomb", "--json", "-o", "own")
    assert code == 0
    assert json.loads((tmp_path / "own" / "verdict.json").read_text()) == json.loads(out)
    assert (tmp_path / "own" / "index.html").exists()
    (tmp_path / "own" / "notes.txt").write_text("mine")
    code, out, err = run("select", rig(), "--laws", "coulomb", "--json", "-o", "own")
    assert (code, out) == (2, "")
    assert "own already exists" in err


def test_select_replaces_its_own_report_and_no_folder_with_anything_else(run, rig, tmp_path):
    # not of the bundled rig, whose page has the audit of its paper too
    code, out, _ = run("select", rig(), "--laws", "coulomb,viscous")
    assert code == 0
    assert "mu_k = 0.25" in out
    page = (tmp_path / "rig-report" / "index.html").read_text(encoding="utf-8")
    assert page.startswith("<!doctype html>")
    json.loads((tmp_path / "rig-report" / "verdict.json").read_text(encoding="utf-8"))
    assert run("select", "rig.toml", "--laws", "coulomb")[0] == 0
    assert "viscous" not in (tmp_path / "rig-report" / "verdict.json").read_text(encoding="utf-8")
    law = ("rig-report/law.toml", "--laws", "coulomb", "-o", "rig-report")
    assert "law.toml is read by this command" in complaint(run, "select", *law)
    (tmp_path / "rig-report" / "notes.txt").write_text("mine")
    assert "--force" in complaint(run, "select", "rig.toml", "--laws", "coulomb")
    assert (tmp_path / "rig-report" / "notes.txt").read_text() == "mine"


def test_cite_prints_the_sources_of_the_laws_asked_for(run):
    _, out, _ = run("cite", "lugre")
    assert "Canudas de Wit" in out
    assert "Dahl" not in out


BAD = [
    (["select", "nowhere.toml"], "nowhere.toml"),
    (["select", "demo", "--laws", "coulom"], "Did you mean 'coulomb'"),
    (["select", "demo", "--laws", ""], "--laws takes names of laws with commas between them"),
    (["select", "demo", "--data", "nowhere.csv"], "nowhere.csv"),
    (["select", "demo", "--set", "mechanism.mass=0"], "above 0 kg"),
    (["select", "demo", "--set", "mechanism.mass=-1 kg"], "above 0 kg"),
    (["select", "demo", "--set", "mechanism.mass=1 furlong"], "mass"),
    (["select", "demo", "--set", "mechanism.mass=heavy"], "mass"),
    (["select", "demo", "--set", "mechanism.mass=nan"], "mass"),
    (["select", "demo", "--set", "mechanism.mass=inf"], "mass"),
    (["select", "demo", "--set", "mechanism.masss=1"], "Did you mean 'mass'"),
    (["select", "demo", "--set", "mechanism.stiffness=0"], "no spring to compress"),
    (
        ["simulate", "demo", "--law", "stribeck", "--set", "friction.exponent=1"],
        "parameter of stribeck in --set: 'exponent'. Did you mean 'fading_exponent' (n)?",
    ),
    (
        ["simulate", "demo", "--set", "mu=.3"],
        "'mu'. Did you mean 'static_coefficient' (mu_s) or 'kinetic_coefficient' (mu_k)?",
    ),
    (["fit", "demo", "--set", "mu_z=.3"], "Did you mean 'static_coefficient' (mu_s) or 'kinetic"),
    (["plan", "demo", "--set", "zzz=1"], "compression (x_0), "),
    (["select", "demo", "--set", "nonsense"], "PATH=VALUE"),
    (["simulate", "demo", "--law", "stribek"], "Did you mean 'stribeck'"),
    (["simulate", "demo", "--law", "printed-5"], "give a step in seconds, such as --fixed-step"),
    (["simulate", "demo", "--break-away", "zero"], "--break-away is for --fixed-step"),
    (["simulate", "demo", "--no-stick-rule"], "--no-stick-rule is for --fixed-step"),
    (["simulate", "demo", "--stick-rule"], "--stick-rule is for --fixed-step"),
    (["simulate", "demo", "--method", "heun"], "--method is for --fixed-step"),
    (["fit", "demo", "--law", "printed-7"], "only `stickslip simulate --law printed-7"),
    (
        ["simulate", "demo", "--law", "printed-7", "--fixed-step", "0.01", "--set", "friction.z=1"],
        "names no parameter of printed-7, which has kinetic_coefficient",
    ),
    (
        ["paper", "--set", "mas=3"],
        "unknown parameter 'mas'. Known: cart.ball_mass (m), cart.cart_mass (M)",
    ),
    (["paper", "--set", "cart_mass=-1"], "--set cart_mass (M) must be above 0 kg, got -1"),
    (["simulate", "demo", "--t-end", "0"], "above 0 s"),
    (["simulate", "demo", "--t-end", "nan"], "t_end"),
    (["simulate", "demo", "--fixed-step", "-1"], "above 0 s"),
    (
        ["simulate", "demo", "--fixed-step", "0.1", "--method", "leapfrog"],
        "euler, semi-implicit, heun, rk4",
    ),
    (["simulate", "demo", "-o", "run.txt"], ".csv, .parquet or .mat"),
    (["models", "coulombs"], "Did you mean 'coulomb'"),
    (["cite", "newton"], "unknown friction law"),
]


@pytest.mark.parametrize(("arguments", "fragment"), BAD, ids=lambda value: str(value)[:50])
def test_bad_input_gives_one_message_and_leaves_nothing(run, tmp_path, arguments, fragment):
    assert fragment in complaint(run, *arguments)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("content", [b"", b"\xff\xfe\x00", b"title = ", b"[mechanism]\ntype = 1\n"])
def test_a_broken_rig_file_is_named(run, tmp_path, content):
    (tmp_path / "rig.toml").write_bytes(content)
    assert "rig.toml" in complaint(run, "select", "rig.toml")


def test_a_report_cannot_replace_a_file(run, tmp_path):
    (tmp_path / "taken").write_text("mine")
    assert "taken" in complaint(
        run, "select", "demo", "--laws", "coulomb", "-o", "taken", "--force"
    )
    assert (tmp_path / "taken").read_text() == "mine"


def test_an_interrupt_ends_with_130_and_one_line(run, monkeypatch):
    import stickslip.cli.judge as command

    def interrupted(*_arguments, **_options):
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "_selected", interrupted)
    code, out, err = run("select", "demo", "--json")
    assert (code, out) == (130, "")
    assert "Cancelled" in err


RIG = """
title = "[/b] :smile: x"
[mechanism]
type = "spring-block"
mass = 1.0
stiffness = {stiffness}
compression = {compression}
[friction]
kinetic_coefficient = 0.25
[[trial]]
travel = {travel}
uncertainty = {uncertainty}
initial = {{ v = "{v} m/s" }}
"""


@pytest.fixture
def rig(tmp_path):
    """Write a rig file and return its name."""
    ordinary = {"stiffness": 100.0, "compression": 0.1, "travel": 0.2, "uncertainty": 0.01, "v": 0}

    def write(**changes):
        (tmp_path / "rig.toml").write_text(RIG.format(**(ordinary | changes)))
        return "rig.toml"

    return write


def test_a_reason_that_looks_like_markup_is_printed_as_it_is(capsys):
    from stickslip.cli.console import note, show_table

    show_table("[/b] title", ["[/i] head"], [["[/b] cell"]])
    note("[/b] reason")
    seen = capsys.readouterr()
    assert "[/b] title" in seen.out
    assert "[/i] head" in seen.out
    assert "[/b] cell" in seen.out
    assert seen.err == "[/b] reason\n"


def test_the_schema_has_the_head_of_every_document(run):
    content = json.loads(run("schema")[1])
    assert content["schema"] == "stickslip/rig-schema/1"
    assert content["stickslip"]
    assert content["$schema"].startswith("https://json-schema.org/")


def test_where_no_law_fits_that_is_said_and_nothing_is_written(run, rig, tmp_path):
    # released at 1 m/s at most, the block cannot come so far in 10 s
    code, out, err = run("select", rig(travel=50.0), "--laws", "coulomb", "-o", "report")
    assert (code, out) == (2, "")
    assert "no law can be fitted to these travels" in err
    assert not (tmp_path / "report").exists()


def test_simulate_starts_as_the_first_trial_does(run, rig):
    thrown = rig(stiffness=0.0, compression=0.0, v=3)
    content = json.loads(run("simulate", thrown, "--json", "--t-end", "3")[1])
    # v^2 / (2 mu g)
    assert content["final"]["x"] == pytest.approx(9.0 / (2 * 0.25 * 9.81), rel=1e-9)


def test_a_rig_with_values_for_several_laws_says_which_one_is_run(run):
    _, out, err = run("simulate", "demo", "--t-end", "0.1")
    assert "Coulomb" in out
    assert "has values for several laws; coulomb is used" in " ".join(err.split())
    _, _, err = run("simulate", "demo", "--t-end", "0.1", "--law", "stribeck")
    assert "several laws" not in err


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is full")
@pytest.mark.parametrize(
    "command",
    [
        pytest.param(["simulate", "demo", "--law", "stribeck"], marks=pytest.mark.slow),
        ["schema"],
        ["--version"],
    ],
)
def test_a_full_device_is_one_message_and_exit_code_2(command):
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-c", "from stickslip.cli import main; main()", *command],
            stdout=full, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr == "stickslip: cannot write: No space left on device.\n"


def unread(*command, folder=".", both=False, **environment):
    """Run a command whose output nobody reads; return its exit code and what else it says."""
    read, write = os.pipe()
    os.close(read)
    done = subprocess.run(
        [sys.executable, "-m", "stickslip", *command],
        cwd=folder, stdout=write, stderr=write if both else subprocess.PIPE, text=True, check=False,
        env={**os.environ, **environment},
    )  # fmt: skip
    os.close(write)
    return done.returncode, done.stderr


@pytest.mark.parametrize("buffered", ["", pytest.param("1", marks=pytest.mark.slow)])
def test_a_reader_that_leaves_early_is_no_error(buffered):
    assert unread("schema", PYTHONUNBUFFERED=buffered) == (0, "")
    assert unread("schema", "--nonsense", both=True, PYTHONUNBUFFERED=buffered) == (2, None)


UNWRITABLE = ["taken/report", *(["/proc/report"] if Path("/proc/self").exists() else [])]


@pytest.mark.parametrize("output", UNWRITABLE)
@pytest.mark.parametrize("command", ["demo", "paper"])
def test_an_output_that_cannot_be_written_is_refused_before_the_work(
    run, tmp_path, monkeypatch, command, output
):
    import stickslip.cli.judge
    import stickslip.cli.studies

    def never(*_arguments, **_options):
        raise AssertionError("the work began")

    monkeypatch.setattr(stickslip.cli.judge, "_selected", never)
    monkeypatch.setattr(stickslip.cli.studies, "audit", never)
    (tmp_path / "taken").write_text("mine")
    assert "cannot be written" in complaint(run, command, "-o", output)
    assert "cannot be written" in complaint(run, "simulate", "demo", "-o", f"{output}/run.csv")
    assert [path.name for path in tmp_path.iterdir()] == ["taken"]


@pytest.mark.slow
def test_force_replaces_a_report_but_no_file_of_the_user(run, rig, tmp_path):
    select = ("select", rig(), "--laws", "coulomb", "--force")
    folder = tmp_path / "rig-report"
    folder.mkdir()
    (folder / "law.toml").write_text("mine")
    assert "law.toml was not written by stickslip" in complaint(run, *select)
    (folder / "law.toml").rename(folder / "own.toml")
    assert run(*select)[0] == 0
    assert run(*select)[0] == 0
    names = {path.name for path in folder.glob("[!.]*")}
    assert names == {"draws.json", "index.html", "verdict.json", "law.toml", "own.toml"}
    assert (folder / "own.toml").read_text() == "mine"
    (folder / "index.html").write_text("edited")
    assert "index.html was changed since" in complaint(run, *select)
    assert (folder / "index.html").read_text() == "edited"
    report = ("simulate", "rig.toml", "--report-to", "rig-report", "--force")
    assert "index.html was changed since" in complaint(run, *report)
    (folder / "index.html").unlink()
    assert run(*report)[0] == 0
    assert {path.name for path in folder.glob("[!.]*")} == names  # the verdict and its law stay


@pytest.mark.slow
def test_a_page_that_is_drawn_while_the_process_is_killed_costs_no_earlier_report(
    run, rig, tmp_path
):
    """Verdict, law and page of one report appear in one step."""
    kill = "import os, stickslip.cli.judge as s"
    kill += "; s.kinds.verdict_page = lambda *_, **__: os.kill(os.getpid(), 9)"
    go = "from stickslip.cli import main"
    go += "; main(['select', 'rig.toml', '--laws', 'coulomb'])"
    rig()  # another page than that of the paper's rig, which takes longer by the paper's audit
    assert run("select", "rig.toml", "--laws", "coulomb")[0] == 0
    folder = tmp_path / "rig-report"
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    done = subprocess.run(
        [sys.executable, "-c", f"{kill}; {go}"], cwd=tmp_path, capture_output=True, check=False
    )
    assert done.returncode == -9
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    assert run("select", "rig.toml", "--laws", "coulomb")[0] == 0


@pytest.mark.slow
def test_a_reader_who_has_seen_enough_costs_no_verdict(rig, tmp_path):
    """``stickslip select | head`` leaves the law for the next command."""
    folder = tmp_path / "rig-report"
    write_folder(folder, {"verdict.json": "{}"})  # an older one, which is replaced
    code, told = unread("select", rig(), "--laws", "coulomb", folder=tmp_path)
    assert (code, "Traceback" in told) == (0, False), told
    assert {path.name for path in folder.glob("[!.]*")} >= {
        "verdict.json",
        "law.toml",
        "index.html",
    }
    assert json.loads((folder / "verdict.json").read_text())
