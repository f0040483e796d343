"""Records that no judge may be given: forces of the wrong sign; and terms of what drives them."""

import numpy as np
import pytest
from scipy.signal import lfilter

from stickslip import Axis, Measurement, select
from stickslip.errors import InputError
from stickslip.identify.problems.record_signals import Record, noise_of, records_of
from stickslip.identify.problems.records import RecordsProblem

LEVEL, VISCOUS, INERTIA = 1.0, 0.3, 0.02
RATE = 1000.0


def moved(seed=0, *, seconds=8.0):
    """Return times, positions, velocities and accelerations of a sum of sines, in closed form."""
    rng = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 1.0 / RATE)
    x = v = a = np.zeros_like(t)
    for f in rng.uniform(0.3, 1.7, 3):
        w, phase = 2.0 * np.pi * f, rng.uniform(0.0, 6.0)
        size = 0.4 / f
        x, v = x + size * np.sin(w * t + phase), v + size * w * np.cos(w * t + phase)
        a = a - size * w**2 * np.sin(w * t + phase)
    return t, x, v, a


def driven(seed=0, *, extra=None, **options):
    """Return times, positions and forces of an axis with Coulomb and viscous friction."""
    rng = np.random.default_rng(seed + 100)
    t, x, v, a = moved(seed, **options)
    force = INERTIA * a + LEVEL * np.sign(v) + VISCOUS * v
    force = force + (0.0 if extra is None else extra(t, x, v))
    return t, x + 1e-5 * rng.normal(size=len(t)), force + 0.02 * rng.normal(size=len(t))


def problem(t, x, force, **options):
    return RecordsProblem([Record(time=t, position=x, force=force, **options)])


@pytest.mark.parametrize("inertia", [None, INERTIA])
def test_a_sign_that_changes_midway_is_refused_with_its_time(inertia):
    t, x, force = driven()
    with pytest.raises(
        InputError, match=r"sign of the force changes at about t = (4\.\d|3\.[5-9])"
    ):
        problem(t, x, np.where(t > 4.0, -force, force), inertia=inertia)


def test_a_force_of_the_other_sign_is_refused():
    t, x, force = driven()
    with pytest.raises(InputError, match="friction would drive the motion"):
        problem(t, x, -force)


@pytest.mark.parametrize("friction", [1.0, 0.0])
def test_sound_forces_are_not_refused(friction):
    t, x, v, a = moved(3)
    noise = 0.02 * np.random.default_rng(4).normal(size=len(t))
    force = INERTIA * a + friction * (LEVEL * np.sign(v) + VISCOUS * v) + noise
    assert problem(t, x, force).finds_inertia


def test_clipping_may_not_say_all_of_the_force():
    # cut at little, it would predict the force by itself
    t, x, force = driven(5)
    clip = problem(t, x, force).terms["clip"]
    assert clip.ranges[0][0] > np.median(np.abs(force))
    assert "level" in clip.needs


def rested(t, x, force):
    """Return a record that rests before and after it, over most of its time."""
    pause = 3 * len(t)
    count = len(t) + 2 * pause
    held = np.pad(x, pause, mode="edge"), np.pad(force, pause)
    return np.arange(count) / RATE, *held


def test_limits_of_the_force_are_none_at_which_a_record_rests():
    t, x, force = driven(5, seconds=4.0)
    terms = problem(*rested(t, x, force)).terms
    moving, resting = problem(t, x, force).terms["clip"].ranges[0], terms["clip"].ranges[0]
    # the ends of a record are left out, which are other samples in each
    np.testing.assert_allclose(resting, moving, rtol=0.1)
    assert terms["clip"].steps[0] > 1.0
    assert min(shape[0] for shape in terms["dead_zone"].shapes) > 0.0


def test_limits_of_the_force_are_a_good_share_of_the_largest():
    t, x, force = driven(5)
    burst = force * (1.0 + 20.0 * np.exp(-(((t - 4.0) / 0.05) ** 2)))
    low, high = problem(t, x, burst, inertia=INERTIA).terms["clip"].ranges[0]
    assert low >= high / 3.0 * (1.0 - 1e-12)


