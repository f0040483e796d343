"""Three phases by their times or with a last phase of its own; a motion that was recorded."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from stickslip import Coulomb, Measurement, PendulumCart, fit, load_rig, simulate
from stickslip.errors import InputError, ParameterError
from stickslip.identify.fits import RecordSettings
from stickslip.mechanisms import Prescribed, cycle_or_none
from stickslip.mechanisms.drives import SampledSwing, SineSwing, ThreePhase, TimedThreePhase
from stickslip.quantities import vary

LAW = Coulomb(kinetic_coefficient=0.2)
durations = st.floats(0.01, 2.0)
sizes = st.floats(0.5, 500.0)


def cart(profile):
    return PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=profile)
    )


def travel(profile, t_end):
    run = simulate(cart(profile), LAW, t_end=t_end)
    return float(run["x"][-1] - run["x"][0])


def check_there_and_back(swing):
    """Closed form: at rest at minus the amplitude at both ends, and at the amplitude between."""
    first, middle, _ = swing.accelerations
    rise = swing.cycle()[1].start
    turn = rise + first * rise / middle
    tolerance = 1e-10 * swing.amplitude  # rounding of a few sums
    for t, place in ((0.0, -1.0), (turn, 1.0), (swing.period * (1.0 - 1e-15), -1.0)):
        position, rate = swing.at(t)
        assert position == pytest.approx(place * swing.amplitude, abs=tolerance)
        assert rate == pytest.approx(0.0, abs=1e-9 * first * rise)


@given(amplitude=st.floats(0.01, 3.0), times=st.tuples(durations, durations, durations))
def test_any_three_durations_make_a_motion_there_and_back(amplitude, times):
    time, two, three = times
    swing = TimedThreePhase(
        amplitude=amplitude, first_duration=time, middle_duration=two, last_duration=three
    )
    assert swing.period == time + two + three
    check_there_and_back(swing)


@given(amplitude=st.floats(0.01, 3.0), fast=sizes, slow=sizes, last=sizes)
def test_a_last_phase_of_its_own_ends_at_rest_where_the_motion_began(amplitude, fast, slow, last):
    check_there_and_back(ThreePhase(amplitude=amplitude, fast=fast, slow=slow, last=last))


@given(fast=sizes, slow=sizes, last=st.none() | sizes)
def test_the_durations_of_a_three_phase_motion_give_the_same_motion(fast, slow, last):
    swing = ThreePhase(amplitude=0.8, fast=fast, slow=slow, last=last)
    starts = [piece.start for piece in swing.cycle()]
    timed = TimedThreePhase(
        amplitude=0.8,
        first_duration=starts[1],
        middle_duration=starts[2] - starts[1],
        last_duration=swing.period - starts[2],
    )
    # differences of times lose digits where one phase is short beside the others
    assert timed.accelerations == pytest.approx(swing.accelerations, rel=1e-9)


def test_a_last_phase_like_the_first_changes_nothing():
    swing = ThreePhase(amplitude=0.8, fast=120.0, slow=30.0)
    same = dataclasses.replace(swing, last=120.0)
    assert same.cycle() == swing.cycle()
    assert same.period == swing.period


@pytest.mark.parametrize("name", ["first_duration", "middle_duration", "last_duration"])
def test_runs_have_sensitivities_to_the_durations(name):
    times = {"first_duration": 0.1, "middle_duration": 0.4, "last_duration": 0.2}
    mechanism = cart(TimedThreePhase(amplitude=0.8, **times))
    path = f"mechanism.pendulum.profile.{name}"
    slope = simulate(mechanism, LAW, t_end=2.0).sensitivity("x", path)[-1]
    h = 1e-5
    ends = [
        simulate(vary(mechanism, "mechanism", {path: times[name] + d}), LAW, t_end=2.0)["x"][-1]
        for d in (-h, h)
    ]
    # a central difference is off by h^2 over 6 times a third derivative of some hundred times x
    assert slope == pytest.approx((ends[1] - ends[0]) / (2.0 * h), rel=1e-4)


def test_a_sampled_sine_moves_the_cart_as_the_sine_does():
    sine = SineSwing(amplitude=1.2, frequency=1.6)
    tilted = dataclasses.replace(cart(sine), incline=0.05)
    t = np.arange(0.0, 3.0001, 0.005)
    sampled = SampledSwing(times=t, positions=[sine.at(x)[0] for x in t])
    other = dataclasses.replace(tilted, pendulum=Prescribed(profile=sampled))
    exact, found = (float(simulate(one, LAW, t_end=3.0)["x"][-1]) for one in (tilted, other))
    assert abs(exact) > 0.01
    # knots two samples apart: a cubic spline's acceleration is off by (w h)^2 / 12, 8e-4
    assert found == pytest.approx(exact, rel=2e-3)


@pytest.mark.parametrize("noise", [1e-4, 1e-3])
def test_the_error_of_the_acceleration_is_at_least_what_the_noise_leaves(noise):
    sine = SineSwing(amplitude=0.8, frequency=1.5)
    t = np.arange(0.0, 3.0, 0.005)
    clean = np.array([sine.at(x)[0] for x in t])
    random = np.random.default_rng(4)
    wrong, stated = [], []
    for _ in range(8):
        swing = SampledSwing(times=t, positions=clean + noise * random.normal(size=t.size))
        wrong.append(np.mean([(swing.value(x) - sine.value(x)) ** 2 for x in t[:-1:7]]))
        stated.append(swing.acceleration_error)
        assert swing.noise == pytest.approx(noise, rel=0.15)  # 600 samples: 3 %, 5 times that
    ratio = math.sqrt(np.mean(wrong)) / np.mean(stated)
    # what the spline flattens comes to it, and is about as much where the criterion chose
    assert 0.7 < ratio < 2.0


def test_wide_knots_take_off_noise_and_the_stated_error_follows():
    t = np.arange(0.0, 2.0, 0.01)
    y = np.sin(t) + 1e-3 * np.random.default_rng(0).normal(size=t.size)
    errors = [SampledSwing(times=t, positions=y, spacing=h).acceleration_error for h in (0.1, 0.4)]
    assert errors[0] / errors[1] == pytest.approx(4.0**2.5, rel=0.5)  # sqrt(dt / h) / h^2


def test_a_recorded_motion_has_no_cycle_and_no_continuation():
    t = np.linspace(0.0, 1.0, 101)
    mechanism = cart(SampledSwing(times=t, positions=np.sin(t)))
    assert cycle_or_none(mechanism) is None
    with pytest.raises(ParameterError, match=r"ends at 1 s, but the run at t_end = 2 s"):
        simulate(mechanism, LAW, t_end=2.0)


def test_sensitivities_to_friction_hold_with_a_recorded_motion():
    sine = SineSwing(amplitude=1.2, frequency=1.6)
    t = np.arange(0.0, 1.5001, 0.005)
    mechanism = cart(SampledSwing(times=t, positions=[sine.at(x)[0] for x in t]))
    mechanism = dataclasses.replace(mechanism, incline=0.05)
    slope = simulate(mechanism, LAW, t_end=1.4).sensitivity("x", "kinetic_coefficient")[-1]
    laws = (Coulomb(kinetic_coefficient=0.2 + d) for d in (-1e-5, 1e-5))
    ends = [float(simulate(mechanism, law, t_end=1.4)["x"][-1]) for law in laws]
    assert slope == pytest.approx((ends[1] - ends[0]) / 2e-5, rel=1e-4)  # h^2 / 6 of a few


@pytest.mark.slow
def test_a_fit_says_that_the_error_of_a_recorded_swing_is_in_no_interval():
    sine = SineSwing(amplitude=1.2, frequency=1.6)
    t = np.arange(0.0, 1.5001, 0.005)
    mechanism = cart(SampledSwing(times=t, positions=[sine.at(x)[0] for x in t]))
    x = simulate(mechanism, LAW, t_end=1.5).at(t[:300])["x"]
    noisy = x + 1e-4 * np.random.default_rng(0).normal(size=300)
    found = fit(
        mechanism,
        Coulomb,
        Measurement(time=t[:300], position=noisy),
        settings=RecordSettings(starts=1),
    )
    assert "The motion of theta is a recorded one" in " ".join(found.sentences)


GOOD = {"times": np.arange(20) * 0.1, "positions": np.zeros(20)}


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"times": np.arange(20) * 0.1 + 3.0}, "must begin at 0 s, when runs begin, got 3 s"),
        ({"times": [*(np.arange(19) * 0.1), 5.0]}, "have a gap of 3.2 s after 1.8 s"),
        ({"times": [*(np.arange(19) * 0.1), 0.5]}, "must increase, got 0.5 s after 1.8 s"),
        ({"positions": np.zeros(19)}, "must be as many, at least 8, got 20 and 19"),
        ({"positions": [math.nan] * 20}, "SampledSwing.positions must be finite"),
        ({"positions": "abc"}, "SampledSwing.positions must be a series of numbers"),
        ({"spacing": 0.01}, r"spacing \(h\) must be from two samples, 0.2 s, to half the record"),
    ],
)
def test_samples_that_make_no_motion_are_refused(changes, message):
    with pytest.raises(ParameterError, match=message):
        SampledSwing(**{**GOOD, **changes})


RIG = """
[mechanism]
type = "pendulum-cart"
cart_mass = "500 g"
ball_mass = "100 g"
length = "30 cm"
[mechanism.pendulum]
type = "prescribed"
profile = {{ {profile} }}
[run]
t_end = "1 s"
"""


@pytest.fixture
def rig_with(tmp_path):
    def make(profile, columns=None):
        t = np.linspace(0.0, 1.0, 101)
        known = {"time [s]": t, "position [mm]": t, "velocity [m/s]": t, "theta [deg]": 30.0 * t}
        table = known if columns is None else columns
        rows = np.column_stack(list(table.values()))
        lines = [",".join(table), *(",".join(map(repr, row.tolist())) for row in rows)]
        (tmp_path / "record.csv").write_text("\n".join(lines))
        (tmp_path / "cart.toml").write_text(RIG.format(profile=profile))
        return load_rig(tmp_path / "cart.toml")

    return make


def test_a_rig_file_names_the_column_of_the_recorded_angle(rig_with, tmp_path):
    rig = rig_with('type = "sampled-swing", file = "record.csv", column = "theta"')
    profile = rig.mechanism.pendulum.profile
    assert profile.at(1.0)[0] == pytest.approx(math.radians(30.0), rel=1e-9)
    assert tmp_path / "record.csv" in rig.files


def test_the_digest_of_a_rig_follows_the_file_of_its_motion(rig_with):
    text = 'type = "sampled-swing", file = "record.csv", column = "theta"'
    t = np.linspace(0.0, 1.0, 101)
    one, other = (rig_with(text, {"time [s]": t, "theta [deg]": k * t}) for k in (30.0, 31.0))
    assert one.digest != other.digest


@pytest.mark.parametrize(
    ("profile", "columns", "message"),
    [
        ('type = "sampled-swing"', None, "must have either file.*got neither"),
        (
            'type = "sampled-swing", file = "record.csv", times = [0.0]',
            None,
            "must have either file.*got times and file",
        ),
        ('type = "sampled-swing", file = "record.csv", column = "phi"', None, "'phi'. Known: "),
        (
            'type = "sampled-swing", file = "record.csv"',
            None,
            r"column 'position \[mm\]' must be in rad or a unit of that kind, not in mm",
        ),
        (
            'type = "sampled-swing", file = "record.csv", column = "theta"',
            {"time": np.arange(20) * 0.1, "theta": np.zeros(20)},
            "column 'theta' has no unit: add unit = \"deg\"",
        ),
        (
            'type = "timed-three-phase", amplitude = "45 deg", first_duration = "80 ms",'
            ' middle_duration = "0 s", last_duration = "80 ms"',
            None,
            r"middle_duration \(t_2\) must be above 0 s",
        ),
        (
            'type = "three-phase", amplitude = "45 deg", fast = 120, slow = 30, last = -1',
            None,
            r"last \(A_3\) must be above 0 rad/s\^2",
        ),
    ],
)
def test_a_motion_that_a_file_cannot_mean_is_one_message(rig_with, profile, columns, message):
    with pytest.raises(InputError, match=message):
        rig_with(profile, columns)
