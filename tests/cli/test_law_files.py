"""From a selection to another mechanism: a law from a file, its band, and the page of the run."""

import json
import math
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from tests.commands import commands
from tests.support import exported

from stickslip import Axis, Coulomb, Dahl, LuGre, SpringBlock, load_rig, simulate
from stickslip.cli import main
from stickslip.data import LawEstimates
from stickslip.data.rigs.rig_writer import rig_toml
from stickslip.friction import law
from stickslip.mechanisms.drives import Sine, Sum, ThreePhase
from stickslip.show.documents import write_folder

CART = Path(__file__).parents[2] / "docs" / "howto" / "files" / "pendulum-cart.toml"
PERIOD = float(ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0).period)
"""Of the swing of that file [s]."""

KNOWN = LawEstimates(
    law="coulomb", intervals={"kinetic_coefficient": (0.19, 0.21)}, largest_speed=2.0
)
LAW = Coulomb(kinetic_coefficient=0.2)


@pytest.fixture
def walk(tmp_path, monkeypatch, capsys):
    """Run commands in a folder of their own; return exit code, stdout, stderr on one line."""
    monkeypatch.chdir(tmp_path)
    return commands(capsys, one_line=True)


def write(path, mechanism, law, estimates=None):
    Path(path).write_text(rig_toml(mechanism, law, estimates=estimates), encoding="utf-8")
    return path


def test_the_cart_runs_with_the_law_of_a_file_as_with_its_own(walk):
    write("law.toml", SpringBlock(mass=1.0), LAW)
    code, out, err = walk("simulate", CART, "--law", "law.toml", "--t-end", 5 * PERIOD, "--json")
    found = json.loads(out)
    assert code == 0
    assert found["law_file"]["file"] == "law.toml"
    # the reference cart: 24.8596 mm in the first cycle, 63.4659 mm in each further one
    travels = [cycle["travel"] for cycle in found["cycles"]]
    np.testing.assert_allclose(travels, [0.0248596, *[0.0634659] * 4], atol=5e-8)
    assert found["final"]["x"] == pytest.approx(math.fsum(travels), abs=1e-9)
    assert "normal force of 9.81 N" in err  # here it is less, and that is said


@pytest.mark.slow
def test_a_band_is_the_spread_of_the_law_in_screen_table_page_and_json(walk):
    # the block without a static surplus: travel k x0^2 / (2 mu m g), which falls with mu
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    write("law.toml", block, LAW, KNOWN)
    asked = ("simulate", "law.toml", "--t-end", 2, "--ensemble", 400, "--seed", 3, "--json")
    code, out, _ = walk(*asked, "-o", "run.csv", "--report-to", "page")
    band = json.loads(out)["band"]
    assert code == 0
    for end, mu in (("low", 0.21), ("median", 0.2), ("high", 0.19)):
        # quantiles of 400 draws lie within 0.3 standard deviations of those drawn from, 0.8 %
        expected = 100.0 * 0.1**2 / (2.0 * mu * 9.81)
        assert band["travel"][end] == pytest.approx(expected, rel=0.012)
    table = exported("run.csv")
    assert table["x_low"].iloc[-1] == pytest.approx(band["travel"]["low"], rel=1e-12)
    assert (table["x_low"] <= table["x_median"] + 1e-15).all()
    assert (table["x_median"] <= table["x_high"] + 1e-15).all()
    assert "400 runs" in Path("page/index.html").read_text()
    again = json.loads(walk(*asked)[1])["band"]
    assert again == band


@pytest.mark.slow
def test_a_back_slip_that_rests_on_bristles_nobody_measured_is_said_to(walk):
    law = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1e3)
    write("law.toml", SpringBlock(mass=1.0), law)
    asked = ("simulate", CART, "--law", "law.toml", "--t-end", 2 * PERIOD, "--force")
    code, _, err = walk(*asked, "--report")
    assert code == 0
    said = "bristle parameters that were not measured: sigma_0 = 1,000 1/m"
    # the contact gives way by 0.5 mm as the force reverses: little of a travel of centimetres
    assert f"depends on {said}" in err
    assert "back-slip in a cycle of" in err
    assert "travel in a cycle" not in err
    page = " ".join(Path("stickslip-run/index.html").read_text().split())
    assert re.search(
        r"back-slip in the last cycle; depends on .{0,900}no measurement determined", page
    )
    remarks = json.loads(walk(*asked, "--json")[1])["remarks"]
    assert any(said in line for line in remarks)


