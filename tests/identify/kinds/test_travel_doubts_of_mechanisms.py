"""Uncertainties of stiffness, mass and compression in the intervals of fits to travels.

The oracle is the released block: mu = k x_0^2 / (2 m g s).
"""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import least_squares

from stickslip import (
    Coulomb,
    CoulombViscous,
    Measurement,
    SpringBlock,
    Viscous,
    fit,
    load_rig,
    select,
    simulate,
)
from stickslip.errors import InputError
from stickslip.identify.criteria import limits_of
from stickslip.identify.fits.travel_model import trials_of

BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
K, M, X = "mechanism.stiffness", "mechanism.mass", "mechanism.compression"
NORMAL_95 = 1.959963984540054


def mu_of(k, m, x, s):
    return k * x**2 / (2.0 * m * 9.81 * s)


def travels(settings, values, error=0.001, parameter_uncertainties=None, own=None):
    return Measurement(
        trials=tuple(
            Measurement(
                travel=s,
                uncertainty=error or {},
                overrides={X: x},
                parameter_uncertainties=own or {},
            )
            for x, s in zip(settings, values, strict=True)
        ),
        parameter_uncertainties=parameter_uncertainties or {},
    )


@pytest.mark.parametrize(
    ("doubts", "variance"),
    [
        ({}, 1.0),
        ({K: 1.0}, 2.0),
        ({M: 0.01}, 2.0),
        ({X: 0.001}, 5.0),
        ({"stiffness": 1.0, "mass": 0.01, "compression": 0.001}, 7.0),
    ],
)
def test_one_travel_has_the_variances_of_the_energy_balance(doubts, variance):
    """Relative variances of k, x_0, m and s add with the factors 1, 4, 1 and 1.

    Intervals are those of Student's t with four degrees of freedom, from draws: 1.9 times as wide.
    """
    reading = Measurement(travel=0.2, uncertainty=0.002, parameter_uncertainties=doubts)
    found = fit(BLOCK, Coulomb, reading).estimates[0]
    expected = NORMAL_95 * 0.01 * math.sqrt(variance)
    assert 1.5 < (found.high - found.low) / 2.0 / found.value / expected < 2.4
    assert found.interval == "95 %"
    shares = {K: 0.01, M: 0.01, X: 0.02}
    for path, error in found.sources.items():
        assert error / found.value == pytest.approx(shares.get(path, 0.01), rel=1e-3)


def test_a_rounded_reading_joins_uncertainties_as_a_standard_error():
    reading = Measurement(
        travel=0.2,
        uncertainty=0.005,
        uncertainty_kind="rounding",
        parameter_uncertainties={"stiffness": 2.0},
    )
    found = fit(BLOCK, Coulomb, reading).estimates[0]
    expected = NORMAL_95 * math.hypot(0.025 / math.sqrt(3.0), 0.02)
    assert 1.5 < (found.high - found.low) / 2.0 / found.value / expected < 2.4


def test_a_viscous_law_has_half_the_slope_with_the_compression():
    """Its equation is linear, so that the travel is proportional to x_0, not to its square."""
    reading = Measurement(travel=0.2, uncertainty=0.002, parameter_uncertainties={X: 0.001})
    found = fit(BLOCK, Viscous, reading).estimates[0]
    assert found.sources[X] / found.sources["readings"] == pytest.approx(1.0, rel=1e-3)


def test_an_uncertain_rig_does_not_make_up_for_an_unstated_reading():
    found = fit(
        BLOCK, Coulomb, Measurement(travel=0.2, parameter_uncertainties={K: 2.0})
    ).estimates[0]
    assert not found.bounded
    assert found.reason == "no uncertainty of the reading was stated"


