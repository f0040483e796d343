"""The pendulum cart against closed forms: Lagrange's equations solved by hand.

The ball is at (x - l sin th, l cos th) on a cart with friction on the ground.
"""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, example, given
from hypothesis import strategies as st
from scipy.optimize import brentq
from tests.support import Generated, decade, examples

from stickslip import Coulomb, EventDriven, FixedStep, PendulumCart, ensemble, simulate
from stickslip.engine import Status
from stickslip.engine.formulation import formulate
from stickslip.errors import InputError, ParameterError, SimulationError
from stickslip.mechanisms import Prescribed, Torque
from stickslip.mechanisms.drives import (
    PiecewiseLinear,
    SevenStep,
    Sine,
    SineSwing,
    SplineSwing,
    ThreePhase,
    TimedThreePhase,
)
from stickslip.quantities import fields_of

ROUNDING = 1e-12
"""Roundings, multiplied by the ratio of the masses and by how close D comes to zero."""


def cart_with(torque=0.0, **values):
    """Return a cart whose pendulum a constant torque turns."""
    constant = PiecewiseLinear(times=(0.0,), values=(torque,))
    return PendulumCart(pendulum=Torque(drive=constant), **values)


def torque_of(cart):
    return cart.pendulum.drive.values[0]


LAW = Coulomb(kinetic_coefficient=0.1, static_coefficient=0.2)


@functools.cache
def model():
    """Return the equations, which are the same for all numbers."""
    return formulate(cart_with(cart_mass=1.0, ball_mass=1.0, length=1.0), LAW)


carts = st.builds(
    cart_with,
    cart_mass=decade(-1, 1),
    ball_mass=decade(-1, 0.3),
    length=decade(-1, 0.3),
    torque=st.floats(-1, 1),
    incline=st.just(0.0) | st.floats(-0.7, 0.7),
)
laws = st.builds(
    lambda kinetic, surplus: Coulomb(
        kinetic_coefficient=kinetic, static_coefficient=kinetic + surplus
    ),
    st.floats(0, 0.6),
    st.floats(0, 0.3),
)
special = st.sampled_from([0.0, math.pi / 2, -math.pi / 2, math.pi])
angles = st.floats(-math.pi, math.pi) | special
rates = st.floats(-5, 5)
EVERY = examples(60)


def pivot(cart, mu, s, theta):
    """D of the cart, over M + m."""
    M, m = cart.cart_mass, cart.ball_mass
    sin_, cos_ = math.sin(theta), math.cos(theta)
    return M + m * sin_**2 - mu * s * m * sin_ * cos_


def slipping(cart, mu, s, theta, omega):
    """Return x'', th'' and N while slipping, and the size of their parts.

    An incline is level ground that is accelerated uphill by g sin beta, with gravity g cos beta.
    """
    M, m, l, tau = cart.cart_mass, cart.ball_mass, cart.length, torque_of(cart)  # noqa: E741
    g, uphill = cart.gravity * math.cos(cart.incline), cart.gravity * math.sin(cart.incline)
    S, C, w2 = math.sin(theta), math.cos(theta), omega * omega
    D = pivot(cart, mu, s, theta)
    N = (M * ((M + m) * g - m * l * w2 * C) - (M + m) * tau * S / l) / D
    x_ddot = (
        -mu * s * g * (M + m * C**2)
        + m * g * S * C
        + m * l * w2 * (mu * s * C - S)
        + tau * (C + mu * s * S) / l
    ) / D - uphill
    th_ddot = (
        (M + m) * tau
        + (M + m) * m * g * l * (S - mu * s * C)
        + m**2 * l**2 * w2 * C * (mu * s * C - S)
    ) / (m * l**2 * D)
    size = (cart.gravity * (M + m) + m * l * w2 + abs(tau) / l) / D
    return x_ddot, th_ddot, N, size


