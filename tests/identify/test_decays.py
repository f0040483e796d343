"""Free motions: their friction from the energy, or the momentum, that it takes."""

import math

import numpy as np
import pytest

from stickslip import Axis, Measurement, select
from stickslip.identify.kinds.record_signals import records_of
from stickslip.identify.kinds.records import RecordsProblem

INERTIA, STIFFNESS, LEVEL = 0.5, 200.0, 0.4
NOISE = 1e-3


def swings(seed=0, *, rate=200.0, level=LEVEL, start=0.3, noise=NOISE):
    """Return a mass on a spring that dry friction stops: half swings about +- level/stiffness."""
    w, shift = math.sqrt(STIFFNESS / INERTIA), level / STIFFNESS
    t = np.arange(0.0, 24.0 * math.pi / w, 1.0 / rate)
    half = np.floor(t * w / math.pi)
    side = np.where(half % 2 == 0, 1.0, -1.0)
    # each half swing ends 2 shift closer to 0 than it began
    x = side * ((start - (2.0 * half + 1.0) * shift) * np.cos(t * w - half * math.pi) + shift)
    x = x + noise * start * np.random.default_rng(seed).normal(size=len(t))
    return Measurement(time=t, position=x, turning=True)


RIG = Axis(inertia=INERTIA, stiffness=STIFFNESS)


@pytest.fixture(scope="module")
def verdict():
    return select(RIG, None, swings(), route="balance")


def test_the_level_of_a_decay_is_known_to_a_percent(verdict):
    assert verdict.family == ("level",)
    (interval,) = [one for one in verdict.parameters if one.path.endswith("kinetic_coefficient")]
    assert interval.low < LEVEL < interval.high
    assert interval.high - interval.low < 0.02 * LEVEL


def test_the_band_of_a_decay_holds_its_friction_and_is_informative(verdict):
    top = verdict.judgement.problem.frame.top
    v = np.linspace(0.2, 0.95, 10) * top
    band = verdict.band(v)
    assert np.all((band.low <= LEVEL) & (band.high >= LEVEL))
    assert np.median(band.high - band.low) < 0.6 * LEVEL


def test_friction_of_a_decay_never_drives(verdict):
    curves = verdict.judgement.ensemble.curves(verdict.judgement.problem.asked())
    velocity = verdict.judgement.problem.asked().velocity
    assert np.mean(curves * np.sign(velocity) >= 0.0) > 0.99


def test_points_of_a_decay_are_forces(verdict):
    judgement = verdict.judgement
    fit = judgement.ensemble.fit(judgement.estimated)
    points = judgement.problem.points(judgement.estimated, fit.coefficients)
    forward = points.friction[points.velocity > 0.5 * judgement.problem.frame.top]
    assert np.mean(forward) == pytest.approx(LEVEL, rel=0.3)


def test_few_samples_a_swing_do_not_bias_the_level():
    # twelve a swing: straight lines between them would lose 3 % of the way
    rate = 12.0 * math.sqrt(STIFFNESS / INERTIA) / (2.0 * math.pi)
    problem = RecordsProblem(records_of(RIG, swings(rate=rate, noise=1e-5)))
    x = problem.terms["level"].columns(problem.rows, (0.0, 0.0))
    assert x @ problem.response / (x @ x) == pytest.approx(LEVEL, rel=0.01)


@pytest.mark.parametrize("quantity", ["position", "velocity"])
def test_a_coast_down_tells_level_and_viscous_friction(quantity):
    # m v' = -level - viscous v, in closed form
    mass, level, viscous, v0 = 10.0, 2.0, 0.5, 6.0
    rate, ratio = viscous / mass, level / viscous
    t = np.arange(0.0, 16.0, 0.05)
    fading = np.exp(-rate * t)
    v = (v0 + ratio) * fading - ratio
    x = (v0 + ratio) * (1.0 - fading) / rate - ratio * t
    y = x if quantity == "position" else v
    y = y + 1e-4 * np.ptp(y) * np.random.default_rng(1).normal(size=len(y))
    found = select(Axis(inertia=mass), None, Measurement(time=t, **{quantity: y}), route="balance")
    speeds = np.linspace(0.2, 0.9, 5) * v0
    band = found.band(speeds)
    true = level + viscous * speeds
    assert np.all((band.low <= true) & (true <= band.high))
    assert np.median(band.high - band.low) < 0.25 * np.median(true)


def test_a_constant_known_force_stays_known():
    # down a slope whose force is given: friction is what it takes, less what slows the mass
    t = np.arange(0.0, 8.0, 0.02)
    x = 5.0 * t - 0.5 * 0.2 * t**2 + 1e-4 * np.random.default_rng(2).normal(size=len(t))
    found = select(
        Axis(inertia=2.0, offset=0.3), None, Measurement(time=t, position=x), route="balance"
    )
    band = found.band([4.0])
    assert band.low[0] < 0.1 < band.high[0]
    assert band.high[0] - band.low[0] < 0.1


def test_noise_turns_no_coast_down():
    # it ends in rest, where noise is all there is: neither places nor directions are told
    mass, level, v0 = 3.0, 0.6, 1.5
    t = np.arange(0.0, 9.0, 0.06)
    moving = np.minimum(t, v0 * mass / level)
    x = v0 * moving - 0.5 * level / mass * moving**2
    x = x + 3e-3 * np.ptp(x) * np.random.default_rng(3).normal(size=len(t))
    problem = RecordsProblem(records_of(Axis(inertia=mass), Measurement(time=t, position=x)))
    assert problem.free == "momentum"
    assert np.all(problem.rows.direction == 1.0)
    assert not {"spring", "ripple", "offset"} & problem.terms.keys()
    column = problem.terms["level"].columns(problem.rows, (0.0, 0.0))
    assert column @ problem.response / (column @ column) == pytest.approx(level, rel=0.03)
