"""What fits refuse instead of returning numbers that mean nothing."""

import dataclasses

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Measurement,
    RecordSettings,
    SpringBlock,
    TowedBlock,
    TwoMassAxis,
    fit,
    select,
    simulate,
)
from stickslip.errors import InputError, ParameterError
from stickslip.friction import law
from stickslip.identify.problems.record_checks import wrong_sign
from stickslip.identify.problems.record_signals import NotToldError, records_of
from stickslip.mechanisms.drives import Sampled, Sine

AXIS = Axis(inertia=5.0)
TIME = np.arange(2000) / 500
TRUTH = CoulombViscous(kinetic_coefficient=10.0, viscous_coefficient=30.0)


@pytest.fixture(scope="module")
def parts():
    force = 40 * np.sin(2 * np.pi * TIME) + 15 * np.sin(2.3 * TIME)
    drive = Sampled(times=TIME.tolist(), values=force.tolist())
    run = simulate(dataclasses.replace(AXIS, drive=drive), TRUTH, t_end=float(TIME[-1]))
    noise = np.random.default_rng(1).normal(0, 1e-5, TIME.size)
    return {"time": TIME, "position": run.at(TIME)["x"] + noise, "force": force}


@pytest.fixture(scope="module")
def found(parts):
    return fit(AXIS, "coulomb-viscous", Measurement(**parts))


# --- what select refuses, fit refuses


def wrong(parts):
    noise = np.random.default_rng(2).normal(0, 1e-5, TIME.size)
    speed = np.linspace(-1, 1, 200)
    return {
        "Position is constant": Measurement(**{**parts, "position": np.full(TIME.size, 0.1)}),
        "its noise level: no motion": Measurement(**{**parts, "position": noise}),
        "set its gain to −1": Measurement(velocity=speed, friction=-3 * np.sign(speed) - speed),
        "whether the force is missing": Measurement(**{**parts, "force": None}),
        "--unit position=mm": Measurement(**{**parts, "position": 1e3 * parts["position"]}),
        "was measured in": Measurement(
            trials=(Measurement(**parts), Measurement(**{**parts, "force": None}))
        ),
    }


@pytest.mark.parametrize(
    "words",
    [
        "Position is constant", "its noise level: no motion", "set its gain to −1",
        "whether the force is missing",
        "--unit position=mm", "was measured in",
    ],
)  # fmt: skip
def test_fit_and_select_refuse_the_same_records(parts, words):
    record = wrong(parts)[words]
    for verb in (
        lambda: fit(AXIS, CoulombViscous, record),
        lambda: select(AXIS, [Coulomb], record),
    ):
        with pytest.raises(InputError, match=words):
            verb()


def test_a_fault_of_several_trials_is_told_once_after_their_names(parts):
    wrong = {**parts, "position": 1e3 * parts["position"]}
    trials = tuple(Measurement(**wrong, name=name) for name in ("north", "south"))
    with pytest.raises(InputError, match=r"used. north and south: Position changes") as caught:
        fit(AXIS, CoulombViscous, Measurement(trials=trials))
    assert str(caught.value).count("Position changes") == 1
    many = tuple(Measurement(**wrong, name=f"run{i}") for i in range(9))
    with pytest.raises(InputError, match=r"used. all trials: Position changes"):
        fit(AXIS, CoulombViscous, Measurement(trials=many))


@pytest.mark.slow
def test_what_a_check_warns_of_stands_beside_the_fit(parts):
    cut = Measurement(**{**parts, "position": np.clip(parts["position"], -0.02, 0.05)})
    both = ["friction.*", "mechanism.inertia"]
    warned = fit(AXIS, CoulombViscous, cut, vary=both).verdict.checks
    assert any("the sensor is at the end of its range" in str(one) for one in warned.findings)


def test_a_slow_record_is_not_refused_because_its_inertia_comes_out_negative():
    """An axis that creeps says nothing of its mass, and noise decides the sign of a regression."""
    time = np.arange(3000) / 500
    v = 2e-3 * np.sin(2.0 * np.pi * 0.25 * time)
    force = 30.0 * np.sign(v) + 500.0 * v
    position = 2e-3 / (0.5 * np.pi) * (1.0 - np.cos(0.5 * np.pi * time))
    # a force that follows the acceleration with the wrong sign, by a thousandth of it
    force = force - 0.03 * np.cos(0.5 * np.pi * time)
    record = Measurement(time=time, position=position, force=force)
    axis = Axis(inertia=1.0)
    found = fit(
        axis, CoulombViscous, record, vary=["friction.*", "mechanism.inertia"], route="balance"
    )
    # without accelerations, a dead zone of the drive cannot be distinguished from the level
    level = found.estimate("kinetic_coefficient")
    assert level.low < 30.0 < level.high
    reversed_force = Measurement(time=time, position=position, force=-force)
    for looked_for in ([], ["friction.*", "mechanism.inertia"]):
        with pytest.raises(InputError, match="turn the sign of the force"):
            fit(axis, CoulombViscous, reversed_force, vary=looked_for or None)


