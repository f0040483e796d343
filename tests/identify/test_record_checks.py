"""Records that no judge may be given: forces of the wrong sign; and terms of what drives them."""

import math
from collections.abc import Callable
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.signal import lfilter

from stickslip import Axis, Measurement, select
from stickslip.errors import InputError
from stickslip.identify.bands import Array
from stickslip.identify.problems.record_checks import refuse_wrong_signs
from stickslip.identify.problems.record_model import RecordModel, force_wave
from stickslip.identify.problems.record_rows import RESTS, by_best_sensor, pieces_of
from stickslip.identify.problems.record_signals import Record, noise_of

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


def refused(t, x, force, **options):
    refuse_wrong_signs([Record(time=t, position=x, force=force, **options)])


@pytest.mark.parametrize("inertia", [None, INERTIA])
def test_a_sign_that_changes_midway_is_refused_with_its_time(inertia):
    t, x, force = driven()
    with pytest.raises(
        InputError, match=r"sign of the force changes at about t = (4\.\d|3\.[5-9])"
    ):
        refused(t, x, np.where(t > 4.0, -force, force), inertia=inertia)


@pytest.mark.parametrize("inertia", [None, INERTIA])
def test_a_force_of_the_other_sign_is_refused(inertia):
    t, x, force = driven()
    with pytest.raises(InputError, match="friction would drive the motion"):
        refused(t, x, -force, inertia=inertia)


@pytest.mark.parametrize("rate", [0.3, 3.0])
def test_the_sign_is_told_below_and_above_a_resonance_and_of_a_single_sine(rate):
    t = np.arange(0.0, 8.0, 1.0 / RATE)
    v = np.cos(rate * t) * rate
    force = INERTIA * -np.sin(rate * t) * rate**2 + LEVEL * np.sign(v) + VISCOUS * v
    refused(t, np.sin(rate * t), force, inertia=INERTIA)
    with pytest.raises(InputError, match="friction would drive the motion"):
        refused(t, np.sin(rate * t), -force, inertia=INERTIA)


@pytest.mark.parametrize("friction", [1.0, 0.0])
def test_sound_forces_are_not_refused(friction):
    t, x, v, a = moved(3)
    noise = 0.02 * np.random.default_rng(4).normal(size=len(t))
    force = INERTIA * a + friction * (LEVEL * np.sign(v) + VISCOUS * v) + noise
    refused(t, x, force)


def one_way(sign=1.0):
    """Return times, positions and forces of an axis that moves forward; a sign may change."""
    rng, t = np.random.default_rng(0), np.arange(0.0, 20.0, 0.01)
    v = 1.0 + 0.5 * np.sin(1.3 * t) * np.cos(0.37 * t)
    force = 0.1 * np.gradient(v, t) + LEVEL + VISCOUS * v + 0.01 * rng.normal(size=len(t))
    return t, 0.01 * np.cumsum(v) + 1e-5 * rng.normal(size=len(t)), force * sign


@pytest.mark.parametrize("inertia", [None, 0.1])
def test_a_wrong_sign_is_refused_of_a_motion_in_one_direction(inertia):
    t, x, force = one_way()
    refused(t, x, force, inertia=inertia)
    with pytest.raises(InputError, match="friction would drive the motion"):
        refused(t, x, -force, inertia=inertia)
    with pytest.raises(InputError, match=r"sign of the force changes at about t = (9\.\d|10)"):
        refused(t, x, np.where(t > 10.0, -force, force), inertia=inertia)


