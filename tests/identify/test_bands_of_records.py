"""Bands of records: new readings, stated uncertainties, records that differ, drawn laws."""

import json
from dataclasses import replace

import numpy as np
import pytest

from stickslip import Axis, Measurement, select, simulate
from stickslip.errors import InputError
from stickslip.friction import law
from stickslip.identify.problems.record_signals import records_of
from stickslip.mechanisms.drives import PiecewiseLinear

RATE, SECONDS = 500.0, 8.0
T = np.arange(0.0, SECONDS, 1.0 / RATE)
INERTIA, NOISE = 0.02, 0.02
AXIS = Axis(inertia=INERTIA)
LAW = law("level + viscous")(kinetic_coefficient=1.0, viscous_coefficient=0.3)


def record(seed, friction=LAW):
    """An axis under a known torque, read with noise of torque and position."""
    random = np.random.default_rng(seed)
    phases = random.uniform(0.0, 2.0 * np.pi, 4)
    waves = zip((1.2, 0.8, 0.6, 0.4), (0.4, 0.9, 1.7, 3.1), phases, strict=True)
    force = sum(a * np.sin(2.0 * np.pi * f * T + p) for a, f, p in waves)
    axis = replace(AXIS, drive=PiecewiseLinear(times=T, values=force))
    x = simulate(axis, friction, t_end=float(T[-1])).at(T)["x"]
    return Measurement(
        time=T,
        position=x + 1e-5 * random.normal(size=len(T)),
        force=force + NOISE * random.normal(size=len(T)),
    )


@pytest.fixture(scope="module")
def verdict():
    return select(AXIS, None, record(1))


def test_bands_of_readings_hold_single_samples_and_another_record_as_often_as_they_say(verdict):
    v = np.geomspace(0.3, 1.5, 2000)
    new = 1.0 + 0.3 * v + NOISE * np.random.default_rng(3).normal(size=len(v))
    problem = verdict.judgement.problem
    other = problem.like(records_of(AXIS, record(2), held=problem.records[0].held))
    for level in (0.95, 0.8, 0.5):
        # of another run friction may differ, as it does not here
        single = verdict.readings(v, level=level)
        assert np.mean((single.low <= new) & (new <= single.high)) > level - 0.05
        band = verdict.judgement.reading_band(other, level)
        inside = np.mean((band.low <= other.response) & (other.response <= band.high))
        assert inside > level - 0.05


def test_stated_uncertainties_widen_bands_and_intervals_and_no_law(verdict):
    doubtful = replace(record(1), parameter_uncertainties={"inertia": 0.1 * INERTIA})
    wide = select(AXIS, None, doubtful)
    v = [2.0, 3.0]
    sizes = [np.subtract(one.band(v).high, one.band(v).low) for one in (verdict, wide)]
    # the motion tells the inertia better than to a tenth
    assert (sizes[1] > 0.9 * sizes[0]).all()  # ends of 400 draws are known to a twentieth
    assert (sizes[1] < 2.0 * sizes[0]).all()
    given = {estimate.path: estimate.value for estimate in verdict.parameters}
    for parameter in wide.parameters:
        assert parameter.path.startswith("friction.")  # what is stated is no estimate
        assert parameter.value == pytest.approx(given[parameter.path], rel=0.02)


def test_an_uncertainty_that_is_nearly_nothing_changes_nothing(verdict):
    exact = select(AXIS, None, replace(record(1), parameter_uncertainties={"inertia": 1e-9}))
    v = np.linspace(0.3, 1.5, 5)
    size = verdict.band(v).high - verdict.band(v).low
    assert exact.band(v).high - exact.band(v).low == pytest.approx(size, rel=0.2)


@pytest.mark.slow
def test_records_whose_friction_differs_are_said_to_differ():
    def said(factors):
        trials = tuple(
            record(k, replace(LAW, kinetic_coefficient=factor)) for k, factor in enumerate(factors)
        )
        found = select(AXIS, None, Measurement(trials=trials))
        return any("3 runs differ by" in sentence for sentence in found.words.cannot_tell)

    assert said((0.9, 1.0, 1.1))
    assert not said((1.0, 1.0, 1.0))


def test_samples_of_a_verdict_are_laws_of_its_band(verdict):
    at = np.array([float(np.asarray(one.force(1.0, 1.0))) for one in verdict.sample(200)])
    assert np.mean(at) == pytest.approx(1.3, abs=0.05)
    band = verdict.band([1.0])
    assert np.mean((band.low < at) & (at < band.high)) > 0.85


@pytest.mark.slow
def test_lugre_is_compared_by_the_bristles_of_its_balance():
    truth = law("dahl(level) + viscous")(
        kinetic_coefficient=1.0, bristle_stiffness=60.0, viscous_coefficient=0.3, yield_exponent=1.0
    )
    found = select(AXIS, ["lugre"], record(5, truth))
    assert found.law.name.startswith("lugre")
    with pytest.raises(InputError, match="memories of Dahl and LuGre"):
        select(AXIS, ["bouc-wen"], record(5, truth))


@pytest.mark.slow
def test_a_second_record_with_other_friction_is_said_to_differ():
    """A third more friction, which is more than runs usually differ by."""
    again = record(2)
    way = np.sign(np.gradient(again.position))
    more = replace(again, force=np.asarray(again.force) + 0.35 * way)
    texts = {}
    for name, other in (("alike", again), ("more", more)):
        found = select(AXIS, None, record(1), validate=other)
        texts[name] = json.dumps(found.to_dict())
        assert (found.inside >= 0.9) == (name == "alike")
    assert "as expected" in texts["alike"]
    assert "it differs by more than this measurement shows" in texts["more"]
