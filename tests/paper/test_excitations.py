"""Closed forms of Coulomb friction, and where they do not hold."""

import dataclasses

import pytest

from stickslip import Coulomb, SpringBlock
from stickslip.paper.rigs import excitations

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)


def closed_forms(law, rig=RIG):
    readings = excitations(rig, law, measured=0.2, t_end=10.0)
    return {r.key: (r.closed_form, r.criteria.travel) for r in readings}


def test_the_closed_forms_hold_where_the_block_leaves_the_spring():
    # mu < k x0 / (2 m g) = 0.51
    for key, (formula, travel) in closed_forms(Coulomb(kinetic_coefficient=0.5)).items():
        assert (formula is None) == (key == "C")
        if formula is not None:
            assert travel == pytest.approx(formula, rel=1e-9)  # the solver's tolerance


def test_there_is_no_formula_for_a_spring_that_does_not_reach_its_natural_length():
    found = closed_forms(Coulomb(kinetic_coefficient=0.6))
    assert found["B"][0] is None
    assert found["B"][1] < RIG.compression
    assert found["A"][1] == pytest.approx(found["A"][0], rel=1e-9)


@pytest.mark.parametrize(
    "law",
    [
        Coulomb(kinetic_coefficient=1.1),
        Coulomb(kinetic_coefficient=0.5, static_coefficient=1.1),
        Coulomb(kinetic_coefficient=0.0, static_coefficient=1.1),
    ],
)
def test_there_is_no_formula_for_a_block_that_does_not_start(law):
    assert {formula for formula, _ in closed_forms(law).values()} == {None}


def test_there_is_no_formula_for_a_spring_on_the_other_side():
    rig = dataclasses.replace(RIG, compression=-0.1)
    found = closed_forms(Coulomb(kinetic_coefficient=0.25), rig)
    assert {formula for formula, _ in found.values()} == {None}
