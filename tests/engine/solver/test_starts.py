"""Where runs may begin: at hard stops, on kinks; and which solver knows stops."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal

import numpy as np
import pytest
from typing_extensions import Doc

from stickslip import Axis, Coulomb, EventDriven, SpringBlock, Stribeck, TwoMassAxis, simulate
from stickslip.errors import InputError, ParameterError
from stickslip.friction import BristleLaw
from stickslip.maths import sign, sin, where
from stickslip.mechanisms import Contact, Mechanism
from stickslip.mechanisms.drives import Pulse
from stickslip.quantities import Quantity

LAW = Coulomb(kinetic_coefficient=0.2)


@pytest.mark.parametrize(
    ("rig", "match"),
    [
        (Axis(inertia=1.0, upper_stop=-0.1), r"x = 0 m, beyond the upper stop of Axis at −0\.1 m"),
        (SpringBlock(mass=1.0, lower_stop=0.2), "beyond the lower stop of SpringBlock at 0.2 m"),
    ],
)
def test_a_start_beyond_a_stop_is_refused(rig, match):
    with pytest.raises(InputError, match=match):
        simulate(rig, LAW, t_end=1.0)


def test_a_start_beyond_a_stop_by_rounding_is_at_the_stop():
    rig = Axis(inertia=1.0, upper_stop=0.1)
    run = simulate(rig, LAW, t_end=1.0, y0={"x": 0.1 + 1e-16})
    assert run["x"][0] == 0.1
    assert run["mode"][0] == 2


def test_stops_that_leave_no_room_are_refused():
    with pytest.raises(ParameterError, match="the upper stop of x must lie above the lower"):
        Axis(inertia=1.0, lower_stop=0.1, upper_stop=0.1)


def test_a_restitution_above_one_is_refused():
    with pytest.raises(ParameterError, match=r"restitution \(e\) must be at least 0 and at most 1"):
        SpringBlock(mass=1.0, upper_stop=1.0, restitution=1.1)


@pytest.mark.parametrize("place", [-1.61803, 0.9032740018574321])
def test_what_begins_at_rest_far_from_zero_moves_as_at_zero(place):
    """The load has no force at first, but for the rounding of what its spring is made of."""
    axis = TwoMassAxis(
        motor_inertia=2.7, load_inertia=9.9, stiffness=10.6, rubs="motor",
        drive=Pulse(level=1.4, duration=1.0),
    )  # fmt: skip
    law = Stribeck(kinetic_coefficient=0.3, static_coefficient=0.3, stribeck_velocity=0.1)
    start = {"x": place, "other": place}
    far = simulate(axis, law, t_end=2.0, y0=start)
    near = simulate(axis, law, t_end=2.0)
    assert far.certificate.steps < 2 * near.certificate.steps
    for name, shift in (("x", place), ("other", place), ("v", 0.0), ("other_dot", 0.0)):
        # places of 1 m are rounded to 2e-16, and a falling law lets errors of steps grow
        np.testing.assert_allclose(
            far.at([0.5, 2.0])[name] - shift, near.at([0.5, 2.0])[name], rtol=0, atol=1e-10
        )


def gap_force(s, v, kind):
    """Return what a stiff spring with a damper gives while s < 0, as Modelica's ElastoGap does."""
    spring, damper = -1e6 * s, -250.0 * v
    if kind == "whole":
        return where(s < 0.0, spring + damper, 0.0)
    if kind == "pushing":
        push = spring + damper
        return where(s < 0.0, where(push > 0.0, push, 0.0), 0.0)
    clipped = where(damper < -spring, -spring, where(damper > spring, spring, damper))
    return where(s < 0.0, spring + clipped, 0.0)


@dataclass(frozen=True, kw_only=True)
class PreLoad(Mechanism):
    """A spool between two plates that a spring presses apart: Modelica's example of this name.

    Two of its four gaps are just closed as it begins, and its places are absolute.
    """

    name: ClassVar[str] = "pre-load"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "a", "b")
    rates: ClassVar[tuple[str, ...]] = ("v", "va", "vb")
    units: ClassVar[tuple[str, ...]] = ("m", "m", "m")
    gap: str = "whole"
    contacts_of: tuple[str, ...] = ("x",)

    def kinetic_energy(self, q, q_dot):
        plates = q_dot["a"] * q_dot["a"] + q_dot["b"] * q_dot["b"]
        return 0.5 * (0.15 * q_dot["x"] * q_dot["x"] + 0.01 * plates)

    def potential_energy(self, t, q):
        stretch = (q["b"] - 0.001) - (q["a"] + 0.001) - 0.025
        return 0.5 * 20e3 * stretch * stretch

    def forces(self, t, q, q_dot, drives):
        x, a, b = (q[name] for name in self.coordinates)
        v, va, vb = (q_dot[name] for name in self.coordinates)
        outer_a = gap_force(a - 0.001 + 0.0955 - 0.0015, va, self.gap)
        outer_b = gap_force(-0.065 - (b + 0.001) - 0.0015, -vb, self.gap)
        inner_a = gap_force((a + 0.008) - (x - 0.095 - 0.00575) - 0.001, va - v, self.gap)
        inner_b = gap_force((x - 0.095 + 0.00575) - (b - 0.008) - 0.001, v - vb, self.gap)
        pull = 150.0 * sin(2.0 * math.pi * 0.01 * t) - 2500.0 * v
        return {"x": pull - inner_a + inner_b, "a": outer_a + inner_a, "b": -outer_b - inner_b}

    def contacts(self):
        several = len(self.contacts_of) > 1
        return tuple(Contact(name=i if several else "", slip=i, load=1.0) for i in self.contacts_of)

    def drives(self):
        return {}

    def start(self):
        return {"x": 0.01475, "a": -0.093, "b": -0.06925}


