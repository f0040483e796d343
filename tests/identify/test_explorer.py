"""What a law leaves: features that are there are named, chance is not, rounding decides nothing."""

import functools

import numpy as np
import pytest

from stickslip import Axis, Measurement, select
from stickslip.identify.ensemble import band_of
from stickslip.identify.explorer import Explorer
from stickslip.identify.judge import Judgement
from stickslip.identify.problem import STRETCHES
from stickslip.identify.problems.records import Record, RecordsProblem
from stickslip.identify.problems.tables import TableProblem
from stickslip.identify.regression import BlockRegression

AXIS = Axis(inertia=1.0)
LAW = (("level", ()), ("viscous", ()))
RIGID = (("inertia", ()), ("level", (0.0, 0.0)), ("viscous", ()))


def problem_of(friction, v, **inputs):
    return TableProblem.of(AXIS, Measurement(velocity=v, friction=friction, inputs=inputs))


def explored(problem, structure, noise):
    """Return an explorer of a structure that is given, with weights of the noise that is known."""
    regression = BlockRegression(problem)
    regression.add(structure)
    regression.weigh(np.full(len(problem.response), 1.0 / noise))
    return Explorer(regression, structure)


def warm(seed=0, *, bend=0.4, noise=0.02):
    """Return a table whose level has its least at a temperature, which no term says."""
    random = np.random.default_rng(seed)
    order = random.permutation(45)
    v = np.tile(np.geomspace(0.05, 1.0, 9), 5)[order]
    temperature = np.repeat([20.0, 25.0, 30.0, 35.0, 40.0], 9)[order]
    friction = 2.0 + 0.5 * v + bend * np.abs(temperature - 30.0) / 10.0
    friction = friction + noise * random.normal(size=len(v))
    return Measurement(velocity=v, friction=friction, inputs={"temperature": temperature})


@functools.cache
def bent():
    return select(AXIS, None, warm())


def axis(seed=0, *, place=0.0, noise=0.02):
    """Return a record of an axis with more friction beyond a place."""
    random = np.random.default_rng(seed)
    t = np.arange(0.0, 12.0, 0.002)
    x, v, a = np.zeros((3, len(t)))
    for f in (0.31, 0.73, 1.1):
        w, phase, size = 2.0 * np.pi * f, random.uniform(0.0, 6.0), random.uniform(0.2, 0.5)
        x += size * np.sin(w * t + phase)
        v += size * w * np.cos(w * t + phase)
        a -= size * w**2 * np.sin(w * t + phase)
    force = 0.02 * a + np.sign(v) + 0.3 * v + place * np.sign(v) * (x > 0.2)
    force = force + noise * random.normal(size=len(t))
    return Record(time=t, position=x + 3e-5 * random.normal(size=len(t)), force=force)


@functools.cache
def of_record(place):
    return explored(RecordsProblem([axis(place=place)]), RIGID, 0.1 if place else 0.02)


def test_what_a_law_leaves_is_said_to_follow_its_feature():
    (pattern,) = bent().patterns
    assert pattern.feature == "temperature"
    assert pattern.stated
    assert pattern.share > 0.5
    # a V of height .4 about its mean has .12 N, of 2.4 N
    assert pattern.of_force == pytest.approx(0.12 / 2.4, rel=0.4)
    assert any("follows the temperature" in line for line in bent().words.cannot_tell)


def test_friction_that_changes_with_the_place_is_found_and_learned():
    explorer = of_record(0.3)
    pattern = explorer.patterns()[0]
    assert pattern.feature == "place"
    assert pattern.stated
    learned = explorer.learned()
    rows = explorer.regression.problem.rows
    beyond = rows.position > 0.2
    true = 0.3 * rows.seen(np.sign(rows.velocity) * (beyond - beyond.mean()))
    found = learned.at(rows)[0]
    # the law takes its mean
    left = explorer.held_out
    assert np.corrcoef(found, true)[0, 1] > 0.9
    assert np.std(left - found) < 0.5 * np.std(left)


def test_steady_motion_is_as_uncertain_as_its_place():
    explorer = of_record(0.3)
    rows = explorer.regression.problem.at([0.5, 1.0])
    learned = explorer.learned().at(rows)
    assert learned.shape == (STRETCHES, 2)
    assert np.ptp(learned[:, 0]) > 0.1


def test_nothing_material_is_left_of_the_law_that_made_a_record():
    assert not any(pattern.stated for pattern in of_record(0.0).patterns())


def test_as_many_tables_of_the_law_stand_out_as_chance_lets():
    v = np.tile(np.geomspace(0.05, 1.0, 12), 2)
    chances = []
    for seed in range(120):
        random = np.random.default_rng(seed)
        order = random.permutation(len(v))
        friction = 2.0 + 0.5 * v[order] + 0.05 * random.normal(size=len(v))
        problem = problem_of(friction, v[order], temperature=random.uniform(20.0, 30.0, len(v)))
        chances.append(min(pattern.p for pattern in explored(problem, LAW, 0.05).patterns()))
    # binomial of 120: standard deviations .037 at .2 and .02 at .05
    assert np.mean(np.array(chances) <= 0.2) == pytest.approx(0.2, abs=0.08)
    assert np.mean(np.array(chances) <= 0.05) < 0.1


def test_the_scatter_is_said_to_follow_what_it_grows_with():
    record = axis(noise=np.where(np.arange(6000) > 3000, 0.2, 0.05))
    patterns = explored(RecordsProblem([record]), RIGID, 0.1).patterns()
    (pattern,) = (one for one in patterns if one.scatter)
    assert pattern.feature in ("time", "way")  # which grows with it
    assert pattern.stated


def test_the_learned_part_widens_the_band_and_nothing_else_does():
    ensemble = Judgement.of(problem_of(**known(warm()))).ensemble
    plain = type(ensemble)(ensemble.regression, ensemble.comparison)
    assert ensemble.learned is not None
    rows = ensemble.problem.asked()
    narrow, wide = (band_of(one.curves(rows)) for one in (plain, ensemble))
    assert np.all(wide.high - wide.low > narrow.high - narrow.low)


def known(measurement):
    return {
        "friction": measurement.friction, "v": measurement.velocity, **measurement.inputs,
    }  # fmt: skip


def test_rounding_decides_nothing():
    measurement = warm()
    other = Measurement(
        velocity=measurement.velocity,
        friction=measurement.friction * (1.0 + 1e-12 * np.sin(np.arange(45.0))),
        inputs=measurement.inputs,
    )
    again = select(AXIS, None, other)
    assert again.words == bent().words
    for pattern, two in zip(bent().patterns, again.patterns, strict=True):
        assert (pattern.feature, pattern.p, pattern.stated) == (two.feature, two.p, two.stated)
        assert pattern.share == pytest.approx(two.share, abs=1e-9)


def test_nothing_is_said_of_the_rounding_that_an_exact_law_leaves():
    v = np.geomspace(0.05, 1.0, 20)
    assert explored(problem_of(2.0 + 0.5 * v, v), LAW, 1e-12).patterns() == ()


def test_several_responses_are_held_out_as_each_is():
    problem = problem_of(2.0 + np.geomspace(0.05, 1.0, 12) ** 2, np.geomspace(0.05, 1.0, 12))
    regression = explored(problem, LAW, 0.1).regression
    random = np.random.default_rng(1)
    others = random.normal(size=(12, 3))
    together = regression.held_out(LAW, others)
    for k in range(3):
        np.testing.assert_allclose(regression.held_out(LAW, others[:, k]), together[:, k])
    np.testing.assert_allclose(regression.held_out(LAW), regression.held_out(LAW, problem.response))
