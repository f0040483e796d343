"""Presliding loops have the closed forms of their laws."""

import numpy as np
import pytest

from stickslip import Dahl, LuGre
from stickslip.errors import InputError
from stickslip.study import presliding_length, presliding_loop
from stickslip.study.presliding import POINTS

MU, SIGMA_0, LOAD = 0.25, 1000.0, 9.81
DAHL = Dahl(kinetic_coefficient=MU, bristle_stiffness=SIGMA_0)
LUGRE = LuGre(
    kinetic_coefficient=MU,
    static_coefficient=0.35,
    stribeck_velocity=0.05,
    bristle_stiffness=SIGMA_0,
    bristle_damping=1.0,
)


def first_loading(law, amplitude):
    loop = presliding_loop(law, amplitude, LOAD, swings=1)
    return loop.displacement[: POINTS + 1], loop.friction[: POINTS + 1]


def test_the_first_loading_of_dahl_is_an_exponential():
    x, friction = first_loading(DAHL, 0.001)
    expected = MU * LOAD * (1 - np.exp(-SIGMA_0 * x / MU))
    # steps are accurate to 1e-11; what is read off between them to some 1e-9
    np.testing.assert_allclose(friction, expected, atol=1e-8 * MU * LOAD)


def test_a_far_swing_of_dahl_is_as_accurate_as_a_short_one():
    loop = presliding_loop(DAHL, 0.01, LOAD, swings=1)  # 40 presliding lengths
    x, friction = (one[POINTS + 1 : 2 * POINTS + 1] for one in (loop.displacement, loop.friction))
    back = MU * LOAD * (2 * np.exp(-SIGMA_0 * (0.01 - x) / MU) - 1)
    # as above; steps of order 4 and a twentieth of the presliding length left 2e-8
    np.testing.assert_allclose(friction, back, atol=5e-9 * MU * LOAD)


def test_slow_lugre_levels_off_at_its_static_coefficient():
    _, friction = first_loading(LUGRE, 20 * presliding_length(LUGRE, LOAD))
    # What the slow speed leaves: its fading, (1e-6 / 0.05)^2, and its bristle damping.
    assert friction[-1] == pytest.approx(0.35 * LOAD, rel=1e-6)


@pytest.mark.parametrize("law", [DAHL, LUGRE], ids=["dahl", "lugre"])
def test_the_presliding_length_is_break_away_over_the_first_stiffness(law):
    expected = float(law.break_away(LOAD)) / (SIGMA_0 * LOAD)
    assert presliding_length(law, LOAD) == pytest.approx(expected, rel=1e-4)


def test_a_widened_loop_takes_work_and_stays_below_break_away():
    loop = presliding_loop(DAHL, 0.0005, LOAD)
    force = (loop.friction[1:] + loop.friction[:-1]) / 2
    assert np.sum(force * np.diff(loop.displacement)) > 0
    assert np.abs(loop.friction).max() < MU * LOAD


def test_the_path_swings_ever_wider_to_both_sides():
    loop = presliding_loop(DAHL, 0.003, LOAD, swings=3)
    corners = loop.displacement[POINTS::POINTS]
    np.testing.assert_allclose(
        corners, [0.001, -0.001, 0.002, -0.002, 0.003, -0.003, 0.003], atol=1e-15
    )


@pytest.mark.parametrize(("amplitude", "swings"), [(0.0, 3), (-1.0, 3), (0.001, 0)])
def test_a_loop_without_amplitude_or_swings_is_refused(amplitude, swings):
    with pytest.raises(InputError, match="presliding loop"):
        presliding_loop(DAHL, amplitude, swings=swings)
