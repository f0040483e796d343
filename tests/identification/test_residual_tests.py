"""Residuals name the error of a model, and are silent where the model is right."""

import functools
from dataclasses import replace

import numpy as np
import pytest
from benchmarks import faults

from stickslip import Axis, CoulombViscous, Measurement, fit, simulate
from stickslip.drives import Sampled, Sine
from stickslip.identification.settings import RecordSettings

QUICK = RecordSettings(starts=1)


def fitted(measurement, route="inverse-dynamics"):
    return fit(
        Axis(inertia=1.0), CoulombViscous, measurement, vary=["friction.*", "inertia"], route=route,
        settings=QUICK,
    )  # fmt: skip


@functools.cache
def faulty(name, seed=205):
    """A record with a fault, of a machine that nothing else disturbs."""
    random = np.random.default_rng(seed)
    while True:
        machine = faults.machine_of(random)
        machine = replace(machine, rig=replace(machine.rig, disturbance=0.005))
        machine = faults.FAULTS[name].machine(machine, random)
        found = machine.run(random)
        if found is not None:
            return faults.FAULTS[name].record(found, random)


@functools.cache
def of_fault(name):
    """Return the errors that are named of a record with a fault."""
    return fitted(faulty(name)).model_errors


NAMED = [
    ("sensor-delay", {"delay", "late or elastic"}),
    ("actuator-delay", {"delay", "late or elastic"}),
    ("amplifier-lag", {"delay", "late or elastic"}),
    ("cogging", {"position force"}),
    ("unknown-spring", {"spring"}),
    ("level-drift", {"drift of the level"}),
]
LONG = ("amplifier-lag", "unknown-spring")
"""Named by the tests that name others too, or as long as all others together."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "kinds"),
    [pytest.param(*one, marks=[pytest.mark.slow] * (one[0] in LONG)) for one in NAMED],
)
def test_the_fault_of_a_record_is_named_first(fault, kinds):
    errors = of_fault(fault)
    assert errors
    assert errors[0].kind in kinds


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "law"),
    [("place-dependence", "[position]"), ("stribeck-peak", "stribeck")],
)
def test_a_law_that_lacks_a_part_is_told_which_one_the_balance_asks_for(fault, law):
    errors = of_fault(fault)
    assert [one.kind for one in errors] == ["law"]
    assert law in errors[0].finding
    assert errors[0].share > 0.1


@pytest.mark.parametrize(
    ("fault", "late"),
    [("sensor-delay", 12e-3), pytest.param("actuator-delay", 6e-3, marks=pytest.mark.slow)],
)
def test_a_delay_is_found_with_its_size(fault, late):
    (error, *_) = of_fault(fault)
    # to first order in the delay: a tenth of it and the interval are the error
    half = error.effect - error.interval[0]
    assert error.effect == pytest.approx(late, abs=0.1 * late + 2.0 * half)


@pytest.mark.slow
def test_a_force_that_is_not_held_between_samples_is_named_as_a_setting():
    t = np.arange(0.0, 10.0, 0.01)
    drive = Sine(amplitude=6.0, frequency=0.5) + Sine(amplitude=3.0, frequency=1.3)
    law = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=5.0)
    run = simulate(Axis(inertia=2.0, drive=drive), law, t_end=10.0)
    noise = 1e-5 * np.random.default_rng(0).normal(size=len(t))
    force = np.array([drive.value(float(at)) for at in t])
    record = Measurement(time=t, position=run.at(t)["x"] + noise, force=force)
    along = functools.partial(
        fit, Axis(inertia=1.0), CoulombViscous, record, vary=["friction.*", "mechanism.inertia"],
        route="inverse-dynamics",
    )  # fmt: skip
    wrong = along(settings=replace(QUICK, hold="zero"))
    assert 'either set hold to "first"' in wrong.model_errors[0].finding
    assert wrong.hold.contradicted
    assert "does not agree with the given hold" in wrong.assumptions[0]
    found = along(settings=QUICK)
    assert (found.hold.hold, found.model_errors) == ("first", ())


@pytest.mark.slow
@pytest.mark.parametrize("records", [3, pytest.param(8, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "route", ["inverse-dynamics", pytest.param("shooting", marks=pytest.mark.slow)]
)
def test_residuals_of_the_right_law_name_nothing(route, records):
    said = [faults.clean(number, 206, route)["said"] for number in range(records)]
    # one of 20 may by the level of the tests: two of three with a probability of 1 %, of eight 6 %
    assert sum(map(bool, said)) <= 1


def test_a_record_of_another_quantity_is_not_tested():
    v = np.linspace(-1.0, 1.0, 80)
    table = Measurement(velocity=v, friction=2.0 * np.sign(v) + 0.5 * v)
    assert fit(Axis(inertia=1.0), CoulombViscous, table).model_errors == ()


@pytest.fixture(scope="module")
def late():
    return fit(
        Axis(inertia=1.0), CoulombViscous, faulty("sensor-delay"),
        vary=["friction.*", "mechanism.inertia"], route="inverse-dynamics", settings=QUICK,
    )  # fmt: skip


def test_a_fit_shows_its_error_of_the_model(late):
    found = late
    assert found.model_errors[0].kind == "delay"
    assert "lags the recorded force" in str(found)
    assert ".." not in str(found)
    assert "lags the recorded force" in found._repr_html_()
    assert found.to_dict()["model_errors"][0]["sentence"] == str(found.model_errors[0])


@pytest.mark.slow
def test_an_encoder_that_toggles_between_two_counts_is_no_vibration():
    step, rate, mass = 5e-6, 1000.0, 30.0
    t = np.arange(0.0, 20.0, 1.0 / rate)
    v = 0.05 * np.sin(1.3 * t) + 0.03 * np.sin(3.1 * t)
    x = -0.05 / 1.3 * np.cos(1.3 * t) - 0.03 / 3.1 * np.cos(3.1 * t)
    a = 0.05 * 1.3 * np.cos(1.3 * t) + 0.03 * 3.1 * np.cos(3.1 * t)
    force = mass * a + 10.0 * np.sign(v) + 20.0 * v
    force += 0.1 * np.random.default_rng(3).standard_normal(len(t))
    toggled = step * (np.round(x / step) + (np.sin(2.0 * np.pi * 443.0 * t) > 0.0))
    record = Measurement(time=t, position=toggled, force=force)
    errors = fit(Axis(inertia=mass), CoulombViscous, record, route="inverse-dynamics").model_errors
    assert not {"vibration"} & {one.kind for one in errors}


@pytest.mark.slow
def test_a_record_that_rests_most_of_the_time_is_tested_too():
    t = 0.005 * np.arange(1600)
    force = np.where(np.mod(t, 4.0) < 0.8, 30.0 * np.sin(2.5 * np.pi * t), 0.0)
    axis = Axis(inertia=1.0, drive=Sampled(times=t.tolist(), values=force.tolist()))
    law = CoulombViscous(kinetic_coefficient=10.0, viscous_coefficient=8.0)
    position = simulate(axis, law, t_end=float(t[-1])).at(t)["x"]
    position = position + np.random.default_rng(1).normal(0.0, 1e-6, len(t))
    found = fitted(Measurement(time=t, position=position, force=force))
    # of 1,600 samples 1,280 and more are at rest; the law holds, and inverse dynamics finds it
    assert found.estimates[0].value == pytest.approx(10.0, rel=0.02)
    assert not found.model_errors