@pytest.mark.parametrize("s", [1, -1], ids=["forward", "backward"])
@EVERY
@given(cart=carts, law=laws, theta=angles, omega=rates, speed=decade(-3, 1))
def test_slip_has_the_accelerations_and_normal_force_of_the_closed_form(
    s, cart, law, theta, omega, speed
):
    mu = law.kinetic_coefficient
    assume(pivot(cart, mu, s, theta) > 0.1 * cart.cart_mass)  # away from the Painleve paradox
    y = [0.3, theta, s * speed, omega]
    x_ddot, th_ddot, N, size = slipping(cart, mu, s, theta, omega)
    generated = Generated(cart, law, model())
    *same, x_found, th_found = generated.moving("field", s, y)
    friction, normal, _, level = generated.moving("contact", s, y)
    ratio = 1.0 + cart.cart_mass / cart.ball_mass + cart.ball_mass / cart.cart_mass
    allowed = ROUNDING * ratio * size
    total = cart.cart_mass + cart.ball_mass
    assert same == [s * speed, omega]
    assert abs(x_found - x_ddot) <= allowed
    assert abs(th_found - th_ddot) <= allowed / cart.length
    assert abs(normal - N) <= allowed * total
    assert abs(friction - s * mu * N) <= allowed * total
    assert abs(level - law.static_coefficient * N) <= allowed * total


@EVERY
@given(cart=carts, law=laws, theta=angles, omega=rates)
def test_stick_needs_the_friction_of_the_closed_form(cart, law, theta, omega):
    M, m, l, tau = cart.cart_mass, cart.ball_mass, cart.length, torque_of(cart)  # noqa: E741
    g, beta = cart.gravity, cart.incline
    S, C, w2 = math.sin(theta), math.cos(theta), omega * omega
    th_ddot = (tau + m * g * l * math.sin(theta + beta)) / (m * l**2)
    needed = m * l * (th_ddot * C - w2 * S) - (M + m) * g * math.sin(beta)
    N = (M + m) * g * math.cos(beta) - m * l * (th_ddot * S + w2 * C)
    size = (M + m) * g + m * l * w2 + abs(tau) / l
    generated = Generated(cart, law, model())
    y = [0.3, theta, 0.0, omega]
    assert generated.moving("field", 0, y)[:3] == [0.0, omega, 0.0]
    assert abs(generated.moving("field", 0, y)[3] - th_ddot) <= ROUNDING * size / (m * l)
    friction, normal, same, level = generated.moving("contact", 0, y)
    assert friction == same
    assert abs(friction - needed) <= ROUNDING * size
    assert abs(normal - N) <= ROUNDING * size
    assert abs(level - law.static_coefficient * N) <= ROUNDING * size


@EVERY
@given(cart=carts, theta=angles, omega=rates, v=rates, x=rates)
def test_the_energy_is_that_of_cart_and_ball(cart, theta, omega, v, x):
    M, m, l, g = cart.cart_mass, cart.ball_mass, cart.length, cart.gravity  # noqa: E741
    beta = cart.incline
    ball = (v - l * math.cos(theta) * omega) ** 2 + (l * math.sin(theta) * omega) ** 2
    height = (M + m) * x * math.sin(beta) + m * l * math.cos(theta + beta)
    expected = 0.5 * M * v**2 + 0.5 * m * ball + g * height
    found = Generated(cart, LAW, model()).energy([x, theta, v, omega])
    size = M * v**2 + m * ball + g * (m * l + (M + m) * abs(x))
    assert abs(found - expected) <= 1e-14 * size  # a few roundings


def test_a_cart_whose_pendulum_lifts_it_ends_with_that_status():
    cart = PendulumCart(cart_mass=1.0, ball_mass=1.0, length=1.0)
    # rising to the top fast enough that m l w^2 cos th outweighs both
    start = {"theta": -1.2, "omega": 7.0}
    run = simulate(cart, LAW, t_end=5.0, y0=start, throw=False)
    assert run.status is Status.LIFT_OFF
    assert run.events[-1].reason == "lift-off"
    assert len(run.certificate.problems) == 1  # that it ended early
    assert abs(run["normal_force"][-1]) <= 1e-9 * 2 * 9.81  # located to rounding of the time
    with pytest.raises(SimulationError, match="Lift-off: the normal force"):
        simulate(cart, LAW, t_end=5.0, y0=start)


