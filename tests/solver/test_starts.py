"""Where runs with hard stops may begin, and which solver knows stops."""

import pytest

from stickslip import Axis, Coulomb, FixedStep, SpringBlock, simulate
from stickslip.errors import InputError, ParameterError

LAW = Coulomb(kinetic_coefficient=0.2)


@pytest.mark.parametrize(
    ("rig", "match"),
    [
        (Axis(inertia=1.0, upper_stop=-0.1), r"x = 0 m, beyond the upper stop of Axis at −0\.1 m"),
        (SpringBlock(mass=1.0, lower_stop=0.2), "beyond the lower stop of SpringBlock at 0.2 m"),
    ],
)
def test_a_start_beyond_a_stop_is_refused(rig, match):
    with pytest.raises(InputError, match=match):
        simulate(rig, LAW, t_end=1.0)


def test_a_start_beyond_a_stop_by_rounding_is_at_the_stop():
    rig = Axis(inertia=1.0, upper_stop=0.1)
    run = simulate(rig, LAW, t_end=1.0, y0={"x": 0.1 + 1e-16})
    assert run["x"][0] == 0.1
    assert run["mode"][0] == 2


def test_stops_that_leave_no_room_are_refused():
    with pytest.raises(ParameterError, match="the upper stop of x must lie above the lower"):
        Axis(inertia=1.0, lower_stop=0.1, upper_stop=0.1)


def test_a_restitution_above_one_is_refused():
    with pytest.raises(ParameterError, match=r"restitution \(e\) must be at least 0 and at most 1"):
        SpringBlock(mass=1.0, upper_stop=1.0, restitution=1.1)


def test_fixed_steps_know_no_stops():
    with pytest.raises(InputError, match="does not support hard stops, and this Axis has some"):
        simulate(Axis(inertia=1.0, upper_stop=1.0), LAW, t_end=1.0, solver=FixedStep(dt=0.01))
