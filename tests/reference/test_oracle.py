"""Runs against SciPy, with the modes and events written by hand."""

import math

import numpy as np
from scipy.integrate import solve_ivp

from stickslip import LuGre, SpringBlock, Stribeck, TowedBlock, simulate
from stickslip.mechanisms.drives import Pulse

M, K, SPEED, F_K, F_S, V_S, S2 = 1.0, 2.0, 0.1, 1.0, 1.5, 0.02, 0.4


def towed_by_hand(t_end):
    """Return times of break-away and stop, and the last state."""

    def slipping(t, y):
        x, v = y
        friction = F_K + (F_S - F_K) * math.exp(-((v / V_S) ** 2)) + S2 * v
        return [v, (K * (SPEED * t - x) - friction) / M]

    def stopped(t, y):
        return y[1]

    stopped.terminal, stopped.direction = True, -1
    t, x, starts, stops = 0.0, 0.0, [], []
    while True:
        t = x / SPEED + F_S / (K * SPEED)
        if t > t_end:
            return starts, stops, x
        starts.append(t)
        # the start is where force and level balance; a step in time leaves it by its own slope
        h = 1e-4
        v = K * SPEED * h**2 / (2 * M)
        run = solve_ivp(
            slipping, (t + h, t_end), [x + v * h / 3, v],
            method="DOP853", rtol=1e-12, atol=1e-15, events=stopped, max_step=0.01,
        )  # fmt: skip
        x = run.y[0, -1]
        if run.status == 0:
            return starts, stops, x
        stops.append(run.t_events[0][0])


def test_three_cycles_of_a_stribeck_towed_block_agree_with_scipy():
    law = Stribeck(
        kinetic_coefficient=F_K, static_coefficient=F_S, stribeck_velocity=V_S,
        viscous_coefficient=S2,
    )  # fmt: skip
    run = simulate(TowedBlock(mass=M, stiffness=K, speed=SPEED, load=1.0), law, t_end=27.0)
    starts, stops, x = towed_by_hand(27.0)
    assert len(stops) == 3
    found = {
        reason: [event.t for event in run.events if event.reason == reason]
        for reason in ("break-away", "stop")
    }
    # the oracle starts 1e-4 s late on a series whose next term is h^3 of the growth there: 1e-8
    np.testing.assert_allclose(found["break-away"], starts, rtol=1e-7)
    np.testing.assert_allclose(found["stop"], stops, rtol=1e-7)
    assert math.isclose(run["x"][-1], x, rel_tol=1e-7)


def test_a_pushed_lugre_block_agrees_with_scipy():
    law = LuGre(
        kinetic_coefficient=0.25,
        static_coefficient=0.35,
        stribeck_velocity=0.01,
        bristle_stiffness=1e3,
        bristle_damping=5.0,
        viscous_coefficient=0.4,
    )
    run = simulate(SpringBlock(mass=1.0, drive=Pulse(level=10.0, duration=0.1)), law, t_end=1.0)

    def rates(push, y):
        _, v, z = y
        g = 0.25 + 0.1 * math.exp(-((v / 0.01) ** 2))
        z_dot = v - 1e3 * abs(v) * z / g
        return [v, push - 9.81 * (1e3 * z + 5.0 * z_dot) - 0.4 * v, z_dot]

    y = [0.0, 0.0, 0.0]
    times = np.linspace(0.0, 1.0, 101)
    columns = []
    for push, first, last in ((10.0, 0, 10), (0.0, 10, 100)):
        part = solve_ivp(
            lambda _, y, push=push: rates(push, y), (times[first], times[last]), y,
            method="Radau", rtol=1e-11, atol=1e-14, t_eval=times[first : last + 1],
        )  # fmt: skip
        y = part.y[:, -1]
        columns.append(part.y[:, 0 if first == 0 else 1 :])
    expected = np.hstack(columns)
    fine = run.at(times)
    # a local tolerance of 1e-8 over some hundred steps, against the largest of each state
    for name, column in zip(("x", "v", "z"), expected, strict=True):
        np.testing.assert_allclose(fine[name], column, rtol=0, atol=2e-6 * np.abs(column).max())
