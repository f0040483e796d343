"""Checks: every remark appears where it should, and a clean record gets no warning."""

import json
import pickle

import numpy as np
import pytest

from stickslip import Axis, CoulombViscous, Measurement, SpringBlock, check, fit, load_measurement
from stickslip.data import Checks, Finding, guess_data, inertia_of, read_data, refuse_faults
from stickslip.data.checking.data_quality import jumps
from stickslip.data.tolerances import LISTED
from stickslip.errors import InputError
from stickslip.mechanisms import as_rotary

RATE = 1000.0


def parts(size=8000, seed=1, **changes):
    """A clean record: two sines under Coulomb and viscous friction, an encoder of 0.1 µm."""
    rng = np.random.default_rng(seed)
    time = np.arange(size) / RATE
    slow, fast = 2 * np.pi * 0.37, 2 * np.pi
    position = 0.05 * np.sin(fast * time) + 0.02 * np.sin(slow * time)
    velocity = 0.05 * fast * np.cos(fast * time) + 0.02 * slow * np.cos(slow * time)
    acceleration = np.gradient(velocity, time)
    force = 20 * np.sign(velocity) + 100 * velocity + 2 * acceleration
    found = {
        "time": time,
        "position": np.round(position + rng.normal(0, 1e-6, size), 7),
        "force": force + rng.normal(0, 0.5, size),
    }
    return {**found, **changes}


def found(kind, **changes):
    return check(Measurement(**parts(**changes))).of(kind)


CLEAN = check(Measurement(**parts()))


def test_a_clean_record_gets_no_warning():
    assert [f for f in CLEAN.findings if f.severity != "info"] == []
    assert CLEAN.worst == "info"


# --- sampling


def test_sampling_is_said_with_its_rate():
    (finding,) = CLEAN.of("sampling")
    assert finding.sentence == (
        "8,000 samples at 1 kHz over 8 s, evenly spaced (largest deviation below 0.001 %)."
    )
    assert finding.numbers["rate"] == pytest.approx(1000.0)


def test_steps_of_time_that_scatter_are_a_warning():
    rng = np.random.default_rng(0)
    time = np.cumsum(rng.uniform(0.2, 1.8, 8000)) / RATE
    (finding,) = found("sampling", time=time)
    assert finding.severity == "warning"
    # of a uniform spread of 0.2 to 1.8 about its median the root mean square is 0.8 over root 3
    assert finding.numbers["scatter"] == pytest.approx(0.8 / np.sqrt(3), rel=0.05)


def test_single_samples_that_are_missing_are_counted():
    kept = np.delete(np.arange(8000), [1000, 2000, 3000])
    record = Measurement(**{name: values[kept] for name, values in parts().items()})
    assert "except for 3 steps (3 single samples missing)" in check(record).sentences[0]


def test_further_samples_and_those_off_the_grid_are_no_missing_ones():
    time = parts()["time"]
    moved = time.copy()
    moved[100] += 0.6 / RATE
    for other, words in (
        (np.sort([*time, time[200] + 0.4 / RATE]), "1 step (1 sample comes early)"),
        (np.sort([*time, *(time[[200, 300]] + 0.4 / RATE)]), "2 steps (2 samples come early)"),
        (moved, "2 steps (1 sample off the grid)"),
    ):
        record = Measurement(time=other, position=np.sin(other), force=np.cos(other))
        assert f"evenly spaced except for {words}" in check(record).sentences[0]


def test_a_gap_is_placed_and_counted():
    kept = np.concatenate([np.arange(3000), np.arange(3300, 8000)])
    record = Measurement(**{name: values[kept] for name, values in parts().items()})
    (gap,) = check(record).of("gap")
    assert gap.sentence == "Gap of 0.301 s after 2.999 s (300 samples missing)."
    assert gap.severity == "warning"
    assert check(record).of("jump") == ()


# --- single signals


def test_a_jump_of_position_is_found_at_its_sample():
    position = parts()["position"].copy()
    position[3000:] += 0.005
    (jump,) = found("jump", position=position)
    assert jump.numbers["time"] == pytest.approx(2.999)
    # the body itself moves by at most 0.4 mm in a sample
    assert jump.numbers["step"] == pytest.approx(0.005, abs=4e-4)


def test_a_single_bad_sample_is_named_and_no_jump():
    position = parts()["position"].copy()
    position[5000] -= 0.01
    checks = check(Measurement(**parts(position=position)))
    (far,) = checks.of("outliers")
    assert far.numbers["first"] == pytest.approx(5.0)
    assert checks.of("jump") == ()


@pytest.mark.parametrize(("lost", "jumps"), [(0.0, 0), (0.003, 1)])
def test_counts_of_an_encoder_do_not_jump_on_an_interpolated_grid(lost, jumps):
    time, grid = np.arange(0.0, 10.0, 0.0013), np.arange(0.0, 9.9, 0.001)
    counts = np.interp(grid, time, 1e-4 * np.round(100.0 * np.sin(0.5 * time)))
    position = counts + np.where(grid > 7.0, lost, 0.0)
    assert len(check(Measurement(time=grid, position=position)).of("jump")) == jumps