def test_a_cart_without_friction_and_torque_keeps_its_energy_and_momentum():
    cart = PendulumCart(cart_mass=2.0, ball_mass=0.5, length=0.4)
    free = Coulomb(kinetic_coefficient=0.0)
    run = simulate(cart, free, t_end=3.0, y0={"theta": 0.3, "v": 5.0})
    momentum = 2.5 * run["v"] - 0.5 * 0.4 * run["omega"] * np.cos(run["theta"])
    assert run.certificate.energy_error <= 1e-9  # the certificate's limit
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-10)  # a hundred tolerances


SWING = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
PERIOD = float(SWING.period)
LIGHT = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING))
ROUGH = Coulomb(kinetic_coefficient=0.2)
PLAIN = EventDriven(tier="python")
G = 9.81
MANY = np.linspace(0.0, PERIOD, 2001)


@functools.cache
def cycles():
    """Return six cycles of the cart of the published checks."""
    return simulate(LIGHT, ROUGH, t_end=6.0 * PERIOD)


def test_the_first_cycle_and_all_others_have_their_published_travel():
    x = cycles().at(PERIOD * np.arange(7))["x"]
    assert round(PERIOD, 5) == 0.7236
    assert round(float(x[1]), 7) == 0.0248596
    assert np.diff(x[1:]).round(7).tolist() == [0.0634659] * 5


def test_the_least_normal_force_and_the_back_slip_are_the_published_ones():
    run = cycles()
    t = np.linspace(0.0, 5.0 * PERIOD, 100001)  # 36 us: a peak of N is missed by 1e-6 of it
    columns = run.at(t)
    assert round(float(columns["normal_force"].min()), 3) == 3.462
    moved = np.diff(columns["x"])
    back = -moved[moved < 0.0].sum() / 5.0  # the first cycle slips back more than the others
    assert round(1e3 * float(back), 2) == 0.35
    assert round(float(columns["v"].min()), 3) == -0.006


def test_a_prescribed_swing_is_followed_and_its_energy_is_accounted_for():
    run = cycles()
    for t in np.linspace(0.0, 6.0 * PERIOD, 50):
        theta, omega = SWING.at(float(t))
        # the swing is a polynomial in each piece, and its sum of pieces rounds
        assert abs(run.at([t])["theta"][0] - theta) < 1e-12
        assert abs(run.at([t])["omega"][0] - omega) < 1e-11
    assert run.certificate.energy_error < 1e-9


swings = st.builds(
    ThreePhase, amplitude=st.floats(0.1, 1.4), fast=st.floats(5, 200), slow=st.floats(5, 200)
)


@EVERY
@given(cart=carts, law=laws, swing=swings, s=st.sampled_from([1, -1]), theta=angles, omega=rates)
def test_a_prescribed_swing_pushes_the_cart_as_the_closed_form_says(
    cart, law, swing, s, theta, omega
):
    cart = replace(cart, pendulum=Prescribed(profile=swing))
    M, m, l, mu = cart.cart_mass, cart.ball_mass, cart.length, law.kinetic_coefficient  # noqa: E741
    g, uphill = cart.gravity * math.cos(cart.incline), cart.gravity * math.sin(cart.incline)
    S, C, w2, turning = math.sin(theta), math.cos(theta), omega * omega, swing.fast
    H = m * l * (turning * C - w2 * S)
    N = (M + m) * g - m * l * (turning * S + w2 * C)
    x_ddot = (H - s * mu * N) / (M + m) - uphill
    tau = m * l**2 * turning - m * l * (x_ddot + uphill) * C - m * g * l * S
    generated = Generated(cart, law)
    generated.equations.load(1)  # the first phase
    y = [0.1, theta, 0.2 * s, omega]
    size = (M + m) * cart.gravity + m * l * (turning + w2)
    # a few roundings of the parts
    assert np.allclose(
        generated.moving("field", s, y), [0.2 * s, omega, x_ddot, turning],
        rtol=1e-12, atol=1e-12 * size / (M + m),
    )  # fmt: skip
    friction, normal, _, _, torque = generated.moving("contact", s, y)
    assert math.isclose(normal, N, rel_tol=1e-12, abs_tol=1e-12 * size)
    assert math.isclose(friction, s * mu * N, rel_tol=1e-12, abs_tol=1e-12 * size)
    assert math.isclose(torque, tau, rel_tol=1e-12, abs_tol=1e-12 * size * l)
    held = generated.moving("contact", 0, [0.1, theta, 0.0, omega])
    needed = H - (M + m) * uphill
    assert math.isclose(held[2], needed, rel_tol=1e-12, abs_tol=1e-12 * size)


