"""Laws with memory fit what they have made themselves, as a whole and in segments."""

import numpy as np
import pytest
from tests.friction.test_memories import CURVES, FLOWS, recorded, truth

from stickslip import Axis, Measurement, RecordSettings, fit
from stickslip.friction import specification
from stickslip.mechanisms.drives import Sine

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
    force = np.array([DRIVE.smooth(moment) for moment in t])
    return Measurement(time=t, position=x, force=force), noise


def fitted(own, written, t_end, *, share, segment, seed=3, step=4e-3):
    table, noise = measured(own, t_end, share=share, seed=seed, step=step)
    settings = RecordSettings(hold="first", segment=segment)
    rig = Axis(inertia=1.0, load=1.0)
    return fit(rig, written, table, route="shooting", settings=settings), noise


def assert_told(found, own, noise):
    """The residual is the noise; what is bounded is right, and what is not has a reason."""
    assert found.rms < 1.08 * noise  # 250 rows and more scatter by 5 %
    for estimate in found.estimates:
        name = estimate.path.partition(".")[2]
        if estimate.path.startswith("friction.") and estimate.bounded:
            # some of hundreds of 95 % intervals do not contain the truth; twice as wide ones do
            assert abs(estimate.value - getattr(own, name)) < 2.0 * estimate.half_width, estimate
        elif estimate.path.startswith("friction."):
            assert estimate.reason


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
    (share,) = (estimate for estimate in found.estimates if estimate.path == f"friction.{name}")
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


def test_a_written_power_has_its_exponent_fitted_where_the_law_of_that_name_holds_it():
    assert specification("lugre(level + stribeck) + power").free is not None
    assert "viscous_exponent" in specification("lugre(level + stribeck) + power").free
    assert specification("dahl(level + lorentz) + power").free is None
    assert specification("power + dahl(level)").free == specification("dahl(level) + power").free
