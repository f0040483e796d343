"""How well a law is known, in a rig file and out of it."""

import dataclasses
import math

import numpy as np
import pytest
from tests.support import rounded_travels

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    LuGre,
    Measurement,
    SpringBlock,
    Stribeck,
    fit,
    load_rig,
)
from stickslip.data import LawEstimates
from stickslip.data.rigs.rig_writer import rig_toml
from stickslip.errors import InputError

BLOCK = SpringBlock(mass=0.82, stiffness=145.0, compression=0.1)
LAW = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.5)
KNOWN = LawEstimates(
    law="coulomb-viscous",
    intervals={"kinetic_coefficient": (0.2304, 0.2696), "viscous_coefficient": (0.108, 0.892)},
    covariance_of=("kinetic_coefficient", "viscous_coefficient"),
    covariance=((1e-4, -1.8e-3), (-1.8e-3, 0.04)),
    largest_speed=1.25,
)
HEAD = """
[mechanism]
type = "spring-block"
mass = 1.0
[friction.coulomb]
kinetic_coefficient = 0.25
static_coefficient = 0.3
[estimates]
law = "coulomb"
"""


@pytest.fixture
def read(tmp_path):
    """Read a rig file from its text."""

    def call(text, **settings):
        path = tmp_path / "rig.toml"
        path.write_text(text, encoding="utf-8")
        return load_rig(path, **settings)

    return call


def test_what_is_written_is_read_back(read):
    rig = read(rig_toml(BLOCK, LAW, estimates=KNOWN))
    assert rig.estimates == KNOWN
    assert rig.laws["coulomb-viscous"] == LAW


def test_a_file_without_the_table_says_nothing_of_estimates(read):
    assert read(rig_toml(BLOCK, LAW)).estimates is None


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("intervals = { kinetic_coeficient = [0.2, 0.3] }", "kinetic_coefficient"),
        ("intervals = { kinetic_coefficient = [0.26, 0.3] }", "outside its interval"),
        ("intervals = { kinetic_coefficient = [0.3, 0.2] }", "lower one first"),
        ("intervals = { kinetic_coefficient = [0.2] }", "a lower and an upper bound"),
        ("intervals = { kinetic_coefficient = [-inf, 0.3] }", "not_identified"),
        ("not_fitted = ['kinetic_coefficient', 'kinetic_coefficient']", "is given twice"),
        ("covariance = [[1.0]]", "0 rows of 0 numbers"),
        ("covariance_of = ['kinetic_coefficient']", "covariance_of"),
        ("largest_speed = -1.0", "at least 0 m/s"),
        ("levels = 'newtons'", "per load"),
        (
            "intervals = { kinetic_coefficient = [0.2, 0.3], static_coefficient = [0.2, 0.4] }\n"
            "covariance_of = ['kinetic_coefficient', 'static_coefficient']\n"
            "covariance = [[1e-4, 1e-4], [2e-4, 1e-4]]",
            "symmetric",
        ),
        (
            "intervals = { kinetic_coefficient = [0.2, 0.3], static_coefficient = [0.2, 0.4] }\n"
            "covariance_of = ['kinetic_coefficient', 'static_coefficient']\n"
            "covariance = [[1e-4, 2e-4], [2e-4, 1e-4]]",
            "positive semi-definite",
        ),
    ],
)
def test_a_table_that_cannot_be_used_is_refused_with_the_file_and_the_cure(read, line, said):
    with pytest.raises(InputError, match=r"rig\.toml") as error:
        read(HEAD + line)
    assert said in str(error.value)


def test_a_largest_speed_of_zero_is_written(read):
    known = dataclasses.replace(KNOWN, largest_speed=0.0)
    assert read(rig_toml(BLOCK, LAW, estimates=known)).estimates == known


def test_a_law_that_the_file_does_not_have_is_refused(read):
    with pytest.raises(InputError, match=r"estimates\.law"):
        read(HEAD.replace('law = "coulomb"', 'law = "dahl"'))


def test_a_value_that_is_overridden_is_no_longer_an_estimate(read):
    text = rig_toml(BLOCK, LAW, estimates=KNOWN)
    rig = read(text, overrides={"friction.coulomb-viscous.viscous_coefficient": 3.0})
    assert rig.estimates.not_fitted == ("viscous_coefficient",)
    assert rig.estimates.covariance == ((1e-4,),)


def test_draws_have_the_covariance_of_the_file():
    draws = np.array(list(KNOWN.draw(LAW, 4000, seed=3).values()))
    # 0.5 is 2.5 standard deviations above 0: cutting off 0.6 % changes a variance by 4 %; the
    # standard error of a variance of 4000 draws is 2.2 %
    np.testing.assert_allclose(np.cov(draws), KNOWN.covariance, rtol=0.1)
    np.testing.assert_allclose(draws.mean(axis=1), [0.25, 0.5], rtol=0.02)


