"""Laws that are one part above another contain it, whether they have names or not."""

import dataclasses

import pytest

from stickslip.friction import FrictionLaw, containment_of, law, laws, usual_specifications
from stickslip.friction.notation import canonical, read
from stickslip.identify.fits.parameters import starting_law

KINDS = list(dict.fromkeys(specification.law for specification in usual_specifications()))
PAIRS = [(rich, kind) for rich in KINDS for kind in KINDS if containment_of(rich, kind)]
LARGE = 1e12
"""Stands for infinity: bristles then give way by less than a picometre."""


@pytest.mark.parametrize(("rich", "simple"), PAIRS, ids=[f"{r.name}<{s.name}" for r, s in PAIRS])
def test_each_law_gives_the_friction_of_all_laws_that_it_contains(rich, simple):
    how = containment_of(rich, simple)
    known = dataclasses.replace(starting_law(simple), **how.where)
    values = how.embed(known)
    rest = starting_law(rich)
    others = {name: getattr(rest, name) for name in rich.fit_order}
    found: FrictionLaw = rich(**{**others, **values, **dict.fromkeys(how.limits, LARGE)})
    for velocity in (-0.8, -1e-3, 1e-3, 0.3):
        # products of the same numbers in another order
        assert found.steady(velocity, 7.0) == pytest.approx(known.steady(velocity, 7.0), rel=1e-9)


@pytest.mark.parametrize(
    ("rich", "simple", "contains"),
    [
        ("both_ways(level + stribeck + power)", "both_ways(level + power)", True),
        ("both_ways(level + stribeck + power)", "level + stribeck + viscous + drag", False),
        (
            "dahl(both_ways[levels](level)) + both_ways[levels](viscous)",
            "dahl(level) + power",
            True,
        ),
        ("dahl(level + stribeck) + viscous", "dahl(level) + power", True),  # whose power is 1
        ("dahl(level) + viscous", "level + power", False),  # a power is not 1 by itself
        ("dahl(level) + viscous", "viscous", False),  # a memory needs a level
        # the directions share the Stribeck velocity
        (
            "dahl(both_ways[levels](level + stribeck)) + viscous",
            "both_ways(level + stribeck)",
            False,
        ),
    ],
)
def test_containment_needs_no_names(rich, simple, contains):
    assert (containment_of(law(rich), law(simple)) is not None) == contains


def test_a_whole_exponent_that_makes_a_law_simpler_is_asked_for():
    how = containment_of(law("dahl(level + stribeck) + viscous"), laws()["dahl"])
    assert how.where["viscous_exponent"] == 1.0


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        ("both_ways(level) + both_ways(viscous)", "both_ways(viscous + level)", True),
        ("both_ways[levels](level + viscous)", "both_ways(level + viscous)", True),
        ("both_ways[levels](level + stribeck)", "both_ways(level + stribeck)", False),
        ("both_ways(level) + viscous", "both_ways(level + viscous)", False),
    ],
)
def test_both_directions_of_a_sum_are_the_sum_of_both_directions(one, other, same):
    assert (canonical(read(one)) == canonical(read(other))) == same
    assert (law(one) is law(other)) <= same


def test_titles_of_candidates_differ():
    titles = [specification.title for specification in usual_specifications()]
    assert len({*titles}) == len(titles)


@pytest.mark.parametrize(
    ("composition", "title"),
    [
        ("both_ways[levels](level + stribeck) + power", "Stribeck by direction + power of speed"),
        ("both_ways(level + stribeck + power)", "Stribeck + power of speed by direction"),
        ("dahl(both_ways[levels](level)) + power", "Dahl by direction + power of speed"),
        ("lugre(level) + viscous", "LuGre + Coulomb + viscous"),
        ("gms[4](level + stribeck) + power", "GMS + power of speed"),
        ("level + weight[gravity] + viscous", "Coulomb + gravity load + viscous"),
    ],
)
def test_a_law_without_a_name_has_a_title_of_words(composition, title):
    assert law(composition).title == title
