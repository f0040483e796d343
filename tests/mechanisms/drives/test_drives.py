"""Values, pieces and sums of drives."""

import cmath
import itertools
import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.support import broken_lines, pulses, squares

from stickslip.errors import ParameterError
from stickslip.mechanisms.drives import (
    PiecewiseLinear,
    Pulse,
    Ramp,
    Sampled,
    Sine,
    Square,
    Sum,
    ThreePhase,
)

sines = st.builds(Sine, amplitude=st.floats(-9, 9), frequency=st.floats(0.1, 9))
ramps = st.builds(Ramp, rate=st.floats(-9, 9), start=st.floats(-1, 1))
samples = st.builds(
    lambda values, hold: Sampled(times=range(len(values)), values=values, hold=hold),
    st.lists(st.floats(-9, 9), min_size=1, max_size=5),
    st.sampled_from(["zero", "first"]),
)
single = st.one_of(pulses, broken_lines, squares, sines, ramps, samples)
times = st.floats(-2, 6)


@given(t=times)
def test_a_sine_is_a_sine(t):
    drive = Sine(amplitude=3.0, frequency=0.7, phase=0.2)
    assert drive.value(t) == 3.0 * math.sin(2.0 * math.pi * 0.7 * t + 0.2)


@given(t=times)
def test_a_piecewise_linear_drive_joins_its_points(t):
    drive = PiecewiseLinear(times=(0.0, 1.0, 3.0), values=(1.0, 3.0, -1.0))
    if t <= 0:
        expected = 1.0
    elif t <= 1:
        expected = 1.0 + 2.0 * t
    else:
        expected = 3.0 - 2.0 * (min(t, 3.0) - 1.0)
    assert math.isclose(drive.value(t), expected, rel_tol=1e-15, abs_tol=1e-15)  # a rounding


@given(t=times)
def test_samples_can_be_joined_by_lines(t):
    points = {"times": (0.0, 0.1, 0.2), "values": (1.0, 3.0, 2.0)}
    assert Sampled(**points, hold="first").value(t) == PiecewiseLinear(**points).value(t)


@given(drive=single | st.builds(lambda a, b: a + b, single, single))
def test_pieces_come_in_the_order_of_time(drive):
    starts = [piece.start for piece in drive.pieces(2.0)]
    assert starts == sorted(starts)


@given(period=st.floats(0.05, 0.5), start=st.floats(-1.0, 1.0))
def test_a_square_wave_that_is_always_high_is_never_low(period, start):
    wave = Square(high=2.0, low=-1.0, period=period, duty=1.0, start=start)
    for k in range(60):  # between its edges, which lie within a rounding error of each other
        assert wave.value(start + (0.1 + 0.37 * k) * period) == 2.0 or (0.1 + 0.37 * k) % 1.0 < 1e-9
    pieces = wave.pieces(3.0)
    widths = np.diff([piece.start for piece in pieces])
    assert (widths >= 0.0).all()
    # what is low has no width but the roundings of its ends
    assert widths[1::2].max(initial=0.0) < 1e-12


@given(first=single, second=single, third=single, t=times)
def test_the_value_of_a_sum_is_the_sum_of_the_values(first, second, third, t):
    parts = [drive.value(t) for drive in (first, second, third)]
    # slopes of up to 100 per second are carried from other starting points: a few roundings
    tolerance = 1e-12
    assert math.isclose((first + second).value(t), sum(parts[:2]), abs_tol=tolerance)
    assert math.isclose((first + second + third).value(t), sum(parts), abs_tol=tolerance)
    assert math.isclose((first + (second + third)).value(t), sum(parts), abs_tol=tolerance)


@given(drive=sines | st.builds(lambda a, b: a + b, sines, sines), t=times)
def test_a_smooth_part_stays_within_its_bound(drive, t):
    low, high = drive.smooth_bound()
    assert low - 1e-12 <= drive.smooth(t) <= high + 1e-12  # a rounding of numbers up to 18


def test_a_sum_takes_the_shortest_time_scale_of_its_parts():
    total = Sine(amplitude=1.0, frequency=2.0) + Sine(amplitude=1.0, frequency=5.0)
    assert total.time_scale() == 0.2
    assert (total + Pulse(level=1.0, duration=1.0)).time_scale() == 0.2
    assert Pulse(level=1.0, duration=1.0).time_scale() == math.inf


@given(drive=squares, t=times)
def test_a_square_wave_is_high_for_its_duty_of_each_cycle(drive, t):
    share = math.modf((t - drive.start) / drive.period)[0]
    assume(min(abs(share), abs(share - drive.duty), abs(share - 1.0)) > 1e-9)  # off the jumps
    expected = drive.high if share < drive.duty else drive.low
    assert drive.value(t) == (0.0 if t < drive.start else expected)


