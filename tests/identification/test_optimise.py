"""Least squares with bounds, from several starts."""

from dataclasses import replace

import numpy as np
import pytest
from tests.linear import Linear

from stickslip.errors import ConvergenceError
from stickslip.identify.fits.levenberg_marquardt import (
    JITTER,
    LeastSquaresProblem,
    ResidualJacobian,
    improve,
    search,
    step_of,
)
from stickslip.identify.fits.parameters import FreeParameter, FreeParameters
from stickslip.identify.fits.shooting import fitting
from stickslip.identify.fits.shooting.estimates import infer
from stickslip.quantities import Quantity

RANDOM = np.random.default_rng(3)
TABLE = RANDOM.normal(size=(40, 2))
MEASURED = TABLE @ np.array([1.5, -0.5]) + 0.1 * RANDOM.normal(size=40)
LEAST = np.linalg.lstsq(TABLE, MEASURED, rcond=None)[0]
FREE = np.full(2, np.inf)


def test_one_undamped_step_solves_a_linear_problem():
    here = Linear(TABLE, MEASURED, start=[9.0, 9.0]).linearise(np.array([9.0, 9.0]))
    step, promised = step_of(TABLE, here.residual, here.values, -FREE, FREE, 0.0)
    # normal equations of two columns of condition 1.5: rounding only
    np.testing.assert_allclose(here.values + step, LEAST, rtol=1e-12)
    rest = MEASURED - TABLE @ LEAST
    assert promised == pytest.approx(here.cost - rest @ rest, rel=1e-12)


def test_the_search_ends_where_least_squares_does():
    end, stopped = improve(Linear(TABLE, MEASURED, start=[9.0, 9.0]), np.array([9.0, 9.0]))
    # damping of 1e-3 at first leaves 1e-3 of the way, and 1e-4 of that after the second step
    np.testing.assert_allclose(end.values, LEAST, rtol=1e-4)
    assert not stopped


def test_a_step_that_meets_a_bound_is_the_least_squares_of_the_other_column():
    table = np.column_stack([TABLE[:, 0], TABLE[:, 0] + 0.3 * TABLE[:, 1]])
    at, low, high = np.array([0.0, 0.0]), np.array([-9.0, 0.0]), np.array([9.0, 9.0])
    step, _ = step_of(table, MEASURED, at, low, high, 0.0)
    # the second value wants to go below 0; the first then is the regression on its column alone
    assert step[1] == 0.0
    alone = table[:, 0] @ MEASURED / (table[:, 0] @ table[:, 0])
    assert step[0] == pytest.approx(alone, rel=1e-12)


def test_no_bound_is_ever_passed():
    problem = Linear(TABLE, MEASURED, start=[0.5, 0.5], bounds=(0.0, 1.0))
    found = search(problem)
    visited = np.array(problem.visited)
    assert visited.min() >= 0.0
    assert visited.max() <= 1.0
    np.testing.assert_allclose(found.best.values, [1.0, 0.0])


def test_the_jitter_of_further_starts_follows_from_the_seed():
    def begun(seed):
        problem = Linear(TABLE, MEASURED, start=[1.0, -1.0], bounds=(-9.0, 9.0))
        search(problem, starts=4, seed=seed)
        sizes = np.exp([-JITTER, JITTER])
        values = np.abs(np.array(problem.visited))
        return values[np.isclose(values[:, :, None], sizes).any(axis=2).all(axis=1)]

    assert len(begun(0)) == 3  # of the four starts, the first is not jittered
    np.testing.assert_array_equal(begun(0), begun(0))
    assert not np.array_equal(begun(0), begun(2))


def test_starts_of_a_linear_problem_agree():
    found = search(Linear(TABLE, MEASURED, start=[9.0, 9.0]), starts=4)
    assert found.agreeing == len(found.costs) == 4
    np.testing.assert_allclose(found.best.values, LEAST, rtol=1e-3)


