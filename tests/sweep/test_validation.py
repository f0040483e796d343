"""A law from elsewhere against what was measured: residuals, bands, verdicts, refits."""

import dataclasses
import math
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

from stickslip import (
    Axis,
    BlockChain,
    Coulomb,
    Measurement,
    PendulumCart,
    SpringBlock,
    fit,
    simulate,
)
from stickslip.data import LawEstimates
from stickslip.errors import InputError
from stickslip.mechanisms import Prescribed
from stickslip.mechanisms.drives import SampledSwing, SineSwing, ThreePhase
from stickslip.study.sweep import Refit, band_of, compare_estimates, validate

SWING = ThreePhase(amplitude=math.radians(45.0), fast=120.0, slow=30.0)
CART = PendulumCart(cart_mass=0.5, ball_mass=0.1, length=0.3, pendulum=Prescribed(profile=SWING))
LAW = Coulomb(kinetic_coefficient=0.2)
KNOWN = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.199, 0.201)})
NOISE = 3e-4
T = np.arange(0.0, 3.6, 0.01)
BLOCK = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)


def record(kinetic=0.2, *, late=0.0, zero=0.0, noise=NOISE, seed=1, **others):
    run = simulate(CART, Coulomb(kinetic_coefficient=kinetic), t_end=3.7)
    x = run.at(np.maximum(T - late, 0.0))["x"] + zero
    x = x + noise * np.random.default_rng(seed).normal(size=T.size)
    return Measurement(time=T, position=x, **others)


def validated(measured, known=KNOWN, law=LAW, mechanism=CART, count=100, **settings):
    return validate(mechanism, law, measured, known, count=count, **settings)


def test_a_record_of_the_same_friction_agrees_and_its_residual_is_the_noise():
    seen = validated(record())
    (one,) = seen.records
    assert seen.agrees
    assert "agrees with the prediction" in seen.verdict
    # 360 samples: 4 % of the root mean square, and 11 % of the median of differences; twice that
    assert one.rms == pytest.approx(NOISE, rel=0.15)
    assert one.noise == pytest.approx(NOISE, rel=0.25)
    assert not one.late


@pytest.mark.parametrize("measured", [record(), Measurement(travel=0.2, uncertainty=0.01)])
def test_no_executor_changes_what_is_said(measured):
    mechanism = CART if measured.time is not None else BLOCK
    with ThreadPoolExecutor(2) as pool:
        own, other = (
            validated(measured, mechanism=mechanism, executor=value) for value in (None, pool)
        )
    assert own.to_dict() == other.to_dict()


@pytest.mark.slow
@pytest.mark.rounding
def test_a_tenth_more_friction_is_seen_and_the_refit_names_it():
    measured = record(0.22)
    seen = validated(measured)
    assert seen.agrees is False
    assert seen.records[0].inside_with_noise < 0.2
    assert not seen.records[0].late
    found = fit(CART, LAW, measured)
    (estimate,) = compare_estimates(LAW, KNOWN, found)
    assert estimate.agrees is False
    assert "do not agree" in str(estimate)
    # the fit is exact to the noise: a thousandth of the coefficient
    assert estimate.difference == pytest.approx(0.02, abs=2e-4)
    assert Refit(fit=found, parameters=(estimate,)).explains


def test_the_zero_of_an_encoder_says_nothing_of_friction():
    plain, moved = (validated(record(zero=zero)).records[0] for zero in (0.0, 0.05))
    assert moved.rms == pytest.approx(plain.rms, rel=1e-9)
    assert moved.origin - plain.origin == pytest.approx(0.05, abs=1e-12)
    assert "Origin of the position: 50" in " ".join(moved.sentences())


