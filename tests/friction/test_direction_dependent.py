"""Friction that differs by direction: what is known of each direction holds in it."""

import math

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    EventDriven,
    FixedStep,
    simulate,
)
from stickslip.engine import Status
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Ramp

AHEAD, BACK = 1.0, 2.0
LEVELS = {1: AHEAD, -1: BACK}
LAW = DirectionDependent(forward_kinetic_coefficient=AHEAD, backward_kinetic_coefficient=BACK)
EXACT = 1e-13
"""Roundings of a few exact series."""

each_direction = pytest.mark.parametrize("direction", [1, -1])


def constant(force):
    return PiecewiseLinear(times=(0.0, 100.0), values=(force, force))


@each_direction
def test_opposite_pushes_end_at_the_distances_that_their_own_levels_allow(direction):
    push, duration, mass = 5.0, 0.4, 1.5
    rig = Axis(inertia=mass, drive=Pulse(level=direction * push, duration=duration))
    run = simulate(rig, LAW, t_end=20.0)
    level = LEVELS[direction]
    travel = push * (push - level) * duration**2 / (2.0 * level * mass)
    assert math.isclose(run["x"][-1], direction * travel, rel_tol=EXACT)
    assert run.status is Status.AT_REST


@each_direction
def test_a_slide_with_a_viscous_part_stops_when_the_logarithm_of_its_direction_says(direction):
    mass, v0, sigma = 2.0, 1.5, {1: 0.3, -1: 0.9}
    law = DirectionDependent(
        forward_kinetic_coefficient=AHEAD,
        backward_kinetic_coefficient=BACK,
        forward_viscous_coefficient=sigma[1],
        backward_viscous_coefficient=sigma[-1],
    )
    run = simulate(Axis(inertia=mass), law, t_end=10.0, y0={"v": direction * v0})
    rate, level = sigma[direction], LEVELS[direction]
    stop = mass / rate * math.log(1.0 + rate * v0 / level)
    assert math.isclose(run.events[0].t, stop, rel_tol=EXACT)
    travel = (mass * v0 - level * stop) / rate
    assert math.isclose(run["x"][-1], direction * travel, rel_tol=1e-12)  # of a difference


@each_direction
def test_a_growing_force_overcomes_the_level_of_its_direction(direction):
    run = simulate(Axis(inertia=1.0, drive=Ramp(rate=0.5 * direction)), LAW, t_end=5.0)
    first = run.events[0]
    assert (first.reason, first.to_mode) == ("break-away", direction)
    assert math.isclose(first.t, LEVELS[direction] / 0.5, rel_tol=EXACT)


@pytest.mark.parametrize("solver", [EventDriven(), FixedStep(dt=1e-3)], ids=["exact", "fixed"])
def test_a_force_between_the_levels_moves_the_body_one_way_and_not_the_other(solver):
    force, mass = 1.5, 2.0
    held = simulate(Axis(inertia=mass, drive=constant(-force)), LAW, t_end=1.0, solver=solver)
    assert np.all(held["x"] == 0)
    assert np.all(held["friction"] == -force)
    moved = simulate(Axis(inertia=mass, drive=constant(force)), LAW, t_end=1.0, solver=solver)
    # half a step's way at the end's speed is what Heun or Euler may be off
    allowed = 1e-12 if isinstance(solver, EventDriven) else 1e-3
    expected = (force - AHEAD) / (2.0 * mass)
    assert math.isclose(moved["x"][-1], expected, abs_tol=allowed)


def test_rest_is_final_only_where_neither_level_is_reached_later():
    for ends, status in (((-1.9, 0.9), Status.AT_REST), ((-1.9, 1.1), Status.END_TIME)):
        drive = PiecewiseLinear(times=(0.0, 1.0, 2.0), values=(0.0, *ends))
        assert simulate(Axis(inertia=1.0, drive=drive), LAW, t_end=3.0).status is status


def test_each_half_swing_loses_two_friction_lengths_of_its_direction():
    k, start = 100.0, 0.213
    run = simulate(Axis(inertia=1.0, stiffness=k), LAW, t_end=10.0, y0={"x": start})
    turns = [run.at(event.t)["x"][0] for event in run.events]
    expected, place, side = [], start, -1
    while -side * k * place > LEVELS[side]:  # turns about where friction and spring balance
        place = -2.0 * side * LEVELS[side] / k - place
        side = -side
        expected.append(place)
    np.testing.assert_allclose(turns, expected, rtol=0, atol=1e-13)


def test_with_both_directions_alike_a_run_is_that_of_the_plain_law_to_the_last_bit():
    rig = Axis(inertia=1.0, stiffness=50.0, drive=Pulse(level=8.0, duration=0.5))
    plain = CoulombViscous(kinetic_coefficient=AHEAD, viscous_coefficient=0.3)
    both = DirectionDependent(
        forward_kinetic_coefficient=AHEAD,
        backward_kinetic_coefficient=AHEAD,
        forward_viscous_coefficient=0.3,
        backward_viscous_coefficient=0.3,
    )
    run, other = (simulate(rig, law, t_end=4.0) for law in (plain, both))
    np.testing.assert_array_equal(other.t, run.t)
    np.testing.assert_array_equal(other["x"], run["x"])
    assert other.events == run.events


def test_a_constant_force_and_half_the_difference_of_the_levels_are_the_same():
    mean, half = 0.5 * (AHEAD + BACK), 0.5 * (BACK - AHEAD)
    drive = Pulse(level=6.0, duration=0.4) + Pulse(level=-7.0, duration=0.4, start=1.0)
    ours = simulate(Axis(inertia=1.0, drive=drive), LAW, t_end=8.0)
    # what holds the body forwards less pulls it there: an offset counts against it
    level = Coulomb(kinetic_coefficient=mean)
    theirs = simulate(Axis(inertia=1.0, drive=drive, offset=-half), level, t_end=8.0)
    assert [e.reason for e in ours.events] == [e.reason for e in theirs.events]
    t = np.linspace(0.0, 8.0, 33)
    np.testing.assert_allclose(ours.at(t)["x"], theirs.at(t)["x"], rtol=0, atol=1e-12)


def test_at_a_stop_the_level_of_the_way_back_is_what_a_pull_must_overcome():
    drive = PiecewiseLinear(times=(0.0, 1.0, 4.0), values=(3.0, 3.0, -3.0))
    rig = Axis(inertia=1.0, drive=drive, upper_stop=0.1)
    run = simulate(rig, LAW, t_end=4.0)
    pressed = run.at(1.0)
    assert pressed["mode"][0] == 2
    assert pressed["friction"][0] == AHEAD
    assert run.at(2.9)["mode"][0] == 2  # pulled with 0.8 N
    assert run.events[-1].to_mode == -1
    assert math.isclose(run.events[-1].t, 1.0 + (3.0 + BACK) / 2.0, rel_tol=EXACT)