def test_a_force_that_is_cut_off_is_saturated_at_both_ends():
    cut = np.clip(parts()["force"], -30, 30)
    above, below = found("saturation", force=cut)
    assert (above.numbers["level"], below.numbers["level"]) == (30.0, -30.0)
    assert (above.numbers["end"], below.numbers["end"]) == (1.0, -1.0)
    assert above.numbers["share"] == np.mean(cut == 30.0)
    assert above.severity == "warning"


def test_a_position_beyond_the_range_of_its_sensor_is_saturated_at_both_ends():
    clean = parts()["position"]
    above, below = found("saturation", position=np.clip(clean, -0.06, 0.06))
    assert (above.numbers["level"], below.numbers["level"]) == (0.06, -0.06)
    runs = np.diff(np.flatnonzero(np.diff(np.r_[0, clean >= 0.06, 0])))[::2]
    assert above.numbers["longest"] == runs.max()
    assert above.severity == "warning"


def test_the_step_of_an_encoder_is_found():
    (finding,) = CLEAN.of("quantisation")
    assert finding.numbers["step"] == pytest.approx(1e-7, rel=1e-3)
    assert finding.severity == "info"
    (finding,) = found("quantisation", position=np.round(parts()["position"] / 0.004) * 0.004)
    assert finding.numbers["step"] == pytest.approx(0.004)
    assert finding.severity == "warning"
    assert "steps of 4 mm" in finding.sentence


def test_speeds_and_ways_that_no_mechanism_has_are_refused():
    wave = np.sin(np.arange(8000) / 100)
    (finding,) = (f for f in found("units", position=200 * wave) if f.severity == "error")
    assert finding.sentence.startswith("Position changes at 2,000 m/s, faster than any mechanism")
    refuse_faults(Measurement(**parts(position=0.2 * wave)), Axis(inertia=1.0))
    stopped = Axis(inertia=1.0, lower_stop=-0.05, upper_stop=0.05)
    with pytest.raises(InputError, match=r"stops of the mechanism are 0\.1 m apart: give the unit"):
        refuse_faults(Measurement(**parts(position=wave)), stopped)


@pytest.mark.parametrize("size", [2, 3, 5, 11, 31])
@pytest.mark.parametrize("name", ["position", "velocity", "force", "friction", "reference"])
def test_any_single_signal_of_any_length_gets_sentences(name, size):
    checks = check(Measurement(time=np.arange(size) / 10, **{name: np.sin(np.arange(size))}))
    assert all(sentence.endswith((".", "?")) for sentence in checks.sentences)
    assert checks.of("sampling")


# --- signals beside each other


def test_a_derivative_that_is_noisier_than_the_velocity_is_of_no_other_unit():
    """Times of samples that jitter make the derivative noisy, and least squares through 0 small."""
    random = np.random.default_rng(2)
    t = np.arange(0.0, 8.0, 0.001)
    x, v = np.sin(3.0 * t), 3.0 * np.cos(3.0 * t)
    read = Measurement(time=t, position=x + 6e-3 * random.normal(size=len(t)), velocity=v)
    (finding,) = check(read).of("velocity")
    assert finding.numbers["factor"] < 0.9
    assert finding.severity == "info"


# --- motion


def test_rests_are_timed():
    time = np.arange(10_000) / RATE
    position = 0.1 * np.clip(np.sin(2 * np.pi * time / 5), -0.5, 0.5)
    (one,) = check(Measurement(time=time, position=position)).of("rests")
    # the sine is beyond half for a third of each half period; the filter takes some of it away
    assert one.numbers["stretches"] == 4
    assert one.numbers["share"] == pytest.approx(2 / 3, abs=0.03)


def test_a_body_that_hardly_moves_is_said_to_rest():
    time = np.arange(20_000) / RATE
    # what pushes it rises while it rests, and moves it at the end
    position = 0.1 * np.clip(time - 0.97 * time[-1], 0.0, None)
    force = 5.0 + 20.0 * time / time[-1] + 0.1 * np.random.default_rng(1).normal(size=time.size)
    found = check(Measurement(time=time, position=position, force=force))
    (finding,) = found.of("rests")
    assert finding.severity == "warning"
    assert finding.sentence.endswith("in 1 period: the record shows little of friction in motion.")


def test_huge_numbers_give_an_inertia_or_none_and_no_warning():
    t = np.arange(400) / 100
    for size in (1e100, 1e200):
        force = size * (10.0 * np.cos(4.0 * t) + np.sign(np.sin(4.0 * t)))
        record = Measurement(time=t, position=1e200 * t * (4.0 - t), force=force)
        assert inertia_of(record) is None
    small = Measurement(
        time=t, velocity=1.25e-160 * np.sin(4.0 * t), force=1e-160 * 10.0 * np.cos(4.0 * t)
    )
    assert inertia_of(small) == pytest.approx(2.0, rel=1e-3)


def test_what_readings_of_another_kind_than_travels_determine_is_left_to_that_kind():
    trials = [
        Measurement(friction=value, conditions={"temperature": 20.0 + value}, uncertainty=0.1)
        for value in (1.0, 2.0)
    ]
    found = check(Measurement(trials=trials))
    assert not found.of("conditions")
    assert not any("cannot rank" in line for line in found.sentences)
    travels = [Measurement(travel=1.0, conditions={"t": x}, uncertainty=0.1) for x in (1.0, 2.0)]
    assert check(Measurement(trials=travels)).of("conditions")


