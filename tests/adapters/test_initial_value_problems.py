"""SciPy's solvers on the equations of the engine."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pandas as pd
import pytest
from tests.loop_cases import TRIANGLE
from tests.solver.test_slip_directions import Shafts, shafts

from stickslip import (
    Axis,
    BlockChain,
    Capsule,
    Coulomb,
    CoulombViscousStatic,
    LuGre,
    PendulumCart,
    SpringBlock,
    TowedBlock,
    TwoFeet,
    TwoMassAxis,
    simulate,
)
from stickslip.engine import Status
from stickslip.errors import InputError, SimulationError
from stickslip.exports.adapters import ModeProblem, to_ivp
from stickslip.friction import PrintedCoulomb
from stickslip.mechanisms import BoundedMechanism, Prescribed, Stop, Torque
from stickslip.mechanisms.drives import Sampled, Sine, ThreePhase

COULOMB = Coulomb(kinetic_coefficient=0.25)
LEVELS = CoulombViscousStatic(
    kinetic_coefficient=0.2, static_coefficient=0.35, viscous_coefficient=0.5
)
BRISTLES = LuGre(
    kinetic_coefficient=0.2, static_coefficient=0.3, stribeck_velocity=0.05,
    bristle_stiffness=1e3, bristle_damping=10.0,
)  # fmt: skip
SWING = ThreePhase(amplitude=math.pi / 4, fast=120.0, slow=30.0)
FORCES = tuple(np.random.default_rng(0).uniform(-3.0, 3.0, 20))
CASES = {
    "decay": (SpringBlock(mass=1.0, stiffness=100.0, compression=0.1), COULOMB, 1.0, {}),
    "stick-slip": (TowedBlock(mass=1.0, stiffness=20.0, speed=0.1, load=10.0), LEVELS, 4.0, {}),
    "bristles": (
        TowedBlock(mass=1.0, stiffness=20.0, speed=0.05, load=10.0), BRISTLES, 1.0,
        {"method": "Radau", "rtol": 1e-9},
    ),
    "prescribed swing": (
        PendulumCart(
            cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING)
        ), Coulomb(kinetic_coefficient=0.2), 0.75, {},
    ),
    "saturating motor": (
        PendulumCart(
            cart_mass=0.5, ball_mass=0.1, length=0.3, pivot_stiffness=2.0,
            pendulum=Torque(drive=Sine(amplitude=0.5, frequency=1.5), limit=0.4),
        ), COULOMB, 1.0, {},
    ),
    "hard stops": (
        Capsule(
            capsule_mass=0.8, inner_mass=0.2, lower_stop=-0.01, upper_stop=0.01, restitution=0.5,
            drive=Torque(drive=Sine(amplitude=3.0, frequency=2.0)),
        ), COULOMB, 0.1, {},
    ),
    "sampled force": (
        Axis(inertia=1.0, drive=Sampled(times=tuple(np.arange(20) * 0.05), values=FORCES)),
        CoulombViscousStatic(
            kinetic_coefficient=1.0, static_coefficient=1.3, viscous_coefficient=0.1
        ), 1.0, {},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_scipy_finds_what_the_engine_finds(case):
    mechanism, law, t_end, settings = CASES[case]
    found = to_ivp(mechanism, law, t_end=t_end).solve(**settings)
    run = simulate(mechanism, law, t_end=t_end)
    end = run.at([t_end])
    for name in found.names:
        # 1e-10 of SciPy's steps, hundreds of them, and of its times of events
        assert found[name][-1] == pytest.approx(end[name][0], abs=3e-8), name
    changes = [e for e in run.events if e.from_mode != e.to_mode]
    assert [(b, c) for _, b, c in found.events] == [(e.from_mode, e.to_mode) for e in changes]
    np.testing.assert_allclose([t for t, *_ in found.events], [e.t for e in changes], atol=1e-7)
    inside = ~np.isin(found.t, [t for t, *_ in found.events])
    within = run.at(found.t[inside])
    np.testing.assert_allclose(found["v"][inside], within["v"], atol=1e-6)


CLUTCHES, _, PRESSED, _ = shafts()
SPUN = {"y0": {"w1": 10.0}}


@dataclass(frozen=True, kw_only=True)
class Ended(BoundedMechanism, Shafts):
    """The second of four shafts has an end stop."""

    name: ClassVar[str] = "ended"

    def stops(self):
        return (Stop(coordinate="phi2", position=1.5, side="upper", restitution=0.5),)


FEET = TwoFeet(
    mass=2.0,
    front=0.3,
    rear=0.2,
    height=0.15,
    stiffness=50.0,
    drive=Sine(amplitude=9.0, frequency=1.0),
)
LOOPED = {
    name: Coulomb(kinetic_coefficient=kinetic, static_coefficient=static)
    for name, kinetic, static in (("c0", 1.4, 2.0), ("c1", 2.6, 3.0), ("c2", 1.3, 1.5))
}
SEVERAL = {
    "feet": (FEET, LEVELS, 1.0, {}),
    "another law on each": (FEET, {"front": COULOMB, "rear": BRISTLES}, 0.1, {"method": "Radau"}),
    "two masses": (
        TwoMassAxis(
            motor_inertia=0.5,
            load_inertia=1.5,
            stiffness=200.0,
            damping=0.5,
            rubs="both",
            drive=Sampled(times=(0.0, 0.4), values=(5.0, -2.0)),
        ),
        CoulombViscousStatic(
            kinetic_coefficient=1.0, static_coefficient=1.3, viscous_coefficient=0.1
        ),
        0.8,
        {},
    ),
    "blocks on a belt": (
        BlockChain(blocks=2, mass=1.0, coupling=40.0, stiffness=10.0, speed=0.1),
        LEVELS,
        4.0,
        {},
    ),
    "slips that are sums": (CLUTCHES, PRESSED, 1.2, SPUN),
    "a loop that breaks open along a cut": (
        TRIANGLE(J1=2.0, J2=3.0, T0=8.0, R0=-3.0, T1=-0.5, spring=60.0), LOOPED, 2.0, {},
    ),
    "a loop whose closing contact holds": (
        TRIANGLE(J1=2.0, J2=3.0, R0=6.0, T1=-0.5, spring=20.0), LOOPED, 2.0,
        {"y0": {"v0": 1.0, "v1": -2.0}},
    ),
    "a wall": (Ended(second=CLUTCHES.second, third=CLUTCHES.third), PRESSED, 0.92, SPUN),
}  # fmt: skip


@pytest.mark.parametrize("case", SEVERAL)
def test_scipy_finds_what_the_engine_finds_of_several_contacts(case):
    mechanism, law, t_end, settings = SEVERAL[case]
    start = {key: value for key, value in settings.items() if key == "y0"}
    how = {key: value for key, value in settings.items() if key != "y0"}
    found = to_ivp(mechanism, law, t_end=t_end, **start).solve(**how)
    run = simulate(mechanism, law, t_end=t_end, **start)
    end = run.at([t_end])
    for name in found.names:
        assert found[name][-1] == pytest.approx(end[name][0], abs=1e-7), name
    table = found.to_dataframe()
    assert found.contacts == tuple(one.name for one in mechanism.contacts())
    for contact in found.contacts:
        changes = [e for e in run.events if e.contact == contact and e.from_mode != e.to_mode]
        own = [event for event in found.events if event[3] == contact]
        assert [event[1:3] for event in own] == [(e.from_mode, e.to_mode) for e in changes]
        np.testing.assert_allclose([event[0] for event in own], [e.t for e in changes], atol=1e-6)
        assert table[f"mode:{contact}"].iloc[-1] == end[f"mode:{contact}"][0]


def test_bounces_that_end_on_a_stop_end_as_those_of_the_engine():
    held = Capsule(
        capsule_mass=0.8, inner_mass=0.2, lower_stop=-0.01, upper_stop=0.01, restitution=0.5,
        drive=Torque(drive=Sampled(times=(0.0,), values=(1.0,))),
    )  # fmt: skip
    found = to_ivp(held, COULOMB, t_end=0.5).solve()
    run = simulate(held, COULOMB, t_end=0.5)
    assert (found.status, run.status) == (Status.END_TIME, Status.AT_REST)
    assert found["xi"][-1] == run["xi"][-1] == 0.01
    assert found["x"][-1] == pytest.approx(run["x"][-1], abs=1e-9)


def test_a_lift_off_ends_the_problem():
    motor = Torque(drive=Sampled(times=(0.0,), values=(2.0,)))
    cart = PendulumCart(cart_mass=0.2, ball_mass=0.2, length=0.3, pendulum=motor)
    found = to_ivp(cart, COULOMB, t_end=2.0).solve()
    run = simulate(cart, COULOMB, t_end=2.0, throw=False)
    assert found.status is run.status is Status.LIFT_OFF
    assert found.t[-1] == pytest.approx(run.span[1], rel=1e-7)


def test_long_steps_miss_what_happens_twice_within_one():
    mechanism, law, t_end, _ = CASES["prescribed swing"]
    problem = to_ivp(mechanism, law, t_end=t_end)
    missed = problem.solve(max_step=math.inf)
    assert len(missed.events) < len(to_ivp(mechanism, law, t_end=t_end).solve().events)


def test_a_start_is_taken_and_a_table_is_given():
    found = to_ivp(Axis(inertia=1.0), Coulomb(kinetic_coefficient=1.0), t_end=1.0, y0={"v": 0.5})
    solved = found.solve()
    assert solved["x"][-1] == pytest.approx(0.125, rel=1e-9)  # v^2 / 2 over 1 m/s^2
    table = solved.to_dataframe()
    assert isinstance(table, pd.DataFrame)
    assert [*table.columns] == ["t", "x", "v", "mode"]
    assert table["mode"].iloc[-1] == 0
    data = solved.to_xarray()
    assert data["v"].units == "m/s"
    np.testing.assert_array_equal(data["x"], table["x"])


def test_bristles_have_the_unit_of_a_length():
    mechanism, law, _, settings = CASES["bristles"]
    found = to_ivp(mechanism, law, t_end=0.01).solve(**settings)
    assert [found.to_xarray()[name].units for name in found.names] == ["m", "m/s", "m"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((Axis(inertia=1.0), PrintedCoulomb(kinetic_coefficient=0.2), 1.0), "FixedStep"),
        ((Axis(inertia=1.0), COULOMB, math.nan), "t_end"),
        ((Axis(inertia=1.0), "colomb", 1.0), "Did you mean 'coulomb'"),
    ],
)
def test_what_has_no_such_problem_is_refused(arguments, words):
    mechanism, law, t_end = arguments
    with pytest.raises(InputError, match=words):
        to_ivp(mechanism, law, t_end=t_end)


def test_changes_without_end_at_one_instant_are_an_error(monkeypatch):
    problem = to_ivp(*CASES["decay"][:2], t_end=1.0)
    monkeypatch.setattr(ModeProblem, "_happen", lambda *_: 1)  # each look finds another change
    with pytest.raises(SimulationError, match=r"changed 1000 times at t = 0 s: run it with simul"):
        problem.go_on(problem.t, problem.y)
