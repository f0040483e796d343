"""Held-out fits of any problem: each segment after a fit to the others."""

import numpy as np
import pytest
from tests.linear import Linear

from stickslip.errors import InputError
from stickslip.identify.candidates import CrossValidation, held_out
from stickslip.identify.fits import search

RANDOM = np.random.default_rng(0)
TABLE = np.column_stack([np.ones(12), np.linspace(0.0, 1.0, 12)])
MEASURED = TABLE @ [2.0, 3.0] + 0.1 * RANDOM.normal(size=12)


def test_what_is_held_out_is_predicted_by_the_least_squares_of_the_rest():
    problem = Linear(TABLE, MEASURED, start=[1.0, 1.0])
    best = search(problem).best
    unseen = held_out(problem, best)
    for one in np.unique(best.segment):
        own = best.segment == one
        values = np.linalg.lstsq(TABLE[~own], MEASURED[~own])[0]
        # refits end where a step takes less than 1e-4 off the cost: a hundredth of the noise of 0.1
        assert unseen[own] == pytest.approx(MEASURED[own] - TABLE[own] @ values, abs=1e-3)
    losses = CrossValidation.by_segment(unseen, best.segment).losses
    assert losses[0] == pytest.approx(np.mean(unseen[best.segment == 0] ** 2))


def test_one_setting_is_not_held_out_of_itself():
    problem = Linear(TABLE, MEASURED, start=[1.0, 1.0])
    alone = problem.linearise(np.array([1.0, 1.0]), only=[0])
    with pytest.raises(InputError, match="one setting leaves nothing to fit"):
        held_out(problem, alone)
