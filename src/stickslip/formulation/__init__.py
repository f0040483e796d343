"""From a law and a mechanism to the text of a self-contained numeric module."""

from stickslip.formulation.infix import Block, Syntax
from stickslip.formulation.mechanics import LINKS, JointTorques, mass_fault, mass_vanishes
from stickslip.formulation.model import contact_model, formulate
from stickslip.formulation.modes import PAINLEVE
from stickslip.formulation.slip_directions import refuse_singular
from stickslip.formulation.trace import Model, Switchboard, Traced, collapsed, expression

__all__ = [
    "LINKS",
    "PAINLEVE",
    "Block",
    "JointTorques",
    "Model",
    "Switchboard",
    "Syntax",
    "Traced",
    "collapsed",
    "contact_model",
    "expression",
    "formulate",
    "mass_fault",
    "mass_vanishes",
    "refuse_singular",
]
