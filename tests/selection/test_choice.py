"""A richer law is named only where it is shown to hold; the choice among laws that are."""

import dataclasses
import math
from collections import Counter
from types import SimpleNamespace

import numpy as np
import pytest

from stickslip import (
    Axis,
    Coulomb,
    CoulombViscous,
    Dahl,
    Measurement,
    RecordSettings,
    Stribeck,
    select,
)
from stickslip.selection.choice import as_good, choose, effective_aic, established, reduces_to
from stickslip.selection.cross_validation import CrossValidation

AXIS = Axis(inertia=1.0)
QUICK = RecordSettings(starts=1)


class _Judged:
    """What a choice among candidates looks at."""

    def __init__(
        self, losses, name="", *, parameters=3, dropped="", residual=1.0, simpler=(), **more
    ):
        self.validation = CrossValidation(losses=tuple(losses), extrapolation=math.nan)
        self.score = self.validation.score
        self.name, self.parameters, self.dropped = name, parameters, dropped
        self.residual, self.simpler = residual, simpler
        self.effective = more.pop("effective", 100.0)
        self.is_simpler = more.pop("is_simpler", ())
        self.weak = more.pop("weak", False)
        assert not more


SIMPLE = _Judged([1.0, 1.1, 0.9, 1.0], "simple", parameters=2)


def rich(gain, residual, **more):
    """A law with one parameter more, whose losses are smaller by factors around a gain."""
    losses = np.array(SIMPLE.validation.losses) / gain * np.array([1.02, 0.98, 0.97, 1.03])
    return _Judged(losses, "rich", residual=residual, simpler=("simple",), **more)


def test_a_simpler_law_is_as_good_only_within_one_paired_error_and_the_floor():
    best = _Judged([1.0, 2.0, 3.0, 4.0])
    assert as_good(_Judged([1.1, 1.9, 3.1, 4.0]), best)  # differences both ways
    assert not as_good(_Judged([1.05, 2.05, 3.05, 4.05]), best)  # small, but every time
    assert not as_good(_Judged([2.0, 1.0, 6.0, 4.0]), best)  # within doubt, but 14 % worse


def test_a_difference_of_the_search_is_no_difference_of_the_laws():
    best = _Judged([1.0, 2.0, 3.0, 4.0])
    # larger in every block alike, by less than anything a fit is searched to
    assert as_good(_Judged([1.0 + 1e-7, 2.0 + 1e-7, 3.0 + 1e-7, 4.0 + 1e-7]), best)
    assert not as_good(_Judged([1.01, 2.01, 3.01, 4.01]), best)


def test_the_law_of_least_aic_is_taken_where_the_blocks_do_not_speak_against_it():
    def among(likeliest):
        """The same five laws, one of which fits the whole record best."""
        laws = {
            "least": ([1.0, 2.0, 3.0, 4.0], 3),
            "near": ([1.9, 1.6, 3.9, 3.5], 5),  # 4 % worse, within doubt
            "far": ([9.0, 1.5, 3.0, 4.0], 3),  # within doubt, but 32 % worse
            "worse": ([1.1, 2.1, 3.1, 4.1], 3),  # 2 % worse, but every time
            "simple": ([1.1, 1.9, 3.1, 4.0], 2),  # .5 % worse
        }
        return [
            _Judged(losses, name, parameters=count, residual=0.5 if name == likeliest else 1.0)
            for name, (losses, count) in laws.items()
        ]

    assert choose(among("near")).name == "near"
    for likeliest in ("far", "worse", "simple"):
        assert choose(among(likeliest)).name == "simple"
    everyone = among("worse")
    assert choose([c for c in everyone if c.name != "simple"]).name == "least"


@pytest.mark.parametrize(
    ("gain", "residual", "shown"),
    [
        (1.5, 0.8, True),  # both witnesses
        (1.5, 0.995, False),  # F = 1 for 100 effective residuals: by chance in one of three
        (1.0, 0.96, False),  # F = 8.3 is chance in .5 %, but 4 % of the residual are few
        (1.0, 0.94, True),  # F = 12.8 and 6 % of the residual, blocks undecided
        (0.8, 0.90, False),  # but not against the blocks
    ],
)
def test_a_richer_law_needs_both_witnesses_or_one_that_is_strong(gain, residual, shown):
    assert established(rich(gain, residual), SIMPLE) is shown
    assert choose([SIMPLE, rich(gain, residual)]).name == ("rich" if shown else "simple")


def test_residuals_count_by_their_effective_number():
    few, many = (rich(1.5, 0.95, effective=size) for size in (20.0, 200.0))
    assert [established(one, SIMPLE) for one in (few, many)] == [False, True]
    near, far = (rich(1.0, 0.99, effective=size) for size in (20.0, 20000.0))
    for one, wanted in ((near, "simple"), (far, "rich")):
        criteria = effective_aic([SIMPLE, one])
        assert min(criteria, key=criteria.get) == wanted


