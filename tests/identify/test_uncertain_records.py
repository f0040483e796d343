"""Uncertainties of a mechanism's parameters in the intervals of fits to records.

Oracles are refits with the parameter at both sides of its value, and laws in closed form: levels
over the load are inverse to it.
"""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    DirectionDependent,
    Measurement,
    PendulumCart,
    fit,
    simulate,
)
from stickslip.errors import InputError
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import Sampled, ThreePhase

J, K, N = "mechanism.inertia", "mechanism.stiffness", "mechanism.load"
NORMAL_95 = 1.959963984540054
AXIS = Axis(inertia=2.0, stiffness=30.0, damping=0.5, load=20.0)
TRUTH = CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=0.5)
SWING = ThreePhase(amplitude=np.radians(45.0), fast=120.0, slow=30.0)
CART = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING))


def pushed(axis=AXIS, noise=1e-4, seed=3):
    """Return the position of an axis under a force, as an encoder sees it."""
    t = np.arange(0.0, 6.0, 0.01)
    force = 12.0 * np.sin(np.pi * t) + 6.0 * np.sin(2.6 * np.pi * t + 1.0)
    drive = Sampled(times=tuple(t[:-1].tolist()), values=tuple(force[:-1].tolist()))
    run = simulate(replace(axis, drive=drive), TRUTH, t_end=5.99)
    x = run.at(t[:-2])["x"] + noise * np.random.default_rng(seed).normal(size=t.size - 2)
    return Measurement(time=t[:-2], position=x, force=force[:-2])


def rubbed(load=20.0, seed=1, name=""):
    """Return friction measured along a motion, under a load."""
    t = np.arange(0.0, 12.0, 0.01)
    v = np.cos(t)
    noise = 0.1 * np.random.default_rng(seed).normal(size=t.size)
    return Measurement(time=t, velocity=v, friction=0.2 * load * np.sign(v) + v + noise, name=name)


def swung(cart=CART, seed=1):
    """Return what a camera sees of a cart with a swinging pendulum."""
    t = np.arange(0.0, 2.4, 1.0 / 200.0)
    run = simulate(cart, Coulomb(kinetic_coefficient=0.18), t_end=2.4)
    return Measurement(
        time=t, position=run.at(t)["x"] + 3e-4 * np.random.default_rng(seed).normal(size=t.size)
    )


def test_a_level_over_the_load_is_as_uncertain_as_the_load():
    found = fit(AXIS, CoulombViscous, replace(rubbed(), parameter_uncertainties={N: 0.4}))
    plain = fit(AXIS, CoulombViscous, rubbed())
    level, own = (one.estimate("kinetic_coefficient") for one in (found, plain))
    half = np.hypot(half_width(own), NORMAL_95 * 0.02 * level.value)
    # draws know a width of 95 % to some per cent, and loads that are off scale it
    assert half_width(level) == pytest.approx(half, rel=0.15)
    slope, known = (one.estimate("viscous_coefficient") for one in (found, plain))
    assert half_width(slope) == pytest.approx(half_width(known), rel=0.15)
    assert found.law_estimates().intervals["kinetic_coefficient"] == (level.low, level.high)


def half_width(estimate):
    return 0.5 * (estimate.high - estimate.low)


@pytest.mark.parametrize(
    ("path", "error", "name", "moved"),
    [
        (N, 0.4, "kinetic_coefficient", 0.02 * 0.2),  # inverse to the load
        # along strokes that come back, a damping in parallel is all of the viscous part
        ("mechanism.damping", 0.05, "viscous_coefficient", 0.05),
    ],
)
def test_a_record_s_intervals_grow_with_what_is_stated_of_its_mechanism(path, error, name, moved):
    stated = replace(pushed(), parameter_uncertainties={path: error})
    found, plain = (
        fit(AXIS, CoulombViscous, one, route="balance").estimate(name) for one in (stated, pushed())
    )
    half = np.hypot(half_width(plain), NORMAL_95 * moved)
    assert half_width(found) == pytest.approx(half, rel=0.25)
    assert half_width(found) > 1.5 * half_width(plain)


