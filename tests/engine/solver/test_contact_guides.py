"""Prescribed motions and limits of mechanisms with several contacts."""

import math
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import pytest
from tests.contact_cases import Plain, coulomb

from stickslip import EventDriven, simulate
from stickslip.engine import Status
from stickslip.errors import InputError, SimulationError
from stickslip.maths import cos, sin
from stickslip.mechanisms import Contact, Guide
from stickslip.mechanisms.drives import Drive, Sampled, Sine
from stickslip.quantities import Quantity

PLAIN = EventDriven(tier="python")
SWING = Sine(amplitude=30.0, frequency=1.0)
START = {"omega": -30.0 / (2.0 * math.pi)}
LAWS = {"wheels": coulomb(0.1, 0.12), "block": coulomb(0.4, 0.5)}


@dataclass(frozen=True, kw_only=True)
class Swinging(Plain):
    """A cart with a pendulum that swings as it is told, and a block behind it on a spring."""

    name: ClassVar[str] = "swinging"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "theta", "z")
    rates: ClassVar[tuple[str, ...]] = ("v", "omega", "w")
    units: ClassVar[tuple[str, ...]] = ("m", "rad", "m")
    ball: Annotated[float, Quantity("m", "kg", above=0)] = 0.3
    cart: Annotated[float, Quantity("M", "kg", above=0)] = 0.5
    length: Annotated[float, Quantity("l", "m", above=0)] = 0.4
    spring: Annotated[float, Quantity("k", "N/m", low=0)] = 20.0
    strongest: Annotated[float, Quantity("T", "N m")] = 8.0
    swing: Drive = SWING

    def kinetic_energy(self, q, q_dot):
        along = q_dot["x"] + self.length * cos(q["theta"]) * q_dot["theta"]
        up = q_dot["y"] + self.length * sin(q["theta"]) * q_dot["theta"]
        cart = q_dot["x"] * q_dot["x"] + q_dot["y"] * q_dot["y"]
        own = 0.2 * q_dot["z"] * q_dot["z"]
        return 0.5 * (self.cart * cart + self.ball * (along * along + up * up) + own)

    def potential_energy(self, t, q):
        weight = (self.cart + self.ball) * 9.81
        hanging = self.ball * 9.81 * self.length * cos(q["theta"])
        stretch = q["z"] - q["x"]
        return weight * q["y"] - hanging + 0.5 * self.spring * stretch * stretch

    def drives(self):
        return {"swing": self.swing}

    def guided(self):
        return {"theta": Guide(drive="swing", effort="torque", unit="N m")}

    def held(self):
        return ("y",)

    def contacts(self):
        return (
            Contact(name="wheels", slip="x", normal="y"),
            Contact(name="block", slip="z", load=1.0),
        )

    def limits(self, forces):
        return {"motor": self.strongest - forces["theta"], "grip": forces["y"] - 2.0}


def test_torque_and_reaction_are_those_of_newton():
    cart = Swinging()
    run = simulate(cart, LAWS, t_end=3.0, y0=START, solver=PLAIN)
    assert run.certificate.certified  # with the work of the torque
    t = np.linspace(0.05, 3.0, 40)
    at = run.at(t)
    theta, rate = at["theta"], at["omega"]
    np.testing.assert_allclose(
        theta, -30.0 / (2 * math.pi) ** 2 * np.sin(2 * math.pi * t), atol=1e-11
    )
    swing = 30.0 * np.sin(2.0 * math.pi * t)
    m, length, total = cart.ball, cart.length, cart.ball + cart.cart
    normal = total * 9.81 + m * length * (np.sin(theta) * swing + np.cos(theta) * rate**2)
    pull = cart.spring * (at["z"] - at["x"]) - at["friction:wheels"]
    pull += m * length * (np.sin(theta) * rate**2 - np.cos(theta) * swing)
    moves = at["mode:wheels"] != 0
    assert 0 < moves.sum() < len(t) or moves.all()
    push = np.where(moves, pull / total, 0.0)
    torque = m * length * (length * swing + np.cos(theta) * push + 9.81 * np.sin(theta))
    np.testing.assert_allclose(at["normal_force:wheels"], normal, rtol=1e-12)
    np.testing.assert_allclose(at["torque"], torque, atol=1e-12)
    assert run.units["torque"] == "N m"


