"""What a law of a record leaves: features that are there are named, chance is not."""

import functools

import numpy as np

from stickslip.identify.explorer import Explorer
from stickslip.identify.problem import STRETCHES
from stickslip.identify.problems.records import Record, RecordsProblem
from stickslip.identify.regression import BlockRegression

RIGID = (("inertia", ()), ("level", (0.0, 0.0)), ("viscous", ()))


def explored(problem, structure, noise):
    """Return an explorer of a structure that is given, with weights of the noise that is known."""
    regression = BlockRegression(problem)
    regression.add(structure)
    regression.weigh(np.full(len(problem.response), 1.0 / noise))
    return Explorer(regression, structure)


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


def test_the_scatter_is_said_to_follow_what_it_grows_with():
    record = axis(noise=np.where(np.arange(6000) > 3000, 0.2, 0.05))
    patterns = explored(RecordsProblem([record]), RIGID, 0.1).patterns()
    (pattern,) = (one for one in patterns if one.scatter)
    assert pattern.feature in ("time", "way")  # which grows with it
    assert pattern.stated


def test_several_responses_are_held_out_as_each_is():
    regression = of_record(0.0).regression
    others = np.random.default_rng(1).normal(size=(len(regression.problem.response), 3))
    together = regression.held_out(RIGID, others)
    for k in range(3):
        np.testing.assert_allclose(regression.held_out(RIGID, others[:, k]), together[:, k])
    own = regression.held_out(RIGID, regression.problem.response)
    np.testing.assert_allclose(regression.held_out(RIGID), own)
