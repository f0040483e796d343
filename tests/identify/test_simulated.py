"""The posterior of simulated rows: closed forms of linear runs, and runs that fail."""

import numpy as np
import pytest
from scipy.stats import norm

from stickslip.friction import RateState
from stickslip.identify.kinds import simulate_velocity_steps
from stickslip.identify.problems.velocity_step_runs import Sliders, coefficients_of
from stickslip.identify.simulated import (
    ENOUGH,
    WHITE,
    Always,
    Simulated,
    SimulatedPosterior,
    Unknowns,
)
from stickslip.quantities import Quantity

ROWS = 200
X = np.linspace(-1.0, 1.0, ROWS)


class Lines(Simulated):
    """Rows that go straight, or bend, beside an offset that is always there."""

    stages = (("straight",), ("bent",))

    def __init__(self, measured, *, least=-np.inf):
        self.measured, self.weights, self.least = measured, np.ones(ROWS), least
        self.always = Always(
            columns=np.ones((ROWS, 1)), sizes=np.array([[1.0]]), prior=np.array([1.0])
        )

    def prior(self, family):
        return 0.0

    def vary(self, family):
        count = 1 + (family == "bent")
        return Unknowns(names=("slope", "bend")[:count], mean=np.zeros(count),
                        deviation=np.full(count, 2.0))  # fmt: skip

    def starts(self, family, ends):
        return np.full((1, 1 + (family == "bent")), 1.1)

    def quantities(self, family):
        return {name: Quantity(name) for name in self.sought(family)}

    def result(self, family, values):
        return values, None

    def simulate(self, asked):
        found = {}
        for family, points in asked.items():
            rows = X[:, None] * points[:, 0]
            if family == "bent":
                rows = rows + (X**2)[:, None] * points[:, 1]
            rows[:, points[:, 0] < self.least] = np.nan
            found[family] = rows
        return found


def noisy(slope, bend, seed=0):
    noise = np.random.default_rng(seed).normal(0.0, 0.1, ROWS)
    return 0.5 + slope * X + bend * X**2 + noise


def test_linear_runs_have_the_posterior_of_least_squares():
    posterior = SimulatedPosterior(Lines(noisy(1.0, 0.0)))
    straight = posterior.families["straight"]
    # white noise counts as WHITE of its rows; the priors are a hundred times wider
    design = np.column_stack([np.ones(ROWS), X])
    best, squares, *_ = np.linalg.lstsq(design, posterior.problem.measured, rcond=None)
    error = np.sqrt(float(squares[0]) / ROWS / WHITE / np.sum(X**2))
    assert straight.mode[0] == pytest.approx(best[1], abs=0.05 * error)
    # 400 draws tell a spread to 4 %, weighed ones to somewhat less
    assert float(np.std(straight.points[:, 0])) == pytest.approx(error, rel=0.15)
    assert straight.effective > ENOUGH
    assert straight.usual[0] == pytest.approx(best[0], abs=0.001)
    inside = (straight.band[0] < 0.5 + X) & (straight.band[2] > 0.5 + X)
    assert inside.mean() > 0.5


def test_a_bend_that_is_not_there_costs_its_prior_volume():
    posterior = SimulatedPosterior(Lines(noisy(1.0, 0.0)))
    bent, straight = (posterior.families[name] for name in ("bent", "straight"))
    # Occam's factor: the posterior over the prior deviation of the bend, less what it explains
    spread = float(np.std(bent.points[:, 1]))
    z = float(np.mean(bent.points[:, 1])) / spread
    assert bent.evidence - straight.evidence == pytest.approx(
        np.log(spread / 2.0) + 0.5 * z**2, abs=0.2
    )
    assert posterior.shares["straight"] > 0.8
    told = SimulatedPosterior(Lines(noisy(1.0, 0.3)))
    assert told.shares["bent"] > 0.999


