"""Periodic orbits: closed forms, published values, an independent integration, invariants."""

import math
import pickle
from collections import Counter
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from stickslip import (
    Axis,
    Capsule,
    Coulomb,
    Dahl,
    EventDriven,
    Pendulum,
    PendulumCart,
    Stribeck,
    Viscous,
    simulate,
)
from stickslip.errors import InputError, SimulationError
from stickslip.mechanisms import Prescribed, SoftStop, Torque
from stickslip.mechanisms.drives import Sine, Square, ThreePhase
from stickslip.study.sweep import continue_orbit, orbit_diagram, periodic_orbit
from stickslip.study.sweep.attractors import period_of
from stickslip.study.sweep.continuation import DIAGRAM_STEP, HALVED, Curve, _halves_meet
from stickslip.study.sweep.orbits import ECHO, return_map

FREQUENCY = "mechanism.drive.drive.frequency"
CAPSULE = Capsule(
    capsule_mass=0.08,
    inner_mass=0.02,
    stiffness=60.0,
    damping=0.03,
    upper_stop=2e-3,
    restitution=0.6,
    drive=Torque(drive=Sine(amplitude=0.2, frequency=13.0)),
)
ROUGH = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)
FADING = Stribeck(
    kinetic_coefficient=0.2, static_coefficient=0.25, stribeck_velocity=0.05, fading_exponent=1.5
)


def oscillator(b=0.8, force=1.0, phase=0.0, **settings):
    """Mass 1, stiffness 1: the natural frequency is 1 rad/s."""
    drive = Sine(amplitude=force, frequency=b / (2.0 * math.pi), phase=phase)
    return Axis(inertia=1.0, stiffness=1.0, drive=drive, **settings)


def capsule_at(frequency, phase=0.0):
    return replace(
        CAPSULE, drive=Torque(drive=Sine(amplitude=0.2, frequency=frequency, phase=phase))
    )


@pytest.mark.parametrize(
    ("mechanism", "law", "path", "value"),
    [
        (CAPSULE, ROUGH, FREQUENCY, 11.0),
        (CAPSULE, ROUGH, "friction.static_coefficient", 0.23),
        (
            replace(CAPSULE, drive=Torque(drive=Square(high=0.2, low=-0.1, period=0.15))),
            ROUGH,
            "mechanism.drive.drive.period",
            0.14,
        ),
        (CAPSULE, FADING, "friction.fading_exponent", 1.7),
    ],
    ids=["sine", "law", "pieces of a drive", "shape of an equation"],
)
def test_a_shot_is_the_run_of_its_own_pair_to_the_bit(mechanism, law, path, value):
    # equations are looked up once for all values of a parameter
    map_ = return_map(mechanism, law, 2, None, EventDriven(), path)
    y = np.linspace(1e-3, 2e-3, len(map_.names))
    shot = map_.shoot(y, value)
    begin = {**shot.mechanism.start(), **dict(zip(map_.names, y, strict=True))}
    start = [begin.get(name, 0.0) for name in map_.states]
    run = EventDriven().bare(shot.mechanism, shot.law, y0=start, t_end=shot.period)
    end = np.array([shot.period])
    free = list(map_.free)
    np.testing.assert_array_equal(run.at(end)[0][free] - y, shot.residual)
    paths = [f"initial.{name}" for name in map_.names]
    np.testing.assert_array_equal(run.differentiate(end, paths)[0][free], shot.monodromy)


def den_hartog(b, ratio):
    """Amplitude over P / k of a motion without stops: Den Hartog 1931."""
    v = 1.0 / (1.0 - b**2)
    u = math.sin(math.pi / b) / (b * (1.0 + math.cos(math.pi / b)))
    return math.sqrt(v**2 - (ratio * u) ** 2)


# -- closed forms


@pytest.mark.parametrize("b", [0.3, 0.8, 1.7])
def test_a_linear_oscillator_has_the_multipliers_of_its_closed_form(b):
    orbit = periodic_orbit(oscillator(b), Viscous(viscous_coefficient=0.2), settle=0)
    rate = complex(-0.1, math.sqrt(1.0 - 0.01))
    expected = np.exp(rate * 2.0 * math.pi / b)
    # no event but reversals, at which nothing jumps: the error is that of the series
    np.testing.assert_allclose(
        np.sort_complex(orbit.multipliers),
        np.sort_complex(np.array([expected, expected.conjugate()])),
        rtol=1e-9,
    )
    gain = 1.0 / abs(complex(1.0 - b**2, 0.2 * b))
    assert np.abs(orbit.run().sampled(4001)["x"]).max() == pytest.approx(gain, rel=1e-5)


@pytest.mark.parametrize(
    ("b", "ratio", "published"),
    [(0.8, 0.2, 2.711415), (0.8, 0.6, 2.106551), (1.2, 0.4, 1.902028), (1.5, 0.6, 0.4)],
)
def test_a_coulomb_oscillator_without_stops_has_den_hartogs_amplitude(b, ratio, published):
    orbit = periodic_orbit(oscillator(b), Coulomb(kinetic_coefficient=ratio))
    turns = [event.t for event in orbit.events if event.reason == "reversal"]
    amplitude = np.abs(orbit.run().at(turns)["x"]).max()
    assert orbit.stable
    assert amplitude == pytest.approx(den_hartog(b, ratio), rel=1e-9)
    assert amplitude == pytest.approx(published, abs=6e-7)  # digits of the published table


