"""The posterior against closed forms: weights, draws and nodes of small linear models."""

import itertools
import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr
from scipy.stats import multivariate_normal

from stickslip.identify.posterior import (
    COEFFICIENT,
    Column,
    Model,
    Node,
    Posterior,
    Scale,
    System,
    eliminated,
    inverted,
    neighbours,
    not_negative,
)

X = np.linspace(-1.0, 1.0, 12)
COLUMNS = {("level", ()): np.ones(12), ("viscous", ()): X, ("bend", ()): X**2}
Z = np.column_stack([np.sin(3.0 * X), np.cos(5.0 * X)])
NOISES, SPREADS = (0.05, 0.1, 0.2), (0.01, 0.5)


class Linear(Model):
    """A line with two random columns, whose covariance is known in full."""

    signed = frozenset({"level", "viscous", "bend"})
    scales = (
        Scale(name="noise", values=NOISES, prior=(0.2, 0.5, 0.3)),
        Scale(name="spread", values=SPREADS, prior=(0.6, 0.4)),
    )

    def __init__(self, y: np.ndarray) -> None:
        self.y = y

    def system(self, node: Node, columns: Sequence[Column]) -> System:
        noise = NOISES[node[0]]
        x = np.column_stack([COLUMNS[one] for one in columns])
        every = np.column_stack([Z, x, self.y]) / noise
        return System(
            gram=every.T @ every,
            deviations=np.full(2, SPREADS[node[1]]),
            volume=-len(self.y) * math.log(noise),
            sizes=np.ones(len(columns)),
        )

    def covariance(self, node: Node, structure: Sequence[Column]) -> np.ndarray:
        """Return the covariance of the response (n, n) under a law."""
        own = np.column_stack([np.zeros(12), *(COLUMNS[one] for one in structure)])
        noise, spread = NOISES[node[0]], SPREADS[node[1]]
        return noise**2 * np.eye(12) + spread**2 * Z @ Z.T + COEFFICIENT**2 * own @ own.T


LAWS = ((), (("level", ()),), (("level", ()), ("viscous", ())), (("bend", ()),))


class Linked(Linear):
    """The same, whose random columns are of links."""

    def system(self, node: Node, columns: Sequence[Column]) -> System:
        return replace(super().system(node, columns), links=(0, 1))


@pytest.fixture
def model() -> Linear:
    random = np.random.default_rng(4)
    return Linear(0.7 + 0.4 * X + 0.1 * random.normal(size=12))


def every_node() -> list[Node]:
    return [(a, b) for a in range(3) for b in range(2)]


def test_weights_are_those_of_the_marginal_likelihood_in_full(model: Linear) -> None:
    posterior = Posterior(model, LAWS, np.log([0.1, 0.4, 0.3, 0.2]), begin=every_node(), most=0)
    exact = np.array(
        [
            [
                multivariate_normal.logpdf(model.y, cov=model.covariance(node, law))
                + model.prior(node)
                + math.log(prior)
                for law, prior in zip(LAWS, (0.1, 0.4, 0.3, 0.2), strict=True)
            ]
            for node in posterior.nodes
        ]
    )
    # what is left out is the same constant for all
    exact = np.exp(exact - exact.max())
    np.testing.assert_allclose(posterior.weights, exact / exact.sum(), rtol=1e-8, atol=1e-12)


def test_draws_have_the_mean_and_covariance_of_the_normal_distribution(model: Linear) -> None:
    posterior = Posterior(model, LAWS[2:3], np.zeros(1), begin=[(1, 1)], most=0)
    (draws,) = posterior.draws(20000)
    x = np.column_stack([Z, *COLUMNS.values()])[:, :4]
    precision = x.T @ x / 0.1**2 + np.diag(
        1.0 / np.array([0.5, 0.5, COEFFICIENT, COEFFICIENT]) ** 2
    )
    mean = np.linalg.solve(precision, x.T @ model.y / 0.1**2)
    found = np.vstack([draws.random, draws.law])
    deviation = np.sqrt(np.diag(np.linalg.inv(precision)))
    # 20,000 draws: means to 1/141 of a deviation, twice over three standard errors
    np.testing.assert_allclose(found.mean(axis=1), mean, atol=0.03 * deviation.max())
    np.testing.assert_allclose(
        np.cov(found), np.linalg.inv(precision), atol=0.05 * deviation.max() ** 2
    )


def test_the_visit_finds_the_nodes_that_have_weight(model: Linear) -> None:
    priors = np.zeros(len(LAWS))
    every = Posterior(model, LAWS, priors, begin=every_node(), most=0)
    walked = Posterior(model, LAWS, priors, begin=[(2, 0)], most=100)
    # nodes that are never opened have less than a hundredth of the best each
    np.testing.assert_allclose(walked.shares, every.shares, atol=0.03)


