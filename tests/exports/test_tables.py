"""CSV and JSON: what our own readers take back."""

import json

import numpy as np
import pytest
from tests.exports.laws import LAWS_EXPORTED

from stickslip import (
    Axis,
    CoulombViscous,
    Measurement,
    Pendulum,
    Rig,
    Stribeck,
    export,
    fit,
    load_measurement,
)

LAW = Stribeck(
    kinetic_coefficient=20.0, static_coefficient=28.0, stribeck_velocity=0.03,
    viscous_coefficient=40.0,
)  # fmt: skip


@pytest.fixture(scope="module")
def fitted():
    v = np.linspace(-1.0, 1.0, 200)
    noise = np.random.default_rng(0).normal(0.0, 0.3, v.size)
    friction = np.array([LAW.force(float(speed), load=1.0) for speed in v]) + noise
    return fit(Axis(inertia=3.0), "stribeck", Measurement(velocity=v, friction=friction))


@pytest.mark.parametrize("name", LAWS_EXPORTED)
def test_the_table_is_read_back_as_the_law_in_si(tmp_path, name):
    law = LAWS_EXPORTED[name]
    (path,) = export(law, "csv", name=name, load=7.0, largest_speed=0.5).save(tmp_path)
    found = load_measurement(path)
    true = [
        law.steady(float(v), 7.0) if law.states else law.force(float(v), 7.0)
        for v in found.velocity
    ]
    np.testing.assert_array_equal(found.friction, true)
    np.testing.assert_array_equal(found.velocity, -found.velocity[::-1])
    assert np.all(np.diff(found.velocity) > 0.0)
    assert (found.velocity[0], found.velocity[-1]) == (-0.5, 0.5)


def test_a_fit_to_the_table_finds_the_parameters_again(tmp_path):
    (path,) = export(LAW, "csv", load=1.0, largest_speed=1.0).save(tmp_path)
    again = fit(Axis(inertia=3.0), "stribeck", load_measurement(path))
    for name in ("kinetic_coefficient", "static_coefficient", "stribeck_velocity"):
        true, found = getattr(LAW, name), again.estimate(name)
        assert found.low < true < found.high
        # the table is exact; a reading counts as having some noise all the same
        assert found.value == pytest.approx(true, rel=0.02)


def test_a_table_of_a_turning_joint_is_in_torques(tmp_path):
    law = CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=0.1)
    rig = Rig(mechanism=Pendulum(mass=1.0, length=0.5))
    (path,) = export(law, "csv", rig=rig, largest_speed=2.0).save(tmp_path)
    assert "velocity [rad/s],friction [N m]" in path.read_text(encoding="utf-8")
    assert load_measurement(path).turning


def test_json_has_values_units_intervals_covariance_and_provenance(fitted, tmp_path):
    fitted.save(tmp_path / "law.toml")
    from stickslip import load_rig

    rig = load_rig(tmp_path / "law.toml")
    found = json.loads(export(rig, "json").files["stribeck.json"])
    assert found["schema"] == "stickslip/law/1"
    first = found["parameters"][0]
    estimate = fitted.estimate("kinetic_coefficient")
    assert (first["value"], first["unit"]) == (estimate.value, "N")
    assert (first["low"], first["high"]) == pytest.approx((estimate.low, estimate.high))
    assert first["interval"] == "95 %"
    known = fitted.law_estimates()
    np.testing.assert_allclose(found["covariance"], known.covariance, rtol=1e-12)
    assert found["provenance"] == f"law.toml, SHA-256 {rig.digest}"
    assert found["largest_speed"] == 1.0
    assert found["shape"] == {"fading_exponent": 2.0}


def test_a_fit_and_its_file_give_the_same_program(fitted, tmp_path):
    from stickslip import load_rig

    fitted.save(tmp_path / "law.toml")
    own = export(fitted, "c").files["stribeck.c"]
    read = export(load_rig(tmp_path / "law.toml"), "c").files["stribeck.c"]
    assert [line for line in read.splitlines() if "Source:" not in line] == own.splitlines()
    assert "95 %" in own