def test_levels_that_are_forces_need_the_load_at_which_they_were_fitted(walk):
    write("law.toml", Axis(inertia=1.0), Coulomb(kinetic_coefficient=10.0))
    code, _, err = walk("simulate", CART, "--law", "law.toml")
    assert (code, '--law-load "50 N"' in err) == (2, True)
    code, out, err = walk("simulate", CART, "--law", "law.toml", "--law-load", "50 N", "--json")
    assert code == 0
    assert "divided by the given load of 50 N" in err
    write("other.toml", SpringBlock(mass=1.0), LAW)
    same = json.loads(walk("simulate", CART, "--law", "other.toml", "--json")[1])
    assert json.loads(out)["final"] == same["final"]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--law", "none.toml"], "does not exist"),
        (["--law", "two.toml"], "two.toml:coulomb"),
        (["--law", "two.toml:dahl"], "coulomb, lugre"),
        (["--law", "bare.toml"], "has no law"),
        (["--law", "law.toml", "--law-load", "50 N"], "leave --law-load out"),
        (["--law", "law.toml", "--law-load", "0 N"], "--law-load"),
        (["--law-load", "50 N"], "--law law.toml"),
        (["--law", "law.toml", "--ensemble", "50"], "law.toml of `stickslip select`"),
        (["--ensemble", "50", "--fixed-step", "0.01"], "leave --fixed-step out"),
    ],
)
def test_what_cannot_be_meant_is_one_message(walk, arguments, said):
    block = SpringBlock(mass=1.0)
    lugre = LuGre(
        kinetic_coefficient=0.2,
        static_coefficient=0.3,
        stribeck_velocity=0.01,
        bristle_stiffness=1e3,
        bristle_damping=10.0,
    )
    one = rig_toml(block, LAW)
    Path("law.toml").write_text(one)
    Path("two.toml").write_text(one + rig_toml(block, lugre).partition("\n\n")[2])
    Path("bare.toml").write_text(one.partition("[friction")[0])
    code, out, err = walk("simulate", CART, *arguments)
    assert (code, out, "Traceback" in err) == (2, "", False)
    assert said in err


def test_one_of_several_laws_is_named_after_a_colon(walk):
    text = rig_toml(SpringBlock(mass=1.0), LAW)
    Path("two.toml").write_text(text + "[friction.viscous]\nviscous_coefficient = 2.0\n")
    code, out, err = walk("simulate", CART, "--law", "two.toml:viscous", "--json")
    assert (code, json.loads(out)["law"]) == (0, "viscous")
    assert "does not scale with the normal force" in err


def test_friction_that_is_set_is_set_in_the_file_of_the_law(walk):
    write("law.toml", SpringBlock(mass=1.0), LAW, KNOWN)
    write("other.toml", SpringBlock(mass=1.0), Coulomb(kinetic_coefficient=0.3))
    law = ("--law", "law.toml", "--set", "friction.kinetic_coefficient=0.3")
    changed = json.loads(walk("simulate", CART, *law, "--json")[1])
    meant = json.loads(walk("simulate", CART, "--law", "other.toml", "--json")[1])
    assert changed["final"] == meant["final"]
    assert walk("simulate", CART, *law, "--ensemble", 50)[0] == 2  # it is no estimate any more


def test_a_run_far_faster_than_what_was_fitted_is_said_to_be_so(walk):
    known = LawEstimates(
        law="coulomb", intervals={"kinetic_coefficient": (0.19, 0.21)}, largest_speed=0.05
    )
    write("law.toml", SpringBlock(mass=1.0), LAW, known)
    _, out, err = walk("simulate", CART, "--law", "law.toml", "--json")
    assert "extrapolated" in err
    assert any("extrapolated" in line for line in json.loads(out)["remarks"])


def test_a_run_that_ends_early_has_its_page_and_its_exit_code(walk):
    # so fast a swing lifts the cart off
    faster = ("--set", "mechanism.pendulum.profile.slow=300", "--report")
    code, out, err = walk("simulate", CART, *faster)
    assert code == 3
    assert "Report: stickslip-run/index.html" in out
    assert "The run ended at" in err
    assert "The run ends early" in Path("stickslip-run/index.html").read_text()


