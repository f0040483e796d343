"""Trials under several conditions: whether they share one law, and what conditions change."""

import json
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Coulomb, CoulombViscous, Measurement, compare_trials
from stickslip import simulate as run_of
from stickslip.errors import InputError, ParameterError
from stickslip.friction import ElastoPlastic
from stickslip.mechanisms.drives import Sampled

AXIS = Axis(inertia=2.0)
MANY = (20.0, 30.0, 40.0, 50.0, 60.0, 70.0)
"""Temperatures: three would lie near a line by chance."""


def noise(draw, n, memory):
    """Return autocorrelated noise (n,) with standard deviation 1."""
    from scipy.signal import lfilter

    return np.sqrt(1.0 - memory**2) * lfilter([1.0], [1.0, -memory], draw.normal(size=n))


def trial(draw, number=0, *, level=5.0, slope=4.0, n=400, memory=0.9, one_way=0, **conditions):
    """Return measured friction along a motion of its own."""
    t = 0.01 * np.arange(n)
    v = 0.3 * np.sin(2.0 * np.pi * (0.7 + 0.07 * number) * t + number) * (1.0 + 0.3 * np.sin(t))
    v = one_way * (np.abs(v) + 0.01) if one_way else v
    friction = level * np.sign(v) + slope * v + 0.1 * noise(draw, n, memory)
    return Measurement(
        time=t, velocity=v, friction=friction, name=f"run{number}", conditions=conditions
    )


def made(seed, temperatures=(20.0, 40.0, 60.0), *, rise=0.0, slope_rise=0.0, **others):
    draw = np.random.default_rng(seed)
    return Measurement(
        trials=tuple(
            trial(
                draw,
                number,
                level=5.0 + rise * temperature,
                slope=4.0 + slope_rise * temperature,
                **others,
                **{"temperature [degC]": temperature},
            )
            for number, temperature in enumerate(temperatures)
        )
    )


def compared(measurement, law=CoulombViscous):
    return compare_trials(AXIS, law, measurement)


@pytest.mark.slow
def test_trials_of_one_law_are_seldom_said_to_differ():
    # said at odds of 20 to 1: of 20 sets, 1 is expected at most by chance
    rejected = sum(not compared(made(seed)).shared for seed in range(20))
    assert rejected <= 1


@pytest.mark.slow
def test_a_level_that_rises_is_found_and_said_with_its_ends():
    found = compared(made(1, MANY, rise=0.01))
    assert not found.shared
    first = found.sentences[0]
    assert first.startswith("The trials do not share one law (probability ")
    assert "): F_c rises from 5." in first
    assert "at 20 °C to 5." in first
    assert first.endswith("at 70 °C.")
    (level,) = (line for line in found.lines if line.path == "friction.kinetic_coefficient")
    assert level.low < 0.01 < level.high
    assert level.clear
    (viscous,) = (line for line in found.lines if line.path == "friction.viscous_coefficient")
    assert not viscous.clear


@pytest.mark.slow
def test_what_three_trials_hardly_tell_of_a_condition_is_said_so():
    found = compared(made(1, rise=0.01))
    assert not found.shared
    assert found.sentences[0].endswith("more trials would tell).")
    assert ", perhaps with the temperature (probability " in found.sentences[0]


@pytest.mark.slow
def test_most_small_rises_are_found():
    # 0.08 N of 5 N with noise of 0.1 N that remembers ten samples
    found = sum(not compared(made(seed, rise=0.002)).shared for seed in range(100, 120))
    assert found >= 12


@pytest.mark.slow
def test_a_viscous_part_that_falls_is_found():
    found = compared(made(2, MANY, slope_rise=-0.03))
    assert "sigma_2 falls from" in found.sentences[0]


@pytest.mark.slow
def test_intervals_of_slopes_cover_the_truth_beside_scatter_between_trials():
    covered, count = 0, 0
    for seed in range(40):
        draw = np.random.default_rng(seed)
        z = np.linspace(0.0, 100.0, 6)
        levels = 5.0 + 0.005 * z + 0.1 * draw.normal(size=6)
        trials = [trial(draw, i, level=levels[i], temperature=float(z[i])) for i in range(6)]
        line = compared(Measurement(trials=tuple(trials))).lines[0]
        covered += line.low <= 0.005 <= line.high
        count += 1
    assert covered >= 0.85 * count  # 95 % less 3 standard errors of 40 sets


