"""Free motions: their friction from the energy, or the momentum, that it takes."""

import math

import numpy as np
import pytest
from benchmarks.band_truths.decays import Body, moved

from stickslip import Axis, CoulombViscous, Measurement, Pendulum, fit, select
from stickslip.errors import InputError
from stickslip.identify.problems.free_balance import free_form
from stickslip.identify.problems.record_signals import records_of
from stickslip.identify.propose import WORTH
from stickslip.identify.selection import problem_of_records

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


def test_the_level_of_a_decay_is_known_to_two_percent(verdict):
    assert verdict.family == ("level",)
    (interval,) = [
        parameter
        for parameter in verdict.parameters
        if parameter.path.endswith("kinetic_coefficient")
    ]
    assert interval.low < LEVEL < interval.high
    assert interval.high - interval.low < 0.04 * LEVEL


def test_the_band_of_a_decay_holds_its_friction_and_is_informative(verdict):
    top = float(verdict.speeds.max())
    v = np.linspace(0.2, 0.95, 10) * top
    band = verdict.band(v)
    assert np.all((band.low <= LEVEL) & (band.high >= LEVEL))
    assert np.median(band.high - band.low) < 0.6 * LEVEL


def test_friction_of_a_decay_never_drives(verdict):
    judgement = verdict.judgement
    rows = judgement.problem.asked()
    assert np.mean(judgement.curves(rows) * np.sign(rows.velocity) >= 0.0) > 0.99


def test_points_of_a_decay_are_forces(verdict):
    points = verdict.judgement.measured()
    assert np.median(points.friction) == pytest.approx(LEVEL, rel=0.3)


def test_a_run_of_the_law_follows_the_decay(verdict):
    seen = verdict.certificate
    spread = np.std(verdict.judgement.problem.balance.each[0].record.position)
    assert seen.run_error * spread == pytest.approx(0.3 * NOISE, rel=0.1)
    assert not seen.is_incomplete


def level_of(found):
    """Return the level of a verdict."""
    return next(x.value for x in found.parameters if x.path.endswith("kinetic_coefficient"))


def test_few_samples_a_swing_do_not_bias_the_level():
    # twelve a swing: straight lines between them would lose 3 % of the way
    rate = 12.0 * math.sqrt(STIFFNESS / INERTIA) / (2.0 * math.pi)
    found = select(RIG, ["coulomb"], swings(rate=rate, noise=1e-5))
    assert level_of(found) == pytest.approx(LEVEL, rel=1e-3)


@pytest.mark.slow
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


@pytest.mark.parametrize("noise", [2e-4, 2e-3, 2e-2])
def test_a_coast_down_of_few_positions_tells_drag_as_a_fit_of_its_motion_does(noise):
    # v = v0 / (1 + s), x = (m / c) log(1 + s), s = c v0 t / m
    mass, drag, v0 = 2.0, 0.3, 4.0
    t = np.linspace(0.0, 8.0, 60)

    def exact(c):
        return mass / c * np.log1p(c * v0 * t / mass)

    slope = (exact(1.001 * drag) - exact(0.999 * drag)) / (0.002 * drag)
    start = np.column_stack([np.ones(60), 1.0 / (1.0 + drag * v0 * t / mass)])
    left = slope - start @ np.linalg.lstsq(start, slope, rcond=None)[0]
    least = noise / np.linalg.norm(left)  # standard deviation where place and speed are open
    errors = []
    for seed in range(4):
        x = exact(drag) + noise * np.random.default_rng(seed).normal(size=60)
        found = select(Axis(inertia=mass), ["drag"], Measurement(time=t, position=x))
        errors.append(found.parameters[0].value - drag)
    assert np.sqrt(np.mean(np.square(errors))) < 2.0 * least


@pytest.mark.slow
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
    measured = Measurement(time=t, position=x)
    assert free_form(records_of(Axis(inertia=mass), measured)) == "momentum"
    found = select(Axis(inertia=mass), ["coulomb"], measured)
    assert level_of(found) == pytest.approx(level, rel=0.03)


