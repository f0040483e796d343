"""What a fit looks for: the way between values and what the optimiser sees."""

import math

import numpy as np

from stickslip.identify.fits.parameters import FreeParameter, FreeParameters
from stickslip.quantities import Quantity

LEVEL = FreeParameter(
    path="friction.kinetic_coefficient", quantity=Quantity("mu_k"), start=2.0, low=0.0, high=9.0
)
SPEED = FreeParameter(
    path="friction.stribeck_velocity",
    quantity=Quantity("v_s", "m/s", above=0),
    start=0.01,
    low=1e-3,
    high=1.0,
    log=True,
)
ALL = FreeParameters((LEVEL, SPEED))


def test_a_size_is_seen_as_its_logarithm():
    np.testing.assert_allclose(ALL.coordinates(ALL.start), [2.0, math.log(0.01)])


def test_values_come_back_from_coordinates():
    values = np.array([3.0, 0.2])
    # one logarithm and one exponential: rounding only
    np.testing.assert_allclose(ALL.values(ALL.coordinates(values)), values, rtol=1e-14)


def test_slopes_are_those_of_the_values():
    at = ALL.coordinates(ALL.start)
    for i in range(2):
        step = np.zeros(2)
        step[i] = 1e-6
        central = (ALL.values(at + step) - ALL.values(at - step)) / 2e-6
        # central differences of an exponential are off by the square of the step
        np.testing.assert_allclose(np.diag(ALL.slopes(at))[:, i], central, rtol=1e-8, atol=1e-9)


def test_coordinates_stay_inside_the_bounds():
    seen = ALL.coordinates(np.array([-1.0, 50.0]))
    np.testing.assert_allclose(seen, [0.0, 0.0])
    low, high = ALL.limits()
    np.testing.assert_allclose(low, [0.0, math.log(1e-3)])
    np.testing.assert_allclose(high, [9.0, 0.0])


def test_other_starts_change_nothing_else():
    moved = ALL.starting_at([1.0, 0.1])
    np.testing.assert_allclose(moved.start, [1.0, 0.1])
    assert moved.paths == ALL.paths
    np.testing.assert_array_equal(moved.limits(), ALL.limits())


def test_nothing_to_look_for_has_no_coordinates():
    none = FreeParameters(())
    assert len(none) == 0
    assert none.coordinates(np.empty(0)).shape == (0,)
    assert none.limits()[0].shape == (0,)
