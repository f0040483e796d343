"""Velocities and accelerations of records, by closed forms."""

import numpy as np
import pytest

from stickslip import Measurement
from stickslip.data.differentiation import acceleration_of, noise_of, smooth, step_of, velocity_of
from stickslip.errors import InputError

RATE = 1000.0
TIME = np.arange(4000) / RATE
W = 2 * np.pi * 2
INSIDE = slice(100, -100)
"""Ten periods of the corner frequency from the ends, where the filter has settled."""


def gained(frequency, cutoff):
    """What the filter leaves of a sine: |H|^2 of order 4, prewarped, since it passes twice."""
    ratio = np.tan(np.pi * frequency / RATE) / np.tan(np.pi * cutoff / RATE)
    return 1 / (1 + ratio**8)


def test_the_velocity_of_a_sine_is_its_cosine():
    record = Measurement(time=TIME, position=0.1 * np.sin(W * TIME))
    expected = 0.1 * W * np.cos(W * TIME)
    # central differences: (w dt)^2/6 = 2.6e-5 of the amplitude
    error = (velocity_of(record) - expected)[INSIDE]
    assert np.abs(error).max() < 3e-5 * 0.1 * W


def test_the_acceleration_of_a_sine_is_found_from_either():
    expected = -0.1 * W**2 * np.sin(W * TIME)
    position = Measurement(time=TIME, position=0.1 * np.sin(W * TIME))
    velocity = Measurement(time=TIME, velocity=0.1 * W * np.cos(W * TIME))
    for record in (position, velocity):
        # twice the error of one difference
        error = (acceleration_of(record) - expected)[INSIDE]
        assert np.abs(error).max() < 6e-5 * 0.1 * W**2


@pytest.mark.parametrize("cutoff", [20.0, 50.0])
def test_the_filter_halves_its_corner_and_delays_nothing(cutoff):
    seen = smooth(TIME, np.sin(2 * np.pi * cutoff * TIME), cutoff)
    left = gained(cutoff, cutoff) * np.sin(2 * np.pi * cutoff * TIME)
    assert gained(cutoff, cutoff) == 0.5
    far = slice(1500, -1500)  # ends are remembered for ten periods of the corner
    np.testing.assert_allclose(seen[far], left[far], atol=1e-6)


def test_a_measured_velocity_is_kept_unless_a_corner_is_given():
    noisy = np.cos(W * TIME) + np.sin(2 * np.pi * 200 * TIME)
    record = Measurement(time=TIME, velocity=noisy, offset={"velocity": 0.5})
    np.testing.assert_array_equal(velocity_of(record), noisy - 0.5)
    filtered = velocity_of(record, cutoff=20.0)
    far = slice(500, -500)
    # of 2 Hz (1/10)^8 is lost, of 200 Hz (tan 36°/tan 3.6°)^-8 = 8e-9 is left
    np.testing.assert_allclose(filtered[far], (np.cos(W * TIME) - 0.5)[far], atol=1e-6)


def test_scattered_times_are_allowed():
    rng = np.random.default_rng(0)
    time = np.sort(TIME + rng.uniform(-0.3, 0.3, TIME.size) / RATE)
    record = Measurement(time=time, position=0.1 * np.sin(W * time))
    error = (velocity_of(record) - 0.1 * W * np.cos(W * time))[INSIDE]
    # straight lines between samples: (w dt)^2/8 of the position, over a step of time
    assert np.abs(error).max() < 0.02 * 0.1 * W


def test_nothing_is_filtered_across_a_gap():
    time = np.concatenate([TIME[:2000], TIME[2000:] + 1.0])
    position = np.concatenate([np.zeros(2000), np.ones(2000)])
    np.testing.assert_allclose(smooth(time, position), position, atol=1e-12)


def test_a_line_stays_a_line_to_its_ends():
    np.testing.assert_allclose(smooth(TIME, 2 + 3 * TIME), 2 + 3 * TIME, atol=1e-9)


def test_noise_is_found_under_a_motion():
    rng = np.random.default_rng(1)
    seen = 0.1 * np.sin(W * TIME) + rng.normal(0, 1e-5, TIME.size)
    # a median of 4,000 sizes is good to 1.2/sqrt(4000) = 2 %, neighbours not independent: 10 %
    assert noise_of(seen) == pytest.approx(1e-5, rel=0.1)
    assert noise_of(TIME) == 0.0


@pytest.mark.parametrize("step", [1e-7, 2.5e-4, 0.3])
def test_the_step_of_rounded_numbers_is_found(step):
    values = np.rint(np.sin(11.0 * TIME) / step / 3) * step
    assert step_of(values) == pytest.approx(step, rel=1e-4)


def test_numbers_that_are_not_rounded_have_no_step():
    rng = np.random.default_rng(1)
    for values in (rng.normal(size=5000), np.sin(W * TIME), TIME**2, np.zeros(10)):
        assert step_of(values) == 0.0


def test_levels_that_all_lie_within_half_a_step_have_none_and_warn_of_nothing():
    # a slow sine sampled finely: near its peaks differences are far below all others
    time = np.arange(0.0, 20.0, 1e-3)
    assert step_of(5.0 + 2.0 * np.sin(0.7 * time)) == 0.0


@pytest.mark.parametrize("cutoff", [0.0, -1.0, 500.0, np.nan])
def test_an_impossible_corner_is_refused(cutoff):
    with pytest.raises(InputError, match="between 0 and half the sampling frequency, 500 Hz"):
        smooth(TIME, TIME, cutoff)


def test_records_without_motion_are_refused_with_what_they_have():
    with pytest.raises(InputError, match=r"velocity of a record needs its position .* got force"):
        velocity_of(Measurement(time=[0, 1], force=[1, 2]))
    with pytest.raises(InputError, match="needs a single time record"):
        acceleration_of(Measurement(travel=0.1))
