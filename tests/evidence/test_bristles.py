"""Bristle states, plays and free loads along a path."""

import math

import numpy as np
import pytest
from benchmarks.axis_records import TRUTHS, record
from scipy.integrate import quad

from stickslip.evidence import Balance, play
from stickslip.evidence.bristles import bristle_states, free_load, lugre_states

RANDOM = np.random.default_rng(1)
PATH = np.cumsum(RANDOM.normal(scale=0.2, size=400))


@pytest.mark.parametrize("n", [0.5, 1.0, 1.7, 2.0])
def test_the_way_of_a_bristle_step_is_the_integral_of_its_compliance(n):
    (z,) = bristle_states(np.array([0.0, 0.8]), [(1.0, n)], -0.3)[1:, 0]
    way, _ = quad(lambda s: (1.0 - s) ** -n, -0.3, z)
    assert way == pytest.approx(0.8, rel=1e-9)  # quadrature


@pytest.mark.parametrize("n", [0.0, 0.5, 1.0, 2.0])
def test_states_do_not_depend_on_how_finely_a_path_is_sampled(n):
    fine = np.interp(np.arange(0.0, 399.0, 0.25), np.arange(400.0), PATH)
    coarse = bristle_states(PATH, [(0.7, n)], 0.2)[:, 0]
    # to rounding, which an exponent above 1 magnifies near the full state
    np.testing.assert_allclose(
        bristle_states(fine, [(0.7, n)], 0.2)[::4, 0], coarse[:-1], atol=1e-9
    )


def test_a_stop_follows_the_path_and_holds_at_the_level():
    z = bristle_states(np.array([0.0, 0.5, 2.0, 1.5, -3.0, -3.0]), [(1.0, 0.0)], 0.0)[:, 0]
    np.testing.assert_allclose(z, [0.0, 0.5, 1.0, 0.5, -1.0, -1.0], atol=1e-15)


def test_many_shapes_at_once_are_those_one_by_one():
    shapes = [(0.1, 0.0), (0.3, 1.0), (0.2, 0.5), (0.5, 2.0), (0.4, 1.0)]
    together = bristle_states(PATH, shapes, 0.1)
    alone = [bristle_states(PATH, [one], 0.1)[:, 0] for one in shapes]
    np.testing.assert_allclose(together, np.array(alone).T, atol=1e-15)


def test_a_mirrored_path_mirrors_states():
    shapes = [(0.1, 0.0), (0.3, 1.0), (0.2, 0.5)]
    mirrored = bristle_states(-PATH, shapes, -0.1)
    np.testing.assert_allclose(mirrored, -bristle_states(PATH, shapes, 0.1), atol=1e-15)


def test_lugre_states_without_a_step_are_those_of_dahl():
    v = np.gradient(PATH)
    found = lugre_states(PATH, v, [(0.3, 1.0, 0.1, 0.0, 1.0)], 0.2)
    np.testing.assert_allclose(found, bristle_states(PATH, [(0.3, 1.0)], 0.2), atol=1e-12)


def test_lugre_states_side_by_side_are_those_of_a_loop():
    v = np.gradient(PATH)
    length, v_s, rho = 0.3, 0.1, 0.8
    state, wanted = 0.2, [0.2]
    for dx, speed in zip(np.diff(PATH), v[1:], strict=True):
        level = 1.0 + rho * math.exp(-abs(speed) / v_s)
        goal = math.copysign(level, dx)
        state = goal + (state - goal) * math.exp(-abs(dx) / (length * level))
        wanted.append(state)
    found = lugre_states(PATH, v, [(length, 1.0, v_s, rho, 1.0)], 0.2)
    np.testing.assert_allclose(found[:, 0], wanted, atol=1e-12)


def test_play_swallows_chatter_of_less_than_its_reach():
    chatter = 0.4 * np.sign(np.sin(np.arange(50.0)))
    assert np.ptp(play(1.0 + chatter, 0.5)) <= 0.5
    np.testing.assert_allclose(play(np.array([0.0, 2.0, 1.8, 1.0]), 0.5), [0.0, 1.5, 1.5, 1.5])


def test_a_load_without_a_gap_on_a_stiff_spring_moves_with_the_axis():
    h = 1e-3
    t = h * np.arange(3000)
    x, v, a = np.sin(2.0 * t), 2.0 * np.cos(2.0 * t), -4.0 * np.sin(2.0 * t)
    found = free_load(x, v, h, 0.0, 35.0)
    late = slice(1000, None)  # after the transient
    assert np.max(np.abs(found - a)[late]) < 0.02 * np.max(np.abs(a))


@pytest.mark.parametrize("name", ["da1", "da2"])
def test_the_filtered_path_with_play_has_the_state_that_noise_at_rest_relaxes(name):
    truth = next(one for one in TRUTHS if one.name == name)
    measured = record(truth, 5, seconds=12.0)
    shape = (truth.plant.length, truth.plant.bristle_exponent)
    true = bristle_states(measured.true_position, [shape], 0.0)[:, 0]
    (part,) = Balance([measured.series]).parts
    rows = slice(1000, -1000)

    def error(path):
        return float(np.std((bristle_states(path, [shape], 0.0)[:, 0] - true)[rows]))

    # share of the friction; measured: 0.34 and 0.22 % against 23 and 17 %
    assert error(part.path) < 0.006
    assert error(measured.q) > 0.15
