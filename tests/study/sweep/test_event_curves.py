"""Curves of events over two parameters: closed forms, single-parameter branches, settled runs."""

import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Capsule, Coulomb, Viscous, simulate
from stickslip.errors import InputError
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import Sine
from stickslip.study.sweep import (
    continue_event,
    continue_orbit,
    orbit_chart,
    orbit_diagram,
    periodic_orbit,
)

GRAVITY, PHASE = 9.81, -1.5
FRICTIONLESS = Viscous(viscous_coefficient=0.0)
CAPSULE = Capsule(
    capsule_mass=0.08,
    inner_mass=0.02,
    stiffness=60.0,
    damping=0.03,
    drive_on="inner mass",
    upper_soft_stop=SoftStop(place=2e-3, stiffness=3000.0, damping=0.1),
    drive=Torque(drive=Sine(amplitude=0.2, frequency=13.0)),
)
HARD = replace(
    CAPSULE, drive_on="both", upper_soft_stop=None, upper_stop=2e-3, restitution=0.6
)  # fmt: skip
ROUGH = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)


def fold_of(restitution):
    """A w^2 of the floor below which a ball does not bounce once a period."""
    return math.pi * (1.0 - restitution) / (1.0 + restitution) * GRAVITY


def doubling_of(r):
    """A w^2 at which that motion doubles its period."""
    cubic = (1.0 + r**2) / (1.0 + r) ** 2
    return GRAVITY * np.sqrt((math.pi * (1.0 - r) / (1.0 + r)) ** 2 + 4.0 * cubic**2)


def bouncing(a, frequency=5.0, restitution=0.5):
    """A ball in the frame of a vibrating floor with its motion of period one, by closed form."""
    w, period = 2.0 * math.pi * frequency, 1.0 / frequency
    hit = (math.acos(fold_of(restitution) / a) - PHASE) / w % period
    left, up = period - hit, GRAVITY * period / 2.0
    height = a / w**2 * (math.sin(w * hit + PHASE) - math.sin(PHASE))
    start = {
        "x": height + up * left - GRAVITY * left**2 / 2.0,
        "v": up - GRAVITY * left - a / w * math.cos(PHASE),
    }
    ball = Axis(
        inertia=1.0, offset=GRAVITY, lower_stop=0.0, restitution=restitution,
        drive=Sine(amplitude=a, frequency=frequency, phase=PHASE),
    )  # fmt: skip
    return periodic_orbit(ball, FRICTIONLESS, start=start, settle=0)


@pytest.fixture(scope="module")
def bounces():
    return continue_orbit(bouncing(1.2 * fold_of(0.5)), "amplitude", (9.0, 31.0))


@pytest.mark.parametrize(
    ("kind", "exact"), [("fold", fold_of), ("period doubling", doubling_of)]
)  # fmt: skip
@pytest.mark.parametrize(
    ("second", "box"), [("frequency", (3.0, 8.0)), ("restitution", (0.4, 0.7))]
)
def test_a_bouncing_ball_has_its_curves_of_folds_and_doublings(bounces, kind, exact, second, box):
    own = [event for event in bounces.events if event.kind == kind]
    event = min(own, key=lambda event: abs(event.value - exact(0.5)))
    curve = continue_event(event, ("amplitude", second), ((5.0, 31.0), box))
    r = curve.values[:, 1] if second == "restitution" else np.full(len(curve.values), 0.5)
    assert np.ptp(curve.values[:, 1]) == pytest.approx(box[1] - box[0])
    np.testing.assert_allclose(curve.values[:, 0], exact(r), rtol=1e-8)


def test_a_stop_is_touched_where_the_linear_amplitude_reaches_it():
    """The curve passes where the orbit has an impact on the other side, of either restitution."""
    axis = Axis(
        inertia=1.0, stiffness=1.0, upper_stop=2.0, restitution=0.5,
        drive=Sine(amplitude=0.8, frequency=0.4 / math.pi),
    )  # fmt: skip
    orbit = periodic_orbit(axis, Viscous(viscous_coefficient=0.4))
    branch = continue_orbit(orbit, "amplitude", (0.5, 2.0))
    event = next(event for event in branch.events if event.kind == "grazing")
    curve = continue_event(event, ("amplitude", "frequency"), ((0.1, 3.0), (0.1, 0.2)))
    w = 2.0 * math.pi * curve.values[:, 1]
    np.testing.assert_allclose(curve.values[:, 0], 2.0 * np.abs(1 - w**2 + 0.4j * w), rtol=1e-8)
    assert curve.ends == ("It reaches 0.1 Hz.", "It reaches 0.2 Hz.")


