"""Where runs with hard stops may begin, and which solver knows stops."""

import numpy as np
import pytest

from stickslip import Axis, Coulomb, FixedStep, SpringBlock, Stribeck, TwoMassAxis, simulate
from stickslip.drives import Pulse
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


@pytest.mark.parametrize("place", [-1.61803, 0.9032740018574321])
def test_what_begins_at_rest_far_from_zero_moves_as_at_zero(place):
    """The load has no force at first, but for the rounding of what its spring is made of."""
    axis = TwoMassAxis(
        motor_inertia=2.7, load_inertia=9.9, stiffness=10.6, rubs="motor",
        drive=Pulse(level=1.4, duration=1.0),
    )  # fmt: skip
    law = Stribeck(kinetic_coefficient=0.3, static_coefficient=0.3, stribeck_velocity=0.1)
    start = {"x": place, "other": place}
    far = simulate(axis, law, t_end=2.0, y0=start)
    near = simulate(axis, law, t_end=2.0)
    assert far.certificate.steps < 2 * near.certificate.steps
    for name, shift in (("x", place), ("other", place), ("v", 0.0), ("other_dot", 0.0)):
        # places of 1 m are rounded to 2e-16, and a falling law lets errors of steps grow
        np.testing.assert_allclose(
            far.at([0.5, 2.0])[name] - shift, near.at([0.5, 2.0])[name], rtol=0, atol=1e-10
        )
