"""Coulomb friction with drag: motions that tangents and logarithms describe."""

import math

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, QuadraticDrag, simulate
from stickslip.engine import Status
from stickslip.mechanisms.drives import PiecewiseLinear

M, LEVEL, C = 2.0, 0.5, 3.0
LAW = QuadraticDrag(kinetic_coefficient=LEVEL, quadratic_coefficient=C)
SMOOTH = 1e-11
"""Steps of 1e-12, some ten of them."""


def test_a_braking_block_slows_down_along_a_tangent_and_stops():
    v0 = 1.5
    run = simulate(Axis(inertia=M), LAW, t_end=5.0, y0={"v": v0})
    phase = math.atan(v0 * math.sqrt(C / LEVEL))
    stop = M / math.sqrt(LEVEL * C) * phase
    t = np.linspace(0.0, 0.99 * stop, 23)
    v = math.sqrt(LEVEL / C) * np.tan(phase - math.sqrt(LEVEL * C) / M * t)
    np.testing.assert_allclose(run.at(t)["v"], v, rtol=0, atol=SMOOTH * v0)
    assert [event.reason for event in run.events] == ["stop"]
    assert math.isclose(run.events[0].t, stop, rel_tol=SMOOTH)
    travel = M / (2.0 * C) * math.log(1.0 + C * v0**2 / LEVEL)
    assert math.isclose(run["x"][-1], travel, rel_tol=SMOOTH)
    assert run.status is Status.AT_REST
    assert run.certificate.certified


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_pulled_block_nears_the_speed_at_which_drag_takes_the_pull(direction):
    pull = 2.0
    rig = Axis(inertia=M, drive=PiecewiseLinear(times=(0.0, 9.0), values=(direction * pull,) * 2))
    run = simulate(rig, LAW, t_end=4.0)
    t = np.linspace(0.0, 4.0, 17)
    excess = pull - LEVEL
    v = direction * math.sqrt(excess / C) * np.tanh(math.sqrt(excess * C) / M * t)
    np.testing.assert_allclose(run.at(t)["v"], v, rtol=0, atol=SMOOTH)


def test_viscous_friction_and_drag_without_a_level_slow_down_as_bernoulli_says():
    sigma, v0 = 0.8, 2.0
    law = QuadraticDrag(kinetic_coefficient=0.0, viscous_coefficient=sigma, quadratic_coefficient=C)
    t = np.linspace(0.0, 5.0, 21)
    run = simulate(Axis(inertia=M), law, t_end=5.0, y0={"v": v0})
    left = np.exp(-sigma * t / M)
    v = sigma * v0 * left / (sigma + C * v0 * (1.0 - left))
    np.testing.assert_allclose(run.at(t)["v"], v, rtol=0, atol=SMOOTH * v0)


def test_without_drag_a_run_is_that_of_coulomb_and_viscous_friction():
    rig = Axis(inertia=M, stiffness=30.0)
    values = {"kinetic_coefficient": LEVEL, "viscous_coefficient": 0.4}
    plain = simulate(rig, CoulombViscous(**values), t_end=3.0, y0={"x": 0.4})
    other = simulate(rig, QuadraticDrag(**values), t_end=3.0, y0={"x": 0.4})
    assert [e.reason for e in other.events] == [e.reason for e in plain.events]
    # one goes by exact series, the other by steps of 1e-12
    t = np.linspace(0.0, 3.0, 31)
    np.testing.assert_allclose(other.at(t)["x"], plain.at(t)["x"], rtol=0, atol=1e-10)
