"""`select` on records of one coordinate: the law, the band and the parameters, by their balance."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from tests.support import acting

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    DirectionDependent,
    Measurement,
    Pendulum,
    PendulumCart,
    RecordSettings,
    SpringBlock,
    Stribeck,
    load_rig,
    select,
    simulate,
    write_report,
)
from stickslip.errors import InputError
from stickslip.friction import law
from stickslip.identify import BandVerdict
from stickslip.mechanisms import DCMotor, PositionLoop, Prescribed, Torque
from stickslip.mechanisms.drives import PiecewiseLinear, Sampled, Sine, Square, ThreePhase

RATE, SECONDS = 500.0, 12.0
T = np.arange(0.0, SECONDS, 1.0 / RATE)
TRUTH = law("level + viscous")(kinetic_coefficient=1.0, viscous_coefficient=0.3)
INERTIA = 0.02


def record(seed, gain=1.0):
    random = np.random.default_rng(seed)
    phases = random.uniform(0.0, 2.0 * np.pi, 4)
    force = sum(
        a * np.sin(2.0 * np.pi * f * T + p)
        for a, f, p in zip((1.2, 0.8, 0.6, 0.4), (0.4, 0.9, 1.7, 3.1), phases, strict=True)
    )
    axis = Axis(inertia=INERTIA, drive=PiecewiseLinear(times=T, values=force))
    x = simulate(axis, TRUTH, t_end=float(T[-1])).at(T)["x"]
    return Measurement(time=T, position=x + 1e-5 * random.normal(size=len(T)), force=gain * force)


@pytest.fixture(scope="module")
def verdict():
    return select(
        Axis(inertia=1.0),
        None,
        record(1),
        vary=["friction.*", "mechanism.inertia"],
        validate=record(2),
    )


def test_law_inertia_and_levels_of_an_axis_lie_in_their_intervals(verdict):
    assert {"level", "viscous"} <= set(verdict.family)
    truth = {"inertia": INERTIA, "kinetic_coefficient": 1.0, "viscous_coefficient": 0.3}
    found = {parameter.path.rpartition(".")[2]: parameter for parameter in verdict.parameters}
    for name, value in truth.items():
        assert found[name].low_any <= value <= found[name].high_any
        assert found[name].value == pytest.approx(value, rel=0.05)


def test_the_band_of_an_axis_holds_its_steady_friction(verdict):
    v = np.geomspace(0.2, float(verdict.speeds.max()), 20)
    band = verdict.band(v)
    assert np.mean((band.low <= 1.0 + 0.3 * v) & (1.0 + 0.3 * v <= band.high)) >= 0.9


def test_a_second_record_lies_in_the_band_of_readings(verdict):
    assert verdict.inside >= 0.9


def test_a_record_is_judged_by_its_balance_without_being_asked(verdict):
    assert isinstance(verdict, BandVerdict)
    assert verdict.route == "balance"
    assert verdict.set[0] == ("level", "viscous")
    assert verdict.findings == ()


def test_the_verdict_of_a_record_is_a_document_and_a_figure(verdict):
    said = json.loads(json.dumps(verdict.to_dict()))
    assert said["route"] == "balance"
    assert said["outliers"] == {}
    assert len(verdict.plot().lines) > 0


@pytest.mark.slow
def test_a_coast_down_at_one_sample_a_second_is_judged():
    """76 kg, 1.2 N and 0.03 N s^2/m^2: v = sqrt(F/c) tan(phi - t sqrt(F c) / m), a closed form."""
    level, drag, mass = 1.2, 0.03, 76.0
    t = np.arange(0.0, 330.0)
    scale = np.sqrt(level / drag)
    v = scale * np.tan(np.arctan(8.0 / scale) - t * np.sqrt(level * drag) / mass)
    read = v + 0.02 * np.random.default_rng(0).normal(size=len(t))
    found = select(Axis(inertia=mass), None, Measurement(time=t, velocity=read))
    u = np.linspace(1.0, 7.0, 13)
    band = found.band(u)
    truth = level + drag * u**2
    assert ((band.low <= truth) & (truth <= band.high)).all()


# ---- what the record says of the law

AXIS = Axis(inertia=2.0)
SIDES = DirectionDependent(
    forward_kinetic_coefficient=4.0,
    backward_kinetic_coefficient=5.0,
    forward_viscous_coefficient=3.0,
    backward_viscous_coefficient=9.0,
)


def moved(friction, *, axis=AXIS, seed=0, noise=1e-5, length=8.0, held=True):
    """Return a record under a random force, as an encoder and a controller give it."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, length, 0.005)
    phases, sizes = random.uniform(0.0, 2.0 * np.pi, 5), random.uniform(4.0, 9.0, 5)
    force = sum(
        a * np.sin(2.0 * np.pi * f * t + p)
        for f, a, p in zip((0.23, 0.41, 0.67, 1.1, 1.7), sizes, phases, strict=True)
    )
    drive = Sampled(times=t, values=force, hold="zero" if held else "first")
    x = simulate(replace(axis, drive=drive), friction, t_end=float(t[-1])).at(t)["x"]
    return Measurement(time=t, position=x + random.normal(0.0, noise, len(t)), force=force)


def intervals(verdict):
    return {parameter.path.rpartition(".")[2]: parameter for parameter in verdict.parameters}


def assert_holds(verdict, truth):
    found = intervals(verdict)
    for name, value in truth.items():
        assert found[name].low_any <= value <= found[name].high_any, name