SPRUNG = {"pivot_stiffness": 2.5, "pivot_angle": 0.2, "pivot_damping": 0.03}


def test_spring_and_damper_at_the_pivot_load_the_motor_of_a_swing_and_not_the_cart():
    plain, sprung = (simulate(one, ROUGH, t_end=2.0) for one in (LIGHT, replace(LIGHT, **SPRUNG)))
    t = np.linspace(0.0, 2.0, 400)
    bare, wound = plain.at(t), sprung.at(t)
    for name in ("x", "v", "friction", "normal_force", "theta"):
        np.testing.assert_array_equal(wound[name], bare[name])
    extra = 2.5 * (bare["theta"] - 0.2) + 0.03 * bare["omega"]
    np.testing.assert_allclose(wound["torque"] - bare["torque"], extra, atol=1e-12)
    assert sprung.certificate.energy_error < 1e-9


def test_a_motor_too_weak_for_the_spring_at_the_pivot_ends_the_run():
    needed = {
        name: float(np.abs(simulate(cart, ROUGH, t_end=PERIOD).at(MANY)["torque"]).max())
        for name, cart in {"bare": LIGHT, "sprung": replace(LIGHT, **SPRUNG)}.items()
    }
    assert needed["bare"] < 0.9 * needed["sprung"]
    motor = Prescribed(profile=SWING, limit=0.95 * needed["sprung"])
    assert simulate(replace(LIGHT, pendulum=motor), ROUGH, t_end=PERIOD).status.complete
    weak = replace(LIGHT, pendulum=motor, **SPRUNG)
    assert simulate(weak, ROUGH, t_end=PERIOD, throw=False).status is Status.LIMIT


@pytest.mark.parametrize("held", [True, False], ids=["cart held", "cart free"])
def test_a_sprung_pendulum_swings_with_its_eigenfrequency_and_damping(held):
    M, m, l, k, c = 0.5, 0.1, 0.3, 2.5, 0.02  # noqa: E741
    cart = PendulumCart(
        cart_mass=M, ball_mass=m, length=l, pivot_stiffness=k, pivot_damping=c,
        pendulum=Torque(drive=None),
    )  # fmt: skip
    # about the upright: J th'' + c th' + (k - m g l) th = 0, J less where the cart gives way
    J = m * l**2 * (1.0 if held else M / (M + m))
    w0, decay = math.sqrt((k - m * G * l) / J), 0.5 * c / J
    w = math.sqrt(w0**2 - decay**2)
    law = Coulomb(kinetic_coefficient=1.0 if held else 0.0)
    size = 1e-5
    run = simulate(cart, law, t_end=1.5, y0={"theta": size})
    t = np.linspace(0.0, 1.5, 200)
    expected = size * np.exp(-decay * t) * (np.cos(w * t) + decay / w * np.sin(w * t))
    # cubes of the angle are left out: 1e-10 of it, times the phase that adds up
    np.testing.assert_allclose(run.at(t)["theta"], expected, atol=1e-8 * size)


def test_a_spring_at_the_pivot_holds_the_rod_where_torques_balance():
    # on an incline, about its rest: k (th - th_0) = m g l sin(th + beta)
    k, beta, m, l = 2.5, 0.2, 0.1, 0.3  # noqa: E741
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=m, length=l, incline=beta, pivot_stiffness=k, pivot_angle=0.3,
        pivot_damping=0.2,
    )  # fmt: skip
    run = simulate(cart, Coulomb(kinetic_coefficient=1.0), t_end=30.0)
    theta = run["theta"][-1]
    assert k * (theta - 0.3) == pytest.approx(m * G * l * math.sin(theta + beta), rel=1e-9)
    assert run["x"][-1] == 0.0


