"""Commands on rigs with several contacts."""

import json
import re
from functools import partial
from pathlib import Path

import pandas as pd
import pytest
from tests.arm_cases import parts, record
from tests.support import exported

from stickslip import EventDriven, load_rig
from stickslip.cli import main
from stickslip.study.sweep import band_of

FEET = """
title = "Sledge on two feet"
[mechanism]
type = "two-feet"
mass = "2 kg"
front = "30 cm"
rear = "20 cm"
height = "15 cm"
stiffness = "50 N/m"
[friction.front]
kinetic_coefficient = 0.6
static_coefficient = 0.7
[friction.rear]
kinetic_coefficient = 0.2
static_coefficient = 0.3
[run]
t_end = "3 s"
initial = { x = "90 cm" }
"""
DAHL = """
[friction.rear.dahl]
kinetic_coefficient = 0.2
bristle_stiffness = 1e4
"""
SHARED = FEET.partition("[friction.rear]")[0].replace("[friction.front]", "[friction]")


@pytest.fixture
def called(tmp_path, monkeypatch, capsys):
    """Call a command in an empty folder with a rig; return exit code, stdout and stderr."""
    monkeypatch.chdir(tmp_path)

    def call(text, command, *arguments):
        Path("rig.toml").write_text(text)
        try:
            code = main([command, *arguments])
        except SystemExit as leaving:
            code = leaving.code or 0
        seen = capsys.readouterr()
        return code, seen.out, " ".join(seen.err.split())

    return call


def test_a_run_is_shown_and_exported_by_contact(called):
    code, out, err = called(FEET, "simulate", "rig.toml", "-o", "run.csv", "--samples", "7")
    assert (code, err) == (0, "")
    assert "rear" in out
    assert re.search(r"^front +\d+ +\d+ % +1\.115 +12\.96$", out, flags=re.MULTILINE)
    table = exported("run.csv")
    names = ["x", "v", "friction:front", "friction:rear"]
    names += ["normal_force:front", "normal_force:rear", "mode:front", "mode:rear"]
    assert list(table.columns) == ["t", *names]
    assert len(table) == 7
    assert table["x"].iloc[-1] == pytest.approx(-0.07443116883117, abs=1e-12)


def test_json_has_laws_and_events_by_contact_and_no_criteria(called):
    code, out, _ = called(FEET, "simulate", "rig.toml", "--json")
    found = json.loads(out)
    assert code == 0
    assert found["laws"] == {"front": "coulomb", "rear": "coulomb"}
    assert {event["contact"] for event in found["events"]} == {"front", "rear"}
    assert found["certificate"]["work"].keys() == {"front", "rear"}
    assert "criteria" not in found


def test_an_override_changes_the_law_of_one_contact(called):
    change = ("--set", "friction.rear.kinetic_coefficient=0.25")
    code, out, _ = called(FEET, "simulate", "rig.toml", "--json", *change)
    changed = json.loads(out)["certificate"]["work"]
    text = FEET.replace("kinetic_coefficient = 0.2", "kinetic_coefficient = 0.25")
    assert code == 0
    same = json.loads(called(text, "simulate", "rig.toml", "--json")[1])["certificate"]["work"]
    assert changed == same


def test_the_page_has_the_figures_and_tables_of_the_contacts(called):
    code, _, _ = called(FEET, "simulate", "rig.toml", "--report-to", "page")
    text = Path("page/index.html").read_text(encoding="utf-8")
    assert code == 0
    for words in ("6 events at 2 contacts", "Friction at each contact", "The run is certified"):
        assert words in text
    assert "could not be produced" not in text


REFUSED = {
    "warmup": ("warmup", "--rig", "rig.toml"),
    "enforce": ("simulate", "rig.toml", "--enforce", "-o", "run.csv"),
}


@pytest.mark.parametrize("arguments", REFUSED.values(), ids=REFUSED)
def test_what_takes_one_contact_names_those_there_are_and_writes_nothing(called, arguments):
    code, out, err = called(FEET, *arguments)
    assert (code, out) == (2, "")
    assert "front, rear" in err
    assert "Traceback" not in err
    assert [path.name for path in Path().iterdir()] == ["rig.toml"]