@given(drive=squares, order=st.integers(1, 6))
def test_the_pieces_of_a_square_wave_have_its_mean_and_its_fourier_coefficients(drive, order):
    pieces = drive.pieces(2.0)
    turn = 2.0 * math.pi * order / drive.period
    integral = coefficient = 0.0
    for piece, after in itertools.pairwise(pieces[:3]):
        a, b = piece.start - drive.start, after.start - drive.start
        integral += piece.value * (b - a)
        coefficient += piece.value * (cmath.exp(-1j * turn * b) - cmath.exp(-1j * turn * a))
    coefficient *= 1j / turn / drive.period
    # of a wave between two levels: (high - low) sin(pi n D) / (pi n), turned by half the duty
    known = (drive.high - drive.low) * math.sin(math.pi * order * drive.duty) / (math.pi * order)
    turned = known * cmath.exp(-1j * math.pi * order * drive.duty)
    assert integral / drive.period == pytest.approx(drive.mean, abs=1e-12)
    assert abs(coefficient - turned) < 1e-12
    later = [(p.start - q.start, p.value) for p, q in zip(pieces[2:], pieces, strict=False)]
    assert all(gap == pytest.approx(drive.period, rel=1e-12) for gap, _ in later)


def test_drives_say_how_long_a_cycle_is_or_that_they_have_none():
    assert Square(high=1.0, period=0.3).repeats() == 0.3
    assert Sine(amplitude=1.0, frequency=4.0).repeats() == 0.25
    assert ThreePhase(amplitude=0.5, fast=9.0, slow=3.0).repeats() == pytest.approx(
        2.0 * math.sqrt(2.0 * (1.0 / 9.0 + 1.0 / 3.0))
    )
    assert Pulse(level=1.0, duration=1.0).repeats() is None


def test_the_pieces_of_a_sum_of_long_signals_are_found_by_bisection():
    count = 20_000  # by a search from the beginning these would be 4e8 comparisons
    signal = Sampled(times=range(count), values=[t % 7 for t in range(count)])
    shifted = Sampled(times=[t + 0.5 for t in range(count)], values=[t % 5 for t in range(count)])
    pieces = (signal + shifted).pieces()
    assert len(pieces) == 2 * count - 1
    assert pieces[-1].value == (count - 1) % 7 + (count - 1) % 5


PULSE = Pulse(level=3.0, duration=0.5, start=0.5)
HELD = Sampled(times=(0.0, 0.1, 0.2), values=(1.0, 3.0, 2.0))


@pytest.mark.parametrize(
    ("drive", "times", "values"),
    [
        # a pulse holds its level from its start until just before its end
        (PULSE, (-0.1, 0.4999, 0.5, 0.999, 1.0), (0, 0, 3, 3, 0)),
        (Ramp(rate=2.0, start=1.0), (0.9, 1.0, 3.0), (0.0, 0.0, 4.0)),
        # samples are held until the next
        (HELD, (-1.0, 0.0, 0.0999, 0.1, 0.2, 9.0), (1.0, 1.0, 1.0, 3.0, 2.0, 2.0)),
    ],
)
def test_a_drive_has_its_values(drive, times, values):
    assert tuple(map(drive.value, times)) == values


ONE = {"level": 1.0, "duration": 1.0}
POINTS = [
    *((bad, {"times": (0.0, 1.0), "values": (1.0, bad)}) for bad in ("a", None, True)),
    ("0", {"times": 0.0, "values": 1.0}),
    ("same length of at least 1, got 0 and 0", {"times": (), "values": ()}),
    ("same length of at least 1, got 2 and 1", {"times": (0.0, 1.0), "values": (1.0,)}),
    ("must increase, got 0 before 0", {"times": (0.0, 0.0), "values": (1.0, 2.0)}),
    ("must increase, got 1 before 0.5", {"times": (1.0, 0.5), "values": (1.0, 2.0)}),
    ("finite", {"times": (0.0, math.nan), "values": (1.0, 2.0)}),
    ("finite", {"times": (0.0, 1.0), "values": (1.0, math.inf)}),
]


@pytest.mark.parametrize(
    ("kind", "values", "words"),
    [
        *(
            (kind, points, str(bad))
            for kind in (PiecewiseLinear, Sampled)
            for bad, points in POINTS
        ),
        (Sampled, {"times": (0.0,), "values": (1.0,), "hold": "second"},
         "'zero' or 'first', got 'second'"),
        (Pulse, {**ONE, "duration": -1.0}, r"Pulse\.duration \(T\) must be at least 0 s"),
        (Sine, {"amplitude": 1.0, "frequency": 0.0}, r"Sine\.frequency \(f\) must be above 0 Hz"),
        (Ramp, {"rate": math.inf}, r"Ramp\.rate \(r\) must be a finite number in N/s, got inf"),
        (Sum, {"parts": ()}, "at least one drive"),
        (lambda **wave: Square(high=1.0, **wave).pieces(5.0), {"period": 1e-6},
         r"Square: a run to t_end = 5 s .* cycles of 1 × 10⁻⁶ s"),
    ],
)  # fmt: skip
def test_what_is_no_drive_is_refused_in_words(kind, values, words):
    with pytest.raises(ParameterError, match=words) as caught:
        kind(**values)
    assert kind not in (PiecewiseLinear, Sampled) or kind.__name__ in str(caught.value)


def test_only_drives_can_be_added():
    with pytest.raises(TypeError):
        Pulse(**ONE) + 2.0
