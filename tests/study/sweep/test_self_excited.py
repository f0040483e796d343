"""Cycles that nothing drives in time: belts, pulled blocks, and axes under feedback."""

import math
from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
import pytest
from scipy.optimize import brentq

from stickslip import Axis, BlockChain, Coulomb, LuGre, Stribeck, TowedBlock, simulate
from stickslip.errors import InputError, SimulationError
from stickslip.mechanisms.drives import Feedback, Sampled, Sine
from stickslip.study.sweep import continue_event, continue_orbit, orbit_diagram, periodic_orbit

JERKY = Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5)
FADING = Stribeck(kinetic_coefficient=1.0, static_coefficient=1.5, stribeck_velocity=0.2)
M, K = 1.3, 2.1


def block(speed=0.1, **settings):
    return TowedBlock(**({"mass": M, "stiffness": K, "speed": speed, "load": 1.0} | settings))


def closed_form(speed):
    """Return period, share of sticking and range of the stretch: the slip is half an ellipse."""
    omega, a = math.sqrt(K / M), 0.5 / K  # 0.5 N between the levels
    slip = (math.pi + 2.0 * math.atan2(speed / omega, a)) / omega
    stick = 2.0 * a / speed
    return slip + stick, stick / (slip + stick), 2.0 * math.hypot(a, speed / omega)


@pytest.mark.parametrize("speed", [0.03, 0.1, -0.1, 0.8])
def test_a_block_on_a_belt_sticks_and_slips_as_in_closed_form(speed):
    orbit = periodic_orbit(block(speed), JERKY)
    period, sticking, width = closed_form(abs(speed))
    assert orbit.period == pytest.approx(period, rel=1e-10)
    assert orbit.sticking[""] == pytest.approx(sticking, rel=1e-9)
    times = np.linspace(0.0, orbit.period, 20001)
    stretch = speed * times - orbit.run().at(times)["x"]
    assert np.ptp(stretch) == pytest.approx(width, rel=1e-7)  # between times it is wider still
    assert 0.5 * (stretch.max() + stretch.min()) == pytest.approx(math.copysign(1.0 / K, speed))
    # sticking forgets, and the phase is none of the unknowns
    assert orbit.free == ("x",)
    assert abs(orbit.multipliers).max() < 1e-7
    assert orbit.mean_velocity == {"x": pytest.approx(speed)}


def test_a_branch_over_the_speed_follows_the_closed_form():
    branch = continue_orbit(periodic_orbit(block(), JERKY), "speed", (0.02, 1.0))
    expected = [closed_form(speed)[0] for speed in branch.values]
    np.testing.assert_allclose(branch.periods, expected, rtol=1e-9)
    np.testing.assert_allclose(branch.mean_velocity("x"), branch.values, rtol=1e-12)
    assert branch.states == ("x", "cycle")
    assert branch.units["cycle"] == "s"
    assert branch.values[[0, -1]].tolist() == [0.02, 1.0]
    again = branch.orbit(5)
    assert again.period == pytest.approx(branch.periods[5], rel=1e-9)


def misses(speed, damping):
    """Return by how much the fastest point of the slip phase misses the speed of the belt."""
    decay, omega = 0.5 * damping / M, math.sqrt(K / M - (0.5 * damping / M) ** 2)
    u = (0.5 - damping * speed) / K
    slope = complex((speed + decay * u) / omega, 0.0)
    start = complex(u, -slope.real)  # u(t) = Re(start exp((-decay + i omega) t))
    rate = complex(-decay, omega)
    # the rate of the stretch is largest where its own rate is 0, in the second half of a turn
    angle = (0.5 * math.pi - np.angle(start * rate * rate)) % math.pi
    times = (angle + np.pi * np.arange(4)) / omega
    rates = (start * rate * np.exp(rate * times)).real
    return max(rates[times > 0.5 * math.pi / omega]) - speed


@pytest.mark.parametrize(("path", "between"), [("speed", (0.1, 4.0)), ("damping", (0.01, 1.0))])
def test_a_damper_ends_the_cycle_where_slip_no_longer_reaches_the_belt(path, between):
    settings = {"speed": 0.3, "damping": 0.1}
    branch = continue_orbit(periodic_orbit(block(**settings), JERKY), path, between)
    end = brentq(lambda value: misses(**(settings | {path: value})), 0.05, 3.0)
    assert branch.values.max() == pytest.approx(end, rel=2e-6)
    assert "sticking ends" in branch.ends[1]
    for factor, sticks in ((0.999, True), (1.001, False)):  # by brute force
        run = simulate(block(**(settings | {path: factor * end})), JERKY, t_end=400.0)
        assert any(event.reason == "stop" for event in run.events[-2:] if event.t > 300.0) is sticks


