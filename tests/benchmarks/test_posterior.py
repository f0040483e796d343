"""The study of the posterior: numbers are compared as asked, and truths are what they say."""

import numpy as np
import pytest
from benchmarks.band_verdict import handed_over
from benchmarks.posterior import fits, numbers, study
from benchmarks.real_records import Law, plain_error, watched

from stickslip import Axis, Measurement, select

V = np.geomspace(0.05, 1.0, 12)
BOTH = np.concatenate([-V[::-1], V])
AXIS = Axis(inertia=1.0)


def table(seed=0, noise=0.01):
    random = np.random.default_rng(seed)
    read = 2.0 * np.sign(BOTH) + BOTH + 0.3 + noise * random.normal(size=len(BOTH))
    return Measurement(velocity=BOTH, friction=read)


def test_a_number_is_met_where_it_is_as_asked():
    assert numbers.least("a", 0.9, 0.9).met
    assert not numbers.most("a", 2.0, 2.1).met
    assert not numbers.held("a", 1.0).met
    assert numbers.least("a", 0.9, float("nan")).met is None
    assert str(numbers.most("peak", 1.0, 0.5, " GB")) == "| peak | <= 1 GB | 0.5 GB | met |"


def test_a_second_table_is_compared_with_the_band_and_with_coulomb_viscous_friction():
    with watched() as seen:
        verdict = select(AXIS, None, table(), validate=table(seed=1))
    ((problem, rows, found),) = seen
    assert problem is verdict.judgement.problem
    assert found.inside == verdict.inside
    values = found.measured
    assert plain_error(problem, rows, values) == pytest.approx(0.01, rel=0.5)
    # what is not in the published law is fitted beside it
    law = Law(level=2.0, viscous=1.0, offset=0.3)
    assert plain_error(problem, rows, values, law) == pytest.approx(0.01, rel=0.5)
    law = Law(level=3.0, viscous=1.0, offset=0.3)
    assert plain_error(problem, rows, values, law) == pytest.approx(1.0, rel=0.1)


def test_a_law_handed_over_is_as_far_from_the_band_as_stated():
    found = handed_over(select(AXIS, None, table()))
    assert found is not None
    assert found.holds
    assert found.off < 0.02 <= found.stated


def test_noise_alone_has_no_friction_and_a_weak_law_has():
    random = np.random.default_rng(3)
    read = np.asarray(study.frictionless(random).friction)
    assert abs(np.mean(read)) < 5.0 * np.std(read) / np.sqrt(len(read))
    weak = study.weak(random)
    sides = np.sign(np.asarray(weak.velocity)) * np.asarray(weak.friction)
    assert np.mean(sides) > 3.0 * np.std(sides) / np.sqrt(len(sides))


def test_a_swing_loses_energy_and_its_length_is_given_off():
    one = study.swing(4, 1)
    assert 0.001 <= abs(one.told.length / one.length - 1.0) <= 0.003
    first, last = (np.ptp(one.position[part]) for part in (slice(200), slice(-200, None)))
    assert 0.02 < last / first < 0.9


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["decays", "steps", "travels"])
def test_select_with_one_law_gives_the_numbers_of_fit_for_other_kinds(kind):
    result = fits.fitted(kind, 1, 0)
    assert result.held
    assert not result.refused
    assert result.apart == 0.0


def test_intervals_of_fits_are_counted_by_whether_the_law_is_right(monkeypatch):
    def fitted(kind, seed, number):
        exact = number % 2 == 0
        return fits.Fitted(
            kind=kind, truth="level", number=number, exact=exact, held={"a": exact, "b": True},
            missed={}, unbounded=1, apart=None, seconds=2.0,
        )  # fmt: skip

    monkeypatch.setattr(fits, "fitted", fitted)
    right, off, time = numbers.fit_coverage(numbers.Asked(seed=1, quick=True), "servos")
    assert right.measured == "1.000 of 4, 2 not bounded"
    assert off.measured == "0.500 of 4, 2 not bounded"
    assert not off.met
    assert time.met
