"""Drives that follow states: at once, by a switch, and a while ago."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import Axis, Capsule, Coulomb, TwoMassAxis, ensemble, simulate
from stickslip.data import load_rig
from stickslip.engine.solver import EventDriven, FixedStep, delays
from stickslip.engine.trajectory import Status
from stickslip.errors import InputError
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import DelayedFeedback, Feedback, Relay, Sine
from stickslip.quantities import parameters

FREE = Coulomb(kinetic_coefficient=0.0)
ROUGH = Coulomb(kinetic_coefficient=0.5, static_coefficient=0.7)
SHAKE = Sine(amplitude=2.0, frequency=2.0)
T = np.linspace(0.0, 5.0, 501)


def test_position_feedback_of_a_linear_oscillator_is_its_closed_form():
    pull = Feedback(state="x", gain=60.0, reference=0.2) + Feedback(state="v", gain=3.0)
    run = simulate(Axis(inertia=1.5, stiffness=40.0, drive=pull), FREE, t_end=5.0)
    decay, rest = 1.0, 0.12  # 3 / (2 * 1.5), and 60 * 0.2 / 100
    omega = math.sqrt(100.0 / 1.5 - decay**2)
    swing = np.exp(-decay * T) * (np.cos(omega * T) + decay / omega * np.sin(omega * T))
    np.testing.assert_allclose(run.at(T)["x"], rest * (1.0 - swing), atol=1e-13)
    assert run.certificate.certified


@pytest.mark.parametrize("law", [FREE, ROUGH])
def test_feedback_is_a_spring_and_a_damper(law):
    fed = SHAKE + Feedback(state="x", gain=100.0, reference=0.1) + Feedback(state="v", gain=2.0)
    by_hand = Axis(inertia=1.0, stiffness=105.0, damping=2.0, offset=-10.0, drive=SHAKE)
    one_axis = Axis(inertia=1.0, stiffness=5.0, drive=fed)
    one = simulate(one_axis, law, t_end=5.0)
    two = simulate(by_hand, law, t_end=5.0)
    np.testing.assert_allclose(one.at(T)["x"], two.at(T)["x"], atol=1e-12)
    assert [e.reason for e in one.events] == [e.reason for e in two.events]
    paths = [p for p, _, value in parameters(one_axis, "mechanism") if value == 100.0]
    slope = one.sensitivity("x", paths[0])[-1]
    stiff, lifted = (two.sensitivity("x", name)[-1] for name in ("stiffness", "offset"))
    assert slope == pytest.approx(stiff - 0.1 * lifted, rel=1e-7)


@pytest.mark.slow
def test_feedback_reaches_the_side_of_the_motor_and_several_contacts():
    settings = {"motor_inertia": 0.5, "load_inertia": 1.0, "stiffness": 100.0, "rubs": "both"}
    fed = TwoMassAxis(drive=Feedback(state="other", gain=10.0, reference=1.0), **settings)
    run = simulate(fed, Coulomb(kinetic_coefficient=0.2), t_end=3.0)
    t = np.linspace(0.0, 3.0, 61)
    held = run.at(t)
    assert held["x"].max() > 1.0
    fixed = simulate(fed, Coulomb(kinetic_coefficient=0.2), t_end=1.0, solver=FixedStep(dt=1e-5))
    assert fixed["x"][-1] == pytest.approx(float(run.at(1.0)["x"][0]), abs=1e-4)


def test_a_relay_switches_where_its_state_passes_the_level():
    axis = Axis(inertia=1.0, drive=Relay(state="x", above=-2.0, below=2.0, level=0.5))
    run = simulate(axis, FREE, t_end=9.0)
    # from 0.5 below the level and back: four equal parts, each of sqrt(2 s / a)
    part = math.sqrt(2.0 * 0.5 / 2.0)
    switches = [(e.t, e.reason) for e in run.events if e.reason != "reversal"]
    expected = [part * (2 * k + 1) for k in range(len(switches))]
    np.testing.assert_allclose([t for t, _ in switches], expected, rtol=1e-11)
    assert [name for _, name in switches[:2]] == ["relay switches up", "relay switches down"]


LEAVES = [  # values above and below, state, start, acceleration after time 0
    (-2.0, 2.0, "x", {"v": 1.0}, -2.0),
    (-2.0, 2.0, "x", {"v": -1.0}, 2.0),
    (2.0, 1.0, "x", {}, 2.0),
    (-2.0, -1.0, "x", {}, -1.0),
    (2.0, -2.0, "x", {"v": 1.0}, 2.0),
    (2.0, 1.0, "v", {}, 2.0),
    (-2.0, -1.0, "v", {}, -1.0),
]


@pytest.mark.parametrize(("above", "below", "state", "start", "rate"), LEAVES)
@pytest.mark.parametrize("tier", ["python", "compiled"])
def test_a_state_at_the_level_leaves_it_to_its_side(above, below, state, start, rate, tier):
    drive, solver = Relay(state=state, above=above, below=below), EventDriven(tier=tier)
    axis = Axis(inertia=1.0, drive=drive)
    run = simulate(axis, FREE, t_end=0.4, y0=start, solver=solver)
    v = start.get("v", 0.0)
    np.testing.assert_allclose(run.at([0.4])["x"], v * 0.4 + 0.5 * rate * 0.16, rtol=1e-12)


@pytest.mark.parametrize("state", ["x", "v"])
def test_a_state_that_both_values_push_back_to_the_level_ends_the_run(state):
    drive = Relay(state=state, above=-2.0, below=2.0)
    run = simulate(Axis(inertia=1.0, drive=drive), FREE, t_end=1.0, throw=False)
    assert run.status is Status.ZENO
    # so does one that reaches the level: at a velocity at once, at a place by shorter and shorter
    # swings about it, which friction damps
    start = {"v": 0.5} if state == "v" else {"x": 0.5}
    reached = simulate(Axis(inertia=1.0, drive=drive), ROUGH, t_end=20.0, y0=start, throw=False)
    assert reached.status is Status.ZENO
    assert abs(reached[state][-1]) < 1e-9
    # friction that holds it against both values keeps it there
    held = replace(drive, above=-0.3, below=0.3)
    still = simulate(Axis(inertia=1.0, drive=held), ROUGH, t_end=1.0)
    assert still.span[1] == 1.0
    assert not still["v"].any()


def test_a_state_that_is_not_there_is_refused():
    with pytest.raises(InputError, match=r"unknown state of a feedback 'y'\. Known: v, x"):
        simulate(Axis(inertia=1.0, drive=Feedback(state="y", gain=1.0)), FREE, t_end=1.0)


RIG = """
[mechanism]
type = "axis"
inertia = "1 kg"