@pytest.mark.slow
def test_each_trial_has_its_own_estimates_with_intervals():
    found = compared(made(3, rise=0.01))
    for one, temperature in zip(found.trials, (20.0, 40.0, 60.0), strict=True):
        level = one.estimates[0]
        assert level.low < 5.0 + 0.01 * temperature < level.high
        assert one.law.kinetic_coefficient == level.value
    table = found.to_dataframe()
    assert table["temperature [degC]"].tolist() == [20.0, 40.0, 60.0]
    assert {"F_c", "F_c low", "F_c high", "sigma_2", "leaves"} <= set(table.columns)
    plain = json.loads(json.dumps(found.to_dict()))
    assert plain["share_one_law"] is False
    assert plain["lines"][0]["condition"] == "temperature [degC]"


@pytest.mark.slow
def test_a_text_is_a_condition_whose_values_are_compared():
    draw = np.random.default_rng(4)
    words = ("dry", "oil", "dry", "oil")
    trials = [
        trial(draw, i, level=5.0 if word == "dry" else 4.0, lubrication=word)
        for i, word in enumerate(words)
    ]
    found = compared(Measurement(trials=tuple(trials)))
    assert "F_c is 5" in found.sentences[0]
    assert "(lubrication)" in found.sentences[0]
    assert "for 'dry' and " in found.sentences[0]
    assert "for 'oil'" in found.sentences[0]


@pytest.mark.slow
def test_a_difference_that_no_condition_explains_is_said_so():
    draw = np.random.default_rng(5)
    levels, runs = (5.0, 6.0, 6.0, 5.0), (1.0, 2.0, 3.0, 4.0)
    trials = [trial(draw, i, level=levels[i], run=runs[i]) for i in range(4)]
    found = compared(Measurement(trials=tuple(trials)))
    assert not found.shared
    assert "which no condition explains" in found.sentences[0]


def test_a_condition_that_is_the_same_or_missing_or_doubled_is_named():
    draw = np.random.default_rng(6)
    rows = (
        {"load": 10.0, "run": 1.0, "temperature": 20.0},
        {"load": 10.0, "run": 2.0, "temperature": 40.0},
        {"load": 10.0, "run": 3.0},
        {"load": 10.0, "run": 4.0, "temperature": 80.0},
    )
    found = compared(Measurement(trials=tuple(trial(draw, i, **row) for i, row in enumerate(rows))))
    text = str(found)
    assert "All trials have load 10: its effect cannot be determined." in text
    assert "run2 has no temperature: its effect was not looked for." in text
    assert {line.condition for line in found.lines} == {"run"}
    full = [trial(draw, i, run=float(i), temperature=20.0 + 20.0 * i) for i in range(4)]
    both = compared(Measurement(trials=tuple(full)))
    assert "run and temperature vary together: their effects cannot be separated." in str(both)
    assert {line.condition for line in both.lines} == {"run", "temperature"}


def test_numbers_and_texts_of_one_condition_are_not_mixed():
    draw = np.random.default_rng(7)
    trials = (trial(draw, 0, load="light"), trial(draw, 1, load=20.0))
    assert "load is a number in some trials and a text in others" in str(
        compared(Measurement(trials=trials))
    )


def test_opposite_directions_keep_the_offset_of_all_trials():
    draw = np.random.default_rng(8)
    trials = [
        trial(draw, i, one_way=1 if i % 2 else -1, direction="up" if i % 2 else "down")
        for i in range(4)
    ]
    found = compared(Measurement(trials=tuple(trials)))
    assert found.shared
    for one in found.trials:  # a trial of one direction cannot tell a level from an offset
        assert one.estimates[0].bounded
        assert one.estimates[0].value == pytest.approx(5.0, abs=0.1)


def test_friction_that_differs_by_direction_beyond_an_offset_is_found():
    draw = np.random.default_rng(9)
    trials = [
        trial(draw, i, one_way=1 if i % 2 else -1, slope=4.0 if i % 2 else 6.0, direction=word)
        for i, word in enumerate(("down", "up", "down", "up"))
    ]
    assert not compared(Measurement(trials=tuple(trials))).shared