# --- levels


# --- tables


def test_a_friction_map_says_what_it_covers():
    speeds = np.linspace(-0.3, 0.3, 7)
    both = np.repeat(speeds, 3)
    checks = check(Measurement(velocity=both, friction=20 * np.sign(both) + both))
    covers, rest = checks.sentences
    assert rest.startswith("3 readings at a speed of 0 are taken for a body at rest")
    assert covers == "21 points at 7 velocities from −0.3 m/s to 0.3 m/s."
    assert checks.worst == "info"


def test_a_friction_map_of_one_direction_without_repeats_says_so():
    checks = check(Measurement(velocity=[0.1, 0.2, 0.3, 0.4], friction=[1.0, 2.0, 3.0, 4.0]))
    text = "\n".join(checks.sentences)
    assert "All velocities are forward" in text
    assert "No velocity is repeated" in text
    assert checks.worst == "warning"


def test_readings_are_counted_by_setting():
    trials = tuple(
        Measurement(travel=0.1 * i, uncertainty=0.01, overrides={"mechanism.compression": 0.1 * k})
        for i, k in enumerate([1, 1, 2], 1)
    )
    checks = check(Measurement(trials=trials))
    assert checks.sentences == ("3 readings at 2 settings, 1 repeat.",)
    assert checks.worst == "info"


def test_one_setting_and_a_missing_uncertainty_are_warnings():
    checks = check(Measurement(travel=0.2))
    assert [f.kind for f in checks.findings] == ["settings", "uncertainty"]
    assert checks.worst == "warning"


# --- the whole


def test_trials_are_checked_one_by_one():
    good = Measurement(**parts(), name="good")
    few = Measurement(time=np.arange(5.0), position=np.arange(5.0), force=np.zeros(5), name="few")
    checks = check(Measurement(trials=(good, few)))
    assert {f.record for f in checks.findings} == {"good", "few"}
    assert {f.record for f in checks.findings if f.severity == "error"} == {"few"}
    assert any(sentence.startswith("few: The record has only 5") for sentence in checks.sentences)


def trials_of(*positions):
    time = np.arange(2000) / RATE
    force = np.sin(9.0 * time)
    named = zip("abc", positions, strict=False)
    return Measurement(
        trials=[Measurement(time=time, position=x(time), force=force, name=n) for n, x in named]
    )


def test_a_trial_at_rest_beside_others_is_data():
    both = trials_of(np.sin, lambda t: 0.0 * t)
    (finding,) = check(both).of("constant")
    assert (
        str(finding)
        == "b: Position is constant: the body rested, which bounds its friction at rest."
    )
    assert finding.severity == "info"
    refuse_faults(both, Axis(inertia=1.0))
    still = trials_of(lambda t: 0.0 * t, lambda t: 1.0 + 0.0 * t)
    assert {one.severity for one in check(still).of("constant")} == {"error"}


def test_trials_that_go_either_way_tell_a_level_from_an_offset():
    finding, other = check(trials_of(lambda t: t, lambda t: -t)).of("reversals")
    assert str(other).endswith("goes backward only, and that of other trials the other way.")
    assert (finding.severity, finding.measure) == ("info", "")
    alike = check(trials_of(lambda t: t, lambda t: 2.0 * t)).of("reversals")
    assert {one.severity for one in alike} == {"warning"}


def test_a_mechanism_checks_overrides_and_stops():
    wrong = Measurement(travel=0.2, uncertainty=0.01, overrides={"mechanism.mas": 1.0})
    (finding,) = check(wrong, mechanism=SpringBlock(mass=1.0)).of("mechanism")
    assert finding.severity == "error"
    axis = Axis(inertia=95.0, upper_stop=0.06)
    (finding,) = check(Measurement(**parts()), mechanism=axis).of("mechanism")
    assert "upper_stop" in finding.sentence
    roomy = Axis(inertia=95.0, upper_stop=0.1)
    assert check(Measurement(**parts()), mechanism=roomy).worst == "info"


def test_checks_become_plain_json_and_html():
    content = json.loads(json.dumps(CLEAN.to_dict()))
    assert content["worst"] == "info"
    assert [f["sentence"] for f in content["findings"]] == list(CLEAN.sentences)
    page = Checks(findings=CLEAN.findings)._repr_html_()
    assert page.count("<li>") == len(CLEAN.findings)
    assert "1\xa0kHz" in page
    assert "1 kHz" in str(CLEAN)


def test_what_is_no_measurement_is_refused_with_a_cure():
    with pytest.raises(InputError, match="read a file with load_measurement"):
        check("data.csv")


# --- measured records

WEIGHT = 0.0307 * 9.81


def spring(data_dir, name):
    return load_measurement(
        data_dir / "spring_pulled_slider" / f"{name}.parquet",
        columns={"time": "t_s", "spring_force": "F_over_mg"},
        gain={"spring_force": WEIGHT},
    )


def axis(data_dir):
    return load_measurement(
        data_dir / "emps" / "train.parquet",
        columns={"time": "t_s", "position": "q_meas_m", "force": "force_N"},
    )


