"""Gears by their efficiencies: a composition against the formulas of Modelica's LossyGear."""

import math
import random
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from stickslip import EventDriven, Pendulum, simulate
from stickslip.friction import bound, law
from stickslip.mechanisms.drives import Ramp, Sampled, Sine

PLAIN = EventDriven(tier="python")
MOTOR = law("level + weight[motor] + viscous")
EXTERNAL = law("level + weight[external] + viscous")
EFFICIENCIES = [(0.9, 0.85), (0.5, 0.5), (0.7, 0.05), (1.0, 1.0)]
"""eta_mf1 and eta_mf2, of which the third hardly lets itself be driven back."""
WORM = (0.4, -0.2)
"""A gear that locks itself: nothing that pulls at its output is passed on."""
ARM = Pendulum(mass=0.5, length=0.16)
WEIGHT = 0.5 * 9.81 * 0.16
"""Torque of gravity at an angle of pi/2 [N m]."""


def lost(tau_a, speed, eta_1, eta_2, bearing_a, bearing_b):
    """Return the torque loss at the input flange as Modelica's documentation has it.

    ``-tau_b = i (eta_mf tau_a - tau_bf)`` with eta_mf1 where ``(tau_a - tau_bf_a) w_a > 0``, else
    with 1 / eta_mf2; the bearing friction of both flanges has the sign of the speed, which the
    documentation writes for ``w_a > 0``.
    """
    way = math.copysign(1.0, speed)
    drives = (way * tau_a - bearing_a) > 0.0
    share, bearing = (
        (eta_1, bearing_a * eta_1 + bearing_b)
        if drives
        else (1.0 / eta_2, bearing_a / eta_2 + bearing_b)
    )
    return (1.0 - share) * tau_a + way * bearing


def counted(inverse, plain):
    """Return how many times a torque counts: the mean of what passes one way and the other."""
    return 0.5 * (1.0 / inverse + plain)


def share(eta_1, eta_2):
    """Return the share of the torque that counts which the teeth take."""
    return (1.0 - eta_1 * eta_2) / (1.0 + eta_1 * eta_2)


