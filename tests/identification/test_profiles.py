"""The largest value that a record allows is where its profile says so."""

import numpy as np
import pytest
from scipy import stats

from stickslip import Axis, CoulombViscous, Measurement, fit, simulate
from stickslip.drives import Sine
from stickslip.identification.profile_likelihood import largest_allowed


def table():
    v = np.linspace(-0.2, 0.2, 120)
    noise = 0.05 * np.random.default_rng(1).normal(size=len(v))
    return Measurement(velocity=v, friction=2.0 * np.sign(v) + 5.0 * v + noise)


def test_the_end_of_a_linear_fit_is_that_of_its_normal_equations():
    found = fit(Axis(inertia=1.0), CoulombViscous, table())
    paths = list(found.free_parameters.paths)
    slopes = found.optimum.best.slopes
    index = paths.index("friction.viscous_coefficient")
    inverse = np.linalg.inv(slopes.T @ slopes)[index, index]
    freedom = found.inference.effective - len(paths)
    rise = stats.t.ppf(0.975, freedom) ** 2 / freedom
    half = np.sqrt(rise * found.optimum.best.cost * inverse)
    end = largest_allowed(found, "viscous_coefficient")
    # the law is linear in all unknowns, and searches end within 1e-4 of the cost
    assert end.value - found.values[index] == pytest.approx(half, rel=0.02)
    assert end.tried[1] > found.values[index]
    assert all(cost > 1.0 for cost in end.costs)


def recorded():
    drive = Sine(amplitude=6.0, frequency=0.5) + Sine(amplitude=3.0, frequency=1.3)
    t = np.arange(0.0, 6.0, 0.01)
    law = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=5.0)
    run = simulate(Axis(inertia=2.0, drive=drive), law, t_end=6.0)
    noise = 1e-5 * np.random.default_rng(0).normal(size=len(t))
    force = np.array([drive.value(float(at)) for at in t])
    return Measurement(time=t, position=run.at(t)["x"] + noise, force=force)


@pytest.fixture(scope="module")
def shot():
    return fit(Axis(inertia=2.0), CoulombViscous, recorded())


def test_a_prediction_holds_what_was_measured_and_what_was_predicted(shot):
    record = recorded()
    seen = shot.predict(record)
    # a difference and the sum that it came from differ by rounding
    np.testing.assert_allclose(seen.measured - seen.predicted, seen.residual, rtol=0, atol=1e-15)
    # segments share their end points with no other rows than those of the record
    np.testing.assert_array_equal(seen.measured, np.interp(seen.t, record.time, record.position))
    assert np.all(np.diff(seen.t) >= 0.0)
    assert {"measured", "predicted", "residual"} <= set(seen.to_dataframe().columns)


def test_predicted_friction_is_that_of_the_law_and_the_offset():
    found = fit(Axis(inertia=1.0), CoulombViscous, table())
    seen = found.predict()
    v = np.asarray(table().velocity)
    law, offset = found.law, found.estimate("offset").value
    expected = law.kinetic_coefficient * np.sign(v) + law.viscous_coefficient * v + offset
    np.testing.assert_allclose(seen.predicted, expected, rtol=1e-9)


def test_runs_of_the_segments_end_where_predictions_do(shot):
    problem, best = shot.problem, shot.optimum.best
    runs = problem.runs(best)
    assert len(runs) == len(problem.segments)
    assert all(run.certificate.certified for run in runs)
    seen = shot.predict()
    for number, run in enumerate(runs[1:], 1):  # the first begins at rest, where slopes have kinks
        own = seen.segment == number
        # first states are corrected to first order, and the last correction was tiny
        assert run["x"][-1] == pytest.approx(seen.predicted[own][-1], abs=1e-9)
