"""Intervals where residuals are correlated."""

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from stickslip import Axis, Measurement, fit
from stickslip.identify.simulated import effective_size


def autoregression(count, decay, random):
    """Return a first-order autoregression of unit variance."""
    shocks = math.sqrt(1.0 - decay**2) * random.standard_normal(count)
    shocks[0] /= math.sqrt(1.0 - decay**2)
    return lfilter([1.0], [1.0, -decay], shocks)


def test_rows_that_a_fit_follows_exactly_leave_no_division_by_zero():
    # of four rows of a half, two leave 1e-10 of their variance to three parameters
    v = np.linspace(-1.0, 1.0, 10)
    friction = 2.0 * np.sign(v) + 0.05 * np.random.default_rng(3).normal(size=10)
    found = fit(Axis(inertia=1.0), "power-viscous", Measurement(velocity=v, friction=friction))
    assert all(np.isfinite(one.value) for one in found.estimates)


def test_an_autoregression_has_the_effective_size_of_the_textbook():
    decay, count = 0.8, 20_000
    seen = autoregression(count, decay, np.random.default_rng(9))
    # n (1 - a) / (1 + a); the sum up to the first zero adds the noise of a few lags to it
    assert effective_size(seen) == pytest.approx(count * (1 - decay) / (1 + decay), rel=0.15)
    white = np.random.default_rng(9).normal(size=2000)
    assert effective_size(white) == pytest.approx(2000.0, rel=0.1)
    assert effective_size(np.ones(30)) == 30.0
