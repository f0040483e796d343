"""What verdicts state is what was measured: ranges, sizes in words, laws that are counted."""

import re
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    CoulombViscousStatic,
    Measurement,
    Pendulum,
    RecordSettings,
    SpringBlock,
    Stribeck,
    Viscous,
    check,
    fit,
    load_measurement,
    load_rig,
    select,
    simulate,
)
from stickslip.data import guess_data, guessed_rig, read_data, swing_of
from stickslip.errors import InputError, ParameterError
from stickslip.identify.fits import Estimate
from stickslip.identify.page import facts, laws_section
from stickslip.identify.problems.record_signals import records_of
from stickslip.mechanisms.drives import Sampled
from stickslip.quantities import Quantity

HELD = RecordSettings(hold="zero")
LAW = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.08)
ARM = Pendulum(mass=1.2, length=0.4)


def moved(rig, law, force, *, rate=200.0, noise=1e-5, seed=3):
    """Return times, noisy positions and the force that a rig was driven by."""
    time = np.arange(len(force)) / rate
    drive = Sampled(times=tuple(time), values=tuple(force))
    run = simulate(replace(rig, drive=drive), law, t_end=float(time[-1])).at(time)
    position = run[rig.coordinates[0]]
    return time, position + noise * np.random.default_rng(seed).normal(size=len(time)), force


def swinging(arm):
    """Return times, angles and torques of a pendulum that a motor swings."""
    t = np.arange(0.0, 10.0, 0.005)
    torque = 2.2 * np.sin(2.0 * np.pi * 0.35 * t) + 1.5 * np.sin(2.0 * np.pi * 0.93 * t)
    return moved(arm, LAW, torque, noise=1e-4)


@pytest.mark.slow
@pytest.mark.parametrize(("back", "sides"), [(0.0, 1), (1.0, 2)])
def test_the_band_is_stated_where_the_body_moved(back, sides):
    t = np.arange(0.0, 12.0, 0.005)
    forward = 3.0 + 2.0 * np.sin(np.pi * t)
    slowly = -2.4 * np.ones_like(t)
    force = np.where((t % 6.0 < 4.0) | (back == 0.0), forward, slowly)
    law = CoulombViscous(kinetic_coefficient=1.4, viscous_coefficient=1.1)
    time, position, force = moved(Axis(inertia=1.5), law, force)
    record = Measurement(time=time, position=position, force=force)
    verdict = select(Axis(inertia=1.5), None, record, settings=HELD)
    speed = np.gradient(position, time)
    assert verdict.speeds.min() >= 1.02 * speed.min()
    assert verdict.speeds.max() <= 1.02 * speed.max()
    assert len({*np.sign(verdict.speeds)}) == sides
    assert verdict.words.lede.startswith("From −" if back else "From ")
    assert ("and from" in verdict.words.lede) == bool(back)


@pytest.mark.slow
def test_what_was_given_wrong_is_said_in_words():
    time, angle, torque = swinging(replace(ARM, gravity=1.15 * ARM.gravity))
    verdict = select(ARM, None, Measurement(time=time, position=angle, force=torque), settings=HELD)
    said = "Forces of the mechanism are 1.1"
    (line, *_) = [x for x in verdict.words.cannot_tell if "times as given" in x and said in x]
    assert "or the gain of the force or a unit of length is wrong" in line
    (size, *_) = [x for x in verdict.findings if x.sentence in line]
    assert 1.0 + size.low < 1.15 < 1.0 + size.high


@pytest.mark.slow
def test_all_laws_that_are_counted_are_in_the_table():
    v = np.array([0.02, 0.05, 0.1, 0.2, 0.35, 0.5, -0.02, -0.05, -0.1, -0.2, -0.35, -0.5])
    noise = 0.15 * np.random.default_rng(4).normal(size=len(v))
    friction = np.sign(v) * (2.0 + np.abs(v)) + noise
    verdict = select(Axis(inertia=1.0), None, Measurement(velocity=v, friction=friction))
    assert len(verdict.set) > 6  # more than the table has otherwise
    assert {candidate.family for candidate in verdict.candidates} >= {*verdict.set}
    told = [candidate for candidate in verdict.candidates if candidate.outcome]
    assert len(told) == len(verdict.set)
    assert laws_section(verdict).heading.startswith(f"{len(told)} laws")