@pytest.mark.slow
def test_a_late_record_does_not_agree_and_its_shift_is_found():
    measured = record(late=0.03)
    seen = validated(measured)
    (one,) = seen.records
    assert seen.agrees is False
    assert one.late
    assert one.shift == pytest.approx(-0.03, abs=1e-3)  # noise over speed and samples
    assert one.shifted_rms == pytest.approx(NOISE, rel=0.25)
    found = fit(CART, LAW, measured)
    refit = Refit(fit=found, parameters=compare_estimates(LAW, KNOWN, found))
    assert refit.explains  # a delay of the drive is an unknown of the fit
    (level,) = found.estimates
    assert level.low <= LAW.kinetic_coefficient <= level.high
    said = " ".join(refit.sentences(seen))
    assert "may be shifted" in said


def test_without_uncertainties_nothing_is_decided():
    for measured in (record(), Measurement(travel=0.279, uncertainty=0.001)):
        seen = validated(measured, None, t_end=3.6)
        assert seen.agrees is None
        assert "cannot be told" in seen.verdict


def test_most_records_of_uncertain_friction_agree():
    random = np.random.default_rng(5)
    spread = 1e-3
    agreed = []
    for seed in range(12):
        best = 0.2 + spread * float(random.normal())
        known = LawEstimates(
            law="coulomb",
            intervals={"kinetic_coefficient": (best - 1.96 * spread, best + 1.96 * spread)},
        )
        law = Coulomb(kinetic_coefficient=best)
        agreed.append(validated(record(seed=seed), known, law, seed=seed).agrees)
    # an expected 1 % are refuted: two or more of 12 have a chance of 0.6 %
    assert agreed.count(False) <= 1


def test_the_band_of_a_travel_is_that_of_the_closed_form():
    measured = Measurement(travel=0.204, uncertainty=0.001)
    known = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.24, 0.26)})
    law = Coulomb(kinetic_coefficient=0.25)
    seen = validated(measured, known, law, BLOCK, count=2000)
    (travel,) = seen.travels
    assert travel.predicted == pytest.approx(0.5 / (9.81 * 0.25), rel=1e-8)
    # quantiles of 2000 draws: 4 % of the half width
    assert travel.low == pytest.approx(0.5 / (9.81 * 0.26), rel=4e-3)
    assert travel.high == pytest.approx(0.5 / (9.81 * 0.24), rel=4e-3)
    assert travel.inside
    assert seen.agrees
    assert validated(Measurement(travel=0.25, uncertainty=0.001), known, law, BLOCK).agrees is False


def test_travels_without_a_stated_uncertainty_are_not_judged():
    known = LawEstimates(law="coulomb", intervals={"kinetic_coefficient": (0.24, 0.26)})
    seen = validated(Measurement(travel=0.3), known, Coulomb(kinetic_coefficient=0.25), BLOCK)
    assert seen.agrees is None
    assert "no uncertainty of the readings was stated" in seen.verdict


def test_travels_per_cycle_are_compared_as_they_were_read():
    measured = Measurement(travel_per_cycle=0.056, uncertainty=1e-3)
    (travel,) = validated(measured, t_end=5.0 * float(SWING.period)).travels
    # the reference cart: 24.8596 mm in the first cycle, 63.4659 mm in each further one
    assert travel.predicted == pytest.approx((0.0248596 + 4 * 0.0634659) / 5, abs=2e-8)
    assert travel.relative_error == pytest.approx((travel.predicted - 0.056) / 0.056)


def test_uncertain_masses_widen_the_band_of_a_block():
    """The travel of a launched block goes with 1 / m, so 2 % of the mass are 2 % of the travel."""
    law = Coulomb(kinetic_coefficient=0.25)
    band = band_of(BLOCK, law, None, t_end=2.0, parameter_uncertainties={"mass": 0.02}, count=2000)
    assert set(band.draws) == {"mechanism.mass"}
    half = 0.5 * (band.travel.high - band.travel.low)
    assert half / band.travel.median == pytest.approx(1.96 * 0.02, rel=0.1)  # quantiles: 4 %