@pytest.mark.parametrize(
    "swing",
    [
        SineSwing(amplitude=0.8, frequency=1.5),
        SplineSwing(positions=(-0.6, 0.2, 0.7, 0.1), duration=0.8),
    ],
    ids=["sine", "spline"],
)
def test_smooth_swings_are_followed_too(swing):
    cart = replace(LIGHT, pendulum=Prescribed(profile=swing))
    run = simulate(cart, ROUGH, t_end=3.0)
    for t in np.linspace(0.0, 3.0, 40):
        theta, omega = swing.at(float(t))
        # steps of relative error 1e-12, of which some tens add up
        assert abs(run.at([t])["theta"][0] - theta) < 1e-10
        assert abs(run.at([t])["omega"][0] - omega) < 1e-9
    assert run.certificate.energy_error < 1e-9


def test_a_motor_that_saturates_gives_its_limit_and_says_when():
    swing = PiecewiseLinear(times=(0.0, 1.0, 2.0), values=(0.0, 1.0, 0.0))
    free = replace(LIGHT, pendulum=Torque(drive=swing))
    weak = replace(LIGHT, pendulum=Torque(drive=swing, limit=0.25))
    held = Coulomb(kinetic_coefficient=3.0)  # the cart stays where it is
    run = simulate(weak, held, t_end=0.4, throw=False)
    reasons = [(event.reason, round(event.t, 12)) for event in run.events]
    assert ("motor saturates", 0.25) in reasons
    alike = simulate(free, held, t_end=0.25, throw=False)
    assert run.at([0.25])["theta"][0] == pytest.approx(alike["theta"][-1], rel=1e-11)


GENTLE = SplineSwing(positions=(0.0, 0.05, 0.7, -0.3), duration=0.9)
"""A swing that asks for most within its cycle and not as it begins."""


def first_above(t, values, level):
    """Return the first sample above a level and the one before it."""
    k = int(np.argmax(values > level))
    assert k > 0
    return t[k - 1], t[k]


def test_a_prescribed_swing_that_needs_more_than_the_motor_gives_ends_there():
    cart = replace(LIGHT, pendulum=Prescribed(profile=GENTLE))
    t = np.linspace(0.0, 1.8, 36001)
    needed = np.abs(simulate(cart, ROUGH, t_end=1.8).at(t)["torque"])
    most = float(needed.max())
    strong = replace(cart, pendulum=Prescribed(profile=GENTLE, limit=1.001 * most))
    assert simulate(strong, ROUGH, t_end=1.8).status is Status.END_TIME
    weak = replace(cart, pendulum=Prescribed(profile=GENTLE, limit=0.9 * most))
    run = simulate(weak, ROUGH, t_end=1.8, throw=False)
    assert run.status is Status.LIMIT
    assert run.events[-1].reason.startswith("motor limit")
    before, after = first_above(t, needed, 0.9 * most)
    assert before <= run.span[1] <= after
    assert len(run.certificate.problems) == 1  # that it ended early


