"""What others published on capsules, as docs/explanation/capsule-literature.md recomputes it."""

import math

import numpy as np
import pytest

from stickslip import (
    Capsule,
    Coulomb,
    DirectionDependent,
    LuGre,
    PendulumCart,
    SpringBlock,
    Viscous,
    simulate,
)
from stickslip.drives import Pulse, Rotation, Sine, SineSwing, Square, ThreePhase
from stickslip.friction import law
from stickslip.mechanisms import Prescribed, Torque

G = 9.81


def mean_speed(mechanism, own, period, settle=40, cycles=20, **start):
    run = simulate(mechanism, own, t_end=(settle + cycles + 0.5) * period, y0=start)
    first, last = run.at([settle * period, (settle + cycles) * period])["x"]
    return (last - first) / (cycles * period)


def test_the_source_papers_block_goes_as_far_as_its_table_says_but_for_four_percent():
    own = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.35)
    push = SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1))
    spring = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    assert simulate(push, own, t_end=5.0)["x"][-1] == pytest.approx(0.16, rel=0.04)
    assert simulate(spring, own, t_end=5.0)["x"][-1] == pytest.approx(0.20, rel=0.02)


@pytest.mark.parametrize(("forward", "backward"), [(0.2, 0.2), (0.1, 0.3)])
def test_a_vibration_moves_a_module_from_the_smaller_friction_at_rest_on(forward, backward):
    """Fang and Xu 2012: at rest up to (M + m) g f of the smaller coefficient."""
    own = DirectionDependent(
        forward_kinetic_coefficient=forward, backward_kinetic_coefficient=backward
    )
    known = math.sqrt(1.0 * G * min(forward, backward) / (0.2 * 0.02)) / math.tau
    travels = []
    for frequency in (known * (1.0 - 1e-8), known * (1.0 + 1e-5)):
        swing = Prescribed(profile=SineSwing(amplitude=0.02, frequency=frequency))
        body = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=swing)
        travels.append(np.ptp(simulate(body, own, t_end=3.0 / frequency)["x"]))
    assert travels[0] == 0.0
    assert travels[1] > 0.0


def test_on_a_viscous_film_no_stroke_carries_a_platform():
    stroke = ThreePhase(amplitude=0.02, fast=50.0, slow=9.81, first="slow")
    body = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    period = float(stroke.period)
    film = mean_speed(body, Viscous(viscous_coefficient=2.0), period, settle=200)
    # of places of 3 mm that roundings of the last digit shift
    assert abs(film) < 1e-13
    assert mean_speed(body, Coulomb(kinetic_coefficient=0.2), period) > 0.06


def test_a_mass_on_a_circle_brings_its_body_to_one_motion_from_any_velocity():
    """Bardin and Panev 2018."""
    turn = Prescribed(profile=Rotation(rate=45.0))
    body = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.02, pendulum=turn)
    own = Coulomb(kinetic_coefficient=0.2)
    speeds = [mean_speed(body, own, math.tau / 45.0, v=v) for v in (-1.0, 0.0, 0.3, 2.0)]
    np.testing.assert_allclose(speeds, speeds[0], rtol=1e-10)


def test_a_pendulum_on_a_vibrating_pipe_swings_at_half_its_frequency_and_travels():
    """Zigelman et al. 2026: 2:1, and a drift under a damping that differs by direction."""
    frequency = 2.0 * math.sqrt(G / 0.1) / math.tau
    body = PendulumCart(
        cart_mass=0.5, ball_mass=0.05, length=0.1, pivot_damping=1e-4,
        ground=Sine(amplitude=2.0, frequency=frequency),
    )  # fmt: skip
    uneven = law("both_ways(viscous)")(
        forward_viscous_coefficient=0.2, backward_viscous_coefficient=1.0
    )
    run = simulate(body, uneven, t_end=400.5 / frequency, y0={"theta": math.pi + 0.3})
    t = np.linspace(300.0 / frequency, 400.0 / frequency, 20001)
    angle = run.at(t)["theta"] - math.pi
    rises = t[1:][(angle[:-1] < 0.0) & (angle[1:] >= 0.0)]
    assert frequency * np.diff(rises).mean() == pytest.approx(2.0, rel=1e-4)  # steps of t
    start = {"theta": math.pi + 0.3}
    moved = mean_speed(body, uneven, 1.0 / frequency, 300, 100, **start)
    even = mean_speed(body, Viscous(viscous_coefficient=0.6), 1.0 / frequency, 300, 100, **start)
    assert moved > 0.03
    assert abs(even) < 1e-6


GIVEN = {"alpha": 1.6, "beta": 15.0, "delta": 0.02, "xi": 0.05, "omega": 0.6, "coefficient": 0.3}


def test_two_motions_of_a_vibro_impact_capsule_go_in_opposite_directions():
    """Liu et al. 2013: its direction by the mass ratio, and by motions side by side."""
    period, own = math.tau / 0.6, Coulomb(kinetic_coefficient=0.3)
    capsule = Capsule.dimensionless(gamma=5.0, **GIVEN)
    speeds = [
        period * mean_speed(capsule, own, period, 100, **start)
        for start in ({}, {"xi": -1.0, "xi_dot": 2.0}, {"xi": -2.0}, {"xi": -0.5, "xi_dot": -1.5})
    ]
    assert min(speeds) == pytest.approx(-0.299, abs=2e-3)
    assert max(speeds) == pytest.approx(0.466, abs=2e-3)
    ways = [
        mean_speed(Capsule.dimensionless(gamma=gamma, **GIVEN), own, period, 100)
        for gamma in (1.0, 2.75, 4.0, 6.0)
    ]
    assert [speed > 0.0 for speed in ways] == [False, True, False, True]


def test_viscous_damping_alone_carries_no_vibro_impact_capsule():
    period = math.tau / 0.6
    capsule = Capsule.dimensionless(gamma=5.0, **GIVEN)
    still = mean_speed(capsule, Viscous(viscous_coefficient=1.0), period, 200)
    assert abs(period * still) < 1e-6
    remembering = LuGre(
        kinetic_coefficient=0.3, static_coefficient=0.4, stribeck_velocity=0.1,
        viscous_coefficient=0.05, bristle_stiffness=10.0, bristle_damping=0.1,
    )  # fmt: skip
    assert abs(period * mean_speed(capsule, remembering, period, 100)) > 0.1


def test_a_measured_capsule_turns_its_direction_with_the_period_as_the_model_does():
    """Its speeds at 60, 85 and 100 ms are 5.8, -15.5 and -31.5 mm/s; one damper is our guess."""

    def speed(period):
        pull = Square(high=1.25, low=0.0, period=period, duty=0.3)
        robot = Capsule(
            capsule_mass=0.193, inner_mass=0.074, stiffness=256.23, damping=1.0,
            drive=Torque(drive=pull),
        )  # fmt: skip
        return -mean_speed(robot, Coulomb(kinetic_coefficient=0.71 / (0.267 * G)), period)

    assert speed(0.060) > 0.004
    assert speed(0.095) < -0.015
    assert -0.030 < speed(0.100) < -0.015
