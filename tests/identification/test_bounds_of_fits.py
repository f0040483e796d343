"""Bounds of quantities stand, and are named."""

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, Measurement, fit, simulate
from stickslip.identify.fits.levenberg_marquardt import ResidualJacobian
from stickslip.identify.fits.parameters import FreeParameter, FreeParameters
from stickslip.identify.fits.shooting.estimates import estimates_of, infer
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import Quantity

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


@pytest.mark.parametrize(("first", "count"), [(1060, 59), (100, 59), (840, 60)])
def test_a_short_record_of_one_direction_is_explained_to_its_noise(motion, first, count):
    # regression of so few noisy accelerations finds a level below 0, and a mass that is half or
    # a third: a search that stays near them ends with the level at its upper bound
    found = fit(
        Axis(inertia=4.0),
        CoulombViscous,
        cut(motion, first, count),
        vary=["friction.*", "mechanism.inertia"],
        route="shooting",
    )
    assert found.at_bounds == {}
    # 59 residuals have their deviation to 9 %: three times that
    assert found.rms < 1.3 * NOISE
    for name, truth in (("kinetic_coefficient", 10.0), ("inertia", 5.0)):
        estimate = found.estimate(name)
        # twice a 95 % interval, four standard errors: eight blocks of seven samples are few
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


def test_an_interval_of_many_times_the_value_is_none_and_its_size_is_the_reason():
    offset = Quantity("o", "N")
    item = FreeParameter(
        path="mechanism.offset", quantity=offset, start=0.1, low=-100.0, high=100.0
    )
    seen = ResidualJacobian(
        values=np.array([0.1]),
        residual=np.random.default_rng(1).normal(0.0, 1.0, 200),
        slopes=np.full((200, 1), 2e-3),
        segment=np.zeros(200, dtype=int),
    )
    known = infer(seen, np.eye(1))
    assert known.half_widths[0] > 100.0 * 0.1  # a mean of 200 rows over 2e-3: 35 N and more
    (estimate,) = estimates_of(FreeParameters((item,)), seen, known, {})
    assert not estimate.bounded
    assert estimate.reason.startswith("the record does not determine its magnitude, ± ")
    assert estimate.reason.endswith(" N")
