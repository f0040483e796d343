"""Friction that grows with a power of the speed: closed forms, down to where it ends."""

import math

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, EventDriven, PowerViscous, QuadraticDrag, simulate
from stickslip.friction.parts.flows import PLATEAU
from stickslip.mechanisms.drives import PiecewiseLinear, Ramp

M, SIGMA, V0 = 1.5, 0.8, 0.6
SMOOTH = 1e-11
"""Steps of 1e-12, some ten of them."""


def law(n, level=0.0, sigma=SIGMA):
    return PowerViscous(kinetic_coefficient=level, viscous_coefficient=sigma, viscous_exponent=n)


def travel(n, v=V0):
    """Return the way from a speed to rest that a power alone allows."""
    return M * v ** (2.0 - n) / (SIGMA * (2.0 - n))


def beyond(n):
    """Return by how much the straight line below the plateau's end lengthens that way."""
    return M * PLATEAU ** (2.0 - n) / SIGMA - travel(n, PLATEAU)


def test_a_root_of_the_speed_brakes_along_a_parabola():
    stop = 2.0 * M * math.sqrt(V0) / SIGMA
    run = simulate(Axis(inertia=M), law(0.5), t_end=2.0 * stop, y0={"v": V0})
    t = np.linspace(0.0, 0.998 * stop, 40)
    v = (math.sqrt(V0) - SIGMA * t / (2.0 * M)) ** 2
    assert v[-1] > 2.0 * PLATEAU
    np.testing.assert_allclose(run.at(t)["v"], v, rtol=0, atol=SMOOTH * V0)
    x = (V0**1.5 - v**1.5) * 2.0 * M / (3.0 * SIGMA)
    np.testing.assert_allclose(run.at(t)["x"], x, rtol=0, atol=SMOOTH * x[-1])
    # where the parabola has ended, what is left of the speed is below a thousandth of the plateau
    assert run.at(1.01 * stop)["v"][0] < 1e-3 * PLATEAU
    assert run.certificate.certified


@pytest.mark.parametrize("n", [0.1, 0.3, 0.5, 0.7, 0.9, 1.5])
def test_the_way_to_rest_is_that_of_the_power_but_for_the_plateau(n):
    run = simulate(Axis(inertia=M), law(n), t_end=1e3, y0={"v": V0})
    expected = travel(n) + beyond(n)
    assert run.certificate.certified
    if n < 1.0:
        assert math.isclose(run["x"][-1], expected, rel_tol=SMOOTH)
        assert math.isclose(run["x"][-1], travel(n), rel_tol=3e-7)  # 1e-6 to the power 1.1
    else:  # a power above 1 takes ever longer: where it is after this time
        v = (V0 ** (1.0 - n) + (n - 1.0) * SIGMA * 1e3 / M) ** (1.0 / (1.0 - n))
        assert v > PLATEAU
        assert math.isclose(run["v"][-1], v, rel_tol=1e-6)  # of 1e-12 of its first value
        assert math.isclose(run["x"][-1], travel(n) - travel(n, v), rel_tol=SMOOTH)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_a_level_and_a_root_stop_a_block_where_their_logarithm_says(direction):
    level = 0.3
    run = simulate(Axis(inertia=M), law(0.5, level), t_end=10.0, y0={"v": direction * V0})
    w, ratio = math.sqrt(V0), level / SIGMA
    logarithm = math.log(1.0 + w / ratio)
    stop = 2.0 * M / SIGMA * (w - ratio * logarithm)
    x = 2.0 * M / SIGMA * (w**3 / 3.0 - ratio * w**2 / 2.0 + ratio**2 * w - ratio**3 * logarithm)
    assert [event.reason for event in run.events] == ["stop"]
    # the plateau lasts for m 1e-6 / 0.3, and its force is off by less than a hundredth of the level
    assert math.isclose(run.events[0].t, stop, abs_tol=0.01 * M * PLATEAU / level)
    assert math.isclose(run["x"][-1], direction * x, rel_tol=SMOOTH)


