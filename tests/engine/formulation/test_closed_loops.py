"""Cuts of loops: as many as ways to part the bodies in two connected halves."""

from itertools import combinations

import pytest
import symengine as se

from stickslip.engine.formulation.slip_directions import loops_of


def all_pairs(bodies):
    """Return the closing slips of bodies that all rub on each other, by relative coordinates."""
    n = bodies - 1  # slips of neighbours
    pairs = [(i, j) for i, j in combinations(range(bodies), 2) if j > i + 1]
    return [tuple(se.Integer(i <= k < j) for k in range(n)) for i, j in pairs]


@pytest.mark.parametrize(("bodies", "cuts"), [(3, 3), (4, 7), (5, 15)])
def test_bodies_that_all_rub_on_each_other_part_in_two_halves(bodies, cuts):
    found = loops_of(all_pairs(bodies))
    assert len(found.cuts) == cuts == 2 ** (bodies - 1) - 1
    for cut, crossing in zip(found.cuts, found.crossings, strict=True):
        products = [sum(a * b for a, b in zip(row, cut, strict=True)) for row in found.closing]
        assert products == list(crossing)
    assert found.looped == frozenset(range(bodies - 1))


def test_loops_apart_have_cuts_of_their_own_and_parameters_stay():
    r, zero, one = se.Symbol("r"), se.Integer(0), se.Integer(1)
    found = loops_of([(one, r, zero, zero), (zero, zero, one, -one)])
    assert len(found.cuts) == 6
    parts = [{k // 2 for k, e in enumerate(cut) if e != 0} for cut in found.cuts]
    assert sorted(map(list, parts)) == [[0]] * 3 + [[1]] * 3
    turned = next(c for c, own in zip(found.cuts, found.crossings, strict=True)
                  if own[0] == 0 and c[0] != 0)  # fmt: skip
    assert turned[0] / turned[1] == -r


def test_a_loop_of_too_many_contacts_is_not_tried():
    assert loops_of(all_pairs(7)) is None
