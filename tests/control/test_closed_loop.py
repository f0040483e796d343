"""The loop is closed: samples, delays, holds, and what friction does in between."""

import dataclasses

import numpy as np
import pytest
from scipy.linalg import expm

from stickslip import (
    Axis,
    Coulomb,
    EventDriven,
    FixedStep,
    LuGre,
    PendulumCart,
    TowedBlock,
    Viscous,
    simulate,
)
from stickslip.engine import Status
from stickslip.engine.solver import ensembles
from stickslip.engine.solver.run import Work
from stickslip.errors import InputError, SimulationError
from stickslip.friction import PRINTED_FORMS
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import Pulse, Sine, ThreePhase
from stickslip.study.control import PID, closed_loop

MASS, SPRING, DAMPER, PERIOD = 1.3, 20.0, 0.7, 0.02
AXIS = Axis(inertia=MASS, stiffness=SPRING)
VISCOUS = Viscous(viscous_coefficient=DAMPER)
K_P, K_D, TARGET = 40.0, 3.0, 0.25
STICTION = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)


def pd(t, seen):
    return K_P * (TARGET - seen["x"]) - K_D * seen["v"]


def discrete(count, delay, *, first=False):
    """States at the samples by matrix exponentials of the plant, with its command as a state."""
    plant = np.zeros((4, 4))
    plant[:2, :2] = [[0.0, 1.0], [-SPRING / MASS, -DAMPER / MASS]]
    plant[1, 2] = 1.0 / MASS  # command
    plant[2, 3] = 1.0  # and its slope
    iw, rest = divmod(delay, PERIOD)
    iw, rest = (int(iw), rest) if rest < 0.999 * PERIOD else (int(iw) + 1, 0.0)
    commands, y, states = {}, np.zeros(2), []

    def line(k):
        slope = (commands[k] - commands[k - 1]) / PERIOD if first and k > 0 else 0.0
        return (commands[k], slope) if k >= 0 else (0.0, 0.0)

    for k in range(count):
        states.append(y)
        commands[k] = pd(0.0, {"x": y[0], "v": y[1]})
        old, steep = line(k - iw - 1)
        new, slope = line(k - iw)
        before = expm(plant * rest) @ [*y, old + steep * (PERIOD - rest), steep]
        y = (expm(plant * (PERIOD - rest)) @ [*before[:2], new, slope])[:2]
    return np.array(states)


@pytest.mark.parametrize("delay", [0.0, 0.4 * PERIOD, PERIOD, 2.4 * PERIOD])
@pytest.mark.parametrize("hold", ["zero", "first"])
def test_without_dry_friction_the_samples_are_those_of_the_discrete_plant(delay, hold):
    loop = closed_loop(AXIS, VISCOUS, pd, period=PERIOD, t_end=3.0, delay=delay, hold=hold)
    exact = discrete(len(loop.t), delay, first=hold == "first")
    seen = np.column_stack([loop.measured["x"], loop.measured["v"]])
    # 150 samples, each exact to rounding
    np.testing.assert_allclose(seen, exact, rtol=0, atol=1e-12 * np.abs(exact).max())


def test_the_run_is_that_of_its_commands_bit_for_bit():
    loop = closed_loop(
        Axis(inertia=1.0),
        STICTION,
        lambda t, seen: 100.0 * (0.1 * np.sin(3.0 * t) - seen["x"]) - 4.0 * seen["v"],
        period=2e-3,
        t_end=3.0,
        delay=3e-3,
    )
    again = simulate(loop.mechanism, STICTION, t_end=3.0)
    assert len(loop.run.events) > 5
    assert loop.run.events == again.events
    np.testing.assert_array_equal(loop.run.t, again.t)
    np.testing.assert_array_equal(loop.run["x"], again["x"])


def test_bristles_go_on_between_samples():
    law = LuGre(
        kinetic_coefficient=1.0,
        static_coefficient=1.5,
        stribeck_velocity=1e-2,
        bristle_stiffness=1e4,
        bristle_damping=100.0,
    )
    loop = closed_loop(Axis(inertia=1.0), law, pd, period=5e-3, t_end=1.0)
    again = simulate(loop.mechanism, law, t_end=1.0)
    # the same bits but for the size of the first step, which the time of the whole run may set
    for state in ("x", "v", "z"):
        size = np.abs(again[state]).max()
        found = loop.run.at(loop.t)[state]
        np.testing.assert_allclose(found, again.at(loop.t)[state], rtol=0, atol=1e-12 * size)


