"""Hunting of an axis under a PID loop: cycles in closed form, their folds, and long runs."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm
from scipy.optimize import brentq

from stickslip import Coulomb, PIDAxis, Stribeck, Viscous, simulate
from stickslip.data import load_rig, rig_toml
from stickslip.errors import SimulationError
from stickslip.mechanisms.drives import Feedback, Pulse
from stickslip.study.energy import energy_balance
from stickslip.study.sweep import continue_event, continue_orbit, periodic_orbit

F_K, F_S = 1.0, 1.5
J, K_P, K_I, K_D, R = 1.0, 100.0, 300.0, 20.0, 0.1
AXIS = PIDAxis(inertia=J, proportional=K_P, integral=K_I, derivative=K_D, reference=R)
STICTION = Coulomb(kinetic_coefficient=F_K, static_coefficient=F_S)
FALLING = Stribeck(kinetic_coefficient=F_K, static_coefficient=F_S, stribeck_velocity=0.01)


def cycle_in_closed_form():
    """Return period, sticking share and amplitude of the symmetric cycle.

    The axis breaks away at the error e with K_p e + w = F_s, slips by 2 e, and rests until w has
    changed its sign.
    """
    # of the error, its rate and the integral part, while the axis slips upwards
    matrix = np.zeros((4, 4))
    matrix[0, 1] = 1.0
    matrix[1] = np.array([-K_P, -K_D, -1.0, F_K]) / J
    matrix[2, 0] = K_I

    def slipped(error):
        """Return error and integral part when the axis stops, and how long it slips."""
        begin = np.array([error, 0.0, F_S - K_P * error, 1.0])
        times = np.arange(1e-3, 0.9, 1e-3)
        speeds = [-(expm(matrix * t) @ begin)[1] for t in times]
        first = next(i for i, speed in enumerate(speeds) if speed < 0.0)
        length = brentq(
            lambda t: (expm(matrix * t) @ begin)[1], times[first - 1], times[first], xtol=1e-15
        )
        end = expm(matrix * length) @ begin
        return end[0], end[2], length

    error = brentq(lambda e: slipped(e)[0] + e, 1e-3, 4e-3, xtol=1e-16, rtol=1e-14)
    _, part, slip = slipped(error)
    stick = (part + F_S - K_P * error) / (K_I * error)
    return 2.0 * (slip + stick), stick / (slip + stick), error


def test_hunting_with_coulomb_friction_has_its_closed_form():
    period, share, error = cycle_in_closed_form()
    orbit = periodic_orbit(AXIS, STICTION)
    assert orbit.period == pytest.approx(period, rel=1e-9)
    assert orbit.sticking[""] == pytest.approx(share, rel=1e-9)
    seen = orbit.run().at(np.linspace(0.0, orbit.period, 1001))["x"] - R
    assert seen.max() == pytest.approx(error, rel=1e-9)
    assert seen.min() == pytest.approx(-error, rel=1e-9)
    assert orbit.stable


def test_a_long_run_ends_in_the_orbit():
    orbit = periodic_orbit(AXIS, FALLING)
    run = simulate(AXIS, FALLING, t_end=30.0 * orbit.period)
    leaves = [event.t for event in run.events if event.reason == "break-away"]
    assert leaves[-1] - leaves[-3] == pytest.approx(orbit.period, rel=1e-8)


def test_hunting_ends_in_a_fold_below_which_runs_reach_their_target():
    orbit = periodic_orbit(AXIS, FALLING)
    branch = continue_orbit(orbit, "mechanism.integral", (100.0, 320.0))
    (fold,) = (event for event in branch.events if event.kind == "fold")
    beside = branch.orbits_at(1.01 * fold.value)
    assert sorted(orbit.stable for orbit in beside) == [False, True]
    size = np.ptp(fold.orbit.run()["x"])
    for share, hunts in ((1.01, True), (0.99, False)):
        axis = replace(AXIS, integral=share * fold.value)
        start = next(orbit for orbit in beside if orbit.stable).start
        run = simulate(axis, FALLING, t_end=60.0 * fold.orbit.period, y0=dict(start))
        late = run.at(np.linspace(0.9, 1.0, 500) * run.t[-1])["x"]
        assert (np.ptp(late) > 0.5 * size) == hunts
    assert abs(late[-1] - R) < 0.1 * size


def test_the_fold_of_hunting_is_followed_over_two_gains():
    orbit = periodic_orbit(AXIS, FALLING)
    branch = continue_orbit(orbit, "mechanism.integral", (100.0, 320.0))
    (fold,) = (event for event in branch.events if event.kind == "fold")
    box = {"mechanism.integral": (100.0, 320.0), "mechanism.derivative": (17.0, 25.0)}
    curve = continue_event(fold, tuple(box), tuple(box.values()))
    middle = len(curve.values) // 2
    assert len(curve.values) > 4
    integral, derivative = curve.values[middle]
    stable = periodic_orbit(
        replace(AXIS, derivative=derivative, integral=1.1 * integral),
        FALLING,
        start=dict(orbit.start),
        settle=10,
    )
    again = continue_orbit(stable, "mechanism.integral", (0.5 * integral, 1.2 * integral))
    (other,) = (event for event in again.events if event.kind == "fold")
    assert other.value == pytest.approx(integral, abs=1e-6 * 220.0)


@pytest.mark.slow
def test_the_work_of_the_loop_closes_the_balance_of_the_axis():
    push = Pulse(level=5.0, duration=0.7)
    for axis in (AXIS, replace(AXIS, drive=push)):
        run = simulate(axis, STICTION, t_end=10.0)
        balance = energy_balance(axis, run)
        seen = run.at(np.linspace(0.0, 10.0, 400_001))
        loop = K_P * (R - seen["x"]) + seen["integral_part"] - K_D * seen["v"]
        loop = loop + 5.0 * np.heaviside(np.round(0.7 - seen.t, 9), 0.5) * (axis.drive is push)
        assert balance.mismatch < 1e-9
        assert balance.energy[-1] == pytest.approx(0.5 * J * run["v"][-1] ** 2, abs=1e-15)
        work = np.trapezoid(loop * seen["v"], seen.t)
        assert balance.drive[-1] == pytest.approx(work, rel=1e-6)


@pytest.mark.parametrize(
    "law", [Viscous(viscous_coefficient=2.0), Viscous(viscous_coefficient=0.0)]
)
def test_without_static_friction_a_loop_settles_and_there_is_no_cycle(law):
    with pytest.raises(SimulationError, match="there is no cycle: the motion comes to rest"):
        periodic_orbit(AXIS, law)
    with pytest.raises(SimulationError, match="there is no cycle: the motion comes to rest"):
        periodic_orbit(replace(AXIS, drive=Feedback(state="x", gain=-5.0, reference=0.2)), law)


def test_the_integral_part_is_in_the_unit_of_the_command():
    orbit_units = simulate(AXIS, STICTION, t_end=0.1).units
    assert [orbit_units[name] for name in ("impulse", "integral_part")] == ["N s", "N"]
    turning = replace(AXIS, rotary=True)
    units = simulate(turning, STICTION, t_end=0.1).units
    assert [units[name] for name in ("impulse", "integral_part")] == ["N m s", "N m"]


def test_a_rig_file_has_the_loop_with_its_units(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(
        '[mechanism]\ntype = "pid-axis"\ninertia = "1 kg"\n'
        'proportional = "100 N/m"\nintegral = "300 N/(m s)"\nderivative = "20 N s/m"\n'
        'reference = "10 cm"\n[friction]\nlaw = "coulomb"\nkinetic_coefficient = 1.0\n'
        "static_coefficient = 1.5\n"
    )
    rig = load_rig(path)
    assert rig.mechanism == AXIS
    again = tmp_path / "again.toml"
    again.write_text(rig_toml(AXIS, STICTION))
    assert load_rig(again).mechanism == AXIS
