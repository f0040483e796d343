"""Least squares with bounds."""

import numpy as np
import pytest
from tests.linear import Linear

from stickslip.identify.fits.levenberg_marquardt import (
    LeastSquaresProblem,
    ResidualJacobian,
    improve,
    step_of,
)
from stickslip.identify.fits.parameters import FreeParameter, FreeParameters
from stickslip.quantities import Quantity

RANDOM = np.random.default_rng(3)
TABLE = RANDOM.normal(size=(40, 2))
MEASURED = TABLE @ np.array([1.5, -0.5]) + 0.1 * RANDOM.normal(size=40)
LEAST = np.linalg.lstsq(TABLE, MEASURED, rcond=None)[0]
FREE = np.full(2, np.inf)
ENDS = {"rounds": 200, "least": 1e-6}


def test_one_undamped_step_solves_a_linear_problem():
    here = Linear(TABLE, MEASURED, start=[9.0, 9.0]).linearise(np.array([9.0, 9.0]))
    step, promised = step_of(TABLE, here.residual, here.values, -FREE, FREE, 0.0)
    # normal equations of two columns of condition 1.5: rounding only
    np.testing.assert_allclose(here.values + step, LEAST, rtol=1e-12)
    rest = MEASURED - TABLE @ LEAST
    assert promised == pytest.approx(here.cost - rest @ rest, rel=1e-12)


def test_the_search_ends_where_least_squares_does():
    problem = Linear(TABLE, MEASURED, start=[9.0, 9.0])
    end = improve(problem, np.array([9.0, 9.0]), **ENDS)
    # damping of 1e-3 at first leaves 1e-3 of the way, and 1e-4 of that after the second step
    np.testing.assert_allclose(end.values, LEAST, rtol=1e-4)


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
    end = improve(problem, problem.free_parameters.start, **ENDS)
    visited = np.array(problem.visited)
    assert visited.min() >= 0.0
    assert visited.max() <= 1.0
    np.testing.assert_allclose(end.values, [1.0, 0.0])


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
        )


def test_a_descent_goes_to_the_end_of_a_curved_valley():
    end = improve(Rosenbrock(), Rosenbrock.free_parameters.start, **ENDS)
    assert end.cost == pytest.approx(0.25, rel=1e-3)
    np.testing.assert_allclose(end.values, [1.0, 1.0], atol=0.02)


def test_a_descent_from_values_that_predict_nothing_stays_there():
    problem = Linear(TABLE, MEASURED, start=[9.0, 9.0], fails=True)
    end = improve(problem, np.array([9.0, 9.0]), **ENDS)
    assert not end.finite
    np.testing.assert_array_equal(end.values, [9.0, 9.0])