@pytest.mark.parametrize(
    ("low", "high", "said"),
    [(0.24, 0.262, "0.250 ± 0.011"), (0.24, 0.31, "0.250 (0.240 to 0.310)"), (0.25, 0.25, "0.25")],
)
def test_an_interval_that_is_skewed_is_stated(low, high, said):
    estimate = Estimate(
        path="friction.kinetic_coefficient", quantity=Quantity("mu_k"), value=0.25,
        low=low, high=high, interval="95 %",
    )  # fmt: skip
    assert estimate.plus_minus == said


@pytest.mark.parametrize("verb", ["select", "fit"])
@pytest.mark.parametrize("measured", ["free", "friction", "table"])
def test_a_hold_is_refused_where_no_force_is_recorded(verb, measured):
    t = np.arange(0.0, 10.0, 0.01)
    v = 3.0 * np.cos(t)
    record = {
        "free": Measurement(time=t, position=np.exp(-0.1 * t) * np.cos(6.0 * t)),
        "friction": Measurement(time=t, position=3.0 * np.sin(t), friction=np.sign(v)),
        "table": Measurement(velocity=np.linspace(0.1, 1.0, 9), friction=np.linspace(2.0, 3.0, 9)),
    }[measured]
    rig = Axis(inertia=1.0, stiffness=36.0)
    judged = {"fit": partial(fit, rig, Coulomb), "select": partial(select, rig, None)}[verb]
    with pytest.raises(InputError, match=r"of a force that drives the motion|has no effect"):
        judged(record, settings=HELD)


def test_what_trials_vary_is_the_setting_though_it_is_0_in_the_rig():
    rig = SpringBlock(mass=1.0, stiffness=400.0)
    trials = []
    for x in (0.06, 0.08, 0.1):
        law = Coulomb(kinetic_coefficient=0.3)
        run = simulate(replace(rig, compression=x), law, t_end=5.0)
        own = {"travel": float(run["x"][-1] - run["x"][0]), "uncertainty": 3e-4}
        trials.append(Measurement(**own, overrides={"mechanism.compression": x}))
    verdict = select(rig, [Coulomb], Measurement(trials=tuple(trials)))
    assert verdict.words.lede.startswith("With a compression from")


def volts(tmp_path, *, header, said):
    """Return a motor log whose force is a column of volts, read as something is said of it."""
    t = np.arange(0.0, 6.0, 0.01)
    x = np.sin(3.0 * t) + 0.3 * np.sin(7.0 * t)
    v = 3.0 * np.cos(3.0 * t) + 2.1 * np.cos(7.0 * t)
    rows = np.column_stack([t, x, 4.0 * np.sign(v) + 2.0 * v])
    file = tmp_path / "log.csv"
    np.savetxt(file, rows, delimiter=",", header=f"time,position,{header}", comments="")
    return load_measurement(file, columns={"force": header}, **said)


@pytest.mark.slow
def test_a_force_in_volts_is_said_to_hold_what_the_speed_induces(tmp_path):
    for said in ({"gain": {"force": 0.5}, "units": {"force": "V"}}, {"gain": {"force": "0.5 N/V"},
                 "units": {"force": "V"}}, {"gain": {"force": 0.5}}):  # fmt: skip
        record = volts(tmp_path, header="ctrl_V", said=said)
        assert record.volts == ("force",)
    (finding,) = check(record).of("volts")
    assert "viscous friction" in finding.sentence
    rig = Axis(inertia=1e-6)
    assert finding.sentence in select(rig, None, record).words.cannot_tell
    assert finding.sentence in fit(rig, CoulombViscous, record).sentences


def test_a_column_called_a_voltage_is_no_force_without_a_word(tmp_path):
    with pytest.raises(InputError, match="'voltage' is called a voltage and taken for the force"):
        volts(tmp_path, header="voltage", said={})
    assert volts(tmp_path, header="F_V", said={"units": {"force": "N"}}).volts == ()


@pytest.mark.slow
def test_a_static_level_that_no_row_tells_is_said_to_be_open():
    t = np.arange(0.0, 8.0, 0.005)
    law = CoulombViscousStatic(
        kinetic_coefficient=1.4, static_coefficient=2.0, viscous_coefficient=1.1
    )
    for force in (4.0 * np.sin(2.0 * np.pi * t) + 6.0 * np.sin(2.3 * t), 3.0 + np.sin(6.3 * t)):
        time, position, force_ = moved(Axis(inertia=0.5), law, force)
        record = Measurement(time=time, position=position, force=force_)
        found = fit(Axis(inertia=0.5), "coulomb-viscous-static", record)
        static = found.estimate("static_coefficient")
        assert not static.bounded
        assert static.value == found.law.static_coefficient
        assert static.value == pytest.approx(found.law.kinetic_coefficient)
        assert any(said.startswith("$F_s$ cannot be determined") for said in found.sentences)
    given = replace(law, static_coefficient=2.5)  # an assumption stays
    assert fit(Axis(inertia=0.5), given, record).law.static_coefficient == 2.5


