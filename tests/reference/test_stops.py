"""Hard stops against closed forms.

Times and places are those of constant accelerations and of springs between impacts. Linear modes
are exact, so that a dozen impacts leave some dozen roundings.
"""

import math

import numpy as np
import pytest

from stickslip import Axis, Coulomb, Dahl, LuGre, SpringBlock, simulate
from stickslip.engine import Status
from stickslip.mechanisms.drives import Pulse, Ramp, Sine

SMOOTH = Coulomb(kinetic_coefficient=0.0)
G = 9.81


def times_of(run, reason):
    return np.array([event.t for event in run.events if event.reason == reason])


def test_without_friction_each_crossing_takes_longer_by_the_restitution():
    rig = Axis(inertia=1.0, lower_stop=-1.0, upper_stop=2.0, restitution=0.8)
    run = simulate(rig, SMOOTH, t_end=20.0, y0={"v": 1.0})
    crossings = 3.0 / 0.8 ** np.arange(1, 4)
    expected = 2.0 + np.concatenate(([0.0], np.cumsum(crossings)))
    np.testing.assert_allclose(times_of(run, "hits stop"), expected, rtol=2e-14)
    assert run["v"][-1] == pytest.approx(0.8**4, rel=2e-14)
    assert run.certificate.work_stops == pytest.approx(0.5 * (1 - 0.8**8), rel=2e-14)


def test_elastic_stops_take_nothing():
    rig = Axis(inertia=2.0, lower_stop=-1.0, upper_stop=1.0, restitution=1.0)
    run = simulate(rig, SMOOTH, t_end=100.0, y0={"v": 3.0})
    assert len(run.events) == 150
    assert abs(run["v"][-1]) == pytest.approx(3.0, rel=2e-14)
    assert run.certificate.work_stops == 0


def test_with_coulomb_friction_speeds_and_times_are_those_of_constant_braking():
    f, e = 0.3, 0.8
    rig = Axis(inertia=1.0, lower_stop=-1.0, upper_stop=2.0, restitution=e)
    run = simulate(rig, Coulomb(kinetic_coefficient=f), t_end=20.0, y0={"v": 4.0})
    speed, t, expected, lost = 4.0, 0.0, [], 0.0
    distance = 2.0
    while speed**2 > 2 * f * distance:
        hit = math.sqrt(speed**2 - 2 * f * distance)
        t += (speed - hit) / f
        expected.append(t)
        lost += 0.5 * (1 - e**2) * hit**2
        speed, distance = e * hit, 3.0
    np.testing.assert_allclose(times_of(run, "hits stop"), expected, rtol=2e-14)
    assert run.events[-1].reason == "stop"
    assert run.events[-1].t == pytest.approx(t + speed / f, rel=2e-14)
    side = 1 if len(expected) % 2 == 0 else -1
    last = (2.0 if side < 0 else -1.0) + side * speed**2 / (2 * f)
    assert run["x"][-1] == pytest.approx(last, rel=2e-14)
    assert run.certificate.work_stops == pytest.approx(lost, rel=2e-14)


def test_a_spring_presses_the_block_to_an_inelastic_stop_for_good():
    m, k, c, mu, stop = 1.5, 100.0, 0.3, 0.25, 0.2
    rig = SpringBlock(mass=m, stiffness=k, compression=c, upper_stop=stop)
    run = simulate(rig, Coulomb(kinetic_coefficient=mu), t_end=5.0)
    assert [event.reason for event in run.events] == ["hits stop"]
    assert run.events[0].to_mode == 2
    assert run.status is Status.AT_REST
    energy = 0.5 * k * (c**2 - (c - stop) ** 2) - mu * m * G * stop
    assert run.certificate.work_stops == pytest.approx(energy, rel=2e-14)
    # from rest at x = 0 the block swings about the place where the spring holds friction
    w, middle = math.sqrt(k / m), c - mu * m * G / k
    hit = math.acos(1 - stop / middle) / w
    assert run.events[0].t == pytest.approx(hit, rel=2e-14)
    later = run.at([hit + 0.1, 5.0])
    assert np.all(later["x"] == stop)
    assert np.all(later["v"] == 0)
    # the spring pushes with 10 N; friction holds what it can of that, the stop the rest
    np.testing.assert_allclose(later["friction"], mu * m * G, rtol=2e-14)


def test_a_body_leaves_its_stop_when_the_drive_pulls_harder_than_friction_holds():
    amplitude, f, level = 3.0, 0.5, 1.5
    rig = Axis(inertia=1.0, drive=Sine(amplitude=amplitude, frequency=f), upper_stop=0.1)
    law = Coulomb(kinetic_coefficient=1.0, static_coefficient=level)
    run = simulate(rig, law, t_end=1.5)
    assert [event.reason for event in run.events] == ["break-away", "hits stop", "leaves stop"]
    leaves = (math.pi + math.asin(level / amplitude)) / (2 * math.pi * f)
    assert run.events[-1].t == pytest.approx(leaves, rel=2e-14)
    t = np.linspace(run.events[1].t, leaves, 101)[1:-1]
    pressed = run.at(t)
    push = amplitude * np.sin(2 * math.pi * f * t)
    assert np.all(pressed["mode"] == 2)
    np.testing.assert_allclose(pressed["friction"], np.minimum(push, level), atol=1e-12)