OTHER = FEET.replace("kinetic_coefficient = 0.6", "kinetic_coefficient = 0.5")


def test_laws_by_contact_are_taken_from_another_file(called):
    Path("law.toml").write_text(FEET + ESTIMATES)
    asked = ("simulate", "rig.toml", "--law", "law.toml", "--json")
    code, out, err = called(OTHER, *asked)
    found = json.loads(out)
    assert (code, err) == (0, "")
    assert found["law_file"]["file"] == "law.toml"
    assert found["final"]["x"] == pytest.approx(-0.07443116883117, abs=1e-12)
    changed = ("--set", "friction.front.kinetic_coefficient=0.55")
    assert json.loads(called(OTHER, *asked, *changed)[1])["final"]["x"] != found["final"]["x"]


BAD_LAWS = {
    "other contacts": (
        '[mechanism]\ntype = "two-mass-axis"\nrubs = "both"\nmotor_inertia = 1\n'
        "load_inertia = 1\nstiffness = 1\n[friction.load]\nkinetic_coefficient = 1\n"
        "[friction.motor]\nkinetic_coefficient = 1\n",
        "law.toml has laws of load, motor, but two-feet has front, rear: rename",
    ),
    "one law": (
        '[mechanism]\ntype = "axis"\ninertia = "1 kg"\n[friction]\nkinetic_coefficient = 1\n',
        "law.toml has no laws by contact, but two-feet has front, rear: write the values into",
    ),
    "another override": (FEET, "friction.front.stribeck_velocity names no parameter of coulomb"),
}


@pytest.mark.parametrize("case", BAD_LAWS)
def test_a_file_whose_laws_do_not_fit_is_refused_in_words(called, case):
    text, message = BAD_LAWS[case]
    Path("law.toml").write_text(text)
    more = ("--set", "friction.front.stribeck_velocity=1") if text == FEET else ()
    code, out, err = called(FEET, "simulate", "rig.toml", "--law", "law.toml", *more)
    assert (code, out) == (2, "")
    assert message in err


@pytest.mark.parametrize("command", ["fit", "select"])
def test_records_of_several_contacts_are_not_fitted(called, command):
    rows = "".join(f"{0.01 * i},{0.001 * i * i},{1 + 0.01 * i}\n" for i in range(60))
    Path("run.csv").write_text("time,position,force\n" + rows)
    code, _, err = called(FEET, command, "rig.toml", "--data", "run.csv")
    assert code == 2
    assert "front, rear" in err


ESTIMATES = """
[estimates]
law = { front = "coulomb", rear = "coulomb" }
[estimates.intervals]
front.kinetic_coefficient = [0.55, 0.65]
rear.kinetic_coefficient = [0.15, 0.25]
"""


@pytest.mark.slow
def test_an_ensemble_draws_from_the_laws_of_all_contacts(called, monkeypatch):
    plain = partial(band_of, solver=EventDriven(tier="python"))  # no kernels to compile
    monkeypatch.setattr("stickslip.cli.simulate.sweep.band_of", plain)
    asked = ("simulate", "rig.toml", "--ensemble", "4", "--seed", "2")
    code, shown, err = called(FEET + ESTIMATES, *asked)
    assert code == 0, err
    assert "4 draws (seed 2) of front kinetic coefficient, rear kinetic coefficient" in shown
    files = ("-o", "run.csv", "--samples", "7", "--report-to", "page", "--json")
    band = json.loads(called(FEET + ESTIMATES, *asked, *files)[1])["band"]
    assert band["parameters"].keys() == {
        "friction.front.kinetic_coefficient", "friction.rear.kinetic_coefficient"
    }  # fmt: skip
    table = exported("run.csv")
    assert table["x_low"].iloc[-1] - table["x"].iloc[0] == pytest.approx(band["travel"]["low"])
    assert (table["v_low"] <= table["v_high"]).all()
    page = Path("page/index.html").read_text(encoding="utf-8")
    for words in ("with uncertain parameters drawn", "0.55 to 0.65", "as given"):
        assert words in page
    assert "could not be produced" not in page


