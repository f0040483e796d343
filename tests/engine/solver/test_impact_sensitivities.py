"""Sensitivities beyond impacts at hard stops, against closed forms and differences of runs."""

import cmath
from dataclasses import dataclass, replace
from typing import Annotated, ClassVar

import numpy as np
import pytest
from tests.contact_cases import Plain

from stickslip import Axis, Capsule, Coulomb, EventDriven, LuGre, SpringBlock, Stribeck, simulate
from stickslip.maths import cos, sin
from stickslip.mechanisms import BoundedMechanism, Contact, Stop, Torque
from stickslip.mechanisms.drives import Ramp, Sine
from stickslip.quantities import Quantity, parameters, vary

PLAIN, COMPILED = EventDriven(tier="python"), EventDriven(tier="compiled")
FALL = {"inertia": 1.3, "offset": 4.0, "lower_stop": -0.7, "restitution": 0.8, "level": 0.9}
"""A block that a constant force presses down to a stop, on which it bounces."""


def falling(numbers):
    """Return rig and law."""
    level = numbers["level"]
    rig = Axis(load=1.0, **{name: x for name, x in numbers.items() if name != "level"})
    return rig, Coulomb(kinetic_coefficient=level)


def fallen(numbers, t, bounces):
    """Return time of the last of some bounces, and place and rate at a time while it rises."""
    m, f, x0, e, level = numbers.values()
    down, up = (f - level) / m, (f + level) / m
    time = cmath.sqrt(-2.0 * x0 / down)
    speed = e * down * time
    for _ in range(bounces - 1):
        time += speed / up + speed / cmath.sqrt(up * down)
        speed *= e * cmath.sqrt(down / up)
    since = t - time
    return time, x0 + speed * since - 0.5 * up * since**2, speed - up * since


@pytest.mark.parametrize("bounces", [1, 2, 5])
def test_a_bouncing_block_has_the_derivatives_of_its_closed_form(bounces):
    rig, law = falling(FALL)
    hit = fallen(FALL, 0.0, bounces)[0].real
    t = hit + 0.01 * 0.6**bounces  # it still rises
    run = simulate(rig, law, t_end=t, solver=PLAIN)
    assert run.events[-1].reason == "hits stop"
    assert run.events[-1].t == pytest.approx(hit, rel=1e-14)
    for name, value in FALL.items():
        path = "kinetic_coefficient" if name == "level" else name
        moved = fallen({**FALL, name: value + 1e-30j}, t, bounces)
        for state, end in zip(("x", "v"), moved[1:], strict=True):
            assert run[state][-1] == pytest.approx(end.real, rel=1e-13)
            # roundings of five bounces, each of which is some units of the last
            assert run.sensitivity(state, path)[-1] == pytest.approx(end.imag * 1e30, rel=1e-12)


def test_a_body_that_has_come_to_rest_at_its_stop_goes_with_it():
    rig, law = falling(FALL)
    run = simulate(rig, law, t_end=20.0, solver=PLAIN)
    assert run.events[-1].to_mode == -2
    for path in ("inertia", "offset", "restitution", "kinetic_coefficient", "initial.x"):
        # the last bounce of all is a billionth as fast as the first, and its end divides by that
        assert run.sensitivity("x", path)[-1] == pytest.approx(0.0, abs=1e-6)
        assert run.sensitivity("v", path)[-1] == 0.0
    assert run.sensitivity("x", "lower_stop")[-1] == pytest.approx(1.0, abs=1e-6)


def test_leaving_a_stop_has_the_derivatives_of_the_force_that_ends_the_pressure():
    m, rate, offset, level, stop, t = 1.3, 0.5, 4.0, 0.9, -0.7, 14.0
    rig = Axis(
        inertia=m, load=1.0, offset=offset, lower_stop=stop, restitution=0.5,
        drive=Ramp(rate=rate),
    )  # fmt: skip
    run = simulate(rig, Coulomb(kinetic_coefficient=level), t_end=t, solver=PLAIN)
    leaves = (offset + level) / rate
    assert run.events[-1].reason == "leaves stop"
    assert run.events[-1].t == pytest.approx(leaves, rel=1e-14)
    since = t - leaves  # it is rate / m since^3 / 6 away from the stop then
    slopes = {
        "offset": -0.5 * since**2 / m,
        "kinetic_coefficient": -0.5 * since**2 / m,
        "inertia": -rate * since**3 / 6.0 / m**2,
        "lower_stop": 1.0,
        "restitution": 0.0,
    }
    for path, slope in slopes.items():
        assert run.sensitivity("x", path)[-1] == pytest.approx(slope, rel=1e-6, abs=1e-6)


