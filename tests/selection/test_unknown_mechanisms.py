"""Selection where a stiffness or a damping is unknown, or where nothing drives the motion."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Coulomb, CoulombViscous, Measurement, SpringBlock, fit, simulate
from stickslip.drives import Sampled
from stickslip.evidence.series import Series, outliers
from stickslip.identification import model_errors
from stickslip.identification.settings import PROMPT
from stickslip.identification.terms.findings import asked_of

AXIS = Axis(inertia=1.1, stiffness=420.0)
T = np.arange(0.0, 16.0, 0.004)
FORCE = sum(a * np.sin(2.0 * np.pi * f * T) for a, f in ((8.0, 0.23), (7.0, 0.61), (6.0, 1.37)))
LEVEL = Coulomb(kinetic_coefficient=0.45)
BOTH = CoulombViscous(kinetic_coefficient=3.0, viscous_coefficient=6.0)


def decay(friction, axis=AXIS, *, seed=6, noise=2e-6):
    """Return a motion of an axis that is let go."""
    t = np.arange(0.0, 5.0, 0.005)
    x = simulate(axis, friction, t_end=5.0, y0=[0.05, 0.0]).at(t)["x"]
    return Measurement(time=t, position=x + noise * np.random.default_rng(seed).normal(size=t.size))


@pytest.fixture(scope="module")
def driven():
    """Return a motion under a force that was recorded."""
    axis = replace(AXIS, drive=Sampled(times=T.tolist(), values=FORCE.tolist()))
    x = simulate(axis, BOTH, t_end=16.0).at(T)["x"]
    random = np.random.default_rng(7)
    return Measurement(
        time=T,
        position=x + 2e-6 * random.normal(size=T.size),
        force=FORCE + 0.02 * random.normal(size=T.size),
    )


def test_intervals_of_free_decays_hold_the_level_in_most_records():
    fits = [fit(AXIS, Coulomb, decay(LEVEL, seed=seed)) for seed in range(1, 7)]
    found = [e for f in fits for e in f.estimates if e.path.startswith("friction.")]
    # 95 % intervals of 6 records: more than one miss has a probability of 3 %
    assert sum(one.low <= 0.45 <= one.high for one in found) >= 5


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("viscous", {"viscous_coefficient": 1.2}),
        ("level + drag", {"kinetic_coefficient": 0.2, "quadratic_coefficient": 0.6}),
        ("dahl(level)", {"kinetic_coefficient": 0.4, "bristle_stiffness": 300.0}),
    ],
)
def test_free_decays_ask_for_the_law_that_damps_them(text, values):
    from stickslip.friction import law

    friction = law(text)(**values)
    start = [0.05, 0.0, *[0.0] * len(friction.states)]
    t = np.arange(0.0, 5.0, 0.005)
    x = simulate(AXIS, friction, t_end=5.0, y0=start).at(t)["x"]
    noise = 2e-6 * np.random.default_rng(8).normal(size=t.size)
    asked = asked_of(AXIS, Measurement(time=t, position=x + noise), "zero", (), PROMPT)
    assert asked.best.text == text
    for name, value in values.items():
        # of the balance alone, which a fit by simulation corrects
        assert asked.best.start[f"friction.{name}"] == pytest.approx(value, rel=0.03)


@pytest.mark.slow
def test_an_unknown_stiffness_is_a_term_of_the_force_balance(driven):
    unknown = ("mechanism.stiffness",)
    asked = asked_of(replace(AXIS, stiffness=250.0), driven, "zero", unknown, PROMPT)
    assert asked.best.text == "level + viscous"
    assert asked.best.known["mechanism.stiffness"] == pytest.approx(420.0, rel=0.005)
    assert model_errors(asked.explanation, driven, "zero", PROMPT) == ()


@pytest.mark.slow
def test_a_damping_that_is_looked_for_has_the_viscous_friction_in_it(driven):
    unknown = ("mechanism.damping",)
    asked = asked_of(AXIS, driven, "zero", unknown, PROMPT)
    assert asked.best.text == "level"
    assert asked.best.known["mechanism.damping"] == pytest.approx(6.0, rel=0.03)
    (said,) = model_errors(asked.explanation, driven, "zero", PROMPT)
    assert said.kind == "damping"
    assert "is their sum" in said.finding


@pytest.mark.slow
def test_a_given_spring_that_is_wrong_is_said_to_be_an_error_of_given_values(driven):
    asked = asked_of(replace(AXIS, stiffness=400.0), driven, "zero", (), PROMPT)
    assert asked.best.text == "level + viscous"
    (said,) = model_errors(asked.explanation, driven, "zero", PROMPT)
    assert "an error of the given parameters of the mechanism" in said.finding
    assert said.effect == pytest.approx(20.0, rel=0.1)


def test_what_changes_the_load_as_well_is_no_term_of_the_force_balance():
    block = SpringBlock(mass=1.0, stiffness=400.0, compression=0.1, attached=True)
    t = np.arange(0.0, 4.0, 0.005)
    law = Coulomb(kinetic_coefficient=0.03)
    record = Measurement(time=t, position=simulate(block, law, t_end=4.0).at(t)["x"])
    assert asked_of(block, record, "zero", ("mechanism.gravity",), PROMPT) is None
    asked = asked_of(block, record, "zero", ("mechanism.stiffness",), PROMPT)
    assert asked.best.start["friction.kinetic_coefficient"] == pytest.approx(0.03, rel=0.01)
    assert asked.best.known["mechanism.stiffness"] == pytest.approx(400.0, rel=1e-3)


def test_the_turn_of_a_swing_is_no_outlier():
    x = np.array(decay(CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=0.6)).position)
    t = 0.005 * np.arange(len(x))
    assert not outliers(Series(t, x, 0.0 * x, mass=1.0))["position"].any()
    x[900] += 0.004  # at rest
    assert np.flatnonzero(outliers(Series(t, x, 0.0 * x, mass=1.0))["position"]).tolist() == [900]