def test_steps_of_an_encoder_that_a_file_rounds_are_its_noise():
    step = 4.84e-5  # 48 or 49 um with six decimals
    t, x, _, _ = moved(2)
    x = np.concatenate([np.zeros(5 * len(t)), x - x[0]])  # in most twentieths it rests
    read = np.round(np.round(x / step) * step, 6)
    assert noise_of(read) == pytest.approx(step / np.sqrt(12.0), rel=0.01)


def test_a_spring_that_relaxes_is_told_from_friction():
    def hose(t, x, v):
        keep = np.exp(-1.0 / RATE / 0.4)
        return 4.0 * lfilter([0.4 * (1.0 - keep)], [1.0, -keep], v)

    t, x, force = driven(7, extra=hose)
    found = select(
        Axis(inertia=INERTIA),
        None,
        Measurement(time=t, position=x, force=force, turning=True),
        vary=["friction.*", "mechanism.inertia"],
        route="balance",
    )
    assert "hose" in found.family
    band = found.band([2.0])
    assert band.low[0] < LEVEL + 2.0 * VISCOUS < band.high[0]


def test_a_known_constant_force_is_no_friction():
    t, x, force = driven(8, extra=lambda t, x, v: 0.4)
    measured = Measurement(time=t, position=x, force=force, turning=True)
    rig = Axis(inertia=INERTIA, offset=0.4)
    found = select(rig, None, measured, vary=["friction.*", "mechanism.inertia"], route="balance")
    forward, backward = found.band([-1.0, 1.0]).median[::-1]
    assert forward == pytest.approx(LEVEL + VISCOUS, rel=0.01)
    assert backward == pytest.approx(-LEVEL - VISCOUS, rel=0.01)


def test_bristles_shorter_than_noise_shows_are_not_looked_for():
    t, x, force = driven(9)
    one = problem(t, x, force)
    lengths = [shape[0] for shape in one.terms["level"].shapes if shape[0]]
    least = one.terms["level"].ranges[0][0]
    assert min(lengths) >= least * (1.0 - 1e-12)
    assert least >= 5.0 * one.frame.noise * (1.0 - 1e-12)


def test_bristles_are_longer_than_a_sample_tells_where_velocities_have_no_noise():
    t, _, v, _ = moved(10)
    record = Measurement(time=t, velocity=v, friction=np.sign(v), turning=True)
    found = RecordsProblem(records_of(Axis(inertia=1.0), record))
    least = found.terms["level"].ranges[0][0]
    assert least >= found.frame.low / RATE


def test_the_curve_of_a_record_whose_load_changes_predicts_as_well_as_the_law():
    # viscous friction and a part of the level that no load changes: the curve is times the load
    load = 1.2 + 0.8 * np.sin(1.7 * moved(12)[0])
    t, x, force = driven(12, extra=lambda t, x, v: 0.5 * load * np.sign(v))
    found = select(
        Axis(inertia=INERTIA),
        None,
        Measurement(time=t, position=x, force=force, load=load, turning=True),
        vary=["friction.*", "mechanism.inertia"],
        route="balance",
    )
    assert found.judgement.comparison.curve_ratio > 0.8
    band = found.band([2.0], [1.5])
    true = LEVEL + 0.75 + 2.0 * VISCOUS
    assert abs(band.median[0] - true) < 0.01 * true
    assert band.high[0] - band.low[0] < 0.1 * true


def test_a_motion_that_lags_is_no_delay_of_the_recorded_force():
    # the force acts 4 ms after it was recorded: latency of a drive, or a load behind a coupling
    t, x, force = driven(13)
    early = np.interp(t + 0.004, t, force)
    found = select(
        Axis(inertia=INERTIA),
        None,
        Measurement(time=t, position=x, force=early, turning=True),
        vary=["friction.*", "mechanism.inertia"],
        route="balance",
    )
    assert "latency" in found.family
    assert "delay" not in found.family
    (inertia,) = [
        parameter for parameter in found.parameters if parameter.path == "mechanism.inertia"
    ]
    assert inertia.low_any < INERTIA < inertia.high_any
