"""Which law a command takes where none is named."""

import json

import pytest

from stickslip.cli import main

MECHANISM = """
title = "Block"
[mechanism]
type = "spring-block"
mass = 1.0
drive = { type = "pulse", level = 20.0, duration = 0.1 }
[run]
t_end = 1.0
"""
ONE = MECHANISM + "[friction.coulomb-viscous]\nkinetic_coefficient = 0.4\nviscous_coefficient = 2\n"


@pytest.fixture
def simulated(tmp_path, capsys):
    """Simulate a rig; return exit code, the law it ran with, its end and stderr."""

    def call(text, *arguments):
        path = tmp_path / "rig.toml"
        path.write_text(text)
        try:
            code = main(["simulate", str(path), "--json", *arguments])
        except SystemExit as leaving:
            code = leaving.code or 0
        seen = capsys.readouterr()
        content = json.loads(seen.out) if seen.out else {}
        end = content.get("final", {}).get("x")
        return code, content.get("law"), end, " ".join(seen.err.split())

    return call


def test_the_only_law_of_a_file_is_the_one_that_runs(simulated):
    code, law, end, err = simulated(ONE)
    assert (code, law, err) == (0, "coulomb-viscous", "")
    assert end == simulated(ONE, "--law", "coulomb-viscous")[2]


def test_of_several_laws_coulomb_is_the_usual_one(simulated):
    code, law, _, err = simulated(ONE + "[friction.coulomb]\nkinetic_coefficient = 0.4\n")
    assert (code, law) == (0, "coulomb")
    assert "several laws; coulomb is used. --law chooses coulomb-viscous." in " ".join(err.split())


def test_several_laws_without_the_usual_one_are_asked_for(simulated):
    code, _, _, err = simulated(ONE + "[friction.viscous]\nviscous_coefficient = 4\n")
    assert code == 2
    assert "several laws, viscous, coulomb-viscous: choose one with --law" in err


@pytest.mark.parametrize(
    "table",
    [
        "kinetic_coefficient = 0.4",
        "[friction.coulomb]\nkinetic_coefficient = 0.4",
        '[friction.dahl.forces]\nload = "10 N"\nkinetic_force = "4 N"\n'
        'bristle_stiffness = "1e5 N/m"',
    ],
)
def test_an_override_of_friction_counts_wherever_the_file_has_the_value(simulated, table):
    text = MECHANISM + ("" if table.startswith("[") else "[friction]\n") + table
    # 2 m/s after the push; braked by mu g alone, from 0.4 to half of that
    wanted = simulated(text.replace("0.4", "0.2").replace("4 N", "2 N"))
    code, law, end, err = simulated(text, "--set", "friction.kinetic_coefficient=0.2")
    assert (code, law, end, err) == (*wanted[:3], "")
    assert end > simulated(text)[2]


COMPOSED = "level + power + drag"
VALUES = "kinetic_coefficient = 0.4\nviscous_coefficient = 2\nquadratic_coefficient = 0.1\n"


@pytest.mark.parametrize(
    ("table", "asked"),
    [
        (f'[friction.mine]\nlaw = "{COMPOSED}"\n', ("--law", "mine")),
        (f'[friction.mine]\nlaw = "{COMPOSED}"\n', ("--law", " level+power +drag")),
        (f'[friction."{COMPOSED}"]\n', ("--law", "level+power+drag")),
        (f'[friction]\nlaw = "{COMPOSED}"\n', ()),
    ],
)
def test_a_composed_law_is_called_by_its_table_or_its_text(simulated, table, asked):
    code, law, _, err = simulated(MECHANISM + table + VALUES + "viscous_exponent = 1.0\n", *asked)
    assert (code, law, err) == (0, COMPOSED, "")


def test_a_table_of_a_law_without_values_names_the_law(simulated):
    code, law, _, err = simulated(MECHANISM + f'[friction]\nlaw = "{COMPOSED}"\n')
    assert (code, law) == (0, COMPOSED)
    assert f"has no values for {COMPOSED}; default values are used" in err
    code, _, _, err = simulated(
        MECHANISM + f'[friction]\nlaw = "{COMPOSED}"\n{VALUES.rpartition("quadratic")[0]}'
    )
    assert (code, "quadratic_coefficient (c) is missing" in err) == (2, True)
    code, _, _, err = simulated(MECHANISM + "[friction]\nlaw = 3\n")
    assert (code, "friction.law must be a text such as 'level + viscous', got 3" in err) == (
        2,
        True,
    )


def test_the_override_of_one_law_comes_before_that_of_all(simulated):
    both = ("friction.kinetic_coefficient=0.1", "friction.coulomb-viscous.kinetic_coefficient=0.2")
    found = simulated(ONE, *(part for one in both for part in ("--set", one)))
    assert found == simulated(ONE, "--set", both[1])


