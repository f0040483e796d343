"""Intervals of travels where valleys bend, where there are several, and where noise is unknown."""

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    Measurement,
    PowerViscous,
    SpringBlock,
    Stribeck,
    fit,
    simulate,
)
from stickslip.identify.fits import TravelModel, trials_of
from stickslip.mechanisms import slip_of
from stickslip.mechanisms.drives import Pulse, Ramp, Sampled, Sine
from stickslip.mechanisms.drives.shapes import PiecewiseAffine
from stickslip.quantities import vary

LEVEL = ["friction.kinetic_coefficient"]
FOUR = ("kinetic_coefficient", "static_coefficient", "stribeck_velocity", "viscous_coefficient")


def run_to_end(rig, law, level):
    law = vary(law, "friction", {LEVEL[0]: level})
    return float(np.ptp(simulate(rig, law, t_end=10.0).at((0.0, 10.0))[slip_of(rig)]))


def travels(rig, law, path, settings):
    rigs = [vary(rig, "mechanism", {path: setting}) for setting in settings]
    ends = [simulate(rig, law, t_end=10.0).at((0.0, 10.0))[slip_of(rig)] for rig in rigs]
    return np.ptp(ends, axis=1)


def readings(rig, law, path, settings, errors, *, stated=True):
    true = travels(rig, law, path, settings) + errors
    trials = tuple(
        Measurement(
            travel=float(read),
            uncertainty={"travel": float(np.max(stated))} if stated else {},
            overrides={path: setting},
        )
        for setting, read in zip(settings, true, strict=True)
    )
    return Measurement(trials=trials), true


THREE = Measurement(
    trials=tuple(
        Measurement(
            travel=travel,
            uncertainty=0.0005,
            uncertainty_kind="rounding",
            overrides={"mechanism.compression": compression},
        )
        for travel, compression in ((0.030, 0.04), (0.201, 0.1), (0.452, 0.15))
    )
)


@pytest.mark.rounding
@pytest.mark.parametrize(
    "seed", [pytest.param(seed, marks=[pytest.mark.slow] * (seed > 0)) for seed in range(8)]
)
def test_intervals_do_not_turn_on_the_last_bits_of_travels(seed, monkeypatch):
    """These readings gave mu_k .2483 to .2554 or .127 to .2554, by the kernel of linear algebra."""
    table, noise = TravelModel.table, np.random.default_rng(seed)

    def rounded(self, trials, rows):
        exact = table(self, trials, rows)
        return exact * (1.0 + 1e-12 * noise.standard_normal(exact.shape))

    monkeypatch.setattr(TravelModel, "table", rounded)
    fitted = fit(SpringBlock(mass=1.0, stiffness=100.0, compression=0.1), Stribeck, THREE)
    first = fitted.estimates[0]
    assert (f"{first.low:.2g}", f"{first.high:.3g}") == ("0.11", "0.254")


@pytest.mark.slow
def test_intervals_hold_a_law_that_explains_the_travels_as_well_along_a_valley_that_bends():
    error = 0.67e-3
    rig = Axis(inertia=2.18, drive=Pulse(level=20.0, duration=0.285))
    path, settings = "mechanism.drive.level", (9.9, 10.2, 11.7, 12.7, 14.0, 16.4, 18.5, 19.4)
    truth = Stribeck(
        kinetic_coefficient=6.08, static_coefficient=6.85, stribeck_velocity=0.092,
        viscous_coefficient=0.187,
    )  # fmt: skip
    measurement, read = readings(rig, truth, path, settings, np.zeros(8), stated=error)
    fitted = fit(rig, truth, measurement, vary=[f"friction.{name}" for name in FOUR])
    # the same level and slope are left by less friction at rest up to higher speeds
    other = Stribeck(
        kinetic_coefficient=6.06, static_coefficient=6.41, stribeck_velocity=0.255,
        viscous_coefficient=0.197,
    )  # fmt: skip
    for law in (truth, other):
        left = np.sum(((read - travels(rig, law, path, settings)) / error) ** 2)
        assert left < fitted.chi_square + 3.84  # the 95 % quantile of chi-square
        for estimate in fitted.estimates:
            assert estimate.low <= getattr(law, estimate.path.rpartition(".")[2]) <= estimate.high