def test_all_of_a_branch_has_den_hartogs_amplitude_and_sticking_begins_where_friction_holds():
    law, ratio = Coulomb(kinetic_coefficient=0.6), 0.6
    orbit = periodic_orbit(oscillator(0.8), law)
    branch = continue_orbit(orbit, "frequency", (0.4 / (2 * math.pi), 0.95 / (2 * math.pi)))
    event = next(e for e in branch.events if e.kind == "sticking")
    # right there spring and drive just overcome friction as the body turns: below, it sticks
    turn = next(e.t for e in event.orbit.events if e.reason in ("reversal", "stop"))
    x = float(event.orbit.run().at(turn)["x"][0])
    net = math.sin(2.0 * math.pi * event.value * turn) - x
    assert abs(net) == pytest.approx(ratio, abs=1e-5)
    free = branch.values > event.value + 1e-4
    assert free.sum() > 10
    for index in np.flatnonzero(free)[::5]:
        found = branch.orbit(int(index))
        turns = [e.t for e in found.events if e.reason == "reversal"]
        amplitude = np.abs(found.run().at(turns)["x"]).max()
        expected = den_hartog(2.0 * math.pi * branch.values[index], ratio)
        assert amplitude == pytest.approx(expected, rel=1e-7)


def test_a_prescribed_stroke_moves_a_capsule_on_as_its_closed_form_says():
    stroke = ThreePhase(amplitude=0.01, fast=50.0, slow=9.81, first="slow")
    capsule = Capsule(capsule_mass=0.8, inner_mass=0.2, drive=Prescribed(profile=stroke))
    orbit = periodic_orbit(capsule, Coulomb(kinetic_coefficient=0.2))
    assert orbit.free == ("v",)  # the place is a translation, and the stroke is prescribed
    assert orbit.advance["x"] == pytest.approx(6.4304e-3, rel=1e-5)
    np.testing.assert_array_equal(orbit.multipliers, [0.0])  # it sticks: nothing is remembered


# -- grazing


STOP = 2.0


def stopped(force):
    return oscillator(0.8, force, upper_stop=STOP, restitution=0.5)


def test_grazing_is_found_where_the_linear_amplitude_reaches_the_stop():
    law = Viscous(viscous_coefficient=0.4)
    graze = STOP * abs(complex(1.0 - 0.64, 0.32))
    orbit = periodic_orbit(stopped(0.8 * graze), law)
    branch = continue_orbit(orbit, "amplitude", (0.5 * graze, 1.2 * graze))
    event = next(e for e in branch.events if e.kind == "grazing")
    assert event.value == pytest.approx(graze, rel=1e-6)
    assert event.orbit.stable


def test_a_branch_passes_a_touched_hard_stop_by_its_square_root():
    """Behind, the speed of the impact is proportional to the arc, and orbits are unstable."""
    law = Viscous(viscous_coefficient=0.4)
    graze = STOP * abs(complex(1.0 - 0.64, 0.32))
    orbit = periodic_orbit(stopped(0.8 * graze), law)
    branch = continue_orbit(orbit, "amplitude", (0.5 * graze, 1.5 * graze))
    assert branch.values[-1] == pytest.approx(1.5 * graze)
    event = next(e for e in branch.events if e.kind == "grazing")
    assert "passed by its square root" in event.sentence
    # eigenvalues are exp((-0.2 +- i 0.98) T): complex, for which there is no rule
    assert "largest multiplier without impact 0.21: no rule" in event.sentence
    speeds, arcs = [], []
    for index in (event.index + 1, event.index + 2):
        found = branch.orbit(index)
        assert not found.stable
        hit = next(e.t for e in found.events if e.reason == "hits stop")
        speeds.append(float(found.run().at([hit * (1.0 - 1e-9)])["v"][0]))
        arcs.append(branch.starts[index] - [event.orbit.start[name] for name in found.free])
    ratio = np.linalg.norm(arcs[1]) / np.linalg.norm(arcs[0])
    assert speeds[1] / speeds[0] == pytest.approx(ratio, rel=0.05)


def test_what_survives_a_touch_follows_from_real_eigenvalues_and_is_met_by_a_run():
    law, damping = Viscous(viscous_coefficient=2.5), 2.5
    graze = STOP * abs(complex(1.0 - 0.64, 0.8 * damping))
    branch = continue_orbit(
        periodic_orbit(stopped(0.9 * graze), law), "amplitude", (0.8 * graze, 1.1 * graze)
    )
    event = next(e for e in branch.events if e.kind == "grazing")
    slow = math.exp(-(damping / 2.0 - math.sqrt(damping**2 / 4.0 - 1.0)) * 2.0 * math.pi / 0.8)
    assert slow < 0.25
    assert "period adding" in event.sentence
    assert "a run behind closes after" in event.sentence


def test_multipliers_change_by_the_root_of_the_depth_at_a_soft_stop_that_is_touched():
    """The map differs by the 3/2 power of the depth; a damper on the way in alone makes a jump."""
    law, turns, k, c = Coulomb(kinetic_coefficient=5.0), 2.0 * math.pi * 8.0, 60.0, 0.1
    graze = STOP * 1e-3 * abs(complex(k - 0.02 * turns**2, c * turns))  # the capsule rests

    def touching(amplitude, damping=0.0, stiffness=600.0):
        return Capsule(
            capsule_mass=1.0, inner_mass=0.02, stiffness=k, damping=c, drive_on="inner mass",
            drive=Torque(drive=Sine(amplitude=amplitude, frequency=8.0)),
            upper_soft_stop=SoftStop(place=STOP * 1e-3, stiffness=stiffness, damping=damping),
        )  # fmt: skip

    orbit = periodic_orbit(touching(0.8 * graze), law)
    branch = continue_orbit(orbit, "drive.amplitude", (0.5 * graze, 1.1 * graze))
    (event,) = branch.events
    assert event.kind == "grazing"
    assert event.value == pytest.approx(graze, rel=1e-6)
    size = math.exp(-c / 0.02 / 2.0 / 8.0)
    assert f"largest multiplier without contact {size:.2g}, with it" in event.sentence
    assert "stable behind; a run behind closes after 1 cycle" in event.sentence
    assert branch.runs > 300  # that behind among them
    pair = np.sort_complex(orbit.multipliers[:2])

    def change(depth, damping):
        near = periodic_orbit(touching(graze * (1.0 + depth), damping), law).multipliers[:2]
        return float(np.abs(np.sort_complex(near) - pair).max())

    assert math.log10(change(1e-5, 0.0) / change(1e-7, 0.0)) == pytest.approx(1.0, abs=0.05)
    assert change(1e-8, 0.1) > 0.8 * change(1e-7, 0.1)
    hard = periodic_orbit(touching(0.99 * graze, stiffness=6e6), law)
    event = continue_orbit(hard, "drive.amplitude", (0.98 * graze, 1.01 * graze)).events[0]
    assert "unstable behind; a run behind ends in another motion, which" in event.sentence