def decay(start, length=0.4):
    """Return times, angles and rates of a pendulum that friction stops."""
    t = np.arange(0.0, 15.0, 0.01)
    run = simulate(
        Pendulum(mass=1.2, length=length),
        CoulombViscous(kinetic_coefficient=0.03, viscous_coefficient=0.01),
        t_end=float(t[-1]),
        y0={"theta": start},
    ).at(t)
    return t, run["theta"], run["omega"]


@pytest.mark.slow
@pytest.mark.parametrize("start", [1.2, -0.6])
def test_a_pendulum_of_which_only_the_rate_is_known_accuses_nothing(start):
    t, _, rate = decay(start)
    rate = rate + 3e-3 * np.random.default_rng(2).normal(size=len(t))
    verdict = select(ARM, None, Measurement(time=t, velocity=rate, turning=True))
    (record,) = verdict.judgement.problem.records
    assert record.began == pytest.approx(start, abs=0.01)
    assert any("taken to begin at" in sentence for sentence in verdict.words.cannot_tell)
    assert not [one for one in verdict.findings if one.asserted]
    levels = [  # of both directions where the law carries an offset consistent with zero
        parameter
        for parameter in verdict.parameters
        if parameter.path.endswith("kinetic_coefficient")
    ]
    assert levels
    assert all(level.low_any < 0.03 < level.high_any for level in levels)


def test_a_place_that_was_measured_or_stated_is_taken():
    t, angle, rate = decay(0.8)
    both = Measurement(time=t, position=angle, velocity=rate, turning=True)
    assert records_of(ARM, both)[0].began is None
    alone = Measurement(time=t, velocity=rate, turning=True)
    assert records_of(replace(ARM, rest_angle=-0.8), alone)[0].began is None
    assert records_of(Axis(inertia=0.2, rotary=True), alone)[0].began is None


@pytest.mark.parametrize("quantity", ["position", "velocity"])
def test_a_body_that_swings_by_itself_is_proposed_as_a_pendulum(tmp_path, quantity):
    t, angle, rate = decay(0.8)
    values = angle + 0.3 if quantity == "position" else rate
    name = {"position": "angle_rad", "velocity": "omega"}[quantity]
    file = tmp_path / "decay.csv"
    np.savetxt(file, np.column_stack([t, values]), delimiter=",", header=f"time,{name}",
               comments="")  # fmt: skip
    guess = guess_data(file)
    swing = swing_of(read_data([file], replace(guess.reading, by="options")))
    text = guessed_rig(guess, "decay.csv", swing=swing)
    (tmp_path / "decay.toml").write_text(text)
    with pytest.raises(ParameterError, match=r"mechanism.mass = '\? kg'"):
        load_rig(tmp_path / "decay.toml")  # friction would be in proportion to an invented mass
    (tmp_path / "decay.toml").write_text(text.replace("? kg", "0.5 kg"))
    rig = load_rig(tmp_path / "decay.toml").mechanism
    assert isinstance(rig, Pendulum)
    assert rig.length == pytest.approx(0.4, rel=1e-3)
    hangs = 0.3 if quantity == "position" else -0.8
    assert rig.rest_angle == pytest.approx(hangs, abs=0.01)


@pytest.mark.parametrize("step", [0.01, 1 / 30, 0.1])
@pytest.mark.parametrize("amplitude", [0.3, 1.0])
def test_the_length_of_a_pendulum_is_found_at_any_sampling(step, amplitude):
    law = CoulombViscous(kinetic_coefficient=0.004, viscous_coefficient=0.002)
    run = simulate(Pendulum(mass=0.5, length=0.4), law, t_end=20.0, y0={"theta": amplitude})
    t = np.arange(0.0, 20.0, step)
    noise = 1e-3 * np.random.default_rng(1).normal(size=t.size)
    swing = swing_of(Measurement(time=t, position=run.at(t)["theta"] + noise, turning=True))
    assert swing.stiffness == pytest.approx(9.81 / 0.4, rel=3e-3)  # 0.5 to 30 % before


