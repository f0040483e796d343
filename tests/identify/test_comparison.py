"""Shares of structures: what rounding makes of a prior takes no share from the others."""

import math
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip.identify.comparison import stacked_shares
from stickslip.identify.evidence import priors_of
from stickslip.identify.problem import Problem, Term


@pytest.mark.parametrize("none", [0.0, -1e-16])
def test_a_prior_that_is_none_by_rounding_has_no_share_and_leaves_the_others_theirs(none):
    shares = stacked_shares(np.zeros((3, 4)), np.array([1.0, 0.5, none]))
    # 1e-15: rounding of a sum of 400 draws
    np.testing.assert_allclose(shares, [2.0 / 3.0, 1.0 / 3.0, 0.0], rtol=1e-12, atol=1e-15)


@pytest.mark.parametrize("step", [0.8, 1.25])
def test_priors_of_shapes_are_even_whether_their_grid_goes_up_or_down(step):
    term = Term(
        name="gap", role="fault", columns=lambda rows, shape: rows, shapes=[(1.0,)], steps=(step,)
    )
    problem = SimpleNamespace(terms={"gap": term}, blocks=())
    problem.family = Problem.family.__get__(problem)
    problem.parameters = Problem.parameters.__get__(problem)
    problem._memory = Problem._memory.__get__(problem)
    structures = [(("gap", (step**k,)),) for k in range(5)]
    priors = priors_of(SimpleNamespace(problem=problem, price=0.0), structures)
    assert math.fsum(priors) == pytest.approx(1.0, rel=1e-12)
    np.testing.assert_allclose(priors, 0.2, rtol=1e-9)  # logarithms are compared to 12 decimals
