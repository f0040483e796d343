"""From a law and a mechanism to the text of a self-contained numeric module."""

from stickslip.engine.formulation.infix import Block, Syntax
from stickslip.engine.formulation.mechanics import LINKS, JointTorques, mass_fault, mass_vanishes
from stickslip.engine.formulation.model import contact_model, formulate
from stickslip.engine.formulation.modes import PAINLEVE
from stickslip.engine.formulation.slip_directions import refuse_singular
from stickslip.engine.formulation.trace import Model, Switchboard, Traced, collapsed, expression

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