[[mechanism.drive]]
type = "feedback"
state = "x"
gain = 100.0
reference = 0.1

[[mechanism.drive]]
type = "delayed-feedback"
state = "v"
gain = 10.0
delay = "50 ms"

[[mechanism.drive]]
type = "relay"
state = "x"
above = "-0.1 N"
below = "0.1 N"
"""


def test_rig_files_hold_them(tmp_path):
    path = tmp_path / "fed.toml"
    path.write_text(RIG)
    drive = load_rig(path).mechanism.drive
    assert drive.parts == (
        Feedback(state="x", gain=100.0, reference=0.1),
        DelayedFeedback(state="v", gain=10.0, delay=0.05),
        Relay(state="x", above=-0.1, below=0.1),
    )


# -- with a delay


def by_steps(gain, delay, until):
    """Return times and places of a damped oscillator by SciPy, one delay after the other."""
    parts, state, t = [], [1.0, 0.0], 0.0

    def past(s):
        return 1.0 if s <= 0.0 else next(f(s)[0] for end, f in parts if s <= end + 1e-12)

    def rates(s, y):
        force = gain * (past(s - delay) - y[0]) + 2.0 * math.sin(4.0 * math.pi * s)
        return [y[1], force - 10.0 * y[0] - 0.1 * y[1]]

    while t < until - 1e-12:
        span = (t, min(t + delay, until))
        found = solve_ivp(
            rates, span, state, method="DOP853", rtol=1e-12, atol=1e-13, dense_output=True
        )
        parts.append((span[1], found.sol))
        state, t = found.y[:, -1], span[1]
    return past


def test_delayed_feedback_is_that_of_a_delay_equation():
    fed = SHAKE + DelayedFeedback(state="x", gain=3.0, delay=0.37)
    axis = Axis(inertia=1.0, stiffness=10.0, damping=0.1, drive=fed)
    run = simulate(axis, FREE, t_end=3.0, y0={"x": 1.0})
    assert run.certificate.certified
    past = by_steps(3.0, 0.37, 3.0)
    times = np.linspace(0.01, 3.0, 100)
    np.testing.assert_allclose(run.at(times)["x"], [past(t) for t in times], atol=1e-6)


def test_a_finer_past_changes_a_run_with_impacts_and_sticking_little(monkeypatch):
    fed = Sine(amplitude=4.0, frequency=0.7) + DelayedFeedback(state="v", gain=0.5, delay=0.37)
    axis = Axis(inertia=1.0, stiffness=10.0, drive=fed, upper_stop=0.3, restitution=0.6)
    runs = []
    for past in (1e-4, 1e-5, 1e-6):
        monkeypatch.setattr(delays, "PAST", past)
        runs.append(simulate(axis, ROUGH, t_end=5.0, y0={"x": 0.2}))
    reasons = [[event.reason for event in run.events] for run in runs]
    assert reasons[0] == reasons[2]
    assert "hits stop" in reasons[0]
    x = [run.at(T)["x"] for run in runs]
    coarse, fine = np.abs(x[0] - x[2]).max(), np.abs(x[1] - x[2]).max()
    assert fine < 0.3 * coarse
    assert coarse < 1e-3


def test_a_delay_that_is_never_reached_leaves_what_was_at_first():
    fed = Axis(inertia=1.0, drive=DelayedFeedback(state="x", gain=4.0, delay=10.0))
    run = simulate(fed, FREE, t_end=3.0, y0={"x": 1.0, "v": 1.0})
    expected = 1.0 + 0.5 * np.sin(2.0 * T[:301])
    np.testing.assert_allclose(run.at(T[:301])["x"], expected, atol=1e-12)


def test_what_knows_no_past_refuses_a_delay():
    axis = Axis(inertia=1.0, drive=DelayedFeedback(state="x", gain=4.0, delay=0.1))
    with pytest.raises(InputError, match="DelayedFeedback has a past in runs of `simulate` alone"):
        ensemble(axis, FREE, {"inertia": [1.0, 2.0]}, t_end=1.0)
    with pytest.raises(InputError, match="DelayedFeedback has a past"):
        simulate(axis, FREE, t_end=1.0, solver=FixedStep(dt=1e-3))
    run = simulate(axis, FREE, t_end=0.3, y0={"x": 1.0})
    with pytest.raises(InputError, match="DelayedFeedback has a past"):
        run.sensitivity("x", "inertia")


def test_feedback_steers_a_capsule_from_one_of_its_motions_to_the_other():
    from stickslip.mechanisms import SoftStop
    from stickslip.study.sweep import periodic_orbit

    force = Sine(amplitude=0.2, frequency=2.75)
    law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)

    def capsule(drive):
        return Capsule(
            capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03,
            upper_soft_stop=SoftStop(place=2e-3, stiffness=3000.0, damping=0.1),
            drive=Torque(drive=drive), drive_on="inner mass",
        )  # fmt: skip

    start = {"xi": -2.035e-3, "xi_dot": 0.0988}
    first = periodic_orbit(capsule(force), law, start=start)
    assert first.stable
    assert first.mean_velocity["x"] == pytest.approx(3.9756e-3, rel=1e-3)
    braked = capsule(force + Feedback(state="xi_dot", gain=0.1))
    run = simulate(braked, law, t_end=20.0 / 2.75, y0=first.start)
    left = {name: float(run[name][-1]) for name in ("xi", "v", "xi_dot")}
    second = periodic_orbit(capsule(force), law, start=left)
    assert second.stable
    assert second.mean_velocity["x"] == pytest.approx(3.6096e-3, rel=1e-3)