def test_shares_do_not_depend_on_the_order_of_laws(model: Linear) -> None:
    one = Posterior(model, LAWS, np.zeros(4), begin=every_node(), most=0)
    other = Posterior(model, LAWS[::-1], np.zeros(4), begin=every_node(), most=0)
    np.testing.assert_allclose(one.shares, other.shares[::-1], rtol=1e-9)


def test_coefficients_that_cannot_be_negative_are_not_drawn_so() -> None:
    class Positive(Linear):
        signed = frozenset[str]()

    model = Positive(0.02 + 0.1 * np.random.default_rng(1).normal(size=12))
    posterior = Posterior(model, LAWS[1:3], np.zeros(2), begin=every_node(), most=0)
    assert all(np.all(one.law >= 0.0) for one in posterior.draws(200))


def test_a_random_coefficient_that_is_not_negative_counts_by_its_share(model: Linear) -> None:
    class OneSided(Linear):
        """The same, with a second random column whose coefficient is not negative."""

        def system(self, node: Node, columns: Sequence[Column]) -> System:
            return replace(super().system(node, columns), positive=(1,))

    laws = LAWS[1:3]
    for sign in (1.0, -1.0):
        y = model.y + 0.06 * sign * Z[:, 1]
        posterior = Posterior(OneSided(y), laws, np.zeros(2), begin=every_node(), most=0)
        free = Posterior(Linear(y), laws, np.zeros(2), begin=every_node(), most=0)
        share = np.empty(free.weights.shape)
        for a, (noise, spread) in enumerate(free.nodes):
            for k, law in enumerate(laws):
                x = np.column_stack([Z, *(COLUMNS[one] for one in law)])
                unit = [SPREADS[spread]] * 2 + [COEFFICIENT] * len(law)
                precision = x.T @ x / NOISES[noise] ** 2 + np.diag(1.0 / np.square(unit))
                covariance = np.linalg.inv(precision)
                mean = covariance @ x.T @ y / NOISES[noise] ** 2
                share[a, k] = ndtr(mean[1] / math.sqrt(covariance[1, 1]))
        exact = free.weights * share
        assert posterior.nodes == free.nodes
        np.testing.assert_allclose(posterior.weights, exact / exact.sum(), rtol=1e-8, atol=1e-12)
        for draw in posterior.draws(200):
            assert np.all(draw.random[1] >= -1e-12)


def test_a_variance_that_rounding_made_negative_makes_no_coefficient_positive() -> None:
    covariance, positive = np.diag([-1e-20, 1.0])[None], np.ones((1, 2), dtype=bool)
    assert not_negative(np.array([[-1.0, 9.0]]), covariance, positive)[0] < -100.0
    assert not_negative(np.array([[1.0, 0.0]]), covariance, positive)[0] == pytest.approx(
        np.log(0.5)
    )


def test_a_law_counts_by_the_share_of_it_in_which_a_level_that_falls_brakes() -> None:
    # friction at X = 1 is the sum of both coefficients; closed form for one bound: Phi(m / s)
    class Falling(Linear):
        def not_below_zero(self, structure: Sequence[Column]) -> np.ndarray:
            return np.ones((1, 2)) if len(structure) == 2 else np.zeros((0, len(structure)))

    y = 0.05 - 0.04 * X + 0.1 * np.random.default_rng(2).normal(size=12)
    free, bounded = (
        Posterior(one(y), LAWS[1:3], np.zeros(2), begin=[(1, 1)], most=0)
        for one in (Linear, Falling)
    )
    (draws,) = Posterior(Linear(y), LAWS[2:3], np.zeros(1), begin=[(1, 1)], most=0).draws(20000)
    ends = draws.law.sum(axis=0)
    inside = ndtr(ends.mean() / ends.std()) / 0.5  # half of the prior is inside
    odds = [one.weights[0, 1] / one.weights[0, 0] for one in (free, bounded)]
    assert odds[1] / odds[0] == pytest.approx(inside, rel=0.01)
    kept = [one.law for one in bounded.draws(2000) if len(one.structure) == 2]
    assert np.all(np.hstack(kept).sum(axis=0) >= 0.0)


def test_draws_repeat_and_are_as_many_as_asked_for(model: Linear) -> None:
    posterior = Posterior(model, LAWS, np.zeros(4), begin=every_node(), most=0)
    first, again = posterior.draws(150, seed=2), posterior.draws(150, seed=2)
    assert sum(one.law.shape[1] for one in first) == 150
    for a, b in zip(first, again, strict=True):
        np.testing.assert_array_equal(a.random, b.random)


