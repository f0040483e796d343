"""The torque-driven pendulum cart: two coordinates, a normal force that depends on accelerations.

The closed forms are those of Lagrange's equations solved by hand for the ball at
(x - l sin th, l cos th) on a cart with friction on the ground.
"""

import functools
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, ClassVar, final

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from tests.support import Generated, decade
from typing_extensions import override

from stickslip import Coulomb, Status, simulate
from stickslip.drives import Drive
from stickslip.errors import SimulationError
from stickslip.formulation import formulate
from stickslip.maths import cos, sin
from stickslip.mechanisms import Contact, Mechanism
from stickslip.quantities import Quantity

ROUNDING = 1e-12
"""Roundings, multiplied by the ratio of the masses and by how close D comes to zero."""


@final
@dataclass(frozen=True, kw_only=True)
class Cart(Mechanism):
    """A cart on the ground with an inverted pendulum that a torque turns."""

    name: ClassVar[str] = "cart"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "theta")
    rates: ClassVar[tuple[str, ...]] = ("v", "omega")
    units: ClassVar[tuple[str, ...]] = ("m", "rad")

    cart_mass: Annotated[float, Quantity("M", "kg", above=0)]
    ball_mass: Annotated[float, Quantity("m", "kg", above=0)]
    length: Annotated[float, Quantity("l", "m", above=0)]
    torque: Annotated[float, Quantity("tau", "N m")] = 0.0
    gravity: Annotated[float, Quantity("g", "m/s^2", above=0)] = 9.81

    @override
    def kinetic_energy(self, q: Mapping, q_dot: Mapping):
        M, m, l = self.cart_mass, self.ball_mass, self.length  # noqa: E741
        u = q_dot["x"] - l * cos(q["theta"]) * q_dot["theta"]
        w = q_dot["y"] - l * sin(q["theta"]) * q_dot["theta"]
        cart = 0.5 * M * (q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"])
        return cart + 0.5 * m * (u * u + w * w)

    @override
    def potential_energy(self, t, q: Mapping):
        M, m, g = self.cart_mass, self.ball_mass, self.gravity
        return M * g * q["y"] + m * g * (q["y"] + self.length * cos(q["theta"]))

    @override
    def forces(self, t, q: Mapping, q_dot: Mapping, drives: Mapping):
        return {"theta": self.torque}

    @override
    def contacts(self) -> tuple[Contact, ...]:
        return (Contact(slip="x", normal="y"),)

    @override
    def drives(self) -> Mapping[str, Drive]:
        return {}


LAW = Coulomb(kinetic_coefficient=0.1, static_coefficient=0.2)


@functools.cache
def model():
    """Return the equations, which are the same for all numbers."""
    return formulate(Cart(cart_mass=1.0, ball_mass=1.0, length=1.0), LAW)


carts = st.builds(
    Cart,
    cart_mass=decade(-1, 1),
    ball_mass=decade(-1, 0.3),
    length=decade(-1, 0.3),
    torque=st.floats(-1, 1),
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
EVERY = settings(max_examples=60)


def pivot(cart, mu, s, theta):
    """D of the cart, over M + m."""
    M, m = cart.cart_mass, cart.ball_mass
    sin_, cos_ = math.sin(theta), math.cos(theta)
    return M + m * sin_**2 - mu * s * m * sin_ * cos_


def slipping(cart, mu, s, theta, omega):
    """Return x'', th'' and N while slipping, and the size of their parts."""
    M, m, l, tau, g = (  # noqa: E741
        cart.cart_mass, cart.ball_mass, cart.length, cart.torque, cart.gravity,
    )  # fmt: skip
    S, C, w2 = math.sin(theta), math.cos(theta), omega * omega
    D = pivot(cart, mu, s, theta)
    N = (M * ((M + m) * g - m * l * w2 * C) - (M + m) * tau * S / l) / D
    x_ddot = (
        -mu * s * g * (M + m * C**2)
        + m * g * S * C
        + m * l * w2 * (mu * s * C - S)
        + tau * (C + mu * s * S) / l
    ) / D
    th_ddot = (
        (M + m) * tau
        + (M + m) * m * g * l * (S - mu * s * C)
        + m**2 * l**2 * w2 * C * (mu * s * C - S)
    ) / (m * l**2 * D)
    size = (g * (M + m) + m * l * w2 + abs(tau) / l) / D
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
    M, m, l, tau, g = (  # noqa: E741
        cart.cart_mass, cart.ball_mass, cart.length, cart.torque, cart.gravity,
    )  # fmt: skip
    S, C, w2 = math.sin(theta), math.cos(theta), omega * omega
    th_ddot = (tau + m * g * l * S) / (m * l**2)
    needed = (tau + m * g * l * S) * C / l - m * l * w2 * S
    N = M * g + m * g * C**2 - m * l * w2 * C - tau * S / l
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
@given(cart=carts, theta=angles, omega=rates, v=rates)
def test_the_energy_is_that_of_cart_and_ball(cart, theta, omega, v):
    M, m, l, g = cart.cart_mass, cart.ball_mass, cart.length, cart.gravity  # noqa: E741
    ball = (v - l * math.cos(theta) * omega) ** 2 + (l * math.sin(theta) * omega) ** 2
    expected = 0.5 * M * v**2 + 0.5 * m * ball + m * g * l * math.cos(theta)
    found = Generated(cart, LAW, model()).energy([0.0, theta, v, omega])
    assert abs(found - expected) <= 1e-14 * (M * v**2 + m * ball + m * g * l)  # a few roundings


def test_a_cart_whose_pendulum_lifts_it_ends_with_that_status():
    cart = Cart(cart_mass=1.0, ball_mass=1.0, length=1.0)
    # rising to the top fast enough that m l w^2 cos th outweighs both
    start = {"theta": -1.2, "omega": 7.0}
    run = simulate(cart, LAW, t_end=5.0, y0=start, throw=False)
    assert run.status is Status.LIFT_OFF
    assert run.events[-1].reason == "lift-off"
    assert run.certificate.certified
    assert abs(run["normal_force"][-1]) <= 1e-9 * 2 * 9.81  # located to rounding of the time
    with pytest.raises(SimulationError, match="leaves the ground"):
        simulate(cart, LAW, t_end=5.0, y0=start)


def test_a_cart_without_friction_and_torque_keeps_its_energy_and_momentum():
    cart = Cart(cart_mass=2.0, ball_mass=0.5, length=0.4)
    free = Coulomb(kinetic_coefficient=0.0)
    run = simulate(cart, free, t_end=3.0, y0={"theta": 0.3, "v": 5.0})
    momentum = 2.5 * run["v"] - 0.5 * 0.4 * run["omega"] * np.cos(run["theta"])
    assert run.certificate.energy_error <= 1e-9  # the certificate's limit
    np.testing.assert_allclose(momentum, momentum[0], rtol=1e-10)  # a hundred tolerances