def test_no_push_towards_the_stop_is_an_event():
    rig = Axis(inertia=1.0, drive=Ramp(rate=-100.0), lower_stop=0.0)
    run = simulate(rig, Coulomb(kinetic_coefficient=1.0), t_end=10.0)
    assert run.events == ()
    assert np.all(run["mode"] == -2)
    assert run["friction"][-1] == -1.0


def test_a_pulse_away_from_the_stop_that_friction_holds_moves_nothing():
    push = Pulse(level=-1.4, duration=1.0, start=1.0)
    rig = Axis(inertia=1.0, drive=push, offset=-0.5, upper_stop=0.0)
    run = simulate(rig, Coulomb(kinetic_coefficient=1.0), t_end=3.0)
    assert run.events == ()
    stronger = Axis(
        inertia=1.0, drive=push + Pulse(level=-0.2, duration=1.0, start=1.0), offset=-0.5,
        upper_stop=0.0,
    )  # fmt: skip
    run = simulate(stronger, Coulomb(kinetic_coefficient=1.0), t_end=3.0)
    assert run.events[0].reason == "leaves stop"
    assert run.events[0].t == 1.0


@pytest.mark.parametrize("restitution", [0.1, 0.5, 0.9])
def test_bounces_that_accumulate_end_pressed_at_the_time_of_the_series(restitution):
    rig = Axis(inertia=2.0, offset=2.0 * G, lower_stop=0.0, restitution=restitution)
    run = simulate(rig, SMOOTH, t_end=50.0, y0={"x": 1.0})
    fall, hit = math.sqrt(2 / G), math.sqrt(2 * G)
    end = fall + 2 * hit * restitution / (G * (1 - restitution))
    assert run.events[-1].to_mode == -2
    # bounces are cut off at 1e-9 of the largest speed
    assert run.events[-1].t == pytest.approx(end, rel=2e-9)
    assert run.status is Status.AT_REST
    assert run["x"][-1] == 0
    # each of up to two hundred impacts is located to rounding of the time
    assert run.certificate.work_stops == pytest.approx(2.0 * G, rel=1e-12)


@pytest.mark.parametrize("place", [1.0, 1000.0])
def test_bounces_far_from_zero_end_where_their_height_is_lost_in_rounding(place):
    rig = Axis(inertia=1.0, offset=-G, upper_stop=place, restitution=0.7)
    run = simulate(rig, SMOOTH, t_end=50.0, y0={"x": place - 1.0})
    end = math.sqrt(2 / G) * (1 + 2 * 0.7 / 0.3)
    assert run.events[-1].to_mode == 2
    # a dozen roundings of the place are a height, and times go with its root
    assert run.events[-1].t == pytest.approx(end, rel=10 * math.sqrt(1e-15 * place))


def test_friction_shortens_the_bounces_by_its_own_ratio():
    f, e = 0.2 * G, 0.9
    rig = Axis(inertia=1.0, offset=G, lower_stop=0.0, restitution=e)
    run = simulate(rig, Coulomb(kinetic_coefficient=f), t_end=50.0, y0={"x": 1.0})
    hit = math.sqrt(2 * (G - f))
    ratio = e * math.sqrt((G - f) / (G + f))  # rises against both, falls against friction
    bounce = e * hit / (G + f) + ratio * hit / (G - f)
    end = hit / (G - f) + bounce / (1 - ratio)
    assert run.events[-1].t == pytest.approx(end, rel=2e-9)
    assert run.events[-1].to_mode == -2


def test_a_body_that_begins_at_its_stop_with_speed_into_it_bounces_at_once():
    rig = Axis(inertia=1.0, lower_stop=0.0, restitution=0.5)
    run = simulate(rig, SMOOTH, t_end=2.0, y0={"v": -1.0})
    assert [(event.t, event.reason) for event in run.events] == [(0.0, "hits stop")]
    assert run["x"][-1] == pytest.approx(1.0, rel=2e-14)


@pytest.mark.parametrize(
    "law",
    [
        Dahl(kinetic_coefficient=1.0, bristle_stiffness=1e4),
        LuGre(
            kinetic_coefficient=1.0, static_coefficient=1.5, stribeck_velocity=0.001,
            bristle_stiffness=1e4, bristle_damping=100.0, fading_exponent=1.5,
        ),
    ],
    ids=lambda law: law.name,
)  # fmt: skip
def test_bent_bristles_push_a_body_off_its_stop(law):
    rig = Axis(inertia=1.0, drive=Sine(amplitude=3.0, frequency=0.5), upper_stop=0.1)
    run = simulate(rig, law, t_end=1.0)
    assert [event.reason for event in run.events] == ["hits stop", "leaves stop"]
    # bent by steady sliding, they hold back with the kinetic level: 3 sin(pi t) falls to it
    leaves = 1 - math.asin(1 / 3) / math.pi
    assert run.events[-1].t == pytest.approx(leaves, rel=1e-6)  # their tolerance is 1e-8 a step


def test_held_bristles_keep_a_body_at_its_stop_up_to_break_away():
    rig = Axis(inertia=1.0, drive=Sine(amplitude=3.0, frequency=0.5), upper_stop=0.1)
    law = Dahl(kinetic_coefficient=1.0, bristle_stiffness=1e4, static_switch=True)
    run = simulate(rig, law, t_end=1.5)
    assert run.events[-1].reason == "leaves stop"
    leaves = 1 + math.asin(1 / 3) / math.pi
    assert run.events[-1].t == pytest.approx(leaves, rel=2e-14)
