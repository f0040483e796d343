"""A fit is the selection in which no other law is compared; intervals of own laws hold truths."""

import numpy as np
import pytest
from tests.arm_cases import ARM, GUESSED, JOINTS, LINEAR, TRUTH
from tests.arm_cases import record as of_arm
from tests.identify.test_decays import RIG, swings
from tests.identify.test_own_laws import Weakening

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    CoulombViscousStatic,
    Dahl,
    DirectionalStribeck,
    DirectionDependent,
    LuGre,
    Measurement,
    Stribeck,
    fit,
    select,
    simulate,
)
from stickslip.errors import InputError
from stickslip.mechanisms.drives import Sampled

TRUTHS = {
    "coulomb-viscous": CoulombViscous(kinetic_coefficient=4.0, viscous_coefficient=3.0),
    "stribeck": Stribeck(
        kinetic_coefficient=3.0, static_coefficient=5.0, stribeck_velocity=0.1,
        viscous_coefficient=2.0,
    ),
    "own": Weakening(grip=4.0, fall=0.5, knee_speed=0.15),
    "direction-dependent": DirectionDependent(
        forward_kinetic_coefficient=4.0, backward_kinetic_coefficient=4.5,
        forward_viscous_coefficient=3.0, backward_viscous_coefficient=2.5,
    ),
}  # fmt: skip


def table(law, seed=1, count=120, noise=0.05):
    """Return friction over velocity in random order, with noise."""
    random = np.random.default_rng(seed)
    v = random.permutation(np.linspace(-0.8, 0.8, count))
    return Measurement(velocity=v, friction=law.force(v, 1.0) + noise * random.normal(size=count))


def record(law, seed=1):
    """Return a record of an axis under a force that is held between samples."""
    t = np.arange(0.0, 6.0, 5e-3)
    force = 9.0 * np.sin(np.pi * t) + 5.0 * np.sin(2.6 * np.pi * t)
    run = simulate(Axis(inertia=4.0, drive=Sampled(times=t, values=force)), law, t_end=t[-1])
    noise = 1e-6 * np.random.default_rng(seed).normal(size=len(t))
    return Measurement(time=t, position=run.at(t)["x"] + noise, force=force)


def numbers(found):
    """Return what a fit says of parameters."""
    return [(one.path, one.value, one.low, one.high) for one in found.estimates]


@pytest.mark.slow
@pytest.mark.parametrize("made", [table, record])
@pytest.mark.parametrize("name", TRUTHS)
def test_select_with_one_law_gives_the_numbers_of_fit_to_the_last_digit(name, made):
    law, measurement = type(TRUTHS[name]), made(TRUTHS[name])
    found = fit(Axis(inertia=4.0), law, measurement)
    verdict = select(Axis(inertia=4.0), [law], measurement)
    chosen = verdict.closest.fit
    assert found.estimates
    assert numbers(found) == numbers(chosen)
    assert found.law == chosen.law
    v = np.linspace(-0.8, 0.8, 8)
    one, other = found.verdict.band(v), verdict.band(v)
    np.testing.assert_array_equal(one.low, other.low)
    np.testing.assert_array_equal(one.high, other.high)


