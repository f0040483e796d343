"""Steps by Taylor series against matrix exponentials, and which modes may take them."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from tests.support import Generated, decade, examples, nearly

from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    CoulombViscous,
    EventDriven,
    SpringBlock,
    Stribeck,
    TowedBlock,
    Viscous,
    simulate,
)
from stickslip.engine.kernels.state_layout import DENSE, FLAGS, MODE, SCALE, SERIES, Y1, Y
from stickslip.engine.kernels.steppers import series_step
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import PiecewiseLinear, Pulse, Sine

MANY = examples(100)
ROUNDING = 3e-15
"""Each of twenty terms adds a few roundings, and the exponential it is compared with some more."""

# What is propagated: m x'' = force + growth t - c x' - k x, put down by hand

directions = st.sampled_from([1, -1])
laws = st.builds(
    CoulombViscous,
    kinetic_coefficient=decade(-2, 0),
    viscous_coefficient=st.just(0.0) | decade(-2, 3),
)
lines = st.builds(
    lambda a, b: PiecewiseLinear(times=(0.0, 8.0), values=(a, b)), nearly(-20, 20), nearly(-20, 20)
)
axes = st.builds(
    Axis,
    inertia=decade(-2, 2),
    drive=lines,
    stiffness=st.just(0.0) | decade(-1, 4),
    damping=st.just(0.0) | decade(-2, 3),
    load=decade(-1, 2),
    offset=nearly(-1, 1),
)
spring_blocks = st.builds(
    SpringBlock,
    mass=decade(-2, 2),
    stiffness=decade(0, 4),
    compression=nearly(0.01, 0.2),
    attached=st.booleans(),
    drive=lines,
)
towed_blocks = st.builds(
    TowedBlock,
    mass=decade(-2, 2),
    stiffness=decade(-1, 4),
    speed=nearly(-0.5, 0.5),
    damping=st.just(0.0) | decade(-2, 3),
)


def line(drive):
    first, last = drive.values
    return first, (last - first) / 8.0


def coefficients(rig, law, sign, touching):
    """Return m, c, k, force at time 0 and its growth for a sliding body."""
    mu, sigma = law.kinetic_coefficient, law.viscous_coefficient
    if isinstance(rig, Axis):
        force, growth = line(rig.drive)
        force -= rig.offset + sign * mu * rig.load
        return rig.inertia, rig.damping + sigma, rig.stiffness, force, growth
    friction = sign * mu * rig.mass * rig.gravity
    if isinstance(rig, SpringBlock):
        force, growth = line(rig.drive)
        k = rig.stiffness if touching else 0.0
        return rig.mass, sigma, k, force - friction + k * rig.compression, growth
    c, k = rig.damping, rig.stiffness
    return rig.mass, c + sigma, k, c * rig.speed - friction, k * rig.speed


def scaled_step(numbers, t, h, x, v):
    """Return the size of the state in a step, and exact position and h times velocity over it."""
    m, c, k, force, growth = numbers
    speed = abs(v) + h * (abs(force) + abs(growth) * (t + h) + c * abs(v) + k * abs(x)) / m
    size = abs(x) + h * speed
    A = np.zeros((4, 4))  # of position, h times velocity, a constant, the share of the step
    A[0, 1] = 1.0
    A[1] = -h * h * k / m, -h * c / m, h * h / m * (force + growth * t), h * h / m * growth * h
    A[1, 2:] /= size
    A[3, 2] = 1.0
    return size, expm(A) @ np.array([x / size, h * v / size, 1.0, 0.0])


class Stepper:
    """Takes series steps of one rig in one mode."""

    def __init__(self, rig, law, sign, x, v):
        generated = Generated(rig, law)
        self.w, self.iw = generated.equations.w, generated.equations.iw
        self.iw[MODE], self.iw[FLAGS] = sign, generated.flags([x, v])
        generated.equations.load_at(0.0)
        self.y = [x, v]

    def step(self, t, h):
        """Return the tail over what is allowed, and the new state."""
        w, iw = self.w, self.iw
        w[iw[Y] : iw[Y] + 2] = self.y
        w[iw[SCALE] : iw[SCALE] + 2] = [0.0, 0.0]
        tail = series_step(t, h, w, iw, iw[Y])
        return tail, w[iw[Y1] : iw[Y1] + 2]

    def accepted(self, t, h):
        """Return the first length that is accepted, and the new state."""
        for _ in range(60):
            tail, y = self.step(t, h)
            if tail <= 1.0:
                return h, y
            h *= 0.95 * tail ** (-1.0 / SERIES) if tail < 1e60 else 1e-3
        raise AssertionError("no step is short enough")


@pytest.mark.parametrize("rigs", [axes, spring_blocks, towed_blocks], ids=["axis", "block", "tow"])
@MANY
@given(
    data=st.data(),
    law=laws,
    sign=directions,
    t=st.just(0.0) | nearly(0, 8),
    x=nearly(-0.5, 0.5),
    speed=decade(-3, 1),
    length=decade(-4, 2),
)
def test_a_step_is_that_of_the_matrix_exponential(rigs, data, law, sign, t, x, speed, length):
    rig = data.draw(rigs)
    v = sign * speed
    stepper = Stepper(rig, law, sign, x, v)
    touching = getattr(rig, "attached", True) or rig.compression > x
    h, (x1, v1) = stepper.accepted(t, length)
    numbers = coefficients(rig, law, sign, touching)
    size, exact = scaled_step(numbers, t, h, x, v)
    assert abs(x1 / size - exact[0]) <= ROUNDING
    assert abs(h * v1 / size - exact[1]) <= ROUNDING


def swung(rig, law, sign, t, h, x, v):
    """Return the size of the state in a step under a sine, and the exact state over it."""
    m, c, k, wave = rig.inertia, rig.damping, rig.stiffness, rig.drive
    c += law.viscous_coefficient
    force = -rig.offset - sign * law.kinetic_coefficient * rig.load
    turn = 2.0 * math.pi * wave.frequency
    angle = turn * t + wave.phase
    speed = abs(v) + h * (abs(force) + abs(wave.amplitude) + c * abs(v) + k * abs(x)) / m
    size = abs(x) + h * speed
    A = np.zeros((5, 5))  # of position, h times velocity, a constant, sine, cosine
    A[0, 1] = 1.0
    A[1] = -h * h * k / m, -h * c / m, h * h / m * force, h * h / m * wave.amplitude, 0.0
    A[1, 2:] /= size
    A[3, 4], A[4, 3] = turn * h, -turn * h
    start = [x / size, h * v / size, 1.0, math.sin(angle), math.cos(angle)]
    return size, expm(A) @ np.array(start)


@MANY
@given(
    rig=axes,
    wave=st.builds(Sine, amplitude=nearly(-20, 20), frequency=decade(-3, 2), phase=nearly(-3, 3)),
    law=laws,
    sign=directions,
    t=st.just(0.0) | nearly(0, 8),
    x=nearly(-0.5, 0.5),
    speed=decade(-3, 1),
    length=decade(-4, 2),
)
def test_a_step_under_a_sine_is_that_of_an_exponential_with_an_oscillator(
    rig, wave, law, sign, t, x, speed, length
):
    rig = replace(rig, drive=wave)
    v = sign * speed
    h, (x1, v1) = Stepper(rig, law, sign, x, v).accepted(t, length)
    size, exact = swung(rig, law, sign, t, h, x, v)
    # the sine of an angle has the rounding of the angle, which a time gives
    blur = ROUNDING * (1.0 + 2.0 * math.pi * wave.frequency * t)
    assert abs(x1 / size - exact[0]) <= blur
    assert abs(h * v1 / size - exact[1]) <= blur


# Length of steps


@pytest.mark.parametrize("frequency", [1e-3, 1.0, 1e6])
def test_a_step_covers_more_than_a_radian_of_a_sine_that_drives(frequency):
    turn = Sine(amplitude=1.0, frequency=frequency / (2.0 * math.pi))
    axis = Axis(inertia=1.0, drive=turn, load=0.0)
    stepper = Stepper(axis, Coulomb(kinetic_coefficient=0.0), 1, 0.0, 1.0 / frequency)
    h, (_, v) = stepper.accepted(0.0, 50.0 / frequency)
    assert 0.9 < h * frequency < 1.5
    assert math.isclose(v, (2.0 - math.cos(h * frequency)) / frequency, rel_tol=4e-16)


@pytest.mark.parametrize("frequency", [1e-3, 1.0, 1e6])
def test_a_step_covers_more_than_a_radian_of_an_oscillation(frequency):
    axis = Axis(inertia=1.0, stiffness=frequency**2)
    stepper = Stepper(axis, Coulomb(kinetic_coefficient=0.0), 1, 0.3, 0.1 * frequency)
    h, (x, v) = stepper.accepted(0.0, 50.0 / frequency)
    angle = h * frequency
    assert 1.0 < angle < 1.5
    exact = 0.3 * math.cos(angle) + 0.1 * math.sin(angle)
    assert math.isclose(x, exact, abs_tol=2e-16)  # a unit in the last place of the amplitude
    slope = (0.1 * math.cos(angle) - 0.3 * math.sin(angle)) * frequency
    assert math.isclose(v, slope, abs_tol=2e-16 * frequency)


def test_the_tail_is_that_of_the_last_two_terms_over_the_last_digit_of_the_state():
    stepper = Stepper(Axis(inertia=1.0, stiffness=1.0), Coulomb(kinetic_coefficient=0.0), 1, 1.0, 0)
    h = 1.3
    tail, (_, v) = stepper.step(0.0, h)
    term = h**20 / math.factorial(20)
    before = h**19 / math.factorial(19)
    # cosine in the position has term 20, sine in the velocity term 19
    assert math.isclose(tail, max(term / 1.0, before / abs(v)) / 1e-16, rel_tol=1e-12)


@pytest.mark.parametrize("length", [10.0, 1e3, 1e15, 1e200, 1e308])
def test_a_step_that_is_far_too_long_is_refused_and_its_remedy_ends(length):
    stepper = Stepper(
        Axis(inertia=1.0, stiffness=1.0), Coulomb(kinetic_coefficient=0.1), 1, 1.0, 0.5
    )
    assert stepper.step(0.0, length)[0] > 1.0
    h, _ = stepper.accepted(0.0, length) if length < 1e100 else stepper.accepted(0.0, 1e100)
    assert 0.5 < h < 1.5


@pytest.mark.parametrize("length", [1e-6, 1.0, 1e8])
def test_uniform_acceleration_is_one_step_however_long(length):
    axis = Axis(inertia=2.0, drive=PiecewiseLinear(times=(0.0,), values=(5.0,)))
    stepper = Stepper(axis, Coulomb(kinetic_coefficient=1.0), 1, 0.25, 0.5)
    tail, (x, v) = stepper.step(0.0, length)
    assert tail == 0.0
    assert stepper.w[stepper.iw[DENSE]] == 2.0  # terms after the first
    # three terms, each with a rounding or two
    assert math.isclose(x, 0.25 + 0.5 * length + length**2, rel_tol=5e-16)
    assert math.isclose(v, 0.5 + 2.0 * length, rel_tol=5e-16)


# Which modes are linear

SINE = Sine(amplitude=1.0, frequency=2.0)
LINEAR_LAWS = [
    Coulomb(kinetic_coefficient=0.2),
    Coulomb(kinetic_coefficient=0.2, static_coefficient=0.3),
    Viscous(viscous_coefficient=0.4),
    CoulombViscous(kinetic_coefficient=0.2, viscous_coefficient=0.4),
]
each_linear_law = pytest.mark.parametrize("law", LINEAR_LAWS, ids=lambda law: law.name)
STRIBECK = Stribeck(
    kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01, viscous_coefficient=0.5
)


def rigs_with(drive):
    return [
        Axis(inertia=2.0, drive=drive, stiffness=3.0, damping=0.2, offset=0.1),
        SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, drive=drive),
        SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True, drive=drive),
        SpringBlock(mass=1.0, drive=drive),
    ]


def linear(rig, law, mode, y):
    return Generated(rig, law).moving("linear", mode, y)[0]


@each_linear_law
@pytest.mark.parametrize("drive", [SINE, SINE + Pulse(level=1.0, duration=0.1)])
@pytest.mark.parametrize("mode", [-1, 0, 1])
def test_modes_under_a_sine_are_linear_with_a_harmonic(law, drive, mode):
    for rig in rigs_with(drive):
        assert linear(rig, law, mode, [0.0, 0.1 * mode]) == 1.0


@each_linear_law
@pytest.mark.parametrize("mode", [-1, 0, 1])
def test_modes_under_sines_are_linear_if_their_frequency_is_one_parameter(law, mode):
    wave = Sine(amplitude=0.5, frequency=3.0)
    for rig in rigs_with(SINE + wave):
        assert linear(rig, law, mode, [0.0, 0.1 * mode]) == 0.0


@pytest.mark.parametrize("mode", [-1, 1])
def test_the_law_of_stribeck_is_linear_outside_its_layer_only(mode):
    layer = 0.01 * math.sqrt(36.0)
    towed = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1)
    for rig in (*rigs_with(None), *rigs_with(SINE), towed):
        for x in (0.0, 0.2):
            assert linear(rig, STRIBECK, mode, [x, 0.999 * layer * mode]) == 0.0
            assert linear(rig, STRIBECK, mode, [x, 1e-6 * mode]) == 0.0
            assert linear(rig, STRIBECK, mode, [x, 1.001 * layer * mode]) == 1.0


def test_a_body_held_by_the_law_of_stribeck_is_linear():
    for rig in (*rigs_with(None), TowedBlock(mass=1.0, stiffness=2.0, speed=0.1)):
        assert linear(rig, STRIBECK, 0, [0.0, 0.0]) == 1.0


# Where series would take too many steps


@pytest.mark.parametrize("viscous", [1e3, 1e5, 1e7])
@pytest.mark.parametrize("t_end", [1.0, 200.0])
def test_very_viscous_friction_takes_few_steps(viscous, t_end):
    m, k, x_0 = 1.0, 10.0, 0.3
    run = simulate(
        Axis(inertia=m, stiffness=k),
        Viscous(viscous_coefficient=viscous),
        t_end=t_end,
        y0={"x": x_0},
    )
    assert run.certificate.steps + run.certificate.rejected < 2000
    fast = (viscous + math.sqrt(viscous**2 - 4 * k * m)) / (2 * m)
    slow = k / (m * fast)
    t = np.linspace(0.0, t_end, 101)
    x = x_0 * (fast * np.exp(-slow * t) - slow * np.exp(-fast * t)) / (fast - slow)
    # some hundred steps of 1e-12 of the largest value each; the velocity is that of the creep
    np.testing.assert_allclose(run.at(t)["x"], x, rtol=0, atol=1e-11 * x_0)
    v = -x_0 * k / m * (np.exp(-slow * t) - np.exp(-fast * t)) / (fast - slow)
    np.testing.assert_allclose(run.at(t)["v"], v, rtol=0, atol=1e-9 * np.abs(v).max())


def test_a_very_viscous_body_follows_a_broken_line_of_force():
    sigma = 1e7
    line = PiecewiseLinear(times=(0.0, 0.5, 1.0), values=(0.0, 1e3, -1e3))
    law = Viscous(viscous_coefficient=sigma)
    run = simulate(Axis(inertia=1.0, drive=line), law, t_end=1.5)
    assert run.certificate.steps + run.certificate.rejected < 2000
    # momentum: what friction took is what the force gave, but for the last of the velocity
    push = 0.5 * 0.5 * 1e3
    assert math.isclose(run["x"][-1], (push - 0.5 * 1e3 - run["v"][-1]) / sigma, rel_tol=1e-10)
    assert math.isclose(run["v"][-1], -1e3 / sigma, rel_tol=1e-10)


@pytest.mark.parametrize("amplitude", [0.0, 0.2])
def test_series_of_two_coordinates_are_the_exponential_of_their_matrix(amplitude):
    """Of the states and the sine and cosine of the force on the inner mass, to rounding."""
    outer, inner, k, c, w, t_end = 0.08, 0.02, 60.0, 0.03, 2.0 * np.pi * 5.0, 0.5
    rig = Capsule(
        capsule_mass=outer, inner_mass=inner, stiffness=k, damping=c, drive_on="inner mass",
        drive=Torque(drive=Sine(amplitude=amplitude, frequency=5.0)),
    )  # fmt: skip
    start = np.array([0.0, 1e-3, 0.2, -0.1])
    run = EventDriven().run(rig, Coulomb(kinetic_coefficient=0.0), y0=start.tolist(), t_end=t_end)
    matrix, both = np.zeros((6, 6)), 1.0 / outer + 1.0 / inner
    matrix[0, 2] = matrix[1, 3] = 1.0
    matrix[2, [1, 3]], matrix[3, [1, 3]] = [k / outer, c / outer], [-k * both, -c * both]
    matrix[3, 4], matrix[4, 5], matrix[5, 4] = amplitude / inner, w, -w
    exact = expm(matrix * t_end) @ [*start, 0.0, 1.0]
    found = [run.at([t_end])[name][0] for name in ("x", "xi", "v", "xi_dot")]
    np.testing.assert_allclose(found, exact[:4], rtol=0.0, atol=1e-13)
