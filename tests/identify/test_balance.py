"""`select` by the force balance: records of one coordinate, from the call to the document."""

import json

import numpy as np
import pytest

from stickslip import Axis, Measurement, select, simulate
from stickslip.drives import PiecewiseLinear
from stickslip.errors import InputError
from stickslip.friction import law

RATE, SECONDS = 500.0, 12.0
T = np.arange(0.0, SECONDS, 1.0 / RATE)
TRUTH = law("level + viscous")(kinetic_coefficient=1.0, viscous_coefficient=0.3)
INERTIA = 0.02


def record(seed, gain=1.0):
    random = np.random.default_rng(seed)
    phases = random.uniform(0.0, 2.0 * np.pi, 4)
    force = sum(
        a * np.sin(2.0 * np.pi * f * T + p)
        for a, f, p in zip((1.2, 0.8, 0.6, 0.4), (0.4, 0.9, 1.7, 3.1), phases, strict=True)
    )
    axis = Axis(inertia=INERTIA, drive=PiecewiseLinear(times=T, values=force))
    x = simulate(axis, TRUTH, t_end=float(T[-1])).at(T)["x"]
    return Measurement(time=T, position=x + 1e-5 * random.normal(size=len(T)), force=gain * force)


@pytest.fixture(scope="module")
def verdict():
    return select(
        Axis(inertia=1.0),
        None,
        record(1),
        vary=["friction.*", "mechanism.inertia"],
        route="balance",
        validate=record(2),
    )


def test_law_inertia_and_levels_of_an_axis_lie_in_their_intervals(verdict):
    assert {"level", "viscous"} <= set(verdict.family)
    truth = {"inertia": INERTIA, "kinetic_coefficient": 1.0, "viscous_coefficient": 0.3}
    found = {one.path.rpartition(".")[2]: one for one in verdict.parameters}
    for name, value in truth.items():
        assert found[name].low_any <= value <= found[name].high_any
        assert found[name].value == pytest.approx(value, rel=0.05)


def test_the_band_of_an_axis_holds_its_steady_friction(verdict):
    v = np.geomspace(0.2, float(verdict.speeds.max()), 20)
    band = verdict.band(v)
    assert np.mean((band.low <= 1.0 + 0.3 * v) & (1.0 + 0.3 * v <= band.high)) >= 0.9


def test_a_second_record_lies_in_the_band_of_readings(verdict):
    assert verdict.inside >= 0.9


def test_the_verdict_of_a_record_is_a_document_and_a_figure(verdict):
    said = json.loads(json.dumps(verdict.to_dict()))
    assert said["route"] == "balance"
    assert said["outliers"] == {}
    assert len(verdict.plot().lines) > 0


def test_a_record_of_a_motor_with_a_voltage_is_refused_with_the_cure():
    one = record(1)
    motor = Measurement(time=T, position=one.position, voltage=one.force, current=one.force)
    with pytest.raises(InputError):
        select(Axis(inertia=1.0), None, motor, route="balance")


def test_two_parameters_of_the_mechanism_are_refused():
    with pytest.raises(InputError, match="finds one parameter of the mechanism"):
        select(
            Axis(inertia=1.0, stiffness=1.0),
            None,
            record(1),
            vary=["mechanism.inertia", "mechanism.stiffness"],
            route="balance",
        )


def test_a_coast_down_at_one_sample_a_second_is_judged():
    """76 kg, 1.2 N and 0.03 N s^2/m^2: v = sqrt(F/c) tan(phi - t sqrt(F c) / m), a closed form."""
    level, drag, mass = 1.2, 0.03, 76.0
    t = np.arange(0.0, 330.0)
    scale = np.sqrt(level / drag)
    v = scale * np.tan(np.arctan(8.0 / scale) - t * np.sqrt(level * drag) / mass)
    read = v + 0.02 * np.random.default_rng(0).normal(size=len(t))
    found = select(Axis(inertia=mass), None, Measurement(time=t, velocity=read), route="balance")
    u = np.linspace(1.0, 7.0, 13)
    band = found.band(u)
    truth = level + drag * u**2
    assert ((band.low <= truth) & (truth <= band.high)).all()