def test_a_stop_that_takes_all_speed_has_one_sided_derivatives():
    rig, law = falling({**FALL, "restitution": 0.0})
    run = simulate(rig, law, t_end=3.0, solver=PLAIN)
    assert run.events[-1].to_mode == -2
    assert run.sensitivity("x", "restitution")[-1] == 0.0  # a bounce of no height ends at once
    assert run.sensitivity("v", "restitution")[-1] == 0.0
    # with a force away from the stop, it leaves with the speed that the restitution gives
    back = Axis(inertia=1.0, load=1.0, offset=-1.0, lower_stop=-0.1, restitution=0.0)
    run = simulate(back, Coulomb(kinetic_coefficient=0.2), t_end=1.0, y0={"v": -1.0}, solver=PLAIN)
    (hit,) = (event.t for event in run.events)
    speed = np.sqrt(1.0 - 2.0 * 1.2 * 0.1)  # friction helps to brake it
    assert hit < 1.0
    assert run.sensitivity("x", "restitution")[-1] == pytest.approx(speed * (1.0 - hit), rel=1e-12)


@dataclass(frozen=True, kw_only=True)
class Coupled(BoundedMechanism, Plain):
    """Two coordinates whose mass matrix depends on one of them, with a stop each."""

    name: ClassVar[str] = "coupled"
    coordinates: ClassVar[tuple[str, ...]] = ("x", "a")
    rates: ClassVar[tuple[str, ...]] = ("v", "w")
    units: ClassVar[tuple[str, ...]] = ("m", "m")
    contacts_of: tuple[str, ...] = ("x", "a")
    first: Annotated[float, Quantity("m_1", "kg")] = 1.0
    second: Annotated[float, Quantity("m_2", "kg")] = 0.7
    coupling: Annotated[float, Quantity("m_12", "kg")] = 0.3
    bend: Annotated[float, Quantity("b", "kg")] = 0.4
    spring: Annotated[float, Quantity("k", "N/m")] = 5.0
    push: Annotated[float, Quantity("f", "N")] = 4.0
    upper: Annotated[float, Quantity("x_u", "m")] = 0.4
    lower: Annotated[float, Quantity("a_l", "m")] = -0.3
    restitution: Annotated[float, Quantity("e")] = 0.6
    other: Annotated[float, Quantity("e_a")] = 0.3

    def kinetic_energy(self, q, q_dot):
        v, w = q_dot["x"], q_dot["a"]
        mass = self.first + self.bend * sin(q["a"])
        return 0.5 * (mass * v * v + self.second * w * w) + self.coupling * cos(q["a"]) * v * w

    def potential_energy(self, t, q):
        return 0.5 * self.spring * q["a"] * q["a"]

    def forces(self, t, q, q_dot, drives):
        return {"x": self.push * cos(3.0 * t), "a": -0.6 * self.push * sin(2.3 * t)}

    def contacts(self):
        several = len(self.contacts_of) > 1
        return tuple(Contact(name=i if several else "", slip=i, load=1.0) for i in self.contacts_of)

    def stops(self):
        return (
            Stop(coordinate="x", position=self.upper, side="upper", restitution=self.restitution),
            Stop(coordinate="a", position=self.lower, side="lower", restitution=self.other),
        )


DRY = Coulomb(kinetic_coefficient=0.5, static_coefficient=0.7)
BRISTLES = LuGre(
    kinetic_coefficient=0.3, static_coefficient=0.4, stribeck_velocity=0.05,
    bristle_stiffness=1e3, bristle_damping=20.0, viscous_coefficient=0.1,
)  # fmt: skip
CAPSULE = Capsule(
    capsule_mass=0.8, inner_mass=0.2, stiffness=40.0, damping=0.2, lower_stop=-0.02,
    upper_stop=0.015, restitution=0.6, drive=Torque(drive=Sine(amplitude=3.0, frequency=4.0)),
)  # fmt: skip
AXIS = Axis(
    inertia=1.0, load=1.0, drive=Sine(amplitude=5.0, frequency=1.3), lower_stop=-0.03,
    upper_stop=0.05, restitution=0.5,
)  # fmt: skip
BLOCK = SpringBlock(
    mass=1.0, stiffness=150.0, compression=0.12, attached=True, upper_stop=0.15, lower_stop=-0.02,
    restitution=0.7,
)  # fmt: skip
START = {"v": 1.0, "w": -0.5}
CASES = {
    "capsule": (CAPSULE, Coulomb(kinetic_coefficient=0.23), 0.6, {}),
    "capsule on bristles": (CAPSULE, BRISTLES, 0.4, {}),
    "axis": (AXIS, Coulomb(kinetic_coefficient=0.3, static_coefficient=0.9), 1.5, {}),
    "block": (
        BLOCK,
        Stribeck(
            kinetic_coefficient=0.1, static_coefficient=0.15, stribeck_velocity=0.2,
            viscous_coefficient=0.5,
        ),
        0.9,
        {},
    ),
    "one contact": (Coupled(contacts_of=("x",)), DRY, 2.0, START),
    "several contacts": (Coupled(), DRY, 2.0, START),
}  # fmt: skip