def test_neighbours_step_along_ordered_scales_and_jump_along_others() -> None:
    scales = (
        Scale(name="a", values=(1.0, 2.0, 3.0, 4.0), prior=(0.25,) * 4),
        Scale(name="b", values=(0.0, 1.0, 2.0), prior=(0.4, 0.3, 0.3), ordered=False),
    )
    assert [node for _, node in neighbours(scales, (0, 0))] == [(1, 0), (0, 1), (0, 2)]


class Far(Model):
    """Fourteen scales, of which all have most of their prior three steps from the first value."""

    scales = tuple(
        Scale(name=str(k), values=tuple(range(6)), prior=(0.01, 0.03, 0.16, 0.6, 0.16, 0.04))
        for k in range(14)
    )

    def system(self, node: Node, columns: object) -> System:
        return System(gram=np.ones((1, 1)), deviations=np.zeros(0), volume=0.0, sizes=np.zeros(0))


def test_a_visit_reaches_a_maximum_that_is_far_in_many_scales() -> None:
    posterior = Posterior(Far(), [()], np.zeros(1), begin=[(0,) * 14], most=120)
    assert posterior.best == (3,) * 14
    for k in range(14):
        assert posterior.scale(str(k))[3] > 0.5


class Ridge(Far):
    """Two scales, of which the data tell the difference alone."""

    scales = tuple(Scale(name=x, values=tuple(range(12)), prior=(1 / 12,) * 12) for x in "ab")

    def prior(self, node: Node) -> float:
        a, b = node
        return -1.5 * (a - b) ** 2 - 0.02 * (a - 6) ** 2


def test_a_visit_follows_scales_that_are_told_together() -> None:
    model, every = Ridge(), list(itertools.product(range(12), repeat=2))
    total = np.logaddexp.reduce([model.prior(node) for node in every])
    posterior = Posterior(model, [()], np.zeros(1), begin=[(6, 6)], most=60)
    visited = np.logaddexp.reduce([model.prior(node) for node in posterior.nodes])
    assert math.exp(visited - total) > 0.98


class Beside(Far):
    """Nine scales of which the data tell nothing but that two are seldom large together."""

    scales = tuple(
        Scale(name=str(k), values=tuple(range(4)), prior=(0.5, 0.25, 0.15, 0.1)) for k in range(9)
    )

    def prior(self, node: Node) -> float:
        return super().prior(node) - 0.5 * node[0] * node[1]


def test_drawn_nodes_stand_for_those_that_were_not_visited() -> None:
    every = np.array([*itertools.product(range(4), repeat=2)])
    likely = np.log([0.5, 0.25, 0.15, 0.1])
    weights = np.exp(likely[every].sum(axis=1) - 0.5 * every[:, 0] * every[:, 1])
    two = np.bincount(every[:, 0], weights=weights) / weights.sum()
    alone, both = (
        Posterior(Beside(), [()], np.zeros(1), begin=[(0,) * 9], most=60, drawn=drawn)
        for drawn in (0, 200)
    )
    assert both.best == (0,) * 9
    assert both.weights.sum() == pytest.approx(1.0)
    for k in range(9):
        true = two if k < 2 else np.exp(likely)
        assert alone.scale(str(k))[0] > true[0] + 0.2  # what is likeliest changes nothing
        np.testing.assert_allclose(both.scale(str(k)), true, atol=0.08)


def test_no_node_is_drawn_where_those_visited_have_all_weight() -> None:
    drawn, visited = (
        Posterior(Ridge(), [()], np.zeros(1), begin=[(6, 6)], most=144, drawn=count)
        for count in (100, 0)
    )
    assert {*drawn.nodes} >= {*visited.nodes}
    np.testing.assert_allclose(drawn.scale("a"), visited.scale("a"), atol=0.02)


class Apart(Far):
    """Of a spring or of drift and place together, the latter are likelier, but no single step."""

    scales = tuple(
        Scale(name=name, values=(0.0, 1.0, 2.0), prior=(0.8, 0.15, 0.05))
        for name in ("spring", "drift", "place", "noise")
    )

    def prior(self, node: Node) -> float:
        spring, drift, place, noise = (k > 0 for k in node)
        explains = 20.0 if drift and place else 17.0 if spring else 3.0 * (drift or place)
        return super().prior(node) + explains - 2.0 * noise