def test_sticking_begins_where_den_hartog_says():
    """A motion without stops turns back up to r = V / sqrt(U^2 + 1 / b^4)."""
    axis = Axis(
        inertia=1.0, stiffness=1.0, drive=Sine(amplitude=1.0, frequency=0.4 / math.pi)
    )  # fmt: skip
    orbit = periodic_orbit(axis, Coulomb(kinetic_coefficient=0.7))
    branch = continue_orbit(orbit, "kinetic_coefficient", (0.6, 0.9))
    event = next(event for event in branch.events if event.kind == "sticking")
    paths = ("kinetic_coefficient", "frequency")
    curve = continue_event(event, paths, ((0.3, 1.0), (0.7 / (2 * math.pi), 1.3 / (2 * math.pi))))
    b = 2.0 * math.pi * curve.values[:, 1]
    b = b[np.abs(b - 1.0) > 1e-3]  # the form is 0 / 0 there
    r = curve.values[np.abs(2.0 * math.pi * curve.values[:, 1] - 1.0) > 1e-3, 0]
    v, u = 1.0 / (1.0 - b**2), np.sin(np.pi / b) / (b * (1.0 + np.cos(np.pi / b)))
    assert np.ptp(b) > 0.2
    np.testing.assert_allclose(r, np.abs(v) / np.sqrt(u**2 + b**-4), rtol=1e-6)


@pytest.fixture(scope="module")
def soft():
    return continue_orbit(periodic_orbit(CAPSULE, ROUGH), "drive.frequency", (10.0, 18.0))


@pytest.mark.parametrize(("kind", "which"), [("fold", -1), ("period doubling", 0), ("sticking", 1)])
def test_curves_of_a_capsule_are_met_by_branches_over_one_parameter(soft, kind, which):
    event = [event for event in soft.events if event.kind == kind][which]
    paths, box = ("drive.frequency", "drive.amplitude"), ((10.0, 18.0), (0.17, 0.215))
    curve = continue_event(event, paths, box)
    assert all("reaches" in end for end in curve.ends)
    for index in np.linspace(1, len(curve.values) - 2, 4).astype(int):
        frequency, amplitude = curve.values[index]
        drive = Sine(amplitude=amplitude, frequency=frequency)
        start = dict(zip(curve.states, curve.starts[index], strict=True))
        near = replace(CAPSULE, drive=Torque(drive=drive))
        orbit = periodic_orbit(near, ROUGH, start=start, settle=0)
        branch = continue_orbit(orbit, paths[0], (frequency - 0.02, frequency + 0.02), step=0.5)
        found = [event.value for event in branch.events if event.kind == kind]
        assert np.abs(np.array(found) - frequency).min() < 1e-6 * (box[0][1] - box[0][0])


@pytest.fixture(scope="module")
def stuck():
    """The branch that sticks over the start of the cycle, and where it breaks off."""
    start = {"xi": -0.00204, "v": 0.0168, "xi_dot": -0.2528}
    rig = replace(CAPSULE, drive=Torque(drive=Sine(amplitude=0.2, frequency=15.12)))
    orbit = periodic_orbit(rig, ROUGH, start=start, settle=0)
    return continue_orbit(orbit, "drive.frequency", (14.4, 15.4))


def test_what_passes_the_start_of_the_cycle_is_no_event(stuck):
    phases = []
    for index in range(len(stuck.values)):
        orbit = stuck.orbit(index)
        phases += [e.t / orbit.period for e in orbit.events if e.reason == "stop"]
    assert min(phases) < 0.05  # it stops before and behind the start of the cycle
    assert max(phases) > 0.95
    assert not [event for event in stuck.events if event.value < 15.0]


def test_sticking_that_breaks_off_has_a_curve(stuck):
    event = next(e for e in stuck.events if e.kind == "sticking")
    paths, box = ("drive.frequency", "drive.amplitude"), ((14.4, 15.6), (0.19, 0.21))
    curve = continue_event(event, paths, box)
    assert all("reaches" in end for end in curve.ends)
    for frequency, amplitude in curve.values[[2, -3]]:
        k = int(np.argmin(np.abs(curve.values[:, 1] - amplitude)))
        start = dict(zip(curve.states, curve.starts[k], strict=True))
        drive = Torque(drive=Sine(amplitude=amplitude, frequency=frequency - 0.002))  # in front
        orbit = periodic_orbit(replace(CAPSULE, drive=drive), ROUGH, start=start, settle=0)
        beside = continue_orbit(orbit, paths[0], (frequency - 0.05, frequency + 0.05))
        off = [abs(e.value - frequency) for e in beside.events if e.kind == "sticking"]
        assert min(off) < 1e-6