def test_a_law_at_a_bound_or_with_a_large_condition_must_predict_better_beyond_doubt():
    assert established(rich(1.5, 0.8, weak=True), SIMPLE)  # every block is better by a third
    wavering = _Judged(
        [0.2, 1.2, 0.8, 1.1], "rich", residual=0.8, simpler=("simple",), weak=True
    )  # a better mean, and one block makes it
    assert not established(wavering, SIMPLE)


def test_a_law_that_is_the_simpler_one_at_its_values_is_never_named_for_it():
    same = rich(3.0, 0.5, is_simpler=("simple",))
    assert not established(same, SIMPLE)
    assert choose([SIMPLE, same]).name == "simple"


def test_a_law_within_the_stated_uncertainty_needs_no_richer_one():
    better = rich(1.5, 0.8)
    assert choose([SIMPLE, better]).name == "rich"
    assert choose([SIMPLE, better], uncertainty=1.1).name == "simple"


def test_numbers_that_two_laws_fit_exactly_go_to_the_simpler_one():
    exact = _Judged([1e-32, 2e-32], "simple", residual=1e-16, parameters=2)
    digits = _Judged([1e-34, 1e-34], "rich", residual=1e-17, simpler=("simple",))
    assert choose([exact, digits], uncertainty=1e-9).name == "simple"


STEP = {"kinetic_coefficient": 2.0, "stribeck_velocity": 0.1}
DAHL = Dahl(kinetic_coefficient=2.0, bristle_stiffness=1e7)


@pytest.mark.parametrize(
    ("law", "at_bounds", "expected"),
    [
        (Stribeck(static_coefficient=2.0, **STEP), {}, True),  # no step
        (Stribeck(static_coefficient=2.1, **STEP), {}, False),
        (DAHL, {"friction.bristle_stiffness": "upper"}, True),  # bristles that do not give way
        (DAHL, {}, False),
        (DAHL, {"friction.kinetic_coefficient": "upper"}, False),
        (dataclasses.replace(DAHL, exponent=2.0), {"friction.bristle_stiffness": "upper"}, False),
        (Coulomb(kinetic_coefficient=2.0), {}, False),  # which does not contain it
    ],
)
def test_what_a_fit_reduces_to_is_seen_from_its_values(law, at_bounds, expected):
    fitted = SimpleNamespace(law=law, at_bounds=at_bounds)
    assert reduces_to(fitted, CoulombViscous) is expected


@pytest.mark.parametrize(("viscous", "expected"), [(0.0, True), (5.0, False)])
def test_a_level_that_nobody_gave_is_not_compared(viscous, expected):
    law = CoulombViscous(kinetic_coefficient=2.0, viscous_coefficient=viscous)
    assert law.static_coefficient is None
    assert reduces_to(SimpleNamespace(law=law, at_bounds={}), Coulomb) is expected


def tabled(law, seed):
    """A table of friction with independent noise, of a law and a seed."""
    random = np.random.default_rng([13, seed])
    v = np.linspace(-0.3, 0.3, int(random.choice([40, 80, 160])))
    noise = 0.05 * 10.0 ** random.uniform(-1.0, 1.0)
    return Measurement(velocity=v, friction=law(v) + noise * random.normal(size=len(v)))


LAWS = ["coulomb", "coulomb-viscous", "direction-dependent", "power-viscous", "quadratic-drag",
        "stribeck"]  # fmt: skip


# 90 % are asked for: with that probability 6 of 8 or more come out in 96 %, 18 of 20 in 68 %
@pytest.mark.parametrize(("count", "least"), [(4, 3), pytest.param(20, 18, marks=pytest.mark.slow)])
def test_coulomb_and_viscous_friction_is_named_where_it_is_the_truth(count, least):
    named = Counter(
        select(
            AXIS, LAWS, tabled(lambda v: 2.0 * np.sign(v) + 5.0 * v, seed), settings=QUICK
        ).closest.name
        for seed in range(count)
    )
    assert named["coulomb-viscous"] >= least, named


def test_a_falling_part_that_can_be_seen_is_named():
    def falling(v):
        return np.sign(v) * (2.0 + np.exp(-((v / 0.05) ** 2)) + 5.0 * np.abs(v))

    random = np.random.default_rng(3)
    for count in (60, 120):
        v = np.linspace(-0.3, 0.3, count)
        table = Measurement(velocity=v, friction=falling(v) + 0.05 * random.normal(size=count))
        assert select(AXIS, LAWS, table, settings=QUICK).best.name == "stribeck"
