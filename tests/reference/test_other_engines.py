"""Reference runs of other engines, beside the exact numbers that come with them."""

import json

import numpy as np
import pandas as pd
import pytest

from stickslip import Axis, Coulomb, Status, simulate


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
