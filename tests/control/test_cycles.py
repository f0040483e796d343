"""What friction makes of feedback: hunting, limit cycles, and where they are found."""

import itertools

import numpy as np
import pytest

from stickslip import Axis, Coulomb, TowedBlock, Viscous, simulate
from stickslip.errors import InputError, UnknownNameError
from stickslip.mechanisms.drives import Sampled
from stickslip.study.control import PID, closed_loop, compensation, limit_cycle

F_K, F_S = 1.0, 1.5
PLAIN = Coulomb(kinetic_coefficient=F_K)
STICTION = Coulomb(kinetic_coefficient=F_K, static_coefficient=F_S)


def hunting(law, t_end=40.0, period=5e-3):
    pid = PID(proportional=100.0, integral=300.0, derivative=20.0, reference=0.1)
    return closed_loop(Axis(inertia=1.0), law, pid, period=period, t_end=t_end), pid


def test_the_integrator_needs_its_time_to_break_away():
    loop, pid = hunting(STICTION)
    events = loop.run.events
    pairs = [
        (stop, leave)
        for stop, leave in itertools.pairwise(events)
        if (stop.reason, leave.reason) == ("stop", "break-away")
    ]
    assert len(pairs) >= 5
    for stop, leave in pairs:
        first = int(np.searchsorted(loop.t, stop.t))
        error = 0.1 - float(loop.run.at(stop.t)["x"][0])
        growth = pid.integral * error * loop.period
        # u = K_p e + I grows by K_i e T a sample, from what it is at the first one at rest
        samples = int(np.floor((np.sign(error) * F_S - loop.commands[first]) / growth)) + 1
        assert leave.t == loop.t[first + samples]
        # and so the wait is (F_s + u) / (K_i e), as for a continuous integrator, but for a sample
        wait = (F_S - np.sign(error) * loop.commands[first]) / (pid.integral * abs(error))
        assert abs(leave.t - stop.t - wait) <= 2.0 * loop.period


def test_integral_action_hunts_where_stiction_exceeds_sliding_friction():
    loop, _ = hunting(STICTION, t_end=80.0)
    cycle = limit_cycle(loop, least=1e-5)
    assert cycle.is_limit_cycle
    assert cycle.stuck > 0.8
    assert cycle.centre == pytest.approx(0.1, abs=1e-5)
    assert 1e-3 < cycle.amplitude < 1e-2


def test_integral_action_without_stiction_comes_to_rest_on_its_target():
    loop, _ = hunting(PLAIN, t_end=60.0)
    cycle = limit_cycle(loop, least=1e-5)
    assert not cycle.is_limit_cycle
    assert abs(loop.run["x"][-1] - 0.1) < 1e-3


MASS, K_P, K_D, START = 1.0, 100.0, 1.0, 0.1
OMEGA = np.sqrt(K_P / MASS)
ZETA = K_D / (2.0 * MASS * OMEGA)


def compensated(factor, t_end=20.0):
    pid = PID(
        proportional=K_P, derivative=K_D, feedforward=compensation(PLAIN, width=1e-3, factor=factor)
    )
    return closed_loop(
        Axis(inertia=MASS), PLAIN, pid, period=5e-4, t_end=t_end, y0={"x": START}
    )  # fmt: skip


def test_over_compensation_is_a_limit_cycle_of_known_size():
    factor = 1.3
    cycle = limit_cycle(compensated(factor))
    # half a swing from A ends at d + r (A + d): the surplus shifts the centre by d = dF / K_p
    shift = (factor - 1.0) * F_K / K_P
    decay = np.exp(-np.pi * ZETA / np.sqrt(1.0 - ZETA**2))
    amplitude = shift * (1.0 + decay) / (1.0 - decay)
    period = 2.0 * np.pi / (OMEGA * np.sqrt(1.0 - ZETA**2))
    assert cycle.is_limit_cycle
    # a hold of T delays by T/2, which takes K_p T/2 = 0.025 off the damping of 1, and the
    # compensation fades in 1e-3 m/s around each turn
    assert cycle.amplitude == pytest.approx(amplitude, rel=0.04)
    assert cycle.amplitude > amplitude
    assert cycle.period == pytest.approx(period, rel=1e-3)
    assert cycle.stuck == 0.0


