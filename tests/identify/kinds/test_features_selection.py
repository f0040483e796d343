"""`fit` and `select` on the force of a spring that pulls a block: by features of stick-slip."""

import json
from dataclasses import replace

import numpy as np
import pytest
from benchmarks import pulled_sliders

from stickslip import (
    Coulomb,
    LuGre,
    Measurement,
    QuadraticDrag,
    RecordSettings,
    Stribeck,
    TowedBlock,
    Viscous,
    fit,
    load_measurement,
    load_rig,
    select,
    simulate,
)
from stickslip.errors import ConvergenceError, InputError
from stickslip.identify import SimulatedFit, SimulatedVerdict
from stickslip.identify.kinds.features import limit_cycle

REAL = TowedBlock(mass=0.021, stiffness=1000.0, speed=4e-3, load=0.3)
STATED = replace(REAL, mass=0.03)
TRUTH = Coulomb(kinetic_coefficient=0.28, static_coefficient=0.32)
FREE = ["friction.*", "mechanism.mass"]


def pulled(*, noise=5e-4, seed=0, end=4.5, speed=4e-3, truth=TRUTH):
    t = np.arange(0.5, end, 5e-4)
    run = simulate(replace(REAL, speed=speed), truth, t_end=end).at(t)
    scatter = np.random.default_rng(seed).normal(0.0, noise, len(t))
    return Measurement(time=t, spring_force=1000.0 * (speed * t - run["x"]) + scatter)


@pytest.fixture(scope="module")
def record():
    return pulled()


@pytest.fixture(scope="module")
def verdict(record):
    return select(STATED, [Stribeck, Coulomb], record, vary=FREE)


@pytest.fixture(scope="module")
def fitted(record):
    return fit(STATED, Coulomb, record, vary=FREE)


def test_the_force_of_a_spring_is_fitted_by_its_features(fitted):
    assert isinstance(fitted, SimulatedFit)
    for name, true in (("mass", REAL.mass), ("kinetic_coefficient", 0.28),
                       ("static_coefficient", 0.32)):  # fmt: skip
        found = fitted.estimate(name)
        assert found.low < true < found.high
        assert found.bounded
    assert fitted.rms < 0.01


def test_a_selection_among_one_law_has_the_numbers_of_the_fit(record, fitted):
    found = select(STATED, [Coulomb], record, vary=FREE)
    assert [str(one) for one in found.best.fit.estimates] == [str(one) for one in fitted.estimates]


@pytest.mark.slow
def test_a_fit_is_saved_as_a_rig_that_simulates_the_same_limit_cycle(fitted, tmp_path):
    fitted.save(tmp_path / "fitted.toml")
    rig = load_rig(tmp_path / "fitted.toml")
    assert rig.mechanism == fitted.mechanism
    assert rig.laws["coulomb"] == fitted.law
    t = np.arange(0.0, 1.0, 1e-3)
    force = limit_cycle(fitted, t) / REAL.load
    # whole cycles to within one of some 35: mean and spread are those of the fitted features
    assert force.mean() == pytest.approx(fitted.details["predicted"]["mean"], rel=0.01)
    assert force.std() == pytest.approx(fitted.details["predicted"]["standard_deviation"], rel=0.03)


@pytest.mark.slow
def test_a_mass_that_is_held_stays_and_one_that_is_stated_does_not(record):
    held = fit(STATED, Coulomb, record, fixed={"mass": 0.03})
    assert held.mechanism.mass == 0.03
    stated = replace(record, parameter_uncertainties={"mechanism.mass": 0.01})
    found = fit(STATED, Coulomb, stated)
    assert found.estimate("mass").low < REAL.mass < found.estimate("mass").high


@pytest.mark.slow
def test_laws_that_have_the_same_three_features_are_not_ranked(verdict):
    assert isinstance(verdict, SimulatedVerdict)
    assert {verdict.best.name, *verdict.rivals} == {"coulomb", "stribeck"}
    assert not verdict.ranked
    assert "cannot rule out" in verdict.sentence
    assert verdict.words.no_score
    assert sum(one.share for one in verdict.candidates) == pytest.approx(1.0)
    assert any("over all laws that have it" in line for line in verdict.words.settles)


def test_an_effective_mass_is_named(verdict):
    mass = verdict.best.fit.estimate("mass")
    assert f"The effective mass is {mass.plus_minus}." in verdict.words.lede
    assert mass.low < REAL.mass < mass.high
    assert any("spring stiffer" in line for line in verdict.words.cannot_tell)
    assert any("Weigh the moving parts" in line for line in verdict.words.measure_next)


def test_a_verdict_is_plain_numbers(verdict):
    content = json.loads(json.dumps(verdict.to_dict()))
    assert content["best"] == verdict.best.name
    assert content["route"] == "features"
    assert content["candidates"][0]["fit"]["observed"]["regime"] == "inertial oscillation"
    assert {c["law"] for c in content["candidates"]} == {"coulomb", "stribeck"}
    assert "<table" in verdict._repr_html_()


def test_other_settings_are_ordered_by_what_they_would_leave(verdict):
    left = [one.expected_width for one in verdict.advised]
    assert left == sorted(left)
    assert 0.0 <= left[0] <= left[-1] <= 1.0
    assert set(verdict.advised[0].predicted) == {"coulomb", "stribeck"}
    assert any("give both records as trials" in line for line in verdict.words.measure_next)


