"""Friction in a body: tissue that relaxes, and the environments that are composed.

Tissue is compared with closed forms of linear viscoelasticity, with an integration written here,
and with the balance of what its springs hold.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Axis, Capsule, Coulomb, Dahl, simulate
from stickslip.friction import SOURCES, TISSUES, bound, law
from stickslip.mechanisms import SoftStop, Torque, given_inputs
from stickslip.mechanisms.drives import Sine
from stickslip.study import check_law
from stickslip.study.sweep import periodic_orbit

STIFFNESSES, TIMES = (300.0, 150.0), (0.2, 2.0)
OWN = law("relaxing[2](level) + viscous")(
    kinetic_coefficient=1.0,
    bristle_stiffness=200.0,
    relaxing_stiffness_1=STIFFNESSES[0],
    relaxation_time_1=TIMES[0],
    relaxing_stiffness_2=STIFFNESSES[1],
    relaxation_time_2=TIMES[1],
    viscous_coefficient=0.4,
)
PUSH = Sine(amplitude=1.5, frequency=0.5)
RIG = Axis(inertia=1.0, drive=PUSH)
BELOW = 1e9
"""A level that is never reached: its share of the force is what yields."""


def moved(own, velocity, z, t):
    """Return the states after some time at velocities that are a function of time."""
    found = solve_ivp(
        lambda t, z: own.rates(velocity(t), 1.0, tuple(z)),
        (0.0, t), z, "DOP853", rtol=1e-10, atol=1e-14, max_step=0.02,
    )  # fmt: skip
    return found.y[:, -1]


# -- closed forms


def test_tissue_that_is_stretched_and_held_relaxes_as_two_exponentials():
    own = replace(OWN, kinetic_coefficient=BELOW)
    stretched = (1e-3, 1e-3, 1e-3)
    for t in (0.05, 0.3, 3.0, 30.0):
        z = moved(own, lambda _: 0.0, stretched, t)
        force = own.force(0.0, 5.0, tuple(z))
        springs = sum(k * math.exp(-t / tau) for k, tau in zip(STIFFNESSES, TIMES, strict=True))
        assert force == pytest.approx(5.0 * 1e-3 * (200.0 + springs), rel=1e-9)


@pytest.mark.parametrize("frequency", [0.1, 1.0, 3.0])
def test_a_body_on_tissue_swings_by_its_complex_stiffness(frequency):
    own = replace(OWN, kinetic_coefficient=BELOW, viscous_coefficient=20.0)
    rig = Axis(inertia=2.0, drive=Sine(amplitude=1.5, frequency=frequency))
    orbit = periodic_orbit(rig, own, settle=400)
    s = 2j * math.pi * frequency
    stiffness = 200.0 + sum(
        k * s * tau / (1.0 + s * tau) for k, tau in zip(STIFFNESSES, TIMES, strict=True)
    )
    amplitude = 1.5 / abs(stiffness + 20.0 * s + 2.0 * s**2)
    x = orbit.run().sampled(4001)["x"]
    # a share of 1e-9 yields, and samples miss the turning point by 1e-7 of it
    assert 0.5 * np.ptp(x) == pytest.approx(amplitude, rel=1e-6)


@pytest.mark.parametrize("speed", [1e-3, -0.3])
def test_long_sliding_brings_it_to_the_level(speed):
    z = moved(OWN, lambda _: speed, (0.0, 0.0, 0.0), 100.0)
    assert OWN.force(speed, 5.0, tuple(z)) == pytest.approx(OWN.steady(speed, 5.0), rel=1e-6)
    assert OWN.steady(speed, 5.0) == pytest.approx(math.copysign(5.0, speed) + 0.4 * speed)


def test_without_springs_that_relax_it_is_dahl():
    plain = replace(OWN, relaxing_stiffness_1=0.0, relaxing_stiffness_2=0.0)
    dahl = Dahl(kinetic_coefficient=1.0, bristle_stiffness=200.0, viscous_coefficient=0.4)
    (contained,) = (one for one in type(OWN).contained if one.law == "dahl")
    assert contained.embed(dahl)["relaxing_stiffness_1"] == 0.0
    ends = [simulate(RIG, one, t_end=3.0)["x"][-1] for one in (plain, dahl)]
    assert ends[0] == pytest.approx(ends[1], rel=1e-8)


# -- runs


def test_a_run_agrees_with_an_integration_of_its_equations():
    def field(t, y):
        _, v, z, *q = y
        force = 200.0 * z + sum(k * one for k, one in zip(STIFFNESSES, q, strict=True))
        z_dot = v - abs(v) * force
        q_dot = [z_dot - one / tau for one, tau in zip(q, TIMES, strict=True)]
        return [v, 1.5 * math.sin(math.pi * t) - force - 0.4 * v, z_dot, *q_dot]

    run = simulate(RIG, OWN, t_end=3.0)
    known = solve_ivp(
        field, (0.0, 3.0), [0.0] * 5, "DOP853", rtol=1e-11, atol=1e-14, max_step=0.01
    ).y[:, -1]
    assert run.certificate.certified
    names = ("x", "v", "z", "q1", "q2")
    # the integration does not locate the turns of the velocity, at which the rates have a corner
    np.testing.assert_allclose([run[name][-1] for name in names], known, rtol=1e-6, atol=1e-9)


def test_the_mirror_image_of_a_run_is_a_run():
    back = replace(RIG, drive=replace(PUSH, amplitude=-1.5))
    run, image = (simulate(one, OWN, t_end=3.0) for one in (RIG, back))
    for name in ("x", "v", "z", "q1", "q2"):
        np.testing.assert_array_equal(image[name], -run[name])


@pytest.mark.parametrize(
    "name", ["kinetic_coefficient", "relaxing_stiffness_1", "relaxation_time_2"]
)
def test_sensitivities_are_those_of_differences(name):
    value = getattr(OWN, name)
    ends = [
        simulate(RIG, replace(OWN, **{name: value * (1.0 + d)}), t_end=1.5)["x"][-1]
        for d in (-1e-4, 1e-4)
    ]
    difference = (ends[1] - ends[0]) / (2e-4 * value)
    found = simulate(RIG, OWN, t_end=1.5).sensitivity("x", name)[-1]
    # differences of second order have errors of 1e-8, runs of 1e-10 of the place over 1e-4
    assert found == pytest.approx(difference, rel=1e-4, abs=1e-7 / value)


# -- passivity


@pytest.mark.parametrize("seed", range(8))
def test_it_takes_at_least_what_its_springs_hold(seed):
    """Work against the force, less the energy of the springs, never falls."""
    dice = np.random.default_rng(seed)
    values = 10.0 ** dice.uniform(-1.5, 1.5, 5) * (200.0, 300.0, 0.2, 150.0, 2.0)
    names = ("bristle_stiffness", "relaxing_stiffness_1", "relaxation_time_1",
             "relaxing_stiffness_2", "relaxation_time_2")  # fmt: skip
    own = replace(OWN, viscous_coefficient=0.0, **dict(zip(names, values, strict=True)))
    sizes, rates = 10.0 ** dice.uniform(-3.0, 0.0, 4), 10.0 ** dice.uniform(-1.0, 1.5, 4)
    phases = dice.uniform(0.0, 2.0 * math.pi, 4)

    def field(t, y):
        v = float(np.sum(sizes * np.sin(rates * t + phases)))
        return [*own.rates(v, 1.0, tuple(y[:3])), v * own.force(v, 1.0, tuple(y[:3]))]

    times = np.linspace(0.0, 10.0, 201)
    y = solve_ivp(field, (0.0, 10.0), [0.0] * 4, "LSODA", times, rtol=1e-9, atol=1e-13).y
    k = np.array([values[0], values[1], values[3]])
    held = 0.5 * np.sum(k[:, None] * y[:3] ** 2, axis=0)
    lost = y[3] - held
    assert np.diff(lost).min() >= -1e-7 * np.abs(y[3]).max()
    assert type(own).passivity.holds(own, 1.0)


def test_an_input_inside_its_memory_leaves_passivity_open():
    assert law("relaxing[1](level)").passivity.condition == "always"
    assert law("relaxing[1](level + weight[pressure])").passivity is None


def test_a_ripple_that_turns_friction_round_is_not_passive():
    kind = TISSUES["folds"].law
    values = {
        "kinetic_coefficient": 0.01, "logarithmic_coefficient": 0.001, "reference_velocity": 0.002,
        "position_harmonic": 600.0, "viscous_coefficient": 0.4,
    }  # fmt: skip
    for cosine, sine, passive in ((0.6, 0.7, True), (0.8, 0.7, False)):
        own = kind(position_cosine=cosine, position_sine=sine, **values)
        assert kind.passivity.holds(own, 1.0) is passive
        places = np.linspace(0.0, 0.01, 101)
        least = min(bound(own, {"position": x}).force(1e-3, 1.0) for x in places)
        assert (least >= 0.0) is passive


def test_the_suite_for_laws_knows_that_tissue_relaxes_at_rest():
    check_law(OWN)


# -- environments

VALUES = {
    "kinetic_coefficient": 0.01,
    "forward_kinetic_coefficient": 0.01,
    "backward_kinetic_coefficient": 0.03,
    "viscous_coefficient": 0.05,
    "viscous_exponent": 0.6,
    "logarithmic_coefficient": 0.001,
    "reference_velocity": 0.002,
    "position_cosine": 0.5,
    "position_sine": 0.0,
    "position_harmonic": 600.0,
    "pressure_coefficient": 1e-5,
    "bristle_stiffness": 20.0,
    "relaxing_stiffness_1": 30.0,
    "relaxation_time_1": 0.2,
    "relaxing_stiffness_2": 20.0,
    "relaxation_time_2": 2.0,
}
CAPSULE = Capsule(
    capsule_mass=4e-3,
    inner_mass=2e-3,
    stiffness=30.0,
    damping=0.01,
    upper_soft_stop=SoftStop(place=5e-4, stiffness=3000.0),
    drive=Torque(drive=Sine(amplitude=0.02, frequency=15.0)),
    drive_on="inner mass",
    squeeze=0.1,
)


@pytest.mark.parametrize("name", TISSUES)
def test_a_capsule_moves_in_each_environment_with_a_certificate(name):
    tissue = TISSUES[name]
    assert set(tissue.sources) <= set(SOURCES)
    kind = tissue.law
    assert kind.passivity is not None
    fields = kind.made_of.fields
    own = kind(**{field: VALUES[field] for field in fields if field in VALUES})
    assert kind.passivity.holds(own, 0.1)
    rig = CAPSULE
    if "pressure" in kind.inputs:
        rig = given_inputs(rig, {"pressure": Sine(amplitude=500.0, frequency=0.2)})
    run = simulate(rig, own, t_end=1.0)
    assert run.certificate.certified
    assert run.certificate.work_friction > 0.0
    assert np.ptp(run["x"]) > 1e-5


def test_the_squeeze_of_walls_acts_as_so_much_more_weight():
    weight = CAPSULE.gravity * (CAPSULE.capsule_mass + CAPSULE.inner_mass)
    own = Coulomb(kinetic_coefficient=0.1, static_coefficient=0.15)
    run = simulate(CAPSULE, own, t_end=1.0)
    np.testing.assert_allclose(run["normal_force"], weight + 0.1, rtol=1e-14)
    more = 1.0 + 0.1 / weight
    heavier = Coulomb(kinetic_coefficient=0.1 * more, static_coefficient=0.15 * more)
    other = simulate(replace(CAPSULE, squeeze=0.0), heavier, t_end=1.0)
    assert run["x"][-1] == pytest.approx(other["x"][-1], rel=1e-9)
    assert np.ptp(run["x"]) > 1e-4
    alpha = CAPSULE.dimensionless_numbers(0.1)["alpha"]
    assert alpha == pytest.approx(0.02 / (0.1 * (weight + 0.1)), rel=1e-14)


def test_on_a_slope_the_squeeze_is_across_the_ground():
    slope = replace(CAPSULE, incline=0.3, drive=Torque(drive=Sine(amplitude=0.0, frequency=1.0)))
    weight = CAPSULE.gravity * (CAPSULE.capsule_mass + CAPSULE.inner_mass)
    run = simulate(slope, Coulomb(kinetic_coefficient=0.01), t_end=0.05)
    np.testing.assert_allclose(run["normal_force"], weight * math.cos(0.3) + 0.1, rtol=1e-12)
