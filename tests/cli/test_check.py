"""``stickslip check``: sentences, marks, exit codes, pictures."""

import json
import subprocess
import sys

import numpy as np
import pytest
from tests.commands import commands

TIME = np.arange(2000) / 1000


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run a command in an empty folder; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)
    return commands(capsys, "check", one_line=True)


@pytest.fixture
def write(tmp_path):
    def writer(name="data.csv", **columns):
        rows = zip(*columns.values(), strict=True)
        lines = [",".join(columns), *(",".join(map(repr, map(float, row))) for row in rows)]
        (tmp_path / name).write_text("\n".join(lines) + "\n")
        return name

    return writer


def good(**changes):
    position = 0.05 * np.sin(2 * np.pi * TIME)
    force = 20 * np.sign(np.cos(2 * np.pi * TIME)) + np.sin(7 * TIME)
    return {"t": TIME, "q": 1000 * position, "u": force / 35.0, **changes}


COLUMNS = ("--columns", "time=t,position=q", "--columns", "force=u")
SCALES = ("--unit", "position=mm", "--gain", "force=35")


def test_the_sentences_of_a_good_record_are_printed(run, write):
    code, out, _ = run(write(**good()), *COLUMNS, *SCALES)
    assert code == 0
    assert "  2,000 samples at 1 kHz over 2 s, evenly spaced" in out
    assert "largest speed of 0.314 m/s" in out  # 0.05 m times 2 pi


@pytest.mark.slow
def test_kinds_are_not_loaded_where_no_trial_has_a_condition(write, tmp_path):
    line = ["check", write(**good()), *COLUMNS, *SCALES]
    program = f"""
import sys
from stickslip.cli import main
try:
    main({line!r})
finally:
    print("stickslip.identify.kinds.registry" in sys.modules)
"""
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, cwd=tmp_path, check=True
    )
    assert done.stdout.splitlines()[-1] == "False"  # they take longer than the check


def test_an_error_is_marked_and_exits_with_two(run, write):
    code, out, err = run(write(**good(q=0 * TIME)), *COLUMNS)
    assert code == 2
    assert "✗ Position is constant: no motion was recorded." in out
    assert err == ""


def test_json_is_one_document(run, write):
    code, out, _ = run(write(**good()), *COLUMNS, *SCALES, "--json")
    content = json.loads(out)
    assert code == 0
    assert content["schema"] == "stickslip/check/1"
    assert content["findings"][0]["numbers"]["samples"] == 2000
    assert content["records"] == [{"name": "data", "provenance": "data.csv"}]


def test_repairs_are_said(run, write):
    data = {name: np.append(values, values[5]) for name, values in good().items()}
    file = write(**data)
    code, _, err = run(file, *COLUMNS)
    assert (code, "for a file, --repair sort does both" in err) == (2, True)
    code, out, _ = run(file, *COLUMNS, "--repair", "sort,gaps")
    assert code == 0
    assert "data.csv; sorted by time (1 sample out of order); dropped 1 exact duplicate" in out


def test_trials_have_one_line_each_and_the_last_line_says_what_to_correct(run, write):
    clipped = np.clip(np.sin(5.0 * TIME), -0.6, 0.6)
    files = [write(f"run{i}.csv", **good(u=i * clipped)) for i in (1, 2)]
    _, out, _ = run(*files, *COLUMNS, *SCALES)
    assert sum(line[2:].startswith(("run1:", "run2:")) for line in out.splitlines()) == 2
    assert " to look at: the findings marked ! (" in out.splitlines()[-1]
    assert "All findings of each trial: --json." in out
    _, out, _ = run(write(**good()), *COLUMNS, *SCALES)
    assert out.splitlines()[-1] == "Nothing to correct."
    code, out, _ = run(write(**good(q=0.0 * TIME)), *COLUMNS, *SCALES)
    assert (code, out.splitlines()[-1]) == (
        2,
        "To correct before a fit: the findings marked ✗ (constant).",
    )


@pytest.mark.slow
def test_the_overview_is_written_and_not_overwritten(run, write, tmp_path):
    file = write(**good())
    code, out, _ = run(file, *COLUMNS, *SCALES, "-o", "seen")
    assert code == 0
    assert "Findings and pictures: seen" in out
    assert (tmp_path / "seen/overview.png").read_bytes().startswith(b"\x89PNG")
    assert "velocity, m/s" in (tmp_path / "seen/overview.svg").read_text(encoding="utf-8")
    assert json.loads((tmp_path / "seen/checks.json").read_text())["worst"] == "info"
    code, _, err = run(file, *COLUMNS, "-o", "seen")
    assert (code, "--force" in err) == (2, True)
    assert run(file, *COLUMNS, "-o", "seen", "--force")[0] == 0


def test_readings_are_checked_without_a_picture(run, write, tmp_path):
    code, out, _ = run(write(travel=[0.1, 0.2]), "-o", "seen")
    assert code == 0
    assert "! 2 readings at 1 setting" in out
    assert [path.name for path in (tmp_path / "seen").glob("[!.]*")] == ["checks.json"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--columns", "position"), "--columns takes NAME=VALUE such as position=q_m"),
        (("--columns", "position=y"), "column of data.csv: 'y'"),
        ((*COLUMNS, "--gain", "force=big"), "--gain takes numbers such as force=35.15"),
        ((*COLUMNS, "--gain", "load=2"), "quantity in gain 'load'"),
        ((*COLUMNS, "--unit", "position=kg"), "must be in m"),
        ((*COLUMNS, "--repair", "all"), "unknown repair 'all'"),
        ((), "no column is named position"),
    ],
)
def test_bad_options_give_one_message(run, write, arguments, message):
    code, out, err = run(write(**good()), *arguments)
    assert (code, out) == (2, "")
    assert message in err


