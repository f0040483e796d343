import pytest

from stickslip import Axis, Stribeck, simulate
from stickslip.errors import ParameterError
from stickslip.mechanisms.drives import Ramp

VALUES = {"kinetic_coefficient": 1.0, "static_coefficient": 2.0, "stribeck_velocity": 0.1}


def test_rest_gives_way_to_its_own_level_and_sliding_begins_below_it():
    law = Stribeck(**VALUES, break_away_coefficient=2.5)
    assert law.break_away(10.0) == 25.0
    assert law.sliding(0.0, 10.0) == 20.0
    run = simulate(Axis(inertia=1.0, drive=Ramp(rate=1.0)), law, t_end=3.0)
    assert run.events[0].t == pytest.approx(2.5, rel=1e-14)
    assert run.at(run.events[0].t)["friction"][0] == 2.0


def test_without_a_level_of_its_own_rest_holds_what_sliding_begins_with():
    assert Stribeck(**VALUES).break_away(10.0) == Stribeck(**VALUES).sliding(0.0, 10.0)


def test_a_break_away_level_below_that_of_sliding_is_refused():
    with pytest.raises(ParameterError, match=r"at least static_coefficient = 2, got 1\.5"):
        Stribeck(**VALUES, break_away_coefficient=1.5)