def test_the_axis_record_is_clean(data_dir):
    checks = check(axis(data_dir))
    assert checks.worst == "info"
    assert checks.sentences[0].startswith("24,841 samples at 1 kHz over 24.8 s, evenly spaced")
    # four strokes to and fro
    assert checks.of("reversals")[0].numbers["reversals"] == 7


def test_the_tribometer_counts_friction_the_other_way(data_dir):
    file = data_dir / "reciprocating_tribometer" / "train.parquet"
    columns = {"time": "t_s", "position": "x_m", "friction": "friction_N", "load": "normal_N"}
    (finding,) = check(load_measurement(file, columns=columns)).of("friction sign")
    assert finding.severity == "error"
    turned = load_measurement(file, columns=columns, gain={"friction": -1})
    assert check(turned).of("friction sign")[0].severity == "info"
    assert check(turned).of("saturation") == ()  # it turns round at the ends of its way


def test_a_record_of_three_quarters_of_a_million_samples_is_checked(data_dir):
    assert check(spring(data_dir, "k168_v42")).of("sampling")[0].numbers["samples"] == 751_281


def test_findings_cross_processes_and_stay_unchangeable():
    finding = Finding(kind="gap", sentence="Gap of 0.3 s after 12.5 s.", numbers={"gap": 0.3})
    again = pickle.loads(pickle.dumps(finding))
    assert again == finding
    with pytest.raises(TypeError):
        again.numbers["gap"] = 1.0


def test_a_trial_that_is_counted_twice_is_named():
    t = np.arange(400) / 200.0
    run = {"time": t, "position": np.sin(t), "force": np.cos(t)}
    once = Measurement(**run, name="a")
    again = Measurement(**run, name="b")
    other = Measurement(**(run | {"force": 2.0 * np.cos(t)}), name="c")
    found = [str(finding) for finding in check(Measurement(trials=(once, other, again))).findings]
    assert sum("counted twice" in line for line in found) == 1
    assert any(line.startswith("'b' has the samples of 'a'") for line in found)


def table_with_rest(level, slowest=0.01):
    """Return velocities and friction of sliding both ways, and three readings at rest."""
    speeds = np.linspace(slowest, 0.34, 40)
    velocity = np.concatenate([-speeds[::-1], [-5e-4, 7e-6, 2e-4], speeds])
    friction = level(velocity)
    friction[40:43] = (-0.9, 0.4, 0.27)
    return velocity, friction


def test_readings_whose_speed_is_not_resolved_are_those_of_a_body_at_rest():
    velocity, friction = table_with_rest(lambda v: 2.0 * np.sign(v) + v)
    table = Measurement(velocity=velocity, friction=friction)
    (finding,) = check(table).of("rest")
    assert finding.sentence.startswith(
        "3 readings at speeds of at most 0.5 mm/s are taken for a body"
    )
    assert "all others are at 10 mm/s or faster" in finding.sentence
    found = fit(Axis(inertia=1.0), CoulombViscous, table)
    got = [found.law.kinetic_coefficient, found.law.viscous_coefficient]
    np.testing.assert_allclose(got, [2.0, 1.0], rtol=0.01)  # readings at rest are not among them


def test_steady_readings_are_not_filtered_as_a_motion():
    rng = np.random.default_rng(2)
    velocity = 1e-3 * np.abs(np.linspace(-5.0, 5.0, 41) + 0.2 * rng.normal(size=41))
    friction = 80.0 * np.tanh(velocity / 0.35e-3)
    seen = Measurement(time=6.0 * np.arange(41), velocity=velocity, friction=friction)
    (finding,) = check(seen).of("steady readings")
    assert "one every 6 s" in finding.sentence
    assert check(seen).of("sampling") == ()
    (covered,) = [one for one in check(seen).of("coverage") if "points" in one.sentence][:1]
    assert covered.numbers["points"] == 41


def coasting(rate, seed=0):
    """Times and speeds of a coast-down from 50 rad/s, with noise of 0.02 rad/s."""
    time = np.arange(0.0, 150.0, 1.0 / rate)
    speed = 70.0 * np.exp(-0.006 * time) - 20.0
    return time, speed + 0.02 * np.random.default_rng(seed).normal(size=time.size)


@pytest.mark.parametrize("rate", [1.0, 10.0])
@pytest.mark.parametrize("value", [0.0, 300.0, 65535.0])
@pytest.mark.parametrize("rows", [[0], [1, 2], [25, 80], [40, 41], [-2, -1]])
def test_dropped_readings_of_a_coast_down_are_named_wherever_they_are(rate, value, rows):
    time, speed = coasting(rate)
    speed[rows] = value
    checks = check(Measurement(time=time, velocity=speed), mechanism=Axis(inertia=0.8))
    (far,) = checks.of("outliers")
    assert far.numbers["samples"] == len(rows)
    assert far.numbers["first"] == min(time[rows])
    assert [one for one in checks.of("drive") if one.severity != "info"] == []


@pytest.mark.parametrize("seed", range(3))
def test_a_coast_down_and_its_rest_have_no_sample_far_off(seed):
    time, speed = coasting(10.0, seed)
    rested = np.where(time < 100.0, speed, 0.02 * (speed - np.median(speed)) / np.ptp(speed))
    for values in (speed, rested):
        assert check(Measurement(time=time, velocity=values)).of("outliers") == ()


