"""Multipliers of orbits under feedback with a delay of whole periods (Pyragas)."""

import cmath
import math
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Capsule, Coulomb, TowedBlock, simulate
from stickslip.errors import InputError
from stickslip.mechanisms import SoftStop, Torque
from stickslip.mechanisms.drives import DelayedFeedback, Sine
from stickslip.study.sweep import continue_orbit, periodic_orbit

FREE = Coulomb(kinetic_coefficient=0.0)
ROUGH = Coulomb(kinetic_coefficient=0.2, static_coefficient=0.25)
K, C, F = 10.0, 0.2, 0.7


def oscillator(gain, delay, **settings):
    fed = DelayedFeedback(state="x", gain=gain, delay=delay)
    return Axis(
        inertia=1.0,
        stiffness=K,
        damping=C,
        drive=Sine(amplitude=1.0, frequency=F) + fed,
        **settings,
    )


def _rounded(m):
    return complex(round(m.real, 4), round(m.imag, 4))


@pytest.mark.parametrize(("gain", "periods"), [(-1.5, 1), (2.0, 1), (-0.4, 2)])
def test_multipliers_of_a_linear_oscillator_solve_its_characteristic_equation(gain, periods):
    orbit = periodic_orbit(oscillator(gain, periods / F), FREE)
    bare = periodic_orbit(
        replace(oscillator(gain, 1.0), drive=Sine(amplitude=1.0, frequency=F)), FREE
    )
    assert orbit.start == pytest.approx(bare.start, rel=1e-9)

    def lack(exponent):
        return exponent**2 + C * exponent + K - gain * (cmath.exp(-periods * exponent / F) - 1.0)

    roots = set()
    for re in np.linspace(-0.45, 0.45, 10):
        for im in np.linspace(-20.0, 20.0, 81):
            s = complex(re, im)
            for _ in range(60):
                slope = (lack(s + 1e-7) - lack(s - 1e-7)) / 2e-7
                s -= lack(s) / slope if slope else 0.0
                if not abs(s) < 1e3:
                    break
            if abs(s) < 1e3 and abs(lack(s)) < 1e-9 and abs(cmath.exp(s / F)) > 0.52:
                roots.add(complex(round(s.real, 6), round(s.imag, 6)))
    expected = {
        complex(round(m.real, 4), round(m.imag, 4)) for m in (cmath.exp(s / F) for s in roots)
    }
    found = {
        complex(round(m.real, 4), round(m.imag, 4)) for m in orbit.multipliers if abs(m) > 0.52
    }
    assert found == expected
    assert found


def capsule(gain=None, frequency=2.65):
    force = Sine(amplitude=0.2, frequency=frequency)
    if gain is not None:
        force = force + DelayedFeedback(state="xi_dot", gain=gain, delay=1.0 / frequency)
    return Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.03,
        upper_soft_stop=SoftStop(place=2e-3, stiffness=3000.0, damping=0.1),
        drive=Torque(drive=force), drive_on="inner mass",
    )  # fmt: skip


@pytest.mark.slow
def test_delayed_feedback_keeps_an_unstable_orbit_of_a_capsule_and_makes_it_stable():
    settled = periodic_orbit(capsule(frequency=2.55), ROUGH, settle=200)
    (bare,) = continue_orbit(settled, "frequency", (2.54, 2.65)).orbits_at(2.65)[-1:]
    assert bare.multipliers[0].real == pytest.approx(-1.3074, abs=1e-4)
    orbit = periodic_orbit(capsule(0.02), ROUGH, start=bare.start, settle=0)
    assert orbit.start == pytest.approx(bare.start, abs=1e-9)
    assert orbit.stable
    largest = orbit.multipliers[0]
    assert largest.imag == 0.0
    # a run that begins beside it comes nearer by that in each period
    begin = dict(orbit.start) | {"xi_dot": 1.02 * orbit.start["xi_dot"]}
    turns = np.arange(13) * orbit.period
    run = simulate(capsule(0.02), ROUGH, t_end=turns[-1], y0=begin)
    gap = run.at(turns)["xi"] - orbit.start["xi"]
    shrinks = -math.sqrt(gap[-1] / gap[-3])  # of two periods, as two kinds of past take turns
    assert shrinks == pytest.approx(largest.real, abs=0.01)
    assert run.certificate.certified
    with pytest.raises(InputError, match="under delayed feedback are those without it"):
        continue_orbit(orbit, "frequency", (2.6, 2.7))


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: periodic_orbit(oscillator(1.0, 0.3), FREE), "0.21 periods of the orbit"),
        (lambda: periodic_orbit(oscillator(1.0, 1.01 / F), FREE), "1.01 periods of the orbit"),
        (
            lambda: periodic_orbit(
                replace(
                    capsule(frequency=2.55),
                    drive=Torque(
                        drive=Sine(amplitude=0.2, frequency=2.55)
                        + DelayedFeedback(state="x", gain=1.0, delay=1.0 / 2.55)
                    ),
                ),
                ROUGH,
            ),
            "x advances by .* follow a state that comes back",
        ),
        (
            lambda: periodic_orbit(
                TowedBlock(
                    mass=1.0,
                    stiffness=1.0,
                    speed=0.1,
                    load=1.0,
                    modulation=DelayedFeedback(state="v", gain=0.01, delay=13.5),
                ),
                Coulomb(kinetic_coefficient=1.0, static_coefficient=1.5),
            ),
            "driven orbits alone",
        ),
    ],
)
def test_delays_that_leave_feedback_are_refused(call, message):
    with pytest.raises(InputError, match=message):
        call()