def test_what_trials_share_is_not_averaged_and_what_is_set_by_hand_is():
    x = np.full(9, 0.1)
    s = [0.2039] * 9
    shared, by_hand = (
        fit(BLOCK, Coulomb, travels(x, s, parameter_uncertainties=doubts)).estimates[0].sources
        for doubts in ({K: 1.0}, {X: 0.001})
    )
    assert shared[K] / shared["readings"] == pytest.approx(0.01 * 203.9 * 3.0, rel=1e-3)
    assert by_hand[X] / by_hand["readings"] == pytest.approx(0.02 * 203.9, rel=1e-3)


def test_a_compression_that_no_trial_sets_is_one_number():
    trials = Measurement(
        trials=tuple(Measurement(travel=s, uncertainty=0.001) for s in (0.203, 0.205)),
        parameter_uncertainties={X: 0.001},
    )
    found = fit(BLOCK, Coulomb, trials).estimates[0].sources
    assert found[X] / found["readings"] == pytest.approx(0.02 * 204.0 * math.sqrt(2.0), rel=1e-2)


def test_a_fit_agrees_with_least_squares_that_has_a_row_for_each_uncertainty():
    """Nuisance parameters with Gaussian priors, solved by SciPy on the closed form."""
    settings = np.array([0.06, 0.08, 0.1, 0.1])
    measured = np.array([0.0747, 0.1290, 0.2060, 0.2051])
    u_s, u_k, u_m, u_x = 0.001, 1.0, 0.02, 0.0008

    def residuals(p):
        mu, k, m, *x = p
        predicted = k * np.array(x) ** 2 / (2.0 * mu * m * 9.81)
        return np.concatenate(
            [
                (measured - predicted) / u_s,
                [(k - 100.0) / u_k, (m - 1.0) / u_m],
                (np.array(x) - settings) / u_x,
            ]
        )

    both = least_squares(residuals, [0.25, 100.0, 1.0, *settings], x_scale="jac", xtol=1e-14)
    error = math.sqrt(np.linalg.inv(both.jac.T @ both.jac)[0, 0])
    doubts = {"stiffness": u_k, "mass": u_m, "compression": u_x}
    found = fit(BLOCK, Coulomb, travels(settings, measured, u_s, doubts)).estimates[0]
    # slopes are taken at the rig as stated: the difference is of second order in 1 % uncertainties
    assert found.value == pytest.approx(both.x[0], rel=2e-3)
    assert 0.9 < (found.high - found.low) / 2.0 / (NORMAL_95 * error) < 1.6


@pytest.mark.slow
def test_intervals_cover_the_truth_in_95_of_100_sets():
    """200 made-up sets: of a binomial with 0.95, 99 % are above 0.91."""
    draw = np.random.default_rng(7)
    settings = np.array([0.06, 0.08, 0.1])
    doubts, hits = {"stiffness": 3.0, "mass": 0.01, "compression": 0.0007}, [0, 0]
    for _ in range(200):
        k, m = 100.0 + 3.0 * draw.normal(), 1.0 + 0.01 * draw.normal()
        x = settings + 0.0007 * draw.normal(size=3)
        s = k * x**2 / (2.0 * 0.25 * m * 9.81) + 0.001 * draw.normal(size=3)
        for i, stated in enumerate((doubts, {})):
            readings = travels(settings, s, parameter_uncertainties=stated)
            (estimate,) = fit(BLOCK, Coulomb, readings).estimates
            hits[i] += estimate.low <= 0.25 <= estimate.high
    assert hits[0] / 200 >= 0.91
    assert hits[1] / 200 < 0.7  # the readings alone promise too much


def test_residuals_that_exceed_do_not_scale_what_trials_share():
    settings, s = [0.06, 0.08, 0.1], [0.080, 0.125, 0.206]
    rough = fit(BLOCK, Coulomb, travels(settings, s))
    both = fit(BLOCK, Coulomb, travels(settings, s, parameter_uncertainties={K: 3.0}))
    assert rough.standard_errors[1] > 2e-3  # 1 mm was stated
    (one,), (other,) = rough.estimates, both.estimates
    assert other.sources[K] / other.value == pytest.approx(0.03, rel=0.02)
    assert other.half_width > one.half_width