@pytest.mark.slow
def test_a_branch_goes_on_behind_the_points_at_which_another_crosses():
    """A mass between equal stops, in a capsule that rests: what is symmetric loses stability."""
    stop = SoftStop(place=1e-3, stiffness=600.0)
    capsule = Capsule(
        capsule_mass=1000.0, inner_mass=0.02, stiffness=60.0, damping=0.1, drive_on="inner mass",
        drive=Torque(drive=Sine(amplitude=0.3, frequency=14.0)),
        upper_soft_stop=stop, lower_soft_stop=replace(stop, place=-1e-3),
    )  # fmt: skip
    orbit = periodic_orbit(capsule, Coulomb(kinetic_coefficient=5.0))
    branch = continue_orbit(orbit, "drive.frequency", (4.0, 30.0))
    assert branch.ends == ("It reaches 4 Hz.", "It reaches 30 Hz.")
    crossed = [event for event in branch.events if event.kind == "branch point"]
    assert len(crossed) == 3
    for event in crossed:
        assert np.abs(event.orbit.multipliers - 1.0).min() < 1e-3


def test_a_step_passes_a_branch_point_and_jumps_over_no_sharp_fold():
    """Both change the sign of det[dF/du; t], with nearly the same tangent."""

    def at(y, p, slopes):
        slopes = np.array(slopes) / np.linalg.norm(slopes)
        tangent = np.array([-slopes[1], slopes[0]])
        tangent *= np.sign(tangent[1])
        return SimpleNamespace(
            unknowns=np.array([y, p]), tangent=tangent, signature=(),
            crossing=float(np.linalg.det([slopes, tangent])),
        )  # fmt: skip

    def is_next(here, there):
        ds = float(here.tangent @ (there.unknowns - here.unknowns))
        return Curve.is_next(None, here, there, here.unknowns, ds)

    # (y - p^2 / 10) (p - y) = 0 along its first factor
    bent = [at(0.1 * p**2, p, [p, -0.2 * p**2]) for p in (-0.1, 0.12)]
    # p = 1 - 1e4 y^2, from below on to the other side
    sharp = [at(y, 1.0 - 1e4 * y**2, [2e4 * y, 1.0]) for y in (-0.01, 0.009)]
    for here, there in (bent, sharp):
        assert here.crossing * there.crossing < 0.0
        assert here.tangent @ there.tangent > 0.99
    assert is_next(*bent)
    assert not is_next(*sharp)
    assert is_next(sharp[0], at(-0.009, 1.0 - 1e4 * 0.009**2, [-180.0, 1.0]))


def test_the_saltation_of_a_touch_grows_like_the_inverse_root_of_its_depth():
    """The square-root law: dPhi/dy = O(depth^-1/2), as an impact at a speed of sqrt(2 a depth)."""
    law = Viscous(viscous_coefficient=0.4)
    graze = STOP * abs(complex(1.0 - 0.64, 0.32))
    orbit = periodic_orbit(stopped(graze * (1.0 - 1e-9)), law)
    shoot = return_map(orbit.mechanism, law, 1, None, orbit.solver)
    y = np.array([orbit.start[name] for name in orbit.free])
    depths = np.array([1e-3, 1e-4, 1e-5, 1e-6])
    sizes = [np.linalg.norm(shoot.shoot(y * (1.0 + depth)).monodromy) for depth in depths]
    slopes = np.diff(np.log(sizes)) / np.diff(np.log(depths))
    assert np.abs(slopes[-1] + 0.5) < 0.01
    assert np.abs(slopes[-1] + 0.5) < np.abs(slopes[0] + 0.5)


# -- an independent integration


def integrated(capsule, law, y, cycles):
    """The capsule by SciPy, in equations written here: slip, stick, and impacts at the stop.

    y is (x, xi, v, xi_dot); returns it after a number of cycles.
    """
    big, m, k, c = capsule.capsule_mass, capsule.inner_mass, capsule.stiffness, capsule.damping
    drive = capsule.drive.drive
    slip, hold = (
        mu * (big + m) * capsule.gravity for mu in (law.kinetic_coefficient, law.static_coefficient)
    )

    def inner(t, y):
        force = drive.amplitude * math.sin(2 * math.pi * drive.frequency * t)
        return force - k * y[1] - c * y[3]  # on the inner mass; its opposite on the capsule

    def field(direction):
        def rates(t, y):
            a = (-inner(t, y) - direction * slip) / big if direction else 0.0
            return [y[2], y[3], a, inner(t, y) / m - a]

        return rates

    def event(function, direction=0.0):
        function.terminal, function.direction = True, direction
        return function

    t, end = 0.0, cycles / drive.frequency
    mode = int(np.sign(y[2]))
    while t < end - 1e-12:
        hit = event(lambda t, y: y[1] - capsule.upper_stop, 1.0)
        if mode:
            change = event(lambda t, y: y[2], -float(mode))
        else:
            change = event(lambda t, y: hold - abs(inner(t, y)), -1.0)
        run = solve_ivp(
            field(mode), (t, end), y, method="DOP853", rtol=1e-12, atol=1e-14, max_step=1e-3,
            events=(hit, change),
        )  # fmt: skip
        t, y = run.t[-1], run.y[:, -1].copy()
        if run.t_events[0].size:
            # momentum of both is kept; the relative speed turns round
            after = -capsule.restitution * y[3]
            y[2] += m * (y[3] - after) / (big + m)
            y[3], y[1] = after, capsule.upper_stop - 1e-15
            mode = int(np.sign(y[2]))
        elif run.t_events[1].size and mode:
            y[2] = 0.0
            mode = 0 if abs(inner(t, y)) <= hold else int(np.sign(-inner(t, y)))
        elif run.t_events[1].size:
            mode = int(np.sign(-inner(t, y)))
            y[2] = mode * 1e-15
    return y


