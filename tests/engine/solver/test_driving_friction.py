"""Friction that drives what it should brake: a certificate says so, and how much."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Coulomb, Dahl, LuGre, TwoFeet, simulate
from stickslip.friction import law
from stickslip.mechanisms.drives import Sine

AXIS = Axis(inertia=1.0, drive=Sine(amplitude=3.0, frequency=0.5))
SLOPES = {"speed_coefficient_1": -0.8, "speed_coefficient_2": 1.0}
DIPS = law("level + polynomial[2]")(kinetic_coefficient=0.1, **SLOPES)
"""Friction that is below 0 between .16 and .64 m/s, where it would drive."""
SOFT = {"kinetic_coefficient": 0.5, "bristle_stiffness": 1e3}


def said(run):
    assert run.certificate.certified
    return [sentence for sentence in run.certificate.warnings if "friction drove" in sentence]


def test_work_that_friction_did_is_the_integral_of_its_power_while_it_pushes():
    run = simulate(AXIS, DIPS, t_end=10.0)
    t = np.linspace(0.0, 10.0, 100_001)
    seen = run.at(t)
    given = -np.trapezoid(np.minimum(seen["friction"] * seen["v"], 0.0), t)
    assert given == pytest.approx(0.0594, abs=1e-4)
    assert run.certificate.work_friction > 0.0  # on the whole it braked
    (sentence,) = said(run)
    assert "it did 0.059 J of work on it; the law level + polynomial[2] with" in sentence


def test_a_run_that_friction_drives_away_is_certified_and_says_what_drove_it():
    away = law("level + polynomial[1]")(kinetic_coefficient=0.5, speed_coefficient_1=-0.8)
    run = simulate(AXIS, away, t_end=10.0)
    assert abs(run["v"]).max() > 500.0
    assert "did 360,000 J of work" in said(run)[0]
    assert any("friction drove" in note for note in run._summary().notes)
    bristles = law("dahl(level) + polynomial[1]")(**SOFT, speed_coefficient_1=-0.8)
    assert "more than it took" in said(simulate(AXIS, bristles, t_end=10.0))[0]


@pytest.mark.parametrize(
    "braking",
    [
        Coulomb(kinetic_coefficient=0.25),
        law("level + polynomial[2]")(kinetic_coefficient=0.5, **SLOPES),
        Dahl(**SOFT),
        LuGre(**SOFT, static_coefficient=1.0, stribeck_velocity=0.01, bristle_damping=30.0),
    ],
    ids=lambda one: one.name,
)
def test_nothing_is_said_of_friction_that_brakes(braking):
    assert said(simulate(AXIS, braking, t_end=4.0)) == []


def test_of_several_contacts_the_one_that_drives_is_named():
    body = TwoFeet(mass=1.0, front=0.1, rear=0.1, drive=Sine(amplitude=20.0, frequency=0.5))
    laws = {
        "front": replace(DIPS, kinetic_coefficient=0.01),
        "rear": Coulomb(kinetic_coefficient=0.1),
    }
    (sentence,) = said(simulate(body, laws, t_end=4.0))
    assert "drove the motion at front" in sentence


def test_hard_stops_do_not_change_what_is_said_of_the_only_contact():
    stopped = replace(AXIS, lower_stop=-1e3)  # which nothing reaches
    sentences = [said(simulate(made, DIPS, t_end=10.0)) for made in (AXIS, stopped)]
    assert sentences[0] == sentences[1] != []