@pytest.mark.slow
def test_a_constant_force_of_a_decay_is_no_friction():
    # the zero of the encoder is off: the spring then pulls with a constant force
    shifted = swings()
    shifted = Measurement(time=shifted.time, position=np.asarray(shifted.position) + 0.02)
    verdict = select(RIG, None, shifted, route="balance")
    assert verdict.family == ("level",)
    top = float(verdict.speeds.max())
    band = verdict.band([-0.5 * top, 0.5 * top])
    for side, low, high in zip((-1.0, 1.0), band.low, band.high, strict=True):
        assert low < side * LEVEL < high
        assert high - low < 0.2 * LEVEL  # the constant force is ten times as large


def test_a_free_motion_says_that_its_friction_goes_with_the_inertia(verdict):
    assert any(
        "only the ratio of friction to inertia" in sentence
        for sentence in verdict.words.cannot_tell
    )


def test_the_ends_of_few_swings_do_not_bias_the_level():
    full = swings(noise=1e-6)
    few = np.asarray(full.time) < 6.0 * math.pi / math.sqrt(STIFFNESS / INERTIA)
    short = Measurement(
        time=np.asarray(full.time)[few], position=np.asarray(full.position)[few], turning=True
    )
    assert level_of(select(RIG, ["coulomb"], short)) == pytest.approx(LEVEL, rel=0.01)


@pytest.mark.parametrize("last", [0.0, 0.5, 0.25])
def test_swings_are_no_coast_down_wherever_they_end(last):
    turns = np.arange(0.0, 1.0 + 1e-9, 1e-3)
    x = np.exp(-0.1 * turns) * np.cos(2.0 * np.pi * (12.0 + last) * turns)
    x[-1] = x[0] if last == 0.0 else x[-1]  # counts may be the same at both ends
    records = records_of(RIG, Measurement(time=10.0 * turns, position=x, turning=True))
    assert free_form(records) == "work"


@pytest.mark.slow
@pytest.mark.parametrize(("noise", "rate"), [(2e-4, 100.0), (1e-6, 100.0), (2e-5, 500.0)])
def test_a_block_that_comes_to_rest_within_its_record_has_coulomb_friction(noise, rate):
    """At rest friction is not that of sliding, by which the record must not be judged."""
    friction, speed = 1.962, 1.3
    t = np.arange(0.0, 1.6 * speed / friction, 1.0 / rate)
    slid = np.minimum(t, speed / friction)
    x = speed * slid - 0.5 * friction * slid**2
    x = x + noise * np.random.default_rng(3).normal(size=len(t))
    found = select(Axis(inertia=1.0), None, Measurement(time=t, position=x))
    assert found.family == ("level",)
    (interval,) = (
        parameter
        for parameter in found.parameters
        if parameter.path.endswith("kinetic_coefficient")
    )
    # of noise of a micrometre the interval is 2e-5 wide, and so is the error of the filter
    assert interval.low - 1e-4 * friction <= friction <= interval.high + 1e-4 * friction


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 3])
def test_swings_that_stop_within_their_record_have_the_level_that_stops_them(seed):
    t = np.arange(0.0, 20.0, 0.005)
    moving = swings(seed, noise=0.0)
    x = np.interp(t, moving.time, moving.position)
    x = x + NOISE * np.random.default_rng(seed).normal(size=len(t))
    found = select(RIG, None, Measurement(time=t, position=x, turning=True))
    (interval,) = (
        parameter
        for parameter in found.parameters
        if parameter.path.endswith("kinetic_coefficient")
    )
    assert interval.low < LEVEL < interval.high


@pytest.mark.parametrize("rate", [90.0, 200.0, 410.0])
def test_a_decay_has_a_figure_at_any_rate(rate):
    found = select(RIG, ["coulomb", "viscous"], swings(rate=rate))
    drawing = found.drawing()
    assert len(drawing.weights) == len(drawing.velocity)


def test_further_motions_are_expected_to_narrow_the_band(verdict):
    judgement = verdict.judgement
    share = judgement.problem.start_of(judgement.draws)
    widths = judgement.problem.further(judgement.draws, share)
    assert list(widths) == sorted(widths, reverse=True)
    assert 0.0 < widths[-1] < widths[0] < 1.0
    assert verdict.shrinks == widths[0]
    told = any("Record another such motion" in said for said in verdict.words.measure_next)
    assert told == (widths[0] < WORTH)


