"""Records cut into the segments that are simulated."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Capsule, Measurement, TowedBlock
from stickslip.errors import InputError
from stickslip.identify.fits.shooting.segments import (
    measured_quantity,
    segments_of,
    with_drive,
)
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Sine

AXIS = Axis(inertia=2.0)
T = np.arange(0.0, 5.0, 1e-3)
SMOOTH = Measurement(time=T, position=np.sin(T), force=3.0 * np.cos(2.0 * T))


def test_segments_cover_a_record_and_end_where_the_next_begins():
    segments = segments_of(AXIS, SMOOTH, length=1.0)
    assert len(segments) == 5
    np.testing.assert_allclose([s.start for s in segments], np.arange(5.0), atol=1e-9)
    assert all(len(s.times) == 101 for s in segments[:-1])
    np.testing.assert_allclose(segments[0].measured, np.sin(segments[0].times), atol=1e-12)


def test_a_remainder_shorter_than_half_a_segment_is_left_out():
    kept = T < 3.4
    cut = Measurement(time=T[kept], position=SMOOTH.position[kept], force=SMOOTH.force[kept])
    assert len(segments_of(AXIS, cut, length=1.0)) == 3


def test_no_segment_crosses_a_gap():
    kept = (T < 1.3) | (T > 2.1)
    cut = Measurement(time=T[kept], position=SMOOTH.position[kept])
    spans = [(s.start, s.start + s.times[-1]) for s in segments_of(AXIS, cut, length=0.5)]
    assert spans
    assert all(end < 1.3 or start > 2.1 for start, end in spans)


def test_a_smooth_drive_is_averaged_between_the_rows_that_are_compared():
    segment = segments_of(AXIS, SMOOTH, length=1.0)[1]
    drive = segment.mechanism.drive
    assert len(drive.times) == 101  # a hundred lines, and the last value held
    assert lines(drive, 0) == pytest.approx(moments(SMOOTH.force[1000:1010]), rel=1e-9)


def moments(samples):
    """Return impulse and moment about the start of force samples that are held for 1 ms each."""
    middles = 1e-3 * (np.arange(len(samples)) + 0.5)
    return 1e-3 * samples.sum(), 1e-3 * (samples * middles).sum()


def lines(drive, k):
    """Return the same of a straight piece."""
    length = drive.times[k + 1] - drive.times[k]
    value, slope = drive.values[k], drive.slopes[k]
    return (value * length + slope * length**2 / 2, value * length**2 / 2 + slope * length**3 / 3)


def test_a_jump_of_the_drive_has_its_impulse_and_its_moment():
    force = np.where(T < 0.503, 1.0, -1.0)
    segment = segments_of(AXIS, replace(SMOOTH, force=force), length=1.0)[0]
    drive = segment.mechanism.drive
    assert lines(drive, 50) == pytest.approx(moments(force[500:510]), rel=1e-9)
    assert lines(drive, 49) == pytest.approx(moments(force[490:500]), rel=1e-9)


def test_joined_samples_are_met_by_their_lines():
    force = 3.0 * T  # a ramp is a ramp, not a staircase half a sample late
    segment = segments_of(AXIS, replace(SMOOTH, force=force), length=1.0, hold="first")[0]
    np.testing.assert_allclose(segment.mechanism.drive.slopes[:-1], 3.0, rtol=1e-6)


def test_the_first_state_is_guessed_from_a_parabola():
    x = 0.3 + 0.2 * T - 0.7 * T**2
    segment = segments_of(AXIS, replace(SMOOTH, position=x), length=1.0)[2]
    # a parabola is met exactly, up to rounding of differences over 20 ms
    np.testing.assert_allclose(segment.guess, [0.3 + 0.4 - 2.8, 0.2 - 2.8], rtol=1e-9)
    v = Measurement(time=T, velocity=0.2 - 1.4 * T)
    np.testing.assert_allclose(segments_of(AXIS, v, length=1.0)[2].guess, [0.0, -2.6], atol=1e-9)


def test_the_position_is_compared_if_there_is_one_or_else_the_velocity():
    assert measured_quantity(SMOOTH) == "position"
    assert measured_quantity(Measurement(time=T, velocity=np.cos(T))) == "velocity"


@pytest.mark.parametrize(
    ("record", "message"),
    [
        (Measurement(velocity=T, friction=T), "has no time"),
        (Measurement(time=T, friction=T), "position or velocity, and the records have only"),
    ],
)
def test_a_record_that_no_run_can_be_compared_with_is_refused(record, message):
    with pytest.raises(InputError, match=message):
        segments_of(AXIS, record, length=1.0)


def test_a_record_of_too_few_samples_is_refused():
    few = Measurement(time=T[:5], position=T[:5])
    with pytest.raises(InputError, match="no segment of 1 s has 8 samples"):
        segments_of(AXIS, few, length=1.0)


def test_a_mechanism_without_a_drive_takes_no_measured_force():
    with pytest.raises(InputError, match="TowedBlock has no drive"):
        with_drive(TowedBlock(mass=1.0, stiffness=1.0, speed=1.0), SMOOTH)


def test_trials_keep_their_own_parameters():
    record = Measurement(
        trials=(
            replace(SMOOTH, name="light"),
            replace(SMOOTH, name="heavy", overrides={"mechanism.inertia": 5.0}),
        )
    )
    segments = segments_of(AXIS, record, length=1.0)
    assert {s.record: s.mechanism.inertia for s in segments} == {0: 2.0, 1: 5.0}


def test_a_force_of_zero_is_no_drive_and_takes_the_mechanism_s_own_off():
    driven = replace(AXIS, drive=Sine(amplitude=3.0, frequency=1.0))
    none = replace(SMOOTH, force=np.zeros_like(T))
    assert all(s.mechanism.drive is None for s in segments_of(driven, none, length=1.0))
    assert segments_of(driven, SMOOTH, length=1.0)[0].mechanism.drive not in (None, driven.drive)


def test_a_record_of_few_samples_has_longer_segments():
    time = np.arange(0.0, 60.0)
    segments = segments_of(AXIS, Measurement(time=time, velocity=5.0 - 0.05 * time))
    assert [float(s.times[-1]) for s in segments] == [20.0, 20.0, 19.0]


def test_what_drives_itself_is_one_segment_with_as_many_rows_for_each_second():
    capsule = Capsule(
        capsule_mass=0.8, inner_mass=0.2, drive=Torque(drive=Sine(amplitude=2.0, frequency=4.0))
    )
    (segment,) = segments_of(capsule, Measurement(time=T, position=np.sin(T)))
    assert segment.times[-1] == pytest.approx(T[-1], abs=0.01)
    assert 500 <= len(segment.times) <= 600
    with pytest.raises(InputError, match=r"begins at −1 s, but the drive of Capsule begins at 0 s"):
        segments_of(capsule, Measurement(time=T - 1.0, position=np.sin(T)))