@pytest.mark.parametrize("start", [{"x": -30.0, "v": 5.0}, {"x": 0.1}, {"v": -2.0}])
def test_cycles_are_met_from_far_away(start):
    orbit = periodic_orbit(block(), JERKY, start=start)
    assert orbit.period == pytest.approx(closed_form(0.1)[0], rel=1e-10)


def test_any_section_gives_the_same_cycle():
    first = periodic_orbit(block(), JERKY)
    for section in ({"v": 0.2}, {"x": -0.5}):
        other = periodic_orbit(block(), JERKY, section=section)
        assert other.period == pytest.approx(first.period, rel=1e-10)
        (state,) = section
        assert other.section.state == state
        assert state not in other.free


LUGRE = LuGre(
    kinetic_coefficient=1.0,
    static_coefficient=1.5,
    stribeck_velocity=0.1,
    bristle_stiffness=1e4,
    bristle_damping=100.0,
)


@pytest.mark.parametrize(("law", "exact"), [(FADING, 1e-9), (LUGRE, 1e-5)])
def test_other_laws_have_the_period_of_long_runs(law, exact):
    belt = block(mass=1.0, stiffness=1.0)
    orbit = periodic_orbit(belt, law, settle=5)
    run = simulate(belt, law, t_end=12.0 * orbit.period)
    t = np.linspace(10.0 * orbit.period, 12.0 * orbit.period, 20001)
    stretch = 0.1 * t - run.at(t)["x"]
    np.testing.assert_allclose(stretch[:10001], stretch[10000:], atol=10.0 * exact)
    ends = orbit.run().at(np.array([0.0, orbit.period]))
    assert ends["x"][1] - ends["x"][0] == pytest.approx(0.1 * orbit.period, rel=exact)
    assert ends["v"][1] == pytest.approx(ends["v"][0], rel=exact)
    mirrored = periodic_orbit(block(-0.1, mass=1.0, stiffness=1.0), law, settle=5)
    assert mirrored.period == pytest.approx(orbit.period, rel=exact)


def test_an_unstable_cycle_parts_sliding_from_sticking():
    belt = block(2.0, mass=1.0, stiffness=1.0, damping=0.05)

    def slides(width):
        run = simulate(belt, FADING, t_end=150.0, y0={"x": -1.0 - width, "v": 2.0})
        return not any(event.t > 100.0 for event in run.events)

    low, high = 1.0, 3.0
    for _ in range(30):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if slides(middle) else (low, middle)
    orbit = periodic_orbit(belt, FADING, start={"x": -1.0 - low, "v": 2.0}, settle=0)
    assert not orbit.stable
    assert orbit.events == ()
    assert -1.0 - orbit.start["x"] == pytest.approx(low, abs=1e-7)
    # a start so near it leaves it by its multiplier each turn
    off = 1e-6
    times = orbit.period * np.arange(3.0)
    run = simulate(belt, FADING, t_end=times[-1], y0={"x": orbit.start["x"] + off, "v": 2.0})
    gap = run.at(times)["x"] - 2.0 * times - orbit.start["x"]
    shear = run.at(times)["v"] - 2.0  # it passes the section a little later
    rate = orbit.run().at(np.array([0.0, 1e-6]))
    slope = (np.diff(rate["x"]) - 2e-6) / np.diff(rate["v"])
    grown = gap - shear * slope
    np.testing.assert_allclose(grown[1:] / grown[:-1], orbit.multipliers[0].real, rtol=1e-3)


