# Where each name of the package is; `make stubs` puts lines in order and adds constructors.
from stickslip.engine.formulation.mechanics import JointTorques as JointTorques
from stickslip.engine.formulation.mechanics import LINKS as LINKS
from stickslip.engine.formulation.mechanics import mass_fault as mass_fault
from stickslip.engine.formulation.mechanics import mass_vanishes as mass_vanishes
from stickslip.engine.formulation.model import Block as Block
from stickslip.engine.formulation.model import Syntax as Syntax
from stickslip.engine.formulation.model import contact_model as contact_model
from stickslip.engine.formulation.model import formulate as formulate
from stickslip.engine.formulation.modes import PAINLEVE as PAINLEVE
from stickslip.engine.formulation.slip_directions import refuse_singular as refuse_singular
from stickslip.engine.formulation.trace import Model as Model
from stickslip.engine.formulation.trace import Switchboard as Switchboard
from stickslip.engine.formulation.trace import Traced as Traced
from stickslip.engine.formulation.trace import collapsed as collapsed
from stickslip.engine.formulation.trace import expression as expression

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
