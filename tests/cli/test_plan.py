"""``stickslip plan``: the sheet, its table, and the way back through ``stickslip select``."""

import json
import re
from pathlib import Path

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
LAWS = ("--law", "coulomb,coulomb-viscous,viscous")


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


def test_one_json_document_is_printed(run, folder):
    options = ("--law", "coulomb", "--between", "50mm..80mm", "--settings", "3")
    code, out, _ = run("plan", "rig.toml", *options, "--json")
    assert code == 0
    content = json.loads(out)
    assert content["schema"] == "stickslip/plan/1"
    assert [row["set"]["mechanism.compression"] for row in content["settings"]] == [
        0.05, 0.065, 0.08,
    ]  # fmt: skip
    assert {entry["parameter"] for entry in content["prepare"]} == {
        "mechanism.mass", "mechanism.stiffness", "mechanism.compression",
    }  # fmt: skip
    assert content["files"] == []


@pytest.mark.slow
def test_a_filled_sheet_is_read_by_select(run, folder):
    """Travels of Coulomb friction with mu_k = 0.21, read to 1 mm: the verdict and its interval."""
    code, *_ = run("plan", "rig.toml", *LAWS, "-o", "sheet.csv")
    assert code == 0
    head, *rows = (folder / "sheet.csv").read_text().splitlines()
    draw = np.random.default_rng(5)
    filled = [head]
    for row in rows:
        x = float(row.split(",")[1]) / 1e3 + 0.0003 * draw.normal()
        s = 145.0 * x**2 / (2.0 * 0.21 * 0.82 * 9.81)
        filled.append(f"{row}{1e3 * s + draw.normal():.0f}")
    (folder / "sheet.csv").write_text("\n".join(filled) + "\n")
    code, out, err = run("select", "rig.toml", "--data", "sheet.csv", "--laws", LAWS[1], "--json")
    assert code == 0, err
    verdict = json.loads(out)
    assert verdict["best"] == "coulomb"
    (level,) = verdict["candidates"][0]["fit"]["estimates"]
    assert level["low"] < 0.21 < level["high"]
    assert level["standard_error_from"].keys() == {
        "readings", "mechanism.mass", "mechanism.stiffness", "mechanism.compression",
    }  # fmt: skip
    # 1 % of the stiffness is shared by all runs: no number of readings makes it smaller
    assert level["standard_error_from"]["mechanism.stiffness"] == pytest.approx(0.0021, rel=0.05)
    settled = " ".join(verdict["settles"])
    assert "The stiffness (1 %) contributes more to its uncertainty than the readings." in settled


def test_a_sheet_that_is_not_filled_in_is_refused_by_its_line(run, folder):
    run("plan", "rig.toml", "--law", "coulomb", "-o", "sheet.csv")
    code, _, err = run("select", "rig.toml", "--data", "sheet.csv")
    assert code == 2
    assert "column 'travel [mm]', line 2: must be a finite number, got nothing" in err


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


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("-o", "sheet.pdf"), "written as a .csv file"),
        (("--between", "50mm"), "--between takes LOW..HIGH"),
        (("--between", "50kg..80kg"), "--between .*must be in m"),
        (("--uncertainty", "2 kg"), "--uncertainty .*must be in m"),
        (("--settings", "40"), "at most 12, got 40"),
        (("--law", "culomb"), "culomb"),
        (
            ("--readings", "3", "--settings", "4"),
            "readings must be at least 4, one at each setting",
        ),
        (("--vary", "mass"), "--vary has no effect on a plan of travels to rest"),
        (("--route", "balance"), "--route has no effect on a plan of travels to rest"),
    ],
)
def test_a_wrong_option_is_named(run, folder, options, said):
    code, _, err = run("plan", "rig.toml", *options)
    assert code == 2
    assert re.search(said, err)
    assert sorted(path.name for path in folder.iterdir()) == ["rig.toml"]


def test_a_sheet_is_not_overwritten(run, folder):
    (folder / "sheet.csv").write_text("mine")
    code, _, err = run("plan", "rig.toml", "-o", "sheet.csv")
    assert code == 2
    assert "sheet.csv already exists" in err


def test_a_rig_with_records_is_told_what_a_plan_is_for(run, folder):
    (folder / "axis.toml").write_text('[mechanism]\ntype = "axis"\ninertia = "80 kg"\n')
    code, _, err = run("plan", "axis.toml")
    assert code == 2
    assert "plan needs a body" in err


def test_settings_of_trials_give_the_range(run, folder):
    trials = "".join(
        f'[[trial]]\nset = {{ compression = "{x} mm" }}\ntravel = "{s} mm"\n'
        for x, s in ((40, 58), (80, 231), (120, 519))
    )
    (folder / "rig.toml").write_text(RIG + trials)
    code, out, _ = run("plan", "rig.toml", "--law", "coulomb", "--settings", "3")
    assert code == 0
    text = re.sub(r"\s+", " ", out)
    assert "Set the compression to 40, 80 and 120 mm" in text
    assert "The settings span the compression of the trials and of the rig, 40 to 120 mm." in text
    assert "Use --between" in text


def test_a_cart_is_refused_before_anything_runs_and_pointed_to_what_is_for_it(run, folder):
    cart = (Path(__file__).parents[2] / "docs/howto/files/pendulum-cart.toml").read_text()
    (folder / "cart.toml").write_text(cart)
    code, _, err = run("plan", "cart.toml")
    assert code == 2
    assert "Simulating" not in err
    assert "docs/howto/fit-cart.md" in err


@pytest.mark.slow
def test_a_table_with_measured_travels_is_never_replaced(folder, run):
    asked = ("plan", "rig.toml", "--law", "coulomb,viscous", "-o", "sheet.csv")
    assert run(*asked)[0] == 0
    table = Path("sheet.csv")
    assert run(*asked, "--force")[0] == 0
    filled = table.read_text().replace(",\n", ",204\n")
    table.write_text(filled)
    code, _, err = run(*asked, "--force")
    assert (code, "sheet.csv has rows that the new table lacks" in err) == (2, True)
    assert table.read_text() == filled


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
        (("--between", "1..2"), "--between has no effect on a plan beside a table"),
        (("--settings", "4"), "--settings has no effect on a plan beside a table"),
        (("--uncertainty", "2mm"), "--uncertainty has no effect on a plan beside a table"),
    ],
)
def test_what_has_no_effect_on_further_readings_is_refused(run, folder, table, options, said):
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
        "plan", "own.toml", "--readings", "2", "-o", "next.csv", "--law", "coulomb"
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