@pytest.mark.parametrize("text", [FEET, FEET.replace("[run]", DAHL + "[run]") + ESTIMATES])
def test_an_ensemble_needs_estimates_of_the_laws_of_the_run(called, text):
    laws = ("--law", "front=coulomb,rear=dahl") if text != FEET else ()
    code, out, err = called(text, "simulate", "rig.toml", "--ensemble", "5", *laws)
    assert (code, out) == (2, "")
    assert "--ensemble samples uncertain parameters, and neither this law nor the mechanism" in err


MISTAKES = {
    "a misspelt contact": (("--set", "friction.frnt.kinetic_coefficient=3"), "'front'"),
    "a parameter of another law": (
        ("--set", "friction.front.viscous_coefficient=3"), "names no parameter of coulomb",
    ),
    "a law that has no values": (("--law", "dahl"), "'front' has no values of the law 'dahl'"),
    "a law for no contact": (("--law", "fornt=coulomb"), "Did you mean 'front'"),
    "a load": (("--law-load", "3 N"), "only to a law from a file"),
}  # fmt: skip


@pytest.mark.parametrize(("options", "message"), MISTAKES.values(), ids=MISTAKES)
def test_a_mistake_is_one_sentence(called, options, message):
    code, _, err = called(FEET, "simulate", "rig.toml", *options)
    assert code == 2
    assert message in err
    assert "Traceback" not in err


def test_a_law_that_a_file_lacks_is_missed_by_the_name_of_the_file(called, tmp_path):
    (tmp_path / "law.toml").write_text(FEET)
    code, _, err = called(FEET, "simulate", "rig.toml", "--law", "law.toml:dahl")
    assert code == 2
    assert "law.toml: the contact 'front' has no values of the law 'dahl'" in err


@pytest.mark.parametrize("name", ["law.toml", "law.toml:coulomb"])
def test_laws_by_contact_are_refused_where_there_is_one_contact(called, tmp_path, name):
    (tmp_path / "law.toml").write_text(FEET)
    code, _, err = called(FEET, "simulate", "demo", "--law", name)
    assert code == 2
    assert "law.toml has laws by contact, of front, rear, which a mechanism with one" in err


def test_laws_by_contact_need_tables_of_contacts(called):
    code, _, err = called(SHARED, "simulate", "rig.toml", "--law", "front=coulomb")
    assert code == 2
    assert "no tables of contacts" in err


ARM_RIG = """
title = "Arm"
[mechanism]
type = "two-link-arm"
upper_mass = "0.5 kg"
upper_length = "20 cm"
upper_centre = 0.18
upper_inertia = { value = 0.05, vary = true }
lower_mass = "0.6 kg"
lower_centre = 0.22
lower_inertia = { value = 0.02, vary = true }
rotor_inertia = 6e-5
gear_ratio = 6.0
[data]
file = "arm.csv"
hold = "first"
[data.columns]
time = "t"
position.shoulder = "q1"
position.elbow = "q2"
force.shoulder = "u1"
force.elbow = "u2"
"""


@pytest.fixture
def arm_record(tmp_path):
    """Write the record of an arm beside the rig."""
    t, places, forces = parts(record(0, span=5.0))
    columns = {"t": t, "q1": places["shoulder"], "q2": places["elbow"]}
    columns |= {"u1": forces["shoulder"], "u2": forces["elbow"]}
    pd.DataFrame(columns).to_csv(tmp_path / "arm.csv", index=False)


@pytest.mark.slow
@pytest.mark.usefixtures("arm_record")
def test_a_parameter_of_the_law_of_one_joint_is_held(called):
    asked = ("--law", "shoulder=coulomb-viscous,elbow=coulomb", "--json")
    held = ("--fixed", "friction.shoulder.viscous_coefficient=0.01")
    code, shown, said = called(ARM_RIG, "fit", "rig.toml", *asked, *held)
    assert code == 0, said
    paths = [load["parameter"] for load in json.loads(shown)["estimates"]]
    assert "friction.shoulder.kinetic_coefficient" in paths
    assert "friction.shoulder.viscous_coefficient" not in paths