@pytest.mark.parametrize(("eta_1", "eta_2"), EFFICIENCIES)
def test_a_gear_whose_load_has_the_inertia_loses_as_lossy_gear_at_200_random_states(eta_1, eta_2):
    rng = random.Random(0)
    bearing = 0.3
    gear = MOTOR(
        kinetic_coefficient=bearing, motor_coefficient=share(eta_1, eta_2), viscous_coefficient=0.0
    )
    for _ in range(200):
        tau, speed = rng.gauss(0.0, 2.0), rng.gauss(0.0, 1.0)
        told = counted(eta_2, eta_1) * tau
        left = told - bound(gear, {"motor": told}).force(speed, 1.0)
        wanted = tau - lost(tau, speed, eta_1, eta_2, 0.0, bearing)
        assert left == pytest.approx(wanted, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize(("eta_1", "eta_2"), EFFICIENCIES)
def test_a_gear_whose_motor_has_the_inertia_loses_as_lossy_gear_at_200_random_states(eta_1, eta_2):
    rng = random.Random(1)
    bearing = 0.3
    gear = EXTERNAL(
        kinetic_coefficient=bearing,
        external_coefficient=share(eta_1, eta_2),
        viscous_coefficient=0.0,
    )
    for _ in range(200):
        pull, speed = rng.gauss(0.0, 2.0), rng.gauss(0.0, 1.0)
        told = counted(eta_1, eta_2) * pull
        left = told - bound(gear, {"external": told}).force(speed, 1.0)

        def balance(tau, pull=pull, speed=speed):
            """Return what is left at a gear without mass: its output pulls as its load does."""
            return pull + tau - lost(tau, speed, eta_1, eta_2, bearing, 0.0)

        # the torque at the input that the load and the losses ask for takes the motor's place
        asked = brentq(balance, -1e3, 1e3, xtol=1e-13)
        assert left == pytest.approx(-asked, rel=1e-9, abs=1e-9)


def worm(eta_1, eta_2, bearing=0.01):
    """Return a pendulum behind a gear, whose weight counts as its efficiencies say, and its law."""
    arm = replace(ARM, gravity=9.81 * counted(eta_1, eta_2))
    gear = EXTERNAL(
        kinetic_coefficient=bearing,
        external_coefficient=share(eta_1, eta_2),
        viscous_coefficient=0.0,
    )
    return arm, gear


@pytest.mark.parametrize("weight", [1.0, 100.0, 1e4])
@pytest.mark.parametrize("eta_2", [0.0, -0.2])
def test_a_gear_without_efficiency_backwards_locks_itself_under_any_weight(eta_2, weight):
    arm, gear = worm(0.4, eta_2)
    heavy = replace(arm, mass=arm.mass * weight)
    run = simulate(heavy, gear, t_end=1.0, y0={"theta": 0.5 * math.pi}, solver=PLAIN)
    assert not run.events
    assert float(run["theta"][-1]) == 0.5 * math.pi


@pytest.mark.parametrize(("eta_1", "eta_2"), [*EFFICIENCIES[:3], WORM])
@pytest.mark.parametrize("way", [1, -1])
def test_a_motor_lifts_and_lowers_a_weight_from_the_torques_of_the_closed_form(eta_1, eta_2, way):
    bearing, angle = 0.01, 0.4
    arm, gear = worm(eta_1, eta_2, bearing)
    weight = WEIGHT * math.sin(angle)
    # up, the weight over eta_mf1 and the bearings; down, what eta_mf2 leaves of it less these
    to = weight / eta_1 + bearing if way > 0 else eta_2 * weight - bearing
    rate = 0.5
    ramp = Sampled(times=[0.0], values=[weight]) + Ramp(rate=way * rate)  # at first it is balanced
    wanted = abs(to - weight) / rate
    lifted = replace(arm, drive=ramp)
    run = simulate(lifted, gear, t_end=wanted + 0.05, y0={"theta": angle}, solver=PLAIN)
    first = next(event for event in run.events if event.from_mode == 0)
    assert first.t == pytest.approx(wanted, rel=1e-9)
    assert first.to_mode == way
    still = run["theta"][run.t < wanted * (1.0 - 1e-6)]
    assert np.all(still == angle)  # what holds holds exactly


@pytest.mark.parametrize(("eta_1", "eta_2"), [*EFFICIENCIES[:3], WORM])
def test_energy_of_a_swing_behind_a_gear_falls_all_the_time(eta_1, eta_2):
    arm, gear = worm(eta_1, eta_2, bearing=0.002)
    run = simulate(arm, gear, t_end=4.0, y0={"theta": 0.3, "omega": 6.0}, solver=PLAIN)
    swing = run.at(np.linspace(0.0, float(run.t[-1]), 2001))
    # of the weight as it is: what counts of it is how the gear passes it on
    energy = 0.5 * 0.5 * 0.16**2 * swing["omega"] ** 2 - WEIGHT * np.cos(swing["theta"])
    assert np.all(np.diff(energy) <= 1e-9 * WEIGHT)
    assert energy[-1] < energy[0] - 0.01


def test_a_gear_driven_the_other_way_round_moves_as_in_a_mirror():
    arm, gear = worm(0.7, 0.4)
    push = Sine(amplitude=0.9, frequency=0.7)
    turned = Sine(amplitude=0.9, frequency=0.7, phase=math.pi)
    runs = [
        simulate(
            replace(arm, drive=drive), gear, t_end=4.0, y0={"theta": side * 0.4}, solver=PLAIN
        ).at(np.linspace(0.0, 4.0, 401))["theta"]
        for side, drive in ((1.0, push), (-1.0, turned))
    ]
    assert np.ptp(runs[0]) > 0.1
    np.testing.assert_allclose(runs[0], -runs[1], atol=1e-9)