def test_a_cart_on_narrow_wheels_tips_where_the_ground_cannot_hold_its_moment():
    M, m, l, g, h_p, h_c = 0.5, 0.1, 0.3, 9.81, 0.1, 0.05  # noqa: E741
    swing = GENTLE
    wide = PendulumCart(
        cart_mass=M, ball_mass=m, length=l, wheelbase=1.0, pivot_height=h_p, centre_height=h_c,
        pendulum=Prescribed(profile=swing),
    )  # fmt: skip
    run = simulate(wide, ROUGH, t_end=2.0)
    t = np.linspace(0.0, 2.0, 4001)
    c = run.at(t)
    turning = np.array([swing.value(float(one)) for one in t])
    S, C = np.sin(c["theta"]), np.cos(c["theta"])
    N, F, w = c["normal_force"], c["friction"], c["omega"]
    H = m * l * (turning * C - w**2 * S)
    x_ddot = (H - F) / (M + m)
    # moments about the middle of the wheels, positive over the back ones to the front:
    # the ball's weight and inertia at (-l S, h_p + l C), the cart's inertia at (0, h_c)
    a_x = x_ddot - l * (turning * C - w**2 * S)
    a_y = -l * (turning * S + w**2 * C)
    moment = m * ((-l * S) * (a_y + g) - (h_p + l * C) * a_x) - M * h_c * x_ddot
    worst = np.max(np.abs(moment) / N)
    narrow = simulate(replace(wide, wheelbase=2.002 * worst), ROUGH, t_end=2.0)
    assert narrow.status is Status.END_TIME
    tips = simulate(replace(wide, wheelbase=1.9 * worst), ROUGH, t_end=2.0, throw=False)
    assert tips.status is Status.LIMIT
    assert tips.events[-1].reason in ("tips forward", "tips backward")
    before, after = first_above(t, np.abs(moment) / N, 0.95 * worst)
    assert before <= tips.span[1] <= after


def test_a_break_away_into_the_paradox_ends_with_that_status():
    # r = M/m = .1: the paradox is possible for mu above .663; at theta = .5, mu = 1.5 D < 0
    cart = cart_with(0.0, cart_mass=0.1, ball_mass=1.0, length=1.0)
    law = Coulomb(kinetic_coefficient=1.5)
    assert pivot(cart, 1.5, 1, 0.5) < 0.0 < pivot(cart, 1.5, -1, 0.5)
    run = simulate(cart, law, t_end=1.0, y0={"theta": 0.5, "v": 0.1}, throw=False)
    assert run.status is Status.PAINLEVE
    assert run.events[-1].reason == "painleve"
    with pytest.raises(SimulationError, match="Painlevé paradox"):
        simulate(cart, law, t_end=1.0, y0={"theta": 0.5, "v": 0.1})


def test_a_certificate_tells_how_near_the_cart_came_to_lifting_off():
    run = cycles()
    t = np.linspace(0.0, 6.0 * PERIOD, 60001)
    normal = run.at(t)["normal_force"]
    told = run.certificate.margins["lift-off"]
    # the solver looks at eight points of each step, between which the force bends little
    assert told == pytest.approx(float(normal.min() / normal.max()), rel=1e-3)
    assert run.certificate.warnings == ()
    # N = (M + m) g - m l (th'' sin th + th'^2 cos th) falls as l grows
    tall = simulate(replace(LIGHT, length=0.65), ROUGH, t_end=PERIOD)
    assert 0.0 < tall.certificate.margins["lift-off"] < 0.1
    assert tall.certificate.warnings == ("the normal force fell to 5.6 % of its largest value",)
    taller = simulate(replace(LIGHT, length=0.75), ROUGH, t_end=PERIOD, throw=False)
    assert taller.status is Status.LIFT_OFF
    assert taller.certificate.margins["lift-off"] == 0.0


@pytest.mark.slow
def test_every_number_of_every_profile_varies_alike_in_ensembles_and_in_single_runs():
    profiles = [
        replace(SWING, last=20.0),
        replace(SWING, last=20.0, frequency=1.2),
        TimedThreePhase(
            amplitude=0.8, first_duration=0.1, middle_duration=0.5, last_duration=0.2, frequency=1.2
        ),
        SineSwing(amplitude=0.8, frequency=1.2),
        SplineSwing(positions=(-0.5, 0.9, 0.5, -0.2), duration=0.6),
        SevenStep(amplitude=0.8, fast=120.0, slow=30.0, top_rate=6.0),
    ]
    for profile in profiles:
        cart = replace(LIGHT, pendulum=Prescribed(profile=profile))
        for name in fields_of(type(profile)):
            own = getattr(profile, name)
            own = 1.0 / profile.period if own is None else own  # a frequency
            values = [own + 0.01, own + 0.02] if own == 0.0 else [0.97 * own, 1.0 * own]
            found = ensemble(cart, ROUGH, {name: values}, t_end=1.0, solver=PLAIN)
            for value, x, status in zip(values, found["x"], found.status, strict=True):
                motor = Prescribed(profile=replace(profile, **{name: value}))
                run = simulate(replace(cart, pendulum=motor), ROUGH, t_end=1.0, solver=PLAIN)
                assert (float(x), status) == (float(run["x"][-1]), run.status), (profile, name)


