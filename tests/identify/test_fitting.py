"""Fits of travels: closed forms, intervals, refusals."""

import pytest
from tests.support import rounded_travels

from stickslip import (
    Coulomb,
    CoulombViscous,
    Dahl,
    Measurement,
    SpringBlock,
    Stribeck,
    Viscous,
    fit,
    select,
    simulate,
)
from stickslip.errors import ConvergenceError, InputError, ParameterError, UnknownNameError
from stickslip.paper.printed import positive_root

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
READING = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind="rounding")


def energy_balance(travel):
    return 100.0 * 0.1**2 / (2.0 * 9.81 * travel)


def test_one_travel_gives_the_coefficient_of_the_energy_balance():
    result = fit(RIG, Coulomb, READING)
    # the root is sought to 1e-11 of its value and the travel is exact to 1e-12
    assert result.law.kinetic_coefficient == pytest.approx(energy_balance(0.20), rel=1e-9)


@pytest.mark.parametrize(("kind", "sigma"), [("rounding", 0.005 / 3.0**0.5), ("standard", 0.005)])
def test_the_interval_holds_what_the_reading_allows(kind, sigma):
    reading = Measurement(travel=0.20, uncertainty=0.005, uncertainty_kind=kind)
    (estimate,) = fit(RIG, Coulomb, reading).estimates
    # 1.96 standard errors of the reading, through the energy balance; those of draws of Student's t
    # with four degrees of freedom are 1.9 times as wide
    low, high = (energy_balance(0.20 + x * sigma) for x in (1.96, -1.96))
    assert estimate.low < low < high < estimate.high
    assert estimate.high - estimate.low < 2.4 * (high - low)
    assert estimate.interval == "95 %"


def test_a_reading_without_uncertainty_leaves_the_parameter_unbounded_and_says_why():
    (estimate,) = fit(RIG, Coulomb, Measurement(travel=0.20)).estimates
    assert not estimate.bounded
    assert "no uncertainty" in estimate.reason


@pytest.mark.parametrize("law", [Coulomb, Viscous, CoulombViscous, Stribeck, Dahl])
def test_the_fitted_law_reproduces_the_travel(law):
    result = fit(RIG, law, READING)
    # a search ends where a step changes nothing that readings tell apart, 1e-5 of a travel
    assert result.predicted[0] == pytest.approx(0.20, rel=1e-5)


def test_three_travels_give_both_parameters_of_the_law_that_made_them():
    truth = CoulombViscous(kinetic_coefficient=0.22, viscous_coefficient=0.5)
    result = fit(RIG, CoulombViscous, rounded_travels(RIG, truth, (0.06, 0.1, 0.15), digits=9))
    # readings are rounded to 1e-9 m, which is 1e-8 of the travels
    assert result.law.kinetic_coefficient == pytest.approx(0.22, rel=1e-5)
    assert result.law.viscous_coefficient == pytest.approx(0.5, rel=1e-5)


def test_intervals_of_rounded_travels_cover_the_truth():
    truth = CoulombViscous(kinetic_coefficient=0.22, viscous_coefficient=0.5)
    result = fit(
        RIG, CoulombViscous, rounded_travels(RIG, truth, (0.05, 0.07, 0.1, 0.12, 0.15), digits=3)
    )
    for estimate, true in zip(result.estimates, (0.22, 0.5), strict=True):
        assert estimate.low < true < estimate.high


def test_a_travel_that_no_value_can_give_is_said_so():
    far = Measurement(travel=0.20, uncertainty=0.005, overrides={"mechanism.mass": 1.0})
    law = CoulombViscous(kinetic_coefficient=0.4, viscous_coefficient=0.5)
    with pytest.raises(ConvergenceError, match=r"viscous_coefficient.*travel of 0\.2 m"):
        fit(RIG, law, far, vary=["viscous_coefficient"])


def test_more_parameters_than_travels_are_refused():
    with pytest.raises(InputError, match=r"1 travel cannot determine 2"):
        fit(RIG, CoulombViscous, READING, vary=["kinetic_coefficient", "viscous_coefficient"])


def test_an_unknown_parameter_names_the_nearest_known_one():
    with pytest.raises(UnknownNameError, match=r"friction\.kinetic_coefficient"):
        fit(RIG, Coulomb, READING, vary=["kinetic_coeficient"])


def test_a_record_of_two_samples_is_refused():
    series = Measurement(time=[0.0, 1.0], position=[0.0, 1.0])
    with pytest.raises(InputError, match="has only 2 samples: a fit needs at least 10"):
        fit(RIG, Coulomb, series)


def test_progress_counts_the_runs():
    seen = []
    result = fit(RIG, Coulomb, READING, progress=seen.append)
    assert seen == sorted(set(seen))  # an ensemble at a time
    assert seen[-1] == result.runs


