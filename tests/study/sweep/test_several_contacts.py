"""Maps of mechanisms with several contacts: of axes without coupling, those of one axis."""

import numpy as np
import pytest
from tests.pair_cases import LAW, LAWS, PUSH, Pair, axis

from stickslip import EventDriven, TwoFeet
from stickslip.errors import InputError, UnknownNameError
from stickslip.mechanisms.drives import Sine
from stickslip.show import plots
from stickslip.study.sweep import average_velocity, basins

PLAIN = EventDriven(tier="python")
PAIR = Pair(left_drive=PUSH, right_drive=PUSH)
SHORT = {"settle": 2, "cycles": 2, "solver": PLAIN}


@pytest.mark.slow
def test_the_map_of_one_of_two_axes_is_that_of_the_axis_alone():
    levels = [0.6]
    both = average_velocity(
        PAIR, LAWS, {"friction.left.kinetic_coefficient": levels}, coordinate="a", **SHORT
    )
    alone = average_velocity(axis(PUSH), LAW, {"kinetic_coefficient": levels}, **SHORT)
    assert np.abs(alone.velocity).min() > 0.01
    # places of some centimetres, over cycles of a second
    np.testing.assert_allclose(both.velocity, alone.velocity, rtol=0, atol=1e-12)
    assert (both.unit, both.coordinate, alone.coordinate) == ("m/s", "a", "")
    assert plots.plot(both).get_ylabel().startswith("mean velocity of a, ")


def test_basins_of_one_of_two_axes_are_those_of_the_axis_alone():
    drive, starts = Sine(amplitude=4.0, frequency=1.0), np.array([-1.0, 0.5])
    pair = Pair(stiffness=100.0, left_drive=drive)
    settings = {"settle": 1, "keep": 2, "solver": PLAIN, "period": 1.0}
    both = basins(pair, LAWS, {"a": starts, "a_dot": [0.0]}, coordinate="a", **settings)
    alone = basins(axis(drive, 100.0), LAW, {"x": starts, "v": [0.0]}, **settings)
    np.testing.assert_array_equal(both.index, alone.index)
    for attractor, other in zip(both.attractors, alone.attractors, strict=True):
        assert attractor.period == other.period
        assert attractor.velocity == pytest.approx(other.velocity, abs=1e-12)


def test_contacts_along_one_coordinate_need_no_name_of_it():
    feet = TwoFeet(
        mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0,
        drive=Sine(amplitude=30.0, frequency=2.0),
    )  # fmt: skip
    found = average_velocity(feet, LAW, {"amplitude": [10.0]}, **SHORT)
    assert found.coordinate == ""
    assert np.isfinite(found.velocity).all()


def test_where_contacts_slip_along_several_coordinates_one_has_to_be_named():
    with pytest.raises(InputError, match=r"several coordinates \(a, b\): name one, such as coord"):
        average_velocity(PAIR, LAWS, {"frequency": [1.0]}, **SHORT)
    with pytest.raises(UnknownNameError, match="unknown coordinate 'left'"):
        basins(PAIR, LAWS, {"a": [0.0], "b": [0.0]}, coordinate="left")
