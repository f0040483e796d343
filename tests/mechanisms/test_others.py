"""Pendulum, two-mass axis and modulated load against closed forms."""

import math

import numpy as np
import pytest
from scipy.special import ellipk

from stickslip import Coulomb, Pendulum, TowedBlock, TwoMassAxis, simulate
from stickslip.engine import Status
from stickslip.errors import ParameterError
from stickslip.mechanisms.drives import PiecewiseLinear, Sine

FREE = Coulomb(kinetic_coefficient=0.0)


def test_a_pendulum_without_friction_swings_with_the_period_of_the_elliptic_integral():
    clock = Pendulum(mass=0.3, length=0.4, inertia=0.01)
    amplitude = 2.0
    rate = math.sqrt(0.3 * 9.81 * 0.4 / (0.3 * 0.4**2 + 0.01))
    period = 4.0 / rate * ellipk(math.sin(0.5 * amplitude) ** 2)
    run = simulate(clock, FREE, t_end=2.0 * period, y0={"theta": amplitude})
    # local errors of 1e-12 in some fifty steps
    assert run["theta"][-1] == pytest.approx(amplitude, abs=1e-9)
    assert run.certificate.energy_error < 1e-11


@pytest.mark.parametrize("amplitude", [1e-3, 1e-4, 1e-6, 1e-9])
def test_the_energy_of_small_swings_is_not_lost_in_the_rounding_of_the_cosine(amplitude):
    clock = Pendulum(mass=0.2, length=0.5)
    law = Coulomb(kinetic_coefficient=1e-3 * amplitude)
    run = simulate(clock, law, t_end=5.0, y0={"theta": amplitude})
    assert run.certificate.energy_error < 1e-11  # as for larger swings, whatever the size
    rate = math.sqrt(9.81 / 0.5)
    assert run.certificate.energy_start == pytest.approx(
        0.5 * 0.2 * 0.25 * (rate * amplitude) ** 2, rel=amplitude**2 + 1e-15
    )


def test_a_rubbing_pivot_takes_its_torque_times_the_angle_swept():
    clock = Pendulum(mass=0.3, length=0.4)
    run = simulate(clock, Coulomb(kinetic_coefficient=0.05), t_end=30.0, y0={"theta": 1.0})
    assert run.status is Status.AT_REST
    swept = np.abs(np.diff(run.at([event.t for event in run.events])["theta"])).sum()
    first = 1.0 - float(run.at([run.events[0].t])["theta"][0])
    taken = 0.05 * (swept + first)
    assert run.certificate.work_friction == pytest.approx(taken, rel=1e-10)
    assert abs(0.3 * 9.81 * 0.4 * math.sin(run["theta"][-1])) <= 0.05


@pytest.mark.parametrize("rubs", ["load", "motor"])
def test_two_masses_swing_against_each_other_about_their_centre(rubs):
    axis = TwoMassAxis(motor_inertia=0.5, load_inertia=1.5, stiffness=600.0, rubs=rubs)
    rate = math.sqrt(600.0 * (1.0 / 0.5 + 1.0 / 1.5))
    run = simulate(axis, FREE, t_end=1.0, y0={"x": 0.01})
    own, other = (1.5, 0.5) if rubs == "load" else (0.5, 1.5)
    t = np.linspace(0.0, 1.0, 60)
    found = run.at(t)
    centre = own * 0.01 / (own + other)
    share = other / (own + other)
    # a linear mode is exact but for rounding, which its phase of 40 rad multiplies
    np.testing.assert_allclose(
        found["x"], centre + share * 0.01 * np.cos(rate * t), rtol=0, atol=1e-14
    )
    np.testing.assert_allclose(own * found["x"] + other * found["other"], own * 0.01, atol=1e-15)


def test_a_stiff_coupling_makes_the_two_masses_one():
    push = PiecewiseLinear(times=(0.0, 1.0, 1.1), values=(6.0, 6.0, 0.0))
    soft = TwoMassAxis(motor_inertia=0.5, load_inertia=1.5, stiffness=1e7, damping=2e3, drive=push)
    run = simulate(soft, Coulomb(kinetic_coefficient=1.0), t_end=1.0)
    # 5 N accelerate 2 kg, after 1 N / (6 N / 0.5 kg x 2e3 N s/m) = 42 us in which the load stays
    assert 0.0 < run["v"][-1] - 2.5 < 0.5 * 42e-6
    assert 0.0 < run["x"][-1] - 1.25 < 0.5 * 42e-6


def test_only_the_two_sides_can_rub():
    with pytest.raises(ParameterError, match="'load', 'motor' or 'both', got 'none'"):
        TwoMassAxis(motor_inertia=1.0, load_inertia=1.0, stiffness=1.0, rubs="none")


def test_a_modulated_load_brakes_by_its_integral():
    block = TowedBlock(
        mass=2.0, stiffness=1e-9, speed=0.0, load=10.0,
        modulation=Sine(amplitude=4.0, frequency=3.0),
    )  # fmt: skip
    run = simulate(block, Coulomb(kinetic_coefficient=0.3), t_end=1.0, y0={"v": 3.0})
    t = np.linspace(0.0, 1.0, 40)
    turn = 6.0 * math.pi
    pressed = 10.0 * t + 4.0 / turn * (1.0 - np.cos(turn * t))
    # the spring, there because a block must have one, pulls with 1e-9 N/m
    np.testing.assert_allclose(run.at(t)["v"], 3.0 - 0.3 / 2.0 * pressed, atol=2e-9)
    np.testing.assert_allclose(run.at(t)["normal_force"], 10.0 + 4.0 * np.sin(turn * t), rtol=1e-12)


def test_a_modulation_that_lifts_the_block_ends_the_run():
    block = TowedBlock(
        mass=2.0, stiffness=50.0, speed=0.1, load=10.0,
        modulation=PiecewiseLinear(times=(0.0, 2.0), values=(0.0, -20.0)),
    )  # fmt: skip
    run = simulate(block, Coulomb(kinetic_coefficient=0.3), t_end=2.0, throw=False)
    assert run.status is Status.LIFT_OFF
    assert run.span[1] == pytest.approx(1.0, rel=1e-12)