def test_megabytes_of_text_are_one_message(run, tmp_path):
    (tmp_path / "book.txt").write_text("Call me Ishmael, some years ago.\n" * 300_000)
    code, _, err = run("book.txt")
    assert code == 2
    assert "book.txt: is not a table" in err
    assert len(err) < 400


# --- with a rig


RIG = """
[mechanism]
type = "axis"
inertia = "5 kg"
[data]
file = "{file}"
columns = {{ time = "t", position = "q", force = "u" }}
units = {{ position = "mm" }}
gain = {{ force = {gain} }}
"""


@pytest.fixture
def rig(axis_record, write, tmp_path):
    """Write a record, in mm and tens of newtons, and the rig file that reads it."""

    def writer(gain=10.0, file="data.csv"):
        write(t=axis_record["t"], q=1e3 * axis_record["q"], u=axis_record["u"] / 10.0)
        (tmp_path / "rig.toml").write_text(RIG.format(gain=gain, file=file))
        return "rig.toml"

    return writer


def test_a_rig_file_has_the_mechanism_and_says_what_is_read(run, rig):
    code, out, _ = run(rig())
    assert (code, "Force is" in out) == (0, False)
    assert "  1,200 samples at 200 Hz" in out
    code, out, _ = run(rig(gain=200.0))
    assert "! Force is 21 times the force that this motion of the mechanism requires" in out
    # a force in amperes that passes for newtons: 300 times too small is an error
    code, out, err = run(rig(gain=0.01))
    assert (code, err) == (2, "")
    assert "✗ Force is 0.00" in out


def test_files_beside_a_rig_are_read_as_it_says(run, rig, tmp_path):
    file = rig()
    (tmp_path / "data.csv").rename(tmp_path / "second.csv")
    (tmp_path / "rig.toml").write_text(RIG.format(gain=10.0, file="").replace('file = ""', ""))
    code, out, err = run(file)
    assert (code, out) == (2, "")
    assert "rig.toml has no measurement" in err
    assert run(file, "second.csv")[:2] == run("second.csv", file)[:2]
    assert "Force is" not in run(file, "second.csv")[1]
    assert "Force is 21 times" in run(file, "second.csv", "--gain", "force=200")[1]


def test_options_of_columns_need_a_file_of_data(run, rig):
    code, _, err = run(rig(), "--gain", "force=2")
    assert (code, "name one beside rig.toml" in err) == (2, True)
    code, _, err = run("rig.toml", "rig.toml")
    assert (code, "one rig file" in err) == (2, True)


def test_a_fault_of_what_a_rig_reads_names_keys_of_a_rig_file(run, rig, tmp_path):
    file = rig()
    (tmp_path / "data.csv").write_text("a,b\n0,1\n1,2\n")
    path = tmp_path / "rig.toml"
    path.write_text("\n".join(path.read_text().splitlines()[:6]))
    code, _, err = run(file)
    assert code == 2
    assert 'columns = { position = "..." }' in err
    assert "--columns position=..." in run("data.csv")[2]


def test_a_mechanism_of_one_s_own_needs_leave(run, tmp_path):
    (tmp_path / "rig.toml").write_text('[mechanism]\ntype = "own:Slide"\n')
    code, _, err = run("rig.toml")
    assert (code, "--allow-import" in err) == (2, True)


def test_hundreds_of_trials_take_a_screen(run, write):
    rows = {"trial": np.repeat(np.arange(300), 41), "t": np.tile(6.0 * np.arange(41), 300)}
    random = np.random.default_rng(1)
    rows["v"] = np.abs(np.tile(np.linspace(-5.0, 5.0, 41), 300) + 0.2 * random.normal(size=12300))
    rows["F"] = 70.0 + rows["v"] + random.normal(size=12300)
    columns = ("time=t", "velocity=v", "friction=F")
    code, out, _ = run(write(**rows), *(f"--columns={one}" for one in columns))
    assert code == 0
    lines = out.splitlines()
    assert len(lines) < 40
    assert max(map(len, lines)) < 400
    assert "All findings of each trial: --json." in lines


def test_memory_that_ends_is_a_sentence(run, write, monkeypatch):
    def spent(*_, **__):
        raise MemoryError("Unable to allocate 41.3 GiB for an array")

    monkeypatch.setattr("stickslip.cli.check.check", spent)
    code, _, err = run(write(**good()), "--columns=time=t", "--columns=position=q")
    assert code == 2
    assert "not enough memory (Unable to allocate 41.3 GiB" in err


@pytest.mark.parametrize(("sign", "code"), [(1.0, 0), (-1.0, 2)])
def test_a_force_of_the_wrong_sign_is_an_error_without_a_mechanism(run, write, sign, code):
    v, a = 0.2 * np.pi * np.cos(np.pi * TIME), -0.2 * np.pi**2 * np.sin(np.pi * TIME)
    force = sign * (2.0 * a + 5.0 * np.sign(v) + 3.0 * v)
    force += 0.02 * np.random.default_rng(0).normal(size=len(TIME))
    file = write(t=TIME, q=0.2 * np.sin(np.pi * TIME), u=force)
    found, out, _ = run(file, *COLUMNS)
    assert (found, "friction would drive the motion" in out) == (code, sign < 0.0)
