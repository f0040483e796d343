"""Figures of runs with several contacts."""

import numpy as np
import pytest
from benchmarks.several.brakes import ClutchTrain, DiscBrake, Lining, Rotor
from matplotlib.figure import Figure
from tests.contact_cases import coulomb

from stickslip import EventDriven, PendulumCart, simulate
from stickslip.mechanisms.drives import Pulse
from stickslip.show.plots import contact_sizes, draw_contacts, draw_states

PLAIN = EventDriven(tier="python")


@pytest.fixture(scope="module")
def train():
    """Seven clutches that are pressed one after the other, for a second each."""
    clutches = [Lining(radius=1.0, press=Pulse(level=20.0 - i, duration=1.0, start=0.1 * i))
                for i in range(7)]  # fmt: skip
    mechanism = ClutchTrain(rotors=[Rotor(inertia=1.0)] * 8, clutches=clutches)
    return simulate(
        mechanism, coulomb(0.5), t_end=2.0, y0={"omega": 10.0, "psi1_dot": -10.0}, solver=PLAIN
    )


def drawn(draw):
    """Return the axes of a drawing."""
    figure = Figure()
    draw(figure, False)
    return figure.axes


def test_a_raster_says_what_its_colours_mean_those_of_open_contacts_too(train):
    (axes,) = drawn(draw_contacts(train))
    words = [text.get_text() for text in axes.get_legend().get_texts()]
    assert words == ["slip backward", "stick", "slip forward", "open"]
    assert contact_sizes(train)["wide"][1] < 900


def test_a_raster_without_open_contacts_does_not_speak_of_them():
    mechanism = ClutchTrain(
        rotors=[Rotor(inertia=1.0)] * 8, clutches=[Lining(radius=1.0, load=20.0)] * 7
    )
    run = simulate(mechanism, coulomb(0.5), t_end=0.2, y0={"omega": 10.0}, solver=PLAIN)
    (axes,) = drawn(draw_contacts(run))
    assert "open" not in [text.get_text() for text in axes.get_legend().get_texts()]


def test_coordinates_of_one_unit_stand_in_one_panel():
    cart = PendulumCart(cart_mass=0.5, ball_mass=0.2, length=0.3, pivot_load=1.0)
    run = simulate(cart, coulomb(0.05), t_end=0.5, y0={"theta": 3.0}, solver=PLAIN)
    assert [axes.get_ylabel() for axes in drawn(draw_states(run))] == ["x, m", "theta, rad"]
    wheels, pivot = (axes.get_ylabel() for axes in drawn(draw_contacts(run)))
    assert wheels == "friction, N"
    assert pivot.endswith("N m")


def test_many_coordinates_are_curves_without_names(train):
    (axes,) = drawn(draw_states(train))
    assert axes.get_ylabel() == "phi to psi7, rad"
    assert axes.get_legend() is None
    assert len(axes.lines) == 8


def test_one_contact_at_a_radius_has_a_panel_too():
    brake = DiscBrake(inertia=0.5, pads=(Lining(radius=0.1, load=10.0),))
    run = simulate(brake, coulomb(0.3), t_end=1.0, y0={"omega": 1.0}, solver=PLAIN)
    (axes,) = drawn(draw_contacts(run))
    assert axes.get_title(loc="left") == "pad-1"
    np.testing.assert_allclose(axes.lines[0].get_ydata(), 3.0)  # 0.3 of 10 N, while it slips
