"""Laws of control: PID, compensation of friction, partial feedback linearisation."""

import math

import numpy as np
import pytest

from stickslip import Capsule, Coulomb, DirectionDependent, LuGre, PendulumCart, Stribeck, simulate
from stickslip.errors import InputError, ParameterError, UnknownNameError
from stickslip.friction import bound
from stickslip.friction import law as law_of
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import ThreePhase
from stickslip.study.control import (
    PID,
    PartialLinearisation,
    closed_loop,
    compensation,
    dynamics_at,
)

M, BALL, L, G = 0.5, 0.1, 0.3, 9.81
MU = 0.2
CART = PendulumCart(cart_mass=M, ball_mass=BALL, length=L)
LAW = Coulomb(kinetic_coefficient=MU)
ML = BALL * L


def samples(controller, errors, dt=0.1, v=0.0):
    return [controller(k * dt, {"x": -e, "v": v}) for k, e in enumerate(errors)]


def test_the_integral_part_is_the_sum_of_errors():
    pid = PID(proportional=2.0, integral=5.0)
    commands = samples(pid, [1.0, 0.5, -0.25])
    expected = [2.0, 1.0 + 5.0 * 0.05, -0.5 + 5.0 * (0.05 - 0.025)]
    np.testing.assert_allclose(commands, expected, rtol=1e-14)


def test_a_saturated_integral_part_does_not_wind_up():
    pid = PID(proportional=1.0, integral=10.0, limit=2.0)
    up = samples(pid, [1.0] * 50)
    assert max(up) == 2.0
    # held at the last value inside, it leaves the limit at the first error of the other sign
    assert pid(5.0, {"x": 0.1, "v": 0.0}) < 1.0
    wound = PID(proportional=1.0, integral=10.0)
    samples(wound, [1.0] * 50)
    assert wound(5.0, {"x": 0.1, "v": 0.0}) > 40.0


def test_back_calculation_holds_the_integral_part_where_the_error_feeds_the_surplus():
    pid = PID(proportional=1.0, integral=10.0, limit=2.0, tracking_time=0.5)
    samples(pid, [1.0] * 200)
    # each sample adds K_i e T = 1 and takes T/T_t = 0.2 of the surplus K_p e + I - limit: 5 of it
    # stands before, 4 after it is taken
    assert pid._memory.integral == pytest.approx(2.0 + 4.0 - 1.0, rel=1e-12)


def test_a_rate_that_is_not_measured_is_estimated():
    plain = PID(proportional=0.0, derivative=1.0, rate=None)
    ramp = [plain(0.1 * k, {"x": 0.3 * 0.1 * k}) for k in range(4)]
    np.testing.assert_allclose(ramp, [0.0, -0.3, -0.3, -0.3], rtol=1e-12)
    smooth = PID(proportional=0.0, derivative=1.0, rate=None, filter_time=0.1)
    found = [smooth(0.1 * k, {"x": 0.3 * 0.1 * k}) for k in range(4)]
    np.testing.assert_allclose(found, [-0.3 * (1.0 - 0.5**k) for k in range(4)], rtol=1e-12)


def test_what_pid_cannot_use_is_refused():
    with pytest.raises(ParameterError, match="tracking_time"):
        PID(proportional=1.0, tracking_time=1.0)
    with pytest.raises(ParameterError, match="feedforward must be callable"):
        PID(proportional=1.0, feedforward=3.0)
    with pytest.raises(InputError, match="'theta' is not measured; measured quantities: x, v"):
        PID(proportional=1.0, state="theta")(0.0, {"x": 0.0, "v": 0.0})


LAWS = [
    LAW,
    Stribeck(kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.01),
    DirectionDependent(
        forward_kinetic_coefficient=0.2,
        backward_kinetic_coefficient=0.3,
        forward_viscous_coefficient=1.0,
        backward_viscous_coefficient=2.0,
    ),
]


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
@pytest.mark.parametrize("v", [-0.2, -0.011, 0.011, 0.2])
def test_beyond_the_crossing_the_compensation_is_the_law(law, v):
    push = compensation(law, width=0.01, factor=1.2, load=7.0)
    assert push(0.0, {"v": v}) == pytest.approx(1.2 * law.force(v, 7.0), rel=1e-15)


def test_the_crossing_is_smooth_and_odd():
    push = compensation(LAW, width=0.01)
    v = np.linspace(-0.02, 0.02, 4001)
    force = np.array([push(0.0, {"v": speed}) for speed in v])
    np.testing.assert_allclose(force, -force[::-1], rtol=0, atol=1e-15)  # v is odd to rounding
    slope = np.diff(force) / np.diff(v)
    # continuous: the slope, 1.5 mu / w at most, changes by at most its own slope times a step
    assert slope.max() <= 1.5 * MU / 0.01
    assert np.abs(np.diff(slope)).max() <= 3.0 * MU / 0.01**2 * 1e-5 * 1.01