@pytest.mark.slow
def test_levels_that_differ_by_direction_are_told_where_the_offset_is_held():
    verdict = select(AXIS, None, moved(SIDES), fixed={"offset": 0.0})
    assert verdict.best.name == "direction-dependent"
    assert_holds(verdict, {name: getattr(SIDES, name) for name in type(SIDES).fit_order})


@pytest.mark.slow
def test_with_an_unknown_offset_it_is_said_that_levels_by_direction_are_not_told_from_it():
    verdict = select(AXIS, None, moved(SIDES))
    said = "A constant offset cannot be distinguished from a level that differs by direction"
    assert any(said in line for line in verdict.words.cannot_tell)
    found = intervals(verdict)
    assert found["forward_viscous_coefficient"].value == pytest.approx(3.0, rel=0.05)
    assert found["backward_viscous_coefficient"].value == pytest.approx(9.0, rel=0.05)


@pytest.mark.slow
def test_presliding_is_a_memory_of_the_way():
    dahl = Dahl(kinetic_coefficient=4.0, bristle_stiffness=3000.0)
    verdict = select(AXIS, None, moved(dahl))
    assert verdict.best.name.startswith("dahl")
    assert_holds(verdict, {"kinetic_coefficient": 4.0, "bristle_stiffness": 3000.0})


@pytest.mark.slow
def test_only_laws_that_were_named_are_compared():
    record = moved(Dahl(kinetic_coefficient=4.0, bristle_stiffness=3000.0))
    assert select(AXIS, ["dahl", "coulomb"], record).best.name.startswith("dahl")
    both = select(AXIS, ["direction-dependent"], moved(SIDES))
    assert both.closest.name.startswith("direction-dependent")
    plain = select(AXIS, ["coulomb", "coulomb-viscous"], moved(SIDES))
    assert plain.closest.name.startswith("coulomb-viscous")
    assert plain.closest.distance > 0.1  # friction differs by direction
    assert select(AXIS, ["lugre"], record).best.name.startswith("lugre")


@pytest.mark.parametrize("held", [True, False])
def test_forces_that_hold_between_samples_or_go_straight_bias_nothing(held):
    truth = CoulombViscous(kinetic_coefficient=4.0, viscous_coefficient=6.0)
    verdict = select(AXIS, None, moved(truth, held=held))
    assert verdict.findings == ()
    assert_holds(verdict, {"kinetic_coefficient": 4.0, "viscous_coefficient": 6.0})


@pytest.mark.slow
def test_friction_that_is_recorded_late_is_a_delay_with_its_size():
    t = np.arange(0.0, 8.0, 0.004)
    x = 0.03 * np.sin(4.0 * t) + 0.01 * np.sin(11.3 * t)
    v = 0.12 * np.cos(4.0 * t) + 0.113 * np.cos(11.3 * t)
    friction = np.interp(t - 0.02, t, 2.0 * np.sign(v) + 3.0 * v)
    friction += 0.02 * np.random.default_rng(1).normal(size=t.size)
    verdict = select(AXIS, None, Measurement(time=t, position=x, friction=friction))
    (late,) = (one for one in verdict.findings if one.term == "delay")
    assert late.asserted
    assert -late.size == pytest.approx(0.02, rel=0.1)
    assert "as if it acted 20 ms earlier than recorded" in late.sentence


def test_samples_far_off_their_neighbours_are_left_out_and_said():
    truth = CoulombViscous(kinetic_coefficient=4.0, viscous_coefficient=6.0)
    record = moved(truth)
    x = record.position.copy()
    x[[300, 301, 900]] += 0.2
    verdict = select(AXIS, None, replace(record, position=x))
    assert any("3 samples of the position lie far off" in x for x in verdict.words.cannot_tell)
    assert_holds(verdict, {"kinetic_coefficient": 4.0, "viscous_coefficient": 6.0})


def test_numbers_that_a_law_made_are_judged_without_noise():
    t = np.linspace(0.0, 12.0, 240, endpoint=False)
    v = np.sin(2.0 * t + 0.3)
    exact = Measurement(
        time=t, position=-0.5 * np.cos(2.0 * t + 0.3), velocity=v,
        friction=10.0 * np.sign(v) + 30.0 * v,
    )  # fmt: skip
    verdict = select(AXIS, None, exact)
    assert verdict.best.name == "coulomb-viscous"
    found = intervals(verdict)
    assert found["kinetic_coefficient"].value == pytest.approx(10.0, rel=5e-3)
    assert found["viscous_coefficient"].value == pytest.approx(30.0, rel=5e-3)


def rubbed(*levels):
    """Return trials of friction in time whose levels differ."""
    random, v = np.random.default_rng(0), 0.3 * np.sin(0.07 * np.arange(400))
    return Measurement(
        trials=tuple(
            Measurement(
                time=0.01 * np.arange(400),
                velocity=v,
                friction=level * np.sign(v) + 4.0 * v + 0.1 * random.normal(size=400),
            )
            for level in levels
        )
    )