def test_what_the_best_node_has_of_a_doubted_scale_is_compared_with_the_best_without_it() -> None:
    model, nodes = Apart(), [*itertools.product(range(3), repeat=4)]
    weights = np.exp([model.prior(node) for node in nodes])
    without = sum(w for w, node in zip(weights, nodes, strict=True) if node[0] == 0)
    begin = [(1, 0, 0, 0)]
    alone = Posterior(model, [()], np.zeros(1), begin=begin, most=8)
    assert alone.scale("spring")[0] < 0.05
    doubted = ("spring", "drift", "place")
    both = Posterior(model, [()], np.zeros(1), begin=begin, most=8, doubted=doubted, drawn=60)
    assert both.best == (0, 1, 1, 0)
    assert both.scale("spring")[0] == pytest.approx(without / weights.sum(), abs=0.05)


def test_sweeps_invert_small_matrices() -> None:
    random = np.random.default_rng(0)
    roots = random.normal(size=(7, 3, 5))
    matrices = np.einsum("sik,sjk->sij", roots, roots) + np.eye(3)
    found, logarithms = inverted(matrices)
    np.testing.assert_allclose(found, np.linalg.inv(matrices), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(logarithms, np.linalg.slogdet(matrices)[1], rtol=1e-12)


def test_a_random_column_with_no_room_changes_nothing() -> None:
    gram = np.array([[4.0, 1.0, 2.0], [1.0, 3.0, 1.0], [2.0, 1.0, 5.0]])
    closed = System(gram=gram, deviations=np.full(1, 1e-9), volume=0.0, sizes=np.ones(1))
    _, left = eliminated(closed)
    np.testing.assert_allclose(left, gram[1:, 1:], rtol=1e-12)


def test_an_estimate_holds_random_coefficients_that_cannot_be_negative() -> None:
    class OneSided(Linear):
        def system(self, node: Node, columns: Sequence[Column]) -> System:
            return replace(super().system(node, columns), positive=(1,))

    y, law = 0.7 + 0.2 * Z[:, 0] - 0.5 * Z[:, 1], LAWS[1]
    _, free = Posterior(Linear(y), [law], np.zeros(1), begin=[(0, 1)], most=0).estimate((0, 1), law)
    held = Posterior(OneSided(y), [law], np.zeros(1), begin=[(0, 1)], most=0).estimate((0, 1), law)
    assert free[1] < -0.1
    assert held[1][1] == pytest.approx(0.0, abs=1e-9)
    # the others are those of a fit without it
    x = np.column_stack([Z[:, 0], np.ones(12)]) / NOISES[0]
    precision = x.T @ x + np.diag([SPREADS[1] ** -2, COEFFICIENT**-2])
    expected = np.linalg.solve(precision, x.T @ y / NOISES[0])
    np.testing.assert_allclose([held[1][0], held[0][0]], expected, rtol=1e-6)


def test_rows_tell_links_with_twice_the_errors_that_they_show(model):
    node, laws = (1, 1), LAWS[:2]
    shown = np.linalg.eigvalsh(Z.T @ Z) * (SPREADS[1] / NOISES[1]) ** 2
    plain, linked = (
        Posterior(one, laws, np.zeros(2), begin=[node], most=0) for one in (model, Linked(model.y))
    )
    assert plain.effective(node, ()) == pytest.approx(np.sum(shown / (1.0 + shown)))
    assert linked.effective(node, ()) == pytest.approx(np.sum(shown / (4.0 + shown)))
    means = [own.estimate(node, ())[1] for own in (plain, linked)]
    np.testing.assert_allclose(*means, rtol=1e-9)


def test_a_law_is_as_doubtful_as_links_make_it(model):
    node, law = (0, 1), LAWS[2]
    plain, linked = (
        Posterior(one, [law], np.zeros(1), begin=[node], most=0).draws(4000)[0]
        for one in (model, Linked(model.y))
    )
    own = np.column_stack([Z, *(COLUMNS[column] for column in law)]) / NOISES[0]
    gram = own.T @ own + np.diag([*[SPREADS[1] ** -2] * 2, *[COEFFICIENT**-2] * 2])
    covariance = np.linalg.inv(gram)
    follow = covariance[2:, :2] @ np.linalg.inv(covariance[:2, :2])
    rest = covariance[2:, 2:] - follow @ covariance[:2, 2:]
    shown = np.linalg.inv(covariance[:2, :2]) - np.eye(2) / SPREADS[1] ** 2
    wider = np.linalg.inv(np.eye(2) / SPREADS[1] ** 2 + shown / 4.0)
    expected = np.sqrt(np.diagonal(rest + follow @ wider @ follow.T))
    np.testing.assert_allclose(np.std(linked.law, axis=1), expected, rtol=0.06)
    assert np.max(np.std(linked.law, axis=1) / np.std(plain.law, axis=1)) > 1.1