@pytest.mark.parametrize("factor", [0.8, pytest.param(1.0, marks=pytest.mark.slow)])
def test_exact_and_under_compensation_settle_where_friction_holds(factor):
    loop = compensated(factor)
    assert limit_cycle(loop, least=1e-9).kind == "none"
    end = float(loop.run["x"][-1])
    assert loop.run.stick_spans()[-1][1] == loop.run.span[1]
    assert K_P * abs(end) <= F_S


def test_exact_compensation_swings_like_an_axis_without_friction():
    loop = compensated(1.0, t_end=2.0)
    free = closed_loop(
        Axis(inertia=MASS), Viscous(viscous_coefficient=0.0),
        PID(proportional=K_P, derivative=K_D), period=5e-4, t_end=2.0, y0={"x": START},
    )  # fmt: skip
    # each start from rest and each turn takes the force of friction for a sample or two
    np.testing.assert_allclose(
        loop.run.at(loop.t)["x"], free.run.at(loop.t)["x"], rtol=0, atol=0.01 * START
    )


def test_stick_slip_of_a_towed_block_has_its_closed_form():
    m, k, v = 1.0, 2.0, 0.1
    block = TowedBlock(mass=m, stiffness=k, speed=v, load=1.0)
    cycle = limit_cycle(simulate(block, STICTION, t_end=100.0), "v", since=20.0)
    d, w = (F_S - F_K) / k, np.sqrt(k / m)
    stick, slip = 2.0 * d / v, 2.0 / w * (np.pi - np.arctan(w * d / v))
    # crossings lie between samples 4 ms apart, and are found on the line between them
    assert cycle.period == pytest.approx(stick + slip, rel=1e-5)
    assert cycle.stuck == pytest.approx(stick / (stick + slip), rel=1e-5)
    assert 2.0 * cycle.amplitude == pytest.approx(v + np.hypot(v, w * d), rel=1e-5)


@pytest.mark.parametrize(("damping", "kind"), [(0.05, "decaying"), (0.0, "limit cycle")])
def test_a_free_oscillator_decays_or_does_not(damping, kind):
    axis = Axis(inertia=1.0, stiffness=40.0, damping=damping)
    run = simulate(axis, Viscous(viscous_coefficient=0.0), t_end=20.0, y0={"x": 0.1})
    assert limit_cycle(run).kind == kind


def test_growing_and_irregular_motions_are_told_apart():
    law = Viscous(viscous_coefficient=0.0)
    swing = closed_loop(
        Axis(inertia=1.0, stiffness=40.0), law, lambda t, seen: 0.3 * seen["v"], period=1e-3,
        t_end=20.0, y0={"x": 1e-3},
    )  # fmt: skip
    assert limit_cycle(swing).kind == "growing"
    rng = np.random.default_rng(1)
    times = tuple(0.3 * k for k in range(100))
    noisy = Axis(
        inertia=1.0, damping=1.0, stiffness=9.0,
        drive=Sampled(times=times, values=tuple(rng.normal(size=100))),
    )  # fmt: skip
    assert limit_cycle(simulate(noisy, law, t_end=30.0)).kind == "irregular"


def test_what_cannot_be_looked_at_is_refused():
    run = simulate(Axis(inertia=1.0), PLAIN, t_end=1.0)
    with pytest.raises(UnknownNameError):
        limit_cycle(run, "y")
    with pytest.raises(InputError, match="since must lie between 0 and 1 s, got 2"):
        limit_cycle(run, since=2.0)
