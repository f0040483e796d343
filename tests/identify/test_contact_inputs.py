"""Fits of laws with contact inputs: told by the mechanism, a column, or a condition of a trial."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.several.brakes import DiscBrake, Lining

from stickslip import Axis, Measurement, Pendulum, fit, select, simulate
from stickslip.errors import InputError
from stickslip.friction import Laws, bound, law
from stickslip.identify.fits.contact_inputs import (
    as_informed,
    inputs_along,
    known_inputs,
    typical_inputs,
    with_inputs,
)
from stickslip.mechanisms import given_inputs, given_names
from stickslip.mechanisms.drives import Sampled, Sine, Sum

WARM = law("level + viscous * exponential[temperature]")
GEAR = law("level + stribeck + weight[transmitted] + viscous")
TRUE_WARM = WARM(kinetic_coefficient=0.5, viscous_coefficient=0.9, viscous_temperature_decay=0.03)
TRUE_GEAR = GEAR(
    kinetic_coefficient=0.04,
    static_coefficient=0.07,
    stribeck_velocity=0.15,
    transmitted_coefficient=0.12,
    viscous_coefficient=0.06,
)
INERTIA, TORQUE = 0.02, 0.8
LENGTH = INERTIA * 9.81 / TORQUE
SERVO = Pendulum(mass=INERTIA / LENGTH**2, length=LENGTH, gravity=9.81)
TABLE = Axis(inertia=1.0)

T = np.arange(0.0, 40.0, 0.02)
V = 0.6 * np.cos(1.3 * T) + 0.3 * np.cos(2.9 * T)
X = 0.6 / 1.3 * np.sin(1.3 * T) + 0.3 / 2.9 * np.sin(2.9 * T)
WARMING = 20.0 + 0.5 * T


def noise(size, seed=1):
    return np.random.default_rng(seed).normal(0.0, size, len(T))


def friction(temperature, seed=1):
    """Return what a sensor of friction shows under a load of 2 N."""
    true = bound(TRUE_WARM, {"temperature": temperature})
    return true.force(V, np.full_like(V, 2.0)) + noise(0.01, seed)


def holds(found, name, value):
    """Whether the interval of an estimate has the true value, and is no wider than half of it.

    Runs may differ by percents, which the warming of one or three of them cannot average out.
    """
    estimate = found.estimate(name)
    return estimate.low <= value <= estimate.high and estimate.high - estimate.low < 0.5 * value


@pytest.mark.slow
def test_a_temperature_column_beside_measured_friction_is_a_covariate_of_the_law():
    record = Measurement(
        time=T, position=X, friction=friction(WARMING), load=2.0, inputs={"temperature": WARMING}
    )
    found = fit(TABLE, WARM, record)
    assert holds(found, "viscous_temperature_decay", 0.03)
    assert holds(found, "viscous_coefficient", 0.9)
    assert "is the median, 30 °C" in found.remarks[0]
    assert found.mechanism.contact_temperature == pytest.approx(30.0, abs=0.1)


def test_a_table_of_friction_may_have_a_column_of_an_input():
    rows = slice(None, None, 5)
    table = Measurement(
        velocity=V[rows], friction=friction(WARMING)[rows], load=2.0,
        inputs={"temperature": WARMING[rows]},
    )  # fmt: skip
    assert holds(fit(TABLE, WARM, table), "viscous_temperature_decay", 0.03)


def test_conditions_of_trials_are_inputs():
    trials = tuple(
        Measurement(
            name=f"at {one}", velocity=V[::5], friction=friction(one, seed)[::5], load=2.0,
            conditions={"temperature [K]": one + 273.15},
        )
        for seed, one in enumerate((15.0, 30.0, 50.0))
    )  # fmt: skip
    assert holds(fit(TABLE, WARM, Measurement(trials=trials)), "viscous_temperature_decay", 0.03)


@pytest.mark.slow
def test_a_constant_input_is_said_and_its_parameter_gets_no_interval():
    record = Measurement(
        time=T, position=X, friction=friction(30.0), load=2.0, inputs={"temperature": 30.0}
    )
    found = fit(TABLE, WARM, record)
    assert "The temperature is constant in this record: its effect cannot be told." in (
        found.sentences
    )
    for name in ("viscous_temperature_decay", "viscous_coefficient"):
        assert not found.estimate(name).bounded
    assert found.estimate("kinetic_coefficient").bounded


def test_bristles_that_change_with_a_temperature_are_refused():
    record = Measurement(
        time=T, position=X, friction=friction(WARMING), load=2.0, inputs={"temperature": WARMING}
    )
    with pytest.raises(InputError, match=r"beside exponential\[temperature\]: fit Dahl or LuGre"):
        fit(TABLE, law("dahl(level * exponential[temperature])"), record)


@pytest.mark.slow
def test_bristles_are_followed_where_the_temperature_stays():
    kind = law("dahl(level)")
    true = kind(kinetic_coefficient=0.5, bristle_stiffness=50.0)
    z, forces, parts = 0.0, [], 10
    for t, v in zip(T, V, strict=True):
        forces.append(true.force(v, 2.0, (z,)))
        for part in range(parts):  # explicit midpoints, 2 ms apart: presliding takes 10 mm
            at = t + 0.02 * (part + 0.5) / parts
            here = 0.6 * np.cos(1.3 * at) + 0.3 * np.cos(2.9 * at)
            h = 0.02 / parts
            middle = z + 0.5 * h * true.rates(here, 2.0, (z,))[0]
            z += h * true.rates(here, 2.0, (middle,))[0]
    record = Measurement(
        time=T, position=X, friction=np.array(forces) + noise(0.005), load=2.0,
        inputs={"temperature": 30.0},
    )  # fmt: skip
    assert holds(fit(TABLE, kind, record), "bristle_stiffness", 50.0)


def test_a_missing_input_is_one_error_with_law_input_and_columns():
    record = Measurement(time=T, position=X, friction=friction(30.0), load=2.0)
    words = (
        rf"{WARM.name} depends on the contact input"
        r" 'temperature'.*columns of the record: position, friction, load.*--columns temperature="
    )
    with pytest.raises(InputError, match=words):
        fit(TABLE, WARM, record)
    with pytest.raises(InputError, match=words):
        select(TABLE, ["coulomb", WARM], record)


def test_an_input_that_only_some_trials_have_is_missing():
    first = Measurement(
        name="one", velocity=V, friction=friction(30.0), load=2.0, inputs={"temperature": 30.0}
    )
    second = Measurement(name="two", velocity=V, friction=friction(30.0), load=2.0)
    with pytest.raises(InputError, match="only 1 of 2 trials have it"):
        fit(TABLE, WARM, Measurement(trials=(first, second)))


def test_a_second_record_needs_the_inputs_too():
    told = Measurement(
        time=T, position=X, friction=friction(WARMING), load=2.0, inputs={"temperature": WARMING}
    )
    bare = Measurement(time=T, position=X, friction=friction(WARMING, 7), load=2.0)
    with pytest.raises(InputError, match="depends on the contact input 'temperature'"):
        select(TABLE, ["coulomb", WARM], told, validate=bare)


def test_a_torque_that_follows_from_a_force_which_nobody_measured_is_missing():
    record = Measurement(time=T, position=X, friction=friction(30.0), turning=True)
    with pytest.raises(InputError, match="tells it by a force or motion that was not measured"):
        fit(SERVO, GEAR, record)


@pytest.fixture(scope="module")
def servo():
    """Return a record of a servo that lifts a pendulum, under a torque that is held 2 ms each."""
    t = np.arange(0.0, 12.0, 0.002)
    push = Sum(parts=(Sine(amplitude=1.1, frequency=0.25), Sine(amplitude=0.45, frequency=0.9)))
    torque = np.array([push.value(moment) for moment in t])
    rig = Pendulum(
        mass=SERVO.mass, length=LENGTH, gravity=9.81, drive=Sampled(times=t, values=torque)
    )
    seen = simulate(rig, TRUE_GEAR, t_end=float(t[-1])).at(t)["theta"]
    angle = seen + np.random.default_rng(3).normal(0.0, 1e-5, len(t))
    return Measurement(time=t, position=angle, force=torque, turning=True)


@pytest.mark.slow
def test_the_transmitted_torque_of_a_servo_is_found_by_inverse_dynamics(servo):
    found = fit(SERVO, GEAR, servo)
    for name in ("transmitted_coefficient", "viscous_coefficient"):
        assert holds(found, name, getattr(TRUE_GEAR, name))
    for name in GEAR.fit_order:
        own = found.estimate(name)
        assert own.low <= getattr(TRUE_GEAR, name) <= own.high
    # the two slow strokes each way do not tell how far friction falls: a level may be below any
    level = found.estimate("kinetic_coefficient")
    assert level.value == pytest.approx(TRUE_GEAR.kinetic_coefficient, rel=0.05)
    assert level.high < 1.1 * TRUE_GEAR.kinetic_coefficient


@pytest.mark.slow
def test_a_law_with_the_transmitted_torque_is_selected_against_those_without(servo):
    names = ["coulomb-viscous", "level + weight[transmitted] + viscous"]
    verdict = select(SERVO, names, servo)
    assert verdict.best is not None
    assert verdict.best.law.inputs == ("transmitted",)


@pytest.fixture(scope="module")
def warming():
    """Return a record of an axis that warms up, and its rig."""
    t = np.arange(0.0, 30.0, 0.004)
    force = 12.0 * np.sin(2.2 * t) + 6.0 * np.sin(5.7 * t + 0.4)
    temperature = 22.0 + 18.0 * (1.0 - np.exp(-t / 12.0))
    true = WARM(kinetic_coefficient=2.5, viscous_coefficient=14.0, viscous_temperature_decay=0.025)
    axis = Axis(inertia=5.0, stiffness=30.0, drive=Sampled(times=t, values=force))
    told = given_inputs(axis, {"temperature": Sampled(times=t, values=temperature, hold="first")})
    x = simulate(told, true, t_end=float(t[-1])).at(t)["x"]
    return Measurement(
        time=t, position=x + np.random.default_rng(2).normal(0.0, 2e-6, len(t)), force=force,
        inputs={"temperature": temperature},
    )  # fmt: skip


@pytest.mark.slow
def test_the_hold_of_a_force_is_told_beside_friction_that_warms(warming):
    found = fit(Axis(inertia=5.0, stiffness=30.0), WARM, warming)
    assert holds(found, "viscous_temperature_decay", 0.025)
    assert holds(found, "viscous_coefficient", 14.0)


def test_inputs_are_those_of_the_mechanism_then_of_the_record_then_given_ones():
    time = np.array([0.0, 1.0])
    record = Measurement(
        time=time, position=[0.0, 0.1], inputs={"temperature": [20.0, 30.0], "motor": 9.0}
    )
    axis = given_inputs(Axis(inertia=1.0), {"temperature": 5.0, "pressure": 7.0})
    found = inputs_along(axis, record, time, position=time, velocity=time, force=2.0)
    assert found["motor"].tolist() == [2.0, 2.0]
    assert found["temperature"].tolist() == [20.0, 30.0]
    assert found["pressure"].tolist() == [7.0, 7.0]


def test_curves_are_drawn_at_the_median_size_of_forces(servo):
    typical = typical_inputs(TRUE_GEAR, SERVO, servo)
    external = -TORQUE * np.sin(np.asarray(servo.position))
    wanted = np.median(np.abs(np.asarray(servo.force) - external))
    assert typical["transmitted"] == pytest.approx(wanted, rel=1e-9)
    assert as_informed(TRUE_GEAR, SERVO, servo) == (SERVO, ())


@pytest.fixture(scope="module")
def warm_arm():
    """Return an arm whose shoulder warms up, and its record without the temperature."""
    from stickslip import TwoLinkArm
    from stickslip.engine.formulation import JointTorques

    arm = TwoLinkArm(
        upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
        lower_mass=0.5, lower_centre=0.2, lower_inertia=0.03, gravity=0.0,
    )  # fmt: skip
    t = np.linspace(0.0, 20.0, 4001)
    places = np.column_stack([np.sin(5.0 * t), 0.8 * np.sin(7.3 * t)])
    rates = np.column_stack([5.0 * np.cos(5.0 * t), 0.8 * 7.3 * np.cos(7.3 * t)])
    forces, _ = JointTorques.of(arm, []).along(arm, t, places, rates, places * [-25.0, -(7.3**2)])
    temperature = 20.0 + 1.5 * t
    true = WARM(kinetic_coefficient=0.3, viscous_coefficient=0.2, viscous_temperature_decay=0.03)
    forces[:, 0] += bound(true, {"temperature": temperature}).force(rates[:, 0], 1.0)
    forces += np.random.default_rng(0).normal(0.0, 0.005, forces.shape)
    record = Measurement(
        time=t, position={"shoulder": places[:, 0], "elbow": places[:, 1]},
        force={"shoulder": forces[:, 0], "elbow": forces[:, 1]}, turning=True,
    )  # fmt: skip
    return arm, record, temperature


@pytest.mark.slow
@pytest.mark.parametrize("shared", [True, False])
def test_joints_share_the_temperature_of_their_record_or_have_their_own(warm_arm, shared):
    arm, record, temperature = warm_arm
    # that of the elbow, which rubs as it does at any temperature, tells nothing of the shoulder
    by_joint = {"shoulder": temperature, "elbow": 60.0 - temperature}
    told = replace(record, inputs={"temperature": temperature if shared else by_joint})
    laws = {"shoulder": WARM, "elbow": "coulomb"}
    found = fit(arm, laws, told)
    (decay,) = [estimate for estimate in found.estimates if estimate.path.endswith("_decay")]
    assert decay.low <= 0.03 <= decay.high < 0.033
    for without in ({}, {"temperature": {"elbow": temperature}}):
        with pytest.raises(InputError, match="depends on the contact input 'temperature'"):
            fit(arm, laws, replace(record, inputs=without))


def test_a_contact_that_slips_by_a_combination_is_told_the_temperature():
    brake = DiscBrake(inertia=0.5, pads=(Lining(radius=0.1, load=10.0),))
    record = Measurement(time=[0.0, 1.0], position=[0.0, 0.1], inputs={"temperature": 20.0})
    assert with_inputs(brake, record, np.zeros(1)).contact_temperature == 20.0
    assert as_informed(TRUE_WARM, brake, record)[0].contact_temperature == 20.0


def test_the_force_of_the_drive_is_not_known_where_only_friction_was_measured():
    read = Measurement(time=T, position=X, friction=0.0 * T, inputs={"external": 0.0 * T})
    assert {*known_inputs(TABLE, read)} == {"position", "external"}
    both = replace(read, inputs={"motor": 0.0 * T, **read.inputs})
    assert {*known_inputs(TABLE, both)} == {"position", "external", "motor", "transmitted"}


def test_runs_of_a_fit_have_the_temperature_of_each_joint(warm_arm):
    arm, record, temperature = warm_arm
    told = replace(record, inputs={"temperature": {"shoulder": temperature, "elbow": 30.0}})
    own = WARM(kinetic_coefficient=0.3, viscous_coefficient=0.2, viscous_temperature_decay=0.03)
    laws = Laws(members=(("shoulder", own), ("elbow", own)))
    assert known_inputs(arm, told)[-1] == "temperature"
    warm, said = as_informed(laws, arm, told)
    assert given_names(warm, "shoulder") == given_names(warm, "elbow") == ("temperature",)
    assert warm.contact_elbow_temperature == 30.0
    assert warm.contact_shoulder_temperature == pytest.approx(35.0)
    (sentence,) = said
    assert "The temperature of the shoulder was measured and varies, 20" in sentence
    along = with_inputs(arm, told, told.time)
    assert along.drives()["contact_shoulder_temperature"].value(10.0) == pytest.approx(35.0)


@pytest.fixture(scope="module")
def gears():
    """Return an arm with gears, its laws, and a record under torques that are held 5 ms each."""
    from stickslip import TwoLinkArm

    t = np.arange(0.0, 16.0, 0.005)
    push = {"shoulder_drive": [(2.0, 0.31), (1.1, 0.83)], "elbow_drive": [(0.8, 0.43), (0.5, 1.07)]}
    torques = {
        name: sum(a * np.sin(2.0 * np.pi * f * t) for a, f in parts) for name, parts in push.items()
    }
    bare = TwoLinkArm(
        upper_mass=0.6, upper_length=0.2, upper_centre=0.1, upper_inertia=0.012,
        lower_mass=0.5, lower_centre=0.1, lower_inertia=0.01,
    )  # fmt: skip
    driven = replace(
        bare, **{name: Sampled(times=t, values=values) for name, values in torques.items()}
    )
    laws = {
        "shoulder": JOINT_GEAR(
            kinetic_coefficient=0.1, transmitted_coefficient=0.08, viscous_coefficient=0.1
        ),
        "elbow": JOINT_GEAR(
            kinetic_coefficient=0.04, transmitted_coefficient=0.15, viscous_coefficient=0.03
        ),
    }
    run = simulate(driven, laws, t_end=float(t[-1]))
    noise = np.random.default_rng(5)
    seen = run.at(t)
    record = Measurement(
        time=t,
        position={x: seen[x] + noise.normal(0.0, 1e-5, len(t)) for x in bare.coordinates},
        force={name.removesuffix("_drive"): values for name, values in torques.items()},
        turning=True,
    )
    return bare, laws, record


JOINT_GEAR = law("level + weight[transmitted] + viscous")


@pytest.mark.slow
def test_the_torques_that_the_gears_of_an_arm_transmit_are_inputs_of_its_joints(gears):
    bare, laws, record = gears
    found = fit(bare, dict.fromkeys(laws, JOINT_GEAR), record)
    for contact, true in laws.items():
        for name in ("transmitted_coefficient", "kinetic_coefficient", "viscous_coefficient"):
            (estimate,) = [e for e in found.estimates if e.path == f"friction.{contact}.{name}"]
            # half of a 95 % interval, twice; some 3 % of the value for what grows with the torque,
            # beside which a level is a quarter of friction, and known to a quarter as well
            assert abs(estimate.value - getattr(true, name)) < estimate.high - estimate.low
            widest = 0.15 if name == "kinetic_coefficient" else 0.05
            assert estimate.high - estimate.low < widest * estimate.value
    plain = fit(bare, dict.fromkeys(laws, "coulomb-viscous"), record)
    for joint in laws:  # what laws leave of friction, over what is allowed
        own, other = (x.joints[joint].judgement.named.excess for x in (found, plain))
        assert own < 0.5 * other


@pytest.mark.slow
def test_a_torque_that_a_gear_transmits_changes_with_a_mass_that_is_fitted(gears):
    bare, laws, record = gears
    kinds = dict.fromkeys(laws, JOINT_GEAR)
    guessed = replace(bare, lower_mass=0.8)
    asked = ["friction.*", "lower_mass"]
    found = fit(guessed, kinds, record, vary=asked)
    for path, true in (
        ("mechanism.lower_mass", 0.5),
        ("friction.shoulder.transmitted_coefficient", 0.08),
        ("friction.elbow.transmitted_coefficient", 0.15),
    ):
        (estimate,) = [e for e in found.estimates if e.path == path]
        assert abs(estimate.value - true) < estimate.high - estimate.low < 0.1 * true
    other = fit(bare, kinds, record, vary=asked)
    # of two ends of searches, to a tenth of an interval
    for one, again in zip(found.estimates, other.estimates, strict=True):
        assert again.value == pytest.approx(one.value, abs=0.1 * (one.high - one.low))
