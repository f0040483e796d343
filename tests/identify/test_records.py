"""Records of one coordinate as a problem of the judge: truths in closed form, and invariances."""

import functools

import numpy as np
import pytest

from stickslip import Axis, Measurement, Pendulum, select
from stickslip.errors import InputError
from stickslip.identify.fits import play
from stickslip.identify.forces import forces_along
from stickslip.identify.judgement import Judgement
from stickslip.identify.problems.record_signals import (
    Filter,
    Record,
    bristle,
    noise_of,
    records_of,
    step_of,
)
from stickslip.identify.problems.records import RecordProblem

LEVEL, VISCOUS, INERTIA = 1.0, 0.3, 0.02


def axis(seed=0, *, seconds=8.0, scale=1.0, mirrored=False, later=0.0, spring=0.0, memory=0.0):
    """Return a record of an axis whose motion is known in closed form: a sum of sines."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, seconds, 0.002)
    x, v, a = np.zeros((3, len(t)))
    for f in (0.31, 0.73, 1.1):
        w, phase, size = 2.0 * np.pi * f, random.uniform(0.0, 6.0), random.uniform(0.2, 0.5)
        x += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w**2 * np.sin(w * t + phase)
    z = bristle(x, memory, 1.0) if memory else np.sign(v)
    force = INERTIA * a + LEVEL * z + VISCOUS * v + spring * x
    force = force + 0.02 * random.normal(size=len(t))
    x = x + 3e-5 * random.normal(size=len(t))
    side = -1.0 if mirrored else 1.0
    return Record(time=t + later, position=side * scale * x, force=side * force / scale)


@functools.cache
def judged(**options) -> Judgement:
    return Judgement(RecordProblem([axis(**options)]))


def values(judgement):
    """Return what is stated of the law and of the inertia, by the ends of the paths."""
    found = {path: float(x[0]) for path, x in judgement.composition.paths().items()}
    return {path.rpartition(".")[2]: x for path, x in found.items()}


def test_inertia_level_and_viscosity_are_those_of_the_axis():
    judgement = judged()
    assert judgement.family == ("level", "viscous")
    found = values(judgement)
    # noise of .02 N over 4000 samples; the filter leaves some 800 independent rows
    assert found["inertia"] == pytest.approx(INERTIA, rel=0.02)
    assert found["kinetic_coefficient"] == pytest.approx(LEVEL, rel=0.01)
    assert found["viscous_coefficient"] == pytest.approx(VISCOUS, rel=0.02)


def test_the_band_holds_the_steady_curve():
    judgement = judged()
    rows = judgement.problem.asked()
    band = judgement.band(rows, all_along=True)
    true = LEVEL * np.sign(rows.velocity) + VISCOUS * rows.velocity
    assert np.all((band.low <= true) & (true <= band.high))
    assert np.median(band.high - band.low) < 0.2 * LEVEL


def test_the_band_holds_readings_of_a_second_record():
    judgement = judged()
    other = judgement.problem.like([axis(seed=1)])
    for level in (0.95, 0.8, 0.5):  # and room for what another run differs by, as it does not here
        band = judgement.reading_band(other, level)
        inside = np.mean((band.low <= other.response) & (other.response <= band.high))
        assert inside > level - 0.05


@pytest.mark.slow
def test_a_memory_is_named_with_its_length():
    judgement = judged(memory=0.02)
    assert judgement.problem.memory == "dahl"
    found = values(judgement)
    assert found["kinetic_coefficient"] / found["bristle_stiffness"] == pytest.approx(0.02, rel=0.1)


def test_a_mirrored_record_has_the_same_law():
    one, other = judged(), judged(mirrored=True)
    assert one.family == other.family
    for name, x in values(one).items():
        assert values(other)[name] == pytest.approx(x, rel=2e-3)


def test_the_time_of_the_first_sample_changes_nothing():
    one, other = judged(), judged(later=1e4)
    assert one.family == other.family
    for name, x in values(one).items():
        assert values(other)[name] == pytest.approx(x, rel=1e-3)


def test_other_units_scale_the_coefficients():
    # lengths in millimetres keep power: forces are thousandths, and so the inertia is a millionth
    one, other = judged(), judged(scale=1e3)
    assert one.family == other.family
    scales = {"inertia": 1e-6, "kinetic_coefficient": 1e-3, "viscous_coefficient": 1e-6}
    for name, x in values(one).items():
        assert values(other)[name] == pytest.approx(x * scales[name], rel=1e-3)


def test_slow_sampling_of_a_coast_down_finds_level_and_drag():
    t = np.arange(0.0, 330.0)
    mass, level, drag = 76.0, 1.2, 0.03
    # m v' = -F - c v^2 has the solution v = sqrt(F / c) tan(phi - sqrt(F c) t / m)
    ratio = np.sqrt(level / drag)
    v = ratio * np.tan(np.arctan(8.0 / ratio) - np.sqrt(level * drag) * t / mass)
    v = v + 0.02 * np.random.default_rng(4).normal(size=len(t))
    found = select(Axis(inertia=mass), None, Measurement(time=t, velocity=v))
    assert found.family == ("drag", "level")
    for one, true in zip(found.parameters, (level, drag), strict=True):
        assert one.low_any <= true <= one.high_any
        assert one.value == pytest.approx(true, rel=0.1)


def test_weight_of_a_pendulum_is_no_friction():
    arm = Pendulum(mass=0.2, length=0.5)
    t = np.arange(0.0, 4.0, 0.01)
    still = Measurement(time=t, position=0.5 + 0.3 * np.sin(t), force=0.0 * t + 1.0)
    (record,) = records_of(arm, still)
    np.testing.assert_allclose(record.mechanism, -0.2 * 9.81 * 0.5 * np.sin(record.position))
    assert record.inertia == pytest.approx(0.2 * 0.5**2)


def sines(seed: int, *, inertia: float = INERTIA):
    """Return times, positions and forces of a plain axis."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, 8.0, 0.002)
    x, v, a = np.zeros((3, len(t)))
    for f in (0.31, 0.73, 1.1):
        w, phase, size = 2.0 * np.pi * f, random.uniform(0.0, 6.0), random.uniform(0.2, 0.5)
        x += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w**2 * np.sin(w * t + phase)
    force = inertia * a + LEVEL * np.sign(v) + VISCOUS * v
    return t, x + 3e-5 * random.normal(size=len(t)), force