class Rosenbrock(LeastSquaresProblem):
    """A curved valley, along which a descent of five steps is on its way."""

    free_parameters = FreeParameters(
        tuple(
            FreeParameter(path=f"friction.{n}", quantity=Quantity(n), start=v, low=-9.0, high=9.0)
            for n, v in (("x", -1.2), ("y", 1.0))
        )
    )

    def linearise(self, values, near=None):
        x, y = values
        return ResidualJacobian(
            values=values,
            residual=np.array([10.0 * (y - x * x), 1.0 - x, 0.5]),
            slopes=np.array([[20.0 * x, -10.0], [1.0, 0.0], [0.0, 0.0]]),
            segment=np.zeros(3, int),
        )


def test_a_descent_goes_to_the_end_of_a_curved_valley():
    found = search(Rosenbrock())
    assert found.best.cost == pytest.approx(0.25, rel=1e-3)
    np.testing.assert_allclose(found.best.values, [1.0, 1.0], atol=0.02)


@pytest.mark.parametrize("calls", [1, 2])
def test_a_watcher_that_answers_false_stops_with_the_best_so_far(calls):
    heard = []

    def watch(rms):
        heard.append(rms)
        return len(heard) < calls

    problem = Linear(TABLE, MEASURED, start=[9.0, 9.0])
    found = search(problem, starts=4, watch=watch)
    assert found.cancelled
    assert len(heard) == found.evaluations == calls
    assert len(found.costs) == 1
    np.testing.assert_array_equal(found.best.values, [9.0, 9.0])
    assert heard == sorted(heard, reverse=True)


def test_a_record_that_no_start_predicts_is_refused_with_the_values_tried():
    problem = Linear(TABLE, MEASURED, start=[9.0, 9.0], fails=True)
    with pytest.raises(ConvergenceError, match=r"any of 3 starting points near friction.p0 = 9"):
        search(problem, starts=3)
    with pytest.raises(ConvergenceError, match="cannot be simulated with these start values"):
        improve(problem, np.array([9.0, 9.0]))


class Wells(LeastSquaresProblem):
    """Readings that two values explain equally well, but for a share of a slope between them."""

    free_parameters = FreeParameters(
        (FreeParameter(path="friction.x", quantity=Quantity("x"), start=1.9, low=0.1, high=9.0),)
    )

    def __init__(self, tilt=0.0):
        self.tilt, self.noise = tilt, 0.1 * np.random.default_rng(5).normal(size=(40, 1))

    def linearise(self, values, near=None):
        (x,) = values
        rows = np.append((x - 1.0) * (x - 3.0) + self.noise, self.tilt * (x - 1.0))
        slopes = np.append(np.full((40, 1), 4.0 - 2.0 * x), [[-self.tilt]], axis=0)
        return ResidualJacobian(
            values=values, residual=rows, slopes=slopes, segment=np.zeros(41, int)
        )


@pytest.mark.parametrize("tilt", [0.0, 1.0])
def test_another_end_that_is_as_likely_is_part_of_the_interval_and_said(tilt):
    found = search(Wells(tilt), starts=4)
    assert {round(float(end[0])) for end in found.ends} == {1, 3}
    inference = infer(found.best, np.eye(1))
    others = fitting._elsewhere(found, inference)
    said = list(fitting._of_ends(Wells.free_parameters, others))
    if tilt:  # it leaves much more
        assert not others
        assert not said
        return
    (other,) = others
    assert abs(other.off[0]) == pytest.approx(2.0, rel=0.05)
    assert other.chance == pytest.approx(0.5, abs=0.05)
    wider = inference.including(other.widening)
    assert wider.half_widths[0] > 2.0 > 5.0 * inference.half_widths[0]
    assert said[0].startswith("Another start of the search ends at x = ")
    assert said[0].endswith("intervals hold both ends.")
    for chance in (0.05, 0.26, 0.5, 1.0):
        assert abs(replace(other, chance=chance).widening[0]) >= abs(other.off[0])
    (item,) = Wells.free_parameters.items
    nuisance = replace(item, quantity=Quantity("x", nuisance=True))
    assert not list(fitting._of_ends(FreeParameters((nuisance,)), others))
