"""Modelica: compiled and simulated by rumoca, compared with the law and with the engine."""

import math

import numpy as np
import pytest
from tests.exports.compiled import library, numbers
from tests.exports.laws import LAWS_EXPORTED
from tests.support import example_of

from stickslip import Axis, CoulombViscous, LuGre, Stribeck, export, simulate
from stickslip.exports.program import equations_of
from stickslip.exports.targets import modelica_unit
from stickslip.mechanisms.drives import Sine
from stickslip.study.control import compensation

LOAD, MASS = 9.81, 2.0
NAMES = ("direction_dependent", "stribeck", "dahl", "lugre_held", "two_bristles")
"""Laws of every kind: what the languages share is tested in C for all laws."""

TEST = """
model Test
  {package}.Body body(mass={mass}, load={load}, applied=8.0*sin(6.0*time));
  Real ramp = -0.5 + time;
  Real push = {package}.compensation(ramp, {load}, 0.01, 0.9);
  Real force = {package}.{steady}(ramp, {load});
{stepped}
end Test;
"""
STEPPED = """
  Real velocity_end, displacement, friction, sticks;
equation
  (velocity_end, displacement, friction, sticks)
    = {package}.step(3.0, ramp, 9.81, 2.0, 0.01);
"""
END, SAMPLE = 1.0, 0.005
TOLERANCE = 2e-4
"""Of positions, over the largest: what an adaptive solver with its own events leaves."""


@pytest.fixture(scope="module")
def rumoca():
    return pytest.importorskip(
        "rumoca", reason="no Modelica tool: pip install rumoca, version 0.10 or newer"
    )


@pytest.mark.parametrize("name", NAMES)
def test_the_package_compiles_and_its_body_moves_as_in_the_engine(rumoca, tmp_path, name):
    law = LAWS_EXPORTED[name]
    ((file, text),) = export(law, "modelica", name=name).files.items()
    states = equations_of(law).bristles
    results = ["velocity_end", "displacement", "friction", "sticks"]
    steady = "steady" if law.states else "friction"
    whole = text + TEST.format(
        package=file.removesuffix(".mo"),
        mass=MASS,
        load=LOAD,
        steady=steady,
        stepped="" if states else STEPPED.format(package=file.removesuffix(".mo")),
    )
    assert rumoca.validate_source(whole) == []
    model = rumoca.Session().loads(whole, model="Test")
    config = rumoca.SimConfig(rtol=1e-9, atol=1e-12)
    table = model.simulate(t=(0.0, END), dt=SAMPLE, config=config).to_dataframe()
    time = table.index.to_numpy()
    run = {column: table[column].to_numpy() for column in table}

    wanted = compensation(law, width=0.01, factor=0.9, load=LOAD)
    for v, force, push in zip(run["ramp"].tolist(), run["force"], run["push"], strict=True):
        true = law.steady(v, LOAD) if law.states else law.force(v, LOAD)
        assert math.isclose(force, true, rel_tol=1e-9, abs_tol=1e-12)
        assert math.isclose(push, wanted(0.0, {"v": v}), rel_tol=1e-9, abs_tol=1e-12)

    if not states:
        files = export(law, "c", name=name).files
        step = numbers(library(tmp_path, files), f"{name}_step", results)
        for i in range(0, len(time), 20):
            moved = step(3.0, float(run["ramp"][i]), LOAD, MASS, 0.01)
            np.testing.assert_allclose(
                [run[result][i] for result in results], list(moved.values()), rtol=1e-9, atol=1e-11
            )

    drive = Sine(amplitude=8.0, frequency=6.0 / (2.0 * math.pi))
    exact = simulate(Axis(inertia=MASS, load=LOAD, drive=drive), law, t_end=END).at(time)
    scale = np.abs(exact["x"]).max()
    np.testing.assert_allclose(run["body.x"], exact["x"], rtol=0, atol=TOLERANCE * scale)
    if equations_of(law).holds:
        resting = np.asarray(exact["mode"]) == 0
        at_rest = run["body.direction"] == 0
        assert np.all(run["body.v"][at_rest] == 0.0)
        assert np.mean(resting != at_rest) < 0.02  # samples beside an event


def test_units_of_a_turning_joint_are_those_of_torques():
    text = export(example_of(LuGre), "modelica").files["Lugre.mo"]
    assert 'velocity(unit="m/s")' in text
    assert modelica_unit("N m s^2/rad^2") == "N.m.s2/rad2"


@pytest.mark.parametrize(("name", "package"), [("real", "Real_"), ("my axis 2", "MyAxis2")])
def test_packages_begin_with_a_capital_and_are_no_words_of_the_language(name, package):
    law = CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=0.1)
    assert list(export(law, "modelica", name=name).files) == [f"{package}.mo"]


def test_a_quotation_mark_in_a_title_stays_inside_of_its_comment():
    text = export(LAWS_EXPORTED["hostile"], "modelica").files["Hostile.mo"]
    assert all(line.lstrip().startswith("//") for line in text.splitlines()[1:6])
    assert Stribeck.title not in text