@pytest.mark.parametrize(
    ("gap", "contacts", "level"),
    [
        ("whole", ("x",), 0.0),
        ("whole", ("x",), 1.0),
        ("pushing", ("x",), 1.0),
        ("clipped", ("x",), 1.0),
        ("whole", ("x", "a"), 1.0),
        ("clipped", ("x", "a"), 1.0),
    ],
)
def test_a_run_that_begins_exactly_on_kinks_goes_on_as_one_that_begins_beside_them(
    gap, contacts, level
):
    rig, law = PreLoad(gap=gap, contacts_of=contacts), Coulomb(kinetic_coefficient=level)
    solver = EventDriven(tier="compiled")
    run = simulate(rig, law, t_end=0.02, solver=solver)
    near = simulate(rig, law, t_end=0.02, solver=solver, y0={"a": -0.093 - 1e-12})
    for name in rig.coordinates:  # a picometre of penetration is 1e-6 N of 65 N
        assert run[name][-1] == pytest.approx(near[name][-1], abs=1e-12)
    assert run["a"][-1] < -0.093 - 1e-5


def test_a_start_on_a_kink_does_not_hold_what_has_just_broken_away():
    class Kinked(PreLoad):
        def start(self):
            return {}

        def potential_energy(self, t, q):
            stretch = q["b"] - q["a"] - 3.25e-3
            return 0.5 * 20e3 * stretch * stretch

        def forces(self, t, q, q_dot, drives):
            x, a, b = (q[name] for name in self.coordinates)
            v, va, vb = (q_dot[name] for name in self.coordinates)
            outer_a, inner_a = gap_force(a, va, "clipped"), gap_force(a - x, va - v, "clipped")
            outer_b = gap_force(0.00175 - b, -vb, "clipped")
            inner_b = gap_force(0.00175 + x - b, v - vb, "clipped")
            pull = 150.0 * sin(2.0 * math.pi * 0.01 * t) - 2500.0 * v
            return {"x": pull - inner_a + inner_b, "a": outer_a + inner_a, "b": -outer_b - inner_b}

    run = simulate(
        Kinked(), Coulomb(kinetic_coefficient=0.0), t_end=0.01, solver=EventDriven(tier="python")
    )
    assert run.events[0].reason == "break-away"
    assert sum(event.t == 0.0 for event in run.events) == 1


@dataclass(frozen=True, kw_only=True)
class Layered(BristleLaw):
    """Bristles that yield in steps of their deflection, by switches within switches."""

    name: ClassVar[str] = "layered"
    title: ClassVar[str] = "Layered bristles"
    formula: ClassVar[str] = "F = k z N"
    sources: ClassVar[tuple[str, ...]] = ()
    states: ClassVar[tuple[str, ...]] = ("z",)
    stiffness: Annotated[float, Quantity("k", "1/m", above=0)] = 1e4
    steps: Annotated[Literal["size", "side", "both"], Doc("What is compared.")] = "size"

    def rates(self, velocity, load, states):
        (z,) = states
        u = self.stiffness * z * sign(velocity)
        if self.steps == "size":
            yields = where(abs(z) < 1e-5, 0.0, where(z * velocity > 0.0, 1.0, 0.0))
        elif self.steps == "side":
            yields = where(z > 0.0, where(u > 0.5, 1.0, 0.0), where(u < 0.0, 0.0, 1.0))
        else:
            size = where(abs(z) < 5e-5, 0.0, where(abs(z) < 8e-5, 0.5, 1.0))
            yields = where(u > 0.0, size, 0.0)
        return (velocity * (1.0 - yields * u),)

    def force(self, velocity, load, states):
        return self.stiffness * states[0] * load

    def break_away(self, load):
        return load

    def steady(self, speed, load):
        return load + 0.0 * speed


@pytest.mark.parametrize("steps", ["size", "side", "both"])
@pytest.mark.parametrize("static_switch", [False, True])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_switches_within_switches_of_a_state_may_all_begin_on_their_thresholds(
    steps, static_switch, side
):
    law = Layered(steps=steps, static_switch=static_switch)
    block = SpringBlock(mass=1.0, stiffness=10.0, gravity=1.0, attached=True)
    run = simulate(block, law, t_end=3.0, y0={"x": 0.3 * side}, throw=False)
    assert run.status.complete
    assert not run.certificate.problems
    # a spring of 3 N draws 1 kg, which friction of at most 1 N slows, to the other side
    farthest = float((-side * run["x"]).max())
    assert 0.09 < farthest < 0.3
