"""Records of mechanisms that drive themselves: position alone, the drive known."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.support import quick

from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    Measurement,
    PendulumCart,
    check,
    fit,
    select,
    simulate,
)
from stickslip.errors import InputError
from stickslip.identify.problems.driven_runs import DrivenProblem
from stickslip.mechanisms import Prescribed, Torque
from stickslip.mechanisms.drives import Sine, Square, ThreePhase

TRUTH = Coulomb(kinetic_coefficient=0.18, static_coefficient=0.24)
SMOOTH = Coulomb(kinetic_coefficient=0.18)
SWING = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
STROKE = ThreePhase(amplitude=0.01, fast=50.0, slow=9.0, first="slow")
KICKS = Square(high=6.0, low=-1.0, period=0.4, duty=0.3)
TURNS = Square(high=0.5, low=-0.2, period=0.5, duty=0.3)
CART = {"cart_mass": 0.5, "ball_mass": 0.1, "length": 0.3}
CAPSULE = {"capsule_mass": 0.8, "inner_mass": 0.2}
# mechanism, length of the record [s], sampling [Hz], noise [m]
CASES = {
    "swing": (PendulumCart(**CART, pendulum=Prescribed(profile=SWING)), 3.6, 200.0, 3e-4),
    "stroke": (Capsule(**CAPSULE, drive=Prescribed(profile=STROKE)), 1.2, 500.0, 1e-4),
    "kicks": (
        Capsule(**CAPSULE, stiffness=80.0, damping=0.8, drive=Torque(drive=KICKS)),
        3.0, 100.0, 3e-4,
    ),
    "torque": (
        PendulumCart(
            **CART, pivot_stiffness=2.0, pivot_damping=0.02, pendulum=Torque(drive=TURNS)
        ),
        3.0, 200.0, 3e-4,
    ),
}  # fmt: skip


def record(mechanism, length, rate, noise, *, law=TRUTH, y0=None, first=0.0, seed=1):
    """Return what a camera would see of a run."""
    run = simulate(mechanism, law, t_end=length, y0=y0)
    t = np.arange(first, length, 1.0 / rate)
    x = run.at(t)["x"] + noise * np.random.default_rng(seed).normal(size=t.size)
    return Measurement(time=t, position=x)


def fitted(mechanism, measurement, *others):
    return fit(mechanism, Coulomb, measurement, vary=["kinetic_coefficient", *others])


def runs_of(found):
    """Return the runs that a fit was made from."""
    assert isinstance(found.judgement.problem, DrivenProblem)
    return found.judgement.problem.following


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    quick(CASES, "stroke"),  # the tests below have the others
)
def test_the_position_alone_tells_the_friction_of_a_driven_cart_or_capsule(name):
    mechanism, length, rate, noise = CASES[name]
    found = fitted(mechanism, record(mechanism, length, rate, noise))
    level = found.estimate("kinetic_coefficient")
    assert level.low <= 0.18 <= level.high  # 95 %: seeds are fixed
    # a swing tells masses and length, which may not be as given, by their ratio alone
    assert level.high - level.low < (0.03 if name == "swing" else 0.02)
    # nothing but the sensor's noise is left, within the scatter of a few hundred rows
    assert runs_of(found).error == pytest.approx(noise, rel=0.15)


@pytest.mark.parametrize("name", ["swing", "stroke"])
def test_a_cart_that_goes_one_way_is_nothing_to_correct(name):
    """No force was measured whose zero a level could be confused with."""
    mechanism, length, rate, noise = CASES[name]
    seen = record(mechanism, length, rate, noise)
    (finding,) = check(seen, mechanism=mechanism).of("reversals")
    assert (finding.severity, finding.sentence) == (
        "info",
        "No reversals: the motion goes forward only.",
    )
    pushed = replace(seen, force=np.zeros_like(seen.position))
    (other,) = check(pushed, mechanism=mechanism).of("reversals")
    assert other.severity == "warning"
    assert "offset" in other.sentence
    # nor is it the offset of an axis, which fits look for
    sliding = Measurement(time=seen.time, position=np.asarray(seen.time) ** 2)
    (third,) = check(sliding, mechanism=Axis(inertia=1.0)).of("reversals")
    assert third.severity == "warning"


@pytest.mark.slow
def test_a_record_that_begins_later_is_compared_where_it_begins():
    mechanism, length, rate, noise = CASES["swing"]
    late = record(mechanism, length, rate, noise, first=1.3)
    found = fitted(mechanism, late)
    assert found.law.kinetic_coefficient == pytest.approx(0.18, abs=0.002)
    assert runs_of(found).error == pytest.approx(noise, rel=0.15)


@pytest.mark.slow
def test_what_is_inside_begins_where_the_record_says():
    mechanism, length, rate, noise = CASES["kicks"]
    start = {"xi": 0.03, "xi_dot": -0.2}
    seen = record(mechanism, length, rate, noise, y0=start)
    told = fitted(mechanism, replace(seen, initial=start))
    assert told.law.kinetic_coefficient == pytest.approx(0.18, abs=0.003)
    assert runs_of(told).error == pytest.approx(noise, rel=0.15)
    with pytest.raises(InputError, match=r"initial \(x\)"):
        fitted(mechanism, replace(seen, initial={"x": 0.1, **start}))


@pytest.mark.slow
def test_a_start_of_what_is_inside_that_nobody_states_is_unknown():
    mechanism, length, rate, noise = CASES["kicks"]
    found = fitted(
        mechanism, record(mechanism, length, rate, noise, y0={"xi": 0.03, "xi_dot": -0.2})
    )
    level = found.estimate("kinetic_coefficient")
    assert level.low <= 0.18 <= level.high
    assert level.high - level.low < 0.01
    assert runs_of(found).error == pytest.approx(noise, rel=0.15)


@pytest.mark.slow
def test_trials_with_other_drives_are_fitted_together():
    mechanism, _, rate, noise = CASES["kicks"]
    path = "mechanism.drive.drive.period"
    held = []
    for seeds in ((2, 3), (4, 5), (6, 7)):
        parts = []
        for seed, period in zip(seeds, (0.3, 0.45), strict=True):
            own = replace(mechanism, drive=Torque(drive=replace(KICKS, period=period)))
            seen = record(own, 2.0, rate, noise, seed=seed)
            parts.append(replace(seen, overrides={path: period}))
        found = fitted(mechanism, Measurement(trials=tuple(parts)))
        level = found.estimate("kinetic_coefficient")
        held.append(level.low <= 0.18 <= level.high)
        assert level.value == pytest.approx(0.18, abs=0.005)
        assert level.high - level.low < 0.006
        assert runs_of(found).error == pytest.approx(noise, rel=0.15)
    # of three intervals of 95 % one misses in one of seven, two in one of 140
    assert sum(held) >= 2


@pytest.mark.slow
def test_a_number_of_the_drive_may_be_looked_for_too():
    mechanism, length, rate, noise = CASES["kicks"]
    seen = record(mechanism, length, rate, noise)
    wrong = replace(mechanism, drive=Torque(drive=replace(KICKS, high=5.0)))
    found = fitted(wrong, seen, "high")
    push, level = found.estimate("high"), found.estimate("kinetic_coefficient")
    assert push.low <= 6.0 <= push.high
    assert push.high - push.low < 0.2
    # wider than with the push known: a harder one against more friction goes as far
    assert level.low <= 0.18 <= level.high
    assert level.high - level.low < 0.02


SHAKEN = Axis(inertia=2.0, drive=Sine(amplitude=8.0, frequency=0.7), load=10.0)


@pytest.mark.parametrize("pushes", [0.0, 0.5])
def test_runs_tell_friction_of_an_axis_that_drives_itself_beside_a_constant_force(pushes):
    seen = record(replace(SHAKEN, offset=pushes), 3.0, 100.0, 2e-4, law=SMOOTH)
    found = fitted(SHAKEN, seen)
    level, constant = found.estimates
    assert level.low <= 0.18 <= level.high
    assert level.high - level.low < 0.001
    assert constant.low <= pushes <= constant.high
    assert constant.high - constant.low < 0.005
    assert found.mechanism.offset == constant.value
    assert runs_of(found).error == pytest.approx(2e-4, rel=0.15)


@pytest.mark.slow
@pytest.mark.parametrize(("force", "seed"), [(2.4, 2), (2.2, 3)])
def test_a_level_at_rest_that_is_higher_leaves_the_kinetic_one_where_it_is(force, seed):
    """The axis rests most of the time, so that breaking away decides where it slips."""
    mechanism = replace(SHAKEN, drive=Sine(amplitude=force, frequency=0.7))
    law = Coulomb(kinetic_coefficient=0.18, static_coefficient=0.2)
    found = fitted(mechanism, record(mechanism, 4.0, 100.0, 2e-4, law=law, seed=seed))
    level = found.estimate("kinetic_coefficient")
    assert level.low <= 0.18 <= level.high
    assert level.high - level.low < 0.01
    assert level.value == pytest.approx(0.18, abs=0.001)


def test_runs_have_the_constant_force_that_is_fixed():
    seen = record(SHAKEN, 3.0, 100.0, 2e-4, law=SMOOTH)
    found = fit(SHAKEN, Coulomb, seen, fixed={"offset": 0.0})
    (level,) = found.estimates
    assert level.low <= 0.18 <= level.high
    assert level.high - level.low < 0.001
    assert runs_of(found).error == pytest.approx(2e-4, rel=0.15)


def test_a_stiffness_that_is_not_as_given_is_named_and_moves_no_friction():
    mechanism = replace(SHAKEN, stiffness=100.0)
    seen = record(mechanism, 3.0, 100.0, 2e-4, law=SMOOTH)
    found = fitted(replace(mechanism, stiffness=92.0), seen)
    level = found.estimate("kinetic_coefficient")
    assert level.low <= 0.18 <= level.high
    assert level.high - level.low < 0.002
    assert runs_of(found).error == pytest.approx(2e-4, rel=0.15)
    (finding,) = (item for item in found.verdict.findings if item.asserted)
    assert "the stiffness at 1.09 times what was given" in finding.sentence


@pytest.mark.slow
@pytest.mark.rounding
def test_constants_that_do_the_same_are_not_named():
    """A swing tells the cart's mass, the ball's and the length by their ratio alone."""
    mechanism, length, rate, noise = CASES["swing"]
    seen = record(mechanism, length, rate, noise, law=SMOOTH)
    found = fitted(replace(mechanism, cart_mass=0.92 * mechanism.cart_mass), seen)
    level = found.estimate("kinetic_coefficient")
    assert level.low <= 0.18 <= level.high
    assert level.high - level.low < 0.02
    assert len([item for item in found.verdict.findings if item.probability > 0.1]) == 3
    assert not any(item.asserted for item in found.verdict.findings)


@pytest.mark.slow
def test_one_law_of_a_selection_is_its_fit():
    mechanism, length, rate, noise = CASES["stroke"]
    seen = record(mechanism, length, rate, noise)
    (candidate,) = select(mechanism, [Coulomb], seen).candidates
    assert candidate.fit.estimates == fit(mechanism, Coulomb, seen).estimates


def test_times_before_the_drive_begins_are_refused():
    mechanism, length, rate, noise = CASES["kicks"]
    seen = record(mechanism, length, rate, noise)
    with pytest.raises(InputError, match=r"begins at −1 s, but the drive of Capsule begins at 0 s"):
        fitted(mechanism, Measurement(time=seen.time - 1.0, position=seen.position))


def test_a_drive_that_lifts_the_cart_at_every_level_is_refused_in_words():
    mechanism, length, rate, noise = CASES["swing"]
    seen = record(mechanism, length, rate, noise)
    wild = replace(mechanism, ball_mass=20.0 * mechanism.ball_mass)
    with pytest.raises(InputError, match="the motion lifts the body"):
        fit(wild, Coulomb, seen)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_velocities_with_much_noise_leave_the_level_where_it_is(seed):
    """The prior of a level has the size of friction under the load."""
    mechanism, length, rate, noise = CASES["stroke"]
    seen = record(mechanism, length, rate, noise, seed=seed)
    velocity = np.gradient(seen.position, seen.time)
    found = fitted(mechanism, Measurement(time=seen.time, velocity=velocity))
    assert isinstance(found.judgement.problem, DrivenProblem)
    level = found.estimate("kinetic_coefficient")
    assert level.low <= 0.18 <= level.high
    assert level.value == pytest.approx(0.18, abs=0.02)


@pytest.mark.slow
def test_a_film_with_a_few_frames_for_each_slip_tells_the_friction():
    shaken = Capsule(
        capsule_mass=0.145, inner_mass=0.017, stiffness=60.0, damping=0.05, upper_stop=0.004,
        lower_stop=-0.02, restitution=0.4, drive=Torque(drive=Sine(amplitude=0.6, frequency=9.0)),
    )  # fmt: skip
    film = record(shaken, 6.0, 120.0, 5e-5, law=Coulomb(kinetic_coefficient=0.23), seed=0)
    found = fit(shaken, Coulomb, film)
    assert found.law.kinetic_coefficient == pytest.approx(0.23, abs=0.002)
    assert found.law.static_coefficient is None


def test_a_motion_that_noise_leaves_no_row_of_is_refused():
    mechanism, length, rate, _ = CASES["stroke"]
    t = np.arange(0.0, length, 1.0 / rate)
    v = simulate(mechanism, TRUTH, t_end=length).at(t)["v"]
    noisy = v + 1e-2 * np.random.default_rng(1).normal(size=t.size)
    with pytest.raises(InputError, match=r"too short for the noise.*s of 1\.2 s are motion"):
        fitted(mechanism, Measurement(time=t, velocity=noisy))


@pytest.mark.parametrize("noise", [0.0, 1e-4])
def test_an_axis_that_rests_under_its_drive_is_refused(noise):
    t = np.arange(0.0, 3.0, 0.01)
    x = noise * np.random.default_rng(0).normal(size=t.size)
    with pytest.raises(InputError, match=r"no motion was recorded|rests throughout"):
        fitted(SHAKEN, Measurement(time=t, position=x))


def test_runs_of_a_body_that_sticks_tell_nothing():
    t = np.arange(0.0, 3.0, 0.01)
    v = 0.01 * np.sin(np.pi * np.clip((t - 1.5) / 0.1, 0.0, 1.0))
    found = fitted(SHAKEN, Measurement(time=t, velocity=v))
    assert not isinstance(found.judgement.problem, DrivenProblem)
    one_count = np.where(t == t[150], 0.01, 0.0)
    with pytest.raises(InputError, match="rests throughout"):
        fitted(SHAKEN, Measurement(time=t, velocity=one_count))


def travels(settings, law, t_end, seed=1):
    """Return what a tape measure says of a kicked capsule, by period and duty."""
    mechanism, rng, trials = CASES["kicks"][0], np.random.default_rng(seed), []
    for period, duty in settings:
        own = replace(KICKS, period=period, duty=duty)
        run = simulate(replace(mechanism, drive=Torque(drive=own)), law, t_end=t_end)
        names = {"mechanism.drive.drive.period": period, "mechanism.drive.drive.duty": duty}
        travel = float(run["x"][-1] + 1e-3 * rng.normal())
        trials.append(Measurement(travel=travel, uncertainty=1e-3, overrides=names))
    return mechanism, Measurement(trials=tuple(trials))


SETTINGS = [(period, duty) for period in (0.3, 0.4, 0.5) for duty in (0.2, 0.35)]


def test_travels_by_period_and_duty_tell_both_levels():
    mechanism, readings = travels(SETTINGS, TRUTH, 3.0)
    start = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3)
    found = fit(mechanism, start, readings, t_end=3.0)
    kinetic, static = found.estimates
    assert kinetic.low <= 0.18 <= kinetic.high
    assert static.low <= 0.24 <= static.high
    assert static.high - static.low < 0.03
    assert found.chi_square < 13.3  # 99 % with 4 degrees of freedom


def test_a_law_without_a_level_at_rest_of_its_own_is_not_given_one():
    mechanism, readings = travels(SETTINGS, Coulomb(kinetic_coefficient=0.2), 3.0)
    found = fit(mechanism, Coulomb, readings, t_end=3.0)
    (level,) = found.estimates
    assert level.low <= 0.2 <= level.high