def test_a_mass_that_swings_along_a_line_is_proposed_on_a_spring(tmp_path):
    t = np.arange(0.0, 10.0, 0.01)
    file = tmp_path / "block.csv"
    x = 0.02 + 0.1 * np.exp(-0.1 * t) * np.cos(6.0 * t)
    np.savetxt(file, np.column_stack([t, x]), delimiter=",", header="time,x [m]", comments="")
    guess = guess_data(file)
    text = guessed_rig(guess, "block.csv", swing=swing_of(read_data([file], guess.reading)))
    assert 'type = "axis"' in text
    assert 'inertia = "? kg"' in text
    assert "for each kg of mass\n# the stiffness is 36.01 N/m" in text
    # what is driven, or runs out in one direction, swings by nothing of its own
    driven = Measurement(time=t, position=x, force=np.sin(t))
    assert swing_of(driven) is None
    assert swing_of(Measurement(time=t, position=t * np.exp(-0.1 * t))) is None


@pytest.mark.slow
def test_a_band_that_holds_an_offset_says_so():
    v = np.array([-0.9, -0.6, -0.3, -0.1, 0.1, 0.3, 0.6, 0.9])
    noise = 0.01 * np.random.default_rng(1).normal(size=len(v))
    said = []
    for offset in (0.0, 15.0):
        table = Measurement(velocity=v, friction=2.0 * np.sign(v) + v + noise + offset)
        said.append(select(Axis(inertia=1.0), None, table).words.lede)
    assert "both directions, friction is known to" in said[0]
    assert "friction with the constant offset is known to" in said[1]


def test_a_body_that_rests_is_refused():
    t = np.arange(0.0, 10.0, 0.004)
    still = 1e-7 * np.random.default_rng(1).normal(size=len(t))
    record = Measurement(time=t, position=still, force=1.2 * np.sin(2.5 * t))
    with pytest.raises(InputError, match="no motion was recorded"):
        select(Axis(inertia=1.0), None, record)
    creeping = replace(record, position=still + 1e-6 * np.sin(2.5 * t))
    with pytest.raises(InputError, match="rests throughout the record, or moves by no more"):
        select(Axis(inertia=1.0), None, creeping, vary=["friction.*", "mechanism.inertia"])


def test_parameters_of_what_is_no_law_have_their_symbols_and_units():
    v = np.geomspace(1e-6, 3e-4, 12)
    v = np.concatenate([v, -v])
    noise = 0.003 * np.random.default_rng(5).normal(size=len(v))
    friction = np.sign(v) * (0.31 - 0.008 * np.log(np.abs(v) / 1e-5)) + noise
    verdict = select(Axis(inertia=1.0), None, Measurement(velocity=v, friction=friction))
    found = {estimate.quantity.symbol: estimate for estimate in verdict.closest.fit.estimates}
    assert found["a"].quantity.unit in ("N", "")
    assert "v_0" not in found  # the reference of the logarithm, which nothing estimates
    assert found["a"].low < found["a"].value < found["a"].high < 0.0


def test_a_law_of_another_power_of_the_load_says_at_which_load_it_stands():
    v = np.tile(np.geomspace(0.005, 0.3, 8), 3)
    load = np.repeat([10.0, 20.0, 40.0], 8)
    noise = 0.02 * np.random.default_rng(3).normal(size=len(v))
    table = Measurement(velocity=v, friction=0.3 * load**0.7 + 2.0 * v + noise, load=load)
    verdict = select(Axis(inertia=1.0), None, table)
    assert any("levels are those at 20 N" in sentence for sentence in verdict.words.cannot_tell)
    assert any("levels are those at 20 N" in remark for remark in verdict.best.fit.remarks)


def test_cards_show_the_digits_of_their_intervals_and_what_they_are():
    v = np.linspace(0.1, 1.0, 12)
    noise = 1e-4 * np.random.default_rng(2).normal(size=len(v))
    verdict = select(Axis(inertia=1.0), None, Measurement(velocity=v, friction=2.0 + v + noise))
    (level, *_) = facts(verdict)
    assert len(level.value.partition(".")[2].partition(" ")[0]) >= 3
    assert level.what == "Coulomb friction $F_c$, 95 % over all laws"
    assert " to " in level.aside


