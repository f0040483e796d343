"""What others published on capsules, as docs/explanation/capsule-literature.md recomputes it."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
import pytest

from stickslip import (
    Capsule,
    Coulomb,
    DirectionDependent,
    LuGre,
    Mechanism,
    PendulumCart,
    SpringBlock,
    Stribeck,
    TowedBlock,
    Viscous,
    ensemble,
    simulate,
)
from stickslip.engine.solver import Samples
from stickslip.friction import law
from stickslip.mechanisms import Contact, Prescribed, Torque
from stickslip.mechanisms.drives import Drive, Pulse, Rotation, Sine, SineSwing, Square, ThreePhase
from stickslip.quantities import Quantity
from stickslip.study.sweep import periodic_orbit

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


@pytest.mark.parametrize(("speed", "share", "error"), [(1.25, 0.08, 0.0061), (1.5, 0.304, 0.0065)])
def test_a_mass_on_a_belt_rests_from_as_many_starts_as_bstab_found(speed, share, error):
    """bSTAB, case_friction; its shares with their standard errors, as the tests of pybasin keep."""
    own = Stribeck(
        kinetic_coefficient=0.5, static_coefficient=1.0, stribeck_velocity=0.5, fading_exponent=1.0
    )
    belt = TowedBlock(mass=1.0, stiffness=1.0, damping=0.1, speed=speed, load=1.0)
    middles = (np.arange(20) + 0.5) / 20
    x, v = (one.ravel() for one in np.meshgrid(4.0 * middles - 2.0, 2.0 * middles))
    late = Samples("v", np.linspace(400.0, 500.0, 201).tolist())
    starts = {"initial.x": -x, "initial.v": speed - v}
    runs = ensemble(belt, own, starts, t_end=500.0, outputs={"v": late})
    still = np.mean(np.abs(speed - runs["v"]).max(axis=1) < 0.2)
    # a basin with an edge of a few cells in a row is known to a cell in each row
    assert still == pytest.approx(share, abs=2.0 * error + 1.0 / 20**1.5)


@pytest.mark.parametrize(("share", "sliding"), [(1.0 - 1e-4, False), (1.0 + 1e-4, True)])
def test_a_machine_slides_steadily_above_the_speed_of_veraszto_and_stepan(share, sliding):
    """Their Tables 1 and 2, and equation (11), as SKHiPPR quotes them."""
    mass, stiffness, damping = 0.538, 6957.0, 5.746
    speed = share * math.log(10.0 * (6.0 - 2.0) / (damping + 0.2)) / 10.0
    own = Stribeck(
        kinetic_coefficient=2.0, static_coefficient=6.0, stribeck_velocity=0.1,
        fading_exponent=1.0, viscous_coefficient=0.2,
    )  # fmt: skip
    machine = TowedBlock(mass=mass, stiffness=stiffness, damping=damping, speed=speed, load=1.0)
    level = 2.0 + 4.0 * math.exp(-10.0 * speed) + 0.2 * speed
    start = {"x": -level / stiffness, "v": speed + 1e-6}
    run = simulate(machine, own, t_end=20.0, y0=start)
    off = np.abs(run.at(np.linspace(0.0, 20.0, 20001))["v"] - speed)
    assert (off[-2000:].max() < off[:2000].max()) == sliding


@dataclass(frozen=True, kw_only=True)
class Microactuator(Mechanism):
    """A body of mass 5, and a mass of 1 on a spring of 1 inside."""

    name: ClassVar[str] = "microactuator"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "xi")
    rates: ClassVar[tuple[str, ...]] = ("v", "xi_dot")
    units: ClassVar[tuple[str, ...]] = ("m", "m")
    voltage: Annotated[float, Quantity("V", low=0)]
    signal: Drive

    def kinetic_energy(self, q, q_dot):
        inner = q_dot["x"] + q_dot["xi"]
        return 2.5 * q_dot["x"] * q_dot["x"] + 0.5 * inner * inner

    def potential_energy(self, t, q):
        return 0.5 * q["xi"] * q["xi"]

    def forces(self, t, q, q_dot, drives):
        pull = self.voltage**2 * drives["signal"] ** 2 / (1.0 - q["xi"]) ** 2
        return {"xi": pull - 0.04 * q_dot["xi"]}

    def contacts(self):
        return (Contact(slip="x", load=1.0),)

    def drives(self):
        return {"signal": self.signal}


def test_an_unstable_orbit_of_a_microactuator_is_that_of_recipes_for_continuation():
    """Dankowicz and Schilder 2013, Example 9.3: values with five digits, close to a fold."""
    phase, rate = -0.0095526, 0.9189
    signal = Sine(amplitude=1.0, frequency=rate / math.tau, phase=phase)
    orbit = periodic_orbit(
        Microactuator(voltage=0.58762, signal=signal),
        Coulomb(kinetic_coefficient=5.0 * 3.1784),
        start={"xi": 0.5},
        settle=0,
    )
    turn = orbit.run().at([(0.5 * math.pi - phase) / rate])
    assert not orbit.stable
    assert orbit.start["xi"] == pytest.approx(0.5, rel=5e-4)
    assert orbit.start["xi_dot"] == pytest.approx(0.0, abs=2e-6)
    assert turn["xi"][0] == pytest.approx(0.25073, rel=5e-4)
    assert turn["xi_dot"][0] == pytest.approx(0.0043073, rel=2e-5)


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
