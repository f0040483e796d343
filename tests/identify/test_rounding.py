"""Bands and intervals are those of a measurement, and not of its last digits."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, Measurement, select, simulate
from stickslip.mechanisms.drives import Sine

AXIS = Axis(inertia=2.0, drive=Sine(amplitude=8.0, frequency=0.5))
LAW = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=1.5)


def table() -> Measurement:
    v = np.geomspace(0.01, 1.0, 14)
    noise = 0.02 * np.random.default_rng(3).normal(size=len(v))
    return Measurement(velocity=v, friction=2.0 + 1.5 * np.exp(-((v / 0.1) ** 2)) + 3.0 * v + noise)


def record() -> Measurement:
    t = np.arange(0.0, 8.0, 0.005)
    x = simulate(AXIS, LAW, t_end=8.0).at(t)["x"]
    x = x + 1e-6 * np.random.default_rng(4).normal(size=len(t))
    return Measurement(time=t, position=x, force=8.0 * np.sin(np.pi * t))


def rounded(measurement: Measurement, name: str) -> Measurement:
    """Return a measurement that differs by some last digits."""
    values = np.asarray(getattr(measurement, name))
    digits = np.random.default_rng(5).choice([-1.0, 0.0, 1.0], len(values))
    return replace(measurement, **{name: values * (1.0 + 1e-14 * digits)})


@pytest.mark.slow
@pytest.mark.parametrize(("made", "name"), [(table, "friction"), (record, "force")])
def test_last_digits_change_no_band_and_no_interval(made, name):
    axis = Axis(inertia=2.0)
    one, other = (select(axis, None, m) for m in (made(), rounded(made(), name)))
    bands = [verdict.band([0.02, 0.1, 0.5]) for verdict in (one, other)]
    for ends in ("low", "median", "high"):
        known = getattr(bands[0], ends)
        np.testing.assert_allclose(getattr(bands[1], ends), known, rtol=1e-3)
    assert [p.path for p in one.parameters] == [p.path for p in other.parameters]
    for p, q in zip(one.parameters, other.parameters, strict=True):
        assert (q.low, q.high) == pytest.approx((p.low, p.high), rel=1e-3)