def test_an_independent_integration_closes_the_orbit_and_has_its_multipliers():
    orbit = periodic_orbit(CAPSULE, ROUGH)
    start = np.array([orbit.start[name] for name in ("x", "xi", "v", "xi_dot")])
    end = integrated(CAPSULE, ROUGH, start, 1)
    scale = np.array([1e-3, 5e-3, 0.02, 0.3])  # of the motion
    np.testing.assert_allclose((end[1:] - start[1:]) / scale[1:], 0.0, atol=1e-8)
    assert end[0] - start[0] == pytest.approx(orbit.advance["x"], rel=1e-7)
    assert orbit.mean_velocity["x"] == pytest.approx(16.679e-3, abs=5e-7)  # another such code
    columns = []
    for i in (1, 2, 3):
        step = np.eye(4)[i] * 1e-5 * scale[i]
        ends = [integrated(CAPSULE, ROUGH, start + sign * step, 1) for sign in (1, -1)]
        columns.append((ends[0] - ends[1])[1:] / (2e-5 * scale[i]))
    found = np.linalg.eigvals(np.array(columns).T)
    # differences over 1e-5 of the motion have errors of its square and of 1e-12 over it
    np.testing.assert_allclose(
        np.sort_complex(found), np.sort_complex(orbit.multipliers), atol=1e-5
    )


# -- invariants


def test_multipliers_and_advance_do_not_depend_on_where_the_cycle_is_cut():
    cut = [periodic_orbit(capsule_at(13.0, phase), ROUGH) for phase in (0.0, 1.0, 2.5, 4.0)]
    for orbit in cut[1:]:
        np.testing.assert_allclose(
            np.abs(orbit.multipliers), np.abs(cut[0].multipliers), rtol=1e-7, atol=1e-12
        )
        assert orbit.advance["x"] == pytest.approx(cut[0].advance["x"], rel=1e-9)
        assert orbit.sticking[""] == pytest.approx(cut[0].sticking[""], rel=1e-9)


def test_multipliers_of_what_sticks_are_zero():
    orbit = periodic_orbit(CAPSULE, ROUGH)
    assert "stop" in [event.reason for event in orbit.events]
    assert np.abs(orbit.multipliers).min() < 1e-12


@pytest.mark.parametrize(
    ("mechanism", "law", "path", "value"),
    [
        (CAPSULE, ROUGH, FREQUENCY, 13.0),
        (CAPSULE, ROUGH, "friction.kinetic_coefficient", 0.2),
        (
            replace(CAPSULE, drive=Torque(drive=Square(high=0.2, low=-0.2, period=0.08))),
            ROUGH,
            "mechanism.drive.drive.period",
            0.08,
        ),
        (
            oscillator(),
            Dahl(kinetic_coefficient=0.3, bristle_stiffness=50.0),
            "mechanism.drive.frequency",
            0.4 / math.pi,
        ),
    ],
    ids=["sine", "friction", "square", "bristles"],
)
def test_derivatives_of_the_map_are_those_of_differences(mechanism, law, path, value):
    orbit = periodic_orbit(mechanism, law)
    shoot = return_map(mechanism, law, 1, None, orbit.solver, path)
    y = np.array([orbit.start[name] for name in shoot.names])
    shot = shoot.shoot(y, value)
    h = 1e-5 * value
    slope = (shoot.shoot(y, value + h).residual - shoot.shoot(y, value - h).residual) / (2 * h)
    tolerance = 1e-5 * np.abs(slope).max()  # bristles are solved to 1e-8, differences over 1e-5
    np.testing.assert_allclose(shot.slope, slope, atol=100 * tolerance if law.states else tolerance)


def test_a_coordinate_is_left_out_only_if_nothing_depends_on_it():
    assert set(periodic_orbit(CAPSULE, ROUGH).advance) == {"x"}
    assert not periodic_orbit(oscillator(), Coulomb(kinetic_coefficient=0.2)).advance
    resting = periodic_orbit(oscillator(), Coulomb(kinetic_coefficient=2.0))
    assert "x" in resting.free  # it sticks throughout, and yet its spring depends on it
    assert resting.sticking == {"": 1.0}
    assert not resting.stable  # it rests in one of many places


def test_orbits_of_a_prescribed_pendulum_are_those_of_the_published_checks():
    swing = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
    cart = PendulumCart(
        cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=swing)
    )
    orbit = periodic_orbit(cart, Coulomb(kinetic_coefficient=0.2))
    assert orbit.advance["x"] == pytest.approx(0.0634659, abs=5e-8)


# -- period doubling


PENDULUM = Pendulum(
    mass=1.0,
    length=1.0,
    gravity=1.0,
    drive=Sine(amplitude=1.05, frequency=1.0 / (3.0 * math.pi), phase=math.pi / 2.0),
)
DAMPED = Viscous(viscous_coefficient=0.5)


