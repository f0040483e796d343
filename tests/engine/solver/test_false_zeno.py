"""Events at one instant that follow each other once, not without end."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import (
    Capsule,
    Coulomb,
    Dahl,
    EventDriven,
    LuGre,
    PendulumCart,
    Stribeck,
    ensemble,
    simulate,
)  # fmt: skip
from stickslip.engine.trajectory import Status
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import Sine
from stickslip.study.sweep import average_velocity, velocity_band

STOP = SoftStop(place=5e-4, stiffness=760.0, damping=5.0)
FREQUENCY = "mechanism.drive.drive.frequency"
CAPSULE = Capsule(
    capsule_mass=0.03, inner_mass=0.03, stiffness=76.0, damping=0.09,
    drive=Torque(drive=Sine(amplitude=0.18, frequency=12.0)), drive_on="inner mass",
    upper_soft_stop=STOP,
)  # fmt: skip
LAW = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.24)
HARD = Capsule(
    capsule_mass=0.06, inner_mass=0.03, stiffness=110.0, damping=0.08, upper_stop=1.5e-3,
    restitution=0.5, drive=Torque(drive=Sine(amplitude=0.3, frequency=5.1)),
)  # fmt: skip
SLOW = Stribeck(
    kinetic_coefficient=0.16980872619627313, static_coefficient=0.1701,
    stribeck_velocity=0.005195057914303151, viscous_coefficient=0.4,
)  # fmt: skip


def integrated(t_end: float, times: np.ndarray) -> np.ndarray:
    """Return places of the capsule by SciPy: modes and events of `CAPSULE` coded by hand.

    Rest or slip; stop open, closed, or left by the damper that would pull.
    """
    m, k, c = CAPSULE.inner_mass, CAPSULE.stiffness, CAPSULE.damping
    weight = CAPSULE.gravity * (CAPSULE.capsule_mass + m)
    kinetic, static = (mu * weight for mu in (LAW.kinetic_coefficient, LAW.static_coefficient))
    t, y, mode, state, found = 0.0, np.zeros(4), 0, "open", []

    def press(y):
        return STOP.stiffness * (y[2] - STOP.place) + STOP.damping * y[3]

    def pull(y, state):  # on the capsule, by the inner mass
        return k * y[2] + c * y[3] + (press(y) if state == "closed" else 0.0)

    def at_rest(y, state):
        return 0 if abs(pull(y, state)) <= static else int(np.sign(pull(y, state)))

    def rates(t, y):
        a = 0.0 if mode == 0 else (pull(y, state) - mode * kinetic) / CAPSULE.capsule_mass
        drive = 0.18 * np.sin(2.0 * np.pi * 12.0 * t)
        return [y[1], a, y[3], (drive - pull(y, state)) / m - a]

    guards = {
        "stop": lambda t, y: mode * y[1] if mode else 1.0,
        "ahead": lambda t, y: 1.0 if mode else static - pull(y, state),
        "back": lambda t, y: 1.0 if mode else static + pull(y, state),
        "closed": lambda t, y: STOP.place - y[2] if state == "open" else 1.0,
        "open": lambda t, y: 1.0 if state == "open" else y[2] - STOP.place,
        "left": lambda t, y: press(y) if state == "closed" else 1.0,
    }
    for guard in guards.values():
        guard.terminal, guard.direction = True, -1
    while t < t_end:
        end = min(t_end, t + 1e-3)  # short stretches, so that no event hides in a step
        run = solve_ivp(
            rates, (t, end), y, method="DOP853", rtol=1e-12, atol=1e-15, max_step=1e-3,
            events=list(guards.values()), dense_output=True,
        )  # fmt: skip
        inside = times[(times >= t) & (times < run.t[-1])]
        found += [run.sol(at)[0] for at in inside]
        t, y = run.t[-1], run.y[:, -1].copy()
        for name, instants in zip(guards, run.t_events, strict=True):
            if not len(instants):
                continue
            if name in ("closed", "open", "left"):
                state = name
                y[2] = y[2] if name == "left" else STOP.place
            y[1] = y[1] if name not in ("stop", "ahead", "back") else 0.0
            forced = {"ahead": 1, "back": -1}.get(name, 0)
            mode = forced or (at_rest(y, state) if mode == 0 or name == "stop" else mode)
    return np.array(found)


@pytest.mark.slow
def test_a_capsule_that_a_damped_stop_breaks_away_moves_as_an_independent_code_says():
    # at 1.115 s the jump of the damper's force breaks it away with the mass 1e-17 m off its stop
    times = np.linspace(0.0, 1.3, 27)[:-1]
    run = simulate(CAPSULE, LAW, t_end=1.3)
    # tolerance of the reference over two hundred events
    np.testing.assert_allclose(run.at(times)["x"], integrated(1.3, times), atol=1e-9)


def test_every_frequency_has_a_velocity_where_a_damper_meets_what_sticks():
    frequencies = np.arange(10.0, 18.1, 0.25)
    found = average_velocity(CAPSULE, LAW, {FREQUENCY: frequencies}, cycles=20, settle=80)
    assert found.early_ends() == ()
    assert found.certified.all()
    # 24.620511252 mm/s by the same independent code over a hundred cycles
    assert found.velocity[frequencies == 12.0][0] == pytest.approx(0.024620511252, rel=1e-9)


@pytest.mark.parametrize("t_end", [100 / 5.1, 40.0])
def test_a_slow_break_away_goes_on(t_end):
    run = simulate(HARD, SLOW, t_end=t_end, solver=EventDriven(tier="compiled"))
    assert run.status is Status.END_TIME
    pairs = zip(run.events, run.events[1:], strict=False)
    undone = [
        before.t
        for before, after in pairs
        if (before.reason, after.reason) == ("break-away", "stop") and after.t == before.t
    ]
    assert undone == []


def test_a_hard_stop_where_a_soft_one_begins_is_left():
    both = replace(
        CAPSULE, capsule_mass=0.084, inner_mass=0.014, stiffness=28.2, damping=0.0217,
        drive=Torque(drive=Sine(amplitude=0.0313, frequency=6.3)), drive_on="both",
        upper_stop=3.8e-4, upper_soft_stop=SoftStop(place=3.8e-4, stiffness=178.0, damping=0.36),
    )  # fmt: skip
    run = simulate(both, Coulomb(kinetic_coefficient=0.092, static_coefficient=0.148), t_end=16.0)
    assert "xi leaves stop" in {event.reason for event in run.events}
    # a soft stop cannot be pressed in behind a hard one: it changes nothing
    alone = replace(both, upper_soft_stop=None)
    hard = simulate(alone, Coulomb(kinetic_coefficient=0.092, static_coefficient=0.148), t_end=16.0)
    np.testing.assert_allclose(run.at([16.0])["x"], hard.at([16.0])["x"], rtol=1e-9)


def test_bounces_end_that_press_only_while_the_capsule_slips():
    # the held capsule lets the mass go, but each bounce makes it slip, and then the mass is pressed
    capsule = Capsule(
        capsule_mass=0.04651720282252222, inner_mass=0.026569411964955374,
        drive=Torque(drive=Sine(amplitude=0.026429146557479535, frequency=8.490086213573035)),
        stiffness=38.19925177475124, damping=0.38520736222307517,
        upper_stop=0.00011326140205906242, restitution=0.3, drive_on="inner mass",
    )  # fmt: skip
    law = Stribeck(
        kinetic_coefficient=0.12087673844993362, static_coefficient=0.12169314137835338,
        stribeck_velocity=0.006421857153872945, viscous_coefficient=0.25761005758850425,
    )  # fmt: skip
    run = simulate(capsule, law, t_end=1.0)
    assert run.certificate.certified


DAHL = Dahl(kinetic_coefficient=0.2, bristle_stiffness=300.0)
LUGRE = LuGre(
    kinetic_coefficient=0.2, static_coefficient=0.25, stribeck_velocity=0.01,
    bristle_stiffness=300.0, bristle_damping=1.0,
)  # fmt: skip


def upright(frequency, amplitude, phase, restitution, **stop):
    """Return a cart on bristles whose pendulum stands upright at its stop."""
    return PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pivot_stiffness=4.0, pivot_damping=0.01,
        pendulum=Torque(drive=Sine(amplitude=amplitude, frequency=frequency, phase=phase)),
        restitution=restitution, **stop,
    )  # fmt: skip


def pushed(frequency, amplitude):
    """Return a capsule on bristles whose inner mass begins at its stop."""
    drive = Torque(drive=Sine(amplitude=amplitude, frequency=frequency, phase=np.pi))
    return replace(
        HARD, capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, upper_stop=None,
        lower_stop=0.0, restitution=0.0, drive=drive,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("rig", "law", "cycles"),
    [
        (upright(1.475888553771215, 0.08811377676660011, np.pi, 0.3, lower_stop=0.0), DAHL, 8),
        (upright(1.1680564271802019, 0.07297264538403808, 0.0, 0.0, upper_stop=0.0), DAHL, 8),
        (pushed(4.9935631221454185, 0.040115448044303455), LUGRE, 40),
    ],
)
def test_what_leaves_a_stop_as_all_forces_vanish_goes_on_beside_bristles(rig, law, cycles):
    place, drive = ("theta", rig.pendulum) if law is DAHL else ("xi", rig.drive)
    period = 1.0 / drive.drive.frequency
    run = simulate(rig, law, t_end=cycles * period)
    leaves = [event.t for event in run.events if event.reason == f"{place} leaves stop"]
    # the force alone turns at the stop, twice a period
    assert np.abs(2.0 * leaves[0] / period - round(2.0 * leaves[0] / period)) < 1e-9
    assert run.certificate.certified
    assert np.abs(run[place]).max() > 1e-5


def test_a_run_that_ends_early_is_not_certified():
    few = EventDriven(max_steps=20)
    run = simulate(CAPSULE, LAW, t_end=1.0, solver=few, throw=False)
    assert run.status is Status.STEP_LIMIT
    assert run.certificate.problems[0].endswith("before the end that was asked for")
    assert not run.certificate.certified
    runs = ensemble(CAPSULE, LAW, {FREQUENCY: [0.01, 12.0]}, t_end=1.0, solver=few)
    assert [status.complete for status in runs.status] == runs.certified.tolist()


def test_a_band_says_which_runs_it_leaves_out_and_why():
    few, slow = EventDriven(max_steps=120), [4.0, 12.0]
    laws = [LAW, replace(LAW, static_coefficient=0.2)]
    band = velocity_band(CAPSULE, laws, {FREQUENCY: slow}, cycles=2, settle=4, solver=few)
    early = ~np.isfinite(band.velocities)
    assert early.any()
    (sentence,) = band.early_ends()
    assert sentence.startswith(f"At {early.sum()} of 4 runs with 2 laws (frequency ")
    assert "maximum number of steps" in sentence
    assert sentence.endswith("The band leaves them out.")
    assert sentence in str(band)
    assert band.to_dataframe()["laws"].tolist() == (~early).sum(axis=0).tolist()