def test_sources_are_those_of_the_scatter_that_residuals_show():
    s = [0.0740, 0.0728, 0.1320, 0.1290, 0.2010, 0.2070]
    trials = tuple(
        Measurement(travel=one, overrides={X: x})
        for x, one in zip(np.repeat([0.06, 0.08, 0.1], 2), s, strict=True)
    )
    fitted = fit(BLOCK, Coulomb, Measurement(trials=trials, parameter_uncertainties={K: 1.0}))
    (estimate,) = fitted.estimates
    scatter = math.sqrt(sum(r * r for r in fitted.residuals) / 5)
    weight = math.sqrt(sum(p * p for p in fitted.predicted))
    # errors are tried on a grid, and may grow with the travel
    assert estimate.sources["readings"] / estimate.value == pytest.approx(scatter / weight, rel=0.5)
    assert estimate.sources[K] / estimate.value == pytest.approx(0.01, rel=1e-2)


def test_without_uncertainties_of_the_rig_nothing_changes():
    s = [0.0735, 0.1300, 0.2039]
    found = fit(BLOCK, CoulombViscous, travels([0.06, 0.08, 0.1], s))
    assert all(estimate.sources == {} for estimate in found.estimates)
    pairs = zip(found.residuals, found.standard_errors, strict=True)
    assert found.chi_square == pytest.approx(sum((r / e) ** 2 for r, e in pairs))
    assert "standard_error_from" not in found.estimates[0].to_dict()


def test_a_law_that_is_moved_more_by_the_settings_is_not_taken_for_that():
    """Travels that grow as x^1.5 are as far from x^2 (Coulomb) as from x (viscous).

    Uncertain settings move the travels of Coulomb friction twice as much, so that its chi-square is
    smaller; that its travels would scatter more speaks against it as much.
    """
    settings = np.array([0.06, 0.08, 0.1])
    reading = travels(settings, 0.2 * (settings / 0.1) ** 1.5, parameter_uncertainties={X: 0.0045})
    fitted, other = (fit(BLOCK, law, reading) for law in (Coulomb, Viscous))
    assert other.chi_square - fitted.chi_square > 5.02  # the 97.5 % quantile, one degree of freedom
    verdict = select(BLOCK, [Coulomb, Viscous], reading)
    assert {*verdict.set} == {("coulomb",), ("viscous",)}


def test_the_verdict_says_what_limits_the_interval():
    reading = Measurement(travel=0.2, uncertainty=0.001, parameter_uncertainties={K: 2.0})
    verdict = select(BLOCK, [Coulomb], reading)
    said = " ".join(verdict.words.settles)
    assert "The stiffness (2 %) contributes more to its uncertainty than the reading." in said
    better = select(BLOCK, [Coulomb], replace(reading, parameter_uncertainties={K: 0.1}))
    said = " ".join(better.words.settles)
    assert "The reading contributes more to its uncertainty than the stiffness (0.1 %)." in said


def test_the_verdict_names_a_setting_by_hand_in_millimetres():
    s = [mu_of(100.0, 1.0, x, 0.25) for x in (0.06, 0.08, 0.1)]
    reading = travels([0.06, 0.08, 0.1], s, error=0.0005, parameter_uncertainties={X: 0.001})
    said = " ".join(limits_of(select(BLOCK, [Coulomb], reading).best.fit))
    assert "The compression (1 mm) contributes more to its uncertainty than the readings." in said


def test_repeats_that_were_set_anew_do_not_contradict_each_other():
    settings, s = [0.06, 0.1, 0.1], [0.0734, 0.1960, 0.2110]
    reading = travels(settings, s, error=0.0003)
    said = " ".join(select(BLOCK, [Coulomb], reading).words.cannot_tell)
    assert "about every law, more than the 0.3 mm stated." in said
    anew = select(BLOCK, [Coulomb], replace(reading, parameter_uncertainties={X: 0.002}))
    assert "about every law" not in " ".join(anew.words.cannot_tell)