def test_a_pendulum_doubles_its_period_where_the_literature_says():
    """The damped driven pendulum of Taylor, Classical Mechanics, 2005, table 12.1."""
    between = (1.04, 1.1)
    branch = continue_orbit(periodic_orbit(PENDULUM, DAMPED), "amplitude", between)
    published, period = (1.0663, 1.0793, 1.0821), 1
    for level in published:
        event = next(e for e in branch.events if e.kind == "period doubling")
        assert event.value == pytest.approx(level, abs=1e-4)
        assert np.abs(event.orbit.multipliers + 1.0).min() < 1e-5
        assert event.orbit.cycles == period
        period *= 2
        branch = continue_orbit(event.orbit, "amplitude", between, doubled=True)
        assert branch.cycles == period
        assert any("doubling" in end for end in branch.ends)


def test_a_doubled_branch_reaches_its_doubling():
    between = (1.04, 1.1)
    branch = continue_orbit(periodic_orbit(PENDULUM, DAMPED), "amplitude", between)
    event = next(e for e in branch.events if e.kind == "period doubling")
    doubled = continue_orbit(event.orbit, "amplitude", between, doubled=True)
    end = 0 if "doubling" in doubled.ends[0] else -1
    # the distance of both halves is as the root of that from the doubling
    assert doubled.values[end] == pytest.approx(event.value, rel=1e-5)
    orbit = doubled.orbit(end if end == 0 else len(doubled.values) - 1)
    half = orbit.run(1).at(np.array([orbit.period / 2]))["omega"][0]
    size = np.abs(doubled.starts).max()
    assert 1e-5 < abs(half - orbit.start["omega"]) / size < 5e-3


def test_a_settled_run_lies_on_the_doubled_branch():
    between = (1.04, 1.1)
    branch = continue_orbit(periodic_orbit(PENDULUM, DAMPED), "amplitude", between)
    event = next(e for e in branch.events if e.kind == "period doubling")
    doubled = continue_orbit(event.orbit, "amplitude", between, doubled=True)
    drive = replace(PENDULUM.drive, amplitude=1.074)
    cycle = 3.0 * math.pi
    run = simulate(replace(PENDULUM, drive=drive), DAMPED, t_end=400 * cycle)
    omega = run.at(cycle * np.arange(380, 401))["omega"]
    assert period_of(omega[:, None], np.abs(omega).max()) == 2
    orbits = [orbit for orbit in doubled.orbits_at(1.074) if orbit.stable]
    # the same rates, begun at the one or the other of two cycles
    starts = [orbit.start["omega"] for orbit in orbits]
    assert np.abs(np.subtract.outer(starts, omega[-2:])).min() < 1e-8
    single = [orbit for orbit in branch.orbits_at(1.074) if orbit.cycles == 1]
    assert single
    assert not any(orbit.stable for orbit in single)


# -- branches and diagrams


@pytest.fixture(scope="module")
def diagram():
    return orbit_diagram(CAPSULE, ROUGH, "drive.frequency", (12.0, 20.0), values=9, settle=150)


def test_branches_turn_back_at_folds_with_a_multiplier_one(diagram):
    folds = [event for _, event in diagram.events if event.kind == "fold"]
    assert folds
    for event in folds:
        assert np.abs(event.orbit.multipliers - 1.0).min() < 1e-3
    (turn,) = (event.value for event in folds if event.orbit.cycles == 1)
    assert turn == pytest.approx(17.2036, abs=1e-3)


def test_branches_end_where_the_range_does(diagram):
    for branch in diagram.branches:  # also those that begin at an end of it
        assert branch.values.min() >= 12.0 - 1e-9
        assert branch.values.max() <= 20.0 + 1e-9


def test_every_settled_motion_lies_on_a_stable_part_of_a_branch(diagram):
    scale = np.nanmax(np.abs(diagram.samples), axis=(0, 1))
    assert (diagram.settled > 0).mean() > 0.9  # right behind a loss of stability runs settle slowly
    for value, closed, points in zip(diagram.values, diagram.settled, diagram.samples, strict=True):
        if not closed:
            continue
        orbits = [
            orbit
            for branch in diagram.branches
            if branch.cycles == closed
            for orbit in branch.orbits_at(value)
            if orbit.stable
        ]
        starts = np.array([[orbit.start[name] for name in diagram.states] for orbit in orbits])
        gaps = np.abs((starts[:, None, :] - points[None, :closed, :]) / scale).max(axis=2)
        assert gaps.min() < 2e-3


def test_runs_from_both_sides_of_a_fold_jump_as_the_branch_says(diagram):
    fold = next(e.value for _, e in diagram.events if e.kind == "fold" and e.orbit.cycles == 1)
    before = periodic_orbit(capsule_at(fold - 0.02), ROUGH, start=_start_near(diagram, fold - 0.02))
    assert before.stable
    assert abs(before.mean_velocity["x"]) > 5e-3
    start = {name: before.start[name] for name in before.free}
    behind = periodic_orbit(capsule_at(fold + 0.05), ROUGH, start=start, settle=1500)
    assert abs(behind.mean_velocity["x"]) < 1e-6  # no impact carries it on


def _start_near(diagram, value):
    orbits = [o for branch in diagram.branches for o in branch.orbits_at(value) if o.stable]
    fastest = max(orbits, key=lambda orbit: abs(orbit.mean_velocity["x"]))
    return {name: fastest.start[name] for name in fastest.free}


def test_branches_are_tables_and_pickles(diagram):
    again = pickle.loads(pickle.dumps(diagram))
    assert str(again) == str(diagram)
    frame = diagram.to_dataframe()
    assert len(frame) == sum(len(branch.values) for branch in diagram.branches)
    assert {"branch", "cycles", "stable", FREQUENCY, "advance x"} <= set(frame.columns)
    assert diagram.branch_cycles < diagram.brute_cycles