@pytest.mark.parametrize("level", [0.0, 0.5])
def test_under_a_growing_force_a_block_leaves_rest_with_the_cube_of_time(level):
    # m = sigma = 1 and F = t after break-away: v = t^2 / 4 solves v' = t - v^0.5
    run = simulate(Axis(inertia=1.0, drive=Ramp(rate=1.0)), law(0.5, level, 1.0), t_end=3.0)
    t = np.linspace(level, 3.0, 20)
    # the plateau makes it leave later, by about its own length in time: 2e-3 s of another path
    np.testing.assert_allclose(run.at(t)["x"], (t - level) ** 3 / 12.0, rtol=0, atol=1e-8)
    assert run.certificate.certified


@pytest.mark.parametrize("n", [0.2, 0.4])
@pytest.mark.parametrize("tier", ["python", pytest.param("compiled", marks=pytest.mark.slow)])
def test_creep_from_rest_under_a_slowly_growing_force_is_certified(n, tier):
    # without a plateau the slope at rest has no bound, and such a run ends in ever smaller steps
    rig = Axis(inertia=1.0, drive=Ramp(rate=0.1))
    run = simulate(rig, law(n, 0.01), t_end=2.0, solver=EventDriven(tier=tier))
    assert run.certificate.certified
    assert run.certificate.steps < 5000
    # what the drive leaves of level and power is the momentum gained, by differences of 1e-3 s
    before, v, after = run.at([1.899, 1.9, 1.901])["v"]
    assert v > PLATEAU
    left = 0.1 * 1.9 - 0.01 - SIGMA * v**n
    assert math.isclose(left, (after - before) / 2e-3, rel_tol=1e-4)


def test_a_pull_ends_at_the_speed_whose_power_takes_it():
    pull, level, n = 1.3, 0.4, 0.6
    rig = Axis(inertia=M, drive=PiecewiseLinear(times=(0.0, 200.0), values=(pull, pull)))
    run = simulate(rig, law(n, level), t_end=120.0)  # fading by 0.3 a second
    assert math.isclose(run["v"][-1], ((pull - level) / SIGMA) ** (1.0 / n), rel_tol=SMOOTH)


def test_with_the_exponent_1_a_run_is_that_of_coulomb_and_viscous_friction():
    plain = CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=SIGMA)
    rig = Axis(inertia=M, stiffness=40.0)
    run, other = (simulate(rig, it, t_end=3.0, y0={"x": 0.3}) for it in (plain, law(1.0, 0.2)))
    np.testing.assert_array_equal(other["x"], run["x"])
    assert other.events == run.events


def test_with_the_exponent_2_a_run_is_that_of_drag():
    drag = QuadraticDrag(kinetic_coefficient=0.2, quadratic_coefficient=SIGMA)
    rig = Axis(inertia=M, stiffness=40.0)
    run, other = (simulate(rig, it, t_end=3.0, y0={"x": 0.3}) for it in (drag, law(2.0, 0.2)))
    assert [event.reason for event in other.events] == [event.reason for event in run.events]
    # below the plateau's end the two forces differ by less than 1e-12 N
    np.testing.assert_allclose(other["x"][-1], run["x"][-1], rtol=0, atol=1e-10)


def test_all_lengths_and_forces_may_grow_together_but_for_the_plateau():
    factor, n = 1024.0, 0.5
    thick = law(n, 0.3 * factor, SIGMA * factor ** (1.0 - n))
    small = simulate(Axis(inertia=M), law(n, 0.3), t_end=9.0, y0={"v": V0})
    large = simulate(Axis(inertia=M), thick, t_end=9.0, y0={"v": V0 * factor})
    assert math.isclose(large["x"][-1], small["x"][-1] * factor, rel_tol=SMOOTH)


def test_the_force_is_continuous_at_the_plateau_and_straight_within():
    for n in (0.3, 0.5, 2.0):
        edge = law(n).force(PLATEAU, 1.0)
        assert math.isclose(edge, SIGMA * PLATEAU**n, rel_tol=1e-14)
        assert math.isclose(law(n).force(0.25 * PLATEAU, 1.0), 0.25 * edge, rel_tol=1e-14)
        above = law(n).force(PLATEAU * (1.0 + 1e-12), 1.0)
        assert math.isclose(above, edge, rel_tol=1e-11)