def test_uncertainties_of_trials_are_drawn_for_each_and_shared_ones_once():
    law = Coulomb(kinetic_coefficient=0.25)
    trials = tuple(
        Measurement(travel=0.5 / (9.81 * 0.25), uncertainty=1e-5, name=str(i)) for i in range(6)
    )
    shared = Measurement(trials=trials, parameter_uncertainties={"mechanism.mass": 0.02})
    off = [dataclasses.replace(trial, travel=trial.travel * 1.03) for trial in trials]
    all_off = dataclasses.replace(shared, trials=tuple(off))
    assert validated(all_off, None, law, BLOCK).agrees is not False  # one heavier block
    alone = [
        dataclasses.replace(
            trial,
            travel=trial.travel * (1.03 if i % 2 else 0.97),
            parameter_uncertainties={"mechanism.mass": 0.02},
        )
        for i, trial in enumerate(trials)
    ]
    seen = validated(Measurement(trials=tuple(alone)), None, law, BLOCK)
    assert seen.agrees is not False  # six masses, each 1.5 standard uncertainties off
    assert seen.drawn == ("mechanism.mass",)


def test_the_error_of_a_recorded_swing_is_said_to_be_left_out():
    sine = SineSwing(amplitude=1.0, frequency=1.5)
    times = np.arange(0.0, 3.6001, 0.005)
    swing = SampledSwing(times=times, positions=[sine.at(t)[0] for t in times])
    mechanism = dataclasses.replace(CART, pendulum=Prescribed(profile=swing))
    x = simulate(mechanism, LAW, t_end=3.6).at(T)["x"]
    seen = validated(Measurement(time=T, position=x), mechanism=mechanism)
    assert "recorded swing" in " ".join(seen.sentences())


def test_a_velocity_has_no_origin():
    v = simulate(CART, LAW, t_end=3.7).at(T)["v"]
    noise = 0.01 * np.random.default_rng(1).normal(size=T.size)
    (one,) = validated(Measurement(time=T, velocity=v + noise)).records
    assert (one.quantity, one.origin) == ("velocity", 0.0)


@pytest.mark.parametrize(
    ("mechanism", "measured", "message"),
    [
        (
            Axis(inertia=1.0),
            Measurement(time=[0.0, 1.0], position=[0.0, 0.1], force=[1.0, 1.0]),
            r"driven by what was recorded \(force\)",
        ),
        (
            Axis(inertia=1.0),
            Measurement(time=[0.0, 1.0], position=[0.0, 0.1]),
            "nothing moves in the prediction",
        ),
        (CART, Measurement(time=[-1.0, 1.0], position=[0.0, 0.1]), "begins at −1 s"),
        (CART, Measurement(velocity=[0.1, 0.2], friction=[1.0, 1.0]), "has only velocity and"),
        (
            BlockChain(blocks=2, mass=1.0, coupling=100.0),
            Measurement(travel=0.2),
            "with one contact",
        ),
    ],
)
def test_what_is_no_prediction_is_refused(mechanism, measured, message):
    law = LAW
    if isinstance(mechanism, BlockChain):
        law = {"block-1": LAW, "block-2": LAW}
    with pytest.raises(InputError, match=message):
        validate(mechanism, law, measured, t_end=1.0)


def test_intervals_of_other_laws_are_not_compared():
    found = fit(BLOCK, "viscous", Measurement(travel=0.2, uncertainty=0.001))
    with pytest.raises(InputError, match="takes a fit of coulomb, got one of viscous"):
        compare_estimates(LAW, KNOWN, found)


def test_a_value_without_an_interval_cannot_be_compared():
    found = fit(BLOCK, Coulomb, Measurement(travel=0.2, uncertainty=0.001))
    (estimate,) = compare_estimates(LAW, None, found)
    assert estimate.agrees is None
    assert "cannot be compared, the carried value has no interval" in str(estimate)