def test_what_happens_in_an_orbit_is_counted_by_its_events(diagram):
    seen = 0
    for branch in diagram.branches:
        for index in range(0, len(branch.values), 23):
            shot = branch.map.shoot(branch.starts[index], float(branch.values[index]))
            came, end = shot.run.events(), (1.0 - ECHO) * shot.period
            late = {(e.contact, e.reason) for e in came if e.t >= end}
            events = Counter(
                (e.contact, e.reason)
                for e in came
                if e.t > ECHO * shot.period or (e.contact, e.reason) not in late
            )
            told = {(c, what): n for c, what, n in shot.signature if not what.startswith("mode ")}
            assert told == events
            assert told.get(("", "stop"), 0) == told.get(("", "break-away"), 0)
            seen += len(events)
    assert seen > 10


def test_all_orbits_of_a_branch_close(diagram):
    for branch in diagram.branches:
        for index in range(0, len(branch.values), 11):
            # beside a grazing contact rounding grows by multipliers of 1e6
            steep = abs(branch.multipliers[index]).max() > 1e4
            assert branch.orbit(index).residual <= (1e-6 if steep else 1e-10)


def test_what_a_branch_keeps_is_that_of_its_orbits(diagram):
    """The last run of a correction is left out: advance and multipliers are those of the next."""
    for branch in diagram.branches:
        for index in range(0, len(branch.values), 17):
            orbit = branch.orbit(index)
            assert branch.advances["x"][index] == pytest.approx(orbit.advance["x"], rel=1e-8)
            assert branch.periods[index] == pytest.approx(orbit.period, rel=1e-13)
            sizes = np.abs(orbit.multipliers)
            # multipliers of thousands, beside a grazing contact, change in a part of a step
            rtol = 1e-2 if sizes.max() > 1e3 else 1e-4
            kept = np.abs(branch.multipliers[index])
            np.testing.assert_allclose(kept, sizes, rtol=rtol, atol=1e-6)


# -- a motion of period two

UNEVEN = Capsule(
    capsule_mass=0.06,
    inner_mass=0.045,
    stiffness=120.0,
    damping=0.1,
    upper_soft_stop=SoftStop(place=1.2e-3, stiffness=2500.0, damping=0.4),
    lower_soft_stop=SoftStop(place=-3e-3, stiffness=800.0, damping=0.1),
    drive=Torque(drive=Sine(amplitude=0.45, frequency=15.5)),
)
WEAKENING = Stribeck(
    kinetic_coefficient=0.12,
    static_coefficient=0.17,
    stribeck_velocity=0.03,
    viscous_coefficient=0.15,
)


@pytest.fixture(scope="module")
def twice():
    between, few = (13.0, 17.0), {"values": 2, "starts": 2, "settle": 100}
    return orbit_diagram(UNEVEN, WEAKENING, "drive.frequency", between, cycles=2, **few)


def test_stable_stretches_end_at_the_doublings_and_each_motion_has_one(twice):
    """Random starts reach both motions at 14.5 Hz, and one, of period two, at 15.5 Hz."""
    found = [
        (branch.cycles, *sorted([*branch.values[[begin, end - 1]], *ends])[::3])
        for branch in twice.branches
        for begin, end, *ends in branch.stretches
    ]
    doublings = [event.value for _, event in twice.events if event.kind == "period doubling"]
    assert doublings == pytest.approx([15.053, 16.036], abs=1e-3)  # another such search
    expected = [(1, 13.0, doublings[0]), (1, doublings[1], 17.0), (2, 13.7785, 16.068)]
    # the last begins in a corner and ends in a fold, of which five digits were given
    assert sorted(found)[:2] == expected[:2]
    several = "several side by side over 33 %, most widely from 13.78 to 15.05 Hz and 16.04 to"
    assert several in str(twice)
    (branch,) = (branch for branch in twice.branches if branch.cycles == 2)
    assert (branch.values.min(), branch.values.max()) == pytest.approx(expected[2][1:], rel=1e-4)
    assert all("in a doubling of period 1" in end for end in branch.ends)