def test_draws_of_an_interval_that_is_longer_on_one_side_keep_to_it():
    known = LawEstimates(
        law="coulomb",
        intervals={"kinetic_coefficient": (0.254, 0.317)},
        covariance_of=("kinetic_coefficient",),
        covariance=((((0.308 - 0.254) / 1.96) ** 2,),),
    )
    drawn = known.draw(Coulomb(kinetic_coefficient=0.308), 4000)["friction.kinetic_coefficient"]
    low, middle, high = np.quantile(drawn, [0.025, 0.5, 0.975])
    # standard errors of such quantiles of 4,000 draws are a twentieth of a side
    assert low == pytest.approx(0.254, abs=4e-3)
    assert middle == pytest.approx(0.308, abs=1e-3)
    assert high == pytest.approx(0.317, abs=1e-3)


def test_draws_are_valid_values_of_the_law():
    law = Stribeck(kinetic_coefficient=0.25, static_coefficient=0.26, stribeck_velocity=0.01)
    known = LawEstimates(law="stribeck", intervals={"kinetic_coefficient": (0.2, 0.3)})
    (draws,) = known.draw(law, 500).values()
    assert draws.max() <= 0.26  # mu_k above mu_s is no law
    assert draws.min() < 0.22


def test_a_fit_to_one_reading_gives_values_that_scatter_as_its_interval_says():
    reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")
    found = fit(SpringBlock(mass=1.0, stiffness=100.0, compression=0.1), Coulomb, reading)
    known = found.law_estimates()
    (low, high), ((variance,),) = known.intervals["kinetic_coefficient"], known.covariance
    (draws,) = known.draw(found.law, 1000).values()
    assert np.quantile(draws, [0.025, 0.975]) == pytest.approx([low, high], rel=0.02)
    assert draws.std() == pytest.approx(math.sqrt(variance), rel=0.25)  # of the longer side


def test_the_covariance_of_a_fit_gives_its_intervals_and_its_correlation():
    law = CoulombViscous(kinetic_coefficient=0.3, viscous_coefficient=0.6)
    readings = rounded_travels(BLOCK, law, (0.06, 0.08, 0.1, 0.12), digits=3)
    found = fit(BLOCK, CoulombViscous, readings)
    known = found.law_estimates()
    spreads = np.sqrt(np.diag(known.covariance))
    for name, spread in zip(known.covariance_of, spreads, strict=True):
        low, high = known.intervals[name]
        value = getattr(found.law, name)
        assert max(high - value, value - low) == pytest.approx(1.959964 * spread, rel=1e-6)
    assert np.array(known.covariance)[0, 1] / np.prod(spreads) == pytest.approx(
        found.correlation[0][1], rel=1e-9
    )
    assert found.correlation[0][1] < -0.9  # more of one is less of the other
    # the longest shot is fastest where the spring pushes as friction does, at sqrt(k / m) times
    # what is left of the compression; the viscous part, damping ratio 0.028, takes about 4 %
    left = 0.12 - 0.3 * 0.82 * 9.81 / 145.0
    assert known.largest_speed == pytest.approx(0.96 * left * math.sqrt(145.0 / 0.82), rel=0.02)


def test_what_was_not_fitted_and_what_the_data_do_not_tell_is_said(read):
    found = fit(
        BLOCK,
        LuGre,
        rounded_travels(BLOCK, Coulomb(kinetic_coefficient=0.3), (0.06, 0.1), digits=3),
    )
    rig = read(found.to_toml())
    assert "bristle_stiffness" in rig.estimates.not_fitted
    reading = Measurement(travel=0.2)
    alone = fit(BLOCK, Coulomb, reading)
    assert read(alone.to_toml()).estimates.not_identified == {
        "kinetic_coefficient": "no uncertainty of the reading was stated"
    }
    with pytest.raises(InputError, match="no parameter of coulomb has an interval"):
        alone.law_estimates().draw(alone.law, 10)


@pytest.mark.slow
def test_levels_of_an_axis_whose_load_is_not_known_are_forces():
    v = np.linspace(-1.0, 1.0, 20)
    table = {"velocity": v, "friction": 2.0 * np.sign(v) + 0.01 * np.cos(9.0 * v)}
    assert fit(Axis(inertia=1.0), Coulomb, Measurement(**table)).law_estimates().levels == "forces"
    loaded = fit(Axis(inertia=1.0, load=8.0), Coulomb, Measurement(**table)).law_estimates()
    assert loaded.levels == "per load"
    weighed = fit(Axis(inertia=1.0), Coulomb, Measurement(**table, load=np.full(20, 8.0)))
    assert weighed.law_estimates().levels == "per load"
    assert loaded.largest_speed == 1.0