@pytest.mark.slow
def test_records_at_two_speeds_tell_more_than_one(record):
    law = Stribeck(kinetic_coefficient=0.2, static_coefficient=0.32, stribeck_velocity=0.02)
    slow, fast = (pulled(speed=v, truth=law, end=end) for v, end in ((1e-3, 8.5), (8e-3, 4.5)))
    both = Measurement(trials=(
        replace(slow, overrides={"mechanism.speed": 1e-3}),
        replace(fast, overrides={"mechanism.speed": 8e-3}),
    ))  # fmt: skip
    found = select(REAL, [Coulomb, Stribeck], both)
    assert found.best.name == "stribeck"
    band = found.predict(replace(REAL, speed=4e-3))
    seen = fit(REAL, Coulomb, pulled(truth=law)).problem.first.features.compared
    assert np.all((band.low < seen) & (seen < band.high))


def test_where_no_limit_cycle_is_right_no_law_is_recommended(record):
    found = select(STATED, [Coulomb], record, fixed={"mass": 0.03, "stiffness": 1000.0})
    assert found.best is None
    assert "No law compared explains these features" in found.sentence
    assert "frequency" in found.closest.fit.details["missed"]
    assert any("Fit the mass as well" in line for line in found.words.measure_next)


def test_a_law_without_a_level_is_kept_with_the_reason(record):
    found = select(STATED, [Coulomb, Viscous], record, vary=FREE)
    assert found.best.name == "coulomb"
    assert found.candidates[1].fit is None
    assert "no friction level" in found.candidates[1].outcome
    row = json.loads(json.dumps(found.to_dict(), allow_nan=False))["candidates"][1]
    assert row["frequency_error"] is row["fit"] is None
    with pytest.raises(InputError, match="no friction level"):
        select(STATED, [Viscous], record)


def test_a_law_without_a_step_has_no_limit_cycle(record):
    with pytest.raises(ConvergenceError, match="limit cycle"):
        fit(STATED, QuadraticDrag, record, vary=FREE)


@pytest.mark.slow
def test_a_law_with_bristles_is_judged_where_it_is_named(record):
    found = fit(REAL, LuGre, record)
    level = found.estimate("kinetic_coefficient")
    assert level.low < 0.28 < level.high


@pytest.mark.slow
def test_a_second_record_judges_every_law(record):
    second = pulled(seed=1, end=3.0)
    found = select(STATED, [Coulomb], record, vary=FREE, validate=second)
    assert set(found.best.second) == {"frequency", "mean", "standard_deviation"}
    # the same block and law: features of noise differ by less than they are fitted to
    assert max(map(abs, found.best.second.values())) < 0.02


def test_false_of_the_watcher_ends_a_search_with_the_best_so_far(record):
    heard = []

    def watch(rms):
        heard.append(rms)
        return False

    found = fit(STATED, Coulomb, record, vary=FREE, progress=watch)
    assert found.cancelled
    assert heard


@pytest.mark.slow
def test_the_route_can_be_asked_for_where_motion_was_measured_too():
    t = np.arange(0.5, 4.5, 5e-4)
    run = simulate(REAL, TRUTH, t_end=4.5).at(t)
    both = Measurement(time=t, position=run["x"], spring_force=1000.0 * (4e-3 * t - run["x"]))
    found = fit(STATED, Coulomb, both, vary=FREE, route="features")
    assert isinstance(found, SimulatedFit)


def test_what_features_have_no_use_for_is_refused(record):
    with pytest.raises(InputError, match="starts applies to"):
        select(STATED, [Coulomb], record, settings=RecordSettings(starts=3))
    held = {"kinetic_coefficient": 0.28, "static_coefficient": 0.32}
    with pytest.raises(InputError, match="nothing to fit"):
        fit(STATED, Coulomb, record, fixed=held)


def test_friction_under_a_load_point_takes_rate_and_state_laws():
    t = np.arange(0.0, 10.0, 0.1)
    steps = Measurement(time=t, pull=1e-6 * t, friction=0.6 + 0.0 * t, load=1.0)
    with pytest.raises(InputError, match="A fit to velocity steps takes a RateState"):
        fit(STATED, Coulomb, steps)


def slider(data_dir, name, stiffness, speed):
    load = 0.0307 * 9.81
    record = load_measurement(
        data_dir / "spring_pulled_slider" / f"{name}.parquet",
        columns={"time": "t_s", "spring_force": "F_over_mg"},
        gain={"spring_force": load},
    )
    return TowedBlock(mass=0.0307, stiffness=stiffness, speed=speed, load=load), record


@pytest.mark.slow
def test_the_stiff_fast_slider_has_an_effective_mass_and_no_ranking(data_dir):
    block, record = slider(data_dir, "k1002_v4300", 1002.0, 4.3e-3)
    found = select(block, [Coulomb, Stribeck], record, vary=FREE)
    assert not found.ranked
    mass = found.closest.fit.estimate("mass")
    # the frequency is 1.23 times that of the nominal mass, and the stiffness known to 10 %
    assert mass.low < 0.0307 / 1.23**2 < mass.high < 0.0307


def test_the_scatter_of_the_slow_slider_is_said_to_be_that_of_no_law(data_dir):
    block, record = slider(data_dir, "k168_v42", 168.0, 42e-6)
    found = select(block, [Coulomb], record)
    assert any("cannot explain the scatter" in line for line in found.words.cannot_tell)


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "number"), [(4101, 2), (4101, 8)])
def test_levels_of_stribeck_friction_lie_in_what_is_said_of_all_laws(seed, number):
    row = pulled_sliders.pulled(seed, number)
    assert row["truth"] == "stribeck"
    assert "stribeck" in (row["named"], *row["ties"])
    assert not row["false"]
