"""A cart with a pendulum on ground that vibrates along its normal."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Coulomb, PendulumCart, simulate
from stickslip.mechanisms.drives import Pulse, Sine

MASS, BALL, LENGTH, GRAVITY = 0.5, 0.1, 0.3, 9.81
SHAKING = Sine(amplitude=6.0, frequency=3.0)
CART = PendulumCart(cart_mass=MASS, ball_mass=BALL, length=LENGTH, ground=SHAKING)
START = {"theta": math.pi - 0.3}


def test_a_cart_that_sticks_carries_a_pendulum_whose_weight_varies():
    """The equation of a parametrically excited pendulum (Mathieu's with a large angle)."""
    run = simulate(CART, Coulomb(kinetic_coefficient=50.0), t_end=3.0, y0=START)

    def slopes(t, y):
        return [y[1], (GRAVITY + SHAKING.value(t)) / LENGTH * math.sin(y[0])]

    known = solve_ivp(slopes, (0.0, 3.0), [START["theta"], 0.0], rtol=1e-11, atol=1e-12)
    assert run["x"][-1] == 0.0
    assert run["theta"][-1] == pytest.approx(known.y[0, -1], rel=1e-7)
    assert run.certificate.certified


def test_a_steady_acceleration_of_the_ground_is_a_larger_gravity():
    law = Coulomb(kinetic_coefficient=0.005)
    lifted = replace(CART, ground=Pulse(level=2.0, duration=10.0))
    heavier = replace(CART, ground=None, gravity=GRAVITY + 2.0)
    ours, theirs = (simulate(one, law, t_end=2.0, y0=START) for one in (lifted, heavier))
    for column in ("x", "theta", "normal_force"):
        assert ours[column][-1] == pytest.approx(theirs[column][-1], rel=1e-9)
    assert np.ptp(ours["x"]) > 1e-3


def test_the_normal_force_follows_the_ground():
    run = simulate(replace(CART, ball_mass=1e-9), Coulomb(kinetic_coefficient=0.1), t_end=1.0)
    known = MASS * (GRAVITY + np.array([SHAKING.value(t) for t in run.t]))
    np.testing.assert_allclose(run["normal_force"], known, rtol=1e-6)


def test_it_lifts_off_where_the_ground_falls_faster_than_gravity():
    falling = replace(CART, ground=replace(SHAKING, amplitude=12.0), ball_mass=1e-9)
    run = simulate(falling, Coulomb(kinetic_coefficient=0.1), t_end=1.0, throw=False)
    assert run.ending.startswith("Lift-off")
    phase = math.pi + math.asin(GRAVITY / 12.0)
    assert run.t[-1] == pytest.approx(phase / (2.0 * math.pi * 3.0), rel=1e-6)