@pytest.mark.slow
@pytest.mark.parametrize(("change", "side"), [(1.0, 1.0), (1.0, -1.0), (-0.8, -1.0)])
def test_friction_that_changes_at_one_speed_is_said_with_its_ends(change, side):
    """As a disc runs in: bristles of metres, at rest at the first sample, are no rival of a drift.

    The friction begins at 3.4 N (1.6 N) and ends at 2.4 N.
    """
    t = np.arange(0.0, 600.0)
    size = 2.4 + change * np.exp(-t / 60.0)
    friction = side * size + 0.08 * np.random.default_rng(11).normal(size=len(t))
    disc = Measurement(time=t, velocity=np.full(len(t), 0.1 * side), friction=friction)
    verdict = select(Axis(inertia=1.0), None, disc)
    [drift] = [x for x in verdict.findings if x.term == "drift"]
    found = re.search(
        r"(\w+) over the record, from (\S+) N at its .* to (\S+) N at its", drift.sentence
    )
    assert found is not None
    assert drift.asserted
    assert found[1] == ("falls" if change > 0.0 else "rises")
    assert float(found[2]) == pytest.approx(2.4 + 0.9 * change, abs=0.3)
    assert float(found[3]) == pytest.approx(2.4, abs=0.1)
    band = verdict.band(0.1 * side)
    mean = side * size.mean()
    assert np.all((band.low < mean) & (mean < band.high))


@pytest.mark.slow
def test_friction_that_is_smooth_below_the_slowest_speed_bends_no_law():
    """Rows near a turn have it: with one breadth of them both coefficients were off."""
    t = np.arange(0.0, 38.8, 5e-3)
    waves = zip((1.0, 0.35, 0.1), (1.0, 3.1, 8.7), (3.1, 1.26, 0.42), strict=True)
    x, v, a = np.zeros((3, len(t)))
    for size, times, phase in waves:
        w = 2.0 * np.pi * 0.19 * times
        x += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w**2 * np.sin(w * t + phase)
    truth = {"kinetic_coefficient": 4.07, "viscous_coefficient": 0.19, "inertia": 0.53}
    level, viscous, inertia = truth.values()
    torque = inertia * a + level * np.tanh(v / 0.172) + viscous * v
    torque += 0.118 * np.random.default_rng(2).normal(size=len(t))
    seen = Measurement(time=t, position=np.round(x / 1e-4) * 1e-4, force=torque, turning=True)
    verdict = select(Axis(inertia=inertia), None, seen, vary=["friction.*", "mechanism.inertia"])
    own = {item.path.rpartition(".")[2]: item for item in verdict.parameters}
    for name, value in truth.items():
        assert own[name].low_any <= value <= own[name].high_any, name


@pytest.mark.slow
def test_trials_that_differ_widen_the_band_and_are_said_to():
    alike, unlike = select(AXIS, None, rubbed(5.0, 5.0, 5.0)), select(
        AXIS, None, rubbed(5.0, 6.0, 7.0)
    )  # fmt: skip
    assert not any("runs differ by" in line for line in alike.words.cannot_tell)
    assert any("The 3 runs differ by" in line for line in unlike.words.cannot_tell)
    assert "runs or specimens measured; friction of another one is known to" in unlike.words.lede
    v, band = unlike.speeds, unlike.other_specimen
    truths = [np.sign(v) * level + 4.0 * v for level in (5.0, 7.0)]
    assert np.mean([(band.low < y) & (y < band.high) for y in truths]) > 0.9
    own, narrow = unlike.friction, alike.friction
    assert np.median(own.high - own.low) < 0.3 * np.median(band.high - band.low)
    assert np.median(narrow.high - narrow.low) < 0.1 * np.median(band.high - band.low)


# ---- what is refused, or recommended to nobody


@pytest.mark.slow
@pytest.mark.parametrize("factor", [10.0, 0.1])
def test_lengths_in_the_wrong_unit_are_said_and_change_no_level(factor):
    record = moved(SIDES)
    verdict = select(AXIS, None, replace(record, position=factor * record.position))
    (inertia,) = (one for one in verdict.findings if one.term == "inertia_given")
    assert inertia.asserted
    assert 1.0 + inertia.size == pytest.approx(1.0 / factor, rel=0.02)
    assert any("a unit of length is wrong" in line for line in verdict.words.cannot_tell)
    # levels, whose mean beside an unknown offset is 4.5 N, have no length in them
    assert_holds(verdict, {"forward_kinetic_coefficient": 4.5})


@pytest.mark.slow
@pytest.mark.parametrize(
    ("level", "power", "base", "said"),
    [
        (0.9, 0.7, 0.0, "with the load to the power 0.7"),
        (0.4, 1.0, 4.0, "with a level that no load changes"),
        (0.3, 1.25, 0.0, "with the load to the power 1."),
        (0.9, 1.0, 0.0, ""),
    ],
)
def test_how_levels_follow_a_load_that_changes_along_a_record_is_named(level, power, base, said):
    random, t = np.random.default_rng(11), np.arange(900) / 150.0
    x = 0.02 * np.sin(2.2 * t) + 0.008 * np.sin(7.0 * t) + 0.003 * np.sin(15.0 * t)
    v, load = np.gradient(x, t), 20.0 + 14.0 * np.sin(2.3 * t + 1.0)
    friction = np.sign(v) * (level * load**power + base) + 6.0 * v
    friction += 0.02 * friction.std() * random.normal(size=len(t))
    verdict = select(
        Axis(inertia=1.0), None, Measurement(time=t, position=x, friction=friction, load=load)
    )
    assert said in verdict.sentence
    assert ("load" in verdict.sentence) == bool(said)
    for at in (8.0, 20.0, 32.0):
        truth = level * at**power + base + 6.0 * 0.05
        assert acting(verdict, np.array([0.05]), at)[0] == pytest.approx(truth, rel=0.02)