def test_trials_that_alone_hardly_tell_a_parameter_have_wide_intervals_and_share_the_law():
    draw = np.random.default_rng(10)
    slow = []
    for speed in (0.1, 0.2, 0.3):  # one speed to and fro: level and slope are one
        v = speed * np.sign(np.sin(2.0 * np.pi * np.arange(400) / 80.0 + 0.1))
        friction = 5.0 * np.sign(v) + 4.0 * v + 0.1 * draw.normal(size=400)
        slow.append(Measurement(time=0.01 * np.arange(400), velocity=v, friction=friction))
    found = compared(Measurement(trials=tuple(slow)))
    assert found.shared
    for one in found.trials:
        level = one.estimates[0]
        assert level.low <= 5.0 <= level.high
        assert level.high - level.low > 2.0


def test_one_trial_travels_and_springs_are_refused():
    draw = np.random.default_rng(11)
    with pytest.raises(InputError, match="at least two"):
        compared(trial(draw))
    travels = Measurement(trials=(Measurement(travel=0.1), Measurement(travel=0.2)))
    with pytest.raises(InputError, match="not travels or the force of a spring"):
        compared(travels)


def test_records_of_a_driven_axis_are_compared():
    rig, t = Axis(inertia=2.0), np.arange(0.0, 3.0, 2e-3)
    draw, trials = np.random.default_rng(12), []
    for number, level in enumerate((4.0, 4.0, 5.0)):
        force = 12.0 * np.sin(2.0 * np.pi * (0.8 + 0.1 * number) * t)
        law = CoulombViscous(kinetic_coefficient=level, viscous_coefficient=6.0)
        drive = Sampled(times=tuple(t), values=tuple(force), hold="zero")
        run = run_of(Axis(inertia=2.0, drive=drive), law, t_end=float(t[-1])).at(t)
        position = run["x"] + 1e-6 * draw.normal(size=len(t))
        trials.append(
            Measurement(time=t, position=position, force=force, conditions={"run": number})
        )
    for count, shared in ((2, True), (3, False)):
        some = Measurement(trials=tuple(trials[:count]))
        found = compare_trials(rig, CoulombViscous, some)
        assert found.shared is shared, str(found)
        levels = [one.law.kinetic_coefficient for one in found.trials]
        assert levels == pytest.approx((4.0, 4.0, 5.0)[:count], abs=0.1)


def test_conditions_must_be_numbers_or_texts():
    with pytest.raises(ParameterError, match="leave an unknown condition out"):
        Measurement(travel=0.1, conditions={"temperature": float("nan")})
    with pytest.raises(InputError, match="give it for each trial"):
        Measurement(trials=(Measurement(travel=0.1),), conditions={"run": 1})


def test_a_law_with_states_that_no_balance_tells_is_refused():
    t = np.arange(0.0, 6.0, 5e-3)
    trials = tuple(
        Measurement(time=t, position=np.sin(rate * t), force=np.cos(rate * t))
        for rate in (2.0, 3.0)
    )
    with pytest.raises(InputError, match="has states that no measurement tells here"):
        compared(Measurement(trials=trials), ElastoPlastic)


def beside_a_rest(held):
    """Return a trial of Coulomb friction of 5 N, and one at rest under a force (n,) [N]."""
    draw = np.random.default_rng(0)
    t = np.arange(0.0, 20.0, 0.01)
    x = 0.5 * np.sin(2.0 * t) + 1e-5 * draw.normal(size=t.size)
    force = -6.0 * np.sin(2.0 * t) + 5.0 * np.sign(np.cos(2.0 * t))
    moving = Measurement(time=t, position=x, force=force, name="moving")
    force = held * np.sin(2.0 * t) + 0.05 * draw.normal(size=t.size)
    still = Measurement(time=t, position=0.0 * t, force=force, name="still")
    return Measurement(trials=(moving, still))


def test_a_trial_at_rest_is_not_compared_with_those_that_move():
    both = beside_a_rest(3.0)
    again = replace(both.trials[0], name="again")
    three = replace(both, trials=(*both.trials, again))
    found = compare_trials(Axis(inertia=3.0), Coulomb, three)
    assert [one.name for one in found.trials] == ["moving", "again"]
    assert not found.failed
    assert not any("still" in sentence for sentence in found.sentences)
    with pytest.raises(InputError, match="at least two trials with motion"):
        compare_trials(Axis(inertia=3.0), Coulomb, both)
