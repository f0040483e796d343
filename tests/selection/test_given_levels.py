"""Break-away levels that were given and that the measurement refutes."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Measurement,
    SpringBlock,
    Stribeck,
    fit,
    select,
    simulate,
)
from stickslip.drives import Sampled
from stickslip.errors import InputError
from stickslip.selection.given_levels import given_level, refuted_by_record

TRUTH = Stribeck(kinetic_coefficient=0.15, static_coefficient=0.22, stribeck_velocity=0.02)
BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.06)
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
    "stribeck": replace(TRUTH, static_coefficient=0.88),
    "coulomb": Coulomb(kinetic_coefficient=0.15, static_coefficient=0.9),
    "break-away": replace(TRUTH, break_away_coefficient=0.8),
}


@pytest.mark.parametrize("name", WRONG)
def test_travels_refute_a_level_that_would_have_held_the_body(name, readings):
    law = WRONG[name]
    with pytest.raises(InputError, match="no law can be fitted to these travels"):
        select(BLOCK, {name: law}, readings)
    beside = select(BLOCK, {name: law, "plain": Coulomb(kinetic_coefficient=0.15)}, readings)
    assert beside.best.name == "plain"
    (out,) = [one for one in beside.candidates if one.name == name]
    assert out.dropped
    assert out.fit is None


@pytest.mark.parametrize(
    ("law", "name"),
    [
        (Coulomb(kinetic_coefficient=0.16), "static_coefficient"),
        (replace(TRUTH, viscous_coefficient=0.5), "break_away_coefficient"),
        (
            replace(TRUTH, viscous_coefficient=0.5, static_coefficient=0.3),
            "static_coefficient",
        ),
    ],
    ids=["coulomb", "break-away", "stribeck"],
)
def test_forces_at_break_away_refute_a_level_that_was_given(law, name, record):
    def fitted(value):
        given = replace(law, **{name: value})
        held = [one for one in law.fit_order if one != name]
        return fit(AXIS, given, record, vary=held, route="inverse-dynamics")

    said = refuted_by_record(fitted(4.0 * 0.22))
    assert said.startswith("the given $mu_")
    assert "= 0.88 contradicts the record: friction at rest was at most 0." in said
    # motion is seen late, so that the force has grown beyond the 0.22 of the law by then
    assert 0.22 <= float(said.split()[-2]) < 0.35
    assert refuted_by_record(fitted(0.22)) == ""


def test_a_level_that_is_fitted_or_measured_is_not_said_to_be_given(record):
    found = fit(AXIS, CoulombViscous, record, route="inverse-dynamics")
    assert refuted_by_record(found) == ""
    v = np.linspace(-1.0, 1.0, 400)
    table = Measurement(velocity=v, friction=2.0 * np.sign(v) + 0.01 * np.cos(40.0 * v))
    law = Coulomb(kinetic_coefficient=2.0, static_coefficient=9.0)
    assert refuted_by_record(fit(Axis(inertia=1.0), law, table)) == ""


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
