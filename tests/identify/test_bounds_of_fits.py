"""Bounds of quantities stand, and are named."""

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, Measurement, fit, simulate
from stickslip.mechanisms.drives import Sampled

TRUTH = CoulombViscous(kinetic_coefficient=10.0, viscous_coefficient=30.0)
NOISE = 1e-4


@pytest.fixture(scope="module")
def motion():
    """Eight seconds of an axis of 5 kg: times, noisy positions, forces."""
    t = np.arange(2000) / 250
    force = 40 * np.sin(2 * np.pi * t) + 15 * np.sin(2.3 * t)
    axis = Axis(inertia=5.0, drive=Sampled(times=t, values=force))
    x = simulate(axis, TRUTH, t_end=8.0).at(t)["x"]
    return t, x + np.random.default_rng(1).normal(0, NOISE, 2000), force


def cut(motion, first, count):
    """Return a short record of forward slip alone."""
    t, x, force = (column[first : first + count] for column in motion)
    return Measurement(time=t, position=x, force=force)


@pytest.mark.parametrize(("first", "count"), [(1060, 60), (100, 60), (840, 60)])
def test_a_short_record_of_one_direction_has_the_truth_in_its_intervals(motion, first, count):
    # regression of so few noisy accelerations finds a level below 0, and a mass that is half or
    # a third
    found = fit(
        Axis(inertia=4.0),
        CoulombViscous,
        cut(motion, first, count),
        vary=["friction.*", "mechanism.inertia"],
    )
    for name, truth in (("kinetic_coefficient", 10.0), ("inertia", 5.0)):
        estimate = found.estimate(name)
        # twice a 95 % interval, four standard errors
        assert abs(estimate.value - truth) < estimate.high - estimate.low


def test_a_bound_that_is_a_limit_of_the_quantity_stays_and_is_named():
    v = np.linspace(-1.0, 1.0, 81)
    # friction that falls with speed, which no viscous coefficient of 0 or more can do
    table = Measurement(velocity=v, friction=3.0 * np.sign(v) - 0.5 * v + 0.01 * np.cos(40.0 * v))
    found = fit(Axis(inertia=1.0), CoulombViscous, table)
    slope = found.estimate("viscous_coefficient")
    assert slope.value == 0.0
    assert slope.reason == "it reached its lower bound, 0 N s/m"


def test_bounds_of_what_turns_are_named_as_torques():
    v = np.linspace(-1.0, 1.0, 81)
    table = Measurement(
        velocity=v, friction=3.0 * np.sign(v) - 0.5 * v + 0.01 * np.cos(40.0 * v), turning=True
    )
    slope = fit(Axis(inertia=1.0), CoulombViscous, table).estimate("viscous_coefficient")
    assert slope.reason == "it reached its lower bound, 0 N m s/rad"
