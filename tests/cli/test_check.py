"""``stickslip check``: sentences, marks, exit codes, pictures."""

import json

import numpy as np
import pytest

from stickslip.cli import main

TIME = np.arange(2000) / 1000


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run a command in an empty folder; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments):
        try:
            code = main(["check", *arguments])
        except SystemExit as leaving:
            code = leaving.code or 0
        seen = capsys.readouterr()
        return code, seen.out, " ".join(seen.err.split())

    return call


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


def test_warnings_are_marked_and_no_failure(run, write):
    code, out, _ = run(write(**good(q=1000 * TIME)), *COLUMNS, *SCALES)
    assert code == 0
    assert "! No reversals: the motion goes forward only" in out


def test_an_error_is_marked_and_exits_with_two(run, write):
    code, out, err = run(write(**good(q=0 * TIME)), *COLUMNS)
    assert code == 2
    assert "✗ Position never changes: no motion was recorded." in out
    assert err == "No fit should be made from this as it is."


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
    assert (code, 'repair="sort"' in err) == (2, True)
    code, out, _ = run(file, *COLUMNS, "--repair", "sort,gaps")
    assert code == 0
    assert "data.csv; sorted by time (1 sample was late); 1 exact double dropped" in out


def test_several_files_are_checked_as_trials(run, write, tmp_path):
    files = [write(f"run{i}.csv", **good(u=0.01 * i * TIME)) for i in (1, 2)]
    _, out, _ = run(*files, *COLUMNS, *SCALES, "-o", "seen")
    assert "  run1: 2,000 samples" in out
    assert "  run2: 2,000 samples" in out
    assert {path.name for path in (tmp_path / "seen").iterdir()} == {
        "checks.json", "overview-1.svg", "overview-1.png", "overview-2.svg", "overview-2.png",
    }  # fmt: skip


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
    assert [path.name for path in (tmp_path / "seen").iterdir()] == ["checks.json"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--columns", "position"), "--columns takes NAME=VALUE such as position=q_m"),
        (("--columns", "position=y"), "column of data.csv: 'y'"),
        ((*COLUMNS, "--gain", "force=big"), "--gain takes numbers such as force=35.15"),
        ((*COLUMNS, "--gain", "load=2"), "quantity in gain 'load'"),
        ((*COLUMNS, "--unit", "position=kg"), "must be in m"),
        ((*COLUMNS, "--repair", "all"), "unknown repair 'all'"),
        ((), "no column is called position"),
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
    assert "book.txt: is no table" in err
    assert len(err) < 400
