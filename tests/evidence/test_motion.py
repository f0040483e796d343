"""What a measured motion shows: resolution, band, direction, rests."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.signal import sosfiltfilt

from stickslip.evidence import Series
from stickslip.evidence.motion import (
    SHARE,
    band,
    derivative,
    directions,
    low_pass,
    open_rows,
    resolution,
)

H = 1e-3
T = H * np.arange(20_000)
RANDOM = np.random.default_rng(3)


def noisy(x, sigma):
    return x + sigma * RANDOM.normal(size=len(x))


def test_the_resolution_is_the_rounding_or_the_noise_whichever_is_larger():
    x = np.sin(T)
    assert resolution(np.round(x / 1e-3) * 1e-3) == pytest.approx(1e-3 / math.sqrt(12.0), rel=1e-6)
    assert resolution(noisy(x, 1e-4)) == pytest.approx(1e-4, rel=0.1)  # of a thousand samples


@pytest.mark.parametrize("jitter", [0.02, 0.1, 0.45])
@pytest.mark.parametrize("sigma", [1e-6, 1e-4])
def test_jitter_of_the_times_changes_neither_the_resolution_nor_the_band(jitter, sigma):
    random, found = np.random.default_rng(4), []
    for t in (T, T + jitter * H * random.uniform(-1.0, 1.0, len(T))):
        x = np.sin(3.0 * t) + sigma * random.normal(size=len(t))
        series = Series(t, x, -9.0 * np.sin(3.0 * t) + 5.0 * np.sign(np.cos(3.0 * t)))
        found.append((resolution(x, t), band(series)))
    assert found[0][0] == pytest.approx(sigma, rel=0.1)
    assert found[1] == pytest.approx(found[0], rel=0.1)  # the sixth root of the share of noise


def test_a_resolution_that_is_given_sets_the_band_of_interpolated_positions():
    x, at = 1e-4 * np.round(1e4 * np.sin(T)), T[1:-1] + 0.3 * H
    force = 5.0 * np.sign(np.cos(T))
    recorded = Series(T, x, force, mass=1.0)
    between = Series(at, np.interp(at, T, x), force[1:-1], mass=1.0)
    assert band(between) > 1.1 * band(recorded)
    given = replace(between, resolution=resolution(x))
    assert band(given) == pytest.approx(band(recorded), rel=1e-3)


@pytest.mark.parametrize("shape", [(64,), (500, 1), (500, 3)])
def test_a_filter_that_knows_its_settled_states_is_that_of_scipy(shape):
    low, x = low_pass(H, 30.0), np.cumsum(RANDOM.normal(size=shape), axis=0)
    np.testing.assert_array_equal(low.passed(x), sosfiltfilt(low.sections, x, axis=0))


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e5])
def test_the_resolution_has_the_unit_of_the_position(scale):
    x = np.round(np.sin(T) / 1e-3) * 1e-3
    assert resolution(scale * x) == pytest.approx(scale * resolution(x), rel=1e-6)


def test_derivatives_are_of_the_fourth_order():
    errors = []
    for n in (200, 400):
        t = np.linspace(0.0, 2.0, n)
        off = derivative(np.sin(3.0 * t), t[1] - t[0]) - 3.0 * np.cos(3.0 * t)
        errors.append(np.max(np.abs(off[5:-5])))
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.05)


def test_in_the_band_noise_of_the_position_costs_its_share_of_the_force():
    mass, sigma = 0.5, 2e-5
    x = 0.3 * np.sin(2.0 * np.pi * T)
    v, a = np.gradient(x, H), -0.3 * (2.0 * np.pi) ** 2 * np.sin(2.0 * np.pi * T)
    force = mass * a + 5.0 * np.sign(v)
    fc = band(Series(T, noisy(x, sigma), force))
    noise = derivative(derivative(low_pass(H, fc).passed(sigma * RANDOM.normal(size=len(T))), H), H)
    # the filter is not as steep as the closed form assumes, and goes forward and backward
    assert mass * np.std(noise[100:-100]) == pytest.approx(SHARE * np.std(force), rel=0.25)


def test_friction_that_is_measured_itself_has_the_widest_band():
    assert band(Series(T, np.sin(T), np.cos(T), inertia=False)) == pytest.approx(60.0)
    slow = Series(10.0 * T, np.sin(T), np.cos(T), inertia=False)
    assert band(slow) == pytest.approx(20.0)


def test_slow_motion_has_a_direction_where_the_band_is_narrow_enough():
    sigma = 1e-4
    slow = np.where(T < 10.0, 4e-3 * T, 4e-2 - 4e-3 * (T - 10.0))
    x = noisy(slow, sigma)
    wide = low_pass(H, 120.0).passed(x)
    found = directions(Series(T, x, T), np.gradient(wide, H), sigma, 60.0)
    assert np.mean(found[1000:9500] == 1.0) > 0.95
    assert np.mean(found[11_000:19_000] == -1.0) > 0.95


def test_a_direction_holds_at_rest():
    x = np.tanh(T - 5.0)
    found = directions(Series(T, x, T), np.gradient(x, H), 1e-5, 20.0)
    assert (found[2000:] == 1.0).all()


def test_rests_and_reversals_are_open_and_motion_is_not():
    x = np.where(T < 5.0, 0.1 * T, np.where(T < 8.0, 0.5, 0.5 - 0.1 * (T - 8.0)))
    direction = np.where(T < 8.0, 1.0, -1.0)
    found = open_rows(x, direction, 1e-3, 20.0, H)
    assert found[5100:7900].all()
    assert not found[:4800].any()
    assert not found[8200:].any()


def test_a_turn_without_a_rest_is_open_as_far_as_the_filter_mixes_it():
    x = np.sin(T)
    found = open_rows(x, np.sign(np.cos(T)), 1e-9, 20.0, H)
    turns = np.flatnonzero(np.diff(np.sign(np.cos(T))))
    assert found[turns].all()
    assert np.sum(found) == pytest.approx(len(turns) * 51, abs=5)  # 0.5 / 20 Hz on either side