def noisy(force, seed=5):
    return force + 0.02 * np.random.default_rng(seed).normal(size=len(force))


def test_gain_of_the_force_scale_of_the_position_and_inertia_are_one_group():
    t, x, force = sines(2)
    record = Record(time=t, position=x, force=noisy(1.3 * force), inertia=INERTIA)
    (wrong,) = Judgement(RecordProblem([record])).findings
    assert wrong.term == "inertia_given"
    assert 1.0 + wrong.size == pytest.approx(1.3, rel=0.02)
    assert "or the gain of the force or a unit of length is wrong" in wrong.sentence


def test_a_gear_takes_a_share_of_what_it_transmits():
    t, x, _ = sines(4)
    v, torque = np.gradient(x, t), 20.0 * np.sin(1.7 * t)
    friction = 0.12 * np.abs(torque) * np.sign(v) + 0.8 * v
    record = Record(
        time=t, position=x, force=noisy(friction), friction=True, transmitted=torque,
        inputs={"transmitted": np.abs(torque)},
    )  # fmt: skip
    found = values(Judgement(RecordProblem([record])))
    assert found["transmitted_coefficient"] == pytest.approx(0.12, rel=0.05)


def test_forces_beside_a_large_inertia_are_no_rounding():
    record = Measurement(time=[0.0, 1.0], position=[0.0, 0.5], force=[0.0, 2.0])
    x, v = np.array([0.0, 0.5]), np.array([0.5, 0.5])
    heavy = Axis(inertia=1e7, stiffness=4.0, damping=1.0)
    found = forces_along(heavy, record, x, v, ["mechanism.damping"])
    np.testing.assert_allclose(found.still, -4.0 * x)


