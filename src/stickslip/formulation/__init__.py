"""From a law and a mechanism to the text of a self-contained numeric module."""

from stickslip.formulation.contact_model import contact_model
from stickslip.formulation.infix import Block, Syntax
from stickslip.formulation.joint_torques import JointTorques
from stickslip.formulation.matrix_form import LINKS, mass_fault, mass_vanishes
from stickslip.formulation.model import formulate
from stickslip.formulation.model_type import Model
from stickslip.formulation.modes import PAINLEVE
from stickslip.formulation.slip_directions import refuse_singular
from stickslip.formulation.trace import Switchboard, Traced, collapsed, expression

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
