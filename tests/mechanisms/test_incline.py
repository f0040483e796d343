"""Inclined ground against closed forms: gravity along it, and what is left of the load."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import examples

from stickslip import Capsule, Coulomb, PendulumCart, SpringBlock, simulate
from stickslip.engine import Status
from stickslip.errors import ParameterError
from stickslip.mechanisms import Prescribed, static_normal_force
from stickslip.mechanisms.drives import ThreePhase

G = 9.81
SLOPED = [
    SpringBlock(mass=1.3),
    PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3),
    Capsule(capsule_mass=0.8, inner_mass=0.2, stiffness=40.0),
]
each = pytest.mark.parametrize("mechanism", SLOPED, ids=lambda one: one.name)
EVERY = examples(60)


@EVERY
@given(
    beta=st.floats(0.05, 1.2),
    share=st.floats(0.1, 0.9),
    room=st.floats(0.0, 0.99),
    v=st.floats(0.1, 5.0),
)
def test_a_block_pushed_uphill_slides_back_if_friction_cannot_hold_it(beta, share, room, v):
    mu = share * math.tan(beta)
    static = mu + room * (math.tan(beta) - mu)
    law = Coulomb(kinetic_coefficient=mu, static_coefficient=static)
    up, down = (G * (math.sin(beta) + s * mu * math.cos(beta)) for s in (1.0, -1.0))
    top, turn = v**2 / (2.0 * up), v / up
    back = math.sqrt(2.0 * top / down)
    block = SpringBlock(mass=2.0, incline=beta)
    run = simulate(block, law, t_end=turn + back, y0={"v": v})
    # modes of constant acceleration are exact
    assert run.at([turn])["x"][0] == pytest.approx(top, rel=1e-9)
    assert run["x"][-1] == pytest.approx(0.0, abs=1e-9 * top)
    assert run["v"][-1] == pytest.approx(-math.sqrt(2.0 * down * top), rel=1e-9)
    np.testing.assert_allclose(run["normal_force"], 2.0 * G * math.cos(beta), rtol=1e-12)
    assert run.certificate.certified


@each
@EVERY
@given(
    beta=st.floats(-1.2, 1.2).filter(lambda b: abs(b) > 0.02), off=st.sampled_from([-1e-9, 1e-9])
)
def test_a_body_stays_where_it_is_as_long_as_friction_exceeds_the_tangent(mechanism, beta, off):
    static = math.tan(abs(beta)) * (1.0 + off)
    law = Coulomb(kinetic_coefficient=0.5 * static, static_coefficient=static)
    start = {"xi": 0.0} if mechanism.name == "capsule" else {}
    if mechanism.name == "pendulum-cart":
        start = {"theta": -beta}  # the rod is upright
    if mechanism.name == "capsule":
        start = {"xi": -0.2 * G * math.sin(beta) / 40.0}  # the spring holds the inner mass
    run = simulate(replace(mechanism, incline=beta), law, t_end=0.02, y0=start, throw=False)
    if off > 0.0:
        assert run["x"][-1] == 0.0
    else:
        assert run["x"][-1] * beta < 0.0  # downhill: positive x is uphill


def test_ground_that_is_tilted_slowly_lets_the_block_go_at_the_angle_of_friction():
    # by bisection on the angle, as a tilt test does
    law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.35)
    low, high = 0.0, 1.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        run = simulate(SpringBlock(mass=1.0, incline=middle), law, t_end=0.1)
        low, high = (middle, high) if run.status is Status.AT_REST else (low, middle)
    assert low == pytest.approx(math.atan(0.35), rel=1e-11)


@each
def test_the_load_is_the_weight_times_the_cosine(mechanism):
    level = static_normal_force(mechanism)
    assert static_normal_force(replace(mechanism, incline=-0.5)) == pytest.approx(
        level * math.cos(0.5)
    )


def test_a_spring_shoots_the_block_less_far_uphill_by_its_energy():
    k, x_0, m, mu = 100.0, 0.1, 1.0, 0.25
    law = Coulomb(kinetic_coefficient=mu, static_coefficient=0.35)
    for beta in (0.25, -0.2):
        rig = SpringBlock(mass=m, stiffness=k, compression=x_0, incline=beta)
        run = simulate(rig, law, t_end=5.0)
        lost = m * G * (mu * math.cos(beta) + math.sin(beta))
        assert run["x"][-1] == pytest.approx(k * x_0**2 / (2.0 * lost), rel=1e-9)
        assert run.certificate.energy_error < 1e-9


def test_a_cart_that_is_parked_on_an_incline_tips_downhill_over_its_wheels():
    b, h_p, h_c, M, m, l = 0.2, 0.1, 0.05, 0.5, 0.1, 0.3  # noqa: E741
    swing = ThreePhase(amplitude=1e-9, fast=1e-6, slow=1e-6)  # as good as at rest
    cart = PendulumCart(
        cart_mass=M, ball_mass=m, length=l, wheelbase=b, pivot_height=h_p, centre_height=h_c,
        pendulum=Prescribed(profile=swing),
    )  # fmt: skip
    height = (M * h_c + m * (h_p + l)) / (M + m)
    steepest = math.atan(0.5 * b / height)
    law = Coulomb(kinetic_coefficient=5.0)
    for sign, reason in ((1.0, "tips backward"), (-1.0, "tips forward")):
        safe = replace(cart, incline=sign * (steepest - 1e-6))
        assert simulate(safe, law, t_end=0.1).status.complete
        steep = replace(cart, incline=sign * (steepest + 1e-6))
        run = simulate(steep, law, t_end=0.1, throw=False)
        assert run.status is Status.LIMIT
        assert run.events[-1].reason == reason


@pytest.mark.parametrize("bad", [1.58, -1.58, math.pi / 2, math.nan, 30.0])
def test_ground_steeper_than_a_wall_is_refused(bad):
    with pytest.raises(
        ParameterError, match=r"SpringBlock.incline \(beta\) must be (finite and )?at least -1.57"
    ):
        SpringBlock(mass=1.0, incline=bad)