def swinging(counts, rate, length=0.33, seconds=40.0):
    """Times and angles of a lightly damped pendulum, and what an encoder shows of them."""
    omega = np.sqrt(9.81 / length)
    time = np.arange(0.0, seconds, 1.0 / rate)
    angle = 0.3 * np.exp(-0.01 * time) * np.cos(omega * time)
    step = 2.0 * np.pi / counts
    return time, step * np.round(angle / step), omega**2


@pytest.mark.parametrize(
    ("counts", "rate", "length"),
    [(400, 100.0, 0.33), (400, 1000.0, 0.33), (1000, 50.0, 6.0), (200, 100.0, 0.33)],
)
def test_turning_points_of_a_coarse_encoder_are_no_rests_and_it_swings(counts, rate, length):
    time, angle, stiffness = swinging(counts, rate, length)
    record = Measurement(time=time, position=angle, turning=True)
    checks = check(record, mechanism=as_rotary(Axis(inertia=2.0)))
    (rests,) = checks.of("rests")
    assert rests.numbers["duration"] == 0.0
    assert checks.of("jump") == ()
    turns = round(40.0 * np.sqrt(stiffness) / np.pi)
    assert checks.of("reversals")[0].numbers["reversals"] == pytest.approx(turns, abs=1)
    (swing,) = checks.of("mechanism")
    assert 'make it a pendulum, as with length = "' in swing.sentence
    # a sine of 0.3 rad is pulled back by up to 2 % less than its angle says
    assert swing.numbers["stiffness"] == pytest.approx(2.0 * stiffness, rel=0.03)
    assert [one for one in checks.of("drive") if one.severity != "info"] == []