def test_a_record_without_motion_decides_nothing():
    t = np.arange(0.0, 4.0, 0.01)
    still = Measurement(time=t, position=np.zeros(400), force=np.sin(t))
    with pytest.raises(InputError, match="cannot be used"):
        select(AXIS, None, still)
    trials = tuple(replace(still, name=name) for name in ("north", "south"))
    said = r"cannot be used\. north and south: Position is constant"
    with pytest.raises(InputError, match=said) as seen:
        select(AXIS, None, Measurement(trials=trials))
    assert str(seen.value).count("Position is constant") == 1


@pytest.mark.slow
def test_a_frictionless_record_is_said_to_be_one():
    verdict = select(AXIS, None, moved(Coulomb(kinetic_coefficient=1e-9)))
    assert verdict.sentence.startswith("No friction stands above the noise")
    assert not any(parameter.path.startswith("friction.") for parameter in verdict.parameters)
    shares = re.findall(r"([\d,.]+) %", " ".join(verdict.words.measure_next))
    assert all(float(share.replace(",", "")) <= 100.0 for share in shares)


@pytest.mark.slow
def test_an_inertia_below_zero_is_said_before_there_is_no_friction():
    moving = moved(Coulomb(kinetic_coefficient=1e-9))
    # another body takes 1.5 times the force of inertia, and pushes back
    turned = replace(moving, force=-0.5 * moving.force, turning=True)
    verdict = select(
        Axis(inertia=1.0, rotary=True), None, turned, vary=["friction.*", "mechanism.inertia"]
    )
    first, second, *_ = verdict.sentence.split(". ")
    assert first == "Check units, gains and signs first"
    assert second.startswith("The balance gives J = −1 kg m², which cannot be")
    assert "If they are right, no friction stands above the noise" in verdict.sentence
    assert verdict.words.lede.startswith("If units, gains and signs are right: from ")


def test_what_has_no_effect_is_refused():
    with pytest.raises(InputError, match="it has no effect on records of motion or friction: lea"):
        select(AXIS, None, moved(SIDES), settings=RecordSettings(starts=2))


# ---- parameters of the mechanism

SPRING = Axis(inertia=1.1, stiffness=420.0)
BOTH = CoulombViscous(kinetic_coefficient=3.0, viscous_coefficient=6.0)


@pytest.fixture(scope="module")
def sprung():
    t = np.arange(0.0, 16.0, 0.004)
    force = sum(a * np.sin(2.0 * np.pi * f * t) for a, f in ((8.0, 0.23), (7.0, 0.61), (6.0, 1.37)))
    axis = replace(SPRING, drive=Sampled(times=t, values=force))
    random = np.random.default_rng(7)
    return Measurement(
        time=t,
        position=simulate(axis, BOTH, t_end=16.0).at(t)["x"] + 2e-6 * random.normal(size=t.size),
        force=force + 0.02 * random.normal(size=t.size),
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("given", "vary", "truth"),
    [
        ({"stiffness": 250.0}, ["stiffness"], {"stiffness": 420.0}),
        (
            {"stiffness": 250.0, "inertia": 3.0},
            ["stiffness", "inertia"],
            {"stiffness": 420.0, "inertia": 1.1},
        ),
        ({}, ["offset"], {"offset": 0.0}),
    ],
)
def test_parameters_in_which_the_balance_is_affine_are_found_beside_the_law(
    sprung, given, vary, truth
):
    verdict = select(replace(SPRING, **given), None, sprung, vary=["friction.*", *vary])
    assert verdict.best.name == "coulomb-viscous"
    levels = {"kinetic_coefficient": 3.0, "viscous_coefficient": 6.0}
    assert_holds(verdict, {**truth, **levels})
    rig = verdict.best.fit.mechanism
    for name, value in truth.items():
        assert getattr(rig, name) == pytest.approx(value, rel=0.01, abs=0.01)


@pytest.mark.slow
def test_a_damping_that_is_looked_for_has_the_viscous_friction_in_it(sprung):
    verdict = select(SPRING, None, sprung, vary=["friction.*", "damping"])
    assert verdict.best.name == "coulomb"
    assert_holds(verdict, {"kinetic_coefficient": 3.0, "damping": 6.0})
    said = "damping cannot be distinguished from viscous friction"
    assert any(said in x for x in verdict.words.cannot_tell)


def test_what_changes_nothing_is_no_parameter_to_find(sprung):
    with pytest.raises(InputError, match="nothing in these records changes with load"):
        select(SPRING, None, sprung, vary=["friction.*", "load"])


def decays(*compressions, noise=2e-5):
    """Return free decays of a block on a spring, and the block."""
    rig = SpringBlock(mass=1.0, stiffness=400.0, compression=0.1, attached=True)
    friction = CoulombViscous(kinetic_coefficient=0.02, viscous_coefficient=0.3)
    t, random = np.arange(0.0, 4.0, 0.01), np.random.default_rng(4)
    trials = tuple(
        Measurement(
            time=t,
            position=simulate(replace(rig, compression=x), friction, t_end=4.0).at(t)["x"]
            + random.normal(0.0, noise, t.size),
            overrides={"mechanism.compression": x},
        )
        for x in compressions
    )
    return rig, Measurement(trials=trials)