def test_two_blocks_slip_in_turn_and_come_back():
    chain = BlockChain(blocks=2, mass=1.0, coupling=1.2, stiffness=1.0, speed=0.1, damping=0.1)
    once = periodic_orbit(chain, FADING, start={"x1": 0.3})
    assert not once.stable  # the blocks take turns in every other way
    orbit = periodic_orbit(chain, FADING, start={"x1": 0.3}, cycles=2)
    slips = Counter(event.contact for event in orbit.events if event.reason == "break-away")
    assert slips == {"block-1": 2, "block-2": 2}
    assert orbit.stable
    long = simulate(chain, FADING, t_end=1000.0, y0={"x1": 0.3})
    begins = [e.t for e in long.events if (e.contact, e.reason) == ("block-1", "break-away")]
    assert begins[-1] - begins[-3] == pytest.approx(orbit.period, rel=1e-8)
    names = ("x1", "x2", "v1", "v2")
    begin = [orbit.start[name] for name in names]
    run = simulate(chain, FADING, t_end=3.0 * orbit.period, y0=dict(zip(names, begin, strict=True)))
    for turn in (1.0, 2.0, 3.0):
        found = run.at(np.array([turn * orbit.period]))
        moved = -0.1 * turn * orbit.period
        expected = [begin[0] + moved, begin[1] + moved, *begin[2:]]
        np.testing.assert_allclose([found[n][0] for n in names], expected, atol=1e-8)
    branch = continue_orbit(orbit, "coupling", (1.1, 1.25))
    near = periodic_orbit(replace(chain, coupling=1.25), FADING, start={"x1": 0.3}, cycles=2)
    (end,) = branch.orbits_at(1.25)[-1:]
    assert end.period == pytest.approx(near.period, rel=1e-8)


def test_a_damper_of_the_wrong_sign_has_the_unstable_cycle_of_half_swings():
    # A half-swing makes (A - d) exp(sigma) - d of an amplitude A; d is friction over stiffness
    mass, stiffness, negative, level = 0.7, 50.0, 0.4, 0.2
    decay = 0.5 * negative / mass
    omega = math.sqrt(stiffness / mass - decay**2)
    growth = math.exp(math.pi * decay / omega)
    amplitude = level / stiffness * (growth + 1.0) / (growth - 1.0)
    axis = Axis(inertia=mass, stiffness=stiffness, drive=Feedback(state="v", gain=-negative))
    law = Coulomb(kinetic_coefficient=level)
    orbit = periodic_orbit(axis, law, start={"x": 1.01 * amplitude}, settle=0, section={"x": 0.0})
    assert orbit.period == pytest.approx(2.0 * math.pi / omega, rel=1e-10)
    times = np.linspace(0.0, orbit.period, 200001)
    assert orbit.run().at(times)["x"].max() == pytest.approx(amplitude, rel=1e-9)
    assert orbit.multipliers.real.tolist() == pytest.approx([growth**2], rel=1e-9)
    branch = continue_orbit(orbit, "gain", (-1.0, -0.2))
    assert not branch.stable.any()


FALLING = Stribeck(
    kinetic_coefficient=0.8, static_coefficient=1.2, stribeck_velocity=0.4,
    viscous_coefficient=0.05,
)  # fmt: skip
VISCOUS = "friction.viscous_coefficient"


def hopf_of(speed):
    """Return the viscous coefficient at which friction does not fall any more at a speed."""
    ratio = speed / 0.4
    return 2.0 * 0.4 * ratio / 0.4 * math.exp(-(ratio**2))


def branch_over_viscous(speed):
    belt = TowedBlock(mass=1.0, stiffness=1.0, speed=speed, load=1.0)
    return continue_orbit(periodic_orbit(belt, FALLING), VISCOUS, (0.01, 1.0))


def test_a_branch_ends_where_its_cycle_shrinks_to_steady_sliding():
    branch = branch_over_viscous(0.5)
    assert [event.kind for event in branch.events] == ["sticking", "fold"]
    assert "shrinks to steady sliding" in branch.ends[1]
    # The parameter differs as the square of what is left of the cycle, 2 %: here by a tenth of it.
    assert branch.values[-1] == pytest.approx(hopf_of(0.5), rel=1e-4)