@pytest.mark.slow
@pytest.mark.parametrize("located", [True, False])
def test_a_motor_that_swings_a_weight_is_proposed_as_a_pendulum(tmp_path, located):
    time, angle, torque = swinging(ARM)
    rate = np.gradient(angle, time)
    name, moved_ = ("angle_deg", np.degrees(angle)) if located else ("omega_rad_s", rate)
    file = tmp_path / "arm.csv"
    rows = np.column_stack([time, moved_, torque])
    np.savetxt(file, rows, delimiter=",", header=f"time_s,{name},torque_Nm", comments="")
    guess = guess_data(file)
    assert guess.units["position" if located else "velocity"] == ("deg" if located else "rad/s")
    swing = swing_of(read_data([file], replace(guess.reading, by="options")))
    assert swing.inertia == pytest.approx(1.2 * 0.4**2, rel=0.05)
    (tmp_path / "arm.toml").write_text(guessed_rig(guess, "arm.csv", swing=swing))
    rig = load_rig(tmp_path / "arm.toml")
    vary = ["friction.*", "mechanism.mass", "mechanism.inertia"]
    verdict = select(rig.mechanism, None, rig.measurement, vary=vary, settings=HELD)
    found = {estimate.path: estimate for estimate in verdict.closest.fit.estimates}
    mass = found["mechanism.mass"]
    assert mass.quantity.unit == "kg"
    assert mass.value * rig.mechanism.length == pytest.approx(1.2 * 0.4, rel=0.03)
    assert found["friction.kinetic_coefficient"].low < 0.25
    assert found["friction.kinetic_coefficient"].high > 0.25


def test_an_axis_whose_torque_moves_an_inertia_only_is_no_pendulum():
    t = np.arange(0.0, 8.0, 0.01)
    angle = 0.4 * np.sin(2.0 * t) + 0.2 * np.sin(5.0 * t)
    rate = 0.8 * np.cos(2.0 * t) + np.cos(5.0 * t)
    torque = -1.6 * np.sin(2.0 * t) - 5.0 * np.sin(5.0 * t) + 0.5 * np.sign(rate)
    noise = 0.02 * np.random.default_rng(0).normal(size=len(t))
    axis = Measurement(time=t, position=angle, force=torque + noise, turning=True)
    assert swing_of(axis) is None
    heavy = replace(axis, force=torque + noise + 4.0 * np.sin(angle))
    assert swing_of(heavy).stiffness == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize("laws", [None, ["coulomb"]])
def test_only_laws_that_were_compared_explain_nothing(laws):
    v = np.linspace(0.1, 2.0, 16)
    noise = 0.01 * np.random.default_rng(6).normal(size=len(v))
    table = Measurement(velocity=v, friction=2.0 + 3.0 * v + noise)
    verdict = select(Axis(inertia=1.0), laws, table)
    assert verdict.sentence.startswith("None of the laws compared describes" if laws else "Use ")


def test_a_level_that_no_load_changes_is_stated_and_part_of_the_law():
    load = np.repeat([20.0, 50.0, 100.0], 8)
    v = np.tile(np.geomspace(0.005, 0.6, 8), 3)
    noise = 0.05 * np.random.default_rng(3).normal(size=len(v))
    table = Measurement(velocity=v, friction=2.0 + 0.1 * load + noise, load=load)
    verdict = select(Axis(inertia=1.0), None, table)
    found = {estimate.path: estimate for estimate in verdict.closest.fit.estimates}
    assert found["adhesion"].low < 2.0 < found["adhesion"].high
    assert "with a level that no load changes" in verdict.words.verdict
    mean = verdict.judgement.problem.load
    assert found["friction.kinetic_coefficient"].value == pytest.approx(2.0 / mean + 0.1, rel=0.01)
    # what is simulated with the law has the load at which it holds
    assert verdict.closest.fit.mechanism.load == pytest.approx(mean)


def test_a_drift_is_what_friction_changes_by_over_a_table_in_newtons():
    order = np.random.default_rng(2).permutation(24)
    v, load = np.linspace(0.05, 0.6, 24)[order], np.tile([20.0, 50.0, 80.0], 8)
    rise = np.linspace(-0.05, 0.05, 24)
    noise = 0.02 * np.random.default_rng(4).normal(size=24)
    table = Measurement(velocity=v, friction=(0.2 + rise) * load + noise, load=load)
    verdict = select(Axis(inertia=1.0), None, table)
    (drift,) = (one for one in verdict.findings if one.asserted)
    assert drift.term == "drift"
    # from .15 to .25 times the load
    assert drift.size == pytest.approx(2.0 / 3.0, rel=0.1)
    assert drift.low <= 2.0 / 3.0 <= drift.high
    (said,) = (line for line in verdict.words.cannot_tell if "over the readings" in line)
    assert said.startswith("Friction rises over the readings, from ")
    assert " N at the first to " in said


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_a_block_that_stops_within_a_short_record_has_friction(seed):
    t = np.arange(96) / 60.0
    stop = 1.5 / 2.4
    u = np.minimum(t, stop)
    x = 1.5 * u - 0.5 * 2.4 * u**2
    x = x + 3e-4 * np.random.default_rng(seed).normal(size=len(t))
    verdict = select(SpringBlock(mass=1.0), None, Measurement(time=t, position=x))
    level = verdict.band([0.75])
    assert level.low[0] < 2.4 < level.high[0]
    assert level.high[0] - level.low[0] < 0.5