@pytest.mark.parametrize(
    ("error", "code", "said"),
    [
        (RuntimeError("no ink"), 1, "The report could not be drawn (RuntimeError: no ink)."),
        (KeyboardInterrupt(), 130, "Cancelled while the report was drawn."),
    ],
)
def test_a_page_that_is_not_drawn_costs_nothing_else_and_is_not_listed(
    walk, monkeypatch, error, code, said
):
    from stickslip.show.report import runs

    def fails(_):
        raise error

    monkeypatch.setattr(runs, "run_page", fails)
    write_folder(Path("stickslip-run"), {"index.html": "of an earlier run"})
    asked = ("simulate", CART, "--report", "--force", "-o", "run.csv")
    found, out, err = walk(*asked)
    assert (found, said in err) == (code, True)
    assert "no result was written" not in err
    assert "At 3 s: x = " in out
    assert "Report:" not in out
    assert Path("run.csv").exists()
    assert not Path("stickslip-run/index.html").exists()
    found, out, _ = walk(*asked, "--json")
    document = json.loads(out)
    assert (found, document["report"]) == (code, None)
    assert document["final"]["x"] > 0.0


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (
            ["kinetic_coefficient=0.5"],
            "friction.coulomb.kinetic_coefficient (mu_k) = 0.5 is above static_coefficient"
            " (mu_s) = 0.4 of the file: override both",
        ),
        (
            ["static_coefficient=0.1"],
            "friction.coulomb.static_coefficient (mu_s) = 0.1 is below kinetic_coefficient"
            " (mu_k) = 0.2 of the file: override both",
        ),
        (
            ["kinetic_coefficient=0.5", "static_coefficient=0.4"],
            "Coulomb.static_coefficient (mu_s) must be at least kinetic_coefficient = 0.5",
        ),
    ],
)
def test_an_override_against_a_value_of_the_file_names_both(walk, overrides, said):
    write(
        "law.toml", SpringBlock(mass=1.0), Coulomb(kinetic_coefficient=0.2, static_coefficient=0.4)
    )
    options = [part for override in overrides for part in ("--set", f"friction.{override}")]
    code, out, err = walk("simulate", CART, "--law", "law.toml", *options)
    assert (code, out) == (2, "")
    assert (
        f"override of law.toml: {'' if len(overrides) == 1 else 'friction.coulomb: '}{said}" in err
    )


def test_an_override_of_a_shared_value_is_named_as_it_was_given(walk):
    _, _, err = walk(
        "simulate", "demo", "--law", "coulomb", "--set", "friction.kinetic_coefficient=0.9"
    )
    assert "friction.kinetic_coefficient (mu_k) = 0.9 is above static_coefficient" in err


@pytest.mark.slow
def test_an_ensemble_of_overridden_parameters_is_refused_with_their_names(walk):
    write("law.toml", SpringBlock(mass=1.0), LAW, KNOWN)
    law = ("--law", "law.toml", "--set", "friction.kinetic_coefficient=0.3")
    code, _, err = walk("simulate", CART, *law, "--ensemble", 50)
    assert code == 2
    assert "has an interval (kinetic_coefficient overridden)" in err
    assert "leave the overrides out" in err
    assert "given or assumed" not in err  # it was fitted, before
    assert walk("simulate", CART, *law, "--report")[0] == 0
    page = Path("stickslip-run/index.html").read_text()
    assert "overridden" in page
    assert "given or assumed" not in page


@pytest.mark.slow
def test_a_level_at_rest_that_nobody_gave_is_said_to_be_taken_equal(walk):
    block = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    write("law.toml", block, LAW, KNOWN)
    said = "mu_s was neither measured nor given: it is set equal to mu_k"
    code, _, err = walk("simulate", CART, "--law", "law.toml", "--t-end", PERIOD, "--report")
    assert code == 0
    assert said in err
    page = Path("stickslip-run/index.html").read_text()
    assert "Static coefficient" in page
    assert "assumed, not measured" in page
    assert "By how much static friction exceeds sliding friction" in page
    given = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.3)
    write("law.toml", block, given, KNOWN)
    code, _, err = walk("simulate", CART, "--law", "law.toml", "--t-end", PERIOD)
    assert (code, said in err) == (0, False)


