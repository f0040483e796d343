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


def test_the_only_table_counts_where_shared_values_make_another_law_known(simulated):
    text = MECHANISM + (
        "[friction]\nkinetic_coefficient = 0.4\n"
        "[friction.coulomb-viscous]\nviscous_coefficient = 2\n"
    )
    assert simulated(text)[1] == "coulomb-viscous"


def test_shared_values_that_make_one_law_are_that_law(simulated):
    assert simulated(MECHANISM + "[friction]\nviscous_coefficient = 2\n")[1] == "viscous"


def test_of_several_laws_coulomb_is_the_usual_one(simulated):
    code, law, _, err = simulated(ONE + "[friction.coulomb]\nkinetic_coefficient = 0.4\n")
    assert (code, law, err) == (0, "coulomb", "")


def test_several_laws_without_the_usual_one_are_asked_for(simulated):
    code, _, _, err = simulated(ONE + "[friction.viscous]\nviscous_coefficient = 4\n")
    assert code == 2
    assert "several laws, viscous, coulomb-viscous: say which with --law" in err


def test_ordinary_values_are_said(simulated):
    code, law, _, err = simulated(MECHANISM)
    assert (code, law) == (0, "coulomb")
    assert "has no values for coulomb: it is run with ordinary ones, Coulomb(" in err
