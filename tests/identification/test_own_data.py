"""Laws with memory fit what they have made themselves, as a whole and in segments."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.friction.test_memories import CURVES, FLOWS, MEMORIES, recorded, truth

from stickslip import Axis, LuGre, Measurement, RecordSettings, fit
from stickslip.drives import Sine
from stickslip.friction import containment_of, law, simpler_laws, specification
from stickslip.identification.estimation.estimates import widened_by_starts
from stickslip.identification.estimation.jackknife import infer
from stickslip.identification.estimation.levenberg_marquardt import OptimizeResult
from stickslip.identification.estimation.parameters import FreeParameter, FreeParameters
from stickslip.identification.estimation.problem import ResidualJacobian
from stickslip.identification.records.fitting import fit_record
from stickslip.quantities import Quantity

FIVE = ("dahl", "lugre", "maxwell[3]", "reset", "elasto_plastic")
DRIVE = Sine(amplitude=3.0, frequency=0.7) + Sine(amplitude=1.5, frequency=1.9)
SHARE = 1e-3
"""Noise of positions over their range: half a millimetre, as large as presliding is."""


def measured(own, t_end, *, share, seed=3, step=4e-3):
    """A record of positions with noise, and the standard deviation of this [m]."""
    t = np.arange(0.0, t_end, step)
    x = recorded(own, t_end).at(t)["x"]
    noise = share * np.ptp(x)
    x = x + np.random.default_rng(seed).normal(0.0, noise, len(t))
    force = np.array([DRIVE.smooth(one) for one in t])
    return Measurement(time=t, position=x, force=force), noise


def fitted(own, written, t_end, *, share, segment, seed=3, step=4e-3):
    table, noise = measured(own, t_end, share=share, seed=seed, step=step)
    settings = RecordSettings(hold="first", segment=segment)
    rig = Axis(inertia=1.0, load=1.0)
    return fit(rig, written, table, route="shooting", settings=settings), noise


def assert_told(found, own, noise):
    """The residual is the noise; what is bounded is right, and what is not has a reason."""
    assert found.rms < 1.08 * noise  # 250 rows and more scatter by 5 %
    for one in found.estimates:
        name = one.path.partition(".")[2]
        if one.path.startswith("friction.") and one.bounded:
            # some of hundreds of 95 % intervals do not contain the truth; twice as wide ones do
            assert abs(one.value - getattr(own, name)) < 2.0 * one.half_width, one
        elif one.path.startswith("friction."):
            assert one.reason


@pytest.mark.slow
def test_a_law_fits_its_own_data_from_its_composition():
    own = truth("maxwell[3]", "level", "viscous")
    written = "viscous + maxwell[3](level)"
    found, noise = fitted(own, written, 2.0, share=SHARE, segment=2.1)
    assert_told(found, own, noise)


@pytest.mark.slow
@pytest.mark.parametrize("flow", FLOWS)
@pytest.mark.parametrize("curve", CURVES)
@pytest.mark.parametrize("memory", FIVE)
def test_three_curves_five_memories_and_two_flows_fit_their_own_data(memory, curve, flow):
    own = truth(memory, curve, flow)
    found, noise = fitted(own, f"{flow} + {memory}({curve})", 2.0, share=SHARE, segment=2.1)
    assert_told(found, own, noise)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("memory", "name"),
    [
        ("reset", "sticking_surplus"),
        pytest.param("elasto_plastic", "elastic_share", marks=pytest.mark.slow),
    ],
)
def test_segments_give_the_share_of_a_memory_as_the_whole_record_does(memory, name):
    own = truth(memory, "level", "viscous")
    # joined straight over 4 ms, the force would err by as much as positions do
    found, noise = fitted(own, type(own), 3.0, share=1e-5, segment=1.0, step=2e-3)
    assert found.rms < 1.05 * noise  # four times the noise where segments begin unbent
    (share,) = (one for one in found.estimates if one.path == f"friction.{name}")
    assert abs(share.value - getattr(own, name)) < 2.0 * share.half_width
    # one turn tells most of it: of a standard error of 0.02 the interval makes 0.2
    assert share.low > 0.0
    assert share.high < 1.0


@pytest.mark.slow
def test_a_static_surplus_is_found_beyond_the_ridge_between_it_and_a_power():
    own = truth("dahl", "level + stribeck", "power")
    found, noise = fitted(own, "dahl(level + stribeck) + power", 3.0, share=SHARE, segment=3.1)
    assert_told(found, own, noise)
    assert found.law.kinetic_coefficient == pytest.approx(1.0, rel=0.2)  # else 1.3


@pytest.mark.slow
def test_a_static_surplus_that_is_not_found_beyond_the_ridge_leaves_its_levels_unbounded():
    own = truth("dahl", "level + lorentz", "power")
    found, noise = fitted(own, "dahl(level + lorentz) + power", 3.0, share=SHARE, segment=3.1)
    assert_told(found, own, noise)  # a residual of 1.01 of the noise; that of the truth has 0.96
    bounded = {one.path: one.bounded for one in found.estimates}
    assert not bounded["friction.kinetic_coefficient"]
    assert not bounded["friction.static_coefficient"]


@pytest.mark.slow
def test_intervals_include_other_valleys_that_fit_nearly_as_closely():
    own = truth("lugre", "level + stribeck", "viscous")
    found, noise = fitted(own, LuGre, 3.0, share=SHARE, segment=3.1)
    assert_told(found, own, noise)  # else 28.9 +- 3.7 N s/m of damping, true 20
    assert any("in place of" in one for one in found.sentences)


@pytest.mark.slow
def test_no_interval_takes_for_known_what_a_search_left_at_a_bound():
    own = truth("reset", "level + lorentz", "power")
    table, noise = measured(own, 2.0, share=SHARE)
    # a search from the type of the law comes here, where the surplus and its speed do nothing
    lost = replace(
        own,
        kinetic_coefficient=1.27,
        static_coefficient=1.33,
        stribeck_velocity=5e-4,
        bristle_stiffness=1433.0,
        bristle_damping=22.0,
        sticking_surplus=0.66,
        viscous_coefficient=1.753,
        viscous_exponent=0.747,
    )
    settings = RecordSettings(hold="first", segment=2.1, starts=1)
    found = fit_record(
        Axis(inertia=1.0, load=1.0),
        lost,
        table,
        route="shooting",
        settings=settings,
        contained=(),
    )
    assert_told(found, own, noise)  # else 1.75 +- 0.04 N s/m, true 2
    assert not found.at_bounds


def line_fit(*ends, rows=100):
    """A fit of one value and one logarithm, both of which scatter by 0.1, and other ends."""
    rng = np.random.default_rng(1)
    slopes = np.linalg.qr(rng.normal(size=(rows, 3)))[0][:, :2] * 10.0
    left = rng.normal(size=rows)
    left -= slopes @ (slopes.T @ left) / 100.0
    best = ResidualJacobian(
        values=np.array([1.0, 2.0]),
        residual=left * (rows / (left @ left)) ** 0.5,
        slopes=slopes,
        segment=np.zeros(rows, dtype=int),
    )
    items = [
        FreeParameter(path="friction.a", quantity=Quantity("a", "N"), start=1.0, low=0.0),
        FreeParameter(path="friction.b", quantity=Quantity("b", "m"), start=1.0, low=0.1, log=True),
    ]
    result = OptimizeResult(
        best=best,
        costs=(rows, math.inf, *(cost * rows for cost, _ in ends)),
        values=np.array([best.values, *(values for _, values in ends)]),
        evaluations=1,
    )
    return widened_by_starts(infer(best, np.eye(2)), FreeParameters(tuple(items)), result)


def test_ends_of_starts_widen_intervals_where_they_fit_as_closely_and_lie_apart():
    own, said = line_fit()
    assert not said
    for end in [(1.01, [1.05, 2.1]), (1.5, [9.0, 2.0])]:  # within the interval; far too bad
        same, said = line_fit(end)
        assert np.array_equal(same.covariance, own.covariance)
        assert not said
    wide, said = line_fit((1.02, [9.0, 2.0]))
    assert wide.half_widths[0] > 8.0
    assert wide.half_widths[1] == pytest.approx(own.half_widths[1])
    assert said.startswith("Other values fit nearly as closely: with a = 9 N in place of 1 N")
    assert "1 % larger" in said
    wide, _ = line_fit((1.02, [1.0, 20.0]))
    assert wide.half_widths[1] > 2.0 * math.log(10.0)


@pytest.mark.parametrize("last", [-1e-13, 1e-13])
def test_intervals_include_ends_whatever_the_order_of_equal_residuals(last):
    near, far = (1.02, [1.5, 2.0]), (1.02 + last, [9.0, 2.0])
    wide, said = line_fit(near, far)
    assert np.array_equal(wide.covariance, line_fit(far)[0].covariance)
    assert "with a = 9 N" in said


def test_a_written_power_has_its_exponent_fitted_where_the_law_of_that_name_holds_it():
    assert specification("lugre(level + stribeck) + power").free is not None
    assert "viscous_exponent" in specification("lugre(level + stribeck) + power").free
    assert specification("dahl(level + lorentz) + power").free is None
    assert specification("power + dahl(level)").free == specification("dahl(level) + power").free


@pytest.mark.parametrize("memory", MEMORIES)
@pytest.mark.parametrize("curve", CURVES)
def test_searches_begin_from_every_law_with_a_part_less(memory, curve):
    kind = law(f"{memory}({curve}) + power")
    free = {*kind.fit_order, "viscous_exponent"}
    simpler = {str(one.made_of.term) for one in simpler_laws(kind, free)}
    assert simpler >= {f"{memory}({curve}) + viscous", f"{curve} + power"}
    if "+" in curve:
        assert f"{memory}(level) + power" in simpler
    assert all(containment_of(kind, one) for one in simpler_laws(kind, free))
