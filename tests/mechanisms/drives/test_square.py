"""Square waves in runs: closed forms, the motion of capsules, and slopes by period and duty."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Capsule, Coulomb, EventDriven, SpringBlock, ensemble, simulate
from stickslip.engine import Status
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Square

G = 9.81
PLAIN = EventDriven(tier="python")
"""For a few short runs of an ensemble, whose equations no other test has compiled."""


def test_a_linear_oscillator_answers_a_square_wave_as_its_fourier_series_says():
    m, c, k = 0.5, 2.0, 300.0
    wave = Square(high=3.0, low=-1.0, period=0.7, duty=0.3)
    axis = Axis(inertia=m, stiffness=k, damping=c, drive=wave)
    run = simulate(axis, Coulomb(kinetic_coefficient=0.0), t_end=20.3)
    t = np.linspace(19.6, 20.3, 60)  # transients have fallen by exp(-c t / 2 m) = 1e-17
    x = np.full_like(t, wave.mean / k)
    for n in range(1, 4000):
        w = 2.0 * math.pi * n / wave.period
        level = (wave.high - wave.low) * math.sin(math.pi * n * wave.duty) / (math.pi * n)
        force = 2.0 * level * np.exp(1j * (w * t - math.pi * n * wave.duty))
        x += np.real(force / (k - m * w * w + 1j * c * w))
    # the rest of the series falls as n^-3: 1e-11 of its first term
    np.testing.assert_allclose(run.at(t)["x"], x, atol=1e-9 * 0.01)


CAPSULE = {"capsule_mass": 0.8, "inner_mass": 0.2}
MU = 0.2
F1, D, T = 6.0, 0.2, 0.5


def driven(high=F1, duty=D, period=T):
    """Return a capsule whose inner mass a square wave without mean pushes forwards."""
    low = -high * duty / (1.0 - duty)
    wave = Square(high=high, low=low, period=period, duty=duty)
    return Capsule(**CAPSULE, drive=Torque(drive=wave))


def kicked(high, duty, period):
    """Return the travel of a cycle: thrown back by the push, then braked to rest, and held."""
    f, low = MU * 1.0 * G, high * duty / (1.0 - duty)
    thrown, braked = (high - f) / 0.8, (low + f) / 0.8
    assert low < f < high
    assert thrown / braked * duty < 1.0 - duty
    return -0.5 * thrown * (duty * period) ** 2 * (1.0 + thrown / braked)


def test_a_square_wave_carries_a_capsule_as_the_closed_form_says():
    run = simulate(driven(), Coulomb(kinetic_coefficient=MU), t_end=6.0 * T)
    x = run.at(T * np.arange(7))["x"]
    # modes of constant acceleration are exact
    np.testing.assert_allclose(np.diff(x), kicked(F1, D, T), rtol=1e-10)
    assert run.certificate.energy_error < 1e-9
    assert run.status is Status.END_TIME


def test_a_mirrored_square_wave_carries_a_sprung_capsule_the_other_way():
    law = Coulomb(kinetic_coefficient=0.15, static_coefficient=0.2)
    wave = Square(high=4.0, low=-1.5, period=0.31, duty=0.4)
    sprung = Capsule(
        **CAPSULE, stiffness=60.0, damping=0.3, upper_stop=0.1, restitution=0.5,
        drive=Torque(drive=wave),
    )  # fmt: skip
    other = replace(
        sprung, drive=Torque(drive=replace(wave, high=-4.0, low=1.5)), upper_stop=None,
        lower_stop=-0.1,
    )  # fmt: skip
    there, back = (simulate(one, law, t_end=6.0) for one in (sprung, other))
    t = np.linspace(0.0, 6.0, 300)
    np.testing.assert_allclose(there.at(t)["x"], -back.at(t)["x"], atol=1e-12)
    assert abs(there["x"][-1]) > 0.01
    assert any("stop" in event.reason for event in there.events)
    assert there.certificate.certified


def test_levels_that_are_exchanged_half_a_cycle_later_carry_the_capsule_the_other_way():
    law = Coulomb(kinetic_coefficient=0.15)
    wave = Square(high=3.0, low=-3.0, period=0.4, duty=0.5)
    capsule = Capsule(**CAPSULE, stiffness=60.0, damping=1.0, drive=Torque(drive=wave))
    run = simulate(capsule, law, t_end=40.0)
    late = run.at([36.0, 36.2, 40.0])["x"]
    # a wave that is its own mirror image half a cycle later has no direction to carry in
    assert late[2] == pytest.approx(late[0], abs=1e-9)
    assert abs(late[1] - late[0]) > 1e-4


@pytest.mark.parametrize("tier", ["python", pytest.param("compiled", marks=pytest.mark.slow)])
def test_travel_has_the_slopes_of_differences_by_every_number_of_the_wave(tier):
    wave = Square(high=F1, low=-1.5, period=T, duty=D, start=0.05)
    capsule = Capsule(**CAPSULE, drive=Torque(drive=wave))
    law = Coulomb(kinetic_coefficient=MU)
    run = simulate(capsule, law, t_end=1.7, solver=EventDriven(tier=tier))
    h = 1e-6
    for path in ("high", "low", "period", "duty", "start"):
        name = f"mechanism.drive.drive.{path}"
        ends = []
        for step in (h, -h):
            varied = replace(wave, **{path: getattr(wave, path) + step})
            other = simulate(replace(capsule, drive=Torque(drive=varied)), law, t_end=1.7)
            ends.append(float(other["x"][-1]))
        known = (ends[0] - ends[1]) / (2.0 * h)
        found = run.at(1.7).sensitivity("x", name)[0]
        # central differences: rounding of 1e-16 / h, and h^2 of the third derivative
        assert found == pytest.approx(known, rel=1e-6, abs=1e-8), path


def test_the_slope_by_duty_is_that_of_the_closed_form():
    wave = driven().drive.drive
    run = simulate(driven(), Coulomb(kinetic_coefficient=MU), t_end=T)
    h = 1e-5
    # the closed form's low level follows the duty: low = -high D / (1 - D)
    known = (kicked(F1, D + h, T) - kicked(F1, D - h, T)) / (2.0 * h)
    found = run.at(T)
    duty = found.sensitivity("x", "mechanism.drive.drive.duty")[0]
    low = found.sensitivity("x", "mechanism.drive.drive.low")[0]
    assert duty + low * -wave.high / (1.0 - D) ** 2 == pytest.approx(known, rel=1e-8)
    period = found.sensitivity("x", "mechanism.drive.drive.period")[0]
    assert period == pytest.approx(2.0 * kicked(F1, D, T) / T, rel=1e-10)


def test_runs_of_an_ensemble_have_their_own_periods_and_duties():
    periods, duties = np.array([0.3, 0.5, 0.9, 0.5]), np.array([0.2, 0.3, 0.1, 0.0])
    wave = Square(high=F1, low=-1.0, period=T, duty=D)
    capsule = Capsule(**CAPSULE, drive=Torque(drive=wave))
    law = Coulomb(kinetic_coefficient=MU)
    paths = {"mechanism.drive.drive.period": periods, "mechanism.drive.drive.duty": duties}
    found = ensemble(capsule, law, paths, t_end=2.0, solver=PLAIN)
    for row, (period, duty) in enumerate(zip(periods, duties, strict=True)):
        own = Torque(drive=replace(wave, period=float(period), duty=float(duty)))
        run = simulate(replace(capsule, drive=own), law, t_end=2.0)
        assert found["x"][row] == pytest.approx(run["x"][-1], rel=1e-12, abs=1e-15)


def test_a_block_that_the_next_cycle_would_move_is_not_at_rest_at_the_end():
    push = Square(high=5.0, period=1.0, duty=0.2)
    block = SpringBlock(mass=1.0, drive=push)
    law = Coulomb(kinetic_coefficient=0.3)
    assert simulate(block, law, t_end=2.9).status is Status.END_TIME
    weak = replace(block, drive=replace(push, high=2.9))
    assert simulate(weak, law, t_end=2.9).status is Status.AT_REST