@pytest.mark.parametrize(
    "profile",
    [
        SplineSwing(positions=(-0.5, 0.9, 0.5, -0.2), duration=0.6),
        SevenStep(amplitude=0.8, fast=120.0, slow=30.0, top_rate=6.0, return_rate=5.0),
    ],
    ids=["spline", "seven-step"],
)
def test_sensitivities_to_profiles_are_those_of_differences(profile):
    cart = replace(LIGHT, pendulum=Prescribed(profile=profile))
    run = simulate(cart, ROUGH, t_end=1.7)
    for name in fields_of(type(profile)):
        own = getattr(profile, name)
        if own == 0.0:  # a pause that begins to be: two jumps that part have no derivative
            assert math.isnan(run.sensitivity("x", name)[-1])
            continue
        ends = []
        for side in (1.0, -1.0):
            motor = Prescribed(profile=replace(profile, **{name: own * (1.0 + 1e-6 * side)}))
            ends.append(float(simulate(replace(cart, pendulum=motor), ROUGH, t_end=1.7)["x"][-1]))
        slope = (ends[0] - ends[1]) / (2e-6 * own)
        # roundings of 1e-16 over a step of 1e-6, and what is beyond its square
        assert run.sensitivity("x", name)[-1] == pytest.approx(slope, rel=1e-4, abs=1e-8)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: replace(LIGHT, pendulum=SWING), r"Write Prescribed\(profile=\.\.\.\)"),
        (lambda: replace(LIGHT, pendulum=Sine(amplitude=1.0, frequency=1.0)), r"Write Torque"),
        (lambda: replace(LIGHT, pendulum=None), "must be a motor"),
        (lambda: Torque(drive=SWING), r"Prescribed\(profile=\.\.\.\)"),
        (lambda: Prescribed(profile=None), "must be a motion profile"),
    ],
)
def test_what_is_no_motor_is_refused_with_its_cure(make, said):
    with pytest.raises(ParameterError, match=said):
        make()


def test_fixed_steps_pass_no_boundary_in_silence():
    steps = FixedStep(dt=0.01)
    flying = simulate(
        replace(LIGHT, length=1.0, ball_mass=1.0), ROUGH, t_end=1.0, solver=steps, throw=False
    )
    assert flying.status is Status.LIFT_OFF
    with pytest.raises(InputError, match=r"does not support limits.*tips forward"):
        simulate(replace(LIGHT, wheelbase=0.6), ROUGH, t_end=1.0, solver=steps)
    with pytest.raises(InputError, match="depends on friction"):
        simulate(replace(LIGHT, pendulum=Torque()), ROUGH, t_end=1.0, solver=steps)


def test_a_limit_is_named_with_its_numbers_where_a_run_raises():
    weak = replace(LIGHT, pendulum=Prescribed(profile=SWING, limit=0.3))
    with pytest.raises(SimulationError, match=r"motor limit forward \(torque 1\.258 N m"):
        simulate(weak, ROUGH, t_end=1.0)
    enough = replace(LIGHT, pendulum=Prescribed(profile=SWING, limit=3.0))
    margins = simulate(enough, ROUGH, t_end=1.0).certificate.margins
    # 1.258 N m of 3: the margin ahead falls from 1 + .48/3, its largest, to 1 - 1.258/3
    assert margins["motor limit forward"] == pytest.approx(0.5, abs=0.01)


STIFF, SHAKEN, PUSH = 1.5, 7.0, 1e-4
"""Ratio of the eigenfrequency to that of the drive, frequency of the drive [rad/s], torque."""