def test_a_stuck_body_does_not_move_and_breaks_away_at_the_sample_that_breaks_it():
    loop = closed_loop(
        Axis(inertia=1.0), STICTION, lambda t, seen: 10.0 * t, period=0.01, t_end=0.3
    )
    (leaving,) = loop.run.events
    assert (leaving.t, leaving.reason) == (16 * 0.01, "break-away")  # 10 t > 1.5 after 0.15 s
    assert not loop.run.at(np.linspace(0.0, 0.16, 50))["x"].any()
    assert loop.run.certificate.certified


def test_a_drive_that_is_there_stays_as_a_disturbance():
    swing = Sine(amplitude=2.0, frequency=0.7)
    loop = closed_loop(
        Axis(inertia=1.0, drive=swing), STICTION, lambda t, seen: -swing.value(t), period=1e-3,
        t_end=2.0,
    )  # fmt: skip
    # what is left is the change of the disturbance within a period, below what friction holds
    assert loop.run.status is Status.END_TIME
    assert not loop.run["x"].any()


def test_a_mechanism_that_depends_on_time_goes_on_in_time():
    block = TowedBlock(mass=1.0, stiffness=2.0, speed=0.1, load=2.0)
    pressed = dataclasses.replace(block, modulation=Pulse(level=0.0, duration=1.0))

    def press(t, seen):
        return -1.0 if seen["v"] == 0.0 and t > 4.0 else 0.0

    loop = closed_loop(pressed, STICTION, press, period=0.1, t_end=8.0)
    first = loop.run.events[0]
    # spring 0.2 t against 1.5 times the load of 1 from 4.1 s on: at 7.5 s, where it breaks away
    assert (first.reason, first.t) == ("break-away", pytest.approx(7.5, rel=1e-12))


def test_an_axis_pressed_against_its_stop_stays_there():
    axis = Axis(inertia=1.0, upper_stop=0.1)
    loop = closed_loop(axis, STICTION, lambda t, seen: 5.0, period=1e-2, t_end=1.0)
    assert loop.run["x"][-1] == 0.1
    assert loop.run["mode"][-1] == 2
    assert loop.run.certificate.certified


def test_an_unstable_mechanism_is_balanced():
    cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3)
    balance = PID(proportional=4.0, derivative=0.2, state="theta", rate="omega")
    loop = closed_loop(cart, STICTION, balance, period=2e-3, t_end=2.0, y0={"theta": 0.1})
    assert abs(loop.run["theta"][-1]) < 1e-6
    assert np.abs(loop.commands).max() < 1.0


def test_commands_are_cut_at_the_limit_and_act_after_the_delay():
    loop = closed_loop(
        Axis(inertia=1.0), STICTION, lambda t, seen: 10.0, period=0.1, t_end=1.0, delay=0.25,
        limit=3.0,
    )  # fmt: skip
    assert loop.requested.tolist() == [10.0] * 10
    assert loop.commands.tolist() == [3.0] * 10
    assert loop.run.events[0].t == pytest.approx(0.25, rel=1e-15)
    # from then on (3 - 1) N on 1 kg
    assert loop.run["x"][-1] == pytest.approx(0.75**2, rel=1e-12)


def test_noise_has_a_seed_and_quantisation_its_steps():
    def seen(**settings):
        loop = closed_loop(AXIS, VISCOUS, pd, period=PERIOD, t_end=1.0, **settings)
        return loop.measured["x"], loop.run.at(loop.t)["x"]

    one, _ = seen(noise={"x": 1e-3}, seed=3)
    same, truth = seen(noise={"x": 1e-3}, seed=3)
    other, _ = seen(noise={"x": 1e-3}, seed=4)
    np.testing.assert_array_equal(one, same)
    assert not np.array_equal(one, other)
    assert 0.5e-3 < np.std(one - truth) < 2e-3  # 50 draws of standard deviation 1e-3
    steps, truth = seen(quantisation={"x": 0.01})
    np.testing.assert_allclose(steps, 0.01 * np.round(steps / 0.01), rtol=0, atol=1e-15)
    assert np.abs(steps - truth).max() <= 0.005 * (1 + 1e-12)


