"""Stops of capsules and carts: stiffening springs, and stops of a pendulum."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Capsule, Coulomb, PendulumCart, load_rig, simulate
from stickslip.data import rig_toml
from stickslip.engine.trajectory import Status
from stickslip.errors import ParameterError
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import Sine
from stickslip.study.sweep import energy_balance

FREE, RUBS = Coulomb(kinetic_coefficient=0.0), Coulomb(kinetic_coefficient=0.1)
STOPS = {
    "hertz": SoftStop(place=2e-3, stiffness=2e5, damping=0.2, spring="hertz"),
    "exponential": SoftStop(
        place=2e-3, stiffness=500.0, damping=0.1, spring="exponential", stiffening=900.0
    ),
    "linear, sticks": SoftStop(place=2e-3, stiffness=3000.0, damping=2.0, sticks=True),
}
PUSH = Torque(drive=Sine(amplitude=0.3, frequency=9.0))
CAPSULE = Capsule(capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, drive=PUSH)
CART = PendulumCart(
    cart_mass=0.5, ball_mass=0.1, length=0.3, pivot_stiffness=1.0, pivot_damping=0.01,
    pendulum=Torque(drive=Sine(amplitude=0.25, frequency=1.2)),
)  # fmt: skip


def pushed(stop, depth, rate):
    """Return what a stop pushes back with, of a depth and its rate."""
    if depth <= 0.0:
        return 0.0
    spring = {
        "linear": stop.stiffness * depth,
        "hertz": stop.stiffness * depth**1.5,
        "exponential": stop.stiffness
        * (math.expm1(stop.stiffening * depth) / (stop.stiffening or 1.0)),
    }[stop.spring]
    force = spring + stop.damping * rate
    return force if stop.sticks else max(force, 0.0)


def wave(drive, t):
    return drive.amplitude * math.sin(2.0 * math.pi * drive.frequency * t)


@pytest.mark.parametrize("stop", STOPS.values(), ids=STOPS)
def test_a_capsule_with_an_elastic_stop_moves_as_scipy_says(stop):
    rig = replace(CAPSULE, upper_soft_stop=stop)

    def field(t, y):
        _, xi, _, rate = y
        inner = wave(PUSH.drive, t) - 60.0 * xi - 0.03 * rate - pushed(stop, xi - stop.place, rate)
        return [y[2], rate, -inner / 0.08, inner / 0.02 + inner / 0.08]

    run = simulate(rig, FREE, t_end=1.0)
    times = np.linspace(0.0, 1.0, 101)
    exact = solve_ivp(
        field, (0.0, 1.0), [0.0] * 4, "DOP853", times, rtol=1e-11, atol=1e-13, max_step=1e-3
    )
    seen = run.at(times)
    assert any(event.reason == "meets upper soft stop" for event in run.events)
    for row, name in enumerate(("x", "xi", "v", "xi_dot")):
        size = np.abs(exact.y[row]).max()
        np.testing.assert_allclose(seen[name], exact.y[row], atol=1e-6 * size)
    rubbed = simulate(rig, RUBS, t_end=1.0)
    assert rubbed.certificate.certified
    assert energy_balance(rig, rubbed).mismatch < 1e-9


def cart_field(stop):
    """Return the equations of a cart without friction whose pendulum may have an elastic stop."""
    total, m, l, g = 0.6, 0.1, 0.3, 9.81  # noqa: E741

    def field(t, y):
        _, theta, v, omega = y
        torque = wave(CART.pendulum.drive, t) - theta - 0.01 * omega
        if stop is not None:
            torque -= pushed(stop, theta - stop.place, omega)
        # the ball is at (x - l sin theta, l cos theta)
        mass = np.array([[total, -m * l * math.cos(theta)], [-m * l * math.cos(theta), m * l * l]])
        right = np.array(
            [-m * l * math.sin(theta) * omega**2, torque + m * g * l * math.sin(theta)]
        )
        return [v, omega, *np.linalg.solve(mass, right)]

    return field


def test_a_pendulum_that_bounces_at_a_hard_stop_moves_its_cart_as_scipy_says():
    rig, e = replace(CART, lower_stop=0.0, restitution=0.7), 0.7  # the rod is upright there

    def hits(side, place):
        def event(_t, y):
            return side * (place - y[1])

        event.terminal, event.direction = True, -1
        return event

    times = np.linspace(0.0, 2.0, 201)
    t, y, found, events = 0.0, np.array([0.0, 0.1, 0.0, 0.0]), np.full((4, len(times)), np.nan), 0
    walls = [hits(-1.0, 0.0)]
    while t < 2.0:
        run = solve_ivp(
            cart_field(None), (t, 2.0), y, "DOP853", events=walls, dense_output=True, rtol=1e-11,
            atol=1e-13,
        )  # fmt: skip
        inside = (times >= t) & (times <= run.t[-1])
        found[:, inside] = run.sol(times[inside])
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.status == 1:
            events += 1
            # momentum along x: total v - m l cos(theta) omega is that of before
            y[2] -= 0.1 * 0.3 * math.cos(y[1]) * (1.0 + e) * y[3] / 0.6
            y[3] *= -e
    assert events > 3
    seen = simulate(rig, FREE, t_end=2.0, y0={"theta": 0.1}).at(times)
    for row, name in enumerate(("x", "theta", "v", "omega")):
        size = np.nanmax(np.abs(found[row]))
        np.testing.assert_allclose(seen[name][1:-1], found[row][1:-1], atol=1e-6 * size)
    run = simulate(rig, RUBS, t_end=2.0, y0={"theta": 0.1})
    assert run.certificate.certified
    balance = energy_balance(rig, run)
    assert balance.mismatch < 1e-9
    assert balance.stops[-1] > 0.0


@pytest.mark.parametrize("place", [0.15, -0.2, 2.0])
def test_a_hard_stop_whose_blow_acts_on_the_normal_force_is_refused(place):
    with pytest.raises(ParameterError, match=f"{place:g} rad: a blow elsewhere lifts the cart"):
        replace(CART, upper_stop=place)
    with pytest.raises(ParameterError, match="Use soft stops"):
        replace(CART, lower_stop=0.0, wheelbase=0.2)


def test_a_hard_stop_is_along_the_normal_where_its_angle_is_rounded():
    assert replace(CART, upper_stop=3.1415927).upper_stop == 3.1415927  # eight digits of pi
    message = r"theta_u\) = 3.1416 rad: .* or 0 or 180 deg \(pi rad\)"  # no "3.14159 rad"
    with pytest.raises(ParameterError, match=message):
        replace(CART, upper_stop=3.1416)
    replace(CART, upper_stop="180 deg")


def test_a_blow_on_a_stiff_soft_stop_may_lift_the_cart():
    # a hanging rod whose ball is stopped on its way up pulls its cart up
    stop = SoftStop(place=math.pi + 1.0, stiffness=2e4, damping=0.0)
    rig = replace(CART, upper_soft_stop=stop, pivot_stiffness=0.0, pendulum=Torque())
    start = {"theta": math.pi, "omega": 12.0}
    run = simulate(rig, RUBS, t_end=2.0, y0=start, throw=False)
    assert run.status is Status.LIFT_OFF
    assert run["theta"][-1] > stop.place


def test_a_pendulum_with_an_elastic_stop_moves_its_cart_as_scipy_says():
    stop = SoftStop(place=0.15, stiffness=20.0, damping=0.05)
    rig = replace(CART, upper_soft_stop=stop)
    times = np.linspace(0.0, 2.0, 201)
    exact = solve_ivp(
        cart_field(stop), (0.0, 2.0), [0.0] * 4, "DOP853", times, rtol=1e-11, atol=1e-13,
        max_step=1e-3,
    )  # fmt: skip
    run = simulate(rig, FREE, t_end=2.0)
    assert any(event.reason == "meets upper soft stop" for event in run.events)
    seen = run.at(times)
    for row, name in enumerate(("x", "theta", "v", "omega")):
        np.testing.assert_allclose(seen[name], exact.y[row], atol=1e-6 * np.abs(exact.y[row]).max())
    assert simulate(rig, RUBS, t_end=2.0).certificate.certified


def test_stops_of_a_pendulum_come_from_a_rig_file_and_go_back(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(
        """