def test_where_runs_fail_the_posterior_ends():
    # slopes below 1.02 have no run: what is left is the tail of a normal distribution
    free = SimulatedPosterior(Lines(noisy(1.0, 0.0))).families["straight"]
    cut = SimulatedPosterior(Lines(noisy(1.0, 0.0), least=1.02)).families["straight"]
    assert cut.points.min() >= 1.02
    spread, middle = float(np.std(free.points)), float(np.mean(free.points))
    z = (1.02 - middle) / spread
    tail = middle + spread * norm.pdf(z) / norm.sf(z)
    # rows count a little less or more, as what is left is another
    assert float(np.mean(cut.points)) == pytest.approx(tail, abs=0.3 * (tail - 1.02) + 1e-3)


def test_a_watch_that_says_no_ends_the_searches():
    told = []

    def watch(family, rms):
        told.append((family, rms))
        return False

    posterior = SimulatedPosterior(Lines(noisy(1.0, 0.0)), watch=watch)
    assert posterior.cancelled
    assert told[0][0] == "straight"
    assert told[0][1] > 0.0


KNOTS = np.array([0.0, 20.0, 60.0, 90.0, 120.0])
SPEEDS = 1e-6 * np.array([1.0, 10.0, 0.0, 3.0])
"""With a load point that holds still."""


@pytest.mark.parametrize("evolution", ["ageing", "slip", "prz", "nagata"])
@pytest.mark.parametrize("second", [False, True])
def test_many_sliders_at_once_do_what_each_does_alone(evolution, second):
    stress = 2.0 if evolution == "nagata" else 0.0
    more = {"second_evolution_effect": 0.003, "second_critical_distance": 5e-5} if second else {}
    laws = [
        RateState(
            reference_coefficient=0.6, direct_effect=a, evolution_effect=0.008,
            critical_distance=D, stress_effect=stress, reference_velocity=1e-6,
            evolution=evolution, **more,
        )
        for a, D in ((0.02, 1e-5), (0.03, 3e-6), (0.015, 2e-5))
    ]  # fmt: skip
    stiffness = np.array([2e3, 5e3, 3e3])
    states = np.array([law.states for law in laws])
    times, places = np.linspace(0.0, 120.0, 241), np.concatenate([[0.0], np.cumsum(
        SPEEDS * np.diff(KNOTS))])  # fmt: skip
    found = coefficients_of(
        Sliders(
            direct=np.array([law.direct_effect for law in laws]),
            effects=[*states[:, :, 0].T],
            distances=[*states[:, :, 1].T],
            stress=np.full(3, stress),
            stiffness=stiffness,
            evolution={evolution: slice(0, 3)},
        ),
        KNOTS, SPEEDS, times, reference=1e-6, tolerance=1e-7,
    )  # fmt: skip
    for law, k, rows in zip(laws, stiffness, found.T, strict=True):
        alone = simulate_velocity_steps(law, stiffness=k, time=KNOTS, pull=places, at=times)
        # a step is exact to 1e-7, and some errors add up
        np.testing.assert_allclose(rows, alone.coefficient - 0.6, rtol=0.0, atol=1e-6)


def test_a_slider_that_sticks_and_slips_is_given_up_and_the_others_go_on():
    sliders = Sliders(
        direct=np.array([0.01, 0.01]),
        effects=[np.array([0.015, 0.015])],
        distances=[np.array([1e-5, 1e-5])],
        stress=np.zeros(2),
        stiffness=np.array([2e3, 100.0]),  # steady sliding needs 500 / m
        evolution={"ageing": slice(0, 2)},
    )
    times = np.linspace(0.0, 400.0, 100)
    rows = coefficients_of(
        sliders, np.array([0.0, 20.0, 400.0]), 1e-6 * np.array([1.0, 10.0]), times,
        reference=1e-6, tolerance=1e-6,
    )  # fmt: skip
    assert np.isnan(rows[:, 1]).all()
    assert rows[-1, 0] == pytest.approx(-0.005 * np.log(10.0), abs=1e-5)