def test_of_an_overridden_value_no_interval_is_left(simulated):
    text = ONE + (
        '[estimates]\nlaw = "coulomb-viscous"\n[estimates.intervals]\n'
        "kinetic_coefficient = [0.3, 0.5]\nviscous_coefficient = [1.0, 3.0]\n"
    )
    code, _, _, err = simulated(text, "--set", "friction.kinetic_coefficient=0.1")
    assert (code, err) == (0, "")  # 0.1 lies outside its interval


@pytest.mark.parametrize(
    ("path", "said"),
    [
        ("friction.bristle_stiffness", "names no parameter of coulomb-viscous"),
        ("friction.viscous.viscous_coefficient", "sets a parameter of viscous, but the run uses"),
    ],
)
def test_an_override_that_the_run_does_not_use_is_refused(simulated, path, said):
    code, law, _, err = simulated(ONE, "--law", "coulomb-viscous", "--set", f"{path}=3")
    assert (code, law) == (2, None)
    assert f"--set {path} {said}" in err
    assert "--law" in err


def test_ordinary_values_stand_only_where_the_file_has_none(simulated):
    text = MECHANISM + "[friction]\nstribeck_velocity = 0.3\n"
    code, law, _, err = simulated(text, "--law", "stribeck")
    assert (code, law) == (0, "stribeck")
    assert "has only some values for stribeck" in err
    assert "stribeck_velocity=0.3" in err
    code, _, _, err = simulated(
        text, "--law", "stribeck", "--set", "friction.kinetic_coefficient=2"
    )
    assert code == 2
    assert "Give all of them" in err


WARM = """
[mechanism]
type = "axis"
inertia = 2.0
drive = {{ type = "sine", amplitude = 8.0, frequency = 1.0 }}
{data}
[friction.warm-viscous]
kinetic_coefficient = 2.0
viscous_coefficient = 10.0
viscous_temperature_decay = 0.03
[run]
t_end = 1.0
"""


def test_a_law_gets_its_temperature_from_the_rig_or_from_the_only_record(simulated, tmp_path):
    rows = "".join(f"{0.1 * i},{0.01 * i},{20 + i}\n" for i in range(11))
    (tmp_path / "run.csv").write_text("time [s],position [m],temperature [degC]\n" + rows)
    code, _, end, err = simulated(WARM.format(data='[data]\nfile = "run.csv"\n'))
    assert code == 0
    assert "The temperature of the run is that of run." in err
    ramp = (
        '[contact]\ntemperature = { type = "piecewise-linear", times = [0, 1], values = [20, 30] }'
    )
    assert simulated(WARM.format(data=ramp))[2] == pytest.approx(end, rel=1e-12)
    code, *_, err = simulated(WARM.format(data=""))
    assert code == 2
    assert "depends on the contact input 'temperature', which Axis does not tell" in err
    code, *_, err = simulated(WARM.format(data=""), "--set", "contact.temprature=20")
    assert code == 2
    assert "Did you mean 'temperature'" in err


WITH_DRAG = MECHANISM + '[friction.own]\nlaw = "level + drag"\n'
DRAG_VALUES = "kinetic_coefficient = 0.4\nquadratic_coefficient = 2\n"


def test_a_law_that_a_file_does_not_have_is_sought_among_its_own_too(simulated):
    code, _, _, err = simulated(WITH_DRAG + DRAG_VALUES, "--law", "onw")
    assert code == 2
    assert err.endswith("'onw'. Did you mean 'own'?")


def test_a_table_of_no_law_is_told_to_say_which_law_it_is(simulated):
    code, _, _, err = simulated(MECHANISM + "[friction.own]\n" + DRAG_VALUES)
    assert code == 2
    assert '[friction.own] has the name of no law or contact: add law = "level + viscous"' in err
    assert "Did you mean 'dahl'" in simulated(MECHANISM + "[friction.dhal]\n" + DRAG_VALUES)[3]


def test_a_table_with_the_name_of_one_law_is_of_no_other(simulated):
    other = WITH_DRAG.replace("friction.own", "friction.lugre") + DRAG_VALUES
    code, _, _, err = simulated(other)
    assert code == 2
    assert "friction.lugre has the name of another law than its law = 'level + drag'" in err
    same = MECHANISM + '[friction.coulomb]\nlaw = "level"\nkinetic_coefficient = 0.4\n'
    assert simulated(same)[:2] == (0, "coulomb")


def test_an_export_of_a_law_without_values_asks_for_a_fit(tmp_path, capsys):
    path = tmp_path / "rig.toml"
    path.write_text(WITH_DRAG)
    with pytest.raises(SystemExit) as leaving:
        main(["export", str(path), "--law", "own", "--to", "c", "-o", str(tmp_path / "out")])
    assert leaving.value.code == 2
    said = " ".join(capsys.readouterr().err.split())
    assert "the law own lacks values: fit it first, with `stickslip fit" in said
    assert not (tmp_path / "out").exists()
