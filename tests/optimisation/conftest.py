"""The cart of the reference numbers, and a capsule, with limits."""

import math

import pytest

from stickslip import Capsule, Coulomb, PendulumCart
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import ThreePhase
from stickslip.study.optimisation import Limits

MU = 0.2
STROKE = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")


@pytest.fixture(scope="session")
def law():
    return Coulomb(kinetic_coefficient=MU)


@pytest.fixture(scope="session")
def cart():
    swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    return PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    )


@pytest.fixture(scope="session")
def cart_limits():
    return Limits(
        position=math.radians(60.0), rate=12.0, effort=0.6, load_share=0.1, back_slip=1e-3
    )


@pytest.fixture(scope="session")
def capsule():
    # a motor without a limit would have other equations to compile; no test comes near this one
    drive = Prescribed(profile=STROKE, limit=100.0)
    return Capsule(capsule_mass=0.8, inner_mass=0.2, drive=drive)