RIG = """
[mechanism]
type = "spring-block"
mass = { value = "1 kg", uncertainty = "10 g" }
stiffness = { value = "100 N/m", uncertainty = "2 %" }
compression = { value = "100 mm", uncertainty = 0.0005 }

[[trial]]
set = { compression = { value = "60 mm", uncertainty = "1 mm" } }
travel = "72 mm"
uncertainty = "1 mm"

[[trial]]
travel = "200 mm"
uncertainty = "1 mm"
"""


def test_a_rig_file_states_them(tmp_path):
    path = tmp_path / "rig.toml"
    path.write_text(RIG)
    rig = load_rig(path)
    assert rig.parameter_uncertainties == pytest.approx({M: 0.01, K: 2.0, X: 0.0005})
    first, second = trials_of(rig.mechanism, rig.measurement, 10.0)
    assert first.mechanism.compression == 0.06
    assert first.doubts == pytest.approx({X: 0.001})
    assert second.doubts == pytest.approx({X: 0.0005})
    assert first.shared == second.shared == pytest.approx({M: 0.01, K: 2.0})


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('"2 %"', '"2 kg"', r"\(u_k\) must be in N/m"),
        ('"2 %"', "0", r"\(u_k\) must be above 0 N/m"),
        ('"2 %"', '"-1 %"', r"\(u_k\) must be above 0"),
        ('"2 %" }', '"2 %", vary = true }', "vary = true and an uncertainty"),
        ("uncertainty = 0.0005", "uncertainy = 0.0005", "keys value and vary or uncertainty"),
        ('value = "60 mm", ', "", "compression.uncertainty"),
    ],
)
def test_a_rig_file_that_states_them_wrongly_is_refused(tmp_path, old, new, said):
    path = tmp_path / "rig.toml"
    path.write_text(RIG.replace(old, new))
    with pytest.raises(InputError, match=said):
        load_rig(path)


def test_uncertainties_of_what_is_not_there_are_refused():
    with pytest.raises(InputError, match="stifness"):
        fit(BLOCK, Coulomb, Measurement(travel=0.2, parameter_uncertainties={"stifness": 1.0}))
    with pytest.raises(InputError, match="upper_stop, but SpringBlock has no such value"):
        fit(BLOCK, Coulomb, Measurement(travel=0.2, parameter_uncertainties={"upper_stop": 1.0}))
    with pytest.raises(InputError, match="above 0, in the SI unit of the parameter, got 0"):
        Measurement(travel=0.2, parameter_uncertainties={K: 0.0})


def test_unstated_readings_are_not_trusted_against_what_trials_share():
    """Settings that the stiffness moves unalike: nothing may be solved for it from the scatter."""
    draw = np.random.default_rng(3)
    settings = np.tile([0.02, 0.03, 0.05, 0.06], 3)
    rig = SpringBlock(mass=0.82, stiffness=145.0, compression=0.06)
    law = Coulomb(kinetic_coefficient=0.31)
    exact = [
        float(simulate(replace(rig, compression=x), law, t_end=2.0)["x"][-1]) for x in settings
    ]
    s = np.round(np.array(exact) + 0.001 * draw.normal(size=settings.size), 4)

    def level(doubts, **stated):
        trials = [
            Measurement(travel=float(one), overrides={"mechanism.compression": x}, **stated)
            for one, x in zip(s, settings, strict=True)
        ]
        record = Measurement(trials=trials, parameter_uncertainties=doubts)
        (found,) = fit(rig, Coulomb, record).estimates
        return found

    doubts = {"mechanism.stiffness": 0.02 * 145.0, "mechanism.mass": 0.005}
    bare, known, open_ = level({}), level(doubts, uncertainty=0.001), level(doubts)
    assert open_.low < 0.31 < open_.high
    # 2 % of the stiffness beside the scatter, which is the same whether it is stated or not
    assert open_.high - open_.low == pytest.approx(known.high - known.low, rel=0.25)
    assert open_.high - open_.low > bare.high - bare.low
