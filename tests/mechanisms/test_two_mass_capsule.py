"""A capsule with two inner masses: what it shares with one of one, and what only two can do."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from stickslip import Capsule, Coulomb, PendulumCart, TwoMassCapsule, simulate
from stickslip.data import load_rig
from stickslip.engine import Status
from stickslip.errors import ParameterError
from stickslip.mechanisms import InnerMass, Prescribed, SoftStop, Torque
from stickslip.mechanisms.drives import Rotation, Sine, SineSwing
from stickslip.study.sweep import periodic_orbit

G = 9.81
UP = 0.5 * math.pi
ROUGH = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)
STRUCK = InnerMass(
    mass=0.02, stiffness=60.0, damping=0.03, upper_stop=0.002, restitution=0.6,
    drive=Torque(drive=Sine(amplitude=0.2, frequency=13.0)),
)  # fmt: skip
LIFTED = InnerMass(
    mass=0.01, angle=UP, stiffness=90.0, damping=0.05,
    drive=Torque(drive=Sine(amplitude=0.15, frequency=13.0, phase=0.4)),
)  # fmt: skip
PAIR = TwoMassCapsule(capsule_mass=0.08, first=STRUCK, second=LIFTED)


def halved(one):
    """Return half of an inner mass: two of them, moving alike, are the whole."""
    drive = one.drive.drive
    return replace(
        one,
        mass=0.5 * one.mass,
        stiffness=0.5 * one.stiffness,
        damping=0.5 * one.damping,
        drive=Torque(drive=replace(drive, amplitude=0.5 * drive.amplitude)),
    )


@pytest.mark.parametrize("incline", [0.0, 0.1])
def test_two_halves_do_what_one_mass_does(incline):
    twin = TwoMassCapsule(
        capsule_mass=0.08, first=halved(STRUCK), second=halved(STRUCK), incline=incline, squeeze=0.1
    )
    alone = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, upper_stop=0.002,
        restitution=0.6, drive=STRUCK.drive, incline=incline, squeeze=0.1,
    )  # fmt: skip
    run, known = (simulate(one, ROUGH, t_end=0.6) for one in (twin, alone))
    assert run.certificate.certified
    # 8 impacts, one after the other in the twin: each doubles roundings a few times
    assert run["x"][-1] == pytest.approx(known["x"][-1], rel=1e-7)
    np.testing.assert_allclose(run["xi"], run["zeta"], atol=1e-9)


@pytest.mark.parametrize("damping", [0.0, 0.4])
def test_two_halves_with_soft_stops_do_what_one_mass_does(damping):
    lower, upper = (SoftStop(place=x, stiffness=3000.0, damping=damping) for x in (-2e-3, 2e-3))
    soft = replace(STRUCK, upper_stop=None, lower_soft_stop=lower, upper_soft_stop=upper)
    half = replace(
        halved(soft),
        lower_soft_stop=replace(lower, stiffness=1500.0, damping=0.5 * damping),
        upper_soft_stop=replace(upper, stiffness=1500.0, damping=0.5 * damping),
    )
    twin = TwoMassCapsule(capsule_mass=0.08, first=half, second=half)
    alone = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03, drive=STRUCK.drive,
        lower_soft_stop=lower, upper_soft_stop=upper,
    )  # fmt: skip
    run, known = (simulate(one, ROUGH, t_end=0.4) for one in (twin, alone))
    assert run.certificate.certified
    assert run["x"][-1] == pytest.approx(known["x"][-1], rel=1e-7)
    met, own = ([e.reason for e in one.events if "soft stop" in e.reason] for one in (run, known))
    assert len(own) > 10
    for whose in ("first", "second"):
        prefix = f"{whose} mass "
        assert [text.removeprefix(prefix) for text in met if text.startswith(prefix)] == own


def test_a_mass_that_moves_upwards_changes_the_normal_force():
    swing = Prescribed(profile=SineSwing(amplitude=0.004, frequency=6.0))
    pushed = Torque(drive=Sine(amplitude=3.0, frequency=6.0))
    body = TwoMassCapsule(
        capsule_mass=0.6,
        first=InnerMass(mass=0.2, stiffness=50.0, drive=pushed),
        second=InnerMass(mass=0.2, angle=UP, drive=swing),
        squeeze=0.5,
    )  # fmt: skip
    run = simulate(body, ROUGH, t_end=1.0)
    t = np.linspace(0.0, 1.0, 101)
    lifted = np.array([swing.profile.value(moment) for moment in t])
    np.testing.assert_allclose(run.at(t)["normal_force"], 1.0 * G + 0.5 + 0.2 * lifted, rtol=1e-11)
    np.testing.assert_allclose(run.at(t)["second_force"], 0.2 * (lifted + G), rtol=1e-9)


def test_it_lifts_off_where_the_mass_falls_faster_than_the_weight_holds():
    def body(share):
        amplitude = share * 1.0 * G / (0.4 * (2.0 * math.pi * 5.0) ** 2)
        swing = Prescribed(profile=SineSwing(amplitude=amplitude, frequency=5.0))
        return TwoMassCapsule(
            capsule_mass=0.5, first=InnerMass(mass=0.1, stiffness=10.0),
            second=InnerMass(mass=0.4, angle=UP, drive=swing),
        )  # fmt: skip

    assert simulate(body(0.999), ROUGH, t_end=1.0).status is Status.END_TIME
    above = simulate(body(1.001), ROUGH, t_end=1.0, throw=False)
    assert above.ending.startswith("Lift-off")
    # the normal force is 0 just before the top of the first swing, half a period after the start
    assert above.span[1] == pytest.approx(0.1, abs=0.003)


def test_small_friction_carries_it_as_averaging_says():
    """Quadrature gives no motion to first order; in phase, ``arcsin s = n sqrt(1 - s^2)``."""
    rate, arm = 45.0, 0.02
    n, largest = 0.1 * arm * rate**2 / (0.6 * G), 0.1 * arm * rate / 0.6
    known = largest * brentq(lambda s: math.asin(s) - n * math.sqrt(1.0 - s * s), 0.0, 1.0)
    motor = Prescribed(profile=Rotation(rate=rate))
    rotor = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=arm, pendulum=motor)
    orbit = periodic_orbit(rotor, Coulomb(kinetic_coefficient=0.003), settle=3000)
    assert orbit.mean_velocity["x"] == pytest.approx(known, rel=3e-4)

    def speed(mu):
        along, up = (
            Prescribed(profile=SineSwing(amplitude=a, frequency=8.0)) for a in (0.01, 0.005)
        )
        body = TwoMassCapsule(
            capsule_mass=0.6,
            first=InnerMass(mass=0.2, drive=along),
            second=InnerMass(mass=0.2, angle=UP, drive=up),
        )
        law = Coulomb(kinetic_coefficient=mu)
        return periodic_orbit(body, law, settle=int(30.0 / mu)).mean_velocity["x"]

    slow, quick = speed(0.01), speed(0.02)
    # the next order is a share of mu of it
    assert quick / slow == pytest.approx(2.0, rel=5e-3)
    assert 0.0 < slow < 0.02 * largest


def test_the_mirror_image_of_a_capsule_is_a_capsule():
    mirrored = replace(
        PAIR,
        first=replace(STRUCK, angle=math.pi),
        second=replace(LIFTED, angle=math.pi - 0.5 * math.pi),
    )
    run, image = (simulate(one, ROUGH, t_end=0.4) for one in (PAIR, mirrored))
    # cos(pi) is -1 and sin(pi) 1e-16
    assert image["x"][-1] == pytest.approx(-run["x"][-1], rel=1e-9)
    assert abs(run["x"][-1]) > 1e-4


def test_a_rig_file_has_a_table_for_each_mass(tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text(
        '[mechanism]\ntype = "two-mass-capsule"\ncapsule_mass = "80 g"\n'
        '[mechanism.first]\nmass = "20 g"\nstiffness = "60 N/m"\n'
        '[mechanism.second]\nmass = "10 g"\nangle = "90 deg"\n'
        "[friction.coulomb]\nkinetic_coefficient = 0.3\n"
    )
    assert load_rig(file).mechanism == TwoMassCapsule(
        capsule_mass=0.08,
        first=InnerMass(mass=0.02, stiffness=60.0),
        second=InnerMass(mass=0.01, angle=math.radians(90.0)),
    )


def test_stops_without_room_are_refused():
    narrow = replace(STRUCK, lower_stop=0.003)
    with pytest.raises(ParameterError, match="the upper stop of xi must lie above"):
        TwoMassCapsule(capsule_mass=0.08, first=narrow, second=LIFTED)