def test_nuisances_that_take_up_the_noise_do_not_make_it_small():
    rig = Axis(inertia=1.0, drive=Pulse(level=20.0, duration=0.2))
    path, settings = "mechanism.drive.level", (14.0, 20.0, 28.0)
    truth = PowerViscous(kinetic_coefficient=5.0, viscous_coefficient=0.5, viscous_exponent=2.0)
    errors = np.array([1e-3, -1e-3, 1e-3])
    measurement, _ = readings(rig, truth, path, settings, errors, stated=False)
    level = fit(rig, PowerViscous, measurement).estimate("kinetic_coefficient")
    assert level.low <= 5.0 <= level.high


def test_a_fit_that_leaves_more_than_the_readings_errors_says_so():
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    path, settings = "mechanism.compression", (0.06, 0.08, 0.1, 0.12)
    truth = CoulombViscous(kinetic_coefficient=0.1, viscous_coefficient=1.5)
    measurement, _ = readings(rig, truth, path, settings, np.zeros(4), stated=1e-4)
    wrong, right = (fit(rig, law, measurement).verdict for law in (Coulomb, CoulombViscous))
    assert "where 0.1 mm is stated" in wrong.sentence
    assert right.sentence == "Use Coulomb + viscous friction."


@pytest.mark.parametrize("incline", [0.0, 0.1])
def test_a_body_on_ringing_bristles_has_the_travel_of_its_whole_run(incline):
    """On an incline it creeps: a fifth of the run ends 4e-4 of the travel off."""
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, incline=incline)
    law = Dahl(kinetic_coefficient=0.3, bristle_stiffness=1e4)
    (trial,) = trials_of(rig, Measurement(travel=0.15), 10.0)
    rows = np.array([[0.3], [0.31]])
    made = TravelModel(law, LEVEL, 10.0).table([trial], rows)[:, 0]
    for level, got in zip(rows[:, 0].tolist(), made.tolist(), strict=True):
        assert got == pytest.approx(run_to_end(rig, law, level), rel=2e-5)


@pytest.mark.parametrize(
    "drive",
    [
        Ramp(rate=1.0),
        Pulse(level=7.0, duration=0.1) + Ramp(rate=0.8),
        Sine(amplitude=6.0, frequency=0.05),
        Sampled(times=[0.0, 8.0], values=[4.0, 7.0]),
        Sampled(times=[0.0], values=[5.0001]),
        PiecewiseAffine(times=(0.0, 4.0, 9.0), values=(4.0, 2.0, 6.0), slopes=(0.0, 1.0, 0.0)),
    ],
    ids=["ramp", "sum", "sine", "late step", "barely enough", "affine pieces"],
)
def test_a_drive_that_moves_a_body_on_bristles_late_does_so(drive):
    """A ramp of one piece was taken for a force that no longer changes: 24 um in place of 21 m."""
    rig, law = Axis(inertia=1.0, drive=drive), Dahl(kinetic_coefficient=5.0, bristle_stiffness=1e5)
    expected = run_to_end(rig, law, 5.0)
    (trial,) = trials_of(rig, Measurement(travel=expected), 10.0)
    made = TravelModel(law, LEVEL, 10.0).table([trial], np.array([[5.0]]))
    assert expected > 0.001
    assert float(made[0, 0]) == pytest.approx(expected, rel=2e-5)


def test_draws_that_are_led_to_the_readings_count():
    """By linear proposals alone, 4 of them did."""
    rig = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
    fitted = fit(rig, PowerViscous, THREE)
    assert fitted.to_dict()["effective_draws"] > 50.0
    low, high = fitted.estimates[0].low, fitted.estimates[0].high
    assert low < fitted.estimates[0].value < high
    assert "effective number of draws" not in " ".join(fitted.verdict.words.cannot_tell)