@pytest.mark.parametrize(
    ("weight", "late", "inertia"), [(40.0, 0.0, 5.0), (0.0, 1e-3, 20.0), (5.0, 0.0, 5.0)]
)
def test_a_reversed_force_is_refused_beside_a_weight_and_late_positions(weight, late, inertia):
    """Neither takes the power of friction: a weight that sinks, nor inertia that is shown late."""
    time = np.arange(8000) / 1000

    def position(t):
        turn = 0.02 * np.sin(2.0 * t) + 0.005 * np.sin(7.0 * t)
        return turn - (0.05 * t if weight > 5.0 else 0.01 * t if weight else 0.0)

    v, a = (np.gradient(x, time) for x in (position(time), np.gradient(position(time), time)))
    force = inertia * a + (3.0 if weight else 0.3) * np.sign(v) + 2.0 * v + weight
    record = Measurement(time=time, position=position(time - late), force=-force)
    unknown = ["friction.*", "mechanism.inertia"]
    with pytest.raises(InputError, match=r"sign of the force|against the motion"):
        fit(Axis(inertia=inertia), CoulombViscous, record, vary=unknown, route="balance")


# --- settings without effect


def test_initial_states_of_a_record_in_time_are_refused(parts):
    record = Measurement(**parts, initial={"x": 5.0, "v": 100.0})
    with pytest.raises(InputError, match=r"initial \(x, v\).* has no effect"):
        fit(AXIS, CoulombViscous, record)
    with pytest.raises(InputError, match=r"initial \(zz\) of the record has no effect"):
        fit(AXIS, CoulombViscous, Measurement(**parts, initial={"zz": 5.0}))


def test_an_uncertainty_of_a_record_is_refused(parts):
    record = Measurement(**parts, uncertainty={"position": 10.0})
    with pytest.raises(InputError, match=r"uncertainty \(position\).* has no effect"):
        fit(AXIS, CoulombViscous, record)


@pytest.mark.parametrize(
    "changes",
    [
        {"starts": 0}, {"starts": 1.5}, {"seed": -3}, {"starts": True},
    ],
)  # fmt: skip
def test_settings_that_mean_nothing_are_refused(changes):
    (name,) = changes
    with pytest.raises(ParameterError, match=rf"RecordSettings\.{name}"):
        RecordSettings(**changes)


# --- a second record


def test_a_second_record_must_have_what_the_first_has(parts, found):
    bare = Measurement(**{**parts, "force": None})
    with pytest.raises(InputError, match=r"the other measurement has no force"):
        found.predict(bare)
    with pytest.raises(InputError, match=r"the second record has no force"):
        select(AXIS, [Coulomb], found.measurement, validate=bare)


# --- loads


@pytest.mark.slow
def test_a_measured_load_takes_the_place_of_the_mechanism_s(parts, found):
    loaded = fit(AXIS, CoulombViscous, Measurement(**parts, load=5.0))
    # levels are per unit load: the same friction force is a fifth of the coefficient
    level = found.law.kinetic_coefficient
    assert loaded.law.kinetic_coefficient == pytest.approx(level / 5.0, rel=1e-3)
    even = Measurement(**parts, load=np.full(TIME.size, 6.0), offset={"load": 1.0})
    again = fit(AXIS, CoulombViscous, even)
    assert again.law.kinetic_coefficient == pytest.approx(level / 5.0, rel=1e-3)
    assert loaded.mechanism.load == again.mechanism.load == 5.0


def test_trials_have_each_their_own_load():
    trials, axis = [], Axis(inertia=5.0)
    force = 40 * np.sin(2 * np.pi * TIME)
    drive = Sampled(times=TIME.tolist(), values=force.tolist())
    law = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=10.0)
    for load in (2.0, 6.0):
        rig = dataclasses.replace(axis, drive=drive, load=load)
        run = simulate(rig, law, t_end=float(TIME[-1]))
        x = run.at(TIME)["x"]
        trials.append(Measurement(time=TIME, position=x, force=force, load=load))
    found = fit(axis, CoulombViscous, Measurement(trials=tuple(trials)))
    # without noise; reversals are known to some samples
    level = found.estimate("kinetic_coefficient")
    assert level.low <= 2.0 <= level.high
    assert level.value == pytest.approx(2.0, rel=0.03)
    assert found.mechanism.load == 4.0


@pytest.mark.parametrize(
    ("mechanism", "load", "message"),
    [
        (AXIS, -5.0, "must be above 0 N"),
        (SpringBlock(mass=5.0), 5.0, "SpringBlock follows from its own parameters, 49.05 N"),
    ],
)
def test_a_load_that_no_balance_can_take_is_refused(parts, mechanism, load, message):
    with pytest.raises(InputError, match=message):
        fit(mechanism, CoulombViscous, Measurement(**parts, load=load))


def test_a_load_that_is_given_twice_is_refused(parts):
    record = Measurement(**parts, load=5.0, overrides={"mechanism.load": 6.0})
    with pytest.raises(InputError, match="given twice: 5 N measured, and 6 N in overrides"):
        fit(AXIS, CoulombViscous, record)


