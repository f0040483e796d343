"""What a page fails with must not cost the verdict, and nothing that is compared may fail."""

import json

import pytest
from typer.testing import CliRunner

import stickslip.cli.judge as command
from stickslip import LuGre, SpringBlock, load_rig, simulate
from stickslip.cli.app import app
from stickslip.show.documents import write_folder

LAW = "rig-report/law.toml"
RIG = """
title = "Own block"
[mechanism]
type = "spring-block"
mass = "0.82 kg"
stiffness = "145 N/m"
compression = "80 mm"
[run]
t_end = "3 s"
[friction]
kinetic_coefficient = 0.2
static_coefficient = 0.3
[friction.lugre]
stribeck_velocity = "10 mm/s"
[friction.lugre.forces]
load = "8.0442 N"
bristle_stiffness = "{stiffness} N/m"
bristle_damping = "300 N s/m"
"""
TRIAL = """
[[trial]]
travel = "{travel} m"
uncertainty = "1 mm"
set = {{ "mechanism.compression" = "{compression} mm" }}
"""


@pytest.fixture(params=[1e4, pytest.param(1e6, marks=pytest.mark.slow)])
def rig(request, tmp_path, monkeypatch):
    """Write three travels of a block with stiff bristles."""
    text = RIG.format(stiffness=request.param)
    path = tmp_path / "rig.toml"
    path.write_text(text)
    law = load_rig(path).laws["lugre"]
    assert isinstance(law, LuGre)
    for compression in (60, 80, 110):
        block = SpringBlock(mass=0.82, stiffness=145.0, compression=1e-3 * compression)
        travel = float(simulate(block, law, t_end=3.0)["x"][-1])
        text += TRIAL.format(travel=round(travel, 3), compression=compression)
    path.write_text(text)
    monkeypatch.chdir(tmp_path)
    return path


def run(*arguments):
    return CliRunner().invoke(app, list(arguments), terminal_width=200)


@pytest.mark.slow
def test_three_travels_of_a_stiff_law_have_a_verdict_and_a_page(rig):
    result = run("select", "rig.toml", "--laws", "lugre")
    assert result.exit_code == 0, result.output
    files = {path.name for path in (rig.parent / "rig-report").glob("[!.]*")}
    assert files == {"index.html", "verdict.json", "law.toml", "draws.json"}
    page = (rig.parent / "rig-report" / "index.html").read_text(encoding="utf-8")
    assert "Use LuGre friction." in page
    given, named = (load_rig(file).laws["lugre"] for file in (rig, rig.parent / LAW))
    assert named.bristle_stiffness == given.bristle_stiffness
    assert named.kinetic_coefficient == pytest.approx(given.kinetic_coefficient, abs=0.002)


@pytest.mark.slow
def test_a_page_that_is_cancelled_leaves_the_verdict_and_says_where(rig, monkeypatch):
    def cancelled(*_arguments, **_settings):
        raise KeyboardInterrupt

    monkeypatch.setattr(command.kinds, "verdict_page", cancelled)
    result = run("select", "rig.toml", "--laws", "coulomb")
    assert result.exit_code == 130
    assert "The verdict is in rig-report/verdict.json." in " ".join(result.stderr.split())
    assert (rig.parent / "rig-report" / "law.toml").is_file()


@pytest.mark.slow
def test_a_page_that_fails_costs_neither_the_verdict_nor_the_law(rig, monkeypatch):
    def failing(*_arguments, **_settings):
        raise ValueError("no ink")

    monkeypatch.setattr(command.kinds, "verdict_page", failing)
    folder = rig.parent / "rig-report"
    write_folder(folder, {"index.html": "an earlier page"})
    result = run("select", "rig.toml", "--laws", "coulomb", "--force")
    assert result.exit_code == 1, result.output
    assert "Coulomb" in result.stdout
    assert "The report could not be drawn (ValueError: no ink)" in result.stderr
    # the page of an earlier verdict does not stand beside this one
    kept = {path.name for path in folder.glob("[!.]*")}
    assert kept == {"verdict.json", "law.toml", "draws.json"}
    verdict = json.loads((folder / "verdict.json").read_text(encoding="utf-8"))
    law = load_rig(folder / "law.toml").laws["coulomb"]
    (estimate,) = verdict["candidates"][0]["fit"]["estimates"]
    assert law.kinetic_coefficient == estimate["value"]