@pytest.mark.parametrize("counts", [0, 400, 100])
def test_rests_of_three_seconds_are_told_from_turning_points(counts):
    time = np.arange(0.0, 20.0, 0.005)
    phase = time % 5.0
    moves = np.where(phase < 2.0, 1.5 * np.sin(np.pi * phase / 2.0) ** 2, 0.0)
    angle = np.cumsum(moves * np.where(time // 5.0 % 2.0, -1.0, 1.0)) * 0.005
    step = 2.0 * np.pi / counts if counts else 0.0
    noise = 2e-4 * np.random.default_rng(1).normal(size=time.size)
    seen = step * np.round(angle / step) if counts else angle + noise
    (rests,) = check(Measurement(time=time, position=seen, turning=True)).of("rests")
    assert rests.numbers["stretches"] == 4
    # the filter rounds each end, by less than a tenth of a rest; a coarse encoder by a fifth
    assert rests.numbers["duration"] == pytest.approx(12.0, rel=0.2)


def test_a_position_that_is_held_for_several_samples_does_not_jump():
    time, angle, _ = swinging(4000, 100.0)
    held = np.repeat(angle[::5], 5)
    checks = check(Measurement(time=time, position=held, turning=True))
    assert checks.of("jump") == ()
    assert checks.of("held samples")


@pytest.mark.parametrize("rate", [260.0, 999.0, 1300.0, 2000.0])
def test_counts_on_an_interpolated_grid_have_their_own_step(rate):
    own, count = np.arange(0.0, 20.0, 1e-3), 1e-4
    x = np.round(0.02 * np.sin(0.7 * own) / count) * count
    t = np.arange(0.0, 19.9, 1.0 / rate)
    record = Measurement(time=t, position=np.interp(t, own, x), force=np.sin(t))
    (said,) = (str(one) for one in check(record).of("quantisation"))
    assert said == "Position is quantised in steps of 0.1 mm, 400 over its range."


def test_the_few_samples_that_repeat_at_turns_are_no_counts():
    count = 1e-6
    ends = 5e-3 * np.array([0, 9, 3, 12, 1, 8, 4, 11, 2, 10, 5, 7, 0, 6])
    at = np.repeat(200 * np.arange(len(ends)), 2)
    at[1::2] += 1
    x = np.interp(np.arange(at[-1]), at, np.repeat(ends, 2))
    waves = np.repeat(np.random.default_rng(1).normal(size=len(ends)), 200)[: len(x)]
    x = x + 5e-4 * waves * np.sin(np.pi * np.arange(len(x)) / 200) ** 2
    t = 1e-3 * np.arange(len(x))
    record = Measurement(time=t, position=np.round(x / count) * count, force=np.sin(t))
    (said,) = (str(one) for one in check(record).of("quantisation"))
    assert said == "Position is quantised in steps of 1 µm, 60,000 over its range."


@pytest.mark.parametrize("named", [{}, {"time": ""}])
def test_a_table_sorted_by_speed_is_in_the_order_of_its_times(tmp_path, named):
    draw = np.random.default_rng(0)
    v, t = np.linspace(0.01, 0.5, 20), 60.0 * np.arange(20)
    file = tmp_path / "steady.csv"
    clock = "time" if named else "time_s"
    for times in (t, draw.permutation(t)):
        rows = np.column_stack([times, v, 2.0 + v])
        np.savetxt(file, rows, delimiter=",", header=f"{clock},velocity,friction", comments="")
        record = load_measurement(file, columns=named)
        np.testing.assert_array_equal(record.velocity, v[np.argsort(times)])
        np.testing.assert_array_equal(record.friction, 2.0 + record.velocity)
        assert not check(record).of("unused column")


def test_a_shuffled_column_of_times_is_no_time_of_a_record(tmp_path):
    times = np.random.default_rng(0).permutation(20)
    rows = np.column_stack([times, np.linspace(0.01, 0.5, 20), np.linspace(2.0, 2.5, 20)])
    file = tmp_path / "steady.csv"
    np.savetxt(file, rows, delimiter=",", header="time,velocity,friction", comments="")
    record = read_data([file], guess_data(file).reading)
    assert record.kind == "friction-map"


def test_noise_makes_no_speed_rise_and_fall():
    t = np.arange(0.0, 10.0, 0.0125)
    noise = np.random.default_rng(4).normal(size=len(t))
    slowing = 2.0 * t - 0.09 * t**2
    rising = slowing + 0.25 * np.sin(2.0 * t)
    for x, doubted in ((slowing + 5e-3 * noise, False), (rising, True)):
        findings = check(Measurement(time=t, position=x), mechanism=Axis(inertia=1.0)).of("drive")
        assert any("rises and falls" in finding.sentence for finding in findings) == doubted


def test_noise_of_many_passages_is_no_gain_of_energy():
    t = np.arange(0.0, 60.0, 0.005)
    noise = np.random.default_rng(5).normal(size=len(t))
    rig = Axis(inertia=1.0, stiffness=10.0)
    w = np.sqrt(10.0)
    fading = np.exp(-0.02 * t) * np.cos(w * t)
    growing = (1.0 + 0.01 * t) * np.cos(w * t)
    for x, doubted in ((fading + 4.5e-3 * noise, False), (growing, True)):
        findings = check(Measurement(time=t, position=x), mechanism=rig).of("drive")
        assert any("gains energy" in finding.sentence for finding in findings) == doubted


def test_noise_that_has_mostly_one_sign_is_not_of_the_other_sign_convention():
    v = np.geomspace(0.01, 1.0, 11)
    noise = [-0.12, -0.03, -0.2, 0.09, -0.05, -0.01, -0.15, -0.02, 0.06, -0.04, -0.08]
    assert not check(Measurement(velocity=v, friction=noise)).of("friction sign")
    (turned,) = check(Measurement(velocity=v, friction=-2.0 - v)).of("friction sign")
    assert turned.severity == "error"


# --- one finding each, and records of which nothing is said

TIME = np.arange(8000) / RATE
LONG = np.arange(20_000) / RATE
TRUE = 0.1 * np.pi * np.cos(2 * np.pi * TIME) + 0.0148 * np.pi * np.cos(0.74 * np.pi * TIME)
GOOD = parts()
CHANCE = np.random.default_rng(0)
SIGNS = np.sign(CHANCE.normal(size=8000)) * np.sign(TRUE) * (CHANCE.random(8000) > 0.1)
WAYS = {
    way: {"time": TIME, "position": sign * (TIME + 0.1 * np.sin(TIME))}
    for way, sign in (("forward", 1), ("backward", -1))
}


def noisy(size, seed, speed):
    time = np.arange(size) / RATE
    return {
        "time": time,
        "position": speed * time + np.random.default_rng(seed).normal(0, 2e-5, size),
    }


SAID = [
    *(("length", parts(size=n), "error", f"only {n} samples", {}) for n in (2, 9)),
    ("length", parts(size=49), "warning", "only 49 samples", {}),
    *(
        ("constant", {"time": np.arange(100.0), name: np.zeros(100)}, "error",
         "is constant: no motion was recorded.", {})
        for name in ("position", "velocity")
    ),
    # 5000 values: 2 % of the noise
    ("constant", {"time": TIME[:5000], "position": CHANCE.normal(0.1, 1e-6, 5000)}, "error", "",
     {"noise": pytest.approx(1e-6, rel=0.1)}),
    ("constant", {**GOOD, "force": np.full(8000, 12.0)}, "info", "12 N", {"force": 12.0}),
    ("constant", {**GOOD, "friction": np.full(8000, 12.0)}, "warning", "12 N", {"friction": 12.0}),
    ("load", {**GOOD, "load": np.where(np.arange(8000) < 800, -0.001, 5.0)}, None, "",
     {"share": 0.1}),
    *(
        ("units", {**GOOD, name: values}, "warning", f"values are in {unit}.", {})
        for name, values, unit in (
            ("position", 1000 * np.sin(np.arange(8000) / 3000), "metres"),
            ("position", 1e-7 * np.sin(np.arange(8000) / 300), "metres"),
            ("position", 40 * np.sin(np.arange(8000) / 100), "metres and seconds"),
            ("velocity", 1000 * TRUE, "m/s"),
            ("force", 1e8 * np.sin(np.arange(8000) / 300), "newtons"),
        )
    ),
    ("units", {"travel": 200.0}, "warning", "", {}),
    # noise of 1 µm at 100 Hz
    *(
        ("velocity", {**GOOD, "velocity": factor * TRUE}, severity, words,
         {"factor": pytest.approx(factor, rel=1e-3)})
        for factor, severity, words in (
            (1000.0, "error", "velocity looks like mm/s"),
            (0.001, "error", "position looks like mm"),
            (-1.0, "error", "the signs are opposite"),
            (1.7, "error", "1.7 times the derivative"),
            (1.0, "info", ""),
        )
    ),
    ("velocity", {**GOOD, "velocity": 0.3 * np.sin(2 * np.pi * 3.1 * TIME)}, "warning",
     "does not follow", {}),
    ("friction sign", {**GOOD, "friction": -20 * np.sign(TRUE)}, "error", "set its gain to −1",
     {"opposite_share": pytest.approx(1.0, abs=0.01)}),
    ("friction sign", {**GOOD, "friction": 20 * np.sign(TRUE)}, "info", "",
     {"same_share": pytest.approx(1.0, abs=0.01)}),
    # signs by chance, and a tenth of them none: 2 % by chance
    ("friction sign", {**GOOD, "friction": 20 * SIGNS}, "warning", "",
     {"same_share": pytest.approx(0.45, abs=0.03)}),
    ("friction sign", {"velocity": [-0.2, -0.1, 0.1, 0.2], "friction": [2.0, 1.5, -1.5, -2.0]},
     "error", "", {}),
    # the fast sine has two extremes a second, and the slow one is too slow to add any
    ("reversals", GOOD, None, "", {"reversals": 16}),
    ("reversals", noisy(8000, 3, 0.1), None, "", {"reversals": 0}),
    # so few samples that no lower filter can take the noise off
    ("reversals", noisy(190, 1, 1e-3), "warning", "directions cannot be determined", {}),
    *(
        ("reversals", record, "warning", words, {})
        for way, record in WAYS.items()
        for words in (f"goes {way} only", "friction level and offset cannot be separated")
    ),
    ("rests", GOOD, None, "No periods of rest of 10 samples or more.", {}),
    ("low speed", WAYS["forward"], None, "does not determine friction near zero velocity", {}),
    # the cosine is below a twentieth for 2 asin(1/20) of pi
    ("low speed", {"time": LONG[:10_000], "position": 0.1 * np.sin(np.pi * LONG[:10_000])}, None,
     "", {"share": pytest.approx(2 * np.arcsin(0.05) / np.pi, abs=2e-3)}),
    ("motion", {"time": TIME[:500], "force": np.sin(np.arange(500.0))}, "info", "", {}),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "record", "severity", "words", "numbers"), SAID)
def test_what_is_odd_is_said_with_its_numbers(kind, record, severity, words, numbers):
    (finding,) = check(Measurement(**record)).of(kind)
    assert severity in (None, finding.severity)
    assert words in finding.sentence
    assert {name: finding.numbers[name] for name in numbers} == numbers


@pytest.mark.parametrize(
    "record",
    [
        *({**GOOD, name: 1e300 * np.sin(TIME)} for name in ("position", "force")),
        *({"time": t, "position": [0, 1, 2]} for t in ([0, 1, 1e300], [0, 1e-300, 2e-300])),
        {"velocity": [0.0, 0.0], "friction": [1.0, 2.0]},
        {"travel": 0.0},
        {"velocity": np.linspace(-1.0, 1.0, 20), "friction": np.zeros(20)},
    ],
)
def test_numbers_without_use_are_an_error(record):
    assert check(Measurement(**record)).worst == "error"


def pushed(step):
    """A body that is pushed from rest and back to rest in 0.5 s, and rests 0.5 s at either end."""
    time = LONG[:16_000]
    phase = np.clip(2 * (time % 1), 0, 1)
    way = np.where(phase < 0.5, 2 * phase**2, 1 - 2 * (1 - phase) ** 2)
    position = 0.05 * np.where(time.astype(int) % 2, 1 - way, way)
    return {"time": time, "position": step * np.round(position / step)}


def stopped():
    """A body that hits a stop at full speed and stays; from there it is pulled off from rest."""
    time = LONG[:12_000]
    at = time % 3
    position = np.select([at < 1, at < 2], [0.05 * at, 0.05], 0.05 * (1 - (at - 2) ** 2))
    return {"time": time, "position": 1e-7 * np.round(position / 1e-7)}


def table(level, rest=None):
    """Sliding both ways, and three readings of hardly any speed."""
    speeds = np.linspace(0.01, 0.34, 40)
    velocity = np.concatenate([-speeds[::-1], [-5e-4, 7e-6, 2e-4], speeds])
    friction = level(velocity)
    friction[40:43] = friction[40:43] if rest is None else rest
    return {"velocity": velocity, "friction": friction}


CYCLES = np.sin(2 * np.pi * LONG / 5)
SECONDS = np.arange(3000) / 100
PASSES = np.array([0.1, 0.2, 0.3, 0.4, 0.1])
QUIET = [
    *(
        (kind, GOOD)
        for kind in (
            "length", "gap", "jump", "saturation", "drift", "constant", "units", "velocity",
            "friction sign", "load", "motion", "mechanism",
        )
    ),
    ("length", parts(size=50)),
    ("jump", {**GOOD, "position": np.round(GOOD["position"], 3)}),
    ("jump", {"time": LONG[:4000], "position": 0.05 * np.floor(LONG[:4000])
              + np.maximum(0.0, 0.1 * (LONG[:4000] % 1 - 0.5))}),
    ("saturation", {"time": LONG, "force": np.round(CYCLES, 2)}),
    # flats of up to 900, 280 and 90 samples
    *(
        ("saturation", {"time": LONG, "position": np.round(n * CYCLES) / n})
        for n in (1e2, 1e3, 1e4)
    ),
    *(("saturation", pushed(step)) for step in (1e-7, 1e-5)),
    ("saturation", stopped()),
    ("constant", {**GOOD, "load": np.full(8000, 5.0)}),
    ("quantisation", {**GOOD, "position": 0.05 * np.sin(TIME)}),
    ("held samples", {"time": TIME[:400], "position": 0.1 * TIME[:400] ** 2,
                      "force": np.full(400, 24.0)}),
    ("outliers", {"time": TIME[:4000],
                  "velocity": np.where(np.arange(4000) % 400 == 100, 0.1, 0.0)}),
    ("order", {"velocity": PASSES, "friction": 20.0 + PASSES}),
    ("order", {"velocity": PASSES[[2, 0, 1, 3]], "friction": 20.0 + PASSES[[2, 0, 1, 3]]}),
    ("rest", table(lambda v: 2.0 * np.sign(v) + v, (-2.1, 1.9, 2.0))),
    ("rest", {"velocity": np.geomspace(1e-6, 1.0, 7), "friction": 2.0 + 0.05 * np.arange(-6, 1)}),
    # friction that fades with the speed: smooth, viscous, of creep
    *(
        ("rest", table(level))
        for level in (
            lambda v: 2 * np.tanh(v / 0.05), lambda v: 20 * v, lambda v: np.arcsinh(v / 1e-3)
        )
    ),
    *(
        ("steady readings", {"time": t, "velocity": v, "friction": 2.0 * np.sign(v) + v})
        for t, v in (
            (SECONDS, np.sin(SECONDS)),
            (SECONDS, np.sin(SECONDS) + 0.02 * np.sin(1e4 * SECONDS**2)),
            (SECONDS, np.sign(np.sin(SECONDS))),
            (1.0 * np.arange(600), np.repeat([1.0, 10.0, 1.0], 200)),
            (np.arange(60) / 30, np.sin(np.arange(60) / 10)),
            (0.005 * np.arange(600), 0.3 * np.sin(0.01 * np.pi * np.arange(600))),
        )
    ),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "record"), QUIET)