def test_a_mass_that_is_off_by_its_uncertainty_leaves_the_truth_in_intervals():
    record = pushed(replace(AXIS, inertia=2.05))
    stated = replace(record, parameter_uncertainties={J: 0.05})
    found = fit(AXIS, CoulombViscous, stated, route="balance")
    for name in ("kinetic_coefficient", "viscous_coefficient"):
        estimate = found.estimate(name)
        assert estimate.low <= getattr(TRUTH, name) <= estimate.high


@pytest.mark.slow
def test_an_offset_of_measured_friction_counts_where_it_is_not_looked_for():
    """What a constant force adds to one level it takes off the other."""
    found = fit(
        AXIS, DirectionDependent, replace(rubbed(), parameter_uncertainties={"offset": 0.4})
    )
    for way in ("forward", "backward"):
        level = found.estimate(f"{way}_kinetic_coefficient")
        # 0.4 N over the load of 20 N, beside what the noise of the record leaves
        assert half_width(level) == pytest.approx(NORMAL_95 * 0.02, rel=0.2)
    stated = replace(rubbed(), parameter_uncertainties={"offset": 0.4})
    sought, plain = (fit(AXIS, CoulombViscous, one) for one in (stated, rubbed()))
    for one, other in zip(sought.estimates, plain.estimates, strict=True):
        assert half_width(one) < 3.0 * half_width(other)
    # the record tells the offset: its 0.4 N alone would widen the level as above
    assert half_width(sought.estimate("kinetic_coefficient")) < 0.2 * NORMAL_95 * 0.02


@pytest.mark.slow
@pytest.mark.rounding
def test_runs_of_what_drives_itself_hold_the_truth_where_a_mass_is_off():
    record = swung(replace(CART, cart_mass=0.52))
    stated = replace(record, parameter_uncertainties={"cart_mass": 0.02})
    for one in (record, stated):
        level = fit(CART, Coulomb, one).estimate("kinetic_coefficient")
        assert level.low <= 0.18 <= level.high
        assert level.high - level.low < 0.02


def test_without_uncertainties_a_record_says_what_it_said():
    found = fit(AXIS, CoulombViscous, rubbed())
    assert all(estimate.sources == {} for estimate in found.estimates)
    assert "standard_error_from" not in found.estimates[0].to_dict()


def both(first, second, **doubts):
    return Measurement(trials=(rubbed(first, 1, "one"), rubbed(second, 2, "two")), **doubts)


@pytest.mark.slow
def test_what_each_trial_sets_and_what_they_share_widens_intervals():
    shared = fit(AXIS, CoulombViscous, both(20.0, 20.0, parameter_uncertainties={N: 0.4}))
    records = [replace(trial, overrides={N: 20.0}) for trial in both(20.0, 20.0).trials]
    anew = fit(AXIS, CoulombViscous, Measurement(trials=records, parameter_uncertainties={N: 0.4}))
    own = fit(
        AXIS,
        CoulombViscous,
        Measurement(trials=[replace(r, parameter_uncertainties={N: 0.4}) for r in records]),
    )
    halves = [half_width(one.estimate("kinetic_coefficient")) for one in (shared, anew, own)]
    # what is set anew for each trial averages out less in the balance, as one number for all
    assert min(halves) > NORMAL_95 * 0.02 * 0.2 / np.sqrt(2.0)
    assert max(halves) < 1.3 * NORMAL_95 * 0.02 * 0.2


def test_uncertainties_without_effect_are_refused():
    weighed = replace(rubbed(), load=20.0, parameter_uncertainties={N: 0.4})
    with pytest.raises(InputError, match="measured load replaces"):
        fit(AXIS, CoulombViscous, weighed)