@pytest.mark.parametrize("name", CASES)
def test_every_sensitivity_beyond_impacts_is_that_of_differences(name):
    rig, law, t_end, y0 = CASES[name]
    solver = EventDriven(tier="compiled", tolerance=1e-11, stiff_tolerance=1e-9)
    run = simulate(rig, law, t_end=t_end, y0=y0, solver=solver)
    assert sum("hits stop" in event.reason for event in run.events) > 1
    states = [*rig.coordinates, *rig.rates]
    for root, holder in (("mechanism", rig), ("friction", law)):
        for path, _, value in parameters(holder, root):
            if value == 0.0 or (value == 1.0 and root == "friction"):
                continue  # at the end of its range, or where bristles at rest go the other way
            step = 1e-6 * max(abs(value), 0.01)
            ends = []
            for change in (-step, step):
                near = vary(holder, root, {path: value + change})
                pair = (near, law) if root == "mechanism" else (rig, near)
                other = simulate(*pair, t_end=t_end, y0=y0, solver=solver)
                assert len(other.events) == len(run.events)
                ends.append(np.array([other[state][-1] for state in states]))
            known = (ends[1] - ends[0]) / (2.0 * step)
            found = np.array([run.sensitivity(state, path)[-1] for state in states])
            # errors of the runs, 1e-11 or 1e-9 of bristles, over the step
            rough = 1e-5 if law is not BRISTLES else 1e-3
            scale = np.abs(known).max() + 1e-3 / max(abs(value), 0.01)
            np.testing.assert_allclose(found, known, atol=rough * scale, err_msg=path)


def test_the_inner_mass_that_kicks_a_capsule_at_rest_has_the_momentum_it_shares():
    capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, upper_stop=0.1, restitution=0.6)
    t, mu = 0.12, 0.2
    law = Coulomb(kinetic_coefficient=mu)
    run = simulate(capsule, law, t_end=t, y0={"xi_dot": 1.0}, solver=PLAIN)
    assert run.events[0].reason == "xi hits stop"
    assert run.events[0].t == pytest.approx(0.1, rel=1e-14)
    # the capsule gets (1 + e) m / (M + m) of the speed; ground friction brakes it with mu g / .8
    assert run.sensitivity("v", "restitution")[-1] == pytest.approx(0.2, rel=1e-13)
    since, brakes = t - 0.1, 9.81 * (0.8 + 0.2) / 0.8
    assert run.sensitivity("x", "kinetic_coefficient")[-1] == pytest.approx(
        -0.5 * brakes * since**2, rel=1e-12
    )
    by_speed = 1.6 * 0.2 * (since + 0.1) - mu * brakes * since * 0.1
    assert run.sensitivity("x", "initial.xi_dot")[-1] == pytest.approx(by_speed, rel=1e-12)


def test_a_body_that_begins_pressed_against_its_stop_has_the_derivatives_that_keep_it_there():
    rig = Axis(
        inertia=1.0, load=1.0, offset=2.0, lower_stop=0.0, restitution=0.5, drive=Ramp(rate=1.0)
    )
    run = simulate(rig, Coulomb(kinetic_coefficient=0.5), t_end=4.0, solver=PLAIN)
    assert [event.reason for event in run.events] == ["leaves stop"]
    since = 4.0 - 2.5
    for path in ("offset", "kinetic_coefficient"):
        assert run.sensitivity("x", path)[-1] == pytest.approx(-0.5 * since**2, rel=1e-12)
    for path in ("initial.x", "initial.v", "lower_stop"):  # an impact would follow, or none
        assert np.isnan(run.sensitivity("x", path)).all()


def test_two_impacts_that_coincide_by_chance_have_no_derivative_of_what_would_part_them():
    rig = replace(Coupled(), spring=0.0, push=0.0, bend=0.0, coupling=0.0, upper=0.5, lower=-0.5)
    law = Coulomb(kinetic_coefficient=0.0, static_coefficient=0.0)
    run = simulate(rig, law, t_end=0.8, y0={"x": 0.0, "v": 1.0, "w": -1.0}, solver=PLAIN)
    (hit,) = {event.t for event in run.events}
    assert hit == pytest.approx(0.5, rel=1e-15)
    assert np.isnan(run.sensitivity("x", "upper")[-1])
    assert np.isfinite(run.sensitivity("x", "other")[-1])