[mechanism]
type = "pendulum-cart"
cart_mass = "0.5 kg"
ball_mass = "0.1 kg"
length = "0.3 m"
upper_stop = "180 deg"
restitution = 0.5

[mechanism.pendulum]
type = "torque"
drive = { type = "sine", amplitude = "0.25 N m", frequency = "1.2 Hz" }

[mechanism.lower_soft_stop]
place = "-10 deg"
stiffness = "2 N m/rad"
spring = "exponential"
stiffening = 3.0

[friction]
law = "coulomb"
kinetic_coefficient = 0.1
"""
    )
    rig = load_rig(path).mechanism
    assert math.isclose(rig.upper_stop, math.pi)
    assert rig.lower_soft_stop == SoftStop(
        place=math.radians(-10.0), stiffness=2.0, spring="exponential", stiffening=3.0
    )
    path.write_text(rig_toml(rig, RUBS, title="back", t_end=1.0))
    assert load_rig(path).mechanism == rig
    assert simulate(rig, RUBS, t_end=2.0).certificate.certified


def test_a_spring_that_is_not_known_or_does_not_stiffen_is_refused():
    with pytest.raises(ParameterError, match="linear, hertz, exponential, got 'cubic'"):
        SoftStop(place=0.0, stiffness=1.0, spring="cubic")
    with pytest.raises(ParameterError, match=r"stiffening \(b\) must be above 0 1/m"):
        SoftStop(place=0.0, stiffness=1.0, spring="exponential")