def test_bristles_are_compensated_by_their_steady_force():
    law = LuGre(
        kinetic_coefficient=0.2,
        static_coefficient=0.3,
        stribeck_velocity=0.01,
        bristle_stiffness=1e4,
        bristle_damping=10.0,
    )
    push = compensation(law, width=1e-3, load=2.0, velocity=lambda t: 0.5 * t)
    assert push(0.1, {}) == pytest.approx(law.steady(0.05, 2.0), rel=1e-15)


def test_the_load_may_be_a_function():
    push = compensation(LAW, width=1e-3, load=lambda t, seen: 3.0 + seen["x"])
    assert push(0.0, {"x": 1.0, "v": 1.0}) == pytest.approx(4.0 * MU)
    with pytest.raises(InputError, match="'v' is not measured"):
        push(0.0, {"x": 1.0})


def test_the_equations_of_the_cart_are_those_on_paper():
    theta, omega = 0.7, -3.0
    here = dynamics_at(CART, q={"theta": theta}, q_dot={"omega": omega, "v": 0.2})
    s, c = math.sin(theta), math.cos(theta)
    expected = [[M + BALL, -ML * c], [-ML * c, BALL * L * L]]
    np.testing.assert_allclose(here.mass, expected, rtol=1e-13)
    np.testing.assert_allclose(here.forces, [-ML * s * omega**2, ML * G * s], rtol=1e-12)
    assert here.friction_direction.tolist() == [1.0, 0.0]
    np.testing.assert_allclose(here.command_direction, [0.0, 1.0], rtol=0, atol=1e-12)
    friction, torque = 0.4, -0.3
    _, turning = here.accelerations(friction, torque)
    normal = (M + BALL) * G - ML * (s * turning + c * omega**2)
    assert here.normal_force(friction, torque) == pytest.approx(normal, rel=1e-12)


def test_mechanisms_whose_motion_is_told_have_no_command():
    told = Prescribed(profile=ThreePhase(amplitude=0.8, fast=120.0, slow=30.0))
    with pytest.raises(InputError, match="prescribed motion"):
        dynamics_at(Capsule(capsule_mass=1.0, inner_mass=0.2, drive=told))
    with pytest.raises(UnknownNameError):
        dynamics_at(CART, q={"phi": 1.0})


def steering(track, **settings):
    return PartialLinearisation(
        mechanism=CART, law=LAW, track=track, stiffness=0.0, damping=0.0, **settings
    )


@pytest.mark.parametrize("v", [-0.3, 0.3])
@pytest.mark.parametrize("theta", [-0.9, 0.0, 0.4])
def test_collocated_commands_are_those_derived_by_hand(theta, v):
    omega, wanted = 2.5, 11.0
    s, c = math.sin(theta), math.cos(theta)
    normal = (M + BALL) * G - ML * (s * wanted + c * omega**2)
    friction = math.copysign(MU, v) * normal
    a = (ML * c * wanted - ML * s * omega**2 - friction) / (M + BALL)
    torque = BALL * L**2 * wanted - ML * c * a - ML * G * s
    seen = {"x": 0.0, "v": v, "theta": theta, "omega": omega}
    found = steering("theta", reference_acceleration=wanted)(0.0, seen)
    assert found == pytest.approx(torque, rel=1e-11)


@pytest.mark.parametrize("v", [-0.3, 0.3])
@pytest.mark.parametrize("theta", [-0.9, 0.0, 0.4])
def test_non_collocated_commands_are_those_derived_by_hand(theta, v):
    omega, wanted = 1.5, 0.8
    s, c, mu = math.sin(theta), math.cos(theta), math.copysign(MU, v)
    gained = (M + BALL) * (wanted + mu * G) + ML * omega**2 * (s - mu * c)
    turning = gained / (ML * (c + mu * s))
    torque = BALL * L**2 * turning - ML * c * wanted - ML * G * s
    seen = {"x": 0.0, "v": v, "theta": theta, "omega": omega}
    found = steering("x", reference_acceleration=wanted)(0.0, seen)
    assert found == pytest.approx(torque, rel=1e-11)


@pytest.mark.parametrize("v", [-0.3, 0.3])
def test_the_non_collocated_law_is_singular_on_the_cone_of_friction(v):
    edge = -math.copysign(math.atan(1.0 / MU), v)

    def gain(theta):
        here = dynamics_at(CART, q={"theta": theta}, q_dot={"v": v})
        mu = math.copysign(MU, v)
        friction = mu * here.normal / (1.0 - mu * here.normal_by_friction)
        alone = here.accelerations(friction)[0]
        state = {"x": 0.0, "v": v, "theta": theta, "omega": 0.0}
        # so little more than what it does without a command that nothing lifts the cart
        return steering("x", reference_acceleration=alone + 1e-7)(0.0, state)

    assert gain(edge - 1e-6) * gain(edge + 1e-6) < 0.0
    steer = steering("x", least=1e-3)
    steer(0.5, {"x": 0.0, "v": v, "theta": edge, "omega": 0.0})
    assert steer.singular == (0.5,)
    steer.reset()
    assert steer.singular == ()


