"""Runs against solutions known in closed form."""

import math

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    SpringBlock,
    Stribeck,
    TowedBlock,
    Viscous,
    simulate,
)
from stickslip.engine import Status
from stickslip.mechanisms.drives import Pulse

G = 9.81
LAW = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
LEVEL = 0.25 * G
EXACT = 1e-10
"""A hundred times the solver's tolerance of a step, for a few tens of steps and an event."""


def test_a_pushed_block_travels_as_far_as_the_work_of_the_push_allows():
    block = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
    run = simulate(block, LAW, t_end=2.0)
    travel = (10.0 - LEVEL) * 0.1**2 * 10.0 / (2 * LEVEL)
    assert math.isclose(travel, 0.1538736, abs_tol=5e-8)  # as printed
    assert math.isclose(run["x"][-1], travel, rel_tol=EXACT)
    assert run.status is Status.AT_REST


def test_a_block_released_from_a_spring_turns_all_of_its_energy_into_friction():
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    run = simulate(rig, LAW, t_end=2.0)
    travel = 100.0 * 0.1**2 / (2 * LEVEL)
    assert math.isclose(travel, 0.2038736, abs_tol=5e-8)  # as printed
    assert math.isclose(run["x"][-1], travel, rel_tol=EXACT)


def test_a_block_leaves_the_spring_at_its_natural_length():
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    run = simulate(rig, LAW, t_end=2.0)
    leaves = next(event.t for event in run.events if event.reason == "block leaves the spring")
    assert math.isclose(run.at(leaves)["x"][0], 0.1, rel_tol=EXACT)


@pytest.fixture(scope="module")
def attached():
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True)
    return simulate(rig, LAW, t_end=5.0)


def test_an_attached_block_first_stops_after_half_a_period(attached):
    reversal = next(event for event in attached.events if event.reason == "reversal")
    assert math.isclose(reversal.t, math.pi / 10.0, rel_tol=EXACT)
    x = 2 * (0.1 - LEVEL / 100.0)
    assert math.isclose(x, 0.15095, abs_tol=5e-6)  # as printed
    assert math.isclose(attached.at(reversal.t)["x"][0], x, rel_tol=EXACT)


def test_an_attached_block_must_return_where_the_spring_pulls_harder_than_break_away(attached):
    reversal = next(event for event in attached.events if event.reason == "reversal")
    pull = 100.0 * (2 * (0.1 - LEVEL / 100.0) - 0.1)
    assert pull > 0.35 * G
    assert math.isclose(reversal.margin, 0.35 * G - pull, rel_tol=1e-9)  # of the pull of 5.1 N


def test_an_attached_block_ends_where_the_spring_cannot_move_it_any_more(attached):
    assert attached.status is Status.AT_REST
    x = 2 * (0.1 - LEVEL / 100.0) - 2 * (0.1 - 2 * LEVEL / 100.0) + 2 * LEVEL / 100.0
    x = 0.1 - (0.1 - 4 * LEVEL / 100.0)
    assert math.isclose(x, 0.0981, abs_tol=5e-5)  # as printed
    assert math.isclose(attached["x"][-1], x, rel_tol=EXACT)
    assert abs(100.0 * (0.1 - x)) <= 0.35 * G


@pytest.mark.parametrize("mass", [0.3, 7.0])
def test_each_half_swing_takes_half_a_period_and_loses_two_friction_lengths(mass):
    k, f = 50.0, 1.0
    axis = Axis(inertia=mass, stiffness=k)
    run = simulate(axis, Coulomb(kinetic_coefficient=f), t_end=100.0, y0={"x": 0.4})
    turns = [event.t for event in run.events if event.reason in ("reversal", "stop")]
    half = math.pi * math.sqrt(mass / k)
    np.testing.assert_allclose(np.diff([0.0, *turns]), half, rtol=EXACT)
    peaks = [0.4, *run.at(turns)["x"]]
    np.testing.assert_allclose(-np.diff(np.abs(peaks)), 2 * f / k, rtol=EXACT * 0.4 * k / f)
    assert run.status is Status.AT_REST
    assert k * abs(run["x"][-1]) <= f


def test_a_linear_oscillator_without_friction_keeps_its_swing():
    axis = Axis(inertia=2.0, stiffness=50.0)
    run = simulate(axis, Viscous(viscous_coefficient=0.0), t_end=20.0, y0={"x": 0.3})
    t = np.linspace(0, 20, 101)
    np.testing.assert_allclose(run.at(t)["x"], 0.3 * np.cos(5.0 * t), atol=0.3 * EXACT)