def test_the_filter_passes_slow_waves_and_their_slopes():
    h, n = 0.001, 6000
    low = Filter(count=n, step=h, band=20.0, every=8)
    t = h * np.arange(n)
    middle = slice(100, -100)
    rows = t[:: low.every]
    np.testing.assert_allclose(low(np.sin(6.0 * t))[middle], np.sin(6.0 * rows)[middle], atol=1e-6)
    np.testing.assert_allclose(
        low(np.sin(6.0 * t), slope=2)[middle], -36.0 * np.sin(6.0 * rows)[middle], atol=1e-3
    )
    late = low(np.sin(6.0 * t), late=0.003)[middle]
    np.testing.assert_allclose(late, np.sin(6.0 * (rows - 0.003))[middle], atol=1e-6)
    assert np.abs(low(np.sin(600.0 * t))[middle]).max() < 1e-4


def test_a_bristle_of_each_exponent_follows_its_equation():
    path = np.concatenate([np.linspace(0.0, 1.0, 4001), np.linspace(1.0, 0.5, 2001)])
    for exponent in (0.0, 1.0, 2.0):
        z, length = 0.0, 0.3
        for step in np.diff(path):  # du/d|x| = -u^n / r by small steps
            side = np.sign(step)
            left = 1.0 - side * z
            z += step / length * left**exponent if left > 0.0 else 0.0
        assert bristle(path, length, exponent)[-1] == pytest.approx(z, abs=2e-3)


def test_play_follows_at_its_reach():
    x = np.concatenate([np.linspace(0.0, 1.0, 101), np.full(100, 1.0)])
    np.testing.assert_allclose(play(x, 0.05)[100], 0.95)


def test_noise_is_that_of_the_quiet_parts_or_the_step_of_the_encoder():
    random = np.random.default_rng(0)
    x = np.sin(0.002 * np.arange(5000.0))
    assert noise_of(x + 1e-4 * random.normal(size=5000)) == pytest.approx(1e-4, rel=0.2)
    assert noise_of(np.round(x, 2)) == pytest.approx(0.01 / np.sqrt(12.0), rel=0.01)


@pytest.mark.parametrize(
    "speeds",
    [
        np.repeat([-0.1, 0.1], 40),
        np.repeat([0.0, 0.1, 0.0, -0.1], 40),
        np.repeat([0.1, 0.2, 0.3, 0.2, 0.1, -0.1, -0.2], 40),
        np.array([-0.1, 0.1, -0.3, 0.3]),
    ],
)
def test_speeds_that_were_set_have_no_step_of_an_encoder_and_its_counts_have(speeds):
    assert step_of(np.resize(speeds, 2000), speed=True) == 0.0
    place = np.round(0.5 * np.sin(0.03 * np.arange(2000.0)) / 0.004) * 0.004
    assert step_of(np.diff(place), speed=True) == pytest.approx(0.004)


@pytest.mark.parametrize(
    ("measurement", "find", "said"),
    [
        (Measurement(time=np.arange(100.0), force=np.ones(100)), False, "position"),
        (Measurement(velocity=np.ones(50), friction=np.ones(50)), False, "in time"),
        (
            Measurement(time=np.arange(20.0), position=np.arange(20.0), force=np.ones(20)),
            False,
            "at least 60 samples",
        ),
        (Measurement(time=np.arange(100.0), position=np.arange(100.0)), True, "inertia"),
        (
            Measurement(
                time=np.arange(100.0), position=np.arange(100.0), friction=np.ones(100), load=0.0
            ),
            False,
            "above 0 N, got 0",
        ),
    ],
)
def test_bad_records_are_refused_with_their_cure(measurement, find, said):
    with pytest.raises(InputError, match=said):
        records_of(Axis(inertia=1.0), measurement, unknown=["mechanism.inertia"] * find)