def test_a_verdict_is_no_law_and_the_file_beside_it_is_named(walk):
    code, _, err = walk("simulate", CART, "--law", "axis-report/verdict.json")
    assert code == 2
    assert "--law axis-report/law.toml" in err


def test_a_page_that_is_there_is_kept_and_the_option_for_another_folder_named(walk):
    assert walk("simulate", CART, "--t-end", 0.1, "--report")[0] == 0
    code, _, err = walk("simulate", CART, "--t-end", 0.1, "--report")
    assert code == 2
    assert "give --force to replace it, or another --report-to FOLDER" in err


COMPOSITION = "both_ways[levels](level + stribeck + power)"
COMPOSED = {
    "forward_kinetic_coefficient": 10.0,
    "backward_kinetic_coefficient": 8.0,
    "forward_static_coefficient": 14.0,
    "backward_static_coefficient": 10.0,
    "stribeck_velocity": 0.05,
    "forward_viscous_coefficient": 30.0,
    "backward_viscous_coefficient": 24.0,
    "viscous_exponent": 0.6,
}
SLIDE = """
[mechanism]
type = "axis"
inertia = "5 kg"
drive = {{ type = "sine", amplitude = "40 N", frequency = "1 Hz" }}
[friction.rail]
law = "{law}"
{values}
[data]
file = "slide.csv"
columns = {{ velocity = "w", friction = "F" }}
[run]
t_end = "1 s"
"""


@pytest.mark.slow
def test_a_composition_goes_from_a_rig_file_to_c_fmu_mjcf_and_figures(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    true = law(COMPOSITION)(**COMPOSED)
    push = Sum(parts=(Sine(amplitude=40.0, frequency=1.0), Sine(amplitude=15.0, frequency=0.7)))
    t = np.arange(300) / 150.0
    seen = simulate(Axis(inertia=5.0, drive=push), true, t_end=2.0).at(t)
    noise = np.random.default_rng(0)
    rows = (
        t,
        seen["v"] + noise.normal(0.0, 1e-4, 300),
        seen["friction"] + noise.normal(0, 0.05, 300),
    )
    np.savetxt("slide.csv", np.transpose(rows), delimiter=",", header="time,w,F", comments="")
    values = "\n".join(f"{name} = {value}" for name, value in COMPOSED.items())
    text = SLIDE.format(law=COMPOSITION, values=values)
    Path("slide.toml").write_text(text, encoding="utf-8")
    still = re.sub("drive = .*", "", text)  # nothing moves: speeds are those of the fit
    Path("still.toml").write_text(still, encoding="utf-8")

    compiler = any(map(shutil.which, ("cc", "gcc", "clang")))
    laws = f"coulomb-viscous,{COMPOSITION}"
    for command in (
        "fit slide.toml --vary forward_kinetic_coefficient -o fitted.toml",
        f"select slide.toml -o report --laws|{laws}",
        "export report/law.toml --to c -o c",
        "export report/law.toml --to mjcf --rig slide.toml -o mjcf",
        "export report/law.toml --to mjcf --rig still.toml -o still",
        "simulate slide.toml --law report/law.toml -o run.csv --report-to run",
        *(["export report/law.toml --to fmu -o fmu"] if compiler else []),
    ):
        plain_words, _, last = command.partition("|")
        with pytest.raises(SystemExit) as leaving:
            main([*plain_words.split(), *([last] if last else []), "--quiet"])
        assert not leaving.value.code, (command, capsys.readouterr().err)

    for file, name in (("fitted.toml", "fitted"), ("report/law.toml", "selected")):
        rig = load_rig(file)
        (found,) = rig.laws.values()
        assert type(found) is type(true), name
        for parameter in rig.estimates.intervals:
            low, high = rig.estimates.intervals[parameter]
            middle = (low + high) / 2.0  # of 95 %: within 3 standard uncertainties
            assert abs(COMPOSED[parameter] - middle) < 1.5 * (high - low) / 2.0, (name, parameter)
    assert "exponent" in next(Path("c").glob("*.h")).read_text(encoding="utf-8")
    assert "<joint" in next(Path("mjcf").glob("*.xml")).read_text(encoding="utf-8")
    assert "<svg" in Path("run/index.html").read_text(encoding="utf-8")
    assert math.isfinite(np.loadtxt("run.csv", delimiter=",", skiprows=1, usecols=1)[-1])
    assert len(list(Path("fmu").glob("*.fmu"))) == compiler