@pytest.mark.slow
def test_folds_of_cycles_end_where_the_square_of_the_cycle_tells_no_side():
    sticking, fold = branch_over_viscous(0.5).events
    paths, box = ("mechanism.speed", VISCOUS), ((0.2, 2.0), (0.01, 1.0))
    folds = continue_event(fold, paths, box)
    assert folds.states == ("x", "cycle")
    # At the degenerate Hopf point the third derivative of friction is 0.
    degenerate = 0.4 * math.sqrt(1.5)
    assert folds.values[-1] == pytest.approx([degenerate, hopf_of(degenerate)], rel=1e-3)
    assert "shrinks to steady sliding" in folds.ends[1]
    borders = continue_event(sticking, paths, box)
    assert borders.values[:, 0].min() == pytest.approx(0.2)
    assert borders.values[:, 0].max() == pytest.approx(2.0)
    (met,), (also,) = folds.points, borders.points
    assert (met.kind, also.kind) == ("fold with sticking", "sticking with fold")
    assert met.values == pytest.approx(also.values, abs=1e-6)
    for curve, kind in ((folds, "fold"), (borders, "sticking")):
        # nearer to where they meet the fold is too near the border for a branch to reach it
        for speed, viscous in curve.values[curve.values[:, 0] < 0.8][5:40:10]:
            near = [e.value for e in branch_over_viscous(speed).events if e.kind == kind]
            assert min(abs(value - viscous) for value in near) < 1e-6


def test_the_diagram_of_a_belt_ends_with_its_cycle():
    belt = block(0.3, damping=0.1)
    diagram = orbit_diagram(belt, JERKY, "speed", (0.1, 1.2), values=6, starts=2, settle=10)
    (branch,) = diagram.branches
    end = brentq(lambda speed: misses(speed, 0.1), 0.3, 3.0)
    assert branch.values.max() == pytest.approx(end, rel=1e-4)
    assert not (diagram.settled[diagram.values > end] > 0).any()
    assert (diagram.settled[diagram.values < end] == 1).all()
    assert diagram.states == ("x", "cycle")
    assert not diagram.chaotic.any()


def test_blocks_whose_neighbours_leave_are_chaotic_and_those_that_close_are_not():
    chain = BlockChain(blocks=3, mass=1.0, coupling=2.0, stiffness=1.0, speed=0.1)
    runs = [
        simulate(chain, FADING, t_end=400.0, y0={"x1": x, "x2": 0.1}) for x in (0.3, 0.3 + 1e-9)
    ]
    here, there = ([run.at([400.0])[name][0] for name in ("x1", "x2", "x3")] for run in runs)
    assert np.abs(np.subtract(here, there)).max() > 0.1  # a hundred million times as far apart
    settings = {"values": 2, "starts": 1, "settle": 60, "y0": {"x1": 0.3, "x2": 0.1}}
    diagram = orbit_diagram(chain, FADING, "coupling", (2.0, 2.1), cycles=1, **settings)
    assert diagram.chaotic.all()
    pair = BlockChain(blocks=2, mass=1.0, coupling=1.2, stiffness=1.0, speed=0.1, damping=0.1)
    settings["y0"] = {"x1": 0.3}
    diagram = orbit_diagram(pair, FADING, "coupling", (1.2, 1.25), cycles=1, **settings)
    assert not diagram.chaotic.any()  # cycles of two passes do not close after one


@dataclass(frozen=True, kw_only=True)
class Untold(TowedBlock):
    """A pulled block that does not tell that it is carried along."""

    name = "untold-block"

    def carried(self):
        return {}


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda: periodic_orbit(Axis(inertia=1.0), JERKY), SimulationError, "there is no cycle"),
        (
            lambda: periodic_orbit(
                Axis(inertia=1.0, drive=Sampled(times=(0.0,), values=(2.0,))), JERKY
            ),
            SimulationError,
            "there is no cycle",
        ),
        (
            lambda: periodic_orbit(block(0.9, damping=0.5), JERKY),
            SimulationError,
            "becomes steady sliding",
        ),
        (
            lambda: periodic_orbit(block(), JERKY, section={"w": 0.0}),
            InputError,
            "unknown state 'w'",
        ),
        (
            lambda: periodic_orbit(block(), JERKY, section={"v": 0.1, "x": 0.0}),
            InputError,
            "one state and its level",
        ),
        (
            lambda: periodic_orbit(
                Axis(inertia=1.0, drive=Sine(amplitude=4.0, frequency=2.0)),
                JERKY,
                section={"v": 0.1},
            ),
            InputError,
            "leave section out",
        ),
        (
            lambda: periodic_orbit(Untold(**vars(block())), JERKY),
            SimulationError,
            "does not converge|there is no cycle",
        ),
    ],
)
def test_what_has_no_cycle_is_told(call, error, message):
    with pytest.raises(error, match=message):
        call()
