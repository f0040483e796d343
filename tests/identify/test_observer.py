"""Laws as observers of a record: the compiled run, and what refining does to a balance."""

import functools

import numpy as np
import pytest

from stickslip.engine.kernels import observer
from stickslip.engine.solver.compile.states import observe
from stickslip.identify.comparison import compare, family_members
from stickslip.identify.ensemble import Ensemble
from stickslip.identify.observer import Observer
from stickslip.identify.problems.record_signals import Record, bristle
from stickslip.identify.problems.records import RecordsProblem
from stickslip.identify.search import Search

STEP, INERTIA, LEVEL, VISCOUS = 0.001, 0.02, 1.0, 0.3
HALF = 400


def numbers(length=0.0, gain=0.0, rate_gain=0.0):
    p = np.zeros(observer.COUNT)
    p[observer.STEP], p[observer.INERTIA] = STEP, INERTIA
    p[observer.GAIN], p[observer.RATE_GAIN] = gain, rate_gain
    p[observer.LENGTH], p[observer.EXPONENT] = length, 1.0
    p[observer.SPEED_UNIT], p[observer.PLACE_STEP] = 40.0 / HALF**2, 1.0
    return p


def run(function, force, *, length=0.0, place=None, parts=4, **gains):
    """Return the places of an axis, or the innovations where places are given."""
    n, k = len(force), np.arange(2 * HALF + 1) - HALF
    none, out = np.zeros(n), np.zeros(n)
    function(
        n, parts, 1, numbers(length, **gains), force, none if place is None else place,
        np.full(2 * HALF + 1, LEVEL), np.zeros(1), VISCOUS * np.sign(k) * 40.0 * (k / HALF) ** 2,
        np.zeros(1), np.zeros(1), np.ones(n), none.copy(), none.copy(), none.copy(), out,
    )  # fmt: skip
    return -out if place is None else out


def forced(seed, count=8000):
    random = np.random.default_rng(seed)
    t = STEP * np.arange(count)
    waves = zip((0.4, 0.9, 1.7), random.uniform(0.0, 6.0, 3), strict=True)
    return t, sum(1.1 * np.sin(2.0 * np.pi * f * t + phase) for f, phase in waves)


@functools.cache
def judged(length=0.0, seed=0):
    t, force = forced(seed)
    random = np.random.default_rng(seed + 100)
    x = run(observe(), force, length=length, parts=24)
    record = Record(
        time=t, position=x + 3e-5 * random.normal(size=len(t)),
        force=force + 0.03 * random.normal(size=len(t)), held=True,
    )  # fmt: skip
    problem = RecordsProblem([record])
    search = Search(problem).run()
    comparison = compare(search)
    return problem, Ensemble(search.regression, comparison)


@pytest.mark.parametrize("length", [0.0, 0.003])
def test_compiled_and_plain_observers_are_the_same(length):
    _, force = forced(3, 400)
    np.testing.assert_array_equal(
        run(observe(), force, length=length), run(observer.observe, force, length=length)
    )


def test_a_constant_force_accelerates_against_the_level_in_closed_form():
    force = np.full(200, 1.5)
    t = STEP * np.arange(200)
    rate = VISCOUS / INERTIA
    top = (1.5 - LEVEL) / VISCOUS  # v = top (1 - exp(-rate t))
    x = top * (t - (1.0 - np.exp(-rate * t)) / rate)
    # the table of viscous friction over speed is straight between its entries
    np.testing.assert_allclose(run(observe(), force), x, rtol=1e-3, atol=1e-7)


@pytest.mark.parametrize("length", [0.0, 0.003])
def test_errors_fall_with_the_square_of_the_step(length):
    _, force = forced(3, 2000)
    fine = run(observe(), force, length=length, parts=64)
    errors = [np.abs(run(observe(), force, length=length, parts=k) - fine).max() for k in (4, 8)]
    assert errors[0] < 1e-5
    assert errors[1] < 0.5 * errors[0]


def test_a_bristle_of_the_observer_is_that_of_the_balance():
    way = np.diff(np.sin(np.linspace(0.0, 20.0, 500)))
    z, found = 0.0, [0.0]
    for dx in way:
        z = observer.strained(z, 0.1, 1.0, dx)
        found.append(z)
    path = np.concatenate([[0.0], np.cumsum(way)])
    np.testing.assert_allclose(found, bristle(path, 0.1, 1.0), atol=1e-12)


def test_refining_narrows_the_inertia_and_holds_the_truth():
    problem, balance = judged()
    refined = Observer(balance).refined()
    assert refined is not balance

    def interval(ensemble):
        comparison = ensemble.comparison
        members = family_members(comparison, problem.family(comparison.named))
        return np.quantile(ensemble.coefficient("inertia", members), (0.01, 0.99))

    wide, narrow = interval(balance), interval(refined)
    assert narrow[0] <= INERTIA <= narrow[1]
    assert np.ptp(narrow) < 0.5 * np.ptp(wide)


def test_lengths_of_bristles_are_continuous():
    _, balance = judged(length=0.004)
    refined = Observer(balance).refined()
    lengths = [
        dict(structure)["level"][0]
        for structure in refined.comparison.structures
        if "level" in dict(structure)
    ]
    assert min(abs(x / 0.004 - 1.0) for x in lengths) < 0.02


def test_measured_friction_has_nothing_to_simulate():
    t = STEP * np.arange(3000)
    record = Record(time=t, position=np.sin(2.0 * t), force=np.sign(np.cos(2.0 * t)), friction=True)
    problem = RecordsProblem([record])
    search = Search(problem).run()
    balance = Ensemble(search.regression, compare(search))
    assert Observer(balance).refined() is balance