@pytest.mark.parametrize(
    ("given", "vary", "truth"),
    [
        ({}, [], {}),
        ({"stiffness": 300.0}, ["stiffness"], {"stiffness": 400.0}),
        ({"mass": 0.7}, ["mass"], {"mass": 1.0}),  # which the normal force grows with
    ],
)
def test_free_decays_name_the_law_that_damps_them(given, vary, truth):
    rig, record = decays(0.1, 0.06)
    verdict = select(replace(rig, **given), None, record, vary=["friction.*", *vary])
    assert verdict.best.name == "coulomb-viscous"
    assert_holds(verdict, {**truth, "kinetic_coefficient": 0.02, "viscous_coefficient": 0.3})


def test_a_free_motion_of_unknown_mass_and_stiffness_has_no_scale():
    rig, record = decays(0.1, 0.06)
    with pytest.raises(InputError, match="without a force only friction over inertia"):
        select(rig, None, record, vary=["friction.*", "mass", "stiffness"])


# ---- motors, gears, inner bodies, drives

MOTOR = DCMotor(
    resistance=3.2, torque_constant=0.35, rotor_inertia=2e-3, supply=7.4,
    loop=PositionLoop(gain=25.0),
)  # fmt: skip
SERVO = Pendulum(mass=0.49, length=0.1, drive=MOTOR)


def commanded(text, **values):
    """Return angle, voltage and goal of a servo at 200 Hz."""
    t = np.arange(0.0, 10.0, 0.005)
    goal = 0.9 * np.sin(2.0 * np.pi * 0.45 * t) + 0.5 * np.sin(2.0 * np.pi * 1.3 * t + 1.0)
    drive = Sampled(times=t, values=goal, hold="first")
    rig = replace(SERVO, drive=replace(MOTOR, drive=drive))
    run = simulate(rig, law(text)(**values), t_end=10.0).at(t)
    return Measurement(
        time=t,
        position=run["theta"] + 2e-4 * np.random.default_rng(0).standard_normal(t.size),
        voltage=np.clip(25.0 * (goal - run["theta"]), -7.4, 7.4),
        reference=goal,
        turning=True,
    )


@pytest.mark.slow
@pytest.mark.parametrize("command", ["voltage", "reference"])
def test_the_torque_of_a_motor_follows_from_its_voltage_or_its_goal(command):
    record = commanded("level + viscous", kinetic_coefficient=0.05, viscous_coefficient=0.02)
    verdict = select(SERVO, None, record if command == "voltage" else replace(record, voltage=None))
    assert verdict.best.name == "coulomb-viscous"
    # the straight lines between samples of the truth cut corners of the voltage by less than 1 %
    found = intervals(verdict)
    assert found["kinetic_coefficient"].value == pytest.approx(0.05, rel=0.02)
    assert found["viscous_coefficient"].value == pytest.approx(0.02, rel=0.02)


@pytest.mark.slow
def test_friction_that_grows_with_the_torque_of_a_gear_is_named():
    record = commanded(
        "level + weight[transmitted] + viscous",
        kinetic_coefficient=0.02, transmitted_coefficient=0.2, viscous_coefficient=0.02,
    )  # fmt: skip
    verdict = select(SERVO, None, record)
    assert verdict.best.name == "bam-m3"
    assert_holds(
        verdict,
        {"kinetic_coefficient": 0.02, "transmitted_coefficient": 0.2, "viscous_coefficient": 0.02},
    )


@pytest.mark.slow
@pytest.mark.parametrize("given", [0.2, 0.35, 0.6])
def test_a_motor_constant_in_which_forces_are_not_linear_is_found(given):
    record = commanded("level + viscous", kinetic_coefficient=0.05, viscous_coefficient=0.02)
    servo = replace(SERVO, drive=replace(SERVO.drive, torque_constant=given))
    verdict = select(servo, None, record, vary=["friction.*", "mechanism.drive.torque_constant"])
    assert verdict.best.name == "coulomb-viscous"
    assert_holds(
        verdict,
        {"kinetic_coefficient": 0.05, "viscous_coefficient": 0.02, "torque_constant": 0.35},
    )


@pytest.mark.slow
def test_constants_of_a_motor_that_act_as_viscous_friction_are_said_to():
    """Their ratio follows from the voltage; what the back EMF takes is as viscous friction."""
    record = commanded("level + viscous", kinetic_coefficient=0.05, viscous_coefficient=0.02)
    paths = ["mechanism.drive.torque_constant", "mechanism.drive.resistance"]
    verdict = select(SERVO, None, record, vary=["friction.*", *paths])
    assert "torque constant and resistance together cannot be distinguished from viscous" in str(
        verdict.words.cannot_tell
    )
    assert_holds(
        verdict,
        {
            "kinetic_coefficient": 0.05,
            "viscous_coefficient": 0.02,
            "torque_constant": 0.35,
            "resistance": 3.2,
        },
    )


@pytest.mark.slow
def test_mass_and_length_of_a_driven_pendulum_are_found_together():
    t = np.arange(0.0, 20.0, 0.005)
    q = 1.2 * np.sin(1.7 * t) + 0.5 * np.sin(4.1 * t + 1.0)
    v = 1.2 * 1.7 * np.cos(1.7 * t) + 0.5 * 4.1 * np.cos(4.1 * t + 1.0)
    a = -1.2 * 1.7**2 * np.sin(1.7 * t) - 0.5 * 4.1**2 * np.sin(4.1 * t + 1.0)
    mass, length, level = 0.7, 0.5, 0.15
    torque = mass * length**2 * a + 9.81 * mass * length * np.sin(q) + level * np.sign(v)
    noise = np.random.default_rng(3).normal(size=(2, len(t)))
    record = Measurement(time=t, position=q + 2e-4 * noise[0], force=torque + 0.02 * noise[1])
    verdict = select(
        Pendulum(mass=1.4, length=0.8), None, record,
        vary=["friction.*", "mechanism.mass", "mechanism.length"],
    )  # fmt: skip
    assert_holds(verdict, {"mass": mass, "length": length, "kinetic_coefficient": level})


