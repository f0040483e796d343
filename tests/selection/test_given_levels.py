"""Break-away levels that were given and that the measurement refutes."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    Measurement,
    SpringBlock,
    Stribeck,
    select,
    simulate,
)
from stickslip.drives import Sampled, Sine
from stickslip.identification import trials_of
from stickslip.kinds.travels.contradictions import refuted_by_travels
from stickslip.selection.given_levels import given_level

TRUTH = Stribeck(kinetic_coefficient=0.15, static_coefficient=0.22, stribeck_velocity=0.02)
BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.06)
AT_RELEASE = 100.0 * 0.06 / 9.81
"""Force of the spring over the weight, in the trial with the least."""
AXIS = Axis(inertia=2.0, load=10.0)
NOISE = 1e-5
"""Of positions [m]."""


@pytest.fixture(scope="module")
def readings():
    trials = []
    for compression in (0.06, 0.07, 0.08):
        run = simulate(replace(BLOCK, compression=compression), TRUTH, t_end=5.0)
        setting = {"mechanism.compression": compression}
        travel = float(run["x"][-1] - run["x"][0])
        trials.append(Measurement(travel=travel, uncertainty=5e-4, overrides=setting))
    return Measurement(trials=trials)


@pytest.fixture(scope="module")
def record():
    """Return 12 s of a body that a force moves back and forth, with a rest at each reversal."""
    t = np.arange(0.0, 12.0, 0.005)
    force = 3.5 * np.sin(2.0 * np.pi * 0.4 * t) * (1.0 + 0.2 * np.sin(0.7 * t))
    law = replace(TRUTH, viscous_coefficient=0.5)
    moved = replace(AXIS, drive=Sampled(times=t, values=force))
    x = simulate(moved, law, t_end=float(t[-1])).at(t)["x"]
    return Measurement(
        time=t, position=x + np.random.default_rng(0).normal(0.0, NOISE, len(t)), force=force
    )


def test_the_level_is_set_by_what_was_given_alone():
    coulomb = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.3)
    assert given_level(coulomb, ["static_coefficient", "kinetic_coefficient"]) == (
        "static_coefficient"
    )
    assert given_level(coulomb, ["kinetic_coefficient"]) == ""
    plain = Coulomb(kinetic_coefficient=0.2)
    assert given_level(plain, ["static_coefficient"]) == ""  # sliding sets it, which is fitted
    assert given_level(plain, ["kinetic_coefficient"]) == "kinetic_coefficient"
    given = replace(TRUTH, break_away_coefficient=0.4)
    assert given_level(given, ["static_coefficient", "break_away_coefficient"]) == (
        "break_away_coefficient"
    )


WRONG = {
    "stribeck": (replace(TRUTH, static_coefficient=0.88), "mu_s = 0.88"),
    "coulomb": (Coulomb(kinetic_coefficient=0.15, static_coefficient=0.9), "mu_s = 0.9"),
    "break-away": (replace(TRUTH, break_away_coefficient=0.8), "mu_b = 0.8"),
}


@pytest.mark.parametrize("name", WRONG)
def test_travels_refute_a_level_that_would_have_held_the_body(name, readings):
    law, said = WRONG[name]
    verdict = select(BLOCK, {name: law}, readings)
    assert verdict.best is None
    # the force of the spring at release, by hand: 6 N over 9.81 N
    assert verdict.sentence == (
        f"The given {said} contradicts the readings: the body moved at x_0 = 60 mm, though friction"
        f" at rest was at most {AT_RELEASE:.3f} N/N."
    )
    beside = select(BLOCK, {name: law, "plain": Coulomb(kinetic_coefficient=0.15)}, readings)
    assert beside.best.name == "plain"
    (out,) = [one for one in beside.candidates if one.name == name]
    assert out.dropped.startswith(f"the given ${said.partition(' ')[0]}$ = ")


@pytest.mark.parametrize(
    "law",
    [
        TRUTH,
        replace(TRUTH, static_coefficient=0.99 * AT_RELEASE),  # it does break away
        Dahl(kinetic_coefficient=0.9, bristle_stiffness=10.0),  # gives way by 6 cm
    ],
)
def test_travels_do_not_refute_a_level_at_which_the_body_moves(law, readings):
    names = ["static_coefficient", "kinetic_coefficient"]
    assert refuted_by_travels(law, names, trials_of(BLOCK, readings, 10.0), t_end=10.0) == ""


def test_a_force_that_rises_later_is_what_moved_the_body():
    pushed = SpringBlock(mass=1.0, drive=Sine(amplitude=6.0, frequency=0.5))
    trials = trials_of(pushed, Measurement(travel=0.1, uncertainty=1e-3), 3.0)
    law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.9)
    said = refuted_by_travels(law, ["static_coefficient"], trials, t_end=3.0)
    assert said.endswith(f"friction at rest was at most {6.0 / 9.81:.3f} N/N")  # not 0, at release


@pytest.mark.slow
def test_a_selection_on_a_record_says_which_value_it_contradicts(record):
    law = Coulomb(kinetic_coefficient=0.16, static_coefficient=0.88)
    verdict = select(AXIS, {"coulomb": law}, record, route="inverse-dynamics")
    assert verdict.best is None
    assert verdict.sentence.startswith("The given mu_s = 0.88 contradicts the record: friction at")
    assert verdict.closest.dropped.startswith("the given $mu_s$ = 0.88 contradicts the record")
    other = select(
        AXIS, {"wrong": law, "coulomb-viscous": CoulombViscous}, record, route="inverse-dynamics"
    )
    assert other.closest.name == "coulomb-viscous"
