"""Parameters of a law that a fit holds at given values."""

import numpy as np
import pytest

from stickslip import Axis, Coulomb, CoulombViscous, Measurement, SpringBlock, Viscous, fit
from stickslip.errors import InputError, UnknownNameError

BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
READING = Measurement(travel=0.2, uncertainty=0.005)
VELOCITY = np.linspace(-1.0, 1.0, 200)
TABLE = Measurement(velocity=VELOCITY, friction=2.0 * np.sign(VELOCITY) + 3.0 * VELOCITY)


def test_measured_friction_is_fitted_beside_a_known_slope():
    known = {"viscous_coefficient": 3.0}
    result = fit(
        Axis(inertia=1.0), CoulombViscous, TABLE, vary=["kinetic_coefficient"], fixed=known
    )
    assert result.law.viscous_coefficient == 3.0
    assert result.law.kinetic_coefficient == pytest.approx(2.0, rel=1e-4)  # the data are exact
    with pytest.raises(UnknownNameError):
        result.estimate("viscous_coefficient")


def test_a_wrong_known_slope_is_what_the_level_makes_up_for():
    known = {"viscous_coefficient": 0.0}
    result = fit(
        Axis(inertia=1.0), CoulombViscous, TABLE, vary=["kinetic_coefficient"], fixed=known
    )
    # where no law is near, the closest is what leaves least: the mean of 2 + 3 |v|
    level = 2.0 + 3.0 * np.mean(np.abs(VELOCITY))
    assert result.law.kinetic_coefficient == pytest.approx(level, rel=1e-4)
    assert result.verdict.closest.distance > 0.1  # it is said to stay that far off


def test_a_travel_is_fitted_beside_a_known_slope():
    result = fit(BLOCK, CoulombViscous, READING, fixed={"viscous_coefficient": 0.0})
    # without a viscous part the spring's energy is mu m g s
    expected = 0.5 * 100.0 * 0.1**2 / (9.81 * 0.2)
    assert result.law.kinetic_coefficient == pytest.approx(expected, rel=1e-6)


def test_a_name_that_the_law_does_not_have_is_refused():
    with pytest.raises(UnknownNameError, match="in fixed 'viscos_coefficient'"):
        fit(BLOCK, Viscous, READING, fixed={"viscos_coefficient": 1.0})


def test_all_of_a_law_fixed_leaves_nothing_to_fit():
    with pytest.raises(InputError, match="there is nothing to fit"):
        fit(BLOCK, Viscous, READING, fixed={"viscous_coefficient": 1.0})


def test_an_offset_held_where_it_is_not_names_the_levels_that_take_its_place():
    time = np.linspace(0.0, 4.0, 401)
    velocity = np.cos(4.4 * time)
    noise = np.random.default_rng(0).normal(0.0, 0.05, time.size)
    force = 2.0 * np.sign(velocity) + 0.5 + np.gradient(velocity, time) + noise
    record = Measurement(time=time, position=np.sin(4.4 * time) / 4.4, force=force)
    with pytest.raises(InputError, match=r"Let the offset be found .* or fit 'both_ways\[levels\]"):
        fit(Axis(inertia=1.0), Coulomb, record, fixed={"offset": 0.1})