@pytest.mark.parametrize(
    ("gain", "mass", "viscous", "level"), [(10.0, 0.06, 0.25, 0.02), (100.0, 1.0, 4.0, 0.5)]
)
def test_a_controller_of_the_position_passes_for_no_force_and_no_delay(gain, mass, viscous, level):
    """The force is a line over the position: a spring of negative stiffness would explain it."""
    resting, moving = 1000, 3000  # at 1 kHz
    z, v, positions, forces = 0.0, 0.0, [0.0] * resting, [0.0] * resting
    for _ in range(moving):
        seen = 4.84e-5 * round(z / 4.84e-5)
        positions.append(z)
        forces.append(gain * (0.2 - seen))
        for _ in range(10):
            net, way = forces[-1] - viscous * v, np.sign(v or forces[-1])
            after = v + 1e-4 * (net - level * way) / mass
            held = abs(net) <= level and (v == 0.0 or v * after < 0.0)
            v = 0.0 if held else after
            z += 1e-4 * v
    time = 1e-3 * np.arange(len(positions))
    record = Measurement(time=time, position=np.array(positions), force=np.array(forces))
    verdict = select(Axis(inertia=1.0), None, record, vary=["friction.*", "mechanism.inertia"])
    assert verdict.best.name == "coulomb-viscous"
    found = {one.path.rpartition(".")[2]: one for one in verdict.parameters}
    assert found["inertia"].value == pytest.approx(mass, rel=0.005)
    assert found["viscous_coefficient"].value == pytest.approx(viscous, rel=0.05)
    assert found["kinetic_coefficient"].value == pytest.approx(level, rel=0.1)


@pytest.mark.slow
def test_a_cart_is_judged_by_what_its_pendulum_does_to_it():
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pivot_stiffness=2.0, pivot_damping=0.02,
        pendulum=Torque(drive=Square(high=0.5, low=-0.2, period=0.5, duty=0.3)),
    )  # fmt: skip
    t = np.arange(0.0, 3.0, 0.005)
    truth = Coulomb(kinetic_coefficient=0.18, static_coefficient=0.24)
    x = simulate(cart, truth, t_end=3.0).at(t)["x"]
    x = x + 3e-4 * np.random.default_rng(8).normal(size=len(t))
    verdict = select(cart, None, Measurement(time=t, position=x))
    assert verdict.best.name.startswith("coulomb")
    assert_holds(verdict, {"kinetic_coefficient": 0.18})


@pytest.mark.slow
def test_what_moves_inside_is_found_where_it_was_given_wrong():
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pivot_stiffness=2.0, pivot_damping=0.02,
        pendulum=Torque(drive=Square(high=0.5, low=-0.2, period=0.5, duty=0.3)),
    )  # fmt: skip
    t = np.arange(0.0, 3.0, 0.005)
    x = simulate(cart, Coulomb(kinetic_coefficient=0.18), t_end=3.0).at(t)["x"]
    x = x + 3e-4 * np.random.default_rng(8).normal(size=len(t))
    given = replace(cart, length=0.34)
    verdict = select(given, None, Measurement(time=t, position=x), vary=["friction.*", "length"])
    assert_holds(verdict, {"kinetic_coefficient": 0.18, "length": 0.3})


@pytest.mark.slow
def test_a_cart_whose_friction_noise_hides_has_a_band_that_holds_it():
    swing = ThreePhase(amplitude=np.deg2rad(45), fast=120.0, slow=30.0)
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    )
    truth = CoulombViscous(kinetic_coefficient=0.18, viscous_coefficient=0.5)
    t = np.arange(0.0, 4.0 * float(swing.period), 0.01)
    x = simulate(cart, truth, t_end=5.0).at(t)["x"]
    x = x + np.random.default_rng(1).normal(0.0, 3e-4, len(t))
    verdict = select(cart, None, Measurement(time=t, position=x))
    v, band = verdict.speeds, verdict.friction
    load = verdict.judgement.problem.load  # the median under the swing, at which friction is stated
    assert load == pytest.approx(0.6 * 9.81, rel=0.03)
    true = np.sign(v) * 0.18 * load + 0.5 * v
    assert np.all((band.low <= true) & (true <= band.high))


@pytest.mark.slow
def test_pulses_of_both_signs_are_no_force_that_is_clipped():
    t = np.arange(0.0, 12.0, 0.005)
    at = t % 2.0
    force = np.where(at < 0.25, 6.0, np.where((at > 1.0) & (at < 1.25), -6.0, 0.0))
    axis = Axis(inertia=1.5, drive=Sampled(times=tuple(t), values=tuple(force)))
    truth = CoulombViscous(kinetic_coefficient=1.0, viscous_coefficient=0.8)
    x = simulate(axis, truth, t_end=float(t[-1])).at(t)[axis.coordinates[0]]
    x = x + 1e-5 * np.random.default_rng(3).normal(size=len(t))
    verdict = select(
        Axis(inertia=1.0),
        None,
        Measurement(time=t, position=x, force=force),
        vary=["friction.*", "mechanism.inertia"],
    )
    assert verdict.best.name == "coulomb-viscous"
    assert_holds(verdict, {"kinetic_coefficient": 1.0, "viscous_coefficient": 0.8})
    band = verdict.friction
    assert np.median((band.high - band.low) / np.abs(band.median)) < 0.05