def test_a_function_whose_values_have_a_product_of_zero_has_no_root_unless_its_sign_changes():
    assert positive_root(lambda x: 1e-200 * (1.0 + x), 1.0, 1e-3, 1e3) is None
    assert positive_root(lambda x: 1e-200 * (x - 2.0), 1.0, 1e-3, 1e3) == pytest.approx(
        2.0, rel=1e-9
    )


@pytest.mark.parametrize("travel", [-1e29, 1e-29, 1e29])
def test_a_travel_at_the_ends_of_its_range_is_one_that_no_law_reaches(travel):
    reading = Measurement(travel=travel, uncertainty=0.1 * abs(travel))
    law = Coulomb(kinetic_coefficient=0.25, static_coefficient=0.3)
    with pytest.raises(InputError, match="no law can be fitted to these travels"):
        select(RIG, {"coulomb": law}, reading, t_end=10.0)


@pytest.mark.parametrize("travel", [-1e80, 1e-80, 1e-31, 1e31, 1e80])
def test_a_travel_whose_square_need_not_be_a_number_is_refused(travel):
    with pytest.raises(ParameterError, match=r"travel \(s\) must be 0 or .* 1e-30 to 1e\+30 m"):
        Measurement(travel=travel)
    with pytest.raises(ParameterError, match=r"travel \(u_s\) must be 0 or .* 1e-30 to 1e\+30 m"):
        Measurement(travel=0.2, uncertainty=abs(travel))


@pytest.mark.parametrize("given", ["overrides", "initial", "offset", "parameter_uncertainties"])
def test_numbers_beside_a_travel_are_of_a_size_that_can_be_computed_with(given):
    named = {"offset": "travel"}.get(given, "v")
    with pytest.raises(ParameterError, match=f"{given} of '{named}' must be 1e.30 at most"):
        Measurement(travel=0.2, **{given: {named: 1e308}})


def test_an_interval_reaches_over_all_values_that_give_the_travel():
    attached = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1, attached=True)
    given = Coulomb(kinetic_coefficient=0.25)
    travel = float(simulate(attached, given, t_end=10.0).at(10.0)["x"][0])
    result = fit(attached, given, Measurement(travel=travel, uncertainty=0.0005))
    # the start gives the travel itself; weaker friction lets the block swing once more to there
    assert result.law.kinetic_coefficient == pytest.approx(0.25, rel=1e-6)
    (level,) = result.estimates
    assert level.low < 0.036
    assert level.high > 0.25
    again = simulate(attached, Coulomb(kinetic_coefficient=0.03462), t_end=10.0).at(10.0)["x"][0]
    assert float(again) == pytest.approx(travel, abs=0.0005)


def test_a_stop_at_the_very_instant_of_leaving_the_spring_does_not_end_a_fit():
    # doubling the answer lands on k x0 / (2 m g), where stop and leaving coincide
    result = fit(RIG, Coulomb, Measurement(travel=0.20, uncertainty=0.005))
    assert result.law.kinetic_coefficient == pytest.approx(energy_balance(0.20), rel=1e-9)


@pytest.mark.slow
def test_bristle_stiffness_is_not_fitted_to_travels():
    soft = Dahl(kinetic_coefficient=0.25, bristle_stiffness=1e3, static_switch=True)
    result = fit(
        RIG,
        soft,
        rounded_travels(RIG, Coulomb(kinetic_coefficient=0.25), (0.06, 0.1, 0.15), digits=4),
    )
    paths = [estimate.path for estimate in result.estimates]
    assert paths == ["friction.kinetic_coefficient", "friction.viscous_coefficient"]


def test_each_trial_keeps_the_kind_of_its_own_uncertainty():
    truth = Coulomb(kinetic_coefficient=0.25)
    readings = rounded_travels(RIG, truth, (0.08, 0.12), digits=3).records()
    mixed = Measurement(
        trials=(
            readings[0],
            Measurement(
                travel=readings[1].travel,
                uncertainty=0.0005,
                overrides=readings[1].overrides,
                name="stated as a standard error",
            ),
        )
    )
    (rounded,) = fit(RIG, Coulomb, Measurement(trials=readings)).estimates
    (stated,) = fit(RIG, Coulomb, mixed).estimates
    # half a last digit is 1.7 standard errors of a uniform distribution
    assert stated.high - stated.low > rounded.high - rounded.low


def test_trials_that_differ_in_their_start_are_different_settings():
    free = SpringBlock(mass=1.0)
    law = CoulombViscous(kinetic_coefficient=0.25, viscous_coefficient=0.8)
    readings = tuple(
        Measurement(
            travel=float(simulate(free, law, t_end=10.0, y0={"v": v}).at(10.0)["x"][0]),
            uncertainty=1e-6,
            initial={"v": v},
            name=f"{v:g} m/s",
        )
        for v in (0.5, 1.0, 2.0)
    )
    result = fit(free, CoulombViscous, Measurement(trials=readings))
    # exact travels; the fit stops at 1e-8 of them
    assert result.law.kinetic_coefficient == pytest.approx(0.25, rel=1e-5)
    assert result.law.viscous_coefficient == pytest.approx(0.8, rel=1e-5)
