"""Servos that a voltage drives: runs tell the motor before the balance tells friction."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks import servos

from stickslip import Axis, BamM4, CoulombViscous, Measurement, RecordSettings, fit, select
from stickslip.identify.refinement import refined

HELD = RecordSettings(hold="zero")


@pytest.fixture(scope="module")
def servo():
    return servos.draw(np.random.default_rng([78001, 2]))


@pytest.fixture(scope="module")
def record(servo):
    return servos.recorded(servo)


def guessed(servo):
    """Return the mechanism with constants of the motor that are a fifth off."""
    motor = servo.rig.drive
    off = replace(
        motor, resistance=0.8 * motor.resistance, torque_constant=1.2 * motor.torque_constant
    )
    return replace(servo.rig, drive=off)


@pytest.mark.slow
def test_select_judges_a_servo_of_unknown_constants(servo, record):
    verdict = select(
        guessed(servo), None, record, vary=["friction.*", *servos.VARIED], settings=HELD
    )
    motor = servo.rig.drive
    known = {one.path: one for one in verdict.parameters}
    for path, true in zip(servos.VARIED, (motor.resistance, motor.torque_constant), strict=True):
        assert known[path].low < true < known[path].high
        assert known[path].high - known[path].low < 0.04 * true
    share = known["friction.transmitted_coefficient"]
    # that of a law without a surplus at rest is between those of sliding and of rest
    true, law = known["friction.kinetic_coefficient"], servo.law
    assert share.high > law.transmitted_coefficient
    assert share.low < law.transmitted_coefficient + law.transmitted_static_surplus
    assert true.low < law.kinetic_coefficient < true.high
    assert any("Runs of the mechanism" in one for one in verdict.words.cannot_tell)
    assert not any("distinguished from viscous" in one for one in verdict.words.cannot_tell)


@pytest.mark.slow
def test_a_law_of_any_form_sees_what_the_gear_transmits(servo, record):
    found = fit(servo.rig, BamM4, record, fixed={"fading_exponent": 1.0}, settings=HELD)
    share = found.estimate("friction.transmitted_coefficient")
    assert share.low < servo.law.transmitted_coefficient < share.high
    assert share.value == pytest.approx(servo.law.transmitted_coefficient, rel=0.1)


def test_forces_that_are_linear_in_what_is_looked_for_need_no_runs():
    t = np.arange(0.0, 10.0, 0.01)
    force = 3.0 * np.cos(t) + np.sign(np.cos(t))
    pushed = Measurement(time=t, position=np.sin(t), force=force)
    assert refined(Axis(inertia=1.0), pushed, ["mechanism.inertia"]) is None


def test_runs_that_do_not_tell_constants_apart_leave_them_to_the_balance(servo):
    plain = replace(servo, law=CoulombViscous(kinetic_coefficient=0.05, viscous_coefficient=0.02))
    assert refined(guessed(servo), servos.recorded(plain), servos.VARIED, hold="zero") is None