@pytest.mark.slow
def test_a_drive_of_the_mechanism_needs_no_record_of_the_force():
    driven = Axis(inertia=2.0, drive=Sine(amplitude=20.0, frequency=0.8))
    t = np.arange(0.0, 8.0, 0.005)
    truth = CoulombViscous(kinetic_coefficient=3.0, viscous_coefficient=4.0)
    x = simulate(driven, truth, t_end=8.0).at(t)["x"]
    x = x + 1e-5 * np.random.default_rng(0).normal(size=len(t))
    verdict = select(driven, None, Measurement(time=t, position=x))
    assert verdict.best.name == "coulomb-viscous"
    assert_holds(verdict, {"kinetic_coefficient": 3.0, "viscous_coefficient": 4.0})


# ---- what is done with a verdict


def test_a_report_has_law_band_and_a_rig_file_that_simulates(verdict, tmp_path):
    page = write_report(verdict, tmp_path / "report", title="Axis").read_text(encoding="utf-8")
    assert "friction is known to ±" in page
    assert "Coulomb + viscous" in page
    rig = load_rig(tmp_path / "report" / "law.toml")
    found = rig.laws[verdict.best.name]
    assert found.kinetic_coefficient == pytest.approx(1.0, rel=0.05)
    assert rig.mechanism.inertia == pytest.approx(INERTIA, rel=0.05)
    run = simulate(
        replace(rig.mechanism, drive=Sine(amplitude=2.0, frequency=1.0)), found, t_end=1.0
    )
    assert run.certificate.certified


def test_laws_drawn_from_the_verdict_of_a_record_lie_in_its_band(verdict):
    laws = [one for one in verdict.sample(60, seed=1) if not one.states]
    assert len(laws) > 10
    at = np.array([float(np.asarray(one.force(1.0, 1.0))) for one in laws])
    band = verdict.band([1.0])
    assert np.mean((at > band.low[0]) & (at < band.high[0])) > 0.9


@pytest.mark.slow
def test_another_record_is_foreseen_with_its_error_beside_that_of_plain_least_squares():
    dip = Stribeck(
        kinetic_coefficient=3.0, static_coefficient=6.0, stribeck_velocity=0.2,
        viscous_coefficient=3.0,
    )  # fmt: skip
    verdict = select(AXIS, None, moved(dip))
    again = moved(dip, seed=9)
    foreseen = verdict.predict(again)
    assert foreseen.inside > 0.9
    assert foreseen.error < 0.7 * foreseen.usual_error
    table = foreseen.to_dataframe()
    assert len(table) == len(foreseen.measured)
    assert ((table["low"] < table["median"]) & (table["median"] < table["high"])).all()
    validated = select(AXIS, None, moved(dip), validate=again)
    assert validated.inside == foreseen.inside
    assert any(
        "Coulomb + viscous friction by least squares" in x for x in validated.words.cannot_tell
    )
    with pytest.raises(InputError, match="identical"):
        verdict.predict(moved(dip))


@pytest.mark.slow
def test_in_one_direction_a_constant_force_is_said_to_be_in_the_level():
    t = np.arange(0.0, 8.0, 0.002)
    v = 0.3 + 0.2 * np.sin(2.1 * t) + 0.08 * np.sin(5.3 * t)
    x = np.concatenate([[0.0], np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))])
    force = 2.0 * np.gradient(v, t) + 5.0 + 3.0 * v + 1.5  # the last is no friction
    noise = np.random.default_rng(5).normal(size=len(t))
    record = Measurement(time=t, position=x, force=force + 0.05 * noise)
    vary = ["friction.*", "mechanism.inertia"]
    verdict = select(Axis(inertia=1.0), None, record, vary=vary)
    assert any("All motion is in one direction" in one for one in verdict.words.cannot_tell)
    held = select(Axis(inertia=1.0), None, record, vary=vary, fixed={"offset": 0.0})
    assert not any("All motion is in one direction" in one for one in held.words.cannot_tell)


@pytest.mark.slow
def test_a_mass_is_found_from_trials_with_other_lengths():
    random, trials = np.random.default_rng(6), []
    t = np.arange(0.0, 10.0, 0.004)
    for length in (0.5, 1.0):
        q = 0.9 * np.sin(1.9 * t + length) + 0.4 * np.sin(4.3 * t)
        v = 0.9 * 1.9 * np.cos(1.9 * t + length) + 0.4 * 4.3 * np.cos(4.3 * t)
        a = -0.9 * 1.9**2 * np.sin(1.9 * t + length) - 0.4 * 4.3**2 * np.sin(4.3 * t)
        torque = 2.0 * (length**2 * a + 9.81 * length * np.sin(q)) + 0.2 * np.sign(v)
        noise = random.normal(size=(2, len(t)))
        trials.append(
            Measurement(
                time=t,
                position=q + 1e-4 * noise[0],
                force=torque + 0.02 * noise[1],
                overrides={"mechanism.length": length},
            )
        )
    verdict = select(
        Pendulum(mass=1.5, length=0.7), None, Measurement(trials=tuple(trials)),
        vary=["friction.*", "mechanism.mass"],
    )  # fmt: skip
    assert_holds(verdict, {"mass": 2.0, "kinetic_coefficient": 0.2})
    (mass,) = (one for one in verdict.parameters if one.path.endswith("mass"))
    assert mass.high - mass.low < 0.1