def test_a_controller_with_a_state_is_reset_before_a_run():
    pid = PID(proportional=K_P, integral=30.0, derivative=K_D, reference=TARGET)
    runs = [closed_loop(AXIS, VISCOUS, pid, period=PERIOD, t_end=1.0) for _ in range(2)]
    np.testing.assert_array_equal(runs[0].commands, runs[1].commands)


def test_a_run_that_is_cancelled_ends_where_it_was():
    told = []

    def enough(done, total):
        told.append((done, total))
        return done < 40

    loop = closed_loop(
        AXIS, VISCOUS, pd, period=0.01, t_end=1.0, progress=enough, throw=False
    )  # fmt: skip
    assert told[-1] == (40, 100)
    assert loop.status is Status.CANCELLED
    assert loop.run.span == (0.0, pytest.approx(0.4))
    assert len(loop.t) == 40


def test_a_run_that_ends_early_says_so():
    cart = PendulumCart(cart_mass=0.1, ball_mass=0.5, length=0.3)
    swing = {"theta": 0.0, "omega": 12.0}

    def run(**settings):
        return closed_loop(
            cart, STICTION, lambda t, seen: 0.0, period=1e-2, t_end=1.0, y0=swing, **settings
        )

    assert run(throw=False).status is Status.LIFT_OFF
    with pytest.raises(SimulationError, match="normal force"):
        run()


def test_a_cart_that_tips_in_closed_loop_is_refused_with_the_name_of_the_limit():
    cart = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, wheelbase=0.1, centre_height=0.2)
    with pytest.raises(SimulationError, match=r"Limit: tips (for|back)ward \(normal force "):
        closed_loop(cart, STICTION, lambda t, seen: 5.0, period=1e-2, t_end=1.0, y0={"theta": 0.1})


def test_a_long_loop_goes_on_in_machine_code_with_the_same_bits(monkeypatch):
    begun = []

    def enough(work, own=None):
        begun.append(own)
        return len(begun) > 2

    monkeypatch.setattr(Work, "is_enough", enough)
    monkeypatch.setattr(ensembles, "STRETCH", 30)
    auto, plain = (
        closed_loop(AXIS, STICTION, pd, period=1e-2, t_end=2.0, solver=EventDriven(tier=tier)).run
        for tier in ("auto", "python")
    )
    assert len(begun) == 3  # when it began, after 30 steps, and after 60
    assert begun[0] is None
    assert begun[2] >= begun[1] > 0.0
    assert auto.certificate == plain.certificate
    assert auto.events == plain.events
    np.testing.assert_array_equal(auto.t, plain.t)
    np.testing.assert_array_equal(auto["x"], plain["x"])


SWING = ThreePhase(amplitude=0.5, fast=120.0, slow=30.0)
CART = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"period": 0.0}, "period.*above 0 s"),
        ({"delay": -1.0}, "delay.*at least 0 s"),
        ({"t_end": 0.0}, "t_end"),
        ({"hold": "second"}, "'zero' or 'first'"),
        ({"hold": "first", "limit": 1.0}, "may exceed a limit"),
        ({"controller": 3.0}, "callable"),
        ({"controller": lambda t, seen: np.nan}, "finite number, got nan at t = 0 s"),
        ({"controller": lambda t, seen: "up"}, "finite number, got 'up'"),
        ({"noise": {"y": 1.0}}, "unknown state in noise 'y'"),
        ({"quantisation": {"x": 0.0}}, "above 0"),
        ({"drive": "motor"}, "unknown drive 'motor'"),
        ({"mechanism": CART}, "no drive that a controller can command"),
        ({"solver": FixedStep(dt=1e-3)}, "solver must be an EventDriven"),
        ({"solver": EventDriven(estimate_error=True)}, "without estimate_error"),
        ({"y0": {"w": 1.0}}, "unknown state in y0 'w'"),
    ],
)
def test_what_cannot_be_used_is_refused(changes, message):
    given = {"mechanism": AXIS, "law": STICTION, "controller": pd, "period": 0.01, "t_end": 0.1}
    given |= changes
    parts = [given.pop(name) for name in ("mechanism", "law", "controller")]
    with pytest.raises(InputError, match=message):
        closed_loop(*parts, **given)


def test_printed_forms_are_refused():
    form = next(iter(PRINTED_FORMS.values()))
    names = [f.name for f in dataclasses.fields(form) if f.default is dataclasses.MISSING]
    with pytest.raises(InputError, match="cannot solve"):
        closed_loop(AXIS, form(**dict.fromkeys(names, 0.5)), pd, period=0.01, t_end=0.1)
