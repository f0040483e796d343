"""``stickslip data``: what there is, one record in full, the path of a table."""

import json

import pandas as pd
import pytest
from tests.commands import commands
from tests.upstream import TEXT, Upstream, text_record

from stickslip.data import catalogue


@pytest.fixture
def run(capsys, monkeypatch, tmp_path):
    """Run a command with nothing but an empty cache; return exit code, stdout and stderr."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("STICKSLIP_DATA_URL", "http://127.0.0.1:9")  # nobody listens there
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    monkeypatch.setenv("COLUMNS", "100")
    monkeypatch.delenv("STICKSLIP_DATA", raising=False)
    return commands(capsys, "data")


@pytest.fixture
def slide(run, monkeypatch):
    """A record that a server on this machine has."""
    monkeypatch.setattr("stickslip.cli.check.dataset", lambda name: text_record())
    with Upstream() as upstream:
        upstream.offer("data/a%20slide.txt", TEXT.encode())
        monkeypatch.setenv("STICKSLIP_DATA_URL", upstream.address)
        yield upstream


def test_list_names_every_record_with_its_licence_and_place(run):
    code, out, _ = run("list")
    assert code == 0
    lines = {line.split()[0]: line for line in out.splitlines() if line[:1].isalpha()}
    assert set(catalogue.names()) <= set(lines)
    assert "none stated" in lines["emps"]
    assert lines["emps"].rstrip().endswith("to download")
    assert lines["modelica_brake"].rstrip().endswith("by hand")


def test_list_as_json_has_every_record_in_full(run):
    _, out, _ = run("list", "--json")
    found = json.loads(out)
    assert found["schema"] == "stickslip/data/1"
    assert [record["name"] for record in found["records"]] == list(catalogue.names())
    (axis,) = [entry for entry in found["records"] if entry["name"] == "emps"]
    assert axis["files"]["train"]["where"] == "to download"


def test_show_has_licence_columns_checksums_and_results(run):
    record = catalogue.dataset("emps")
    code, out, _ = run("show", "emps")
    assert code == 0
    assert record.licence in out
    assert record.citation in out
    assert record.commit in out
    assert all(column.name in out for column in record.columns)
    assert "35.1506518825" in out
    assert record.file().sha256 in out
    assert record.file().source_sha256 in out
    assert "M_kg = 95.1089" in out
    assert "Butterworth" in out


def test_show_as_json_has_gains_and_what_is_known_of_a_file(run):
    _, out, _ = run("show", "spring_pulled_slider", "--json")
    found = json.loads(out)
    # weight of the slider: 0.0307 kg times 9.81 m/s2
    assert found["columns"][1]["gain"] == pytest.approx(0.0307 * 9.81, rel=1e-15)
    assert found["files"]["k168_v42"]["known"]["stiffness_N_per_m"] == 168.0


def test_path_prints_nothing_but_the_path_and_says_on_stderr_what_is_downloaded(run, slide):
    code, out, err = run("path", "slide")
    assert code == 0
    assert len(pd.read_parquet(out.rstrip("\n"))) == 4
    assert "Downloading a slide.txt" in err
    assert run("path", "slide") == (0, out, "")


def test_path_takes_a_file_and_gives_json(run, slide):
    _, out, _ = run("path", "slide", "--file", "all", "--json")
    found = json.loads(out)
    assert (found["name"], found["file"]) == ("slide", "all")
    assert len(pd.read_parquet(found["path"])) == 6


def test_what_is_odd_about_a_table_is_said_on_stderr(run, slide, monkeypatch, tmp_path):
    record = text_record(TEXT.encode() + b"0.6\t107\n")
    slide.offer("data/a%20slide.txt", TEXT.encode() + b"0.6\t107\n")
    monkeypatch.setattr("stickslip.cli.check.dataset", lambda name: record)
    code, out, err = run("path", "slide", "--file", "all")
    assert code == 0
    assert out.endswith("all.parquet\n")
    assert "7 rows" in " ".join(err.split())


@pytest.mark.parametrize(
    ("arguments", "fragment"),
    [
        (["show", "emsp"], "Did you mean 'emps'?"),
        (["path", "emsp"], "Did you mean 'emps'?"),
        (["path", "emps", "--file", "trian"], "Did you mean 'train'?"),
        (["path", "emps"], "DATA_EMPS.mat could not be downloaded"),
        (["path", "modelica_brake"], "STICKSLIP_DATA"),
    ],
)
def test_bad_input_gives_one_message(run, arguments, fragment):
    code, out, err = run(*arguments)
    assert code == 2
    assert out == ""
    assert fragment in " ".join(err.split())
    assert "Traceback" not in err
