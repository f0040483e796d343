"""Reference runs of other engines, beside the exact numbers that come with them."""

import json

import numpy as np
import pandas as pd
import pytest

from stickslip import Axis, Coulomb, Stribeck, simulate
from stickslip.engine import Status
from stickslip.mechanisms.drives import Sine


def test_the_friction_oscillator_rests_where_the_exact_solution_does(data_dir):
    folder = data_dir / "siconos_friction_oscillator"
    known = json.loads((folder / "dataset.json").read_text(encoding="utf-8"))["known"]
    oscillator = Axis(inertia=known["m"], stiffness=known["k"])
    law = Coulomb(kinetic_coefficient=known["Fc"])
    run = simulate(oscillator, law, t_end=100.0, y0={"x": known["x0"], "v": known["v0"]})
    assert run.status is Status.AT_REST
    assert [event.reason for event in run.events] == ["reversal"] * 7 + ["stop"]
    # the digits of the record's notes: eight reversals, rest at this time and place
    assert run.events[-1].t == pytest.approx(22.42355635069909, rel=1e-10)
    assert run["x"][-1] == pytest.approx(0.6821789367236466, rel=1e-10)


def test_time_stepping_stays_within_its_known_error_of_the_exact_run(data_dir):
    folder = data_dir / "siconos_friction_oscillator"
    reference = pd.read_parquet(folder / "reference.parquet")
    oscillator = Axis(inertia=1.0, stiffness=1.0)
    law = Coulomb(kinetic_coefficient=1.0)
    run = simulate(oscillator, law, t_end=100.0, y0={"x": 12.0, "v": 6.0})
    ours = run.at(reference["t_s"].to_numpy())["x"]
    # Moreau-Jean with a step of 0.01 s is off by 0.025 at most, by the record's notes
    assert np.abs(ours - reference["x"].to_numpy()).max() < 0.026


def test_the_braked_mass_stops_where_modelica_stops_it(data_dir):
    reference = pd.read_parquet(data_dir / "modelica_brake" / "reference.parquet")
    brake = Axis(inertia=1.0, load=2.0)  # mu = 0.5 at twice 1 N, from 0.1 s on
    run = simulate(brake, Coulomb(kinetic_coefficient=0.5), t_end=2.0, y0={"x": 0.1, "v": 1.0})
    assert run["x"][-1] == pytest.approx(0.6, rel=1e-12)
    # the reference was made with a tolerance of 1e-6
    assert float(reference["mass1.s"].iloc[-1]) == pytest.approx(run["x"][-1], abs=1e-5)


@pytest.fixture(scope="module")
def modelica_friction(data_dir):
    """Return the reference result of Translational.Examples.Friction."""
    return pd.read_parquet(data_dir / "modelica_friction" / "reference.parquet")


def modelica_law(coulomb, stribeck):
    """Return F_prop v + F_C + F_S exp(-2 v) with F_prop = 1, and 1.001 (F_C + F_S) at rest."""
    return Stribeck(
        kinetic_coefficient=coulomb,
        static_coefficient=coulomb + stribeck,
        stribeck_velocity=0.5,
        viscous_coefficient=1.0,
        fading_exponent=1,
        break_away_coefficient=1.001 * (coulomb + stribeck),
    )


def test_the_driven_mass_switches_when_the_exact_solution_does(modelica_friction):
    driven = Axis(inertia=1.0, drive=Sine(amplitude=25.0, frequency=0.25))
    run = simulate(driven, modelica_law(5.0, 10.0), t_end=5.0)
    # the digits of the record's notes; without a break-away level of its own the first is 4.8e-4 s
    # early
    assert [event.reason for event in run.events] == ["break-away", "reversal", "reversal"]
    exact = [0.41014313, 2.44269042, 4.44194243]
    np.testing.assert_allclose([event.t for event in run.events], exact, rtol=0, atol=1e-8)
    ours = run.at(modelica_friction["time"].to_numpy())
    # DASSL with 1e-6 is off by 5.4e-5 m and 7.8e-5 m/s, by the record's notes
    assert np.abs(ours["x"] - modelica_friction["stop1.s"]).max() < 1e-4
    assert np.abs(ours["v"] - modelica_friction["stop1.v"]).max() < 1e-4


def test_the_sprung_mass_hits_its_stop_and_rests_as_in_modelica(modelica_friction):
    # a spring of 1 m from -1.75 m to the left face, 0.5 m left of s: at rest for s = -0.25 m;
    # faces at -0.9 m and 0.9 m are places of -0.4 m and 0.4 m
    sprung = Axis(inertia=1.0, stiffness=500.0, offset=125.0, lower_stop=-0.4, upper_stop=0.4)
    run = simulate(sprung, modelica_law(3.0, 5.0), t_end=5.0, y0={"v": -5.0})
    reasons = [event.reason for event in run.events]
    assert reasons == ["hits stop"] + ["reversal"] * 6 + ["stop"]
    assert run.status is Status.AT_REST
    t = modelica_friction["time"].to_numpy()
    assert run.events[0].t == pytest.approx(0.060597, abs=5e-7)  # the record's, to its tolerance
    assert run.events[-1].t == pytest.approx(1.045974, abs=1e-5)
    ours = run.at(t)
    # DASSL with 1e-6 was as far off in the test above; the impact takes 6.1 m/s in no time, and
    # falls 1.4e-7 s earlier there
    away = np.abs(t - run.events[0].t) > 1e-6
    assert np.abs(ours["x"] - modelica_friction["stop2.s"]).max() < 1e-5
    assert np.abs(ours["v"] - modelica_friction["stop2.v"])[away].max() < 1e-4
    assert run["x"].min() == -0.4