def test_points_of_codimension_two_have_both_events(soft):
    event = next(event for event in soft.events if event.kind == "period doubling")
    curve = continue_event(
        event, ("drive.frequency", "drive.amplitude"), ((10.0, 18.0), (0.15, 0.25))
    )
    (point,) = (point for point in curve.points if "sticking" in point.kind)
    assert point.kind == "flip with sticking"
    assert np.abs(point.orbit.multipliers + 1.0).min() < 1e-4
    margins = [abs(event.margin) for event in point.orbit.events if event.reason == "stop"]
    assert min(margins) < 1e-4 * 0.25 * 0.1 * GRAVITY
    assert point.kind in str(curve)


def bordered(frequency, amplitude):
    """Return the curve of the doubling that begins near both parameters."""
    rig = replace(CAPSULE, drive=Torque(drive=Sine(amplitude=amplitude, frequency=frequency)))
    start = {"xi": -0.0020859, "v": 0.0163487, "xi_dot": -0.2491242}
    orbit = periodic_orbit(rig, ROUGH, start=start, settle=0)
    branch = continue_orbit(orbit, "drive.frequency", (frequency - 0.2, frequency + 0.2))
    event = next(event for event in branch.events if event.kind == "period doubling")
    paths, box = ("drive.frequency", "drive.amplitude"), ((10.0, 18.0), (0.15, 0.25))
    return continue_event(event, paths, box)


@pytest.mark.slow
def test_a_curve_that_runs_along_a_border_ends_there_wherever_it_begins():
    ends = [bordered(*at).values[-1, 1] for at in ((15.0295, 0.19173), (15.16, 0.2018))]
    assert np.ptp(ends) < 1e-3 * (0.25 - 0.15)


def test_a_curve_that_runs_along_a_border_says_along_which():
    """The doubling comes so near a change of sticking that no step stays in front of it."""
    curve = bordered(15.0295, 0.19173)
    assert "frequency 1e-05 of its range off, sticking from 2 to 1 times" in curve.ends[1]
    (frequency, amplitude), counts = curve.values[-1], set()
    start = dict(zip(curve.states, curve.starts[-1], strict=True))
    for turns in (frequency - 8e-5, frequency + 8e-5):
        near = replace(CAPSULE, drive=Torque(drive=Sine(amplitude=amplitude, frequency=turns)))
        run = simulate(near, ROUGH, t_end=1.0 / turns, y0=start)
        counts.add(sum(event.reason == "stop" for event in run.events))
    assert counts == {1, 2}


@pytest.mark.slow
def test_a_chart_knows_the_motions_that_settled_runs_show():
    ranges = {"drive.frequency": (14.0, 18.0), "drive.amplitude": (0.17, 0.23)}
    chart = orbit_chart(
        CAPSULE, ROUGH, ranges, values=(5, 4), lines=1, runs=5, cycles=1, settle=150
    )
    assert {curve.kind for curve in chart.curves} >= {"fold"}
    assert chart.count.min() >= 1
    assert (chart.count == 2).any()
    for j in (0, 3):
        amplitude = float(chart.axes[1][j])
        rig = replace(CAPSULE, drive=Torque(drive=Sine(amplitude=amplitude, frequency=15.0)))
        few = {"values": chart.axes[0], "starts": 1, "settle": 200, "cycles": 1}
        brute = orbit_diagram(rig, ROUGH, "drive.frequency", (14.0, 18.0), **few)
        for value, closed, points in zip(brute.values, brute.settled, brute.samples, strict=True):
            at = np.flatnonzero(chart.axes[0] == value)
            if closed == 1 and len(at):
                known = np.array([y for _, y in chart.motions[int(at[0]), j]])
                off = np.abs(known - points[-1]) / np.abs(points).max()
                assert off.max(axis=1).min() < 2e-3
    assert "stable periodic motions" in str(chart)
    assert {"curve", "event"} <= set(chart.to_dataframe().columns)


def test_what_has_no_curve_is_refused_by_its_name(soft):
    fold = next(event for event in soft.events if event.kind == "fold")
    paths = ("drive.frequency", "drive.amplitude")
    with pytest.raises(InputError, match="event must be one of a branch, of kind fold"):
        continue_event(replace(fold, kind="torus"), paths, ((10.0, 18.0), (0.1, 0.3)))
    with pytest.raises(InputError, match=r"0\.2 N, outside of 0\.25 to 0\.3 N"):
        continue_event(fold, paths, ((10.0, 18.0), (0.25, 0.3)))
    with pytest.raises(InputError, match="paths and box must be two each"):
        continue_event(fold, (paths[0], paths[0]), ((10.0, 18.0), (0.1, 0.3)))
    with pytest.raises(InputError, match="ranges must map two parameters"):
        orbit_chart(CAPSULE, ROUGH, {"drive.frequency": (2.0, 3.0)})
    with pytest.raises(InputError, match=r"initial\.xi is not a parameter"):
        orbit_chart(CAPSULE, ROUGH, {"drive.frequency": (14.0, 18.0), "xi": (0.0, 1e-3)})