@pytest.mark.parametrize("inertia", [None, 1.2])
def test_a_block_that_is_pulled_one_way_with_friction_that_falls_is_not_refused(inertia):
    rng, rate = np.random.default_rng(6), 50.0
    t = np.arange(0.0, 40.0, 1.0 / rate)
    v = np.select([t % 10 < 3, t % 10 < 6], [0.01 + 0.0 * t, 0.01 + 0.02 * (t // 10)], 0.0)
    x = np.cumsum(v) / rate
    force = np.where(v > 0.0, 3.0 + np.exp(-v / 0.02), 3.2)  # the spring stays stretched at rest
    noisy = force + 0.03 * rng.normal(size=len(t))
    refused(t, x + 2e-5 * rng.normal(size=len(t)), noisy, inertia=inertia)


def pulled(slope, stiffness, gain, *, seconds=10.0, turns=False):
    """Return times, positions and forces of stick-slip in a soft loop that follows a ramp."""
    rng, h = np.random.default_rng(350), 5e-4
    x = v = added = 0.0
    result = []
    for k in range(int(seconds / h)):
        t = k * h
        goal = slope * (t if not turns else 2.5 - abs(t % 5.0 - 2.5))
        added += gain * (goal - x) * h
        force = stiffness * (goal - x) + added
        level = 4.0 + 4.4 * math.exp(-min((v / 0.005) ** 2, 50.0))
        moves = v != 0.0 or abs(force) > level
        side = math.copysign(1.0, v if v else force)
        after = v + h * (force - side * level) / 1.5 if moves else 0.0
        v = 0.0 if after * side <= 0.0 else after
        x += h * v
        if k % 10 == 0:
            result.append((t, x, force))
    t, x, force = np.array(result).T
    return t, x, force + 0.05 * rng.normal(size=len(t))


def test_stick_slip_in_a_soft_loop_is_not_refused_and_is_where_its_sign_changes():
    few = pulled(0.0058, 111.0, 33.0, seconds=11.0)  # 97 % of it rests
    refused(*few)
    refused(*few, inertia=1.5)
    t, x, force = pulled(0.2, 80.0, 0.0, turns=True)
    refused(t, x, force)
    with pytest.raises(InputError, match=r"sign of the force changes at about t = (4|5)\.\d"):
        refused(t, x, np.where(t > 5.0, -force, force))


def test_a_cogging_force_that_moves_the_body_has_its_wave_number():
    rng, w = np.random.default_rng(2), 2.0 * np.pi / 0.032
    t = np.arange(0.0, 8.0, 1.0 / RATE)
    way = 0.25 * np.cumsum(np.where(t % 2.0 < 1.0, 1.0, -1.0)) / RATE
    kernel = np.hanning(102) / np.hanning(102).sum()
    q = np.convolve(np.pad(way, 51, mode="edge"), kernel, mode="same")[51:-51]
    cogging = 6.0 * np.sin(w * q)
    q = q + 0.3 * cogging / (8.0 * (2.0 * np.pi * 8.0) ** 2)  # a controller gives way to it
    v = np.gradient(q) * RATE
    force = 8.0 * np.gradient(v) * RATE + cogging + 9.0 * np.sign(v) + 14.0 * v
    force = force + 0.3 * rng.normal(size=len(t))
    records = [Record(time=t, position=q, force=force)]
    model = RecordModel(records, families=[("level",), ("level", "viscous")])
    (found,) = model.balance.waves[0]
    assert found == pytest.approx(w, rel=2e-3)


@pytest.mark.parametrize(("rows", "noise"), [(24, 1e-4), (400, math.pi / 40.5 / 4.0)])
def test_few_rows_and_a_single_wave_number_choose_no_wave(rows, noise):
    random = np.random.default_rng(5)
    some = SimpleNamespace(
        far=np.full(rows, 1e3), position=random.uniform(0.0, 1.0, rows),
        velocity=random.normal(size=rows), response=random.normal(size=rows),
    )  # fmt: skip
    beside = random.normal(size=(rows, 20))
    assert force_wave(some, 1.0, noise, beside) == ()


def test_steps_of_an_encoder_that_a_file_rounds_are_its_noise():
    step = 4.84e-5  # 48 or 49 um with six decimals
    t, x, _, _ = moved(2)
    x = np.concatenate([np.zeros(5 * len(t)), x - x[0]])  # in most twentieths it rests
    read = np.round(np.round(x / step) * step, 6)
    assert noise_of(read) == pytest.approx(step / np.sqrt(12.0), rel=0.01)


def test_a_known_constant_force_is_no_friction():
    t, x, force = driven(8, extra=lambda t, x, v: 0.4)
    measured = Measurement(time=t, position=x, force=force, turning=True)
    rig = Axis(inertia=INERTIA, offset=0.4)
    found = select(rig, None, measured, vary=["friction.*", "mechanism.inertia"], route="balance")
    forward, backward = found.band([-1.0, 1.0]).median[::-1]
    assert forward == pytest.approx(LEVEL + VISCOUS, rel=0.01)
    assert backward == pytest.approx(-LEVEL - VISCOUS, rel=0.01)


@pytest.mark.slow
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
    band = found.band([2.0], [1.5])
    true = LEVEL + 0.75 + 2.0 * VISCOUS
    assert abs(band.median[0] - true) < 0.01 * true
    assert band.high[0] - band.low[0] < 0.1 * true


@pytest.mark.slow
def test_a_force_that_acts_late_is_a_delay_and_no_inertia():
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
    (late,) = (one for one in found.findings if one.term == "delay")
    assert late.asserted
    assert late.size == pytest.approx(0.004, rel=0.1)
    (inertia,) = [
        parameter for parameter in found.parameters if parameter.path == "mechanism.inertia"
    ]
    assert inertia.low_any < INERTIA < inertia.high_any


def test_a_body_that_travels_far_in_short_slips_does_not_rest():
    # a slip of 2 frames in 13, as a camera sees a body that a weight kicks
    rng, frame = np.random.default_rng(3), np.arange(780)
    x = 1e-3 * (frame // 13 + np.clip(frame % 13 - 10, 0, 2) / 2.0)
    film = Record(
        time=frame / 120.0, position=x + 5e-5 * rng.normal(size=len(x)), force=1.0 + 0 * x
    )
    (piece,), _ = pieces_of([film])
    assert np.any(piece.usable(piece.cutoff))
    with pytest.raises(InputError, match=RESTS[:24]):
        pieces_of([Record(time=film.time, position=film.position - x, force=film.force)])


def test_velocities_that_are_later_than_positions_are_not_taken() -> None:
    rng, t = np.random.default_rng(4), np.arange(0.0, 20.0, 0.01)
    x = np.sin(2.0 * t) + 0.3 * np.sin(5.0 * t) + 1e-4 * rng.normal(size=len(t))
    v = 2.0 * np.cos(2.0 * t) + 1.5 * np.cos(5.0 * t) + 1e-4 * rng.normal(size=len(t))
    force = 3.0 * np.gradient(v, t) + np.sign(v)
    late = lfilter([0.3], [1.0, -0.7], v)
    kept = [
        by_best_sensor([Record(time=t, position=x, force=force, velocity=y)])[0].velocity
        for y in (v, late)
    ]
    assert kept[0] is not None
    assert kept[1] is None


@pytest.mark.parametrize(
    "wrong",
    [
        lambda x: 5e-3 * np.round(x / 5e-3),
        lambda x: 5e-4 * np.round(x / 5e-4),
        lambda x: x + 1e-5 * np.sin(2.0 * np.pi * x / 0.01),
        lambda x: 1e3 * x,
    ],
    ids=["coarse", "quantised", "periodic", "unit"],
)
def test_velocities_are_kept_where_positions_are_wrong(wrong: Callable[[Array], Array]) -> None:
    rng, t = np.random.default_rng(0), np.arange(0.0, 8.0, 0.001)
    x, v = 0.1 * np.sin(np.pi * t), 0.1 * np.pi * np.cos(np.pi * t)
    force = -2.0 * np.pi**2 * x + np.sign(v) + 0.5 * v + 0.01 * rng.normal(size=len(t))
    read = v + 1e-5 * rng.normal(size=len(t))
    record = Record(time=t, position=wrong(x), force=force, velocity=read)
    assert by_best_sensor([record])[0].velocity is not None


def test_the_start_of_a_motion_in_one_direction_is_used_from_two_lengths_of_the_filter():
    rng, t = np.random.default_rng(4), np.arange(0.0, 4.0, 0.003)
    v = 30.0 * (1.0 - np.exp(-t / 0.15))
    x = np.round(30.0 * (t + 0.15 * np.exp(-t / 0.15)), 4)
    force = 8e-4 * (30.0 - v) / 0.15 + 0.05 + 0.0052 * v + 0.02 * rng.normal(size=len(t))
    (piece,), _ = pieces_of([Record(time=t, position=x, force=force, inertia=8e-4)])
    first = t[np.argmax(piece.usable(piece.cutoff))]
    assert first <= 2.0 / piece.cutoff + 2.0 * piece.step
    assert first < 0.02 * t[-1]