def test_exact_series_book_the_work_of_a_guide():
    """A plate that is shaken under a block on a spring: all is linear."""

    class Shaken(Plain):
        name = "shaken"
        coordinates, rates, units = ("base", "x", "z"), ("u", "v", "w"), ("m", "m", "m")

        def kinetic_energy(self, q, q_dot):
            carried = q_dot["base"] + q_dot["x"]
            beside = q_dot["base"] + q_dot["z"]
            own = 4.0 * q_dot["base"] * q_dot["base"]
            return 0.5 * (own + carried * carried + 2.0 * beside * beside)

        def potential_energy(self, t, q):
            return 8.0 * q["x"] * q["x"]

        def drives(self):
            return {"shake": Sampled(times=(0.0, 0.3, 0.9, 1.2), values=(6.0, -6.0, 6.0, 0.0))}

        def guided(self):
            return {"base": Guide(drive="shake", effort="push", unit="N")}

        def contacts(self):
            return tuple(Contact(name=i, slip=i, load=1.0) for i in ("x", "z"))

    run = simulate(Shaken(), coulomb(2.0, 3.0), t_end=2.0, solver=PLAIN)
    assert run.certificate.energy_error < 1e-14
    assert run.certificate.steps < 60
    # two spells of 0.3 s at 6 m/s^2 forwards, one of 0.6 s backwards: the plate comes to rest
    assert run["u"][-1] == pytest.approx(0.0, abs=1e-14)
    assert run["base"][-1] == pytest.approx(0.0, abs=1e-14)
    first = run.at([0.01])
    held = first["mode:x"][0] == 0, first["mode:z"][0] == 0
    assert held == (False, False)
    # plate and friction of both blocks, which are left behind
    assert first["push"][0] == pytest.approx(4.0 * 6.0 + 2.0 + 2.0 - 16.0 * first["x"][0], rel=1e-9)


def test_a_limit_ends_the_run_where_the_torque_reaches_it():
    run = simulate(Swinging(strongest=0.3), LAWS, t_end=3.0, y0=START, solver=PLAIN, throw=False)
    assert run.status is Status.LIMIT
    end = run.events[-1]
    assert end.reason == "motor"
    assert end.from_mode == end.to_mode == run["mode:wheels"][-1] != 0
    assert run["torque"][-1] == pytest.approx(0.3, rel=1e-12)
    whole = simulate(Swinging(), LAWS, t_end=3.0, y0=START, solver=PLAIN)
    before = whole.at(np.linspace(0.0, run.span[1], 400))["torque"]
    assert np.all(before <= 0.3 * (1.0 + 1e-9))


def test_a_limit_that_is_passed_at_the_start_ends_the_run_there():
    with pytest.raises(SimulationError, match=r"Limit: motor \(torque .* ended at t = 0 s"):
        simulate(Swinging(strongest=-1.0), LAWS, t_end=1.0, y0=START, solver=PLAIN)


class GuidedSlip(Swinging):
    """The pendulum is free; the cart is told how to move, so that nothing is left to its wheels."""

    def guided(self):
        return {"x": Guide(drive="swing", effort="pull", unit="N")}


class Switched(Swinging):
    """A limit of the size of a torque."""

    def limits(self, forces):
        return {"motor": 3.0 - abs(forces["theta"])}


@pytest.mark.parametrize(
    ("mechanism", "words"),
    [(GuidedSlip(), "x is a slip coordinate"), (Switched(), "a limit for each sign of the force")],
    ids=["guided slip", "limit with a switch"],
)
def test_what_is_not_determined_is_refused(mechanism, words):
    with pytest.raises(InputError, match=words):
        simulate(mechanism, LAWS, t_end=1.0, solver=PLAIN)


def test_two_limits_stand_for_the_size_of_a_force():
    class Both(Swinging):
        def limits(self, forces):
            return {"pull": 0.3 - forces["theta"], "push": 0.3 + forces["theta"]}

    run = simulate(Both(), LAWS, t_end=3.0, y0=START, solver=PLAIN, throw=False)
    assert abs(run["torque"][-1]) == pytest.approx(0.3, rel=1e-12)
    slower = replace(Both(), swing=replace(SWING, amplitude=1.0))
    assert simulate(slower, LAWS, t_end=1.0, solver=PLAIN).status is not Status.LIMIT
