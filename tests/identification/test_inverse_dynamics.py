"""Friction levels by linear least squares of forces: exact motions, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Measurement
from stickslip.data.differentiation import rows_of
from stickslip.errors import InputError
from stickslip.identify.fits.series.inverse_dynamics import inverse_dynamics, regressed

T = np.arange(0.0, 20.0, 1e-3)
J, F_V, F_C, OFFSET = 4.0, 6.0, 2.0, -0.5


def record_of(*, levels=(F_C, F_C), viscous=(F_V, F_V), offset=OFFSET, noise=0.0):
    """Return a motion in closed form, and the force that it takes."""
    parts = ((0.3, 0.8, 0.2), (0.1, 2.3, 1.0))
    x = sum(a * np.sin(w * T + p) for a, w, p in parts)
    v = sum(a * w * np.cos(w * T + p) for a, w, p in parts)
    a = sum(-a * w**2 * np.sin(w * T + p) for a, w, p in parts)
    level = np.where(v > 0.0, levels[0], -levels[1])
    slope = np.where(v > 0.0, viscous[0], viscous[1])
    scatter = noise * np.random.default_rng(0).normal(size=len(T))
    return Measurement(time=T, position=x, force=J * a + slope * v + level + offset + scatter)


def test_an_exact_motion_gives_its_parameters_back():
    found = inverse_dynamics(Axis(inertia=1.0), record_of())
    # differences of 1 ms on motions of 2.3 rad/s; the last samples suffer from the filter's end
    np.testing.assert_allclose(
        [found["inertia"], found["viscous"], found["level"], found["offset"]],
        [J, F_V, F_C, OFFSET],
        rtol=5e-3,
    )
    assert found.relative_error < 0.02


def test_each_direction_has_parameters_of_its_own():
    record = record_of(levels=(2.0, 2.6), viscous=(6.0, 7.0), offset=0.0)
    found = inverse_dynamics(Axis(inertia=1.0), record, directional=True, offset=False)
    names = ("level+", "level-", "viscous+", "viscous-", "inertia")
    np.testing.assert_allclose([found[name] for name in names], [2.0, 2.6, 6.0, 7.0, J], rtol=1e-2)


def test_a_known_mass_is_taken_off():
    found = inverse_dynamics(Axis(inertia=J), record_of(), vary=())
    assert "inertia" not in found.names
    assert found["level"] == pytest.approx(F_C, rel=1e-3)
    v, friction = found.velocity, found.friction
    away = np.abs(v) > 0.1
    away[-500:] = False  # where the filter ends
    expected = F_C * np.sign(v) + F_V * v + OFFSET
    np.testing.assert_allclose(friction[away], expected[away], atol=0.02)


def test_a_spring_is_no_friction():
    record = record_of()
    sprung = Measurement(
        time=T, position=record.position, force=record.force + 30.0 * record.position
    )
    found = inverse_dynamics(Axis(inertia=1.0, stiffness=30.0), sprung)
    assert found["inertia"] == pytest.approx(J, rel=2e-3)
    assert found["level"] == pytest.approx(F_C, rel=2e-3)


def test_outliers_move_the_robust_estimates_less():
    record = record_of(noise=0.2)
    force = record.force.copy()
    force[5000:5200] += 60.0  # 1 % of the record
    spoiled = Measurement(time=T, position=record.position, force=force)
    plain, robust = (
        inverse_dynamics(Axis(inertia=1.0), spoiled, robust=choice) for choice in (False, True)
    )
    assert abs(robust["offset"] - OFFSET) < 0.1 * abs(plain["offset"] - OFFSET)
    assert robust["level"] == pytest.approx(F_C, rel=0.02)


def test_slip_in_one_direction_shares_level_and_offset_evenly():
    x = 0.5 * T + 0.05 * np.sin(3.0 * T)
    v = 0.5 + 0.15 * np.cos(3.0 * T)
    force = -J * 0.45 * np.sin(3.0 * T) + F_V * v + 2.0
    for robust in (False, True):
        found = inverse_dynamics(
            Axis(inertia=1.0), Measurement(time=T, position=x, force=force), robust=robust
        )
        # one number for both: the least of all solutions has half in each
        assert found["level"] == pytest.approx(1.0, abs=0.02)
        assert found["offset"] == pytest.approx(1.0, abs=0.02)


def test_standard_deviations_are_those_of_independent_errors():
    found = inverse_dynamics(Axis(inertia=J), record_of(noise=0.5), vary=(), offset=False)
    again = inverse_dynamics(Axis(inertia=J), record_of(noise=0.5), vary=(), offset=False)
    np.testing.assert_array_equal(found.deviations, again.deviations)
    assert found.names == ("viscous", "level")
    n = len(found.residual)
    # of a regression on two nearly orthogonal columns: at least s / sqrt(n) for a column of ones
    least = np.sqrt(np.mean(found.residual**2) / n)
    assert least < found.deviations[1] < 3.0 * least


def test_a_mass_to_start_from_is_that_of_a_regression_where_it_is_looked_for():
    axis = Axis(inertia=1.0)
    assert "inertia" not in regressed(axis, record_of()).names
    found = regressed(axis, record_of(), ("mechanism.inertia",))
    assert found["inertia"] == pytest.approx(J, rel=2e-3)


def test_forces_of_the_wrong_sign_have_no_mass():
    clean = record_of()
    with pytest.raises(InputError, match="gain -1"):
        regressed(Axis(inertia=1.0), replace(clean, force=-clean.force), ("mechanism.inertia",))


@pytest.mark.parametrize(
    ("record", "message"),
    [
        (Measurement(time=T, force=np.ones_like(T)), "needs the position or the velocity"),
        (
            Measurement(time=T[:20], position=T[:20]),
            "at least 30 samples without a gap, and the longest has 20",
        ),
    ],
)
def test_a_record_without_enough_positions_is_refused(record, message):
    with pytest.raises(InputError, match=message):
        inverse_dynamics(Axis(inertia=1.0), record)


def test_what_lies_on_either_side_of_a_gap_is_filtered_as_two_records():
    record = record_of(noise=0.1)
    parts = [rows_of(record, 0, 9_000), rows_of(record, 9_500, len(T))]
    seen = np.r_[0:9_000, 9_500 : len(T)]
    columns = ("time", "position", "force")
    holed = Measurement(**{name: getattr(record, name)[seen] for name in columns})
    found = inverse_dynamics(Axis(inertia=1.0), holed)
    apart = inverse_dynamics(Axis(inertia=1.0), Measurement(trials=tuple(parts)))
    np.testing.assert_array_equal(found.values, apart.values)
    assert found["level"] == pytest.approx(F_C, rel=0.01)  # noise of 0.1 N in 19,500 samples


def test_a_record_of_nothing_but_gaps_says_how_long_a_stretch_must_be():
    bursts = np.concatenate([start + 1e-3 * np.arange(20) for start in range(9)])
    record = Measurement(time=bursts, position=np.sin(bursts), force=np.cos(bursts))
    with pytest.raises(
        InputError, match="at least 30 samples without a gap, and the longest has 20"
    ):
        inverse_dynamics(Axis(inertia=1.0), record)