VARIED = {
    "a level at rest": (
        Axis(inertia=4.0), CoulombViscousStatic, lambda: record(TRUTHS["coulomb-viscous"]), None
    ),
    "a peak by direction": (
        Axis(inertia=4.0), DirectionalStribeck, lambda: table(TRUTHS["stribeck"]), None
    ),
    "an inertia": (
        Axis(inertia=3.0), CoulombViscous, lambda: record(TRUTHS["coulomb-viscous"]),
        ["friction.*", "mechanism.inertia"],
    ),
    "a decay": (RIG, Coulomb, swings, None),
    "joints": (GUESSED, CoulombViscous, lambda: of_arm(0), ["friction.*", *LINEAR]),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("name", VARIED)
def test_select_with_one_law_gives_the_numbers_of_fit_for_what_else_is_unknown(name):
    mechanism, law, made, vary = VARIED[name]
    measurement = made()
    found = fit(mechanism, law, measurement, vary=vary)
    chosen = select(mechanism, [law], measurement, vary=vary).closest.fit
    assert found.estimates
    assert numbers(found) == numbers(chosen)
    assert found.law == chosen.law


@pytest.mark.slow
@pytest.mark.parametrize("level", [4.0, 2.0])
def test_an_inertia_is_fitted_beside_a_law_that_is_held(level):
    """A law that is held and wrong is said to be, and does not move the inertia."""
    measurement = record(TRUTHS["coulomb-viscous"])
    held = {"kinetic_coefficient": level, "viscous_coefficient": 3.0}
    found = fit(Axis(inertia=3.0), CoulombViscous(**held), measurement, vary="inertia")
    (inertia,) = found.estimates
    assert inertia.low <= 4.0 <= inertia.high
    assert inertia.high - inertia.low < 0.1
    assert found.law == CoulombViscous(**held)
    assert ("Use" if level == 4.0 else "None of the laws") in found.verdict.words.verdict
    by_value = fit(Axis(inertia=3.0), CoulombViscous, measurement, vary="inertia", fixed=held)
    assert numbers(by_value) == numbers(found)


@pytest.mark.slow
def test_links_are_fitted_beside_laws_that_are_held():
    found = fit(GUESSED, TRUTH, of_arm(0), vary=LINEAR)
    assert [one.path for one in found.estimates] == [f"mechanism.{name}" for name in LINEAR]
    for name in LINEAR:
        one = found.estimate(name)
        assert one.low <= getattr(ARM, name) <= one.high
    assert dict(found.law.members) == {name: TRUTH[name] for name in JOINTS}


@pytest.mark.parametrize("vary", [[], "friction.*"])
def test_a_fit_of_nothing_is_refused(vary):
    held = {"kinetic_coefficient": 4.0, "viscous_coefficient": 3.0}
    with pytest.raises(InputError, match="there is nothing to fit"):
        fit(
            Axis(inertia=4.0), CoulombViscous, table(TRUTHS["coulomb-viscous"]),
            vary=vary, fixed=held,
        )  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("law", [Dahl, LuGre])
def test_select_with_one_law_of_bristles_gives_the_numbers_of_fit(law):
    """Their viscous exponent is 1 unless it is varied, in a selection as in a fit."""
    measurement = record(
        Dahl(kinetic_coefficient=4.0, bristle_stiffness=1e4, viscous_coefficient=3.0)
    )
    found = fit(Axis(inertia=4.0), law, measurement)
    chosen = select(Axis(inertia=4.0), [law], measurement).closest.fit
    assert numbers(found) == numbers(chosen)


def test_a_fit_in_a_verdict_refuses_to_predict():
    chosen = select(Axis(inertia=4.0), [CoulombViscous], table(TRUTHS["coulomb-viscous"])).closest
    with pytest.raises(InputError, match="call predict of the verdict"):
        chosen.fit.predict(table(TRUTHS["coulomb-viscous"], seed=2))


@pytest.mark.slow
def test_intervals_of_a_law_of_ones_own_hold_the_truth():
    held = dict.fromkeys(Weakening.fit_order, 0)
    for seed in range(30):
        random = np.random.default_rng([41, seed])
        truth = Weakening(
            grip=random.uniform(2.0, 8.0),
            fall=random.uniform(0.3, 0.8),
            knee_speed=random.uniform(0.08, 0.3),
        )
        found = fit(Axis(inertia=1.0), Weakening, table(truth, seed, noise=0.03 * truth.grip))
        for name in held:
            one = found.estimate(name)
            held[name] += one.low <= getattr(truth, name) <= one.high
    # of 30 intervals of 95 %, fewer than 27 hold with a probability of 6 %
    assert min(held.values()) >= 27, held