def test_an_orbit_begun_a_cycle_later_lies_on_the_same_branch(twice):
    (branch,) = (branch for branch in twice.branches if branch.cycles == 2)
    orbit, map_ = branch.orbit(len(branch.values) // 2), branch.map
    curve = Curve(map_, 13.0, 17.0, "Hz", 0.02, 100, DIAGRAM_STEP)
    trail = np.column_stack([branch.starts, branch.values])
    curve.known = trail, np.full(len(trail), 7)
    value = float(branch.values[len(branch.values) // 2])
    later = orbit.run(1).at([orbit.period / 2.0])
    for start in (orbit.start, {name: float(later[name][0]) for name in orbit.free}):
        shot = map_.shoot(np.array([start[name] for name in orbit.free]), value)
        assert curve.met(curve.point(shot)) == 7
    single = periodic_orbit(orbit.mechanism, WEAKENING)
    shot = map_.shoot(np.array([single.start[name] for name in orbit.free]), value)
    assert curve.met(curve.point(shot)) is None


@pytest.mark.parametrize(
    ("before", "after", "meet"),
    [
        (2e-3, -1e-3, True),  # across the doubling
        (1.5e-3, 4.5e-6, True),  # right before it, where the next step cannot tell the halves
        (2e-3, 1.5e-3, False),  # there is a step to go
        (1e-8, -1e-8, False),  # both are alike all the time, to what is solved for
    ],
)
def test_a_step_that_lands_at_a_doubling_ends_there(before, after, meet):
    assert 4.5e-6 < HALVED < 1.5e-3
    here, there = (
        SimpleNamespace(
            half=np.array([half, 0.5 * half]),
            scale=np.ones(3),
            shot=SimpleNamespace(off=np.zeros(3)),
        )
        for half in (before, after)
    )
    assert _halves_meet(here, there) == meet


def test_orbits_that_close_sooner_are_those_of_a_branch_of_fewer_cycles():
    """A branch of period three begins near 7.016 Hz; followed on, its orbits close after one."""
    capsule = Capsule(
        capsule_mass=0.09703,
        inner_mass=0.02577,
        stiffness=106.06,
        damping=0.1913,
        upper_soft_stop=SoftStop(place=1.33e-3, stiffness=2154.6, damping=0.3),
        lower_soft_stop=SoftStop(place=-3.483e-3, stiffness=1523.0, damping=0.1),
        drive=Torque(drive=Sine(amplitude=0.41984, frequency=7.0)),
    )
    law = Coulomb(kinetic_coefficient=0.05413, static_coefficient=0.22)
    few = {"cycles": 3, "values": 3, "starts": 2, "settle": 100}
    found = orbit_diagram(capsule, law, "drive.frequency", (7.0, 7.05), **few)
    longer = [branch for branch in found.branches if branch.cycles == 3]
    assert longer
    for branch in longer:
        assert any("close after fewer cycles" in end for end in branch.ends)
        for index in range(len(branch.values)):
            shot = branch.map.shoot(branch.starts[index], float(branch.values[index]))
            # far more than the residual of an orbit, over the size of the states
            assert (np.abs(shot.strobes[1:] - shot.y) / shot.scale).max(axis=1).min() > 1e-6


def test_settled_runs_are_made_at_values_that_are_given():
    axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=2.0))
    law, few = Coulomb(kinetic_coefficient=0.5), {"cycles": 1, "starts": 1, "settle": 50}
    found = orbit_diagram(axis, law, "frequency", (1.9, 2.4), values=[2.2, 1.95], **few)
    assert found.values.tolist()[:2] == [1.95, 2.2]
    with pytest.raises(InputError, match=r"must lie in 1\.9 to 2\.4 Hz.*got 1\.8 to 2 Hz"):
        orbit_diagram(axis, law, "frequency", (1.9, 2.4), values=[1.8, 2.0], **few)


# -- elastic stops


def elastic(frequency):
    stop = SoftStop(place=2e-3, stiffness=3000.0, damping=0.1)
    bare = replace(capsule_at(frequency), upper_stop=None, restitution=0.0, upper_soft_stop=stop)
    return replace(bare, drive_on="inner mass")


def test_a_branch_that_comes_back_to_itself_ends_there():
    orbit = periodic_orbit(elastic(2.6), ROUGH, settle=200)
    branch = continue_orbit(orbit, "frequency", (2.0, 20.0))
    assert len(branch.values) < 1000  # it was followed round and round for 2,000 points a side
    assert not any("give more" in end for end in branch.ends)
    scale = np.abs(branch.starts).max(axis=0)
    points = np.column_stack(
        [branch.starts / np.where(scale > 0.0, scale, 1.0), branch.values / 18.0]
    )
    gaps = np.linalg.norm(points[:, None] - points[None, :], axis=2)
    far = np.abs(np.subtract.outer(np.arange(len(points)), np.arange(len(points)))) > 20
    assert ((gaps < 1e-6) & far).sum() <= 2 * 20  # no part twice


def test_what_is_stable_where_nothing_was_known_is_found():
    """Three cycles near 2 Hz: between values with settled runs, connected to nothing known."""
    found = orbit_diagram(elastic(2.0), ROUGH, "frequency", (2.0, 2.1), values=2, starts=1)
    stable = [b for b in found.branches if b.cycles == 3 and b.stable.any()]
    assert any(b.values.min() < 2.0286 and b.values.max() > 2.0166 for b in stable)


def test_branches_are_those_of_the_least_period():
    """Runs that come to rest from either side in turn close after two cycles before one."""
    found = orbit_diagram(elastic(9.2), ROUGH, "frequency", (9.17, 9.3), values=4, starts=3)
    assert {branch.cycles for branch in found.branches} >= {1, 2}
    for branch in found.branches:
        if branch.cycles == 2:
            orbit = branch.orbit(len(branch.values) // 2)
            times = [0.0, orbit.period / 2.0]
            first, second = orbit.run().at(times)["xi"]
            assert abs(first - second) > 1e-6


def test_a_branch_over_folds_has_a_mean_velocity_at_each_point_whatever_advances():
    orbit = periodic_orbit(elastic(2.6), ROUGH, settle=200)
    branch = continue_orbit(orbit, "frequency", (2.4, 2.9))
    assert any(event.kind == "fold" for event in branch.events)
    np.testing.assert_array_equal(branch.mean_velocity(), branch.advances["x"] / branch.periods)
    np.testing.assert_array_equal(branch.mean_velocity("xi"), 0.0 * branch.values)  # it comes back
    held = periodic_orbit(oscillator(), Coulomb(kinetic_coefficient=0.2))
    assert held.mean_velocity == {"x": 0.0}
    still = continue_orbit(held, "frequency", (0.12, 0.13))
    np.testing.assert_array_equal(still.mean_velocity(), 0.0 * still.values)
    with pytest.raises(InputError, match=r"unknown coordinate 'y'\. Known: x"):
        still.mean_velocity("y")


# -- what cannot be


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: periodic_orbit(CAPSULE, ROUGH, cycles=0), "cycles must be a whole number of 1"),
        (lambda: periodic_orbit(CAPSULE, ROUGH, start={"y": 1.0}), "unknown"),
        (lambda: orbit_diagram(CAPSULE, ROUGH, "frequency", (3.0, 2.0)), "the lower one first"),
        (lambda: orbit_diagram(CAPSULE, ROUGH, "frequency", (0.0, 2.0)), "above 0 Hz, got 0"),
        (lambda: orbit_diagram(CAPSULE, ROUGH, "frequenzy", (1.0, 2.0)), "frequency"),
        (lambda: orbit_diagram(CAPSULE, ROUGH, "initial.xi", (0.0, 1e-3)), "not a parameter"),
        (lambda: orbit_diagram(CAPSULE, ROUGH, "restitution", (0.5, 1.5)), "at most 1"),
        (
            lambda: orbit_diagram(CAPSULE, ROUGH, ["frequency"], (1.0, 2.0)),
            "orbit_diagram: path mu",
        ),
    ],
)
def test_what_cannot_be_used_is_refused_by_its_name(call, message):
    with pytest.raises(InputError, match=message):
        call()


