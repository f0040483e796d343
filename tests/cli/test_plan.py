"""``stickslip plan``: what to measure next, and the way back through ``stickslip select``."""

import json

import numpy as np
import pytest

from stickslip.cli import main

RIG = """
title = "Own block"
[mechanism]
type = "spring-block"
mass = { value = "0.82 kg", uncertainty = "2 g" }
stiffness = { value = "145 N/m", uncertainty = "1 %" }
compression = { value = "80 mm", uncertainty = "0.3 mm" }
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """Write the rig of somebody who has measured no travel yet."""
    (tmp_path / "rig.toml").write_text(RIG)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def run(folder, capsys):
    """Run a command as the console script does; return exit code, stdout and stderr."""

    def one(*arguments):
        with pytest.raises(SystemExit) as leaving:
            main(arguments)
        out, err = capsys.readouterr()
        return leaving.value.code, out, err

    return one


@pytest.mark.slow
def test_readings_are_written_in_the_code_page_of_the_rig(run, folder, table):
    text = (folder / "table.csv").read_text().replace("friction [N]", "Größe")
    (folder / "table.csv").write_bytes(text.encode("cp1252"))
    (folder / "old.toml").write_text(
        '[mechanism]\ntype = "axis"\ninertia = "1 kg"\n[data]\nfile = "table.csv"\n'
        'columns = { velocity = "velocity [m/s]", friction = "Größe" }\n'
        '[data.layout]\nencoding = "cp1252"\n'
    )
    asked = ("plan", "old.toml", "--readings", "2", "-o", "next.csv")
    assert run(*asked)[0] == 0
    head, *rows = (folder / "next.csv").read_bytes().decode("cp1252").splitlines()
    assert "Größe" in head
    assert run(*asked, "--force")[0] == 0  # nothing was filled in
    filled = [row + "2.3" * row.endswith(",") for row in rows]
    (folder / "next.csv").write_bytes("\n".join([head, *filled]).encode("cp1252"))
    code, _, err = run("check", "old.toml", "--data", "next.csv")
    assert code == 0, err
    assert run(*asked, "--force")[0] == 2


AXIS = '[mechanism]\ntype = "axis"\ninertia = "1 kg"\n'
SPEEDS = np.linspace(0.02, 0.4, 12)


@pytest.fixture
def table(folder):
    """Write a table of Stribeck friction with 3 % of noise, and the rig file of an axis."""
    (folder / "axis.toml").write_text(AXIS)
    random = np.random.default_rng(2)
    friction = 2.0 + 1.5 * np.exp(-((SPEEDS / 0.08) ** 2)) + 1.2 * SPEEDS
    friction *= 1.0 + 0.03 * random.normal(size=12)
    rows = [f"{v:.4f},{f:.4f}" for v, f in zip(SPEEDS, friction, strict=True)]
    (folder / "table.csv").write_text("\n".join(["velocity [m/s],friction [N]", *rows]) + "\n")


@pytest.mark.slow
def test_readings_of_a_table_are_planned_filled_in_and_selected(run, folder, table):
    asked = ("axis.toml", "--data", "table.csv", "--readings", "6", "-o", "next.csv", "--json")
    code, out, err = run("plan", *asked)
    assert code == 0, err
    content = json.loads(out)
    speeds = content["readings"]["velocity"]
    assert len(speeds) == 6
    assert 0.0199 < min(speeds) <= max(speeds) < 0.401
    low, middle, high = content["band_shrinks_to"]
    assert low < middle < high < 1.2
    assert 0.0 <= content["halves_or_decides"] <= 1.0
    head, *rows = (folder / "next.csv").read_text().splitlines()
    assert (head, len(rows)) == ("velocity [m/s],friction [N]", 18)
    assert rows[12:] == [f"{v:g}," for v in speeds]
    filled = [row + "2.3" * row.endswith(",") for row in rows]
    (folder / "next.csv").write_text("\n".join([head, *filled]) + "\n")
    assert run("check", "axis.toml", "--data", "next.csv")[0] == 0
    code, _, err = run("plan", *asked, "--force")
    assert (code, "next.csv has rows that the new table lacks" in err) == (2, True)
    for other in ("time,ch1,\n1,2,\n", "velocity [m/s],friction [N]\n0.1,2.0\n0.1,2.0\n"):
        (folder / "next.csv").write_text(other)
        assert run("plan", *asked, "--force")[0] == 2
        assert (folder / "next.csv").read_text() == other


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("-o", "table.csv", "--force"), "table.csv is read by this command"),
        (("-o", "sheet.pdf"), "written as a .csv file"),
        (("--laws", "culomb"), "culomb"),
    ],
)
def test_a_wrong_option_is_named(run, folder, table, options, said):
    before = (folder / "table.csv").read_text()
    code, _, err = run("plan", "axis.toml", "--data", "table.csv", *options)
    assert (code, said in " ".join(err.split())) == (2, True)
    assert (folder / "table.csv").read_text() == before


@pytest.mark.slow
def test_a_rig_file_of_init_reads_the_table_of_its_plan(run, folder, table):
    rows = np.loadtxt(folder / "table.csv", delimiter=",", skiprows=1)
    lines = [f"{1e3 * v:.5f};{1e-3 * f:.7f};35" for v, f in rows]
    text = "\n".join(["Speed (mm/s);Ff (kN);Temp (degC)", *lines]) + "\n"
    (folder / "own.csv").write_text(text.replace(".", ","))
    assert run("init", "own.csv")[0] == 0
    code, out, err = run(
        "plan", "own.toml", "--readings", "2", "-o", "next.csv", "--laws", "coulomb"
    )
    assert code == 0, err
    assert "velocity [m/s]" in out
    assert "lists them" not in out
    *_, first, second = (folder / "next.csv").read_text().splitlines()
    assert first.endswith(";;35")  # the temperature is a condition
    assert second.endswith(";;35")
    filled = (folder / "next.csv").read_text().replace(";;", ";0,0023;")
    (folder / "next.csv").write_text(filled)
    code, out, err = run("select", "own.toml", "--data", "next.csv", "--laws", "coulomb", "--json")
    assert code in (0, 3), err
    assert json.loads(out)["schema"].startswith("stickslip/select")


def test_no_more_readings_of_a_table_are_planned_than_were_made(run, table):
    code, out, _ = run("plan", "axis.toml", "--data", "table.csv", "--json")
    assert code == 0
    assert 0 < len(json.loads(out)["readings"]["velocity"]) <= 12


def test_a_number_of_readings_that_nobody_makes_is_refused(run, table):
    code, _, err = run("plan", "axis.toml", "--data", "table.csv", "--readings", "5000")
    assert code == 2
    assert "at least 1 and at most 300, got 5000" in err


def test_where_nothing_was_measured_the_page_on_experiments_is_named(run):
    code, out, err = run("plan", "rig.toml")
    assert (code, out) == (2, "")
    assert "docs/howto/which-experiment.md" in err


@pytest.mark.slow
def test_travels_have_further_settings(run, folder):
    trials = "".join(
        f'[[trial]]\nset = {{ compression = "{x} mm" }}\ntravel = "{s} mm"\n'
        for x, s in ((40, 58), (80, 231), (120, 519))
    )
    (folder / "rig.toml").write_text(RIG + trials)
    code, out, err = run("plan", "rig.toml", "--laws", "coulomb,viscous", "--json")
    assert code == 0, err
    assert json.loads(out)["plan"]
    code, _, err = run("plan", "rig.toml", "-o", "next.csv")
    assert (code, "-o writes readings to make beside a table" in err) == (2, True)
