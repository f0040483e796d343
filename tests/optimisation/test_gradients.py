"""Gradients of the polish against differences of whole runs."""

import numpy as np
import pytest

from stickslip import Coulomb
from stickslip.study.optimisation import GOALS, Limits
from stickslip.study.optimisation.parametrisation import space_of
from stickslip.study.optimisation.problem import Problem, Scenarios
from stickslip.study.optimisation.search import goal_gradient, travel_gradient

LAW = Coulomb(kinetic_coefficient=0.2)
LIMITS = Limits(position=1.0, rate=12.0, effort=2.0)
POINTS = {
    "three-phase": [0.7, 0.55, 0.42],
    "three-accelerations": [0.7, 0.55, 0.42, 0.5],
    "seven-step": [0.7, 0.55, 0.42, 0.8, 0.7, 0.1],
    # a sine swing brings nothing on a level road; what it brings in the first cycles moves all
    "sine": [0.7, 0.9],
}
STEP = 1e-5


def problem_of(mechanism, goal="travel", laws=(LAW,), quantile=0.0):
    cases = Scenarios(laws=laws, changes=({},) * len(laws), quantile=quantile, words="")
    return Problem(mechanism=mechanism, scenarios=cases, goal=GOALS[goal], limits=LIMITS)


def by_differences(problem, space, u, read):
    """Central differences of something read off the judged motion."""
    columns = []
    for i in range(len(u)):
        step = STEP * np.eye(len(u))[i]
        ends = [read(problem.judge(space.profile(u + side * step))) for side in (1, -1)]
        columns.append((ends[0] - ends[1]) / (2 * STEP))
    return np.array(columns)


@pytest.mark.parametrize("kind", ["three-phase", "three-accelerations", "seven-step"])
@pytest.mark.parametrize("goal", ["travel", "speed"])
def test_goal_gradients_from_sensitivities_are_those_of_differences(cart, kind, goal):
    problem, space = problem_of(cart, goal), space_of(kind, LIMITS, 12)
    u = np.array(POINTS[kind])
    judged = problem.judge(space.profile(u))
    assert judged.cycles[0].repeats
    found = goal_gradient(problem, space, u, judged)
    known = by_differences(problem, space, u, lambda judged: judged.value)
    assert np.abs(known).max() > 1e-3
    # the differences err by the square of their step times a third derivative of up to 1e4
    np.testing.assert_allclose(found, known, atol=1e-5 * np.abs(known).max())


def test_a_sine_brings_nothing_however_it_is_changed(cart):
    problem, space = problem_of(cart), space_of("sine", LIMITS, 12)
    u = np.array(POINTS["sine"])
    judged = problem.judge(space.profile(u))
    found = travel_gradient(problem, space, u, judged.cycles[0])
    # of parts that are centimetres in all and cancel; events are located to rounding
    np.testing.assert_allclose(found, 0.0, atol=1e-8)


@pytest.mark.parametrize(
    ("quantile", "statistic"), [(0.3, lambda x: np.quantile(x, 0.3)), ("mean", np.mean)]
)
def test_what_counts_of_several_laws_has_the_gradient_of_those_that_count(
    cart, quantile, statistic
):
    laws = tuple(Coulomb(kinetic_coefficient=mu) for mu in (0.18, 0.2, 0.22))
    problem = problem_of(cart, laws=laws, quantile=quantile)
    space = space_of("three-phase", LIMITS, 12)
    u = np.array(POINTS["three-phase"])
    judged = problem.judge(space.profile(u))
    found = goal_gradient(problem, space, u, judged)
    known = by_differences(problem, space, u, lambda judged: judged.value)
    np.testing.assert_allclose(found, known, atol=1e-5 * np.abs(known).max())
    values = problem.values(judged.cycles)
    assert judged.value == pytest.approx(statistic(values), rel=1e-12)