def test_an_orbit_is_continued_within_a_range_around_it_and_doubled_at_minus_one():
    orbit = periodic_orbit(CAPSULE, ROUGH)
    with pytest.raises(InputError, match="13 Hz, outside of 14 to 20 Hz"):
        continue_orbit(orbit, "frequency", (14.0, 20.0))
    with pytest.raises(InputError, match="needs an orbit with a multiplier at -1"):
        continue_orbit(orbit, "frequency", (12.0, 20.0), doubled=True)
    paths = ["drive.frequency", "drive.amplitude"]
    with pytest.raises(InputError, match=r"path must name one parameter.*got \['drive.frequency'"):
        continue_orbit(orbit, paths, (12.0, 20.0))
    with pytest.raises(InputError, match="step must be above"):
        continue_orbit(orbit, "frequency", (12.0, 20.0), step=2.0)


def test_a_search_that_finds_no_orbit_says_how_far_it_is_and_what_to_do():
    pulled = Axis(inertia=1.0, offset=-5.0, drive=Sine(amplitude=1.0, frequency=1.0))
    with pytest.raises(
        SimulationError, match=r"a periodic orbit of 1 cycle does not converge.* Settle longer"
    ):
        periodic_orbit(pulled, Coulomb(kinetic_coefficient=0.5), settle=3)  # faster and faster


def test_two_sines_have_orbits_where_a_cycle_holds_both():
    two = Sine(amplitude=0.15, frequency=8.0) + Sine(amplitude=0.1, frequency=12.0)
    robot = replace(CAPSULE, drive=Torque(drive=two))
    with pytest.raises(InputError, match="no common period"):
        periodic_orbit(robot, ROUGH)
    orbit = periodic_orbit(robot, ROUGH, period=0.25)
    later = orbit.run(9).at(np.array([2.0, 2.25]))  # eight cycles and nine
    np.testing.assert_allclose(later["xi"], orbit.start["xi"], atol=1e-9)
    path = "mechanism.drive.drive.parts.1"
    branch = continue_orbit(orbit, f"{path}.amplitude", (0.098, 0.102), period=0.25)
    assert branch.values.min() == pytest.approx(0.098)
    for period in (0.2, 0.375):
        with pytest.raises(InputError, match="no orbit closes"):
            periodic_orbit(robot, ROUGH, period=period)
    with pytest.raises(InputError, match="no orbit closes"):  # although 12 and 16 Hz both fit
        continue_orbit(orbit, f"{path}.frequency", (12.0, 16.0), period=0.25)


def test_starts_of_an_orbit_diagram_do_not_grow_with_what_has_not_settled():
    robot = capsule_at(18.0)
    path = "mechanism.drive.drive.frequency"
    found = orbit_diagram(robot, ROUGH, path, (17.0, 19.0), cycles=1, values=10, starts=2, settle=1)
    assert np.nanmax(np.abs(found.samples)) < 50.0  # it is 6.4; 310 if starts are of unsettled runs


@pytest.mark.slow
def test_a_walk_ends_where_every_step_changes_what_happens():
    """Branches of rest and of slip lie side by side here, each a step behind the other."""
    square = Square(high=0.2, low=-0.2, period=0.125, duty=0.5)
    capsule = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, drive_on="inner mass",
        upper_stop=2e-3, lower_stop=-2e-3, restitution=0.6, drive=Torque(drive=square),
    )  # fmt: skip
    law = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)
    path, between = "friction.kinetic_coefficient", (0.05, 0.2)
    found = orbit_diagram(capsule, law, path, between, cycles=1, values=3, starts=1, settle=40)
    assert found.branches
    assert max(len(branch.values) for branch in found.branches) < 1000


def test_a_branch_ends_where_the_body_comes_to_rest():
    axis = Axis(inertia=1.0, stiffness=100.0, drive=Sine(amplitude=4.0, frequency=2.0))
    law = Coulomb(kinetic_coefficient=0.5)
    branch = continue_orbit(periodic_orbit(axis, law), "amplitude", (0.0, 5.0))
    assert branch.values.min() == pytest.approx(0.5, abs=0.01)
    assert "followed" not in branch.ends[0]


@pytest.mark.parametrize("start", [0.0, -0.4])
def test_a_wave_shifted_to_before_time_0_has_the_orbit_that_runs_settle_to(start):
    axis, law = squared(start), Coulomb(kinetic_coefficient=0.5)
    times = np.linspace(0.0, 0.5, 101)
    settled = simulate(axis, law, t_end=40.0).at(39.0 + times)["x"]
    own = periodic_orbit(axis, law).run().at(times)["x"]
    np.testing.assert_allclose(own, settled, atol=1e-5)


def test_a_wave_that_begins_late_is_refused():
    """Its first cycle differs: a run over it alone closes at what is no orbit."""
    with pytest.raises(InputError, match=r"begins at 0\.1 s.*a whole number of periods earlier"):
        periodic_orbit(squared(0.1), Coulomb(kinetic_coefficient=0.5))


def squared(start: float) -> Axis:
    wave = Square(high=4.0, low=-4.0, period=0.5, duty=0.5, start=start)
    return Axis(inertia=1.0, stiffness=100.0, damping=0.5, drive=wave)
