"""What takes one contact names those there are, whatever laws it is given."""

import numpy as np
import pytest
from tests.contact_cases import coulomb

from stickslip import (
    EventDriven,
    Measurement,
    SpringBlock,
    TwoFeet,
    fit,
    select,
    simulate,
)
from stickslip.data import LawEstimates
from stickslip.errors import InputError
from stickslip.identify.criteria import criteria_of
from stickslip.mechanisms import PendulumCart
from stickslip.mechanisms.drives import Sine
from stickslip.study.control import PartialLinearisation, closed_loop
from stickslip.study.sweep import average_velocity, band_of, basins

PLAIN = EventDriven(tier="python")
BODY = TwoFeet(
    mass=2.0, front=0.3, rear=0.2, height=0.15, stiffness=50.0,
    drive=Sine(amplitude=30.0, frequency=2.0),
)  # fmt: skip
LAWS = {"front": coulomb(0.6, 0.7), "rear": coulomb(0.2, 0.3)}
TIME = np.linspace(0.0, 1.0, 100)
RECORD = Measurement(time=TIME, position=np.sin(5.0 * TIME), force=np.cos(5.0 * TIME))
KNOWN = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.1, 0.3)})

CALLS = {
    "PartialLinearisation": lambda m, _: PartialLinearisation(
        mechanism=m, law=coulomb(0.3), track="x", stiffness=1.0, damping=1.0
    )(0.0, {"x": 0.0, "v": 0.0}),
    "band_of": lambda m, law: band_of(
        m, law, KNOWN, t_end=1.0, count=3, seed=0, times=np.linspace(0.0, 1.0, 3)
    ),
    "fit": lambda m, law: fit(m, law, RECORD),
    "select": lambda m, law: select(m, law, RECORD),
    "criteria_of": lambda m, law: criteria_of(
        simulate(m, law, t_end=0.1, solver=PLAIN), m
    ),
}  # fmt: skip


@pytest.mark.parametrize("law", [LAWS, coulomb(0.3)], ids=["by contact", "shared"])
@pytest.mark.parametrize("name", [name for name in CALLS if name != "band_of"])
def test_several_contacts_are_refused_by_name(name, law):
    with pytest.raises(InputError, match="front, rear"):
        CALLS[name](BODY, law)


UNNAMED = {
    "average_velocity": lambda m, law: average_velocity(m, law, {"amplitude": [10.0, 20.0]}),
    "basins": lambda m, law: basins(m, law, {"x": [0.0, 1.0], "v": [0.0, 1.0]}),
    "band_of": CALLS["band_of"],
    "closed_loop": lambda m, law: closed_loop(
        m, law, lambda t, seen: 0.0, period=0.01, t_end=0.1
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", UNNAMED)
def test_laws_by_contact_are_refused_where_the_contact_has_no_name(name):
    block = SpringBlock(mass=1.0, drive=Sine(amplitude=3.0, frequency=2.0))
    with pytest.raises(InputError, match="one contact, which has no name: give its law alone"):
        UNNAMED[name](block, LAWS)


def test_a_foot_that_carries_load_needs_a_law_even_if_nothing_rubs_there():
    with pytest.raises(InputError, match=r"front has no law but carries load.*levels of 0"):
        simulate(BODY, LAWS | {"front": None}, t_end=1.0, solver=PLAIN)
    run = simulate(BODY, LAWS | {"front": coulomb(0.0)}, t_end=1.0, solver=PLAIN)
    assert not np.any(run["friction:front"])


def test_wheels_that_carry_a_cart_need_a_law_even_if_only_its_pivot_rubs():
    cart = PendulumCart(cart_mass=1.0, ball_mass=0.2, length=0.3, pivot_load=1.0)
    with pytest.raises(InputError, match=r"wheels has no law but carries load.*levels of 0"):
        simulate(cart, {"wheels": None, "pivot": coulomb(0.1)}, t_end=1.0, solver=PLAIN)