WARM_ARM = """
[friction.shoulder.warm-viscous]
kinetic_coefficient = 0.2
viscous_coefficient = 0.05
viscous_temperature_decay = 0.02
[friction.elbow.coulomb]
kinetic_coefficient = 0.1
[run]
t_end = "1 s"
initial = { shoulder = 0.5 }
"""


@pytest.mark.slow
@pytest.mark.usefixtures("arm_record")
def test_runs_of_joints_get_the_temperature_of_their_record(called, tmp_path):
    table = pd.read_csv(tmp_path / "arm.csv")
    table.assign(temperature=20.0 + table["t"]).to_csv(tmp_path / "arm.csv", index=False)
    rig = ARM_RIG + 'temperature = "temperature"\n' + WARM_ARM
    code, _, said = called(rig, "simulate", "rig.toml")
    assert code == 0, said
    assert "The temperature of the run is that of arm." in said
    other = rig.replace('temperature = "temp', 'temperature.elbow = "temp')
    code, _, said = called(other, "simulate", "rig.toml")
    assert code == 2
    assert "'temperature', which TwoLinkArm at 'shoulder' does not tell" in said
    assert "of the run is that of" not in said
    told = rig.replace('temperature = "temperature"\n', "") + '[contact]\ntemperature = "20 degC"\n'
    assert called(told, "simulate", "rig.toml")[0] == 0
    table.to_csv(tmp_path / "arm.csv", index=False)
    code, _, said = called(ARM_RIG + WARM_ARM, "simulate", "rig.toml")
    assert code == 2
    assert "'temperature', which TwoLinkArm at 'shoulder' does not tell" in said


MISNAMED = {
    "a joint without a law": ("elbow=coulomb,shoulder=", "one law of each contact"),
    "a joint with two": ("elbow=coulomb,elbow=dahl", "one law of each contact"),
    "no joint": ("elbw=coulomb", "unknown contact in --law 'elbw'. Did you mean 'elbow'"),
    "no law": ("elbow=coulmb", "unknown friction law 'coulmb'. Did you mean 'coulomb'"),
}


@pytest.mark.usefixtures("arm_record")
@pytest.mark.parametrize(("law", "message"), MISNAMED.values(), ids=MISNAMED)
def test_laws_of_joints_that_cannot_be_fitted_are_named(called, law, message):
    code, _, said = called(ARM_RIG, "fit", "rig.toml", "--law", law)
    assert (code, message in said) == (2, True), said


def test_one_record_takes_one_law(called):
    code, _, said = called(FEET, "fit", "demo", "--law", "front=coulomb,rear=dahl")
    assert code == 2
    assert "which only records of several joints take: give one name" in said


@pytest.mark.slow
@pytest.mark.usefixtures("arm_record")
def test_laws_of_all_joints_are_selected_from_a_rig_file(called, tmp_path):
    tried = ["--laws", "coulomb,coulomb-viscous", "-o", "report"]
    code, shown, said = called(ARM_RIG, "select", "rig.toml", *tried)
    assert code == 0, said
    for joint in ("Shoulder", "Elbow"):
        assert f"{joint}: use Coulomb + viscous friction." in shown
    content = json.loads((tmp_path / "report" / "verdict.json").read_text())
    assert content["best"] == "shoulder=coulomb-viscous,elbow=coulomb-viscous"
    code, shown, said = called(ARM_RIG, "simulate", "report/law.toml", "--t-end", "0.1")
    assert code == 0, said
    known = load_rig("report/law.toml").estimates
    assert known.law == {"shoulder": "coulomb-viscous", "elbow": "coulomb-viscous"}
    assert len(known.covariance_of) == 4
    for joint in known.law:
        assert f"{joint}.kinetic_coefficient" in known.intervals