def test_viscous_friction_lets_a_body_creep_for_ever_over_a_finite_distance():
    axis = Axis(inertia=2.0)
    run = simulate(axis, Viscous(viscous_coefficient=4.0), t_end=5.0, y0={"v": 1.0})
    np.testing.assert_allclose(run["v"][-1], math.exp(-10.0), rtol=1e-9)  # 1e-12 of the start
    np.testing.assert_allclose(run["x"][-1], 0.5 * (1 - math.exp(-10.0)), rtol=EXACT)
    assert run.status is Status.END_TIME


def test_coulomb_and_viscous_friction_stop_a_body_after_a_logarithm():
    law = CoulombViscous(kinetic_coefficient=0.5, viscous_coefficient=4.0)
    run = simulate(Axis(inertia=2.0), law, t_end=5.0, y0={"v": 1.0})
    stop = 2.0 / 4.0 * math.log(1 + 4.0 / 0.5)
    assert math.isclose(run.events[0].t, stop, rel_tol=EXACT)
    assert math.isclose(run["x"][-1], (2.0 * 1.0 - 0.5 * stop) / 4.0, rel_tol=EXACT)


def spans_of(run):
    starts = [event.t for event in run.events if event.reason == "break-away"]
    stops = [event.t for event in run.events if event.reason == "stop"]
    slips = np.subtract(stops, starts[: len(stops)])
    sticks = np.subtract(starts[1:], stops[: len(starts) - 1])
    return slips, sticks


def test_a_towed_block_sticks_and_slips_for_the_times_of_the_closed_form():
    m, k, speed, f_s, f_k = 1.0, 2.0, 0.1, 1.5, 1.0
    block = TowedBlock(mass=m, stiffness=k, speed=speed, load=1.0)
    law = Coulomb(kinetic_coefficient=f_k, static_coefficient=f_s)
    run = simulate(block, law, t_end=60.0)
    D, w = (f_s - f_k) / k, math.sqrt(k / m)
    slip = 2 / w * (math.pi - math.atan(w * D / speed))
    slips, sticks = spans_of(run)
    assert len(slips) >= 5
    np.testing.assert_allclose(slips, slip, rtol=EXACT)
    np.testing.assert_allclose(sticks, 2 * D / speed, rtol=EXACT)
    assert math.isclose(slip, 2.61126, abs_tol=5e-6)  # as printed
    v = run.at(run.events[0].t + np.linspace(0, slip, 20001))["v"]
    fastest = speed + math.hypot(speed, D * w)
    assert math.isclose(fastest, 0.46742, abs_tol=5e-6)  # as printed
    assert math.isclose(v.max(), fastest, rel_tol=1e-8)  # 20001 points on a smooth maximum


def test_a_towed_block_with_stribeck_friction_sticks_and_slips_for_the_known_times():
    law = Stribeck(
        kinetic_coefficient=1.0,
        static_coefficient=1.5,
        stribeck_velocity=1e-3,
        viscous_coefficient=0.4,
    )
    block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=1.0)
    slips, sticks = spans_of(simulate(block, law, t_end=40.0))
    np.testing.assert_allclose(slips[1:], 2.84029, atol=5e-6)  # the digits that are known
    np.testing.assert_allclose(sticks[1:], 3.67203, atol=5e-6)


def test_a_heavy_block_pushed_below_break_away_does_not_move_in_a_million_seconds():
    block = SpringBlock(mass=1.0, drive=Pulse(level=3.0, duration=2e6))
    run = simulate(block, LAW, t_end=1e6)
    assert run["x"][-1] == 0
    assert run["v"][-1] == 0
    assert run.status is Status.AT_REST
    np.testing.assert_allclose(run["friction"], 3.0, rtol=1e-15)  # a rounding


def test_a_push_of_exactly_the_break_away_level_does_not_move_a_block():
    block = Axis(inertia=1.0, drive=Pulse(level=1.5, duration=10.0))
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    assert np.all(simulate(block, law, t_end=10.0)["x"] == 0)


def test_a_push_just_above_the_break_away_level_moves_it():
    level = math.nextafter(1.5, 2.0)
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
    run = simulate(Axis(inertia=1.0, drive=Pulse(level=level, duration=2.0)), law, t_end=2.0)
    assert math.isclose(run["x"][-1], 0.5 * 0.5 * 2.0**2, rel_tol=EXACT)


def test_a_body_leaves_rest_where_friction_falls_with_infinite_slope():
    law = Stribeck(
        kinetic_coefficient=0.1,
        static_coefficient=0.2,
        stribeck_velocity=0.1,
        viscous_coefficient=1.0,
        fading_exponent=0.7,
    )
    block = TowedBlock(mass=0.1, stiffness=100.0, speed=0.001307)
    run = simulate(block, law, t_end=3.0)
    # the spring must first be stretched by mu_s m g / k
    assert run.events[0].t == pytest.approx(0.2 * 0.1 * 9.81 / 100.0 / 0.001307, rel=1e-9)
    assert run.events[0].reason == "break-away"
    assert run["v"].max() > 0.001307