def test_a_level_that_depends_on_a_temperature_is_stated_where_it_was_measured():
    v, warm = np.tile(np.geomspace(0.01, 1.0, 8), 4), np.repeat([20.0, 35.0, 50.0, 65.0], 8)
    noise = 0.05 * np.random.default_rng(3).normal(size=v.size)
    friction = 10.0 - 0.05 * (warm - 20.0) + 3.0 * v + noise
    table = Measurement(velocity=v, friction=friction, inputs={"temperature": warm})
    verdict = select(Axis(inertia=1.0), ["level * linear[temperature] + viscous"], table)
    (said,) = (sentence for sentence in verdict.words.cannot_tell if "the median" in sentence)
    assert "temperature 42.5 °C" in said
    low, high = map(float, re.search(r"\((\S+) to (\S+)\)", said).groups())
    assert low < 10.0 - 0.05 * 22.5 < high < low + 0.3


@pytest.mark.slow
def test_two_loads_are_answered_by_a_third_one():
    v, load = np.tile(np.geomspace(0.01, 1.0, 10), 2), np.repeat([20.0, 80.0], 10)
    noise = 1.0 + 0.01 * np.random.default_rng(3).normal(size=v.size)
    friction = (0.5 * load**0.8 + v) * noise
    two = select(Axis(inertia=1.0), None, Measurement(velocity=v, friction=friction, load=load))
    assert two.words.measure_next[0].startswith("Measure at a third load, such as 40 N")
    load = np.where(np.arange(20) % 3 == 0, 40.0, load)
    friction = (0.5 * load**0.8 + v) * noise
    three = select(Axis(inertia=1.0), None, Measurement(velocity=v, friction=friction, load=load))
    assert not any("third load" in sentence for sentence in three.words.measure_next)


@pytest.mark.slow
def test_a_body_without_friction_has_no_law_of_that_name():
    t = np.arange(0.0, 6.0, 0.002)
    force = 3.0 * np.sin(2.1 * t) + 2.0 * np.sin(5.3 * t)
    time, position, force = moved(
        Axis(inertia=2.0), Viscous(viscous_coefficient=0.0), force, rate=500.0
    )
    record = Measurement(time=time, position=position, force=force)
    verdict = select(Axis(inertia=2.0), None, record, settings=HELD)
    assert verdict.closest.title.startswith("No friction")
    assert not verdict.closest.name.startswith("coulomb")


def test_a_parameter_that_is_not_identified_has_no_number():
    v = np.linspace(0.3, 1.0, 8)
    noise = 1.0 + 0.01 * np.random.default_rng(3).normal(size=v.size)
    table = Measurement(velocity=v, friction=(4.0 + 3.0 * v) * noise)
    found = fit(Axis(inertia=1.0), CoulombViscousStatic, table)
    left = [estimate for estimate in found.estimates if not estimate.bounded]
    assert left
    assert all("not identified" in str(one) and "N" not in str(one) for one in left)
    assert any(said.startswith("$F_s$ cannot be determined") for said in found.sentences)


def test_what_fades_below_the_slowest_speed_has_no_end_of_its_interval_there():
    v = np.geomspace(0.05, 0.5, 20)
    noise = np.random.default_rng(11).normal(size=len(v))
    friction = 4.0 + 3.0 * np.exp(-((v / 0.03) ** 2)) + 2.0 * v + 0.01 * noise
    verdict = fit(Axis(inertia=1.0), Stribeck, Measurement(velocity=v, friction=friction))
    own = {one.path.rpartition(".")[2]: one for one in verdict.estimates}
    assert own["stribeck_velocity"].low == 0.0 or not own["stribeck_velocity"].bounded
    assert own["stribeck_velocity"].high > 0.03
    assert own["static_coefficient"].high == np.inf
    assert own["static_coefficient"].reason == "the speeds measured do not bound it"
