"""Gears that their load drives back: they hold exactly, break away at closed forms, lose energy."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip import EventDriven, Pendulum, simulate
from stickslip.friction import LAWS, bound
from stickslip.mechanisms.drives import Ramp, Sampled, Sine

SERVO = Pendulum(mass=0.5, length=0.16)
WEIGHT = 0.5 * 9.81 * 0.16
"""Torque of gravity at an angle of pi/2 [N m]."""
PLAIN = EventDriven(tier="python")
COMMON = {"kinetic_coefficient": 0.02, "viscous_coefficient": 0.02}
FADING = COMMON | {"static_coefficient": 0.05, "stribeck_velocity": 0.1, "fading_exponent": 1.0}
SHARES = {"motor_friction": 0.15, "external_friction": 0.25}
MORE = {"motor_static_friction": 0.05, "external_static_friction": 0.1}
LAW = {
    "bam-m1": LAWS["bam-m1"](**COMMON),
    "bam-m2": LAWS["bam-m2"](**FADING),
    "bam-m3": LAWS["bam-m3"](**COMMON, transmitted_coefficient=0.2),
    "bam-m4": LAWS["bam-m4"](**FADING, transmitted_coefficient=0.2, transmitted_static_surplus=0.1),
    "bam-m5": LAWS["bam-m5"](**FADING, **SHARES, **MORE),
    "bam-m6": LAWS["bam-m6"](
        **FADING, **SHARES, **MORE, motor_quadratic=0.2, external_quadratic=0.1
    ),
}


def constant(torque):
    """Return a drive that does not change."""
    return Sampled(times=[0.0], values=[torque])


def last(run):
    """Return the angle at the end of a run."""
    return float(run["theta"][-1])


def driven_back(name, motor):
    """Return the torque of a weight from which it drives a motor back that holds against it."""
    law = LAW[name]
    rest = getattr(law, "static_coefficient", law.kinetic_coefficient)
    if name in ("bam-m1", "bam-m2"):
        return motor + rest
    if name in ("bam-m3", "bam-m4"):
        share = law.transmitted_coefficient + getattr(law, "transmitted_static_surplus", 0.0)
        return (rest + motor * (1.0 + share)) / (1.0 - share)
    of_motor, of_weight = 0.15 + 0.05, 0.25 + 0.1
    square = 0.2 * motor**2 if name == "bam-m6" else 0.0  # of the smaller torque, the motor's
    return (rest + motor * (1.0 + of_motor) + square) / (1.0 - of_weight)


def driven_ahead(name, weight):
    """Return the torque of a motor from which it lifts a weight."""
    law = LAW[name]
    rest = getattr(law, "static_coefficient", law.kinetic_coefficient)
    if name in ("bam-m1", "bam-m2"):
        return weight + rest
    if name in ("bam-m3", "bam-m4"):
        share = law.transmitted_coefficient + getattr(law, "transmitted_static_surplus", 0.0)
        return (rest + weight * (1.0 + share)) / (1.0 - share)
    square = 0.1 * weight**2 if name == "bam-m6" else 0.0  # of the smaller torque, the weight's
    return (rest + weight * (1.0 + 0.25 + 0.1) + square) / (1.0 - 0.15 - 0.05)


@pytest.mark.parametrize("motor", [0.0, 0.1])
@pytest.mark.parametrize("name", LAW)
def test_a_weight_drives_a_gear_back_from_the_angle_of_the_closed_form(name, motor):
    angle = math.asin(driven_back(name, motor) / WEIGHT)
    held = replace(SERVO, drive=constant(motor))
    for beside, moves in ((-1e-6, False), (1e-6, True)):
        run = simulate(held, LAW[name], t_end=0.5, y0={"theta": angle + beside}, solver=PLAIN)
        assert run.certificate.certified
        # what holds holds exactly: the angle stays to the last digit
        assert (last(run) < angle + beside) == moves
        assert moves or last(run) == angle + beside


@pytest.mark.parametrize("name", LAW)
def test_a_motor_lifts_a_weight_from_the_torque_of_the_closed_form(name):
    rate = 0.5
    angle = math.asin(0.9 * driven_back(name, 0.0) / WEIGHT)  # at first the gear holds it
    lifting = replace(SERVO, drive=Ramp(rate=rate))
    wanted = driven_ahead(name, WEIGHT * math.sin(angle)) / rate
    run = simulate(lifting, LAW[name], t_end=wanted + 0.1, y0={"theta": angle}, solver=PLAIN)
    first = next(event for event in run.events if event.from_mode == 0)
    assert first.t == pytest.approx(wanted, rel=1e-9)
    assert first.to_mode == 1


@pytest.mark.parametrize("name", ["bam-m3", "bam-m4", "bam-m5", "bam-m6"])
def test_a_gear_that_loses_all_that_drives_it_back_locks_itself_under_any_weight(name):
    law = LAW[name]
    locks = (
        replace(law, transmitted_coefficient=1.0)
        if name in ("bam-m3", "bam-m4")
        else replace(law, external_friction=1.0)
    )
    for weight in (1.0, 100.0, 1e4):
        heavy = replace(SERVO, mass=SERVO.mass * weight)
        run = simulate(heavy, locks, t_end=1.0, y0={"theta": 0.5 * math.pi}, solver=PLAIN)
        assert not run.events
        assert last(run) == 0.5 * math.pi
    lowered = replace(SERVO, drive=constant(-0.4))
    run = simulate(lowered, locks, t_end=1.0, y0={"theta": 0.5 * math.pi}, solver=PLAIN)
    assert last(run) < 0.5 * math.pi  # a motor lowers what the gear holds


@pytest.mark.parametrize("name", LAW)
def test_friction_of_a_gear_that_turns_both_ways_stays_within_its_level_and_takes_energy(name):
    push = Sine(amplitude=0.5, frequency=0.4) + Sine(amplitude=0.3, frequency=1.1)
    servo = replace(SERVO, drive=push)
    law = LAW[name]
    run = simulate(servo, law, t_end=8.0, y0={"theta": 1.4}, solver=PLAIN)
    assert run.certificate.certified
    reversals = [event.to_mode for event in run.events]
    assert {1, -1} <= {*reversals}  # lifts and is driven back
    t = np.linspace(0.0, 8.0, 4001)
    seen = run.at(t)
    friction, v = seen["friction"], seen["omega"]
    external = -WEIGHT * np.sin(seen["theta"])
    motor = np.array([push.value(float(moment)) for moment in t])
    told = bound(law, {"motor": motor, "external": external, "transmitted": motor - external})
    held = seen["mode"] == 0
    assert held.any() == (name not in ("bam-m1", "bam-m2"))  # the loaded gears stick on the way
    assert np.all(friction * v >= 0.0)
    assert np.all(v[held] == 0.0)
    most = np.asarray(told.break_away(1.0)) + law.viscous_coefficient * np.abs(v)
    assert np.all(np.abs(friction) <= most * (1.0 + 1e-9))
    assert np.all(np.abs(friction[held] - (motor + external)[held]) < 1e-12)
    # without a motor the energy of a swing falls all the time
    free = simulate(SERVO, law, t_end=4.0, y0={"theta": 2.5}, solver=PLAIN)
    swing = free.at(np.linspace(0.0, float(free.t[-1]), 2001))
    energy = 0.5 * 0.5 * 0.16**2 * swing["omega"] ** 2 - WEIGHT * np.cos(swing["theta"])
    assert np.all(np.diff(energy) <= 1e-9 * WEIGHT)
    assert free.certificate.work_friction > 0.0
