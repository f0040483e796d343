"""What random cases brought to light, each reduced to a few lines.

A mark of expected failure goes when its fault does.
"""

import math

import pytest
from tests.properties.fuzzing.campaign import time_limit
from tests.properties.fuzzing.rigs import Chain, PendulumCart, ShakenBlock

from stickslip import (
    Axis,
    Coulomb,
    Dahl,
    EventDriven,
    LuGre,
    PiecewiseLinear,
    Pulse,
    Ramp,
    SpringBlock,
    Status,
    Viscous,
    simulate,
)

FREE = Coulomb(kinetic_coefficient=0.0)
COULOMB = Coulomb(kinetic_coefficient=1.0)


def test_a_force_that_jumps_above_break_away_and_falls_below_it_in_one_step_moves_the_body():
    drive = Pulse(level=1.5, duration=5.0, start=1.0) + Ramp(rate=-1.0, start=1.0)
    run = simulate(Axis(inertia=1.0, drive=drive), COULOMB, t_end=3.0)
    # from 1 s: v = t (0.5 - t / 2), which ends 1 s later after 1 / 12 m
    assert [event.reason for event in run.events] == ["break-away", "stop"]
    assert math.isclose(run["x"][-1], 1.0 / 12.0, rel_tol=1e-9)


def test_a_lift_that_jumps_above_the_weight_and_falls_below_it_in_one_step_lifts_the_body():
    lift = Pulse(level=20.0, duration=1.0, start=1.0) + Ramp(rate=-20.0, start=1.0)
    run = simulate(ShakenBlock(mass=1.0, lift=lift), COULOMB, t_end=3.0, throw=False)
    assert run.status is Status.LIFT_OFF
    assert run.span[1] == 1.0


def test_a_body_that_will_be_lifted_off_does_not_rest_for_good():
    lift = Pulse(level=20.0, duration=1.0, start=1.0)
    law = Viscous(viscous_coefficient=1.0)
    run = simulate(ShakenBlock(mass=1.0, lift=lift), law, t_end=3.0, throw=False)
    assert run.status is Status.LIFT_OFF


@pytest.mark.parametrize("later", [1, 3])
def test_a_jump_given_as_two_points_a_rounding_apart_is_passed(later):
    after = 1.1 + later * math.ulp(1.1)
    drive = PiecewiseLinear(times=(1.1, after), values=(0.0, 1.4))
    with time_limit(2.0):
        run = simulate(Axis(inertia=1.0, drive=drive), COULOMB, t_end=2.1)
    assert math.isclose(run["x"][-1], 0.2, rel_tol=1e-9)  # 0.4 N for a second


def test_a_free_axis_that_is_moved_from_rest_to_rest_is_certified():
    there_and_back = Pulse(level=1.0, duration=1.0) + Pulse(level=-1.0, duration=1.0, start=1.0)
    run = simulate(Axis(inertia=1.0, drive=there_and_back), FREE, t_end=2.0, throw=False)
    assert math.isclose(run["x"][-1], 1.0, rel_tol=1e-12)
    assert run.certificate.certified


def test_a_block_that_its_bristles_swing_without_loss_is_certified():
    law = LuGre(
        kinetic_coefficient=1.0, static_coefficient=1.0, stribeck_velocity=1.0,
        bristle_stiffness=300.0, bristle_damping=0.0,
    )  # fmt: skip
    run = simulate(SpringBlock(mass=1.0), law, t_end=1.0, y0={"z": 1.0}, throw=False)
    assert math.isclose(run["x"][-1], -0.99982947552, rel_tol=1e-8)  # by a tolerance of 1e-12
    assert run.certificate.certified


def test_a_held_axis_without_load_follows_a_ramp_backward():
    law = Dahl(kinetic_coefficient=1.0, bristle_stiffness=1.0, static_switch=True)
    axis = Axis(inertia=1.0, load=0.0, drive=Ramp(rate=-1.0))
    run = simulate(axis, law, t_end=1.0, throw=False)
    assert run.status is Status.END_TIME
    assert math.isclose(run["x"][-1], -1.0 / 6.0, rel_tol=1e-7)


def test_a_mass_may_turn_round_long_before_the_first_step_ends():
    push = Pulse(level=0.7, duration=9.0)
    chain = Chain(mass=1.0, free=1.0, stiffness=1.0, damping=1.0, drive=push)
    law = Viscous(viscous_coefficient=0.0)
    run = simulate(chain, law, t_end=1.0, y0={"w": -1e-12}, throw=False)
    assert run.status is Status.END_TIME


def test_a_pendulum_may_start_from_rest_under_a_torque_that_grows_late():
    cart = PendulumCart(
        mass=1.0, ball=1.0, length=1.0, gravity=1.0, torque=Ramp(rate=1e4, start=10.0)
    )
    run = simulate(cart, COULOMB, t_end=11.0, throw=False)
    assert run.status is Status.LIFT_OFF


@pytest.mark.parametrize("start", [0.0, 1.0])
def test_a_chain_on_bristles_may_start_from_rest_under_a_force_that_grows(start):
    law = LuGre(
        kinetic_coefficient=0.25, static_coefficient=0.4, stribeck_velocity=0.01,
        bristle_stiffness=1e3, bristle_damping=1.0,
    )  # fmt: skip
    chain = Chain(mass=1.0, free=1.0, stiffness=1.0, drive=Ramp(rate=1.0, start=start))
    solver = EventDriven(max_steps=2000)
    run = simulate(chain, law, t_end=start + 2.0, solver=solver, throw=False)
    assert run.status is Status.END_TIME


def test_a_body_on_bristles_changes_its_mode_with_an_event():
    law = Dahl(kinetic_coefficient=1.0, bristle_stiffness=100.0)
    axis = Axis(inertia=1.0, drive=Ramp(rate=-1.0, start=1.0))
    run = simulate(axis, law, t_end=1.1)
    before, after = run.at([0.5, 1.05])["mode"]
    assert after == -1
    assert before == after or run.events


@pytest.mark.xfail(reason="where rigid bodies with friction jam, the normal force changes sign")
def test_a_cart_that_jams_does_not_lift_off():
    cart = PendulumCart(
        mass=0.002, ball=1.0, length=0.006, torque=Pulse(level=-0.001, duration=1.0)
    )
    law = Coulomb(kinetic_coefficient=0.45, static_coefficient=0.8)
    run = simulate(cart, law, t_end=1.0, throw=False)
    assert run.status is not Status.LIFT_OFF or run["normal_force"][-1] < 1e-6


def test_a_block_that_starts_where_its_spring_ends_slides_to_rest():
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    run = simulate(rig, Coulomb(kinetic_coefficient=0.25), t_end=10.0, y0={"x": 0.1, "v": 1e-3})
    way = 1e-3**2 / (2.0 * 0.25 * 9.81)
    assert math.isclose(run["x"][-1] - 0.1, way, rel_tol=1e-8)  # 1e-7 m beside 0.1 m
    assert run.status is Status.AT_REST
