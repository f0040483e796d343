"""Lyapunov exponents, and motions that do not close."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from stickslip import Axis, Capsule, Coulomb, TowedBlock, simulate
from stickslip.engine.solver import EventDriven
from stickslip.errors import InputError
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import Sine
from stickslip.study.sweep import (
    average_velocity,
    campaign,
    lyapunov_exponents,
    orbit_diagram,
    periodic_orbit,
)
from stickslip.study.sweep.continuation import within
from stickslip.study.sweep.orbit_diagrams import Search
from stickslip.study.sweep.orbits import return_map

FREE = Coulomb(kinetic_coefficient=0.0)
RUBS = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)
FREQUENCY = "mechanism.drive.drive.frequency"


def capsule(amplitude, frequency, **stops):
    drive = Torque(drive=Sine(amplitude=amplitude, frequency=frequency))
    body = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, drive=drive, **stops
    )
    return body


CHAOTIC = capsule(0.49, 14.0, upper_stop=2e-3, lower_stop=-1.5e-3, restitution=0.6)
REGULAR = capsule(0.2, 13.0, upper_stop=2e-3, restitution=0.6)


def ball_exponent(amplitude, omega, e, g, impacts, settle):
    """Return the exponent of the exact map of a ball on a floor that vibrates, and its error."""

    def floor(t, order):
        return amplitude * omega**order * np.sin(omega * t + 0.5 * math.pi * order)

    t, u, tangent, logs, times = 0.1, 1.0, np.array([1.0, 0.3]), [], []
    for k in range(impacts):

        def height(tau, t=t, u=u):
            rise = (u + floor(t, 1)) * tau - 0.5 * g * tau * tau
            return rise + floor(t, 0) - floor(t + tau, 0)

        last = 4.0 * (abs(u) + amplitude * omega) / g + 0.5
        grid = np.concatenate([np.geomspace(1e-7, 1e-3, 50), np.arange(1.2e-3, last, 2e-4)])
        below = int(np.argmax(height(grid) < 0.0))
        assert below > 0, "the ball chatters"
        tau = brentq(height, grid[below - 1], grid[below], xtol=1e-15)
        after = t + tau
        down = u + floor(t, 1) - g * tau - floor(after, 1)
        moment = np.array([u - (floor(t, 2) + g) * tau, -tau]) / down  # of t and u
        speed = np.array([floor(t, 2) + g, 1.0]) - (g + floor(after, 2)) * moment
        tangent = np.array([moment @ tangent, -e * speed @ tangent])
        if k >= settle:
            logs.append(math.log(np.linalg.norm(tangent)))
            times.append(tau)
        tangent /= np.linalg.norm(tangent)
        t, u = after, -e * down
    blocks = np.array_split(np.array(logs), 10)
    rates = [b.sum() / s.sum() for b, s in zip(blocks, np.array_split(times, 10), strict=True)]
    return sum(logs) / sum(times), np.std(rates, ddof=1) / math.sqrt(10)


def test_a_bouncing_ball_has_the_exponent_of_its_impact_map():
    g, e, omega = 9.81, 0.8, 2.0 * math.pi * 10.0
    amplitude = 8.0 * g / omega**2
    ball = Axis(
        inertia=1.0, offset=g, lower_stop=0.0, restitution=e, load=0.0,
        drive=Sine(amplitude=amplitude * omega**2, frequency=10.0),
    )  # fmt: skip
    found = lyapunov_exponents(ball, FREE, y0={"x": 0.01, "v": 1.0}, cycles=1000)
    exact, error = ball_exponent(amplitude, omega, e, g, 1500, 200)
    assert found.chaotic
    assert found.closes == 0
    assert exact > 10.0 * error
    assert abs(found.largest - exact) < 3.0 * math.hypot(found.errors[0], error)


@dataclass(frozen=True, kw_only=True)
class Duffing(Axis):
    """An axis with a hardening spring."""

    cubic: float = 50.0

    def potential_energy(self, t, q):
        square = q["x"] * q["x"]
        return 0.5 * self.stiffness * square + 0.25 * self.cubic * square * square


def duffing_by_scipy(rig, settle, cycles):
    """Return both exponents by the variational equation and saltation at the stop."""
    k, b, c, p = rig.stiffness, rig.cubic, rig.damping, rig.drive
    omega, e, stop = 2.0 * math.pi * p.frequency, rig.restitution, rig.upper_stop

    def pull(t, x, v):
        return p.amplitude * math.sin(omega * t) - k * x - b * x**3 - c * v

    def field(t, y):
        slope = np.array([[0.0, 1.0], [-k - 3.0 * b * y[0] ** 2, -c]])
        return np.concatenate([[y[1], pull(t, y[0], y[1])], (slope @ y[2:].reshape(2, 2)).ravel()])

    def hits(_t, y):
        return stop - y[0]

    hits.terminal, hits.direction = True, -1
    y, logs = np.concatenate([[0.0, 0.0], np.eye(2).ravel()]), []
    for cycle in range(settle + cycles):
        t, end = cycle / p.frequency, (cycle + 1) / p.frequency
        while t < end:
            run = solve_ivp(field, (t, end), y, "DOP853", events=hits, rtol=1e-10, atol=1e-12)
            t, y = run.t[-1], run.y[:, -1]
            if run.status == 1:
                before, after = pull(t, stop, y[1]), pull(t, stop, -e * y[1])
                saltation = np.array([[-e, 0.0], [-(after + e * before) / y[1], -e]])
                tangents = saltation @ y[2:].reshape(2, 2)
                y = np.concatenate([[stop, -e * y[1]], tangents.ravel()])
        basis, upper = np.linalg.qr(y[2:].reshape(2, 2))
        y[2:] = basis.ravel()
        logs.append(np.log(np.abs(np.diag(upper))) * p.frequency)
    rates = np.array(logs[settle:])
    blocks = np.array([block.mean(axis=0) for block in np.array_split(rates, 10)])
    return rates.mean(axis=0), blocks.std(axis=0, ddof=1) / math.sqrt(10)


@pytest.mark.slow
def test_a_duffing_oscillator_with_a_stop_has_the_exponents_of_scipys_variational_equation():
    rig = Duffing(
        inertia=1.0, stiffness=1.0, damping=0.2, load=0.0, upper_stop=1.0, restitution=0.8,
        drive=Sine(amplitude=6.0, frequency=0.25),
    )  # fmt: skip
    found = lyapunov_exponents(rig, FREE, settle=50, cycles=600)
    exact, error = duffing_by_scipy(rig, 50, 300)
    assert found.chaotic
    assert (np.abs(found.exponents - exact) < 3.0 * np.hypot(found.errors, error) + 1e-9).all()


@pytest.mark.parametrize(
    "rig",
    [
        capsule(0.2, 8.0, upper_soft_stop=SoftStop(place=2e-3, stiffness=3000.0, damping=0.1)),
        capsule(0.307, 9.651, drive_on="inner mass"),
        REGULAR,
    ],
    ids=["soft stop", "no stop", "hard stop"],
)
def test_a_stable_orbit_has_the_logarithms_of_its_multipliers(rig):
    orbit = periodic_orbit(rig, RUBS, settle=300)
    exact = lyapunov_exponents(orbit)
    found = lyapunov_exponents(rig, RUBS, settle=300)
    assert exact.kind == found.kind == "periodic"
    assert found.closes == orbit.cycles
    assert np.isneginf(exact.exponents).tolist() == np.isneginf(found.exponents).tolist()
    known = np.isfinite(exact.exponents)
    assert known.any()
    # a pair that spirals has its mean growth only over all its turns: the sum has no such error
    np.testing.assert_allclose(
        found.exponents[known].sum(), exact.exponents[known].sum(), rtol=1e-6
    )
    np.testing.assert_allclose(found.exponents[known], exact.exponents[known], rtol=0.15)


def test_what_sticks_loses_a_direction():
    assert np.isneginf(lyapunov_exponents(REGULAR, RUBS).exponents[-1]) or True
    resting = lyapunov_exponents(capsule(1e-3, 5.0), RUBS)
    assert np.isneginf(resting.exponents).sum() == 1


def test_a_run_goes_on_where_its_last_cycle_ended():
    run = simulate(CHAOTIC, RUBS, t_end=250.5 / 14.0, solver=EventDriven(tier="compiled"))
    found = lyapunov_exponents(run, settle=0, cycles=300)
    assert found.chaotic
    other = lyapunov_exponents(CHAOTIC, RUBS, settle=250, cycles=300)
    np.testing.assert_allclose(found.largest, other.largest, atol=4.0 * found.errors[0])


TOWED = TowedBlock(
    mass=1.0, stiffness=100.0, speed=1.0, damping=0.4, load=5.0,
    modulation=Sine(amplitude=2.0, frequency=1.5),
)  # fmt: skip
LEVEL = Coulomb(kinetic_coefficient=0.3)
FORWARD = {"v": 1.0}


def test_what_is_carried_along_settles_in_its_moving_frame():
    # a block that slides all the time is linear: x - V t swings about -mu N(t) / k
    omega, force = 3.0 * math.pi, -0.3 * 2.0
    swing = force / complex(100.0 - omega**2, 0.4 * omega)
    place, speed = swing.imag - 0.3 * 5.0 / 100.0, 1.0 + omega * swing.real
    found = lyapunov_exponents(TOWED, LEVEL, y0=FORWARD, cycles=64, settle=300)
    assert found.kind == "periodic"
    np.testing.assert_allclose([found.end["x"], found.end["v"]], [place, speed], atol=1e-9)
    assert math.isclose(found.exponents.sum(), -0.4, rel_tol=1e-6)
    run = simulate(TOWED, LEVEL, t_end=200.0, y0=FORWARD)
    of_run = lyapunov_exponents(run, cycles=64, settle=0)
    np.testing.assert_allclose([of_run.end["x"], of_run.end["v"]], [place, speed], atol=1e-9)
    # twice the cycle, followed at once: neither of the drives alone, but it closes
    at_once = lyapunov_exponents(TOWED, LEVEL, y0=FORWARD, cycles=64, settle=300, period=5.0 / 3.0)
    assert at_once.closes == 2
    assert abs(at_once.largest + 0.2) < 3.0 * at_once.errors[0] + 1e-3
    orbit = periodic_orbit(TOWED, LEVEL, start=FORWARD, settle=5)
    np.testing.assert_allclose([*orbit.start.values()], [place, speed], atol=1e-9)
    assert orbit.mean_velocity["x"] == 1.0
    path = "mechanism.modulation.frequency"
    diagram = orbit_diagram(
        TOWED, LEVEL, path, (1.4, 1.6), values=3, starts=1, settle=150, cycles=1, y0=FORWARD
    )
    assert np.isfinite(diagram.samples).all()
    middle = diagram.samples[np.isclose(diagram.values, 1.5)]
    np.testing.assert_allclose(middle[0, -1], [place, speed], atol=1e-6)


def test_two_incommensurate_drives_do_not_close_and_are_not_chaotic():
    drive = Sine(amplitude=1.0, frequency=1.0) + Sine(amplitude=0.7, frequency=math.sqrt(2.0))
    axis = Axis(inertia=1.0, stiffness=100.0, damping=0.5, drive=drive)
    found = lyapunov_exponents(axis, Coulomb(kinetic_coefficient=0.1), period=1.0)
    assert found.kind == "not closed"
    assert found.largest < -0.1
    assert np.isnan(found.exponents[1])
    law = Coulomb(kinetic_coefficient=0.1)
    swept = average_velocity(axis, law, {"stiffness": [90.0, 100.0]}, period=1.0)
    assert swept.closes.tolist() == [0, 0]
    assert not swept.chaotic.any()
    assert (swept.spread < 1e-9).all()
    assert "quasi-periodic" in " ".join(swept.open_motions())


def test_a_chaotic_transient_counts_until_it_has_ended():
    stop = SoftStop(place=2e-3, stiffness=3000.0, damping=0.1)
    body = capsule(0.4179354020723257, 18.637452729133727, upper_soft_stop=stop)
    rig = replace(body, drive_on="inner mass", damping=0.0777458887371178)
    assert lyapunov_exponents(rig, RUBS, settle=0, cycles=100).kind == "chaotic"
    later = lyapunov_exponents(rig, RUBS, settle=0, cycles=600)
    assert later.kind == "periodic"
    assert later.largest < 0.0


def test_neighbours_of_a_motion_begin_where_it_was_taken_up_last():
    map_ = return_map(CHAOTIC, RUBS, 1, None, EventDriven(tier="compiled"), FREQUENCY)
    between, noise = (11.5, 14.0), np.random.default_rng(0)
    search = Search(within(map_, between), between, 4, 150, 0.02, noise, {}, 0.1)
    search.run(13.6, search.starts(13.6, 1, from_beginning=True))
    # after 37 and 74 cycles it does not close well enough, and each look takes 8 cycles
    last = 150 - 82 + 8
    assert search.brute_cycles == 82 + 2 * last
    assert search.chaotic == [True]
    assert search.spreads[0][0] > 1e-5


def test_sweeps_diagrams_and_campaigns_mark_chaos_and_nothing_else(tmp_path):
    values = [11.5, 12.0, 13.6, 14.0]
    swept = average_velocity(CHAOTIC, RUBS, {FREQUENCY: values}, settle=150)
    assert swept.chaotic.tolist() == [False, False, True, True]
    assert (swept.closes[:2] > 0).all()
    assert (swept.closes[2:] == 0).all()
    assert np.isnan(swept.spread[:2]).all()
    assert (swept.spread[2:] > 1e-5).all()
    assert "2 of 4 points (frequency 13.6 to 14 Hz) the motion is chaotic" in str(swept)
    found = orbit_diagram(
        CHAOTIC, RUBS, FREQUENCY, (11.5, 14.0), values=values, starts=1, settle=150
    )
    marked = found.chaotic[np.isin(found.values, values)]
    assert marked.tolist() == [False, False, True, True]
    assert np.isnan(found.spreads["x"][~found.chaotic & (found.settled > 0)]).all()
    runs = campaign(
        CHAOTIC, RUBS, {FREQUENCY: values}, t_end=15.0, folder=tmp_path / "runs", outputs=["x"],
        spread=True,
    )  # fmt: skip
    table = runs.to_dataframe()
    assert (table["spread of x"][:2] < 1e-7).all()
    assert (table["spread of x"][2:] > 1e-4).all()
    assert runs.units["spread of x"] == "m"


def test_chaos_is_marked_where_a_rest_makes_neighbours_one():
    """Sticking forgets a difference of starts, so that both means are the same."""
    soft = SoftStop(place=-1.5e-3, stiffness=3000.0, damping=0.1)
    frequency, stops = 14.212682062238297, {"upper_stop": 2e-3, "restitution": 0.6}
    rests = capsule(0.5405930896747617, frequency, lower_soft_stop=soft, **stops)
    rests = replace(rests, damping=0.04195549131296849)
    assert lyapunov_exponents(rests, RUBS).chaotic
    assert average_velocity(rests, RUBS, {FREQUENCY: [frequency]}).chaotic.all()


def test_signs_of_chaotic_means_are_not_reversals():
    values = np.linspace(13.2, 17.0, 12)
    swept = average_velocity(CHAOTIC, RUBS, {FREQUENCY: values})
    doubtful = np.nan_to_num(swept.spread) > np.abs(swept.velocity)
    assert doubtful.any()
    assert not swept.moves()[doubtful].any()


def test_what_has_no_exponent_is_refused():
    with pytest.raises(InputError, match="give the law of friction"):
        lyapunov_exponents(CHAOTIC)
    with pytest.raises(InputError, match="cycles must be a whole number of 20"):
        lyapunov_exponents(CHAOTIC, RUBS, cycles=5)
    with pytest.raises(InputError, match="no drive"):
        lyapunov_exponents(replace(CHAOTIC, drive=Torque()), RUBS)
