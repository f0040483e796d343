"""Two-body crawlers whose optimal motion is known in closed form.

A body of mass M slides on the ground with Coulomb friction, an inner mass m moves along it with a
bounded stroke L, relative speed U and relative acceleration W: the problem of F. L. Chernousko
(2002). The forms below follow from its equation of motion in phases of constant acceleration,
v' = -m / (M + m) xi'' - friction / (M + m); that no other accelerations are quicker was checked
by differential evolution over the same equation.
"""

import math

import pytest

from stickslip import Capsule, Coulomb, DirectionDependent
from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import ThreePhase
from stickslip.study.optimisation import Limits, optimise_profile, pareto_front

GRAVITY, SHARE = 9.81, 0.2
"""Acceleration of free fall [m/s^2], and inner mass over that of both."""
START = ThreePhase(amplitude=0.008, fast=20.0, slow=9.0, first="slow")
CAPSULE = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=START))
ISOTROPIC, ANISOTROPIC = (0.2, 0.2), (0.2, 0.4)


def friction(forward, backward):
    if forward == backward:
        return Coulomb(kinetic_coefficient=forward)
    return DirectionDependent(
        forward_kinetic_coefficient=forward, backward_kinetic_coefficient=backward
    )


def speed_within_rate(rate, acceleration, coefficient):
    """Mean speed of three phases with equal outer ones, at rest in the first (isotropic).

    The outer acceleration is the largest that leaves the body at rest. In the middle phase it gains
    2 U (m / (M + m) - a / W), a = mu g, and loses it at 2 a in the last.
    """
    a = coefficient * GRAVITY
    q = SHARE - a / acceleration
    way = 2.0 * rate**2 * q**2 * (1.0 / (acceleration * q) + 0.5 / a)
    return way / (2.0 * rate * (1.0 / acceleration + SHARE / a))


def speed_within_stroke(stroke, acceleration, forward, backward):
    """Mean speed of three phases of which the middle and the last are as quick as allowed.

    The first is the quickest that a body at rest stands; while it still moves forwards then, it
    loses speed at the sum of both frictions. Speeds after the middle and the last phase: v_2, v_3.
    """
    a, b = forward * GRAVITY, backward * GRAVITY
    first = b / SHARE
    there = math.sqrt(2.0 * stroke / (1.0 / first + 1.0 / acceleration))
    back = math.sqrt(stroke * acceleration)
    middle, last = (there + back) / acceleration, back / acceleration
    v_2 = (SHARE * acceleration - a) * middle
    v_3 = v_2 - (SHARE * acceleration + a) * last
    assert 0.0 <= v_3 <= (a + b) * there / first
    way = 0.5 * v_2 * middle + 0.5 * (v_2 + v_3) * last + 0.5 * v_3**2 / (a + b)
    return way / (there / first + middle + last)


@pytest.mark.parametrize(("rate", "acceleration"), [(0.2, 50.0), (0.3, 200.0)])
def test_bounded_speed_and_acceleration(rate, acceleration):
    limits = Limits(position=0.02, rate=rate, acceleration=acceleration)
    best = optimise_profile(
        CAPSULE, friction(0.2, 0.2), limits=limits, goal="speed", evaluations=60
    )
    known = speed_within_rate(rate, acceleration, 0.2)
    assert best.value == pytest.approx(known, rel=1e-3)
    assert best.profile.accelerations[0] == pytest.approx(0.2 * GRAVITY / SHARE, rel=1e-2)


@pytest.mark.parametrize("coefficients", [ISOTROPIC, ANISOTROPIC])
def test_bounded_stroke_and_acceleration(coefficients):
    limits = Limits(position=0.01, rate=5.0, acceleration=100.0)
    law = friction(*coefficients)
    best = optimise_profile(
        CAPSULE, law, limits=limits, goal="speed", kind="three-accelerations", evaluations=200
    )
    known = speed_within_stroke(0.02, 100.0, *coefficients)
    assert best.value == pytest.approx(known, rel=1e-3)
    assert best.kind == "three-accelerations"
    assert best.value > 1.1 * best.three_phase.value  # which ends as it begins


def test_a_motion_within_an_acceleration_keeps_it():
    limits = Limits(position=0.01, rate=0.8, acceleration=40.0)
    law = friction(0.2, 0.2)
    best = optimise_profile(
        CAPSULE, law, limits=limits, goal="speed", kind="seven-step", evaluations=20
    )
    (margin,) = [one for one in best.margins if one.name == "acceleration"]
    assert margin.unit == "m/s^2"
    assert margin.reached <= 40.0
    assert best.to_dict()["cycle"]["acceleration"] == margin.reached


def test_a_front_trades_speed_for_energy():
    limits = Limits(position=0.01, rate=0.8, acceleration=100.0)
    front = pareto_front(
        CAPSULE, friction(0.2, 0.2), limits=limits, points=2, evaluations=20,
        kind="three-accelerations",
    )  # fmt: skip
    speeds, costs = front.speeds, front.costs
    assert len(speeds) >= 3
    assert (speeds[1:] < speeds[:-1]).all()
    assert (costs[1:] < costs[:-1]).all()
    assert list(front.to_dataframe().columns) == ["speed", "energy", "profile"]
    # friction takes mu (M + m) g a metre, which no motor gets back
    assert costs.min() > 0.2 * 1.0 * GRAVITY


def test_without_back_slip_the_front_is_one_motion():
    limits = Limits(position=0.01, rate=0.8, acceleration=100.0)
    law = friction(0.2, 0.2)
    front = pareto_front(CAPSULE, law, limits=limits, cost="back_slip", points=1, evaluations=20)
    assert len(front.motions) == 1
    assert front.costs[0] == pytest.approx(0.0, abs=1e-12)


def test_what_is_no_cost_or_number_is_refused():
    limits = Limits(position=0.01, rate=0.8)
    with pytest.raises(InputError, match="cost must be 'energy' or 'back_slip', got 'time'"):
        pareto_front(CAPSULE, friction(0.2, 0.2), limits=limits, cost="time")
    with pytest.raises(ParameterError, match="points must be a whole number of at least 0"):
        pareto_front(CAPSULE, friction(0.2, 0.2), limits=limits, points=-1)
