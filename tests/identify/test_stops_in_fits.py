"""Fits of records with impacts: a capsule filmed by a camera, and what starts at its stop."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Capsule, Coulomb, Measurement, fit, simulate
from stickslip.identify.fits.parameters import FreeParameter, FreeParameters
from stickslip.identify.fits.shooting.multiple_shooting import Segment, Shooting
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import Sine
from stickslip.quantities import fields_of

CAPSULE = Capsule(
    capsule_mass=0.8, inner_mass=0.2, stiffness=40.0, damping=0.2, lower_stop=-0.02,
    upper_stop=0.015, restitution=0.6, drive=Torque(drive=Sine(amplitude=3.0, frequency=4.0)),
)  # fmt: skip
FRAMES, NOISE = 120.0, 50e-6
LEVEL = "friction.kinetic_coefficient"


def filmed(rig, level, seed, t_end=2.0):
    """Return positions of the frames of a camera, with its noise."""
    t = np.arange(round(FRAMES * t_end) + 1) / FRAMES
    run = simulate(rig, Coulomb(kinetic_coefficient=level), t_end=float(t[-1]))
    assert sum("hits stop" in event.reason for event in run.events) > 15
    noise = np.random.default_rng(seed).normal(0.0, NOISE, len(t))
    return Measurement(time=t, position=run.at(t)["x"] + noise)


def level_of(rig, record):
    """Return the estimate of the level from a start that is a third off."""
    return fit(rig, Coulomb(kinetic_coefficient=0.16), record).estimate(LEVEL)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(20))
def test_the_friction_of_a_filmed_capsule_with_stops_is_found(seed):
    level = level_of(CAPSULE, filmed(CAPSULE, 0.23, seed))
    # four standard errors, from half the width of the 95 % interval: 1 of 16,000 by chance
    assert abs(level.value - 0.23) <= 2.0 * (level.high - level.low) / 2.0
    assert level.high - level.low < 0.01


@pytest.mark.slow
def test_the_way_down_does_not_end_in_the_valley_of_another_sequence_of_impacts():
    rig = replace(
        CAPSULE, capsule_mass=1.3, inner_mass=0.45, stiffness=15.0, damping=0.05, restitution=0.85,
        drive=Torque(drive=Sine(amplitude=5.5, frequency=3.0)),
    )  # fmt: skip
    level = level_of(rig, filmed(rig, 0.2, 1))
    assert level.low < 0.2 < level.high
    assert level.value == pytest.approx(0.2, rel=0.01)


def shooting(rig, times, measured, guess):
    """Return runs of one segment in which the level of friction is looked for."""
    item = FreeParameter(
        path=LEVEL, quantity=fields_of(Coulomb)["kinetic_coefficient"], start=0.4, low=0.0
    )
    segment = Segment(
        record=0, start=0.0, mechanism=rig, times=times, measured=measured, guess=guess,
        known=np.array([True, True]),
    )  # fmt: skip
    law = Coulomb(kinetic_coefficient=0.4)
    return Shooting(law=law, free_parameters=FreeParameters((item,)), segments=(segment,))


def test_slopes_that_a_run_does_not_have_are_differences_and_never_zero():
    # the run begins at its stop with a speed into it, before which nothing is known
    rig = Axis(inertia=1.0, load=1.0, offset=1.0, lower_stop=0.0, restitution=0.9)
    times = np.linspace(0.0, 0.5, 26)
    start = {"x": 0.0, "v": -1.0}
    law = Coulomb(kinetic_coefficient=0.4)
    run = simulate(rig, law, t_end=0.5, y0=start).at(times)
    assert np.isnan(run.sensitivity("x", LEVEL)).all()
    problem = shooting(rig, times, run["x"], np.array([0.0, -1.0]))
    slopes = problem.linearise(np.array([0.4])).slopes[:, 0]
    # it rises from 0.9 m/s, braked by 1.4 m/s^2; the difference is of 1e-5 of the level
    np.testing.assert_allclose(slopes, -0.5 * times**2, atol=1e-9)


def test_what_noise_puts_beyond_its_stop_begins_at_it():
    rig = Axis(inertia=1.0, load=1.0, offset=1.0, lower_stop=0.0, restitution=0.9)
    times = np.linspace(0.0, 0.5, 26)
    problem = shooting(rig, times, np.zeros(26), np.array([-1e-4, 0.0]))
    seen = problem.linearise(np.array([0.4]))
    assert np.abs(seen.residual).max() == 0.0
