"""Of the laws that predict as well as the best, the most usual is named, and the others told."""

import math
from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import (
    Axis,
    Dahl,
    Measurement,
    RecordSettings,
    select,
)
from stickslip.identify.candidates.choice import APART, NEAR, apart, as_good, choose
from stickslip.identify.candidates.cross_validation import CrossValidation

AXIS = Axis(inertia=1.0)
QUICK = RecordSettings(starts=1)


def law(name, losses, parameters=2, *, effective=100.0, simpler=(), **more):
    """What the rule looks at of a candidate."""
    validation = CrossValidation(losses=tuple(losses))
    return SimpleNamespace(
        name=name,
        validation=validation,
        score=validation.score,
        parameters=parameters,
        effective=effective,
        simpler=simpler,
        **more,
    )


SIMPLE = law("simple", [1.0, 1.1, 0.9, 1.0], parameters=1)


def rich(*gains, **more):
    """A law with one parameter more, whose losses are smaller by these factors."""
    losses = np.array(SIMPLE.validation.losses) / np.array(gains)
    return law("rich", losses, simpler=("simple",), **more)


@pytest.mark.parametrize(
    ("gains", "named"),
    [
        ((1.5, 1.4, 1.6, 1.5), "rich"),  # in every block
        ((3.0, 0.5, 0.6, 0.5), "simple"),  # in one block
        ((1.03, 1.02, 1.03, 1.02), "simple"),  # in every block, but 1 % of the error
        ((0.8, 0.7, 0.8, 0.9), "simple"),
    ],
)
def test_the_most_usual_law_is_named_of_those_that_predict_as_well_as_the_best(gains, named):
    assert choose([SIMPLE, rich(*gains)]).name == named
    assert choose([rich(*gains), SIMPLE]).name == named


@pytest.mark.parametrize("last", [-1e-12, 1e-12])
def test_the_order_of_laws_that_predict_alike_is_that_in_which_they_were_tried(last):
    """A law at its bound is the one beside it, up to the last bits of another kernel."""
    losses = np.array([1.0, 1.1, 0.9, 1.0])
    first, second = law("first", losses), law("second", losses * (1.0 + last))
    assert first.score == second.score
    assert choose([first, second]).name == "first"


def test_a_block_that_is_bad_for_both_laws_does_not_hide_which_one_is_better():
    simple = law("simple", [4.0, 4.2, 3.8, 4.1, 300.0], parameters=1)
    better = law("rich", [1.0, 1.1, 0.9, 1.0, 310.0])
    even = law("rich", [4.0, 4.2, 3.8, 4.1, 290.0])
    assert choose([simple, better]).name == "simple"  # its error is no smaller
    assert choose([simple, even]).name == "simple"  # one block alone
    four = [law(one.name, one.validation.losses[:4], one.parameters) for one in (simple, better)]
    assert choose(four).name == "rich"


def test_a_block_in_which_a_law_is_exact_by_chance_does_not_decide():
    lucky = rich(1.0, 1.0, 1e12, 1.0)
    assert apart(SIMPLE.validation.losses, lucky.validation.losses) < NEAR


def test_a_block_in_which_a_law_runs_away_does_not_hide_what_the_others_show():
    better = law("rich", [1.0] * 8)
    worse = law("simple", [8.0, 2.0, 2.0, 2.0, 8.0, 30.0, 1e15, 5.0], parameters=1)
    assert not as_good(worse, better)
    assert choose([worse, better]).name == "rich"
    alone = law("simple", [1.0] * 7 + [1e15], parameters=1)
    assert as_good(alone, better)  # one block is no rule


def test_where_readings_are_few_two_of_them_decide_nothing():
    better = (1.3, 1.25, 1.2, 1.3)  # an error smaller by an eighth
    assert choose([SIMPLE, rich(*better)]).name == "rich"
    assert choose([SIMPLE, rich(*better, effective=10.0)]).name == "simple"


def test_what_a_law_is_called_needs_less_than_saying_that_another_does_not_hold():
    doubtful = rich(1.1, 1.8, 1.0, 1.9)
    assert NEAR < apart(SIMPLE.validation.losses, doubtful.validation.losses) < APART
    assert choose([SIMPLE, doubtful]).name == "rich"
    assert as_good(SIMPLE, doubtful)


def test_a_law_within_the_stated_uncertainty_needs_no_richer_one():
    better = rich(1.5, 1.4, 1.6, 1.5)
    assert choose([SIMPLE, better]).name == "rich"
    assert choose([SIMPLE, better], uncertainty=1.1).name == "simple"


def test_numbers_that_two_laws_fit_exactly_go_to_the_simpler_one():
    exact = law("simple", [1e-32, 2e-32], parameters=1)
    assert choose([exact, law("rich", [1e-34, 1e-34])], uncertainty=1e-9).name == "simple"


def test_a_single_block_tells_no_laws_apart():
    assert as_good(law("simple", [9.0]), law("rich", [1.0]))


def rubbing(t, v, x, noise):
    return Measurement(time=t, velocity=v, position=x, friction=2.0 * np.sign(v) + noise)


STEP = {"kinetic_coefficient": 2.0, "stribeck_velocity": 0.1}
DAHL = Dahl(kinetic_coefficient=2.0, bristle_stiffness=1e7)


def rubbed(law, seed):
    """A record in time of friction with independent noise, of a law and a seed."""
    random = np.random.default_rng([13, seed])
    t = np.linspace(0.0, 12.0, int(random.choice([120, 240])), endpoint=False)
    rate = 2.0 * math.pi / 3.0
    v, x = 0.3 * np.sin(rate * t + 0.3), -0.3 / rate * np.cos(rate * t + 0.3)
    noise = 0.05 * 10.0 ** random.uniform(-1.0, 1.0)
    friction = law(v) + noise * random.normal(size=t.size)
    return Measurement(time=t, position=x, velocity=v, friction=friction)


LAWS = ["coulomb", "coulomb-viscous", "direction-dependent", "power-viscous", "quadratic-drag",
        "stribeck"]  # fmt: skip


# 90 % are asked for: with that probability 6 of 8 or more come out in 96 %, 18 of 20 in 68 %
@pytest.mark.slow
@pytest.mark.parametrize(("count", "least"), [(4, 3), pytest.param(20, 18, marks=pytest.mark.slow)])
def test_coulomb_and_viscous_friction_is_named_where_it_is_the_truth(count, least):
    named = Counter(
        select(
            AXIS, LAWS, rubbed(lambda v: 2.0 * np.sign(v) + 5.0 * v, seed), settings=QUICK
        ).closest.name
        for seed in range(count)
    )
    assert named["coulomb-viscous"] >= least, named


@pytest.mark.slow
def test_a_falling_part_that_can_be_seen_is_named():
    def falling(v):
        return np.sign(v) * (2.0 + np.exp(-((v / 0.05) ** 2)) + 5.0 * np.abs(v))

    for seed in (3, 4):
        assert select(AXIS, LAWS, rubbed(falling, seed), settings=QUICK).best.name == "stribeck"