@pytest.mark.slow
def test_a_further_motion_narrows_the_band_about_as_expected(verdict):
    both = Measurement(trials=(swings(), swings(seed=1)))
    after = select(RIG, None, both, route="balance").judgement
    rows = after.problem.asked()
    before, now = (np.std(one.curves(rows), axis=0).mean() for one in (verdict.judgement, after))
    # it also tells laws apart, which is not in what is expected
    expected = verdict.judgement.problem.further(verdict.judgement.draws)[0]
    assert 0.3 < now / before / expected < 1.3


def swinging(friction, *, drift=0.0, noise=1e-3, rate=50.0):
    """Return a pendulum whose length is given .2 % off, and its swing with what it lost."""
    length, mass = 0.4, 0.8
    weight = mass * length * 9.81
    body = Body(
        inertia=mass * length**2,
        pull=lambda q: -weight * math.sin(q),
        level=friction(0.0) * weight,
        friction=lambda v: friction(v) * weight,
    )
    t = np.arange(0.0, 30.0, 1.0 / rate)
    q, _ = moved(body, 0.8, 0.0, t, 0.25 / rate)
    noises = noise * np.random.default_rng(3).normal(size=len(t))
    record = Measurement(time=t, position=q + noises + drift * t / t[-1], turning=True)
    return Pendulum(mass=mass, length=1.002 * length, gravity=9.81), record, weight


@pytest.mark.parametrize("drift", [0.0, 0.01])
def test_a_swing_tells_its_length_and_friction_beside_a_zero_that_drifts(drift):
    rig, record, weight = swinging(lambda v: 0.006 + 0.0018 * v, drift=drift)
    found = select(rig, None, record)
    band = found.friction
    true = np.sign(found.speeds) * (0.006 + 0.0018 * np.abs(found.speeds)) * weight
    assert np.mean((band.low <= true) & (true <= band.high)) > 0.9
    assert found.family == ("level", "viscous")
    length = found.judgement.problem.rig(found.judgement.draws)["mechanism.length"]
    assert abs(np.mean(length) - 0.4) < 3.0 * np.std(length) < 1e-4


def test_a_law_with_a_part_held_is_fitted_to_a_swing():
    rig, record, weight = swinging(lambda v: 0.006 + 0.0018 * v)
    found = fit(rig, CoulombViscous, record, fixed={"viscous_coefficient": 0.0018 * weight})
    (level,) = (one for one in found.estimates if one.path == "friction.kinetic_coefficient")
    assert level.low < 0.006 * weight < level.high
    assert level.high - level.low < 0.01 * level.value


def test_a_motion_that_only_speeds_up_is_refused():
    t = np.arange(0.0, 3.0, 0.01)
    noise = 1e-4 * np.random.default_rng(1).normal(size=len(t))
    record = Measurement(time=t, position=0.5 * t + 0.25 * t**2 + noise)
    with pytest.raises(InputError, match="gains momentum, which friction only takes"):
        select(Axis(inertia=1.0), None, record)


DRIVEN = {
    "no spring": (Axis(inertia=1.0), (), "turns back although no spring"),
    "another length": (Pendulum(mass=1.0, length=0.5), (), "no run of a law follows"),
    "its length": (
        Pendulum(mass=1.0, length=0.5),
        ("mechanism.length",),
        "no run of a law follows",
    ),
}


@pytest.mark.parametrize("case", DRIVEN)
def test_a_driven_motion_whose_drive_is_missing_is_refused_by_the_judge_itself(case):
    rig, sought, message = DRIVEN[case]
    t = np.arange(0.0, 20.0, 0.01)
    x = 0.5 * np.sin(2.0 * t) + 1e-4 * np.random.default_rng(0).normal(size=len(t))
    motion = Measurement(time=t, position=x, turning=case != "no spring")
    with pytest.raises(InputError, match=message):
        problem_of_records(rig, records_of(rig, motion, unknown=sought), vary=sought)
