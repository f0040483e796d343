"""Half-sine pulses in runs: closed forms, slopes by their parameters, and what they cannot be."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.exports.fmus import made, need_tools
from tests.exports.test_fmu import compare

from stickslip import Axis, Capsule, Coulomb, EventDriven, ensemble, simulate
from stickslip.data import load_rig
from stickslip.errors import ParameterError
from stickslip.mechanisms import Torque
from stickslip.mechanisms.drives import HalfSine, Sine, Sum
from stickslip.study.sweep import periodic_orbit

BLOWS = HalfSine(amplitude=2.0, period=0.5, duty=0.2)
SMOOTH = Coulomb(kinetic_coefficient=0.0)
ROUGH = Coulomb(kinetic_coefficient=0.3, static_coefficient=0.4)


def test_without_friction_each_pulse_gives_its_impulse():
    run = simulate(Axis(inertia=1.5, drive=BLOWS), SMOOTH, t_end=2.4)
    impulse = 2.0 * 2.0 * 0.2 * 0.5 / math.pi
    assert BLOWS.mean * 0.5 == pytest.approx(impulse, rel=1e-15)
    after = run.at(0.5 * np.arange(5) + 0.1)["v"]
    # steps of high order are exact to a few hundred roundings
    np.testing.assert_allclose(after, impulse / 1.5 * np.arange(1, 6), rtol=1e-12)


def test_a_body_breaks_away_where_the_pulse_exceeds_friction_and_coasts_to_rest():
    run = simulate(Axis(inertia=1.0, drive=BLOWS), ROUGH, t_end=0.5)
    first, stop = run.events[:2]
    assert first.reason == "break-away"
    begins = 0.1 / math.pi * math.asin(0.4 / 2.0)
    assert first.t == pytest.approx(begins, rel=1e-10)
    speed = 2.0 * 0.1 / math.pi * (math.cos(math.pi * begins / 0.1) + 1.0) - 0.3 * (0.1 - begins)
    assert stop.t == pytest.approx(0.1 + speed / 0.3, rel=1e-10)


def test_a_linear_oscillator_answers_as_the_fourier_series_says():
    m, c, k = 0.5, 2.0, 300.0
    axis = Axis(inertia=m, stiffness=k, damping=c, drive=BLOWS)
    run = simulate(axis, SMOOTH, t_end=20.5)
    t = np.linspace(20.0, 20.5, 40)  # transients have fallen by exp(-c t / 2 m) = 1e-17
    x, duty = np.full_like(t, BLOWS.mean / k), BLOWS.duty
    for n in range(1, 2000):
        w = 2.0 * math.pi * n / BLOWS.period
        level = 4.0 * BLOWS.amplitude * duty / math.pi * math.cos(math.pi * n * duty)
        level /= 1.0 - (2.0 * n * duty) ** 2
        force = level * np.exp(1j * w * (t - 0.5 * duty * BLOWS.period))
        x += np.real(force / (k - m * w * w + 1j * c * w))
    # the rest of the series falls as n^-4
    np.testing.assert_allclose(run.at(t)["x"], x, atol=1e-8 * np.abs(x).max())


def test_both_tiers_give_the_same_bits_and_the_mirror_image_is_a_run():
    axis = Axis(inertia=1.0, stiffness=40.0, drive=BLOWS)
    plain, fast = (
        simulate(axis, ROUGH, t_end=3.0, solver=EventDriven(tier=tier))
        for tier in ("python", "compiled")
    )
    back = simulate(replace(axis, drive=replace(BLOWS, amplitude=-2.0)), ROUGH, t_end=3.0)
    assert fast.certificate == plain.certificate
    assert fast.certificate.certified
    for name in ("x", "v"):
        np.testing.assert_array_equal(fast[name], plain[name])
        np.testing.assert_array_equal(back[name], -fast[name])


def test_ensembles_and_slopes_by_its_parameters():
    axis = Axis(inertia=1.0, stiffness=40.0, drive=BLOWS)
    values = np.linspace(0.15, 0.35, 6)
    found = ensemble(axis, ROUGH, {"mechanism.drive.duty": values}, t_end=1.7)
    for duty, x in zip(values, found["x"], strict=True):
        alone = simulate(replace(axis, drive=replace(BLOWS, duty=float(duty))), ROUGH, t_end=1.7)
        assert x == pytest.approx(alone["x"][-1], rel=1e-12)
    run = simulate(axis, ROUGH, t_end=1.7)
    for name in ("amplitude", "period", "duty"):
        value = getattr(BLOWS, name)
        ends = [
            simulate(
                replace(axis, drive=replace(BLOWS, **{name: value * (1.0 + d)})), ROUGH, t_end=1.7
            )["x"][-1]
            for d in (-1e-5, 1e-5)
        ]
        difference = (ends[1] - ends[0]) / (2e-5 * value)
        slope = run.sensitivity("x", f"mechanism.drive.{name}")[-1]
        assert slope == pytest.approx(difference, rel=1e-5)


def test_a_capsule_has_the_period_of_the_pulses():
    capsule = Capsule(
        capsule_mass=0.08, inner_mass=0.02, stiffness=60.0, damping=0.1,
        drive=Torque(drive=HalfSine(amplitude=0.6, period=0.12, duty=0.3)),
    )  # fmt: skip
    orbit = periodic_orbit(capsule, Coulomb(kinetic_coefficient=0.2))
    assert orbit.period == pytest.approx(0.12, rel=1e-15)
    run = simulate(capsule, Coulomb(kinetic_coefficient=0.2), t_end=60 * 0.12)
    first, last = run.at([59 * 0.12, 60 * 0.12])["x"]
    assert orbit.advance["x"] == pytest.approx(last - first, rel=1e-7)
    assert abs(orbit.advance["x"]) > 1e-4


def test_a_rig_file_names_it(tmp_path):
    file = tmp_path / "rig.toml"
    file.write_text(
        '[mechanism]\ntype = "axis"\ninertia = "1 kg"\n'
        '[mechanism.drive]\ntype = "half-sine"\namplitude = "2 N"\nperiod = "0.5 s"\nduty = 0.2\n'
        "[friction.coulomb]\nkinetic_coefficient = 0.3\n"
    )
    assert load_rig(file).mechanism.drive == BLOWS


def test_it_is_not_added_to_other_drives():
    with pytest.raises(ParameterError, match="HalfSine, whose pieces are a phase"):
        BLOWS + Sine(amplitude=1.0, frequency=1.0)
    with pytest.raises(ParameterError, match="Give it alone"):
        Sum(parts=(BLOWS,))


def test_an_fmu_has_the_bits_of_the_engine(tmp_path):
    need_tools()
    axis = Axis(inertia=1.0, stiffness=40.0, drive=BLOWS)
    compare(made(tmp_path, "blows", axis, ROUGH), tmp_path, axis, ROUGH)