def test_nothing_is_said_of_what_a_record_does_not_have(kind, record):
    assert check(Measurement(**record)).of(kind) == ()


@pytest.mark.parametrize(
    ("kind", "record", "count"),
    [
        ("gap", {n: v[np.arange(8000) % 800 > 10] for n, v in GOOD.items()}, 9),
        ("jump", {**GOOD, "position": GOOD["position"] + 0.01 * (np.arange(8000) // 500)}, 15),
    ],
)
def test_many_faults_of_a_kind_are_summed_up(kind, record, count):
    faults = check(Measurement(**record)).of(kind)
    assert len(faults) == LISTED + 1
    assert faults[-1].numbers[f"{kind}s"] == count


@pytest.mark.parametrize("seed", range(2, 12))
def test_a_clean_record_gets_no_warning_by_chance(seed):
    assert check(Measurement(**parts(seed=seed))).worst == "info"


def test_two_quantities_of_one_run_are_no_repeats():
    checks = check(Measurement(travel=0.2, velocity=0.1, uncertainty={"travel": 1e-3}))
    assert checks.sentences[0].startswith("2 readings at 1 setting, no repeats.")


COUNT = 7.7e-3  # [m]


def coarse(case):
    """Return positions of a coarse sensor, and their times."""
    rng = np.random.default_rng(5)
    t = np.arange(3000) / 1000
    x = np.round(0.05 * np.sin(2 * t) / COUNT) * COUNT
    if case == "another grid":
        return t + 3e-4, np.interp(t + 3e-4, t, x)
    if case == "uneven lines":
        lines = np.cumsum(COUNT * (1 + 0.05 * rng.normal(size=100))) - 50 * COUNT
        return t, lines[np.searchsorted(lines, 0.2 * np.sin(2 * t))]
    return t, x + 1e-6 * rng.normal(size=t.size) * (case == "noise")


@pytest.mark.parametrize("case", ["plain", "noise", "another grid", "uneven lines"])
def test_a_step_of_a_coarse_sensor_is_no_jump(case):
    t, x = coarse(case)
    record = Measurement(time=t, position=x, force=np.sin(t))
    assert not [*jumps(record)]


@pytest.mark.parametrize(
    "lost", [lambda t, x: x + 0.3 * (np.floor(9 * t) % 2), lambda t, x: np.mod(60 * t, 2 * np.pi)]
)
def test_a_body_that_moves_between_its_jumps_has_no_coarse_sensor(lost):
    t = np.arange(3000) / 1000
    record = Measurement(time=t, position=lost(t, 0.05 * np.sin(2 * t)), force=np.sin(t))
    assert len([*jumps(record)]) > 5