def test_a_free_swing_that_gives_no_scale_is_refused():
    arm, t = Pendulum(mass=1.0, length=0.5), np.arange(0.0, 20.0, 0.02)
    law_ = CoulombViscous(kinetic_coefficient=0.004, viscous_coefficient=0.003)
    q = simulate(arm, law_, t_end=20.0, y0={"theta": 0.8}).at(t)["theta"]
    record = Measurement(time=t, position=q + 1e-3 * np.random.default_rng(1).normal(size=len(t)))
    with pytest.raises(InputError, match="only friction over inertia"):
        select(arm, None, record, vary=["friction.*", "mechanism.mass", "mechanism.length"])


@pytest.mark.parametrize(
    "seed", [4, *(pytest.param(seed, marks=pytest.mark.slow) for seed in (1, 2, 3))]
)
def test_the_start_of_a_step_tells_friction_of_slow_speeds(seed):
    """A step of the torque: half a second of start, and then a constant speed."""
    inertia, level, viscous = 8e-4, 0.05, 0.0052
    rng, fine = np.random.default_rng(seed), np.linspace(0.0, 4.0, 40_001)
    time, h = np.arange(1334) * 0.003, fine[1]
    torque = (
        0.205 * (fine > 0.004)
        + 0.012 * np.sin(2.0 * np.pi * 9.0 * fine)
        + 0.006 * np.sin(2.0 * np.pi * 31.0 * fine + 1.0)
    )
    speed = np.zeros_like(fine)
    for k in range(len(fine) - 1):
        v, free = speed[k], torque[k] - level
        speed[k + 1] = v + h * (free - viscous * v) / inertia if v > 0.0 or free > 0.0 else 0.0
    turned = np.concatenate([[0.0], np.cumsum(0.5 * h * (speed[1:] + speed[:-1]))])
    own = select(
        Axis(inertia=inertia),
        None,
        Measurement(
            time=time,
            position=np.round(0.4 + np.interp(time, fine, turned), 4),
            velocity=np.interp(time, fine, speed) + rng.normal(0.0, 0.3, len(time)),
            force=np.interp(time, fine, torque) + rng.normal(0.0, 0.02, len(time)),
            turning=True,
        ),
    )
    assert isinstance(own.law, CoulombViscous)
    assert own.judgement.problem.asked().velocity.min() < 3.0
    assert ("level",) not in own.set
    assert own.law.kinetic_coefficient == pytest.approx(level, rel=0.15)
    assert own.law.viscous_coefficient == pytest.approx(viscous, rel=0.06)
    v = np.array([3.0, 10.0, 25.0])
    band = own.band(v)
    assert np.all((band.low < level + viscous * v) & (level + viscous * v < band.high))


@pytest.mark.parametrize("last", [5.0, 6.0])
def test_trials_whose_friction_differs_are_said_to_differ_and_equal_ones_are_not(last):
    random, time = np.random.default_rng(0), 0.005 * np.arange(600)
    trials = []
    for number, level in enumerate((5.0, 5.0, last), 1):
        velocity = 0.3 * np.sin(2.0 * np.pi * (0.7 + 0.1 * number) * time)
        friction = level * np.sign(velocity) + 4.0 * velocity + 0.1 * random.normal(size=600)
        trials.append(Measurement(time=time, velocity=velocity, friction=friction))
    own = select(Axis(inertia=1.0), [CoulombViscous], Measurement(trials=tuple(trials)))
    found = [finding for finding in own.findings if finding.term == "run" and finding.asserted]
    if last == 5.0:
        assert not found
    else:  # the standard deviation of 5, 5 and 6 N over friction of 6 N in the mean
        assert found[0].low < np.std([5.0, 5.0, 6.0]) * np.sqrt(1.5) / 6.0 < found[0].high


@pytest.mark.slow
@pytest.mark.parametrize("gain", [1.0, 1.15])
def test_a_gain_that_inertia_and_spring_show_is_taken_from_friction(gain):
    random, t = np.random.default_rng(3), np.arange(6000) / 800.0
    waves = ((28.0, 0.5, 1.0), (16.0, 1.3, 2.0), (9.0, 3.1, 4.0))
    force = sum(a * np.sin(2.0 * np.pi * f * t + p) for a, f, p in waves)
    rig = Axis(inertia=4.0, stiffness=700.0)
    driven = replace(rig, drive=Sampled(times=t.tolist(), values=force.tolist()))
    law = CoulombViscous(kinetic_coefficient=8.0, viscous_coefficient=20.0)
    x = simulate(driven, law, t_end=float(t[-1])).at(t)["x"] + 1e-6 * random.normal(size=len(t))
    read = gain * force + 0.1 * random.normal(size=len(t))
    own = select(rig, None, Measurement(time=t, position=x, force=read))
    assert ("The recorded force is 1.15 times" in own.words.verdict) == (gain > 1.0)
    band = own.band(np.array([0.05, 0.15]))
    assert np.all((band.low < [9.0, 11.0]) & (band.high > [9.0, 11.0]))
    assert own.law.kinetic_coefficient == pytest.approx(8.0, rel=0.02)
