"""Equations in plain Python."""

import traceback

import pytest

from stickslip import Coulomb, SpringBlock
from stickslip.engine.formulation import formulate
from stickslip.engine.kernels.equations import FIELD
from stickslip.engine.solver.compile.modules import load, plain_equations, plain_text

RIG = SpringBlock(mass=1.0, stiffness=100.0, compression=0.1)
LAW = Coulomb(kinetic_coefficient=0.25)


@pytest.fixture
def model():
    return formulate(RIG, LAW)


def test_the_same_equations_are_loaded_once(model):
    assert load(model) is load(formulate(RIG, Coulomb(kinetic_coefficient=0.4)))
    assert callable(load(model).equations[FIELD])


def test_a_traceback_shows_the_line_of_the_equations(model):
    with pytest.raises(IndexError) as caught:
        plain_equations(model)["field"](1, 0, 0.0, [], 0, 0)
    last = traceback.extract_tb(caught.tb)[-1]
    assert last.line
    assert last.line in plain_text(model)
