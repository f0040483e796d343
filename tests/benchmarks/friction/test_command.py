"""The command of the friction benchmark: tasks, page, tables, and one message of what is wrong."""

import json

import pandas as pd
import pytest
from benchmarks.friction.__main__ import main

TASKS = ("rock", "siconos-oscillator")


def call(*arguments):
    return main([*map(str, arguments)])


def test_tasks_are_listed(capsys):
    assert call("--list", "--json") == 0
    rows = json.loads(capsys.readouterr().out)["tasks"]
    assert {"emps", "tx40", "servo"} <= {row["name"] for row in rows}
    assert all(row["licence"] and row["fitted"] and row["judged"] and row["metric"] for row in rows)


@pytest.mark.slow
def test_a_folder_gets_a_page_a_table_and_a_document(data_dir, tmp_path, capsys):
    assert call(*TASKS, "--peers", "scipy", "-o", tmp_path) == 0
    shown = capsys.readouterr()
    table = pd.read_csv(tmp_path / "results.csv")
    assert list(dict.fromkeys(table["task"])) == list(TASKS)
    assert {*table["tool"]} == {"stickslip", "scipy"}
    ours = table[(table["task"] == "rock") & (table["tool"] == "stickslip")].set_index("law")
    (named,) = ours.index[ours["named"]]
    # which of the laws with a transient holds, one step does not say; that there is one, it does
    assert ours.loc[named, "error"] < 0.2 * ours.loc["constant-coefficient", "error"]
    page = (tmp_path / "index.html").read_text()
    for said in ("Sepiolite", "MIT", "Giacomel", "Siconos", "SciPy curve_fit"):
        assert said in page
    assert ours.loc[named, "title"] in shown.out
    assert call(*TASKS, "--peers", "scipy", "-o", tmp_path, "--json") == 0
    assert json.loads(capsys.readouterr().out)["made"] == 0


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["emsp"], "unknown task of the benchmark 'emsp'"),
        (["rock", "--peers", "spicy"], "unknown peer of the benchmark 'spicy'"),
    ],
)
def test_bad_input_gets_one_message(given, said, data_dir, tmp_path, capsys):
    assert call(*given, "-o", tmp_path / "out") == 2
    assert said in capsys.readouterr().err


def test_a_task_without_its_record_is_left_out(monkeypatch, tmp_path, capsys):
    monkeypatch.setenv("STICKSLIP_DATA", str(tmp_path))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert call("tx40", "-o", tmp_path / "out") == 2
    told = capsys.readouterr().err
    assert "tx40: left out" in told
    assert "there is no record for any of the tasks" in told
    assert not (tmp_path / "out").exists()