def pressed_cart(phase=0.0, restitution=0.0):
    """Return an upright pendulum at its stop, where only the torque of a sine acts."""
    held = replace(cart_with(cart_mass=0.5, ball_mass=0.1, length=0.3), upper_stop=0.0)
    stiffness = 0.1 * 0.3**2 * (STIFF * SHAKEN) ** 2 + 0.1 * held.gravity * 0.3
    drive = Sine(amplitude=PUSH, frequency=SHAKEN / (2.0 * math.pi), phase=phase)
    return replace(
        held, pendulum=Torque(drive=drive), pivot_stiffness=stiffness, restitution=restitution
    )


def test_a_pendulum_leaves_its_stop_as_the_torque_turns_and_flies_as_the_closed_form_says():
    # At the stop the spring and the weight have no torque, so that at each release all forces are
    # 0 and their rate decides. The cart rests; sin(theta) is theta to 1e-6.
    period = 2.0 * math.pi / SHAKEN
    run = simulate(pressed_cart(), LAW, t_end=6.3 * period)
    leaves = [event.t for event in run.events if event.reason == "theta leaves stop"]
    hits = [event.t for event in run.events if event.reason == "theta hits stop"]
    np.testing.assert_allclose(leaves, (np.arange(6) + 0.5) * period, rtol=1e-12)

    def flight(s):
        share = PUSH / (0.1 * 0.3**2) / (SHAKEN**2 * (STIFF**2 - 1.0))
        return -share * (np.sin(SHAKEN * s) - np.sin(STIFF * SHAKEN * s) / STIFF)

    landing = brentq(flight, 0.5 * period, 0.75 * period, xtol=1e-15)
    np.testing.assert_allclose(hits, np.array(leaves)[:6] + landing, rtol=1e-6)
    flying = (run.t > leaves[2]) & (run.t < hits[2])
    expected = flight(run.t[flying] - leaves[2])
    np.testing.assert_allclose(run["theta"][flying], expected, atol=1e-6 * np.abs(expected).max())
    assert run.certificate.certified


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_a_run_that_begins_as_a_press_ends_goes_on_as_one_that_comes_there(restitution):
    period = 2.0 * math.pi / SHAKEN
    before = simulate(pressed_cart(restitution=restitution), LAW, t_end=4.0 * period)
    after = simulate(pressed_cart(phase=math.pi, restitution=restitution), LAW, t_end=3.5 * period)
    first, second = ([(e.t, e.reason) for e in run.events] for run in (before, after))
    assert [reason for _, reason in second if "leaves" in reason]
    shifted = [(t - 0.5 * period, reason) for t, reason in first if t > 0.6 * period]
    rest = [(t, reason) for t, reason in second if t > 0.1 * period]
    assert [reason for _, reason in shifted] == [reason for _, reason in rest]
    np.testing.assert_allclose([t for t, _ in shifted], [t for t, _ in rest], rtol=1e-9)
    np.testing.assert_allclose(before["theta"][-1], after["theta"][-1], atol=1e-9 * PUSH / 0.1)


@EVERY
@given(
    hangs=st.booleans(),
    above=st.booleans(),
    frequency=decade(-0.3, 0.3),
    torque=decade(-1.5, -0.3),
    phase=st.sampled_from([0.0, math.pi]) | st.floats(0.0, 6.0),
    restitution=st.sampled_from([0.0, 0.3, 0.5]),
)
@example(  # leaves by less than the rounding of pi in a step
    hangs=True, above=True, frequency=0.525, torque=0.053, phase=math.pi, restitution=0.3
)
def test_no_run_ends_at_a_stop_where_all_forces_vanish_together(
    hangs, above, frequency, torque, phase, restitution
):
    place = math.pi if hangs else 0.0
    drive = Sine(amplitude=torque, frequency=frequency, phase=phase)
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Torque(drive=drive),
        pivot_stiffness=4.0, pivot_angle=place, pivot_damping=0.01, restitution=restitution,
        **{"upper_stop" if above else "lower_stop": place},
    )  # fmt: skip
    run = simulate(cart, LAW, t_end=8.0 / frequency, y0={"theta": place}, throw=False)
    assert run.status in (Status.END_TIME, Status.LIFT_OFF)
