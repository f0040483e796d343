"""A body with an unbalanced rotor, which is a cart whose pendulum turns at a constant rate.

Closed forms: the frictionless motion, the rate at which it lifts off, and the one at which it
begins to slip.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Coulomb, DirectionDependent, PendulumCart, simulate
from stickslip.engine import Status
from stickslip.errors import ParameterError
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import Rotation

BODY, ROTOR, ARM, GRAVITY = 0.5, 0.1, 0.02, 9.81
TOTAL = BODY + ROTOR


def robot(rate, incline=0.0, start=0.0):
    motor = Prescribed(profile=Rotation(rate=rate, start=start))
    return PendulumCart(
        cart_mass=BODY, ball_mass=ROTOR, length=ARM, pendulum=motor, incline=incline
    )


def lift_off_rate(incline):
    """Largest rate [rad/s] at which the normal force keeps its sign."""
    return math.sqrt(TOTAL * GRAVITY * math.cos(incline) / (ROTOR * ARM))


def test_without_friction_the_centre_of_mass_keeps_its_momentum():
    rate = 20.0
    run = simulate(robot(rate), Coulomb(kinetic_coefficient=0.0), t_end=1.0)
    share = ROTOR / TOTAL
    # at rest at time 0 with the ball moving at -rate * arm: that momentum goes on
    known = share * ARM * (np.sin(rate * run.t) - rate * run.t)
    np.testing.assert_allclose(run["x"], known, atol=1e-12)


@pytest.mark.parametrize("incline", [0.0, 0.2])
def test_it_lifts_off_above_the_rate_of_the_closed_form(incline):
    law = Coulomb(kinetic_coefficient=0.6)
    limit = lift_off_rate(incline)
    below = simulate(robot(0.999 * limit, incline, math.pi), law, t_end=1.0)
    assert below.status is Status.END_TIME
    assert below["normal_force"].min() > 0.0
    above = simulate(robot(1.001 * limit, incline, math.pi), law, t_end=1.0, throw=False)
    assert above.status is not Status.END_TIME
    assert above.ending.startswith("Lift-off")


@pytest.mark.parametrize("mu", [0.2, 0.5])
def test_it_slips_above_the_rate_of_the_closed_form(mu):
    """Centrifugal force m l w^2 against mu ((M + m) g - its upward part), at the worst angle."""
    limit = math.sqrt(mu * TOTAL * GRAVITY / (ROTOR * ARM * math.hypot(1.0, mu)))
    law = Coulomb(kinetic_coefficient=mu)
    slips = []
    for factor in (0.999, 1.001):
        run = simulate(robot(factor * limit, start=math.pi), law, t_end=1.0)
        slips.append(np.ptp(run["x"]))
    assert slips[0] == 0.0
    assert slips[1] > 0.0


def stepped(rate, forward, backward, t_end, h):
    """Moreau's time stepping: place of the body at the end [m]."""
    x = v = 0.0
    for i in range(round(t_end / h)):
        angle = rate * (i + 0.5) * h
        pull = ROTOR * ARM * rate**2
        normal = TOTAL * GRAVITY - pull * math.cos(angle)
        free = v - h * pull * math.sin(angle) / TOTAL
        loss = h * (forward if free > 0.0 else backward) * normal / TOTAL
        after = math.copysign(max(abs(free) - loss, 0.0), free)
        x, v = x + 0.5 * h * (v + after), after
    return x


def test_anisotropic_friction_makes_it_travel_as_time_steps_do():
    law = DirectionDependent(forward_kinetic_coefficient=0.1, backward_kinetic_coefficient=0.4)
    rate = 0.9 * lift_off_rate(0.0)
    run = simulate(robot(rate), law, t_end=2.0)
    assert run["x"][-1] == pytest.approx(stepped(rate, 0.1, 0.4, 2.0, 1e-5), rel=1e-4)
    mirrored = simulate(
        robot(-rate),
        replace(law, forward_kinetic_coefficient=0.4, backward_kinetic_coefficient=0.1),
        t_end=2.0,
    )
    assert mirrored["x"][-1] == pytest.approx(-run["x"][-1], rel=1e-12)


def test_a_rotor_that_does_not_turn_is_refused():
    with pytest.raises(ParameterError, match=r"Rotation.rate \(Omega\) must not be 0 rad/s"):
        Rotation(rate=0.0)
