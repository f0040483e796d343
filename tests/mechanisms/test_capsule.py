"""The capsule against closed forms of its three-phase drive, and its impacts."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tests.support import examples

from stickslip import Capsule, Coulomb, TwoMassCapsule, ensemble, simulate
from stickslip.engine import Status
from stickslip.errors import InputError, ParameterError
from stickslip.mechanisms import Coil, InnerMass, Prescribed, Torque
from stickslip.mechanisms.drives import Sine, Square, ThreePhase
from stickslip.study.sweep import energy_balance

G = 9.81
T = np.linspace(0.0, 2.0, 201)


def driven(share, mu, stroke, fast):
    """Return a capsule of 1 kg whose slow phase drives just at the break-away level."""
    slow = mu * G / share
    profile = ThreePhase(amplitude=0.5 * stroke, fast=fast, slow=slow, first="slow")
    motor = Prescribed(profile=profile)
    return Capsule(capsule_mass=1.0 - share, inner_mass=share, drive=motor), profile


def travel(share, mu, stroke, fast):
    """Return the travel of a cycle and its duration in closed form.

    The capsule stays while the inner mass goes slowly, and is thrown as it comes back: it gains
    speed for the fast phase and coasts to rest.
    """
    slow = mu * G / share
    rate = math.sqrt(2.0 * stroke / (1.0 / slow + 1.0 / fast))
    back = 2.0 * rate / fast
    gained = (share * fast - mu * G) * back
    return gained * back / 2.0 + gained**2 / (4.0 * mu * G), 2.0 * rate / slow + back


def test_the_published_capsule_travels_its_published_way():
    capsule, profile = driven(0.2, 0.2, 0.02, 50.0)
    run = simulate(capsule, Coulomb(kinetic_coefficient=0.2), t_end=5.0 * profile.period)
    x = run.at(profile.period * np.arange(6))["x"]
    assert np.diff(x).round(7).tolist() == [0.0064304] * 5
    assert round(float(x[-1] / (5.0 * profile.period)), 6) == 0.046037
    assert run.certificate.energy_error < 1e-9


@examples(40)
@given(
    share=st.floats(0.05, 0.6),
    mu=st.floats(0.05, 0.8),
    stroke=st.floats(0.005, 0.2),
    faster=st.floats(3.0, 12.0),
)
def test_three_phases_carry_any_capsule_as_the_closed_form_says(share, mu, stroke, faster):
    capsule, profile = driven(share, mu, stroke, faster * mu * G / share)
    expected, period = travel(share, mu, stroke, faster * mu * G / share)
    run = simulate(capsule, Coulomb(kinetic_coefficient=mu), t_end=2.0 * period)
    assert profile.period == pytest.approx(period, rel=1e-14)
    x = run.at([period, 2.0 * period])["x"]
    # modes of constant acceleration are exact; the slow phase balances up to roundings of forces,
    # which may let the capsule creep by 1e-15 of what the forces would do alone
    assert x[0] == pytest.approx(expected, rel=1e-9)
    assert x[1] == pytest.approx(2.0 * expected, rel=1e-9)


def test_a_faster_return_nears_twice_the_share_of_the_stroke():
    far, _ = travel(0.2, 0.2, 0.02, 1e9)
    assert far == pytest.approx(2.0 * 0.2 * 0.02, rel=1e-4)  # the rest falls as w1 / w2 does: 1e-8
    capsule, profile = driven(0.2, 0.2, 0.02, 1e7)
    run = simulate(capsule, Coulomb(kinetic_coefficient=0.2), t_end=float(profile.period))
    assert float(run["x"][-1]) == pytest.approx(0.008, rel=1e-5)


def test_without_friction_the_common_centre_stays_where_it_was():
    capsule = Capsule(
        capsule_mass=0.7, inner_mass=0.3, stiffness=40.0, damping=0.2,
        drive=Torque(drive=Sine(amplitude=1.0, frequency=2.0)),
    )  # fmt: skip
    run = simulate(capsule, Coulomb(kinetic_coefficient=0.0), t_end=4.0)
    centre = run["x"] + 0.3 * run["xi"]
    assert np.abs(centre).max() < 1e-11  # a hundred local errors of 1e-12 of 0.1 m


def test_the_mirrored_drive_mirrors_the_motion():
    capsule = Capsule(
        capsule_mass=0.7, inner_mass=0.3, stiffness=40.0,
        drive=Torque(drive=Sine(amplitude=3.0, frequency=1.7, phase=0.4)),
    )  # fmt: skip
    law = Coulomb(kinetic_coefficient=0.15, static_coefficient=0.2)
    other = replace(capsule, drive=Torque(drive=Sine(amplitude=-3.0, frequency=1.7, phase=0.4)))
    there, back = (simulate(one, law, t_end=3.0) for one in (capsule, other))
    assert len(there.events) == len(back.events) > 4
    t = np.linspace(0.0, 3.0, 50)
    # the same operations with other signs, but for the rounding of sums
    np.testing.assert_allclose(there.at(t)["x"], -back.at(t)["x"], atol=1e-12)


def test_a_vibro_impact_capsule_strikes_its_stops_and_keeps_its_momentum():
    capsule = Capsule(
        capsule_mass=0.6, inner_mass=0.4, lower_stop=-0.01, upper_stop=0.02, restitution=0.7
    )
    free = Coulomb(kinetic_coefficient=0.0)
    run = simulate(capsule, free, t_end=0.4, y0={"xi_dot": 0.5}, throw=False)
    assert run.status is Status.END_TIME
    hits = [event for event in run.events if event.reason == "xi hits stop"]
    # 20 mm at 0.5 m/s, then 30 mm each at 0.7 of the speed before
    times = 0.04 + np.cumsum([0.0, 0.03 / 0.35, 0.03 / 0.245])
    assert [event.t for event in hits[:3]] == pytest.approx(times.tolist(), rel=1e-12)
    momentum = 0.6 * run["v"] + 0.4 * (run["v"] + run["xi_dot"])
    np.testing.assert_allclose(momentum, 0.2, rtol=1e-13)
    assert run["xi"].max() <= 0.02 + 1e-15


def test_a_prescribed_motion_and_a_hard_stop_exclude_each_other():
    capsule, _ = driven(0.2, 0.2, 0.02, 50.0)
    stopped = replace(capsule, upper_stop=0.02, restitution=0.5)
    with pytest.raises(InputError, match="motion of xi is prescribed"):
        simulate(stopped, Coulomb(kinetic_coefficient=0.2), t_end=1.0)


# -- an inner mass on an inclined line, and a coil


def test_a_vertical_inner_mass_shakes_the_normal_force():
    # it hangs on its spring, whose force is what the capsule feels
    body = Capsule(capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, angle=0.5 * math.pi)
    run = simulate(body, Coulomb(kinetic_coefficient=0.3), t_end=1.0, y0={"xi": -1e-2})
    rest, omega, t = -0.02 * G / 60.0, math.sqrt(60.0 / 0.02), np.linspace(0.0, 1.0, 97)
    place = rest + (-1e-2 - rest) * np.cos(omega * t)
    seen = run.at(t)
    np.testing.assert_allclose(seen["xi"], place, atol=1e-12)
    np.testing.assert_allclose(seen["normal_force"], 0.08 * G - 60.0 * place, atol=1e-10)
    assert not seen["x"].any()


def test_an_inclined_inner_mass_is_two_halves_of_it():
    law = Coulomb(kinetic_coefficient=0.05, static_coefficient=0.06)
    push = Sine(amplitude=0.15, frequency=5.0)
    body = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, incline=0.01,
        drive=Torque(drive=push), angle=1.0,
    )  # fmt: skip
    half = InnerMass(
        mass=0.01, stiffness=30.0, damping=0.015, angle=1.0,
        drive=Torque(drive=replace(push, amplitude=0.075)),
    )  # fmt: skip
    halves = TwoMassCapsule(capsule_mass=0.08, first=half, second=half, incline=0.01)
    one, two = (simulate(rig, law, t_end=2.0) for rig in (body, halves))
    assert abs(one["x"][-1]) > 1e-3
    for name in ("x", "xi", "v", "normal_force"):
        np.testing.assert_allclose(one.at(T)[name], two.at(T)[name], atol=1e-9)
    assert energy_balance(body, one).mismatch < 1e-9


def test_a_force_from_outside_along_an_inclined_line_presses_the_capsule():
    pull = Torque(drive=Square(high=0.05, low=0.05, period=1.0, duty=0.5))
    body = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, drive=pull, angle=0.7,
        drive_on="inner mass",
    )  # fmt: skip
    resting = {"xi": (0.05 - 0.02 * G * math.sin(0.7)) / 60.0}
    run = simulate(body, Coulomb(kinetic_coefficient=0.3), t_end=0.5, y0=resting)
    weight = 0.1 * G - 0.05 * math.sin(0.7)
    np.testing.assert_allclose(run["normal_force"], weight, rtol=1e-12)
    np.testing.assert_allclose(run["friction"], 0.05 * math.cos(0.7), rtol=1e-9)


@pytest.mark.parametrize("stops", [{"lower_stop": -0.07}, {"upper_stop": 0.07}])
def test_a_hard_stop_off_the_line_of_the_ground_is_refused(stops):
    # a blow would lift the capsule, which goes on as if the ground held it
    struck = Capsule(capsule_mass=0.1, inner_mass=0.2, stiffness=20.0, **stops)
    mass = InnerMass(mass=0.2, stiffness=20.0, **stops)
    pair = TwoMassCapsule(capsule_mass=0.1, first=mass, second=InnerMass(mass=0.1, angle=1.2))
    for refused in (
        lambda: replace(struck, angle=1.2),
        lambda: replace(pair, second=replace(mass, angle=1.2)),
    ):
        with pytest.raises(ParameterError, match=r"angle \(alpha\) of 1\.2 rad.*Use soft stops"):
            refused()
    law = Coulomb(kinetic_coefficient=0.2)
    for rig, path in ((struck, "angle"), (pair, "first.angle")):
        along = {f"mechanism.{path}": [0.0, math.pi]}
        complete = [status.complete for status in ensemble(rig, law, along, t_end=0.1).status]
        assert complete == [True, True]
        with pytest.raises(ParameterError, match=r"angle \(alpha\) of 0\.3 rad"):
            ensemble(rig, law, {f"mechanism.{path}": [0.0, 0.3]}, t_end=0.1)


def test_dimensionless_numbers_are_those_of_a_constant_force_over_a_constant_friction():
    drive = Sine(amplitude=0.2, frequency=8.0)
    plain = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, drive=Torque(drive=drive)
    )  # fmt: skip
    known = plain.dimensionless_numbers(0.2)
    coil = replace(plain, drive=Coil(radius=0.01, drive=drive))
    assert coil.dimensionless_numbers(0.2) == {n: x for n, x in known.items() if n != "alpha"}
    with pytest.raises(InputError, match=r"angle \(alpha\) of 1\.2 rad varies"):
        replace(plain, angle=1.2).dimensionless_numbers(0.2)


def test_a_coil_gives_the_inner_mass_the_energy_of_its_closed_form():
    # the integral of u (1 + u^2)^(-5/2) is -(1 + u^2)^(-3/2) / 3
    force, radius, begin = 0.3, 0.01, 1e-3
    coil = Coil(radius=radius, drive=Square(high=force, low=force, period=1.0, duty=0.5))
    body = Capsule(capsule_mass=0.8, inner_mass=0.02, drive=coil)
    run = simulate(body, Coulomb(kinetic_coefficient=2.0), t_end=0.3, y0={"xi": begin})
    seen = run.at(np.linspace(0.0, 0.3, 31))
    shape = (1.0 + (np.array([begin]) / radius) ** 2) ** -1.5
    shape = shape - (1.0 + (seen["xi"] / radius) ** 2) ** -1.5
    work = force * radius * shape / 3.0 / (16.0 / (25.0 * math.sqrt(5.0)))
    np.testing.assert_allclose(0.5 * 0.02 * seen["xi_dot"] ** 2, work, atol=1e-11)
    assert seen["xi"][-1] > 3.0 * radius
    assert energy_balance(body, run).mismatch < 1e-9