@pytest.mark.slow
@pytest.mark.parametrize("of", ["motor", "position"])
def test_a_law_of_what_fits_do_not_follow_is_refused(parts, of):
    kind, record = law(f"level + weight[{of}]"), Measurement(**parts)
    message = f"depends on the contact input '{of}', which fits"
    with pytest.raises(InputError, match=message):
        fit(AXIS, kind, record)
    with pytest.raises(InputError, match=message):
        select(AXIS, [kind], record)


def constant_push(count=300, rate=200.0):
    """Return a record of an axis under one force, which it never changes."""
    t = np.arange(count) / rate
    speed = 0.4 * (1.0 - np.exp(-7.0 * t))  # of 5 kg, 10 N and 35 N s/m under 24 N
    return Measurement(time=t, position=np.cumsum(speed) / rate, force=np.full(count, 24.0))


def test_a_mass_is_not_looked_for_under_a_constant_force():
    # without it all friction is that force: a mass of 0 and 24 N of friction leave nothing
    with pytest.raises(
        InputError, match=r"mechanism\.inertia: the force that moves the body never"
    ):
        fit(
            Axis(inertia=4.0), "coulomb", constant_push(), vary=["friction.*", "inertia"],
            route="balance",
        )  # fmt: skip
    found = fit(Axis(inertia=5.0), "coulomb-viscous", constant_push(), route="balance")
    assert found.estimates[0].value == pytest.approx(10.0, rel=0.02)


@pytest.mark.parametrize(("stiffness", "late"), [(0.0, 0.02), (1e4, 0.005), (1e4, -0.005)])
def test_a_late_force_of_inertia_or_of_a_spring_is_no_reversed_one(stiffness, late):
    """Late forces have a part that drives, by more than friction brakes."""
    time = np.arange(0.0, 8.0, 1e-3)
    parts = ((0.05, 0.3), (0.02, 0.8))
    position = sum(a * np.sin(2.0 * np.pi * f * time) for a, f in parts)
    v = np.gradient(position, time)
    force = np.gradient(v, time) + stiffness * position + 0.2 * np.sign(v) + 0.1 * v
    force = np.interp(time + late, time, force)
    record = Measurement(time=time, position=position, force=force)
    axis = Axis(inertia=1.0, stiffness=stiffness)
    for unknown in (["mechanism.inertia"], []):
        assert not wrong_sign(records_of(axis, record, unknown=unknown))


def test_friction_against_the_pull_is_refused():
    t = np.arange(200.0)
    pull = np.interp(t, [0.0, 100.0, 199.0], [0.0, 1e-4, 1.09e-3])
    record = Measurement(time=t, pull=pull, friction=np.full(200, -0.6), load=1.0)
    machine = TowedBlock(mass=1e-3, stiffness=2e3, speed=1e-6, load=1.0)
    with pytest.raises(
        InputError, match=r"mean coefficient of friction is −0\.6 and must be above"
    ):
        fit(machine, "rate-and-state", record)


@pytest.mark.parametrize(
    ("law", "choice", "cause"),
    [
        ("lugre", {"fixed": {"viscous_coefficient": 30.0}}, r"viscous_coefficient cannot be held"),
        ("elasto-plastic", {}, r"tell Dahl and LuGre friction: fit one of these"),
    ],
)
def test_a_law_with_states_is_refused_with_the_cause(parts, law, choice, cause):
    with pytest.raises(NotToldError, match=cause):
        fit(AXIS, law, Measurement(**parts), **choice)


@pytest.mark.slow
def test_states_that_a_drive_without_a_recorded_force_does_not_show_are_refused():
    shaken = Axis(inertia=2.0, drive=Sine(amplitude=8.0, frequency=0.7), load=10.0)
    run = simulate(shaken, Coulomb(kinetic_coefficient=0.18), t_end=3.0)
    t = np.arange(0.0, 3.0, 0.01)
    x = run.at(t)["x"] + 2e-4 * np.random.default_rng(1).normal(size=t.size)
    with pytest.raises(NotToldError, match=r"in time of a force that drives the motion"):
        fit(shaken, "lugre", Measurement(time=t, position=x))


# --- what is fitted nevertheless


def test_the_encoder_of_one_of_two_masses_tells_friction():
    axis = TwoMassAxis(motor_inertia=1.0, load_inertia=2.0, stiffness=50.0)
    drive, t = Sine(amplitude=8.0, frequency=0.7), np.arange(0.0, 3.0, 0.01)
    run = simulate(
        dataclasses.replace(axis, drive=drive), Coulomb(kinetic_coefficient=1.0), t_end=3.0
    )
    x = run.at(t)["x"] + 1e-4 * np.random.default_rng(0).normal(size=t.size)
    force = 8.0 * np.sin(2.0 * np.pi * 0.7 * t)
    found = fit(axis, "coulomb", Measurement(time=t, position=x, force=force))
    (level,) = found.estimates
    assert level.low <= 1.0 <= level.high
    assert level.high - level.low < 0.3
