"""Intervals of travels where valleys bend, where there are several, and where noise is unknown."""

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Measurement,
    PowerViscous,
    SpringBlock,
    Stribeck,
    fit,
    simulate,
)
from stickslip.drives import Pulse
from stickslip.identification import TravelModel
from stickslip.kinds.travels.profiles import profile_ends
from stickslip.mechanisms import slip_of
from stickslip.quantities import vary

FOUR = ("kinetic_coefficient", "static_coefficient", "stribeck_velocity", "viscous_coefficient")


def travels(rig, law, path, settings):
    found = []
    for setting in settings:
        one = vary(rig, "mechanism", {path: setting})
        ends = simulate(one, law, t_end=10.0).at((0.0, 10.0))[slip_of(one)]
        found.append(float(ends[1] - ends[0]))
    return np.array(found)


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
    """These readings gave mu_k .2483 to .2554 or .127 to .2554, by the kernel of linear algebra.

    With friction at rest up to the largest speeds, and viscous friction, no level is needed.
    """
    table, noise = TravelModel.table, np.random.default_rng(seed)

    def rounded(self, trials, rows):
        found = table(self, trials, rows)
        return found * (1.0 + 1e-12 * noise.standard_normal(found.shape))

    monkeypatch.setattr(TravelModel, "table", rounded)
    found = fit(SpringBlock(mass=1.0, stiffness=100.0, compression=0.1), Stribeck, THREE)
    level, slope = found.estimates
    assert (f"{level.low:.3g}", f"{level.high:.3g}") == ("0", "0.255")
    assert level.range == "0.00 to 0.26"
    assert not slope.bounded


def test_an_end_is_looked_for_from_other_valleys_at_the_value_that_is_followed():
    """Where a power of the speed was followed itself, its ends were those of other powers."""

    def descend(points, moving):
        # beside x, y goes to the nearer of two values, of which one explains no more
        points = np.where(moving, np.where(points > 3.0, 5.0, 1.0), points)
        x, y = points.T
        return points, x**2 * np.where(y > 3.0, 1.0, 4.0)

    inside, outside, share = profile_ends(
        descend, np.array([[0.0, 1.0]]), np.array([0]), np.array([[1.0, 0.0]]),
        low=np.full(2, -90.0), high=np.full(2, 90.0), least=0.0, target=4.0,
        again=lambda point: np.array([point, [0.1, 5.0], [7.0, 5.0]]),
    )  # fmt: skip
    end = inside + share[:, None] * (outside - inside)
    np.testing.assert_allclose(end, [[2.0, 5.0]], rtol=1e-6)  # the profile is straight in x


def test_an_interval_holds_a_law_of_a_third_of_the_level_that_explains_as_well():
    """Its travels are the means of the repeats, so it leaves their pure error: the least of all."""
    rig, path = SpringBlock(mass=0.82, stiffness=145.0, compression=0.1), "mechanism.compression"
    settings, read = (0.06, 0.06, 0.08, 0.08, 0.1), np.array([0.106, 0.105, 0.187, 0.189, 0.292])
    trials = tuple(
        Measurement(travel=travel, uncertainty=1e-3, overrides={path: setting})
        for setting, travel in zip(settings, read.tolist(), strict=True)
    )
    found = fit(rig, Stribeck, Measurement(trials=trials)).estimate("kinetic_coefficient")
    other = Stribeck(
        kinetic_coefficient=0.10, static_coefficient=0.2792, stribeck_velocity=0.8581,
        viscous_coefficient=1.3169,
    )  # fmt: skip
    left = np.sum(((read - travels(rig, other, path, settings)) / 1e-3) ** 2)
    assert left == pytest.approx(2.5, abs=0.05)
    assert found.low <= 0.10
    assert found.high == pytest.approx(0.31, abs=0.005)


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
    found = fit(rig, truth, measurement, vary=[f"friction.{name}" for name in FOUR])
    # the same level and slope are left by less friction at rest up to higher speeds
    other = Stribeck(
        kinetic_coefficient=6.06, static_coefficient=6.41, stribeck_velocity=0.255,
        viscous_coefficient=0.197,
    )  # fmt: skip
    for law in (truth, other):
        left = np.sum(((read - travels(rig, law, path, settings)) / error) ** 2)
        assert left < found.chi_square + 3.84  # the 95 % quantile of chi-square
        for one in found.estimates:
            assert one.low <= getattr(law, one.path.rpartition(".")[2]) <= one.high


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
    assert "their stated uncertainty" in " ".join(fit(rig, Coulomb, measurement).told_apart)
    assert not fit(rig, CoulombViscous, measurement).told_apart


def parabola(points, moving):
    return np.where(moving, 0.0, points), points[:, 0] ** 2


@pytest.mark.parametrize(("high", "end"), [(9.0, 2.0), (1.5, 1.5)])
def test_a_walk_ends_at_the_target_or_at_a_bound(high, end):
    inside, outside, share = profile_ends(
        parabola, np.zeros((1, 2)), np.array([0]), np.array([[1.0, 0.0]]),
        low=np.full(2, -9.0), high=np.full(2, high), least=0.0, target=4.0,
        again=lambda point: point[None],
    )  # fmt: skip
    # the root of a parabola is straight: its interpolation is exact
    assert (inside + share[:, None] * (outside - inside))[0, 0] == pytest.approx(end, rel=1e-12)


def test_a_walk_that_meets_no_end_is_open():
    inside, outside, _ = profile_ends(
        lambda points, _: (points, np.zeros(len(points))),
        np.zeros((1, 1)), np.array([0]), np.array([[-1.0]]),
        low=np.full(1, -1e9), high=np.full(1, 1e9), least=0.0, target=4.0,
        again=lambda point: point[None],
    )  # fmt: skip
    assert np.isfinite(inside).all()
    assert outside[0, 0] == -np.inf