def test_without_friction_it_is_singular_where_the_rod_is_level():
    smooth = Coulomb(kinetic_coefficient=0.0)
    steer = PartialLinearisation(
        mechanism=CART, law=smooth, track="x", stiffness=0.0, damping=0.0, least=1e-9,
    )  # fmt: skip
    steer(0.0, {"x": 0.0, "v": 0.1, "theta": math.pi / 2, "omega": 0.0})
    steer(0.1, {"x": 0.0, "v": 0.1, "theta": math.pi / 2 - 0.01, "omega": 0.0})
    assert steer.singular == (0.0,)


def test_a_command_that_would_lift_the_cart_is_not_given():
    steer = steering("theta", reference_acceleration=1e3)
    assert steer(0.0, {"x": 0.0, "v": 0.1, "theta": 1.0, "omega": 0.0}) == 0.0
    assert steer.singular == (0.0,)


def test_a_swing_that_is_followed_carries_the_cart_as_one_that_is_prescribed():
    swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    told = PendulumCart(
        cart_mass=M, ball_mass=BALL, length=L, pendulum=Prescribed(profile=swing)
    )  # fmt: skip
    T = float(swing.period)
    travel = simulate(told, LAW, t_end=T)["x"][-1]
    y0 = {"theta": float(swing.start_position), "omega": float(swing.start_rate)}

    def off(period):
        steer = PartialLinearisation(
            mechanism=CART, law=LAW, track="theta", stiffness=900.0, damping=60.0,
            reference=lambda t: swing.at(t)[0],
            reference_rate=lambda t: swing.at(t)[1],
            reference_acceleration=swing.value,
        )  # fmt: skip
        loop = closed_loop(CART, LAW, steer, period=period, t_end=T, y0=y0)
        assert steer.singular == ()
        return abs(loop.run["x"][-1] / travel - 1.0)

    # a sampled command lags by half a period: of first order
    assert off(2e-3) < 0.006
    assert off(2.5e-4) < 0.00075


def test_a_cart_that_is_steered_through_its_pendulum_pays_with_the_swing():
    lasts, far = 0.1, 0.005

    def rest_to_rest(t):
        s = min(t / lasts, 1.0)
        return (
            far * s**3 * (10.0 - 15.0 * s + 6.0 * s * s),
            far / lasts * 30.0 * s * s * (1.0 - s) ** 2,
            far / lasts**2 * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s),
        )

    steer = PartialLinearisation(
        mechanism=CART, law=LAW, track="x", stiffness=2500.0, damping=100.0,
        reference=lambda t: rest_to_rest(t)[0],
        reference_rate=lambda t: rest_to_rest(t)[1],
        reference_acceleration=lambda t: rest_to_rest(t)[2],
    )  # fmt: skip
    loop = closed_loop(
        CART, LAW, steer, period=1e-3, t_end=lasts, y0={"theta": math.radians(-60.0)}
    )  # fmt: skip
    error = loop.run.at(loop.t)["x"] - [rest_to_rest(t)[0] for t in loop.t]
    # half a period of lag at the peak speed of 0.094 m/s
    assert np.abs(error).max() < 1e-3 / 2.0 * 0.094
    times = np.linspace(0.0, lasts, 20_001)
    run = loop.run.at(times)
    momentum = (M + BALL) * run["v"] - ML * np.cos(run["theta"]) * run["omega"]
    impulse = np.trapezoid(run["friction"], times)
    # the trapezoid's error at jumps of friction: 2.4 N times half a step
    assert momentum[-1] - momentum[0] == pytest.approx(-impulse, abs=6e-6)
    assert run["omega"][-1] > 3.0


def test_compensation_takes_contact_inputs_as_it_takes_the_load():
    kind = law_of("level + viscous * exponential[temperature]")
    warm = kind(kinetic_coefficient=0.1, viscous_coefficient=0.12, viscous_temperature_decay=0.03)
    wanted = bound(warm, {"temperature": 30.0}).force(0.5, 2.0)
    for given in (30.0, lambda t, measured: measured["T"]):
        push = compensation(warm, width=0.01, load=2.0, inputs={"temperature": given})
        assert push(0.0, {"v": 0.5, "T": 30.0}) == wanted
    told = bound(warm, {"temperature": 30.0})
    assert compensation(told, width=0.01, load=2.0)(0.0, {"v": 0.5}) == wanted
    with pytest.raises(InputError, match="depends on temperature: give it, as inputs="):
        compensation(warm, width=0.01)
    with pytest.raises(UnknownNameError, match="contact input of"):
        compensation(warm, width=0.01, inputs={"temp": 1.0})
